"""Whether storage and loss modulus look exchanged, or in different units: which of it a passive material can have.

The storage modulus of a passive linear material rises with frequency, and by how much, its loss modulus says. How close
the closest such material (`fit.passive`) comes to an isotherm as its columns are read, and how close with both
exchanged or the loss modulus 10, 10^3 or 10^6 times smaller or larger, decides. A passive material is then off by 15
to 80 % rms, unless both moduli are nearly the same power law, omega^(1/2), which nothing tells from itself exchanged.
Where it is a loss modulus that is too small, only the rise of the storage modulus is off, by less than 10 % if the true
loss tangent is below 0.1.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..isotherms import group
from ..passive import closest
from .columns import Column, spelled

_MISFIT = 0.1  # rms relative misfit as read above which the columns are suspect, if
_CLOSER = 3.0  # another reading is so many times closer
_AS_CLOSE = 2.0  # misfit over that of the closest reading up to which another one may be meant as well
_FACTORS = (10.0, 0.1, 1e3, 1e-3, 1e6, 1e-6)  # of dyn/cm2, Pa, kPa, MPa: how much too large the loss modulus may be
_TOLERANCE = 1.5  # between temperatures of one isotherm [K], as for master curves
_LEAST_RANGE = 2.0  # ratio of the highest to the lowest frequency of an isotherm that says anything
_HOTTEST = 1e4  # what is beyond is damaged [K]
_LARGEST = 1e100  # modulus; what is beyond is damaged [Pa]
_FEWEST = 5  # points that say anything
_MOST = 100  # points of an isotherm that are looked at
Moduli = tuple[np.ndarray, np.ndarray]  # storage and loss modulus


def swapped(arrays: Mapping[str, np.ndarray], storage: Column, loss: Column, given: Mapping[str, str]) -> Iterator[str]:
    """A warning where the columns of storage and loss modulus look exchanged or in different units; `arrays` in SI
    units by role, units `given` by role.
    """
    rate = arrays["omega" if "omega" in arrays else "frequency"]
    temperature = arrays.get("temperature", np.zeros(rate.size))
    found = other_readings(temperature, rate, arrays["storage"], arrays["loss"])
    if not found:
        return
    s, l = storage.place + 1, loss.place + 1
    exchange = (
        f"Assumed are the names; if they are wrong, give columns={{'storage': {l}, 'loss': {s}}} "
        f"(--column storage={l} --column loss={s})."
    )
    factor = next((one for one in found if one), None)
    if factor is None:
        yield (
            f"{storage.title!r} and {loss.title!r} look exchanged: no passive material has them as they are named, and "
            f"one has them the other way round. {exchange}"
        )
        return
    units = " and ".join(f"{one.title!r} in {spelled(given[one.role])}" for one in (storage, loss))
    other_way = f" As close is one that has both exchanged. {exchange}" if None in found else ""
    yield (
        f"{storage.title!r} and {loss.title!r} suit no passive material as they are read, and one if the loss modulus "
        f"is {max(factor, 1 / factor):.0f} times {'smaller' if factor > 1 else 'larger'}: are their units mixed up? "
        f"Assumed are those of the file, {units}.{other_way}"
    )


def look_swapped(temperature: np.ndarray, omega: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> bool:
    """Whether isotherms suit no passive material as named, and one if storage and loss modulus are exchanged.

    Arrays of one shape in SI units. The median isotherm decides.
    """
    return None in other_readings(temperature, omega, storage, loss)


def other_readings(
    temperature: np.ndarray, omega: np.ndarray, storage: np.ndarray, loss: np.ndarray
) -> list[float | None]:
    """Which other readings suit a passive material, where none has storage and loss modulus as named; closest first.

    None is both exchanged, a number how many times too large the loss modulus is; of several the one closest to 1,
    for a loss modulus that is far too small suits any flat storage modulus. Arrays of one shape in SI units.
    """
    storage, loss = (np.minimum(x, _LARGEST) for x in (storage, loss))
    readings = [(loss, storage), *((storage, loss / factor) for factor in _FACTORS)]
    found = [(None, *_FACTORS)[i] for i in closer(temperature, omega, (storage, loss), readings, _MISFIT)]
    least = min((factor for factor in found if factor), key=lambda factor: max(factor, 1 / factor), default=None)
    return [one for one in found if one in (None, least)]


def closer(
    temperature: np.ndarray, omega: np.ndarray, named: Moduli, others: Sequence[Moduli], misfit: float
) -> list[int]:
    """Which of several other readings of storage and loss modulus suit a passive material, where they do not as named.

    The closest first, and others hardly less close. None where they do to `misfit` as named, or where no other one is
    several times closer.
    """
    if omega.size < _FEWEST or not others:
        return []
    number, mean = group(np.minimum(temperature, _HOTTEST), _TOLERANCE)
    isotherms = []
    for i in range(mean.size):
        at = np.flatnonzero(number == i)
        at = at[np.argsort(omega[at], kind="stable")]
        at = at[np.linspace(0, at.size - 1, min(at.size, _MOST)).astype(int)]
        if omega[at[-1]] / _LEAST_RANGE > omega[at[0]]:
            isotherms.append(at)

    def median(moduli: Moduli) -> float:
        return float(np.median([_misfit(omega[at], moduli[0][at], moduli[1][at]) for at in isotherms]))

    if not isotherms or not (own := median(named)) > misfit:
        return []
    distances = np.array([median(other) for other in others])
    near = distances * _CLOSER < own  # not where NaN
    near &= distances <= _AS_CLOSE * distances[near].min(initial=np.inf)
    return [int(i) for i in np.argsort(distances, kind="stable") if near[i]]


def _misfit(omega: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> float:
    """Rms relative distance of the closest passive material; NaN where none is found."""
    is_storage = np.arange(2 * omega.size) < omega.size
    found = closest(np.tile(np.log(omega), 2), np.log(np.concatenate([storage, loss])), is_storage)
    return np.nan if found is None else found.misfit
