"""The elements under a body that is pressed straight down: their rigid profile, and
their weight in the total force.

On a half-space they are those of the MDR line, which carry 2 q dx on both sides of the
axis (Popov & Hess 2015, ch. 3); on a thin layer the rings 2 pi r dr of an axisymmetric
body, or the strips 2 L dx of a cylinder. In each case an element at x has the rigid
surface w = d - g(x) over it, and for a contact that has only grown everything follows
from

    A(a) = int_0^a weight (g(a) - g(x)) dx,    dA/dd = W(a) = int_0^a weight dx,    V(a) = int A dd.

The force of an elastic foundation is E A. Lengths in m.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..arrays import stop_gradient, while_loop, xp
from ..checks import Array
from ..numerics.quadrature import gauss_on_panels
from ..trees import Tree, static
from .profile import Profile
from .shapes import (
    AbstractShape,
    Cylinder,
    FlatPunch,
    PowerShape,
    Sphere,
    raised,
)

if TYPE_CHECKING:
    pass


_NODES = 10  # Gauss points per panel
# Panels that narrow towards both ends: a sphere's profile is singular at its equator, a
# power law's at its axis.
_GRADED = np.concatenate(
    [
        [0.0],
        0.5 * 0.15 ** np.arange(5.0, 0.0, -1),
        1 - 0.5 * 0.15 ** np.arange(0.0, 9.0),
        [1.0],
    ]
)
_ITERATIONS = 60

_STEPS = 6  # Newton's on a sphere: from 13 % to rounding


class Disc(Tree):
    """A contact that is a disc (or a strip) of radius a, under a body that moves
    normally.
    """

    shape: AbstractShape
    kind: Literal["half-space", "layer", "cylinder"] = static()

    def profile(self, x: Array) -> Array:
        """g(x) [m] for x >= 0: the MDR profile, or on a layer the shape itself."""
        return self.shape._height(x) if self.kind == "layer" else self.shape._profile(x)

    def slope(self, x: Array) -> Array:
        """dg/dx."""
        if self.kind == "layer":
            return self.shape._steepness(x)
        return self.shape._slope(x)

    def weight(self, x: Array) -> Array:
        """What an element's force density counts in the total: 2, 2 pi x or 2 L."""
        if self.kind == "layer":
            return 2 * math.pi * x
        return xp.full_like(x, 2.0) * (
            self.shape.length if isinstance(self.shape, Cylinder) else 1.0
        )

    def width(self, a: Array) -> Array:
        """W(a) = dA/dd: 2a, pi a^2 or 2 L a."""
        return self.weight(a) * a / (2 if self.kind == "layer" else 1)

    def area(self, a: Array) -> Array:
        """A(a), so that an elastic contact carries E A."""
        n, c = self._power()
        if n is not None:
            p = 1 if self.kind == "layer" else 0
            return self.weight(a) * c * a * raised(a, n) * n / ((p + 1) * (n + p + 1))
        if isinstance(self.shape, Sphere):
            layer = self.kind == "layer"
            return self.shape.radius ** (3 if layer else 2) * _sphere_area(
                a / self.shape.radius, layer
            )
        x, dx = self._quadrature(a)
        return xp.sum(
            dx * self.weight(x) * (self.profile(a)[..., None] - self.profile(x)),
            axis=-1,
        )

    def energy(self, a: Array) -> Array:
        """V(a), so that an elastic contact stores E V."""
        n, c = self._power()
        if n is not None:
            p = 1 if self.kind == "layer" else 0
            share = 1 / (p + 1) - 2 / (n + p + 1) + 1 / (2 * n + p + 1)
            return 0.5 * self.weight(a) * a * (c * raised(a, n)) ** 2 * share
        x, dx = self._quadrature(a)
        return 0.5 * xp.sum(
            dx * self.weight(x) * (self.profile(a)[..., None] - self.profile(x)) ** 2,
            axis=-1,
        )

    @property
    def largest(self) -> Any:
        """Radius [m] that the contact cannot exceed; what is beyond a tenth of rounding
        of it is not looked at.
        """
        return xp.asarray(self.shape.largest_contact, dtype=float) * (1 - 1e-12)

    @property
    def flat(self) -> bool:
        """Whether all elements are at the same height: they then share one history."""
        return isinstance(self.shape, FlatPunch)

    def radius_of_depth(self, depth: Array) -> Array:
        """a with g(a) = d, zero for d <= 0, NaN beyond the largest contact; any shape,
        differentiable.
        """
        n, c = self._power()
        if n is not None:
            return _root(depth / c, n)
        if self.flat:
            return xp.where(depth > 0, self.shape.largest_contact, 0.0)
        if isinstance(self.shape, Sphere):
            return _sphere_radius(self.shape.radius, depth, self.kind == "layer")
        return _invert(self, "depth", depth, _root(depth * self._tip, 2.0))

    def radius_of_area(self, area: Array) -> Array:
        """a with A(a) = `area`, zero for area <= 0, NaN beyond the largest contact; any
        shape, differentiable.
        """
        n, _ = self._power()
        if self.flat:
            return xp.where(area > 0, self.shape.largest_contact, 0.0)
        if n is not None:
            one = xp.ones(())
            return _root(area / self.area(one), n + (2 if self.kind == "layer" else 1))
        if self.kind == "layer":
            return _invert(
                self, "area", area, _root(area * self._tip * 2 / math.pi, 4.0)
            )
        guess = _root(0.75 * area * self._tip, 3.0)
        # A/R^2 = (4/3) c^3 + (8/15) c^5 + ..., c = a/R
        if isinstance(self.shape, Sphere):
            guess = guess / (1 + 2 / 15 * (guess / self.shape.radius) ** 2)
        return _invert(self, "area", area, guess)

    def depth_of_area(self, area: Array) -> Array:
        """d at which A is `area`; NaN beyond the largest contact, zero for area <= 0
        unless the body is flat.
        """
        if self.flat:
            return area / self.width(xp.asarray(self.shape.largest_contact))
        radius = self.radius_of_area(area)
        return xp.where(xp.isnan(radius), xp.nan, self.profile(xp.nan_to_num(radius)))

    def measure(self, depth: Array) -> Array:
        """W at a depth: dA/dd while the contact grows."""
        return self.width(self.radius_of_depth(depth))

    @property
    def _tip(self) -> Any:
        """A length of the order of the tip's radius [m], to begin a search with."""
        if isinstance(self.shape, Sphere):
            return self.shape.radius
        x = 0.25 * xp.minimum(self.largest, 1.0)
        return x**2 / self.profile(x)

    def _power(self) -> tuple[float | None, Any]:
        """(n, c) of a profile c x^n, or (None, None)."""
        if not isinstance(self.shape, PowerShape):
            return None, None
        n, height, line = self.shape.power
        return n, height if self.kind == "layer" else line

    def _quadrature(self, a: Array) -> tuple[Array, Array]:
        """Nodes and weights on [0, a], shape (..., nodes)."""
        a = xp.asarray(a)[..., None]
        edges = (
            xp.minimum(self.shape.r, a)
            if isinstance(self.shape, Profile)
            else xp.asarray(_GRADED) * a
        )
        return gauss_on_panels(edges, _NODES)


def _invert(
    disc: Disc, name: Literal["depth", "area"], value: Array, guess: Array
) -> Array:
    """x in (0, largest] where a rising function of it, zero at zero, has the value.

    Newton's method on logarithms, nearly a straight line, in a bracket; one more step
    carries the derivatives. `numerics.root` takes secants, where the slope is at hand
    here, and knows no upper end, beyond which a profile has no answer.
    """
    value = xp.asarray(value)
    known, goal = stop_gradient((disc, value))
    in_contact = goal > 0
    goal = xp.log(xp.where(in_contact, goal, 1.0))
    top = xp.broadcast_to(xp.log(xp.minimum(known.largest, 1e60)), goal.shape)

    def height_and_rate(disc: Disc, x: Array) -> tuple[Array, Array]:
        if name == "depth":
            return disc.profile(x), disc.slope(x)
        return disc.area(x), disc.width(x) * disc.slope(x)

    def advance(state: tuple) -> tuple:
        log_x, low, high, settled, count = state
        x = xp.exp(log_x)
        height, rate = height_and_rate(known, x)
        excess = xp.log(height) - goal
        step = excess * height / (x * rate)
        settled = settled | (xp.abs(step) < 1e-8)  # the last step, below, squares this
        low, high = xp.where(excess < 0, log_x, low), xp.where(excess < 0, high, log_x)
        following = log_x - step
        middle = 0.5 * (xp.maximum(low, log_x - 8) + xp.minimum(high, log_x + 8))
        following = xp.where((following > low) & (following < high), following, middle)
        return xp.where(settled, log_x, following), low, high, settled, count + 1

    start = xp.minimum(
        xp.log(xp.where(in_contact, stop_gradient(guess), 1.0)), top - 0.1
    )
    state = (start, xp.full_like(goal, -300.0), top, ~in_contact, 0)
    log_x = while_loop(lambda s: ~xp.all(s[3]) & (s[4] < _ITERATIONS), advance, state)[
        0
    ]
    x = xp.where(in_contact, xp.exp(log_x), xp.exp(start))
    height, rate = height_and_rate(disc, x)
    step = (value - height) / stop_gradient(rate)
    # Where the step is not that of a root, the value is more than the largest contact
    # can have.
    root = xp.where(xp.abs(step) <= 1e-7 * x, x + step, xp.nan)
    return xp.where(in_contact, root, 0.0)


def _sphere_area(c: Array, layer: bool) -> Array:
    """A/R^2 = (1 + c^2) artanh(c) - c of a sphere, c = a/R; on a layer A/R^3 = (pi/3)
    (1 - s)^2 (2 + s), the volume of the cap, s = sqrt(1 - c^2).
    """
    if layer:
        s = xp.sqrt(1 - c**2)
        return math.pi / 3 * (c**2 / (1 + s)) ** 2 * (2 + s)
    small, large = xp.where(c < 0.4, c, 0.4), xp.where(c < 0.4, 0.4, c)
    series = xp.zeros_like(c)
    for n in range(18, 0, -1):
        series = (series + 1 / (2 * n - 1) + 1 / (2 * n + 1)) * (
            small**2 if n > 1 else small**3
        )
    return xp.where(c < 0.4, series, (1 + large**2) * xp.arctanh(large) - large)


def _sphere_radius(radius: Array, depth: Array, layer: bool) -> Array:
    """a = R tanh(u) with u tanh(u) = d/R of a sphere, by Newton's method; on a layer
    sqrt(2 R d - d^2).
    """
    ratio = depth / radius
    touches = ratio > 0
    ratio = xp.where(touches, ratio, 0.1)  # any number will do where it is masked
    if layer:
        square = xp.where(ratio < 1, ratio * (2 - ratio), xp.nan)
        return xp.where(touches, radius * xp.sqrt(square), 0.0)
    # a start so near that a fixed number of steps, which JAX differentiates, will do
    u = xp.sqrt(ratio * (1 + ratio))
    for _ in range(_STEPS):
        t = xp.tanh(u)
        u = u - (u * t - ratio) / (t + u * (1 - t**2))
    return xp.where(touches, radius * xp.tanh(u), 0.0)


def _root(value: Array, n: float) -> Array:
    """value^(1/n), zero where the value is not positive, with finite derivatives."""
    value = xp.asarray(value)
    return xp.where(value > 0, xp.where(value > 0, value, 1.0) ** (1 / n), 0.0)


def disc_under(shape: AbstractShape, per_area: bool) -> Disc:
    """The contact of a body on a half-space, or on springs, whose stiffness is one per
    area.
    """
    if isinstance(shape, Cylinder):
        return Disc(shape, "cylinder")
    return Disc(shape, "layer" if per_area else "half-space")


def contact_measure(shape: AbstractShape | Disc, depth: Array, per_area: bool) -> Array:
    """dA/dd [m, or m^2 on springs] at depths d > 0 [m] of a contact that grows; a flat
    punch has its own at d = 0 too.

    In place of a shape it takes the `Disc` of a contact on rubber of finite thickness.
    """
    if isinstance(shape, Disc):
        return shape.measure(depth)
    disc = disc_under(shape, per_area)
    if disc.flat:
        return disc.width(xp.full_like(depth, shape.largest_contact))
    return disc.measure(depth)
