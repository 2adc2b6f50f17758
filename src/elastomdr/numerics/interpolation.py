"""Curves through points: cubics with given slopes, slopes, Lagrange's polynomials on
even grids, integrals, and the maximum of a smooth function.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import stop_gradient, xp
from ..checks import Array, argmax, numpy_unless_traced

if TYPE_CHECKING:
    from jaxtyping import Float


def hermite(
    nodes: Float[Array, " n"],
    values: Float[Array, "*batch n"],
    slopes: Float[Array, "*batch n"],
    x: Array,
) -> Array:
    """Cubics with given values and slopes at ascending nodes, at places x; the outer
    ones go on beyond the ends.
    """
    left = xp.searchsorted(nodes, x, side="right") - 1
    left = xp.clip(left, 0, nodes.shape[0] - 2)
    start, width = xp.take(nodes, left), xp.take(xp.diff(nodes), left)
    s = (x - start) / width

    def ends(values: Array) -> tuple[Array, Array]:
        return xp.take(values, left, axis=-1), xp.take(values, left + 1, axis=-1)

    (value, next_value), (slope, next_slope) = ends(values), ends(slopes)
    return (
        (1 + 2 * s) * (1 - s) ** 2 * value
        + s * (1 - s) ** 2 * width * slope
        + s**2 * (3 - 2 * s) * next_value
        + s**2 * (s - 1) * width * next_slope
    )


def even_cubics(
    cubics: Float[Array, "4 intervals"], place: Array, left: Array
) -> Array:
    """Cubics on even intervals, coefficients from the third power down, at `place`, in
    intervals from the lower end of the first; `left` as `interval_of` gives it.
    """
    s = place - left
    # each from an array of one dimension: an eighth of the time of indexing rows
    cube, square, slope, value = map(xp.take, cubics, (left, left, left, left))
    return ((cube * s + square) * s + slope) * s + value


def interval_of(place: Array, count: int) -> Array:
    """The interval, of `count`, that a place is in; the outer ones go on beyond."""
    return xp.clip(xp.floor(place).astype(int), 0, count - 1)


@numpy_unless_traced
def monotone_slopes(x: Array, y: Array) -> Array:
    """Slopes with which cubics through points rise and fall as the points do (PCHIP).

    Between two secants of one sign it is their weighted harmonic mean, else zero.
    Source: Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300.
    """
    x, y = xp.asarray(x), xp.asarray(y)
    width = xp.diff(x)
    secant = xp.diff(y) / width
    if x.shape[0] == 2:
        return xp.concatenate([secant, secant], axis=-1)
    before, after = secant[..., :-1], secant[..., 1:]
    one_sign = before * after > 0
    weight_before = 2 * width[1:] + width[:-1]
    weight_after = width[1:] + 2 * width[:-1]
    # any number will do where the result is masked
    before, after = xp.where(one_sign, before, 1.0), xp.where(one_sign, after, 1.0)
    mean = (weight_before + weight_after) / (
        weight_before / before + weight_after / after
    )
    inner = xp.where(one_sign, mean, 0.0)

    def end(
        width: Array, next_width: Array, secant: Array, next_secant: Array
    ) -> Array:
        """Of the parabola through three points, kept from overshooting."""
        slope = (2 * width + next_width) * secant - width * next_secant
        slope = slope / (width + next_width)
        slope = xp.where(slope * secant > 0, slope, 0.0)
        turns = secant * next_secant < 0
        return xp.where(turns & (abs(slope) > 3 * abs(secant)), 3 * secant, slope)

    first = end(width[0], width[1], secant[..., 0], secant[..., 1])
    last = end(width[-1], width[-2], secant[..., -1], secant[..., -2])
    return xp.concatenate([first[..., None], inner, last[..., None]], axis=-1)


def parabola_slopes(x: Array, y: Array) -> Array:
    """Slopes at points of the parabolas through three neighbours each; of the straight
    line where there are two points.
    """
    width = xp.diff(x)
    secant = xp.diff(y) / width
    if x.shape[0] == 2:
        return xp.concatenate([secant, secant])
    weighted = secant[:-1] * width[1:] + secant[1:] * width[:-1]
    inner = weighted / (width[:-1] + width[1:])
    first, last = 2 * secant[:1] - inner[:1], 2 * secant[-1:] - inner[-1:]
    return xp.concatenate([first, inner, last])


def lagrange(
    place: Array, stencil: int, count: int | None = None
) -> tuple[Array, Array]:
    """Indices and weights of the `stencil` nodes around each place on a grid of unit
    spacing, or the nearest of `count` nodes: (..., stencil).
    """
    left = xp.floor(stop_gradient(place)).astype(int) - (stencil // 2 - 1)
    left = left if count is None else xp.clip(left, 0, count - stencil)
    offsets = np.arange(stencil)
    gaps = (place - left)[..., None] - offsets
    # at a node, where the squares in derivatives must not overflow
    gaps = xp.where(gaps == 0, 1e-140, gaps)
    weights = _barycentric(stencil) / gaps
    return left[..., None] + offsets, weights / weights.sum(axis=-1, keepdims=True)


@functools.cache
def _barycentric(stencil: int) -> np.ndarray:
    factorials = [
        math.factorial(j) * math.factorial(stencil - 1 - j) for j in range(stencil)
    ]
    return (-1.0) ** np.arange(stencil) / np.array(factorials)


def halving_limit(coarse: Array, fine: Array, power: int = 2) -> Array:
    """Richardson's limit from a step and from half of it, without the given power of
    the step in its error; arrays or numbers.
    """
    return fine + (fine - coarse) / (2**power - 1)


_NEAR = 9  # nodes around the largest value
_TO_POWERS = np.linalg.inv(np.vander(np.linspace(-1.0, 1.0, _NEAR), increasing=True))


def peak(values: Array, last: Array | int) -> tuple[Array, Array]:
    """The largest value of a smooth function given at equal steps up to index `last`,
    and where it is (0 to 1).

    Newton's method on the slope of the polynomial through the nine values around the
    largest one.
    """
    half = _NEAR // 2
    first = xp.clip(argmax(stop_gradient(values)) - half, 0, last + 1 - _NEAR)
    near = first[None] + xp.arange(_NEAR)[:, None]
    rows = xp.take_along_axis(values, near, axis=0)
    # of powers of x, the nodes being at -1 ... 1
    coefficients = xp.einsum("ij,j...->i...", _TO_POWERS, rows)
    known, powers = stop_gradient(coefficients), np.arange(_NEAR)[:, None]
    x = argmax(stop_gradient(rows)) / half - 1.0
    for _ in range(5):
        slope = xp.sum((powers * known)[1:] * x ** (powers[1:] - 1), axis=0)
        bends = (powers * (powers - 1) * known)[2:] * x ** (powers[2:] - 2)
        bend = xp.sum(bends, axis=0)
        step = xp.where(bend < 0, slope / xp.where(bend < 0, bend, -1.0), 0.0)
        x = xp.clip(x - step, -1.0, 1.0)
    largest = functools.reduce(lambda sum, c: sum * x + c, coefficients[::-1])
    return largest, (first + half * (1 + x)) / last


def integrals(x: Array, values: Array) -> Array:
    """From the last of x to 0 and to each of x, before the first of which values are
    even: near closing, where they are small, with all of their digits.
    """
    parts = 0.5 * (values[..., 1:] + values[..., :-1]) * np.diff(x)
    first, last = values[..., :1] * x[0], np.zeros_like(values[..., :1])
    parts = np.concatenate([last, parts[..., ::-1], first], axis=-1)
    return -np.cumsum(parts, axis=-1)[..., ::-1]
