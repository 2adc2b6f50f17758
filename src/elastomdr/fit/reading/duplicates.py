"""Columns that hold the same quantity: which is taken, whether the others contradict it, and a word on both."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from .columns import Column, measure

_KELVINS = 3.0  # median difference of two temperatures of one sample above which they contradict each other [K]
_RATIO = 0.05  # the same of moduli and loss tangents, relative
_RATE = 0.02  # of frequencies and times
_OF_SAMPLE = re.compile(r"sample|specimen|proben|prüfling", re.IGNORECASE)
_PROGRAMMED = re.compile(r"set|prog|target|nominal|soll|command|furnace|oven|chamber", re.IGNORECASE)
_NAMED = 6  # columns passed over that are named


def preference(column: Column) -> int:
    """The lower, the sooner a column is taken: temperatures of the sample before others, programmed ones last."""
    if column.role != "temperature":
        return 0
    return 0 if _OF_SAMPLE.search(column.title) else 2 if _PROGRAMMED.search(column.title) else 1


def contradictions(
    arrays: Mapping[str, np.ndarray], chosen: Mapping[str, Column], others: Iterable[tuple[Column, np.ndarray]]
) -> Iterator[str]:
    """A warning on each further column that contradicts the one taken for its role; all values in SI."""
    for column, values in others:
        role, first = column.role, chosen[column.role]
        known = np.isfinite(values) & ((values > 0) | (measure(role) in ("temperature", "angle")))
        if not known.any():
            continue
        one, other = arrays[role][known], values[known]
        if role == "temperature":
            apart = float(np.median(np.abs(other - one)))
            contrary, by = apart > _KELVINS, f"differ by {apart:.3g} K in the median"
        else:
            apart = float(np.expm1(np.median(np.abs(np.log(np.abs(other) / one)))))
            contrary = apart > (_RATE if measure(role) in ("frequency", "time") else _RATIO)
            by = f"differ by a factor of {1 + apart:.3g} in the median"
        if contrary:
            yield (
                f"columns {first.place + 1} {first.title!r} and {column.place + 1} {column.title!r} both hold {role} "
                f"and {by}. Taken is column {first.place + 1}; if it is the other, give columns={{{role!r}: "
                f"{column.place + 1}}} (--column {role}={column.place + 1})."
            )


def taken(titles: Sequence[str], needed: Sequence[Column], temperature: str, part: tuple[int, int]) -> tuple[str, ...]:
    """In words, which columns are read as what and which are passed over; the first of several blocks speaks for all.

    `temperature` says where that comes from which has no column.
    """
    number, count = part
    if number:
        return ()
    words = [f"{column.role} from {column.place + 1} {column.title!r}" for column in needed]
    if all(column.role != "temperature" for column in needed):
        words.append(temperature)
    text = ", ".join(words)
    if count > 1:
        return (f"{text}; and so on, {count} blocks side by side",)
    places = {column.place for column in needed}
    rest = [f"{i + 1} {title.strip()!r}" for i, title in enumerate(titles) if title.strip() and i not in places]
    more = f" and {len(rest) - _NAMED} more" if len(rest) > _NAMED else ""
    return (text + f"; passed over: {', '.join(rest[:_NAMED])}{more}" * bool(rest),)
