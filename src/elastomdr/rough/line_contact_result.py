"""Contact along a rough line: what `em.line_contact` returns."""

from collections.abc import Iterator
from typing import ClassVar

import numpy as np

from ..checks import significant
from ..results.base import Array, Result, quantity, record


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

    title: ClassVar[str] = "Contact along the line"
    figure: ClassVar[str] = "plot_contacts.draw_line_contact"
    across: ClassVar[str] = "x"
    shows: ClassVar[str] = "surface"
    error_of: ClassVar[str] = "mu"
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
