"""Shift laws: the factor a_T by which all relaxation times grow when the material cools
(time-temperature superposition), and b_T by which all moduli grow when it warms.
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
from ..trees import Tree, fill, same

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


class AbstractVertical(Tree):
    """A law of vertical shifts: M(omega; T) = b_T M(omega a_T; T_ref), M any modulus of
    the material.
    """

    def __repr__(self) -> str:
        return written(self)

    @abc.abstractmethod
    def _b(self, temperature: Array) -> Array:
        """b_T, at temperatures [K] that `_check` has let pass."""

    @abc.abstractmethod
    def _check(self, temperature: Any) -> None:
        """Raises `InputError` where the law does not hold."""

    @numpy_unless_traced
    def b(self, temperature: ArrayLike) -> Array:
        """Vertical shift factor b_T at temperatures [K], any shape. Raises `InputError`
        outside the law's range.
        """
        temperature = as_float64("temperature", temperature)
        in_kelvin("temperature", temperature)
        self._check(temperature)
        return self._b(temperature)


class EntropicVertical(AbstractVertical):
    """b_T = T/T_ref, the elasticity of entropy of a rubber network or a melt (Ferry
    1980, ch. 11).

    The density is taken as constant: with it, b_T would be lower by 0.06 % per kelvin
    above the reference temperature (a rubber's volume expansion). Raises `InputError`
    for a reference temperature that is not positive.
    """

    reference: Float[Array, ""]  # [K]

    def __init__(self, reference: Number):
        fill(self, reference=scalar("reference", reference))
        in_kelvin("reference", self.reference)

    def _b(self, temperature: Array) -> Array:
        return temperature / self.reference

    def _check(self, temperature: Any) -> None:
        pass


class VerticalTable(AbstractVertical):
    """Vertical shift factors by their values, joined by monotone cubics (PCHIP);
    outside the table there is no answer, only an error. Raises `InputError` for lists
    that do not match, temperatures that do not ascend, and factors that are not
    positive.
    """

    temperature: Float[Array, " n"]  # ascending [K]
    # b_T, 1 at the temperature at which the moduli are given
    factor: Float[Array, " n"]
    slopes: Float[Array, " n"]  # of the factor, at the table's temperatures [1/K]

    def __init__(self, temperature: ArrayLike, factor: ArrayLike):
        temperature, factor = (
            as_float64("temperature", temperature),
            as_float64("factor", factor),
        )
        alike(2, temperature=temperature, factor=factor)
        if is_traced(temperature):
            raise InputError(
                "temperature must be plain numbers: a table is differentiated in "
                "its factors only."
            )
        in_kelvin("temperature", temperature)
        positive("factor", factor)
        ascending("temperature", temperature)
        fill(
            self,
            temperature=temperature,
            factor=factor,
            slopes=_slopes(np.asarray(temperature), factor),
        )

    def _b(self, temperature: Array) -> Array:
        return hermite(self.temperature, self.factor, self.slopes, temperature)

    def _check(self, temperature: Any) -> None:
        if is_traced(self.temperature):
            return
        low, high = float(self.temperature[0]), float(self.temperature[-1])
        accepted = f"within the table of vertical shifts, {low:g} K to {high:g} K"
        require(
            "temperature", temperature, accepted, lambda t: (t >= low) & (t <= high)
        )


@numpy_unless_traced
def _slopes(x: Any, y: Any) -> Array:
    """Slopes of the monotone cubics through points (Fritsch & Butland 1984), as PCHIP
    has them.
    """
    x, y = xp.asarray(x), xp.asarray(y)
    h = xp.diff(x)
    secant = xp.diff(y) / h
    if x.shape[0] == 2:
        return xp.concatenate([secant, secant])
    before, after, w1, w2 = (
        secant[:-1],
        secant[1:],
        2 * h[1:] + h[:-1],
        h[1:] + 2 * h[:-1],
    )
    same_way = before * after > 0
    left, right = xp.where(same_way, before, 1.0), xp.where(same_way, after, 1.0)
    inner = xp.where(same_way, (w1 + w2) / (w1 / left + w2 / right), 0.0)

    def end(h0: Any, h1: Any, d0: Any, d1: Any) -> Any:
        slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
        slope = xp.where(slope * d0 > 0, slope, 0.0)
        return xp.where((d0 * d1 < 0) & (abs(slope) > 3 * abs(d0)), 3 * d0, slope)

    first = end(h[0], h[1], secant[0], secant[1])
    last = end(h[-1], h[-2], secant[-1], secant[-2])
    return xp.concatenate([first[None], inner, last[None]])


def check_vertical(vertical: Any) -> None:
    """Raises `InputError` unless it is a law of vertical shifts, or None."""
    if vertical is not None and not isinstance(vertical, AbstractVertical):
        raise InputError(
            "vertical must be an EntropicVertical or a VerticalTable, got "
            f"{vertical!r}."
        )


def thermal_factors(body: Any, temperature: Any) -> tuple[Any, Any]:
    """a_T and b_T of a material or foundation at temperatures [K]; 1 for a law that it
    does not have.

    Raises `InputError` where it has neither, or outside a law's range.
    """
    if body.shift is None and body.vertical is None:
        raise InputError(
            f"temperature was given ({_brief(temperature)}), but "
            f"{body.name or 'the material'} has no shift law; give "
            "the material one with shift=em.WLF(...), or leave the temperature out."
        )
    a = 1.0 if body.shift is None else body.shift.a(temperature)
    return a, 1.0 if body.vertical is None else body.vertical.b(temperature)


def _brief(kelvin: Any) -> str:
    if is_traced(kelvin):
        return "traced"
    values = np.asarray(kelvin, dtype=float)
    ends = f"{values.min():g}" if values.size and values.min() == values.max() else ""
    return (
        f"{ends or f'{values.min():g} to {values.max():g}'} K"
        if values.size
        else "none"
    )


def same_thermal(one: Any, other: Any) -> bool:
    """Whether two bodies shift alike with the temperature; under a transformation of
    JAX as far as can be seen.
    """
    return all(
        _same(getattr(one, law), getattr(other, law)) for law in ("shift", "vertical")
    )


def _same(first: Any, second: Any) -> bool:
    if first is None or second is None or is_traced(first, second):
        return first is second
    return bool(same(first, second))
