"""Which points of a steady scene use a material beyond the range of its data, and how
that is said.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..checks import is_traced
from ..errors import ExtrapolationWarning, warn
from ..material.validity import Range
from ..surface.rough_line import RoughLine
from ..surface.spectrum import AbstractSpectrum

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

# share of a rough surface's mean square slope that may lie outside the range
_OUTSIDE = 0.1
_CELLS = 400  # of the slope, where each wave has a temperature of its own


class Beyond(NamedTuple):
    """Which points lie beyond the range, None where that is not known; and a line for
    the inputs where some do.
    """

    points: Bool[np.ndarray, "..."] | None
    said: tuple[tuple[str, str], ...]


NOT_KNOWN = Beyond(None, ())


def told(points: np.ndarray, findings: str, illustrative: bool) -> Beyond:
    """Says what lies beyond, with a warning unless the range is an assumption only."""
    if not points.any():
        return Beyond(points, ())
    sentence = f"{int(points.sum())} of {points.size} points lie beyond the range of the material"
    if findings:
        sentence += f": {findings}"
    if not illustrative:
        warn(f"{sentence}.", ExtrapolationWarning)
    return Beyond(points, (("extrapolated", sentence),))


def steady_beyond(
    known: Range | None, reduced: Any, size: Any, temperature: Any
) -> Beyond:
    """Passages at the velocities `reduced` = v a_T [m/s] of contacts of half the length
    `size` [m].

    A parabola's passage dissipates most at the frequency 2 v a_T/a, and nine tenths
    between a quarter and twice of it. A quarter is the reciprocal of the time that it
    lasts, and must be within the range too.
    """
    if known is None or is_traced(reduced, size, temperature):
        return NOT_KNOWN
    rate = np.asarray(2 * reduced / size)
    points = known.outside(rate, temperature)
    findings = "; ".join(known.findings(rate, temperature)) if points.any() else ""
    return told(points, findings, known.illustrative)


def held_beyond(
    known: Range | None, time: Any, temperature: Any, factor: Any
) -> Beyond:
    """What is put on at once and held for a `time` [s], or without one for ever, at
    points of one shape.
    """
    if known is None or is_traced(time, temperature, factor):
        return NOT_KNOWN
    with np.errstate(divide="ignore"):
        rate = 4 * np.asarray(factor) / (np.inf if time is None else np.asarray(time))
    shape = np.broadcast_shapes(rate.shape, np.shape(temperature))
    rate = np.broadcast_to(rate, shape)
    temperatures = None if temperature is None else np.broadcast_to(temperature, shape)
    points = known.outside(rate, temperatures)
    of = (
        "held for ever means a frequency"
        if time is None
        else "the time held means frequencies (a_T/t to 4 a_T/t)"
    )
    findings = "; ".join(known.findings(rate, temperatures, of)) if points.any() else ""
    return told(points, findings, known.illustrative)


def excited_outside(
    known: Range | None,
    surface: RoughLine | AbstractSpectrum,
    reduced: np.ndarray,
    factor: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Float[np.ndarray, "..."] | None:
    """Share of the mean square slope that is excited, at q v a_T, beyond the
    frequencies of the data.

    `factor`, of rubber that is hotter at some wave numbers of a spectrum than at
    others: that on v a_T at wave numbers (n,), shape (points, n).
    """
    if known is None or known.omega is None:
        return None
    if not known.omega:
        return np.ones(np.shape(reduced))
    if factor is not None and not isinstance(surface, RoughLine):
        ends = np.geomspace(float(surface.q_low), float(surface.q_high), _CELLS + 1)
        q, share = np.sqrt(ends[1:] * ends[:-1]), np.diff(surface.moment(3, None, ends))
        omega = reduced.reshape(-1, 1) * q * factor(q)
        beyond = (omega < known.omega[0]) | (omega > known.omega[1])
        return (beyond @ (share / share.sum())).reshape(reduced.shape)
    low, high = (frequency / reduced for frequency in known.omega)
    if isinstance(surface, RoughLine):
        q = 2 * np.pi * np.fft.rfftfreq(surface.count, float(surface.spacing))
        power = np.append(
            0.0,
            np.cumsum(np.square(q * np.abs(np.fft.rfft(np.asarray(surface.height))))),
        )
        if power[-1] == 0:  # a flat line excites nothing
            return np.zeros(np.shape(reduced))
        inside = (
            power[np.searchsorted(q, high, "right")] - power[np.searchsorted(q, low)]
        ) / power[-1]
    else:
        inside = surface.moment(3, low, high) / surface.moment(3)
    return np.clip(1 - inside, 0.0, 1.0)


def rough_beyond(
    known: Range | None,
    outside: np.ndarray | None,
    temperature: Any,
    shape: tuple[int, ...],
    rise: Any = 0.0,
) -> Beyond:
    """Points where more than a tenth of the slope is excited `outside`, or at a
    temperature that was not measured, with the `rise` [K] by friction or without it.
    """
    if known is None:
        return NOT_KNOWN
    only, rate, temperatures = known._replace(omega=None), np.zeros((2, *shape)), None
    if temperature is not None:
        body = np.broadcast_to(temperature, shape)
        temperatures = np.stack([body, body + np.nan_to_num(rise)])
    points: Any = only.outside(rate, temperatures).any(axis=0)
    findings = list(only.findings(rate, temperatures))
    if outside is not None and (outside > _OUTSIDE).any():
        points = points | (outside > _OUTSIDE)
        most = f"up to {outside.max():.0%} of the mean square slope"
        findings.append(f"{most} lies outside the measured frequencies of the material")
    if outside is None and known.temperature is None and not known.beyond:
        return NOT_KNOWN
    return told(points, "; ".join(findings), known.illustrative)
