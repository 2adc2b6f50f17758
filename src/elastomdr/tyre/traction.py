"""Steady rolling with creepage: traction, stick and slip, and the rolling loss beside
it.
"""

from __future__ import annotations

import dataclasses
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import xp
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    as_float64,
    broadcast_shape,
    finite,
    is_traced,
    known,
    nan_unless,
    numpy_unless_traced,
    only_one,
    positive,
    require,
)
from ..element.law import Foundation, as_foundation
from ..element.layer import Layer
from ..errors import ConvergenceWarning, InputError
from ..material.prony import Prony
from ..material.shift import same_thermal, thermal_factors
from ..material.validity import shared
from ..results.friction_law import FrictionLaw
from ..results.words import brief, describe
from ..smooth.cylinder import cylinder_pressure
from ..smooth.problem import Contact, set_up, solve
from ..surface.lines import SingleLine
from ..surface.shapes import AbstractShape, Cylinder
from ..transient.tangential_law import both_laws
from ..trees import replaced
from .brush import Rolling, carter, tractions
from .brush_layer import pull, shear_compliance, typical_wave
from .traction_result import Traction

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials, ModelLike

# error of the traction over (1 + mu) F_N that no computation is without
_ROUNDING = 1e-14
# of the march, where elements stick again after they have slipped
_STEPS = (1024, 8192, 65536)
# less is lost in the rounding of what sticks, more is in no error of the force
_FRICTION = 1e-12, 1e12
BRUSH = "MDR line of elements with Coulomb friction (brush); rolling loss: "
ON_LAYER = (
    "brush with the shear stiffness of the layer at one wave, pressure exact; rolling "
    "loss: "
)
CARTER = (
    "Carter's elastic half-plane (exact for equal bodies, or an incompressible one on "
    "a rigid one)"
)


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
    (Carter). On a half-space traction is that of the MDR line, whose initial slope is
    higher, by 10 % for an elastic sphere with nu = 0.25 (Kalker 1967). A friction law
    taken at one sliding velocity leaves out that elements near the leading edge slide
    more slowly than the body, and those near the trailing edge faster.

    On an `em.layer`, in numbers only, the normal problem is exact and the tangential
    one a brush whose elements have the stiffness of the layer at one wave
    (`elastomdr.tyre.brush_layer`): exact in a contact much wider than the layer is
    thick; on a thick elastic layer right for small and large creepage, and up to 8 % of
    mu F_N below Carter's in between.

    Source: Popov & Hess 2015, ch. 5; Carter 1926.
    """
    if isinstance(shape, AbstractShape) and shape.rolling_radius is None:
        raise InputError(
            "shape must roll (em.Sphere, em.Paraboloid or em.Cylinder), got a "
            f"{shape.label}."
        )
    law = friction if isinstance(friction, FrictionLaw) else None
    velocity, creepage, slip, road = _kinematics(velocity, creepage, slip)
    friction = 0.0 if law is not None else as_float64("friction", friction)
    accepted = (
        f"zero or positive, {_FRICTION[0]:g} to {_FRICTION[1]:g}, infinity included"
    )
    require(
        "friction",
        friction,
        accepted,
        lambda x: (
            (x == 0) | np.isinf(x) & (x > 0) | (x > _FRICTION[0]) & (x < _FRICTION[1])
        ),
    )
    foundation: Any = (
        material if isinstance(material, Layer) else as_foundation(material)
    )
    points = broadcast_shape(velocity=velocity, creepage=creepage, friction=friction)
    velocity = xp.broadcast_to(velocity, points)
    if isinstance(foundation, Layer):
        rubbing = friction if law is None else law
        found = _on_layer(
            foundation,
            shape,
            velocity,
            creepage,
            rubbing,
            load,
            depth,
            temperature,
            tangential,
            model,
            rtol,
        )
        return _braked(found, slip, road)
    if isinstance(shape, Cylinder) and foundation.per_area is False:
        found = _carter(
            foundation,
            shape,
            velocity,
            creepage,
            friction if law is None else law,
            load,
            depth,
            temperature,
        )
        return _braked(found, slip, road)
    normal, sheared = both_laws(material, tangential)
    if temperature is not None:
        normal = _shifted(normal, sheared)
    normal = replaced(normal, range=shared(normal.range, sheared.range))
    if normal.per_area and not isinstance(shape, Cylinder):
        raise InputError(
            "material must be a half-space under a body of revolution, or a layer "
            "under a Cylinder, got a layer under "
            f"a {shape.label}."
        )
    scene = set_up(
        "rolling",
        normal,
        shape,
        velocity=velocity,
        load=load,
        depth=depth,
        pressure=None,
        temperature=temperature,
        model=model,
        rtol=rtol,
        skip=True,
        softens=False,
    )
    assert isinstance(scene.lines, SingleLine)
    found = solve(scene)
    rules = scene.plan.rules
    if law is not None:
        friction = _at_contact(
            law,
            shape,
            creepage,
            found.velocity,
            scene.temperature,
            found.normal_force,
            found.contact,
            found.converged,
        )

    def flat(field: Any) -> Any:
        return xp.broadcast_to(field, scene.shape).reshape(-1)

    rolling = Rolling(
        scene.law,
        sheared.law(),
        scene.lines,
        scene.reduced,
        flat(found.contact.leading),
        flat(found.contact.trailing),
        flat(friction),
        abs(flat(creepage)),
    )
    rule = rules[0] if scene.plan.traced else rules[-1]
    # Without creepage nothing pulls, and no error is small against that.
    rounding = 1 + xp.where(xp.isfinite(rolling.friction), rolling.friction, 0)
    rounding = _ROUNDING * rounding * flat(found.normal_force) / scene.vertical
    # Where errors cannot be looked at, the number of steps that is nearly always
    # enough.
    pulled = known(
        tractions(rolling, rule, _STEPS[1] if is_traced(rolling) else _STEPS[0])
    )
    for steps in _STEPS[1:]:
        missed = ~(pulled.error <= rtol * pulled.force + rounding)
        if is_traced(missed, pulled.force) or not np.any(
            missed & np.isfinite(pulled.force)
        ):
            break
        pulled = known(tractions(rolling, rule, steps))
    missed = ~(pulled.error <= rtol * pulled.force + rounding)
    pulled = pulled._replace(
        force=pulled.force * scene.vertical, error=pulled.error * scene.vertical
    )
    pulled = type(pulled)(*(xp.asarray(x).reshape(scene.shape) for x in pulled))
    good = found.converged & ~xp.asarray(missed).reshape(scene.shape)
    if not is_traced(good) and (lost := int(np.sum(found.converged & ~good))):
        warnings.warn(
            f"{lost} of {good.size} tractions did not converge; they are NaN.",
            ConvergenceWarning,
            stacklevel=3,
        )
    force = nan_unless(good, xp.sign(creepage) * pulled.force)
    inputs = list(found.inputs)
    place = [name for name, _ in inputs].index("relative tolerance")
    inputs[place:place] = _said(creepage, friction, law)
    answer = Traction(
        velocity=found.velocity,
        creepage=xp.broadcast_to(creepage, scene.shape),
        friction=xp.broadcast_to(friction, scene.shape),
        coefficient=force / found.normal_force,
        force=force,
        stick=nan_unless(good, pulled.stick),
        slip_power=abs(force * creepage) * found.velocity,
        rolling=found.mu,
        normal_force=found.normal_force,
        depth=found.depth,
        contact=found.contact,
        error=nan_unless(good, pulled.error / found.normal_force),
        converged=good,
        temperature=scene.temperature,
        model=BRUSH + scene.plan.model,
        plan=scene.plan,
        inputs=tuple(inputs),
        extrapolated=found.extrapolated,
    )
    return _braked(answer, slip, road)


def _kinematics(
    velocity: Any, creepage: Any, slip: Any
) -> tuple[Array, Array, Array | None, Array | None]:
    """Rolling velocity and creepage, and where a slip was given that slip and the
    velocity of the road, else None.
    """
    only_one(creepage=creepage, slip=slip)
    velocity = as_float64("velocity", velocity)
    if slip is None:
        creepage = as_float64("creepage", creepage)
        finite("creepage", creepage)
        return velocity, creepage, None, None
    slip = as_float64("slip", slip)
    accepted = (
        "finite and below 1, a part of the road's velocity (a locked wheel slides: "
        "em.friction)"
    )
    require("slip", slip, accepted, lambda s: np.isfinite(s) & (s < 1))
    positive("velocity", velocity)
    broadcast_shape(velocity=velocity, slip=slip)
    return (1 - slip) * velocity, slip / (1 - slip), slip, velocity


def _braked(found: Traction, slip: Any, road: Any) -> Traction:
    """The answer with the slip that was asked for, if one was."""
    if slip is None:
        return found
    rows = [pair for pair in found.inputs if pair[0] != "creepage"]
    place = next(i for i, pair in enumerate(rows) if pair[0] == "velocity")
    counted = (
        f"{brief(slip, '').strip()}; of the velocity V of the road, (V - v)/V, with v "
        "that of rolling"
    )
    rows[place : place + 1] = [
        ("velocity of the road", brief(road, "m/s")),
        ("slip", counted),
    ]
    shape = np.shape(found.force)
    slip, road = xp.broadcast_to(slip, shape), xp.broadcast_to(road, shape)
    return dataclasses.replace(found, slip=slip, road=road, inputs=tuple(rows))


def _said(
    creepage: Any, friction: Any, law: FrictionLaw | None
) -> list[tuple[str, str]]:
    words = brief(friction, "").strip()
    if law is not None:
        words = (
            f"{words}, of a friction law at the body's sliding velocity "
            f"({', '.join(law.axes())})"
        )
    return [("creepage", brief(creepage, "").strip()), ("friction coefficient", words)]


def _shifted(normal: Foundation, sheared: Foundation) -> Foundation:
    """`normal` with the shift law of `sheared`, where it is elastic and has none of its
    own: a_T changes nothing in it.

    Raises `InputError` for laws that differ, since one a_T scales the velocity of both,
    and one b_T their moduli.
    """
    law = normal.law()
    elastic = (
        not law.moduli.size
        and not is_traced(law.viscosity)
        and float(law.viscosity) == 0
    )
    if elastic and sheared.shift is not None:
        normal = replaced(normal, shift=sheared.shift)
    if (sheared.shift is not None or sheared.vertical is not None) and not same_thermal(
        normal, sheared
    ):
        raise InputError(
            "tangential must have the same shift law as material, and the same "
            "vertical one, got "
            f"{sheared.shift}, {sheared.vertical} and {normal.shift}, "
            f"{normal.vertical}; bring both to their "
            "temperature first, with material.at(T)."
        )
    return normal


def _at_contact(
    law: FrictionLaw,
    shape: Any,
    creepage: Any,
    velocity: Any,
    kelvin: Any,
    force: Any,
    contact: Contact,
    good: Any,
) -> Any:
    """The law's mu at each contact; without creepage at its lowest velocity, which
    decides nothing there.
    """
    axes, given = law.axes(), {}
    if "temperature" in axes:
        if kelvin is None:
            raise InputError(
                "temperature must be given: the friction law depends on it."
            )
        given["temperature"] = kelvin
    if law.pressure is not None:
        length = contact.leading + contact.trailing
        area = (
            length * shape.length
            if isinstance(shape, Cylinder)
            else xp.pi * (0.5 * length) ** 2
        )
        given["pressure"] = xp.where(good, force / area, law.pressure[0])
    slip = xp.prod(xp.stack(xp.broadcast_arrays(xp.abs(creepage), velocity)), axis=0)
    return law(xp.where(slip > 0, slip, law.velocity[0]), **given)


def _on_layer(
    layer: Layer,
    shape: Any,
    velocity: Any,
    creepage: Any,
    friction: Any,
    load: Any,
    depth: Any,
    temperature: Any,
    tangential: Any,
    model: Any,
    rtol: float,
) -> Traction:
    """A cylinder on a bonded layer. Raises `InputError` for other bodies and what is
    not known of the shear.
    """
    if not isinstance(shape, Cylinder):
        raise InputError(
            "shape must be an em.Cylinder for traction on an em.layer, got a "
            f"{shape.label}."
        )
    if tangential is not None:
        raise InputError(
            "tangential must be left out with an em.layer, which knows its own "
            "shear stiffness."
        )
    if is_traced(layer, shape, velocity, creepage, friction, load, depth, temperature):
        raise InputError(
            "material must be em.springs or a half-space under jit, grad and vmap, "
            "not an em.layer."
        )
    if (load is None) == (depth is None):
        raise InputError("load or depth must be given, and only one of them.")
    solid: Any = layer.material
    if (
        layer.other is not None
        or not layer.bonded
        or not layer.constant
        or not isinstance(solid, Prony)
    ):
        raise InputError(
            "material must be one em.layer for traction, bonded to its base, of an "
            "em.Prony with a constant Poisson's ratio."
        )
    sheared = solid.shear().law()
    if float(sheared.viscosity) > 0:
        raise InputError(
            "material must have no parallel dashpot for traction on an em.layer."
        )
    given = load if depth is None else depth
    value = np.broadcast_to(
        given, np.broadcast_shapes(np.shape(given), np.shape(velocity))
    )
    done, points, contacts = cylinder_pressure(
        layer,
        shape,
        velocity=velocity,
        load=value if depth is None else None,
        depth=None if depth is None else value,
        temperature=temperature,
        model=model,
        rtol=rtol,
    )
    found, law = done.found, friction if isinstance(friction, FrictionLaw) else None
    if law is not None:
        friction = _at_contact(
            law,
            shape,
            creepage,
            found.velocity,
            done.temperature,
            found.normal_force,
            found.contact,
            found.converged,
        )
    rubbing: Any = friction
    rubbing, slipping = (np.broadcast_to(x, points.shape) for x in (rubbing, creepage))
    softness = shear_compliance(
        typical_wave(contacts.half),
        float(layer.thickness),
        float(1 - layer.squeeze()) / 2,
    )
    pulled = pull(
        sheared,
        1 / softness,
        np.asarray(points.reduced).reshape(-1),
        contacts.half,
        contacts.terms,
        rubbing.reshape(-1),
        np.abs(slipping).reshape(-1),
    )
    scale = float(shape.length) * np.asarray(points.vertical).reshape(-1)
    size, stick, off = (
        x.reshape(points.shape)
        for x in (pulled.force * scale, pulled.stick, pulled.error * scale)
    )
    force = nan_unless(found.converged, np.sign(slipping) * size)
    inputs = list(found.inputs)
    place = [name for name, _ in inputs].index("relative tolerance")
    inputs[place:place] = _said(creepage, rubbing, law)
    return Traction(
        velocity=found.velocity,
        creepage=slipping,
        friction=rubbing,
        coefficient=force / found.normal_force,
        force=force,
        stick=nan_unless(found.converged, stick),
        slip_power=abs(force * slipping) * found.velocity,
        rolling=found.mu,
        normal_force=found.normal_force,
        depth=found.depth,
        contact=found.contact,
        error=nan_unless(found.converged, off / found.normal_force),
        converged=found.converged,
        temperature=done.temperature,
        model=ON_LAYER + done.model,
        plan=done.plan,
        inputs=tuple(inputs),
        extrapolated=found.extrapolated,
    )


def _carter(
    foundation: Any,
    shape: Cylinder,
    velocity: Any,
    creepage: Any,
    friction: Any,
    load: Any,
    depth: Any,
    temperature: Any,
) -> Traction:
    law = foundation.law()
    mu_law: FrictionLaw | None = friction if isinstance(friction, FrictionLaw) else None
    if load is None or depth is not None:
        raise InputError(
            "load must be given for a cylinder on a half-space, whose depth is "
            "not defined (plane strain)."
        )
    if law.moduli.size or (not is_traced(law) and law.viscosity > 0):
        raise InputError(
            "material must be elastic for a cylinder on a half-space (Carter's "
            "problem), or a layer (em.springs): a viscoelastic half-plane is no MDR "
            "problem."
        )
    load = as_float64("load", load)
    positive("load", load)
    if (
        temperature is not None
        and foundation.vertical is None
        and (mu_law is None or mu_law.temperature is None)
    ):
        raise InputError(
            "temperature must be left out for an elastic half-plane, on which it "
            "has no effect."
        )
    modulus = law.equilibrium
    if temperature is not None and foundation.vertical is not None:
        modulus = (
            modulus
            * thermal_factors(foundation, as_float64("temperature", temperature))[1]
        )
    if mu_law is not None:
        half = carter(modulus, shape.radius, load / shape.length, 1.0, 0.0)[2]
        friction = _at_contact(
            mu_law,
            shape,
            creepage,
            velocity,
            temperature,
            load,
            Contact(half, half),
            True,
        )
    if not is_traced(friction) and np.isinf(np.asarray(friction)).any():
        raise InputError(
            "friction must be finite for a cylinder on a half-space: without slip "
            "Carter's traction diverges."
        )
    arrays = velocity, creepage, friction, load, modulus
    velocity, creepage, friction, load, modulus = xp.broadcast_arrays(
        *(xp.asarray(x) for x in arrays)
    )
    ratio, stick, half = carter(
        modulus, shape.radius, load / shape.length, friction, abs(creepage)
    )
    zero = xp.zeros_like(ratio)
    force = xp.sign(creepage) * ratio * load
    inputs = [
        ("material", foundation.name or "given directly"),
        ("shape", describe(shape)),
    ]
    inputs += [
        ("load", brief(load, "N")),
        ("velocity", brief(velocity, "m/s")),
        *_said(creepage, friction, mu_law),
    ]
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
        converged=xp.ones(ratio.shape, bool),
        temperature=None,
        model=CARTER,
        plan="closed form",
        inputs=tuple(inputs),
    )
