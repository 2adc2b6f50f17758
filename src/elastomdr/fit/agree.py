"""Whether relaxation agrees with the storage and loss modulus that were measured beside
it.

Both follow from one spectrum. That of the dynamic moduli alone foretells the relaxation
modulus at times t with 1/t within their frequencies, and the ratio of what was measured
to that is 1 in the median, unless a unit, a kind of modulus or the sample differs.
"""

import numpy as np

from .joint import Joint
from .passive import closest
from .shifting import LN10
from .spectrum import RELAXATION, STORAGE

_FEWEST = 6  # values of storage and loss modulus of an isotherm that say anything
_FACTOR = 1.25  # between both, above which they contradict each other


def relaxation_excess(joint: Joint) -> float | None:
    """By which factor relaxation is above what storage and loss modulus make of it;
    None where they agree, or where nothing is to be compared.

    Isotherms are compared each by itself, so that no shift enters; where none has both,
    they are after the shift along the frequency: a vertical shift may have made up for
    the factor.
    """
    points, shifts = joint.shifts.points, joint.shifts
    slow = points.channel == RELAXATION
    if slow.all() or not slow.any():
        return None
    log10_a = shifts.horizontal(shifts.posterior.mean)[0]
    reduced = points.log_rate + LN10 * (log10_a[points.isotherm] + points.offset)
    for number, rate in (
        (points.isotherm, points.log_rate),
        (np.zeros_like(points.isotherm), reduced),
    ):
        each = [number == i for i in np.unique(number)]
        found = [
            _excess(rate[at], points.log_value[at], points.channel[at]) for at in each
        ]
        excess = np.concatenate(found)
        if excess.size:
            ratio = float(np.exp(np.median(excess)))
            return ratio if max(ratio, 1 / ratio) > _FACTOR else None
    return None


def _excess(
    log_rate: np.ndarray, log_value: np.ndarray, channel: np.ndarray
) -> np.ndarray:
    """ln of relaxation over what the closest spectrum of both dynamic moduli makes of
    it, at each time within reach.
    """
    dynamic = channel != RELAXATION
    if dynamic.sum() < _FEWEST:
        return np.zeros(0)
    low, high = log_rate[dynamic].min(), log_rate[dynamic].max()
    slow = ~dynamic & (log_rate > low) & (log_rate < high)
    if not slow.any():
        return np.zeros(0)
    found = closest(log_rate[dynamic], log_value[dynamic], channel[dynamic] == STORAGE)
    return (
        np.zeros(0)
        if found is None
        else log_value[slow] - found.log_relaxation(log_rate[slow])
    )
