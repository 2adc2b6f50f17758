"""Further figures of a fit: shift factors, relaxation spectrum, Cole-Cole, van
Gurp-Palmen. Master curves and series draw themselves (`plot`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..results.axes import Label
from ..results.plotting import (
    INK,
    Across,
    Dots,
    Panels,
    Sketch,
    Trace,
    intervals,
    saved,
)
from .drawing import BAND, BLUE, RED, DrawnIsotherms, celsius, draw_isotherms, sketch
from .master import MasterCurve
from .series import PronyFit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style

# standard deviation of log10 b_T below which a fit had no vertical shifts to find
_NO_VERTICAL = 1e-4


def figures(master: MasterCurve, series: PronyFit) -> dict[str, bytes]:
    """Name to PNG image of everything there is to see of a material's fit."""
    drawn = {"master": series.plot()}
    if master.temperature.size > 1:
        drawn["shifts"] = draw_shifts(master)
    if master.omega.size:
        drawn["cole-cole"] = draw_cole_cole(master, series)
        drawn["van-gurp-palmen"] = draw_van_gurp_palmen(master)
    return {name: saved(ax) for name, ax in drawn.items()}


def draw_spectrum(
    fit: PronyFit, ax: Axes | None = None, style: Style | None = None
) -> Axes:
    """Moduli of the series over their relaxation times with 95 % intervals, and below
    them the relative residuals.
    """
    made = sketch(
        (Label("Relaxation time", "s"), Label("Modulus", "Pa")),
        f"Relaxation spectrum of {fit.material.name or 'the series'}",
        f"{fit.terms} terms, 95 % intervals",
        ax,
        style,
        Panels(2, heights=(3, 2)),
    )
    made.ax.set(xscale="log", yscale="log")
    moduli, spread = np.asarray(fit.material.moduli), 1.96 * fit.moduli_std
    times = np.asarray(fit.material.times)
    made.add(
        intervals(times, moduli - np.minimum(spread, 0.99 * moduli), moduli + spread)
    )
    made.add(Dots(times, moduli, colour=BLUE))
    if made.canvas.several:
        _draw_residuals(made, made.canvas.panels[1], fit)
    return made.finish()


def _draw_residuals(made: Sketch, ax: Axes, fit: PronyFit) -> None:
    ax.set_xscale("log")
    for (name, values), colour in zip(
        fit.residuals.items(), (BLUE, RED, BAND), strict=False
    ):
        x = fit.time if name == "relaxation" else fit.omega
        label = f"residuals of {name}" if np.size(values) else ""
        made.add(
            Dots(x, 100 * np.asarray(values), label, colour=colour, size=1.5, ax=ax)
        )
    made.add(Across(y=0.0, colour="#cccccc", ax=ax))
    rate = r"Reduced angular frequency $\omega\,a_T$ [rad/s]"
    ax.set(
        xlabel=rate if fit.omega.size else r"Reduced time $t/a_T$ [s]",
        ylabel="Residual [%]",
    )


def draw_shifts(
    master: MasterCurve, ax: Axes | None = None, style: Style | None = None
) -> Axes:
    """Horizontal shift factors with 95 % intervals and the laws through them; vertical
    ones below, where there are.
    """
    vertical = ax is None and master.log10_b_std.max() >= _NO_VERTICAL
    made = sketch(
        (Label("Temperature", "°C"), Label(r"Shift factor $\log_{10}\,a_T$", "-")),
        f"Shift factors about {celsius(master.reference)}",
        master.source,
        ax,
        style,
        Panels(2, heights=(3, 1), same_x=True) if vertical else None,
    )
    temperature = master.temperature - 273.15
    y, half = master.log10_a, 1.96 * master.log10_a_std
    made.add(intervals(temperature, y - half, y + half))
    for chosen, hollow, label in (
        (~master.ambiguous, "", "shifted, 95 % interval"),
        (master.ambiguous, "white", "not separable from b_T"),
    ):
        if chosen.any():
            made.add(
                Dots(temperature[chosen], y[chosen], label, colour=BLUE, hollow=hollow)
            )
    fine = np.linspace(temperature.min(), temperature.max(), 200)
    for name, dashes in (("WLF", "-"), ("Arrhenius", ":")):
        if name in master.laws:
            fit = master.laws[name]
            law = np.asarray(fit.law._log10_a(fine + 273.15))
            label = f"{name}, rms {fit.rms:.2g} decades"
            made.add(
                Trace(fine, law, label, colour=RED, dashes=dashes, width=0.8, layer=1.0)
            )
    made.add(Across(x=master.reference - 273.15, colour="#cccccc", layer=0.0))
    if vertical:
        lower = made.canvas.panels[1]
        y, half = master.log10_b, 1.96 * master.log10_b_std
        made.add(intervals(temperature, y - half, y + half, ax=lower))
        made.add(Dots(temperature, y, colour=BLUE, ax=lower))
        made.add(Across(y=0.0, colour="#cccccc", layer=0.0, ax=lower))
        lower.set(xlabel=str(made.labels[0]), ylabel=r"$\log_{10}\,b_T$ [-]")
        made.labels[0] = Label("")
    return made.finish()


def draw_cole_cole(
    master: MasterCurve,
    fit: PronyFit,
    ax: Axes | None = None,
    style: Style | None = None,
) -> Axes:
    """Loss against storage modulus: shifts of frequency drop out, what remains off the
    line is misfit.
    """
    letter = "G" if fit.kind == "shear" else "E"
    lifted = bool(np.abs(master.log10_b).max() > 1e-3)
    made = sketch(
        (
            Label(f"Storage modulus {letter}'", "Pa"),
            Label(f"Loss modulus {letter}''", "Pa"),
        ),
        "Cole-Cole",
        "line: Prony series" + ("; vertical shifts applied" if lifted else ""),
        ax,
        style,
    )
    line = fit.moduli_at(np.geomspace(*fit.window, 400))
    made.ax.set(xscale="log", yscale="log")
    points = master.storage, master.loss
    every = [DrawnIsotherms(*points, master.isotherm)]
    draw_isotherms(made, master.temperature, master.reference, every)
    _widen(made.ax, *map(np.concatenate, zip(points, line, strict=True)))
    made.add(Trace(*line, colour=INK, width=0.67, layer=4.0))
    return made.finish()


def draw_van_gurp_palmen(
    master: MasterCurve, ax: Axes | None = None, style: Style | None = None
) -> Axes:
    """Phase angle against modulus as measured, unshifted: one curve means
    thermorheologically simple.
    """
    modulus = np.hypot(master.dma.storage, master.dma.loss)
    angle = np.degrees(np.arctan2(master.dma.loss, master.dma.storage))
    letter = "G" if master.kind == "shear" else "E"
    made = sketch(
        (Label(f"Modulus |{letter}*|", "Pa"), Label("Phase angle", "°")),
        "Van Gurp-Palmen",
        "as measured, no shift of any kind",
        ax,
        style,
    )
    made.ax.set(xscale="log")
    _widen(made.ax, modulus)
    every = [DrawnIsotherms(modulus, angle, master.isotherm)]
    draw_isotherms(made, master.temperature, master.reference, every)
    return made.finish()


def _widen(ax: Axes, *coordinates: np.ndarray) -> None:
    """Limits for x (and y) that are one value but for rounding, of which matplotlib
    makes no logarithmic axis.
    """
    for values, limit in zip(coordinates, (ax.set_xlim, ax.set_ylim), strict=False):
        if values.max() < 1.001 * values.min():
            limit(0.5 * values.min(), 2.0 * values.max())
