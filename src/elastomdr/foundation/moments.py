"""Relaxation moments: integrals of exp(-r/s) against Legendre polynomials, exact for every decay length s.

In steady sliding all contact integrals have the form int E(r/v) h(r) dr with a smooth h that knows nothing of the
material. With h expanded in Legendre polynomials on an interval, one branch enters through

    mu_j(z) = int_0^1 exp(-z c) P_j(1 - 2c) dc = exp(-z/2) i_j(z/2),        z = width/s,

i_j the modified spherical Bessel function. So a boundary layer at the leading edge, however thin, costs nothing.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Float

from .._runtime import Array

_UNROLLED = 5  # coefficients up to which the recurrences are written out


@jax.custom_jvp
def contract(coefficients: Float[Array, "count ..."], z: Float[Array, "*shape"]) -> Float[Array, "..."]:
    """sum_j c_j mu_j(z) for z >= 0 and at least two rows of coefficients, broadcast against z.

    One sweep: the ratios i_j/i_{j-1} by backward recurrence where z is small, forward recurrence where it is large,
    the sum taken along the way. Start: Amos' bound (Math. Comp. 28, 1974). Recurrences: DLMF 10.51.
    """
    rows, count = coefficients, coefficients.shape[0]
    switch = max(count, count * count / 8)
    half = z / 2
    small, large = jnp.minimum(half, switch), jnp.maximum(half, switch)
    # A long chain of steps in one expression is slow to compile and, past a dozen, slow to run: then it is a loop.
    loop = jax.lax.fori_loop if count > _UNROLLED else _unrolled

    top = count + (8 if count <= 9 else 12 if count <= 17 else 26)
    ratio = small / (top + 1.5 + jnp.sqrt((top + 1.5) ** 2 + small**2))

    def lower(i, ratio):
        return small / ((2 * (top - i) + 1) + small * ratio)

    def lower_and_add(i, state):
        ratio, total = state
        j = count - 1 - i
        ratio = small / ((2 * j + 1) + small * ratio)
        return ratio, ratio * (rows[j] + total)

    ratio = loop(0, top - count + 1, lower, ratio)
    _, total = loop(0, count - 1, lower_and_add, (ratio, jnp.zeros(jnp.broadcast_shapes(z.shape, rows[0].shape))))
    low = _mean_decay(2 * small) * (rows[0] + total)

    inverse, decay = 1 / large, jnp.exp(-2 * large)
    before = 0.5 * (1 - decay) * inverse
    mu = 0.5 * (1 + decay) * inverse - before * inverse

    def raise_and_add(i, state):
        before, mu, total = state
        j = i + 1
        before, mu = mu, before - (2 * j + 1) * inverse * mu
        return before, mu, total + rows[j + 1] * mu

    _, _, high = loop(0, count - 2, raise_and_add, (before, mu, rows[0] * before + rows[1] * mu))
    return jnp.where(half <= switch, low, high)


def _unrolled(start: int, stop: int, body: Callable[[int, Any], Any], state: Any) -> Any:
    for i in range(start, stop):
        state = body(i, state)
    return state


@contract.defjvp
def _contract_jvp(primals, tangents):
    """d mu_j/dz = -(1/2)[mu_j - ((j+1) mu_{j+1} + j mu_{j-1})/(2j+1)]: again a contraction."""
    (coefficients, z), (coefficient_tangents, z_tangent) = primals, tangents
    count = coefficients.shape[0]
    i = jnp.arange(count + 1.0).reshape(-1, *[1] * (coefficients.ndim - 1))

    def shifted(before: int, after: int) -> Array:
        return jnp.pad(coefficients, [(before, after)] + [(0, 0)] * (coefficients.ndim - 1))

    up, same, down = shifted(1, 0), shifted(0, 1), shifted(0, 2)[1:]
    derivative = -0.5 * (same - i / (2 * i - 1) * up - (i + 1) / (2 * i + 3) * down)
    value = contract(coefficients, z)
    return value, contract(coefficient_tangents, z) + z_tangent * contract(derivative, z)


def _mean_decay(z: Array) -> Array:
    """(1 - exp(-z))/z, by its series where the difference would lose digits."""
    series = jnp.ones_like(z)
    for k in range(13, 1, -1):
        series = 1 - z / k * series
    safe = jnp.where(z > 0.3, z, 1.0)
    return jnp.where(z > 0.3, (1 - jnp.exp(-safe)) / safe, jnp.where(z > 0.3, 0.0, series))
