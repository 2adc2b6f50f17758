"""What a coefficient rests on, part by part: how much of it each part may
change, and which test would narrow the band, by how much.

Numerical error and bound of the model are those of the curve. What else was not stated
as an uncertainty is taken by a convention, which each row names: the shortest wave of a
road a factor of two longer or shorter, its heights 10 % off where no scan says how well
they are known, a shear stress 20 %, a temperature 1 K. So is what a test leaves; what
measured friction leaves follows from the derivatives of mu. Moduli beyond
their data are changed as far as these allow.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from typing import ClassVar, NamedTuple

import numpy as np

from ..checks import SEEN, percent, shares_in_words, significant
from ..errors import Advised, InputError
from ..linear_update import relative
from .axes import Axis, Quantity, dimensions
from .base import (
    AbstractPoints,
    Array,
    Assumed,
    Change,
    Result,
    quantity,
    record,
    setting,
)
from .doubts import Doubt, carried, counted_kinds, where

# the input of a result that tells what a fit misses
FITTED = "material against its data"
# what is taken where an uncertainty was not stated
FACTOR = Assumed(
    "shortest wave off by a factor of 2", Change(shorter=2.0), Change(shorter=0.5)
)
HEIGHTS = Assumed("off by 10 % at all scales", Change(higher=1.1), Change(higher=0.9))
ERRORS = Assumed(
    "its spectrum off by 2 standard errors at all scales",
    Change(sampled=2.0),
    Change(sampled=-2.0),
)
STRESS = Assumed("shear stress off by 20 %", Change(stress=1.2), Change(stress=0.8))
BEYOND = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, -1.0)  # decades from the data to a branch
KELVIN = Assumed("off by 1 K", Change(kelvin=1.0), Change(kelvin=-1.0))
SMALL = 0.02  # share of the band that a test must take away to be named
EACH = 0.05  # standard deviation of a measured coefficient, relative
SUREST = 1e-3  # that nobody measures better, as `em.fit.calibrate`
OUTSIDE = 0.05  # share of measured points that a band may leave out
KNOWN = 0.02  # how well a scan of the road knows its heights, relative
# the argument, the key of a scene and, as data, the field of the page
DRAWS = "draws of a fit in place of the material: " + Advised.of(
    ("em.fit.material(...).draws(n), uncertainty of a scene", {"uncertainty": ""})
)
SHEAR = "a shear law where the road is dry: " + Advised.of(
    ("adhesion=, [adhesion] of a scene", {"adhesion": ""})
)


class Part(NamedTuple):
    """One part of what a number rests on; shares are relative to it, at each point, and
    NaN where they are not known.
    """

    source: str  # "numerical", "model", "rubber", "road", "shear law", "temperature"
    share: np.ndarray  # how much of the number it may change
    assumed: str  # what has been taken for it
    test: str  # what would lower it
    after: np.ndarray  # share that the test leaves

    def words(self) -> str:
        """Share, convention, test and what that leaves."""
        left = f", {shares_in_words(self.after)} left" if (self.after > 0).any() else ""
        return (
            f"{shares_in_words(self.share)} ({self.assumed}); surer: {self.test}{left}"
        )


class Surer(NamedTuple):
    """A test, and what it does to the band where that is widest, relative to the
    number; and at how many points something is not known before and after it.
    """

    test: str
    before: float
    after: float  # NaN where that is not known
    lost: int = 0
    left: int = 0

    def words(self) -> str:
        """The test, and the band or the points before and after it."""
        if self.lost and self.lost == self.left:
            return self.test + "; by how much is not known"
        if self.lost:
            return f"{self.test}: not known at {self.lost} points, then at {self.left}"
        return self.test + f": band {percent(self.before)}, then {percent(self.after)}"


@record
class Uncertainty(AbstractPoints):
    """What `curve.uncertainty()` returns: parts, to go through or take by name; the first
    axis of every field runs over them, the others are the points of the curve.
    """

    value: Array = quantity("value", "-")
    share: Array = quantity(
        "share", "-", "of the value, how much the part may change it; NaN: not known"
    )
    after: Array = quantity("share after the test", "-", "of the value; NaN: not known")
    error: Array = quantity("estimated error", "-")
    about: Quantity = setting()  # what the value is of
    sources: tuple[str, ...] = setting()  # names of the parts
    assumed: tuple[str, ...] = setting()
    tests: tuple[str, ...] = setting()

    title: ClassVar[str] = "What a number rests on"
    figure: ClassVar[str] = "plot_curves.draw_parts"
    shows: ClassVar[str] = "share"
    error_of: ClassVar[str] = "the value"

    @classmethod
    def of(
        cls, parts: Iterable[Part], result: Result, doubts: Iterable[Doubt]
    ) -> Uncertainty:
        """Parts of what a result shows; `doubts` are those of its points."""
        sources, shares, assumed, tests, after = zip(*parts, strict=True)
        share = np.array(shares)
        return cls(
            velocity=getattr(result, "velocity", np.array(np.nan)),
            temperature=getattr(result, "temperature", None),
            pressure=getattr(result, "pressure", None),
            value=getattr(result, result.shows),
            error=result.error,
            model_error=getattr(result, "model_error", None),
            converged=np.broadcast_to(result.converged, share.shape),
            share=share,
            after=np.array(after),
            marks=tuple(doubts),  # those of points that failed among them
            model=result.model,
            plan=result.plan,
            inputs=result.inputs,
            about=next(q for q in result.quantities() if q.path == result.shows),
            sources=sources,
            assumed=assumed,
            tests=tests,
        )

    def examined(self) -> Iterator[Doubt]:
        """Those of the curve, at its points."""
        yield from self.marks

    def describe(self, q: Quantity) -> Quantity:
        """The value is of the quantity that it is about."""
        about = self.about
        own = q._replace(label=about.label, unit=about.unit)
        return own if q.path == "value" else q

    def fields(self, dims: str | None = "...") -> dict[Quantity, np.ndarray]:
        """As of every result, each of the shape of the shares."""
        every, shape = super().fields(dims), self.share.shape
        return {q: np.broadcast_to(values, shape) for q, values in every.items()}

    def axes(self) -> list[Axis]:
        """The parts, then the axes of the curve."""
        first = {q: values[0] for q, values in self.fields().items()}
        parts = Axis("part", np.array(self.sources))
        return [parts, *dimensions(first, self.coordinates, "")]

    def columns(self) -> dict[str, np.ndarray]:
        """As of every result, a row for each part of each point, with the `band`."""
        names = np.repeat(self.sources, self.share[0].size)
        half = np.tile(np.ravel(self.half_band()), len(self.sources))
        return {"part": names, **super().columns(), "half of the band [-]": half}

    def __getitem__(self, source: str) -> Part:
        """The part of a name. Raises `InputError` for a name that is not among them."""
        if source not in self.sources:
            accepted = f"one of {', '.join(self.sources)}"
            raise InputError(argument="source", got=source, accepted=accepted)
        return [*self][self.sources.index(source)]

    def __iter__(self) -> Iterator[Part]:
        fields = (self.sources, self.share, self.assumed, self.tests, self.after)
        return map(Part._make, zip(*fields, strict=True))

    def at(self, points: list[int]) -> Uncertainty:
        """The same of some points, by their number in the flattened curve."""

        of_parts = {
            q.path: np.reshape(values, (len(self.sources), -1))[:, points]
            for q, values in self.fields().items()
            if q.path != "extrapolated"
        }
        marks = carried(self.marks, lambda at: np.ravel(at)[points], failed=True)
        return dataclasses.replace(self, **of_parts, marks=marks)

    def half_band(self, test: str = "") -> np.ndarray:
        """Half the band around mu, relative, at each point, after a `test`: bounds are
        added to the root of the sum of squares of the rest. What nobody knows is left
        out, but without a bound of the model it is NaN.
        """
        shares = {p.source: p.after if p.test == test else p.share for p in self}
        bounds = shares.pop("numerical") + shares.pop("model")
        squares = (np.nan_to_num(share) ** 2 for share in shares.values())
        return bounds + np.sqrt(sum(squares))

    def _good(self) -> np.ndarray:
        """The points that converged."""
        value = np.broadcast_to(self.value, self.share.shape)[0]
        return np.isfinite(value) & self.converged[0]

    def surer(self) -> tuple[Surer, ...]:
        """The tests that would narrow the band, the one that would most first; then
        those of parts that are not known. Points that did not converge are left out.
        """
        good = self._good()
        tests: list[Surer] = []
        before = float(np.max(self.half_band()[good], initial=0.0))
        for test in dict.fromkeys(self.tests):
            parts = [part for part in self if part.test == test]
            every = np.array([(p.share[good], p.after[good]) for p in parts])
            lost, left = np.isnan(every).any(axis=0).sum(axis=-1).tolist()
            after = np.max(self.half_band(test)[good], initial=0.0)
            after = np.nan if left else float(after)
            lower = after < (np.inf if np.isnan(before) else before * (1 - SMALL))
            if lower or lost:
                tests.append(Surer(test, before, after, lost, left))
        return tuple(sorted(tests, key=lambda each: np.nan_to_num(each.after, nan=1e9)))

    def largest(self) -> list[tuple[float, Part]]:
        """The parts with their largest share, the largest first, unknown ones last."""
        parts = [(float(np.max(part.share)), part) for part in self]
        return sorted(parts, key=lambda each: -np.nan_to_num(each[0], nan=-1.0))

    def headline(self) -> Iterator[tuple[str, str]]:
        """What a command prints below the largest value, of it alone: the band and its
        parts, what these rest on with what is not in the band and the test that would
        narrow it most; and the doubts of all points.
        """
        one = self.at([int(np.where(self._good(), self.value, -np.inf).argmax())])
        left_out = [part.source for part in one if np.isnan(part.share).any()]
        value, half = float(one.value[0, 0]), float(one.half_band()[0])
        ends = [significant(max(value * (1 + x), 0.0), 3) for x in (-half, half)]
        there = "not known" if np.isnan(value * half) else " to ".join(ends)
        parts = (f"{p.source} {percent(x)}" for x, p in one.largest() if x >= SEEN)
        yield "how sure", f"{there} there: {', '.join(parts)}"
        rests = [*self._rests_on()]
        rests += [f"not in the band: {', '.join(left_out)}"] if left_out else []
        rests += [f"surer: {each.words()}" for each in one.surer()[:1]]
        yield "rests on", "; ".join(filter(None, rests))
        yield "doubts", counted_kinds(self.doubts) or "none"

    def findings(self) -> Iterator[tuple[str, str]]:
        """What the curve was computed of, the parts, the band, the tests, the doubts."""
        yield from self.inputs
        yield from ((f"part, {part.source}", part.words()) for part in self)
        yield "band", shares_in_words(self.half_band())
        yield from (("surer", each.words()) for each in self.surer())
        yield from ((doubt.kind, doubt.words()) for doubt in self.doubts)


def computed(
    result: Result, value: Array, error: Array, bound: Array | float, test: str
) -> Iterator[Part]:
    """The parts that every result has, of a value that it shows: numerical error, bound
    of its model, both absolute, rubber, and a temperature that it has not; `test` tells
    how far the model is off.
    """
    size = np.where(np.asarray(value) == 0, 1.0, np.abs(value))
    none = np.zeros(size.shape)
    share = np.asarray(error) / size
    said, closer, left = "error of the computation", "a smaller rtol", none
    given = dict(result.inputs)
    if FITTED in given:
        # which a table of moduli hardly changes: their data stay as they are
        said, closer, left = f"{said} and misfit of the rubber", DRAWS, share
    lines = getattr(result, "lines", None)
    if lines is not None and lines.numerical is not None:
        said, closer = f"{said} and scatter of the lines", "four times as many seeds"
        left = share if lines.scatter is None else share - lines.scatter / size
    if "drawn" in given:  # a median, whose error holds them
        said, closer = f"{said} and 95 % of the draws", closer
    yield Part("numerical", share, said, closer, left)
    yield Part(
        "model",
        np.asarray(bound) / size,
        "its bound, or limits where it has none",
        test,
        none,
    )
    yield unknown("rubber", none, "not computed", DRAWS)
    if getattr(result, "temperature", None) is None:
        yield unknown(
            "temperature", none, "one temperature only", "DMA at several temperatures"
        )


def left_out(result: Result, drawn: bool, road: Iterable[str] = ()) -> str:
    """What the band of a result that was computed once does not hold: moduli that are
    neither `drawn` nor have their misfit in the error, a temperature, those of a road.
    """
    moduli = [] if drawn or FITTED in dict(result.inputs) else ["the moduli"]
    return f"not in the band: {', '.join([*moduli, 'the temperature', *road])}"


def unknown(source: str, value: Array, assumed: str, test: str) -> Part:
    """A part of which nobody knows how much of a value it may change."""
    nowhere = np.full(np.shape(value), np.nan)
    return Part(source, nowhere, assumed, test, nowhere)


def changed(
    shown: np.ndarray, told: Iterable[Doubt], curves: Sequence[Result | None]
) -> tuple[np.ndarray, np.ndarray, str]:
    """The larger change of what is shown, up or down, relative, NaN where one is not
    known; half of the difference, with its sign; and in words where one has no
    prediction though the doubts that were `told` are others.
    """
    lost = np.zeros(shown.shape, bool)
    for curve in filter(None, curves):
        lost |= unforetold(curve.examined(), shown)
    lost &= ~unforetold(told, shown)
    ends = [np.nan if c is None else np.asarray(getattr(c, c.shows)) for c in curves]
    off = relative(shown, ends)
    count = f"; then no prediction at {int(lost.sum())} of {lost.size} points"
    return *off, count if lost.any() else ""


def unforetold(doubts: Iterable[Doubt], mu: Array) -> np.ndarray:
    """The points without prediction, of the shape of mu."""
    there = where(doubts, "no prediction")
    return np.broadcast_to(False if there is None else there, np.shape(mu))
