"""Persson's friction and contact area against velocity: what `em.reference.persson` returns."""

from typing import Any, ClassVar

import equinox as eqx
from jaxtyping import Bool, Float

from .._runtime import Array
from .curve import AbstractCurve
from .table import Column


class PerssonCurve(AbstractCurve):
    """Persson's theory at given pressures and velocities; every field has one value per point.

    `error` is the estimated numerical error of mu (absolute): what half the wave numbers and angles change.
    `temperature` is None where none was given.
    """

    velocity: Float[Array, "..."]  # sliding velocity v [m/s]
    mu: Float[Array, "..."]  # friction coefficient
    area_ratio: Float[Array, "..."]  # real contact area over the nominal one, A/A_0, at q_high
    spread: Float[Array, "..."]  # G at q_high
    pressure: Float[Array, "..."]  # nominal [Pa]
    error: Float[Array, "..."]  # estimated error of mu
    converged: Bool[Array, "..."]
    temperature: Float[Array, "..."] | None  # T [K]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Friction by Persson's theory"
    symbol: ClassVar[str] = "mu"
    coefficient_field: ClassVar[str] = "mu"

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            Column("pressure", "nominal pressure", "Pa"),
            Column("mu", "friction coefficient", "-"),
            Column("area_ratio", "contact area over nominal area", "-"),
            Column("spread", "G", "-"),
            Column("error", "estimated error of the coefficient", "-"),
            Column("converged", "converged", ""),
        )
