"""The page: one screen per stage, from the example at the start to the one that hands
out what has been computed; and the pages of the documentation, in a dialog.
"""

import copy
import re
import tempfile
from collections.abc import Awaitable, Callable, Iterator
from functools import cache, partial
from html import escape
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from nicegui import ui

import elastomdr as em

from ..cli.kinds import toml
from ..cli.schema import Content
from ..errors import InputError
from ..fit.report import DYNA_TERMS
from ..notebook_tables import html_image, html_page
from .cards import Cards, cards
from .chart import Drawn
from .computed import ComputedStage
from .road import RoadStage
from .rubber import Fitted, RubberStage
from .scene import (
    CancelledError,
    Done,
    bundle,
    compute,
    files_of,
    written,
    zipped,
)
from .screens import COMPARE, FRICTION, ROLLING, SEAL, TYRE
from .security import Folder, safe
from .session import COMPUTING, DRAWING, Session, Sessions
from .stage import BUTTON, DOCS, Busy, Picture, worked
from .words import in_words, spoken

_IMAGES = {"PNG": "png", "SVG": "svg"}
_WIDTH = 900  # of the figure of a report
# what programs read of a friction law, by its form, and of a fit, by its file's name
_LAWS = {
    "Friction law (CSV)": ("csv", "csv"),
    "Abaqus friction": ("abaqus", "inp"),
    "Abaqus FRIC_COEF": ("fric_coef", "f"),
    "Modelica": ("modelica", "txt"),
}
_FIT = {
    "Material (TOML)": ".toml",
    "Report (HTML)": "-report.html",
    "Master curve": "-master.csv",
    "Shift table": "-shifts.csv",
    "Prony series": "-prony.csv",
    "Abaqus": "-abaqus.inp",
    "Ansys": "-ansys.mac",
    "LS-DYNA": "-dyna.k",
    "Radioss": "-radioss.rad",
    "COMSOL": "-comsol.m",
}
Files: TypeAlias = dict[str, tuple[str, Callable[[], bytes]]]


class Taken(NamedTuple):
    """What can be taken away of a result: by the words of a button, a file's name and
    what makes it.
    """

    title: str
    about: str
    files: Files
    text: str


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
            taken = [*self._taken()]
            if not taken:
                ui.label(
                    "Nothing has been computed yet: fit a rubber, or compute friction, "
                    "a comparison, rolling, a slip curve of a tyre or a seal first."
                )
            for each in taken:
                self._card(each)

    def _taken(self) -> Iterator[Taken]:
        for key, done in self._session.done.items():
            yield self._of_result(key, done)
        if (found := self._session.calibrated) is not None:
            files: Files = {
                name: (name, partial(written, write, name))
                for name, write in found.files.items()
            }
            text = "\n".join(f"{name}: {said}" for name, said in found.lines().items())
            about = "Material and surface that give the measured friction."
            yield Taken("Calibration", about, files, spoken(text))
        for fitted in reversed(self._session.fits.values()):
            yield _of_fit(fitted)

    def _of_result(self, key: str, done: Done) -> Taken:
        rubber, beside = done.content.get("material"), files_of(done.content)
        called = f"-{rubber.removesuffix('.toml')}" if isinstance(rubber, str) else ""
        stem = safe(f"{key}{called}")
        made = (self._session.notes.get(name) for name in beside)
        notes = tuple(f"material: {command}" for command in made if command)
        scene = toml(done.verb, done.content, stem, notes)
        files: Files = {
            "Scene (TOML)": (f"{stem}.toml", scene.encode),
            "Report (HTML)": (f"{stem}.html", partial(report, stem, done, scene)),
            "CSV": (f"{stem}.csv", done.csv),
            "Excel": (f"{stem}.xlsx", done.excel),
        }
        for label, kind in _IMAGES.items():
            files[label] = f"{stem}.{kind}", partial(_image, done, kind)
        if done.verb == "traction":
            files["Tyre (.tir)"] = f"{stem}.tir", done.tir
        if done.verb == "friction":
            for label, (form, ending) in _LAWS.items():
                files[label] = f"{stem}-law.{ending}", partial(done.law, form)
        zipped_all = partial(bundle, done, self._session.folder, stem, notes)
        files["All (zip)"] = f"{stem}.zip", zipped_all
        about = "The scene file gives the same numbers again, without this page."
        if beside:
            about += (
                f" It reads, beside it: {', '.join(beside)}. The zip archive has them."
            )
        return Taken(key.capitalize(), about, files, scene)

    def _card(self, taken: Taken) -> None:
        with ui.element("section").classes("card"):
            ui.label(taken.title).classes("lead").props("role=heading aria-level=2")
            ui.label(taken.about).classes("about")
            with ui.element("div").classes("buttons"):
                for label, (name, make) in taken.files.items():
                    first = " outline" * (label != next(iter(taken.files)))
                    ui.button(label, on_click=partial(self._give, name, make)).props(
                        BUTTON + first
                    )
            if taken.text:
                ui.label(taken.text).classes("words").props("tabindex=0")

    async def _give(self, name: str, make: Callable[[], bytes]) -> None:
        if self._busy.on:
            return
        kind = name.rpartition(".")[2]
        try:
            content = await self._busy.during(DRAWING, make, kind=kind)
        except InputError as error:
            ui.notify(in_words(error), type="negative")
            return
        except CancelledError:
            return
        ui.download.content(content, name)


def _image(done: Done, kind: str) -> bytes:
    return done.figure().saved(kind)


def _of_fit(fitted: Fitted) -> Taken:
    """A fitted rubber, its tables, and cards for other programs."""
    stem, material = fitted.name.removesuffix(".toml"), fitted.fit.material
    files: Files = {
        label: (stem + end, lambda name=stem + end: fitted.fit.files()[name])
        for label, end in _FIT.items()
        if label != "LS-DYNA" or material.moduli.size < DYNA_TERMS
    }
    files["All (zip)"] = f"{stem}.zip", lambda: zipped(fitted.fit.files())
    # what the fit says stands on the screen Rubber, and in its report
    return Taken(f"Rubber {stem}", fitted.command, files, "")


def report(stem: str, done: Done, scene: str) -> bytes:
    """A page of a result for people, in one file: its numbers with how sure they are,
    its figure, its doubts, what it was computed of, and what to cite.
    """
    image = done.figure().saved("svg")
    said = [*done.warnings, *(f"{d.kind}: {d.words()}" for d in done.curve.doubts)]
    numbers = "".join(
        f"<dt>{_html(card.title)}</dt><dd><b>{_html(card.number)}</b> "
        f"{'<br>'.join(map(_html, card.notes))}</dd>"
        for card in cards(done.shown, done.parts)
    )
    parts = {
        "Numbers": f"<dl>{numbers}</dl>",
        "Figure": html_image(image, _WIDTH, "svg+xml"),
        "Doubts": f"<ul>{''.join(f'<li>{_html(each)}</li>' for each in said)}</ul>",
        "Summary": f"<pre>{_html(done.result.summary())}</pre>",
        "Computed of": f"<pre>{escape(scene)}</pre>",
        "To cite": f"<pre>{escape(em.cite(done.curve))}</pre>",
    }
    return html_page(stem, parts)


def _html(words: str) -> str:
    return escape(spoken(words))


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
    state = f"{{screen: '{session.place or 'Start'}'}}"
    ui.run_javascript(f"history.replaceState({state}, '', '?session={session.name}')")
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
                    ComputedStage, session, screen, self._computed, self._elsewhere
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
        ui.on("screen", lambda event: self._go(str(event.args)))

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
        self._tabs.client.run_javascript(f"elastomdr.at('{name}')")
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
        self._computed()

    def _elsewhere(self, error: InputError) -> bool:
        """Shows what is wrong with the road, or with what other screens take of that of
        friction, where it is filled in.
        """
        for name in ("Road", "Friction"):
            form = self.screen(name).form
            if form.field(error.argument):
                self._tabs.value = name
                form.show_error(error)
                return True
        return False

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
    "belt": "Belts, rollers, wheels",
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
