"""Reading a roughness spectrum: a table of wave numbers, spatial frequencies or wavelengths, and of C, with units.

q = 2 pi/lambda [rad/m]. What a title leaves open is the user's to say: 1/m may stand for 2 pi/lambda or for 1/lambda,
and how C is normalised (`convention`) is never in a table.
"""

import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from ..._runtime import plain, positive
from ...errors import InputError
from ...mapping.measured import MeasuredSpectrum, from_spectrum
from ...mapping.spectrum import check_convention
from .table import METRES, Table, read_table

ANGULAR, CYCLES, WAVELENGTH = "2 pi/lambda", "1/lambda", "lambda"
_LENGTH = r"(nm|um|mm|cm|m)"
_FIRST = {
    ANGULAR: rf"rad/{_LENGTH}|rad[ *.]?{_LENGTH}\^?-1",
    CYCLES: rf"(?:cycles?|cyc|lp|periods?)/{_LENGTH}",
    WAVELENGTH: _LENGTH,
    "": rf"1?/{_LENGTH}|{_LENGTH}\^?-1",  # either of the first two
}
_SECOND = re.compile(rf"{_LENGTH}\^?(\d)(?:[ *.]?{_LENGTH}\^?(\d))?")
_SPELLED = str.maketrans(
    {"µ": "u", "μ": "u", "⁻": "-", "¹": "1", "²": "2", "³": "3", "⁴": "4", "·": "*", "\u2212": "-"}
)
_LARGEST = 1e100
# Titles without blanks, brackets and signs of multiplication: what they say that the numbers are. Nothing is concluded
# from one that says anything else besides.
_NAME = r"(?:(?:spatial|wave|number|vector|frequency|angular|q|k|f|n)+[=:,]?)?"
_TOLD = {ANGULAR: rf"{_NAME}2pix?1?/lambda", CYCLES: rf"(?!.*angular){_NAME}1/lambda"}
_LOGARITHM = re.compile(r"(?<![a-z])(?:log|lg|ln)(?![a-z]{2}|[ _-]*(?:spac|scale|grid|bin))")


def spectrum_from_file(
    path: str | os.PathLike[str],
    *,
    convention: str,
    wave_number: str | None = None,
    q_unit: str | None = None,
    c_unit: str | None = None,
    columns: tuple[int, int] | None = None,
    longest: Any = None,
    shortest: Any = None,
) -> MeasuredSpectrum:
    """A surface from a text file of its power spectrum: wave numbers and C, with titles such as "q [rad/m], C [m^4]".

    `convention` is that of `em.Spectrum`, with q = 2 pi/lambda: a density over f = 1/lambda is "2d/4pi^2", "1d/2pi" or
    "1d one-sided/2pi". `wave_number`, "2 pi/lambda" or "1/lambda", says what a unit such as 1/mm counts; rad/mm,
    cycles/mm, wavelengths (mm) and titles such as "1/lambda [1/mm]" need none. `q_unit` and `c_unit` stand in for units
    that the titles do not give, or of which the title says another thing ("1/lambda [rad/m]"); `columns` names two of
    several, from 1. `longest` and `shortest` [m] cut the table. Rows without a number, repeated and unsorted ones are
    mended and named in `report`. Raises `InputError`, with file, line and value.
    """
    check_convention(convention)
    if wave_number not in (None, ANGULAR, CYCLES):
        raise InputError(f"wave_number must be {ANGULAR!r} or {CYCLES!r}, got {wave_number!r}.")
    cutoffs = [None if wave is None else 2 * np.pi / _wave(key, wave) for key, wave in
               (("longest", longest), ("shortest", shortest))]  # fmt: skip
    name = Path(path).name
    table = read_table(path, "wave numbers and spectrum", lambda text: bool(_first(text) or _second(text)))
    first, second = _columns(table, columns, name)
    for place in (first, second):
        if table.titles and _LOGARITHM.search(table.titles[place].lower()):
            raise InputError(
                f"path: {name!r} has logarithms in column {place + 1}, {table.titles[place]!r}: turn them into numbers "
                "first, or name other columns, as columns = [1, 2]."
            )
    given = _unit(table, first, q_unit, "q_unit", "rad/m", name, _first)
    counted, metres = _first(given) or ("", 1.0)
    title = _bare(table.titles[first]) if table.titles else ""
    told = _told(title)
    if q_unit is None and _contradicts(title, told, counted):
        raise InputError(
            f"path: {name!r} has the title {table.titles[first]!r} with the unit {given!r}, which contradict each "
            f"other: say what the numbers are, as q_unit = 'rad/m', 'cycles/m' or, for wavelengths, 'm'."
        )
    told = None if counted else told
    if told and wave_number not in (None, told):
        raise InputError(f"wave_number is {wave_number!r}, but {name!r} says {table.titles[first]!r}.")
    wave_number = wave_number or told
    if not counted and wave_number is None:
        raise InputError(
            f"path: {name!r} gives wave numbers in {given}, which may be q = 2 pi/lambda or 1/lambda: say so, as "
            f"wave_number = {ANGULAR!r} or {CYCLES!r}."
        )
    if counted and wave_number not in (None, counted):
        raise InputError(f"wave_number is {wave_number!r}, but {name!r} gives {given}, which is {counted}.")
    said = _unit(table, second, c_unit, "c_unit", "m^4", name, _second)
    factor, power = _second(said) or (1.0, 0)
    wanted = 4 if convention.startswith("2d") else 3
    if power != wanted:
        raise InputError(
            f"path: {name!r} gives C in {said}, but convention {convention!r} needs m^{wanted}: m^4 is the spectrum of "
            "a surface (2d), m^3 that of a straight cut (1d)."
        )
    rows = _rows(table, first, second, name)
    x, c = table.data[rows, first], table.data[rows, second] * factor
    q = 2 * np.pi / (x * metres) if counted == WAVELENGTH else x / metres
    q = q * (2 * np.pi if (counted or wave_number) == CYCLES else 1.0)
    if not (np.all(q < _LARGEST) and np.all(c < _LARGEST)):
        raise InputError(f"path: {name!r} must hold numbers below {_LARGEST:g} in SI units.")
    try:
        found = from_spectrum(q, c, convention, *cutoffs)
    except InputError as error:
        raise InputError(f"path: {name!r}: {error}") from error
    left = len(table.lines) - rows.size
    if left:
        out = [line for i, line in enumerate(table.lines) if i not in set(rows.tolist())]
        shown = ", ".join(map(str, out[:5])) + (", ..." if left > 5 else "")
        text = f"{left} of {len(table.lines)} rows without a number, or at q = 0, left out (line {shown})"
        object.__setattr__(found, "report", (text, *found.report))
    return found


def _first(text: str) -> tuple[str, float] | None:
    """What a unit of the first column counts, empty where that is open, and its length in metres."""
    bare = text.translate(_SPELLED).replace("**", "^").strip()
    for counted, pattern in _FIRST.items():
        match = re.fullmatch(pattern, bare)
        if match:
            return counted, METRES[next(length for length in match.groups() if length)]
    return None


def _bare(title: str) -> str:
    """A title in one spelling, without unit, blanks, brackets and signs of multiplication."""
    text = title.partition("[")[0].lower()
    for old, new in (
        ("λ", "lambda"),
        ("π", "pi"),
        ("\u00d7", "x"),
        ("wavelength", "lambda"),
        ("wave length", "lambda"),
    ):
        text = text.replace(old, new)
    return re.sub(r"[\s*()·{}$\\]", "", text)


def _told(bare: str) -> str | None:
    """What a title spells out that its numbers are, such as "1/lambda [1/mm]"; None if that is not plain."""
    return next((counted for counted, pattern in _TOLD.items() if re.fullmatch(pattern, bare)), None)


def _contradicts(bare: str, told: str | None, counted: str) -> bool:
    """Whether a title and its unit cannot both be right, such as "1/lambda [rad/m]" or "lambda [1/m]"."""
    lengths = re.fullmatch("(lambda)+", bare) is not None
    if counted == WAVELENGTH:
        return not lengths and ("/lambda" in bare or "lambda^-" in bare or re.fullmatch(_NAME, bare or "-") is not None)
    return lengths or bool(counted and "lambda" in bare and told != counted)


def _second(text: str) -> tuple[float, int] | None:
    """Factor to SI and power of metres of a unit of C."""
    match = _SECOND.fullmatch(text.translate(_SPELLED).replace("**", "^").strip())
    if match is None:
        return None
    one, two = int(match[2]), int(match[4] or 0)
    return METRES[match[1]] ** one * (METRES[match[3]] ** two if two else 1.0), one + two


def _columns(table: Table, columns: Any, name: str) -> tuple[int, int]:
    count = len(table.units)
    if columns is None:
        if count != 2:
            listed = ", ".join(f"{i}: {title}" for i, title in enumerate(table.titles, start=1)) or "no titles"
            raise InputError(
                f"path: {name!r} has {count} columns ({listed}); say which are the wave number and C, as "
                "columns = [1, 2]."
            )
        return 0, 1
    whole = isinstance(columns, (tuple, list)) and all(type(i) is int and 1 <= i <= count for i in columns)
    if not whole or len(columns) != 2:
        raise InputError(f"columns must be two numbers from 1 to {count}, got {columns!r}.")
    return columns[0] - 1, columns[1] - 1


def _unit(table: Table, place: int, user: Any, key: str, example: str, name: str, known: Any) -> str:
    """The unit of a column, from its title or else from the user, who does not overrule it."""
    if user is not None and (not isinstance(user, str) or known(user) is None):
        raise InputError(f"{key} must be a unit such as {example}, got {user!r}.")
    said = table.units[place]
    if known(said) is not None:
        if user is not None and known(user) != known(said):
            if key == "q_unit" and _settles(table, place, user):
                return user
            raise InputError(f"{key} is {user!r}, but {name!r} says {said!r}.")
        return said
    if user is not None:
        return user
    title = f" {table.titles[place]!r}" if table.titles else ""
    wrong = f"a unit that is not known, {said!r}" if said else "no unit"
    raise InputError(
        f"path: {name!r} has {wrong} in column {place + 1}{title}; write titles such as "
        f'"q [rad/m], C [m^4]", or give {key} = {example!r}.'
    )


def _settles(table: Table, place: int, user: str) -> bool:
    """Whether a unit says which of a title and its unit, which contradict each other, is right; of the same length."""
    (counted, metres), (_, length) = _first(table.units[place]) or ("", 1.0), _first(user) or ("", 0.0)
    bare = _bare(table.titles[place]) if table.titles else ""
    return _contradicts(bare, _told(bare), counted) and metres == length


def _rows(table: Table, first: int, second: int, name: str) -> np.ndarray:
    """The rows that hold two numbers. Raises `InputError` for what no spectrum holds, with line and value."""
    x, c = table.data[:, first], table.data[:, second]
    used = np.isfinite(x) & np.isfinite(c) & (x != 0)
    for place, what, values in ((first, "wave number", x), (second, "C", c)):
        wrong = np.flatnonzero(used & ~(values > 0))
        if wrong.size:
            hint = " Logarithms must be turned into numbers first." if wrong.size > used.sum() / 4 else ""
            raise InputError(
                f"path: {name!r} has {what} {table.cells[wrong[0]][place]} in line {table.lines[wrong[0]]}, which must "
                f"be positive ({wrong.size} such rows).{hint}"
            )
    if used.sum() < 3:
        raise InputError(f"path: {name!r} must have three rows of numbers or more, got {int(used.sum())}.")
    return np.flatnonzero(used)


def _wave(key: str, wave: Any) -> float:
    value = float(plain(key, wave))
    positive(key, value)
    return value
