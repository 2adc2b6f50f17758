"""What both reference solvers do with a user's arguments."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from .._runtime import as_float64, is_traced, positive
from ..errors import InputError
from ..foundation.law import Foundation
from ..material.vertical import thermal_factors
from ..results.words import brief
from ..solve.passage import Control


class Points(NamedTuple):
    """The points of a call, flattened."""

    control: Control
    value: Float[np.ndarray, " n"]  # load over b_T [N], or depth [m]
    vertical: Float[np.ndarray, " n"]  # b_T, by which forces are larger than those of the foundation's law
    velocity: Float[np.ndarray, " n"]  # times a_T
    given: Float[np.ndarray, " n"]  # velocity as given
    temperature: Any  # in the broadcast shape, or None
    shape: tuple[int, ...]
    cells: int

    def inputs(self, foundation: Foundation, shape: str) -> tuple[tuple[str, str], ...]:
        unit = "N" if self.control == "load" else "m"
        rows = [("material", foundation.name or "given directly"), ("shape", shape)]
        given = self.value * self.vertical if self.control == "load" else self.value
        rows += [(self.control, brief(given, unit)), ("velocity", brief(self.given, "m/s"))]
        if self.temperature is not None:
            rows.append(("temperature", brief(self.temperature, "K")))
        return (*rows, ("grid", f"{self.cells} points"))


def broadcast(
    foundation: Foundation, *, velocity: Any, load: Any, depth: Any, temperature: Any, points: Any, name: str = "load"
) -> Points:
    """Checks and flattens; raises `InputError`. `name` is what the load is called in the call."""
    if (load is None) == (depth is None):
        got = "neither" if load is None else f"{name}={load} and depth={depth}"
        raise InputError(f"{name} or depth must be given, and only one of them, got {got}.")
    if isinstance(points, bool) or not isinstance(points, (int, np.integer)) or points % 2 or not 16 <= points <= 4096:
        raise InputError(f"points must be an even whole number from 16 to 4096, got {points!r}.")
    control: Control = "load" if depth is None else "depth"
    value, velocity = as_float64(control, load if depth is None else depth), as_float64("velocity", velocity)
    if is_traced(value, velocity, foundation):
        raise InputError("material, velocity and load must be plain numbers: the reference is not differentiable.")
    positive(name if control == "load" else control, value)
    positive("velocity", velocity)
    if float(foundation.equilibrium) == 0:
        raise InputError("material must be a solid, got equilibrium modulus 0: a liquid sinks for ever.")
    kelvin, factor, vertical = None, 1.0, 1.0
    if temperature is not None:
        kelvin = as_float64("temperature", temperature)
        factor, vertical = thermal_factors(foundation, kelvin)
    try:
        arrays = np.broadcast_arrays(value, velocity, velocity * factor, 0.0 if kelvin is None else kelvin, vertical)
    except ValueError as error:
        raise InputError(f"velocity, {control} and temperature must broadcast.") from error
    value, given, reduced, kelvins, vertical = arrays
    value = value / vertical if control == "load" else value
    return Points(
        control, value.ravel(), vertical.ravel(), reduced.ravel(), given.ravel(), 
        None if kelvin is None else kelvins.copy(), given.shape, int(points),
    )  # fmt: skip
