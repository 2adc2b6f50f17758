"""Figures, described once: lines, bands, rules and words on axes.

A `Sketch` is what is drawn together, such as one result. It draws its marks with
matplotlib as they come, and they are kept with the axes, where `results/chart.py` reads
them to draw the same with plotly. Title, sentence and legend are made anew for all that
has been drawn on the same axes: the legend names what the results differ in.
"""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Protocol, TypeAlias, TypeVar

import numpy as np

from ..checks import Array
from ..errors import InputError
from .axes import Axis, Curve, Label, Quantity, few
from .doubts import SHORT, Doubt
from .words import in_unit

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .._types import ArrayLike

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


class Style(NamedTuple):
    """Sizes of a figure."""

    size: tuple[float, float]  # [inches]
    panels: tuple[float, float]  # size with four panels [inches]
    text: float  # size of the labels' letters [points]
    line: float  # width of a curve [points]
    words: bool  # whether there is a title and a sentence
    dpi: int
    settings: Mapping[str, float]


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
    None: Style((5.2, 3.5), (8.4, 5.8), 10.0, 1.8, True, 200, {}),
    # a column of 85 mm
    "paper": Style((3.346, 2.3), (3.346, 3.2), 7.5, 1.1, False, 300, _FINE),
}


class DrawAsk(NamedTuple):
    """How something is to be drawn."""

    ax: Axes | None = None
    style: str | None = None
    title: str | None = None
    label: str | None = None
    group: bool = False  # whether it is one of several materials


class Drawable(Protocol):
    """What a figure asks of a result."""

    title: ClassVar[str]
    across: ClassVar[str]
    shows: ClassVar[str]
    last: ClassVar[str]
    scale: ClassVar[str]
    each: ClassVar[str]
    from_zero: ClassVar[bool]

    @property
    def inputs(self) -> tuple[tuple[str, str], ...]: ...
    @property
    def converged(self) -> Array: ...
    @property
    def doubts(self) -> tuple[Doubt, ...]: ...
    def quantities(self) -> list[Quantity]: ...
    def fields(self, dims: str | None = "...") -> dict[Quantity, np.ndarray]: ...
    def curves(self, along: str = "velocity") -> tuple[Axis, list[Curve]]: ...
    def heading(self) -> str: ...
    def short_model(self) -> str: ...
    def counted(self) -> tuple[int, int]: ...


class Panels(NamedTuple):
    """How a new figure is divided; its first Axes are the ones that are returned."""

    rows: int
    columns: int = 1
    heights: Sequence[float] | None = None
    same_x: bool = False


# ------------------------------------------------------------------------------------------
# what a figure consists of


@dataclass(eq=False)
class Trace:
    """A curve, or points without `dashes`; widths and sizes are in those of a curve."""

    x: np.ndarray
    y: np.ndarray
    label: str = ""  # in the legend
    is_curve: bool = False  # the legend says whose it is, and names some of many
    colour: str = INK
    dashes: str = "-"
    width: float = 1.0
    mark: str = ""
    hollow: str = ""  # the colour within a mark
    size: float = 2.2  # of a mark
    dotted: np.ndarray | None = None  # where it is to be doubted
    silent: bool = False  # nothing is said of it where one points at it
    layer: float = 3.0
    ax: Axes | None = None
    band: Shaded | None = None  # around it

    def parts(self) -> tuple[np.ndarray, np.ndarray | None]:
        """y where it is sure, and y where it is to be doubted, up to the neighbours so
        that there is no gap; None where there is no doubt.
        """
        if self.dotted is None or not self.dotted.any():
            return self.y, None
        near = self.dotted.copy()
        near[1:] |= self.dotted[:-1]
        near[:-1] |= self.dotted[1:]
        sure = np.where(self.dotted, np.nan, self.y)
        return sure, np.where(near, self.y, np.nan)

    def draw(self, ax: Axes, style: Style) -> Artist:
        """Draws it with matplotlib."""
        look = {
            "color": self.colour,
            "marker": self.mark,
            "markersize": self.size * style.line,
            "markeredgewidth": 0.6 * style.line,
            "zorder": self.layer,
        }
        (sure, doubted), width = self.parts(), self.width * style.line
        line = {"linestyle": self.dashes or "none", "linewidth": width}
        face = self.hollow or self.colour
        (drawn,) = ax.plot(self.x, sure, markerfacecolor=face, **line, **look)
        if doubted is not None:
            thin = {"linestyle": ":", "linewidth": 0.7 * width}
            ax.plot(self.x, doubted, markerfacecolor="none", **thin, **look)
        return drawn


@dataclass(eq=False)
class Dots(Trace):
    """Points, such as those that were measured."""

    dashes: str = ""
    mark: str = "o"


def intervals(
    x: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    colour: str = FAINT,
    ax: Axes | None = None,
) -> Trace:
    """Bars from low to high."""
    y = np.stack([low, high, np.full(np.shape(low), np.nan)], -1).ravel()
    return Trace(
        np.repeat(x, 3),
        y,
        colour=colour,
        width=0.5,
        mark="_",
        size=1.8,
        silent=True,
        layer=2.0,
        ax=ax,
    )


@dataclass(eq=False)
class Shaded:
    """An area between two curves."""

    x: np.ndarray
    low: np.ndarray
    high: np.ndarray
    label: str = ""
    colour: str = FAINT
    opacity: float = LIGHT
    layer: float = 2.0
    ax: Axes | None = None
    of: Trace | None = None  # the curve that it is around
    is_curve: ClassVar[bool] = False

    def known(self) -> np.ndarray:
        """Where both ends are."""
        return np.isfinite(self.low) & np.isfinite(self.high)

    def draw(self, ax: Axes, style: Style) -> Artist:
        """Draws it with matplotlib."""
        if self.of is not None:
            self.of.band = self
        look = {"color": self.colour, "alpha": self.opacity, "zorder": self.layer}
        return ax.fill_between(
            self.x, self.low, self.high, where=self.known(), linewidth=0, **look
        )


_LINES = ("-", "-.", "--")  # of curves that a second axis sets apart


@dataclass(eq=False)
class Across:
    """A line across the axes, at one x or at one y."""

    label: str = ""
    x: float | None = None
    y: float | None = None
    colour: str = "#888888"
    dashes: str = "-"
    width: float = 0.5
    layer: float = 1.0
    ax: Axes | None = None
    is_curve: ClassVar[bool] = False

    def draw(self, ax: Axes, style: Style) -> Artist:
        """Draws it with matplotlib."""
        look = {"color": self.colour, "linestyle": self.dashes, "zorder": self.layer}
        look["linewidth"] = self.width * style.line
        if self.x is not None:
            return ax.axvline(self.x, **look)
        assert self.y is not None
        return ax.axhline(self.y, **look)


@dataclass(eq=False)
class Caption:
    """A text beside a place."""

    text: str
    x: float
    y: float
    colour: str = INK
    side: str = "center"
    offset: tuple[float, float] = (0.0, 8.0)  # [points]
    ax: Axes | None = None
    label: ClassVar[str] = ""
    is_curve: ClassVar[bool] = False

    def draw(self, ax: Axes, style: Style) -> Artist:
        """Draws it with matplotlib."""
        return ax.annotate(
            self.text,
            (self.x, self.y),
            self.offset,
            textcoords="offset points",
            fontsize=0.9 * style.text,
            color=self.colour,
            ha=self.side,
            va="bottom",
        )


Mark: TypeAlias = Trace | Shaded | Across | Caption
M = TypeVar("M", bound=Mark)


@dataclass
class Entry:
    """What has been drawn together, such as one result."""

    heading: str
    title: str
    labels: tuple[Label, Label]  # of the axes, for this alone
    model: str = ""
    inputs: Mapping[str, str] = field(default_factory=dict)
    asked: DrawAsk = field(default_factory=DrawAsk)
    each: str = ""
    counted: tuple[int, int] = (0, 0)
    doubts: tuple[Doubt, ...] = ()
    marks: dict[Mark, Artist] = field(default_factory=dict)  # with what draws them
    notes: list[str] = field(default_factory=list)


@dataclass
class Canvas:
    """What has been drawn on axes, and what has to be made anew when more is drawn."""

    style: Style
    own_figure: bool  # the figure was made here
    foreign: bool  # something was drawn before
    panels: list[Axes]
    entries: list[Entry] = field(default_factory=list)
    limits: object = None  # of x and y, as they were left
    heading: list[Artist] = field(default_factory=list)  # artists of the title

    @property
    def several(self) -> bool:
        """Whether the figure has several panels."""
        return len(self.panels) > 1


def canvas_of(ax: Axes | None) -> Canvas | None:
    """What has been drawn on axes by this package."""
    return getattr(ax, "_elastomdr", None)


def figure_of(ax: Axes) -> Figure:
    """The figure that axes belong to."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure


class Sketch:
    """What is drawn together, on its way onto axes."""

    def __init__(self, ask: DrawAsk, entry: Entry, panels: Panels | None = None):
        self.canvas = begin(ask, panels)
        self.ax = ask.ax or self.canvas.panels[0]
        entries = self.canvas.entries
        self.labels = [
            _joined_label([e.labels[i] for e in entries] + [entry.labels[i]])
            for i in (0, 1)
        ]
        self.before = self.ax.get_xlim(), self.ax.get_ylim()
        if self.canvas.limits == self.before:  # nobody has set others since
            self.ax.autoscale()
        self.entry, self.ask, self.style = entry, ask, self.canvas.style
        self.drawn = len(entries) + self.canvas.foreign
        self.alone = not self.drawn and not ask.group

    def colours(self, count: int) -> list[str]:
        """Of curves: shades of one colour, of viridis where nothing else is drawn."""
        from matplotlib.colors import to_hex, to_rgb

        colour = PALETTE[self.drawn % len(PALETTE)]
        if count == 1:
            return [colour]
        if self.alone:
            return shades(count)
        return [
            to_hex(tuple(1 - (1 - np.array(to_rgb(colour))) * (1 - pale)))
            for pale in np.linspace(0.0, 0.65, count)
        ]

    def add(self, mark: M) -> M:
        """Draws a mark; an area of nothing that is known would spoil the limits."""
        mark.ax = mark.ax or self.ax
        if isinstance(mark, Shaded) and not mark.known().any():
            return mark
        self.entry.marks[mark] = mark.draw(mark.ax, self.style)
        return mark

    def explain(self, label: str, dashes: str) -> None:
        """Says in the legend what lines of a kind mean."""
        if self.style.words:
            none = np.array([np.nan])
            look = {"colour": FAINT, "dashes": dashes, "width": 0.7}
            self.add(Trace(none, none, label, silent=True, **look))

    def finish(self) -> Axes:
        """Labels, frames, title and legend of the axes; returns them."""
        self.ax.set(xlabel=str(self.labels[0]), ylabel=str(self.labels[1]))
        for ax in {id(ax): ax for ax in (self.ax, *self.canvas.panels)}.values():
            frame(ax)
        self.canvas.entries.append(self.entry)
        _dress(self.canvas)
        self.canvas.limits = self.ax.get_xlim(), self.ax.get_ylim()
        return self.canvas.panels[0]


class DrawnLine(NamedTuple):
    """A curve of a result, to draw."""

    curve: Curve
    order: np.ndarray  # of its points, so that x ascends
    si: np.ndarray  # x in SI units
    x: np.ndarray  # in the unit of the figure
    y: np.ndarray
    colour: str
    dashes: str
    dotted: np.ndarray  # where it is to be doubted


class ResultSketch(Sketch):
    """One result on its way onto axes: field `y` over field `x`."""

    def __init__(
        self,
        result: Drawable,
        ask: DrawAsk,
        x: str = "",
        y: str = "",
        panels: Panels | None = None,
        labels: tuple[Label, Label] | None = None,
    ):
        self.result = result
        self.fields = {q.key: values for q, values in result.fields(None).items()}
        self.about = {q.key: q for q in result.quantities()}
        self.x, self.y = x or result.across, y or result.shows
        self.axis, every = result.curves(result.last or self.x)
        self.curves = few(every)
        # x has values of its own
        self.along = (
            bool(result.last) or self.axis.name == self.x or not self.axis.known
        )
        about = self.about[self.x] if self.along else self.axis.quantity
        self.x_unit = about.shown if about else ""
        along = about.axis_label if about else Label(self.axis.name.capitalize())
        entry = Entry(
            result.heading(),
            result.title,
            labels or (along, self.about[self.y].axis_label),
            result.short_model(),
            dict(result.inputs),
            ask,
            result.each,
            result.counted(),
            result.doubts,
        )
        if len(self.curves) < len(every):
            entry.notes.append(f"{len(self.curves)} of {len(every)} curves drawn")
        super().__init__(ask, entry, panels)
        self.dotted = dotted(result.doubts, np.shape(result.converged))

    def lines(self) -> Iterator[DrawnLine]:
        """The curves, each with ascending x, in the units of the figure."""
        for curve, (colour, dashes) in zip(self.curves, self._looks(), strict=True):
            x = (
                np.atleast_1d(self.fields[self.x][curve.place])
                if self.along
                else np.asarray(self.axis.values, dtype=float)
            )
            order = (
                np.arange(x.size) if self.result.last else np.argsort(x, kind="stable")
            )
            yield DrawnLine(
                curve,
                order,
                x[order],
                in_unit(x[order], self.x_unit),
                self.shown(self.y, curve)[order],
                colour,
                dashes,
                np.atleast_1d(self.dotted[curve.place])[order],
            )

    def _looks(self) -> list[tuple[str, str]]:
        """Colour and line of each curve: where two axes set them apart, one by each, the
        later one by its line unless it has more values than there are lines.
        """
        places = [[i for i in each.place if isinstance(i, int)] for each in self.curves]
        index = np.array(places, int).reshape(len(places), -1)
        sizes = index.max(axis=0, initial=0) + 1
        axes = np.flatnonzero(sizes > 1)
        fits = [i for i in axes if sizes[i] <= len(_LINES)]
        if axes.size != 2 or not fits:
            return [(colour, "-") for colour in self.colours(len(places))]
        by_line = fits[-1]
        (by_colour,) = axes[axes != by_line]
        colours = self.colours(int(sizes[by_colour]))
        return [(colours[i[by_colour]], _LINES[i[by_line]]) for i in index]

    def shown(self, key: str, curve: Curve) -> np.ndarray:
        """A field along a curve, in the unit of a figure."""
        values = np.atleast_1d(self.fields[key][curve.place])
        return in_unit(values, self.about[key].shown)

    def curve(
        self,
        line: DrawnLine,
        label: str = "",
        mark: str = "",
    ) -> Trace:
        """Draws a curve, dotted where it is to be doubted; `label` stands in the legend
        in place of that of the curve.
        """
        seen = bool(np.isfinite(line.y).any())
        return self.add(
            Trace(
                line.x,
                line.y,
                (label or line.curve.label) if seen else "",
                is_curve=seen,
                colour=line.colour,
                dashes=line.dashes,
                mark=mark or ("o" if line.x.size == 1 else ""),
                size=2.6,
                dotted=line.dotted,
            )
        )

    def along_line(self, values: np.ndarray, line: DrawnLine) -> np.ndarray:
        """Values of the result's shape at the points of a line."""
        return np.atleast_1d(values[line.curve.place])[line.order]

    def finish(self) -> Axes:
        doubts = self.result.doubts
        dots = [doubt.kind for doubt in doubts if drawn_dotted(doubt)]
        if dots:
            self.explain(" or ".join(dict.fromkeys(dots)), ":")
        self.set_scale()
        return super().finish()

    def set_scale(self) -> None:
        """Of the horizontal axis, after the lines and before any limits: those would
        else be made on a linear one.
        """
        if self.along and self.result.scale == "log":
            self.ax.set_xscale("log")
        elif self.along and self.result.scale == "auto":
            every = [m for e in (*self.canvas.entries, self.entry) for m in e.marks]
            x = [mark.x for mark in every if isinstance(mark, Trace)]
            _logarithmic_if_crowded(self.ax, np.concatenate(x) if x else np.ones(1))


def begin(ask: DrawAsk, panels: Panels | None = None) -> Canvas:
    """The axes to draw on, new ones where none are given, with what has been drawn
    there. Raises `InputError`.
    """
    if ask.style not in STYLES:
        raise InputError(argument="style", got=ask.style, accepted='None or "paper"')
    style, ax = STYLES[ask.style], ask.ax
    if ax is None:
        return _new_canvas(style, panels)
    if not hasattr(ax, "set_xlabel"):
        raise InputError(
            argument="ax",
            got=ax,
            accepted="matplotlib Axes, or None for a new figure",
            hint="a style is given as style=",
        )
    canvas = canvas_of(ax)
    if canvas is None:
        import matplotlib

        if style.words:  # as large as the letters that are there
            style = style._replace(text=float(matplotlib.rcParams["font.size"]))
        canvas = Canvas(style, own_figure=False, foreign=ax.has_data(), panels=[ax])
        vars(ax)["_elastomdr"] = canvas
    on = {id(panel) for panel in canvas.panels}
    canvas.entries = [
        entry
        for entry in canvas.entries  # the others were cleared
        if all(
            id(artist.axes) in on
            for mark, artist in entry.marks.items()
            if not isinstance(mark, Caption)
        )
    ]
    return canvas


def _new_canvas(style: Style, panels: Panels | None) -> Canvas:
    import matplotlib
    from matplotlib.figure import Figure

    rows, columns, heights, same_x = panels or Panels(1)
    settings: dict = {**style.settings, "font.size": style.text}
    with matplotlib.rc_context(settings):
        size = style.size if panels is None else style.panels
        grid = Figure(figsize=size, layout="constrained").subplots(
            rows,
            columns,
            squeeze=False,
            sharex=same_x,
            height_ratios=heights,
        )
    canvas = Canvas(style, own_figure=True, foreign=False, panels=list(grid.flat))
    for ax in canvas.panels:
        vars(ax)["_elastomdr"] = canvas
    return canvas


def draw(
    result: Drawable,
    ask: DrawAsk,
    x: str = "",
    y: str = "",
    also: Callable[[ResultSketch, DrawnLine, Trace], None] | None = None,
) -> Axes:
    """Draws one field over another, one line per further index, and what `also` adds to
    each line.
    """
    sketch = ResultSketch(result, ask, x, y)
    for line in sketch.lines():
        drawn = sketch.curve(line)
        if also is not None:
            also(sketch, line, drawn)
    sketch.set_scale()
    if result.from_zero:
        sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def logarithmic_if_wide(ax: Axes, values: ArrayLike, ratio: float = LOG_RATIO) -> None:
    """A logarithmic vertical axis where these values are spread that widely."""
    values = np.asarray(values, dtype=float)
    known = values[np.isfinite(values) & (values > 0)]
    if known.size and known.max() > ratio * known.min():
        ax.set_yscale("log")
        frame(ax)


def shades(count: int) -> list[str]:
    """Colours of viridis, for what is in order."""
    import matplotlib
    from matplotlib.colors import to_hex

    every = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.87, max(count, 2)))
    return [to_hex(each) for each in every[:count]]


def saved(ax: Axes, model: str = "", kind: str = "png") -> bytes:
    """The figure that the axes belong to as an image; the model's name goes with it
    as its description.
    """
    buffer = io.BytesIO()
    canvas = canvas_of(ax)
    figure_of(ax).savefig(
        buffer,
        format=kind,
        dpi=(canvas.style if canvas else STYLES[None]).dpi,
        metadata={"Description": model} if model else None,
    )
    return buffer.getvalue()


def drawn_dotted(doubt: Doubt) -> bool:
    """Whether curves are dotted there: beyond the range of the material, and where a
    model that has a bound elsewhere has none.
    """
    return doubt.kind == "extrapolated" or (
        doubt.kind == "no prediction" and not np.asarray(doubt.points).all()
    )


def dotted(doubts: Iterable[Doubt], shape: tuple[int, ...]) -> np.ndarray:
    """Where a curve is drawn dotted."""
    points = np.zeros(shape, bool)
    for doubt in filter(drawn_dotted, doubts):
        points = points | np.broadcast_to(np.asarray(doubt.points), shape)
    return points


def in_short(results: Iterable[tuple[str, tuple[Doubt, ...]]]) -> list[str]:
    """The kinds of doubts of results, with the materials that they are of where these
    are not all; what did not converge is counted elsewhere.
    """
    results = list(results)
    said = []
    for kind, words in SHORT.items():
        names = [name for name, doubts in results if kind in {d.kind for d in doubts}]
        if names and kind != "not converged":
            which = f"{', '.join(dict.fromkeys(names))}: "
            said.append(words if len(names) == len(results) else which + words)
    return said


# ------------------------------------------------------------------------------------------
# frame, title, legend


def frame(ax: Axes) -> None:
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


def _power(value: float, _: float | None = None) -> str:
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


def _dress(canvas: Canvas) -> None:
    """Title, sentence and legend for all that has been drawn."""
    entries = canvas.entries
    handles: dict[str, Artist] = {}
    for entry, named in zip(entries, names(entries), strict=True):
        curves = [mark for mark in named if mark.is_curve]
        spread = np.linspace(0, len(curves) - 1, min(len(curves), _LEGEND))
        shown = {id(curves[round(i)]) for i in spread}
        for mark, label in named.items():
            entry.marks[mark].set_label(label)
            if not mark.is_curve or id(mark) in shown:
                handles.setdefault(label, entry.marks[mark])
    if handles:
        _write_legend(canvas, handles)
    titles = [entry.asked.title for entry in entries if entry.asked.title]
    if canvas.foreign and not titles:
        return
    for artist in canvas.heading:
        artist.remove()
    canvas.heading = _write_title(canvas, heading(entries), bool(titles))


def heading(entries: Sequence[Entry]) -> str:
    """The title: that which was asked for last, or of what is common."""
    for entry in reversed(entries):
        if entry.asked.title:
            return entry.asked.title
    alike = len({entry.heading for entry in entries}) == 1
    return entries[0].heading if alike else entries[0].title


def sentence(entries: Sequence[Entry]) -> str:
    """Models, what is to be doubted, and how many points failed."""
    said = dict.fromkeys(entry.model for entry in entries if entry.model)
    said |= dict.fromkeys(note for entry in entries for note in entry.notes)
    doubts = in_short((e.inputs.get("material", ""), e.doubts) for e in entries)
    failed, count = map(sum, zip(*(entry.counted for entry in entries), strict=True))
    if failed:
        doubts.append(f"{failed} of {count} {entries[0].each} not converged (left out)")
    doubts = [f"doubts: {', '.join(doubts)}"] if doubts else []
    return "; ".join([*said, *doubts])


def names(entries: Sequence[Entry]) -> list[Mapping[Mark, str]]:
    """Of each entry the marks that a legend may name, curves first, with their names."""
    named: list[Mapping[Mark, str]] = []
    for entry, name in zip(entries, _told_apart(entries), strict=True):
        of: dict[Mark, str] = {}
        for mark in sorted(entry.marks, key=lambda mark: not mark.is_curve):
            label = mark.label
            if mark.is_curve:
                label = ", ".join(filter(None, (name, label)))
            if label:
                of[mark] = label.replace("degC", "°C")
        named.append(of)
    return named


def _told_apart(entries: Sequence[Entry]) -> list[str]:
    """What sets results apart: the label that was asked for, or else the fewest inputs
    that differ.
    """
    properties = [
        {
            "shown": entry.labels[1].words.lower(),
            "material": "",
            **entry.inputs,
            "model": entry.model,
        }
        for entry in entries
    ]
    names = [""] * len(entries)
    for key in dict.fromkeys(key for each in properties for key in each):
        longer = [
            ", ".join(filter(None, (name, each.get(key))))
            for name, each in zip(names, properties, strict=True)
        ]
        if len(set(longer)) > len(set(names)):
            names = longer
    return [
        entry.asked.label or name for entry, name in zip(entries, names, strict=True)
    ]


def _write_legend(canvas: Canvas, handles: Mapping[str, Artist]) -> None:
    """Below the axes, of several panels below them all, in as many columns as fit."""
    from matplotlib.transforms import ScaledTranslation

    style, ax = canvas.style, canvas.panels[0]
    figure = figure_of(ax)
    labels = [textwrap.fill(label, 48) for label in handles]
    size = style.panels if canvas.several else style.size
    width = size[0] if canvas.own_figure else _room(ax)
    columns = _columns(labels, width * 130 / style.text)
    if canvas.own_figure:
        rows = -(-len(labels) // columns) + sum(label.count("\n") for label in labels)
        figure.set_size_inches(width, size[1] + 0.018 * style.text * rows)
    look = {"frameon": False, "fontsize": 0.9 * style.text, "ncols": columns}
    look |= {
        "handlelength": 2.3 if style.words else 1.5,
        "columnspacing": 1.2,
        "borderaxespad": 0.2,
    }
    if canvas.several:
        for legend in figure.legends[:]:
            legend.remove()
        figure.legend(handles.values(), labels, **look, loc="outside lower left")
        return
    down = ScaledTranslation(0.0, -0.045 * style.text, figure.dpi_scale_trans)
    look |= {"loc": "upper left", "bbox_transform": ax.transAxes + down}
    ax.legend(handles.values(), labels, **look, bbox_to_anchor=(0.0, 0.0))


def _columns(labels: Sequence[str], room: float) -> int:
    """The most columns of a legend that fit into so many letters; one after another is
    filled.
    """
    long = [max(map(len, label.splitlines())) + 8 for label in labels]
    for count in range(len(labels), 1, -1):
        if sum(max(part) for part in np.array_split(long, count)) <= room:
            return count
    return 1


def _room(ax: Axes) -> float:
    """The width that axes of others have in their figure, with their labels where a
    layout makes place for these [inches].
    """
    figure, shown = figure_of(ax), ax.get_position(original=True).width
    if figure.get_layout_engine():
        shown /= figure.subplotpars.right - figure.subplotpars.left
    return figure.get_size_inches()[0] * shown


def _write_title(canvas: Canvas, title: str, asked: bool) -> list[Artist]:
    """Above the axes the title, and below it in small print one sentence, red where
    points failed; in a paper only a title that was asked for. Returns the sentence.
    """
    ax, text = canvas.panels[0], canvas.style.text
    if not canvas.style.words:
        if asked:
            ax.set_title(title, loc="left", fontsize=text + 1)
        return []
    figure = figure_of(ax)
    bold = {"fontsize": 1.1 * text, "fontweight": "bold", "color": INK}
    inches = figure.get_size_inches()[0]
    if canvas.several:
        figure.suptitle(title, x=0.01, ha="left", **bold)
    if canvas.several:
        inches *= ax.get_position(original=True).width
    elif not canvas.own_figure:
        inches = _room(ax)
    lines = textwrap.wrap(sentence(canvas.entries), max(30, int(118 * inches / text)))
    if not canvas.several:
        wrapped = "\n".join(textwrap.wrap(title, max(24, int(95 * inches / text))))
        above = 1.25 * text * len(lines) + 0.9 * text
        ax.set_title(wrapped, loc="left", pad=above, **bold)
    if not lines:
        return []
    failed = any(entry.counted[0] for entry in canvas.entries)
    made = ax.annotate(
        "\n".join(lines),
        (0, 1),
        (0, 0.5 * text),
        xycoords="axes fraction",
        textcoords="offset points",
        va="bottom",
        fontsize=0.9 * text,
        color=RED if failed else FAINT,
    )
    return [made]


def _logarithmic_if_crowded(ax: Axes, x: np.ndarray) -> None:
    """A logarithmic horizontal axis where half of the values would lie near its end;
    zero keeps a place.
    """
    later = x[x > 0]
    crowded = later.size and later.max() > LOG_RATIO**0.5 * np.median(later)
    if crowded and not (x < 0).any():
        if (x == 0).any():
            ax.set_xscale("symlog", linthresh=later.min(), linscale=0.3)
        else:
            ax.set_xscale("log")


def _joined_label(labels: list[Label]) -> Label:
    """The label of an axis along which there are several quantities of one unit. Raises
    `InputError` for several.
    """
    labels = list(dict.fromkeys(labels))
    if len({label.unit for label in labels}) > 1:
        raise InputError(
            argument="ax",
            got=str(labels[0]),
            accepted=f"with the units of the result, {str(labels[-1])!r}",
            hint="draw it on axes of its own",
        )
    words = [label.words for label in labels]
    words[1:] = [word[0].lower() + word[1:] for word in words[1:]]
    return Label(", ".join(words), labels[0].unit)
