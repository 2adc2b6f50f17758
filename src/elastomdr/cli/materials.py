"""`elastomdr materials [NAME]`: the library, or the file of one material."""

import argparse
import shutil
import textwrap
from collections.abc import Iterator

from ..errors import InputError
from ..files import read_text
from ..material.format import read_document
from ..material.library import locate, material_info, materials
from . import DONE
from .schema import path_from


def run(options: argparse.Namespace) -> int:
    """Prints the library's names, or one material; returns the exit status."""
    print("\n".join(_library() if options.name is None else _one(options.name)))
    return DONE


def _library() -> Iterator[str]:
    names = materials()
    width = max(map(len, names), default=0) + 1
    columns = max(60, shutil.get_terminal_size((120, 24)).columns)
    for name in names:
        try:
            info = material_info(name)
            grade = info.get("source", {}).get("moduli", {}).get("grade")
            about = info.get("description", "") + (f" [{grade}]" if grade else "")
        except InputError as error:  # somebody's broken file must not hide the others
            about = f"({error})"
        yield (
            f"{name:<{width}} "
            f"{textwrap.shorten(about, columns - width - 1, placeholder=' ...')}"
        )
    yield (
        "\nelastomdr materials NAME shows the file of one of them: numbers, ranges, "
        "sources."
    )


def _one(name: str) -> Iterator[str]:
    with path_from("NAME"):
        path = locate(name)
        read_document(path)
    yield f"# {path}"
    yield read_text(path).rstrip()
