"""The direction average of many velocities at one load, from one line curve.

Line solutions stand on a grid even in log v. There the average is a convolution with
one kernel, the same at every node, since directions are factors of the velocity; and
the average, as smooth as the line's curve, is interpolated to the velocities asked for.
Where a line solution costs much, `direction.shared_grid` does with fewer of them.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..checks import Array
from .direction import STENCIL, directions, lagrange, spacing

if TYPE_CHECKING:
    from jaxtyping import Float, Int

_MARGIN = STENCIL // 2


class SharedCurve(NamedTuple):
    """A line curve and what it takes to average and to interpolate it."""

    velocity: Float[np.ndarray, " nodes"]  # of the line solutions [m/s]
    # `average` of the line's friction at the means, a part of the nodes
    kernel: Float[np.ndarray, " width"]
    half: Float[np.ndarray, " width"]  # the same with every second direction
    quarter: Float[np.ndarray, " width"]  # and with every fourth
    lower: Float[np.ndarray, " width"]  # the same with interpolation of lower order
    means: slice  # which nodes the averages belong to
    near: Int[np.ndarray, "points stencil"]  # the means about each velocity
    local: Float[np.ndarray, "points stencil"]  # and their weights
    coarse: Float[np.ndarray, "points stencil"]  # the same of lower order


def shared_curve(
    velocity: Float[np.ndarray, " points"], rtol: float, level: int = 0
) -> SharedCurve:
    """The grid for velocities [m/s] at one load, to a relative error of about `rtol`;
    `level` halves it as often.
    """
    step, kernels = spacing(rtol) / 2**level, _kernels(rtol, level)
    place = np.log(velocity) / step
    first, last = (
        math.floor(place.min()) - _MARGIN + 1,
        math.floor(place.max()) + _MARGIN,
    )
    index, local = lagrange(place - first, STENCIL)
    coarse = np.pad(lagrange(place - first, STENCIL - 2)[1], ((0, 0), (1, 1)))
    below = kernels.below
    return SharedCurve(
        np.exp(step * np.arange(first - below, last + _MARGIN + 1)),
        kernels.whole,
        kernels.half,
        kernels.quarter,
        kernels.lower,
        slice(below, below + last - first + 1),
        index,
        local,
        coarse,
    )


class _Kernels(NamedTuple):
    """The part of a `SharedCurve` that is the same for all velocities."""

    below: int  # nodes of a kernel below its own
    whole: np.ndarray
    half: np.ndarray
    quarter: np.ndarray
    lower: np.ndarray


@functools.lru_cache(64)
def _kernels(rtol: float, level: int) -> _Kernels:
    rule, step = directions(rtol, level), spacing(rtol) / 2**level
    shift = np.log(rule.cosines) / step  # of the directions, down the grid
    below = _MARGIN - 1 - math.floor(shift.min())
    width = below + _MARGIN + 1

    def kernel(stencil: int, weights: np.ndarray) -> np.ndarray:
        index, local = lagrange(shift + below, stencil)
        return np.bincount(index.ravel(), (local * weights[:, None]).ravel(), width)

    return _Kernels(
        below,
        kernel(STENCIL, rule.weights),
        kernel(STENCIL, rule.half),
        kernel(STENCIL, rule.quarter),
        kernel(STENCIL - 2, rule.weights),
    )


def shared_curve_size(velocity: Float[np.ndarray, " points"], rtol: float) -> int:
    """Number of line solutions that `shared_curve` asks for, to within two."""
    span = math.log(velocity.max() / velocity.min()) - math.log(
        directions(rtol).cosines[-1]
    )
    return math.ceil(span / spacing(rtol)) + 2 * STENCIL - 1


def average(
    line: Float[Array, " nodes"], kernel: Float[np.ndarray, " width"]
) -> Float[np.ndarray, " means"]:
    """The direction average of a line curve at the means."""
    return np.correlate(np.asarray(line), kernel, "valid")


def at_points(
    values: Float[np.ndarray, " means *n"],
    near: Int[np.ndarray, "points stencil"],
    weights: Float[np.ndarray, "points stencil"],
) -> Float[np.ndarray, " points *n"]:
    """Values at the means, interpolated to the velocities asked for."""
    return np.einsum("ps,ps...->p...", weights, values[near])


def between_orders(
    values: Float[np.ndarray, "means fields"], near: Int[np.ndarray, "points stencil"]
) -> Float[np.ndarray, " points"]:
    """How far interpolation is from that of lower order about each point, the largest
    of all fields.

    Taken in the middle of the interval of each point and of both beside it, since it
    may vanish by chance at a point.
    """
    windows = np.lib.stride_tricks.sliding_window_view(values, STENCIL, axis=0)
    off = np.abs(windows @ _orders_apart()).max(axis=1)
    padded = np.pad(off, 1, "edge")
    return np.max([padded[:-2], off, padded[2:]], axis=0)[near[:, 0]]


@functools.cache
def _orders_apart() -> np.ndarray:
    """Weights of interpolation in the middle of an interval, less those of lower
    order.
    """
    (fine,), (coarse,) = (
        lagrange(np.array([_MARGIN - 0.5]), stencil)[1]
        for stencil in (STENCIL, STENCIL - 2)
    )
    return fine - np.pad(coarse, 1)
