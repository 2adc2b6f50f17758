"""Figures of a rough surface: a line of the ensemble with its power spectrum, and where a line touches the rubber."""

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from ..mapping.rough_line import RoughLine
from ..mapping.spectrum import AbstractSpectrum
from ..mapping.synthesis import synthesise
from .figure import _DPI, _write_title

if TYPE_CHECKING:
    from .line_contact import LineContact

_BLUE, _RED, _GREY = "#1f5a94", "#c23b22", "#8a8a8a"


def draw_surface(surface: AbstractSpectrum | RoughLine, axes: Any = None, seed: int = 0) -> Any:
    """Draws heights of the line (left) and the spectrum C(q) (right); returns the two matplotlib Axes.

    Of a `RoughLine` its own heights and spectrum, two-sided: (A_j^2/4)/dq of each of its waves, dq = 2 pi/period.
    """
    if axes is None:
        from matplotlib.figure import Figure

        axes = Figure(figsize=(9.6, 3.8), layout="constrained").subplots(1, 2)
    left, right = axes
    whole = isinstance(surface, RoughLine)
    line = surface if whole else synthesise(surface, seed)
    left.plot(1e3 * np.asarray(line.x), 1e6 * np.asarray(line.height), color=_BLUE, linewidth=0.8)
    left.set(xlabel="Position on the line [mm]", ylabel="Height, into the rubber [µm]")
    left.set_title("Line" if whole else f"Line of the method, seed {seed}", loc="left", fontsize=10)
    if whole:
        n = line.count
        q = 2 * np.pi / float(line.period) * np.arange(1, n // 2)
        power = np.abs(np.fft.rfft(np.asarray(line.height))[1 : n // 2] / n) ** 2 * float(line.period) / (2 * np.pi)
        right.loglog(q, np.where(power > 1e-16 * power.max(), power, np.nan), ".", color=_BLUE, markersize=3)
        right.set_ylabel("Spectrum of the line [m³]")
    else:
        right.loglog(surface.q, surface.c, "o-" if surface.q.size < 40 else "-", color=_BLUE, markersize=4)
        right.set_ylabel("Spectrum C(q), <h²> = ∫C d²q [m⁴]")
    right.set_xlabel("Wave number q [rad/m]")
    rms = f"rms height {1e6 * float(surface.rms_height):.3g} µm, rms slope {float(surface.rms_slope):.3g}"
    right.set_title(rms + ("" if whole else " (surface)"), loc="left", fontsize=10)
    for ax in (left, right):
        ax.grid(color="#dddddd", linewidth=0.6)
        ax.set_axisbelow(True)
        ax.spines[["top", "right"]].set_visible(False)
    return axes


def draw_contact(result: "LineContact", ax: Any = None, title: str | None = None) -> Any:
    """Draws the line and the rubber's surface, with the stretches in contact in colour; returns the Axes."""
    if ax is None:
        from matplotlib.figure import Figure

        ax = Figure(figsize=(8.6, 4.4), layout="constrained").add_subplot()
    x, line, rubber = (np.asarray(a) for a in (1e3 * result.x, 1e6 * result.height, 1e6 * result.surface))
    touching = np.asarray(result.touching)
    ax.plot(x, line, color=_GREY, linewidth=0.9, label="rough line")
    ax.plot(x, rubber, color=_BLUE, linewidth=1.1, label="rubber")
    if touching.any():
        label = f"in contact, {result.share:.1%} of the line (not the real contact area)"
        ax.plot(x, np.where(touching, rubber, np.nan), color=_RED, linewidth=2.4, label=label)
        alone = touching & ~np.roll(touching, 1) & ~np.roll(touching, -1)  # a single sample draws no stretch
        ax.plot(x[alone], rubber[alone], ".", color=_RED, markersize=5)
    ax.set(
        xlabel="Position on the line, which moves to the right [mm]", ylabel="Depth below the undeformed rubber [µm]"
    )
    known = [float(y) for y in (*line, *rubber) if np.isfinite(y)]
    if known:
        top = min(0.0, float(np.min(rubber, where=np.isfinite(rubber), initial=0.0)))
        # The deepest valleys of a surface are far below what the rubber sees.
        least = max(min(known), top - 1.5 * (max(known) - top))
        ax.set_ylim(max(known) + 0.05 * (max(known) - least), least)
    ax.set_xlim(x[0], x[-1])
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3, frameon=False, fontsize=8.5)
    ax.grid(color="#dddddd", linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    inputs = dict(result.inputs)
    at = ", ".join(inputs[name] for name in ("velocity", "pressure", "temperature") if name in inputs)
    note = "" if result.converged.all() else "the point did not converge"
    _write_title(ax, title or f"{result.heading()}, {at}", result.model, note)
    return ax


def contact_png(result: "LineContact", title: str | None = None) -> bytes:
    """The figure of `draw_contact` as a PNG image, 200 dots per inch."""
    buffer = io.BytesIO()
    draw_contact(result, title=title).figure.savefig(buffer, format="png", dpi=_DPI)
    return buffer.getvalue()
