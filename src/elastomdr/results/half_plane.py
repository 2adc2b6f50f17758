"""Friction on a half-plane against velocity: what `em.reference.half_plane_sliding` returns."""

from typing import Any, ClassVar

import equinox as eqx
from jaxtyping import Bool, Float

from .._runtime import Array
from .curve import AbstractCurve, Contact
from .table import Column


class HalfPlaneCurve(AbstractCurve):
    """Friction of a cylinder that slides steadily across its axis over a half-plane, per length of the cylinder.

    `mu` is the friction force over the load, `error` its estimated error (absolute). A point that did not converge is
    NaN with `converged=False`. `temperature` is None where none was given.
    """

    velocity: Float[Array, "..."]  # sliding velocity v [m/s]
    mu: Float[Array, "..."]  # friction coefficient
    load_per_length: Float[Array, "..."]  # [N/m]
    friction_per_length: Float[Array, "..."]  # [N/m]
    contact: Contact  # leading and trailing edge [m]
    error: Float[Array, "..."]  # estimated error of mu
    converged: Bool[Array, "..."]
    temperature: Float[Array, "..."] | None  # T [K]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Friction"
    symbol: ClassVar[str] = "mu"
    coefficient_field: ClassVar[str] = "mu"
    coordinates: ClassVar[tuple[str, ...]] = ("velocity", "temperature", "load_per_length")

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            Column("mu", "friction coefficient", "-"),
            Column("load_per_length", "load per length", "N/m"),
            Column("friction_per_length", "friction force per length", "N/m"),
            Column("contact.leading", "leading edge", "m"),
            Column("contact.trailing", "trailing edge", "m"),
            Column("error", "estimated error of the coefficient", "-"),
            Column("converged", "converged", ""),
        )
