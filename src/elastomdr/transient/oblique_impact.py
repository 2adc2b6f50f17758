"""The oblique part of `em.impact`: arguments, and the tangential motion of every
point.
"""

from typing import Any, NamedTuple

import numpy as np

from ..checks import as_float64, finite, nan_unless, positive, require, scalar
from ..element.law import Foundation, half_space
from ..errors import InputError
from ..material.prony import Prony
from ..material.relaxation import Relaxation
from ..material.shift import thermal_factors
from ..numerics.interpolation import halving_limit
from ..surface.disc import disc_under
from ..surface.shapes import AbstractShape, Cylinder, FlatPunch
from .impact_result import History, Oblique

_ELEMENTS, _STEPS = 500, 16


class Slips(NamedTuple):
    """What an oblique impact needs beside the normal one."""

    velocity: Any  # of the point of contact at touch [m/s]
    friction: Any
    inertia: Any  # [kg m^2], or None
    tangential: Foundation


def check_oblique(
    material: Any, velocity: Any, friction: Any, inertia: Any, tangential: Any
) -> Slips | None:
    """The oblique part's arguments, or None without one. Raises `InputError` for what
    has no meaning.
    """
    if velocity is None:
        given = {"friction": friction, "inertia": inertia, "tangential": tangential}
        for name, value in given.items():
            if value is not None:
                raise InputError(
                    f"{name} belongs to an oblique impact: give "
                    "tangential_velocity "
                    "as well."
                )
        return None
    if friction is None:
        raise InputError("friction must be given with tangential_velocity.")
    if isinstance(material, (list, tuple)):
        raise InputError(
            "material must be one material in an oblique impact, got a list."
        )
    velocity, friction = (
        as_float64("tangential_velocity", velocity),
        as_float64("friction", friction),
    )
    finite("tangential_velocity", velocity)
    require(
        "friction", friction, "zero or positive, infinity included", lambda x: x >= 0
    )
    if inertia is not None:
        inertia = scalar("inertia", inertia)
        positive("inertia", inertia)
    if tangential is None and not isinstance(material, Prony):
        raise InputError(
            "tangential must be given with a Foundation, which only knows the normal "
            "direction: em.half_space(material, tangential=True), or an em.Foundation "
            "of G*."
        )
    tangential = material if tangential is None else tangential
    if isinstance(tangential, Prony):
        tangential = half_space(tangential, tangential=True)
    if not isinstance(tangential, Foundation):
        raise InputError(
            f"tangential must be an em.Foundation of G*, got {tangential!r}."
        )
    return Slips(velocity, friction, inertia, tangential)


def solve_oblique(
    slips: Slips, scene: Any, shape: AbstractShape, history: History, found: Any
) -> Oblique:
    """The tangential motion of every point of an impact that is solved already; NaN
    where that failed.
    """
    import jax
    import jax.numpy as jnp

    from .oblique_motion import Course, deflect
    from .shear_motion import Scene

    count = int(np.prod(scene.shape))

    def flat(field: Any) -> Any:
        return jnp.broadcast_to(jnp.asarray(field), scene.shape).reshape(-1)

    body = jax.tree.map(jnp.asarray, scene.body)
    mass, u = flat(scene.mass), flat(slips.velocity)
    lever = shape.rolling_radius
    rotation = (
        0.0
        if lever is None
        else 1 / ((0.5 if isinstance(shape, Cylinder) else 0.4) * mass)
    )
    if slips.inertia is not None:
        rotation = (0.0 if lever is None else lever) ** 2 / slips.inertia
    effective = 1 / (1 / mass + rotation)
    law = slips.tangential.law()
    factor, vertical, own = jnp.ones(count), jnp.ones(count), slips.tangential
    if scene.temperature is not None and (
        own.shift is not None or own.vertical is not None
    ):
        factor, vertical = (flat(x) for x in thermal_factors(own, scene.temperature))
    deepest = jnp.asarray(found.motion.max_depth)
    disc = disc_under(shape, scene.per_area)
    reach = disc.radius_of_depth(jnp.where(deepest > 0, deepest, 1e-9))
    reach = reach if isinstance(shape, FlatPunch) else reach * (1 + 2 / _ELEMENTS)
    reach = jnp.minimum(reach, jnp.asarray(shape.largest_contact) * (1 - 1e-12))
    rates = jnp.broadcast_to(body.rates, (body.rates.shape[0], count))[1:]
    moduli = jnp.broadcast_to(body.moduli, (body.moduli.shape[0], count))
    viscosity = jnp.broadcast_to(body.viscosity, (count,))

    def one(point: tuple, finer: int) -> Any:
        rates, moduli, viscosity, factor, vertical, reach, mu, course = point
        times = 1 / jnp.where(rates > 0, rates, 1.0)
        normal = Relaxation(moduli[0], moduli[1:], times, viscosity)
        sheared = Relaxation(
            jnp.asarray(law.equilibrium) * vertical,
            jnp.asarray(law.moduli) * vertical,
            jnp.asarray(law.times) * factor,
            law.viscosity * factor * vertical,
        )
        place = Scene(shape, normal, sheared, mu, reach)
        elements, steps = _ELEMENTS * finer // 2, _STEPS * finer // 2
        return deflect(
            place, course, elements=elements, steps=steps, per_area=scene.per_area
        )

    def series(field: Any) -> Any:
        return jnp.asarray(field).reshape(count, -1)

    course = Course(
        series(history.time),
        series(history.depth),
        series(history.velocity),
        series(history.force),
        mass,
        effective,
        u,
    )
    points = (
        rates.T,
        moduli.T,
        viscosity,
        factor,
        vertical,
        reach,
        flat(slips.friction),
        course,
    )
    coarse, fine = (
        jax.lax.map(lambda point, n=n: one(point, n), points) for n in (1, 2)
    )
    # Where nothing slips until it lets go the scheme is of first order, else of second.
    limit = jax.tree.map(halving_limit, coarse, fine)
    after = limit.velocity[:, -1]
    error = (
        jnp.where(jnp.isinf(flat(slips.friction)), 2, 1)
        * jnp.abs(after - coarse.velocity[:, -1])
        * 0.75
    )
    good = (
        jnp.asarray(found.converged) & ~jnp.asarray(found.stuck) & jnp.isfinite(after)
    )

    def shaped(field: Any) -> Any:
        field = nan_unless(good.reshape(-1, *[1] * (field.ndim - 1)), field)
        return field.reshape((*scene.shape, *field.shape[1:]))

    return Oblique(
        before=u.reshape(scene.shape),
        after=shaped(after),
        slip_loss=shaped(limit.slip_loss),
        lost=shaped(0.5 * effective * (u**2 - after**2)),
        velocity=shaped(limit.velocity),
        force=shaped(limit.force),
        error=shaped(error),
        tangential_mass=effective.reshape(scene.shape),
    )
