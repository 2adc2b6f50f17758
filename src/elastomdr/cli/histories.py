"""Scenes in time: `elastomdr indent` under a history of depth or load, `impact`, and
`slide` through stages of rest, speed and load.
"""

import abc
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import msgspec

import elastomdr as em

from ..errors import InputError
from .bodies import AnyShape, AnySurface
from .scene import Numerics, OfBodies, body, on_axes
from .schema import Instants, One, Several, Sweep, Table, given, named, only_one
from .units import (
    Damping,
    Depth,
    Duration,
    Force,
    Frequency,
    Instant,
    Length,
    LinePush,
    Mass,
    Pause,
    Push,
    PushPressure,
    Speed,
    Stiffness,
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

        fraction = np.linspace(0, 1, self.points)
        return fraction * self.duration, np.multiply.outer(size, fraction)


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


class PointsTable(Table):
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
    history: Annotated[Program | PointsTable, "load or depth against time"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        with named("[history]"):
            history = self.history.arguments()
        return (
            on_axes({"shape": body(self.indenter, folder)} | self.common(folder))
            | given(self, "adhesion")
            | history
        )


class IndentationScene(_Indentation):
    """Indentation under a history of depth or load with a name."""

    history: Annotated[Hold | Ramp | Triangle | Sine, "load or depth against time"]


class IndentationByPoints(_Indentation):
    """Indentation under a history of depth or load given by points."""

    history: Annotated[PointsTable, "load or depth against time"]

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


class ImpactScene(OfBodies):
    """Impact of a body and its rebound."""

    mark: ClassVar[str] = "impact"
    call: ClassVar[str] = "impact"
    indenter: Annotated[AnyShape, "the rigid body"]
    impact: Annotated[Thrown, "how heavy and how fast it is"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        arguments = {"shape": body(self.indenter, folder)} | self.common(folder)
        return on_axes(arguments | given(self.impact, "mass", "velocity"))


_FIRST = 1e-4  # of a rest: the first instant looked at after its beginning


class StageNumerics(Numerics):
    """How exactly the scene is computed."""

    points: Annotated[
        Annotated[int, msgspec.Meta(ge=2, le=2000)], "instants of each stage"
    ] = 60


class Stage(Table):
    """A stage of rest or of constant speed.

    A load or depth is put on at once, at the beginning; a stage without one keeps that
    of the stage before.
    """

    duration: Annotated[Duration | None, "how long it lasts"] = None
    way: Annotated[
        Length | None, "how far the body moves, in place of the duration"
    ] = None
    velocity: Annotated[
        Speed | None, "sliding velocity, of either sign; at rest by default"
    ] = None
    depth: Annotated[Depth | None, "indentation depth, in place of the load"] = None
    ramp: Annotated[
        bool, "true where load or depth grows to its value over the stage"
    ] = False

    def __post_init__(self) -> None:
        if self.way is None and self.duration is None:
            raise InputError("duration is missing, or a way with a velocity.")
        if self.way is not None and (self.duration is not None or not self.velocity):
            raise InputError(
                "way needs a velocity that is not zero, and no duration beside it."
            )

    def motion(self) -> tuple[float, float]:
        """Duration [s], and how far the body moves [m]."""
        velocity = self.velocity or 0.0
        if self.duration is not None:
            return self.duration, velocity * self.duration
        way = self.way or 0.0
        return way / abs(velocity), way if velocity > 0 else -way


class BodyStage(Stage):
    """A stage of a body."""

    load: Annotated[Push | None, "normal force"] = None


class SurfaceStage(Stage):
    """A stage of a line of a surface."""

    load: Annotated[LinePush | None, "force per length of the line"] = None
    pressure: Annotated[
        PushPressure | None, "nominal pressure, in place of the load"
    ] = None


class DriveTable(Table):
    """A drive that pulls the body through a spring and a damper; the stages are its
    way.
    """

    mass: Annotated[Mass, "mass that the spring pulls"]
    stiffness: Annotated[Stiffness, "of the spring"]
    damping: Annotated[Damping | None, "of the damper beside it"] = None

    def mount(self, history: dict[str, Any]) -> Any:
        """The drive as an object. Raises `InputError` for a history of depth."""
        if "load" not in history:
            raise InputError(
                "[drive] needs stages with a load: a body on a spring has no "
                "depth of its own."
            )
        return em.Mount(self.mass, self.stiffness, self.damping or 0.0)


class SurfaceDrive(DriveTable):
    """A drive of the body for which the line of a surface stands."""

    normal_force: Annotated[
        Force,
        "on that body: mass, stiffness and damping are scaled to the load of the line",
    ]

    def mount(self, history: dict[str, Any]) -> Any:
        whole = super().mount(history)
        if not history["load"][-1] > 0:
            raise InputError("[drive] needs a load above zero in the last stage.")
        return whole.for_line(float(history["load"][-1]), self.normal_force)


class BodySlide(OfBodies):
    """Sliding of a body through stages."""

    call: ClassVar[str] = "slide"
    temperature: Annotated[One[Temperature] | None, "temperature of the rubber"] = None
    indenter: Annotated[AnyShape, "the rigid body"]
    stage: Annotated[list[BodyStage], msgspec.Meta(min_length=1), "the stages"]
    drive: Annotated[
        DriveTable | None, "what pulls the body, where it is pulled through a spring"
    ] = None
    numerics: Annotated[StageNumerics, "how exactly it is computed"] = StageNumerics()

    def called(self) -> str:
        return "slide" if self.drive is None else "drive"

    def arguments(self, folder: Path) -> dict[str, Any]:
        history = follow(self.stage, self.numerics.points)
        mount = {} if self.drive is None else {"tangential": self.drive.mount(history)}
        return (
            on_axes({"shape": body(self.indenter, folder)} | self.common(folder))
            | history
            | mount
        )


class SurfaceSlide(OfBodies):
    """Sliding of a line of a surface through stages."""

    mark: ClassVar[str] = "surface"
    call: ClassVar[str] = "slide"
    temperature: Annotated[One[Temperature] | None, "temperature of the rubber"] = None
    layer: Annotated[None, "a surface slides on a half-space"] = None
    surface: Annotated[AnySurface, "the surface that the line is taken from"]
    stage: Annotated[list[SurfaceStage], msgspec.Meta(min_length=1), "the stages"]
    drive: Annotated[
        SurfaceDrive | None, "what pulls the body, where it is pulled through a spring"
    ] = None
    numerics: Annotated[StageNumerics, "how exactly it is computed"] = StageNumerics()

    def called(self) -> str:
        return "slide" if self.drive is None else "drive"

    def arguments(self, folder: Path) -> dict[str, Any]:
        with named("[surface]"):
            line, length = self.surface.line(folder)
        history = follow(self.stage, self.numerics.points, length)
        mount = {} if self.drive is None else {"tangential": self.drive.mount(history)}
        return on_axes({"shape": line} | self.common(folder)) | history | mount

    def said(self, result: Any) -> str:
        """Whether the whole body sticks and slips, in newtons."""
        if self.drive is None:
            return ""
        return (
            f"Stick-slip of the body of {self.drive.normal_force:g} N? "
            f"{result.stick_slip(self.drive.normal_force)}"
        )


def follow(
    stages: list[Any], points: int, length: float | None = None
) -> dict[str, Any]:
    """time, position, and load or depth, from the stages; two equal instants are a
    jump.

    With the `length` of a line a pressure is turned into its load.
    """
    import numpy as np

    kinds = ("load", "depth") if length is None else ("load", "depth", "pressure")
    time, position, values, name = [0.0], [0.0], [], ""
    for i, stage in enumerate(stages, start=1):
        duration, moved = stage.motion()
        given_here = given(stage, *kinds)
        if (
            len(given_here) > 1
            or (name and given_here and name not in given_here)
            or not (given_here or name)
        ):
            wanted = (
                f"{name}, as the stages before"
                if name
                else f"one of {', '.join(kinds)}"
            )
            raise InputError(
                f"[stage {i}] must have {wanted}, got "
                f"{' and '.join(given_here) or 'none of them'}."
            )
        name = name or next(iter(given_here))
        new = given_here.get(name, values[-1] if values else 0.0)
        if not values:
            values.append(0.0 if stage.ramp else new)
        elif new != values[-1] and not stage.ramp:
            time.append(time[-1])
            position.append(position[-1])
            values.append(new)
        fraction = np.arange(1, points + 1) / points
        if not moved:
            # at rest the rubber answers on all its time scales
            fraction = np.geomspace(_FIRST, 1.0, points)
        start, begin, before = time[-1], position[-1], values[-1]
        time.extend(start + duration * fraction)
        position.extend(begin + moved * fraction)
        values.extend(before + (new - before) * fraction)
    loads = np.array(values)
    if name == "pressure":
        name, loads = "load", loads * length
    return {"time": np.array(time), "position": np.array(position), name: loads}
