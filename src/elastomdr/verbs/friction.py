"""Steady sliding friction of one indenter."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, ParamSpec

from ..call.model_choice import (
    hint_at_line,
    is_rough,
    of_rough,
    of_smooth,
    only_rough,
)
from ..call.several_materials import over_materials
from ..checks import needs_64_bit_types, numpy_unless_traced
from ..results.curve import FrictionCurve
from ..rough.adhesion import on_contact
from ..rough.adhesive_shear import AdhesiveShear, check_adhesion
from ..rough.heat import Heat
from ..smooth.on_layer import beside_layer, is_on_layer, on_layer
from ..smooth.problem import set_up, solve
from ..smooth.softening import SOFTENED
from ..surface.shapes import AbstractShape
from ..surface.spectrum import AbstractSpectrum

if TYPE_CHECKING:
    from .._types import ArrayLike, Number, Store
    from ..call.types import Indenter, Materials, ModelLike, Surface

P = ParamSpec("P")


def _surfaces_in_64_bits(
    function: Callable[P, FrictionCurve],
) -> Callable[P, FrictionCurve]:
    """Refuses surfaces and layers under jit, grad or vmap without 64-bit types: JAX
    would mix both.
    """

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> FrictionCurve:
        shape = args[1] if len(args) > 1 else kwargs.get("shape")
        surface = (
            isinstance(shape, AbstractSpectrum) and kwargs.get("pressure") is not None
        )
        if surface or is_on_layer(args[0] if args else kwargs.get("material"), shape):
            return needs_64_bit_types(function)(*args, **kwargs)
        return function(*args, **kwargs)

    return wrapper


@over_materials
@_surfaces_in_64_bits
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
    skip: bool = True,
    heat: Heat | None = None,
    adhesion: AdhesiveShear | None = None,
    strain_share: Number = 0.5,
    progress: Callable[[int, int], None] | None = None,
    store: Store | None = None,
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
            body `em.Averaged()`, the default, `em.Line()` or `em.HalfSpace()`; on
            layers every line is exact, and the model makes no difference. For a rough
            line `em.Line()`. For a surface under a pressure `em.Multiscale()`, the
            default, `em.Persson()`, `em.HalfSpace()` or `em.Line()`; under a load or a
            depth `em.Line()`.
        rtol: relative error of mu to be met, 1e-3 to 1e-10. With `em.Line` on a rough
            line or surface it is that of the solution on its samples;
            `curve.lines.numerical` has the error for the sampling too, and a point
            where it exceeds a tenth of mu is NaN.
        skip: False computes also what the plan would leave out.
        heat: `em.Heat(...)` heats the rubber of a surface under a pressure by its
            friction, from `temperature`, that of the body, on, until friction and
            temperature agree: `mu` is then the hot curve, `cold` the one without
            heating, `temperature_rise` the mean where the heat arises. With
            `em.Multiscale()` and `em.Persson()` each length scale has a temperature of
            its own (`elastomdr.rough.temperature_by_scale`), `contact_rise` that of the
            shortest waves; with others there is one (`elastomdr.rough.heat`). Points
            where none is found are NaN.
        adhesion: `em.AdhesiveShear(...)` adds the shear stress of dry contact on the
            area of real contact: `mu` is then the sum of `hysteresis` and `adhesion`.
            On a surface under a pressure that is its `area_ratio`; under a smooth body
            `contact_area`, from the edges of its contact or, with `em.HalfSpace()`,
            from its cells. A line (`em.Line` on a rough line or surface) has none.
        strain_share: of a material with a softening on a surface: strain amplitude at
            wave number q over the rms slope of the waves up to q, above 0 and at most
            2. `linear` is mu without softening. `em.Line()` and `em.HalfSpace()` on a
            surface are linear and say so.
        progress: `progress(done, total)` is called after each batch on a rough line or
            surface.
        store: keeps finished batches of lines (`get(key)`, `put(key, arrays)`).

    Returns:
        An `em.FrictionCurve`. `error` is numerical, with the scatter of random lines;
        `model_error` bounds the distance to the half-space. With `em.Averaged` depth,
        normal force and contact edges are those of the line at the velocity itself.
        Points that do not converge are NaN and counted in one `ConvergenceWarning`.

    Raises:
        InputError: for arguments that have no meaning.

    Exact for the line and for layers; for the half-space see
    `elastomdr.surface.direction`. Differentiable with respect to moduli, times,
    geometry, load or depth, velocity and temperature. Source: Popov & Hess 2015, ch. 7
    and 10, and `docs/theory.md`.
    """
    if is_rough(shape):
        chosen = of_rough(model, shape, pressure)
        chosen.check_adhesion(adhesion)
        hint_at_line(model, shape, pressure=pressure, load=load, depth=depth)
        return chosen.rough_friction(
            material,
            shape,
            velocity=velocity,
            load=load,
            depth=depth,
            pressure=pressure,
            temperature=temperature,
            rtol=rtol,
            skip=skip,
            heat=heat,
            adhesion=adhesion,
            strain_share=strain_share,
            progress=progress,
            store=store,
        )
    only_rough(heat)
    check_adhesion(adhesion, temperature)
    if isinstance(shape, AbstractShape):
        model = of_smooth(model, "friction", shape.label)
        if not model.on_line:
            return model.smooth_friction(
                material,
                shape,
                velocity=velocity,
                load=load,
                depth=depth,
                pressure=pressure,
                temperature=temperature,
                adhesion=adhesion,
            )
    if is_on_layer(material, shape):
        found, kelvin, name, plan = on_layer(
            "friction",
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
        layer = True
    else:
        scene = set_up(
            "friction",
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
        layer = bool(scene.foundation.per_area)
    curve = FrictionCurve(
        velocity=found.velocity,
        mu=found.mu,
        normal_force=found.normal_force,
        friction_force=found.friction_force,
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
    return curve if adhesion is None else on_contact(curve, adhesion, shape, layer)
