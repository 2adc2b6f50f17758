"""Figure of a body that warms up."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .._runtime import significant
from .axes import in_words
from .figure import _colours, _frame, _legend_beside, _new_axes, _write_title

if TYPE_CHECKING:
    from .warming import Warming

_MOST = 12  # lines that one figure shows


def draw_warming(result: "Warming", ax: Any = None, title: str | None = None) -> Any:
    """Temperature against time, or the steady one against velocity."""
    known = {column.key: np.atleast_1d(value) for column, value in result.fields().items()}
    rows = {key: value.reshape(-1, value.shape[-1]) for key, value in known.items()}
    count, along = len(rows["temperature"]), "time" if "time" in rows else "velocity"
    new = ax is None
    ax = _new_axes(count > 1) if new else ax
    shown = np.unique(np.linspace(0, count - 1, min(count, _MOST)).round().astype(int))
    for i, colour in zip(shown, _colours(len(shown)), strict=True):
        if along == "time" and not rows["converged"][i].all():
            continue
        words = [f"{significant(float(rows['load'][i, 0]))} N"]
        if along == "time":
            words.insert(0, in_words("velocity", float(rows["velocity"][i, 0])))
        words.append(in_words("temperature", float(rows["ambient"][i, 0])).replace("degC", "°C"))
        celsius, order = rows["temperature"][i] - 273.15, np.argsort(rows[along][i], kind="stable")
        marker = "o" if celsius.size == 1 else None
        ax.plot(rows[along][i][order], celsius[order], color=colour, marker=marker, label=", ".join(words))
        if along == "time":
            ax.axhline(rows["steady"][i, 0] - 273.15, color=colour, linewidth=0.9, linestyle=":")
    ax.set(xlabel="Time [s]" if along == "time" else "Rolling velocity [m/s]", ylabel="Temperature [°C]")
    _frame(ax)
    if count > 1:
        _legend_beside(ax)
    if new or title:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} points did not converge and are left out" if failed else ""
        note = "; ".join(x for x in (note, "dotted: steady" if along == "time" else "") if x)
        material = dict(result.inputs).get("material")
        _write_title(ax, title or f"Warming by rolling resistance, {material}", result.model, note)
    return ax
