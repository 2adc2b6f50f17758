"""The kinds of scenes of each command, reading a file as one of them, and writing it."""

from pathlib import Path
from typing import Any

import tomli_w

from .. import __version__
from ..errors import InputError, closest
from ..files import read_toml
from .histories import (
    BodySlide,
    ImpactScene,
    IndentationByPoints,
    IndentationScene,
    SurfaceSlide,
)
from .scene import Scene
from .schema import Content, about, decode, keys_of
from .seals import BreakOutScene, LeakScene, LubricatedScene, RingScene, StrokeScene
from .steady import (
    BodyComparison,
    BodyFriction,
    ConveyorScene,
    RollingScene,
    SurfaceComparison,
    SurfaceFrictionScene,
    TractionScene,
    WarmingScene,
    WheelTraction,
)

# Of each command, the kind that a scene is by default last.
KINDS: dict[str, tuple[type[Scene], ...]] = {
    "friction": (SurfaceFrictionScene, BodyFriction),
    "rolling": (WarmingScene, ConveyorScene, RollingScene),
    "indent": (IndentationByPoints, IndentationScene),
    "impact": (ImpactScene,),
    "slide": (SurfaceSlide, BodySlide),
    "traction": (WheelTraction, TractionScene),
    "leak": (LeakScene,),
    "lubricated": (LubricatedScene,),
    "o_ring": (RingScene,),
    "reciprocating": (StrokeScene,),
    "break_out": (BreakOutScene,),
    "compare": (SurfaceComparison, BodyComparison),
}


def read_scene(verb: str, path: Path) -> Scene:
    """A scene of the command `verb` from its file. Raises `InputError` for whatever is
    wrong.
    """
    return decoded(verb, read_content(path))


def read_content(path: Path) -> Content:
    """What a TOML file holds. Raises `InputError` where it cannot be read."""
    return read_toml(path, "SCENE")


def decoded(verb: str, content: Content) -> Scene:
    """A scene of the command `verb` from what its file holds. Raises `InputError` for
    whatever is wrong.
    """
    kind = next((kind for kind in KINDS[verb] if kind.fits(content)), KINDS[verb][-1])
    for key in content:
        if key not in keys_of(kind):
            _refuse(verb, kind, key, isinstance(content[key], dict | list))
    return decode(kind, content)


def _refuse(verb: str, kind: type[Scene], key: str, table: bool) -> None:
    """Raises `InputError` for a key that other kinds of scenes have."""
    name = f"[{key}]" if table else key
    homes = [
        home
        for home, kinds in KINDS.items()
        if any(key in keys_of(other) for other in kinds)
    ]
    if verb in homes:
        raise InputError(
            argument=name,
            accepted="left out of a scene of this kind",
            hint=kind.without.get(key) or f'it is one of "{about(kind).rstrip(".")}"',
        )
    if homes:
        raise InputError(
            argument=name,
            accepted=f"left out of a scene of elastomdr {verb}",
            hint=f"it belongs to elastomdr {', '.join(homes)}",
        )
    elsewhere = {
        other for kinds in KINDS.values() for one in kinds for other in keys_of(one)
    }
    if not closest(key, keys_of(kind)) and (hint := closest(key, sorted(elsewhere))):
        raise InputError(
            argument=name,
            accepted="a key of this kind of scenes",
            hint=f"{hint} That key belongs to scenes of another kind.",
        )


def toml(verb: str, content: Content, stem: str, notes: tuple[str, ...] = ()) -> str:
    """The scene file; its first lines say how it is run."""
    head = [
        f"# elastomdr {verb} {stem}.toml",
        *(f"# {note}" for note in notes),
        f"# written by elastomdr {__version__}",
    ]
    filled = without_empty(content)
    lines = [
        f"{key} = {_as_toml(value)}"
        for key, value in filled.items()
        if not isinstance(value, dict)
    ]
    for name, table in filled.items():
        if isinstance(table, dict):
            lines += [
                "",
                f"[{name}]",
                *(f"{key} = {_as_toml(value)}" for key, value in table.items()),
            ]
    return "\n".join([*head, "", *lines, ""])


def _as_toml(value: Any) -> str:
    """A value in one line."""
    if isinstance(value, dict):
        return (
            "{ "
            + ", ".join(f"{key} = {_as_toml(one)}" for key, one in value.items())
            + " }"
        )
    if isinstance(value, list):
        return f"[{', '.join(map(_as_toml, value))}]"
    return tomli_w.dumps({"x": value}).removeprefix("x = ").rstrip("\n")


def without_empty(content: Content) -> Content:
    """Without [numerics] as long as nothing stands in it."""
    return {key: value for key, value in content.items() if key != "numerics" or value}
