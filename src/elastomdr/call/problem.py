"""The arguments of a steady call, checked and broadcast once: for bodies, rough lines,
surfaces and the references.
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ..arrays import stop_gradient
from ..checks import (
    Array,
    as_float64,
    broadcast_shape,
    certain,
    is_traced,
    known,
    only_one,
    positive,
    possible,
    require,
)
from ..element.law import Foundation
from ..errors import InputError, ModelWarning, warn
from ..material.shift import thermal_factors
from ..material.validity import material_in_words
from ..results.doubts import Doubt
from ..results.words import brief
from ..surface.shapes import AbstractShape, Cylinder, FlatPunch, Paraboloid, Sphere

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..element.layer import Body
    from ..material.prony import Prony
    from ..material.tabulated import TabulatedModulus

# velocities times a_T beyond which a shift law means nothing, and numbers overflow
_FASTEST = 1e60
_TURN = 2 * np.pi * (1 + 1e-9)
_UNITS = {"depth": "m", "pressure": "Pa"}

_LARGEST = 2.0  # radius of a ball above which a hint is given [m]


@dataclasses.dataclass(frozen=True)
class Asked:
    """The points of a steady call as its caller gives them: one of load, depth and
    pressure, all to be broadcast.
    """

    velocity: ArrayLike  # [m/s]
    load: ArrayLike | None = None  # [N], on a line per length [N/m]
    depth: ArrayLike | None = None  # [m]
    pressure: ArrayLike | None = None  # nominal, of a surface [Pa]
    temperature: ArrayLike | None = None  # [K]
    direction: ArrayLike | None = None  # of sliding, to the lay of a surface [rad]


class SteadyScene(NamedTuple):
    """The points of a steady call as float64; JAX arrays where traced, else NumPy's."""

    foundation: Any
    name: str  # of what is given: load, depth or pressure
    shape: tuple[int, ...]  # of all of them, broadcast
    velocity: Array  # as given [m/s]
    value: Array  # load, depth or pressure as given
    temperature: Array | None  # as given [K]
    reduced: Array  # v a_T [m/s], of the broadcast shape
    # b_T, of the broadcast shape: forces over b_T are those of the material at its
    # reference
    vertical: Array
    traced: bool
    direction: Array | None  # of sliding, to the lay of a surface [rad]

    def full(self, array: Array | float | None) -> Any:
        """`array` in the broadcast shape; None stays None."""
        return None if array is None else np.zeros(self.shape) + array

    def at_reference(self) -> Array:
        """Load or pressure over b_T, or the depth, at each point, flat."""
        value = self.full(self.value)
        return (value if self.name == "depth" else value / self.vertical).ravel()

    def inputs(self, *body: tuple[str, str], load: str = "N") -> list[tuple[str, str]]:
        """For results: the material, the `body`, and the points; `load` is its unit."""
        rows = [*material_in_words(self.foundation), *body]
        rows.append((self.name, brief(self.value, _UNITS.get(self.name, load))))
        rows.append(("velocity", brief(self.velocity, "m/s")))
        return (
            rows
            if self.temperature is None
            else [*rows, ("temperature", brief(self.temperature, "K"))]
        )


def steady_scene(
    foundation: Any,
    body: Any,
    asked: Asked,
    *one_of: Literal["load", "depth", "pressure"],
) -> SteadyScene:
    """Checks and broadcasts; `one_of` names what may be given, load or depth by
    default. Raises `InputError`.

    The points are traced if `foundation` or `body`, on which they are solved, are.
    """
    given = {"load": asked.load, "depth": asked.depth, "pressure": asked.pressure}
    name = only_one({key: given[key] for key in one_of or ("load", "depth")})
    velocity = as_float64("velocity", asked.velocity)
    value = as_float64(name, given[name])
    temperature, direction = asked.temperature, asked.direction
    positive("velocity", velocity)
    positive(name, value)
    temperature = (
        None if temperature is None else as_float64("temperature", temperature)
    )
    if direction is not None:
        direction = as_float64("direction", direction)
        accepted = "an angle in rad, of 2 pi at most to either side"
        require("direction", direction, accepted, lambda x: np.abs(x) < _TURN)
    points = {"velocity": velocity, name: value, "temperature": temperature}
    shape = broadcast_shape({**points, "direction": direction})
    factor, vertical = thermal_factors(foundation, temperature)
    if temperature is not None:
        _check_shift(temperature, velocity, factor)
    traced = is_traced(foundation, body, velocity, value, temperature, direction)
    return SteadyScene(
        foundation,
        name,
        shape,
        velocity,
        value,
        temperature,
        reduced=np.zeros(shape) + velocity * factor,
        vertical=np.zeros(shape) + vertical,
        traced=traced,
        direction=direction,
    )


def rough_scene(
    foundation: Any,
    surface: Any,
    rtol: Any,
    asked: Asked,
    *one_of: Literal["load", "depth", "pressure"],
) -> SteadyScene:
    """The scene of a rough line or surface, which has conditions of its own. Raises
    `InputError`.
    """
    check_carries(foundation)
    check_rtol(rtol)
    return steady_scene(foundation, surface, asked, *one_of)


def check_rtol(rtol: Any, least: str = "1e-10", most: str = "1e-1") -> float:
    """The tolerance as a number. Raises `InputError` unless it is one that the call can
    keep.
    """
    if isinstance(rtol, (np.ndarray, np.generic)) and rtol.ndim == 0:
        rtol = rtol.item()
    number = isinstance(rtol, (int, float)) and not isinstance(rtol, bool)
    if not number or not float(least) <= rtol <= float(most):
        raise InputError(
            argument="rtol", got=rtol, accepted=f"a number from {least} to {most}"
        )
    return float(rtol)


def check_carries(foundation: Any) -> None:
    """Raises `InputError` for what carries no rough surface: a layer, a liquid."""
    if foundation.per_area:
        raise InputError(
            argument="material",
            got=foundation,
            accepted="a half-space under a rough surface, not a layer",
        )
    at_rest = foundation.complex_modulus(np.zeros(()))
    if not possible(lambda modulus: modulus.real > 0, at_rest):
        raise InputError(
            argument="material",
            got=foundation,
            accepted="a solid with an equilibrium modulus under a rough surface",
            hint="a liquid carries no steady load on an unbounded surface, since "
            "every element sinks until the mean force is gone",
        )


def _check_shift(temperature: Array, velocity: Array, factor: Array | float) -> None:
    def lost(velocity: Array, factor: Array | float) -> Array:
        reduced = velocity * factor
        return ~((reduced > 1 / _FASTEST) & (reduced < _FASTEST))

    with np.errstate(over="ignore", invalid="ignore"):
        if possible(lambda *x: not lost(*x).any(), velocity, factor):
            return
        temperature, reduced, bad = np.broadcast_arrays(
            temperature, velocity * factor, lost(velocity, factor)
        )
    raise InputError(
        argument="temperature",
        got=float(temperature[bad].flat[0]),
        accepted=f"such that the velocity times a_T is between {1 / _FASTEST:g} and "
        f"{_FASTEST:g} m/s",
        hint=f"v a_T is {float(reduced[bad].flat[0]):.3g} m/s, too far from where the "
        "shift law was measured",
    )


def hint_at_metres(shape: object) -> None:
    """Warns of a ball of more than two metres in radius."""
    if not isinstance(shape, Sphere | Paraboloid) or not certain(
        lambda radius: radius > _LARGEST, shape.radius
    ):
        return
    radius = float(shape.radius)
    warn(
        f"The radius of the {shape.label} is {radius:g} m. Radii are in metres: "
        f"{radius:g} mm are {1e-3 * radius:g} m "
        f'(in a scene "{radius:g} mm").',
        ModelWarning,
    )


# depth over radius of the body at which the depth is the radius of contact
_DEEPEST = {Paraboloid: 1.0, Cylinder: 0.5, Sphere: math.tanh(1.0), FlatPunch: 1.0}


def doubt_depth(
    body: Prony | TabulatedModulus | Body, shape: AbstractShape, depth: Array
) -> tuple[Doubt, ...]:
    """The doubt of a shape that is pressed in deeper than the radius a of the contact
    that belongs to the depth, d = g(a), or through springs; with a warning.

    The mean strain of a contact, 0.2 a/R under a ball (Tabor 1951; Johnson 1985, section
    6.3), is 0.2 d/a under any body. Above d = a it is no small one, and a paraboloid,
    which stands for a ball of radius R, has left it at a = R. Springs of an
    `em.Foundation` that is given directly have no thickness, and no strains.
    """
    springs = isinstance(body, Foundation) and body.is_springs(shape)
    thick = body.thickness if isinstance(body, Foundation) and springs else None
    if springs and thick is None:
        return ()
    depth, pressed, thick = known(stop_gradient((depth, shape, thick)))
    remedy = "a depth below the radius of contact"
    with np.errstate(all="ignore"):
        if springs:
            points = depth >= thick
            remedy = "a depth below the thickness"
        else:
            # g(d) > d where d > a; a cylinder's g is half of a paraboloid's
            scale = 2.0 if isinstance(shape, Cylinder) else 1.0
            points = pressed._profile(scale * depth) > depth
            points = (points | (depth >= pressed.largest_contact)) & (depth > 0)
            round_or_flat = isinstance(
                shape, Paraboloid | Cylinder | Sphere | FlatPunch
            )
            if round_or_flat and not is_traced(shape):
                deepest = _DEEPEST[type(shape)] * float(shape.radius)
                remedy += f", here {deepest:.3g} m"
    says = (
        "are deeper than springs are thick"
        if springs
        else "are deeper than the radius of contact (of a ball: wider than it is)"
    )
    says += ": mean strains above 0.2, beyond the linear theory of small strains"
    doubt = Doubt("estimate", points, says, remedy)
    if certain(np.any, points):
        warn(f"{doubt.words()}.", ModelWarning)
    return (doubt,)
