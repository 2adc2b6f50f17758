"""Scenes of seals: a liquid that leaks through a static one, the force of an O-ring over
years, a rod that moves out and in, a film between a cylinder and rubber, the start of a
dry seal after a rest.
"""

from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import elastomdr as em

from ..errors import InputError
from .bodies import AnySurface, CylinderTable
from .scene import OfBodies, Scene, body, load, on_axes
from .schema import Positive, Several, Sweep, Table, Text, given, named
from .steady import OfDraws
from .units import (
    Angle,
    Density,
    Duration,
    Force,
    KinematicViscosity,
    Length,
    MolarMass,
    Pressure,
    Velocity,
    Viscosity,
)


class Ring(Table):
    """The cord of an O-ring, how it is squeezed, and its groove."""

    diameter: Annotated[Length, "diameter of the cord"]
    squeeze: Annotated[
        Several[Positive], "part of the diameter by which the cord is squeezed"
    ]
    time: Annotated[
        Sweep[Duration] | None, "since it was squeezed; by default long after"
    ] = None
    fluid_pressure: Annotated[
        Several[Pressure] | None, "of the sealed fluid, above that behind the ring"
    ] = None
    groove_width: Annotated[
        Length | None, "width of the groove, whose height is the squeezed diameter"
    ] = None
    formula: Annotated[
        Literal["lindley", "hertz", "held", "free"] | None,
        "load of the cord: lindley by default; hertz for small squeeze; held or free, "
        "of a ring that its groove keeps at its length, or that may lengthen",
    ] = None

    def arguments(self) -> dict[str, Any]:
        """What `em.o_ring` takes beside material and temperature."""
        return given(self, *Ring.__struct_fields__)


class LeakTable(Table):
    """How the seal is pressed, and what flows through it."""

    pressure: Annotated[
        Sweep[Pressure] | None,
        "of rubber and surface, that of the fluid between them included",
    ] = None
    profile: Annotated[
        Text | None,
        "in its place a file beside the scene, position [mm] and pressure [MPa] from the "
        "side of the fluid on",
    ] = None
    pressure_drop: Annotated[
        Sweep[Pressure], "of the fluid, below the largest pressure of the contact"
    ]
    viscosity: Annotated[Viscosity | None, "dynamic viscosity of the fluid"] = None
    kinematic_viscosity: Annotated[
        KinematicViscosity | None, "in its place, of a liquid, with density"
    ] = None
    length: Annotated[
        Length | None,
        "of the contact along the flow; a profile and an [o_ring] have their own",
    ] = None
    width: Annotated[
        Length | None, "of the contact across the flow, by default 1 m"
    ] = None
    density: Annotated[Density | None, "of the fluid: gives the mass rate as well"] = (
        None
    )
    outlet_pressure: Annotated[
        Pressure | None, "absolute, behind the seal: makes the fluid a gas"
    ] = None
    mean_free_path: Annotated[
        Length | None, "of the gas at the outlet: its slip at the walls"
    ] = None
    molar_mass: Annotated[
        MolarMass | None, "of the gas, with a temperature: its slip, and the mass rate"
    ] = None
    time: Annotated[
        Several[Duration] | None, "since it was pressed; by default long after"
    ] = None
    direction: Annotated[
        Angle | None,
        "of the flow, to the lay of a measured surface: 0 along its grooves",
    ] = None
    model: Annotated[
        Literal["multiscale", "critical constriction", "effective medium", "half-space"]
        | None,
        "what computes the channels, by default multiscale",
    ] = None


class LeakScene(OfDraws):
    """Leak of a static seal."""

    mark: ClassVar[str] = "leak"
    call: ClassVar[str] = "leak"
    surface: Annotated[AnySurface, "the roughness"]
    leak: Annotated[LeakTable, "how it is pressed, and what flows"]
    o_ring: Annotated[
        Ring | None, "presses with Hertz' ellipse, in place of pressure or profile"
    ] = None

    def arguments(self, folder: Path) -> dict[str, Any]:
        _without_rtol(self, "a leak")
        with named("[surface]"):
            surface = self.surface.drawn(folder, self.uncertainty)
        leak = given(self.leak, *LeakTable.__struct_fields__)
        if self.leak.profile is not None:
            leak["profile"] = folder / self.leak.profile
        if self.o_ring is None:
            return on_axes({"surface": surface} | self.common(folder) | leak)
        if "time" in leak:
            raise InputError(
                "[leak] time must be left out beside [o_ring]: it has its own."
            )
        of_ring = self.o_ring.arguments()
        common = self.common(folder)
        if isinstance(common["material"], list):
            raise InputError(
                "material must be a single one beside [o_ring], without uncertainty: "
                "each rubber has a ring of its own."
            )
        shaped = on_axes(common | of_ring | leak)
        names = ("material", "temperature", *of_ring)
        with named("[o_ring]"):
            ring = em.o_ring(**{key: shaped[key] for key in names if key in shaped})
        rest = {key: shaped[key] for key in (*common, *leak)}
        return {"surface": surface, "o_ring": ring} | rest


class LubricatedTable(Table):
    """How the bodies are pressed together and move, and what is between them."""

    velocity: Annotated[Sweep[Velocity], "velocity of what moves"]
    load: Annotated[Several[Force], "load on the length of the cylinder"]
    viscosity: Annotated[Viscosity, "dynamic viscosity of the liquid"]
    boundary_shear: Annotated[
        Pressure | None, "shear stress of the real contact, with a [surface]"
    ] = None
    time: Annotated[
        Several[Duration] | None,
        "since rubber that rests was pressed; by default long after",
    ] = None
    rubber: Annotated[
        Literal["rests", "passes", "rolls"] | None,
        "rests (a seal on a rod), by default; passes (under a slider); rolls",
    ] = None
    flow_factor: Annotated[
        Literal["maps", "patir-cheng"] | None,
        "of a rough contact: of maps, as a leak's, by default; or of Patir and Cheng",
    ] = None


class LubricatedScene(OfBodies):
    """Film and friction of a lubricated cylinder."""

    mark: ClassVar[str] = "lubricated"
    call: ClassVar[str] = "lubricated"
    indenter: Annotated[CylinderTable, "the cylinder; its radius is that of the gap"]
    surface: Annotated[
        AnySurface | None, "roughness of the counterface; without it, it is smooth"
    ] = None
    lubricated: Annotated[LubricatedTable, "how it is pressed and moved"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        _without_rtol(self, "a film")
        arguments = {"shape": body(self.indenter, folder)}
        if self.surface is not None:
            with named("[surface]"):
                arguments["surface"] = self.surface.drawn(folder, None)
        keys = LubricatedTable.__struct_fields__
        return on_axes(arguments | self.common(folder) | given(self.lubricated, *keys))


class RingScene(Scene):
    """Sealing force of a squeezed O-ring."""

    mark: ClassVar[str] = "o_ring"
    call: ClassVar[str] = "o_ring"
    o_ring: Annotated[Ring, "the cord, its squeeze and its groove"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        _without_rtol(self, "an O-ring")
        rubber = load(folder, "material", self.material[0])
        common = {"material": rubber} | given(self, "temperature")
        return on_axes(common | self.o_ring.arguments())


class Stroke(Table):
    """How the rod moves, and in what fluid."""

    velocity_out: Annotated[Sweep[Velocity], "velocity of the rod, out of the fluid"]
    velocity_in: Annotated[Velocity, "velocity of the rod, into the fluid"]
    length: Annotated[Length, "length of the stroke"]
    viscosity: Annotated[Viscosity, "dynamic viscosity of the fluid"]
    width: Annotated[
        Length | None, "length of the seal along its edge, by default 1 m"
    ] = None


class StrokeScene(RingScene):
    """Films, net leak and friction of an O-ring on a rod that moves out and in."""

    mark: ClassVar[str] = "stroke"
    call: ClassVar[str] = "reciprocating"
    stroke: Annotated[Stroke, "how the rod moves, and in what fluid"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        ring = super().arguments(folder)
        with named("[o_ring]"):
            o_ring = em.o_ring(**ring)
        if o_ring.line_load.ndim:
            raise InputError(
                "[o_ring] must be one ring on a rod: a single squeeze, time, pressure "
                "and temperature."
            )
        stroke = given(self.stroke, "velocity_out", "velocity_in", "viscosity", "width")
        stroke |= {"stroke": self.stroke.length}
        return on_axes({"material": ring["material"], "o_ring": o_ring} | stroke)


class BreakOutTable(Table):
    """How the seal is pressed and for how long it rests, and what holds it."""

    pressure: Annotated[Several[Pressure], "nominal pressure of rubber and surface"]
    boundary_shear: Annotated[Pressure, "shear stress of the real contact"]
    time: Annotated[
        Sweep[Duration] | None, "dwell under the pressure; by default long after"
    ] = None


class BreakOutScene(Scene):
    """Break-out of a dry seal after a dwell."""

    mark: ClassVar[str] = "break_out"
    call: ClassVar[str] = "break_out"
    surface: Annotated[AnySurface, "the roughness"]
    break_out: Annotated[
        BreakOutTable, "how it is pressed and rests, and what holds it"
    ]

    def arguments(self, folder: Path) -> dict[str, Any]:
        _without_rtol(self, "a break-out")
        rubber = load(folder, "material", self.material[0])
        with named("[surface]"):
            surface = self.surface.drawn(folder, None)
        return on_axes(
            {"material": rubber, "surface": surface}
            | given(self, "temperature")
            | given(self.break_out, *BreakOutTable.__struct_fields__)
        )


def _without_rtol(scene: Scene, what: str) -> None:
    if scene.numerics.rtol is not None:
        raise InputError(f"[numerics] does not belong to {what}: it has no rtol.")
