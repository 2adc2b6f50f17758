"""A smooth relaxation spectrum: what it predicts, the passive material closest to
moduli, the Bayesian least squares that finds it, the prior for its fast end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.linalg.blas import dsyrk  # pyright: ignore[reportAttributeAccessIssue]
from scipy.linalg.lapack import dpotrf, dpotri, dpotrs  # pyright: ignore[reportAttributeAccessIssue]
from scipy.optimize import nnls

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

# --------------------------------------------------------------------------------------
# A smooth relaxation spectrum on log-spaced times, and what it predicts: storage and
# loss modulus, relaxation.
#
# G(t) = G_eq + sum_k H_k exp(-t/tau_k) with H_k > 0, four tau_k per decade: fine enough
# for the sum to stand for a continuous spectrum (the ripples are of 1e-7), and each may
# move a little, so that it can stand for a sharp line. The unknowns are logarithms, so
# that every answer is passive.
# --------------------------------------------------------------------------------------

STORAGE, LOSS, RELAXATION = 0, 1, 2  # what a measured value is
CHANNELS = ("storage modulus", "loss modulus", "relaxation modulus")
PER_DECADE = 4
_MARGIN = 2.0  # decades of relaxation times beyond the data, on either side
# weights of a neighbourhood, nearly a decade wide
_REACH = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 9.0
_LARGEST = 700.0  # of an exponent: exp(700) is still a float64
# largest 1/(omega tau), and inverse of the smallest: their squares are still float64
_FAR = 1e150


class MeasuredPoints(NamedTuple):
    """Measured values, one row each, whatever they are of."""

    channel: np.ndarray  # STORAGE, LOSS or RELAXATION
    # ln(omega), or ln(1/t) for relaxation, omega in rad/s and t in s
    log_rate: np.ndarray
    log_value: np.ndarray  # ln(modulus), modulus in Pa
    isotherm: np.ndarray  # number of the isotherm it belongs to
    # log10 a_T expected of the point's own temperature within its isotherm
    offset: np.ndarray


@dataclass(frozen=True, eq=False)
class Prediction:
    """ln of the predicted values; derivatives, computed on demand, by ln H_k, ln G_eq,
    ln(omega) and ln tau_k.
    """

    log_value: np.ndarray  # (points,)
    heights: np.ndarray  # (times,): H_k
    by_equilibrium: np.ndarray  # (points,)
    channel: np.ndarray  # (points,)
    value: np.ndarray  # (points,)
    x: np.ndarray  # (points, times): 1/(omega tau), or t/tau
    kernels: np.ndarray  # (points, times): the contribution of a unit branch

    @cached_property
    def bends(self) -> np.ndarray:
        """(points, times): the derivative of a unit branch's contribution with respect
        to ln(omega), over the value.
        """
        derivative = np.empty(self.x.shape)
        for which, run in _runs(self.channel):
            _bend(which, self.x[run], self.kernels[run], derivative[run])
        derivative /= self.value[:, None]
        return derivative

    @property
    def by_spectrum(self) -> np.ndarray:
        """(points, times), by ln H_k."""
        derivative = self.kernels * self.heights
        derivative /= self.value[:, None]
        return derivative

    @property
    def by_neighbours(self) -> np.ndarray:
        """(points, times), by ln H_k too, but as if H_k were the mean of its
        neighbourhood.

        A branch that the most probable spectrum leaves empty, beside a full one, may
        well be there, which the derivative by its logarithm does not see.
        """
        wide = np.pad(self.heights, _REACH.size // 2, mode="edge")
        return (
            self.kernels / self.value[:, None] * np.convolve(wide, _REACH, mode="valid")
        )

    @property
    def by_place(self) -> np.ndarray:
        """(points, times), by ln tau_k."""
        return self.bends * self.heights

    @property
    def by_rate(self) -> np.ndarray:
        """(points,), by ln(omega)."""
        return self.bends @ self.heights


def nodes(log_rate: np.ndarray) -> np.ndarray:
    """ln of relaxation times that cover data at these ln(omega), with a margin on
    either side.
    """
    ln10 = np.log(10.0)
    low, high = -log_rate.max() - _MARGIN * ln10, -log_rate.min() + _MARGIN * ln10
    count = int(np.ceil((high - low) / ln10 * PER_DECADE)) + 1
    middle, half = 0.5 * (low + high), 0.5 * (count - 1) * ln10 / PER_DECADE
    return np.linspace(middle - half, middle + half, count)


def predict(
    channel: np.ndarray,
    log_rate: np.ndarray,
    log_times: np.ndarray,
    log_spectrum: np.ndarray,
    equilibrium: float,
) -> Prediction:
    """What a spectrum predicts for points of any channel, at ln(omega) or ln(1/t) of
    shape (points,).
    """
    heights = np.exp(np.clip(log_spectrum, -_LARGEST, _LARGEST))
    with np.errstate(over="ignore"):
        x = np.outer(np.exp(-log_rate), np.exp(-log_times))  # 1/(omega tau), or t/tau
    np.clip(x, 1 / _FAR, _FAR, out=x)
    kernels = np.empty(x.shape)
    for which, run in _runs(channel):
        _kernel(which, x[run], kernels[run])
    of_equilibrium = np.where(channel == LOSS, 0.0, equilibrium)
    value = np.maximum(kernels @ heights + of_equilibrium, 1e-300)
    return Prediction(
        np.log(value), heights, of_equilibrium / value, channel, value, x, kernels
    )


def _runs(channel: np.ndarray) -> Iterator[tuple[int, slice]]:
    """Neighbouring points of one channel, as slices: views, which are not copied."""
    ends = [
        0,
        *(np.flatnonzero(channel[1:] != channel[:-1]) + 1).tolist(),
        channel.size,
    ]
    for start, stop in pairwise(ends if channel.size else []):
        yield int(channel[start]), slice(start, stop)


def _kernel(channel: int, x: np.ndarray, out: np.ndarray) -> None:
    """The contribution of a unit branch at x = 1/(omega tau) or t/tau."""
    if channel == RELAXATION:
        np.exp(-x, out=out)
        return
    np.multiply(x, x, out=out)
    out += 1
    np.divide(1.0 if channel == STORAGE else x, out, out=out)


def _bend(channel: int, x: np.ndarray, kernel: np.ndarray, out: np.ndarray) -> None:
    """The derivative of that contribution with respect to -ln x."""
    np.multiply(x, kernel, out=out)
    if channel == STORAGE:  # 2 loss^2, loss = x storage
        out *= out
        out *= 2
    elif channel == LOSS:  # loss (1 - 2 storage), storage = 1 - x loss
        out *= 2
        out -= 1
        out *= kernel


# --------------------------------------------------------------------------------------
# The passive material closest to storage and loss modulus: a non-negative spectrum by
# their relative errors.
#
# G' = G_eq + sum_k H_k x_k^2/(1 + x_k^2) and G'' = eta omega + sum_k H_k x_k/(1 + x_k^2),
# x_k = omega tau_k, H_k >= 0, on a grid of relaxation times that reaches beyond the data.
# A check of data, not a fit: that is `fit.terms`.
# --------------------------------------------------------------------------------------

_PASSIVE_PER_DECADE = 4  # relaxation times,
_PASSIVE_MARGIN = 2.3  # how far beyond the data ln(tau) goes on either side,
_MOST_TIMES = 200  # and how many at most
# |ln| of a modulus over the median one, and of omega tau: what is beyond is damaged
_DAMAGED = 100.0


class Passive(NamedTuple):
    """Rates ln(1/tau_k), the moduli at them and at rest over exp(log_median), and the rms
    relative misfit.
    """

    log_rates: Float[np.ndarray, " k"]
    moduli: Float[np.ndarray, " k"]
    equilibrium: float
    log_median: float  # median ln(modulus)
    misfit: float
    storage: float  # rms relative misfit of the storage modulus,
    loss: float  # and of the loss modulus

    def log_relaxation(
        self, log_rate: Float[np.ndarray, " n"]
    ) -> Float[np.ndarray, " n"]:
        """ln G(t) at ln(1/t)."""
        past = np.exp(np.clip(self.log_rates - log_rate[:, None], -_DAMAGED, _DAMAGED))
        return self.log_median + np.log(
            np.maximum(np.exp(-past) @ self.moduli + self.equilibrium, 1e-300)
        )


def closest_passive(
    log_rate: Float[np.ndarray, " m"],
    log_value: Float[np.ndarray, " m"],
    storage: Bool[np.ndarray, " m"],
    balance: float = 1.0,
) -> Passive | None:
    """The closest one to ln(modulus) at ln(omega), `storage` or else loss; None where
    none is found.

    `balance` is by how much more a relative deviation of the storage modulus counts.
    """
    low, high = log_rate.min() - _PASSIVE_MARGIN, log_rate.max() + _PASSIVE_MARGIN
    count = min(
        int(np.ceil(_PASSIVE_PER_DECADE * (high - low) / np.log(10.0))) + 1, _MOST_TIMES
    )
    rates = np.linspace(high, low, count)
    x = np.exp(np.clip(log_rate[:, None] - rates, -_DAMAGED, _DAMAGED))
    storage = storage[:, None]
    spring, dashpot = storage * 1.0, ~storage * x[:, -1:] / x[:, -1].max()
    log_median = float(np.median(log_value))
    scale = np.exp(np.clip(log_median - log_value, -_DAMAGED, _DAMAGED))[:, None]
    matrix = (
        np.hstack(
            [np.where(storage, x / (x + 1 / x), 1 / (x + 1 / x)), spring, dashpot]
        )
        * scale
    )
    largest, weight = matrix.max(axis=0), np.where(storage, balance, 1.0)
    try:
        moduli, _ = nnls(matrix / largest * weight, weight[:, 0])
    except RuntimeError:  # too many iterations
        return None
    moduli = moduli / largest
    off, is_storage = (matrix @ moduli - 1) ** 2, storage[:, 0]
    parts = (
        float(np.sqrt(residuals.mean())) if residuals.size else 0.0
        for residuals in (off, off[is_storage], off[~is_storage])
    )
    return Passive(rates, moduli[:count], float(moduli[count]), log_median, *parts)


# --------------------------------------------------------------------------------------
# Least squares with Gaussian priors whose widths the data choose: the machinery behind
# master curves.
#
# Unknowns p with prior precision sum_j w_j P_j, residuals r = (data - model(p))/sigma.
# The most probable p is found by damped Gauss-Newton, noise and prior widths by MacKay's
# fixed point (D. J. C. MacKay, Neural Computation 4 (1992) 415-447), the covariance is
# the inverse of the Hessian there.
# --------------------------------------------------------------------------------------

# limits of a noise that is found: what rounding leaves is no statistics
_NOISE = (1e-4, 1.0)
_HUBER = 3.0  # residuals beyond this many standard deviations are weighted down
# largest ratio of two groups' noise: a misfit of one must not leave it to the others
# alone
_RATIO = 5.0
_ROUNDS = 40
# added to curvatures where they scale the damping: unknowns are logarithms, a step of 1
# is large
_STIFF = 1.0
# change of the logarithms of noise and widths at which they count as found
SETTLED = 0.03
GAIN = 3e-3  # of a step, in twice the logarithm of probability, at which climbing stops
_STEPS = 12  # of Gauss-Newton before the widths are looked at again


class Prior(NamedTuple):
    """A group of unknowns seen through rows @ p, each row zero with standard deviation
    `width`.
    """

    rows: np.ndarray  # (m, n)
    width: float
    # bounds of the width where the data choose it; None: it is fixed
    limits: tuple[float, float] | None = None
    target: np.ndarray | float = 0.0  # what rows @ p is expected to be
    loosen: float = 1.0  # factor on a width that the data chose
    # width expected before any data, and how many rows that counts for
    usual: tuple[float, float] = (0.0, 0.0)

    def pull(self) -> np.ndarray:
        """Towards the target, at width 1."""
        return self.rows.T @ np.broadcast_to(self.target, self.rows.shape[0])


class Posterior(NamedTuple):
    """The most probable unknowns and what is known about them."""

    mean: np.ndarray  # (n,)
    covariance: np.ndarray  # (n, n)
    noise: np.ndarray  # standard deviation per noise group
    weights: np.ndarray  # 1, or less for outliers, per data point
    residuals: np.ndarray  # data minus model, not scaled
    widths: tuple[float, ...]  # of the priors
    evidence: float  # ln of the marginal likelihood, up to a constant
    converged: bool


# p -> (values, their Jacobian's function)
Model = Callable[[np.ndarray], tuple[np.ndarray, Callable[[], np.ndarray]]]
# p -> the Jacobian that the covariance is computed with
Wary = Callable[[np.ndarray], np.ndarray]


class _SearchPoint(NamedTuple):
    """Unknowns, and the model there."""

    p: np.ndarray
    residuals: np.ndarray  # data minus model
    jacobian: np.ndarray


def infer(
    model: Model,
    data: np.ndarray,
    group: np.ndarray,
    start: np.ndarray,
    priors: Sequence[Prior],
    noise: np.ndarray,
    *,
    temper: float = 1.0,
    wary: Wary | None = None,
    noise_limits: tuple[float, float] | None = _NOISE,
    weights: np.ndarray | None = None,
    gain: float = GAIN,
    settled_at: float = SETTLED,
) -> Posterior:
    """The posterior of a model whose values have Gaussian noise of unknown size, one
    size per `group` of points.

    With `noise_limits=None` the noise stays as it is given. `temper` above 1 says that
    residuals resemble their neighbours: so many points count as one. `wary` replaces
    the Jacobian in the covariance. `weights` of the points are found, unless they are
    given: 1, and less for outliers. Climbing stops where a step gains less than `gain`,
    and all of it where logarithms of noise and widths change by less than `settled_at`.
    """
    robust = weights is None
    weights = np.ones(data.size) if weights is None else weights
    widths = [prior.width for prior in priors]
    grams = [prior.rows.T @ prior.rows for prior in priors]
    pulls = [prior.pull() for prior in priors]
    members = [np.flatnonzero(group == g) for g in range(noise.size)]
    value, jacobian = model(start)
    place, converged = _SearchPoint(start, data - value, jacobian()), False
    factor = covariance = np.eye(start.size)
    for _ in range(_ROUNDS):
        # its transpose is itself, in the order of LAPACK
        precision = _weighted(grams, widths).T
        pull = _weighted(pulls, widths)
        scale = np.sqrt(weights / temper) / noise[group]
        place, settled = _climb(model, data, scale, precision, pull, place, gain)
        scaled = place.jacobian * scale[:, None]
        curvatures = [_gram(scaled[member]) for member in members]
        factor = _cholesky(sum(curvatures) + precision)
        covariance = _inverse(factor)
        before = np.log(np.concatenate([noise, widths]))
        if noise_limits is not None:
            squares = [weights[i] * place.residuals[i] ** 2 for i in members]
            effective = [_trace(covariance, curvature) for curvature in curvatures]
            noise = _new_noise(noise, squares, effective, noise_limits)
        widths = _new_widths(priors, widths, grams, place.p, covariance)
        if robust:
            weights = _outlier_weights(place.residuals / noise[group])
        change = np.abs(np.log(np.concatenate([noise, widths])) - before).max()
        converged = bool(settled and change < settled_at)
        if converged:
            break
    if wary is not None:
        scaled = wary(place.p) * (np.sqrt(weights / temper) / noise[group])[:, None]
        covariance = _inverse(_cholesky(_gram(scaled) + _weighted(grams, widths)))
    return Posterior(
        place.p,
        covariance,
        noise,
        weights,
        place.residuals,
        tuple(widths),
        _evidence(place, weights, noise[group], temper, factor, priors, widths),
        converged,
    )


def _outlier_weights(residuals: np.ndarray) -> np.ndarray:
    """1, and less beyond Huber's limit of residuals in standard deviations."""
    return np.minimum(1.0, (_HUBER / np.maximum(np.abs(residuals), 1e-12)) ** 2)


def _evidence(
    place: _SearchPoint,
    weights: np.ndarray,
    sigma: np.ndarray,
    temper: float,
    factor: np.ndarray,
    priors: Sequence[Prior],
    widths: list[float],
) -> float:
    """ln of the marginal likelihood, up to a constant; `factor` is Cholesky's of the
    precision.
    """
    evidence = (
        -0.5 * (weights * (place.residuals / sigma) ** 2).sum() / temper
        - np.log(sigma).sum() / temper
        - np.log(np.diag(factor)).sum()
    )
    for prior, width in zip(priors, widths, strict=True):
        left = prior.rows @ place.p - prior.target
        evidence -= 0.5 * (left @ left) / width**2 + len(left) * np.log(width)
    return float(evidence)


def _new_noise(
    noise: np.ndarray,
    squares: list[np.ndarray],
    effective: list[Any],
    limits: tuple[float, float],
) -> np.ndarray:
    """Noise of each group from the weighted squares of its points, less the parameters
    that these determine.
    """
    noise = noise.copy()
    for g, square in enumerate(squares):
        if square.size:
            freedom = max(square.size - effective[g], 0.1 * square.size)
            noise[g] = np.clip(np.sqrt(square.sum() / freedom), *limits)
    measured = np.array([square.size > 0 for square in squares])
    return np.maximum(noise, noise[measured].max() / _RATIO)


def _new_widths(
    priors: Sequence[Prior],
    widths: list[float],
    grams: list[np.ndarray],
    p: np.ndarray,
    covariance: np.ndarray,
) -> list[float]:
    return [
        _new_width(prior, width, gram, p, covariance)
        for prior, width, gram in zip(priors, widths, grams, strict=True)
    ]


def _new_width(
    prior: Prior, width: float, gram: np.ndarray, p: np.ndarray, covariance: np.ndarray
) -> float:
    """The width of a prior from how far the parameters are from its target."""
    if prior.limits is None:
        return width
    left = prior.rows @ p - prior.target
    known = len(left) - (gram * covariance).sum() / width**2
    usual, count = prior.usual
    squares = left @ left + count * usual**2 + 1e-12
    estimate = prior.loosen * np.sqrt(squares / max(known + count, 0.1))
    return float(np.clip(estimate, *prior.limits))


def _weighted(parts: list[np.ndarray], widths: list[float]) -> np.ndarray:
    total = parts[0] / widths[0] ** 2
    for rows, width in zip(parts[1:], widths[1:], strict=True):
        total = total + rows / width**2
    return total


def _climb(
    model: Model,
    data: np.ndarray,
    scale: np.ndarray,
    precision: np.ndarray,
    pull: np.ndarray,
    place: _SearchPoint,
    least: float,
) -> tuple[_SearchPoint, bool]:
    """Damped Gauss-Newton to the most probable unknowns, and whether they are
    reached.
    """
    damping = 1e-3

    def penalty(p: np.ndarray, residuals: np.ndarray) -> float:
        r = residuals * scale
        return float(r @ r + p @ precision @ p - 2 * pull @ p)

    now = penalty(place.p, place.residuals)
    for _ in range(_STEPS):
        p = place.p
        scaled = place.jacobian * scale[:, None]
        gradient = (place.residuals * scale) @ scaled - precision @ p + pull
        hessian = _gram(scaled) + precision
        diagonal, calm = np.diag(hessian) + _STIFF, True
        while True:
            damped = hessian.copy(order="K")
            np.einsum("ii->i", damped)[:] += damping * diagonal
            step = dpotrs(_cholesky(damped), gradient, lower=1)[0]
            trial = p + step * min(1.0, 3.0 / max(np.abs(step).max(), 1e-12))
            value, jacobian = model(trial)
            new = penalty(trial, data - value)
            if np.isfinite(new) and new <= now + 1e-12 * abs(now):
                break
            damping, calm = 8 * damping, False
            if damping > 1e8:
                return place, True
        gain = now - new
        place, now = _SearchPoint(trial, data - value, jacobian()), new
        if calm:
            damping = max(damping / 8, 1e-9)
        if gain < least:
            return place, True
    return place, False


def _gram(rows: np.ndarray) -> np.ndarray:
    """The lower triangle of rows.T @ rows, the upper one zero, in the order that LAPACK
    takes without a copy.
    """
    return (
        dsyrk(1.0, rows.T, lower=1)
        if len(rows)
        else np.zeros((rows.shape[1],) * 2, order="F")
    )


def _trace(covariance: np.ndarray, gram: np.ndarray) -> float:
    """Trace of the product of a symmetric matrix and one given by its lower
    triangle.
    """
    return float(
        2 * np.vdot(covariance.T, gram.T) - np.diag(covariance) @ np.diag(gram)
    )


def _cholesky(matrix: np.ndarray) -> np.ndarray:
    """The lower factor, by LAPACK itself: SciPy's checks take longer than a matrix of a
    hundred rows.
    """
    factor, failed = dpotrf(matrix, lower=1)  # reads the lower triangle only
    jitter = 1e-14 * np.abs(np.diag(matrix)).max() if failed else 0.0
    while failed:
        factor, failed = dpotrf(matrix + jitter * np.eye(len(matrix)), lower=1)
        jitter *= 10
    return factor


def _inverse(factor: np.ndarray) -> np.ndarray:
    # the upper triangle stays that of the factor, zero
    lower = dpotri(factor, lower=1)[0]
    inverse = lower + lower.T
    np.einsum("ii->i", inverse)[:] *= 0.5
    return inverse


# --------------------------------------------------------------------------------------
# A prior for what relaxed before the first instant of relaxation data: roughly a power
# law.
#
# Relaxation from t_0 on says next to nothing of relaxation times below t_0/4, but they
# are a part of the loss at angular frequencies a decade or two below 1/t_0. A spectrum
# that is free there goes on with whatever slope its last ripple has, to nothing as a
# rule, and what is nothing has no uncertainty. It is expected to continue H = -dG/d(ln t)
# of the first two decades of data,
#
#     ln H(tau) = ln H(t_0) + n ln(t_0/tau) +- sqrt(A^2 + B^2 ln(t_0/tau)^2),
#
# at all times together too high or too low, too steep or too flat. How smooth the
# spectrum is has to be learnt from the times that are seen: second differences of the
# others would all be small.
#
# What is known to a factor only may be larger by more than it may be smaller: an interval
# takes the step of one standard deviation up, e^s - 1, not its tangent s.
# --------------------------------------------------------------------------------------

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


def hidden(
    points: MeasuredPoints, reduced: np.ndarray, log_times: np.ndarray
) -> np.ndarray:
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
    points: MeasuredPoints, reduced: np.ndarray, log_times: np.ndarray, size: int
) -> list[Prior]:
    """The expectation of ln H_k (the first of `size` unknowns) at times too short to be
    seen; none for other data.

    `reduced` as for `hidden`.
    """
    if points.channel[reduced.argmax()] != RELAXATION:
        return []
    start = -reduced.max()
    unmeasured = np.flatnonzero(hidden(points, reduced, log_times))
    chosen = (points.channel == RELAXATION) & (-reduced <= start + _DECADES * _LN10)
    u = -reduced[chosen] - start
    if np.unique(u).size < _FEWEST or np.ptp(u) < _NARROW * _LN10:
        return []
    curve = np.polynomial.Polynomial.fit(u, points.log_value[chosen], 2)
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
