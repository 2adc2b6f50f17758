"""The tables in a file: headers that are understood, each with the rows below it."""

from collections.abc import Iterator, Sequence

from ...errors import InputError
from .cells import Row, Sheet, number
from .columns import Column, is_complete, is_unit_row, named, understand
from .headers import bare, is_numeric, titles, widths
from .measurements import Block, Options
from .temperatures import Above, above, check_agree, unread


def blocks(sheet: Sheet, options: Options) -> Iterator[Block]:
    """Headers that are understood, each with the rows below it up to the next header, or to the next line that gives
    a temperature where there is no column of it.

    Raises `InputError` where a header that is cut at blanks has not as many titles as its rows have cells.
    """
    rows = sheet.rows
    lines = sheet.text.splitlines() if sheet.separator == " " else None
    below, told = widths(rows), ()
    lines_above: list[tuple[Above, ...]] = []  # that give a temperature, since the last row of numbers
    found: Block | None = None
    skip = -1
    for i, row in enumerate(rows):
        if i == skip or not (any(row.cells) or row.line == 0):
            continue
        if row.line == 0:  # the end of a sheet
            yield from _whole(found)
            found, told, lines_above = None, (), []
            continue
        if is_numeric(row):
            if found is not None:
                found.rows.append(row)
                lines_above = []
            continue
        following = next((k for k in range(i + 1, len(rows)) if any(rows[k].cells) or rows[k].line == 0), i)
        heads = titles(row, lines[row.line - 1] if lines else None, below[i])
        units = _units(rows[following], len(heads))
        untitled = [f"column {k}" for k in range(len(heads) + 1, below[i] + 1)] if lines else []
        columns = with_named([*heads, *untitled], understand(heads, units), units, options)
        if is_complete(columns):
            yield from _whole(found)
            if not told and found is not None and not found.rows:
                told = found.above  # a line of prose had been taken for the header
            if lines and units and below[i] == len(heads) != len(units):
                raise InputError(
                    f"line {rows[following].line} has {len(units)} units, cut at blanks, and {len(heads)} titles stand "
                    "above it: write - for no unit, or the units into the titles."
                )
            if options.temperature is None and all(column.role != "temperature" for column in columns):
                check_agree(lines_above)
            found = _block(heads, columns, below[i] if lines else 0, options, told)
            told, skip = (), following if units else -1
            continue
        here = above(row.cells)
        lines_above += [here] if len(here) == 1 else []
        told = here or told
        if len(here) == 1 and found is not None and all(column.role != "temperature" for column in found.columns):
            yield from _whole(found)
            if options.temperature is None:
                check_agree(lines_above)
            found, told = found._replace(rows=[], above=here), ()
        elif found is not None and _broken([cell for cell in row.cells if cell]):
            found.rows.append(row)  # counted as bad below
        elif found is not None and found.rows and _told_above(found) and (text := unread(row.cells)):
            raise InputError(
                f"line {row.line}, {text!r}, seems to give the temperature of the rows below it, but cannot be "
                "understood: write it as 'T = -20 degC', or give the temperatures in a column."
            )
        elif found is not None and found.rows and row.cells[0].startswith("["):
            yield from _whole(found)
            found = None
    yield from _whole(found)


def with_named(heads: Sequence[str], columns: list[Column], units: list[str], options: Options) -> list[Column]:
    """Adds the columns that the user named."""
    understood = columns
    for role, wanted in options.columns.items():
        if isinstance(wanted, int) and not isinstance(wanted, bool):
            place = wanted - 1
        else:
            place = next((i for i, title in enumerate(heads) if title.strip() == str(wanted).strip()), -1)
        if not 0 <= place < len(heads):
            continue
        known = next((column for column in understood if column.place == place), None)
        below = units[place] if place < len(units) else None
        columns = [column for column in columns if column.place != place and column.role != role]
        columns.append(named(role, place, heads[place], below, known))
    return columns


def _units(row: Row, width: int) -> list[str]:
    """The units that a row gives, an empty list where it gives none; it may be a comment, as the header above it.

    A first cell of % or # is a unit where there is a title for it, and else the mark of a comment.
    """
    if len(row.cells) == width and is_unit_row(row.cells):
        return row.cells
    cells = [bare(cell) for cell in row.cells[:1]] + row.cells[1:]
    if row.cells and row.cells[0] and not cells[0]:
        cells = cells[1:]
    return cells if is_unit_row(cells) else []


def _block(heads: list[str], columns: list[Column], width: int, options: Options, told) -> Block:
    """A header without rows as yet; where its titles cannot be told apart, only columns named by number count."""
    if width in (0, len(heads)):
        return Block(columns, [], heads, told, width)
    numbered = [f"column {i}" for i in range(1, width + 1)]
    by_number = options._replace(columns={role: at for role, at in options.columns.items() if isinstance(at, int)})
    columns = with_named(numbered, [], [], by_number)
    return Block(columns if is_complete(columns) else [], [], heads, told, width)


def _told_above(block: Block) -> bool:
    """Whether the temperature of a block stands above it, and in no column."""
    return bool(block.above) and all(column.role != "temperature" for column in block.columns)


def _whole(block: Block | None) -> Iterator[Block]:
    """A block that has rows."""
    if block is None or not block.rows:
        return
    if not block.columns:
        raise InputError(
            f"the header {' '.join(block.titles)[:80]!r}, cut at blanks, has {len(block.titles)} titles, and the rows "
            f"below it have {block.width} cells: write titles without blanks in them, separate all by commas or tabs, "
            "or name every column by its number, as columns={'storage': 3} (--column storage=3)."
        )
    yield block


def _broken(cells: list[str]) -> bool:
    """Whether what is left of a row belongs to a table, and is no remark: several cells, or a number first."""
    return len(cells) > 2 or number(cells[0]) is not None
