"""What a scene would compute, and leave out, without computing it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..call.model_choice import is_rough, only_rough
from ..call.problem import Asked
from ..call.several_materials import over_materials
from ..checks import numpy_unless_traced, one_of
from ..errors import InputError
from ..rough.adhesion import AdhesiveShear, check_adhesion
from ..rough.heat import Heat
from ..rough.problem import RoughCall
from ..smooth.plan import Plan
from ..smooth.problem import LayerPlan, SmoothCall
from .roads import cells_of_body, hint_at_line, of_rough, plan_by
from .steady import steady_plan

if TYPE_CHECKING:
    from .._types import ArrayLike, Motion
    from ..call.several_materials import Plans
    from ..call.types import Indenter, Materials, ModelLike, Surface
    from ..rough.surface import SurfacePlan


@over_materials
@numpy_unless_traced
def plan(
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
    quantity: Motion = "friction",
    heat: Heat | None = None,
    adhesion: AdhesiveShear | None = None,
    direction: ArrayLike | None = None,
) -> "Plan | LayerPlan | SurfacePlan | Plans | str":
    """The plan that `friction` (or `rolling`, by `quantity`) would follow; printing it
    says what is skipped and why.

    Arguments and errors as for `friction`; `adhesion` adds nothing to the work. With
    `em.HalfSpace` on a smooth body it is a line of text. Of a list of materials it is a
    tuple of plans, one for each.
    """
    one_of("quantity", quantity, "friction", "rolling")
    check_adhesion(adhesion, temperature)
    solid: Any = material  # `over_materials` has taken a list apart
    asked = Asked(velocity, load, depth, pressure, temperature, direction)
    if is_rough(shape):
        if quantity != "friction":
            raise InputError(
                argument="quantity",
                got=quantity,
                accepted="'friction' on a rough surface",
            )
        road_model = of_rough(model, shape, pressure)
        call = RoughCall(solid, shape, asked, rtol, heat, adhesion)
        planned = plan_by(road_model, call)
        hint_at_line(model, shape, asked)
        return planned
    only_rough(heat=heat, direction=direction)
    body: Any = shape  # anything else is refused there
    smooth = SmoothCall(quantity, solid, body, asked, model, rtol)
    cells = cells_of_body(smooth)
    if cells is not None:
        from ..reference.half_space import grid_words

        return grid_words(cells)
    return steady_plan(smooth)
