"""The foundation: what each element of the line does, and how a half-space or a thin layer becomes one."""

from typing import Any

import equinox as eqx
import numpy as np
from jaxtyping import Float

from .._runtime import Array, as_float64, in_float64, is_traced, positive, scalar
from ..errors import InputError
from ..mapping.radok import layer_operator, normal_operator, tangential_operator
from ..material.prony import Prony
from ..material.relaxation import AbstractRelaxation, Relaxation, checked, scaled, series
from ..material.shift import AbstractShift
from ..material.validity import Range, as_range, shared


class Foundation(AbstractRelaxation):
    """Independent elements, each with E(t) = E_inf + sum_k E_k exp(-t/tau_k) + eta delta(t).

    For a half-space the numbers are E* [Pa]: an element of width dx carries E* u dx. For a layer they are stiffness per
    area [Pa/m]. `per_area` says which; None, as when the numbers are given directly, leaves it to the shape: a cylinder
    takes them per area, every other shape as E*. Raises `InputError` as `Prony` does.
    """

    equilibrium: Float[Array, ""]  # E_inf [Pa, or Pa/m]
    moduli: Float[Array, " n"]  # E_k [Pa, or Pa/m]
    times: Float[Array, " n"]  # tau_k, ascending [s]
    viscosity: Float[Array, ""]  # eta [Pa s, or Pa s/m]
    shift: AbstractShift | None
    per_area: bool | None = eqx.field(static=True)
    name: str = eqx.field(static=True)
    range: Range | None = eqx.field(static=True)  # where the numbers hold; None: not known

    def __init__(
        self,
        equilibrium: Any,
        moduli: Any,
        times: Any,
        viscosity: Any = 0.0,
        *,
        shift: AbstractShift | None = None,
        per_area: bool | None = None,
        name: str = "",
        range: Any = None,
    ):
        law = checked(equilibrium, moduli, times, viscosity)
        self.equilibrium, self.moduli, self.times, self.viscosity = (
            law.equilibrium,
            law.moduli,
            law.times,
            law.viscosity,
        )
        self.shift, self.per_area, self.name, self.range = shift, per_area, name, as_range(range)

    @classmethod
    def kelvin(cls, stiffness: Any, viscosity: Any) -> "Foundation":
        """Kelvin elements: a spring and a dashpot in parallel."""
        return cls(stiffness, np.zeros(0), np.zeros(0), viscosity)

    @classmethod
    def maxwell(cls, stiffness: Any, time: Any) -> "Foundation":
        """Maxwell elements: a spring and a dashpot in series."""
        return cls(0.0, as_float64("stiffness", stiffness)[None], as_float64("time", time)[None])

    def __repr__(self) -> str:
        unit = "Pa/m" if self.per_area else "Pa" if self.per_area is not None else "Pa or Pa/m"
        label = f"{self.name!r}, " if self.name else ""
        if is_traced(self) or np.ndim(self.equilibrium) or np.ndim(self.moduli) != 1:
            return f"Foundation({label}{np.shape(self.moduli)[-1]} branches, traced or a batch)"
        glassy = float(self.equilibrium + np.sum(self.moduli))
        span = f", tau {self.times[0]:.3g}..{self.times[-1]:.3g} s" if self.moduli.size else ""
        dashpot = f", viscosity {float(self.viscosity):.4g} {unit} s" if float(self.viscosity) else ""
        return (
            f"Foundation({label}{float(self.equilibrium):.4g} {unit} relaxed, {glassy:.4g} {unit} glassy, "
            f"{self.moduli.size} branches{span}{dashpot})"
        )

    def law(self) -> Relaxation:
        return Relaxation(self.equilibrium, self.moduli, self.times, self.viscosity)


@in_float64
def half_space(material: Prony, other: Prony | None = None, *, tangential: bool = False) -> Foundation:
    """The foundation of a half-space by Radok's equations, exact; with `other`, of two half-spaces in contact.

    Two bodies carry the same pressure: their creep functions add, so that two viscoelastic ones give n_1 + n_2
    branches (twice that for constant bulk moduli). `tangential` gives G* in place of E*. Source: Radok 1957;
    Popov & Hess 2015, ch. 7. Raises `InputError` for two materials with different shift laws, unless they are already
    at their temperature (`material.at(T)`).
    """
    operator = tangential_operator if tangential else normal_operator
    law, shift, name = operator(_material("material", material)), material.shift, material.name
    known = material.range
    if other is not None:
        law = series(law, operator(_material("other", other)))
        if not same_shift(material.shift, other.shift):
            raise InputError(
                "other must have the same shift law as material, got "
                f"{other.shift} and {material.shift}; bring both to their temperature first, with material.at(T)."
            )
        name, known = f"{material.name or 'material'} on {other.name or 'material'}", shared(known, other.range)
    return _foundation(law, shift, False, name, known)


@in_float64
def layer(material: Prony, thickness: Any, *, bonded: bool = True, tangential: bool = False) -> Foundation:
    """The foundation of a thin layer on a rigid base, stiffness per area [Pa/m]; `thickness` in m.

    Holds where the contact is much wider than the layer is thick. `tangential` gives that of simple shear, G(t) over
    the thickness, as of the tread in the brush model of a tyre. Raises `InputError` for a bonded incompressible
    layer, which does not act as a row of springs, and for one that is sheared without being bonded.
    Source: Johnson 1985, section 5.8.
    """
    thickness = scalar("thickness", thickness)
    positive("thickness", thickness)
    if tangential and not bonded:
        raise InputError("bonded must be True with tangential: a layer that slips on its base is not sheared.")
    own = _material("material", material)
    law = scaled(own.law() if tangential else layer_operator(own, bonded), 1 / thickness)
    return _foundation(law, material.shift, True, material.name, material.range)


def as_foundation(material: Any) -> Foundation:
    """A foundation as it is, or the half-space of a bare material."""
    if isinstance(material, Foundation):
        return material
    if isinstance(material, Prony):
        return half_space(material)
    raise InputError(
        f"material must be a material (em.Prony, em.load_material(...)) or an em.Foundation, got {material!r}."
    )


def _foundation(
    law: Relaxation, shift: AbstractShift | None, per_area: bool, name: str, known: Range | None
) -> Foundation:
    if not is_traced(law):
        law = Relaxation(*(np.asarray(x) for x in (law.equilibrium, law.moduli, law.times, law.viscosity)))
    blank = Foundation(1.0, np.zeros(0), np.zeros(0), shift=shift, per_area=per_area, name=name, range=known)
    return eqx.tree_at(
        lambda f: (f.equilibrium, f.moduli, f.times, f.viscosity),
        blank,
        (law.equilibrium, law.moduli, law.times, law.viscosity),
    )


def _material(name: str, material: Any) -> Prony:
    if not isinstance(material, Prony):
        raise InputError(f"{name} must be an em.Prony, or one made by em.load_material(...), got {material!r}.")
    return material


def same_shift(first: AbstractShift | None, second: AbstractShift | None) -> bool:
    """Whether two shift laws are one; under a transformation of JAX as far as can be seen."""
    if first is None or second is None:
        return first is second
    if is_traced(first, second):
        return first is second
    return bool(eqx.tree_equal(first, second))
