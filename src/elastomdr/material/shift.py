"""Shift laws: the factor a_T by which all relaxation times grow when the material cools
(time-temperature superposition), and b_T by which all moduli grow when it warms.
"""

from __future__ import annotations

import abc
import math
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np

from ..arrays import in_float64, xp
from ..checks import (
    Array,
    alike,
    as_float64,
    ascending,
    certain,
    in_kelvin,
    is_traced,
    not_negative,
    numpy_unless_traced,
    positive,
    possible,
    require,
    scalar,
    untraced,
    written,
)
from ..errors import InputError, amount
from ..numerics.interpolation import hermite, monotone_slopes
from ..trees import Tree, fill, same

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number


GAS_CONSTANT = 8.31446261815324  # R [J/(mol K)], CODATA 2018 (exact)
_LN10 = float(np.log(10.0))


class _TemperatureLaw(Tree):
    """What laws over temperature share: the range in which they hold."""

    def __repr__(self) -> str:
        return written(self)

    def _check(self, temperature: Array) -> None:
        """Raises `InputError` where the law does not hold."""

    @property
    def _hottest(self) -> float:
        """The temperature up to which `_check` lets a law pass [K]."""
        return math.inf

    def _checked(self, temperature: ArrayLike) -> Array:
        """Temperatures [K] at which the law holds. Raises `InputError` for others."""
        temperature = as_float64("temperature", temperature)
        in_kelvin("temperature", temperature)
        self._check(temperature)
        return temperature


class _LawTable(_TemperatureLaw):
    """A law by its values at some temperatures, between which it holds."""

    temperature: Float[Array, " n"]  # ascending [K]
    _called: ClassVar[str]

    def _check(self, temperature: Array) -> None:
        if is_traced(self.temperature):
            return
        low, high = float(self.temperature[0]), self._hottest
        ends = amount(low, "K") + " to " + amount(high, "K")
        accepted = f"within the {self._called}, " + ends
        require(
            "temperature", temperature, accepted, lambda t: (t >= low) & (t <= high)
        )

    @property
    def _hottest(self) -> float:
        return float(self.temperature[-1])


class AbstractShift(_TemperatureLaw):
    """A shift law; `a(T)` is tau(T)/tau(reference), so that it is 1 at the reference
    temperature.
    """

    if TYPE_CHECKING:  # declared by each law, in an order of its own
        reference: Float[Array, ""]  # [K]

    @abc.abstractmethod
    def _log10_a(self, temperature: Array) -> Array:
        """log10 a_T, at temperatures [K] that `_check` has let pass."""

    @numpy_unless_traced
    def log10_a(self, temperature: ArrayLike) -> Array:
        """log10 a_T at temperatures [K], any shape. Raises `InputError` outside the
        law's range.
        """
        return self._log10_a(self._checked(temperature))

    @numpy_unless_traced
    def a(self, temperature: ArrayLike) -> Array:
        """Shift factor a_T at temperatures [K], any shape."""
        # close above the pole: infinite, for the caller to judge
        with np.errstate(over="ignore"):
            return 10.0 ** self._log10_a(self._checked(temperature))

    @in_float64
    def activation_energy(self, temperature: ArrayLike) -> Array:
        """Apparent activation energy R d(ln a_T)/d(1/T) [J/mol] at temperatures [K],
        any shape.
        """
        import jax

        at = self._checked(temperature)
        _, slope = jax.jvp(self._log10_a, (at,), (xp.ones_like(at),))
        return -GAS_CONSTANT * at**2 * _LN10 * slope


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

    def _check(self, temperature: Array) -> None:
        _above_pole("WLF", temperature, self.reference - self.c2)

    def at_reference(self, temperature: Number) -> "WLF":
        """The same law written about another reference temperature [K]."""
        temperature = scalar("temperature", temperature)
        self._check(temperature)
        c2 = self.c2 + temperature - self.reference
        return WLF(self.c1 * self.c2 / c2, c2, temperature)


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
        if not possible(lambda t0, reference: t0 < reference, self.t0, self.reference):
            raise InputError(
                argument="t0",
                got=float(self.t0),
                accepted="below the reference temperature, "
                + amount(self.reference, "K"),
            )

    def _log10_a(self, temperature: Array) -> Array:
        return (
            self.b
            * (1 / (temperature - self.t0) - 1 / (self.reference - self.t0))
            / _LN10
        )

    def _check(self, temperature: Array) -> None:
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


class ShiftTable(_LawTable, AbstractShift):
    """Measured shift factors, joined by monotone cubics (PCHIP); outside the table
    there is no answer, only an error.
    """

    temperature: Float[Array, " n"]  # ascending [K]
    log10_a_table: Float[Array, " n"]
    slopes: Float[Array, " n"]  # d(log10 a_T)/dT at the table's temperatures [1/K]
    # temperature at which log10 a_T = 0 [K]; NaN where the table does not cross zero
    reference: Float[Array, ""]
    _called: ClassVar[str] = "shift table"

    def __init__(self, temperature: ArrayLike, log10_a: ArrayLike):
        temperature = as_float64("temperature", temperature)
        log10_a = as_float64("log10_a", log10_a)
        alike(2, {"temperature": temperature, "log10_a": log10_a})
        in_kelvin("temperature", temperature)
        require("log10_a", log10_a, "finite", np.isfinite)
        ascending("temperature", temperature)
        if not possible(lambda x: (np.diff(x) <= 0).all(), log10_a):
            i = int(np.argmax(np.diff(log10_a) > 0))
            raise InputError(
                argument="log10_a",
                got=float(log10_a[i + 1]),
                accepted=f"{log10_a[i]:g} or less at {temperature[i + 1]:g} K, since "
                "it may not rise with the temperature",
            )
        from scipy.interpolate import CubicHermiteSpline

        slopes = monotone_slopes(temperature, log10_a)
        curve = CubicHermiteSpline(temperature, log10_a, slopes)
        crossings = np.asarray(curve.solve(0.0, extrapolate=False))
        reference = np.asarray(crossings[0] if crossings.size else np.nan)
        fill(
            self,
            temperature=temperature,
            log10_a_table=log10_a,
            slopes=slopes,
            reference=reference,
        )

    def _log10_a(self, temperature: Array) -> Array:
        return _of_table(self.temperature, self.log10_a_table, self.slopes, temperature)


def _above_pole(law: str, temperature: Array, pole: Array) -> None:
    if not is_traced(pole):
        limit = float(pole)
        place = amount(limit, "K") + ", where the law breaks down"
        accepted = f"above the {law} pole at " + place
        require("temperature", temperature, accepted, lambda t: t > limit)


class AbstractVertical(_TemperatureLaw):
    """A law of vertical shifts: M(omega; T) = b_T M(omega a_T; T_ref), M any modulus of
    the material.
    """

    @abc.abstractmethod
    def _b(self, temperature: Array) -> Array:
        """b_T, at temperatures [K] that `_check` has let pass."""

    @numpy_unless_traced
    def b(self, temperature: ArrayLike) -> Array:
        """Vertical shift factor b_T at temperatures [K], any shape. Raises `InputError`
        outside the law's range.
        """
        return self._b(self._checked(temperature))


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


class VerticalTable(_LawTable, AbstractVertical):
    """Vertical shift factors by their values, joined by monotone cubics (PCHIP);
    outside the table there is no answer, only an error. Raises `InputError` for lists
    that do not match, temperatures that do not ascend, and factors that are not
    positive.
    """

    temperature: Float[Array, " n"]  # ascending [K]
    # b_T, 1 at the temperature at which the moduli are given
    factor: Float[Array, " n"]
    slopes: Float[Array, " n"]  # of the factor, at the table's temperatures [1/K]
    _called: ClassVar[str] = "table of vertical shifts"

    def __init__(self, temperature: ArrayLike, factor: ArrayLike):
        temperature = as_float64("temperature", temperature)
        factor = as_float64("factor", factor)
        alike(2, {"temperature": temperature, "factor": factor})
        untraced(
            InputError(
                argument="temperature",
                accepted="plain numbers",
                hint="a table is differentiated in its factors only",
            ),
            temperature,
        )
        in_kelvin("temperature", temperature)
        positive("factor", factor)
        ascending("temperature", temperature)
        fill(
            self,
            temperature=temperature,
            factor=factor,
            slopes=monotone_slopes(temperature, factor),
        )

    def _b(self, temperature: Array) -> Array:
        return _of_table(self.temperature, self.factor, self.slopes, temperature)


class Shifted(Protocol):
    """A body whose moduli may depend on temperature."""

    @property
    def name(self) -> str: ...
    @property
    def shift(self) -> AbstractShift | None: ...
    @property
    def vertical(self) -> AbstractVertical | None: ...


def _of_table(nodes: Array, values: Array, slopes: Array, temperature: Array) -> Array:
    """Monotone cubics through a table; NaN outside."""
    inside = (temperature >= nodes[0]) & (temperature <= nodes[-1])
    return xp.where(inside, hermite(nodes, values, slopes, temperature), xp.nan)


def check_laws(shift: object, vertical: object) -> None:
    """Raises `InputError` unless they are a shift law and a law of vertical shifts;
    either may be None.
    """
    if shift is not None and not isinstance(shift, AbstractShift):
        raise InputError(
            argument="shift", got=shift, accepted="a WLF, Arrhenius, VFT or ShiftTable"
        )
    if vertical is not None and not isinstance(vertical, AbstractVertical):
        raise InputError(
            argument="vertical",
            got=vertical,
            accepted="an EntropicVertical or a VerticalTable",
        )


def thermal_factors(body: Shifted, temperature: ArrayLike | None) -> tuple[Any, Any]:
    """a_T and b_T of a material or foundation at temperatures [K]; 1 for a law that it
    does not have, and without a temperature.

    Raises `InputError` where it has neither, or outside a law's range.
    """
    if temperature is None:
        return 1.0, 1.0
    if body.shift is None and body.vertical is None:
        raise InputError(
            argument="temperature",
            got=temperature,
            accepted="left out for a material that has no shift law",
            hint=f"give {body.name or 'it'} one with shift=em.WLF(...)",
        )
    a = 1.0 if body.shift is None else body.shift.a(temperature)
    return a, 1.0 if body.vertical is None else body.vertical.b(temperature)


def need_same_thermal(name: str, body: Shifted, material: Shifted) -> None:
    """Raises `InputError` unless a body, the argument of that name, shifts like the
    material.
    """
    if not same_thermal(material, body):
        raise InputError(
            argument=name,
            got=(body.shift, body.vertical),
            accepted="of the shift law and the vertical one of material, "
            f"{(material.shift, material.vertical)}",
            hint="bring both to their temperature first, with material.at(T)",
        )


def same_thermal(one: Shifted, other: Shifted) -> bool:
    """Whether two bodies shift alike with the temperature; under a transformation of
    JAX as far as can be seen.
    """
    return all(
        is_same(getattr(one, law), getattr(other, law)) for law in ("shift", "vertical")
    )


def is_same(first: Tree | None, second: Tree | None) -> bool:
    """Whether two laws are one, by their values; under a transformation of JAX as far
    as can be seen.
    """
    return first is second or certain(same, first, second)
