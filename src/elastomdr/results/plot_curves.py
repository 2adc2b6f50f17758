"""Figures of coefficients, temperatures and shares: curves over velocity, slip,
time or frequency, measured points on them, and a ranking as bars.
"""

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..checks import as_float64, positive, require, significant
from ..errors import InputError
from .axes import Axis, Peak, peak
from .doubts import Doubt, found
from .plotting import (
    FAINT,
    INK,
    LIGHT,
    PALETTE,
    RED,
    DrawAsk,
    DrawnLine,
    Sketch,
    Style,
    begin,
    dotted,
    draw,
    frame,
    notes_of,
    plot_line,
)
from .words import in_unit, in_words

_VISIBLE = 0.004  # part of the figure's height from which an error band can be seen
# distance from a curve's up to which a measured point takes its colour [K]
SAME_TEMPERATURE = 2.0
# markers of measured points by temperature, where nothing was computed
_WITHOUT_CURVE = "s^Dv<>"
_UNSTABLE = "#c03030"


def draw_curve(
    result: Any, ask: DrawAsk, measured: Any = None, spread: Any = None
) -> Any:
    """Draws a coefficient against velocity, its largest value marked, the whole
    uncertainty as a band.

    `spread` has the lower end, the median and the upper end of draws, whose median the
    result is.
    """
    points = None if measured is None else as_measured(measured)
    sketch = Sketch(result, ask)
    fields, entry = sketch.fields, sketch.entry
    below, above, uncertainty = _band(fields, spread)
    cold, hysteresis = fields.get("cold"), fields.get("hysteresis")
    highest = _highest(fields[sketch.y], cold, points)
    shaded, highest_band, lines = False, highest, list(sketch.lines())
    single = len(lines) == 1
    for line in lines:
        top = peak(line.x, line.y)
        label = _peak_in_words(top, line, None if sketch.along else sketch.axis)
        colour = sketch.draw(line, label)
        if cold is not None:
            _draw_thin(sketch, line, cold, "--", colour)
        if hysteresis is not None:
            _draw_parts(sketch, line, hysteresis, colour, single)
        down, up = (sketch.along_line(half, line) for half in (below, above))
        if (np.fmax(down, up) > _VISIBLE * highest).any():
            shaded = True
            highest_band = max(highest_band, float(np.nanmax(line.y + up)))
            _draw_band(sketch, line, down, up, colour)
        if top is not None and line.x.size > 1 and sketch.style.words:
            sketch.peak_mark(top, colour)
            if single and sketch.alone and line.x[0] < line.x[-1]:
                _write_above(sketch, line, top, label)
    if points is not None and sketch.along:
        _draw_measured(sketch, points, lines)
    sketch.set_scale()
    drawn = sketch.canvas.entries or sketch.canvas.foreign
    before = sketch.before[1][1] if drawn else 0.0
    sketch.ax.set_ylim(
        0.0, max(1.16 * highest, 1.04 * min(highest_band, 2 * highest), before)
    )
    entry.notes += ["dashed: without heating"] if cold is not None else []
    if hysteresis is not None and not (single and sketch.alone):
        entry.notes.append("dash-dotted: hysteresis, the rest is adhesive shear")
    entry.notes += [f"shaded: {uncertainty}"] if shaded else []
    return sketch.finish()


def _band(
    fields: Mapping[str, np.ndarray], spread: Any
) -> tuple[np.ndarray, np.ndarray, str]:
    """How far the band reaches below and above each point, and what it holds."""
    half, uncertainty = _uncertainty(fields)
    if spread is None:
        return half, half, uncertainty
    low, middle, high = spread
    uncertainty = f"95 % of the draws, and {uncertainty}"
    return middle - low + half, high - middle + half, uncertainty


def _uncertainty(fields: Mapping[str, np.ndarray]) -> tuple[np.ndarray, str]:
    """Half the width of the band around each point, and what it holds; none at a point
    whose bound is not known, where others have one.
    """
    error, bound = fields["error"], fields.get("model_error")
    if bound is None:
        return error, "numerical error"
    if not np.isfinite(bound).any():
        return error, "numerical error (the model's is not known)"
    return error + bound, "numerical and model error"


def _highest(values: np.ndarray, cold: Any, points: Any) -> float:
    """The highest point of curves and measurement, above zero."""
    values = values if cold is None else np.fmax(values, cold)
    highest = float(np.fmax.reduce(values, axis=None, initial=0.0)) or 1.0
    return highest if points is None else max(highest, float(points["mu"].max()))


def _draw_thin(
    sketch: Sketch, line: DrawnLine, values: np.ndarray, dashes: str, colour: Any
) -> None:
    sketch.ax.plot(
        line.x,
        sketch.along_line(values, line),
        dashes,
        color=colour,
        linewidth=0.7 * sketch.style.line,
        zorder=2.5,
    )


def _draw_parts(
    sketch: Sketch, line: DrawnLine, hysteresis: np.ndarray, colour: Any, single: bool
) -> None:
    """Hysteresis below and adhesive shear above it, as areas under a single curve, as a
    line under several.
    """
    if not (single and sketch.alone) or line.x.size < 2:
        _draw_thin(sketch, line, hysteresis, "-.", colour)
        return
    border = sketch.along_line(hysteresis, line)
    for low, high, shade, label in (
        (np.zeros_like(border), border, PALETTE[2], "hysteresis"),
        (border, line.y, PALETTE[1], "adhesive shear"),
    ):
        style = {"color": shade, "alpha": 0.35, "linewidth": 0, "zorder": 1.5}
        handle = sketch.ax.fill_between(
            line.x, low, high, where=np.isfinite(line.y), **style
        )
        sketch.entry.extras.append((handle, label))


def _draw_band(
    sketch: Sketch, line: DrawnLine, down: np.ndarray, up: np.ndarray, colour: Any
) -> None:
    """The uncertainty, of a single point as a bar."""
    if line.x.size > 1:
        style = {"color": colour, "alpha": LIGHT, "linewidth": 0, "zorder": 2}
        low, high = np.maximum(line.y - down, 0.0), line.y + up
        sketch.ax.fill_between(line.x, low, high, **style)
        return
    style = {"ecolor": colour, "alpha": 0.5, "capsize": 4, "zorder": 2}
    sketch.ax.errorbar(line.x, line.y, [down, up], fmt="none", **style)


def _write_above(sketch: Sketch, line: DrawnLine, top: Peak, label: str) -> None:
    """Labels the peak so that the text stays inside the figure."""
    scale = np.log if sketch.along else np.asarray
    first, last = scale(line.x[0]), scale(line.x[-1])
    share = float((scale(top.x) - first) / (last - first))
    sketch.canvas.single.append(
        sketch.ax.annotate(
            label,
            xy=(top.x, top.y),
            fontsize=9,
            color=INK,
            xytext=(0, 8),
            textcoords="offset points",
            ha="left" if share < 0.25 else "right" if share > 0.75 else "center",
            va="bottom",
        )
    )


def _peak_in_words(top: Peak | None, line: DrawnLine, axis: Axis | None) -> str:
    """The largest value and where it is, along the velocity or an `axis` of something
    else.
    """
    if top is None:
        return "no point converged"
    x = float(line.si[np.flatnonzero(line.x == top.x)[0]])
    name, unit = "velocity", "m/s"
    if axis is not None:
        name, unit = axis.name, axis.quantity.unit if axis.quantity else ""
    place = in_words(name, float(significant(x, 3)) if name == "velocity" else x, unit)
    return f"{top.kind} {significant(top.y, 3)} at {place}".replace("degC", "°C")


def as_measured(measured: Any) -> dict[str, np.ndarray]:
    """Measured points as lists: "velocity" [m/s], "mu" and, if known, "temperature"
    [K], which broadcast.

    Raises `InputError`.
    """
    known = {"velocity", "mu", "temperature"}
    if (
        not isinstance(measured, Mapping)
        or not {"velocity", "mu"} <= set(measured) <= known
    ):
        got = sorted(measured) if isinstance(measured, Mapping) else repr(measured)
        raise InputError(
            'measured must be a mapping with "velocity" [m/s], "mu" and, if '
            f'known, "temperature" [K], got {got}.'
        )
    points = {
        name: np.atleast_1d(as_float64(f"measured {name}", values))
        for name, values in measured.items()
    }
    positive("measured velocity", points["velocity"])
    require("measured mu", points["mu"], "finite", np.isfinite)
    try:
        together = np.broadcast_arrays(*points.values())
        sizes = [values.size for values in points.values() if values.ndim == 1]
        # lists alone are columns of one table
        same = len(sizes) < len(points) or len(set(sizes)) == 1
    except ValueError:
        together, same = [], False
    if not same:
        shapes = ", ".join(f"{name} {values.shape}" for name, values in points.items())
        raise InputError(
            "measured values must be lists of the same length, or arrays that "
            f"broadcast, got {shapes}."
        )
    return {name: values.ravel() for name, values in zip(points, together, strict=True)}


def _draw_measured(
    sketch: Sketch, points: dict[str, np.ndarray], lines: list[DrawnLine]
) -> None:
    """Draws points in the colour of the curve at their temperature, in black where
    there is none.
    """
    measured_at = points.get("temperature")
    computed_at = sketch.fields.get("temperature")
    left = np.ones(points["mu"].shape, dtype=bool)
    if measured_at is not None and computed_at is not None:
        for line in lines:
            temperature = np.atleast_1d(computed_at[line.curve.place])
            near = np.abs(measured_at - temperature[0]) <= SAME_TEMPERATURE
            near &= left & (np.ptp(temperature) == 0)
            if near.any():
                label = f"measured, {in_words('temperature', float(temperature[0]))}"
                _mark_points(sketch, points, near, "o", line.colour, label)
            left &= ~near
    if not left.any():
        return
    if measured_at is None:
        _mark_points(sketch, points, left, "s", INK, "measured")
        return
    _draw_without_curve(sketch, points, left, computed_at is not None)


def _draw_without_curve(
    sketch: Sketch, points: dict[str, np.ndarray], left: np.ndarray, other_curves: bool
) -> None:
    """Points in black, with a marker and a label for each temperature, or one for all
    where these are many.
    """
    note = " (no curve)" if other_curves else ""
    temperature = points["temperature"]
    means = grouped(temperature[left])
    if len(means) > len(_WITHOUT_CURVE):
        low, high = (in_words("temperature", each) for each in (means[0], means[-1]))
        label = f"measured, {low} to {high}{note}"
        _mark_points(sketch, points, left, "s", INK, label)
        return
    nearest = np.abs(temperature[:, None] - means).argmin(axis=1)
    for k, (mean, marker) in enumerate(zip(means, _WITHOUT_CURVE, strict=False)):
        label = f"measured, {in_words('temperature', mean)}{note}"
        _mark_points(sketch, points, left & (nearest == k), marker, INK, label)


def _mark_points(
    sketch: Sketch,
    points: dict[str, np.ndarray],
    chosen: np.ndarray,
    marker: str,
    colour: Any,
    label: str,
) -> None:
    (handle,) = sketch.ax.plot(
        points["velocity"][chosen],
        points["mu"][chosen],
        marker,
        color=colour,
        linestyle="none",
        markersize=2.8 * sketch.style.line,
        markeredgewidth=0.7 * sketch.style.line,
        markerfacecolor="white",
        zorder=5,
    )
    sketch.entry.extras.append((handle, label))


def grouped(temperature: np.ndarray) -> list[float]:
    """The means of temperatures that belong together, ascending [K]."""
    ascending = np.sort(np.ravel(temperature))
    runs = np.split(
        ascending, np.flatnonzero(np.diff(ascending) > SAME_TEMPERATURE) + 1
    )
    return [float(run.mean()) for run in runs if run.size]


def draw_traction(result: Any, ask: DrawAsk) -> Any:
    """Draws traction against creepage or slip, as it was given; dashed what a contact
    has that slips all over.
    """
    x = "slip" if result.slip is not None else "creepage"
    friction = np.asarray(result.friction)
    constant = np.isfinite(friction).all() and np.ptp(friction) == 0

    def full_slip(sketch: Sketch, line: DrawnLine) -> None:
        most = sketch.along_line(sketch.fields["friction"], line)
        if sketch.along and np.isfinite(most).all() and np.ptp(most) > 0:
            limit = np.where(line.x == 0, np.nan, np.sign(line.x) * most)
            sketch.ax.plot(
                line.x, limit, "--", color=line.colour, linewidth=0.9, zorder=1
            )
            top = peak(line.x, np.abs(line.y))
            if top is not None and top.inside:  # at an end the largest may lie beyond
                i = int(np.flatnonzero(line.x == top.x)[0])
                sketch.peak_mark(Peak(top.x, float(line.y[i]), True), line.colour)

    ax = draw(result, ask, x=x, also=full_slip)
    if constant:
        sliding = float(friction.flat[0])
        for bound in (
            {sliding, -sliding} if np.nanmin(getattr(result, x)) < 0 else {sliding}
        ):
            ax.axhline(bound, color="#888888", linewidth=0.9, linestyle="--", zorder=1)
    return ax


def draw_break_out(result: Any, ask: DrawAsk, y: str) -> Any:
    """Draws the break-out coefficient or the real contact against the dwell, the whole
    uncertainty as a band: that of both is relatively the same.
    """

    def band(sketch: Sketch, line: DrawnLine) -> None:
        half, uncertainty = _uncertainty(sketch.fields)
        around = sketch.along_line(half / sketch.fields["mu"], line) * line.y
        _draw_band(sketch, line, around, around, line.colour)
        if (note := f"shaded: {uncertainty}") not in sketch.entry.notes:
            sketch.entry.notes.append(note)

    return draw(result, ask, y=y, also=band)


def draw_heat_build_up(result: Any, ask: DrawAsk) -> Any:
    """Draws temperature against time, with the steady one dotted, or the steady one
    against velocity.
    """
    over_time = result.time is not None

    def steady(sketch: Sketch, line: DrawnLine) -> None:
        if over_time:
            temperature = in_unit(sketch.values("steady", line.curve)[0], "°C")
            sketch.ax.axhline(
                temperature, color=line.colour, linewidth=0.9, linestyle=":"
            )
            sketch.entry.notes[:] = ["dotted: steady"]

    return draw(result, ask, x="time" if over_time else "velocity", also=steady)


def draw_stability(result: Any, ask: DrawAsk) -> Any:
    """Draws the damping ratio against velocity; dotted where friction does not follow,
    shaded where swings grow.
    """
    sketch = Sketch(result, ask)
    ax, extras = sketch.ax, sketch.entry.extras
    for line in sketch.lines():
        follows = sketch.along_line(sketch.fields["follows"], line)
        counts = follows & np.isfinite(line.y)
        # what decides lies on top
        ax.plot(
            line.x, line.y, ":", color=line.colour, linewidth=0.7 * sketch.style.line
        )
        sketch.draw(
            line._replace(y=np.where(counts, line.y, np.nan)),
            marker="o" if counts.sum() == 1 else None,
        )
        unstable = counts & (line.y < 0)
        if unstable.any():
            red = {"color": _UNSTABLE, "alpha": 0.3, "linewidth": 0, "zorder": 1}
            area = ax.fill_between(
                line.x, line.y, 0, where=unstable, interpolate=True, **red
            )
            extras.append((area, "swings grow"))
        # between two points there is an area, at one there is none
        if unstable.sum() == 1:
            ax.plot(
                line.x[unstable], line.y[unstable], "o", color=_UNSTABLE, markersize=4
            )
    limit = ax.axvline(
        float(result.slowest), color="#888888", linewidth=1, linestyle="--"
    )
    extras.append((limit, r"$\lambda\sqrt{k/m}$: below it the ratio is not valid"))
    ax.axhline(0, color="#888888", linewidth=1)
    return sketch.finish()


def draw_dissipation(result: Any, ask: DrawAsk) -> Any:
    """Draws shares against relaxation time, one line per point that converged."""
    sketch = Sketch(result, ask)
    for line in sketch.lines():
        if not sketch.values("converged", line.curve).all():
            continue
        dashpot, label = line.si == 0, line.curve.label
        if dashpot.any():
            share = f"dashpot {significant(float(line.y[dashpot][0]), 2)} %"
            label = f"{label}, {share}" if label else share
        branches = line._replace(x=line.x[~dashpot], y=line.y[~dashpot])
        sketch.draw(branches, marker="o", label=label)
    sketch.set_scale()
    sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def draw_friction_spectrum(result: Any, ask: DrawAsk, colour: Any = None) -> Any:
    """Draws the part of mu per decade of frequency as steps: the area under a line is
    its friction coefficient.
    """
    sketch = Sketch(result, ask)
    half, limits = np.sqrt(result.width), []
    for line in sketch.lines():
        edges = np.append(line.x / half, line.x[-1] * half)
        asked = colour is not None and len(sketch.curves) == 1
        steps = sketch.ax.stairs(
            line.y / np.log10(result.width),
            edges,
            color=colour if asked else line.colour,
            linewidth=sketch.style.line,
        )
        sketch.entry.lines.append((steps, line.curve.label, ""))
        seen = line.x[line.y > 0.01 * np.nanmax(result.mu, initial=0.0)]
        limits += [seen.min() / half, seen.max() * half] if seen.size else []
    sketch.set_scale()
    if limits:
        low, high = sketch.before[0] if sketch.canvas.entries else (np.inf, 0.0)
        sketch.ax.set_xlim(min(low, *limits), max(high, *limits))
    sketch.ax.set_ylim(0.0, None)
    return sketch.finish()


def draw_force_spectrum(result: Any, ask: DrawAsk) -> Any:
    """Draws the amplitudes of a force as a spectrum of lines, or its density as a
    curve.
    """
    if result.shows_density:
        ax = draw(result, ask, "frequency", "density")
        ax.set_yscale("log")
        frame(ax)
        return ax
    sketch = Sketch(result, ask)
    for line in sketch.lines():
        low = np.nanmax(line.y, initial=0.0) * 1e-4 or 1e-300
        sketch.ax.vlines(
            line.x,
            low,
            np.maximum(line.y, low),
            color=line.colour,
            linewidth=0.6 * sketch.style.line,
        )
        (tips,) = sketch.ax.plot(
            line.x, np.maximum(line.y, low), "o", color=line.colour, markersize=4.5
        )
        sketch.entry.lines.append((tips, line.curve.label, ""))
    sketch.ax.set_yscale("log")
    return sketch.finish()


def draw_ranking(ranking: Any, style: str | None, title: str | None) -> Any:
    """Friction of each material against velocity, at the temperature of a ranking, and
    the ranking as bars.
    """
    panels: dict[str, Any] = {"nrows": 1, "ncols": 2, "width_ratios": (1.4, 1.0)}
    if style is not None:
        panels = {"nrows": 2, "ncols": 1, "height_ratios": (1.4, 1.0)}
    left, canvas = begin(DrawAsk(None, style), panels)
    right, look = canvas.panels[1], canvas.style
    if look.words:
        left.figure.set_size_inches(look.wide, look.size[1])
    place_of_curve = {"temperature": ranking.temperature, "pressure": ranking.pressure}
    given = {name: x for name, x in place_of_curve.items() if x is not None}
    known = [place.mu for place in ranking.places if np.isfinite(place.mu)]
    by_material: list[tuple[str, tuple[Doubt, ...]]] = []
    left.set_xscale("log")
    for i, place in enumerate(ranking.places):
        # as in the figure of the curve
        colour = PALETTE[ranking.curve.materials.index(place.material) % len(PALETTE)]
        law = ranking.curve.select(place.material).law()
        doubts = law.doubts_at(velocity=law.velocity, **given)
        by_material.append((place.material, found(doubts)))
        plot_line(
            left,
            law.velocity,
            law(law.velocity, **given),
            dotted(doubts, law.velocity.shape),
            color=colour,
            linewidth=look.line,
            label=place.material,
        )
        _draw_bar(right, look, i, place, colour, 0.01 * max(known, default=1.0))
    left.axvline(ranking.velocity, color=FAINT, linestyle=":")
    left.set(
        xlabel="Sliding velocity [m/s]",
        ylabel="Friction coefficient [-]",
        ylim=(0, None),
    )
    right.set(
        yticks=[],
        xlabel="Friction coefficient [-]",
        xlim=(0, None),
        ylim=(len(ranking.places) - 0.5, -0.75),
    )
    right.locator_params(axis="x", nbins=5)
    for ax in (left, right):
        frame(ax)
    if look.words or title:
        left.figure.suptitle(
            title or f"Ranking at {ranking.where()}".replace("degC", "°C"),
            x=0.01,
            ha="left",
            fontsize=1.2 * look.text,
            fontweight="bold",
            color=INK,
        )
    if look.words and (notes := notes_of(by_material)):
        small = {"fontsize": 0.8 * look.text, "color": FAINT}
        left.annotate(
            textwrap.fill("; ".join(notes), 75),
            (0, 1),
            (0, 0.6 * look.text),
            xycoords="axes fraction",
            textcoords="offset points",
            va="bottom",
            **small,
        )
    return left


def _draw_bar(
    ax: Any, look: Style, i: int, place: Any, colour: Any, margin: float
) -> None:
    """One material of a ranking, its name above the bar."""
    known = np.isfinite(place.uncertainty)
    bar = {"color": colour, "xerr": place.uncertainty if known else None, "capsize": 3}
    ax.barh(i, place.mu, 0.5, **bar)
    name = place.material
    if place.significant is False:
        name += " (lead not significant)"
    elif place.significant is None and not np.isnan(place.ahead):
        name += " (significance not known)"
    ax.text(
        margin,
        i - 0.3,
        name,
        va="bottom",
        fontsize=0.8 * look.text,
        color=RED if place.significant is False else INK,
    )
