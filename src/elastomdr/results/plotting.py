"""Figures of results, in two styles; matplotlib is loaded when something is drawn.

A `Sketch` is one result on its way onto axes. What has been drawn on the same axes
before is kept with them, so that title, notes and legend are made anew for all of it:
the legend names what the results differ in.
"""

import io
import textwrap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..checks import as_float64, positive, require, significant
from ..errors import InputError
from .axes import Axis, Curve, Peak, peak
from .words import in_unit, in_words

PALETTE = (
    "#1f5a94",
    "#c8702a",
    "#3c8d53",
    "#8a4fa0",
    "#b03a2e",
    "#5a6470",
    "#b59a2b",
    "#2a9d9d",
)
INK, FAINT, RED, GRID = "#222222", "#666666", "#a02020", "#dddddd"
_VISIBLE = 0.004  # part of the figure's height from which an error band can be seen
_LIGHT = 0.16  # opacity of a band
# curves of one result that a legend names; of more, it names as many, evenly spread
_LEGEND = 12
# ratio of the largest to the smallest value from which on an axis may be logarithmic
_LOG = 20.0
# distance from a curve's up to which a measured point takes its colour [K]
SAME_TEMPERATURE = 2.0
# markers of measured points by temperature, where nothing was computed
_WITHOUT_CURVE = "s^Dv<>"
# ratio of the ends of a logarithmic axis up to which its ticks are those of a linear
# one
_FEW = 12.0
# largest over middle interval from which instants are taken as spread over decades
_DECADES = 30.0
DOTTED = "dotted: beyond the range of the material's data"


class Style(NamedTuple):
    """Sizes of a figure."""

    size: tuple[float, float]  # [inches]
    wide: float  # width with a legend beside the axes [inches]
    panels: tuple[float, float]  # size with four panels [inches]
    text: float  # size of the labels' letters [points]
    line: float  # width of a curve [points]
    # whether there is a title, the model's name and notes, and values in the legend
    words: bool
    dpi: int
    settings: dict[str, Any]


_FINE = {
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "axes.labelpad": 2.0,
}
STYLES = {
    None: Style((6.6, 4.4), 8.6, (9.6, 6.6), 10.0, 1.8, True, 200, {}),
    # a column of 85 mm
    "paper": Style((3.346, 2.3), 3.346, (3.346, 3.2), 7.5, 1.1, False, 300, _FINE),
}


class Ask(NamedTuple):
    """How a result is to be drawn."""

    ax: Any = None
    style: str | None = None
    title: str | None = None
    label: str | None = None
    group: bool = False  # whether it is one of several materials


@dataclass
class Entry:
    """What has been drawn of one result."""

    heading: str
    title: str
    model: str
    inputs: dict[str, str]
    asked: Ask
    each: str
    counted: tuple[int, int]
    labels: tuple[str, str]  # of the axes, for this result alone
    # artist, what the curve is, what is to see
    lines: list[tuple[Any, str, str]] = field(default_factory=list)
    extras: list[tuple[Any, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass
class Canvas:
    """What has been drawn on axes, and what has to be made anew when more is drawn."""

    style: Style
    own: bool  # the figure was made here
    foreign: bool  # something was drawn before
    panels: list[Any] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)
    limits: Any = None  # of x and y, as they were left
    heading: list[Any] = field(default_factory=list)  # artists of the title
    # artists that are right while there is one result
    single: list[Any] = field(default_factory=list)


class Sketch:
    """One result on its way onto axes."""

    def __init__(
        self,
        result: Any,
        ask: Ask,
        x: str = "",
        y: str = "",
        panels: dict[str, Any] | None = None,
        labels: tuple[str, str] = ("", ""),
    ):
        self.result, self.ask = result, ask
        self.fields = {q.key: values for q, values in result.fields().items()}
        self.about = {q.key: q for q in result.quantities()}
        self.x, self.y = x or result.across, y or result.shows
        self.axis, self.curves = result.curves(result.last or self.x)
        # x has values of its own
        self.along = (
            bool(result.last) or self.axis.name == self.x or not self.axis.known
        )
        about = self.about[self.x] if self.along else self.axis.quantity
        names = about.axis_label if about else self.axis.name.capitalize()
        labels = labels[0] or names, labels[1] or self.about[self.y].axis_label
        self.ax, self.canvas = begin(ask, panels)
        self.labels = [
            _together([e.labels[i] for e in self.canvas.entries] + [labels[i]])
            for i in (0, 1)
        ]
        self.before = self.ax.get_xlim(), self.ax.get_ylim()
        if self.canvas.limits == self.before:  # nobody has set others since
            self.ax.autoscale()
        self.entry = Entry(
            result.heading(),
            result.title,
            result.model,
            dict(result.inputs),
            ask,
            result.each,
            result.counted(),
            labels,
        )
        self.alone = (
            not self.canvas.entries and not self.canvas.foreign and not ask.group
        )
        self.style = self.canvas.style

    def colours(self, count: int) -> list[Any]:
        """Of the curves: shades of one colour, of viridis where there is one result."""
        k = len(self.canvas.entries) + self.canvas.foreign
        own = PALETTE[k % len(PALETTE)]
        if count == 1:
            return [own]
        import matplotlib
        from matplotlib.colors import to_rgb

        if k == 0 and not self.ask.group:
            return list(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, count)))
        return [
            tuple(1 - (1 - np.array(to_rgb(own))) * (1 - pale))
            for pale in np.linspace(0.0, 0.65, count)
        ]

    def values(self, key: str, curve: Curve) -> np.ndarray:
        """A field along a curve."""
        return np.atleast_1d(self.fields[key][curve.at])

    def lines(self) -> Iterator["Line"]:
        """The curves, each with ascending x, in the units of the figure."""
        for curve, colour in zip(
            self.curves, self.colours(len(self.curves)), strict=True
        ):
            x = (
                self.values(self.x, curve)
                if self.along
                else np.asarray(self.axis.values, dtype=float)
            )
            order = (
                np.arange(x.size) if self.result.last else np.argsort(x, kind="stable")
            )
            y = in_unit(self.values(self.y, curve)[order], self.about[self.y].shown)
            beyond = (
                self.values("extrapolated", curve)[order]
                if "extrapolated" in self.fields
                else None
            )
            yield Line(curve, order, x[order], self.across(x[order]), y, colour, beyond)

    def across(self, x: np.ndarray) -> np.ndarray:
        """Horizontal places in the unit of the axis."""
        about = self.about[self.x] if self.along else self.axis.quantity
        return in_unit(x, about.shown if about else "")

    def draw(
        self, line: "Line", tail: str = "", marker: str | None = None, text: str = ""
    ) -> Any:
        """Draws a curve, dotted where the material is used beyond its range; returns
        its colour.
        """
        marker = marker or ("o" if line.x.size == 1 else None)
        style = {
            "linewidth": self.style.line,
            "marker": marker,
            "markersize": 2.6 * self.style.line,
            "zorder": 3,
        }
        handle = within(
            self.ax, line.x, line.y, line.beyond, color=line.colour, **style
        )
        if np.isfinite(line.y).any() or tail:
            self.entry.lines.append((handle, text or line.curve.label, tail))
        return line.colour

    def finish(self) -> Any:
        """Labels, frame, title and legend of the axes; returns them."""
        self.ax.set(xlabel=self.labels[0], ylabel=self.labels[1])
        self.set_scale()
        frame(self.ax)
        beyond = self.fields.get("extrapolated")
        if beyond is not None and beyond.any():
            self.entry.notes.insert(0, DOTTED)
        self.canvas.entries.append(self.entry)
        _dress(self.ax, self.canvas)
        self.canvas.limits = self.ax.get_xlim(), self.ax.get_ylim()
        return self.ax

    def set_scale(self) -> None:
        """Of the horizontal axis, after the lines and before any limits: those would
        else be made on a linear one.
        """
        if self.along and self.result.scale == "log":
            self.ax.set_xscale("log")
        elif self.along and self.result.scale == "auto":
            _logarithmic_if_wide(self.ax)

    def peak_mark(self, top: Peak, colour: Any) -> None:
        self.ax.plot(
            top.x, top.y, "o", color=colour, markersize=3 * self.style.line, zorder=4
        )


class Line(NamedTuple):
    """A curve to draw."""

    curve: Curve
    order: np.ndarray  # of its points, so that x ascends
    si: np.ndarray  # x in SI units
    x: np.ndarray  # in the unit of the figure
    y: np.ndarray
    colour: Any
    beyond: np.ndarray | None  # where the material is used beyond its range


def begin(ask: Ask, panels: dict[str, Any] | None = None) -> tuple[Any, Canvas]:
    """The axes to draw on, new ones where none are given, and what has been drawn
    there. Raises `InputError`.

    `panels` says as for `Figure.subplots` how a new figure is divided; its first Axes
    are the ones to draw on.
    """
    if ask.style not in STYLES:
        raise InputError(f'style must be None or "paper", got {ask.style!r}.')
    style, ax = STYLES[ask.style], ask.ax
    if ax is not None and not hasattr(ax, "set_xlabel"):
        raise InputError(
            f"ax must be matplotlib Axes, or None for a new figure, got {ax!r}; a "
            "style is given as style=."
        )
    settings: Any = {**style.settings, "font.size": style.text}
    if ax is None:
        import matplotlib
        from matplotlib.figure import Figure

        with matplotlib.rc_context(settings):
            figure = Figure(
                figsize=style.panels if panels else style.size, layout="constrained"
            )
            grid: list[Any] = (
                list(figure.subplots(**panels).flat)
                if panels
                else [figure.add_subplot()]
            )
        ax = grid[0]
        ax._elastomdr = Canvas(
            style, own=True, foreign=False, panels=grid if panels else []
        )
    canvas: Canvas | None = getattr(ax, "_elastomdr", None)
    if canvas is None:
        import matplotlib

        if style.words:  # as large as the letters that are there
            style = style._replace(text=float(matplotlib.rcParams["font.size"]))
        canvas = ax._elastomdr = Canvas(style, own=False, foreign=ax.has_data())
    on = {id(panel) for panel in (ax, *canvas.panels)}
    # cleared
    canvas.entries = [
        e
        for e in canvas.entries
        if all(id(h.axes) in on for h, *_ in (*e.lines, *e.extras))
    ]
    return ax, canvas


def draw(
    result: Any,
    ask: Ask,
    x: str = "",
    y: str = "",
    also: Callable[[Sketch, Line], None] | None = None,
) -> Any:
    """Draws one field over another, one line per further index, and what `also` adds to
    each line.
    """
    sketch = Sketch(result, ask, x, y)
    for line in sketch.lines():
        sketch.draw(line)
        if also is not None:
            also(sketch, line)
    sketch.set_scale()
    if result.from_zero:
        sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def draw_curve(result: Any, ask: Ask, measured: Any = None, spread: Any = None) -> Any:
    """Draws a coefficient against velocity, its largest value marked, the whole
    uncertainty as a band.

    `spread` has the lower end, the median and the upper end of draws, whose median the
    result is.
    """
    points = None if measured is None else as_measured(measured)
    sketch = Sketch(result, ask)
    ax, fields = sketch.ax, sketch.fields
    cold, hysteresis = fields.get("cold"), fields.get("hysteresis")
    band, described = _uncertainty(fields)
    below = above = band
    if spread is not None:
        low, middle, high = spread
        below, above = (
            middle - low + np.nan_to_num(band),
            high - middle + np.nan_to_num(band),
        )
        described = f"95 % of the draws, and {described}"
    value = fields[sketch.y] if cold is None else np.fmax(fields[sketch.y], cold)
    highest = float(np.fmax.reduce(value, axis=None, initial=0.0)) or 1.0
    highest = highest if points is None else max(highest, float(points["mu"].max()))
    shaded, whole, lines = False, highest, list(sketch.lines())
    for line in lines:
        down, up = (
            np.atleast_1d(part[line.curve.at])[line.order] for part in (below, above)
        )
        top = peak(line.x, line.y)
        text = _peak_in_words(top, line, sketch.axis if not sketch.along else None)
        colour = sketch.draw(line, text)
        if cold is not None:
            warm = np.atleast_1d(cold[line.curve.at])[line.order]
            ax.plot(
                line.x,
                warm,
                "--",
                color=colour,
                linewidth=0.7 * sketch.style.line,
                zorder=2.5,
            )
        if hysteresis is not None:
            _draw_parts(
                sketch,
                line,
                np.atleast_1d(hysteresis[line.curve.at])[line.order],
                colour,
                len(lines) == 1,
            )
        if (np.fmax(down, up) > _VISIBLE * highest).any():
            shaded = True
            whole = max(whole, float(np.nanmax(line.y + up)))
            low, high = np.maximum(line.y - down, 0.0), line.y + up
            if line.x.size > 1:
                ax.fill_between(
                    line.x, low, high, color=colour, alpha=_LIGHT, linewidth=0, zorder=2
                )
            else:
                ax.errorbar(
                    line.x,
                    line.y,
                    [down, up],
                    fmt="none",
                    ecolor=colour,
                    alpha=0.5,
                    capsize=4,
                    zorder=2,
                )
        if top is not None and line.x.size > 1 and sketch.style.words:
            sketch.peak_mark(top, colour)
            if len(lines) == 1 and sketch.alone and line.x[0] < line.x[-1]:
                scale = np.log if sketch.along else np.asarray
                part = float(
                    (scale(top.x) - scale(line.x[0]))
                    / (scale(line.x[-1]) - scale(line.x[0]))
                )
                sketch.canvas.single.append(_write_above(ax, top, text, part))
    if points is not None and sketch.along:
        _draw_measured(sketch, points, lines)
    sketch.set_scale()
    before = (
        sketch.before[1][1] if sketch.canvas.entries or sketch.canvas.foreign else 0.0
    )
    ax.set_ylim(0.0, max(1.16 * highest, 1.04 * min(whole, 2 * highest), before))
    sketch.entry.notes += ["dashed: without heating"] if cold is not None else []
    if hysteresis is not None and not (len(lines) == 1 and sketch.alone):
        sketch.entry.notes.append("dash-dotted: hysteresis, the rest is adhesive shear")
    sketch.entry.notes += [f"shaded: {described}"] if shaded else []
    return sketch.finish()


def draw_traction(result: Any, ask: Ask) -> Any:
    """Draws traction against creepage or slip, as it was given; dashed what a contact
    has that slips all over.
    """
    x = "slip" if result.slip is not None else "creepage"
    friction = np.asarray(result.friction)
    constant = np.isfinite(friction).all() and np.ptp(friction) == 0

    def full_slip(sketch: Sketch, line: Line) -> None:
        most = sketch.values("friction", line.curve)[line.order]
        if sketch.along and np.isfinite(most).all() and np.ptp(most) > 0:
            limit = np.where(line.x == 0, np.nan, np.sign(line.x) * most)
            sketch.ax.plot(
                line.x, limit, "--", color=line.colour, linewidth=0.9, zorder=1
            )
            top = peak(line.x, np.abs(line.y))
            if top is not None and top.inside:  # at an end the largest may lie beyond
                at = int(np.flatnonzero(line.x == top.x)[0])
                sketch.peak_mark(Peak(top.x, float(line.y[at]), True), line.colour)

    ax = draw(result, ask, x=x, also=full_slip)
    if constant:
        full = float(friction.flat[0])
        for level in {full, -full} if np.nanmin(getattr(result, x)) < 0 else {full}:
            ax.axhline(level, color="#888888", linewidth=0.9, linestyle="--", zorder=1)
    return ax


def draw_warming(result: Any, ask: Ask) -> Any:
    """Draws temperature against time, with the steady one dotted, or the steady one
    against velocity.
    """
    over_time = result.time is not None

    def steady(sketch: Sketch, line: Line) -> None:
        if over_time:
            level = in_unit(sketch.values("steady", line.curve)[0], "°C")
            sketch.ax.axhline(level, color=line.colour, linewidth=0.9, linestyle=":")
            sketch.entry.notes[:] = ["dotted: steady"]

    return draw(result, ask, x="time" if over_time else "velocity", also=steady)


def draw_stability(result: Any, ask: Ask) -> Any:
    """Draws the damping ratio against velocity; dotted where friction does not follow,
    shaded where swings grow.
    """
    sketch = Sketch(result, ask)
    ax, entry = sketch.ax, sketch.entry
    for line in sketch.lines():
        counts = sketch.values("follows", line.curve)[line.order] & np.isfinite(line.y)
        # what decides lies on top
        ax.plot(
            line.x, line.y, ":", color=line.colour, linewidth=0.7 * sketch.style.line
        )
        sketch.draw(
            line._replace(y=np.where(counts, line.y, np.nan)),
            marker="o" if counts.sum() == 1 else None,
        )
        below = counts & (line.y < 0)
        if below.any():
            red = {"color": "#c03030", "alpha": 0.3, "linewidth": 0, "zorder": 1}
            entry.extras.append(
                (
                    ax.fill_between(
                        line.x, line.y, 0, where=below, interpolate=True, **red
                    ),
                    "swings grow",
                )
            )
            # between two points there is an area, at one there is none
            if below.sum() == 1:
                ax.plot(
                    line.x[below], line.y[below], "o", color="#c03030", markersize=4
                )
    limit = ax.axvline(
        float(result.slowest), color="#888888", linewidth=1, linestyle="--"
    )
    entry.extras.append((limit, r"$\lambda\sqrt{k/m}$: slower, it decides nothing"))
    ax.axhline(0, color="#888888", linewidth=1)
    return sketch.finish()


def draw_dissipation(result: Any, ask: Ask) -> Any:
    """Draws shares against relaxation time, one line per point that converged."""
    sketch = Sketch(result, ask)
    for line in sketch.lines():
        if not sketch.values("converged", line.curve).all():
            continue
        dashpot, text = line.si == 0, line.curve.label
        if dashpot.any():
            text = ", ".join(
                filter(
                    None,
                    (text, f"dashpot {significant(float(line.y[dashpot][0]), 2)} %"),
                )
            )
        sketch.draw(
            line._replace(x=line.x[~dashpot], y=line.y[~dashpot]), marker="o", text=text
        )
    sketch.set_scale()
    sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def draw_bands(result: Any, ask: Ask, colour: Any = None) -> Any:
    """Draws the part of mu per decade of frequency as steps: the area under a line is
    its friction coefficient.
    """
    sketch = Sketch(result, ask)
    half, limits = np.sqrt(result.width), []
    for line in sketch.lines():
        edges = np.append(line.x / half, line.x[-1] * half)
        own = colour if colour is not None and len(sketch.curves) == 1 else line.colour
        steps = sketch.ax.stairs(
            line.y / np.log10(result.width),
            edges,
            color=own,
            linewidth=sketch.style.line,
        )
        sketch.entry.lines.append((steps, line.curve.label, ""))
        seen = line.x[line.y > 0.01 * np.nanmax(result.mu, initial=0.0)]
        limits += [seen.min() / half, seen.max() * half] if seen.size else []
    sketch.set_scale()
    if limits:
        low, high = sketch.before[0] if sketch.canvas.entries else (np.inf, 0.0)
        sketch.ax.set_xlim(min(low, *limits), max(high, *limits))
    sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def draw_rough_contact(result: Any, ask: Ask, x: str = "", y: str = "") -> Any:
    """Draws a field of a rough contact, both axes logarithmic where they are spread
    widely, its error as a band.
    """
    known = {
        "conductance": "error",
        "thermal": "error",
        "electrical": "error",
        "approach": "approach_error",
        "separation": "approach_error",
    }
    relative = known.get(y) == "error"

    def band(sketch: Sketch, line: Line) -> None:
        if y not in known:
            return
        error = sketch.values(known[y], line.curve)[line.order]
        half = error * line.y if relative else in_unit(error, sketch.about[y].shown)
        low = np.maximum(line.y - half, 1e-3 * line.y)
        sketch.ax.fill_between(
            line.x, low, line.y + half, color=line.colour, alpha=_LIGHT, linewidth=0
        )

    ax = draw(result, ask, x, y, band)
    values = np.asarray(getattr(result, y or result.shows))
    values = values[np.isfinite(values) & (values > 0)]
    if values.size and values.max() > _LOG / 4 * values.min():
        ax.set_yscale("log")
        frame(ax)
    return ax


def draw_force_spectrum(result: Any, ask: Ask) -> Any:
    """Draws the amplitudes of a force as a spectrum of lines, or its density as a
    curve.
    """
    if result.shows_density:
        ax = draw(result, ask, "frequency", "density")
        ax.set_yscale("log")
        frame(ax)
        return ax
    sketch = Sketch(result, ask)
    for line in sketch.lines():
        low = np.nanmax(line.y, initial=0.0) * 1e-4 or 1e-300
        sketch.ax.vlines(
            line.x,
            low,
            np.maximum(line.y, low),
            color=line.colour,
            linewidth=0.6 * sketch.style.line,
        )
        (tips,) = sketch.ax.plot(
            line.x, np.maximum(line.y, low), "o", color=line.colour, markersize=4.5
        )
        sketch.entry.lines.append((tips, line.curve.label, ""))
    sketch.ax.set_yscale("log")
    return sketch.finish()


def draw_impact(result: Any, ask: Ask) -> Any:
    """Draws the force of one impact against time."""
    from scipy.interpolate import CubicSpline

    about = {q.path: q for q in result.quantities()}
    labels = about["history.time"].axis_label, about["history.force"].axis_label
    sketch = Sketch(result, ask, labels=labels)
    sketch.along = False  # what is drawn is a history
    ax, time, force = (
        sketch.ax,
        in_unit(np.ravel(result.history.time), "ms"),
        np.ravel(result.history.force),
    )
    restitution = (
        f"restitution {significant(float(np.ravel(result.restitution)[0]), 4)}"
    )
    if np.isfinite(time).all():
        fine, colour = np.linspace(time[0], time[-1], 400), sketch.colours(1)[0]
        beyond = (
            None
            if result.extrapolated is None
            else np.broadcast_to(np.ravel(result.extrapolated), fine.shape)
        )
        line = Line(
            Curve((), ""),
            np.arange(400),
            fine,
            fine,
            CubicSpline(time, force)(fine),
            colour,
            beyond,
        )
        sketch.draw(line, restitution)
        turn = time.size // 2
        sketch.peak_mark(Peak(time[turn], force[turn], True), colour)
        if sketch.style.words and sketch.alone:
            words = (
                f"turn, {significant(1e3 * float(np.ravel(result.max_depth)[0]), 3)} "
                "mm deep"
            )
            place = {"xytext": (8, 2), "textcoords": "offset points", "fontsize": 9}
            sketch.canvas.single += [
                ax.annotate(words, (time[turn], force[turn]), **place),
                ax.text(
                    0.98,
                    0.95,
                    restitution,
                    transform=ax.transAxes,
                    ha="right",
                    va="top",
                    fontsize=10,
                ),
            ]
        ax.set(ylim=(0, None), xlim=(0, None))
    return sketch.finish()


def draw_indentation(result: Any, ask: Ask) -> Any:
    """Draws depth, force and radius against time and the force against the depth; on
    given axes the last alone.
    """
    unit, scale = _force_unit(result.force, ask.ax)
    sketch = Sketch(
        result, ask, panels={"nrows": 2, "ncols": 2}, labels=("", f"Force [{unit}]")
    )
    panels, about = sketch.canvas.panels, sketch.about
    time = np.atleast_1d(result.time)
    rows = time.reshape(-1, time.shape[-1])
    steps = np.diff(rows[0])
    log = bool(steps.size and steps.max() > _DECADES * np.median(steps))
    labels, main = _reached(sketch), sketch.ax
    for line, label in zip(sketch.lines(), labels, strict=True):
        t = np.atleast_1d(result.time[line.curve.at])
        since = np.where(t > t[0], t - t[0], np.nan) if log else t - t[0]
        for panel, key in zip(
            panels[:3], ("depth", "force", "contact_radius"), strict=False
        ):
            y = sketch.values(key, line.curve)
            y = scale * y if key == "force" else in_unit(y, about[key].shown)
            within(
                panel,
                since,
                y,
                line.beyond,
                color=line.colour,
                linewidth=0.9 * sketch.style.line,
            )
        sketch.ax = panels[3] if panels else main
        sketch.draw(
            line._replace(y=scale * line.y), text=label if len(labels) > 1 else ""
        )
        sketch.ax = main
    words = (
        "Time [s]"
        if not log and (rows[:, 0] == 0).all()
        else "Time since the first instant [s]"
    )
    for panel, key in zip(
        panels[:3], ("depth", "force", "contact_radius"), strict=False
    ):
        panel.set(
            xscale="log" if log else "linear",
            xlabel=words,
            ylabel=about[key].axis_label,
        )
        frame(panel)
    for panel in panels[1:2]:
        panel.set_ylabel(f"Force [{unit}]")
    sketch.ax = panels[3] if panels else main
    sketch.finish()
    return main


def draw_line_contact(result: Any, ask: Ask) -> Any:
    """Draws the line and the rubber's surface, with the stretches in contact in
    colour.
    """
    sketch = Sketch(result, ask)
    ax, about, extras = sketch.ax, sketch.about, sketch.entry.extras
    x, line, rubber = (
        in_unit(sketch.fields[k], about[k].shown) for k in ("x", "height", "surface")
    )
    touching, thin = np.asarray(result.touching), 0.6 * sketch.style.line
    extras += [
        (ax.plot(x, line, color="#8a8a8a", linewidth=0.8 * thin)[0], "rough line")
    ]
    extras += [(ax.plot(x, rubber, color=PALETTE[0], linewidth=thin)[0], "rubber")]
    if touching.any():
        label = (
            f"in contact, {float(result.share):.1%} of the line (not the real contact "
            "area)"
        )
        red = {"color": "#c23b22"}
        (stretch,) = ax.plot(
            x, np.where(touching, rubber, np.nan), linewidth=2.2 * thin, **red
        )
        extras.append((stretch, label if sketch.style.words else "in contact"))
        # a single sample draws no stretch
        alone = touching & ~np.roll(touching, 1) & ~np.roll(touching, -1)
        ax.plot(x[alone], rubber[alone], ".", markersize=5, **red)
    known = [float(y) for y in (*line, *rubber) if np.isfinite(y)]
    if known:
        top = min(0.0, float(np.min(rubber, where=np.isfinite(rubber), initial=0.0)))
        # the deepest valleys are far below the rubber
        least = max(min(known), top - 1.5 * (max(known) - top))
        ax.set_ylim(max(known) + 0.05 * (max(known) - least), least)
    ax.set_xlim(x[0], x[-1])
    return sketch.finish()


def draw_surface(
    line: Any, spectrum: Any = None, axes: Any = None, name: str = "Line"
) -> Any:
    """Draws the heights of a line (left) and a spectrum (right); returns the two
    matplotlib Axes.

    Args:
        line: an `em.RoughLine`.
        spectrum: C(q) of the surface it was made from; None for the line's own,
            two-sided: (A_j^2/4)/dq of each of its waves, dq = 2 pi/period.
        axes: two axes to draw on.
        name: of the line, above it.
    """
    if axes is None:
        from matplotlib.figure import Figure

        axes = Figure(figsize=(9.6, 3.8), layout="constrained").subplots(1, 2)
    left, right = axes
    left.plot(
        1e3 * np.asarray(line.x),
        1e6 * np.asarray(line.height),
        color=PALETTE[0],
        linewidth=0.8,
    )
    left.set(xlabel="Position on the line [mm]", ylabel="Height, into the rubber [µm]")
    left.set_title(name, loc="left", fontsize=10)
    whole = line if spectrum is None else spectrum
    if spectrum is None:
        n = line.count
        q = 2 * np.pi / float(line.period) * np.arange(1, n // 2)
        power = (
            np.abs(np.fft.rfft(np.asarray(line.height))[1 : n // 2] / n) ** 2
            * float(line.period)
            / (2 * np.pi)
        )
        right.loglog(
            q,
            np.where(power > 1e-16 * power.max(), power, np.nan),
            ".",
            color=PALETTE[0],
            markersize=3,
        )
        right.set_ylabel("Spectrum of the line [m³]")
    else:
        right.loglog(
            spectrum.q,
            spectrum.c,
            "o-" if spectrum.q.size < 40 else "-",
            color=PALETTE[0],
            markersize=4,
        )
        right.set_ylabel("Spectrum C(q), <h²> = ∫C d²q [m⁴]")
    right.set_xlabel("Wave number q [rad/m]")
    rms = (
        f"rms height {1e6 * float(whole.rms_height):.3g} µm, rms slope "
        f"{float(whole.rms_slope):.3g}"
    )
    right.set_title(
        rms + ("" if spectrum is None else " (surface)"), loc="left", fontsize=10
    )
    for ax in (left, right):
        frame(ax)
    return axes


def draw_cutoffs(spectrum: Any, whole: Any = None) -> Any:
    """Draws a spectrum (left) and the rms slope of the surface down to each wavelength
    (right); returns the left Axes.

    Args:
        spectrum: C(q) between its cutoffs, with `moment` and `rms_slope`.
        whole: the spectrum that it is cut from, drawn behind it.
    """
    from matplotlib.figure import Figure

    # laid out by hand: this is drawn while a cutoff moves
    figure = Figure(figsize=(8.6, 3.4))
    left, right = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.085, right=0.985, bottom=0.155, top=0.9, wspace=0.24)
    for each, colour, width in ((whole, "#b8bec6", 1.2), (spectrum, PALETTE[0], 2.0)):
        if each is None:
            continue
        q = np.geomspace(float(each.q_low), float(each.q_high), 200)
        left.loglog(q, each.at(q), color=colour, linewidth=width)
        slope = np.sqrt(2 * np.pi * np.maximum(each.moment(3, each.q_low, q), 0.0))
        right.semilogx(2e3 * np.pi / q, slope, color=colour, linewidth=width)
    left.set(xlabel="Wave number q [rad/m]", ylabel="Spectrum C(q), <h²> = ∫C d²q [m⁴]")
    right.set(
        xlabel="Shortest wavelength kept [mm]",
        ylabel="rms slope of the surface [-]",
        ylim=(0.0, None),
    )
    right.invert_xaxis()
    rms = (
        f"rms height {1e6 * float(spectrum.rms_height):.3g} µm, rms slope "
        f"{float(spectrum.rms_slope):.3g}"
    )
    left.set_title(rms, loc="left", fontsize=10)
    for ax in (left, right):
        frame(ax)
        ax.minorticks_off()
    return left


def saved(ax: Any, model: str = "") -> bytes:
    """The figure that the axes belong to as a PNG image; the model's name goes with it
    as its description.
    """
    buffer = io.BytesIO()
    canvas = getattr(ax, "_elastomdr", None)
    dpi = canvas.style.dpi if canvas is not None else STYLES[None].dpi
    ax.figure.savefig(
        buffer,
        format="png",
        dpi=dpi,
        metadata={"Description": model} if model else None,
    )
    return buffer.getvalue()


def within(ax: Any, x: Any, y: Any, beyond: Any = None, **style: Any) -> Any:
    """Draws a line, dotted where a material is used beyond its range; returns the
    line.
    """
    beyond = np.zeros(np.shape(y), dtype=bool) if beyond is None else beyond
    handle = ax.plot(x, np.where(beyond, np.nan, y), **style)[0]
    if beyond.any():
        thin = 0.7 * style["linewidth"]
        ax.plot(
            x,
            y,
            ":",
            markerfacecolor="none",
            **{**style, "color": handle.get_color(), "linewidth": thin},
        )
    return handle


def frame(ax: Any) -> None:
    """Grid behind the curves, two spines, ticks whose labels do not overlap."""
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

    for axis in (ax.xaxis, ax.yaxis):
        if axis.get_scale() == "log":
            low, high = sorted(axis.get_view_interval())
            axis.set_minor_formatter(NullFormatter())
            axis.set_major_formatter(FuncFormatter(_power))
            few = high < _FEW * low
            axis.set_major_locator(
                MaxNLocator(4, steps=[1, 2, 2.5, 5, 10])
                if few
                else LogLocator(numticks=8)
            )
    ax.grid(True, which="major", color=GRID, linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)


def _power(value: float, _: Any = None) -> str:
    """A tick of a logarithmic axis: powers of ten as such, all others as plain numbers
    where these are short.
    """
    if value <= 0:
        return ""
    power = int(np.floor(np.log10(value) + 1e-9))
    factor = float(f"{value / 10.0**power:.4g}")
    if factor == 1:
        return f"$\\mathdefault{{10^{{{power}}}}}$"
    return (
        f"{value:.4g}"
        if -3 <= power < 4
        else f"$\\mathdefault{{{factor:g}\\times10^{{{power}}}}}$"
    )


def as_measured(measured: Any) -> dict[str, np.ndarray]:
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
            'measured must be a mapping with "velocity" [m/s], "mu" and, if '
            f'known, "temperature" [K], got {got}.'
        )
    points = {
        name: np.atleast_1d(as_float64(f"measured {name}", values))
        for name, values in measured.items()
    }
    positive("measured velocity", points["velocity"])
    require("measured mu", points["mu"], "finite", np.isfinite)
    try:
        together = np.broadcast_arrays(*points.values())
        lists = [values.size for values in points.values() if values.ndim == 1]
        # lists alone are columns of one table
        same = len(lists) < len(points) or len(set(lists)) == 1
    except ValueError:
        together, same = [], False
    if not same:
        shapes = ", ".join(f"{name} {values.shape}" for name, values in points.items())
        raise InputError(
            "measured values must be lists of the same length, or arrays that "
            f"broadcast, got {shapes}."
        )
    return {name: values.ravel() for name, values in zip(points, together, strict=True)}


def _dress(ax: Any, canvas: Canvas) -> None:
    """Title, notes and legend for all that has been drawn."""
    entries, first = canvas.entries, canvas.entries[0]
    names = _names(entries)
    shown: dict[str, Any] = {}
    for entry, name in zip(entries, names, strict=True):
        places = (
            np.linspace(0, len(entry.lines) - 1, min(len(entry.lines), _LEGEND))
            .round()
            .astype(int)
        )
        for handle, text, tail in (entry.lines[i] for i in np.unique(places)):
            words = ", ".join(part for part in (name, text) if part)
            if words:
                full = f"{words}: {tail}" if tail and canvas.style.words else words
                shown.setdefault(full.replace("degC", "°C"), handle)
    for handle, text in (pair for entry in entries for pair in entry.extras):
        shown.setdefault(text.replace("degC", "°C"), handle)
    if len(entries) > 1:
        for artist in canvas.single:
            artist.remove()
        canvas.single.clear()
    titles = [entry.asked.title for entry in entries if entry.asked.title]
    alike = len({entry.heading for entry in entries}) == 1
    title = titles[-1] if titles else first.heading if alike else first.title
    for text, handle in shown.items():
        handle.set_label(text)
    if shown:
        _write_legend(ax, canvas, shown)
    if not canvas.foreign or titles:
        models = "; ".join(dict.fromkeys(entry.model for entry in entries))
        failed, count = (
            sum(numbers)
            for numbers in zip(*(entry.counted for entry in entries), strict=True)
        )
        missing = (
            f"{failed} of {count} {first.each} did not converge and are left out"
            if failed
            else ""
        )
        notes = dict.fromkeys(note for entry in entries for note in entry.notes)
        for artist in canvas.heading:
            artist.remove()
        place = canvas.panels[0] if canvas.panels else ax
        canvas.heading = write_title(
            place, canvas, title, bool(titles), (models, "; ".join(notes), missing)
        )


def _names(entries: list[Entry]) -> list[str]:
    """What sets results apart: the label that was asked for, or else the fewest inputs
    that differ.
    """
    if len(entries) == 1:
        return [entries[0].asked.label or ""]
    known = [
        {
            **entry.inputs,
            "model": entry.model.split(" (")[0],
            "shown": entry.labels[1].partition(" [")[0].lower(),
        }
        for entry in entries
    ]
    keys = dict.fromkeys(
        ["shown", "material", *(key for inputs in known for key in inputs)]
    )
    parts: list[list[str]] = [[] for _ in entries]
    own = [i for i, entry in enumerate(entries) if not entry.asked.label]
    for key in keys:
        values = [inputs.get(key, "") for inputs in known]
        apart = len({tuple(parts[i]) for i in own})
        if len({(*parts[i], values[i]) for i in own}) > apart:
            for i in own:
                parts[i].append(values[i])
    same = own and not any(parts[i] for i in own)
    return [
        entry.asked.label
        or ", ".join(filter(None, part))
        or (entry.inputs.get("material", "") if same else "")
        for entry, part in zip(entries, parts, strict=True)
    ]


def _write_legend(ax: Any, canvas: Canvas, shown: dict[str, Any]) -> None:
    """Beside the axes; in a paper above them, in as many columns as fit, where it
    covers nothing.
    """
    style = canvas.style
    texts = [textwrap.fill(text, 48) for text in shown]
    common = {"frameon": False, "borderaxespad": 0.2, "fontsize": 0.85 * style.text}
    if style.words and not crowded(ax, canvas):
        if canvas.own:
            width = style.panels[0] + 2.2 if canvas.panels else style.wide
            ax.figure.set_size_inches(width, ax.figure.get_size_inches()[1])
        ax.legend(
            shown.values(),
            texts,
            loc="upper left",
            bbox_to_anchor=(1.01, 1.0),
            **common,
        )
        return
    common |= {"handlelength": 1.5, "columnspacing": 1.2}
    if style.words:
        common |= below(ax, style)
    else:
        common |= {
            "loc": "lower left",
            "bbox_to_anchor": (0.0, 1.0),
            "fontsize": style.text - 0.5,
        }
    inches = (
        ax.figure.get_size_inches()[0] * ax.get_position(original=True).width
        if style.words
        else 3.346
    )
    room = int(inches * 120 / style.text)  # letters
    columns = max(1, min(len(texts), room // (max(map(len, texts)) + 7)))
    if canvas.own:
        rows = -(-len(texts) // columns) + sum(text.count("\n") for text in texts)
        height = style.panels[1] if canvas.panels else style.size[1]
        ax.figure.set_size_inches(style.wide, height + 0.14 * rows)
    if canvas.panels:
        for legend in ax.figure.legends[:]:
            legend.remove()
        del common["bbox_to_anchor"]
        ax.figure.legend(
            shown.values(),
            texts,
            ncols=columns,
            **{**common, "loc": "outside upper left"},
        )
        return
    ax.legend(shown.values(), texts, ncols=columns, **common)


def crowded(ax: Any, canvas: Canvas) -> bool:
    """Whether the axes are some of several that matplotlib lays out: a legend beside
    them takes their width.
    """
    return (
        not canvas.own
        and len(ax.figure.axes) > 1
        and ax.get_figure(root=True).get_layout_engine() is not None
    )


def below(ax: Any, style: Style) -> dict[str, Any]:
    """The place of a legend below the axes and their label."""
    from matplotlib.transforms import ScaledTranslation

    down = ScaledTranslation(
        0.0, -3.6 * style.text / 72, ax.get_figure(root=True).dpi_scale_trans
    )
    return {
        "loc": "upper left",
        "bbox_to_anchor": (0.0, 0.0),
        "bbox_transform": ax.transAxes + down,
    }


def write_title(
    ax: Any, canvas: Canvas, title: str, asked: bool, small: tuple[str, str, str]
) -> list[Any]:
    """Above the axes, from the top: the title, in small print the model's name and what
    lines mean, in red what failed.

    Returns the artists but the title. In a paper there is only a title that was asked
    for.
    """
    if not canvas.style.words:
        if asked:
            ax.set_title(title, loc="left", fontsize=canvas.style.text + 1)
        return []
    figure, text = ax.figure.get_figure(root=True), canvas.style.text
    if canvas.panels:
        left = 0.01 if figure.get_layout_engine() else ax.get_position().x0
        figure.suptitle(
            title, x=left, ha="left", fontsize=1.2 * text, fontweight="bold", color=INK
        )
    inches = figure.get_size_inches()[0] * ax.get_position(original=True).width
    above = {
        "xy": (0, 1),
        "xycoords": "axes fraction",
        "textcoords": "offset points",
        "va": "bottom",
        "fontsize": 0.8 * text,
    }
    made, height = [], 0.6 * text
    for words, colour in zip(reversed(small), (RED, FAINT, FAINT), strict=True):
        lines = textwrap.wrap(words, max(30, int(170 * inches / text)))
        place = {"xytext": (0, height), "color": colour, "linespacing": 1.2, **above}
        made += [ax.annotate("\n".join(lines), **place)] if lines else []
        height += 1.2 * text * len(lines)
    if not canvas.panels:
        heading = "\n".join(textwrap.wrap(title, max(24, int(95 * inches / text))))
        ax.set_title(
            heading,
            loc="left",
            fontsize=1.2 * text,
            fontweight="bold",
            color=INK,
            pad=height + 0.4 * text,
        )
    return made


def _write_above(ax: Any, top: Peak, text: str, part: float) -> Any:
    """Labels the peak; `part` is its place along the axis, from 0 to 1, so that the
    text stays inside the figure.
    """
    side = "left" if part < 0.25 else "right" if part > 0.75 else "center"
    place = {
        "xytext": (0, 8),
        "textcoords": "offset points",
        "ha": side,
        "va": "bottom",
    }
    return ax.annotate(text, xy=(top.x, top.y), fontsize=9, color=INK, **place)


def _peak_in_words(top: Peak | None, line: Line, axis: Axis | None) -> str:
    """The largest value and where it is, along the velocity or an `axis` of something
    else.
    """
    if top is None:
        return "no point converged"
    at = float(line.si[np.flatnonzero(line.x == top.x)[0]])
    name, unit = (
        ("velocity", "m/s")
        if axis is None
        else (axis.name, axis.quantity.unit if axis.quantity else "")
    )
    place = float(significant(at, 3)) if name == "velocity" else at
    return (
        f"{top.kind} {significant(top.y, 3)} at {in_words(name, place, unit)}".replace(
            "degC", "°C"
        )
    )


def _uncertainty(fields: Mapping[str, np.ndarray]) -> tuple[np.ndarray, str]:
    """Half the width of the band around each point, and what it holds."""
    error, bound = fields["error"], fields.get("model_error")
    if bound is None:
        return error, "numerical error"
    known = np.isfinite(bound)
    total = error + np.where(known, bound, 0.0)
    if not known[np.isfinite(error)].any():
        return total, "numerical error (the model's is not known)"
    unknown = not known[np.isfinite(error)].all()
    return total, "numerical and model error" + (
        ", in part numerical only" if unknown else ""
    )


def _draw_parts(
    sketch: Sketch, line: Line, hysteresis: np.ndarray, colour: Any, only: bool
) -> None:
    """Hysteresis below and adhesive shear above it, as areas under a single curve, as a
    line under several.
    """
    if not (only and sketch.alone) or line.x.size < 2:
        sketch.ax.plot(
            line.x,
            hysteresis,
            "-.",
            color=colour,
            linewidth=0.7 * sketch.style.line,
            zorder=2.5,
        )
        return
    known = np.isfinite(line.y)
    for low, high, shade, label in (
        (np.zeros_like(hysteresis), hysteresis, PALETTE[2], "hysteresis"),
        (hysteresis, line.y, PALETTE[1], "adhesive shear"),
    ):
        handle = sketch.ax.fill_between(
            line.x,
            low,
            high,
            where=known,
            color=shade,
            alpha=0.35,
            linewidth=0,
            zorder=1.5,
        )
        sketch.entry.extras.append((handle, label))


def _draw_measured(
    sketch: Sketch, points: dict[str, np.ndarray], lines: list[Line]
) -> None:
    """Draws points in the colour of the curve at their temperature, in black where
    there is none.

    Those in black have a marker and a label for each temperature, or one for all where
    these are many.
    """
    at, kelvin = points.get("temperature"), sketch.fields.get("temperature")
    style = {
        "linestyle": "none",
        "markersize": 2.8 * sketch.style.line,
        "markeredgewidth": 0.7 * sketch.style.line,
        "markerfacecolor": "white",
        "zorder": 5,
    }
    left = np.ones(points["mu"].shape, dtype=bool)

    def mark(which: np.ndarray, marker: str, colour: Any, label: str) -> None:
        (handle,) = sketch.ax.plot(
            points["velocity"][which],
            points["mu"][which],
            marker,
            color=colour,
            **style,
        )
        sketch.entry.extras.append((handle, label))

    if at is not None and kelvin is not None:
        for line in lines:
            own = np.atleast_1d(kelvin[line.curve.at])
            near = left & (np.abs(at - own[0]) <= SAME_TEMPERATURE) & (np.ptp(own) == 0)
            if near.any():
                mark(
                    near,
                    "o",
                    line.colour,
                    f"measured, {in_words('temperature', float(own[0]))}",
                )
            left &= ~near
    if not left.any():
        return
    if at is None:
        return mark(left, "s", INK, "measured")
    tail = "" if kelvin is None else " (no curve)"
    centres = grouped(at[left])
    if len(centres) > len(_WITHOUT_CURVE):
        ends = " to ".join(
            in_words("temperature", each) for each in (centres[0], centres[-1])
        )
        return mark(left, "s", INK, f"measured, {ends}{tail}")
    nearest = np.abs(at[:, None] - centres).argmin(axis=1)
    for k, (centre, marker) in enumerate(zip(centres, _WITHOUT_CURVE, strict=False)):
        mark(
            left & (nearest == k),
            marker,
            INK,
            f"measured, {in_words('temperature', centre)}{tail}",
        )


def grouped(kelvin: np.ndarray) -> list[float]:
    """The means of temperatures that belong together, ascending [K]."""
    ascending = np.sort(np.ravel(kelvin))
    runs = np.split(
        ascending, np.flatnonzero(np.diff(ascending) > SAME_TEMPERATURE) + 1
    )
    return [float(run.mean()) for run in runs if run.size]


def _logarithmic_if_wide(ax: Any) -> None:
    """A logarithmic horizontal axis where the values are spread that widely; zero keeps
    a place.
    """
    values = [
        np.asarray(line.get_xdata(), dtype=float)
        for line in ax.get_lines()
        if line.get_transform() == ax.transData
    ]
    x = np.concatenate(values) if values else np.ones(1)
    later = x[x > 0]
    if later.size and (x >= 0).all() and later.max() > _LOG * later.min():
        if later.size < x.size:
            ax.set_xscale("symlog", linthresh=later.min(), linscale=0.3)
        else:
            ax.set_xscale("log")


def _reached(sketch: Sketch) -> list[str]:
    """What sets histories apart: their largest depths or loads, whichever were given as
    round numbers.
    """

    def words(key: str, name: str) -> list[str]:
        rows = (sketch.values(key, curve) for curve in sketch.curves)
        return [
            f"to {in_words(name, float(np.nanmax(row, initial=0.0)))}" for row in rows
        ]

    force, depth = words("force", "load"), words("depth", "depth")
    return depth if sum(map(len, depth)) < sum(map(len, force)) else force


def _force_unit(force: Any, ax: Any) -> tuple[str, float]:
    """The unit of forces in a figure, and what one newton is in it: that of what has
    been drawn there before.
    """
    units = {"kN": 1e-3, "N": 1.0, "mN": 1e3, "µN": 1e6}
    canvas: Canvas | None = getattr(ax, "_elastomdr", None)
    if canvas is not None and canvas.entries:
        unit = _unit(canvas.entries[0].labels[1])
        return unit, units.get(unit, 1.0)
    largest = float(np.nanmax(np.abs(force), initial=0.0))
    return next(
        ((unit, scale) for unit, scale in units.items() if largest * scale >= 1),
        ("N", 1.0),
    )


def _unit(label: str) -> str:
    """The unit of an axis' label."""
    return label.rpartition(" [")[2].rstrip("]") if label.endswith("]") else ""


def _together(labels: list[str]) -> str:
    """The label of an axis along which there are several quantities of one unit. Raises
    `InputError` for several.
    """
    labels = list(dict.fromkeys(labels))
    units = {_unit(label) for label in labels}
    if len(labels) > 1 and len(units) > 1:
        raise InputError(
            f"ax must have axes with the units of the result, got {labels[-1]!r} on "
            f"axes of {labels[0]!r}: "
            "draw it on axes of its own."
        )
    (unit,) = units
    words = [label.removesuffix(f" [{unit}]") for label in labels]
    words[1:] = [word[0].lower() + word[1:] for word in words[1:]]
    return ", ".join(words) + (f" [{unit}]" if unit else "")


def draw_ranking(ranking: Any, style: str | None, title: str | None) -> Any:
    """Friction of each material against velocity, at the temperature of a ranking, and
    the ranking as bars.
    """
    heading = title or f"Ranking at {ranking.where()}".replace("degC", "°C")
    panels: dict[str, Any] = {"nrows": 1, "ncols": 2, "width_ratios": (1.4, 1.0)}
    if style is not None:
        panels = {"nrows": 2, "ncols": 1, "height_ratios": (1.4, 1.0)}
    left, canvas = begin(Ask(None, style), panels)
    right, look = canvas.panels[1], canvas.style
    if look.words:
        left.figure.set_size_inches(look.wide, look.size[1])
    at = {"temperature": ranking.temperature, "pressure": ranking.pressure}
    at = {name: value for name, value in at.items() if value is not None}
    highest = max(
        (place.mu for place in ranking.places if np.isfinite(place.mu)), default=1.0
    )
    for i, place in enumerate(ranking.places):
        # as in the figure of the curve
        colour = PALETTE[ranking.curve.materials.index(place.material) % len(PALETTE)]
        law = ranking.curve.select(place.material).law()
        left.semilogx(
            law.velocity, law(law.velocity, **at), color=colour, linewidth=look.line
        )
        known = np.isfinite(place.uncertainty)
        right.barh(
            i,
            place.mu,
            0.5,
            color=colour,
            xerr=place.uncertainty if known else None,
            capsize=3,
        )
        sure = {
            True: "",
            False: "lead not significant",
            None: "" if np.isnan(place.ahead) else "significance not known",
        }
        words = " ".join(
            filter(
                None,
                (
                    place.material,
                    f"({sure[place.significant]})" if sure[place.significant] else "",
                ),
            )
        )
        right.text(
            0.01 * highest,
            i - 0.3,
            words,
            va="bottom",
            fontsize=0.8 * look.text,
            color=RED if place.significant is False else INK,
        )
    left.axvline(ranking.velocity, color=FAINT, linestyle=":")
    left.set(
        xlabel="Sliding velocity [m/s]",
        ylabel="Friction coefficient [-]",
        ylim=(0, None),
    )
    right.set(
        yticks=[],
        xlabel="Friction coefficient [-]",
        xlim=(0, None),
        ylim=(len(ranking.places) - 0.5, -0.75),
    )
    right.locator_params(axis="x", nbins=5)
    for ax in (left, right):
        frame(ax)
    if look.words or title:
        left.figure.suptitle(
            heading,
            x=0.01,
            ha="left",
            fontsize=1.2 * look.text,
            fontweight="bold",
            color=INK,
        )
    return left
