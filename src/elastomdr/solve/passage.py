"""Steady sliding of one indenter: contact size and trailing edge from load or depth, then the forces.

In steady motion every element has the same history, so one passage is the whole field. Two kinds of unknown: the
contact size A, from the load (or the depth), and for each line its trailing edge b, where the force density falls to
zero. For a convex profile b is unique: after contact is lost the free surface falls ever more slowly (its recovery is
completely monotone) while the profile retreats ever faster, so it cannot touch again, and holding on would need tension.
"""

import functools
from typing import Literal, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .integrals import Passage, exit_density, friction_force, normal_force
from .rule import Rule, gauss

Control = Literal["load", "depth"]

_NEAREST_EXIT = 1e-12  # b/a below which contact is lost at the apex itself (a kink under a dashpot)
_ITERATIONS = 60  # after which a point is given up
_TIGHT, _LOOSE = 1e-9, 1e-6  # steps at which the searches stop; Newton's last step squares what error is left


class Passages(NamedTuple):
    """Steady sliding of many points at once."""

    mu: Float[Array, " points"]
    normal_force: Float[Array, " points"]  # [N]
    friction_force: Float[Array, " points"]  # [N]
    depth: Float[Array, " points"]  # [m]
    leading: Float[Array, " points"]  # leading edge of the central line [m]
    trailing: Float[Array, " points"]  # its trailing edge, counted backwards from the apex [m]
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
    law, lines, value, velocity = jax.tree.map(jnp.asarray, (law, lines, value, velocity))
    size, ratio, found = _search(*jax.lax.stop_gradient((law, lines, value, velocity)), rule=rule, control=control)
    size, ratio = jax.lax.stop_gradient((size, ratio))
    return _polish(law, lines, value, velocity, size, ratio, found, rule=rule, control=control)


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
def _search(law, lines, value, velocity, *, rule: Rule, control: Control):
    top = _largest(lines, value)
    ratio = jnp.full((lines.count, *value.shape), 0.8)
    passage = Passage(law, lines, rule, velocity)
    if control == "depth":
        size = _size_of_depth(lines, value, top)
        ratio, found = _exits(passage, size, ratio)
        return size, ratio, found
    return _size_of_load(passage, value, _first_guess(passage, value, top), ratio, top)


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
        passage = 2 * size / p.velocity
        branches = p.law.moduli[:, None] / (1 + passage / p.law.times[:, None])
        mean = p.law.equilibrium + jnp.sum(branches, axis=0) + p.law.viscosity / passage
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


def _exits(p: Passage, size: Array, ratio: Array) -> tuple[Array, Array]:
    """Trailing edges b/a at given contact sizes: Newton's method inside a shrinking bracket, all lines at once."""

    def density(ratio):
        return exit_density(p, size, ratio)

    def advance(state):
        ratio, low, high, done, count = state
        value, slope = jax.jvp(density, (ratio,), (jnp.ones_like(ratio),))
        low, high = jnp.where(value > 0, ratio, low), jnp.where(value > 0, high, ratio)
        newton = ratio - value / slope
        inside = (newton >= low) & (newton <= high)
        following = jnp.where(inside, newton, 0.5 * (low + high))
        small = jnp.abs(following - ratio) <= _TIGHT * (1 - ratio) + 4e-16
        following = jnp.where(done, ratio, following)
        return following, low, high, done | small | (value == 0), count + 1

    low, high = jnp.full_like(ratio, _NEAREST_EXIT), jnp.full_like(ratio, 1 + 1e-14)
    lost_at_apex = jnp.zeros(ratio.shape, bool)
    if p.rule.split:
        lost_at_apex = density(low) <= 0
        ratio = jnp.where(lost_at_apex, low, ratio)
    state = (ratio, low, high, lost_at_apex, 0)
    ratio, _, _, done, _ = jax.lax.while_loop(lambda s: ~jnp.all(s[3]) & (s[4] < _ITERATIONS), advance, state)
    return ratio, jnp.all(done, axis=0)


def _size_of_load(p: Passage, load: Array, log_size: Array, ratio: Array, top: Array) -> tuple[Array, Array, Array]:
    """Contact size for a load: Newton on log F_N against log A, nearly a straight line; its slope needs no dF/db (= q = 0)."""

    def advance(state):
        log_size, ratio, low, high, done, count = state
        ratio, found = _exits(p, jnp.exp(log_size), ratio)

        def log_force(log_size):
            return jnp.log(normal_force(p, jnp.exp(log_size), ratio)[0])

        value, slope = jax.jvp(log_force, (log_size,), (jnp.ones_like(log_size),))
        excess = value - jnp.log(load)
        low, high = jnp.where(excess < 0, log_size, low), jnp.where(excess < 0, high, log_size)
        newton = log_size - jnp.clip(excess / slope, -3.0, 3.0)
        inside = (newton > low) & (newton < high)
        middle = 0.5 * (jnp.maximum(low, log_size - 3) + jnp.minimum(high, log_size + 3))
        following = jnp.where(inside, newton, middle)
        small = jnp.abs(following - log_size) <= _LOOSE
        following = jnp.where(done, log_size, following)
        return following, ratio, low, high, done | (small & found), count + 1

    state = (log_size, ratio, jnp.full_like(load, -140.0), top, jnp.zeros(load.shape, bool), 0)
    state = jax.lax.while_loop(lambda s: ~jnp.all(s[4]) & (s[5] < _ITERATIONS), advance, state)
    return jnp.exp(state[0]), state[1], state[4]


@functools.partial(jax.jit, static_argnames=("rule", "control"))
def _polish(law, lines, value, velocity, size, ratio, found, *, rule: Rule, control: Control) -> Passages:
    """One Newton step on both equations, then forces and their sampling error."""
    kept = jax.lax.stop_gradient
    p = Passage(law, lines, rule, velocity)
    ones = jnp.ones_like(size)
    reached = (lambda s: normal_force(p, s, ratio)[0]) if control == "load" else lines.depth
    now, slope = jax.jvp(reached, (size,), (ones,))
    step = _small(-(now - value) / kept(slope), size)
    pinned = ratio <= 2 * _NEAREST_EXIT
    q, q_size = jax.jvp(lambda s: exit_density(p, s, ratio), (size,), (ones,))
    _, q_ratio = jax.jvp(lambda r: exit_density(p, size, r), (ratio,), (jnp.ones_like(ratio),))
    q_ratio = jnp.where(pinned | (q_ratio == 0), 1.0, q_ratio)
    ratio_step = -(q + kept(q_size) * step) / kept(q_ratio)
    ratio = ratio + jnp.where(pinned, 0.0, _small(ratio_step, ratio))
    size = size + step

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
        error=kept((drag_error + jnp.abs(mu) * normal_error) / normal),
        converged=found,
    )


def _small(step: Array, base: Array) -> Array:
    """A Newton step as computed where it is small; where it is not, the point has failed and keeps only its tangent."""
    wild = jnp.abs(step) > 1e-3 * jnp.abs(base)
    return step - jax.lax.stop_gradient(jnp.where(wild, step, 0.0))
