"""Traction against creep or slip: what `em.traction` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar, NamedTuple

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from .curve import Contact
from .table import AbstractResult, Column


class TractionPeak(NamedTuple):
    """The largest traction of each curve, over the last axis; NaN where no point of it is known."""

    creep: Float[np.ndarray, "..."]  # xi at which it was computed, no interpolation
    coefficient: Float[np.ndarray, "..."]  # F_x/F_N
    inside: Bool[np.ndarray, "..."]  # False at an end of the curve, beyond which it may grow
    place: tuple[np.ndarray, ...]  # of the point, an index into the fields

    @property
    def slip(self) -> Float[np.ndarray, "..."]:
        """The same as a slip, s = xi/(1 + xi): the velocity of slip over that of the road."""
        return self.creep / (1 + self.creep)


class Traction(AbstractResult):
    """Steady rolling with creep; every field has one value per point, NaN with `converged=False` where it failed."""

    velocity: Float[Array, "..."]  # rolling velocity v [m/s]
    creep: Float[Array, "..."]  # xi
    friction: Float[Array, "..."]  # Coulomb's coefficient mu
    coefficient: Float[Array, "..."]  # F_x/F_N
    force: Float[Array, "..."]  # tractive force F_x [N]
    stick: Float[Array, "..."]  # part of the contact's length that sticks
    slip_power: Float[Array, "..."]  # power of the tractive force on the creep, F_x xi v [W]
    rolling: Float[Array, "..."]  # rolling resistance coefficient of the normal contact
    normal_force: Float[Array, "..."]  # F_N [N]
    depth: Float[Array, "..."]  # [m]
    contact: Contact  # leading and trailing edge [m]
    error: Float[Array, "..."]  # estimated error of the traction coefficient, at its contact size
    converged: Bool[Array, "..."]
    temperature: Float[Array, "..."] | None  # T [K]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)
    extrapolated: Bool[Array, "..."] | None = None  # whether the material is used beyond its range; None: not known
    slip: Float[Array, "..."] | None = None  # s = (V - v)/V, where the scene was given by it
    road: Float[Array, "..."] | None = None  # velocity V of the road, beside the slip [m/s]

    quantity: ClassVar[str] = "Traction"
    coordinates: ClassVar[tuple[str, ...]] = (
        "slip", "creep", "road", "velocity", "temperature", "normal_force", "depth", "friction",
    )  # fmt: skip

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("road", "velocity of the road", "m/s", optional=True),
            Column("velocity", "velocity" if self.road is None else "rolling velocity", "m/s"),
            Column("creep", "creep", "-"),
            Column("slip", "slip", "-", optional=True),
            Column("friction", "Coulomb's friction coefficient", "-"),
            Column("temperature", "temperature", "K", optional=True),
            Column("coefficient", "traction coefficient", "-"),
            Column("force", "tractive force", "N"),
            Column("stick", "part of the contact that sticks", "-"),
            Column("slip_power", "power of creep", "W"),
            Column("rolling", "rolling resistance coefficient", "-"),
            Column("normal_force", "normal force", "N"),
            Column("depth", "depth", "m"),
            Column("contact.leading", "leading edge", "m"),
            Column("contact.trailing", "trailing edge", "m"),
            Column("error", "estimated error of the traction coefficient", "-"),
            Column("converged", "converged", ""),
            Column("extrapolated", "beyond the range of the material", "", optional=True),
        )

    def peak(self) -> TractionPeak:
        """The point of largest absolute traction on each curve, whose points lie along the last axis.

        With a friction coefficient that falls with the sliding velocity it lies inside; with one that rises, or a
        constant one, at the end, where all of the contact slips.
        """
        pulled = np.atleast_1d(np.abs(np.asarray(self.coefficient)))
        creep = np.atleast_1d(np.asarray(self.creep))
        place = np.where(np.isfinite(pulled), pulled, -1.0).argmax(axis=-1)
        index = (*np.indices(place.shape), place)
        known, top = np.isfinite(pulled), creep[index][..., None]
        inside = np.asarray((known & (creep < top)).any(axis=-1) & (known & (creep > top)).any(axis=-1))
        coefficient = np.atleast_1d(np.asarray(self.coefficient))[index]
        return TractionPeak(creep[index], np.where(pulled[index] >= 0, coefficient, np.nan), inside, index)

    def plot(self, ax: Any = None, title: str | None = None) -> Any:
        """Draws the traction coefficient against creep, or slip where that was given, one line per further index.

        Returns matplotlib Axes; with `ax=None` on a new figure, which is the `.figure` of the answer.
        """
        from .motion_figure import draw_traction

        return draw_traction(self, ax, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, the largest traction, the rolling loss, how many points failed."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        good = np.asarray(self.converged)
        for name, field in (("traction coefficient", self.coefficient), ("rolling resistance", self.rolling)):
            known = np.asarray(field)[good]
            if known.size:
                low, high = significant(float(known.min())), significant(float(known.max()))
                yield name, low if low == high else f"{low} to {high}"
        yield "points", self.reached("error of the coefficient")
