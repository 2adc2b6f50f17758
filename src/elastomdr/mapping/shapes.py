"""Axisymmetric indenters and their MDR profiles; the cylinder that acts on a layer.

The MDR profile of a body f(r) is g(x) = |x| int_0^|x| f'(r)/sqrt(x^2 - r^2) dr (Popov & Hess 2015, ch. 3). Lengths in
m.
"""

import abc
import math
from typing import Any, ClassVar

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Float

from .._runtime import Array, as_float64, in_float64, plain, positive, scalar, written


class AbstractShape(eqx.Module):
    """A rigid indenter, rising from its lowest point: `height(r)` in three dimensions, `profile_1d(x)` on the line."""

    label: ClassVar[str]  # what the shape is called in a sentence

    def __repr__(self) -> str:
        return written(self)

    @abc.abstractmethod
    def _height(self, r: Array) -> Array:
        """f(r) for r >= 0."""

    @abc.abstractmethod
    def _profile(self, x: Array) -> Array:
        """g(x) for any sign of x."""

    @abc.abstractmethod
    def _slope(self, x: Array) -> Array:
        """dg/dx, odd in x."""

    @in_float64
    def height(self, r: Any) -> Array:
        """Height f(r) [m] of the surface above its lowest point, at radii [m], any shape."""
        return self._height(jnp.abs(jnp.asarray(as_float64("r", r))))

    @in_float64
    def profile_1d(self, x: Any) -> Array:
        """MDR profile g(x) [m] at positions [m], any shape."""
        return self._profile(jnp.asarray(as_float64("x", x)))

    @in_float64
    def slope_1d(self, x: Any) -> Array:
        """Slope dg/dx of the MDR profile at positions [m], any shape."""
        return self._slope(jnp.asarray(as_float64("x", x)))

    @property
    def rolling_radius(self) -> Any:
        """Radius [m] about which the body rolls; None for a body that does not roll."""
        return None

    @property
    def largest_contact(self) -> Any:
        """Contact radius [m] that the shape cannot exceed."""
        return jnp.inf


class Paraboloid(AbstractShape):
    """f = r^2/(2R), g = x^2/R: the usual stand-in for a sphere while the contact is small."""

    radius: Float[Array, ""]  # R [m]
    label: ClassVar[str] = "paraboloid"

    def __init__(self, radius: Any):
        self.radius = scalar("radius", radius)
        positive("radius", self.radius)

    def _height(self, r: Array) -> Array:
        return r**2 / (2 * self.radius)

    def _profile(self, x: Array) -> Array:
        return x**2 / self.radius

    def _slope(self, x: Array) -> Array:
        return 2 * x / self.radius

    @property
    def rolling_radius(self) -> Any:
        return self.radius


class Sphere(AbstractShape):
    """f = R - sqrt(R^2 - r^2), g = (x/2) ln((R+x)/(R-x)): the full sphere, any depth."""

    radius: Float[Array, ""]  # R [m]
    label: ClassVar[str] = "sphere"

    def __init__(self, radius: Any):
        self.radius = scalar("radius", radius)
        positive("radius", self.radius)

    def _height(self, r: Array) -> Array:
        return r**2 / (self.radius + jnp.sqrt(self.radius**2 - r**2))

    def _profile(self, x: Array) -> Array:
        return x * jnp.arctanh(x / self.radius)

    def _slope(self, x: Array) -> Array:
        c = x / self.radius
        return jnp.arctanh(c) + c / (1 - c**2)

    @property
    def rolling_radius(self) -> Any:
        return self.radius

    @property
    def largest_contact(self) -> Any:
        return self.radius


class Cone(AbstractShape):
    """f = slope r, g = (pi/2) slope |x|, with slope = tan(theta), theta the angle between flank and surface."""

    slope: Float[Array, ""]
    label: ClassVar[str] = "cone"

    def __init__(self, slope: Any):
        self.slope = scalar("slope", slope)
        positive("slope", self.slope)

    def _height(self, r: Array) -> Array:
        return self.slope * r

    def _profile(self, x: Array) -> Array:
        return 0.5 * math.pi * self.slope * jnp.abs(x)

    def _slope(self, x: Array) -> Array:
        return 0.5 * math.pi * self.slope * jnp.sign(x)


class PowerLaw(AbstractShape):
    """f = c r^n, g = kappa_n c |x|^n, kappa_n = sqrt(pi) n Gamma(n/2)/(2 Gamma((n+1)/2)); n > 0, c in m^(1-n)."""

    coefficient: Float[Array, ""]  # c [m^(1-n)]
    exponent: float = eqx.field(static=True)  # n: it decides how the profile is integrated, so it is not differentiated
    label: ClassVar[str] = "power law"

    def __init__(self, exponent: Any, coefficient: Any):
        self.exponent = plain("exponent", exponent)
        positive("exponent", self.exponent)
        self.coefficient = scalar("coefficient", coefficient)
        positive("coefficient", self.coefficient)

    @property
    def _kappa(self) -> float:
        n = self.exponent
        return math.sqrt(math.pi) * n / 2 * math.exp(math.lgamma(n / 2) - math.lgamma((n + 1) / 2))

    def _height(self, r: Array) -> Array:
        return self.coefficient * r**self.exponent

    def _profile(self, x: Array) -> Array:
        return self._kappa * self.coefficient * _power(jnp.abs(x), self.exponent)

    def _slope(self, x: Array) -> Array:
        n = self.exponent
        return self._kappa * n * self.coefficient * _power(jnp.abs(x), n - 1) * jnp.sign(x)


class FlatPunch(AbstractShape):
    """A flat-ended cylinder of the given radius: f = 0 inside, no contact outside.

    Its edge has no slope, so steady sliding has no meaning for it (`em.friction` refuses it and says what to do).
    """

    radius: Float[Array, ""]  # [m]
    label: ClassVar[str] = "flat punch"

    def __init__(self, radius: Any):
        self.radius = scalar("radius", radius)
        positive("radius", self.radius)

    def _height(self, r: Array) -> Array:
        return jnp.where(r <= self.radius, 0.0, jnp.inf)

    def _profile(self, x: Array) -> Array:
        return jnp.where(jnp.abs(x) <= self.radius, 0.0, jnp.inf)

    def _slope(self, x: Array) -> Array:
        return jnp.zeros_like(x)

    @property
    def largest_contact(self) -> Any:
        return self.radius


class Cylinder(AbstractShape):
    """A cylinder or roller of radius R and length L on a layer: f = g = x^2/(2R), with x across its axis."""

    radius: Float[Array, ""]  # R [m]
    length: Float[Array, ""]  # L, along the axis [m]
    label: ClassVar[str] = "cylinder on a layer"

    def __init__(self, radius: Any, length: Any):
        self.radius, self.length = scalar("radius", radius), scalar("length", length)
        positive("radius", self.radius)
        positive("length", self.length)

    def _height(self, r: Array) -> Array:
        return r**2 / (2 * self.radius)

    def _profile(self, x: Array) -> Array:
        return x**2 / (2 * self.radius)

    def _slope(self, x: Array) -> Array:
        return x / self.radius

    @property
    def rolling_radius(self) -> Any:
        return self.radius


def _power(x: Array, exponent: float) -> Array:
    """x^exponent for x >= 0, with a finite derivative at zero where a search direction passes through it."""
    if exponent == int(exponent) and exponent >= 0:
        return x ** int(exponent)
    return jnp.where(x > 0, jnp.where(x > 0, x, 1.0) ** exponent, 0.0 if exponent > 0 else jnp.inf)
