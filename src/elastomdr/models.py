"""Models: what a body or a surface is computed with, as objects that carry their own
options and answer for themselves.

A verb checks its arguments, asks the model and hands on. The numbers of a model stand
in its room, which its methods import where they are called: this file is ground.
"""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, NoReturn

from .checks import is_traced, is_whole, whole_number
from .errors import InputError, closest
from .units.arguments import constructor_in_si

if TYPE_CHECKING:
    from ._types import ArrayLike, Number
    from .arrays import Array
    from .call.types import Surface
    from .element.law import Foundation, TabulatedFoundation
    from .results.curve import FrictionCurve
    from .rough.adhesion import AdhesiveShear
    from .rough.local_modulus import Local
    from .rough.multiscale import Waves
    from .rough.periodic_plan import RoughPlan
    from .rough.problem import RoughCall
    from .rough.psd_integrals import Nodes, Tables
    from .rough.surface import SurfacePlan
    from .smooth.problem import SmoothCall
    from .surface.spectrum import AbstractSpectrum

_OF_LEAKS = (
    "em.Multiscale(), em.CriticalConstriction(), em.EffectiveMedium() or "
    "em.HalfSpace() for a leak"
)
_MOST_LINES = 1000  # of an ensemble
_CELLS = 64  # along each side of the grid of a smooth body, by default


class Model:
    """A model of the contact; `model=` takes one of its kinds, or the name of one with
    its default options.
    """

    label: ClassVar[str]
    # on a smooth body: whether it is solved on the MDR line, whether averaged over the
    # directions of sliding, and then whether corrected for asymmetric contacts
    on_line: ClassVar[bool] = False
    over_directions: ClassVar[bool] = False
    corrected: bool = False

    def smooth_friction(
        self, call: SmoothCall, adhesion: AdhesiveShear | None
    ) -> FrictionCurve:
        """`em.friction` of a smooth body with a model that is not solved on a line."""
        self._refuse("em.Averaged(), em.Line() or em.HalfSpace() for a smooth body")

    def smooth_plan(self) -> str:
        """`em.plan` of a smooth body with a model that is not solved on a line."""
        self._refuse("em.Averaged(), em.Line() or em.HalfSpace() for a smooth body")

    def check_adhesion(self, adhesion: AdhesiveShear | None) -> None:
        """Raises `InputError` for adhesion where a rough surface has no known area."""

    def for_changes(self, surface: Surface, finer: float) -> Model:
        """The model for many surfaces close to this one, with the same samples on each;
        `finer` is by how much their cutoffs grow.
        """
        return self

    def doubt(self, surface: Surface) -> str | None:
        """What the model misses on a surface under a pressure, for a warning; None
        where that is little.
        """
        return None

    def rough_friction(self, call: RoughCall) -> FrictionCurve:
        """`em.friction` of a rough line or surface."""
        self._refuse("one of friction")

    def rough_plan(self, call: RoughCall) -> RoughPlan | SurfacePlan:
        """`em.plan` of a rough line or surface."""
        self._refuse("one of friction")

    def leak(
        self,
        surface: AbstractSpectrum,
        relative_pressure: Array,
        direction: float | None = None,
    ) -> GapFlow:
        """Gaps of a surface and the flow through them, for `em.leak`;
        `relative_pressure` is the pressure over E*, shape (rows, points), `direction`
        that of the flow to a lay [rad], if it is known.
        """
        self._refuse(_OF_LEAKS)

    # of a leak: pressures along a seal by which its model is asked, 2^n + 1
    leak_nodes: ClassVar[int] = 17
    # whether a leak is computed in its direction to a lay
    leak_turns: ClassVar[bool] = False

    def closes_at(self) -> float:
        """The real contact area over nominal area from which on nothing flows."""
        self._refuse(_OF_LEAKS)

    def _refuse(self, accepted: str) -> NoReturn:
        raise InputError(f"model must be {accepted}, got {self!r}.")


class GapFlow(NamedTuple):
    """What a model finds at each pressure of a leak, arrays of shape (rows, points)."""

    flow: Array  # w = 12 viscosity times flow per width and pressure gradient [m^3]
    gap: Array  # mean gap [m]
    critical_gap: Array  # widest that a way must pass [m], of the first row, (points,)
    area: Array  # real contact area over nominal area
    error: Array  # relative numerical error of w
    # w is within a factor of 1 + this of three dimensions; None for those themselves
    model_error: Array | None
    good: Array  # whether the point has an answer
    said: str  # the model in a few words, for the result
    work: str = "closed integrals over the spectrum"  # what was computed
    # dw/dl [m^2] by the mean free path l, each gap by itself; None: by an estimate
    slip: Array | None = None


class SurfaceFriction(NamedTuple):
    """What a `SurfaceModel` finds at each point, arrays of shape (points,)."""

    mu: Array
    area: Array  # real contact area over nominal area
    error: Array  # numerical error of mu
    good: Array  # whether the point has an answer
    area_error: Array  # numerical error of the area
    said: str = ""  # about the solution, for the result


class SurfaceModel(Model, ABC):
    """A model of a surface under a pressure: derive a class from it to add another.

    It needs `label`, `words` and `solve`; everything else has a default. A test
    (`tests/house/test_models.py`) shows one that stands outside of this package.
    """

    # whether `solve` follows the softening of the material from scale to scale; a model
    # that does not is linear, and its results say so
    softens: ClassVar[bool] = False
    # whether each length scale has a temperature of its own under `em.Heat`, for which
    # the model needs `waves` and `contact`; otherwise all scales have one
    heats_by_scale: ClassVar[bool] = False
    # whether `solve` follows `local.directed`, the direction of sliding on a surface
    # with a lay; others refuse a direction
    takes_direction: ClassVar[bool] = False
    # whether without one `solve` is the mean over directions of sliding, not that of
    # the mean spectrum
    samples_directions: ClassVar[bool] = False

    def on_map(self, surface: AbstractSpectrum) -> bool:
        """Whether the body slides over the heights that were measured, not over what
        their spectrum stands for.
        """
        return False

    @abstractmethod
    def words(self) -> str:
        """The model in a few words, for results."""

    def work(self, surface: AbstractSpectrum) -> tuple[str, str]:
        """What a solution of the surface computes and what it leaves out, for plans."""
        return self.words(), "nothing"

    @abstractmethod
    def solve(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        pressure: Array,
        local: Local,
        rtol: float,
        progress: Callable[[int, int], None] | None,
    ) -> SurfaceFriction:
        """Friction and real contact at many points.

        Args:
            foundation: the rubber; `foundation.complex_modulus(omega)` is E* [Pa] at
                omega [rad/s].
            surface: an `AbstractSpectrum`.
            velocity: reduced velocity v a_T [m/s], shape (points,).
            pressure: nominal pressure [Pa] at the reference temperature, (points,).
            local: how moduli differ from scale to scale
                (`elastomdr.rough.local_modulus.Local`).
            rtol: relative error of mu to be met.
            progress: `progress(done, total)`, or None.
        """

    def bound(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
        of_area: bool = False,
    ) -> Array | None:
        """Bound on the relative distance of mu, or of the area, from three dimensions,
        shape (points,); NaN, the default, where none is established, None for a model
        that is the three-dimensional one.
        """
        return float("nan") * area

    def why_wide(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
    ) -> list[str]:
        """Why `bound` is wide at points, and what would make it smaller, for results."""
        return []

    def waves(
        self,
        modulus: Callable[[Array], Array],
        nodes: Nodes,
        velocity: Array,
        pressure: Array,
        table: Tables | None,
        local: Local,
    ) -> Waves:
        """Friction wave by wave, `elastomdr.rough.multiscale.Waves`."""
        self._refuse("one with `waves` and `contact`, as `heats_by_scale` promises")

    def contact(self, stress_variance: Array, stiffer: Array) -> Array:
        """The share of contact from R, the integral of `waves(...).rate`, and from
        `waves(...).stiffer`.
        """
        self._refuse("one with `waves` and `contact`, as `heats_by_scale` promises")

    def rough_friction(self, call: RoughCall) -> FrictionCurve:
        from .rough.surface import surface_friction

        return surface_friction(call, self)

    def rough_plan(self, call: RoughCall) -> RoughPlan | SurfacePlan:
        from .rough.surface import surface_plan

        return surface_plan(call, self)


class _ClosedIntegrals(SurfaceModel):
    """What Multiscale and Persson's theory share: integrals over the waves of a
    surface, each with moduli of its own.
    """

    softens: ClassVar[bool] = True
    heats_by_scale: ClassVar[bool] = True
    takes_direction: ClassVar[bool] = True

    @abstractmethod
    def energy_factor(self) -> tuple[float, bool]:
        """gamma of the factor S, and whether S is in the integral for the contact
        area.
        """

    def bound_terms(self, of_area: bool) -> tuple[float, float, float] | None:
        """a, b and c of the bound sqrt(1 - A) (a - b ln A) (1 + c m^2) on
        |ln(mu/mu_3D)|; None where it is not known.
        """
        from .rough.multiscale import bound_terms

        return bound_terms(self.label, of_area)

    def work(self, surface: AbstractSpectrum) -> tuple[str, str]:
        from .rough.multiscale import WORK

        return WORK

    def solve(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        pressure: Array,
        local: Local,
        rtol: float,
        progress: Callable[[int, int], None] | None,
    ) -> SurfaceFriction:
        from .rough.multiscale import friction

        return friction(
            self, foundation, surface, velocity, pressure, local, rtol, progress
        )

    def bound(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
        of_area: bool = False,
    ) -> Array | None:
        from .rough.multiscale import bound, felt

        terms = self.bound_terms(of_area)
        return bound(terms, area, felt(foundation, surface, velocity))

    def why_wide(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
    ) -> list[str]:
        from .rough.multiscale import why_wide

        if self.bound_terms(False) is None:
            return []
        return why_wide(foundation, surface, velocity)

    def contact(self, stress_variance: Array, stiffer: Array) -> Array:
        from .rough.multiscale import contact

        return contact(stress_variance, *self.energy_factor(), stiffer)


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Averaged(Model):
    """The MDR line averaged over directions: the default for a smooth body on a
    half-space.

    Args:
        corrected: apply the empirical correction for asymmetric contacts
            (`elastomdr.surface.direction.asymmetry`).

    Exact to first order in the loss; `model_error` bounds the rest. Source:
    `docs/theory.md`.
    """

    corrected: bool = True
    label: ClassVar[str] = "averaged"
    on_line: ClassVar[bool] = True
    over_directions: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _flag("corrected", self.corrected)


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Line(Model):
    """The line of the Method of Dimensionality Reduction, as in the textbook.

    Args:
        average: average over the directions of sliding (rough lines and surfaces).
        equivalent_length: length L [m] that turns the pressure p on a surface into the
            load p L of a line, or "full contact" for 2 m_2/m_3 of the spectrum's
            moments; by default the longest wave, 2 pi/q_low.
        seeds: number of lines with random phases that stand for a surface, or a list of
            their seeds.
        samples: samples of a line, 64 or more; by default eight per shortest wave, and
            more where that is too few.
        periods: length of a line in longest waves.

    Exact for layers of independent elements and for rough lines. It overstates the
    friction of a smooth body on a half-space by up to a factor of 2. On a surface,
    `error` is the numerical error plus twice the standard error over the lines, and NaN
    for a single line, whose scatter is not known.

    A surface under a pressure: the line does not see how waves of different length
    carry each other, and its friction falls with the cutoff ratio r = q_high/q_low
    without end. `model_error` is mu (F - 1), with F = 2.9 r^0.69 by default and with a
    given length, F = 1.45 r^0.16 by the rule of full contact, twice that with
    `average`: an upper envelope of three-dimensional over line friction at r from 4 to
    64, continued up to r = 1e5 and NaN beyond (`elastomdr.rough.line_problem`). Under a
    load per length or a depth it is NaN. Above r = 10 there is one `em.ModelWarning`;
    `em.Multiscale()` is the model for that.

    Source: Popov & Hess 2015, chapters 7 and 10; the bound is empirical.
    """

    average: bool = False
    equivalent_length: Number | Literal["full contact"] | None = None
    seeds: int | Sequence[int] = 1
    samples: int | None = None
    periods: int = 4
    label: ClassVar[str] = "line"
    on_line: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _flag("average", self.average)
        seeds_of(self.seeds)

    def rough_friction(self, call: RoughCall) -> FrictionCurve:
        from .rough.line import rough_friction

        self._refuse_direction(call.asked.direction)
        return rough_friction(call, self)

    def rough_plan(self, call: RoughCall) -> RoughPlan | SurfacePlan:
        from .rough.line import rough_plan

        self._refuse_direction(call.asked.direction)
        return rough_plan(call, self)

    def _refuse_direction(self, direction: ArrayLike | None) -> None:
        if direction is not None:
            raise InputError(
                "direction needs em.Multiscale(), em.Persson() or em.HalfSpace() and a "
                f"surface under a pressure, got {self!r}."
            )

    def for_changes(self, surface: Surface, finer: float) -> Line:
        from .surface.spectrum import PER_WAVE, line_count

        if self.samples is not None:
            return self
        spectrum: Any = surface
        samples = line_count(spectrum, self.periods, PER_WAVE * finer)
        return dataclasses.replace(self, samples=samples)

    def doubt(self, surface: Surface) -> str | None:
        from .rough.line_problem import missed

        return missed(surface, self)

    def check_adhesion(self, adhesion: AdhesiveShear | None) -> None:
        from .rough.adhesion import no_area

        model_in_words = f"a {self.label} on a rough line or surface"
        no_area(adhesion, model_in_words, "use em.Multiscale() under a pressure")


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Multiscale(_ClosedIntegrals):
    """Friction of a randomly rough surface in closed integrals: the default for a
    surface under a pressure.

    It has no options and no random numbers. `model_error` bounds its distance from a
    three-dimensional solution.
    """

    label: ClassVar[str] = "multiscale"

    def words(self) -> str:
        return "Multiscale (Persson's contact shares, a sum rule for the pressure's variance)"

    def energy_factor(self) -> tuple[float, bool]:
        from .rough.multiscale import FORM

        return FORM.gamma, True

    def waves(
        self,
        modulus: Callable[[Array], Array],
        nodes: Nodes,
        velocity: Array,
        pressure: Array,
        table: Tables | None,
        local: Local,
    ) -> Waves:
        from .rough.multiscale import waves_of_multiscale

        return waves_of_multiscale(modulus, nodes, velocity, pressure, table, local)

    def leak(
        self,
        surface: AbstractSpectrum,
        relative_pressure: Array,
        direction: float | None = None,
    ) -> GapFlow:
        from .seal.leak_form import leak

        return leak(surface, relative_pressure, direction)

    def closes_at(self) -> float:
        from .seal.leak_form import FORM

        return FORM.closes


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Persson(_ClosedIntegrals):
    """Persson's theory of rubber friction.

    Args:
        gamma: of the factor S = gamma + (1 - gamma) P^2 that reduces the stored energy,
            0 to 1; 1 for S = 1.
        stored: S also inside the integral for the contact area, as in later work.

    Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; Scaraggi and Persson, J.
    Phys.: Condens. Matter 27 (2015) 105102.
    """

    gamma: float = 0.5
    stored: bool = True
    label: ClassVar[str] = "persson"

    def __post_init__(self) -> None:
        _flag("stored", self.stored)
        if (
            isinstance(self.gamma, bool)
            or not isinstance(self.gamma, (int, float))
            or not 0 <= self.gamma <= 1
        ):
            raise InputError(f"gamma must be a number from 0 to 1, got {self.gamma!r}.")

    def words(self) -> str:
        where = "in mu and in G" if self.stored else "in mu"
        return f"Persson's theory, S with gamma = {self.gamma:g} {where}"

    def energy_factor(self) -> tuple[float, bool]:
        return self.gamma, self.stored

    def bound_terms(self, of_area: bool) -> tuple[float, float, float] | None:
        if self.energy_factor() != Persson().energy_factor():
            return None
        return super().bound_terms(of_area)

    def waves(
        self,
        modulus: Callable[[Array], Array],
        nodes: Nodes,
        velocity: Array,
        pressure: Array,
        table: Tables | None,
        local: Local,
    ) -> Waves:
        from .rough.multiscale import waves_of_persson

        return waves_of_persson(
            modulus, nodes, velocity, pressure, self.energy_factor(), table, local
        )


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class HalfSpace(SurfaceModel):
    """The three-dimensional half-space on a grid of cells, without reduction: for
    smooth bodies and for surfaces.

    Args:
        cells: cells along each side of the grid; by default enough for the body, or
            four per shortest wave.
        seeds: number of random maps that stand for a surface, or a list of their seeds.
        periods: side of a map in longest waves of the surface; by default as many as
            fit on the grid.

    A surface that `em.read_surface` read from one map is that map itself, its edges
    made to meet, unless `seeds` or `periods` ask for random maps of its spectrum. Of
    these `model_error` is what skewness and lay of the surface may change, and their
    sampling errors; of all others there is none.
    """

    cells: int | None = None
    seeds: int | Sequence[int] = 1
    periods: int | None = None
    label: ClassVar[str] = "half-space"
    takes_direction: ClassVar[bool] = True
    samples_directions: ClassVar[bool] = True

    def __post_init__(self) -> None:
        seeds_of(self.seeds)
        if self.cells is not None:
            whole_number("cells", self.cells, 16)
        if self.periods is not None:
            whole_number("periods", self.periods, 1)

    def smooth_friction(
        self, call: SmoothCall, adhesion: AdhesiveShear | None
    ) -> FrictionCurve:
        from .reference.half_space import friction_on_cells

        return friction_on_cells(call, adhesion, self.cells or _CELLS)

    def smooth_plan(self) -> str:
        from .reference.half_space import grid_words

        return grid_words(self.cells or _CELLS)

    def words(self) -> str:
        return "half-space in three dimensions, maps of cells (no reduction)"

    def on_map(self, surface: AbstractSpectrum) -> bool:
        random = self.periods is not None or self.seeds != 1
        return not random and getattr(surface, "map", None) is not None

    def work(self, surface: AbstractSpectrum) -> tuple[str, str]:
        from .rough import on_maps
        from .rough.random_maps import work

        if self.on_map(surface):
            return on_maps.work(surface, self.cells)
        return work(surface, self.cells, self.periods, len(seeds_of(self.seeds)))

    def solve(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        pressure: Array,
        local: Local,
        rtol: float,
        progress: Callable[[int, int], None] | None,
    ) -> SurfaceFriction:
        import numpy as np

        from .rough.on_maps import friction

        if is_traced(surface, velocity, pressure, foundation):
            raise InputError(
                "model must be em.Multiscale() or em.Persson() under jit, grad and "
                "vmap."
            )
        return friction(
            self,
            foundation.complex_modulus,
            surface,
            np.asarray(velocity),
            np.asarray(pressure),
            local.directed,
            seeds_of(self.seeds),
            rtol,
            progress,
        )

    def bound(
        self,
        foundation: Foundation | TabulatedFoundation,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
        of_area: bool = False,
    ) -> Array | None:
        # random maps have the spectrum of a measured surface and not its skewness; what
        # that and a lay change is added for all models alike
        others = ("skewness", "skewness_error", "lay")
        differs = any(getattr(surface, name, None) for name in others)
        return 0.0 * area if differs and not self.on_map(surface) else None

    def leak(
        self,
        surface: AbstractSpectrum,
        relative_pressure: Array,
        direction: float | None = None,
    ) -> GapFlow:
        from .seal.gap_maps import leak

        maps = (self.cells, self.periods, seeds_of(self.seeds))
        return leak(*maps, surface, relative_pressure, direction)

    leak_nodes: ClassVar[int] = 5  # each is a contact in three dimensions
    leak_turns: ClassVar[bool] = True

    def closes_at(self) -> float:
        from .seal.gap_maps import SHUT

        return SHUT


KINDS: dict[str, type[Model]] = {
    kind.label: kind
    for kind in (
        Averaged,
        Line,
        Multiscale,
        Persson,
        HalfSpace,
    )
}


def as_model(model: Any, kinds: dict[str, type[Model]] = KINDS) -> Model | None:
    """A model from an object or the name of one of `kinds`; None stays None, for the
    default of the shape. Raises `InputError`.
    """
    if model is None or isinstance(model, Model):
        return model
    if isinstance(model, str) and model in kinds:
        return kinds[model]()
    listed = ", ".join(
        f"em.{kind.__name__}() or {name!r}" for name, kind in kinds.items()
    )
    hint = closest(model, kinds) if isinstance(model, str) else ""
    raise InputError(f"model must be {listed}; got {model!r}.{hint}")


def seeds_of(seeds: Any) -> tuple[int, ...]:
    """The seeds of an ensemble: that many from 0 on, or those given. Raises
    `InputError`.
    """
    if (
        isinstance(seeds, int)
        and not isinstance(seeds, bool)
        and 1 <= seeds <= _MOST_LINES
    ):
        return tuple(range(seeds))
    listed: Any = (
        seeds
        if hasattr(seeds, "__iter__") and not isinstance(seeds, str | bytes)
        else ()
    )
    each = tuple(listed)
    whole = all(is_whole(seed) and seed >= 0 for seed in each)
    if not each or not whole or len(set(each)) != len(each) or len(each) > _MOST_LINES:
        raise InputError(
            f"seeds must be a whole number from 1 to {_MOST_LINES}, or the seeds "
            f"themselves, different whole numbers from 0 on, got {seeds!r}."
        )
    return tuple(int(s) for s in each)


def _flag(name: str, value: Any) -> None:
    if not isinstance(value, bool):
        raise InputError(f"{name} must be True or False, got {value!r}.")
