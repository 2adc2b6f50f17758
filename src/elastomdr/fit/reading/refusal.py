"""Why nothing in a file is read as a measurement, and what would help."""

from .blocks import with_named
from .cells import Sheet
from .columns import UNITS, Column, is_complete, measure, title_unit, unclear_logarithm, understand
from .headers import titles, widths
from .logarithms import other_logarithm
from .measurements import Options


def no_columns(sheet: Sheet, options: Options) -> str:
    """What is wrong with a file without a header that is understood, in words."""
    rows = sheet.rows
    if not any(any(row.cells) for row in rows):
        return "the file is empty."
    lines = sheet.text.splitlines() if sheet.separator == " " else None
    heads = [
        titles(row, lines[row.line - 1] if lines and row.line else None, width) if any(row.cells) else []
        for row, width in zip(rows, widths(rows), strict=True)
    ]
    understood = [with_named(head, understand(head, []), [], options) for head in heads]
    if any(map(is_complete, understood)):
        return "there are no numbers below the header."
    found = {column.role for columns in understood for column in columns}
    absent = [role for role in ("storage", "loss") if role not in found]
    if {"frequency", "omega"} & found and len(absent) == 1:
        return (
            f"there is no {absent[0]} modulus: friction needs the storage modulus with the loss modulus or "
            f"tan delta, or |G*| with tan delta or the phase angle. Name its column, as columns={{{absent[0]!r}: "
            f"'Modulus 1'}} (--column {absent[0]}='Modulus 1')."
        )
    unclear = [cell for row in rows for cell in row.cells if other_logarithm(cell)]
    if unclear:
        return unclear_logarithm(unclear[0])
    shown = next((row.cells for row in rows if sum(bool(cell) for cell in row.cells) >= 2), [])
    place = _modulus(heads, understood)
    wanted = "{'storage': 'Modulus 1'} (--column storage='Modulus 1')"
    if place:
        wanted = f"{{'relaxation': {place}}} (--column relaxation={place})"
    return (
        "no header names frequency, storage and loss modulus (or time and relaxation modulus); "
        f"the first row is {', '.join(cell for cell in shown[:8] if cell) or 'empty'}. Name the columns, as "
        f"columns={wanted}."
    )


def _modulus(heads: list[list[str]], understood: list[list[Column]]) -> int:
    """The column, from 1, that may be the relaxation modulus beside one of times; 0 where there is none."""
    for head, columns in zip(heads, understood, strict=True):
        roles = {column.role for column in columns}
        if "time" in roles and not {"frequency", "omega"} & roles:
            known = {column.place for column in columns if measure(column.role) != "modulus"}
            left = [place for place in range(len(head)) if place not in known]
            moduli = [place for place in left if title_unit(head[place]) in UNITS["modulus"]]
            return next(iter([*moduli, *left]), -1) + 1
    return 0
