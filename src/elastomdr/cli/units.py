"""Texts with units, such as "5 mm" or "20 degC", into SI numbers."""

import functools
import math
import re
from typing import Any, NamedTuple

from ..errors import InputError, closest


class Kind(NamedTuple):
    """A kind of quantity: its name, its SI unit, an example to put into messages, units to suggest."""

    name: str
    unit: str
    example: str
    usual: str = ""
    accepted: str = "positive"  # or "zero or positive", or "of any sign"


_LENGTHS = "m mm um nm cm km inch metre meter millimetre millimeter micrometre micrometer nanometre nanometer"
LENGTH = Kind("a length", "m", "5 mm", _LENGTHS)
FORCE = Kind("a force", "N", "10 N", "N mN uN kN MN newton millinewton kilonewton lbf")
VELOCITY = Kind("a velocity", "m/s", "0.1 m/s", "m/s mm/s um/s nm/s cm/s km/h m/min mm/min")
TEMPERATURE = Kind("a temperature", "K", "20 degC", "degC degF K kelvin celsius fahrenheit")
_TIMES = "s ms us min h day hour second minute"
DURATION = Kind("a time", "s", "10 s", _TIMES)
PAUSE = DURATION._replace(accepted="zero or positive")
INSTANT = Kind("a time", "s", "10 s", _TIMES, "of any sign")
DEPTH = Kind("a length", "m", "0.1 mm", _LENGTHS, "of any sign")
PUSH = Kind("a force", "N", "10 N", FORCE.usual, "of any sign")
SPEED = Kind("a velocity", "m/s", "0.1 m/s", VELOCITY.usual, "of any sign")
LINE_PUSH = Kind("a force per length", "N/m", "5 N/m", "N/m N/mm kN/m", "of any sign")
PUSH_PRESSURE = Kind("a pressure", "Pa", "0.3 MPa", "Pa kPa MPa GPa bar psi", "of any sign")
FREQUENCY = Kind("a frequency", "Hz", "10 Hz", "Hz kHz mHz hertz")
ADHESION = Kind("an energy per area", "J/m^2", "50 mJ/m^2", "J/m^2 mJ/m^2 N/m mN/m")

PRESSURE = Kind("a pressure", "Pa", "0.3 MPa", "Pa kPa MPa GPa bar psi")
LINE_LOAD = Kind("a force per length", "N/m", "1 N/mm", "N/m N/mm kN/m")
CONDUCTIVITY = Kind("a thermal conductivity", "W/(m*K)", "0.2 W/(m*K)", "W/(m*K) W/m/K mW/m/K")
HEAT_CAPACITY = Kind("a heat capacity per volume", "J/(m^3*K)", "2e6 J/(m^3*K)", "J/(m^3*K) J/m^3/K MJ/m^3/K")
MASS = Kind("a mass", "kg", "5 kg", "kg g t")
STIFFNESS = Kind("a stiffness", "N/m", "5 kN/m", "N/m N/mm kN/m", "zero or positive")
DAMPING = Kind("a damping", "N*s/m", "20 N*s/m", "N*s/m N*s/mm kN*s/m", "zero or positive")
CONDUCTANCE = Kind("a thermal conductance", "W/K", "1.2 W/K", "W/K kW/K mW/K")
CAPACITY = Kind("a heat capacity", "J/K", "1 kJ/K", "J/K kJ/K")
LINE_MASS = Kind("a mass per length", "kg/m", "28 kg/m", "kg/m t/m g/m")
LOADED_MASS = LINE_MASS._replace(example="120 kg/m", accepted="zero or positive")  # an empty belt has none
AREA_STIFFNESS = Kind("a stiffness per area", "Pa/m", "80 MPa/m", "Pa/m MPa/m N/m^3 N/mm^3")
WAVE_NUMBER = Kind("a wave number", "1/m", "1e3 1/m", "1/m 1/mm 1/um rad/m")

_LARGEST = 1e100  # in SI units: products of such numbers stay within float64
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.DOTALL)


def quantity(name: str, text: Any, kind: Kind) -> float:
    """The SI value of a text with a unit; of most kinds it must be positive.

    Number and unit are read apart from each other, so that "-35 degC" is a temperature and not a difference of two.
    Raises `InputError`, naming the argument, for a bare number, an unknown unit, a unit of another kind, or a value
    that is not finite or of a sign that the kind does not take (a temperature: not above absolute zero).
    """
    if not isinstance(text, str):
        raise InputError(
            f'{name} must be {kind.name} with its unit, as a text such as "{kind.example}", got {_toml(text)}.'
        )
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise InputError(f'{name} must be a number and a unit, such as "{kind.example}", got "{text}".')
    number, unit = float(match[1]), match[2]
    if not unit:
        raise InputError(
            f'{name} must be {kind.name} with its unit, such as "{kind.example}", got "{text}" without one.'
        )
    value = number_in(name, number, unit, kind)
    refused = {"positive": value <= 0, "zero or positive": value < 0}.get(kind.accepted, False)
    if not math.isfinite(value) or refused:
        accepted = "above absolute zero" if kind is TEMPERATURE else kind.accepted
        raise InputError(f'{name} must be {accepted} and finite, got "{text}".')
    if value and not 1 / _LARGEST < abs(value) < _LARGEST:
        raise InputError(f'{name} must be between {1 / _LARGEST:g} and {_LARGEST:g} {kind.unit}, got "{text}".')
    return value


def number_in(name: str, number: float, unit: str, kind: Kind) -> float:
    """The SI value of `number`, given in `unit`. Raises `InputError` as `quantity` does, but takes any sign."""
    registry = _registry()
    try:
        parsed = registry.parse_units(unit)
    except Exception as error:  # pint lets its tokenizer's errors through, of many types
        hint = closest(unit, kind.usual.split()) or f' Write it as in "{kind.example}".'
        raise InputError(f"{name} has a unit that is not known: {unit!r}.{hint}") from error
    wanted = registry.parse_units(kind.unit)
    if not _alike(parsed.dimensionality, wanted.dimensionality) or str(parsed).startswith("delta_"):
        raise InputError(f'{name} must be {kind.name}, such as "{kind.example}", got the unit {unit!r} ({parsed}).')
    try:
        return float(registry.Quantity(number, parsed).to(wanted).magnitude)
    except (OverflowError, ArithmeticError):
        return math.inf


def _alike(first: Any, second: Any) -> bool:
    try:
        return all(math.isclose(first.get(d, 0), second.get(d, 0), abs_tol=1e-9) for d in {*first, *second})
    except OverflowError:  # an exponent of hundreds of digits
        return False


@functools.cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


def _toml(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)
