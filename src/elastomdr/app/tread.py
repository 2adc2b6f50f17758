"""The friction that a slip curve takes: of the tread's own rubber on the road, where
the wheel needs it.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import elastomdr as em

from ..cli.kinds import decoded
from ..errors import InputError
from .scene import Done, compute, files_of
from .security import Folder

COMPUTED = "computed"  # what is typed in the place of a coefficient or a table
TABLE = "tread-friction.csv"
_PRESSURES = 3
_PER_DECADE = 8  # velocities
_MARGIN = 1.01  # by which the table reaches beyond what the wheel needs
_OF_THE_ROAD = ("surface", "heat", "adhesion", "numerics")
_IN_PLACE_OF_A_PRESSURE = ("pressure", "load", "depth")


def compute_on_road(
    wheel: dict[str, Any],
    road: dict[str, Any],
    folder: Folder,
    progress: Callable[[int, int], None],
) -> Done:
    """Computes a slip curve whose friction is "computed".

    Args:
        wheel: the scene of the slip curve.
        road: the scene of the friction screen, of which rubber, temperature, pressure
            and velocity are replaced.
        folder: where the table of friction is kept.
        progress: called with the parts done and all of them; may raise to stop.

    Returns:
        The slip curve, as of a scene that names the table.

    Raises:
        InputError: beginning with "[surface]" for the road, else with the key of the
            slip curve.
    """
    scene = _scene_of_friction(wheel, road, folder)
    try:
        table = compute("friction", scene, folder, progress)
    except InputError as error:
        said = str(error)
        raise InputError(
            said if said.startswith(("[surface]", "material")) else f"friction: {said}"
        ) from error
    folder.keep(TABLE, table.csv(), anew=True)
    done = compute("traction", wheel | {"friction": TABLE}, folder)
    done.asked = wheel
    done.warnings = (
        *(f"Friction of the tread: {text}" for text in table.warnings),
        *done.warnings,
    )
    pressures, span = scene["contact"]["pressure"], scene["contact"]["velocity"]
    done.more = (
        "friction of the tread computed on the road of the friction screen, at "
        f"{pressures[0]} to {pressures[-1]}, {span['from']} to {span['to']}"
    )
    return done


def _scene_of_friction(
    wheel: dict[str, Any], road: dict[str, Any], folder: Folder
) -> dict[str, Any]:
    """The friction screen's scene with the rubber of the wheel, at its temperatures,
    pressures and velocities.
    """
    pressure, velocity = _needed(wheel, folder)
    low, high = pressure.min() / _MARGIN, pressure.max() * _MARGIN
    slow, fast = velocity.min() / _MARGIN, velocity.max() * _MARGIN
    contact = {
        key: value
        for key, value in road["contact"].items()
        if key not in _IN_PLACE_OF_A_PRESSURE
    }
    contact["pressure"] = [
        f"{each / 1e6:.5g} MPa" for each in np.geomspace(low, high, _PRESSURES)
    ]
    points = 2 + math.ceil(_PER_DECADE * math.log10(fast / slow))
    contact["velocity"] = {
        "from": f"{slow:.5g} m/s",
        "to": f"{fast:.5g} m/s",
        "points": points,
    }
    taken = {key: road[key] for key in _OF_THE_ROAD if key in road}
    taken |= {key: wheel[key] for key in ("material", "temperature") if key in wheel}
    return taken | {"contact": contact}


def _needed(wheel: dict[str, Any], folder: Folder) -> tuple[np.ndarray, np.ndarray]:
    """Mean pressures of the contact [Pa] and sliding velocities [m/s] of a wheel."""
    content = wheel | {"friction": 1.0}
    scene: Any = decoded("traction", content)
    folder.check(files_of(content))
    arguments = scene.arguments(folder.path)
    way = "slip" if "slip" in arguments else "creepage"
    sliding = np.abs(np.asarray(arguments[way]) * arguments["velocity"])
    if not (sliding > 0).all():
        raise InputError(
            f"[contact] {way} must not be zero where friction is computed: nothing "
            "slides."
        )
    # The normal contact does not depend on slip: any one serves.
    once = em.traction(**arguments | {way: 0.5})
    width = once.contact.leading + once.contact.trailing
    return np.asarray(once.normal_force / (width * scene.indenter.length)), sliding
