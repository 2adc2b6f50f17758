"""A figure of matplotlib as one of plotly, to point at and to zoom into."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from .chart import Chart, charts

_DASHES = {"solid": "solid", "dashed": "dash", "dotted": "dot"}
_SYMBOLS = {"rect": "square", "triangle": "triangle-up", "arrow": "triangle-down"}
_POINTS = 0.75  # pixels of a screen per point of print, inverted
_PANEL = 520  # pixels across a panel
_HEIGHT = 460


def as_plotly(plotly: Any, axes: Any) -> Any:
    """The figure that matplotlib's axes belong to: its curves, bands, points and
    labels. `plotly` is the package.
    """
    panels = charts(axes)
    figure = plotly.subplots.make_subplots(
        1, len(panels), subplot_titles=["", *(chart.title for chart in panels[1:])]
    )
    for column, chart in enumerate(panels, 1):
        for trace in _traces(chart):
            figure.add_trace(trace, row=1, col=column)
        across, up = (_axis(chart.options[axis]) for axis in ("xAxis", "yAxis"))
        figure.update_xaxes(**across, row=1, col=column)
        figure.update_yaxes(**up, row=1, col=column)
    small = "<br>".join(panels[0].notes)
    title = panels[0].title
    figure.update_layout(
        title=f"{title}<br><sup>{small}</sup>" if small else title,
        template="simple_white",
        width=_PANEL * len(panels) + 240,
        height=_HEIGHT,
    )
    return figure


def _traces(chart: Chart) -> Iterator[dict[str, Any]]:
    """Bands first, so that the curves are drawn over them; a name once in the legend."""
    series = chart.options["series"]
    names = list(chart.options["legend"]["data"])
    for each in sorted(series, key=lambda each: each["type"] != "custom"):
        if not each["data"]:  # a line across the axes
            continue
        x, y, *_ = zip(*(point[:2] for point in each["data"]), strict=True)
        name, is_curve = each["name"], each["type"] != "custom"
        shown = is_curve and name in names
        if shown:
            names.remove(name)
        place = {"x": x, "y": y, "name": name, "legendgroup": name, "showlegend": shown}
        if not is_curve:
            look = _band(each)
        elif "label" in each:
            look = {"mode": "text", "text": each["label"]["formatter"]}
        else:
            look = _curve(each)
        yield {"type": "scatter", **place, **look}


def _curve(each: dict[str, Any]) -> dict[str, Any]:
    line, symbol = each.get("lineStyle", {}), each.get("symbol", "circle")
    is_line = each["type"] == "line"
    marked = not is_line or each.get("showSymbol", False)
    hollow = symbol.startswith("empty")
    symbol = symbol.removeprefix("empty").lower()
    return {
        "mode": "+".join(["lines"] * is_line + ["markers"] * marked),
        "line": {
            "color": each["itemStyle"]["color"],
            "dash": _DASHES.get(str(line.get("type", "solid")), "dashdot"),
            "width": line.get("width", 1.0) / _POINTS,
        },
        "marker": {
            "color": each["itemStyle"]["color"],
            "symbol": _SYMBOLS.get(symbol, symbol) + "-open" * hollow,
        },
    }


def _band(each: dict[str, Any]) -> dict[str, Any]:
    return {
        "fill": "toself",
        "mode": "none",
        "fillcolor": each["itemStyle"]["color"],
        "opacity": each["opacity"],
        "hoverinfo": "skip",
    }


def _axis(options: dict[str, Any]) -> dict[str, Any]:
    logarithmic = options["type"] == "log"
    ends = np.array([options["min"], options["max"]])
    ends = np.log10(ends) if logarithmic else ends
    return {
        "title": options["name"],
        "type": "log" if logarithmic else "linear",
        "range": list(ends[:: -1 if options["inverse"] else 1]),
        "showgrid": True,
        "exponentformat": "power",
        **({"dtick": 1} if logarithmic else {}),
    }
