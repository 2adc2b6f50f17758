"""Figures of a fit: master curve and band, shift factors, Cole-Cole, van Gurp-Palmen; matplotlib only when drawn."""

import io
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..fit.grosch import FrictionMaster
    from ..fit.master import MasterCurve
    from ..fit.pipeline import MaterialFit
    from ..fit.series import PronyFit

_INK, _FAINT, _BLUE, _RED = "#222222", "#666666", "#1f5a94", "#b03a2e"
_BAND = "#e08214"
_NO_VERTICAL = 1e-4  # standard deviation of log10 b_T below which a fit had no vertical shifts to find
_DPI = 160


def figures(fit: "MaterialFit") -> dict[str, bytes]:
    """Name to PNG image of everything there is to see of a material's fit."""
    found = {"master": _png(draw_prony(fit.prony))}
    if fit.master.temperature.size > 1:
        found["shifts"] = _png(draw_shifts(fit.master))
    if fit.master.frequency.size:
        found["cole-cole"] = _png(draw_cole_cole(fit.prony))
        found["van-gurp-palmen"] = _png(draw_van_gurp_palmen(fit.master))
    return found


def draw_master(master: "MasterCurve", ax: Any = None) -> Any:
    """Shifted data, one colour per isotherm, with the smooth curve and its 95 % band."""
    ax = _axes() if ax is None else ax
    _logarithmic(ax)
    _data(ax, master)
    if master.frequency.size:
        omega = np.geomspace(*master.window, 300)
        _band(ax, master.band(omega), "smooth spectrum")
    else:
        t = np.geomspace(1 / master.window[1], 1 / master.window[0], 300)
        _relaxation_band(ax, master.relaxation_band(t), "smooth spectrum")
    _label_moduli(ax, master.kind, bool(master.frequency.size))
    _title(ax, f"Master curve at {master.reference - 273.15:.4g} °C", master.source)
    return ax


def draw_prony(fit: "PronyFit", ax: Any = None) -> Any:
    """Data and series over frequency (or time), with the 95 % band; the series beyond the data is dashed."""
    ax = _axes() if ax is None else ax
    _logarithmic(ax)
    if fit.master is not None:
        _data(ax, fit.master)
    elif fit.omega.size:
        ax.plot(fit.omega, fit.storage, "o", color=_BLUE, markersize=4, label="storage modulus")
        ax.plot(fit.omega, fit.loss, "s", color=_RED, markersize=4, markerfacecolor="none", label="loss modulus")
    else:
        ax.plot(fit.time, fit.relaxation, "o", color=_BLUE, markersize=4, label="relaxation modulus")
    low, high = fit.window
    if fit.omega.size:
        wide = np.geomspace(low / 10, high * 10, 400)
        for values, label in zip(fit.moduli_at(wide), ("beyond the data", None), strict=True):
            ax.plot(wide, values, "--", color=_FAINT, linewidth=0.9, zorder=2, label=label)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            _band(ax, fit.band(np.geomspace(low, high, 300)), f"Prony series, {fit.terms} terms")
    else:
        wide = np.geomspace(1 / high / 10, 10 / low, 400)
        ax.plot(wide, fit.relaxation_at(wide), "--", color=_FAINT, linewidth=0.9, zorder=2, label="beyond the data")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            band = fit.relaxation_band(np.geomspace(1 / high, 1 / low, 300))
        _relaxation_band(ax, band, f"Prony series, {fit.terms} terms")
    _label_moduli(ax, fit.kind, bool(fit.omega.size))
    named = (("storage", fit.storage_residual), ("loss", fit.loss_residual), ("relaxation", fit.relaxation_residual))
    residuals = ", ".join(f"{name} {100 * size:.2g} %" for name, size in named if np.isfinite(size))
    place = f" at {fit.master.reference - 273.15:.4g} °C" if fit.master is not None else ""
    _title(ax, f"{fit.material.name or 'Prony series'}{place}", f"rms relative residuals: {residuals}")
    return ax


def draw_shifts(master: "MasterCurve", ax: Any = None) -> Any:
    """Horizontal shift factors with 95 % intervals and the laws through them; vertical ones below, where there are."""
    lower = None
    if ax is None and master.log10_b_std.max() < _NO_VERTICAL:
        ax = _axes()
    elif ax is None:
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.6, 5.4))
        figure.subplots_adjust(left=0.15, right=0.97, bottom=0.1, top=0.9, hspace=0.08)
        ax, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    celsius = master.temperature - 273.15
    ax.errorbar(celsius, master.log10_a, 1.96 * master.log10_a_std, fmt="none", ecolor=_FAINT, capsize=3, zorder=2)
    for poor, face, label in ((False, _BLUE, "shifted, 95 % interval"), (True, "white", "not told apart from b_T")):
        at = master.ambiguous == poor
        if at.any():
            ax.plot(celsius[at], master.log10_a[at], "o", color=_BLUE, markerfacecolor=face, markersize=5, label=label)
    fine = np.linspace(celsius.min(), celsius.max(), 200)
    for name, style in (("WLF", "-"), ("Arrhenius", ":")):
        if name in master.laws:
            fit = master.laws[name]
            label = f"{name}, rms {fit.rms:.2g} decades"
            ax.plot(fine, np.asarray(fit.law._log10_a(fine + 273.15)), style, color=_RED, label=label, zorder=1)
    ax.axvline(master.reference - 273.15, color="#cccccc", linewidth=0.8, zorder=0)
    ax.set_ylabel("log10 a_T [-]")
    ax.legend(frameon=False, fontsize=8.5)
    if lower is not None:
        lower.errorbar(celsius, master.log10_b, 1.96 * master.log10_b_std, fmt="o", color=_BLUE, ecolor=_FAINT,
                       capsize=3, markersize=4)  # fmt: skip
        lower.axhline(0.0, color="#cccccc", linewidth=0.8, zorder=0)
        lower.set_ylabel("log10 b_T [-]")
        ax.figure.align_ylabels()
    (ax if lower is None else lower).set_xlabel("Temperature [°C]")
    for each in (ax, lower):
        _plain(each)
    _title(ax, f"Shift factors about {master.reference - 273.15:.4g} °C", master.source)
    return ax


def draw_cole_cole(fit: "PronyFit", ax: Any = None) -> Any:
    """Loss against storage modulus: shifts of frequency drop out, what remains off the line is misfit."""
    ax = _axes() if ax is None else ax
    master = fit.master
    storage, loss = (fit.storage, fit.loss) if master is None else (master.storage, master.loss)
    lifted = master is not None and bool(np.abs(master.log10_b).max() > 1e-3)
    colours = _BLUE if master is None else _colours(master, master.isotherm)
    line = fit.moduli_at(np.geomspace(fit.window[0], fit.window[1], 400))
    _logarithmic(ax)
    _widen(ax, np.concatenate([storage, line[0]]), np.concatenate([loss, line[1]]))
    ax.scatter(storage, loss, c=colours, s=14, zorder=3)
    ax.plot(*line, color=_INK, linewidth=1.2, zorder=4)
    letter = "G" if fit.kind == "shear" else "E"
    ax.set(xlabel=f"Storage modulus {letter}' [Pa]", ylabel=f"Loss modulus {letter}'' [Pa]")
    _plain(ax)
    _legend(ax, master)
    _title(ax, "Cole-Cole", "line: Prony series" + ("; vertical shifts applied" if lifted else ""))
    return ax


def draw_van_gurp_palmen(master: "MasterCurve", ax: Any = None) -> Any:
    """Phase angle against modulus as measured, unshifted: one curve means thermorheologically simple."""
    ax = _axes() if ax is None else ax
    modulus = np.hypot(master.dma.storage, master.dma.loss)
    angle = np.degrees(np.arctan2(master.dma.loss, master.dma.storage))
    ax.set(xscale="log")
    _widen(ax, modulus)
    ax.scatter(modulus, angle, c=_colours(master, master.isotherm), s=14, zorder=3)
    letter = "G" if master.kind == "shear" else "E"
    ax.set(xlabel=f"Modulus |{letter}*| [Pa]", ylabel="Phase angle [°]")
    _plain(ax)
    _legend(ax, master)
    _title(ax, "Van Gurp-Palmen", "as measured, no shift of any kind")
    return ax


def draw_friction_master(master: "FrictionMaster", ax: Any = None) -> Any:
    """Measured friction over reduced velocity, one colour per temperature, with the smooth curve and its band."""
    ax = _axes() if ax is None else ax
    levels = master.temperature
    colours = _scale(levels.size)
    for i, kelvin in enumerate(levels):
        at = master.number == i
        ax.semilogx(
            master.velocity[at],
            master.mu[at],
            "o",
            color=colours[i],
            markersize=4,
            label=_celsius(float(kelvin)),
        )
    v = np.geomspace(master.velocity.min(), master.velocity.max(), 300)
    value, low, high = master.curve(v)
    (line,) = ax.semilogx(v, value, color=_INK, linewidth=1.2)
    ax.fill_between(v, low, high, color=_FAINT, alpha=0.25, linewidth=0)
    ax.set(xlabel="Reduced velocity v a_T [m/s]", ylabel="Friction coefficient [-]")
    _plain(ax)
    beside = ax.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    ax.legend([line], ["smooth curve, 95 % band"], frameon=False, fontsize=8, loc="best")
    ax.add_artist(beside)
    _title(ax, f"Measured friction shifted to {master.reference - 273.15:.4g} °C", "")
    return ax


def _data(ax: Any, master: "MasterCurve") -> None:
    if master.frequency.size:
        colours = _colours(master, master.isotherm)
        ax.scatter(master.frequency, master.storage, c=colours, s=14, marker="o", zorder=3)
        ax.scatter(master.frequency, master.loss, s=14, marker="s", facecolors="none", edgecolors=colours, zorder=3)
        ax.plot([], [], "o", color=_FAINT, markersize=4, label="storage modulus")
        ax.plot([], [], "s", color=_FAINT, markersize=4, markerfacecolor="none", label="loss modulus")
    else:
        ax.scatter(master.time, master.relaxation, c=_colours(master, master.time_isotherm), s=14, zorder=3)
        ax.plot([], [], "o", color=_FAINT, markersize=4, label="relaxation modulus")
    _legend(ax, master)


def _band(ax: Any, band: Any, label: str) -> None:
    ax.plot(band.omega, band.storage, color=_INK, linewidth=1.2, label=label, zorder=4)
    ax.plot(band.omega, band.loss, color=_INK, linewidth=1.2, zorder=4)
    for low, high in ((band.storage_low, band.storage_high), (band.loss_low, band.loss_high)):
        once = "95 % interval" if low is band.loss_low else None
        ax.fill_between(band.omega, low, high, color=_BAND, alpha=0.35, linewidth=0, zorder=1, label=once)


def _relaxation_band(ax: Any, band: Any, label: str) -> None:
    ax.plot(band.time, band.relaxation, color=_INK, linewidth=1.2, label=label, zorder=4)
    limits = band.relaxation_low, band.relaxation_high
    ax.fill_between(band.time, *limits, color=_BAND, alpha=0.35, linewidth=0, zorder=1, label="95 % interval")


def _label_moduli(ax: Any, kind: str, dynamic: bool) -> None:
    letter = "G" if kind == "shear" else "E"
    if dynamic:
        ax.set(xlabel="Reduced angular frequency ω a_T [rad/s]", ylabel=f"Moduli {letter}', {letter}'' [Pa]")
    else:
        ax.set(xlabel="Reduced time t/a_T [s]", ylabel=f"Relaxation modulus {letter} [Pa]")
    _plain(ax)
    handles, labels = ax.get_legend_handles_labels()
    if labels:
        first = ax.get_legend()
        ax.legend(handles, labels, frameon=False, fontsize=8, loc="best")
        if first is not None:
            ax.add_artist(first)


def _legend(ax: Any, master: "MasterCurve | None") -> None:
    """Temperatures beside the axes, at most ten of them."""
    if master is None:
        return
    count = master.temperature.size
    shown = np.unique(np.linspace(0, count - 1, min(count, 10)).round().astype(int))
    colours = _scale(count)
    handles = [ax.plot([], [], "o", color=colours[i], markersize=4)[0] for i in shown]
    labels = [_celsius(float(master.temperature[i])) for i in shown]
    ax.legend(handles, labels, frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _celsius(kelvin: float) -> str:
    return f"{round(kelvin - 273.15, 1) + 0.0:g} °C"  # without the sign of -0


def _colours(master: "MasterCurve", number: np.ndarray) -> np.ndarray:
    return _scale(master.temperature.size)[number]


def _scale(count: int) -> np.ndarray:
    import matplotlib

    return np.asarray(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, max(count, 2))))[:count]


def _axes() -> Any:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.4, 4.6))  # with fixed margins: looking for the best ones takes longer than the fit
    figure.subplots_adjust(left=0.13, right=0.84, bottom=0.12, top=0.88)
    return figure.add_subplot()


def _logarithmic(ax: Any) -> None:
    """Makes both axes logarithmic before anything is drawn: changed later, limits are those of the data so far."""
    ax.set(xscale="log", yscale="log")


def _widen(ax: Any, *coordinates: np.ndarray) -> None:
    """Limits for x (and y) that are one value but for rounding, of which matplotlib makes no logarithmic axis."""
    for values, limit in zip(coordinates, (ax.set_xlim, ax.set_ylim), strict=False):
        if values.max() < 1.001 * values.min():
            limit(0.5 * values.min(), 2.0 * values.max())


def _plain(ax: Any) -> None:
    if ax is not None:
        ax.grid(True, which="major", color="#dddddd", linewidth=0.6)
        ax.set_axisbelow(True)
        ax.spines[["top", "right"]].set_visible(False)


def _title(ax: Any, title: str, small: str) -> None:
    ax.set_title(title, loc="left", fontsize=11, fontweight="bold", color=_INK, pad=18 if small else 8)
    short = small if len(small) <= 90 else f"{small[:87]}..."
    ax.annotate(short, (0, 1), (0, 5), xycoords="axes fraction", textcoords="offset points", fontsize=8, color=_FAINT)


def _png(ax: Any) -> bytes:
    buffer = io.BytesIO()
    ax.figure.savefig(buffer, format="png", dpi=_DPI)
    return buffer.getvalue()
