"""exp(-z) and the means of it that a step takes: (1 - exp(-z))/z and its relatives, to
full accuracy for z >= 0.
"""

from __future__ import annotations

import math

from ..arrays import xp
from ..checks import Array

# the first term left out is below 1e-17 of the sum
_PHI2 = [(-1.0) ** k / math.factorial(k + 2) for k in range(17)]


def phi1(y: Array) -> Array:
    """(1 - exp(-y))/y for y >= 0."""
    safe = xp.where(y > 0, y, 1.0)
    return xp.where(y > 0, -xp.expm1(-safe) / safe, 1 - 0.5 * y)


def phi2(y: Array) -> Array:
    """(1 - phi1(y))/y for y >= 0, by its series where the difference would lose
    digits.
    """
    # not min and max: at y = 1 they halve slopes
    small, large = xp.where(y < 1, y, 1.0), xp.where(y < 1, 1.0, y)
    return xp.where(y < 1, _phi2_series(small), (1 - phi1(large)) / large)


def _phi2_series(y: Array) -> Array:
    """(1 - phi1(y))/y for 0 <= y <= 1: sum_k (-y)^k/(k + 2)!, by Horner's rule."""
    total = xp.full_like(y, _PHI2[-1])
    for coefficient in _PHI2[-2::-1]:
        total *= y  # in place on NumPy
        total += coefficient
    return total


def ramp_weights(z: Array) -> tuple[Array, Array, Array]:
    """exp(-z), int_0^1 exp(-(1-s) z) (1-s) ds and int_0^1 exp(-(1-s) z) s ds, to full
    accuracy for z >= 0.

    What is left of a branch after a step of z relaxation times, and what a rate that is
    linear over the step adds, from its value at the start and at the end.
    """
    small, large = xp.minimum(z, 1.0), xp.maximum(z, 1.0)
    series = _phi2_series(small)
    mean = 1 - small * series
    left = xp.exp(-large)
    mean_large = (1 - left) / large
    late = xp.where(z < 1, series, (1 - mean_large) / large)
    mean = xp.where(z < 1, mean, mean_large)
    return xp.where(z < 1, 1 - small * (1 - small * series), left), mean - late, late
