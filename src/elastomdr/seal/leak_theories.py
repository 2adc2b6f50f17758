"""Published theories of leaks, to compare with: the critical constriction and the
effective medium of the gaps of Persson's theory.

    critical constriction    w = u_1(z_c)^3,    A(z_c) = 0.42
    effective medium         sum f_i (w_i - w)/(w_i + (n - 1) w) = A/(n - 1),  w_i = u_1i^3

Here u_1 is the gap where contact is lost as waves about z come into sight, and f = -dA
how much is; contact itself has w = 0. The medium closes at A = (n - 1)/n: n = 2 is
Bruggeman's. Sources: B. N. J. Persson and C. Yang, J. Phys.: Condens. Matter 20 (2008)
315011; B. Lorenz and B. N. J. Persson, Eur. Phys. J. E 31 (2010) 159.
"""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..errors import InputError
from ..models import Model
from ..rough.psd_integrals import PER_DECADE, nodes
from ..units.arguments import constructor_in_si
from .channels import Channels, GapFlow, RoughSeal, no_derivatives
from .gap_maps import effective_medium
from .persson_gap import (
    CLOSES,
    GapPoints,
    contact_of,
    critical_gap,
    mean_gap,
    scales,
)

if TYPE_CHECKING:
    from ..arrays import Array


class LeakTheory(Model, Channels):
    """A model of leaks alone, from the gaps on all scales."""

    @abstractmethod
    def words(self) -> str:
        """The theory in a few words."""

    @abstractmethod
    def through(self, contacts: GapPoints) -> Array:
        """w [m^3] at each point."""

    def flow(self, rough: RoughSeal, relative_pressure: Array) -> GapFlow:
        surface, softened = rough.surface, rough.softened()
        no_derivatives(rough, relative_pressure)
        fine, coarse = (nodes(surface, count) for count in (2 * PER_DECADE, PER_DECADE))
        flat, shape = np.ravel(relative_pressure), relative_pressure.shape
        contacts = contact_of(fine, flat, softened)
        w, less = (
            self.through(contacts),
            self.through(contact_of(coarse, flat, softened)),
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            error = np.where(w > 0, np.abs(w - less) / w, 0.0)
        return GapFlow(
            flow=w.reshape(shape),
            gap=mean_gap(contacts).reshape(shape),
            critical_gap=critical_gap(contact_of(fine, relative_pressure[0], softened)),
            area=contacts.area.reshape(shape),
            error=error.reshape(shape),
            model_error=np.full(shape, np.nan),
            good=np.isfinite(w).reshape(shape),
            said=self.words(),
        )


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class CriticalConstriction(LeakTheory):
    """A leak through the narrowest place of the widest channel, for comparison: all of
    the pressure falls there.

    Its gap is that which Persson's theory has where the share of contact falls to 0.42.
    It leaks about two to five times more than three-dimensional maps. Source: B. N. J.
    Persson and C. Yang, J. Phys.: Condens. Matter 20 (2008) 315011.
    """

    label: ClassVar[str] = "critical constriction"
    closes = CLOSES

    def words(self) -> str:
        return "critical constriction (Persson)"

    def through(self, contacts: GapPoints) -> Array:
        return np.where(contacts.area < CLOSES, critical_gap(contacts) ** 3, 0.0)


@constructor_in_si
@dataclasses.dataclass(frozen=True)
class EffectiveMedium(LeakTheory):
    """A leak through an effective medium of the gaps that Persson's theory has on all
    scales, for comparison.

    Args:
        closes: real contact area over nominal area at which nothing flows any more;
            0.5 is Bruggeman's medium, in contacts it is about 0.42.

    It leaks two to more than ten times more than three-dimensional maps. Source: B.
    Lorenz and B. N. J. Persson, Eur. Phys. J. E 31 (2010) 159.
    """

    closes: float = 0.5
    label: ClassVar[str] = "effective medium"

    def __post_init__(self) -> None:
        number = isinstance(self.closes, (int, float))
        if isinstance(self.closes, bool) or not number or not 0 < self.closes < 1:
            raise InputError(
                argument="closes", got=self.closes, accepted="a number between 0 and 1"
            )

    def words(self) -> str:
        return f"effective medium (Persson), closed at {self.closes:.4g} of contact"

    def through(self, contacts: GapPoints) -> Array:
        each = zip(*scales(contacts), contacts.area, strict=True)
        return np.array([_medium(*one, closes=self.closes) for one in each])


def _medium(shares: Array, gaps: Array, area: float, closes: float) -> float:
    """w of the effective medium, from shares and gaps at all scales and the share in
    contact at the last.
    """
    if area >= closes:
        return 0.0
    gap_shares = -np.diff(np.append(shares, area))
    known = np.isfinite(gaps) & (gap_shares > 0)
    gap_shares = gap_shares[known] * (1 - area) / gap_shares[known].sum()
    return effective_medium(
        np.append(gap_shares, area), np.append(gaps[known] ** 3, 0.0), 1 / (1 - closes)
    )
