"""Flow of a thin film through the gaps of a periodic map, by Reynolds' equation.

With the gap g and a mean pressure gradient of one along an axis,

    div(g^3 grad p) = 0,    w = mean flux of g^3 grad p [m^3],    s = w/(12 viscosity),

s [m^3/(Pa s)] the flow per width and pressure gradient. Finite volumes: the pressure
belongs to the cells, and between two of them the flux goes by the harmonic mean of
their g^3, which is exact for a gap that changes along the flow only, and keeps a closed
cell closed. Pools from which no channel leads through the map are left out: a channel
winds, which is to say that a way through it comes back to where it began in another
copy of the map.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ..arrays import one_thread

_LEAST = -200.0  # log of w over the largest flow: below it a medium is closed


class Flow(NamedTuple):
    """Flow along either axis of a map."""

    conductance: tuple[float, float]  # w [m^3]
    percolates: tuple[bool, bool]  # whether a channel leads through the map
    # dw/dl at l = 0 [m^2], where each gap conducts g^3 + 6 l g^2: a gas that slips
    slip: tuple[float, float]


@one_thread()
def flow(gap: Any) -> Flow:
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
    return Flow((along[0], along[1]), (through[0], through[1]), (slip[0], slip[1]))


def effective_medium(shares: Any, flows: Any, n: float) -> float:
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


def channels(is_open: Any) -> tuple[np.ndarray, dict[int, tuple[int, int]]]:
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


def _faces(cube: Any, number: Any) -> Iterator[_Faces]:
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


def _fluxes(cube: Any, pools: Any, inside: Any) -> list[tuple[float, float]]:
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
