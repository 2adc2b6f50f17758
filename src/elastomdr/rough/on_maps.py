"""`em.HalfSpace` on surfaces: over the map that was measured, or over random maps of a
spectrum, in a direction or in several.

A measured map is the surface itself, with its flattened summits and its grooves; what
is missing is more of it, so that `error` has the number of its summits that carry the
load, as of a random map (`rough.random_maps`). Its edges are made to meet by
`surface.height_map`. Without a direction the result is the mean over four on a surface
with a lay, over x and y on a map without one.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..surface.height_map import HeightMap, PeriodicMap
from ..surface.lay import lay_of
from ..surface.topography import MeasuredSurface
from .against_lay import Directed
from .random_maps import (
    LARGEST,
    OF_SUMMITS,
    MapGrid,
    grid_of,
    on_map,
    summits,
    unsolved_words,
)
from .random_maps import friction as on_random_maps
from .road_model import MapsOf, RoadProblem, SurfaceFriction

if TYPE_CHECKING:
    from ..surface.spectrum import AbstractSpectrum

_SAMPLED = {True: (0.0, 0.25, 0.5, 0.75), False: (0.0, 0.5)}  # with a lay, without [pi]

_MARGIN = 4  # cells from the edges of a map that count as near them
# of a measured map that carry the load, below which there is no answer: there the error
# of mu by their number is all of mu
LEAST_SUMMITS = OF_SUMMITS

# (which points, direction or None) -> friction
Run = Callable[[Any, float | None], SurfaceFriction]


def friction(maps_of: MapsOf, problem: RoadProblem) -> SurfaceFriction:
    """Points on the measured map, or on random ones."""
    modulus, surface = problem.foundation.complex_modulus, problem.surface
    velocity, pressure = np.asarray(problem.velocity), np.asarray(problem.pressure)
    directed, rtol = problem.local.directed, problem.rtol
    on_measured, has_lay = maps_of.measured, lay_of(surface) is not None
    sampled: list[np.ndarray | None] = [None]
    if directed is not None:
        sampled = [np.asarray(directed.direction)]
    elif on_measured or has_lay:
        sampled = [np.full(velocity.shape, np.pi * turn) for turn in _SAMPLED[has_lay]]
    maps = 1 if on_measured else len(maps_of.seeds)
    counter, total = itertools.count(1), len(sampled) * maps * velocity.size

    def tick() -> None:
        number = next(counter)
        if problem.progress is not None:
            problem.progress(number, total)

    if on_measured:
        grid = cells_of(surface, maps_of.cells)
        whole = _map_of(surface).periodic(grid)

        def run(batch: np.ndarray, direction: float | None) -> SurfaceFriction:
            given = velocity[batch], pressure[batch]
            return _on_measured(
                modulus, surface, whole, *given, direction or 0.0, rtol, tick
            )

    else:
        square = grid_of(surface, maps_of.cells, maps_of.periods)

        def run(batch: np.ndarray, direction: float | None) -> SurfaceFriction:
            given = velocity[batch], pressure[batch]
            return on_random_maps(
                modulus, surface, *given, square, maps_of.seeds, rtol, tick, direction
            )

    return _mean([_each(run, direction) for direction in sampled], has_lay)


def _each(run: Run, direction: np.ndarray | None) -> SurfaceFriction:
    """Points of one direction after the other."""
    if direction is None:
        return run(slice(None), None)
    whole = [np.full(direction.shape, np.nan) for _ in range(4)]
    good, remark = np.zeros(direction.shape, dtype=bool), ""
    for angle in np.unique(direction):
        same_direction = direction == angle
        solved = run(same_direction, float(angle))
        values = solved.mu, solved.area, solved.error, solved.area_error
        for array, entries in zip(whole, values, strict=True):
            array[same_direction] = entries
        good[same_direction], remark = solved.good, solved.said
    mu, area, error, area_error = whole
    return SurfaceFriction(mu, area, error, good, area_error, remark)


def _mean(each: list[SurfaceFriction], has_lay: bool) -> SurfaceFriction:
    """The mean over directions; where they are alike, half of their distance is an
    error of the sample.
    """
    if len(each) == 1:
        return each[0]
    mu, area, error, area_error = (
        np.mean([getattr(one, name) for one in each], axis=0)
        for name in ("mu", "area", "error", "area_error")
    )
    if not has_lay:
        error = error + np.ptp([one.mu for one in each], axis=0) / 2
        area_error = area_error + np.ptp([one.area for one in each], axis=0) / 2
    good = np.all([one.good for one in each], axis=0)
    remark = f"{each[0].said}; mean over {len(each)} directions of sliding"
    return SurfaceFriction(mu, area, error, good, area_error, remark)


def _map_of(surface: AbstractSpectrum) -> HeightMap:
    assert isinstance(surface, MeasuredSurface)
    assert surface.map is not None
    return surface.map


def cells_of(surface: AbstractSpectrum, cells: int | None) -> tuple[int, int]:
    """Cells along both sides of the measured map, `cells` along the longer one if
    given. Raises `InputError` where they do not hold it, or are too many.
    """
    least = _map_of(surface).least_cells()
    longer = max(least)
    if cells is None:
        if longer > LARGEST:
            raise InputError(
                argument="cells",
                accepted=f"given for a map that needs {longer} along a side, more than "
                f"{LARGEST}",
                hint="or read it with a larger `shortest`",
            )
        return least
    if cells % 4 or cells < longer:
        raise InputError(
            argument="cells",
            got=cells,
            accepted=f"a multiple of 4, at least {longer} along the longer side of the "
            "map",
            hint="a larger `shortest` in em.read_surface needs fewer",
        )
    x, y = (4 * int(np.ceil(n * cells / longer / 4)) for n in least)
    return x, y


def _on_measured(
    modulus: Callable[[Any], Any],
    surface: AbstractSpectrum,
    whole: PeriodicMap,
    velocity: np.ndarray,
    pressure: np.ndarray,
    direction: float,
    rtol: float,
    tick: Callable[[], None],
) -> SurfaceFriction:
    """Sliding over the measured map at an angle to its lay, or to x where it has
    none.
    """
    lay, side = lay_of(surface), float(np.sqrt(np.prod(whole.sides)))
    periods = max(1, round(side * float(surface.q_low) / (2 * np.pi)))
    directed = None
    if lay is not None:
        directed = Directed(lay, np.full(velocity.shape, direction))
    grid = MapGrid(whole.height.shape[0], periods, side)
    enough = summits(modulus, surface, velocity, pressure, grid, directed)
    angle = direction + (0.0 if lay is None else lay.angle)
    seams = _at_seams(whole, angle)
    solved = on_map(
        modulus,
        whole.height,
        whole.sides,
        velocity,
        pressure,
        enough,
        rtol,
        tick,
        angle=angle,
        least=LEAST_SUMMITS,
    )
    good = np.isfinite(solved.mu) & (enough >= LEAST_SUMMITS)
    cells, cut = " by ".join(map(str, whole.height.shape)), _map_of(surface).cut
    shortest = "" if cut is None else f" with waves down to {2 * np.pi / cut:.3g} m"
    remark = (
        f"the measured map on {cells} cells{shortest}, its edges made to meet by taking "
        f"off a smooth part of {whole.changed:.0%} of its rms height, with {seams:.0%} "
        f"more mean square slope along the motion; at least {enough.min():.2g} summits "
        "carry the load"
    )
    if (enough < LEAST_SUMMITS).any():
        remark += (
            f", fewer than {LEAST_SUMMITS:g} at points without an answer: a larger map, "
            "more pressure or softer rubber has more, and em.Multiscale() needs no map"
        )
    remark += unsolved_words(solved.unsolved)
    # two points may be all that a wave has: the error is the whole change of the grid
    return SurfaceFriction(
        solved.mu,
        solved.area,
        2 * solved.mu_error + (OF_SUMMITS / enough + seams) * np.abs(solved.mu),
        good,
        2 * solved.area_error + OF_SUMMITS * solved.area / enough,
        remark,
    )


def _at_seams(whole: PeriodicMap, angle: float) -> float:
    """Relative excess of the mean square slope along the motion over that of the cells
    some way from the edges: along a lay, where edges meet, slopes are of another kind.
    """
    slope = np.zeros(whole.height.shape)
    for axis, along in enumerate((np.cos(angle), np.sin(angle))):
        step = whole.sides[axis] / whole.height.shape[axis]
        rise = np.roll(whole.height, -1, axis) - whole.height
        slope += along * rise / step
    inside = slope[_MARGIN:-_MARGIN, _MARGIN:-_MARGIN]
    return max(float(np.mean(slope**2) / np.mean(inside**2)) - 1.0, 0.0)


def work(surface: AbstractSpectrum, cells: int | None) -> tuple[str, str]:
    """What is computed on the measured map and what is left out, in words."""
    along = " by ".join(map(str, cells_of(surface, cells)))
    return (
        f"the measured map on {along} cells",
        "cells out of contact; contact from a grid half as fine, then from the "
        "neighbouring velocity",
    )
