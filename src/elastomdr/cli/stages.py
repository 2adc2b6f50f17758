"""The scene file of `elastomdr slide`: an indenter, a material and [[stage]] after [[stage]] of rest and sliding.

A stage lasts a `duration` at rest, or at a `velocity` (of either sign) for a `duration` or along a `way`. Its `load` or
`depth` is put on at its beginning, at once, or with `ramp = true` grows to that value over the stage; a stage without
one keeps that of the stage before.
"""

from pathlib import Path
from typing import Any

from ..errors import InputError
from .history import whole
from .indenter import read_indenter
from .keys import Keys, flag, one, positive_number, text
from .scene import Scene, in_file, read_material, read_toml
from .units import DEPTH, DURATION, LENGTH, PUSH, SPEED, TEMPERATURE

_MOST_POINTS = 2000
_POINTS = 60  # instants of a stage, unless said otherwise
_FIRST = 1e-4  # of a rest: the first instant looked at after its beginning


def read_stages(path: str) -> Scene:
    """Reads a scene file. Raises `InputError`, in one line that begins with the file's name, for whatever is wrong."""
    with in_file(path):
        return _scene(Path(path), read_toml(Path(path)))


def _scene(path: Path, content: dict[str, Any]) -> Scene:
    top = Keys(content, "", ("title", "material", "other", "temperature", "indenter", "layer", "stage", "numerics"))
    title = top.get("title", text) if "title" in top else None
    if "indenter" not in top or "stage" not in top:
        missing = "[indenter]" if "indenter" not in top else "[[stage]]"
        raise InputError(f"{missing} is missing: a scene has a material, an [indenter] and one [[stage]] or more.")
    numerics = Keys(content.get("numerics", {}), "numerics", ("rtol", "points"))
    points = _POINTS
    if "points" in numerics:
        points = numerics.get("points", lambda name, value: whole(name, value, 2, _MOST_POINTS))
    arguments = _history(content["stage"], points)
    if "rtol" in numerics:
        arguments["rtol"] = numerics.get("rtol", positive_number)
    if "temperature" in top:
        arguments["temperature"] = top.get("temperature", one(TEMPERATURE))
    shape = read_indenter(content["indenter"], path.parent)
    material = read_material(top, content.get("layer"), shape, path.parent, arguments)
    return Scene(path, title, material, shape, arguments)


def _history(stages: Any, points: int) -> dict[str, Any]:
    """time, position, and load or depth, from the stages; two equal instants are a jump."""
    import numpy as np

    if not isinstance(stages, list) or not stages:
        raise InputError("[[stage]] must be a list of tables, written [[stage]] with two brackets.")
    time, position, values = [0.0], [0.0], []
    name = ""
    for i, content in enumerate(stages, start=1):
        keys = Keys(content, f"stage {i}", ("duration", "way", "velocity", "load", "depth", "ramp"))
        duration, moved = _motion(keys)
        given = [key for key in ("load", "depth") if key in keys]
        if len(given) > 1 or (given and name and given[0] != name) or not (given or name):
            got = " and ".join(given) or "neither"
            raise InputError(f"[stage {i}] the stages must have loads, or depths, from the first one on, got {got}.")
        name = name or given[0]
        new = keys.get(name, one(PUSH if name == "load" else DEPTH)) if given else values[-1]
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
    return {"time": np.array(time), "position": np.array(position), name: np.array(values)}


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
