"""Gaps between rubber and random maps of a surface that is pressed into it, and the flow
through them: the leak of `em.HalfSpace`.

The rubber is at rest and elastic, of the modulus E* of the time that it has been
pressed. Its contact is that of `rough.half_space`, in three dimensions; the gap is the
displacement u = K p less the heights, in the cells that do not touch. Maps lie side by
side in a plane, and the flow through many of them is that of an effective medium of
theirs, along either axis,

    sum (w_i - w)/(w_i + w) = 0,

which is their mean where they differ little, and zero where half of them are closed.
"""

from typing import Any, NamedTuple

import numpy as np

from ..checks import is_traced
from ..errors import InputError
from ..models import GapFlow
from ..rough.half_space import area_of, solve, waves
from ..rough.random_maps import Grid, grid_of
from ..surface.spectrum import rough_map
from .gap_flow import channels, effective_medium, flow

# Relative error of the flow by four cells per shortest wave, over -ln(1 - A/0.415):
# benchmarks/leak_grid.py. It falls as the square of the cell.
_OF_CELLS, _CLOSES, _SURE = 0.12, 0.415, 0.38
_SMALL = 1e-4  # mean free path over w^(1/3) at which the slip of maps is added up


class Pressed(NamedTuple):
    """A map under a pressure."""

    gap: Any  # of each cell [m], 0 where it touches
    area: float  # real contact area over nominal area
    pressure: Any  # over E* [-], of each cell
    settled: bool


def pressed(
    heights: Any, side: float, relative_pressure: float, start: Any = None
) -> Pressed:
    """Periodic `heights` [m], positive into the rubber, on a square of `side` [m] under
    a mean pressure over E* of `relative_pressure`; `start` are the pressures of a
    lighter load.
    """
    sides = side, side
    contact = solve(
        _one,
        heights,
        sides,
        velocity=1.0,
        pressure=relative_pressure,
        start=start,
        double=False,
    )
    kernel = waves(_one, 1.0, heights.shape, sides).kernel
    displacement = np.fft.irfft2(
        kernel * np.fft.rfft2(contact.pressure), s=heights.shape
    )
    gap = displacement - (heights - heights.mean()) + contact.separation
    touches = contact.pressure > 0
    gap = np.where(touches, 0.0, np.maximum(gap, 0.0))
    return Pressed(gap, area_of(touches), contact.pressure, contact.settled)


def _one(omega: Any) -> Any:
    """E* at every frequency: what counts is the pressure over it."""
    return np.ones(np.shape(omega), complex)


def narrowest(gap: Any) -> float:
    """The gap at the narrowest place of the widest channel [m], the mean of both axes;
    NaN where none leads through along either.
    """
    sorted_gaps = np.unique(gap[gap > 0])
    critical = []
    for axis in (0, 1):
        low, high = -1, sorted_gaps.size  # channels of gaps above it: yes, no
        while high - low > 1:
            middle = (low + high) // 2
            wide = channels(gap >= sorted_gaps[middle])[1].values()
            if any(winding[axis] for winding in wide):
                low = middle
            else:
                high = middle
        if low >= 0:
            critical.append(sorted_gaps[low])
    return float(np.mean(critical)) if critical else np.nan


def leak(
    cells: int | None,
    periods: int | None,
    seeds: Any,
    surface: Any,
    relative_pressure: Any,
) -> GapFlow:
    """The answers of `em.HalfSpace` at pressures over E*, (points,)."""
    if is_traced(surface, relative_pressure):
        raise InputError("model must be em.Multiscale() under jit, grad and vmap.")
    grid = grid_of(surface, cells, periods)
    relative_pressure = np.asarray(relative_pressure)
    flows, slips = np.full((2, len(seeds), 2, relative_pressure.size), np.nan)
    gap, critical, area = (
        np.full((len(seeds), relative_pressure.size), np.nan) for _ in range(3)
    )
    for i, seed in enumerate(seeds):
        heights, side = rough_map(
            surface, seed, periods=grid.periods, points=grid.cells
        )
        start = None
        for j in np.argsort(relative_pressure):
            contact = pressed(heights, side, float(relative_pressure[j]), start)
            start = contact.pressure if contact.settled else None
            if contact.settled:
                through = flow(contact.gap)
                flows[i, :, j], slips[i, :, j] = through.conductance, through.slip
                gap[i, j], area[i, j] = contact.gap.mean(), contact.area
                critical[i, j] = narrowest(contact.gap)
    good: Any = np.isfinite(flows).all((0, 1))
    w = _of_maps(flows)
    path = _SMALL * np.where(w > 0, w, 1.0) ** (1 / 3)
    slip = (_of_maps(flows + path * slips) - w) / path
    work = (
        f"{len(seeds)} maps of {grid.cells} by {grid.cells} cells, {grid.periods} "
        "longest waves to a side"
    )
    return GapFlow(
        flow=w,
        slip=slip,
        gap=gap.mean(0),
        critical_gap=_mean_of_open(critical),
        area=area.mean(0),
        percolates=w > 0,
        error=_scatter(flows) + _of_cells(area.mean(0), surface, grid),
        model_error=None,
        good=good,
        said="Reynolds' equation on gaps in three dimensions (no reduction)",
        work=work,
    )


def _of_maps(flows: np.ndarray) -> np.ndarray:
    """The medium of maps and axes alike, from (maps, axes, points)."""
    maps, axes, points = flows.shape
    alike = np.ones(maps * axes)
    medium = [effective_medium(alike, flows[..., j].ravel(), 2) for j in range(points)]
    return np.array(medium)


def _mean_of_open(gaps: np.ndarray) -> np.ndarray:
    """Over the maps with a channel; NaN where there is none."""
    count = np.isfinite(gaps).sum(0)
    total = np.where(np.isfinite(gaps), gaps, 0.0).sum(0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _of_cells(area: np.ndarray, surface: Any, grid: Grid) -> np.ndarray:
    """How much less a map leaks than on ever finer cells, relative."""
    per_wave = grid.cells * surface.q_low / (grid.periods * surface.q_high)
    near = -np.log(1 - np.minimum(area, _SURE) / _CLOSES)
    return _OF_CELLS * near * (4 / per_wave) ** 2


def _scatter(flows: np.ndarray) -> np.ndarray:
    """Twice the standard error of w over maps (maps, axes, points), relative; NaN of a
    single one, and where all are closed.
    """
    if len(flows) == 1:
        return np.full(flows.shape[-1], np.nan)
    each = flows.mean(1)
    mean = each.mean(0)
    spread = 2 * each.std(0, ddof=1) / len(flows) ** 0.5
    return np.where(mean > 0, spread / np.where(mean > 0, mean, 1.0), np.nan)
