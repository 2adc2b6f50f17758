"""Rubber of finite thickness on a rigid base: neither a half-space nor independent
springs.

A frictionless load p on the surface of a layer of thickness h displaces it, wave by
wave, by

    u(k) = (2/k) C(k, omega) p(k),      C = W(kh)/E*(omega),

with E* = E/(1 - nu^2) the modulus of the half-space. W tends to one for short waves,
which see a half-space, and for long ones to that of a thin layer: kh (1 - 2 nu)/(2 (1 -
nu)^2) where it is bonded, (2/3) (kh)^3 where it is incompressible as well, kh/2 on a
base on which it slips. `layer_kernel` is W, `layer_deficit` 1 - W; both hold for plane
waves and for those of Hankel's transform.

The kernel takes `squeeze` = 1 - 2 nu in place of nu: zero where incompressible, and
complex, 3G/(3K + G), where the bulk modulus K is constant. Source: Johnson, Contact
Mechanics (1985), section 5.8; derived again in `docs/theory.md`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..arrays import xp
from ..checks import (
    Array,
    as_float64,
    in_si,
    numpy_unless_traced,
    positive,
    scalar,
    written,
)
from ..errors import InputError
from ..material.prony import Prony
from ..material.relaxation import Relaxation
from ..material.shift import need_same_thermal
from ..material.tabulated import TabulatedModulus
from ..material.validity import Range, shared
from ..trees import Tree, fill, static
from .law import Foundation, TabulatedFoundation, normal_operator

if TYPE_CHECKING:
    from .._types import ArrayLike, ComplexArray, Number
    from ..material.shift import AbstractShift, AbstractVertical
    from ..material.softening import Softening

# below this kh the numerator of the bonded layer, which cancels as its third power, is
# a series
_SERIES = 0.5


class Layer(Tree):
    """A layer of rubber on a rigid base, with a frictionless top; `em.layer` makes it.

    How solvers use it: `layer.covers` are the layers on both sides of the contact, one,
    or two with `other`; their compliances add. Of one of them `cover.kernel(z)` is W at
    z = kh where the Poisson's ratio is constant, and `cover.kernel(z, omega)` that of
    any material; `cover.compliance(z, omega)` is W/E* [1/Pa], and `cover.deficit(z,
    omega)` the part (1 - W)/E* by which a half-space is more compliant.
    `cover.normal()` is E*(t) of the half-space as a relaxation function,
    `cover.constant` says whether W is the same at all frequencies. `name`, `shift` and
    `range` are those of the material.
    """

    material: Prony | TabulatedModulus
    thickness: Array  # h [m]
    bonded: bool = static()
    other: "Layer | None" = None  # what it meets, where that is a cover too

    def __init__(
        self,
        material: Prony | TabulatedModulus,
        thickness: Number,
        *,
        bonded: bool = True,
        other: "Layer | None" = None,
    ):
        if not isinstance(material, (Prony, TabulatedModulus)):
            raise InputError(
                argument="material",
                got=material,
                accepted="an em.Prony, or one made by em.load_material(...)",
            )
        if other is not None and not isinstance(other, Layer):
            raise InputError(argument="other", got=other, accepted="an em.layer(...)")
        if other is not None and other.other is not None:
            raise InputError(
                argument="other",
                got=other,
                accepted="a single layer, without another of its own",
            )
        thickness = scalar("thickness", thickness)
        positive("thickness", thickness)
        if other is not None:
            need_same_thermal("other", other, material)
        fill(
            self,
            material=material,
            thickness=thickness,
            bonded=bool(bonded),
            other=other,
        )

    def __repr__(self) -> str:
        return written(self)

    @property
    def covers(self) -> tuple["Layer", ...]:
        """The layers across the contact, one or two."""
        return (self,) if self.other is None else (self, self.other)

    @property
    def whole(self) -> Array:
        """Thickness of all covers [m]."""
        more = 0.0 if self.other is None else self.other.thickness
        return self.thickness + more

    @property
    def name(self) -> str:
        names = [cover.material.name for cover in self.covers]
        return (
            names[0]
            if len(names) == 1
            else " on ".join(name or "material" for name in names)
        )

    @property
    def shift(self) -> AbstractShift | None:
        """The shift law of the material."""
        return self.material.shift

    @property
    def vertical(self) -> AbstractVertical | None:
        """The vertical shift law of the material."""
        return self.material.vertical

    @property
    def softening(self) -> Softening | None:
        """The softening of the first material that has one; layers are linear, and
        their results say so.
        """
        return next(
            (
                each
                for cover in self.covers
                if (each := cover.material.softening) is not None
            ),
            None,
        )

    @property
    def range(self) -> Range | None:
        """Where the numbers of the material hold."""
        return (
            self.material.range
            if self.other is None
            else shared(self.material.range, self.other.material.range)
        )

    @property
    def constant(self) -> bool:
        """Whether the kernel is the same at every frequency: a constant Poisson's
        ratio.
        """
        return getattr(self.material, "bulk", None) is None

    @numpy_unless_traced
    def normal(self) -> Relaxation:
        """E*(t) of the half-space of this material, a Prony series [Pa]; not for a
        table of moduli.
        """
        if isinstance(self.material, TabulatedModulus):
            raise InputError(
                argument="material",
                got=self.material,
                accepted="an em.Prony here, not a table of moduli",
            )
        return normal_operator(self.material)

    @numpy_unless_traced
    def modulus(self, omega: ArrayLike) -> ComplexArray:
        """E*(omega) of the half-space of this material [Pa], at omega >= 0 [rad/s], any
        shape.
        """
        if self.constant:
            poisson: Any = self.material.poisson
            return self.material.shear().complex_modulus(omega) * (2 / (1 - poisson))
        return self.normal().complex_modulus(omega)

    @numpy_unless_traced
    def squeeze(self, omega: ArrayLike | None = None) -> Array:
        """1 - 2 nu: a number, or with a constant bulk modulus 3G/(3K + G) at omega
        [rad/s], complex.
        """
        if self.constant:
            poisson: Any = self.material.poisson
            return 1 - 2 * poisson
        if omega is None:
            raise InputError(
                argument="omega",
                accepted="given for a material with a constant bulk modulus",
            )
        material: Any = self.material
        shear, bulk = material.shear().complex_modulus(omega), material.bulk
        return 3 * shear / (3 * bulk + shear)

    @numpy_unless_traced
    def kernel(self, z: ArrayLike, omega: ArrayLike | None = None) -> Array:
        """W at z = kh, any shape; `omega` [rad/s], broadcast with it, where the bulk
        modulus is constant.
        """
        return layer_kernel(as_float64("z", z), self.squeeze(omega), self.bonded)

    @numpy_unless_traced
    def compliance(self, z: ArrayLike, omega: ArrayLike) -> Array:
        """W(kh)/E*(omega) [1/Pa] at z = kh and omega [rad/s], which broadcast."""
        return self.kernel(z, omega) / self.modulus(omega)

    @numpy_unless_traced
    def deficit(self, z: ArrayLike, omega: ArrayLike) -> Array:
        """(1 - W(kh))/E*(omega) [1/Pa]: by how much a half-space is more compliant than
        this layer.
        """
        return layer_deficit(
            as_float64("z", z), self.squeeze(omega), self.bonded
        ) / self.modulus(omega)


@in_si
def layer(
    material: Prony | TabulatedModulus,
    thickness: Number,
    *,
    bonded: bool = True,
    other: Layer | None = None,
) -> Layer:
    """Rubber of finite thickness on a rigid base, to be indented, rolled or slid on.

    Args:
        material: `Prony`, of any Poisson's ratio including 0.5 or with a constant bulk
            modulus; `TabulatedModulus` for what needs no history in time.
        thickness: [m], any, thin or thick against the contact.
        bonded: whether it sticks to its base, or slips on it without friction.
        other: a layer on the other body, for two covers in contact, as a belt on a
            lagged roller.

    Returns:
        A `Layer`, for the argument `material` of the verbs.

    Raises:
        InputError: for a thickness that is not positive, for anything but a material,
            for different shift laws.

    Exact, for small strains and a frictionless surface. The base is rigid. Source:
    `elastomdr.element.layer`.
    """
    return Layer(material, thickness, bonded=bonded, other=other)


def layer_kernel(z: Array, squeeze: Array | float, bonded: bool) -> Array:
    """W at z = kh > 0; `squeeze` = 1 - 2 nu, real or complex. Accurate to rounding for
    all z, at nu = 1/2 as well.
    """
    e, zero = xp.exp(-2 * z), xp.zeros_like(z)
    if not bonded:
        return xp.expm1(-2 * z) ** 2 / (-xp.expm1(-4 * z) + 4 * z * e)
    kappa = 1 + 2 * squeeze
    small = z < _SERIES
    y = 4 * xp.where(small, z, zero) ** 2
    # sinh(2z) - 2z = sum (2z)^(2n+1)/(2n+1)!, n = 1, 2, ...
    term, total = y / 6, y / 6
    for n in range(2, 10):
        term = term * y / (2 * n * (2 * n + 1))
        total = total + term
    excess = xp.where(small, 2 * z * e * total, -xp.expm1(-4 * z) / 2 - 2 * z * e)
    # the numerator 2 kappa sinh 2z - 4z = 2 kappa (sinh 2z - 2z) + 8z squeeze, times
    # exp(-2z)
    return (2 * kappa * excess + 8 * z * e * squeeze) / _bonded_denominator(z, e, kappa)


def layer_deficit(z: Array, squeeze: Array | float, bonded: bool) -> Array:
    """1 - W at z = kh > 0, to full relative accuracy where it is small."""
    e = xp.exp(-2 * z)
    if not bonded:
        return 2 * e * (2 * z - xp.expm1(-2 * z)) / (-xp.expm1(-4 * z) + 4 * z * e)
    kappa = 1 + 2 * squeeze
    return (
        e
        * (2 * kappa * e + 1 + kappa**2 + 4 * z**2 + 4 * z)
        / _bonded_denominator(z, e, kappa)
    )


def _bonded_denominator(z: Array, e: Array, kappa: Array | float) -> Array:
    return kappa * (1 + e**2) + (1 + kappa**2 + 4 * z**2) * e


# what a pressure rests on, each by its law
Body = Layer | Foundation | TabulatedFoundation
