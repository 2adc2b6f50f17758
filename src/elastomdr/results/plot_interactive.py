"""A figure of matplotlib as one of plotly, to point at and to zoom into."""

from collections.abc import Iterator
from typing import Any

import numpy as np

_DASHES = {"-": "solid", "--": "dash", ":": "dot", "-.": "dashdot"}
_SYMBOLS = {
    "o": "circle",
    ".": "circle",
    "s": "square",
    "D": "diamond",
    "^": "triangle-up",
    "v": "triangle-down",
    "x": "x",
    "+": "cross",
}
_POINTS = 0.75  # pixels of a screen per point of print, inverted
_PANEL = 520  # pixels across a panel
_HEIGHT = 460


def as_plotly(plotly: Any, axes: Any) -> Any:
    """The figure that matplotlib's axes belong to: its curves, bands, points and
    labels. `plotly` is the package.
    """
    panels = [ax for ax in axes.figure.axes if ax.has_data()]
    figure = plotly.subplots.make_subplots(1, len(panels))
    for column, ax in enumerate(panels, 1):
        seen: set[str] = set()
        for trace in _traces(ax, seen):
            figure.add_trace(trace, row=1, col=column)
        figure.update_xaxes(**_axis(ax.xaxis, ax.get_xscale()), row=1, col=column)
        figure.update_yaxes(**_axis(ax.yaxis, ax.get_yscale()), row=1, col=column)
    figure.update_layout(
        title=_title(axes.figure, panels),
        template="simple_white",
        width=_PANEL * len(panels) + 240,
        height=_HEIGHT,
    )
    return figure


def _title(figure: Any, panels: list[Any]) -> str:
    """The title, and below it the small print that stands above the axes: model, rubbers
    that are illustrative, what lines mean.
    """
    title = next((ax.get_title(loc="left") for ax in panels), "")
    notes = [
        artist.get_text()
        for ax in panels
        for artist in ax.texts
        if getattr(artist, "xycoords", None) == "axes fraction"
    ]
    small = "<br>".join(" ".join(note.split()) for note in reversed(notes) if note)
    title = " ".join((figure.get_suptitle() or title).split())
    return f"{title}<br><sup>{small}</sup>" if small else title


def _traces(ax: Any, seen: set[str]) -> Iterator[dict[str, Any]]:
    """Bands first, so that the curves are drawn over them; a name once in the legend."""
    names = dict(zip(*_legend(ax), strict=True))
    by_colour = {_colour(line.get_color()): name for line, name in names.items()}
    for band in ax.collections:
        if band.get_facecolor().size and hasattr(band, "get_paths"):
            yield from _band(band, by_colour)
    for line in ax.get_lines():
        if line.get_transform() != ax.transData:  # a line across the axes
            continue
        name = names.get(line) or by_colour.get(_colour(line.get_color()), "")
        yield _curve(line, name, shown=bool(name) and name not in seen)
        seen.add(name)


def _legend(ax: Any) -> tuple[list[Any], list[str]]:
    """Lines and their names."""
    handles, labels = ax.get_legend_handles_labels()
    pairs = [(h, label) for h, label in zip(handles, labels, strict=True)]
    pairs = [pair for pair in pairs if hasattr(pair[0], "get_xydata")]
    return [line for line, _ in pairs], [_plain(label) for _, label in pairs]


def _curve(line: Any, name: str, shown: bool) -> dict[str, Any]:
    x, y = np.asarray(line.get_xydata(), dtype=float).T
    dash, symbol = line.get_linestyle(), line.get_marker()
    marked = symbol not in (None, "None", "none", "", " ")
    modes = ["lines"] * (dash in _DASHES) + ["markers"] * marked
    return {
        "type": "scatter",
        "x": x,
        "y": y,
        "mode": "+".join(modes) or "lines",
        "name": name,
        "legendgroup": name,
        "showlegend": shown,
        "line": {
            "color": _colour(line.get_color()),
            "dash": _DASHES.get(dash, "solid"),
            "width": line.get_linewidth() / _POINTS,
        },
        "marker": {"symbol": _SYMBOLS.get(symbol, "circle")},
    }


def _band(band: Any, by_colour: dict[str, str]) -> Iterator[dict[str, Any]]:
    colour = band.get_facecolor()[0]
    name = by_colour.get(_colour(colour[:3]), "")
    for path in band.get_paths():
        x, y = path.vertices.T
        yield {
            "type": "scatter",
            "x": x,
            "y": y,
            "fill": "toself",
            "mode": "none",
            "fillcolor": _colour(colour),
            "legendgroup": name,
            "showlegend": False,
            "hoverinfo": "skip",
        }


def _axis(axis: Any, scale: str) -> dict[str, Any]:
    low, high = axis.get_view_interval()
    logarithmic = scale == "log"
    ends = np.log10([low, high]) if logarithmic else (low, high)
    return {
        "title": _plain(axis.get_label_text()),
        "type": "log" if logarithmic else "linear",
        "range": list(ends),
        "showgrid": True,
        "exponentformat": "power",
        **({"dtick": 1} if logarithmic else {}),
    }


def _colour(colour: Any) -> str:
    from matplotlib.colors import to_rgba

    red, green, blue, opacity = to_rgba(colour)
    return f"rgba({255 * red:.0f},{255 * green:.0f},{255 * blue:.0f},{opacity:.3g})"


def _plain(label: str) -> str:
    """A label of matplotlib without the signs of formulas."""
    for mark, letter in ((r"\omega", "ω"), (r"\mu", "µ"), (r"\,", " "), ("$", "")):
        label = label.replace(mark, letter)
    return label.replace("{", "").replace("}", "")
