"""From a DMA file to a material: what was read as what, master curve, shifts, spectrum,
residuals; isotherms can be shifted by hand.
"""

import copy
import dataclasses
import shlex
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from nicegui import background_tasks, ui

import elastomdr as em

from ..checks import significant
from ..cli.fit import Fit
from ..cli.schema import Content, decode, keys_of
from ..errors import InputError, advised
from ..fit.figures import draw_shifts, draw_spectrum
from ..fit.laws import fit_laws
from ..fit.master import MasterCurve
from ..fit.pipeline import MaterialFit
from .chart import Drawn, drawn
from .form import TableForm
from .scene import CancelledError
from .session import COMPUTING, DRAWING, Session
from .stage import (
    BUTTON,
    Busy,
    Latest,
    Notes,
    Picture,
    Slider,
    Words,
    drop,
    mark_of_age,
    sample,
    worked,
)
from .words import spoken

_ABOUT = (
    ("master", "Master curve with the fitted series"),
    ("shifts", "Shift factors against temperature"),
    ("spectrum", "Relaxation spectrum, and residuals of the fit"),
)
_FIRST = ("data", "reference", "name", "poisson")


@dataclass
class Fitted:
    """A fit as the page shows it."""

    name: str  # of the material's file
    command: str
    summary: str
    warnings: tuple[str, ...]
    figures: dict[str, Drawn] = field(repr=False)
    fit: Any = field(repr=False)
    asked: Content = field(repr=False)  # as it was filled in
    offsets: np.ndarray = field(repr=False)  # of isotherms shifted by hand [decades]


class RubberStage:
    """The screen."""

    def __init__(self, session: Session, changed: Callable[[str], None]):
        self._session, self._changed = session, changed
        self._fitted: Any = None
        self._shown: Content = {}  # what was asked of the fit that is shown
        self._asked = ""  # the field whose answer a dropped file waits for
        self._tried: Content = {}  # what was filled in without that answer
        session.rubber.setdefault("data", [])
        with ui.element("div").classes("stage"):
            with ui.element("div").classes("left"):
                ui.label(
                    "Drop measured isotherms (DMA): text, spreadsheet or an "
                    "instrument's export."
                ).classes("lead")
                drop(
                    session,
                    "DMA files",
                    self._dropped,
                    ("Use sample DMA", self._sample),
                    multiple=True,
                )
                files = session.folder.measurements
                choices = {"data": files, "softening": files}
                self.form = TableForm(
                    Fit,
                    session.rubber,
                    first=_FIRST,
                    choices=choices,
                    entered=self.fit,
                    changed=self._typed,
                    left=self._answered,
                )
                self._button = ui.button("Fit material", on_click=self.fit).props(
                    BUTTON
                )
                self._busy = Busy()
            with ui.element("div").classes("right"):
                self._old, self._notes = mark_of_age(), Notes()
                (key, about), *others = _ABOUT
                self._pictures = {key: Picture(about, key, dragged=True)}
                self._editor = ShiftEditor(self._edited, self._use)
                self._pictures |= {key: Picture(about, key) for key, about in others}
                self._words = Words()
        last = list(session.fits.values())[-1:]
        if last and last[0].asked == session.rubber:
            self._show(last[0])
        if session.question:
            self._ask(session.question, copy.deepcopy(session.rubber))

    async def _sample(self) -> None:
        name = sample(self._session, "dma.csv")
        self._session.rubber |= {"reference": "20 degC", "poisson": 0.5}
        self._session.scenes["friction"]["temperature"] = [
            "0 degC",
            "20 degC",
            "60 degC",
        ]
        await self._dropped([name])

    async def _dropped(self, names: list[str]) -> None:
        materials = [name for name in names if name.endswith(".toml")]
        for name in materials:
            path = self._session.folder.path / name
            try:
                em.load_material(str(path))
            except InputError:
                path.unlink()  # would be offered as a rubber
                raise
            self._changed(name)
        data = [name for name in names if name not in materials]
        if not data:
            return
        self._session.rubber["data"] = data
        self.form.draw()
        await self.fit()

    async def fit(self) -> None:
        """Reads the files and fits a material, or says beside a field what is wrong
        with it.
        """
        if self._busy.on:
            return
        self._session.touch()
        self.form.clear_errors()
        self._clear()
        self._button.disable()
        asked = copy.deepcopy(self._session.rubber)
        self._asked, self._session.question = "", None
        try:
            fitted = await self._busy.during(
                COMPUTING,
                calculate,
                asked,
                self._session,
                self._busy.progress,
                kind="fit",
            )
            fitted.figures = await worked(COMPUTING, figures, fitted.fit)
        except InputError as error:
            self._ask(_of_form(error), asked)
            return
        except CancelledError:
            return
        finally:
            self._button.enable()
        self._session.fits.pop(fitted.name, None)
        self._session.fits[fitted.name] = fitted
        self._session.notes[fitted.name] = fitted.command
        self._show(fitted)
        self._changed(fitted.name)

    def _ask(self, question: InputError, tried: Content) -> None:
        """Asks beside a field, and fits once it has its answer: chosen, or typed and
        left.
        """
        self._session.question, self._tried = question, tried
        self._asked = self.form.show_error(question)

    def _typed(self, name: str) -> None:
        self._compare()
        widget = self.form.widgets.get(name)
        if name == self._asked and not isinstance(widget, ui.input):
            background_tasks.create(self._answered(), name="fit with the answer")

    async def _answered(self) -> None:
        now, asked = self._session.rubber, self._asked
        if asked and now.get(asked) != self._tried.get(asked):
            await self.fit()

    def _compare(self) -> None:
        """Says so where a fit is shown that is not of what is filled in."""
        self._old.visible = bool(self._shown) and self._shown != self._session.rubber

    def _clear(self) -> None:
        """Takes away what there was to see of another fit."""
        self._shown = {}
        self._old.visible = False
        self._notes.show(())
        self._words.show("")
        self._editor.edit(None)
        for picture in self._pictures.values():
            picture.show(None)

    def _show(self, fitted: Fitted) -> None:
        self._shown = fitted.asked
        self._compare()
        self._notes.show(fitted.warnings)
        for key, picture in self._pictures.items():
            picture.show(fitted.figures.get(key))
        self._fitted = fitted
        self._editor.edit(fitted.fit.master, fitted.offsets)
        self._words.show(spoken(fitted.summary))

    def _edited(self, figures: dict[str, Drawn] | None) -> None:
        """Shows figures with isotherms shifted by hand, or those of the fit."""
        shown = self._fitted.figures if figures is None else figures
        for key in shown.keys() & {"master", "shifts"}:
            self._pictures[key].show(shown[key])

    async def _use(self, factors: bytes) -> None:
        """Fits with shift factors that were found by hand."""
        name = self._session.folder.keep("shifts.csv", factors, anew=True)
        self._session.rubber["shift"] = name
        self.form.draw()
        await self.fit()


def calculate(
    content: Content,
    session: Session,
    progress: Callable[[int, int], None] | None = None,
) -> Fitted:
    """Fits a material and keeps its file. Raises `InputError`."""
    folder = session.folder
    if not content["data"]:
        raise InputError(
            argument="data",
            got=None,
            accepted="given",
            hint="drop a file, or use the sample",
        )
    asked: Fit = decode(Fit, content)
    folder.check([*asked.data, *filter(None, [asked.softening])])
    if (
        asked.shift is not None
        and "(" not in asked.shift
        and asked.shift != "universal"
    ):
        folder.check([asked.shift])
    try:
        fit = asked.fitted(folder.path, progress)
    except OSError as error:
        raise InputError(
            argument="data",
            got=list(asked.data),
            accepted="files that can be read",
            hint=str(error.strerror or error),
        ) from error
    name = f"{fit.material.name}.toml"
    em.save_material(fit.material, folder.path / name, info=fit.info())
    rows = (f"row left out: {row}" for row in fit.master.dma.bad_rows)
    warned = tuple(map(spoken, (*fit.warnings, *rows)))
    offsets = np.zeros(fit.master.temperature.size)
    return Fitted(
        name, _command(content), fit.summary(), warned, {}, fit, content, offsets
    )


def figures(fit: MaterialFit) -> dict[str, Drawn]:
    """Master curve, shifts and spectrum of a fit."""
    drawings = {
        "master": drawn(fit.prony.plot()),
        "spectrum": drawn(draw_spectrum(fit.prony)),
    }
    if fit.master.temperature.size > 1:
        drawings["shifts"] = drawn(draw_shifts(fit.master))
    return drawings


def _of_form(error: InputError) -> InputError:
    """An error of a fit with the field that it is about: of a file, that which it asks
    for.
    """
    options = next(iter(advised(error.hint)), {"data": ""})
    if error.argument == "data" or error.argument not in keys_of(Fit):
        error.called(next(iter(options)))
    return error


_REACH = 1.5  # how far an isotherm may be shifted from the fit [decades]


class ShiftEditor:
    """A slider for one isotherm at a time, which can be dragged in the figure as well.

    `show` is called with the figures of master curve and shift factors, None for those
    of the fit; `use` with the table of shift factors, to fit with them.
    """

    def __init__(
        self,
        show: Callable[[dict[str, Drawn] | None], None],
        use: Callable[[bytes], Awaitable[None]],
    ):
        self._show, self._use = show, use
        self._master: Any = None
        self._offsets = np.zeros(0)  # from the fit [decades]
        # offset of an isotherm that is being dragged
        self._grabbed: float | None = None
        self._numbers: dict[str, int] = {}  # of isotherms, by what they are called
        self._restarts = 0  # how often all went back to a fit
        self._redraw = Latest(self._drawn)
        ui.on("isotherm", self._dragged)
        title = "Shift isotherms: drag one in the figure, or here"
        with ui.expansion(title).classes("more") as self._fold:
            self._isotherm = ui.select({}, label="Isotherm").classes("field")
            self._isotherm.on_value_change(self._chosen)
            self._slider = Slider(
                "Shift factor log₁₀ a_T",
                (-_REACH, _REACH),
                lambda decades: f"{decades:.3f}",
                self._moved,
                logarithmic=False,
            )
            self._said = ui.label().classes("words")
            with ui.element("div").classes("buttons"):
                ui.button("Back to the fit", on_click=self._back).props(
                    f"{BUTTON} outline"
                )
                ui.button("Fit with these factors", on_click=self._taken).props(BUTTON)
        self._fold.visible = False

    def edit(
        self, master: MasterCurve | None, offsets: np.ndarray | None = None
    ) -> None:
        """Takes the master curve of a fit and the shifts by hand [decades], which it
        changes in place; None, or a single isotherm, hides it.
        """
        if master is not None and master.temperature.size < 2:
            master = None
        self._fold.visible = master is not None
        self._master = master
        self._restarts += 1
        if master is None:
            return
        self._offsets = (
            np.zeros(master.temperature.size) if offsets is None else offsets
        )
        names = {
            i: _celsius(temperature) for i, temperature in enumerate(master.temperature)
        }
        by_hand = bool(self._offsets.any())
        far = self._offsets if by_hand else master.temperature - master.reference
        farthest = int(np.abs(far).argmax())
        self._numbers = {name: i for i, name in names.items()}
        self._isotherm.set_options(names, value=farthest)
        self._chosen()
        if by_hand:
            background_tasks.create(self._redraw(), name="show shifts by hand")

    def _chosen(self) -> None:
        i = self._isotherm.value
        if self._master is None or i is None:
            return
        fitted = float(self._master.log10_a[i])
        limits = fitted - _REACH, fitted + _REACH
        self._slider.set(fitted + float(self._offsets[i]), limits)
        self._said.text = _in_words(_edited(self._master, self._offsets), i)

    def _moved(self, decades: float) -> None:
        i = self._isotherm.value
        self._offsets[i] = decades - float(self._master.log10_a[i])
        background_tasks.create(self._redraw(), name="shift an isotherm")

    def _dragged(self, event: Any) -> None:
        """Follows an isotherm in the figure, which moves by itself until it is let go."""
        i = self._numbers.get(event.args["name"])
        if self._master is None or i is None:
            return
        if self._grabbed is None:
            self._grabbed = float(self._offsets[i])
            self._isotherm.value = i
            self._fold.open()
        # over time, longer times are a smaller shift factor
        sign = 1.0 if self._master.omega.size else -1.0
        offset = self._grabbed + sign * float(event.args["decades"])
        fitted = float(self._master.log10_a[i])
        decades = fitted + float(np.clip(offset, -_REACH, _REACH))
        if event.args["end"]:
            self._grabbed = None
        self._slider.set(decades)
        self._moved(decades)

    async def _drawn(self) -> None:
        if self._master is None:
            return
        offsets, i, restarts = (
            self._offsets.copy(),
            self._isotherm.value,
            self._restarts,
        )
        figures, words = await worked(DRAWING, _figures, self._master, offsets, i)
        if restarts != self._restarts:
            return
        if self._grabbed is not None:
            figures.pop("master")
        self._show(figures)
        self._said.text = words

    def _back(self) -> None:
        self._restarts += 1
        self._offsets[:] = 0.0
        self._chosen()
        self._show(None)

    async def _taken(self) -> None:
        factors = self._master.log10_a + self._offsets
        rows = zip(self._master.temperature - 273.15, factors, strict=True)
        table = "".join(f"{celsius:.6g},{factor:.6g}\n" for celsius, factor in rows)
        await self._use(f"T [degC],log10 a_T\n{table}".encode())


def _figures(
    master: MasterCurve, offsets: np.ndarray, i: int
) -> tuple[dict[str, Drawn], str]:
    """Master curve and shift factors with these offsets, and what there is to say."""
    edited = _edited(master, offsets)
    shown = {
        "master": drawn(edited.plot()),
        "shifts": drawn(draw_shifts(edited)),
    }
    return shown, _in_words(edited, i)


def _edited(master: MasterCurve, offsets: np.ndarray) -> Any:
    """The master curve with isotherms moved from the fit [decades]; the smooth curve
    behind them stays that of the fit.
    """
    factors = master.log10_a + offsets
    return dataclasses.replace(
        master,
        log10_a=factors,
        omega=master.omega * 10.0 ** offsets[master.isotherm],
        time=master.time / 10.0 ** offsets[master.time_isotherm],
        laws=fit_laws(master.temperature, factors, master.covariance, master.reference),
    )


def _in_words(master: MasterCurve, i: int) -> str:
    """Shift factor, overlap and law."""
    lines = [f"log10 a_T  {master.log10_a[i]:.3f} at {_celsius(master.temperature[i])}"]
    distance, count = overlap(master, i)
    lines.append(
        f"overlap    {count} points of E' within the neighbours, "
        f"{significant(100 * distance, 2)} % off them (rms)"
        if count
        else "overlap    none with the neighbours"
    )
    lines += [
        f"{name:<9}  {law.constants()}; {significant(law.rms, 2)} decades off (rms)"
        for name, law in master.laws.items()
        if name in ("WLF", "Arrhenius")
    ]
    return spoken("\n".join(lines))


def overlap(master: MasterCurve, i: int) -> tuple[float, int]:
    """How far an isotherm's storage moduli (or relaxation moduli) are from a line
    through those of its two neighbours, relative, rms, and how many points that are.
    """
    dynamic = bool(master.omega.size)
    x, y, number = (
        (master.omega, master.storage, master.isotherm)
        if dynamic
        else (master.time, master.relaxation, master.time_isotherm)
    )
    on_isotherm, beside = number == i, np.abs(number - i) == 1
    order = np.argsort(x[beside])
    across, up = np.log(x[beside][order]), np.log(y[beside][order])
    places = np.log(x[on_isotherm])
    inside = (places >= across[0]) & (places <= across[-1])
    if not inside.any():
        return 0.0, 0
    off = np.log(y[on_isotherm][inside]) - np.interp(places[inside], across, up)
    return float(np.sqrt(np.mean(off**2))), int(inside.sum())


def _celsius(temperature: float) -> str:
    return f"{round(float(temperature) - 273.15, 1) + 0.0:g} °C"


def _command(content: Content) -> str:
    """The command that does what the form of the page asks for."""
    words = ["elastomdr", "fit", *content["data"]]
    for key, value in content.items():
        option = f"--{key.replace('_', '-')}"
        if isinstance(value, bool):
            no_option = [f"--no-{key}"] if key == "vertical" else []
            words += [option] if value else no_option
        elif key == "column" and isinstance(value, list):
            words += [f"{option}={one}" for one in value]
        elif key != "data":
            listed = value if isinstance(value, list) else [value]
            words.append(f"{option}={','.join(map(str, listed))}")
    return shlex.join(words)
