"""Coupled dynamics: what `em.drive` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from ..errors import InputError
from .table import AbstractResult, Column


class Drive(AbstractResult):
    """A body driven over rubber through springs and dampers, at the instants asked for; per metre for a rough line.

    `given` is the work of drive and load since the body was put down. It is in motion, springs and rubber (`kinetic`,
    `stored`) or `dissipated`, but for `imbalance`, the error of the time integration.
    """

    time: Float[Array, " n"]  # [s]
    drive: Float[Array, " n"]  # place of the drive D [m]
    position: Float[Array, " n"]  # place of the body X [m]
    velocity: Float[Array, " n"]  # X' [m/s]
    depth: Float[Array, " n"]  # d [m]
    mu: Float[Array, " n"]  # F_x/F_N
    normal_force: Float[Array, " n"]  # F_N [N, or N/m]
    friction_force: Float[Array, " n"]  # F_x [N, or N/m]
    pull: Float[Array, " n"]  # of the tangential spring; F_x where the drive is rigid [N, or N/m]
    given: Float[Array, " n"]  # [J, or J/m]
    kinetic: Float[Array, " n"]  # [J, or J/m]
    stored: Float[Array, " n"]  # in rubber and springs [J, or J/m]
    dissipated: Float[Array, " n"]  # in rubber and dampers [J, or J/m]
    imbalance: Float[Array, " n"]  # [J, or J/m]
    error: Float[Array, " n"]  # estimated error of mu
    converged: Bool[Array, " n"]
    per_length: bool = eqx.field(static=True)  # forces and energies are per metre of line
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Driven motion"

    @property
    def table(self) -> tuple[Column, ...]:
        force, joule = ("N/m", "J/m") if self.per_length else ("N", "J")
        return (
            Column("time", "time", "s"),
            Column("drive", "place of the drive", "m"),
            Column("position", "place of the body", "m"),
            Column("velocity", "velocity", "m/s"),
            Column("depth", "depth", "m"),
            Column("mu", "friction coefficient", "-"),
            Column("normal_force", "normal force", force),
            Column("friction_force", "friction force", force),
            Column("pull", "pull of the drive", force),
            Column("given", "work of drive and load", joule),
            Column("kinetic", "kinetic energy", joule),
            Column("stored", "stored energy", joule),
            Column("dissipated", "dissipated energy", joule),
            Column("imbalance", "missing in the energy balance", joule),
            Column("error", "estimated error of the coefficient", "-"),
            Column("converged", "converged", ""),
        )

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, ranges of friction and normal force, the energy balance, how many points failed."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        yield "computed", str(self.plan)
        good = np.flatnonzero(self.converged)
        if good.size:
            unit = "N/m" if self.per_length else "N"
            for name, key in (("friction", "friction_force"), ("normal force", "normal_force")):
                values = getattr(self, key)[good]
                yield name, f"{significant(values.min())} to {significant(values.max())} {unit}"
            last, joule = good[-1], "J/m" if self.per_length else "J"
            names = ("given", "kinetic", "stored", "dissipated", "imbalance")
            yield "energy", ", ".join(f"{k} {significant(getattr(self, k)[last])} {joule}" for k in names)
        yield "points", self.reached("error of mu")

    def plot(self, ax: Any = None, *, show: str = "pull", title: str | None = None, label: str | None = None) -> Any:
        """Draws one column against time, by default the pull of the drive; returns the matplotlib Axes.

        With `ax=None` on a new figure.
        """
        fields = [column.field for column in self.table[1:-1]]
        if show not in fields:
            raise InputError(f"show must be one of {', '.join(fields)}, got {show!r}.")
        from .history_figure import draw_history

        return draw_history(self, ax, show, title, label)
