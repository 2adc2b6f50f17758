"""The keys of scene files from their schema: for the help of the commands and for the
documentation.
"""

import inspect
import textwrap
from collections.abc import Iterator
from typing import Any, NamedTuple

import msgspec

from .kinds import KINDS
from .schema import accepted, is_list, keys_of, tables_of
from .sweep import SweepTable


class Key(NamedTuple):
    """One key of a table."""

    name: str
    accepted: str
    default: str
    meaning: str


class Section(NamedTuple):
    """The keys of a scene outside of its tables, or of one of its tables."""

    title: str
    about: str
    keys: tuple[Key, ...]


def sections(kind: Any) -> Iterator[Section]:
    """The sections of a kind of scene: its own keys, then each table."""
    yield _section("", kind)
    for name, field in keys_of(kind).items():
        written = f"[[{name}]]" if is_list(field.type) else f"[{name}]"
        for table in tables_of(field.type):
            yield _section(written, table)


def as_text(verb: str) -> str:
    """The keys of the scenes of a command, for a terminal."""
    lines, seen = [], set()
    for kind in KINDS[verb]:
        lines += [f"keys of a scene: {_about(kind)}", ""]
        for section in sections(kind):
            if section in seen:
                continue
            seen.add(section)
            lines += [f"  {section.title}  {section.about}"] if section.title else []
            for key in section.keys:
                words = (
                    f"{key.meaning} "
                    f"({'; '.join(piece for piece in (key.accepted, key.default) if piece)})"
                )
                lines += textwrap.wrap(
                    words,
                    116,
                    initial_indent=f"    {key.name:<20}",
                    subsequent_indent=24 * " ",
                )
            lines.append("")
    return "\n".join(lines)


def as_markdown() -> str:
    """The keys of all scenes, a table for each section; one that several kinds share
    stands at its first place.
    """
    lines, seen = [], set()
    for verb, kinds in KINDS.items():
        lines += [f"## elastomdr {verb}", ""]
        for kind in kinds:
            lines += [f"### {_about(kind).rstrip('.')}", ""]
            for section in sections(kind):
                if section in seen:
                    continue
                seen.add(section)
                lines += (
                    [f"`{section.title}` {section.about}", ""] if section.title else []
                )
                lines += (
                    ["| key | accepted | default | meaning |", "|---|---|---|---|"]
                    if section.keys
                    else []
                )
                lines += [
                    f"| `{key.name}` | {' | '.join(_cell(entry) for entry in key[1:])} |"
                    for key in section.keys
                ]
                lines.append("")
    lines += [
        "## elastomdr sweep",
        "",
        "Beside the keys of friction, rolling or impact:",
        "",
    ]
    section = _section("[sweep]", SweepTable)
    lines += [
        f"`{section.title}` {section.about}",
        "",
        "| key | accepted | default | meaning |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| `{key.name}` | {' | '.join(_cell(entry) for entry in key[1:])} |"
        for key in section.keys
    ]
    return "\n".join([*lines, ""])


def _section(written: str, table: Any) -> Section:
    config = table.__struct_config__
    title = (
        f'{written} {config.tag_field} = "{config.tag}"'
        if config.tag_field
        else written
    )
    keys = []
    for name, field in keys_of(table).items():
        default = (
            "required"
            if field.required
            else ""
            if field.default is None
            else _shown(field.default)
        )
        inner = tables_of(field.type)
        words = (
            f"{'tables' if is_list(field.type) else 'table'} below"
            if inner
            else accepted(field.type)
        )
        keys.append(Key(name, words, default, _meaning(field.type)))
    return Section(title, _about(table), tuple(keys))


def _about(table: Any) -> str:
    """The first sentence of its docstring."""
    return inspect.cleandoc(table.__doc__).split("\n\n")[0].replace("\n", " ")


def _meaning(kind: Any) -> str:
    return next(
        (note for note in getattr(kind, "__metadata__", ()) if isinstance(note, str)),
        "",
    )


def _shown(value: Any) -> str:
    if isinstance(value, msgspec.Struct):
        return ""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _cell(entry: str) -> str:
    return entry.replace("|", "\\|")
