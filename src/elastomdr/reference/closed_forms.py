"""Closed forms: friction of a rough line in full contact, and the rolling resistance of
a cylinder on a thin cover that loses little.

**Full contact.** A rough line that touches the rubber everywhere, a sum over its waves:

    F_x = sum (1/2) A_k^2 k E*''(k v),      mu = F_x/F_N,

A_k the amplitude of the wave k, E* = E/(1 - nu^2) the modulus of the half-space, forces
per length of line. The rubber follows the line, so that the force under it is known:
where it would have to pull, contact is not full and there is no answer.

**Small damping.** A cover of springs side by side, K* = K' + i K'' per area, is indented
elastically over a half-width a,

    W/L = (4/3) K' a^3/D,
    F/L = (1/pi) int_0^inf k K''(k v) |u_k|^2 dk,
    u_k = 4 (sin ka - ka cos ka)/(D k^3),

D the diameter of the roll, L its length, W its load, F the resistance to first order in
the loss. For a K'' that does not depend on frequency the integral is (4/pi) K''
a^4/D^2, so that F/W = (3/pi) (K''/K') a/D. With a spectrum both moduli are taken at the
frequency 2 v/a, near which a passage dissipates most (k a = 2.08 is the peak over ln
k).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import jax.numpy as jnp
import numpy as np

from ..checks import (
    Array,
    in_float64,
    is_traced,
)
from ..element.law import Foundation, surface_foundation
from ..errors import InputError
from ..surface.rough_line import RoughLine
from ..surface.shapes import Cylinder
from .points import at_reference

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike
    from ..call.types import Material

# Steps for the half-width, a = [(3/4) D W/(L K'(2 v/a))]^(1/3). Each leaves n/3 of the
# error, n = d ln K'/d ln omega: some per cent of it where little is lost, for which n =
# (2/pi) delta; two thirds at most, as n < 2 for any spectrum.
_STEPS = 40


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
    v, force = at_reference(foundation, temperature, velocity=velocity, load=load)
    waves = jnp.fft.rfft(jnp.asarray(line.height))[1:]
    k = 2 * jnp.pi * jnp.arange(1, waves.shape[0] + 1) / line.period
    modulus = foundation.complex_modulus(jnp.asarray(v)[..., None] * k)
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


@in_float64
def small_damping(
    cover: Foundation,
    roll: Cylinder,
    *,
    velocity: ArrayLike,
    load: ArrayLike,
    temperature: ArrayLike | None = None,
) -> Float[Array, "..."]:
    """Rolling resistance over load of a roll on a cover of small damping, in closed
    form.

        f = (3/pi) tan(delta) a/D,
        a = [(3/4) D W/(L K')]^(1/3),
        K' and tan(delta) = K''/K' at omega = 2 v/a

    Args:
        cover: an `em.springs`, or a `Foundation` per area, K* [Pa/m].
        roll: an `em.Cylinder` of diameter D = 2 radius and length L.
        velocity: rolling velocity v [m/s]; velocity, load and temperature broadcast.
        load: normal force W [N].
        temperature: temperature [K], for a cover with a shift law.

    Returns:
        f, of the broadcast shape.

    Raises:
        InputError: for a roll that is no cylinder, or values that are not positive.

    Exact to first order in tan(delta) where K'' does not depend on frequency. With a
    spectrum it is an estimate: within 5 % of `em.rolling` at loss tangents of 0.1 to
    0.3 on that of example 23. Differentiable.

    Source: derived in `docs/belt.md`; the powers of load, thickness, modulus and
    diameter are those of Jonkers 1980 and Spaans 1991.
    """
    if not isinstance(cover, Foundation) or cover.per_area is False:
        raise InputError(
            "cover must be a layer, em.springs(rubber, thickness, bonded=False), "
            "got "
            f"{cover!r}."
        )
    if not isinstance(roll, Cylinder):
        raise InputError(f"roll must be an em.Cylinder(radius, length), got {roll!r}.")
    v, force = at_reference(cover, temperature, velocity=velocity, load=load)
    if not is_traced(cover) and not float(cover.equilibrium) > 0:
        raise InputError(
            "cover must have an equilibrium modulus: one that relaxes altogether "
            "does not lose little."
        )
    diameter = 2 * jnp.asarray(roll.radius)
    scale = 0.75 * diameter * force / jnp.asarray(roll.length)
    half = (scale / cover.equilibrium) ** (1 / 3) + 0 * v
    for _ in range(_STEPS):
        half = (scale / cover.storage(2 * v / half)) ** (1 / 3)
    return 3 / np.pi * cover.loss_tangent(2 * v / half) * half / diameter
