"""The joint fit of spectrum and shift factors: shifts, their posterior at any reference
temperature, and whether horizontal and vertical shifts can be separated.
"""

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from ..material.shift import AbstractShift
from .isotherms import Isotherms, alike, own_noise
from .laws import (
    LawFit,
    ReferencePlace,
    fit_laws,
    locate,
    log10_a,
    of_law,
    slopes,
    temperature_error,
)
from .spectrum import (
    GAIN,
    LOSS,
    PER_DECADE,
    SETTLED,
    MeasuredPoints,
    Posterior,
    Prediction,
    Prior,
    early,
    hidden,
    infer,
    nodes,
    predict,
    skewed,
)

# --------------------------------------------------------------------------------------
# Shift factors of isotherms, found jointly with the smooth spectrum that all of them
# share.
#
# An isotherm i is predicted from the spectrum at the anchor isotherm's temperature T_a by
#
#     b_i M(omega; T_i) = M_a(omega a_i),     ln b_i = s ln(T_a/T_i) + delta_i,
#
# M any of storage, loss and relaxation modulus. s = 1 is the elasticity of entropy of a
# rubber or melt, s = 0 no vertical shift; its prior covers both, and the free part
# delta_i is as wide as the data ask for. Shift factors fall as the temperature rises: the
# unknowns are logarithms of the slopes -d(log10 a_T)/dT between neighbours, which are
# expected to change slowly, how slowly the data decide. All isotherms are fitted at once:
# their order does not matter.
# --------------------------------------------------------------------------------------

LN10 = float(np.log(10.0))
_ENTROPY = (0.5, 0.75)  # mean and width of s
# vertical shifts: none, those of entropy elasticity, or what data ask for
Lift = Literal["none", "entropic", "free"]
_FREE = (0.003, 0.3)  # limits of the standard deviation of delta_i
_FIXED = 1e-5  # width of a prior that fixes an unknown
_SLOPE = np.log(0.06)  # usual -d(log10 a_T)/dT of rubbers and melts [1/K]
_LEAST = 0.03  # least slope to begin with [1/K]
_FLAT = 1e-6  # and of a law that is given
_BIN = 0.5  # decades of time from which a first slope of relaxation is taken,
_LEAST_FALL = 1e-3  # and the least one, -d(ln G)/d(ln t)
_BEND = -0.012  # usual d(ln slope)/dT: that of WLF laws 150 K above their pole [1/K]
_CHANGE = (0.1, 0.4)  # limits of the standard deviation of ln(slope ratio) over 10 K
# limits of the standard deviation of the second difference of ln H_k
_CURVATURE = (0.04, 3.0)
# by how much of their spacing times may be off the grid: a sharp line may lie between
# two
_PLACE = (0.6, 1.5)
_ROUGH = (0.5, 0.2)  # gain of a step, and change of widths, at which a first fit stops
# Relaxation above a plateau may tell so little of its spectrum that noise decides how
# smooth it seems: what is usual of second differences, and how many of them that counts
# for.
_USUAL_CURVATURE = (0.5, 4.0)
_USUAL_CHANGE = (0.2, 2.0)
# wider than most probable: one width for all times smooths away what is sharper than
# the average
_LOOSEN = 1.5


class Shifts(NamedTuple):
    """The joint posterior of spectrum and shifts; `layout` says where in the unknowns
    each of them is.
    """

    posterior: Posterior
    log_times: np.ndarray  # ln tau_k at the anchor's temperature
    temperature: np.ndarray  # of the isotherms, ascending [K]
    anchor: int
    points: MeasuredPoints

    @property
    def size(self) -> int:
        return self.temperature.size

    @property
    def spectrum(self) -> slice:
        return slice(0, self.log_times.size)

    @property
    def equilibrium(self) -> int:
        return self.log_times.size

    @property
    def slopes(self) -> slice:
        """ln of -d(log10 a_T)/dT between neighbours."""
        start = self.log_times.size + 1
        return slice(start, start + self.size - 1)

    def predict(
        self, p: np.ndarray, channel: np.ndarray, log_rate: np.ndarray
    ) -> Prediction:
        """What the spectrum predicts at the anchor's temperature."""
        log_times = self.log_times + p[self.places]
        return predict(
            channel, log_rate, log_times, p[self.spectrum], np.exp(p[self.equilibrium])
        )

    def horizontal(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """log10 a_i, and its derivatives with respect to all unknowns."""
        log10_a, by_slope = from_slopes(p[self.slopes], self.temperature, self.anchor)
        jacobian = np.zeros((self.size, p.size))
        jacobian[:, self.slopes] = by_slope
        return log10_a, jacobian

    @property
    def places(self) -> slice:
        """By how much each ln tau_k is off its place on the grid."""
        start = self.slopes.stop + 1 + self.size
        return slice(start, start + self.log_times.size)

    def vertical(self) -> np.ndarray:
        """Matrix that takes the unknowns to ln b_i."""
        start = self.slopes.stop
        matrix = np.zeros((self.size, self.places.stop))
        matrix[:, start] = np.log(self.temperature[self.anchor] / self.temperature)
        matrix[:, start + 1 : self.places.start] = np.eye(self.size)
        return matrix


def from_slopes(
    log_slopes: np.ndarray, temperature: np.ndarray, anchor: int
) -> tuple[np.ndarray, np.ndarray]:
    """log10 a_i about an isotherm, and its derivatives, from ln of -d(log10 a_T)/dT
    between neighbours.
    """
    by_slope = np.zeros((temperature.size, temperature.size - 1))
    steps = np.exp(log_slopes) * np.diff(temperature)
    for i in range(anchor):
        by_slope[i, i:anchor] = steps[i:anchor]
    for i in range(anchor + 1, temperature.size):
        by_slope[i, anchor:i] = -steps[anchor:i]
    return by_slope.sum(axis=1), by_slope


def slope_priors(
    slopes: np.ndarray, temperature: np.ndarray, usual: tuple[float, float] = (0.0, 0.0)
) -> list[Prior]:
    """What is expected of ln slopes: their size, and that they change slowly; `slopes`
    picks them from the unknowns.
    """
    gap = np.sqrt(np.diff(0.5 * (temperature[1:] + temperature[:-1])) / 10.0)
    change = np.diff(slopes, axis=0) / gap[:, None]
    return [
        Prior(slopes, 1.5, None, _SLOPE),
        Prior(change, 0.2, _CHANGE, 10.0 * _BEND * gap, usual=usual),
    ]


def first_slopes(
    guess: np.ndarray, temperature: np.ndarray, least: float = _LEAST
) -> np.ndarray:
    """ln slopes to begin with, from a guess of log10 a_i."""
    return np.log(np.maximum(-np.diff(guess) / np.diff(temperature), least))


def _held(rows: np.ndarray, target: np.ndarray) -> Prior:
    """Unknowns that stay where they are."""
    return Prior(rows, _FIXED, None, target)


def join(
    points: MeasuredPoints,
    temperature: np.ndarray,
    first_guess: np.ndarray,
    vertical: Lift,
    temper: float = 1.0,
    near: Shifts | None = None,
    roughly: bool = False,
    fixed: bool = False,
) -> Shifts:
    """The most probable shifts and spectrum of isotherms at ascending temperatures [K];
    `temper` as for `infer`.

    `near` is a fit of nearly the same points: the search begins at its answer, noise
    and roughness, but not at the widths that it gave to the shifts, which would hold
    them where it had them. `roughly` stops early: such a fit is there to begin another
    one. `fixed` keeps the shifts of the first guess.
    """
    anchor = _anchor(points, first_guess)
    guess = first_guess - first_guess[anchor]
    reduced = points.log_rate + LN10 * (guess[points.isotherm] + points.offset)
    log_times = nodes(reduced)
    shifts = Shifts(None, log_times, temperature, anchor, points)  # type: ignore[arg-type]
    n = shifts.places.stop
    start = _start(shifts, guess, reduced, fixed)
    noise, roughness = np.full(3, 0.03), 0.6 / PER_DECADE
    if near is not None:
        _begin(start, shifts, near)
        noise, roughness = near.posterior.noise, near.posterior.widths[0]
    model = partial(_model, shifts, shifts.vertical()[points.isotherm])
    posterior = infer(
        model,
        points.log_value,
        points.channel,
        start,
        _priors(
            shifts,
            start,
            vertical,
            roughness,
            early(points, reduced, log_times, n),
            fixed,
        ),
        noise,
        temper=temper,
        wary=lambda p: model(p, wary=True)[1](),
        gain=_ROUGH[0] if roughly else GAIN,
        settled_at=_ROUGH[1] if roughly else SETTLED,
    )
    return shifts._replace(posterior=posterior)


def _start(
    shifts: Shifts, guess: np.ndarray, reduced: np.ndarray, fixed: bool
) -> np.ndarray:
    """Spectrum, equilibrium modulus and slopes to begin with."""
    points = shifts.points
    start = np.zeros(shifts.places.stop)
    start[shifts.spectrum] = _first_spectrum(points, reduced, shifts.log_times)
    without_loss = points.log_value[points.channel != LOSS]
    lowest = without_loss if without_loss.size else points.log_value
    start[shifts.equilibrium] = lowest.min() - 1.0
    least = _FLAT if fixed else _LEAST
    start[shifts.slopes] = first_slopes(guess, shifts.temperature, least)
    return start


def _model(
    shifts: Shifts, lifted: np.ndarray, p: np.ndarray, wary: bool = False
) -> tuple[np.ndarray, Callable[[], np.ndarray]]:
    """ln of the moduli at the points, and what makes its Jacobian; `lifted` are the
    derivatives of the points' vertical shifts.
    """
    points = shifts.points
    vertical_part = slice(shifts.slopes.stop, shifts.places.start)
    log10_a, by_slope = from_slopes(p[shifts.slopes], shifts.temperature, shifts.anchor)
    rate = points.log_rate + LN10 * (log10_a[points.isotherm] + points.offset)
    answer = shifts.predict(p, points.channel, rate)

    def jacobian() -> np.ndarray:
        matrix = np.empty((points.channel.size, p.size))
        matrix[:, shifts.spectrum] = (
            answer.by_neighbours if wary else answer.by_spectrum
        )
        matrix[:, shifts.equilibrium] = answer.by_equilibrium
        matrix[:, shifts.slopes] = (
            LN10 * answer.by_rate[:, None] * by_slope[points.isotherm]
        )
        matrix[:, vertical_part] = -lifted[:, vertical_part]
        matrix[:, shifts.places] = answer.by_place
        return matrix

    return answer.log_value - lifted @ p, jacobian


def _priors(
    shifts: Shifts,
    start: np.ndarray,
    vertical: Lift,
    roughness: float,
    fast: list[Prior],
    fixed: bool,
) -> list[Prior]:
    """The first of them is that of the spectrum's smoothness, `roughness` its width to
    begin with.
    """
    n, k = start.size, shifts.log_times.size
    every = np.eye(n)
    second = np.zeros((k - 2, n))
    second[:, :k] = np.diff(np.eye(k), 2, axis=0)
    # the first times, of which little is seen
    hidden = sum(prior.rows.shape[0] for prior in fast)
    second = second[max(hidden - 1, 0) :]
    slopes, entropy = every[shifts.slopes], shifts.slopes.stop
    blind = not (shifts.points.channel == LOSS).any()
    curvature, change = (
        (_USUAL_CURVATURE, _USUAL_CHANGE) if blind else ((0.0, 0.0), (0.0, 0.0))
    )
    # Relaxation shows lines worse than a loss modulus does: how far off the grid they
    # are has to be learnt from all.
    near, far = (LN10 / PER_DECADE * spacings for spacings in _PLACE)
    free, is_free = every[entropy + 1 : shifts.places.start], vertical == "free"
    mean, width = _ENTROPY if is_free else (float(vertical == "entropic"), _FIXED)
    return [
        Prior(second, roughness, _CURVATURE, 0.0, _LOOSEN, curvature),
        Prior(every[shifts.spectrum], 12.0, None, start[shifts.spectrum].mean()),
        Prior(every[[shifts.equilibrium]], 3.0, None, start[shifts.equilibrium]),
        *(
            [_held(slopes, start[shifts.slopes])]
            if fixed
            else slope_priors(slopes, shifts.temperature, change)
        ),
        Prior(every[[entropy]], width, None, mean),
        Prior(every[shifts.places], near, (near, far) if blind else None),
        Prior(free, 0.01 if is_free else _FIXED, _FREE if is_free else None),
        *fast,
    ]


def _begin(start: np.ndarray, shifts: Shifts, near: Shifts) -> None:
    """Fills in what another fit found; its spectrum is moved where times or anchor are
    others.
    """
    p = near.posterior.mean
    if near.anchor == shifts.anchor and np.array_equal(
        near.log_times, shifts.log_times
    ):
        start[:] = p
        return
    moved = near.log_times + LN10 * near.horizontal(p)[0][shifts.anchor]
    start[shifts.spectrum] = np.interp(shifts.log_times, moved, p[near.spectrum])
    start[shifts.slopes], start[shifts.equilibrium] = (
        p[near.slopes],
        p[near.equilibrium],
    )


def _anchor(points: MeasuredPoints, guess: np.ndarray) -> int:
    """The isotherm nearest to the middle of the reduced frequencies."""
    reduced = points.log_rate + LN10 * guess[points.isotherm]
    middle = 0.5 * (reduced.min() + reduced.max())
    centres = [reduced[points.isotherm == i].mean() for i in range(guess.size)]
    return int(np.argmin(np.abs(np.array(centres) - middle)))


def _first_spectrum(
    points: MeasuredPoints, reduced: np.ndarray, log_times: np.ndarray
) -> np.ndarray:
    """ln H_k from the loss modulus, H = (2/pi) G'' per unit of ln tau, or from
    relaxation, H = -dG/d(ln t).

    Relaxation that has come to an end must begin without slow times: beside an
    equilibrium modulus that is too low they would stay, and bend the slow edge.
    """
    width = np.log(LN10 / PER_DECADE)
    is_loss = points.channel == LOSS
    if is_loss.any():
        order = np.argsort(-reduced[is_loss])
        return (
            np.interp(
                log_times, -reduced[is_loss][order], points.log_value[is_loss][order]
            )
            + np.log(2 / np.pi)
            + width
        )
    bins = np.floor((reduced.max() - reduced) / (_BIN * LN10)).astype(int)
    log_time, log_modulus = (
        np.bincount(bins, of) for of in (-reduced, points.log_value)
    )
    count = np.bincount(bins)
    log_time = log_time[count > 0] / count[count > 0]
    log_modulus = log_modulus[count > 0] / count[count > 0]
    fall = (
        -np.gradient(log_modulus, log_time)
        if log_modulus.size > 1
        else np.array([_LEAST_FALL])
    )
    return (
        np.interp(
            log_times, log_time, log_modulus + np.log(np.maximum(fall, _LEAST_FALL))
        )
        + width
    )


def guess_shifts(points: MeasuredPoints, temperature: np.ndarray) -> np.ndarray:
    """log10 a_i to begin with, from neighbours in temperature: the shift that makes
    both one smooth curve.
    """
    guess = np.zeros(temperature.size)
    for i in range(temperature.size - 2, -1, -1):
        guess[i] = guess[i + 1] + _pair(
            points, i, i + 1, temperature[i + 1] - temperature[i]
        )
    return guess


def _pair(points: MeasuredPoints, cold: int, warm: int, gap: float) -> float:
    """log10(a_cold/a_warm) by least squares of polynomials in ln omega, one per
    channel, over a grid of shifts.
    """
    grid = np.arange(-0.5, max(4.0, 0.6 * gap), 0.05)
    chosen = (points.isotherm == cold) | (points.isotherm == warm)
    rate = points.log_rate[chosen]
    value = points.log_value[chosen]
    channel = points.channel[chosen]
    is_cold = points.isotherm[chosen] == cold
    u = rate + LN10 * grid[:, None] * is_cold  # (grid, points)
    low, high = u.min(axis=1, keepdims=True), u.max(axis=1, keepdims=True)
    u = 2 * (u - low) / np.maximum(high - low, 1e-9) - 1
    kinds = np.unique(channel)
    design = np.zeros((*u.shape, 1 + 6 * kinds.size))
    design[..., 0] = is_cold  # a vertical offset, held small below
    for k, which in enumerate(kinds):
        of_channel = channel == which
        design[:, of_channel, 1 + 6 * k : 7 + 6 * k] = np.vander(
            u[:, of_channel].ravel(), 6, increasing=True
        ).reshape(len(u), -1, 6)
    ridge = np.array([1e2] + [1e-8, 1e-8, 1e-8, 1e-6, 1e-4, 1e-2] * kinds.size)
    normal = design.swapaxes(1, 2) @ design + np.diag(ridge)
    right = value @ design
    solution = np.linalg.solve(normal, right[..., None])[..., 0]
    error = ((design @ solution[..., None])[..., 0] - value) ** 2
    misfit = error.sum(axis=1) + (ridge * solution**2).sum(axis=1)
    usual = 0.06 * gap  # decades per kelvin, where the data say nothing
    penalty = (
        value.size * np.log(misfit / value.size + 1e-6) + ((grid - usual) / 2.0) ** 2
    )
    return float(grid[np.argmin(penalty)])


# --------------------------------------------------------------------------------------
# The joint fit of all isotherms, and its shift factors at any reference
# temperature.
# --------------------------------------------------------------------------------------

# what a gap between isotherms adds to the standard deviation of the step across it, per
# decade beyond
_GAP = 0.15
# of ln(rate) within an isotherm, from which its level says something
_RANGE = float(np.log(2.0))
# by how much vertical shifts may differ from entropy elasticity and still be taken for
# it, relatively
_EVEN = 0.02
_BRIDGED = 1.0  # the width that a smooth spectrum bridges [decades]


class ShiftDirection(NamedTuple):
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
    doubts: tuple[ShiftDirection, ...]
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
    temperature_error: float | None = None


class AtReference(NamedTuple):
    """Shifts about a reference temperature."""

    log10_a: np.ndarray
    covariance: np.ndarray  # of log10_a
    ln_b: np.ndarray
    ln_b_std: np.ndarray
    place: ReferencePlace  # of the reference temperature among the isotherms
    # takes the unknowns to ln b at the reference temperature
    ln_b_by_unknowns: np.ndarray
    laws: dict[str, LawFit]
    temperature_error: float  # standard error of an isotherm's temperature [K]


def fit_jointly(
    data: Isotherms,
    vertical: bool,
    law: AbstractShift | None = None,
    temperature_error: float | None = None,
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
    horizontal = plain.horizontal(plain.posterior.mean)[0]
    points, several = _with_offsets(data, horizontal).points, data.temperature.size > 1
    both = vertical and several
    lift = "free" if both else "none"
    shifts = (
        join(points, data.temperature, horizontal, lift, near=plain, roughly=True)
        if both
        else plain
    )
    temper = alike(shifts.points, shifts.posterior.residuals)
    shifts = join(points, data.temperature, horizontal, lift, temper, near=shifts)
    plain = (
        join(points, data.temperature, horizontal, "none", temper, near=plain)
        if both
        else shifts
    )
    misfit = _misfit(shifts)
    gain = (shifts.posterior.evidence - plain.posterior.evidence) / max(
        1.0, misfit
    ) ** 2
    weight = 1 / (1 + np.exp(np.clip(gain, -50, 50)))
    lifted, unlifted = (s.horizontal(s.posterior.mean)[0] for s in (shifts, plain))
    difference = (unlifted - unlifted[shifts.anchor]) - (lifted - lifted[shifts.anchor])
    choice = ShiftDirection(np.sqrt(weight) * difference, 0.0, (np.inf, np.inf))
    return Joint(
        shifts,
        (choice, *_gaps(shifts)),
        temper,
        misfit,
        plain,
        float(weight),
        None,
        temperature_error,
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
    choice = ShiftDirection(
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
        joint.temperature_error,
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
    lift = shifts.vertical() @ shifts.posterior.mean
    lifted = free.vertical() @ free.posterior.mean
    if gain < 0 and np.ptp(lifted - lift) > _EVEN:
        return None
    here = shifts.horizontal(shifts.posterior.mean)[0]
    difference = (x - x[shifts.anchor]) - (here - here[shifts.anchor])
    other = 1 / (1 + np.exp(np.clip(gain, -50, 50)))
    choice = ShiftDirection(np.sqrt(other) * difference, 0.0, (np.inf, np.inf))
    return joint._replace(
        shifts=shifts,
        doubts=() if law else (choice, *_gaps(shifts)),
        misfit=_misfit(shifts),
    )


def at_reference(joint: Joint, reference: float) -> AtReference:
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
    error = joint.temperature_error if joint.temperature_error is not None else 0.0
    if n > 1 and joint.temperature_error is None and joint.law is None:
        error = temperature_error(
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
    log10_a_covariance = (
        laws_own
        + change
        @ _outer((d.by_isotherm * (not d.of_law) for d in joint.doubts), n)
        @ change.T
    )
    shifted = x - place.log10_a
    # of the reference: the free part is that of the isotherms nearby,
    ln_b_by_unknowns = place.near @ shifts.vertical()
    # entropy elasticity its own
    ln_b_by_unknowns[shifts.slopes.stop] = np.log(
        temperature[shifts.anchor] / reference
    )
    lift = shifts.vertical() - ln_b_by_unknowns
    std = np.sqrt(np.maximum(np.diag(lift @ covariance @ lift.T), 0.0))
    laws = (
        fit_laws(temperature, shifted, laws_own, reference)
        if n >= 2 and joint.law is None
        else {}
    )
    return AtReference(
        shifted,
        log10_a_covariance,
        lift @ p,
        std,
        place,
        ln_b_by_unknowns,
        laws,
        error,
    )


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
    sensitive = sensitivity(joint, reference, log_rate, channel)
    variance = np.einsum(
        "ij,jk,ik->i",
        sensitive.by_unknowns,
        joint.shifts.posterior.covariance,
        sensitive.by_unknowns,
    )
    variance += (sensitive.by_others**2).sum(axis=1)
    return sensitive.log_value, np.sqrt(np.maximum(variance, 0.0))


def sensitivity(
    joint: Joint, reference: AtReference, log_rate: np.ndarray, channel: np.ndarray
) -> Sensitivity:
    """The common curve and what it depends on, at ln(omega) or ln(1/t)."""
    shifts = joint.shifts
    p = shifts.posterior.mean
    x, by_x = shifts.horizontal(p)
    weights = reference.place.weights
    here = float(x[shifts.anchor] - reference.log10_a[shifts.anchor])
    ln_b_at_reference = float(reference.ln_b_by_unknowns @ p)
    at_anchor = log_rate + LN10 * here
    answer = shifts.predict(p, channel, at_anchor)
    jacobian = (
        LN10 * answer.by_rate[:, None] * (weights @ by_x) - reference.ln_b_by_unknowns
    )
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
        for size in weights
        * reference.temperature_error
        * slopes(shifts.temperature, x)
    ]
    for doubt in joint.doubts:
        along = doubt.size * (
            (at_anchor > doubt.between[0]) & (at_anchor < doubt.between[1])
        )
        steps.append(weights @ doubt.by_isotherm - along)
    return Sensitivity(
        answer.log_value - ln_b_at_reference,
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
    thermal = change * (reference.temperature_error * slopes(shifts.temperature, x))
    of_place = np.full((shifts.size, 1), -np.sqrt(place.variance))
    doubts = [(change @ doubt.by_isotherm)[:, None] for doubt in joint.doubts]
    return (
        change @ by_x,
        np.hstack([of_place, thermal, *doubts]),
        shifts.vertical() - reference.ln_b_by_unknowns,
    )


def _gaps(shifts: Shifts) -> Iterator[ShiftDirection]:
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
            yield ShiftDirection(
                np.where(numbers <= i, size, 0.0), size, (high[i + 1 :].max(), np.inf)
            )
        elif size > 0:
            yield ShiftDirection(
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


# --------------------------------------------------------------------------------------
# Whether the data separate a horizontal shift from a vertical one.
#
# Where storage and loss modulus are one power law, M ~ omega^n with the same n (a
# constant loss tangent), a shift by x decades along the frequency is one by n x decades
# along the modulus: no data separate them, and only the prior for the vertical shift
# chooses. A slope that changes, or differs between the moduli, separates them.
# --------------------------------------------------------------------------------------

# relative standard deviation of a step between neighbours above which it may not be
# separable
_POOR = 0.12
# relative standard deviation below which a power law is no matter: it is steep
_SLIGHT = 0.05
_EXCHANGED = 0.5  # part of its variance that is exchange with the vertical shifts
# width of the vertical shifts below which there are none: nothing to be separated from
_NO_VERTICAL = 1e-4
# standard deviations by which a misfit of the power law must exceed chance to be a
# landmark
_SURE = 3.0


def separable(joint: Joint) -> np.ndarray:
    """Whether the data separate the horizontal shift of an isotherm, from its neighbour
    on the anchor's side, from b_T.

    They do not where its uncertainty is a fair part of it and would mostly be gone if
    the vertical shifts were known; nor where both isotherms follow one power law within
    their scatter.
    """
    shifts, clear = joint.shifts, np.ones(joint.shifts.size, dtype=bool)
    if shifts.size == 1 or shifts.posterior.widths[-1] < _NO_VERTICAL:
        return clear
    x, by_x = shifts.horizontal(shifts.posterior.mean)
    step_x, step_y = np.diff(by_x, axis=0), np.diff(shifts.vertical(), axis=0)
    covariance = shifts.posterior.covariance
    both = step_x @ covariance @ step_y.T
    known = np.linalg.solve(
        step_y @ covariance @ step_y.T + 1e-12 * np.eye(len(step_y)), both.T
    )
    variance = np.diag(step_x @ covariance @ step_x.T)
    exchanged = np.einsum("ij,ji->i", both, known) / np.maximum(variance, 1e-300)
    relative = np.sqrt(variance) / np.maximum(np.abs(np.diff(x)), 1e-12)
    poor = (relative > _POOR) & (exchanged > _EXCHANGED)
    bare = [
        relative[i] > _SLIGHT and _power_law(shifts, i, joint.inflation)
        for i in range(shifts.size - 1)
    ]
    for i in np.flatnonzero(poor | bare):
        clear[i + 1 if i >= shifts.anchor else i] = False
    return clear


def _power_law(shifts: Shifts, cold: int, alike: float) -> bool:
    """Whether an isotherm and the next one follow one power law, within chance.

    Chi squared of it is compared with that of a parabola in ln omega of its own for
    each modulus.
    """
    points, posterior = shifts.points, shifts.posterior
    chosen = (points.isotherm == cold) | (points.isotherm == cold + 1)
    channel, warm = points.channel[chosen], points.isotherm[chosen] == cold + 1
    log10_a = shifts.horizontal(posterior.mean)[0]
    rate = points.log_rate[chosen] + LN10 * (
        log10_a[points.isotherm[chosen]] + points.offset[chosen]
    )
    rate = rate - rate.mean()
    weight = np.sqrt(posterior.weights[chosen] / alike) / posterior.noise[channel]
    kinds = [channel == which for which in np.unique(channel)]
    levels = [kind & side for kind in kinds for side in (warm, ~warm)]
    misfits = []
    for shapes in ([rate], [kind * rate**k for kind in kinds for k in (1, 2)]):
        design = np.stack([*levels, *shapes], axis=1) * weight[:, None]
        value = points.log_value[chosen] * weight
        off = value - design @ np.linalg.lstsq(design, value, rcond=None)[0]
        misfits.append(float(off @ off))
    freedom = 2 * len(kinds) - 1
    return misfits[0] - misfits[1] < freedom + _SURE * np.sqrt(2 * freedom)
