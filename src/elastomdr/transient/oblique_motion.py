"""Oblique impact: the tangential motion of a body during an impact, with Coulomb
friction element by element.

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
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp

from ..checks import Array
from ..element.contact_step import coefficients
from .shear_motion import Scene, line, step, untouched

if TYPE_CHECKING:
    from jaxtyping import Float

_ITERATIONS = 40
_MET = 1e-13  # relative change of a step's displacement at which its search ends


class Course(NamedTuple):
    """A normal impact at its instants, and what moves tangentially."""

    time: Float[Array, " instants"]
    depth: Float[Array, " instants"]
    velocity: Float[Array, " instants"]
    force: Float[Array, " instants"]
    mass: Array  # m [kg]
    tangential_mass: Array  # m_t [kg]
    tangential_velocity: Array  # u at touch [m/s]


class Deflection(NamedTuple):
    """The tangential motion at the same instants."""

    velocity: Float[Array, " instants"]  # u [m/s]
    force: Float[Array, " instants"]  # F_x against the motion [N]
    slip_loss: Array  # turned into heat by slip [J]


@functools.partial(jax.jit, static_argnames=("elements", "steps", "per_area"))
def deflect(
    scene: Scene, course: Course, *, elements: int, steps: int, per_area: bool
) -> Deflection:
    """The tangential motion, with `steps` contact steps between two instants."""
    grid = line(scene, elements, per_area)
    mass = course.tangential_mass

    def interval(carry: tuple, ends: tuple) -> tuple:
        start, end = ends
        span = end[0] - start[0]
        h = span / steps
        normal, tangential = (
            coefficients(scene.normal, h),
            coefficients(scene.tangential, h),
        )

        def advance(carry: tuple, i: Array) -> tuple:
            state, speed, force = carry
            depth = _quintic(start, end, course.mass, (i + 1) / steps)
            following = functools.partial(
                _displacement, speed * h, force, 0.25 * h**2 / mass
            )
            state, ((after, *_), _) = step(
                scene, grid, normal, tangential, state, depth, following, False
            )
            return (state, speed - 0.5 * h * (force + after) / mass, after), None

        carry, _ = jax.lax.scan(advance, carry, jnp.arange(steps))
        return carry, (carry[1], carry[2], carry[0].slip_loss)

    rows = jnp.stack([course.time, course.depth, course.velocity, course.force], axis=1)
    carry = (untouched(scene, grid), course.tangential_velocity, jnp.zeros(()))
    _, (speed, force, loss) = jax.lax.scan(interval, carry, (rows[:-1], rows[1:]))
    return Deflection(
        jnp.concatenate([course.tangential_velocity[None], speed]),
        jnp.concatenate([jnp.zeros(1), force]),
        loss[-1],
    )


def _quintic(start: Array, end: Array, mass: Array, s: Array) -> Array:
    """Depth at a fraction s of an interval, from depth, velocity and acceleration at
    its ends.
    """
    h = end[0] - start[0]
    p0, p1, v0, v1 = start[1], end[1], h * start[2], h * end[2]
    a0, a1 = -(h**2) * start[3] / mass, -(h**2) * end[3] / mass
    rise = p1 - p0 - v0 - 0.5 * a0
    slope, bend = v1 - v0 - a0, a1 - a0
    cubic, quartic, quint = (
        10 * rise - 4 * slope + 0.5 * bend,
        -15 * rise + 7 * slope - bend,
        6 * rise - 3 * slope + 0.5 * bend,
    )
    return p0 + s * (v0 + s * (0.5 * a0 + s * (cubic + s * (quartic + s * quint))))


def _displacement(free: Array, before: Array, compliance: Array, force: Any) -> Array:
    """x with x = free - compliance (F_before + F(x)): Newton in a bracket, since F
    rises in straight pieces.
    """

    def residual(x: Array) -> Array:
        return x - free + compliance * (before + force(x))

    fixed = jax.lax.stop_gradient

    def advance(state: tuple) -> tuple:
        x, low, high, _, count = state
        value, slope = _value_and_slope(residual, x)
        low, high = jnp.where(value < 0, x, low), jnp.where(value < 0, high, x)
        newton = x - value / slope
        following = jnp.where(
            (newton >= low) & (newton <= high), newton, 0.5 * (low + high)
        )
        done = jnp.abs(following - x) <= _MET * (jnp.abs(free) + jnp.abs(following))
        return following, low, high, done, count + 1

    edge = jnp.abs(free) + compliance * jnp.abs(before) + 1e-300
    edge = (
        edge
        + compliance * jnp.abs(fixed(force(edge)))
        + compliance * jnp.abs(fixed(force(-edge)))
    )
    start = (free, -2 * edge, 2 * edge, jnp.zeros((), bool), 0)
    x = fixed(
        jax.lax.while_loop(
            lambda s: ~s[3] & (s[4] < _ITERATIONS), advance, fixed(start)
        )[0]
    )
    value, slope = _value_and_slope(residual, x)
    return x - value / fixed(slope)


def _value_and_slope(residual: Any, x: Array) -> tuple[Array, Array]:
    return jax.jvp(residual, (x,), (jnp.ones_like(x),))
