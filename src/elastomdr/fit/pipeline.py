"""From measured isotherms to a material in one call, and the files that come of it."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .. import __version__
from ..checks import in_si
from ..errors import InputError
from ..io.data import Dma, strains
from ..material.library import save_material
from ..material.prony import Prony
from ..material.tabulated import TabulatedModulus
from ..material.validity import Range
from ..material.vertical import EntropicVertical
from .cards import abaqus_card, ansys_card, plain_card
from .chosen_law import check_law, rounded, shift_law, vertical_law
from .findings import TWO_SIGMA, AbstractFindings
from .master import MasterCurve, master_curve
from .misfit import misfit, with_misfit
from .series import PronyFit, prony
from .tables import master_csv, prony_csv, shifts_csv
from .tabulate import tabulate

if TYPE_CHECKING:
    from .._types import LawName
    from ..material.shift import AbstractShift

# chance that there are no vertical shifts above which the material has none
_OPEN = 0.05
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
        yield from (("columns", text) for text in self.master.dma.columns)
        yield from (
            (name, text) for name, text in self.master.findings() if name != "warning"
        )
        yield (
            "shift law",
            "none in the material"
            if self.law == "none"
            else f"{self.law} in the material",
        )
        yield "vertical shift", _lifted(self.material.vertical)
        yield from (
            (name, text) for name, text in self.prony.findings() if name != "warning"
        )
        if self.misfit:
            parts = ", ".join(
                f"{name} {100 * size:.2g} %" for name, size in self.misfit.items()
            )
            yield (
                "misfit",
                f"of material and shift law against the data as measured: {parts} rms",
            )
        for text in self.warnings:
            yield "warning", text

    def tabulated(self, *, per_decade: int = 8) -> TabulatedModulus:
        """The data themselves as a material for surfaces, with the shift law of this
        fit; see `MasterCurve.tabulated`.

        Args:
            per_decade: bands per decade of frequency.

        Returns:
            A table of moduli, of the name, citation, Poisson's ratio and shift law of
            `material`.
        """
        own = self.material
        return tabulate(
            self.master,
            per_decade,
            own.shift,
            own.vertical,
            own.poisson,
            own.name,
            own.citation,
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
        from .draws import draws

        return draws(self, n, seed)

    def info(self) -> dict[str, Any]:  # texts, numbers and tables
        """What a material file holds beside the numbers: description, range, sources
        with the quality of the fit.
        """
        master, fit, law = self.master, self.prony, self.material.shift
        fitted = {
            "citation": f"{self.citation}, fitted by elastomdr {__version__} (em.fit)",
            "grade": "fitted here",
        }
        moduli: dict[str, Any] = fitted | {"note": self._note()}
        own = {
            "storage": fit.storage_residual,
            "loss": fit.loss_residual,
            "relaxation": fit.relaxation_residual,
        }
        # of this material against the data, not of the series against shifted ones
        for name in ("storage", "loss"):
            of = name if fit.storage.size else "relaxation"
            moduli[f"{name}_residual"] = rounded(
                self.misfit.get(f"{of} modulus", own[of]), 2
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
                "note": f"{_lifted(self.material.vertical).capitalize()}."
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
                f"of shifts; {self._own()}."
            )
        return " ".join([*parts, *self.warnings])

    def _own(self) -> str:
        """How close the series is to the shifted data, in words."""
        fit = self.prony
        sizes = {
            "storage": fit.storage_residual,
            "loss": fit.loss_residual,
            "relaxation": fit.relaxation_residual,
        }
        met = ", ".join(
            f"{name} {100 * size:.2g} %"
            for name, size in sizes.items()
            if np.isfinite(size)
        )
        return f"the master curve is met to: {met} rms"

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

    def files(self, stem: str | None = None) -> dict[str, bytes]:
        """File name to content: the material, its cards, tables and figures. Cards that
        do not exist are left out.
        """
        from .figures import figures

        stem = self.material.name if stem is None else stem
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{stem}.toml"
            save_material(self.material, path, info=self.info())
            content = {path.name: path.read_bytes()}
        texts = {
            f"{stem}-master.csv": master_csv(self.master),
            f"{stem}-shifts.csv": shifts_csv(self.master),
            f"{stem}-prony.csv": prony_csv(self.prony),
            f"{stem}-plain.csv": plain_card(self.material),
            f"{stem}-abaqus.inp": abaqus_card(self.material),
            f"{stem}-ansys.mac": ansys_card(self.material),
        }
        content |= {name: text.encode() for name, text in texts.items()}
        return content | {
            f"{stem}-{name}.png": image for name, image in figures(self).items()
        }

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
    vertical: bool | None = None,
    terms: int | None = None,
    equilibrium: bool | None = None,
    balance: float | None = None,
    temperature_error: float | None = None,
    poisson: float | None = None,
    law: LawName = "auto",
    name: str = "",
    citation: str = "",
    description: str = "",
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
            choose.
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

    Returns:
        A `MaterialFit`; `save(folder)` writes the material, tables, cards and figures.

    Raises:
        InputError: as `master_curve` and `prony`, and for a law that is none of these.
    """
    check_law(law)
    if shift is not None and law != "auto":
        raise InputError(f"law must be left out where shift is given, got {law!r}.")
    name = (
        name
        or re.sub(r"[^\w.-]+", "-", Path(dma.source.split(",")[0]).stem)
        .strip("-.")
        .lower()
        or "rubber"
    )
    citation = citation or f"Measured data: {dma.source or 'arrays'}"

    def fitted(master: MasterCurve) -> MaterialFit:
        dma = master.dma  # of one strain
        chosen, own = shift_law(master, law)
        fit = prony(
            master,
            terms=terms,
            equilibrium=equilibrium,
            balance=balance,
            poisson=poisson,
            shift=own,
            vertical=vertical_law(master),
            name=name,
            citation=citation,
        )
        texts = (*dma.warnings, *master.warnings, *fit.warnings)
        about = description or f"Fitted to {dma.summary()}"
        return MaterialFit(
            with_misfit(fit.material, dma),
            master,
            fit,
            chosen,
            misfit(fit.material, dma),
            texts,
            citation,
            about,
        )

    free = master_curve(
        dma,
        reference,
        vertical is not False,
        shift=shift,
        temperature_error=temperature_error,
    )
    found = fitted(_shifted(free, vertical))
    return replace(found, warnings=(*found.warnings, *_misses(found)))


def _shifted(free: MasterCurve, vertical: bool | None) -> MasterCurve:
    """The master curve with the vertical shifts that the data ask for, by their
    evidence: none, entropic, or free.
    """
    if vertical is False or free.temperature.size < 2:
        return free
    if vertical is None and free.joint.weight > _OPEN:
        return free.without_vertical()
    return free.with_entropy() or free


def _misses(fit: MaterialFit) -> Iterator[str]:
    """A warning where the material, by its shift law, is far from data that its series
    is close to.
    """
    own = {
        f"{name} modulus": getattr(fit.prony, f"{name}_residual")
        for name in ("storage", "loss", "relaxation")
    }
    if any(size > max(_MISSED, 2 * own[name]) for name, size in fit.misfit.items()):
        law = fit.master.laws.get(fit.law)
        remedy = (
            (
                f" {fit.law} misses the shift factors by {law.rms:.2g} decades rms; "
                "--law table keeps them."
            )
            if law
            else ""
        )
        yield (
            f"Material and shift law miss the data as measured: {_met(fit)} % rms "
            f"({_names(fit)}), while the series meets the shifted data.{remedy}"
        )


def _lifted(law: Any) -> str:
    """A law of vertical shifts in words."""
    if law is None:
        return "none: the data ask for none, or none were looked for"
    if isinstance(law, EntropicVertical):
        return "entropy elasticity, moduli as the temperature"
    return (
        "table in the material, by up to "
        f"{100 * float(np.abs(law.factor[1:-1] - 1).max()):.2g} %"
    )


def _met(fit: MaterialFit) -> str:
    return ", ".join(f"{100 * size:.2g}" for size in fit.misfit.values())


def _names(fit: MaterialFit) -> str:
    return ", ".join(name.removesuffix(" modulus") for name in fit.misfit)
