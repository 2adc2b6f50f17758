"""What has been computed, to take away: the scene that reproduces it, its tables and
its figure.
"""

from functools import partial
from typing import Any

from nicegui import ui

from ..errors import InputError
from .scene import Done, bundle, files_of, toml
from .session import DRAWING, Session
from .stage import BUTTON, worked

_KINDS = {"CSV": "csv", "Excel": "xlsx", "PNG": "png", "SVG": "svg", "All (zip)": "zip"}


class ExportStage:
    """The screen."""

    def __init__(self, session: Session):
        self._session = session
        self._place = ui.element("div").classes("export")
        self.refresh()

    def refresh(self) -> None:
        """Shows what has been computed up to now."""
        self._place.clear()
        with self._place:
            if not self._session.done:
                ui.label(
                    "Nothing has been computed yet: compute friction, a "
                    "comparison or rolling first."
                )
            for stem, done in self._session.done.items():
                self._card(stem, done)

    def _card(self, stem: str, done: Done) -> None:
        notes = self._notes(done)
        text = toml(done.verb, done.content, stem, notes)
        beside = files_of(done.content)
        with ui.element("section").classes("card"):
            ui.label(stem.capitalize()).classes("lead").props(
                "role=heading aria-level=2"
            )
            ui.label(f"elastomdr {done.verb} {stem}.toml --out out").classes("command")
            if beside:
                ui.label(
                    f"It reads, beside it: {', '.join(beside)}. The zip archive "
                    "has "
                    "them."
                )
            with ui.element("div").classes("buttons"):
                scene = text.encode()
                ui.button(
                    "Scene (TOML)",
                    on_click=lambda: ui.download.content(scene, f"{stem}.toml"),
                ).props(BUTTON)
                tyre = {"Tyre (.tir)": "tir"} if done.verb == "traction" else {}
                for label, ending in (_KINDS | tyre).items():
                    ui.button(
                        label, on_click=partial(self._give, stem, done, ending)
                    ).props(f"{BUTTON} outline")
            ui.label(text).classes("words").props("tabindex=0")

    def _notes(self, done: Done) -> tuple[str, ...]:
        made = (self._session.notes.get(name) for name in files_of(done.content))
        return tuple(f"material: {command}" for command in made if command)

    async def _give(self, stem: str, done: Done, ending: str) -> None:
        try:
            content = await worked(DRAWING, self._made, stem, done, ending)
        except InputError as error:
            ui.notify(str(error), type="negative")
            return
        name = f"{stem}.zip" if ending == "zip" else f"{stem}-{done.verb}.{ending}"
        ui.download.content(content, name)

    def _made(self, stem: str, done: Done, ending: str) -> Any:
        if ending in ("png", "svg"):
            return done.figure(ending)
        if ending == "zip":
            return bundle(done, self._session.folder, stem, self._notes(done))
        return {"csv": done.csv, "tir": done.tir, "xlsx": done.excel}[ending]()
