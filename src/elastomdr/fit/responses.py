"""Other responses than relaxation as relaxation: creep compliance, stress after a ramp,
a storage modulus alone.

What was measured, M(t), is a functional of the relaxation modulus G(t):

    creep            M = 1/J(t)                                  with int_0^t G(t - s) dJ(s) = 1
    ramp of r
    M = (1/r) int_(t-r)^t G(s) ds
    t from the start of the ramp, ln s at its mean
    storage modulus  M = G'(omega)                               with t = 1/omega

G/M depends on the shape of the spectrum only, and little on that. It is taken from the
smooth spectrum through G, found from the ratio before, until it settles. After a ramp G
is not sought at t but at the mean of ln s over the ramp, where the ratio is nearly 1
for any spectrum: just behind the ramp, that is well before t.
"""

from dataclasses import replace

import numpy as np

from ..io.data import Dma
from ..material.prony import Prony
from ..material.shift import AbstractShift
from .isotherms import Isotherms, group, isotherms
from .joint import rough_shifts
from .shifting import LN10, Shifts

_ROUNDS = 12
_SETTLED = 2e-3  # change of ln(ratio) at which it counts as found
_DEGREE = 3  # of the polynomial whose slope gives the first ratio
_STEEPEST = 0.9  # slope d(ln M)/d(ln t) that the first ratio is made for


def as_relaxation(dma: Dma, tolerance: float, law: AbstractShift | None) -> Dma:
    """The same measurement with its response turned into relaxation; itself where it is
    relaxation.
    """
    if (dma.response == "relaxation" and not dma.ramp) or not dma.time.size:
        return dma
    ratio, time = _first(dma, tolerance), _middle(dma.time, dma.ramp)
    near = None
    for _ in range(_ROUNDS):
        found = replace(
            dma,
            time=time,
            relaxation=dma.relaxation * ratio,
            response="relaxation",
            ramp=0.0,
        )
        data = isotherms(found, tolerance, law)
        near = rough_shifts(data, law, near)
        before, ratio = ratio, _ratio(dma, time, data, near)
        if np.abs(np.log(ratio / before)).max() < _SETTLED:
            break
    words = f"{dma.described}, as relaxation by the spectrum"
    return replace(
        dma,
        time=time,
        relaxation=dma.relaxation * ratio,
        response="relaxation",
        ramp=0.0,
        columns=tuple(f"{text}; {words}" for text in dma.columns),
    )


def _first(dma: Dma, tolerance: float) -> np.ndarray:
    """G/M of a power law with the slope that each isotherm has."""
    number, mean = group(dma.time_temperature, tolerance)
    ratio = np.ones(dma.time.size)
    for i in range(mean.size):
        at = np.flatnonzero(number == i)
        u = np.log(dma.time[at])
        if np.unique(u).size < _DEGREE + 2:
            continue
        curve = np.polynomial.Polynomial.fit(u, np.log(dma.relaxation[at]), _DEGREE)
        m = np.clip(-curve.deriv()(u), 1e-3, _STEEPEST)
        if dma.response == "creep":
            ratio[at] = np.sinc(m)
    return ratio


def _middle(time: np.ndarray, ramp: float) -> np.ndarray:
    """The mean of ln s between t - ramp and t, as a time."""
    if not ramp:
        return time
    early = time - ramp
    return np.exp((time * np.log(time) - early * np.log(early)) / ramp - 1)


def _ratio(dma: Dma, time: np.ndarray, data: Isotherms, shifts: Shifts) -> np.ndarray:
    """G/M of a smooth spectrum at the times of all points."""
    p = shifts.posterior.mean
    times = np.exp(shifts.log_times + p[shifts.places])
    order = np.argsort(times)
    series = Prony(
        float(np.exp(p[shifts.equilibrium])),
        np.exp(p[shifts.spectrum])[order],
        times[order],
    )
    timed = slice(2 * dma.omega.size, None)
    shift = (
        shifts.horizontal(p)[0][data.points.isotherm[timed]] + data.points.offset[timed]
    )
    factor = np.exp(-LN10 * shift)
    reduced = dma.time * factor
    wanted = np.asarray(series.relaxation(time * factor))
    if dma.response == "creep":
        return wanted * np.asarray(series.creep_compliance(reduced))
    if dma.response == "storage":
        return wanted / np.asarray(series.storage(1 / reduced))
    return wanted / _after_ramp(series, reduced, dma.ramp * factor)


def _after_ramp(series: Prony, time: np.ndarray, ramp: np.ndarray) -> np.ndarray:
    """(1/r) int_(t-r)^t G(s) ds."""
    x, r = time[:, None] / series.times, ramp[:, None] / series.times
    mean = np.exp(-(x - r)) * -np.expm1(-r) / r
    return float(series.equilibrium) + mean @ np.asarray(series.moduli)
