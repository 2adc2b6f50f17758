"""The scene file: a TOML file with unit strings becomes the arguments of `em.friction`, `em.rolling` and `em.plan`."""

import contextlib
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..files import read_bytes
from .further import TABLES, Further, read_further
from .indenter import read_indenter
from .keys import Keys, choice, flag, one, one_or_more, positive_number, text
from .measured import read_measured
from .surface import read_heat, read_surface
from .units import FORCE, LENGTH, LINE_LOAD, PRESSURE, TEMPERATURE, VELOCITY

_MOST_POINTS = 100_000
_MOST_BYTES = 10_000_000  # a scene is a page of text; what is larger is some other file


@dataclass(frozen=True)
class Scene:
    """What a scene file asks for, in SI units."""

    path: Path
    title: str | None
    material: Any  # a Prony, or a Foundation where the scene has a layer or two bodies
    shape: Any
    arguments: dict[str, Any]  # keyword arguments: velocity, load or depth, temperature, average, rtol
    rough: bool = False  # whether the scene has a [surface]
    measured: Any = None  # points to draw, `fit.reading.friction_file.MeasuredFriction`
    further: Further | None = None  # what a [warming] or a [conveyor] computes in place of the rolling resistance


@contextlib.contextmanager
def in_file(path: str | Path) -> Iterator[None]:
    """Puts the file's name before whatever `InputError` its contents lead to."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{Path(path).name or path}: {error}") from error


def read_scene(path: str) -> Scene:
    """Reads a scene file. Raises `InputError`, in one line that begins with the file's name, for whatever is wrong."""
    with in_file(path):
        return _scene(Path(path), read_toml(Path(path)))


def read_toml(path: Path) -> dict[str, Any]:
    """The content of a TOML file. Raises `InputError` for whatever is none."""
    try:
        return tomllib.loads(read_bytes(path, _MOST_BYTES).decode())
    except OSError as error:
        raise InputError(f"the scene cannot be read: {error.strerror or error}.") from error
    except (ValueError, RecursionError) as error:  # not UTF-8, not TOML, no valid path
        raise InputError(f"the scene is not valid TOML: {error}.") from error


def _scene(path: Path, content: dict[str, Any]) -> Scene:
    keys = ("title", "material", "other", "temperature", "measured", "indenter", "surface", "layer", "contact", "heat",
            "numerics", *TABLES)  # fmt: skip
    top = Keys(content, "", keys)
    title = top.get("title", text) if "title" in top else None
    if "indenter" in top and "surface" in top:
        raise InputError("[indenter] and [surface] exclude each other.")
    rough = "surface" in top
    table = _further(top, rough)
    if (not rough and "indenter" not in top) or "contact" not in top:
        missing = "contact" if rough or "indenter" in top else "indenter"
        raise InputError(
            f"[{missing}] is missing: a scene has a material, an [indenter] or a [surface], and a [contact]."
        )
    arguments = _contact(top.get("contact", lambda _, value: value), rough, table)
    if "temperature" in top:
        arguments["temperature"] = top.get("temperature", one_or_more(TEMPERATURE))
    arguments |= _numerics(content.get("numerics", {}))
    if rough:
        shape, more = read_surface(content["surface"], path.parent)
        arguments |= more | (read_heat(content["heat"]) if "heat" in top else {})
    elif "heat" in top:
        raise InputError("[heat] goes with a [surface]: an indenter's friction is at the temperature given.")
    else:
        shape = read_indenter(content["indenter"], path.parent)
    material = read_material(top, content.get("layer"), shape, path.parent, arguments)
    measured = read_measured(path.parent / top.get("measured", text)) if "measured" in top else None
    further = None
    if table is not None:
        if table == "conveyor" and arguments.get("average", "direction") != "direction":
            raise InputError("[numerics] average has no meaning with a [conveyor]: its covers are layers.")
        further = _read_further(top, table, content, shape, path.parent, arguments)
    return Scene(path, title, material, shape, _on_axes(arguments), rough, measured, further)


def _further(top: Keys, rough: bool) -> str | None:
    """Which of [warming] and [conveyor] the scene has, if any. Raises `InputError` for what does not go with it."""
    given = [name for name in TABLES if name in top]
    if not given:
        return None
    if len(given) > 1:
        raise InputError(f"[{given[0]}] and [{given[1]}] exclude each other.")
    for name in ("surface", "heat", "measured"):
        if name in top:
            raise InputError(f"[{given[0]}] and {name} exclude each other: it is about a body that rolls.")
    if given[0] == "warming" and "temperature" in top:
        raise InputError("temperature must be left out with [warming], which has an ambient, and finds the rest.")
    return given[0]


def _read_further(top: Keys, table: str, content: Any, shape: Any, folder: Path, arguments: dict[str, Any]) -> Further:
    from .. import Cylinder

    layer = content.get("layer")

    def on_layer(thickness: float) -> Any:
        return read_material(top, {**layer, "thickness": f"{thickness!r} m"}, shape, folder, arguments)

    known = isinstance(layer, dict) and isinstance(shape, Cylinder)
    thickness = Keys(layer, "layer", ("thickness", "bonded")).get("thickness", one(LENGTH)) if known else None
    found = read_further(table, content[table], on_layer, shape, thickness)
    arguments |= found.arguments
    return found


def read_material(top: Keys, layer: Any, shape: Any, folder: Path, arguments: dict[str, Any]) -> Any:
    """What `material`, `other` and [layer] stand for; may take the temperature out of the arguments."""
    from .. import Cylinder, load_material
    from .. import layer as on_layer

    def load(name: str, value: Any) -> Any:
        where = text(name, value)
        is_file = where.endswith(".toml") or "/" in where or "\\" in where
        try:
            return load_material(str(folder / where) if is_file else where)
        except InputError as error:
            raise InputError(f"{name}: {error}") from error

    material = top.get("material", load)
    if layer is not None:
        keys = Keys(layer, "layer", ("thickness", "bonded"))
        thickness = keys.get("thickness", one(LENGTH))
        if "other" in top:
            raise InputError("other and [layer] exclude each other: two bodies are two half-spaces in contact.")
        return on_layer(material, thickness, bonded=keys.get("bonded", flag) if "bonded" in keys else True)
    if isinstance(shape, Cylinder):
        raise InputError("[layer] is missing: a cylinder acts on a layer; give [layer] thickness.")
    return _two_bodies(material, top.get("other", load), arguments) if "other" in top else material


def _two_bodies(material: Any, other: Any, arguments: dict[str, Any]) -> Any:
    """Two bodies in contact. Where they shift differently, both are brought to the one temperature first."""
    import equinox as eqx

    from .. import Foundation, half_space

    if eqx.tree_equal(material.shift, other.shift):
        return half_space(material, other)
    if "temperature" not in arguments:
        raise InputError("temperature is missing: material and other have different shift laws.")
    temperature = arguments["temperature"]
    if isinstance(temperature, list):
        raise InputError(
            f"temperature must be a single value, got {len(temperature)}: material and other have different shift laws."
        )
    pair = half_space(*(body if body.shift is None else body.at(temperature) for body in (material, other)))
    del arguments["temperature"]
    return Foundation(
        pair.equilibrium, pair.moduli, pair.times, pair.viscosity, per_area=False,
        name=f"{pair.name} at {float(temperature):g} K", range=pair.range,
    )  # fmt: skip


def _contact(content: Any, rough: bool = False, table: str | None = None) -> dict[str, Any]:
    if table is not None:
        keys = Keys(content, "contact", ("velocity",) if table == "conveyor" else ("load", "velocity"))
        speed: dict[str, Any] = {"velocity": keys.get("velocity", _velocity)}
        return speed if table == "conveyor" else speed | {"load": keys.get("load", one_or_more(FORCE))}
    kinds = {"pressure": PRESSURE, "load": LINE_LOAD, "depth": LENGTH} if rough else {"load": FORCE, "depth": LENGTH}
    keys = Keys(content, "contact", (*kinds, "velocity"))
    if rough:
        given = [name for name in kinds if name in keys]
        if len(given) != 1:
            got = " and ".join(given) or "none of them"
            raise InputError(
                '[contact] must have one of a pressure, such as "0.3 MPa", a load per length, such as "1 N/mm", and a '
                f'depth, such as "0.1 mm", got {got}.'
            )
        return {"velocity": keys.get("velocity", _velocity), given[0]: keys.get(given[0], one_or_more(kinds[given[0]]))}
    if ("load" in keys) == ("depth" in keys):
        got = "both" if "load" in keys else "neither"
        raise InputError(f'[contact] must have either a load, such as "10 N", or a depth, such as "0.1 mm", got {got}.')
    control, kind = ("load", FORCE) if "load" in keys else ("depth", LENGTH)
    return {"velocity": keys.get("velocity", _velocity), control: keys.get(control, one_or_more(kind))}


def _velocity(name: str, value: Any) -> Any:
    if not isinstance(value, dict):
        return one_or_more(VELOCITY)(name, value)
    import numpy as np

    keys = Keys(value, name.strip("[").replace("] ", "."), ("from", "to", "points"))
    first, last = keys.get("from", one(VELOCITY)), keys.get("to", one(VELOCITY))
    points = keys.get("points", _points)
    if not first < last:
        raise InputError(f"{name} must go from a smaller to a larger value, got from {value['from']} to {value['to']}.")
    return np.geomspace(first, last, points)


def _points(name: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 2 <= value <= _MOST_POINTS:
        raise InputError(f"{name} must be a whole number from 2 to {_MOST_POINTS}, got {value!r}.")
    return value


def _numerics(content: Any) -> dict[str, Any]:
    keys = Keys(content, "numerics", ("rtol", "average"))
    arguments: dict[str, Any] = {}
    if "rtol" in keys:
        arguments["rtol"] = keys.get("rtol", positive_number)
    if "average" in keys:
        average = keys.get("average", choice("direction", "corrected", "line"))
        arguments["average"] = None if average == "line" else average
    return arguments


def _on_axes(arguments: dict[str, Any]) -> dict[str, Any]:
    """Gives each list an axis of its own: temperature first, then load or depth or goods, velocity last."""
    import numpy as np

    shaped, after = dict(arguments), 0
    for name in ("velocity", "slip", "creep", "pressure", "load", "depth", "goods", "ambient", "temperature"):
        if np.ndim(arguments.get(name, 0.0)) == 1:
            shaped[name] = np.asarray(arguments[name]).reshape(-1, *[1] * after)
            after += 1
    return shaped
