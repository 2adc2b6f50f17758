"""Whether a drive damps its swings: what `em.stability` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .axes import Axis, in_words
from .table import AbstractResult, Column


class Stability(AbstractResult):
    """Damping of a drive about steady sliding, for each velocity; the last axis is that of the velocities.

    Where `follows` is False the ratio decides nothing. A velocity at which the force is not known, or beside one, is
    NaN with `converged=False`.
    """

    velocity: Float[Array, "..."]  # V [m/s]
    force: Float[Array, "..."]  # F(V), as given [N]
    slope: Float[Array, "..."]  # F'(V) [N s/m]
    ratio: Float[Array, "..."]  # zeta; below zero swings grow
    follows: Bool[Array, "..."]  # whether friction follows the speed at once, V > lambda sqrt(k/m): else ask em.drive
    error: Float[
        Array, "..."
    ]  # estimated error of zeta by the differences; NaN for fewer than five velocities together
    converged: Bool[Array, "..."]
    slowest: Float[Array, ""]  # lambda sqrt(k/m), from which on friction follows [m/s]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Stability of a drive"

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("force", "friction force", "N"),
            Column("slope", "slope of the friction force", "N s/m"),
            Column("ratio", "damping ratio", "-"),
            Column("follows", "friction follows the speed at once", ""),
            Column("error", "estimated error of the damping ratio", "-"),
            Column("converged", "converged", ""),
        )

    def axes(self) -> list[Axis]:
        """The axes of the fields by name, with their values; a force that is the same at all velocities names one."""
        return [axis._replace(name="friction_force") if axis.name == "load" else axis for axis in super().axes()]

    def plot(self, ax: Any = None, title: str | None = None, label: str | None = None) -> Any:
        """Draws the damping ratio against velocity, dotted where it decides nothing, the unstable range shaded.

        Returns matplotlib Axes; with `ax=None` on a new figure, which is the `.figure` of the answer. On axes that
        hold a curve already this one is added, under `label`.
        """
        from .stability_figure import draw_stability

        return draw_stability(self, ax, title, label)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, from which velocity on the ratio decides, the least ratio there, and where swings grow."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        yield "decides", f"above {in_words('velocity', float(self.slowest))}; slower than that ask em.drive"
        fields = {column.key: value for column, value in self.fields().items()}
        for curve in self.curves()[1][:_SHOWN]:
            velocity, ratio, counts = (fields[key][curve.at] for key in ("velocity", "ratio", "follows"))
            counts = counts & np.isfinite(ratio)
            yield "at " + curve.label if curve.label else "result", _said(velocity, ratio, counts, float(self.slowest))
        holes, alone = np.isnan(fields["force"]), fields["converged"] & np.isnan(fields["error"])
        if holes.any():
            text = f"{holes.sum()} of {holes.size} forces; the ratio there and beside them is left out"
            yield "not known", text + (f", and its error at {alone.sum()} others" if alone.any() else "")
        yield "points", self.reached("error of the damping ratio")


_SHOWN = 6  # curves that a summary lists one by one
_ALIKE = 1e-9  # relative, of two velocities


def unstable(velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, limit: float) -> list[tuple[float, float]]:
    """Ranges of velocity in which swings grow, from where the ratio crosses zero, linear in ln V in between.

    One that begins below `limit`, from which on the ratio counts, begins there.
    """
    found: list[tuple[float, float]] = []
    at = np.log(velocity)
    for i in np.flatnonzero(counts & (ratio < 0)):
        ends = []
        for j in (i - 1, i + 1):
            known = 0 <= j < ratio.size and np.isfinite(ratio[j])
            if known and ratio[j] >= 0:
                crossing = at[i] + (at[j] - at[i]) * ratio[i] / (ratio[i] - ratio[j])
                ends.append(max(crossing, np.log(limit)))
            else:
                ends.append(np.log(limit) if known and not counts[j] else at[i])
        if found and i > 0 and counts[i - 1] and ratio[i - 1] < 0:
            found[-1] = (found[-1][0], float(np.exp(ends[1])))
        else:
            found.append((float(np.exp(ends[0])), float(np.exp(ends[1]))))
    return found


def _said(velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, limit: float) -> str:
    if not counts.any():
        return "no velocity at which the ratio decides"
    least = np.flatnonzero(counts)[ratio[counts].argmin()]
    place = in_words("velocity", float(velocity[least]))
    text = f"damping ratio at least {significant(float(ratio[least]))}, at {place}: "
    ranges = unstable(velocity, ratio, counts, limit)
    if not ranges:
        return text + "swings die out"
    return text + "swings grow " + " and ".join(_range(low, high, limit) for low, high in ranges)


def _range(low: float, high: float, limit: float) -> str:
    if low <= limit * (1 + _ALIKE):
        return f"from below {significant(limit)} to {significant(high)} m/s"
    return f"at {in_words('velocity', low)}" if low == high else f"at {significant(low)} to {significant(high)} m/s"
