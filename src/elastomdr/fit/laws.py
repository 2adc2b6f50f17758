"""WLF, Arrhenius and VFT laws through measured shift factors."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..material.shift import GAS_CONSTANT, VFT, WLF, Arrhenius

if TYPE_CHECKING:
    from jaxtyping import Float

_LN10 = float(np.log(10.0))
_LEAST = 0.003  # standard deviation by which any such law may be off [decades]
POLE = 1.0  # least distance of a law's pole below the data [K]
_AT_BOUND = 0.01  # distance of a logarithm from its limit at which it is held by it
# error of its own above which a law is not that of the shift factors [decades]
MISSES = 0.1


class LawFit(NamedTuple):
    """A shift law, how far each measured shift factor is from it, and how well its
    constants are known.
    """

    law: Any  # em.WLF, em.Arrhenius or em.VFT
    residuals: Float[np.ndarray, " n"]  # log10 a_T measured minus law [decades]
    std: dict[str, float]  # standard deviation of each constant, in its unit
    # whether a constant is at the end of what the search allows, so that its
    # uncertainty means nothing
    bound: bool
    # how far the law is off beyond what the shift factors are known to, a standard
    # deviation [decades]
    own: float

    @property
    def rms(self) -> float:
        """Root mean square of the residuals [decades]."""
        return float(np.sqrt(np.mean(self.residuals**2)))

    @property
    def holds(self) -> bool:
        """Whether the shift factors follow the law, within what they are known to."""
        return self.own <= MISSES

    @property
    def determined(self) -> bool:
        """Whether the data know every constant better than by its own size."""
        return (
            all(
                1.96 * std < float(getattr(self.law, key))
                for key, std in self.std.items()
            )
            and not self.bound
        )

    def constants(self) -> str:
        """The constants with their units and 95 % intervals, in one line, or that the
        data do not determine them.
        """
        units = {"c1": "", "c2": " K", "energy": " J/mol", "b": " K", "t0": " K"}
        if not self.determined:
            return f"{' and '.join(self.std)} not determined by these data"
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
    temperature: np.ndarray,
    log10_a: np.ndarray,
    covariance: np.ndarray,
    reference: float,
) -> dict[str, LawFit]:
    """The laws that pass through 0 at `reference` [K] and come closest to shift factors
    with this covariance.

    A law may be off by more than the measurement: a part of its own is added to the
    covariance until the misfit is what it should be. "Arrhenius" needs two
    temperatures, "WLF" and "VFT" three; laws that cannot be fitted are left out.
    """
    fits: dict[str, LawFit] = {}
    known = forms(reference, min(temperature.min(), reference))
    if temperature.size < 2 or (np.abs(temperature - reference) > 1e-6).sum() < 1:
        return fits
    for name in (
        ("Arrhenius", "WLF", "VFT") if temperature.size >= 3 else ("Arrhenius",)
    ):
        p, spread, own = fit_form(known[name], temperature, log10_a, covariance)
        law, by_p = known[name].constants(p)
        std = {
            key: float(abs(slope) * np.sqrt(spread[k, k]))
            for k, (key, slope) in enumerate(by_p.items())
        }
        residuals = log10_a - known[name].value(p, temperature)
        fits[name] = LawFit(law, residuals, std, _at_bound(known[name], p), own)
    return fits


class Form(NamedTuple):
    """A law in parameters that may take any value."""

    value: Callable[[np.ndarray, Any], Any]  # parameters, temperature [K] -> log10 a_T
    start: list[float]
    limits: list[tuple[float, float]]
    # the law, d(constant)/d(its parameter) by name
    constants: Callable[[np.ndarray], tuple[Any, dict[str, float]]]


def forms(reference: float, lowest: float) -> dict[str, Form]:
    """The laws about `reference` [K]; their poles are below `lowest` [K]."""
    room = reference - lowest + POLE

    def wlf(p: np.ndarray, temperature: Any) -> Any:
        above = temperature - reference
        return -np.exp(p[0]) * above / (room + np.exp(p[1]) + above)

    def vft(p: np.ndarray, temperature: Any) -> Any:
        t0 = (lowest - POLE) / (1 + np.exp(-p[1]))
        return np.exp(p[0]) * (1 / (temperature - t0) - 1 / (reference - t0)) / _LN10

    def arrhenius(p: np.ndarray, temperature: Any) -> Any:
        return np.exp(p[0]) / GAS_CONSTANT * (1 / temperature - 1 / reference) / _LN10

    def wlf_constants(p: np.ndarray) -> tuple[Any, dict[str, float]]:
        c1, gap = float(np.exp(p[0])), float(np.exp(p[1]))
        return WLF(c1, room + gap, reference), {"c1": c1, "c2": gap}

    def vft_constants(p: np.ndarray) -> tuple[Any, dict[str, float]]:
        b, part = float(np.exp(p[0])), float(1 / (1 + np.exp(-p[1])))
        return VFT(b, (lowest - POLE) * part, reference), {
            "b": b,
            "t0": (lowest - POLE) * part * (1 - part),
        }

    def arrhenius_constants(p: np.ndarray) -> tuple[Any, dict[str, float]]:
        energy = float(np.exp(p[0]))
        return Arrhenius(energy, reference), {"energy": energy}

    return {
        "Arrhenius": Form(
            arrhenius, [float(np.log(1e5))], [(5.0, 16.0)], arrhenius_constants
        ),
        "WLF": Form(wlf, [2.0, 4.0], [(-4.0, 8.0), (-3.0, 9.0)], wlf_constants),
        "VFT": Form(vft, [7.0, 0.5], [(2.0, 14.0), (-8.0, 8.0)], vft_constants),
    }


def _at_bound(form: Form, p: np.ndarray) -> bool:
    low, high = np.array(form.limits).T
    return bool(((p - low < _AT_BOUND) | (high - p < _AT_BOUND)).any())


def fit_form(
    form: Form, temperature: np.ndarray, value: np.ndarray, covariance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Generalised least squares, with the law's own error grown until chi squared
    matches the freedom left.

    Returns the parameters, their covariance, and that error [decades].
    """
    own, p = _LEAST, np.array(form.start)
    bounds = np.array(form.limits).T
    spread = np.eye(p.size)
    for _ in range(8):
        white = np.linalg.inv(
            np.linalg.cholesky(covariance + own**2 * np.eye(value.size))
        )
        answer = least_squares(
            lambda p, white=white: white @ (value - form.value(p, temperature)),
            p,
            lambda p, white=white: -white @ derivatives(form, p, temperature),  # pyright: ignore[reportArgumentType]
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


def derivatives(form: Form, p: np.ndarray, temperature: np.ndarray) -> np.ndarray:
    """The derivatives of a law with respect to its parameters, from a step along the
    imaginary axis: exact.
    """
    step = 1e-30
    return (
        np.stack(
            [
                form.value(p + 1j * step * row, temperature).imag
                for row in np.eye(p.size)
            ],
            axis=1,
        )
        / step
    )
