"""What friction and rolling share: from a user's arguments to a plan and its result."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import compiled, stop_gradient, xp
from ..call.extrapolation import beyond_sweep, steady_beyond
from ..call.model_choice import of_smooth
from ..call.problem import (
    Asked,
    SteadyScene,
    check_rtol,
    doubt_depth,
    hint_at_metres,
    steady_scene,
)
from ..checks import Array, is_traced, nan_unless, require, warn_unless
from ..element.law import Foundation, as_foundation
from ..element.layer import Body
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..results.curve import Contact
from ..results.doubts import Doubt
from ..results.words import describe
from ..surface.direction import BARE_LINE
from ..surface.lines import AbstractLines, SingleLine, Strips
from ..surface.shapes import AbstractShape, Cylinder, FlatPunch, PowerLaw
from ..trees import replaced
from .passage import Control
from .plan import Plan, PlanAsked, make_plan
from .softening import check_softening, run_softened, softened_words
from .solve import SolvedPoints, run

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import ArrayLike
    from ..call.types import Indenter, Material, ModelLike

AVERAGED = "MDR line averaged over directions (estimate for the half-space)"
CORRECTED = (
    "MDR line averaged over directions, corrected for an asymmetric contact (estimate "
    "for the half-space)"
)
BARE = (
    "bare MDR line (textbook; overstates the losses of a half-space by up to a factor "
    "of 2)"
)
LAYER = "independent springs (textbook, not the layer itself)"


@dataclasses.dataclass(frozen=True)
class SmoothCall:
    """A smooth body in steady motion, as a verb was asked for it."""

    quantity: str  # "friction", "rolling", ...
    material: Material
    shape: Indenter
    asked: Asked
    model: ModelLike | None = None
    rtol: float = 1e-6


class SmoothScene(NamedTuple):
    """A steady scene of a smooth body: its points, broadcast and flattened, its lines
    and its plan.
    """

    foundation: Foundation
    law: Relaxation
    lines: AbstractLines
    control: Control
    value: Float[Array, " points"]  # load over b_T [N] or depth [m]
    # b_T, by which forces are larger than those of `law`
    vertical: Float[Array, " points"]
    velocity: Float[Array, " points"]  # as given [m/s]
    reduced: Float[Array, " points"]  # velocity times a_T [m/s]
    temperature: Any  # broadcast to `shape`, or None
    shape: tuple[int, ...]  # of the result's fields
    plan: Plan
    inputs: tuple[tuple[str, str], ...]


class Steady(NamedTuple):
    """Solved scene, every field in the broadcast shape; NaN where a point did not
    converge.
    """

    velocity: Float[Array, "..."]
    mu: Float[Array, "..."]
    error: Float[Array, "..."]
    model_error: Float[Array, "..."]
    normal_force: Float[Array, "..."]
    friction_force: Float[Array, "..."]
    depth: Float[Array, "..."]
    contact: Contact
    converged: Bool[Array, "..."]
    marks: tuple[Doubt, ...]
    inputs: tuple[tuple[str, str], ...]
    # effective strain of the contact, where the material softens
    strain: Float[Array, "..."] | None = None
    linear: Float[Array, "..."] | None = None  # mu without softening


@dataclasses.dataclass(frozen=True)
class LayerPlan:
    """What is computed on a layer; `print(plan)` says it in words."""

    quantity: str
    scene: str
    model: str
    control: str
    points: int
    rtol: float
    covers: tuple[tuple[str, str], ...]  # each as a row of words
    work: tuple[tuple[str, str], ...]  # likewise

    def __str__(self) -> str:
        points = f"{self.points} point{'s' * (self.points != 1)}"
        asked = f"{points} by {self.control}, relative error {self.rtol:g}"
        rows = ("model", self.model), ("asked", asked), *self.covers, *self.work
        lines = (f"  {title:<12} {words}" for title, words in rows)
        return "\n".join([f"Plan: {self.quantity}, {self.scene}", *lines])


class OnLayer(NamedTuple):
    """What a curve is made of, of a body on an `em.layer`."""

    steady: Steady
    temperature: Array | None  # broadcast to the points
    plan: LayerPlan


class Solved(NamedTuple):
    """What is found on a layer, flat, at the reference temperature."""

    mu: Array
    error: Array
    model_error: Array
    force: Array  # over b_T [N]
    depth: Array  # [m]
    leading: Array  # [m]
    trailing: Array  # [m]
    good: Array


def packed(
    points: SteadyScene,
    solved: Solved,
    body: Body,
    shape: AbstractShape,
    plan: LayerPlan,
) -> Steady:
    """Fields in the shape of the points, NaN where one failed; forces times b_T."""

    def shaped(field: Array) -> Any:
        return nan_unless(solved.good, field).reshape(points.shape)

    force = solved.force * xp.asarray(points.vertical).reshape(-1)
    contact = Contact(shaped(solved.leading), shaped(solved.trailing))
    size = 0.5 * (contact.leading + contact.trailing)
    temperature = points.full(points.temperature)
    beyond = steady_beyond(body.range, points.full(points.reduced), size, temperature)
    name = describe(shape).replace(" on a layer", "")
    inputs = points.inputs(("shape", name), *plan.covers)
    inputs.append(("relative tolerance", f"{plan.rtol:g}"))
    return Steady(
        velocity=points.full(points.velocity),
        mu=shaped(solved.mu),
        error=shaped(solved.error),
        model_error=shaped(solved.model_error),
        normal_force=shaped(force),
        friction_force=shaped(solved.mu * force),
        depth=shaped(solved.depth),
        contact=contact,
        converged=solved.good.reshape(points.shape),
        marks=(*beyond, *doubt_depth(body, shape, shape._profile(contact.leading))),
        inputs=tuple(inputs),
    )


def set_up(call: SmoothCall, softens: bool = True) -> SmoothScene:
    """Checks the arguments and plans the scene; without `softens` the moduli are those
    of small strain.

    Raises `InputError` for whatever has no meaning.
    """
    shape, rtol = call.shape, call.rtol
    lines, foundation = contact(call.material, shape)
    small = not softens and foundation.softening is not None
    foundation = replaced(foundation, softening=None) if small else foundation
    no_pressure(shape, call.asked.pressure)
    chosen = _of_line(call.model, call.quantity, shape)
    check_rtol(rtol)
    points = steady_scene(foundation, lines, call.asked)
    control: Control = "load" if points.name == "load" else "depth"
    law, temperatures, vertical = (
        foundation.law(),
        points.temperature,
        points.vertical.reshape(-1),
    )
    value, reduced = points.at_reference(), points.reduced.reshape(-1)
    if not points.traced:
        _check_size(lines, control, value)
    layer = bool(foundation.per_area) or isinstance(shape, Cylinder)
    averaged = chosen.over_directions and not layer
    corrected = averaged and chosen.corrected
    words = CORRECTED if corrected else AVERAGED if averaged else BARE
    words = LAYER if layer else words
    body = describe(shape)
    name = f"{body} on {foundation.name or ('a layer' if layer else 'a half-space')}"
    check_softening(foundation, lines)
    spread = None if points.traced else _softened_too(foundation, control, value)
    passing = None if spread is None else np.tile(reduced, spread.size // reduced.size)
    asked = PlanAsked(
        call.quantity,
        name,
        words,
        control,
        points=int(np.prod(points.shape)),
        temperatures=1 if temperatures is None else int(np.size(temperatures)),
        rtol=float(rtol),
        averaged=averaged,
        corrected=corrected,
        range=foundation.range,
    )
    plan = make_plan(asked, law, lines, spread, passing)
    if plan.marched and plan.traced:
        raise InputError(
            "shape must have a convex profile under jit, grad and vmap: where contact "
            "may be renewed, sliding is known for numbers only."
        )
    inputs = [*points.inputs(("shape", body)), ("relative tolerance", f"{rtol:g}")]
    inputs += [("softening", "left out: moduli of small strain")] if small else []
    return SmoothScene(
        foundation,
        law,
        lines,
        control,
        value,
        vertical,
        points.full(points.velocity).reshape(-1),
        reduced,
        points.full(temperatures),
        points.shape,
        plan,
        tuple(inputs),
    )


def _of_line(model: ModelLike | None, quantity: str, shape: AbstractShape) -> Any:
    """The model, which must be one of lines. Raises `InputError`."""
    chosen = of_smooth(model, quantity, shape.label)
    if not chosen.on_line:
        raise InputError(
            "model must be em.Averaged() or em.Line() on the line of a "
            f"{shape.label}, got {chosen!r}."
        )
    return chosen


def _softened_too(
    foundation: Foundation, control: Control, value: np.ndarray
) -> np.ndarray:
    """The loads to plan for: under softer rubber the contact is that under a higher
    one.
    """
    if foundation.softening is None or control == "depth":
        return value
    return np.concatenate([value, value / np.min(foundation.softening.storage)])


def no_pressure(shape: AbstractShape, pressure: ArrayLike | None) -> None:
    """Refuses a pressure on a smooth body. Raises `InputError`."""
    if pressure is not None:
        raise InputError(
            f"pressure belongs to a rough surface; a {shape.label} takes load or "
            f"depth, got pressure={pressure}. Give "
            "the force as load= [N]."
        )


def solve(scene: SmoothScene) -> Steady:
    """Runs the plan; points that failed are NaN, and one warning counts them."""
    softening, soft, inputs = scene.foundation.softening, None, scene.inputs
    if softening is None:
        result = run(scene.plan, scene.law, scene.lines, scene.value, scene.reduced)
    else:
        result, soft = run_softened(
            scene.plan,
            scene.foundation,
            scene.law,
            scene.lines,
            scene.value,
            scene.reduced,
        )
    traced = is_traced(result.mu)
    good = result.line.converged
    if not traced and not good.all():
        why = _sunk(scene) if result.sunk else nearly(good, result.error, result.mu)
        warn_unless(good, "points", f" to rtol={scene.plan.rtol:g}", why)
    # A Foundation given directly is a line by definition; a half-space under the bare
    # line is not.
    bare = (
        BARE_LINE
        if scene.plan.model == BARE and scene.foundation.per_area is False
        else 0.0
    )
    extra = () if soft is None else (soft.strain, soft.linear)
    fields, strain, linear = _fields(
        result._replace(sunk=False), scene.vertical, extra, bare=bare, shape=scene.shape
    )
    size = 0.5 * (fields["contact"].leading + fields["contact"].trailing)
    beyond = steady_beyond(
        scene.foundation.range,
        scene.reduced.reshape(scene.shape),
        size,
        scene.temperature,
    )
    if softening is not None and soft is not None:
        outside = stop_gradient(xp.asarray(good & softening.outside(soft.strain)))
        beyond += beyond_sweep(outside.reshape(scene.shape), scene.foundation.range)
        if not traced:
            inputs += softened_words(soft, np.asarray(good))
    beyond += doubt_depth(scene.foundation, scene.lines.shape, fields["depth"])
    return Steady(
        velocity=scene.velocity.reshape(scene.shape),
        **fields,
        converged=good.reshape(scene.shape),
        marks=beyond,
        inputs=inputs,
        strain=strain,
        linear=linear,
    )


def nearly(good: Array, error: Array, mu: Array) -> str:
    """What a larger rtol would help, if the points that failed have small errors."""
    missed = (error / mu)[~good & (mu > 0)]
    if not missed.size or not missed.max() < 0.1:
        return ""
    return (
        f"Their estimated errors are up to {missed.max():.1e} of mu, so a larger rtol "
        "would accept them."
    )


def too_deep(sunk: Array, thick: Array | float) -> str:
    """How many points would sink into the ground under a layer."""
    if not np.any(sunk):
        return ""
    return (
        f"{int(np.sum(sunk))} of them would sink deeper than the layer is thick "
        f"({1e3 * float(thick):.4g} mm)."
    )


@compiled("bare", "shape")
def _fields(
    sweep: SolvedPoints,
    vertical: Array,
    extra: tuple[Any, ...],
    *,
    bare: float,
    shape: tuple[int, ...],
) -> tuple[dict[str, Any], Any, Any]:
    """The fields of a result in their shape, NaN where a point failed; strain and
    linear friction, if there are any.

    One program where JAX traces.
    """

    good = sweep.line.converged
    if not is_traced(sweep) and np.all(good):
        good = None

    def shaped(field: Array) -> Any:
        return (
            None
            if field is None
            else (field if good is None else nan_unless(good, field)).reshape(shape)
        )

    force = sweep.line.normal_force * vertical
    fields = {
        "mu": shaped(sweep.mu),
        "error": shaped(sweep.error),
        "model_error": shaped(sweep.model_error + bare * sweep.mu),
        "normal_force": shaped(force),
        "friction_force": shaped(sweep.mu * force),
        "depth": shaped(sweep.line.depth),
        "contact": Contact(shaped(sweep.line.leading), shaped(sweep.line.trailing)),
    }
    strain, linear = (shaped(x) for x in extra) if extra else (None, None)
    return fields, strain, linear


def _sunk(scene: SmoothScene) -> str:
    """Why a load was not carried, and what to do."""
    radius = float(np.asarray(scene.lines.shape.largest_contact))
    sentence = (
        f"The load would need a contact wider than the {scene.lines.shape.label} has "
        f"({radius:.4g} m)"
    )
    if scene.plan.averaged and float(np.asarray(scene.law.equilibrium)) == 0:
        sentence += (
            " in the slow directions of the average, since a liquid (equilibrium "
            "modulus 0) carries nothing at rest: give em.Paraboloid, or "
            "model=em.Line()"
        )
    return f"{sentence}."


def contact(material: Material, shape: Indenter) -> tuple[AbstractLines, Foundation]:
    """The lines of a sliding contact, and what they are made of. Raises `InputError`
    for a pair that does not fit.
    """
    hint_at_metres(shape)
    foundation = as_foundation(material)
    if not isinstance(shape, AbstractShape):
        raise InputError(
            "shape must be an em.Sphere, em.Cone, em.Profile, em.Cylinder or the "
            f"like, got {shape!r}."
        )
    if isinstance(shape, FlatPunch):
        raise InputError(
            "shape must not be a FlatPunch in sliding or rolling: its sharp edge "
            "strains the surface at an infinite rate at any velocity, so that the "
            "friction depends on how the edge is rounded. Give the rounding: "
            "em.Profile with points along the edge, or em.PowerLaw with a large "
            "exponent."
        )
    if isinstance(shape, PowerLaw) and shape.exponent < 1:
        raise InputError(
            f"exponent must be 1 or more in sliding, got {shape.exponent:g}: a body "
            "with an infinitely sharp tip has "
            "no steady sliding solution."
        )
    if isinstance(shape, Cylinder):
        if foundation.per_area is False:
            raise InputError(
                "material must be independent springs under a Cylinder here, got a "
                "half-space: use em.springs(material, thickness). A cylinder on a "
                "half-space is no MDR problem."
            )
        return SingleLine(shape), foundation
    if foundation.per_area:
        return Strips(shape), foundation
    return SingleLine(shape), foundation


def _check_size(lines: AbstractLines, control: Control, value: Array) -> None:
    largest = float(np.asarray(lines.shape.largest_contact))
    if control == "depth" and np.isfinite(largest):
        deepest = float(lines.depth(np.array(largest * (1 - 1e-12))))
        require(
            "depth",
            value,
            f"below {deepest:.4g} m, where the contact reaches the end of the profile",
            lambda d: d < deepest,
        )
