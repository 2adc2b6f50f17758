"""What meets the rubber in a scene: an [indenter], a [surface] with its [heat] and
[adhesion]; one table for each kind.
"""

import abc
import math
import re
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec

import elastomdr as em

from ..errors import InputError
from ..files import read_text
from .schema import (
    Count,
    Positive,
    Several,
    Table,
    Text,
    given,
    named,
    only_one,
    path_from,
)
from .units import (
    Conductivity,
    Length,
    MolarEnergy,
    Pressure,
    SceneQuantity,
    Temperature,
    Velocity,
    VolumeCapacity,
    WaveNumber,
    shown,
)


class Shape(Table, tag_field="shape"):
    """A rigid body."""

    def make(self, folder: Path) -> Any:
        """The body; files are looked for in `folder`."""
        return getattr(em, type(self).__name__.removesuffix("Table"))(
            *msgspec.structs.astuple(self)
        )


class SphereTable(Shape, tag="sphere"):
    """A sphere."""

    radius: Annotated[Length, "radius"]


class ParaboloidTable(Shape, tag="paraboloid"):
    """A paraboloid of revolution."""

    radius: Annotated[Length, "radius of curvature at the apex"]


class ConeTable(Shape, tag="cone"):
    """A cone."""

    slope: Annotated[Positive, "rise of its side over the distance from the axis"]


class FlatPunchTable(Shape, tag="flat_punch"):
    """A cylinder on its flat end."""

    radius: Annotated[Length, "radius"]


class PowerLawTable(Shape, tag="power_law"):
    """A body of revolution of height coefficient times r to the exponent."""

    exponent: Annotated[Positive, "exponent"]
    coefficient: Annotated[
        str | float, 'in length^(1 - exponent), such as "100 m^-1"; a number for a cone'
    ]

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

            with named("coefficient"):
                coefficient = Coefficient.read(coefficient)
        return em.PowerLaw(self.exponent, coefficient)


class ProfileTable(Shape, tag="profile"):
    """A body of revolution given by points of its profile."""

    unit: Annotated[Text, 'unit of length of the points, such as "mm"']
    r: Annotated[list[float] | None, "distances from the axis, from 0 on"] = None
    z: Annotated[list[float] | None, "heights at these distances"] = None
    file: Annotated[
        Text | None, "a table of two columns, r and z, in place of the lists"
    ] = None
    apex: Annotated[
        Literal["auto", "smooth", "sharp"], "at the axis; by default the points decide"
    ] = "auto"
    curve: Annotated[Literal["auto", "spline", "monotone"], "between the points"] = (
        "auto"
    )

    def make(self, folder: Path) -> Any:
        with named("unit"):
            metres = Length.convert("1", self.unit)
        if self.file is not None and self.r is None and self.z is None:
            r, z = _points(folder, self.file)
        elif self.file is None and self.r is not None and self.z is not None:
            r, z = self.r, self.z
        else:
            raise InputError(
                "must have either a file, or lists r and z, for a profile given as "
                "points."
            )
        return em.Profile(
            [metres * x for x in r],
            [metres * x for x in z],
            apex=self.apex,
            curve=self.curve,
        )


class CylinderTable(Shape, tag="cylinder"):
    """A cylinder that lies on a layer: a roller, a wheel."""

    radius: Annotated[Length, "radius"]
    length: Annotated[
        Length, "length of its line of contact, across the direction of motion"
    ]


OfRevolution = (
    SphereTable
    | ParaboloidTable
    | ConeTable
    | FlatPunchTable
    | PowerLawTable
    | ProfileTable
)
AnyShape = (
    SphereTable
    | ParaboloidTable
    | ConeTable
    | FlatPunchTable
    | PowerLawTable
    | ProfileTable
    | CylinderTable
)


def _points(folder: Path, file: str) -> tuple[list[float], list[float]]:
    """Two columns, r and z; lines that start with # and one line of titles are passed
    over.
    """
    try:
        lines = read_text(folder / file).split("\n")
    except OSError as error:
        raise InputError(
            f"file {shown(file)} cannot be read: {error.strerror or error}."
        ) from error
    except ValueError as error:
        raise InputError(f"file {shown(file)} is not a text file.") from error
    rows: list[tuple[float, float]] = []
    titles = False
    for i, line in enumerate(lines, start=1):
        line = line.strip()
        if not line or line.startswith("#"):
            continue
        try:
            r, z = (float(cell) for cell in re.split(r"\s*[,;\t]\s*|\s+", line))
            rows.append((r, z))
        except ValueError as error:
            if rows or titles:
                raise InputError(
                    f"file {shown(file)}, line {i}, must be two numbers, r and z, "
                    f"got {line[:200]!r}."
                ) from error
            titles = True
    return [r for r, _ in rows], [z for _, z in rows]


_OF_LINE = ("equivalent_length", "seed", "periods", "samples")


class SurfaceTable(Table, tag_field="shape"):
    """A rough surface."""

    equivalent_length: Annotated[
        Text | None, "elastomdr slide: as in [contact] of friction"
    ] = None
    seed: Annotated[Count | None, "elastomdr slide: which line of the surface"] = None
    periods: Annotated[
        Count | None, "elastomdr slide: length of the line in longest waves"
    ] = None
    samples: Annotated[
        Count | None, "elastomdr slide: samples of the line, 64 or more"
    ] = None
    level_error: Annotated[
        Positive | None, "relative standard deviation of C, with uncertainty"
    ] = None
    cutoff_error: Annotated[
        Positive | None,
        "relative standard deviation of the upper cutoff, with uncertainty",
    ] = None

    @abc.abstractmethod
    def make(self, folder: Path) -> Any:
        """The surface; files are looked for in `folder`."""

    def isotropic(self, folder: Path) -> Any:
        """The surface, where no line of it is asked for."""
        for key in _OF_LINE:
            if getattr(self, key) is not None:
                raise InputError(
                    f"{key} belongs to elastomdr slide; here it stands in "
                    "[contact], "
                    "beside the model."
                )
        return self.make(folder)

    def drawn(self, folder: Path, count: int | None) -> Any:
        """The surface, or so many draws of it where its errors are given."""
        surface = self.isotropic(folder)
        errors = {"level": self.level_error, "cutoff": self.cutoff_error}
        errors = {name: size for name, size in errors.items() if size is not None}
        if not errors:
            return surface
        if count is None:
            raise InputError(
                "level_error and cutoff_error belong to uncertainty, the number of "
                "draws."
            )
        return surface.draws(count, seed=1, **errors)

    def line(self, folder: Path) -> tuple[Any, float]:
        """One line of the surface, and the length that turns a pressure into its load
        [m].
        """
        if self.samples is not None and self.samples < 64:
            raise InputError(f"samples must be 64 or more, got {self.samples}.")
        surface = self.make(folder)
        length: Any = 2 * math.pi / float(surface.q_low)
        if self.equivalent_length is not None:
            length = equivalent_length(self.equivalent_length)
        if isinstance(length, str):
            length = surface.full_contact_length
        options = {
            key: value
            for key in _OF_LINE[1:]
            if (value := getattr(self, key)) is not None
        }
        return surface.line(**options), float(length)


class SelfAffineTable(SurfaceTable, tag="self_affine"):
    """A self-affine surface between two wavelengths."""

    hurst: Annotated[float, "Hurst exponent"]
    rms_slope: Annotated[
        Positive | None,
        "rms slope of the surface; that of a cut is smaller by the root of 2",
    ] = None
    rms_height: Annotated[Length | None, "rms height, in place of the slope"] = None
    longest: Annotated[Length | None, "longest wavelength, or q_low"] = None
    shortest: Annotated[Length | None, "shortest wavelength, or q_high"] = None
    rolloff: Annotated[
        Length | None, "wavelength above which the spectrum is flat, or q_rolloff"
    ] = None
    q_low: Annotated[WaveNumber | None, "smallest wave number"] = None
    q_high: Annotated[WaveNumber | None, "largest wave number"] = None
    q_rolloff: Annotated[
        WaveNumber | None, "wave number below which the spectrum is flat"
    ] = None

    def __post_init__(self) -> None:
        only_one(self, "rms_slope", "rms_height")
        only_one(self, "longest", "q_low")
        only_one(self, "shortest", "q_high")
        if self.rolloff is not None and self.q_rolloff is not None:
            raise InputError("must have one of rolloff, q_rolloff, got both.")

    def make(self, folder: Path) -> Any:
        waves = {
            "q_low": self.longest,
            "q_high": self.shortest,
            "q_rolloff": self.rolloff,
        }
        numbers = {
            key: 2 * math.pi / wave for key, wave in waves.items() if wave is not None
        }
        keys = ("rms_slope", "rms_height", "q_low", "q_high", "q_rolloff")
        return em.SelfAffine(self.hurst, **numbers, **given(self, *keys))


class SpectrumTable(SurfaceTable, tag="spectrum"):
    """A surface by its power spectrum, a table of wave numbers and C."""

    convention: Annotated[
        Literal["2d", "2d/4pi^2", "1d", "1d one-sided", "1d/2pi", "1d one-sided/2pi"],
        "how C is normalised (em.Spectrum)",
    ]
    q: Annotated[list[float] | None, "wave numbers [rad/m]"] = None
    c: Annotated[list[float] | None, "power spectrum C at these, in SI units"] = None
    file: Annotated[
        Text | None, "a table of wave numbers and C, in place of q and c"
    ] = None
    wave_number: Annotated[
        Literal["2 pi/lambda", "1/lambda"] | None, "what the wave numbers count"
    ] = None
    q_unit: Annotated[
        Text | None, "unit of the first column, where its title has none"
    ] = None
    c_unit: Annotated[
        Text | None, "unit of the second column, where its title has none"
    ] = None
    columns: Annotated[list[int] | None, "which two of several columns, from 1"] = None
    longest: Annotated[Length | None, "the table is cut at this wavelength"] = None
    shortest: Annotated[Length | None, "the table is cut at this wavelength"] = None

    def __post_init__(self) -> None:
        only_one(self, "q", "file")
        options = given(
            self, "wave_number", "q_unit", "c_unit", "columns", "longest", "shortest"
        )
        if self.q is not None and (options or self.c is None):
            raise InputError(
                "must have c beside q, and nothing that goes with a file, got "
                f"{', '.join(options)}."
            )

    def make(self, folder: Path) -> Any:
        if self.q is not None and self.c is not None:
            return em.Spectrum(self.q, self.c, convention=self.convention)
        options = given(
            self, "wave_number", "q_unit", "c_unit", "columns", "longest", "shortest"
        )
        with path_from("file"):
            return em.read_spectrum(
                folder / str(self.file), convention=self.convention, **options
            )


class Measured(SurfaceTable, tag="file"):
    """A measured profile or map."""

    file: Annotated[Text, "the heights, in a table or a format of SurfaceTopography"]
    pixel_size: Annotated[Several[Length] | None, "step, or one for each direction"] = (
        None
    )
    shortest: Annotated[
        Length | None, "resolution of the instrument: shorter waves are left out"
    ] = None
    unit: Annotated[
        Several[Text] | None, "unit of the lengths, or of each column, without one"
    ] = None
    columns: Annotated[
        list[int] | None, "which columns are x (and y) and height, from 1"
    ] = None
    detrend: Annotated[bool, "whether the mean plane is subtracted"] = True

    def make(self, folder: Path) -> Any:
        options = given(self, "shortest", "columns")
        if self.unit is not None:
            options["unit"] = self.unit if len(self.unit) > 1 else self.unit[0]
        if self.pixel_size is not None:
            options["pixel_size"] = (
                self.pixel_size if len(self.pixel_size) > 1 else self.pixel_size[0]
            )
        with path_from("file"):
            return em.read_surface(folder / self.file, detrend=self.detrend, **options)


AnySurface = SelfAffineTable | SpectrumTable | Measured


class RoadTable(Table):
    """What conducts the heat of the counterface."""

    conductivity: Annotated[Conductivity, "thermal conductivity"]
    heat_capacity: Annotated[VolumeCapacity, "heat capacity per volume"]


class HeatTable(Table):
    """Flash temperature: the rubber is heated by its friction."""

    conductivity: Annotated[Conductivity, "thermal conductivity of the rubber"]
    heat_capacity: Annotated[VolumeCapacity, "heat capacity of the rubber per volume"]
    road: Annotated[
        RoadTable | None,
        (
            "the counterface that takes its share of the heat; without it, none flows "
            "there"
        ),
    ] = None
    branch: Annotated[
        Literal["cold", "hot"] | None,
        "which of several temperatures; by default that of rubber that was cold",
    ] = None

    def make(self) -> Any:
        """The conduction."""
        road = (
            None
            if self.road is None
            else (self.road.conductivity, self.road.heat_capacity)
        )
        return em.Heat(self.conductivity, self.heat_capacity, road=road)


class Adhesion(Table):
    """Adhesive shear on the area of real contact, in dry friction: stress exp(-width
    log10(v a_T/velocity)^2).
    """

    stress: Annotated[Pressure, "largest shear stress"]
    velocity: Annotated[
        Velocity, "sliding velocity of the largest stress, at the reference temperature"
    ]
    width: Annotated[float, "width of the bell over log10 v, 0 or more"]
    energy: Annotated[
        MolarEnergy | None, "activation energy of its a_T (Arrhenius); without it none"
    ] = None
    reference: Annotated[Temperature | None, "reference temperature, with energy"] = (
        None
    )

    def __post_init__(self) -> None:
        if (self.energy is None) != (self.reference is None):
            raise InputError(
                "energy and reference belong together: give both, or neither for "
                "an athermal stress."
            )

    def make(self) -> Any:
        """The law."""
        shift = (
            None
            if self.energy is None or self.reference is None
            else em.Arrhenius(self.energy, self.reference)
        )
        with named("[adhesion]"):
            return em.AdhesiveShear(self.stress, self.velocity, self.width, shift=shift)


def equivalent_length(value: str) -> Any:
    """A length [m], or "full contact"."""
    if value == "full contact":
        return value
    with named("equivalent_length"):
        return Length.read(value)
