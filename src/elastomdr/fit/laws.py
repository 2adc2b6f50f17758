"""WLF, Arrhenius and VFT laws through measured shift factors."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from ..material.shift import GAS_CONSTANT, VFT, WLF, Arrhenius

_LN10 = float(np.log(10.0))
_LEAST = 0.003  # standard deviation by which any such law may be off [decades]
_POLE = 1.0  # least distance of a law's pole below the data [K]
_MISSES = 0.1  # error of its own above which a law is not that of the shift factors [decades]


class LawFit(NamedTuple):
    """A shift law, how far each measured shift factor is from it, and how well its constants are known."""

    law: Any  # em.WLF, em.Arrhenius or em.VFT
    residuals: Float[np.ndarray, " n"]  # log10 a_T measured minus law [decades]
    std: dict[str, float]  # standard deviation of each constant, in its unit
    own: float  # how far the law is off beyond what the shift factors are known to, a standard deviation [decades]

    @property
    def rms(self) -> float:
        """Root mean square of the residuals [decades]."""
        return float(np.sqrt(np.mean(self.residuals**2)))

    @property
    def holds(self) -> bool:
        """Whether the shift factors follow the law, within what they are known to."""
        return self.own <= _MISSES

    def constants(self) -> str:
        """The constants with their units and 95 % intervals, in one line."""
        units = {"c1": "", "c2": " K", "energy": " J/mol", "b": " K", "t0": " K"}
        return ", ".join(
            f"{key} {float(getattr(self.law, key)):.4g} +- {1.96 * std:.2g}{units[key]}"
            for key, std in self.std.items()
        )

    def at_reference(self, temperature: float) -> Any:
        """The same law about another reference temperature [K]."""
        if isinstance(self.law, WLF):
            return self.law.at_reference(temperature)
        if isinstance(self.law, VFT):
            return VFT(self.law.b, self.law.t0, temperature)
        return Arrhenius(self.law.energy, temperature)


def fit_laws(
    temperature: np.ndarray, log10_a: np.ndarray, covariance: np.ndarray, reference: float
) -> dict[str, LawFit]:
    """The laws that pass through 0 at `reference` [K] and come closest to shift factors with this covariance.

    A law may be off by more than the measurement: a part of its own is added to the covariance until the misfit is
    what it should be. "Arrhenius" needs two temperatures, "WLF" and "VFT" three; laws that cannot be fitted are left
    out.
    """
    fits: dict[str, LawFit] = {}
    distinct = np.abs(temperature - reference) > 1e-6
    above = temperature - reference
    lowest = min(temperature.min(), reference)

    def wlf(p: np.ndarray) -> np.ndarray:
        c2 = reference - lowest + _POLE + np.exp(p[1])
        return -np.exp(p[0]) * above / (c2 + above)

    def vft(p: np.ndarray) -> np.ndarray:
        t0 = (lowest - _POLE) / (1 + np.exp(-p[1]))
        return np.exp(p[0]) * (1 / (temperature - t0) - 1 / (reference - t0)) / _LN10

    def arrhenius(p: np.ndarray) -> np.ndarray:
        return np.exp(p[0]) / GAS_CONSTANT * (1 / temperature - 1 / reference) / _LN10

    if distinct.sum() >= 1 and temperature.size >= 2:
        p, spread, own = _fit(arrhenius, [np.log(1e5)], [(5.0, 16.0)], log10_a, covariance)
        energy = float(np.exp(p[0]))
        fits["Arrhenius"] = LawFit(
            Arrhenius(energy, reference), log10_a - arrhenius(p), {"energy": energy * np.sqrt(spread[0, 0])}, own
        )
    if temperature.size >= 3:
        p, spread, own = _fit(wlf, [2.0, 4.0], [(-4.0, 8.0), (-3.0, 9.0)], log10_a, covariance)
        c1, gap = float(np.exp(p[0])), float(np.exp(p[1]))
        std = {"c1": c1 * np.sqrt(spread[0, 0]), "c2": gap * np.sqrt(spread[1, 1])}
        fits["WLF"] = LawFit(WLF(c1, reference - lowest + _POLE + gap, reference), log10_a - wlf(p), std, own)
        p, spread, own = _fit(vft, [7.0, 0.5], [(2.0, 14.0), (-8.0, 8.0)], log10_a, covariance)
        b, part = float(np.exp(p[0])), float(1 / (1 + np.exp(-p[1])))
        std = {"b": b * np.sqrt(spread[0, 0]), "t0": (lowest - _POLE) * part * (1 - part) * np.sqrt(spread[1, 1])}
        fits["VFT"] = LawFit(VFT(b, (lowest - _POLE) * part, reference), log10_a - vft(p), std, own)
    return fits


def at_reference(
    temperature: np.ndarray, log10_a: np.ndarray, covariance: np.ndarray, reference: float
) -> tuple[np.ndarray, float]:
    """Weights of the temperatures whose mean log10 a_T stands for that at `reference` [K], and what to add to it.

    Weights are those of linear interpolation, or all on the last temperature beyond the ends; a law through the shift
    factors bends away from the straight line by what is added [decades].
    """
    n = temperature.size
    weights = np.zeros(n)
    place = np.interp(reference, temperature, np.arange(n))
    low = min(int(place), max(n - 2, 0))
    weights[low] = 1 - (place - low)
    if n == 1:
        return weights, 0.0
    weights[low + 1] = place - low
    if np.abs(temperature - reference).min() < 1e-9:  # there is nothing between to bend
        return weights, 0.0
    centre = int(np.argmin(np.abs(temperature - reference)))
    change = np.eye(n)
    change[:, centre] -= 1
    laws = fit_laws(temperature, change @ log10_a, change @ covariance @ change.T, float(temperature[centre]))
    law = laws["WLF" if n > 2 else "Arrhenius"].law
    return weights, float(law._log10_a(reference)) - float(weights @ np.asarray(law._log10_a(temperature)))


def _fit(
    law: Any, start: list[float], limits: list[tuple[float, float]], value: np.ndarray, covariance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Generalised least squares, with the law's own error grown until chi squared matches the freedom left."""
    own, p = _LEAST, np.array(start)
    bounds = np.array(limits).T
    spread = np.eye(p.size)
    for _ in range(8):
        white = np.linalg.inv(np.linalg.cholesky(covariance + own**2 * np.eye(value.size)))
        answer = least_squares(
            lambda p, white=white: white @ (value - law(p)),
            p,
            lambda p, white=white: -white @ _derivatives(law, p),  # pyright: ignore[reportArgumentType]
            bounds=bounds,
            x_scale=1.0,
        )
        p = answer.x
        spread = np.linalg.pinv(answer.jac.T @ answer.jac)
        excess = 2 * answer.cost / max(value.size - p.size, 1)
        if excess <= 1.2:
            break
        own *= min(np.sqrt(excess), 4.0)
    return p, spread, float(own)


def _derivatives(law: Any, p: np.ndarray) -> np.ndarray:
    """The derivatives of a law with respect to its parameters, from a step along the imaginary axis: exact."""
    step = 1e-30
    return np.stack([law(p + 1j * step * row).imag for row in np.eye(p.size)], axis=1) / step
