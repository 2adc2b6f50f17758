"""What cannot be relied on in a master curve or a series, in plain words."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..io.data import describe_list
from .isotherms import contradicting_repeats
from .shifting import LN10, Joint
from .spectrum import CHANNELS, RELAXATION, STORAGE, Points, closest_passive
from .terms import Data, SlowEnd

if TYPE_CHECKING:
    from .master import MasterCurve

# --------------------------------------------------------------------------------------
# Whether relaxation agrees with the storage and loss modulus that were measured beside
# it.
#
# Both follow from one spectrum. That of the dynamic moduli alone foretells the relaxation
# modulus at times t with 1/t within their frequencies, and the ratio of what was measured
# to that is 1 in the median, unless a unit, a kind of modulus or the sample differs.
# --------------------------------------------------------------------------------------

_FEWEST = 6  # values of storage and loss modulus of an isotherm that say anything
_FACTOR = 1.25  # between both, above which they contradict each other


def relaxation_excess(joint: Joint) -> float | None:
    """By which factor relaxation is above what storage and loss modulus make of it;
    None where they agree, or where nothing is to be compared.

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
        found = [
            _excess(rate[at], points.log_value[at], points.channel[at]) for at in each
        ]
        excess = np.concatenate(found)
        if excess.size:
            ratio = float(np.exp(np.median(excess)))
            return ratio if max(ratio, 1 / ratio) > _FACTOR else None
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
    found = closest_passive(
        log_rate[dynamic], log_value[dynamic], channel[dynamic] == STORAGE
    )
    return (
        np.zeros(0)
        if found is None
        else log_value[slow] - found.log_relaxation(log_rate[slow])
    )


# --------------------------------------------------------------------------------------
# What cannot be relied on in a master curve or a series, in plain words.
# --------------------------------------------------------------------------------------

_NOT_SIMPLE = 2.0  # scatter about the common curve over that of the isotherms alone
_WORTH_SAYING = 0.01  # scatter below which a misfit is of no consequence
# half a 95 % interval of an extrapolated shift above which it is no longer of much use
# [decades]
_FAR = 0.3
_NAMED = 6  # outliers that a warning names one by one
_POOR = 0.1  # relative residual of a series worth a warning
# what the choice of shift model may move before it is worth saying [decades]
_CHOICE = 0.1


def judge(master: "MasterCurve") -> tuple[str, ...]:
    """The warnings of a master curve, most important first."""
    repeats = contradicting_repeats(master.dma, master.isotherm, master.temperature)
    # The scatter of measurements that disagree is no isotherm's.
    whole = [*_disagree(master), *repeats] or _simple(master)
    return (
        *_failed(master),
        *whole,
        *_ambiguous(master),
        *_choice(master),
        *_gaps(master),
        *_details(master),
    )


def _failed(master: "MasterCurve") -> Iterator[str]:
    if not master.converged:
        yield (
            "The joint fit did not converge: look at the figure before using anything "
            "of it."
        )


def _disagree(master: "MasterCurve") -> Iterator[str]:
    if ratio := relaxation_excess(master.joint):
        yield (
            "Relaxation and dynamic moduli contradict each other: the relaxation "
            f"modulus is {ratio:.2g} times what "
            "storage and loss modulus make of it (median where both were measured). "
            "Check unit, kind and sample of both measurements; what is fitted to both "
            "is a compromise between them."
        )


def _simple(master: "MasterCurve") -> Iterator[str]:
    misfit, worst = master.joint.misfit, max(master.noise.values())
    if misfit > _NOT_SIMPLE and worst > _WORTH_SAYING and master.temperature.size > 1:
        yield (
            f"Not thermorheologically simple: the isotherms scatter {misfit:.1f} "
            "times as much about one common curve as each about a smooth curve of "
            f"its own ({100 * worst:.2g} % in the worst modulus). No shift makes them "
            "one."
        )


def _ambiguous(master: "MasterCurve") -> Iterator[str]:
    celsius = master.temperature[master.ambiguous] - 273.15
    if celsius.size:
        yield (
            "Horizontal and vertical shift cannot be separated at "
            f"{describe_list(celsius, 'degC')}: the isotherms are "
            "too flat or too much alike there. Their log10 a_T rests on the prior for "
            "the vertical shift; see the intervals, and compare vertical=False "
            "(--no-vertical)."
        )


def _choice(master: "MasterCurve") -> Iterator[str]:
    if master.joint.law is not None:
        return
    choice = master.joint.doubts[0].by_isotherm
    moved = np.abs(choice - np.interp(master.reference, master.temperature, choice))
    if moved.max() > _CHOICE:
        celsius = master.temperature[moved.argmax()] - 273.15
        yield (
            "These data leave open whether there are vertical shifts, which moves "
            "log10 a_T by about "
            f"{moved.max():.2g} decades (at {celsius:.4g} degC); the intervals "
            "contain that."
        )


def _gaps(master: "MasterCurve") -> Iterator[str]:
    if master.joint.law is not None:
        return
    rates = np.concatenate([master.omega, 1 / master.time])
    number = np.concatenate([master.isotherm, master.time_isotherm])
    celsius = master.temperature - 273.15
    lonely = []
    for i in range(celsius.size - 1):
        cold, warm = rates[number == i], rates[number == i + 1]
        if cold.size and warm.size and cold.min() > warm.max():
            lonely.append(
                f"{celsius[i]:.4g} and {celsius[i + 1]:.4g} degC "
                f"({np.log10(cold.min() / warm.max()):.1f} decades)"
            )
    if lonely:
        yield (
            f"Isotherms do not overlap: {', '.join(lonely)}. The shift across the gap "
            "rests on the assumption of a "
            "smooth spectrum."
        )


def _details(master: "MasterCurve") -> Iterator[str]:
    temperature, reference = master.temperature, master.reference
    if temperature.size == 1:
        yield "There is one temperature only: no shift law."
    elif not temperature.min() - 1.5 <= reference <= temperature.max() + 1.5:
        half = master.state.place.half
        yield (
            f"The reference temperature, {reference - 273.15:.4g} degC, lies outside "
            f"the data ({temperature.min() - 273.15:.4g} to "
            f"{temperature.max() - 273.15:.4g} degC): it is reached by extrapolating "
            f"the shift law, which knows that step to +- {half:.2g} decades (95 %). "
            "Every log10 a_T and the band contain "
            f"that{'; give a reference within the data' if half > _FAR else ''}."
        )
    if temperature.size == 2:
        yield (
            "There are two temperatures only: Arrhenius' law can be fitted, WLF and "
            "VFT cannot."
        )
    if copies := master.dma.copies:
        yield (
            f"{copies} of {master.dma.size + copies} points repeat others in all "
            "their numbers, and are left out."
        )
    points, outliers = (
        master.joint.shifts.points,
        np.flatnonzero(master.joint.shifts.posterior.weights < 1),
    )
    if outliers.size:
        names = []
        for i in outliers[:_NAMED]:
            channel, celsius, rate = (
                points.channel[i],
                temperature[points.isotherm[i]] - 273.15,
                points.log_rate[i],
            )
            when = (
                f"{np.exp(-rate):.3g} s"
                if channel == RELAXATION
                else f"{np.exp(rate):.3g} rad/s"
            )
            names.append(f"{CHANNELS[channel]} at {celsius:.4g} degC and {when}")
        yield (
            f"{outliers.size} of {points.log_rate.size} values are outliers (beyond 3 "
            "standard deviations) and count for less: "
            f"{'; '.join(names)}{' ...' if outliers.size > _NAMED else ''}."
        )
    if "WLF" in master.laws and not master.laws["WLF"].holds:
        yield (
            f"The WLF law misses the shift factors by {master.laws['WLF'].rms:.2f} "
            "decades rms, more than they are "
            "uncertain by: use the table of shift factors instead."
        )


def judge_series(
    points: Points,
    residuals: np.ndarray,
    data: Data,
    contradiction: str,
    excess: float | None,
    converged: bool,
) -> Iterator[str]:
    """Warnings on what a series does not meet; single outliers are not held against it.

    `contradiction` says what the closest passive material shows of storage and loss
    modulus, `excess` is that of relaxation and both.
    """
    if not converged:
        yield (
            "The refinement of the times did not converge: look at the figure before "
            "using the series."
        )
    for channel, key in enumerate(("storage", "loss", "relaxation")):
        at = points.channel == channel
        if not at.any():
            continue
        size = float(
            np.sqrt((data.weights * residuals**2)[at].sum() / data.weights[at].sum())
        )
        if size <= _POOR:
            continue
        met = f"The {key} modulus is met to {100 * size:.2g} % rms only"
        if excess is not None:
            yield (
                f"{met}: relaxation and dynamic moduli contradict each other, by a "
                f"factor of {max(excess, 1 / excess):.2g}."
            )
        elif contradiction:
            yield f"{met}{contradiction}"
        elif size > 1.5 * data.noise[channel]:
            yield f"{met}; more terms may help (terms=...)."
        else:
            yield f"{met}, by which the data scatter."


def judge_level(
    level: float, end: SlowEnd, interval: tuple[float, float]
) -> Iterator[str]:
    """Whether the data say where the equilibrium modulus is, or only where they end."""
    if level and end.open:
        yield (
            f"The {end.kind} modulus still falls at the slow end of the data "
            f"({end.rate:.3g} rad/s): where they end sets the equilibrium modulus, "
            f"{level:.4g} Pa; they allow {interval[0]:.3g} to {interval[1]:.3g} Pa."
        )


def judge_range(limits: tuple[float, ...], dynamic: np.ndarray) -> Iterator[str]:
    """Whether there is a range of frequencies at all, and one of all `dynamic` data
    [rad/s].
    """
    if (
        limits
        and dynamic.size
        and (dynamic.min() < 0.99 * limits[0] or dynamic.max() > 1.01 * limits[1])
    ):
        yield (
            "The data leave a gap in which the loss modulus is not known to 6 %: the "
            f"range of the material is the widest part beside it, {limits[0]:.3g} to "
            f"{limits[1]:.3g} rad/s of {dynamic.min():.3g} to {dynamic.max():.3g}. "
            "Measure between them, or closer isotherms."
        )
    if not limits:
        yield (
            "Relaxation with so little fall, or so much noise, determines the loss "
            "modulus at no frequency: the range of the material is empty, and all "
            "friction from it is flagged as extrapolated. Measure dynamic moduli."
        )
