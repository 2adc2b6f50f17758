"""The few terms of a Prony series: how many, where, and whether there is an equilibrium
modulus.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import nnls

from ..errors import InputError
from .posterior import GAIN, Posterior, Prior, infer
from .spectrum import LOSS, RELAXATION, Points, predict

_LN10 = float(np.log(10.0))
_BEYOND = 0.5  # decades by which the first and last term may start beyond the data
_MOST_PER_DECADE = 1.5
_FAR = 1.5  # decades beyond the fast end at which one more term may start
# standard deviation of a refined time about its place on the grid, in spacings
_MOVE = 0.7
_FREE = 15.0  # standard deviation of a logarithm that the data alone decide
# least part of the lowest storage modulus that an equilibrium modulus must be to be
# believed
_PLATEAU = 0.1
# by how much a liquid must do better before a body that levels off counts as one
_DECISIVE = 10.0
# largest share of any value below which a term is left out, in noise standard
# deviations
_IDLE = 0.001
# largest modulus of a term to begin with, in largest values: one beyond the data may
# seem boundless
_STIFFEST = 30.0
# numbers of terms that are worse, one after the other, before a series is taken for the
# best,
_USUAL, _PATIENT = 3, 6
# the latter where its mean square residual, in standard deviations, is larger
_MET = 3.0
# per decade of frequency, into which points are gathered while the number of terms is
# looked for
_BINS = 12
# gain of a step, in the criterion, at which the search for that number stops climbing
_ROUGHLY = 0.1


class Data(NamedTuple):
    """What a series is held against."""

    points: Points
    noise: np.ndarray  # standard deviation of ln(value) per channel
    # per point: 1, less for an outlier, more where several points are gathered in one
    weights: np.ndarray
    alike: float  # number of neighbours that count as one
    # only so many points, the first ones, are data; the others guide the fit
    measured: int | None = None


class Terms(NamedTuple):
    """A refined series; logarithms of moduli and times with their covariance, the
    equilibrium modulus last if any.
    """

    log_moduli: np.ndarray
    log_times: np.ndarray
    equilibrium: float  # 0 for a liquid
    posterior: Posterior
    priors: tuple[Prior, ...]
    criterion: float  # Akaike information criterion: smaller is better


def most_terms(log_rate: np.ndarray) -> int:
    """How many terms data over this range of ln(omega) may have: one and a half per
    decade.
    """
    decades = (log_rate.max() - log_rate.min()) / _LN10
    return max(1, int(np.floor(_MOST_PER_DECADE * decades)))


def check_terms(terms: Any, log_rate: np.ndarray) -> None:
    """Raises `InputError` for a number of terms that is none, or far more than data
    over this range may have.
    """
    if terms is None:
        return
    most = max(4 * most_terms(log_rate), 4)
    if (
        isinstance(terms, bool)
        or not isinstance(terms, (int, np.integer))
        or not 1 <= terms <= most
    ):
        raise InputError(
            f"terms must be a whole number from 1 to {most} for these data, got "
            f"{terms!r}."
        )


def choose_terms(data: Data, terms: int | None, solid: bool | None) -> Terms:
    """The series with the smallest information criterion; `terms` and `solid` settle
    number and equilibrium modulus.

    The number of terms is found with points gathered in narrow bins; all points refine
    the answer.
    """
    gathered = _gathered(data)
    found = _search(gathered, terms, solid)
    found = _pruned(gathered, found) if terms is None else found
    return _climb(data, found.posterior.mean, found.priors, found.equilibrium > 0)


def _search(data: Data, terms: int | None, solid: bool | None) -> Terms:
    points = data.points
    rooms = (True, False) if solid is None else (solid,)
    if terms is not None:
        trials = [_best(data, terms, room) for room in rooms]
        if solid is None and not _levels_off(points, trials[0]):
            return trials[1]
        if solid is None and trials[1].criterion > trials[0].criterion - _DECISIVE:
            return trials[0]
        return min(trials, key=lambda t: t.criterion)
    most = most_terms(points.log_rate)
    best, worse = None, 0
    for count in _counts(most):
        trial = _best(data, count, rooms[0])
        if best is None or trial.criterion < best.criterion:
            best, worse = trial, 0
        else:
            worse += 1
        if worse == (_PATIENT if _off(data, best) > _MET else _USUAL):
            break
    assert best is not None
    if solid is None:
        count = best.log_times.size
        liquids = [_best(data, other, False) for other in {count, min(count + 1, most)}]
        liquid = min(liquids, key=lambda t: t.criterion)
        if liquid.criterion < best.criterion - _DECISIVE or not _levels_off(
            points, best
        ):
            return liquid
    return best


def _off(data: Data, found: Terms) -> float:
    """Mean square residual of a series in standard deviations."""
    squares = (found.criterion - 2.0 * found.posterior.mean.size) * data.alike
    return squares / float(data.weights.sum())


def _pruned(data: Data, found: Terms) -> Terms:
    """The series without terms that the data hardly know, as long as that lowers the
    criterion.
    """
    while found.log_times.size > 1:
        n = found.log_times.size
        least = int(np.diag(found.posterior.covariance)[:n].argmax())
        kept = np.delete(np.arange(found.posterior.mean.size), [least, n + least])
        priors = tuple(_without(prior, kept) for prior in found.priors)
        trial = _climb(
            data, found.posterior.mean[kept], priors, found.equilibrium > 0, _ROUGHLY
        )
        if trial.criterion > found.criterion:
            break
        found = trial
    return found


def _without(prior: Prior, kept: np.ndarray) -> Prior:
    """The prior of the unknowns that are kept; each of its rows is about one
    unknown.
    """
    rows = prior.rows[:, kept]
    about = rows.any(axis=1)
    return prior._replace(
        rows=rows[about], target=np.broadcast_to(prior.target, about.shape)[about]
    )


def _gathered(data: Data) -> Data:
    """Points of a channel that are within a twelfth of a decade of each other, as one
    at their mean.
    """
    points, weights = data.points, data.weights
    number = np.floor(points.log_rate / _LN10 * _BINS).astype(int)
    _, group = np.unique(
        np.stack([points.channel, number]), axis=1, return_inverse=True
    )
    group = group.reshape(-1)
    total = np.bincount(group, weights)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(group, weights * values) / total

    channel = np.rint(mean(points.channel.astype(float))).astype(int)
    zero = np.zeros(total.size)
    gathered = Points(
        channel, mean(points.log_rate), mean(points.log_value), zero.astype(int), zero
    )
    return data._replace(points=gathered, weights=total, measured=None)


def _levels_off(points: Points, found: Terms) -> bool:
    """Whether the slow end of the data is that of a solid, so that its equilibrium
    modulus is more than a guess.

    Over the slowest decade the storage modulus must rise more slowly than the frequency
    (that of a melt in its terminal zone rises with its square), and the equilibrium
    modulus must be a fair part of the lowest value.
    """
    elastic = points.channel != LOSS
    rate, value = points.log_rate[elastic], points.log_value[elastic]
    if not rate.size:
        return False
    slow = rate <= rate.min() + _LN10
    flat = (
        slow.sum() < 3
        or np.ptp(rate[slow]) == 0
        or np.polyfit(rate[slow], value[slow], 1)[0] < 1.0
    )
    return bool(flat and found.equilibrium > _PLATEAU * np.exp(value.min()))


def _counts(most: int) -> list[int]:
    """Numbers of terms to try: every one up to ten, then in steps of about 8 %."""
    first = max(1, most // 3)
    return sorted(
        {
            *range(first, min(most, 10) + 1),
            *np.linspace(first, most, 12).round().astype(int).tolist(),
        }
    )


def _best(data: Data, count: int, solid: bool) -> Terms:
    """The better of two starts: with terms close to the data, and with one well beyond
    their fast end.
    """
    trials = [
        _trial(data, count, solid, far)
        for far in ((False, True) if count > 2 else (False,))
    ]
    return min(trials, key=lambda t: t.criterion)


def _trial(data: Data, count: int, solid: bool, far: bool) -> Terms:
    """Non-negative least squares on log-spaced times, then times and moduli
    together.
    """
    points = data.points
    low, high = -points.log_rate.max(), -points.log_rate.min()
    beyond = min(_BEYOND * _LN10, (high - low) / 2)
    inner = count - far
    log_times = (
        np.array([0.5 * (low + high)])
        if inner == 1
        else np.linspace(low - beyond, high + beyond, inner)
    )
    spacing = (high - low + 2 * beyond) / max(inner - 1, 1)
    if far:
        log_times = np.concatenate([[low - _FAR * _LN10], log_times])
    moduli, equilibrium = _first(data, log_times, solid)
    top = np.exp(points.log_value).max()
    start = np.concatenate(
        [np.log(np.clip(moduli, 1e-6 * top, _STIFFEST * top)), log_times]
    )
    if solid:
        lowest = points.log_value[points.channel != LOSS].min(
            initial=points.log_value.max()
        )
        start = np.append(start, np.log(max(equilibrium, 0.03 * np.exp(lowest))))
    while True:
        n = (start.size - solid) // 2
        every = np.eye(start.size)
        priors = (
            Prior(
                np.delete(every, slice(n, 2 * n), axis=0),
                _FREE,
                None,
                np.delete(start, slice(n, 2 * n)),
            ),
            Prior(every[n : 2 * n], _MOVE * spacing, None, start[n : 2 * n]),
        )
        found = _climb(data, start, priors, solid, _ROUGHLY)
        p = found.posterior.mean
        share = np.abs(
            _model(points, p, solid)[1]()[:, :n] / data.noise[points.channel][:, None]
        ).max(axis=0)
        kept = share > _IDLE
        # a modulus that never changes leaves every term idle
        kept[share.argmax()] = True
        if kept.all():
            return found
        start = np.concatenate([p[:n][kept], p[n : 2 * n][kept], p[2 * n :]])


def _climb(
    data: Data,
    start: np.ndarray,
    priors: tuple[Prior, ...],
    solid: bool,
    gain: float = GAIN,
) -> Terms:
    """The most probable series near a start; its terms in order of their times."""
    points, noise = data.points, data.noise

    def by_data(p: np.ndarray) -> np.ndarray:
        rows = _model(points, p, solid)[1]()
        rows[data.measured :] = 0.0
        return rows

    posterior = infer(
        lambda p: _model(points, p, solid),
        points.log_value,
        points.channel,
        start,
        priors,
        noise,
        noise_limits=None,
        temper=data.alike,
        wary=by_data if data.measured is not None else None,
        weights=data.weights,
        gain=gain,
    )
    p, n = posterior.mean, (start.size - solid) // 2
    residuals = posterior.residuals / noise[points.channel]
    criterion = float(
        (data.weights * residuals**2).sum() / data.alike + 2.0 * start.size
    )
    order = np.argsort(p[n : 2 * n])
    full = np.concatenate([order, n + order, np.arange(2 * n, p.size)])
    posterior = posterior._replace(
        mean=p[full], covariance=posterior.covariance[np.ix_(full, full)]
    )
    priors = tuple(prior._replace(rows=prior.rows[:, full]) for prior in priors)
    level = float(np.exp(p[-1])) if solid else 0.0
    return Terms(p[:n][order], p[n : 2 * n][order], level, posterior, priors, criterion)


def _model(
    points: Points, p: np.ndarray, solid: bool
) -> tuple[np.ndarray, Callable[[], np.ndarray]]:
    """ln of what a series predicts, and its Jacobian."""
    n = (p.size - solid) // 2
    level = np.exp(p[-1]) if solid else 0.0
    answer = predict(points.channel, points.log_rate, p[n : 2 * n], p[:n], level)

    def jacobian() -> np.ndarray:
        parts = [answer.by_spectrum, answer.by_place] + (
            [answer.by_equilibrium[:, None]] if solid else []
        )
        return np.concatenate(parts, axis=1)

    return answer.log_value, jacobian


def _first(data: Data, log_times: np.ndarray, solid: bool) -> tuple[np.ndarray, float]:
    points, weight = (
        data.points,
        np.sqrt(data.weights) / data.noise[data.points.channel],
    )
    u = points.log_rate[:, None] + log_times
    x = np.exp(np.clip(u, -300, 300))
    storage, loss = 1 / (1 + 1 / x**2), 1 / (x + 1 / x)
    channel = points.channel[:, None]
    matrix = np.where(
        channel == LOSS, loss, np.where(channel == RELAXATION, np.exp(-1 / x), storage)
    )
    if solid:
        matrix = np.column_stack([matrix, points.channel != LOSS])
    solution, _ = nnls(matrix * (weight * np.exp(-points.log_value))[:, None], weight)
    return solution[: log_times.size], float(solution[-1]) if solid else 0.0
