"""Figure of a belt conveyor."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .._runtime import significant
from .axes import in_words
from .figure import _colours, _frame, _legend_beside, _new_axes, _write_title

if TYPE_CHECKING:
    from .conveyor import Conveyor

_MOST = 12  # lines that one figure shows


def draw_conveyor(result: "Conveyor", ax: Any = None, title: str | None = None) -> Any:
    """Power per kilometre against velocity, one line per temperature and mass of the goods."""
    known = {column.key: np.atleast_1d(value) for column, value in result.fields().items()}
    rows = {key: value.reshape(-1, value.shape[-1]) for key, value in known.items()}
    count = len(rows["power"])
    new = ax is None
    ax = _new_axes(count > 1) if new else ax
    shown = np.unique(np.linspace(0, count - 1, min(count, _MOST)).round().astype(int))
    for i, colour in zip(shown, _colours(len(shown)), strict=True):
        words = [f"{significant(float(rows['goods'][i, 0]))} kg/m of goods"]
        if "temperature" in rows:
            words.insert(0, in_words("temperature", float(rows["temperature"][i, 0])).replace("degC", "°C"))
        order = np.argsort(rows["velocity"][i], kind="stable")
        x, y = rows["velocity"][i][order], rows["power"][i][order]
        ax.plot(x, y, color=colour, marker="o" if x.size == 1 else None, label=", ".join(words))
    ax.set(xlabel="Belt speed [m/s]", ylabel="Power per kilometre of belt [kW]", ylim=(0, None))
    _frame(ax)
    if count > 1:
        _legend_beside(ax)
    if new or title:
        failed = int(np.sum(~known["converged"]))
        note = f"{failed} of {known['converged'].size} points did not converge and are left out" if failed else ""
        _write_title(ax, title or result.quantity, result.model, note)
    return ax
