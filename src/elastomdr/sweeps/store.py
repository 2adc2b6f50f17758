"""The store of a sweep: a zarr group with one array per quantity, and which of its
points are done.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from .. import __version__
from ..errors import InputError
from .grid import Grid
from .identity import Json, difference
from .storage import Files, remembered

if TYPE_CHECKING:
    import xarray

OPEN, DONE, RAISED = 0, 1, 2  # the state of a chunk
# in the folder of an array, where zarr looks for nothing but chunks
_RECORDS = "state/.record"
_METADATA = (".zarray", ".zattrs")  # what zarr says of an array
_STATE, _RAISED, _MADE_OF, _MODEL = "state", "raised", "sweep", "model"
# the attribute by which xarray knows the dimensions of an array
_DIMENSIONS = "_ARRAY_DIMENSIONS"
_CHECKED = 50  # chunks whose files are read at the same time
_READ = 1000  # records that are
_ABOUT_STATE = {
    "long_name": "state",
    "flag_values": [OPEN, DONE, RAISED],
    "flag_meanings": "open done raised",
    "description": "whether a point has been computed, or its call raised",
}


# of a chunk: values and attributes by the name of the array
Parts: TypeAlias = dict[str, tuple[np.ndarray, Mapping[str, object]]]


class Record:
    """Which files of a store were written, and a checksum of each.

    One file of JSON for each array that was made and for each chunk that was kept,
    written after their files. So a chunk that has a record was written whole, and
    whatever differs from its record was changed afterwards. A record that cannot be read
    is none.
    """

    def __init__(self, files: Files, checksums: dict[str, list[int] | None]):
        """`checksums` are those of what zarr has written."""
        self._files, self._checksums = files, checksums
        self.arrays: dict[str, dict[str, Any]] = {}  # checksums by file, of each array
        # state, message, models and checksums, of each chunk
        self.chunks: dict[int, dict[str, Any]] = {}
        self.unreadable: dict[int, str] = {}  # the record of each chunk that has such
        names = [name for name in files.names() if name.startswith(f"{_RECORDS}/")]
        for start in range(0, len(names), _READ):
            batch = names[start : start + _READ]
            for name, content in zip(batch, files.read(batch), strict=True):
                self._take(name, content or b"")

    def _take(self, name: str, content: bytes) -> None:
        kind, _, what = name.removeprefix(f"{_RECORDS}/").partition(".")
        try:
            record = json.loads(content)
            if kind == "array":
                self.arrays[what] = dict(record["files"])
            else:
                self.chunks[int(what)] = {
                    "state": int(record["state"]),
                    "message": str(record["message"]),
                    "models": list(record["models"]),
                    "files": dict(record["files"]),
                }
        except (ValueError, KeyError, TypeError):
            if kind == "chunk" and what.isdecimal():
                self.unreadable[int(what)] = name

    def _add(self, name: str, record: Mapping[str, object]) -> None:
        name, content = f"{_RECORDS}/{name}", json.dumps(record).encode()
        self._files.write(name, content)
        self._take(name, content)

    def add_array(self, name: str) -> None:
        """Says that an array was made."""
        files = [f"{name}/{file}" for file in _METADATA]
        self._add(f"array.{name}", {"files": self._written(files)})

    def add_chunk(
        self, number: int, state: int, message: str, models: list[str], files: list[str]
    ) -> None:
        """Says that a chunk was kept, in these files."""
        record = {"state": state, "message": message, "models": models}
        self._add(f"chunk.{number}", {**record, "files": self._written(files)})

    def _written(self, files: list[str]) -> dict[str, list[int] | None]:
        """Checksums of files that were just written, by zarr or else by what is there."""
        known = self._checksums
        others = self._files.checksums([file for file in files if file not in known])
        return {file: known.pop(file, others.get(file)) for file in files}

    def array_is_there(self, name: str) -> bool:
        """Whether an array was made and is there. Raises `InputError` where what zarr
        says of it was changed.
        """
        files = self.arrays.get(name, {})
        present = self._files.checksums(list(files))
        if not files or None in present.values():
            return False
        for file, checksum in files.items():
            if present[file] != checksum:
                raise damaged(self._files.place, file)
        return True

    def changed(self, arrays: Iterable[str]) -> dict[int, str]:
        """Of each chunk that is not as it was written the first such file: one that
        differs, or whose array is none of those that are there.
        """
        changed = dict(self.unreadable)
        numbers = [n for n, record in self.chunks.items() if record["state"] != OPEN]
        for start in range(0, len(numbers), _CHECKED):
            batch = {n: self.chunks[n]["files"] for n in numbers[start:][:_CHECKED]}
            present = self._files.checksums(
                [file for files in batch.values() for file in files]
            )
            for number, files in batch.items():
                for file, checksum in files.items():
                    array = file.partition("/")[0]
                    if array not in arrays or present[file] != checksum:
                        changed.setdefault(number, file)
        return changed

    def forget(self) -> None:
        """Nothing was written, or it is written anew."""
        self.arrays, self.chunks = {}, {}


class ZarrStore:
    """Files in zarr's second format. Each chunk is one file per quantity, put in place
    whole; its record comes last.

    What a process that was killed, or a full disk, leaves behind is never wrong: the
    store says first what it is made of, an array or a chunk without a record is made
    anew, and so is a chunk whose files are not those of its record.
    """

    def __init__(self, files: Files, grid: Grid, made_of: Mapping[str, Json]):
        """`made_of` is what a store has to have been made of to be gone on with."""
        self.files, self._grid, self._chunks = files, grid, grid.chunks()
        self._making = threading.Lock()  # held while an array is made
        self._group: Any = self._open_group({"elastomdr": __version__, **made_of})
        self._record = Record(files, self._group.store.checksums)
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

    def _open_group(self, identity: Json) -> Any:
        """The group, which says what it is made of. Raises `InputError` where that is
        something else.
        """
        import zarr

        place = self.files.place
        root, attributes = self.files.read([".zgroup", ".zattrs"])
        if root is None and not self.files.is_empty():
            raise _not_ours(place)
        # another format would be taken for an empty group
        if root is not None and _json(root).get("zarr_format") != 2:
            raise damaged(place, ".zgroup")
        try:
            made_of = _json(attributes or b"{}")[_MADE_OF]
            told = json.loads(made_of)  # pyright: ignore[reportArgumentType]
        except KeyError:
            told = None
        except (ValueError, TypeError) as error:
            raise damaged(place, ".zattrs") from error
        if told is not None and (mismatch := difference(told, identity)):
            raise InputError(
                argument="store",
                got=place,
                accepted="made with the same inputs",
                hint=f"{mismatch}; give another store, or remove this one",
            )
        if told is None and any(
            name.endswith("/.zarray") for name in self.files.names()
        ):
            raise _not_ours(place)
        # Metadata collected by an earlier run may be older than what has been written
        # since.
        group: Any = zarr.open_group(
            remembered(self.files.zarr_store()),
            mode="a",
            zarr_format=2,
            use_consolidated=False,
        )
        if told is None:
            group.attrs[_MADE_OF] = json.dumps(identity)
        return group

    def _set_aside(self) -> dict[int, str]:
        """The first damaged file of each chunk that has one; these chunks are open
        again, their files removed.
        """
        changed = self._record.changed(self._arrays)
        for number in changed:
            record = self._record.chunks.pop(number, {"files": {}})
            self.files.remove(record["files"])
        # the records are in its folder, and are removed when it is made anew
        if _STATE not in self._arrays:
            self._record.forget()
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
        self,
        name: str,
        dims: Iterable[str],
        like: np.ndarray,
        about: Mapping[str, object],
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
        parts: Parts,
        message: str,
        models: list[str],
        state: int,
    ) -> None:
        """Writes the arrays of a chunk, its state, and last its record; `parts` are
        arrays and attributes. Threads may keep several chunks at a time.
        """
        chunk = self._chunks[number]
        for name, (values, about) in parts.items():
            with self._making:
                if name not in self._arrays:
                    points = self._points(values.dtype)
                    self._arrays[name] = self._new_array(name, *points, about)
            self._arrays[name][chunk] = values
        self._arrays[_STATE][chunk] = state
        place = [
            span.start // size
            for span, size in zip(chunk, self._grid.sizes(), strict=True)
        ]
        key = ".".join(map(str, place))
        files = [f"{name}/{key}" for name in (*parts, _STATE)]
        self._record.add_chunk(number, state, message, models, files)
        self.state[number] = state

    def raised(self) -> dict[int, str]:
        """The messages of what did not compute, by the number of their chunk."""
        records = sorted(self._record.chunks.items())
        return {
            number: record["message"]
            for number, record in records
            if record["message"] and record["state"] != DONE
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
            {
                model
                for record in self._record.chunks.values()
                for model in record["models"]
            }
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

        return xarray.open_zarr(self.files.zarr_store(), chunks=None, consolidated=True)


def _json(content: bytes) -> dict[str, Json]:
    """What a file of metadata says; nothing where that cannot be read."""
    try:
        entries = json.loads(content)
    except ValueError:
        return {}
    return entries if isinstance(entries, dict) else {}


def _not_ours(place: str) -> InputError:
    return InputError(
        argument="store",
        got=place,
        accepted="a new folder or URL, or one that em.sweep has made",
    )


def damaged(place: str, file: str) -> InputError:
    """What is raised for a file from which nothing can be made anew unless it is
    removed.
    """
    folder = file.rpartition("/")[0]
    remove = f"its folder {folder!r}" if folder else "this store"
    return InputError(
        argument="store",
        got=place,
        accepted="as em.sweep wrote it",
        hint=f"{file!r} is damaged; remove {remove}, and the same call computes it "
        "again",
    )
