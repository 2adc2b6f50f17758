"""What a road is asked for, and rubber that rests on a rough surface."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import stop_gradient, xp
from ..call.extrapolation import (
    beyond_sweep,
    held_beyond,
    pressed_too_hard,
    warn_of,
)
from ..call.problem import Asked, check_carries
from ..checks import is_traced
from ..element.law import not_flat, surface_foundation
from ..errors import InputError
from ..material.shift import thermal_factors
from ..material.tabulated import needs_series
from ..results.doubts import Doubt
from ..surface.spectrum import AbstractSpectrum
from .adhesion import AdhesiveShear
from .heat import Heat
from .local_modulus import SoftenedByScale

if TYPE_CHECKING:
    from collections.abc import Callable

    from .._types import ArrayLike, Branch, Number
    from ..arrays import Array
    from ..call.types import Material, SteadyBody, Surface
    from ..material.validity import Range

STRAIN_SHARE = 0.5  # strain of a length scale over its rms slope, where none is given


@dataclasses.dataclass(frozen=True)
class RoughCall:
    """A rough line or surface in steady sliding, as `em.friction` was asked for it."""

    material: Material
    surface: Surface
    asked: Asked
    rtol: float = 1e-6
    heat: Heat | None = None
    adhesion: AdhesiveShear | None = None
    strain_share: Number = STRAIN_SHARE
    progress: Callable[[int, int], None] | None = None
    branch: Branch = "cold"  # of several steady states with heat


def resting_body(
    material: Material, time: ArrayLike | None, velocity: ArrayLike | None = None
) -> SteadyBody:
    """The half-space of rubber that rests on a rough surface, or slides over its lines.
    Raises `InputError`.
    """
    if time is not None:
        needs_series("material", material, "rubber that is held for a time")
    if velocity is not None:
        needs_series("material", material, "rubber that slides over lines")
    foundation = surface_foundation(material)
    if foundation.per_area:
        raise not_flat(material)
    if time is None:
        check_carries(foundation)
    return foundation


def not_rough(surface: object) -> InputError:
    """What is said of a surface on which there is no contact of a line."""
    return InputError(
        argument="surface",
        got=surface,
        accepted="an em.RoughLine, or a surface such as em.SelfAffine",
    )


class Resting(NamedTuple):
    """Rubber that a pressure has held on a rough surface for a time, or for ever.

    Under a constant pressure contact grows, and is at each time that of an elastic body
    with E* = b_T/J(t/a_T).
    """

    foundation: SteadyBody
    surface: Surface
    time: Array | None
    temperature: Array | None
    factor: Any  # a_T
    vertical: Any  # b_T
    soft: Any  # 1/E* [1/Pa]

    @classmethod
    def of(
        cls,
        foundation: SteadyBody,
        surface: Surface,
        time: Array | None,
        temperature: Array | None,
    ) -> Resting:
        factor, vertical = thermal_factors(foundation, temperature)
        compliance = (
            1 / foundation.equilibrium
            if time is None
            else foundation.creep_compliance(time / factor)
        )
        soft = compliance / vertical + 0.0
        return cls(foundation, surface, time, temperature, factor, vertical, soft)

    def softened(self) -> SoftenedByScale | None:
        """The softening of each length scale by its strain, on a spectrum."""
        softening, surface = self.foundation.softening, self.surface
        if softening is None or not isinstance(surface, AbstractSpectrum):
            return None
        return SoftenedByScale(softening, surface, np.asarray(STRAIN_SHARE))

    def level(self) -> Any:
        """E* of the real contact over that of small strain."""
        softened = self.softened()
        return 1.0 if softened is None else softened.level()

    def doubts(
        self, pressure: Array, shape: tuple[int, ...], softens: bool
    ) -> tuple[Doubt, ...]:
        """Points beyond the data of the rubber, by time and strain, and those where the
        largest `pressure` [Pa] is above its modulus; `softens`: whether the model
        follows `softened()`.
        """
        known, time, temperature = self.foundation.range, self.time, self.temperature
        beyond = held_beyond(known, time, temperature, self.factor, shape)
        hard = pressed_too_hard(xp.broadcast_to(pressure, shape), 1 / self.soft)
        return (*beyond, *hard, *self.of_softening(shape, softens))

    def of_softening(self, shape: tuple[int, ...], softens: bool) -> tuple[Doubt, ...]:
        """Strains beyond the sweep, or that the softening is left out."""
        softened = self.softened()
        if not softens or softened is None:
            return softening_left_out(self.foundation, shape)
        return strained_beyond(softened, self.foundation.range, shape)


def softening_left_out(body: SteadyBody, shape: tuple[int, ...]) -> tuple[Doubt, ...]:
    """The doubt of all points of a model that is linear, where the rubber softens."""
    if body.softening is None:
        return ()
    says = (
        "leave out the softening of the material by strain: moduli are those of small "
        "strain, with less real contact"
    )
    return (Doubt("estimate", np.ones(shape, bool), says, "em.break_out, em.leak"),)


def strained_beyond(
    softened: SoftenedByScale, known: Range | None, shape: tuple[int, ...]
) -> tuple[Doubt, ...]:
    """All points, where the surface strains the rubber more than its sweep did."""
    strain, last = stop_gradient(
        (
            softened.strain(xp.asarray(softened.spectrum.q_high)),
            softened.softening.strain[-1],
        )
    )
    points = xp.full(shape, strain > last * (1 + 1e-9))
    traced, strains = is_traced(strain, last), ""
    if not traced:
        ends = float(strain), float(last)
        strains = "up to {:.2g} on a sweep that ends at {:.2g}".format(*ends)
    doubts = beyond_sweep(points, known, strains)
    if not traced and not (known is not None and known.illustrative):
        for doubt in doubts:
            warn_of(doubt)
    return doubts
