"""What friction and rolling share: from a user's arguments to a plan and its result."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, NamedTuple

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
from ..checks import Array, nan_unless, require, warn_unless
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
from .solve import run

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
# of a cylinder on a `Foundation` without `per_area`: why no bound is known, the remedy
NO_UNIT = (
    "numbers of a Foundation are taken per area [Pa/m] under a cylinder, as E* [Pa] "
    "elsewhere",
    "per_area=True in em.Foundation for springs, or the material itself",
)
MARCHED = "; elements marched by diffrax"


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
    points: SteadyScene
    plan: Plan
    inputs: tuple[tuple[str, str], ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the result's fields."""
        return self.points.shape

    @property
    def reduced(self) -> Float[Array, " points"]:
        """Velocity times a_T [m/s]."""
        return self.points.reduced.reshape(-1)

    @property
    def vertical(self) -> Float[Array, " points"]:
        """b_T, by which forces are larger than those of `law`."""
        return self.points.vertical.reshape(-1)

    @property
    def temperature(self) -> Array | None:
        """In the shape of the result's fields."""
        return self.points.full(self.points.temperature)


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


def report_on_layer(
    points: SteadyScene,
    solved: Solved,
    body: Body,
    shape: AbstractShape,
    plan: LayerPlan,
) -> OnLayer:
    """What is made of a body on a layer."""
    name = describe(shape).replace(" on a layer", "")
    inputs = points.inputs(("shape", name), *plan.covers)
    inputs.append(("relative tolerance", f"{plan.rtol:g}"))
    steady = report(points, solved, body, tuple(inputs), ())
    # the contact is wider than that of a half-space at this depth
    deep = doubt_depth(body, shape, shape._profile(steady.contact.leading))
    steady = steady._replace(marks=(*steady.marks, *deep))
    return OnLayer(steady, points.full(points.temperature), plan)


class Solved(NamedTuple):
    """What is found, flat, at the reference temperature."""

    mu: Array
    error: Array
    model_error: Array
    force: Array  # over b_T [N]
    depth: Array  # [m]
    leading: Array  # [m]
    trailing: Array  # [m]
    good: Array


def report(
    points: SteadyScene,
    solved: Solved,
    body: Body,
    inputs: tuple[tuple[str, str], ...],
    marks: tuple[Doubt, ...],
) -> Steady:
    """Fields in the shape of the points, NaN where one failed; forces times b_T. `marks`
    come after those of the material.
    """
    shown = _shaped(solved, points.vertical.reshape(-1), points.shape)
    contact = Contact(shown.leading, shown.trailing)
    size, reduced = (
        0.5 * (contact.leading + contact.trailing),
        points.full(points.reduced),
    )
    temperature = points.full(points.temperature)
    return Steady(
        velocity=points.full(points.velocity),
        mu=shown.mu,
        error=shown.error,
        model_error=shown.model_error,
        normal_force=shown.force,
        friction_force=shown.mu * shown.force,
        depth=shown.depth,
        contact=contact,
        converged=shown.good,
        marks=(*steady_beyond(body.range, reduced, size, temperature), *marks),
        inputs=inputs,
    )


@compiled("shape")
def _shaped(solved: Solved, vertical: Array, shape: tuple[int, ...]) -> Solved:
    """One program where JAX traces."""
    shown = solved._replace(force=solved.force * vertical)
    fields = [nan_unless(solved.good, x).reshape(shape) for x in shown[:-1]]
    return Solved(*fields, good=solved.good.reshape(shape))


def check(call: SmoothCall, softens: bool = True) -> SmoothScene:
    """Checks the arguments and plans the scene; without `softens` the moduli are those
    of small strain.

    Raises `InputError` for whatever has no meaning.
    """
    shape, rtol = call.shape, call.rtol
    lines, foundation = contact(call.material, shape)
    small = not softens and foundation.softening is not None
    foundation = replaced(foundation, softening=None) if small else foundation
    no_pressure(shape, call.asked.pressure)
    chosen = of_smooth(call.model, call.quantity, shape.label)
    check_rtol(rtol)
    points = steady_scene(foundation, lines, call.asked)
    control: Control = "load" if points.name == "load" else "depth"
    law, temperatures = foundation.law(), points.temperature
    value, reduced = points.at_reference(), points.reduced.reshape(-1)
    if not points.traced:
        _check_size(lines, control, value)
    layer = bool(foundation.per_area) or isinstance(shape, Cylinder)
    averaged = chosen.over_directions and not layer
    corrected = averaged and chosen.corrected
    words = CORRECTED if corrected else AVERAGED if averaged else BARE
    words = LAYER if layer else words
    words += MARCHED if chosen.marched else ""
    body = describe(shape)
    name = f"{body} on {foundation.name or ('a layer' if layer else 'a half-space')}"
    check_softening(foundation, lines)
    spread = (
        None if points.traced else _softened_too(foundation, control, np.asarray(value))
    )
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
        marched=chosen.marched,
    )
    plan = make_plan(asked, law, lines, spread, passing)
    if chosen.marched and plan.traced:
        raise InputError(
            argument="model",
            got=chosen,
            accepted="one with derivatives under jit, grad and vmap",
            hint="em.Averaged() is the same by closed forms",
        )
    if plan.marched and plan.traced:
        raise InputError(
            argument="shape",
            accepted="of a convex profile under jit, grad and vmap",
            hint="where contact may be renewed, sliding is known for numbers only",
        )
    inputs = [*points.inputs(("shape", body)), ("relative tolerance", f"{rtol:g}")]
    inputs += [("softening", "left out: moduli of small strain")] if small else []
    return SmoothScene(
        foundation, law, lines, control, value, points, plan, tuple(inputs)
    )


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
            argument="pressure",
            got=pressure,
            accepted=f"left out for a {shape.label}",
            hint="it belongs to a rough surface; give the force as load [N], or depth",
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
    traced = scene.points.traced
    good = result.line.converged
    if not traced and not good.all():
        rtol = scene.plan.rtol
        why = nearly(good, result.error, result.mu, rtol)
        why = _sunk(scene) if result.sunk else why
        warn_unless(good, "points", f" to rtol={rtol:g}", why)
    springs = scene.foundation.per_area or isinstance(scene.lines.shape, Cylinder)
    bare = not scene.plan.averaged and not springs
    bound, line = BARE_LINE * result.mu if bare else 0.0, result.line
    marks: tuple[Doubt, ...] = ()
    strain, linear = None, None
    if in_no_unit(scene.foundation, scene.lines.shape):
        bound, says = np.nan, f"have no bound on the model: {NO_UNIT[0]}"
        points = good.reshape(scene.shape)
        marks = (Doubt("no prediction", points, says, NO_UNIT[1]),)
    if softening is not None and soft is not None:
        outside = stop_gradient(xp.asarray(good & softening.outside(soft.strain)))
        marks += beyond_sweep(outside.reshape(scene.shape), scene.foundation.range)
        strain = nan_unless(good, soft.strain).reshape(scene.shape)
        if soft.linear is not None:
            linear = nan_unless(good, soft.linear).reshape(scene.shape)
        if not traced:
            inputs += softened_words(soft, np.asarray(good))
    solved = Solved(
        result.mu,
        result.error,
        result.model_error + bound,
        line.normal_force,
        line.depth,
        line.leading,
        line.trailing,
        good,
    )
    steady = report(scene.points, solved, scene.foundation, inputs, marks)
    deep = doubt_depth(scene.foundation, scene.lines.shape, steady.depth)
    return steady._replace(marks=(*steady.marks, *deep), strain=strain, linear=linear)


def in_no_unit(foundation: Foundation, shape: object) -> bool:
    """Whether numbers given directly are taken per area for the sake of the shape."""
    return foundation.per_area is None and isinstance(shape, Cylinder)


def nearly(good: Array, error: Array, mu: Array, rtol: float) -> str:
    """Why points failed: errors that a larger rtol would accept, or a search."""
    missed = (error / mu)[~good & (mu > 0)]
    missed = missed[np.isfinite(missed)]
    if not missed.size or not missed.max() < 0.1:
        return ""
    larger = "so a larger rtol would accept them"
    why = larger if missed.max() > rtol else "but some contact was not found"
    return f"Their estimated errors are up to {missed.max():.1e} of mu, {why}."


def too_deep(sunk: Array, thick: Array | float) -> str:
    """How many points would sink into the ground under a layer."""
    if not np.any(sunk):
        return ""
    return (
        f"{int(np.sum(sunk))} of them would sink deeper than the layer is thick "
        f"({1e3 * float(thick):.4g} mm)."
    )


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


def check_edge(shape: AbstractShape) -> None:
    """Raises `InputError` for bodies so sharp that none slides steadily."""
    if isinstance(shape, FlatPunch):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="without a sharp edge in sliding or rolling",
            hint="it strains the surface at an infinite rate at any velocity, so that "
            "the friction depends on how the edge is rounded; give the rounding: "
            "em.Profile with points along the edge, or em.PowerLaw with a large "
            "exponent",
        )
    if isinstance(shape, PowerLaw) and shape.exponent < 1:
        raise InputError(
            argument="exponent",
            got=float(shape.exponent),
            accepted="1 or more in sliding",
            hint="a body with an infinitely sharp tip has no steady sliding solution",
        )


def contact(material: Material, shape: Indenter) -> tuple[AbstractLines, Foundation]:
    """The lines of a sliding contact, and what they are made of. Raises `InputError`
    for a pair that does not fit.
    """
    hint_at_metres(shape)
    foundation = as_foundation(material)
    if not isinstance(shape, AbstractShape):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="an em.Sphere, em.Cone, em.Profile, em.Cylinder or the like",
        )
    check_edge(shape)
    if isinstance(shape, Cylinder):
        if foundation.per_area is False:
            raise InputError(
                argument="material",
                got=material,
                accepted="independent springs under a Cylinder here",
                hint="use em.springs(material, thickness); a cylinder on a half-space "
                "is no MDR problem",
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
