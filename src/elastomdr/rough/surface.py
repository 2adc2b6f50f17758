"""Steady friction of a surface under a pressure, by any `SurfaceModel`: check, solve,
pack.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import stop_gradient, xp
from ..call.extrapolation import (
    excited_outside,
    hardly_pressed,
    modulus_at,
    pressed_too_hard,
    rough_beyond,
)
from ..call.problem import SteadyScene, rough_scene
from ..checks import (
    is_traced,
    known,
    nan_unless,
    only_one,
    require,
    scalar,
    warn_unless,
)
from ..element.law import Foundation, TabulatedFoundation, surface_foundation
from ..errors import InputError
from ..material.shift import thermal_factors
from ..material.validity import Range, misfit
from ..models import named
from ..numerics.implicit import on_host
from ..results.base import WIDE
from ..results.curve import FrictionCurve
from ..results.doubts import Doubt, where
from ..results.words import brief, surface_in_words
from ..smooth.softening import LINEAR
from ..surface.height_map import top_slope, tops_of
from ..surface.lay import lay_of
from ..surface.spectrum import AbstractSpectrum
from .adhesion import AdhesiveShear, Known, check_adhesion, sheared, why_hotter
from .against_lay import Directed
from .heat import NO_STATE, Heat, check_heat, why_no_state
from .local_modulus import Local, SoftenedByScale
from .multiscale import RoadPoints, RoadShared, put_together, taken_apart
from .problem import RoughCall, strained_beyond
from .road_model import RoadProblem, SurfaceFriction, SurfaceModel
from .road_models import HalfSpace, Multiscale, Persson

if TYPE_CHECKING:
    from ..arrays import Array
    from ..call.types import SteadyBody
    from ..results.doubts import Kind
    from .temperature_by_scale import Warm

HOT = "; rubber at one flash temperature, the mean over the length scales of Multiscale"
_HOT_BY_SCALE = (
    "; rubber at a temperature for each length scale, heated by its friction"
)
SOFTENING_LEFT_OUT = (
    "softening",
    "of the material is left out: this model is linear, its moduli are of small strain",
)
_SOFTENED = "; moduli softened by the strain of each length scale"
# bound on |ln(mu/mu_3D)| of measured heights, and on that of the real contact: over the
# log slope of the tops at the contact, of a model that follows it and of others, over
# its rms at all shares, and over the standard error of the skewness:
# benchmarks/skewed_roads.py
_PER_TOP = {True: 0.2, False: 2.0}
_PER_TOPS, _PER_SAMPLE = 0.05, 0.25
# over `MeasuredSurface.flat` of the contact: of mu, and of the real contact, where
# plateaus may be in contact as a whole
_PER_FLAT = {False: 0.2, True: 1.0}
_PER_UNLIKE = 0.2  # over `MeasuredSurface.unlike` of the contact
_LACKING = 0.1  # from which part of mu on waves left out are a doubt of their own
# |ln(mu/mu_3D)| that a lay adds, over ln g and sqrt(-ln A): benchmarks/anisotropic.py
_PER_LAY = 0.12
_LAY_ERRORS = 2.0  # standard errors of a Peklenik number that a bound holds
# real contact, and the factor within which the strain at a scale is known there, of a
# sweep in shear: benchmarks/strain_share.py
_STRAIN_SHARE = (0.12, 1.35), (0.3, 2.0)
_MOST_SHARE = 2.0
# parts of a bound that are named where it is wide: their least share of it, and why
_NAMED = 0.25
_WIDE_BY_STRAIN = (
    "the strain at a length scale is known within a factor of 1.35 below 12 % contact, "
    "of 2 above 30 %: friction without softening, `linear`, is the other limit"
)
_WIDE_BY_LAY = (
    "edges of contacts have directions of their own, which the lay of the waves does not "
    "tell: more real contact has less"
)
_WIDE_BY_END = (
    "the map has slopes that its spectrum lacks, most at waves of less than four steps: "
    "with `shortest` both end there"
)
_WIDE_BY_SHEAR = (
    "shear may take contact away, or press the rubber down where it climbs: measured "
    "friction decides"
)
_WIDE_BY_MEAN = "it holds friction along and across the lay: a `direction` has less"
_WIDE_BY_ERROR = (
    "the Peklenik numbers have a sampling error: a map of more of its longest waves has "
    "less"
)
_ROUGHLY = 1e-3  # relative error of what only goes into a bound


@dataclasses.dataclass(frozen=True)
class SurfacePlan:
    """What is computed for a surface under a pressure; `print(plan)` says it in
    words.
    """

    scene: str
    model: str
    points: int
    work: str
    skipped: str

    def __str__(self) -> str:
        return "\n".join(
            [
                f"Plan: friction, {self.scene}",
                f"  model: {self.model}",
                f"  {self.points} points: {self.work}",
                f"  skipped: {self.skipped}",
            ]
        )


class _Answer(NamedTuple):
    """Friction at each point, flat, and at which temperatures."""

    hot: SurfaceFriction  # at the temperatures that friction makes
    cold: SurfaceFriction  # at the temperatures that are given
    problem: RoadProblem  # at velocity and pressure that are given, with local rises
    by_scale: Warm | None  # temperatures by length scale
    # v a_T at the temperature of the real contact, in the shape of the call
    reduced: Array

    def field(self, shape: tuple[int, ...], values: Array) -> Array:
        """`values` in the shape of the call, NaN where there is no answer."""
        return nan_unless(self.hot.good, values).reshape(shape)

    def longest(self, scene: SteadyScene) -> Any:
        """v a_T of the longest waves, flat: at the temperature of the body, where each
        length scale has one of its own.
        """
        reduced = self.reduced if self.by_scale is None else scene.reduced
        return reduced.ravel()

    def hottest(self) -> Any:
        """The largest rise of temperature at which moduli are taken [K], in the shape
        of the call; zero without heat.
        """
        if self.by_scale is None:
            return 0.0
        return self.by_scale.warmed.rise.max(-1).reshape(self.reduced.shape)


class _Strained(NamedTuple):
    """What softening changes."""

    linear: Array | None  # mu without softening
    # how far mu and, relatively, the area are off at half and twice the strain
    of_mu: Array | float
    of_area: Array | float
    rows: list[tuple[str, str]]


class _Turned(NamedTuple):
    """What the direction of sliding does on a surface with a lay."""

    # how far mu and, relatively, the area may be from those computed
    of_mu: Array | float
    of_area: Array | float
    rows: list[tuple[str, str]]


def surface_friction(call: RoughCall, model: SurfaceModel) -> FrictionCurve:
    """`em.friction` of a surface that is given by its spectrum, under a pressure; see
    there.
    """
    foundation, surface, scene = _check(call, model)
    heat, adhesion, rtol = call.heat, call.adhesion, call.rtol
    check_adhesion(adhesion, call.asked.temperature)
    strain_share = scalar("strain_share", call.strain_share)
    require(
        "strain_share",
        strain_share,
        f"above 0 and at most {_MOST_SHARE:g}",
        lambda x: (x > 0) & (x <= _MOST_SHARE),
    )
    softened = None
    if foundation.softening is not None and model.softens:
        softened = SoftenedByScale(foundation.softening, surface, strain_share)
    problem = RoadProblem(
        foundation,
        surface,
        scene.reduced.ravel(),
        # by the material at its reference temperature
        (scene.full(scene.value) / scene.vertical).ravel(),
        Local(softened, directed=_directed(scene, surface, model)),
        float(rtol),
        call.progress,
    )
    answer = _solve(call, scene, model, problem)
    states: list[tuple[str, str]] = []
    if not scene.traced:
        if answer.by_scale is not None:
            temperature = scene.full(scene.temperature).ravel()
            states = why_no_state(answer.by_scale.runaway, foundation, temperature)
        _warn_of_failed(answer.hot, states, rtol)
    outside = _outside(foundation.range, surface, scene, answer)
    of_data = (
        np.zeros(())
        if scene.traced
        else _misfit(
            foundation,
            surface,
            answer.longest(scene),
            np.asarray(answer.reduced).ravel(),
        )
    )
    strained = _strained(model, scene, answer)
    turned = _turned(scene, model, answer)
    marks = rough_beyond(
        foundation.range, outside, scene.temperature, scene.shape, answer.hottest()
    )
    marks += _too_much(scene, surface)
    if softened is not None:
        marks += strained_beyond(softened, foundation.range, scene.shape)
    label = surface_in_words(surface)
    inputs = _inputs(scene, label, model, heat, answer, strained, of_data, outside)
    inputs += turned.rows + states
    curve = _report(scene, model, answer, strained, turned, of_data)
    curve = dataclasses.replace(
        curve,
        model=curve.model + _hot(model, heat),
        plan=_plan(foundation, scene, surface, model, heat),
        inputs=tuple(inputs),
        marks=marks,
        outside=outside,
    )
    if heat is not None:
        curve = _with_heat(curve, heat, scene, answer)
    if adhesion is not None:
        curve = _with_adhesion(
            curve, adhesion, heat, scene, model, answer, strained, turned
        )
    if answer.by_scale is not None and model.by_wave() is None:
        curve = with_own_heat(curve, answer.by_scale)
    if scene.traced or curve.model_error is None:
        return curve
    wide = _judge(curve, model, answer, strained, turned)
    return dataclasses.replace(curve, marks=(*curve.marks, *wide))


def _solve(
    call: RoughCall, scene: SteadyScene, model: SurfaceModel, problem: RoadProblem
) -> _Answer:
    """Friction at the temperatures that are given or, with `heat`, that it makes."""
    cold = model.solve(problem)
    if not scene.traced:
        hardly_pressed(scene.full(scene.value).ravel(), cold.area, cold.good)
    answer = _Answer(cold, cold, problem, None, scene.reduced)
    if call.heat is None:
        return answer
    return _heated(call, call.heat, model, scene, answer)


def _heated(
    call: RoughCall,
    heat: Heat,
    model: SurfaceModel,
    scene: SteadyScene,
    answer: _Answer,
) -> _Answer:
    """Friction at the temperatures by length scale that it makes; of a model that takes
    one for all, at their mean for the friction of Multiscale.
    """
    from .temperature_by_scale import Problem, warmed

    velocity, temperature, pressure = (
        scene.full(a).ravel() for a in (scene.velocity, scene.temperature, scene.value)
    )
    problem, by_wave = answer.problem, model.by_wave()
    foundation, surface, reduced, reduced_pressure, local, *_ = problem
    scales = Problem(
        foundation,
        surface,
        local,
        heat,
        call.adhesion,
        velocity,
        reduced,
        temperature,
        pressure,
        reduced_pressure,
    )
    by_scale = warmed(scales, by_wave or Multiscale(), call.branch == "hot")
    if by_wave is None:
        factor, vertical = thermal_factors(foundation, temperature + by_scale.known())
        problem = problem._replace(
            velocity=velocity * factor, pressure=pressure / vertical
        )
    else:
        problem = problem._replace(local=local._replace(warmed=by_scale.warmed))
    heated = model.solve(problem)
    good = heated.good & answer.cold.good & by_scale.good
    error = by_scale.error if by_wave is not None else 0.0
    heated = heated._replace(error=heated.error + error, good=good)
    factor, _ = thermal_factors(foundation, temperature + by_scale.contact)
    reduced = scene.full(scene.velocity) * factor.reshape(scene.shape)
    return answer._replace(
        hot=heated, problem=problem, by_scale=by_scale, reduced=reduced
    )


def _outside(
    known: Range | None, surface: AbstractSpectrum, scene: SteadyScene, answer: _Answer
) -> Any:
    """Share of the slope outside the measured frequencies, at the temperatures that the
    rubber has there.
    """
    if answer.by_scale is None:
        return excited_outside(known, surface, answer.reduced)
    warm = answer.by_scale.warmed

    def factor(q: Array) -> Array:
        return warm.factors(warm.at(q))[0]

    return excited_outside(known, surface, scene.reduced, factor)


def _warn_of_failed(
    hysteresis: SurfaceFriction, states: list[tuple[str, str]], rtol: float
) -> None:
    """Counts the points without an answer in one warning."""
    why = [f"{said}." for name, said in states if name == NO_STATE]
    why += [f"Maps: {hysteresis.said}."] if hysteresis.said else []
    warn_unless(hysteresis.good, "points", f" to rtol={rtol:g}", " ".join(why))


def _inputs(
    scene: SteadyScene,
    label: str,
    model: SurfaceModel,
    heat: Heat | None,
    answer: _Answer,
    strained: _Strained,
    of_data: np.ndarray,
    outside: Array | None,
) -> list[tuple[str, str]]:
    """What a result says of its arguments."""
    hysteresis, surface = answer.hot, answer.problem.surface
    rows = scene.inputs(
        ("surface", label),
        *(("as read", remark) for remark in getattr(surface, "report", ())),
    )
    if not scene.traced and tops_of(surface) is not None and not model.on_map(surface):
        rows += [("heights", _tops_words(model, surface, hysteresis.area))]
    if heat is not None:
        longest = None if scene.traced else float(2 * np.pi / surface.q_low)
        rows += [("heat", heat.words(longest))]
    if answer.by_scale is not None and not scene.traced:
        rows += _scales_in_words(answer.by_scale, np.asarray(hysteresis.good))
    rows += strained.rows
    if hysteresis.said:
        rows += [("maps", hysteresis.said)]
    if np.any(of_data):
        share = f"at most {np.max(of_data):.0%} of mu, part of the error"
        rows += [("material against its data", share)]
    if outside is not None and not scene.traced:
        rows += [excited_beyond(outside)]
    return rows


def _judge(
    curve: FrictionCurve,
    model: SurfaceModel,
    answer: _Answer,
    strained: _Strained,
    turned: _Turned,
) -> tuple[Doubt, ...]:
    """Where the bound of the model exceeds half of mu: why, and what would lower it; and
    why there is none.
    """
    bound, mu = (abs(np.asarray(x).ravel()) for x in (curve.model_error, curve.mu))
    area, reduced = answer.hot.area, answer.reduced.ravel()
    foundation, surface = answer.problem[:2]
    wide, unknown = bound > WIDE * mu, np.isnan(bound) & np.isfinite(mu)
    of_waves = np.expm1(_of_left_out(surface, area))
    lacking = (of_waves > _LACKING) & np.isfinite(bound) & ~wide
    if (told := where(curve.marks, "no prediction")) is not None:
        unknown &= ~np.ravel(told)
    widths = (
        (strained.of_mu, _WIDE_BY_STRAIN),
        (mu * np.expm1(_of_tops(model, surface, area)), _wide_by_tops(model)),
        (mu * np.expm1(_of_lay(surface, area)), _WIDE_BY_LAY),
        (mu * of_waves, _WIDE_BY_END),
        (
            turned.of_mu,
            _WIDE_BY_ERROR if curve.direction is not None else _WIDE_BY_MEAN,
        ),
        (_of_shear(curve), _WIDE_BY_SHEAR),
    )
    cases: tuple[tuple[Kind, np.ndarray, str], ...] = (
        ("no prediction", unknown, "no bound on the model for"),
        ("bound", wide, "a bound on the model above half of"),
        (
            "bound",
            lacking,
            f"left out waves of the map worth {_LACKING:.0%} or more of",
        ),
    )
    doubts = []
    for kind, points, words in cases:
        if not points.any():
            continue
        reasons = []
        if points is not lacking:
            reasons = model.why_wide(foundation, surface, reduced[points], area[points])
        for width, reason in widths:
            share = np.broadcast_to(width, wide.shape)[points] / bound[points]
            if (share > _NAMED).any():
                reasons.append(reason)
        says = "; ".join([f"have {words} the friction coefficient", *reasons])
        doubts.append(Doubt(kind, points.reshape(curve.mu.shape), says))
    return tuple(doubts)


def _of_shear(curve: FrictionCurve) -> Array | float:
    """The part of a bound that is what shear does to the contact."""
    if curve.adhesion is None or curve.hysteresis is None:
        return 0.0
    alone = (curve.hysteresis, 0.0, 0.0)
    return Known.of(curve.adhesion, 0.0, None, curve.area_ratio, alone).bound.ravel()


def _wide_by_tops(model: SurfaceModel) -> str:
    """Why heights that are not Gaussian widen a bound, and what would lower that."""
    if not model.follows_tops:
        return (
            "Gaussian heights are assumed: em.Multiscale() follows those of the map, "
            "em.HalfSpace() slides over it"
        )
    return (
        "the tops of the heights have other slopes than the rest: more real contact has "
        "less, and em.HalfSpace() slides over the map itself"
    )


def excited_beyond(outside: Array) -> tuple[str, str]:
    """A row for results: the share of the slope outside the measured frequencies."""
    most = np.nanmax(outside)
    share = "less than 1%" if most < 0.005 else f"up to {most:.0%}"
    says = "of the mean square slope lies outside the measured frequencies"
    return "outside the data", f"{share} {says}"


def _report(
    scene: SteadyScene,
    model: SurfaceModel,
    answer: _Answer,
    strained: _Strained,
    turned: _Turned,
    of_data: np.ndarray,
) -> FrictionCurve:
    """The numbers of the result, of hysteresis alone."""
    hysteresis, shape = answer.hot, scene.shape
    field = partial(answer.field, shape)
    pressure = scene.full(scene.value)
    softening = ""
    if scene.foundation.softening is not None:
        softening = LINEAR if answer.problem.local.softened is None else _SOFTENED
    bound = _model_error(model, scene, answer, strained.of_mu + turned.of_mu)
    return FrictionCurve(
        velocity=scene.full(scene.velocity),
        mu=field(hysteresis.mu),
        normal_force=field(pressure.ravel()),
        friction_force=field(hysteresis.mu * pressure.ravel()),
        depth=None,
        contact=None,
        error=field(hysteresis.error + of_data * abs(hysteresis.mu)),
        converged=hysteresis.good.reshape(shape),
        temperature=scene.full(scene.temperature),
        model=model.words() + softening,
        plan="",
        inputs=(),
        model_error=bound,
        pressure=pressure,
        direction=scene.full(scene.direction),
        area_ratio=field(hysteresis.area),
        linear=None if strained.linear is None else field(strained.linear),
    )


def _with_heat(
    curve: FrictionCurve, heat: Heat, scene: SteadyScene, answer: _Answer
) -> FrictionCurve:
    """The temperatures that friction makes, beside mu without them."""
    field = partial(answer.field, scene.shape)
    by_scale = answer.by_scale
    assert by_scale is not None
    return dataclasses.replace(
        curve,
        other_states=by_scale.several.reshape(scene.shape),
        temperature_rise=field(by_scale.mean),
        contact_rise=field(by_scale.contact),
        cold=field(answer.cold.mu),
        heat_flux=field(by_scale.flux * (1 - by_scale.to_road)),
        road_share=None if heat.road is None else field(by_scale.to_road),
    )


def with_own_heat(curve: FrictionCurve, warm: Warm) -> FrictionCurve:
    """The heat of a curve whose temperatures are those that the friction of Multiscale
    makes: its own, with what the difference is worth in mu, to first order, as error.
    """
    assert curve.cold is not None
    assert curve.pressure is not None
    power = curve.velocity * curve.pressure
    flux, of_mu, to_road = (
        each.reshape(curve.mu.shape) for each in (warm.flux, warm.error, warm.to_road)
    )
    # of Multiscale
    other = np.where(flux > 0, flux, np.nan) / power
    share = np.nan_to_num(curve.mu / other, nan=1.0)
    off = of_mu * share + abs(curve.mu - curve.cold) * abs(share - 1)
    return dataclasses.replace(
        curve,
        heat_flux=curve.mu * power * (1 - to_road),
        error=curve.error + off,
    )


def _with_adhesion(
    curve: FrictionCurve,
    adhesion: AdhesiveShear,
    heat: Heat | None,
    scene: SteadyScene,
    model: SurfaceModel,
    answer: _Answer,
    strained: _Strained,
    turned: _Turned,
) -> FrictionCurve:
    """The shear of the real contact added."""
    field = partial(answer.field, scene.shape)
    hysteresis, pressure = answer.hot, scene.full(scene.value)
    area, cold_area = field(hysteresis.area), field(answer.cold.area)
    stress = None
    if heat is not None:
        stress = adhesion.shear_stress(
            scene.full(scene.velocity), scene.full(scene.temperature)
        )
        cold = curve.cold + stress * cold_area / pressure
        curve = dataclasses.replace(curve, cold=cold)
    both = sheared(
        curve,
        adhesion,
        area / pressure,
        field(hysteresis.area_error) / area,
        _model_error(
            model,
            scene,
            answer,
            strained.of_area + turned.of_area,
            of_area=True,
        ),
        "area of real contact",
        modulus_at(
            scene.foundation,
            answer.problem.surface.q_high,
            scene.reduced,
            scene.vertical,
        ),
    )
    if heat is None or scene.traced:
        return both
    return dataclasses.replace(
        both,
        inputs=(
            *both.inputs,
            *why_hotter(both, np.asarray(cold_area), np.asarray(stress)),
        ),
    )


def _scales_in_words(by_scale: Warm, good: np.ndarray) -> list[tuple[str, str]]:
    """The rise of temperature by length scale, where it is largest."""
    if not good.any():
        return []
    i = np.argmax(np.where(good, by_scale.contact, -np.inf))
    length, rise = 2 * np.pi / np.exp(by_scale.warmed.log_q()), by_scale.warmed.rise[i]
    parts = [
        f"{rise[k]:.3g} K at {1e3 * length[k]:.2g} mm" for k in (0, rise.size // 2, -1)
    ]
    return [("rise by wavelength", f"{', '.join(parts)}, where it is largest")]


def _strained(model: SurfaceModel, scene: SteadyScene, answer: _Answer) -> _Strained:
    """What softening changes; how far mu is off where the strain is not that taken.

    Under a transformation of JAX the same numbers, without derivatives, as a bound has
    none; what there is to say of them is left out.
    """
    problem, softened = answer.problem, answer.problem.local.softened
    if softened is None:
        left_out = problem.foundation.softening is not None
        return _Strained(None, 0.0, 0.0, [SOFTENING_LEFT_OUT] if left_out else [])
    if scene.traced:
        return _Strained(None, *off_by_strain(model, problem), rows=[])
    linear, here, of_mu, of_area = by_strain(model, problem, softened)
    words = _softening_words(softened, problem.surface, here, linear, answer.hot.good)
    return _Strained(linear.mu, of_mu, of_area, [("softening", words)])


class ByStrain(NamedTuple):
    """What softening changes at points on a surface."""

    linear: SurfaceFriction  # without it
    here: SurfaceFriction  # with it, to a rtol of 1e-3 at best
    # how far mu and, relatively, the area are off: the strain is known within a factor
    of_mu: np.ndarray
    of_area: np.ndarray


def by_strain(
    model: SurfaceModel, problem: RoadProblem, softened: SoftenedByScale
) -> ByStrain:
    """Friction and real contact at other strains of each length scale, and at none."""
    roughly = problem._replace(rtol=max(problem.rtol, 1e-3), progress=None)

    def at(share: Array | None) -> SurfaceFriction:
        other = None if share is None else softened._replace(share=share)
        local = problem.local._replace(softened=other)
        return model.solve(roughly._replace(local=local))

    linear, here = at(None), at(softened.share)

    def changes(factor: float) -> np.ndarray:
        """The largest of mu [absolute] and of the area [relative]: (2, points)."""
        others = [at(softened.share * f) for f in (factor, 1 / factor)]
        return np.array(_changes(here, others))

    return ByStrain(linear, here, *within_strain(changes, here.area))


def off_by_strain(model: SurfaceModel, problem: RoadProblem) -> tuple[Array, Array]:
    """`of_mu` and `of_area` of what JAX traces, without derivatives."""

    def changes(known: RoadProblem) -> tuple[np.ndarray, np.ndarray]:
        assert known.local.softened is not None
        return by_strain(model, known, known.local.softened)[2:]

    return _of_known(changes, problem)


def _of_known(
    changes: Callable[[RoadProblem], tuple[np.ndarray, np.ndarray]],
    problem: RoadProblem,
) -> tuple[Array, Array]:
    """Numbers of a problem that JAX traces, found when its own are known, without
    derivatives.
    """

    def numbers(shared: RoadShared, points: RoadPoints) -> tuple[np.ndarray, ...]:
        return changes(put_together(shared, points, problem.rtol))

    shared, points = stop_gradient(taken_apart(problem))
    return on_host(numbers, (points.velocity,) * 2, shared, points)


def within_strain(changes: Callable[[float], np.ndarray], area: Array) -> np.ndarray:
    """The changes (..., points) by a factor on the strain of each length scale, within
    which that is known at the real contact `area`.
    """
    (light, within), (full, most) = _STRAIN_SHARE
    more = np.clip((area - light) / (full - light), 0.0, 1.0)
    far = changes(most)
    return far if (more == 1).all() else more * far + (1 - more) * changes(within)


def _directed(
    scene: SteadyScene, surface: AbstractSpectrum, model: SurfaceModel
) -> Directed | None:
    """The direction of sliding at each point, where one is given and matters."""
    lay = lay_of(surface)
    if scene.direction is None or not (lay or model.on_map(surface)):
        return None
    closed = not (scene.traced or model.samples_directions)
    if lay and closed and not np.any(lay.log_peklenik):
        return None  # of a Peklenik number of 1 nothing depends on it
    return Directed(lay, scene.full(scene.direction).ravel())


def _turned(scene: SteadyScene, model: SurfaceModel, answer: _Answer) -> _Turned:
    """What the direction of sliding does, and the sampling error of the lay; how far mu
    may be from its mean over directions where none is given.
    """
    surface = answer.problem.surface
    lay = lay_of(surface)
    if lay is None:
        if scene.direction is None or model.on_map(surface):
            return _Turned(0.0, 0.0, [])
        words = "friction is taken as the same in all directions: no lay is known"
        return _Turned(0.0, 0.0, [("direction", words)])
    words = "none is given: the mean over directions"
    if scene.direction is not None:
        words = f"{brief(scene.direction, 'rad')} to the lay (0: along it)"
    alike = scene.direction is not None or not known(lay.log_peklenik).any()
    exact = alike and not known(lay.error).any()
    if exact or model.on_map(surface) or not model.takes_direction:
        return _Turned(0.0, 0.0, [("direction", words)])
    rows, problem = [("direction", words)], answer.problem
    if scene.traced:

        def changes(known: RoadProblem) -> tuple[np.ndarray, np.ndarray]:
            way = known.local.directed and known.local.directed.direction
            return _changes(*_at_other_lays(way, model, known, model.solve(known)))

        return _Turned(*_of_known(changes, problem), rows)
    direction = None if scene.direction is None else scene.full(scene.direction).ravel()
    here, ends = _at_other_lays(direction, model, problem, answer.hot)
    of_mu, of_area = _changes(here, ends)
    good = answer.hot.good
    if good.any():
        times = np.array([(end.mu / here.mu)[good] for end in ends])
        apart = "from {:.2g} times along the lay to {:.2g} times across it".format(
            *np.median(times, axis=1)
        )
        if scene.direction is not None:
            apart = f"{_between(times)} within the sampling error of the lay"
        words += f"; {apart}, which the model error holds"
    return _Turned(of_mu, of_area, [("direction", words)])


def _changes(
    here: SurfaceFriction, others: Sequence[SurfaceFriction]
) -> tuple[np.ndarray, np.ndarray]:
    """The largest of mu [absolute] and of the area [relative]."""
    return (
        np.max([abs(o.mu - here.mu) for o in others], axis=0),
        np.max([abs(o.area / here.area - 1) for o in others], axis=0),
    )


def _at_other_lays(
    direction: Array | None,
    model: SurfaceModel,
    problem: RoadProblem,
    hot: SurfaceFriction,
) -> tuple[SurfaceFriction, list[SurfaceFriction]]:
    """Friction, `hot`, and that where ln g is two standard errors less and more, in the
    direction that is given; without one where it is more, along the lay and across it.

    Random maps of another lay would be other maps: of these Multiscale says how much
    friction changes.
    """
    problem = problem._replace(rtol=_ROUGHLY, progress=None)
    on_maps: bool = model.samples_directions
    lay: Any = lay_of(problem.surface)
    solve = (Multiscale() if on_maps else model).solve

    def towards(direction: Array | float | None, errors: float) -> SurfaceFriction:
        directed = None
        if direction is not None:
            turned = np.broadcast_to(np.asarray(direction), problem.pressure.shape)
            directed = Directed(lay.off(errors), turned)
        local = problem.local._replace(directed=directed)
        return solve(problem._replace(local=local))

    here = towards(direction, 0.0) if on_maps else hot
    if direction is None:
        return here, [towards(angle, _LAY_ERRORS) for angle in (0.0, np.pi / 2)]
    return here, [towards(direction, errors) for errors in (-_LAY_ERRORS, _LAY_ERRORS)]


def _softening_words(
    softened: SoftenedByScale,
    surface: AbstractSpectrum,
    here: SurfaceFriction,
    linear: SurfaceFriction,
    good: Array,
) -> str:
    """How far moduli soften, and what that does."""
    strain = float(softened.strain(np.asarray(surface.q_high)))
    storage, loss = (float(x) for x in softened.softening.factors(strain))
    words = (
        f"strain up to {strain:.2g}, where the storage modulus is {storage:.0%} and "
        f"the loss modulus {loss:.0%}"
    )
    if not good.any():
        return words
    mu, area = (here.mu / linear.mu)[good], (here.area / linear.area)[good]
    return (
        f"{words}; hysteresis {mu.min():.2f} to {mu.max():.2f} times, contact area "
        f"{area.min():.2f} to {area.max():.2f} times those without"
    )


def surface_plan(call: RoughCall, model: SurfaceModel) -> SurfacePlan:
    """`em.plan` of a surface under a pressure; see there."""
    foundation, surface, scene = _check(call, model)
    return _plan(foundation, scene, surface, model, call.heat)


def _plan(
    foundation: SteadyBody,
    scene: SteadyScene,
    surface: AbstractSpectrum,
    model: SurfaceModel,
    heat: Heat | None,
) -> SurfacePlan:
    name = foundation.name or "a foundation given directly"
    work, skipped = model.work(surface)
    if _directed(scene, surface, model) is not None and not model.samples_directions:
        work += ", each averaged over the angle to the lay"
    points = int(np.prod(scene.shape))
    return SurfacePlan(
        f"{surface_in_words(surface)} on {name}",
        model.words() + _hot(model, heat),
        points,
        work,
        skipped,
    )


def _hot(model: SurfaceModel, heat: Heat | None) -> str:
    if heat is None:
        return ""
    return HOT if model.by_wave() is None else _HOT_BY_SCALE


def _check(
    call: RoughCall, model: SurfaceModel
) -> tuple[Foundation | TabulatedFoundation, AbstractSpectrum, SteadyScene]:
    """The foundation, the surface and the points, checked. Raises `InputError`."""
    surface, asked, heat = call.surface, call.asked, call.heat
    assert isinstance(surface, AbstractSpectrum)  # a line of heights has been refused
    only_one({"pressure": asked.pressure, "load": asked.load, "depth": asked.depth})
    foundation = surface_foundation(call.material)
    scene = rough_scene(foundation, surface, call.rtol, asked, "pressure")
    traced = scene.traced or is_traced(heat, call.adhesion, call.strain_share)
    scene = scene._replace(traced=traced)
    if asked.direction is not None and not model.takes_direction:
        raise InputError(
            argument="direction",
            got=asked.direction,
            accepted="left out without " + named(Multiscale(), Persson(), HalfSpace()),
        )
    check_heat(
        heat,
        asked.temperature,
        call.branch,
        traced,
        model.by_wave() is not None,
    )
    # averages over directions look far below a frequency, contact edges beyond q_high
    if not scene.traced:
        low, high = 1e-89 / float(surface.q_low), 1e95 / float(surface.q_high)
        accepted = (
            f"between {low:.0e} and {high:.0e} m/s on this surface, times the shift "
            "factor"
        )
        require("velocity", scene.reduced, accepted, lambda v: (v > low) & (v < high))
    return foundation, surface, scene


def _too_much(scene: SteadyScene, surface: AbstractSpectrum) -> tuple[Doubt, ...]:
    """Where a pressure exceeds the modulus that the rubber has at the longest waves."""
    body, reduced = scene.foundation, scene.reduced
    modulus = modulus_at(body, surface.q_low, reduced, scene.vertical)
    return pressed_too_hard(scene.full(scene.value), modulus)


def _misfit(
    foundation: SteadyBody,
    surface: AbstractSpectrum,
    cold: np.ndarray,
    reduced: np.ndarray,
) -> np.ndarray:
    """Relative change of mu for what a material misses of the data that it was fitted
    to; 0 where that is not known.

    Friction scales with the loss modulus, and in light contact with the reciprocal of the
    storage modulus: both root mean squares, over the frequencies from q_low v a_T, at the
    temperature of the body, to q_high v a_T, at that of the contact, or over all of the
    data where those lie beyond them.
    """
    ends = surface.q_low * cold, surface.q_high * reduced
    within = np.hypot(*misfit(foundation, np.minimum(*ends), np.maximum(*ends)))
    whole = np.nan_to_num(np.hypot(*misfit(foundation, 0.0, np.inf)))
    return np.where(np.isfinite(within), within, whole)


def _tops_words(model: SurfaceModel, surface: AbstractSpectrum, area: Array) -> str:
    """How the tops of measured heights differ from the rest, and what follows it."""
    times = _between(np.exp(top_slope(tops_of(surface), area)))
    what = "which friction follows"
    if not model.follows_tops:
        what = "which this model leaves out and the model error holds"
    return (
        f"the highest part, as large as the real contact, has {times} the rms slope of "
        f"all, {what}"
    )


def _between(factors: np.ndarray) -> str:
    """The range of some factors, one number where its ends are the same to two digits."""
    low, high = f"{np.nanmin(factors):.2g}", f"{np.nanmax(factors):.2g}"
    return f"{low} times" if low == high else f"{low} to {high} times"


def _of_tops(
    model: SurfaceModel,
    surface: AbstractSpectrum,
    area: Array,
    of_area: bool = False,
) -> Array:
    """Bound on |ln(mu/mu_3D)| by heights that are not Gaussian, or on that of the
    real contact.
    """
    tops = tops_of(surface)
    if tops is None:
        return 0.0 * area
    at_contact = xp.abs(top_slope(tops, area))
    at_all = xp.sqrt(xp.mean(tops**2))
    sample = getattr(surface, "skewness_error", 0.0)
    follows = _PER_TOP[model.follows_tops]
    whole = follows * at_contact + _PER_TOPS * at_all + _PER_SAMPLE * sample
    for name, times in (("flat", _PER_FLAT[of_area]), ("unlike", _PER_UNLIKE)):
        if (more := getattr(surface, name, None)) is not None:
            whole = whole + times * xp.maximum(top_slope(more, area), 0.0)
    return whole


def _of_left_out(
    surface: AbstractSpectrum, area: Array, of_area: bool = False
) -> Array:
    """Bound on |ln(mu/mu_3D)| by waves of a map that its spectrum lacks, or on that of
    the real contact: friction is proportional to the rms slope, in full contact to its
    square, contact to its reciprocal at most.
    """
    power = 1.0 if of_area else 1 + area
    return xp.abs(getattr(surface, "left_out", 0.0)) * power


def _of_lay(surface: AbstractSpectrum, area: Array) -> Array:
    """Bound on |ln(mu/mu_3D)| by what a lay does beside giving waves their directions,
    and on that of the real contact.
    """
    lay = lay_of(surface)
    if lay is None:
        return 0.0 * area
    stretch = xp.mean(xp.abs(lay.log_peklenik))
    return _PER_LAY * stretch * xp.sqrt(-xp.log(xp.clip(area, 1e-300, 1.0)))


def bound_of_heights(
    model: SurfaceModel, surface: AbstractSpectrum, area: Array, of_area: bool
) -> Array:
    """What tops, lay and waves left out of a measured surface add to a relative bound,
    of friction or of the real contact.
    """
    of_tops = xp.expm1(_of_tops(model, surface, area, of_area))
    of_tops = of_tops + xp.expm1(_of_left_out(surface, area, of_area))
    return of_tops + xp.expm1(_of_lay(surface, area))


def _model_error(
    model: SurfaceModel,
    scene: SteadyScene,
    answer: _Answer,
    of_strain: Array | float,
    of_area: bool = False,
) -> Any:
    """Bound on mu's distance from three dimensions, or on the area's relative one; None
    for that model itself.

    `of_strain` is what the strain at a scale, known within a factor, adds to it. The
    bound itself holds with softening as without: each scale is linear, and moduli that
    change with the wave number are what it was established for.
    """
    hysteresis, foundation = answer.hot, scene.foundation
    if foundation.softening is not None and not model.softens:
        return answer.field(scene.shape, np.full(np.shape(hysteresis.mu), np.nan))
    # a bound has no derivatives: of plain numbers nothing is traced
    surface = answer.problem.surface
    body, road, velocity, area = known(
        stop_gradient((foundation, surface, answer.reduced.ravel(), hysteresis.area))
    )
    bound = model.bound(body, road, velocity, area, of_area)
    if bound is None:
        return None
    bound = bound + bound_of_heights(model, road, area, of_area)
    if not of_area:
        bound = abs(hysteresis.mu) * bound
    return answer.field(scene.shape, bound + of_strain)
