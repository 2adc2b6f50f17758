"""What is typed into a field or an option of the command line as the value of a scene,
and back.
"""

import re
from typing import Any

from .schema import Key

_SPAN = re.compile(
    r"(.+?)\s+to\s+(.+?)(?:\s*[,;]\s*(\d+)(?:\s*points?)?)?", re.IGNORECASE
)
_POINTS = 24  # of a span that does not say how many
# "0,5" is 0.5; "1,250" may be either, and "1,2,3" is a list: both are left to the scene
_COMMA = re.compile(
    r"(?<![\d.,])(?![1-9]\d{0,2},\d{3}(?!\d))(\d+),(?=\d+(?![\d.]|,\d|\s*point))"
)
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
# The number is taken whole (possessive): "0.3" is no 0 with the unit ".3".
_UNIT = re.compile(rf"(?>{_NUMBER.pattern})\s*((?:1/)?[^\d\s].*)")


def to_text(value: Any) -> str:
    """A value of a scene file as it is typed."""
    if value is None:
        return ""
    if isinstance(value, dict):
        first, last = str(value["from"]), str(value["to"])
        same = _UNIT.fullmatch(first), _UNIT.fullmatch(last)
        if same[0] and same[1] and same[0][3] == same[1][3]:
            first = first.removesuffix(same[0][3]).rstrip()
        return f"{first} to {last}, {value['points']} points"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def from_text(key: Key, typed: str, unit: str = "") -> Any:
    """The value of a scene file that a text stands for; None where the key is left out.
    Numbers without a unit have the field's `unit`, where it has one, and may have a
    decimal comma.

    What is no value of the kind is returned as it is, so that the scene's own message
    says what is accepted.
    """
    typed = typed.strip()
    if not typed:
        return None
    if key.numeric or key.quantity or unit:
        typed = _COMMA.sub(r"\1.", typed)
    if key.spread and (match := _SPAN.fullmatch(typed)) is not None:
        first, last = _with_unit([match[1], match[2]], unit)
        return {"from": first, "to": last, "points": int(match[3] or _POINTS)}
    values: list[Any] = [typed]
    if key.several:
        entries = map(str.strip, re.split(r";|,\s+", typed))
        values = [entry for entry in entries if entry]
    if key.numeric:
        values = [_number(entry) for entry in values]
    elif key.quantity or unit:
        values = _with_unit(values, unit)
    return values[0] if len(values) == 1 and not key.listed else values


def _number(typed: str) -> Any:
    if not is_number(typed):
        return typed
    return int(typed) if re.fullmatch(r"[-+]?\d{1,15}", typed) else float(typed)


def _with_unit(parts: list[str], unit: str = "") -> list[str]:
    """Numbers without a unit take that of the last one, "0, 20, 40 degC", or else that
    of the field.
    """
    match = _UNIT.fullmatch(parts[-1].strip())
    unit = unit if match is None else match[3]
    if not unit:
        return parts
    return [f"{entry} {unit}" if is_number(entry.strip()) else entry for entry in parts]


def is_number(typed: str) -> bool:
    """Whether a text is a number without a unit."""
    return _NUMBER.fullmatch(typed) is not None
