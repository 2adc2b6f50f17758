"""A result in a few cards: the peak, at which speed, how sure, and what would make it
surer.
"""

import asyncio
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from nicegui import background_tasks, ui

import elastomdr as em

from ..checks import percent, significant
from ..errors import InputError
from ..results.axes import Axis, Curve, peak
from ..results.base import Result
from ..results.curve import AbstractCurve, Ranking
from ..results.uncertainty import SMALL, Uncertainty, computed
from ..results.words import in_words
from .scene import CancelledError, Done
from .session import COMPUTING
from .stage import Busy
from .words import spoken, with_signs

_MOST = 4  # curves that get a card
_LONG = 4  # lines from which on a card is a wide one
_AS_SHOWN = {"Pa": ("MPa", 1e-6), "m^3": ("mm³", 1e9)}  # units, and SI ones in them
_UNKNOWN = "no prediction"
_HERE = {  # what a doubt of one value is called
    _UNKNOWN: "no bound of the model is known here",
    "extrapolated": "the rubber was not measured here",
    "hot branch": "a second, hotter state exists here",
    "bound": "the bound of the model is above half of it",
    "estimate": "an estimate",
}
_KINDS = {  # and one of several, where its kind alone does not say it
    _UNKNOWN: "no bound of the model",
    "bound": "bound of the model above half of the value",
    "hot branch": "a second, hotter state",
    "illustrative": "illustrative moduli",
}
_REMEDIES = {  # in place of the doubt's own, which stands behind its points
    _UNKNOWN: "",  # a measured value, which is said where the bound is wide as well
    "extrapolated": "moduli measured at more temperatures and frequencies",
}
AWAITED = "what road, shear and temperature change is being computed"
_TEST = "a measured value to compare with"


class Card(NamedTuple):
    """A number with what it is and what there is to say of it."""

    title: str
    number: str
    notes: tuple[str, ...]


class _Top(NamedTuple):
    """The value of a curve that counts, the largest or the last, and how sure it is."""

    name: str
    place: str  # where it is, and what that is worth
    y: float
    inside: bool
    slow: bool  # whether it is at the low end of the axis
    error: float  # numerical; with what the rubber's fit misses where `_knows_fit`
    model_error: float  # NaN where it is not known
    doubts: tuple[em.Doubt, ...]
    place_in_result: int  # in its arrays, flattened

    @property
    def spread(self) -> float:
        """The uncertainty; NaN where no bound of the model is known."""
        return self.error + self.model_error

    def doubted(self) -> Iterator[str]:
        """What there is to doubt in the value, in short."""
        kinds = dict.fromkeys(doubt.kind for doubt in self.doubts)
        return (_HERE[kind] for kind in kinds if kind in _HERE)

    def share(self, uncertainty: float) -> float:
        """Relative to the value; 0 where that is 0, as of elastic bodies."""
        known = uncertainty if np.isfinite(uncertainty) else 0.0
        return known / abs(self.y) if self.y else 0.0


def cards(
    result: Result | Ranking, parts: Uncertainty | None = None, *, awaited: bool = False
) -> list[Card]:
    """The cards of a result; none of several materials at once. With what its
    uncertainty consists of, where that is known or `awaited`.
    """
    if isinstance(result, Ranking):
        return [_first(result)]
    if result.materials:
        return []
    along = "time" if getattr(result, "time", None) is not None else "velocity"
    axis, curves = result.curves(along)
    tops = [top for curve in curves if (top := _top(result, axis, curve)) is not None]
    if not tops:
        return []
    shown = [
        Card(
            " ".join(filter(None, (_title(result, top), top.name))),
            f"{_number(result, top.y)}{_in_brackets(result, top)}",
            tuple(filter(None, (top.place, _of_brackets(top), *top.doubted()))),
        )
        for top in tops[:_MOST]
    ]
    more = len(curves) - len(shown)
    if more:
        failed = len(curves) - len(tops)
        notes = ("in the figure",) if more > failed else ()
        notes += (f"{failed} without a converged point",) if failed else ()
        curve = "curve" if more == 1 else "curves"
        shown.append(Card(f"And {more} more {curve}", "", notes))
    table = _known(result) if parts is None else parts
    table = table.at([top.place_in_result for top in tops])
    notes = [f"{p.source} {percent(x)}: {p.assumed}" for x, p in table.largest()]
    notes += [*_counted(result), *[AWAITED] * awaited]
    tests = (spoken(each.words()) for each in table.surer())
    ways = [f"{way[0].upper()}{way[1:]}." for way in tests]
    if isinstance(result, em.ORing):
        ways = ["Whether the groove keeps the ring at its length: choose held or free."]
    ways += _ends(result, axis, tops)
    half = float(np.max(table.half_band()))
    number = f"± {percent(half)}" if half > 1e-3 else percent(half)
    if isinstance(result, em.Leak):
        number = f"a factor of {significant(1 + half, 2)}"
    return [
        *shown,
        Card("How sure", number, tuple(notes)),
        Card("What would make it surer", "", tuple(dict.fromkeys(ways))),
    ]


def _known(result: Result) -> Uncertainty:
    """What is known of a result without computing more."""
    error, bound = _errors(result)
    value = getattr(result, result.shows)
    parts = computed(result, value, error, bound, _TEST)
    return Uncertainty.of(parts, result, result.doubts)


def _title(result: Result, top: _Top) -> str:
    """What is shown of a curve."""
    if isinstance(result, AbstractCurve | em.Lubricated):
        symbol = "µ" if result.shows == "mu" else result.shows
        return f"{'Peak' if top.inside else 'Largest'} {symbol}"
    label = _shown(result).label
    return label.capitalize() if isinstance(result, em.ORing) else f"Largest {label}"


def _shown(result: Result) -> Any:
    """The quantity that the figure shows."""
    return next(each for each in result.fields() if each.key == result.shows)


def _number(result: Result, value: float) -> str:
    """A value with its unit."""
    unit = _shown(result).unit
    if unit == "K":
        return f"{value - 273.15:.1f} °C"
    unit, scale = _AS_SHOWN.get(unit, (unit.replace("^3", "³"), 1.0))
    return f"{significant(scale * value, 3)} {unit}".rstrip(" -")


class Cards:
    """A place for the cards of a result; what its uncertainty consists of is computed
    once they are shown.
    """

    def __init__(self) -> None:
        self._place = ui.element("div").classes("results")
        self._judging = Busy(gives_way=True)
        self._done: Done | None = None

    def show(self, done: Done | None, *, judged: bool = True) -> None:
        """Shows the cards of a result in the place of those before."""
        self._judging.stop()
        self._done = done
        awaited = done is not None and done.judges and judged
        self._draw(awaited)
        if done is not None and awaited:
            background_tasks.create(self._judge(done), name="judge a result")

    async def _judge(self, done: Done) -> None:
        while self._done is done and done.judges:
            if self._judging.on:
                await asyncio.sleep(0.01)
                continue
            try:
                await self._judging.during(COMPUTING, done.judge, quiet=True)
            except CancelledError:
                continue  # behind what is asked for
            except InputError:
                break  # the cards say what is known without
        if self._done is done:
            self._draw(False)

    def _draw(self, awaited: bool) -> None:
        done = self._done
        drawn = [] if done is None else cards(done.shown, done.parts, awaited=awaited)
        self._place.clear()
        with self._place:
            for card in drawn:
                wide = "result" if len(card.notes) < _LONG else "result wide"
                with ui.element("section").classes(wide):
                    ui.label(with_signs(card.title)).classes("about")
                    if card.number:
                        ui.label(with_signs(card.number)).classes("number")
                    for note in card.notes:
                        ui.label(with_signs(note)).classes("about")


def _first(ranking: Ranking) -> Card:
    """The rubber with most friction, and whether its lead is significant."""
    best = ranking.places[0]
    known = (
        "" if np.isnan(best.uncertainty) else f" ± {significant(best.uncertainty, 2)}"
    )
    lead = {
        True: "its lead is significant",
        False: "its lead is not significant",
        None: "whether its lead is significant is not known",
    }[best.significant]
    number = f"{best.material}: {significant(best.mu, 3)}{known}"
    kinds = dict.fromkeys(map(_called, best.doubts))
    return Card("Most friction", number, (f"at {ranking.where()}", lead, *kinds))


def _top(result: Result, axis: Axis, curve: Curve) -> _Top | None:
    """The largest value of a curve, of an O-ring the last; None where no point
    converged.
    """
    fields = {quantity.key: values for quantity, values in result.fields().items()}

    def along(values: Any) -> np.ndarray:
        return np.atleast_1d(np.broadcast_to(values, result.error.shape)[curve.place])

    y = along(getattr(result, result.shows))
    key = axis.quantity.key if axis.quantity is not None else ""
    x = along(fields[key]) if key else np.arange(float(y.size))
    order = np.argsort(x, kind="stable")
    if isinstance(result, em.ORing):
        order = order[-1:]
    top = peak(x[order], y[order])
    if top is None:
        return None
    i = int(np.flatnonzero((x == top.x) & (y == top.y))[0])
    error, bound = _errors(result)
    return _Top(
        with_signs(f"at {curve.label}") if curve.label else "",
        _place(axis, top, x),
        top.y,
        top.inside,
        top.x == np.nanmin(x),
        float(along(error)[i]),
        float(along(bound)[i]),
        tuple(doubt for doubt in result.doubts if along(doubt.points)[i]),
        int(along(np.arange(result.error.size).reshape(result.error.shape))[i]),
    )


def _errors(result: Result) -> tuple[Any, Any]:
    """Numerical error and bound of the model, of what the figure shows."""
    bound = getattr(result, "model_error", None)
    bound = np.nan if bound is None else bound
    if isinstance(result, em.Leak):  # relative
        with np.errstate(invalid="ignore"):  # of a leak that is zero
            factor = np.where(np.isinf(bound), np.inf, bound * result.rate)
        return result.error * result.rate, factor
    if isinstance(result, em.ORing):  # of the load
        scale = result.pressure / result.line_load
        return result.error * scale, bound * scale
    if isinstance(result, em.Reciprocating):
        return result.net_leak_error, np.nan
    if isinstance(result, em.Conveyor):  # its own are of the coefficient
        return result.errors()
    return result.error, bound


def _place(axis: Axis, top: Any, x: np.ndarray) -> str:
    """Where a value is, and what that is worth."""
    if axis.quantity is None or x.size < 2:
        return ""
    if axis.name == "time":
        return f"after {_duration(top.x)}"
    slow = top.x == np.nanmin(x)
    velocity = axis.quantity.unit == "m/s"
    name = "velocity" if velocity else axis.name
    value = float(significant(top.x, 3)) if velocity else top.x  # not of kelvins
    where = f"at {in_words(name, value, axis.quantity.unit)}"
    if top.inside:
        return where
    return f"{where}, the {'lowest' if slow else 'highest'} {name} computed"


def _duration(seconds: float) -> str:
    """A time in the largest unit of which it is one or more."""
    units = (("years", 31_557_600), ("days", 86_400), ("h", 3600), ("min", 60))
    name, size = next((each for each in units if seconds >= 0.99 * each[1]), ("s", 1))
    return f"{significant(seconds / size, 3)} {name}"


def _of_brackets(top: _Top) -> str:
    """What the uncertainty behind a number is of, where it stands there."""
    seen = top.share(top.spread) >= 0.1 * SMALL
    return "its band is of model and computation alone" if seen else ""


def _in_brackets(result: Result, top: _Top) -> str:
    """The uncertainty behind a number, where it is known and can be seen in its digits."""
    if not _of_brackets(top):
        return ""
    if isinstance(result, em.Leak):
        factor = 1 + top.share(top.spread)
        return f" within a factor of {significant(factor, 2)}"
    _, scale = _AS_SHOWN.get(_shown(result).unit, ("", 1.0))
    return f" ± {significant(scale * top.spread, 2)}"


def _counted(result: Result) -> Iterator[str]:
    """The doubts, and of how many points each is."""
    for doubt in result.doubts:
        points = f"{int(doubt.points.sum())} of {doubt.points.size} points"
        yield f"{_called(doubt)}: {points}"


def _called(doubt: em.Doubt) -> str:
    """What a doubt of several values is called."""
    return _KINDS.get(doubt.kind, doubt.kind)


def _ends(result: Result, axis: Axis, tops: list[_Top]) -> Iterator[str]:
    """What the doubts ask for, and peaks at the end of what was computed."""
    remedies = (_REMEDIES.get(doubt.kind, doubt.remedy) for doubt in result.doubts)
    yield from (f"{r[0].upper()}{r[1:]}." for r in dict.fromkeys(remedies) if r)
    if axis.name == "velocity" and isinstance(result, AbstractCurve):
        if any(not top.inside and not top.slow for top in tops):
            yield "Higher velocities: a peak may lie beyond the highest."
        if any(not top.inside and top.slow for top in tops):
            yield "Lower velocities: a peak may lie below the lowest."
