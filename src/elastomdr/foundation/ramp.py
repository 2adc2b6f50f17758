"""A branch under a rate of displacement that is linear over a step: exact weights of both ends."""

import jax.numpy as jnp

from .._runtime import Array


def ramp_weights(z: Array) -> tuple[Array, Array, Array]:
    """exp(-z), int_0^1 exp(-(1-s) z) (1-s) ds and int_0^1 exp(-(1-s) z) s ds, to full accuracy for z >= 0.

    What is left of a branch after a step of z relaxation times, and what a rate that is linear over the step adds, from
    its value at the start and at the end.
    """
    small, large = jnp.minimum(z, 1.0), jnp.maximum(z, 1.0)
    series = jnp.ones_like(z)
    for k in range(18, 2, -1):
        series = 1 - small / k * series
    series = 0.5 * series
    mean = 1 - small * series
    left = jnp.exp(-large)
    mean_large = (1 - left) / large
    late = jnp.where(z < 1, series, (1 - mean_large) / large)
    mean = jnp.where(z < 1, mean, mean_large)
    return jnp.where(z < 1, 1 - small * (1 - small * series), left), mean - late, late
