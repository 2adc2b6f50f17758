"""Steady friction of a rough line or surface: the ensemble of lines, the direction
average, heating; and its plan.
"""

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..call.extrapolation import NOT_KNOWN, excited_outside, rough_beyond
from ..checks import Array, in_float64, nan_unless
from ..errors import ConvergenceWarning, ModelWarning
from ..models import Line as LineModel
from ..results.curve import FrictionCurve, Lines
from ..smooth.problem import AVERAGED, BARE
from ..surface.rough_line import RoughLine
from ..surface.spectrum import AbstractSpectrum
from . import ensemble as ensemble_of
from .ensemble import (
    Ask,
    coarse_at,
    ensemble,
    lanes_of,
    mean_of_lines,
    on_enough_samples,
    solutions,
)
from .flash import SETTLED, warmed
from .heat import Heat
from .line_bound import factor, missed
from .line_derivatives import traced_mean_of_lines
from .line_problem import RoughScene, load_level, set_up
from .mean import Mean
from .periodic import Job, Line, solve_lines
from .periodic_plan import RoughPlan, plan_lines

_COARSE = 1e-4  # tolerance of the curve on which the flash temperature is looked for
_ROUNDS = 4  # of a call's solutions that heating takes, about
_LINES = "MDR line (textbook; on a surface too low, the more so the wider its spectrum)"
_AVERAGED_LINES = (
    "MDR line averaged over directions (on a surface too low, the more so the wider "
    "its spectrum)"
)
_FLASH = (
    "; rubber at the flash temperature of its contacts (moving sources by length scale)"
)


@in_float64
def rough_friction(
    material: Any,
    surface: RoughLine | AbstractSpectrum,
    *,
    velocity: Any,
    load: Any,
    depth: Any,
    pressure: Any,
    temperature: Any,
    model: LineModel,
    rtol: Any,
    skip: bool,
    heat: Heat | None,
    progress: Callable[[int, int], None] | None,
    store: Any,
) -> FrictionCurve:
    """`em.friction` of a rough line or surface on lines; see there."""
    scene = set_up(
        material,
        surface,
        velocity=velocity,
        load=load,
        depth=depth,
        pressure=pressure,
        temperature=temperature,
        model=model,
        rtol=rtol,
        heat=heat,
    )
    at, lines, length, given, control = (
        scene.at,
        scene.lines,
        scene.length,
        scene.given,
        scene.control,
    )
    foundation, shape, kelvin, reduced, traced = (
        at.foundation,
        at.shape,
        at.kelvin,
        at.reduced,
        at.traced,
    )
    law, average = foundation.law(), model.average
    asked, finished, largest, count = [0], [0], [lines[0].count], len(lines)
    first = (
        0
        if traced
        else solutions(
            Ask(reduced.ravel(), given, control, float(rtol), bool(skip)), average
        )
    )

    def tick(some: int) -> None:
        finished[0] += some
        if progress is not None:
            # how many rounds heating takes is not known before
            least = 1 if heat is None else _ROUNDS * count * first
            total = max(asked[0], least)
            progress(min(finished[0], total), total)

    def solved(
        wanted: list[tuple[RoughLine, np.ndarray, np.ndarray, Any]], rtol: float
    ) -> list[Line]:
        jobs = [
            Job(np.asarray(line.height), float(line.spacing), v, x, how)
            for line, v, x, how in wanted
        ]
        return solve_lines(jobs, law, rtol, bool(skip), tick, store)

    def points(reduced: np.ndarray, value: np.ndarray, coarse: bool = False) -> Mean:
        tolerance = max(_COARSE, float(rtol)) if coarse else float(rtol)

        def mean(ask: Ask, on: list[RoughLine]) -> Mean:
            asked[0] += count * solutions(ask, average)
            return mean_of_lines(ask, on, average, partial(solved, rtol=tolerance))

        def finer(ask: Ask, size: int) -> Mean:
            return mean(ask, ensemble(surface, size, model.periods, scene.seeds))

        ask = Ask(reduced, value, control, tolerance, bool(skip))
        found = mean(ask, lines)
        if coarse or model.samples is not None:
            return found
        found, used = on_enough_samples(
            ask, found, lines[0], float(law.equilibrium), finer
        )
        largest[0] = max(largest[0], int(used.max()))
        return found

    if traced:
        found = traced_mean_of_lines(
            lines, law, reduced.ravel(), given, control, float(rtol), average
        )
    else:
        found = points(reduced.ravel(), given)
        # nothing is lost, and what is left is rounding
        if not np.any(law.moduli) and not float(law.viscosity):
            found = found._replace(mu=0 * found.mu, error=0 * found.error)
    warm, cold = None, found.mu
    vertical = at.vertical.ravel()
    if (
        heat is not None
        and isinstance(surface, AbstractSpectrum)
        and kelvin is not None
    ):
        v, t = (at.full(a).ravel() for a in (at.velocity, kelvin))

        def at_pressure(
            reduced: np.ndarray, pressure: np.ndarray, coarse: bool
        ) -> Mean:
            return points(reduced, pressure * length, coarse)

        warm = warmed(
            heat,
            foundation,
            surface,
            v,
            t,
            given * vertical / length,
            found,
            at_pressure,
        )
        found, reduced, vertical = warm.mean, warm.reduced.reshape(shape), warm.vertical
    mu, good, force = found.mu, found.good, found.load * vertical
    error = found.error + (0.0 if warm is None else SETTLED * np.abs(mu - cold))
    coarse = good & coarse_at(error, mu)
    good = good & ~coarse
    if not traced and not good.all():
        text = (
            f"{int((~good).sum())} of {good.size} points did not converge; they are "
            "NaN."
        )
        if coarse.any():
            text += (
                f" Of {int(coarse.sum())} the estimated error for the sampling of the "
                f"line, up to {(error / mu)[coarse].max():.1g} of mu, is above "
                f"{ensemble_of.SAMPLING:g}: more samples lower it."
            )
        warnings.warn(text, ConvergenceWarning, stacklevel=4)
    # A surface is all its lines; about 95 % of means of as many lines lie within twice
    # their standard error.
    spread, far = 0.0, np.nan
    if isinstance(surface, AbstractSpectrum):
        spread = np.nan if found.scatter is None else 2 * found.scatter
        if pressure is not None:
            far = factor(surface, model) - 1
            if not traced and (text := missed(surface, model)) is not None:
                warnings.warn(text, ModelWarning, stacklevel=4)

    def field(values: Array) -> Array:
        return nan_unless(good, values).reshape(shape)

    outside = None if traced else excited_outside(foundation.range, surface, reduced)
    inputs = scene.inputs(
        ("surface", surface.label if traced else surface_words(surface, lines[0])),
        *(("as read", text) for text in getattr(surface, "report", ())),
    )
    inputs += (
        []
        if pressure is None or traced
        else load_level(foundation, surface, pressure, model.equivalent_length)
    )
    words = ensemble_words(scene.seeds, lines[0].count, largest[0])
    if isinstance(surface, AbstractSpectrum) and count == 1:
        words += ": how far lines scatter is not known, and so no error of mu"
    inputs += [("ensemble", words)]
    inputs += [] if heat is None else [("heat", heat.words())]
    if foundation.softening is not None:
        far = np.nan
        inputs.append(
            (
                "softening",
                (
                    "of the material is left out: this model is linear, its moduli "
                    "are of small strain"
                ),
            )
        )
    if outside is not None:
        inputs.append(
            (
                "excited beyond",
                (
                    f"the material's data: at most {np.nanmax(outside):.0%} of <|grad "
                    "h|^2>"
                ),
            )
        )
    beyond = (
        NOT_KNOWN
        if traced
        else rough_beyond(foundation.range, outside, kelvin, shape, stacklevel=4)
    )
    inputs += beyond.said
    return FrictionCurve(
        velocity=at.full(at.velocity),
        mu=field(mu),
        normal_force=field(force),
        friction_force=field(mu * force),
        depth=field(found.depth),
        contact=None,
        error=field(error + spread),
        converged=good.reshape(shape),
        temperature=at.full(kelvin),
        model=_model(scene, average, heat),
        plan=_plan(scene, surface, average, rtol, skip, heat),
        inputs=tuple(inputs),
        extrapolated=beyond.points,
        model_error=None if isinstance(surface, RoughLine) else field(mu * far),
        pressure=None
        if pressure is None
        else (given * at.vertical.ravel() / length).reshape(shape),
        temperature_rise=None if warm is None else field(warm.rise),
        cold=None if warm is None else field(cold),
        heat_flux=None if warm is None else field(warm.heat),
        outside=outside,
        lines=Lines(
            field(found.share),
            None if found.scatter is None else field(found.scatter),
            None if isinstance(surface, RoughLine) else field(error),
            count,
        ),
    )


@in_float64
def rough_plan(
    material: Any,
    surface: RoughLine | AbstractSpectrum,
    *,
    model: LineModel,
    rtol: Any,
    skip: bool,
    heat: Heat | None,
    **arguments: Any,
) -> RoughPlan:
    """`em.plan` of a rough line or surface on lines; see there."""
    scene = set_up(material, surface, model=model, rtol=rtol, heat=heat, **arguments)
    return _plan(scene, surface, model.average, rtol, skip, heat)


def _plan(
    scene: RoughScene,
    surface: Any,
    average: Any,
    rtol: Any,
    skip: Any,
    heat: Heat | None,
) -> RoughPlan:
    at = scene.at
    ask = Ask(at.reduced.ravel(), scene.given, scene.control, float(rtol), bool(skip))
    line, law = scene.lines[0], at.foundation.law()
    name = at.foundation.name or "a foundation given directly"
    lanes = None if at.traced else lanes_of(ask, average)
    return plan_lines(
        scene=f"{surface.label if at.traced else surface_words(surface, line)} on {name}",
        model=_model(scene, average, heat),
        line=None if at.traced else (np.asarray(line.height), float(line.spacing)),
        lines=len(scene.lines),
        samples=line.count,
        points=ask.velocity.size,
        law=law,
        lanes=lanes,
        control=scene.control,
        rtol=float(rtol),
        averaged=average,
        solutions=None if at.traced else solutions(ask, average),
        skip=bool(skip),
        heated=heat is not None,
        temperatures=0 if at.kelvin is None else np.size(at.kelvin),
    )


def _model(scene: RoughScene, average: Any, heat: Heat | None) -> str:
    line = (
        (_AVERAGED_LINES if average else _LINES)
        if scene.length is not None
        else (AVERAGED if average else BARE)
    )
    return line + scene.rule + ("" if heat is None else _FLASH)


def surface_words(surface: Any, line: RoughLine) -> str:
    """A surface and one of its lines, for results."""
    if isinstance(surface, RoughLine):
        return (
            f"rough line, period {float(surface.period):.4g} m, {surface.count} "
            f"points, rms height {float(surface.rms_height):.4g} m, rms slope "
            f"{float(surface.rms_slope):.4g}, cutoffs "
            f"{2 * np.pi / float(surface.period):.4g} and "
            f"{np.pi / float(surface.spacing):.4g} rad/m"
        )
    return (
        f"{surface.label}, {surface.words()}; line: rms height "
        f"{float(line.rms_height):.4g} m, rms slope "
    ) + (f"{float(line.rms_slope):.4g}")


def ensemble_words(seeds: tuple[int, ...], count: int, largest: int = 0) -> str:
    """How many lines of how many samples, for results."""
    text = f"{len(seeds)} line{'s' * (len(seeds) > 1)} of {count} samples"
    if seeds != tuple(range(len(seeds))):
        text += f", seed{'s' * (len(seeds) > 1)} " + ", ".join(map(str, seeds))
    if largest > count:
        text += f", of up to {largest} where that was too few"
    return text
