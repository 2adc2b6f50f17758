"""Whether relaxation agrees with the storage and loss modulus that were measured beside it.

Both follow from one spectrum. That of the dynamic moduli alone foretells the relaxation modulus at times t with 1/t
within their frequencies, and the ratio of what was measured to that is 1 in the median, unless a unit, a kind of
modulus or the sample differs.
"""

import numpy as np
from scipy.optimize import nnls

from .joint import Joint
from .shifting import LN10
from .spectrum import RELAXATION, STORAGE

_FEWEST = 6  # values of storage and loss modulus of an isotherm that say anything
_PER_DECADE = 4  # relaxation times,
_MARGIN = 2.3  # how far beyond the frequencies ln(tau) goes on either side
_MOST_TIMES = 200
_LARGEST = 100.0  # |ln| of a modulus over the median one, and of omega tau: what is beyond is damaged
_FACTOR = 1.25  # between both, above which they contradict each other


def relaxation_excess(joint: Joint) -> float | None:
    """By which factor relaxation is above what storage and loss modulus make of it; None where they agree, or where
    nothing is to be compared.

    Isotherms are compared each by itself, so that no shift enters; where none has both, they are after the shift along
    the frequency: a vertical shift may have made up for the factor.
    """
    points, shifts = joint.shifts.points, joint.shifts
    slow = points.channel == RELAXATION
    if slow.all() or not slow.any():
        return None
    log10_a = shifts.horizontal(shifts.posterior.mean)[0]
    reduced = points.log_rate + LN10 * (log10_a[points.isotherm] + points.offset)
    for number, rate in ((points.isotherm, points.log_rate), (np.zeros_like(points.isotherm), reduced)):
        each = [number == i for i in np.unique(number)]
        found = [_excess(rate[at], points.log_value[at], points.channel[at]) for at in each]
        excess = np.concatenate(found)
        if excess.size:
            ratio = float(np.exp(np.median(excess)))
            return ratio if max(ratio, 1 / ratio) > _FACTOR else None
    return None


def _excess(log_rate: np.ndarray, log_value: np.ndarray, channel: np.ndarray) -> np.ndarray:
    """ln of relaxation over what the closest spectrum of both dynamic moduli makes of it, at each time within reach."""
    dynamic = channel != RELAXATION
    if dynamic.sum() < _FEWEST:
        return np.zeros(0)
    low, high = log_rate[dynamic].min(), log_rate[dynamic].max()
    slow = ~dynamic & (log_rate > low) & (log_rate < high)
    if not slow.any():
        return np.zeros(0)
    ends = high + _MARGIN, low - _MARGIN
    rates = np.linspace(*ends, min(int(_PER_DECADE * (ends[0] - ends[1]) / LN10) + 1, _MOST_TIMES))
    x = np.exp(np.clip(log_rate[dynamic, None] - rates, -_LARGEST, _LARGEST))
    storage = channel[dynamic, None] == STORAGE
    spring, dashpot = storage * 1.0, ~storage * x[:, -1:] / x[:, -1].max()
    matrix = np.hstack([np.where(storage, x / (x + 1 / x), 1 / (x + 1 / x)), spring, dashpot])
    level = np.median(log_value[dynamic])
    scale = np.clip(level - log_value[dynamic], -_LARGEST, _LARGEST)
    try:
        moduli, _ = nnls(matrix * np.exp(scale)[:, None], np.ones(matrix.shape[0]))
    except RuntimeError:  # too many iterations
        return np.zeros(0)
    past = np.exp(np.clip(rates - log_rate[slow, None], -_LARGEST, _LARGEST))
    foretold = np.exp(-past) @ moduli[: rates.size] + moduli[rates.size]
    return log_value[slow] - level - np.log(np.maximum(foretold, 1e-300))
