"""Shift factors of isotherms, found jointly with the smooth spectrum that all of them
share.

An isotherm i is predicted from the spectrum at the anchor isotherm's temperature T_a by

    b_i M(omega; T_i) = M_a(omega a_i),     ln b_i = s ln(T_a/T_i) + delta_i,

M any of storage, loss and relaxation modulus. s = 1 is the elasticity of entropy of a
rubber or melt, s = 0 no vertical shift; its prior covers both, and the free part
delta_i is as wide as the data ask for. Shift factors fall as the temperature rises: the
unknowns are logarithms of the slopes -d(log10 a_T)/dT between neighbours, which are
expected to change slowly, how slowly the data decide. All isotherms are fitted at once:
their order does not matter.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from .fast_end import early
from .posterior import GAIN, SETTLED, Posterior, Prior, infer
from .spectrum import LOSS, PER_DECADE, Points, Prediction, nodes, predict

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
    points: Points

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
    points: Points,
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
    lift, n = shifts.vertical(), shifts.places.stop
    start = np.zeros(n)
    start[shifts.spectrum] = _first_spectrum(points, reduced, log_times)
    lowest = (
        points.log_value[points.channel != LOSS].min()
        if (points.channel != LOSS).any()
        else points.log_value.min()
    )
    start[shifts.equilibrium] = lowest - 1.0
    start[shifts.slopes] = first_slopes(guess, temperature, _FLAT if fixed else _LEAST)
    noise, roughness = np.full(3, 0.03), 0.6 / PER_DECADE
    if near is not None:
        _begin(start, shifts, near)
        noise, roughness = near.posterior.noise, near.posterior.widths[0]
    lifted, vertical_part = (
        lift[points.isotherm],
        slice(shifts.slopes.stop, shifts.places.start),
    )

    def model(
        p: np.ndarray, wary: bool = False
    ) -> tuple[np.ndarray, Callable[[], np.ndarray]]:
        log10_a, by_slope = from_slopes(p[shifts.slopes], temperature, anchor)
        rate = points.log_rate + LN10 * (log10_a[points.isotherm] + points.offset)
        answer = shifts.predict(p, points.channel, rate)

        def jacobian() -> np.ndarray:
            found = np.empty((points.channel.size, n))
            found[:, shifts.spectrum] = (
                answer.by_neighbours if wary else answer.by_spectrum
            )
            found[:, shifts.equilibrium] = answer.by_equilibrium
            found[:, shifts.slopes] = (
                LN10 * answer.by_rate[:, None] * by_slope[points.isotherm]
            )
            found[:, vertical_part] = -lifted[:, vertical_part]
            found[:, shifts.places] = answer.by_place
            return found

        return answer.log_value - lifted @ p, jacobian

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
    near, far = (LN10 / PER_DECADE * part for part in _PLACE)
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


def _anchor(points: Points, guess: np.ndarray) -> int:
    """The isotherm nearest to the middle of the reduced frequencies."""
    reduced = points.log_rate + LN10 * guess[points.isotherm]
    middle = 0.5 * (reduced.min() + reduced.max())
    centres = [reduced[points.isotherm == i].mean() for i in range(guess.size)]
    return int(np.argmin(np.abs(np.array(centres) - middle)))


def _first_spectrum(
    points: Points, reduced: np.ndarray, log_times: np.ndarray
) -> np.ndarray:
    """ln H_k from the loss modulus, H = (2/pi) G'' per unit of ln tau, or from
    relaxation, H = -dG/d(ln t).

    Relaxation that has come to an end must begin without slow times: beside an
    equilibrium modulus that is too low they would stay, and bend the slow edge.
    """
    width = np.log(LN10 / PER_DECADE)
    at = points.channel == LOSS
    if at.any():
        order = np.argsort(-reduced[at])
        return (
            np.interp(log_times, -reduced[at][order], points.log_value[at][order])
            + np.log(2 / np.pi)
            + width
        )
    bins = np.floor((reduced.max() - reduced) / (_BIN * LN10)).astype(int)
    log_time, level = (np.bincount(bins, of) for of in (-reduced, points.log_value))
    count = np.bincount(bins)
    log_time, level = (
        log_time[count > 0] / count[count > 0],
        level[count > 0] / count[count > 0],
    )
    fall = -np.gradient(level, log_time) if level.size > 1 else np.array([_LEAST_FALL])
    return (
        np.interp(log_times, log_time, level + np.log(np.maximum(fall, _LEAST_FALL)))
        + width
    )


def guess_shifts(points: Points, temperature: np.ndarray) -> np.ndarray:
    """log10 a_i to begin with, from neighbours in temperature: the shift that makes
    both one smooth curve.
    """
    guess = np.zeros(temperature.size)
    for i in range(temperature.size - 2, -1, -1):
        guess[i] = guess[i + 1] + _pair(
            points, i, i + 1, temperature[i + 1] - temperature[i]
        )
    return guess


def _pair(points: Points, cold: int, warm: int, gap: float) -> float:
    """log10(a_cold/a_warm) by least squares of polynomials in ln omega, one per
    channel, over a grid of shifts.
    """
    grid = np.arange(-0.5, max(4.0, 0.6 * gap), 0.05)
    at = (points.isotherm == cold) | (points.isotherm == warm)
    rate, value, channel = points.log_rate[at], points.log_value[at], points.channel[at]
    is_cold = points.isotherm[at] == cold
    u = rate + LN10 * grid[:, None] * is_cold  # (grid, points)
    low, high = u.min(axis=1, keepdims=True), u.max(axis=1, keepdims=True)
    u = 2 * (u - low) / np.maximum(high - low, 1e-9) - 1
    kinds = np.unique(channel)
    design = np.zeros((*u.shape, 1 + 6 * kinds.size))
    design[..., 0] = is_cold  # a vertical offset, held small below
    for k, which in enumerate(kinds):
        at = channel == which
        design[:, at, 1 + 6 * k : 7 + 6 * k] = np.vander(
            u[:, at].ravel(), 6, increasing=True
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
