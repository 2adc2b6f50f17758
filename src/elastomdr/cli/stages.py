"""The scene file of `elastomdr slide`: an indenter or a surface, a material, and [[stage]] after [[stage]].

A stage lasts a `duration` at rest, or at a `velocity` (of either sign) for a `duration` or along a `way`. Its `load` or
`depth` is put on at its beginning, at once, or with `ramp = true` grows to that value over the stage; a stage without
one keeps that of the stage before. With a [surface], of which one line is taken, a load is per length of line, and a
nominal `pressure` may stand in its place, turned into that load as `elastomdr friction` does it. With a [drive] the
stages are the way of a drive that pulls the body through a spring and a damper.
"""

from pathlib import Path
from typing import Any

from ..errors import InputError
from .further import read_drive
from .indenter import read_indenter
from .keys import Keys, flag, one, positive_number, text, whole
from .scene import Scene, in_file, read_material, read_toml
from .surface import read_surface
from .units import DEPTH, DURATION, LENGTH, LINE_PUSH, PUSH, PUSH_PRESSURE, SPEED, TEMPERATURE

_MOST_POINTS = 2000
_POINTS = 60  # instants of a stage, unless said otherwise
_FEWEST = 64  # samples of a rough line, as for em.friction
_FIRST = 1e-4  # of a rest: the first instant looked at after its beginning


def read_stages(path: str) -> Scene:
    """Reads a scene file. Raises `InputError`, in one line that begins with the file's name, for whatever is wrong."""
    with in_file(path):
        return _scene(Path(path), read_toml(Path(path)))


def _scene(path: Path, content: dict[str, Any]) -> Scene:
    keys = ("title", "material", "other", "temperature", "indenter", "surface", "layer", "stage", "drive", "numerics")
    top = Keys(content, "", keys)
    title = top.get("title", text) if "title" in top else None
    rough = "surface" in top
    if rough and ("indenter" in top or "layer" in top):
        raise InputError(f"[{'indenter' if 'indenter' in top else 'layer'}] and [surface] exclude each other.")
    if not (rough or "indenter" in top) or "stage" not in top:
        missing = "[[stage]]" if rough or "indenter" in top else "[indenter]"
        raise InputError(
            f"{missing} is missing: a scene has a material, an [indenter] or a [surface], and one [[stage]] or more."
        )
    numerics = Keys(content.get("numerics", {}), "numerics", ("rtol", "points"))
    points = _POINTS
    if "points" in numerics:
        points = numerics.get("points", lambda name, value: whole(name, value, 2, _MOST_POINTS))
    shape, length = _line(content["surface"], path.parent) if rough else (None, None)
    arguments = _history(content["stage"], points, length)
    if "rtol" in numerics:
        arguments["rtol"] = numerics.get("rtol", positive_number)
    if "temperature" in top:
        arguments["temperature"] = top.get("temperature", one(TEMPERATURE))
    shape = shape if rough else read_indenter(content["indenter"], path.parent)
    material = read_material(top, content.get("layer"), shape, path.parent, arguments)
    further = read_drive(content["drive"], arguments, rough) if "drive" in top else None
    arguments |= {} if further is None else further.arguments
    return Scene(path, title, material, shape, arguments, rough, further=further)


def _line(content: Any, folder: Path) -> tuple[Any, float]:
    """One line of a surface, and the length that turns a pressure into its load [m]."""
    surface, more = read_surface(content, folder, one_line=True)
    if more.get("samples", _FEWEST) < _FEWEST:
        raise InputError(f"[surface] samples must be a whole number, {_FEWEST} or more, got {more['samples']}.")
    length = more.pop("equivalent_length", 6.283185307179586 / float(surface.q_low))
    length = surface.full_contact_length if isinstance(length, str) else length
    try:
        return surface.line(**more), float(length)
    except InputError as error:
        raise InputError(f"[surface] {error}") from error


def _history(stages: Any, points: int, length: float | None = None) -> dict[str, Any]:
    """time, position, and load or depth, from the stages; two equal instants are a jump.

    With the `length` of a surface the loads are per length of line, or pressures.
    """
    import numpy as np

    kinds = {"load": PUSH if length is None else LINE_PUSH, "depth": DEPTH}
    kinds |= {} if length is None else {"pressure": PUSH_PRESSURE}

    if not isinstance(stages, list) or not stages:
        raise InputError("[[stage]] must be a list of tables, written [[stage]] with two brackets.")
    time, position, values = [0.0], [0.0], []
    name = ""
    for i, content in enumerate(stages, start=1):
        keys = Keys(content, f"stage {i}", ("duration", "way", "velocity", *kinds, "ramp"))
        duration, moved = _motion(keys)
        given = [key for key in kinds if key in keys]
        if len(given) > 1 or (given and name and given[0] != name) or not (given or name):
            got = " and ".join(given) or "neither"
            what = "loads, or depths" if length is None else "loads, or depths, or pressures"
            raise InputError(f"[stage {i}] the stages must have {what}, from the first one on, got {got}.")
        name = name or given[0]
        new = keys.get(name, one(kinds[name])) if given else values[-1]
        ramp = "ramp" in keys and keys.get("ramp", flag)
        if not values:
            values.append(0.0 if ramp else new)
        elif new != values[-1] and not ramp:
            time.append(time[-1])
            position.append(position[-1])
            values.append(new)
        part = np.arange(1, points + 1) / points
        if not moved:
            part = np.geomspace(_FIRST, 1.0, points)  # at rest the rubber answers on all its time scales
        start, at, before = time[-1], position[-1], values[-1]
        time.extend(start + duration * part)
        position.extend(at + moved * part)
        values.extend(before + (new - before) * part)
    loads = np.array(values)
    if name == "pressure":
        name, loads = "load", loads * length
    return {"time": np.array(time), "position": np.array(position), name: loads}


def _motion(keys: Keys) -> tuple[float, float]:
    """Duration [s] of a stage, and how far the body moves in it [m]."""
    velocity = keys.get("velocity", one(SPEED)) if "velocity" in keys else 0.0
    if "way" not in keys:
        duration = keys.get("duration", one(DURATION))
        return duration, velocity * duration
    if "duration" in keys or not velocity:
        raise InputError(f"{keys.name('way')} needs a velocity that is not zero, and no duration beside it.")
    way = keys.get("way", one(LENGTH))
    return way / abs(velocity), way if velocity > 0 else -way
