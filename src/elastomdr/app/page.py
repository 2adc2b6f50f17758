"""The page: one screen per stage; the last one hands out what has been computed."""

import copy
import re
from functools import partial
from pathlib import Path
from typing import Any

from nicegui import ui

from ..errors import InputError
from .computed import COMPARE, FRICTION, ROLLING, SEAL, ComputedStage
from .road import RoadStage
from .rubber import RubberStage
from .scene import Done, bundle, files_of, toml
from .session import DRAWING, Session, Sessions
from .stage import BUTTON, DOCS, worked
from .start import StartStage

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
            for stem, computation in self._session.done.items():
                self._card(stem, computation)

    def _card(self, stem: str, computation: Done) -> None:
        notes = self._notes(computation)
        scene_toml = toml(computation.verb, computation.content, stem, notes)
        beside = files_of(computation.content)
        with ui.element("section").classes("card"):
            ui.label(stem.capitalize()).classes("lead").props(
                "role=heading aria-level=2"
            )
            ui.label(
                "The scene gives the same numbers on the command line and in Python; "
                "its first line says how."
            ).classes("about")
            if beside:
                ui.label(
                    f"It reads, beside it: {', '.join(beside)}. The zip archive has them."
                ).classes("about")
            with ui.element("div").classes("buttons"):
                scene = scene_toml.encode()
                ui.button(
                    "Scene (TOML)",
                    on_click=lambda: ui.download.content(scene, f"{stem}.toml"),
                ).props(BUTTON)
                tyre = {"Tyre (.tir)": "tir"} if computation.verb == "traction" else {}
                for label, ending in (_KINDS | tyre).items():
                    ui.button(
                        label, on_click=partial(self._give, stem, computation, ending)
                    ).props(f"{BUTTON} outline")
            ui.label(scene_toml).classes("words").props("tabindex=0")

    def _notes(self, computation: Done) -> tuple[str, ...]:
        made = (self._session.notes.get(name) for name in files_of(computation.content))
        return tuple(f"material: {command}" for command in made if command)

    async def _give(self, stem: str, computation: Done, ending: str) -> None:
        try:
            content = await worked(DRAWING, self._made, stem, computation, ending)
        except InputError as error:
            ui.notify(str(error), type="negative")
            return
        name = (
            f"{stem}.zip" if ending == "zip" else f"{stem}-{computation.verb}.{ending}"
        )
        ui.download.content(content, name)

    def _made(self, stem: str, computation: Done, ending: str) -> Any:
        if ending in ("png", "svg"):
            return computation.figure().saved(ending)
        if ending == "zip":
            return bundle(
                computation, self._session.folder, stem, self._notes(computation)
            )
        return {
            "csv": computation.csv,
            "tir": computation.tir,
            "xlsx": computation.excel,
        }[ending]()


_STAGES = (
    "Start",
    "Rubber",
    "Road",
    "Friction",
    "Compare",
    "Rolling",
    "Seal",
    "Export",
)
_HERE = Path(__file__).parent


def page(sessions: Sessions) -> "Page":
    """Builds the page of the session that its address names, or of a new one."""
    request = ui.context.client.request
    session = sessions.get(
        request.query_params.get("session") if request is not None else None
    )
    session.shown_by(ui.context.client)
    ui.add_css(_HERE.joinpath("style.css").read_text(encoding="utf-8"))
    script = _HERE.joinpath("page.js").read_text(encoding="utf-8")
    ui.add_head_html(f"<script>{script}</script>")
    ui.colors(primary="#1f5a94")
    ui.run_javascript(f"history.replaceState(null, '', '?session={session.name}')")
    return Page(session)


def _help() -> None:
    """Shows the page of the docs about this page."""
    markdown = DOCS.joinpath("app.md").read_text(encoding="utf-8")
    # what stands before is to open the page
    markdown = markdown[markdown.index("| screen |") :]
    markdown = re.sub(r"!\[.*?\]\(.*?\)\n+\*.*?\*\n", "", markdown, flags=re.DOTALL)
    markdown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", markdown)
    with ui.dialog() as dialog, ui.element("div").classes("help"):
        ui.button("Close", on_click=dialog.close).props(f"{BUTTON} outline")
        ui.markdown(markdown)
    dialog.open()


class Page:
    """The screens, and what a change on one of them means for the others."""

    def __init__(self, session: Session):
        self._session = session
        with ui.element("header").classes("head"):
            ui.label("elastomdr").classes("brand").props("role=heading aria-level=1")
            with (
                ui.tabs()
                .props("dense no-caps align=left outside-arrows mobile-arrows")
                .classes("tabs") as self._tabs
            ):
                for stage in _STAGES:
                    ui.tab(stage)
            ui.button("Help", on_click=_help).props("flat dense no-caps").classes(
                "to-help"
            )
        with ui.tab_panels(
            self._tabs,
            value=session.place or _STAGES[0],
            animated=False,
            keep_alive=True,
        ).classes("panels"):
            with ui.tab_panel("Start"):
                self.start = StartStage(self._go, self._take)
            with ui.tab_panel("Rubber"):
                self.rubber = RubberStage(session, self._new_rubber)
            with ui.tab_panel("Road"):
                self.road = RoadStage(session)
            with ui.tab_panel("Friction"):
                self.friction = ComputedStage(
                    session, FRICTION, self._computed, self._on_road
                )
            with ui.tab_panel("Compare"):
                self.compare = ComputedStage(
                    session, COMPARE, self._computed, self._on_road
                )
            with ui.tab_panel("Rolling"):
                self.rolling = ComputedStage(
                    session, ROLLING, self._computed, self._on_road
                )
            with ui.tab_panel("Seal"):
                self.seal = ComputedStage(session, SEAL, self._computed, self._on_road)
            with ui.tab_panel("Export"):
                self.export = ExportStage(session)
        self._tabs.on_value_change(self._look)

    def _go(self, screen: str) -> None:
        self._tabs.value = screen

    async def _take(self, example: Done) -> None:
        """Shows the example on the friction screen, to be changed."""
        scene = self._session.scenes["friction"]
        scene.clear()
        scene.update(copy.deepcopy(example.asked))
        self._session.done["friction"] = example
        self._computed()
        for stage in (self.friction, self.compare):
            stage.refresh()
        await self.road.refresh()
        await self.friction.show_again()
        self._go("Friction")

    async def _look(self) -> None:
        self._session.place = str(self._tabs.value)
        if self._tabs.value == "Road":
            await self.road.look_again()
        for stage in (self.friction, self.compare, self.rolling, self.seal):
            stage.look()

    def _new_rubber(self, name: str) -> None:
        """A fitted or dropped material is the one that the other screens take."""
        scenes = self._session.scenes
        for key in scenes.keys() - {"compare"}:
            scenes[key]["material"] = name
        compared = scenes["compare"]["material"]
        scenes["compare"]["material"] = [
            name,
            *(other for other in compared if other != name),
        ]
        for stage in (self.friction, self.compare, self.rolling, self.seal):
            stage.refresh()

    def _on_road(self, message: str) -> bool:
        """Shows what is wrong with the road where the road is filled in."""
        marked_field = self.road.form.show_error(message)
        if marked_field:
            self._tabs.value = "Road"
        return bool(marked_field)

    def _computed(self) -> None:
        self.export.refresh()
