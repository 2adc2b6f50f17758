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
from typing import TYPE_CHECKING, Any, NamedTuple

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
_LAYER_HALVINGS = 50
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


@compiled("rule", "steps")
def tractions(rolling: RollingContact, rule: Rule, steps: int) -> Tractions:
    """Tractive force of each point, with `steps` steps of the march; differentiable in
    both modes.
    """
    r = arrays(rolling)
    length = r.leading + r.trailing
    marched = _march(r, length, steps)
    # Only its error needs the march of half the steps.
    coarse = (
        marched
        if on_numpy() and not marched.sticks_again.any()
        else _march(stop_gradient(r), length, steps // 2)
    )
    passage = Passage(r.normal, r.lines, rule, r.velocity)
    distance = _sticking_length(r, rule, length, marched.first_slip, steps)
    weight = r.lines.weight(r.leading)[0]
    force, error, rounding = _sticking_then_sliding(r, passage, distance, weight)
    error = xp.where(
        marched.sticks_again,
        weight * xp.abs(marched.force - coarse.force) + rounding,
        error + rounding,
    )
    error = xp.where(xp.isfinite(error), error, rounding)
    early = xp.where(marched.stick > 0, weight * _early_slip(r, length, steps), 0.0)
    stick = xp.where(distance > 1e-12 * length, distance / length, 0.0)
    return Tractions(
        force=xp.where(marched.sticks_again, weight * marched.force, force),
        stick=stop_gradient(xp.where(marched.sticks_again, marched.stick, stick)),
        error=stop_gradient(error + early),
        sticks_again=marched.sticks_again,
    )


def _sticking_length(
    r: RollingContact, rule: Rule, length: Array, first_slip: Array, steps: int
) -> Array:
    """The distance c from the leading edge at which tau_stick reaches mu q, by halving.

    No derivative of it is needed: at its end both tractions are equal.
    """
    held = stop_gradient(r)
    passage = Passage(held.normal, held.lines, rule, held.velocity)

    def sticks(distance: Array) -> Array:
        pressed = part_of_contact(passage, held.leading, distance - held.leading)[0]
        return _limit(held.friction, pressed) - _ramp(held, distance)[0] > 0

    ends = xp.asarray(_step_ends(steps))
    low, high = stop_gradient(
        tuple(length * ends[xp.clip(first_slip + i, 0, steps)] for i in (-2, 1))
    )
    return _where_slip_begins(r, length, bisect(sticks, low, high, _HALVINGS))


def _where_slip_begins(r: Any, length: Array, bracket: tuple[Array, Array]) -> Array:
    """The middle of the bracket; all of the contact sticks without an end of friction,
    or without creepage, and none of it without friction.
    """
    low, high = bracket
    return xp.where(
        xp.isinf(r.friction) | (r.creepage == 0),
        length,
        xp.where(r.friction == 0, 0.0, 0.5 * (low + high)),
    )


def _sticking_then_sliding(
    r: RollingContact, passage: Passage, distance: Array, weight: Array
) -> tuple[Array, Array, Array]:
    """F_x of elements that stick up to a distance and slide from there on, its error,
    and its rounding.
    """
    slides = distance < r.leading + r.trailing
    whole = part_of_contact(passage, r.leading, r.trailing)[1]
    _, before, missed = part_of_contact(passage, r.leading, distance - r.leading)
    sliding = xp.where(slides, _limit(r.friction, whole - before), 0.0)
    force = weight * _ramp(r, distance)[1] + sliding
    rounding = xp.where(slides, _ROUNDING * _limit(r.friction, whole), 0.0)
    return force, _limit(r.friction, missed), rounding + 1e-13 * xp.abs(force)


def _early_slip(r: RollingContact, length: Array, steps: int) -> Array:
    """Bound on the traction per weight that slip within the first two steps takes."""
    slope = r.lines.slope(r.leading[None], r.leading, xp.zeros((1, 1), int))[0]
    dashpot = r.creepage * r.tangential.viscosity * r.velocity
    slips = dashpot > _limit(r.friction, r.normal.viscosity * r.velocity * slope)
    h = length * _step_ends(steps)[2]
    return xp.where(slips, h * (_ramp(r, length)[0] - dashpot + _ramp(r, h)[0]), 0.0)


def _limit(friction: Array, pressed: Array) -> Array:
    """mu q, for friction coefficients that may be infinite."""
    return xp.where(pressed > 0, friction * xp.where(pressed > 0, pressed, 1.0), 0.0)


def _ramp(r: RollingContact, distance: Array) -> tuple[Array, Array]:
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
def _step_ends(steps: int) -> np.ndarray:
    """Ends of the steps over the length of the contact: closer at both edges."""
    s = np.arange(steps + 1) / steps
    return s**2 * (3 - 2 * s)


class _Marched(NamedTuple):
    """What a march over the length of the contact gives."""

    force: Array  # per weight
    stick: Array  # part of the length
    first_slip: Array  # the first step that ends slipping, counted from 1
    sticks_again: Array  # whether any step sticks after one has slipped


class _BrushState(NamedTuple):
    """Elements at the end of a step of the march."""

    normal: Array  # forces of the normal branches
    sheared: Array  # those of the tangential ones
    shear: Array  # displacement
    traction: Array
    force: Array  # int traction dr up to here
    stick: Array
    first_slip: Array
    sticks_again: Array
    slipped: Array


class _Step(NamedTuple):
    """Everything of a step that no slip changes."""

    number: Array
    share: Array  # of the length
    width: Array  # h
    normal_decay: Array
    pressing: Array  # what the normal branches gain
    pressed: Array  # q without the branches
    decay: Array
    gain: Array  # of the tangential branches, per displacement
    stiffness: Array


def _march(r: RollingContact, length: Array, steps: int) -> _Marched:
    """Elements followed from the leading edge to the trailing one, in blocks of
    steps.
    """

    def march_block(state: _BrushState, block: tuple) -> tuple:
        number, begin, end = block
        prepared = _prepare(r, length, number, begin, end)
        return scan(advance, state, prepared)

    def advance(state: _BrushState, step: _Step) -> tuple[_BrushState, None]:
        last = step.number == steps - 1
        return _advance(r, state, step, last), None

    ends = xp.asarray(_step_ends(steps))
    blocks = tuple(
        x.reshape(-1, _STEPS_AT_ONCE) for x in (xp.arange(steps), ends[:-1], ends[1:])
    )
    state, _ = scan(march_block, _at_leading_edge(r, length, steps), blocks)
    return _Marched(state.force, state.stick, state.first_slip, state.sticks_again)


def _slope(r: RollingContact, distance: Array) -> Array:
    """Slope of the profile at a distance from the leading edge."""
    x = (r.leading - distance)[None]
    return r.lines.slope(x, r.leading, xp.zeros((1, 1), int))[0]


def _at_leading_edge(r: RollingContact, length: Array, steps: int) -> _BrushState:
    zero, false = xp.zeros_like(length), xp.zeros(length.shape, bool)
    # of the dashpots alone
    traction = xp.minimum(
        r.creepage * r.tangential.viscosity * r.velocity,
        _limit(r.friction, r.normal.viscosity * r.velocity * _slope(r, zero)),
    )
    return _BrushState(
        normal=xp.zeros((r.normal.moduli.shape[0], *length.shape)),
        sheared=xp.zeros((r.tangential.moduli.shape[0], *length.shape)),
        shear=zero,
        traction=traction,
        force=zero,
        stick=zero,
        first_slip=xp.full(length.shape, steps),
        sticks_again=false,
        slipped=false,
    )


def _prepare(
    r: RollingContact,
    length: Array,
    number: Array,
    begin_fraction: Array,
    end_fraction: Array,
) -> _Step:
    """Some steps, from `begin_fraction` to `end_fraction` of the length."""
    normal, tangential = r.normal, r.tangential

    def height(x: Array) -> Array:
        return r.lines.profile(x[None], r.leading, xp.zeros((1, 1), int))[0]

    begin, end = length * begin_fraction[:, None], length * end_fraction[:, None]
    h = end - begin
    decay, early, late = ramp_weights(h[:, None] / (r.velocity * normal.times[:, None]))
    slope = _slope(r, end)
    pressing = (
        h[:, None]
        * normal.moduli[:, None]
        * (early * _slope(r, begin)[:, None] + late * slope[:, None])
    )
    depth = height(r.leading) - height(r.leading - end)
    pressed = normal.equilibrium * depth + normal.viscosity * r.velocity * slope
    kept, early, late = ramp_weights(
        h[:, None] / (r.velocity * tangential.times[:, None])
    )
    gain = tangential.moduli[:, None] * (early + late)
    stiffness = (
        tangential.equilibrium
        + xp.sum(gain, axis=1)
        + tangential.viscosity * r.velocity / h
    )
    share = end_fraction - begin_fraction
    return _Step(number, share, h, decay, pressing, pressed, kept, gain, stiffness)


def _advance(
    r: RollingContact, state: _BrushState, step: _Step, last: Array
) -> _BrushState:
    """One step: the element sticks where that asks for less than mu q."""
    normal = step.normal_decay * state.normal + step.pressing
    limit = _limit(r.friction, step.pressed + xp.sum(normal, axis=0))
    decayed = step.decay * state.sheared
    free = r.tangential.equilibrium * state.shear + xp.sum(decayed, axis=0)
    displacement = r.creepage * step.width
    trial = free + step.stiffness * displacement
    slips = trial > limit
    moved = xp.where(slips, (limit - free) / step.stiffness, displacement)
    traction = xp.where(slips, limit, trial)
    again = state.slipped & ~slips & (trial < limit * (1 - 1e-9)) & ~last
    return _BrushState(
        normal,
        decayed + step.gain * moved,
        state.shear + moved,
        traction,
        state.force + 0.5 * step.width * (state.traction + traction),
        state.stick + xp.where(slips, 0.0, step.share),
        xp.where(slips & ~state.slipped, step.number + 1, state.first_slip),
        state.sticks_again | again,
        state.slipped | slips,
    )


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

    def angle(self, distance: np.ndarray) -> np.ndarray:
        """x = L cos(angle) at a distance from the leading edge, as a column."""
        return np.arccos(np.clip(1 - distance / self.half_length, -1, 1))[:, None]

    def slip_limit(self, distance: np.ndarray) -> np.ndarray:
        """mu p."""
        waves = np.sin(self.angle(distance) * self.order)
        pressure = np.maximum(np.sum(self.terms * waves, axis=1), 0.0)
        return np.asarray(_limit(self.friction, pressure))

    def load_up_to(self, distance: np.ndarray) -> np.ndarray:
        """int p from the leading edge [N/m]."""
        angle, n = self.angle(distance), self.order
        lower = np.where(n == 1, angle, np.sin((n - 1) * angle) / np.maximum(n - 1, 1))
        upper = np.sin((n + 1) * angle) / (n + 1)
        return self.half_length * np.sum(self.terms * 0.5 * (lower - upper), axis=1)

    def ramp(self, distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """tau_stick at a distance from the leading edge, and its integral."""
        law, r = self.law, distance
        _, early, late = ramp_weights(r / (self.velocity * law.times[:, None]))
        slope = self.creepage * self.stiffness
        traction = law.equilibrium * r + law.moduli @ (early + late) * r
        summed = 0.5 * law.equilibrium * r**2 + law.moduli @ late * r**2
        return slope * traction, slope * summed


class LayerTraction(NamedTuple):
    force: np.ndarray  # [N/m]
    stick: np.ndarray  # part of the contact's length
    error: np.ndarray  # [N/m]


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


def layer_traction(contact: LayerContact) -> LayerTraction:
    """Traction of cylinders on a layer."""
    length = 2 * contact.half_length
    marched = _march_on_layer(contact, _LAYER_STEPS)
    distance = _sticking_length_on_layer(contact, marched.first_slip)
    sliding = np.maximum(contact.load_up_to(length) - contact.load_up_to(distance), 0.0)
    friction = np.where(np.isinf(contact.friction), 0.0, contact.friction)
    sliding = np.where(distance < length, friction * sliding, 0.0)
    force = contact.ramp(distance)[1] + sliding
    error = 1e-9 * force
    again = marched.sticks_again
    if again.any():
        coarse = _march_on_layer(contact, _LAYER_STEPS // 2)
        error = np.where(again, np.abs(marched.force - coarse.force), error)
    return LayerTraction(
        np.where(again, marched.force, force),
        np.where(again, marched.stick, distance / length),
        error,
    )


def _sticking_length_on_layer(contact: LayerContact, first_slip: Array) -> np.ndarray:
    """The distance from the leading edge at which tau_stick reaches mu p, by halving."""
    length, ends = 2 * contact.half_length, np.append(_step_ends(_LAYER_STEPS), 1.0)
    low = ends[np.maximum(first_slip - 1, 0)] * length
    high = ends[np.minimum(first_slip + 2, _LAYER_STEPS)] * length

    def sticks(distance: np.ndarray) -> np.ndarray:
        return contact.ramp(distance)[0] < contact.slip_limit(distance)

    bracket = bisect(sticks, low, high, _LAYER_HALVINGS)
    return np.asarray(_where_slip_begins(contact, length, bracket))


def _march_on_layer(contact: LayerContact, steps: int) -> _Marched:
    """Elements followed from the leading edge to the trailing one; the first step that
    slips is counted from 0.
    """
    law, stiffness = contact.law, contact.stiffness
    length, ends = 2 * contact.half_length, _step_ends(steps)
    zero, false = np.zeros_like(length), np.zeros(length.size, bool)
    branches, shear = np.zeros((law.moduli.size, length.size)), zero
    traction, force, stick = zero, zero, zero
    first_slip, slipped, again = np.full(length.size, steps), false, false
    for i in range(steps):
        share = ends[i + 1] - ends[i]
        h = length * share
        decay, early, late = ramp_weights(h / (contact.velocity * law.times[:, None]))
        gain = law.moduli[:, None] * (early + late)
        decayed = decay * branches
        free = stiffness * (law.equilibrium * shear + np.sum(decayed, axis=0))
        stiff = stiffness * (law.equilibrium + np.sum(gain, axis=0))
        limit = contact.slip_limit(length * ends[i + 1])
        displacement = contact.creepage * h
        slips = free + stiff * displacement > limit
        moved = np.where(slips, (limit - free) / stiff, displacement)
        new = np.where(slips, limit, free + stiff * displacement)
        if i < steps - 1:
            again = again | slipped & ~slips & (new < limit * (1 - 1e-9))
        first_slip = np.where(slips & ~slipped, i, first_slip)
        stick = stick + np.where(slips, 0.0, share)
        branches, shear = decayed + gain * moved, shear + moved
        force = force + 0.5 * h * (traction + new)
        traction, slipped = new, slipped | slips
    return _Marched(force, stick, first_slip, again)
