"""Figure of a body that warms up."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .figure import _across, _axis_label, _colours, _frame, _legend_beside, _new_axes, _spread, _write_title

if TYPE_CHECKING:
    from .warming import Warming

_MOST = 12  # lines that one figure shows


def draw_warming(result: "Warming", ax: Any = None, title: str | None = None) -> Any:
    """Temperature against time, or the steady one against velocity, one line per further index."""
    known = {column.key: np.asarray(value) for column, value in result.fields().items()}
    along = "time" if "time" in known else "velocity"
    axis, lines = result.curves(along)
    new = ax is None
    ax = _new_axes(len(lines) > 1) if new else ax
    shown = _spread(lines, _MOST)
    for line, colour in zip(shown, _colours(len(shown)), strict=True):
        if along == "time" and not known["converged"][line.at].all():
            continue
        x, celsius = _across(known, axis, along, line), np.atleast_1d(known["temperature"][line.at]) - 273.15
        order, marker = np.argsort(x, kind="stable"), "o" if x.size == 1 else None
        ax.plot(x[order], celsius[order], color=colour, marker=marker, label=line.label.replace("degC", "°C"))
        if along == "time":
            ax.axhline(known["steady"][line.at][0] - 273.15, color=colour, linewidth=0.9, linestyle=":")
    own = "Time [s]" if along == "time" else "Rolling velocity [m/s]"
    ax.set(xlabel=_axis_label(axis, along, own), ylabel="Temperature [°C]")
    _frame(ax)
    if len(lines) > 1:
        _legend_beside(ax)
    if new or title:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} points did not converge and are left out" if failed else ""
        note = "; ".join(x for x in (note, "dotted: steady" if along == "time" else "") if x)
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Warming by rolling resistance, {material}", result.model, note)
    return ax
