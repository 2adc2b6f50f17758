"""Figures of results: the one module that imports matplotlib, and only when something is drawn."""

import io
import os
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._runtime import significant
from .axes import Axis, Curve, Peak, in_words, peak
from .measured_figure import as_measured, draw_measured
from .table import write_files

if TYPE_CHECKING:
    from .curve import AbstractCurve

_VISIBLE = 0.004  # part of the figure's height from which an error band can be seen
_LEGEND = 12  # curves that a legend names; of more, it names as many, evenly spread
_INK, _FAINT, _BLUE = "#222222", "#666666", "#1f5a94"
_DPI = 200
DOTTED = "dotted: beyond the range of the material's data"


def draw(
    result: "AbstractCurve", ax: Any = None, title: str | None = None, label: str | None = None, measured: Any = None
) -> Any:
    """Draws a coefficient against velocity on `ax`, or on a new figure; returns the Axes.

    One line per temperature, load or depth, its largest value marked, the estimated error as a band where it can be
    seen, points that did not converge left out and counted. Without a velocity axis, the last axis takes its place.
    On axes that hold a curve already the title stays and the curve goes into the legend, by `label` or its material.
    """
    fields = {column.key: value for column, value in result.fields().items()}
    axis, all_curves = result.curves()
    ax = _new_axes(len(all_curves) > 1 or measured is not None) if ax is None else ax
    beside_others = ax.has_data()
    points = None if measured is None else as_measured(measured)
    cold = fields.get("cold")
    name = label or (dict(result.inputs).get("material") if beside_others else None)
    value, error = fields[result.coefficient_field], fields["error"]
    highest = float(np.fmax.reduce(value if cold is None else np.fmax(value, cold), axis=None, initial=0.0)) or 1.0
    highest = highest if points is None else max(highest, float(points["mu"].max()))
    beyond = fields.get("extrapolated", np.zeros(value.shape, dtype=bool))
    against_velocity = axis.name == "velocity" or not axis.unit
    shaded = False
    for curve, colour, named in zip(all_curves, _colours(len(all_curves)), _named(len(all_curves)), strict=True):
        x = _across(fields, axis, "velocity", curve)
        order = np.argsort(x, kind="stable")
        x, y, e = x[order], np.atleast_1d(value[curve.at])[order], np.atleast_1d(error[curve.at])[order]
        top = peak(x, y)
        text = _in_words(top, "velocity" if against_velocity else axis.name)
        parts = [part for part in (name, curve.label) if part]
        words = ": ".join([", ".join(parts), text]).replace("degC", "°C") if named and parts else None
        colour = None if beside_others and len(all_curves) == 1 else colour  # the next one of the axes' own
        marker = "o" if x.size == 1 else None
        there = np.atleast_1d(beyond[curve.at])[order]
        style = {"color": colour, "linewidth": 1.8, "marker": marker, "markersize": 5, "label": words, "zorder": 3}
        colour = plot_within(ax, x, y, there, **style)
        if cold is not None:
            ax.plot(x, np.atleast_1d(cold[curve.at])[order], "--", color=colour, linewidth=1.2, zorder=2.5)
        if (e > _VISIBLE * highest).any():
            shaded = True
            ax.fill_between(x, y - e, y + e, color=colour, alpha=0.2, linewidth=0, zorder=2)
        if top is not None and x.size > 1:
            ax.plot(top.x, top.y, "o", color=colour, markersize=5.5, zorder=4)
            if len(all_curves) == 1 and not name and x[0] < x[-1]:
                scale = np.log if against_velocity else np.asarray
                _write_above(ax, top, text, float((scale(top.x) - scale(x[0])) / (scale(x[-1]) - scale(x[0]))))
    if points is not None and against_velocity:
        draw_measured(ax, points, fields.get("temperature"), all_curves, _colours(len(all_curves)))
    if against_velocity:
        ax.set_xscale("log")
    motion = "Sliding" if result.coefficient_field == "mu" else "Rolling"
    ax.set_xlabel(_axis_label(axis, "velocity", f"{motion} velocity [m/s]"))
    ax.set_ylabel(
        "Friction coefficient [-]" if result.coefficient_field == "mu" else "Rolling resistance coefficient [-]"
    )
    ax.set_ylim(0.0, max(1.16 * highest, ax.get_ylim()[1] if beside_others else 0.0))
    _frame(ax)
    notes = [text] if (text := left_out(fields, "points")) else []
    notes += ["dashed: without heating"] if cold is not None else []
    notes += ["shaded: estimated numerical error"] if shaded else []
    note = "; ".join(notes)
    if title or not beside_others:
        _write_title(ax, title or result.heading(), result.model, note)
    if len(all_curves) > 1 or name or points is not None:
        _legend_beside(ax)
    return ax


def png(result: "AbstractCurve", title: str | None = None, measured: Any = None) -> bytes:
    """The figure of a result as a PNG image, 200 dots per inch."""
    return saved(draw(result, title=title, measured=measured))


def plot_within(ax: Any, x: Any, y: Any, beyond: Any = None, **style: Any) -> Any:
    """Draws a line, dotted where a material is used beyond its range; returns its colour."""
    beyond = np.zeros(np.shape(y), dtype=bool) if beyond is None else beyond
    colour = ax.plot(x, np.where(beyond, np.nan, y), **style)[0].get_color()
    if beyond.any():
        ax.plot(x, y, ":", markerfacecolor="none", **{**style, "color": colour, "linewidth": 1.3, "label": None})
    return colour


def left_out(fields: Mapping[str, np.ndarray], points: str) -> str:
    """What the reader of a figure has to know: how many `points` did not converge, and what is dotted."""
    good, beyond = fields["converged"], fields.get("extrapolated")
    failed = int(np.sum(~good))
    notes = [f"{failed} of {good.size} {points} did not converge and are left out"] if failed else []
    notes += [DOTTED] if beyond is not None and beyond.any() else []
    return "; ".join(notes)


def saved(ax: Any) -> bytes:
    """The figure that the axes belong to as a PNG image, 200 dots per inch."""
    buffer = io.BytesIO()
    ax.figure.savefig(buffer, format="png", dpi=_DPI)
    return buffer.getvalue()


def save(result: "AbstractCurve", path: str | os.PathLike[str], title: str | None = None) -> None:
    """Writes the figure as PNG, whole or not at all. Raises `InputError` where the file cannot be written."""
    write_files({Path(path): png(result, title)})


def _new_axes(wide: bool) -> Any:
    from matplotlib.figure import Figure

    return Figure(figsize=(8.6, 4.4) if wide else (6.6, 4.4), layout="constrained").add_subplot()


def _frame(ax: Any) -> None:
    """Grid behind the curves, two spines."""
    ax.grid(True, which="major", color="#dddddd", linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)


def _legend_beside(ax: Any) -> None:
    ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=8.5, borderaxespad=0.0)


def _write_title(ax: Any, title: str, model: str, note: str) -> None:
    """Above the axes, from the top: the title, the model's name in small print, and in red what is missing."""
    inches = ax.figure.get_figure(root=True).get_size_inches()[0] * ax.get_position(original=True).width
    small = textwrap.wrap(model, max(30, int(17 * inches)))
    above = {"xy": (0, 1), "xycoords": "axes fraction", "textcoords": "offset points", "va": "bottom", "fontsize": 8}
    ax.annotate(note, xytext=(0, 6), color="#a02020", **above)
    ax.annotate("\n".join(small), xytext=(0, 18 if note else 6), color=_FAINT, linespacing=1.2, **above)
    heading = "\n".join(textwrap.wrap(title, max(24, int(9.5 * inches))))
    lines = len(small) + bool(note)
    ax.set_title(heading, loc="left", fontsize=12, fontweight="bold", color=_INK, pad=11 + 11 * lines)


def _write_above(ax: Any, top: Peak, text: str, part: float) -> None:
    """Labels the peak; `part` is its place along the axis, from 0 to 1, so that the text stays inside the figure."""
    side = "left" if part < 0.25 else "right" if part > 0.75 else "center"
    place = {"xytext": (0, 8), "textcoords": "offset points", "ha": side, "va": "bottom"}
    ax.annotate(text, xy=(top.x, top.y), fontsize=9, color=_INK, **place)


def _in_words(top: Peak | None, name: str) -> str:
    if top is None:
        return "no point converged"
    place = float(significant(top.x, 3)) if name == "velocity" else top.x
    return f"{top.kind} {significant(top.y, 3)} at {in_words(name, place)}".replace("degC", "°C")


def _axis_label(axis: Axis, along: str, own: str) -> str:
    """Of the horizontal axis: the figure's `own` one where the curves run `along` what it shows as a rule."""
    if axis.name == along or not axis.unit:
        return own
    name = "velocity of the road" if axis.name == "road" else axis.name.replace("_", " ")
    return f"{name.capitalize()} [{axis.unit}]"


def _across(fields: dict[str, np.ndarray], axis: Axis, along: str, curve: Curve) -> np.ndarray:
    """The horizontal places of the points of one curve."""
    return np.atleast_1d(fields[along][curve.at] if axis.name == along or not axis.unit else axis.values)


def _spread(curves: list[Curve], most: int) -> list[Curve]:
    """All curves, or of more than `most` as many, evenly spread."""
    places = np.linspace(0, len(curves) - 1, min(len(curves), most)).round().astype(int)
    return [curves[i] for i in np.unique(places)]


def _colours(count: int) -> list[Any]:
    if count == 1:
        return [_BLUE]
    import matplotlib

    return list(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, count)))


def _named(count: int) -> np.ndarray:
    shown = np.zeros(count, dtype=bool)
    shown[np.linspace(0, count - 1, min(count, _LEGEND)).round().astype(int)] = True
    return shown
