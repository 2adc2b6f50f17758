"""What meets the rubber in a scene: an [indenter], a [surface] with its [heat] and
[adhesion]; one table for each kind.
"""

import abc
import math
from pathlib import Path
from typing import Any, Literal

import msgspec

import elastomdr as em

from .._types import Branch, Dry, Road, Rubber
from ..errors import InputError, amount
from .schema import (
    Arguments,
    Count,
    Positive,
    Several,
    Table,
    Text,
    given,
    keys_of,
    of_key,
    only_one,
    path_from,
)
from .units import (
    Conductivity,
    EquivalentLength,
    Length,
    MolarEnergy,
    Pressure,
    SceneQuantity,
    Temperature,
    Velocity,
    VolumeCapacity,
    WaveNumber,
)


class Shape(Table, tag_field="shape"):
    """A rigid body."""

    def arguments(self, folder: Path) -> Arguments:
        return {"shape": self.make(folder)}

    def make(self, folder: Path) -> Any:
        """The body; files are looked for in `folder`."""
        return getattr(em, type(self).__name__.removesuffix("Table"))(
            *msgspec.structs.astuple(self)
        )


class SphereTable(Shape, tag="sphere"):
    """A sphere.

    Keys:
        radius: radius
    """

    radius: Length


class ParaboloidTable(Shape, tag="paraboloid"):
    """A paraboloid of revolution.

    Keys:
        radius: radius of curvature at the apex
    """

    radius: Length


class ConeTable(Shape, tag="cone"):
    """A cone.

    Keys:
        slope: rise of its side over the distance from the axis
    """

    slope: Positive


class FlatPunchTable(Shape, tag="flat_punch"):
    """A cylinder on its flat end.

    Keys:
        radius: radius
    """

    radius: Length


class PowerLawTable(Shape, tag="power_law"):
    """A body of revolution of height coefficient times r to the exponent.

    Keys:
        exponent: exponent
        coefficient: in length^(1 - exponent), such as "100 m^-1"; a number for a cone
    """

    exponent: Positive
    coefficient: str | float

    def make(self, folder: Path) -> Any:
        power = f"{1 - self.exponent:.12g}"
        coefficient = self.coefficient
        if self.exponent != 1 or isinstance(coefficient, str):

            class Coefficient(
                SceneQuantity,
                what=f"in m^{power}",
                unit=f"m**({power})",
                example=f"100 m^{power}",
            ): ...

            with of_key("coefficient"):
                coefficient = Coefficient.read(coefficient)
        return em.PowerLaw(self.exponent, coefficient)


class ProfileTable(Shape, tag="profile"):
    """A body of revolution given by points of its profile.

    Keys:
        unit: unit of length of the points, such as "mm"
        r: distances from the axis, from 0 on
        z: heights at these distances
        apex: at the axis; by default the points decide
        curve: between the points
    """

    unit: Text
    r: list[float]
    z: list[float]
    apex: Literal["auto", "smooth", "sharp"] = "auto"
    curve: Literal["auto", "spline", "monotone"] = "auto"

    def make(self, folder: Path) -> Any:
        with of_key("unit"):
            metres = Length.convert("1", self.unit)
        return em.Profile(
            [metres * x for x in self.r],
            [metres * x for x in self.z],
            apex=self.apex,
            curve=self.curve,
        )


class CylinderTable(Shape, tag="cylinder"):
    """A cylinder that lies on a layer: a roller, a wheel.

    Keys:
        radius: radius
        length: length of its line of contact, across the direction of motion
    """

    radius: Length
    length: Length


OfRevolution = (
    SphereTable
    | ParaboloidTable
    | ConeTable
    | FlatPunchTable
    | PowerLawTable
    | ProfileTable
)
AnyShape = OfRevolution | CylinderTable


_OF_LINE = ("equivalent_length", "seed", "periods", "samples")


class SurfaceTable(Table, tag_field="shape"):
    """A rough surface.

    Keys:
        equivalent_length: elastomdr slide: as in [contact] of friction
        seed: elastomdr slide: which line of the surface
        periods: elastomdr slide: length of the line in longest waves
        samples: elastomdr slide: samples of the line, 64 or more
        cutoff: upper cutoff in place of that of the shape; beyond its last wave C goes on
            as its last power law
        heights: factor on all heights
        level_error: relative standard deviation of C, for what friction rests on
        cutoff_error: relative standard deviation of the upper cutoff, likewise
    """

    equivalent_length: EquivalentLength | None = None
    seed: Count | None = None
    periods: Count | None = None
    samples: Count | None = None
    cutoff: WaveNumber | None = None
    heights: Positive | None = None
    level_error: Positive | None = None
    cutoff_error: Positive | None = None

    @abc.abstractmethod
    def make(self, folder: Path) -> Any:
        """The surface; files are looked for in `folder`."""

    def changed(self, folder: Path) -> Any:
        """The surface with its cutoff and factor."""
        surface = self.make(folder)
        if self.cutoff is not None:
            with of_key("cutoff:"):
                surface = surface.ended(self.cutoff)
        return surface if self.heights is None else surface.raised(self.heights)

    def drawn(self, folder: Path, count: int | None) -> Any:
        """The surface, where no line of it is asked for, or so many draws of it where
        its errors are given: None for none, 0 where errors mean nothing.
        """
        for key in given(self, *_OF_LINE):
            raise InputError(
                argument=key,
                got=getattr(self, key),
                accepted="left out here, where it stands in [contact], beside the model",
                hint="it belongs to elastomdr slide",
            )
        surface = self.changed(folder)
        errors = self.errors()
        if errors and count == 0:
            raise InputError(
                argument=f"{next(iter(errors))}_error",
                accepted="left out, or beside uncertainty, the number of draws",
                hint="without draws only elastomdr friction makes use of it",
            )
        return surface.draws(count, seed=1, **errors) if errors and count else surface

    def errors(self) -> dict[str, float]:
        """How well the surface is known, in the words of its `draws`."""
        stated = given(self, "level_error", "cutoff_error")
        return {name.removesuffix("_error"): size for name, size in stated.items()}

    def line(self, folder: Path) -> tuple[Any, float]:
        """One line of the surface, and the length that turns a pressure into its load
        [m].
        """
        if self.samples is not None and self.samples < 64:
            raise InputError(
                argument="samples", got=self.samples, accepted="64 or more"
            )
        surface = self.changed(folder)
        length = self.equivalent_length or 2 * math.pi / float(surface.q_low)
        if isinstance(length, str):
            length = surface.full_contact_length
        return surface.line(**given(self, *_OF_LINE[1:])), float(length)


class SelfAffineTable(SurfaceTable, tag="self_affine"):
    """A self-affine surface between two wavelengths.

    Keys:
        hurst: Hurst exponent
        rms_slope: rms slope of the surface; that of a cut is smaller by the root of 2
        rms_height: rms height, in place of the slope
        longest: longest wavelength, or q_low
        shortest: shortest wavelength, or q_high
        rolloff: wavelength above which the spectrum is flat, or q_rolloff
        q_low: smallest wave number
        q_high: largest wave number
        q_rolloff: wave number below which the spectrum is flat
    """

    hurst: float
    rms_slope: Positive | None = None
    rms_height: Length | None = None
    longest: Length | None = None
    shortest: Length | None = None
    rolloff: Length | None = None
    q_low: WaveNumber | None = None
    q_high: WaveNumber | None = None
    q_rolloff: WaveNumber | None = None

    def __post_init__(self) -> None:
        only_one(self, "rms_slope", "rms_height")
        only_one(self, "longest", "q_low")
        only_one(self, "shortest", "q_high")
        if self.rolloff is not None and self.q_rolloff is not None:
            raise InputError(
                argument="q_rolloff",
                got=self.q_rolloff,
                accepted="left out where rolloff is given",
            )
        q = self._wave_numbers()
        knee = q.get("q_rolloff", q["q_low"])
        if self.rolloff is not None and knee < q["q_low"]:
            raise InputError(
                argument="rolloff",
                got=self.rolloff,
                accepted="at most the longest wave, "
                + amount(2 * math.pi / q["q_low"], "m"),
            )
        if self.shortest is not None and q["q_high"] <= knee:
            raise InputError(
                argument="shortest",
                got=self.shortest,
                accepted="below "
                + amount(2 * math.pi / knee, "m")
                + ", where the spectrum begins to fall",
            )

    def _wave_numbers(self) -> dict[str, float]:
        waves = {
            "q_low": self.longest,
            "q_high": self.shortest,
            "q_rolloff": self.rolloff,
        }
        return {
            key: 2 * math.pi / wave for key, wave in waves.items() if wave is not None
        } | given(self, *waves)

    def make(self, folder: Path) -> Any:
        heights = given(self, "rms_slope", "rms_height")
        return em.SelfAffine(self.hurst, **self._wave_numbers(), **heights)


# of how the file of a spectrum is read
_OF_TABLE = ("wave_number", "q_unit", "c_unit", "columns", "longest", "shortest")


class SpectrumTable(SurfaceTable, tag="spectrum"):
    """A surface by its power spectrum, a table of wave numbers and C.

    Keys:
        convention: how C is normalised (em.Spectrum)
        q: wave numbers [rad/m]
        c: power spectrum C at these, in SI units
        file: a table of wave numbers and C, in place of q and c
        wave_number: what the wave numbers count
        q_unit: unit of the first column, where its title has none
        c_unit: unit of the second column, where its title has none
        columns: which two of several columns, from 1
        longest: the table is cut at this wavelength
        shortest: the table is cut at this wavelength
    """

    convention: Literal[
        "2d", "2d/4pi^2", "1d", "1d one-sided", "1d/2pi", "1d one-sided/2pi"
    ]
    q: list[float] | None = None
    c: list[float] | None = None
    file: Text | None = None
    wave_number: Literal["2 pi/lambda", "1/lambda"] | None = None
    q_unit: Text | None = None
    c_unit: Text | None = None
    columns: list[int] | None = None
    longest: Length | None = None
    shortest: Length | None = None

    def __post_init__(self) -> None:
        only_one(self, "q", "file")
        options = given(self, *_OF_TABLE)
        if self.q is not None and (options or self.c is None):
            raise InputError(
                argument=next(iter(options), "c"),
                got=next(iter(options.values()), None),
                accepted="left out where q and c are given"
                if options
                else "given beside q",
            )

    def make(self, folder: Path) -> Any:
        if self.q is not None and self.c is not None:
            return em.Spectrum(self.q, self.c, convention=self.convention)
        with path_from("file", folder, keys_of(type(self))):
            return em.read_spectrum(
                folder / str(self.file),
                convention=self.convention,
                **given(self, *_OF_TABLE),
            )


class Measured(SurfaceTable, tag="file"):
    """A measured profile or map.

    Keys:
        file: the heights, in a table or a format of SurfaceTopography
        pixel_size: step, or one for each direction
        shortest: resolution of the instrument: shorter waves are left out
        unit: unit of the lengths, or of each column, without one
        columns: which columns are x (and y) and height, from 1
        detrend: whether the mean plane is subtracted
    """

    file: Text
    pixel_size: Several[Length] | None = None
    shortest: Length | None = None
    unit: Several[Text] | None = None
    columns: list[int] | None = None
    detrend: bool = True

    def make(self, folder: Path) -> Any:
        options = given(self, "shortest", "columns", "unit", "pixel_size")
        for key in ("unit", "pixel_size"):
            if key in options and len(options[key]) == 1:
                (options[key],) = options[key]
        with path_from("file", folder, keys_of(type(self))):
            return em.read_surface(folder / self.file, detrend=self.detrend, **options)


AnySurface = SelfAffineTable | SpectrumTable | Measured


class _WithPreset(Table):
    """Values of a preset, or all of one's own."""

    replaces = ("conductivity", "heat_capacity")  # keys
    preset: str | None = None

    def __post_init__(self) -> None:
        for key in self.replaces:
            entry = getattr(self, key)
            if (entry is None) == (self.preset is None):
                raise InputError(
                    argument=key,
                    got=entry,
                    accepted="left out beside a preset"
                    if self.preset
                    else "given, or left to a preset",
                )


class _Conducts(_WithPreset):
    """What conducts heat.

    Keys:
        preset: typical values, in place of conductivity and heat capacity
        conductivity: thermal conductivity
        heat_capacity: heat capacity per volume
    """

    conductivity: Conductivity | None = None
    heat_capacity: VolumeCapacity | None = None


class RoadTable(_Conducts):
    """What conducts the heat of the counterface."""

    preset: Road | None = None


class HeatTable(_Conducts):
    """Flash temperature: the rubber is heated by its friction.

    Keys:
        road: the counterface that takes its share of the heat; without it, none flows
            there
        branch: which of several temperatures; by default that of rubber that was cold
    """

    preset: Rubber | None = None
    road: RoadTable | None = None
    branch: Branch | None = None

    def arguments(self, folder: Path) -> Arguments:
        road = self.road and (self.road.preset or tuple(given(self.road).values()))
        if self.preset:
            heat = em.Heat.preset(self.preset, road=road)
        else:
            heat = em.Heat(**given(self, *self.replaces), road=road)
        return {"heat": heat} | given(self, "branch")


class ShearOfContact(_WithPreset):
    """Adhesive shear on the area of real contact, in dry friction: stress exp(-width
    log10(v a_T/velocity)^2).

    Keys:
        preset: a typical law, in place of the three below
        stress: largest shear stress
        velocity: sliding velocity of the largest stress, at the reference temperature
        width: width of the bell over log10 v, 0 or more
        energy: activation energy of its a_T (Arrhenius); without it none
        reference: reference temperature, with energy
    """

    replaces = ("stress", "velocity", "width")
    preset: Dry | None = None
    stress: Pressure | None = None
    velocity: Velocity | None = None
    width: float | None = None
    energy: MolarEnergy | None = None
    reference: Temperature | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.energy is None) != (self.reference is None):
            raise InputError(
                argument="reference" if self.reference is None else "energy",
                accepted="given, as energy and reference belong together, or both "
                "left out for an athermal stress",
            )

    def arguments(self, folder: Path) -> Arguments:
        moves = given(self, "energy", "reference")
        shift = em.Arrhenius(**moves) if moves else None
        if self.preset:
            law = em.AdhesiveShear.preset(self.preset, shift=shift)
        else:
            law = em.AdhesiveShear(**given(self, *self.replaces), shift=shift)
        return {"adhesion": law}
