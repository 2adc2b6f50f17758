"""Figures of a fit: master curve and band, shift factors, Cole-Cole, van Gurp-Palmen;
matplotlib only when drawn.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ..results.plotting import (
    FAINT,
    INK,
    PALETTE,
    DrawAsk,
    begin,
    below,
    crowded,
    frame,
    saved,
    write_title,
)

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..io.data import Dma
    from ..material.prony import Prony
    from .laws import LawFit
    from .report import DynamicBand, RelaxationBand

_BLUE, _RED, _BAND = PALETTE[0], PALETTE[4], "#e08214"
# standard deviation of log10 b_T below which a fit had no vertical shifts to find
_NO_VERTICAL = 1e-4
_SHOWN = 12  # temperatures that a legend names
_SAME = 0.5  # distance from the reference up to which an isotherm is called that [K]


# The classes below say what a figure takes from a result. The results themselves import
# this file where they draw, so that it cannot import them.


class MeasuredModuli(Protocol):
    """What a figure needs of data at one temperature, and of a curve through them."""

    @property
    def kind(self) -> str: ...

    @property
    def window(self) -> tuple[float, float]: ...

    @property
    def omega(self) -> np.ndarray: ...

    @property
    def storage(self) -> np.ndarray: ...

    @property
    def loss(self) -> np.ndarray: ...

    @property
    def time(self) -> np.ndarray: ...

    @property
    def relaxation(self) -> np.ndarray: ...

    def band(self, omega: ArrayLike) -> DynamicBand: ...

    def relaxation_band(self, time: ArrayLike) -> RelaxationBand: ...


class ShiftedModuli(MeasuredModuli, Protocol):
    """What a figure needs of a master curve."""

    @property
    def reference(self) -> float: ...

    @property
    def temperature(self) -> np.ndarray: ...

    @property
    def log10_a(self) -> np.ndarray: ...

    @property
    def log10_a_std(self) -> np.ndarray: ...

    @property
    def log10_b(self) -> np.ndarray: ...

    @property
    def log10_b_std(self) -> np.ndarray: ...

    @property
    def ambiguous(self) -> np.ndarray: ...

    @property
    def laws(self) -> Mapping[str, LawFit]: ...

    @property
    def isotherm(self) -> np.ndarray: ...

    @property
    def time_isotherm(self) -> np.ndarray: ...

    @property
    def source(self) -> str: ...

    @property
    def dma(self) -> Dma: ...


class FittedSeries(MeasuredModuli, Protocol):
    """What a figure needs of a Prony series."""

    @property
    def material(self) -> Prony: ...

    @property
    def terms(self) -> int: ...

    @property
    def master(self) -> ShiftedModuli | None: ...

    @property
    def moduli_std(self) -> np.ndarray: ...

    @property
    def residuals(self) -> Mapping[str, np.ndarray]: ...

    def residuals_in_words(self) -> str: ...

    def moduli_at(self, omega: ArrayLike) -> tuple[np.ndarray, np.ndarray]: ...

    def relaxation_at(self, time: ArrayLike) -> np.ndarray: ...


class ShiftedFriction(Protocol):
    """What a figure needs of friction shifted to one temperature."""

    @property
    def reference(self) -> float: ...

    @property
    def temperature(self) -> np.ndarray: ...

    @property
    def velocity(self) -> np.ndarray: ...

    @property
    def mu(self) -> np.ndarray: ...

    @property
    def number(self) -> np.ndarray: ...

    def curve(
        self, velocity: ArrayLike
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...


class SeparatedFriction(Protocol):
    """What a figure needs of friction split into hysteresis and adhesive shear."""

    @property
    def velocity(self) -> np.ndarray: ...

    @property
    def temperature(self) -> np.ndarray | None: ...

    @property
    def measured(self) -> np.ndarray: ...

    @property
    def hysteresis(self) -> np.ndarray: ...

    @property
    def adhesion(self) -> np.ndarray: ...

    @property
    def used(self) -> np.ndarray: ...

    @property
    def parameters(self) -> Mapping[str, float]: ...

    @property
    def interval(self) -> Mapping[str, tuple[float, float]]: ...


class StrainSweeps(Protocol):
    """What a figure needs of strain sweeps."""

    @property
    def strain(self) -> np.ndarray: ...

    @property
    def storage(self) -> np.ndarray: ...

    @property
    def loss(self) -> np.ndarray: ...

    @property
    def omega(self) -> np.ndarray: ...


def figures(master: ShiftedModuli, series: FittedSeries) -> dict[str, bytes]:
    """Name to PNG image of everything there is to see of a material's fit."""
    images = {"master": saved(draw_prony(series))}
    if master.temperature.size > 1:
        images["shifts"] = saved(draw_shifts(master))
    if master.omega.size:
        images["cole-cole"] = saved(draw_cole_cole(series))
        images["van-gurp-palmen"] = saved(draw_van_gurp_palmen(master))
    return images


def draw_master(master: ShiftedModuli, ax: Any = None, style: str | None = None) -> Any:
    """Shifted data, one colour per isotherm, with the smooth curve and its 95 %
    band.
    """
    ax = _axes(ax, style)
    _logarithmic(ax)
    _data(ax, master)
    if master.omega.size:
        omega = np.geomspace(*master.window, 300)
        _band(ax, master.band(omega), "smooth spectrum")
    else:
        t = np.geomspace(1 / master.window[1], 1 / master.window[0], 300)
        _relaxation_band(ax, master.relaxation_band(t), "smooth spectrum")
    _label_moduli(ax, master.kind, bool(master.omega.size))
    _title(ax, f"Master curve at {master.reference - 273.15:.4g} °C", master.source)
    return ax


def draw_prony(fit: FittedSeries, ax: Any = None, style: str | None = None) -> Any:
    """Data and series over frequency (or time), with the 95 % band; the series beyond
    the data is dashed.
    """
    ax = _axes(ax, style)
    _logarithmic(ax)
    dynamic = bool(fit.omega.size)
    if fit.master is not None:
        _data(ax, fit.master)
    elif dynamic:
        _points(ax, fit.omega, fit.storage, "o", _BLUE, "storage modulus")
        _points(ax, fit.omega, fit.loss, "s", _RED, "loss modulus", hollow=True)
    else:
        _points(ax, fit.time, fit.relaxation, "o", _BLUE, "relaxation modulus")
    low, high = fit.window
    label = f"Prony series, {fit.terms} terms"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if dynamic:
            wide = np.geomspace(low / 10, high * 10, 400)
            _dashed(ax, wide, fit.moduli_at(wide))
            _band(ax, fit.band(np.geomspace(low, high, 300)), label)
        else:
            wide = np.geomspace(1 / high / 10, 10 / low, 400)
            _dashed(ax, wide, [fit.relaxation_at(wide)])
            inside = np.geomspace(1 / high, 1 / low, 300)
            _relaxation_band(ax, fit.relaxation_band(inside), label)
    _label_moduli(ax, fit.kind, dynamic)
    title = fit.material.name or "Prony series"
    if fit.master is not None:
        title += f" at {fit.master.reference - 273.15:.4g} °C"
    _title(ax, title, f"rms relative residuals: {fit.residuals_in_words()}")
    return ax


def _points(
    ax: Any,
    x: Any,
    y: Any,
    marker: str,
    colour: Any,
    label: str,
    *,
    hollow: bool = False,
) -> None:
    """Measured points."""
    face = {"markerfacecolor": "none"} if hollow else {}
    ax.plot(x, y, marker, color=colour, markersize=_dot(ax), label=label, **face)


def _dashed(ax: Any, x: np.ndarray, curves: Any) -> None:
    """Curves beyond the data."""
    label: str | None = "beyond the data"
    for y in curves:
        ax.plot(x, y, "--", color=FAINT, linewidth=0.9, zorder=2, label=label)
        label = None


def draw_spectrum(fit: FittedSeries, ax: Any = None, style: str | None = None) -> Any:
    """Moduli of the series over their relaxation times with 95 % intervals, and below
    them the relative residuals.
    """
    alone = ax is None
    ax = _axes(ax, style, {"nrows": 2, "height_ratios": (3, 2)} if alone else None)
    ax.set(xscale="log", yscale="log")
    moduli, spread = np.asarray(fit.material.moduli), 1.96 * fit.moduli_std
    interval = np.vstack([np.minimum(spread, 0.99 * moduli), spread])
    _intervals(ax, ax, np.asarray(fit.material.times), moduli, interval)
    ax.set(xlabel="Relaxation time [s]", ylabel="Modulus [Pa]")
    frame(ax)
    if alone:
        _draw_residuals(ax, ax._elastomdr.panels[1], fit)
    _title(
        ax,
        f"Relaxation spectrum of {fit.material.name or 'the series'}",
        f"{fit.terms} terms, 95 % intervals",
    )
    return ax


def _intervals(
    main: Any, ax: Any, x: Any, y: Any, half: Any, dots: bool = True
) -> None:
    """Points with their 95 % intervals, or the intervals alone; as large as those of
    `main`.
    """
    style = {"ecolor": FAINT, "capsize": 0.7 * _dot(main)}
    if dots:
        style |= {"fmt": "o", "color": _BLUE, "markersize": _dot(main)}
    else:
        style |= {"fmt": "none", "zorder": 2}
    ax.errorbar(x, y, half, **style)


def _draw_residuals(main: Any, ax: Any, fit: FittedSeries) -> None:
    colours = (_BLUE, _RED, _BAND)
    for (name, values), colour in zip(fit.residuals.items(), colours, strict=False):
        if np.size(values):
            x = fit.time if name == "relaxation" else fit.omega
            style = {"color": colour, "markersize": 0.7 * _dot(main), "label": name}
            ax.semilogx(x, 100 * np.asarray(values), "o", **style)
    ax.axhline(0.0, color="#cccccc", linewidth=0.8, zorder=0)
    rate = r"Reduced angular frequency $\omega\,a_T$ [rad/s]"
    ax.set(
        xlabel=rate if fit.omega.size else r"Reduced time $t/a_T$ [s]",
        ylabel="Residual [%]",
    )
    frame(ax)
    legend = {"frameon": False, "fontsize": _size(main)}
    if main._elastomdr.style.words:
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), **legend)
        main.figure.subplots_adjust(hspace=0.42)
    else:
        legend |= {"ncols": 2, "borderaxespad": 0.1}
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), **legend)


def draw_shifts(master: ShiftedModuli, ax: Any = None, style: str | None = None) -> Any:
    """Horizontal shift factors with 95 % intervals and the laws through them; vertical
    ones below, where there are.
    """
    vertical = ax is None and master.log10_b_std.max() >= _NO_VERTICAL
    panels = {"nrows": 2, "sharex": True, "height_ratios": (3, 1)} if vertical else None
    ax = _axes(ax, style, panels)
    lowest = ax._elastomdr.panels[1] if vertical else ax
    celsius = master.temperature - 273.15
    half = 1.96 * master.log10_a_std
    _intervals(ax, ax, celsius, master.log10_a, half, dots=False)
    for ambiguous, face, label in (
        (False, _BLUE, "shifted, 95 % interval"),
        (True, "white", "not separable from b_T"),
    ):
        chosen = master.ambiguous == ambiguous
        if chosen.any():
            look = {"color": _BLUE, "markerfacecolor": face, "markersize": _dot(ax)}
            x, y = celsius[chosen], master.log10_a[chosen]
            ax.plot(x, y, "o", label=label, **look)
    fine = np.linspace(celsius.min(), celsius.max(), 200)
    for name, dashes in (("WLF", "-"), ("Arrhenius", ":")):
        if name in master.laws:
            fit = master.laws[name]
            law = np.asarray(fit.law._log10_a(fine + 273.15))
            label = f"{name}, rms {fit.rms:.2g} decades"
            ax.plot(fine, law, dashes, color=_RED, label=label, zorder=1)
    ax.axvline(master.reference - 273.15, color="#cccccc", linewidth=0.8, zorder=0)
    ax.set_ylabel(r"Shift factor $\log_{10}\,a_T$ [-]")
    ax.legend(frameon=False, fontsize=_size(ax))
    if vertical:
        half = 1.96 * master.log10_b_std
        _intervals(ax, lowest, celsius, master.log10_b, half)
        lowest.axhline(0.0, color="#cccccc", linewidth=0.8, zorder=0)
        lowest.set_ylabel(r"$\log_{10}\,b_T$ [-]")
    lowest.set_xlabel("Temperature [°C]")
    frame(ax)
    if vertical:
        frame(lowest)
    _title(ax, f"Shift factors about {master.reference - 273.15:.4g} °C", master.source)
    return ax


def draw_cole_cole(fit: FittedSeries, ax: Any = None, style: str | None = None) -> Any:
    """Loss against storage modulus: shifts of frequency drop out, what remains off the
    line is misfit.
    """
    ax = _axes(ax, style)
    master = fit.master
    storage, loss = (
        (fit.storage, fit.loss) if master is None else (master.storage, master.loss)
    )
    lifted = master is not None and bool(np.abs(master.log10_b).max() > 1e-3)
    colours = _BLUE if master is None else _colours(master, master.isotherm)
    line = fit.moduli_at(np.geomspace(fit.window[0], fit.window[1], 400))
    _logarithmic(ax)
    _widen(ax, np.concatenate([storage, line[0]]), np.concatenate([loss, line[1]]))
    ax.scatter(storage, loss, c=colours, s=_dot(ax) ** 2, zorder=3)
    ax.plot(*line, color=INK, linewidth=1.2, zorder=4)
    letter = "G" if fit.kind == "shear" else "E"
    ax.set(
        xlabel=f"Storage modulus {letter}' [Pa]", ylabel=f"Loss modulus {letter}'' [Pa]"
    )
    frame(ax)
    _legend(ax, master)
    _title(
        ax,
        "Cole-Cole",
        "line: Prony series" + ("; vertical shifts applied" if lifted else ""),
    )
    return ax


def draw_van_gurp_palmen(
    master: ShiftedModuli, ax: Any = None, style: str | None = None
) -> Any:
    """Phase angle against modulus as measured, unshifted: one curve means
    thermorheologically simple.
    """
    ax = _axes(ax, style)
    modulus = np.hypot(master.dma.storage, master.dma.loss)
    angle = np.degrees(np.arctan2(master.dma.loss, master.dma.storage))
    ax.set(xscale="log")
    _widen(ax, modulus)
    ax.scatter(
        modulus, angle, c=_colours(master, master.isotherm), s=_dot(ax) ** 2, zorder=3
    )
    letter = "G" if master.kind == "shear" else "E"
    ax.set(xlabel=f"Modulus |{letter}*| [Pa]", ylabel="Phase angle [°]")
    frame(ax)
    _legend(ax, master)
    _title(ax, "Van Gurp-Palmen", "as measured, no shift of any kind")
    return ax


def draw_friction_master(
    master: ShiftedFriction, ax: Any = None, style: str | None = None
) -> Any:
    """Measured friction over reduced velocity, one colour per temperature, with the
    smooth curve and its band.
    """
    ax = _axes(ax, style)
    levels = master.temperature
    colours = _scale(levels.size)
    for i, temperature in enumerate(levels):
        isotherm = master.number == i
        ax.semilogx(
            master.velocity[isotherm],
            master.mu[isotherm],
            "o",
            color=colours[i],
            markersize=_dot(ax),
            label=_celsius(float(temperature)),
        )
    v = np.geomspace(master.velocity.min(), master.velocity.max(), 300)
    value, low, high = master.curve(v)
    (line,) = ax.semilogx(v, value, color=INK, linewidth=1.2)
    ax.fill_between(v, low, high, color=FAINT, alpha=0.25, linewidth=0)
    ax.set(xlabel=r"Reduced velocity $v\,a_T$ [m/s]", ylabel="Friction coefficient [-]")
    frame(ax)
    outside = _legend_outside(ax, *ax.get_legend_handles_labels())
    ax.legend(
        [line],
        ["smooth curve, 95 % band"],
        frameon=False,
        fontsize=_size(ax),
        loc="best",
    )
    ax.add_artist(outside)
    outside.set_clip_on(False)  # else no room is left for it
    _title(ax, f"Measured friction shifted to {master.reference - 273.15:.4g} °C", "")
    return ax


def draw_adhesion(
    fit: SeparatedFriction, ax: Any = None, style: str | None = None
) -> Any:
    """Measured friction over velocity, one colour per temperature, with the fitted sum
    and hysteresis alone.
    """
    ax = _axes(ax, style)
    if fit.temperature is None:
        temperature = np.zeros(fit.velocity.size)
    else:
        temperature = np.round(fit.temperature, 1)
    levels = np.unique(temperature)
    for isotherm, colour in zip(levels, _scale(levels.size), strict=True):
        chosen = np.flatnonzero(temperature == isotherm)
        chosen = chosen[np.argsort(fit.velocity[chosen], kind="stable")]
        v, used = fit.velocity[chosen], fit.used[chosen]
        name = "measured" if fit.temperature is None else _celsius(float(isotherm))
        look = {"color": colour, "markersize": _dot(ax), "label": name}
        ax.semilogx(v[used], fit.measured[chosen][used], "o", **look)
        total = (fit.hysteresis + fit.adhesion)[chosen]
        ax.semilogx(v, total, "-", color=colour, linewidth=1.3)
        ax.semilogx(v, fit.hysteresis[chosen], "-.", color=colour, linewidth=0.9)
    ax.set(xlabel="Sliding velocity [m/s]", ylabel="Friction coefficient [-]")
    ax.set_ylim(0.0, None)
    frame(ax)
    outside = _legend_outside(ax, *ax.get_legend_handles_labels())
    keys = [ax.plot([], [], look, color=INK, linewidth=1.1)[0] for look in ("-", "-.")]
    legend = {"frameon": False, "fontsize": _size(ax), "loc": "best"}
    ax.legend(keys, ["fitted sum", "hysteresis"], **legend)
    ax.add_artist(outside)
    outside.set_clip_on(False)
    low, high = (x / 1e6 for x in fit.interval["stress"])
    stress = f"{fit.parameters['stress'] / 1e6:.3g} MPa"
    _title(
        ax,
        "Hysteresis and adhesive shear",
        f"stress {stress} ({low:.3g} to {high:.3g}, 95 %)",
    )
    return ax


def draw_softening(
    sweeps: StrainSweeps,
    factors: Callable[[np.ndarray], tuple[Any, Any]],
    ax: Any = None,
    style: str | None = None,
) -> Any:
    """Factors on both moduli over the strain amplitude, and the measured points about
    their own sweeps.
    """
    ax = _axes(ax, style)
    strain = np.geomspace(sweeps.strain.min() / 3, sweeps.strain.max(), 200)
    for values, factor, colour, mark, name in (
        (sweeps.storage, factors(strain)[0], _BLUE, "o", "storage"),
        (sweeps.loss, factors(strain)[1], _RED, "s", "loss"),
    ):
        ax.semilogx(
            100 * strain, factor, color=colour, linewidth=1.3, label=f"{name} modulus"
        )
        ax.semilogx(
            100 * sweeps.strain,
            values,
            mark,
            color=colour,
            markersize=_dot(ax),
            markerfacecolor="none",
        )
    ax.set(
        xlabel="Strain amplitude [%]",
        ylabel="Factor on the modulus of small strain [-]",
    )
    ax.set_ylim(0.0, None)
    frame(ax)
    ax.legend(frameon=False, fontsize=_size(ax), loc="best")
    size = (
        f"{sweeps.omega.size} sweep{'s' * (sweeps.omega.size > 1)}, {sweeps.strain.size} "
        "points"
    )
    _title(ax, "Softening with strain", size)
    return ax


def _data(ax: Any, master: ShiftedModuli) -> None:
    if master.omega.size:
        colours = _colours(master, master.isotherm)
        ax.scatter(
            master.omega,
            master.storage,
            c=colours,
            s=_dot(ax) ** 2,
            marker="o",
            zorder=3,
        )
        ax.scatter(
            master.omega,
            master.loss,
            s=_dot(ax) ** 2,
            marker="s",
            facecolors="none",
            edgecolors=colours,
            zorder=3,
        )
        ax.plot([], [], "o", color=FAINT, markersize=_dot(ax), label="storage modulus")
        ax.plot(
            [],
            [],
            "s",
            color=FAINT,
            markersize=_dot(ax),
            markerfacecolor="none",
            label="loss modulus",
        )
    else:
        ax.scatter(
            master.time,
            master.relaxation,
            c=_colours(master, master.time_isotherm),
            s=_dot(ax) ** 2,
            zorder=3,
        )
        ax.plot(
            [], [], "o", color=FAINT, markersize=_dot(ax), label="relaxation modulus"
        )
    _legend(ax, master)


def _band(ax: Any, band: Any, label: str) -> None:
    ax.plot(band.omega, band.storage, color=INK, linewidth=1.2, label=label, zorder=4)
    ax.plot(band.omega, band.loss, color=INK, linewidth=1.2, zorder=4)
    for low, high in (
        (band.storage_low, band.storage_high),
        (band.loss_low, band.loss_high),
    ):
        once = "95 % interval" if low is band.loss_low else None
        ax.fill_between(
            band.omega,
            low,
            high,
            color=_BAND,
            alpha=0.35,
            linewidth=0,
            zorder=1,
            label=once,
        )


def _relaxation_band(ax: Any, band: Any, label: str) -> None:
    ax.plot(band.time, band.relaxation, color=INK, linewidth=1.2, label=label, zorder=4)
    limits = band.relaxation_low, band.relaxation_high
    ax.fill_between(
        band.time,
        *limits,
        color=_BAND,
        alpha=0.35,
        linewidth=0,
        zorder=1,
        label="95 % interval",
    )


def _label_moduli(ax: Any, kind: str, dynamic: bool) -> None:
    letter = "G" if kind == "shear" else "E"
    if dynamic:
        ax.set(
            xlabel=r"Reduced angular frequency $\omega\,a_T$ [rad/s]",
            ylabel=f"Moduli {letter}', {letter}'' [Pa]",
        )
    else:
        ax.set(
            xlabel=r"Reduced time $t/a_T$ [s]",
            ylabel=f"Relaxation modulus {letter} [Pa]",
        )
    frame(ax)
    handles, labels = ax.get_legend_handles_labels()
    if labels:
        first = ax.get_legend()
        ax.legend(handles, labels, frameon=False, fontsize=_size(ax), loc="best")
        if first is not None:
            ax.add_artist(first)
            first.set_clip_on(False)  # else no room is left for it


def _legend(ax: Any, master: ShiftedModuli | None) -> None:
    """Temperatures outside the axes, some twelve of them, and the isotherm of the
    reference among these.
    """
    if master is None:
        return
    count = master.temperature.size
    shown = np.linspace(0, count - 1, min(count, _SHOWN)).round().astype(int)
    reference = int(np.abs(master.temperature - master.reference).argmin())
    if reference not in shown:
        # in the place of its neighbour
        shown[np.abs(shown[1:-1] - reference).argmin() + 1] = reference
    colours = _scale(count)
    handles = [
        ax.plot([], [], "o", color=colours[i], markersize=_dot(ax))[0] for i in shown
    ]
    labels = [_celsius(float(master.temperature[i])) for i in shown]
    if abs(master.temperature[reference] - master.reference) < _SAME:
        labels[list(shown).index(reference)] += ", ref."
    _legend_outside(ax, handles, labels)


def _legend_outside(ax: Any, handles: list[Any], labels: list[str]) -> Any:
    """Beside the axes; below them where they are some of several; in a paper, above
    them.
    """
    canvas = ax._elastomdr
    rows = {
        "ncols": 4,
        "columnspacing": 0.8,
        "handlelength": 1,
        "handletextpad": 0.4,
        "borderaxespad": 0.1,
    }
    if not canvas.style.words:
        place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), **rows}
        if canvas.own_figure:
            ax.figure.set_size_inches(
                canvas.style.wide, canvas.style.size[1] + 0.14 * -(-len(labels) // 4)
            )
    elif crowded(ax, canvas):
        place = below(ax, canvas.style) | rows
    else:
        place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
    return ax.legend(handles, labels, frameon=False, fontsize=_size(ax), **place)


def _celsius(temperature: float) -> str:
    return f"{round(temperature - 273.15, 1) + 0.0:g} °C"  # without the sign of -0


def _colours(master: ShiftedModuli, number: np.ndarray) -> np.ndarray:
    return _scale(master.temperature.size)[number]


def _scale(count: int) -> np.ndarray:
    import matplotlib

    return np.asarray(
        matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, max(count, 2)))
    )[:count]


def _axes(ax: Any, style: str | None, panels: Any = None) -> Any:
    """The axes that were given, or new ones, with room for the temperatures beside
    them.
    """
    ax, canvas = begin(DrawAsk(ax, style), panels)
    if canvas.own_figure and canvas.style.words:
        figure = ax.figure
        figure.set_size_inches(7.4, 4.6)
        # with fixed margins: looking for the best ones takes longer than the fit
        figure.set_layout_engine(None)
        figure.subplots_adjust(left=0.155, right=0.84, bottom=0.12, top=0.86)
    return ax


def _dot(ax: Any) -> float:
    """Size of a mark [points]."""
    return 4.0 if ax._elastomdr.style.words else 2.2


def _size(ax: Any) -> float:
    """Of the letters in a legend."""
    return ax._elastomdr.style.text - (2 if ax._elastomdr.style.words else 1)


def _logarithmic(ax: Any) -> None:
    """Makes both axes logarithmic before anything is drawn: changed later, limits are
    those of the data so far.
    """
    ax.set(xscale="log", yscale="log")


def _widen(ax: Any, *coordinates: np.ndarray) -> None:
    """Limits for x (and y) that are one value but for rounding, of which matplotlib
    makes no logarithmic axis.
    """
    for values, limit in zip(coordinates, (ax.set_xlim, ax.set_ylim), strict=False):
        if values.max() < 1.001 * values.min():
            limit(0.5 * values.min(), 2.0 * values.max())


def _title(ax: Any, title: str, small: str) -> None:
    write_title(
        ax,
        ax._elastomdr,
        title,
        False,
        (small if len(small) <= 90 else f"{small[:87]}...", "", ""),
    )
