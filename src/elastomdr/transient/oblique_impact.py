"""The oblique part of `em.impact`: arguments, and the tangential motion of every point,
with Coulomb friction element by element.

Normal motion does not feel the tangential one, so that d(t) is that of
`transient.impact_motion`; in between its instants it is the quintic through depth,
velocity and acceleration. The point of contact has the velocity u = v_x + R omega, and

    m_t u' = -F_x,    1/m_t = 1/m + R^2/I        (m_t = 2/7 m for a homogeneous ball),

F_x from `transient.shear_motion`. The momentum is changed by the trapezoidal rule, the
displacement of a step is found together with the force at its end, which rises with it.
Second order in the step. For an elastic ball this is the problem of Maw, Barber &
Fawcett (1976), in MDR Lyashenko & Popov (2015).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import tree_map
from ..checks import Array, as_float64, finite, nan_unless, positive, require, scalar
from ..element.contact_step import Coefficients, coefficients
from ..element.law import Foundation
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..material.shift import thermal_factors
from ..numerics.root import root
from ..results.base import part, quantity
from ..surface.disc import disc_under
from ..surface.shapes import AbstractShape, Cylinder, FlatPunch
from .march import march
from .problem import both_laws
from .refinement import limit
from .shear_motion import ShearScene, ShearState, line, step, untouched

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike
    from .impact_motion import Impacts

_ELEMENTS, _STEPS = 500, 16  # over the radius, and between two instants
_BODIES = 32  # marched together: their elements fit the processor's cache
_MET = 1e-13  # relative change of a step's displacement at which its search ends


@part
class ObliqueHistory:
    """The motion at instants from touch (first) to separation (last); they lie closer
    where it changes fast.

    Every field has the impact's shape and one more axis, for the instants; the turn is
    the one in the middle.
    """

    time: Array = quantity("time since touch", "s", dims="... instant", shown="ms")
    depth: Array = quantity("depth", "m", "d", dims="... instant")
    velocity: Array = quantity(
        "velocity", "m/s", "d', positive into the rubber", dims="... instant"
    )
    force: Array = quantity("contact force", "N", dims="... instant")


@part
class Oblique:
    """The tangential motion of the point of contact; series at the instants of the
    history.
    """

    before: Array = quantity("tangential velocity at touch", "m/s")
    after: Array = quantity("tangential velocity at separation", "m/s")
    slip_loss: Array = quantity("lost by slip", "J", "turned into heat by slip")
    lost: Array = quantity(
        "tangential kinetic energy lost", "J", "m_t/2 (before^2 - after^2)"
    )
    velocity: Array = quantity("tangential velocity", "m/s", dims="... instant")
    force: Array = quantity(
        "tangential force", "N", "against the motion", dims="... instant"
    )
    error: Array = quantity(
        "estimated error of the tangential velocity at separation", "m/s"
    )
    model_error: Array = quantity(
        "bound on the error of the model of slip", "m/s", "NaN: not known"
    )
    tangential_mass: Array = quantity("tangential mass", "kg", "m_t")


class Slips(NamedTuple):
    """What an oblique impact needs beside the normal one."""

    velocity: Any  # of the point of contact at touch [m/s]
    friction: Any
    inertia: Any  # [kg m^2], or None
    tangential: Foundation


def check_oblique(
    material: Any,
    velocity: ArrayLike | None,
    friction: ArrayLike | None,
    inertia: ArrayLike | None,
    tangential: Foundation | None,
) -> Slips | None:
    """The oblique part's arguments, or None without one. Raises `InputError` for what
    has no meaning.
    """
    if velocity is None:
        given = {"friction": friction, "inertia": inertia, "tangential": tangential}
        for name, value in given.items():
            if value is not None:
                raise InputError(
                    argument=name,
                    got=value,
                    accepted="left out without tangential_velocity",
                )
        return None
    if friction is None:
        raise InputError(argument="friction", accepted="given with tangential_velocity")
    if isinstance(material, (list, tuple)):
        raise InputError(
            argument="material",
            got=material,
            accepted="one material in an oblique impact",
        )
    velocity = as_float64("tangential_velocity", velocity)
    friction = as_float64("friction", friction)
    finite("tangential_velocity", velocity)
    accepted = "zero or positive, infinity included"
    require("friction", friction, accepted, lambda x: x >= 0)
    if inertia is not None:
        inertia = scalar("inertia", inertia)
        positive("inertia", inertia)
    return Slips(velocity, friction, inertia, both_laws(material, tangential)[1])


class NormalImpact(NamedTuple):
    """Normal impacts at their instants."""

    time: Float[Array, "bodies instants"]
    depth: Float[Array, "bodies instants"]
    velocity: Float[Array, "bodies instants"]
    force: Float[Array, "bodies instants"]


class Displaced(NamedTuple):
    """What moves tangentially."""

    mass: Float[Array, " bodies"]  # m [kg]
    tangential_mass: Float[Array, " bodies"]  # m_t [kg]
    velocity: Float[Array, " bodies"]  # u at touch [m/s]


class Deflection(NamedTuple):
    """The tangential motion at the same instants."""

    velocity: Float[Array, "bodies instants"]  # u [m/s]
    force: Float[Array, "bodies instants"]  # F_x against the motion [N]
    slip_loss: Float[Array, "bodies instants"]  # turned into heat by slip [J]


class ObliqueSteps(NamedTuple):
    """Contact steps."""

    h: Float[Array, "steps bodies"]  # [s]
    depth: Float[Array, "steps bodies"]  # at the end [m]


class Striking(NamedTuple):
    """Bodies that strike, with their laws, friction, reach and normal motion."""

    scene: ShearScene
    course: NormalImpact
    moved: Displaced


def solve_oblique(
    slips: Slips,
    scene: Any,
    shape: AbstractShape,
    history: ObliqueHistory,
    normal_impact: Impacts,
) -> Oblique:
    """The tangential motion of every point of an impact that is solved already; NaN
    where that failed.
    """
    count = int(np.prod(scene.shape))
    mass, u, friction = (
        np.broadcast_to(field, scene.shape).reshape(-1)
        for field in (scene.mass, slips.velocity, slips.friction)
    )
    moved = Displaced(mass, _tangential_mass(shape, mass, slips.inertia), u)
    fields = (history.time, history.depth, history.velocity, history.force)
    course = NormalImpact(*(np.reshape(field, (count, -1)) for field in fields))
    reach = _reach(shape, scene.per_area, np.asarray(normal_impact.motion.max_depth))
    laws = _laws(slips, scene, count)
    bodies = Striking(ShearScene(shape, *laws, friction, reach), course, moved)
    parts = [_select(bodies, slice(i, i + _BODIES)) for i in range(0, count, _BODIES)]

    def marched(finer: int) -> Deflection:
        elements, steps = _ELEMENTS * finer // 2, _STEPS * finer // 2
        found = [_deflect(part, elements, steps, scene.per_area) for part in parts]
        return tree_map(lambda *x: np.concatenate(x), *found)

    coarse, fine = marched(1), marched(2)
    # Where nothing slips until it lets go the scheme is of first order, else of second.
    best = limit((coarse, fine), (2,))
    after = best.velocity[:, -1]
    order = np.where(np.isinf(friction), 2, 1)
    error = order * np.abs(after - coarse.velocity[:, -1]) * 0.75
    known = normal_impact.converged & ~normal_impact.stuck
    good = np.asarray(known) & np.isfinite(after)

    def shaped(field: Array) -> Any:
        field = nan_unless(good.reshape(-1, *[1] * (field.ndim - 1)), field)
        return field.reshape((*scene.shape, *field.shape[1:]))

    return Oblique(
        before=u.reshape(scene.shape),
        after=shaped(after),
        slip_loss=shaped(best.slip_loss[:, -1]),
        lost=shaped(0.5 * moved.tangential_mass * (u**2 - after**2)),
        velocity=shaped(best.velocity),
        force=shaped(best.force),
        error=shaped(error),
        model_error=np.full(scene.shape, np.nan),
        tangential_mass=moved.tangential_mass.reshape(scene.shape),
    )


def _select(bodies: Striking, chosen: slice) -> Striking:
    """Some of the bodies."""
    scene, course, moved = bodies

    def of_law(law: Relaxation) -> Relaxation:
        parts = law.equilibrium, law.moduli, law.times, law.viscosity
        return Relaxation(*(x[..., chosen] for x in parts))

    laws = of_law(scene.normal), of_law(scene.tangential)
    friction, reach = scene.friction[chosen], scene.reach[chosen]
    return Striking(
        ShearScene(scene.shape, *laws, friction[:, None], reach),
        NormalImpact(*(x[chosen] for x in course)),
        Displaced(*(x[chosen] for x in moved)),
    )


def _tangential_mass(shape: AbstractShape, mass: Array, inertia: Array | None) -> Array:
    """m_t: 1/m_t = 1/m + R^2/I, by default of a homogeneous ball or cylinder."""
    lever = shape.rolling_radius
    if lever is None:
        return mass
    share = 0.5 if isinstance(shape, Cylinder) else 0.4  # I/(m R^2)
    rotation = 1 / (share * mass) if inertia is None else lever**2 / inertia
    return 1 / (1 / mass + rotation)


def _laws(slips: Slips, scene: Any, count: int) -> tuple[Relaxation, Relaxation]:
    """E* and G* of each body, at its temperature, bodies along the last axis."""
    rates, moduli, viscosity = (
        np.broadcast_to(x, (*np.shape(x)[:-1], count))
        for x in (scene.body.rates, scene.body.moduli, scene.body.viscosity)
    )
    times = 1 / np.where(rates > 0, rates, 1.0)
    normal = Relaxation(moduli[0], moduli[1:], times[1:], viscosity)
    law, foundation = slips.tangential.law(), slips.tangential
    factor = vertical = np.ones(count)
    shifted = foundation.shift is not None or foundation.vertical is not None
    if scene.temperature is not None and shifted:
        factor, vertical = (
            np.broadcast_to(x, scene.shape).reshape(-1)
            for x in thermal_factors(foundation, scene.temperature)
        )
    tangential = Relaxation(
        law.equilibrium * vertical,
        np.asarray(law.moduli)[:, None] * vertical,
        np.asarray(law.times)[:, None] * factor,
        law.viscosity * factor * vertical,
    )
    return normal, tangential


def _reach(shape: AbstractShape, per_area: bool, deepest: Array) -> Array:
    """A radius [m] that the contact of each body does not exceed."""
    disc = disc_under(shape, per_area)
    reach = disc.radius_of_depth(np.where(deepest > 0, deepest, 1e-9))
    if not isinstance(shape, FlatPunch):
        reach = reach * (1 + 2 / _ELEMENTS)
    return np.minimum(reach, np.asarray(shape.largest_contact) * (1 - 1e-12))


def _deflect(bodies: Striking, elements: int, steps: int, per_area: bool) -> Deflection:
    """The tangential motion, with `steps` contact steps between two instants."""
    scene, course, moved = bodies
    grid = line(scene, elements, per_area)

    def prepare(block: ObliqueSteps) -> tuple[ObliqueSteps, Coefficients, Coefficients]:
        laws = scene.normal, scene.tangential
        normal, tangential = (_coefficients(law, block.h) for law in laws)
        return block, normal, tangential

    def advance(
        sliding: _Sliding, now: tuple[ObliqueSteps, Coefficients, Coefficients]
    ) -> tuple[_Sliding, None]:
        (state, speed, force), (end, cn, ct) = sliding, now
        free, compliance = speed * end.h, 0.25 * end.h**2 / moved.tangential_mass
        slide = functools.partial(_displacement, free, force, compliance)
        state, felt = step(scene, grid, cn, ct, state, end.depth, slide, False)
        speed = speed - 0.5 * end.h * (force + felt.force) / moved.tangential_mass
        return _Sliding(state, speed, felt.force), None

    def look(sliding: _Sliding, _: None) -> Deflection:
        return Deflection(sliding.speed, sliding.force, sliding.state.slip_loss)

    start = _Sliding(untouched(scene, grid), moved.velocity, 0 * moved.velocity)
    every = _steps(course, moved.mass, steps)
    is_seen = np.arange(1, len(every.h) + 1) % steps == 0
    _, seen = march(advance, look, start, every, is_seen, prepare)
    return tree_map(
        lambda a, b: np.concatenate([a[None], b]).T, look(start, None), seen
    )


class _Sliding(NamedTuple):
    """Elements and bodies at one instant."""

    state: ShearState
    speed: Array
    force: Array


def _coefficients(law: Relaxation, h: Float[Array, "steps bodies"]) -> Coefficients:
    """Of a block of steps, each body with its law: steps first, and a last axis for the
    elements.
    """
    steps = h.shape[0]

    def again(x: Array) -> Array:
        return np.tile(x, steps)

    parts = law.equilibrium, law.moduli, law.times, law.viscosity
    found = coefficients(Relaxation(*map(again, parts)), h.reshape(-1))

    def apart(x: np.ndarray) -> Array:
        return np.moveaxis(x.reshape(*x.shape[:-1], *h.shape), -2, 0)[..., None]

    return tree_map(apart, found)


def _steps(course: NormalImpact, mass: Array, steps: int) -> ObliqueSteps:
    """The depth between the instants: the quintic from depth, velocity and acceleration
    at both ends.
    """
    span = np.diff(course.time)[..., None]
    depth, velocity, force = (x[..., None] for x in course[1:])
    bend = -(span**2) / mass[:, None, None]
    p0, p1 = depth[:, :-1], depth[:, 1:]
    v0, v1 = span * velocity[:, :-1], span * velocity[:, 1:]
    a0, a1 = bend * force[:, :-1], bend * force[:, 1:]
    rise = p1 - p0 - v0 - 0.5 * a0
    slope, bend = v1 - v0 - a0, a1 - a0
    cubic = 10 * rise - 4 * slope + 0.5 * bend
    quartic = -15 * rise + 7 * slope - bend
    quint = 6 * rise - 3 * slope + 0.5 * bend
    s = np.arange(1, steps + 1) / steps
    ends = p0 + s * (v0 + s * (0.5 * a0 + s * (cubic + s * (quartic + s * quint))))
    h = np.repeat(span[..., 0] / steps, steps, axis=1)
    return ObliqueSteps(h.T, ends.reshape(h.shape).T)


def _displacement(
    free: Array, before: Array, compliance: Array, force: Callable[[Array], Array]
) -> Array:
    """x with x = free - compliance (F_before + F(x)); F rises in straight pieces."""
    scale = np.abs(free) + compliance * np.abs(before) + 1e-300

    def residual(scaled: Array) -> Array:
        return scaled + (compliance * (before + force(scale * scaled)) - free) / scale

    return scale * root(residual, free / scale, _MET, 1.0)[0]
