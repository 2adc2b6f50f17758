"""Scenes of `elastomdr indent` and `elastomdr impact`: an indenter under a history of
depth or load, or let go.
"""

import abc
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import msgspec

from ..errors import InputError
from .indenter import AnyShape
from .scene import OfBodies, body, on_axes
from .schema import Instants, One, Several, Sweep, Table, given, named, only_one
from .units import (
    Depth,
    Duration,
    Force,
    Frequency,
    Instant,
    Length,
    Mass,
    Pause,
    Push,
    SurfaceEnergy,
    Temperature,
    Velocity,
)

_RISE = 41  # instants of a rise
Cycles = Annotated[int, msgspec.Meta(ge=1, le=1000)]


class Program(Table, tag_field="program"):
    """A history with a name."""

    load: Annotated[
        Several[Force] | None, "normal force, or several, each a history of its own"
    ] = None
    depth: Annotated[
        Several[Length] | None, "indentation depth, in place of the load"
    ] = None
    points: Annotated[Instants, "instants of the history"] = 200

    def __post_init__(self) -> None:
        only_one(self, "load", "depth")

    def arguments(self) -> dict[str, Any]:
        """time [s], and load [N] or depth [m]."""
        import numpy as np

        name = only_one(self, "load", "depth")
        sizes = getattr(self, name)
        time, values = self.course(np.asarray(sizes if len(sizes) > 1 else sizes[0]))
        return {"time": time, name: values}

    @abc.abstractmethod
    def course(self, size: Any) -> tuple[Any, Any]:
        """Instants, and the values at them for histories of the given size."""


class Hold(Program, tag="hold"):
    """A step or a ramp to the value, which is then kept: creep under a load, relaxation
    under a depth.
    """

    duration: Annotated[Duration, "how long the value is kept"]
    rise: Annotated[
        Pause | None, "how long it takes to get there, at once by default"
    ] = None
    spacing: Annotated[Literal["log", "linear"], "of the instants"] = "log"

    def course(self, size: Any) -> tuple[Any, Any]:
        import numpy as np

        since = np.linspace(0, self.duration, self.points)
        if self.spacing == "log":
            since = np.append(
                0.0, np.geomspace(1e-6 * self.duration, self.duration, self.points - 1)
            )
        if not self.rise:
            return since, np.multiply.outer(size, np.ones(self.points))
        time = np.concatenate(
            [np.linspace(0, self.rise, _RISE)[:-1], self.rise + since]
        )
        return time, np.multiply.outer(size, np.minimum(time / self.rise, 1.0))


class Ramp(Program, tag="ramp"):
    """From zero to the value."""

    duration: Annotated[Duration, "how long it takes"]

    def course(self, size: Any) -> tuple[Any, Any]:
        import numpy as np

        part = np.linspace(0, 1, self.points)
        return part * self.duration, np.multiply.outer(size, part)


class Triangle(Program, tag="triangle"):
    """Up to the value and down again."""

    duration: Annotated[Duration, "of one cycle, up and down"]
    cycles: Annotated[Cycles, "how many there are"] = 1
    rest: Annotated[Pause | None, "time at zero after each of them"] = None

    def course(self, size: Any) -> tuple[Any, Any]:
        import numpy as np

        kinks, heights = [0.0], [0.0]
        for i in range(self.cycles):
            start = i * (self.duration + (self.rest or 0.0))
            kinks += [start + 0.5 * self.duration, start + self.duration]
            heights += [1.0, 0.0]
            if self.rest:
                kinks.append(start + self.duration + self.rest)
                heights.append(0.0)
        time = np.union1d(kinks, np.linspace(0, kinks[-1], self.points))
        return time, np.multiply.outer(size, np.interp(time, kinks, heights))


class Sine(Program, tag="sine"):
    """A step to the value, about which depth or load then swings."""

    frequency: Annotated[Frequency, "cycles per time"]
    cycles: Annotated[Cycles, "how many there are"]
    amplitude: Annotated[str, "of the swing, a length or a force"]

    def course(self, size: Any) -> tuple[Any, Any]:
        import numpy as np

        with named("amplitude"):
            amplitude = (Force if self.depth is None else Length).read(self.amplitude)
        if self.depth is None and (size < amplitude).any():
            raise InputError(
                "amplitude must not be larger than load: a load that pulls needs "
                "adhesion."
            )
        time = np.linspace(0, self.cycles / self.frequency, self.points)
        return time, np.add.outer(
            size, amplitude * np.sin(2 * np.pi * self.frequency * time)
        )


class Points(Table):
    """A history by its points, straight between them."""

    time: Annotated[
        Annotated[list[Instant], msgspec.Meta(min_length=2)], "instants, ascending"
    ]
    load: Annotated[
        Annotated[list[Push], msgspec.Meta(min_length=2)] | None,
        "normal forces at these",
    ] = None
    depth: Annotated[
        Annotated[list[Depth], msgspec.Meta(min_length=2)] | None,
        "indentation depths at these, in place of the loads",
    ] = None
    points: Annotated[
        Instants, "instants of the history; those of `time` are added to them"
    ] = 200

    def __post_init__(self) -> None:
        name = only_one(self, "load", "depth")
        if any(
            second <= first
            for first, second in zip(self.time, self.time[1:], strict=False)
        ):
            raise InputError("time must be ascending, without repeats.")
        if (count := len(getattr(self, name))) != len(self.time):
            raise InputError(
                f"time and {name} must be lists of the same length, got "
                f"{len(self.time)} and {count}."
            )

    def arguments(self) -> dict[str, Any]:
        """time [s], and load [N] or depth [m]."""
        import numpy as np

        time = np.union1d(
            self.time, np.linspace(self.time[0], self.time[-1], self.points)
        )
        name = only_one(self, "load", "depth")
        return {"time": time, name: np.interp(time, self.time, getattr(self, name))}


class _Indentation(OfBodies):
    """Indentation under a history of depth or load."""

    mark: ClassVar[str] = "history"
    call: ClassVar[str] = "indent"
    temperature: Annotated[One[Temperature] | None, "temperature of the rubber"] = None
    adhesion: Annotated[SurfaceEnergy | None, "work of adhesion"] = None
    indenter: Annotated[AnyShape, "the rigid body"]
    history: Annotated[Program | Points, "load or depth against time"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        with named("[history]"):
            history = self.history.arguments()
        return (
            on_axes({"shape": body(self.indenter, folder)} | self.common(folder))
            | given(self, "adhesion")
            | history
        )


class Indentation(_Indentation):
    """Indentation under a history of depth or load with a name."""

    history: Annotated[Hold | Ramp | Triangle | Sine, "load or depth against time"]


class IndentationByPoints(_Indentation):
    """Indentation under a history of depth or load given by points."""

    history: Annotated[Points, "load or depth against time"]

    @classmethod
    def fits(cls, content: dict[str, Any]) -> bool:
        return (
            isinstance(content.get("history"), dict)
            and "program" not in content["history"]
        )


class Thrown(Table):
    """The body that hits the rubber."""

    mass: Annotated[Several[Mass], "its mass"]
    velocity: Annotated[Sweep[Velocity], "its velocity at touch"]


class Impact(OfBodies):
    """Impact of a body and its rebound."""

    mark: ClassVar[str] = "impact"
    call: ClassVar[str] = "impact"
    indenter: Annotated[AnyShape, "the rigid body"]
    impact: Annotated[Thrown, "how heavy and how fast it is"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        found = {"shape": body(self.indenter, folder)} | self.common(folder)
        return on_axes(found | given(self.impact, "mass", "velocity"))
