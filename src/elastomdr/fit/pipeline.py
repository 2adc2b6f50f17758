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
from ..errors import InputError
from ..io.data import Dma, strains
from ..material.library import save_material
from ..material.prony import Prony
from ..material.tabulated import TabulatedModulus
from ..material.validity import Range
from .cards import abaqus_card, ansys_card, plain_card
from .chosen_law import check_law, rounded, shift_law
from .findings import TWO_SIGMA, AbstractFindings
from .master import MasterCurve, master_curve
from .misfit import misfit, with_misfit
from .series import PronyFit, prony
from .tables import master_csv, prony_csv, shifts_csv
from .tabulate import tabulate

if TYPE_CHECKING:
    from .._types import LawName
    from ..material.shift import AbstractShift

_LIFT = 0.03  # relative vertical shift above which its absence from the material is worth a warning
_MISSED = 0.1  # misfit above which a warning names the material without vertical shifts as well
_UNLIKELY = 0.01  # chance that there are no vertical shifts below which the data have decided that there are


@dataclass(frozen=True, eq=False, repr=False)
class MaterialFit(AbstractFindings):
    """A material, with the master curve and the series that it comes from.

    `misfit` has the rms relative residuals of the material, with its shift law, about the data as measured.
    """

    material: Prony
    master: MasterCurve
    prony: PronyFit
    law: str  # of `LAWS`
    misfit: dict[str, float]  # rms relative residual of the material, with its shift law, to the data as measured
    warnings: tuple[str, ...]
    citation: str
    description: str

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the material, as pairs of a name and a text."""
        yield "material", self.material.name
        yield from (("columns", text) for text in self.master.dma.columns)
        yield from ((name, text) for name, text in self.master.findings() if name != "warning")
        yield "shift law", "none in the material" if self.law == "none" else f"{self.law} in the material"
        yield from ((name, text) for name, text in self.prony.findings() if name != "warning")
        if self.misfit:
            parts = ", ".join(f"{name} {100 * size:.2g} %" for name, size in self.misfit.items())
            yield "misfit", f"of material and shift law against the data as measured: {parts} rms"
        for text in self.warnings:
            yield "warning", text

    def tabulated(self, *, per_decade: int = 8) -> TabulatedModulus:
        """The data themselves as a material for surfaces, with the shift law of this fit; see `MasterCurve.tabulated`.

        Args:
            per_decade: bands per decade of frequency.

        Returns:
            A table of moduli, of the name, citation, Poisson's ratio and shift law of `material`.
        """
        own = self.material
        return tabulate(self.master, per_decade, own.shift, own.poisson, own.name, own.citation)

    def info(self) -> dict[str, Any]:  # texts, numbers and tables
        """What a material file holds beside the numbers: description, range, sources with the quality of the fit."""
        master, fit = self.master, self.prony
        fitted = {"citation": f"{self.citation}, fitted by elastomdr {__version__} (em.fit)", "grade": "fitted here"}
        moduli: dict[str, Any] = fitted | {"note": self._note()}
        own = {"storage": fit.storage_residual, "loss": fit.loss_residual, "relaxation": fit.relaxation_residual}
        for name in ("storage", "loss"):  # of this material against the data, not of the series against shifted ones
            of = name if fit.storage.size else "relaxation"
            moduli[f"{name}_residual"] = rounded(self.misfit.get(f"{of} modulus", own[of]), 2)
        sources = {
            "moduli": moduli,
            "shift": (fitted if not self.master.given else self._given()) | {"note": self._shift_note()},
            "poisson": {"citation": "Assumed, not measured", "grade": "illustrative"},
            "range": {"citation": f"Span of the data: {self.citation}", "grade": "measured"},
        }
        if self.material.shift is None:
            del sources["shift"]
        return {
            "description": self.description,
            "reference_temperature": float(master.reference),
            "range": (self.material.range or Range(None, None)).table(),
            "source": sources,
        }

    def _note(self) -> str:
        fit = self.prony
        parts = [f"{fit.terms} terms over {np.log10(fit.window[1] / fit.window[0]):.1f} decades."]
        if amplitude := strains(self.master.dma.strain):
            parts.append(f"Measured at a strain amplitude of {amplitude}.")
        if not fit.storage.size:
            parts.append(f"From relaxation; both residuals are of the relaxation modulus. Loss: {fit.loss_known}.")
        if self.misfit:
            parts.append(f"Residuals are of the data as measured, by this file with its shift law; {self._own()}.")
        return " ".join([*parts, *self.warnings])

    def _own(self) -> str:
        """How close the series is to the shifted data, in words."""
        fit = self.prony
        sizes = {"storage": fit.storage_residual, "loss": fit.loss_residual, "relaxation": fit.relaxation_residual}
        met = ", ".join(f"{name} {100 * size:.2g} %" for name, size in sizes.items() if np.isfinite(size))
        lifted = ", with its vertical shifts," if np.abs(self.master.log10_b).max() > 1e-4 else ""
        return f"the master curve{lifted} is met to: {met} rms"

    def _given(self) -> dict[str, str]:
        estimated = "estimated" in self.master.given
        return {"citation": "Given with the data", "grade": "estimated" if estimated else "published fit"}

    def _shift_note(self) -> str:
        master = self.master
        if master.given:
            return f"{master.given}."
        worst = TWO_SIGMA * float(master.log10_a_std.max())
        parts = [f"{master.temperature.size} isotherms shifted jointly, log10 a_T to +- {worst:.2g} (95 %) at worst."]
        if self.law in master.laws:
            parts.append(f"The law misses them by {master.laws[self.law].rms:.2g} decades rms.")
        return " ".join(parts)

    def files(self, stem: str | None = None) -> dict[str, bytes]:
        """File name to content: the material, its cards, tables and figures. Cards that do not exist are left out."""
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
        return content | {f"{stem}-{name}.png": image for name, image in figures(self).items()}

    def save(self, folder: str | os.PathLike[str], stem: str | None = None) -> list[Path]:
        """Writes all `files` into a folder that is there; all of them or none. Returns their paths."""
        from ..files import write_files

        paths = {Path(folder) / name: content for name, content in self.files(stem).items()}
        write_files(paths)
        return list(paths)


def material(
    dma: Dma,
    reference: float | None = None,
    *,
    shift: AbstractShift | Literal["universal"] | None = None,
    vertical: bool | None = None,
    terms: int | None = None,
    equilibrium: bool | None = None,
    balance: float | None = None,
    poisson: float | None = None,
    law: LawName = "auto",
    name: str = "",
    citation: str = "",
    description: str = "",
) -> MaterialFit:
    """A material from measured isotherms: `master_curve`, then `prony`, then a shift law.

    A material has no vertical shift, and `misfit` says how close it comes to the data as measured. Where vertical
    shifts are large and the data leave open whether there are any, isotherms are shifted a second time without, and the
    material that comes closer to the data is the answer.

    Args:
        dma: the measurement, with temperatures.
        reference: reference temperature [K]; by default the measured temperature nearest to 20 degC.
        shift: a shift law that is known, as for `master_curve`; the material carries it.
        vertical: True or False with or without vertical shifts; None to choose as above.
        terms: number of terms of the series, as for `prony`.
        equilibrium: whether there is an equilibrium modulus, as for `prony`.
        balance: weight of the storage modulus, as for `prony`.
        poisson: Poisson's ratio of the material.
        law: "WLF", "Arrhenius", "VFT", "table" (the shift factors themselves), "none", or "auto": WLF where it is
            within 0.1 decades of the shift factors, or within their uncertainty, and a table otherwise.
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
    name = name or re.sub(r"[^\w.-]+", "-", Path(dma.source.split(",")[0]).stem).strip("-.").lower() or "rubber"
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
            name=name,
            citation=citation,
        )
        texts = (*dma.warnings, *master.warnings, *fit.warnings)
        about = description or f"Fitted to {dma.summary()}"
        return MaterialFit(
            with_misfit(fit.material, dma), master, fit, chosen, misfit(fit.material, dma), texts, citation, about
        )

    lifted = fitted(master_curve(dma, reference, True if vertical is None else vertical, shift=shift))
    size, celsius = _lift(lifted.master)
    if size <= _LIFT:
        return replace(lifted, warnings=(*lifted.warnings, *_misses(lifted)))
    there = _decided(lifted.master)
    flat = lifted.master.without_vertical() if vertical is None and not there else None
    # A series is hardly closer to the data than the smooth curve through them: where that is worse, none is made.
    promising = flat is not None and _squares(flat.noise) < _squares(lifted.misfit)
    plain = fitted(flat) if flat is not None and promising else lifted
    if _squares(plain.misfit) < _squares(lifted.misfit):
        return replace(plain, warnings=(*plain.warnings, _said(plain, lifted)))
    text = (
        f"Vertical shifts reach {100 * size:.2g} % (at {celsius:.3g} degC), and a material file has none: "
        "away from the reference temperature its moduli are off by as much."
    )
    if there:
        text += " The data leave no doubt of them: without, shift factors would make up for what is none of theirs."
    if there and vertical is None and max(lifted.misfit.values(), default=0.0) > _MISSED:
        text += _instead(lifted, fitted(lifted.master.without_vertical()))
    elif vertical or there:
        text += " vertical=False (--no-vertical) fits a material that has none from the start."
    return replace(lifted, warnings=(*lifted.warnings, text))


def _misses(fit: MaterialFit) -> Iterator[str]:
    """A warning where the material, by its shift law, is far from data that its series is close to."""
    own = {f"{name} modulus": getattr(fit.prony, f"{name}_residual") for name in ("storage", "loss", "relaxation")}
    if any(size > max(_MISSED, 2 * own[name]) for name, size in fit.misfit.items()):
        law = fit.master.laws.get(fit.law)
        remedy = (
            f" {fit.law} misses the shift factors by {law.rms:.2g} decades rms; --law table keeps them." if law else ""
        )
        yield (
            f"Material and shift law miss the data as measured: {_met(fit)} % rms ({_names(fit)}), while the series "
            f"meets the shifted data.{remedy}"
        )


def _lift(master: MasterCurve) -> tuple[float, float]:
    """The largest relative vertical shift that is known not to be zero, and the temperature it is at [degC]."""
    known = np.abs(master.log10_b) > TWO_SIGMA * master.log10_b_std
    log10_b = np.abs(master.log10_b * known)
    size = float(np.abs(np.expm1(np.log(10) * master.log10_b * known)).max())
    return size, float(master.temperature[log10_b.argmax()] - 273.15)


def _decided(master: MasterCurve) -> bool:
    """Whether the data decide that there are vertical shifts, and separate them from horizontal ones.

    Then shift factors found without any are wrong: they make up for a change of level, as that of entropy elasticity in
    a melt. A material of the right shift factors has its loss tangent where it belongs at every temperature, and only
    the level of its moduli is off; friction is a matter of the former.
    """
    return master.joint.weight < _UNLIKELY and not bool(master.ambiguous.any())


def _squares(sizes: dict[str, float]) -> float:
    return sum(size**2 for size in sizes.values())


def _said(plain: MaterialFit, lifted: MaterialFit) -> str:
    """What a fit with vertical shifts would have been, beside the one without."""
    own = lifted.prony.storage_residual, lifted.prony.loss_residual, lifted.prony.relaxation_residual
    met = ", ".join(f"{100 * size:.2g}" for size in own if np.isfinite(size))
    return (
        "Fitted without vertical shifts, which a material cannot have. With them (vertical=True, --vertical), shift "
        f"factors move by up to {_moved(plain, lifted):.2g} decades, the master curve is met to {met} % rms "
        f"({_names(lifted)}), but the moduli as measured only to {_met(lifted)} %."
    )


def _instead(lifted: MaterialFit, plain: MaterialFit) -> str:
    """What to do where the data have vertical shifts and the material, which has none, misses them."""
    return (
        f" The moduli as measured are met to {_met(lifted)} % rms only ({_names(lifted)}), worst far from the "
        "reference temperature: let that be where the material is used (--reference). Or give vertical=False "
        f"(--no-vertical): {_met(plain)} %, by shift factors moved by up to {_moved(plain, lifted):.2g} decades."
    )


def _moved(one: MaterialFit, other: MaterialFit) -> float:
    return float(np.abs(one.master.log10_a - other.master.log10_a).max())


def _met(fit: MaterialFit) -> str:
    return ", ".join(f"{100 * size:.2g}" for size in fit.misfit.values())


def _names(fit: MaterialFit) -> str:
    return ", ".join(name.removesuffix(" modulus") for name in fit.misfit)
