"""Tables that take a scene further: [warming] and [conveyor] for `elastomdr rolling`, [drive] for `elastomdr slide`."""

from collections.abc import Callable
from typing import Any, NamedTuple

from ..errors import InputError
from .keys import Keys, numbers, one, one_or_more, whole
from .units import (
    CAPACITY,
    CONDUCTANCE,
    DAMPING,
    DURATION,
    FORCE,
    LENGTH,
    LINE_MASS,
    LOADED_MASS,
    MASS,
    STIFFNESS,
    TEMPERATURE,
)

TABLES = ("warming", "conveyor")
_WARMING = ("ambient", "conductance", "capacity", "duration", "points", "hottest")
_CONVEYOR = ("spacing", "shares", "belt", "goods", "return_spacing", "return_length", "return_thickness")
_POINTS, _MOST_POINTS = 121, 10_000  # instants of a history


class Further(NamedTuple):
    """What is computed in place of what the verb computes."""

    name: str  # of the table, and of the files
    verb: str  # that it belongs to
    call: Callable[..., Any]
    arguments: dict[str, Any]  # beside those of the scene


def read_further(
    name: str, content: Any, on_layer: Callable[[float], Any], shape: Any, thickness: float | None
) -> Further:
    """The table `name` of a scene; `on_layer(thickness)` makes a cover like that of the scene. Raises `InputError`."""
    if name == "warming":
        return _warming(Keys(content, name, _WARMING))
    if thickness is None:
        raise InputError("[conveyor] needs a [layer], the cover of the belt, and an [indenter] with a cylinder.")
    return _conveyor(Keys(content, name, _CONVEYOR), on_layer, shape, thickness)


def _warming(keys: Keys) -> Further:
    """`em.warming`: the steady temperature, or with a duration and a heat capacity the way to it."""
    import numpy as np

    from .. import warming

    arguments: dict[str, Any] = {
        "ambient": keys.get("ambient", one_or_more(TEMPERATURE)),
        "conductance": keys.get("conductance", one(CONDUCTANCE)),
    }
    if ("capacity" in keys) != ("duration" in keys):
        raise InputError("[warming] capacity and duration belong together: give both for the history, or neither.")
    if "capacity" in keys:
        points = keys.get("points", lambda name, value: whole(name, value, 2, _MOST_POINTS)) if "points" in keys else 0
        time = np.linspace(0, keys.get("duration", one(DURATION)), points or _POINTS)
        arguments |= {"capacity": keys.get("capacity", one(CAPACITY)), "time": time}
    if "hottest" in keys:
        arguments["hottest"] = keys.get("hottest", one(TEMPERATURE))
    return Further("warming", "rolling", warming, arguments)


def _conveyor(keys: Keys, on_layer: Callable[[float], Any], shape: Any, thickness: float) -> Further:
    """`em.conveyor`: roll and cover of the scene on the carry side, one roll in a set on the return side.

    That roll is as long as all of the carry side's set together and runs on a cover like its, unless said otherwise.
    """
    from .. import Cylinder, Idlers, conveyor

    shares = keys.get("shares", numbers) if "shares" in keys else [1.0]
    length = keys.get("return_length", one(LENGTH)) if "return_length" in keys else len(shares) * shape.length
    above = keys.get("return_thickness", one(LENGTH)) if "return_thickness" in keys else thickness
    spacing, back_spacing = keys.get("spacing", one(LENGTH)), keys.get("return_spacing", one(LENGTH))
    arguments = {"belt": keys.get("belt", one(LINE_MASS)), "goods": keys.get("goods", one_or_more(LOADED_MASS))}
    try:
        carry = Idlers(on_layer(thickness), shape, spacing=spacing, shares=shares)
        back = Idlers(on_layer(above), Cylinder(shape.radius, length), spacing=back_spacing)
    except InputError as error:
        raise InputError(f"[conveyor] {error}") from error

    def call(material: Any, body: Any, **scene: Any) -> Any:
        return conveyor(carry, back, **scene)

    return Further("conveyor", "rolling", call, arguments)


def read_drive(content: Any, history: dict[str, Any], per_length: bool) -> Further:
    """The [drive] of a scene with stages: the body hangs on a spring, and the stages are where the drive goes.

    Under a surface the forces are per length of line: mass, stiffness and damping of the drive of a whole body that is
    pressed on with `normal_force` are scaled to the line's load. Raises `InputError`.
    """
    from .. import Mount, drive

    keys = Keys(content, "drive", ("mass", "stiffness", "damping", "normal_force"))
    if "load" not in history:
        raise InputError("[drive] needs stages with a load: a body on a spring has no depth of its own.")
    if per_length != ("normal_force" in keys):
        raise InputError(
            "[drive] normal_force must be given under a [surface]: the force on the body for which the line stands."
            if per_length
            else "[drive] normal_force belongs to a [surface]; an indenter has its load."
        )
    damping = keys.get("damping", one(DAMPING)) if "damping" in keys else 0.0
    mount = Mount(keys.get("mass", one(MASS)), keys.get("stiffness", one(STIFFNESS)), damping)
    if per_length:
        load, force = float(history["load"][-1]), keys.get("normal_force", one(FORCE))
        if not load > 0:
            raise InputError("[drive] needs a load above zero in the last stage.")
        mount = mount.for_line(load, force)
    return Further("drive", "slide", drive, {"tangential": mount})
