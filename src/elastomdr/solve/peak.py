"""The maximum of a smooth function that is known at equal steps."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .._runtime import Array, argmax


def peak(force: Array, last: Any) -> tuple[Array, Array]:
    """The largest value of a smooth function given at equal steps, and where (0 to 1), by a polynomial."""
    half = _NEAR // 2
    first = jnp.clip(argmax(jax.lax.stop_gradient(force)) - half, 0, last + 1 - _NEAR)
    rows = jnp.take_along_axis(force, first[None] + jnp.arange(_NEAR)[:, None], axis=0)
    coefficients = jnp.einsum("ij,j...->i...", jnp.asarray(_THROUGH), rows)  # of powers of x, the nodes at -1 ... 1

    def value(x: Array) -> Array:
        return functools.reduce(lambda sum, c: sum * x + c, coefficients[::-1])

    fixed, powers = jax.lax.stop_gradient(coefficients), np.arange(_NEAR)[:, None]
    x = argmax(jax.lax.stop_gradient(rows)) / half - 1.0
    for _ in range(5):
        slope = jnp.sum((powers * fixed)[1:] * x ** (powers[1:] - 1), axis=0)
        bend = jnp.sum((powers * (powers - 1) * fixed)[2:] * x ** (powers[2:] - 2), axis=0)
        x = jnp.clip(x - jnp.where(bend < 0, slope / jnp.where(bend < 0, bend, -1.0), 0.0), -1.0, 1.0)
    return value(x), (first + half * (1 + x)) / last


_NEAR = 9  # nodes around the largest force
_THROUGH = np.linalg.inv(np.vander(np.linspace(-1.0, 1.0, _NEAR), increasing=True))
