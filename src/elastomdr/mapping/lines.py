"""A contact as parallel lines of independent elements: one for a half-space or a cylinder, strips for a layer.

Along each line the rigid body moves in x. The size of the contact is one number A [m], the same for all lines: the
leading edge of the central line. A line enters contact at a = entry(A).
"""

import abc
import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .._runtime import Array
from .shapes import AbstractShape, Cylinder

STRIPS = 16  # Gauss points over the half-width of a layer contact


class AbstractLines(eqx.Module):
    """Lines j = 0 ... count-1, with their weights in the total force."""

    shape: eqx.AbstractVar[AbstractShape]

    @property
    @abc.abstractmethod
    def count(self) -> int:
        """Number of lines."""

    @abc.abstractmethod
    def entry(self, size: Float[Array, " points"]) -> Float[Array, "lines points"]:
        """Leading edge a_j [m] of each line."""

    @abc.abstractmethod
    def weight(self, size: Float[Array, " points"]) -> Float[Array, "lines points"]:
        """Factor that turns a line's force into its share of the total: 1, or a width [m]."""

    @abc.abstractmethod
    def profile(self, x: Array, size: Array, line: Array) -> Array:
        """Rigid profile g_j(x) [m], zero at x = 0."""

    @abc.abstractmethod
    def slope(self, x: Array, size: Array, line: Array) -> Array:
        """dg_j/dx, odd in x."""

    @abc.abstractmethod
    def depth(self, size: Array) -> Array:
        """Indentation depth [m] at which the central line enters at `size`."""


class SingleLine(AbstractLines):
    """The MDR line of a half-space contact, or the one line of a cylinder on a layer (weighted by its length)."""

    shape: AbstractShape

    @property
    def count(self) -> int:
        return 1

    def entry(self, size: Array) -> Array:
        return size[None]

    def weight(self, size: Array) -> Array:
        length = self.shape.length if isinstance(self.shape, Cylinder) else 1.0
        return jnp.full((1, 1), length)

    def profile(self, x: Array, size: Array, line: Array) -> Array:
        return self.shape._profile(x)

    def slope(self, x: Array, size: Array, line: Array) -> Array:
        return self.shape._slope(x)

    def depth(self, size: Array) -> Array:
        return self.shape._profile(size)


class Strips(AbstractLines):
    """An axisymmetric body on a thin layer: strips along the motion at y = A sin(theta), Gauss points in theta.

    Exact for a layer, up to the quadrature across the contact, since the layer's elements are independent in both
    directions.
    """

    shape: AbstractShape

    @property
    def count(self) -> int:
        return STRIPS

    def entry(self, size: Array) -> Array:
        return size * jnp.cos(_angles()[0])[:, None]

    def weight(self, size: Array) -> Array:
        angle, weight = _angles()
        return 2 * size * (jnp.cos(angle) * weight)[:, None]

    def profile(self, x: Array, size: Array, line: Array) -> Array:
        y = size * jnp.sin(jnp.asarray(_angles()[0])[line])
        return self.shape._height(jnp.hypot(x, y)) - self.shape._height(y)

    def slope(self, x: Array, size: Array, line: Array) -> Array:
        r = jnp.hypot(x, size * jnp.sin(jnp.asarray(_angles()[0])[line]))
        _, steepness = jax.jvp(self.shape._height, (r,), (jnp.ones_like(r),))
        return steepness * x / r

    def depth(self, size: Array) -> Array:
        return self.shape._height(size)


def _angles() -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(STRIPS)
    return math.pi / 4 * (nodes + 1), math.pi / 4 * weights
