"""Figures of what moves in time: impact, tangential loading, tractive rolling."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .._runtime import significant
from .axes import in_words
from .figure import _BLUE, _colours, _frame, _new_axes, _write_title

if TYPE_CHECKING:
    from .impact import Impact
    from .shear import Shear
    from .traction import Traction

_MOST = 12  # lines that one figure shows


def draw_impact(result: "Impact", ax: Any = None, title: str | None = None) -> Any:
    """Force against time of one impact; of many, restitution against velocity, one line per further index."""
    known = {column.key: value for column, value in result.fields().items()}
    single = known["velocity"].size == 1
    lines = 1 if single else int(np.prod(known["velocity"].shape[:-1]))
    new = ax is None
    ax = _new_axes(lines > 1) if new else ax
    if single:
        _draw_force(result, ax)
    else:
        _draw_restitution(known, ax)
    _frame(ax)
    if new or title:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} impacts did not converge and are left out" if failed else ""
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Impact, {material}", result.model, note)
    return ax


def _draw_force(result: "Impact", ax: Any) -> None:
    from scipy.interpolate import CubicSpline

    time, force = (np.ravel(x) for x in (result.history.time, result.history.force))
    if not np.isfinite(time).all():
        return
    fine = np.linspace(time[0], time[-1], 400)
    ax.plot(1e3 * fine, CubicSpline(time, force)(fine), color=_BLUE, linewidth=1.8)
    turn = time.size // 2
    ax.plot(1e3 * time[turn], force[turn], "o", color=_BLUE, markersize=5.5)
    words = f"turn, {significant(1e3 * float(np.ravel(result.max_depth)[0]), 3)} mm deep"
    ax.annotate(words, (1e3 * time[turn], force[turn]), xytext=(8, 2), textcoords="offset points", fontsize=9)
    words = f"restitution {significant(float(np.ravel(result.restitution)[0]), 4)}"
    ax.text(0.98, 0.95, words, transform=ax.transAxes, ha="right", va="top", fontsize=10)
    ax.set(xlabel="Time since touch [ms]", ylabel="Contact force [N]", ylim=(0, None), xlim=(0, None))


def _draw_restitution(known: dict[str, np.ndarray], ax: Any) -> None:
    name, along = ("velocity", "Velocity at touch [m/s]")
    if np.ptp(known["velocity"], axis=-1).max() == 0 and np.ptp(known["mass"], axis=-1).max() > 0:
        name, along = "mass", "Mass [kg]"
    x, y = (np.atleast_2d(known[key].reshape(-1, known[key].shape[-1])) for key in (name, "restitution"))
    shown = np.unique(np.linspace(0, len(x) - 1, min(len(x), _MOST)).round().astype(int))
    for i, colour in zip(shown, _colours(len(shown)), strict=True):
        order = np.argsort(x[i])
        ax.plot(x[i][order], y[i][order], color=colour, linewidth=1.8, label=_label(known, i))
    if (x > 0).all() and x.max() > 20 * x.min():
        ax.set_xscale("log")
    ax.set(xlabel=along, ylabel="Coefficient of restitution [-]", ylim=(0, 1.05))
    if len(shown) > 1:
        ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=8.5, borderaxespad=0.0)


def draw_shear(result: "Shear", ax: Any = None, title: str | None = None) -> Any:
    """Tangential force against displacement."""
    new = ax is None
    ax = _new_axes(False) if new else ax
    known = {column.key: value for column, value in result.fields().items()}
    ax.plot(1e6 * known["displacement"], known["force"], color=_BLUE if new else None, linewidth=1.6)
    ax.set(xlabel="Tangential displacement [µm]", ylabel="Tangential force [N]")
    _frame(ax)
    if new or title:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} instants did not converge and are left out" if failed else ""
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Tangential loading, {material}", result.model, note)
    return ax


def draw_traction(result: "Traction", ax: Any = None, title: str | None = None) -> Any:
    """Traction coefficient against creep or slip, as it was given, one line per further index, full slip dashed."""
    known = {column.key: value for column, value in result.fields().items()}
    lines = int(np.prod(known["creep"].shape[:-1]))
    along = "slip" if "slip" in known else "creep"
    new = ax is None
    ax = _new_axes(lines > 1) if new else ax
    x, y = (known[key].reshape(lines, -1) for key in (along, "coefficient"))
    shown = np.unique(np.linspace(0, lines - 1, min(lines, _MOST)).round().astype(int))
    for i, colour in zip(shown, _colours(len(shown)), strict=True):
        order = np.argsort(x[i])
        ax.plot(100 * x[i][order], y[i][order], color=colour, linewidth=1.8, label=_label(known, i))
    friction = known["friction"].reshape(lines, -1)
    if np.isfinite(friction).all() and np.ptp(friction) == 0:
        full = float(friction.flat[0])
        for level in {full, -full} if x.min() < 0 else {full}:
            ax.axhline(level, color="#888888", linewidth=0.9, linestyle="--", zorder=1)
    elif np.ptp(friction, axis=1).any():  # it depends on the sliding velocity: what a contact that slips all over has
        peak = result.peak()
        top = [np.ravel(part) for part in (getattr(peak, along), peak.coefficient, peak.inside)]
        for i, colour in zip(shown, _colours(len(shown)), strict=True):
            order = np.argsort(x[i])
            full = np.where(x[i] == 0, np.nan, np.sign(x[i]) * friction[i])[order]
            ax.plot(100 * x[i][order], full, "--", color=colour, linewidth=0.9, zorder=1)
            if top[2][i]:
                ax.plot(100 * top[0][i], top[1][i], "o", color=colour, markersize=5.5, zorder=4)
    ax.set(xlabel=f"{along.capitalize()} [%]", ylabel="Traction coefficient $F_x/F_N$ [-]")
    _frame(ax)
    if len(shown) > 1:
        ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=8.5, borderaxespad=0.0)
    if new or title:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} points did not converge and are left out" if failed else ""
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Traction, {material}", result.model, note)
    return ax


def _label(known: dict[str, np.ndarray], row: int) -> str:
    """What sets a line apart from the others: all of temperature, mass, velocity, load and friction that are constant
    along it and not the same everywhere, or its number."""
    units = {
        "temperature": "K",
        "mass": "kg",
        "velocity": "m/s",
        "normal_force": "N",
        "friction": "friction coefficient",
    }
    words = []
    for key, unit in units.items():
        if key not in known or known[key].ndim == 0:
            continue
        values = known[key].reshape(-1, known[key].shape[-1])
        rounding = 1e-9 * np.abs(values).max()  # a load that was asked for comes back within it
        if np.ptp(values) > rounding and np.ptp(values[row]) <= rounding:
            value = float(values[row, 0])
            words.append(
                in_words(key, value).replace("degC", "°C") if key == "temperature" else f"{significant(value)} {unit}"
            )
    return ", ".join(words) or f"no. {row}"
