"""Steady sliding of one indenter: contact size and trailing edge from load or depth, then the forces.

In steady motion every element has the same history, so one passage is the whole field. Two kinds of unknown: the
contact size A, from the load (or the depth), and for each line its trailing edge b, where the force density falls to
zero. For a convex profile b is unique: after contact is lost the free surface falls ever more slowly (its recovery is
completely monotone) while the profile retreats ever faster, so it cannot touch again, and holding on would need
tension.
"""

import functools
from typing import Literal, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float

from .._runtime import Array, is_traced
from ..foundation.modes import recovery_modes
from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .condense import filled
from .integrals import Passage, balance, branch_losses, exit_density, friction_force, normal_force
from .rule import Rule, gauss

Control = Literal["load", "depth"]

_NEAREST_EXIT = 1e-15  # b/a below which contact is lost at the apex itself (a kink under a dashpot)
_ITERATIONS = 60  # after which a point is given up
_MET = 1e-3  # relative miss of the load from which Newton's last step gets home
_FAR = 1e-6  # relative distance of two values from which their difference gives a slope
_ROUNDING = 1e-12  # relative to the slope of an elastic contact, below which a slope is rounding
_NEAR = 1e-3  # b/a below which the search halves its logarithm
_TIGHT, _LOOSE = 1e-9, 1e-6  # steps at which the searches stop; Newton's last step squares what error is left


class Passages(NamedTuple):
    """Steady sliding of many points at once."""

    mu: Float[Array, " points"]
    normal_force: Float[Array, " points"]  # [N]
    friction_force: Float[Array, " points"]  # [N]
    depth: Float[Array, " points"]  # [m]
    leading: Float[Array, " points"]  # leading edge of the central line [m]
    trailing: Float[Array, " points"]  # its trailing edge, counted backwards from the apex [m]
    exponent: Float[Array, " points"]  # a g'(a)/g(a), the power with which the profile rises at the leading edge
    error: Float[Array, " points"]  # estimated error of mu from sampling
    converged: Bool[Array, " points"]


def solve_passages(
    law: Relaxation,
    lines: AbstractLines,
    rule: Rule,
    control: Control,
    value: Float[Array, " points"],  # load [N] or depth [m]
    velocity: Float[Array, " points"],  # times a_T [m/s]
) -> Passages:
    """Steady passages, differentiable in the law, the shape, the load or depth, and the velocity.

    The searches run on values cut off from differentiation; one Newton step on the full equations, with the
    derivatives in it, makes the answer differentiable in forward and reverse mode.
    """
    law, lines, value, velocity = jax.tree.map(jnp.asarray, (law, lines.refined(rule.strips), value, velocity))
    found = _search(*jax.lax.stop_gradient((law, lines, value, velocity)), rule=rule, control=control)
    return _polish(law, lines, value, velocity, jax.lax.stop_gradient(found), rule=rule, control=control)


class _Found(NamedTuple):
    """What the search hands to Newton's last step."""

    size: Array
    ratio: Array
    converged: Array
    reached_size: Array  # derivative of load or depth by size
    density_size: Array  # derivatives of the exit density by size and by ratio
    density_ratio: Array


@functools.partial(jax.jit, static_argnames=("control",))
def estimate_sizes(
    law: Relaxation, lines: AbstractLines, control: Control, value: Array, velocity: Array
) -> Float[Array, " points"]:
    """Contact sizes [m] for planning, within a factor of 2."""
    top = _largest(lines, value)
    if control == "depth":
        return _size_of_depth(lines, value, top)
    return jnp.exp(_first_guess(Passage(law, lines, Rule(2), velocity), value, top))


def _largest(lines: AbstractLines, value: Array) -> Array:
    """Logarithm of the largest contact size that the shape allows."""
    largest = jnp.broadcast_to(jnp.asarray(lines.shape.largest_contact, dtype=value.dtype), value.shape)
    return jnp.log(jnp.minimum(largest * (1 - 1e-13), 1e60))


@functools.partial(jax.jit, static_argnames=("rule", "control"))
def _search(law, lines, value, velocity, *, rule: Rule, control: Control) -> _Found:
    top = _largest(lines, value)
    ratio = jnp.full((lines.count, *value.shape), 0.8)
    passage = Passage(law, lines, rule, velocity)
    if control == "depth":
        size = _size_of_depth(lines, value, top)
        ratio, _, converged = _exits(passage, size, ratio, jnp.ones_like(ratio))
    else:
        size, ratio, converged = _size_of_load(passage, value, _first_guess(passage, value, top), ratio, top)
    _, tangent = jax.linearize(lambda size, ratio: balance(passage, size, ratio), size, ratio)
    density_size, force_size = tangent(jnp.ones_like(size), jnp.zeros_like(ratio))
    density_ratio, _ = tangent(jnp.zeros_like(size), jnp.ones_like(ratio))
    if control == "depth":
        _, force_size = jax.jvp(lines.depth, (size,), (jnp.ones_like(size),))
    return _Found(size, ratio, converged, force_size, density_size, density_ratio)


def _size_of_depth(lines: AbstractLines, depth: Array, top: Array) -> Array:
    """Contact size by bisection of its logarithm; `_polish` adds the last digits."""

    def halve(_, bounds):
        low, high = bounds
        middle = 0.5 * (low + high)
        above = lines.depth(jnp.exp(middle)) > depth
        return jnp.where(above, low, middle), jnp.where(above, middle, high)

    low, high = jax.lax.fori_loop(0, 56, halve, (jnp.full_like(depth, -140.0), top))
    return jnp.exp(0.5 * (low + high))


def _first_guess(p: Passage, load: Array, top: Array) -> Array:
    """log A of an elastic contact whose modulus is about the mean of E(t) over one passage."""
    c, w, _ = (jnp.asarray(x) for x in gauss(6))
    line = jnp.arange(p.lines.count)[:, None, None]

    def force(log_size):
        size = jnp.exp(log_size)
        mean = _mean_modulus(p, size)
        entry = p.lines.entry(size)
        x = entry[:, None] * c[:, None]
        volume = 2 * entry * jnp.sum(w[:, None] * x * p.lines.slope(x, size, line), axis=1)
        return mean * jnp.sum(p.lines.weight(size) * volume, axis=0)

    def halve(_, bounds):
        low, high = bounds
        middle = 0.5 * (low + high)
        above = force(middle) > load
        return jnp.where(above, low, middle), jnp.where(above, middle, high)

    low, high = jax.lax.fori_loop(0, 11, halve, (jnp.full_like(load, -60.0), jnp.minimum(top, 40.0)))
    return 0.5 * (low + high)


def _mean_modulus(p: Passage, size: Array) -> Array:
    """About the mean of E(t) over one passage."""
    passage = 2 * size / p.velocity
    branches = p.law.moduli[:, None] / (1 + passage / p.law.times[:, None])
    return p.law.equilibrium + jnp.sum(branches, axis=0) + p.law.viscosity / passage


def _elastic_slope(p: Passage, size: Array) -> Array:
    """Derivative of the exit density by b/a, about, in a contact that loses nothing."""
    entry = p.lines.entry(size)
    line = jnp.arange(p.lines.count)[:, None]
    return -_mean_modulus(p, size) * entry * p.lines.slope(0.8 * entry, size, line)


def _exits(p: Passage, size: Array, ratio: Array, factor: Array) -> tuple[Array, Array, Array]:
    """Trailing edges b/a at given contact sizes, all lines at once: the secant method inside a shrinking bracket.

    It starts with `factor` times the slope of an elastic contact, and returns the factor that it ended with.
    """
    elastic = _elastic_slope(p, size)

    def density(ratio):
        return exit_density(p, size, ratio)

    def advance(state):
        ratio, before, value_before, slope, low, high, done, count = state
        value = density(ratio)
        low, high = jnp.where(value > 0, ratio, low), jnp.where(value > 0, high, ratio)
        slope = _secant(ratio - before, value - value_before, slope, _FAR * ratio)
        following = ratio - value / slope
        inside = (following >= low) & (following <= high)
        # Near a kink at the apex the edge may lie anywhere between rounding and a thousandth.
        middle = jnp.where(high < _NEAR, jnp.sqrt(low * high), 0.5 * (low + high))
        following = jnp.where(inside, following, middle)
        small = jnp.abs(following - ratio) <= _TIGHT * jnp.minimum(ratio, 1 - ratio) + 4e-15
        following = jnp.where(done, ratio, following)
        return following, ratio, value, slope, low, high, done | small | (value == 0), count + 1

    low, high = jnp.full_like(ratio, _NEAREST_EXIT), jnp.full_like(ratio, 1 + 1e-14)
    lost_at_apex = jnp.zeros(ratio.shape, bool)
    if p.rule.split:
        lost_at_apex = density(low) <= 0
        ratio = jnp.where(lost_at_apex, low, ratio)
    state = (ratio, ratio, jnp.zeros_like(ratio), factor * elastic, low, high, lost_at_apex, 0)
    state = jax.lax.while_loop(lambda s: ~jnp.all(s[6]) & (s[7] < _ITERATIONS), advance, state)
    return state[0], state[3] / elastic, jnp.all(state[6], axis=0)


def _secant(step: Array, change: Array, slope: Array, far: Array | float) -> Array:
    """Slope of a falling or rising function from its last two values, where they lie far enough apart to tell."""
    known = (jnp.abs(step) > far) & (change * step * slope > 0)
    return jnp.where(known, change / jnp.where(known, step, 1.0), slope)


def _size_of_load(p: Passage, load: Array, log_size: Array, ratio: Array, top: Array) -> tuple[Array, Array, Array]:
    """Contact size for a load: the secant method on log F_N against log A, nearly a straight line. An edge that is off
    by a little leaves the force as it is, since dF/db = q(-b) = 0.
    """

    def advance(state):
        log_size, before, excess_before, slope, ratio, factor, low, high, done, count = state
        size = jnp.exp(log_size)
        ratio, factor, found = _exits(p, size, ratio, factor)
        excess = jnp.log(normal_force(p, size, ratio)[0]) - jnp.log(load)
        low, high = jnp.where(excess < 0, log_size, low), jnp.where(excess < 0, high, log_size)
        slope = _secant(log_size - before, excess - excess_before, slope, _FAR)
        straight = log_size - jnp.clip(excess / slope, -3.0, 3.0)
        # A bracket that closes at the widest contact has not met the load, hence the second condition.
        small = (jnp.abs(straight - log_size) <= _LOOSE) & (jnp.abs(excess) <= _MET)
        inside = (straight > low) & (straight < high)
        middle = 0.5 * (jnp.maximum(low, log_size - 3) + jnp.minimum(high, log_size + 3))
        following = jnp.where(inside | small, straight, middle)
        following = jnp.where(done, log_size, following)
        return following, log_size, excess, slope, ratio, factor, low, high, done | (small & found), count + 1

    fresh = jnp.zeros_like(load)
    state = (log_size, log_size, fresh, fresh + 2.5, ratio, jnp.ones_like(ratio), fresh - 140, top, fresh > 0, 0)
    state = jax.lax.while_loop(lambda s: ~jnp.all(s[8]) & (s[9] < _ITERATIONS), advance, state)
    return jnp.exp(state[0]), state[4], state[8]


@functools.partial(jax.jit, static_argnames=("rule", "control"))
def _polish(law, lines, value, velocity, found: _Found, *, rule: Rule, control: Control) -> Passages:
    """One Newton step on both equations, then forces and their sampling error."""
    p = Passage(law, lines, rule, velocity)
    size, ratio, settled = _edges(p, value, found, control)
    normal, normal_error = normal_force(p, size, ratio)
    drag, drag_error = friction_force(p, size, ratio)
    mu = drag / normal
    entry = lines.entry(size)
    return Passages(
        mu=mu,
        normal_force=normal,
        friction_force=drag,
        depth=lines.depth(size),
        leading=entry[0],
        trailing=(ratio * entry)[0],
        exponent=lines.exponent(size),
        error=jax.lax.stop_gradient((drag_error + jnp.abs(mu) * normal_error) / normal),
        converged=found.converged & settled,
    )


def _edges(p: Passage, value: Array, found: _Found, control: Control) -> tuple[Array, Array, Array]:
    """Contact size and trailing edges after one Newton step, which carries the derivatives, and whether it was small:
    a search that was led astray by a steep density stops where a step is not."""
    size, ratio = found.size, found.ratio
    density, reached = balance(p, size, ratio)
    if control == "depth":
        reached = p.lines.depth(size)
    step = _small((value - reached) / found.reached_size, size)
    # Where both edges agree to rounding, a kink (a cone) has no slope there: the edge stays as it was found.
    nothing = _ROUNDING * jax.lax.stop_gradient(_elastic_slope(p, size))
    pinned = (ratio <= 2 * _NEAREST_EXIT) | (found.density_ratio >= nothing)
    slope = jnp.where(pinned, 1.0, found.density_ratio)
    ratio_step = -(density + found.density_size * step) / slope
    room = 1e-3 * jnp.minimum(ratio, 1 - ratio) + 1e-13
    settled = jnp.all(pinned | (jnp.abs(jax.lax.stop_gradient(ratio_step)) <= room), axis=0)
    ratio = ratio + jnp.where(pinned, 0.0, _small(ratio_step, ratio))
    return size + step, ratio, settled


class Losses(NamedTuple):
    """Where the energy of a passage goes."""

    dashpot: Float[Array, " points"]  # of the parallel dashpot, per length of way [N]
    branches: Float[Array, "branches points"]  # of each branch [N]
    friction_force: Float[Array, " points"]  # the work, by its own integral [N]
    converged: Bool[Array, " points"]


def solve_losses(
    law: Relaxation, lines: AbstractLines, rule: Rule, control: Control, value: Array, velocity: Array
) -> Losses:
    """Steady passages, and what each branch turns into heat; differentiable as `solve_passages` is."""
    law, lines, value, velocity = jax.tree.map(jnp.asarray, (law, lines.refined(rule.strips), value, velocity))
    sought = jax.tree.map(jnp.asarray, law if is_traced(law) else filled(law))  # the program of `solve_passages`
    found = _search(*jax.lax.stop_gradient((sought, lines, value, velocity)), rule=rule, control=control)
    return _losses(law, recovery_modes(law), lines, value, velocity, jax.lax.stop_gradient(found), rule, control)


@functools.partial(jax.jit, static_argnames=("rule", "control"))
def _losses(law, modes, lines, value, velocity, found: _Found, rule: Rule, control: Control) -> Losses:
    p = Passage(law, lines, rule, velocity)
    size, ratio, settled = _edges(p, value, found, control)
    dashpot, branches = branch_losses(p, modes, size, ratio)
    return Losses(dashpot, branches, friction_force(p, size, ratio)[0], found.converged & settled)


def _small(step: Array, base: Array) -> Array:
    """A Newton step as computed where it is small; where it is not, the point has failed and keeps only its tangent."""
    wild = jnp.abs(step) > 1e-3 * jnp.abs(base)
    return step - jax.lax.stop_gradient(jnp.where(wild, step, 0.0))
