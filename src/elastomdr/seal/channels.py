"""What a model of a leak answers: the flow through the gaps of a pressed surface."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ..checks import untraced
from ..errors import InputError
from ..rough.local_modulus import SoftenedByScale
from ..rough.problem import STRAIN_SHARE

if TYPE_CHECKING:
    from ..arrays import Array
    from ..material.softening import Softening
    from ..surface.spectrum import AbstractSpectrum


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


class RoughSeal(NamedTuple):
    """What is pressed together."""

    surface: AbstractSpectrum
    softening: Softening | None = None  # of the rubber, by the strain of each scale
    direction: float | None = None  # of the flow to a lay [rad], if it is known

    def softened(self, times: float = 1.0) -> SoftenedByScale | None:
        """The softening at `times` the usual strain of each length scale."""
        if self.softening is None:
            return None
        share = np.asarray(times * STRAIN_SHARE)
        return SoftenedByScale(self.softening, self.surface, share)


def no_derivatives(*values: object) -> None:
    """Raises `InputError` where JAX traces one of the values."""
    accepted = "em.Multiscale() under jit, grad and vmap"
    untraced(InputError(argument="model", accepted=accepted), *values)


class Channels(ABC):
    """A model with its options, as a leak asks it."""

    closes: float  # the real contact area over nominal area from which on nothing flows
    nodes: ClassVar[int] = 17  # pressures along a seal by which it is asked, 2^n + 1
    turns: ClassVar[bool] = False  # whether it follows the flow's direction to a lay
    softens: ClassVar[bool] = True  # and the softening of each length scale

    @abstractmethod
    def flow(self, rough: RoughSeal, relative_pressure: Array) -> GapFlow:
        """The flow through the gaps at pressures over E*, (rows, points)."""
