"""What cannot be relied on in master curves and Prony series, in words.

The doubts of the other fits stand beside them, in functions like these: sentences, most
important first, each where what it looks at passes its limit.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..errors import advise
from ..io.data import Dma, describe_list
from .shifting import LN10, AtReference, Joint
from .spectrum import (
    CHANNELS,
    RELAXATION,
    STORAGE,
    MeasuredPoints,
    closest_passive,
)
from .terms import Data, SlowEnd

# --------------------------------------------------------------------------------------
# Master curves.
# --------------------------------------------------------------------------------------

_NOT_SIMPLE = 2.0  # scatter about the common curve over that of the isotherms alone
_WORTH_SAYING = 0.01  # scatter below which a misfit is of no consequence
_MOVED = 0.1  # what the choice of shift model may move [decades]
_OUTSIDE = 1.5  # distance of the reference temperature from the data [K]
# half a 95 % interval of a shift that is no longer of much use [decades]
_USELESS = 0.3
_NAMED = 6  # outliers that are named one by one


class JudgedShifts(NamedTuple):
    """What is judged of a master curve."""

    dma: Dma
    joint: Joint
    state: AtReference
    reference: float  # [K]
    ambiguous: np.ndarray  # isotherms whose two shifts cannot be separated
    noise: dict[str, float]  # scatter about the curve per modulus
    log_reduced: np.ndarray  # ln of the reduced angular frequency, or of 1/t, per point

    @property
    def points(self) -> MeasuredPoints:
        return self.joint.shifts.points

    @property
    def celsius(self) -> np.ndarray:
        """Temperature of each isotherm."""
        return self.joint.shifts.temperature - 273.15


def of_shifts(judged: JudgedShifts) -> Iterator[str]:
    """The doubts of a master curve."""
    joint, celsius = judged.joint, judged.celsius
    if not joint.shifts.posterior.converged:
        yield (
            "The joint fit did not converge: look at the figure before using anything "
            "of it."
        )
    disagree = [*_contradictions(judged)]
    yield from disagree
    worst = max(judged.noise.values())
    is_misfit = joint.misfit > _NOT_SIMPLE and worst > _WORTH_SAYING
    # the scatter of measurements that disagree is no isotherm's
    if is_misfit and celsius.size > 1 and not disagree:
        yield (
            f"Not thermorheologically simple: the isotherms scatter {joint.misfit:.1f} "
            "times as much about one common curve as each about a smooth curve of its "
            f"own ({100 * worst:.2g} % in the worst modulus). No shift makes them one."
        )
    if judged.ambiguous.any():
        yield (
            "Horizontal and vertical shift cannot be separated at "
            f"{describe_list(celsius[judged.ambiguous], 'degC')}: the isotherms are "
            "too "
            "flat or too much alike there. Their log10 a_T rests on the prior for the "
            "vertical shift; see the intervals, and compare "
            + advise("vertical=False", {"no_vertical": ""})
            + "."
        )
    if joint.law is None:
        yield from _of_free_shifts(judged)
    if celsius.size == 1:
        yield "There is one temperature only: no shift law."
    yield from _reference_outside(judged)
    if celsius.size == 2:
        yield (
            "There are two temperatures only: Arrhenius' law can be fitted, WLF and "
            "VFT "
            "cannot."
        )
    if copies := judged.dma.copies:
        yield (
            f"{copies} of {judged.dma.size + copies} points repeat others in all their "
            "numbers, and are left out."
        )
    yield from _outliers(judged)
    wlf = judged.state.laws.get("WLF")
    if wlf is not None and not wlf.holds:
        yield (
            f"The WLF law misses the shift factors by {wlf.rms:.2f} decades rms, more "
            "than they are uncertain by: use the table of shift factors instead."
        )


def _contradictions(judged: JudgedShifts) -> Iterator[str]:
    if ratio := relaxation_excess(judged.joint):
        yield (
            "Relaxation and dynamic moduli contradict each other: the relaxation "
            "modulus "
            f"is {ratio:.2g} times what storage and loss modulus make of it (median "
            "where both were measured). Check unit, kind and sample of both "
            "measurements; what is fitted to both is a compromise between them."
        )


def _of_free_shifts(judged: JudgedShifts) -> Iterator[str]:
    """What the choice of shift model moves, and gaps between neighbouring isotherms."""
    celsius = judged.celsius
    choice = judged.joint.doubts[0].by_isotherm
    moved = np.abs(choice - np.interp(judged.reference - 273.15, celsius, choice))
    if moved.max() > _MOVED:
        yield (
            "These data leave open whether there are vertical shifts, which moves "
            "log10 "
            f"a_T by about {moved.max():.2g} decades (at {celsius[moved.argmax()]:.4g} "
            "degC); the intervals contain that."
        )
    log_rate, isotherm = judged.log_reduced, judged.points.isotherm
    gaps = []
    for i in range(celsius.size - 1):
        cold, warm = log_rate[isotherm == i], log_rate[isotherm == i + 1]
        if cold.size and warm.size and cold.min() > warm.max():
            decades = (cold.min() - warm.max()) / LN10
            gaps.append(
                f"{celsius[i]:.4g} and {celsius[i + 1]:.4g} degC "
                f"({decades:.1f} decades)"
            )
    if gaps:
        yield (
            f"Isotherms do not overlap: {', '.join(gaps)}. The shift across the gap "
            "rests on the assumption of a smooth spectrum."
        )


def _reference_outside(judged: JudgedShifts) -> Iterator[str]:
    reference, celsius = judged.reference - 273.15, judged.celsius
    low, high = celsius.min(), celsius.max()
    if celsius.size == 1 or low - _OUTSIDE <= reference <= high + _OUTSIDE:
        return
    half = judged.state.place.half
    advice = "; give a reference within the data" if half > _USELESS else ""
    yield (
        f"The reference temperature, {reference:.4g} degC, lies outside the data "
        f"({low:.4g} to {high:.4g} degC): it is reached by extrapolating the shift "
        "law, "
        f"which knows that step to +- {half:.2g} decades (95 %). Every log10 a_T and "
        f"the band contain that{advice}."
    )


def _outliers(judged: JudgedShifts) -> Iterator[str]:
    points = judged.points
    outliers = np.flatnonzero(judged.joint.shifts.posterior.weights < 1)
    if not outliers.size:
        return
    names = []
    for i in outliers[:_NAMED]:
        log_rate = points.log_rate[i]
        when = f"{np.exp(log_rate):.3g} rad/s"
        if points.channel[i] == RELAXATION:
            when = f"{np.exp(-log_rate):.3g} s"
        celsius = judged.celsius[points.isotherm[i]]
        names.append(f"{CHANNELS[points.channel[i]]} at {celsius:.4g} degC and {when}")
    more = " ..." if outliers.size > _NAMED else ""
    yield (
        f"{outliers.size} of {points.log_rate.size} values are outliers (beyond 3 "
        f"standard deviations) and count for less: {'; '.join(names)}{more}."
    )


# --------------------------------------------------------------------------------------
# Prony series.
# --------------------------------------------------------------------------------------

_MISSED = 0.1  # rms relative residual of a modulus
_OPEN = 0.1  # part of the modulus at the slow end that may still relax
_GAP = 0.01  # dynamic data outside the range of the material, relative


class JudgedSeries(NamedTuple):
    """What is judged of a Prony series."""

    data: Data
    residuals: np.ndarray  # relative, per point
    contradiction: str  # of storage and loss modulus, as the closest material shows it
    excess: float | None  # of relaxation over what dynamic moduli make of it
    converged: bool
    equilibrium: float  # equilibrium modulus [Pa]
    interval: tuple[float, float]  # 95 % of it [Pa]
    end: SlowEnd
    # of the angular frequencies of the material [rad/s]
    limits: tuple[float, float] | tuple[()]
    omega: np.ndarray  # of dynamic data [rad/s]


def of_series(judged: JudgedSeries) -> Iterator[str]:
    """The doubts of a series."""
    if not judged.converged:
        yield (
            "The refinement of the times did not converge: look at the figure before "
            "using the series."
        )
    for channel, name in enumerate(CHANNELS):
        measured = judged.data.points.channel == channel
        if measured.any():
            # single outliers are not held against it
            weights = judged.data.weights[measured]
            squares = weights * judged.residuals[measured] ** 2
            size = float(np.sqrt(squares.sum() / weights.sum()))
            if size > _MISSED:
                reason = _why_missed(judged, size, judged.data.noise[channel])
                yield f"The {name} is met to {100 * size:.2g} % rms only{reason}"
    end = judged.end
    if judged.equilibrium and end.end - end.low > _OPEN * end.end:
        low, high = judged.interval
        yield (
            f"The {end.kind} modulus still falls at the slow end of the data "
            f"({end.rate:.3g} rad/s): where they end sets the equilibrium modulus, "
            f"{judged.equilibrium:.4g} Pa; they allow {low:.3g} to {high:.3g} Pa."
        )
    if not judged.limits:
        yield (
            "Relaxation with so little fall, or so much noise, determines the loss "
            "modulus at no frequency: the range of the material is empty, and all "
            "friction from it is flagged as extrapolated. Measure dynamic moduli."
        )
    elif judged.omega.size:
        (low, high), omega = judged.limits, judged.omega
        if omega.min() < (1 - _GAP) * low or omega.max() > (1 + _GAP) * high:
            yield (
                "The data leave a gap in which the loss modulus is not known to 6 %: "
                "the "
                "range of the material is the widest part beside it, "
                f"{low:.3g} to {high:.3g} rad/s of {omega.min():.3g} to "
                f"{omega.max():.3g}. Measure between them, or closer isotherms."
            )


def _why_missed(judged: JudgedSeries, size: float, noise: float) -> str:
    if judged.excess is not None:
        factor = max(judged.excess, 1 / judged.excess)
        return (
            ": relaxation and dynamic moduli contradict each other, by a factor of "
            f"{factor:.2g}."
        )
    if judged.contradiction:
        return judged.contradiction
    if size > 1.5 * noise:
        return "; more terms may help (terms=...)."
    return ", by which the data scatter."


# --------------------------------------------------------------------------------------
# Whether relaxation agrees with the storage and loss modulus that were measured beside
# it.
#
# Both follow from one spectrum. That of the dynamic moduli alone foretells the relaxation
# modulus at times t with 1/t within their frequencies, and the ratio of what was measured
# to that is 1 in the median, unless a unit, a kind of modulus or the sample differs.
# --------------------------------------------------------------------------------------

_CONTRADICTION = 1.25  # ratio of relaxation to what dynamic moduli make of it
_FEWEST = 6  # values of storage and loss modulus of an isotherm that say anything


def relaxation_excess(joint: Joint) -> float | None:
    """By which factor relaxation is above what storage and loss modulus make of it;
    None where they agree within a factor of 1.25, or where nothing is to be compared.

    Isotherms are compared each by itself, so that no shift enters; where none has both,
    they are after the shift along the frequency: a vertical shift may have made up for
    the factor.
    """
    points, shifts = joint.shifts.points, joint.shifts
    slow = points.channel == RELAXATION
    if slow.all() or not slow.any():
        return None
    log10_a = shifts.horizontal(shifts.posterior.mean)[0]
    reduced = points.log_rate + LN10 * (log10_a[points.isotherm] + points.offset)
    for number, rate in (
        (points.isotherm, points.log_rate),
        (np.zeros_like(points.isotherm), reduced),
    ):
        each = [number == i for i in np.unique(number)]
        excesses = [
            _excess(
                rate[isotherm], points.log_value[isotherm], points.channel[isotherm]
            )
            for isotherm in each
        ]
        excess = np.concatenate(excesses)
        if excess.size:
            ratio = float(np.exp(np.median(excess)))
            return ratio if max(ratio, 1 / ratio) > _CONTRADICTION else None
    return None


def _excess(
    log_rate: np.ndarray, log_value: np.ndarray, channel: np.ndarray
) -> np.ndarray:
    """ln of relaxation over what the closest spectrum of both dynamic moduli makes of
    it, at each time within reach.
    """
    dynamic = channel != RELAXATION
    if dynamic.sum() < _FEWEST:
        return np.zeros(0)
    low, high = log_rate[dynamic].min(), log_rate[dynamic].max()
    slow = ~dynamic & (log_rate > low) & (log_rate < high)
    if not slow.any():
        return np.zeros(0)
    closest = closest_passive(
        log_rate[dynamic], log_value[dynamic], channel[dynamic] == STORAGE
    )
    return (
        np.zeros(0)
        if closest is None
        else log_value[slow] - closest.log_relaxation(log_rate[slow])
    )
