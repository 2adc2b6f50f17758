"""A history given at instants, linear between them, cut into contact steps.

Two equal instants are a jump of load or depth. Where motion or load changes abruptly,
the rubber answers on all its time scales: the first step after it is divided
geometrically, down to the shortest relaxation time. Every step of the finer levels is a
part of one of the coarsest, so that errors fall in proportion to the square of the
step.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import xp
from ..checks import Array, is_traced

if TYPE_CHECKING:
    from jaxtyping import Float

_FEWEST = 4  # steps between two instants
# change of a rate, relative to the larger of both, from which it counts as abrupt
_ABRUPT = 0.3
_HALVINGS = 40  # of the first step after an abrupt change, at most
_INSTANT = 1e-12  # duration of a jump, over the shortest time of the scene


class Steps(NamedTuple):
    """Contact steps: how long each is, and where the history stands at its end."""

    h: Float[Array, " steps"]  # [s]
    position: Float[Array, " steps"]  # X [m]
    value: Float[Array, " steps"]  # load [N] or depth [m]


class Timeline(NamedTuple):
    """The coarsest steps: which interval each belongs to and how far in it ends, from 0
    to 1.
    """

    interval: np.ndarray  # (steps,)
    fraction: np.ndarray  # at the end of each step
    part: np.ndarray  # of the interval that the step takes
    instant: np.ndarray  # (instants,) index of the step that ends there


def timeline(
    time: np.ndarray,
    position: Any,
    value: Any,
    spacing: float | None,
    shortest: float,
    even: int,
) -> Timeline:
    """Cuts a history. A moving body takes one step per `spacing` [m]; `even` steps per
    interval where that is None.
    """
    duration = np.diff(time)
    pieces: list[np.ndarray] = [np.ones(1)]
    before: np.ndarray | None = None
    for j, length in enumerate(duration):
        if length == 0:
            pieces.append(np.ones(1))
            before = None
            continue
        count = even
        if spacing is not None:
            count = max(
                _FEWEST, math.ceil(abs(position[j + 1] - position[j]) / spacing)
            )
        parts = np.full(count, 1 / count)
        if spacing is not None:
            rate = (
                np.array([position[j + 1] - position[j], value[j + 1] - value[j]])
                / length
            )
            if (
                before is None
                or (
                    np.abs(rate - before)
                    > _ABRUPT * np.maximum(np.abs(rate), np.abs(before))
                ).any()
            ):
                first = length / count
                halvings = min(
                    _HALVINGS, max(0, math.ceil(math.log2(first / shortest)))
                )
                halves = 0.5 ** np.arange(1, halvings + 1)
                parts = np.concatenate(
                    [parts[0] * np.append(halves, 0.5**halvings)[::-1], parts[1:]]
                )
            before = rate
        pieces.append(parts)
    return Timeline(
        interval=np.repeat(np.arange(len(pieces)), [p.size for p in pieces]),
        fraction=np.concatenate([np.cumsum(p) for p in pieces]),
        part=np.concatenate(pieces),
        instant=np.cumsum([p.size for p in pieces]) - 1,
    )


def cut(
    line: Timeline,
    time: np.ndarray,
    position: Any,
    value: Any,
    shortest: float,
    finer: int,
) -> tuple[Steps, Any]:
    """The steps, each divided into `finer` equal ones, and the index of the last step
    before each instant.
    """
    duration = np.diff(time)
    times = duration[duration > 0]
    jump = _INSTANT * min(shortest, float(times.min()) if times.size else shortest)
    interval = np.repeat(line.interval, finer)
    within = (np.tile(np.arange(finer) + 1, line.part.size) / finer - 1) * np.repeat(
        line.part, finer
    )
    share = np.clip(np.repeat(line.fraction, finer) + within, 0.0, 1.0)
    last = finer * (line.instant + 1) - 1
    share[last] = 1.0
    length = np.concatenate([[0.0], duration])
    length = np.where(length > 0, length, jump)
    numpy = xp if is_traced(position, value) else np

    def at(values: Any) -> Any:
        left = numpy.concatenate([values[:1], values[:-1]])[interval]
        return left + share * (values[interval] - left)

    steps = Steps(
        np.repeat(line.part / finer, finer) * length[interval], at(position), at(value)
    )
    return steps, last
