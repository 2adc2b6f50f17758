"""Steady frictionless rolling of a sphere, or of a cylinder on a layer."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, ParamSpec

from ..call.several_materials import over_materials
from ..checks import needs_64_bit_types, numpy_unless_traced
from ..errors import InputError
from ..results.curve import RollingCurve
from ..smooth.on_layer import beside_layer, is_on_layer, on_layer
from ..smooth.problem import set_up, solve
from ..smooth.softening import SOFTENED
from ..surface.shapes import AbstractShape

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials, ModelLike

P = ParamSpec("P")


def _layers_in_64_bits(
    function: Callable[P, RollingCurve],
) -> Callable[P, RollingCurve]:
    """Refuses a layer under jit, grad or vmap without 64-bit types: JAX would mix
    both.
    """

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> RollingCurve:
        material = args[0] if args else kwargs.get("material")
        layer = is_on_layer(material, args[1] if len(args) > 1 else kwargs.get("shape"))
        return (needs_64_bit_types(function) if layer else function)(*args, **kwargs)

    return wrapper


@over_materials
@_layers_in_64_bits
@numpy_unless_traced
def rolling(
    material: Materials,
    shape: Indenter,
    *,
    velocity: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    pressure: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    model: ModelLike | None = None,
    rtol: float = 1e-6,
    skip: bool = True,
) -> RollingCurve:
    """Rolling resistance of a sphere, or the indentation rolling resistance of a belt
    under a cylinder.

    Without friction in the contact a rolling body solves the same pressure problem as a
    sliding one. The resistance is taken from the power that the rubber dissipates, F =
    P/v, and the moment is M = R F. (The moment of the MDR line's own forces is half of
    that, since the line is not the half-space's pressure; the power is right in both
    models.) `coefficient` is the resisting force over the normal force. `model` is
    `em.Averaged(...)`, by default with its correction, or `em.Line()`. Arguments,
    errors and limits as for `friction`; raises `InputError` for bodies that do not
    roll.
    """
    if isinstance(shape, AbstractShape) and shape.rolling_radius is None:
        raise InputError(
            "shape must roll (em.Sphere, em.Paraboloid or em.Cylinder), got a "
            f"{shape.label}."
        )
    if is_on_layer(material, shape):
        found, kelvin, name, plan = on_layer(
            "rolling",
            material,
            shape,
            velocity=velocity,
            load=load,
            depth=depth,
            pressure=pressure,
            temperature=temperature,
            model=model,
            rtol=rtol,
        )
    else:
        scene = set_up(
            "rolling",
            material,
            shape,
            velocity=velocity,
            load=load,
            depth=depth,
            pressure=pressure,
            temperature=temperature,
            model=model,
            rtol=rtol,
            skip=skip,
        )
        found, kelvin, name, plan = (
            solve(scene),
            scene.temperature,
            scene.plan.model,
            scene.plan,
        )
        found = beside_layer(
            found, material, shape, load=load, depth=depth, temperature=temperature
        )
    radius = shape.rolling_radius
    assert radius is not None  # refused above
    return RollingCurve(
        velocity=found.velocity,
        coefficient=found.mu,
        resistance=found.friction_force,
        moment=found.friction_force * radius,
        power=found.friction_force * found.velocity,
        normal_force=found.normal_force,
        depth=found.depth,
        contact=found.contact,
        error=found.error,
        model_error=found.model_error,
        converged=found.converged,
        extrapolated=found.extrapolated,
        temperature=kelvin,
        strain=found.strain,
        linear=found.linear,
        model=name + ("" if found.strain is None else SOFTENED),
        plan=plan,
        inputs=found.inputs,
    )
