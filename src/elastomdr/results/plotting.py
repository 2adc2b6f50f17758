"""What all figures share: two styles, curves, legend and title; matplotlib is loaded
when something is drawn.

A `Sketch` is one result on its way onto axes. What has been drawn on the same axes
before is kept with them, so that title, notes and legend are made anew for all of it:
the legend names what the results differ in.
"""

import io
import textwrap
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from .axes import Curve, Peak
from .doubts import Doubt, Kind
from .words import in_unit

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
LIGHT = 0.16  # opacity of a band
# curves of one result that a legend names; of more, it names as many, evenly spread
_LEGEND = 12
# ratio of the largest to the smallest value from which on an axis may be logarithmic
LOG_RATIO = 20.0
# ratio of the ends of a logarithmic axis up to which its ticks are those of a linear
# one
_FEW = 12.0
_PANEL = (5.75, 5.0)  # size of a panel beside others [inches]
_NOTES: dict[Kind, str] = {
    "illustrative": "moduli: illustrative, of no particular rubber",
    "extrapolated": "dotted: outside the measured range of the material",
    "no prediction": "no bound on the model is known (dotted where in part)",
    "hot branch": "in part another steady state exists",
    "bound": "in part the bound on the model exceeds half of the value",
    "estimate": "an estimate",
}


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


class DrawAsk(NamedTuple):
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
    asked: DrawAsk
    each: str
    counted: tuple[int, int]
    labels: tuple[str, str]  # of the axes, for this result alone
    doubts: tuple[Doubt, ...] = ()
    # artist, what the curve is, what is to see
    lines: list[tuple[Any, str, str]] = field(default_factory=list)
    extras: list[tuple[Any, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass
class Canvas:
    """What has been drawn on axes, and what has to be made anew when more is drawn."""

    style: Style
    own_figure: bool  # the figure was made here
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
        ask: DrawAsk,
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
            _joined_label([e.labels[i] for e in self.canvas.entries] + [labels[i]])
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
            result.doubts,
        )
        self.alone = (
            not self.canvas.entries and not self.canvas.foreign and not ask.group
        )
        self.style = self.canvas.style
        self.dotted = dotted(result.doubts, np.shape(result.converged))

    def colours(self, count: int) -> list[Any]:
        """Of the curves: shades of one colour, of viridis where there is one result."""
        drawn = len(self.canvas.entries) + self.canvas.foreign
        colour = PALETTE[drawn % len(PALETTE)]
        if count == 1:
            return [colour]
        import matplotlib
        from matplotlib.colors import to_rgb

        if drawn == 0 and not self.ask.group:
            return list(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, count)))
        return [
            tuple(1 - (1 - np.array(to_rgb(colour))) * (1 - pale))
            for pale in np.linspace(0.0, 0.65, count)
        ]

    def values(self, key: str, curve: Curve) -> np.ndarray:
        """A field along a curve."""
        return np.atleast_1d(self.fields[key][curve.place])

    def lines(self) -> Iterator["DrawnLine"]:
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
            yield DrawnLine(
                curve,
                order,
                x[order],
                self.across(x[order]),
                y,
                colour,
                np.atleast_1d(self.dotted[curve.place])[order],
            )

    def across(self, x: np.ndarray) -> np.ndarray:
        """Horizontal places in the unit of the axis."""
        about = self.about[self.x] if self.along else self.axis.quantity
        return in_unit(x, about.shown if about else "")

    def draw(
        self,
        line: "DrawnLine",
        value: str = "",
        marker: str | None = None,
        label: str = "",
    ) -> Any:
        """Draws a curve, dotted where it is to be doubted; returns its colour.

        `label` stands in the legend in place of that of the curve, `value` behind it.
        """
        marker = marker or ("o" if line.x.size == 1 else None)
        style = {
            "linewidth": self.style.line,
            "marker": marker,
            "markersize": 2.6 * self.style.line,
            "zorder": 3,
        }
        handle = plot_line(
            self.ax, line.x, line.y, line.dotted, color=line.colour, **style
        )
        if np.isfinite(line.y).any() or value:
            self.entry.lines.append((handle, label or line.curve.label, value))
        return line.colour

    def finish(self) -> Any:
        """Labels, frame, title and legend of the axes; returns them."""
        self.ax.set(xlabel=self.labels[0], ylabel=self.labels[1])
        self.set_scale()
        frame(self.ax)
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

    def along_line(self, values: Any, line: "DrawnLine") -> np.ndarray:
        """Values of the result's shape at the points of a line."""
        return np.atleast_1d(values[line.curve.place])[line.order]

    def peak_mark(self, top: Peak, colour: Any) -> None:
        self.ax.plot(
            top.x, top.y, "o", color=colour, markersize=3 * self.style.line, zorder=4
        )


class DrawnLine(NamedTuple):
    """A curve to draw."""

    curve: Curve
    order: np.ndarray  # of its points, so that x ascends
    si: np.ndarray  # x in SI units
    x: np.ndarray  # in the unit of the figure
    y: np.ndarray
    colour: Any
    dotted: np.ndarray  # where it is to be doubted


def begin(ask: DrawAsk, panels: dict[str, Any] | None = None) -> tuple[Any, Canvas]:
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
            style, own_figure=True, foreign=False, panels=grid if panels else []
        )
    canvas: Canvas | None = getattr(ax, "_elastomdr", None)
    if canvas is None:
        import matplotlib

        if style.words:  # as large as the letters that are there
            style = style._replace(text=float(matplotlib.rcParams["font.size"]))
        canvas = ax._elastomdr = Canvas(style, own_figure=False, foreign=ax.has_data())
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
    ask: DrawAsk,
    x: str = "",
    y: str = "",
    also: Callable[[Sketch, DrawnLine], None] | None = None,
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


def panels(count: int) -> list[Any]:
    """Axes of a new figure, beside each other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_PANEL[0] * count, _PANEL[1]), layout="constrained")
    return list(figure.subplots(1, count))


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


def dotted(doubts: Iterable[Doubt], shape: tuple[int, ...]) -> np.ndarray:
    """Where a curve is drawn dotted: beyond the range of the material, and where a model
    that has a bound elsewhere has none.
    """
    points = np.zeros(shape, bool)
    for doubt in doubts:
        here = np.broadcast_to(np.asarray(doubt.points), shape)
        if doubt.kind == "extrapolated" or (
            doubt.kind == "no prediction" and not here.all()
        ):
            points = points | here
    return points


def notes_of(results: Iterable[tuple[str, tuple[Doubt, ...]]]) -> list[str]:
    """What a figure says of the doubts of results, with the materials that they are of
    where these are not all; what did not converge is counted elsewhere.
    """
    results = list(results)
    notes = []
    for kind, note in _NOTES.items():
        names = [name for name, doubts in results if kind in {d.kind for d in doubts}]
        which = f"{', '.join(dict.fromkeys(names))}: "
        if names:
            notes.append(note if len(names) == len(results) else which + note)
    return notes


def plot_line(ax: Any, x: Any, y: Any, dotted: Any, **style: Any) -> Any:
    """Draws a line, dotted where it says; returns the line."""
    handle = ax.plot(x, np.where(dotted, np.nan, y), **style)[0]
    if dotted.any():
        thin = 0.7 * style["linewidth"]
        dots = {**style, "color": handle.get_color(), "linewidth": thin}
        ax.plot(x, y, ":", markerfacecolor="none", **dots)
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


def _dress(ax: Any, canvas: Canvas) -> None:
    """Title, notes and legend for all that has been drawn."""
    entries = canvas.entries
    if len(entries) > 1:
        for artist in canvas.single:
            artist.remove()
        canvas.single.clear()
    handles = _legend_handles(entries, canvas.style.words)
    for label, handle in handles.items():
        handle.set_label(label)
    if handles:
        _write_legend(ax, canvas, handles)
    titles = [entry.asked.title for entry in entries if entry.asked.title]
    if canvas.foreign and not titles:
        return
    alike = len({entry.heading for entry in entries}) == 1
    title = entries[0].heading if alike else entries[0].title
    for artist in canvas.heading:
        artist.remove()
    canvas.heading = write_title(
        canvas.panels[0] if canvas.panels else ax,
        canvas,
        titles[-1] if titles else title,
        bool(titles),
        _small_print(entries),
    )


def _legend_handles(entries: list[Entry], with_values: bool) -> dict[str, Any]:
    """Label and artist of what a legend shows: curves, evenly spread where they are
    many, then all else.
    """
    handles: dict[str, Any] = {}
    for entry, name in zip(entries, _names(entries), strict=True):
        count = min(len(entry.lines), _LEGEND)
        spread = np.linspace(0, len(entry.lines) - 1, count).round().astype(int)
        for handle, curve, value in (entry.lines[i] for i in np.unique(spread)):
            label = ", ".join(filter(None, (name, curve)))
            if label and value and with_values:
                label = f"{label}: {value}"
            if label:
                handles.setdefault(label.replace("degC", "°C"), handle)
    for handle, label in (extra for entry in entries for extra in entry.extras):
        handles.setdefault(label.replace("degC", "°C"), handle)
    return handles


def _small_print(entries: list[Entry]) -> tuple[str, str, str]:
    """Models, notes and what failed."""
    models = dict.fromkeys(entry.model for entry in entries)
    notes = dict.fromkeys(note for entry in entries for note in entry.notes)
    of_doubts = notes_of((e.inputs.get("material", ""), e.doubts) for e in entries)
    notes = {**dict.fromkeys(of_doubts), **notes}
    counts = zip(*(entry.counted for entry in entries), strict=True)
    failed, count = map(sum, counts)
    missing = f"{failed} of {count} {entries[0].each} did not converge and are left out"
    return "; ".join(models), "; ".join(notes), missing if failed else ""


def _names(entries: list[Entry]) -> list[str]:
    """What sets results apart: the label that was asked for, or else the fewest inputs
    that differ.
    """
    if len(entries) == 1:
        return [entries[0].asked.label or ""]
    properties = [
        {
            **entry.inputs,
            "model": entry.model.split(" (")[0],
            "shown": entry.labels[1].partition(" [")[0].lower(),
        }
        for entry in entries
    ]
    keys = dict.fromkeys(
        ["shown", "material", *(key for each in properties for key in each)]
    )
    names: list[list[str]] = [[] for _ in entries]
    unlabelled = [i for i, entry in enumerate(entries) if not entry.asked.label]
    for key in keys:
        values = [each.get(key, "") for each in properties]
        distinct = len({tuple(names[i]) for i in unlabelled})
        if len({(*names[i], values[i]) for i in unlabelled}) > distinct:
            for i in unlabelled:
                names[i].append(values[i])
    alike = unlabelled and not any(names[i] for i in unlabelled)
    return [
        entry.asked.label
        or ", ".join(filter(None, name))
        or (entry.inputs.get("material", "") if alike else "")
        for entry, name in zip(entries, names, strict=True)
    ]


def _write_legend(ax: Any, canvas: Canvas, handles: dict[str, Any]) -> None:
    """Beside the axes; in a paper above them, in as many columns as fit, where it
    covers nothing.
    """
    style = canvas.style
    labels = [textwrap.fill(label, 48) for label in handles]
    common = {"frameon": False, "borderaxespad": 0.2, "fontsize": 0.85 * style.text}
    if style.words and not crowded(ax, canvas):
        if canvas.own_figure:
            width = style.panels[0] + 2.2 if canvas.panels else style.wide
            ax.figure.set_size_inches(width, ax.figure.get_size_inches()[1])
        common |= {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0)}
        ax.legend(handles.values(), labels, **common)
        return
    common |= {"handlelength": 1.5, "columnspacing": 1.2}
    common["ncols"] = columns = _legend_columns(ax, style, labels)
    if canvas.own_figure:
        rows = -(-len(labels) // columns) + sum(label.count("\n") for label in labels)
        height = style.panels[1] if canvas.panels else style.size[1]
        ax.figure.set_size_inches(style.wide, height + 0.14 * rows)
    if style.words:
        common |= below(ax, style)
    else:
        common |= {"loc": "lower left", "fontsize": style.text - 0.5}
        common["bbox_to_anchor"] = (0.0, 1.0)
    if not canvas.panels:
        ax.legend(handles.values(), labels, **common)
        return
    for legend in ax.figure.legends[:]:
        legend.remove()
    del common["bbox_to_anchor"]
    common["loc"] = "outside upper left"
    ax.figure.legend(handles.values(), labels, **common)


def _legend_columns(ax: Any, style: Style, labels: list[str]) -> int:
    """How many columns of a legend fit above or below the axes."""
    inches = STYLES["paper"].wide
    if style.words:
        position = ax.get_position(original=True)
        inches = ax.figure.get_size_inches()[0] * position.width
    room = int(inches * 120 / style.text)  # letters
    return max(1, min(len(labels), room // (max(map(len, labels)) + 7)))


def crowded(ax: Any, canvas: Canvas) -> bool:
    """Whether the axes are some of several that matplotlib lays out: a legend beside
    them takes their width.
    """
    return (
        not canvas.own_figure
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
    figure, font_size = ax.figure.get_figure(root=True), canvas.style.text
    if canvas.panels:
        left = 0.01 if figure.get_layout_engine() else ax.get_position().x0
        figure.suptitle(
            title,
            x=left,
            ha="left",
            fontsize=1.2 * font_size,
            fontweight="bold",
            color=INK,
        )
    inches = figure.get_size_inches()[0] * ax.get_position(original=True).width
    above = {
        "xy": (0, 1),
        "xycoords": "axes fraction",
        "textcoords": "offset points",
        "va": "bottom",
        "fontsize": 0.8 * font_size,
    }
    made, height = [], 0.6 * font_size
    for words, colour in zip(reversed(small), (RED, FAINT, FAINT), strict=True):
        lines = textwrap.wrap(words, max(30, int(170 * inches / font_size)))
        place = {"xytext": (0, height), "color": colour, "linespacing": 1.2, **above}
        made += [ax.annotate("\n".join(lines), **place)] if lines else []
        height += 1.2 * font_size * len(lines)
    if not canvas.panels:
        heading = "\n".join(textwrap.wrap(title, max(24, int(95 * inches / font_size))))
        ax.set_title(
            heading,
            loc="left",
            fontsize=1.2 * font_size,
            fontweight="bold",
            color=INK,
            pad=height + 0.4 * font_size,
        )
    return made


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
    if later.size and (x >= 0).all() and later.max() > LOG_RATIO * later.min():
        if later.size < x.size:
            ax.set_xscale("symlog", linthresh=later.min(), linscale=0.3)
        else:
            ax.set_xscale("log")


def unit_of(label: str) -> str:
    """The unit of an axis' label."""
    return label.rpartition(" [")[2].rstrip("]") if label.endswith("]") else ""


def _joined_label(labels: list[str]) -> str:
    """The label of an axis along which there are several quantities of one unit. Raises
    `InputError` for several.
    """
    labels = list(dict.fromkeys(labels))
    units = {unit_of(label) for label in labels}
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
