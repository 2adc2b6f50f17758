"""Friction of a surface on random maps of it, in three dimensions: `em.HalfSpace`.

A map (`surface.spectrum.rough_map`) has the amplitudes of the spectrum and random phases. Its
friction is divided by that of full contact on the same waves, and multiplied by that of
the spectrum, which takes off what the waves of a finite cell miss.

A cell must hold many longest waves where contact is light: with one to a side, all of
the load is on one summit, and friction comes out three times too low at 2 % contact.
The share of the surface that touches where waves up to twice the longest are seen
(Persson's P), times the number of longest waves in the cell, is how many summits carry
the load. With one of them friction was 14 % low, with four 1 %: `error` has 0.3/N for N
of them; below one there is no answer.
"""

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from ..models import Persson, SurfaceFriction
from ..surface.spectrum import rough_map
from .half_space import solve, waves
from .local_modulus import Local
from .psd_integrals import direct, nodes, until

SAMPLES = 4  # cells per shortest wave
# cells to a side that are aimed at, and the most, where none are given
_USUAL, _LARGEST = 512, 2048
_PERIODS = 16  # longest waves to a side, at most, where none are given
# relative error of a cell, over the number of summits that carry its load
_OF_SUMMITS = 0.3
# Half of the change from a grid half as fine: a grid of 4 cells per shortest wave is
# within 0.8 % of ever finer ones.
_OF_HALF = 0.5


class Grid(NamedTuple):
    """A square cell."""

    cells: int  # to a side
    periods: int  # longest waves to a side
    side: float  # [m]


def grid_of(spectrum: Any, cells: int | None, periods: int | None) -> Grid:
    """The grid of a surface. Raises `InputError` where it cannot resolve the waves."""
    ratio = spectrum.q_high / spectrum.q_low
    if cells is None and periods is None:
        periods = min(max(1, int(_USUAL / (SAMPLES * ratio))), _PERIODS)
    if cells is None:
        cells = 32 * int(np.ceil(SAMPLES * ratio * periods / 32 - 1e-9))
        if cells > _LARGEST:
            raise InputError(
                "cells must be given for a surface whose cutoffs are a factor of "
                f"{ratio:.3g} apart: {cells} to a side "
                "would be needed. em.Multiscale() costs nothing; or lower the upper "
                "cutoff."
            )
    if periods is None:
        periods = int(cells / (SAMPLES * ratio))
    least = int(np.ceil(SAMPLES * ratio * max(periods, 1) - 1e-9))
    if cells % 4 or periods < 1 or cells < least:
        raise InputError(
            f"cells must be a multiple of 4, at least {least} for {SAMPLES} per "
            f"shortest wave, got {cells}."
        )
    return Grid(cells, periods, 2 * np.pi * periods / spectrum.q_low)


class _MapFriction(NamedTuple):
    """One map at each point; NaN where there is no answer."""

    mu: np.ndarray
    area: np.ndarray
    mu_error: np.ndarray  # from a grid half as fine
    area_error: np.ndarray


def friction(
    modulus: Callable[[Any], Any],
    spectrum: Any,
    velocity: np.ndarray,
    pressure: np.ndarray,
    grid: Grid,
    seeds: tuple[int, ...],
    rtol: float,
    progress: Callable[[int, int], None] | None,
) -> SurfaceFriction:
    """Points (velocity [m/s], pressure [Pa]), flat, each on every map."""
    full = full_contact(modulus, spectrum, velocity, pressure)
    enough = summits(modulus, spectrum, velocity, pressure, grid)
    done = itertools.count(1)

    def tick() -> None:
        number = next(done)
        if progress is not None:
            progress(number, velocity.size * len(seeds))

    maps = []
    for seed in seeds:
        heights, _ = rough_map(spectrum, seed, periods=grid.periods, points=grid.cells)
        maps.append(
            _on_map(
                modulus, heights, grid, velocity, pressure, full, enough, rtol, tick
            )
        )
    each = _MapFriction(*map(np.array, zip(*maps, strict=True)))
    mu, area = each.mu.mean(axis=0), each.area.mean(axis=0)
    of_mu = each.mu_error.mean(axis=0) + _OF_SUMMITS * np.abs(mu) / enough
    of_area = each.area_error.mean(axis=0) + _OF_SUMMITS * area / enough
    good = np.isfinite(each.mu).all(axis=0) & (enough >= 1)
    said = (
        f"{len(seeds)} of {grid.cells} by {grid.cells} cells, {grid.periods} longest "
        f"waves to a side; at least {enough.min():.2g} summits carry the load"
    )
    if len(seeds) == 1:
        said += "; how far maps scatter is not known, and so no error of mu"
    return SurfaceFriction(
        mu,
        area,
        of_mu + 2 * _standard_error(each.mu),
        good,
        of_area + 2 * _standard_error(each.area),
        said,
    )


def _standard_error(values: np.ndarray) -> np.ndarray:
    """Of the mean over maps (maps, points); NaN of a single one."""
    if len(values) == 1:
        return np.full(values.shape[1], np.nan)
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


def _on_map(
    modulus: Callable[[Any], Any],
    heights: np.ndarray,
    grid: Grid,
    velocity: np.ndarray,
    pressure: np.ndarray,
    full: np.ndarray,
    enough: np.ndarray,
    rtol: float,
    tick: Callable[[], None],
) -> _MapFriction:
    """All points on one map; neighbours begin with each other's contact."""
    answer = _MapFriction(*(np.full(velocity.size, np.nan) for _ in range(4)))
    sides = (grid.side, grid.side)
    start, last = None, None
    for i in np.lexsort((velocity, pressure)):
        if last is not None and pressure[last] != pressure[i]:
            start = None
        tick()
        if not enough[i] >= 1:
            # no answer, whatever the solution; far below that there may be no contact
            # in 32 bits
            continue
        given = {"velocity": float(velocity[i]), "pressure": float(pressure[i])}
        fine = solve(modulus, heights, sides, **given, start=start, double=rtol < 1e-4)
        coarse = solve(modulus, heights[::2, ::2], sides, **given, double=False)
        start, last = (fine.pressure if fine.settled else None), i
        if not fine.settled:
            continue
        on_map = full_contact_of_map(modulus, heights, sides, **given)
        answer.mu[i] = fine.stress / pressure[i] * full[i] / on_map
        answer.area[i] = fine.area
        if coarse.settled:
            change = abs(fine.stress - coarse.stress) / pressure[i]
            answer.mu_error[i] = _OF_HALF * change
            answer.area_error[i] = _OF_HALF * abs(fine.area - coarse.area)
    return answer


def summits(
    modulus: Any, spectrum: Any, velocity: np.ndarray, pressure: np.ndarray, grid: Grid
) -> np.ndarray:
    """How many summits of the longest waves carry the load, by Persson's theory."""
    at = nodes(spectrum, 16)
    model = Persson()
    found = model.waves(modulus, at, velocity, pressure, None, Local())
    shares = model.contact(until(found.rate, at.weight), found.stiffer)
    shares = shares.reshape(velocity.size, -1)
    longest = spectrum.q[
        int(np.argmax(np.diff(np.log(spectrum.c)) / np.diff(np.log(spectrum.q)) < -1))
    ]
    # longest waves that still grow, or the roll-off's
    number = (grid.side * longest / (2 * np.pi)) ** 2
    where = np.searchsorted(at.q.ravel(), min(2 * longest, 0.999 * spectrum.q_high))
    return number * shares[:, where]


def full_contact(
    modulus: Any, spectrum: Any, velocity: np.ndarray, pressure: np.ndarray
) -> np.ndarray:
    """Friction in full contact of all waves of a spectrum."""
    at = nodes(spectrum, 32)
    drag = direct(modulus, velocity[:, None, None] * at.q).drag
    return (at.weight * at.power * drag).sum((-2, -1)) / (2 * pressure)


def full_contact_of_map(
    modulus: Any, heights: np.ndarray, sides: Any, velocity: float, pressure: float
) -> float:
    """The same of the waves of one map."""
    on = waves(modulus, velocity, heights.shape, sides)
    spread = np.abs(np.fft.rfft2(heights) / heights.size) ** 2
    return float((on.loss * spread * np.abs(on.inverse) ** 2).sum()) / pressure


def work(
    surface: Any, cells: int | None, periods: int | None, seeds: int
) -> tuple[str, str]:
    """What is computed on how many maps of which grid and what is left out, in
    words.
    """
    grid = grid_of(surface, cells, periods)
    return (
        f"{seeds} maps of {grid.cells} by {grid.cells} cells, {grid.periods} longest "
        "waves to a side",
        "cells out of contact; contact from a grid half as fine, then from the "
        "neighbouring velocity",
    )
