"""The store of a sweep: a zarr group with one array per quantity, and which of its chunks are done."""

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
_STATE, _RAISED, _MADE_OF = "chunk_state", "raised", "sweep"


class Store:
    """A folder in zarr's second format. Each chunk is one file per quantity, put in place whole, and marked after."""

    def __init__(self, path: Path, grid: Grid):
        import zarr

        self.path, self._grid, self._count = path, grid, len(grid.chunks())
        identity = grid.identity(__version__)
        if path.exists() and not (path / ".zgroup").is_file() and (not path.is_dir() or any(path.iterdir())):
            raise InputError(f"store must be a new folder or one that em.sweep has made, got {str(path)!r}.")
        self._group: Any = zarr.open_group(path, mode="a", zarr_format=2)
        made_of = self._group.attrs.get(_MADE_OF)
        if made_of is None and list(self._group.array_keys()):
            raise InputError(f"store must be a new folder or one that em.sweep has made, got {str(path)!r}.")
        if made_of is not None and (text := difference(json.loads(str(made_of)), identity)):
            raise InputError(
                f"store {str(path)!r} was made with other inputs: {text}. Give another store, or remove this one."
            )
        if made_of is None:
            for axis in grid.axes:
                self._new(axis.name, (axis.name,), axis.labels, None, axis.about)
            self._new(_STATE, ("chunk",), np.zeros(self._count, dtype="u1"), (1,), {})
            self._group.attrs[_MADE_OF] = json.dumps(identity)  # last: without it the store is begun anew
        self._arrays = dict(self._group.arrays())  # to look one up reads its metadata again
        self.state = np.asarray(self._arrays[_STATE][:])

    def _new(self, name: str, dims: tuple[str, ...], values: np.ndarray, chunks: Any, about: dict) -> None:
        self._array(name, dims, values.shape, chunks or values.shape, values.dtype, about)[...] = values

    def _array(self, name: str, dims: Any, shape: Any, chunks: Any, dtype: np.dtype, about: dict[str, str]) -> Any:
        """A new array, NaN or zero where nothing is written; xarray takes the fill value of others for a mask."""
        attributes = {"_ARRAY_DIMENSIONS": list(dims), **about} | ({"dtype": "bool"} if dtype.kind == "b" else {})
        stored = np.dtype("i1") if dtype.kind == "b" else dtype
        return self._group.create_array(
            name, shape=shape, dtype=stored, chunks=chunks, fill_value=np.nan if dtype.kind == "f" else None,
            overwrite=True, attributes=attributes,
        )  # fmt: skip

    def keep(self, number: int, chunk: tuple[slice, ...], parts: dict[str, Any], message: str, state: int) -> None:
        """Writes the arrays of a chunk, then marks it; `parts` are arrays and attributes by name."""
        for name, (values, about) in parts.items():
            if name not in self._arrays:
                dims, sizes = [axis.name for axis in self._grid.axes], self._grid.sizes()
                self._arrays[name] = self._array(name, dims, self._grid.shape, sizes, values.dtype, about)
            self._arrays[name][chunk] = values
        if message:
            raised = dict(self._group.attrs.get(_RAISED, {}))
            self._group.attrs[_RAISED] = raised | {str(number): message}
        self._arrays[_STATE][number] = state
        self.state[number] = state

    def raised(self) -> dict[str, str]:
        """The messages of what did not compute, by the number of their chunk."""
        return dict(self._group.attrs.get(_RAISED, {}))

    def not_converged(self) -> int:
        """How many points did not converge, in this run or in one before."""
        return int(np.count_nonzero(np.asarray(self._arrays["converged"][:]) == 0))

    def describe(self, attributes: dict[str, str]) -> None:
        """Adds what the results say of themselves to the attributes of the store, and collects the metadata."""
        import zarr

        self._group.attrs.update(attributes)
        zarr.consolidate_metadata(self._group.store, zarr_format=2)

    def opened(self) -> xarray.Dataset:
        """The store as a Dataset whose arrays are read when they are used."""
        import xarray

        found = xarray.open_zarr(self.path, chunks=None, consolidated=True)
        return found.set_coords([name for name in found if name in {axis.name for axis in self._grid.axes}])
