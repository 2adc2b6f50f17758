"""Axisymmetric indenters and their MDR profiles; the cylinder that acts on a layer.

The MDR profile of a body f(r) is g(x) = |x| int_0^|x| f'(r)/sqrt(x^2 - r^2) dr (Popov &
Hess 2015, ch. 3). Lengths in m.
"""

from __future__ import annotations

import abc
import math
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from ..arrays import on_jax, xp
from ..checks import (
    Array,
    as_float64,
    numpy_unless_traced,
    plain,
    positive,
    require,
    scalar,
    written,
)
from ..trees import Tree, fill, static

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number


class AbstractShape(Tree):
    """A rigid indenter, rising from its lowest point: `height(r)` in three dimensions,
    `profile_1d(x)` on the line.
    """

    label: ClassVar[str]  # what the shape is called in a sentence

    def __repr__(self) -> str:
        return written(self)

    @abc.abstractmethod
    def _height(self, r: Array) -> Array:
        """f(r) for r >= 0."""

    def _steepness(self, r: Array) -> Array:
        """df/dr for r >= 0; a shape that gives its own is differentiated without
        JAX.
        """
        import jax

        return on_jax(lambda: jax.jvp(self._height, (r,), (jax.numpy.ones_like(r),))[1])

    @abc.abstractmethod
    def _profile(self, x: Array) -> Array:
        """g(x) for any sign of x."""

    @abc.abstractmethod
    def _slope(self, x: Array) -> Array:
        """dg/dx, odd in x."""

    def _rise(self, y: Array, x: Array) -> Array:
        """f(sqrt(x^2 + y^2)) - f(y), how far the surface rises from the axis to x on a
        strip beside it. Bodies with a formula for it lose no digits where x << y.
        """
        return self._height(xp.hypot(x, y)) - self._height(y)

    @numpy_unless_traced
    def height(self, r: ArrayLike) -> Array:
        """Height f(r) [m] of the surface above its lowest point, at radii [m], any
        shape.
        """
        return self._height(xp.abs(as_float64("r", r)))

    @numpy_unless_traced
    def profile_1d(self, x: ArrayLike) -> Array:
        """MDR profile g(x) [m] at positions [m], any shape."""
        return self._profile(as_float64("x", x))

    @numpy_unless_traced
    def slope_1d(self, x: ArrayLike) -> Array:
        """Slope dg/dx of the MDR profile at positions [m], any shape."""
        return self._slope(as_float64("x", x))

    @property
    def rolling_radius(self) -> Array | None:
        """Radius [m] about which the body rolls; None for a body that does not roll."""
        return None

    @property
    def largest_contact(self) -> Array | float:
        """Contact radius [m] that the shape cannot exceed."""
        return math.inf


class Power(NamedTuple):
    """A power law c x^n."""

    exponent: float  # n
    height: Array | float  # c of the body, f = c r^n
    line: Array | float  # c of its MDR profile, g = c |x|^n


class PowerShape(AbstractShape):
    """A body whose height is a power of the radius, and so its MDR profile."""

    @property
    @abc.abstractmethod
    def power(self) -> Power:
        """Exponent and coefficients."""

    def _height(self, r: Array) -> Array:
        return self.power.height * raised(r, self.power.exponent)

    def _steepness(self, r: Array) -> Array:
        n, c, _ = self.power
        return n * c * raised(r, n - 1)

    def _profile(self, x: Array) -> Array:
        return self.power.line * raised(xp.abs(x), self.power.exponent)

    def _slope(self, x: Array) -> Array:
        n, _, c = self.power
        # x itself, where it can be: |x| sign(x) has no derivative at zero
        return (
            n
            * c
            * (x ** int(n - 1) if n % 2 == 0 else raised(xp.abs(x), n - 1) * xp.sign(x))
        )


class Paraboloid(PowerShape):
    """f = r^2/(2R), g = x^2/R: the usual stand-in for a sphere while the contact is
    small.
    """

    radius: Float[Array, ""]  # R [m]
    label: ClassVar[str] = "paraboloid"

    def __init__(self, radius: Number):
        fill(self, radius=scalar("radius", radius))
        positive("radius", self.radius)

    @property
    def power(self) -> Power:
        return Power(2.0, 0.5 / self.radius, 1 / self.radius)

    def _rise(self, y: Array, x: Array) -> Array:
        return self._height(x)

    @property
    def rolling_radius(self) -> Array | None:
        return self.radius


class Sphere(AbstractShape):
    """f = R - sqrt(R^2 - r^2), g = (x/2) ln((R+x)/(R-x)): the full sphere, any
    depth.
    """

    radius: Float[Array, ""]  # R [m]
    label: ClassVar[str] = "sphere"

    def __init__(self, radius: Number):
        fill(self, radius=scalar("radius", radius))
        positive("radius", self.radius)

    def _height(self, r: Array) -> Array:
        return r**2 / (self.radius + xp.sqrt(self.radius**2 - r**2))

    def _steepness(self, r: Array) -> Array:
        return r / xp.sqrt(self.radius**2 - r**2)

    def _rise(self, y: Array, x: Array) -> Array:
        high = self.radius**2 - y**2
        return x**2 / (xp.sqrt(high) + xp.sqrt(high - x**2))

    def _profile(self, x: Array) -> Array:
        return x * xp.arctanh(x / self.radius)

    def _slope(self, x: Array) -> Array:
        c = x / self.radius
        return xp.arctanh(c) + c / (1 - c**2)

    @property
    def rolling_radius(self) -> Array | None:
        return self.radius

    @property
    def largest_contact(self) -> Array | float:
        return self.radius


class Cone(PowerShape):
    """f = slope r, g = (pi/2) slope |x|, with slope = tan(theta), theta the angle
    between flank and surface.
    """

    slope: Float[Array, ""]
    label: ClassVar[str] = "cone"

    def __init__(self, slope: Number):
        fill(self, slope=scalar("slope", slope))
        positive("slope", self.slope)

    @property
    def power(self) -> Power:
        return Power(1.0, self.slope, 0.5 * math.pi * self.slope)

    def _rise(self, y: Array, x: Array) -> Array:
        return self.slope * x**2 / (y + xp.hypot(x, y))


class PowerLaw(PowerShape):
    """f = c r^n, g = kappa_n c |x|^n, kappa_n = sqrt(pi) n Gamma(n/2)/(2
    Gamma((n+1)/2)); n > 0, c in m^(1-n).
    """

    coefficient: Float[Array, ""]  # c [m^(1-n)]
    # n: it decides how the profile is integrated, so it is not differentiated
    exponent: float = static()
    label: ClassVar[str] = "power law"

    def __init__(self, exponent: Number, coefficient: Number):
        fill(
            self,
            exponent=plain("exponent", exponent),
            coefficient=scalar("coefficient", coefficient),
        )
        positive("exponent", self.exponent)
        # a steep body of 1 mm has (1 mm)^(1-n)
        decades = min(300, int(100 * max(1.0, self.exponent - 1)))
        accepted = f"positive, between 1e-{decades} and 1e{decades} m^(1-n)"
        require(
            "coefficient",
            self.coefficient,
            accepted,
            lambda c: (c > 10.0**-decades) & (c < 10.0**decades),
        )

    @property
    def power(self) -> Power:
        n = self.exponent
        gammas = math.exp(math.lgamma(n / 2) - math.lgamma((n + 1) / 2))
        kappa = math.sqrt(math.pi) * n / 2 * gammas
        return Power(n, self.coefficient, kappa * self.coefficient)

    def _rise(self, y: Array, x: Array) -> Array:
        beside = xp.minimum(x / y, 1.0)
        growth = xp.expm1(0.5 * self.exponent * xp.log1p(beside**2))
        return xp.where(x < y, self._height(y) * growth, super()._rise(y, x))


class FlatPunch(AbstractShape):
    """A flat-ended cylinder of the given radius: f = 0 inside, no contact outside.

    Its edge has no slope, so steady sliding has no meaning for it (`em.friction`
    refuses it and says what to do).
    """

    radius: Float[Array, ""]  # [m]
    label: ClassVar[str] = "flat punch"

    def __init__(self, radius: Number):
        fill(self, radius=scalar("radius", radius))
        positive("radius", self.radius)

    def _height(self, r: Array) -> Array:
        return xp.where(r <= self.radius, 0.0, xp.inf)

    def _steepness(self, r: Array) -> Array:
        return xp.zeros_like(r)

    def _profile(self, x: Array) -> Array:
        return xp.where(xp.abs(x) <= self.radius, 0.0, xp.inf)

    def _slope(self, x: Array) -> Array:
        return xp.zeros_like(x)

    @property
    def largest_contact(self) -> Array | float:
        return self.radius


class Cylinder(PowerShape):
    """A cylinder or roller of radius R and length L on a layer: f = g = x^2/(2R), with
    x across its axis.
    """

    radius: Float[Array, ""]  # R [m]
    length: Float[Array, ""]  # L, along the axis [m]
    label: ClassVar[str] = "cylinder on a layer"

    def __init__(self, radius: Number, length: Number):
        fill(self, radius=scalar("radius", radius), length=scalar("length", length))
        positive("radius", self.radius)
        positive("length", self.length)

    @property
    def power(self) -> Power:
        return Power(2.0, 0.5 / self.radius, 0.5 / self.radius)

    @property
    def rolling_radius(self) -> Array | None:
        return self.radius


def raised(x: Array, exponent: float) -> Array:
    """x^exponent for x >= 0, with a finite derivative at zero where a search direction
    passes through it.
    """
    if exponent == int(exponent) and exponent >= 0:
        return x ** int(exponent)
    return xp.where(
        x > 0, xp.where(x > 0, x, 1.0) ** exponent, 0.0 if exponent > 0 else xp.inf
    )
