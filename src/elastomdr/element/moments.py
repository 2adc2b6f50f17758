"""Relaxation moments: integrals of exp(-r/s) against Legendre polynomials, exact for
every decay length s.

In steady sliding all contact integrals have the form int E(r/v) h(r) dr with a smooth h
that knows nothing of the material. With h expanded in Legendre polynomials on an
interval, one branch enters through

    mu_j(z) = int_0^1 exp(-z c) P_j(1 - 2c) dc = exp(-z/2) i_j(z/2),        z = width/s,

i_j the modified spherical Bessel function. So a boundary layer at the leading edge,
however thin, costs nothing.

The ratios i_j/i_{j-1} come from a backward recurrence where z is small, the moments
from a forward one where it is large. Start: Amos' bound (Math. Comp. 28, 1974).
Recurrences: DLMF 10.51.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import on_numpy, xp
from ..checks import Array
from ..numerics.decay import phi1
from ..numerics.implicit import on_host

if TYPE_CHECKING:
    from jaxtyping import Float, PyTree


class PanelSums(NamedTuple):
    zeroth: Any  # mu_0, an array like the others
    both: Any  # mu_0 + mu_1
    forth: Any  # over j > 0, of c_j mu_j
    back: Any  # of (-1)^j c_j mu_j
    rest: Any  # of kappa_j mu_j, if given


def panel_sums(c: Array, kappa: Array | None, z: Array) -> PanelSums:
    """Sums over the moments of a panel."""
    count = c.shape[0]
    terms = count if kappa is None else kappa.shape[0]
    mu = moments(terms, z) if on_numpy() else moments_on_host(terms)(z)
    odd = _dot(c[1::2], mu[1:count:2])
    even = _dot(c[2::2], mu[2:count:2])
    squares = None if kappa is None else _dot(kappa[1:], mu[1:])
    return PanelSums(mu[0], mu[0] + mu[1], even + odd, even - odd, squares)


@functools.cache
def moments_on_host(count: int) -> Callable[[Array], Array]:
    """`moments` for JAX, which differentiates them by

    d mu_j/dz = -(1/2) [mu_j - ((j+1) mu_{j+1} + j mu_{j-1})/(2j+1)].
    """
    import jax
    import jax.numpy as jnp

    def numbers(_: PyTree, z: np.ndarray) -> Any:
        return moments(count, z)

    @jax.custom_jvp
    def whole(z: Array) -> Array:
        like = jax.ShapeDtypeStruct((count, *z.shape), z.dtype)
        return on_host(numbers, like, (), z)

    @whole.defjvp
    def derivative(given: PyTree, tangents: PyTree) -> Any:
        (z,), (step,) = given, tangents
        with jax.enable_x64(True):
            mu = moments_on_host(count + 1)(z)
            j = np.arange(float(count)).reshape(-1, *[1] * z.ndim)
            lower = jnp.concatenate([jnp.zeros_like(mu[:1]), mu[: count - 1]])
            mean = ((j + 1) * mu[1:] + j * lower) / (2 * j + 1)
            return mu[:count], -0.5 * (mu[:count] - mean) * step

    return whole


def _dot(rows: Any, mu: Any) -> Any:
    """sum_j rows_j mu_j for as many j as there are rows."""
    mu = mu[: len(rows)]
    if not on_numpy():
        return xp.sum(rows * mu, axis=0) if len(rows) else 0.0
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


def moments(count: int, z: Array) -> Float[np.ndarray, "count ..."]:
    """mu_j(z) of j < `count`, for z >= 0; on NumPy."""
    flat = np.asarray(z).reshape(-1)
    big = flat > 2 * _ranges(count)[0]
    big_count = np.count_nonzero(big)
    if big_count == 0:
        mu = _backward(count, flat)
    elif big_count == flat.size:
        mu = _forward(count, flat)
    else:
        mu = np.empty((count, flat.size))
        near = np.flatnonzero(~big)
        far = np.flatnonzero(big)
        for row, low, high in zip(
            mu, _backward(count, flat[near]), _forward(count, flat[far]), strict=True
        ):
            row[near], row[far] = low, high
    return mu.reshape(count, *z.shape)


def _backward(count: int, z: Float[np.ndarray, " n"]) -> Float[np.ndarray, "count n"]:
    """`moments` from the ratios of each to the one before."""
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
    """`moments` of large z, each from the two before."""
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
