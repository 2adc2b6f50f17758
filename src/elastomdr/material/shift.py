"""Time-temperature superposition: the factor a_T by which all relaxation times grow
when the material cools.
"""

from __future__ import annotations

import abc
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import xp
from ..checks import (
    Array,
    alike,
    as_float64,
    ascending,
    in_float64,
    in_kelvin,
    is_traced,
    not_negative,
    numpy_unless_traced,
    positive,
    require,
    scalar,
    written,
)
from ..errors import InputError
from ..trees import Tree, fill

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number

GAS_CONSTANT = 8.31446261815324  # R [J/(mol K)], CODATA 2018 (exact)
_LN10 = float(np.log(10.0))


class AbstractShift(Tree):
    """A shift law; `a(T)` is tau(T)/tau(reference), so that it is 1 at the reference
    temperature.
    """

    if TYPE_CHECKING:  # declared by each law, in an order of its own
        reference: Float[Array, ""]  # [K]

    def __repr__(self) -> str:
        return written(self)

    @abc.abstractmethod
    def _log10_a(self, temperature: Array) -> Array:
        """log10 a_T, at temperatures [K] that `_check` has let pass."""

    @abc.abstractmethod
    def _check(self, temperature: Any) -> None:
        """Raises `InputError` where the law does not hold."""

    @numpy_unless_traced
    def log10_a(self, temperature: ArrayLike) -> Array:
        """log10 a_T at temperatures [K], any shape. Raises `InputError` outside the
        law's range.
        """
        temperature = as_float64("temperature", temperature)
        in_kelvin("temperature", temperature)
        self._check(temperature)
        return self._log10_a(temperature)

    @numpy_unless_traced
    def a(self, temperature: ArrayLike) -> Array:
        """Shift factor a_T at temperatures [K], any shape."""
        # close above the pole: infinite, for the caller to judge
        with np.errstate(over="ignore"):
            return 10.0 ** self.log10_a(temperature)

    @in_float64
    def activation_energy(self, temperature: ArrayLike) -> Array:
        """Apparent activation energy R d(ln a_T)/d(1/T) [J/mol] at temperatures [K],
        any shape.
        """
        import jax

        self.log10_a(temperature)
        kelvin = xp.asarray(as_float64("temperature", temperature))
        _, slope = jax.jvp(self._log10_a, (kelvin,), (xp.ones_like(kelvin),))
        return -GAS_CONSTANT * kelvin**2 * _LN10 * slope


class WLF(AbstractShift):
    """log10 a_T = -c1 (T - T_ref)/(c2 + T - T_ref), above T_ref - c2 (Williams, Landel
    & Ferry 1955).
    """

    c1: Float[Array, ""]
    c2: Float[Array, ""]  # [K]
    reference: Float[Array, ""]  # [K]

    def __init__(self, c1: Number, c2: Number, reference: Number):
        fill(
            self,
            c1=scalar("c1", c1),
            c2=scalar("c2", c2),
            reference=scalar("reference", reference),
        )
        positive("c1", self.c1)
        positive("c2", self.c2)
        in_kelvin("reference", self.reference)

    def _log10_a(self, temperature: Array) -> Array:
        above = temperature - self.reference
        return -self.c1 * above / (self.c2 + above)

    def _check(self, temperature: Any) -> None:
        _above_pole("WLF", temperature, self.reference - self.c2)

    def at_reference(self, temperature: Number) -> "WLF":
        """The same law written about another reference temperature [K]."""
        temperature = scalar("temperature", temperature)
        self._check(temperature)
        c2 = self.c2 + temperature - self.reference
        return WLF(self.c1 * self.c2 / c2, c2, temperature)

    def to_vft(self) -> "VFT":
        """The same law in Vogel's form."""
        return VFT(_LN10 * self.c1 * self.c2, self.reference - self.c2, self.reference)


class VFT(AbstractShift):
    """ln a_T = b/(T - t0) - b/(T_ref - t0), above t0 (Vogel 1921, Fulcher 1925, Tammann
    1926).
    """

    b: Float[Array, ""]  # [K]
    t0: Float[Array, ""]  # Vogel temperature [K]
    reference: Float[Array, ""]  # [K]

    def __init__(self, b: Number, t0: Number, reference: Number):
        fill(
            self,
            b=scalar("b", b),
            t0=scalar("t0", t0),
            reference=scalar("reference", reference),
        )
        positive("b", self.b)
        in_kelvin("reference", self.reference)
        not_negative("t0", self.t0)
        if not is_traced(self.reference):
            reference = float(self.reference)
            require(
                "t0",
                self.t0,
                f"below the reference temperature, {reference:g} K",
                lambda t: t < reference,
            )

    def _log10_a(self, temperature: Array) -> Array:
        return (
            self.b
            * (1 / (temperature - self.t0) - 1 / (self.reference - self.t0))
            / _LN10
        )

    def _check(self, temperature: Any) -> None:
        _above_pole("VFT", temperature, self.t0)

    def to_wlf(self) -> WLF:
        """The same law in the form of Williams, Landel and Ferry."""
        c2 = self.reference - self.t0
        return WLF(self.b / (_LN10 * c2), c2, self.reference)


class Arrhenius(AbstractShift):
    """ln a_T = (energy/R) (1/T - 1/T_ref)."""

    energy: Float[Array, ""]  # activation energy [J/mol]
    reference: Float[Array, ""]  # [K]

    def __init__(self, energy: Number, reference: Number):
        fill(
            self,
            energy=scalar("energy", energy),
            reference=scalar("reference", reference),
        )
        positive("energy", self.energy)
        in_kelvin("reference", self.reference)

    def _log10_a(self, temperature: Array) -> Array:
        return (
            self.energy / GAS_CONSTANT * (1 / temperature - 1 / self.reference) / _LN10
        )

    def _check(self, temperature: Any) -> None:
        pass


class ShiftTable(AbstractShift):
    """Measured shift factors, joined by monotone cubics (PCHIP); outside the table
    there is no answer, only an error.
    """

    temperature: Float[Array, " n"]  # ascending [K]
    log10_a_table: Float[Array, " n"]
    slopes: Float[Array, " n"]  # d(log10 a_T)/dT at the table's temperatures [1/K]
    # temperature at which log10 a_T = 0 [K]; NaN where the table does not cross zero
    reference: Float[Array, ""]

    def __init__(self, temperature: ArrayLike, log10_a: ArrayLike):
        temperature, log10_a = (
            as_float64("temperature", temperature),
            as_float64("log10_a", log10_a),
        )
        alike(2, temperature=temperature, log10_a=log10_a)
        in_kelvin("temperature", temperature)
        require("log10_a", log10_a, "finite", np.isfinite)
        ascending("temperature", temperature)
        if not is_traced(log10_a) and (np.diff(log10_a) > 0).any():
            raise InputError(
                f"log10_a must fall as the temperature rises, got {log10_a.tolist()}."
            )
        from scipy.interpolate import PchipInterpolator

        curve = PchipInterpolator(temperature, log10_a)
        crossings = np.asarray(curve.solve(0.0, extrapolate=False))
        slopes = np.asarray(curve.derivative()(temperature))
        reference = np.asarray(crossings[0] if crossings.size else np.nan)
        fill(
            self,
            temperature=temperature,
            log10_a_table=log10_a,
            slopes=slopes,
            reference=reference,
        )

    def _log10_a(self, temperature: Array) -> Array:
        return hermite(self.temperature, self.log10_a_table, self.slopes, temperature)

    def _check(self, temperature: Any) -> None:
        if is_traced(self):
            return
        low, high = float(self.temperature[0]), float(self.temperature[-1])
        accepted = f"within the shift table, {low:g} K to {high:g} K"
        require(
            "temperature", temperature, accepted, lambda t: (t >= low) & (t <= high)
        )


def hermite(table: Any, values: Any, slopes: Any, at: Array) -> Array:
    """Cubics through the values of a table with its slopes; NaN outside."""
    table, values, slopes = map(xp.asarray, (table, values, slopes))
    left = xp.clip(xp.searchsorted(table, at, side="right") - 1, 0, table.shape[0] - 2)
    width = table[left + 1] - table[left]
    s = (at - table[left]) / width
    outside = (at < table[0]) | (at > table[-1])
    value = (
        (1 + 2 * s) * (1 - s) ** 2 * values[left]
        + s * (1 - s) ** 2 * width * slopes[left]
        + s**2 * (3 - 2 * s) * values[left + 1]
        + s**2 * (s - 1) * width * slopes[left + 1]
    )
    return xp.where(outside, xp.nan, value)


def _above_pole(law: str, temperature: Any, pole: Any) -> None:
    if not is_traced(pole):
        limit = float(pole)
        accepted = f"above the {law} pole at {limit:g} K, where the law breaks down"
        require("temperature", temperature, accepted, lambda t: t > limit)
