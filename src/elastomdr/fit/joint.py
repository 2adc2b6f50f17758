"""The joint fit of all isotherms, and its shift factors at any reference
temperature.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from ..material.shift import AbstractShift
from .fast_end import hidden, skewed
from .given_law import log10_a
from .isotherms import Isotherms, alike, own_noise
from .laws import LawFit, fit_laws
from .reference import Place, locate, of_law
from .shifting import LN10, Shifts, guess_shifts, join
from .thermometer import slopes, thermometer

# what a gap between isotherms adds to the standard deviation of the step across it, per
# decade beyond
_GAP = 0.15
# of ln(rate) within an isotherm, from which its level says something
_RANGE = float(np.log(2.0))
# by how much vertical shifts may differ from entropy elasticity and still be taken for
# it, relatively
_EVEN = 0.02
_BRIDGED = 1.0  # the width that a smooth spectrum bridges [decades]


class Doubt(NamedTuple):
    """One direction of uncertainty of log10 a_T that the posterior does not contain,
    one standard deviation long.
    """

    by_isotherm: np.ndarray  # (n,) [decades]
    # by how much the common curve moves along with the isotherms [decades],
    size: float
    between: tuple[float, float]  # at these ln(rate) at the anchor's temperature
    # whether a law may miss the shift factors along it; False: it has to follow them
    of_law: bool = True


class Joint(NamedTuple):
    """The most probable shifts and spectrum, and by how much their covariance falls
    short of the truth.
    """

    shifts: Shifts
    # of the choice of shift model, and of gaps between isotherms
    doubts: tuple[Doubt, ...]
    # by which the covariance has grown since residuals along an isotherm resemble each
    # other
    inflation: float
    # scatter about the common curve over that of each isotherm about a smooth curve of
    # its own
    misfit: float
    plain: Shifts  # without a vertical part
    weight: float  # that the data leave to it
    # that the shifts follow exactly, since the user gave it
    law: AbstractShift | None = None
    # standard error of an isotherm's temperature [K]; None: found from its scatter
    thermometer: float | None = None


class AtReference(NamedTuple):
    """Shifts about a reference temperature."""

    log10_a: np.ndarray
    covariance: np.ndarray  # of log10_a
    ln_b: np.ndarray
    ln_b_std: np.ndarray
    place: Place  # of the reference temperature among the isotherms
    level: np.ndarray  # takes the unknowns to ln b at the reference temperature
    laws: dict[str, LawFit]
    thermometer: float  # standard error of an isotherm's temperature [K]


def fit_jointly(
    data: Isotherms,
    vertical: bool,
    law: AbstractShift | None = None,
    thermometer: float | None = None,
) -> Joint:
    """Shifts without a vertical part first, then with one, starting from that answer.

    The choice between both enters the uncertainty with the weight that the data leave
    to the simpler one; data count for less where their misfit is not noise. With a
    `law` the shifts are those of the law.
    """
    if law is not None:
        return _along(law, data, vertical)
    guess = guess_shifts(data.points, data.temperature)
    plain = join(
        _with_offsets(data, guess).points, data.temperature, guess, "none", roughly=True
    )
    found = plain.horizontal(plain.posterior.mean)[0]
    points, several = _with_offsets(data, found).points, data.temperature.size > 1
    both = vertical and several
    lift = "free" if both else "none"
    shifts = (
        join(points, data.temperature, found, lift, near=plain, roughly=True)
        if both
        else plain
    )
    temper = alike(shifts.points, shifts.posterior.residuals)
    shifts = join(points, data.temperature, found, lift, temper, near=shifts)
    plain = (
        join(points, data.temperature, found, "none", temper, near=plain)
        if both
        else shifts
    )
    misfit = _misfit(shifts)
    gain = (shifts.posterior.evidence - plain.posterior.evidence) / max(
        1.0, misfit
    ) ** 2
    weight = 1 / (1 + np.exp(np.clip(gain, -50, 50)))
    here, there = (s.horizontal(s.posterior.mean)[0] for s in (shifts, plain))
    difference = (there - there[shifts.anchor]) - (here - here[shifts.anchor])
    choice = Doubt(np.sqrt(weight) * difference, 0.0, (np.inf, np.inf))
    return Joint(
        shifts,
        (choice, *_gaps(shifts)),
        temper,
        misfit,
        plain,
        float(weight),
        None,
        thermometer,
    )


def rough_shifts(
    data: Isotherms, law: AbstractShift | None, near: Shifts | None = None
) -> Shifts:
    """Shifts and spectrum of isotherms without a vertical part, roughly; `near` is a
    fit of nearly the same data.
    """
    if law is not None:
        x = log10_a(law, data.temperature)
    elif near is None:
        x = guess_shifts(data.points, data.temperature)
    else:
        x = near.horizontal(near.posterior.mean)[0]
        data = _with_offsets(data, x)
    near = (
        near
        if near is not None and near.points.channel.size == data.points.channel.size
        else None
    )
    return join(
        data.points,
        data.temperature,
        x,
        "none",
        near=near,
        roughly=True,
        fixed=law is not None,
    )


def _along(law: AbstractShift, data: Isotherms, vertical: bool) -> Joint:
    """The spectrum, and vertical shifts, along a law."""
    x, points = log10_a(law, data.temperature), data.points
    slow, fast = (np.full(data.temperature.size, end) for end in (np.inf, -np.inf))
    np.minimum.at(slow, points.isotherm, points.log_rate)
    np.maximum.at(fast, points.isotherm, points.log_rate)
    both = (
        vertical
        and data.temperature.size > 1
        and float(np.median(fast - slow)) > _RANGE
    )
    plain = join(points, data.temperature, x, "none", roughly=True, fixed=True)
    temper = alike(points, plain.posterior.residuals)
    plain = join(points, data.temperature, x, "none", temper, near=plain, fixed=True)
    shifts = (
        join(points, data.temperature, x, "free", temper, near=plain, fixed=True)
        if both
        else plain
    )
    misfit = _misfit(shifts)
    gain = (shifts.posterior.evidence - plain.posterior.evidence) / max(
        1.0, misfit
    ) ** 2
    return Joint(
        shifts,
        (),
        temper,
        misfit,
        plain,
        float(1 / (1 + np.exp(np.clip(gain, -50, 50)))),
        law,
    )


def without_vertical(joint: Joint) -> Joint:
    """The fit of the same isotherms that has no vertical part; what that changes is in
    the uncertainty.
    """
    if joint.law is not None:
        return joint._replace(
            shifts=joint.plain, misfit=_misfit(joint.plain), weight=1.0
        )
    plain = joint.plain
    temper = alike(plain.points, plain.posterior.residuals)
    x, lifted = (s.horizontal(s.posterior.mean)[0] for s in (plain, joint.shifts))
    plain = join(plain.points, plain.temperature, x, "none", temper, near=plain)
    x = plain.horizontal(plain.posterior.mean)[0]
    difference = (lifted - lifted[plain.anchor]) - (x - x[plain.anchor])
    choice = Doubt(
        np.sqrt(1 - joint.weight) * difference, 0.0, (np.inf, np.inf), of_law=False
    )
    return Joint(
        plain,
        (choice, *_gaps(plain)),
        temper,
        _misfit(plain),
        plain,
        1.0,
        None,
        joint.thermometer,
    )


def entropic(joint: Joint) -> Joint | None:
    """The fit of the same isotherms with the vertical shifts of entropy elasticity;
    None where data ask for others.

    What other shifts would change is in the uncertainty, with the weight that their
    evidence leaves them.
    """
    free = joint.shifts
    x = free.horizontal(free.posterior.mean)[0]
    law = joint.law is not None
    shifts = join(
        free.points,
        free.temperature,
        x,
        "entropic",
        joint.inflation,
        near=free,
        fixed=law,
    )
    gain = (shifts.posterior.evidence - free.posterior.evidence) / max(
        1.0, joint.misfit
    ) ** 2
    lift, lifted = (
        shifts.vertical() @ shifts.posterior.mean,
        free.vertical() @ free.posterior.mean,
    )
    if gain < 0 and np.ptp(lifted - lift) > _EVEN:
        return None
    here = shifts.horizontal(shifts.posterior.mean)[0]
    difference = (x - x[shifts.anchor]) - (here - here[shifts.anchor])
    other = 1 / (1 + np.exp(np.clip(gain, -50, 50)))
    choice = Doubt(np.sqrt(other) * difference, 0.0, (np.inf, np.inf))
    return joint._replace(
        shifts=shifts,
        doubts=() if law else (choice, *_gaps(shifts)),
        misfit=_misfit(shifts),
    )


def about(joint: Joint, reference: float) -> AtReference:
    """Shifts about a reference temperature [K], through the laws where it is not that
    of an isotherm.
    """
    shifts = joint.shifts
    p, n, temperature = shifts.posterior.mean, shifts.size, shifts.temperature
    covariance = shifts.posterior.covariance
    x, by_x = shifts.horizontal(p)
    spread = by_x @ covariance @ by_x.T + _outer(
        (d.by_isotherm * d.of_law for d in joint.doubts), n
    )
    error = joint.thermometer if joint.thermometer is not None else 0.0
    if n > 1 and joint.thermometer is None and joint.law is None:
        error = thermometer(
            temperature,
            x,
            spread + _outer((d.by_isotherm * (not d.of_law) for d in joint.doubts), n),
        )
    spread = spread + np.diag((error * slopes(temperature, x)) ** 2)
    if joint.law is None:
        place = locate(temperature, x, spread, reference)
    else:
        step = log10_a(joint.law, np.array([reference])) - log10_a(
            joint.law, temperature[[shifts.anchor]]
        )
        place = of_law(float(x[shifts.anchor] + step[0]), temperature, reference)
    change = np.eye(n) - place.weights
    laws_own = change @ spread @ change.T + place.variance
    full = (
        laws_own
        + change
        @ _outer((d.by_isotherm * (not d.of_law) for d in joint.doubts), n)
        @ change.T
    )
    shifted = x - place.log10_a
    # of the reference: the free part is that of the isotherms nearby,
    level = place.near @ shifts.vertical()
    # entropy elasticity its own
    level[shifts.slopes.stop] = np.log(temperature[shifts.anchor] / reference)
    lift = shifts.vertical() - level
    std = np.sqrt(np.maximum(np.diag(lift @ covariance @ lift.T), 0.0))
    laws = (
        fit_laws(temperature, shifted, laws_own, reference)
        if n >= 2 and joint.law is None
        else {}
    )
    return AtReference(shifted, full, lift @ p, std, place, level, laws, error)


class Sensitivity(NamedTuple):
    """ln of the common curve at the reference temperature, and what moves it."""

    log_value: np.ndarray
    by_unknowns: np.ndarray  # its derivatives by the unknowns of the posterior
    # by independent standard normal numbers: of the reference, of each thermometer,
    # each doubt
    by_others: np.ndarray


def curve(
    joint: Joint, reference: AtReference, log_rate: np.ndarray, channel: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """ln of the common curve at the reference temperature, and its standard deviation,
    at ln(omega) or ln(1/t).
    """
    at = sensitivity(joint, reference, log_rate, channel)
    variance = np.einsum(
        "ij,jk,ik->i", at.by_unknowns, joint.shifts.posterior.covariance, at.by_unknowns
    )
    variance += (at.by_others**2).sum(axis=1)
    return at.log_value, np.sqrt(np.maximum(variance, 0.0))


def sensitivity(
    joint: Joint, reference: AtReference, log_rate: np.ndarray, channel: np.ndarray
) -> Sensitivity:
    """The common curve and what it depends on, at ln(omega) or ln(1/t)."""
    shifts = joint.shifts
    p = shifts.posterior.mean
    x, by_x = shifts.horizontal(p)
    weights = reference.place.weights
    here = float(x[shifts.anchor] - reference.log10_a[shifts.anchor])
    level = float(reference.level @ p)
    at_anchor = log_rate + LN10 * here
    answer = shifts.predict(p, channel, at_anchor)
    jacobian = LN10 * answer.by_rate[:, None] * (weights @ by_x) - reference.level
    reduced = shifts.points.log_rate + LN10 * (
        x[shifts.points.isotherm] + shifts.points.offset
    )
    unmeasured = hidden(shifts.points, reduced, shifts.log_times)
    std = np.sqrt(np.diag(shifts.posterior.covariance)[shifts.spectrum])
    jacobian[:, shifts.spectrum] += answer.by_neighbours * np.where(
        unmeasured, skewed(std), 1.0
    )
    jacobian[:, shifts.equilibrium] += answer.by_equilibrium
    jacobian[:, shifts.places] += answer.by_place
    steps = [np.full(log_rate.size, np.sqrt(reference.place.variance))]
    steps += [
        np.full(log_rate.size, size)
        for size in weights * reference.thermometer * slopes(shifts.temperature, x)
    ]
    for doubt in joint.doubts:
        along = doubt.size * (
            (at_anchor > doubt.between[0]) & (at_anchor < doubt.between[1])
        )
        steps.append(weights @ doubt.by_isotherm - along)
    return Sensitivity(
        answer.log_value - level,
        jacobian,
        LN10 * answer.by_rate[:, None] * np.stack(steps, axis=1),
    )


def moved(
    joint: Joint, reference: AtReference
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What moves log10 a_T about the reference temperature, as in `Sensitivity`, and ln
    b by the unknowns.
    """
    shifts, place = joint.shifts, reference.place
    x, by_x = shifts.horizontal(shifts.posterior.mean)
    change = np.eye(shifts.size) - place.weights
    thermal = change * (reference.thermometer * slopes(shifts.temperature, x))
    own = np.full((shifts.size, 1), -np.sqrt(place.variance))
    doubts = [(change @ doubt.by_isotherm)[:, None] for doubt in joint.doubts]
    return (
        change @ by_x,
        np.hstack([own, thermal, *doubts]),
        shifts.vertical() - reference.level,
    )


def _gaps(shifts: Shifts) -> Iterator[Doubt]:
    """What rests on the smoothness of the spectrum alone: the steps between isotherms
    that do not overlap.
    """
    points, log10_a = shifts.points, shifts.horizontal(shifts.posterior.mean)[0]
    rate = points.log_rate + LN10 * (log10_a[points.isotherm] + points.offset)
    numbers = np.arange(shifts.size)
    low, high = (
        np.array([end(rate[points.isotherm == i]) for i in numbers])
        for end in (np.min, np.max)
    )
    for i in range(shifts.size - 1):
        size = _GAP * ((low[: i + 1].min() - high[i + 1 :].max()) / LN10 - _BRIDGED)
        if size > 0 and i < shifts.anchor:
            yield Doubt(
                np.where(numbers <= i, size, 0.0), size, (high[i + 1 :].max(), np.inf)
            )
        elif size > 0:
            yield Doubt(
                np.where(numbers > i, size, 0.0), size, (-np.inf, low[: i + 1].min())
            )


def _outer(vectors: Iterable[np.ndarray], n: int) -> np.ndarray:
    return sum((np.outer(vector, vector) for vector in vectors), np.zeros((n, n)))


def _with_offsets(data: Isotherms, log10_a: np.ndarray) -> Isotherms:
    """The same data with what the shift law makes of each point's distance from its
    isotherm's mean temperature.
    """
    if data.temperature.size < 2:
        return data
    slope = np.gradient(log10_a, data.temperature)
    offset = slope[data.points.isotherm] * data.deviation
    return data._replace(points=data.points._replace(offset=offset))


def _misfit(shifts: Shifts) -> float:
    """Scatter about the common curve over that of each isotherm about a smooth curve of
    its own, at most of moduli.
    """
    alone, channels = own_noise(shifts.points), np.unique(shifts.points.channel)
    ratios = [
        shifts.posterior.noise[c] / max(alone[c], 1e-4)
        for c in channels
        if np.isfinite(alone[c])
    ]
    return float(max(ratios, default=1.0))
