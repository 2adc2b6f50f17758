"""Steady frictionless rolling of a sphere, or of a cylinder on a layer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..call.problem import Asked
from ..call.several_materials import over_materials
from ..checks import numpy_unless_traced
from ..errors import InputError
from ..results.curve import RollingCurve
from ..smooth.problem import SmoothCall
from ..surface.shapes import AbstractShape
from .friction import repeatable
from .steady import in_64_bits_where, needs_layer, steady_contact

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials, ModelLike
    from ..rough.adhesion import AdhesiveShear


@over_materials
@in_64_bits_where(needs_layer)
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
) -> RollingCurve:
    """Rolling resistance of a sphere, or the indentation rolling resistance of a belt
    under a cylinder.

    Without friction in the contact a rolling body solves the same pressure problem as a
    sliding one. The resistance is taken from the power that the rubber dissipates, F =
    P/v, and the moment is M = R F. (The moment of the MDR line's own forces is half of
    that, since the line is not the half-space's pressure; the power is right in both
    models.) `coefficient` is the resisting force over the normal force. `model` is
    `em.Averaged(...)`, by default with its correction, `em.Line()` or `em.Marched()`.
    Arguments, errors and limits as for `friction`; raises `InputError` for bodies that
    do not roll.
    """
    if isinstance(shape, AbstractShape) and shape.rolling_radius is None:
        raise InputError(
            argument="shape",
            got=shape,
            accepted="one that rolls, an em.Sphere, em.Paraboloid or em.Cylinder",
        )
    solid: Any = material  # `over_materials` has taken a list apart
    asked = Asked(velocity, load, depth, pressure, temperature)
    call = SmoothCall("rolling", solid, shape, asked, model, rtol)
    return repeatable(_rolled(call), call, None, _rolled)


def _rolled(call: SmoothCall, _: AdhesiveShear | None = None) -> RollingCurve:
    contact, radius = steady_contact(call), call.shape.rolling_radius
    solution = contact.solution
    assert radius is not None  # refused before
    return RollingCurve(
        coefficient=solution.mu,
        resistance=solution.friction_force,
        moment=solution.friction_force * radius,
        power=solution.friction_force * solution.velocity,
        **contact.common_fields(),
    )
