"""The points of a sweep: its axes, and the chunks that they are divided into."""

from __future__ import annotations

import inspect
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..call.model_choice import is_rough
from ..call.several_materials import RTOL
from ..checks import as_float64, untraced
from ..errors import InputError
from ..material.validity import Draws
from ..results.base import distinct

_BODIES = ("shape", "surface")
_STEADY = ("velocity", "load", "depth", "pressure", "temperature", "direction")
_IMPACT = (
    "mass",
    "velocity",
    "temperature",
    "tangential_velocity",
    "friction",
    "inertia",
)
_UNITS = {
    "velocity": "m/s",
    "load": "N",
    "depth": "m",
    "pressure": "Pa",
    "direction": "rad",
    "temperature": "K",
    "mass": "kg",
    "inertia": "kg m^2",
    "tangential_velocity": "m/s",
}
_POINTS = 10_000  # of a chunk: a second of work by Multiscale, 10 MB
_FEWEST = 2_000  # of a chunk of several calls: to write one costs a few milliseconds
_CHUNKS = 128  # if the points suffice, so that no worker waits long for the last one
_SLOW = 50  # of a chunk where every point is solved on lines
_ON_CELLS = 8  # of a chunk where it is solved in three dimensions: seconds each
_IMPACTS = 1_000  # of a chunk: a second
_DRAW = "draw"  # the axis of draws


class SweepAxis(NamedTuple):
    """One axis of a sweep."""

    name: str
    values: list[Any]
    broadcast: bool  # whether the call takes all of its values as an array

    @property
    def about(self) -> dict[str, str]:
        """Attributes of the coordinate."""
        return {"units": _UNITS[self.name]} if self.name in _UNITS else {}

    @property
    def labels(self) -> np.ndarray:
        """The coordinate of the axis: its numbers, or the names of its materials and
        surfaces.
        """
        if all(
            isinstance(value, (bool, int, float, np.number)) for value in self.values
        ):
            return np.array(self.values)
        return np.array(distinct([_label(value) for value in self.values]))


class Grid(NamedTuple):
    """What a sweep computes."""

    call: Callable[..., Any]
    axes: list[SweepAxis]
    fixed: dict[str, object]
    draws: bool = False  # whether the first axis numbers draws among the arguments

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(axis.values) for axis in self.axes)

    def sizes(self) -> tuple[int, ...]:
        """How long a chunk is along each axis: arrays first, so that one call does as
        much as possible.
        """
        most = _POINTS
        if self.call.__name__ == "impact":
            most = _IMPACTS
        elif "halfspace" in self._models():
            most = _ON_CELLS
        elif self._on_lines():
            most = _SLOW
        several = min(most, max(_FEWEST, math.prod(self.shape) // _CHUNKS))
        sizes = [1] * len(self.axes)
        order = sorted(
            range(len(self.axes)), key=lambda i: (not self.axes[i].broadcast, -i)
        )
        for i in order:
            left = (most if self.axes[i].broadcast else several) // math.prod(sizes)
            parts = math.ceil(self.shape[i] / max(1, left))
            sizes[i] = math.ceil(self.shape[i] / parts)
        return tuple(sizes)

    def _values(self, *names: str) -> list[Any]:
        """All values of arguments of these names: along axes, fixed, and those that the
        call of a scene holds itself.
        """
        along = [axis.values for axis in self.axes if axis.name in names]
        given = [self.fixed, *getattr(self.call, "arguments", ())]
        held = [each[name] for each in given for name in names if name in each]
        return [*itertools.chain.from_iterable(along), *held]

    def _models(self) -> set[str]:
        return {_name(each).lower().replace("-", "") for each in self._values("model")}

    def _on_lines(self) -> bool:
        """Whether points are solved on lines of several seeds."""
        return "line" in self._models() and any(map(is_rough, self._values(*_BODIES)))

    def chunks(self) -> list[tuple[slice, ...]]:
        """The places of all chunks."""
        along = [
            [slice(start, min(start + size, n)) for start in range(0, n, size)]
            for n, size in zip(self.shape, self.sizes(), strict=True)
        ]
        return list(itertools.product(*along))

    def calls(
        self, chunk: tuple[slice, ...]
    ) -> Iterator[tuple[tuple[int | slice, ...], dict[str, object]]]:
        """The calls of a chunk: where their points lie in it, and their arguments."""
        together = [axis for axis in self.axes if axis.broadcast]
        arrays: dict[str, object] = {}
        for i, axis in enumerate(together):
            along = chunk[self.axes.index(axis)]
            values = np.asarray(axis.values[along], dtype=float)
            arrays[axis.name] = values.reshape((-1,) + (1,) * (len(together) - 1 - i))
        one_by_one = [
            (k, axis) for k, axis in enumerate(self.axes) if not axis.broadcast
        ]
        for places in itertools.product(
            *(range(*chunk[k].indices(self.shape[k])) for k, _ in one_by_one)
        ):
            given = {
                axis.name: axis.values[i]
                for (_, axis), i in zip(one_by_one, places, strict=True)
            }
            where: list[int | slice] = [slice(None)] * len(self.axes)
            for (k, _), i in zip(one_by_one, places, strict=True):
                where[k] = i - chunk[k].start
            yield tuple(where), self._drawn(self.fixed | arrays | given)

    def _drawn(self, arguments: dict[str, Any]) -> dict[str, object]:
        """The arguments of one draw, as exact as `em.friction` takes draws."""
        if not self.draws:
            return arguments
        i = arguments.pop(_DRAW) - 1
        exact: dict[str, object] = (
            {"rtol": RTOL} if "rtol" in inspect.signature(self.call).parameters else {}
        )
        return exact | {
            name: value[i] if isinstance(value, Draws) else value
            for name, value in arguments.items()
        }

    def parts(self) -> dict[str, object]:
        """What a store has to have been made of to be gone on with, and itself."""
        axes = {axis.name: axis.values for axis in self.axes}
        return {"call": self.call, "axes": axes, "fixed": self.fixed, "points": self}


def grid(call: object, axes: object, fixed: dict[str, object]) -> Grid:
    """Checks the arguments of a sweep. Raises `InputError`."""
    if not callable(call) or not hasattr(call, "__name__"):
        raise InputError(
            argument="call",
            got=call,
            accepted="em.friction, em.rolling, em.impact or a function like these",
        )
    if not isinstance(axes, Mapping) or not axes:
        raise InputError(
            argument="axes",
            got=axes,
            accepted="a dict of one or more names to their values",
        )
    arrays = _IMPACT if call.__name__ == "impact" else _STEADY
    for name in axes:
        if name in fixed:
            raise InputError(
                argument=name, got=fixed[name], accepted="an axis or fixed, not both"
            )
    checked = [
        SweepAxis(str(name), listed, name in arrays and None not in listed)
        for name, values in axes.items()
        for listed in [_checked_values(name, values)]
    ]
    for name, value in fixed.items():
        _check_fixed(name, value, arrays)
    draws = _draws(checked, fixed)
    if draws:
        checked = [SweepAxis(_DRAW, draws, False), *checked]
    points = Grid(call, checked, dict(sorted(fixed.items())), bool(draws))
    _check_signature(points)
    return points


def _checked_values(name: str, values: Sequence[object] | np.ndarray) -> list[Any]:
    """The values of an axis. Raises `InputError`."""
    axis, accepted = f"axes[{name!r}]", "plain numbers, which a sweep can store"
    untraced(InputError(argument=axis, accepted=accepted), values)
    listed = np.asarray(values).tolist() if hasattr(values, "__array__") else values
    is_list = (
        not isinstance(listed, (str, bytes, Mapping))
        and hasattr(listed, "__len__")
        and hasattr(listed, "__getitem__")
        and len(listed) > 0
    )
    if not is_list or any(
        isinstance(value, list) and not isinstance(value, Draws) for value in listed
    ):
        raise InputError(
            argument=axis, got=values, accepted="a list or an array with one dimension"
        )
    untraced(InputError(argument=axis, accepted=accepted), *listed)
    return list(listed)


def _check_fixed(name: str, value: Any, arrays: tuple[str, ...]) -> None:
    """Raises `InputError` for several values of what is no axis."""
    if name in arrays and isinstance(value, (list, tuple)):
        value = as_float64(name, value)
    if name in arrays and np.ndim(value):
        raise InputError(argument=name, got=value, accepted="one value or an axis")
    is_list = isinstance(value, (list, tuple)) and not isinstance(value, Draws)
    if name in ("material", *_BODIES) and is_list:
        raise InputError(
            argument=name, got=value, accepted="one, draws of one, or an axis"
        )


def _check_signature(points: Grid) -> None:
    """Raises `InputError` for arguments that the call does not take."""
    try:
        _, arguments = next(points.calls(points.chunks()[0]))
        by_position, by_name = positional(arguments)
        inspect.signature(points.call).bind(*by_position, **by_name)
    except TypeError as error:
        raise InputError(
            argument="axes",
            got=[axis.name for axis in points.axes],
            accepted=f"arguments of {points.call.__name__}, as what is fixed",
            hint=str(error),
        ) from error
    except ValueError:  # a function that has no signature
        pass


def _draws(axes: list[SweepAxis], fixed: dict[str, object]) -> list[int]:
    """The numbers of the draws, where there are any. Raises `InputError`."""
    every = itertools.chain(
        fixed.items(), ((axis.name, value) for axis in axes for value in axis.values)
    )
    counts = {len(value): name for name, value in every if isinstance(value, Draws)}
    if len(counts) > 1:
        one, other = list(counts.items())[:2]
        raise InputError(
            argument=other[1],
            got=other[0],
            accepted=f"as many draws as {one[1]}, {one[0]}",
        )
    if counts and any(
        name == _DRAW for name in (*fixed, *(axis.name for axis in axes))
    ):
        raise InputError(
            argument="axes",
            got=_DRAW,
            accepted=f"without one called {_DRAW!r} beside draws, which make that axis",
        )
    return [i for count in counts for i in range(1, count + 1)]


def positional(
    arguments: Mapping[str, object],
) -> tuple[list[object], dict[str, object]]:
    """Material and body of a call, which have places, whatever the axes call a body;
    and the other arguments.
    """
    rest = dict(arguments)
    places = [rest.pop("material")] if "material" in rest else []
    body = [name for name in _BODIES if name in rest]
    if places and body:
        places.append(rest.pop(body[0]))
    return places, rest


def _label(value: object) -> str:
    if value is None or isinstance(value, (bool, int, float)):
        return str(value)
    return str(
        getattr(value, "name", "") or getattr(value, "label", "") or _name(value)
    )


def _name(value: object) -> str:
    return value if isinstance(value, str) else type(value).__name__
