"""The few terms of a Prony series: how many and where, how moduli count against each
other, and between which values the equilibrium modulus lies.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from ..checks import whole_number
from .spectrum import (
    GAIN,
    LOSS,
    RELAXATION,
    STORAGE,
    MeasuredPoints,
    Posterior,
    Prior,
    closest_passive,
    infer,
    predict,
)

# --------------------------------------------------------------------------------------
# The few terms of a Prony series: how many, where, and whether there is an equilibrium
# modulus.
# --------------------------------------------------------------------------------------

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
    """What a series is compared with."""

    points: MeasuredPoints
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


def check_terms(terms: object, log_rate: np.ndarray) -> None:
    """Raises `InputError` for a number of terms that is none, or far more than data
    over this range may have.
    """
    if terms is None:
        return
    whole_number("terms", terms, 1, max(4 * most_terms(log_rate), 4))


def choose_terms(data: Data, terms: int | None, solid: bool | None) -> Terms:
    """The series with the smallest information criterion; `terms` and `solid` settle
    number and equilibrium modulus.

    The number of terms is found with points gathered in narrow bins; all points refine
    the answer.
    """
    gathered = _gathered(data)
    series = _search(gathered, terms, solid)
    series = _pruned(gathered, series) if terms is None else series
    return _climb(data, series.posterior.mean, series.priors, series.equilibrium > 0)


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


def _off(data: Data, series: Terms) -> float:
    """Mean square residual of a series in standard deviations."""
    squares = (series.criterion - 2.0 * series.posterior.mean.size) * data.alike
    return squares / float(data.weights.sum())


def _pruned(data: Data, series: Terms) -> Terms:
    """The series without terms that the data hardly know, as long as that lowers the
    criterion.
    """
    while series.log_times.size > 1:
        n = series.log_times.size
        least = int(np.diag(series.posterior.covariance)[:n].argmax())
        kept = np.delete(np.arange(series.posterior.mean.size), [least, n + least])
        priors = tuple(_without(prior, kept) for prior in series.priors)
        trial = _climb(
            data, series.posterior.mean[kept], priors, series.equilibrium > 0, _ROUGHLY
        )
        if trial.criterion > series.criterion:
            break
        series = trial
    return series


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
    gathered = MeasuredPoints(
        channel, mean(points.log_rate), mean(points.log_value), zero.astype(int), zero
    )
    return data._replace(points=gathered, weights=total, measured=None)


def _levels_off(points: MeasuredPoints, series: Terms) -> bool:
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
    return bool(flat and series.equilibrium > _PLATEAU * np.exp(value.min()))


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
        series = _climb(data, start, priors, solid, _ROUGHLY)
        p = series.posterior.mean
        share = np.abs(
            _model(points, p, solid)[1]()[:, :n] / data.noise[points.channel][:, None]
        ).max(axis=0)
        kept = share > _IDLE
        # a modulus that never changes leaves every term idle
        kept[share.argmax()] = True
        if kept.all():
            return series
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
    by_time = np.concatenate([order, n + order, np.arange(2 * n, p.size)])
    posterior = posterior._replace(
        mean=p[by_time], covariance=posterior.covariance[np.ix_(by_time, by_time)]
    )
    priors = tuple(prior._replace(rows=prior.rows[:, by_time]) for prior in priors)
    equilibrium = float(np.exp(p[-1])) if solid else 0.0
    return Terms(
        p[:n][order], p[n : 2 * n][order], equilibrium, posterior, priors, criterion
    )


def _model(
    points: MeasuredPoints, p: np.ndarray, solid: bool
) -> tuple[np.ndarray, Callable[[], np.ndarray]]:
    """ln of what a series predicts, and its Jacobian."""
    n = (p.size - solid) // 2
    equilibrium = np.exp(p[-1]) if solid else 0.0
    answer = predict(points.channel, points.log_rate, p[n : 2 * n], p[:n], equilibrium)

    def jacobian() -> np.ndarray:
        parts = [answer.by_spectrum, answer.by_place] + (
            [answer.by_equilibrium[:, None]] if solid else []
        )
        return np.concatenate(parts, axis=1)

    return answer.log_value, jacobian


def _first(data: Data, log_times: np.ndarray, solid: bool) -> tuple[np.ndarray, float]:
    points = data.points
    weight = np.sqrt(data.weights) / data.noise[data.points.channel]
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


# --------------------------------------------------------------------------------------
# How much storage modulus, loss modulus and relaxation count against each other in a
# Prony series.
#
# Each counts by its scatter. A passive material's moduli determine each other (Kramers
# and Kronig), so that data may contradict themselves: then no weights meet both, and
# relative deviations of both count alike, which is what foretells points that were left
# out best (`benchmarks/fit_balance.py`). What other weights would give is in `trade_off`.
# --------------------------------------------------------------------------------------

# largest ratio between the weights of two kinds of modulus: a series has to meet all of
# them
_RATIO = 3.0
# misfit of a smooth spectrum above which storage and loss modulus contradict each
# other, if
_CONTRADICTION = 0.1
_SYSTEMATIC = 2.0  # it is so many times the scatter between neighbouring points
# misfit of a series over that of the closest passive material up to which none comes
# closer
_CLOSEST = 1.2
_BALANCES = (0.1, 1.0, 5.0, 20.0)  # of which the trade-off is shown
# relative standard deviation below which residuals are not trusted to be noise
_LEAST_NOISE = 0.002


def weigh(
    noise: np.ndarray, points: MeasuredPoints, balance: float | None
) -> tuple[np.ndarray, bool]:
    """Standard deviations that the kinds of modulus are weighed with, and whether the
    moduli contradict each other.

    They are the scatter between neighbouring points, where that is less than the misfit
    of a smooth spectrum, within limits. Where the misfit is large and not scatter,
    storage and loss modulus may contradict each other.
    """
    present, scatter = np.unique(points.channel), _scatter(points)
    both = LOSS in present and STORAGE in present
    worst = present[noise[present].argmax()]
    systematic = bool(
        both and noise[worst] > max(_CONTRADICTION, _SYSTEMATIC * scatter[worst])
    )
    if systematic and balance is None:
        balance = 1.0
    if both and balance is not None:
        noise = noise.copy()
        noise[LOSS] = noise[[STORAGE, LOSS]].max()
        noise[STORAGE] = noise[LOSS] / balance
        return noise, systematic
    noise = np.maximum(np.fmin(noise, scatter), _LEAST_NOISE)
    return np.maximum(noise, noise[present].max() / _RATIO), systematic


class Met(NamedTuple):
    """How closely a passive material can meet both moduli: rms relative deviations,
    with `balance` as the weight.
    """

    balance: float
    storage: float
    loss: float

    @property
    def whole(self) -> float:
        return float(np.hypot(self.storage, self.loss))


def trade_off(points: MeasuredPoints) -> tuple[Met, ...]:
    """Of all passive materials those closest to storage and loss modulus, by the weight
    of the storage modulus.
    """
    dynamic = points.channel <= LOSS
    met = []
    for balance in _BALANCES:
        near = closest_passive(
            points.log_rate[dynamic],
            points.log_value[dynamic],
            points.channel[dynamic] == STORAGE,
            balance,
        )
        if near is not None:
            met.append(Met(balance, near.storage, near.loss))
    return tuple(met)


def verdict(met: tuple[Met, ...], storage: float, loss: float) -> str:
    """What the trade-off says of a series with these rms deviations; "" without one."""
    alike = next((one for one in met if one.balance == 1.0), None)
    if alike is None:
        return ""
    closest_passive = f"{100 * alike.storage:.2g} and {100 * alike.loss:.2g} %"
    if np.hypot(storage, loss) > _CLOSEST * alike.whole:
        return (
            "; the closest passive material meets storage and loss modulus to "
            f"{closest_passive}, more terms may help."
        )
    return (
        ": storage and loss modulus contradict each other, no passive material comes "
        f"closer to both than {closest_passive}; "
        "balance=... favours one of them."
    )


def _scatter(points: MeasuredPoints) -> np.ndarray:
    """Standard deviation of ln(value) about the line between its neighbours in
    frequency, by channel, or NaN.
    """
    scatter = np.full(3, np.nan)
    for channel in np.unique(points.channel):
        indices = np.flatnonzero(points.channel == channel)
        indices = indices[np.argsort(points.log_rate[indices], kind="stable")]
        if indices.size < 5:
            continue
        x, y = points.log_rate[indices], points.log_value[indices]
        fraction = (x[1:-1] - x[:-2]) / np.maximum(x[2:] - x[:-2], 1e-12)
        off = (y[1:-1] - (1 - fraction) * y[:-2] - fraction * y[2:]) / np.sqrt(
            1 + fraction**2 + (1 - fraction) ** 2
        )
        scatter[channel] = 1.4826 * np.median(np.abs(off))  # an outlier is not scatter
    return scatter


# --------------------------------------------------------------------------------------
# The equilibrium modulus from the slow end of the data: how far the modulus may still
# fall below the window.
#
# Relaxation slower than the data shows at their slow end: it makes loss there, and keeps
# the modulus falling. A power law, as of a fractional element (spring-pot) beside a
# spring, carries the end on (omega: lowest angular frequency, t: longest time):
#
#     G_eq = G' - G''/tan(m pi/2),  G'' ~ omega^m   or   G_eq = G - D/m,  D = -dG/d(ln t) ~ t^-m.
#
# m = 1 is the end of all relaxation, G' = G_eq; m -> 0, a loss as large at every
# frequency, leaves nothing for sure. The lower limit of the interval takes the least m
# that the slowest decade of the data allows.
# --------------------------------------------------------------------------------------

_FEWEST = 6  # points that a slope is taken from, or all there are
_SURE = 2.0  # standard deviations


class SlowEnd(NamedTuple):
    """Between which values the modulus ends that the data leave at `end`."""

    low: float  # least equilibrium modulus [Pa]
    end: float  # modulus at the slow end of the data [Pa]
    rate: float  # lowest angular frequency, or inverse of the longest time [rad/s]
    kind: str  # of the modulus that is followed: "storage" or "relaxation"


class _SlowLine(NamedTuple):
    value: float  # ln(modulus) at its slow end
    slope: float  # d(ln modulus)/d(ln rate)
    slope_std: float
    value_std: float


def slow_end(points: MeasuredPoints, noise: np.ndarray) -> SlowEnd:
    """What may still relax below the data; `noise` is the standard deviation of
    ln(modulus) per channel.
    """
    slowest = {
        c: points.log_rate[points.channel == c].min(initial=np.inf)
        for c in (STORAGE, RELAXATION)
    }
    dynamic = slowest[STORAGE] <= slowest[RELAXATION]
    start = min(slowest.values())
    low, end = (_from_loss if dynamic else _from_relaxation)(points, noise, start)
    return SlowEnd(
        float(np.clip(low, 0.0, end)),
        end,
        float(np.exp(start)),
        "storage" if dynamic else "relaxation",
    )


def _from_loss(
    points: MeasuredPoints, noise: np.ndarray, start: float
) -> tuple[float, float]:
    storage, loss = (
        _line(points, which, noise[which], start) for which in (STORAGE, LOSS)
    )
    end = float(np.exp(storage.value))
    sure = end * np.exp(-_SURE * storage.value_std)
    power = min(loss.slope - _SURE * loss.slope_std, 1.0)
    if power <= 0:
        return 0.0, end
    return sure - float(np.exp(loss.value)) / np.tan(power * np.pi / 2), end


def _from_relaxation(
    points: MeasuredPoints, noise: np.ndarray, start: float
) -> tuple[float, float]:
    last, before = (
        _line(points, RELAXATION, noise[RELAXATION], start + by) for by in (0.0, _LN10)
    )
    end = float(np.exp(last.value))
    sure = np.exp(-_SURE * last.value_std)
    equilibrium = float(np.exp(before.value)) / end
    # of d(ln G)/d(ln rate), in moduli at the slow end
    most = max(last.slope + _SURE * last.slope_std, 0.0)
    # flat within the scatter: what it may hide within one decade
    if last.slope < _SURE * last.slope_std:
        return end * (sure - most), end
    least = equilibrium * (before.slope - _SURE * before.slope_std)
    power = np.log10(least / most) if least > most else 0.0
    return (end * (sure - most * 10 ** (-power / 2) / power) if power > 0 else 0.0), end


def _line(
    points: MeasuredPoints, channel: int, noise: float, start: float
) -> _SlowLine:
    """A straight line through ln(modulus) over the decade from ln(rate) `start` on."""
    indices = np.flatnonzero(
        (points.channel == channel) & (points.log_rate >= start - 1e-9)
    )
    indices = indices[np.argsort(points.log_rate[indices], kind="stable")]
    inside = int((points.log_rate[indices] <= start + _LN10).sum())
    indices = indices[: max(inside, _FEWEST)]
    u = points.log_rate[indices] - start
    if np.unique(u).size < 2:
        return _SlowLine(
            float(points.log_value[indices].mean()) if indices.size else 0.0,
            0.0,
            np.inf,
            noise,
        )
    design = np.stack([np.ones(u.size), u], axis=1)
    inverse = np.linalg.inv(design.T @ design)
    p = inverse @ design.T @ points.log_value[indices]
    off = points.log_value[indices] - design @ p
    size = max(noise, float(np.sqrt(off @ off / max(u.size - 2, 1))))
    return _SlowLine(
        float(p[0]), float(p[1]), *(size * np.sqrt(np.diag(inverse))[::-1]).tolist()
    )
