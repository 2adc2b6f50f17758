"""Models: what a body or a surface is computed with, as objects that carry their own
options.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from .errors import InputError, closest
from .units.arguments import constructor_in_si

if TYPE_CHECKING:
    from ._types import Number

_MOST_LINES = 1000  # of an ensemble


class Model:
    """A model of the contact; `model=` takes one of its kinds, or the name of one with
    its default options.
    """

    label: ClassVar[str]


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Averaged(Model):
    """The MDR line averaged over directions: the default for a smooth body on a
    half-space.

    Args:
        corrected: apply the empirical correction for asymmetric contacts
            (`elastomdr.surface.direction.asymmetry`).

    Exact to first order in the loss; `model_error` bounds the rest. Source:
    `docs/theory.md`.
    """

    corrected: bool = True
    label: ClassVar[str] = "averaged"

    def __post_init__(self) -> None:
        _flag("corrected", self.corrected)


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Line(Model):
    """The line of the Method of Dimensionality Reduction, as in the textbook.

    Args:
        average: average over the directions of sliding (rough lines and surfaces).
        equivalent_length: length L [m] that turns the pressure p on a surface into the
            load p L of a line, or "full contact" for 2 m_2/m_3 of the spectrum's
            moments; by default the longest wave, 2 pi/q_low.
        seeds: number of lines with random phases that stand for a surface, or a list of
            their seeds.
        samples: samples of a line, 64 or more; by default eight per shortest wave, and
            more where that is too few.
        periods: length of a line in longest waves.

    Exact for layers of independent elements and for rough lines. It overstates the
    friction of a smooth body on a half-space by up to a factor of 2. On a surface,
    `error` is the numerical error plus twice the standard error over the lines, and NaN
    for a single line, whose scatter is not known.

    A surface under a pressure: the line does not see how waves of different length
    carry each other, and its friction falls with the cutoff ratio r = q_high/q_low
    without end. `model_error` is mu (F - 1), with F = 2.9 r^0.69 by default and with a
    given length, F = 1.45 r^0.16 by the rule of full contact, twice that with
    `average`: an upper envelope of three-dimensional over line friction at r from 4 to
    64, continued up to r = 1e5 and NaN beyond (`elastomdr.rough.line_bound`). Under a
    load per length or a depth it is NaN. Above r = 10 there is one `em.ModelWarning`;
    `em.Multiscale()` is the model for that.

    Source: Popov & Hess 2015, chapters 7 and 10; the bound is empirical.
    """

    average: bool = False
    equivalent_length: Number | Literal["full contact"] | None = None
    seeds: int | Sequence[int] = 1
    samples: int | None = None
    periods: int = 4
    label: ClassVar[str] = "line"

    def __post_init__(self) -> None:
        _flag("average", self.average)
        seeds_of(self.seeds)


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Multiscale(Model):
    """Friction of a randomly rough surface in closed integrals: the default for a
    surface under a pressure.

    It has no options and no random numbers. `model_error` bounds its distance from a
    three-dimensional solution.
    """

    label: ClassVar[str] = "multiscale"


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Persson(Model):
    """Persson's theory of rubber friction.

    Args:
        gamma: of the factor S = gamma + (1 - gamma) P^2 that reduces the stored energy,
            0 to 1; 1 for S = 1.
        stored: S also inside the integral for the contact area, as in later work.

    Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; Scaraggi and Persson, J.
    Phys.: Condens. Matter 27 (2015) 105102.
    """

    gamma: float = 0.5
    stored: bool = True
    label: ClassVar[str] = "persson"

    def __post_init__(self) -> None:
        _flag("stored", self.stored)
        if (
            isinstance(self.gamma, bool)
            or not isinstance(self.gamma, (int, float))
            or not 0 <= self.gamma <= 1
        ):
            raise InputError(f"gamma must be a number from 0 to 1, got {self.gamma!r}.")


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class HalfSpace(Model):
    """The three-dimensional half-space on a grid of cells, without reduction: for
    smooth bodies and for surfaces.

    Args:
        cells: cells along each side of the grid; by default enough for the body, or
            four per shortest wave.
        seeds: number of random maps that stand for a surface, or a list of their seeds.
        periods: side of a map in longest waves of the surface; by default as many as
            fit on the grid.
    """

    cells: int | None = None
    seeds: int | Sequence[int] = 1
    periods: int | None = None
    label: ClassVar[str] = "half-space"

    def __post_init__(self) -> None:
        seeds_of(self.seeds)
        if self.cells is not None:
            whole_number("cells", self.cells, 16)
        if self.periods is not None:
            whole_number("periods", self.periods, 1)


KINDS: dict[str, type[Model]] = {
    kind.label: kind for kind in (Averaged, Line, Multiscale, Persson, HalfSpace)
}


def as_model(model: Any) -> Model | None:
    """A model from an object or a name; None stays None, for the default of the shape.
    Raises `InputError`.
    """
    if model is None or isinstance(model, Model):
        return model
    if isinstance(model, str) and model in KINDS:
        return KINDS[model]()
    listed = ", ".join(
        f"em.{kind.__name__}() or {name!r}" for name, kind in KINDS.items()
    )
    hint = closest(model, KINDS) if isinstance(model, str) else ""
    raise InputError(f"model must be {listed}; got {model!r}.{hint}")


def whole_number(name: str, value: Any, least: int, most: int | None = None) -> None:
    """Raises `InputError` unless `value` is a whole number from `least` to `most`."""
    whole = hasattr(value, "__index__") and not isinstance(value, bool)
    if not whole or value < least or (most is not None and value > most):
        accepted = f"{least} or more" if most is None else f"{least} to {most}"
        raise InputError(f"{name} must be a whole number, {accepted}, got {value!r}.")


def seeds_of(seeds: Any) -> tuple[int, ...]:
    """The seeds of an ensemble: that many from 0 on, or those given. Raises
    `InputError`.
    """
    if (
        isinstance(seeds, int)
        and not isinstance(seeds, bool)
        and 1 <= seeds <= _MOST_LINES
    ):
        return tuple(range(seeds))
    listed: Any = (
        seeds
        if hasattr(seeds, "__iter__") and not isinstance(seeds, str | bytes)
        else ()
    )
    each = tuple(listed)
    whole = all(
        hasattr(s, "__index__") and not isinstance(s, bool) and s >= 0 for s in each
    )
    if not each or not whole or len(set(each)) != len(each) or len(each) > _MOST_LINES:
        raise InputError(
            f"seeds must be a whole number from 1 to {_MOST_LINES}, or the seeds "
            f"themselves, different whole numbers from 0 on, got {seeds!r}."
        )
    return tuple(int(s) for s in each)


def _flag(name: str, value: Any) -> None:
    if not isinstance(value, bool):
        raise InputError(f"{name} must be True or False, got {value!r}.")
