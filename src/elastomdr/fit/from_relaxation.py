"""The loss modulus, which makes friction, from relaxation: a smooth estimate for the
series, and its range.

Few exponentials that meet G(t) exactly may have a loss modulus that is several per cent
off, too small near the fast end above all: relaxation from t_0 on has lost what relaxes
within t_0, and that is still a part of the loss at angular frequencies a decade or two
below 1/t_0 (of order (omega t_0)^(1 - n) where G ~ t^-n). The smooth spectrum carries
on.
"""

import itertools
from collections.abc import Callable

import numpy as np

from .findings import TWO_SIGMA
from .joint import AtReference, Joint, curve
from .spectrum import LOSS, RELAXATION, Points
from .terms import Data

_LN10 = float(np.log(10.0))
# times 1/t, the largest angular frequency that relaxation from t on says something of
_EARLY = 0.1
_PER_DECADE = 6  # estimates of the loss modulus
# half a 95 % interval of ln(loss modulus) up to which relaxation determines it,
_KNOWN = 0.03
# or times the smallest such interval, where it is known nearly as well as anywhere,
_BEST = 1.5
_LEAST_KNOWN = 0.06  # but never a wider one: noisier data would seem to determine more
# decades; over fewer, what seems to be known is where errors happen to cancel
_SHORTEST = 0.5
# decades between neighbouring dynamic points from which the loss modulus between them
# may be unknown
_WIDE = 0.5
# standard deviation of ln(loss modulus) above which an estimate is worth nothing
_WIDEST = 0.5


def with_loss(data: Data, joint: Joint, state: AtReference) -> Data:
    """Data with the smooth spectrum's loss modulus added where there is relaxation and
    no dynamic modulus.

    Each estimate counts by its own uncertainty; `Data.measured` says that they are not
    data.
    """
    rate = _grid(data.points)
    if not rate.size:
        return data
    value, std = curve(joint, state, rate, np.full(rate.size, LOSS))
    sure = std < _WIDEST
    rate, value, std = rate[sure], value[sure], std[sure]
    noise = data.noise.copy()
    if not (data.points.channel == LOSS).any():
        noise[LOSS] = noise[RELAXATION]
    weights = np.minimum((noise[LOSS] / std) ** 2, 1.0) * data.alike
    more = Points(
        np.full(rate.size, LOSS),
        rate,
        value,
        np.zeros(rate.size, dtype=int),
        np.zeros(rate.size),
    )
    return Data(
        Points(*(np.concatenate(both) for both in zip(data.points, more, strict=True))),
        noise,
        np.concatenate([data.weights, weights]),
        data.alike,
        data.points.channel.size,
    )


def known_range(
    points: Points,
    joint: Joint,
    state: AtReference,
    loss: Callable[[np.ndarray], np.ndarray],
) -> tuple[float, float] | tuple[()]:
    """Angular frequencies at which the moduli of a series are known: those of dynamic
    data, and where relaxation determines its loss modulus to 3 %, or nearly as well as
    anywhere, and nowhere between to worse than 6 %; rounded [rad/s].

    The widest stretch, of half a decade at least; () where there is none. Relaxation
    and dynamic data, or isotherms of dynamic data that do not overlap, make one stretch
    where the loss modulus is known between them too.
    """
    dynamic = np.unique(points.log_rate[points.channel != RELAXATION])
    unknown = [
        gap
        for gap in itertools.pairwise(dynamic)
        if np.ptp(gap) > _WIDE * _LN10 and _unknown(joint, state, gap, loss)
    ]
    edges = [*dynamic[:1], *(x for gap in unknown for x in gap), *dynamic[-1:]]
    ends = [
        float(x)
        for x in max(zip(edges[::2], edges[1::2], strict=True), key=np.ptp, default=())
    ]
    rate = _grid(points)
    if rate.size:
        half = _half(joint, state, rate, loss)
        relaxed = _widest(
            rate, half, float(np.clip(_BEST * half.min(), _KNOWN, _LEAST_KNOWN))
        )
        both = bool(ends and relaxed)
        if both and _unknown(
            joint,
            state,
            (min(max(ends), max(relaxed)), max(min(ends), min(relaxed))),
            loss,
        ):
            ends = max(ends, relaxed, key=np.ptp)
        else:
            ends += relaxed
    if not ends:
        return ()
    low, high = (float(f"{np.exp(x):.4g}") for x in (min(ends), max(ends)))
    return low, high


def known_to(
    joint: Joint,
    state: AtReference,
    window: tuple[float, float],
    limits: tuple[float, float] | tuple[()],
    loss: Callable[[np.ndarray], np.ndarray],
) -> str:
    """How well the loss modulus of a series is known between two angular frequencies
    [rad/s], in words.

    Half of the widest 95 % interval, that of the smooth spectrum widened by its
    distance to the series. Without such limits, half of the narrowest within the
    `window` of relaxation data.
    """
    low, high = limits or (window[0], max(_EARLY * window[1], 1.001 * window[0]))
    rate = np.log(np.geomspace(low, high, _PER_DECADE * 4))
    half = 100 * _half(joint, state, rate, loss)
    if not limits:
        return (
            f"not measured, and known to {100 * _LEAST_KNOWN:g} % over no half "
            f"decade: at best to +- {half.min():.2g} % (95 %), at "
            f"{np.exp(rate[half.argmin()]):.3g} rad/s; friction is extrapolated"
        )
    return (
        f"not measured; the series has it to +- {half.max():.2g} % (95 %) from "
        f"{low:.3g} to {high:.3g} "
        "rad/s, and friction no better"
    )


def _unknown(
    joint: Joint,
    state: AtReference,
    gap: tuple[float, float],
    loss: Callable[[np.ndarray], np.ndarray],
) -> bool:
    """Whether between two ln(omega), ascending, the loss modulus is known to worse than
    6 % somewhere.
    """
    low, high = gap
    if high <= low:
        return False
    rate = np.linspace(low, high, int(np.ceil((high - low) / _LN10 * _PER_DECADE)) + 1)
    return bool(_half(joint, state, rate, loss).max() > _LEAST_KNOWN)


def _widest(rate: np.ndarray, half: np.ndarray, limit: float) -> list[float]:
    """Ends of the widest stretch whose intervals are within a limit at either end, and
    between within half as much again (`_BEST`), but nowhere above the widest that
    counts as known.
    """
    near = half <= min(_BEST * limit, _LEAST_KNOWN)
    # first of one, next after it
    edges = np.flatnonzero(np.diff(near, prepend=False, append=False))
    known = [
        rate[a:b][half[a:b] <= limit]
        for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]
    ends = [
        (float(x[0]), float(x[-1]))
        for x in known
        if x.size and np.ptp(x) >= _SHORTEST * _LN10
    ]
    return list(max(ends, key=np.ptp, default=()))


def _half(
    joint: Joint,
    state: AtReference,
    rate: np.ndarray,
    loss: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Half of the 95 % interval of ln(loss modulus) of a series at ln(omega), as
    `bands.dynamic_band` has it.
    """
    value, std = curve(joint, state, rate, np.full(rate.size, LOSS))
    return TWO_SIGMA * np.hypot(std, np.log(loss(np.exp(rate))) - value)


def _grid(points: Points) -> np.ndarray:
    """ln(omega) where relaxation says something and no dynamic modulus does."""
    relaxed = points.log_rate[points.channel == RELAXATION]
    if not relaxed.size:
        return relaxed
    low, high = relaxed.min(), max(relaxed.max() + np.log(_EARLY), relaxed.min() + 1e-3)
    rate = np.linspace(
        low, high, max(2, int(np.ceil((high - low) / _LN10 * _PER_DECADE)) + 1)
    )
    dynamic = points.log_rate[points.channel != RELAXATION]
    return (
        rate
        if not dynamic.size
        else rate[(rate < dynamic.min()) | (rate > dynamic.max())]
    )
