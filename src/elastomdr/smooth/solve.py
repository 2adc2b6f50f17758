"""Carries out a plan: all points of a scene at once, direction-averaged or not, to the
tolerance asked for.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import on_numpy, xp
from ..checks import Array
from ..material.relaxation import Relaxation
from ..numerics.implicit import as_doubles, numbers_with_slopes
from ..surface.direction import (
    SharedCurve,
    asymmetry,
    at_points,
    average,
    between_orders,
    directions,
    interpolation_error,
    quadrature_error,
    shared_curve,
    within_maps,
)
from ..surface.lines import AbstractLines
from ..surface.profile import Profile
from ..surface.sampling import Rule
from .passage import Control, Passages, solve_passages
from .plan import TRACED, Plan, make_plan, traced_level

if TYPE_CHECKING:
    from jaxtyping import Float, PyTree

_ROUNDING = 1e-13  # relative, for what no estimate sees
# by which the correction for an asymmetric contact may enlarge the error of the average
_CORRECTED = 6
_LEVELS = 5  # how often the steps of an average are halved where its error asks for it
# by which errors are enlarged where friction may bend, and its series converge by
# powers only
_BENT = 3
# of the tolerance: what directions of one velocity were off beyond their estimate, for
# r^3 to r^8
_UNSEEN = 0.3
_BATCH = 4096  # points solved at once, and
# of panels times branches, some 100 MB in all: both bound the memory
_NUMBERS = 200_000


# loads, velocities, and the passages there
_Solved = tuple[Array, Array, Passages]


class SolvedPoints(NamedTuple):
    """Friction of each point, and the line passage at that point's own velocity and
    load.
    """

    mu: Float[Array, " points"]
    error: Float[Array, " points"]  # estimated error of mu
    line: Passages
    # bound on the error of mu that the reduction to the line leaves
    model_error: Float[Array, " points"]
    # somewhere, in some direction, the load would need a wider contact than the shape
    # has
    sunk: bool = False


class _Sweep(NamedTuple):
    """What all points of a plan share."""

    plan: Plan
    law: Relaxation
    lines: AbstractLines
    rtol: float  # of the average


def run(
    plan: Plan,
    law: Relaxation,
    lines: AbstractLines,
    value: Float[Array, " points"],  # load [N] or depth [m]
    velocity: Float[Array, " points"],  # times a_T [m/s]
) -> SolvedPoints:
    """The friction of every point of a plan; points that miss the tolerance come back
    with `line.converged` False.
    """
    if plan.traced and on_numpy():
        return _of_values(plan, law, lines, value, velocity)
    if plan.traced:
        law, lines, value, velocity = as_doubles((law, lines, value, velocity))
        fields = _with_slopes(plan)((law, lines), (value, velocity))
        mu, *line, error, model_error = fields
        passages = Passages(*line)._replace(converged=line[-1] > 0)
        return SolvedPoints(mu, error, passages, model_error)
    rtol = plan.rtol / (_CORRECTED if plan.corrected else 1)
    sweep = _Sweep(plan, law, lines, rtol)
    if not plan.averaged:
        ahead = _solve(sweep, plan.control, value, velocity)
        sunk = _sunk(lines, ahead)
        lossy = 0.0 if plan.elastic else 1.0
        mu, error, good, model_error = (
            lossy * ahead.mu,
            lossy * ahead.error,
            ahead.converged,
            0.0 * ahead.mu,
        )
    else:
        deep = (
            _solve(sweep, "depth", value, velocity) if plan.control == "depth" else None
        )
        load = (
            value if deep is None else np.where(deep.converged, deep.normal_force, 1.0)
        )
        mean = _over_directions(sweep, np.asarray(load), np.asarray(velocity))
        mu, good, ahead, sunk = mean.mu, mean.good, mean.ahead, mean.sunk
        if deep is not None:
            ahead, good = deep, good & deep.converged
        mu, error, model_error = _against_half_space(
            plan, law, mu, mean.skew, mean.error, ahead
        )
    error = error + mu * _ROUNDING
    good = good & (error <= plan.rtol * mu) & np.isfinite(mu)
    return SolvedPoints(mu, error, ahead._replace(converged=good), model_error, sunk)


class _Averaged(NamedTuple):
    """Averages over directions."""

    mu: np.ndarray
    skew: np.ndarray  # of `_skew`
    error: np.ndarray
    sampling: np.ndarray  # the part of it that is that of the passages
    good: np.ndarray  # whether all were solved
    ahead: Passages  # in the direction of the motion itself
    sunk: bool  # whether some load sinks in


def _over_directions(
    sweep: _Sweep, load: np.ndarray, velocity: np.ndarray
) -> _Averaged:
    """Averages over directions, with more of them at points that miss the tolerance."""
    average = _shared if sweep.plan.shared else _direct
    known: list[_Solved] = []
    whole = average(sweep, load, velocity, 0, known)
    mu, rtol, sunk = whole.mu, sweep.rtol, whole.sunk
    room = rtol - _ROUNDING  # which `run` adds
    for level in range(1, _LEVELS + 1):
        left = whole.good & ~(whole.error <= room * mu) & (whole.sampling <= rtol * mu)
        if not left.any():
            break
        again = average(sweep, load[left], velocity[left], level, known)
        for field, values in zip(whole[:5], again[:5], strict=True):
            field[..., left] = values
        _put(whole.ahead, left, again.ahead)
        sunk |= again.sunk
    return whole._replace(sunk=sunk)


def _sunk(lines: AbstractLines, passages: Passages) -> bool:
    """Whether some load would need a wider contact than the shape has."""
    largest = 0.999 * np.asarray(lines.shape.largest_contact)
    return bool(np.any(~passages.converged & (passages.leading > largest)))


def _against_half_space(
    plan: Plan, law: Relaxation, mu: Array, skew: Array, error: Array, ahead: Passages
) -> tuple[Array, Array, Array]:
    """Friction, its numerical error and the model's: the average as it is, or corrected
    for an asymmetric contact.

    `skew` has the averages of `_skew`.
    """
    mean, exponent = skew / xp.where(mu > 0, mu, 1.0)
    exponent = xp.maximum(ahead.exponent, exponent)
    correction = asymmetry(mu, ahead.mu, ahead.leading, ahead.trailing, exponent, mean)
    mapped = within_maps(law, exponent)
    if not plan.corrected:
        return mu, error, mu * mapped * correction.bound
    factor = xp.exp(-correction.excess)
    error = factor * (
        error + correction.sensitivity * (error + mu * ahead.error / ahead.mu)
    )
    return mu * factor, error, mu * factor * mapped * correction.corrected


def _shared(
    sweep: _Sweep,
    load: np.ndarray,
    velocity: np.ndarray,
    level: int,
    known: list[_Solved],
) -> _Averaged:
    """Velocities at the same load share one line curve, and where they are more than
    its nodes, its passages too.
    """
    loads, curve = np.unique(load, return_inverse=True)
    chosen = [np.flatnonzero(curve == i) for i in range(loads.size)]
    grids = [shared_curve(velocity[points], sweep.rtol, level) for points in chosen]
    sizes = [grid.velocity.size for grid in grids]
    few = [
        points
        for points, size in zip(chosen, sizes, strict=True)
        if points.size <= size
    ]
    alone = np.concatenate(few) if few else np.zeros(0, int)
    every_load = np.concatenate([np.repeat(loads, sizes), load[alone]])
    every_velocity = np.concatenate(
        [grid.velocity for grid in grids] + [velocity[alone]]
    )
    every = _solve_new(sweep, every_load, every_velocity, known)
    ahead = Passages(*(np.zeros(load.shape, field.dtype) for field in every))
    _put(ahead, alone, Passages(*(field[sum(sizes) :] for field in every)))
    mu, error, sampling = (np.empty_like(velocity) for _ in range(3))
    skew = np.empty((2, velocity.size))
    good, left = np.zeros(load.shape, bool), np.zeros(load.shape, bool)
    tail, start = directions(sweep.rtol, level).tail, 0
    for points, grid, size in zip(chosen, grids, sizes, strict=True):
        line = Passages(*(field[start : start + size] for field in every))
        start += size
        safety = _BENT if sweep.plan.bends else 1
        mu[points], error[points], sampling[points], good[points] = _of_curve(
            grid, line, sweep.rtol, tail, safety
        )
        skew[:, points] = [
            at_points(average(field, grid.kernel), grid.near, grid.local)
            for field in _skew(line)
        ]
        if points.size > size:
            read, precise = _read_off(grid, line, sweep.rtol)
            _put(ahead, points, read._replace(converged=good[points]))
            left[points] = good[points] & ~precise
    if left.any():
        _put(
            ahead,
            left,
            _solve(sweep, "load", load[left], velocity[left]),
        )
    good &= ahead.converged
    sunk = _sunk(sweep.lines, every)
    return _Averaged(mu, skew, error, sampling, good, ahead, sunk)


def _skew(line: Passages) -> tuple[Array, Array]:
    """Friction of each passage times how much farther it reaches ahead of the apex than
    behind, and times its power.
    """
    width = line.leading + line.trailing
    ahead = (line.leading - line.trailing) / xp.where(width > 0, width, 1.0)
    return line.mu * ahead, line.mu * line.exponent


def _put(whole: Passages, points: np.ndarray, passages: Passages) -> None:
    for field, values in zip(whole, passages, strict=True):
        field[points] = values


class _Curve(NamedTuple):
    """Averages of a line curve at the points."""

    mu: np.ndarray
    error: np.ndarray
    sampling: np.ndarray
    reached: np.ndarray


def _of_curve(
    grid: SharedCurve, line: Passages, rtol: float, tail: float, safety: float
) -> _Curve:
    """The direction average of a line curve at the points, its error, how much of it is
    that of the line's solutions, and whether what it uses has converged.
    """
    weight, kernel = np.abs(grid.local), np.abs(grid.kernel)
    means = average(line.mu, grid.kernel)
    power = 2 if safety == 1 else 1
    checked = quadrature_error(
        means, average(line.mu, grid.half), average(line.mu, grid.quarter), tail, power
    )
    mu = at_points(means, grid.near, grid.local)
    lower = at_points(average(line.mu, grid.lower), grid.near, grid.coarse)
    sampling = at_points(average(line.error, kernel), grid.near, weight)
    reached = ~(
        at_points(average((~line.converged).astype(float), kernel), grid.near, weight)
        > 0
    )
    # points that failed say nothing of the others' interpolation
    trusted = reached & (sampling <= rtol * mu)
    # An error that is small by chance at one velocity is not at all of its neighbours.
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = np.nan_to_num(checked / means)[grid.near].max(axis=1)
    interpolated = interpolation_error(mu, np.where(trusted, lower, np.nan))
    error = safety * (mu * relative + interpolated) + sampling
    return _Curve(mu, error, sampling, reached)


def _read_off(
    grid: SharedCurve, line: Passages, rtol: float
) -> tuple[Passages, np.ndarray]:
    """Each point's own passage from a line curve, and where all of it is known to
    `rtol`.
    """
    positive = np.stack(line[:-2], axis=1)[grid.means]
    # an edge at the apex is solved for
    logs = np.log(np.where(positive > 0, positive, np.nan))
    fine = at_points(logs, grid.near, grid.local)
    error = at_points(np.asarray(line.error)[grid.means], grid.near, np.abs(grid.local))
    precise = 3 * between_orders(logs, grid.near) <= rtol
    return Passages(*[*np.exp(fine).T, error, precise]), precise


def _direct(
    sweep: _Sweep,
    load: np.ndarray,
    velocity: np.ndarray,
    level: int,
    known: list[_Solved],
) -> _Averaged:
    """Every velocity has its own directions: for few points, or where each has its own
    load.
    """
    rule = directions(sweep.rtol, level)
    slowed = velocity[:, None] * rule.cosines
    loads = np.broadcast_to(load[:, None], slowed.shape).ravel()
    every = _solve_new(sweep, loads, slowed.ravel(), known)
    every = Passages(*(field.reshape(slowed.shape) for field in every))
    # the first direction is the motion itself
    ahead = Passages(*(field[:, 0].copy() for field in every))
    line = np.asarray(every.mu)
    mu, sampling = line @ rule.weights, np.asarray(every.error) @ rule.weights
    unseen = rule.tail + _UNSEEN * sweep.rtol
    error = quadrature_error(mu, line @ rule.half, line @ rule.quarter, unseen)
    skew = np.stack([field @ rule.weights for field in _skew(every)])
    return _Averaged(
        mu,
        skew,
        np.asarray(error) + sampling,
        sampling,
        np.asarray(np.all(every.converged, axis=1)),
        ahead,
        _sunk(sweep.lines, every),
    )


def _solve_new(
    sweep: _Sweep, load: np.ndarray, velocity: np.ndarray, known: list[_Solved]
) -> Passages:
    """Passages at given loads, but for those `known` from longer steps of the average,
    to which it adds the others.
    """
    if not known:
        known.append((load, velocity, _solve(sweep, "load", load, velocity)))
        return known[0][2]
    asked = load + 1j * velocity  # pairs as one number each
    loads, velocities, every = _joined(known)
    rows = _place(asked, loads + 1j * velocities)
    new = (loads + 1j * velocities)[rows] != asked
    if new.any():
        load, velocity = load[new], velocity[new]
        known.append((load, velocity, _solve(sweep, "load", load, velocity)))
        loads, velocities, every = _joined(known)
        rows = _place(asked, loads + 1j * velocities)
    return Passages(*(field[rows] for field in every))


def _place(asked: Array, numbers: Array) -> np.ndarray:
    """Where each number asked for is among others, if it is there; any index if not."""
    order = np.argsort(numbers)
    return order[
        np.minimum(np.searchsorted(numbers, asked, sorter=order), order.size - 1)
    ]


def _joined(
    known: list[_Solved],
) -> tuple[Array, Array, Passages]:
    loads, velocities, parts = zip(*known, strict=True)
    every = Passages(*(np.concatenate(field) for field in zip(*parts, strict=True)))
    return np.concatenate(loads), np.concatenate(velocities), every


def _solve(sweep: _Sweep, control: Control, value: Array, velocity: Array) -> Passages:
    """Passages as NumPy arrays, with the rules of the plan tried in turn where the
    error asks for it.
    """
    plan, law, lines, rtol = sweep
    wanted = 0.1 * rtol
    value, velocity = np.asarray(value), np.asarray(velocity)
    if plan.marched:
        # loads diffrax, which the other routes do without
        from .march import march_passages

        return march_passages(law, lines, control, value, velocity, max(wanted, 1e-9))
    passages = _in_batches(law, lines, plan.rules[0], control, value, velocity)
    for finer in plan.rules[1:]:
        # a coarse rule may show no trailing edge near the end of a ball
        left = ~(passages.converged & (passages.error <= wanted * passages.mu))
        if not np.any(left):
            break
        _put(
            passages,
            np.asarray(left),
            _in_batches(law, lines, finer, control, value[left], velocity[left]),
        )
    return passages


def batch_size(law: Relaxation, lines: AbstractLines, rule: Rule) -> int:
    """How many points to solve at once, as the memory is meant to hold."""
    panels = (len(rule.fractions) - 1) * (rule.strips if lines.count > 1 else 1)
    panels *= lines.shape.r.size if isinstance(lines.shape, Profile) else 1
    return int(np.clip(_NUMBERS // (panels * (1 + law.moduli.size)), 16, _BATCH))


def _in_batches(
    law: Relaxation,
    lines: AbstractLines,
    rule: Rule,
    control: Control,
    value: Array,
    velocity: Array,
) -> Passages:
    """`solve_passages` for as many points at once as the memory is meant to hold."""
    most = batch_size(law, lines, rule)
    if velocity.size <= most:
        return solve_passages(law, lines, rule, control, value, velocity)
    parts = [
        solve_passages(law, lines, rule, control, value[batch], velocity[batch])
        for batch in np.array_split(np.arange(velocity.size), -(-velocity.size // most))
    ]
    return Passages(*(np.concatenate(field) for field in zip(*parts, strict=True)))


# Under a transformation of JAX


@functools.cache
def _with_slopes(plan: Plan) -> Any:
    """A sweep as one tuple of arrays: numbers from NumPy, derivatives from formulas.

    The numbers are those of the same call outside, since the plan is made of the
    values that NumPy sees.
    """

    def numbers(shared: PyTree, points: PyTree) -> Any:
        (law, lines), (value, velocity) = shared, points
        sweep = _of_values(plan, law, lines, value, velocity)
        return (sweep.mu, *sweep.line, sweep.error, sweep.model_error)

    def friction(shared: PyTree, points: PyTree) -> Any:
        (law, lines), (value, velocity) = shared, points
        return (_averaged_by_formula(plan, law, lines, value, velocity),)

    def line(shared: PyTree, points: PyTree) -> Any:
        (law, lines), (value, velocity) = shared, points
        rule, control = plan.rules[0], plan.control
        return solve_passages(law, lines, rule, control, value, velocity)[:-2]

    def like(shared: PyTree, points: PyTree) -> Any:
        return (points[0],) * (3 + len(Passages._fields))

    formulas = (friction, 1), (line, len(Passages._fields) - 2)
    return numbers_with_slopes(numbers, formulas, like)


def _of_values(
    plan: Plan, law: Relaxation, lines: AbstractLines, value: Array, velocity: Array
) -> SolvedPoints:
    """`run` by a plan made of values; NaN where no contact can have them."""
    good = np.isfinite(value) & (value > 0) & np.isfinite(velocity) & (velocity > 0)
    good &= all(np.all(np.isfinite(x) & (x >= 0)) for x in vars(law).values())
    blank = np.full((3 + len(Passages._fields), value.size), np.nan)
    mu, error, model_error, *line = blank
    sweep = SolvedPoints(mu, error, Passages(*line), model_error)
    if not good.any():
        return sweep
    value, velocity = np.asarray(value[good]), np.asarray(velocity[good])
    asked = dataclasses.replace(plan, points=value.size)
    known_plan = make_plan(asked, law, lines, value, velocity)
    solved = run(known_plan, law, lines, value, velocity)
    sweep.mu[good] = solved.mu
    sweep.error[good] = solved.error
    sweep.model_error[good] = solved.model_error
    _put(sweep.line, good, solved.line)
    return sweep


def _averaged_by_formula(
    plan: Plan, law: Relaxation, lines: AbstractLines, value: Array, velocity: Array
) -> Array:
    """Friction by a fixed rule for directions, for its derivatives."""

    def solve(control: Control, value: Array, velocity: Array) -> Passages:
        return solve_passages(law, lines, plan.rules[0], control, value, velocity)

    if not plan.averaged:
        return solve(plan.control, value, velocity).mu * (0.0 if plan.elastic else 1.0)
    rule = directions(plan.rtol * TRACED, traced_level(plan.rtol, plan.bends))
    load = value
    if plan.control == "depth":
        load = solve("depth", value, velocity).normal_force
    slowed = velocity[:, None] * rule.cosines
    loads = xp.broadcast_to(load[:, None], slowed.shape)
    passages = solve("load", loads.ravel(), slowed.ravel())
    passages = Passages(*(field.reshape(slowed.shape) for field in passages))
    ahead = Passages(*(field[:, 0] for field in passages))
    mu = passages.mu @ rule.weights
    skew = xp.stack([x @ rule.weights for x in _skew(passages)])
    return _against_half_space(plan, law, mu, skew, xp.zeros_like(mu), ahead)[0]
