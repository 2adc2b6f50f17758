"""The keys of scene files from their schema: for the help of the commands and for the
documentation.
"""

import textwrap
from collections.abc import Iterator
from typing import NamedTuple

from .kinds import KINDS
from .schema import Key, Table, about, keys_of


class Section(NamedTuple):
    """The keys of a scene outside of its tables, or of one of its tables."""

    title: str
    about: str
    keys: tuple[Key, ...]


def sections(kind: type[Table]) -> Iterator[Section]:
    """The sections of a kind of scene: its own keys, then each table."""
    yield section_of("", kind)
    for name, key in keys_of(kind).items():
        written = f"[[{name}]]" if key.listed else f"[{name}]"
        for table in key.tables:
            yield section_of(written, table)


def as_text(verb: str) -> str:
    """The keys of the scenes of a command, for a terminal."""
    lines, seen = [], []
    for kind in KINDS[verb]:
        lines += [f"keys of a scene: {about(kind)}", ""]
        for section in sections(kind):
            if section in seen:
                continue
            seen.append(section)
            lines += [f"  {section.title}  {section.about}"] if section.title else []
            for key in section.keys:
                words = "; ".join(filter(None, cells(key)[:2]))
                lines += textwrap.wrap(
                    f"{key.meaning} ({words})",
                    116,
                    initial_indent=f"    {key.name:<20}",
                    subsequent_indent=24 * " ",
                )
            lines.append("")
    return "\n".join(lines)


def section_of(written: str, table: type[Table]) -> Section:
    config = table.__struct_config__
    tag = f' {config.tag_field} = "{config.tag}"' if config.tag_field else ""
    return Section(f"{written}{tag}", about(table), tuple(keys_of(table).values()))


def cells(key: Key) -> tuple[str, str, str]:
    """What a key accepts, its default and its meaning."""
    words = "tables below" if key.listed else "table below"
    default = "" if key.default is None or key.tables else str(key.default)
    if isinstance(key.default, bool):
        default = default.lower()
    return (
        words if key.tables else key.accepted,
        "required" if key.required else default,
        key.meaning,
    )
