"""The [indenter] table of a scene file becomes a shape."""

import re
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..files import read_text
from .keys import Keys, choice, numbers, one, positive_number, text
from .units import LENGTH, Kind, number_in, quantity

_KEYS = {
    "sphere": ("radius",),
    "paraboloid": ("radius",),
    "cone": ("slope",),
    "flat_punch": ("radius",),
    "power_law": ("exponent", "coefficient"),
    "profile": ("r", "z", "unit", "file", "apex", "curve"),
    "cylinder": ("radius", "length"),
}


def read_indenter(content: Any, folder: Path) -> Any:
    """A shape from its table; files are looked for beside the scene. Raises `InputError` for whatever is wrong."""
    every = ("shape", *dict.fromkeys(key for keys in _KEYS.values() for key in keys))
    shape = Keys(content, "indenter", every).get("shape", choice(*_KEYS))
    keys = Keys(content, "indenter", ("shape", *_KEYS[shape]))
    from .. import Cone, Cylinder, FlatPunch, Paraboloid, PowerLaw, Sphere

    match shape:
        case "cone":
            return Cone(keys.get("slope", positive_number))
        case "power_law":
            exponent = keys.get("exponent", positive_number)
            return PowerLaw(exponent, keys.get("coefficient", _coefficient(exponent)))
        case "profile":
            return _profile(keys, folder)
        case "cylinder":
            return Cylinder(keys.get("radius", one(LENGTH)), keys.get("length", one(LENGTH)))
        case _:
            return {"sphere": Sphere, "paraboloid": Paraboloid, "flat_punch": FlatPunch}[shape](
                keys.get("radius", one(LENGTH))
            )


def _coefficient(exponent: float) -> Any:
    """Reads c of f = c r^n, in m^(1-n): a text with its unit, or a plain number where n = 1."""
    power = f"{1 - exponent:.12g}"

    def read(name: str, value: Any) -> float:
        if exponent == 1:
            return positive_number(name, value)
        return quantity(name, value, Kind(f"in length^(1-exponent) (m^{power})", f"m**({power})", f"100 m^{power}"))

    return read


def _profile(keys: Keys, folder: Path) -> Any:
    from .. import Profile

    unit = keys.get("unit", text)
    metres = number_in(keys.name("unit"), 1.0, unit, LENGTH)
    if ("file" in keys) == ("r" in keys or "z" in keys):
        raise InputError("[indenter] must have either a file, or lists r and z, for a profile given as points.")
    r, z = (
        keys.get("file", _points_file(folder)) if "file" in keys else (keys.get("r", numbers), keys.get("z", numbers))
    )
    apex = keys.get("apex", choice("auto", "smooth", "sharp")) if "apex" in keys else "auto"
    curve = keys.get("curve", choice("auto", "spline", "monotone")) if "curve" in keys else "auto"
    try:
        return Profile([metres * x for x in r], [metres * x for x in z], apex=apex, curve=curve)
    except InputError as error:
        raise InputError(f"[indenter] {error}") from error


def _points_file(folder: Path) -> Any:
    """Reads a table of two columns, r and z; lines that start with # and one line of titles are passed over."""

    def read(name: str, value: Any) -> tuple[list[float], list[float]]:
        path = folder / text(name, value)
        try:
            lines = read_text(path).split("\n")
        except OSError as error:
            raise InputError(f"{name}: {value!r} cannot be read: {error.strerror or error}.") from error
        except ValueError as error:
            raise InputError(f"{name}: {value!r} is not a text file.") from error
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
                        f"{name}: {value!r}, line {i}, must be two numbers, r and z, got {line!r}."
                    ) from error
                titles = True
        return [r for r, _ in rows], [z for _, z in rows]

    return read
