"""What a person types into a field, as the value that a scene file holds, and back."""

import re
import types
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from ..cli.schema import Several, Sweep, accepted
from ..cli.units import Quantity

_SPAN = re.compile(r"(.+?)\s+to\s+(.+?)\s*[,;]\s*(\d+)(?:\s*points?)?", re.IGNORECASE)
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
# The number is taken whole (possessive): "0.3" is no 0 with the unit ".3".
_UNIT = re.compile(rf"(?>{_NUMBER.pattern})\s*((?:1/)?[^\d\s].*)")


class Leaf(NamedTuple):
    """What a key that is no table accepts."""

    kinds: tuple[Any, ...]  # the types, without None
    optional: bool

    @property
    def words(self) -> tuple[str, ...]:
        """The words that it accepts, where they are listed."""
        return tuple(
            word
            for kind in self.kinds
            if get_origin(kind) is Literal
            for word in get_args(kind)
        )

    @property
    def flag(self) -> bool:
        """Whether it is true or false."""
        return self.kinds == (bool,)

    @property
    def several(self) -> bool:
        """Whether it accepts a list."""
        return any(get_origin(kind) in (list, Several, Sweep) for kind in self.kinds)

    @property
    def spread(self) -> bool:
        """Whether it accepts values from one to another."""
        return any(get_origin(kind) is Sweep for kind in self.kinds)

    @property
    def numeric(self) -> bool:
        """Whether it accepts bare numbers."""
        return any(kind in (int, float) for kind in self._innermost())

    @property
    def quantity(self) -> type[Quantity] | None:
        """What it measures, None for a number or a text."""
        return next(
            (
                k
                for k in self._innermost()
                if isinstance(k, type) and issubclass(k, Quantity)
            ),
            None,
        )

    @property
    def accepted(self) -> str:
        """What it accepts, in words."""
        return " or ".join(accepted(kind) for kind in self.kinds)

    def _innermost(self) -> tuple[Any, ...]:
        return tuple(
            inner
            for kind in self.kinds
            for inner in (_parts(get_args(kind)[0]) if get_args(kind) else [kind])
        )


def leaf(kind: Any) -> Leaf:
    """What the type of a key accepts."""
    parts = _parts(kind)
    return Leaf(
        tuple(part for part in parts if part is not type(None)),
        type(None) in parts or None in parts,
    )


def to_text(value: Any) -> str:
    """A value of a scene file as it is typed."""
    if value is None:
        return ""
    if isinstance(value, dict):
        return f"{value['from']} to {value['to']}, {value['points']} points"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def from_text(accepts: Leaf, text: str | None) -> Any:
    """The value of a scene file that a text stands for; None where the key is left out.

    What is no value of the kind is returned as it is, so that the scene's own message
    says what is accepted.
    """
    text = (text or "").strip()
    if not text:
        return None
    if accepts.spread and (match := _SPAN.fullmatch(text)) is not None:
        first, last = _with_unit([match[1], match[2]])
        return {"from": first, "to": last, "points": int(match[3])}
    parts = (
        [part.strip() for part in re.split(r";|,\s+", text) if part.strip()]
        if accepts.several
        else [text]
    )
    numeric = accepts.numeric and accepts.quantity is None
    values = (
        [_number(part) for part in parts]
        if numeric
        else _with_unit(parts)
        if accepts.quantity
        else parts
    )
    one = len(values) == 1 and not all(
        get_origin(kind) is list for kind in accepts.kinds
    )
    return values[0] if one else values


def _parts(kind: Any) -> tuple[Any, ...]:
    """The members of a union, each without its notes."""
    if get_origin(kind) is Annotated:
        return _parts(get_args(kind)[0])
    if get_origin(kind) in (Union, types.UnionType):
        return tuple(part for member in get_args(kind) for part in _parts(member))
    return (kind,)


def _number(text: str) -> Any:
    if _NUMBER.fullmatch(text) is None:
        return text
    return int(text) if re.fullmatch(r"[-+]?\d{1,15}", text) else float(text)


def _with_unit(parts: list[str]) -> list[str]:
    """Numbers without a unit take that of the last one: "0, 20, 40 degC"."""
    match = _UNIT.fullmatch(parts[-1].strip())
    if match is None:
        return parts
    return [
        f"{part} {match[3]}" if _NUMBER.fullmatch(part.strip()) else part
        for part in parts
    ]
