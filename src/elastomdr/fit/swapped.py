"""Whether storage and loss modulus look exchanged: which way round a passive material can have them.

The storage modulus of a passive linear material rises with frequency, and by how much, its loss modulus says. How close
the closest such material (`fit.passive`) comes to an isotherm as its columns are named, and how close with both
exchanged, decides. A passive material exchanged is off by 20 to 70 % rms, unless both moduli are nearly the same power
law, omega^(1/2), which nothing tells apart.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from .columns import Column
from .isotherms import group
from .passive import closest

_MISFIT = 0.1  # rms relative misfit as named above which the columns are suspect, if
_CLOSER = 3.0  # the exchanged ones are so many times closer
_TOLERANCE = 1.5  # between temperatures of one isotherm [K], as for master curves
_LEAST_RANGE = 2.0  # ratio of the highest to the lowest frequency of an isotherm that says anything
_HOTTEST = 1e4  # what is beyond is damaged [K]
_FEWEST = 5  # points that say anything
_MOST = 100  # points of an isotherm that are looked at
Moduli = tuple[np.ndarray, np.ndarray]  # storage and loss modulus


def swapped(arrays: Mapping[str, np.ndarray], storage: Column, loss: Column) -> Iterator[str]:
    """A warning where the columns of storage and loss modulus look exchanged; `arrays` in SI units by role."""
    rate = arrays["omega" if "omega" in arrays else "frequency"]
    temperature = arrays.get("temperature", np.zeros(rate.size))
    if look_swapped(temperature, rate, arrays["storage"], arrays["loss"]):
        s, l = storage.place + 1, loss.place + 1
        yield (
            f"{storage.title!r} and {loss.title!r} look exchanged: no passive material has them as they are named, and "
            f"one has them the other way round. Assumed are the names; if they are wrong, give "
            f"columns={{'storage': {l}, 'loss': {s}}} (--column storage={l} --column loss={s})."
        )


def look_swapped(temperature: np.ndarray, omega: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> bool:
    """Whether isotherms suit no passive material as named, and one if storage and loss modulus are exchanged.

    Arrays of one shape in SI units. The median isotherm decides.
    """
    return closer(temperature, omega, (storage, loss), [(loss, storage)], _MISFIT) is not None


def closer(
    temperature: np.ndarray, omega: np.ndarray, named: Moduli, others: Sequence[Moduli], misfit: float
) -> int | None:
    """Which of several other readings of storage and loss modulus suits a passive material, where they do not as named.

    None where they do to `misfit`, or where no other one is several times closer.
    """
    if omega.size < _FEWEST or not others:
        return None
    number, mean = group(np.minimum(temperature, _HOTTEST), _TOLERANCE)
    found = []
    for i in range(mean.size):
        at = np.flatnonzero(number == i)
        at = at[np.argsort(omega[at], kind="stable")]
        at = at[np.linspace(0, at.size - 1, min(at.size, _MOST)).astype(int)]
        if omega[at[-1]] / _LEAST_RANGE > omega[at[0]]:
            found.append([_misfit(omega[at], storage[at], loss[at]) for storage, loss in (named, *others)])
    if not found:
        return None
    own, *distances = np.median(found, axis=0)
    best = int(np.argmin(distances))
    return best if own > misfit and own > _CLOSER * distances[best] else None


def _misfit(omega: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> float:
    """Rms relative distance of the closest passive material; NaN where none is found."""
    is_storage = np.arange(2 * omega.size) < omega.size
    found = closest(np.tile(np.log(omega), 2), np.log(np.concatenate([storage, loss])), is_storage)
    return np.nan if found is None else found.misfit
