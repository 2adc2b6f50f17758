"""What cannot be relied on in a fit: tables of checks.

A `Check` says what it looks at, above which limit it speaks, and with which sentence.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..io.data import Dma, describe_list
from .report import TWO_SIGMA
from .shifting import LN10, AtReference, Joint
from .spectrum import (
    CHANNELS,
    LOSS,
    RELAXATION,
    STORAGE,
    MeasuredPoints,
    closest_passive,
)
from .terms import Data, SlowEnd

Facts = dict[str, Any]  # what a sentence has to name


class Check(NamedTuple):
    """One thing that may be wrong with a fit."""

    looks_at: str
    limit: float  # above which it speaks; 0 where it is a matter of yes or no
    # what the sentence names, once per sentence, from what is judged and the limit
    test: Callable[[Any, float], Iterator[Facts]]
    sentence: str
    # other checks that explain this one: where they have spoken, it is silent
    unless: tuple[str, ...] = ()


def doubts(checks: Sequence[Check], judged: Any) -> tuple[str, ...]:
    """The sentences of all checks that speak, in the order of the table."""
    sentences: dict[str, list[str]] = {}
    for check in checks:
        if any(sentences[other] for other in check.unless):
            sentences[check.looks_at] = []
            continue
        sentences[check.looks_at] = [
            check.sentence.format(**facts) for facts in check.test(judged, check.limit)
        ]
    return tuple(sentence for each in sentences.values() for sentence in each)


def _if(is_so: Callable[[Any], bool]) -> Callable[[Any, float], Iterator[Facts]]:
    """A test of yes or no, whose sentence names nothing."""

    def test(judged: Any, limit: float) -> Iterator[Facts]:
        if is_so(judged):
            yield {}

    return test


_not_converged = _if(lambda judged: not judged.converged)

# --------------------------------------------------------------------------------------
# Master curves.
# --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class JudgedShifts:
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
    def temperature(self) -> np.ndarray:
        """Of each isotherm [K]."""
        return self.joint.shifts.temperature

    @property
    def converged(self) -> bool:
        return self.joint.shifts.posterior.converged

    @cached_property
    def celsius(self) -> np.ndarray:
        return self.temperature - 273.15


def _relaxation_contradicts(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    if ratio := relaxation_excess(judged.joint, limit):
        yield {"ratio": ratio}


_SAME_RATE = 0.01  # of ln(omega), within which two frequencies are one,
_SAME_PLACE = 0.3  # and two temperatures [K]: modulus may change by a tenth per kelvin
_FEWEST_REPEATS = 3  # repeated points of an isotherm that say anything
_SURE = 3.0  # standard errors beyond which a mean difference is no noise


def _repeats_differ(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    """Isotherms whose repeated points differ on the whole by more than `limit`, in the
    mean of ln(last/first), and not by noise.
    """
    largest: dict[float, float] = {}
    for number, ratios in _repeats(judged).items():
        if len(ratios) < _FEWEST_REPEATS:
            continue
        mean = np.mean(ratios, axis=0)
        error = np.std(ratios, axis=0, ddof=1) / np.sqrt(len(ratios))
        differs = np.abs(mean) > np.maximum(limit, _SURE * error)
        if differs.any():
            difference = np.abs(np.expm1(mean[differs])).max()
            largest[float(judged.celsius[number])] = float(difference)
    if largest:
        yield {
            "places": describe_list(sorted(largest), "degC"),
            "percent": 100 * max(largest.values()),
        }


def _repeats(judged: JudgedShifts) -> dict[int, list[np.ndarray]]:
    """Number of an isotherm to ln(last/first) of storage and loss modulus, for each
    point that was measured again.
    """
    dma = judged.dma
    isotherm = judged.points.isotherm[judged.points.channel == STORAGE]
    rate = np.round(np.log(dma.omega) / _SAME_RATE)
    log_modulus = np.log(np.stack([dma.storage, dma.loss]))
    earlier: dict[tuple[int, int], list[int]] = {}
    ratios: dict[int, list[np.ndarray]] = {}
    for i in range(dma.omega.size):
        known = earlier.setdefault((int(isotherm[i]), int(rate[i])), [])
        away = np.abs(dma.temperature[i] - dma.temperature[known])
        repeated = np.flatnonzero(away <= _SAME_PLACE)
        if repeated.size:
            first = known[repeated[0]]
            ratios.setdefault(int(isotherm[i]), []).append(
                log_modulus[:, i] - log_modulus[:, first]
            )
        else:
            known.append(i)
    return ratios


_WORTH_SAYING = 0.01  # scatter below which a misfit is of no consequence


def _not_simple(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    misfit, worst = judged.joint.misfit, max(judged.noise.values())
    if misfit > limit and worst > _WORTH_SAYING and judged.temperature.size > 1:
        yield {"misfit": misfit, "percent": 100 * worst}


def _not_separable(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    celsius = judged.celsius[judged.ambiguous]
    if celsius.size:
        yield {"places": describe_list(celsius, "degC")}


def _choice_moves(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    if judged.joint.law is not None:
        return
    choice = judged.joint.doubts[0].by_isotherm
    at_reference = np.interp(judged.reference, judged.temperature, choice)
    moved = np.abs(choice - at_reference)
    if moved.max() > limit:
        celsius = judged.temperature[moved.argmax()] - 273.15
        yield {"decades": moved.max(), "celsius": celsius}


def _no_overlap(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    if judged.joint.law is not None:
        return
    log_rate, isotherm = judged.log_reduced, judged.points.isotherm
    celsius = judged.celsius
    gaps = []
    for i in range(celsius.size - 1):
        cold, warm = log_rate[isotherm == i], log_rate[isotherm == i + 1]
        if cold.size and warm.size and cold.min() - warm.max() > limit:
            decades = (cold.min() - warm.max()) / LN10
            gaps.append(
                f"{celsius[i]:.4g} and {celsius[i + 1]:.4g} degC "
                f"({decades:.1f} decades)"
            )
    if gaps:
        yield {"gaps": ", ".join(gaps)}


def _one_temperature(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    if judged.temperature.size == 1:
        yield {}


_USELESS = (
    0.3  # half a 95 % interval of a shift that is no longer of much use [decades]
)


def _reference_outside(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    temperature = judged.temperature
    low, high = temperature.min() - limit, temperature.max() + limit
    if temperature.size == 1 or low <= judged.reference <= high:
        return
    half = judged.state.place.half
    yield {
        "reference": judged.reference - 273.15,
        "low": temperature.min() - 273.15,
        "high": temperature.max() - 273.15,
        "half": half,
        "advice": "; give a reference within the data" if half > _USELESS else "",
    }


def _two_temperatures(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    if judged.temperature.size == 2:
        yield {}


def _copied_points(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    if copies := judged.dma.copies:
        yield {"copies": copies, "all": judged.dma.size + copies}


_NAMED = 6  # outliers that are named one by one


def _outliers(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
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
    yield {
        "count": outliers.size,
        "all": points.log_rate.size,
        "names": "; ".join(names) + more,
    }


def _wlf_misses(judged: JudgedShifts, limit: float) -> Iterator[Facts]:
    wlf = judged.state.laws.get("WLF")
    if wlf is not None and not wlf.holds:
        yield {"rms": wlf.rms}


CONTRADICTION = 1.25  # ratio of relaxation to what dynamic moduli make of it

# most important first
OF_SHIFTS = (
    Check(
        "convergence of the joint fit",
        0.0,
        _not_converged,
        "The joint fit did not converge: look at the figure before using anything of "
        "it.",
    ),
    Check(
        "relaxation over what dynamic moduli make of it",
        CONTRADICTION,
        _relaxation_contradicts,
        "Relaxation and dynamic moduli contradict each other: the relaxation modulus "
        "is {ratio:.2g} times what storage and loss modulus make of it (median where "
        "both were measured). Check unit, kind and sample of both measurements; what "
        "is fitted to both is a compromise between them.",
    ),
    Check(
        "repeated points: mean ln of last over first",
        0.04,
        _repeats_differ,
        "Points are repeated at {places}, and differ from those before by up to "
        "{percent:.2g} % on average: another sample, strain or pass? All are taken for "
        "one material, whose shifts and moduli are a compromise; leave out what does "
        "not belong to it.",
    ),
    Check(
        "scatter about the common curve over that of the isotherms alone",
        2.0,
        _not_simple,
        "Not thermorheologically simple: the isotherms scatter {misfit:.1f} times as "
        "much about one common curve as each about a smooth curve of its own "
        "({percent:.2g} % in the worst modulus). No shift makes them one.",
        # the scatter of measurements that disagree is no isotherm's
        unless=(
            "relaxation over what dynamic moduli make of it",
            "repeated points: mean ln of last over first",
        ),
    ),
    Check(
        "isotherms whose horizontal and vertical shift cannot be separated",
        0.0,
        _not_separable,
        "Horizontal and vertical shift cannot be separated at {places}: the isotherms "
        "are too flat or too much alike there. Their log10 a_T rests on the prior for "
        "the vertical shift; see the intervals, and compare vertical=False "
        "(--no-vertical).",
    ),
    Check(
        "what the choice of shift model moves [decades]",
        0.1,
        _choice_moves,
        "These data leave open whether there are vertical shifts, which moves log10 "
        "a_T by about {decades:.2g} decades (at {celsius:.4g} degC); the intervals "
        "contain that.",
    ),
    Check(
        "gaps between neighbouring isotherms [ln of reduced frequency]",
        0.0,
        _no_overlap,
        "Isotherms do not overlap: {gaps}. The shift across the gap rests on the "
        "assumption of a smooth spectrum.",
    ),
    Check(
        "one temperature",
        0.0,
        _one_temperature,
        "There is one temperature only: no shift law.",
    ),
    Check(
        "distance of the reference temperature from the data [K]",
        1.5,
        _reference_outside,
        "The reference temperature, {reference:.4g} degC, lies outside the data "
        "({low:.4g} to {high:.4g} degC): it is reached by extrapolating the shift law, "
        "which knows that step to +- {half:.2g} decades (95 %). Every log10 a_T and "
        "the band contain that{advice}.",
    ),
    Check(
        "two temperatures",
        0.0,
        _two_temperatures,
        "There are two temperatures only: Arrhenius' law can be fitted, WLF and VFT "
        "cannot.",
    ),
    Check(
        "points that repeat others in all their numbers",
        0.0,
        _copied_points,
        "{copies} of {all} points repeat others in all their numbers, and are left "
        "out.",
    ),
    Check(
        "outliers",
        0.0,
        _outliers,
        "{count} of {all} values are outliers (beyond 3 standard deviations) and count "
        "for less: {names}.",
    ),
    Check(
        "WLF law through the shift factors",
        0.0,
        _wlf_misses,
        "The WLF law misses the shift factors by {rms:.2f} decades rms, more than they "
        "are uncertain by: use the table of shift factors instead.",
    ),
)

# --------------------------------------------------------------------------------------
# Prony series.
# --------------------------------------------------------------------------------------


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
    limits: tuple[float, ...]  # of the angular frequencies of the material [rad/s]
    omega: np.ndarray  # of dynamic data [rad/s]


_NAMES = {STORAGE: "storage", LOSS: "loss", RELAXATION: "relaxation"}


def _moduli_missed(judged: JudgedSeries, limit: float) -> Iterator[Facts]:
    """Moduli that the series does not meet; single outliers are not held against it."""
    for channel, name in _NAMES.items():
        measured = judged.data.points.channel == channel
        if not measured.any():
            continue
        weights = judged.data.weights[measured]
        squares = weights * judged.residuals[measured] ** 2
        size = float(np.sqrt(squares.sum() / weights.sum()))
        if size > limit:
            reason = _why_missed(judged, size, judged.data.noise[channel])
            yield {"name": name, "percent": 100 * size, "reason": reason}


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


def _level_open(judged: JudgedSeries, limit: float) -> Iterator[Facts]:
    """Whether the data say where the equilibrium modulus is, or only where they end."""
    end = judged.end
    if judged.equilibrium and end.end - end.low > limit * end.end:
        low, high = judged.interval
        yield {
            "kind": end.kind,
            "rate": end.rate,
            "level": judged.equilibrium,
            "low": low,
            "high": high,
        }


def _gap_in_range(judged: JudgedSeries, limit: float) -> Iterator[Facts]:
    omega, limits = judged.omega, judged.limits
    if not limits or not omega.size:
        return
    below = omega.min() < (1 - limit) * limits[0]
    above = omega.max() > (1 + limit) * limits[1]
    if below or above:
        yield {
            "low": limits[0],
            "high": limits[1],
            "lowest": omega.min(),
            "highest": omega.max(),
        }


OF_SERIES = (
    Check(
        "convergence of the relaxation times",
        0.0,
        _not_converged,
        "The refinement of the times did not converge: look at the figure before using "
        "the series.",
    ),
    Check(
        "relative residual of each modulus, rms",
        0.1,
        _moduli_missed,
        "The {name} modulus is met to {percent:.2g} % rms only{reason}",
    ),
    Check(
        "part of the modulus at the slow end that may still relax",
        0.1,
        _level_open,
        "The {kind} modulus still falls at the slow end of the data ({rate:.3g} "
        "rad/s): where they end sets the equilibrium modulus, {level:.4g} Pa; they "
        "allow {low:.3g} to {high:.3g} Pa.",
    ),
    Check(
        "dynamic data outside the range of the material, relative",
        0.01,
        _gap_in_range,
        "The data leave a gap in which the loss modulus is not known to 6 %: the range "
        "of the material is the widest part beside it, {low:.3g} to {high:.3g} rad/s "
        "of {lowest:.3g} to {highest:.3g}. Measure between them, or closer isotherms.",
    ),
    Check(
        "range of the material",
        0.0,
        _if(lambda judged: not judged.limits),
        "Relaxation with so little fall, or so much noise, determines the loss modulus "
        "at no frequency: the range of the material is empty, and all friction from it "
        "is flagged as extrapolated. Measure dynamic moduli.",
    ),
)

# --------------------------------------------------------------------------------------
# Master curves of friction.
# --------------------------------------------------------------------------------------


class JudgedFriction(NamedTuple):
    """What is judged of a master curve of friction."""

    celsius: np.ndarray  # of each curve [degC]
    log10_a: np.ndarray
    covariance: np.ndarray  # of log10_a
    flat: bool  # friction changes less over all velocities than its scatter can show
    converged: bool


def _uncertain_steps(judged: JudgedFriction, limit: float) -> Iterator[Facts]:
    celsius = judged.celsius
    between = np.diff(np.eye(celsius.size), axis=0)
    variance = np.diag(between @ judged.covariance @ between.T)
    std = np.sqrt(np.maximum(variance, 0.0))
    for i in np.flatnonzero(std > limit * np.abs(np.diff(judged.log10_a))):
        yield {"one": celsius[i], "next": celsius[i + 1], "half": TWO_SIGMA * std[i]}


OF_FRICTION = (
    Check(
        "convergence of the curve",
        0.0,
        _not_converged,
        "The fit did not converge: look at the figure before using it.",
    ),
    Check(
        "change of friction over its scatter",
        0.0,
        _if(lambda judged: judged.flat),
        "The friction is too flat against its scatter to see any shift: log10 a_T is "
        "what is usual of rubber.",
    ),
    Check(
        "relative standard deviation of a shift between neighbours",
        0.3,
        _uncertain_steps,
        "The shift between {one:.4g} and {next:.4g} degC is known to +- {half:.2g} "
        "decades only: the friction hardly changes there, or the curves do not overlap.",
        unless=("change of friction over its scatter",),
    ),
)

# --------------------------------------------------------------------------------------
# Softening.
# --------------------------------------------------------------------------------------


class JudgedSoftening(NamedTuple):
    """What is judged of Kraus' form through strain sweeps."""

    strain: tuple[float, float]  # smallest and largest measured
    first: float  # factor on the storage modulus at the smallest
    slope: float  # of ln storage over ln strain at the largest, falling
    at_limit: bool  # whether a constant is at the end of what is looked at
    drop_std: float  # standard deviation of r
    rms: np.ndarray  # of ln storage and ln loss, (sweeps, 2)
    temperature: np.ndarray  # of each sweep [K]; NaN where not known
    omega: np.ndarray  # [rad/s]; NaN where not known


def _falls_still(judged: JudgedSoftening, limit: float) -> Iterator[Facts]:
    if judged.slope > limit:
        yield {"percent": 100 * judged.strain[1]}


def _softened_at_first(judged: JudgedSoftening, limit: float) -> Iterator[Facts]:
    if 1 - judged.first > limit:
        yield {"percent": 100 * judged.strain[0]}


def _uncertain_drop(judged: JudgedSoftening, limit: float) -> Iterator[Facts]:
    if judged.drop_std > limit:
        yield {"half": 2 * judged.drop_std}


def _sweeps_apart(judged: JudgedSoftening, limit: float) -> Iterator[Facts]:
    apart = (judged.rms > limit * np.median(judged.rms, axis=0)).any(axis=1)
    if apart.size == 1:
        return
    for i in np.flatnonzero(apart):
        celsius, hertz = judged.temperature[i] - 273.15, judged.omega[i] / (2 * np.pi)
        where = "" if np.isnan(celsius) else f" at {celsius:.3g} degC"
        where += "" if np.isnan(hertz) else f" and {hertz:.3g} Hz"
        yield {"where": where}


OF_SOFTENING = (
    Check(
        "slope of ln storage over ln strain at the largest strain, falling",
        0.1,
        _falls_still,
        "The storage modulus still falls at the largest strain, {percent:.3g} %: where "
        "it levels off is an extrapolation. The factors end there, and are held beyond.",
    ),
    Check(
        "drop of the storage modulus at the smallest strain",
        0.03,
        _softened_at_first,
        "At the smallest strain, {percent:.3g} %, the rubber has softened already: the "
        "moduli of small strain are an extrapolation.",
    ),
    Check(
        "constants at the end of what is looked at",
        0.0,
        _if(lambda judged: judged.at_limit),
        "A constant of Kraus' form is at the end of what is looked at: take the table "
        "(form='table').",
    ),
    Check(
        "standard deviation of the drop of the storage modulus",
        0.25,
        _uncertain_drop,
        "The drop of the storage modulus is known to +- {half:.2g} only.",
    ),
    Check(
        "rms of a sweep over the median of all",
        2.5,
        _sweeps_apart,
        "The sweep{where} does not follow the factors of the others: they depend on it.",
    ),
)

# --------------------------------------------------------------------------------------
# Calibration.
# --------------------------------------------------------------------------------------


class JudgedCalibration(NamedTuple):
    """What is judged of parameters adjusted to measurements."""

    names: Sequence[str]
    std: np.ndarray
    prior: np.ndarray  # standard deviations assumed beforehand
    covariance: np.ndarray
    used: np.ndarray  # which measurements have a computed answer
    converged: bool


def _not_computed(judged: JudgedCalibration, limit: float) -> Iterator[Facts]:
    if missing := int((~judged.used).sum()):
        yield {"count": missing, "all": judged.used.size}


def _not_learned(judged: JudgedCalibration, limit: float) -> Iterator[Facts]:
    for name, std, prior in zip(judged.names, judged.std, judged.prior, strict=True):
        if std > limit * prior:
            yield {"name": name, "std": std, "prior": prior}


def _correlated(judged: JudgedCalibration, limit: float) -> Iterator[Facts]:
    correlation = judged.covariance / np.outer(judged.std, judged.std)
    for i, name in enumerate(judged.names):
        for j in range(i):
            if abs(r := correlation[i, j]) > limit:
                yield {"one": judged.names[j], "other": name, "correlation": r}


OF_CALIBRATION = (
    Check(
        "convergence of the search",
        0.0,
        _not_converged,
        "The search did not converge.",
    ),
    Check(
        "points without a computed answer",
        0.0,
        _not_computed,
        "{count} of {all} points have no computed answer and count for nothing.",
    ),
    Check(
        "uncertainty of a parameter over that of its prior",
        0.7,
        _not_learned,
        "{name} is hardly determined by the data: its uncertainty, {std:.2g}, is that "
        "of the prior, {prior:.2g}.",
    ),
    Check(
        "correlation of two parameters",
        0.98,
        _correlated,
        "{one} and {other} cannot be separated (correlation {correlation:.3f}).",
    ),
)

# --------------------------------------------------------------------------------------
# The shear law of adhesion.
# --------------------------------------------------------------------------------------


class JudgedAdhesion(NamedTuple):
    """What is judged of a shear law fitted to measured friction."""

    converged: bool
    used: np.ndarray  # which points have a computed hysteresis and contact area
    # by parameter, whether the search reached its lower, its upper limit
    open_ends: dict[str, tuple[bool, bool]]
    width: float  # lower end of its interval
    decades: float  # of the velocities
    cutoffs: tuple[float, float]  # lowest and highest that were computed [rad/m]
    hysteresis: np.ndarray  # of the points used
    measured: np.ndarray
    misfit: float  # rms of the residuals over the error given; NaN where none was
    warm: bool  # whether temperatures differ


def _undecided(judged: JudgedAdhesion, limit: float) -> Iterator[Facts]:
    names = ("stress", "velocity", "energy")
    undecided = [name for name in names if any(judged.open_ends.get(name, ()))]
    if undecided:
        yield {"names": " and ".join(undecided), "decades": judged.decades}


def _cutoff_at_limit(judged: JudgedAdhesion, limit: float) -> Iterator[Facts]:
    if any(judged.open_ends.get("q_high", ())):
        yield {"low": judged.cutoffs[0], "high": judged.cutoffs[1]}


def _hysteresis_alone(judged: JudgedAdhesion, limit: float) -> Iterator[Facts]:
    if above := int((judged.hysteresis > judged.measured).sum()):
        yield {"above": above, "all": judged.measured.size}


def _misfit(judged: JudgedAdhesion, limit: float) -> Iterator[Facts]:
    if judged.misfit > limit:
        yield {"misfit": judged.misfit}


OF_ADHESION = (
    Check(
        "convergence of the search, where the summit of the stress is bounded",
        0.0,
        _if(
            lambda judged: (
                not judged.converged and not any(judged.open_ends["velocity"])
            )
        ),
        "The search did not converge.",
    ),
    Check(
        "points without a computed answer",
        0.0,
        _not_computed,
        "{count} of {all} points have no computed hysteresis or contact area and are "
        "left out.",
    ),
    Check(
        "parameters at the end of what is looked at",
        0.0,
        _undecided,
        "{names} cannot be determined: over {decades:.2g} decades of velocity the data "
        "show no maximum of the stress. Measure at lower or higher velocities, or at "
        "more temperatures.",
    ),
    Check(
        "width against zero",
        0.0,
        _if(lambda judged: judged.width == 0.0),
        "width cannot be distinguished from 0: over the measured velocities the stress "
        "is constant, or rises or falls as a power, within the scatter.",
    ),
    Check(
        "width at the upper end of what is looked at",
        0.0,
        _if(lambda judged: judged.open_ends["width"][1]),
        "width is not bounded above: the stress falls off within the distance of two "
        "velocities.",
    ),
    Check(
        "cutoff at the end of those computed",
        0.0,
        _cutoff_at_limit,
        "q_high reaches the end of the cutoffs that were computed, {low:.3g} to "
        "{high:.3g} rad/m: compute more.",
    ),
    Check(
        "hysteresis above the measured friction",
        0.0,
        _hysteresis_alone,
        "At {above} of {all} points the computed hysteresis alone is above the measured "
        "friction.",
    ),
    Check(
        "rms of the residuals over the error given",
        1.5,
        _misfit,
        "Residuals are {misfit:.2g} times the error given: hysteresis and this law do "
        "not describe the data.",
    ),
    Check(
        "temperatures",
        0.0,
        _if(lambda judged: not judged.warm),
        "Measured at one temperature: how the adhesion shifts with temperature is not "
        "known.",
    ),
)

# --------------------------------------------------------------------------------------
# Whether relaxation agrees with the storage and loss modulus that were measured beside
# it.
#
# Both follow from one spectrum. That of the dynamic moduli alone foretells the relaxation
# modulus at times t with 1/t within their frequencies, and the ratio of what was measured
# to that is 1 in the median, unless a unit, a kind of modulus or the sample differs.
# --------------------------------------------------------------------------------------

_FEWEST = 6  # values of storage and loss modulus of an isotherm that say anything


def relaxation_excess(joint: Joint, limit: float = CONTRADICTION) -> float | None:
    """By which factor relaxation is above what storage and loss modulus make of it;
    None where they agree within a factor of `limit`, or where nothing is to be compared.

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
            return ratio if max(ratio, 1 / ratio) > limit else None
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
