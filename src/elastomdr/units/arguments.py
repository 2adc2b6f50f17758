"""Units of arguments: what carries a unit becomes a plain number in SI units, or is
refused by the argument's name.

`UNITS` says once in which unit each argument is; an argument that it does not name has
none. Public functions are marked by `in_si` (`numpy_unless_traced` and `in_float64` do
so), constructors by `Tree`, so that nothing behind them meets a unit. Quantities are
pint's, bare, in lists, in xarray or in pandas; pint itself is loaded only to read a
unit that is given as a text, `attrs["units"]`.
"""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeVar

from ..errors import InputError, closest

P = ParamSpec("P")
R = TypeVar("R")

_DIFFERENCE = "K of difference"  # of temperatures: 10 degC is no such thing
_MODULUS = ("Pa", "Pa/m")  # of a foundation: of a half-space, or of a layer per area
# argument -> unit; a tuple: any of these; a list: one for each entry
UNITS: dict[str, Any] = {
    "adhesion": "J/m^2",
    "ambient": "K",
    "area": "m^2",
    "b": _DIFFERENCE,
    "belt": "kg/m",
    "boundary_shear": "Pa",
    "bulk": "Pa",
    "c2": _DIFFERENCE,
    "capacity": "J/K",
    "cell": "m",
    "conductance": "W/K",
    "conductivity": "W/(m*K)",
    "cutoff": "m",
    "depth": "m",
    "diameter": "m",
    "direction": "rad",
    "displacement": "m",
    "edge": ["m/s", ""],
    "energy": "J/mol",
    "equilibrium": "Pa",
    "equivalent_length": "m",
    "fluid_pressure": "Pa",
    "force": "N",
    "goods": "kg/m",
    "gravity": "m/s^2",
    "heat_capacity": "J/(m^3*K)",
    "height": "m",
    "groove_width": "m",
    "hottest": "K",
    "inertia": "kg*m^2",
    "kinematic_viscosity": "m^2/s",
    "length": "m",
    "load": "N",
    "load_per_length": "N/m",
    "longest": "m",
    "mass": "kg",
    "mean_free_path": "m",
    "moduli": "Pa",
    "modulus": "Pa",
    "molar_mass": "kg/mol",
    "normal_force": ("N", "N/m"),
    "omega": "rad/s",
    "outlet_pressure": "Pa",
    "path_or_heights": "m",
    "period": ("s", "m"),
    "pixel_size": "m",
    "position": "m",
    "pressure": "Pa",
    "pressure_drop": "Pa",
    "q": "rad/m",
    "q_high": "rad/m",
    "q_low": "rad/m",
    "q_rolloff": "rad/m",
    "r": "m",
    "radius": "m",
    "ramp": "s",
    "reference": "K",
    "relaxation": "Pa",
    "resistivity": "ohm*m",
    "rms_height": "m",
    "road": ["W/(m*K)", "J/(m^3*K)"],
    "shape": "m",
    "shortest": "m",
    "since": "s",
    "spacing": "m",
    "stiffness": "N/m",
    "damping": "N*s/m",
    "storage": "Pa",
    "loss": "Pa",
    "strength": "Pa",
    "stress": "Pa",
    "stroke": "m",
    "t": "s",
    "t0": "K",
    "tangential_velocity": "m/s",
    "temperature": "K",
    "temperature_error": _DIFFERENCE,
    "thickness": "m",
    "time": "s",
    "times": "s",
    "velocity": "m/s",
    "velocity_in": "m/s",
    "velocity_out": "m/s",
    "viscosity": "Pa*s",
    "wavelength": "m",
    "work": "J/m^2",
    "x": "m",
    "z": "m",
}
# where an argument has another unit than of that name elsewhere
_ELSEWHERE: dict[str, Any] = {
    "Foundation.__init__ equilibrium": _MODULUS,
    "Foundation.__init__ moduli": _MODULUS,
    "Foundation.__init__ viscosity": ("Pa*s", "Pa*s/m"),
    "Foundation.kelvin stiffness": _MODULUS,
    "Foundation.kelvin viscosity": ("Pa*s", "Pa*s/m"),
    "Foundation.maxwell stiffness": _MODULUS,
    "Drive.stick_slip normal_force": "N",
    "Layer.kernel z": "",
    "Layer.deficit z": "",
    "Mount.__init__ mass": ("kg", "kg/m"),  # per metre of a rough line
    "Mount.__init__ stiffness": ("N/m", "N/m^2"),
    "Mount.__init__ damping": ("N*s/m", "N*s/m^2"),
    "Traction.to_tir width": "m",
    "TabulatedModulus.interpolation_error low": "rad/s",
    "TabulatedModulus.interpolation_error high": "rad/s",
    "Softening.__init__ storage": "",
    "Softening.__init__ loss": "",
    "friction_spectrum load": "N/m",
    "full_contact_sliding load": "N/m",
    "leak density": "kg/m^3",
    "leak width": "m",
    "leak profile": ["m", "Pa"],
    "reciprocating profile": ["m", "Pa"],
    "reciprocating width": "m",
    # logarithms and exponents, whatever their names are elsewhere
    "calibrate parameters": "",
    "calibrate widths": "",
}
_PLAIN = {float, int, bool, str, type(None)}  # without a unit
_ANGLES = ("radian", "degree", "turn", "cycle", "revolution", "gradian")


def carries_unit(value: Any) -> bool:
    """Whether a value, or an entry of a list or dict, says in which unit it is. The
    type is looked at, not the data.
    """
    kind = type(value)
    if kind in _PLAIN or kind.__module__ == "numpy":
        return False
    if kind in (list, tuple):
        return not set(map(type, value)) <= _PLAIN and any(map(carries_unit, value))
    if isinstance(value, Mapping):
        return any(map(carries_unit, value)) or any(map(carries_unit, value.values()))
    if hasattr(kind, "attrs") and "units" in value.attrs:  # of xarray or pandas
        return True
    if not hasattr(kind, "__array__"):
        return hasattr(kind, "m_as")
    # of pint-xarray, of pint-pandas
    inside = getattr(value, "data", None), getattr(value, "dtype", None)
    return any(
        hasattr(type(one), "m_as") or hasattr(one, "units") for one in (value, *inside)
    ) or hasattr(kind, "unit")


def in_si(function: Callable[P, R]) -> Callable[P, R]:
    """Marks a public function: arguments with units become SI numbers, and an unknown
    keyword is answered.
    """
    to_numbers = arguments_in_si(function)
    plain: Callable[..., R] = function

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        given, named = to_numbers(args, kwargs)
        return plain(*given, **named)

    return wrapper


def constructor_in_si(cls: type[R]) -> type[R]:
    """Marks a class of arguments, as `in_si` does a function."""
    cls.__init__ = in_si(cls.__init__)  # type: ignore[method-assign]
    return cls


def arguments_in_si(
    function: Callable[..., Any],
) -> Callable[[Any, Any], tuple[Any, Any]]:
    """What turns the arguments of one function, positional and by name, into numbers in
    SI units.
    """
    inner = inspect.unwrap(function)
    parameters = inspect.signature(inner).parameters
    variable = {inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD}
    known = {
        name: each for name, each in parameters.items() if each.kind not in variable
    }
    names = tuple(known)
    open_ended = any(
        each.kind is inspect.Parameter.VAR_KEYWORD for each in parameters.values()
    )
    # of those that cannot be None
    defaults = {
        name: each.default
        for name, each in known.items()
        if each.default is not None
        and not re.search("None|Any|Optional|_empty", str(each.annotation))
    }
    flags = {name for name, each in known.items() if isinstance(each.default, bool)}

    def to_numbers(args: Any, kwargs: Any) -> tuple[Any, Any]:
        if not open_ended and not kwargs.keys() <= known.keys():
            word = next(name for name in kwargs if name not in known)
            accepted = [name for name in names if name not in ("self", "cls")]
            called = inner.__qualname__.removesuffix(".__init__")
            hint = closest(word, accepted) or f"Arguments are {', '.join(accepted)}."
            raise TypeError(f"{called}() has no argument {word!r}. {hint}")
        of = {**dict(zip(names, args, strict=False)), **kwargs}
        carried = False
        for name, value in of.items():
            if value is None:
                if name in defaults:
                    raise _missing(name, defaults[name], inner)
            elif name in flags and type(value).__name__ not in ("bool", "bool_"):
                raise InputError(argument=name, got=value, accepted="True or False")
            elif type(value) not in _PLAIN and type(value).__module__ != "numpy":
                carried = _has_unit(name, value) or carried
        if not carried and not any(map(carries_unit, args[len(names) :])):
            return args, kwargs
        given = [number_in_si(name, of[name], inner, of) for name in names[: len(args)]]
        named = {
            name: number_in_si(name, value, inner, of) for name, value in kwargs.items()
        }
        return (*given, *args[len(given) :]), named

    return to_numbers


def _missing(name: str, default: Any, function: Any) -> InputError:
    """What is raised for None where a value is needed."""
    if default is not inspect.Parameter.empty:
        return InputError(argument=name, got=None, accepted=f"left out for {default!r}")
    unit = _ELSEWHERE.get(f"{function.__qualname__} {name}", UNITS.get(name, ""))
    unit = f" [{unit}]" if unit and isinstance(unit, str) else ""
    return InputError(argument=name, got=None, accepted=f"given{unit}")


def _has_unit(name: str, value: Any) -> bool:
    """Whether an argument carries a unit. Raises `InputError` for a list in itself, and
    for what can be read only once.
    """
    if hasattr(type(value), "__next__"):
        raise InputError(argument=name, got=value, accepted="a list or an array")
    try:
        return carries_unit(value)
    except RecursionError as error:
        raise InputError(
            argument=name, got=value, accepted="a list that does not hold itself"
        ) from error


def number_in_si(
    name: str, value: Any, function: Any = None, of: Mapping[str, Any] | None = None
) -> Any:
    """An argument of a function as a number in SI units, or as it is where it has no
    unit.

    `of` are all arguments, on some of which the unit of another depends. Raises
    `InputError`.
    """
    if not carries_unit(value):
        return value
    called = getattr(function, "__qualname__", "")
    if isinstance(value, Mapping):  # its entries are arguments by their own names
        alike = f"{called} {name}" in _ELSEWHERE
        return {
            _plain_key(name, key): number_in_si(
                name if alike else str(key), entry, function, of
            )
            for key, entry in value.items()
        }
    return _converted(name, value, _unit(called, name, of or {}))


def _plain_key(name: str, key: Any) -> Any:
    if carries_unit(key):
        raise InputError(
            argument=name,
            got=key,
            accepted="a mapping whose keys are plain numbers in SI units",
        )
    return key


def _unit(called: str, name: str, of: Mapping[str, Any]) -> Any:
    """The unit of an argument, or several of which one has to fit."""
    if called == "PowerLaw.__init__" and name == "coefficient":
        return _of_power_law(of.get("exponent"))
    if called == "Spectrum.__init__" and name == "c":
        return "m^3" if str(of.get("convention", "2d")).startswith("1d") else "m^4"
    argument = f"{called} {name}"
    if argument in _ELSEWHERE:
        return _ELSEWHERE[argument]
    if name == "load":
        return _of_load(of)
    return UNITS.get(name, "")


def _of_power_law(exponent: Any) -> str:
    """Of c in f = c r^n, which is a length."""
    if not isinstance(exponent, (int, float)):
        raise InputError(
            argument="exponent",
            got=exponent,
            accepted="a plain number where coefficient has a unit",
        )
    power = 1 - exponent
    return f"m^{power:.12g}" if power >= 0 else f"1/m^{-power:.12g}"


def _of_load(of: Mapping[str, Any]) -> str:
    """N of a body, N/m of a rough line or surface, which say so themselves."""
    every = {**of, **of.get("axes", {})}  # those of a sweep are arguments too
    bodies = next(
        (every[key] for key in ("shape", "surface", "line") if key in every), None
    )
    listed = bodies if isinstance(bodies, (list, tuple)) and bodies else [bodies]
    units = {getattr(body, "load_unit", "N") for body in listed}
    if len(units) > 1:
        raise InputError(
            argument="load",
            got=of.get("load"),
            accepted="a plain number where shape is a list of bodies [N] and of "
            "rough surfaces [N/m]",
        )
    return units.pop()


def _converted(name: str, value: Any, unit: Any) -> Any:
    if not carries_unit(value):
        return value
    if type(value) in (list, tuple):
        units = unit if isinstance(unit, list) else [unit] * len(value)
        return type(value)(
            _converted(name, entry, one)
            for entry, one in zip(value, units, strict=True)
        )
    quantity = _quantity(name, value)
    accepted = unit if isinstance(unit, (tuple, list)) else (unit,)
    for one in accepted:
        if (number := _magnitude(quantity, one)) is not None:
            return number
    hint = ""
    if name == "viscosity" and quantity.check("[length]**2/[time]"):
        hint = "A kinematic viscosity times the density of the fluid is a dynamic one."
    raise InputError(
        argument=name, got=quantity, accepted=_in_words(accepted), hint=hint
    )


def _quantity(name: str, value: Any) -> Any:
    """A value with its unit as pint's quantity. Raises `InputError` for units that pint
    does not know.
    """
    if hasattr(type(value), "m_as"):
        return value
    if hasattr(getattr(value, "dtype", None), "units"):  # pandas, by pint-pandas
        import numpy as np

        quantity = getattr(value, "array", value).quantity
        return type(quantity)(
            np.asarray(quantity.magnitude, dtype=np.float64), quantity.units
        )
    if hasattr(getattr(value, "data", None), "m_as"):  # xarray, by pint-xarray
        return value.data
    if not hasattr(type(value), "attrs"):
        raise InputError(
            argument=name,
            got=value,
            accepted="a plain number in SI units or a quantity of pint",
            hint=f"units of {type(value).__module__.partition('.')[0]} are not known "
            "here",
        )
    import numpy as np

    from .registry import quantity_of

    unit = value.attrs["units"]
    quantity = quantity_of(np.asarray(value), unit)
    if quantity is None:
        raise InputError(
            argument=name,
            got=value,
            accepted="a quantity whose attrs['units'] are known",
            hint=f"they are {unit!r}",
        )
    return quantity


def _magnitude(quantity: Any, unit: str) -> Any:
    """The number of a quantity in a unit, None where it is no such quantity."""
    registry = quantity._REGISTRY
    given = str(quantity.units)
    wanted = registry.parse_units(unit.removesuffix(" of difference"))
    if quantity.dimensionality != wanted.dimensionality:
        return None
    if not unit and any(word in given for word in _ANGLES):
        return None  # a slope is no angle, and pint takes 5 degrees for .087
    if unit == "rad/s" and "hertz" in given:
        return None  # it counts turns, and pint takes 1 Hz for 1 rad/s
    zero = registry.Quantity(0.0, quantity.units).m_as(wanted) != 0
    if unit == _DIFFERENCE and zero:
        return None
    if unit == "K" and given.startswith("delta_"):
        return None
    magnitude = quantity.magnitude
    if hasattr(magnitude, "dtype") and magnitude.dtype.kind in "iu":
        magnitude = 1.0 * magnitude
    return registry.Quantity(magnitude, quantity.units).m_as(wanted)


def _in_words(accepted: Any) -> str:
    if "" in accepted:
        return "a number without a unit"
    return f"in {' or '.join(accepted)}, or in a unit that can be converted to it"
