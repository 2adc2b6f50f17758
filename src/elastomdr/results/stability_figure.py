"""Figure of a drive's damping."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .figure import _across, _axis_label, _colours, _frame, _legend_beside, _new_axes, _spread, _write_title

if TYPE_CHECKING:
    from .stability import Stability

_MOST = 12  # lines that one figure shows


def draw_stability(result: "Stability", ax: Any = None, title: str | None = None, label: str | None = None) -> Any:
    """Damping ratio against velocity; dotted where friction does not follow, shaded where swings grow."""
    known = {column.key: np.asarray(value) for column, value in result.fields().items()}
    axis, lines = result.curves()
    new = ax is None
    ax = _new_axes(True) if new else ax
    beside_others = ax.has_data()
    shown = _spread(lines, _MOST)
    named = beside_others  # the shading has its line in the legend once
    for line, usual in zip(shown, _colours(len(shown)), strict=True):
        x, y = _across(known, axis, "velocity", line), known["ratio"][line.at]
        counts = known["follows"][line.at] & np.isfinite(y)
        words = ", ".join(part for part in (label, line.label) if part).replace("degC", "°C")
        colour = None if beside_others and len(shown) == 1 else usual  # None: the next one of the axes' own
        dotted = ax.plot(x, y, ":", color=colour, linewidth=1.2)[0]  # all of it: where it decides a line lies on top
        deciding = np.where(counts, y, np.nan)
        marker = "o" if counts.sum() == 1 else None
        ax.plot(x, deciding, color=dotted.get_color(), linewidth=1.8, marker=marker, label=words or "damping ratio")
        below = counts & (y < 0)
        if below.any():
            name = None if named else "swings grow"
            named = True
            red = {"color": "#c03030", "alpha": 0.3, "linewidth": 0, "zorder": 1}
            ax.fill_between(x, y, 0, where=below, interpolate=True, label=name, **red)
            if below.sum() == 1:  # between two points there is an area, at one there is none
                ax.plot(x[below], y[below], "o", color="#c03030", markersize=4)
    slowest = float(result.slowest)
    name = r"$\lambda\sqrt{k/m}$: slower, it decides nothing"
    ax.axvline(slowest, color="#888888", linewidth=1, linestyle="--", label=None if beside_others else name)
    ax.axhline(0, color="#888888", linewidth=1)
    ax.set_xscale("log")
    ax.set(xlabel=_axis_label(axis, "velocity", "Velocity of the drive [m/s]"), ylabel=r"Damping ratio $\zeta$ [-]")
    _frame(ax)
    _legend_beside(ax)
    if title or not beside_others:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} points are not known and are left out" if failed else ""
        _write_title(ax, title or result.heading(), result.model, note)
    return ax
