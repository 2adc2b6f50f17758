"""Titles of columns from the line that they stand in: without a comment mark, and cut as the rows below are."""

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Sequence

from .cells import Row, number

_MARK = re.compile(r"\s*(?:#+|%+|//+|;+)\s*")  # begins a line that programs which want numbers pass over
_BRACKETS = re.compile(r"[\[(][^\[\]()]*[\])]")
_WORDS = re.compile(
    r"\b(storage|loss|complex|relaxation|phase|tan|angular|sample|shear|tensile)\s+"
    r"(?=(modulus|factor|tangent|angle|delta|δ|frequency|temp|storage|loss|relaxation))",
    re.IGNORECASE,
)
_IN_A_CELL = re.compile(r"\s*[#%]\s*[,;\t]")
_GLUE = "\0"
_LONGEST = 5000  # characters of a line of titles
_COPY = re.compile(r"(.*\S)\.\d+")  # what pandas makes of a title that it has met before


def bare(line: str) -> str:
    """A line without the comment mark that it may begin with."""
    return line[match.end() :] if (match := _MARK.match(line)) else line


def is_remark(line: str) -> bool:
    """Whether a line begins with a mark that no table of numbers begins with; one in a cell of its own is a unit."""
    return line.lstrip().startswith(("#", "%", "//")) and not _IN_A_CELL.match(line)


def titles(row: Row, line: str | None, width: int) -> list[str]:
    """The titles in a row above rows of `width` cells (0 where there are none).

    `line` is the text of the row where it is cut at blanks, and is cut in the first way that gives as many titles as
    there are cells: with "G' [Pa]" as one title, at two blanks or more, at other separators, behind brackets. A mark
    such as # that is a cell by itself is a title (of numbers of points) where the rows have a cell for it.
    """
    if line is not None:
        cuts = (cut for text in (bare(line), line) for cut in _cuts(text) if len(cut) == width)
        return _originals(next(cuts, None) or next(_cuts(bare(line))))
    cells = row.cells
    match = _MARK.match(cells[0]) if cells else None
    if match is None:
        return _originals(cells)
    rest = cells[0][match.end() :]
    if rest or len(cells) == width:
        return _originals([rest or cells[0], *cells[1:]])
    return _originals(cells[1:])


def widths(rows: Sequence[Row]) -> list[int]:
    """How many cells most of the next rows of numbers have, for each row that holds none; 0 where there are none."""
    found, counts, run = [0] * len(rows), Counter(), False
    for i in reversed(range(len(rows))):
        if is_numeric(rows[i]):
            counts = counts if run else Counter()
            run = True
            counts[len(rows[i].cells)] += 1
        elif any(rows[i].cells) or rows[i].line == 0:
            counts = Counter() if rows[i].line == 0 else counts
            found[i] = max(counts, key=lambda width: counts[width], default=0)
            run = False
    return found


def is_numeric(row: Row) -> bool:
    """Whether a row holds two numbers at least, and so belongs to a table."""
    known = 0
    for cell in row.cells:
        known += number(cell) is not None
        if known == 2:
            return True
    return False


def _cuts(line: str) -> Iterator[list[str]]:
    """A line of titles in the ways that it may be meant."""
    text = line.strip()
    if len(text) > _LONGEST:
        yield text.split()
        return
    inside = _BRACKETS.sub(lambda match: re.sub(r"\s+", _GLUE, match[0]), text)
    joined = re.sub(r"(?<=\S)\s+(?=[\[(])", _GLUE, inside)
    joined = re.sub(r"\s+/\s+", f"{_GLUE}/{_GLUE}", joined)
    yield [cell.replace(_GLUE, " ") for cell in joined.split()]
    if '"' in text:
        yield next(csv.reader(io.StringIO(text), delimiter=" ", skipinitialspace=True), [])
    yield [cell.replace(_GLUE, " ") for cell in _WORDS.sub(rf"\1{_GLUE}", joined).split()]
    yield [cell.strip() for cell in re.split(r"\s{2,}|\t", text)]
    for mark in ",;|":
        yield [cell.strip() for cell in text.split(mark)]
    yield [cell.strip() for cell in re.findall(r"[^\[\]()]+(?:\[[^\[\]]*\]|\([^()]*\)|$)", text) if cell.strip()]
    if not _BRACKETS.sub("", text).strip():  # units
        yield text.split()


def _originals(cells: list[str]) -> list[str]:
    """Titles without the numbers that tell copies of one title apart: "G' [Pa].1"."""
    found = [_COPY.fullmatch(cell) for cell in cells]
    return [match[1] if match and match[1] in cells else cell for match, cell in zip(found, cells, strict=True)]
