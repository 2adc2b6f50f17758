"""How much storage modulus, loss modulus and relaxation count against each other in a
Prony series.

Each counts by its scatter. A passive material's moduli determine each other (Kramers
and Kronig), so that data may contradict themselves: then no weights meet both, and
relative deviations of both count alike, which is what foretells points that were left
out best (`benchmarks/fit_balance.py`). What other weights would give is in `trade_off`.
"""

from typing import NamedTuple

import numpy as np

from .passive import closest
from .spectrum import LOSS, STORAGE, Points

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
    noise: np.ndarray, points: Points, balance: float | None
) -> tuple[np.ndarray, bool]:
    """Standard deviations that the kinds of modulus are weighed with, and whether the
    moduli contradict each other.

    They are the scatter between neighbouring points, where that is less than the misfit
    of a smooth spectrum, within limits. Where the misfit is large and not scatter,
    storage and loss modulus may contradict each other.
    """
    present, scatter = np.unique(points.channel), _scatter(points)
    both, worst = (
        LOSS in present and STORAGE in present,
        present[noise[present].argmax()],
    )
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


def trade_off(points: Points) -> tuple[Met, ...]:
    """Of all passive materials those closest to storage and loss modulus, by the weight
    of the storage modulus.
    """
    at = points.channel <= LOSS
    found = []
    for balance in _BALANCES:
        near = closest(
            points.log_rate[at],
            points.log_value[at],
            points.channel[at] == STORAGE,
            balance,
        )
        if near is not None:
            found.append(Met(balance, near.storage, near.loss))
    return tuple(found)


def verdict(met: tuple[Met, ...], storage: float, loss: float) -> str:
    """What the trade-off says of a series with these rms deviations; "" without one."""
    alike = next((one for one in met if one.balance == 1.0), None)
    if alike is None:
        return ""
    closest = f"{100 * alike.storage:.2g} and {100 * alike.loss:.2g} %"
    if np.hypot(storage, loss) > _CLOSEST * alike.whole:
        return (
            "; the closest passive material meets storage and loss modulus to "
            f"{closest}, more terms may help."
        )
    return (
        ": storage and loss modulus contradict each other, no passive material comes "
        f"closer to both than {closest}; "
        "balance=... favours one of them."
    )


def _scatter(points: Points) -> np.ndarray:
    """Standard deviation of ln(value) about the line between its neighbours in
    frequency, by channel, or NaN.
    """
    found = np.full(3, np.nan)
    for channel in np.unique(points.channel):
        at = np.flatnonzero(points.channel == channel)
        at = at[np.argsort(points.log_rate[at], kind="stable")]
        if at.size < 5:
            continue
        x, y = points.log_rate[at], points.log_value[at]
        part = (x[1:-1] - x[:-2]) / np.maximum(x[2:] - x[:-2], 1e-12)
        off = (y[1:-1] - (1 - part) * y[:-2] - part * y[2:]) / np.sqrt(
            1 + part**2 + (1 - part) ** 2
        )
        found[channel] = 1.4826 * np.median(np.abs(off))  # an outlier is not scatter
    return found
