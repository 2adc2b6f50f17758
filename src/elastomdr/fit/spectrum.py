"""A smooth relaxation spectrum on log-spaced times, and what it predicts: storage and
loss modulus, relaxation.

G(t) = G_eq + sum_k H_k exp(-t/tau_k) with H_k > 0, four tau_k per decade: fine enough
for the sum to stand for a continuous spectrum (the ripples are of 1e-7), and each may
move a little, so that it can stand for a sharp line. The unknowns are logarithms, so
that every answer is passive.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

STORAGE, LOSS, RELAXATION = 0, 1, 2  # what a measured value is
CHANNELS = ("storage modulus", "loss modulus", "relaxation modulus")
PER_DECADE = 4
_MARGIN = 2.0  # decades of relaxation times beyond the data, on either side
# weights of a neighbourhood, nearly a decade wide
_REACH = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 9.0
_LARGEST = 700.0  # of an exponent: exp(700) is still a float64
# largest 1/(omega tau), and inverse of the smallest: their squares are still float64
_FAR = 1e150


class Points(NamedTuple):
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
        found = np.empty(self.x.shape)
        for which, at in _runs(self.channel):
            _bend(which, self.x[at], self.kernels[at], found[at])
        found /= self.value[:, None]
        return found

    @property
    def by_spectrum(self) -> np.ndarray:
        """(points, times), by ln H_k."""
        found = self.kernels * self.heights
        found /= self.value[:, None]
        return found

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
    for which, at in _runs(channel):
        _kernel(which, x[at], kernels[at])
    level = np.where(channel == LOSS, 0.0, equilibrium)
    value = np.maximum(kernels @ heights + level, 1e-300)
    return Prediction(np.log(value), heights, level / value, channel, value, x, kernels)


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
