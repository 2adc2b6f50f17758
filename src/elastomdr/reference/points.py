"""What the reference solvers do with a user's arguments and with what they found."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..call.problem import Asked, SteadyScene, steady_scene
from ..checks import numbers_only, whole_number
from ..element.law import Foundation, TabulatedFoundation
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


def needs_half_space(foundation: Foundation | TabulatedFoundation) -> None:
    """Raises `InputError` for springs."""
    if foundation.per_area:
        raise InputError(
            argument="material",
            got=foundation,
            accepted="a half-space",
            hint="em.friction is exact for independent springs",
        )


def points_of(foundation: Foundation, asked: Asked, points: int) -> ReferencePoints:
    """Checks and flattens. Raises `InputError`."""
    whole_number("points", points, 16, 4096)
    if points % 2:
        raise InputError(argument="points", got=points, accepted="even")
    steady = steady_scene(foundation, None, asked)
    numbers_only({"material": foundation, **vars(asked)})
    if float(foundation.equilibrium) == 0:
        raise InputError(
            argument="material",
            got=foundation,
            accepted="a solid, with an equilibrium modulus",
            hint="a liquid sinks for ever",
        )
    control: Control = "depth" if steady.name == "depth" else "load"
    return ReferencePoints(
        steady,
        control,
        np.ravel(steady.at_reference()),
        np.ravel(steady.vertical),
        np.ravel(steady.reduced),
        int(points),
    )
