"""The scene file of `elastomdr indent`: an indenter, a material and a [history] of depth or load."""

from pathlib import Path
from typing import Any

from ..errors import InputError
from .indenter import read_indenter
from .keys import Keys, choice, one, one_or_more, positive_number, text, whole
from .scene import Scene, in_file, read_material, read_toml
from .units import ADHESION, DEPTH, DURATION, FORCE, FREQUENCY, INSTANT, LENGTH, PAUSE, PUSH, TEMPERATURE

_PROGRAMS = {
    "hold": ("duration", "rise", "spacing"),
    "ramp": ("duration",),
    "triangle": ("duration", "cycles", "rest"),
    "sine": ("frequency", "cycles", "amplitude"),
}
_MOST_POINTS = 10_000


def read_history(path: str) -> Scene:
    """Reads a scene file. Raises `InputError`, in one line that begins with the file's name, for whatever is wrong."""
    with in_file(path):
        return _scene(Path(path), read_toml(Path(path)))


def _scene(path: Path, content: dict[str, Any]) -> Scene:
    keys = ("title", "material", "other", "temperature", "adhesion", "indenter", "layer", "history", "numerics")
    top = Keys(content, "", keys)
    title = top.get("title", text) if "title" in top else None
    for table in ("indenter", "history"):
        if table not in top:
            raise InputError(f"[{table}] is missing: a scene has a material, an [indenter] and a [history].")
    arguments = _history(content["history"])
    if "temperature" in top:
        arguments["temperature"] = top.get("temperature", one(TEMPERATURE))
    if "adhesion" in top:
        arguments["adhesion"] = top.get("adhesion", one(ADHESION))
    numerics = Keys(content.get("numerics", {}), "numerics", ("rtol",))
    if "rtol" in numerics:
        arguments["rtol"] = numerics.get("rtol", positive_number)
    shape = read_indenter(content["indenter"], path.parent)
    material = read_material(top, content.get("layer"), shape, path.parent, arguments)
    return Scene(path, title, material, shape, arguments)


def _history(content: Any) -> dict[str, Any]:
    """time, and depth or load, from a program with a name or from points."""
    import numpy as np

    every = ("program", "points", "time", "depth", "load", *dict.fromkeys(k for v in _PROGRAMS.values() for k in v))
    keys = Keys(content, "history", every)
    points = keys.get("points", _points) if "points" in keys else 200
    if "program" not in keys:
        keys = Keys(content, "history", ("points", "time", "depth", "load"))
        instants = np.asarray(keys.get("time", _several(INSTANT)))
        if not (np.diff(instants) > 0).all():
            raise InputError("[history] time must be ascending, without repeats.")
        name, values = _control(keys, _several(DEPTH), _several(PUSH))
        if len(values) != len(instants):
            raise InputError(
                f"[history] time and {name} must be lists of the same length, got {len(instants)} and {len(values)}."
            )
        time = np.union1d(instants, np.linspace(instants[0], instants[-1], points))
        return {"time": time, name: np.interp(time, instants, values)}
    program = keys.get("program", choice(*_PROGRAMS))
    keys = Keys(content, "history", ("program", "points", "depth", "load", *_PROGRAMS[program]))
    name, size = _control(keys, one_or_more(LENGTH), one_or_more(FORCE))
    kind = LENGTH if name == "depth" else FORCE
    time, value = {"hold": _hold, "ramp": _ramp, "triangle": _triangle, "sine": _sine}[program](keys, points, kind)
    if callable(value):
        return {"time": time, name: value(np.asarray(size))}
    return {"time": time, name: np.multiply.outer(size, value)}


def _hold(keys: Keys, points: int, _: Any) -> Any:
    """A step or a ramp up to the value, which is then kept: creep under a load, relaxation under a depth."""
    import numpy as np

    duration = keys.get("duration", one(DURATION))
    rise = keys.get("rise", one(PAUSE)) if "rise" in keys else 0.0
    even = "spacing" in keys and keys.get("spacing", choice("log", "linear")) == "linear"
    since = (
        np.linspace(0, duration, points)
        if even
        else np.append(0.0, np.geomspace(1e-6 * duration, duration, points - 1))
    )
    if not rise:
        return since, np.ones(points)
    time = np.concatenate([np.linspace(0, rise, 41)[:-1], rise + since])
    return time, np.minimum(time / rise, 1.0)


def _ramp(keys: Keys, points: int, _: Any) -> Any:
    """From zero to the value."""
    import numpy as np

    part = np.linspace(0, 1, points)
    return part * keys.get("duration", one(DURATION)), part


def _triangle(keys: Keys, points: int, _: Any) -> Any:
    """Up to the value and down again within `duration`, `cycles` times, a `rest` at zero after each."""
    import numpy as np

    duration = keys.get("duration", one(DURATION))
    cycles = keys.get("cycles", _count) if "cycles" in keys else 1
    rest = keys.get("rest", one(PAUSE)) if "rest" in keys else 0.0
    kinks, heights = [0.0], [0.0]
    for i in range(cycles):
        start = i * (duration + rest)
        kinks += [start + 0.5 * duration, start + duration] + ([start + duration + rest] if rest else [])
        heights += [1.0, 0.0] + ([0.0] if rest else [])
    time = np.union1d(kinks, np.linspace(0, kinks[-1], points))
    return time, np.interp(time, kinks, heights)


def _sine(keys: Keys, points: int, kind: Any) -> Any:
    """A step to the value, about which depth or load then swings by `amplitude`."""
    import numpy as np

    frequency, cycles = keys.get("frequency", one(FREQUENCY)), keys.get("cycles", _count)
    amplitude = keys.get("amplitude", one(kind))
    time = np.linspace(0, cycles / frequency, points)
    wave = amplitude * np.sin(2 * np.pi * frequency * time)

    def value(mean: Any) -> Any:
        if kind is FORCE and (mean < amplitude).any():
            raise InputError("[history] amplitude must not be larger than load: a load that pulls needs adhesion.")
        return np.add.outer(mean, wave)

    return time, value


def _control(keys: Keys, depth: Any, load: Any) -> tuple[str, Any]:
    if ("load" in keys) == ("depth" in keys):
        got = "both" if "load" in keys else "neither"
        raise InputError(f"[history] must have either a load or a depth, got {got}.")
    return ("load", keys.get("load", load)) if "load" in keys else ("depth", keys.get("depth", depth))


def _several(kind: Any) -> Any:
    """A list of two or more quantities."""

    def read(name: str, value: Any) -> list[float]:
        values = one_or_more(kind)(name, value)
        if not isinstance(values, list):
            raise InputError(f"{name} must be a list of two or more values with units, got {value!r}.")
        return values

    return read


def _points(name: str, value: Any) -> int:
    return whole(name, value, 2, _MOST_POINTS)


def _count(name: str, value: Any) -> int:
    return whole(name, value, 1, 1000)
