"""Text files of plain columns of numbers: titles with units, rows with their lines; for surfaces and their spectra."""

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ...files import read_bytes
from .cells import Row, decode, separator_of, with_points
from .headers import is_remark, titles

METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9}
_HOLES = ("", "nan", "na", "n/a", "null", "none", "-", "--")  # cells without a value
_TITLE = re.compile(r"\s*(.*?\S)\s*(?:\[\s*([^\[\]]*?)\s*\]|\(\s*([^()]*?)\s*\)|\s(?:/|in)\s+(\S+))\s*")


class Table(NamedTuple):
    """What a file holds; empty cells and those that are no number are NaN."""

    titles: list[str]  # empty where there are none
    units: list[str]  # of the columns, empty where none is given
    lines: list[int]  # in which each row stands, counted from 1
    cells: list[list[str]]
    data: np.ndarray  # (rows, columns)


def read_table(path: str | os.PathLike[str], what: str, is_unit: Callable[[str], bool], ragged: bool = False) -> Table:
    """The columns of a text file. Raises `InputError`, with the file's name.

    The first row of two numbers or more begins the table, or the rows with holes right above it. Titles stand above it,
    a row of units may follow them, and both may stand behind a # (or %, //). Tab, semicolon, comma or blank separates;
    decimal commas and the encodings of `read_dma`. Rows with another number of cells than the first are refused, or, in
    a `ragged` table, rows without a number.
    """
    name = Path(path).name
    try:
        raw = read_bytes(path)
    except (OSError, ValueError) as error:
        raise InputError(f"path must be a text file that can be read, got {name!r}: {error}.") from error
    given = [(i, line) for i, line in enumerate(decode(raw, name).splitlines(), start=1) if line.strip()]
    lines = [(i, line) for i, line in given if not is_remark(line)]
    mark = separator_of([line for _, line in lines])
    rows = [Row(i, _cut(line, mark)) for i, line in lines]
    if mark != "," and any("," in line for _, line in lines):
        rows = with_points(rows, mark)
    numeric = (sum(np.isfinite(_number(cell)) for cell in row.cells) > 1 for row in rows)
    start = next((i for i, found in enumerate(numeric) if found), None)
    if start is None:
        raise InputError(f"path must be a table of {what}, got {name!r} without a row of two numbers.")
    width = len(rows[start].cells)
    while start and len(rows[start - 1].cells) == width and _holed(rows[start - 1].cells):
        start -= 1
    body = rows[start:]
    for i, row in enumerate(body):
        if len(row.cells) != width and ragged:
            kept = row.cells if _in_place(row.cells, mark, width) else []
            body[i] = Row(row.line, [*kept, *[""] * width][:width])
        elif len(row.cells) != width:
            raise InputError(
                f"path: {name!r} has {len(row.cells)} cells in line {row.line}, {width} in line {body[0].line}."
            )
    above = [_titles(line, mark, width) for i, line in lines if i < body[0].line]
    behind = [_titles(line, mark, width) for i, line in given if is_remark(line) and i < body[0].line]
    heads, units = _head([cells for cells in above if len(cells) == width], is_unit)
    if not heads:
        heads, units = _head([cells for cells in behind if len(cells) == width], is_unit)
        heads, units = (heads, units) if any(map(is_unit, units)) else ([], [])
    data = np.array([[_number(cell) for cell in row.cells] for row in body])
    return Table(heads, units or [""] * width, [row.line for row in body], [row.cells for row in body], data)


def _head(rows: list[list[str]], is_unit: Callable[[str], bool]) -> tuple[list[str], list[str]]:
    """Titles without their units, and the units, from the rows above a table."""
    if not rows:
        return [], []
    bare = [cell.strip("[]() ") for cell in rows[-1]]
    if len(rows) > 1 and all(map(is_unit, bare)):
        return rows[-2], bare
    found = [_TITLE.fullmatch(cell) for cell in rows[-1]]
    units = [next((u for u in match.groups()[1:] if u), "") if match else "" for match in found]
    return [match[1] if match else cell for match, cell in zip(found, rows[-1], strict=True)], units


def _titles(line: str, mark: str, width: int) -> list[str]:
    return titles(Row(0, _cut(line, mark)), line if mark == " " else None, width)


def _in_place(cells: list[str], mark: str, width: int) -> bool:
    """Whether the cells of a row of another length are in their places: only empty ones are missing, or too many."""
    return mark != " " and not any(cells[width:])


def _cut(line: str, mark: str) -> list[str]:
    return [cell.strip().strip('"').strip() for cell in (line.split() if mark == " " else line.split(mark))]


def _holed(cells: list[str]) -> bool:
    """Whether a row begins with a number and has nothing but numbers and holes after it."""
    return bool(np.isfinite(_number(cells[0]))) and all(
        np.isfinite(_number(cell)) or cell.lower() in _HOLES for cell in cells[1:]
    )


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return np.nan
