"""What looks wrong in measured data: moduli no polymer has, columns that contradict each other."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..data import Dma
from .columns import MODULI, Column, spelled
from .misread import moduli_roles

_LARGEST = 3e10  # [Pa], above any polymer
_SMALLEST = 1e3  # [Pa], below what the stiffest point of any solid polymer or melt in its plateau has
_SOFTEST = 1e4  # [Pa], below what a solid polymer has that is no gel
_FLAT = 0.3  # lowest over highest relaxation modulus of a solid in its plateau
TEMPERATURES = (120.0, 700.0)  # [K]
_LEAST_TANGENT = 3e-3  # of a polymer; a thousandth of what rubbers and melts have, 0.03 to 3, is below
_LARGEST_TANGENT = 100.0  # in the median of a file: a melt in its terminal zone has more at its slow end only
_CONTRADICTION = 0.1  # relative difference in the median of two columns that say the same
_HOT = 200.0  # coldest number of a file in degC above which all may well be kelvins, up to
_KELVINS = 450.0  # the hottest
_MELT = 1e6  # [Pa], above the median of a melt, which has moreover
_FLOWS = 0.3  # more than this loss tangent in the median


def implausible(
    arrays: dict[str, np.ndarray], titles: dict[str, str], given: dict[str, str], user: bool, elastic: bool
) -> Iterator[str]:
    """Warnings on values that a polymer hardly has; they say what was assumed. `titles` and units `given` by role;
    `elastic` says whether the material is a solid.
    """
    whose = "as you say" if user else "as the file says"
    units = {titles[role]: spelled(given[role]) for role in titles}
    for role in ("storage", "absolute", "relaxation"):
        if role not in arrays:
            continue
        low, high = float(arrays[role].min()), float(arrays[role].max())
        if high > _LARGEST or high < (_SOFTEST if elastic else _SMALLEST):
            side = "high" if high > _LARGEST else "low"
            what = "polymer" if high > _LARGEST or high < _SMALLEST else "solid polymer, unless it is a gel"
            yield (
                f"moduli from {low:.3g} to {high:.3g} Pa are implausibly {side} for a {what}; assumed is the unit, "
                f"{whose}: {', '.join(f'{title} in {unit}' for title, unit in units.items() if unit)}. Check it."
            )
    if given.get("omega") == "hz":
        yield f"{titles['omega']!r} is an angular frequency in Hz: are Hz and rad/s mixed up? Assumed is Hz."


def implausible_temperatures(dma: Dma) -> Iterator[str]:
    """A warning on temperatures of all isotherms together that hardly anybody measures at."""
    temperature = np.concatenate([dma.temperature, dma.time_temperature])
    temperature = temperature[np.isfinite(temperature)]
    unit = dma.units.get("temperature")
    if not temperature.size or unit is None:
        return
    low, high = float(temperature.min()), float(temperature.max())
    melt = (not dma.frequency.size or is_melt(dma.storage, dma.loss, np.zeros(0))) and (
        not dma.time.size or is_melt(dma.storage, dma.loss, dma.relaxation)
    )
    kelvins = kelvins_as_celsius(temperature - 273.15, melt) if unit == "degC" else ""
    if low < TEMPERATURES[0] or high > TEMPERATURES[1] or kelvins:
        yield (
            f"temperatures from {low:.4g} to {high:.4g} K are implausible for a DMA{kelvins}; assumed is the unit of "
            f"the file, {unit}. Check whether they are in degC or K."
        )


def kelvins_as_celsius(celsius: np.ndarray, melt: bool) -> str:
    """Why numbers given in degC look like kelvins, in words; an empty text where they do not.

    All of them lie where kelvins of an ordinary measurement would, above 200 degC, and either they all end in .15, as
    kelvins do that were whole degrees Celsius, or nothing is seen of a melt, which is what most polymers are there.
    """
    if not celsius.size or celsius.min() < _HOT or celsius.max() > _KELVINS:
        return ""
    if np.all(np.abs(celsius % 1 - 0.15) < 1e-6):
        return f" (the numbers {celsius.min():g} to {celsius.max():g} all end in .15, as kelvins do)"
    return "" if melt else " (as kelvins they would be ordinary)"


def is_melt(storage: np.ndarray, loss: np.ndarray, relaxation: np.ndarray) -> bool:
    """Whether a material flows as a melt does: soft, with a large loss tangent or much relaxation, in the median."""
    if relaxation.size:
        return bool(np.median(relaxation) < _MELT and relaxation.min() < _FLAT * relaxation.max())
    return bool(np.median(storage) < _MELT and np.median(loss / storage) > _FLOWS)


def is_elastic(storage: np.ndarray, loss: np.ndarray, relaxation: np.ndarray) -> bool:
    """Whether a material is a solid: mostly more storage than loss modulus, or relaxation that hardly falls."""
    if relaxation.size:
        return bool(relaxation.min() > _FLAT * relaxation.max())
    return bool(np.median(loss / storage) < 1)


def mixed_up(storage: np.ndarray, loss: np.ndarray, columns: Sequence[Column], given: dict[str, str]) -> Iterator[str]:
    """A warning on a ratio of both moduli that a polymer hardly has; `columns` are those that they come from."""
    ratio = float(np.median(loss / storage))
    if not _LEAST_TANGENT < ratio < _LARGEST_TANGENT:
        said = " and ".join(
            f"{one.title!r} {f'in {unit}' if (unit := spelled(given[one.role])) else 'as a ratio'}" for one in columns
        )
        yield (
            f"the loss modulus is {ratio:.3g} times the storage modulus in the median, which is implausible: are "
            f"their units mixed up? Assumed are those of the file, {said}."
        )


def inconsistent(
    omega: np.ndarray | None,
    storage: np.ndarray,
    loss: np.ndarray,
    others: Mapping[str, np.ndarray],
    chosen: Mapping[str, Column],
) -> Iterator[str]:
    """Warnings on columns, the `others` by role, that contradict those which are read; all in SI units."""
    if "frequency" in others and omega is not None:
        ratio = _median(others["frequency"] / omega)
        if abs(ratio - 1) > 0.02:
            yield (
                f"frequency and angular frequency differ by a factor of {ratio:.3g} after conversion: are Hz and "
                "rad/s mixed up? Assumed is the angular frequency."
            )
    from_others = {
        "tangent": ("loss tangent", "loss over storage modulus", loss / storage),
        "absolute": ("absolute modulus", "that of storage and loss modulus", np.hypot(storage, loss)),
        "phase": ("phase angle", "that of storage and loss modulus", np.arctan2(loss, storage)),
        "storage": ("storage modulus", "that of the other columns", storage),
        "loss": ("loss modulus", "that of the other columns", loss),
    }
    read = " and ".join(f"{chosen[role].title!r}" for role in moduli_roles(chosen) if role in chosen)
    for role in (role for role in MODULI if role in others):
        name, of, expected = from_others[role]
        ratio = _median(others[role] / expected)
        if abs(ratio - 1) > _CONTRADICTION:
            yield (
                f"the {name} {chosen[role].title!r} is {ratio:.3g} times {of} in the median: are their units mixed up? "
                f"Assumed are {read}."
            )


def _median(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else 1.0
