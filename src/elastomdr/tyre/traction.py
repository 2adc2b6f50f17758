"""Steady rolling with creepage: traction, stick and slip, and the rolling loss beside
it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import xp
from ..call.problem import Asked, SteadyScene, doubt_depth
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    as_float64,
    broadcast_shape,
    certain,
    finite,
    is_traced,
    known,
    nan_unless,
    numpy_unless_traced,
    only_one,
    positive,
    require,
    untraced,
    warn_unless,
)
from ..element.law import Foundation, as_foundation
from ..element.layer import Layer
from ..errors import InputError, amount
from ..material.prony import Prony
from ..material.relaxation import Relaxation
from ..material.shift import need_same_thermal, thermal_factors
from ..material.validity import material_in_words, shared
from ..results.base import Result
from ..results.doubts import Doubt, carried
from ..results.friction_law import FrictionLaw
from ..results.words import brief, describe
from ..smooth.cylinder import cylinder_pressure
from ..smooth.plan import Plan
from ..smooth.problem import (
    Contact,
    LayerPlan,
    SmoothCall,
    SmoothScene,
    Steady,
    check,
    solve,
)
from ..surface.lines import SingleLine
from ..surface.shapes import Cylinder
from ..transient.problem import Bound, both_laws, bound_on, check_shape, unknown
from ..trees import replaced
from .brush import (
    LayerContact,
    RollingContact,
    Tractions,
    carter,
    layer_traction,
    shear_compliance,
    tractions,
    typical_wave,
)
from .traction_result import Traction

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Material, Materials, ModelLike

# error of the traction over (1 + mu) F_N that no computation is without
_ROUNDING = 1e-14
# of the march, where elements stick again after they have slipped
_STEPS = (1024, 8192, 65536)
# what each point of a `RollingContact` has of its own
_OWN = ("velocity", "leading", "trailing", "friction", "creepage")
# Below the first what sticks is lost in rounding; above the second the error of the
# force no longer counts what slips.
_FRICTION = 1e-12, 1e12
# at what a friction law is asked, which nobody has typed
_MEANT = {
    "pressure": ("mean pressure of the contact", "Pa"),
    "velocity": ("velocity with which the body slides", "m/s"),
}
BRUSH = "MDR line of elements with Coulomb friction (brush); rolling loss: "
ON_LAYER = (
    "brush with the shear stiffness of the layer at one wave, pressure exact; rolling "
    "loss: "
)
VISCOELASTIC = unknown(
    "elements side by side, which on elastic rubber pull up to a third of mu less than "
    "a half-space under a ball, and 12 % of mu less than a layer under a cylinder"
)
ONE_VELOCITY = unknown("all elements have the friction of one sliding velocity")
ENDS = unknown("plane strain leaves out the ends of the cylinder")
CARTER = (
    "Carter's elastic half-plane (exact for equal bodies, or an incompressible one on "
    "a rigid one)"
)


# of the traction coefficient, without its sign, and the friction coefficient
_BoundAt = Callable[[Any, Any], Bound]


class _TractionScene(NamedTuple):
    """What is asked for; velocity and creepage are those of rolling."""

    shape: Any
    velocity: Any  # broadcast
    creepage: Any
    friction: Any  # Coulomb's coefficient, or a `FrictionLaw`
    load: Any
    depth: Any
    temperature: Any
    model: Any
    rtol: float

    @property
    def law(self) -> FrictionLaw | None:
        """The friction law, where there is one."""
        return self.friction if isinstance(self.friction, FrictionLaw) else None

    def friction_in(
        self,
        velocity: Array,
        temperature: Array | None,
        force: Array,
        contact: Contact,
        converged: Array | bool,
    ) -> tuple[Any, tuple[Doubt, ...]]:
        """Coulomb's coefficient of each contact, from the law where there is one, and
        its doubts there; without creepage at the law's lowest velocity, which decides
        nothing there.
        """
        law, shape = self.law, self.shape
        if law is None:
            return self.friction, ()
        given = {}
        if "temperature" in law.axes():
            if temperature is None:
                raise InputError(
                    argument="temperature",
                    accepted="given",
                    hint="the friction law depends on it",
                )
            given["temperature"] = temperature
        if law.pressure is not None:
            length = contact.leading + contact.trailing
            area = (
                length * shape.length
                if isinstance(shape, Cylinder)
                else xp.pi * (0.5 * length) ** 2
            )
            given["pressure"] = xp.where(converged, force / area, law.pressure[0])
        sliding = xp.prod(
            xp.stack(xp.broadcast_arrays(xp.abs(self.creepage), velocity)), axis=0
        )
        given["velocity"] = xp.where(sliding > 0, sliding, law.velocity[0])
        try:
            return law(**given), law.doubts_at(**given)
        except InputError as error:
            if error.argument not in _MEANT:
                raise
            meant, unit = _MEANT[error.argument]
            raise InputError(
                argument="friction",
                got=law,
                accepted=f"a law that covers the {meant}, "
                + amount(float(np.asarray(error.got)), unit, 4),
            ) from error

    def words(self, friction: Array) -> list[tuple[str, str]]:
        """Creepage and friction as inputs of the result."""
        words = brief(friction, "").strip()
        if self.law is not None:
            axes = ", ".join(self.law.axes())
            words += f", of a friction law at the body's sliding velocity ({axes})"
        creepage = brief(self.creepage, "").strip()
        return [("creepage", creepage), ("friction coefficient", words)]


@over_materials
@numpy_unless_traced
def traction(
    material: Materials,
    shape: Indenter,
    *,
    velocity: ArrayLike,
    creepage: ArrayLike | None = None,
    slip: ArrayLike | None = None,
    friction: ArrayLike | FrictionLaw,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    tangential: Foundation | None = None,
    model: ModelLike | None = None,
    rtol: float = 1e-6,
) -> Traction:
    """Tractive force of a body that rolls with a creepage, or brakes with a slip, and
    its rolling loss.

    Arguments broadcast. A wheel that brakes with the slip s on a road at V rolls at (1
    - s) V with the creepage s/(1 - s), so that it slides at s V; one that drives has a
    negative slip.

    Args:
        material: a material (then a half-space of it), a bonded `em.layer` under a
            cylinder, or a `Foundation` of E* (then give `tangential`).
        shape: the body that rolls, such as `em.Paraboloid` or `em.Cylinder`.
        velocity: rolling velocity [m/s]; with `slip` that of the road.
        creepage: velocity of slip of the rigid body over the rolling velocity [-]; its
            sign is the traction's.
        slip: in place of a creepage, velocity of slip over that of the road [-], below
            1.
        friction: Coulomb's coefficient, zero and infinity included; or an
            `em.FrictionLaw`, taken at the sliding velocity of the body, |creepage| v,
            at `temperature`, and at the mean pressure of the contact.
        load: normal force [N].
        depth: depth [m] in place of a load.
        temperature: temperature [K], for a material with a shift law or a friction law.
        tangential: the `Foundation` of G*; it follows from a material. Its shift law
            serves where `material` is elastic and has none, as under a tyre: the
            structure carries the load, and the tread is sheared.
        model: model of the rolling loss, as for `em.rolling`.
        rtol: relative error to be met, 1e-3 to 1e-10.

    Returns:
        An `em.Traction`. A point that failed is NaN with `converged=False`.

    Raises:
        InputError: for bodies that do not roll, for neither or both of creepage and
            slip, and for what `em.rolling` refuses.

    Exact for a row of springs (brush) and for a cylinder on an elastic half-space
    (Carter). On a half-space traction is that of the MDR line, which pulls less: on an
    elastic one its slope at small creepage is 1.70 to 1.95 times too low (nu = 0 to
    1/2, Kalker 1967), and it is up to a third of mu F_N below in between. A friction
    law
    taken at one sliding velocity leaves out that elements near the leading edge slide
    more slowly than the body, and those near the trailing edge faster.

    On an `em.layer`, in numbers only, the normal problem is exact and the tangential
    one a brush whose elements have the stiffness of the layer at one wave
    (`elastomdr.tyre.brush`): exact in a contact much wider than the layer is
    thick; on an elastic incompressible layer right for large creepage, up to 8 % of mu
    F_N below Carter's where the layer is thick, and up to 12 % where half the contact
    is two to four times as long as the layer is thick. `model_error` is a bound where
    the rubber is elastic, NaN else.

    Source: Popov & Hess 2015, ch. 5; Carter 1926; Kalker 1967.
    """
    check_shape(shape)
    if shape.rolling_radius is None:
        raise InputError(
            argument="shape",
            got=shape,
            accepted="one that rolls, an em.Sphere, em.Paraboloid or em.Cylinder",
        )
    velocity, creepage, slip, road = _kinematics(velocity, creepage, slip)
    friction = _checked_friction(friction)
    foundation: Any = (
        material if isinstance(material, Layer) else as_foundation(material)
    )
    points = broadcast_shape(
        {
            "velocity": velocity,
            "creepage": creepage,
            "friction": 0.0 if isinstance(friction, FrictionLaw) else friction,
        }
    )
    velocity = xp.broadcast_to(velocity, points)
    scene = _TractionScene(
        shape, velocity, creepage, friction, load, depth, temperature, model, rtol
    )
    if isinstance(foundation, Layer):
        curve = _on_layer(foundation, scene, tangential)
    elif isinstance(shape, Cylinder) and foundation.per_area is False:
        curve = _carter(foundation, scene)
    else:
        solid: Any = material  # `over_materials` has taken a list apart
        curve = _on_line(solid, scene, tangential)
    return curve if slip is None or road is None else _over_slip(curve, slip, road)


def _checked_friction(friction: ArrayLike | FrictionLaw) -> Any:
    """A friction law, or coefficients as an array. Raises `InputError`."""
    if isinstance(friction, FrictionLaw):
        return friction
    least, most = _FRICTION
    if isinstance(friction, Result):
        raise InputError(
            argument="friction",
            got=friction,
            accepted="a FrictionLaw, a number or an array of numbers",
            hint="`.law()` of a FrictionCurve is its law",
        )
    friction = as_float64("friction", friction)
    require(
        "friction",
        friction,
        f"zero or positive, {least:g} to {most:g}, infinity included",
        lambda x: (x == 0) | np.isinf(x) & (x > 0) | (x > least) & (x < most),
    )
    return friction


class _Kinematics(NamedTuple):
    velocity: Array  # of rolling
    creepage: Array
    # where it was given, and with it the velocity of the road
    slip: Array | None = None
    road: Array | None = None


def _kinematics(
    velocity: ArrayLike, creepage: ArrayLike | None, slip: ArrayLike | None
) -> _Kinematics:
    """The motion, by creepage or by slip. Raises `InputError`."""
    only_one({"creepage": creepage, "slip": slip})
    velocity = as_float64("velocity", velocity)
    if slip is None:
        creepage = as_float64("creepage", creepage)
        finite("creepage", creepage)
        return _Kinematics(velocity, creepage)
    slip = as_float64("slip", slip)
    accepted = (
        "finite and below 1, a part of the road's velocity (a locked wheel slides: "
        "em.friction)"
    )
    require("slip", slip, accepted, lambda s: np.isfinite(s) & (s < 1))
    positive("velocity", velocity)
    broadcast_shape({"velocity": velocity, "slip": slip})
    return _Kinematics((1 - slip) * velocity, slip / (1 - slip), slip, velocity)


def _over_slip(curve: Traction, slip: Array, road: Array) -> Traction:
    """The result with the slip that was asked for in place of the creepage."""
    rows = [pair for pair in curve.inputs if pair[0] != "creepage"]
    place = next(i for i, pair in enumerate(rows) if pair[0] == "velocity")
    words = (
        f"{brief(slip, '').strip()}; of the velocity V of the road, (V - v)/V, with v "
        "that of rolling"
    )
    rows[place : place + 1] = [
        ("velocity of the road", brief(road, "m/s")),
        ("slip", words),
    ]
    shape = np.shape(curve.force)
    slip, road = xp.broadcast_to(slip, shape), xp.broadcast_to(road, shape)
    return dataclasses.replace(curve, slip=slip, road=road, inputs=tuple(rows))


def _on_line(
    material: Material, scene: _TractionScene, tangential: Foundation | None
) -> Traction:
    """A body on the MDR line, or on springs. Raises `InputError`."""
    normal, sheared = _foundations(material, scene, tangential)
    # in numbers though JAX traces creepage or friction, which they do not depend on
    steady, solution = _pressed(normal, scene._replace(creepage=None, friction=None))
    friction, doubts = scene.friction_in(
        solution.velocity,
        steady.temperature,
        solution.normal_force,
        solution.contact,
        solution.converged,
    )
    pulled, missed = _solve(steady, solution, sheared, friction, scene)
    converged = solution.converged & ~xp.asarray(missed).reshape(steady.shape)
    warn_unless(converged, "tractions", known=~solution.converged)
    return _report(
        scene,
        solution,
        creepage=xp.broadcast_to(scene.creepage, steady.shape),
        friction=xp.broadcast_to(friction, steady.shape),
        doubts=doubts,
        pulled=pulled,
        converged=converged,
        bound=_of_line(normal, sheared, scene, tangential),
        temperature=steady.temperature,
        model=BRUSH + steady.plan.model,
        plan=steady.plan,
    )


@numpy_unless_traced
def _pressed(normal: Foundation, scene: _TractionScene) -> tuple[SmoothScene, Steady]:
    """The contact as it rolls freely."""
    asked = Asked(
        scene.velocity, scene.load, scene.depth, temperature=scene.temperature
    )
    call = SmoothCall("rolling", normal, scene.shape, asked, scene.model, scene.rtol)
    steady = check(call, softens=False)
    return steady, solve(steady)


def _foundations(
    material: Material, scene: _TractionScene, tangential: Foundation | None
) -> tuple[Foundation, Foundation]:
    """The normal and the tangential foundation. Raises `InputError`."""
    normal, sheared = both_laws(material, tangential)
    if scene.temperature is not None:
        normal = _shifted(normal, sheared)
    normal = replaced(normal, range=shared(normal.range, sheared.range))
    if normal.per_area and not isinstance(scene.shape, Cylinder):
        raise InputError(
            argument="material",
            got=normal,
            accepted=f"a half-space under a {scene.shape.label}",
            hint="a layer is for an em.Cylinder",
        )
    return normal, sheared


def _solve(
    steady: SmoothScene,
    solution: Steady,
    sheared: Foundation,
    friction: Array,
    scene: _TractionScene,
) -> tuple[Tractions, Any]:
    """Tractions to the tolerance, in the shape of the result, and at which of the
    flattened points it was missed.
    """

    def flat(field: Array) -> Any:
        return xp.broadcast_to(field, steady.shape).reshape(-1)

    assert isinstance(steady.lines, SingleLine)
    rolling = RollingContact(
        steady.law,
        sheared.law(),
        steady.lines,
        steady.reduced,
        flat(solution.contact.leading),
        flat(solution.contact.trailing),
        flat(friction),
        abs(flat(scene.creepage)),
    )
    rules = steady.plan.rules
    rule = rules[0] if steady.plan.traced else rules[-1]
    # Without creepage nothing pulls, and no error is small against that.
    rounding = 1 + xp.where(xp.isfinite(rolling.friction), rolling.friction, 0)
    rounding = _ROUNDING * rounding * flat(solution.normal_force) / steady.vertical

    def missed_in(pulled: Tractions) -> Any:
        return ~(pulled.error <= scene.rtol * pulled.force + rounding)

    def finer(pulled: Tractions, again: Array, steps: int) -> Tractions:
        """The tractions with those of some points found anew."""
        points = rolling._replace(
            **{name: getattr(rolling, name)[again] for name in _OWN}
        )
        refined = known(tractions(points, rule, steps))
        merged = [np.array(each) for each in pulled]
        for whole, new in zip(merged, refined, strict=True):
            whole[again] = new
        return Tractions(*merged)

    # Where errors cannot be looked at, the number of steps that is nearly always
    # enough.
    traced = is_traced(rolling)
    first = _STEPS[1] if traced else _STEPS[0]
    pulled = known(tractions(rolling, rule, first))
    for steps in _STEPS[1:]:
        missed = missed_in(pulled)
        if traced:
            break
        again = missed & np.isfinite(pulled.force)
        if not again.any():
            break
        pulled = finer(pulled, again, steps)
    missed = missed_in(pulled)
    pulled = pulled._replace(
        force=pulled.force * steady.vertical, error=pulled.error * steady.vertical
    )
    return Tractions(*(xp.asarray(x).reshape(steady.shape) for x in pulled)), missed


def _of_line(
    normal: Foundation,
    sheared: Foundation,
    scene: _TractionScene,
    tangential: Foundation | None,
) -> _BoundAt:
    """Of a row of elements: exact where it was asked for as such, under one friction
    coefficient.
    """
    if scene.law is not None:
        return lambda *_: ONE_VELOCITY
    elastic = _is_elastic(normal.law()) and _is_elastic(sheared.law())
    if normal.per_area is False and elastic and tangential is None:
        return _of_a_ball
    return lambda *_: bound_on(normal, scene.shape, VISCOELASTIC)


def _of_a_ball(coefficient: Array, friction: Array) -> Bound:
    """Of the brush on an elastic half-space: three dimensions pull more, at small
    creepage 1.70 to 1.95 times as much (Kalker's C_11 for nu from 0 to 1/2), and at
    most mu. `benchmarks/traction_map.py`.
    """
    size = xp.minimum(0.96 * coefficient, friction - coefficient)
    return Bound(xp.maximum(size, 0.0))


def _of_a_strip(coefficient: Array, friction: Array) -> Bound:
    """Of the brush on an elastic incompressible layer, in plane strain; drawn and
    covered by `benchmarks/traction_map.py`.
    """
    most = xp.minimum(0.12 * friction, 1.03 * friction - coefficient)
    return Bound(xp.minimum(most, 0.25 * coefficient))


def _on_strip(layer: Layer, law: Relaxation, scene: _TractionScene) -> _BoundAt:
    """Of the brush on a layer."""
    if scene.law is not None:
        return lambda *_: ONE_VELOCITY
    if _is_elastic(law) and float(layer.squeeze()) == 0:
        return _of_a_strip
    return lambda *_: VISCOELASTIC


def _is_elastic(law: Relaxation) -> bool:
    """Whether a law is known to be elastic."""
    return not law.moduli.size and certain(lambda x: x == 0, law.viscosity)


def _report(
    scene: _TractionScene,
    solution: Steady,
    *,
    creepage: Array,
    friction: Array,
    doubts: tuple[Doubt, ...],
    pulled: Tractions,
    converged: Array,
    bound: _BoundAt,
    temperature: Array | None,
    model: str,
    plan: Plan | LayerPlan,
) -> Traction:
    """The result of a brush: `pulled` has force, stick and error without signs,
    `doubts` are those of a friction law.
    """
    force = nan_unless(converged, xp.sign(creepage) * pulled.force)
    inputs = list(solution.inputs)
    place = [name for name, _ in inputs].index("relative tolerance")
    inputs[place:place] = scene.words(friction)
    coefficient = force / solution.normal_force
    limit = bound(abs(coefficient), friction)
    doubts = (*solution.marks, *doubts, *limit.marks(converged))
    return Traction(
        velocity=solution.velocity,
        creepage=creepage,
        friction=friction,
        coefficient=coefficient,
        force=force,
        stick=nan_unless(converged, pulled.stick),
        slip_power=abs(force * creepage) * solution.velocity,
        rolling=solution.mu,
        normal_force=solution.normal_force,
        depth=solution.depth,
        contact=solution.contact,
        error=nan_unless(converged, pulled.error / solution.normal_force),
        model_error=limit.at(converged),
        converged=converged,
        marks=_at_points(doubts, force.shape),
        inputs=tuple(inputs),
        temperature=temperature,
        model=model,
        plan=plan,
    )


def _at_points(doubts: tuple[Doubt, ...], shape: tuple[int, ...]) -> tuple[Doubt, ...]:
    """The doubts of rubber and friction law at the points of the result."""
    return carried(doubts, lambda points: xp.broadcast_to(points, shape))


def _shifted(normal: Foundation, sheared: Foundation) -> Foundation:
    """`normal` with the shift law of `sheared`, where it is elastic and has none of its
    own: a_T changes nothing in it.

    Raises `InputError` for laws that differ, since one a_T scales the velocity of both,
    and one b_T their moduli.
    """
    law = normal.law()
    if _is_elastic(law) and sheared.shift is not None:
        normal = replaced(normal, shift=sheared.shift)
    if sheared.shift is not None or sheared.vertical is not None:
        need_same_thermal("tangential", sheared, normal)
    return normal


def _on_layer(
    layer: Layer, scene: _TractionScene, tangential: Foundation | None
) -> Traction:
    """A cylinder on a bonded layer. Raises `InputError`."""
    law = _checked_layer(layer, scene, tangential)
    asked = Asked(
        scene.velocity, scene.load, scene.depth, temperature=scene.temperature
    )
    rolled, points, contacts = cylinder_pressure(
        SmoothCall("rolling", layer, scene.shape, asked, scene.model, scene.rtol)
    )
    solution, half = rolled.steady, np.asarray(contacts.half)
    friction, doubts = scene.friction_in(
        solution.velocity,
        rolled.temperature,
        solution.normal_force,
        solution.contact,
        solution.converged,
    )
    friction, creepage = (
        np.broadcast_to(x, points.shape) for x in (friction, scene.creepage)
    )
    softness = shear_compliance(
        typical_wave(half),
        float(layer.thickness),
        float(1 - layer.squeeze()) / 2,
    )
    sheared = LayerContact(
        law=law,
        stiffness=1 / softness,
        velocity=np.asarray(points.reduced).reshape(-1),
        half_length=half,
        terms=np.asarray(contacts.terms),
        friction=friction.reshape(-1),
        creepage=np.abs(creepage).reshape(-1),
    )
    return _report(
        scene,
        solution,
        creepage=creepage,
        friction=friction,
        doubts=doubts,
        pulled=_pulled(sheared, float(scene.shape.length), points),
        converged=solution.converged,
        bound=_on_strip(layer, law, scene),
        temperature=rolled.temperature,
        model=ON_LAYER + rolled.plan.model,
        plan=rolled.plan,
    )


def _pulled(contact: LayerContact, length: float, points: SteadyScene) -> Tractions:
    """The traction of a cylinder of this length, in the shape of the call."""
    pulled = layer_traction(contact)
    per_length = length * np.asarray(points.vertical).reshape(-1)
    return pulled._replace(
        force=(pulled.force * per_length).reshape(points.shape),
        stick=pulled.stick.reshape(points.shape),
        error=(pulled.error * per_length).reshape(points.shape),
    )


def _checked_layer(
    layer: Layer, scene: _TractionScene, tangential: Foundation | None
) -> Relaxation:
    """G(t) of the layer. Raises `InputError` for other bodies and what is not known of
    the shear.
    """
    shape, solid = scene.shape, layer.material
    if not isinstance(shape, Cylinder):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="an em.Cylinder for traction on an em.layer",
        )
    if tangential is not None:
        raise InputError(
            argument="tangential",
            got=tangential,
            accepted="left out with an em.layer",
            hint="it knows its own shear stiffness",
        )
    untraced(
        InputError(
            argument="material",
            accepted="em.springs or a half-space under jit, grad and vmap, not an "
            "em.layer",
        ),
        layer,
        *scene[:-2],
    )
    only_one({"load": scene.load, "depth": scene.depth})
    single = layer.other is None and layer.bonded and layer.constant
    if not single or not isinstance(solid, Prony):
        raise InputError(
            argument="material",
            got=layer,
            accepted="one em.layer for traction, bonded to its base, of an em.Prony "
            "with a constant Poisson's ratio",
        )
    sheared = solid.shear().law()
    if float(sheared.viscosity) > 0:
        raise InputError(
            argument="material",
            got=solid,
            accepted="one without a parallel dashpot for traction on an em.layer",
        )
    return sheared


def _carter(foundation: Foundation, scene: _TractionScene) -> Traction:
    """A cylinder on an elastic half-space. Raises `InputError`."""
    load, modulus = _checked_half_plane(foundation, scene)
    shape: Any = scene.shape
    half = carter(modulus, shape.radius, load / shape.length, 1.0, 0.0)[2]
    friction, doubts = scene.friction_in(
        scene.velocity, scene.temperature, load, Contact(half, half), True
    )
    accepted = "finite for a cylinder on a half-space (without slip Carter's traction diverges)"
    converged = ~xp.isnan(friction)  # NaN where the friction law is not known
    require(
        "friction", xp.where(converged, friction, 0), accepted, lambda x: ~np.isinf(x)
    )
    velocity, creepage, friction, load, modulus = xp.broadcast_arrays(
        *map(xp.asarray, (scene.velocity, scene.creepage, friction, load, modulus))
    )
    ratio, stick, half = carter(
        modulus, shape.radius, load / shape.length, friction, abs(creepage)
    )
    zero = xp.zeros_like(ratio)
    force = xp.sign(creepage) * ratio * load
    deep = doubt_depth(foundation, shape, shape._profile(half))
    return Traction(
        velocity=velocity,
        creepage=creepage,
        friction=friction,
        coefficient=force / load,
        force=force,
        stick=stick,
        slip_power=abs(force * creepage) * velocity,
        rolling=zero,
        normal_force=load,
        depth=zero + xp.nan,
        contact=Contact(half, half),
        error=zero,
        model_error=ENDS.at(zero == 0),
        converged=xp.broadcast_to(converged, ratio.shape),
        marks=_at_points((*doubts, *ENDS.marks(zero == 0), *deep), ratio.shape),
        temperature=None,
        model=CARTER,
        plan="closed form",
        inputs=(
            *material_in_words(foundation),
            ("shape", describe(shape)),
            ("load", brief(load, "N")),
            ("velocity", brief(velocity, "m/s")),
            *scene._replace(creepage=creepage).words(friction),
        ),
    )


def _checked_half_plane(
    foundation: Foundation, scene: _TractionScene
) -> tuple[Any, Any]:
    """Load [N] and E* [Pa] at the temperature. Raises `InputError`."""
    law = foundation.law()
    vertical = foundation.vertical
    temperature = scene.temperature
    if scene.load is None or scene.depth is not None:
        raise InputError(
            argument="load",
            got=scene.load,
            accepted="given without depth for a cylinder on a half-space",
            hint="its depth is not defined (plane strain)",
        )
    if law.moduli.size or certain(lambda x: x > 0, law.viscosity):
        raise InputError(
            argument="material",
            got=foundation,
            accepted="an em.layer, or elastic for a cylinder on a half-space (Carter's "
            "problem)",
            hint="em.layer(material, thickness) rolls with the losses of its rubber",
        )
    load = as_float64("load", scene.load)
    positive("load", load)
    matters = scene.law is not None and scene.law.temperature is not None
    if temperature is not None and vertical is None and not matters:
        raise InputError(
            argument="temperature",
            got=temperature,
            accepted="left out for an elastic half-plane, on which it has no effect",
        )
    modulus = law.equilibrium
    if temperature is not None and vertical is not None:
        temperature = as_float64("temperature", temperature)
        modulus = modulus * thermal_factors(foundation, temperature)[1]
    return load, modulus
