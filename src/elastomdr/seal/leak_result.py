"""What `em.leak` returns."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..results.base import Array, Result, quantity, record, setting
from ..results.words import span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style

_LOG_RATIO = 5.0  # of the largest to the smallest value from which on an axis is


@record
class Leak(Result):
    """Leak of a liquid or a gas through a static seal.

    Within a factor of 1 + `model_error` the rate is that of three dimensions, at 95 %
    of the points. Where `percolates` is false no channel leads through, and the rate is
    zero but for single flaws, permeation and what the model does not know.
    """

    pressure: Array = quantity("contact pressure", "Pa", shown="MPa")
    pressure_drop: Array = quantity("pressure drop of the fluid", "Pa", shown="MPa")
    viscosity: Array = quantity("viscosity", "Pa s")
    time: Array | None = quantity(
        "time since it was pressed", "s", "None: long after", default=None
    )
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    outlet_pressure: Array | None = quantity(
        "absolute pressure behind the seal",
        "Pa",
        "None of a liquid",
        default=None,
        shown="MPa",
    )
    rate: Array = quantity(
        "leak rate", "m^3/s", "Q, volume, of a gas at the outlet", axis="leak rate"
    )
    mass_rate: Array | None = quantity(
        "mass leak rate", "kg/s", "None where no density was given", default=None
    )
    conductance: Array = quantity(
        "flow conductance",
        "m^3/(Pa s)",
        "s, flow per width and pressure gradient",
    )
    mean_gap: Array = quantity("mean gap", "m", "u", shown="µm")
    critical_gap: Array = quantity(
        "critical gap",
        "m",
        "of the narrowest place of the widest channel, NaN where there is none",
        shown="µm",
    )
    area_ratio: Array = quantity("real contact area over nominal area", "-", "A")
    knudsen: Array | None = quantity(
        "Knudsen number",
        "-",
        "Kn, mean free path at the mean pressure over the gap of even planes",
        default=None,
    )
    percolates: Array = quantity(
        "percolates", "", "whether channels lead through the contact"
    )
    error: Array = quantity("estimated relative error of the rate", "-")
    model_error: Array | None = quantity(
        "bound of the model's relative error",
        "-",
        "the rate is within a factor of 1 + this of three dimensions; None for those",
        default=None,
    )
    slip_estimated: bool = setting(default=False)  # of a gas, by one gap for all

    title: ClassVar[str] = "Leak"
    across: ClassVar[str] = "pressure"
    shows: ClassVar[str] = "rate"
    scale: ClassVar[str] = "auto"
    error_of: ClassVar[str] = "the rate, relative"
    from_zero: ClassVar[bool] = False
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "pressure",
        "temperature",
        "pressure_drop",
        "viscosity",
    )

    def plot(
        self,
        ax: Axes | None = None,
        style: Style | None = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: str = "rate",
    ) -> Axes:
        """Draws the rate, or another field, against time or pressure, whichever has more
        values; with the band of the model about a rate.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        self._check_shown(show)
        from ..results.plotting import LIGHT, Ask, Line, Sketch, draw, frame

        def band(sketch: Sketch, line: Line) -> None:
            if show not in ("rate", "mass_rate", "conductance"):
                return
            if self.model_error is None:
                return
            error = sketch.along_line(sketch.fields["model_error"], line)
            factor = 1 + np.where(np.isfinite(error), error, np.nan)
            if not np.isfinite(line.y * factor).any():
                return  # a band of NaN would take its limits from the axes
            ends = line.y / factor, line.y * factor
            look = {"color": line.colour, "alpha": LIGHT, "linewidth": 0}
            sketch.ax.fill_between(line.x, *ends, **look)

        counts = {axis.name: axis.values.size for axis in self.axes()}
        x = "time" if counts.get("time", 0) >= counts.get("pressure", 1) else "pressure"
        ask = Ask(ax, style, title, label)
        drawn = self._draw(draw, ask, x=x, y=show, also=band)
        values = np.asarray(getattr(self, show))
        values = values[np.isfinite(values) & (values > 0)]
        if values.size and values.max() > _LOG_RATIO * values.min():
            drawn.set_yscale("log")
            frame(drawn)
        return drawn

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Ranges of rate, gaps and real contact, how far the rate may be off and at how
        many points channels are closed.
        """
        good: Any = np.asarray(self.converged)
        for name in ("rate", "mass_rate", "mean_gap", "critical_gap", "area_ratio"):
            if (value := getattr(self, name)) is not None:
                q = next(q for q in self.quantities() if q.path == name)
                unit = "" if q.unit == "-" else q.unit
                yield q.label, span(np.asarray(value)[good], unit)
        if self.model_error is not None and np.isfinite(self.model_error).any():
            factor = span(1 + np.asarray(self.model_error))
            yield "model", f"rate within a factor of {factor}"
        if self.knudsen is not None:
            numbers = span(np.asarray(self.knudsen)[good])
            by = "in each gap by itself (to a "
            if self.slip_estimated:
                by = "(an estimate, counted in full in the bound up to a "
            yield (
                "gas",
                f"expands and slips {by}Knudsen number of 0.1), here {numbers}; volumes "
                "are at the outlet",
            )
        closed = int((good & ~np.asarray(self.percolates)).sum())
        if closed:
            yield (
                "closed",
                f"no channel leads through at {closed} of {good.size} points",
            )
