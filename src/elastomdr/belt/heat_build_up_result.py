"""A rolling body heated by its own resistance: what the call returns."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..checks import significant
from ..results.axes import place_in_words
from ..results.base import Array, Result, quantity, record
from ..results.words import in_words

if TYPE_CHECKING:
    pass

_SHOWN = 6  # curves that a summary lists one by one
_ALIKE = 1e-9  # relative, of two velocities


@record
class HeatBuildUp(Result):
    """Temperature of a rolling body heated by its own resistance; NaN with
    `converged=False` where there is none.

    Without a time `temperature`, `power` and `coefficient` are those of the steady
    state. With one, the last axis of every field is time. `settling` is the time
    constant with which the body approaches its steady temperature, C/(H - dP/dT); None
    where no heat capacity was given. `plot` draws the temperature against time, or the
    steady one against velocity.
    """

    time: Array | None = quantity(
        "time", "s", "since the start at the ambient temperature", default=None
    )
    velocity: Array = quantity(
        "velocity", "m/s", "rolling velocity v", axis="rolling velocity"
    )
    load: Array = quantity("normal force", "N", "F_N")
    ambient: Array = quantity(
        "ambient temperature", "K", "of the surroundings, T_a", shown="°C"
    )
    conductance: Array = quantity(
        "conductance", "W/K", "H, from the body to its surroundings"
    )
    capacity: Array | None = quantity("heat capacity", "J/K", "C", default=None)
    temperature: Array = quantity("temperature", "K", "T", shown="°C")
    steady: Array = quantity(
        "steady temperature", "K", "T of the steady state", shown="°C"
    )
    settling: Array | None = quantity(
        "time constant", "s", "near the steady state", default=None
    )
    power: Array = quantity("dissipated power", "W", "at T")
    coefficient: Array = quantity("rolling resistance coefficient", "-", "at T")
    error: Array = quantity("estimated error of the temperature", "K")

    title: ClassVar[str] = "Warming by rolling resistance"
    figure: ClassVar[str] = "draw_warming"
    shows: ClassVar[str] = "temperature"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the temperature"
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "velocity",
        "load",
        "ambient",
        "conductance",
        "capacity",
    )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The coldest and the warmest steady state."""
        steady, rise = np.asarray(self.steady), np.asarray(self.steady - self.ambient)
        if np.isfinite(rise).any():
            for i in dict.fromkeys((int(np.nanargmin(rise)), int(np.nanargmax(rise)))):
                place = [in_words("velocity", float(np.ravel(self.velocity)[i]))]
                for axis, at in zip(
                    self.axes(), np.unravel_index(i, steady.shape), strict=True
                ):
                    if axis.values.size > 1 and axis.name not in ("velocity", "time"):
                        place.append(place_in_words(axis, int(at)))
                kelvin = in_words("temperature", float(steady.ravel()[i]))
                text = (
                    f"{kelvin}, {significant(float(rise.ravel()[i]))} K above the "
                    "surroundings"
                )
                yield f"steady at {', '.join(place)}", text
