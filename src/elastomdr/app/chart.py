"""A figure of the page, with the files that it can be saved as."""

import csv
import io
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from ..files import no_formula
from ..results.chart import Chart, charts


class Drawn(NamedTuple):
    """A figure, as it is shown and as it is written into files."""

    axes: Any
    charts: list[Chart]
    table: Callable[[], bytes] | None  # its numbers; None: the points of the charts

    def saved(self, kind: str) -> bytes:
        """The figure as a PNG or SVG image, or its numbers as CSV."""
        if kind == "csv":
            return (self.table or partial(points, self.charts))()
        return image(self.axes, kind)


def drawn(axes: Any, table: Callable[[], bytes] | None = None) -> Drawn:
    """The figure that the axes belong to."""
    return Drawn(axes, charts(axes), table)


def image(axes: Any, kind: str = "svg") -> bytes:
    """The figure that the axes belong to as an SVG or PNG image."""
    buffer = io.BytesIO()
    axes.figure.savefig(buffer, format=kind, dpi=200)
    return buffer.getvalue()


def points(charts: list[Chart]) -> bytes:
    """All points of the charts as comma-separated text, a line each."""
    buffer = io.StringIO()
    write = csv.writer(buffer)
    for chart in charts:
        across, up = (chart.options[axis]["name"] for axis in ("xAxis", "yAxis"))
        write.writerow(["curve", across, up, "lower end", "upper end"])
        for series in chart.options["series"]:
            if series["type"] in ("line", "scatter"):
                for point in series["data"]:
                    write.writerow([no_formula(series["name"]), *point])
    return buffer.getvalue().encode()
