"""Figures of coefficients, temperatures and shares: curves over velocity, slip,
time or frequency, measured points on them, and a ranking as bars.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from ..checks import as_float64, broadcast_shape, positive, require, significant
from ..errors import InputError
from .axes import Label, Peak, peak
from .doubts import found
from .plotting import (
    FAINT,
    INK,
    PALETTE,
    RED,
    Across,
    Caption,
    Dots,
    Drawable,
    DrawAsk,
    DrawnLine,
    Entry,
    Panels,
    ResultSketch,
    Shaded,
    Sketch,
    Trace,
    dotted,
    draw,
    in_short,
    intervals,
)
from .words import in_unit, in_words, span

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.typing import ColorType

    from .._types import ArrayLike
    from .friction_law import FrictionLaw, Ranked
    from .uncertainty import Uncertainty

    Measured: TypeAlias = Mapping[str, ArrayLike]
    # lower end, median and upper end of draws
    Band: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]

_VISIBLE = 0.004  # part of the figure's height from which an error band can be seen
# distance from a curve's up to which a measured point takes its colour [K]
SAME_TEMPERATURE = 2.0
_UNSTABLE = "#c03030"


def draw_curve(
    result: Drawable,
    ask: DrawAsk,
    measured: Measured | None = None,
    spread: Band | None = None,
) -> Axes:
    """Draws a coefficient against velocity, its largest value marked, the whole
    uncertainty as a band.

    `spread` has the lower end, the median and the upper end of draws, whose median the
    result is.
    """
    points = None if measured is None else as_measured(measured)
    sketch = ResultSketch(result, ask)
    fields = sketch.fields
    below, above, uncertainty = _band(fields, spread)
    lines = list(sketch.lines())
    single = len(lines) == 1 and sketch.alone and lines[0].x.size > 1
    cold = fields.get("cold") if single else None
    hysteresis = fields.get("hysteresis") if single else None
    highest = _highest(fields[sketch.y], cold, points)
    highest_band = highest
    for line in lines:
        top = peak(line.x, line.y)
        drawn = sketch.curve(line)
        if cold is not None:
            look = {"colour": line.colour, "dashes": "--", "width": 0.7, "layer": 2.5}
            x, y = line.x, sketch.along_line(cold, line)
            sketch.add(Trace(x, y, "without heating", silent=True, **look))
        if hysteresis is not None:
            _draw_parts(sketch, line, sketch.along_line(hysteresis, line))
        down, up = (sketch.along_line(half, line) for half in (below, above))
        if (np.fmax(down, up) > _VISIBLE * highest).any():
            highest_band = max(highest_band, float(np.nanmax(line.y + up)))
            _draw_band(sketch, line, drawn, down, up, uncertainty)
        if top is not None and line.x.size > 1 and sketch.style.words:
            _peak_mark(sketch, top, line.colour)
    if points is not None and sketch.along:
        _draw_measured(sketch, points, lines)
    sketch.set_scale()
    before = sketch.before[1][1] if sketch.drawn else 0.0
    sketch.ax.set_ylim(
        0.0, max(1.16 * highest, 1.04 * min(highest_band, 2 * highest), before)
    )
    return sketch.finish()


def _band(
    fields: Mapping[str, np.ndarray], spread: Band | None
) -> tuple[np.ndarray, np.ndarray, str]:
    """How far the band reaches below and above each point, and what it holds."""
    half, uncertainty = _uncertainty(fields)
    below = above = half
    if "mu_low" in fields:
        below, above = fields["mu"] - fields["mu_low"], fields["mu_high"] - fields["mu"]
        if not np.isfinite(fields["model_error"]).any():
            uncertainty = "limits (the model has no bound)"
    if spread is None:
        return below, above, uncertainty
    low, middle, high = spread
    uncertainty = f"95 % of the draws, and {uncertainty}"
    return middle - low + below, high - middle + above, uncertainty


def _uncertainty(fields: Mapping[str, np.ndarray]) -> tuple[np.ndarray, str]:
    """Half the width of the band around each point, and what it holds; none at a point
    whose bound is not known, where others have one.
    """
    error, bound = fields["error"], fields.get("model_error")
    if bound is None:
        return error, "numerical error"
    if not np.isfinite(bound).any():
        return error, "numerical error (the model's is not known)"
    return error + bound, "numerical and model error"


def _highest(
    values: np.ndarray,
    cold: np.ndarray | None,
    points: Mapping[str, np.ndarray] | None,
) -> float:
    """The highest point of curves and measurement, above zero."""
    values = values if cold is None else np.fmax(values, cold)
    highest = float(np.fmax.reduce(values, axis=None, initial=0.0)) or 1.0
    return highest if points is None else max(highest, float(points["mu"].max()))


def _draw_parts(sketch: Sketch, line: DrawnLine, border: np.ndarray) -> None:
    """Hysteresis below and adhesive shear above it, as areas under a single curve."""
    below, above = 0.0 * border, line.y
    for low, high, label, colour in (
        (below, border, "hysteresis", PALETTE[2]),
        (border, above, "adhesive shear", PALETTE[1]),
    ):
        sketch.add(Shaded(line.x, low, high, label, colour, opacity=0.35, layer=1.5))


def _draw_band(
    sketch: Sketch,
    line: DrawnLine,
    drawn: Trace,
    down: np.ndarray,
    up: np.ndarray,
    label: str,
) -> None:
    """The uncertainty, of a single point as a bar."""
    if line.x.size > 1:
        ends = np.maximum(line.y - down, 0.0), line.y + up
        label = label if sketch.style.words else ""
        sketch.add(Shaded(line.x, *ends, label, colour=line.colour, of=drawn))
    else:
        sketch.add(intervals(line.x, line.y - down, line.y + up, line.colour))


def _peak_mark(sketch: Sketch, top: Peak, colour: str) -> None:
    sketch.add(
        Dots(
            np.array([top.x]),
            np.array([top.y]),
            colour=colour,
            size=3.0,
            silent=True,
        )
    )


def as_measured(measured: Measured) -> dict[str, np.ndarray]:
    """Measured points as lists: "velocity" [m/s], "mu" and, if known, "temperature"
    [K], which broadcast.

    Raises `InputError`.
    """
    known = {"velocity", "mu", "temperature"}
    if (
        not isinstance(measured, Mapping)
        or not {"velocity", "mu"} <= set(measured) <= known
    ):
        got = sorted(measured) if isinstance(measured, Mapping) else repr(measured)
        raise InputError(
            argument="measured",
            got=got,
            accepted='a mapping with "velocity" [m/s], "mu" and, if known, '
            '"temperature" [K]',
        )
    points = {
        f"measured {name}": as_float64(f"measured {name}", values)
        for name, values in measured.items()
    }
    positive("measured velocity", points["measured velocity"])
    require("measured mu", points["measured mu"], "finite", np.isfinite)
    shape = broadcast_shape(points)
    return {
        name: np.broadcast_to(points[f"measured {name}"], shape).ravel()
        for name in measured
    }


def _draw_measured(
    sketch: ResultSketch, points: Mapping[str, np.ndarray], lines: list[DrawnLine]
) -> None:
    """Draws points in the colour of the curve at their temperature, in black where
    there is none.
    """
    v, mu = points["velocity"], points["mu"]
    measured_at = points.get("temperature")
    computed_at = sketch.fields.get("temperature")
    left = np.ones(mu.shape, dtype=bool)

    def mark(chosen: np.ndarray, mark: str, colour: str, of: str) -> None:
        if chosen.any():
            label = f"measured{', ' * bool(of)}{of}"
            sketch.add(
                Dots(
                    v[chosen],
                    mu[chosen],
                    label,
                    colour=colour,
                    mark=mark,
                    size=2.8,
                    hollow="white",
                )
            )

    if measured_at is None:
        mark(left, "s", INK, "")
        return
    for line in lines:
        if computed_at is None:
            break
        temperature = np.atleast_1d(computed_at[line.curve.place])
        near = np.abs(measured_at - temperature[0]) <= SAME_TEMPERATURE
        near &= left & (np.ptp(temperature) == 0)
        mark(near, "o", line.colour, in_words("temperature", float(temperature[0])))
        left &= ~near
    note = " (no curve)" if computed_at is not None else ""
    mark(left, "s", INK, f"{span(in_unit(measured_at[left], '°C'), 'degC')}{note}")


def grouped(temperature: np.ndarray) -> list[float]:
    """The means of temperatures that belong together, ascending [K]."""
    ascending = np.sort(np.ravel(temperature))
    runs = np.split(
        ascending, np.flatnonzero(np.diff(ascending) > SAME_TEMPERATURE) + 1
    )
    return [float(run.mean()) for run in runs if run.size]


def draw_traction(result: Drawable, ask: DrawAsk) -> Axes:
    """Draws traction against creepage or slip, as it was given; dashed what a contact
    has that slips all over.
    """
    fields = {q.key: values for q, values in result.fields().items()}
    x = "slip" if "slip" in fields else "creepage"
    friction = fields["friction"]
    constant = bool(np.isfinite(friction).all() and np.ptp(friction) == 0)
    sign = -1.0 if np.nanmin(fields[x]) < 0 else 1.0

    def full_slip(sketch: ResultSketch, line: DrawnLine, _: Trace) -> None:
        most = sketch.along_line(friction, line)
        if constant and line.curve is sketch.curves[0]:
            for bound in {float(most[0]), sign * float(most[0])}:
                sketch.add(Across(y=bound, dashes="--"))
        if sketch.along and np.isfinite(most).all() and np.ptp(most) > 0:
            limit = np.where(line.x == 0, np.nan, np.sign(line.x) * most)
            sketch.add(
                Trace(
                    line.x, limit, colour=line.colour, dashes="--", width=0.5, layer=1.0
                )
            )
            sketch.explain("full slip", "--")
            top = peak(line.x, np.abs(line.y))
            if top is not None and top.inside:  # at an end the largest may lie beyond
                i = int(np.flatnonzero(line.x == top.x)[0])
                _peak_mark(sketch, Peak(top.x, float(line.y[i]), True), line.colour)

    return draw(result, ask, x=x, also=full_slip)


def draw_break_out(result: Drawable, ask: DrawAsk, y: str) -> Axes:
    """Draws the break-out coefficient or the real contact against the dwell, the whole
    uncertainty as a band: that of both is relatively the same.
    """

    def band(sketch: ResultSketch, line: DrawnLine, drawn: Trace) -> None:
        *ends, uncertainty = _band(sketch.fields, None)
        below, above = (
            sketch.along_line(end / sketch.fields["mu"], line) * line.y for end in ends
        )
        _draw_band(sketch, line, drawn, below, above, uncertainty)

    return draw(result, ask, y=y, also=band)


def draw_heat_build_up(result: Drawable, ask: DrawAsk) -> Axes:
    """Draws temperature against time, with the steady one dotted, or the steady one
    against velocity.
    """
    over_time = any(q.path == "time" for q in result.quantities())

    def steady(sketch: ResultSketch, line: DrawnLine, _: Trace) -> None:
        if over_time:
            temperature = in_unit(sketch.fields["steady"][line.curve.place], "°C")
            at = float(np.ravel(temperature)[0])
            sketch.add(Across("steady", y=at, colour=line.colour, dashes=":"))

    return draw(result, ask, x="time" if over_time else "velocity", also=steady)


def draw_stability(result: Drawable, ask: DrawAsk) -> Axes:
    """Draws the damping ratio against velocity; dotted where friction does not follow,
    shaded where swings grow.
    """
    sketch = ResultSketch(result, ask)
    for line in sketch.lines():
        follows = sketch.along_line(sketch.fields["follows"], line)
        counts = follows & np.isfinite(line.y)
        # what decides lies on top
        sketch.add(Trace(line.x, line.y, colour=line.colour, dashes=":", width=0.7))
        sketch.curve(
            line._replace(y=np.where(counts, line.y, np.nan)),
            mark="o" if counts.sum() == 1 else "",
        )
        unstable = counts & (line.y < 0)
        # between two points there is an area, at one there is none
        if unstable.sum() == 1:
            sketch.add(Dots(line.x[unstable], line.y[unstable], colour=_UNSTABLE))
        if unstable.any():
            below = np.where(counts, np.minimum(line.y, 0.0), np.nan)
            sketch.add(Shaded(
                *(line.x, below, 0.0 * below), "swings grow", colour=_UNSTABLE,
                opacity=0.3, layer=1.0,
            ))  # fmt: skip
    slowest = float(sketch.fields["slowest"])
    label = r"$\lambda\sqrt{k/m}$: below it the ratio is not valid"
    sketch.add(Across(label, x=slowest, dashes="--"))
    sketch.add(Across(y=0.0))
    return sketch.finish()


def draw_dissipation(result: Drawable, ask: DrawAsk) -> Axes:
    """Draws shares against relaxation time, one line per point that converged."""
    sketch = ResultSketch(result, ask)
    for line in sketch.lines():
        if not sketch.along_line(sketch.fields["converged"], line).all():
            continue
        dashpot, label = line.si == 0, line.curve.label
        if dashpot.any():
            share = f"dashpot {significant(float(line.y[dashpot][0]), 2)} %"
            label = f"{label}, {share}" if label else share
        kept = {"x": line.x[~dashpot], "y": line.y[~dashpot]}
        line = line._replace(**kept, dotted=line.dotted[~dashpot])
        sketch.curve(line, label, "o")
    sketch.set_scale()
    sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def draw_friction_spectrum(
    result: Drawable, ask: DrawAsk, width: float, colour: ColorType | None = None
) -> Axes:
    """Draws the part of mu per decade of frequency as steps: the area under a line is
    its friction coefficient; `width` is the upper frequency of a band over its lower.
    """
    from matplotlib.colors import to_hex

    sketch = ResultSketch(result, ask)
    half, limits = np.sqrt(width), []
    highest = np.nanmax(sketch.fields["mu"], initial=0.0)
    for line in sketch.lines():
        edges = np.append(line.x / half, line.x[-1] * half)
        x, y = np.repeat(edges, 2)[1:-1], np.repeat(line.y / np.log10(width), 2)
        only = to_hex(colour) if colour and len(sketch.curves) == 1 else None
        sketch.add(
            Trace(x, y, line.curve.label, colour=only or line.colour, is_curve=True)
        )
        seen = line.x[line.y > 0.01 * highest]
        limits += [seen.min() / half, seen.max() * half] if seen.size else []
    sketch.set_scale()
    if limits:
        low, high = sketch.before[0] if sketch.canvas.entries else (np.inf, 0.0)
        sketch.ax.set_xlim(min(low, *limits), max(high, *limits))
    sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def draw_amplitudes(result: Drawable, ask: DrawAsk) -> Axes:
    """Draws the amplitudes of a force as a spectrum of lines."""
    sketch = ResultSketch(result, ask)
    for line in sketch.lines():
        low = np.nanmax(line.y, initial=0.0) * 1e-4 or 1e-300
        y = np.maximum(line.y, low)
        sketch.add(intervals(line.x, 0.0 * y + low, y, colour=line.colour))
        sketch.add(Trace(
            line.x, y, line.curve.label, colour=line.colour, dashes="", mark="o",
            is_curve=True,
        ))  # fmt: skip
    sketch.ax.set_yscale("log")
    return sketch.finish()


def draw_ranking(
    ranked: Sequence[tuple[Ranked, FrictionLaw, int]],
    where: str,
    velocity: float,
    at: Mapping[str, float],
    ask: DrawAsk,
) -> Axes:
    """Friction of each material against velocity, where a ranking holds, and the
    ranking as bars; with each place its law and its number in the figure of the curve.
    """
    heading = f"Ranking at {where}".replace("degC", "°C")
    names = Label("Sliding velocity", "m/s"), Label("Friction coefficient", "-")
    entry = Entry(heading, heading, names, asked=DrawAsk(title=ask.title))
    sketch = Sketch(ask, entry, Panels(2, 1, heights=(1.6, 1.0)))
    bars = sketch.canvas.panels[1]
    known = [place.mu for place, _, _ in ranked if np.isfinite(place.mu)]
    margin = 0.01 * max(known, default=1.0)
    sketch.ax.set_xscale("log")
    by_material = []
    for i, (place, law, number) in enumerate(ranked):
        colour = PALETTE[number % len(PALETTE)]
        v = np.asarray(law.velocity)
        doubts = law.doubts_at(velocity=v, **at)
        by_material.append((place.material, found(doubts)))
        points = dotted(doubts, v.shape)
        sketch.add(Trace(v, np.asarray(law(v, **at)), colour=colour, dotted=points))
        _draw_bar(sketch, bars, i, place, colour, margin)
    entry.notes += in_short(by_material)
    sketch.add(Across(x=velocity, colour=FAINT, dashes=":"))
    sketch.ax.set_ylim(0, None)
    bars.set(yticks=[], xlabel="Friction coefficient [-]")
    bars.set(xlim=(0, None), ylim=(len(ranked) - 0.5, -0.75))
    bars.locator_params(axis="x", nbins=5)
    return sketch.finish()


def _draw_bar(
    sketch: Sketch, ax: Axes, i: int, place: Ranked, colour: str, margin: float
) -> None:
    """One material of a ranking, its name above the bar."""
    ends, half = np.array([0.0, place.mu]), np.full(2, 0.25)
    sketch.add(Shaded(ends, i - half, i + half, opacity=1.0, colour=colour, ax=ax))
    if np.isfinite(place.uncertainty):
        ends = place.mu + place.uncertainty * np.array([-1.0, 1.0])
        sketch.add(Trace(ends, np.full(2, i), width=0.6, mark="|", ax=ax))
    name = place.material
    if place.significant is False:
        name += " (lead not significant)"
    elif place.significant is None and not np.isnan(place.ahead):
        name += " (significance not known)"
    sketch.add(
        Caption(
            name,
            margin,
            i - 0.3,
            colour=RED if place.significant is False else INK,
            side="left",
            offset=(0, 0),
            ax=ax,
        )
    )


def draw_parts(table: Uncertainty, ask: DrawAsk) -> Axes:
    """What a number rests on: the share of each part as a bar, up to the largest of any
    point, dark up to the smallest.
    """
    title = table.title
    entry = Entry(
        title, title, (Label("Share of the friction coefficient", "%"), Label(""))
    )
    sketch, half = Sketch(ask, entry), np.full(2, 0.25)
    for i, (name, share) in enumerate(zip(table.sources, table.share, strict=True)):
        known = 100 * share[np.isfinite(share)]
        for end, opacity in (
            (known.min(initial=np.inf), 1.0),
            (known.max(initial=0.0), 0.4),
        ):
            reach = np.array([0.0, end if known.size else 0.0])
            bar = Shaded(reach, i - half, i + half, "", PALETTE[0], opacity=opacity)
            sketch.add(bar)
        name += "" if known.size == share.size else " (not known)"
        sketch.add(Caption(name, 0.0, i - 0.3, side="left", offset=(2, 0)))
    sketch.ax.set(yticks=[], xlim=(0, None), ylim=(len(table.sources) - 0.5, -0.75))
    return sketch.finish()
