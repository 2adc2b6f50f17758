"""Shift laws that the user brings: a law, factors shifted by hand, or the universal law
of Williams, Landel and Ferry.

The universal law is log10 a_T = -17.44 (T - T_g)/(51.6 K + T - T_g). A material that is
passive has a storage modulus that rises with frequency as its loss modulus demands: a
sweep of temperature at one frequency therefore tells how fast a_T falls, and T_g is
where the closest passive material (`fit.passive`) is closest.
"""

from typing import Any

import numpy as np

from ..checks import significant
from ..errors import InputError
from ..io.data import Dma
from ..material.shift import VFT, WLF, AbstractShift, Arrhenius, ShiftTable
from .passive import closest

UNIVERSAL = 17.44, 51.6  # of C1 and C2 [K] about T_g (Williams, Landel & Ferry 1955)
_STEP = 1.0  # between the T_g that are tried [K],
_COLDEST = 80.0  # from so far below the data on [K]
_POLE = 1.0  # least distance of the data from the law's pole [K]
# rms relative misfit of the closest passive material above which the law is not that of
# the data
_MISFIT = 0.3
_MOST = 80  # points that are looked at
# by how much data may lie beyond a table [K]: its temperatures are rounded ones
_BEYOND = 3.0


def given_law(shift: Any, dma: Dma) -> tuple[AbstractShift | None, str]:
    """The law that a user gives, and where it comes from in words; (None, "") for None.

    Raises `InputError` for what is no law, and for "universal" where the data show no
    peak of the loss modulus.
    """
    if shift is None:
        return None, ""
    if isinstance(shift, AbstractShift):
        return shift, "as given"
    if isinstance(shift, str) and shift == "universal":
        glass = _glass_temperature(dma)
        at = (
            f"T_g = {glass - 273.15:.3g} degC, where storage and loss modulus suit "
            "each other best"
        )
        return WLF(
            *UNIVERSAL, round(glass, 1)
        ), f"estimated: universal constants about {at}"
    raise InputError(
        "shift must be a shift law (em.WLF, Arrhenius, VFT, ShiftTable, or "
        f"em.read_shifts of a file) or 'universal', got {shift!r:.80}."
    )


def log10_a(law: AbstractShift, temperature: np.ndarray) -> np.ndarray:
    """log10 a_T at temperatures [K]; a table goes on straight by some kelvin, since its
    temperatures are rounded.
    """
    temperature = np.asarray(temperature, dtype=float)
    if not isinstance(law, ShiftTable):
        return np.asarray(law.log10_a(temperature))
    known, slopes = np.asarray(law.temperature), np.asarray(law.slopes)
    inside = np.clip(temperature, known[0], known[-1])
    beyond = temperature - inside
    if (np.abs(beyond) > _BEYOND).any():
        far = temperature[np.abs(beyond).argmax()] - 273.15
        raise InputError(
            f"shift must reach over the data: its table has {known[0] - 273.15:.4g} "
            f"to {known[-1] - 273.15:.4g} degC, got data at {far:.4g} degC."
        )
    return np.asarray(law.log10_a(inside)) + beyond * np.where(
        beyond < 0, slopes[0], slopes[-1]
    )


def about(
    law: AbstractShift, reference: float, ends: tuple[float, float]
) -> AbstractShift:
    """The same law about another reference temperature; a table has entries there and
    at the `ends` of the data [K].
    """
    if isinstance(law, WLF):
        return law.at_reference(reference)
    if isinstance(law, VFT):
        return VFT(law.b, law.t0, reference)
    if isinstance(law, Arrhenius):
        return Arrhenius(law.energy, reference)
    known = np.asarray(law.temperature)  # pyright: ignore[reportAttributeAccessIssue]
    more = [
        kelvin for kelvin in (reference, *ends) if np.abs(known - kelvin).min() > 1e-6
    ]
    inside = [
        kelvin
        for kelvin in more
        if kelvin == reference or not known[0] < kelvin < known[-1]
    ]
    every = np.unique(np.append(known, inside))
    value = log10_a(law, every) - log10_a(law, np.array([reference]))
    return ShiftTable(every, np.minimum.accumulate(value))


def words(law: AbstractShift) -> str:
    """A law in a few words."""
    if isinstance(law, ShiftTable):
        known = np.asarray(law.temperature) - 273.15
        return f"table of {known.size} factors, {known[0]:.4g} to {known[-1]:.4g} degC"
    constants = [
        f"{name} = {significant(float(getattr(law, name)), 4)}"
        for name in law.__dataclass_fields__
    ]
    return f"{type(law).__name__}({', '.join(constants)})"


def _glass_temperature(dma: Dma) -> float:
    """T_g [K] of the universal law with which storage and loss modulus are closest to
    those of a passive material.
    """
    if not dma.omega.size:
        raise InputError(
            "shift must be a law for data in time, which tell no T_g: "
            "em.WLF(17.44, 51.6, T_g)."
        )
    order = np.argsort(dma.temperature, kind="stable")
    at = order[np.linspace(0, order.size - 1, min(order.size, _MOST)).astype(int)]
    coldest = float(dma.temperature.min())
    value = np.log(np.concatenate([dma.storage[at], dma.loss[at]]))
    tried = np.arange(coldest - _COLDEST, coldest + UNIVERSAL[1] - _POLE, _STEP)
    misfits = np.full(tried.size, np.inf)
    for i, kelvin in enumerate(tried):
        rate = np.log(dma.omega[at]) + np.log(10) * log10_a(
            WLF(*UNIVERSAL, kelvin), dma.temperature[at]
        )
        found = closest(np.tile(rate, 2), value, np.arange(2 * at.size) < at.size)
        misfits[i] = np.inf if found is None else found.misfit
    best = int(misfits.argmin())
    if not misfits[best] < _MISFIT or best in (0, tried.size - 1):
        raise InputError(
            "shift must be a law with its reference temperature for these data, whose "
            "storage and loss modulus suit the universal law with no T_g: "
            "em.WLF(17.44, 51.6, T_g) (--shift 'WLF(17.44, 51.6, -50degC)') with T_g "
            "of the material, got 'universal'."
        )
    near = slice(best - 1, best + 2)
    curve = np.polyfit(tried[near] - tried[best], misfits[near], 2)
    return float(
        tried[best] - np.clip(curve[1] / (2 * curve[0]), -_STEP, _STEP)
        if curve[0] > 0
        else tried[best]
    )
