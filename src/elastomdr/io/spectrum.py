"""`em.read_spectrum`: a table of wave numbers, spatial frequencies or wavelengths, and
of the power spectrum C.

q = 2 pi/lambda [rad/m]. What a title leaves open is the user's to say: 1/m may stand
for 2 pi/lambda or for 1/lambda, and how C is normalised (`convention`) is never in a
table.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..checks import in_si, one_of, plain, positive
from ..errors import InputError
from ..files import file_as_typed
from ..surface.spectrum import check_convention
from ..surface.topography import MeasuredSpectrum, from_spectrum
from ..units.registry import is_level, to_si
from .columns import logarithm
from .sheets import read_sheet
from .tables import (
    Head,
    TitledTable,
    clean,
    listed,
    main_table,
    named_heads,
    refuse_ragged,
    splits,
    titled_unit,
)

if TYPE_CHECKING:
    from .._types import Convention

ANGULAR, CYCLES, WAVELENGTH = "2 pi/lambda", "1/lambda", "lambda"
_LARGEST = 1e100
# Titles without blanks, brackets and signs of multiplication: what they say that the
# numbers are. Nothing is concluded from one that says anything else besides.
_NAME = r"(?:(?:spatial|wave|number|vector|frequency|angular|q|k|f|n)+[=:,]?)?"
_COUNTED = {
    ANGULAR: rf"{_NAME}2pix?1?/lambda",
    CYCLES: rf"(?!.*angular){_NAME}1/lambda",
    WAVELENGTH: "(?:lambda)+",
}


@in_si
def read_spectrum(
    path: str | os.PathLike[str],
    *,
    convention: Convention,
    wave_number: str | None = None,
    q_unit: str | None = None,
    c_unit: str | None = None,
    columns: Sequence[int | str] | None = None,
    longest: float | None = None,
    shortest: float | None = None,
) -> MeasuredSpectrum:
    """A surface from a table of its power spectrum, with titles such as "q [rad/m], C
    [m^4]".

    Args:
        path: a text file or a spreadsheet with wave numbers (rad/mm), spatial
            frequencies (cycles/mm, or 1/mm under a title "1/lambda") or wavelengths
            (mm), and C.
        convention: how C is normalised, as in `em.Spectrum`, with q = 2 pi/lambda; a
            density over 1/lambda is "2d/4pi^2", "1d/2pi" or "1d one-sided/2pi".
        wave_number: "2 pi/lambda" or "1/lambda", what a unit such as 1/mm counts where
            the title does not say.
        q_unit: unit of the first column where its title has none, or contradicts it.
        c_unit: unit of C where its title has none.
        columns: the two columns by number from 1 or by title, where there are more.
        longest: longest wavelength to keep [m].
        shortest: shortest wavelength to keep [m].

    Returns:
        A surface for `em.friction`; `report` names rows that were left out or mended.

    Raises:
        InputError: for what cannot be read or is ambiguous, with file, line and value.
    """
    check_convention(convention)
    if wave_number is not None:
        one_of("wave_number", wave_number, ANGULAR, CYCLES)
    waves = {"longest": longest, "shortest": shortest}
    for key, wave in waves.items():
        if wave is not None:
            positive(key, plain(key, wave))
    low, high = (wave and 2 * np.pi / float(wave) for wave in waves.values())
    with file_as_typed(path):
        sheet = read_sheet(path)
        name, table = sheet.name, main_table(sheet)
        if table is None:
            raise InputError(
                argument="path",
                accepted="a table of wave numbers and a spectrum, with rows of two "
                "numbers",
            )
        refuse_ragged(table)
        first, second = _columns(table, columns, name)
        q = _wave_numbers(table, first, wave_number, q_unit, name)
        c = _densities(table, second, convention, c_unit, name)
        kept = _rows(table, (first, second), q, c)
    lines = [str(row.line) for row, k in zip(table.rows, kept, strict=True) if not k]
    shown = ", ".join(lines[:5]) + ", ..." * (len(lines) > 5)
    left = (
        f"{len(lines)} of {len(table.rows)} rows without a number, or at q = 0, left "
        f"out (line {shown})"
    )
    try:
        return from_spectrum(
            q[kept], c[kept], convention, low, high, [left] if lines else []
        )
    except InputError as error:
        error.inside(repr(name), "path")
        raise


def _densities(
    table: TitledTable, head: Head, convention: str, c_unit: str | None, name: str
) -> np.ndarray:
    """C [m^4 or m^3]. Raises `InputError` for a unit that the convention excludes."""
    wanted = "m^4" if convention.startswith("2d") else "m^3"
    unit_of_title = titled_unit(head, "m^4", "m^3")[1]
    unit = _given(name, head, unit_of_title, c_unit, "c_unit", "m^4", "m^3")
    si = to_si(unit, wanted)
    if si is None:
        raise InputError(
            argument="c_unit",
            got=unit,
            accepted=f"{wanted} for the convention {convention!r}",
            hint="m^4 is the spectrum of a surface (2d), m^3 that of a straight cut "
            "(1d)",
        )
    return table.column(head.place) * si[0]


def _wave_numbers(
    table: TitledTable,
    head: Head,
    wave_number: str | None,
    q_unit: str | None,
    name: str,
) -> np.ndarray:
    """q [rad/m]; NaN where there is no number, infinite for a wavelength of 0."""
    unit, counts = _unit_and_meaning(head, wave_number, q_unit, name)
    x = table.column(head.place)
    if counts == WAVELENGTH:
        with np.errstate(divide="ignore"):
            return 2 * np.pi / (x * (to_si(unit, "length") or (1.0,))[0])
    # pint knows what a cycle is
    turns = 2 * np.pi if counts == CYCLES and "cycle" not in unit else 1.0
    return x * (to_si(unit, "wave number") or (1.0,))[0] * turns


def _unit_and_meaning(
    head: Head, wave_number: str | None, q_unit: str | None, name: str
) -> tuple[str, str]:
    """The unit of the first column, and what its numbers are, from title, unit or user.
    Raises `InputError` where they contradict each other, or leave it open.
    """
    title, unit_of_title = titled_unit(head, "wave number", "length")
    bare = _bare(title)
    by_title = next(
        (meaning for meaning, form in _COUNTED.items() if re.fullmatch(form, bare)),
        None,
    )
    contradiction = bool(
        unit_of_title and _contradiction(bare, by_title, _counts(unit_of_title))
    )
    if contradiction and q_unit is None:
        raise InputError(
            argument="q_unit",
            got=None,
            accepted="given where title and unit contradict each other, as 'rad/m', "
            "'cycles/m' or, for wavelengths, 'm'",
            hint=f"{name!r} has the title {head.title!r} with the unit "
            f"{unit_of_title!r}",
        )
    known = "" if contradiction else unit_of_title
    unit = _given(name, head, known, q_unit, "q_unit", "wave number", "length")
    by_unit = _counts(unit)
    if by_unit:
        if wave_number not in (None, by_unit):
            raise InputError(
                argument="wave_number",
                got=wave_number,
                accepted=f"left out, or {by_unit!r}",
                hint=f"{name!r} gives {unit}",
            )
        return unit, by_unit
    if wave_number and by_title and wave_number != by_title:
        raise InputError(
            argument="wave_number",
            got=wave_number,
            accepted=f"left out, or {by_title!r}",
            hint=f"{name!r} says {head.title!r}",
        )
    meaning = wave_number or by_title
    if not meaning:
        raise InputError(
            argument="wave_number",
            got=None,
            accepted=f"given, as {ANGULAR!r} or {CYCLES!r}",
            hint=f"wave numbers of {name!r} are in {unit}, which may be q = 2 "
            "pi/lambda or 1/lambda",
        )
    return unit, meaning


def _counts(unit: str) -> str:
    """What a unit counts; empty where that is open, as in 1/m."""
    if to_si(unit, "length"):
        return WAVELENGTH
    return ANGULAR if "rad" in unit else CYCLES if "cycle" in unit else ""


def _contradiction(bare: str, by_title: str | None, counts: str) -> bool:
    """Whether a title and its unit cannot both be right, such as "1/lambda [rad/m]" or
    "lambda [1/m]".
    """
    if counts == WAVELENGTH:
        return by_title != WAVELENGTH and (
            "/lambda" in bare or re.fullmatch(_NAME, bare or "-") is not None
        )
    return by_title == WAVELENGTH or bool(
        counts and "lambda" in bare and by_title != counts
    )


def _bare(title: str) -> str:
    """A title in one spelling, without blanks, brackets and signs of multiplication."""
    lower = title.lower()
    for old, new in (
        ("λ", "lambda"),
        ("π", "pi"),
        ("\u00d7", "x"),
        ("wavelength", "lambda"),
        ("wave length", "lambda"),
    ):
        lower = lower.replace(old, new)
    return re.sub(r"[\s*()·{}$\\]", "", lower)


def _given(
    name: str, head: Head, in_title: str, user: str | None, key: str, *kinds: str
) -> str:
    """The unit of a column, from its title or else from the user, who does not overrule
    it.
    """
    example = {"q_unit": "rad/m", "c_unit": "m^4"}[key]
    if user is not None and (
        not isinstance(user, str) or not any(to_si(user, kind) for kind in kinds)
    ):
        raise InputError(argument=key, got=user, accepted=f"a unit such as {example}")
    if in_title and user is not None and user != in_title:
        raise InputError(
            argument=key,
            got=user,
            accepted=f"left out, or {in_title!r}, as {name!r} says",
        )
    if in_title or user:
        return in_title or str(user)
    raise InputError(
        argument=key,
        got=None,
        accepted=f"given, such as {example!r}, or said by a title",
        hint=f"column {head.words} of {name!r} has no unit that is known; titles are "
        "such as 'q [rad/m], C [m^4]'",
    )


def _columns(
    table: TitledTable, columns: Sequence[int | str] | None, name: str
) -> tuple[Head, Head]:
    count = len(table.heads)
    if columns is None and count != 2:
        raise InputError(
            argument="columns",
            got=None,
            accepted="given, as columns = [N, M], where a table has more than the "
            "wave number and C",
            hint=f"{name!r} has {count} columns ({listed(table.heads)})",
        )
    heads = table.heads if columns is None else named_heads(columns, table, "two ")
    if len(heads) != 2:
        raise InputError(argument="columns", accepted="two", got=columns)
    first, second = heads
    for head in heads:
        if any(is_level(unit) for _, unit in [("", head.below), *splits(head.title)]):
            raise InputError(
                argument="path",
                accepted="a table of numbers, not of levels in dB",
                hint=f"column {head.words} has levels: turn them into numbers first. "
                "Levels L re 1e-6 m of bands (ISO 13473-4) are C = 1e-12 m^2 "
                '10^(L/10)/width with convention="1d one-sided", the width of a '
                "band being 0.2316 q for third octaves and 0.7071 q for "
                "octaves, q = 2 pi/lambda [rad/m].",
            )
        if logarithm(clean(head.title))[0] and not re.search(
            "spac|scale|grid|bin", head.title
        ):
            raise InputError(
                argument="path",
                accepted="a table of numbers, not of logarithms",
                hint=f"column {head.words} has logarithms: turn them into numbers "
                "first, or name other columns, as columns = [N, M]",
            )
    return first, second


def _rows(
    table: TitledTable,
    heads: tuple[Head, Head],
    q: np.ndarray,
    c: np.ndarray,
) -> np.ndarray:
    """Which rows hold two numbers. Raises `InputError` for what no spectrum holds, with
    line and value.
    """
    used = np.isfinite(q) & np.isfinite(c) & (q != 0)
    for head, quantity, values in zip(heads, ("wave number", "C"), (q, c), strict=True):
        wrong = np.flatnonzero(used & ~(values > 0))
        if wrong.size:
            row = table.rows[wrong[0]]
            hint = (
                ": logarithms must be turned into numbers first"
                if wrong.size > used.sum() / 4
                else ""
            )
            raise InputError(
                argument="path",
                accepted=f"a table whose {quantity} is positive",
                hint=f"it is {row.cells[head.place]} in line {row.line} ({wrong.size} "
                f"such rows){hint}",
            )
    if used.sum() < 3:
        raise InputError(
            argument="path",
            accepted="a table of three rows of numbers or more",
            hint=f"it has {int(used.sum())}",
        )
    if not (np.all(q[used] < _LARGEST) and np.all(c[used] < _LARGEST)):
        raise InputError(
            argument="path",
            accepted=f"a table of numbers below {_LARGEST:g} in SI units",
        )
    return used
