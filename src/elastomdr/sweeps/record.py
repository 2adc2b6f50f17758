"""The record of a store: which of its files were written, and a checksum of each.

One line of JSON for each array that was made and for each chunk that was kept, written
after their files. So a chunk that has a line was written whole, and whatever differs
from its line was changed afterwards.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..errors import InputError

_FILE = ".record"  # in the folder of an array, where zarr looks for nothing but chunks
_MADE = (".zarray", ".zattrs")  # what zarr says of an array


class Record:
    """Arrays and chunks of a store, the last line of each."""

    def __init__(self, store: Path, array: str):
        self._store, self._file = store, store / array / _FILE
        self.arrays: dict[str, dict[str, Any]] = {}  # checksums by file, of each array
        # state, message, models and checksums, of each chunk
        self.chunks: dict[int, dict[str, Any]] = {}
        for line in self._lines():
            try:
                self._take(json.loads(line))
            except (ValueError, KeyError, TypeError) as error:
                raise damaged(store, self._file) from error

    def _lines(self) -> list[str]:
        """The lines that are whole; the beginning of one, which a killed process
        leaves, is cut off.
        """
        if not self._file.is_file():
            return []
        data = self._file.read_bytes()
        whole = data[: data.rfind(b"\n") + 1]
        if whole != data:
            with self._file.open("r+b") as file:
                file.truncate(len(whole))
        return whole.decode("utf-8", errors="replace").splitlines()

    def _take(self, line: dict[str, Any]) -> None:
        if "array" in line:
            self.arrays[line["array"]] = dict(line["files"])
        else:
            self.chunks[int(line["chunk"])] = {
                "state": int(line["state"]),
                "message": str(line["message"]),
                "models": list(line["models"]),
                "files": dict(line["files"]),
            }

    def _add(self, line: dict[str, Any]) -> None:
        with self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        self._take(line)

    def add_array(self, name: str) -> None:
        """Says that an array was made."""
        self._add(
            {"array": name, "files": self._sums(f"{name}/{file}" for file in _MADE)}
        )

    def add_chunk(
        self, number: int, state: int, message: str, models: list[str], files: list[str]
    ) -> None:
        """Says that a chunk was kept, in these files."""
        line = {"chunk": number, "state": state, "message": message, "models": models}
        self._add({**line, "files": self._sums(files)})

    def array_is_there(self, name: str) -> bool:
        """Whether an array was made and is there. Raises `InputError` where what zarr
        says of it was changed.
        """
        files = self.arrays.get(name, {})
        if not files or not all((self._store / file).is_file() for file in files):
            return False
        if changed := self._changed(files):
            raise damaged(self._store, self._store / changed)
        return True

    def changed(self, number: int, arrays: Iterable[str]) -> str:
        """The first file of a chunk that is not as it was written, or whose array is
        none of those that are there.
        """
        files = self.chunks[number]["files"]
        lost = (name for name in files if name.partition("/")[0] not in arrays)
        return next(lost, "") or self._changed(files)

    def clear(self) -> None:
        """Forgets everything."""
        self._file.unlink(missing_ok=True)
        self.arrays, self.chunks = {}, {}

    def _changed(self, files: dict[str, Any]) -> str:
        return next(
            (name for name, kept in files.items() if _sum(self._store / name) != kept),
            "",
        )

    def _sums(self, files: Iterable[str]) -> dict[str, list[int] | None]:
        return {name: _sum(self._store / name) for name in files}


def _sum(path: Path) -> list[int] | None:
    """Size and CRC-32 of a file; None where there is none, as zarr writes none for a
    chunk that is NaN all over.
    """
    try:
        data = path.read_bytes()
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
        return None
    return [len(data), zlib.crc32(data)]


def damaged(store: Path, file: Path) -> InputError:
    """What is raised for a file from which nothing can be made anew unless it is
    removed.
    """
    whole = file.parent == store
    remove = "this store" if whole else f"its folder {file.parent.name!r}"
    return InputError(
        f"store {str(store)!r} is damaged: {str(file.relative_to(store))!r} is not as "
        f"em.sweep wrote it. Remove {remove}, and the same call computes it again."
    )
