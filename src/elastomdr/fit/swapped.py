"""Whether storage and loss modulus look exchanged: which of both a passive material can
have.

The storage modulus of a passive material rises with frequency, and by how much, its
loss modulus says. How close the closest such material (`fit.passive`) comes to an
isotherm as named, and how close with both exchanged, decides. Nothing tells a power law
omega^(1/2) in both from itself exchanged.
"""

import re

import numpy as np

from ..errors import InputError
from ..io.data import Dma
from ..material.shift import AbstractShift
from .given_law import log10_a
from .isotherms import group
from .passive import closest

# rms relative misfit as named above which moduli are suspect, if exchanged they meet it
_MISFIT = 0.1
_CLOSER = 3.0  # and are so many times closer
_TOLERANCE = 1.5  # between temperatures of one isotherm [K], as for master curves
# ratio of the highest to the lowest frequency of an isotherm that says anything
_LEAST_RANGE = 2.0
_LARGEST = 1e100  # modulus [Pa], and temperature [K]; what is beyond is damaged
_FEWEST = 5  # points that say anything
_MOST = 100  # points of an isotherm that are looked at


def refuse_swapped(dma: Dma, law: AbstractShift | None = None) -> None:
    """Raises `InputError` where no passive material has the moduli as named, and one
    has them exchanged: the isotherms, or the master curve along a `law`.
    """
    swapped = look_swapped(dma.temperature, dma.omega, dma.storage, dma.loss)
    if law is not None and not swapped and dma.omega.size:
        reduced = dma.omega * 10 ** log10_a(law, dma.temperature)
        swapped = look_swapped(np.zeros(reduced.size), reduced, dma.storage, dma.loss)
    if swapped:
        said = (
            f" (read were {'; '.join(text.split(';')[0] for text in dma.columns)})"
            if dma.columns
            else ""
        )
        places = [
            re.search(rf"\b{name} from (\d+)", said) for name in ("loss", "storage")
        ]
        new, old = (
            (place[1] for place in places if place) if all(places) else ("N", "M")
        )
        what = (
            ""
            if all(places)
            else ", N the column read as loss, M the one read as storage"
        )
        raise InputError(
            f"storage and loss modulus of {dma.source!r} look exchanged: no passive "
            "material has them as they are named, and one has them the other way "
            f"round{said}. Exchange them: columns={{'storage': {new}, 'loss': {old}}} "
            f"(--column storage={new} --column loss={old}){what}."
        )


def look_swapped(
    temperature: np.ndarray, omega: np.ndarray, storage: np.ndarray, loss: np.ndarray
) -> bool:
    """Whether isotherms suit no passive material as named, and one with storage and
    loss modulus exchanged.

    Arrays of one shape in SI units. The median isotherm decides.
    """
    if omega.size < _FEWEST:
        return False
    storage, loss = (np.minimum(x, _LARGEST) for x in (storage, loss))
    kelvin = np.where(np.isfinite(temperature), np.minimum(temperature, 1e4), 0.0)
    number, mean = group(kelvin, _TOLERANCE)
    named, exchanged = [], []
    for i in range(mean.size):
        at = np.flatnonzero(number == i)
        at = at[np.argsort(omega[at], kind="stable")]
        at = at[np.linspace(0, at.size - 1, min(at.size, _MOST)).astype(int)]
        if omega[at[-1]] / _LEAST_RANGE > omega[at[0]]:
            named.append(_misfit(omega[at], storage[at], loss[at]))
            exchanged.append(_misfit(omega[at], loss[at], storage[at]))
    if not named or not float(np.median(named)) > _MISFIT:
        return False
    other = float(np.median(exchanged))
    return other < _MISFIT and other * _CLOSER < float(np.median(named))


def _misfit(omega: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> float:
    """Rms relative distance of the closest passive material; NaN where none is
    found.
    """
    is_storage = np.arange(2 * omega.size) < omega.size
    found = closest(
        np.tile(np.log(omega), 2), np.log(np.concatenate([storage, loss])), is_storage
    )
    return np.nan if found is None else found.misfit
