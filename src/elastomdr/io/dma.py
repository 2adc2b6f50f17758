"""`em.read_dma`: dynamic moduli and relaxation from files into SI arrays."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..checks import in_si, one_of, plain, positive
from ..errors import InputError, advise, warn
from .columns import (
    Column,
    Understood,
    checked_units,
    choose,
    left_out,
    measured,
    missing,
    naming,
    refuse_contradiction,
    refuse_wide,
    taken,
    understand_table,
    unit_of,
)
from .data import KINDS, Dma, FitWarning, join
from .isotherms import (
    isotherms,
    with_given_temperatures,
    with_temperatures_of_names,
    without_holds,
)
from .quantities import QUANTITIES, lacking, needed_roles, proportional
from .sheets import is_frame, read_sheet, sheet_of_frame
from .tables import Format, TitledTable, format_of

if TYPE_CHECKING:
    from .._types import ArrayLike, Frame, Kind

    Source = str | os.PathLike[str] | Frame

# ratio of the largest to the smallest stress (or strain) that counts as held
_CONSTANT = 1.05
_STEP = 0.25  # change from row to row that ends a step, less being a drift
_FEWEST_HELD = 5  # rows
_BACK = 0.25  # share by which a compliance falls, or a modulus rises, after its step
_RINGING = 0.1  # share of rows up to which this is the ringing of an instrument
_APART = 0.5  # [K], within which two temperatures are one
_ALONE = (
    f"if it was not measured, give {advise('storage_only=True', {'storage_only': ''})}"
)


_OF_KIND = " or ".join(
    advise(f"kind={kind!r}", {"kind": kind}) for kind in ("shear", "tensile")
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
    if columns is not None and not isinstance(columns, Mapping):
        raise InputError(
            f"columns must be a dict such as {{'storage': 'Modulus 1'}}, got "
            f"{columns!r}."
        )
    units = checked_units(
        {
            "frequency": frequency_unit,
            "modulus": modulus_unit,
            "temperature": temperature_unit,
            "time": time_unit,
        },
    )
    specimen = _specimen(area, length, ramp, storage_only)
    options = _Options(kind, columns, units, specimen)
    unmet = dict(columns or {})
    parts = [
        measurement
        for source in _checked_sources(path_or_paths)
        for measurement in _read(source, options, unmet)
    ]
    if unmet:
        raise InputError(
            f"columns must name titles or numbers of columns, got {unmet}, which no "
            "file has."
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


def _checked_sources(path_or_paths: object) -> list[Any]:
    """Files or tables in memory. Raises `InputError`."""
    sources = [path_or_paths] if _is_source(path_or_paths) else path_or_paths
    if (
        not isinstance(sources, Sequence)
        or not sources
        or not all(map(_is_source, sources))
    ):
        raise InputError(
            "path_or_paths must be a file or a list of files, or tables of pandas or "
            f"polars in their place, got {path_or_paths!r}."
        )
    files = [str(one) for one in sources if not is_frame(one)]
    repeated = sorted({name for name in files if files.count(name) > 1})
    if repeated:
        raise InputError(
            f"path_or_paths must name every file once, got {', '.join(repeated)} "
            "twice or more."
        )
    return list(sources)


def _is_source(value: object) -> bool:
    return isinstance(value, (str, os.PathLike)) or is_frame(value)


def _specimen(
    area: float | None, length: float | None, ramp: float | None, storage_only: bool
) -> Specimen:
    given = {"area": area, "length": length, "ramp": ramp}
    numbers = {
        name: None if value is None else float(plain(name, value))
        for name, value in given.items()
    }
    for name, number in numbers.items():
        if number is not None:
            positive(name, number)
    return Specimen(
        numbers["area"], numbers["length"], numbers["ramp"], bool(storage_only)
    )


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
    refused: list[_NoStep] = []
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
            _refuse_second_step(measurement, table, measurements, used, before)
        except _NoStep as error:
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
        raise InputError(missing(name, known, lack, parts))
    without = [i for i, one in enumerate(measurements) if not one.has_temperatures]
    if 0 < len(without) < len(measurements):
        raise InputError(
            f"{name}: the rows from line {used[without[0]].rows[0].line} on have no "
            "temperature, and others have: write it above them, as 'T = -20 degC', or "
            "into a column."
        )
    return measurements


class _NoStep(InputError):
    """Rows over time that are no response to one step of stress or strain."""

    def __init__(
        self, table: TitledTable, why: str, advice: str, ended: float = -np.inf
    ):
        super().__init__(f"{table.name}: {why}{advice and ': '}{advice}.")
        self.why = why
        self.ended = ended  # their last time [s]


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
) -> None:
    """Raises `_NoStep` for a step of stress or strain that remembers one before it in
    the file, which ended at `before` [s].
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
    apart = [abs(one.time_temperature[0] - kelvin) > _APART for one in above]
    if measurement.time.min() > before > 0:
        on = f"the times from line {line} on count on from the step before"
        advice = "write seconds since their own step"
        if apart and apart[-1]:
            raise InputError(f"{table.name}: {on}, at another temperature: {advice}.")
        # the same step with other intervals goes on where it was
        if (
            not above
            or measurement.relaxation[0] * (1 - _BACK) > above[-1].relaxation[-1]
        ):
            raise _NoStep(table, on, advice, _ended(measurement))
    elif measurement.response == "creep" and not all(apart):
        raise _NoStep(
            table,
            f"the rows from line {line} on are a second creep at one temperature, "
            "which remembers the first",
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
    return f"{lack}; {_ALONE}"


def _refuse_rows_below(table: TitledTable, before: TitledTable) -> None:
    """Raises `InputError` for rows, below a table that is read, whose titles are not
    understood: as wide, they may belong to it.
    """
    line = table.rows[0].line
    if len(table.heads) == len(before.heads) and line > before.rows[0].line:
        titles = ", ".join(head.title for head in table.heads)[:80]
        raise InputError(
            f"{table.name}: the rows from line {line} on stand below titles that are not "
            f"understood, {titles!r}: leave them out, or name the columns."
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
            f"{table.name}: the file has moduli of shear and of tension: give {_OF_KIND}."
        )
    of_kind = [
        column
        for column in columns
        if column.letter in ("", "G" if kind == "shear" else "E")
    ]
    if lacking({column.role for column in of_kind}):
        raise InputError(
            f"{table.name}: the file has no storage and loss modulus of kind {kind!r}, "
            "only one of "
            "both."
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
        table, response, rest = _while_held(table, beside, needed[1], options)
    values, good, bad = measured(table, chosen)
    if not good.any():
        why = (
            f"no row below {next(iter(chosen.values())).title!r} is a measurement "
            f"({bad[0]})"
        )
        if needed[0] == "time":
            raise _NoStep(table, why, "")
        raise InputError(f"{name}: {why}.")
    for role in needed:
        if role not in values:
            values[role] = np.full(int(good.sum()), table.fixed.get(role, np.nan))
    written = {
        role: _unit_in_words(column, table.units) for role, column in chosen.items()
    }
    columns_taken = taken(table, chosen, written)
    if "temperature" in table.fixed:
        columns_taken += "; temperature from the text"
    none = np.zeros(0)
    blank = Dma(
        none,
        none,
        none,
        none,
        kind,
        units=written,
        warnings=(
            *rest,
            *left_out(name, bad, "bad_rows and in the master curve's table"),
        ),
        bad_rows=tuple(bad),
        source=name,
        shifted=layout.shifted,
        columns=(columns_taken,),
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
        raise InputError(f"ramp must be left out for creep, got {ramp:g} s ({name}).")
    good = np.isfinite(modulus) & (time > ramp)
    if not good.any():
        raise InputError(
            f"{name}: no point is later than the ramp of {ramp:g} s; times count from "
            "its start."
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


def _while_held(
    table: TitledTable,
    columns: Mapping[str, Column],
    measured_as: str,
    options: _Options,
) -> tuple[TitledTable, str, tuple[str, ...]]:
    """The rows of a table over time while the stress (creep) or the strain (relaxation)
    is held, which of both it is, and what is left out, in words.

    What is held is looked for whatever the titles of the other columns say: compliance
    and modulus are columns of flow curves and ramps too. Raises `InputError`.
    """
    count = len(table.rows)
    time = np.arange(float(count))
    if "time" in columns:
        time = columns["time"].of(table, unit_of(table, columns["time"]))
    numbers = _held_numbers(table, columns, measured_as, time)
    kept = [np.flatnonzero(~np.isfinite(time))]  # named later as no measurement
    found: set[str] = set()
    for curve in _curves(time):
        late = curve[time[curve] > (options.specimen.ramp or 0.0)]
        held = {
            response: rows
            for response, values in numbers.items()
            if (rows := late[_run(values[late])]).size
        }
        if not numbers:
            values = table.column(columns[measured_as].place)[late]
            held = {measured_as: late[: _turn(values, measured_as)]}
        if len(held) == 1:
            ((response, rows),) = held.items()
            found.add(response)
            kept += [np.setdiff1d(curve, late), rows]
        elif not found:
            ended = float(np.nanmax(time, initial=0.0))
            raise _NoStep(table, *_not_held([*numbers], bool(held), table), ended)
        else:  # what follows remembers this
            break
    if len(found) > 1:
        raise _NoStep(table, *_not_held([*numbers], False, table))
    (response,) = found
    places = np.sort(np.concatenate(kept))
    if places.size == count:
        return table, response, ()
    line = table.rows[int(np.setdiff1d(np.arange(count), places)[0])].line
    why = (
        f"{'stress' if response == 'creep' else 'strain'} is not held there"
        if numbers
        else f"{measured_as} turns back there, as after another step"
    )
    remark = (
        f"{table.name}: {count - places.size} rows (line {line} on) left out: {why}."
    )
    rows = [table.rows[i] for i in places]
    return table._replace(rows=rows), response, (remark,)


def _held_numbers(
    table: TitledTable,
    columns: Mapping[str, Column],
    measured_as: str,
    time: np.ndarray,
) -> dict[str, np.ndarray]:
    """What must be held for the rows to be a response, by response: the stress in creep,
    the strain in relaxation; empty where no column says it.

    Compliance is strain over stress, modulus stress over strain: the third follows.
    """
    loads = _loads(table, columns, time)
    held = {"creep": "stress", "relaxation": "strain"}
    if measured_as not in held:
        return {way: loads[role] for way, role in held.items() if role in loads}
    if held[measured_as] in loads:
        return {measured_as: loads[held[measured_as]]}
    if not loads or columns[measured_as].log:
        return {}
    ratio = table.column(columns[measured_as].place)
    with np.errstate(divide="ignore", invalid="ignore"):
        return {measured_as: next(iter(loads.values())) / ratio}


def _loads(
    table: TitledTable, columns: Mapping[str, Column], time: np.ndarray
) -> dict[str, np.ndarray]:
    """Numbers in proportion to stress and strain: of their columns, of what the user
    gives for all rows, of a force or torque and a displacement or angle, and of a
    constant rate of strain.
    """
    loads: dict[str, np.ndarray] = {}
    for role in ("stress", "strain"):
        column = columns.get(role)
        if role in table.fixed:
            loads[role] = np.ones(time.size)
        elif column is not None and column.known and not column.log:
            loads[role] = table.column(column.place)
        elif (place := proportional(table, role)) is not None:
            loads[role] = np.abs(table.column(place))
    place = proportional(table, "rate")
    if place is not None and "strain" not in loads:
        rate = np.abs(table.column(place))
        if _run(rate).stop == rate.size:
            loads["strain"] = rate * time
    return loads


def _curves(time: np.ndarray) -> list[np.ndarray]:
    """The rows of each curve, by ascending time: where it turns the next one begins."""
    rows = np.flatnonzero(np.isfinite(time))
    along = np.sign(np.diff(time[rows]))
    if (along < 0).sum() > (along > 0).sum():  # the last time first
        return [curve[::-1] for curve in np.split(rows, np.flatnonzero(along > 0) + 1)]
    return np.split(rows, np.flatnonzero(along < 0) + 1)


def _not_held(runs: Sequence[str], held: bool, table: TitledTable) -> tuple[str, str]:
    """Why rows over time are no response to one step, and what to do, in words."""
    if len(runs) > 1:
        said = "are both constant" if held else "both vary"
        what = f"stress and strain {said}"
        advice = (
            f"give the one that was held, as {naming({'stress': '0.1 MPa'})} or "
            f"{naming({'strain': '1 %'})}"
        )
    elif "creep" in runs:
        what, advice = (
            "the stress is not held",
            "leave out the rows while it changes, or give what was held, as "
            f"{naming({'stress': '1 kPa'})}",
        )
    else:
        what = "the strain is not held"
        advice = (
            "leave out the rows while it changes, or give the duration of its ramp, as "
            f"{advise('ramp=2.0', {'ramp': '2 s'})}, or what was held, as "
            f"{naming({'strain': '1 %'})}"
        )
    line = table.rows[0].line
    return (
        f"{what} over time from line {line} on, which is neither creep nor relaxation",
        advice,
    )


def _run(numbers: np.ndarray) -> slice:
    """The numbers, from about the first on, over which numbers hold; none where they do
    not, or drift.

    The first of them may still be on their way; the last is before a step.
    """
    few = min(_FEWEST_HELD, numbers.size)
    for start in range(min(few, numbers.size // 4) + 1):
        level = numbers[start] if numbers.size else 0.0
        if not level > 0:
            continue
        off = np.abs(numbers[start:] / level - 1)
        away = np.flatnonzero(off > _CONSTANT - 1)
        if not away.size:
            return slice(start, numbers.size)
        if away[0] >= few and off[away[0]] > _STEP:
            return slice(start, start + int(away[0]))
    return slice(0, 0)


def _turn(numbers: np.ndarray, response: str) -> int:
    """How many rows there are before a compliance falls, or a modulus rises, by more
    than noise and ringing do.
    """
    known = np.where(np.isfinite(numbers), numbers, 0.0)
    if response == "creep":
        back = known < (1 - _BACK) * np.maximum.accumulate(known)
    else:
        known = np.where(known > 0, known, np.inf)
        largest = known[np.isfinite(known)].max(initial=0.0)
        back = known > np.minimum.accumulate(known) + _BACK * largest
        back &= np.isfinite(known)
    if back.sum() <= _RINGING * numbers.size:
        return numbers.size
    return int(np.argmax(back))


def _scale(name: str, specimen: Specimen) -> float:
    """What turns a stiffness into a modulus: length over section."""
    if specimen.area is None or specimen.length is None:
        raise InputError(
            f"{name}: the columns hold a stiffness; give the specimen's section and "
            "length (in shear: height), as "
            f"{advise('area=1e-4, length=0.02', {'area': '100 mm2', 'length': '20 mm'})}."
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


def _unit_in_words(column: Column, units: Mapping[str, str]) -> str:
    kind = (
        "frequency"
        if column.quantity.kind == "angular frequency"
        else column.quantity.kind
    )
    unit = column.unit or units.get(kind, "")
    return f"{column.log} of {unit}" if column.log else unit


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
            f"{table.name}: whether the moduli are of shear or tension is not in the "
            f"file; give it, as {_OF_KIND}."
        )
    return known
