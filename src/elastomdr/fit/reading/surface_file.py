"""Reading a measured surface: a CSV file of a profile or of a map, columns with units; or an instrument's file."""

import importlib.util
import io
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from ..._runtime import plain, positive
from ...errors import InputError
from ...files import read_bytes
from ...mapping.measured import MeasuredSurface, from_map, from_profile
from .table import METRES, Table, read_table

_LARGEST = 1e100  # [m]
_TEXT = (".csv", ".tsv", ".txt", ".dat", "")  # names of tables; other files are an instrument's
_PATIENCE = 120  # seconds for an instrument's file


def surface_from_file(
    path: str | os.PathLike[str], *, unit: str | None = None, shortest: Any = None, detrend: bool = True
) -> MeasuredSurface:
    """A measured surface from a CSV file: a profile in two columns, x and height, or a map in three, x, y and height.

    The line of titles carries the units, such as "x [mm], height [um]"; without them `unit` names the one unit of all
    columns. Cells that are empty or no number are holes. Lines that start with # are passed over, unless they hold the
    titles; comma, semicolon, tab or blank separates. `shortest` [m] is the shortest wavelength to keep (default: two
    steps), `detrend` takes a straight line or plane off. What had to be mended is in `report`. The surface is taken to
    be isotropic. Raises `InputError`.

    A file that is not called .csv, .tsv, .txt or .dat is taken for an instrument's (x3p, sur, plu, opd, al3d, vk4, mnt,
    ibw, gwy, ...), which `pip install elastomdr[instruments]` (SurfaceTopography) reads, with the unit in it.
    """
    name = Path(path).name
    if shortest is not None:
        shortest = plain("shortest", shortest)
        positive("shortest", shortest)
    if Path(path).suffix.lower() not in _TEXT:
        return _from_instrument(Path(path), unit, shortest, detrend)
    table = read_table(path, "heights", METRES.__contains__)
    data = table.data * _units(table, unit, name)
    if not np.all(np.abs(data[np.isfinite(data)]) < _LARGEST):
        raise InputError(
            f"path: {name!r} must hold lengths below {_LARGEST:g} m, got one of {np.nanmax(np.abs(data)):g} m."
        )
    try:
        if data.shape[1] == 2:
            return from_profile(data[:, 0], data[:, 1], shortest, detrend)
        grid, mended = _grid(data)
        return from_map(*grid, shortest, detrend, mended)
    except InputError as error:
        raise InputError(f"path: {name!r}: {error}") from error


def _from_instrument(path: Path, unit: str | None, shortest: float | None, detrend: bool) -> MeasuredSurface:
    if importlib.util.find_spec("SurfaceTopography") is None:
        raise InputError(
            f"path must be a table of heights (.csv, .tsv, .txt, .dat), got {path.name!r}; files of instruments are "
            "read with SurfaceTopography, which is not installed: pip install elastomdr[instruments]."
        )
    try:
        read_bytes(path)
        reader = Path(__file__).with_name("instrument.py")
        done = subprocess.run([sys.executable, reader, path], capture_output=True, timeout=_PATIENCE, check=False)
    except (OSError, ValueError) as error:
        raise InputError(f"path must be a file that can be read, got {path.name!r}: {error}.") from error
    except subprocess.TimeoutExpired as error:
        raise InputError(f"path: {path.name!r} was not read within {_PATIENCE} s.") from error
    if done.returncode != 0:
        why = " ".join(done.stdout.decode(errors="replace").split())[:300] or "the reader gave up"
        raise InputError(f"path must be a file that SurfaceTopography reads, got {path.name!r}: {why}")
    with np.load(io.BytesIO(done.stdout)) as found:
        x, y, height, given = found["x"], found["y"], found["height"], str(found["unit"]) or unit
    if given is None:
        raise InputError(f"path: {path.name!r} says nothing of its unit; give unit=.")
    if given not in METRES:
        raise InputError(f"path: {path.name!r} has the unit {given!r}; accepted are {', '.join(METRES)}.")
    scale = METRES[given]
    try:
        if y.size == 0:
            return from_profile(x * scale, height * scale, shortest, detrend)
        return from_map(x * scale, y * scale, height * scale, shortest, detrend)
    except InputError as error:
        raise InputError(f"path: {path.name!r}: {error}") from error


def _grid(data: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], list[str]]:
    """x, y and heights of the grid that the rows of a map lie on, and what had to be mended."""
    report = []
    placed = np.isfinite(data[:, :2]).all(axis=1)
    if not placed.all():
        report.append(f"{int((~placed).sum())} of {placed.size} rows without x or y left out")
    data = data[placed]
    (x, i), (y, j) = (np.unique(data[:, k], return_inverse=True) for k in (0, 1))
    if min(x.size, y.size) < 16 or x.size * y.size > 4 * len(data):
        raise InputError(f"a map must lie on a grid of 16 by 16 points or more, got {x.size} x and {y.size} y values.")
    for axis, values in (("x", x), ("y", y)):
        if np.ptp(np.diff(values)) > 1e-3 * np.diff(values).mean():
            raise InputError(f"{axis} of a map must be evenly spaced.")
    rows = [k for a in (i, -i) for b in (j, -j) for k in (a * y.size + b, b * x.size + a)]
    if not any((np.diff(k) >= 0).all() for k in rows):
        report.append("points did not come row by row: sorted")
    place, known = i * y.size + j, np.isfinite(data[:, 2])
    again = place.size - np.unique(place).size
    if again:
        report.append(f"{again} points at a place that came before: heights averaged")
    count = np.bincount(place[known], minlength=x.size * y.size)
    total = np.bincount(place[known], data[known, 2], minlength=x.size * y.size)
    height = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    return (x, y, height.reshape(x.size, y.size)), report


def _units(table: Table, unit: str | None, name: str) -> np.ndarray:
    count = len(table.units)
    if count not in (2, 3):
        raise InputError(f"path must have two columns (x, height) or three (x, y, height), got {count} in {name!r}.")
    units = [given or unit for given in table.units]
    for given in units:
        if given is None:
            raise InputError(
                f'path: {name!r} has columns without a unit; write titles such as "x [mm], height [um]", or give unit=.'
            )
        if given not in METRES:
            raise InputError(f"path: {name!r} has the unit {given!r}; accepted are {', '.join(METRES)}.")
    return np.array([METRES[str(u)] for u in units])
