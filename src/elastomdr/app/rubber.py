"""From a DMA file to a material: what was read as what, master curve, shifts, spectrum,
residuals.
"""

import copy
import re
import shlex
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from nicegui import background_tasks, ui

import elastomdr as em

from ..cli.fit import SIZES, law_of, size_of, strain_of, vertical_of
from ..cli.schema import Several, Table, Text, decode
from ..cli.units import Temperature
from ..errors import InputError, quiet
from ..fit.figures import draw_prony, draw_shifts, draw_spectrum
from .chart import Drawn, drawn
from .form import TableForm
from .scene import CancelledError
from .session import COMPUTING, Session
from .shifts import ShiftEditor
from .stage import (
    BUTTON,
    SAMPLE,
    Busy,
    Notes,
    Picture,
    Words,
    drop,
    mark_of_age,
    worked,
)
from .words import quoted, spoken

_ABOUT = (
    ("master", "Master curve with the fitted series"),
    ("shifts", "Shift factors against temperature"),
    ("spectrum", "Relaxation spectrum, and residuals of the fit"),
)
_UNITS = ("frequency_unit", "modulus_unit", "temperature_unit", "time_unit")
_INNER = r"(?:[^()]|\([^()]*\))*"
_ADVICE = re.compile(  # for Python, then for the command line
    r"(?:(?<=as )|(?<=: )|(?<=give )|(?<=or )|(?<=compare ))"
    rf"\w+=(?:(?!\. )[^()]|\([^()]*\))*? \((--{_INNER})\)"
    rf"|\bem\.\w+\([^()]*\) \((--{_INNER})\)"
)
# as the command line takes it
_OPTION = re.compile(rf" \({_INNER}?--[a-z-]+(?![a-z,-]){_INNER}\)")
_FIRST = ("data", "reference", "name", "poisson")


class Fit(Table):
    """How measured isotherms are read and made into a material: the options of
    elastomdr fit.

    Keys:
        data: the files that were dropped; several files of one material are joined
        reference: reference temperature, by default the isotherm nearest 20 degC
        name: name of the material, by default that of the data
        poisson: Poisson's ratio, by default 0.5
        kind: what the moduli are, where the file does not say
        temperature: of all points, or one for each isotherm, where the file does not
            say
        frequency_unit: Hz or rad/s, where the file does not say
        modulus_unit: Pa, kPa, MPa or GPa, where the file does not say
        temperature_unit: degC or K, where the file does not say
        time_unit: s, ms, min or h, where the file does not say
        column: columns by quantity, such as "storage=4, loss=5"
        area: section of the specimen, such as 100 mm2, where the file has stiffness
        length: length of the specimen, such as 20 mm, where the file has stiffness
        ramp: duration of the ramp before relaxation, such as 1 s, where times count
            from its start
        strain: amplitude to use, such as 0.1 %, where several were measured; by default
            the smallest
        storage_only: whether there is no loss modulus in the file
        shift: a known shift law, such as WLF(8.86, 101.6, 20degC), a dropped file of
            factors, or "universal"
        law: shift law
        vertical: with or without vertical shifts; by default the data decide
        terms: number of relaxation times, by default the data decide
    """

    data: list[str]
    reference: Temperature | None = None
    name: Text | None = None
    poisson: float | None = None
    kind: Literal["shear", "tensile"] | None = None
    temperature: Several[Temperature] | None = None
    frequency_unit: Text | None = None
    modulus_unit: Text | None = None
    temperature_unit: Text | None = None
    time_unit: Text | None = None
    column: Several[Text] | None = None
    area: Text | None = None
    length: Text | None = None
    ramp: Text | None = None
    strain: Text | None = None
    storage_only: bool = False
    shift: Text | None = None
    law: Literal["auto", "WLF", "Arrhenius", "VFT", "table", "none"] | None = None
    vertical: bool | None = None
    terms: int | None = None

    def command(self) -> str:
        """The command that does the same."""
        words = ["elastomdr", "fit", *self.data]
        words += (
            [f"--reference={self.reference - 273.15:.6g}degC"]
            if self.reference is not None
            else []
        )
        if self.temperature is not None:
            words.append(
                "--temperature="
                + ",".join(
                    f"{temperature - 273.15:.6g}degC"
                    for temperature in self.temperature
                )
            )
        for key in (
            "name",
            "kind",
            *SIZES,
            "strain",
            "shift",
            "poisson",
            "law",
            "terms",
            *_UNITS,
        ):
            if (value := getattr(self, key)) is not None:
                words.append(f"--{key.replace('_', '-')}={value}")
        words += [f"--column={column}" for column in self.column or ()] + [
            "--storage-only"
        ] * self.storage_only
        words += (
            []
            if self.vertical is None
            else ["--vertical" if self.vertical else "--no-vertical"]
        )
        return shlex.join(words)


@dataclass
class Fitted:
    """A fit as the page shows it."""

    name: str  # of the material's file
    command: str
    summary: str
    warnings: tuple[str, ...]
    figures: dict[str, Drawn] = field(repr=False)
    fit: Any = field(repr=False)
    asked: dict[str, Any] = field(repr=False)  # as it was filled in
    offsets: np.ndarray = field(repr=False)  # of isotherms shifted by hand [decades]


class RubberStage:
    """The screen."""

    def __init__(self, session: Session, changed: Any):
        self._session, self._changed = session, changed
        self._fitted: Any = None
        self._shown: dict[str, Any] = {}  # what was asked of the fit that is shown
        self._asked = ""  # the field whose answer a dropped file waits for
        self._tried: dict[str, Any] = {}  # what was filled in without that answer
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
                choices = {"data": self._files}
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

    def _files(self) -> list[str]:
        return [
            name for name in self._session.folder.names() if not name.endswith(".toml")
        ]

    async def _sample(self) -> None:
        name = self._session.folder.keep(
            "dma.csv", SAMPLE.joinpath("dma.csv").read_bytes()
        )
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
            self._ask(_for_form(error), asked)
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

    def _ask(self, question: InputError, tried: dict[str, Any]) -> None:
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
        self._words.show(in_fields(fitted.summary))

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
    content: dict[str, Any],
    session: Session,
    progress: Callable[[int, int], None] | None = None,
) -> Fitted:
    """Fits a material and keeps its file. Raises `InputError`."""
    asked: Fit = decode(
        Fit, {key: value for key, value in content.items() if value is not None}
    )
    if not asked.data:
        raise InputError("data: drop a file, or use the sample.")
    session.folder.check(asked.data)
    if asked.name is not None and not re.fullmatch(r"[\w.-]+", asked.name):
        raise InputError(
            f"name must be letters, digits, dots and dashes, got {asked.name!r}."
        )
    options = _given(asked, ("vertical", "terms", "law", "poisson"))
    with quiet(em.fit.FitWarning):  # all of them are in the summary
        dma = _read(asked, session)
        if asked.vertical is None:
            options["vertical"] = _of_shift(vertical_of, asked.shift, session)
        fit = em.fit.material(
            dma,
            asked.reference,
            name=asked.name or "",
            shift=_of_shift(law_of, asked.shift, session),
            progress=progress,
            **options,
        )
        name = f"{fit.material.name}.toml"
        em.save_material(fit.material, session.folder.path / name, info=fit.info())
    rows = (f"row left out: {row}" for row in dma.bad_rows)
    warned = tuple(in_fields(warning) for warning in (*fit.warnings, *rows))
    offsets = np.zeros(fit.master.temperature.size)
    return Fitted(
        name, asked.command(), fit.summary(), warned, {}, fit, content, offsets
    )


def _read(asked: Fit, session: Session) -> Any:
    """The measurement in the files. Raises `InputError`."""
    options = _given(asked, ("kind", *_UNITS))
    if asked.temperature is not None:
        several = len(asked.temperature) > 1
        options["temperature"] = (
            list(asked.temperature) if several else asked.temperature[0]
        )
    options |= {
        key: size_of(key, getattr(asked, key), unit) for key, unit in SIZES.items()
    }
    paths = [session.folder.path / name for name in asked.data]
    try:
        dma = em.read_dma(
            paths if len(paths) > 1 else paths[0],
            columns=dict(map(_column, asked.column or ())) or None,
            storage_only=asked.storage_only,
            **options,
        )
    except OSError as error:
        raise InputError(f"data: {error.strerror or error}") from error
    return dma if asked.strain is None else dma.at_strain(strain_of(asked.strain))


def _given(asked: Fit, keys: tuple[str, ...]) -> dict[str, Any]:
    """What was filled in, of these keys."""
    values = {key: getattr(asked, key) for key in keys}
    return {key: value for key, value in values.items() if value is not None}


def figures(fit: Any) -> dict[str, Drawn]:
    """Master curve, shifts and spectrum of a fit."""
    drawings = {
        "master": drawn(draw_prony(fit.prony)),
        "spectrum": drawn(draw_spectrum(fit.prony)),
    }
    if fit.master.temperature.size > 1:
        drawings["shifts"] = drawn(draw_shifts(fit.master))
    return drawings


def _of_shift(
    laws: Callable[[str | None], Any], typed: str | None, session: Session
) -> Any:
    """A law by a shift law as it is typed; a file of factors must be one that was
    dropped.
    """
    if typed is None or "(" in typed or typed.strip() == "universal":
        return laws(typed)
    session.folder.check([typed.strip()])
    return laws(str(session.folder.path / typed.strip()))


def in_fields(message: str) -> str:
    """A message whose advice, for Python and for the command line, is said in what the
    fields are called and take.
    """
    message = re.sub(r"[\w.]+\(\.\.\.\), (?=--)", "", message)
    message = re.sub(
        _OPTION,
        "",
        re.sub(_ADVICE, lambda match: _spoken(match[1] or match[2]), message),
    )
    return spoken(re.sub(r"--([a-z-]+)", _field, message))


def _spoken(options: str) -> str:
    """Options of a command as fields with what to type into them."""
    phrase = re.sub(r"'([^']*)'", r"\1", options)
    phrase = re.sub(
        r"(?<!or) --(column )?", lambda more: ", " if more[1] else ", --", phrase
    )
    phrase = re.sub(r"--no-([a-z]+)", lambda option: f"{_field(option)}: no", phrase)
    return re.sub(r"--([a-z-]+)", _field, phrase)


def _field(option: re.Match[str]) -> str:
    """What the page calls an option of the command line."""
    return quoted(option[1].replace("-", "_"))


def _for_form(error: InputError) -> InputError:
    message = _said_in_form(str(error))
    first = re.match(r"\w+", message)
    return InputError(message, argument=first[0] if first else "")


def _said_in_form(message: str) -> str:
    """A reader names the file first, and options of the command line; here it is the
    field that is named.
    """
    message = message.removeprefix("--")
    spoken_message = in_fields(message)
    for key in (
        *_UNITS,
        "kind",
        "temperature",
        "column",
        "reference",
        "poisson",
        "terms",
        "law",
        "shift",
        "name",
        "strain",
        *SIZES,
    ):
        if re.match(rf"{key}s?\b", message):
            return (
                f"{key}{spoken_message[len(key) :].removeprefix('s')}"
                if key == "column"
                else spoken_message
            )
    asked = re.search(r"--([a-z-]+)", message)  # what is missing
    key = asked[1].replace("-", "_") if asked else ""
    if key in Fit.__struct_fields__:
        return f"{key}: {spoken_message}"
    return spoken_message if message.startswith("data") else f"data: {spoken_message}"


def _column(typed: str) -> tuple[str, Any]:
    role, equals, title = typed.partition("=")
    if not equals or not role.strip() or not title.strip():
        raise InputError(
            "column must be a quantity and a title or number, such as storage=4, "
            "got "
            f"{typed!r}."
        )
    return role.strip(), int(title) if title.strip().isdigit() else title.strip()
