"""What `em.line_contact` and `em.press` return: contact along a rough line, and a rough
surface pressed into rubber.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import one_of, significant
from ..results.base import Array, Result, quantity, record
from ..results.words import span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style


@record
class LineContact(Result):
    """A rough line and the rubber it slides over towards +x, at each sample of the
    line.

    Heights and surface count from the undeformed rubber, positive into it: where they
    are equal there is contact. `share` and the stretches in contact are those of the
    MDR line, **not the real contact of the surface**. `plot` draws line and rubber, the
    stretches in contact in colour.
    """

    x: Array = quantity(
        "place on the line",
        "m",
        shown="mm",
        axis="position on the line, which moves to the right",
    )
    height: Array = quantity(
        "height of the line into the rubber", "m", "at its depth", shown="µm"
    )
    surface: Array = quantity(
        "displacement of the rubber",
        "m",
        "u",
        axis="depth below the undeformed rubber",
        shown="µm",
    )
    force: Array = quantity("force per length of line", "N/m", "q")
    touching: Array = quantity("in contact", "")
    mu: float | Array = quantity(
        "friction coefficient", "-", "of the bare line", dims=""
    )
    load: float | Array = quantity("mean force per length", "N/m", dims="")
    depth: float | Array = quantity("depth", "m", "of the highest point", dims="")
    share: float | Array = quantity(
        "share of the line in contact",
        "-",
        "not the real contact area of the surface",
        dims="",
    )
    error: Array = quantity("estimated error of mu", "-", "the same everywhere")
    model_error: Array = quantity(
        "model error", "-", "NaN: how far the line is from a surface"
    )

    title: ClassVar[str] = "Contact along the line"
    figure: ClassVar[str] = "plot_contacts.draw_line_contact"
    across: ClassVar[str] = "x"
    shows: ClassVar[str] = "surface"
    error_of: ClassVar[str] = "mu"
    bound_of: ClassVar[str] = "mu"
    each: ClassVar[str] = "samples"
    last: ClassVar[str] = "x"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)

    def heading(self) -> str:
        """The quantity and the material, at which velocity, pressure and
        temperature.
        """
        inputs = dict(self.inputs)
        return ", ".join(
            [
                super().heading(),
                *(
                    inputs[k]
                    for k in ("velocity", "pressure", "temperature")
                    if k in inputs
                ),
            ]
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Friction and depth, the share of the line in contact."""
        if np.all(self.converged):
            mu, load, depth = (
                significant(float(value)) for value in (self.mu, self.load, self.depth)
            )
            yield "result", f"mu = {mu}, line load {load} N/m, depth {depth} m"
            yield (
                "contact",
                (
                    f"{float(self.share):.2%} of the line; this is not the real "
                    "contact "
                    "area of the surface"
                ),
            )


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
