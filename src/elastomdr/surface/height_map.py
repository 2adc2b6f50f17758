"""Measured heights as a periodic map for a solver on a grid.

Opposite edges of a measured map do not meet. It is split into a smooth part, which has
the steps from edge to edge and no others, and a periodic one, which is kept:

    (2 cos(2 pi i/n_x) + 2 cos(2 pi j/n_y) - 4) s_ij = v_ij,    s_00 = 0,

v the steps between opposite edges, on the edges (Moisan, J. Math. Imaging Vis. 39
(2011) 161). Nothing is cut away or blended: what is inside keeps its shape, and close
to an edge only long waves change.

A map without noise is taken point by point: to cut its shortest waves would put ripples
on summits that are worn flat. Where noise or the user cut a map, waves beyond are left
out, and the grid has four cells or more for the shortest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import xp
from ..numerics.interpolation import hermite, parabola_slopes

if TYPE_CHECKING:
    from ..arrays import Array

PER_WAVE = 4  # cells of a grid to the shortest wave that is left where waves are cut
_MULTIPLE = 4  # of which the cells along a side are one
# (-ln A)^(1/2) of the shares A at which slopes of tops are kept
_PLACES = np.linspace(0.0, 3.0, 21)
# points of a top at least, and its share over the square of the skewness' standard
# error, two of the longest waves: there chance moves the slope by some 10 %; least rms
# slope of a top over that of all
_FEWEST, _LEAST_SHARE, _FLATTEST = 16, 0.3, 0.02
_NEARLY_ALL = 0.9  # share from which a part's lowest point is an outlier


class PeriodicMap(NamedTuple):
    """Heights that repeat in both directions."""

    height: np.ndarray  # (n_x, n_y) [m]
    sides: tuple[float, float]  # [m]
    changed: float  # rms of what was subtracted, over that of the heights


class HeightMap:
    """The heights of one map, without holes and trend; equal to itself alone, so that
    JAX need not look into it.
    """

    def __init__(self, height: np.ndarray, steps: tuple[float, ...], cut: float | None):
        # the solver halves its grid twice
        whole = tuple(slice(0, n - n % _MULTIPLE) for n in height.shape)
        self.height, self.steps = height[whole], steps
        self.cut = cut  # wave number beyond which waves are left out [rad/m], or None

    @property
    def sides(self) -> tuple[float, float]:
        """Lengths of the map [m]."""
        x, y = (n * step for n, step in zip(self.height.shape, self.steps, strict=True))
        return x, y

    def raised(self, factor: float) -> HeightMap:
        """The same map with all heights times `factor`."""
        return HeightMap(self.height * factor, self.steps, self.cut)

    def ended(self, q_high: float) -> HeightMap:
        """The same map without its waves beyond `q_high` [rad/m]."""
        cut = q_high if self.cut is None else min(self.cut, q_high)
        return HeightMap(self.height, self.steps, cut)

    def least_cells(self) -> tuple[int, int]:
        """Cells along each side that hold the map: its own points, or fewer where its
        shortest waves are cut.
        """
        x, y = self.height.shape
        if self.cut is None:
            return x, y
        per_cell = 2 * np.pi * _MULTIPLE / PER_WAVE
        x, y = (
            min(n, _MULTIPLE * int(np.ceil(self.cut * side / per_cell - 1e-6)))
            for n, side in zip((x, y), self.sides, strict=True)
        )
        return x, y

    def periodic(self, cells: tuple[int, int]) -> PeriodicMap:
        """The map on a grid of `cells`."""
        n_x, n_y = self.height.shape
        waves = np.fft.fft2(self.height) - _smooth(self.height)
        whole = np.fft.ifft2(waves).real
        changed = float(np.std(whole - self.height) / np.std(self.height))
        if self.cut is None and cells == self.height.shape:
            return PeriodicMap(whole, self.sides, changed)
        if self.cut is not None:
            k_x, k_y = (
                2 * np.pi * np.fft.fftfreq(n, step)
                for n, step in zip((n_x, n_y), self.steps, strict=True)
            )
            q = np.hypot(k_x[:, None], k_y)
            waves = np.where(q <= self.cut * (1 + 1e-9), waves, 0.0)
        return PeriodicMap(_on_grid(waves, cells), self.sides, changed)


def _smooth(height: np.ndarray) -> np.ndarray:
    """The waves of the smooth part s."""
    steps = np.zeros(height.shape)
    across_x, across_y = height[-1] - height[0], height[:, -1] - height[:, 0]
    steps[0] += across_x
    steps[-1] -= across_x
    steps[:, 0] += across_y
    steps[:, -1] -= across_y
    c_x, c_y = (2 * np.cos(2 * np.pi * np.arange(n) / n) for n in height.shape)
    laplace = c_x[:, None] + c_y - 4
    laplace[0, 0] = 1.0
    waves = np.fft.fft2(steps) / laplace
    waves[0, 0] = 0.0
    return waves


def _on_grid(waves: np.ndarray, cells: tuple[int, int]) -> np.ndarray:
    """Heights on a grid of other cells that have the same waves."""
    whole = np.zeros(cells, dtype=complex)
    places = []
    for n, m in zip(waves.shape, cells, strict=True):
        number = np.fft.fftfreq(n, 1 / n).astype(int)
        held = 2 * np.abs(number) < min(n, m)
        places.append((np.flatnonzero(held), number[held] % m))
    (from_x, to_x), (from_y, to_y) = places
    whole[np.ix_(to_x, to_y)] = waves[np.ix_(from_x, from_y)]
    return np.fft.ifft2(whole).real * (whole.size / waves.size)


def top_slopes(
    height: np.ndarray, long: np.ndarray, steps: tuple[float, ...], error: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The logarithm of the rms slope of the highest part of a map or profile over that
    of all of it, at the shares `_PLACES`; that of the least share that holds enough of
    the surface below it. `error` is the standard error of the skewness.

    And by how much it exceeds that of the part's mean height above its lowest point,
    over that of Gaussian heights: 0 but where summits are plateaus, whose edges have the
    slopes. And how far the slopes of its `long` waves, and of the others, are from that
    logarithm: 0 where the tops have the waves of all of it, steeper or flatter.
    """
    from scipy.special import ndtri

    slopes = [
        np.reshape(np.gradient(waves, *steps), (height.ndim, -1))
        for waves in (height, long, height - long)
    ]
    order = np.argsort(-height, axis=None, kind="stable")
    squares, down = np.square(slopes).sum(1)[:, order], height.ravel()[order]
    shares = np.maximum(np.exp(-(_PLACES**2)), min(_LEAST_SHARE * error**2, 1.0))
    count = np.maximum(shares * down.size, _FEWEST).astype(int)
    means = np.cumsum([*squares, down], axis=1)[:, count - 1] / count
    ratios = (means[:-1].T / squares.mean(axis=1)).T
    log, *by_part = 0.5 * np.log(np.maximum(ratios, _FLATTEST**2))
    # a part that the tops lack does no more by lacking even more
    unlike = np.sqrt(np.mean(np.clip(by_part - log, -1.0, 1.0) ** 2, axis=0))
    part = count / down.size
    level = ndtri(1 - np.minimum(part, _NEARLY_ALL))
    usual = np.exp(-(level**2) / 2) / np.sqrt(2 * np.pi) / part - level
    above = (means[-1] - down[count - 1]) / (height.std() * usual)
    flat = np.maximum(log - np.log(np.maximum(above, _FLATTEST)), 0.0)
    return log, np.where(part < _NEARLY_ALL, flat, 0.0), unlike


def top_slope(tops: Array, area: Array) -> Any:
    """The same at a real contact `area` over the nominal one: cubics between
    `_PLACES`, level at full contact.
    """
    place = xp.sqrt(xp.maximum(-xp.log(xp.maximum(area, 1e-300)), 1e-24))
    slopes = xp.concatenate([xp.zeros(1), parabola_slopes(_PLACES, tops)[1:]])
    return hermite(_PLACES, tops, slopes, xp.minimum(place, _PLACES[-1]))


def tops_of(surface: object) -> Any:
    """`top_slopes` of a surface; None of one that does not know its heights."""
    return getattr(surface, "tops", None)
