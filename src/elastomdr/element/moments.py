"""Relaxation moments: integrals of exp(-r/s) against Legendre polynomials, exact for
every decay length s.

In steady sliding all contact integrals have the form int E(r/v) h(r) dr with a smooth h
that knows nothing of the material. With h expanded in Legendre polynomials on an
interval, one branch enters through

    mu_j(z) = int_0^1 exp(-z c) P_j(1 - 2c) dc = exp(-z/2) i_j(z/2),        z = width/s,

i_j the modified spherical Bessel function. So a boundary layer at the leading edge,
however thin, costs nothing.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import fori_loop, in_steps, on_numpy, xp
from ..checks import Array
from ..numerics.decay import phi1

if TYPE_CHECKING:
    from jaxtyping import Float

_UNROLLED = 5  # coefficients up to which the recurrences are written out


def contract(
    coefficients: Float[Array, "count ..."], z: Float[Array, "*shape"]
) -> Float[Array, "..."]:
    """sum_j c_j mu_j(z) for z >= 0 and at least two rows of coefficients, broadcast
    against z.

    One sweep: the ratios i_j/i_{j-1} by backward recurrence where z is small, forward
    recurrence where it is large, the sum taken along the way; on JAX. Start: Amos'
    bound (Math. Comp. 28, 1974). Recurrences: DLMF 10.51.
    """
    return _differentiable()(coefficients, z)


def panel_sums(
    c: Array, kappa: Array | None, z: Array
) -> tuple[Any, Any, Any, Any, Any]:
    """mu_0, mu_0 + mu_1, and the sums over j > 0 of c_j mu_j, of (-1)^j c_j mu_j, and
    of kappa_j mu_j, if given.
    """
    if on_numpy():
        mu = _moments(c.shape[0] if kappa is None else kappa.shape[0], z)
        odd, even = _dot(c[1::2], mu[1::2]), _dot(c[2::2], mu[2 : c.shape[0] : 2])
        return (
            mu[0],
            mu[0] + mu[1],
            even + odd,
            even - odd,
            None if kappa is None else _dot(kappa[1:], mu[1:]),
        )
    later = xp.concatenate([xp.zeros_like(c[:1]), c[1:]])
    sign = xp.asarray((-1.0) ** np.arange(c.shape[0])).reshape(-1, *[1] * (c.ndim - 1))
    first = xp.concatenate([xp.ones_like(c[:2]), xp.zeros_like(c[2:])])
    forth, back, both = contract(xp.stack([later, sign * later, first], axis=1), z)
    zeroth = xp.where(z > 0, -xp.expm1(-z) / xp.where(z > 0, z, 1.0), 1.0)
    rest = (
        None
        if kappa is None
        else contract(xp.concatenate([xp.zeros_like(kappa[:1]), kappa[1:]]), z)
    )
    return zeroth, both, forth, back, rest


# The recurrences stand twice. On NumPy all moments are one array, made in place by
# passes over long rows, and sums are products of matrices. On JAX such arrays in the
# body of a loop take several times as long as sums made along the way, and derivatives
# would pass through each of their rows. `tests/element/test_element.py` holds one against the
# other.


def _dot(rows: Any, mu: Any) -> Any:
    """sum_j rows_j mu_j for as many j as there are rows; on NumPy."""
    mu = mu[: len(rows)]
    if (
        len(rows)
        and rows.size == rows.shape[0] * rows.shape[1] * rows.shape[2]
        and mu.shape[2:4] == (1, 1)
    ):
        # Panels that are the same for all branches and points: one product of matrices
        # each.
        terms = mu.reshape(*mu.shape[:2], -1).swapaxes(0, 1)
        total = np.moveaxis(rows.reshape(rows.shape[:3]), 0, 2) @ terms
        return total.reshape(*total.shape[:2], 1, *mu.shape[4:])
    total = 0.0
    for row, moment in zip(rows, mu, strict=True):
        total += row * moment
    return total


def _moments(count: int, z: Any) -> Float[np.ndarray, "count ..."]:
    """mu_j(z) of j < `count`, as in `_sum`; on NumPy."""
    flat = z.reshape(-1)
    big = flat > 2 * _ranges(count)[0]
    some = np.count_nonzero(big)
    if some == 0:
        mu = _backward(count, flat)
    elif some == flat.size:
        mu = _forward(count, flat)
    else:
        mu, near, far = (
            np.empty((count, flat.size)),
            np.flatnonzero(~big),
            np.flatnonzero(big),
        )
        for row, low, high in zip(
            mu, _backward(count, flat[near]), _forward(count, flat[far]), strict=True
        ):
            row[near], row[far] = low, high
    return mu.reshape(count, *z.shape)


def _backward(count: int, z: Float[np.ndarray, " n"]) -> Float[np.ndarray, "count n"]:
    """`_moments` from the ratios of each to the one before."""
    half, top = 0.5 * z, _ranges(count)[1]
    mu = np.empty((count, z.size))
    ratio = half / (top + 1.5 + np.sqrt((top + 1.5) ** 2 + half**2))
    for j in range(top, 0, -1):
        ratio *= half
        ratio += 2 * j + 1
        np.divide(half, ratio, out=ratio)
        if j < count:
            mu[j] = ratio
    mu[0] = phi1(z)
    for j in range(1, count):
        mu[j] *= mu[j - 1]
    return mu


def _forward(count: int, z: Float[np.ndarray, " n"]) -> Float[np.ndarray, "count n"]:
    """`_moments` of large z, each from the two before."""
    inverse, decay = 2 / z, np.exp(-z)
    mu = np.empty((count, z.size))
    mu[0] = 0.5 * (1 - decay) * inverse
    mu[1] = 0.5 * (1 + decay) * inverse - mu[0] * inverse
    for j in range(1, count - 1):
        np.multiply((2 * j + 1) * inverse, mu[j], out=mu[j + 1])
        np.subtract(mu[j - 1], mu[j + 1], out=mu[j + 1])
    return mu


def _ranges(count: int) -> tuple[float, int]:
    """z/2 from which the recurrence goes forward, and where the one backward begins."""
    return max(count, count * count / 8), count + (
        8 if count <= 9 else 12 if count <= 17 else 26
    )


def _sum(coefficients: Array, z: Array) -> Array:
    """`contract` itself, without its derivative."""
    rows, count = coefficients, coefficients.shape[0]
    # the same for all that are short: XLA then computes ratios once
    switch, top = _ranges(max(count, _UNROLLED))
    half = z / 2
    small, large = xp.minimum(half, switch), xp.maximum(half, switch)
    # A long chain of steps in one expression is slow to compile and, past a dozen, slow
    # to run: then it is a loop.
    loop = fori_loop if count > _UNROLLED else _unrolled

    ratio = small / (top + 1.5 + xp.sqrt((top + 1.5) ** 2 + small**2))

    def lower(i, ratio):
        return small / ((2 * (top - i) + 1) + small * ratio)

    def lower_and_add(state, now):
        (ratio, total), (j, row) = state, now
        ratio = small / ((2 * j + 1) + small * ratio)
        return (ratio, ratio * (row + total)), None

    ratio = loop(0, top - count + 1, lower, ratio)
    start = (ratio, xp.zeros(xp.broadcast_shapes(z.shape, rows[0].shape)))
    _, total = _over(np.arange(count - 1.0, 0.0, -1), rows[:0:-1], lower_and_add, start)
    low = phi1(2 * small) * (rows[0] + total)
    return xp.where(half <= switch, low, _ascending(rows, large))


def _ascending(rows: Array, large: Array) -> Array:
    """`contract` for large z/2."""
    inverse, decay = 1 / large, xp.exp(-2 * large)
    before = 0.5 * (1 - decay) * inverse
    mu = 0.5 * (1 + decay) * inverse - before * inverse

    def raise_and_add(state, now):
        (before, mu, total), (j, row) = state, now
        before, mu = mu, before - (2 * j + 1) * inverse * mu
        return (before, mu, total + row * mu), None

    start = (before, mu, rows[0] * before + rows[1] * mu)
    return _over(np.arange(1.0, rows.shape[0] - 1.0), rows[2:], raise_and_add, start)[2]


def _over(
    j: np.ndarray, rows: Array, body: Callable[[Any, Any], Any], state: Any
) -> Any:
    """A loop over rows and their numbers; by scan: what indexes rows has no derivative
    without 64-bit types.
    """
    if len(j) >= _UNROLLED:
        return in_steps(body, state, (xp.asarray(j), rows))[0]
    for now in zip(j, rows, strict=True):
        state, _ = body(state, now)
    return state


def _unrolled(
    start: int, stop: int, body: Callable[[int, Any], Any], state: Any
) -> Any:
    for i in range(start, stop):
        state = body(i, state)
    return state


@functools.cache
def _differentiable() -> Callable[[Array, Array], Array]:
    import jax

    contraction = jax.custom_jvp(_sum)
    contraction.defjvp(_derivative)
    return contraction


def _derivative(primals, tangents):
    """d mu_j/dz = -(1/2)[mu_j - ((j+1) mu_{j+1} + j mu_{j-1})/(2j+1)]: again a
    contraction.
    """
    (coefficients, z), (coefficient_tangents, z_tangent) = primals, tangents
    count = coefficients.shape[0]
    i = xp.arange(count + 1.0).reshape(-1, *[1] * (coefficients.ndim - 1))

    def shifted(before: int, after: int) -> Array:
        return xp.pad(
            coefficients, [(before, after)] + [(0, 0)] * (coefficients.ndim - 1)
        )

    up, same, down = shifted(1, 0), shifted(0, 1), shifted(0, 2)[1:]
    derivative = -0.5 * (same - i / (2 * i - 1) * up - (i + 1) / (2 * i + 3) * down)
    value = contract(coefficients, z)
    return value, contract(coefficient_tangents, z) + z_tangent * contract(
        derivative, z
    )
