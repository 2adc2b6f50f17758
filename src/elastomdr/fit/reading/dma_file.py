"""`em.fit.read_dma`: DMA files of several makes into SI arrays."""

import os
import re
import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..._runtime import positive, scalar
from ...errors import InputError, closest
from ..data import KINDS, Dma, FitWarning, join
from .blocks import blocks, with_named
from .cells import Row, Sheet, number, read_cells
from .columns import Column, checked_unit, is_complete, understand
from .measurements import Block, Options, measurements
from .plausible import implausible_temperatures
from .refusal import no_columns
from .side_by_side import apart, together
from .temperatures import advised, check_told

_ROLES = ("frequency", "temperature", "storage", "loss", "time", "relaxation")
_FORMAT_UNITS = {
    "omega": "rad/s",
    "storage": "pa",
    "loss": "pa",
    "relaxation": "pa",
    "time": "s",
    "temperature": "degc",
}


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
    `temperature` [K] is that of all points where the file has no such column, and no lines above several blocks that
    say one each. Isotherms may stand side by side. `columns` names columns that are not
    recognised, as {"storage": "Modulus 1"} or by number from 1; logarithms are read where titles or units say which.
    Rows that are no measurement are left out, counted and named in a `FitWarning` and in the result; so is what looks
    implausible. Raises `InputError` for what cannot be read, and for units that nobody gives.
    """
    options = _options(kind, frequency_unit, modulus_unit, temperature_unit, time_unit, temperature, columns)
    if isinstance(path, (str, os.PathLike)):
        found = _read(Path(path), options)
    elif isinstance(path, Sequence) and path and all(isinstance(one, (str, os.PathLike)) for one in path):
        twice = {str(one) for one in path if [str(other) for other in path].count(str(one)) > 1}
        if twice:
            raise InputError(f"path must name every file once, got {', '.join(sorted(twice))} twice or more.")
        found = join(*(_read(Path(one), options) for one in path))
    else:
        raise InputError(f"path must be a file or a list of files, got {path!r}.")
    found = replace(found, warnings=(*found.warnings, *implausible_temperatures(found)))
    for text in found.warnings:
        warnings.warn(text, FitWarning, stacklevel=2)
    return found


def _options(kind, frequency, modulus, temperature_unit, time, temperature, columns) -> Options:
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
    return Options(kind, units, temperature, columns)


def _read(path: Path, options: Options) -> Dma:
    sheet = read_cells(path)
    try:
        parameters = _parameters(sheet)
        if parameters is not None or path.suffix.lower() in (".osc", ".tts"):
            return _reptate(path, sheet, parameters or {}, options)
        sides = [apart(block, options) for block in blocks(sheet, options)]
        if not sides:
            raise InputError(no_columns(sheet, options))
        check_told([block.told for parts in sides for block in parts], options.temperature)
        found = [together([measurements(path, block, options, {}) for block in parts]) for parts in sides]
        return advised(join(*found))
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(path.name) else f"{path.name}: {text}") from error


def _parameters(sheet: Sheet) -> dict[str, str] | None:
    """RepTate's first line, "T=-10;Mw=33.6;chem=PI;", as a dict; None for other files."""
    first = sheet.text.split("\n", 1)[0].strip()
    if not re.fullmatch(r"(\w+=[^;]*;)+\s*", first) or first.startswith("sep="):
        return None
    return dict(part.strip().split("=", 1) for part in first.split(";") if "=" in part)


def _reptate(path: Path, sheet: Sheet, parameters: dict[str, str], options: Options) -> Dma:
    """RepTate's text formats: omega [rad/s], G' and G'' [Pa]; .tts is a master curve, shifted to T of its
    first line.
    """
    rows = [Row(i, line.split()) for i, line in enumerate(sheet.text.splitlines(), start=1)]
    given = number(parameters.get("T", ""))
    master = path.suffix.lower() == ".tts"
    start = next((i for i, row in enumerate(rows) if sum(number(c) is not None for c in row.cells) >= 3), len(rows))
    titles = _titles(sheet.text.splitlines(), start)
    columns = understand(*titles)
    if not is_complete(columns):
        titles = ["omega", "storage", "loss"], []
        columns = [Column(i, role, role, "", "G") for i, role in enumerate(titles[0])]
    columns = with_named(titles[0], columns, titles[1], options)
    if master:
        columns = [column for column in columns if column.role != "temperature"]
    units = _FORMAT_UNITS | {"frequency": "rad/s"}
    kelvin = options.temperature if given is None else given + 273.15
    body = [row for row in rows[start:] if row.cells]
    kind = options.kind or ("shear" if not any(column.letter for column in columns) else None)
    found = measurements(path, Block(columns, body, titles[0]), options._replace(kind=kind, temperature=kelvin), units)
    return advised(Dma(**{**vars(found), "shifted": master}))


def _titles(lines: list[str], start: int) -> tuple[list[str], list[str]]:
    heads = [line.split("\t") for line in lines[:start] if "\t" in line]
    if not heads:
        return [], []
    return heads[0], heads[1] if len(heads) > 1 else []
