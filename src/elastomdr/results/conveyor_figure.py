"""Figure of a belt conveyor."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .figure import _across, _axis_label, _colours, _frame, _legend_beside, _new_axes, _spread, _write_title

if TYPE_CHECKING:
    from .conveyor import Conveyor

_MOST = 12  # lines that one figure shows


def draw_conveyor(result: "Conveyor", ax: Any = None, title: str | None = None) -> Any:
    """Power per kilometre against velocity, or what else is given in many values, one line per temperature and load."""
    known = {column.key: np.asarray(value) for column, value in result.fields().items()}
    axis, lines = result.curves()
    new = ax is None
    ax = _new_axes(len(lines) > 1) if new else ax
    shown = _spread(lines, _MOST)
    for line, colour in zip(shown, _colours(len(shown)), strict=True):
        x, y = _across(known, axis, "velocity", line), np.atleast_1d(known["power"][line.at])
        order = np.argsort(x, kind="stable")
        label = line.label.replace("degC", "°C")
        ax.plot(x[order], y[order], color=colour, marker="o" if x.size == 1 else None, label=label)
    xlabel = _axis_label(axis, "velocity", "Belt speed [m/s]")
    ax.set(xlabel=xlabel, ylabel="Power per kilometre of belt [kW]", ylim=(0, None))
    _frame(ax)
    if len(lines) > 1:
        _legend_beside(ax)
    if new or title:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} points did not converge and are left out" if failed else ""
        _write_title(ax, title or result.quantity, result.model, note)
    return ax
