"""Scenes of steady motion: `elastomdr friction`, `rolling` with its heat and a whole belt,
`compare`, and `traction` of a wheel or a ball.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import elastomdr as em

from ..errors import InputError
from .bodies import (
    AnyShape,
    AnySurface,
    CylinderTable,
    HeatTable,
    OfRevolution,
    ShearOfContact,
)
from .scene import ContactTable, LayerTable, OfBodies, Scene, on_axes
from .schema import (
    Arguments,
    Content,
    Draws,
    Instants,
    Several,
    Sweep,
    Table,
    Text,
    given,
    named,
    of_key,
    path_from,
)
from .units import (
    Angle,
    AreaStiffness,
    Conductance,
    Duration,
    Force,
    HeatCapacity,
    Length,
    LineLoad,
    LineMass,
    LoadedMass,
    Pressure,
    Temperature,
    Velocity,
)


class BodyContact(ContactTable):
    """How the body is pressed on and how fast it moves.

    Keys:
        load: normal force
        depth: indentation depth, in place of the load
    """

    one_of: ClassVar[tuple[str, ...]] = ("load", "depth")
    load: Several[Force] | None = None
    depth: Several[Length] | None = None

    of_others: ClassVar[dict[str, str]] = Table.of_others | {
        "pressure": (
            "A body is pressed on with a load or a depth; a nominal pressure is that "
            "of a [surface]."
        )
    }


class SurfaceContact(ContactTable):
    """How the surface is pressed on and how fast it slides.

    Keys:
        pressure: nominal pressure
        load: force per length of a line, in place of the pressure
        depth: depth of the highest point of a line, in place of it
        strain_share: strain at a scale over the rms slope up to it, of a rubber that
            softens
        direction: of sliding, to the lay of a measured surface: 0 along its grooves
    """

    one_of: ClassVar[tuple[str, ...]] = ("pressure", "load", "depth")
    pressure: Several[Pressure] | None = None
    load: Several[LineLoad] | None = None
    depth: Several[Length] | None = None
    strain_share: float | None = None
    direction: Several[Angle] | None = None


class OfDraws(OfBodies):
    """A scene whose result may have a band of the uncertainty of its material and
    road.

    Keys:
        uncertainty: number of draws for the band, 2 or more: of the [misfit] in the
            material's file, and of the road
    """

    uncertainty: Draws | None = None

    def rubbers(self, folder: Path) -> list[Any]:
        """The materials, or draws of the one. Raises `InputError` where nothing is
        known of its uncertainty.
        """
        materials = super().rubbers(folder)
        if self.uncertainty is None:
            return materials
        several = len(materials) > 1 or self.other is not None
        road: Any = getattr(self, "surface", None)
        if (
            road
            and road.errors()
            and not several
            and not getattr(materials[0].range, "misfit", ())
        ):
            return materials  # draws of the road alone
        if several or not isinstance(materials[0], em.Prony):
            raise InputError(
                argument="uncertainty",
                got=self.uncertainty,
                accepted="left out of this scene",
                hint="draws are taken of one Prony series; there are none of several "
                "materials, of a table of moduli, and with a second body (other)",
            )
        with of_key("uncertainty", "count"):
            return materials[0].draws(self.uncertainty)


class RollingScene(OfDraws):
    """Rolling resistance of a body.

    Keys:
        indenter: the rigid body
        contact: how it is pressed on and moved
    """

    call: ClassVar[str] = "rolling"
    indenter: AnyShape
    contact: BodyContact


class BodyFriction(RollingScene):
    """Friction of a body.

    Keys:
        adhesion: adhesive shear of the contact
        measured: measured friction, a table beside the scene, drawn over the curve
    """

    call: ClassVar[str] = "friction"
    adhesion: ShearOfContact | None = None
    measured: Text | None = None


class Roller(Table):
    """A rigid roller on a cover of the same rubber, bonded to a rigid base: its rolling
    resistance is drawn beside the friction.

    Keys:
        radius: of the roller
        length: of the roller
        thickness: of the cover
        load: normal force
        velocity: velocity of rolling
    """

    radius: Length
    length: Length
    aside = True
    thickness: Length
    load: Force
    velocity: Sweep[Velocity]


class SurfaceFrictionScene(OfDraws):
    """Friction of a rough surface.

    Keys:
        surface: the rough surface
        contact: how it is pressed on and moved
        heat: flash temperature
        adhesion: adhesive shear on the area of real contact
        measured: measured friction, a table beside the scene, drawn over the curve
        doubts: what a calibration says against the numbers that it found
        roller: a roller on the same rubber, drawn beside the friction
    """

    mark: ClassVar[str] = "surface"
    call: ClassVar[str] = "friction"
    rough: ClassVar[str] = "shape"
    surface: AnySurface
    contact: SurfaceContact
    heat: HeatTable | None = None
    adhesion: ShearOfContact | None = None
    measured: Text | None = None
    doubts: Several[Text] | None = None
    roller: Roller | None = None

    def beside(self, folder: Path) -> Arguments | None:
        if (roller := self.roller) is None:
            return None
        rubbers = [
            em.layer(rubber, roller.thickness) for rubber in self.rubbers(folder)
        ]
        return on_axes(
            {"shape": em.Cylinder(roller.radius, roller.length)}
            | {"material": rubbers if len(rubbers) > 1 else rubbers[0]}
            | given(self, "temperature")
            | given(roller, "load", "velocity")
        )


class Compare(Table):
    """Where the materials are ranked.

    Keys:
        velocity: sliding velocity; by default the middle, on a logarithmic scale
        temperature: by default the middle
        pressure: nominal; by default the middle, on a logarithmic scale
    """

    aside = True
    velocity: Velocity | None = None
    temperature: Temperature | None = None
    pressure: Pressure | None = None


class SurfaceComparison(SurfaceFrictionScene):
    """Materials ranked by friction on a rough surface.

    Keys:
        roller: of elastomdr friction
        compare: where they are ranked
    """

    roller: None = None
    compare: Compare = Compare()


class BodyComparison(BodyFriction):
    """Materials ranked by friction under a body.

    Keys:
        compare: where they are ranked
    """

    compare: Compare = Compare()


class WarmingContact(ContactTable):
    """How the body is pressed on and how fast it rolls.

    Keys:
        load: normal force
    """

    one_of: ClassVar[tuple[str, ...]] = ("load",)
    load: Several[Force]


class HeatBuildUpTable(Table):
    """A rolling body that its own resistance heats.

    Keys:
        ambient: temperature of the surroundings
        conductance: from the body to its surroundings
        capacity: heat capacity of the body, for the way to the steady state
        duration: how long the body rolls
        points: instants of that time
        hottest: highest temperature considered, by default the material's
    """

    ambient: Several[Temperature]
    conductance: Conductance
    capacity: HeatCapacity | None = None
    duration: Duration | None = None
    points: Instants = 121
    hottest: Temperature | None = None

    def __post_init__(self) -> None:
        if (self.capacity is None) != (self.duration is None):
            raise InputError(
                argument="duration" if self.duration is None else "capacity",
                got=None,
                accepted="given, as capacity and duration belong together, or both left out",
            )

    def arguments(self, folder: Path) -> Arguments:
        import numpy as np

        found = given(self, "ambient", "conductance", "capacity", "hottest")
        if self.duration is not None:
            found["time"] = np.linspace(0, self.duration, self.points)
        return found


class WarmingScene(OfBodies):
    """Temperature of a rolling body.

    Keys:
        temperature: the body finds its own
        indenter: the rigid body
        contact: how it is pressed on and moved
        heat_build_up: what heats and cools it
    """

    mark: ClassVar[str] = "heat_build_up"
    call: ClassVar[str] = "heat_build_up"
    temperature: None = None
    indenter: AnyShape
    contact: WarmingContact
    heat_build_up: HeatBuildUpTable


class ConveyorContact(Table):
    """How fast the belt runs.

    Keys:
        velocity: velocity of the belt
    """

    velocity: Sweep[Velocity]


class ConveyorTable(Table):
    """A belt conveyor: roll and cover of the scene on the carry side, one roll in a set
    on the return side.

    Keys:
        spacing: distance of the sets of idlers on the carry side
        shares: of the load on a set, by roll; 1 by default
        belt: mass of the belt per length
        goods: mass of the goods per length
        return_spacing: distance of the rolls on the return side
        return_length: length of such a roll; by default that of all rolls of a set
        return_thickness: of the cover that it dents; by default that of the layer
    """

    aside = True
    spacing: Length
    shares: list[float] | None = None
    belt: LineMass
    goods: Several[LoadedMass]
    return_spacing: Length
    return_length: Length | None = None
    return_thickness: Length | None = None


class ConveyorScene(Scene):
    """Power of a belt conveyor.

    Keys:
        indenter: one roll of the carry side
        layer: the cover that it dents
        contact: how fast the belt runs
        conveyor: the belt
    """

    without: ClassVar[dict[str, str]] = {
        "uncertainty": "a belt takes no draws of its rubber; one roll on its cover does, "
        "in a scene without [conveyor]"
    }
    mark: ClassVar[str] = "conveyor"
    call: ClassVar[str] = "conveyor"
    indenter: CylinderTable
    layer: LayerTable
    contact: ConveyorContact
    conveyor: ConveyorTable

    def rubber(self, folder: Path) -> Arguments:
        belt, roll = self.conveyor, self.indenter
        found = super().rubber(folder)
        material: Any = found.pop("material")
        with named("[layer]"):
            carrying = self.layer.on_base(material)
            back = self.layer.on_base(material, belt.return_thickness)
        shares = belt.shares or [1.0]
        length = belt.return_length or len(shares) * roll.length
        with named("[conveyor]"):
            found["carry"] = em.Idlers(
                carrying, roll.make(folder), spacing=belt.spacing, shares=shares
            )
            found["back"] = em.Idlers(
                back, em.Cylinder(roll.radius, length), spacing=belt.return_spacing
            )
        return found | given(belt, "belt", "goods")

    def arguments(self, folder: Path) -> Arguments:
        found = super().arguments(folder)
        del found["shape"]  # which the idlers have
        return found


class TractionContact(ContactTable):
    """How the body is pressed on, how fast it rolls and how much it slips.

    Keys:
        load: normal force
        velocity: with a slip that of the road, with a creepage that of rolling
        slip: velocity of slip over that of the road, below 1
        creepage: velocity of slip over the rolling velocity, in place of the slip
    """

    one_of: ClassVar[tuple[str, ...]] = ("slip", "creepage")
    load: Several[Force]
    velocity: Sweep[Velocity]
    slip: Sweep[float] | None = None
    creepage: Sweep[float] | None = None


class _Traction(Scene):
    """Traction of a body that rolls.

    Keys:
        friction: Coulomb's coefficient, or a table mu(v, T, p) as elastomdr friction
            writes it
        indenter: the body
        contact: how it is pressed on and moved
    """

    call: ClassVar[str] = "traction"
    friction: float | str
    indenter: AnyShape
    contact: TractionContact

    def rubber(self, folder: Path) -> Arguments:
        """The rubber, and its friction."""
        friction: Any = self.friction
        if isinstance(friction, str):
            with path_from("friction", folder):
                friction = em.load_friction(folder / friction)
        return super().rubber(folder) | {"friction": friction}


class TractionScene(_Traction):
    """Traction of a ball on a half-space.

    Keys:
        indenter: the ball
    """

    indenter: OfRevolution


class Structure(Table):
    """What carries the load of a wheel.

    Keys:
        stiffness: of the structure, per area of the contact
    """

    aside = True
    stiffness: AreaStiffness


class Tread(Table):
    """What is sheared: a layer of the material.

    Keys:
        thickness: thickness
    """

    aside = True
    thickness: Length


class WheelTraction(_Traction):
    """Traction of a wheel.

    Keys:
        indenter: the wheel
        structure: what carries the load
        layer: the tread, which is sheared
    """

    mark: ClassVar[str] = "structure"
    indenter: CylinderTable
    structure: Structure
    layer: Tread

    @classmethod
    def fits(cls, content: Content) -> bool:
        """Whether the body is a cylinder."""
        shape = content.get("indenter")
        return isinstance(shape, dict) and shape.get("shape") == "cylinder"

    def rubber(self, folder: Path) -> Arguments:
        found = super().rubber(folder)
        rubber: Any = found["material"]
        carries = em.Foundation(
            self.structure.stiffness,
            [],
            [],
            name=f"{rubber.name or 'tread'} on an elastic structure",
        )
        sheared = em.springs(rubber, self.layer.thickness, tangential=True)
        return found | {"material": carries, "tangential": sheared}

    def further_files(self, result: "em.Traction") -> dict[str, Callable[[Path], None]]:
        """The Magic Formula as a property file, one for each temperature. Raises
        `InputError` where it cannot be fitted.
        """
        import numpy as np

        size = {"radius": self.indenter.radius, "width": self.indenter.length}
        distinct = np.unique(np.asarray(result.temperature, float)).tolist()
        ends: dict[str, float | None] = {".tir": None}
        if len(distinct) > 1:
            ends = {f"-{each - 273.15:.6g}degC.tir": each for each in distinct}
        with of_key("no .tir file"):
            for temperature in ends.values():
                result.magic_formula(temperature=temperature)
        return {
            end: partial(result.to_tir, temperature=temperature, **size)
            for end, temperature in ends.items()
        }
