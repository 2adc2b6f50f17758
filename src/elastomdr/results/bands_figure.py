"""Figure of friction by frequency."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .figure import _colours, _frame, _legend_beside, _new_axes, _write_title

if TYPE_CHECKING:
    from .bands import FrictionBands

_MOST = 12  # lines that one figure shows
_SEEN = 0.01  # part of the highest band from which one is worth room on the axis


def draw_bands(
    result: "FrictionBands", ax: Any = None, title: str | None = None, label: str | None = None, colour: Any = None
) -> Any:
    """Part of mu per decade of frequency as steps, so that the area under a line is its friction coefficient."""
    frequency, mu = np.asarray(result.frequency), np.asarray(result.mu)
    points = list(np.ndindex(mu.shape[:-1]))
    points = [
        points[i] for i in np.unique(np.linspace(0, len(points) - 1, min(len(points), _MOST)).round().astype(int))
    ]
    new = ax is None
    ax = _new_axes(len(points) > 1) if new else ax
    beside_others = ax.has_data()
    name = label or (dict(result.inputs).get("material") if beside_others else None)
    half = np.sqrt(result.width)
    seen = frequency[mu > _SEEN * np.nanmax(mu, initial=0.0)]
    for at, usual in zip(points, _colours(len(points)), strict=True):
        edges = np.append(frequency[at] / half, frequency[at][-1] * half)
        words = ", ".join(part for part in (name, result.named(at)) if part).replace("degC", "°C")
        own = colour if len(points) == 1 else usual  # None: the next one of the axes' own
        ax.stairs(mu[at] / np.log10(result.width), edges, color=own, linewidth=1.8, label=words or None)
    ax.set_xscale("log")
    ax.set(xlabel="Frequency of excitation [rad/s]", ylabel="Friction coefficient per decade [-]")
    ax.set_ylim(0.0, None)
    if seen.size:
        before = ax.get_xlim() if beside_others else (np.inf, 0.0)
        ax.set_xlim(min(before[0], seen.min() / half), max(before[1], seen.max() * half))
    _frame(ax)
    if len(points) > 1 or name:
        _legend_beside(ax)
    if title or not beside_others:
        failed = int(np.sum(~np.asarray(result.converged)[..., 0]))
        note = f"{failed} of {len(list(np.ndindex(mu.shape[:-1])))} points did not converge and are left out"
        _write_title(ax, title or result.heading(), result.model, note if failed else "")
    return ax
