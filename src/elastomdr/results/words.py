"""Numbers, shapes and arrays in words, with the units an engineer would write."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..checks import is_traced, significant

if TYPE_CHECKING:
    from .._types import ArrayLike

_SHAPE_UNITS = {"radius": " m", "length": " m"}
# what one SI unit is in them
_SCALES = {
    "mm": 1e3,
    "µm": 1e6,
    "mm³": 1e9,
    "ms": 1e3,
    "%": 100.0,
    "MPa": 1e-6,
    "°": 180 / np.pi,
}

_MEGAPASCAL = 1e3  # from here on a pressure is in MPa [Pa]
_LONG = 7200.0  # from here on a time is no longer in seconds
_TIMES = ((86400.0, "days"), (3600.0, "h"))


def describe(shape: Any) -> str:
    """A body by its name and its numbers with their units."""
    numbers = [
        f"{name} {float(np.asarray(x)):.6g}{_SHAPE_UNITS.get(name, '')}"
        for name, x in vars(shape).items()
        if not isinstance(x, bool) and not is_traced(x) and np.ndim(x) == 0
    ]
    return ", ".join([shape.label, *numbers])


def surface_in_words(surface: Any) -> str:
    """A rough surface by its name and its numbers; a line by its name."""
    if not hasattr(surface, "words") or is_traced(surface):
        return surface.label
    return f"{surface.label}, {surface.words()}"


def covers_in_words(body: Any) -> tuple[str, ...]:
    """Each layer of an `em.layer` by its thickness and base; nothing of another
    body.
    """
    if is_traced(body):
        return ()
    return tuple(
        f"{1e3 * float(each.thickness):.4g} mm of {each.material.name or 'rubber'}, "
        f"{'bonded to' if each.bonded else 'slipping on'} a rigid base"
        for each in getattr(body, "covers", ())
    )


def brief(array: ArrayLike, unit: str) -> str:
    """A number with its unit, or the range of an array and how many values it has."""
    if is_traced(array):
        return "traced"
    array = np.asarray(array)
    if unit == "Pa" and array.size and array.max() >= _MEGAPASCAL:
        array, unit = in_unit(array, "MPa"), "MPa"
    if array.size and array.min() == array.max():
        return f"{float(array.flat[0]):.6g} {unit}"
    digits = 6 if unit == "K" else 4  # 0 degC is 273.15 K
    low, high = (f"{float(x):.{digits}g}" for x in (array.min(), array.max()))
    return f"{low} to {high} {unit} ({array.size} values)"


def given_in_words(given: NamedTuple, units: dict[str, str]) -> list[tuple[str, str]]:
    """Those arguments of a held contact that were given and have a unit, by name; rubber
    that is held without a time is relaxed.
    """
    values = given._asdict()
    rows = [
        (name.replace("_", " "), brief(values[name], unit))
        for name, unit in units.items()
        if values[name] is not None
    ]
    return rows if values["time"] is not None else [*rows, ("relaxed", "completely")]


def length_in_words(metres: float) -> str:
    """A length in the largest unit of which it is one or more, m to nm."""
    units = (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6))
    unit, size = next(
        (each for each in units if metres >= 0.9995 * each[1]), ("nm", 1e-9)
    )
    return f"{metres / size:.4g} {unit}"


def in_unit(values: ArrayLike, unit: str) -> np.ndarray:
    """SI values in the unit of a figure's axis."""
    return (
        np.asarray(values) - 273.15
        if unit == "°C"
        else np.asarray(values) * _SCALES.get(unit, 1.0)
    )


def in_words(name: str, value: float, unit: str = "N") -> str:
    """A quantity with the unit an engineer would write; `unit` is that of `value` where
    there is no usual one.
    """
    if name in ("temperature", "ambient"):
        return f"{significant(round(value - 273.15, 3), 5)} degC"
    if name == "pressure":
        return f"{significant(1e-6 * value)} MPa"
    if name == "direction":
        return f"{significant(round(np.degrees(value), 6))} degrees to the lay"
    if name == "time" and value >= _LONG:
        seconds, called = next(x for x in _TIMES if value >= x[0])
        return f"{significant(value / seconds)} {called}"
    if name in ("depth", "radius", "length", "diameter"):
        return f"{significant(1e3 * value)} mm"
    if name in ("creepage", "slip", "squeeze"):
        return f"{name} {significant(100 * value)} %"
    if name == "friction_force":
        return f"friction force {significant(value)} N"
    if name in ("belt", "goods"):
        return f"{significant(value)} kg/m of {name}"
    if unit == "-":
        return f"{name} {significant(value)}"
    return f"{significant(value)} {'m/s' if name == 'velocity' else unit}"


def span(values: ArrayLike, unit: str = "") -> str:
    """The range of an array in words, one number where it is one; NaN is not looked
    at.
    """
    values, unit = np.asarray(values), f" {unit}" if unit else ""
    known = values[np.isfinite(values)]
    if not known.size:
        return "infinite" if np.isinf(values).any() else "none"
    digits = 7 if values.size == 1 else 4
    low, high = (significant(float(x), digits) for x in (known.min(), known.max()))
    return f"{low}{unit}" if low == high else f"{low} to {high}{unit}"
