"""The secular equation that links relaxation and retardation times, solved to full
relative accuracy.

Poles of a relaxation function and of its creep function interlace. With pole times p_1
< ... < p_n and weights w_k >= 0, the times of the other function are the roots t of

    sum_k w_k / (t - p_k) = c,        c >= 0,

one in each interval (p_k, p_{k+1}) and, where c > 0, one above p_n. A general
eigenvalue routine loses the small eigenvalues to rounding once the times span more than
15 decades; here every root is found as a distance to the nearer end of its interval, so
that it keeps its relative accuracy over any span.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..arrays import compiled, fixed, fori_loop, xp
from ..checks import Array

if TYPE_CHECKING:
    from jaxtyping import Float

# halvings of the logarithm of a distance: from 280 decades down to rounding
_BISECTIONS = 64
_SMALLEST = 1e-140  # its square is still a float64


@compiled()
def secular_roots(
    poles: Float[Array, " n"],  # ascending pole times [s]
    weights: Float[Array, " n"],  # positive weights
    constant: Float[Array, ""],  # c >= 0, same unit as weight over time
) -> tuple[Float[Array, " n"], Float[Array, " n"], Float[Array, "n n"]]:
    """Roots t of sum_k w_k/(t - p_k) = c, the slope sum_k w_k/(t - p_k)^2 at each, and
    t_j - p_k to full accuracy.

    The last root is infinite where c = 0. Differentiable: the bisection is not, one
    Newton step after it is.
    """
    n = poles.shape[0]
    index = xp.arange(n)
    finite = (index < n - 1) | (constant > 0)
    # Where the last root is infinite it is sought with a constant that puts it at a
    # finite place, and masked below: an infinity on the way would turn the derivatives
    # of all roots into NaN.
    stand_in = fixed(xp.sum(weights) / xp.maximum(poles[-1], _SMALLEST))
    constants = xp.where(finite, constant, stand_in)
    fixed_poles, fixed_weights, fixed_constants = fixed((poles, weights, constants))
    top = fixed_poles[-1] + xp.sum(fixed_weights) / fixed_constants[-1]
    upper = xp.append(fixed_poles[1:], top)
    width = upper - fixed_poles

    def excess(
        origin: Array, distance: Array, poles: Array, weights: Array, constants: Array
    ) -> Array:
        gap = (origin[:, None] - poles[None, :]) + distance[:, None]
        return xp.sum(weights / _away_from_zero(gap), axis=1) - constants

    # Which end is nearer: the left-hand side falls through its interval from +infinity
    # to -infinity.
    right_half = (
        excess(fixed_poles, 0.5 * width, fixed_poles, fixed_weights, fixed_constants)
        > 0
    )
    right_half = right_half & (index < n - 1)
    origin = xp.where(right_half, upper, fixed_poles)
    side = xp.where(right_half, -1.0, 1.0)
    reach = xp.where(right_half, 0.5, 1.0) * width

    def halve(_, bounds):
        low, high = bounds
        middle = 0.5 * (low + high)
        value = excess(
            origin, side * xp.exp(middle), fixed_poles, fixed_weights, fixed_constants
        )
        too_near = side * value > 0  # the root lies farther from the origin
        return xp.where(too_near, middle, low), xp.where(too_near, high, middle)

    start = (xp.full(n, math.log(_SMALLEST)), xp.log(xp.maximum(reach, _SMALLEST)))
    low, high = fori_loop(0, _BISECTIONS, halve, start)
    distance = side * xp.exp(0.5 * (low + high))

    # Newton on the distance, with the poles' own tangents in the residual.
    origin = poles[xp.minimum(index + right_half, n - 1)]
    gap = (origin[:, None] - poles[None, :]) + distance[:, None]
    residual = xp.sum(weights / _away_from_zero(gap), axis=1) - constants
    step = residual / xp.sum(weights / _away_from_zero(gap) ** 2, axis=1)
    step = step - fixed(xp.where(xp.abs(step) < 0.1 * xp.abs(distance), 0.0, step))
    gap = gap + step[:, None]
    slope = xp.sum(weights / _away_from_zero(gap) ** 2, axis=1)
    return xp.where(finite, origin + distance + step, xp.inf), slope, gap


def _away_from_zero(gap: Array) -> Array:
    return xp.where(xp.abs(gap) < _SMALLEST, _SMALLEST, gap)
