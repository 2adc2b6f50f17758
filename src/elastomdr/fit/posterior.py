"""Least squares with Gaussian priors whose widths the data choose: the machinery behind
master curves.

Unknowns p with prior precision sum_j w_j P_j, residuals r = (data - model(p))/sigma.
The most probable p is found by damped Gauss-Newton, noise and prior widths by MacKay's
fixed point (D. J. C. MacKay, Neural Computation 4 (1992) 415-447), the covariance is
the inverse of the Hessian there.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg.blas import dsyrk  # pyright: ignore[reportAttributeAccessIssue]
from scipy.linalg.lapack import dpotrf, dpotri, dpotrs  # pyright: ignore[reportAttributeAccessIssue]

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


class _Place(NamedTuple):
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
    noise, robust = noise.copy(), weights is None
    weights = np.ones(data.size) if weights is None else weights
    widths = [prior.width for prior in priors]
    grams = [prior.rows.T @ prior.rows for prior in priors]
    pulls = [
        prior.rows.T @ np.broadcast_to(prior.target, prior.rows.shape[0])
        for prior in priors
    ]
    members = [np.flatnonzero(group == g) for g in range(noise.size)]
    there = np.array([at.size > 0 for at in members])
    value, jacobian = model(start)
    place, converged = _Place(start, data - value, jacobian()), False
    factor = covariance = np.eye(start.size)
    for _ in range(_ROUNDS):
        # its transpose is itself, in the order of LAPACK
        precision = _weighted(grams, widths).T
        pull = _weighted(pulls, widths)
        scale = np.sqrt(weights / temper) / noise[group]
        place, settled = _climb(model, data, scale, precision, pull, place, gain)
        p, residuals = place.p, place.residuals
        scaled = place.jacobian * scale[:, None]
        curvatures = [_gram(scaled[at]) for at in members]
        factor = _cholesky(sum(curvatures) + precision)
        covariance = _inverse(factor)
        before = np.log(np.concatenate([noise, widths]))
        for g, at in enumerate(members):
            if at.size and noise_limits is not None:
                freedom = max(
                    at.size - _trace(covariance, curvatures[g]), 0.1 * at.size
                )
                size = np.sqrt((weights[at] * residuals[at] ** 2).sum() / freedom)
                noise[g] = np.clip(size, *noise_limits)
        if noise_limits is not None:
            noise = np.maximum(noise, noise[there].max() / _RATIO)
        for j, prior in enumerate(priors):
            if prior.limits is None:
                continue
            seen = prior.rows @ p - prior.target
            known = len(seen) - (grams[j] * covariance).sum() / widths[j] ** 2
            usual, count = prior.usual
            squares = seen @ seen + count * usual**2 + 1e-12
            estimate = prior.loosen * np.sqrt(squares / max(known + count, 0.1))
            widths[j] = float(np.clip(estimate, *prior.limits))
        if robust:
            size = np.abs(residuals) / noise[group]
            weights = np.minimum(1.0, (_HUBER / np.maximum(size, 1e-12)) ** 2)
        cost = np.abs(np.log(np.concatenate([noise, widths])) - before).max()
        if settled and cost < settled_at:
            converged = True
            break
    if wary is not None:
        scaled = wary(place.p) * (np.sqrt(weights / temper) / noise[group])[:, None]
        covariance = _inverse(_cholesky(_gram(scaled) + _weighted(grams, widths)))
    p, residuals = place.p, place.residuals
    log_evidence = (
        -0.5 * (weights * (residuals / noise[group]) ** 2).sum() / temper
        - np.log(noise[group]).sum() / temper
        - np.log(np.diag(factor)).sum()
    )
    for prior, width in zip(priors, widths, strict=True):
        seen = prior.rows @ p - prior.target
        log_evidence -= 0.5 * (seen @ seen) / width**2 + len(seen) * np.log(width)
    return Posterior(
        p,
        covariance,
        noise,
        weights,
        residuals,
        tuple(widths),
        float(log_evidence),
        converged,
    )


def _weighted(parts: list[np.ndarray], widths: list[float]) -> np.ndarray:
    total = parts[0] / widths[0] ** 2
    for part, width in zip(parts[1:], widths[1:], strict=True):
        total = total + part / width**2
    return total


def _climb(
    model: Model,
    data: np.ndarray,
    scale: np.ndarray,
    precision: np.ndarray,
    pull: np.ndarray,
    place: _Place,
    least: float,
) -> tuple[_Place, bool]:
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
        place, now = _Place(trial, data - value, jacobian()), new
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
    full = lower + lower.T
    np.einsum("ii->i", full)[:] *= 0.5
    return full
