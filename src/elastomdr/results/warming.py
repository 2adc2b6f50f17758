"""How warm a rolling body gets: what `em.warming` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .axes import in_words
from .table import AbstractResult, Column


class Warming(AbstractResult):
    """Temperature of a rolling body heated by its own resistance; NaN with `converged=False` where there is none.

    Without a time `temperature`, `power` and `coefficient` are those of the steady state. With one, the last axis of
    every field is time. `settling` is the time constant with which the body approaches its steady temperature,
    C/(H - dP/dT); None where no heat capacity was given.
    """

    time: Float[Array, "..."] | None  # since the start at the ambient temperature [s]
    velocity: Float[Array, "..."]  # v [m/s]
    load: Float[Array, "..."]  # F_N [N]
    ambient: Float[Array, "..."]  # temperature of the surroundings T_a [K]
    conductance: Float[Array, "..."]  # H, from the body to its surroundings [W/K]
    capacity: Float[Array, "..."] | None  # C [J/K]
    temperature: Float[Array, "..."]  # T [K]
    steady: Float[Array, "..."]  # T of the steady state [K]
    settling: Float[Array, "..."] | None  # time constant near the steady state [s]
    power: Float[Array, "..."]  # dissipated at T [W]
    coefficient: Float[Array, "..."]  # rolling resistance coefficient at T
    error: Float[Array, "..."]  # estimated error of T [K]
    converged: Bool[Array, "..."]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Warming by rolling resistance"
    coordinates: ClassVar[tuple[str, ...]] = ("time", "velocity", "load", "ambient", "conductance", "capacity")

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("time", "time", "s", optional=True),
            Column("velocity", "velocity", "m/s"),
            Column("load", "normal force", "N"),
            Column("ambient", "ambient temperature", "K"),
            Column("conductance", "conductance", "W/K"),
            Column("capacity", "heat capacity", "J/K", optional=True),
            Column("temperature", "temperature", "K"),
            Column("steady", "steady temperature", "K"),
            Column("settling", "time constant", "s", optional=True),
            Column("power", "dissipated power", "W"),
            Column("coefficient", "rolling resistance coefficient", "-"),
            Column("error", "estimated error of the temperature", "K"),
            Column("converged", "converged", ""),
        )

    def plot(self, ax: Any = None, title: str | None = None) -> Any:
        """Draws temperature against time, or the steady temperature against velocity, one line per further index.

        Returns matplotlib Axes; with `ax=None` on a new figure, which is the `.figure` of the answer.
        """
        from .warming_figure import draw_warming

        return draw_warming(self, ax, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, the coldest and the warmest steady state, how many points failed."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        steady, rise = np.asarray(self.steady), np.asarray(self.steady - self.ambient)
        if np.isfinite(rise).any():
            for i in dict.fromkeys((int(np.nanargmin(rise)), int(np.nanargmax(rise)))):
                place = ", ".join((in_words("velocity", float(np.ravel(self.velocity)[i])), *self._besides(i)))
                kelvin = in_words("temperature", float(steady.ravel()[i]))
                yield f"steady at {place}", f"{kelvin}, {significant(float(rise.ravel()[i]))} K above the surroundings"
        yield "points", self.reached("error of the temperature", " K")

    def _besides(self, i: int) -> Iterator[str]:
        """What sets a point apart from others at its velocity."""
        for axis, at in zip(self.axes(), np.unravel_index(i, np.shape(self.steady)), strict=True):
            if axis.values.size > 1 and axis.name not in ("velocity", "time"):
                yield in_words(axis.name, float(axis.values[at]), axis.unit) if axis.unit else f"no. {at}"
