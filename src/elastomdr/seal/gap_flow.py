"""Flow of a thin film through the gaps of a periodic map, by Reynolds' equation.

With the gap g and a mean pressure gradient of one along an axis,

    div(g^3 grad p) = 0,    w = mean flux of g^3 grad p [m^3],    s = w/(12 eta),

s [m^3/(Pa s)] the flow per width and pressure gradient of a fluid of viscosity eta.
Finite volumes: the pressure belongs to the cells, and between two of them the flux goes
by the harmonic mean of their g^3, which is exact for a gap that changes along the flow
only, and keeps a closed cell closed. Cells with g = 0 are left out, and so are pools
from which no channel leads through the map: what a channel is, is said by its winding,
how often a closed way through it goes around the map before it is back.
"""

from typing import Any, NamedTuple

import numpy as np

from ..arrays import one_thread


class Flow(NamedTuple):
    """Flow along either axis of a map."""

    conductance: tuple[float, float]  # w [m^3]
    percolates: tuple[bool, bool]  # whether a channel leads through the map


@one_thread()
def flow(gap: Any) -> Flow:
    """Flow through a periodic map of gaps [m], of square cells; closed where they are
    zero.
    """
    gap = np.asarray(gap, dtype=float)
    label, windings = channels(gap > 0)
    through = tuple(any(w[axis] for w in windings.values()) for axis in (0, 1))
    if not any(through):
        return Flow((0.0, 0.0), (False, False))
    largest = float(gap.max())
    inside = np.isin(label, list(windings))
    along = _conductances(np.where(inside, gap / largest, 0.0) ** 3, label, inside)
    found = [largest**3 * w if open_ else 0.0 for w, open_ in zip(along, through)]
    return Flow((found[0], found[1]), (through[0], through[1]))


def channels(is_open: Any) -> tuple[np.ndarray, dict[int, tuple[int, int]]]:
    """Labels of the pools of open cells, 0 where closed, and of those that lead through
    the map how often, at most, a way goes around it along each axis.

    Two cells belong to one pool that share an edge, across the ends of the map too.
    """
    from scipy.ndimage import label as labelled

    label, _ = labelled(is_open)
    # Across an end the place of one piece in the plane of all copies of the map is
    # that of its neighbour, one map further. A second way to another place winds.
    links: dict[int, set[tuple[int, int, int]]] = {}
    for axis in (0, 1):
        last, first = label.take(-1, axis), label.take(0, axis)
        for a, b in {*zip(last.tolist(), first.tolist(), strict=True)}:
            if a and b:
                step = (1 - axis, axis)
                links.setdefault(a, set()).add((b, *step))
                links.setdefault(b, set()).add((a, -step[0], -step[1]))
    windings: dict[int, tuple[int, int]] = {}
    place: dict[int, tuple[int, int]] = {}
    joined = np.arange(label.max() + 1)
    for root in links:
        if root in place:
            continue
        place[root] = 0, 0
        around = [0, 0]
        left = [root]
        while left:
            a = left.pop()
            joined[a] = root
            for b, x, y in links[a]:
                there = place[a][0] + x, place[a][1] + y
                if b not in place:
                    place[b] = there
                    left.append(b)
                for axis in (0, 1):
                    off = abs(there[axis] - place[b][axis])
                    around[axis] = max(around[axis], off)
        if any(around):
            windings[root] = around[0], around[1]
    return joined[label], windings


def _conductances(cube: Any, label: Any, inside: Any) -> list[float]:
    """Mean flux along either axis under a pressure that falls by one per cell, of the
    cells `inside`; `cube` is g^3.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    number = np.full(cube.shape, -1)
    number[inside] = np.arange(int(inside.sum()))
    faces, rows, columns, values = [], [], [], []
    diagonal = np.zeros(int(inside.sum()))
    driven = []
    for axis in (0, 1):
        beyond = np.roll(cube, -1, axis)
        face = 2 * cube * beyond / np.maximum(cube + beyond, 1e-300)
        both = face > 0
        here, there = number[both], np.roll(number, -1, axis)[both]
        face = face[both]
        faces.append((face, here, there))
        rows += [here, there]
        columns += [there, here]
        values += [-face, -face]
        diagonal += np.bincount(here, face, diagonal.size)
        diagonal += np.bincount(there, face, diagonal.size)
        # what flows into each cell by the mean gradient alone
        into = np.bincount(there, face, diagonal.size)
        driven.append(into - np.bincount(here, face, diagonal.size))
    # The pressure of one cell of each pool is held: only differences count.
    held = np.unique(label[inside], return_index=True)[1]
    free = np.ones(diagonal.size, bool)
    free[held] = False
    at = np.arange(diagonal.size)
    matrix = coo_array(
        (
            np.concatenate([*values, diagonal]),
            (np.concatenate([*rows, at]), np.concatenate([*columns, at])),
        )
    ).tocsc()[free][:, free]
    solved = splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    found = []
    for (face, here, there), into in zip(faces, driven, strict=True):
        rise = np.zeros(diagonal.size)
        rise[free] = solved.solve(into[free])
        found.append(float((face * (1 + rise[here] - rise[there])).sum()) / cube.size)
    return found
