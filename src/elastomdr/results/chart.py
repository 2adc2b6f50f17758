"""Figures that one can point at: the marks of a figure of `results/plotting.py` as data
and layout of plotly, for notebooks and the page.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from .plotting import (
    GRID,
    Across,
    Caption,
    Entry,
    Mark,
    Shaded,
    Trace,
    canvas_of,
    heading,
    names,
    sentence,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from plotly.graph_objects import Figure  # pyright: ignore[reportMissingImports]

    # of plotly, as in JSON
    Options: TypeAlias = dict[str, object]

_DASHES = {"-": "solid", "--": "dash", ":": "dot", "-.": "dashdot"}
_SYMBOLS = {
    "s": "square",
    "^": "triangle-up",
    "v": "triangle-down",
    "<": "triangle-left",
    ">": "triangle-right",
    "D": "diamond",
    "_": "line-ew-open",
    "|": "line-ns-open",
}
_LETTERS = {
    r"\omega": "ω",
    r"\lambda": "λ",
    r"\sqrt": "√",
    r"\log_{10}": "log₁₀",
    r"\,": " ",
}
_MOST = 2000  # points of a curve; the tables have all of them
_LINE = 2.4  # width of a curve [pixels]
_EDGE = "#444444"
_PANEL, _HEIGHT = 520, 460  # pixels of a panel in a notebook


class Chart(NamedTuple):
    """One panel of a figure."""

    title: str
    sentence: str  # in small print
    labels: tuple[str, str]  # of the axes
    lines: list[tuple[Trace, str]]  # with their names
    data: list[Options]  # traces
    shapes: list[Options]
    layout: Options


def charts(axes: Axes) -> list[Chart]:
    """Each panel of the figure that the axes belong to, in order."""
    every = (_chart(panel) for panel in axes.figure.axes)
    return [chart for chart in every if chart is not None]


def plain(label: str) -> str:
    """A label of matplotlib, which may hold formulas, in plain letters."""
    for command, letter in _LETTERS.items():
        label = label.replace(command, letter)
    return re.sub(r"[${}]", "", label)


def points(charts: Sequence[Chart]) -> Iterator[list[object]]:
    """All points of the curves of charts with the ends of their bands, as rows."""
    for chart in charts:
        yield ["curve", *chart.labels, "lower end", "upper end"]
        for line, name in chart.lines:
            ends = [] if line.band is None else [line.band.low, line.band.high]
            for row in zip(line.x, line.y, *ends, strict=True):
                yield [name, *row]


def as_plotly(make_subplots: Callable[..., Figure], axes: Axes) -> Figure:
    """The figure that the axes belong to, by the function of this name of plotly."""
    panels = charts(axes)
    figure = make_subplots(1, len(panels))
    for column, chart in enumerate(panels, 1):
        for trace in chart.data:
            figure.add_trace(trace, row=1, col=column)
        for shape in chart.shapes:
            figure.add_shape(shape, row=1, col=column)
        figure.update_xaxes(chart.layout["xaxis"], row=1, col=column)
        figure.update_yaxes(chart.layout["yaxis"], row=1, col=column)
    title, small = panels[0].title, panels[0].sentence
    figure.update_layout(
        title=f"{title}<br><sup>{small}</sup>" if small else title,
        template="none",
        hovermode=panels[0].layout["hovermode"],
        width=_PANEL * len(panels) + 240,
        height=_HEIGHT,
    )
    return figure


def _chart(ax: Axes) -> Chart | None:
    canvas = canvas_of(ax)
    if canvas is None or not canvas.entries:
        return None
    entries, first = canvas.entries, ax is canvas.panels[0]
    # a band lies behind all curves
    marks = sorted(
        (pair for pair in _marks(entries) if pair[0].ax is ax),
        key=lambda pair: not isinstance(pair[0], Shaded),
    )
    lines = [(mark, name) for mark, name in marks if isinstance(mark, Trace)]
    curves = [mark for mark, _ in lines if mark.dashes and mark.x.size > 1]
    together = len({mark.x.tobytes() for mark in curves}) == 1
    labels = plain(ax.get_xlabel()), plain(ax.get_ylabel())
    shown = {""}
    data: list[Options] = []
    for mark, name in marks:
        named = (bool(mark.label) or mark.is_curve) and name not in shown
        shown |= {name} if named else set()
        called = name or labels[1]
        for trace in _traces(mark, together):
            about = {"type": "scatter", "name": called, "legendgroup": called}
            data.append(about | {"showlegend": named} | trace)
            named = False
    layout: Options = {
        "xaxis": _axis(ax.xaxis, labels[0]),
        "yaxis": _axis(ax.yaxis, labels[1]),
        "hovermode": "x unified" if together else "closest",
    }
    return Chart(
        heading(entries) if first else "",
        sentence(entries) if first else "",
        labels,
        lines,
        data,
        [_shape(mark) for mark, _ in marks if isinstance(mark, Across)],
        layout,
    )


def _marks(entries: Sequence[Entry]) -> Iterator[tuple[Mark, str]]:
    """Marks and their names: those of the legend, else of the curve that they go with."""
    for entry, named in zip(entries, names(entries), strict=True):
        latest: dict[str, str] = {}
        for mark in entry.marks:
            if mark in named:
                latest[mark.colour] = plain(named[mark])
            yield mark, latest.get(mark.colour, "")


def _traces(mark: Mark, together: bool) -> Iterator[Options]:
    """A mark as traces; a rule is a shape."""
    if isinstance(mark, Shaded):
        few = np.flatnonzero(mark.known())
        few = few[_few(few.size)]
        x, low, high = (each[few] for each in (mark.x, mark.low, mark.high))
        yield {
            "x": [*x, *x[::-1]],
            "y": [*low, *high[::-1]],
            "mode": "none",
            "fill": "toself",
            "fillcolor": mark.colour,
            "opacity": mark.opacity,
            "hoverinfo": "skip",
        }
    elif isinstance(mark, Caption):
        sides = {"left": "right", "right": "left"}
        yield {
            "x": [mark.x],
            "y": [mark.y],
            "mode": "text",
            "text": [mark.text],
            "textposition": f"top {sides.get(mark.side, 'center')}",
            "hoverinfo": "skip",
        }
    elif isinstance(mark, Trace):
        sure, doubted = mark.parts()
        yield _curve(mark, sure, mark.dashes, together)
        if doubted is not None:
            yield _curve(mark, doubted, ":", together)


def _curve(mark: Trace, y: np.ndarray, dashes: str, together: bool) -> Options:
    symbol = _SYMBOLS.get(mark.mark, "circle")
    few = _few(mark.x.size)
    at = "%{y:.4~g}" if together else "%{x:.4~g}: %{y:.4~g}"
    ends = _ends(mark)
    said: Options = {
        "customdata": [ends[i] for i in few],
        "hovertemplate": at + "%{customdata}",
    }
    modes = {"lines": dashes, "markers": mark.mark}
    drawn: Options = {
        "x": _known(mark.x[few]),
        "y": _known(y[few]),
        "mode": "+".join(mode for mode, on in modes.items() if on),
        "line": {
            "color": mark.colour,
            "dash": _DASHES.get(dashes, "solid"),
            "width": _LINE * mark.width,
        },
        "marker": {
            "color": mark.colour,
            "symbol": symbol + "-open" * bool(mark.hollow),
            "size": max(5.0, _LINE * mark.size),
        },
    }
    return drawn | ({"hoverinfo": "skip"} if mark.silent else said)


def _few(count: int) -> np.ndarray:
    """Which of so many points are drawn: evenly, with the first and the last."""
    return np.linspace(0, count - 1, min(count, _MOST)).round().astype(int)


def _ends(mark: Trace) -> list[str]:
    """The ends of the band at each point of a curve, in words."""
    if mark.band is None:
        return [""] * mark.x.size
    ends = zip(mark.band.low, mark.band.high, strict=True)
    return [
        f" ({low:.3g} to {high:.3g})" if np.isfinite(low + high) else ""
        for low, high in ends
    ]


def _shape(mark: Across) -> Options:
    """A line across the whole panel."""
    along, across = "yx" if mark.x is None else "xy"
    at, name = mark.y if mark.x is None else mark.x, plain(mark.label)
    return {
        "type": "line",
        f"{across}ref": f"{across} domain",
        f"{across}0": 0,
        f"{across}1": 1,
        f"{along}0": at,
        f"{along}1": at,
        "layer": "below",
        "line": {
            "color": mark.colour,
            "dash": _DASHES[mark.dashes],
            "width": _LINE * mark.width,
        },
        "name": name,
        "showlegend": bool(name),
    }


def _axis(axis: Axis, label: str) -> Options:
    """One axis with its limits, logarithmic where the figure's is."""
    logarithmic = axis.get_scale() == "log"
    ends = np.array(axis.get_view_interval(), dtype=float)
    wide = logarithmic and max(ends) > 100 * min(ends)
    return {
        "title": {"text": label},
        "type": "log" if logarithmic else "linear",
        "range": [float(end) for end in (np.log10(ends) if logarithmic else ends)],
        "gridcolor": GRID,
        "linecolor": _EDGE,
        "showline": True,
        "zeroline": False,
        "ticks": "outside",
        "exponentformat": "power",
        "hoverformat": ".4~g",
        "showticklabels": len(axis.get_majorticklocs()) > 0,
        "automargin": True,
        **({"dtick": 1} if wide else {}),
    }


def _known(values: np.ndarray) -> list[float | None]:
    """Numbers as JSON knows them, without NaN."""
    return [float(each) if np.isfinite(each) else None for each in values]
