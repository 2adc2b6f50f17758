"""Figures of an indentation: depth, force and contact radius against time, and the force against the depth."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .axes import in_words
from .figure import _colours, _frame, _named, _write_title, left_out, plot_within, saved

if TYPE_CHECKING:
    from .indentation import Indentation

_PANELS = (("depth", "Depth [mm]", 1e3), ("force", "Force [{}]", 1.0), ("contact_radius", "Contact radius [mm]", 1e3))
_LOG = 30.0  # largest over middle interval from which instants are taken as spread over decades


def draw(result: "Indentation", ax: Any = None, title: str | None = None, label: str | None = None) -> Any:
    """Draws four panels on a new figure, or the force against the depth on `ax`; returns (the first) Axes.

    One line per history. Instants that did not converge are left out and counted.
    """
    fields = {column.key: np.atleast_1d(value) for column, value in result.fields().items()}
    instants = fields["time"].shape[-1]
    rows = {key: value.reshape(-1, instants) for key, value in fields.items()}
    unit, scale = _force_unit(rows["force"])
    note, beyond = left_out(fields, "instants"), rows.get("extrapolated")
    if ax is not None:
        beside = ax.has_data()
        _curves(ax, 1e3 * rows["depth"], scale * rows["force"], [label] if label else _labels(rows), beside, beyond)
        _dress(ax, "Depth [mm]", f"Force [{unit}]")
        if title or not beside:
            _write_title(ax, title or result.heading(), result.model, note)
        if label or len(rows["depth"]) > 1:
            ax.legend(frameon=False, fontsize=8.5)
        return ax

    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 6.6), layout="constrained")
    (first, second), (third, fourth) = figure.subplots(2, 2)
    labels = _labels(rows)
    time, log = rows["time"] - rows["time"][:, :1], _spread(rows["time"])
    time = np.where(time > 0, time, np.nan) if log else time
    for panel, (key, name, factor) in zip((first, second, third), _PANELS, strict=True):
        factor = scale if key == "force" else factor
        _curves(panel, time, factor * rows[key], labels, False, beyond)
        if log:
            panel.set_xscale("log")
        _dress(panel, "Time since the first instant [s]" if log else "Time [s]", name.format(unit))
        if not log and (rows["time"][:, 0] != 0).any():
            panel.set_xlabel("Time since the first instant [s]")
    _curves(fourth, 1e3 * rows["depth"], scale * rows["force"], labels, False, beyond)
    _dress(fourth, "Depth [mm]", f"Force [{unit}]")
    figure.suptitle(title or result.heading(), x=0.01, ha="left", fontsize=12, fontweight="bold")
    first.set_title(result.model, loc="left", fontsize=8, color="#666666")
    if note:
        second.set_title(note, loc="left", fontsize=8, color="#a02020")
    if len(rows["depth"]) > 1:
        fourth.legend(frameon=False, fontsize=8)
    return first


def png(result: "Indentation", title: str | None = None) -> bytes:
    """The figure of a result as a PNG image, 200 dots per inch."""
    return saved(draw(result, title=title))


def _curves(ax: Any, x: np.ndarray, y: np.ndarray, labels: list[str], keep_colours: bool, beyond: Any) -> None:
    colours = [None] * len(x) if keep_colours else _colours(len(x))
    named = _named(len(x))
    for i in range(len(x)):
        text = labels[i] if i < len(labels) and named[i] else None
        there = None if beyond is None else beyond[i]
        plot_within(ax, x[i], y[i], there, color=colours[i], linewidth=1.7, label=text)


def _dress(ax: Any, x: str, y: str) -> None:
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    _frame(ax)


def _labels(rows: dict[str, np.ndarray]) -> list[str]:
    """What sets the histories apart: their largest depths or loads, whichever were given as round numbers."""

    def words(key: str, name: str) -> list[str]:
        return [in_words(name, float(np.nanmax(row, initial=0.0))) for row in rows[key]]

    force, depth = words("force", "load"), words("depth", "depth")
    shorter = sum(map(len, depth)) < sum(map(len, force))
    return [f"to {text}" for text in (depth if shorter else force)]


def _spread(time: np.ndarray) -> bool:
    steps = np.diff(time[0])
    return bool(steps.max() > _LOG * np.median(steps))


def _force_unit(force: np.ndarray) -> tuple[str, float]:
    largest = float(np.nanmax(np.abs(force), initial=0.0))
    for unit, scale in (("kN", 1e-3), ("N", 1.0), ("mN", 1e3), ("µN", 1e6)):
        if largest * scale >= 1:
            return unit, scale
    return "N", 1.0
