"""Coupled dynamics: what `em.drive` returns."""

import itertools
from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, is_traced, plain, positive, significant
from ..errors import InputError
from .table import AbstractResult, Column

_LATE = 0.8  # part of the time from which on a summary looks at the velocity


class Drive(AbstractResult):
    """A body driven over rubber through springs and dampers, at the instants asked for; per metre for a rough line.

    `given` is the work of drive and load since the body was put down. It is in motion, springs and rubber (`kinetic`,
    `stored`) or `dissipated`, but for `imbalance`, the error of the time integration, held against rtol as well.
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
    extrapolated: Bool[Array, " n"] | None = None  # whether the material is used beyond its range; None: not known

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
            Column("extrapolated", "beyond the range of the material", "", optional=True),
        )

    def swing(self, period: float) -> Float[Array, " periods"]:
        """(max X' - min X')/|mean D'| in each whole `period` [s] since the start: 0 when the body follows the drive.

        It dies out where the drive damps; a body that sticks and slips swings on, by more than 1 as a rule. Take the
        period of the mass on its spring, 2 pi sqrt(m/k), and instants enough to see it. NaN in a period with an
        instant that did not converge, or in which the drive stands. Works under `jax.vmap` over what is driven. Raises
        `InputError`.
        """
        length, time = plain("period", period), np.asarray(self.time)
        positive("period", length)
        number = np.ceil((time - time[0]) / length * (1 - 1e-12)).astype(int)  # 1 for the first, its end included
        count = int((time[-1] - time[0]) / length * (1 + 1e-12))
        if not 1 <= count < time.size or np.bincount(number, minlength=count + 1)[1 : count + 1].min() < 2:
            raise InputError(
                f"period must leave two instants or more in each, and be no longer than the motion, got {length:g} s."
            )
        ends = [np.flatnonzero(number <= j)[-1] for j in range(count + 1)]
        found = []
        for first, last in itertools.pairwise(ends):
            speed = (self.drive[last] - self.drive[first]) / (time[last] - time[first])
            part = self.velocity[first + 1 : last + 1]
            xp = jnp if is_traced(speed) else np
            found.append((part.max() - part.min()) / xp.where(speed == 0, xp.nan, abs(speed)))
        return jnp.stack(found) if is_traced(found) else np.array(found)

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
        late = np.flatnonzero(self.converged & (self.time >= self.time[0] + _LATE * (self.time[-1] - self.time[0])))
        if late.size > 1 and (speed := np.ptp(self.drive[late[[0, -1]]]) / np.ptp(self.time[late[[0, -1]]])):
            low, high = (
                significant(float(x) / speed, 3) for x in (self.velocity[late].min(), self.velocity[late].max())
            )
            yield "velocity", f"{low} to {high} times the drive's in the last fifth of the time"
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
