"""The scene file of `elastomdr traction`: a wheel or ball that rolls with a creep, or brakes with a slip.

`friction` is a plain number, or the name of a table mu(v, T, p) as `elastomdr friction` writes it. Under a cylinder a
[structure] carries the load and a [layer] of the material, the tread, is sheared; a body of revolution rolls on a
half-space of the material.
"""

from pathlib import Path
from typing import Any

from ..errors import InputError
from .indenter import read_indenter
from .keys import Keys, number, numbers, one, one_or_more, positive_number, text
from .scene import Scene, _numerics, _on_axes, _points, _velocity, in_file, read_material, read_toml
from .units import AREA_STIFFNESS, FORCE, LENGTH, TEMPERATURE

_KEYS = ("title", "material", "temperature", "friction", "indenter", "structure", "layer", "contact", "numerics")


def read_wheel(path: str) -> Scene:
    """Reads a scene file. Raises `InputError`, in one line that begins with the file's name, for whatever is wrong."""
    with in_file(path):
        return _scene(Path(path), read_toml(Path(path)))


def _scene(path: Path, content: dict[str, Any]) -> Scene:
    top = Keys(content, "", _KEYS)
    title = top.get("title", text) if "title" in top else None
    for table in ("indenter", "contact"):
        if table not in top:
            raise InputError(
                f"[{table}] is missing: a scene has a material, a friction, an [indenter] and a [contact], and for a "
                "wheel a [structure] and a [layer]."
            )
    arguments = _contact(content["contact"]) | _numerics(content.get("numerics", {}))
    if "temperature" in top:
        arguments["temperature"] = top.get("temperature", one_or_more(TEMPERATURE))
    shape = read_indenter(content["indenter"], path.parent)
    material, tread = _bodies(top, content, shape, path.parent, arguments)
    arguments |= {"friction": top.get("friction", _friction(path.parent))} | tread
    return Scene(path, title, material, shape, _on_axes(arguments))


def _contact(content: Any) -> dict[str, Any]:
    keys = Keys(content, "contact", ("load", "velocity", "slip", "creep"))
    given = [name for name in ("slip", "creep") if name in keys]
    if len(given) != 1:
        got = "both" if given else "neither"
        raise InputError(
            "[contact] must have either a slip, over the velocity of the road, or a creep, over that of the rolling "
            f"body, such as slip = {{ from = 0.002, to = 0.99, points = 40 }}, got {got}."
        )
    return {
        "load": keys.get("load", one_or_more(FORCE)),
        "velocity": keys.get("velocity", _velocity),
        given[0]: keys.get(given[0], _parts),
    }


def _parts(name: str, value: Any) -> Any:
    """A plain number, a list of them, or { from, to, points } on a logarithmic scale."""
    import numpy as np

    if isinstance(value, dict):
        keys = Keys(value, name.strip("[").replace("] ", "."), ("from", "to", "points"))
        first, last = keys.get("from", positive_number), keys.get("to", positive_number)
        if not first < last:
            raise InputError(f"{name} must go from a smaller to a larger value, got from {first:g} to {last:g}.")
        return np.geomspace(first, last, keys.get("points", _points))
    if isinstance(value, list):
        if not value:
            raise InputError(f"{name} must be a number or a list of them, got an empty list.")
        values = numbers(name, value)
        return values if len(values) > 1 else values[0]
    return number(name, value)


def _friction(folder: Path) -> Any:
    def read(name: str, value: Any) -> Any:
        if not isinstance(value, str):
            return number(name, value)
        from .. import load_friction

        try:
            return load_friction(folder / text(name, value))
        except InputError as error:
            raise InputError(f"{name}: {error}") from error

    return read


def _bodies(
    top: Keys, content: dict[str, Any], shape: Any, folder: Path, arguments: dict[str, Any]
) -> tuple[Any, dict[str, Any]]:
    """What carries the load, and what is sheared where that is another."""
    from .. import Cylinder, Foundation
    from .. import layer as on_layer

    if not isinstance(shape, Cylinder):
        for table in ("structure", "layer"):
            if table in top:
                raise InputError(f"[{table}] goes with a cylinder, a wheel; a {shape.label} rolls on a half-space.")
        return read_material(top, None, shape, folder, arguments), {}
    for table in ("structure", "layer"):
        if table not in top:
            raise InputError(
                f"[{table}] is missing: under a wheel a [structure] with its stiffness, such as "
                '"80 MPa/m", carries the load, and a [layer] of the material with its thickness, the tread, is sheared.'
            )
    stiffness = Keys(content["structure"], "structure", ("stiffness",)).get("stiffness", one(AREA_STIFFNESS))
    thickness = Keys(content["layer"], "layer", ("thickness",)).get("thickness", one(LENGTH))
    tread = read_material(top, None, None, folder, arguments)
    return Foundation(stiffness, [], [], name=f"{tread.name or 'tread'} on an elastic structure"), {
        "tangential": on_layer(tread, thickness, tangential=True)
    }
