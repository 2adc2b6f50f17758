"""The tables in a sheet: runs of rows of numbers, each with its titles and units; the
header parser of all formats, and the register of formats of moduli, each with its name,
how a file of it is recognised, and how its tables are found.

A format whose titles stand right above its numbers needs no code: `tables` reads it,
with the units behind the titles or below them. A format that keeps titles or
temperatures elsewhere has a function that finds them.
"""

import contextlib
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Literal, NamedTuple

import numpy as np

from ..errors import InputError
from ..units.registry import is_unit, to_si
from .sheets import Row, Sheet, number, seconds, with_points

# begins a line that programs which want numbers pass over
_MARK = re.compile(r"\s*(?:#+|%+|//+|;+)\s*")
_BRACKETS = re.compile(r"[\[(][^\[\]()]*[\])]")
# what pandas makes of a title that it has met before
_COPY = re.compile(r"(.*\S)\.\d+")
_HOLES = ("nan", "na", "n/a", "null", "none", "-", "--")  # cells without a value
# of a table with titles; a wider one is a matrix, and its titles are not looked at
MOST_COLUMNS = 2000
_MOST_TABLES = 5000  # in a file
_HIGHEST = 200  # rows above a table among which its titles are
_LONGEST_LINE = 5000  # characters of a line of titles that is cut at blanks


class Head(NamedTuple):
    """The title of a column, and the unit in a row below it (empty where there is no
    such row).
    """

    place: int
    title: str
    below: str

    @property
    def words(self) -> str:
        """Its number and title."""
        return f"{self.place + 1} {self.title!r}"


class TitledTable(NamedTuple):
    """Rows of numbers below titles; titles are empty where there are none."""

    heads: list[Head]
    rows: list[Row]
    above: list[Row]  # rows of text above, since the table before
    # cells a row must have where it is cut at blanks, so that one that is missing moves
    # the others
    width: int = 0
    fixed: Mapping[str, float] = {}  # what holds for all rows, by role [SI]
    name: str = ""  # of the file
    units: Mapping[str, str] = {}  # of the user, by kind

    def column(self, place: int) -> np.ndarray:
        """The numbers of a column, of times as hh:mm:ss their seconds, NaN where there
        are none.
        """
        with contextlib.suppress(ValueError, IndexError):  # fast, where all are numbers
            return np.array([row.cells[place] for row in self.rows]).astype(float)
        values = np.array(
            [
                number(row.cells[place]) if place < len(row.cells) else np.nan
                for row in self.rows
            ]
        )
        return self.clock(place) if np.isnan(values).all() else values

    def clock(self, place: int) -> np.ndarray:
        """The seconds of the times in a column that are written as hh:mm:ss, NaN where
        there are none.
        """
        return np.array(
            [
                seconds(row.cells[place]) if place < len(row.cells) else np.nan
                for row in self.rows
            ]
        )


def tables(sheet: Sheet, fewest: int = 2) -> list[TitledTable]:
    """All runs of rows with `fewest` numbers or more, the titles of each from the text
    above it.

    A row that breaks off (its first cell is a number, or it has one among three cells)
    belongs to the run. A run without titles of its own has those of the run before it,
    if that is as wide.
    """
    complete: list[TitledTable] = []
    above: list[Row] = []
    rows: list[Row] = []
    before: TitledTable | None = None
    for row in [*sheet.rows, Row(0, [])]:
        if row.line and not any(row.cells):
            continue
        if _belongs(sheet, row, rows, fewest):
            holed: list[Row] = []
            while not rows and above and _begins(above[-1], row):
                holed.insert(0, above.pop())
            rows += [*holed, row]
            continue
        single = rows[:] if len(rows) == 1 else []  # or numbers above titles
        if rows:
            before = _table(sheet, above, rows, before)
            complete.append(before)
            refuse_many(len(complete))
            above, rows = single, []
        above.append(row)
        if not row.line:  # the end of a sheet
            above, before = [], None
    return complete


def refuse_many(count: int) -> None:
    """Raises `InputError` for more tables than a measurement has."""
    if count > _MOST_TABLES:
        raise InputError(
            argument="path",
            accepted=f"a file with {_MOST_TABLES:,} tables (or steps) at most",
        )


def main_table(sheet: Sheet, fewest: int = 2) -> TitledTable | None:
    """The table with most rows, and those below it without titles of their own, for
    files that hold one table.
    """
    candidates = tables(sheet, fewest)
    best = max(candidates, key=lambda table: len(table.rows), default=None)
    if best is None:
        return None
    rows: list[Row] = []
    for table in (table for table in candidates if table.heads == best.heads):
        # as wide as the table: a row that holds no numbers
        between = table.above if rows else []
        rows += [
            *(
                row
                for row in between
                if len(row.cells) == len(best.heads) and row.line != rows[-1].line
            ),
            *table.rows,
        ]
    return best._replace(rows=rows)


_LISTED, _SHOWN = 24, 60  # columns in a message, and characters of the title of each
_LONGEST_TITLE = 500  # characters of a title: the time to split one grows as the square


def splits(title: str) -> Iterator[tuple[str, str]]:
    """Name and unit of a title such as "G' [MPa]", "f (Hz)", "E' / MPa", "f, Hz",
    "freq_hz", as it may be meant.
    """
    if len(title) > _LONGEST_TITLE:
        return
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\[\]()]*)\s*[\])]", title)
    if match:
        yield match[1], match[2]
    for gap in re.finditer(r"\s*[/,]\s*|\s+in\s+|\s+-\s+|_|\s+", title):
        name, unit = title[: gap.start()], title[gap.end() :].strip()
        # not within brackets
        if all(name.count(one) == name.count(other) for one, other in ("()", "[]")):
            yield name, unit
            yield name, unit.replace("_", "/")


def clean(title: str) -> str:
    """A title with plain primes and single blanks."""
    bare = title.strip().strip('"').strip() if title.count('"') != 1 else title.strip()
    for mark in ("\u2032", "\u2019", "\u02b9", "`", "\u00b4"):
        bare = bare.replace(mark, "'")
    return re.sub(r"\s+", " ", re.sub('[″“”"]', "''", bare))


def titled_unit(head: Head, *kinds: str) -> tuple[str, str]:
    """The title of a column without its unit, and the unit, from the title or from the
    row below; empty where none is of these kinds.
    """
    title, below = clean(head.title), head.below.strip("[]() ")
    ways = [(title, below)] if below else splits(title)
    return next(
        (
            (name, unit)
            for name, unit in ways
            if not name.isdigit() and any(to_si(unit, kind) for kind in kinds)
        ),
        (title, ""),
    )


def named_heads(
    columns: Sequence[int | str], table: TitledTable, count: str = ""
) -> list[Head]:
    """The columns that a user names by number from 1 or by title; `count` says how many
    there must be. Raises `InputError`.
    """
    known = {
        name: head
        for head in reversed(table.heads)
        for name in (head.title.strip(), head.place + 1)
    }
    if not isinstance(columns, (list, tuple)) or not all(
        type(one) in (int, str) and one in known for one in columns
    ):
        raise InputError(
            argument="columns",
            got=columns,
            accepted=f"{count}numbers from 1 to {len(table.heads)} or titles of "
            f"{listed(table.heads)}",
        )
    return [known[one] for one in columns]


def refuse_ragged(table: TitledTable) -> None:
    """Raises `InputError` for a row with more or fewer cells than there are titles."""
    for row in table.rows:
        if len(row.cells) != len(table.heads):
            raise InputError(
                argument="path",
                accepted="a table with as many cells in each row as titles",
                hint=f"it has {len(row.cells)} in line {row.line}, {len(table.heads)} "
                "elsewhere",
            )


def listed(heads: Sequence[Head]) -> str:
    """The columns of a table by number and title, for messages; the first of them where
    there are many.
    """
    shown = [
        f"{head.place + 1}: {_short(head.title) or 'no title'}"
        for head in heads[:_LISTED]
    ]
    rest = [f"and {len(heads) - _LISTED} more"] if len(heads) > _LISTED else []
    return ", ".join([*shown, *rest])


def _short(title: str) -> str:
    return title if len(title) <= _SHOWN else f"{title[: _SHOWN - 3]}..."


def _table(
    sheet: Sheet, above: list[Row], rows: list[Row], before: TitledTable | None
) -> TitledTable:
    width = Counter(len(row.cells) for row in islice(rows, 400)).most_common(1)[0][0]
    # columns up to the last one that holds anything: lines may end with separators
    filled = width
    while filled > 1 and not any(row.cells[filled - 1 : filled] > [""] for row in rows):
        filled -= 1
    titles, units = (
        _header(sheet, above, filled, True) if width <= MOST_COLUMNS else ([], [])
    )
    if not titles and before is not None and len(before.heads) == filled:
        heads = before.heads
    # a remark may have been cut at its commas: narrower than the table is the second
    # choice
    else:
        if not titles and width <= MOST_COLUMNS:
            titles, units = _header(sheet, above, filled, False)
        titles, units = (
            [*cells, *[""] * (filled - len(cells))] for cells in (titles, units)
        )
        while len(titles) > filled and not titles[-1]:
            titles = titles[:-1]
        heads = [
            Head(i, title, units[i] if i < len(units) else "")
            for i, title in enumerate(titles)
        ]
    if len(heads) < width:
        rows = [row._replace(cells=row.cells[: len(heads)]) for row in rows]
    return TitledTable(heads, rows, above, width if sheet.separator == " " else 0)


def _header(
    sheet: Sheet, above: list[Row], width: int, whole: bool
) -> tuple[list[str], list[str]]:
    """The titles right above a table of some width, and the units between both; empty
    where there are none.
    """
    units: list[str] = []
    for row in reversed(above[-_HIGHEST:]):
        cells = _titles(sheet, row, width)
        if not cells or any(np.isfinite(number(cell)) for cell in cells):
            continue
        known = [cell for cell in cells if cell]
        if not units and _are_units(known):
            units = cells
        elif (
            len(known) >= min(2, width)
            and len(cells) >= width * whole
            and 2 * len(known) >= min(width, len(cells))
        ):
            copies = [_COPY.fullmatch(cell) for cell in cells]
            return [
                m[1] if m and m[1] in cells else c
                for m, c in zip(copies, cells, strict=True)
            ], units
    return units, []  # titles that might be units, such as t, T


def _are_units(cells: Sequence[str]) -> bool:
    units = sum(is_unit(re.sub(r"^(ln|log10|log|lg)[ (]", "", cell)) for cell in cells)
    return 2 * units >= len(cells) and (units >= 2 or len(cells) == 1)


def _titles(sheet: Sheet, row: Row, width: int) -> list[str]:
    """The cells of a row of titles without its comment mark; none where they cannot be
    told apart.

    A row that is cut at blanks is cut in the first way that gives `width` titles. A
    mark by itself is a title (of numbers of points) where the rows have a cell for it.
    """
    if sheet.separator == " ":
        line = sheet.lines[row.line - 1].strip()
        bare = _MARK.sub("", line, count=1) if _MARK.match(line) else line
        return next(
            (
                cut
                for candidate in (bare, line)
                for cut in _cuts(candidate)
                if len(cut) == width
            ),
            [],
        )
    match = _MARK.match(row.cells[0]) if row.cells else None
    if match is None:
        return row.cells
    rest = row.cells[0][match.end() :]
    return (
        [rest or row.cells[0], *row.cells[1:]]
        if rest or len(row.cells) == width
        else row.cells[1:]
    )


def _cuts(line: str) -> Iterator[list[str]]:
    """A line of titles in the ways that it may be meant: at blanks that are not before
    a bracket, at two blanks, at other separators, behind brackets.
    """
    if len(line) > _LONGEST_LINE:
        return
    joined = re.sub(
        r"(?<=\S)\s+(?=[\[(])",
        "\0",
        _BRACKETS.sub(lambda match: re.sub(r"\s+", "\0", match[0]), line),
    )
    joined = re.sub(r"\s+/\s+", "\0/\0", joined)
    yield [cell.replace("\0", " ") for cell in joined.split()]
    yield [cell.strip() for cell in re.split(r"\s{2,}|\t", line)]
    for mark in ",;|":
        yield [cell.strip() for cell in line.split(mark)]
    yield [
        cell.strip()
        for cell in re.findall(r"[^\[\]()]+(?:\[[^\[\]]*\]|\([^()]*\)|$)", line)
        if cell.strip()
    ]
    yield line.split()


def _numbers(cells: Sequence[str], enough: int) -> int:
    count = 0
    for cell in cells:
        count += math.isfinite(number(cell))
        if count == enough:
            break
    return count


def _belongs(sheet: Sheet, row: Row, rows: list[Row], fewest: int) -> bool:
    """Whether a row belongs to a table of the `rows` before it, though it may lack
    numbers.
    """
    first = next((cell for cell in row.cells if cell), "#")
    if first.startswith(("#", "%", "//")) or first.endswith(":"):
        return False
    enough = _numbers(row.cells, fewest) == fewest or _is_timed(row.cells, fewest)
    if enough or not rows:
        return enough
    cells = [cell for cell in row.cells if cell]
    wide = len(cells) > 2 or (
        sheet.separator != "" and len(row.cells) == len(rows[-1].cells) > 2
    )
    holes = all(cell.lower() in _HOLES for cell in cells)
    return (
        holes
        or bool(np.isfinite(number(cells[0])))
        or (wide and _numbers(cells, 1) == 1)
    )


def _is_timed(cells: Sequence[str], fewest: int) -> bool:
    """Whether a row holds nothing but numbers and a time as hh:mm:ss: remarks have
    words beside it.
    """
    filled = [cell for cell in cells if cell]
    if len(filled) < fewest or not any(":" in cell for cell in filled):
        return False
    values = [number(cell) for cell in filled]
    clocks = [seconds(cell) for cell in filled]
    return bool(
        np.isfinite(values).any() and (np.isfinite(values) | np.isfinite(clocks)).all()
    )


def _begins(row: Row, first: Row) -> bool:
    """Whether a row above the first with enough numbers is one of the table too, with
    holes.
    """
    return (
        len(row.cells) == len(first.cells)
        and bool(np.isfinite(number(row.cells[0])))
        and all(
            cell.lower() in ("", *_HOLES)
            for cell in row.cells
            if not np.isfinite(number(cell))
        )
    )


@dataclass(frozen=True)
class Format:
    """A layout of files of moduli."""

    name: str
    # regular expression, found in the first lines of a file, or in its name
    signature: str
    tables: Callable[[Sheet], list[TitledTable]]
    # "shear" or "tensile", where the format says it and the titles do not
    kind: Literal["shear", "tensile"] | None = None
    shifted: bool = False  # whether files of it are master curves

    def recognises(self, sheet: Sheet) -> bool:
        """Whether a file is of this format."""
        head = "\n".join(sheet.lines[:200]) if sheet.lines else ""
        return (
            re.search(self.signature, f"{head}\nfile name: {sheet.name}", re.MULTILINE)
            is not None
        )


def format_of(sheet: Sheet) -> Format:
    """The first format of the register that a file is of."""
    return next(one for one in FORMATS if one.recognises(sheet))


def _q800(sheet: Sheet) -> list[TitledTable]:
    """TA Instruments Q800: titles in the lines Sig1, Sig2, ..., numbers below
    StartOfData.
    """
    lines = [line.split("\t") for line in sheet.lines]
    titles = [
        cells[1].strip()
        for cells in lines
        if re.fullmatch(r"Sig\d+", cells[0]) and len(cells) > 1
    ]
    start = next(
        i for i, cells in enumerate(lines) if cells[0].strip().lower() == "startofdata"
    )
    rows = [
        Row(i, [cell.strip() for cell in cells])
        for i, cells in enumerate(lines, start=1)
        if i > start + 1
    ]
    rows = with_points(rows, "\t")
    # -1, -2: marks of events
    rows = [row for row in rows if len(row.cells) > 1 and not number(row.cells[0]) < 0]
    return [
        TitledTable([Head(i, title, "") for i, title in enumerate(titles)], rows, [])
    ]


def _reptate(sheet: Sheet) -> list[TitledTable]:
    """RepTate: parameters in the first line ("T=-10;Mw=33.6;"), titles and units at
    tabs, numbers at blanks.
    """
    rows = [Row(i, line.split()) for i, line in enumerate(sheet.lines, start=1)]
    rows = [
        row
        for row in rows
        if len(row.cells) > 1
        and all(np.isfinite(number(cell)) for cell in row.cells[:2])
    ]
    if not rows:
        return []
    above = [
        line.split("\t") for line in sheet.lines[: rows[0].line - 1] if "\t" in line
    ]
    heads, units = [*above, [], []][:2]
    kind = sheet.name.lower().rpartition(".")[2]
    if len(heads) < 2 or kind in _BARE:
        heads, units = _BARE.get(kind, (["omega", "G'", "G''"], ["rad/s", "Pa", "Pa"]))
    given = dict(
        re.findall(
            r"(?:^|;)\s*(T|stress)\s*=\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(?=;|$)",
            sheet.lines[0],
        )
    )
    fixed = {"temperature": float(given["T"]) + 273.15} if "T" in given else {}
    if kind == "creep" and "stress" in given:
        fixed["stress"] = float(given["stress"])
    # its column of temperatures is that of the isotherms
    master = re.search(r"\.tts$", sheet.name, re.IGNORECASE)
    units = [*units, *[""] * len(heads)]
    read = [
        Head(i, title, units[i])
        for i, title in enumerate(heads)
        if not (master and title.startswith("T"))
    ]
    return [TitledTable(read, rows, [], fixed=fixed)]


# RepTate's columns and units
_BARE = {"gt": (["t", "G(t)"], ["s", "Pa"]), "creep": (["t", "strain [-]"], ["s", ""])}
_PARAMETERS = r"\A\s*(?!sep=)(\w+=[^;\n]*;)+\s*$"
FORMATS = (
    Format(
        "RepTate master curve",
        r"^file name: .*\.[tT][tT][sS]$",
        _reptate,
        "shear",
        shifted=True,
    ),
    Format(
        "RepTate",
        rf"^file name: .*\.(osc|gt|creep|OSC|GT|CREEP)$|{_PARAMETERS}",
        _reptate,
        "shear",
    ),
    Format("TA Q800", r"^StartOfData\s*$", _q800),
    Format("TRIOS", r"^\[[Ss]tep\]", tables),
    Format("Netzsch DMA", r"^##Temp\.?/", tables),
    Format("RheoCompass", r"^Interval and data points:", tables),
    Format("table", "", tables),
)
