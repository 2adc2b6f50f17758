"""Roots of many functions at once, with derivatives that do not pass through the
search.
"""

import math
from collections.abc import Callable
from typing import Any

from ..arrays import fori_loop, on_numpy, stop_gradient, while_loop, xp
from ..checks import Array

_CLOSE = 3e-4  # change of x from which one more Newton step is at rounding
# the same of a step of the secant method, whose error is the product of the last two
_ROUNDING = 1e-8
_ITERATIONS = 60
_CLIP = 3.0  # longest step of a search
_USUAL = 1.5  # slope to start a search with: of powers, in logarithms


def root(
    residual: Callable[[Array], Array],
    guess: Array,
    close: float = _CLOSE,
    slope: float = _USUAL,
) -> tuple[Array, Array]:
    """x with residual(x) = 0, rising through it, and whether it was found.

    The search runs on values cut off from differentiation, until a step is as short as
    `close`; one Newton step afterwards carries the derivatives. On NumPy it runs until
    its next step would be rounding.
    """
    if on_numpy():
        return search(residual, guess, min(close, _ROUNDING), slope)
    import jax

    x, settled = search(residual, guess, close, slope)
    value, slope = jax.jvp(residual, (x,), (xp.ones_like(x),))
    step = value / stop_gradient(slope)
    converged = settled & (xp.abs(step) < 10 * _CLOSE)
    return x - xp.where(converged, step, step - stop_gradient(step)), converged


def search(
    residual: Callable[[Array], Array],
    guess: Array,
    close: float = _CLOSE,
    slope: Array | float = _USUAL,
    high: Array | float = math.inf,
    longest: float = _CLIP,
) -> tuple[Array, Array]:
    """The secant method inside a shrinking bracket, many roots at once, and which of
    them were found: the step that is left there is small, which a NaN's is not.

    It begins with `slope`, and returns to it where two values do not rise. Steps end
    at `close`; none is longer than `longest` or leads beyond `high`.
    """
    usual = slope

    def advance(state: tuple) -> tuple:
        x, slope, low, high, settled, count, value = state
        low, high = xp.where(value < 0, x, low), xp.where(value < 0, high, x)
        secant = x - xp.clip(value / slope, -longest, longest)
        middle = 0.5 * (
            xp.maximum(low, x - 2 * longest) + xp.minimum(high, x + 2 * longest)
        )
        following = xp.where((secant >= low) & (secant <= high), secant, middle)
        change = following - x
        settled = settled | (xp.abs(change) < close) | xp.isnan(value)
        following = xp.where(xp.isfinite(following), following, x)
        new = residual(following)
        slope = xp.where(
            xp.abs(change) > 1e-9,
            (new - value) / xp.where(change == 0, 1.0, change),
            slope,
        )
        return (
            following,
            xp.where((slope > 0.05) & (slope < math.inf), slope, usual),
            low,
            high,
            settled,
            count + 1,
            new,
        )

    guess = xp.where(xp.isfinite(guess), guess, -7.0)
    everywhere = xp.full_like(guess, xp.inf)
    state = (
        guess,
        xp.zeros_like(guess) + usual,
        -everywhere,
        xp.minimum(everywhere, high),
        xp.zeros(guess.shape, bool),
        0,
        residual(guess),
    )
    state = stop_gradient(state)
    state = while_loop(lambda s: ~xp.all(s[4]) & (s[5] < _ITERATIONS), advance, state)
    x, slope, _, _, settled, _, value = state
    return stop_gradient((x, settled & (xp.abs(value) < 10 * _CLOSE * slope)))


def bisect(
    root_above: Callable[[Any], Any], low: Array, high: Array, halvings: int
) -> tuple[Any, Any]:
    """Halves brackets, all of them at once; `root_above(x)` tells where the root lies
    above x. A bracket that holds none ends at one of its ends.
    """

    def halve(_: int, bracket: tuple) -> tuple:
        low, high = bracket
        middle = 0.5 * (low + high)
        above = root_above(middle)
        return xp.where(above, middle, low), xp.where(above, high, middle)

    return fori_loop(0, halvings, halve, (low, high))
