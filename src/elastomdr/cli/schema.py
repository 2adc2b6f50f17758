"""Tables of scene files as types: what makes them from TOML, and errors that name the
key, the value and what is accepted.
"""

import abc
import contextlib
import inspect
import math
import textwrap
import types
from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import (
    Annotated,
    Any,
    ClassVar,
    Generic,
    Literal,
    TypeAlias,
    TypeVar,
    Union,
    dataclass_transform,
    get_args,
    get_origin,
)

import msgspec

from ..errors import InputError, closest
from .units import VALUE, SceneQuantity

T = TypeVar("T")
# what a TOML file holds, and what a function of elastomdr is called with
Content: TypeAlias = dict[str, Any]
Arguments: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Plain:
    """A value of TOML that is taken as it is, within limits."""

    what: str  # in words
    types: tuple[type, ...]
    fits: Callable[[Any], object] = lambda entry: True

    def accepted(self) -> str:
        """What is accepted, in words."""
        return self.what

    def read(self, entry: object) -> object:
        """The value. Raises `InputError`, which says what is accepted."""
        if type(entry) in self.types and self.fits(entry):
            with contextlib.suppress(OverflowError):
                return self.types[-1](entry)
        raise InputError(argument=VALUE, got=entry, accepted=self.what)


def whole(least: int, most: int) -> Plain:
    """A whole number within limits."""
    words = f"a whole number from {least} to {most}"
    return Plain(words, (int,), lambda entry: least <= entry <= most)


Text = Annotated[
    str, Plain("a text", (str,), lambda entry: entry.strip() and "\0" not in entry)
]
Positive = Annotated[
    float, Plain("a positive number", (int, float), lambda entry: entry > 0)
]
Count = Annotated[int, whole(1, 1_000_000)]
Draws = Annotated[int, whole(2, 10_000)]
Many = Annotated[int, whole(2, 100_000)]  # values of a sweep
Instants = Annotated[int, whole(2, 10_000)]  # of a history
_PLAIN: dict[Any, Plain] = {
    bool: Plain("true or false", (bool,)),
    int: Plain("a whole number", (int,)),
    float: Plain("a number", (int, float)),
    str: Plain("a text", (str,)),
}


@dataclass_transform(kw_only_default=True, frozen_default=True)
class _TableType(msgspec.StructMeta, abc.ABCMeta):
    """Frozen structs with keyword fields."""

    def __new__(
        mcls,
        name: str,
        bases: tuple[type, ...],
        namespace: dict[str, object],
        tag: str | None = None,
        tag_field: str | None = None,
        rename: Mapping[str, str] | None = None,
    ) -> Any:
        return super().__new__(
            mcls,
            name,
            bases,
            namespace,
            kw_only=True,
            frozen=True,
            tag=tag,
            tag_field=tag_field,
            rename=rename,
        )


class Table(msgspec.Struct, metaclass=_TableType):
    """A table of a scene file: its fields are the keys, whose meaning stands in the
    docstring under "Keys".
    """

    # keys looked for here that belong elsewhere, and what to do about them
    of_others: ClassVar[dict[str, str]] = dict.fromkeys(
        ("title", "material", "temperature", "measured"),
        "It stands at the top of the file, above the first table.",
    )
    aside: ClassVar[bool] = False  # whether its keys are no arguments of the call

    def arguments(self, folder: Path) -> "Arguments":
        """What the call takes of it; files are looked for in `folder`."""
        return given(self)


class Several(tuple[T, ...], Generic[T]):
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


@dataclass(frozen=True)
class Key:
    """A key of a table: what it accepts, by its types without None, and what it is for."""

    name: str
    kinds: tuple[Any, ...]
    optional: bool
    default: Any  # `msgspec.NODEFAULT` where it must be given
    meaning: str

    @property
    def required(self) -> bool:
        """Whether it must be given."""
        return self.default is msgspec.NODEFAULT

    @property
    def tables(self) -> tuple[type[Table], ...]:
        """The tables of which it is one, or a list."""
        return tuple(each for each in self.entries if _is_table(each))

    @property
    def listed(self) -> bool:
        """Whether it is a list of TOML's."""
        return all(get_origin(kind) is list for kind in self.kinds)

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
    def entries(self) -> tuple[Any, ...]:
        """The types of a single value."""
        return tuple(
            inner
            for kind in self.kinds
            for inner in (members(get_args(kind)[0]) if get_args(kind) else [kind])
        )

    @property
    def quantity(self) -> type[SceneQuantity] | None:
        """What it measures, None for a number or a text."""
        return next((k for k in self.entries if _is_a(k, SceneQuantity)), None)

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
        """Whether it accepts bare numbers and measures nothing."""
        plain = (_PLAIN.get(kind, kind) for kind in self.entries)
        numbers = (isinstance(p, Plain) and p.types[0] is int for p in plain)
        return any(numbers) and self.quantity is None

    @property
    def accepted(self) -> str:
        """What it accepts, in words."""
        return accepted(self.kinds)


@cache
def keys_of(table: type[Table]) -> dict[str, Key]:
    """The keys of a table by their names in the file."""
    meant = _meanings(table)
    return {
        field.encode_name: Key(
            field.encode_name,
            members(field.type),
            type(None) in get_args(field.type),
            field.default if field.default_factory is msgspec.NODEFAULT else None,
            meant.get(field.name, ""),
        )
        for field in msgspec.structs.fields(table)
    }


def _meanings(table: type) -> dict[str, str]:
    """The meanings of keys, as the docstrings of a table and of its bases tell them."""
    found: dict[str, str] = {}
    for base in reversed((get_origin(table) or table).__mro__):
        listed = inspect.cleandoc(base.__doc__ or "").partition("\nKeys:\n")[2]
        key = ""
        for line in textwrap.dedent(listed).splitlines():
            if line.startswith(" "):
                found[key] += f" {line.strip()}"
            else:
                key, _, found[key] = line.partition(": ")
    return found


def about(table: type) -> str:
    """What a table is, by the first sentence of its docstring."""
    return inspect.cleandoc(table.__doc__ or "").partition("\n\n")[0].replace("\n", " ")


def decode(kind: Any, entry: object, place: tuple[str | int, ...] = ()) -> Any:
    """A value of the type `kind` from what TOML holds at a place. Raises `InputError`,
    which names the key.
    """
    kinds = members(kind)
    tables = tuple(each for each in kinds if _is_table(each))
    if tables and (isinstance(entry, dict) or len(tables) == len(kinds)):
        return _decoded_table(tables, entry, place)
    kinds = tuple(each for each in kinds if each not in tables)
    if len(kinds) != 1:
        for each in kinds:
            with contextlib.suppress(InputError):
                return decode(each, entry, place)
        raise _refused(kinds, entry, place)
    (only,) = kinds
    origin, inner = get_origin(only), get_args(only)
    if origin is Literal and isinstance(entry, str) and entry in inner:
        return entry
    if origin in (Several, One, Sweep):
        return origin(_several(only, entry, place))
    if origin is list and isinstance(entry, list):
        return [decode(inner[0], one, (*place, i)) for i, one in enumerate(entry)]
    if origin is dict and isinstance(entry, dict):
        return {key: decode(inner[1], one, (*place, key)) for key, one in entry.items()}
    if only is Any:
        return entry
    if origin is None:
        reader: Any = _PLAIN.get(only, only)
        with of_key(_name(place)):
            return reader.read(entry)
    raise _refused(kinds, entry, place)


def _several(kind: Any, entry: object, place: tuple[str | int, ...]) -> list[Any]:
    """The values of a key that has one or more of them."""
    origin, (inner,) = get_origin(kind), get_args(kind)
    if isinstance(entry, dict) and origin is Sweep:
        with of_key(_name(place)):
            span = decode(Span[inner], entry)
            if 0 < span.first < span.last:
                import numpy as np

                return np.geomspace(span.first, span.last, span.points).tolist()
            raise InputError(
                argument="from",
                got=entry["from"],
                accepted=f"above zero and below to, {entry['to']}",
            )
    if not isinstance(entry, list) or origin is One:
        return [decode(inner, entry, place)]
    if not entry:
        raise InputError(argument=_name(place), got=entry, accepted=accepted((kind,)))
    return [decode(inner, one, (*place, i)) for i, one in enumerate(entry)]


def _decoded_table(
    tables: tuple[Any, ...], entry: object, place: tuple[str | int, ...]
) -> Any:
    """A table, of several kinds that which its tag names."""
    if not isinstance(entry, dict):
        raise _refused(tables, entry, place)
    given, table = dict(entry), tables[0]
    tag = _struct(table).__struct_config__.tag_field
    if tag is not None:
        by_tag = {_struct(one).__struct_config__.tag: one for one in tables}
        named_kind = Literal[tuple(by_tag)]
        if tag not in given:
            raise _missing(Key(tag, (named_kind,), False, None, ""), place)
        table = by_tag[decode(named_kind, given.pop(tag), (*place, tag))]
    keys = keys_of(table)
    for key in [key for key in given if key not in keys]:
        name, valid = _name(place, table=True), [*([tag] if tag else []), *keys]
        homes = [
            f"[{home}]"
            for home, other in keys.items()
            if any(key in keys_of(one) for one in other.tables)
        ]
        hint = (
            (f"It stands in {' or '.join(homes)}." if homes else "")
            or _struct(table).of_others.get(key, "")
            or (closest(str(key), valid) or f"Valid keys are {', '.join(valid)}.")
        )
        raise InputError(
            argument=f"{name} {key}".strip(),
            got=key,
            accepted="a key that is known",
            hint=hint,
        )
    types_of = {each.encode_name: each for each in msgspec.structs.fields(table)}
    values = {
        types_of[key].name: decode(types_of[key].type, value, (*place, key))
        for key, value in given.items()
    }
    for key in keys.values():
        if key.required and key.name not in given:
            raise _missing(key, place)
    with named(_name(place, table=True)):
        return _struct(table)(**values)


def _missing(key: Key, place: tuple[str | int, ...]) -> InputError:
    written = _name((*place, key.name), bool(key.tables))
    if key.tables and key.listed:
        written = f"[{written}]"
    return InputError(argument=written, accepted=key.accepted, hint="it is missing")


def _refused(
    kinds: tuple[Any, ...], entry: object, place: tuple[str | int, ...]
) -> InputError:
    key = Key("", kinds, False, None, "")
    return InputError(
        argument=_name(place, bool(key.tables)),
        got=entry,
        accepted=key.accepted,
        hint=closest(entry, key.words) if isinstance(entry, str) else "",
    )


@contextlib.contextmanager
def as_typed(table: Table) -> Iterator[None]:
    """Gives an `InputError` the value of a key as it was typed."""
    try:
        yield
    except InputError as error:
        key = keys_of(type(table)).get(error.argument)
        if key is not None and key.quantity is not None:
            held = getattr(table, error.argument, None)
            error.got = _typed(key.quantity, held, error.got)
        raise


def _typed(kind: type[SceneQuantity], held: object, got: object) -> object:
    """What was typed for a value of a key, or the value with its unit where it is one
    of a span.
    """
    if getattr(got, "ndim", None) == 0:
        got = float(got)  # pyright: ignore[reportArgumentType]
    if isinstance(got, list | tuple):
        texts = [_typed(kind, held, each) for each in got]
        return texts[0] if len(texts) == 1 else texts
    if not isinstance(got, float | int) or isinstance(got, bool):
        return got
    for each in held if isinstance(held, tuple) else (held,):
        if isinstance(each, SceneQuantity) and math.isclose(each, got, rel_tol=1e-9):
            return each.typed or kind.in_unit(got)
    return kind.in_unit(got)


@contextlib.contextmanager
def named(table: str) -> Iterator[None]:
    """Puts the table before the argument of an `InputError`, unless it has one; its
    quantities are as they were typed.
    """
    try:
        yield
    except InputError as error:
        got = error.got
        each = got[0] if isinstance(got, list | tuple) and got else got
        if isinstance(each, SceneQuantity):
            error.got = _typed(type(each), got, got)
        if table and not error.argument.startswith("["):
            error.called(f"{table} {error.argument}")
        raise


@contextlib.contextmanager
def of_file(path: Path) -> Iterator[None]:
    """Puts the file of a scene before the sentence of an `InputError`."""
    try:
        yield
    except InputError as error:
        error.inside(path.name or str(path))
        raise


@contextlib.contextmanager
def of_key(key: str, *names: str) -> Iterator[None]:
    """Calls a value, or an argument of these names, of an `InputError` by its key; puts
    the key before other arguments.
    """
    try:
        yield
    except InputError as error:
        if error.argument in (VALUE, *names):
            error.called(key)
        else:
            error.inside("", key)
        raise


_PATHS = ("path", "path_or_paths", "path_or_heights", "name_or_path")


@contextlib.contextmanager
def path_from(
    key: str, folder: Path = Path(), options: Container[str] = ()
) -> Iterator[None]:
    """Calls the path of an `InputError` by the key that holds it, which names it as
    seen from `folder`; `options` are keys themselves.
    """
    try:
        yield
    except InputError as error:
        if error.argument in _PATHS:
            error.called(key)
            with contextlib.suppress(TypeError, ValueError):
                error.got = str(Path(error.got).relative_to(folder))  # type: ignore[arg-type]
        elif error.argument not in options:
            error.inside("", key)
        raise


def only_one(table: Table, *keys: str) -> str:
    """The one of the keys that the table has. Raises `InputError` for none and for
    more.
    """
    present = list(given(table, *keys))
    if len(present) != 1:
        raise InputError(
            argument=present[-1] if present else keys[0],
            got=getattr(table, present[-1]) if present else None,
            accepted=f"left out where {present[0]} is given"
            if present
            else f"given, or {' or '.join(keys[1:])}",
        )
    return present[0]


def given(table: Table, *keys: str) -> Arguments:
    """Those of the keys that the table has, with their values; of all keys where none
    are named.
    """
    return {
        key: value
        for key in keys or table.__struct_fields__
        if (value := getattr(table, key)) is not None
    }


def accepted(kinds: tuple[Any, ...]) -> str:
    """What values some types accept, in words."""
    tables = [kind for kind in kinds if _is_table(kind)]
    if len(tables) > 1:
        return f"a table with the key {_struct(tables[0]).__struct_config__.tag_field}"
    return " or ".join(map(_accepted, kinds)) or "left out"


def _accepted(kind: Any) -> str:
    origin, inner = get_origin(kind), get_args(kind)
    if origin is None or _is_table(kind):
        if _is_table(kind):
            return f"a table with the keys {', '.join(keys_of(kind))}"
        reader: Any = _PLAIN.get(kind, kind)
        return "a value" if kind is Any else reader.accepted()
    if origin is Literal:
        words = ", ".join(map(str, inner))
        return f"one of {words}" if len(inner) > 1 else words
    if origin is dict:
        return "a table of lists"
    one = accepted(members(inner[0]))
    if origin is list:
        if _is_table(inner[0]):
            return "a list of tables, each with two brackets around its name"
        plural: dict[Any, str] = {
            float: "a list of numbers",
            int: "a list of whole numbers",
        }
        return plural.get(inner[0], f"a list, each {one}")
    if origin is One:
        return one
    more = "a list of them, or { from, to, points }"
    return f"{one}, {more if origin is Sweep else 'or a list of them'}"


def members(kind: Any) -> tuple[Any, ...]:
    """The members of a union, without None."""
    if get_origin(kind) in (Union, types.UnionType):
        return tuple(inner for each in get_args(kind) for inner in members(each))
    if get_origin(kind) is Annotated:
        return (get_args(kind)[1],)
    return () if kind in (None, type(None)) else (kind,)


def _struct(kind: Any) -> Any:
    return get_origin(kind) or kind


def _is_table(kind: Any) -> bool:
    return _is_a(_struct(kind), Table)


def _is_a(kind: Any, base: type) -> bool:
    return isinstance(kind, type) and issubclass(kind, base)


def _name(steps: tuple[str | int, ...], table: bool = False) -> str:
    """The place as messages call it, such as "[contact] load", "[stage 2] way",
    "[heat.road] conductivity" or "[history] time[1]".
    """
    if not steps:
        return ""
    if isinstance(steps[-1], int) and not table:
        return f"{_name(steps[:-1])}[{steps[-1]}]"
    if not table and len(steps) == 1:
        return str(steps[0])
    first, *others = steps if table else steps[:-1]
    words = (f" {step + 1}" if isinstance(step, int) else f".{step}" for step in others)
    name = f"[{first}{''.join(words)}]"
    return name if table else f"{name} {steps[-1]}"
