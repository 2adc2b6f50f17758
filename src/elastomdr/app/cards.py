"""A result in a few cards: the peak, at which speed, how sure, and what would make it
surer.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from nicegui import ui

from ..checks import significant
from ..results.axes import Curve, peak
from ..results.curve import AbstractCurve

_MOST = 4  # curves that get a card
_FINE = 0.02  # relative uncertainty from which on a number needs nothing surer


class Card(NamedTuple):
    """A number with what it is and what there is to say of it."""

    title: str
    number: str
    notes: tuple[str, ...]


class _Top(NamedTuple):
    """The largest value of a curve, and how sure it is."""

    name: str
    x: float
    y: float
    inside: bool
    slow: bool  # whether it is at the lowest velocity
    error: float  # numerical, and what the rubber's fit misses of its data
    model_error: float  # NaN where it is not known
    extrapolated: bool

    @property
    def spread(self) -> float:
        """The uncertainty that is known."""
        return self.error + float(np.nan_to_num(self.model_error))

    def share(self, uncertainty: float) -> float:
        """Relative to the value; 0 where that is 0, as of elastic bodies."""
        return float(np.nan_to_num(uncertainty)) / abs(self.y) if self.y else 0.0

    @property
    def place(self) -> str:
        """Where it is, and what that is worth."""
        where = f"at {significant(self.x, 3)} m/s"
        if self.inside:
            return where
        return f"{where}, the {'lowest' if self.slow else 'highest'} velocity computed"


def cards(result: Any) -> list[Card]:
    """The cards of a result; none of a kind that has no curve over velocity."""
    if hasattr(result, "places"):  # a ranking
        return [_first(result)]
    if not isinstance(result, AbstractCurve) or result.materials:
        return []
    axis, curves = result.curves()
    if axis.name != "velocity":
        return []
    tops = [top for curve in curves if (top := _top(result, curve)) is not None]
    if not tops:
        return []
    symbol = "µ" if result.symbol == "mu" else result.symbol
    shown = [
        Card(
            " ".join(
                filter(
                    None,
                    (f"{'Peak' if top.inside else 'Largest'} {symbol}", top.name),
                )
            ),
            f"{significant(top.y, 3)}{_in_brackets(top)}",
            (top.place,),
        )
        for top in tops[:_MOST]
    ]
    return [*shown, _how_sure(tops), _surer(tops)]


def show(place: Any, new_cards: list[Card]) -> None:
    """Shows cards in the place of the ones before."""
    place.clear()
    with place:
        for card in new_cards:
            with ui.element("section").classes("result"):
                ui.label(card.title).classes("about")
                if card.number:
                    ui.label(card.number).classes("number")
                for note in card.notes:
                    ui.label(note).classes("about")


def _first(ranking: Any) -> Card:
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
    where = ranking.where().replace("degC", "°C")
    return Card("Most friction", number, (f"at {where}", lead))


def _top(result: AbstractCurve, curve: Curve) -> _Top | None:
    """The largest value of a curve; None where no point converged."""
    fields = {quantity.key: values for quantity, values in result.fields().items()}

    def along(key: str, default: float) -> np.ndarray:
        values = fields.get(key, np.full(fields["error"].shape, default))
        return np.atleast_1d(values[curve.place])

    x, y = along("velocity", np.nan), along(result.shows, np.nan)
    order = np.argsort(x, kind="stable")
    top = peak(x[order], y[order])
    if top is None:
        return None
    i = int(np.flatnonzero((x == top.x) & (y == top.y))[0])
    return _Top(
        f"at {curve.label}".replace("degC", "°C") if curve.label else "",
        top.x,
        top.y,
        top.inside,
        top.x == np.nanmin(x),
        float(along("error", 0.0)[i]),
        float(along("model_error", np.nan)[i]),
        bool(along("extrapolated", 0.0)[i]),
    )


def _in_brackets(top: _Top) -> str:
    return f" ± {significant(top.spread, 2)}" if top.spread > 0 else ""


def _how_sure(tops: list[_Top]) -> Card:
    """The largest relative uncertainty of the peaks, with its parts."""
    worst = max(tops, key=lambda top: top.share(top.spread))
    share = worst.share(worst.spread)
    notes = [
        f"computation and fit of the rubber {significant(worst.error, 2)}",
        "model: no bound is known here"
        if np.isnan(worst.model_error)
        else f"model at most {significant(worst.model_error, 2)}",
    ]
    if any(top.extrapolated for top in tops):
        notes.append("in part outside the measured range of the rubber")
    return Card("How sure", f"± {significant(100 * share, 2)} %", tuple(notes))


def _surer(tops: list[_Top]) -> Card:
    """What would make the peaks surer, what matters most first."""
    ways = list(_ways(tops)) or ["Nothing: the uncertainty is small."]
    return Card("What would make it surer", "", tuple(ways))


def _ways(tops: list[_Top]) -> Iterator[str]:
    if any(top.extrapolated for top in tops):
        yield "Moduli measured at more temperatures and frequencies."
    if any(not top.inside and not top.slow for top in tops):
        yield "Higher velocities: a peak may lie beyond the highest."
    if any(not top.inside and top.slow for top in tops):
        yield "Lower velocities: a peak may lie below the lowest."
    bound = max(top.share(top.model_error) for top in tops)
    error = max(top.share(top.error) for top in tops)
    if any(np.isnan(top.model_error) for top in tops) or bound > max(_FINE, error):
        yield "Measured friction, to compare with: drop it on the friction screen."
    if error > _FINE:
        yield "A fit closer to the moduli, or a smaller relative tolerance."
