"""The road models of the package: closed integrals over the waves of a surface, and maps
in three dimensions.
"""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from ..checks import (
    untraced,
    whole_number,
)
from ..errors import InputError
from ..models import seeds_of
from ..surface.height_map import tops_of
from ..surface.lay import lay_of
from ..units.arguments import constructor_in_si
from . import multiscale
from .road_model import (
    MapsOf,
    RoadProblem,
    SurfaceFriction,
    SurfaceModel,
    WaveByWave,
    WaveProblem,
    Waves,
)

if TYPE_CHECKING:
    from ..arrays import Array
    from ..call.types import SteadyBody
    from ..surface.spectrum import AbstractSpectrum


class _ClosedIntegrals(SurfaceModel, WaveByWave):
    """What Multiscale and Persson's theory share: integrals over the waves of a
    surface, each with moduli of its own.
    """

    softens: ClassVar[bool] = True
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
        return multiscale.bound_terms(self.label, of_area)

    def work(self, surface: AbstractSpectrum) -> tuple[str, str]:
        return multiscale.WORK

    def solve(self, problem: RoadProblem) -> SurfaceFriction:
        return multiscale.friction(self, problem)

    def bound(
        self,
        foundation: SteadyBody,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
        of_area: bool = False,
    ) -> Array | None:
        terms = self.bound_terms(of_area)
        felt = multiscale.felt(foundation, surface, velocity)
        return multiscale.bound(terms, area, felt)

    def why_wide(
        self,
        foundation: SteadyBody,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
    ) -> list[str]:
        if self.bound_terms(False) is None:
            return []
        return multiscale.why_wide(foundation, surface, velocity)

    def by_wave(self) -> WaveByWave:
        return self

    def contact(self, stress_variance: Array, stiffer: Array) -> Array:
        return multiscale.contact(stress_variance, *self.energy_factor(), stiffer)


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class Multiscale(_ClosedIntegrals):
    """Friction of a randomly rough surface in closed integrals: the default for a
    surface under a pressure.

    It has no options and no random numbers. `model_error` bounds its distance from a
    three-dimensional solution. Of a surface that `em.read_surface` read from heights it
    takes the slopes of their tops; `em.Spectrum(road.q, road.c, convention="2d")` is the
    one with Gaussian heights.
    """

    follows_tops: ClassVar[bool] = True
    label: ClassVar[str] = "multiscale"

    def words(self) -> str:
        return "Multiscale (Persson's contact shares, a sum rule for the pressure's variance)"

    def energy_factor(self) -> tuple[float, bool]:
        return multiscale.FORM.gamma, True

    def waves(self, problem: WaveProblem) -> Waves:
        return multiscale.waves_of_multiscale(problem)


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
        if (
            isinstance(self.gamma, bool)
            or not isinstance(self.gamma, (int, float))
            or not 0 <= self.gamma <= 1
        ):
            raise InputError(
                argument="gamma", got=self.gamma, accepted="a number from 0 to 1"
            )

    def words(self) -> str:
        where = "in mu and in G" if self.stored else "in mu"
        return f"Persson's theory, S with gamma = {self.gamma:g} {where}"

    def energy_factor(self) -> tuple[float, bool]:
        return self.gamma, self.stored

    def bound_terms(self, of_area: bool) -> tuple[float, float, float] | None:
        if self.energy_factor() != Persson().energy_factor():
            return None
        return super().bound_terms(of_area)

    def waves(self, problem: WaveProblem) -> Waves:
        return multiscale.waves_of_persson(problem, self.energy_factor())


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
    these `model_error` is what heights and lay of the surface may change, and their
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

    def words(self) -> str:
        return "half-space in three dimensions, maps of cells (no reduction)"

    def on_map(self, surface: AbstractSpectrum) -> bool:
        random = self.periods is not None or self.seeds != 1
        return not random and getattr(surface, "map", None) is not None

    def work(self, surface: AbstractSpectrum) -> tuple[str, str]:
        from . import on_maps, random_maps  # which load SciPy

        if self.on_map(surface):
            return on_maps.work(surface, self.cells)
        seeds = len(seeds_of(self.seeds))
        return random_maps.work(surface, self.cells, self.periods, seeds)

    def solve(self, problem: RoadProblem) -> SurfaceFriction:
        from . import on_maps

        untraced(
            InputError(
                argument="model",
                got=self,
                accepted="em.Multiscale() or em.Persson() under jit, grad and vmap",
            ),
            problem,
        )
        seeds, measured = seeds_of(self.seeds), self.on_map(problem.surface)
        maps = MapsOf(measured, self.cells, self.periods, seeds)
        return on_maps.friction(maps, problem)

    def bound(
        self,
        foundation: SteadyBody,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
        of_area: bool = False,
    ) -> Array | None:
        # random maps have the spectrum of a measured surface and not its heights; what
        # these and a lay change is added for all models alike
        differs = tops_of(surface) is not None or lay_of(surface) is not None
        return 0.0 * area if differs and not self.on_map(surface) else None
