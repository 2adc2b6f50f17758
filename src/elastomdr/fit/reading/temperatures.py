"""The temperature of a table that stands in a line above it, and what to do where it stands nowhere."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ..data import Dma, describe_list
from ..isotherms import untold
from .columns import convert, known_unit

_UNIT = r"deg ?[CFcf]|°\s?[CF]|º\s?[CF]|℃|℉|K|C|kelvin|celsius"
_PARTS = "step|block|set|sweep|run|curve|interval|segment|abschnitt|messung|experiment|stage"
_OF_BLOCK = re.compile(  # nothing but the temperature, and what may number the block
    rf"[^\w+-]*(?:(?:{_PARTS}|frequency sweep)(?:\s*\d+(?!\d))?[^\w+-]*)?"
    r"(?:(?:t|temp\.?|temperatur|(?:(?:sample|test) )?temp(?:erature)?|isotherme?|온도)\s*(?:at|of|bei)?|at|bei)?"
    rf"\s*[=:,;]?\s*(?<!\d)([+-]?\d+(?:[.,]\d+)?)\s*\[?\(?({_UNIT})\W*",
    re.IGNORECASE,
)
# "Run 3 C": its number, and who knows what else.
_NUMBERED = re.compile(rf"\W*(?:{_PARTS})\s*\d+\s*[CK]\b", re.IGNORECASE)
_LIKE_ONE = re.compile(r"\bt(?:emp\w*)?\s*[=:]|°|º|℃|deg ?[CF]\b|isotherm|\d\s*[KC]\b", re.IGNORECASE)
_SAME = 0.5  # [K], within which two temperatures are one, rounded
_LONGEST = 80  # characters of such a line


class Above(NamedTuple):
    """A temperature in a line above the columns."""

    place: int  # column of its cell
    kelvin: float
    text: str


def above(cells: Sequence[str]) -> tuple[Above, ...]:
    """The temperatures that a row of remarks gives: one in each cell that is one, or that of the whole row."""
    whole = [cell for cell in cells if cell]
    ways = ([",".join(whole)], cells, [" ".join(whole)])  # a decimal comma may have been cut
    return next((found for way in ways if (found := tuple(_each(way)))), ())


def unread(cells: Sequence[str]) -> str:
    """A row of remarks that seems to give a temperature, in a way that `above` does not understand; else nothing."""
    text = " ".join(cell for cell in cells if cell)
    return text[:_LONGEST] if re.search(r"\d", text) and _LIKE_ONE.search(text) else ""


def _each(cells: Sequence[str]) -> Iterator[Above]:
    for place, cell in enumerate(cells):
        plain = re.sub("[\u2212\u2013]", "-", cell.strip())
        match = _OF_BLOCK.fullmatch(plain) if cell and len(cell) < _LONGEST and not _NUMBERED.match(plain) else None
        unit = known_unit(match[2].replace(" ", "")) if match else ""
        if match and unit:
            value = float(match[1].replace(",", "."))
            kelvin = convert([value], "temperature", unit)[0]
            if kelvin > 0:
                yield Above(place, kelvin, cell.strip())


def check_agree(lines: Sequence[Sequence[Above]]) -> None:
    """Raises `InputError` where lines above the same columns, each with one temperature, say different ones."""
    found = [line[0] for line in lines]
    other = next((one for one in found[:-1] if abs(one.kelvin - found[-1].kelvin) > _SAME), None)
    if other is not None:
        raise InputError(
            f"{other.text!r} and {found[-1].text!r} stand above the same columns: leave the one that is theirs, or "
            "give temperature=293.15 (--temperature 20degC)."
        )


def overruled(told: float | None, user: float | None) -> Iterator[str]:
    """A warning where a user's temperature [K] is another than that of the line above the columns."""
    if told is not None and user is not None and abs(told - user) > _SAME:
        said, given = (f"{kelvin - 273.15:.4g} degC" for kelvin in (told, user))
        yield f"a line above the columns says {said}; assumed is what you give, {given}."


def check_told(told: Sequence[float | None], user: float | None) -> None:
    """Raises `InputError` where a user gives one temperature [K] to blocks that have several in lines above them."""
    several = sorted({round(kelvin - 273.15, 2) for kelvin in told if kelvin is not None})
    if user is not None and len(several) > 1:
        raise InputError(
            f"temperature must be left out, got {user:g} K: lines above the columns say "
            f"{describe_list(several, 'degC')}."
        )


def advised(dma: Dma) -> Dma:
    """The same data, with a warning where a temperature is not known."""
    known = np.isfinite(np.concatenate([dma.temperature, dma.time_temperature]))
    if known.all():
        return dma
    rates = np.concatenate([dma.frequency, 1 / dma.time])[~known]
    text = f"{dma.source}: there is no temperature column, which shifting needs: {untold(rates)}"
    return replace(dma, warnings=(*dma.warnings, text))
