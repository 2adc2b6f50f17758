"""From measured isotherms (`em.fit.material`), or from a hardness alone, to a material:
misfit, random draws, and the files that come of it.
"""

from __future__ import annotations

import html
import os
import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypedDict

import numpy as np

from .. import __version__
from ..checks import a_text, in_si, scalar, significant
from ..errors import InputError, advise, quiet, typed_as
from ..io.data import Dma, FitWarning, strains
from ..material.format import Document
from ..material.library import load_material, material_info, save_material
from ..material.prony import Prony
from ..material.shift import (
    AbstractVertical,
    EntropicVertical,
    ShiftTable,
    VerticalTable,
)
from ..material.tabulated import TabulatedModulus
from ..material.validity import (
    Draws,
    Range,
    by_moduli,
    changed,
    check_draws,
    misfit_bands,
    root_of,
    without_misfit,
)
from ..notebook_tables import html_image, html_page, html_table
from ..progress_bar import reporter
from ..trees import replaced
from .laws import derivatives, fit_form, forms
from .master import (
    MasterCurve,
    check_dma,
    check_law,
    master_curve,
    rounded,
    shift_law,
    shifts_csv,
    tabulate,
    vertical_law,
)
from .report import (
    DYNA_TERMS,
    TWO_SIGMA,
    AbstractFindings,
    abaqus_card,
    ansys_card,
    comsol_card,
    dyna_card,
    plain_card,
    radioss_card,
    tell,
)
from .series import PronyFit, prony
from .shifting import LN10, moved, sensitivity
from .spectrum import LOSS, STORAGE

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes

    from .._types import LawName, Number, Style
    from ..material.shift import AbstractShift

# --------------------------------------------------------------------------------------
# How far a material with its laws of shifts is from moduli as they were measured.
# --------------------------------------------------------------------------------------


def deviations(material: Prony, dma: Dma) -> dict[str, np.ndarray]:
    """Relative deviations at each measured point, prediction over data minus one, by
    the name of the modulus.

    `material` is of the kind of the data. Without a shift law there are none.
    """
    law = material.shift
    if law is None:
        return {}
    times = np.asarray(material.times)
    moduli = np.asarray(material.moduli)
    equilibrium = float(material.equilibrium)
    parts = {}
    if dma.omega.size:
        b = _lift(material.vertical, dma.temperature)
        x = (dma.omega * _factor(law, dma.temperature))[:, None] * times
        parts["storage modulus"] = (
            b * (equilibrium + (moduli * x / (x + 1 / x)).sum(axis=1)) / dma.storage - 1
        )
        parts["loss modulus"] = b * (moduli / (x + 1 / x)).sum(axis=1) / dma.loss - 1
    if dma.time.size:
        x = (dma.time / _factor(law, dma.time_temperature))[:, None] / times
        b = _lift(material.vertical, dma.time_temperature)
        parts["relaxation modulus"] = (
            b * (equilibrium + (moduli * np.exp(-x)).sum(axis=1)) / dma.relaxation - 1
        )
    return parts


def misfit(material: Prony, dma: Dma) -> dict[str, float]:
    """Root mean squares of `deviations`."""
    return {
        name: float(np.sqrt(np.mean(deviation**2)))
        for name, deviation in deviations(material, dma).items()
    }


def with_misfit(material: Prony, dma: Dma) -> Prony:
    """The material with its deviations from the data as measured, at reduced
    frequencies, as its record of misfit.
    """
    if material.shift is None or material.range is None or not dma.omega.size:
        return material
    parts = deviations(material, dma)
    rows = misfit_bands(
        dma.omega * _factor(material.shift, dma.temperature),
        parts["storage modulus"],
        parts["loss modulus"],
    )
    return replaced(material, range=material.range._replace(misfit=rows))


def _lift(law: AbstractVertical | None, temperature: np.ndarray) -> float | np.ndarray:
    """b_T; 1 without a law."""
    return 1.0 if law is None else np.asarray(law.b(temperature))


def _factor(law: AbstractShift, temperature: np.ndarray) -> np.ndarray:
    """a_T; a table ends at the mean of its last isotherm, and holds a little beyond."""
    try:
        return 10 ** np.asarray(law.log10_a(temperature))
    except InputError:
        if not isinstance(law, ShiftTable):
            raise
        low, high = (float(law.temperature[i]) for i in (0, -1))
        return 10 ** np.asarray(law.log10_a(np.clip(temperature, low, high)))


# --------------------------------------------------------------------------------------
# Materials drawn from a fit: spectrum and laws of shifts together, as the intervals of
# the fit report them.
#
# The unknowns of the joint fit, the errors of the temperatures and the doubts
# (`fit/shifting.py`) are drawn together. They move the common curve, to which the moduli of
# the series follow in least squares, and the shift factors, to which the constants of the
# law follow as they did in their fit. The distance between series and curve is one more
# direction.
# --------------------------------------------------------------------------------------

_PER_DECADE = 6
# from the reference temperature up to which an isotherm is not in a table beside it [K]
_NEAR = 0.5


def draws(fit: MaterialFit, n: int, seed: int) -> Draws[Prony]:
    """`n` materials, in which everything that the data leave open differs."""
    check_draws(n, seed)
    joint, state = fit.master.joint, fit.master.state
    low, high = np.log(fit.prony.window)
    log_omega = np.linspace(low, high, max(int(_PER_DECADE * (high - low) / LN10), 8))
    curve = sensitivity(
        joint, state, np.tile(log_omega, 2), np.repeat([STORAGE, LOSS], log_omega.size)
    )
    of_a, of_others, of_b = moved(joint, state)
    rng = np.random.default_rng(seed)
    unknowns = (
        rng.standard_normal((n, of_a.shape[1]))
        @ root_of(joint.shifts.posterior.covariance).T
    )
    others = rng.standard_normal((n, of_others.shape[1]))
    off = (
        np.log(np.concatenate(fit.prony.moduli_at(np.exp(log_omega)))) - curve.log_value
    )
    spectrum = (
        unknowns @ curve.by_unknowns.T
        + others @ curve.by_others.T
        + np.outer(rng.standard_normal(n), off)
    )
    log10_a, ln_b = unknowns @ of_a.T + others @ of_others.T, unknowns @ of_b.T
    changes = spectrum @ by_moduli(fit.material, np.exp(log_omega)).T
    shift = _shifts(fit, log10_a, rng)
    each = [
        replaced(
            changed(fit.material, change, i + 1),
            shift=shift(i),
            vertical=_vertical(fit, ln_b[i]),
        )
        for i, change in enumerate(changes)
    ]
    words = "spectrum" + (
        "" if fit.material.shift is None or fit.master.given else " and shift factors"
    )
    words = f"{words}, as the fit leaves them open"
    return Draws(each, without_misfit(fit.material), words)


def _shifts(fit: MaterialFit, log10_a: np.ndarray, rng: np.random.Generator) -> Any:
    """A function from the number of a draw to its shift law."""
    law, master = fit.material.shift, fit.master
    if law is None or fit.law == "given":
        return lambda _: law
    if isinstance(law, ShiftTable):
        return lambda i: ShiftTable(law.temperature, _along(fit, law, log10_a[i]))
    reference, temperature = master.reference, master.temperature
    form = forms(reference, float(min(temperature.min(), reference)))[fit.law]
    start, spread, law_own = fit_form(
        form, temperature, master.log10_a, master.covariance
    )
    precision = np.linalg.inv(master.covariance + law_own**2 * np.eye(temperature.size))
    gain = spread @ derivatives(form, start, temperature).T @ precision
    off = log10_a + law_own * rng.standard_normal(log10_a.shape)
    low, high = np.array(form.limits).T
    return lambda i: form.constants(np.clip(start + gain @ off[i], low, high))[0]


def _along(fit: MaterialFit, table: ShiftTable, change: np.ndarray) -> np.ndarray:
    """The shift factors of a table with their changes, zero at the reference
    temperature, falling.
    """
    temperature = np.asarray(table.temperature)
    away = np.abs(fit.master.temperature - fit.master.reference) > _NEAR
    x = np.append(fit.master.temperature[away], fit.master.reference)
    order = np.argsort(x)
    moved = np.asarray(table.log10_a_table) + np.interp(
        temperature, x[order], np.append(change[away], 0.0)[order]
    )
    return np.minimum.accumulate(moved)


def _vertical(fit: MaterialFit, change: np.ndarray) -> Any:
    """The vertical shifts with their changes; those of entropy elasticity have no
    constant that could differ.
    """
    vertical = fit.material.vertical
    if not isinstance(vertical, VerticalTable):
        return vertical
    # A modulus at T is that of the common curve over exp(ln b).
    return replaced(
        vertical,
        factor=np.asarray(vertical.factor)
        * np.exp(-np.interp(vertical.temperature, fit.master.temperature, change)),
    )


# --------------------------------------------------------------------------------------
# From measured isotherms to a material in one call, and the files that come of it.
# --------------------------------------------------------------------------------------

_STEPS = 3  # of a fit: shifts, vertical shifts, series
# chance that there are no vertical shifts above which the material has none
_OPEN = 0.05
_UNITY = 1e-3  # by which b_T may differ from 1 at the reference temperature
_JUDGED_AT = (0.0, 60.0)  # where treads are compared, for wet grip and rolling [degC]
_MISSED = 0.1  # misfit of the data as measured that is worth a warning


@dataclass(frozen=True, eq=False, repr=False)
class MaterialFit(AbstractFindings):
    """A material, with the master curve and the series that it comes from.

    `misfit` has the rms relative residuals of the material, with its shift law, about
    the data as measured.
    """

    material: Prony
    master: MasterCurve
    prony: PronyFit
    law: str  # of `LAWS`
    # rms relative residual of the material, with its shift law, to the data as measured
    misfit: dict[str, float]
    warnings: tuple[str, ...]
    citation: str
    description: str

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the material, as pairs of a name and a text."""
        yield "material", self.material.name
        yield from (("columns", value) for value in self.master.dma.columns)
        yield from (
            (name, value) for name, value in self.master.findings() if name != "warning"
        )
        yield (
            "shift law",
            "none in the material"
            if self.law == "none"
            else f"{self.law} in the material",
        )
        yield "vertical shift", _lifted(self.material.vertical, self.master.temperature)
        if self.material.shift is not None:
            tangents = (_tangent(self.material, celsius) for celsius in _JUDGED_AT)
            yield "loss tangent", f"{', '.join(tangents)}, at 10 Hz and small strain"
        if (softening := self.material.softening) is not None:
            *_, (strain, storage, loss) = zip(
                softening.strain, softening.storage, softening.loss, strict=True
            )
            yield (
                "softening",
                f"storage modulus times {storage:.3g}, loss modulus times {loss:.3g} "
                f"at {100 * strain:.3g} % strain",
            )
        yield from (
            (name, value) for name, value in self.prony.findings() if name != "warning"
        )
        if self.misfit:
            parts = ", ".join(
                f"{name} {100 * size:.2g} %" for name, size in self.misfit.items()
            )
            yield (
                "misfit",
                f"of material and shift law against the data as measured: {parts} rms",
            )
        for value in self.warnings:
            yield "warning", value

    def tabulated(self, *, per_decade: int = 8) -> TabulatedModulus:
        """The data themselves as a material for surfaces, with the shift law of this
        fit, averaged in bands of log omega.

        Args:
            per_decade: bands per decade of frequency.

        Returns:
            A table of moduli, of the name, citation, Poisson's ratio and shift law of
            `material`.
        """
        material = self.material
        assert material.poisson is not None  # no fit makes a constant bulk modulus
        return tabulate(
            self.master,
            per_decade,
            material.shift,
            material.vertical,
            material.poisson,
            material.name,
            material.citation,
        )

    def draws(self, n: int, seed: int = 0) -> list[Prony]:
        """Materials that the data allow, for `em.friction`, `em.rolling` and
        `em.sweep`: the whole uncertainty.

        Moduli scatter as `prony.band` says, shift factors as their law's constants or
        the shift factors themselves are known, with vertical shifts where the material
        has a table of them; all of it is drawn together. A law that was given stays as
        it is.

        Args:
            n: how many, 2 or more.
            seed: of the random numbers.

        Returns:
            A list of materials that knows what it is of: a result of it is drawn as one
            curve with its band.

        Raises:
            InputError: for numbers that are not whole.
        """

        return draws(self, n, seed)

    def info(self) -> Document:
        """What a material file holds beside the numbers: description, range, sources
        with the quality of the fit.
        """
        master, fit, law = self.master, self.prony, self.material.shift
        fitted = {
            "citation": f"{self.citation}, fitted by elastomdr {__version__} (em.fit)",
            "grade": "fitted here",
        }
        moduli: dict[str, Any] = fitted | {"note": self._note()}
        of_series = {
            "storage": fit.storage_residual,
            "loss": fit.loss_residual,
            "relaxation": fit.relaxation_residual,
        }
        # of this material against the data, not of the series against shifted ones
        for name in ("storage", "loss"):
            of = name if fit.storage.size else "relaxation"
            moduli[f"{name}_residual"] = rounded(
                self.misfit.get(f"{of} modulus", of_series[of]), 2
            )
        sources = {
            "moduli": moduli,
            "shift": (fitted if not self.master.given else self._given())
            | {"note": self._shift_note()},
            "poisson": {"citation": "Assumed, not measured", "grade": "illustrative"},
            "range": {
                "citation": f"Span of the data: {self.citation}",
                "grade": "measured",
            },
        }
        if self.material.shift is None:
            del sources["shift"]
        if self.material.vertical is not None:
            sources["vertical"] = fitted | {
                "note": f"{_lifted(self.material.vertical, self.master.temperature).capitalize()}."
            }
        return {
            "description": self.description,
            "reference_temperature": float(
                law.reference
                if law is not None and np.isfinite(law.reference)
                else master.reference
            ),  # which is rounded
            "range": (self.material.range or Range(None, None)).table(),
            "source": sources,
        }

    def _note(self) -> str:
        fit = self.prony
        parts = [
            (
                f"{fit.terms} terms over {np.log10(fit.window[1] / fit.window[0]):.1f} "
                "decades."
            )
        ]
        if amplitude := strains(self.master.dma.strain):
            parts.append(f"Measured at a strain amplitude of {amplitude}.")
        if not fit.storage.size:
            parts.append(
                "From relaxation; both residuals are of the relaxation modulus. "
                f"Loss: {fit.loss_known}."
            )
        if self.misfit:
            parts.append(
                "Residuals are of the data as measured, by this file with its laws "
                "of shifts; the master curve is met to: "
                f"{self.prony.residuals_in_words()} rms."
            )
        return " ".join([*parts, *self.warnings])

    def _given(self) -> dict[str, str]:
        estimated = "estimated" in self.master.given
        return {
            "citation": "Given with the data",
            "grade": "estimated" if estimated else "published fit",
        }

    def _shift_note(self) -> str:
        master = self.master
        if master.given:
            return f"{master.given}."
        worst = TWO_SIGMA * float(master.log10_a_std.max())
        parts = [
            (
                f"{master.temperature.size} isotherms shifted jointly, log10 a_T to +- "
                f"{worst:.2g} (95 %) at worst."
            )
        ]
        if self.law in master.laws:
            parts.append(
                f"The law misses them by {master.laws[self.law].rms:.2g} decades rms."
            )
        return " ".join(parts)

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws data, series and band against frequency, as `prony.plot`."""
        return self.prony.plot(ax, style)

    def files(self, stem: str | None = None) -> dict[str, bytes]:
        """File name to content: the material, its cards, tables and figures, and
        a page of all that for people. Cards that do not exist are left out.
        """
        from .figures import figures

        stem = self.material.name if stem is None else stem
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{stem}.toml"
            save_material(self.material, path, info=self.info())
            content = {path.name: path.read_bytes()}
        texts = {
            f"{stem}-master.csv": self.master.csv(),
            f"{stem}-shifts.csv": shifts_csv(self.master),
            f"{stem}-prony.csv": self.prony.csv(),
            f"{stem}-plain.csv": plain_card(self.material),
            f"{stem}-abaqus.inp": abaqus_card(self.material),
            f"{stem}-ansys.mac": ansys_card(self.material),
            f"{stem}-radioss.rad": radioss_card(self.material),
            f"{stem}-comsol.m": comsol_card(self.material),
        }
        if self.material.moduli.size < DYNA_TERMS:
            texts[f"{stem}-dyna.k"] = dyna_card(self.material)
        content |= {name: text_of_file.encode() for name, text_of_file in texts.items()}
        pictures = figures(self.master, self.prony)
        parts = {
            "What was found": html_table("", self.findings()),
            "Figures": "".join(html_image(each, 600) for each in pictures.values()),
            "Doubts": html_table("", (("", each) for each in self.warnings)),
            "To cite": html.escape(self.material.citation),
        }
        content[f"{stem}-report.html"] = html_page(f"Rubber {stem}", parts)
        return content | {f"{stem}-{n}.png": image for n, image in pictures.items()}

    def save(
        self, folder: str | os.PathLike[str], stem: str | None = None
    ) -> list[Path]:
        """Writes all `files` into a folder that is there; all of them or none. Returns
        their paths.
        """
        from ..files import write_files

        paths = {
            Path(folder) / name: content for name, content in self.files(stem).items()
        }
        write_files(paths)
        return list(paths)


@in_si
def material(
    dma: Dma,
    reference: float | None = None,
    *,
    shift: AbstractShift | Literal["universal"] | None = None,
    vertical: bool | AbstractVertical | None = None,
    terms: int | None = None,
    equilibrium: bool | None = None,
    balance: float | None = None,
    temperature_error: float | None = None,
    poisson: float | None = None,
    law: LawName = "auto",
    name: str = "",
    citation: str = "",
    description: str = "",
    progress: Callable[[int, int], None] | None = None,
) -> MaterialFit:
    """A material from measured isotherms: `master_curve`, then `prony`, then a shift
    law.

    The material carries the vertical shifts that the data ask for by their evidence:
    those of entropy elasticity (`em.EntropicVertical`), a table (`em.VerticalTable`),
    or none where that is as likely as one in twenty. `misfit` says how close it comes
    to the data as measured.

    Args:
        dma: the measurement, with temperatures.
        reference: reference temperature [K]; by default the measured temperature
            nearest to 20 degC.
        shift: a shift law that is known, as for `master_curve`; the material carries
            it.
        vertical: True or False with or without vertical shifts; None lets the data
            choose. A law that is known, such as an `em.VerticalTable` of the factors
            beside the shift factors of a file, is 1 at `reference`, and the material
            carries it.
        terms: number of terms of the series, as for `prony`.
        equilibrium: whether there is an equilibrium modulus, as for `prony`.
        balance: weight of the storage modulus, as for `prony`.
        temperature_error: standard error of the temperature of an isotherm [K], as for
            `master_curve`.
        poisson: Poisson's ratio of the material.
        law: "WLF", "Arrhenius", "VFT", "table" (the shift factors themselves), "none",
            or "auto": WLF where it is within 0.1 decades of the shift factors, or
            within their uncertainty, and a table otherwise.
        name: name of the material.
        citation: source of the data.
        description: a line about the material.
        progress: `progress(done, total)` is called after shifting, vertical shifts and
            series.

    Returns:
        A `MaterialFit`; `save(folder)` writes the material, tables, cards and figures.

    Raises:
        InputError: as `master_curve` and `prony`, and for a law that is none of these.
    """
    check_law(law)
    check_dma(dma)
    if shift is not None and law != "auto":
        raise InputError(
            argument="law", got=law, accepted="left out where shift is given"
        )
    series: _Asked = {
        "terms": terms,
        "equilibrium": equilibrium,
        "balance": balance,
        "poisson": poisson,
        "name": name or _default_name(dma),
        "citation": citation or f"Measured data: {dma.source or 'arrays'}",
    }
    if not isinstance(vertical, (bool, AbstractVertical, type(None))):
        raise InputError(
            argument="vertical",
            got=vertical,
            accepted="True, False, None or a law of vertical shifts such as "
            "em.VerticalTable",
        )
    law_given = vertical if isinstance(vertical, AbstractVertical) else None
    asked = None if isinstance(vertical, AbstractVertical) else vertical
    report_step = reporter("fitting the material", progress)
    with quiet(FitWarning):  # the doubts that remain are listed below
        free = master_curve(
            dma if law_given is None else _lowered(dma, law_given),
            reference,
            law_given is None and asked is not False,
            shift=shift,
            temperature_error=temperature_error,
        )
        report_step(1, _STEPS)
        master = free if law_given is not None else _shifted(free, asked)
        report_step(2, _STEPS)
        fit = _fitted(master, law, series, description, law_given)
        report_step(3, _STEPS)
    fit = replace(fit, warnings=(*fit.warnings, *_misses(fit)))
    tell(warning for warning in fit.warnings if warning not in dma.warnings)
    return fit


def _default_name(dma: Dma) -> str:
    """A name of the material from that of its file."""
    stem = Path(dma.source.split(",")[0]).stem
    return re.sub(r"[^\w.-]+", "-", stem).strip("-.").lower() or "rubber"


def _lowered(dma: Dma, law: AbstractVertical) -> Dma:
    """The measurement with its moduli over b_T."""
    b, b_timed = _lift(law, dma.temperature), _lift(law, dma.time_temperature)
    return replace(
        dma,
        storage=dma.storage / b,
        loss=dma.loss / b,
        relaxation=dma.relaxation / b_timed,
    )


class _Asked(TypedDict):
    """What `prony` is asked for."""

    terms: int | None
    equilibrium: bool | None
    balance: float | None
    poisson: float | None
    name: str
    citation: str


def _fitted(
    master: MasterCurve,
    law: LawName,
    series: _Asked,
    description: str,
    vertical: AbstractVertical | None = None,
) -> MaterialFit:
    """Series and shift law of a master curve; `series` are the options of `prony`,
    `vertical` a law by which its moduli were divided.
    """
    dma = master.dma  # of one strain
    if vertical is not None:
        at_reference = float(vertical.b(master.reference))
        if abs(at_reference - 1) > _UNITY:
            raise InputError(
                argument="vertical",
                got=float(at_reference),
                accepted=f"1 at the reference temperature, {master.reference:.5g} K",
                hint="give its reference temperature, or divide its factors by that",
            )
        dma = replace(
            dma,
            storage=dma.storage * _lift(vertical, dma.temperature),
            loss=dma.loss * _lift(vertical, dma.temperature),
            relaxation=dma.relaxation * _lift(vertical, dma.time_temperature),
        )
    chosen, shift = shift_law(master, law)
    fit = prony(
        master,
        shift=shift,
        vertical=vertical_law(master) if vertical is None else vertical,
        **series,
    )
    return MaterialFit(
        with_misfit(fit.material, dma),
        master,
        fit,
        chosen,
        misfit(fit.material, dma),
        (*dma.warnings, *master.warnings, *fit.warnings),
        series["citation"],
        description or f"Fitted to {dma.summary()}",
    )


def _shifted(free: MasterCurve, vertical: bool | None) -> MasterCurve:
    """The master curve with the vertical shifts that the data ask for, by their
    evidence: none, entropic, or free.
    """
    if vertical is False or free.temperature.size < 2:
        return free
    if vertical is None and free.joint.weight > _OPEN:
        return free.without_vertical()
    return free.with_entropy() or free


def _tangent(material: Prony, celsius: float) -> str:
    """The loss tangent at a temperature and 10 Hz, and whether that was measured."""
    kelvin, omega, known = celsius + 273.15, 20 * np.pi, material.range
    try:
        here = material.at(kelvin)
    except InputError:  # beyond a table of shift factors
        return f"not known at {celsius:g} degC"
    within = here.range
    low, high = (within and within.omega) or (np.inf, 0.0)
    coldest, hottest = (known and known.temperature) or (kelvin, kelvin)
    measured = low <= omega <= high and coldest <= kelvin <= hottest
    said = f"{float(here.loss_tangent(omega)):.3g} at {celsius:g} degC"
    return said if measured else f"{said} (extrapolated)"


def _misses(fit: MaterialFit) -> Iterator[str]:
    """A warning where the material, by its shift law, is far from data that its series
    is close to.
    """
    of_series = {
        f"{name} modulus": getattr(fit.prony, f"{name}_residual")
        for name in ("storage", "loss", "relaxation")
    }
    if any(
        size > max(_MISSED, 2 * of_series[name]) for name, size in fit.misfit.items()
    ):
        law = fit.master.laws.get(fit.law)
        remedy = (
            (
                f" {fit.law} misses the shift factors by {law.rms:.2g} decades rms; "
                + advise("law table", {"law": "table"})
                + " keeps them."
            )
            if law
            else ""
        )
        yield (
            f"Material and shift law miss the data as measured: {_met(fit)} % rms "
            f"({_names(fit)}), while the series meets the shifted data." + remedy
        )


def _lifted(law: AbstractVertical | None, temperature: np.ndarray) -> str:
    """A law of vertical shifts in words."""
    if law is None:
        return "none: the data ask for none, or none were looked for"
    if isinstance(law, EntropicVertical):
        return "entropy elasticity, moduli as the temperature"
    return (
        "table in the material, by up to "
        f"{100 * float(np.abs(_lift(law, temperature) - 1).max()):.2g} %"
    )


def _met(fit: MaterialFit) -> str:
    return ", ".join(f"{100 * size:.2g}" for size in fit.misfit.values())


def _names(fit: MaterialFit) -> str:
    return ", ".join(name.removesuffix(" modulus") for name in fit.misfit)


# --------------------------------------------------------------------------------------
# A material from its hardness alone: a library spectrum scaled to the modulus that
# Shore A stands for.
# --------------------------------------------------------------------------------------

FACTOR = 2.0  # within which the moduli lie
_SHORE = (20.0, 90.0)  # where Gent's relation is of use
_READ = 3.0  # time after which a durometer is read [s],
_TEMPERATURE = 296.15  # and temperature [K] (ISO 48-4)
_SHIFTED = "moduli scaled from a library spectrum to Shore A by Gent's relation"


@in_si
def from_hardness(
    shore_a: Number,
    *,
    like: str | os.PathLike[str] | Prony = "sbr-gum-like",
    name: str = "",
) -> Prony:
    """A material known by its hardness only: the spectrum of another one, scaled to
    Gent's modulus for Shore A.

    An estimate: moduli lie within a factor of two, which the material's record of
    misfit holds for every band of friction, and the loss tangent is that of the other
    material.

    Args:
        shore_a: hardness [Shore A], 20 to 90.
        like: the material whose spectrum, shift law and Poisson's ratio it has: a name
            in the library, a file, or one; one without a shift law is known at 23 degC.
        name: name of the material.

    Returns:
        A `Prony` of the kind of `like`.

    Raises:
        InputError: for a hardness outside of the relation, and for a material that is
            no series.

    Source: A. N. Gent, Rubber Chemistry and Technology 31 (1958) 896-906: E = 0.0981
    (56 + 7.62336 S)/(0.137505 (254 - 2.54 S)) MPa, here the relaxation modulus after 3
    s at 23 degC.
    """
    a_text("name", name)
    hardness = float(scalar("shore_a", shore_a))
    if not _SHORE[0] <= hardness <= _SHORE[1]:
        raise InputError(
            argument="shore_a",
            got=float(hardness),
            accepted=f"{_SHORE[0]:g} to {_SHORE[1]:g}",
        )
    with typed_as("name_or_path", "like"):
        other = like if isinstance(like, Prony) else load_material(like)
    if not isinstance(other, Prony):
        raise InputError(
            argument="like",
            got=like,
            accepted="a Prony series, or the name of one in the library",
        )
    if not float(np.asarray(other.equilibrium)) > 0:
        raise InputError(
            argument="like",
            got=other.name or other,
            accepted="a rubber, with an equilibrium modulus",
            hint="hardness is read on what stays after seconds",
        )
    known = other.range if other.range is not None else Range(None, None)
    read = other.at(_TEMPERATURE) if other.shift is not None else other
    coldest, hottest = known.temperature or (_TEMPERATURE, _TEMPERATURE)
    if other.shift is None and not coldest <= _TEMPERATURE <= hottest:
        raise InputError(
            argument="like",
            got=other.name or other,
            accepted="known at 23 degC, where hardness is read",
            hint=f"it has no shift law, and is known from {coldest:.5g} to "
            f"{hottest:.5g} K",
        )
    factor = _gent(hardness) / float(np.asarray(read.tensile().relaxation(_READ)))
    low, high = known.omega or (
        0.1 / float(other.times.max()),
        10 / float(other.times.min()),
    )
    bands = np.geomspace(low, high, int(np.ceil(4 * np.log10(high / low))) + 1)
    rows = tuple((float(f"{omega:.4g}"), FACTOR - 1, FACTOR - 1) for omega in bands)
    return replaced(
        other,
        equilibrium=other.equilibrium * factor,
        moduli=other.moduli * factor,
        viscosity=other.viscosity * factor,
        range=known._replace(misfit=rows),
        name=name or f"shore-{significant(hardness)}-a",
        citation=f"{_SHIFTED}; spectrum of {other.name or 'another material'}",
    )


def _gent(hardness: float) -> float:
    """Young's modulus [Pa]."""
    return 0.0981e6 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))


def save_hardness(material: Prony, hardness: float, like: str, path: Path) -> None:
    """Writes such a material with its sources, graded as an estimate."""
    known: dict[str, Any] = dict(material_info(like).get("source", {}))
    note = (
        f"Gent's relation for {hardness:g} Shore A; moduli within a factor of "
        f"{FACTOR:g}, loss tangent of {like}."
    )
    sources = known | {
        "moduli": {"citation": material.citation, "grade": "estimated", "note": note}
    }
    info = {
        "description": f"Rubber of {hardness:g} Shore A: the spectrum of {like}, scaled",
        "source": sources,
    }
    save_material(material, path, info=info)
