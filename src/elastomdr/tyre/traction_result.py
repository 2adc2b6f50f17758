"""Traction against creepage or slip: what `em.traction` returns."""

import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ..results.base import Array, Quantity, Result, quantity, record
from ..results.curve import Contact
from ..results.words import span

if TYPE_CHECKING:
    from .magic_formula import MagicFormula


class TractionPeak(NamedTuple):
    """The largest traction of each curve, over the last axis; NaN where no point of it
    is known.
    """

    creepage: np.ndarray  # xi at which it was computed, no interpolation
    coefficient: np.ndarray  # F_x/F_N
    inside: np.ndarray  # False at an end of the curve, beyond which it may grow
    place: tuple[np.ndarray, ...]  # of the point, an index into the fields

    @property
    def slip(self) -> np.ndarray:
        """The same as a slip, s = xi/(1 + xi): the velocity of slip over that of the
        road.
        """
        return self.creepage / (1 + self.creepage)


@record
class Traction(Result):
    """Steady rolling with creepage; a point that did not converge is NaN with
    `converged=False`.

    `plot` draws the traction coefficient against creepage, or the slip where that was
    given; dashed is the friction coefficient, what a contact has that slips all over.
    """

    road: Array | None = quantity(
        "velocity of the road", "m/s", "V, where a slip was given", default=None
    )
    velocity: Array = quantity("velocity", "m/s", "rolling velocity v")
    creepage: Array = quantity("creepage", "-", "xi", shown="%")
    slip: Array | None = quantity(
        "slip", "-", "s = (V - v)/V, where it was given", default=None, shown="%"
    )
    friction: Array = quantity("Coulomb's friction coefficient", "-", "mu")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    coefficient: Array = quantity(
        "traction coefficient", "-", "F_x/F_N", axis="traction coefficient $F_x/F_N$"
    )
    force: Array = quantity("tractive force", "N", "F_x")
    stick: Array = quantity("part of the contact that sticks", "-", "of its length")
    slip_power: Array = quantity(
        "power of creepage", "W", "of the tractive force on the creepage, F_x xi v"
    )
    rolling: Array = quantity(
        "rolling resistance coefficient", "-", "of the normal contact"
    )
    normal_force: Array = quantity("normal force", "N", "F_N")
    depth: Array = quantity("depth", "m", shown="mm")
    contact: Contact
    error: Array = quantity(
        "estimated error of the traction coefficient", "-", "at its contact size"
    )

    title: ClassVar[str] = "Traction"
    figure: ClassVar[str] = "draw_traction"
    across: ClassVar[str] = "creepage"
    shows: ClassVar[str] = "coefficient"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the coefficient"
    coordinates: ClassVar[tuple[str, ...]] = (
        "slip",
        "creepage",
        "road",
        "velocity",
        "temperature",
        "normal_force",
        "depth",
        "friction",
    )

    def describe(self, q: Quantity) -> Quantity:
        """Beside the velocity of the road the other one is that of rolling."""
        return (
            q._replace(label="rolling velocity")
            if q.path == "velocity" and self.road is not None
            else q
        )

    def peak(self) -> TractionPeak:
        """The point of largest absolute traction on each curve, whose points lie along
        the last axis.

        With a friction coefficient that falls with the sliding velocity it lies inside;
        with one that rises, or a constant one, at the end, where all of the contact
        slips.
        """
        pulled = np.atleast_1d(np.abs(np.asarray(self.coefficient)))
        creepage = np.atleast_1d(np.asarray(self.creepage))
        place = np.where(np.isfinite(pulled), pulled, -1.0).argmax(axis=-1)
        index = (*np.indices(place.shape), place)
        known, top = np.isfinite(pulled), creepage[index][..., None]
        inside = np.asarray(
            (known & (creepage < top)).any(axis=-1)
            & (known & (creepage > top)).any(axis=-1)
        )
        coefficient = np.atleast_1d(np.asarray(self.coefficient))[index]
        return TractionPeak(
            creepage[index],
            np.where(pulled[index] >= 0, coefficient, np.nan),
            inside,
            index,
        )

    def magic_formula(self, *, temperature: float | None = None) -> "MagicFormula":
        """The Magic Formula fitted to this slip curve, of one speed and temperature,
        over its loads.

        `temperature` [K] says which, where there are several. Raises `InputError` for
        several speeds or temperatures, and fewer than eight points that brake.
        """
        from .magic_formula import fitted

        return fitted(self, temperature)

    def to_tir(
        self,
        path: str | os.PathLike[str],
        *,
        radius: float,
        width: float,
        temperature: float | None = None,
    ) -> None:
        """Writes the Magic Formula as a property file (.tir, PAC2002) in SI units: the
        longitudinal part only.

        `radius` and `width` of the tyre [m] go into the file; how far the fit is from
        the curve stands at its top. `temperature` [K] says which, where there are
        several. Raises `InputError` as `magic_formula` does, and where the file cannot
        be written.
        """
        from .magic_formula import write

        write(self, path, radius, width, temperature)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The largest traction and the rolling loss."""
        good = np.asarray(self.converged)
        if good.any():
            yield "traction coefficient", span(np.asarray(self.coefficient)[good])
            yield "rolling resistance", span(np.asarray(self.rolling)[good])
