"""Tables of scene files as types: what makes them from TOML, and errors that name the
key, the value and what is accepted.
"""

import abc
import contextlib
import re
import types
from collections.abc import Iterator
from typing import (
    Annotated,
    Any,
    ClassVar,
    Generic,
    Literal,
    TypeVar,
    Union,
    dataclass_transform,
    get_args,
    get_origin,
)

import msgspec

from ..errors import InputError, closest
from .units import SceneQuantity, shown

T = TypeVar("T")
_PATH = re.compile(r"(.*?)(?: - at `\$(.*)`)?", re.DOTALL)

Text = Annotated[str, msgspec.Meta(pattern=r"^[^\x00]*[^\s\x00][^\x00]*$")]
Positive = Annotated[float, msgspec.Meta(gt=0)]
Count = Annotated[int, msgspec.Meta(ge=1, le=1_000_000)]
Draws = Annotated[int, msgspec.Meta(ge=2, le=10_000)]
Many = Annotated[int, msgspec.Meta(ge=2, le=100_000)]  # values of a sweep
Instants = Annotated[int, msgspec.Meta(ge=2, le=10_000)]  # of a history


@dataclass_transform(kw_only_default=True, frozen_default=True)
class _TableType(msgspec.StructMeta, abc.ABCMeta):
    """Frozen structs with keyword fields that refuse unknown keys."""

    def __new__(
        mcls,
        name: str,
        bases: tuple[type, ...],
        namespace: dict[str, Any],
        **options: Any,
    ) -> Any:
        defaults: dict[str, Any] = {
            "kw_only": True,
            "frozen": True,
            "forbid_unknown_fields": True,
        }
        return super().__new__(mcls, name, bases, namespace, **(defaults | options))


class Table(msgspec.Struct, metaclass=_TableType):
    """A table of a scene file: its fields are the keys, each annotated with its
    meaning.
    """

    # keys looked for here that belong elsewhere, and what to do about them
    of_others: ClassVar[dict[str, str]] = {}


class Several(tuple, Generic[T]):
    """One value, or a list of values."""


class One(Several[T]):
    """One value, where other scenes have several."""


class Sweep(Several[T]):
    """One value, a list of values, or { from, to, points } on a logarithmic scale."""


class Span(Table, Generic[T], rename={"first": "from", "last": "to"}):
    """The first and the last of several values, and how many there are."""

    first: T
    last: T
    points: Many


def decode(kind: Any, content: Any) -> Any:
    """A value of the type `kind` from what TOML holds. Raises `InputError` that begins
    with the key.
    """
    try:
        return msgspec.convert(content, kind, dec_hook=_custom)
    except msgspec.ValidationError as error:
        raise InputError(_explained(kind, content, error)) from error


@contextlib.contextmanager
def named(name: str) -> Iterator[None]:
    """Puts a file, a table or a key before the message of an `InputError`, unless it
    begins with it.
    """
    try:
        yield
    except InputError as error:
        message = str(error)
        raise InputError(
            message if message.startswith(name) else f"{name} {message}"
        ) from error


@contextlib.contextmanager
def path_from(key: str) -> Iterator[None]:
    """Puts the key that holds a path in the place of the word "path" at the beginning
    of an `InputError`.
    """
    try:
        yield
    except InputError as error:
        message = str(error)
        raise InputError(
            f"{key}{message[4:]}" if message.startswith("path") else f"{key}: {message}"
        ) from error


def only_one(table: Any, *keys: str) -> str:
    """The one of the keys that the table has. Raises `InputError` for none and for
    more.
    """
    present = list(given(table, *keys))
    if len(present) != 1:
        raise InputError(
            f"must have one of {', '.join(keys)}, got "
            f"{' and '.join(present) or 'none of them'}."
        )
    return present[0]


def given(table: Any, *keys: str) -> dict[str, Any]:
    """Those of the keys that the table has, with their values."""
    return {key: value for key in keys if (value := getattr(table, key)) is not None}


def accepted(kind: Any) -> str:
    """What values a type accepts, in words."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        limits = {
            k: v
            for m in inner[1:]
            for k in ("gt", "ge", "le")
            if (v := getattr(m, k, None)) is not None
        }
        if limits.keys() == {"ge", "le"}:
            return f"{accepted(inner[0])} from {limits['ge']} to {limits['le']}"
        return "a positive number" if limits else accepted(inner[0])
    if origin is Literal:
        return f"one of {', '.join(map(str, inner))}"
    if origin in (Union, types.UnionType):
        tables = [member for member in inner if _is_table(member)]
        if len(tables) > 1:
            return f"a table with the key {tables[0].__struct_config__.tag_field}"
        return " or ".join(
            accepted(member) for member in inner if member is not type(None)
        )
    if origin is One:
        return accepted(inner[0])
    if origin is dict:
        return "a table of lists"
    if origin in (list, Several, Sweep):
        one = accepted(inner[0])
        if origin is list and _is_table(inner[0]):
            return "a list of tables, each with two brackets around its name"
        if origin is list:
            return {float: "a list of numbers", int: "a list of whole numbers"}.get(
                inner[0], f"a list, each {one}"
            )
        return (
            f"{one}, a list of them, or {{ from, to, points }}"
            if origin is Sweep
            else f"{one}, or a list of them"
        )
    if _is_table(kind):
        return f"a table with the keys {', '.join(keys_of(kind))}"
    if isinstance(kind, type) and issubclass(kind, SceneQuantity):
        return f'{kind.what} with its unit, such as "{kind.example}"'
    if kind in (None, type(None)):
        return "left out"
    return {
        bool: "true or false",
        int: "a whole number",
        float: "a number",
        str: "a text",
    }[kind]


def keys_of(kind: Any) -> dict[str, Any]:
    """The fields of a table by their keys in the file."""
    return {field.encode_name: field for field in msgspec.structs.fields(kind)}


def tables_of(kind: Any) -> tuple[Any, ...]:
    """The tables that a type accepts: itself, or the members of a union, of a list."""
    if _is_table(kind):
        return (kind,)
    inner = get_args(kind)
    return (
        tuple(table for member in inner for table in tables_of(member))
        if get_origin(kind) is not Literal
        else ()
    )


def is_list(kind: Any) -> bool:
    """Whether a type is a list of TOML's."""
    return (
        get_origin(get_args(kind)[0] if get_origin(kind) is Annotated else kind) is list
    )


def _options(kind: Any) -> tuple[Any, ...]:
    """The words that a type accepts, where they are listed."""
    if get_origin(kind) is Literal:
        return get_args(kind)
    return tuple(word for member in get_args(kind) for word in _options(member))


def _is_table(kind: Any) -> bool:
    kind = get_origin(kind) or kind
    return isinstance(kind, type) and issubclass(kind, msgspec.Struct)


def _custom(kind: Any, value: Any) -> Any:
    """Reads what is no type of TOML."""
    origin = get_origin(kind)
    if origin is None:
        return kind.read(value)
    (inner,) = get_args(kind)
    if isinstance(value, dict) and origin is Sweep:
        with named(":"):
            return origin(_spread(decode(Span[inner], value)))
    if not isinstance(value, list) or origin is One:
        return origin([decode(inner, value)])
    if not value:
        raise InputError(f"must be {accepted(kind)}, got an empty list.")
    entries = []
    for i, entry in enumerate(value):
        with named(f"[{i}]"):
            entries.append(decode(inner, entry))
    return origin(entries)


def _spread(span: Span) -> list[float]:
    if not 0 < span.first < span.last:
        raise InputError(
            "must go from a smaller to a larger value above zero, got "
            f"{span.first:g} to {span.last:g}."
        )
    import numpy as np

    return np.geomspace(span.first, span.last, span.points).tolist()


def _explained(kind: Any, content: Any, error: msgspec.ValidationError) -> str:
    """The message of msgspec's error: the key, what is wrong with its value, what is
    accepted.
    """
    message, path = _PATH.fullmatch(str(error)).groups()  # type: ignore[union-attr]
    steps = [
        int(i) if i else key for key, i in re.findall(r"\.(\w+)|\[(\d+)\]", path or "")
    ]
    for step in steps:
        kind, content = _inside(kind, content, step)
    if error.__cause__ is not None:  # our own words
        name = _name(steps, bool(tables_of(kind)))
        joined = message[0] in "[:" and not name.endswith("]")
        return f"{name}{'' if joined else ' '}{message}".strip()
    if (match := re.search(r"unknown field `(.*)`", message, re.DOTALL)) is not None:
        valid = list(
            dict.fromkeys(
                key for table in _chosen(kind, content) for key in _all_keys(table)
            )
        )
        other = next(
            (
                t.of_others[match[1]]
                for t in _chosen(kind, content)
                if match[1] in t.of_others
            ),
            "",
        )
        hint = (
            f" {other}"
            if other
            else closest(match[1], valid) or f" Valid keys are {', '.join(valid)}."
        )
        return (
            f"{_name(steps, table=True)} has a key that is not known: "
            f"{match[1]!r}.{hint}"
        ).strip()
    if (match := re.search(r"missing required field `(.*)`", message)) is not None:
        within, _ = _inside(kind, content, match[1])
        name = _name([*steps, match[1]])
        if tables_of(within):
            name = f"[[{name}]]" if is_list(within) else f"[{name}]"
        return f"{name} is missing: it must be {accepted(within)}."
    hint = closest(content, _options(kind)) if isinstance(content, str) else ""
    return (
        f"{_name(steps, bool(tables_of(kind)))} must be {accepted(kind)}, got "
        f"{shown(content)}.{hint}"
    )


def _chosen(kind: Any, content: Any) -> tuple[Any, ...]:
    """The table of a union whose tag the content has, or all of them."""
    tables = tables_of(kind)
    config = (get_origin(tables[0]) or tables[0]).__struct_config__
    tagged = [
        t
        for t in tables
        if config.tag_field and t.__struct_config__.tag == content.get(config.tag_field)
    ]
    return tuple(tagged) or tables


def _all_keys(table: Any) -> list[str]:
    tag = (get_origin(table) or table).__struct_config__.tag_field
    return [*([tag] if tag else []), *keys_of(table)]


def _inside(kind: Any, content: Any, step: str | int) -> tuple[Any, Any]:
    """Type and value of a key of a table, or of an entry of a list."""
    if isinstance(step, int):
        return next(_entries(kind)), content[step]
    for table in _chosen(kind, content):
        if step in (keys := keys_of(table)):
            return keys[step].type, content.get(step)
    return Literal[
        tuple(table.__struct_config__.tag for table in tables_of(kind))
    ], content.get(step)


def _entries(kind: Any) -> Iterator[Any]:
    """The types of the entries of the lists that a type accepts."""
    if get_origin(kind) is list:
        yield get_args(kind)[0]
    elif get_origin(kind) in (Annotated, Union, types.UnionType):
        for member in get_args(kind):
            yield from _entries(member)


def _name(steps: list[Any], table: bool = False) -> str:
    """The place as messages call it, such as "[contact] load", "[stage 2] way" or
    "[history] time[1]".
    """
    if not steps:
        return ""
    if isinstance(steps[-1], int) and not table:
        return f"{_name(steps[:-1])}[{steps[-1]}]"
    words = [f" {step + 1}" if isinstance(step, int) else str(step) for step in steps]
    if table:
        return f"[{''.join(words)}]"
    return f"[{''.join(words[:-1])}] {words[-1]}" if words[1:] else words[0]
