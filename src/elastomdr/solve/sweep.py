"""Carries out a plan: all points of a scene at once, direction-averaged or not, to the tolerance asked for."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .._runtime import Array, is_traced
from ..mapping.direction import asymmetry, directions, interpolation_error, quadrature_error, shared_grid
from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .condense import condensed
from .passage import Control, Passages, solve_passages
from .plan import TRACED, Plan
from .rule import Rule

_ROUNDING = 1e-13  # relative, for what no estimate sees
_CORRECTED = 6  # by which the correction for an asymmetric contact may enlarge the error of the average
_BATCH = 4096  # points solved at once, and
_NUMBERS = 5_000_000  # of the largest array, 40 MB: both bound the memory


class Sweep(NamedTuple):
    """Friction of each point, and the line passage at that point's own velocity and load."""

    mu: Float[Array, " points"]
    error: Float[Array, " points"]  # estimated error of mu
    line: Passages
    model_error: Float[Array, " points"]  # bound on the error of mu that the reduction to the line leaves
    sunk: bool = False  # somewhere, in some direction, the load would need a wider contact than the shape has


def run(
    plan: Plan,
    law: Relaxation,
    lines: AbstractLines,
    value: Float[Array, " points"],  # load [N] or depth [m]
    velocity: Float[Array, " points"],  # times a_T [m/s]
) -> Sweep:
    """The friction of every point of a plan; points that miss the tolerance come back with `line.converged` False."""
    if plan.traced:
        return _traced(plan, law, lines, value, velocity)
    law = condensed(law, plan.condensation)
    rtol = plan.rtol / (_CORRECTED if plan.corrected else 1)
    if not plan.averaged:
        every = own = _solve(plan, law, lines, plan.control, value, velocity, rtol)
        lossy = 0.0 if plan.elastic else 1.0
        mu, error, good, model_error = lossy * own.mu, lossy * own.error, own.converged, 0.0 * own.mu
    else:
        deep = _solve(plan, law, lines, "depth", value, velocity, rtol) if plan.control == "depth" else None
        load = value if deep is None else np.where(deep.converged, deep.normal_force, 1.0)
        average = _shared if plan.shared else _direct
        mu, error, good, every, own = average(plan, law, lines, load, velocity, rtol)
        for finer in (rtol / 30, rtol / 1000):
            if bool(np.all(error <= rtol * mu)) or not bool(np.all(good)):
                break
            mu, error, good, every, own = average(plan, law, lines, load, velocity, max(finer, 1e-15))
        if deep is not None:
            own, good = deep, good & deep.converged
        mu, error, model_error = _against_half_space(plan, mu, error, own)
    error = error + mu * (plan.condensation.cost + _ROUNDING)
    good = good & (error <= plan.rtol * mu) & np.isfinite(mu)
    sunk = bool(np.any(~every.converged & (every.leading > 0.999 * np.asarray(lines.shape.largest_contact))))
    return Sweep(mu, error, own._replace(converged=good), model_error, sunk)


def _against_half_space(plan: Plan, mu: Array, error: Array, own: Passages) -> tuple[Array, Array, Array]:
    """Friction, its numerical error and the model's: the average as it is, or corrected for an asymmetric contact."""
    numpy = jnp if is_traced(mu) else np
    found = asymmetry(mu, own.mu, own.leading, own.trailing, own.exponent)
    if not plan.corrected:
        return mu, error, mu * found.bound
    factor = numpy.exp(-found.excess)
    error = factor * (error + found.sensitivity * (error + mu * own.error / own.mu))
    return mu * factor, error, mu * factor * found.corrected


def _shared(plan, law, lines, load, velocity, rtol):
    """Velocities at the same load share one line curve, evenly spaced in log v."""
    loads, curve = np.unique(load, return_inverse=True)
    grids = [shared_grid(velocity[curve == i], rtol) for i in range(loads.size)]
    ends = np.cumsum([grid.velocity.size for grid in grids])
    every_load = np.concatenate([np.repeat(loads, [grid.velocity.size for grid in grids]), load])
    every_velocity = np.concatenate([grid.velocity for grid in grids] + [velocity])
    every = _solve(plan, law, lines, "load", every_load, every_velocity, rtol)
    own = Passages(*(field[ends[-1] :] for field in every))
    mu, error = np.empty_like(velocity), np.empty_like(velocity)
    good = np.empty(velocity.shape, bool)
    tail = directions(rtol).tail
    for i, grid in enumerate(grids):
        part = slice(ends[i] - grid.velocity.size, ends[i])
        line, chosen = every.mu[part], curve == i
        average = grid.weights @ line
        sampling = np.abs(grid.weights) @ every.error[part]
        reached = ~(np.abs(grid.weights) @ ~every.converged[part] > 0)
        trusted = reached & (sampling <= rtol * average)  # points that failed say nothing of the others' interpolation
        mu[chosen] = average
        error[chosen] = (
            quadrature_error(average, grid.check @ line, tail)
            + interpolation_error(average, np.where(trusted, grid.lower @ line, np.nan))
            + sampling
        )
        good[chosen] = reached
    return mu, error, good & own.converged, every, own


def _direct(plan, law, lines, load, velocity, rtol):
    """Every velocity has its own directions: for few points, or where each has its own load."""
    rule = directions(rtol)
    slowed = velocity[:, None] * rule.cosines
    every = _solve(plan, law, lines, "load", np.broadcast_to(load[:, None], slowed.shape).ravel(), slowed.ravel(), rtol)
    every = Passages(*(field.reshape(slowed.shape) for field in every))
    own = Passages(*(field[:, 0] for field in every))  # the first direction is the motion itself
    mu = every.mu @ rule.weights
    error = quadrature_error(mu, every.mu @ rule.check, rule.tail) + every.error @ rule.weights
    return mu, error, every.converged.all(axis=1), every, own


def _solve(
    plan: Plan, law: Relaxation, lines: AbstractLines, control: Control, value: Array, velocity: Array,
    rtol: float,
) -> Passages:  # fmt: skip
    """Passages as NumPy arrays, in batches, with the rules of the plan tried in turn where the error asks for it."""
    wanted = 0.1 * rtol
    value, velocity = np.asarray(value), np.asarray(velocity)
    if plan.marched:
        from .march import march_passages  # loads diffrax, which the other routes do without

        return _as_numpy(march_passages(law, lines, control, value, velocity, max(wanted, 1e-9)))
    parts = []
    finest = max(plan.rules, key=lambda rule: rule.samples * rule.strips)
    each = finest.samples**2 // finest.nodes * (finest.strips if lines.count > 1 else 1)
    batch = int(np.clip(_NUMBERS // each, 16, _BATCH))
    for start in range(0, velocity.size, batch):
        here = slice(start, start + batch)
        part = _padded(law, lines, plan.rules[0], control, value[here], velocity[here])
        for finer in plan.rules[1:]:
            if not np.any(part.converged & (part.error > wanted * part.mu)):
                break
            part = _padded(law, lines, finer, control, value[here], velocity[here])
        parts.append(part)
    return Passages(*(np.concatenate(field) for field in zip(*parts, strict=True)))


def _padded(law, lines, rule: Rule, control: Control, value: Array, velocity: Array) -> Passages:
    """Solves with the number of points rounded up, so that few sizes are compiled."""
    count = velocity.size
    size = next(n for n in _sizes() if n >= count)
    fill = [(0, size - count)]
    out = solve_passages(law, lines, rule, control, np.pad(value, fill, "edge"), np.pad(velocity, fill, "edge"))
    return Passages(*(np.asarray(field)[:count] for field in out))


def _sizes():
    """Few and far between where points cost less than compiling for their number."""
    yield 64
    size = 320
    while True:
        yield size
        yield size * 3 // 2
        size *= 2


def _traced(plan: Plan, law: Relaxation, lines: AbstractLines, value: Array, velocity: Array) -> Sweep:
    """The same under a JAX transformation: no sharing, no batches, one rule; convergence is judged by the estimate."""
    rule = plan.rules[0]

    def solve(control, value, velocity):
        if plan.marched:
            from .march import march_passages

            return march_passages(law, lines, control, value, velocity, max(0.1 * plan.rtol, 1e-9))
        return solve_passages(law, lines, rule, control, value, velocity)

    if not plan.averaged:
        own = solve(plan.control, value, velocity)
        lossy = 0.0 if plan.elastic else 1.0
        mu, error, good, model_error = lossy * own.mu, lossy * own.error, own.converged, 0.0 * own.mu
    else:
        average = directions(plan.rtol * TRACED)
        load = value if plan.control == "load" else solve("depth", value, velocity).normal_force
        slowed = velocity[:, None] * average.cosines
        every = solve("load", jnp.broadcast_to(load[:, None], slowed.shape).ravel(), slowed.ravel())
        every = Passages(*(field.reshape(slowed.shape) for field in every))
        own = Passages(*(field[:, 0] for field in every))  # the first direction is the motion itself
        mu = every.mu @ average.weights
        relative = jnp.abs(every.mu @ average.check / mu - 1)
        error = mu * (0.1 * relative**2 + average.tail) + every.error @ average.weights
        good = every.converged.all(axis=1)
        mu, error, model_error = _against_half_space(plan, mu, error, own)
    error = jax.lax.stop_gradient(error + mu * _ROUNDING)
    good = jax.lax.stop_gradient(good & (error <= plan.rtol * mu))
    return Sweep(mu, error, own._replace(converged=good), jax.lax.stop_gradient(model_error))


def _as_numpy(passages: Passages) -> Passages:
    return Passages(*(np.asarray(field) for field in passages))
