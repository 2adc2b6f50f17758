"""What a model of a leak answers: the flow through the gaps of a pressed surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ..arrays import Array
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


class Channels(NamedTuple):
    """A model with its options, as a leak asks it."""

    # gaps of a surface, and flow through them, at pressures over E*, (rows, points), in
    # a direction of the flow to a lay [rad], if it is known
    flow: Callable[[AbstractSpectrum, Array, float | None], GapFlow]
    # the real contact area over nominal area from which on nothing flows
    closes: float
    # pressures along a seal by which it is asked, 2^n + 1
    nodes: int = 17
    # whether it computes a flow in its direction to a lay
    turns: bool = False
