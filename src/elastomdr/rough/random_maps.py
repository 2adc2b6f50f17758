"""Friction of a surface on random maps of it, in three dimensions: `em.HalfSpace`.

A map (`surface.spectrum.rough_map`) has the amplitudes of the spectrum and random phases. Its
friction is divided by that of full contact on the same waves, and multiplied by that of
the spectrum, which takes off what the waves of a finite cell miss.

A cell must hold many longest waves where contact is light: with one to a side, all of
the load is on one summit, and friction comes out three times too low at 2 % contact.
The share of the surface that touches where waves up to twice the longest are seen
(Persson's P), times the number of longest waves in the cell, is how many summits carry
the load. With one of them friction was 14 % low, with four 1 %: `error` has
0.3 sqrt(1 - A)/N for N of them and the real contact A; below one there is no answer.
In full contact, which is linear, every map has the friction of its spectrum.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import InputError
from ..surface.lay import lay_of
from ..surface.spectrum import rough_map
from .against_lay import Directed
from .half_space import solve, waves
from .local_modulus import Local
from .multiscale import averages_of, contact, waves_of_persson
from .psd_integrals import Modulus, integral_to, nodes
from .road_model import SurfaceFriction, WaveProblem

if TYPE_CHECKING:
    from ..surface.spectrum import AbstractSpectrum

SAMPLES = 4  # cells per shortest wave
# cells to a side that are aimed at, and the most, where none are given
_USUAL, LARGEST = 512, 2048
_PERIODS = 16  # longest waves to a side, at most, where none are given
# relative error of a cell, over the number of summits that carry its load
OF_SUMMITS = 0.3
# Half of the change from a grid half as fine: a grid of 4 cells per shortest wave is
# within 0.8 % of ever finer ones.
_OF_HALF = 0.5


class MapGrid(NamedTuple):
    """A square cell."""

    cells: int  # to a side
    periods: int  # longest waves to a side
    side: float  # [m]


def grid_of(
    spectrum: AbstractSpectrum, cells: int | None, periods: int | None
) -> MapGrid:
    """The grid of a surface. Raises `InputError` where it cannot resolve the waves."""
    ratio = float(spectrum.q_high / spectrum.q_low)
    if cells is None and periods is None:
        periods = min(max(1, int(_USUAL / (SAMPLES * ratio))), _PERIODS)
    if cells is None:
        cells = 32 * int(np.ceil(SAMPLES * ratio * (periods or 0) / 32 - 1e-9))
        if cells > LARGEST:
            raise InputError(
                argument="cells",
                accepted="given for a surface whose cutoffs are a factor of "
                f"{ratio:.3g} apart",
                hint=f"{cells} to a side would be needed; em.Multiscale() needs no "
                "map, or lower the upper cutoff",
            )
    if periods is None:
        periods = int(cells / (SAMPLES * ratio))
    least = int(np.ceil(SAMPLES * ratio * max(periods, 1) - 1e-9))
    if cells % 4 or periods < 1 or cells < least:
        raise InputError(
            argument="cells",
            got=cells,
            accepted=f"a multiple of 4, at least {least} for {SAMPLES} per shortest "
            "wave",
        )
    return MapGrid(cells, periods, float(2 * np.pi * periods / spectrum.q_low))


class MapFriction(NamedTuple):
    """One map at each point; NaN where there is no answer."""

    mu: np.ndarray
    area: np.ndarray
    mu_error: np.ndarray  # from a grid half as fine
    area_error: np.ndarray
    unsolved: np.ndarray  # where the solver did not converge


def friction(
    modulus: Callable[[Any], Any],
    spectrum: AbstractSpectrum,
    velocity: np.ndarray,
    pressure: np.ndarray,
    grid: MapGrid,
    seeds: tuple[int, ...],
    rtol: float,
    tick: Callable[[], None],
    direction: float | None = None,
) -> SurfaceFriction:
    """Points (velocity [m/s], pressure [Pa]), flat, each on every map; at an angle to
    the lay of a surface that has one.
    """
    directed = None
    if direction is not None:
        directed = Directed(lay_of(spectrum), np.full(velocity.shape, direction))
    of_spectrum = full_contact(modulus, spectrum, velocity, pressure, directed)
    enough = summits(modulus, spectrum, velocity, pressure, grid, directed)

    def over_full(heights: np.ndarray, i: int) -> float:
        """Full contact of the spectrum over that of the waves of a map."""
        of_map = full_contact_of_map(modulus, heights, sides, velocity[i], pressure[i])
        return of_spectrum[i] / of_map

    maps, sides = [], (grid.side, grid.side)
    for seed in seeds:
        heights, _ = rough_map(
            spectrum,
            seed,
            periods=grid.periods,
            points=grid.cells,
            direction=direction or 0.0,
        )
        maps.append(
            on_map(
                modulus,
                heights,
                sides,
                velocity,
                pressure,
                enough,
                rtol,
                tick,
                over_full=over_full,
            )
        )
    each = MapFriction(*map(np.array, zip(*maps, strict=True)))
    mu, area = each.mu.mean(axis=0), each.area.mean(axis=0)
    of_sample = OF_SUMMITS / enough * np.sqrt(1 - area)
    of_mu = each.mu_error.mean(axis=0) + (of_sample + rtol) * np.abs(mu)
    of_area = each.area_error.mean(axis=0) + (of_sample + rtol) * area
    full = (each.area == 1).all(axis=0)
    good = np.isfinite(each.mu).all(axis=0) & (enough >= 1)
    remark = (
        f"{len(seeds)} of {grid.cells} by {grid.cells} cells, {grid.periods} longest "
        f"waves to a side; at least {enough.min():.2g} summits carry the load"
    )
    if (enough < 1).any():
        remark += ", fewer than 1 at points without an answer: more cells hold more"
    remark += unsolved_words(each.unsolved)
    if len(seeds) == 1 and not full.all():
        remark += "; how far maps scatter is not known, and so no error of mu"
    return SurfaceFriction(
        mu,
        area,
        of_mu + np.where(full, 0.0, 2 * _standard_error(each.mu)),
        good,
        of_area + np.where(full, 0.0, 2 * _standard_error(each.area)),
        remark,
    )


def unsolved_words(unsolved: np.ndarray) -> str:
    """What there is to say of solutions (maps, points) that were not found."""
    if not unsolved.any():
        return ""
    return (
        f"; the solver did not converge in {int(unsolved.sum())} of {unsolved.size} "
        "solutions, which have no answer: a lower upper cutoff, on fewer cells, or "
        "rubber whose modulus changes less between the waves needs fewer iterations"
    )


def _standard_error(values: np.ndarray) -> np.ndarray:
    """Of the mean over maps (maps, points); NaN of a single one."""
    if len(values) == 1:
        return np.full(values.shape[1], np.nan)
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


def on_map(
    modulus: Callable[[Any], Any],
    heights: np.ndarray,
    sides: tuple[float, float],
    velocity: np.ndarray,
    pressure: np.ndarray,
    enough: np.ndarray,
    rtol: float,
    tick: Callable[[], None],
    *,
    over_full: Callable[[np.ndarray, int], float] | None = None,
    angle: float = 0.0,
    least: float = 1.0,
) -> MapFriction:
    """All points on one map that moves at `angle` to x; neighbours begin with each
    other's contact. Fewer summits than `least` give no answer.

    `over_full`, of the heights and the point, is what mu is multiplied by.
    """
    answer = MapFriction(
        *(np.full(velocity.size, np.nan) for _ in range(4)),
        unsolved=np.zeros(velocity.size, dtype=bool),
    )
    start, last = None, None
    for i in np.lexsort((velocity, pressure)):
        if last is not None and pressure[last] != pressure[i]:
            start = None
        tick()
        if not enough[i] >= least:
            # no answer, whatever the solution; far below that there may be no contact
            # in 32 bits
            continue
        on = {"velocity": velocity[i], "pressure": pressure[i], "angle": angle}
        fine = solve(modulus, heights, sides, **on, start=start, double=rtol < 1e-4)
        start, last = (fine.pressure if fine.settled else None), i
        if not fine.settled:
            answer.unsolved[i] = True
            continue
        coarse = solve(modulus, heights[::2, ::2], sides, **on, double=False)
        mu, coarse_mu = fine.stress / pressure[i], coarse.stress / pressure[i]
        if over_full is not None:
            mu *= over_full(heights, i)
            coarse_mu *= over_full(heights[::2, ::2], i)
        answer.mu[i], answer.area[i] = mu, fine.area
        if coarse.settled:
            answer.mu_error[i] = _OF_HALF * abs(mu - coarse_mu)
            answer.area_error[i] = _OF_HALF * abs(fine.area - coarse.area)
    return answer


_ENERGY = 0.5, True  # gamma of Persson's S, and that it is in the contact too


def summits(
    modulus: Modulus,
    spectrum: AbstractSpectrum,
    velocity: np.ndarray,
    pressure: np.ndarray,
    grid: MapGrid,
    directed: Directed | None = None,
) -> np.ndarray:
    """How many summits of the longest waves carry the load, by Persson's theory."""
    wave_nodes = nodes(spectrum, 16)
    problem = WaveProblem(
        modulus, wave_nodes, velocity, pressure, Local(directed=directed)
    )
    by_wave = waves_of_persson(problem, _ENERGY)
    variance = integral_to(by_wave.rate, wave_nodes.weight)
    shares = contact(variance, *_ENERGY, by_wave.stiffer)
    shares = shares.reshape(velocity.size, -1)
    longest = spectrum.q[
        int(np.argmax(np.diff(np.log(spectrum.c)) / np.diff(np.log(spectrum.q)) < -1))
    ]
    # longest waves that still grow, or the roll-off's
    number = (grid.side * longest / (2 * np.pi)) ** 2
    if directed is not None:  # of ridges, which are longer than wide
        assert directed.lay is not None
        longer = float(np.exp(abs(directed.lay.log_peklenik[0])))
        # those that run through the whole map count once
        number = max(number / longer, number**0.5)
    where = np.searchsorted(
        wave_nodes.q.ravel(), min(2 * longest, 0.999 * spectrum.q_high)
    )
    where = min(int(where), shares.shape[1] - 1)
    return number * shares[:, where]


def full_contact(
    modulus: Modulus,
    spectrum: AbstractSpectrum,
    velocity: np.ndarray,
    pressure: np.ndarray,
    directed: Directed | None = None,
) -> np.ndarray:
    """Friction in full contact of all waves of a spectrum."""
    wave_nodes = nodes(spectrum, 32)
    local = Local(directed=directed)
    drag = averages_of(modulus, velocity, wave_nodes.q, local).drag
    each = np.asarray(wave_nodes.weight * wave_nodes.power * drag)
    return each.sum((-2, -1)) / (2 * pressure)


def full_contact_of_map(
    modulus: Modulus,
    heights: np.ndarray,
    sides: tuple[float, float],
    velocity: float,
    pressure: float,
    angle: float = 0.0,
) -> float:
    """The same of the waves of one map."""
    on = waves(modulus, velocity, heights.shape, sides, angle)
    spread = np.abs(np.fft.rfft2(heights) / heights.size) ** 2
    return float((on.loss * spread * np.abs(on.inverse) ** 2).sum()) / pressure


def work(
    surface: AbstractSpectrum, cells: int | None, periods: int | None, seeds: int
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
