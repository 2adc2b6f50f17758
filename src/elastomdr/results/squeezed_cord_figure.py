"""Figure of a squeezed cord."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .figure import _across, _axis_label, _colours, _frame, _legend_beside, _new_axes, _spread, _write_title

if TYPE_CHECKING:
    from .squeezed_cord import SqueezedCord

_MOST = 12  # lines that one figure shows
_LOG = 20  # ratio of the largest to the smallest time from which on its axis is logarithmic
_SCALES = {
    "pressure": (1e-6, "Mean pressure of the contact [MPa]"),
    "width": (1e3, "Width of the contact [mm]"),
    "line_load": (1.0, "Force per length of cord [N/m]"),
}


def draw_squeezed_cord(result: "SqueezedCord", ax: Any = None, show: str = "pressure", title: str | None = None) -> Any:
    """One of its quantities against time, squeeze, or the last axis."""
    known = {column.key: np.asarray(value) for column, value in result.fields().items()}
    along = "time" if any(axis.name == "time" for axis in result.axes()) else "squeeze"
    axis, lines = result.curves(along)
    new = ax is None
    ax = _new_axes(len(lines) > 1) if new else ax
    scale, ylabel = _SCALES[show]
    shown = _spread(lines, _MOST)
    for line, colour in zip(shown, _colours(len(shown)), strict=True):
        x, y = _across(known, axis, along, line), scale * np.atleast_1d(known[show][line.at])
        x = 100 * x if axis.name == "squeeze" or not axis.unit else x
        order, marker = np.argsort(x, kind="stable"), "o" if x.size == 1 else None
        label = line.label.replace("degC", "°C")
        ax.plot(x[order], y[order], color=colour, linewidth=1.8, marker=marker, label=label)
    later = axis.values[axis.values > 0]
    if along == "time" and later.size and later.max() > _LOG * later.min():
        if later.size < axis.values.size:  # the moment of squeezing itself has its place before the decades
            ax.set_xscale("symlog", linthresh=later.min(), linscale=0.3)
        else:
            ax.set_xscale("log")
    own = "Time since it was squeezed [s]" if along == "time" else "Squeeze [% of the diameter]"
    ax.set(xlabel=_axis_label(axis, along, own), ylabel=ylabel)
    ax.set_ylim(0.0, None)
    _frame(ax)
    if len(lines) > 1:
        _legend_beside(ax)
    if new or title:
        _write_title(ax, title or result.heading(), result.model, "")
    return ax
