"""Figure of a rough surface: a line of the ensemble, and the power spectrum it was made from."""

from typing import Any

import numpy as np

from ..mapping.rough_line import RoughLine
from ..mapping.spectrum import AbstractSpectrum
from ..mapping.synthesis import synthesise

_BLUE, _FAINT = "#1f5a94", "#666666"


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
