"""Measured friction drawn over computed curves."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .._runtime import as_float64, positive, require
from ..errors import InputError
from .axes import Curve, in_words

_SAME = 2.0  # temperature from a curve up to which a point takes its colour [K]


def as_measured(measured: Any) -> dict[str, np.ndarray]:
    """Measured points as lists: "velocity" [m/s], "mu" and, if known, "temperature" [K], which broadcast.

    Raises `InputError`.
    """
    if not isinstance(measured, Mapping) or not {"velocity", "mu"} <= set(measured) <= {
        "velocity",
        "mu",
        "temperature",
    }:
        raise InputError(
            'measured must be a mapping with "velocity" [m/s], "mu" and, if known, "temperature" [K], got '
            f"{sorted(measured) if isinstance(measured, Mapping) else measured!r}."
        )
    points = {name: np.atleast_1d(as_float64(f"measured {name}", values)) for name, values in measured.items()}
    positive("measured velocity", points["velocity"])
    require("measured mu", points["mu"], "finite", np.isfinite)
    try:
        together = np.broadcast_arrays(*points.values())
        lists = [values.size for values in points.values() if values.ndim == 1]
        same = len(lists) < len(points) or len(set(lists)) == 1  # lists alone are columns of one table
    except ValueError:
        together, same = [], False
    if not same:
        shapes = ", ".join(f"{name} {values.shape}" for name, values in points.items())
        raise InputError(f"measured values must be lists of the same length, or arrays that broadcast, got {shapes}.")
    return {name: values.ravel() for name, values in zip(points, together, strict=True)}


def draw_measured(
    ax: Any, points: dict[str, np.ndarray], kelvin: Any, curves: Sequence[Curve], colours: Sequence[Any]
) -> None:
    """Draws points in the colour of the curve at their temperature, in black where there is none."""
    at = points.get("temperature")
    style = {"linestyle": "none", "markersize": 5, "markeredgewidth": 1.2, "markerfacecolor": "white", "zorder": 5}
    left = np.ones(points["mu"].shape, dtype=bool)
    if at is not None and kelvin is not None:
        for curve, colour in zip(curves, colours, strict=True):
            own = np.atleast_1d(kelvin[curve.at])
            near = left & (np.abs(at - own[0]) <= _SAME) & (np.ptp(own) == 0)
            if near.any():
                label = f"measured, {in_words('temperature', float(own[0]))}".replace("degC", "°C")
                ax.plot(points["velocity"][near], points["mu"][near], "o", color=colour, label=label, **style)
            left &= ~near
    if left.any():
        ax.plot(points["velocity"][left], points["mu"][left], "s", color="#222222", label="measured", **style)
