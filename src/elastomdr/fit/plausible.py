"""What looks wrong in measured data: moduli no polymer has, columns that contradict each other."""

from collections.abc import Iterator, Sequence

import numpy as np

from .columns import Column, convert, spelled

_LARGEST = 3e10  # [Pa], above any polymer
_SMALLEST = 1e3  # [Pa], below what the stiffest point of any solid polymer or melt in its plateau has
_TEMPERATURES = (120.0, 700.0)  # [K]
_LEAST_TANGENT = 3e-3  # of a polymer; a thousandth of what rubbers and melts have, 0.03 to 3, is below
_LARGEST_TANGENT = 100.0  # in the median of a file: a melt in its terminal zone has more at its slow end only
_HOT = 473.15  # coldest temperature of a file, if in degC, above which it may well be kelvins [K]


def implausible(
    arrays: dict[str, np.ndarray], titles: dict[str, str], given: dict[str, str], user: bool
) -> Iterator[str]:
    """Warnings on values that a polymer hardly has; they say what was assumed. `titles` and units `given` by role."""
    whose = "as you say" if user else "as the file says"
    units = {titles[role]: spelled(given[role]) for role in titles}
    for role in ("storage", "absolute", "relaxation"):
        if role not in arrays:
            continue
        low, high = float(arrays[role].min()), float(arrays[role].max())
        if high > _LARGEST or high < _SMALLEST:
            side = "high" if high > _LARGEST else "low"
            yield (
                f"moduli from {low:.3g} to {high:.3g} Pa are implausibly {side} for a polymer; assumed is the unit, "
                f"{whose}: {', '.join(f'{title} in {unit}' for title, unit in units.items() if unit)}. Check it."
            )
    if "temperature" in arrays:
        low, high = float(arrays["temperature"].min()), float(arrays["temperature"].max())
        if low < _TEMPERATURES[0] or high > _TEMPERATURES[1] or (given["temperature"] == "degc" and low > _HOT):
            yield (
                f"temperatures from {low:.4g} to {high:.4g} K are implausible for a DMA; assumed is the unit of the "
                f"file, {spelled(given['temperature'])}. Check whether they are in degC or K."
            )
    if given.get("omega") == "hz":
        yield f"{titles['omega']!r} is an angular frequency in Hz: are Hz and rad/s mixed up? Assumed is Hz."


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
    arrays: dict[str, np.ndarray], others: dict[str, tuple[list[float], str]], dynamic: bool
) -> Iterator[str]:
    """Warnings on columns that contradict each other: omega and f, loss tangent and moduli."""
    if not dynamic:
        return
    if "frequency" in others and others["frequency"][1] and "omega" in arrays:
        ratio = _median(
            np.array(convert(others["frequency"][0], "frequency", others["frequency"][1])) / arrays["omega"]
        )
        if abs(ratio - 1) > 0.02:
            yield (
                f"frequency and angular frequency differ by a factor of {ratio:.3g} after conversion: are Hz and "
                "rad/s mixed up? Assumed is the angular frequency."
            )
    if "tangent" in others and "storage" in arrays and "loss" in arrays:
        ratio = _median(
            np.array(convert(others["tangent"][0], "tangent", others["tangent"][1]))
            * arrays["storage"]
            / arrays["loss"]
        )
        if abs(ratio - 1) > 0.1:
            yield (
                f"the loss tangent is {ratio:.3g} times loss over storage modulus: are their units mixed up? Assumed "
                "are the two moduli."
            )


def _median(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else 1.0
