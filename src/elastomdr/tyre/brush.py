"""Steady tractive rolling: elements enter at the leading edge, are sheared by the
creepage and slip where they must.

In the frame of the contact an element that has come a distance r from the leading edge
and has not slipped is sheared by xi r, xi the creepage, so that it carries the traction
of a ramp,

    tau_stick(r) = xi [G_inf r + sum_k G_k s_k (1 - exp(-r/s_k)) + eta v],    s_k = v tau_k,

in units of force per length, as the normal q. It slips from the distance c on at which
this has reached mu q, and

    F_x = int_0^c tau_stick dr + mu [F_N - Q(c)],    Q(c) = int_0^c q dr,

with q and Q exact from `smooth.passage_integrals`. An elastic paraboloid has F_x/(mu
F_N) = 1 - (1 - zeta)^3, zeta = xi R G*/(2 a mu E*) (Popov & Hess 2015, ch. 5; the brush
of tyre mechanics). An element that has slipped stays slipping as long as its own
recovery is slower than the creepage, which is checked step by step; where one sticks
again (a dashpot, or tangential relaxation faster than the normal one), the force is
that of the march, second order in its step, of first order where a dashpot slips or
slip begins within one: its error is the change on halving the step.

A tangential dashpot needs xi eta v at once, and elements slip over a distance c_0
behind the leading edge where mu q is less. Where that ends within the first steps of
the march, of length h, it is not resolved: the elements lag by at most xi h, so that
the traction is off by at most h [tau_stick(l) - xi eta v] + h tau_stick(h), l the
length of the contact. That counts as error.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import arrays, compiled, fixed, fori_loop, in_steps, on_numpy, xp
from ..checks import Array
from ..material.relaxation import Relaxation
from ..numerics.decay import ramp_weights
from ..smooth.memory import Passage
from ..smooth.passage_integrals import part_of_contact
from ..surface.lines import AbstractLines
from ..surface.sampling import Rule

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_HALVINGS = 45
_TOGETHER = 32  # steps of the march that are prepared together
# of mu F_N: what sliding elements carry is the difference of two normal forces
_ROUNDING = 4e-15


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


@compiled("rule", "steps")
def tractions(rolling: Rolling, rule: Rule, steps: int) -> Tractions:
    """Tractive force of each point, with `steps` steps of the march; differentiable in
    both modes.
    """
    r = arrays(rolling)
    length = r.leading + r.trailing
    passage = Passage(r.normal, r.lines, rule, r.velocity)
    held = fixed(r)

    def excess(distance: Array, r: Rolling) -> Array:
        passage = Passage(r.normal, r.lines, rule, r.velocity)
        density = part_of_contact(passage, r.leading, distance - r.leading)[0]
        return _limit(r.friction, density) - _ramp(r, distance)[0]

    marched, stick, first, again = _march(r, length, steps)
    # Only its error needs the march of half the steps.
    coarse = (
        marched
        if on_numpy() and not again.any()
        else _march(held, length, steps // 2)[0]
    )
    low, high = fixed(
        tuple(
            length * xp.asarray(_places(steps))[xp.clip(first + i, 0, steps)]
            for i in (-2, 1)
        )
    )

    def halve(_: int, bounds: tuple) -> tuple:
        low, high = bounds
        middle = 0.5 * (low + high)
        sticks = excess(middle, held) > 0
        return xp.where(sticks, middle, low), xp.where(sticks, high, middle)

    low, high = fori_loop(0, _HALVINGS, halve, (low, high))
    distance = 0.5 * (low + high)
    # No derivative of the distance is needed: at its end both tractions are equal.
    distance = xp.where(
        xp.isinf(r.friction) | (r.creepage == 0),
        length,
        xp.where(r.friction == 0, 0.0, distance),
    )
    weight = r.lines.weight(r.leading)[0]
    every = part_of_contact(passage, r.leading, r.trailing)[1]
    _, before, missed = part_of_contact(passage, r.leading, distance - r.leading)
    sliding = xp.where(distance < length, _limit(r.friction, every - before), 0.0)
    smooth = weight * _ramp(r, distance)[1] + sliding
    rounding = xp.where(
        distance < length, _ROUNDING * _limit(r.friction, every), 0.0
    ) + 1e-13 * xp.abs(smooth)
    error = (
        xp.where(again, weight * xp.abs(marched - coarse), _limit(r.friction, missed))
        + rounding
    )
    error = xp.where(xp.isfinite(error), error, rounding)
    error = error + xp.where(stick > 0, weight * _early_slip(r, length, steps), 0.0)
    return Tractions(
        force=xp.where(again, weight * marched, smooth),
        stick=fixed(
            xp.where(
                again,
                stick,
                xp.where(distance > 1e-12 * length, distance / length, 0.0),
            )
        ),
        error=fixed(error),
        again=again,
    )


def _early_slip(r: Rolling, length: Array, steps: int) -> Array:
    """Bound on the traction per weight that slip within the first two steps takes."""
    slope = r.lines.slope(r.leading[None], r.leading, xp.zeros((1, 1), int))[0]
    dashpot = r.creepage * r.tangential.viscosity * r.velocity
    slips = dashpot > _limit(r.friction, r.normal.viscosity * r.velocity * slope)
    h = length * _places(steps)[2]
    return xp.where(slips, h * (_ramp(r, length)[0] - dashpot + _ramp(r, h)[0]), 0.0)


def _limit(friction: Array, pressed: Array) -> Array:
    """mu q, for friction coefficients that may be infinite."""
    return xp.where(pressed > 0, friction * xp.where(pressed > 0, pressed, 1.0), 0.0)


def _ramp(r: Rolling, distance: Array) -> tuple[Array, Array]:
    """tau_stick at a distance from the leading edge, and its integral up to there."""
    law = r.tangential
    z = distance / (r.velocity * law.times[:, None])
    _, early, late = ramp_weights(z)
    dashpot = law.viscosity * r.velocity
    moduli = law.moduli[:, None]
    traction = (
        law.equilibrium * distance
        + xp.sum(moduli * (early + late), axis=0) * distance
        + dashpot
    )
    summed = (
        0.5 * law.equilibrium * distance**2
        + xp.sum(moduli * late, axis=0) * distance**2
        + dashpot * distance
    )
    return r.creepage * traction, r.creepage * summed


@functools.cache
def _places(steps: int) -> np.ndarray:
    """Ends of the steps over the length of the contact: closer at both edges."""
    s = np.arange(steps + 1) / steps
    return s**2 * (3 - 2 * s)


def _march(r: Rolling, length: Array, steps: int) -> tuple[Array, Array, Array, Array]:
    """Force per weight, part that sticks, first step that ends slipping, whether any
    sticks after it has slipped.
    """
    normal, tangential = r.normal, r.tangential
    zero = xp.zeros_like(length)

    def rest(law: Relaxation) -> Array:
        return xp.zeros((law.moduli.shape[0], *length.shape))

    def slope(distance: Array) -> Array:
        return r.lines.slope(
            (r.leading - distance)[None], r.leading, xp.zeros((1, 1), int)
        )[0]

    def height(x: Array) -> Array:
        return r.lines.profile(x[None], r.leading, xp.zeros((1, 1), int))[0]

    def step(carry: tuple, now: tuple) -> tuple:
        f, p, shear, tau, total, stuck, first, again, slipped = carry
        i, part, h, normal_decay, pressing, q, decay, gain, stiffness = now
        f = normal_decay * f + pressing
        limit = _limit(r.friction, q + xp.sum(f, axis=0))
        free = tangential.equilibrium * shear + xp.sum(decay * p, axis=0)
        full = r.creepage * h
        trial = free + stiffness * full
        slips = trial > limit
        moved = xp.where(slips, (limit - free) / stiffness, full)
        new = xp.where(slips, limit, trial)
        p = decay * p + gain * moved
        restuck = slipped & ~slips & (trial < limit * (1 - 1e-9)) & (i < steps - 1)
        first = xp.where(slips & ~slipped, i + 1, first)
        stuck = stuck + xp.where(slips, 0.0, part)
        total = total + 0.5 * h * (tau + new)
        return (
            f,
            p,
            shear + moved,
            new,
            total,
            stuck,
            first,
            again | restuck,
            slipped | slips,
        ), None

    def block(carry: tuple, ends: tuple) -> tuple:
        """Some steps, for which everything that no slip changes is computed at once."""
        i, here, there = ends
        begin, distance = length * here[:, None], length * there[:, None]
        h = distance - begin
        decay, early, late = ramp_weights(
            h[:, None] / (r.velocity * normal.times[:, None])
        )
        steep = slope(distance)
        pressing = (
            h[:, None]
            * normal.moduli[:, None]
            * (early * slope(begin)[:, None] + late * steep[:, None])
        )
        pressed = height(r.leading) - height(r.leading - distance)
        q = normal.equilibrium * pressed + normal.viscosity * r.velocity * steep
        kept, early, late = ramp_weights(
            h[:, None] / (r.velocity * tangential.times[:, None])
        )
        gain = tangential.moduli[:, None] * (early + late)
        stiffness = (
            tangential.equilibrium
            + xp.sum(gain, axis=1)
            + tangential.viscosity * r.velocity / h
        )
        return in_steps(
            step, carry, (i, there - here, h, decay, pressing, q, kept, gain, stiffness)
        )

    place = xp.asarray(_places(steps))
    start = r.creepage * tangential.viscosity * r.velocity
    start = xp.minimum(
        start, _limit(r.friction, normal.viscosity * r.velocity * slope(zero))
    )
    no = xp.zeros(length.shape, bool)
    carry = (
        rest(normal),
        rest(tangential),
        zero,
        start,
        zero,
        zero,
        xp.full(length.shape, steps),
        no,
        no,
    )
    ends = (xp.arange(steps), place[:-1], place[1:])
    carry, _ = in_steps(block, carry, tuple(x.reshape(-1, _TOGETHER) for x in ends))
    _, _, _, _, total, stuck, first, again, _ = carry
    return total, stuck, first, again


def carter(
    modulus: Any, radius: Any, line_load: Any, friction: Any, creepage: Any
) -> tuple[Array, Array, Array]:
    """Carter's cylinder on an elastic half-plane: F_x/F_N, the part of the contact that
    sticks, and its half-width.

    F_x/(mu F_N) = 1 - (1 - xi R/(mu a))^2 up to full slip, a^2 = 4 w R/(pi E*), w the
    load per length [N/m], for equal bodies, or an incompressible one on a rigid one, so
    that normal and tangential loading do not influence each other. Elements that know
    of each other: no line of independent ones has this law. Source: Carter 1926;
    Johnson 1985, ch. 8.
    """
    half = xp.sqrt(4 * line_load * radius / (xp.pi * modulus))
    part = xp.clip(
        creepage * radius / xp.where(friction > 0, friction * half, 1.0), 0.0, 1.0
    )
    part = xp.where(friction > 0, part, 1.0)
    return friction * part * (2 - part), 1 - part, half
