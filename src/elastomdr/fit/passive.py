"""The passive material closest to storage and loss modulus: a non-negative spectrum by
their relative errors.

G' = G_eq + sum_k H_k x_k^2/(1 + x_k^2) and G'' = eta omega + sum_k H_k x_k/(1 + x_k^2),
x_k = omega tau_k, H_k >= 0, on a grid of relaxation times that reaches beyond the data.
A check of data, not a fit: that is `fit.terms`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.optimize import nnls

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_PER_DECADE = 4  # relaxation times,
_MARGIN = 2.3  # how far beyond the data ln(tau) goes on either side,
_MOST_TIMES = 200  # and how many at most
# |ln| of a modulus over the median one, and of omega tau: what is beyond is damaged
_LARGEST = 100.0


class Passive(NamedTuple):
    """Rates ln(1/tau_k), the moduli at them and at rest over exp(level), and the rms
    relative misfit.
    """

    log_rates: Float[np.ndarray, " k"]
    moduli: Float[np.ndarray, " k"]
    equilibrium: float
    level: float  # median ln(modulus)
    misfit: float
    storage: float  # rms relative misfit of the storage modulus,
    loss: float  # and of the loss modulus

    def log_relaxation(
        self, log_rate: Float[np.ndarray, " n"]
    ) -> Float[np.ndarray, " n"]:
        """ln G(t) at ln(1/t)."""
        past = np.exp(np.clip(self.log_rates - log_rate[:, None], -_LARGEST, _LARGEST))
        return self.level + np.log(
            np.maximum(np.exp(-past) @ self.moduli + self.equilibrium, 1e-300)
        )


def closest(
    log_rate: Float[np.ndarray, " m"],
    log_value: Float[np.ndarray, " m"],
    storage: Bool[np.ndarray, " m"],
    balance: float = 1.0,
) -> Passive | None:
    """The closest one to ln(modulus) at ln(omega), `storage` or else loss; None where
    none is found.

    `balance` is by how much more a relative deviation of the storage modulus counts.
    """
    low, high = log_rate.min() - _MARGIN, log_rate.max() + _MARGIN
    count = min(
        int(np.ceil(_PER_DECADE * (high - low) / np.log(10.0))) + 1, _MOST_TIMES
    )
    rates = np.linspace(high, low, count)
    x = np.exp(np.clip(log_rate[:, None] - rates, -_LARGEST, _LARGEST))
    storage = storage[:, None]
    spring, dashpot = storage * 1.0, ~storage * x[:, -1:] / x[:, -1].max()
    level = float(np.median(log_value))
    scale = np.exp(np.clip(level - log_value, -_LARGEST, _LARGEST))[:, None]
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
    off, at = (matrix @ moduli - 1) ** 2, storage[:, 0]
    parts = (
        float(np.sqrt(part.mean())) if part.size else 0.0
        for part in (off, off[at], off[~at])
    )
    return Passive(rates, moduli[:count], float(moduli[count]), level, *parts)
