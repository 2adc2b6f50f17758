"""Which axis of a result's arrays runs over velocity, which over temperature, load or
depth.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from typing import NamedTuple

import numpy as np

from .words import in_words

# relative spread below which values count as one: a load that was asked for comes back
# within rounding
_ALIKE = 1e-6
_MANY = 8  # curves over several parameters beyond which a figure shows some
# others: their field
_NAMES = {"normal_force": "load", "force": "load", "load_per_length": "load"}


class Label(NamedTuple):
    """What stands at an axis of a figure."""

    words: str
    unit: str = ""

    def __str__(self) -> str:
        return f"{self.words} [{self.unit}]" if self.unit else self.words


class Quantity(NamedTuple):
    """What a field of numbers is."""

    label: str  # in the title of a column
    unit: str  # "-" for a plain number, "" for yes or no
    meaning: str = ""  # in one line
    # "..." one value per point, "... name" a series of values per point, "" one for all
    # points
    dims: str = "..."
    axis: str = ""  # label of an axis in a figure, where it is not that of the column
    shown: str = ""  # unit in a figure, where it is not `unit`
    path: str = ""  # of the field in its result, such as "contact.leading"
    # its name in a table: the last part of the path where that is of one field only
    key: str = ""

    @property
    def title(self) -> str:
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    @property
    def axis_label(self) -> Label:
        words = self.axis or self.label
        unit = (self.shown or self.unit).replace("^2", "²").replace("^3", "³")
        return Label(f"{words[0].upper()}{words[1:]}", unit)


class Axis(NamedTuple):
    """One axis of a result's arrays."""

    name: str
    # the axis' coordinate (names of materials are text), or 0 ... n-1 where it has none
    values: np.ndarray
    quantity: Quantity | None = None  # that runs along it

    @property
    def known(self) -> bool:
        """Whether the axis has a coordinate."""
        return self.quantity is not None or self.values.dtype.kind == "U"


def dimensions(
    fields: Mapping[Quantity, np.ndarray], given: Iterable[str], last: str
) -> list[Axis]:
    """The axes of a result: each is named after the first quantity that changes along
    it and along no other.

    `fields` are quantities and their values; `given` the keys of what may name an axis,
    in order; `last` the name of the last axis where every result of the kind has it.
    """
    shape = np.shape(next(iter(fields.values())))
    known = {quantity.key: (quantity, values) for quantity, values in fields.items()}
    varying = {key: _varies_along(known[key][1]) for key in given if key in known}
    axes = []
    for i, length in enumerate(shape):
        fixed_name = last if last and i == len(shape) - 1 else ""
        axis = Axis(fixed_name or f"axis_{i}", np.arange(length))
        for key, along in varying.items():
            if along == {i} and fixed_name in ("", key):
                quantity, values = known[key]
                others = tuple(j for j in range(len(shape)) if j != i)
                axis = Axis(
                    _NAMES.get(key, key), np.fmax.reduce(values, axis=others), quantity
                )
                break
        axes.append(axis)
    return axes


class Curve(NamedTuple):
    """One line of a figure: where it is in the arrays, and what sets it apart from the
    others.
    """

    place: tuple[int | slice, ...]
    label: str  # "" where there is only one curve


def curves(axes: list[Axis], along: str = "velocity") -> tuple[Axis, list[Curve]]:
    """Splits a result into curves along one axis, or along its last one where none has
    that name.
    """
    if not axes:
        return Axis(along, np.zeros(1)), [Curve((), "")]
    names = [axis.name for axis in axes]
    place = names.index(along) if along in names else len(axes) - 1
    others = [
        range(axis.values.size) if i != place else [slice(None)]
        for i, axis in enumerate(axes)
    ]
    return axes[place], [
        Curve(index, ", ".join(_labels(axes, index))) for index in product(*others)
    ]


def few(curves: list[Curve]) -> list[Curve]:
    """What a figure shows of many curves over several parameters: those of which all
    parameters but one are in the middle of theirs.
    """
    places = np.array([[i for i in c.place if isinstance(i, int)] for c in curves])
    if len(curves) <= _MANY or (places.max(axis=0) > 0).sum() < 2:
        return curves
    away = (places != places.max(axis=0) // 2).sum(axis=1)
    return [curve for curve, off in zip(curves, away, strict=True) if off <= 1]


def place_in_words(axis: Axis, i: int) -> str:
    """One place on an axis."""
    if axis.quantity is None:
        return str(axis.values[i]) if axis.known else f"no. {i}"
    return in_words(axis.name, float(axis.values[i]), axis.quantity.unit)


def _labels(axes: list[Axis], index: tuple[int | slice, ...]) -> Iterator[str]:
    for axis, i in zip(axes, index, strict=True):
        if isinstance(i, int) and axis.values.size > 1:
            yield place_in_words(axis, i)


class Peak(NamedTuple):
    """The largest value of a curve and where it is."""

    x: float
    y: float
    inside: bool  # False at an end of the curve, where the true peak may lie beyond


def peak(x: np.ndarray, y: np.ndarray) -> Peak | None:
    """The peak of a curve with ascending x, over the points that are known; None where
    there is none.
    """
    x, y = x[np.isfinite(y)], y[np.isfinite(y)]
    if not y.size:
        return None
    i = int(y.argmax())
    return Peak(float(x[i]), float(y[i]), 0 < i < y.size - 1)


def _varies_along(values: np.ndarray) -> set[int]:
    """The axes along which a quantity changes; NaNs, the points that failed, are not
    looked at.
    """

    def changes(axis: int) -> bool:
        high, low = np.fmax.reduce(values, axis=axis), np.fmin.reduce(values, axis=axis)
        with np.errstate(invalid="ignore"):  # infinite friction does not change
            return bool((high - low > _ALIKE * np.abs(high)).any())

    return {axis for axis in range(values.ndim) if values.size and changes(axis)}
