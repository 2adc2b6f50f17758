"""Reads a spreadsheet and prints its sheets as JSON, every cell a text: a program of
its own, run by `sheets.py`.

A damaged .xls can make the reader, which is written in Rust, panic, ask for all the
memory there is, or abort the process; here that costs a child and not the session.
"""

import contextlib
import datetime
import json
import re
import sys
import zipfile

# of all sheets: a few kilobytes can hold a thousand times as many
MOST_CELLS = 5_000_000
MOST_MEMORY = 4_000_000_000  # bytes of address space


# A cell with a formula and no value behind it; Excel writes an empty text (t="str") as
# an empty value.
_BARE_FORMULA = re.compile(
    rb"<c(?![^>]* t=\"str\")[^>]*><f(?: [^>]*)?(?:/>|>[^<]*</f>)\s*(?:<v\s*/>|<v></v>)?\s*</c>"
)
FORMULAS = (
    "its formulas have no values: open it in Excel or LibreOffice and save it there, "
    "or export it as .csv"
)


def cell_text(cell: object) -> str:
    """A cell as a text; a number with all its digits, a duration as hh:mm:ss."""
    if isinstance(cell, datetime.timedelta):
        seconds = cell.total_seconds()
        return (
            f"{int(seconds // 3600)}:{int(seconds // 60 % 60):02d}:{seconds % 60:09.6f}"
        )
    return repr(cell) if isinstance(cell, float) else str(cell).strip()


def formulas_without_values(path: str) -> bool:
    """Whether an .xlsx holds formulas that no program has computed: a library wrote
    it.
    """
    if not zipfile.is_zipfile(path):
        return False
    with zipfile.ZipFile(path) as book:
        sheets = [
            name
            for name in book.namelist()
            if re.fullmatch(r"xl/worksheets/[^/]+\.xml", name)
        ]
        return any(_BARE_FORMULA.search(book.read(name)) for name in sheets)


def main(path: str) -> int:
    """Prints the name and the rows of each sheet and returns 0, or prints why not and
    returns 1.
    """
    # Windows has no such limits
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    from python_calamine import CalamineError, CalamineWorkbook

    try:
        book = CalamineWorkbook.from_path(path)
        sheets = {
            name: book.get_sheet_by_name(name).to_python(skip_empty_area=False)
            for name in book.sheet_names
        }
        if formulas_without_values(path):
            print(FORMULAS)
            return 1
    except (CalamineError, OSError, ValueError, zipfile.BadZipFile) as error:
        print(error)
        return 1
    if sum(len(row) for sheet in sheets.values() for row in sheet) > MOST_CELLS:
        print(f"more than {MOST_CELLS / 1e6:g} million cells")
        return 1
    json.dump(
        {
            name: [[cell_text(cell) for cell in row] for row in sheet]
            for name, sheet in sheets.items()
        },
        sys.stdout,
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
