"""The impact of a body: what `em.impact` returns."""

from collections.abc import Iterator
from typing import ClassVar

import numpy as np

from ..results.base import Array, Result, part, quantity, record
from ..results.words import span


@part
class History:
    """The motion at instants from touch (first) to separation (last); they lie closer
    where it changes fast.

    Every field has the impact's shape and one more axis, for the instants; the turn is
    the one in the middle.
    """

    time: Array = quantity("time since touch", "s", dims="... instant", shown="ms")
    depth: Array = quantity("depth", "m", "d", dims="... instant")
    velocity: Array = quantity(
        "velocity", "m/s", "d', positive into the rubber", dims="... instant"
    )
    force: Array = quantity("contact force", "N", dims="... instant")


@part
class Oblique:
    """The tangential motion of the point of contact; series at the instants of the
    history.
    """

    before: Array = quantity("tangential velocity at touch", "m/s")
    after: Array = quantity("tangential velocity at separation", "m/s")
    slip_loss: Array = quantity("lost by slip", "J", "turned into heat by slip")
    lost: Array = quantity(
        "tangential kinetic energy lost", "J", "m_t/2 (before^2 - after^2)"
    )
    velocity: Array = quantity("tangential velocity", "m/s", dims="... instant")
    force: Array = quantity(
        "tangential force", "N", "against the motion", dims="... instant"
    )
    error: Array = quantity(
        "estimated error of the tangential velocity at separation", "m/s"
    )
    tangential_mass: Array = quantity("tangential mass", "kg", "m_t")


@record
class Impact(Result):
    """Impact of a rigid body.

    `restitution` is the velocity of separation over that of touch, `error` its
    estimated, absolute error. `stuck` marks a body that never comes back: restitution
    0, infinite duration, and a history that ends with the rest. A point that did not
    converge is NaN with `converged=False`.
    """

    mass: Array = quantity("mass", "kg", "m")
    velocity: Array = quantity("velocity at touch", "m/s", "v0")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    restitution: Array = quantity(
        "coefficient of restitution", "-", "velocity of separation over that of touch"
    )
    duration: Array = quantity("contact time", "s", "from touch to separation")
    max_depth: Array = quantity("largest depth", "m", "at the turn")
    max_force: Array = quantity("largest force", "N", "before or at the turn")
    lost: Array = quantity("normal kinetic energy lost", "J")
    history: History
    oblique: Oblique | None = None  # where a tangential velocity was given
    error: Array = quantity("estimated error of the restitution", "-", "absolute")
    stuck: Array = quantity("stuck", "", "the body never comes back")

    title: ClassVar[str] = "Impact"
    shows: ClassVar[str] = "restitution"
    scale: ClassVar[str] = "auto"
    error_of: ClassVar[str] = "the restitution"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity",
        "mass",
        "before",
        "temperature",
    )

    def _figure(self) -> str:
        """Force against time for one impact, restitution against velocity for many."""
        return (
            "plot_contacts.draw_impact"
            if np.size(self.velocity) == max(1, len(self.origins))
            else "plotting.draw"
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The range of what came out."""
        for name, field, unit in (
            ("restitution", self.restitution, ""),
            ("contact time", self.duration, "s"),
            ("largest depth", self.max_depth, "m"),
            ("largest force", self.max_force, "N"),
        ):
            yield name, span(field, unit)

    def reached(self, also: str = "") -> str:
        """As of every result, with how many bodies stuck."""
        stuck = int(np.sum(self.stuck))
        return super().reached(
            also + (f", {stuck} stuck (restitution 0)" if stuck else "")
        )
