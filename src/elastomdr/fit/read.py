"""`em.fit.read_dma`: DMA files of several makes into SI arrays."""

import os
import re
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .._runtime import positive, scalar
from ..errors import InputError, closest
from .cells import Row, Sheet, number, read_cells
from .columns import Column, checked_unit, convert, is_unit_row, known_unit, measure, spelled, understand
from .data import KINDS, Dma, FitWarning, join
from .plausible import implausible, inconsistent

_ROLES = ("frequency", "temperature", "storage", "loss", "time", "relaxation")
_FORMAT_UNITS = {"omega": "rad/s", "storage": "pa", "loss": "pa", "relaxation": "pa", "time": "s", "temperature": "degc"}
_NAMED = 6  # bad rows that a warning names one by one


class _Options(NamedTuple):
    kind: str | None
    units: dict[str, str | None]  # by measure
    temperature: float | None
    columns: dict[str, Any]


class _Block(NamedTuple):
    """A header and the rows below it."""

    columns: list[Column]
    rows: list[Row]


def read_dma(
    path: Any,
    *,
    kind: str | None = None,
    frequency_unit: str | None = None,
    modulus_unit: str | None = None,
    temperature_unit: str | None = None,
    time_unit: str | None = None,
    temperature: float | None = None,
    columns: dict[str, Any] | None = None,
) -> Dma:
    """Dynamic moduli or relaxation from a file, or from a list of files that belong together.

    Understands tables in text (comma, semicolon, tab or blank; one or two header rows) and spreadsheets (with the extra
    `excel`), TRIOS exports, Eplexor sheets, RepTate's .osc and .tts. Units come from the file or from the arguments
    `frequency_unit` ("Hz", "rad/s"), `modulus_unit` ("Pa", "MPa", ...), `temperature_unit` ("degC", "K"), `time_unit`
    ("s"), which fill in what the file leaves out and never overrule it; `kind` ("shear", "tensile") likewise.
    `temperature` [K] is that of all points where the file has no such column. `columns` names columns that are not
    recognised, as {"storage": "Modulus 1"} or by number from 1. Rows that are no measurement are left out, counted and
    named in a `FitWarning` and in the result; so is what looks implausible. Raises `InputError` for what cannot be
    read, and for units that nobody gives.
    """
    options = _options(kind, frequency_unit, modulus_unit, temperature_unit, time_unit, temperature, columns)
    if isinstance(path, (str, os.PathLike)):
        found = _read(Path(path), options)
    elif isinstance(path, Sequence) and path and all(isinstance(one, (str, os.PathLike)) for one in path):
        found = join(*(_read(Path(one), options) for one in path))
    else:
        raise InputError(f"path must be a file or a list of files, got {path!r}.")
    for text in found.warnings:
        warnings.warn(text, FitWarning, stacklevel=2)
    return found


def _options(kind, frequency, modulus, temperature_unit, time, temperature, columns) -> _Options:
    if kind is not None and kind not in KINDS:
        raise InputError(f"kind must be 'shear' or 'tensile', got {kind!r}.")
    units = {
        "frequency": checked_unit("frequency_unit", frequency, "frequency"),
        "modulus": checked_unit("modulus_unit", modulus, "modulus"),
        "temperature": checked_unit("temperature_unit", temperature_unit, "temperature"),
        "time": checked_unit("time_unit", time, "time"),
    }
    if temperature is not None:
        temperature = float(scalar("temperature", temperature))
        positive("temperature", temperature)
    columns = {} if columns is None else columns
    if not isinstance(columns, dict):
        raise InputError(f"columns must be a dict such as {{'storage': 'Modulus 1'}}, got {columns!r}.")
    for role in columns:
        if role not in _ROLES:
            raise InputError(f"columns must name {', '.join(_ROLES)}, got {role!r}.{closest(str(role), _ROLES)}")
    return _Options(kind, units, temperature, columns)


def _read(path: Path, options: _Options) -> Dma:
    sheet = read_cells(path)
    try:
        parameters = _parameters(sheet)
        if parameters is not None or path.suffix.lower() in (".osc", ".tts"):
            return _reptate(path, sheet, parameters or {}, options)
        blocks = list(_blocks(sheet.rows, options))
        if not blocks:
            raise InputError(_no_columns(sheet.rows))
        return join(*(_measurements(path, block, options, {}) for block in blocks))
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(path.name) else f"{path.name}: {text}") from error


def _blocks(rows: list[Row], options: _Options) -> Iterator[_Block]:
    """Headers that are understood, each with the rows below it up to the next header."""
    found: _Block | None = None
    skip = -1
    for i, row in enumerate(rows):
        if i == skip:
            continue
        if row.line == 0:  # the end of a sheet
            if found is not None and found.rows:
                yield found
            found = None
            continue
        if sum(number(cell) is not None for cell in row.cells) >= 2:
            if found is not None:
                found.rows.append(row)
            continue
        after = rows[i + 1].cells if i + 1 < len(rows) else []
        units = after if is_unit_row(after) else []
        columns = _named(row.cells, understand(row.cells, units), units, options)
        if _complete(columns):
            if found is not None and found.rows:
                yield found
            found = _Block(columns, [])
            skip = i + 1 if units else -1
        elif found is not None and any(row.cells) and len([c for c in row.cells if c]) > 2:
            found.rows.append(row)  # a row of a table that is no measurement: counted as bad below
        elif found is not None and found.rows and row.cells and row.cells[0].startswith("["):
            yield found
            found = None
    if found is not None and found.rows:
        yield found


def _complete(columns: list[Column]) -> bool:
    roles = {column.role for column in columns}
    moduli = {"storage", "loss"} <= roles or {"storage", "tangent"} <= roles or {"absolute", "phase"} <= roles
    return bool(({"frequency", "omega"} & roles and moduli) or {"time", "relaxation"} <= roles)


def _named(titles: list[str], columns: list[Column], units: list[str], options: _Options) -> list[Column]:
    """Adds the columns that the user named."""
    for role, wanted in options.columns.items():
        if isinstance(wanted, int) and not isinstance(wanted, bool):
            place = wanted - 1
        else:
            place = next((i for i, title in enumerate(titles) if title.strip() == str(wanted).strip()), -1)
        if not 0 <= place < len(titles):
            continue
        unit = known_unit(units[place]) if place < len(units) else ""
        columns = [column for column in columns if column.place != place and column.role != role]
        columns.append(Column(place, role, titles[place], unit, ""))
    return columns


def _measurements(path: Path, block: _Block, options: _Options, units: dict[str, str]) -> Dma:
    """A block's points in SI; `units` are those that the format fixes."""
    chosen: dict[str, Column] = {}
    for column in block.columns:
        chosen.setdefault(column.role, column)
    dynamic = "storage" in chosen or "absolute" in chosen
    if dynamic:
        chosen.pop("time", None)
        rate = "omega" if "omega" in chosen else "frequency"
        needed = [rate, *_moduli(chosen)]
    else:
        needed = ["time", "relaxation"]
    if "temperature" in chosen:
        needed.append("temperature")
    checks = [role for role in ("frequency", "tangent", "absolute") if role in chosen and role not in needed]
    given = {role: _unit(chosen[role], options, units) for role in needed}
    given |= {role: chosen[role].unit for role in checks}
    values, bad = _numbers(block.rows, chosen, given, needed, checks)
    if not values[needed[0]]:
        raise InputError(f"no row below the header {chosen[needed[0]].title!r} is a measurement ({'; '.join(bad[:2])}).")
    arrays = {role: np.array(convert(values[role], role, given[role])) for role in needed}
    texts = list(inconsistent(arrays, {role: (values[role], given[role]) for role in checks}, dynamic))
    kind = _kind(chosen, options)
    texts += implausible(arrays, {chosen[role].title: spelled(given[role]) for role in needed}, modulus_given(options))
    if bad:
        more = f" and {len(bad) - _NAMED} more" if len(bad) > _NAMED else ""
        texts.append(f"{path.name}: {len(bad)} rows left out: {'; '.join(bad[:_NAMED])}{more}.")
    n = len(values[needed[0]])
    temperature = arrays.get("temperature")
    if temperature is None:
        temperature = np.full(n, np.nan if options.temperature is None else options.temperature)
        if options.temperature is None:
            texts.append(
                f"{path.name}: there is no temperature column; shifting needs temperature=... [K] (--temperature 20degC)."
            )
    common: dict[str, Any] = {
        "kind": kind,
        "units": {role: spelled(given[role]) for role in needed},
        "warnings": tuple(texts),
        "bad_rows": tuple(bad),
        "source": path.name,
    }
    none = np.zeros(0)
    if not dynamic:
        return Dma(none, none, none, none, time=arrays["time"], relaxation=arrays["relaxation"],
                   time_temperature=temperature, **common)  # fmt: skip
    if "loss" in arrays:
        storage, loss = arrays["storage"], arrays["loss"]
    elif "tangent" in arrays:
        storage, loss = arrays["storage"], arrays["storage"] * arrays["tangent"]
    else:
        storage, loss = (arrays["absolute"] * part(arrays["phase"]) for part in (np.cos, np.sin))
    return Dma(temperature, arrays[rate], storage, loss, **common)


def modulus_given(options: _Options) -> bool:
    """Whether the user, not the file, said what the moduli are in."""
    return options.units["modulus"] is not None


def _moduli(chosen: dict[str, Column]) -> tuple[str, str]:
    if {"storage", "loss"} <= chosen.keys():
        return "storage", "loss"
    return ("storage", "tangent") if "tangent" in chosen and "storage" in chosen else ("absolute", "phase")


def _numbers(
    rows: list[Row], chosen: dict[str, Column], given: dict[str, str], needed: list[str], checks: list[str]
) -> tuple[dict[str, list[float]], list[str]]:
    """The numbers of good rows, by role, and what is wrong with each of the others."""
    values: dict[str, list[float]] = {role: [] for role in (*needed, *checks)}
    bad = []
    for row in rows:
        found, wrong = {}, ""
        for role in needed:
            column = chosen[role]
            cell = row.cells[column.place] if column.place < len(row.cells) else ""
            value = number(cell)
            if value is None or not np.isfinite(value):
                wrong = f"{column.title} is {cell[:20]!r}, no number"
            elif role not in ("temperature", "phase") and value <= 0:
                wrong = f"{column.title} is {value:g} {spelled(given[role])}, not positive"
            if wrong:
                break
            found[role] = value
        if wrong:
            bad.append(f"line {row.line}: {wrong}")
            continue
        for role in checks:
            column = chosen[role]
            extra = number(row.cells[column.place]) if column.place < len(row.cells) else None
            found[role] = np.nan if extra is None else extra
        for role, value in found.items():
            values[role].append(value)
    return values, bad


def _unit(column: Column, options: _Options, fixed: dict[str, str]) -> str:
    """The unit of a column: the file's own, that of the format, or the user's."""
    kind = measure(column.role)
    if column.role == "omega" and not column.unit:
        return "rad/s"
    if kind == "ratio":
        return ""
    unit = column.unit or fixed.get(column.role) or options.units.get(kind)
    if unit:
        return unit
    option = {"frequency": "frequency_unit", "modulus": "modulus_unit", "temperature": "temperature_unit",
              "time": "time_unit", "angle": ""}[kind]  # fmt: skip
    if kind == "angle":
        raise InputError(f"the unit of {column.title!r} is not in the file: name it in the title, as '{column.title} [deg]'.")
    example = {"frequency": "Hz", "modulus": "MPa", "temperature": "degC", "time": "s"}[kind]
    raise InputError(
        f"the unit of {column.title!r} is not in the file; give it, as {option}={example!r} "
        f"(--{option.replace('_', '-')} {example})."
    )


def _kind(chosen: dict[str, Column], options: _Options) -> str:
    letters = {chosen[r].letter for r in ("storage", "loss", "absolute", "relaxation") if r in chosen} - {""}
    if "torque" in chosen:
        letters.add("G")  # torque means torsion, and torsion is shear
    if len(letters) > 1:
        raise InputError(f"moduli must be all of shear or all of tension, got columns of {' and '.join(sorted(letters))}.")
    found = {"G": "shear", "E": "tensile"}.get("".join(letters))
    if found and options.kind and found != options.kind:
        raise InputError(f"kind must be {found!r}, as the file's columns say, got {options.kind!r}.")
    kind = found or options.kind
    if kind is None:
        raise InputError(
            "whether the moduli are of shear or tension is not in the file; give it, as kind='shear' (--kind shear)."
        )
    return kind


def _parameters(sheet: Sheet) -> dict[str, str] | None:
    """RepTate's first line, "T=-10;Mw=33.6;chem=PI;", as a dict; None for other files."""
    first = sheet.text.split("\n", 1)[0].strip()
    if not re.fullmatch(r"(\w+=[^;]*;)+\s*", first):
        return None
    return dict(part.strip().split("=", 1) for part in first.split(";") if "=" in part)


def _reptate(path: Path, sheet: Sheet, parameters: dict[str, str], options: _Options) -> Dma:
    """RepTate's text formats: omega [rad/s], G' and G'' [Pa]; .tts is a master curve, shifted to T of its first line."""
    rows = [Row(i, line.split()) for i, line in enumerate(sheet.text.splitlines(), start=1)]
    given = number(parameters.get("T", ""))
    master = path.suffix.lower() == ".tts"
    start = next((i for i, row in enumerate(rows) if sum(number(c) is not None for c in row.cells) >= 3), len(rows))
    titles = _titles(sheet.text.splitlines(), start)
    columns = understand(*titles)
    if not _complete(columns):
        columns = [Column(i, role, role, "", "G") for i, role in enumerate(("omega", "storage", "loss"))]
    if master:
        columns = [column for column in columns if column.role != "temperature"]
    units = _FORMAT_UNITS | {"frequency": "rad/s"}
    kelvin = options.temperature if given is None else given + 273.15
    body = [row for row in rows[start:] if row.cells]
    found = _measurements(path, _Block(columns, body), options._replace(kind="shear", temperature=kelvin), units)
    return Dma(**{**vars(found), "shifted": master})


def _titles(lines: list[str], start: int) -> tuple[list[str], list[str]]:
    heads = [line.split("\t") for line in lines[:start] if "\t" in line]
    if not heads:
        return [], []
    return heads[0], heads[1] if len(heads) > 1 else []


def _no_columns(rows: list[Row]) -> str:
    shown = next((row.cells for row in rows if sum(bool(cell) for cell in row.cells) >= 2), [])
    return (
        "no header names frequency, storage and loss modulus (or time and relaxation modulus); "
        f"the first row is {', '.join(cell for cell in shown[:8] if cell) or 'empty'}. "
        "Name the columns, as columns={'storage': 'Modulus 1'} (--column storage='Modulus 1')."
    )
