"""Figures of contacts: impact and indentation in time, rough lines and surfaces."""

from __future__ import annotations

import dataclasses
import os
from typing import TYPE_CHECKING

import numpy as np

from ..checks import whole_number
from .axes import Curve, Label
from .plotting import (
    LOG_RATIO,
    PALETTE,
    Drawable,
    DrawAsk,
    DrawnLine,
    Panels,
    ResultSketch,
    Shaded,
    Trace,
    draw,
    figure_of,
    frame,
    logarithmic_if_wide,
)
from .words import in_unit, in_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

# largest over middle interval from which instants are taken as spread over decades
_DECADES = 30.0
WAVE_NUMBER = Label("Wave number q", "rad/m")
SPECTRUM = Label("Spectrum C(q), <h²> = ∫C d²q", "m⁴")
_TOUCHING = "#c23b22"
_NAMED = 4  # branches with a name in the figure of elements, those that carry most


def draw_impact(result: Drawable, ask: DrawAsk) -> Axes:
    """Draws the force of one impact against time."""
    from scipy.interpolate import CubicSpline

    about = {q.path: q for q in result.quantities()}
    labels = about["history.time"].axis_label, about["history.force"].axis_label
    sketch = ResultSketch(result, ask, labels=labels)
    sketch.along = False  # what is drawn is a history
    values = {q.path: np.ravel(values) for q, values in result.fields(None).items()}
    time, force = in_unit(values["history.time"], "ms"), values["history.force"]
    if not np.isfinite(time).all():
        return sketch.finish()
    fine, colour = np.linspace(time[0], time[-1], 400), sketch.colours(1)[0]
    doubted = np.broadcast_to(np.ravel(sketch.dotted), fine.shape)
    curve, order = Curve((), ""), np.arange(fine.size)
    smooth = CubicSpline(time, force)(fine)
    line = DrawnLine(curve, order, fine, fine, smooth, colour, "-", doubted)
    sketch.curve(line)
    sketch.ax.set(ylim=(0, None), xlim=(0, None))
    return sketch.finish()


def draw_indentation(result: Drawable, ask: DrawAsk) -> Axes:
    """Draws depth, force and radius against time and the force against the depth; on
    given axes the last alone.
    """
    fields = {q.key: values for q, values in result.fields(None).items()}
    sketch = ResultSketch(result, ask, panels=Panels(2, 2))
    if sketch.canvas.several:
        sketch.ax = sketch.canvas.panels[3]
    keys = ("depth", "force", "contact_radius") if sketch.canvas.several else ()
    histories = dict(zip(keys, sketch.canvas.panels, strict=False))
    time = np.atleast_1d(fields["time"])
    rows = time.reshape(-1, time.shape[-1])
    steps = np.diff(rows[0])
    log = bool(steps.size and steps.max() > _DECADES * np.median(steps))
    labels = _largest_in_words(sketch)
    for line, label in zip(sketch.lines(), labels, strict=True):
        t = np.atleast_1d(time[line.curve.place])
        since = np.where(t > t[0], t - t[0], np.nan) if log else t - t[0]
        for key, panel in histories.items():
            y = sketch.shown(key, line.curve)
            sketch.add(
                Trace(
                    since,
                    y,
                    width=0.9,
                    colour=line.colour,
                    dotted=line.dotted,
                    ax=panel,
                )
            )
        sketch.curve(line, label=label if len(labels) > 1 else "")
    from_zero = not log and (rows[:, 0] == 0).all()
    for key, panel in histories.items():
        panel.set(
            xscale="log" if log else "linear",
            xlabel="Time [s]" if from_zero else "Time since the first instant [s]",
            ylabel=str(sketch.about[key].axis_label),
        )
    return sketch.finish()


def _largest_in_words(sketch: ResultSketch) -> list[str]:
    """What sets histories apart: their largest depths or loads, whichever were given as
    round numbers.
    """

    def words(key: str, name: str) -> list[str]:
        rows = (sketch.fields[key][curve.place] for curve in sketch.curves)
        return [
            f"to {in_words(name, float(np.nanmax(row, initial=0.0)))}" for row in rows
        ]

    force, depth = words("force", "load"), words("depth", "depth")
    return depth if sum(map(len, depth)) < sum(map(len, force)) else force


def draw_rough_contact(
    result: Drawable, ask: DrawAsk, x: str = "", y: str = ""
) -> Axes:
    """Draws a field of a rough contact, both axes logarithmic where they are spread
    widely, its error as a band.
    """
    known = {
        "conductance": "error",
        "thermal": "error",
        "electrical": "error",
        "approach": "approach_error",
        "separation": "approach_error",
    }

    def band(sketch: ResultSketch, line: DrawnLine, drawn: Trace) -> None:
        if y in known:
            error = sketch.along_line(sketch.fields[known[y]], line)
            relative = known[y] == "error"
            half = error * line.y if relative else in_unit(error, sketch.about[y].shown)
            low = np.maximum(line.y - half, 1e-3 * line.y)
            sketch.add(Shaded(line.x, low, line.y + half, colour=line.colour, of=drawn))

    ax = draw(result, ask, x, y, band)
    logarithmic_if_wide(ax, getattr(result, y or result.shows), LOG_RATIO / 4)
    return ax


def draw_surface(
    heights: tuple[np.ndarray, np.ndarray],
    spectrum: tuple[np.ndarray, np.ndarray],
    names: tuple[str, str],
    label: Label = SPECTRUM,
    axes: Sequence[Axes] | None = None,
) -> tuple[Axes, Axes]:
    """Draws heights over a line [m] (left) and a spectrum over wave numbers (right), on
    two axes that are given or new ones; returns them.
    """
    if axes is None:
        from matplotlib.figure import Figure

        axes = tuple(Figure(figsize=(9.6, 3.8), layout="constrained").subplots(1, 2))
    left, right = axes
    x, height = (
        scale * values for scale, values in zip((1e3, 1e6), heights, strict=True)
    )
    left.plot(x, height, color=PALETTE[0], linewidth=0.8)
    left.set(xlabel="Position on the line [mm]", ylabel="Height, into the rubber [µm]")
    look = {"color": PALETTE[0], "marker": "o" if spectrum[0].size < 40 else ""}
    right.loglog(*spectrum, markersize=4, **look)
    right.set(xlabel=str(WAVE_NUMBER), ylabel=str(label))
    for ax, name in zip((left, right), names, strict=True):
        ax.set_title(name, loc="left", fontsize=10)
        frame(ax)
    return left, right


def roughness_in_words(rms_height: float, rms_slope: float) -> str:
    """Both with few digits."""
    return f"rms height {1e6 * rms_height:.3g} µm, rms slope {rms_slope:.3g}"


_ELEMENTS = 61  # in a moving picture
_WINDOW = 2.6  # on each side of it, over the leading edge


@dataclasses.dataclass(frozen=True)
class SteadyElements:
    """What the elements under a body in steady motion do: those of the line in the
    direction of motion, on springs of the strip in the middle.

    Where an element is, counted from the apex, is also how long ago it was touched: one
    passage is the whole field.
    """

    x: np.ndarray  # place ahead of the apex, ascending, shape (n,) [m]
    surface: np.ndarray  # of the rigid body, 0 beyond the leading edge's height [m]
    u: np.ndarray  # displacement into the material [m]
    q: np.ndarray  # contact force density [N/m; Pa on springs]
    branches: np.ndarray  # of each branch, shape (k, n), likewise
    spring: np.ndarray  # of the equilibrium modulus, likewise
    per: str  # unit of force densities
    title: str

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws displacements and the body above force densities; on `ax` the first
        only. Returns the axes of the displacements.
        """
        lower = None
        if ax is None:
            ax, lower = _panels((7.2, 6.0), 2)
        a, x, height = self._body()
        ax.plot(x, height, color="0.45", label="rigid body")
        place = np.append(1e3 * self.x, 1.6 * a)
        ax.plot(place, -1e6 * np.append(self.u, 0.0), label="elements")
        ax.set(ylabel="Height [µm]", xlim=(-3 * a, 1.6 * a))
        ax.set_title(self.title)
        ax.legend()
        bottom = ax if lower is None else lower
        bottom.set_xlabel("Place ahead of the apex [mm]")
        if lower is not None:
            lower.plot(1e3 * self.x, self.q, color="k", label="contact, q")
            lower.plot(1e3 * self.x, self.spring, label="spring")
            most = np.argsort(-np.abs(self.branches).max(axis=1))
            for rank, k in enumerate(most):
                few = rank < _NAMED
                label = f"branch {k + 1}" if few else "other branches"
                lower.plot(
                    1e3 * self.x,
                    self.branches[k],
                    lw=1,
                    color=None if few else "0.7",
                    zorder=None if few else 1,
                    label=label if rank <= _NAMED else None,
                )
            lower.set_ylabel(f"Force density [{self.per}]")
            lower.legend()
        return ax

    def animate(self, path: str | os.PathLike[str], frames: int = 48) -> None:
        """Writes a GIF of elements under the body, which moves on by its contact in so
        many `frames`. Raises `InputError` for fewer than two.
        """
        from matplotlib.animation import FuncAnimation, PillowWriter

        whole_number("frames", frames, 2)
        a, x, height = self._body()
        places = np.linspace(-_WINDOW, _WINDOW, _ELEMENTS) * a
        deep = -1.6e6 * self.u.max()
        (ax,) = _panels((6.4, 3.4), 1)
        (body,) = ax.plot([], [], color="0.3", lw=2)
        bars = ax.vlines(places, deep, 0.0, lw=3)
        ax.set(
            xlim=(-_WINDOW * a, _WINDOW * a),
            ylim=(deep, -0.75 * deep),
            xlabel="Place [mm]",
            ylabel="Height [µm]",
        )
        ax.set_title(self.title)

        def show(frame: int) -> tuple[Line2D, LineCollection]:
            moved = (2 * frame / frames - 1) * a
            at = 1e-3 * (places - moved)
            u = 1e6 * np.interp(at, self.x, self.u, right=0.0)
            touched = np.interp(at, self.x, self.q, right=0.0) > 0
            body.set_data(x + moved, height)
            bars.set_segments(
                [[(i, deep), (i, -j)] for i, j in zip(places, u, strict=True)]
            )
            bars.set_color([_TOUCHING if here else "0.6" for here in touched])
            return body, bars

        made = FuncAnimation(figure_of(ax), show, frames=frames)
        made.save(os.fspath(path), writer=PillowWriter(fps=24))

    def _body(self) -> tuple[float, np.ndarray, np.ndarray]:
        """The leading edge [mm], places [mm] and heights [µm] of the body there."""
        near = np.abs(self.x) <= self.x[-1]
        return 1e3 * self.x[-1], 1e3 * self.x[near], -1e6 * self.surface[near]


def _panels(size: tuple[float, float], rows: int) -> list[Axes]:
    """New axes below each other."""
    import matplotlib.style
    from matplotlib.figure import Figure

    with matplotlib.style.context("elastomdr.figures"):
        figure = Figure(figsize=size, layout="constrained")
        return list(figure.subplots(rows, sharex=True, squeeze=False).flat)
