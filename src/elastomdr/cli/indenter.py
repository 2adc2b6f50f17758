"""The [indenter] of a scene: one table for each shape."""

import re
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec

import elastomdr as em

from ..errors import InputError
from ..files import read_text
from .schema import Positive, Table, Text, named
from .units import Length, Quantity, shown


class Shape(Table, tag_field="shape"):
    """A rigid body."""

    def make(self, folder: Path) -> Any:
        """The body; files are looked for in `folder`."""
        return getattr(em, type(self).__name__)(*msgspec.structs.astuple(self))


class Sphere(Shape, tag="sphere"):
    """A sphere."""

    radius: Annotated[Length, "radius"]


class Paraboloid(Shape, tag="paraboloid"):
    """A paraboloid of revolution."""

    radius: Annotated[Length, "radius of curvature at the apex"]


class Cone(Shape, tag="cone"):
    """A cone."""

    slope: Annotated[Positive, "rise of its side over the distance from the axis"]


class FlatPunch(Shape, tag="flat_punch"):
    """A cylinder on its flat end."""

    radius: Annotated[Length, "radius"]


class PowerLaw(Shape, tag="power_law"):
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
                Quantity,
                what=f"in m^{power}",
                unit=f"m**({power})",
                example=f"100 m^{power}",
            ): ...

            with named("coefficient"):
                coefficient = Coefficient.read(coefficient)
        return em.PowerLaw(self.exponent, coefficient)


class Profile(Shape, tag="profile"):
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


class Cylinder(Shape, tag="cylinder"):
    """A cylinder that lies on a layer: a roller, a wheel."""

    radius: Annotated[Length, "radius"]
    length: Annotated[
        Length, "length of its line of contact, across the direction of motion"
    ]


OfRevolution = Sphere | Paraboloid | Cone | FlatPunch | PowerLaw | Profile
AnyShape = Sphere | Paraboloid | Cone | FlatPunch | PowerLaw | Profile | Cylinder


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
                    f"got {line!r}."
                ) from error
            titles = True
    return [r for r, _ in rows], [z for _, z in rows]
