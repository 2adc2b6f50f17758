"""Figures of contacts: impact and indentation in time, rough lines and surfaces."""

from typing import Any

import numpy as np

from ..checks import significant
from .axes import Curve, Peak
from .plotting import (
    LIGHT,
    LOG_RATIO,
    PALETTE,
    Canvas,
    DrawAsk,
    DrawnLine,
    Sketch,
    draw,
    frame,
    plot_line,
    unit_of,
)
from .words import in_unit, in_words

# largest over middle interval from which instants are taken as spread over decades
_DECADES = 30.0
_WAVE_NUMBER = "Wave number q [rad/m]"
_SPECTRUM = "Spectrum C(q), <h²> = ∫C d²q [m⁴]"


def draw_impact(result: Any, ask: DrawAsk) -> Any:
    """Draws the force of one impact against time."""
    from scipy.interpolate import CubicSpline

    about = {q.path: q for q in result.quantities()}
    labels = about["history.time"].axis_label, about["history.force"].axis_label
    sketch = Sketch(result, ask, labels=labels)
    sketch.along = False  # what is drawn is a history
    time = in_unit(np.ravel(result.history.time), "ms")
    force = np.ravel(result.history.force)
    if not np.isfinite(time).all():
        return sketch.finish()
    fine, colour = np.linspace(time[0], time[-1], 400), sketch.colours(1)[0]
    doubted = np.broadcast_to(np.ravel(sketch.dotted), fine.shape)
    curve, order = Curve((), ""), np.arange(fine.size)
    smooth = CubicSpline(time, force)(fine)
    restitution = significant(float(np.ravel(result.restitution)[0]), 4)
    label = f"restitution {restitution}"
    sketch.draw(DrawnLine(curve, order, fine, fine, smooth, colour, doubted), label)
    turn = time.size // 2
    sketch.peak_mark(Peak(time[turn], force[turn], True), colour)
    if sketch.style.words and sketch.alone:
        depth = significant(1e3 * float(np.ravel(result.max_depth)[0]), 3)
        at_turn = (time[turn], force[turn])
        place = {"xytext": (8, 2), "textcoords": "offset points", "fontsize": 9}
        corner = {"transform": sketch.ax.transAxes, "ha": "right", "va": "top"}
        sketch.canvas.single += [
            sketch.ax.annotate(f"turn, {depth} mm deep", at_turn, **place),
            sketch.ax.text(0.98, 0.95, label, fontsize=10, **corner),
        ]
    sketch.ax.set(ylim=(0, None), xlim=(0, None))
    return sketch.finish()


def draw_indentation(result: Any, ask: DrawAsk) -> Any:
    """Draws depth, force and radius against time and the force against the depth; on
    given axes the last alone.
    """
    unit, scale = _force_unit(result.force, ask.ax)
    sketch = Sketch(
        result, ask, panels={"nrows": 2, "ncols": 2}, labels=("", f"Force [{unit}]")
    )
    panels, about, main = sketch.canvas.panels, sketch.about, sketch.ax
    histories = dict(
        zip(("depth", "force", "contact_radius"), panels[:3], strict=False)
    )
    time = np.atleast_1d(result.time)
    rows = time.reshape(-1, time.shape[-1])
    steps = np.diff(rows[0])
    log = bool(steps.size and steps.max() > _DECADES * np.median(steps))
    labels = _largest_in_words(sketch)
    for line, label in zip(sketch.lines(), labels, strict=True):
        t = np.atleast_1d(result.time[line.curve.place])
        since = np.where(t > t[0], t - t[0], np.nan) if log else t - t[0]
        for key, panel in histories.items():
            y = sketch.values(key, line.curve)
            y = scale * y if key == "force" else in_unit(y, about[key].shown)
            style = {"color": line.colour, "linewidth": 0.9 * sketch.style.line}
            plot_line(panel, since, y, line.dotted, **style)
        sketch.ax = panels[3] if panels else main
        sketch.draw(
            line._replace(y=scale * line.y), label=label if len(labels) > 1 else ""
        )
        sketch.ax = main
    from_zero = not log and (rows[:, 0] == 0).all()
    for key, panel in histories.items():
        panel.set(
            xscale="log" if log else "linear",
            xlabel="Time [s]" if from_zero else "Time since the first instant [s]",
            ylabel=f"Force [{unit}]" if key == "force" else about[key].axis_label,
        )
        frame(panel)
    sketch.ax = panels[3] if panels else main
    sketch.finish()
    return main


def _largest_in_words(sketch: Sketch) -> list[str]:
    """What sets histories apart: their largest depths or loads, whichever were given as
    round numbers.
    """

    def words(key: str, name: str) -> list[str]:
        rows = (sketch.values(key, curve) for curve in sketch.curves)
        return [
            f"to {in_words(name, float(np.nanmax(row, initial=0.0)))}" for row in rows
        ]

    force, depth = words("force", "load"), words("depth", "depth")
    return depth if sum(map(len, depth)) < sum(map(len, force)) else force


def _force_unit(force: Any, ax: Any) -> tuple[str, float]:
    """The unit of forces in a figure, and what one newton is in it: that of what has
    been drawn there before.
    """
    units = {"kN": 1e-3, "N": 1.0, "mN": 1e3, "µN": 1e6}
    canvas: Canvas | None = getattr(ax, "_elastomdr", None)
    if canvas is not None and canvas.entries:
        unit = unit_of(canvas.entries[0].labels[1])
        return unit, units.get(unit, 1.0)
    largest = float(np.nanmax(np.abs(force), initial=0.0))
    return next(
        ((unit, scale) for unit, scale in units.items() if largest * scale >= 1),
        ("N", 1.0),
    )


def draw_line_contact(result: Any, ask: DrawAsk) -> Any:
    """Draws the line and the rubber's surface, with what touches in colour."""
    sketch = Sketch(result, ask)
    ax, about, extras = sketch.ax, sketch.about, sketch.entry.extras
    x, line, rubber = (
        in_unit(sketch.fields[key], about[key].shown)
        for key in ("x", "height", "surface")
    )
    touching, thin = np.asarray(result.touching), 0.6 * sketch.style.line
    for y, colour, width, label in (
        (line, "#8a8a8a", 0.8 * thin, "rough line"),
        (rubber, PALETTE[0], thin, "rubber"),
    ):
        extras.append((ax.plot(x, y, color=colour, linewidth=width)[0], label))
    if touching.any():
        label = "in contact"
        if sketch.style.words:
            share = f"{float(result.share):.1%}"
            label += f", {share} of the line (not the real contact area)"
        red = {"color": "#c23b22"}
        in_contact = np.where(touching, rubber, np.nan)
        extras.append((ax.plot(x, in_contact, linewidth=2.2 * thin, **red)[0], label))
        # a single sample draws no line
        alone = touching & ~np.roll(touching, 1) & ~np.roll(touching, -1)
        ax.plot(x[alone], rubber[alone], ".", markersize=5, **red)
    known = [float(y) for y in (*line, *rubber) if np.isfinite(y)]
    if known:
        top = min(0.0, float(np.min(rubber, where=np.isfinite(rubber), initial=0.0)))
        # the deepest valleys are far below the rubber
        lowest = max(min(known), top - 1.5 * (max(known) - top))
        ax.set_ylim(max(known) + 0.05 * (max(known) - lowest), lowest)
    ax.set_xlim(x[0], x[-1])
    return sketch.finish()


def draw_rough_contact(result: Any, ask: DrawAsk, x: str = "", y: str = "") -> Any:
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
    relative = known.get(y) == "error"

    def band(sketch: Sketch, line: DrawnLine) -> None:
        if y not in known:
            return
        error = sketch.along_line(sketch.fields[known[y]], line)
        half = error * line.y if relative else in_unit(error, sketch.about[y].shown)
        low = np.maximum(line.y - half, 1e-3 * line.y)
        sketch.ax.fill_between(
            line.x, low, line.y + half, color=line.colour, alpha=LIGHT, linewidth=0
        )

    ax = draw(result, ask, x, y, band)
    values = np.asarray(getattr(result, y or result.shows))
    values = values[np.isfinite(values) & (values > 0)]
    if values.size and values.max() > LOG_RATIO / 4 * values.min():
        ax.set_yscale("log")
        frame(ax)
    return ax


def draw_surface(
    line: Any, spectrum: Any = None, axes: Any = None, name: str = "DrawnLine"
) -> Any:
    """Draws the heights of a line (left) and a spectrum (right); returns the two
    matplotlib Axes.

    Args:
        line: an `em.RoughLine`.
        spectrum: C(q) of the surface it was made from; None for the line's own,
            two-sided: (A_j^2/4)/dq of each of its waves, dq = 2 pi/period.
        axes: two axes to draw on.
        name: of the line, above it.
    """
    if axes is None:
        from matplotlib.figure import Figure

        axes = Figure(figsize=(9.6, 3.8), layout="constrained").subplots(1, 2)
    left, right = axes
    height = 1e6 * np.asarray(line.height)
    left.plot(1e3 * np.asarray(line.x), height, color=PALETTE[0], linewidth=0.8)
    left.set(xlabel="Position on the line [mm]", ylabel="Height, into the rubber [µm]")
    left.set_title(name, loc="left", fontsize=10)
    if spectrum is None:
        q, power = _line_spectrum(line)
        right.loglog(q, power, ".", color=PALETTE[0], markersize=3)
        right.set_ylabel("Spectrum of the line [m³]")
        title = _roughness_in_words(line)
    else:
        marker = "o-" if spectrum.q.size < 40 else "-"
        right.loglog(spectrum.q, spectrum.c, marker, color=PALETTE[0], markersize=4)
        right.set_ylabel(_SPECTRUM)
        title = f"{_roughness_in_words(spectrum)} (surface)"
    right.set_xlabel(_WAVE_NUMBER)
    right.set_title(title, loc="left", fontsize=10)
    for ax in (left, right):
        frame(ax)
    return axes


def _line_spectrum(line: Any) -> tuple[np.ndarray, np.ndarray]:
    """Wave numbers and the two-sided spectrum of a line, without its rounding."""
    n, period = line.count, float(line.period)
    amplitude = np.abs(np.fft.rfft(np.asarray(line.height))[1 : n // 2] / n)
    power = amplitude**2 * period / (2 * np.pi)
    q = 2 * np.pi / period * np.arange(1, n // 2)
    return q, np.where(power > 1e-16 * power.max(), power, np.nan)


def _roughness_in_words(surface: Any) -> str:
    return (
        f"rms height {1e6 * float(surface.rms_height):.3g} µm, rms slope "
        f"{float(surface.rms_slope):.3g}"
    )


def draw_cutoffs(spectrum: Any, whole: Any = None) -> Any:
    """Draws a spectrum (left) and the rms slope of the surface down to each wavelength
    (right); returns the left Axes.

    Args:
        spectrum: C(q) between its cutoffs, with `moment` and `rms_slope`.
        whole: the spectrum that it is cut from, drawn behind it.
    """
    from matplotlib.figure import Figure

    # laid out by hand: this is drawn while a cutoff moves
    figure = Figure(figsize=(8.6, 3.4))
    left, right = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.085, right=0.985, bottom=0.155, top=0.9, wspace=0.24)
    for each, colour, width in ((whole, "#b8bec6", 1.2), (spectrum, PALETTE[0], 2.0)):
        if each is None:
            continue
        q = np.geomspace(float(each.q_low), float(each.q_high), 200)
        left.loglog(q, each.at(q), color=colour, linewidth=width)
        slope = np.sqrt(2 * np.pi * np.maximum(each.moment(3, each.q_low, q), 0.0))
        right.semilogx(2e3 * np.pi / q, slope, color=colour, linewidth=width)
    left.set(xlabel=_WAVE_NUMBER, ylabel=_SPECTRUM)
    right.set(
        xlabel="Shortest wavelength kept [mm]",
        ylabel="rms slope of the surface [-]",
        ylim=(0.0, None),
    )
    right.invert_xaxis()
    left.set_title(_roughness_in_words(spectrum), loc="left", fontsize=10)
    for ax in (left, right):
        frame(ax)
        ax.minorticks_off()
    return left
