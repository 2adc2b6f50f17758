"""Friction of a rough line that touches the rubber everywhere: a sum over its waves, in
closed form.

    F_x = sum (1/2) A_k^2 k E*''(k v),      mu = F_x/F_N,

A_k the amplitude of the wave k, E* = E/(1 - nu^2) the modulus of the half-space, forces
per length of line. The rubber follows the line, so that the force under it is known:
where it would have to pull, contact is not full and there is no answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import jax.numpy as jnp
import numpy as np

from ..checks import Array, as_float64, broadcast_shape, in_float64, in_kelvin, positive
from ..element.law import surface_foundation
from ..errors import InputError
from ..material.shift import thermal_factors
from ..surface.rough_line import RoughLine

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike
    from ..call.types import Material


@in_float64
def full_contact_sliding(
    material: Material,
    line: RoughLine,
    *,
    velocity: ArrayLike,
    load: ArrayLike,
    temperature: ArrayLike | None = None,
) -> Float[Array, "..."]:
    """Friction coefficient of a rough line in full contact, mu = sum (1/2) A_k^2 k
    E*''(k v)/F_N.

    The line moves towards +x, as in `em.friction`. Velocity, load and temperature
    broadcast.

    Args:
        material: a material, which may be a `TabulatedModulus`, or a `Foundation`.
        line: the rough line.
        velocity: sliding velocity [m/s].
        load: normal force per length of line F_N [N/m].
        temperature: temperature [K], for a material with a shift law.

    Returns:
        mu, of the broadcast shape; NaN where the load does not keep the whole line in
        contact.

    Raises:
        InputError: for a line that is no `em.RoughLine`, or values that are not
            positive.

    Exact for the bare line (`em.friction(..., model=em.Line())`), taken as waves
    through its samples. Differentiable.

    Source: Popov & Hess 2015, ch. 10.
    """
    foundation = surface_foundation(material)
    if foundation.per_area or not isinstance(line, RoughLine):
        raise InputError(
            "full contact is that of an em.RoughLine on a material or a "
            "half-space of it."
        )
    v, force, factor = as_float64("velocity", velocity), as_float64("load", load), 1.0
    vertical = np.ones(())
    positive("velocity", v)
    positive("load", force)
    if temperature is not None:
        kelvin = as_float64("temperature", temperature)
        in_kelvin("temperature", kelvin)
        factor, vertical = thermal_factors(foundation, kelvin)
    broadcast_shape(velocity=v, load=force, temperature=temperature)
    force = force / vertical
    waves = jnp.fft.rfft(jnp.asarray(line.height))[1:]
    k = 2 * jnp.pi * jnp.arange(1, waves.shape[0] + 1) / line.period
    modulus = foundation.complex_modulus((jnp.asarray(v) * factor)[..., None] * k)
    # the shortest wave counts once
    twice = jnp.where(2 * jnp.arange(1, waves.shape[0] + 1) == line.count, 0.5, 1.0)
    drag = (
        2
        / line.count**2
        * jnp.sum(twice * jnp.abs(waves) ** 2 * k * modulus.imag, axis=-1)
    )
    # The line moves towards +x under the rubber, which meets the wave k as exp(-i k v
    # t): conjugate of E*(k v).
    lifted = jnp.concatenate(
        [jnp.zeros_like(modulus[..., :1]), jnp.conj(modulus) * waves], axis=-1
    )
    least = jnp.min(jnp.fft.irfft(lifted, n=line.count), axis=-1)
    return jnp.where(jnp.asarray(force) + least >= 0, drag / force, jnp.nan)
