"""Steady friction of a rough line or surface: the arguments, the ensemble of lines, the direction average."""

import warnings
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np

from .._runtime import Array, as_float64, is_traced, plain, positive
from ..errors import ConvergenceWarning, ExtrapolationWarning, InputError
from ..foundation.law import Foundation, as_foundation
from ..mapping.rough_line import RoughLine
from ..mapping.spectrum import AbstractSpectrum
from ..results.curve import FrictionCurve, Rough
from ..solve.heat import Heat
from ..solve.periodic import Line, solve_line
from .ensemble import Ask, Mean, ensemble, mean_of_lines, solutions
from .flash import SETTLED, warmed
from .rough_traced import traced_mean_of_lines
from .steady import AVERAGED, BARE, brief, check_shift

_OUTSIDE = 0.1  # share of the mean square slope beyond the material's range from which a point counts as extrapolated
_COARSE = 1e-4  # tolerance of the curve on which the flash temperature is looked for
_FLASH = "; rubber at the flash temperature of its contacts (moving sources by length scale)"


def is_rough(shape: Any) -> bool:
    """Whether a shape is one of this module's."""
    return isinstance(shape, (RoughLine, AbstractSpectrum))


def rough_friction(
    material: Any, surface: RoughLine | AbstractSpectrum, *, velocity: Any, load: Any, depth: Any, pressure: Any,
    temperature: Any, average: str | None, rtol: Any, skip: bool, equivalent_length: Any, samples: int | None,
    periods: int, seeds: int, sampling: float, heat: Heat | None,
    progress: Callable[[int, int], None] | None, store: Any,
) -> FrictionCurve:  # fmt: skip
    """`em.friction` of a rough line or surface; see there."""
    foundation = as_foundation(material)
    traced = is_traced(foundation, surface, velocity, load, depth, pressure, temperature)
    if traced and heat is not None:
        raise InputError("heat must be left out under jax.grad, jit and vmap: flash temperature is not differentiable.")
    check_numerics(foundation, average, rtol, samples, periods, seeds)
    _check_heat(heat, surface, pressure, temperature)
    control, value, length, rule = control_of(surface, load, depth, pressure, equivalent_length)
    velocity, value = as_float64("velocity", velocity), value
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
    lines = ensemble(surface, samples, periods, seeds)
    law = foundation.law()
    asked, finished = [0], [0]

    def tick(count: int) -> None:
        finished[0] += count
        if progress is not None:
            progress(min(finished[0], asked[0]), asked[0])

    def solved(line: RoughLine, velocity: np.ndarray, value: np.ndarray, control: Any, rtol: float) -> Line:
        return solve_line(
            np.asarray(line.height), float(line.spacing), law, velocity, value, control, rtol, bool(skip), tick, store
        )

    def points(reduced: np.ndarray, value: np.ndarray, coarse: bool = False) -> Mean:
        tolerance = max(_COARSE, float(rtol)) if coarse else float(rtol)
        ask = Ask(reduced, value, control, tolerance, bool(skip))
        asked[0] += seeds * solutions(ask, average)
        return mean_of_lines(ask, lines, average, solved)

    if traced:
        found = traced_mean_of_lines(lines, law, reduced.ravel(), given, control, float(rtol), average)
    else:
        found = points(reduced.ravel(), given)
    warm, cold = None, found.mu
    if (
        heat is not None
        and isinstance(surface, AbstractSpectrum)
        and kelvin is not None
        and foundation.shift is not None
    ):
        v, t = (np.broadcast_to(a, shape).ravel() for a in (velocity, kelvin))

        def at_pressure(reduced: np.ndarray, pressure: np.ndarray, coarse: bool) -> Mean:
            return points(reduced, pressure * length, coarse)

        warm = warmed(heat, foundation, foundation.shift, surface, v, t, given / length, found, at_pressure)
        found, reduced = warm.mean, warm.reduced.reshape(shape)
    mu, good = found.mu, found.good
    error = found.error + (0.0 if warm is None else SETTLED * np.abs(mu - cold))
    coarse = good & ~(error <= sampling * numpy.abs(mu))
    good = good & ~coarse
    if not traced and not good.all():
        text = f"{int((~good).sum())} of {good.size} points did not converge; they are NaN."
        if coarse.any():
            text += (
                f" Of {int(coarse.sum())} the estimated error, up to {(error / mu)[coarse].max():.1g} of mu, is above "
                f"sampling={sampling:g}: more samples lower it."
            )
        warnings.warn(text, ConvergenceWarning, stacklevel=4)

    def field(values: Array) -> Array:
        return numpy.where(good, values, np.nan).reshape(shape)

    outside = None if traced else _outside(foundation, surface, reduced)
    extrapolated = None if outside is None else outside > _OUTSIDE
    inputs = [
        ("material", foundation.name or "given directly"),
        ("surface", surface.label if traced else surface_words(surface, lines[0])),
    ]
    inputs += [("pressure", brief(as_float64("pressure", pressure), "Pa"))] if pressure is not None else []
    inputs += [
        (f"line {control}", brief(value, "N/m" if control == "load" else "m")),
        ("velocity", brief(velocity, "m/s")),
    ]
    inputs += [] if kelvin is None else [("temperature", brief(kelvin, "K"))]
    inputs += [("ensemble", f"{seeds} line{'s' * (seeds > 1)} of {lines[0].count} samples")]
    inputs += [] if heat is None else [("heat", heat.words())]
    if outside is not None and extrapolated is not None and foundation.range is not None:
        inputs.append(("excited beyond", f"the material's data: at most {np.nanmax(outside):.0%} of <|grad h|^2>"))
        if extrapolated.any():
            text = (
                f"at {int(extrapolated.sum())} of {outside.size} points more than {_OUTSIDE:.0%} of the mean square "
                f"slope, at most {outside.max():.0%}, is excited beyond the frequencies of the material's data"
            )
            inputs.append(("extrapolated", text))
            if not foundation.range.illustrative:
                warnings.warn(f"{text}.", ExtrapolationWarning, stacklevel=4)
    cost = f"{asked[0]} line solutions of {lines[0].count} samples by periodic quasi-Newton sweeps"
    return FrictionCurve(
        velocity=numpy.broadcast_to(velocity, shape).copy(),
        mu=field(mu),
        normal_force=field(found.load),
        friction_force=field(mu * found.load),
        depth=field(found.depth),
        contact=None,
        error=field(error),
        converged=good.reshape(shape),
        temperature=None if kelvin is None else numpy.broadcast_to(kelvin, shape).copy(),
        model=(BARE if average is None else AVERAGED) + rule + ("" if warm is None else _FLASH),
        plan=cost,
        inputs=tuple(inputs),
        extrapolated=extrapolated,
        rough=Rough(
            None if pressure is None else numpy.broadcast_to(value / length, shape).copy(),
            field(found.share), None if found.scatter is None else field(found.scatter), outside, seeds,
            *(() if warm is None else (field(warm.rise), field(cold), field(warm.heat))),
        ),
    )  # fmt: skip


def check_numerics(foundation: Foundation, average: Any, rtol: Any, samples: Any, periods: Any, seeds: Any) -> None:
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
    for name, value, least in (("periods", periods, 1), ("seeds", seeds, 1), ("samples", samples, 64)):
        if value is None and name == "samples":
            continue
        if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
            raise InputError(f"{name} must be a whole number, {least} or more, got {value!r}.")


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


def control_of(surface: Any, load: Any, depth: Any, pressure: Any, equivalent_length: Any) -> tuple:
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
    if equivalent_length is None:
        if isinstance(surface, RoughLine):
            raise InputError(
                "pressure needs equivalent_length [m] with a RoughLine, the width of surface that the line stands for: "
                "the load per length is pressure times equivalent_length. Or give load, in N/m."
            )
        length = 2 * np.pi / surface.q_low
        return "load", value * length, length, (
            f"; pressure p as line load p L with L = 2 pi/q_low = {length:.4g} m (Popov & Hess 2015, ch. 10; the "
            "equivalence holds to a factor of order one)"
        )  # fmt: skip
    length = plain("equivalent_length", equivalent_length)
    positive("equivalent_length", length)
    return "load", value * length, length, f"; pressure p as line load p L with L = {length:.4g} m as given"


def surface_words(surface: Any, line: RoughLine) -> str:
    if isinstance(surface, RoughLine):
        return (
            f"rough line, period {float(surface.period):.4g} m, {surface.count} points, rms height "
            f"{float(surface.rms_height):.4g} m, rms slope {float(surface.rms_slope):.4g}, cutoffs "
            f"{2 * np.pi / float(surface.period):.4g} and {np.pi / float(surface.spacing):.4g} rad/m"
        )
    return f"{surface.label}, {surface.words()}; line: rms height {float(line.rms_height):.4g} m, rms slope " + (
        f"{float(line.rms_slope):.4g}"
    )


def _outside(foundation: Foundation, surface: Any, reduced: np.ndarray) -> np.ndarray | None:
    """Share of the mean square slope that is excited, at q v a_T, beyond the frequencies of the material's data."""
    known = foundation.range
    if known is None or known.frequency is None or isinstance(surface, RoughLine):
        return None
    low, high = known.frequency
    inside = surface.moment(3, low / reduced, high / reduced) / surface.moment(3)
    return np.clip(1 - inside, 0.0, 1.0)
