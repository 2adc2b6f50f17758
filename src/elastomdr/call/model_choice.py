"""Which model of lines a body is computed with: that of the caller, checked, or the
default of the shape; of surfaces see `verbs/roads.py`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeGuard

from ..element.law import Foundation
from ..element.layer import Layer
from ..errors import InputError
from ..models import Averaged, Line, Marched, Model, as_model, named
from ..surface.rough_line import RoughLine
from ..surface.shapes import Cylinder
from ..surface.spectrum import AbstractSpectrum

if TYPE_CHECKING:
    from .types import Indenter, Material

# options of em.Line that smooth bodies do not have
_OF_SURFACES = "equivalent_length", "seeds", "samples", "periods"


def is_rough(shape: object) -> TypeGuard[RoughLine | AbstractSpectrum]:
    """Whether a shape is a rough line or surface."""
    return isinstance(shape, (RoughLine, AbstractSpectrum))


def only_rough(
    heat: object = None, direction: object = None, branch: object = "cold"
) -> None:
    """Refuses for an indenter what belongs to a rough surface. Raises `InputError`."""
    if not isinstance(branch, str) or branch != "cold":
        raise InputError(
            argument="branch",
            got=branch,
            accepted="left out for an indenter",
            hint="it belongs to heat= on a rough surface",
        )
    if heat is not None:
        raise InputError(
            argument="heat",
            got=heat,
            accepted="left out for an indenter",
            hint="its friction is at the temperature given",
        )
    if direction is not None:
        raise InputError(
            argument="direction",
            got=direction,
            accepted="left out for an indenter",
            hint="it is an angle to the lay of a rough surface",
        )


def of_smooth(model: Model | str | None, quantity: str, label: str) -> Averaged | Line:
    """The model of a smooth body on its line. Raises `InputError`."""
    model = as_model(model)
    if model is None:
        return Averaged()
    if isinstance(model, Line):
        return _bare(model, label)
    if isinstance(model, Averaged):
        return model
    raise InputError(
        argument="model",
        got=model,
        accepted=named(Averaged(), Line(), Marched()) + f" for {quantity} of a {label}",
    )


def models_of(material: Material, shape: Indenter, whole: Model) -> list[Model]:
    """The models of friction of a smooth body; `whole` is that in three dimensions."""
    ball = not isinstance(shape, Cylinder)
    springs = isinstance(material, Foundation) and material.is_springs(shape)
    known: list[Model] = [Averaged(), Line()]
    if springs or (ball and not isinstance(material, Layer)):
        known.append(Marched())
    if ball and not springs:
        known.append(whole)
    return known


def of_layer(model: Model | str | None, quantity: str, label: str) -> Averaged | Line:
    """The model of a smooth body on an `em.layer`, or of a cylinder on a half-space,
    which have no elements. Raises `InputError`.
    """
    chosen = as_model(model)
    if chosen is None or (chosen.on_line and not chosen.marched):
        return of_smooth(chosen, quantity, label)
    raise InputError(
        argument="model",
        got=chosen,
        accepted="em.Averaged() or em.Line() without independent elements, which a "
        "ball on a half-space and em.springs have",
    )


def of_line(model: Model | str | None, call: str) -> Line:
    """The model of what exists on a line only. Raises `InputError`."""
    model = as_model(model)
    if model is None:
        return Line()
    if not isinstance(model, Line):
        raise InputError(
            argument="model", got=model, accepted=f"em.Line(...) in em.{call}"
        )
    return model


def _bare(model: Line, label: str) -> Line:
    if model.average:
        raise InputError(
            argument="model",
            got=model,
            accepted=named(Averaged(corrected=False))
            + f" for the line averaged over directions of a {label}",
            hint="average=True of em.Line is for rough lines and surfaces",
        )
    default = Line()
    for name in _OF_SURFACES:
        value = getattr(model, name)
        if value is not None and (
            not isinstance(value, int) or value != getattr(default, name)
        ):
            raise InputError(
                argument=name,
                got=value,
                accepted=f"left out of em.Line for a {label}",
                hint="it belongs to a rough line or surface",
            )
    return model
