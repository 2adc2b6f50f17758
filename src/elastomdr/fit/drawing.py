"""What figures of fits share: points by their temperature, curves with their interval.

It knows no fit, so that the classes of fits, which draw themselves, can import it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..results.axes import Label
from ..results.plotting import (
    FAINT,
    PALETTE,
    Dots,
    DrawAsk,
    Entry,
    Panels,
    Shaded,
    Sketch,
    Trace,
    shades,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style
    from .report import DynamicBand, RelaxationBand

BLUE, RED, BAND = PALETTE[0], PALETTE[4], "#e08214"
_SAME = 0.5  # distance from the reference up to which an isotherm is called that [K]
_LONG = 90  # letters of a line in small print


class DrawnIsotherms(NamedTuple):
    """Measured points of all temperatures."""

    x: np.ndarray
    y: np.ndarray
    isotherm: np.ndarray  # number of the temperature of each
    name: str = ""  # of what is measured
    mark: str = "o"
    hollow: str = ""


def sketch(
    labels: tuple[Label, Label],
    title: str,
    small: str = "",
    ax: Axes | None = None,
    style: Style | None = None,
    panels: Panels | None = None,
) -> Sketch:
    """A figure of a fit, with one line of small print."""
    short = small if len(small) <= _LONG else f"{small[: _LONG - 3]}..."
    entry = Entry(title, title, labels, notes=[short] if short else [])
    return Sketch(DrawAsk(ax, style), entry, panels)


def of_moduli(
    kind: str,
    dynamic: bool,
    title: str,
    small: str,
    ax: Axes | None,
    style: Style | None,
) -> Sketch:
    """A figure of moduli over frequency, or over time, both logarithmic."""
    letter = "G" if kind == "shear" else "E"
    labels = (
        Label(r"Reduced angular frequency $\omega\,a_T$", "rad/s"),
        Label(f"Moduli {letter}', {letter}''", "Pa"),
    )
    if not dynamic:
        labels = (
            Label(r"Reduced time $t/a_T$", "s"),
            Label(f"Relaxation modulus {letter}", "Pa"),
        )
    made = sketch(labels, title, small, ax, style)
    # before anything is drawn: changed later, limits are those of the data so far
    made.ax.set(xscale="log", yscale="log")
    return made


def draw_isotherms(
    made: Sketch,
    temperature: np.ndarray,
    reference: float | None,
    every: Sequence[DrawnIsotherms],
) -> None:
    """Isotherms in one colour for each temperature; the marks tell what was measured."""
    for i, colour in enumerate(shades(temperature.size)):
        label = celsius(float(temperature[i]))
        if reference is not None and abs(temperature[i] - reference) < _SAME:
            label += ", ref."
        for of in every:
            here = of.isotherm == i
            if here.any():
                made.add(
                    Dots(
                        of.x[here],
                        of.y[here],
                        label,
                        is_curve=bool(label),
                        colour=colour,
                        mark=of.mark,
                        hollow=of.hollow,
                    )
                )
                label = ""
    none = np.zeros(0)
    for of in every:
        if of.name:
            made.add(
                Dots(none, none, of.name, colour=FAINT, mark=of.mark, hollow=of.hollow)
            )


def draw_band(made: Sketch, band: DynamicBand | RelaxationBand, label: str) -> None:
    """The moduli of a band and their 95 % intervals."""
    x, *columns, _ = band
    interval = "95 % interval"
    for k in range(0, len(columns), 3):
        y, low, high = columns[k : k + 3]
        line = made.add(Trace(x, y, label, width=0.67, layer=4.0))
        made.add(
            Shaded(
                x, low, high, interval, of=line, colour=BAND, opacity=0.35, layer=1.0
            )
        )
        label = interval = ""


def draw_beyond(made: Sketch, x: np.ndarray, curves: Sequence[np.ndarray]) -> None:
    """Curves beyond the data."""
    label = "beyond the data"
    for y in curves:
        made.add(
            Trace(
                x,
                y,
                label,
                silent=True,
                colour=FAINT,
                dashes="--",
                width=0.5,
                layer=2.0,
            )
        )
        label = ""


def celsius(temperature: float) -> str:
    """A temperature [K] as it is written in a figure."""
    return f"{round(temperature - 273.15, 1) + 0.0:g} °C"  # without the sign of -0


def draw_friction(
    made: Sketch,
    velocity: np.ndarray,
    temperature: np.ndarray | None,
    measured: np.ndarray,
    computed: Mapping[str, np.ndarray],
) -> None:
    """Measured points, NaN where they count for nothing, in one colour for each
    temperature, over what was computed at the same places: the first by its name as a
    line, others dash-dotted.
    """
    made.ax.set(xscale="log")
    kelvin = np.zeros(velocity.size) if temperature is None else temperature.round(2)
    levels, looks = np.unique(kelvin), (("-", 0.7), ("-.", 0.5))
    for level, colour in zip(levels, shades(levels.size), strict=True):
        here = np.flatnonzero(kelvin == level)
        here = here[np.argsort(velocity[here], kind="stable")]
        label = "measured" if temperature is None else celsius(float(level))
        of_level = velocity[here]
        made.add(Dots(of_level, measured[here], label, is_curve=True, colour=colour))
        for y, (dashes, width) in zip(computed.values(), looks, strict=False):
            made.add(
                Trace(
                    of_level,
                    y[here],
                    colour=colour,
                    dashes=dashes,
                    width=width,
                    silent=dashes != "-",
                )
            )
    none = np.zeros(0)
    for name, (dashes, width) in zip(computed, looks, strict=False):
        made.add(Trace(none, none, name, dashes=dashes, width=width))
    made.ax.set_ylim(0.0, None)
