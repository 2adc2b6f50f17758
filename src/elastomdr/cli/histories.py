"""Scenes in time: `elastomdr indent` under a history of depth or load, `impact`, and
`slide` through stages of rest, speed and load.
"""

import abc
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import elastomdr as em

from ..errors import InputError
from .bodies import AnyShape, AnySurface, SurfaceTable
from .scene import Numerics, OfBodies
from .schema import (
    Arguments,
    Content,
    Instants,
    One,
    Several,
    Sweep,
    Table,
    given,
    only_one,
    whole,
)
from .units import (
    Damping,
    Depth,
    Duration,
    Force,
    Instant,
    Length,
    LinePush,
    Mass,
    Pause,
    Pressure,
    Push,
    PushPressure,
    Speed,
    Stiffness,
    SurfaceEnergy,
    Temperature,
    Velocity,
)

if TYPE_CHECKING:
    import numpy as np

_RISE = 41  # instants of a rise


Cycles = Annotated[int, whole(1, 1000)]
StageInstants = Annotated[int, whole(2, 2000)]


class Program(Table, tag_field="program"):
    """A history with a name.

    Keys:
        load: normal force, or several, each a history of its own
        depth: indentation depth, in place of the load
        points: instants of the history
    """

    load: Several[Force] | None = None
    depth: Several[Length] | None = None
    points: Instants = 200

    def __post_init__(self) -> None:
        only_one(self, "load", "depth")

    def arguments(self, folder: Path) -> Arguments:
        """time [s], and load [N] or depth [m]."""
        import numpy as np

        ((name, sizes),) = given(self, "load", "depth").items()
        time, share = self.course()
        size = sizes if len(sizes) > 1 else sizes[0]
        return {"time": time, name: np.multiply.outer(size, share)}

    @abc.abstractmethod
    def course(self) -> "tuple[np.ndarray, np.ndarray]":
        """Instants, and the shares of the value that there are at them."""


class Hold(Program, tag="hold"):
    """A step or a ramp to the value, which is then kept: creep under a load, relaxation
    under a depth.

    Keys:
        duration: how long the value is kept
        rise: how long it takes to get there, at once by default
        spacing: of the instants
    """

    duration: Duration
    rise: Pause | None = None
    spacing: Literal["log", "linear"] = "log"

    def course(self) -> "tuple[np.ndarray, np.ndarray]":
        import numpy as np

        since = np.linspace(0, self.duration, self.points)
        if self.spacing == "log":
            since = np.append(
                0.0, np.geomspace(1e-6 * self.duration, self.duration, self.points - 1)
            )
        if not self.rise:
            return since, np.ones(self.points)
        time = np.concatenate(
            [np.linspace(0, self.rise, _RISE)[:-1], self.rise + since]
        )
        return time, np.minimum(time / self.rise, 1.0)


class Ramp(Program, tag="ramp"):
    """From zero to the value.

    Keys:
        duration: how long it takes
    """

    duration: Duration

    def course(self) -> "tuple[np.ndarray, np.ndarray]":
        import numpy as np

        fraction = np.linspace(0, 1, self.points)
        return fraction * self.duration, fraction


class Triangle(Program, tag="triangle"):
    """Up to the value and down again.

    Keys:
        duration: of one cycle, up and down
        cycles: how many there are
        rest: time at zero after each of them
    """

    duration: Duration
    cycles: Cycles = 1
    rest: Pause | None = None

    def course(self) -> "tuple[np.ndarray, np.ndarray]":
        import numpy as np

        kinks, heights, rest = [0.0], [0.0], self.rest or 0.0
        for i in range(self.cycles):
            start = i * (self.duration + rest)
            end = start + self.duration
            kinks += [start + 0.5 * self.duration, end, end + rest]
            heights += [1.0, 0.0, 0.0]
        time = np.union1d(kinks, np.linspace(0, kinks[-1], self.points))
        return time, np.interp(time, kinks, heights)


class PointsTable(Table):
    """A history by its points, straight between them.

    Keys:
        time: instants, ascending
        load: normal forces at these
        depth: indentation depths at these, in place of the loads
        points: instants of the history; those of `time` are added to them
    """

    time: list[Instant]
    load: list[Push] | None = None
    depth: list[Depth] | None = None
    points: Instants = 200

    def __post_init__(self) -> None:
        only_one(self, "load", "depth")

    def arguments(self, folder: Path) -> Arguments:
        """time [s], and load [N] or depth [m]."""
        import numpy as np

        from ..checks import alike, ascending

        ((name, values),) = given(self, "load", "depth").items()
        alike(2, {"time": self.time, name: values})
        ascending("time", self.time)
        time = np.union1d(
            self.time, np.linspace(self.time[0], self.time[-1], self.points)
        )
        return {"time": time, name: np.interp(time, self.time, values)}


class Bonds(Table):
    """Adhesion of the body and the rubber.

    Keys:
        work: work of adhesion at rest
        cutoff: length at the edge within which bonds open
        strength: largest stress between the surfaces, in place of the cutoff
        edge: what it takes at a speed; by default computed from the rubber
    """

    work: SurfaceEnergy
    cutoff: Length | None = None
    strength: Pressure | None = None
    edge: Literal["persson-brener", "glassy", "elastic"] | None = None

    def arguments(self, folder: Path) -> Arguments:
        rest = given(self, "cutoff", "strength", "edge")
        return {"adhesion": em.Adhesion(self.work, **rest)}


class _Indentation(OfBodies):
    """Indentation under a history of depth or load.

    Keys:
        temperature: temperature of the rubber
        adhesion: adhesion of the body; a work of adhesion alone is its upper limit
        indenter: the rigid body
        history: load or depth against time
    """

    mark: ClassVar[str] = "history"
    call: ClassVar[str] = "indent"
    temperature: One[Temperature] | None = None
    adhesion: SurfaceEnergy | Bonds | None = None
    indenter: AnyShape
    history: Program | PointsTable

    def arguments(self, folder: Path) -> Arguments:
        found = super().arguments(folder)
        return (
            found
            if isinstance(self.adhesion, Bonds)
            else found | given(self, "adhesion")
        )


class IndentationScene(_Indentation):
    """Indentation under a history of depth or load with a name.

    Keys:
        history: load or depth against time
    """

    history: Hold | Ramp | Triangle


class IndentationByPoints(_Indentation):
    """Indentation under a history of depth or load given by points.

    Keys:
        history: load or depth against time
    """

    history: PointsTable

    @classmethod
    def fits(cls, content: Content) -> bool:
        return (
            isinstance(content.get("history"), dict)
            and "program" not in content["history"]
        )


class Thrown(Table):
    """The body that hits the rubber.

    Keys:
        mass: its mass
        velocity: its velocity at touch
    """

    mass: Several[Mass]
    velocity: Sweep[Velocity]


class ImpactScene(OfBodies):
    """Impact of a body and its rebound.

    Keys:
        indenter: the rigid body
        impact: how heavy and how fast it is
    """

    mark: ClassVar[str] = "impact"
    call: ClassVar[str] = "impact"
    indenter: AnyShape
    impact: Thrown


_FIRST = 1e-4  # of a rest: the first instant looked at after its beginning


class StageNumerics(Numerics):
    """How exactly the scene is computed.

    Keys:
        points: instants of each stage
    """

    points: StageInstants = 60

    def arguments(self, folder: Path) -> Arguments:
        return given(self, "rtol")


class Stage(Table):
    """A stage of rest or of constant speed.

    A load or depth is put on at once, at the beginning; a stage without one keeps that
    of the stage before.

    Keys:
        duration: how long it lasts
        way: how far the body moves, in place of the duration
        velocity: sliding velocity, of either sign; at rest by default
        depth: indentation depth, in place of the load
        ramp: true where load or depth grows to its value over the stage
    """

    duration: Duration | None = None
    way: Length | None = None
    velocity: Speed | None = None
    depth: Depth | None = None
    ramp: bool = False
    # the keys of which one says how the body is pressed on
    pressed: ClassVar[tuple[str, ...]] = ("load", "depth")

    def __post_init__(self) -> None:
        if self.way is None:
            if self.duration is None:
                accepted = "given, or a way with a velocity"
                raise InputError(argument="duration", accepted=accepted)
        elif not self.velocity:
            raise InputError(
                argument="velocity",
                got=self.velocity,
                accepted="given and not zero beside a way",
            )
        elif self.duration is not None:
            raise InputError(
                argument="duration",
                got=self.duration,
                accepted="left out beside a way with a velocity",
            )

    def motion(self) -> tuple[float, float]:
        """Duration [s], and how far the body moves [m]."""
        velocity = self.velocity or 0.0
        if self.way is None:
            duration = self.duration or 0.0
            return duration, velocity * duration
        return self.way / abs(velocity), math.copysign(self.way, velocity)


class BodyStage(Stage):
    """A stage of a body.

    Keys:
        load: normal force
    """

    load: Push | None = None


class SurfaceStage(Stage):
    """A stage of a line of a surface.

    Keys:
        load: force per length of the line
        pressure: nominal pressure, in place of the load
    """

    load: LinePush | None = None
    pressure: PushPressure | None = None
    pressed: ClassVar[tuple[str, ...]] = ("load", "depth", "pressure")


class DriveTable(Table):
    """A drive that pulls the body through a spring and a damper; the stages are its
    way.

    Keys:
        mass: mass that the spring pulls
        stiffness: of the spring
        damping: of the damper beside it
    """

    mass: Mass
    stiffness: Stiffness
    damping: Damping | None = None

    aside = True

    def mount(self, load: "np.ndarray | None") -> "em.Mount":
        """The drive as an object. Raises `InputError` for a history of depth."""
        if load is None:
            raise InputError(
                argument="[drive]",
                accepted="left out without stages with a load",
                hint="a body on a spring has no depth of its own",
            )
        return em.Mount(self.mass, self.stiffness, self.damping or 0.0)


class SurfaceDrive(DriveTable):
    """A drive of the body for which the line of a surface stands.

    Keys:
        normal_force: on that body: mass, stiffness and damping are scaled to the load
            of the line
    """

    normal_force: Force

    def mount(self, load: "np.ndarray | None") -> "em.Mount":
        whole = super().mount(load)
        if load is None or not load[-1] > 0:
            raise InputError(
                argument="[drive]",
                accepted="left out where the last stage has no load above zero",
            )
        return whole.for_line(float(load[-1]), self.normal_force)


class _Slide(OfBodies):
    """Sliding through stages.

    Keys:
        temperature: temperature of the rubber
        stage: the stages
        drive: what pulls the body, where it is pulled through a spring
        numerics: how exactly it is computed
    """

    call: ClassVar[str] = "slide"
    temperature: One[Temperature] | None = None
    stage: list[BodyStage] | list[SurfaceStage]
    drive: DriveTable | None = None
    numerics: StageNumerics = StageNumerics()

    def called(self) -> str:
        return "slide" if self.drive is None else "drive"

    def arguments(self, folder: Path) -> Arguments:
        found = super().arguments(folder)
        length: Any = found.pop("length", None)
        history = follow(self.stage, self.numerics.points, length)
        if self.drive is not None:
            found["tangential"] = self.drive.mount(history.get("load"))
        return found | history


class BodySlide(_Slide):
    """Sliding of a body through stages.

    Keys:
        indenter: the rigid body
    """

    indenter: AnyShape
    stage: list[BodyStage]


class SurfaceSlide(_Slide):
    """Sliding of a line of a surface through stages.

    Keys:
        layer: a surface slides on a half-space
        surface: the surface that the line is taken from
    """

    mark: ClassVar[str] = "surface"
    layer: None = None
    surface: AnySurface
    stage: list[SurfaceStage]
    drive: SurfaceDrive | None = None

    def of_surface(self, surface: SurfaceTable, folder: Path) -> Arguments:
        line, length = surface.line(folder)
        return {"shape": line, "length": length}

    def said(self, result: "em.Drive") -> str:
        """Whether the whole body sticks and slips, in newtons."""
        if self.drive is None:
            return ""
        return (
            f"Stick-slip of the body of {self.drive.normal_force:g} N? "
            f"{result.stick_slip(self.drive.normal_force)}"
        )


def follow(
    stages: Sequence[Stage], points: int, length: float | None = None
) -> Arguments:
    """time, position, and load or depth, from the stages; two equal instants are a
    jump.

    With the `length` of a line a pressure is turned into its load.
    """
    import numpy as np

    time, position, values, name = [0.0], [0.0], [], ""
    for i, stage in enumerate(stages, start=1):
        duration, moved = stage.motion()
        pressed = given(stage, *stage.pressed)
        found = list(pressed) or [name]
        if len(found) > 1 or found[0] not in ([name] if name else stage.pressed):
            wanted = (
                f"{name}, as the stages before"
                if name
                else f"one of {', '.join(stage.pressed)}"
            )
            raise InputError(
                argument=f"[stage {i}]",
                got=list(pressed),
                accepted=f"given {wanted}",
            )
        (name,) = found
        new = pressed.get(name, values[-1] if values else 0.0)
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
        time.extend(time[-1] + duration * fraction)
        position.extend(position[-1] + moved * fraction)
        values.extend(values[-1] + (new - values[-1]) * fraction)
    loads = np.array(values)
    if name == "pressure":
        name, loads = "load", loads * length
    return {"time": np.array(time), "position": np.array(position), name: loads}
