"""Contact along a rough line: what `em.line_contact` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .table import AbstractResult, Column


class LineContact(AbstractResult):
    """A rough line and the rubber it slides over towards +x, at each sample of the line.

    Heights and surface count from the undeformed rubber, positive into it: where they are equal there is contact.
    `share` and the stretches in contact are those of the MDR line, **not the real contact of the surface**.
    """

    x: Float[Array, " n"]  # place on the line [m]
    height: Float[Array, " n"]  # of the line, at its depth [m]
    surface: Float[Array, " n"]  # u, of the rubber [m]
    force: Float[Array, " n"]  # q, force per length of line [N/m]
    touching: Bool[Array, " n"]
    mu: float  # of the bare line
    load: float  # mean force per length [N/m]
    depth: float  # of the highest point [m]
    share: float  # of the line in contact
    error: Float[Array, " n"]  # estimated error of mu, the same everywhere
    converged: Bool[Array, " n"]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Contact along the line"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("x", "place on the line", "m"),
            Column("height", "height of the line into the rubber", "m"),
            Column("surface", "displacement of the rubber", "m"),
            Column("force", "force per length of line", "N/m"),
            Column("touching", "in contact", ""),
            Column("converged", "converged", ""),
        )

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, friction and depth, the share of the line in contact."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        if self.converged.all():
            mu, load, depth = (significant(value) for value in (self.mu, self.load, self.depth))
            yield "result", f"mu = {mu}, line load {load} N/m, depth {depth} m"
            yield "contact", f"{self.share:.2%} of the line; this is not the real contact area of the surface"
        yield "points", self.reached("error of mu")

    def png(self, title: str | None = None) -> bytes:
        """The figure as a PNG image, 200 dots per inch."""
        from .surface_figure import contact_png

        return contact_png(self, title)

    def plot(self, ax: Any = None, *, title: str | None = None) -> Any:
        """Draws line and rubber, the stretches in contact in colour; returns the matplotlib Axes."""
        from .surface_figure import draw_contact

        return draw_contact(self, ax, title)
