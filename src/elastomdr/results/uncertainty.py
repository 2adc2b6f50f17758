"""What a friction coefficient rests on, part by part: how much of it each part may
change, and which test would narrow the band, by how much.

Numerical error and bound of the model are those of the curve. What else was not stated
as an uncertainty is taken by a convention, which each row names: the shortest wave of a
road a factor of two longer or shorter, its heights 10 % off where no scan says how well
they are known, a shear stress 20 %, a temperature 1 K, moduli beyond their data a factor
of two. So is what a test leaves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ..checks import significant
from ..errors import InputError
from .doubts import Doubt, carried, counted_kinds, found, where

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style
    from ..arrays import Array
    from .plot_contacts import SteadyElements

FACTOR = 2.0  # of the shortest wave, each way
HEIGHTS = 0.1  # of the heights of a road that was not scanned, relative
ERRORS = 2.0  # standard errors of a scanned spectrum, each way
STRESS = 0.2  # of the shear stress, relative
KELVIN = 1.0  # of the temperature, each way
BEYOND = 2.0  # of moduli beyond their data, each way
_SEEN = 1e-3  # the smallest share that words give
SMALL = 0.02  # share of the band that a test must take away to be named
POINTS, EACH = 3, 0.05  # of measured friction, and how well each is known, relative
MEASURED = f"{POINTS} points of measured friction, each to {100 * EACH:g} %"
_OWN = {MEASURED: EACH / POINTS**0.5}  # error of a test itself, relative
_BOUNDS = ("numerical", "model")  # parts that are bounds, which add up


class Change(NamedTuple):
    """One thing changed in a call."""

    shorter: float = 1.0  # factor on the upper cutoff of a surface
    higher: float = 1.0  # factor on its heights
    sampled: float = 0.0  # standard errors by which its measured spectrum is off
    kelvin: float = 0.0  # by which the rubber is warmer
    stress: float = 1.0  # factor on the shear stress
    beyond: float = 1.0  # factor on moduli beyond the data of the rubber
    decades: float = 0.0  # by which these begin further out than the data end


class Judged(Protocol):
    """A coefficient that has doubts."""

    @property
    def mu(self) -> Array: ...
    def examined(self) -> Iterator[Doubt]:
        """All doubts that were looked for."""
        ...


class Again(Protocol):
    """The call of a curve, once more."""

    @property
    def measured(self) -> bool:
        """Whether the surface was measured, and has sampling errors."""
        ...

    def curve(self, change: Change) -> Judged | None:
        """The curve with one thing changed; None where that has no answer."""
        ...

    def elements(self, point: int, leading: float) -> SteadyElements:
        """What the elements do under a point, whose leading edge [m] is known. Raises
        `InputError`.
        """
        ...


class Part(NamedTuple):
    """One part of what a number rests on; shares are relative to mu, at each point, and
    NaN where they are not known.
    """

    source: str  # "numerical", "model", "rubber", "road", "shear law", "temperature"
    share: np.ndarray  # how much of mu it may change
    assumed: str  # what has been taken for it
    test: str  # what would lower it
    after: np.ndarray  # share that the test leaves

    @property
    def largest(self) -> float:
        """The largest share of any point; NaN where it is not known at one."""
        return float(np.max(self.share))

    def at(self, points: list[int]) -> Part:
        """The same of some points, by their number in the flattened curve."""
        share, after = (np.ravel(each)[points] for each in (self.share, self.after))
        return self._replace(share=share, after=after)

    def words(self) -> str:
        """Share, convention, test and what that leaves."""
        left = f", {_range(self.after)} left" if (self.after > 0).any() else ""
        return f"{_range(self.share)} ({self.assumed}); surer: {self.test}{left}"


class Surer(NamedTuple):
    """A test, and what it does to the band where that is widest, relative to mu."""

    test: str
    before: float
    after: float  # NaN where that is not known

    def words(self) -> str:
        """The test and the band before and after it."""
        if np.isnan(self.after):
            return f"{self.test}: by how much is not known"
        return f"{self.test}: band {percent(self.before)}, then {percent(self.after)}"


@dataclass(frozen=True, eq=False, repr=False)
class Uncertainty:
    """What `FrictionCurve.uncertainty` returns: parts, to go through or take by name."""

    parts: tuple[Part, ...]
    doubts: tuple[Doubt, ...] = ()  # of mu, at the points of the curve

    def __getitem__(self, source: str) -> Part:
        """The part of a name. Raises `InputError` for a name that is not among them."""
        named = {part.source: part for part in self}
        if source not in named:
            accepted = f"one of {', '.join(named)}"
            raise InputError(argument="source", got=source, accepted=accepted)
        return named[source]

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)

    def at(self, points: list[int]) -> Uncertainty:
        """The same of some points, by their number in the flattened curve."""
        doubts = carried(self.doubts, lambda at: np.ravel(at)[points], failed=True)
        return Uncertainty(tuple(part.at(points) for part in self), found(doubts))

    def band(self, test: str = "") -> np.ndarray:
        """Half the band around mu, relative, at each point, after a `test`: bounds are
        added to the root of the sum of squares of the rest. What nobody knows is left
        out, but without a bound of the model it is NaN.
        """
        shares = {p.source: p.after if p.test == test else p.share for p in self}
        bounds = sum(shares.pop(source) for source in _BOUNDS)
        squares = (np.nan_to_num(share) ** 2 for share in shares.values())
        return bounds + np.sqrt(sum(squares) + _OWN.get(test, 0.0) ** 2)

    def surer(self) -> tuple[Surer, ...]:
        """The tests that would narrow the band, the one that would most first; then
        those of parts that are not known.
        """
        before, tests = float(np.max(self.band())), []
        for test in dict.fromkeys(part.test for part in self):
            told = np.isfinite([part.after for part in self if part.test == test])
            after = float(np.max(self.band(test))) if told.any() else np.nan
            lower = after < (np.inf if np.isnan(before) else before * (1 - SMALL))
            if lower or not told.any():
                tests.append(Surer(test, before, after))
        return tuple(sorted(tests, key=lambda each: np.nan_to_num(each.after, nan=1e9)))

    def summary(self) -> str:
        """The parts, a line each, the band, and the tests."""
        width = max(len(part.source) for part in self) + 2
        lines = [f"{part.source:<{width}}{part.words()}" for part in self]
        lines.append(f"{'band':<{width}}{_range(self.band())}")
        if said := counted_kinds(self.doubts):
            lines.append(f"{'doubts':<{width}}{said}")
        return "\n".join(lines + [f"surer: {each.words()}" for each in self.surer()])

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws the parts as bars, up to the largest share of any point, dark up to the
        smallest, in a style of `Result.plot`; returns matplotlib Axes.
        """
        from .plot_curves import draw_parts
        from .plotting import DrawAsk

        return draw_parts({p.source: p.share for p in self}, DrawAsk(ax, style))

    def __repr__(self) -> str:
        return self.summary()


def computed(
    value: Array, error: Array | float, bound: Array | float, fitted: bool, test: str
) -> Iterator[Part]:
    """The parts that every result has: numerical error, bound of its model, both
    absolute, and rubber; `fitted` where the error holds what a fit misses, `test` tells
    how far the model is off.
    """
    size = np.where(np.asarray(value) == 0, 1.0, np.abs(value))
    none, unknown = np.zeros(size.shape), np.full(size.shape, np.nan)
    said, closer = "error of the computation", "a smaller rtol"
    if fitted:
        said, closer = f"{said} and misfit of the rubber", "the moduli as a table"
    yield Part("numerical", np.asarray(error) / size, said, closer, none)
    yield Part(
        "model", np.asarray(bound) / size, "its bound, or limits of mu", test, none
    )
    draws = "draws of a fit, em.fit.material(...).draws(n), in place of the material"
    yield Part("rubber", unknown, "not computed", draws, unknown)


def largest_change(
    mu: np.ndarray, told: Iterable[Doubt], curves: list[Judged | None]
) -> tuple[np.ndarray, str]:
    """The largest change of mu among curves, relative, NaN where one is not known; and
    in words where one has no prediction though the doubts that were `told` are others.
    """
    lost = np.zeros(mu.shape, bool)
    for curve in filter(None, curves):
        lost |= _unforetold(curve.examined(), mu)
    lost &= ~_unforetold(told, mu)
    others = [np.nan if curve is None else np.asarray(curve.mu) for curve in curves]
    size = np.where(mu == 0, np.nan, mu)
    share = np.max([np.abs(other / size - 1) for other in others], axis=0)
    count = f"; then no prediction at {int(lost.sum())} of {lost.size} points"
    return share, count if lost.any() else ""


def _unforetold(doubts: Iterable[Doubt], mu: np.ndarray) -> np.ndarray:
    there = where(doubts, "no prediction")
    return np.broadcast_to(False if there is None else np.asarray(there), mu.shape)


def _range(shares: np.ndarray) -> str:
    """The smallest and the largest of shares, where they differ."""
    known = shares[np.isfinite(shares)]
    if not known.size:
        return "not known"
    low, high = float(known.min()), float(known.max())
    words = f"{percent(high)} of mu" + " where it is known" * (known.size < shares.size)
    return words if low >= 0.9 * high or high < _SEEN else f"{percent(low)} to {words}"


def percent(share: float) -> str:
    """A share in words."""
    if np.isnan(share):
        return "not known"
    words = significant(100 * share, 2 if share < 1 else 3)
    return f"{words} %" if share >= _SEEN else "below 0.1 %"
