"""Transient sliding: what `em.slide` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from ..errors import InputError
from .table import AbstractResult, Column


class Slide(AbstractResult):
    """A body that moves over a viscoelastic foundation, at the instants asked for; forces per metre for a rough line.

    `friction_force` is the force on the body against +x, positive where it resists a motion towards +x, and `mu` its
    ratio to the normal force (NaN without contact). `dissipated` is `work` less `stored`, all since the start. A point
    that did not converge is NaN with `converged=False`.
    """

    time: Float[Array, " n"]  # [s]
    position: Float[Array, " n"]  # X [m]
    velocity: Float[Array, " n"]  # dX/dt over the interval that ends here [m/s]
    mu: Float[Array, " n"]  # F_x/F_N
    normal_force: Float[Array, " n"]  # F_N [N, or N/m]
    friction_force: Float[Array, " n"]  # F_x [N, or N/m]
    depth: Float[Array, " n"]  # d [m]
    work: Float[Array, " n"]  # of normal and friction force on the rubber [J, or J/m]
    stored: Float[Array, " n"]  # elastic energy in the rubber [J, or J/m]
    dissipated: Float[Array, " n"]  # [J, or J/m]
    error: Float[Array, " n"]  # estimated error of mu
    converged: Bool[Array, " n"]
    per_length: bool = eqx.field(static=True)  # forces and energies are per metre of line
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)
    extrapolated: Bool[Array, " n"] | None = None  # whether the material is used beyond its range; None: not known

    quantity: ClassVar[str] = "Transient sliding"

    @property
    def table(self) -> tuple[Column, ...]:
        force, joule = ("N/m", "J/m") if self.per_length else ("N", "J")
        return (
            Column("time", "time", "s"),
            Column("position", "position", "m"),
            Column("velocity", "velocity", "m/s"),
            Column("mu", "friction coefficient", "-"),
            Column("normal_force", "normal force", force),
            Column("friction_force", "friction force", force),
            Column("depth", "depth", "m"),
            Column("work", "work", joule),
            Column("stored", "stored energy", joule),
            Column("dissipated", "dissipated energy", joule),
            Column("error", "estimated error of the coefficient", "-"),
            Column("converged", "converged", ""),
            Column("extrapolated", "beyond the range of the material", "", optional=True),
        )

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, largest and last friction coefficient, energies, how many points failed, the largest error."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        yield "computed", str(self.plan)
        known = np.flatnonzero(np.isfinite(self.mu))
        if known.size:
            top, last = known[np.abs(self.mu[known]).argmax()], known[-1]
            values = (self.mu[top], self.time[top], self.mu[last], self.time[last])
            most, when, end, then = (significant(float(value)) for value in values)
            yield "result", f"largest mu = {most} at {when} s, last {end} at {then} s"
            unit = "J/m" if self.per_length else "J"
            done = ", ".join(f"{k} {significant(getattr(self, k)[last])} {unit}" for k in ("work", "dissipated"))
            yield "energy", f"{done}, stored {significant(float(self.stored[last]))} {unit}"
        yield "points", self.reached("error of mu")

    def png(self, title: str | None = None) -> bytes:
        """The figure as a PNG image, 200 dots per inch."""
        from .history_figure import png

        return png(self, title)

    def plot(self, ax: Any = None, *, against: str = "time", title: str | None = None, label: str | None = None) -> Any:
        """Draws mu against "time" or "position" and returns the matplotlib Axes; with `ax=None` on a new figure."""
        if against not in ("time", "position"):
            raise InputError(f"against must be 'time' or 'position', got {against!r}.")
        from .history_figure import draw_slide

        return draw_slide(self, ax, against, title, label)
