"""The store of a sweep: a zarr group with one array per quantity, and which of its points are done."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import __version__
from ..errors import InputError
from .grid import Grid, difference

if TYPE_CHECKING:
    import xarray

OPEN, DONE, RAISED = 0, 1, 2  # the state of a chunk
_STATE, _RAISED, _MADE_OF, _MODEL = "state", "raised", "sweep", "model"
_DIMENSIONS = "_ARRAY_DIMENSIONS"  # the attribute by which xarray knows the dimensions of an array
_ABOUT_STATE = {
    "long_name": "state", "flag_values": [OPEN, DONE, RAISED], "flag_meanings": "open done raised",
    "description": "whether a point has been computed, or its call raised",
}  # fmt: skip


class Store:
    """A folder in zarr's second format. Each chunk is one file per quantity, put in place whole; its state comes last.

    What a process that was killed, or a full disk, leaves behind is never wrong: the store says first what it is made
    of, an array without its dimensions is made anew, and a chunk counts when its state is written.
    """

    def __init__(self, path: Path, grid: Grid):
        import zarr

        self.path, self._grid, self._chunks = path, grid, grid.chunks()
        identity = grid.identity(__version__)
        if path.exists() and not (path / ".zgroup").is_file() and (not path.is_dir() or any(path.iterdir())):
            raise _not_ours(path)
        # Metadata collected by an earlier run may be older than what has been written since.
        self._group: Any = zarr.open_group(path, mode="a", zarr_format=2, use_consolidated=False)
        made_of = self._group.attrs.get(_MADE_OF)
        if made_of is None:
            if _named(path, ".zarray"):
                raise _not_ours(path)
            self._group.attrs[_MADE_OF] = json.dumps(identity)
        elif text := difference(json.loads(str(made_of)), identity):
            raise InputError(
                f"store {str(path)!r} was made with other inputs: {text}. Give another store, or remove this one."
            )
        for left in path.rglob("*.partial"):  # of a process that was killed while it wrote
            left.unlink(missing_ok=True)
        # To look an array up reads its metadata again.
        try:
            found = {name: self._group[name] for name in _named(path, ".zarray")}
        except (ValueError, TypeError, KeyError) as error:  # a codec or a type that no sweep has written
            raise _not_ours(path) from error
        self._arrays = {name: array for name, array in found.items() if _DIMENSIONS in array.attrs}
        if _STATE not in self._arrays:
            for axis in grid.axes:
                self._array(axis.name, (axis.name,), axis.labels, axis.about)[...] = axis.labels
            self._arrays[_STATE] = self._array(_STATE, *self._points(np.dtype("u1")), _ABOUT_STATE)
        for array in self._arrays.values():
            if array.shape != grid.shape and array.name.lstrip("/") not in {axis.name for axis in grid.axes}:
                raise _not_ours(path)
        state = np.asarray(self._arrays[_STATE][...])
        self.state = np.array([state[tuple(place.start for place in chunk)] for chunk in self._chunks])
        self._models = set(str(self._group.attrs.get(_MODEL, "")).split(" | ")) - {""}

    def _points(self, dtype: np.dtype) -> tuple[list[str], np.ndarray]:
        """Names of the dimensions, and an array like one with a value for each point."""
        return [axis.name for axis in self._grid.axes], np.broadcast_to(np.zeros((), dtype), self._grid.shape)

    def _array(self, name: str, dims: Any, like: np.ndarray, about: dict[str, Any]) -> Any:
        """A new array, NaN or zero where nothing is written; xarray takes the fill value of others for a mask."""
        attributes = {_DIMENSIONS: list(dims), **about} | ({"dtype": "bool"} if like.dtype.kind == "b" else {})
        return self._group.create_array(
            name, shape=like.shape, dtype=np.dtype("i1") if like.dtype.kind == "b" else like.dtype,
            chunks=self._grid.sizes() if like.shape == self._grid.shape else like.shape,
            fill_value=np.nan if like.dtype.kind == "f" else None, overwrite=True, attributes=attributes,
        )  # fmt: skip

    def keep(self, number: int, parts: dict[str, Any], message: str, models: list[str], state: int) -> None:
        """Writes the arrays of a chunk and what was raised, then its state; `parts` are arrays and attributes."""
        chunk = self._chunks[number]
        for name, (values, about) in parts.items():
            if name not in self._arrays:
                self._arrays[name] = self._array(name, *self._points(values.dtype), about)
            self._arrays[name][chunk] = values
        if message:
            self._group.create_group(f"{_RAISED}/{number}", overwrite=True, attributes={_RAISED: message})
        if not self._models.issuperset(models):
            self._models.update(models)
            self._group.attrs[_MODEL] = " | ".join(sorted(self._models))
        if state != OPEN:
            self._arrays[_STATE][chunk] = state
            self.state[number] = state

    def raised(self) -> dict[int, str]:
        """The messages of what did not compute, by the number of their chunk."""
        kept = _named(self.path / _RAISED, ".zgroup")
        said = {int(name): self._group[f"{_RAISED}/{name}"].attrs.get(_RAISED) for name in kept}
        return {number: said[number] for number in sorted(said) if said[number] and self.state[number] != DONE}

    def not_converged(self) -> int:
        """How many points did not converge, in this run or in one before."""
        return int(np.count_nonzero(np.asarray(self._arrays["converged"][...]) == 0))

    def finish(self) -> None:
        """Puts all that was raised into the attributes of the store, and collects the metadata for its readers."""
        import zarr

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
    """The folders that hold such a file; zarr would warn of what a killed process has left."""
    return sorted(found.parent.name for found in path.glob(f"*/{file}"))


def _not_ours(path: Path) -> InputError:
    return InputError(f"store must be a new folder or one that em.sweep has made, got {str(path)!r}.")
