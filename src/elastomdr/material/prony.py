"""The viscoelastic solid: a Prony series for shear or tension, a constant Poisson's ratio or bulk modulus, a shift
law.
"""

from typing import Any, Literal

import equinox as eqx
import numpy as np
from jaxtyping import Float

from .._runtime import Array, as_float64, in_float64, is_traced, not_negative, positive, require, scalar
from ..errors import InputError
from .relaxation import AbstractRelaxation, KelvinChain, Relaxation, checked, scaled, to_kelvin, to_relaxation
from .shift import AbstractShift
from .validity import Range, as_range, with_range


class Prony(AbstractRelaxation):
    """Generalised Maxwell solid: M(t) = M_inf + sum_k M_k exp(-t/tau_k) + eta delta(t), M the shear or tensile modulus.

    Give either a constant Poisson's ratio (default 0.5, incompressible) or a constant bulk modulus. An equilibrium
    modulus of zero makes it a liquid. `relaxation`, `creep`, `storage`, `loss`, `loss_tangent` and `complex_modulus`
    speak of shear, whatever `kind` the moduli were given in. `range` says where the numbers hold, as a dict like the
    [range] of a material file: `em.friction` flags what lies beyond. Raises `InputError` for negative or NaN moduli,
    times that are not positive and ascending, a Poisson's ratio outside (-1, 0.5], or both `poisson` and `bulk`.
    """

    equilibrium: Float[Array, ""]  # M_inf, as given [Pa]
    moduli: Float[Array, " n"]  # M_k, as given [Pa]
    times: Float[Array, " n"]  # relaxation times tau_k, ascending [s]
    viscosity: Float[Array, ""]  # parallel dashpot, as given [Pa s]
    poisson: Any  # constant Poisson's ratio, a scalar; None where `bulk` is given
    bulk: Any  # constant bulk modulus, a scalar [Pa]; None where `poisson` is given
    shift: AbstractShift | None
    kind: Literal["shear", "tensile"] = eqx.field(static=True)
    name: str = eqx.field(static=True)
    citation: str = eqx.field(static=True)
    range: Range | None = eqx.field(static=True)  # where the numbers hold; None: not known

    def __init__(
        self,
        equilibrium: Any,
        moduli: Any,
        times: Any,
        *,
        kind: str = "shear",
        poisson: Any = None,
        bulk: Any = None,
        viscosity: Any = 0.0,
        shift: AbstractShift | None = None,
        name: str = "",
        citation: str = "",
        range: Any = None,
    ):
        law = checked(equilibrium, moduli, times, viscosity)
        self.equilibrium, self.moduli, self.times, self.viscosity = (
            law.equilibrium,
            law.moduli,
            law.times,
            law.viscosity,
        )
        if kind not in ("shear", "tensile"):
            raise InputError(f"kind must be 'shear' or 'tensile', got {kind!r}.")
        for argument, text in (("name", name), ("citation", citation)):
            if not isinstance(text, str):
                raise InputError(f"{argument} must be a text, got {text!r}.")
        if poisson is not None and bulk is not None:
            raise InputError(
                f"poisson and bulk exclude each other (one of them is constant), got poisson={poisson} and bulk={bulk}."
            )
        if shift is not None and not isinstance(shift, AbstractShift):
            raise InputError(f"shift must be a WLF, Arrhenius, VFT or ShiftTable, got {shift!r}.")
        self.poisson = self.bulk = None
        if bulk is not None:
            self.bulk = scalar("bulk", bulk)
            positive("bulk", self.bulk)
        else:
            self.poisson = scalar("poisson", 0.5 if poisson is None else poisson)
            require("poisson", self.poisson, "above -1 and at most 0.5", lambda nu: (nu > -1) & (nu <= 0.5))
        self.shift, self.kind, self.name, self.citation, self.range = shift, kind, name, citation, as_range(range)
        if kind == "tensile" and self.bulk is not None:
            if not is_traced(law.viscosity) and law.viscosity > 0:
                raise InputError(
                    "viscosity must be 0 for tensile moduli with a constant bulk modulus: "
                    f"Young's modulus cannot exceed 9 bulk, got {float(law.viscosity):g}."
                )
            if not is_traced(law, self.bulk) and law.instantaneous >= 9 * self.bulk:
                raise InputError(
                    "bulk must be more than a ninth of the glassy tensile modulus "
                    f"({float(law.instantaneous):g} Pa), got {float(self.bulk):g}."
                )

    @in_float64
    def law(self) -> Relaxation:
        """The shear relaxation function G(t)."""
        given = Relaxation(self.equilibrium, self.moduli, self.times, self.viscosity)
        if self.kind == "shear":
            return given
        if self.poisson is not None:
            return scaled(given, 1 / (2 * (1 + self.poisson)))
        # 1/E = 1/(3G) + 1/(9K): take the bulk part out of the creep function, then invert it.
        chain = to_kelvin(given)
        return to_relaxation(
            KelvinChain(
                3 * (chain.instantaneous - 1 / (9 * self.bulk)), 3 * chain.compliances, chain.times, 3 * chain.fluidity
            )
        )

    @in_float64
    def at(self, temperature: Any) -> "Prony":
        """The same material at a temperature [K]: its times multiplied by a_T. Raises without a shift law."""
        temperature = scalar("temperature", temperature)
        if self.shift is None:
            raise InputError(
                f"temperature was given ({temperature}), but the material {self.name or '(unnamed)'} has no shift law; "
                "give it one with shift=em.WLF(...), or leave the temperature out."
            )
        factor = self.shift.a(temperature)
        if not is_traced(factor):
            factor = np.asarray(factor)
        shifted = eqx.tree_at(
            lambda m: (m.times, m.viscosity, m.shift),
            self,
            (self.times * factor, self.viscosity * factor, None),
            is_leaf=lambda x: x is None,
        )
        return with_range(shifted, None if self.range is None else self.range.at(temperature, factor))

    def __repr__(self) -> str:
        label = f"{self.name!r}, " if self.name else ""
        if is_traced(self) or np.ndim(self.equilibrium) or np.ndim(self.moduli) != 1:
            what = "traced" if is_traced(self) else f"a batch of shape {np.shape(self.equilibrium)}"
            return f"Prony({label}{self.kind}, {np.shape(self.moduli)[-1]} branches, {what})"
        span = f", tau {self.times[0]:.3g}..{self.times[-1]:.3g} s" if self.moduli.size else ""
        glassy = float(self.equilibrium + np.sum(self.moduli))
        return (
            f"Prony({label}{self.kind} modulus {float(self.equilibrium):.4g} Pa relaxed, {glassy:.4g} Pa glassy, "
            f"{self.moduli.size} branches{span})"
        )


def KelvinVoigt(modulus: Any, viscosity: Any, **properties: Any) -> Prony:
    """A spring [Pa] and a dashpot [Pa s] in parallel; keyword arguments as for `Prony`."""
    not_negative("modulus", as_float64("modulus", modulus))
    return Prony(modulus, np.zeros(0), np.zeros(0), viscosity=viscosity, **properties)


def Maxwell(modulus: Any, time: Any, **properties: Any) -> Prony:
    """A spring [Pa] and a dashpot in series with relaxation time [s]: a liquid; keyword arguments as for `Prony`."""
    return Prony(0.0, *_one_branch(modulus, time), **properties)


def StandardSolid(equilibrium: Any, modulus: Any, time: Any, **properties: Any) -> Prony:
    """A spring [Pa] beside one Maxwell branch [Pa, s]; keyword arguments as for `Prony`."""
    return Prony(equilibrium, *_one_branch(modulus, time), **properties)


def _one_branch(modulus: Any, time: Any) -> tuple[Array, Array]:
    modulus, time = scalar("modulus", modulus), scalar("time", time)
    not_negative("modulus", modulus)
    positive("time", time)
    return modulus[None], time[None]
