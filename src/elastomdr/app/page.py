"""The page: one screen per stage, from the example at the start to the one that hands
out what has been computed; and the pages of the documentation, in a dialog.
"""

import copy
import re
import tempfile
from collections.abc import Awaitable, Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

from nicegui import ui

from ..cli.kinds import toml
from ..cli.schema import Content
from ..errors import InputError
from .cards import Cards
from .chart import Drawn
from .computed import ComputedStage
from .road import RoadStage
from .rubber import RubberStage
from .scene import CancelledError, Done, bundle, compute, files_of
from .screens import COMPARE, FRICTION, ROLLING, SEAL, TYRE
from .security import Folder
from .session import COMPUTING, DRAWING, Session, Sessions
from .stage import BUTTON, DOCS, Busy, Picture, worked
from .words import in_words

_KINDS = {"CSV": "csv", "Excel": "xlsx", "PNG": "png", "SVG": "svg", "All (zip)": "zip"}


class ExportStage:
    """The screen."""

    def __init__(self, session: Session):
        self._session = session
        self._busy = Busy()
        self._place = ui.element("div").classes("export")
        self.refresh()

    def refresh(self) -> None:
        """Shows what has been computed up to now."""
        self._place.clear()
        with self._place:
            if not self._session.done:
                ui.label(
                    "Nothing has been computed yet: compute friction, a comparison, "
                    "rolling, a slip curve of a tyre or a seal first."
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
                "The scene file gives the same numbers again, without this page."
            ).classes("about")
            if beside:
                ui.label(
                    f"It reads, beside it: {', '.join(beside)}. The zip archive has "
                    "them."
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
        if self._busy.on:
            return
        try:
            content = await self._busy.during(
                DRAWING, self._made, stem, computation, ending, kind=ending
            )
        except InputError as error:
            ui.notify(in_words(error), type="negative")
            return
        except CancelledError:
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


_HERE = Path(__file__).parent
_COMPUTED = {
    screen.key.capitalize(): screen
    for screen in (FRICTION, COMPARE, ROLLING, TYRE, SEAL)
}
# of the other screens, the page of the docs
_DOCS = {"Start": "app", "Rubber": "fitting", "Road": "rough", "Export": "app"}


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


class Page:
    """The screens, each made when it is first shown, and what a change on one of them
    means for the others.
    """

    def __init__(self, session: Session):
        self._session = session
        self._makers: dict[str, Callable[[], Any]] = {
            "Start": lambda: StartStage(self._go, self._take),
            "Rubber": lambda: RubberStage(session, self._new_rubber),
            "Road": lambda: RoadStage(session),
            **{
                name: partial(
                    ComputedStage, session, screen, self._computed, self._on_road
                )
                for name, screen in _COMPUTED.items()
            },
            "Export": lambda: ExportStage(session),
        }
        self._made: dict[str, Any] = {}
        with ui.element("header").classes("head"):
            ui.label("elastomdr").classes("brand").props("role=heading aria-level=1")
            with (
                ui.tabs()
                .props("dense no-caps align=left outside-arrows mobile-arrows")
                .classes("tabs") as self._tabs
            ):
                for name in self._makers:
                    ui.tab(name)
            ui.button("Help", on_click=self._help).props("flat dense no-caps").classes(
                "to-help"
            )
        place = session.place or "Start"
        with ui.tab_panels(
            self._tabs, value=place, animated=False, keep_alive=True
        ).classes("panels"):
            self._panels = {name: ui.tab_panel(name) for name in self._makers}
        self.screen(place)
        self._tabs.on_value_change(self._look)

    def screen(self, name: str) -> Any:
        """A screen, made if it has not been shown yet."""
        if name not in self._made:
            with (
                self._panels[name],
                ui.element("div").classes(f"screen of-{name.lower()}"),
            ):
                self._made[name] = self._makers[name]()
        return self._made[name]

    def _go(self, name: str) -> None:
        self._tabs.value = name

    def _help(self) -> None:
        name = str(self._tabs.value)
        show_docs(_DOCS.get(name) or _COMPUTED[name].docs)

    async def _take(self, example: Done) -> None:
        """Shows the example on the friction screen, to be changed."""
        scene = self._session.scenes["friction"]
        scene.clear()
        scene.update(copy.deepcopy(example.asked))
        self._session.done["friction"] = example
        self._computed()
        for stage in self._computing():
            stage.refresh()
        if "Road" in self._made:
            await self.screen("Road").refresh()
        await self.screen("Friction").show_again()
        self._go("Friction")

    async def _look(self) -> None:
        name = self._session.place = str(self._tabs.value)
        stage = self.screen(name)
        if name == "Road":
            await stage.look_again()
        for stage in self._computing():
            stage.look()

    def _computing(self) -> list[ComputedStage]:
        """The screens with a form and a result that have been made."""
        return [self._made[name] for name in _COMPUTED if name in self._made]

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
        for stage in self._computing():
            stage.refresh()

    def _on_road(self, error: InputError) -> bool:
        """Shows what is wrong with the road where the road is filled in."""
        marked_field = self.screen("Road").form.show_error(error)
        if marked_field:
            self._tabs.value = "Road"
        return bool(marked_field)

    def _computed(self) -> None:
        if "Export" in self._made:
            self._made["Export"].refresh()


# by file, in the order in which they are offered
PAGES = {
    "app": "This page",
    "fitting": "From measured moduli to a material",
    "rough": "Rough roads",
    "measured-friction": "Measured friction",
    "accuracy": "How sure the numbers are",
    "wheel": "Rollers and wheels",
    "belt": "Belts",
    "tyre": "Tyres",
    "seal": "Seals",
    "terms": "Terms",
}


def show_docs(name: str) -> None:
    """Shows a page of the docs, with the others to choose from."""
    with ui.dialog() as dialog, ui.element("div").classes("help"):
        with ui.element("div").classes("buttons"):
            chosen = ui.select(PAGES, value=name, label="Documentation")
            chosen.classes("choice")
            ui.button("Close", on_click=dialog.close).props(f"{BUTTON} outline")
        page = ui.markdown(text(name))
        chosen.on_value_change(lambda event: page.set_content(text(event.value)))
    dialog.on("hide", dialog.delete)
    dialog.open()


def text(name: str) -> str:
    """A page as Markdown without figures and links, which the browser has not, and with
    formulas as they are written.
    """
    markdown = DOCS.joinpath(f"{name}.md").read_text(encoding="utf-8")
    if name == "app":  # what stands before is to open the page
        markdown = markdown[markdown.index("| screen |") :]
    markdown = re.sub(r"!\[.*?\]\(.*?\)\n+\*.*?\*\n", "", markdown, flags=re.DOTALL)
    markdown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", markdown)
    markdown = re.sub(r"\$\$(.+?)\$\$", r"\n```\n\1\n```\n", markdown, flags=re.DOTALL)
    return re.sub(r"\$([^$\n]+)\$", r"`\1`", markdown)


# A tread block on stone; its adhesive shear is illustrative, of the size that is found
# for dry treads.
EXAMPLE: Content = {
    "material": "tread-passenger-synthetic",
    "temperature": ["0 degC", "20 degC", "40 degC"],
    "surface": {
        "shape": "self_affine",
        "hurst": 0.8,
        "rms_slope": 1.3,
        "longest": "5 mm",
        "shortest": "0.1 mm",
    },
    "contact": {
        "pressure": "0.3 MPa",
        "velocity": {"from": "1e-4 m/s", "to": "30 m/s", "points": 18},
    },
    "heat": {
        "conductivity": "0.25 W/(m K)",
        "heat_capacity": "2 MJ/(m^3 K)",
        "road": {"conductivity": "1.5 W/(m K)", "heat_capacity": "2 MJ/(m^3 K)"},
    },
    "adhesion": {
        "stress": "5.5 MPa",
        "velocity": "5 mm/s",
        "width": 0.1,
        "energy": "80 kJ/mol",
        "reference": "20 degC",
    },
}
_WAYS = (
    (
        "My rubber",
        "Rubber",
        "Drop measured moduli (DMA): master curve, shift factors, Prony series.",
    ),
    (
        "My road",
        "Road",
        "Drop a spectrum or a topography, or give self-affine numbers.",
    ),
    (
        "My roller",
        "Rolling",
        "A roller, a wheel, a belt: rolling resistance, heat, power.",
    ),
)


class StartStage:
    """The screen.

    `go` shows another screen; `take` shows the example on the friction screen, to be
    changed.
    """

    def __init__(
        self, go: Callable[[str], None], take: Callable[[Done], Awaitable[None]]
    ):
        self._take = take
        with ui.element("div").classes("start"):
            self._fill(go)
        ui.timer(0.05, self._show, once=True)

    def _fill(self, go: Callable[[str], None]) -> None:
        ui.label(
            "How much friction, how much rolling loss, and how sure is the number?"
        ).classes("lead")
        with ui.element("div").classes("ways"):
            for name, screen, about in _WAYS:
                with ui.element("section").classes("way"):
                    ui.button(name, on_click=lambda _, to=screen: go(to)).props(BUTTON)
                    ui.label(about).classes("about")
        ui.label("An example: dry friction of a tread block on a rough road").classes(
            "lead"
        ).props("role=heading aria-level=2")
        self._busy = Busy()
        self._cards = Cards()
        self._picture = Picture("the friction of the example", "example")
        self._change = ui.button("Change the example", on_click=self._taken).props(
            f"{BUTTON} outline"
        )
        ui.label(
            "The rubber is synthetic, with moduli like those of a passenger-car tread; "
            "road and adhesive shear are assumed."
        ).classes("about")

    async def _show(self) -> None:
        try:
            computation = await self._busy.during(COMPUTING, example)
        except CancelledError:
            return
        self._cards.show(computation)
        self._picture.show(await worked(DRAWING, _figure))

    async def _taken(self) -> None:
        await self._take(await worked(COMPUTING, example))


@cache
def example() -> Done:
    """The example, computed once by a server."""
    with tempfile.TemporaryDirectory() as place:
        return compute("friction", EXAMPLE, Folder(Path(place)))


@cache
def _figure() -> Drawn:
    return example().figure()
