"""The arguments of a scene on a rough line or surface, checked and broadcast, with its lines."""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from .._runtime import as_float64, is_traced, positive, scalar
from ..errors import InputError
from ..foundation.law import Foundation, as_foundation
from ..mapping.rough_line import RoughLine
from ..mapping.synthesis import whole_number
from ..solve.heat import Heat
from .ensemble import ensemble
from .steady import brief, check_shift

FULL = "full contact"
_MOST_LINES = 1000  # of an ensemble
_LIGHT = 0.03  # p/(E*(0) rms slope) up to which the book's rule is one of light contact (docs/rough.md)


class RoughScene(NamedTuple):
    """A scene of many points, flattened where it says so."""

    foundation: Foundation
    lines: list[RoughLine]
    seeds: tuple[int, ...]  # of the lines
    shape: tuple[int, ...]  # of the broadcast arguments
    velocity: Any  # as given [m/s]; this and what follows are JAX arrays where traced, else NumPy's
    kelvin: Any  # as given [K], or None
    value: Any  # line load [N/m] or depth [m], as given
    reduced: Any  # v a_T [m/s], of the broadcast shape
    given: Any  # line load [N/m] or depth [m] of each point, flat
    control: Any  # "load" or "depth"
    length: Any  # that turns the pressure into a line load [m]; None without a pressure
    rule: str  # how, in words
    traced: bool


def set_up(
    material: Any, surface: Any, *, velocity: Any, load: Any, depth: Any, pressure: Any, temperature: Any,
    average: Any, rtol: Any, equivalent_length: Any, samples: Any, periods: Any, seeds: Any, heat: Any = None,
) -> RoughScene:  # fmt: skip
    """Checks the arguments and makes the lines. Raises `InputError`."""
    foundation = as_foundation(material)
    traced = is_traced(foundation, surface, velocity, load, depth, pressure, temperature)
    if traced and heat is not None:
        raise InputError("heat must be left out under jax.grad, jit and vmap: flash temperature is not differentiable.")
    _check(foundation, average, rtol, samples, periods)
    which = _seeds(seeds)
    _check_heat(heat, surface, pressure, temperature)
    control, value, length, rule = _control(surface, load, depth, pressure, equivalent_length)
    velocity = as_float64("velocity", velocity)
    positive("velocity", velocity)
    kelvin = None if temperature is None else as_float64("temperature", temperature)
    if kelvin is not None and foundation.shift is None:
        raise InputError(
            f"temperature was given ({brief(kelvin, 'K')}), but {foundation.name or 'the material'} has no shift law; "
            "give the material one with shift=em.WLF(...), or leave the temperature out."
        )
    arrays = [velocity, value, *([] if kelvin is None else [kelvin])]
    try:
        shape = np.broadcast_shapes(*(a.shape for a in arrays))
    except ValueError as error:
        shapes = ", ".join(str(a.shape) for a in arrays)
        raise InputError(f"velocity, {control} and temperature must broadcast, got shapes {shapes}.") from error
    if 0 in shape:
        raise InputError(f"velocity, {control} and temperature must not be empty, got shape {shape}.")
    factor = 1.0
    if kelvin is not None and foundation.shift is not None:
        factor = foundation.shift.a(kelvin)
        if not is_traced(factor, velocity):
            check_shift(kelvin, velocity, factor)
    numpy: Any = jnp if traced else np
    reduced = numpy.broadcast_to(velocity * factor, shape)
    given = numpy.broadcast_to(value, shape).ravel()
    lines = ensemble(surface, samples, periods, which)
    return RoughScene(
        foundation, lines, which, shape, velocity, kelvin, value, reduced, given, control, length, rule, traced
    )


def _check(foundation: Foundation, average: Any, rtol: Any, samples: Any, periods: Any) -> None:
    if foundation.per_area:
        raise InputError("material must be a half-space under a rough surface, got a layer.")
    if not is_traced(foundation.equilibrium) and not float(foundation.equilibrium) > 0:
        raise InputError(
            "material must have an equilibrium modulus under a rough surface, got 0: a liquid carries no steady load "
            "on a surface without end, since every element sinks until the mean force is gone."
        )
    if average not in ("direction", None):
        raise InputError(f"average must be 'direction' or None (the bare line), got {average!r}.")
    if isinstance(rtol, bool) or not isinstance(rtol, (int, float, np.floating)) or not 1e-10 <= rtol <= 1e-1:
        raise InputError(f"rtol must be a number from 1e-10 to 1e-1, got {rtol!r}.")
    whole_number("periods", periods, 1)
    if samples is not None:
        whole_number("samples", samples, 64)


def _seeds(seeds: Any) -> tuple[int, ...]:
    """The seeds of the lines: that many from 0 on, or those given."""
    if isinstance(seeds, (int, np.integer)) and not isinstance(seeds, bool) and seeds >= 1:
        whole_number("seeds", seeds, 1, _MOST_LINES)
        return tuple(range(seeds))
    each = tuple(seeds) if isinstance(seeds, (list, tuple, range, np.ndarray)) else ()
    whole = all(isinstance(s, (int, np.integer)) and not isinstance(s, bool) and s >= 0 for s in each)
    if not each or not whole or len(set(each)) != len(each):
        raise InputError(
            "seeds must be a whole number of lines, 1 or more, or the seeds themselves, different whole numbers from 0 "
            f"on, got {seeds!r}."
        )
    return tuple(int(s) for s in each)


def _check_heat(heat: Any, surface: Any, pressure: Any, temperature: Any) -> None:
    if heat is None:
        return
    if not isinstance(heat, Heat):
        raise InputError(f"heat must be an em.Heat(conductivity, heat_capacity), got {heat!r}.")
    if isinstance(surface, RoughLine) or pressure is None:
        raise InputError(
            "heat needs a surface given by its spectrum, and a pressure: a line has no contact area that is that of "
            "a surface, on which the flash temperature depends."
        )
    if temperature is None:
        raise InputError("heat needs a temperature [K], that of the rubber without the flash, and so a shift law.")


def _control(surface: Any, load: Any, depth: Any, pressure: Any, equivalent_length: Any) -> tuple:
    """What is given, as line load or depth; the length that turns pressure into load; the rule in words."""
    given = {k: v for k, v in (("load", load), ("depth", depth), ("pressure", pressure)) if v is not None}
    if len(given) != 1:
        got = " and ".join(f"{k}={v}" for k, v in given.items()) or "none of them"
        raise InputError(
            f"pressure, load (per length of line) or depth must be given, and only one of them, got {got}."
        )
    ((name, value),) = given.items()
    value = as_float64(name, value)
    positive(name, value)
    if name != "pressure":
        if equivalent_length is not None:
            raise InputError(f"equivalent_length turns a pressure into a line load; it has no meaning with a {name}.")
        return name, value, None, "; load per length of line, no pressure" if name == "load" else "; depth of the line"
    if isinstance(surface, RoughLine) and (equivalent_length is None or isinstance(equivalent_length, str)):
        raise InputError(
            "pressure needs equivalent_length [m] with a RoughLine, the width of surface that the line stands for: "
            "the load per length is pressure times equivalent_length. Or give load, in N/m."
        )
    spectrum: Any = surface
    if isinstance(equivalent_length, str):
        if equivalent_length != FULL:
            raise InputError(f"equivalent_length must be a length [m] or {FULL!r}, got {equivalent_length!r}.")
        length = spectrum.full_contact_length
        return "load", value * length, length, (
            f"; pressure p as line load p L with L = 2 <q^2 C>/<q^3 C>{_metres(length)}, that of full contact"
        )  # fmt: skip
    if equivalent_length is None:
        length = 2 * np.pi / spectrum.q_low
        return "load", value * length, length, (
            f"; pressure p as line load p L with L = 2 pi/q_low{_metres(length)} (Popov & Hess 2015, ch. 10; the "
            "equivalence holds to a factor of order one, in light contact)"
        )  # fmt: skip
    length = scalar("equivalent_length", equivalent_length)
    positive("equivalent_length", length)
    return "load", value * length, length, f"; pressure p as line load p L with L ={_metres(length)[2:]} as given"


def load_level(foundation: Foundation, surface: Any, pressure: Any, rule: Any) -> list[tuple[str, str]]:
    """For results: p/(E*(0) rms slope), half the share of relaxed rubber that touches or more; which rule fits.

    `rule` is the caller's `equivalent_length`. Nothing for a line, whose pressure has a length of its own.
    """
    if isinstance(surface, RoughLine):
        return []
    level = np.asarray(pressure, dtype=np.float64) / (float(foundation.equilibrium) * surface.rms_slope)
    words = f"p/(E*(0) rms slope) = {brief(level, '').strip()}: "
    if level.max() <= _LIGHT:
        words += f"light contact (up to {_LIGHT}), for which the book's rule is made"
    elif rule is None:
        words += (
            f'beyond light contact ({_LIGHT}): mu comes out too low by this rule, compare equivalent_length = "{FULL}"'
        )
    else:
        words += f"beyond light contact ({_LIGHT})"
    return [("load level", words)]


def _metres(length: Any) -> str:
    return "" if is_traced(length) else f" = {float(length):.4g} m"
