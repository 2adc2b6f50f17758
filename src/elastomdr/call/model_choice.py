"""Which model of lines a body is computed with: that of the caller, checked, or the
default of the shape; of surfaces see `verbs/roads.py`.
"""

from typing import TypeGuard

from ..errors import InputError
from ..models import Averaged, Line, Model, as_model
from ..surface.rough_line import RoughLine
from ..surface.spectrum import AbstractSpectrum

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
            "branch belongs to heat= on a rough surface; an indenter's friction has "
            f"one temperature, got {branch!r}."
        )
    if heat is not None:
        raise InputError(
            "heat belongs to a rough surface; an indenter's friction is at the "
            "temperature given."
        )
    if direction is not None:
        raise InputError(
            "direction is an angle to the lay of a rough surface; an indenter has "
            f"none, got {direction!r}."
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
        f"model must be em.Averaged() or em.Line() for {quantity} of a {label}, got "
        f"{model!r}."
    )


def of_line(model: Model | str | None, call: str) -> Line:
    """The model of what exists on a line only. Raises `InputError`."""
    model = as_model(model)
    if model is None:
        return Line()
    if not isinstance(model, Line):
        raise InputError(f"model must be em.Line(...) in em.{call}, got {model!r}.")
    return model


def _bare(model: Line, label: str) -> Line:
    if model.average:
        raise InputError(
            "model must be em.Averaged(corrected=False) for the line averaged over "
            f"directions of a {label}, got "
            "em.Line(average=True), which is for rough lines and surfaces."
        )
    default = Line()
    for name in _OF_SURFACES:
        value = getattr(model, name)
        if value is not None and (
            not isinstance(value, int) or value != getattr(default, name)
        ):
            raise InputError(
                f"{name} of em.Line belongs to a rough line or surface, not to a "
                f"{label}; got {value!r}."
            )
    return model
