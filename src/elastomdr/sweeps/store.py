"""The store of a sweep: a zarr group with one array per quantity, and which of its
points are done.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import __version__
from ..errors import InputError
from .grid import Grid, difference

if TYPE_CHECKING:
    import xarray

OPEN, DONE, RAISED = 0, 1, 2  # the state of a chunk
_RECORD = (
    ".record"  # in the folder of an array, where zarr looks for nothing but chunks
)
_METADATA = (".zarray", ".zattrs")  # what zarr says of an array
_STATE, _RAISED, _MADE_OF, _MODEL = "state", "raised", "sweep", "model"
# the attribute by which xarray knows the dimensions of an array
_DIMENSIONS = "_ARRAY_DIMENSIONS"
_ABOUT_STATE = {
    "long_name": "state",
    "flag_values": [OPEN, DONE, RAISED],
    "flag_meanings": "open done raised",
    "description": "whether a point has been computed, or its call raised",
}


class Record:
    """Which files of a store were written, and a checksum of each.

    One line of JSON for each array that was made and for each chunk that was kept,
    written after their files. So a chunk that has a line was written whole, and whatever
    differs from its line was changed afterwards. Of each the last line counts.
    """

    def __init__(self, store: Path, array: str):
        self._store, self._file = store, store / array / _RECORD
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
            {
                "array": name,
                "files": self._checksums(f"{name}/{file}" for file in _METADATA),
            }
        )

    def add_chunk(
        self, number: int, state: int, message: str, models: list[str], files: list[str]
    ) -> None:
        """Says that a chunk was kept, in these files."""
        line = {"chunk": number, "state": state, "message": message, "models": models}
        self._add({**line, "files": self._checksums(files)})

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
            (
                name
                for name, kept in files.items()
                if _checksum(self._store / name) != kept
            ),
            "",
        )

    def _checksums(self, files: Iterable[str]) -> dict[str, list[int] | None]:
        return {name: _checksum(self._store / name) for name in files}


class Store:
    """A folder in zarr's second format. Each chunk is one file per quantity, put in
    place whole; its record comes last.

    What a process that was killed, or a full disk, leaves behind is never wrong: the
    store says first what it is made of, an array or a chunk without a line in the
    record is made anew, and so is a chunk whose files are not those of its line.
    """

    def __init__(self, path: Path, grid: Grid):
        self.path, self._grid, self._chunks = path, grid, grid.chunks()
        self._group: Any = self._open_group(grid.identity(__version__))
        # of a process that was killed while it wrote
        for left in path.rglob("*.partial"):
            left.unlink(missing_ok=True)
        self._record = Record(path, _STATE)
        present = [
            name for name in self._record.arrays if self._record.array_is_there(name)
        ]
        self._arrays: dict[str, Any] = {name: self._group[name] for name in present}
        self.damaged = self._set_aside()
        if _STATE not in self._arrays:
            self._arrays[_STATE] = self._new_array(
                _STATE, *self._points(np.dtype("u1")), _ABOUT_STATE
            )
        self._write_axes()
        chunks = self._record.chunks
        self.state = np.array(
            [
                chunks[n]["state"] if n in chunks else OPEN
                for n in range(len(self._chunks))
            ]
        )

    def _open_group(self, identity: dict[str, Any]) -> Any:
        """The group, which says what it is made of. Raises `InputError` where that is
        something else, or not known.
        """
        import zarr

        path, root = self.path, self.path / ".zgroup"
        if (
            path.exists()
            and not root.is_file()
            and (not path.is_dir() or any(path.iterdir()))
        ):
            raise _not_ours(path)
        if root.is_file() and not _is_group(root):
            raise damaged(path, root)
        try:
            # Metadata collected by an earlier run may be older than what has been
            # written since.
            group: Any = zarr.open_group(
                path, mode="a", zarr_format=2, use_consolidated=False
            )
            made_of = group.attrs.get(_MADE_OF)
            told = None if made_of is None else json.loads(str(made_of))
        except OSError:
            raise
        # zarr raises whatever its reader of JSON stumbles over
        except Exception as error:
            raise damaged(path, path / ".zattrs" if _is_json(root) else root) from error
        if told is None:
            if _named(path, ".zarray"):
                raise _not_ours(path)
            group.attrs[_MADE_OF] = json.dumps(identity)
        elif mismatch := difference(told, identity):
            raise InputError(
                f"store {str(path)!r} was made with other inputs: {mismatch}. Give "
                "another store, or remove this one."
            )
        return group

    def _set_aside(self) -> dict[int, str]:
        """The first damaged file of each chunk that has one; these chunks are open
        again, their files removed.
        """
        lines = {
            number: line
            for number, line in self._record.chunks.items()
            if line["state"] != OPEN
        }
        changed = {
            number: self._record.changed(number, self._arrays) for number in lines
        }
        changed = {number: file for number, file in changed.items() if file}
        for number in changed:
            for file in self._record.chunks.pop(number)["files"]:
                (self.path / file).unlink(missing_ok=True)
        # the record is in its folder, and is made anew with it
        if _STATE not in self._arrays:
            self._record.clear()
            self._arrays = {}
        return changed

    def _write_axes(self) -> None:
        """The coordinates, which are small and therefore written each time."""
        for axis in self._grid.axes:
            if axis.name not in self._arrays:
                self._arrays[axis.name] = self._new_array(
                    axis.name, (axis.name,), axis.labels, axis.about
                )
            self._arrays[axis.name][...] = axis.labels

    def _points(self, dtype: np.dtype) -> tuple[list[str], np.ndarray]:
        """Names of the dimensions, and an array like one with a value for each
        point.
        """
        return [axis.name for axis in self._grid.axes], np.broadcast_to(
            np.zeros((), dtype), self._grid.shape
        )

    def _new_array(
        self, name: str, dims: Any, like: np.ndarray, about: dict[str, Any]
    ) -> Any:
        """A new array, NaN or zero where nothing is written; xarray takes the fill
        value of others for a mask.
        """
        attributes = {_DIMENSIONS: list(dims), **about} | (
            {"dtype": "bool"} if like.dtype.kind == "b" else {}
        )
        array = self._group.create_array(
            name,
            shape=like.shape,
            dtype=np.dtype("i1") if like.dtype.kind == "b" else like.dtype,
            chunks=self._grid.sizes() if like.shape == self._grid.shape else like.shape,
            fill_value=np.nan if like.dtype.kind == "f" else None,
            overwrite=True,
            attributes=attributes,
        )
        self._record.add_array(name)
        return array

    def keep(
        self,
        number: int,
        parts: dict[str, Any],
        message: str,
        models: list[str],
        state: int,
    ) -> None:
        """Writes the arrays of a chunk, its state, and last its line; `parts` are
        arrays and attributes.
        """
        chunk = self._chunks[number]
        for name, (values, about) in parts.items():
            if name not in self._arrays:
                self._arrays[name] = self._new_array(
                    name, *self._points(values.dtype), about
                )
            self._arrays[name][chunk] = values
        self._arrays[_STATE][chunk] = state
        place = [
            span.start // size
            for span, size in zip(chunk, self._grid.sizes(), strict=True)
        ]
        key = ".".join(map(str, place))
        self._record.add_chunk(
            number,
            state,
            message,
            models,
            [f"{name}/{key}" for name in (*parts, _STATE)],
        )
        self.state[number] = state

    def raised(self) -> dict[int, str]:
        """The messages of what did not compute, by the number of their chunk."""
        lines = sorted(self._record.chunks.items())
        return {
            number: line["message"]
            for number, line in lines
            if line["message"] and line["state"] != DONE
        }

    def not_converged(self) -> int:
        """How many points did not converge, in this run or in one before."""
        return int(np.count_nonzero(np.asarray(self._arrays["converged"][...]) == 0))

    def finish(self) -> None:
        """Puts models and all that was raised into the attributes, and collects the
        metadata for readers.
        """
        import zarr

        models = sorted(
            {model for line in self._record.chunks.values() for model in line["models"]}
        )
        if models:
            self._group.attrs[_MODEL] = " | ".join(models)
        if raised := self.raised():
            self._group.attrs[_RAISED] = list(raised.values())
        elif _RAISED in self._group.attrs:
            del self._group.attrs[_RAISED]
        zarr.consolidate_metadata(self._group.store, zarr_format=2)

    def opened(self) -> xarray.Dataset:
        """The store as a Dataset whose arrays are read when they are used."""
        import xarray

        return xarray.open_zarr(self.path, chunks=None, consolidated=True)


def _named(path: Path, file: str) -> list[str]:
    """The folders that hold such a file; zarr would warn of what a killed process has
    left.
    """
    return sorted(marker.parent.name for marker in path.glob(f"*/{file}"))


def _is_group(path: Path) -> bool:
    """Whether a `.zgroup` says what zarr writes there: another format would be taken for
    an empty group.
    """
    return _is_json(path) and json.loads(path.read_bytes()).get("zarr_format") == 2


def _is_json(path: Path) -> bool:
    try:
        return isinstance(json.loads(path.read_bytes()), dict)
    except ValueError:
        return False


def _not_ours(path: Path) -> InputError:
    return InputError(
        f"store must be a new folder or one that em.sweep has made, got {str(path)!r}."
    )


def _checksum(path: Path) -> list[int] | None:
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
