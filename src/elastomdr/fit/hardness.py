"""A material from its hardness alone: a library spectrum scaled to the modulus that
Shore A stands for.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import in_si, scalar, significant
from ..errors import InputError
from ..material.library import load_material, material_info, save_material
from ..material.prony import Prony
from ..material.validity import Range
from ..trees import replaced

if TYPE_CHECKING:
    from .._types import Number

FACTOR = 2.0  # within which the moduli lie
_SHORE = (20.0, 90.0)  # where Gent's relation is of use
_READ = 3.0  # time after which a durometer is read [s],
_TEMPERATURE = 296.15  # and temperature [K] (ISO 48-4)
_SHIFTED = "moduli scaled from a library spectrum to Shore A by Gent's relation"


@in_si
def from_hardness(
    shore_a: Number,
    *,
    like: str | os.PathLike[str] | Prony = "sbr-gum-like",
    name: str = "",
) -> Prony:
    """A material known by its hardness only: the spectrum of another one, scaled to
    Gent's modulus for Shore A.

    An estimate: moduli lie within a factor of two, which the material's record of
    misfit holds for every band of friction, and the loss tangent is that of the other
    material.

    Args:
        shore_a: hardness [Shore A], 20 to 90.
        like: the material whose spectrum, shift law and Poisson's ratio it has: a name
            in the library, a file, or one.
        name: name of the material.

    Returns:
        A `Prony` of the kind of `like`.

    Raises:
        InputError: for a hardness outside of the relation, and for a material that is
            no series.

    Source: A. N. Gent, Rubber Chemistry and Technology 31 (1958) 896-906: E = 0.0981
    (56 + 7.62336 S)/(0.137505 (254 - 2.54 S)) MPa, here the relaxation modulus after 3
    s at 23 degC.
    """
    hardness = float(scalar("shore_a", shore_a))
    if not _SHORE[0] <= hardness <= _SHORE[1]:
        raise InputError(
            f"shore_a must be between {_SHORE[0]:g} and {_SHORE[1]:g}, got "
            f"{hardness:g}."
        )
    other = like if isinstance(like, Prony) else load_material(like)
    if not isinstance(other, Prony):
        raise InputError(
            "like must be a Prony series, or the name of one in the library, got "
            f"{like!r:.80}."
        )
    factor = _gent(hardness) / float(
        np.asarray(other.at(_TEMPERATURE).tensile().relaxation(_READ))
    )
    known = other.range if other.range is not None else Range(None, None)
    low, high = known.omega or (
        0.1 / float(other.times.max()),
        10 / float(other.times.min()),
    )
    bands = np.geomspace(low, high, int(np.ceil(4 * np.log10(high / low))) + 1)
    rows = tuple((float(f"{omega:.4g}"), FACTOR - 1, FACTOR - 1) for omega in bands)
    return replaced(
        other,
        equilibrium=other.equilibrium * factor,
        moduli=other.moduli * factor,
        viscosity=other.viscosity * factor,
        range=known._replace(misfit=rows),
        name=name or f"shore-{significant(hardness)}-a",
        citation=f"{_SHIFTED}; spectrum of {other.name or 'another material'}",
    )


def _gent(hardness: float) -> float:
    """Young's modulus [Pa]."""
    return 0.0981e6 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))


def save_hardness(material: Prony, hardness: float, like: str, path: Path) -> None:
    """Writes such a material with its sources, graded as an estimate."""
    known: dict[str, Any] = dict(material_info(like).get("source", {}))
    note = (
        f"Gent's relation for {hardness:g} Shore A; moduli within a factor of "
        f"{FACTOR:g}, loss tangent of {like}."
    )
    sources = known | {
        "moduli": {"citation": material.citation, "grade": "estimated", "note": note}
    }
    info = {
        "description": f"Rubber of {hardness:g} Shore A: the spectrum of {like}, scaled",
        "source": sources,
    }
    save_material(material, path, info=info)
