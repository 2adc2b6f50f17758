"""Scenes of steady motion: `elastomdr friction`, `rolling` with its heat and a whole belt,
`compare`, and `traction` of a wheel or a ball.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar

import msgspec

import elastomdr as em

from ..errors import InputError
from .bodies import (
    Adhesion,
    AnyShape,
    AnySurface,
    CylinderTable,
    HeatTable,
    OfRevolution,
)
from .scene import ContactTable, LayerTable, OfBodies, Scene, body, load, on_axes
from .schema import (
    Draws,
    Instants,
    Several,
    Sweep,
    Table,
    Text,
    given,
    named,
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
    """How the body is pressed on and how fast it moves."""

    one_of: ClassVar[tuple[str, ...]] = ("load", "depth")
    load: Annotated[Several[Force] | None, "normal force"] = None
    depth: Annotated[
        Several[Length] | None, "indentation depth, in place of the load"
    ] = None

    of_others: ClassVar[dict[str, str]] = {
        "pressure": (
            "A body is pressed on with a load or a depth; a nominal pressure is that "
            "of a [surface]."
        )
    }


class SurfaceContact(ContactTable):
    """How the surface is pressed on and how fast it slides."""

    one_of: ClassVar[tuple[str, ...]] = ("pressure", "load", "depth")
    pressure: Annotated[Several[Pressure] | None, "nominal pressure"] = None
    load: Annotated[
        Several[LineLoad] | None, "force per length of a line, in place of the pressure"
    ] = None
    depth: Annotated[
        Several[Length] | None, "depth of the highest point of a line, in place of it"
    ] = None
    strain_share: Annotated[
        float | None,
        "strain at a scale over the rms slope up to it, of a rubber that softens",
    ] = None
    direction: Annotated[
        Several[Angle] | None,
        "of sliding, to the lay of a measured surface: 0 along its grooves",
    ] = None

    def arguments(self) -> dict[str, Any]:
        """As of every contact, with what goes with a softening and with a lay."""
        return super().arguments() | given(self, "strain_share", "direction")


class OfDraws(OfBodies):
    """A scene whose result may have a band of the uncertainty of its material and
    road.
    """

    uncertainty: Annotated[
        Draws | None,
        (
            "number of draws for the band, 2 or more: of the [misfit] in the "
            "material's file, and of the road"
        ),
    ] = None

    def rubbers(self, folder: Path) -> list[Any]:
        """The materials, or draws of the one. Raises `InputError` where nothing is
        known of its uncertainty.
        """
        materials = super().rubbers(folder)
        if self.uncertainty is None:
            return materials
        if len(materials) > 1 or self.other is not None:
            raise InputError("uncertainty belongs to a single material, without other.")
        if not isinstance(materials[0], em.Prony):
            raise InputError(
                "uncertainty must be left out with a material that is a table of "
                "moduli: it has no draws."
            )
        with named("uncertainty:"):
            return materials[0].draws(self.uncertainty)


class RollingScene(OfDraws):
    """Rolling resistance of a body."""

    call: ClassVar[str] = "rolling"
    indenter: Annotated[AnyShape, "the rigid body"]
    contact: Annotated[BodyContact, "how it is pressed on and moved"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        return on_axes(
            {"shape": body(self.indenter, folder)}
            | self.common(folder)
            | self.contact.arguments()
        )


class BodyFriction(RollingScene):
    """Friction of a body."""

    call: ClassVar[str] = "friction"
    adhesion: Annotated[Adhesion | None, "adhesive shear of the contact"] = None
    measured: Annotated[
        Text | None, "measured friction, a table beside the scene, drawn over the curve"
    ] = None

    def arguments(self, folder: Path) -> dict[str, Any]:
        return super().arguments(folder) | (
            {} if self.adhesion is None else {"adhesion": self.adhesion.make()}
        )


class Roller(Table):
    """A rigid roller on a cover of the same rubber, bonded to a rigid base: its rolling
    resistance is drawn beside the friction.
    """

    radius: Annotated[Length, "of the roller"]
    length: Annotated[Length, "of the roller"]
    thickness: Annotated[Length, "of the cover"]
    load: Annotated[Force, "normal force"]
    velocity: Annotated[Sweep[Velocity], "velocity of rolling"]


class SurfaceFrictionScene(OfDraws):
    """Friction of a rough surface."""

    mark: ClassVar[str] = "surface"
    call: ClassVar[str] = "friction"
    surface: Annotated[AnySurface, "the rough surface"]
    contact: Annotated[SurfaceContact, "how it is pressed on and moved"]
    heat: Annotated[HeatTable | None, "flash temperature"] = None
    adhesion: Annotated[
        Adhesion | None, "adhesive shear on the area of real contact"
    ] = None
    measured: Annotated[
        Text | None, "measured friction, a table beside the scene, drawn over the curve"
    ] = None

    roller: Annotated[
        Roller | None, "a roller on the same rubber, drawn beside the friction"
    ] = None

    def beside(self, folder: Path) -> dict[str, Any] | None:
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

    def arguments(self, folder: Path) -> dict[str, Any]:
        with named("[surface]"):
            surface = self.surface.drawn(folder, self.uncertainty)
        heat = {}
        if self.heat is not None:
            heat = {"heat": self.heat.make()} | given(self.heat, "branch")
        shear = {} if self.adhesion is None else {"adhesion": self.adhesion.make()}
        return on_axes(
            {"shape": surface}
            | self.common(folder)
            | self.contact.arguments()
            | heat
            | shear
        )


class Compare(Table):
    """Where the materials are ranked."""

    velocity: Annotated[
        Velocity | None,
        "sliding velocity; by default the middle, on a logarithmic scale",
    ] = None
    temperature: Annotated[Temperature | None, "by default the middle"] = None
    pressure: Annotated[
        Pressure | None, "nominal; by default the middle, on a logarithmic scale"
    ] = None

    def place(self) -> dict[str, Any]:
        """The place, in SI units."""
        return given(self, "velocity", "temperature", "pressure")


class SurfaceComparison(SurfaceFrictionScene):
    """Materials ranked by friction on a rough surface."""

    roller: Annotated[None, "of elastomdr friction"] = None
    compare: Annotated[Compare, "where they are ranked"] = Compare()


class BodyComparison(BodyFriction):
    """Materials ranked by friction under a body."""

    compare: Annotated[Compare, "where they are ranked"] = Compare()


class WarmingContact(ContactTable):
    """How the body is pressed on and how fast it rolls."""

    one_of: ClassVar[tuple[str, ...]] = ("load",)
    load: Annotated[Several[Force], "normal force"]


class HeatBuildUpTable(Table):
    """A rolling body that its own resistance heats."""

    ambient: Annotated[Several[Temperature], "temperature of the surroundings"]
    conductance: Annotated[Conductance, "from the body to its surroundings"]
    capacity: Annotated[
        HeatCapacity | None,
        "heat capacity of the body, for the way to the steady state",
    ] = None
    duration: Annotated[Duration | None, "how long the body rolls"] = None
    points: Annotated[Instants, "instants of that time"] = 121
    hottest: Annotated[
        Temperature | None, "highest temperature considered, by default the material's"
    ] = None

    def __post_init__(self) -> None:
        if (self.capacity is None) != (self.duration is None):
            raise InputError(
                "capacity and duration belong together: give both for the "
                "history, or neither."
            )


class WarmingScene(OfBodies):
    """Temperature of a rolling body."""

    mark: ClassVar[str] = "heat_build_up"
    call: ClassVar[str] = "heat_build_up"
    temperature: Annotated[None, "the body finds its own"] = None
    indenter: Annotated[AnyShape, "the rigid body"]
    contact: Annotated[WarmingContact, "how it is pressed on and moved"]
    heat_build_up: Annotated[HeatBuildUpTable, "what heats and cools it"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        import numpy as np

        given_to_verb = (
            {"shape": body(self.indenter, folder)}
            | self.common(folder)
            | self.contact.arguments()
        )
        given_to_verb |= given(
            self.heat_build_up, "ambient", "conductance", "capacity", "hottest"
        )
        if self.heat_build_up.duration is not None:
            given_to_verb["time"] = np.linspace(
                0, self.heat_build_up.duration, self.heat_build_up.points
            )
        return on_axes(given_to_verb)


class ConveyorContact(Table):
    """How fast the belt runs."""

    velocity: Annotated[Sweep[Velocity], "velocity of the belt"]


class ConveyorTable(Table):
    """A belt conveyor: roll and cover of the scene on the carry side, one roll in a set
    on the return side.
    """

    spacing: Annotated[Length, "distance of the sets of idlers on the carry side"]
    shares: Annotated[
        Annotated[list[float], msgspec.Meta(min_length=1)] | None,
        "of the load on a set, by roll; 1 by default",
    ] = None
    belt: Annotated[LineMass, "mass of the belt per length"]
    goods: Annotated[Several[LoadedMass], "mass of the goods per length"]
    return_spacing: Annotated[Length, "distance of the rolls on the return side"]
    return_length: Annotated[
        Length | None, "length of such a roll; by default that of all rolls of a set"
    ] = None
    return_thickness: Annotated[
        Length | None, "of the cover that it dents; by default that of the layer"
    ] = None


class ConveyorScene(Scene):
    """Power of a belt conveyor."""

    mark: ClassVar[str] = "conveyor"
    call: ClassVar[str] = "conveyor"
    indenter: Annotated[CylinderTable, "one roll of the carry side"]
    layer: Annotated[LayerTable, "the cover that it dents"]
    contact: Annotated[ConveyorContact, "how fast the belt runs"]
    conveyor: Annotated[ConveyorTable, "the belt"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        belt, roll, layer = self.conveyor, self.indenter, self.layer
        material = load(folder, "material", self.material[0])
        with named("[layer]"):
            carrying = layer.on_base(material)
            back = layer.on_base(material, belt.return_thickness)
        shares = belt.shares or [1.0]
        length = belt.return_length or len(shares) * roll.length
        with named("[conveyor]"):
            sides = {
                "carry": em.Idlers(
                    carrying, body(roll, folder), spacing=belt.spacing, shares=shares
                ),
                "back": em.Idlers(
                    back, em.Cylinder(roll.radius, length), spacing=belt.return_spacing
                ),
            }
        options = (
            given(self, "temperature")
            | self.numerics.chosen()
            | given(belt, "belt", "goods")
        )
        return sides | on_axes(options | {"velocity": self.contact.velocity})


class TractionContact(ContactTable):
    """How the body is pressed on, how fast it rolls and how much it slips."""

    one_of: ClassVar[tuple[str, ...]] = ("slip", "creepage")
    load: Annotated[Several[Force], "normal force"]
    velocity: Annotated[
        Sweep[Velocity], "with a slip that of the road, with a creepage that of rolling"
    ]
    slip: Annotated[
        Sweep[float] | None, "velocity of slip over that of the road, below 1"
    ] = None
    creepage: Annotated[
        Sweep[float] | None,
        "velocity of slip over the rolling velocity, in place of the slip",
    ] = None


class _Traction(Scene):
    """Traction of a body that rolls."""

    call: ClassVar[str] = "traction"
    friction: Annotated[
        float | str,
        "Coulomb's coefficient, or a table mu(v, T, p) as elastomdr friction writes it",
    ]
    indenter: Annotated[AnyShape, "the body"]
    contact: Annotated[TractionContact, "how it is pressed on and moved"]

    def rolling(self, folder: Path) -> dict[str, Any]:
        """The arguments but for the material."""
        friction: Any = self.friction
        if isinstance(friction, str):
            with path_from("friction"):
                friction = em.load_friction(folder / friction)
        arguments = given(self, "temperature") | self.numerics.chosen()
        arguments |= given(self.contact, "load") | self.contact.arguments()
        return {"shape": body(self.indenter, folder), "friction": friction} | on_axes(
            arguments
        )


class TractionScene(_Traction):
    """Traction of a ball on a half-space."""

    indenter: Annotated[OfRevolution, "the ball"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        return self.rolling(folder) | {
            "material": load(folder, "material", self.material[0])
        }


class Structure(Table):
    """What carries the load of a wheel."""

    stiffness: Annotated[AreaStiffness, "of the structure, per area of the contact"]


class Tread(Table):
    """What is sheared: a layer of the material."""

    thickness: Annotated[Length, "thickness"]


class WheelTraction(_Traction):
    """Traction of a wheel."""

    mark: ClassVar[str] = "structure"
    indenter: Annotated[CylinderTable, "the wheel"]
    structure: Annotated[Structure, "what carries the load"]
    layer: Annotated[Tread, "the tread, which is sheared"]

    @classmethod
    def fits(cls, content: dict[str, Any]) -> bool:
        """Whether the body is a cylinder."""
        shape = content.get("indenter")
        return isinstance(shape, dict) and shape.get("shape") == "cylinder"

    def arguments(self, folder: Path) -> dict[str, Any]:
        rubber = load(folder, "material", self.material[0])
        carries = em.Foundation(
            self.structure.stiffness,
            [],
            [],
            name=f"{rubber.name or 'tread'} on an elastic structure",
        )
        sheared = em.springs(rubber, self.layer.thickness, tangential=True)
        return self.rolling(folder) | {"material": carries, "tangential": sheared}

    def said(self, result: Any) -> str:
        """Why there is no property file, where there is none."""
        try:
            self._temperatures(result)
        except InputError as error:
            return f"no .tir file: {error}"
        return ""

    def further_files(self, result: Any) -> dict[str, Callable[[Path], None]]:
        """The Magic Formula as a property file, one for each temperature; none where it
        cannot be fitted.
        """
        try:
            temperatures = self._temperatures(result)
        except InputError:  # said below the summary
            return {}
        size = {"radius": self.indenter.radius, "width": self.indenter.length}
        return {
            end: partial(result.to_tir, temperature=temperature, **size)
            for end, temperature in temperatures.items()
        }

    @staticmethod
    def _temperatures(result: Any) -> dict[str, float | None]:
        """The temperatures of which a Magic Formula is fitted, by the ends of their
        files. Raises `InputError`.
        """
        import numpy as np

        distinct = (
            [] if result.temperature is None else np.unique(result.temperature).tolist()
        )
        several = {
            f"-{temperature - 273.15:.6g}degC.tir": temperature
            for temperature in distinct
        }
        temperatures: dict[str, float | None] = (
            {".tir": None} if len(distinct) < 2 else {**several}
        )
        for temperature in temperatures.values():
            result.magic_formula(temperature=temperature)
        return temperatures
