"""Friction of a periodic map on a half-space: what `em.reference.half_space_sliding` returns for a `cell`."""

from typing import Any, ClassVar

import equinox as eqx
from jaxtyping import Bool, Float

from .._runtime import Array
from .curve import AbstractCurve
from .table import Column


class HalfSpaceCurve(AbstractCurve):
    """Friction of a map of heights that slides steadily over a half-space, for one cell of the periodic array.

    `mu` is the friction force over the normal force, `error` its estimated error (absolute). A point that did not
    converge is NaN with `converged=False`. `temperature` is None where none was given.
    """

    velocity: Float[Array, "..."]  # sliding velocity v [m/s]
    mu: Float[Array, "..."]  # friction coefficient
    normal_force: Float[Array, "..."]  # of one cell [N]
    friction_force: Float[Array, "..."]  # of one cell [N]
    area: Float[Array, "..."]  # real contact area over that of the cell
    separation: Float[Array, "..."]  # mean distance of the surfaces [m]
    error: Float[Array, "..."]  # estimated error of mu
    converged: Bool[Array, "..."]
    temperature: Float[Array, "..."] | None  # T [K]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Friction"
    symbol: ClassVar[str] = "mu"
    coefficient_field: ClassVar[str] = "mu"

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            Column("mu", "friction coefficient", "-"),
            Column("normal_force", "normal force", "N"),
            Column("friction_force", "friction force", "N"),
            Column("area", "contact area over cell area", "-"),
            Column("separation", "mean distance of the surfaces", "m"),
            Column("error", "estimated error of the coefficient", "-"),
            Column("converged", "converged", ""),
        )
