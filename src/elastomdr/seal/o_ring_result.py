"""Contact of a squeezed O-ring with its walls: what the call returns."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal

from ..errors import InputError
from ..results.base import Array, Result, quantity, record
from ..results.words import in_unit, span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style

_SHOWN = 6  # curves that a summary lists one by one
_ALIKE = 1e-9  # relative, of two velocities


@record
class ORing(Result):
    """Contact of a squeezed cord with either wall.

    `error` is that of the arithmetic alone, zero: what the formula itself leaves open
    `model` says.
    """

    diameter: Array = quantity("diameter of the cord", "m", "d", shown="mm")
    squeeze: Array = quantity(
        "squeeze", "-", "C, part of d", axis="squeeze of the diameter", shown="%"
    )
    time: Array | None = quantity(
        "time since it was squeezed", "s", "None: relaxed", default=None
    )
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    line_load: Array = quantity(
        "line load",
        "N/m",
        "W, force per length of cord",
        axis="force per length of cord",
    )
    width: Array = quantity("width of the contact", "m", "2a", shown="mm")
    pressure: Array = quantity(
        "mean pressure",
        "Pa",
        "W/2a, of the contact; the largest is 4/pi of it",
        axis="mean pressure of the contact",
        shown="MPa",
    )
    error: Array = quantity("error of the arithmetic", "N/m")

    title: ClassVar[str] = "Squeezed cord"
    across: ClassVar[str] = "squeeze"
    scale: ClassVar[str] = "auto"
    shows: ClassVar[str] = "pressure"
    error_of: ClassVar[str] = "the arithmetic"
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "squeeze",
        "temperature",
        "diameter",
    )

    def plot(
        self,
        ax: "Axes | None" = None,
        style: "Style | None" = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: Literal["pressure", "width", "line_load"] = "pressure",
    ) -> "Axes":
        """Draws pressure, width or line_load against time where there are several
        times, else against the squeeze.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        shown = ("pressure", "width", "line_load")
        if show not in shown:
            raise InputError(f"show must be one of {', '.join(shown)}, got {show!r}.")
        from ..results.plotting import Ask, draw

        x = "time" if any(axis.name == "time" for axis in self.axes()) else "squeeze"
        return self._draw(draw, Ask(ax, style, title, label), x=x, y=show)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The ranges of line load, width and pressure."""
        yield "line load", span(self.line_load, "N/m")
        yield "contact width", span(in_unit(self.width, "mm"), "mm")
        yield "mean pressure", span(in_unit(self.pressure, "MPa"), "MPa")
