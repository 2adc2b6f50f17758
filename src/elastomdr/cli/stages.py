"""Scenes of `elastomdr slide`: a body or a line of a surface, and stage after stage of
rest, speed and load.
"""

from pathlib import Path
from typing import Annotated, Any, ClassVar

import msgspec

import elastomdr as em

from ..errors import InputError
from .indenter import AnyShape
from .scene import Numerics, OfBodies, body, on_axes
from .schema import One, Table, given, named
from .surface import AnySurface
from .units import (
    Damping,
    Depth,
    Duration,
    Force,
    Length,
    LinePush,
    Mass,
    Push,
    PushPressure,
    Speed,
    Stiffness,
    Temperature,
)

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


class Drive(Table):
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


class SurfaceDrive(Drive):
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
        Drive | None, "what pulls the body, where it is pulled through a spring"
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
        own = given(stage, *kinds)
        if len(own) > 1 or (name and own and name not in own) or not (own or name):
            wanted = (
                f"{name}, as the stages before"
                if name
                else f"one of {', '.join(kinds)}"
            )
            raise InputError(
                f"[stage {i}] must have {wanted}, got "
                f"{' and '.join(own) or 'none of them'}."
            )
        name = name or next(iter(own))
        new = own.get(name, values[-1] if values else 0.0)
        if not values:
            values.append(0.0 if stage.ramp else new)
        elif new != values[-1] and not stage.ramp:
            time.append(time[-1])
            position.append(position[-1])
            values.append(new)
        part = np.arange(1, points + 1) / points
        if not moved:
            # at rest the rubber answers on all its time scales
            part = np.geomspace(_FIRST, 1.0, points)
        start, at, before = time[-1], position[-1], values[-1]
        time.extend(start + duration * part)
        position.extend(at + moved * part)
        values.extend(before + (new - before) * part)
    loads = np.array(values)
    if name == "pressure":
        name, loads = "load", loads * length
    return {"time": np.array(time), "position": np.array(position), name: loads}
