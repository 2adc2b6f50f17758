"""The foundation: what each element of the line does, and how a half-space or a thin
layer becomes one.

Radok's functional equations (1957) replace the elastic constants of the elastic
solution by operators. With a constant bulk modulus the result is again a Prony series,
exactly, since a multiple of G in series with a spring is one (`material.relaxation`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, overload

import numpy as np

from ..checks import (
    Array,
    as_float64,
    certain,
    in_si,
    is_traced,
    numpy_unless_traced,
    positive,
    scalar,
)
from ..errors import InputError, ModelWarning, warn
from ..material.prony import Prony
from ..material.relaxation import (
    AbstractRelaxation,
    Relaxation,
    checked,
    parallel,
    scaled,
    series,
    spring,
)
from ..material.shift import (
    AbstractShift,
    AbstractVertical,
    check_laws,
    is_same,
    need_same_thermal,
)
from ..material.softening import Softening, as_softening
from ..material.tabulated import (
    AbstractTable,
    TabulatedModulus,
    described,
    needs_series,
)
from ..material.validity import Range, RangeLike, as_range, shared
from ..surface.shapes import Cylinder
from ..trees import Tree, fill, replaced, static

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number


class Slab(Tree):
    """The layer that springs stand for, to be compared with it."""

    material: Prony
    thickness: Array  # [m]
    bonded: bool = static()


class Foundation(AbstractRelaxation):
    """Independent elements, each with E(t) = E_inf + sum_k E_k exp(-t/tau_k) + eta
    delta(t).

    For a half-space the numbers are E* [Pa]: an element of width dx carries E* u dx.
    For a layer they are stiffness per area [Pa/m]. `per_area` says which; None, as when
    the numbers are given directly, leaves it to the shape: a cylinder takes them per
    area, with a `model_error` of NaN until `per_area=True` says so; for every other
    shape they are E* of a half-space, with its `model_error`. Raises `InputError` as
    `Prony` does.
    """

    equilibrium: Float[Array, ""]  # E_inf [Pa, or Pa/m]
    moduli: Float[Array, " n"]  # E_k [Pa, or Pa/m]
    times: Float[Array, " n"]  # tau_k, ascending [s]
    viscosity: Float[Array, ""]  # eta [Pa s, or Pa s/m]
    shift: AbstractShift | None
    vertical: AbstractVertical | None  # b_T, which multiplies all stiffness
    softening: Softening | None  # factors on the moduli by strain; None: linear
    # of a layer, a scalar [m]: what its strain is a part of; None: not known, or no
    # layer
    thickness: Array | None
    per_area: bool | None = static()
    name: str = static()
    range: Range | None = static()  # where the numbers hold; None: not known
    slab: Slab | None = None  # of `em.springs`

    def __init__(
        self,
        equilibrium: Number,
        moduli: ArrayLike,
        times: ArrayLike,
        viscosity: Number = 0.0,
        *,
        shift: AbstractShift | None = None,
        vertical: AbstractVertical | None = None,
        softening: Softening | None = None,
        thickness: Number | None = None,
        per_area: bool | None = None,
        name: str = "",
        range: RangeLike | None = None,
    ):
        law = checked(equilibrium, moduli, times, viscosity)
        check_laws(shift, vertical)
        fill(
            self,
            **vars(law),
            shift=shift,
            vertical=vertical,
            softening=as_softening(softening),
            per_area=per_area,
        )
        fill(self, name=name, range=as_range(range))
        fill(
            self,
            thickness=None if thickness is None else scalar("thickness", thickness),
            slab=None,
        )

    @classmethod
    @in_si
    def kelvin(cls, stiffness: Number, viscosity: Number) -> "Foundation":
        """Kelvin elements: a spring and a dashpot in parallel."""
        return cls(stiffness, np.zeros(0), np.zeros(0), viscosity)

    @classmethod
    @in_si
    def maxwell(cls, stiffness: Number, time: Number) -> "Foundation":
        """Maxwell elements: a spring and a dashpot in series."""
        return cls(
            0.0,
            as_float64("stiffness", stiffness)[None],
            as_float64("time", time)[None],
        )

    def __repr__(self) -> str:
        unit = (
            "Pa/m"
            if self.per_area
            else "Pa"
            if self.per_area is not None
            else "Pa or Pa/m"
        )
        label = f"{self.name!r}, " if self.name else ""
        if is_traced(self) or np.ndim(self.equilibrium) or np.ndim(self.moduli) != 1:
            return (
                f"Foundation({label}{np.shape(self.moduli)[-1]} branches, traced or a "
                "batch)"
            )
        glassy = float(self.equilibrium + np.sum(self.moduli))
        span = (
            f", tau {self.times[0]:.3g}..{self.times[-1]:.3g} s"
            if self.moduli.size
            else ""
        )
        dashpot = (
            f", viscosity {float(self.viscosity):.4g} {unit} s"
            if float(self.viscosity)
            else ""
        )
        return (
            f"Foundation({label}{float(self.equilibrium):.4g} {unit} relaxed, "
            f"{glassy:.4g} {unit} glassy, {self.moduli.size} branches{span}{dashpot})"
        )

    def is_springs(self, shape: object) -> bool:
        """Whether its numbers are per area under this shape."""
        on_line = isinstance(shape, Cylinder)
        return on_line if self.per_area is None else self.per_area

    def law(self) -> Relaxation:
        return Relaxation(self.equilibrium, self.moduli, self.times, self.viscosity)


class TabulatedFoundation(AbstractTable):
    """A half-space by a table of E*(omega), for steady models of surfaces;
    `em.half_space(tabulated)` makes it.

    It answers what such models ask of a `Foundation`: `complex_modulus`, `shift`,
    `vertical`, `softening`, `range`, `name` and `per_area`.
    """

    omega: Float[Array, " n"]
    storage_table: Float[Array, " n"]  # Re E* [Pa]
    loss_table: Float[Array, " n"]  # Im E* [Pa]
    shift: AbstractShift | None
    vertical: AbstractVertical | None
    softening: Softening | None  # factors on the moduli by strain; None: linear
    name: str = static()
    range: Range | None = static()  # where the numbers hold; None: not known
    per_area: ClassVar[bool] = False

    @property
    def equilibrium(self) -> Array:
        """E* at the lowest frequency [Pa], below which it is taken as constant."""
        return self.storage_table[0]

    def __repr__(self) -> str:
        label = f"{self.name!r}, " if self.name else ""
        return f"TabulatedFoundation({label}{described(self)})"


@overload
def half_space(
    material: Prony, other: Prony | None = None, *, tangential: bool = False
) -> Foundation: ...
@overload
def half_space(
    material: TabulatedModulus, other: None = None, *, tangential: bool = False
) -> TabulatedFoundation: ...
@numpy_unless_traced
def half_space(
    material: Prony | TabulatedModulus,
    other: Prony | None = None,
    *,
    tangential: bool = False,
) -> Foundation | TabulatedFoundation:
    """The foundation of a half-space by Radok's equations, exact; with `other`, of two
    half-spaces in contact.

    Two bodies carry the same pressure: their creep functions add, so that two
    viscoelastic ones give n_1 + n_2 branches (twice that for constant bulk moduli).
    `tangential` gives G* in place of E*. A `TabulatedModulus` gives the table of E* =
    2G/(1 - nu) = E/(1 - nu^2), for steady models of surfaces; no second body is taken
    with it. Source: Radok 1957; Popov & Hess 2015, ch. 7. Two bodies keep a softening
    that both have; any other is left out, with a `ModelWarning`. Raises `InputError`
    for two materials with different shift laws, unless they are already at their
    temperature (`material.at(T)`).
    """
    if other is None and isinstance(material, TabulatedModulus):
        return _half_space_of_table(material, tangential)
    operator = tangential_operator if tangential else normal_operator
    law = operator(_material("material", material))
    name = material.name
    known = material.range
    if other is not None:
        law = series(law, operator(_material("other", other)))
        need_same_thermal("other", other, material)
        name = f"{material.name or 'material'} on {other.name or 'material'}"
        known = shared(known, other.range)
        if not is_same(material.softening, other.softening):
            material = replaced(material, softening=None)
            warn(
                (
                    f"{name}: two bodies of which one softens with strain, or each in "
                    "its own way, are taken as linear."
                ),
                ModelWarning,
            )
    return _foundation(law, material, False, name, known)


@numpy_unless_traced
def springs(
    material: Prony | TabulatedModulus,
    thickness: Number,
    *,
    bonded: bool = True,
    tangential: bool = False,
) -> Foundation:
    """Independent springs in place of a layer on a rigid base, stiffness per area
    [Pa/m]; `thickness` in m.

    The textbook's; `em.layer` is the layer itself. Springs hold where the contact is
    much wider than the layer is thick: the `model_error` of `em.friction` and
    `em.rolling` says how far they are from it under a cylinder. `tangential` gives the
    stiffness of simple shear, G(t) over the thickness, as of the tread in the brush
    model of a tyre. Raises `InputError` for a bonded incompressible layer, which does
    not act as a row of springs, and for one that is sheared without being bonded.
    Source: Johnson 1985, section 5.8.
    """
    thickness = scalar("thickness", thickness)
    positive("thickness", thickness)
    if tangential and not bonded:
        raise InputError(
            argument="bonded",
            got=bonded,
            accepted="True with tangential",
            hint="a layer that slips on its base is not sheared",
        )
    rubber = _material("material", material)
    law = scaled(
        rubber.shear().law() if tangential else layer_operator(rubber, bonded),
        1 / thickness,
    )
    slab = None if tangential else Slab(rubber, thickness, bool(bonded))
    foundation = _foundation(law, material, True, material.name, material.range)
    return replaced(foundation, thickness=thickness, slab=slab)


def surface_foundation(material: object) -> Foundation | TabulatedFoundation:
    """What steady models of surfaces compute with: a foundation as it is, or the
    half-space of a bare material.

    They need the complex modulus only, so that a table of it will do. Raises
    `InputError` for anything else.
    """
    if isinstance(material, TabulatedFoundation):
        return material
    if type(material).__name__ == "Layer":
        raise not_flat(material)
    return (
        half_space(material)
        if isinstance(material, TabulatedModulus)
        else as_foundation(material)
    )


def not_flat(material: object) -> InputError:
    """What is said of a layer under a rough surface."""
    return InputError(
        argument="material",
        got=material,
        accepted="a half-space under a rough surface, whose waves are far shorter "
        "than a layer is thick",
        hint="give its rubber alone",
    )


def as_foundation(material: object) -> Foundation:
    """A foundation as it is, or the half-space of a bare material; raises `InputError`
    for a table of moduli.
    """
    needs_series("material", material, "smooth bodies, lines and histories in time")
    if isinstance(material, Foundation):
        return material
    if isinstance(material, Prony):
        return half_space(material)
    # solved by its own means where a verb knows it
    if type(material).__name__ == "Layer":
        raise InputError(
            argument="material",
            got=material,
            accepted="a half-space or independent springs here",
            hint="em.springs(material, thickness), bonded=False where incompressible, "
            "is for a contact much wider than the layer is thick, the rubber alone for "
            "one much narrower and under rough lines",
        )
    raise InputError(
        argument="material",
        got=material,
        accepted="a material (em.Prony, em.load_material(...)) or an em.Foundation",
    )


def _foundation(
    law: Relaxation,
    material: Prony | TabulatedModulus,
    per_area: bool,
    name: str,
    known: Range | None,
) -> Foundation:
    if not is_traced(law):
        law = Relaxation(
            *(
                np.asarray(x)
                for x in (law.equilibrium, law.moduli, law.times, law.viscosity)
            )
        )
    # its numbers were checked when the material was made
    foundation = object.__new__(Foundation)
    fill(
        foundation,
        **vars(law),
        shift=material.shift,
        vertical=material.vertical,
        softening=material.softening,
    )
    fill(
        foundation, thickness=None, slab=None, per_area=per_area, name=name, range=known
    )
    return foundation


def _half_space_of_table(
    material: TabulatedModulus, tangential: bool
) -> TabulatedFoundation:
    nu, shear = material.poisson, material.shear()
    factor = 4 / (2 - nu) if tangential else 2 / (1 - nu)
    return TabulatedFoundation(
        shear.omega,
        shear.storage_table * factor,
        shear.loss_table * factor,
        shear.shift,
        shear.vertical,
        shear.softening,
        shear.name,
        shear.range,
    )


def _material(name: str, material: object) -> Prony:
    needs_series(name, material, "a layer or two bodies in contact")
    if not isinstance(material, Prony):
        raise InputError(
            argument=name,
            got=material,
            accepted="an em.Prony, or one made by em.load_material(...)",
        )
    return material


@numpy_unless_traced
def normal_operator(material: Prony) -> Relaxation:
    """E*(t) of a half-space pressed normally [Pa].

    Constant Poisson's ratio: E* = 2G/(1-nu). Constant bulk modulus: E* =
    4G(3K+G)/(3K+4G) = G + [1/(3G) + 4/(9K)]^-1. Exact; 2n branches in the second case.
    Source: Radok 1957; Popov & Hess 2015, ch. 7.
    """
    shear = material.shear().law()
    bulk: Any = material.bulk  # None with a constant Poisson's ratio
    if material.poisson is not None:
        return scaled(shear, 2 / (1 - material.poisson))
    return parallel(shear, series(scaled(shear, 3.0), spring(9 * bulk / 4)))


@numpy_unless_traced
def tangential_operator(material: Prony) -> Relaxation:
    """G*(t) of a half-space sheared at its surface [Pa].

    Constant Poisson's ratio: G* = 4G/(2-nu). Constant bulk modulus: G* =
    8G(3K+G)/(3(3K+2G)) = (4/3) G + [3/(4G) + 1/(2K)]^-1. Exact. Source: as
    `normal_operator`.
    """
    shear = material.shear().law()
    bulk: Any = material.bulk  # None with a constant Poisson's ratio
    if material.poisson is not None:
        return scaled(shear, 4 / (2 - material.poisson))
    return parallel(
        scaled(shear, 4 / 3), series(scaled(shear, 4 / 3), spring(2 * bulk))
    )


@numpy_unless_traced
def layer_operator(material: Prony, bonded: bool) -> Relaxation:
    """Modulus of a thin layer on a rigid base [Pa]; divided by the thickness it is the
    layer's stiffness per area.

    Bonded: K + 4G/3 (no lateral strain). Frictionless base: 2G/(1-nu), which is
    E/(1-nu^2) (plane strain without lateral stress), the same operator as E*. Thin
    means: contact width much larger than the thickness. A bonded incompressible layer
    does not act as a row of springs (its pressure obeys Reynolds' equation) and raises
    `InputError`. Source: Johnson, Contact Mechanics (1985), section 5.8.
    """
    if not bonded:
        return normal_operator(material)
    shear = material.shear().law()
    bulk: Any = material.bulk  # None with a constant Poisson's ratio
    if material.poisson is None:
        law = scaled(shear, 4 / 3)
        return Relaxation(law.equilibrium + bulk, law.moduli, law.times, law.viscosity)
    if certain(lambda nu: nu >= 0.5, material.poisson):
        raise InputError(
            argument="poisson",
            got=float(material.poisson),
            accepted="below 0.5 for bonded springs",
            hint="A bonded incompressible layer does not act as a row of springs. "
            "Use em.layer(material, thickness), which holds for any thickness and "
            "any Poisson's ratio; a bulk modulus in its place would make the springs "
            "hundreds of times too stiff.",
        )
    return scaled(shear, 2 * (1 - material.poisson) / (1 - 2 * material.poisson))
