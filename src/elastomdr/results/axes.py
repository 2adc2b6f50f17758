"""Which axis of a result's arrays runs over velocity, which over temperature, load or depth."""

from collections.abc import Iterator, Mapping
from itertools import product
from typing import NamedTuple

import numpy as np

from .._runtime import significant

_ALIKE = 1e-6  # relative spread below which values count as one: a load that was asked for comes back within rounding
_CANDIDATES = (
    ("time", "time", "s"),
    ("velocity", "velocity", "m/s"),
    ("temperature", "temperature", "K"),
    ("pressure", "pressure", "Pa"),
    ("normal_force", "load", "N"),
    ("force", "load", "N"),
    ("depth", "depth", "m"),
)


class Axis(NamedTuple):
    """One axis of a result's arrays."""

    name: str
    values: np.ndarray  # the axis' coordinate, or 0 ... n-1 where it has none
    unit: str  # "" where it has none


def dimensions(fields: Mapping[str, np.ndarray]) -> list[Axis]:
    """The axes of a result: each is named after the first quantity that changes along it and along no other."""
    shape = np.shape(next(iter(fields.values())))
    varying = {key: _varies_along(fields[key]) for key, _, _ in _CANDIDATES if key in fields}
    axes = []
    for i, length in enumerate(shape):
        axis = Axis(f"axis_{i}", np.arange(length), "")
        for key, name, unit in _CANDIDATES:
            if varying.get(key) == {i}:
                others = tuple(j for j in range(len(shape)) if j != i)
                axis = Axis(name, np.fmax.reduce(fields[key], axis=others), unit)
                break
        axes.append(axis)
    return axes


class Curve(NamedTuple):
    """One line of a figure: where it is in the arrays, and what sets it apart from the others."""

    at: tuple[int | slice, ...]
    label: str  # "" where there is only one curve


def curves(fields: Mapping[str, np.ndarray]) -> tuple[Axis, list[Curve]]:
    """Splits a result into curves along its velocity axis, or along its last axis where velocity has none."""
    axes = dimensions(fields)
    if not axes:
        return Axis("velocity", np.asarray(fields["velocity"])[None], "m/s"), [Curve((), "")]
    names = [axis.name for axis in axes]
    along = names.index("velocity") if "velocity" in names else len(axes) - 1
    others = [range(axis.values.size) if i != along else [slice(None)] for i, axis in enumerate(axes)]
    return axes[along], [Curve(index, ", ".join(_labels(axes, index))) for index in product(*others)]


def _labels(axes: list[Axis], index: tuple[int | slice, ...]) -> Iterator[str]:
    for axis, i in zip(axes, index, strict=True):
        if isinstance(i, int) and axis.values.size > 1:
            yield in_words(axis.name, float(axis.values[i])) if axis.unit else f"{axis.name} {i}"


class Peak(NamedTuple):
    """The largest value of a curve and where it is."""

    x: float
    y: float
    inside: bool  # False at an end of the curve, where the true peak may lie beyond

    @property
    def kind(self) -> str:
        return "peak" if self.inside else "largest"


def peak(x: np.ndarray, y: np.ndarray) -> Peak | None:
    """The peak of a curve with ascending x, over the points that are known; None where there is none."""
    x, y = x[np.isfinite(y)], y[np.isfinite(y)]
    if not y.size:
        return None
    i = int(y.argmax())
    return Peak(float(x[i]), float(y[i]), 0 < i < y.size - 1)


def in_words(name: str, value: float) -> str:
    """A velocity, temperature, load or depth with the unit an engineer would write."""
    if name == "temperature":
        return f"{significant(round(value - 273.15, 3), 5)} degC"
    if name == "pressure":
        return f"{significant(1e-6 * value)} MPa"
    if name in ("depth", "radius", "length"):
        return f"{significant(1e3 * value)} mm"
    return f"{significant(value)} {'m/s' if name == 'velocity' else 'N'}"


def _varies_along(values: np.ndarray) -> set[int]:
    """The axes along which a quantity changes; NaNs, the points that failed, are not looked at."""

    def changes(axis: int) -> bool:
        high, low = np.fmax.reduce(values, axis=axis), np.fmin.reduce(values, axis=axis)
        return bool((high - low > _ALIKE * np.abs(high)).any())

    return {axis for axis in range(values.ndim) if values.size and changes(axis)}
