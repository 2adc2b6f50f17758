"""Figures of histories: a friction coefficient, or forces and motion, against time."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .figure import _frame, _new_axes, _write_title, left_out, plot_within, saved

if TYPE_CHECKING:
    from .drive import Drive
    from .slide import Slide

_BLUE = "#1f5a94"
_VISIBLE = 0.004  # part of the figure's height from which an error band can be seen
AXES = {"time": "Time [s]", "position": "Position [m]"}


def draw_slide(result: "Slide", ax: Any, against: str, title: str | None, label: str | None) -> Any:
    """mu against time or position, its estimated error as a band where it can be seen; returns the Axes."""
    fields = {column.key: value for column, value in result.fields().items()}
    ax = _new_axes(False) if ax is None else ax
    beside_others = ax.has_data()
    x, y, error = fields[against], fields["mu"], fields["error"]
    style = {"color": None if beside_others else _BLUE, "linewidth": 1.6, "label": label, "zorder": 3}
    colour = plot_within(ax, x, y, fields.get("extrapolated"), **style)
    if (error > _VISIBLE * np.nanmax(np.abs(y), initial=0.0)).any():
        ax.fill_between(x, y - error, y + error, color=colour, alpha=0.2, linewidth=0, zorder=2)
    ax.set(xlabel=AXES[against], ylabel="Friction coefficient [-]")
    _frame(ax)
    if title or not beside_others:
        _write_title(ax, title or result.heading(), result.model, left_out(fields, "points"))
    if label:
        ax.legend(frameon=False, fontsize=8.5)
    return ax


def png(result: "Slide", title: str | None = None) -> bytes:
    """The figure of a sliding history as a PNG image: against position, since a rest may take most of the time."""
    against = "position" if np.ptp(result.position) > 0 else "time"
    return saved(draw_slide(result, None, against, title, None))


def draw_history(result: "Drive", ax: Any, show: str, title: str | None, label: str | None) -> Any:
    """One column of a motion against time; returns the Axes."""
    fields = {column.field: value for column, value in result.fields().items()}
    column = next(column for column in result.table if column.field == show)
    ax = _new_axes(False) if ax is None else ax
    beside_others = ax.has_data()
    style = {"color": None if beside_others else _BLUE, "linewidth": 1.3, "label": label, "zorder": 3}
    plot_within(ax, result.time, fields[show], fields.get("extrapolated"), **style)
    ax.set(xlabel=AXES["time"], ylabel=column.title[0].upper() + column.title[1:])
    _frame(ax)
    if title or not beside_others:
        _write_title(ax, title or result.heading(), result.model, left_out(fields, "points"))
    if label:
        ax.legend(frameon=False, fontsize=8.5)
    return ax
