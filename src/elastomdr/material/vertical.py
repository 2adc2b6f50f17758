"""Vertical shift: the factor b_T by which all moduli grow with the temperature, beside
the shift of times.
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
    in_kelvin,
    is_traced,
    numpy_unless_traced,
    positive,
    require,
    scalar,
    written,
)
from ..errors import InputError
from ..trees import Tree, fill, same
from .shift import hermite

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number


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
