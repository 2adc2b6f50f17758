"""Where in the spectrum the loss happens: what `em.dissipation` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .table import AbstractResult, Column


class Dissipation(AbstractResult):
    """Loss of each branch; the last axis of every field runs over the branches of the relaxation spectrum.

    A point that failed is NaN, with `converged=False`. `temperature` is None where none was given.
    """

    velocity: Float[Array, "..."]  # v [m/s]
    temperature: Float[Array, "..."] | None  # T [K]
    time: Float[Array, "..."]  # relaxation time tau_k at the temperature, 0 for a parallel dashpot [s]
    share: Float[Array, "..."]  # F_k/F_x
    resistance: Float[Array, "..."]  # F_k, the branch's part of friction or resistance [N]
    power: Float[Array, "..."]  # F_k v, turned into heat [W]
    normal_force: Float[Array, "..."]  # F_N [N]
    error: Float[Array, "..."]  # share of the work that the branches together do not account for
    converged: Bool[Array, "..."]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Dissipation by relaxation time"

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            Column("time", "relaxation time", "s"),
            Column("share", "share of the dissipation", "-"),
            Column("resistance", "part of the resistance", "N"),
            Column("power", "power", "W"),
            Column("normal_force", "normal force", "N"),
            Column("error", "share not accounted for", "-"),
            Column("converged", "converged", ""),
        )

    def plot(self, ax: Any = None, title: str | None = None) -> Any:
        """Draws the shares against relaxation time, one line per point; a parallel dashpot goes into the legend.

        Returns matplotlib Axes; with `ax=None` on a new figure, which is the `.figure` of the answer.
        """
        from .dissipation_figure import draw_dissipation

        return draw_dissipation(self, ax, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, the branch that dissipates most and where half of the loss lies, how many points failed."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        time, share = (np.asarray(x).reshape(-1, x.shape[-1]) for x in (self.time, self.share))
        velocity = np.asarray(self.velocity).reshape(share.shape)
        for i in {0: None, len(share) - 1: None}:
            if np.isfinite(share[i]).all():
                most = int(share[i].argmax())
                text = (
                    f"{significant(100 * float(share[i, most]), 3)} % at tau = {significant(float(time[i, most]), 3)} s"
                )
                yield f"at {significant(float(velocity[i, 0]), 3)} m/s", f"most, {text}"
        yield "points", self.reached("share not accounted for")
