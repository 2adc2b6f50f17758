"""A hint where a length was probably given in millimetres."""

import warnings
from typing import Any

from ..checks import is_traced
from ..errors import ModelWarning
from ..surface.shapes import Paraboloid, Sphere

_LARGEST = 2.0  # radius of a ball above which a hint is given [m]


def hint_at_metres(shape: Any) -> None:
    """Warns of a ball of more than two metres in radius."""
    if (
        not isinstance(shape, (Sphere, Paraboloid))
        or is_traced(shape)
        or not shape.radius > _LARGEST
    ):
        return
    radius = float(shape.radius)
    warnings.warn(
        f"The radius of the {shape.label} is {radius:g} m. Radii are in metres: "
        f"{radius:g} mm are {1e-3 * radius:g} m "
        f'(in a scene "{radius:g} mm").',
        ModelWarning,
        stacklevel=6,
    )
