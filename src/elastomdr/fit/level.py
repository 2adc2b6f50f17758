"""The equilibrium modulus from the slow end of the data: how far the modulus may still
fall below the window.

Relaxation slower than the data shows at their slow end: it makes loss there, and keeps
the modulus falling. A power law, as of a fractional element (spring-pot) beside a
spring, carries the end on (omega: lowest angular frequency, t: longest time):

    G_eq = G' - G''/tan(m pi/2),  G'' ~ omega^m   or   G_eq = G - D/m,  D = -dG/d(ln t) ~ t^-m.

m = 1 is the end of all relaxation, G' = G_eq; m -> 0, a loss as large at every
frequency, leaves nothing for sure. The lower limit of the interval takes the least m
that the slowest decade of the data allows.
"""

from typing import NamedTuple

import numpy as np

from .spectrum import LOSS, RELAXATION, STORAGE, Points

_LN10 = float(np.log(10.0))
_FEWEST = 6  # points that a slope is taken from, or all there are
_SURE = 2.0  # standard deviations
# part of the modulus at the slow end that may still relax, above which the window sets
# the level
_OPEN = 0.1


class SlowEnd(NamedTuple):
    """Between which values the modulus ends that the data leave at `end`."""

    low: float  # least equilibrium modulus [Pa]
    end: float  # modulus at the slow end of the data [Pa]
    rate: float  # lowest angular frequency, or inverse of the longest time [rad/s]
    kind: str  # of the modulus that is followed: "storage" or "relaxation"

    @property
    def open(self) -> bool:
        """Whether the level is set by where the data end, and not by the material."""
        return self.end - self.low > _OPEN * self.end


class _Line(NamedTuple):
    value: float  # ln(modulus) at its slow end
    slope: float  # d(ln modulus)/d(ln rate)
    slope_std: float
    value_std: float


def slow_end(points: Points, noise: np.ndarray) -> SlowEnd:
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


def _from_loss(points: Points, noise: np.ndarray, start: float) -> tuple[float, float]:
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
    points: Points, noise: np.ndarray, start: float
) -> tuple[float, float]:
    last, before = (
        _line(points, RELAXATION, noise[RELAXATION], start + by) for by in (0.0, _LN10)
    )
    end = float(np.exp(last.value))
    sure = np.exp(-_SURE * last.value_std)
    level = float(np.exp(before.value)) / end
    # of d(ln G)/d(ln rate), in moduli at the slow end
    most = max(last.slope + _SURE * last.slope_std, 0.0)
    # flat within the scatter: what it may hide within one decade
    if last.slope < _SURE * last.slope_std:
        return end * (sure - most), end
    least = level * (before.slope - _SURE * before.slope_std)
    power = np.log10(least / most) if least > most else 0.0
    return (end * (sure - most * 10 ** (-power / 2) / power) if power > 0 else 0.0), end


def _line(points: Points, channel: int, noise: float, start: float) -> _Line:
    """A straight line through ln(modulus) over the decade from ln(rate) `start` on."""
    at = np.flatnonzero((points.channel == channel) & (points.log_rate >= start - 1e-9))
    at = at[np.argsort(points.log_rate[at], kind="stable")]
    inside = int((points.log_rate[at] <= start + _LN10).sum())
    at = at[: max(inside, _FEWEST)]
    u = points.log_rate[at] - start
    if np.unique(u).size < 2:
        return _Line(
            float(points.log_value[at].mean()) if at.size else 0.0, 0.0, np.inf, noise
        )
    design = np.stack([np.ones(u.size), u], axis=1)
    inverse = np.linalg.inv(design.T @ design)
    p = inverse @ design.T @ points.log_value[at]
    off = points.log_value[at] - design @ p
    size = max(noise, float(np.sqrt(off @ off / max(u.size - 2, 1))))
    return _Line(
        float(p[0]), float(p[1]), *(size * np.sqrt(np.diag(inverse))[::-1]).tolist()
    )
