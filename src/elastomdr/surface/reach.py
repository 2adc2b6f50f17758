"""How far a contact reaches at a given depth: the inverse of the profile, a(d) with
g(a) = d, and the contact measure.

While a rigid body goes deeper into a line of independent elements by dd, each element
in contact is pressed in by dd, so that the displaced measure A(d) = int (d - w) grows
by A'(d) dd with

    A'(d) = 2 a(d) on the MDR line of an axisymmetric body [m]       (Popov & Hess 2015, ch. 3)
    A'(d) = 2 a(d) L for a cylinder of length L on a layer [m^2]
    A'(d) = pi a(d)^2 for an axisymmetric body on a layer [m^2], with f(a) = d.

The force of an elastic foundation is E A(d). Lengths in m.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..arrays import fixed, fori_loop, xp
from ..checks import Array
from .disc import Disc
from .profile import Profile
from .shapes import (
    AbstractShape,
    Cone,
    Cylinder,
    FlatPunch,
    Paraboloid,
    PowerLaw,
    Sphere,
)

if TYPE_CHECKING:
    from jaxtyping import Float

_STEPS = 6  # Newton's on a sphere: from 13 % to rounding
_ROUNDS = 12  # of Newton inside a bracket between two points of a profile


def contact_measure(
    shape: AbstractShape | Disc, depth: Float[Array, "..."], per_area: bool
) -> Float[Array, "..."]:
    """A'(d) of this module's docstring [m, or m^2 on springs], at depths d > 0 [m];
    exact.

    In place of a shape it takes the `Disc` of a contact on rubber of finite thickness,
    which knows its own.
    """
    if isinstance(shape, Disc):
        return shape.measure(depth)
    size = contact_size(shape, depth, per_area and not isinstance(shape, Cylinder))
    if isinstance(shape, Cylinder):
        return 2 * size * shape.length
    return math.pi * size**2 if per_area else 2 * size


def contact_size(
    shape: AbstractShape, depth: Float[Array, "..."], by_height: bool = False
) -> Float[Array, "..."]:
    """a(d) with g(a) = d, or with f(a) = d if `by_height` [m]: the contact while it
    grows; exact.

    NaN where the contact would be wider than the body. A flat punch has its own radius
    at any depth.
    """
    if isinstance(shape, FlatPunch):
        return xp.broadcast_to(xp.asarray(shape.radius), xp.shape(depth))
    if isinstance(shape, Paraboloid):
        return xp.sqrt((2 if by_height else 1) * shape.radius * depth)
    if isinstance(shape, Cylinder):
        return xp.sqrt(2 * shape.radius * depth)
    if isinstance(shape, Cone):
        return depth / (shape.slope * (1 if by_height else 0.5 * math.pi))
    if isinstance(shape, PowerLaw):
        stretch = 1.0 if by_height else shape._kappa
        return (depth / (stretch * shape.coefficient)) ** (1 / shape.exponent)
    if isinstance(shape, Sphere):
        return _on_sphere(shape.radius, depth, by_height)
    if isinstance(shape, Profile):
        return _on_profile(shape, depth, by_height)
    raise TypeError(f"the contact size of a {type(shape).__name__} is not known")


def _on_sphere(radius: Any, depth: Array, by_height: bool) -> Array:
    """a = sqrt(2 R d - d^2), or R tanh(u) with u tanh(u) = d/R."""
    part = depth / radius
    if by_height:
        return radius * xp.sqrt(xp.where(part < 1, part * (2 - part), xp.nan))
    u = xp.sqrt(part * (1 + part))
    for _ in range(_STEPS):
        t = xp.tanh(u)
        u = u - (u * t - part) / (t + u * (1 - t**2))
    return radius * xp.tanh(u)


def _on_profile(shape: Profile, depth: Array, by_height: bool) -> Array:
    """Newton's method between the two points around it."""
    value = shape._height if by_height else shape._profile
    points = xp.asarray(shape.r)
    heights = value(points)
    i = xp.clip(xp.searchsorted(heights, depth), 1, points.shape[0] - 1)

    def newton(x: Array, depth: Array) -> tuple[Array, Array]:
        there, slope = value(x), shape._steepness(x) if by_height else shape._slope(x)
        return there, x - (there - depth) / fixed(slope)

    def close_in(_: int, state: tuple) -> tuple:
        x, low, high = state
        there, following = newton(x, wanted)
        low, high = xp.where(there < wanted, x, low), xp.where(there < wanted, high, x)
        return (
            xp.where(
                (following >= low) & (following <= high), following, 0.5 * (low + high)
            ),
            low,
            high,
        )

    wanted = fixed(depth)
    low, high = fixed((points[i - 1], points[i]))
    x = fori_loop(0, _ROUNDS, close_in, (0.5 * (low + high), low, high))[0]
    x = newton(fixed(x), depth)[1]  # with the derivatives
    return xp.where(depth <= heights[-1], x, xp.nan)
