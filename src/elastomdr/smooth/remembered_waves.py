"""What a Kelvin element remembers of a contact, in closed form.

A pressure over |t| < 1 whose n-th term has the transform J_n(y)/y leaves in the slope,
of a surface that gives way by 1/(1 - iy/z) to the wave exp(iyt), z = 1/l with the memory
l in half-lengths, the m-th Chebyshev polynomial with the share

    Re[i^(m-n) int_0^inf J_m J_n/(y (1 - iy/z)) dy] = [m = n]/2n - I_m(z) K_n(z),    m >= n,

and (-1)^(m-n) times that of (n, m) where m < n. Where m - n is even this is Watson's
integral (Theory of Bessel Functions, 13.53); where it is odd it follows from its
neighbours, as J_(m-1) + J_(m+1) = 2m J_m/y. The products are needed for n = 0 and n = 1
(`bessel_products`). I_m comes from its ratios, downwards, which begin with Debye's
expansion for large orders (DLMF 10.41).
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from ..arrays import fori_loop, scan, xp
from ..checks import Array

_HIGHER = 16  # orders above the last one, where the ratios begin
_LARGE, _POWERS = 2.0, 18  # from where on, and terms of the series below


class Products(NamedTuple):
    """Of orders m = 0 ... top along the first axis."""

    with_first: Array  # I_m K_0
    with_second: Array  # I_m K_1
    diagonal: Array  # 1/2 - I_1 K_1, to full relative accuracy


def bessel_products(z: Array, top: int) -> Products:
    """I_m(z) K_0(z) and I_m(z) K_1(z), m = 0 ... `top`, z > 0 of any shape."""
    ratios = _ratios(z, top)
    product = _first_product(z, ratios[0])

    def next_order(before: Array, ratio: Array) -> tuple[Array, Array]:
        after = before * ratio
        return after, after

    _, over_first = scan(next_order, xp.ones_like(z), ratios)
    over_first = xp.concatenate([xp.ones_like(z)[None], over_first])  # I_m/I_0
    # Wronski: I_0 K_1 = 1/z - I_1 K_0
    second = 1 / z - over_first[1] * product
    # I_1/z = (I_0 - I_2)/2
    diagonal = 0.5 * over_first[2] + over_first[1] ** 2 * product
    return Products(over_first * product, over_first * second, diagonal)


def _ratios(z: Array, top: int) -> Array:
    """I_m/I_(m-1), m = 1 ... `top`."""
    last = top + _HIGHER

    def lower(above: Array, order: Array) -> tuple[Array, Array]:
        ratio = z / (2 * order + z * above)
        return ratio, ratio

    orders = np.arange(last - 1, 0, -1.0)
    _, ratios = scan(lower, _first_ratio(z, last), xp.asarray(orders))
    return ratios[::-1][:top]


def _first_ratio(z: Array, order: int) -> Array:
    """I_n/I_(n-1) of one large order n, by three terms of Debye's expansion."""
    p = 1 / xp.sqrt(1 + (z / order) ** 2)
    q = p**2
    value = 1 + p / order * (
        (3 - 5 * q) / 24
        + p / order * (81 + q * (-462 + 385 * q)) / 1152
        + (p / order) ** 2
        * (30375 + q * (-369603 + q * (765765 - 425425 * q)))
        / 414720
    )
    slope = 1 + p / order * (
        (-9 + 7 * q) / 24
        + p / order * (-135 + q * (594 - 455 * q)) / 1152
        + (p / order) ** 2
        * (-42525 + q * (451737 + q * (-883575 + 475475 * q)))
        / 414720
    )
    # I_(n-1) = I_n' + (n/z) I_n,  I_n'/I_n = (n/z) slope/(p value)
    return z / order / (1 + slope / (p * value))


def _first_product(z: Array, ratio: Array) -> Array:
    """I_0 K_0, from I_1/I_0: by the power series of K_0 (DLMF 10.31.2) for z < 2, above
    by Wronski's 1/z = I_0 K_0 (K_1/K_0 + I_1/I_0).
    """
    small = z < _LARGE
    square = xp.where(small, 0.5 * z, 1.0) ** 2
    harmonic = xp.asarray(np.cumsum(1 / np.arange(1.0, _POWERS)))

    def next_power(k: Array | int, state: tuple) -> tuple:
        term, i_0, rest = state
        term = term * square / (k * k)
        return term, i_0 + term, rest + harmonic[k - 1] * term

    first = xp.ones_like(z), xp.ones_like(z), xp.zeros_like(z)
    _, i_0, rest = fori_loop(1, _POWERS, next_power, first)
    k_0 = rest - (0.5 * xp.log(square) + np.euler_gamma) * i_0
    x = 2 * _LARGE / xp.where(small, _LARGE, z) - 1
    coefficients = xp.asarray(_ratio_of_k()[::-1])

    def clenshaw(k: Array | int, state: tuple) -> tuple:
        last, before = state
        return coefficients[k] + 2 * x * last - before, last

    first = xp.zeros_like(z), xp.zeros_like(z)
    last, before = fori_loop(0, len(coefficients) - 1, clenshaw, first)
    k_ratio = coefficients[-1] + x * last - before
    return xp.where(small, i_0 * k_0, 1 / (z * (k_ratio + ratio)))


@functools.cache
def _ratio_of_k() -> np.ndarray:
    """Chebyshev coefficients of K_1/K_0 over 4/z - 1, z > 2; from the integrals of
    exp(-z cosh(a)) cosh(na), for which the trapezoidal rule converges exponentially.
    """
    count = 32
    x = np.cos(math.pi * (np.arange(count) + 0.5) / count)
    z = 2 * _LARGE / (1 + x[:, None])
    a = np.arccosh(1 + 40 / z) * (np.arange(64) / 64)
    fall = np.exp(-2 * z * np.sinh(a / 2) ** 2)
    fall[:, 0] *= 0.5
    ratio = np.sum(fall * np.cosh(a), axis=1) / np.sum(fall, axis=1)
    degree = np.arange(count)[:, None]
    to = np.cos(degree * np.arccos(x)) * np.where(degree == 0, 1, 2) / count
    return to @ ratio


def slopes_of_all(first: Array, second: Array, order: int) -> Array:
    """The shares of all terms n = 1 ... `order` in all polynomials m = 1 ... `order`,
    (points, m, n), of whatever gives way to waves: from those of the terms 0 and 1 in
    the polynomials up to 2 `order` + 1, (m, points).

    The recurrence of J_m and that of J_n make m (B_{m,n+1} - B_{m,n-1}) =
    n (B_{m-1,n} - B_{m+1,n}), in which errors do not grow for m > n; the others follow
    by symmetry.
    """
    count = first.shape[0]
    degree = np.arange(count, dtype=float)[:, None]
    below = xp.zeros_like(first[:1])

    def next_term(state: tuple, n: Array) -> tuple[tuple, Array]:
        before, now = state
        change = xp.concatenate([now[2:] - now[:-2], below])
        change = xp.concatenate([below, change]) * (n / np.maximum(degree, 1.0))
        after = xp.where(degree > n, before - change, 0.0)
        return (now, after), now[1 : order + 1]

    terms = np.arange(1.0, order + 1)
    _, lower = scan(next_term, (first, second), xp.asarray(terms))
    lower = xp.transpose(lower, (2, 1, 0))  # points, m, n
    m, n = terms[:, None], terms
    sign = (-1.0) ** (m - n)
    return xp.where(m >= n, lower, sign * xp.swapaxes(lower, 1, 2))
