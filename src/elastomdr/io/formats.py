"""The register of formats of moduli: each with its name, how a file of it is
recognised, and how its tables are found.

A format whose titles stand right above its numbers needs no code: `TABLE` reads it,
with the units behind the titles or below them. A format that keeps titles or
temperatures elsewhere says in `tables` where.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .sheets import Row, Sheet, number, with_points
from .tables import Head, Table, tables


@dataclass(frozen=True)
class Format:
    """A layout of files of moduli."""

    name: str
    # regular expression, found in the first lines of a file, or in its name
    signature: str
    tables: Callable[[Sheet], list[Table]]
    # "shear" or "tensile", where the format says it and the titles do not
    kind: str = ""
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


def _q800(sheet: Sheet) -> list[Table]:
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
    return [Table([Head(i, title, "") for i, title in enumerate(titles)], rows, [])]


def _reptate(sheet: Sheet) -> list[Table]:
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
    return [Table(read, rows, [], fixed=fixed)]


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
