"""The viscoelastic solid: a Prony series for shear or tension, a constant Poisson's
ratio or bulk modulus, a shift law.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypedDict, Unpack

import numpy as np

from ..checks import (
    Array,
    a_text,
    as_float64,
    certain,
    in_si,
    is_traced,
    not_negative,
    numpy_unless_traced,
    one_of,
    positive,
    scalar,
)
from ..errors import InputError
from ..trees import fill, replaced, static
from .relaxation import (
    AbstractRelaxation,
    KelvinChain,
    Relaxation,
    checked,
    poisson_ratio,
    scaled,
    series,
    spring,
    to_kelvin,
    to_relaxation,
)
from .shift import AbstractShift, AbstractVertical, check_laws, thermal_factors
from .softening import Softening, as_softening
from .validity import Range, RangeLike, as_range

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Kind, Number


class Properties(TypedDict, total=False):
    """The keyword arguments of `em.Prony` that are no moduli."""

    kind: Kind
    poisson: Number | None
    bulk: Number | None
    shift: AbstractShift | None
    vertical: AbstractVertical | None
    softening: Softening | None
    name: str
    citation: str
    range: RangeLike | None


class DashpotProperties(Properties, total=False):
    """With a parallel dashpot."""

    viscosity: Number


class Prony(AbstractRelaxation):
    """Generalised Maxwell solid: M(t) = M_inf + sum_k M_k exp(-t/tau_k) + eta delta(t),
    M the shear or tensile modulus.

    Give either a constant Poisson's ratio (default 0.5, incompressible) or a constant
    bulk modulus. An equilibrium modulus of zero makes it a liquid. All fields and
    methods speak of the `kind` of modulus that was given; `shear()` and `tensile()` are
    the same material in the other kind. `range` says where the numbers hold, as a dict
    like the [range] of a material file: `em.friction` flags what lies beyond.
    `softening` (`em.Softening`) has the factors on the moduli at larger strains. Raises
    `InputError` for negative or NaN moduli, times that are not positive, a Poisson's
    ratio outside (-1, 0.5], or both `poisson` and `bulk`. Branches may come in any
    order: they are sorted by their times, and those of one time are added.
    """

    equilibrium: Float[Array, ""]  # M_inf, as given [Pa]
    moduli: Float[Array, " n"]  # M_k, as given [Pa]
    times: Float[Array, " n"]  # relaxation times tau_k, ascending [s]
    viscosity: Float[Array, ""]  # parallel dashpot, as given [Pa s]
    # constant Poisson's ratio, a scalar; None where `bulk` is given
    poisson: Array | None
    # constant bulk modulus, a scalar [Pa]; None where `poisson` is given
    bulk: Array | None
    shift: AbstractShift | None
    vertical: AbstractVertical | None  # b_T, which multiplies all moduli
    softening: Softening | None  # factors on the moduli by strain; None: linear
    kind: Literal["shear", "tensile"] = static()
    name: str = static()
    citation: str = static()
    range: Range | None = static()  # where the numbers hold; None: not known

    def __init__(
        self,
        equilibrium: Number,
        moduli: ArrayLike,
        times: ArrayLike,
        *,
        kind: Kind = "shear",
        poisson: Number | None = None,
        bulk: Number | None = None,
        viscosity: Number = 0.0,
        shift: AbstractShift | None = None,
        vertical: AbstractVertical | None = None,
        softening: Softening | None = None,
        name: str = "",
        citation: str = "",
        range: RangeLike | None = None,
    ):
        law = checked(equilibrium, moduli, times, viscosity)
        one_of("kind", kind, "shear", "tensile")
        a_text("name", name)
        a_text("citation", citation)
        check_laws(shift, vertical)
        if poisson is not None and bulk is not None:
            raise InputError(
                argument="bulk",
                got=bulk,
                accepted="left out where poisson is given",
                hint="one of them is constant",
            )
        if bulk is not None:
            bulk = scalar("bulk", bulk)
            positive("bulk", bulk)
        else:
            poisson = poisson_ratio(0.5 if poisson is None else poisson)
        fill(
            self,
            **vars(law),
            poisson=poisson,
            bulk=bulk,
            shift=shift,
            vertical=vertical,
        )
        fill(self, softening=as_softening(softening))
        fill(self, kind=kind, name=name, citation=citation, range=as_range(range))
        if kind == "tensile" and bulk is not None:
            self._check_bulk(law, bulk)

    def _check_bulk(self, law: Relaxation, bulk: Array) -> None:
        """Raises `InputError` where Young's modulus would exceed 9 times the bulk
        modulus.
        """
        if certain(lambda eta: eta > 0, law.viscosity):
            raise InputError(
                argument="viscosity",
                got=float(law.viscosity),
                accepted="0 for tensile moduli with a constant bulk modulus",
                hint="Young's modulus cannot exceed 9 bulk",
            )
        if certain(lambda law, bulk: law.instantaneous >= 9 * bulk, law, bulk):
            raise InputError(
                argument="bulk",
                got=float(bulk),
                accepted="more than a ninth of the glassy tensile modulus, "
                f"{float(law.instantaneous):g} Pa",
            )

    def law(self) -> Relaxation:
        """The relaxation function of `kind`, as given."""
        return Relaxation(self.equilibrium, self.moduli, self.times, self.viscosity)

    def shear(self) -> "Prony":
        """The same material by its shear modulus G(t).

        Exact: G = E/(2 (1 + nu)) for a constant Poisson's ratio, and 1/(3G) = 1/E -
        1/(9K) for a constant bulk modulus, with as many branches.
        """
        return self if self.kind == "shear" else self._in_other_kind()

    def tensile(self) -> "Prony":
        """The same material by its tensile modulus E(t); with a constant bulk modulus a
        dashpot becomes a branch.
        """
        return self if self.kind == "tensile" else self._in_other_kind()

    @numpy_unless_traced
    def _in_other_kind(self) -> "Prony":
        given, tensile = self.law(), self.kind == "tensile"
        bulk: Any = self.bulk  # None with a constant Poisson's ratio
        if self.poisson is not None:
            ratio = 2 * (1 + self.poisson)
            law = scaled(given, 1 / ratio if tensile else ratio)
        elif tensile:  # take the bulk part out of the creep function, then invert it
            chain = to_kelvin(given)
            glassy = 3 * (chain.instantaneous - 1 / (9 * bulk))
            law = to_relaxation(
                KelvinChain(
                    glassy, 3 * chain.compliances, chain.times, 3 * chain.fluidity
                )
            )
        else:
            law = series(scaled(given, 3.0), spring(9 * bulk))
        return replaced(
            self,
            equilibrium=law.equilibrium,
            moduli=law.moduli,
            times=law.times,
            viscosity=law.viscosity,
            kind="shear" if tensile else "tensile",
        )

    @numpy_unless_traced
    def at(self, temperature: Number) -> "Prony":
        """The same material at a temperature [K]: its times multiplied by a_T, its
        moduli by b_T, the bulk modulus too.

        Raises without a shift law.
        """
        temperature = scalar("temperature", temperature)
        a, b = thermal_factors(self, temperature)
        known = None if self.range is None else self.range.at(temperature, a)
        law = scaled(self.law(), b)
        return replaced(
            self,
            equilibrium=law.equilibrium,
            moduli=law.moduli,
            times=self.times * a,
            viscosity=law.viscosity * a,
            bulk=None if self.bulk is None else self.bulk * b,
            shift=None,
            vertical=None,
            range=known,
        )

    def draws(self, n: int, seed: int = 0) -> "list[Prony]":
        """Materials as far from this one as it is from its data, for `em.friction` and
        `em.sweep`.

        Their moduli deviate by the misfit that the range records ([misfit] in a
        material file), over about a decade of frequency alike. Shift factors are as
        they are: `em.fit.material(...).draws` knows their uncertainty too.

        Args:
            n: how many, 2 or more.
            seed: of the random numbers.

        Raises:
            InputError: for a material without a record of its misfit, and for numbers
                that are not whole.
        """
        from .validity import drawn_from_misfit

        return drawn_from_misfit(self, n, seed)

    def __repr__(self) -> str:
        label = f"{self.name!r}, " if self.name else ""
        traced, shape = is_traced(self), np.shape(self.equilibrium)
        if traced or shape or np.ndim(self.moduli) != 1:
            return (
                f"Prony({label}{self.kind}, {np.shape(self.moduli)[-1]} branches, "
                f"{'traced' if traced else f'a batch of shape {shape}'})"
            )
        span = (
            f", tau {self.times[0]:.3g}..{self.times[-1]:.3g} s"
            if self.moduli.size
            else ""
        )
        glassy = float(self.equilibrium + np.sum(self.moduli))
        dashpot = (
            f", viscosity {float(self.viscosity):.4g} Pa s"
            if float(self.viscosity)
            else ""
        )
        return (
            f"Prony({label}{self.kind} modulus {float(self.equilibrium):.4g} Pa "
            f"relaxed, {glassy:.4g} Pa glassy, {self.moduli.size} "
            f"branches{span}{dashpot})"
        )


@in_si
def KelvinVoigt(
    modulus: Number, viscosity: Number, **properties: Unpack[Properties]
) -> Prony:
    """A spring [Pa] and a dashpot [Pa s] in parallel; keyword arguments as for
    `Prony`.
    """
    not_negative("modulus", as_float64("modulus", modulus))
    return Prony(modulus, np.zeros(0), np.zeros(0), viscosity=viscosity, **properties)


@in_si
def Maxwell(
    modulus: Number, time: Number, **properties: Unpack[DashpotProperties]
) -> Prony:
    """A spring [Pa] and a dashpot in series with relaxation time [s]: a liquid; keyword
    arguments as for `Prony`.
    """
    return Prony(0.0, *_one_branch(modulus, time), **properties)


@in_si
def StandardSolid(
    equilibrium: Number,
    modulus: Number,
    time: Number,
    **properties: Unpack[DashpotProperties],
) -> Prony:
    """A spring [Pa] beside one Maxwell branch [Pa, s]; keyword arguments as for
    `Prony`.
    """
    return Prony(equilibrium, *_one_branch(modulus, time), **properties)


def _one_branch(modulus: Number, time: Number) -> tuple[Array, Array]:
    modulus, time = scalar("modulus", modulus), scalar("time", time)
    not_negative("modulus", modulus)
    positive("time", time)
    return modulus[None], time[None]
