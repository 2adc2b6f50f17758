"""Friction of a rough line that touches the rubber everywhere: a sum over its waves, in closed form.

    F_x = sum (1/2) A_k^2 k E*''(k v),      mu = F_x/F_N,

A_k the amplitude of the wave k, E* = E/(1 - nu^2) the modulus of the half-space, forces per length of line. The rubber
follows the line, so that the force under it is known: where it would have to pull, contact is not full and there is no
answer.
"""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .._runtime import Array, as_float64, in_float64, positive
from ..errors import InputError
from ..foundation.law import as_foundation
from ..mapping.rough_line import RoughLine


@in_float64
def full_contact_sliding(
    material: Any, line: RoughLine, *, velocity: Any, load: Any, temperature: Any = None
) -> Float[Array, "..."]:
    """Friction coefficient of a rough line in full contact, mu = sum (1/2) A_k^2 k E*''(k v)/F_N.

    The line moves towards +x, as in `em.friction`. `velocity` [m/s], `load` F_N [N/m] and `temperature` [K] (for a
    material with a shift law) broadcast. NaN where the load does not keep the whole line in contact. Exact for the bare
    line (`em.friction(..., average=None)`), taken as waves through its samples. Differentiable. Raises `InputError`.
    Source: Popov & Hess 2015, ch. 10.
    """
    foundation = as_foundation(material)
    if foundation.per_area or not isinstance(line, RoughLine):
        raise InputError("full contact is that of an em.RoughLine on a material or a half-space of it.")
    v, force, factor = as_float64("velocity", velocity), as_float64("load", load), 1.0
    positive("velocity", v)
    positive("load", force)
    if temperature is not None:
        if foundation.shift is None:
            raise InputError(f"temperature was given, but {foundation.name or 'the material'} has no shift law.")
        kelvin = as_float64("temperature", temperature)
        positive("temperature", kelvin)
        factor = foundation.shift.a(kelvin)
    shapes = [np.shape(v), np.shape(force), np.shape(factor)]
    try:
        np.broadcast_shapes(*shapes)
    except ValueError as error:
        raise InputError(f"velocity, load and temperature must broadcast, got shapes {shapes}.") from error
    waves = jnp.fft.rfft(jnp.asarray(line.height))[1:]
    k = 2 * jnp.pi * jnp.arange(1, waves.shape[0] + 1) / line.period
    modulus = foundation.complex_modulus((jnp.asarray(v) * factor)[..., None] * k)
    twice = jnp.where(2 * jnp.arange(1, waves.shape[0] + 1) == line.count, 0.5, 1.0)  # the shortest wave counts once
    drag = 2 / line.count**2 * jnp.sum(twice * jnp.abs(waves) ** 2 * k * modulus.imag, axis=-1)
    # The line moves towards +x under the rubber, which meets the wave k as exp(-i k v t): conjugate of E*(k v).
    lifted = jnp.concatenate([jnp.zeros_like(modulus[..., :1]), jnp.conj(modulus) * waves], axis=-1)
    least = jnp.min(jnp.fft.irfft(lifted, n=line.count), axis=-1)
    return jnp.where(jnp.asarray(force) + least >= 0, drag / force, jnp.nan)
