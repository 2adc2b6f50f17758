"""Quantities with their units, such as "5 mm" or "20 degC", as types of the scene
file's schema; SI numbers inside.
"""

import math
import re
from collections.abc import Callable, Mapping
from decimal import Decimal
from functools import partial
from typing import Any, ClassVar, Self

from ..errors import Amount, InputError, closest, written

_MOST_SHOWN = 6  # entries of a list
_LARGEST = 1e100  # in SI units: products of such numbers stay within float64
_NUMBER = re.compile(
    r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.DOTALL
)

_DEGREE = "0.017453292519943295769"  # [rad]

# The usual units of each SI unit, converted exactly and without loading pint, which
# knows all others.
USUAL = {
    "m": {
        "m": "1",
        "mm": "1e-3",
        "um": "1e-6",
        "µm": "1e-6",
        "nm": "1e-9",
        "cm": "1e-2",
        "km": "1e3",
    },
    "m^2": {"m^2": "1", "cm^2": "1e-4", "mm^2": "1e-6", "mm2": "1e-6", "cm2": "1e-4"},
    "N": {"N": "1", "mN": "1e-3", "uN": "1e-6", "kN": "1e3", "MN": "1e6"},
    "m/s": {
        "m/s": "1",
        "mm/s": "1e-3",
        "um/s": "1e-6",
        "nm/s": "1e-9",
        "cm/s": "1e-2",
        "km/h": "1/3.6",
    },
    "K": {"K": "1", "degC": "1"},
    "s": {
        "s": "1",
        "ms": "1e-3",
        "us": "1e-6",
        "min": "60",
        "h": "3600",
        "day": "86400",
    },
    "N/m": {"N/m": "1", "N/mm": "1e3", "kN/m": "1e3"},
    "Pa": {"Pa": "1", "kPa": "1e3", "MPa": "1e6", "GPa": "1e9", "bar": "1e5"},
    "Hz": {"Hz": "1", "kHz": "1e3", "mHz": "1e-3"},
    "J/m^2": {"J/m^2": "1", "mJ/m^2": "1e-3", "N/m": "1", "mN/m": "1e-3"},
    "W/(m*K)": {"W/(m*K)": "1", "W/(m K)": "1", "W/m/K": "1", "mW/m/K": "1e-3"},
    "J/(m^3*K)": {
        "J/(m^3*K)": "1",
        "J/(m^3 K)": "1",
        "J/m^3/K": "1",
        "MJ/(m^3 K)": "1e6",
        "MJ/m^3/K": "1e6",
    },
    "kg": {"kg": "1", "g": "1e-3", "t": "1e3"},
    "N*s/m": {"N*s/m": "1", "N*s/mm": "1e3", "kN*s/m": "1e3"},
    "W/K": {"W/K": "1", "kW/K": "1e3", "mW/K": "1e-3"},
    "J/K": {"J/K": "1", "kJ/K": "1e3"},
    "Pa*s": {"Pa*s": "1", "Pa s": "1", "mPa*s": "1e-3", "mPa s": "1e-3", "cP": "1e-3"},
    "m^2/s": {"m^2/s": "1", "mm^2/s": "1e-6", "cSt": "1e-6"},
    "kg/m^3": {"kg/m^3": "1", "g/cm^3": "1e3", "g/l": "1"},
    "kg/m": {"kg/m": "1", "t/m": "1e3", "g/m": "1e-3"},
    "Pa/m": {"Pa/m": "1", "MPa/m": "1e6", "N/m^3": "1", "N/mm^3": "1e9"},
    "J/mol": {"J/mol": "1", "kJ/mol": "1e3"},
    "kg/mol": {"kg/mol": "1", "g/mol": "1e-3"},
    "rad": {"rad": "1", "deg": _DEGREE, "°": _DEGREE},
    "1/m": {"1/m": "1", "1/mm": "1e3", "1/um": "1e6", "rad/m": "1"},
}
_ZERO = {"degC": Decimal("273.15")}  # where a unit's scale begins
# a decimal comma, and a unit
_COMMA = re.compile(r"\s*([+-]?[\d.]*),(\d+)\s*([^\d\s,].*?)\s*", re.DOTALL)
_DEGREES = {
    "c": "degC",
    "celsius": "degC",
    "deg": "degC",
    "°": "degC",
    "f": "degF",
    "fahrenheit": "degF",
}


VALUE = "value"  # of an `InputError` about what a key holds, which `of_key` names


class SceneQuantity(float):
    """A number in SI units, read from a text with its unit."""

    what: ClassVar[str]  # in words, such as "a length"
    unit: ClassVar[str]  # SI
    example: ClassVar[str]
    sign: ClassVar[str] = "positive"  # or "zero or positive", or "" for either sign
    typed: str = ""

    def __init_subclass__(
        cls, what: str = "", unit: str = "", example: str = "", sign: str | None = None
    ):
        cls.what, cls.unit = what or cls.what, unit or cls.unit
        cls.example = example or cls.example
        cls.sign = cls.sign if sign is None else sign

    @classmethod
    def read(cls, entry: Any) -> Self:
        """The quantity that a text stands for.

        Number and unit are read apart from each other, so that "-35 degC" is a
        temperature and not a difference of two. Raises `InputError`, which says what is
        accepted, for a bare number, an unknown unit, a unit of another quantity, or a
        value that is not finite or of the wrong sign.
        """
        if isinstance(entry, str) and (comma := _COMMA.fullmatch(entry)) is not None:
            meant = f"{comma[1].replace('.', '')}.{comma[2]} {comma[3]}"
            raise InputError(
                argument=VALUE,
                got=entry,
                accepted="a number with a decimal point, not a comma",
                hint=f'write "{meant}"',
            )
        number, unit = "", ""
        if isinstance(entry, str) and (match := _NUMBER.fullmatch(entry)) is not None:
            number, unit = match[1], match[2]
        elif isinstance(entry, int | float) and not isinstance(entry, bool):
            number = str(entry)
        if not unit:
            meant = f'Did you mean "{number} {cls.example.partition(" ")[2]}"?'
            raise InputError(
                argument=VALUE,
                got=entry,
                accepted=cls.accepted(),
                hint=meant if number else "",
            )
        if cls.unit == "K" and (degrees := _DEGREES.get(unit.lower())) is not None:
            hint = f'write "{number} {degrees}"'
            raise InputError(argument=VALUE, got=entry, accepted=cls.what, hint=hint)
        value = cls.convert(number, unit)
        refused = {"": False, "zero or positive": value < 0}.get(cls.sign, value <= 0)
        if not math.isfinite(value) or refused:
            sign = cls.sign or "of either sign"
            raise InputError(argument=VALUE, got=entry, accepted=f"{sign} and finite")
        if value and not 1 / _LARGEST < abs(value) < _LARGEST:
            limits = f"between {1 / _LARGEST:g} and {_LARGEST:g} {cls.unit}"
            raise InputError(argument=VALUE, got=entry, accepted=limits)
        quantity = cls(value)
        quantity.typed = str(entry)
        return quantity

    @classmethod
    def in_unit(cls, value: float) -> str:
        """A number in SI units with its unit, a temperature in degrees Celsius."""
        return _in_unit(value, cls.unit)

    @classmethod
    def accepted(cls) -> str:
        """What is accepted, in words."""
        return f'{cls.what} with its unit, such as "{cls.example}"'

    @classmethod
    def convert(cls, number: str, unit: str) -> float:
        """The SI value of a number given in `unit`. Raises `InputError` for a unit that
        is none of this quantity.
        """
        factor = USUAL.get(cls.unit, {}).get(unit)
        if factor is None:
            return _by_pint(float(number), unit, cls)
        if not math.isfinite(float(number)):
            return math.inf
        times, _, over = factor.partition("/")
        exact = (
            Decimal(number if float(number) else 0)
            * Decimal(times)
            / Decimal(over or 1)
        )
        return float(exact + _ZERO.get(unit, 0))


class Length(SceneQuantity, what="a length", unit="m", example="5 mm"): ...


class Depth(Length, example="0.1 mm", sign=""): ...


class EquivalentLength(Length):
    """A length, or "full contact"."""

    @classmethod
    def read(cls, entry: Any) -> Any:
        return entry if entry == "full contact" else super().read(entry)

    @classmethod
    def accepted(cls) -> str:
        return f'{super().accepted()}, or "full contact"'


class Area(SceneQuantity, what="an area", unit="m^2", example="100 mm^2"): ...


class Force(SceneQuantity, what="a force", unit="N", example="10 N"): ...


class Push(Force, sign=""): ...


class LineLoad(
    SceneQuantity, what="a force per length", unit="N/m", example="1 N/mm"
): ...


class LinePush(LineLoad, sign=""): ...


class Pressure(SceneQuantity, what="a pressure", unit="Pa", example="0.3 MPa"): ...


class PushPressure(Pressure, sign=""): ...


class Velocity(SceneQuantity, what="a velocity", unit="m/s", example="0.1 m/s"): ...


class Speed(Velocity, sign=""): ...


class Temperature(
    SceneQuantity,
    what="a temperature",
    unit="K",
    example="20 degC",
    sign="above absolute zero",
): ...


class Duration(SceneQuantity, what="a time", unit="s", example="10 s"): ...


class Pause(Duration, sign="zero or positive"): ...


class Instant(Duration, sign=""): ...


class Frequency(SceneQuantity, what="a frequency", unit="Hz", example="10 Hz"): ...


class WaveNumber(
    SceneQuantity, what="a wave number", unit="1/m", example="1e3 1/m"
): ...


class Angle(SceneQuantity, what="an angle", unit="rad", example="90 deg", sign=""): ...


class Viscosity(
    SceneQuantity,
    what="a dynamic viscosity (a kinematic one times the density)",
    unit="Pa*s",
    example="0.1 Pa*s",
): ...


class KinematicViscosity(
    SceneQuantity, what="a kinematic viscosity", unit="m^2/s", example="46 cSt"
): ...


class MolarMass(
    SceneQuantity, what="a molar mass", unit="kg/mol", example="28.97 g/mol"
): ...


class Density(SceneQuantity, what="a density", unit="kg/m^3", example="870 kg/m^3"): ...


class SurfaceEnergy(
    SceneQuantity, what="an energy per area", unit="J/m^2", example="50 mJ/m^2"
): ...


class Mass(SceneQuantity, what="a mass", unit="kg", example="5 kg"): ...


class LineMass(
    SceneQuantity, what="a mass per length", unit="kg/m", example="28 kg/m"
): ...


class LoadedMass(LineMass, example="120 kg/m", sign="zero or positive"): ...


class Stiffness(
    SceneQuantity,
    what="a stiffness",
    unit="N/m",
    example="5 kN/m",
    sign="zero or positive",
): ...


class AreaStiffness(
    SceneQuantity, what="a stiffness per area", unit="Pa/m", example="80 MPa/m"
): ...


class Damping(
    SceneQuantity,
    what="a damping",
    unit="N*s/m",
    example="20 N*s/m",
    sign="zero or positive",
): ...


class Conductivity(
    SceneQuantity, what="a thermal conductivity", unit="W/(m*K)", example="0.2 W/(m*K)"
): ...


class VolumeCapacity(
    SceneQuantity,
    what="a heat capacity per volume",
    unit="J/(m^3*K)",
    example="2e6 J/(m^3*K)",
): ...


class Conductance(
    SceneQuantity, what="a thermal conductance", unit="W/K", example="1.2 W/K"
): ...


class HeatCapacity(
    SceneQuantity, what="a heat capacity", unit="J/K", example="1 kJ/K"
): ...


class MolarEnergy(
    SceneQuantity, what="an energy per mole", unit="J/mol", example="80 kJ/mol"
): ...


def shown(value: object, unit: str = "") -> str:
    """A value as TOML writes it; a model by its name, with the options it has; an
    amount in a unit.
    """
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Amount):
        return _in_unit(*value, unit)
    if isinstance(value, bool) or value is None:
        return "nothing" if value is None else str(value).lower()
    if isinstance(value, list | tuple) and len(value) <= _MOST_SHOWN:
        return f"[{', '.join(map(shown, value))}]"
    if isinstance(value, int | float):
        return written(value)
    if isinstance(value, type) or not hasattr(value, "in_python"):
        return written(value)
    model: Any = value  # what `models.Model` has
    options = (f"{name} = {shown(one)}" for name, one in model.options().items())
    return " with ".join(filter(None, [f'"{model.label}"', ", ".join(options)]))


def shown_beside(got: object) -> Callable[[object], str]:
    """`shown`, with amounts in the unit of a value that was typed, such as "5 mm"."""
    match = _NUMBER.fullmatch(str(got))
    return partial(shown, unit=match[2] if match else "")


def _in_unit(value: float, si: str, unit: str = "") -> str:
    """A number in SI units in another unit where that is a usual one, else in its own,
    a temperature in degrees Celsius.
    """
    usual = USUAL.get(si, {})
    if unit not in usual:
        unit = "degC" if si == "K" else si
    times, _, over = usual.get(unit, "1").partition("/")
    value = (value - float(_ZERO.get(unit, 0))) / float(times) * float(over or 1)
    return f"{value:g} {unit}".rstrip()


def _by_pint(number: float, unit: str, kind: type[SceneQuantity]) -> float:
    from ..units.registry import harmless, registry

    units = registry()
    usual = USUAL.get(kind.unit, {})
    try:
        if not harmless(unit):
            raise ValueError("no unit has such powers")
        parsed = units.parse_units(unit)
    # pint lets its tokenizer's errors through, of many types
    except Exception as error:
        known = f"usual units are {', '.join(usual)}" if usual else ""
        raise InputError(
            argument=VALUE,
            got=f"{number:g} {unit}",
            accepted=f'with a unit that is known, as in "{kind.example}"',
            hint=closest(unit, usual) or known,
        ) from error
    wanted = units.parse_units(kind.unit)
    if not _alike(parsed.dimensionality, wanted.dimensionality) or str(
        parsed
    ).startswith("delta_"):
        raise InputError(
            argument=VALUE,
            got=f"{number:g} {unit}",
            accepted=f'{kind.what}, such as "{kind.example}"',
            hint=f"its unit is {parsed}",
        )
    try:
        return float(units.Quantity(number, parsed).to(wanted).magnitude)
    except (OverflowError, ArithmeticError):
        return math.inf


def _alike(first: Mapping[str, float], second: Mapping[str, float]) -> bool:
    try:
        return all(
            math.isclose(first.get(d, 0), second.get(d, 0), abs_tol=1e-9)
            for d in {*first, *second}
        )
    except OverflowError:  # an exponent of hundreds of digits
        return False
