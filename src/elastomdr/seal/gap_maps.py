"""Gaps between rubber and random maps of a surface that is pressed into it, and the flow
through them: the leak of `em.HalfSpace`.

The rubber is at rest and elastic, of the modulus E* of the time that it has been
pressed. Its contact is that of `rough.half_space`, in three dimensions; the gap is the
displacement u = K p less the heights, in the cells that do not touch. Maps lie side by
side in a plane, and the flow through many of them is that of an effective medium of
theirs, along either axis,

    sum (w_i - w)/(w_i + w) = 0,

which is their mean where they differ little, and zero where half of them are closed.

The flow through one map is Reynolds'. With the gap g and a mean pressure gradient of one
along an axis,

    div(g^3 grad p) = 0,    w = mean flux of g^3 grad p [m^3],    s = w/(12 viscosity),

s [m^3/(Pa s)] the flow per width and pressure gradient. Finite volumes: the pressure
belongs to the cells, and between two of them the flux goes by the harmonic mean of
their g^3, which is exact for a gap that changes along the flow only, and keeps a closed
cell closed. Pools from which no channel leads through the map are left out: a channel
winds, which is to say that a way through it comes back to where it began in another
copy of the map.
"""

import bisect
import dataclasses
import functools
from collections.abc import Iterator
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ..arrays import Array, one_thread
from ..rough.half_space import area_of, solve, waves
from ..rough.random_maps import MapGrid, grid_of
from ..surface.lay import lay_of
from ..surface.spectrum import AbstractSpectrum, rough_map
from ..surface.topography import skewness_of
from .channels import Channels, GapFlow, RoughSeal, no_derivatives
from .leak_form import of_heights, of_skewness, off_by

_LEAST = -200.0  # log of w over the largest flow: below it a medium is closed


class FlowOnMap(NamedTuple):
    """Flow along either axis of a map."""

    conductance: tuple[float, float]  # w [m^3]
    percolates: tuple[bool, bool]  # whether a channel leads through the map
    # dw/dl at l = 0 [m^2], where each gap conducts g^3 + 6 l g^2: a gas that slips
    slip: tuple[float, float]


@one_thread()
def flow(gap: Array) -> FlowOnMap:
    """Flow through a periodic map of gaps [m] in square cells, closed where they are
    zero.
    """
    gap = np.asarray(gap, dtype=float)
    pools, windings = channels(gap > 0)
    through = [any(winding[axis] for winding in windings.values()) for axis in (0, 1)]
    along, slip = [0.0, 0.0], [0.0, 0.0]
    if any(through):
        widest = float(gap.max())
        inside = np.isin(pools, list(windings))
        cube = np.where(inside, gap / widest, 0.0) ** 3
        for axis, (flux, more) in enumerate(_fluxes(cube, pools, inside)):
            if through[axis]:
                along[axis], slip[axis] = widest**3 * flux, widest**2 * more
    return FlowOnMap((along[0], along[1]), (through[0], through[1]), (slip[0], slip[1]))


def effective_medium(shares: Array, flows: Array, n: float) -> float:
    """w of a medium of parts with `flows` w_i [m^3], of which `shares` f_i are there.

        sum f_i (w_i - w)/(w_i + (n - 1) w) = 0

    It is closed, w = 0, where no more than 1/n of it is open; NaN where a flow is; n = 2
    is Bruggeman's medium in a plane. Source: as of the effective medium in `seal/leak_theories.py`.
    """
    shares, flows = np.asarray(shares, dtype=float), np.asarray(flows, dtype=float)
    if np.isnan(flows).any():
        return float("nan")
    if not n * shares[flows > 0].sum() > shares.sum():
        return 0.0
    from scipy.optimize import brentq

    largest = flows.max()
    flows = flows / largest

    def surplus(log_w: float) -> float:
        w = np.exp(log_w)
        return float(shares @ ((flows - w) / (flows + (n - 1) * w)))

    root: Any = brentq(surplus, _LEAST, 0.0, xtol=1e-13)
    return float(largest * np.exp(root))


def channels(is_open: Array) -> tuple[np.ndarray, dict[int, tuple[int, int]]]:
    """The pools of open cells, numbered, 0 where closed; and of those that lead through
    the map how often a way goes around it along each axis.

    Two cells belong to one pool that share an edge, across the ends of the map too.
    """
    from scipy.ndimage import label

    labelled: Any = label(is_open)
    pieces, count = labelled
    links = _links(pieces)
    pool_of = np.arange(count + 1)
    windings: dict[int, tuple[int, int]] = {}
    # the copy of the map in which each piece is, as its pool goes on across the ends
    copy: dict[int, tuple[int, int]] = {}
    for root in links:
        if root in copy:
            continue
        copy[root] = 0, 0
        around = [0, 0]
        waiting = [root]
        while waiting:
            piece = waiting.pop()
            pool_of[piece] = root
            for other, *step in links[piece]:
                next_copy = copy[piece][0] + step[0], copy[piece][1] + step[1]
                if other not in copy:
                    copy[other] = next_copy
                    waiting.append(other)
                for axis in (0, 1):  # reached in two copies: it winds
                    apart = abs(next_copy[axis] - copy[other][axis])
                    around[axis] = max(around[axis], apart)
        if any(around):
            windings[root] = around[0], around[1]
    return pool_of[pieces], windings


def _links(pieces: np.ndarray) -> dict[int, set[tuple[int, int, int]]]:
    """Of each piece at an end of the map the pieces across it, and in which of the
    next copies of the map they are.
    """
    links: dict[int, set[tuple[int, int, int]]] = {}
    for axis in (0, 1):
        last, first = pieces.take(-1, axis).tolist(), pieces.take(0, axis).tolist()
        for a, b in set(zip(last, first, strict=True)):
            if a and b:
                links.setdefault(a, set()).add((b, 1 - axis, axis))
                links.setdefault(b, set()).add((a, axis - 1, -axis))
    return links


class _Faces(NamedTuple):
    """The open faces between cells that are neighbours along an axis."""

    cube: Any  # harmonic mean c of g^3
    slip: Any  # its change dc/dl, g^3 changing by 6 g^2
    here: Any  # number of the cell before it
    there: Any  # and behind it


def _faces(cube: Array, number: Array) -> Iterator[_Faces]:
    for axis in (0, 1):
        beyond = np.roll(cube, -1, axis)
        total = np.maximum(cube + beyond, 1e-300)
        mean = 2 * cube * beyond / total
        # dc/d(g^3) of one side is half the square of c over its g^3
        share_before, share_beyond = cube / total, beyond / total
        slip = 12 * (
            cube ** (2 / 3) * share_beyond**2 + beyond ** (2 / 3) * share_before**2
        )
        open_ = mean > 0
        following = np.roll(number, -1, axis)
        yield _Faces(mean[open_], slip[open_], number[open_], following[open_])


def _fluxes(cube: Array, pools: Array, inside: Array) -> list[tuple[float, float]]:
    """Mean flux along either axis under a pressure that falls by one per cell, and its
    change by slip; `cube` is g^3, not zero in the cells `inside` alone.

    The flux is the least of sum c (fall)^2 over the faces, so that its change is that of
    c alone.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    count = int(inside.sum())
    number = np.full(cube.shape, -1)
    number[inside] = np.arange(count)
    faces = list(_faces(cube, number))
    means, slips, here, following = (
        np.concatenate(field) for field in zip(*faces, strict=True)
    )
    rows = np.concatenate([here, following, here, following])
    columns = np.concatenate([following, here, here, following])
    values = np.concatenate([-means, -means, means, means])
    # Only differences of pressure count: that of one cell of each pool is held.
    free = np.ones(count, bool)
    free[np.unique(pools[inside], return_index=True)[1]] = False
    matrix = coo_array((values, (rows, columns)), shape=(count, count)).tocsc()
    solved = splu(
        matrix[free][:, free],
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    fluxes = []
    ends = np.cumsum([0, *(face.cube.size for face in faces)])
    for axis, face in enumerate(faces):
        # what flows into each cell, less what flows out, by the mean gradient alone
        gained = np.bincount(face.there, face.cube, count)
        gained -= np.bincount(face.here, face.cube, count)
        pressure = np.zeros(count)
        pressure[free] = solved.solve(gained[free])
        falls = 1 + pressure[face.here] - pressure[face.there]
        flux = float((face.cube * falls).sum()) / cube.size
        every = pressure[here] - pressure[following]  # on the faces of both axes
        every[ends[axis] : ends[axis + 1]] = falls
        fluxes.append((flux, float((slips * every**2).sum()) / cube.size))
    return fluxes


# Relative error of the flow by four cells per shortest wave, over -ln(1 - A/0.415):
# benchmarks/leak_grid.py. It falls as the square of the cell.
_OF_CELLS, _CLOSES, _SURE = 0.12, 0.415, 0.38
SHUT = 0.5  # real contact from which on no map of a rough surface lets anything through
_SMALL = 1e-4  # mean free path over w^(1/3) at which the slip of maps is added up


class PressedMap(NamedTuple):
    """A map under a pressure."""

    gap: Any  # of each cell [m], 0 where it touches
    area: float  # real contact area over nominal area
    pressure: Any  # over E* [-], of each cell
    settled: bool


def pressed(
    heights: Any, side: float, relative_pressure: float, start: np.ndarray | None = None
) -> PressedMap:
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
    return PressedMap(gap, area_of(touches), contact.pressure, contact.settled)


def _one(omega: Array) -> Any:
    """E* at every frequency: what counts is the pressure over it."""
    return np.ones(np.shape(omega), complex)


def narrowest(gap: Array) -> float:
    """The gap at the narrowest place of the widest channel [m], the mean of both axes;
    NaN where none leads through along either.
    """
    sorted_gaps = np.unique(gap[gap > 0])

    def closed(least: float, axis: int) -> bool:
        """Whether no channel of gaps from `least` on leads through along an axis."""
        wide = channels(gap >= least)[1].values()
        return not any(winding[axis] for winding in wide)

    critical = []
    for axis in (0, 1):
        is_closed = functools.partial(closed, axis=axis)
        number = bisect.bisect_left(sorted_gaps, True, key=is_closed)
        if number > 0:
            critical.append(sorted_gaps[number - 1])
    return float(np.mean(critical)) if critical else np.nan


@dataclasses.dataclass(frozen=True)
class MappedChannels(Channels):
    """Of `em.HalfSpace`, with its options."""

    cells: int | None
    periods: int | None
    seeds: tuple[int, ...]
    closes = SHUT
    nodes: ClassVar[int] = 5  # each is a contact in three dimensions
    turns: ClassVar[bool] = True
    softens: ClassVar[bool] = False

    def flow(self, rough: RoughSeal, relative_pressure: Array) -> GapFlow:
        """On a surface with a lay the maps lie in the `direction` of the flow, which is that
        along their first axis; without one both axes are taken as one medium.
        """
        surface, softening, direction = rough
        no_derivatives(rough, relative_pressure)
        grid = grid_of(surface, self.cells, self.periods)
        flat, shape = np.ravel(relative_pressure), relative_pressure.shape
        turned = direction is not None and lay_of(surface) is not None
        axes = 1 if turned else 2
        flows, slips = np.full((2, len(self.seeds), axes, flat.size), np.nan)
        gap, critical, area = (
            np.full((len(self.seeds), flat.size), np.nan) for _ in range(3)
        )
        for i, seed in enumerate(self.seeds):
            heights, side = rough_map(
                surface,
                seed,
                periods=grid.periods,
                points=grid.cells,
                direction=direction or 0.0,
            )
            start = None
            for j in np.argsort(flat):
                contact = pressed(heights, side, float(flat[j]), start)
                start = contact.pressure if contact.settled else None
                if contact.settled:
                    through = flow(contact.gap)
                    flows[i, :, j] = through.conductance[:axes]
                    slips[i, :, j] = through.slip[:axes]
                    gap[i, j], area[i, j] = contact.gap.mean(), contact.area
                    if j < shape[1]:  # of the first row
                        critical[i, j] = narrowest(contact.gap)
        good: Any = np.isfinite(flows).all((0, 1))
        w = _of_maps(flows)
        path = _SMALL * np.where(w > 0, w, 1.0) ** (1 / 3)
        slip = (_of_maps(flows + path * slips) - w) / path
        work = (
            f"{len(self.seeds)} maps of {grid.cells} by {grid.cells} cells, {grid.periods} "
            "longest waves to a side"
        )
        error = _scatter(flows) + _of_cells(area.mean(0), surface, grid)
        error = np.where((w == 0) & (area.mean(0) > SHUT), 0.0, error)
        of_surface = of_heights(surface, area.mean(0))
        if turned:
            of_surface = of_skewness(skewness_of(surface), area.mean(0))
        if softening is not None:  # cells have one modulus
            of_surface = np.full_like(w, np.nan)
        return GapFlow(
            flow=w.reshape(shape),
            slip=slip.reshape(shape),
            gap=gap.mean(0).reshape(shape),
            critical_gap=_mean_of_open(critical)[: shape[1]],
            area=area.mean(0).reshape(shape),
            error=error.reshape(shape),
            # maps are Gaussian, and a lay makes both axes differ
            model_error=off_by(of_surface).reshape(shape) if of_surface.any() else None,
            good=good.reshape(shape),
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


def _of_cells(area: np.ndarray, surface: AbstractSpectrum, grid: MapGrid) -> np.ndarray:
    """How much less a map leaks than on ever finer cells, relative."""
    per_wave = grid.cells * surface.q_low / (grid.periods * surface.q_high)
    near = -np.log(1 - np.minimum(area, _SURE) / _CLOSES)
    return _OF_CELLS * near * (4 / per_wave) ** 2


def _scatter(flows: np.ndarray) -> np.ndarray:
    """Twice the standard error of w over maps (maps, axes, points), relative; NaN of a
    single one, zero where all are closed.
    """
    if len(flows) == 1:
        return np.full(flows.shape[-1], np.nan)
    each = flows.mean(1)
    mean = each.mean(0)
    spread = 2 * each.std(0, ddof=1) / len(flows) ** 0.5
    return np.where(mean > 0, spread / np.where(mean > 0, mean, 1.0), 0.0)
