"""Which instants of a history use a material beyond the range of its data.

What was pressed in at s shows at t by the modulus at the age t - s, and data up to a
frequency w say nothing of ages below 1/w, as a file's range of times has it. An instant
in contact lies beyond where half of its depth or load, or of what was there before,
came or went within the youngest known age, or where a tenth of it was there before the
oldest one: for a parabola's passage nearly the rule for steady sliding
(`steady_beyond`). A tangential displacement changes its sign, and is compared with the
largest so far.
"""

from typing import Any

import numpy as np

from ..call.extrapolation import told
from ..checks import Array, is_traced, numpy_unless_traced, significant
from ..material.validity import Range
from ..results.doubts import Doubt
from ..surface.disc import disc_under
from ..surface.lines import AbstractLines, SingleLine
from ..surface.rough_line import RoughLine
from .problem import GivenHistory

_YOUNG, _OLD = 0.5, 0.1
_ROUNDING = 1e-6


def history_beyond(
    known: Range | None,
    time: Any,
    pressed: Any,
    temperature: Array | None,
    factor: Array | float,
    *,
    slid: Any = None,
    at_once: bool = True,
    edge: Array | None = None,
) -> tuple[Doubt, ...]:
    """Instants [s] along the last axis of depths [m] or loads [N] `pressed`, and
    displacements [m] `slid`, all of the shape of `time`. `at_once`: whether what is put
    on at once at the first instant is looked at there. `edge`: where an
    adhesive edge is faster than the data (`edge_beyond`).
    """
    if known is None or is_traced(time, pressed, slid, temperature, factor):
        return ()
    ages = _ages(known, factor)
    young, old = np.zeros((2, *np.shape(time)), bool)
    for where, t, f in zip(
        np.ndindex(young.shape[:-1]), _rows(time), _rows(pressed), strict=True
    ):
        young[where], old[where] = _pressed(t, f, ages)
    if slid is not None:
        largest = np.maximum.accumulate(np.abs(slid))
        young |= _came(time, slid, ages[0]) > _YOUNG * largest
        old |= np.abs(_before(time, slid, ages[1])) > _OLD * largest
    young[..., 0] &= at_once
    if edge is not None:
        young |= edge
    return _instants(known, young, old, ages, temperature)


def edge_beyond(known: Range | None, rate: Array, factor: Array | float) -> Array:
    """Where an edge strains the rubber at angular frequencies `rate` [rad/s] above the
    data; not where there is none (NaN).
    """
    youngest = 0.0 if known is None else _ages(known, factor)[0]
    return np.nan_to_num(rate) * youngest > 1 + _ROUNDING


def sliding_beyond(
    history: GivenHistory,
    body: RoughLine | AbstractLines,
    depth: Array,
    course: Array,
) -> tuple[Doubt, ...]:
    """Instants of a body that slides, `depth` [m] deep, under a `course` of depths [m]
    or loads [N, or N/m].

    An element is as old as the path over which the contact has passed it, or as the
    contact, if that never left it. The body is put down at once at the first instant,
    of which nothing is looked at.
    """
    known, time, position = history.range, history.time, history.position
    if known is None or history.traced or is_traced(body, depth, history.factor):
        return ()
    size = np.broadcast_to(_half_length(body, depth), time.shape)
    ages = _ages(known, history.factor)
    way = np.abs(np.diff(position))
    path = np.concatenate([[0.0], np.cumsum(way)])
    since = np.interp(path - 2 * size, path, time, left=time[0])
    since = np.where(np.ptp(position) > 2 * size, since, time[0])
    old = (time - since > ages[1] * (1 + _ROUNDING)) & (course > 0)
    fast = np.zeros(time.shape, bool)
    fast[1:] = 2 * way * ages[0] > size[1:] * np.diff(time) * (1 + _ROUNDING)
    young = (_pressed(time, course, ages)[0] | fast) & (course > 0)
    young[0] = False
    return _instants(known, young, old, ages, history.temperature)


def _half_length(body: RoughLine | AbstractLines, depth: Array) -> Any:
    """Of the contact [m]: of an indenter so deep, or a quarter of the wavelength of a
    wave as high and as steep.
    """
    if isinstance(body, RoughLine):
        slope = float(body.rms_slope)
        return 0.5 * np.pi * float(body.rms_height) / slope if slope > 0 else np.inf
    disc = disc_under(body.shape, not isinstance(body, SingleLine))
    radius = np.asarray(numpy_unless_traced(disc.radius_of_depth)(np.asarray(depth)))
    return np.where(radius > 0, radius, np.nan)


def _ages(known: Range, factor: Array | float) -> tuple[float, float]:
    """The youngest and the oldest age [s] that the data speak of at the temperature
    where times are `factor` longer.
    """
    low, high = known.omega or (0.0, np.inf)
    return float(factor) / high, float(factor) / low if low > 0 else np.inf


def _rows(values: Array) -> np.ndarray:
    return np.reshape(values, (-1, np.shape(values)[-1]))


def _pressed(
    time: np.ndarray, course: Array, ages: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Where a depth or load is too young, and where too old, to be known."""
    course = np.maximum(np.nan_to_num(course), 0.0)
    young = _came(time, course, ages[0]) > _YOUNG * np.maximum(
        course, _before(time, course, ages[0] * (1 - _ROUNDING))
    )
    old = _before(time, course, ages[1] * (1 + _ROUNDING)) > _OLD * course
    return young & (course > 0), old & (course > 0)


def _came(time: np.ndarray, course: np.ndarray, age: float) -> np.ndarray:
    """How much of a course came and went within an age."""
    gone = np.cumsum(np.abs(np.diff(course, prepend=0.0)))
    return gone - _before(time, gone, age * (1 - _ROUNDING))


def _before(time: np.ndarray, course: np.ndarray, age: float) -> np.ndarray:
    """The course an age earlier."""
    return np.interp(time - age, time, course, left=0.0)


def _instants(
    known: Range,
    young: np.ndarray,
    old: np.ndarray,
    ages: tuple[float, float],
    temperature: Array | None,
) -> tuple[Doubt, ...]:
    none = np.zeros(young.shape)
    temperatures = (
        None if temperature is None else np.broadcast_to(temperature, young.shape)
    )
    elsewhere, nowhere = known._replace(omega=None), known.omega == ()
    points = young | old | nowhere | elsewhere.outside(none, temperatures)
    within, after = (significant(age, 3) for age in ages)
    findings = (
        [f"its answer within {within} s decides, range from {within} s"]
        if young.any()
        else []
    )
    findings += (
        [f"its answer after more than {after} s decides, range to {after} s"]
        if old.any()
        else []
    )
    findings += ["the data determine the loss modulus nowhere"] if nowhere else []
    findings += elsewhere.findings(none, temperatures)
    return told(known, points, "; ".join(findings))
