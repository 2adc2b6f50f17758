"""The rolling resistance of a cylinder on a thin cover that loses little, in closed
form, to lay beside `em.rolling`.

A cover of springs side by side, K* = K' + i K'' per area, is dented elastically over a
half-width a,

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
    as_float64,
    broadcast_shape,
    in_float64,
    in_kelvin,
    is_traced,
    positive,
)
from ..element.law import Foundation
from ..errors import InputError
from ..material.shift import thermal_factors
from ..surface.shapes import Cylinder

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike

# Steps for the half-width, a = [(3/4) D W/(L K'(2 v/a))]^(1/3). Each leaves n/3 of the
# error, n = d ln K'/d ln omega: some per cent of it where little is lost, for which n =
# (2/pi) delta; two thirds at most, as n < 2 for any spectrum.
_STEPS = 40


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
    v, force, factor = as_float64("velocity", velocity), as_float64("load", load), 1.0
    vertical = np.ones(())
    positive("velocity", v)
    positive("load", force)
    if temperature is not None:
        kelvin = as_float64("temperature", temperature)
        in_kelvin("temperature", kelvin)
        factor, vertical = thermal_factors(cover, kelvin)
    if not is_traced(cover) and not float(cover.equilibrium) > 0:
        raise InputError(
            "cover must have an equilibrium modulus: one that relaxes altogether "
            "does not lose little."
        )
    broadcast_shape(velocity=v, load=force, temperature=temperature)
    force = force / vertical
    diameter = 2 * jnp.asarray(roll.radius)
    scale, speed = (
        0.75 * diameter * force / jnp.asarray(roll.length),
        jnp.asarray(v) * factor,
    )
    half = (scale / cover.equilibrium) ** (1 / 3) + 0 * speed
    for _ in range(_STEPS):
        half = (scale / cover.storage(2 * speed / half)) ** (1 / 3)
    return 3 / np.pi * cover.loss_tangent(2 * speed / half) * half / diameter
