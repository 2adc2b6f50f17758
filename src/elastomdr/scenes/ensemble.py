"""How the points of a call are solved on an ensemble of rough lines: alone, or averaged over directions."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .._runtime import Array
from ..errors import InputError
from ..mapping.direction import SharedGrid, directions, interpolation_error, quadrature_error, shared_grid
from ..mapping.rough_line import RoughLine
from ..mapping.synthesis import PERIODS, synthesise
from ..solve.periodic import Line

AVERAGE = 1e-5  # least relative error asked of the direction average: contacts that come and go leave kinks in mu(v)
_SAMPLES = 4096  # least number of samples of a line that is given by its points


class Ask(NamedTuple):
    """The points of a call, flattened."""

    velocity: np.ndarray  # times a_T [m/s]
    value: np.ndarray  # line load [N/m] or depth [m]
    control: Any
    rtol: float
    skip: bool


class Mean(NamedTuple):
    """The ensemble's answer at each point."""

    mu: Array
    error: Array
    load: Array
    depth: Array
    share: Array
    good: Array
    scatter: Array | None  # standard error of mu


def mean_of_lines(ask: Ask, lines: list[RoughLine], average: str | None, solved: Callable[..., Line]) -> Mean:
    """Mean over the lines; `solved(line, velocity, value, control, rtol)` gives the lanes of one line."""
    runs = [_bare(ask, line, solved) if average is None else _averaged(ask, line, solved) for line in lines]
    mu, error, load, deep, share = (np.mean([getattr(r, k) for r in runs], axis=0) for k in _Run._fields[:-1])
    scatter = np.std([r.mu for r in runs], axis=0, ddof=1) / np.sqrt(len(runs)) if len(runs) > 1 else None
    return Mean(mu, error, load, deep, share, np.all([r.good for r in runs], axis=0) & np.isfinite(mu), scatter)


class _Run(NamedTuple):
    """One line's answer at each point."""

    mu: np.ndarray
    error: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    share: np.ndarray
    good: np.ndarray


def _bare(ask: Ask, line: RoughLine, solved: Callable[..., Line]) -> _Run:
    own = solved(line, ask.velocity, ask.value, ask.control, ask.rtol)
    return _Run(own.mu, own.error + own.cost * own.mu, own.load, own.depth, own.share, own.converged)


def _averaged(ask: Ask, line: RoughLine, solved: Callable[..., Line]) -> _Run:
    """Points of one load share a line curve; with the depth given, each has its own load and so its own directions."""
    rtol = max(ask.rtol, AVERAGE)
    own = solved(line, ask.velocity, ask.value, ask.control, ask.rtol)
    mu, error = np.empty_like(ask.velocity), np.empty_like(ask.velocity)
    if ask.control == "depth":
        rule = directions(rtol)
        slowed = ask.velocity[:, None] * rule.cosines
        load = np.broadcast_to(np.where(own.converged, own.load, 1.0)[:, None], slowed.shape)
        every = solved(line, slowed.ravel(), load.ravel(), "load", ask.rtol)
        each = every.mu.reshape(slowed.shape)
        mu = each @ rule.weights
        error = (
            np.asarray(quadrature_error(mu, each @ rule.check, rule.tail))
            + every.error.reshape(slowed.shape) @ rule.weights
        )
        return _Run(mu, error + own.cost * mu, own.load, own.depth, own.share, own.converged & np.isfinite(mu))
    grids = _grids(ask)
    speeds = np.concatenate([grid.velocity for grid, _ in grids])
    loads = np.concatenate([np.full(grid.velocity.size, ask.value[chosen][0]) for grid, chosen in grids])
    every = solved(line, speeds, loads, "load", ask.rtol)
    start, tail = 0, directions(rtol).tail
    for grid, chosen in grids:
        part = slice(start, start + grid.velocity.size)
        start = part.stop
        curve = every.mu[part]
        used = grid.weights != 0
        # A node that failed spoils the points that use it and no others.
        broken = used @ ~np.isfinite(curve) > 0
        curve = np.where(np.isfinite(curve), curve, 0.0)
        average = grid.weights @ curve
        mu[chosen] = np.where(broken, np.nan, average)
        error[chosen] = (
            quadrature_error(average, grid.check @ curve, tail)
            + interpolation_error(average, np.where(broken, np.nan, grid.lower @ curve))
            + np.abs(grid.weights) @ np.nan_to_num(every.error[part])
            + average * np.nanmax(every.cost[part], initial=0.0)
        )
    return _Run(mu, error, own.load, own.depth, own.share, own.converged & np.isfinite(mu))


def _grids(ask: Ask) -> list[tuple[SharedGrid, np.ndarray]]:
    chosen = [np.flatnonzero(ask.value == value) for value in np.unique(ask.value)]
    return [(shared_grid(ask.velocity[points], max(ask.rtol, AVERAGE)), points) for points in chosen]


def lanes_of(ask: Ask, average: str | None) -> tuple[np.ndarray, np.ndarray]:
    """Velocities [m/s] that one line is solved at, with their line loads or depths.

    Where the depth is given, directions are solved at a load that is not known beforehand: the points alone stand here.
    """
    if average is None or ask.control == "depth":
        return ask.velocity, ask.value
    grids = _grids(ask)
    values = [np.full(grid.velocity.size, ask.value[chosen][0]) for grid, chosen in grids]
    return np.concatenate([ask.velocity, *(g.velocity for g, _ in grids)]), np.concatenate([ask.value, *values])


def solutions(ask: Ask, average: str | None) -> int:
    """Line solutions that one line takes."""
    if average is None:
        return ask.velocity.size
    if ask.control == "depth":
        return ask.velocity.size * (1 + directions(max(ask.rtol, AVERAGE)).cosines.size)
    return ask.velocity.size + sum(grid.velocity.size for grid, _ in _grids(ask))


def ensemble(surface: Any, samples: int | None, periods: int, seeds: int, first: int = 0) -> list[RoughLine]:
    """The lines of a surface, one for each seed; a line that is given, on enough samples. Raises `InputError`."""
    if isinstance(surface, RoughLine):
        if seeds != 1 or periods != PERIODS:
            raise InputError("seeds and periods belong to a surface given by its spectrum; a RoughLine is what it is.")
        factor = 4
        while surface.count * factor < (_SAMPLES if samples is None else samples):
            factor *= 2
        return [surface.finer(factor)]
    return [synthesise(surface, seed, periods, samples) for seed in range(first, first + seeds)]
