"""Which model a body or a surface is computed with: that of the caller, checked, or the
default of the shape.
"""

from typing import Any, TypeGuard

from ..errors import InputError, ModelWarning, warn
from ..models import Averaged, HalfSpace, Line, Model, Multiscale, as_model
from ..surface.rough_line import RoughLine
from ..surface.spectrum import AbstractSpectrum
from .problem import Asked

# options of em.Line that smooth bodies do not have
_OF_SURFACES = "equivalent_length", "seeds", "samples", "periods"


def is_rough(shape: Any) -> TypeGuard[RoughLine | AbstractSpectrum]:
    """Whether a shape is a rough line or surface."""
    return isinstance(shape, (RoughLine, AbstractSpectrum))


def only_rough(heat: Any = None, direction: Any = None, branch: Any = "cold") -> None:
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


def of_smooth(model: Any, quantity: str, label: str) -> Averaged | Line | HalfSpace:
    """The model of a smooth body, which may be `em.HalfSpace` for its friction. Raises
    `InputError`.
    """
    model = as_model(model)
    if model is None:
        return Averaged()
    if isinstance(model, Line):
        return _bare(model, label)
    if isinstance(model, Averaged):
        return model
    if not isinstance(model, HalfSpace):
        raise InputError(
            f"model must be em.Averaged(), em.Line() or em.HalfSpace() for a {label}, "
            f"got {model!r}, which is for a "
            "surface under a pressure."
        )
    if quantity != "friction":
        raise InputError(
            f"model must be em.Averaged() or em.Line() for {quantity}, got "
            f"{model!r}: "
            "it gives friction."
        )
    if model.seeds != 1 or model.periods is not None:
        raise InputError(
            f"model must be em.HalfSpace(cells=...) for a {label}, got {model!r}: "
            "seeds and periods are for a surface."
        )
    if model.cells is not None and model.cells % 2:
        raise InputError(
            f"cells must be an even whole number for a {label}, got {model.cells}."
        )
    return model


def of_rough(model: Any, surface: Any, pressure: Any) -> Model:
    """The model of a rough line, or of a surface, under a pressure or not. Raises
    `InputError`.
    """
    model = as_model(model)
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
            f"model must not be {model!r} on a rough line or surface: use "
            "em.Line(average=True) for the line averaged "
            "over directions, or em.Multiscale() for a surface under a pressure."
        )
    if isinstance(surface, RoughLine):
        raise InputError(
            f"model must be em.Line() for an em.RoughLine, got {model!r}, which is "
            "for a surface."
        )
    if pressure is None:
        raise InputError(
            f"model must be em.Line() for a surface without a pressure, got {model!r}."
        )
    return model


def hint_at_line(model: Any, surface: Any, asked: Asked) -> None:
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


def of_line(model: Any, call: str) -> Line:
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
