"""Steady friction of a rough line or surface: the ensemble of lines, the direction
average, heating; and its plan.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..call.extrapolation import excited_outside, rough_beyond
from ..call.problem import SteadyScene
from ..checks import in_float64, warn_unless
from ..errors import ModelWarning, warn
from ..material.shift import thermal_factors
from ..models import Line as LineModel
from ..results.curve import FrictionCurve, Lines
from ..smooth.problem import AVERAGED, BARE
from ..surface.rough_line import RoughLine
from ..surface.spectrum import AbstractSpectrum
from .ensemble import (
    SAMPLING,
    LinePoints,
    Mean,
    coarse_at,
    mean_of_lines,
)
from .heat import NO_STATE, Heat, why_no_state
from .line_problem import RoughScene, check, factor, load_level, missed
from .local_modulus import Local
from .periodic import Job, SolvedLine, solve_lines
from .problem import RoughCall
from .road_models import Multiscale
from .surface import (
    HOT,
    SOFTENING_LEFT_OUT,
    SurfacePlan,
    excited_beyond,
    with_own_heat,
)
from .temperature_by_scale import Problem, Warm, warmed

if TYPE_CHECKING:
    from .._types import Branch
    from ..call.types import Surface
    from ..checks import Array

_LINES = "MDR line (textbook; on a surface too low, the more so the wider its spectrum)"
_AVERAGED_LINES = (
    "MDR line averaged over directions (on a surface too low, the more so the wider "
    "its spectrum)"
)


class _Solver:
    """Solves points on the lines of a scene, and tells `progress` how far it is."""

    def __init__(self, scene: RoughScene, call: RoughCall, model: LineModel):
        self.scene, self.surface, self.model = scene, call.surface, model
        self.law = scene.at.foundation.law()
        self.rtol, self.progress = float(call.rtol), call.progress
        self.asked = self.finished = 0  # line solutions, so far

    def cold(self) -> Mean:
        """The points of the scene, at the temperatures that are given."""
        return self.mean(np.ravel(self.scene.at.reduced), self.scene.given)

    def warm(self, heat: Heat, branch: Branch) -> Warm:
        """The temperatures that the friction of Multiscale makes."""
        points = self.scene.at
        assert isinstance(self.surface, AbstractSpectrum)  # `check` refuses others
        velocity, temperature, pressure = (
            points.full(a).ravel()
            for a in (points.velocity, points.temperature, points.value)
        )
        problem = Problem(
            points.foundation,
            self.surface,
            Local(),
            heat,
            None,
            velocity,
            np.ravel(points.reduced),
            temperature,
            pressure,
            pressure / points.vertical.ravel(),
        )
        return warmed(problem, Multiscale(), branch == "hot")

    def mean(self, reduced: np.ndarray, value: np.ndarray) -> Mean:
        """Mean over the lines at v a_T and line loads or depths."""
        scene = self.scene
        ask = LinePoints(reduced, value, scene.control, self.rtol)
        mean = mean_of_lines(ask, scene.lines, self.model.average, self._solved)
        # nothing is lost, and what is left is rounding
        if not np.any(self.law.moduli) and not float(self.law.viscosity):
            mean = mean._replace(mu=0 * mean.mu, error=0 * mean.error)
        return mean

    def _solved(self, jobs: list[Job]) -> list[SolvedLine]:
        self.asked += sum(job.velocity.size for job in jobs)
        return solve_lines(jobs, self.law, self._tick)

    def _tick(self, count: int) -> None:
        self.finished += count
        if self.progress is not None:
            self.progress(self.finished, self.asked)


class _LineAnswer(NamedTuple):
    """The means over the lines, flat, and which of them are handed out."""

    mean: Mean
    cold: Array  # mu at the temperatures that are given
    warm: Warm | None
    reduced: np.ndarray  # v a_T at the raised temperature, in the shape of the call
    vertical: np.ndarray  # b_T at the raised temperature
    error: Array  # numerical error of mu
    good: Array

    def rise(self) -> Array | float:
        """The flash temperature [K], in the shape of the call; zero without heat."""
        return 0.0 if self.warm is None else self.warm.mean.reshape(self.reduced.shape)


@in_float64
def rough_friction(call: RoughCall, model: LineModel) -> FrictionCurve:
    """`em.friction` of a rough line or surface on lines; see there."""
    surface, heat = call.surface, call.heat
    scene = check(call, model)
    solver = _Solver(scene, call, model)
    cold = solver.cold()
    warm = None if heat is None else solver.warm(heat, call.branch)
    answer = _judge(solver, cold, warm)
    points, foundation = scene.at, scene.at.foundation
    states: list[tuple[str, str]] = []
    if warm is not None:
        temperature = points.full(points.temperature).ravel()
        states = why_no_state(warm.runaway, foundation, temperature)
    _warn_of_failed(points, answer, states)
    spread, far = _model_bounds(scene, surface, model, answer)
    outside = excited_outside(foundation.range, surface, answer.reduced)
    inputs = _inputs(scene, surface, model, heat, outside)
    beyond = rough_beyond(
        foundation.range, outside, points.temperature, points.shape, answer.rise()
    )
    curve = _report(scene, surface, answer, spread, far)
    return dataclasses.replace(
        curve,
        model=_model(scene, model.average, heat),
        plan=_plan(scene, call, model),
        inputs=(*inputs, *states),
        marks=beyond,
        outside=outside,
    )


def _judge(solver: _Solver, cold: Mean, warm: Warm | None) -> _LineAnswer:
    """The answer at the temperatures that friction makes, if it heats, and which points
    have one.
    """
    scene, mean = solver.scene, cold
    points, error, known = scene.at, cold.error, cold.good
    reduced, vertical = np.ravel(points.reduced), np.ravel(points.vertical)
    if warm is not None:
        given = points.full(points.temperature).ravel() + warm.known()
        factor, hotter = thermal_factors(points.foundation, given)
        reduced = points.full(points.velocity).ravel() * factor
        vertical, value = hotter * np.ones(given.shape), scene.given * vertical
        mean = solver.mean(reduced, value / vertical)
        error, known = mean.error, mean.good & warm.good
    good = known & ~coarse_at(error, mean.mu)
    return _LineAnswer(
        mean, cold.mu, warm, reduced.reshape(points.shape), vertical, error, good
    )


def _warn_of_failed(
    points: SteadyScene, answer: _LineAnswer, states: list[tuple[str, str]]
) -> None:
    """Counts the points without an answer in one warning, with why they have none."""
    why = [f"{said}." for name, said in states if name == NO_STATE]
    coarse = answer.mean.good & ~answer.good
    if coarse.any():
        worst = (answer.error / answer.mean.mu)[coarse].max()
        why.append(
            f"Of {int(coarse.sum())} the estimated error for the sampling of the "
            f"line, up to {worst:.1g} of mu, is above "
            f"{SAMPLING:g}: more samples lower it, em.Line(samples=...)."
        )
    warn_unless(answer.good, "points", reason=" ".join(why))


def _model_bounds(
    scene: RoughScene, surface: Surface, model: LineModel, answer: _LineAnswer
) -> tuple[Array | float, float]:
    """Error of mu for the number of lines, and the bound of the line's distance from
    three dimensions over mu; with a warning where that is large.
    """
    if not isinstance(surface, AbstractSpectrum):
        return 0.0, np.nan
    # A surface is all its lines; about 95 % of means of as many lines lie within twice
    # their standard error.
    scatter = answer.mean.scatter
    spread = np.nan if scatter is None else 2 * scatter
    if scene.length is None:
        return spread, np.nan
    if (sentence := missed(surface, model)) is not None:
        warn(sentence, ModelWarning)
    softens = scene.at.foundation.softening is not None
    return spread, np.nan if softens else factor(surface, model) - 1


def _report(
    scene: RoughScene,
    surface: Surface,
    answer: _LineAnswer,
    spread: Array | float,
    far: float,
) -> FrictionCurve:
    """The numbers of the result."""
    points, mean, warm = scene.at, answer.mean, answer.warm

    def field(values: Array) -> np.ndarray:
        return np.where(answer.good, values, np.nan).reshape(points.shape)

    on_line = isinstance(surface, RoughLine)
    force = mean.load * answer.vertical
    curve = FrictionCurve(
        velocity=points.full(points.velocity),
        mu=field(mean.mu),
        normal_force=field(force),
        friction_force=field(mean.mu * force),
        depth=field(mean.depth),
        contact=None,
        error=field(answer.error + spread),
        converged=answer.good.reshape(points.shape),
        temperature=points.full(points.temperature),
        model="",
        plan="",
        inputs=(),
        model_error=field(mean.mu * far),
        lines=Lines(
            field(mean.share),
            None if mean.scatter is None else field(mean.scatter),
            None if on_line else field(answer.error),
            len(scene.lines),
        ),
    )
    if scene.length is not None:
        pressure = scene.given * points.vertical.ravel() / scene.length
        curve = dataclasses.replace(curve, pressure=pressure.reshape(points.shape))
    if warm is None:
        return curve
    curve = dataclasses.replace(
        curve,
        temperature_rise=field(warm.mean),
        cold=field(answer.cold),
        road_share=field(warm.to_road),
        other_states=warm.several.reshape(points.shape),
    )
    return with_own_heat(curve, warm)


def _inputs(
    scene: RoughScene,
    surface: Surface,
    model: LineModel,
    heat: Heat | None,
    outside: Array | None,
) -> list[tuple[str, str]]:
    """What a result says of its arguments."""
    points, line = scene.at, scene.lines[0]
    rows = scene.inputs(
        ("surface", surface_words(surface, line)),
        *(("as read", remark) for remark in getattr(surface, "report", ())),
    )
    if scene.length is not None:
        rows += load_level(
            points.foundation, surface, points.value, model.equivalent_length
        )
    words = ensemble_words(scene.seeds, line.count)
    if isinstance(surface, AbstractSpectrum) and len(scene.lines) == 1:
        words += ": how far lines scatter is not known, and so no error of mu"
    rows += [("ensemble", words)]
    if heat is not None:
        rows += [("heat", heat.words())]
    if points.foundation.softening is not None:
        rows += [SOFTENING_LEFT_OUT]
    if outside is not None:
        rows += [excited_beyond(outside)]
    return rows


@in_float64
def rough_plan(call: RoughCall, model: LineModel) -> SurfacePlan:
    """`em.plan` of a rough line or surface on lines; see there."""
    return _plan(check(call, model), call, model)


def _plan(scene: RoughScene, call: RoughCall, model: LineModel) -> SurfacePlan:
    name = scene.at.foundation.name or "a foundation given directly"
    line = scene.lines[0]
    work = "periodic states of " + ensemble_words(scene.seeds, line.count)
    if model.average:
        work += ", averaged over directions"
    return SurfacePlan(
        f"{surface_words(call.surface, line)} on {name}",
        _model(scene, model.average, call.heat),
        int(np.prod(scene.at.shape)),
        work,
        "the transient, and other elements, which see the same",
    )


def _model(scene: RoughScene, average: bool, heat: Heat | None) -> str:
    line = (
        (_AVERAGED_LINES if average else _LINES)
        if scene.length is not None
        else (AVERAGED if average else BARE)
    )
    return line + scene.rule + ("" if heat is None else HOT)


def surface_words(surface: Surface, line: RoughLine) -> str:
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


def ensemble_words(seeds: tuple[int, ...], count: int) -> str:
    """How many lines of how many samples, for results."""
    sentence = f"{len(seeds)} line{'s' * (len(seeds) > 1)} of {count} samples"
    if seeds != tuple(range(len(seeds))):
        sentence += f", seed{'s' * (len(seeds) > 1)} " + ", ".join(map(str, seeds))
    return sentence
