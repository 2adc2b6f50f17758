"""Indentation under a given load by a plain march: the judge of loads in the stress
test.

Elements at equal distances, u linear over a step h, e_k = exp(-h/tau_k), phi_k = (1 -
e_k) tau_k/h, S = E_inf + eta/h + sum E_k phi_k: without contact u+ = u_free = u -
(E_inf u + sum e_k f_k)/S, in contact q+ = S (d - g - u_free), and d so that the line, q
between two elements linear and cut where it is zero, carries the load. Steps shrink
geometrically towards both ends of each interval (where a load vanishes a dashpot alone
decides the depth, in a moment), in a fixed way, so that halving steps and elements
together divides the error by four where contact only grows, and by two or so where it
is lost and regained; the limit and twice its last change are what is returned. Nothing
is shared with elastomdr.
"""

import itertools
from typing import Any

import numpy as np
from slow_elements import Line
from slow_route import Law

# elements and steps in an interval
_LEVELS = ((320, 48), (640, 96), (1280, 192), (2560, 384))


def depths(
    law: Law,
    line: Line,
    time: np.ndarray,
    load: np.ndarray,
    reach: float,
    finer: bool = False,
) -> tuple[np.ndarray, float]:
    """Depth [m] at every instant, and its own error over the largest."""
    found = [
        _march(law, line, time, load, reach, *level)
        for level in (_LEVELS[1:] if finer else _LEVELS[:3])
    ]
    limits = [(4 * b - a) / 3 for a, b in itertools.pairwise(found)]
    largest = np.abs(limits[-1]).max()
    return limits[-1], float(2 * np.abs(limits[-1] - limits[-2]).max() / largest)


def _march(
    law: Law,
    line: Line,
    time: np.ndarray,
    load: np.ndarray,
    reach: float,
    count: int,
    steps: int,
) -> Any:
    x = reach * np.arange(count + 1) / count
    g, dx = line.profile(x), reach / count
    u, f, depth = np.zeros(count + 1), np.zeros((law.moduli.size, count + 1)), 0.0

    def found(free: np.ndarray, stiffness: float, load: float, depth: float) -> float:
        """d with weight S int max(d - free, 0) dx = load, `free` linear between
        elements: Newton from below.
        """
        if load <= 0:
            return float(free.min())
        low, high = np.minimum(free[:-1], free[1:]), np.maximum(free[:-1], free[1:])
        rise = high - low
        d, last = max(depth, float(free.min())), np.inf
        for turn in range(100):
            over = np.clip(d - low, 0, None)
            flat = over >= rise
            part = np.where(flat, 1.0, over / np.where(flat, 1.0, rise))
            area = np.where(flat, d - 0.5 * (low + high), 0.5 * over * part).sum() * dx
            slope = part.sum() * dx
            new = d - (area * line.weight * stiffness - load) / (
                line.weight * stiffness * max(slope, 1e-6 * dx)
            )
            # of a convex function steps shrink until rounding
            stalled = turn > 5 and abs(new - d) >= last
            if stalled or abs(new - d) <= 1e-14 * abs(new):
                return new
            d, last = new, abs(new - d)
        return d

    out = []
    if law.viscosity == 0 and load[0] > 0:
        everything = law.equilibrium + law.moduli.sum()
        depth = found(g, everything, load[0], 0.0)
        u = np.maximum(depth - g, 0.0)
        f = law.moduli[:, None] * u
    out.append(depth)
    for i, (t0, t1, p0, p1) in enumerate(
        zip(time[:-1], time[1:], load[:-1], load[1:], strict=True)
    ):
        grade = 15.0 if i == 0 or p1 == 0 else 10.0
        half = 0.5 * np.expm1(grade * np.arange(steps + 1) / steps) / np.expm1(grade)
        place = np.append(half, 1 - half[-2::-1])
        for s0, s1 in itertools.pairwise(place):
            h = (t1 - t0) * (s1 - s0)
            z = h / law.times
            keep, mean = np.exp(-z)[:, None], (law.moduli * -np.expm1(-z) / z)[:, None]
            stiffness = float(law.equilibrium + law.viscosity / h + mean.sum())
            recovered = u - (law.equilibrium * u + (keep * f).sum(0)) / stiffness
            free = recovered + g
            depth = found(free, stiffness, p0 + s1 * (p1 - p0), depth)
            new = np.maximum(recovered, depth - g)
            f = keep * f + mean * (new - u)
            u = new
        out.append(depth)
    return np.array(out)
