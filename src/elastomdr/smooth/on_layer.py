"""Steady friction and rolling on rubber of finite thickness: which solver a body goes
to.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ..checks import is_traced, only_one
from ..element.law import Foundation
from ..element.layer import Layer
from ..errors import InputError, quiet
from ..surface.shapes import AbstractShape, Cylinder
from .problem import LayerPlan, OnLayer, SmoothCall, Steady, no_pressure

_ENOUGH = 1e-4  # relative error of the layer that springs are compared with


def is_on_layer(material: object, shape: object) -> bool:
    """Whether the contact is one of a layer, or of a cylinder on a half-space, the
    limit of a thick layer.
    """
    if not isinstance(shape, AbstractShape):
        return isinstance(material, Layer)
    return isinstance(material, Layer) or (
        isinstance(shape, Cylinder) and getattr(material, "per_area", False) is False
    )


def on_layer(call: SmoothCall) -> OnLayer:
    """The steady scene of a smooth body on a layer. Raises `InputError` for whatever
    has no meaning.
    """
    _check(call)
    if isinstance(call.shape, Cylinder):
        from .cylinder import cylinder_on_layer

        return cylinder_on_layer(call)
    from .ball_on_layer import ball_on_layer

    return ball_on_layer(call)


def plan_on_layer(call: SmoothCall) -> LayerPlan:
    """Its plan. Raises `InputError`."""
    _check(call)
    if isinstance(call.shape, Cylinder):
        from .cylinder import cylinder_plan

        return cylinder_plan(call)
    from .ball_on_layer import ball_plan

    return ball_plan(call)


def _check(call: SmoothCall) -> None:
    shape = call.shape
    if not isinstance(shape, AbstractShape):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="an em.Sphere, em.Cone, em.Cylinder or the like on a layer",
        )
    no_pressure(shape, call.asked.pressure)
    only_one({"load": call.asked.load, "depth": call.asked.depth})


def beside_layer(on_springs: Steady, call: SmoothCall) -> Steady:
    """The result on springs, with how far it is from that on the layer they stand for,
    and what is known of that layer, as its `model_error`.

    NaN where the layer has no bound, under a transformation of JAX, and under bodies of
    revolution, whose layer takes ten times as long and more.
    """
    material, asked = call.material, call.asked
    if not isinstance(material, Foundation) or material.slab is None:
        return on_springs
    apart = on_springs.mu * np.nan
    linear = on_springs.strain is None
    if (
        linear
        and isinstance(call.shape, Cylinder)
        and not is_traced(
            material,
            call.shape,
            asked.velocity,
            asked.load,
            asked.depth,
            asked.temperature,
        )
    ):
        slab, depth = material.slab, asked.depth
        deep = False if depth is None else np.asarray(depth) >= slab.thickness
        if depth is not None:
            depth = np.minimum(np.asarray(depth), 0.99 * slab.thickness)
        from .cylinder import cylinder_on_layer

        with quiet():
            exact = cylinder_on_layer(
                SmoothCall(
                    "rolling",
                    Layer(slab.material, slab.thickness, bonded=slab.bonded),
                    call.shape,
                    dataclasses.replace(asked, depth=depth),
                    rtol=_ENOUGH,
                )
            ).steady
        apart = np.abs(on_springs.mu - exact.mu) + exact.error + exact.model_error
        apart = np.where(deep, np.nan, apart)
    return on_springs._replace(model_error=apart)
