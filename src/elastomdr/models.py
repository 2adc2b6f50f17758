"""Models: what a body or a surface is computed with, as objects that carry their own
options.

Here is what bodies need; road models stand in `rough/road_models.py`, theories of leaks
in `seal/leak_theories.py`, and `verbs/roads.py` knows all that a body or a surface may
have.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from .checks import is_whole, positive_arrays, whole_number
from .errors import Advised, InputError, closest, either
from .units.arguments import constructor_in_si

if TYPE_CHECKING:
    from ._types import Number

_MOST_LINES = 1000  # of an ensemble


class Model:
    """A model of the contact; `model=` takes one of its kinds, or the name of one with
    its default options.
    """

    label: ClassVar[str]
    # on a smooth body: whether it is solved on the MDR line, whether averaged over the
    # directions of sliding, and then whether corrected for asymmetric contacts
    on_line: ClassVar[bool] = False
    over_directions: ClassVar[bool] = False
    corrected: bool = False
    marched: ClassVar[bool] = False  # whether elements are, in time steps

    def options(self) -> dict[str, object]:
        """The options that are not those by default."""
        fields = dataclasses.fields(self)  # pyright: ignore[reportArgumentType]
        given = {field.name: getattr(self, field.name) for field in fields}
        return {f.name: given[f.name] for f in fields if given[f.name] != f.default}

    def in_python(self) -> str:
        options = ", ".join(
            f"{name}={value!r}" for name, value in self.options().items()
        )
        return f"{type(self).__name__}({options})"


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
    on_line: ClassVar[bool] = True
    over_directions: ClassVar[bool] = True


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
    64, continued up to r = 1e5 and NaN beyond (`elastomdr.rough.line_problem`). Under a
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
    on_line: ClassVar[bool] = True

    def __post_init__(self) -> None:
        seeds_of(self.seeds)
        whole_number("periods", self.periods, 1)
        if self.samples is not None:
            whole_number("samples", self.samples, 64)
        if not isinstance(self.equivalent_length, str):
            positive_arrays({"equivalent_length": self.equivalent_length})


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Marched(Averaged):
    """The row of elements, integrated by diffrax: the same friction and rolling
    resistance by another way than the closed forms.

    Args:
        average: average over the directions of sliding, as the half-space needs; False
            for the bare line, on which layers of springs are computed in any case.
        corrected: as of `em.Averaged`.

    In steady motion every element has the same history: one passage of one element from
    rest, by exact contact steps, is the whole field. Steps are halved until the
    extrapolated limit is within `rtol`; `error` is what is left, and a point that
    misses `rtol` with the finest of them is NaN. `curve.elements(point)` has what the
    elements did. At rtol=1e-4 fifty times slower than `em.Averaged()`, at 1e-6 up to
    some thousand times; for numbers only.

    Source: Popov & Hess 2015, ch. 7; `docs/theory.md`.
    """

    average: bool = True
    label: ClassVar[str] = "marched"
    marched: ClassVar[bool] = True

    @property
    def over_directions(self) -> bool:  # type: ignore[override]
        return self.average


def named(*models: Model) -> str:
    """Models of which one is accepted, for an `InputError`: "em.Averaged() or
    em.Line()", of which scenes and the page say the names.
    """
    return either([Advised.of((f"em.{model.in_python()}", model)) for model in models])


KINDS: dict[str, type[Model]] = {kind.label: kind for kind in (Averaged, Line, Marched)}


def as_model(
    model: Model | str | None, kinds: Mapping[str, type[Model]] = KINDS
) -> Model | None:
    """A model from an object or the name of one of `kinds`; None stays None, for the
    default of the shape. Raises `InputError`.
    """
    if model is None or isinstance(model, Model):
        return model
    if isinstance(model, str) and model in kinds:
        return kinds[model]()
    raise InputError(
        argument="model",
        got=model,
        accepted=named(*(kind() for kind in kinds.values())) + ", or the name of one",
        hint=closest(model, kinds) if isinstance(model, str) else "",
    )


def seeds_of(seeds: int | Sequence[int]) -> tuple[int, ...]:
    """The seeds of an ensemble: that many from 0 on, or those given. Raises
    `InputError`.
    """
    if is_whole(seeds) and 1 <= seeds <= _MOST_LINES:
        return tuple(range(seeds))
    listed: Any = (
        seeds
        if hasattr(seeds, "__iter__") and not isinstance(seeds, str | bytes)
        else ()
    )
    each = tuple(listed)
    whole = all(is_whole(seed) and seed >= 0 for seed in each)
    if not each or not whole or len(set(each)) != len(each) or len(each) > _MOST_LINES:
        raise InputError(
            argument="seeds",
            got=seeds,
            accepted=f"a whole number from 1 to {_MOST_LINES}, or the seeds "
            "themselves, different whole numbers from 0 on",
        )
    return tuple(int(s) for s in each)
