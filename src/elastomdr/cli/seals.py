"""Scenes of `elastomdr leak` and `elastomdr lubricated`: a liquid that leaks through a
static seal, a film between a cylinder and rubber.
"""

from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from ..errors import InputError
from .bodies import AnySurface, Cylinder
from .scene import OfBodies, body, on_axes
from .schema import Several, Sweep, Table, given, named
from .steady import OfDraws
from .units import (
    Density,
    Duration,
    Force,
    Length,
    MolarMass,
    Pressure,
    Velocity,
    Viscosity,
)


class Leak(Table):
    """How the seal is pressed, and what flows through it."""

    pressure: Annotated[
        Sweep[Pressure], "of rubber and surface, over that of the fluid between them"
    ]
    pressure_drop: Annotated[Pressure, "of the fluid, below the pressure"]
    viscosity: Annotated[Viscosity, "dynamic viscosity of the fluid"]
    length: Annotated[Length, "of the contact along the flow"]
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
    leak: Annotated[Leak, "how it is pressed, and what flows"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        if self.numerics.rtol is not None:
            raise InputError("[numerics] does not belong to a leak: it has no rtol.")
        with named("[surface]"):
            surface = self.surface.drawn(folder, self.uncertainty)
        keys = Leak.__struct_fields__
        return on_axes(
            {"surface": surface} | self.common(folder) | given(self.leak, *keys)
        )


class Lubricated(Table):
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
    indenter: Annotated[Cylinder, "the cylinder; its radius is that of the gap"]
    surface: Annotated[
        AnySurface | None, "roughness of the counterface; without it, it is smooth"
    ] = None
    lubricated: Annotated[Lubricated, "how it is pressed and moved"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        if self.numerics.rtol is not None:
            raise InputError("[numerics] does not belong to a film: it has no rtol.")
        arguments = {"shape": body(self.indenter, folder)}
        if self.surface is not None:
            with named("[surface]"):
                arguments["surface"] = self.surface.drawn(folder, None)
        keys = Lubricated.__struct_fields__
        return on_axes(arguments | self.common(folder) | given(self.lubricated, *keys))
