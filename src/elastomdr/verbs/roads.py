"""Which model a body or a surface is computed with, of all that there are, and where
friction by it is computed.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from ..call.model_choice import models_of, of_smooth
from ..call.problem import Asked
from ..errors import InputError, ModelWarning, warn
from ..models import Averaged, Line, Marched, Model, as_model, named
from ..rough.adhesion import no_area
from ..rough.road_model import SurfaceModel
from ..rough.road_models import HalfSpace, Multiscale, Persson
from ..surface.rough_line import RoughLine
from ..surface.shapes import AbstractShape

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Surface
    from ..results.curve import FrictionCurve
    from ..rough.problem import RoughCall
    from ..rough.surface import SurfacePlan
    from ..smooth.problem import SmoothCall
    from ..surface.spectrum import AbstractSpectrum

KINDS: dict[str, type[Model]] = {
    kind.label: kind
    for kind in (
        Averaged,
        Line,
        Marched,
        Multiscale,
        Persson,
        HalfSpace,
    )
}


_CELLS = 64  # along each side of the grid of a smooth body, by default


def cells_of_body(call: SmoothCall) -> int | None:
    """Cells along each side of the grid of a smooth body by `em.HalfSpace`, which has
    its friction alone; None on a line, and of what is no body. Raises `InputError`.
    """
    if not isinstance(call.shape, AbstractShape):
        return None
    model, label = as_model(call.model, KINDS), call.shape.label
    if call.quantity != "friction" or not isinstance(model, SurfaceModel):
        of_smooth(model, call.quantity, label)
        return None
    if not isinstance(model, HalfSpace):
        known = models_of(call.material, call.shape, HalfSpace())
        accepted = named(*known) + f" for a {label}"
        raise InputError(argument="model", got=model, accepted=accepted)
    if model.seeds != 1 or model.periods is not None:
        raise InputError(
            argument="model",
            got=model,
            accepted=f"em.HalfSpace(cells=...) for a {label}",
            hint="seeds and periods are for a surface",
        )
    if model.cells is not None and model.cells % 2:
        raise InputError(
            argument="cells",
            got=model.cells,
            accepted=f"an even whole number for a {label}",
        )
    return model.cells or _CELLS


def of_rough(
    model: Model | str | None, surface: Surface, pressure: ArrayLike | None
) -> Line | SurfaceModel:
    """The model of a rough line, or of a surface, under a pressure or not. Raises
    `InputError`.
    """
    model = as_model(model, KINDS)
    if model is None:
        return (
            Line()
            if pressure is None or isinstance(surface, RoughLine)
            else Multiscale()
        )
    if isinstance(model, Line):
        return model
    if isinstance(model, Averaged):
        raise InputError(
            argument="model",
            got=model,
            accepted="one of a rough line or surface",
            hint="use "
            + named(Line(average=True))
            + " for the line averaged over directions, or "
            + named(Multiscale())
            + " for a surface under a pressure",
        )
    if isinstance(surface, RoughLine):
        raise InputError(
            argument="model", got=model, accepted=named(Line()) + " for a rough line"
        )
    if pressure is None:
        raise InputError(
            argument="model",
            got=model,
            accepted=named(Line()) + " for a surface without a pressure",
        )
    if not isinstance(model, SurfaceModel):
        raise InputError(argument="model", got=model, accepted="one of friction")
    return model


def hint_at_line(model: Model | str | None, surface: Surface, asked: Asked) -> None:
    """Warns where a load or depth makes the line the model of a surface that could be
    computed under a pressure.
    """
    if model is not None or isinstance(surface, RoughLine):
        return
    if asked.pressure is not None or (asked.load is None and asked.depth is None):
        return
    name = "depth" if asked.load is None else "load"
    unit = (
        "a force per length of line [N/m]" if name == "load" else "the depth of a line"
    )
    warn(
        f"{name} on a surface is {unit}, and is computed with em.Line(), whose "
        "friction may be fifty times too low: give pressure= [Pa], the load over the "
        "nominal area, for em.Multiscale(), or model=em.Line() where the line is meant "
        '(in a scene model = "line").',
        ModelWarning,
    )


def friction_by(call: RoughCall, model: Line | SurfaceModel) -> FrictionCurve:
    """`em.friction` of a rough line or surface. Raises `InputError`."""
    if isinstance(model, Line):
        from ..rough.line import rough_friction

        _refuse(model, call)
        return rough_friction(call, model)
    from ..rough.surface import surface_friction

    return surface_friction(call, model)


def plan_by(model: Line | SurfaceModel, call: RoughCall) -> SurfacePlan:
    """`em.plan` of a rough line or surface. Raises `InputError`."""
    if isinstance(model, Line):
        from ..rough.line import rough_plan

        _refuse(model, call)
        return rough_plan(call, model)
    from ..rough.surface import surface_plan

    return surface_plan(call, model)


def _refuse(model: Line, call: RoughCall) -> None:
    """Raises `InputError` for what a line does not have: an area, directions."""
    no_area(
        call.adhesion,
        f"a {model.label} on a rough line or surface",
        "use em.Multiscale() under a pressure",
    )
    if call.asked.direction is not None:
        raise InputError(
            argument="direction",
            got=call.asked.direction,
            accepted="left out with " + named(Line()),
            hint="it needs "
            + named(Multiscale(), Persson(), HalfSpace())
            + " and a surface under a pressure",
        )


def for_changes(
    model: Line | SurfaceModel, surface: AbstractSpectrum, finer: float
) -> Line | SurfaceModel:
    """The model for many surfaces close to this one, with the same samples on each;
    `finer` is by how much their cutoffs grow.
    """
    if not isinstance(model, Line) or model.samples is not None:
        return model
    from ..surface.spectrum import PER_WAVE, line_count

    samples = line_count(surface, model.periods, PER_WAVE * finer)
    return dataclasses.replace(model, samples=samples)


def doubt_of(model: Line | SurfaceModel, surface: AbstractSpectrum) -> str | None:
    """What the model misses on a surface under a pressure, for a warning; None where
    that is little.
    """
    if not isinstance(model, Line):
        return None
    from ..rough.line_problem import missed

    return missed(surface, model)
