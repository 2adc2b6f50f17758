"""Steady sliding friction of one indenter or of a rough surface."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ..call.model_choice import is_rough, only_rough
from ..call.problem import Asked
from ..call.several_materials import over_materials
from ..checks import is_traced, numpy_unless_traced
from ..errors import InputError, quiet
from ..material.relaxation import scaled
from ..material.validity import beyond_data
from ..models import Line, as_model
from ..progress_bar import reporter
from ..results.base import NOT_STATED, Assumed, Change, RoadErrors
from ..results.curve import AbstractCurve, FrictionCurve
from ..results.words import in_words
from ..rough.adhesion import AdhesiveShear, check_adhesion, on_contact
from ..rough.heat import Heat
from ..rough.problem import RoughCall
from ..rough.road_model import SurfaceModel
from ..smooth.on_layer import is_on_layer
from ..smooth.problem import SmoothCall, check
from ..surface.spectrum import AbstractSpectrum
from ..surface.topography import MeasuredSurface
from ..trees import replaced
from .roads import KINDS, cells_of_body, friction_by, hint_at_line, of_rough
from .steady import in_64_bits_where, steady_contact

if TYPE_CHECKING:
    from .._types import ArrayLike, Branch, Number
    from ..call.types import Indenter, Materials, ModelLike, Surface
    from ..results.plot_contacts import SteadyElements


Curve = TypeVar("Curve", bound=AbstractCurve)
_ROUGHLY = 1e-4  # relative error of what only tells how uncertain a number is


@dataclasses.dataclass(frozen=True, eq=False)
class CallAgain:
    """A call of `friction` once more, as `results.base.Again`."""

    call: RoughCall | SmoothCall
    adhesion: AdhesiveShear | None
    solve: Callable[[Any, AdhesiveShear | None], AbstractCurve]
    errors: RoadErrors = NOT_STATED  # that were stated

    @property
    def measured(self) -> bool:
        """Whether the surface was measured, and has sampling errors."""
        surface = getattr(self.call, "surface", None)
        return isinstance(surface, MeasuredSurface)

    @property
    def material(self) -> object:
        """The rubber, as the verb was given it."""
        return self.call.material

    @property
    def bands(self) -> list[Assumed | None]:
        """What is typical and not measured of shear law and heat."""
        heat: Heat | None = getattr(self.call, "heat", None)
        return [law and law.band() for law in (self.adhesion, heat)]

    def of(
        self, material: object, errors: RoadErrors | None = None, road: object = None
    ) -> CallAgain:
        """The call of another material, and of a road of which the errors are stated."""
        new = {"material": material} | ({} if road is None else {"surface": road})
        call: Any = dataclasses.replace(self.call, **new)
        return dataclasses.replace(self, call=call, errors=errors or self.errors)

    def at(self, places: dict[str, np.ndarray]) -> CallAgain:
        """The call at other points."""
        asked = dataclasses.replace(self.call.asked, **places)
        return dataclasses.replace(self, call=replaced(self.call, asked=asked))

    def curve(self, change: Change) -> AbstractCurve | None:
        """The curve with one thing changed; None where that has no answer, as beyond a
        shift law, or where the shortest wave would be longer than the longest.
        """
        call, asked, adhesion = self.call, self.call.asked, self.adhesion
        if change.kelvin:
            warmer = np.asarray(asked.temperature, dtype=float) + change.kelvin
            asked = dataclasses.replace(asked, temperature=warmer)
        if change.wider is not None:
            solid: Any = beyond_data(call.material, change.wider, change.beyond)
            if solid is None:
                return None
            call = dataclasses.replace(call, material=solid)
        if adhesion is not None:
            adhesion = replaced(adhesion, stress=adhesion.stress * change.stress)
        given = {"asked": asked, "rtol": max(call.rtol, _ROUGHLY)}
        try:
            if isinstance(call, RoughCall):
                given |= {"surface": _altered(call.surface, change), "progress": None}
                if call.heat is not None and change.conducts is not None:
                    given |= {"heat": call.heat.at_end(change.conducts)}
            with quiet():
                return _once_more(
                    self.solve, dataclasses.replace(call, **given), adhesion
                )
        except InputError:
            return None

    def elements(self, point: int, leading: float) -> SteadyElements:
        """What the elements do under a point whose leading edge [m] is known."""
        model = getattr(self.call, "model", None)  # which a surface has not
        chosen = as_model(model, KINDS)
        if chosen is None or not chosen.marched:
            raise InputError(
                argument="model",
                got=model,
                accepted="em.Marched() for the elements of a curve",
            )
        assert isinstance(self.call, SmoothCall)
        return _elements(self.call, point, leading)


@numpy_unless_traced
def _elements(call: SmoothCall, point: int, leading: float) -> SteadyElements:
    from ..smooth.march import steady_elements

    scene = check(call)
    if scene.foundation.softening is not None:
        raise InputError(
            argument="material",
            got=scene.foundation.name,
            accepted="one that does not soften for the elements of a curve",
        )
    velocity = float(np.ravel(scene.points.full(scene.points.velocity))[point])
    return steady_elements(
        scaled(scene.law, float(scene.vertical[point])),
        scene.lines,
        np.array([leading]),
        scene.reduced[point : point + 1],
        per="Pa" if scene.foundation.per_area else "N/m",
        title=f"{scene.plan.scene}, {in_words('velocity', velocity)}",
    )


def _altered(surface: Any, change: Change) -> Any:
    """The surface with another end, heights or spectrum."""
    if change.shorter != 1:
        surface = surface.ended(surface.q_high * change.shorter)
    if change.higher != 1:
        surface = surface.raised(change.higher)
    return surface.sampled(change.sampled) if change.sampled else surface


@numpy_unless_traced
def _once_more(
    solve: Callable[[Any, AdhesiveShear | None], AbstractCurve],
    call: RoughCall | SmoothCall,
    adhesion: AdhesiveShear | None,
) -> AbstractCurve:
    return solve(call, adhesion)


def _on_road(
    call: RoughCall, adhesion: AdhesiveShear | None, model: Line | SurfaceModel
) -> FrictionCurve:
    """Friction of a rough line or surface."""
    return friction_by(dataclasses.replace(call, adhesion=adhesion), model)


def repeatable(
    curve: Curve,
    call: RoughCall | SmoothCall,
    adhesion: AdhesiveShear | None,
    solve: Callable[[Any, AdhesiveShear | None], AbstractCurve],
) -> Curve:
    """The curve of a call, with the call itself unless JAX traces it."""
    if is_traced(curve.error):
        return curve
    return dataclasses.replace(curve, again=CallAgain(call, adhesion, solve))


def _on_smooth(call: SmoothCall, adhesion: AdhesiveShear | None) -> FrictionCurve:
    """Friction of a smooth body."""
    cells = cells_of_body(call)
    if cells is not None:
        from ..reference.half_space import friction_on_cells

        return friction_on_cells(call, adhesion, cells)
    contact = steady_contact(call)
    solution = contact.solution
    curve = FrictionCurve(
        mu=solution.mu,
        friction_force=solution.friction_force,
        **contact.common_fields(),
    )
    if adhesion is None:
        return curve
    return on_contact(curve, adhesion, call.shape, call.material)


def _has_large_program(material: object, shape: object, pressure: object) -> bool:
    """Whether a surface is under a pressure, or the rubber is a layer."""
    if isinstance(shape, AbstractSpectrum) and pressure is not None:
        return True
    return is_on_layer(material, shape)


@over_materials
@in_64_bits_where(_has_large_program)
@numpy_unless_traced
def friction(
    material: Materials,
    shape: Indenter | Surface,
    *,
    velocity: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    pressure: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    model: ModelLike | None = None,
    rtol: float = 1e-6,
    heat: Heat | None = None,
    adhesion: AdhesiveShear | None = None,
    branch: Branch = "cold",
    strain_share: Number = 0.5,
    direction: ArrayLike | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> FrictionCurve:
    """Friction coefficient of an indenter or a rough surface in steady sliding against
    velocity, load and temperature.

    Arguments broadcast against each other; every field of the result has the broadcast
    shape.

    Args:
        material: `Prony` (then a half-space of it), or `Foundation` (two bodies, a
            layer).
        shape: a smooth body (`em.Sphere`, ...), an `em.RoughLine`, or a surface
            (`em.SelfAffine`, `em.Spectrum`, measured).
        velocity: sliding velocity [m/s].
        load: normal force [N]; on a rough line or surface force per length of line
            [N/m].
        depth: indentation depth [m], in place of a load; that of the highest point of a
            rough line.
        pressure: nominal pressure on a surface [Pa].
        temperature: [K], for a material with a shift law.
        model: what the contact is computed with, an object or its name. For a smooth
            body `em.Averaged()`, the default, `em.Line()`, `em.Marched()` or
            `em.HalfSpace()`; on layers every line is exact, and the model makes no
            difference. For a rough line `em.Line()`. For a surface under a pressure
            `em.Multiscale()`, the default, `em.Persson()`, `em.HalfSpace()` or
            `em.Line()`; under a load or a depth `em.Line()`.
        rtol: relative error of mu to be met, 1e-3 to 1e-10. With `em.Line` on a rough
            line or surface it is that of the solution on its samples;
            `curve.lines.numerical` has the error for the sampling too, and a point
            where it exceeds a tenth of mu is NaN.
        heat: `em.Heat(...)` heats the rubber of a surface under a pressure by its
            friction, from `temperature`, that of the body, on, until friction and
            temperature agree: `mu` is then the hot curve, `cold` the one without
            heating, `temperature_rise` the mean where the heat arises. With
            `em.Multiscale()` and `em.Persson()` each length scale has a temperature of
            its own (`elastomdr.rough.temperature_by_scale`), `contact_rise` that of the
            shortest waves; with others there is one (`elastomdr.rough.heat`). Points
            without one below the end of the shift law are NaN.
        adhesion: `em.AdhesiveShear(...)` adds the shear stress of dry contact on the
            area of real contact: `mu` is then the sum of `hysteresis` and `adhesion`.
            On a surface under a pressure that is its `area_ratio`; under a smooth body
            `contact_area`, from the edges of its contact or, with `em.HalfSpace()`,
            from its cells. A line (`em.Line` on a rough line or surface) has none.
        branch: which of several temperatures is taken where friction that grows as it
            heats agrees with more than one, `other_states`: "cold", that which rubber
            reaches from the body's, or "hot", that which it keeps that was hot before.
        strain_share: of a material with a softening on a surface: strain amplitude at
            wave number q over the rms slope of the waves up to q, above 0 and at most
            2. Elastic maps in three dimensions have 0.54 (0.40 to 0.67) in light
            contact (`docs/theory.md`, section 21.1), of a sweep in shear; 0.5 is not
            fitted to friction. `linear` is mu without softening. `em.Line()` and
            `em.HalfSpace()` on a surface are linear and say so.
        direction: of sliding, as an angle to the lay of a measured surface whose
            spectrum depends on direction [rad]: 0 along the grooves, pi/2 across. None:
            the mean over directions, and `model_error` holds what is between them. A
            surface without a lay is the same in all directions.
        progress: `progress(done, total)` is called after each batch on a rough line or
            surface.

    Returns:
        An `em.FrictionCurve`. `error` is numerical, with the scatter of random lines;
        `model_error` bounds the distance to the half-space. With `em.Averaged` depth,
        normal force and contact edges are those of the line at the velocity itself.
        Points that do not converge are NaN and counted in one `ConvergenceWarning`.

    Raises:
        InputError: for arguments that have no meaning.

    Exact for the line and for layers; for the half-space see
    `elastomdr.surface.direction`. Differentiable with respect to moduli, times,
    geometry, load or depth, velocity and temperature, but for `em.Line` on a rough line
    or surface. Source: Popov & Hess 2015, ch. 7
    and 10, and `docs/theory.md`.
    """
    solid: Any = material  # `over_materials` has taken a list apart
    asked = Asked(velocity, load, depth, pressure, temperature, direction)
    if is_rough(shape):
        road_model = of_rough(model, shape, pressure)
        tell = reporter("friction on a rough surface", progress)
        rough = RoughCall(
            solid,
            shape,
            asked,
            rtol,
            heat,
            adhesion,
            strain_share,
            tell,
            branch,
        )
        curve = friction_by(rough, road_model)
        hint_at_line(model, shape, asked)
        solve = partial(_on_road, model=road_model)
        return repeatable(curve, rough, adhesion, solve)
    only_rough(heat=heat, direction=direction, branch=branch)
    check_adhesion(adhesion, temperature)
    body: Any = shape  # anything else is refused there
    smooth = SmoothCall("friction", solid, body, asked, model, rtol)
    curve = _on_smooth(smooth, adhesion)
    return repeatable(curve, smooth, adhesion, _on_smooth)
