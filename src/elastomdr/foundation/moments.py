"""Relaxation moments: integrals of exp(-r/s) against Legendre polynomials, exact for every decay length s.

In steady sliding all contact integrals have the form int E(r/v) h(r) dr with a smooth h that knows nothing of the
material. With h expanded in Legendre polynomials on an interval, one branch enters through

    mu_j(z) = int_0^1 exp(-z c) P_j(1 - 2c) dc = exp(-z/2) i_j(z/2),        z = width/s,

i_j the modified spherical Bessel function. So a boundary layer at the leading edge, however thin, costs nothing.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Float

from .._runtime import Array


@jax.custom_jvp
def contract(coefficients: tuple[Array, ...], z: Float[Array, "*shape"]) -> Float[Array, "..."]:
    """sum_j c_j mu_j(z) for z >= 0 and at least two coefficients, broadcast against each other.

    One sweep: the ratios i_j/i_{j-1} by backward recurrence where z is small, forward recurrence where it is large,
    the sum taken along the way. Start: Amos' bound (Math. Comp. 28, 1974). Recurrences: DLMF 10.51.
    """
    count = len(coefficients)
    switch = max(count, count * count / 8)
    half = z / 2
    small, large = jnp.minimum(half, switch), jnp.maximum(half, switch)

    top = count + (8 if count <= 9 else 12 if count <= 17 else 26)
    ratio = small / (top + 1.5 + jnp.sqrt((top + 1.5) ** 2 + small**2))
    total = 0.0
    for j in range(top, 0, -1):
        ratio = small / ((2 * j + 1) + small * ratio)
        if j < count:
            total = ratio * (coefficients[j] + total)
    low = _mean_decay(2 * small) * (coefficients[0] + total)

    inverse, decay = 1 / large, jnp.exp(-2 * large)
    before = 0.5 * (1 - decay) * inverse
    mu = 0.5 * (1 + decay) * inverse - before * inverse
    high = coefficients[0] * before + coefficients[1] * mu
    for j in range(1, count - 1):
        before, mu = mu, before - (2 * j + 1) * inverse * mu
        high = high + coefficients[j + 1] * mu
    return jnp.where(half <= switch, low, high)


@contract.defjvp
def _contract_jvp(primals, tangents):
    """d mu_j/dz = -(1/2)[mu_j - ((j+1) mu_{j+1} + j mu_{j-1})/(2j+1)]: again a contraction."""
    (coefficients, z), (coefficient_tangents, z_tangent) = primals, tangents
    padded = (0.0, *coefficients, 0.0, 0.0)
    derivative = tuple(
        -0.5 * (padded[i + 1] - i / (2 * i - 1) * padded[i] - (i + 1) / (2 * i + 3) * padded[i + 2])
        for i in range(len(coefficients) + 1)
    )
    value = contract(coefficients, z)
    return value, contract(coefficient_tangents, z) + z_tangent * contract(derivative, z)


def _mean_decay(z: Array) -> Array:
    """(1 - exp(-z))/z, by its series where the difference would lose digits."""
    series = jnp.ones_like(z)
    for k in range(13, 1, -1):
        series = 1 - z / k * series
    safe = jnp.where(z > 0.3, z, 1.0)
    return jnp.where(z > 0.3, (1 - jnp.exp(-safe)) / safe, jnp.where(z > 0.3, 0.0, series))
