"""Impact of a rigid body on a viscoelastic half-space or layer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..call.extrapolation import told
from ..call.problem import check_rtol, doubt_depth, hint_at_metres
from ..checks import (
    as_float64,
    broadcast_shape,
    nan_unless,
    numbers_only,
    numpy_unless_traced,
    positive,
    warn_unless,
)
from ..element.law import Foundation, as_foundation
from ..element.layer import Layer
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..material.shift import thermal_factors
from ..material.validity import material_in_words
from ..results.base import Array, Origin, Result, distinct, quantity, record
from ..results.doubts import Doubt
from ..results.words import brief, describe, span
from ..surface.shapes import AbstractShape
from .impact_motion import Impacts, Striker, impacts
from .layer_disc import incompressible_enough, of_layer
from .oblique_impact import Oblique, ObliqueHistory, Slips, check_oblique, solve_oblique
from .problem import (
    Bound,
    bound_on,
    check_shape,
    standing,
)

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials

# numbers of branches that are filled up to, so that few are compiled
_WIDTHS = (1, 3, 7, 11, 15, 23, 31, 47, 63)
# Contact times over relaxation times between which branches are neither followed by the
# steps nor dashpots to them: there the error does not fall as a series in n^-2.
_SHORT, _DASHPOT = 100.0, 1e6
# frequency times duration of the passage that `material/validity.py` speaks of
_PASSAGE = 4.0
HALF_SPACE = (
    "MDR, exact for the half-space: approach and rebound (Ting's solution), "
    "quasi-static rubber, no adhesion"
)
LAYER = (
    "independent springs, exact for them (rubber of that thickness: em.layer); "
    "quasi-static rubber, no adhesion"
)
FINITE = (
    "rubber of finite thickness on a rigid base, exact: approach and rebound; "
    "quasi-static rubber, no adhesion"
)


@record
class Impact(Result):
    """Impact of a rigid body.

    `restitution` is the velocity of separation over that of touch, `error` its
    estimated, absolute error. `stuck` marks a body that never comes back: restitution
    0, infinite duration, and a history that ends with the rest. A point that did not
    converge is NaN with `converged=False`.
    """

    mass: Array = quantity("mass", "kg", "m")
    velocity: Array = quantity("velocity at touch", "m/s", "v0")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    restitution: Array = quantity(
        "coefficient of restitution", "-", "velocity of separation over that of touch"
    )
    duration: Array = quantity("contact time", "s", "from touch to separation")
    max_depth: Array = quantity("largest depth", "m", "at the turn")
    max_force: Array = quantity("largest force", "N", "before or at the turn")
    lost: Array = quantity("normal kinetic energy lost", "J")
    history: ObliqueHistory
    oblique: Oblique | None = None  # where a tangential velocity was given
    error: Array = quantity("estimated error of the restitution", "-", "absolute")
    model_error: Array = quantity(
        "bound on the error of the model", "-", "of the restitution; NaN: not known"
    )
    stuck: Array = quantity("stuck", "", "the body never comes back")

    title: ClassVar[str] = "Impact"
    shows: ClassVar[str] = "restitution"
    scale: ClassVar[str] = "auto"
    error_of: ClassVar[str] = "the restitution"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity",
        "mass",
        "before",
        "temperature",
    )

    def _figure(self) -> str:
        """Force against time for one impact, restitution against velocity for many."""
        return (
            "plot_contacts.draw_impact"
            if np.size(self.velocity) == max(1, len(self.origins))
            else "plotting.draw"
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The range of what came out."""
        for name, field, unit in (
            ("restitution", self.restitution, ""),
            ("contact time", self.duration, "s"),
            ("largest depth", self.max_depth, "m"),
            ("largest force", self.max_force, "N"),
        ):
            yield name, span(field, unit)

    def reached(self, also: str = "") -> str:
        """As of every result, with how many bodies stuck."""
        stuck = int(np.sum(self.stuck))
        return super().reached(
            also + (f", {stuck} stuck (restitution 0)" if stuck else "")
        )


@numpy_unless_traced
def impact(
    material: Materials,
    shape: Indenter,
    *,
    mass: ArrayLike,
    velocity: ArrayLike,
    temperature: ArrayLike | None = None,
    tangential_velocity: ArrayLike | None = None,
    friction: ArrayLike | None = None,
    inertia: ArrayLike | None = None,
    tangential: Foundation | None = None,
    rtol: float = 1e-6,
) -> Impact:
    """Impact of a rigid body that touches at `velocity`, until it leaves: m d'' =
    -F(history of d).

    F is the force of the viscoelastic foundation; gravity and adhesion are left out.
    `mass`, `velocity` and `temperature` broadcast.

    Args:
        material: a material (then a half-space of it), a `Foundation`, or a list of
            either: the result then has one more axis, in front, for them.
        shape: the body, such as `em.Sphere`.
        mass: mass [kg].
        velocity: velocity at touch [m/s].
        temperature: temperature [K], for a material with a shift law.
        tangential_velocity: for an oblique impact, velocity of the point of contact at
            touch [m/s], spin included.
        friction: Coulomb's coefficient of an oblique impact, zero and infinity
            included.
        inertia: moment of inertia about the centre [kg m^2]; by default that of a
            homogeneous ball or cylinder, and infinite for a body that does not roll.
        tangential: the `Foundation` of G* of an oblique impact, needed where `material`
            is a `Foundation`.
        rtol: relative error of restitution and depth to be met, 1e-2 to 1e-10.

    Returns:
        An `em.Impact`; of an oblique one `oblique` has the velocity of the point of
        contact afterwards, with its error. A body that never comes back (a liquid too
        viscous for it) has restitution 0, an infinite duration and `stuck=True`. A
        point whose restitution or depth misses `rtol` is NaN with `converged=False`; a
        duration that misses 100 `rtol` (restitution below 1e-4) is NaN alone.

    Raises:
        InputError: for a mass or velocity that is not positive, a cylinder on a
            half-space, a temperature without a shift law, and under a transformation of
            JAX.

    Exact for the half-space and every shape whose contact grows as a disc; the rubber's
    own inertia (waves) is left out. Oblique impacts are of second order in the step.
    Without derivatives: under `jit`, `grad` and `vmap` it is refused.

    Source: Popov & Hess 2015, ch. 7; Ting 1966 for the rebound.
    """
    numbers_only(
        {
            "material": material,
            "shape": shape,
            "mass": mass,
            "velocity": velocity,
            "temperature": temperature,
            "tangential_velocity": tangential_velocity,
            "friction": friction,
            "inertia": inertia,
            "tangential": tangential,
        },
    )
    slips = check_oblique(material, tangential_velocity, friction, inertia, tangential)
    extra = {}
    if slips is not None:
        extra = {"tangential_velocity": slips.velocity, "friction": slips.friction}
    scene = _check(material, shape, mass, velocity, temperature, rtol, extra)
    solution = impacts(scene.body, per_area=scene.per_area, rtol=float(rtol))
    good, reason = solution.converged, _why_not(scene.body, solution)
    if isinstance(material, Layer):
        good, deep = _within_layer(material, scene.body.shape, solution)
        reason = deep or reason
    warn_unless(good, "impacts", f" to rtol={rtol:g}", reason)
    return _report(scene, shape, slips, solution, good)


def _report(
    scene: _ImpactScene,
    shape: AbstractShape,
    slips: Slips | None,
    solution: Impacts,
    good: Array,
) -> Impact:
    """The result, NaN where an impact is not `good`."""
    motion = solution.motion

    def shaped(field: Array) -> Any:
        return nan_unless(good, field).reshape(scene.shape)

    def series(field: Array) -> Any:
        return nan_unless(good, field).T.reshape((*scene.shape, -1))

    converged = good.reshape(scene.shape)
    duration = shaped(nan_unless(solution.timed, motion.duration))
    beyond = _judge(scene, duration)
    history = ObliqueHistory(
        series(motion.time),
        series(motion.depth),
        series(motion.speed),
        series(motion.force),
    )
    oblique = None
    if slips is not None:
        oblique = solve_oblique(slips, scene, shape, history, solution)
    bounds = (bound_on(f, shape, Bound()) for f in scene.foundations)
    bound = next((one for one in bounds if one.why), Bound())
    max_depth = shaped(motion.max_depth)
    deep = doubt_depth(scene.foundations[0], shape, max_depth)
    energy = 0.5 * scene.body.mass * scene.body.velocity**2
    return Impact(
        mass=scene.mass,
        velocity=scene.velocity,
        restitution=shaped(motion.restitution),
        duration=duration,
        max_depth=max_depth,
        max_force=shaped(motion.max_force),
        lost=shaped(energy * (1 - motion.restitution**2)),
        history=history,
        oblique=oblique,
        error=nan_unless(good, solution.error).reshape(scene.shape),
        model_error=bound.at(converged),
        stuck=solution.stuck.reshape(scene.shape),
        converged=converged,
        temperature=scene.temperature,
        model=scene.model,
        plan="velocities as the grid, extrapolated in the number of steps",
        inputs=scene.inputs,
        marks=(*beyond, *bound.marks(converged), *deep),
        origins=_origins(scene) if scene.many else (),
    )


def _why_not(body: Striker, solution: Impacts) -> str:
    """What impacts reach that do not converge, and which branches keep them from more;
    empty where nothing is known.
    """
    missed = ~solution.converged & np.isfinite(solution.reached)
    if not missed.any():
        return ""
    reached = float(np.max(solution.reached[missed]))
    words = f"They reach {1.05 * reached:.1e}, which rtol may be raised to."
    rates = np.broadcast_to(body.rates, (len(body.rates), missed.size))[:, missed]
    per_contact = rates * np.asarray(solution.motion.duration)[missed]
    short = rates[(per_contact > _SHORT) & (per_contact < _DASHPOT)]
    if short.size:
        words += (
            f" Branches far shorter than the contact, such as {1 / short.min():.2g} s, "
            "hold steps back: those that matter little may be left out."
        )
    return words


def _within_layer(
    material: Layer, disc: Any, solution: Impacts
) -> tuple[np.ndarray, str]:
    """Which impacts are solved and less deep than the layer is thick, and why others
    are not. Raises `InputError` for rubber that is not incompressible enough.
    """
    motion = solution.motion
    good = solution.converged & (motion.max_depth < disc.thickness)
    radius = np.asarray(disc.radius_of_depth(motion.max_depth))
    incompressible_enough(material, disc, radius, motion.max_force)
    if not (solution.converged & ~good).any():
        return good, ""
    h = float(disc.thickness)
    return good, f"The body would go deeper than the layer is thick, {h:.4g} m."


def _origins(scene: "_ImpactScene") -> tuple[Origin, ...]:
    """The materials along the first axis."""
    names = distinct(
        [f.name or f"material {i}" for i, f in enumerate(scene.foundations, 1)]
    )
    rest = [pair for pair in scene.inputs if pair[0] != "material"]
    return tuple(
        Origin(
            name,
            scene.model,
            (("material", name), *rest),
            frozenset({"extrapolated"} if foundation.range is None else ()),
            None,
        )
        for name, foundation in zip(names, scene.foundations, strict=True)
    )


class _ImpactScene(NamedTuple):
    body: Striker
    per_area: bool
    model: str
    mass: Any  # broadcast
    velocity: Any
    temperature: Any
    shape: tuple[int, ...]
    inputs: tuple[tuple[str, str], ...]
    foundations: list[Foundation]  # one, or one for each place of the first axis
    many: bool  # whether a list of materials was given


def _check(
    material: Any,
    shape: AbstractShape,
    mass: ArrayLike,
    velocity: ArrayLike,
    temperature: ArrayLike | None,
    rtol: float,
    extra: dict[str, Any],
) -> _ImpactScene:
    """Everything checked and broadcast; `extra` are arguments of an oblique impact that
    broadcast too. Raises `InputError`.
    """
    many = isinstance(material, Sequence) and not isinstance(material, str)
    struck, foundations, per_area, model = _struck(material, shape, many, bool(extra))
    check_rtol(rtol, "1e-10", "1e-2")
    mass, velocity = as_float64("mass", mass), as_float64("velocity", velocity)
    positive("mass", mass)
    positive("velocity", velocity)
    temperature = (
        None if temperature is None else as_float64("temperature", temperature)
    )
    points = broadcast_shape(
        {"mass": mass, "velocity": velocity, "temperature": temperature, **extra}
    )
    result = (len(foundations), *points) if many else points
    columns = _columns(foundations, temperature, points, many)

    def full(array: Array) -> Any:
        return np.broadcast_to(array, result)

    names = ", ".join(dict.fromkeys(f.name or "given directly" for f in foundations))
    inputs = [
        ("material", names),
        *dict.fromkeys(pair for f in foundations for pair in material_in_words(f)[1:]),
        ("shape", describe(shape)),
        ("mass", brief(mass, "kg")),
        ("velocity", brief(velocity, "m/s")),
    ]
    if temperature is not None:
        inputs.append(("temperature", brief(temperature, "K")))
    inputs.append(("relative tolerance", f"{rtol:g}"))
    flat = (full(mass).reshape(-1), full(velocity).reshape(-1))
    return _ImpactScene(
        body=Striker(struck, *columns, *flat),
        per_area=per_area,
        model=model,
        mass=full(mass),
        velocity=full(velocity),
        temperature=None if temperature is None else full(temperature),
        shape=result,
        inputs=tuple(inputs),
        foundations=foundations,
        many=many,
    )


class _Struck(NamedTuple):
    """What is struck."""

    body: Any  # over its elements
    foundations: list[Foundation]
    per_area: bool
    model: str


def _struck(material: Any, shape: AbstractShape, many: bool, oblique: bool) -> _Struck:
    """What there is to strike. Raises `InputError`."""
    if many and not material:
        raise InputError(
            argument="material", got=material, accepted="a material or a list of them"
        )
    check_shape(shape)
    hint_at_metres(shape)
    if isinstance(material, Layer):
        if oblique:
            raise InputError(
                argument="tangential_velocity",
                accepted="left out on an em.layer",
                hint="only its normal impact is known",
            )
        struck, foundation = of_layer(material, shape)
        return _Struck(struck, [foundation], False, FINITE)
    if many and any(isinstance(m, Layer) for m in material):
        raise InputError(
            argument="material",
            accepted="one em.layer in an impact, no list with one",
        )
    foundations = [as_foundation(m) for m in (material if many else [material])]
    per_area = standing(foundations, material, shape)
    model = LAYER if per_area else HALF_SPACE
    return _Struck(shape, foundations, per_area, model)


def _columns(
    foundations: list[Foundation],
    temperature: ArrayLike | None,
    points: tuple[int, ...],
    many: bool,
) -> tuple[Any, Any, Any]:
    """(rates, moduli, viscosity) of all laws, a column for each point, or one for all."""
    laws = [_law_at(foundation, temperature, points) for foundation in foundations]
    most = max(law.moduli.shape[0] for law in laws)
    width = next((n for n in _WIDTHS if n >= most), most)
    padded = [_branches(law, width) for law in laws]
    rates, moduli, viscosity = (
        np.concatenate(parts, axis=-1) for parts in zip(*padded, strict=True)
    )
    # one column per material: one per point
    repeats = 1
    if many and rates.shape[-1] == len(foundations):
        repeats = int(np.prod(points))
    rates, moduli, viscosity = (
        np.repeat(x, repeats, axis=-1) for x in (rates, moduli, viscosity)
    )
    return rates, moduli, viscosity


def _judge(scene: _ImpactScene, duration: np.ndarray) -> tuple[Doubt, ...]:
    """An impact counts as a passage as long as its contact."""
    if all(foundation.range is None for foundation in scene.foundations):
        return ()
    points = np.zeros(
        (len(scene.foundations), duration.size // len(scene.foundations)), bool
    )
    findings = []
    illustrative = True
    temperatures = (
        None
        if scene.temperature is None
        else np.reshape(scene.temperature, points.shape)
    )
    for i, (foundation, times) in enumerate(
        zip(scene.foundations, duration.reshape(points.shape), strict=True)
    ):
        known = foundation.range
        temperature = None if temperatures is None else temperatures[i]
        if known is None:
            continue
        rate = _PASSAGE * thermal_factors(foundation, temperature)[0] / times
        points[i] = known.outside(rate, temperature)
        if points[i].any():
            findings += known.findings(
                rate,
                temperature,
                "the contact time means frequencies (a_T/t to 4 a_T/t)",
            )
            illustrative &= known.illustrative
    ranges = [each.range for each in scene.foundations if each.range is not None]
    of_range = ranges[0]._replace(illustrative=illustrative, illustrative_moduli=False)
    every = told(
        of_range, points.reshape(scene.shape), "; ".join(dict.fromkeys(findings))
    )
    assumed = np.zeros(points.shape, bool)
    for i, foundation in enumerate(scene.foundations):
        known = foundation.range
        assumed[i] = known is not None and known.illustrative_moduli
    return *every, Doubt("illustrative", assumed.reshape(scene.shape))


def _law_at(
    foundation: Foundation, temperature: ArrayLike | None, points: tuple[int, ...]
) -> Relaxation:
    """The law, with one column per point where a temperature gives each its own times
    and moduli.
    """
    law = foundation.law()
    if temperature is None:
        return law
    a, b = (
        np.broadcast_to(np.asarray(x), points).reshape(-1)
        for x in thermal_factors(foundation, temperature)
    )
    return Relaxation(
        law.equilibrium * b,
        law.moduli[:, None] * b,
        law.times[:, None] * a,
        law.viscosity * a * b,
    )


def _branches(law: Relaxation, width: int) -> tuple[Any, Any, Any]:
    """(rates, moduli, viscosity), the spring as a branch with rate zero, `width` more
    branches, equal columns.
    """
    times = law.times if law.times.ndim == 2 else law.times[:, None]
    columns = times.shape[-1]
    viscosity = np.broadcast_to(law.viscosity, (columns,))
    filled = np.zeros((width - law.moduli.shape[0], columns))
    branch_moduli = np.broadcast_to(
        law.moduli if law.moduli.ndim == 2 else law.moduli[:, None], times.shape
    )
    moduli = np.concatenate(
        [np.broadcast_to(law.equilibrium, (1, columns)), branch_moduli, filled]
    )
    return (
        np.concatenate([np.zeros((1, columns)), 1 / times, filled]),
        moduli,
        viscosity,
    )
