"""A contact as parallel lines of independent elements: one for a half-space or a
cylinder, strips for a layer.

Along each line the rigid body moves in x. The size of the contact is one number A [m],
the same for all lines: the leading edge of the central line. A line enters contact at a
= entry(A).
"""

from __future__ import annotations

import abc
import functools
import math
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import xp
from ..checks import Array
from ..numerics.quadrature import gauss, shares_to_legendre
from ..trees import Tree, static
from .profile import Profile
from .shapes import AbstractShape, Cylinder, PowerShape

if TYPE_CHECKING:
    from jaxtyping import Float

_APEX = 1e-9  # of the leading edge: what counts as the apex
_FLAT = 60.0  # power that stands for a flat
_ONE = np.ones((1, 1))  # weight of a line that stands for the whole contact
# Strips crowd towards a pointed apex, where the sum over them goes as y^n log y.
_CROWDED = 3


class AbstractLines(Tree):
    """Lines j = 0 ... count-1, with their weights in the total force."""

    shape: AbstractShape

    @property
    @abc.abstractmethod
    def count(self) -> int:
        """Number of lines."""

    @abc.abstractmethod
    def entry(self, size: Float[Array, " points"]) -> Float[Array, "lines points"]:
        """Leading edge a_j [m] of each line."""

    @abc.abstractmethod
    def weight(self, size: Float[Array, " points"]) -> Float[Array, "lines points"]:
        """Factor that turns a line's force into its share of the total: 1, or a width
        [m].
        """

    @abc.abstractmethod
    def profile(self, x: Array, size: Array, line: Array) -> Array:
        """Rigid profile g_j(x) [m], zero at x = 0."""

    @abc.abstractmethod
    def slope(self, x: Array, size: Array, line: Array) -> Array:
        """dg_j/dx, odd in x."""

    @abc.abstractmethod
    def summation_error(
        self, parts: Float[Array, "lines points"]
    ) -> Float[Array, " points"]:
        """Estimated error of the sum of all lines' shares in a force, for a finite
        number of strips.
        """

    @abc.abstractmethod
    def refined(self, strips: int) -> "AbstractLines":
        """The same contact in `strips` strips, where it is in strips."""

    @abc.abstractmethod
    def depth(self, size: Array) -> Array:
        """Indentation depth [m] at which the central line enters at `size`."""

    def exponent(self, size: Float[Array, " points"]) -> Float[Array, " points"]:
        """a g'(a)/g(a) on the central line: 1 for a cone, 2 for a paraboloid."""
        entry, central = self.entry(size)[:1], xp.zeros((1, 1), int)
        return (
            entry
            * self.slope(entry, size, central)
            / self.profile(entry, size, central)
        )[0]

    def rise(
        self, leading: Float[Array, " points"], trailing: Float[Array, " points"]
    ) -> Float[Array, " points"]:
        """a g'(a)/g(a) on the central line, the mean of both edges; large where an edge
        lies on a flat.
        """
        edges, central = (
            xp.stack([leading, xp.maximum(trailing, _APEX * leading)]),
            xp.zeros((1, 1), int),
        )
        height, slope = (
            self.profile(edges, leading, central),
            self.slope(edges, leading, central),
        )
        power = xp.where(
            height > 0, edges * slope / xp.where(height > 0, height, 1.0), _FLAT
        )
        return 0.5 * xp.sum(xp.minimum(power, _FLAT), axis=0)


class SingleLine(AbstractLines):
    """The MDR line of a half-space contact, or the one line of a cylinder on a layer
    (weighted by its length).
    """

    shape: AbstractShape

    @property
    def count(self) -> int:
        return 1

    def entry(self, size: Array) -> Array:
        return size[None]

    def weight(self, size: Array) -> Array:
        if not isinstance(self.shape, Cylinder):
            return _ONE
        return xp.full((1, 1), self.shape.length)

    def profile(self, x: Array, size: Array, line: Array) -> Array:
        return self.shape._profile(x)

    def slope(self, x: Array, size: Array, line: Array) -> Array:
        return self.shape._slope(x)

    def summation_error(self, parts: Array) -> Array:
        return xp.zeros_like(parts[0])

    def refined(self, strips: int) -> "SingleLine":
        return self

    def depth(self, size: Array) -> Array:
        return self.shape._profile(size)


class Strips(AbstractLines):
    """An axisymmetric body on a thin layer: strips along the motion at y = A
    sin(theta), Gauss points in theta.

    Exact for a layer, up to the quadrature across the contact, since the layer's
    elements are independent in both directions.
    """

    shape: AbstractShape
    strips: int = static(default=16)  # over the half-width

    @property
    def count(self) -> int:
        return self.strips

    @property
    def _angles(self) -> tuple[np.ndarray, np.ndarray]:
        return _angles(self.strips, _CROWDED if pointed(self.shape) else 1)

    def entry(self, size: Array) -> Array:
        return size * xp.cos(self._angles[0])[:, None]

    def weight(self, size: Array) -> Array:
        angle, weight = self._angles
        return 2 * size * (xp.cos(angle) * weight)[:, None]

    def profile(self, x: Array, size: Array, line: Array) -> Array:
        return self.shape._rise(self._beside(size, line), x)

    def slope(self, x: Array, size: Array, line: Array) -> Array:
        r = xp.hypot(x, self._beside(size, line))
        return self.shape._steepness(r) * x / r

    def _beside(self, size: Array, line: Array) -> Array:
        """Distance y [m] of each strip from the axis."""
        return size * xp.sin(xp.take(self._angles[0], line))

    def summation_error(self, parts: Array) -> Array:
        # Gauss' rule with n points misses about the 2n-th Legendre coefficient c of the
        # integrand. It is reached from c_n/2 and c_n by the law that joins them, c_2n =
        # c_n^2/c_n/2 for a power and less for an exponential. Against 96 strips of
        # spheres, cones and power laws on three rubbers that was up to 3 times too
        # small, hence the 4.
        size = xp.abs(shares_to_legendre(self.strips) @ parts)
        half, last = (
            xp.max(size[self.strips // 2 - 2 : self.strips // 2], axis=0),
            xp.max(size[-2:], axis=0),
        )
        return 4 * last * xp.minimum(last / xp.where(half > 0, half, 1.0), 1.0)

    def refined(self, strips: int) -> "Strips":
        return Strips(self.shape, strips)

    def depth(self, size: Array) -> Array:
        return self.shape._height(size)


def pointed(shape: AbstractShape) -> bool:
    """Whether derivatives of the height do not exist at the apex: those of a cone, of
    powers that are not even, and of profiles given by points, which may be anything.
    """
    if isinstance(shape, PowerShape):
        return shape.power.exponent % 2 != 0
    return isinstance(shape, Profile)


@functools.cache
def _angles(strips: int, power: int) -> tuple[np.ndarray, np.ndarray]:
    """theta and its weights: Gauss points in u, theta = (pi/2) u^power."""
    nodes, weights = gauss(strips)
    u = 0.5 * (nodes + 1)
    angle = 0.5 * math.pi * u**power
    return angle, 0.25 * math.pi * weights * power * u ** (power - 1)
