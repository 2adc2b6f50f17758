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

On a layer under a cylinder the pressure is exact, and elements have the shear stiffness
of the layer. A tangential load on a bonded layer displaces its surface, wave by wave,
by u(k) = (2/k) W_t(kh) tau(k)/E*,

    W_t = (2 kap sinh 2z + 4z)/(2 kap cosh 2z + 1 + kap^2 + 4z^2),      kap = 3 - 4 nu, z = kh,

the normal kernel of `element.layer` with the other sign, which is G/h for long waves.
Independent elements have one stiffness, taken at k = pi/(2L), L the
half-length of the contact: G/h of a thin layer, exact where the contact is wide, and on
a half-space pi E*/(4L), with which the traction at small creepage is that of Carter.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import arrays, compiled, on_numpy, scan, stop_gradient, xp
from ..checks import Array
from ..material.relaxation import Relaxation
from ..numerics.decay import ramp_weights
from ..numerics.root import bisect
from ..smooth.memory import Passage
from ..smooth.passage_integrals import part_of_contact
from ..surface.lines import AbstractLines
from ..surface.sampling import Rule

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_HALVINGS = 45
_STEPS_AT_ONCE = 32  # of the march, which are prepared together
_LAYER_STEPS = 1024  # of the march on a layer
_LAYER_ERROR = 1e-9  # relative, of the pressure there
# of mu F_N: what sliding elements carry is the difference of two normal forces
_ROUNDING = 4e-15


class RollingContact(NamedTuple):
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
    # whether elements stick again after they have slipped
    sticks_again: Bool[Array, " points"]


class ShearedBrush(NamedTuple):
    """Elements that the creepage shears, each law in force per length and
    displacement.
    """

    equilibrium: Array  # of each point, or one for all
    moduli: Float[Array, "branches points"]
    times: Float[Array, " branches"]
    viscosity: Array
    velocity: Float[Array, " points"]  # times a_T [m/s]
    friction: Float[Array, " points"]
    creepage: Float[Array, " points"]  # xi, without its sign
    length: Float[Array, " points"]  # of the contact [m]

    def ramp(self, distance: Array) -> tuple[Array, Array]:
        """tau_stick at a distance from the leading edge, and its integral up to
        there.
        """
        z = distance / (self.velocity * self.times[:, None])
        _, early, late = ramp_weights(z)
        dashpot = self.viscosity * self.velocity
        traction = (
            self.equilibrium * distance
            + xp.sum(self.moduli * (early + late), axis=0) * distance
            + dashpot
        )
        summed = (
            0.5 * self.equilibrium * distance**2
            + xp.sum(self.moduli * late, axis=0) * distance**2
            + dashpot * distance
        )
        return self.creepage * traction, self.creepage * summed


def sheared_by(r: RollingContact) -> ShearedBrush:
    """The elements of rolling contacts."""
    law = r.tangential
    return ShearedBrush(
        law.equilibrium,
        law.moduli[:, None],
        law.times,
        law.viscosity,
        r.velocity,
        r.friction,
        r.creepage,
        r.leading + r.trailing,
    )


@compiled("rule", "steps")
def tractions(rolling: RollingContact, rule: Rule, steps: int) -> Tractions:
    """Tractive force of each point, with `steps` steps of the march; differentiable in
    both modes.
    """
    r = arrays(rolling)
    law, held, sheared = r.tangential, stop_gradient(r), sheared_by(r)
    weight = r.lines.weight(r.leading)[0]

    def limit_at(distance: Array) -> Array:
        passage = Passage(held.normal, held.lines, rule, held.velocity)
        pressed = part_of_contact(passage, held.leading, distance - held.leading)[0]
        return _limit(held.friction, pressed)

    def load_up_to(distance: Array) -> tuple[Array, Array]:
        passage = Passage(r.normal, r.lines, rule, r.velocity)
        return part_of_contact(passage, r.leading, distance - r.leading)[1:]

    first = _first_limit(r)
    pulled = _pulled(
        sheared, weight, first, lambda n: _limits(r, n), limit_at, load_up_to, steps
    )
    h = sheared.length * _step_ends(steps)[2]
    dashpot = r.creepage * law.viscosity * r.velocity
    # what slip within the first two steps takes, at most
    early = h * (sheared.ramp(sheared.length)[0] - dashpot + sheared.ramp(h)[0])
    early = xp.where((dashpot > first) & (pulled.stick > 0), weight * early, 0.0)
    return pulled._replace(error=stop_gradient(pulled.error + early))


def _pulled(
    sheared: ShearedBrush,
    weight: Array,
    first: Array,
    limits: Callable[[int], Array],
    limit_at: Callable[[Array], Array],
    load_up_to: Callable[[Array], tuple[Array, Array]],
    steps: int,
) -> Tractions:
    """Traction of elements whose limits mu q are known.

    Args:
        sheared: the elements.
        weight: of a line, by which the sheared elements are multiplied.
        first: mu q at the leading edge.
        limits: mu q at the ends of a number of steps, (steps, points).
        limit_at: mu q at a distance from the leading edge, without derivatives.
        load_up_to: int q from there to a distance, and its error.
        steps: of the march.
    """
    length, friction = sheared.length, sheared.friction
    marched = _march(sheared, first, limits(steps))
    # Only its error needs the march of half the steps.
    coarse = (
        marched
        if on_numpy() and not marched.sticks_again.any()
        else _march(stop_gradient(sheared), first, limits(steps // 2))
    )
    distance = _sticking_length(sheared, limit_at, marched.first_slip, steps)
    slides = distance < length
    whole, (before, missed) = load_up_to(length)[0], load_up_to(distance)
    sliding = xp.where(slides, _limit(friction, whole - before), 0.0)
    force = weight * sheared.ramp(distance)[1] + sliding
    rounding = xp.where(slides, _ROUNDING * _limit(friction, whole), 0.0)
    rounding = rounding + 1e-13 * xp.abs(force)
    again, change = marched.sticks_again, xp.abs(marched.force - coarse.force)
    error = xp.where(again, weight * change, _limit(friction, missed)) + rounding
    error = xp.where(xp.isfinite(error), error, rounding)
    stick = xp.where(distance > 1e-12 * length, distance / length, 0.0)
    return Tractions(
        force=xp.where(again, weight * marched.force, force),
        stick=stop_gradient(xp.where(again, marched.stick, stick)),
        error=stop_gradient(error),
        sticks_again=again,
    )


def _sticking_length(
    sheared: ShearedBrush,
    limit_at: Callable[[Array], Array],
    first_slip: Array,
    steps: int,
) -> Array:
    """The distance c from the leading edge at which tau_stick reaches mu q, by halving;
    all of the contact sticks without an end of friction, or without creepage, and none
    of it without friction.

    No derivative of it is needed: at its end both tractions are equal.
    """
    held, ends = stop_gradient(sheared), _step_ends(steps)

    def sticks(distance: Array) -> Array:
        return limit_at(distance) - held.ramp(distance)[0] > 0

    low, high = stop_gradient(
        tuple(
            held.length * xp.take(ends, xp.clip(first_slip + i, 0, steps))
            for i in (-2, 1)
        )
    )
    low, high = bisect(sticks, low, high, _HALVINGS)
    return xp.where(
        xp.isinf(sheared.friction) | (sheared.creepage == 0),
        sheared.length,
        xp.where(sheared.friction == 0, 0.0, 0.5 * (low + high)),
    )


def _limit(friction: Array, pressed: Array) -> Array:
    """mu q, for friction coefficients that may be infinite."""
    return xp.where(pressed > 0, friction * xp.where(pressed > 0, pressed, 1.0), 0.0)


@functools.cache
def _step_ends(steps: int) -> np.ndarray:
    """Ends of the steps over the length of the contact: closer at both edges."""
    s = np.arange(steps + 1) / steps
    return s**2 * (3 - 2 * s)


def _in_blocks(steps: int) -> tuple[Array, Array]:
    """Ends of the steps, of which some are prepared together: (blocks, steps)."""
    ends = _step_ends(steps)
    blocks = (-1, _STEPS_AT_ONCE)
    return ends[:-1].reshape(blocks), ends[1:].reshape(blocks)


class _Marched(NamedTuple):
    """What a march over the length of the contact gives."""

    force: Array  # per weight
    stick: Array  # part of the length
    first_slip: Array  # the first step that ends slipping, counted from 1
    sticks_again: Array  # whether any step sticks after one has slipped


class _BrushState(NamedTuple):
    """Elements at the end of a step of the march."""

    number: Array  # of the step
    branches: Array  # their forces
    shear: Array  # displacement
    traction: Array
    force: Array  # int traction dr up to here
    stick: Array
    first_slip: Array
    sticks_again: Array
    slipped: Array


class _Step(NamedTuple):
    """Everything of a step that no slip changes."""

    share: Array  # of the length
    width: Array  # h
    limit: Array  # mu q at its end
    decay: Array
    gain: Array  # of the branches, per displacement
    stiffness: Array


def _march(sheared: ShearedBrush, first: Array, limits: Array) -> _Marched:
    """Elements followed from the leading edge to the trailing one, in blocks of
    steps.
    """
    steps, zero = limits.shape[0], xp.zeros_like(sheared.length)
    false = xp.zeros(zero.shape, bool)

    def march_block(state: _BrushState, block: tuple) -> tuple:
        begin, end, limit = block
        share = end - begin
        h = sheared.length * share[:, None]
        z = h[:, None] / (sheared.velocity * sheared.times[:, None])
        decay, early, late = ramp_weights(z)
        gain = sheared.moduli * (early + late)
        stiffness = sheared.equilibrium + xp.sum(gain, axis=1)
        stiffness = stiffness + sheared.viscosity * sheared.velocity / h
        return scan(advance, state, _Step(share, h, limit, decay, gain, stiffness))

    def advance(state: _BrushState, step: _Step) -> tuple[_BrushState, None]:
        """The element sticks where that asks for less than mu q."""
        decayed, limit = step.decay * state.branches, step.limit
        free = sheared.equilibrium * state.shear + xp.sum(decayed, axis=0)
        displacement = sheared.creepage * step.width
        trial = free + step.stiffness * displacement
        slips = trial > limit
        moved = xp.where(slips, (limit - free) / step.stiffness, displacement)
        traction, number = xp.where(slips, limit, trial), state.number + 1
        again = state.slipped & ~slips & (trial < limit * (1 - 1e-9))
        after = _BrushState(
            number,
            decayed + step.gain * moved,
            state.shear + moved,
            traction,
            state.force + 0.5 * step.width * (state.traction + traction),
            state.stick + xp.where(slips, 0.0, step.share),
            xp.where(slips & ~state.slipped, number, state.first_slip),
            state.sticks_again | (again & (number < steps)),
            state.slipped | slips,
        )
        return after, None

    # of the dashpots alone
    dashpot = sheared.creepage * sheared.viscosity * sheared.velocity
    start = _BrushState(
        xp.zeros((), int),
        xp.zeros((sheared.times.shape[0], *zero.shape)),
        zero,
        xp.minimum(dashpot, first),
        zero,
        zero,
        xp.full(zero.shape, steps),
        false,
        false,
    )
    blocks = (*_in_blocks(steps), limits.reshape(-1, _STEPS_AT_ONCE, zero.size))
    state, _ = scan(march_block, start, blocks)
    return _Marched(state.force, state.stick, state.first_slip, state.sticks_again)


def _slope(r: RollingContact, distance: Array) -> Array:
    """Slope of the profile at a distance from the leading edge."""
    x = (r.leading - distance)[None]
    return r.lines.slope(x, r.leading, xp.zeros((1, 1), int))[0]


def _first_limit(r: RollingContact) -> Array:
    """mu q at the leading edge, of the normal dashpot alone."""
    slope = _slope(r, xp.zeros_like(r.leading))
    return _limit(r.friction, r.normal.viscosity * r.velocity * slope)


def _limits(r: RollingContact, steps: int) -> Array:
    """mu q at the ends of the steps, by the normal branches: (steps, points)."""
    law, length, line = r.normal, r.leading + r.trailing, xp.zeros((1, 1), int)

    def height(x: Array) -> Array:
        return r.lines.profile(x[None], r.leading, line)[0]

    def press_block(branches: Array, block: tuple) -> tuple:
        begin, end = (length * x[:, None] for x in block)
        h = (end - begin)[:, None]
        decay, early, late = ramp_weights(h / (r.velocity * law.times[:, None]))
        steep = early * _slope(r, begin)[:, None] + late * _slope(r, end)[:, None]
        gain = h * law.moduli[:, None] * steep
        branches, forces = scan(press, branches, (decay, gain))
        pressed = law.equilibrium * (height(r.leading) - height(r.leading - end))
        pressed = pressed + law.viscosity * r.velocity * _slope(r, end)
        return branches, _limit(r.friction, pressed + forces)

    def press(branches: Array, step: tuple) -> tuple:
        decay, gain = step
        branches = decay * branches + gain
        return branches, xp.sum(branches, axis=0)

    start = xp.zeros((law.moduli.shape[0], *length.shape))
    limits = scan(press_block, start, _in_blocks(steps))[1]
    return limits.reshape(steps, *length.shape)


def carter(
    modulus: Array,
    radius: Array,
    line_load: Array,
    friction: Array | float,
    creepage: Array | float,
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
    slipping = xp.clip(
        creepage * radius / xp.where(friction > 0, friction * half, 1.0), 0.0, 1.0
    )
    slipping = xp.where(friction > 0, slipping, 1.0)
    return friction * slipping * (2 - slipping), 1 - slipping, half


class LayerContact(NamedTuple):
    """Cylinders that roll on a layer, whose pressure is known; numbers only."""

    law: Relaxation  # G(t) [Pa]
    stiffness: np.ndarray  # of the elements, per G [1/m]
    velocity: np.ndarray  # times a_T [m/s]
    half_length: np.ndarray  # [m]
    terms: np.ndarray  # p = sum terms_n sin(n angle) [Pa], a row per point
    friction: np.ndarray
    creepage: np.ndarray  # without its sign

    @property
    def order(self) -> np.ndarray:
        return np.arange(1, self.terms.shape[1] + 1)

    def angle(self, distance: Array) -> np.ndarray:
        """x = L cos(angle) at a distance from the leading edge, as a last axis."""
        return np.arccos(np.clip(1 - np.asarray(distance) / self.half_length, -1, 1))[
            ..., None
        ]

    def limit_at(self, distance: Array) -> np.ndarray:
        """mu p."""
        waves = np.sin(self.angle(distance) * self.order)
        return np.asarray(_limit(self.friction, np.sum(self.terms * waves, axis=-1)))

    def load_up_to(self, distance: Array) -> tuple[Array, Array]:
        """int p from the leading edge [N/m], and its error, which is left to the end."""
        angle, n = self.angle(distance), self.order
        lower = np.where(n == 1, angle, np.sin((n - 1) * angle) / np.maximum(n - 1, 1))
        upper = np.sin((n + 1) * angle) / (n + 1)
        load = self.half_length * np.sum(self.terms * 0.5 * (lower - upper), axis=1)
        return load, 0.0 * load


def typical_wave(half_length: np.ndarray) -> np.ndarray:
    """k at which elements of a brush are as stiff as the layer [1/m]."""
    return np.pi / (2 * half_length)


def shear_compliance(k: np.ndarray, thickness: float, poisson: float) -> np.ndarray:
    """u/tau of a bonded layer at the waves k, times G [m]."""
    z = k * thickness
    kappa, e = 3 - 4 * poisson, np.exp(-2 * z)
    above = kappa * (1 - e**2) + 4 * z * e
    below = kappa * (1 + e**2) + (1 + kappa**2 + 4 * z**2) * e
    return (1 - poisson) / k * above / below


def layer_traction(contact: LayerContact) -> Tractions:
    """Traction of cylinders on a layer, per length [N/m]."""
    law, length = contact.law, 2 * contact.half_length
    sheared = ShearedBrush(
        contact.stiffness * law.equilibrium,
        contact.stiffness * law.moduli[:, None],
        law.times,
        np.zeros(()),
        contact.velocity,
        contact.friction,
        contact.creepage,
        length,
    )

    def limits(steps: int) -> np.ndarray:
        ends = (length * end for end in _step_ends(steps)[1:])
        return np.stack([contact.limit_at(end) for end in ends])

    pulled = _pulled(
        sheared,
        np.ones(()),
        np.zeros(()),
        limits,
        contact.limit_at,
        contact.load_up_to,
        _LAYER_STEPS,
    )
    error = pulled.error + _LAYER_ERROR * pulled.force
    return pulled._replace(error=error)
