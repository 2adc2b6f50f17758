"""Free normal impact of a rigid body: m d'' = -F, d(0) = 0, d'(0) = v0, until the
contact force has gone.

While the contact grows every element has been pressed in since it was touched, at
t_1(x), so that with the measure A(d) of `surface.disc`

    F = E_inf A(d) + sum_k F_k + eta A'(d) d',    F_k' = E_k A'(d) d' - F_k/tau_k.

After the turn, d' = 0, the contact shrinks. Elements touched after the instant t_1(t)
have left; t_1 is where

    int_{t_1}^t E(t - s) d'(s) ds + eta d'(t) = 0,
    F = E_inf A(d(t_1)) + sum_k exp(-(t - t_1)/tau_k) F_k(t_1)

(Ting 1966; on the line each element leaves at zero force). Nothing else can happen in a
free impact: F >= 0 lets the velocity only fall, so that it changes sign once, and the
body retreats ever faster from a surface that recovers ever more slowly. All of this is
exact for the half-space.

Discretised by a grid of velocities, v_i = v0 (1 - s_i^6)^3 with s_i = i/n, so that no
time scale has to be known: in the approach the length of each step is the unknown; in
the rebound step j ends when the elements touched at node j leave. d and C_k = int E_k
exp(-(t - s)/tau_k) d'(s) ds follow from d' linear over the step, F_k from A'(d) d'
linear over it, with exact exponentials, the momentum from the trapezoidal rule. Each
step is symmetric in time, so the error is a series in n^-2, and Richardson's
extrapolation takes it away, term by term (`impacts`). Short
relaxation times need no short steps: their branches become dashpots exactly.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import compiled, cond, on_jax, on_numpy, scan, tree_map, xp
from ..checks import Array
from ..numerics.decay import ramp_weights
from ..numerics.interpolation import peak
from ..numerics.root import root, search
from ..surface.disc import Disc, contact_measure
from ..surface.shapes import AbstractShape, FlatPunch

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

COARSEST = 16  # n of the first grid, and half the intervals of a history
# powers of the grid at both ends: steps shrink where the motion is not smooth in time
_START, _TURN = 6, 3
# grids, in units of the coarsest
_STAGES = ((1, 2, 3, 4), (1, 2, 3, 4, 5, 6, 7, 8), (1, 2, 3, 4, 6, 8, 10, 12, 16))
# Of the last correction. The error left is 0.02 of it in the median and 0.4 at most on
# smooth solids, but up to 4 with branches a millionth as long as the contact or a
# strong dashpot. Where corrections shrink slowly, each to r of the one before, r/(1 -
# r) of it is left, and 12 to 21 times it was seen where they do not shrink. One that is
# small by chance says nothing, which those before it show
# (benchmarks/robustness/stress_motion.py).
_SHARE, _SLOWEST, _BY_CHANCE = 4.0, 20.0, 0.5
# relative correction below which it is not for a series any more to shrink
_ROUNDING = 1e-9
_LOOSER = 100  # times rtol: what a duration may miss
# impacts computed together: their states fit the processor's cache
_BLOCK, _SMALL = 256, 8
# impacts up to which NumPy is taken: with 16 branches 500 take 3 s, and .9 s compiled,
# after 8 s of compiling
_FEW = 500
# fall of the force at the turn, from the fourth grid to the last, for a body that never
# turns
_STUCK = 0.3
_REST = 1e-3  # and largest share that it may have of the largest force


class ApproachGrid(NamedTuple):
    """n steps of the approach, filled up with steps that are not taken; so that grids
    of one size compile once. On NumPy several stand side by side, one for each impact,
    with a second axis.
    """

    taken: Bool[Array, " size"]
    kept: Float[Array, " size"]  # v/v0 at the end of the step
    lost: Float[Array, " size"]  # loss of v/v0 in the step
    stride: Float[Array, " size"]  # change of ln s from the middle of the last step
    last: Any  # n
    shown: Array  # which nodes of the approach a history keeps, (COARSEST + 1,)


class Striker(NamedTuple):
    """What strikes, and on what; impacts run over the last axis."""

    shape: AbstractShape | Disc  # a body, or its contact on rubber of finite thickness
    # 1/tau_k, the first one zero: the equilibrium spring [1/s]
    rates: Float[Array, "k impacts"]
    moduli: Float[Array, "k impacts"]  # [Pa, or Pa/m]
    viscosity: Float[Array, " impacts"]  # [Pa s, or Pa s/m]
    mass: Float[Array, " impacts"]  # [kg]
    velocity: Float[Array, " impacts"]  # [m/s]


class ImpactMotion(NamedTuple):
    """An impact from one grid. Histories: n + 1 nodes from touch to turn, then n to the
    end.
    """

    restitution: Float[Array, " impacts"]
    duration: Float[Array, " impacts"]  # [s]
    max_depth: Float[Array, " impacts"]  # [m]
    max_force: Float[Array, " impacts"]  # [N]
    peak: Float[Array, " impacts"]  # where that is, s from 0 at touch to 1 at the turn
    turning: Float[Array, " impacts"]  # force at the turn over the largest force
    time: Float[Array, "nodes impacts"]  # [s]
    depth: Float[Array, "nodes impacts"]  # [m]
    speed: Float[Array, "nodes impacts"]  # d' [m/s]
    force: Float[Array, "nodes impacts"]  # [N]
    solved: Bool[Array, " impacts"]


class _Node(NamedTuple):
    """State at a node of the approach."""

    time: Array
    depth: Array
    speed: Array
    rate: Array  # A'(d) d'
    forces: Array  # F_k, (k, impacts)
    centre: Array  # C_k, (k, impacts)
    force: Array  # F


def march(body: Striker, grid: ApproachGrid, *, per_area: bool) -> ImpactMotion:
    """Impacts on one grid."""
    zero = xp.zeros(body.velocity.shape)
    none = xp.zeros((body.rates.shape[0], *zero.shape))
    punch = (
        body.shape.flat
        if isinstance(body.shape, Disc)
        else isinstance(body.shape, FlatPunch)
    )
    rate = (
        contact_measure(body.shape, zero, per_area) * body.velocity if punch else zero
    )
    start = _Node(zero, zero, body.velocity, rate, none, none, body.viscosity * rate)
    turn, nodes, steps, good = _approach(body, per_area, start, grid)
    path = tree_map(
        lambda first, rest: xp.concatenate([first[None], rest]), start, nodes
    )
    retreat = _retreat_of_punch if punch else _retreat
    end, states, left = retreat(body, per_area, path, turn, steps, grid)
    largest, place = peak(path.force, grid.last)
    size = grid.kept.shape[0]

    def joined(before: Array, after: Array) -> Array:
        return xp.concatenate(
            [_rows(before, grid.shown), _rows(after, size - 1 - grid.shown[-2::-1])]
        )

    return ImpactMotion(
        restitution=-end.speed / body.velocity,
        duration=end.time,
        max_depth=turn.depth,
        max_force=largest,
        peak=place,
        turning=turn.force / largest,
        time=joined(path.time, states.time),
        depth=joined(path.depth, states.depth),
        speed=joined(path.speed, states.speed),
        force=joined(path.force, states.force),
        solved=good & left,
    )


def _rows(values: Array, rows: Any) -> Array:
    """These nodes of all impacts, or of each its own."""
    if rows.ndim == 1:
        return values[rows]
    return np.take_along_axis(values, rows, axis=0)


def _where_taken(
    taken: Array, take: Callable[..., tuple], body: Striker, *given: tuple
) -> tuple:
    """The carry after a step of the impacts that take it; the others keep theirs."""
    if taken.ndim == 0:
        return cond(taken, take, lambda body, carry, step: carry, body, *given)
    if np.all(taken):
        return take(body, *given)
    here = np.flatnonzero(taken)
    carry, step = tree_map(lambda x: x[..., here] if np.ndim(x) else x, given)
    after = take(_select(body, here), carry, step)

    def placed(old: Array, new: Array) -> Array:
        whole = old.copy()
        whole[..., here] = new
        return whole

    return tree_map(placed, given[0], after)


@functools.cache
def grid(n: int, size: int) -> ApproachGrid:
    """The grid of n steps, as one of `size`: NumPy arrays."""
    s = np.arange(n + 1) / n
    kept = (1 - s**_START) ** _TURN
    kept[-1] = 0.0
    lost = np.append(-np.expm1(_TURN * np.log1p(-(s[:-1] ** _START))), 1.0)
    loss = np.where(s[1:] < 0.5, np.diff(lost), -np.diff(kept))  # without cancellation
    stride = np.append(1.0, np.diff(np.log(np.arange(n) + 0.5)))
    fill = np.zeros(size - n)
    return ApproachGrid(
        taken=np.arange(size) < n,
        kept=np.append(kept[1:], fill),
        lost=np.append(loss, fill),
        stride=np.append(stride, fill),
        last=np.asarray(n),
        shown=np.arange(COARSEST + 1) * (n // COARSEST),
    )


@functools.lru_cache(8)  # 10 MB each for hundreds of impacts
def _side_by_side(multiples: tuple[int, ...], impacts: int) -> ApproachGrid:
    """Grids of so many times the coarsest, each for so many impacts."""
    size = multiples[-1] * COARSEST
    grids = [grid(k * COARSEST, size) for k in multiples]
    return ApproachGrid(
        *(
            np.repeat(np.stack(x, axis=-1), impacts, axis=-1)
            for x in zip(*grids, strict=True)
        )
    )


class _Approach(NamedTuple):
    """From touch to the turn."""

    turn: _Node
    nodes: _Node  # after each step
    lengths: Array  # of the steps
    good: Array  # which impacts were solved


def _approach(
    body: Striker, per_area: bool, start: _Node, grid: ApproachGrid
) -> _Approach:

    def after(body: Striker, node: _Node, log_h: Array, speed: Array) -> _Node:
        h = xp.exp(log_h)
        decay, early, late = ramp_weights(h * body.rates)
        depth = node.depth + 0.5 * h * (node.speed + speed)
        rate = contact_measure(body.shape, depth, per_area) * speed
        gain = h * body.moduli
        forces = decay * node.forces + gain * (early * node.rate + late * rate)
        centre = decay * node.centre + gain * (early * node.speed + late * speed)
        force = xp.sum(forces, axis=0) + body.viscosity * rate
        return _Node(node.time + h, depth, speed, rate, forces, centre, force)

    def take(body: Striker, carry: tuple, step: ApproachGrid) -> tuple:
        node, log_force, slope, good = carry
        momentum = xp.log(body.mass * body.velocity * step.lost)
        speed = body.velocity * step.kept

        def residual(log_h: Array) -> Array:
            return (
                log_h
                + xp.log(0.5 * (node.force + after(body, node, log_h, speed).force))
                - momentum
            )

        # The mean force over a step is nearly a power of s: that gives the first guess
        # of the step's length.
        log_h, met = root(residual, momentum - (log_force + slope * step.stride))
        mean = momentum - log_h
        slope = xp.clip((mean - log_force) / step.stride, -20, 20)
        return after(body, node, log_h, speed), mean, slope, good & met

    def step(carry: tuple, step: ApproachGrid) -> tuple:
        ahead = _where_taken(step.taken, take, body, carry, step)
        return ahead, (ahead[0], ahead[0].time - carry[0].time)

    momentum = xp.log(body.mass * body.velocity * grid.lost[0])
    log_force = momentum - _first_step(body, per_area, grid)
    carry = (start, log_force, xp.zeros_like(log_force), xp.ones(log_force.shape, bool))
    steps = grid._replace(
        last=xp.zeros(grid.kept.shape), shown=xp.zeros(grid.kept.shape)
    )
    (turn, _, _, good), (nodes, lengths) = scan(step, carry, steps)
    return _Approach(turn, nodes, lengths, good)


def _first_step(body: Striker, per_area: bool, grid: ApproachGrid) -> Array:
    """Logarithm of a rough length of the first step, of which no scale is known."""
    momentum = xp.log(body.mass * body.velocity * grid.lost[0])

    def residual(log_h: Array) -> Array:
        h = xp.exp(log_h)
        measure = (
            contact_measure(body.shape, body.velocity * h, per_area) * body.velocity
        )
        _, _, late = ramp_weights(h * body.rates)
        return (
            log_h
            + xp.log(
                0.5
                * measure
                * (h * xp.sum(body.moduli * late, axis=0) + body.viscosity)
            )
            - momentum
        )

    return search(residual, xp.full(body.velocity.shape, -7.0))[0]


class _Rebound(NamedTuple):
    """State of the body after the turn, and of the element in the middle."""

    time: Array
    depth: Array
    speed: Array
    centre: Array  # C_k, (k, impacts)
    force: Array


def _retreat(
    body: Striker,
    per_area: bool,
    path: _Node,
    turn: _Node,
    lengths: Array,
    grid: ApproachGrid,
) -> tuple[_Rebound, _Rebound, Array]:
    """From the turn to the end: step j ends when the elements touched at node j of the
    approach leave.
    """

    def after(
        body: Striker, node: _Rebound, touched: _Node, log_h: Array
    ) -> tuple[Array, _Rebound]:
        h = xp.exp(log_h)
        decay, early, late = ramp_weights(h * body.rates)
        since = xp.exp(-body.rates * (node.time + h - touched.time))
        force = xp.sum(since * touched.forces, axis=0)
        speed = node.speed - 0.5 * h * (node.force + force) / body.mass
        centre = decay * node.centre + h * body.moduli * (
            early * node.speed + late * speed
        )
        density = (
            xp.sum(centre - since * touched.centre, axis=0) + body.viscosity * speed
        )
        return density, _Rebound(
            node.time + h,
            node.depth + 0.5 * h * (node.speed + speed),
            speed,
            centre,
            force,
        )

    def take(body: Striker, carry: tuple, step: tuple) -> tuple:
        node, log_ratio, trend, good = carry
        touched, log_length, _, _ = step
        since = xp.exp(-body.rates * (node.time - touched.time))
        held = (
            xp.sum(node.centre - since * touched.centre, axis=0)
            + body.viscosity * node.speed
        )

        def residual(log_h: Array) -> Array:  # rises as a power of the step does
            return xp.log((held - after(body, node, touched, log_h)[0]) / held)

        log_h, met = root(residual, log_length + log_ratio + trend)
        ratio = log_h - log_length
        trend = xp.clip(xp.where(trend == 0, 0.5, 1.0) * (ratio - log_ratio), -1.0, 1.0)
        return after(body, node, touched, log_h)[1], ratio, trend, good & met

    def step(carry: tuple, step: tuple) -> tuple:
        carry = _where_taken(step[2], take, body, carry, step)
        ended = carry[0]._replace(force=xp.where(step[3], 0.0, carry[0].force))
        return (ended, *carry[1:]), ended

    touched = tree_map(lambda x: x[-2::-1], path)
    log_lengths = xp.log(xp.where(lengths > 0, lengths, 1.0))[::-1]
    zero = xp.zeros_like(log_lengths[0])
    first = xp.arange(log_lengths.shape[0])[::-1] == 0
    node = _Rebound(turn.time, turn.depth, turn.speed, turn.centre, turn.force)
    carry = (node, zero, zero, xp.ones(zero.shape, bool))
    (end, _, _, good), states = scan(
        step, carry, (touched, log_lengths, grid.taken[::-1], first)
    )
    return end, states, good


def _retreat_of_punch(
    body: Striker,
    per_area: bool,
    path: _Node,
    turn: _Node,
    lengths: Array,
    grid: ApproachGrid,
) -> tuple[_Rebound, _Rebound, Array]:
    """All elements of a flat punch leave together: step j ends when the force is F_turn
    (1 - (1 - j/n)^2).
    """
    measure = contact_measure(body.shape, turn.depth, per_area)

    def after(
        body: Striker, carry: tuple, target: Array, log_h: Array
    ) -> tuple[Array, _Rebound]:
        node, measure = carry[0], carry[-1]
        h = xp.exp(log_h)
        decay, early, late = ramp_weights(h * body.rates)
        speed = node.speed - 0.5 * h * (node.force + target) / body.mass
        centre = decay * node.centre + h * body.moduli * (
            early * node.speed + late * speed
        )
        depth = node.depth + 0.5 * h * (node.speed + speed)
        force = measure * (xp.sum(centre, axis=0) + body.viscosity * speed)
        return force, _Rebound(node.time + h, depth, speed, centre, target)

    def take(body: Striker, carry: tuple, step: tuple) -> tuple:
        node, log_h, good, measure = carry
        target, _ = step

        def residual(log_h: Array) -> Array:
            force = after(body, carry, target, log_h)[0]
            return xp.log((node.force - force) / (node.force - target))

        log_h, met = root(residual, log_h)
        return after(body, carry, target, log_h)[1], log_h, good & met, measure

    def step(carry: tuple, step: tuple) -> tuple:
        carry = _where_taken(step[1], take, body, carry, step)
        return carry, carry[0]

    j = xp.arange(grid.kept.shape[0])[::-1, None]
    targets = turn.force * (1 - (1 - j / grid.last) ** 2)
    node = _Rebound(turn.time, turn.depth, turn.speed, turn.centre, turn.force)
    guess = xp.log(turn.time / grid.last)
    carry = (node, guess, xp.ones(guess.shape, bool), measure)
    (end, _, good, _), states = scan(step, carry, (targets, grid.taken[::-1]))
    return end, states, good


class Impacts(NamedTuple):
    """Impacts of many bodies; histories have their nodes first."""

    motion: ImpactMotion
    error: Float[Array, " impacts"]  # estimated error of the restitution, absolute
    # the body never turns: a liquid too viscous to throw it back
    stuck: Bool[Array, " impacts"]
    converged: Bool[Array, " impacts"]  # restitution and depth to rtol
    # and the duration to 100 rtol: strong damping leaves the instant of the turn open
    timed: Bool[Array, " impacts"]
    reached: Float[Array, " impacts"]  # the larger relative error of these two


def impacts(body: Striker, *, per_area: bool, rtol: float) -> Impacts:
    """Every impact to `rtol`, on finer grids where one needs them."""
    count = int(body.velocity.shape[0])
    starts = range(0, count, _BLOCK)
    blocks = [_select(body, np.arange(i, min(i + _BLOCK, count))) for i in starts]
    if count <= _FEW:
        parts = [_block(block, per_area, rtol) for block in blocks]
    else:  # a thread has its own setting
        pool = ThreadPoolExecutor(os.cpu_count())
        try:
            parts = list(pool.map(lambda b: on_jax(_block, b, per_area, rtol), blocks))
        finally:  # an interrupt does not wait for the blocks that are under way
            pool.shutdown(wait=False, cancel_futures=True)
    return tree_map(lambda *pieces: np.concatenate(pieces, axis=-1), *parts)


def _block(body: Striker, per_area: bool, rtol: float) -> Impacts:
    """A block of impacts: stage by stage, each for those that the last left open."""
    count = int(body.velocity.shape[0])
    solved: Any = None
    waiting = np.arange(count)
    for stage in range(len(_STAGES)):
        # few, so that few are compiled
        sizes = () if on_numpy() else (_SMALL, 64, _BLOCK)
        size = next((n for n in sizes if n >= waiting.size), waiting.size)
        batch = _select(body, np.resize(waiting, size))
        latest = _stage(batch, rtol, per_area=per_area, stage=stage)
        latest = tree_map(lambda x, n=waiting.size: np.array(x)[..., :n], latest)
        if solved is None:
            solved = latest
        else:
            tree_map(
                lambda whole, piece, i=waiting: whole.__setitem__((..., i), piece),
                solved,
                latest,
            )
        waiting = np.flatnonzero(
            ~(solved.converged & solved.timed) & np.isfinite(solved.motion.max_depth)
        )
        if not waiting.size:
            break
    return solved


def _select(body: Striker, chosen: Array) -> Striker:
    """The impacts with these numbers."""
    batch_shape = body.velocity.shape
    return Striker(
        body.shape,
        *(
            np.broadcast_to(x, (*x.shape[:-1], *batch_shape))[..., chosen]
            for x in body[1:]
        ),
    )


@compiled("per_area", "stage")
def _stage(body: Striker, rtol: float, *, per_area: bool, stage: int) -> Impacts:
    """All grids of a stage, extrapolated to n = infinity: a polynomial in n^-2 through
    them.
    """
    sizes = _STAGES[stage]
    if on_numpy():
        count = body.velocity.shape[-1]
        of_grids = march(
            _select(body, np.tile(np.arange(count), len(sizes))),
            _side_by_side(sizes, count),
            per_area=per_area,
        )
        motions = tree_map(
            lambda x: np.moveaxis(x.reshape(*x.shape[:-1], -1, count), -2, 0), of_grids
        )
    else:  # one program, for the largest
        import jax

        grids = [grid(k * COARSEST, sizes[-1] * COARSEST) for k in sizes]
        motions = jax.lax.map(
            lambda g: march(body, g, per_area=per_area),
            tree_map(lambda *x: np.stack(x), *grids),
        )
    series = [
        _extrapolated(motions, sizes[: len(sizes) - left])
        for left in range(min(4, len(sizes) - 1))
    ]
    best, before = series[:2]
    error, duration, depth = (
        _left(*values) for values in zip(*(one[:3] for one in series), strict=True)
    )
    duration = duration / xp.abs(before.duration)
    depth = depth / xp.abs(before.max_depth)
    enough = (error <= rtol * xp.abs(best.restitution)) & (depth <= rtol)
    reached = xp.maximum(error / xp.abs(best.restitution), depth)
    fine, coarse = motions.turning[-1], motions.turning[3]
    liquid = (body.moduli[0] == 0) & (
        (fine <= 1e-12) | ((fine < _STUCK * coarse) & (fine < _REST))
    )
    stuck = xp.broadcast_to(liquid, error.shape)
    best = best._replace(
        max_force=motions.max_force[-1]
        + _between(best.force - motions.force[-1], motions.peak[-1]),
        restitution=xp.where(stuck, 0.0, best.restitution),
        duration=xp.where(stuck, xp.inf, best.duration),
    )
    solved = xp.all(motions.solved, axis=0)
    good = (solved & enough & xp.isfinite(best.restitution)) | (stuck & (depth <= rtol))
    timed = (duration <= _LOOSER * rtol) | stuck
    error = xp.where(stuck, 0.0, error)
    reached = xp.where(solved & ~stuck, reached, xp.nan)
    return Impacts(best, error, stuck, good, timed, reached)


def _left(
    best: Array, before: Array, earlier: Array, earliest: Array | None = None
) -> Array:
    """What may be left of an error, by the last corrections, of which four grids have
    two only.
    """
    last, first = xp.abs(best - before), xp.abs(before - earlier)
    left = 2 * last / xp.maximum(first - last, 1e-300)  # 2 r/(1 - r)
    share = xp.where(last < first, xp.clip(left, _SHARE, _SLOWEST), _SLOWEST)
    share = xp.where(last < _ROUNDING * xp.abs(best), _SHARE, share)
    if earliest is None:
        return share * last
    shrank = xp.minimum(first / xp.maximum(xp.abs(earlier - earliest), 1e-300), 1.0)
    return xp.maximum(share * last, _BY_CHANCE * first * shrank)


def _extrapolated(motions: ImpactMotion, sizes: tuple[int, ...]) -> ImpactMotion:
    """The value at 0 of the polynomial in 1/k^2 through the first grids; weights of
    Lagrange.
    """
    squares = np.square(np.array(sizes, dtype=float))
    weights = [np.prod([a / (a - b) for b in squares if b != a]) for a in squares]
    return tree_map(
        lambda x: (
            x[0]
            if x.dtype == bool
            else xp.tensordot(np.array(weights), x[: len(sizes)], axes=1)
        ),
        motions,
    )


def _between(nodes: Array, s: Array) -> Array:
    """A smooth function given at the coarsest grid's nodes, at s from 0 to 1: the cubic
    through four of them.
    """
    first = xp.clip(xp.floor(s * COARSEST).astype(int) - 1, 0, COARSEST - 3)
    x = s * COARSEST - first
    rows = xp.take_along_axis(nodes, first[None] + xp.arange(4)[:, None], axis=0)
    weights = [np.prod([1 / (i - j) for j in range(4) if j != i]) for i in range(4)]
    total = xp.zeros_like(x)
    for i, (w, row) in enumerate(zip(weights, rows, strict=True)):
        total = total + w * row * functools.reduce(
            xp.multiply, [x - j for j in range(4) if j != i]
        )
    return total
