"""What a friction coefficient rests on, part by part: how much of it each part may
change, and what would lower that.

Numerical error and bound of the model are those of the curve. Of the others nobody says
how uncertain they are; by convention, which each row names, the shortest wave of a road
may be a factor of two longer or shorter, a shear stress 20 % off, a temperature 2 K.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ..checks import significant
from ..errors import InputError
from .doubts import Doubt

FACTOR = 2.0  # of the shortest wave, each way
KELVIN = 2.0  # of the temperature, each way
STRESS = 0.2  # of the shear stress, relative
ERRORS = 2.0  # standard errors of a measured spectrum, each way
SMALL = 0.02  # share of mu up to which nothing needs to be surer


class Judged(Protocol):
    """What has doubts."""

    def examined(self) -> Iterator[Doubt]:
        """All doubts that were looked for."""
        ...


class Again(Protocol):
    """The call of a curve, once more with one thing changed."""

    @property
    def measured(self) -> bool:
        """Whether the surface was measured, and has sampling errors."""
        ...

    def cold(self) -> Judged:
        """The curve without heating."""
        ...

    def mu(
        self, shorter: float = 1.0, kelvin: float = 0.0, sampled: float = 0.0
    ) -> np.ndarray | None:
        """mu with a shortest wave that is shorter by a factor, rubber that is `kelvin`
        warmer, or a spectrum that is off by so many of its standard errors; None where
        that has no answer.
        """
        ...


class Part(NamedTuple):
    """One part of what a number rests on."""

    source: str  # "numerical", "model", "rubber", "road", "shear law", "temperature"
    # how much of mu it may change, relative, at each point; NaN where not known
    share: np.ndarray
    assumed: str  # what has been taken for it
    remedy: str  # what would lower it

    @property
    def largest(self) -> float:
        """The largest share of any point; NaN where it is not known at one."""
        known = self.share[np.isfinite(self.share)]
        return float(known.max()) if known.size == self.share.size else np.nan

    def words(self) -> str:
        """Share, convention and remedy."""
        share = "not known"
        if np.isfinite(self.share).any():
            low, high = np.nanmin(self.share), np.nanmax(self.share)
            share = f"{significant(100 * float(high), 3)} % of mu"
            if low < 0.9 * high:
                share = f"{significant(100 * float(low), 3)} to {share}"
            if np.isnan(self.share).any():
                share += " where it is known"
        return f"{share} ({self.assumed}); surer: {self.remedy}"


@dataclass(frozen=True, eq=False, repr=False)
class Uncertainty:
    """What `FrictionCurve.uncertainty` returns: parts, to go through or take by name."""

    parts: tuple[Part, ...]

    def __getitem__(self, source: str) -> Part:
        """The part of a name. Raises `InputError` for a name that is not among them."""
        for part in self.parts:
            if part.source == source:
                return part
        names = ", ".join(part.source for part in self.parts)
        raise InputError(argument="source", got=source, accepted=f"one of {names}")

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)

    def surer(self) -> tuple[Part, ...]:
        """The parts that matter, what is not known and what changes most first."""
        matter = [part for part in self.parts if not part.largest <= SMALL]
        return tuple(sorted(matter, key=lambda p: (np.isfinite(p.largest), -p.largest)))

    def summary(self) -> str:
        """The parts, a line each."""
        width = max(len(part.source) for part in self.parts) + 2
        return "\n".join(f"{p.source:<{width}}{p.words()}" for p in self.parts)

    def __repr__(self) -> str:
        return self.summary()


def largest_change(mu: np.ndarray, *others: np.ndarray | None) -> np.ndarray:
    """The largest change of mu from those given; NaN where one is not known."""
    changes = [np.full(mu.shape, np.nan) if o is None else abs(o - mu) for o in others]
    return np.max(changes, axis=0)
