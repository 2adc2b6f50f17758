"""What a belt conveyor spends on the indentation of its covers: what `em.conveyor` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .axes import in_words
from .table import AbstractResult, Column


class Conveyor(AbstractResult):
    """Resistance and power per length of belt; every field has one value per point.

    `power` in W/m is also that in kW per kilometre. A point of which one roll failed is NaN with `converged=False`.
    """

    velocity: Float[Array, "..."]  # v [m/s]
    belt: Float[Array, "..."]  # mass of the belt per length [kg/m]
    goods: Float[Array, "..."]  # mass of the goods per length [kg/m]
    temperature: Float[Array, "..."] | None  # T [K]
    carry: Float[Array, "..."]  # resistance of the carry side per length of belt [N/m]
    back: Float[Array, "..."]  # resistance of the return side per length of belt [N/m]
    resistance: Float[Array, "..."]  # both together [N/m]
    power: Float[Array, "..."]  # v times that [W/m, or kW/km]
    coefficient: Float[Array, "..."]  # resistance over the weight of goods and of both strands of the belt
    error: Float[Array, "..."]  # estimated error of the coefficient
    converged: Bool[Array, "..."]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Indentation rolling resistance of a belt conveyor"
    coordinates: ClassVar[tuple[str, ...]] = ("velocity", "temperature", "belt", "goods")

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("belt", "mass of the belt", "kg/m"),
            Column("goods", "mass of the goods", "kg/m"),
            Column("temperature", "temperature", "K", optional=True),
            Column("carry", "resistance of the carry side", "N/m"),
            Column("back", "resistance of the return side", "N/m"),
            Column("resistance", "resistance", "N/m"),
            Column("power", "power", "W/m"),
            Column("coefficient", "resistance over weight", "-"),
            Column("error", "estimated error of the coefficient", "-"),
            Column("converged", "converged", ""),
        )

    def plot(self, ax: Any = None, title: str | None = None) -> Any:
        """Draws the power per kilometre against velocity, one line per further index.

        Returns matplotlib Axes; with `ax=None` on a new figure, which is the `.figure` of the answer.
        """
        from .conveyor_figure import draw_conveyor

        return draw_conveyor(self, ax, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, least and largest power per kilometre and where, how many points failed."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        power = np.ravel(self.power)
        if np.isfinite(power).any():
            for i in dict.fromkeys((int(np.nanargmin(power)), int(np.nanargmax(power)))):
                place = f"{in_words('velocity', float(np.ravel(self.velocity)[i]))}, "
                place += f"{significant(float(np.ravel(self.goods)[i]))} kg/m of goods"
                if self.temperature is not None:
                    place += f", {in_words('temperature', float(np.ravel(self.temperature)[i]))}"
                share = significant(100 * float(np.ravel(self.carry)[i] / np.ravel(self.resistance)[i]), 3)
                over = significant(float(np.ravel(self.coefficient)[i]))
                text = (
                    f"{significant(float(power[i]))} kW per km of belt, {share} % of it on the carry side; resistance"
                )
                yield f"at {place}", f"{text} over weight {over}"
        yield "points", self.reached("error of the coefficient")
