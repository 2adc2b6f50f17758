"""Figure of the loss by relaxation time."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .._runtime import significant
from .axes import in_words
from .figure import _colours, _frame, _legend_beside, _new_axes, _write_title

if TYPE_CHECKING:
    from .dissipation import Dissipation

_MOST = 8  # points that one figure shows


def draw_dissipation(result: "Dissipation", ax: Any = None, title: str | None = None) -> Any:
    """Shares against relaxation time, one line per point."""
    known = {column.key: np.asarray(value) for column, value in result.fields().items()}
    rows = {key: value.reshape(-1, value.shape[-1]) for key, value in known.items()}
    count = len(rows["share"])
    new = ax is None
    ax = _new_axes(True) if new else ax
    shown = np.unique(np.linspace(0, count - 1, min(count, _MOST)).round().astype(int))
    for i, colour in zip(shown, _colours(len(shown)), strict=True):
        if not rows["converged"][i].all():
            continue
        time, share = rows["time"][i], rows["share"][i]
        words = [in_words("velocity", float(rows["velocity"][i, 0]))]
        if "temperature" in rows:
            words.append(in_words("temperature", float(rows["temperature"][i, 0])).replace("degC", "°C"))
        if time[0] == 0:
            words.append(f"dashpot {significant(100 * float(share[0]), 2)} %")
        at = time > 0
        ax.plot(time[at], 100 * share[at], "o-", color=colour, linewidth=1.4, markersize=4.5, label=", ".join(words))
    ax.set(xscale="log", xlabel="Relaxation time [s]", ylabel="Share of the dissipation [%]", ylim=(0, None))
    _frame(ax)
    _legend_beside(ax)
    if new or title:
        failed = int(np.sum(~rows["converged"][:, 0]))
        note = f"{failed} of {count} points did not converge and are left out" if failed else ""
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Where the loss happens, {material}", result.model, note)
    return ax
