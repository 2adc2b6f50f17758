"""Steady friction of a rough line or surface: the arguments, the ensemble of lines, the direction average."""

import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .._runtime import as_float64, is_traced, plain, positive
from ..errors import ConvergenceWarning, ExtrapolationWarning, InputError
from ..foundation.law import Foundation, as_foundation
from ..mapping.direction import SharedGrid, directions, interpolation_error, quadrature_error, shared_grid
from ..mapping.rough_line import RoughLine
from ..mapping.spectrum import AbstractSpectrum
from ..mapping.synthesis import PERIODS, synthesise
from ..results.curve import FrictionCurve, Rough
from ..solve.periodic import Line, solve_line
from .steady import AVERAGED, BARE, brief, check_shift

_AVERAGE = 1e-5  # least relative error asked of the direction average: contacts that come and go leave kinks in mu(v)
_SAMPLES = 4096  # least number of samples of a line that is given by its points
_OUTSIDE = 0.1  # share of the mean square slope beyond the material's range from which a point counts as extrapolated


class _Ask(NamedTuple):
    """The points of a call, flattened."""

    velocity: np.ndarray  # times a_T [m/s]
    value: np.ndarray  # line load [N/m] or depth [m]
    control: Any
    rtol: float
    skip: bool


def is_rough(shape: Any) -> bool:
    """Whether a shape is one of this module's."""
    return isinstance(shape, (RoughLine, AbstractSpectrum))


def rough_friction(
    material: Any, surface: RoughLine | AbstractSpectrum, *, velocity: Any, load: Any, depth: Any, pressure: Any,
    temperature: Any, average: str | None, rtol: Any, skip: bool, equivalent_length: Any, samples: int | None,
    periods: int, seeds: int, sampling: float, progress: Callable[[int, int], None] | None, store: Any,
) -> FrictionCurve:  # fmt: skip
    """`em.friction` of a rough line or surface; see there."""
    foundation = as_foundation(material)
    traced = (foundation, velocity, load, depth, pressure, temperature, equivalent_length)
    if is_traced(*traced) or (isinstance(surface, RoughLine) and is_traced(surface)):
        raise InputError("the friction of a rough line or surface is not differentiable, nor seen by jit and vmap.")
    _check(foundation, average, rtol, samples, periods, seeds)
    control, value, length, rule = _control(surface, load, depth, pressure, equivalent_length)
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
        factor = np.asarray(foundation.shift.a(kelvin))
        check_shift(kelvin, velocity, factor)
    reduced = np.broadcast_to(velocity * factor, shape)
    ask = _Ask(reduced.ravel(), np.broadcast_to(value, shape).ravel(), control, float(rtol), bool(skip))
    lines = _ensemble(surface, samples, periods, seeds)
    law = foundation.law()

    def solved(line: RoughLine, velocity: np.ndarray, value: np.ndarray, control: Any) -> Line:
        return solve_line(
            np.asarray(line.height), float(line.spacing), law, velocity, value, control, ask.rtol, ask.skip, tick, store
        )

    own_only = average is None
    total, finished = seeds * _solutions(ask, own_only), [0]

    def tick(count: int) -> None:
        finished[0] += count
        if progress is not None:
            progress(min(finished[0], total), total)

    runs = [_bare(ask, line, solved) if own_only else _averaged(ask, line, solved) for line in lines]
    mu, error, load_, deep, share = (np.mean([getattr(r, k) for r in runs], axis=0) for k in _Run._fields[:-1])
    scatter = np.std([r.mu for r in runs], axis=0, ddof=1) / np.sqrt(seeds) if seeds > 1 else None
    good = np.all([r.good for r in runs], axis=0) & np.isfinite(mu)
    coarse = good & ~(error <= sampling * np.abs(mu))
    good = good & ~coarse
    if not good.all():
        text = f"{int((~good).sum())} of {good.size} points did not converge; they are NaN."
        if coarse.any():
            text += (
                f" Of {int(coarse.sum())} the estimated error, up to {(error / mu)[coarse].max():.1g} of mu, is above "
                f"sampling={sampling:g}: more samples lower it."
            )
        warnings.warn(text, ConvergenceWarning, stacklevel=4)

    def field(values: np.ndarray) -> np.ndarray:
        return np.where(good, values, np.nan).reshape(shape)

    outside = _outside(foundation, surface, reduced)
    extrapolated = None if outside is None else outside > _OUTSIDE
    inputs = [("material", foundation.name or "given directly"), ("surface", _words(surface, lines[0]))]
    inputs += [("pressure", brief(as_float64("pressure", pressure), "Pa"))] if pressure is not None else []
    inputs += [
        (f"line {control}", brief(value, "N/m" if control == "load" else "m")),
        ("velocity", brief(velocity, "m/s")),
    ]
    inputs += [] if kelvin is None else [("temperature", brief(kelvin, "K"))]
    inputs += [("ensemble", f"{seeds} line{'s' * (seeds > 1)} of {lines[0].count} samples")]
    if foundation.range is not None and outside is not None and extrapolated is not None and extrapolated.any():
        text = (
            f"at {int(extrapolated.sum())} of {outside.size} points more than {_OUTSIDE:.0%} of the mean square slope, "
            f"at most {outside.max():.0%}, is excited beyond the frequencies of the material's data"
        )
        inputs.append(("extrapolated", text))
        if not foundation.range.illustrative:
            warnings.warn(f"{text}.", ExtrapolationWarning, stacklevel=4)
    cost = f"{total} line solutions of {lines[0].count} samples by periodic quasi-Newton sweeps"
    return FrictionCurve(
        velocity=np.broadcast_to(velocity, shape).copy(),
        mu=field(mu),
        normal_force=field(load_),
        friction_force=field(mu * load_),
        depth=field(deep),
        contact=None,
        error=field(error),
        converged=good.reshape(shape),
        temperature=None if kelvin is None else np.broadcast_to(kelvin, shape).copy(),
        model=(BARE if own_only else AVERAGED) + rule,
        plan=cost,
        inputs=tuple(inputs),
        extrapolated=extrapolated,
        rough=Rough(
            None if pressure is None else np.broadcast_to(value / length, shape).copy(),
            field(share), None if scatter is None else field(scatter), outside, seeds,
        ),
    )  # fmt: skip


class _Run(NamedTuple):
    """One line's answer at each point."""

    mu: np.ndarray
    error: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    share: np.ndarray
    good: np.ndarray


def _bare(ask: _Ask, line: RoughLine, solved: Callable[..., Line]) -> _Run:
    own = solved(line, ask.velocity, ask.value, ask.control)
    return _Run(own.mu, own.error + own.cost * own.mu, own.load, own.depth, own.share, own.converged)


def _averaged(ask: _Ask, line: RoughLine, solved: Callable[..., Line]) -> _Run:
    """Points of one load share a line curve; with the depth given, each has its own load and so its own directions."""
    rtol = max(ask.rtol, _AVERAGE)
    own = solved(line, ask.velocity, ask.value, ask.control)
    mu, error = np.empty_like(ask.velocity), np.empty_like(ask.velocity)
    if ask.control == "depth":
        rule = directions(rtol)
        slowed = ask.velocity[:, None] * rule.cosines
        load = np.broadcast_to(np.where(own.converged, own.load, 1.0)[:, None], slowed.shape)
        every = solved(line, slowed.ravel(), load.ravel(), "load")
        each = every.mu.reshape(slowed.shape)
        mu = each @ rule.weights
        error = (
            np.asarray(quadrature_error(mu, each @ rule.check, rule.tail))
            + every.error.reshape(slowed.shape) @ rule.weights
        )
        return _Run(mu, error + own.cost * mu, own.load, own.depth, own.share, own.converged & np.isfinite(mu))
    grids = _grids(ask)
    speeds = np.concatenate([grid.velocity for grid, _ in grids])
    loads = np.concatenate([np.full(grid.velocity.size, ask.value[chosen][0]) for grid, chosen in grids])
    every = solved(line, speeds, loads, "load")
    start, tail = 0, directions(rtol).tail
    for grid, chosen in grids:
        part = slice(start, start + grid.velocity.size)
        start = part.stop
        curve = every.mu[part]
        used = grid.weights != 0
        # A node that failed spoils the points that use it and no others.
        broken = used @ ~np.isfinite(curve) > 0
        curve = np.where(np.isfinite(curve), curve, 0.0)
        average = grid.weights @ curve
        mu[chosen] = np.where(broken, np.nan, average)
        error[chosen] = (
            quadrature_error(average, grid.check @ curve, tail)
            + interpolation_error(average, np.where(broken, np.nan, grid.lower @ curve))
            + np.abs(grid.weights) @ np.nan_to_num(every.error[part])
            + average * np.nanmax(every.cost[part], initial=0.0)
        )
    return _Run(mu, error, own.load, own.depth, own.share, own.converged & np.isfinite(mu))


def _grids(ask: _Ask) -> list[tuple[SharedGrid, np.ndarray]]:
    chosen = [np.flatnonzero(ask.value == value) for value in np.unique(ask.value)]
    return [(shared_grid(ask.velocity[points], max(ask.rtol, _AVERAGE)), points) for points in chosen]


def _solutions(ask: _Ask, own_only: bool) -> int:
    if own_only:
        return ask.velocity.size
    if ask.control == "depth":
        return ask.velocity.size * (1 + directions(max(ask.rtol, _AVERAGE)).cosines.size)
    return ask.velocity.size + sum(grid.velocity.size for grid, _ in _grids(ask))


def _check(foundation: Foundation, average: Any, rtol: Any, samples: Any, periods: Any, seeds: Any) -> None:
    if foundation.per_area:
        raise InputError("material must be a half-space under a rough surface, got a layer.")
    if not float(foundation.equilibrium) > 0:
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


def _ensemble(surface: Any, samples: int | None, periods: int, seeds: int) -> list[RoughLine]:
    if isinstance(surface, RoughLine):
        if seeds != 1 or periods != PERIODS:
            raise InputError("seeds and periods belong to a surface given by its spectrum; a RoughLine is what it is.")
        factor = 4
        while surface.count * factor < (_SAMPLES if samples is None else samples):
            factor *= 2
        return [surface.finer(factor)]
    return [synthesise(surface, seed, periods, samples) for seed in range(seeds)]


def _words(surface: Any, line: RoughLine) -> str:
    if isinstance(surface, RoughLine):
        return (
            f"rough line, period {float(surface.period):.4g} m, {surface.count} points, rms height "
            f"{float(surface.rms_height):.4g} m, rms slope {float(surface.rms_slope):.4g}"
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
