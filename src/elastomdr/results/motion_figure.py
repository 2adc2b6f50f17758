"""Figures of what moves in time: impact, tangential loading, tractive rolling."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .._runtime import significant
from .figure import (
    _BLUE,
    _across,
    _axis_label,
    _colours,
    _frame,
    _legend_beside,
    _new_axes,
    _spread,
    _write_title,
    left_out,
    plot_within,
)

if TYPE_CHECKING:
    from .impact import Impact
    from .shear import Shear
    from .traction import Traction

_MOST = 12  # lines that one figure shows


def draw_impact(result: "Impact", ax: Any = None, title: str | None = None) -> Any:
    """Force against time of one impact; of many, restitution against velocity, one line per further index."""
    known = {column.key: value for column, value in result.fields().items()}
    single = known["velocity"].size == 1
    new = ax is None
    ax = _new_axes(len(result.curves()[1]) > 1) if new else ax
    if single:
        _draw_force(result, ax)
    else:
        _draw_restitution(result, known, ax)
    _frame(ax)
    if new or title:
        note = left_out(known, "impacts")
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Impact, {material}", result.model, note)
    return ax


def _draw_force(result: "Impact", ax: Any) -> None:
    from scipy.interpolate import CubicSpline

    time, force = (np.ravel(x) for x in (result.history.time, result.history.force))
    if not np.isfinite(time).all():
        return
    fine = np.linspace(time[0], time[-1], 400)
    beyond = None if result.extrapolated is None else np.broadcast_to(result.extrapolated.ravel(), fine.shape)
    plot_within(ax, 1e3 * fine, CubicSpline(time, force)(fine), beyond, color=_BLUE, linewidth=1.8)
    turn = time.size // 2
    ax.plot(1e3 * time[turn], force[turn], "o", color=_BLUE, markersize=5.5)
    words = f"turn, {significant(1e3 * float(np.ravel(result.max_depth)[0]), 3)} mm deep"
    ax.annotate(words, (1e3 * time[turn], force[turn]), xytext=(8, 2), textcoords="offset points", fontsize=9)
    words = f"restitution {significant(float(np.ravel(result.restitution)[0]), 4)}"
    ax.text(0.98, 0.95, words, transform=ax.transAxes, ha="right", va="top", fontsize=10)
    ax.set(xlabel="Time since touch [ms]", ylabel="Contact force [N]", ylim=(0, None), xlim=(0, None))


def _draw_restitution(result: "Impact", known: dict[str, np.ndarray], ax: Any) -> None:
    axis, lines = result.curves()
    shown = _spread(lines, _MOST)
    xs, beyond = [_across(known, axis, "velocity", line) for line in shown], known.get("extrapolated")
    for x, line, colour in zip(xs, shown, _colours(len(shown)), strict=True):
        y, order, marker = np.atleast_1d(known["restitution"][line.at]), np.argsort(x), "o" if x.size == 1 else None
        label = line.label.replace("degC", "°C")
        there = None if beyond is None else np.atleast_1d(beyond[line.at])[order]
        plot_within(ax, x[order], y[order], there, color=colour, linewidth=1.8, marker=marker, label=label)
    x = np.concatenate(xs)
    if (x > 0).all() and x.max() > 20 * x.min():
        ax.set_xscale("log")
    xlabel = _axis_label(axis, "velocity", "Velocity at touch [m/s]")
    ax.set(xlabel=xlabel, ylabel="Coefficient of restitution [-]", ylim=(0, 1.05))
    if len(lines) > 1:
        _legend_beside(ax)


def draw_shear(result: "Shear", ax: Any = None, title: str | None = None) -> Any:
    """Tangential force against displacement."""
    new = ax is None
    ax = _new_axes(False) if new else ax
    known = {column.key: value for column, value in result.fields().items()}
    style = {"color": _BLUE if new else None, "linewidth": 1.6}
    plot_within(ax, 1e6 * known["displacement"], known["force"], known.get("extrapolated"), **style)
    ax.set(xlabel="Tangential displacement [µm]", ylabel="Tangential force [N]")
    _frame(ax)
    if new or title:
        note = left_out(known, "instants")
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Tangential loading, {material}", result.model, note)
    return ax


def draw_traction(result: "Traction", ax: Any = None, title: str | None = None) -> Any:
    """Traction coefficient against creep or slip, as it was given, one line per further index, full slip dashed."""
    known = {column.key: np.asarray(value) for column, value in result.fields().items()}
    along = "slip" if "slip" in known else "creep"
    axis, lines = result.curves(along)
    new = ax is None
    ax = _new_axes(len(lines) > 1) if new else ax
    friction, shown = known["friction"], _spread(lines, _MOST)
    constant = np.isfinite(friction).all() and np.ptp(friction) == 0
    for line, colour in zip(shown, _colours(len(shown)), strict=True):
        x = _across(known, axis, along, line)
        order = np.argsort(x)
        x, y, most = (np.atleast_1d(z)[order] for z in (x, known["coefficient"][line.at], friction[line.at]))
        x = 100 * x if axis.name in ("slip", "creep") or not axis.unit else x
        label, marker = line.label.replace("degC", "°C"), "o" if x.size == 1 else None
        there = np.atleast_1d(known["extrapolated"][line.at])[order] if "extrapolated" in known else None
        plot_within(ax, x, y, there, color=colour, linewidth=1.8, marker=marker, label=label)
        if (axis.name == along or not axis.unit) and np.isfinite(most).all() and np.ptp(most) > 0:
            # It depends on the sliding velocity: what a contact has that slips all over.
            ax.plot(x, np.where(x == 0, np.nan, np.sign(x) * most), "--", color=colour, linewidth=0.9, zorder=1)
            there = np.flatnonzero(np.isfinite(y))
            top = there[np.abs(y[there]).argmax()] if there.size else 0
            if there.size and there[0] < top < there[-1]:  # at an end the largest may lie beyond
                ax.plot(x[top], y[top], "o", color=colour, markersize=5.5, zorder=4)
    if constant:
        full = float(friction.flat[0])
        for level in {full, -full} if known[along].min() < 0 else {full}:
            ax.axhline(level, color="#888888", linewidth=0.9, linestyle="--", zorder=1)
    xlabel = _axis_label(axis, along, f"{along.capitalize()} [%]")
    ax.set(xlabel=xlabel, ylabel="Traction coefficient $F_x/F_N$ [-]")
    _frame(ax)
    if len(lines) > 1:
        _legend_beside(ax)
    if new or title:
        note = left_out(known, "points")
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Traction, {material}", result.model, note)
    return ax
