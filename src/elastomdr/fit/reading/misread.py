"""Storage and loss modulus from the columns of a file, and whether other units or names would suit them better."""

from collections.abc import Iterator, Mapping

import numpy as np

from .columns import PAIRS, Column
from .swapped import closer

_MISFIT = 0.03  # rms relative misfit as read above which units are suspect, if others are several times closer


def moduli_roles(roles: Mapping[str, object]) -> tuple[str, str]:
    """The first two columns of `roles` that make both moduli."""
    return next((pair for pair in PAIRS if set(pair) <= roles.keys()), PAIRS[0])


def moduli(arrays: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Storage and loss modulus from whichever two columns there are, in SI units: G* = |G*| e^(i delta)."""
    one, other = moduli_roles(arrays)
    first, second = arrays[one], arrays[other]
    if other == "loss":
        return first, second
    if other == "phase":
        return first * np.cos(second), first * np.sin(second)
    storage = first if one == "storage" else first / np.hypot(1.0, second)
    return storage, storage * second


def misread(arrays: Mapping[str, np.ndarray], chosen: Mapping[str, Column], given: Mapping[str, str]) -> Iterator[str]:
    """A warning where a loss tangent or a phase angle suits no passive material as it is read, and one in another unit,
    or with storage and loss modulus exchanged; `arrays` in SI units by role.
    """
    one, other = moduli_roles(arrays)
    if other == "loss":
        return
    rate = arrays["omega" if "omega" in arrays else "frequency"]
    temperature = arrays.get("temperature", np.zeros(rate.size))
    readings = dict(_readings(arrays, one, other, given[other]))
    best = closer(temperature, rate, moduli(arrays), list(readings.values()), _MISFIT)
    if not best:
        return
    first, second = chosen[one].title, chosen[other].title
    said = {"%": "in %", "": "as a ratio"}.get(given[other], f"in {given[other]}")
    yield (
        f"{first!r} and {second!r} suit no passive material as they are named, and one if "
        f"{list(readings)[best[0]].format(first=first, second=second)}. Assumed are the names, and {second!r} {said}; "
        "if they are wrong, correct the title in the file."
    )


def _readings(
    arrays: Mapping[str, np.ndarray], one: str, other: str, unit: str
) -> Iterator[tuple[str, tuple[np.ndarray, np.ndarray]]]:
    """What the columns may be in place of what they are called, in words, and both moduli then."""
    first, second = arrays[one], arrays[other]
    if other == "phase":
        factor, meant = (180 / np.pi, "rad") if unit == "deg" else (np.pi / 180, "deg")
        if factor * second.max() < np.pi / 2:
            yield f"{{second!r}} is in {meant}", moduli({one: first, other: factor * second})
        return
    factor, meant = (100.0, "a ratio") if unit == "%" else (0.01, "in %")
    yield f"{{second!r}} is {meant}", moduli({one: first, other: factor * second})
    if one == "storage":
        yield "{first!r} is the loss modulus", (first / second, first)
        yield "{first!r} is the loss modulus and {second!r} storage over loss modulus", (first * second, first)
