"""Steady tractive rolling: elements enter at the leading edge, are sheared by the creepage and slip where they must.

In the frame of the contact an element that has come a distance r from the leading edge and has not slipped is sheared
by xi r, xi the creepage, so that it carries the traction of a ramp,

    tau_stick(r) = xi [G_inf r + sum_k G_k s_k (1 - exp(-r/s_k)) + eta v],    s_k = v tau_k,

in units of force per length, as the normal q. It slips from the distance c on at which this has reached mu q, and

    F_x = int_0^c tau_stick dr + mu [F_N - Q(c)],    Q(c) = int_0^c q dr,

with q and Q exact from `solve.integrals`. An elastic paraboloid has F_x/(mu F_N) = 1 - (1 - zeta)^3, zeta = xi R
G*/(2 a mu E*) (Popov & Hess 2015, ch. 5; the brush of tyre mechanics). An element that has slipped stays slipping as
long as its own recovery is slower than the creepage, which is checked step by step; where one sticks again (a
dashpot, or tangential relaxation faster than the normal one), the force is that of the march, second order in its
step, of first order where a dashpot slips or slip begins within one: its error is the change on halving the step.

A tangential dashpot needs xi eta v at once, and elements slip over a distance c_0 behind the leading edge where mu q
is less. Where that ends within the first steps of the march, of length h, it is not resolved: the elements lag by at
most xi h, so that the traction is off by at most h [tau_stick(l) - xi eta v] + h tau_stick(h), l the length of the
contact. That counts as error.
"""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array
from ..foundation.decay import ramp_weights
from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .integrals import part_of_contact
from .memory import Passage
from .rule import Rule

_HALVINGS = 45
_ROUNDING = 4e-15  # of mu F_N: what sliding elements carry is the difference of two normal forces


class Rolling(NamedTuple):
    """Rolling contacts whose normal side is solved."""

    normal: Relaxation
    tangential: Relaxation
    lines: AbstractLines  # one line
    velocity: Float[Array, " points"]  # times a_T [m/s]
    leading: Float[Array, " points"]  # a [m]
    trailing: Float[Array, " points"]  # b [m]
    friction: Float[Array, " points"]
    creepage: Float[Array, " points"]  # xi, without its sign


class Tractions(NamedTuple):
    """Traction of many contacts."""

    force: Float[Array, " points"]  # F_x [N]
    stick: Float[Array, " points"]  # part of the contact's length that sticks
    error: Float[Array, " points"]  # estimated error of F_x [N]
    again: Bool[Array, " points"]  # elements stick again after they have slipped


@functools.partial(jax.jit, static_argnames=("rule", "steps"))
def tractions(rolling: Rolling, rule: Rule, steps: int) -> Tractions:
    """Tractive force of each point, with `steps` steps of the march; differentiable in both modes."""
    r = jax.tree.map(jnp.asarray, rolling)
    length = r.leading + r.trailing
    passage = Passage(r.normal, r.lines, rule, r.velocity)
    fixed = jax.lax.stop_gradient(r)

    def excess(distance: Array, r: Rolling) -> Array:
        passage = Passage(r.normal, r.lines, rule, r.velocity)
        density = part_of_contact(passage, r.leading, distance - r.leading)[0]
        return _limit(r.friction, density) - _ramp(r, distance)[0]

    marched, stick, first, again = _march(r, length, steps)
    coarse = _march(fixed, length, steps // 2)[0]
    low, high = jax.lax.stop_gradient(
        [length * jnp.asarray(_places(steps))[jnp.clip(first + i, 0, steps)] for i in (-2, 1)]
    )

    def halve(_: int, bounds: tuple) -> tuple:
        low, high = bounds
        middle = 0.5 * (low + high)
        sticks = excess(middle, fixed) > 0
        return jnp.where(sticks, middle, low), jnp.where(sticks, high, middle)

    low, high = jax.lax.fori_loop(0, _HALVINGS, halve, (low, high))
    distance = 0.5 * (low + high)
    # No derivative of the distance is needed: at its end both tractions are equal.
    distance = jnp.where(jnp.isinf(r.friction) | (r.creepage == 0), length, jnp.where(r.friction == 0, 0.0, distance))
    weight = r.lines.weight(r.leading)[0]
    every = part_of_contact(passage, r.leading, r.trailing)[1]
    _, before, missed = part_of_contact(passage, r.leading, distance - r.leading)
    sliding = jnp.where(distance < length, _limit(r.friction, every - before), 0.0)
    smooth = weight * _ramp(r, distance)[1] + sliding
    rounding = jnp.where(distance < length, _ROUNDING * _limit(r.friction, every), 0.0) + 1e-13 * jnp.abs(smooth)
    error = jnp.where(again, weight * jnp.abs(marched - coarse), _limit(r.friction, missed)) + rounding
    error = jnp.where(jnp.isfinite(error), error, rounding)
    error = error + jnp.where(stick > 0, weight * _early_slip(r, length, steps), 0.0)
    return Tractions(
        force=jnp.where(again, weight * marched, smooth),
        stick=jax.lax.stop_gradient(
            jnp.where(again, stick, jnp.where(distance > 1e-12 * length, distance / length, 0.0))
        ),
        error=jax.lax.stop_gradient(error),
        again=again,
    )


def _early_slip(r: Rolling, length: Array, steps: int) -> Array:
    """Bound on the traction per weight that slip within the first two steps takes."""
    slope = r.lines.slope(r.leading[None], r.leading, jnp.zeros((1, 1), int))[0]
    dashpot = r.creepage * r.tangential.viscosity * r.velocity
    slips = dashpot > _limit(r.friction, r.normal.viscosity * r.velocity * slope)
    h = length * _places(steps)[2]
    return jnp.where(slips, h * (_ramp(r, length)[0] - dashpot + _ramp(r, h)[0]), 0.0)


def _limit(friction: Array, pressed: Array) -> Array:
    """mu q, for friction coefficients that may be infinite."""
    return jnp.where(pressed > 0, friction * jnp.where(pressed > 0, pressed, 1.0), 0.0)


def _ramp(r: Rolling, distance: Array) -> tuple[Array, Array]:
    """tau_stick at a distance from the leading edge, and its integral up to there."""
    law = r.tangential
    z = distance / (r.velocity * law.times[:, None])
    _, early, late = ramp_weights(z)
    dashpot = law.viscosity * r.velocity
    moduli = law.moduli[:, None]
    traction = law.equilibrium * distance + jnp.sum(moduli * (early + late), axis=0) * distance + dashpot
    summed = 0.5 * law.equilibrium * distance**2 + jnp.sum(moduli * late, axis=0) * distance**2 + dashpot * distance
    return r.creepage * traction, r.creepage * summed


@functools.cache
def _places(steps: int) -> np.ndarray:
    """Ends of the steps over the length of the contact: closer at both edges."""
    s = np.arange(steps + 1) / steps
    return s**2 * (3 - 2 * s)


def _march(r: Rolling, length: Array, steps: int) -> tuple[Array, Array, Array, Array]:
    """Force per weight, part that sticks, first step that ends slipping, whether any sticks after it has slipped."""
    normal, tangential = r.normal, r.tangential
    zero = jnp.zeros_like(length)

    def rest(law: Relaxation) -> Array:
        return jnp.zeros((law.moduli.shape[0], *length.shape))

    def slope(distance: Array) -> Array:
        return r.lines.slope((r.leading - distance)[None], r.leading, jnp.zeros((1, 1), int))[0]

    def step(carry: tuple, ends: tuple) -> tuple:
        f, p, shear, tau, total, stuck, first, again, slipped = carry
        i, here, there = ends
        distance, h = length * there, length * (there - here)
        decay, early, late = ramp_weights(h / (r.velocity * normal.times[:, None]))
        f = decay * f + h * normal.moduli[:, None] * (early * slope(length * here) + late * slope(distance))
        pressed = r.lines.profile(r.leading[None], r.leading, jnp.zeros((1, 1), int))[0]
        pressed = pressed - r.lines.profile((r.leading - distance)[None], r.leading, jnp.zeros((1, 1), int))[0]
        q = normal.equilibrium * pressed + jnp.sum(f, axis=0) + normal.viscosity * r.velocity * slope(distance)
        limit = _limit(r.friction, q)

        decay, early, late = ramp_weights(h / (r.velocity * tangential.times[:, None]))
        mean = early + late
        free = tangential.equilibrium * shear + jnp.sum(decay * p, axis=0)
        stiffness = tangential.equilibrium + jnp.sum(tangential.moduli[:, None] * mean, axis=0)
        stiffness = stiffness + tangential.viscosity * r.velocity / h
        trial = free + stiffness * r.creepage * h
        slips = trial > limit
        moved = jnp.where(slips, (limit - free) / stiffness, r.creepage * h)
        new = jnp.where(slips, limit, trial)
        p = decay * p + tangential.moduli[:, None] * mean * moved
        restuck = slipped & ~slips & (trial < limit * (1 - 1e-9)) & (i < steps - 1)
        first = jnp.where(slips & ~slipped, i + 1, first)
        stuck = stuck + jnp.where(slips, 0.0, there - here)
        total = total + 0.5 * h * (tau + new)
        return (f, p, shear + moved, new, total, stuck, first, again | restuck, slipped | slips), None

    place = jnp.asarray(_places(steps))
    start = r.creepage * tangential.viscosity * r.velocity
    start = jnp.minimum(start, _limit(r.friction, normal.viscosity * r.velocity * slope(zero)))
    no = jnp.zeros(length.shape, bool)
    carry = (rest(normal), rest(tangential), zero, start, zero, zero, jnp.full(length.shape, steps), no, no)
    carry, _ = jax.lax.scan(step, carry, (jnp.arange(steps), place[:-1], place[1:]))
    _, _, _, _, total, stuck, first, again, _ = carry
    return total, stuck, first, again


def carter(modulus: Any, radius: Any, line_load: Any, friction: Any, creepage: Any) -> tuple[Array, Array, Array]:
    """Carter's cylinder on an elastic half-plane: F_x/F_N, the part of the contact that sticks, and its half-width.

    F_x/(mu F_N) = 1 - (1 - xi R/(mu a))^2 up to full slip, a^2 = 4 w R/(pi E*), w the load per length [N/m], for equal
    bodies, or an incompressible one on a rigid one, so that normal and tangential loading do not influence each other.
    Elements that know of each other: no line of independent ones has this law. Source: Carter 1926;
    Johnson 1985, ch. 8.
    """
    half = jnp.sqrt(4 * line_load * radius / (jnp.pi * modulus))
    part = jnp.clip(creepage * radius / jnp.where(friction > 0, friction * half, 1.0), 0.0, 1.0)
    part = jnp.where(friction > 0, part, 1.0)
    return friction * part * (2 - part), 1 - part, half
