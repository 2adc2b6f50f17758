"""From a DMA file to a material: what was read as what, master curve, shifts, spectrum,
residuals.
"""

import copy
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from nicegui import background_tasks, ui

import elastomdr as em

from ..cli.fit import Fit, command
from ..cli.schema import Content, decode, keys_of
from ..errors import InputError, advised
from ..fit.figures import draw_shifts, draw_spectrum
from ..fit.pipeline import MaterialFit
from .chart import Drawn, drawn
from .form import TableForm
from .scene import CancelledError
from .session import COMPUTING, Session
from .shifts import ShiftEditor
from .stage import (
    BUTTON,
    Busy,
    Notes,
    Picture,
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
                choices = {"data": session.folder.measurements}
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
        raise InputError("data: drop a file, or use the sample.")
    asked: Fit = decode(Fit, content)
    folder.check(asked.data)
    if (
        asked.shift is not None
        and "(" not in asked.shift
        and asked.shift != "universal"
    ):
        folder.check([asked.shift])
    try:
        fit = asked.fitted(folder.path, progress)
    except OSError as error:
        raise InputError(f"data: {error.strerror or error}") from error
    name = f"{fit.material.name}.toml"
    em.save_material(fit.material, folder.path / name, info=fit.info())
    rows = (f"row left out: {row}" for row in fit.master.dma.bad_rows)
    warned = tuple(map(spoken, (*fit.warnings, *rows)))
    offsets = np.zeros(fit.master.temperature.size)
    return Fitted(
        name, command(content), fit.summary(), warned, {}, fit, content, offsets
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
    options = next(iter(advised(str(error)).values()), {"data": ""})
    if error.argument == "columns" or error.argument not in keys_of(Fit):
        error.argument = next(iter(options))
    return error
