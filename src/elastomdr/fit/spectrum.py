"""A smooth relaxation spectrum on log-spaced times, and what it predicts: storage and loss modulus, relaxation.

G(t) = G_eq + sum_k H_k exp(-t/tau_k) with H_k > 0, four tau_k per decade: fine enough for the sum to stand for a
continuous spectrum (the ripples are of 1e-7), and each may move a little, so that it can stand for a sharp line. The
unknowns are logarithms, so that every answer is passive.
"""

from typing import NamedTuple

import numpy as np

STORAGE, LOSS, RELAXATION = 0, 1, 2  # what a measured value is
CHANNELS = ("storage modulus", "loss modulus", "relaxation modulus")
PER_DECADE = 4
_MARGIN = 2.0  # decades of relaxation times beyond the data, on either side
_REACH = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 9.0  # weights of a neighbourhood, nearly a decade wide
_LARGEST = 700.0  # of an exponent: exp(700) is still a float64


class Points(NamedTuple):
    """Measured values, one row each, whatever they are of."""

    channel: np.ndarray  # STORAGE, LOSS or RELAXATION
    log_rate: np.ndarray  # ln(omega), or ln(1/t) for relaxation, omega in rad/s and t in s
    log_value: np.ndarray  # ln(modulus), modulus in Pa
    isotherm: np.ndarray  # number of the isotherm it belongs to
    offset: np.ndarray  # log10 a_T expected of the point's own temperature within its isotherm


class Prediction(NamedTuple):
    """ln of the predicted values, and derivatives with respect to ln H_k, ln G_eq, ln(omega) and ln tau_k.

    `by_neighbours` is by ln H_k too, but as if H_k were the mean of its neighbourhood: a branch that the most probable
    spectrum leaves empty, beside a full one, may well be there, which the derivative by its logarithm does not see.
    """

    log_value: np.ndarray  # (points,)
    by_spectrum: np.ndarray  # (points, times)
    by_equilibrium: np.ndarray  # (points,)
    by_rate: np.ndarray  # (points,)
    by_neighbours: np.ndarray  # (points, times)
    by_place: np.ndarray  # (points, times), with respect to ln tau_k


def nodes(log_rate: np.ndarray) -> np.ndarray:
    """ln of relaxation times that cover data at these ln(omega), with a margin on either side."""
    ln10 = np.log(10.0)
    low, high = -log_rate.max() - _MARGIN * ln10, -log_rate.min() + _MARGIN * ln10
    count = int(np.ceil((high - low) / ln10 * PER_DECADE)) + 1
    middle, half = 0.5 * (low + high), 0.5 * (count - 1) * ln10 / PER_DECADE
    return np.linspace(middle - half, middle + half, count)


def predict(
    channel: np.ndarray, log_rate: np.ndarray, log_times: np.ndarray, log_spectrum: np.ndarray, equilibrium: float
) -> Prediction:
    """What a spectrum predicts for points of any channel, at ln(omega) or ln(1/t) of shape (points,)."""
    heights = np.exp(np.clip(log_spectrum, -_LARGEST, _LARGEST))
    kernels, places = np.empty((2, log_rate.size, log_times.size))
    level = np.where(channel == LOSS, 0.0, equilibrium)
    for which in np.unique(channel):
        at = channel == which
        kernels[at], places[at] = _kernel(which, log_rate[at, None] + log_times)
    value = np.maximum(kernels @ heights + level, 1e-300)
    kernels /= value[:, None]
    places *= heights / value[:, None]
    spread = np.convolve(np.pad(heights, _REACH.size // 2, mode="edge"), _REACH, mode="valid")
    slope = places.sum(axis=1)
    return Prediction(np.log(value), kernels * heights, level / value, slope, kernels * spread, places)


def _kernel(channel: int, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The contribution of a unit branch at u = ln(omega tau) and its derivative in u."""
    u = np.clip(u, -_LARGEST / 2, _LARGEST / 2)
    if channel == RELAXATION:
        x = np.exp(-u)
        value = np.exp(-x)
        return value, x * value
    storage = 1 / (1 + np.exp(-2 * u))
    if channel == STORAGE:
        return storage, 2 * storage * (1 - storage)
    loss = 0.5 / np.cosh(u)
    return loss, loss * (1 - 2 * storage)
