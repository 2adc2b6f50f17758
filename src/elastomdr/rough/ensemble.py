"""How the points of a call are solved on an ensemble of rough lines: alone, or averaged
over directions.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from ..checks import Array
from ..errors import InputError
from ..surface.direction import (
    SharedGrid,
    directions,
    interpolation_error,
    quadrature_error,
    shared_grid,
)
from ..surface.rough_line import RoughLine
from ..surface.spectrum import PERIODS, AbstractSpectrum, synthesise
from .periodic import Job, SolvedLine

# least relative error asked of the direction average: contacts that come and go leave
# kinks in mu(v)
AVERAGE = 1e-5
# estimated error for the sampling of a line over mu, up to which a point is handed out
SAMPLING = 0.1
_SAMPLES = 4096  # least number of samples of a line that is given by its points


class Mean(NamedTuple):
    """The answer at each point, a mean over the lines."""

    mu: Array
    error: Array
    load: Array
    depth: Array
    share: Array
    good: Array
    scatter: Array | None  # standard error of mu


class LinePoints(NamedTuple):
    """The points of a call, flattened."""

    velocity: np.ndarray  # times a_T [m/s]
    value: np.ndarray  # line load [N/m] or depth [m]
    control: Literal["load", "depth"]
    rtol: float

    def on(self, line: RoughLine) -> Job:
        """The points on a line."""
        height, spacing = np.asarray(line.height), float(line.spacing)
        return Job(height, spacing, self.velocity, self.value, self.control)


Solver = Callable[[list[Job]], list[SolvedLine]]


def mean_of_lines(
    ask: LinePoints, lines: list[RoughLine], average: bool, solved: Solver
) -> Mean:
    """Mean over the lines, which are solved together."""
    jobs = [ask.on(line) for line in lines]
    if not average:
        runs = [_bare(line) for line in solved(jobs)]
    elif ask.control == "load":
        runs = _averaged(ask, jobs, solved)
    else:
        # each line and point has a load of its own, and so its own directions
        runs = [
            _averaged_at(ask, job, at, solved)
            for job, at in zip(jobs, solved(jobs), strict=True)
        ]
    mu, error, load, deep, share = (
        np.mean([getattr(r, k) for r in runs], axis=0) for k in _Run._fields[:-1]
    )
    scatter = (
        np.std([r.mu for r in runs], axis=0, ddof=1) / np.sqrt(len(runs))
        if len(runs) > 1
        else None
    )
    return Mean(
        mu,
        error,
        load,
        deep,
        share,
        np.all([r.good for r in runs], axis=0) & np.isfinite(mu),
        scatter,
    )


class _Run(NamedTuple):
    """One line's answer at each point."""

    mu: np.ndarray
    error: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    share: np.ndarray
    good: np.ndarray


def _bare(line: SolvedLine) -> _Run:
    return _Run(line.mu, line.error, line.load, line.depth, line.share, line.converged)


def _averaged_at(ask: LinePoints, job: Job, at: SolvedLine, solved: Solver) -> _Run:
    """One line's average at the loads that it has `at` its depths."""
    load = np.where(at.converged, at.load, 1.0)
    (run,) = _averaged(ask._replace(value=load, control="load"), [job], solved)
    return run._replace(depth=at.depth, good=run.good & at.converged)


def _averaged(ask: LinePoints, jobs: list[Job], solved: Solver) -> list[_Run]:
    """Averages over directions at given loads: points of one load share a line curve."""
    grids = _grids(ask)
    speeds = [ask.velocity, *(grid.velocity for grid, _ in grids)]
    loads = [ask.value] + [
        np.full(grid.velocity.size, ask.value[chosen][0]) for grid, chosen in grids
    ]
    velocity, value = np.concatenate(speeds), np.concatenate(loads)
    on_curves = [
        job._replace(velocity=velocity, value=value, control="load") for job in jobs
    ]
    return [_average_of(ask, grids, every) for every in solved(on_curves)]


def _average_of(
    ask: LinePoints, grids: list[tuple[SharedGrid, np.ndarray]], every: SolvedLine
) -> _Run:
    """One line's average, from its points themselves and then the nodes of each load's
    curve.
    """
    start, tail = ask.velocity.size, directions(max(ask.rtol, AVERAGE)).tail
    ahead = SolvedLine(*(field[:start] for field in every))
    mu, error = np.empty_like(ask.velocity), np.empty_like(ask.velocity)
    for grid, chosen in grids:
        on_curve = slice(start, start + grid.velocity.size)
        start = on_curve.stop
        curve, off = every.mu[on_curve], every.error[on_curve]
        known = np.isfinite(curve + off)
        # A node that failed spoils the points that use it and no others.
        broken = (grid.weights != 0) @ ~known > 0
        curve, off = (np.where(known, values, 0.0) for values in (curve, off))
        average = grid.weights @ curve
        mu[chosen] = np.where(broken, np.nan, average)
        error[chosen] = (
            quadrature_error(average, grid.half @ curve, grid.quarter @ curve, tail)
            + interpolation_error(average, np.where(broken, np.nan, grid.lower @ curve))
            + np.abs(grid.weights) @ off
        )
    good = ahead.converged & np.isfinite(mu)
    return _Run(mu, error, ahead.load, ahead.depth, ahead.share, good)


def _grids(ask: LinePoints) -> list[tuple[SharedGrid, np.ndarray]]:
    chosen = [np.flatnonzero(ask.value == value) for value in np.unique(ask.value)]
    return [
        (shared_grid(ask.velocity[points], max(ask.rtol, AVERAGE)), points)
        for points in chosen
    ]


def coarse_at(error: Array, mu: Array) -> Array:
    """Where the error of a point is above `SAMPLING` times mu, so that it is not handed
    out.
    """
    return ~(error <= SAMPLING * abs(mu))


def ensemble(
    surface: RoughLine | AbstractSpectrum,
    samples: int | None,
    periods: int,
    seeds: tuple[int, ...],
) -> list[RoughLine]:
    """The lines of a surface, one for each seed; a line that is given, on enough
    samples. Raises `InputError`.
    """
    if isinstance(surface, RoughLine):
        for name, given, usual in (
            ("seeds", seeds, (0,)),
            ("periods", periods, PERIODS),
        ):
            if given != usual:
                raise InputError(
                    argument=name,
                    got=given,
                    accepted="left out for a RoughLine, which is a line already",
                )
        factor = 4
        while surface.count * factor < (_SAMPLES if samples is None else samples):
            factor *= 2
        return [surface.finer(factor)]
    return [synthesise(surface, seed, periods, samples) for seed in seeds]
