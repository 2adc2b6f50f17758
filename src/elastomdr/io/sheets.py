"""Files into rows of cells: text in several encodings and separators, spreadsheets;
numbers with a decimal point.
"""

import csv
import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from ..files import as_path, read_bytes

_PATIENCE = 60  # seconds for a spreadsheet
_LONGEST_LINE = 2_000_000  # characters
_MOST_LINES = 10_000_000
_LONGEST_CELL = 2000  # characters that are looked at: the rest is a remark
_MOST_CELLS = 25_000_000  # of a text: a map of 5000 by 5000 points
_EXPECTED = set(
    "°º±²³µ·äöüÄÖÜßéèêëàâçñôûîóáíåæøÅÆØ\u00d7\u2018\u2019\u201c\u201d\u2013\u2014\u2026\u2022"
)
_CLOCK = re.compile(r"(\d{1,5}):([0-5]\d):([0-5]\d(?:[.,]\d*)?)")  # hh:mm:ss
# a number, whatever its comma and point mean
_MARKED = re.compile(r"[+-]?(?=[.,]*\d)[\d.,]+([eEdD][+-]?\d+)?")


class Row(NamedTuple):
    """One line of a file or a sheet; line 0 is the end of a sheet."""

    line: int  # counted from 1
    cells: list[str]


class Sheet(NamedTuple):
    """A file's rows; `lines` and `separator` are empty for spreadsheets."""

    name: str
    rows: list[Row]
    lines: list[str]
    separator: str = ""


def read_sheet(path: str | os.PathLike[str]) -> Sheet:
    """The rows of a text file or a spreadsheet, whose sheets follow each other, each
    below its name.

    Raises `InputError` for what cannot be read.
    """
    path = as_path(path)
    name, raw = path.name or str(path), bytes_of(path)
    if raw[:4] in (b"\xd0\xcf\x11\xe0", b"PK\x03\x04"):
        return Sheet(name, with_points(_spreadsheet(path), ""), [])
    return cut(name, decode(raw))


def bytes_of(path: Path) -> bytes:
    """What a file holds. Raises `InputError`."""
    try:
        return read_bytes(path)
    except (OSError, ValueError) as error:
        reason = (
            "it is a folder: give the files in it"
            if isinstance(error, IsADirectoryError)
            else getattr(error, "strerror", None) or error
        )
        raise InputError(
            argument="path",
            accepted="a file that can be read",
            hint=str(reason),
        ) from error


def is_frame(value: object) -> bool:
    """Whether a value is a table of pandas or polars, or of a package that is like
    them.
    """
    return hasattr(value, "columns") and hasattr(value, "to_numpy")


def sheet_of_frame(frame: Any) -> Sheet:
    """A table in memory as a sheet: its titles, a row for each of their levels, and its
    cells below.

    Numbers keep all their digits. Units stand in the titles, as in files, or are those
    of a column of pint.
    """
    if any(
        name is not None for name in getattr(getattr(frame, "index", None), "names", ())
    ):
        frame = frame.reset_index()  # of pandas: an index with a name is a column
    levels = [
        title if isinstance(title, tuple) else (title,) for title in frame.columns
    ]
    titles = [
        list(map(str, titles_of_level)) for titles_of_level in zip(*levels, strict=True)
    ]
    for i, kind in enumerate(frame.dtypes):
        if (unit := getattr(kind, "units", None)) is not None:
            titles[-1][i] += f" [{unit:~}]"
    columns = map(_column, _columns_of(frame))
    cells = titles + [
        [_frame_cell(value) for value in row] for row in zip(*columns, strict=True)
    ]
    return Sheet(
        "the table",
        [*(Row(i, row) for i, row in enumerate(cells, start=1)), Row(0, [])],
        [],
    )


def _columns_of(frame: Any) -> list[Any]:
    """The columns of a table of pandas, whose titles need not differ, or of polars."""
    if hasattr(frame, "iloc"):
        return [frame.iloc[:, i] for i in range(frame.shape[1])]
    return list(frame)


def _column(column: Any) -> np.ndarray:
    """The numbers of a column, without the unit that pint-pandas keeps beside them."""
    if hasattr(column.dtype, "units"):
        return np.asarray(column.array.quantity.magnitude)
    return column.to_numpy()


def _frame_cell(value: object) -> str:
    if isinstance(value, (int, float, np.number)):
        return "" if np.isnan(value) else repr(float(value))
    return "" if value is None else str(value).strip()[:_LONGEST_CELL]


def cut(name: str, content: str) -> Sheet:
    """A text as a sheet, cut at the separator that suits most of its lines."""
    # more lines and their cells would take a hundred times the memory of the text
    if content.count("\n") > _MOST_LINES:
        raise InputError(
            argument="path",
            accepted=f"a text of {_MOST_LINES:,} lines at most",
            hint=f"it has {content.count(chr(10)):,}",
        )
    # blanks between thousands
    content = re.sub("(?<=\\d)[\u00a0\u2009\u202f](?=\\d)", "", content).replace(
        "\u2212", "-"
    )
    lines = content.splitlines()
    longest = max(map(len, lines), default=0)
    if longest > _LONGEST_LINE:
        raise InputError(
            argument="path",
            accepted=f"a text with lines of {_LONGEST_LINE:,} characters at most",
            hint=f"one has {longest:,}",
        )
    mark = _separator(lines)
    if content.count(mark) > _MOST_CELLS:
        raise InputError(
            argument="path",
            accepted=f"a text of {_MOST_CELLS:,} cells at most",
            hint=f"it has {content.count(mark):,}",
        )
    rows = [
        Row(i, line.split() if mark == " " else _cells(line, mark))
        for i, line in enumerate(lines, start=1)
        if line and not line.isspace()
    ]
    if longest > _LONGEST_CELL:
        rows = [
            row._replace(cells=[cell[:_LONGEST_CELL] for cell in row.cells])
            for row in rows
        ]
    if (
        (mark != "," and "," in content)
        or '"' in content
        or re.search(r"\d\.\d{3}\.\d{3}", content)
    ):
        rows = with_points(rows, mark)
    return Sheet(name, rows, lines, mark)


def decode(raw: bytes) -> str:
    """Text from UTF-16, UTF-8, Windows-1252 or cp949, whichever fits; Latin-1 fits
    always.
    """
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16", errors="replace")
    for start, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):  # without a mark
        half = raw[start:4096:2]
        if half.count(0) > 0.9 * len(half) and b"\0" not in raw[1 - start : 4096 : 2]:
            return raw.decode(encoding, errors="replace")
    if b"\0" in raw[:4096]:
        raise InputError(
            argument="path",
            accepted="a text file or a spreadsheet (.xls, .xlsx)",
            hint="it has binary data",
        )
    for encoding in ("utf-8-sig", "cp1252", "cp949"):
        try:
            decoded = raw.decode(encoding)
        except UnicodeDecodeError:
            continue
        if (
            encoding != "cp1252"
            or {character for character in decoded if ord(character) > 127} <= _EXPECTED
        ):
            return decoded
    return raw.decode("latin-1")


def number(cell: str) -> float:
    """The number in a cell with a decimal point; NaN where it holds something else."""
    try:
        return float(cell) if "_" not in cell else np.nan
    except ValueError:
        pass
    # 1.5D-3, of Fortran
    exponent = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+))[dD]([+-]?\d+)\s*", cell)
    return float("e".join(exponent.groups())) if exponent else np.nan


def seconds(cell: str) -> float:
    """The seconds of a time that is written as hh:mm:ss; NaN where a cell holds
    something else.
    """
    match = _CLOCK.fullmatch(cell)
    if match is None:
        return np.nan
    return (
        3600.0 * int(match[1])
        + 60.0 * int(match[2])
        + float(match[3].replace(",", "."))
    )


def with_points(rows: list[Row], separator: str) -> list[Row]:
    """The same rows with decimal points and nothing between thousands, whatever a sheet
    uses for either.

    What cannot be both decides: 0,5 and 1.234,5 have decimal commas. Where all commas
    could stand before thousands (1,234) they do if the separator is a comma, if other
    numbers have decimal points, or if one has two commas; points likewise where others
    have decimal commas, or one number has two points.
    """
    marked = [
        cell
        for row in rows
        for cell in row.cells
        if ("," in cell or "." in cell) and _MARKED.fullmatch(cell)
    ]
    comma, point = (any(_is_decimal(cell, mark) for cell in marked) for mark in ",.")
    grouped = not comma and (
        point or separator == "," or any(cell.count(",") > 1 for cell in marked)
    )
    dotted = not point and (
        comma
        or any(re.fullmatch(r"[+-]?\d{1,3}(\.\d{3}){2,}", cell) for cell in marked)
    )

    def plain(cell: str) -> str:
        if not ("," in cell or "." in cell) or not _MARKED.fullmatch(cell):
            return cell
        if "," in cell and "." in cell:
            decimal = max(",.", key=cell.rfind)
        elif "," in cell:
            decimal = "" if grouped else ","
        else:
            decimal = "" if dotted else "."
        for mark in {",", "."} - {decimal}:
            cell = cell.replace(mark, "")
        return cell.replace(",", ".")

    return [Row(row.line, [plain(cell) for cell in row.cells]) for row in rows]


def _is_decimal(cell: str, mark: str) -> bool:
    """Whether a comma (or point) can only be the decimal one: the last mark, once, not
    before just three digits.
    """
    other = "." if mark == "," else ","
    if cell.count(mark) != 1 or (
        other in cell and cell.rfind(other) > cell.rfind(mark)
    ):
        return False
    before, after = re.split("[eEdD]", cell)[0].lstrip("+-").split(mark)
    return other in before or len(after) != 3 or len(before) > 3 or before in ("", "0")


def _separator(lines: list[str]) -> str:
    """The separator that cuts most lines into several cells that are mostly numbers."""
    sample = [line for line in lines if line.strip()][:400]
    best, most = ",", 0.0
    for separator in ("\t", ";", ",", "|", " "):
        score = 0.0
        for line in sample:
            cells = line.split() if separator == " " else line.split(separator)
            bare = [cell.strip().strip('"') for cell in cells]
            known = sum(
                _MARKED.fullmatch(cell) is not None
                or _CLOCK.fullmatch(cell) is not None
                for cell in bare
            )
            score += (
                known
                if known >= 2 and (separator != " " or 2 * known >= len(cells))
                else 0
            )
        if score > 1.05 * most:
            best, most = separator, score
    return best


def _cells(line: str, separator: str) -> list[str]:
    """A quote within a cell, as in G", is a character like others."""
    try:
        cells = (
            next(csv.reader([line], delimiter=separator), [])
            if '"' in line
            else line.split(separator)
        )
    except csv.Error:
        cells = line.split(separator)
    return [cell.strip() for cell in cells]


def run_reader(reader: str, path: Path, patience: float, accepted: str) -> bytes:
    """What a reader of `readers.py` prints of a file. Raises `InputError`."""
    command = [sys.executable, Path(__file__).with_name("readers.py"), reader, path]
    try:
        read = subprocess.run(
            command, capture_output=True, timeout=patience, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise InputError(
            argument="path",
            accepted=f"{accepted} that can be read in {patience} s",
        ) from error
    if read.returncode != 0:
        reason = read.stdout.decode(errors="replace") * (read.returncode == 1)
        raise InputError(
            argument="path",
            accepted=f"{accepted} that can be read",
            hint=" ".join(reason.split())[:300].rstrip(".") or "it is damaged",
        )
    return read.stdout


def _spreadsheet(path: Path) -> list[Row]:
    if importlib.util.find_spec("python_calamine") is None:
        raise InputError(
            argument="path",
            accepted="a text file where python-calamine is not installed, which "
            "reads spreadsheets",
            hint="pip install elastomdr[excel]",
        )
    printed = run_reader("spreadsheet", path, _PATIENCE, "a spreadsheet")
    rows: list[Row] = []
    # line numbers are those of the sheet
    for title, sheet in json.loads(printed).items():
        rows += [
            Row(1, [title]),
            *(
                Row(i, [cell[:_LONGEST_CELL] for cell in cells])
                for i, cells in enumerate(sheet, start=1)
            ),
        ]
        rows.append(Row(0, []))
    return rows
