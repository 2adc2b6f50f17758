"""Tangential loading of a contact with friction: what `em.shear` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .table import AbstractResult, Column


class Shear(AbstractResult):
    """Tangential loading with stick and slip, at the instants of the history; an instant that failed is NaN."""

    time: Float[Array, " times"]  # [s]
    displacement: Float[Array, " times"]  # tangential displacement of the body [m]
    force: Float[Array, " times"]  # tangential force on the body's side that moves it [N]
    normal_force: Float[Array, " times"]  # [N]
    depth: Float[Array, " times"]  # [m]
    contact_radius: Float[Array, " times"]  # [m]
    stick_radius: Float[Array, " times"]  # inside, nothing slipped in the last step [m]
    work: Float[Array, " times"]  # done by the tangential force since the start [J]
    slip_loss: Float[Array, " times"]  # of that, turned into heat by slip [J]
    stored: Float[Array, " times"]  # of that, still there as elastic energy; the rest is lost inside the rubber [J]
    error: Float[Array, " times"]  # estimated error of the force [N]
    converged: Bool[Array, " times"]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)
    extrapolated: Bool[Array, " times"] | None = None  # whether the material is used beyond its range; None: not known

    quantity: ClassVar[str] = "Tangential loading with friction"

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("time", "time", "s"),
            Column("displacement", "tangential displacement", "m"),
            Column("force", "tangential force", "N"),
            Column("normal_force", "normal force", "N"),
            Column("depth", "depth", "m"),
            Column("contact_radius", "contact radius", "m"),
            Column("stick_radius", "stick radius", "m"),
            Column("work", "tangential work", "J"),
            Column("slip_loss", "lost by slip", "J"),
            Column("stored", "stored tangentially", "J"),
            Column("error", "estimated error of the tangential force", "N"),
            Column("converged", "converged", ""),
            Column("extrapolated", "beyond the range of the material", "", optional=True),
        )

    def plot(self, ax: Any = None, title: str | None = None) -> Any:
        """Draws the tangential force against displacement and returns matplotlib Axes (on a new figure: `.figure`)."""
        from .motion_figure import draw_shear

        return draw_shear(self, ax, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, the largest force, what was lost, how many instants failed."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        good = np.asarray(self.converged)
        if good.any():
            force = np.abs(np.asarray(self.force)[good])
            largest = int(force.argmax())
            when = np.asarray(self.time)[good][largest]
            yield "largest force", f"{significant(float(force[largest]))} N at {significant(float(when))} s"
            work, slip, stored = (float(np.asarray(x)[good][-1]) for x in (self.work, self.slip_loss, self.stored))
            yield "work", f"{significant(work)} J: slip {significant(slip)} J, stored {significant(stored)} J"
        yield "instants", self.reached("error of the force", " N")
