"""Impacts to a tolerance: the same motion on finer and finer grids, extrapolated, with
an estimate of what is left.
"""

from __future__ import annotations

import functools
import os
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import compiled, fixed, mapped, on_jax, on_numpy, xp
from ..checks import Array, is_traced
from .impact_motion import COARSEST, Body, Motion, grid, march

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

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
# lanes computed together: their states fit the processor's cache
_BLOCK, _SMALL = 256, 8
# fall of the force at the turn, from the fourth grid to the last, for a body that never
# turns
_STUCK = 0.3
_REST = 1e-3  # and largest share that it may have of the largest force


class Impacts(NamedTuple):
    """Impacts of many bodies; histories have their nodes first."""

    motion: Motion
    error: Float[Array, " lanes"]  # estimated error of the restitution, absolute
    # the body never turns: a liquid too viscous to throw it back
    stuck: Bool[Array, " lanes"]
    converged: Bool[Array, " lanes"]  # restitution and depth to rtol
    # and the duration to 100 rtol: strong damping leaves the instant of the turn open
    timed: Bool[Array, " lanes"]


def impacts(body: Body, *, per_area: bool, rtol: float) -> Impacts:
    """Every lane to `rtol`, on finer grids where one needs them and values are known
    (not under `jit` or `grad`).
    """
    if is_traced(body):
        return _stage(body, rtol, per_area=per_area, stage=1)
    lanes = int(body.velocity.shape[0])
    if lanes <= _SMALL:
        return _block(body, per_area, rtol)

    def solve(start: int) -> Impacts:
        block = _lanes(body, np.arange(start, min(start + _BLOCK, lanes)))
        return on_jax(_block, block, per_area, rtol)  # a thread has its own setting

    if lanes <= _BLOCK:
        return solve(0)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        parts = list(pool.map(solve, range(0, lanes, _BLOCK)))
    return mapped(lambda *pieces: np.concatenate(pieces, axis=-1), *parts)


def _block(body: Body, per_area: bool, rtol: float) -> Impacts:
    """A block of lanes whose values can be looked at: stage by stage, each for those
    that the last left open.
    """
    lanes = int(body.velocity.shape[0])
    found: Any = None
    waiting = np.arange(lanes)
    for stage in range(len(_STAGES)):
        # few, so that few are compiled
        sizes = () if on_numpy() else (_SMALL, 64, _BLOCK)
        size = next((n for n in sizes if n >= waiting.size), waiting.size)
        part = _stage(
            _lanes(body, np.resize(waiting, size)), rtol, per_area=per_area, stage=stage
        )
        part = mapped(lambda x, n=waiting.size: np.array(x)[..., :n], part)
        if found is None:
            found = part
        else:
            mapped(
                lambda whole, piece, at=waiting: whole.__setitem__((..., at), piece),
                found,
                part,
            )
        waiting = np.flatnonzero(
            ~(found.converged & found.timed) & np.isfinite(found.motion.max_depth)
        )
        if not waiting.size:
            break
    return found


def _lanes(body: Body, chosen: Array) -> Body:
    lanes = body.velocity.shape
    return Body(
        body.shape,
        *(np.broadcast_to(x, (*x.shape[:-1], *lanes))[..., chosen] for x in body[1:]),
    )


@compiled("per_area", "stage")
def _stage(body: Body, rtol: float, *, per_area: bool, stage: int) -> Impacts:
    """All grids of a stage, extrapolated to n = infinity: a polynomial in n^-2 through
    them.
    """
    sizes = _STAGES[stage]
    if on_numpy():
        of_grids = [
            march(body, grid(k * COARSEST, k * COARSEST), per_area=per_area)
            for k in sizes
        ]
        motions = mapped(lambda *x: np.stack(x), *of_grids)
    else:  # one program, for the largest
        import jax

        grids = [grid(k * COARSEST, sizes[-1] * COARSEST) for k in sizes]
        motions = jax.lax.map(
            lambda g: march(body, g, per_area=per_area),
            mapped(lambda *x: np.stack(x), *grids),
        )
    series = [
        _extrapolated(motions, sizes[: len(sizes) - left])
        for left in range(min(4, len(sizes) - 1))
    ]
    best, before = series[:2]
    error, duration, depth = (
        _left(*values) for values in zip(*(one[:3] for one in series), strict=True)
    )
    duration, depth = (
        duration / xp.abs(before.duration),
        depth / xp.abs(before.max_depth),
    )
    enough = (error <= rtol * xp.abs(best.restitution)) & (depth <= rtol)
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
    good = (xp.all(motions.solved, axis=0) & enough & xp.isfinite(best.restitution)) | (
        stuck & (depth <= rtol)
    )
    timed = (duration <= _LOOSER * rtol) | stuck
    return Impacts(best, fixed(xp.where(stuck, 0.0, error)), stuck, good, timed)


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


def _extrapolated(motions: Motion, sizes: tuple[int, ...]) -> Motion:
    """The value at 0 of the polynomial in 1/k^2 through the first grids; weights of
    Lagrange.
    """
    squares = np.square(np.array(sizes, dtype=float))
    weights = [np.prod([a / (a - b) for b in squares if b != a]) for a in squares]
    return mapped(
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
