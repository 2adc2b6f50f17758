"""`em.read_dma`: dynamic moduli and relaxation from files into SI arrays."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..checks import in_si, one_of, plain, positive
from ..errors import InputError, advise, either, typed_as, warn
from ..files import file_as_typed
from .columns import (
    NUMBERS,
    Column,
    Understood,
    check_columns,
    checked_units,
    choose,
    left_out,
    measured,
    missing,
    refuse_contradiction,
    refuse_wide,
    taken,
    understand_table,
    units_of,
)
from .data import KINDS, Dma, FitWarning, join
from .held import BACK, NoStep, while_held
from .isotherms import (
    isotherms,
    with_given_temperatures,
    with_temperatures_of_names,
    without_holds,
)
from .quantities import QUANTITIES, lacking, needed_roles
from .sheets import is_frame, read_sheet, sheet_of_frame
from .tables import Format, TitledTable, format_of

if TYPE_CHECKING:
    from .._types import ArrayLike, Frame, Kind

    Source = str | os.PathLike[str] | Frame

_APART = 0.5  # [K], within which two temperatures are one
_A_MEASUREMENT = "a table of frequency with moduli, or of time with stress and strain"
_ALONE = "if it was not measured, give " + advise(
    "storage_only=True", {"storage_only": ""}
)
_OF_KIND = either(
    [advise(f"kind={kind!r}", {"kind": kind}) for kind in ("shear", "tensile")]
)


class Specimen(NamedTuple):
    """What files seldom say of a test: section [m^2] and length [m] of the specimen,
    duration of a ramp [s].
    """

    area: float | None
    length: float | None
    ramp: float | None
    storage_only: bool


@in_si
@typed_as("path", "path_or_paths")
def read_dma(
    path_or_paths: Source | Sequence[Source],
    *,
    temperature: ArrayLike | None = None,
    kind: Kind | None = None,
    columns: Mapping[str, str | int] | None = None,
    frequency_unit: str | None = None,
    modulus_unit: str | None = None,
    temperature_unit: str | None = None,
    time_unit: str | None = None,
    area: float | None = None,
    length: float | None = None,
    ramp: float | None = None,
    storage_only: bool = False,
) -> Dma:
    """Dynamic moduli or relaxation from a file or a table in memory, or from several of
    one material.

    The formats are those of `elastomdr.io.tables`: tables in text and spreadsheets,
    exports of TA Q800, TRIOS, Netzsch, RheoCompass and Eplexor, RepTate's files.
    Isotherms may stand in one table, one below the other, side by side, or in columns
    such as "E' (-40 degC) [MPa]".

    Args:
        path_or_paths: a file, or a table of pandas or polars, whose titles are
            understood as those of files are; or a list of these.
        temperature: temperature of all points that have none in the files [K], or one
            for each isotherm without, in their order.
        kind: "shear" or "tensile": what the moduli are, where the file does not say.
        columns: columns by quantity (frequency, temperature, storage, loss, absolute,
            phase, tangent, time, relaxation, creep, stress, strain, and viscosity,
            compliance, stiffness with _real, _imaginary or _storage, _loss), for titles
            that are not recognised or are wrong: a title, or a number from 1, with the
            unit where the file's is missing or wrong: {"storage": "Modulus 1", "loss":
            4, "frequency": "2 [Hz]"}; "log10(3)" for logarithms; "10 Hz" for a number
            that holds for all rows.
        frequency_unit: unit of frequencies without one, such as "Hz" or "rad/s"; it
            overrules none in a file.
        modulus_unit: likewise of moduli, such as "MPa".
        temperature_unit: likewise of temperatures, "degC" or "K".
        time_unit: likewise of times, such as "s".
        area: section of the specimen, of which files hold the dynamic stiffness [m^2].
        length: its length in tension, its height in shear [m]: modulus = stiffness
            length/area.
        ramp: duration of the ramp of strain before relaxation, from whose start times
            count [s].
        storage_only: whether a storage modulus without a loss modulus is all there is.

    Returns:
        The measurement in SI units; `columns` says what was read as what, `bad_rows`
        which rows are no measurement.

    Raises:
        InputError: for what cannot be read, what is ambiguous, and units that nobody
            gives; it says what to give.
    """
    if kind is not None:
        one_of("kind", kind, *KINDS)
    check_columns(columns)
    units = checked_units(
        {
            "frequency": frequency_unit,
            "modulus": modulus_unit,
            "temperature": temperature_unit,
            "time": time_unit,
        },
    )
    specimen = _specimen(area, length, ramp, storage_only)
    options = _Options(
        kind, columns, units, specimen, isinstance(temperature, (Sequence, np.ndarray))
    )
    unmet = dict(columns or {})
    parts: list[Dma] = []
    for source in _checked_sources(path_or_paths):
        with file_as_typed(source):
            parts += _read(source, options, unmet)
    if unmet:
        raise InputError(
            argument="columns",
            got=unmet,
            accepted="titles or numbers of columns that a file has",
        )
    if temperature is None:
        parts = with_temperatures_of_names(parts)
    dma = join(*with_given_temperatures(without_holds(parts), temperature))
    for warning in dma.warnings:
        warn(warning, FitWarning)
    return dma


class _Options(NamedTuple):
    """What a user says of files."""

    kind: Kind | None
    columns: Mapping[str, str | int] | None
    units: dict[str, str]  # by kind
    specimen: Specimen
    isotherms: bool  # whether each without a temperature is given its own


def _checked_sources(path_or_paths: object) -> list[Any]:
    """Files or tables in memory. Raises `InputError`."""
    sources = [path_or_paths] if _is_source(path_or_paths) else path_or_paths
    if (
        not isinstance(sources, Sequence)
        or not sources
        or not all(map(_is_source, sources))
    ):
        raise InputError(
            argument="path_or_paths",
            got=path_or_paths,
            accepted="a file or a list of files, or tables of pandas or polars in "
            "their place",
        )
    files = [str(one) for one in sources if not is_frame(one)]
    repeated = sorted({name for name in files if files.count(name) > 1})
    if repeated:
        raise InputError(
            argument="path_or_paths", got=repeated, accepted="every file once"
        )
    return list(sources)


def _is_source(value: object) -> bool:
    return isinstance(value, (str, os.PathLike)) or is_frame(value)


def _specimen(
    area: float | None, length: float | None, ramp: float | None, storage_only: bool
) -> Specimen:
    given = {"area": area, "length": length, "ramp": ramp}
    for name, value in given.items():
        if value is not None:
            given[name] = number = plain(name, value)
            positive(name, number)
    return Specimen(**given, storage_only=bool(storage_only))


def _read(source: Any, options: _Options, unmet: dict[str, str | int]) -> list[Dma]:
    """Each isotherm of a file, or of a table in memory, as a measurement; the
    temperature is NaN where the file has none.

    Roles of `options.columns` that are found are taken out of `unmet`.
    """
    sheet = sheet_of_frame(source) if is_frame(source) else read_sheet(source)
    name, layout = sheet.name, format_of(sheet)
    tables = [
        table._replace(name=name, units=options.units) for table in layout.tables(sheet)
    ]
    refuse_wide(tables)
    parts = [
        isotherm for table in tables for isotherm in isotherms(table, options.columns)
    ]
    measurements: list[Dma] = []
    used: list[TitledTable] = []
    refused: list[NoStep] = []
    before = -np.inf  # when the step before ended
    not_understood: tuple[list[str], str] | None = None
    for table in parts:
        columns = understand_table(options.columns, table, QUANTITIES)
        for role in columns.of_user & unmet.keys():
            del unmet[role]
        lack = _lack(table, columns, options.specimen)
        if lack:
            not_understood = not_understood or (columns.in_words(), lack)
            if used:
                _refuse_rows_below(table, used[-1])
            continue
        try:
            measurement = _measurement(layout, table, columns, options)
            own = options.isotherms and not measurement.has_temperatures
            _refuse_second_step(measurement, table, measurements, used, before, own)
        except NoStep as error:
            refused.append(error)
            before = max(before, error.ended)
            continue
        before = _ended(measurement)
        measurements.append(measurement)
        used.append(table)
    if refused and not measurements:
        raise refused[-1]
    if refused:
        left = (f"{name}: {error.why}: left out." for error in refused)
        measurements[0] = replace(
            measurements[0], warnings=(*measurements[0].warnings, *left)
        )
    if not measurements:
        known, lack = not_understood or ([], "there are no columns of moduli")
        raise InputError(
            argument="path",
            accepted=_A_MEASUREMENT if parts else NUMBERS,
            hint=lack + "; " + missing(known, max(parts, key=lambda one: len(one.rows)))
            if parts
            else "",
        )
    without = [i for i, one in enumerate(measurements) if not one.has_temperatures]
    if 0 < len(without) < len(measurements):
        raise InputError(
            argument="path",
            accepted="a file whose rows all have a temperature, or none",
            hint=f"the rows from line {used[without[0]].rows[0].line} on have none: "
            "write it above them, as 'T = -20 degC', or into a column",
        )
    return measurements


def _ended(measurement: Dma) -> float:
    """The last time after a step; none of what has none."""
    timed = not measurement.omega.size and measurement.response != "storage"
    return float(measurement.time.max()) if timed else -np.inf


def _refuse_second_step(
    measurement: Dma,
    table: TitledTable,
    others: Sequence[Dma],
    used: Sequence[TitledTable],
    before: float,
    own: bool,
) -> None:
    """Raises `NoStep` for a step of stress or strain that remembers one before it in
    the file, which ended at `before` [s]; the user may give each a temperature of its
    `own`.
    """
    if _ended(measurement) == -np.inf:
        return
    line = table.rows[0].line
    kelvin = measurement.time_temperature[0]
    above = [
        one
        for one, rows in zip(others, used, strict=True)
        if one.response == measurement.response and rows.rows[-1].line < line
    ]
    apart = [own or abs(one.time_temperature[0] - kelvin) > _APART for one in above]
    if measurement.time.min() > before > 0:
        on = f"the times from line {line} on count on from the step before"
        advice = "write seconds since their own step"
        if apart and apart[-1]:
            raise InputError(
                argument="path",
                accepted="a file whose times count from their own step",
                hint=f"{on}, at another temperature: {advice}",
            )
        # the same step with other intervals goes on where it was
        if (
            not above
            or measurement.relaxation[0] * (1 - BACK) > above[-1].relaxation[-1]
        ):
            raise NoStep(table, on, advice, _ended(measurement))
    elif not all(apart):
        raise NoStep(
            table,
            f"the rows from line {line} on are a second {measurement.response} at one "
            "temperature, which remembers the first",
            "give it alone, in a file of its own",
            _ended(measurement),
        )


def _lack(table: TitledTable, columns: Understood, specimen: Specimen) -> str:
    """What is missing to make a measurement of a table, in words; empty where nothing
    is.
    """
    roles = (
        {one.role for one in columns.all}
        | columns.constants.keys()
        | table.fixed.keys()
    )
    lack = lacking(roles)
    only_storage = {"frequency", "storage"} <= roles and not {
        "absolute",
        "loss",
    } & roles
    if not lack or not only_storage:
        return lack
    titled = {head.place for head in table.heads if head.title}
    if specimen.storage_only or titled <= {one.place for one in columns.all}:
        return ""
    return lack + "; " + _ALONE


def _refuse_rows_below(table: TitledTable, before: TitledTable) -> None:
    """Raises `InputError` for rows, below a table that is read, whose titles are not
    understood: as wide, they may belong to it.
    """
    line = table.rows[0].line
    if len(table.heads) == len(before.heads) and line > before.rows[0].line:
        titles = ", ".join(head.title for head in table.heads)[:80]
        raise InputError(
            argument="path",
            accepted="a table whose rows stand below titles that are understood",
            hint=f"those from line {line} on are below {titles!r}: leave them out, or "
            "name the columns",
        )


def _of_kind(
    table: TitledTable, columns: Sequence[Column], kind: str | None
) -> list[Column]:
    """The columns without moduli of the other kind. Raises `InputError` where nobody
    says which kind is meant.
    """
    letters = {
        column.letter for column in columns if column.quantity.kind == "modulus"
    } - {""}
    if len(letters) < 2:
        return list(columns)
    if kind is None:
        raise InputError(
            argument="kind",
            got=None,
            accepted="given for a file with moduli of shear and of tension",
            hint=f"{table.name!r} has both: give " + _OF_KIND,
        )
    of_kind = [
        column
        for column in columns
        if column.letter in ("", "G" if kind == "shear" else "E")
    ]
    if lacking({column.role for column in of_kind}):
        raise InputError(
            argument="kind",
            got=kind,
            accepted=f"one of which {table.name!r} has storage and loss modulus",
            hint="it has only one of both",
        )
    return of_kind


def _measurement(
    layout: Format,
    table: TitledTable,
    columns: Understood,
    options: _Options,
) -> Dma:
    """The measurement in a table. Raises `InputError`."""
    name = table.name
    chosen, needed = _chosen(table, columns, options)
    table = table._replace(fixed={**table.fixed, **columns.constants})
    kind = _kind(table, chosen, options.kind, layout)
    response, rest = "relaxation", ()
    if needed[0] == "time":
        beside = {one.role: one for one in reversed(columns.all)} | chosen
        table, response, rest = while_held(
            table, beside, needed[1], kind, options.specimen.ramp or 0.0
        )
        for role in {"stress", "strain"} & chosen.keys():
            column = chosen[role]
            if not column.log and np.nanmedian(table.column(column.place)) < 0:
                chosen[role] = column._replace(sign=-1.0)
    values, good, bad = measured(table, chosen)
    if not good.any():
        why = (
            f"no row below {next(iter(chosen.values())).title!r} is a measurement "
            f"({bad[0]})"
        )
        if needed[0] == "time":
            raise NoStep(table, why, "")
        raise InputError(
            argument="path",
            accepted="a file with rows that are a measurement",
            hint=why,
        )
    for role in needed:
        if role not in values:
            values[role] = np.full(int(good.sum()), table.fixed.get(role, np.nan))
    columns_taken = taken(table, chosen)
    if "temperature" in table.fixed:
        columns_taken += "; temperature from the text"
    none = np.zeros(0)
    blank = Dma(
        none,
        none,
        none,
        none,
        kind,
        units=units_of(table, chosen),
        warnings=(
            *rest,
            *left_out(name, bad, "bad_rows and in the master curve's table"),
        ),
        bad_rows=tuple(bad),
        source=name,
        shifted=layout.shifted,
        columns=(columns_taken,),
        places={role: column.place + 1 for role, column in chosen.items()},
    )
    if needed[0] == "time":
        return _over_time(blank, values, response, options.specimen)
    return _over_frequency(blank, values, needed[1:-2], options.specimen)


def _chosen(
    table: TitledTable, columns: Understood, options: _Options
) -> tuple[dict[str, Column], tuple[str, ...]]:
    """One column for each role that is needed, and these roles. Raises `InputError`."""
    candidates = [
        *_of_kind(table, columns.read, options.kind),
        *columns.named.values(),
    ]
    table = table._replace(fixed={**table.fixed, **columns.constants})
    roles = {*(one.role for one in candidates), *table.fixed}
    wanted = needed_roles(roles, columns.of_user)
    chosen = choose([one for one in candidates if one.role in wanted], table)
    if not {"loss", "tangent"} & columns.of_user:
        refuse_contradiction(table, chosen, candidates)
    needed = needed_roles({*chosen, *table.fixed}, set())
    chosen = {role: chosen[role] for role in needed if role in chosen}
    if (
        needed[0] == "frequency"
        and "strain" in chosen
        and not _is_strain(table, chosen["strain"])
    ):
        del chosen["strain"]
    return chosen, needed


def _over_frequency(
    blank: Dma,
    values: Mapping[str, np.ndarray],
    pair: Sequence[str],
    specimen: Specimen,
) -> Dma:
    """Storage and loss modulus from a pair of columns; with one column the storage
    modulus alone. `blank` is the measurement without its numbers.
    """
    rate, temperature = values["frequency"], values["temperature"]
    if len(pair) == 1:
        message = (
            f"{blank.source}: there is no loss modulus: the fit takes it from the "
            "spectrum, with a wide band."
        )
        return replace(
            blank,
            time=1 / rate,
            relaxation=values["storage"],
            time_temperature=temperature,
            response="storage",
            warnings=(*blank.warnings, message),
        )
    first, second = values[pair[0]], values[pair[1]]
    if pair[0].startswith("stiffness"):
        scale = _scale(blank.source, specimen)
        first = first * scale
        second = second * scale if pair[1].startswith("stiffness") else second
    storage, loss = _moduli(first, second, pair, rate)
    return replace(
        blank,
        temperature=temperature,
        omega=rate,
        storage=storage,
        loss=loss,
        strain=values["strain"],
    )


def _over_time(
    blank: Dma,
    values: Mapping[str, np.ndarray],
    response: str,
    specimen: Specimen,
) -> Dma:
    """Relaxation or creep. `blank` is the measurement without its numbers."""
    ramp, name = specimen.ramp or 0.0, blank.source
    if "stress" in values:
        modulus = values["stress"] / values["strain"]
    else:
        modulus = 1 / values["creep"] if response == "creep" else values["relaxation"]
    time, temperature = values["time"], values["temperature"]
    if ramp and response == "creep":
        raise InputError(
            argument="ramp", got=ramp, accepted=f"left out for creep, as in {name!r}"
        )
    good = np.isfinite(modulus) & (time > ramp)
    if not good.any():
        raise InputError(
            argument="ramp",
            got=ramp,
            accepted=f"shorter than the times of {name!r}, which count from its start",
        )
    message = (
        f"{name}: {int((~good).sum())} points within the ramp of {ramp:g} s left out."
    )
    return replace(
        blank,
        time=time[good],
        relaxation=modulus[good],
        time_temperature=temperature[good],
        response=response,
        ramp=ramp,
        warnings=blank.warnings if good.all() else (*blank.warnings, message),
    )


def _scale(name: str, specimen: Specimen) -> float:
    """What turns a stiffness into a modulus: length over section."""
    if specimen.area is None or specimen.length is None:
        raise InputError(
            argument="area",
            got=specimen.area,
            accepted="given, as length, for columns of stiffness",
            hint=f"those of {name!r}: give the specimen's section and length (in "
            "shear: height), as "
            + advise("area=1e-4, length=0.02", {"area": "100 mm2", "length": "20 mm"}),
        )
    return specimen.length / specimen.area


def _is_strain(table: TitledTable, column: Column) -> bool:
    """Whether a column of strain is wanted: in a unit of strain, or, without one,
    different from row to row.
    """
    if column.unit:
        return column.known
    numbers = table.column(column.place)
    numbers = numbers[numbers > 0]
    return bool(numbers.size and numbers.max() > 1.5 * numbers.min())


def _moduli(
    first: np.ndarray, second: np.ndarray, pair: Sequence[str], omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Storage and loss modulus from two columns in SI units: G* = |G*| e^(i delta) =
    1/J* = i omega eta*.
    """
    if pair[0] == "viscosity_real":
        return omega * second, omega * first
    if pair[1] in ("phase", "tangent"):
        if pair[0] == "loss":
            return first / second, first
        tangent = np.tan(second) if pair[1] == "phase" else second
        size = first if pair[0].endswith("storage") else first / np.hypot(1.0, tangent)
        first, second = size, size * tangent
    if pair[0].startswith("compliance"):
        square = first**2 + second**2
        return first / square, second / square
    return (
        (first * omega, second * omega) if pair[0] == "viscosity" else (first, second)
    )


def _kind(
    table: TitledTable,
    chosen: Mapping[str, Column],
    kind: Kind | None,
    layout: Format,
) -> Kind:
    letters = {column.letter for column in chosen.values()} - {""}
    if any(
        re.search("torque|drehmoment", head.title, re.IGNORECASE)
        for head in table.heads
    ):
        letters.add("G")  # torsion is shear
    kinds: dict[str, Kind] = {"G": "shear", "E": "tensile"}
    kind_of_file = kinds.get("".join(letters)) if letters else layout.kind
    if kind_of_file and kind and kind_of_file != kind:
        raise InputError(
            argument="kind",
            got=kind,
            accepted=f"{kind_of_file!r}, as the columns of {table.name!r} say",
        )
    known = kind_of_file or kind
    if len(letters) > 1 or known is None:
        raise InputError(
            argument="kind",
            got=None,
            accepted="given where the file does not say whether its moduli are of "
            "shear or tension",
            hint=f"{table.name!r} does not: give " + _OF_KIND,
        )
    return known
