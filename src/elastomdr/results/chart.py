"""Figures that one can point at: the curves, bands, points and labels of a matplotlib
figure, the one that is written into files, as options of ECharts.
"""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

_DASHES = {"-": "solid", "--": "dashed", ":": "dotted", "-.": [8, 3, 2, 3]}
_SYMBOLS = {"s": "rect", "^": "triangle", "D": "diamond", "v": "arrow", ".": "circle"}
_LETTERS = {
    r"\omega": "ω",
    r"\lambda": "λ",
    r"\mu": "µ",
    r"\sqrt": "√",
    r"\log_{10}": "log₁₀",
    r"\mathdefault": "",
    r"\,": " ",
    r"\ ": " ",
    r"\times": "·",
}
_CAPS = ("_", "|")  # the ends of intervals
_EDGE = {"color": "#444444"}
_GRID = {"show": True, "lineStyle": {"color": "#dddddd"}}


class Chart(NamedTuple):
    """One panel of a figure."""

    title: str
    notes: tuple[str, ...]  # in small print
    options: dict[str, Any]  # of ECharts


def charts(axes: Any) -> list[Chart]:
    """Each panel of the figure that the axes belong to, in order."""
    return [_chart(panel) for panel in axes.figure.axes if panel.has_data()]


def plain(label: str) -> str:
    """A label of matplotlib, which may hold formulas, in plain letters."""
    for command, letter in _LETTERS.items():
        label = label.replace(command, letter)
    return re.sub(r"[${}]", "", label)


def _chart(ax: Any) -> Chart:
    """The options of one panel."""
    names = _Names(ax)
    series = [*_curves(ax, names), *_areas(ax, names), *_texts(ax)]
    called = list(dict.fromkeys(filter(None, (each["name"] for each in series))))
    _give_bands(series)
    across, up = plain(ax.get_xlabel()), plain(ax.get_ylabel())
    curves = [
        each for each in series if each["type"] == "line" and len(each["data"]) > 1
    ]
    columns = {tuple(point[0] for point in each["data"]) for each in curves}
    options = {
        "animation": False,
        "textStyle": {"fontFamily": "Roboto, sans-serif"},
        "grid": {
            "left": 14,
            "right": 22,
            "top": 34,
            "bottom": 62 if len(called) > 1 else 40,
        },
        "xAxis": _axis(ax.xaxis, across, 26),
        "yAxis": _axis(ax.yaxis, up, 46),
        "legend": {
            "data": called if len(called) > 1 else [],
            "type": "scroll",
            "bottom": 0,
            "left": 0,
        },
        "tooltip": {
            "trigger": "axis" if len(columns) == 1 else "item",
            "confine": True,
            "axisPointer": {"type": "line", "snap": True},
            ":formatter": f"elastomdr.said({json.dumps(across)}, {json.dumps(up)})",
        },
        "toolbox": {
            "right": 6,
            "top": 0,
            "feature": {
                "dataZoom": {
                    "filterMode": "none",
                    "title": {"zoom": "Zoom: draw a box", "back": "Zoom back"},
                },
                "restore": {"title": "Show all"},
            },
        },
        "dataZoom": [
            {
                "type": "inside",
                axis: 0,
                "filterMode": "none",
                "zoomOnMouseWheel": "ctrl",
                "moveOnMouseMove": "shift",
                "preventDefaultMouseMove": False,
            }
            for axis in ("xAxisIndex", "yAxisIndex")
        ],
        "series": series,
    }
    return Chart(*_headings(ax), options)


def _axis(axis: Any, name: str, gap: int) -> dict[str, Any]:
    """One axis with its limits, logarithmic where the figure's is."""
    low, high = (float(end) for end in axis.get_view_interval())
    options: dict[str, Any] = {
        "type": "log" if axis.get_scale() == "log" else "value",
        "min": min(low, high),
        "max": max(low, high),
        "inverse": low > high,
        "name": name,
        "nameLocation": "middle",
        "nameGap": gap,
        "nameTextStyle": {"color": "#222222"},
        "axisLabel": {
            "color": "#444444",
            "hideOverlap": True,
            # limits are where the curves end, and no round numbers
            "showMinLabel": False,
            "showMaxLabel": False,
            ":formatter": "elastomdr.tick",
        },
        "axisLine": {"show": True, "onZero": False, "lineStyle": _EDGE},
        "splitLine": _GRID,
    }
    if len(axis.get_majorticklocs()) == 0:
        for element in ("axisLabel", "axisTick", "splitLine"):
            options[element] = {"show": False}
    return options


class _Names:
    """What the artists of a panel are called: as the legend calls them, else as one of
    the same colour that it does call.
    """

    def __init__(self, ax: Any):
        self._latest: dict[str, str] = {}
        self._own: dict[str, str] = {}
        self._default = plain(ax.get_ylabel()).rpartition(" [")[0]
        for artist in (*ax.lines, *ax.collections, *ax.patches):
            if (label := _label(artist)) and not _is_empty(artist):
                self._own.setdefault(_colour(artist), label)
        for legend in (*_legends(ax), *ax.figure.legends):
            for handle, legend_text in zip(
                legend.legend_handles, legend.get_texts(), strict=False
            ):
                if handle is not None:
                    label = " ".join(plain(legend_text.get_text()).split())
                    self._own.setdefault(_colour(handle), label)

    def __call__(self, artist: Any, default: str | None = None) -> str:
        colour = _colour(artist)
        if label := _label(artist):
            self._latest[colour] = label
            return label
        return self._latest.get(colour, self.of_colour(colour, default))

    def of_colour(self, colour: str, default: str | None = None) -> str:
        """What is drawn in this colour."""
        return self._own.get(colour, self._default if default is None else default)


def _legends(ax: Any) -> Iterator[Any]:
    from matplotlib.legend import Legend

    return (child for child in ax.get_children() if isinstance(child, Legend))


def _is_empty(artist: Any) -> bool:
    """Whether it stands for others in a legend."""
    return hasattr(artist, "get_xdata") and not np.size(artist.get_xdata())


def _label(artist: Any) -> str:
    label = str(artist.get_label() or "")
    return "" if label.startswith("_") else " ".join(plain(label).split())


def _colour(artist: Any) -> str:
    """The colour of an artist, of several the first, without its opacity."""
    from matplotlib.colors import to_hex

    for kind in ("get_color", "get_facecolor", "get_edgecolor"):
        if (get := getattr(artist, kind, None)) is None:
            continue
        colour = get()
        if isinstance(colour, str):
            return to_hex(colour)
        rows = np.atleast_2d(np.asarray(colour, dtype=float))
        if rows.size and (rows.shape[1] < 4 or rows[0, 3] > 0):
            return to_hex(tuple(rows[0, :3]))
    return "#000000"


def _curves(ax: Any, names: _Names) -> Iterator[dict[str, Any]]:
    """Lines and marks."""
    from matplotlib.collections import LineCollection, PathCollection
    from matplotlib.patches import StepPatch

    for line in ax.lines:
        x, y = (np.asarray(values, dtype=float) for values in line.get_data())
        if line.get_transform() != ax.transData:
            yield _mark_line(line, x, y)
        elif x.size and str(line.get_marker()) not in _CAPS:
            yield _line(line, x, y, names(line))
    for drawn in ax.collections:
        if isinstance(drawn, PathCollection):
            yield from _scattered(drawn, names)
        elif isinstance(drawn, LineCollection):
            gap = np.full((1, 2), np.nan)
            ends = [
                vertices for each in drawn.get_segments() for vertices in (each, gap)
            ]
            if ends:
                yield _thin(np.vstack(ends), _colour(drawn), names(drawn, ""))
    for patch in ax.patches:
        if isinstance(patch, StepPatch):
            heights, edges, _ = patch.get_data()
            stairs = np.column_stack([np.repeat(edges, 2)[1:-1], np.repeat(heights, 2)])
            yield _thin(stairs, _colour(patch), names(patch), 2.0)


def _line(line: Any, x: np.ndarray, y: np.ndarray, name: str) -> dict[str, Any]:
    dashes, marker = str(line.get_linestyle()), str(line.get_marker())
    drawn, marked = dashes in _DASHES, marker not in ("None", "none", "", " ")
    colour, width = _colour(line), float(line.get_linewidth())
    face = line.get_markerfacecolor()
    hollow = isinstance(face, str) and face.lower() in ("none", "white")
    return {
        "type": "line" if drawn else "scatter",
        "name": name,
        "data": _data(x, y),
        "symbol": _symbol(marker, hollow) if marked else "circle",
        "symbolSize": max(5.0, 1.3 * float(line.get_markersize())) if marked else 7,
        "showSymbol": marked,
        "lineStyle": {"type": _DASHES.get(dashes, "solid"), "width": width},
        "itemStyle": {"color": colour},
        "z": int(10 * line.get_zorder()),
        "clip": True,
    }


def _thin(
    places: np.ndarray, colour: str, name: str, width: float = 1.0
) -> dict[str, Any]:
    """A line without marks: the ends of intervals, or steps."""
    return {
        "type": "line",
        "name": name,
        "data": _data(*places.T),
        "showSymbol": False,
        "silent": True,
        "lineStyle": {"width": width},
        "itemStyle": {"color": colour},
        "clip": True,
    }


def _mark_line(line: Any, x: np.ndarray, y: np.ndarray) -> dict[str, Any]:
    """A line across the whole panel."""
    place = {"xAxis": x[0]} if x[0] == x[-1] else {"yAxis": y[0]}
    look = {
        "color": _colour(line),
        "type": _DASHES.get(str(line.get_linestyle()), "solid"),
    }
    label = _label(line)
    return {
        "type": "line",
        "name": label,
        "data": [],
        "itemStyle": {"color": look["color"]},
        "markLine": {
            "silent": True,
            "symbol": "none",
            "label": {"show": False},
            "lineStyle": {**look, "width": float(line.get_linewidth())},
            "data": [place],
        },
    }


def _scattered(drawn: Any, names: _Names) -> Iterator[dict[str, Any]]:
    """Marks, a series for each colour."""
    from matplotlib.colors import to_hex

    offsets = np.asarray(drawn.get_offsets(), dtype=float)
    faces, edges = drawn.get_facecolor(), drawn.get_edgecolor()
    hollow = not len(faces)
    colours = np.asarray(edges if hollow else faces)
    if len(colours) == 1:
        colours = np.repeat(colours, len(offsets), axis=0)
    square = len(drawn.get_paths()[0].vertices) < 8
    for colour in dict.fromkeys(to_hex(each[:3]) for each in colours):
        chosen = [to_hex(each[:3]) == colour for each in colours]
        yield {
            "type": "scatter",
            "name": _label(drawn) or names.of_colour(colour),
            "data": _data(*offsets[chosen].T),
            "symbol": _symbol("s" if square else "o", hollow),
            "symbolSize": 6,
            "itemStyle": {"color": colour},
            "z": int(10 * drawn.get_zorder()),
        }


def _symbol(marker: str, hollow: bool) -> str:
    symbol = _SYMBOLS.get(marker, "circle")
    return f"empty{symbol.capitalize()}" if hollow else symbol


def _areas(ax: Any, names: _Names) -> Iterator[dict[str, Any]]:
    """Bands and bars, as polygons."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Rectangle

    for drawn in ax.collections:
        if isinstance(drawn, PolyCollection):
            opacity = drawn.get_alpha()
            for path in drawn.get_paths():
                corners = np.asarray(path.vertices)
                yield _polygon(corners, _colour(drawn), opacity, names(drawn))
    for patch in ax.patches:
        if isinstance(patch, Rectangle):
            corners = patch.get_patch_transform().transform(patch.get_path().vertices)
            yield _polygon(corners, _colour(patch), patch.get_alpha(), "")


def _polygon(
    corners: np.ndarray, colour: str, opacity: float | None, name: str
) -> dict[str, Any]:
    return {
        "type": "custom",
        "name": name,
        "data": _data(*np.asarray(corners, dtype=float).T),
        ":renderItem": f"elastomdr.polygon({1.0 if opacity is None else opacity:g})",
        "opacity": 1.0 if opacity is None else opacity,  # for who reads this anew
        "itemStyle": {"color": colour},
        "silent": True,
        "clip": True,
        "z": 1,
    }


def _give_bands(series: list[dict[str, Any]]) -> None:
    """Adds to the points of each curve the ends of the band that goes by its name."""
    ends: dict[tuple[str, str], dict[float, list[float]]] = {}
    for each in series:
        if each["type"] == "custom" and each["name"]:
            of = ends.setdefault((each["name"], each["itemStyle"]["color"]), {})
            for x, y in each["data"]:
                of.setdefault(x, []).append(y)
    for each in series:
        band = ends.get((each["name"], each["itemStyle"]["color"]), {})
        if each["type"] == "line" and band:
            each["data"] = [
                [x, y, min(band[x]), max(band[x])] if x in band else [x, y]
                for x, y in each["data"]
            ]


def _texts(ax: Any) -> Iterator[dict[str, Any]]:
    """What is written at a place of the data."""
    from matplotlib.text import Annotation

    for artist in ax.texts:
        annotated = isinstance(artist, Annotation)
        if annotated and artist.xycoords != "data":
            continue
        if not annotated and artist.get_transform() != ax.transData:
            continue
        place = artist.xy if annotated else artist.get_position()
        side = {"left": "right", "right": "left"}.get(
            artist.get_horizontalalignment(), "top"
        )
        yield {
            "type": "scatter",
            "name": "",
            "data": _data(*np.asarray([place], dtype=float).T),
            "symbolSize": 1,
            "silent": True,
            "itemStyle": {"color": "transparent"},
            "tooltip": {"show": False},
            "label": {
                "show": True,
                "position": "top" if annotated else side,
                "formatter": plain(artist.get_text()),
                "color": _colour(artist),
            },
        }


def _headings(ax: Any) -> tuple[str, tuple[str, ...]]:
    """The title of a panel, and what is written above it in small print."""
    from matplotlib.text import Annotation

    title = next(
        filter(None, (ax.get_title(loc=loc) for loc in ("left", "center"))), ""
    )
    first = ax.figure.axes[0] is ax
    if first and (whole := ax.figure.get_suptitle()):
        title = whole
    notes = [
        artist.get_text()
        for artist in ax.texts
        if isinstance(artist, Annotation) and artist.xycoords == "axes fraction"
    ]
    return tuple(  # type: ignore[return-value]
        [
            " ".join(plain(title).split()),
            tuple(" ".join(plain(note).split()) for note in reversed(notes)),
        ]
    )


def _data(x: np.ndarray, y: np.ndarray) -> list[list[float | None]]:
    """Points as JSON knows them, without NaN."""
    return [
        [float(each) if np.isfinite(each) else None for each in point]
        for point in zip(x, y, strict=True)
    ]
