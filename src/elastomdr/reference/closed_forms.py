"""Friction of a rough line in full contact in closed form, a sum over its waves:

    F_x = sum (1/2) A_k^2 k E*''(k v),      mu = F_x/F_N,

A_k the amplitude of the wave k, E* = E/(1 - nu^2) the modulus of the half-space, forces
per length of line. The rubber follows the line, so that the force under it is known:
where it would have to pull, contact is not full and there is no answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arrays import xp
from ..call.problem import Asked, steady_scene
from ..checks import Array, numpy_unless_traced
from ..element.law import surface_foundation
from ..errors import InputError
from ..surface.rough_line import RoughLine
from .points import needs_half_space

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike
    from ..call.types import Material


@numpy_unless_traced
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
    needs_half_space(foundation)
    if not isinstance(line, RoughLine):
        raise InputError(argument="line", got=line, accepted="an em.RoughLine")
    asked = Asked(velocity, load, temperature=temperature)
    scene = steady_scene(foundation, line, asked, "load")
    v, force = scene.reduced, scene.at_reference().reshape(scene.shape)
    waves = xp.fft.rfft(line.height)[1:]
    k = 2 * xp.pi * xp.arange(1, waves.shape[0] + 1) / line.period
    modulus = foundation.complex_modulus(xp.asarray(v)[..., None] * k)
    # the shortest wave counts once
    twice = xp.where(2 * xp.arange(1, waves.shape[0] + 1) == line.count, 0.5, 1.0)
    drag = (
        2
        / line.count**2
        * xp.sum(twice * xp.abs(waves) ** 2 * k * modulus.imag, axis=-1)
    )
    # The line moves towards +x under the rubber, which meets the wave k as exp(-i k v
    # t): conjugate of E*(k v).
    lifted = xp.concatenate(
        [xp.zeros_like(modulus[..., :1]), xp.conj(modulus) * waves], axis=-1
    )
    least = xp.min(xp.fft.irfft(lifted, n=line.count), axis=-1)
    return xp.where(xp.asarray(force) + least >= 0, drag / force, xp.nan)
