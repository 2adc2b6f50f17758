"""`em.read_friction`: tables of measured friction: velocity, friction coefficient,
temperature, pressure, error.
"""

import os
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..checks import in_kelvin, in_si, plain
from ..errors import InputError
from .columns import Quantity, left_out, read_columns
from .data import FitWarning, MeasuredFriction
from .dma import checked_units

QUANTITIES = (
    Quantity(
        "velocity",
        "velocity",
        (
            r"v|velocity|speed|sliding (velocity|speed)|geschwindigkeit|gleitgeschwindigkeit",
        ),
        option="velocity_unit",
        limits=(1e-12, 1e3),
    ),
    Quantity(
        "mu",
        "ratio",
        (
            r"mu|µ|μ|cof|friction|(friction|frictional) coefficient|"
            r"coefficient of friction|reib(wert|ungszahl)|reibungskoeffizient",
        ),
        valid="not negative",
        limits=(0.0, 8.0),
    ),
    Quantity(
        "temperature",
        "temperature",
        (r"t|temp\.?|temperature|temperatur",),
        option="temperature_unit",
        limits=(100.0, 800.0),
    ),
    Quantity(
        "pressure",
        "modulus",
        (r"p|(nominal |contact |mean )?pressure|druck|flächenpressung",),
        option="pressure_unit",
    ),
    Quantity(
        "error",
        "ratio",
        (
            r"error|std|sigma|standard deviation|"
            r"(error|std|standard deviation) of (mu|friction)|mu (error|std)",
        ),
    ),
)


@in_si
def read_friction(
    path: str | os.PathLike[str],
    *,
    temperature: float | None = None,
    columns: Mapping[str, str | int] | None = None,
    velocity_unit: str | None = None,
    temperature_unit: str | None = None,
    pressure_unit: str | None = None,
) -> MeasuredFriction:
    """Measured friction from a text file or a spreadsheet, one row per point.

    Args:
        path: a table with titles such as "velocity [mm/s],temperature [degC],mu";
            temperature, nominal pressure and error (standard deviation of mu, or [%] of
            it) may be absent, other columns are passed over.
        temperature: temperature of all points where the file has no such column [K].
        columns: columns by quantity (velocity, mu, temperature, pressure, error), as in
            `em.read_dma`.
        velocity_unit: unit of velocities without one, such as "mm/s"; it overrules none
            in the file.
        temperature_unit: likewise of temperatures.
        pressure_unit: likewise of pressures.

    Returns:
        The points in SI units; `report` names the rows that are no measurement.

    Raises:
        InputError: for what cannot be read, what is ambiguous, units that nobody gives,
            and where more than half of the rows are no measurement.
    """
    units = checked_units(
        velocity=velocity_unit, temperature=temperature_unit, pressure=pressure_unit
    )
    units["modulus"] = units.pop("pressure", "")
    name, chosen, values, bad, rows = read_columns(
        path, QUANTITIES, ("velocity", "mu"), columns, units
    )
    if 2 * len(bad) > rows:
        raise InputError(
            f"{name}: {len(bad)} of {rows} rows are no measurement: "
            f"{'; '.join(bad[:3])} ..."
        )
    if "error" in chosen and chosen["error"].unit == "%":
        if chosen["mu"].unit == "%":
            raise InputError(
                f"{name}: mu and its error are in %, which may be percent of mu or of "
                "1: give the error as a "
                "plain number."
            )
        values["error"] = values["error"] * values["mu"]
    if temperature is not None:
        kelvin = float(plain("temperature", temperature))
        in_kelvin("temperature", kelvin)
        if "temperature" in values:
            raise InputError(
                f"temperature must be left out, got {kelvin:g} K: {name!r} has a "
                "column for it."
            )
        values["temperature"] = np.full(values["mu"].shape, kelvin)
    report = left_out(name, bad, "report")
    for text in report:
        warnings.warn(text, FitWarning, stacklevel=3)
    optional: dict[str, Any] = {
        role: values.get(role) for role in ("temperature", "pressure", "error")
    }
    return MeasuredFriction(
        values["velocity"], values["mu"], source=name, report=report, **optional
    )
