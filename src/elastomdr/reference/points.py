"""What the reference solvers do with a user's arguments and with what they found."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..call.problem import Asked, SteadyScene, steady_scene
from ..element.law import Foundation
from ..errors import InputError
from ..smooth.passage import Control

if TYPE_CHECKING:
    from jaxtyping import Float

NOT_COMPARED = (
    "range of the data",
    "not looked at: a reference takes the material as it is given",
)


class ReferencePoints(NamedTuple):
    """The points of a call, flattened."""

    steady: SteadyScene
    control: Control
    value: Float[np.ndarray, " n"]  # load over b_T [N], or depth [m]
    # b_T, by which forces are larger than those of the foundation's law
    vertical: Float[np.ndarray, " n"]
    velocity: Float[np.ndarray, " n"]  # times a_T
    cells: int

    def inputs(
        self, *body: tuple[str, str], load: str = "N"
    ) -> tuple[tuple[str, str], ...]:
        """The rows of a result."""
        return *self.steady.inputs(*body, load=load), ("grid", f"{self.cells} points")

    def field(
        self, good: np.ndarray, values: Iterable[Any]
    ) -> Float[np.ndarray, "..."]:
        """One number per point in the shape of the call, NaN where not `good`."""
        numbers = np.array([float(value) for value in values])
        return np.where(good, numbers, np.nan).reshape(self.steady.shape)


def points_of(foundation: Foundation, asked: Asked, points: int) -> ReferencePoints:
    """Checks and flattens. Raises `InputError`."""
    if (
        isinstance(points, bool)
        or not isinstance(points, (int, np.integer))
        or points % 2
        or not 16 <= points <= 4096
    ):
        raise InputError(
            f"points must be an even whole number from 16 to 4096, got {points!r}."
        )
    steady = steady_scene(foundation, None, asked)
    if steady.traced:
        raise InputError(
            "material, velocity and load must be plain numbers: the reference is "
            "not differentiable."
        )
    if float(foundation.equilibrium) == 0:
        raise InputError(
            "material must be a solid, got equilibrium modulus 0: a liquid sinks "
            "for ever."
        )
    control: Control = "depth" if steady.name == "depth" else "load"
    return ReferencePoints(
        steady,
        control,
        steady.at_reference(),
        steady.vertical.ravel(),
        steady.reduced.ravel(),
        int(points),
    )
