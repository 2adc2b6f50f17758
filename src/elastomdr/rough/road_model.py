"""What a model of a surface under a pressure answers: derive a class from `SurfaceModel`
to add another.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from ..models import Model
from .local_modulus import Local

if TYPE_CHECKING:
    from ..arrays import Array
    from ..call.types import SteadyBody
    from ..surface.spectrum import AbstractSpectrum
    from .against_lay import Which
    from .psd_integrals import Moduli, Nodes


class RoadProblem(NamedTuple):
    """Points of a surface under a pressure, as a `SurfaceModel` solves them."""

    foundation: SteadyBody  # the rubber; `complex_modulus(omega)` is E* [Pa]
    surface: AbstractSpectrum
    velocity: Array  # reduced, v a_T [m/s] (points,)
    pressure: Array  # nominal, at the reference temperature [Pa] (points,)
    local: Local = Local()  # how moduli differ from scale to scale
    rtol: float = 1e-6  # relative error of mu to be met
    progress: Callable[[int, int], None] | None = None  # `progress(done, total)`

    def of(self, points: Which) -> RoadProblem:
        """The same for some of the points."""
        return self._replace(
            velocity=self.velocity[points],
            pressure=self.pressure[points],
            local=self.local.of(points),
        )


class SurfaceFriction(NamedTuple):
    """What a `SurfaceModel` finds at each point, arrays of shape (points,)."""

    mu: Array
    area: Array  # real contact area over nominal area
    error: Array  # numerical error of mu
    good: Array  # whether the point has an answer
    area_error: Array  # numerical error of the area
    said: str = ""  # about the solution, for the result


class MapsOf(NamedTuple):
    """The maps that stand for a surface in three dimensions."""

    measured: bool  # whether that which was measured does
    cells: int | None  # along each side; None: enough
    periods: int | None  # side in longest waves; None: as many as fit
    seeds: tuple[int, ...]  # of random ones


class WaveProblem(NamedTuple):
    """Points of a surface under a pressure, as a `WaveByWave` solves them."""

    moduli: Moduli
    nodes: Nodes  # of the integral over the waves
    velocity: Array  # reduced [m/s] (points,)
    pressure: Array  # at the reference temperature [Pa] (points,)
    local: Local = Local()  # how moduli differ from scale to scale


class Waves(NamedTuple):
    """Where on the scale of lengths a surface is in contact and loses energy."""

    each: Array  # friction of each node (points, cells, 2)
    edges: Array  # friction of the waves beyond q_high (points,)
    rate: Array  # dR/dlog q, of which the shares of contact are made
    stiffer: Array  # by what factor contacts feel a larger |E*|^2, its log
    area: Array  # of real contact


class WaveByWave(ABC):
    """A model that tells the friction of each wave."""

    @abstractmethod
    def waves(self, problem: WaveProblem) -> Waves:
        """Friction wave by wave."""

    @abstractmethod
    def contact(self, stress_variance: Array, stiffer: Array) -> Array:
        """The share of contact from R, the integral of `waves(...).rate`, and from
        `waves(...).stiffer`.
        """


class SurfaceModel(Model, ABC):
    """A model of a surface under a pressure.

    It needs `label`, `words` and `solve`; everything else has a default. A test
    (`tests/house/test_models.py`) shows one that stands outside of this package.
    """

    # whether `solve` follows the softening of the material from scale to scale; a model
    # that does not is linear, and its results say so
    softens: ClassVar[bool] = False
    # whether `solve` follows the slopes of the tops of measured heights (`Nodes.tops`);
    # others take heights as Gaussian
    follows_tops: ClassVar[bool] = False
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
    def solve(self, problem: RoadProblem) -> SurfaceFriction:
        """Friction and real contact at the points of the problem."""

    def bound(
        self,
        foundation: SteadyBody,
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
        foundation: SteadyBody,
        surface: AbstractSpectrum,
        velocity: Array,
        area: Array,
    ) -> list[str]:
        """Why `bound` is wide at points, and what would make it smaller, for results."""
        return []

    def by_wave(self) -> WaveByWave | None:
        """The model as one that answers wave by wave: each length scale then has a
        temperature of its own under `em.Heat`. None, the default, where all have one.
        """
        return None
