"""Files into rows of cells: text in several encodings and separators, spreadsheets."""

import contextlib
import csv
import importlib.util
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from ...errors import InputError
from ...files import read_bytes

_PATIENCE = 60  # seconds for a spreadsheet
_LATIN = set("°º±²³µ·äöüÄÖÜßéèêëàâçñôûîóáíåæøÅÆØ\u00d7")  # what a Latin-1 file of measurements holds beyond ASCII
_TYPED = set("\u2018\u2019\u201c\u201d\u2013\u2014\u2026\u2022")  # what Windows-1252 has where Latin-1 has controls
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
_MARKED = re.compile(r"[+-]?[\d.,]*\d[\d.,]*([eEdD][+-]?\d+)?")  # a number, whatever its comma and point mean
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(\.\d{3}){2,}")  # points that can be no decimal ones, and make no date
_BLANKS = re.compile("(?<=\\d)[\u00a0\u2009\u202f](?=\\d)")  # that set thousands apart


class Row(NamedTuple):
    """One line of a file or a sheet."""

    line: int  # counted from 1
    cells: list[str]


class Sheet(NamedTuple):
    """A file's rows; `text` and `separator` are empty for spreadsheets."""

    rows: list[Row]
    text: str
    separator: str = ""


def read_cells(path: Path) -> Sheet:
    """The rows of a text file or a spreadsheet. Raises `InputError`, with the file's name, where there are none."""
    try:
        if path.is_dir():
            raise InputError(f"{path.name or path}: must be a file, got a folder; give the files in it.")
        raw = read_bytes(path)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{path.name or path}: cannot be read ({getattr(error, 'strerror', None) or error})."
        ) from error
    if raw[:4] in (b"\xd0\xcf\x11\xe0", b"PK\x03\x04"):
        return Sheet(with_points(_spreadsheet(path), ""), "")
    text = decode(raw, path.name)
    separator = separator_of(text.splitlines())
    return Sheet(with_points(_split(text, separator), separator), text, separator)


def decode(raw: bytes, name: str) -> str:
    """Text from UTF-8 or UTF-16 (with a mark, or UTF-8 without), Latin-1, Windows-1252 or cp949, whichever fits."""
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16", errors="replace")
    if b"\0" in raw[:4096]:
        raise InputError(f"{name}: must be a text file or a spreadsheet (.xls, .xlsx), got binary data.")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    latin = raw.decode("latin-1")
    if {character for character in latin if ord(character) > 127} <= _LATIN:
        return latin
    with contextlib.suppress(UnicodeDecodeError):
        windows = raw.decode("cp1252")
        if {character for character in windows if ord(character) > 127} <= _LATIN | _TYPED:
            return windows
    try:
        return raw.decode("cp949")
    except UnicodeDecodeError:
        return latin


def number(cell: str) -> float | None:
    """The number in a cell, with a decimal point, or None where it holds something else."""
    text = cell.strip().strip('"')
    if not _NUMBER.fullmatch(text):
        return None
    return float(text.replace("d", "e").replace("D", "E"))


def _split(text: str, separator: str) -> list[Row]:
    lines = text.splitlines()
    if separator == " ":
        return [Row(i, line.split()) for i, line in enumerate(lines, start=1)]
    rows = []
    for i, line in enumerate(lines, start=1):
        try:  # a quote within a cell, as in G", is a character like others
            cells = next(csv.reader(io.StringIO(line), delimiter=separator), [])
        except csv.Error:
            cells = line.split(separator)
        # Some exports separate titles with tabs and numbers with blanks.
        if separator == "\t" and len(cells) == 1 and len(line.split()) > 2 and number(line.split()[0]) is not None:
            cells = line.split()
        rows.append(Row(i, [cell.strip() for cell in cells]))
    return rows


def with_points(rows: list[Row], separator: str) -> list[Row]:
    """The same rows with decimal points and nothing between thousands, whatever a sheet uses for either.

    What cannot be both decides: 0,5 and 1.234,5 have decimal commas. Where all commas of a sheet could stand before
    thousands (1,234), they do if its separator is a comma too, if other numbers have decimal points, or if one has two
    of them (1,234,567); points likewise where other numbers have decimal commas, or one has two points.
    """
    rows = [Row(row.line, [_BLANKS.sub("", cell).replace("\u2212", "-") for cell in row.cells]) for row in rows]
    marked = [cell for row in rows for cell in row.cells if ("," in cell or "." in cell) and _MARKED.fullmatch(cell)]
    comma, point = (any(_is_decimal(cell, mark) for cell in marked) for mark in ",.")
    grouped = not comma and (point or separator == "," or any(cell.count(",") > 1 for cell in marked))
    dotted = not point and (comma or any(_THOUSANDS.fullmatch(cell) for cell in marked))

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
    """Whether a comma (or point) can only be the decimal one: the last mark, once, not before just three digits."""
    other = "." if mark == "," else ","
    if cell.count(mark) != 1 or (other in cell and cell.rfind(other) > cell.rfind(mark)):
        return False
    before, after = re.split("[eEdD]", cell)[0].lstrip("+-").split(mark)
    return other in before or len(after) != 3 or len(before) > 3 or before in ("", "0")


def separator_of(lines: list[str]) -> str:
    """The separator that cuts most lines into several cells that are mostly numbers."""
    sample = [line for line in lines if line.strip()][:400]
    best, most = ",", 0.0
    for separator in ("\t", ";", ",", "|", " "):
        score = 0.0
        for line in sample:
            cells = line.split() if separator == " " else line.split(separator)
            known = sum(_MARKED.fullmatch(cell.strip().strip('"')) is not None for cell in cells)
            score += known if len(cells) >= 2 and known >= 2 else 0
        if score > 1.05 * most:
            best, most = separator, score
    return best


def _spreadsheet(path: Path) -> list[Row]:
    if importlib.util.find_spec("python_calamine") is None:
        raise InputError(f"{path.name}: reading spreadsheets needs python-calamine: pip install elastomdr[excel]")
    reader = [sys.executable, str(Path(__file__).with_name("spreadsheet.py")), os.fspath(path)]
    try:
        read = subprocess.run(reader, capture_output=True, timeout=_PATIENCE, check=False)
    except subprocess.TimeoutExpired as error:
        raise InputError(f"{path.name}: is not a spreadsheet that can be read in {_PATIENCE} s.") from error
    if read.returncode != 0:
        said = read.stdout.decode(errors="replace").strip() if read.returncode == 1 else ""
        raise InputError(f"{path.name}: is not a spreadsheet that can be read ({said or 'it is damaged'}).")
    rows: list[Row] = []
    for sheet in json.loads(read.stdout):  # line numbers are those of the sheet
        rows += [Row(i, cells) for i, cells in enumerate(sheet, start=1)]
        rows.append(Row(0, []))
    return rows
