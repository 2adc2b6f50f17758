"""Scenes of seals: a liquid that leaks through a static one, the force of an O-ring over
years, a rod that moves out and in, a film between a cylinder and rubber, the start of a
dry seal after a rest.
"""

from pathlib import Path
from typing import Any, ClassVar, Literal

import elastomdr as em

from ..errors import InputError
from .bodies import AnySurface, CylinderTable
from .scene import OfBodies, Scene
from .schema import Arguments, Positive, Several, Sweep, Table, Text, given, named
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
    """The cord of an O-ring, how it is squeezed, and its groove.

    Keys:
        diameter: diameter of the cord
        squeeze: part of the diameter by which the cord is squeezed
        time: since it was squeezed; by default long after
        fluid_pressure: of the sealed fluid, above that behind the ring
        groove_width: width of the groove, whose height is the squeezed diameter
        formula: load of the cord: lindley by default; hertz for small squeeze; held or
            free, of a ring that its groove keeps at its length, or that may lengthen
    """

    diameter: Length
    squeeze: Several[Positive]
    time: Sweep[Duration] | None = None
    fluid_pressure: Several[Pressure] | None = None
    groove_width: Length | None = None
    formula: Literal["lindley", "hertz", "held", "free"] | None = None


class LeakTable(Table):
    """How the seal is pressed, and what flows through it.

    Keys:
        pressure: of rubber and surface, that of the fluid between them included
        profile: in its place a file beside the scene, position [mm] and pressure [MPa]
            from the side of the fluid on
        pressure_drop: of the fluid, below the largest pressure of the contact
        viscosity: dynamic viscosity of the fluid
        kinematic_viscosity: in its place, of a liquid, with density
        length: of the contact along the flow; a profile and an [o_ring] have their own
        width: of the contact across the flow, by default 1 m
        density: of the fluid: gives the mass rate as well
        outlet_pressure: absolute, behind the seal: makes the fluid a gas
        mean_free_path: of the gas at the outlet: its slip at the walls
        molar_mass: of the gas, with a temperature: its slip, and the mass rate
        time: since it was pressed; by default long after
        direction: of the flow, to the lay of a measured surface: 0 along its grooves
        model: what computes the channels, by default multiscale
    """

    pressure: Sweep[Pressure] | None = None
    profile: Text | None = None
    pressure_drop: Sweep[Pressure]
    viscosity: Viscosity | None = None
    kinematic_viscosity: KinematicViscosity | None = None
    length: Length | None = None
    width: Length | None = None
    density: Density | None = None
    outlet_pressure: Pressure | None = None
    mean_free_path: Length | None = None
    molar_mass: MolarMass | None = None
    time: Several[Duration] | None = None
    direction: Angle | None = None
    model: (
        Literal["multiscale", "critical constriction", "effective medium", "half-space"]
        | None
    ) = None

    def arguments(self, folder: Path) -> Arguments:
        files = {} if self.profile is None else {"profile": folder / self.profile}
        return given(self) | files


class LeakScene(OfDraws):
    """Leak of a static seal.

    Keys:
        surface: the roughness
        leak: how it is pressed, and what flows
        o_ring: presses with Hertz' ellipse, in place of pressure or profile
    """

    mark: ClassVar[str] = "leak"
    call: ClassVar[str] = "leak"
    numerics: None = None  # type: ignore[assignment]
    surface: AnySurface
    leak: LeakTable
    o_ring: Ring | None = None

    def arguments(self, folder: Path) -> Arguments:
        found = super().arguments(folder)
        if self.o_ring is None:
            return found
        if self.leak.time is not None:
            raise InputError(
                argument="[leak] time",
                got=self.leak.time,
                accepted="left out beside [o_ring], which has its own",
            )
        if isinstance(found["material"], list):
            raise InputError(
                argument="material",
                got=list(self.material),
                accepted="a single one beside [o_ring], without uncertainty",
                hint="each rubber has a ring of its own",
            )
        return found | {"o_ring": _squeezed(self.o_ring, found)}


def _squeezed(ring: Ring, found: Arguments) -> "em.ORing":
    """A ring of what its scene holds, from which its own keys are taken."""
    common = {key: found[key] for key in ("material", "temperature") if key in found}
    own: dict[str, Any] = common | {key: found.pop(key) for key in given(ring)}
    with named("[o_ring]"):
        return em.o_ring(**own)


class LubricatedTable(Table):
    """How the bodies are pressed together and move, and what is between them.

    Keys:
        velocity: velocity of what moves
        load: load on the length of the cylinder
        viscosity: dynamic viscosity of the liquid
        boundary_shear: shear stress of the real contact, with a [surface]
        time: since rubber that rests was pressed; by default long after
        rubber: rests (a seal on a rod), by default; passes (under a slider); rolls
        flow_factor: of a rough contact: of maps, as a leak's, by default; or of Patir
            and Cheng
    """

    velocity: Sweep[Velocity]
    load: Several[Force]
    viscosity: Viscosity
    boundary_shear: Pressure | None = None
    time: Several[Duration] | None = None
    rubber: Literal["rests", "passes", "rolls"] | None = None
    flow_factor: Literal["maps", "patir-cheng"] | None = None


class LubricatedScene(OfBodies):
    """Film and friction of a lubricated cylinder.

    Keys:
        indenter: the cylinder; its radius is that of the gap
        surface: roughness of the counterface; without it, it is smooth
        lubricated: how it is pressed and moved
    """

    mark: ClassVar[str] = "lubricated"
    call: ClassVar[str] = "lubricated"
    numerics: None = None  # type: ignore[assignment]
    indenter: CylinderTable
    surface: AnySurface | None = None
    lubricated: LubricatedTable


class RingScene(Scene):
    """Sealing force of a squeezed O-ring.

    Keys:
        o_ring: the cord, its squeeze and its groove
    """

    mark: ClassVar[str] = "o_ring"
    call: ClassVar[str] = "o_ring"
    numerics: None = None  # type: ignore[assignment]
    o_ring: Ring


class Stroke(Table):
    """How the rod moves, and in what fluid.

    Keys:
        velocity_out: velocity of the rod, out of the fluid
        velocity_in: velocity of the rod, into the fluid
        length: length of the stroke
        viscosity: dynamic viscosity of the fluid
        width: length of the seal along its edge, by default 1 m
    """

    velocity_out: Sweep[Velocity]
    velocity_in: Velocity
    length: Length
    viscosity: Viscosity
    width: Length | None = None


class StrokeScene(RingScene):
    """Films, net leak and friction of an O-ring on a rod that moves out and in.

    Keys:
        stroke: how the rod moves, and in what fluid
    """

    mark: ClassVar[str] = "stroke"
    call: ClassVar[str] = "reciprocating"
    stroke: Stroke

    def arguments(self, folder: Path) -> Arguments:
        found = super().arguments(folder)
        ring = _squeezed(self.o_ring, found)
        if ring.line_load.ndim:
            raise InputError(
                argument="[o_ring] squeeze",
                got=ring.line_load,
                accepted="such that there is one ring on a rod",
                hint="a single squeeze, time, pressure and temperature",
            )
        found.pop("temperature", None)  # the ring has it
        return found | {"o_ring": ring, "stroke": found.pop("length")}


class BreakOutTable(Table):
    """How the seal is pressed and for how long it rests, and what holds it.

    Keys:
        pressure: nominal pressure of rubber and surface
        boundary_shear: shear stress of the real contact
        time: dwell under the pressure; by default long after
    """

    pressure: Several[Pressure]
    boundary_shear: Pressure
    time: Sweep[Duration] | None = None


class BreakOutScene(Scene):
    """Break-out of a dry seal after a dwell.

    Keys:
        surface: the roughness
        break_out: how it is pressed and rests, and what holds it
    """

    mark: ClassVar[str] = "break_out"
    call: ClassVar[str] = "break_out"
    numerics: None = None  # type: ignore[assignment]
    surface: AnySurface
    break_out: BreakOutTable
