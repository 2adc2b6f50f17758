"""A squeezed cord's load, width and pressure: what `em.squeezed_cord` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from ..errors import InputError
from .table import AbstractResult, Column


class SqueezedCord(AbstractResult):
    """Contact of a squeezed cord with either wall; every field has one value per point.

    `error` is that of the arithmetic alone, zero: what the formula itself leaves open `model` says.
    """

    diameter: Float[Array, "..."]  # d [m]
    squeeze: Float[Array, "..."]  # C, part of d
    time: Float[Array, "..."] | None  # since it was squeezed [s]; None: relaxed
    temperature: Float[Array, "..."] | None  # T [K]
    line_load: Float[Array, "..."]  # W, force per length of cord [N/m]
    width: Float[Array, "..."]  # 2a, of the contact [m]
    pressure: Float[Array, "..."]  # W/2a, mean pressure of the contact [Pa]; the largest is 4/pi of it
    error: Float[Array, "..."]
    converged: Bool[Array, "..."]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Squeezed cord"
    coordinates: ClassVar[tuple[str, ...]] = ("time", "squeeze", "temperature", "diameter")

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("diameter", "diameter of the cord", "m"),
            Column("squeeze", "squeeze", "-"),
            Column("time", "time since it was squeezed", "s", optional=True),
            Column("temperature", "temperature", "K", optional=True),
            Column("line_load", "line load", "N/m"),
            Column("width", "width of the contact", "m"),
            Column("pressure", "mean pressure", "Pa"),
            Column("error", "error of the arithmetic", "N/m"),
            Column("converged", "converged", ""),
        )

    def plot(self, ax: Any = None, *, show: str = "pressure", title: str | None = None) -> Any:
        """Draws pressure, width or line_load against what was given in many values; returns matplotlib Axes.

        Against time where there are several, else against the squeeze, else along the last axis, one line per further
        index. With `ax=None` on a new figure, which is the `.figure` of the answer. Raises `InputError`.
        """
        shown = ("pressure", "width", "line_load")
        if show not in shown:
            raise InputError(f"show must be one of {', '.join(shown)}, got {show!r}.")
        from .squeezed_cord_figure import draw_squeezed_cord

        return draw_squeezed_cord(self, ax, show, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, and the ranges of line load, width and pressure."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        for name, key, scale, unit in (
            ("line load", "line_load", 1.0, "N/m"),
            ("contact width", "width", 1e3, "mm"),
            ("mean pressure", "pressure", 1e-6, "MPa"),
        ):
            values = scale * np.asarray(getattr(self, key))
            low, high = significant(float(values.min())), significant(float(values.max()))
            yield name, f"{low} {unit}" if low == high else f"{low} to {high} {unit}"
        yield "points", f"{np.size(self.line_load)}, in closed form"
