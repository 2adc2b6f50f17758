"""The rolling resistance of a cylinder on a thin cover that loses little, in closed form, to lay beside `em.rolling`.

    f = (3/pi) tan(delta) a/D,      a = [(3/4) D W/(L K')]^(1/3),      K' and tan(delta) at the frequency 2 v/a

D the diameter of the roll, W/L the load per width, K* = K' + i K'' the stiffness of the cover per area. Exact to first
order in the loss for a loss modulus that does not depend on frequency; with a spectrum the moduli are taken where a
passage dissipates most. These are the powers of load, thickness, modulus and diameter of the formulas in use for belt
conveyors (Jonkers 1980, Spaans 1991). Derived in `docs/belt.md`.
"""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .._runtime import Array, as_float64, in_float64, is_traced, positive
from ..errors import InputError
from ..foundation.law import Foundation
from ..mapping.shapes import Cylinder

_STEPS = 40  # of the half-width: a changes as K'(2 v/a)^(-1/3), so that each step leaves less than a third of the error


@in_float64
def small_damping(
    cover: Any, roll: Any, *, velocity: Any, load: Any, temperature: Any = None
) -> Float[Array, "..."]:  # fmt: skip
    """Rolling resistance coefficient of a roll on a cover of small damping, f = (3/pi) tan(delta) a/D.

    `cover` is an `em.layer`, or a `Foundation` per area, `roll` an `em.Cylinder`; `velocity` [m/s], `load` [N] and
    `temperature` [K] (for a cover with a shift law) broadcast. Within 5 % of `em.rolling` at loss tangents of 0.1 to
    0.3 on the spectrum of example 23. Differentiable. Raises `InputError`. Source: `docs/belt.md`.
    """
    if not isinstance(cover, Foundation) or cover.per_area is False:
        raise InputError(f"cover must be a layer, em.layer(rubber, thickness, bonded=False), got {cover!r}.")
    if not isinstance(roll, Cylinder):
        raise InputError(f"roll must be an em.Cylinder(radius, length), got {roll!r}.")
    v, force, factor = as_float64("velocity", velocity), as_float64("load", load), 1.0
    positive("velocity", v)
    positive("load", force)
    if temperature is not None:
        if cover.shift is None:
            raise InputError(f"temperature was given, but {cover.name or 'the cover'} has no shift law.")
        kelvin = as_float64("temperature", temperature)
        positive("temperature", kelvin)
        factor = cover.shift.a(kelvin)
    if not is_traced(cover) and not float(cover.equilibrium) > 0:
        raise InputError("cover must have an equilibrium modulus: one that relaxes altogether does not lose little.")
    shapes = [np.shape(v), np.shape(force), np.shape(factor)]
    try:
        np.broadcast_shapes(*shapes)
    except ValueError as error:
        raise InputError(f"velocity, load and temperature must broadcast, got shapes {shapes}.") from error
    diameter = 2 * jnp.asarray(roll.radius)
    scale, speed = 0.75 * diameter * force / jnp.asarray(roll.length), jnp.asarray(v) * factor
    half = (scale / cover.equilibrium) ** (1 / 3) + 0 * speed
    for _ in range(_STEPS):
        half = (scale / cover.storage(2 * speed / half)) ** (1 / 3)
    return 3 / np.pi * cover.loss_tangent(2 * speed / half) * half / diameter
