"""What `em.press` returns: a rough surface pressed into rubber."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import one_of
from ..results.base import Array, Result, quantity, record
from ..results.words import span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style


@record
class RoughContact(Result):
    """A rough surface under a pressure: approach, stiffness and conductance of the
    interface, means over the lines.

    All are of the interface: the mean displacement of the rubber's surface, which
    belongs to its bulk, is left out. `conductance` is that of two bodies of
    conductivities k1 and k2 over 1/(1/k1 + 1/k2), 2 stiffness/E* by Barber's theorem; a
    small vibration of angular frequency omega sees the stiffness E*(omega)
    conductance/2. `conductance_low` is a bound for every elastic surface whose highest
    peak is that of the given one; it is NaN in sliding, for which none is known. The
    real contact area does not follow from lines.
    """

    pressure: Array = quantity("nominal pressure", "Pa", shown="MPa")
    time: Array | None = quantity(
        "time under load", "s", "None: long after, or in sliding", default=None
    )
    velocity: Array | None = quantity("velocity", "m/s", "None: at rest", default=None)
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    approach: Array = quantity(
        "approach",
        "m",
        "of the mean planes since the first touch of the lines",
        shown="µm",
    )
    separation: Array = quantity("mean gap", "m", "between the surfaces", shown="µm")
    stiffness: Array = quantity(
        "contact stiffness", "Pa/m", "increment of pressure over that of the approach"
    )
    conductance: Array = quantity(
        "conductance over conductivity", "1/m", "per nominal area"
    )
    conductance_low: Array = quantity(
        "least conductance over conductivity", "1/m", "bound"
    )
    thermal: Array | None = quantity(
        "thermal conductance", "W/(m^2 K)", "of the contact spots alone", default=None
    )
    electrical: Array | None = quantity(
        "electrical conductance", "S/m^2", "of the contact spots alone", default=None
    )
    error: Array = quantity(
        "estimated relative error of the conductance",
        "-",
        "twice the standard error over lines",
    )
    approach_error: Array = quantity(
        "estimated error of the approach", "m", "twice the standard error over lines"
    )
    model_error: Array = quantity(
        "bound of the model's relative error", "-", "of the conductance, against 3D"
    )

    title: ClassVar[str] = "Rough contact"
    figure: ClassVar[str] = "plot_contacts.draw_rough_contact"
    across: ClassVar[str] = "pressure"
    shows: ClassVar[str] = "conductance"
    error_of: ClassVar[str] = "the conductance, relative"
    relative_bound: ClassVar[bool] = True
    from_zero: ClassVar[bool] = False
    scale: ClassVar[str] = "auto"
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "velocity",
        "temperature",
        "pressure",
    )

    def plot(
        self,
        ax: Axes | None = None,
        style: Style | None = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: str = "conductance",
        against: str | None = None,
    ) -> Axes:
        """Draws one field `against` pressure, time or velocity.

        By default the conductance against what has most values. The rest as of every
        result, `Result.plot`. Raises `InputError`.
        """
        self._check_shown(show)
        known = [
            name
            for name in ("pressure", "time", "velocity")
            if getattr(self, name) is not None
        ]
        if against is None:
            against = max(
                known, key=lambda name: np.unique(np.asarray(getattr(self, name))).size
            )
        one_of("against", against, *known)
        from ..results.plot_contacts import draw_rough_contact
        from ..results.plotting import DrawAsk

        return self._draw(
            partial(draw_rough_contact, x=against, y=show),
            DrawAsk(ax, style, title, label),
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Ranges of approach, stiffness and conductance."""
        good: Any = np.asarray(self.converged)
        if good.any():
            for name in (
                "separation",
                "stiffness",
                "conductance",
                "thermal",
                "electrical",
            ):
                if (value := getattr(self, name)) is not None:
                    q = next(q for q in self.quantities() if q.path == name)
                    yield q.label, span(np.asarray(value)[good], q.unit)
            low = np.asarray(self.conductance_low)[good]
            if np.isfinite(low).any():
                yield "bound", f"conductance at least {span(low, '1/m')}"
            yield (
                "real contact area",
                (
                    "does not follow from lines: em.friction with em.Multiscale() or "
                    "em.HalfSpace()"
                ),
            )
