"""Which instants of a history use a material beyond the range of its data.

What was pressed in at s shows at t by the modulus at the age t - s, and data up to a frequency w say nothing of ages
below 1/w, as a file's range of times has it. An instant lies beyond where half of the largest depth or load so far came
or went within the youngest known age, or a tenth of it was there before the oldest one: for a parabola's passage nearly
the rule for steady sliding (`steady_beyond`).
"""

from typing import Any

import numpy as np

from .._runtime import is_traced, significant
from ..mapping.lines import AbstractLines, SingleLine
from ..mapping.reach import contact_size
from ..mapping.rough_line import RoughLine
from ..material.validity import Range
from .beyond import NOT_KNOWN, Beyond, told
from .history import GivenHistory

_YOUNG, _OLD = 0.5, 0.1
_ROUNDING = 1e-6


def history_beyond(
    known: Range | None, time: Any, courses: list[Any], temperature: Any, factor: Any, *, at_once: bool = True,
    stacklevel: int,
) -> Beyond:  # fmt: skip
    """Instants [s] along the last axis of depths [m], loads [N] or displacements [m], each of the shape of `time`.

    `at_once`: whether what is put on at once at the first instant is looked at there.
    """
    if known is None or is_traced(time, courses, temperature, factor):
        return NOT_KNOWN
    ages = _ages(known, factor)
    young, old = np.zeros((2, *np.shape(time)), bool)
    for course in courses:
        for where, t, f in zip(np.ndindex(young.shape[:-1]), _rows(time), _rows(course), strict=True):
            young[where] |= _young(t, f, ages[0])
            old[where] |= _old(t, f, ages[1])
    young[..., 0] &= at_once
    return _instants(known, young, old, ages, temperature, stacklevel + 1)


def sliding_beyond(
    history: GivenHistory, body: RoughLine | AbstractLines, depth: Any, course: Any, *, stacklevel: int
) -> Beyond:
    """Instants of a body that slides, `depth` [m] deep, under a `course` of depths [m] or loads [N, or N/m].

    An element is as old as the path over which the contact has passed it, or as the contact, if that never left it. The
    body is put down at once at the first instant, of which nothing is looked at.
    """
    known, time, position = history.range, history.time, history.position
    if known is None or history.traced or is_traced(body, depth, history.factor):
        return NOT_KNOWN
    size = np.broadcast_to(_half_length(body, depth), time.shape)
    ages = _ages(known, history.factor)
    way = np.abs(np.diff(position))
    path = np.concatenate([[0.0], np.cumsum(way)])
    since = np.interp(path - 2 * size, path, time, left=time[0])
    since = np.where(np.ptp(position) > 2 * size, since, time[0])
    old = time - since > ages[1] * (1 + _ROUNDING)
    fast = np.zeros(time.shape, bool)
    fast[1:] = 2 * way * ages[0] > size[1:] * np.diff(time) * (1 + _ROUNDING)
    young = _young(time, course, ages[0]) | fast
    young[0] = False
    young, old = young & (course > 0), old & (course > 0)
    return _instants(known, young, old, ages, history.temperature, stacklevel + 1)


def _half_length(body: RoughLine | AbstractLines, depth: Any) -> Any:
    """Of the contact [m]: of an indenter so deep, or a quarter of the wavelength of a wave as high and as steep."""
    if isinstance(body, RoughLine):
        slope = float(body.rms_slope)
        return 0.5 * np.pi * float(body.rms_height) / slope if slope > 0 else np.inf
    deep = np.where(np.asarray(depth) > 0, depth, np.nan)
    return np.asarray(contact_size(body.shape, deep, not isinstance(body, SingleLine)))


def _ages(known: Range, factor: Any) -> tuple[float, float]:
    """The youngest and the oldest age [s] that the data speak of at the temperature where times are `factor` longer."""
    low, high = known.frequency or (0.0, np.inf)
    return float(factor) / high, float(factor) / low if low > 0 else np.inf


def _rows(values: Any) -> np.ndarray:
    return np.reshape(values, (-1, np.shape(values)[-1]))


def _young(time: np.ndarray, course: np.ndarray, age: float) -> np.ndarray:
    course = np.nan_to_num(course)
    gone = np.cumsum(np.abs(np.diff(course, prepend=0.0)))
    return gone - np.interp(time - age * (1 - _ROUNDING), time, gone, left=0.0) > _YOUNG * _peak(course)


def _old(time: np.ndarray, course: np.ndarray, age: float) -> np.ndarray:
    course = np.nan_to_num(course)
    return np.abs(np.interp(time - age * (1 + _ROUNDING), time, course, left=0.0)) > _OLD * _peak(course)


def _peak(course: np.ndarray) -> np.ndarray:
    return np.maximum.accumulate(np.abs(course))


def _instants(
    known: Range, young: np.ndarray, old: np.ndarray, ages: tuple[float, float], temperature: Any, stacklevel: int
) -> Beyond:
    none = np.zeros(young.shape)
    kelvin = None if temperature is None else np.broadcast_to(temperature, young.shape)
    elsewhere, nowhere = known._replace(frequency=None), known.frequency == ()
    points = young | old | nowhere | elsewhere.outside(none, kelvin)
    within, after = (significant(age, 3) for age in ages)
    what = [f"its answer within {within} s decides, range from {within} s"] if young.any() else []
    what += [f"its answer after more than {after} s decides, range to {after} s"] if old.any() else []
    what += ["the data determine the loss modulus nowhere"] if nowhere else []
    what += elsewhere.findings(none, kelvin)
    return told(points, "; ".join(what), known.illustrative, stacklevel + 1)
