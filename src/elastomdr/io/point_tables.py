"""Tables with one row per point: measured friction (`em.read_friction`), and shift
factors as instruments' programs write them beside a master curve (`em.read_shifts`).
"""

import os
from collections.abc import Mapping

import numpy as np

from ..checks import in_kelvin, in_si, plain
from ..errors import InputError, warn
from ..files import file_as_typed
from ..material.shift import ShiftTable, VerticalTable
from .columns import (
    ColumnKind,
    ColumnsRead,
    checked_units,
    left_out,
    naming,
    read_columns,
    taken,
    understand,
    unread,
)
from .data import COLDEST, FitWarning, MeasuredFriction

_TEMPERATURE = ColumnKind(
    "temperature",
    "temperature",
    (r"t|temp\.?|temperature|temperatur",),
    limits=(COLDEST, 800.0),
)
_FRICTION = (
    ColumnKind(
        "velocity",
        "velocity",
        (
            r"v|velocity|speed|sliding (velocity|speed)|geschwindigkeit|gleitgeschwindigkeit",
        ),
        limits=(1e-12, 1e3),
    ),
    ColumnKind(
        "mu",
        "ratio",
        (
            r"mu|µ|μ|cof|friction|(friction|frictional) coefficient|"
            r"coefficient of friction|reib(wert|ungszahl)|reibungskoeffizient",
        ),
        valid="zero or positive",
        limits=(0.0, 8.0),
    ),
    _TEMPERATURE,
    ColumnKind(
        "pressure",
        "pressure",
        (r"p|(nominal |contact |mean )?pressure|druck|flächenpressung",),
    ),
    ColumnKind(
        "error",
        "ratio",
        (
            r"err(or)?|std|sd|sigma|±|\+/-|fehler|unsicherheit|uncertainty|"
            r"standard deviation|standardabweichung|u[ _](mu|µ|μ)|"
            r"(err(or)?|std|sd|standard deviation|uncertainty) (of )?(mu|friction)|"
            r"mu (err(or)?|std|sd|uncertainty)",
        ),
    ),
)
_VERTICAL = 1e-3  # of log10 b_T, below which moduli are not shifted
_NEAR = 0.5  # likewise where no a_T is 1
_SECOND = r"(wlf|vft|vtf|arrhenius|fit(ted)?|smoothed|manual)"
_NO_FACTOR = (
    r"vert|b_?t|std|err|dev|\+|±|%|uncert|unsich|conf|low|upp|\b(ci|sd|se|min|max)\b"
)
_SHIFTS = (
    _TEMPERATURE,
    ColumnKind(
        "shift",
        "ratio",
        (
            rf"a|(?!.*({_NO_FACTOR}))(({_SECOND}[ _])?"
            r"(a(_?t|\(t\))|shift ?factors?|verschiebungsfaktor(en)?)( .+)?|wlf)",
        ),
    ),
    ColumnKind(
        "vertical",
        "ratio",
        (r"b(_?[tv]|\(t\))?|vertical( shift)?( ?factors?)?",),
        valid="",
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
            it) may be absent, other columns are passed over, with a warning where they
            hold numbers.
        temperature: temperature of all points where the file has no such column [K].
        columns: columns by quantity (velocity, mu, temperature, pressure, error), as in
            `em.read_dma`.
        velocity_unit: unit of velocities without one, such as "mm/s"; it overrules none
            in the file.
        temperature_unit: likewise of temperatures.
        pressure_unit: likewise of pressures.

    Returns:
        The points in SI units; `columns` says what was read as what, `report` which
        rows are no measurement, and which numbers were not read.

    Raises:
        InputError: for what cannot be read, what is ambiguous, units that nobody gives,
            and where more than half of the rows are no measurement.
    """
    units = checked_units(
        {
            "velocity": velocity_unit,
            "temperature": temperature_unit,
            "pressure": pressure_unit,
        }
    )
    with file_as_typed(path):
        table, chosen, values, bad = read_columns(
            path, _FRICTION, ("velocity", "mu"), columns, units
        )
    name = table.name
    if 2 * len(bad) > len(table.rows):
        raise InputError(
            argument="path",
            got=path,
            accepted="a table most of whose rows are a measurement",
            hint=f"{len(bad)} of {len(table.rows)} are not: {'; '.join(bad[:3])} ...",
        )
    if "error" in chosen and chosen["error"].unit == "%":
        if chosen["mu"].unit == "%":
            raise InputError(
                argument="path",
                got=path,
                accepted="a table whose error is a plain number where mu is in %",
                hint="the error may be percent of mu or of 1",
            )
        values["error"] = values["error"] * values["mu"]
    if temperature is not None:
        given_temperature = plain("temperature", temperature)
        in_kelvin("temperature", given_temperature)
        if "temperature" in values:
            raise InputError(
                argument="temperature",
                got=given_temperature,
                accepted=f"left out where the file has a column for it, as {name!r}",
            )
        values["temperature"] = np.full(values["mu"].shape, given_temperature)
    numbers = [
        head.words
        for head in unread(table, chosen)
        if 2 * np.isfinite(table.column(head.place)).sum() > len(table.rows)
        and not understand(head, _FRICTION)
    ]
    report = left_out(name, bad, "report")
    if numbers:
        report += (f"{name}: numbers that are not read: {', '.join(numbers)}.",)
    for line in report:
        warn(line, FitWarning)
    return MeasuredFriction(
        values["velocity"],
        values["mu"],
        values.get("temperature"),
        values.get("pressure"),
        values.get("error"),
        name,
        taken(table, chosen),
        report,
    )


@in_si
def read_shifts(
    path: str | os.PathLike[str],
    *,
    columns: Mapping[str, str | int] | None = None,
    temperature_unit: str | None = None,
) -> ShiftTable:
    """A shift law from a list of temperatures and shift factors, such as "T
    [degC],log_aT".

    Args:
        path: a text file or a spreadsheet; factors as a_T, or their logarithms as
            "log10 a_T", "log aT" or "ln aT".
        columns: columns by quantity (temperature, shift, vertical), as in `em.read_dma`.
        temperature_unit: unit of the temperatures, where the file has none.

    Returns:
        The list as a law; between its temperatures it is interpolated. Vertical factors
        b_T beside it, and columns that may hold them, are passed over, with a warning.

    Raises:
        InputError: for what cannot be read, and units that nobody gives.
    """
    read, shift, vertical = _both_shifts(path, columns, temperature_unit)
    remedy = "em.fit.material as vertical=em.VerticalTable(temperature, b_T)"
    if vertical is not None:
        column, known = read.chosen["vertical"], np.log10(vertical.factor)
        warn(
            f"{read.table.name}: column {column.words} is passed over: "
            f"log10 b_T from {known.min():.4f} to {known.max():.4f} is no part of a "
            f"shift law. Give it to {remedy}.",
            FitWarning,
        )
    away = abs(np.log(read.values["shift"]))
    reference = away.argmin()
    near = _VERTICAL if away[reference] < _VERTICAL else _NEAR
    for head in read.table.heads:
        if understand(head, _SHIFTS):
            continue
        factor = read.table.column(head.place)  # b_T is 1 where a_T is
        if abs(factor[reference] - 1) < near and 0 < min(factor) < max(factor) < 9:
            warn(
                f"{read.table.name}: column {head.words} is passed over: where it is "
                f"b_T, title it so or give it to {remedy}.",
                FitWarning,
            )
    return shift


def vertical_factors(path: str | os.PathLike[str]) -> VerticalTable | None:
    """The vertical factors b_T beside the shift factors of a file, where it has any
    that are not 1.
    """
    return _both_shifts(path, None, None)[2]


def _both_shifts(
    path: str | os.PathLike[str],
    columns: Mapping[str, str | int] | None,
    temperature_unit: str | None,
) -> tuple[ColumnsRead, ShiftTable, VerticalTable | None]:
    """The columns of a file, its shift factors, and the vertical ones."""
    units = checked_units({"temperature": temperature_unit})
    # nobody's log a_T is ln
    with file_as_typed(path):
        read = read_columns(
            path, _SHIFTS, ("temperature", "shift"), columns, units, log="log10"
        )
    if read.bad:
        raise InputError(
            argument="path",
            got=path,
            accepted="a table whose rows are all of numbers",
            hint="; ".join(read.bad[:3]),
        )
    order = np.argsort(read.values["temperature"])
    temperature = read.values["temperature"][order]
    shift = ShiftTable(temperature, np.log10(read.values["shift"][order]))
    factor = read.values.get("vertical", np.ones(order.size))[order]
    known = np.isfinite(factor)
    if "vertical" in read.chosen:
        column = read.chosen["vertical"]
        if not column.log and (read.table.column(column.place) <= 0).any():
            raise InputError(
                argument="path",
                got=path,
                accepted=f"a table whose column {column.words} is positive",
                hint="if it holds logarithms, title it 'log10 bT', or give it as "
                + naming({"vertical": f"log10({column.place + 1})"}),
            )
        if not known.all():
            holes = ", ".join(f"{kelvin:g} K" for kelvin in temperature[~known])
            warn(
                f"{read.table.name}: column {column.words} has no number at {holes}: "
                "b_T is interpolated between its other rows.",
                FitWarning,
            )
    if known.sum() < 2 or not (np.abs(np.log10(factor[known])) > _VERTICAL).any():
        return read, shift, None
    return read, shift, VerticalTable(temperature[known], factor[known])
