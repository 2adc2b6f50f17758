"""The impact of a body: what `em.impact` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar, NamedTuple

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .table import AbstractResult, Column


class History(NamedTuple):
    """The motion at instants from touch (first) to separation (last); they lie closer where it changes fast.

    Every field has the impact's shape and one more axis, for the instants; the turn is the one in the middle.
    """

    time: Float[Array, "... instants"]  # since touch [s]
    depth: Float[Array, "... instants"]  # d [m]
    velocity: Float[Array, "... instants"]  # d', positive into the rubber [m/s]
    force: Float[Array, "... instants"]  # contact force [N]


class Oblique(NamedTuple):
    """The tangential motion of the point of contact; series at the instants of the history."""

    before: Float[Array, "..."]  # its velocity at touch [m/s]
    after: Float[Array, "..."]  # at separation [m/s]
    slip_loss: Float[Array, "..."]  # turned into heat by slip [J]
    lost: Float[Array, "..."]  # tangential kinetic energy lost, m_t/2 (before^2 - after^2) [J]
    velocity: Float[Array, "... instants"]  # [m/s]
    force: Float[Array, "... instants"]  # against the motion [N]
    error: Float[Array, "..."]  # estimated error of `after` [m/s]
    tangential_mass: Float[Array, "..."]  # m_t [kg]


class Impact(AbstractResult):
    """Impact of a rigid body; every field has one value per point.

    `restitution` is the velocity of separation over that of touch, `error` its estimated, absolute error. `stuck` marks
    a body that never comes back: restitution 0, infinite duration, and a history that ends with the rest. A point that
    did not converge is NaN with `converged=False`.
    """

    mass: Float[Array, "..."]  # m [kg]
    velocity: Float[Array, "..."]  # at touch, v0 [m/s]
    restitution: Float[Array, "..."]
    duration: Float[Array, "..."]  # from touch to separation [s]
    max_depth: Float[Array, "..."]  # at the turn [m]
    max_force: Float[Array, "..."]  # before or at the turn [N]
    lost: Float[Array, "..."]  # normal kinetic energy lost [J]
    history: History
    oblique: Oblique | None  # where a tangential velocity was given
    error: Float[Array, "..."]  # estimated error of the restitution
    stuck: Bool[Array, "..."]
    converged: Bool[Array, "..."]
    temperature: Float[Array, "..."] | None  # T [K]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)
    extrapolated: Bool[Array, "..."] | None = None  # whether the material is used beyond its range; None: not known

    quantity: ClassVar[str] = "Impact"
    coordinates: ClassVar[tuple[str, ...]] = ("velocity", "mass", "before", "temperature")

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("mass", "mass", "kg"),
            Column("velocity", "velocity at touch", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            Column("restitution", "coefficient of restitution", "-"),
            Column("duration", "contact time", "s"),
            Column("max_depth", "largest depth", "m"),
            Column("max_force", "largest force", "N"),
            Column("lost", "normal kinetic energy lost", "J"),
            *(_OBLIQUE if self.oblique is not None else ()),
            Column("error", "estimated error of the restitution", "-"),
            Column("stuck", "stuck", ""),
            Column("converged", "converged", ""),
            Column("extrapolated", "beyond the range of the material", "", optional=True),
        )

    def plot(self, ax: Any = None, title: str | None = None) -> Any:
        """Draws force against time for one impact, or restitution against velocity for many; returns matplotlib Axes.

        With `ax=None` on a new figure, which is the `.figure` of the answer.
        """
        from .motion_figure import draw_impact

        return draw_impact(self, ax, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, the range of what came out, how many points failed, the largest error."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        for name, field, unit in (
            ("restitution", self.restitution, ""),
            ("contact time", self.duration, " s"),
            ("largest depth", self.max_depth, " m"),
            ("largest force", self.max_force, " N"),
        ):
            yield name, _range(np.asarray(field), unit)
        stuck = int(np.sum(self.stuck))
        also = f", {stuck} stuck (restitution 0)" if stuck else ""
        yield "points", self.reached("error of the restitution", also=also)


_OBLIQUE = (
    Column("oblique.before", "tangential velocity at touch", "m/s"),
    Column("oblique.after", "tangential velocity at separation", "m/s"),
    Column("oblique.slip_loss", "lost by slip", "J"),
)


def _range(values: np.ndarray, unit: str) -> str:
    known = values[np.isfinite(values)]
    if not known.size:
        return "none" if not np.isinf(values).any() else "infinite"
    low, high = float(known.min()), float(known.max())
    text = f"{significant(low, 7 if values.size == 1 else 4)}{unit}"
    return text if values.size == 1 or low == high else f"{text} to {significant(high)}{unit}"
