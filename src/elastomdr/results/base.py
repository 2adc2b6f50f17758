"""What every result is: fields that know their name and unit, and the tables, texts and
figures that follow from them.

A result is a frozen dataclass, declared with `@record`, whose fields are of three
kinds:

- `quantity(label, unit, meaning)`: numbers, one per point unless its `dims` say
  otherwise;
- `setting()`: what is no number and JAX does not see, such as the model's name;
- any other: something that the result carries along, such as a `Contact`, which has
  quantities of its own.

Doubts of its numbers are data (`results/doubts.py`), said once and in one place:

- A verb hands over those that it finds: `marks=(Doubt("hot branch", points, says,
  remedy), ...)`. `points` is a bool array of the shape of `converged`, all False where
  the verb looked and found nothing; `says` follows "3 of 27 points ", "" for the usual
  words of the kind. `call/extrapolation.py` makes those of the material.
- Those that follow from fields are no second truth: `Result.examined` makes them of
  `converged` and `model_error` ("not converged", "no prediction", "bound"). A class
  with more fields of this sort overrides it, `yield from super().examined()` first.
- What is made from results hands on theirs: `marks=carried(result.examined(), change)`,
  where `change` takes a mask to the points of the new result.
- Tables, files, figures, summaries, stacks and draws follow from `doubts`.
"""

import abc
import dataclasses
import importlib
import io
import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    NamedTuple,
    Protocol,
    Self,
    TypeVar,
    dataclass_transform,
)

import numpy as np

from .. import __version__
from ..arrays import xp
from ..checks import (
    as_float64,
    is_traced,
    known,
    require,
    significant,
    untraced,
)
from ..errors import InputError
from ..files import as_path, csv_text, write_files
from ..notebook_tables import html_figure, html_table
from ..trees import pytree, replaced
from .axes import Axis, Curve, Quantity, curves, dimensions, place_in_words
from .doubts import (
    FLAGS,
    TITLE,
    Doubt,
    carried,
    counted_kinds,
    flags,
    found,
    kinds_of_points,
    where,
)
from .words import in_unit, span

if TYPE_CHECKING:
    import jax
    import pandas
    import plotly.graph_objects  # pyright: ignore[reportMissingImports]
    import xarray
    from matplotlib.axes import Axes

    from .._types import Style
    from .plot_contacts import SteadyElements
    from .plotting import DrawAsk

    Draw = Callable[[Any, DrawAsk], Axes]
    Array = jax.Array | np.ndarray
else:
    Array = np.ndarray

T = TypeVar("T")
# rows of draws that are said of the first that has them: each draw has its own numbers
_OF_A_DRAW = ("heights", "direction")


def quantity(
    label: str,
    unit: str,
    meaning: str = "",
    *,
    default: Any = dataclasses.MISSING,
    dims: str = "...",
    axis: str = "",
    shown: str = "",
) -> Any:
    """A field of numbers of a result; with `default=None` one that may be missing."""
    metadata = {"quantity": Quantity(label, unit, meaning, dims, axis, shown)}
    return dataclasses.field(default=default, metadata=metadata)


def setting(*, default: Any = dataclasses.MISSING) -> Any:
    """A field that JAX does not see: it has to be hashable, and is part of what a
    compiled program depends on.
    """
    return dataclasses.field(default=default, metadata={"static": True})


@dataclass_transform(
    kw_only_default=True,
    frozen_default=True,
    eq_default=False,
    field_specifiers=(quantity, setting),
)
def record(cls: type[T]) -> type[T]:
    """Declares a class of results."""
    return pytree(
        dataclasses.dataclass(frozen=True, kw_only=True, eq=False, repr=False)(cls)
    )


@dataclass_transform(
    frozen_default=True, eq_default=False, field_specifiers=(quantity, setting)
)
def part(cls: type[T]) -> type[T]:
    """Declares a class of what results carry along, such as the edges of a contact;
    made by position.
    """
    return pytree(dataclasses.dataclass(frozen=True, eq=False)(cls))


_EXTRAPOLATED = Quantity(
    "beyond the range of the material",
    "",
    "None where the range of the material is not known",
    path="extrapolated",
)
# standard deviations on both sides that hold 95 %
NORMAL = 1.96
# relative bound of a model from which on it is a doubt
WIDE = 0.5


class _Ends(NamedTuple):
    low: np.ndarray
    median: np.ndarray
    high: np.ndarray


class Band(_Ends):
    """Lower end, median and upper end over draws, with the doubts of any of them."""

    doubts: tuple[Doubt, ...] = ()


class Change(NamedTuple):
    """One thing changed in a call."""

    shorter: float = 1.0  # factor on the upper cutoff of a surface
    higher: float = 1.0  # factor on its heights
    sampled: float = 0.0  # standard errors by which its measured spectrum is off
    kelvin: float = 0.0  # by which the rubber is warmer
    wider: float | None = None  # factor on the range of its moduli, at each end
    beyond: float | None = None  # decades from there to a branch, as `beyond_data`
    stress: float = 1.0  # factor on the shear stress
    conducts: int | None = None  # as `Heat.at_end`


class Assumed(NamedTuple):
    """What is typical in a call, in words, and what is changed to either end of it."""

    says: str
    low: Change
    high: Change


class RoadErrors(NamedTuple):
    """How well a road is known: relative standard deviations, log-normal; 0 where that
    is not stated.
    """

    level: float = 0.0  # of C, the same at all wave numbers
    cutoff: float = 0.0  # of its upper cutoff

    def words(self) -> str:
        """What is stated."""
        return " and ".join(x.says for x in (self.heights(), self.end()) if x)

    def heights(self) -> Assumed | None:
        """The ends of 95 % of its heights."""
        return _ends("C", self.level, lambda x: Change(higher=x**0.5))

    def end(self) -> Assumed | None:
        """The ends of 95 % of its shortest wave."""
        return _ends("its upper cutoff", self.cutoff, lambda x: Change(shorter=x))


def _ends(what: str, size: float, change: Callable[[float], Change]) -> Assumed | None:
    factor, says = math.exp(NORMAL * size), f"{what} to +- {size:.2g} (one sigma)"
    return Assumed(says, change(factor), change(1 / factor)) if size else None


NOT_STATED = RoadErrors()


class Again(Protocol):
    """The call of a curve, once more."""

    @property
    def measured(self) -> bool:
        """Whether the surface was measured, and has sampling errors."""
        ...

    @property
    def material(self) -> object:
        """The rubber, as the verb was given it."""
        ...

    @property
    def bands(self) -> list[Assumed | None]:
        """What is typical and not measured of shear law and heat."""
        ...

    @property
    def errors(self) -> RoadErrors:
        """How well the road is known, where that was stated."""
        ...

    def of(
        self, material: object, errors: RoadErrors | None = None, road: object = None
    ) -> "Again":
        """The call of another material, and of a road of which the errors are stated."""
        ...

    def at(self, places: dict[str, np.ndarray]) -> "Again":
        """The call at other points."""
        ...

    def curve(self, change: Change) -> "Result | None":
        """The curve with one thing changed; None where that has no answer."""
        ...

    def elements(self, point: int, leading: float) -> "SteadyElements":
        """What the elements do under a point, whose leading edge [m] is known. Raises
        `InputError`.
        """
        ...


class Origin(NamedTuple):
    """One of the results that `Result.stack` has joined."""

    name: str  # of the material
    model: str
    inputs: tuple[tuple[str, str], ...]
    missing: frozenset[str]  # fields it did not have
    length: int | None  # of its last axis, where that was extended


def distinct(names: Sequence[str]) -> list[str]:
    """Names of materials along an axis: of equal ones the second becomes "name (2)"."""
    return [
        f"{n} ({1 + list(names[:i]).count(n)})" if n in names[:i] else n
        for i, n in enumerate(names)
    ]


class WithTable(abc.ABC):
    """What has one table, exported in every form."""

    @abc.abstractmethod
    def header(self) -> list[str]:
        """What is said of the table, line by line."""

    @abc.abstractmethod
    def columns(self) -> dict[str, np.ndarray]:
        """The columns by their titles with units."""

    def csv(self) -> str:
        """The text that `to_csv` writes."""
        return csv_text(self.header(), self.columns())

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes a comma-separated table, its first lines a header that starts with "#
        ".

        Opens with `pandas.read_csv(path, comment="#")` and in a spreadsheet. Numbers
        have as many digits, up to 17, as it takes to read back the same float64; one
        that is not known, since its point failed, is an empty cell. The file appears
        when it is complete, or not at all. Raises `InputError` where it cannot be
        written, and for a name that ends in .xlsx.
        """
        if as_path(path).suffix.lower() in (".xlsx", ".xls"):
            raise InputError(
                argument="path",
                got=str(path),
                accepted="no workbook",
                hint="for one use to_excel",
            )
        write_files({as_path(path): self.csv().encode()})

    def _sheets(self) -> dict[str, list[list[Any]]]:
        """The table, then its header lines."""
        columns = self.columns()
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        inputs = [[line] for line in self.header()]
        return {"result": [list(columns), *map(list, rows)], "inputs": inputs}

    def to_excel(self, path: str | os.PathLike[str]) -> None:
        """Writes an Excel workbook: the table, then what is said of it, of a result
        also what the columns mean.

        Raises `InputError` for a name that does not end in .xlsx, without openpyxl, and
        where it cannot be written.
        """
        if as_path(path).suffix.lower() != ".xlsx":
            raise InputError(
                argument="path",
                got=str(path),
                accepted="the name of a file that ends in .xlsx",
                hint="for a table of text use to_csv",
            )
        book = _package("openpyxl", "excel").Workbook()
        book.active.title = "result"
        book.active.freeze_panes = "A2"
        for name, lines in self._sheets().items():
            sheet = book[name] if name in book.sheetnames else book.create_sheet(name)
            fill_sheet(sheet, lines)
        buffer = io.BytesIO()
        book.save(buffer)
        write_files({as_path(path): buffer.getvalue()})

    def summary(self) -> str:
        """What is said of the table, in a few lines."""
        return "\n".join(self.header())

    def to_dict(self) -> dict[str, np.ndarray]:
        """The title of each column to its values."""
        return self.columns()

    def to_pandas(self) -> "pandas.DataFrame":
        """A pandas DataFrame of `columns()`, what is said of them as `attrs`. Raises
        `InputError` without pandas.
        """
        frame = _package("pandas", "tables").DataFrame(self.columns())
        frame.attrs.update(self._attributes())
        return frame

    def to_xarray(self) -> "xarray.Dataset":
        """An xarray Dataset of the columns, over the row. Raises `InputError` without
        xarray.
        """
        _package("xarray", "tables")
        return self.to_pandas().to_xarray()

    def _attributes(self) -> Mapping[str, object]:
        """What is said of a table, by name."""
        return {"header": self.header()}


@record
class Result(WithTable):
    """A result: quantities of one shape, which is that of its points, and in words what
    they were computed from.
    """

    error: Array = quantity("estimated error", "-")
    converged: Array = quantity(
        "converged", "", "whether the error was met; if not, the point is NaN"
    )
    marks: tuple[Doubt, ...] = ()  # those that the verb found, or looked for in vain
    model: str = setting()  # its name, in words
    # what was computed and skipped, of a type for each verb; of several materials a
    # tuple
    plan: Any = setting()
    # the call once more, where a verb has one (`Again`); likewise
    again: Again | tuple[Again | None, ...] | None = setting(default=None)
    # of draws the call of what they are draws of
    once: Again | None = setting(default=None)
    # name and value of each argument, in words
    inputs: tuple[tuple[str, str], ...] = setting()
    # the materials along the first axis, if that is theirs
    origins: tuple[Origin, ...] = setting(default=())
    drawn: bool = setting(default=False)  # whether the materials are draws of one

    title: ClassVar[str]  # of a figure
    # the field along the horizontal axis of a figure
    across: ClassVar[str] = "velocity"
    shows: ClassVar[str]  # the field along its vertical axis
    # what draws it, as "module.function" of this room
    figure: ClassVar[str] = "plotting.draw"
    error_of: ClassVar[str]  # what `error` is the error of, in a sentence
    each: ClassVar[str] = "points"  # what one value of a field belongs to
    # name of the last axis where every result of the class has it
    last: ClassVar[str] = ""
    # of the horizontal axis: "log", or "auto" where the values are crowded
    scale: ClassVar[str] = "linear"
    # the field that `model_error` is of, "" for the one that is shown; whether relative
    bound_of: ClassVar[str] = ""
    relative_bound: ClassVar[bool] = False
    # why `extrapolated` is None
    unflagged: ClassVar[str] = "not known: no point is marked as extrapolated"
    from_zero: ClassVar[bool] = True  # whether the vertical axis begins at zero
    # after which an axis may be called: of several quantities that change along it, the
    # first
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "velocity",
        "temperature",
        "pressure",
        "direction",
        "normal_force",
        "force",
        "depth",
    )

    # ------------------------------------------------------------------------------------------
    # numbers

    def quantities(self) -> list[Quantity]:
        """What the fields of numbers are, in the order of a table; those that are None
        are left out.
        """
        every = [*_quantities(self, ""), _EXTRAPOLATED]
        # of each class, in the last columns
        common = ("error", "model_error", "converged", "extrapolated")
        every.sort(key=lambda q: common.index(q.path) if q.path in common else -1)
        keys = [
            q.path.rpartition(".")[2] if q.dims in ("...", "") else "" for q in every
        ]
        named = (
            q._replace(
                key=key
                if key and (q.path == key or keys.count(key) == 1)
                else q.path.replace(".", "_")
            )
            for q, key in zip(every, keys, strict=True)
        )
        return [self.describe(q) for q in named if self._value(q) is not None]

    def describe(self, q: Quantity) -> Quantity:
        """A quantity as it is in this result, where label or unit depend on what was
        computed.
        """
        return q

    def _value(self, q: Quantity) -> Any:
        value: Any = self
        for attribute in q.path.split("."):
            value = None if value is None else getattr(value, attribute)
        return value

    def fields(self, dims: str | None = "...") -> dict[Quantity, np.ndarray]:
        """The quantities of one kind of dimensions (None: all) as arrays. Raises
        `InputError` while JAX traces them.
        """
        untraced(
            InputError(
                argument=type(self).__name__,
                accepted="made into tables outside jit, grad and vmap",
            ),
            self,
        )
        return {
            q: np.asarray(self._value(q))
            for q in self.quantities()
            if dims is None or q.dims == dims
        }

    @property
    def materials(self) -> tuple[str, ...]:
        """Names along the first axis, where that is an axis of materials."""
        return tuple(origin.name for origin in self.origins)

    def axes(self) -> list[Axis]:
        """The axes of the quantities by name, such as material, temperature and
        velocity, with their values.
        """
        fields = self.fields()
        if not self.origins:
            return dimensions(fields, self.coordinates, self.last)
        rest = dimensions(
            {q: values[0] for q, values in fields.items()}, self.coordinates, self.last
        )
        return [Axis("material", np.array(self.materials)), *rest]

    def curves(self, along: str = "velocity") -> tuple[Axis, list[Curve]]:
        """One axis, the one named `along` or else the last, and where the curves along
        it are, with their labels.
        """
        return curves(self.axes(), along)

    # ------------------------------------------------------------------------------------------
    # doubts

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """What there is to doubt in these numbers: kind, points, why, and what would
        help. Under JAX all that was looked for, since its points are not known.
        """
        return found(self.examined())

    @property
    def extrapolated(self) -> Array | None:
        """Where the material is used beyond the range of its data; None: not known."""
        return where(self.marks, "extrapolated")

    def examined(self) -> Iterator[Doubt]:
        """All doubts that were looked for, those that hold at no point too."""
        yield from self.marks
        # what a compiled program has returned is read as NumPy's
        name = self.bound_of or self.shows
        bound, others = (
            getattr(self, field, None) for field in ("model_error", "other_states")
        )
        converged, size, bound, others = known(
            (self.converged, getattr(self, name), bound, others)
        )
        yield Doubt("not converged", xp.logical_not(converged))
        if others is not None:
            yield Doubt("hot branch", xp.logical_and(others, converged))
        if bound is None:
            return
        of = f"the {type(self).__dataclass_fields__[name].metadata['quantity'].label}"
        unknown = xp.logical_and(xp.isnan(bound), converged)
        told = where(self.marks, "no prediction")
        if told is not None:
            unknown = xp.logical_and(unknown, xp.logical_not(told))
        says = f"have no bound on the model for {of}: none was established there"
        yield Doubt("no prediction", unknown, says, "a measured value to compare with")
        if not any(doubt.kind == "bound" for doubt in self.marks):
            half = WIDE * (1.0 if self.relative_bound else xp.abs(size))
            wide = xp.logical_and(bound > half, converged)
            yield Doubt("bound", wide, f"have a bound on the model above half of {of}")

    # ------------------------------------------------------------------------------------------
    # materials

    @classmethod
    def stack(
        cls,
        results: Sequence[Self],
        names: Sequence[str],
        drawn: tuple[str, str] | None = None,
        once: Again | None = None,
    ) -> Self:
        """Joins results of the same call for several materials along a new first axis,
        "material".

        Args:
            results: results of this class, of one shape; a spectrum may have fewer
                branches than another.
            names: the name of each material; of equal ones the second becomes "name
                (2)".
            drawn: where they are draws of one material, which, and what differs, in
                words.
            once: the call of what they are draws of.

        Raises `InputError`.
        """
        if (
            not results
            or len(names) != len(results)
            or any(type(r) is not type(results[0]) for r in results)
        ):
            raise InputError(
                argument="results",
                got=[type(r).__name__ for r in results],
                accepted=f"of one class, with a name each, and there are {len(names)} "
                "names",
            )
        unique = distinct(names)
        lengths = [
            np.shape(r.converged)[-1] if np.ndim(r.converged) else None for r in results
        ]
        ragged = len(set(lengths)) > 1
        origins = tuple(
            Origin(name, r.model, r.inputs, _missing(r), length if ragged else None)
            for name, r, length in zip(unique, results, lengths, strict=True)
        )
        of_all = {
            "model": "; ".join(dict.fromkeys(r.model for r in results)),
            "plan": tuple(r.plan for r in results),
            "again": tuple(r.again for r in results),
            "once": once,
            "inputs": tuple(_joined_inputs(results, unique, drawn).items()),
            "origins": origins,
            "drawn": drawn is not None,
            "marks": _joined_marks(results, drawn is not None),
        }
        return _joined(list(results), of_all)

    def select(self, material: str) -> Self:
        """The result of one of the materials. Raises `InputError` for a name that is
        not among them.
        """
        if material not in self.materials:
            raise InputError(
                argument="material",
                got=material,
                accepted=f"one of {', '.join(self.materials) or 'none'}",
            )
        i = self.materials.index(material)
        _, model, inputs, missing, length = self.origins[i]
        inputs = [pair for pair in inputs if pair[0] != "material"]
        return dataclasses.replace(
            _part(self, i, length, missing),
            model=model,
            plan=self.plan[i] if isinstance(self.plan, tuple) else self.plan,
            again=self.again[i] if isinstance(self.again, tuple) else self.again,
            inputs=(("material", material), *inputs),
            origins=(),
            drawn=False,
            marks=_marks_of(self.marks, i, length, missing),
        )

    def each_material(self) -> Iterator[Self]:
        """The result of each material; itself where there is no axis of materials."""
        yield from (
            (self.select(name) for name in self.materials) if self.origins else (self,)
        )

    # ------------------------------------------------------------------------------------------
    # draws

    def band(self, share: float = 0.95) -> Band:
        """Of the main field of a result for draws of a material: the lower end of an
        interval, median, upper end; with the `doubts` of any draw.

        Args:
            share: of the draws that lies in the interval, those below and above it
                alike.

        Raises `InputError` where the materials are no draws.
        """
        if not self.drawn:
            raise InputError(
                argument="material",
                got=list(self.materials),
                accepted="a list of draws, as of em.fit.material(...).draws(n), to "
                "have a band",
            )
        require(
            "share",
            as_float64("share", share),
            "between 0 and 1",
            lambda x: (x > 0) & (x < 1),
        )
        ends = [0.5 - 0.5 * share, 0.5, 0.5 + 0.5 * share]
        band = Band(
            *_over_draws(
                lambda x: np.nanquantile(x, ends, axis=0), getattr(self, self.shows)
            )
        )
        band.doubts = found(_of_draws(self.examined()))
        return band

    def typical(self) -> Self:
        """The median over draws of every field, without an axis of materials. Raises
        `InputError` as `band`.
        """
        self.band()
        plan = self.plan[0] if isinstance(self.plan, tuple) else self.plan
        return dataclasses.replace(
            _median(self),
            plan=plan,
            again=self.once,
            origins=(),
            drawn=False,
            marks=_of_draws(self.marks),
        )

    # ------------------------------------------------------------------------------------------
    # words

    def heading(self) -> str:
        """A title: what was computed, and the material where it is known."""
        material = dict(self.inputs).get("material")
        if material in (None, "", "given directly"):
            return self.title
        return f"{self.title}, {material}"

    def headline(self) -> Iterator[tuple[str, str]]:
        """What a command prints: the largest and the smallest value and where, how sure
        they are, what they rest on, and how many points each kind of doubt is about.
        """
        one = self.typical() if self.drawn else self
        kind, said, top = one.extremes(np.arange(np.size(one.converged)))
        yield kind, said
        if top is not None:
            drawn = (f"{name}: {said}; each: " for name, said in self._spread())
            yield "how sure", "".join(drawn if self.drawn else ()) + one._sure(top)
        rests = [*one._rests_on(), one._left_out(top or 0, self._rubber_drawn())]
        yield "rests on", "; ".join(filter(None, rests))
        yield "doubts", counted_kinds(self.doubts) or "none"

    def extremes(self, points: np.ndarray) -> tuple[str, str, int | None]:
        """Whether the largest value of these points is a peak, the largest and the
        smallest in words, and which point the largest is; None where none converged.
        """
        shown = self.told()
        about = next(q for q in self.quantities() if q.path == shown)
        values = np.ravel(self._value(about))[points]
        points, values = points[np.isfinite(values)], values[np.isfinite(values)]
        if not points.size:
            return "largest", f"none of the {self.each} converged", None
        top, least = int(points[values.argmax()]), int(points[values.argmin()])
        kind, end = self._top(top)
        said = f"{about.label} {self._point(about, top)}{end}"
        if values.min() < values.max():
            said += f"; smallest {self._point(about, least)}"
        return kind, said, top

    def _top(self, i: int) -> tuple[str, str]:
        """Whether a largest value is a peak along its curve, and else at which end."""
        axes = self.axes()
        places = np.unravel_index(i, np.shape(self.converged))
        for axis, j in zip(axes, places, strict=True):
            x = axis.values
            if axis.name == (self.last or self.across) and axis.known and x.size > 1:
                if x.min() < x[j] < x.max():
                    return "peak", ""
                end = "lowest" if x[j] == x.min() else "highest"
                timed = axis.name == "time"
                return "largest", "" if timed else f", the {end} {axis.name} computed"
        return "largest", ""

    def _point(self, about: Quantity, i: int) -> str:
        """One value of a field with its unit, and where it is."""
        value, shape = np.ravel(self._value(about))[i], np.shape(self.converged)
        unit = about.shown or about.unit
        number = significant(float(in_unit(value, about.shown)), 3)
        where = self._place(i)
        said = number if unit == "-" else f"{number} {unit}"
        some = (doubt for doubt in self.doubts if not np.all(doubt.points))
        kinds = kinds_of_points(some, shape).ravel()[i]
        return (
            said + (f" at {where}" if where else "") + (f" ({kinds})" if kinds else "")
        )

    def _place(self, i: int) -> str:
        """Where a point is, on the axes that have more than one place."""
        places = np.unravel_index(i, np.shape(self.converged))
        return ", ".join(
            place_in_words(axis, int(j))
            for axis, j in zip(self.axes(), places, strict=True)
            if axis.values.size > 1
        )

    def _sure(self, i: int) -> str:
        """How sure the value of a point is, or else those of all points."""
        error, bound = np.asarray(self.error), getattr(self, "model_error", None)
        if np.all(error == 0):
            said = "no error of the computation"
        else:
            most = self._with_unit("error", np.fmax.reduce(error, axis=None), 2)
            said = f"error of the computation of {self.error_of}: at most {most}"
        if bound is None:
            return said
        if not np.isfinite(bound).any():
            return f"no bound on the model; {said}"
        if np.all(bound == 0):
            return f"{said}; the model is exact"
        if self.relative_bound:
            return f"{said}; bound on the model: {span(100 * bound, '%')} of the value"
        unit = self._unit("model_error")
        of = "bound on the model" if unit else "bound on the model, absolute"
        return f"{said}; {of}: {span(bound, unit)}"

    def _unit(self, path: str) -> str:
        """The unit of a field, "" where it has none."""
        unit = next(q.unit for q in self.quantities() if q.path == path)
        return "" if unit == "-" else unit

    def _with_unit(self, path: str, value: Array, digits: int) -> str:
        return f"{significant(float(value), digits)} {self._unit(path)}".strip()

    def _rests_on(self) -> Iterator[str]:
        """Material and model, in short."""
        yield dict(self.inputs).get("material", "")
        yield self.short_model()

    def _left_out(self, i: int, drawn: bool) -> str:
        """What the band of a point leaves out, where it has one; `drawn`: it holds what
        draws of the rubber change.
        """
        return ""

    def _rubber_drawn(self) -> bool:
        """Whether these are draws of the rubber, and not of its road alone."""
        call = self.once
        return self.drawn and (
            call is None or any(x is not call.material for x in self._rubbers())
        )

    def _rubbers(self) -> list[object]:
        """The rubbers of the calls of several materials."""
        every = self.again if isinstance(self.again, tuple) else ()
        return [each.material for each in every if each]

    def short_model(self) -> str:
        """The name of the model, without what it means."""
        return self.model.split(" (")[0].split(";")[0]

    def told(self) -> str:
        """The field that the first line is of."""
        return self.shows

    def findings(self) -> Iterator[tuple[str, str]]:
        """What went in and what came out, as pairs of a name and a text."""
        yield "quantity", self.title
        yield from self.inputs
        yield "model", self.model
        if self.drawn:
            yield from (
                ("median, " + key, sentence)
                for key, sentence in self.typical().outcome()
            )
            yield from self._spread()
        for one in () if self.drawn else self.each_material():
            name = f"{dict(one.inputs)['material']}: " if self.origins else ""
            yield from ((f"{name}{key}", sentence) for key, sentence in one.outcome())
        yield self.each, self.reached()
        for doubt in self.doubts:
            yield doubt.kind, self._whose(doubt) + doubt.words()
        if self.extrapolated is None and "range of the data" not in dict(self.inputs):
            yield "range of the data", self.unflagged

    def _whose(self, doubt: Doubt) -> str:
        """Which materials a doubt is of, where it is not of all."""
        if not self.origins or self.drawn:
            return ""
        points = np.reshape(doubt.points, (len(self.origins), -1)).any(axis=1)
        names = np.array(self.materials)[points]
        return "" if points.all() else f"{', '.join(names)}: "

    def _spread(self) -> Iterator[tuple[str, str]]:
        """Where 95 % of the draws lie, where their median is largest."""
        low, middle, high = (np.ravel(x) for x in self.band())
        if np.isfinite(middle).any():
            i = int(np.nanargmax(middle))
            ends = f"{significant(float(low[i]))} to {significant(float(high[i]))}"
            yield (
                "95 % of the draws",
                f"{ends} where the median is largest, {significant(float(middle[i]))}",
            )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """What came out, for a result without an axis of materials."""
        yield from ()

    def counted(self) -> tuple[int, int]:
        """How many points failed, of how many."""
        good = np.asarray(self.converged)
        # the last axis divides each point
        good = good[..., 0] if self.last and self.each == "points" else good
        return int(np.sum(~good)), good.size

    def reached(self, also: str = "") -> str:
        """How many points converged, what `also` was counted, and the largest estimated
        error.
        """
        (failed, count), error = self.counted(), np.asarray(self.error)
        sentence = (
            f"{count}, "
            f"{f'{failed} did not converge' if failed else 'all converged'}{also}"
        )
        if np.isfinite(error).any():
            largest = self._with_unit("error", np.fmax.reduce(error, axis=None), 2)
            sentence += (
                f"; error of the computation of {self.error_of}, at most: {largest}"
            )
        return sentence

    def summary(self) -> str:
        """What went in and what came out, in a few lines of text."""
        if is_traced(self):
            return repr(self)
        findings = list(self.findings())
        width = max(len(name) for name, _ in findings) + 2
        return "\n".join(f"{name:<{width}}{sentence}" for name, sentence in findings)

    def __repr__(self) -> str:
        values = [self._value(q) for q in _quantities(self, "")]
        values = [value for value in values if value is not None]
        main = (self.error, self.converged, getattr(self, self.shows))
        if all(hasattr(value, "dtype") for value in (*main, *values)) and not is_traced(
            self
        ):
            return f"{type(self).__name__}\n{self.summary()}"
        shapes = sorted(
            {str(np.shape(value)) for value in values if hasattr(value, "dtype")}
        )
        return (
            f"{type(self).__name__}({self.model}; without numbers, shape "
            f"{' or '.join(shapes) or 'unknown'})"
        )

    def _repr_html_(self) -> str:
        lines = repr(self).splitlines()
        if len(lines) == 1:  # without numbers there is nothing but that line
            return html_table(lines[0], ())
        table = html_table(lines[0], self.findings())
        if np.count_nonzero(self.converged) < 2:  # a point is no curve
            return table
        return table + html_figure(self.plot(style="paper"))

    # ------------------------------------------------------------------------------------------
    # tables and files

    def columns(self) -> dict[str, np.ndarray]:
        """Column title with its unit, such as "velocity [m/s]", to the values,
        flattened in C order; the last one names the kinds of doubts of each point.
        """
        fields = self.fields()
        columns = {q.title: values.ravel() for q, values in fields.items()}
        shape = np.shape(self.converged)
        columns[TITLE] = kinds_of_points(self.doubts, shape).ravel()
        if not self.origins:
            return columns
        shape = next(iter(fields.values())).shape
        names = np.repeat(np.array(self.materials), int(np.prod(shape[1:])))
        # of a shorter spectrum
        padding = np.all(
            [np.isnan(x) for x in columns.values() if x.dtype.kind == "f"], axis=0
        )
        return {
            title: values[~padding]
            for title, values in {"material": names, **columns}.items()
        }

    def header(self) -> list[str]:
        """What a table has to carry besides its numbers: version, inputs, model,
        findings, one line each.
        """
        return [
            f"elastomdr {__version__}: {type(self).__name__}",
            "units: SI, in brackets in the column titles",
            *(f"{name}: {sentence}" for name, sentence in self.findings()),
        ]

    def _sheets(self) -> dict[str, list[list[Any]]]:
        """The table, then what went in and came out, then what the columns mean."""
        meanings = [[q.label, q.path, q.unit, q.meaning] for q in self.fields()]
        return super()._sheets() | {
            "inputs": [["elastomdr", __version__], *map(list, self.findings())],
            "columns": [["column", "field", "unit", "meaning"], *meanings],
        }

    def to_dict(self) -> dict[str, Any]:
        """Field name to an array of the result's shape, in SI units; with "model",
        "plan" and "inputs" in words, and "doubts".
        """
        values: dict[str, Any] = {"material": self.materials} if self.origins else {}
        values |= {q.key: value for q, value in self.fields().items()}
        values |= {q.key: value for q, value in self.fields("").items()}
        plan = (
            "; ".join(dict.fromkeys(map(str, self.plan)))
            if isinstance(self.plan, tuple)
            else str(self.plan)
        )
        words = {"model": self.model, "plan": plan, "inputs": dict(self.inputs)}
        return values | words | {"doubts": self.doubts}

    def to_xarray(self) -> "xarray.Dataset":
        """An xarray Dataset, its axes what was given (velocity, temperature, load).
        Raises `InputError` without it.
        """
        xarray = _package("xarray", "tables")
        axes = self.axes()
        units = {
            axis.name: {"units": axis.quantity.unit} if axis.quantity else {}
            for axis in axes
        }
        coordinates = {
            axis.name: (axis.name, axis.values, units[axis.name])
            for axis in axes
            if axis.known
        }
        names, data = tuple(axis.name for axis in axes), {}
        for q, values in self.fields(None).items():
            series = q.dims.removeprefix("...")
            leading = names if "..." in q.dims else names[: len(self.origins) > 0]
            if q.key not in coordinates:
                about = {"long_name": q.label, "units": q.unit} | (
                    {"description": q.meaning} if q.meaning else {}
                )
                data[q.key] = ((*leading, *series.split()), values, about)
        data[TITLE] = names, flags(self.doubts, np.shape(self.converged)), FLAGS
        return xarray.Dataset(data, coords=coordinates, attrs=self._attributes())

    def _attributes(self) -> Mapping[str, object]:
        """Inputs, model, version and doubts."""
        said = dict.fromkeys(doubt.kind for doubt in self.doubts)
        doubts = {
            f"doubt, {kind}": "; ".join(
                self._whose(doubt) + doubt.words()
                for doubt in self.doubts
                if doubt.kind == kind
            )
            for kind in said
        }
        about = {"model": self.model, "elastomdr": __version__}
        return {**dict(self.inputs), **about, **doubts}

    # ------------------------------------------------------------------------------------------
    # figures

    def plot(
        self,
        ax: "Axes | None" = None,
        style: "Style | None" = None,
        *,
        title: str | None = None,
        label: str | None = None,
    ) -> "Axes":
        """Draws the result and returns the matplotlib Axes.

        Args:
            ax: axes to draw on; None for a new figure, which is the `.figure` of the
                answer. Several results on the same axes share a legend that says what
                they differ in.
            style: None, or "paper" for a column of 85 mm: small print, no title.
            title: instead of the quantity and the material.
            label: of this result in the legend.
        """
        from .plotting import DrawAsk

        module, function = self._figure().split(".")
        drawing = importlib.import_module(f".{module}", __package__)
        return self._draw(getattr(drawing, function), DrawAsk(ax, style, title, label))

    def _figure(self) -> str:
        """What draws this result, as "module.function" of this room."""
        return self.figure

    def _check_shown(self, show: str, *shown: str) -> None:
        """Raises `InputError` unless `show` is one of these fields or, where none are
        named, one of those that have a unit and are no coordinate.
        """
        fields = shown or [
            q.path
            for q in self.quantities()
            if q.unit and q.path not in self.coordinates
        ]
        if show not in fields:
            raise InputError(
                argument="show", got=show, accepted=f"one of {', '.join(fields)}"
            )

    def _draw(self, draw: "Draw", ask: "DrawAsk") -> "Axes":
        """Draws each material on the same axes."""
        ax, group = ask.ax, bool(self.origins)
        for one in self.each_material():
            label = ask.label
            if group and label:
                label = f"{label}, {dict(one.inputs)['material']}"
            ax = draw(one, ask._replace(ax=ax, label=label, group=group))
        assert ax is not None
        return ax

    def interactive(
        self, title: str | None = None, **options: Any
    ) -> "plotly.graph_objects.Figure":
        """The figure of `plot` as one of plotly, to read values off, zoom and switch
        curves off in a notebook; `write_html` makes a page of it.

        Args:
            title: instead of the quantity and the material.
            options: those of `plot`.

        Returns:
            A plotly figure of the same curves, bands and points.

        Raises:
            InputError: without plotly, and as `plot`.
        """
        from .chart import as_plotly

        plotly = _package("plotly.subplots", "interactive")
        make = plotly.subplots.make_subplots
        return as_plotly(make, self.plot(title=title, **options))


@record
class AbstractPoints(Result):
    """A result of the points of a curve."""

    velocity: Array = quantity("velocity", "m/s", "velocity v", axis="sliding velocity")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    pressure: Array | None = quantity(
        "nominal pressure", "Pa", "of a surface", default=None, shown="MPa"
    )
    model_error: Array | None = quantity(
        "bound on the error of the model",
        "-",
        "bound on the model's error of the coefficient, absolute",
        default=None,
    )


def _package(name: str, extra: str) -> Any:
    """An optional package. Raises `InputError` with what to install where there is
    none.
    """
    try:
        return __import__(name)
    except ImportError as error:
        raise InputError(
            argument=name.partition(".")[0],
            accepted="installed for this",
            hint=f"pip install elastomdr[{extra}]",
        ) from error


def _quantities(record: Any, path: str) -> Iterator[Quantity]:
    for f in dataclasses.fields(record) if dataclasses.is_dataclass(record) else ():
        if "quantity" in f.metadata:
            yield f.metadata["quantity"]._replace(path=path + f.name)
        elif "static" not in f.metadata:
            yield from _quantities(getattr(record, f.name), f"{path}{f.name}.")


def _missing(result: Result) -> frozenset[str]:
    """The fields that a result does not have, and "extrapolated" where that is not
    known.
    """
    names = [*(f.name for f in dataclasses.fields(result)), "extrapolated"]
    return frozenset(name for name in names if getattr(result, name) is None)


def _joined_marks(results: Sequence[Result], drawn: bool) -> tuple[Doubt, ...]:
    """The marks of several results at the points of all; those of draws, which differ
    in numbers only, are one of each kind, in the words of the first.
    """
    first: dict[tuple[str, ...], Doubt] = {}
    columns: dict[tuple[str, ...], list[Any]] = {}
    for i, result in enumerate(results):
        for doubt in result.marks:
            key = (doubt.kind,) if drawn else (doubt.kind, doubt.says, doubt.remedy)
            if key not in first or not first[key].found():
                first[key] = doubt
            column = columns.setdefault(key, [None] * len(results))
            column[i] = doubt.points if column[i] is None else column[i] | doubt.points
    return tuple(
        replaced(first[key], points=_stacked(TITLE, column, _given(column)))
        for key, column in columns.items()
    )


def _marks_of(
    marks: Iterable[Doubt], i: int, length: int | None, missing: frozenset[str]
) -> tuple[Doubt, ...]:
    """The marks of one of the results that `_joined_marks` has joined."""
    picked = carried(
        marks, lambda points: points[i] if length is None else points[i][..., :length]
    )
    looked = [d for d in picked if d.kind == "extrapolated" and d.kind not in missing]
    kept = [d for d in picked if d.found()]
    if looked and where(kept, "extrapolated") is None:
        kept.append(looked[0])
    return tuple(kept)


def _of_draws(doubts: Iterable[Doubt]) -> tuple[Doubt, ...]:
    """What is to be doubted in a number made of all draws: what is in any of them."""
    return carried(doubts, lambda points: np.asarray(points).any(axis=0))


def _given(column: list[Any]) -> list[Any]:
    return [value for value in column if value is not None]


def _joined_inputs(
    results: Sequence[Result], names: Sequence[str], drawn: tuple[str, str] | None
) -> dict[str, str]:
    """The inputs of several materials: what is the same is said once, what differs for
    each of them; of draws not at all, but for the limits of the model, which are said of
    the first that has them.
    """
    every = [dict(result.inputs) for result in results]
    first = every[0]
    inputs = {"material": ", ".join(names)}
    if drawn is not None:
        inputs = {"material": drawn[0], "drawn": drawn[1]}
    for key in dict.fromkeys(key for each in every for key in each):
        same = all(each.get(key) == first.get(key) for each in every)
        if key == "material":
            continue
        if drawn and not same:
            if key in _OF_A_DRAW:
                texts = [each[key] for each in every if key in each]
                inputs[key] = (
                    f"in {len(texts)} of {len(every)} draws, first: {texts[0]}"
                )
            continue
        inputs[key] = (
            first[key]
            if same
            else "; ".join(
                f"{name}: {each[key]}"
                for name, each in zip(names, every, strict=True)
                if key in each
            )
        )
    unknown = [
        name
        for name, result in zip(names, results, strict=True)
        if result.extrapolated is None
    ]
    if unknown and len(unknown) < len(results):
        inputs["range of the data"] = (
            f"not known for {', '.join(unknown)}, never marked as extrapolated"
        )
    return inputs


def fill_sheet(sheet: Any, lines: list[list[Any]]) -> None:
    """Writes lines into a sheet of Excel; what is not known is an empty cell, and no
    text is a formula.
    """
    for i, line in enumerate(lines, 1):
        for j, value in enumerate(line, 1):
            if isinstance(value, str):
                cell = sheet.cell(i, j, re.sub(r"[\x00-\x1f]+", " ", value))
                cell.data_type = "s"
            elif not isinstance(value, float) or np.isfinite(value):
                sheet.cell(i, j, value)
            elif np.isinf(value):
                sheet.cell(i, j, str(value)).data_type = "s"
    for cell in sheet[1]:
        width = max(14, len(str(lines[0][cell.column - 1])) + 2)
        sheet.column_dimensions[cell.column_letter].width = width


def _joined(parts: list[T], given: Mapping[str, object]) -> T:
    """One record of several: their numbers along a new first axis, what is no number as
    a tuple.
    """
    values = dict(given)
    for f in dataclasses.fields(type(parts[0])):  # type: ignore[arg-type]
        if f.name not in values:
            column = [getattr(one, f.name) for one in parts]
            values[f.name] = _joined_field(f, column)
    return type(parts[0])(**values)


def _joined_field(f: Any, column: list[Any]) -> Any:
    """The values of one field of several records. Raises `InputError` where they do not
    fit together.
    """
    given = _given(column)
    if "static" in f.metadata:
        if any(value != column[0] for value in column):
            raise InputError(
                argument="results", got=column, accepted=f"computed alike in {f.name}"
            )
        return column[0]
    if not given:
        return None
    if "quantity" in f.metadata:
        return _stacked(f.name, column, given)
    if not any(True for _ in _quantities(given[0], "")):
        return tuple(column)
    if len(given) < len(column):
        raise InputError(
            argument="results",
            got=len(given),
            accepted=f"computed alike, {len(column)} of them with {f.name}",
        )
    return _joined(given, {})


def _stacked(name: str, column: list[Any], given: list[Any]) -> Any:
    """Arrays along a new first axis; one that is missing is NaN (or False), the last
    axis as long as the longest.
    """
    shapes = {np.shape(x)[:-1] for x in given}
    if len(shapes) > 1 or len({np.ndim(x) for x in given}) > 1:
        raise InputError(
            argument="results",
            got=[np.shape(x) for x in given],
            accepted=f"of one shape in {name}",
        )
    longest = max(np.shape(x)[-1] if np.ndim(x) else 0 for x in given)

    def padded(x: Any) -> Any:
        if x is None:
            shape = (*np.shape(given[0])[:-1], longest) if np.ndim(given[0]) else ()
            return xp.full(shape, False if given[0].dtype == bool else np.nan)
        x = xp.asarray(x)
        if not x.ndim or x.shape[-1] == longest:
            return x
        width = [(0, 0)] * (x.ndim - 1) + [(0, longest - x.shape[-1])]
        return (
            xp.pad(x, width, mode="edge")
            if x.dtype == bool
            else xp.pad(x, width, constant_values=np.nan)
        )

    return xp.stack([padded(x) for x in column])


def _over_draws(reduce: Callable[[np.ndarray], np.ndarray], values: Any) -> np.ndarray:
    values = np.asarray(values)
    lost = np.isnan(values).all(axis=0)  # where no draw converged
    return np.where(lost, np.nan, reduce(np.where(lost, 0.0, values)))


def _changed(
    record: T,
    change: Callable[[str, Array], Array | None],
    chosen: int,
    missing: frozenset[str] = frozenset(),
) -> T:
    """One record of those that `_joined` has joined: its numbers changed, of a tuple
    the one that is chosen.
    """
    values: dict[str, object] = {}
    for f in dataclasses.fields(record):  # type: ignore[arg-type]
        value = getattr(record, f.name)
        if f.name in missing:
            value = None
        elif f.name == "marks":
            value = ()
        elif "quantity" in f.metadata and value is not None:
            value = change(f.name, value)
        elif "static" not in f.metadata and value is not None:
            is_tuple = isinstance(value, tuple)
            value = value[chosen] if is_tuple else _changed(value, change, chosen)
        values[f.name] = value
    return type(record)(**values)


def _median(record: T) -> T:
    """The medians of all; of a draw that is not foretold the median is not either."""

    def middle(name: str, values: Array) -> Array:
        if np.asarray(values).dtype == bool:
            share = np.mean(values, axis=0)
            return share == 1 if name == "converged" else share > 0.5
        median = np.median if name == "model_error" else np.nanmedian
        return _over_draws(lambda x: median(x, axis=0), values)

    return _changed(record, middle, 0)


def _part(record: T, i: int, length: int | None, missing: frozenset[str]) -> T:
    """One of the records that `_joined` has joined."""

    def own(_: str, values: Array) -> Array:
        cut = length is not None and np.ndim(values) > 1
        return values[i][..., :length] if cut else values[i]

    return _changed(record, own, i, missing)
