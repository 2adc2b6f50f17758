"""Steady friction of a surface under a pressure: by Multiscale, by Persson's theory, on a half-space of cells."""

import dataclasses
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .._runtime import is_traced, nan_unless
from ..arguments import Scene, rough_scene
from ..errors import ConvergenceWarning, InputError
from ..foundation.law import surface_foundation
from ..mapping.spectrum import AbstractSpectrum
from ..material.tabulated import LEFT_OUT
from ..material.validity import misfit
from ..models import HalfSpace, Model, Persson, seeds_of
from ..results.curve import FrictionCurve
from ..solve import multiscale
from ..solve.heat import Heat
from .beyond import NOT_KNOWN, excited_outside, rough_beyond
from .mean import Mean

_LEAST = 1e-6  # share of real contact below which a pressure is taken for one in the wrong unit
_HOT = "; rubber at the flash temperature of its contacts (moving sources by length scale)"


@dataclasses.dataclass(frozen=True)
class SurfacePlan:
    """What is computed for a surface under a pressure; `print(plan)` says it in words."""

    scene: str
    model: str
    points: int
    work: str
    skipped: str

    def __str__(self) -> str:
        return "\n".join([
            f"Plan: friction, {self.scene}", f"  model: {self.model}", f"  {self.points} points: {self.work}",
            f"  skipped: {self.skipped}",
        ])  # fmt: skip


def surface_friction(
    material: Any, surface: AbstractSpectrum, model: Model, *, velocity: Any, pressure: Any, temperature: Any,
    rtol: Any, heat: Heat | None, progress: Callable[[int, int], None] | None,
) -> FrictionCurve:  # fmt: skip
    """`em.friction` of a surface that is given by its spectrum, under a pressure; see there."""
    foundation, scene = _set_up(material, surface, velocity, pressure, temperature, rtol, heat)
    shape, kelvin, traced = scene.shape, scene.kelvin, scene.traced
    pressures = scene.full(scene.value)  # [Pa]
    solved = _solver(model, foundation, surface, float(rtol), progress)
    found = solved(scene.reduced.ravel(), pressures.ravel())
    if not traced:
        _check_contact(found, pressures.ravel())
    reduced, warm, cold = scene.reduced, None, found.mu
    if heat is not None:
        v, t, p = (scene.full(a).ravel() for a in (scene.velocity, kelvin, pressures))

        from .flash import SETTLED, warmed

        def again(reduced: np.ndarray, pressure: np.ndarray, coarse: bool) -> Mean:
            return _as_mean(solved(reduced, pressure))

        warm = warmed(heat, foundation, foundation.shift, surface, v, t, p, _as_mean(found), again)
        reduced = warm.reduced.reshape(shape)
        found = found._replace(
            mu=warm.mean.mu, area=warm.mean.share, good=warm.mean.good,
            error=warm.mean.error + SETTLED * np.abs(warm.mean.mu - cold),
        )  # fmt: skip
    if not traced and not found.good.all():
        warnings.warn(
            f"{int((~found.good).sum())} of {found.good.size} points did not converge to rtol={rtol:g}; they are NaN."
            + (f" Maps: {found.said}; more cells hold more of them." if found.said else ""),
            ConvergenceWarning,
            stacklevel=4,
        )

    def field(values: Any) -> Any:
        return nan_unless(found.good, values).reshape(shape)

    outside = None if traced else excited_outside(foundation.range, surface, reduced)
    series = np.zeros(()) if traced else _misfit(foundation, surface, reduced.ravel())
    label = surface.label if is_traced(surface) else f"{surface.label}, {surface.words()}"
    inputs = scene.inputs(("surface", label), *(("as read", text) for text in getattr(surface, "report", ())))
    inputs += [] if heat is None else [("heat", heat.words())]
    inputs += [] if not found.said else [("maps", found.said)]
    if np.any(series):
        inputs.append(("material against its data", f"at most {np.max(series):.0%} of mu, part of the error"))
    if outside is not None:
        inputs.append(("excited beyond", f"the material's data: at most {np.nanmax(outside):.0%} of <|grad h|^2>"))
    beyond = NOT_KNOWN if traced else rough_beyond(foundation.range, outside, kelvin, shape, stacklevel=4)
    inputs += beyond.said
    stress = field(found.mu * pressures.ravel())
    return FrictionCurve(
        velocity=scene.full(scene.velocity),
        mu=field(found.mu),
        normal_force=field(pressures.ravel()),
        friction_force=stress,
        depth=None,
        contact=None,
        error=field(found.error + series * abs(found.mu)),
        converged=found.good.reshape(shape),
        temperature=scene.full(kelvin),
        model=_name(model) + ("" if heat is None else _HOT),
        plan=_plan(foundation, scene, surface, model, heat),
        inputs=tuple(inputs),
        extrapolated=beyond.points,
        model_error=_model_error(model, foundation, surface, found, reduced, field),
        pressure=pressures,
        area_ratio=field(found.area),
        temperature_rise=None if warm is None else field(warm.rise),
        cold=None if warm is None else field(cold),
        heat_flux=None if warm is None else field(warm.heat),
        outside=outside,
    )


def surface_plan(
    material: Any, surface: AbstractSpectrum, model: Model, *, velocity: Any, pressure: Any, temperature: Any,
    rtol: Any, heat: Heat | None,
) -> SurfacePlan:  # fmt: skip
    """`em.plan` of a surface under a pressure; see there."""
    return _plan(*_set_up(material, surface, velocity, pressure, temperature, rtol, heat), surface, model, heat)


def _plan(foundation: Any, scene: Scene, surface: AbstractSpectrum, model: Model, heat: Heat | None) -> SurfacePlan:
    name = foundation.name or "a foundation given directly"
    if isinstance(model, HalfSpace):
        from ..solve import maps

        grid, seeds = maps.grid_of(surface, model.cells, model.periods), len(seeds_of(model.seeds))
        work = f"{seeds} maps of {grid.cells} by {grid.cells} cells, {grid.periods} longest waves to a side"
        skipped = "cells out of contact; contact from a grid half as fine, then from the neighbouring velocity"
    else:
        work = f"integrals over {multiscale.PER_DECADE} cells per decade of q, or more until rtol is met"
        skipped = "no lines, no maps, no random numbers; integrals over the angle are tabulated once for all points"
    points = int(np.prod(scene.shape))
    label = surface.label if is_traced(surface) else f"{surface.label}, {surface.words()}"
    return SurfacePlan(f"{label} on {name}", _name(model) + ("" if heat is None else _HOT), points, work, skipped)


def _name(model: Model) -> str:
    if isinstance(model, Persson):
        where = "in mu and in G" if model.stored else "in mu"
        return f"Persson's theory, S with gamma = {model.gamma:g} {where}"
    if isinstance(model, HalfSpace):
        return "half-space in three dimensions, random maps of cells (no reduction)"
    return "Multiscale (Persson's contact shares, weights from three-dimensional maps)"


def _set_up(
    material: Any, surface: Any, velocity: Any, pressure: Any, temperature: Any, rtol: Any, heat: Any
) -> tuple[Any, Scene]:
    """The foundation and its points, checked. Raises `InputError`."""
    foundation = surface_foundation(material)
    return foundation, rough_scene(
        foundation, surface, velocity=velocity, pressure=pressure, temperature=temperature, rtol=rtol, heat=heat
    )


class _Found(NamedTuple):
    """What any of the models finds at each point."""

    mu: Any
    area: Any
    error: Any
    good: Any
    said: str = ""  # of the maps that were solved


def _solver(
    model: Model, foundation: Any, surface: Any, rtol: float, progress: Callable[[int, int], None] | None
) -> Callable[[Any, Any], _Found]:
    """Solves points (v a_T [m/s], p [Pa]), flat."""
    if isinstance(model, HalfSpace):
        from ..solve import maps

        grid, seeds = maps.grid_of(surface, model.cells, model.periods), seeds_of(model.seeds)

        def on_maps(reduced: Any, pressure: Any) -> _Found:
            if is_traced(surface, reduced, pressure, foundation):
                raise InputError("model must be em.Multiscale() or em.Persson() under jit, grad and vmap.")
            found = maps.friction(foundation.complex_modulus, surface, reduced, pressure, grid, seeds, rtol, progress)
            return _Found(*found)

        return on_maps
    tables = _half_tables(foundation)

    def closed(reduced: Any, pressure: Any) -> _Found:
        found = multiscale.solve(foundation.complex_modulus, surface, reduced, pressure, model, rtol)
        good = (found.error <= rtol * abs(found.mu)) | (found.mu == 0)
        if is_traced(found.mu):
            good = found.mu == found.mu
        if progress is not None and not is_traced(reduced):
            progress(reduced.size, reduced.size)
        change = 0.0
        for half in () if is_traced(found.mu) else tables:
            other = multiscale.solve(half.complex_modulus, surface, reduced, pressure, model, max(rtol, 1e-3))
            change = np.maximum(change, LEFT_OUT * np.abs(other.mu - found.mu))
        return _Found(found.mu, found.area, found.error + change, good)

    return closed


def _half_tables(foundation: Any) -> tuple[Any, ...]:
    """The halves of a table of moduli, whose friction shows the error of its interpolation; none for a series."""
    return () if not hasattr(foundation, "thinned") or is_traced(foundation) else tuple(foundation.thinned())


def _as_mean(found: _Found) -> Mean:
    unknown = np.full(np.shape(found.mu), np.nan)
    return Mean(found.mu, found.error, unknown, unknown, found.area, found.good, None)


def _check_contact(found: _Found, pressure: np.ndarray) -> None:
    """Raises `InputError` for a pressure that is likely to be in another unit."""
    area = np.where(found.good, found.area, 1.0)
    least = int(np.argmin(area))
    if area[least] < _LEAST:
        raise InputError(
            f"pressure must be in Pa, and enough for a real contact of {_LEAST:g} of the nominal area, got "
            f"{pressure[least]:g} Pa with a contact of {area[least]:.1g}: 0.3 MPa are 3e5 Pa."
        )


def _misfit(foundation: Any, surface: AbstractSpectrum, reduced: np.ndarray) -> np.ndarray:
    """Relative change of mu for what a material misses of the data that it was fitted to; 0 where that is not known.

    Friction goes with the loss modulus, and in light contact with the reciprocal of the storage modulus: both root mean
    squares, over the frequencies from q_low v a_T to q_high v a_T, or over all of the data where those lie beyond them.
    """
    within = np.hypot(*misfit(foundation, surface.q_low * reduced, surface.q_high * reduced))
    whole = np.nan_to_num(np.hypot(*misfit(foundation, 0.0, np.inf)))
    return np.where(np.isfinite(within), within, whole)


def _model_error(
    model: Model, foundation: Any, surface: AbstractSpectrum, found: _Found, reduced: Any, field: Callable[[Any], Any]
) -> Any:
    """Bound on the distance from three dimensions; None for the three-dimensional model itself."""
    if isinstance(model, HalfSpace):
        return None
    stiff = [abs(foundation.complex_modulus(q * reduced.ravel())) for q in (surface.q_high, surface.q_low)]
    ratio = surface.q_high / surface.q_low
    return field(abs(found.mu) * multiscale.bound(model, found.area, ratio, stiff[0] / stiff[1]))
