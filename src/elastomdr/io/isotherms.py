"""The isotherms in a file of moduli, and their temperatures: in a column, in titles, in
the text above them, in the name of the file, or given by the user.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..checks import as_float64, in_kelvin
from ..errors import InputError, advise
from ..units.registry import to_si
from .columns import named_columns, understand
from .data import COLDEST, Dma, describe_list, in_strain_sweep, untold
from .quantities import QUANTITIES, lacking
from .sheets import Row
from .tables import Head, TitledTable, refuse_many

if TYPE_CHECKING:
    from .._types import ArrayLike

_STEP = (
    r"(step|schritt|segment|interval|intervall|block|set|sweep|(mess)?abschnitt)"
    r"( (no\.?|nr\.?|number|index))?"
)
_HOLD = 4  # points at one frequency and temperature that make a sweep of something else
_HELD = 3.0  # range of temperatures within it [K]
_SWEPT = 1.5  # ratio of the highest to the lowest frequency of a sweep
_SAME = 0.5  # [K], within which two temperatures are one, rounded
_LAST = 10**9  # behind all columns
# that may stand once, before the columns of several isotherms
_SHARED = {"time", "frequency"}
_UNIT = r"deg ?[CFcf]|°\s?[CF]|º\s?[CF]|℃|℉|K|C|kelvin|celsius"
_BLOCKS = (
    "step|block|set|sweep|run|curve|interval|segment|abschnitt|messung|experiment|stage"
)
# a remark with nothing but the temperature, and what may number the block
_TEMPERATURE = re.compile(
    rf"[^\w+-]*(?:(?:{_BLOCKS}|frequency sweep)(?:\s*\d+(?!\d))?[^\w+-]*)?"
    r"(?:(?:t|temp\.?|temperatur|(?:(?:sample|test) )?temp(?:erature)?|isotherme?|온도)"
    r"\s*(?:at|of|bei)?|at|bei)?"
    rf"\s*[=:,;]?\s*(?<!\d)([+-]?\d+(?:[.,]\d+)?)\s*\[?\(?({_UNIT})\W*",
    re.IGNORECASE,
)
_BARE = re.compile(  # likewise without a unit
    r"((?:t|temp\.?|temperatur|(?:sample )?temperature|isotherme?)\s*[=:]?\s*)?"
    r"([+-]?\d+(?:[.,]\d+)?)",
    re.IGNORECASE,
)
# "Run 3 C" is its number
_NUMBERED = re.compile(rf"\W*(?:{_BLOCKS})\s*\d+\s*[CK]\b", re.IGNORECASE)
_VALUE = rf"(?:T\s*=\s*)?([+-]?\d+(?:[.,]\d+)?)\s*_?({_UNIT}|k?Hz|rad/s)(?![\w/])"
# in titles: E' (-40 °C) [MPa], E' [MPa] @ -40 °C, E'_-40C, E', 10 Hz, MPa
_CONDITIONS = (
    re.compile(rf"\s*[(\[]\s*{_VALUE}\s*[)\]]"),
    re.compile(rf"[\s,;_@]+(?:(?:at|bei|@)\s*)?{_VALUE}"),
)
_RATE = re.compile(
    r"[^\w]*(?:(?:step|block|sweep|set)\s*\d*[^\w]*)?"
    r"(?:f|freq\.?|frequency|frequenz)\s*[=:,;]?\s*(\d+(?:[.,]\d+)?)\s*[\[(]?"
    r"(k?Hz|rad/s)\W*",
    re.IGNORECASE,
)
# of a file
_NAME = re.compile(
    rf"(?<![A-Za-z0-9.,])([+-]?\d+(?:[.,]\d+)?)[ _]?({_UNIT})(?![A-Za-z0-9])"
)
_DASH = re.compile(r"[A-Za-z0-9)]-\d+(?:[.,]\d+)?[ _]?(?:deg ?C|°C|C|K)(?![A-Za-z0-9])")
# that a title with a condition does not hold
_CONDITION_ROLES = ("frequency", "temperature", "time")


def isotherms(
    table: TitledTable, columns: Mapping[str, str | int] | None
) -> list[TitledTable]:
    """The isotherms in a table, each with the temperature that stands in its titles or
    above it; of those side by side only the ones with all the columns that the user
    names.
    """
    parts = [
        isotherm
        for step in _steps(table)
        for condition in _by_condition(step)
        for isotherm in _beside(condition)
    ]
    users = named_columns(columns, table, QUANTITIES)[0].keys()
    if len(parts) < 2 or not users:
        return parts
    complete = [
        candidate
        for candidate in parts
        if named_columns(columns, candidate, QUANTITIES)[0].keys() == users
    ]
    return complete or [table]


def _steps(table: TitledTable) -> list[TitledTable]:
    """A table for each number in a column of steps; or the table."""
    for head in table.heads:
        if not re.fullmatch(_STEP, head.title.strip(), re.IGNORECASE):
            continue
        numbers = table.column(head.place)
        steps = np.unique(numbers[np.isfinite(numbers)])
        if (
            1 < steps.size <= len(table.rows) / 3
            and (steps == np.round(steps)).all()
            and np.isfinite(numbers).all()
        ):
            refuse_many(steps.size)
            rows: dict[float, list[Row]] = {step: [] for step in steps.tolist()}
            for row, step in zip(table.rows, numbers.tolist(), strict=True):
                rows[step].append(row)
            return [table._replace(rows=own) for own in rows.values()]
    return [table]


def _by_condition(table: TitledTable) -> list[TitledTable]:
    """A table for each temperature or frequency that stands in titles, as in "E' (-40
    degC) [MPa]"; or the table.
    """
    groups: dict[tuple[str, float], list[Head]] = {}
    shared: list[Head] = []
    for head in table.heads:
        condition = _condition(head.title)
        if condition is not None:
            key, title = condition
            bare = head._replace(title=title)
            column = understand(bare, QUANTITIES)
            if column is not None and column.role not in _CONDITION_ROLES:
                groups.setdefault(key, []).append(bare)
                continue
        shared.append(head)
    if not groups:
        return [table]
    return [
        table._replace(heads=[*shared, *heads], fixed={**table.fixed, **dict([key])})
        for key, heads in groups.items()
    ]


def _condition(title: str) -> tuple[tuple[str, float], str] | None:
    """The temperature [K] or frequency [rad/s] in a title, and the title without it."""
    matches = (pattern.search(title) for pattern in _CONDITIONS)
    match = next(filter(None, matches), None)
    if match is None:
        return None
    for kind in ("temperature", "frequency"):
        if si := to_si(match[2], kind):
            rest = f"{title[: match.start()]} {title[match.end() :]}"
            empty_brackets = r"\(\s*\)|\[\s*\]|[(\[]\s*(?=[(\[])"
            rest = re.sub(empty_brackets, " ", rest).replace(" /", "/")
            rest = re.sub(r"\s*,\s*(?=[,\[(]|$)|[\s_@]+$", "", rest).strip()
            return (kind, _decimal(match[1]) * si[0] + si[1]), rest
    return None


def _decimal(digits: str) -> float:
    """A number with a decimal point or comma."""
    return float(digits.replace(",", "."))


def _beside(table: TitledTable) -> list[TitledTable]:
    """A table for each isotherm where the same columns repeat; or the table."""
    columns = [
        column for head in table.heads if (column := understand(head, QUANTITIES))
    ]
    roles = [column.role for column in columns]
    if not {"frequency", "time"} & {*roles} and "frequency" not in table.fixed:
        table = table._replace(fixed={**table.fixed, **_rate_above(table)})
    repeated = _repeated(roles)
    without = "temperature" not in roles
    if repeated is None:
        above = _between(table, 0, _LAST) if without else {}
        if without and not above and (bare := _bare(table, 1)):
            above = {"temperature": bare[0]}
        return [table._replace(fixed={**above, **table.fixed})]
    once, period = repeated
    starts = [columns[i].place for i in range(once, len(columns), period)]
    heads = {head.place: head for head in table.heads}
    shared = [heads[column.place] for column in columns[:once]]
    isotherms = []
    bare = _bare(table, len(starts)) if without else []
    for i, (start, end) in enumerate(zip(starts, [*starts[1:], _LAST], strict=True)):
        own_heads = [
            heads[column.place] for column in columns if start <= column.place < end
        ]
        first = 0 if start == starts[0] else start
        above = _between(table, first, end) if without else {}
        above = above or ({"temperature": bare[i]} if bare else {})
        rows = [row for row in table.rows if _has_cell(row, own_heads)]
        isotherms.append(
            table._replace(
                heads=[*shared, *own_heads], rows=rows, fixed={**above, **table.fixed}
            )
        )
    if once and not all("temperature" in one.fixed for one in isotherms):
        return [table]  # two samples, or raw and smoothed values
    return [one for one in isotherms if one.rows]


def _has_cell(row: Row, heads: Sequence[Head]) -> bool:
    """Whether a row has something in one of the columns."""
    return any(row.cells[h.place : h.place + 1] not in ([], [""]) for h in heads)


def _between(table: TitledTable, first: int, end: int) -> dict[str, float]:
    """The temperature in the text above some columns. Raises `InputError` where there
    are two.
    """
    temperatures = {
        temperature: remark
        for row in table.above
        for place, temperature, remark in _above(row.cells)
        if first <= place < end
    }
    if temperatures and max(temperatures) - min(temperatures) > _SAME:
        raise InputError(
            argument="path",
            accepted="a table with one temperature above its columns",
            hint=f"{' and '.join(map(repr, temperatures.values()))} stand above the "
            "same: leave the one that is theirs",
        )
    return {"temperature": min(temperatures)} if temperatures else {}


def _bare(table: TitledTable, count: int) -> list[float]:
    """The temperatures [K] of `count` isotherms side by side from a row right above
    their titles with a number for each, or the same for each of their columns; empty
    where there is none. Raises `InputError` where nobody gives their unit.
    """
    for row in reversed(table.above):
        cells = [cell.strip() for cell in row.cells if cell]
        label = Head(0, cells[0] if cells else "", "")
        column = understand(label, QUANTITIES)
        labelled = column is not None and column.role == "temperature"
        found = [_BARE.fullmatch(_with_minus(cell)) for cell in cells[labelled:]]
        numbers = [_decimal(match[2]) for match in found if match]
        each, rest = divmod(len(numbers), count)
        # one number alone may be anything, unless its name is beside it
        sure = count > 1 or labelled or all(match and match[1] for match in found)
        if len(numbers) != len(found) or rest or not each or not sure:
            continue
        if any(numbers[i] != numbers[i - i % each] for i in range(len(numbers))):
            continue
        unit = (column.unit if column else "") or table.units.get("temperature", "")
        si = to_si(unit, "temperature") if unit else None
        listed = describe_list(np.array(numbers[::each]), unit).strip()
        if si is not None:
            kelvin = [x * si[0] + si[1] for x in numbers[::each]]
            place = f"{table.name}: the temperatures in line {row.line}"
            in_kelvin(place, np.array(kelvin), COLDEST)
            return kelvin
        if count > 1:
            raise InputError(
                argument="path",
                accepted="a table whose temperatures have a unit",
                hint=f"those in line {row.line}, {listed}, above {count} isotherms "
                "have none: give degC or K, as "
                + advise("temperature_unit=UNIT", {"temperature_unit": "UNIT"})
                + ", or write it behind each",
            )
    return []


def _rate_above(table: TitledTable) -> dict[str, float]:
    """The frequency [rad/s] in the last line above a table that says one and nothing
    else.
    """
    for row in reversed(table.above):
        for remark in (" ".join(cell for cell in row.cells if cell), *row.cells):
            match = _RATE.fullmatch(remark.strip())
            if match and (si := to_si(match[2], "frequency")):
                return {"frequency": _decimal(match[1]) * si[0]}
    return {}


def _repeated(roles: Sequence[str]) -> tuple[int, int] | None:
    """How many columns stand once, and how many repeat behind them; None where none
    do.
    """
    for once in range(len(roles)):
        if not set(roles[:once]) <= _SHARED:
            return None
        rest = roles[once:]
        for period in range(1, len(rest) // 2 + 1):
            whole = not lacking({*roles[:once], *rest[:period]}) and {
                *rest[:period]
            }.isdisjoint(roles[:once])
            if whole and list(rest) == list(rest[:period]) * (len(rest) // period):
                return once, period
    return None


def _above(cells: Sequence[str]) -> list[tuple[int, float, str]]:
    """The temperatures that a row of remarks gives, with their columns: one in each
    cell, or that of the whole row.
    """
    whole = [cell for cell in cells if cell]
    # a decimal comma may have been cut
    ways = ([",".join(whole)], cells, [" ".join(whole)])
    return next(
        (temperatures for way in ways if (temperatures := list(_temperatures(way)))), []
    )


def _temperatures(cells: Sequence[str]) -> Iterator[tuple[int, float, str]]:
    for place, cell in enumerate(cells):
        signed = _with_minus(cell.strip())
        if not signed or len(signed) >= 80 or _NUMBERED.match(signed):
            continue
        match = _TEMPERATURE.fullmatch(signed)
        si = to_si(match[2].replace(" ", ""), "temperature") if match else None
        if match and si and (temperature := _decimal(match[1]) * si[0] + si[1]) > 0:
            yield place, temperature, signed


def _with_minus(title: str) -> str:
    """A text with hyphens in place of signs of subtraction and dashes."""
    return re.sub("[\u2212\u2013]", "-", title)


def without_holds(parts: list[Dma]) -> list[Dma]:
    """The measurements without steps at one frequency and temperature beside sweeps of
    frequency.

    Nobody says what was changed in them: strain, time or preload. Where the strain is
    known, the fit sorts them out.
    """
    holds = [isotherm for isotherm in parts if _is_hold(isotherm)]
    swept = any(
        isotherm.omega.size > 1 and isotherm.omega.max() > _SWEPT * isotherm.omega.min()
        for isotherm in parts
    )
    if not holds or not swept:
        return parts
    kept = [isotherm for isotherm in parts if isotherm not in holds]
    warning = (
        f"{holds[0].source}: {sum(isotherm.size for isotherm in holds)} points in "
        "steps "
        "at one frequency and temperature are left out: a sweep of something that no "
        "column holds, such as strain or time."
    )
    return [replace(kept[0], warnings=(*kept[0].warnings, warning)), *kept[1:]]


def _is_hold(measurement: Dma) -> bool:
    if (
        measurement.omega.size < _HOLD
        or np.isfinite(measurement.strain).any()
        or measurement.time.size
    ):
        return False
    one_rate = measurement.omega.max() < 1.01 * measurement.omega.min()
    # NaN where no temperature is known: not held
    return bool(one_rate and np.ptp(measurement.temperature) < _HELD)


def with_temperatures_of_names(parts: list[Dma]) -> list[Dma]:
    """The measurements with the temperatures that the names of their files give to
    those without, one to each file.

    A dash right behind a word ("rubber-20C") may be a minus or not: such names say
    nothing.
    """
    sources = [isotherm.source for isotherm in parts]
    completed = []
    for isotherm in parts:
        stem = _with_minus(Path(isotherm.source).stem)
        temperatures = _NAME.findall(stem)
        unclear = len(temperatures) != 1 or _DASH.search(stem)
        known = np.isfinite([*isotherm.temperature, *isotherm.time_temperature]).any()
        if not known and not unclear and sources.count(isotherm.source) == 1:
            number, unit = temperatures[0]
            factor, offset = to_si(unit.replace(" ", ""), "temperature") or (1.0, 0.0)
            temperature = _decimal(number) * factor + offset
            isotherm = _with_temperature(
                isotherm, temperature, "from the name of the file"
            )
        completed.append(isotherm)
    return completed


def _with_temperature(measurement: Dma, temperature: float, source: str) -> Dma:
    """A measurement at a temperature, with a word on where that comes from."""
    words = f"temperature {temperature - 273.15:g} degC {source}"
    columns = tuple(f"{column}; {words}" for column in measurement.columns)
    return replace(measurement.at(temperature), columns=columns)


def with_given_temperatures(
    parts: list[Dma], temperature: ArrayLike | None
) -> list[Dma]:
    """The measurements with the temperatures that the user gives to those without.
    Raises `InputError` for as many as do not fit.
    """
    without = [not isotherm.has_temperatures for isotherm in parts]
    if temperature is None:
        return [
            _warned(isotherm) if lacks else isotherm
            for isotherm, lacks in zip(parts, without, strict=True)
        ]
    given = np.atleast_1d(as_float64("temperature", temperature))
    if given.ndim > 1 or not given.size:
        raise InputError(
            argument="temperature", got=given, accepted="one, or a list of them"
        )
    in_kelvin("temperature", given, COLDEST)
    count = sum(without)
    if not count:
        temperatures = np.concatenate([isotherm.temperatures for isotherm in parts])
        celsius = np.unique((temperatures - 273.15).round(1))
        raise InputError(
            argument="temperature",
            got=given,
            accepted=f"left out: the files say {describe_list(celsius, 'degC')}",
        )
    if len(given) not in (1, count):
        raise InputError(
            argument="temperature",
            got=given,
            accepted=f"one number, or one for each of the {count} isotherms without",
        )
    left = iter(np.broadcast_to(given, count).tolist())
    return [
        _with_temperature(isotherm, next(left), "as given") if lacks else isotherm
        for isotherm, lacks in zip(parts, without, strict=True)
    ]


def _warned(isotherm: Dma) -> Dma:
    """A measurement without temperatures, with a warning; a sweep of strain, which
    nobody shifts, needs none.
    """
    if isotherm.omega.size and in_strain_sweep(isotherm).all():
        return isotherm
    unknown = ~np.isfinite(isotherm.temperatures)
    rates = np.concatenate([isotherm.omega, 1 / isotherm.time])[unknown]
    warning = (
        f"{isotherm.source}: there is no temperature, which shifting needs: "
        + untold(rates)
    )
    return replace(isotherm, warnings=(*isotherm.warnings, warning))
