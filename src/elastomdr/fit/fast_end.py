"""A prior for what relaxed before the first instant of relaxation data: roughly a power
law.

Relaxation from t_0 on says next to nothing of relaxation times below t_0/4, but they
are a part of the loss at angular frequencies a decade or two below 1/t_0. A spectrum
that is free there goes on with whatever slope its last ripple has, to nothing as a
rule, and what is nothing has no uncertainty. It is expected to continue H = -dG/d(ln t)
of the first two decades of data,

    ln H(tau) = ln H(t_0) + n ln(t_0/tau) +- sqrt(A^2 + B^2 ln(t_0/tau)^2),

at all times together too high or too low, too steep or too flat. How smooth the
spectrum is has to be learnt from the times that are seen: second differences of the
others would all be small.

What is known to a factor only may be larger by more than it may be smaller: an interval
takes the step of one standard deviation up, e^s - 1, not its tangent s.
"""

import numpy as np

from .posterior import Prior
from .spectrum import PER_DECADE, RELAXATION, Points

_LN10 = float(np.log(10.0))
_SEEN = 0.25  # times t_0, the shortest relaxation time that data say enough of
_DECADES = 2.0  # of the data that level and slope are taken from
_LEVEL = 0.5  # A: standard deviation of ln H at the first instant
_SLOPE = 0.25  # B: standard deviation of n
_EACH = 0.5  # standard deviation of each ln H for itself
_WIDEST = 1.5  # standard deviation of ln H beyond which it is no better than unknown
_FEWEST = 6  # instants that a level and a slope are taken from,
_NARROW = 0.3  # and the least number of decades that they have to span
# of their span, by how much inside of its ends a parabola's slope is taken
_INWARD = 0.15
_FLAT = 1e-3  # least -d(ln G)/d(ln t)
# largest n, least one 0: a steeper one would have no bounds to its loss
_STEEPEST = 0.8


def hidden(points: Points, reduced: np.ndarray, log_times: np.ndarray) -> np.ndarray:
    """Which relaxation times are too short for relaxation data to see; none for other
    data.

    `reduced` is ln(1/t) of the points at the anchor's temperature.
    """
    fastest = reduced.argmax()
    relaxed = points.channel[fastest] == RELAXATION
    return (log_times < np.log(_SEEN) - reduced[fastest]) & relaxed


def skewed(std: np.ndarray) -> np.ndarray:
    """Factor on a derivative by ln H where that is known to `std`: H may be larger by
    more than it may be smaller.
    """
    std = np.clip(std, 1e-3, _WIDEST)
    return np.expm1(std) / std


def early(
    points: Points, reduced: np.ndarray, log_times: np.ndarray, size: int
) -> list[Prior]:
    """The expectation of ln H_k (the first of `size` unknowns) at times too short to be
    seen; none for other data.

    `reduced` as for `hidden`.
    """
    if points.channel[reduced.argmax()] != RELAXATION:
        return []
    start = -reduced.max()
    unmeasured = np.flatnonzero(hidden(points, reduced, log_times))
    at = (points.channel == RELAXATION) & (-reduced <= start + _DECADES * _LN10)
    u = -reduced[at] - start
    if np.unique(u).size < _FEWEST or np.ptp(u) < _NARROW * _LN10:
        return []
    curve = np.polynomial.Polynomial.fit(u, points.log_value[at], 2)
    ends = np.array([_INWARD, 1 - _INWARD]) * np.ptp(u)
    # ln H per unit of ln(tau)
    fall = np.log(np.maximum(-curve.deriv()(ends), _FLAT)) + curve(ends)
    steepness = float(
        np.clip((fall[0] - fall[1]) / (ends[1] - ends[0]), 0.0, _STEEPEST)
    )
    away = start - log_times[unmeasured]
    target = fall[0] + steepness * (ends[0] + away) + np.log(_LN10 / PER_DECADE)
    spread = (
        _LEVEL**2
        + _SLOPE**2 * np.outer(away, away)
        + _EACH**2 * np.eye(unmeasured.size)
    )
    whiten = np.linalg.inv(np.linalg.cholesky(spread))
    rows = np.zeros((unmeasured.size, size))
    rows[:, unmeasured] = whiten
    return [Prior(rows, 1.0, None, whiten @ target)]
