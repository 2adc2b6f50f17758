"""What both reference solvers do with a user's arguments."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from .._runtime import as_float64, is_traced, positive
from ..errors import InputError
from ..foundation.law import Foundation
from ..results.words import brief
from ..solve.passage import Control


class Points(NamedTuple):
    """The points of a call, flattened."""

    control: Control
    value: Float[np.ndarray, " n"]
    velocity: Float[np.ndarray, " n"]  # times a_T
    given: Float[np.ndarray, " n"]  # velocity as given
    temperature: Any  # in the broadcast shape, or None
    shape: tuple[int, ...]
    cells: int

    def inputs(self, foundation: Foundation, shape: str) -> tuple[tuple[str, str], ...]:
        unit = "N" if self.control == "load" else "m"
        rows = [("material", foundation.name or "given directly"), ("shape", shape)]
        rows += [(self.control, brief(self.value, unit)), ("velocity", brief(self.given, "m/s"))]
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
    kelvin, factor = None, 1.0
    if temperature is not None:
        kelvin = as_float64("temperature", temperature)
        if foundation.shift is None:
            raise InputError(f"temperature was given ({brief(kelvin, 'K')}), but the material has no shift law.")
        factor = np.asarray(foundation.shift.a(kelvin))
    try:
        arrays = np.broadcast_arrays(value, velocity, velocity * factor, 0.0 if kelvin is None else kelvin)
    except ValueError as error:
        raise InputError(f"velocity, {control} and temperature must broadcast.") from error
    value, given, reduced, kelvins = arrays
    return Points(
        control, value.ravel(), reduced.ravel(), given.ravel(), None if kelvin is None else kelvins.copy(),
        given.shape, int(points),
    )  # fmt: skip
