"""Contact edges on a single line in closed form, under a parabola.

All integrals of such a passage are means of exponentials over the contact, so that
Newton's method on the edges needs no panels. On NumPy.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..numerics.quadrature import gauss_unit

if TYPE_CHECKING:
    from ..checks import Array
    from .memory import Passage

# b/a below which contact is lost at the apex itself (a kink under a dashpot)
NEAREST_EXIT = 1e-15
USUAL = math.log(1e-3)  # log of a contact size [m] to begin with
_GUESSES = 8  # how often the length of a contact under a parabola is improved
# last step of log(a + b) under a parabola, whose error is the square of it
_GUESSED_WELL = 1e-4
_TO_ROUNDING = 2e-14  # the same after the last step where the body is a parabola
# passage time over relaxation time from which closed forms keep their digits,
_NEARLY_SPRING = 0.05
# and of what is done below it
_SERIES = [1 / (math.factorial(k) * (k + 3)) for k in range(8)]


def under_parabola(
    p: Passage, given: Array, top: Array, by_size: bool
) -> tuple[Array, Array, Array]:
    """log A and b/a on a single line, by Newton's method, if its profile were a
    parabola, and where; on NumPy.

    Of a given load, or `by_size` of log A itself.

    The parabola is the one with the same volume between profile and contact. For a
    parabola with the length L = a + b of contact and M_j = int E(r/v) r^j dr from 0 to
    L, q(-b) = 0 gives b = M_1/(M_0 + eta v), and the force follows.
    """
    law, lines, line, exact = p.law, p.lines, np.zeros((1, 1), int), p.rule.parabola
    c, w, _ = gauss_unit(6)
    rate, drag, widest = 1 / p.decay, p.velocity * law.viscosity, np.exp(top)
    lossy = bool(np.any(drag))
    log_length = (
        (given if by_size else np.minimum(USUAL, top - 0.5))
        + math.log(2)
        + np.zeros_like(given)
    )
    a, b, length, before = 4 * (np.ones_like(given),)
    # of a parabola that is the curvature
    curvature, weight = lines.profile(a, a, line), lines.weight(a)[0]
    converged = np.zeros(given.shape, bool)
    for _ in range(_GUESSES):
        length = np.exp(log_length)
        kept, first, second, third = (
            law.moduli @ x for x in _exponential_means(length * rate)
        )
        last, mean = law.equilibrium + kept, law.equilibrium + first
        mean = mean + drag / length if lossy else mean
        arm = law.equilibrium / 2 + second
        b = arm / mean
        a = 1 - b
        size, left_over = length * a, mean - last * a
        if by_size:
            step = (given - np.log(size)) * a * mean / left_over
        else:
            force = mean - 2 * arm * a - (law.equilibrium / 3 + third)
            rise = 2 * a * left_over / force
            if not exact:
                size = np.minimum(size, widest)
                x = size * c[:, None]
                curvature = 1.5 / size**2 * (w @ (x * lines.slope(x, size, line)))
                rise = rise + (lines.exponent(size) - 2) * left_over / (a * mean)
            step = np.log(given / (weight * curvature * length**3 * force)) / rise
        log_length = np.minimum(log_length + step, top + math.log(2))
        miss = np.abs(step)
        # Each miss is the square of the one before times a number, taken as 1/4 at
        # least.
        left = miss**2 * np.maximum(miss / before**2, 0.25)
        if miss.max() < _GUESSED_WELL and (not exact or left.max() <= _TO_ROUNDING):
            moved = left_over / mean * step  # da/dL = left_over/mean
            a, b = a + moved, b + step - moved
            converged = size <= widest
            break
        before = miss
    ratio = np.minimum(np.maximum(b / a, NEAREST_EXIT), 1 - 4e-16)
    return (
        given if by_size else np.minimum(np.log(length * a), top),
        ratio[None],
        converged,
    )


class _Means(NamedTuple):
    kept: Array  # e^{-z}
    zeroth: Array
    first: Array
    second: Array


def _exponential_means(z: Array) -> _Means:
    """e^{-z} and int e^{-z c} c^j dc from 0 to 1 for j = 0, 1, 2.

    The last by a series where z is small, and from it the others, whose sums cancel
    nothing.
    """
    left, small = np.exp(-z), -np.minimum(z, _NEARLY_SPRING)
    series = np.full_like(z, _SERIES[-1])
    for coefficient in _SERIES[-2::-1]:
        series *= small
        series += coefficient
    third = np.where(
        z < _NEARLY_SPRING, series, (2 * (-np.expm1(-z) / z - left) / z - left) / z
    )
    second = 0.5 * (left + z * third)
    return _Means(left, left + z * second, second, third)
