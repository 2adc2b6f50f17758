"""Readers that take the process with them when a file is damaged: a program of its own,
run by `sheets.py`, so that this costs a child and not the session.

A damaged .xls can make its reader, which is written in Rust, panic, ask for all the
memory there is, or abort the process. SurfaceTopography takes seconds to load and knows
some forty formats of instruments, most of them binary.
"""

import contextlib
import datetime
import io
import json
import re
import sys
import zipfile

# of all sheets: a few kilobytes can hold a thousand times as many
MOST_CELLS = 5_000_000


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


def spreadsheet(path: str) -> int:
    """Prints the sheets as JSON, names and rows, every cell a text, and returns 0, or
    prints why not and returns 1.
    """
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


def instrument(path: str) -> int:
    """Prints a surface as an .npz file: x, y (empty for a profile), heights with NaN in
    holes, the unit, and whether the file says the size.

    Where it does not, x and y count points. Returns 0, or prints why not and 1.
    """
    import numpy as np
    from SurfaceTopography import open_topography  # pyright: ignore[reportMissingImports]

    try:
        with contextlib.redirect_stdout(sys.stderr):
            reader = open_topography(path)
            channel = reader.default_channel
            sized = channel.physical_sizes is not None
            topography = (
                reader.topography()
                if sized
                else reader.topography(physical_sizes=channel.nb_grid_pts)
            )
            height = np.ma.filled(
                np.ma.asarray(topography.heights(), dtype=float), np.nan
            )
            if topography.dim == 1:
                x, y = np.asarray(topography.positions(), dtype=float), np.empty(0)
            else:
                x, y = (
                    np.arange(n) * size / n
                    for n, size in zip(
                        topography.nb_grid_pts, topography.physical_sizes, strict=True
                    )
                )
    except Exception as error:  # whatever one of forty parsers may raise
        print(f"{type(error).__name__}: {error}")
        return 1
    buffer = io.BytesIO()
    np.savez(
        buffer,
        x=x,
        y=y,
        height=height,
        unit=np.array(topography.unit or ""),
        sized=np.array(sized),
    )
    sys.stdout.buffer.write(buffer.getvalue())
    return 0


# each with the bytes of address space that it may take
READERS = {
    "spreadsheet": (spreadsheet, 4_000_000_000),
    "instrument": (instrument, 8_000_000_000),
}

if __name__ == "__main__":
    reader, most = READERS[sys.argv[1]]
    # Windows has no such limits
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    sys.exit(reader(sys.argv[2]))
