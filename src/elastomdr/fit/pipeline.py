"""From measured isotherms to a material in one call, and the files that come of it."""

import os
import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__
from ..errors import InputError
from ..material.library import save_material
from ..material.prony import Prony
from ..material.shift import ShiftTable
from ..material.validity import Range
from .as_used import as_used
from .cards import abaqus_card, ansys_card, plain_card
from .data import Dma
from .findings import TWO_SIGMA, AbstractFindings
from .master import MasterCurve, master_curve
from .series import TEMPERATURE_DIGITS, PronyFit, prony
from .tables import master_csv, prony_csv, shifts_csv

LAWS = ("auto", "WLF", "Arrhenius", "VFT", "table", "none")
_DIGITS = 8  # of a law in the material: what follows is rounding, and differs between machines
_LIFT = 0.03  # relative vertical shift above which its absence from the material is worth a warning
_MISSED = 0.1  # relative residual as used above which the material without vertical shifts is told beside it
_UNLIKELY = 0.01  # chance that there are no vertical shifts below which the data have decided that there are


@dataclass(frozen=True, eq=False, repr=False)
class MaterialFit(AbstractFindings):
    """A material with the master curve and the series that it comes from."""

    material: Prony
    master: MasterCurve
    prony: PronyFit
    law: str  # of `LAWS`
    as_used: dict[str, float]  # rms relative residual of the material, with its shift law, to the data as measured
    warnings: tuple[str, ...]
    citation: str
    description: str

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the material, as pairs of a name and a text."""
        yield "material", self.material.name
        yield from (("columns", text) for text in self.master.dma.columns)
        yield from ((name, text) for name, text in self.master.findings() if name != "warning")
        yield "shift law", f"{self.law} in the material" if self.law != "none" else "none in the material"
        yield from ((name, text) for name, text in self.prony.findings() if name != "warning")
        if self.as_used:
            parts = ", ".join(f"{name} {100 * size:.2g} %" for name, size in self.as_used.items())
            yield "as used", f"material and shift law against the data as measured: {parts} rms"
        for text in self.warnings:
            yield "warning", text

    def info(self) -> dict[str, Any]:
        """What a material file holds beside the numbers: description, range, sources with the quality of the fit."""
        master, fit = self.master, self.prony
        fitted = {"citation": f"{self.citation}, fitted by elastomdr {__version__} (em.fit)", "grade": "fitted here"}
        moduli: dict[str, Any] = fitted | {"note": self._note()}
        own = {"storage": fit.storage_residual, "loss": fit.loss_residual, "relaxation": fit.relaxation_residual}
        for name in ("storage", "loss"):  # of this material against the data, not of the series against shifted ones
            of = name if fit.storage.size else "relaxation"
            moduli[f"{name}_residual"] = _round(self.as_used.get(f"{of} modulus", own[of]), 2)
        sources = {
            "moduli": moduli,
            "shift": fitted | {"note": self._shift_note()},
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
        if not fit.storage.size:
            parts.append(f"From relaxation; both residuals are of the relaxation modulus. Loss: {fit.loss_known}.")
        if self.as_used:
            parts.append(f"Residuals are of the data as measured, by this file with its shift law; {self._own()}.")
        return " ".join([*parts, *self.warnings])

    def _own(self) -> str:
        """How close the series is to the shifted data, in words."""
        fit = self.prony
        sizes = {"storage": fit.storage_residual, "loss": fit.loss_residual, "relaxation": fit.relaxation_residual}
        met = ", ".join(f"{name} {100 * size:.2g} %" for name, size in sizes.items() if np.isfinite(size))
        lifted = ", with its vertical shifts," if np.abs(self.master.log10_b).max() > 1e-4 else ""
        return f"the master curve{lifted} is met to: {met} rms"

    def _shift_note(self) -> str:
        master = self.master
        worst = TWO_SIGMA * float(master.log10_a_std.max())
        parts = [f"{master.temperature.size} isotherms shifted jointly, log10 a_T to +- {worst:.2g} (95 %) at worst."]
        if self.law in master.laws:
            parts.append(f"The law misses them by {master.laws[self.law].rms:.2g} decades rms.")
        return " ".join(parts)

    def files(self, stem: str | None = None) -> dict[str, bytes]:
        """File name to content: the material, its cards, tables and figures. Cards that do not exist are left out."""
        from ..results.fit_figure import figures

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
        from ..results.table import write_files

        paths = {Path(folder) / name: content for name, content in self.files(stem).items()}
        write_files(paths)
        return list(paths)


def material(
    dma: Dma,
    reference: Any = None,
    *,
    vertical: bool | None = None,
    terms: int | None = None,
    equilibrium: bool | None = None,
    balance: float | None = None,
    poisson: float | None = None,
    law: str = "auto",
    name: str = "",
    citation: str = "",
    description: str = "",
) -> MaterialFit:
    """A material from measured isotherms: `master_curve`, then `prony`, then a shift law.

    `law` is "WLF", "Arrhenius", "VFT", "table" (the shift factors themselves), "none", or "auto": WLF where it is
    within 0.1 decades of the shift factors, or within what they are known to, a table otherwise. A material has
    no vertical shift, and `as_used` says how close it comes to the data as measured. Where vertical shifts are large,
    and it is not for the data to say whether there are any, isotherms are shifted a second time without, and the
    material that comes closer to the data is the answer (`vertical=None`; True or False settle it). Other arguments as
    for `master_curve` and `prony`; `citation` is the source of the data. Raises `InputError` as they do.
    """
    if law not in LAWS:
        raise InputError(f"law must be one of {', '.join(LAWS)}, got {law!r}.")
    name = name or re.sub(r"[^\w.-]+", "-", Path(dma.source.split(",")[0]).stem).strip("-.").lower() or "rubber"
    citation = citation or f"Measured data: {dma.source or 'arrays'}"

    def fitted(master: MasterCurve) -> MaterialFit:
        chosen = _choose(master) if law == "auto" else law
        shift = None if chosen == "none" else _table(master) if chosen == "table" else _law(master, chosen)
        fit = prony(
            master,
            terms=terms,
            equilibrium=equilibrium,
            balance=balance,
            poisson=poisson,
            shift=shift,
            name=name,
            citation=citation,
        )
        texts = (*dma.warnings, *master.warnings, *fit.warnings)
        said = description or f"Fitted to {dma.summary()}"
        return MaterialFit(fit.material, master, fit, chosen, as_used(fit.material, dma), texts, citation, said)

    lifted = fitted(master_curve(dma, reference, True if vertical is None else vertical))
    size, celsius = _lift(lifted.master)
    if size <= _LIFT:
        return replace(lifted, warnings=(*lifted.warnings, *_misses(lifted)))
    there = _decided(lifted.master)
    flat = lifted.master.without_vertical() if vertical is None and not there else None
    # A series is hardly closer to the data than the smooth curve through them: where that is worse, none is made.
    promising = flat is not None and _squares(flat.noise) < _squares(lifted.as_used)
    plain = fitted(flat) if flat is not None and promising else lifted
    if _squares(plain.as_used) < _squares(lifted.as_used):
        return replace(plain, warnings=(*plain.warnings, _said(plain, lifted)))
    text = (
        f"Vertical shifts reach {100 * size:.2g} % (at {celsius:.3g} degC), and a material file has none: "
        "away from the reference temperature its moduli are off by as much."
    )
    if there:
        text += " The data leave no doubt of them: without, shift factors would make up for what is none of theirs."
    if there and vertical is None and max(lifted.as_used.values(), default=0.0) > _MISSED:
        text += _instead(lifted, fitted(lifted.master.without_vertical()))
    elif vertical or there:
        text += " vertical=False (--no-vertical) fits a material that has none from the start."
    return replace(lifted, warnings=(*lifted.warnings, text))


def _misses(fit: MaterialFit) -> Iterator[str]:
    """A warning where the material, by its shift law, is far from data that its series is close to."""
    own = {f"{name} modulus": getattr(fit.prony, f"{name}_residual") for name in ("storage", "loss", "relaxation")}
    if any(size > max(_MISSED, 2 * own[name]) for name, size in fit.as_used.items()):
        law = fit.master.laws.get(fit.law)
        said = (
            f" {fit.law} misses the shift factors by {law.rms:.2g} decades rms; --law table keeps them." if law else ""
        )
        yield (
            f"Material and shift law miss the data as measured: {_met(fit)} % rms ({_names(fit)}), while the series "
            f"meets the shifted data.{said}"
        )


def _lift(master: MasterCurve) -> tuple[float, float]:
    """The largest relative vertical shift that is known not to be zero, and the temperature it is at [degC]."""
    known = np.abs(master.log10_b) > TWO_SIGMA * master.log10_b_std
    log10_b = np.abs(master.log10_b * known)
    size = float(np.abs(np.expm1(np.log(10) * master.log10_b * known)).max())
    return size, float(master.temperature[log10_b.argmax()] - 273.15)


def _decided(master: MasterCurve) -> bool:
    """Whether the data themselves say that there are vertical shifts, and tell them from horizontal ones.

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
    return ", ".join(f"{100 * size:.2g}" for size in fit.as_used.values())


def _names(fit: MaterialFit) -> str:
    return ", ".join(name.removesuffix(" modulus") for name in fit.as_used)


def _choose(master: MasterCurve) -> str:
    if master.temperature.size < 2:
        return "none"
    if master.temperature.size == 2:
        return "Arrhenius"
    return "WLF" if master.laws["WLF"].holds else "table"


def _law(master: MasterCurve, name: str) -> Any:
    if name not in master.laws:
        raise InputError(
            f"law must be one that these data allow ({', '.join([*master.laws, 'none'])}), got {name!r}: there are "
            f"{master.temperature.size} temperatures."
        )
    law = master.laws[name].law
    return type(law)(*(_round(float(getattr(law, field)), _DIGITS) for field in law.__dataclass_fields__))


def _table(master: MasterCurve) -> ShiftTable:
    """The shift factors as a table, with the reference temperature as one of its entries."""
    if master.temperature.size < 2:
        raise InputError("law must be 'none' for data of one temperature, got 'table'.")
    away = np.abs(master.temperature - master.reference) > 0.5
    temperature = np.append(master.temperature[away], master.reference).round(TEMPERATURE_DIGITS)
    log10_a = np.append(master.log10_a[away], 0.0).round(_DIGITS)
    order = np.argsort(temperature)
    return ShiftTable(temperature[order], np.minimum.accumulate(log10_a[order]))


def _round(value: float, digits: int) -> float:
    return float(f"{value:.{digits - 1}e}")
