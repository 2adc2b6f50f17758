"""What the reference solvers do with a user's arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..call.problem import Scene, steady_scene
from ..element.law import Foundation
from ..errors import InputError
from ..smooth.passage import Control

if TYPE_CHECKING:
    from jaxtyping import Float

NOT_COMPARED = (
    "range of the data",
    "not looked at: a reference takes the material as it is given",
)


class Points(NamedTuple):
    """The points of a call, flattened."""

    at: Scene
    control: Control
    value: Float[np.ndarray, " n"]  # load over b_T [N], or depth [m]
    # b_T, by which forces are larger than those of the foundation's law
    vertical: Float[np.ndarray, " n"]
    velocity: Float[np.ndarray, " n"]  # times a_T
    cells: int

    def inputs(
        self, *body: tuple[str, str], load: str = "N"
    ) -> tuple[tuple[str, str], ...]:
        return *self.at.inputs(*body, load=load), ("grid", f"{self.cells} points")


def broadcast(
    foundation: Foundation,
    *,
    velocity: Any,
    temperature: Any,
    points: Any,
    **given: Any,
) -> Points:
    """Checks and flattens; `given` are load and depth by their names in the call.
    Raises `InputError`.
    """
    if (
        isinstance(points, bool)
        or not isinstance(points, (int, np.integer))
        or points % 2
        or not 16 <= points <= 4096
    ):
        raise InputError(
            f"points must be an even whole number from 16 to 4096, got {points!r}."
        )
    at = steady_scene(
        foundation, None, velocity=velocity, temperature=temperature, **given
    )
    if at.traced:
        raise InputError(
            "material, velocity and load must be plain numbers: the reference is "
            "not differentiable."
        )
    if float(foundation.equilibrium) == 0:
        raise InputError(
            "material must be a solid, got equilibrium modulus 0: a liquid sinks "
            "for ever."
        )
    control: Control = "depth" if at.name == "depth" else "load"
    return Points(
        at,
        control,
        at.at_reference(),
        at.vertical.ravel(),
        at.reduced.ravel(),
        int(points),
    )
