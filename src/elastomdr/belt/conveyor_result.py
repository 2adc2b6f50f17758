"""Resistance and power of a belt conveyor: what the call returns."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..checks import significant
from ..results.base import Array, Result, quantity, record
from ..results.words import in_words

if TYPE_CHECKING:
    pass

_SHOWN = 6  # curves that a summary lists one by one
_ALIKE = 1e-9  # relative, of two velocities


@record
class Conveyor(Result):
    """Resistance and power per length of belt; a point of which one roll failed is NaN
    with `converged=False`.

    `power` in W/m is also that in kW per kilometre.
    """

    velocity: Array = quantity("velocity", "m/s", "belt speed v", axis="belt speed")
    belt: Array = quantity("mass of the belt", "kg/m", "per length")
    goods: Array = quantity("mass of the goods", "kg/m", "per length")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    carry: Array = quantity("resistance of the carry side", "N/m", "per length of belt")
    back: Array = quantity("resistance of the return side", "N/m", "per length of belt")
    resistance: Array = quantity("resistance", "N/m", "both sides together")
    power: Array = quantity(
        "power",
        "W/m",
        "v times the resistance",
        axis="power per length of belt",
        shown="kW/km",
    )
    coefficient: Array = quantity(
        "resistance over weight", "-", "of goods and of both strands of the belt"
    )
    error: Array = quantity("estimated error of the coefficient", "-")

    title: ClassVar[str] = "Indentation rolling resistance of a belt conveyor"
    shows: ClassVar[str] = "power"
    error_of: ClassVar[str] = "the coefficient"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity",
        "temperature",
        "belt",
        "goods",
    )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Least and largest power per kilometre, and where."""
        power = np.ravel(self.power)
        if np.isfinite(power).any():
            for i in dict.fromkeys(
                (int(np.nanargmin(power)), int(np.nanargmax(power)))
            ):
                place = f"{in_words('velocity', float(np.ravel(self.velocity)[i]))}, "
                place += f"{significant(float(np.ravel(self.goods)[i]))} kg/m of goods"
                if self.temperature is not None:
                    place += (
                        ", "
                        f"{in_words('temperature', float(np.ravel(self.temperature)[i]))}"
                    )
                share = significant(
                    100 * float(np.ravel(self.carry)[i] / np.ravel(self.resistance)[i]),
                    3,
                )
                over = significant(float(np.ravel(self.coefficient)[i]))
                text = (
                    f"{significant(float(power[i]))} kW per km of belt, {share} % of "
                    "it on the carry side"
                )
                yield f"at {place}", f"{text}; resistance over weight {over}"
