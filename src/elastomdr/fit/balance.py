"""How much storage modulus, loss modulus and relaxation count against each other in a Prony series.

Each counts by its scatter. A passive material's moduli determine each other (Kramers and Kronig), so that data may
contradict themselves; the loss modulus is then the worse one in a solid: an error dphi of the phase angle phi changes
it by dphi/tan(phi), relatively, and the storage modulus by dphi tan(phi).
"""

import numpy as np

from .spectrum import LOSS, STORAGE, Points

_RATIO = 3.0  # largest ratio between the weights of two kinds of modulus: a series has to meet all of them
_CONTRADICTION = 0.1  # misfit of a smooth spectrum above which storage and loss modulus contradict each other, if
_SYSTEMATIC = 2.0  # it is so many times the scatter between neighbouring points
_STORAGE_FIRST = 20.0  # times that the storage modulus then counts for more: an error of phase hardly touches it
_LEAST_NOISE = 0.002  # relative standard deviation below which residuals are not trusted to be noise


def weigh(noise: np.ndarray, points: Points, balance: float | None) -> tuple[np.ndarray, bool]:
    """Standard deviations that the kinds of modulus are weighed with, and whether the moduli contradict each other.

    They are the scatter between neighbouring points, where that is less than the misfit of a smooth spectrum, within
    limits. Where the misfit is large and not scatter, storage and loss modulus contradict each other.
    """
    present, scatter = np.unique(points.channel), _scatter(points)
    both, worst = LOSS in present and STORAGE in present, present[noise[present].argmax()]
    systematic = bool(both and noise[worst] > max(_CONTRADICTION, _SYSTEMATIC * scatter[worst]))
    if systematic and balance is None:
        median = {c: np.median(points.log_value[points.channel == c]) for c in (STORAGE, LOSS)}
        balance = _STORAGE_FIRST if median[STORAGE] > median[LOSS] else None
    if both and balance is not None:
        noise = noise.copy()
        noise[LOSS] = noise[[STORAGE, LOSS]].max()
        noise[STORAGE] = noise[LOSS] / balance
        return noise, systematic
    noise = np.maximum(np.fmin(noise, scatter), _LEAST_NOISE)
    return np.maximum(noise, noise[present].max() / _RATIO), systematic


def _scatter(points: Points) -> np.ndarray:
    """Standard deviation of ln(value) about the line between its neighbours in frequency, by channel, or NaN."""
    found = np.full(3, np.nan)
    for channel in np.unique(points.channel):
        at = np.flatnonzero(points.channel == channel)
        at = at[np.argsort(points.log_rate[at], kind="stable")]
        if at.size < 5:
            continue
        x, y = points.log_rate[at], points.log_value[at]
        part = (x[1:-1] - x[:-2]) / np.maximum(x[2:] - x[:-2], 1e-12)
        off = (y[1:-1] - (1 - part) * y[:-2] - part * y[2:]) / np.sqrt(1 + part**2 + (1 - part) ** 2)
        found[channel] = 1.4826 * np.median(np.abs(off))  # an outlier is not scatter
    return found
