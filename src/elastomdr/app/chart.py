"""A figure of the page, with the files that it can be saved as."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from ..files import no_formula
from ..results.chart import Chart, charts, points
from ..results.plotting import saved

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# of plotly: how a chart lies on the page
_LAYOUT = {
    "autosize": True,
    "margin": {"l": 14, "r": 14, "t": 8, "b": 14},
    "font": {"family": "Roboto, sans-serif", "color": "#222222", "size": 12},
    "dragmode": "zoom",
    "hoverlabel": {"namelength": -1},
    "legend": {"orientation": "h", "yref": "container", "y": 0, "maxheight": 0.25},
    "template": {"layout": {"colorway": ["#1f5a94"]}},
}


class Drawn(NamedTuple):
    """A figure, as it is shown and as it is written into files."""

    axes: Axes
    charts: list[Chart]
    table: Callable[[], bytes] | None  # its numbers; None: the points of the charts

    def saved(self, kind: str) -> bytes:
        """The figure as a PNG or SVG image, or its numbers as CSV."""
        if kind != "csv":
            return saved(self.axes, kind=kind)
        return self.table() if self.table is not None else self._points()

    def _points(self) -> bytes:
        """All points of the charts as comma-separated text, a line each."""
        buffer = io.StringIO()
        write = csv.writer(buffer)
        for name, *row in points(self.charts):
            write.writerow([no_formula(str(name)), *row])
        return buffer.getvalue().encode()

    def plots(self) -> list[dict[str, object]]:
        """Each panel as a figure of plotly; one of the same curves stays zoomed."""
        return [
            {
                "data": chart.data,
                "layout": {
                    **_LAYOUT,
                    **chart.layout,
                    "shapes": chart.shapes,
                    "uirevision": "; ".join(str(trace["name"]) for trace in chart.data),
                },
                "config": {"displayModeBar": False, "responsive": False},
            }
            for chart in self.charts
        ]


def drawn(axes: Axes, table: Callable[[], bytes] | None = None) -> Drawn:
    """The figure that the axes belong to."""
    return Drawn(axes, charts(axes), table)
