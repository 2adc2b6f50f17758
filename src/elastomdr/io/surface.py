"""Measured heights: arrays, text files with units, and the files of instruments."""

from __future__ import annotations

import importlib.util
import io
import os
import subprocess
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import in_si, plain, positive
from ..errors import InputError
from ..files import read_bytes
from ..surface.topography import MeasuredSurface, Scan, surface
from ..units.registry import to_si, usual
from .data import FitWarning
from .dropouts import LEFT_OUT, without_dropouts
from .sheets import read_sheet
from .tables import Head, clean, main_table, splits

if TYPE_CHECKING:
    from jaxtyping import Float

    Heights = Float[np.ndarray, " n"] | Float[np.ndarray, "n_x n_y"]

_LARGEST = 1e100  # [m]
_TABLES = (".csv", ".tsv", "")  # names of tables
# names of tables, or of an instrument's text; other files are an instrument's
_TEXT = (*_TABLES, ".txt", ".dat")
_PATIENCE = 120  # seconds for an instrument's file
_EVEN = 1e-4  # unevenness of x, relative to its step, that counts as rounding
_MOST = 4_000_000  # even points along a profile

Path_ = str | os.PathLike[str]
PixelSize = float | tuple[float, float] | None


@in_si
def read_surface(
    path_or_heights: Path_ | Heights | Sequence[Path_ | Heights],
    *,
    pixel_size: PixelSize | Sequence[PixelSize] = None,
    unit: str | None = None,
    shortest: float | None = None,
    detrend: bool = True,
) -> MeasuredSurface:
    """The isotropic spectrum of a measured profile or map, or of several scans of the
    same surface.

    A text file (.csv, .tsv, .txt, .dat) holds a profile in two columns, x and height,
    or a map in three, x, y and height, with titles such as "x [mm], height [um]". With
    `pixel_size` it holds heights only: one column for a profile, a matrix for a map.
    Cells that are empty or no number are holes. Every other file is read by
    SurfaceTopography (`pip install elastomdr[instruments]`): x3p, sur, plu, opd, al3d,
    vk4, mnt, ibw, gwy, npy, ...

    Dropouts of the instrument that it wrote as numbers (a code such as -9999, single
    spikes) are holes too, with a warning; too many are refused.

    Nothing is scaled: C holds the waves from half the length of the scan down to four
    steps, or down to where noise or the resolution of the instrument ends the
    measurement. `report` compares the rms height and the rms slope of the data with
    those of the spectrum, and says what was mended and cut.

    Args:
        path_or_heights: a path; heights [m], shape (n,) for a profile and (n_x, n_y)
            for a map, where masked entries and NaN are holes; or a list of these,
            joined into one spectrum.
        pixel_size: distance of neighbouring points [m], or one for each direction of a
            map. Needed for arrays and for files without one. For several scans a list
            with an entry for each, None where the file has it.
        unit: unit of the lengths in a file that names none, such as "um".
        shortest: shortest wavelength to keep [m], from two steps on.
        detrend: whether to subtract a straight line or plane.

    Returns:
        A surface for `em.friction`, with `q` [rad/m], `c` [m^4], `relative_error`
        (standard error of ln C), `report`.

    Raises:
        InputError: where a file cannot be read, or heights and sizes are no scan in
            metres.
    """
    if shortest is not None:
        shortest = plain("shortest", shortest)
        positive("shortest", shortest)
    if unit is not None and not (isinstance(unit, str) and to_si(unit, "length")):
        raise InputError(
            f"unit must be a unit of length such as {usual('length')}, got {unit!r}."
        )
    sources: list[Any] = (
        list(path_or_heights) if isinstance(path_or_heights, (list, tuple)) else []
    )
    several = any(isinstance(one, (str, os.PathLike, np.ndarray)) for one in sources)
    sources = sources if several else [path_or_heights]
    sizes = (
        pixel_size
        if several and isinstance(pixel_size, list)
        else [pixel_size] * len(sources)
    )
    if len(sizes) != len(sources):
        raise InputError(
            f"pixel_size must have an entry for each of the {len(sources)} scans, "
            f"got {len(sizes)}."
        )
    scans = [
        _scan(source, size, unit) for source, size in zip(sources, sizes, strict=True)
    ]
    paths = [
        Path(source).name
        for source in sources
        if isinstance(source, (str, os.PathLike))
    ]
    for text in dict.fromkeys(
        text for scan in scans for text in scan.report if text.endswith(LEFT_OUT)
    ):
        warnings.warn(
            f"{', '.join(paths) or 'heights'}: {text}.", FitWarning, stacklevel=3
        )
    try:
        return surface(scans, shortest, detrend)
    except InputError as error:
        raise InputError(
            f"path: {', '.join(map(repr, paths))}: {error}" if paths else str(error)
        ) from error


def _scan(source: Any, pixel_size: Any, unit: str | None) -> Scan:
    if isinstance(source, (str, os.PathLike)):
        path = Path(source)
        try:
            if path.suffix.lower() not in _TEXT:
                return _from_instrument(path, pixel_size, unit)
            return _from_text(path, pixel_size, unit)
        except InputError as error:
            said = str(error)
            raise InputError(
                said if said.startswith("path") else f"path: {path.name!r}: {said}"
            ) from error
    if unit is not None:
        raise InputError(
            "unit goes with a file; heights of an array are in metres, got "
            f"unit={unit!r}."
        )
    try:
        height = np.ma.filled(np.ma.asarray(source, dtype=np.float64), np.nan)
    except (TypeError, ValueError) as error:
        raise InputError(
            "path_or_heights must be a path, heights [m] or a list of these, got "
            f"{type(source).__name__}."
        ) from error
    if height.ndim not in (1, 2):
        raise InputError(
            f"heights must have the shape (n,) or (n_x, n_y), got {height.shape}."
        )
    return _even(height, pixel_size, "heights")


def _even(
    height: np.ndarray, pixel_size: Any, what: str, report: Sequence[str] = ()
) -> Scan:
    """Heights [m] whose points are `pixel_size` [m] apart."""
    if pixel_size is None:
        raise InputError(
            f"pixel_size must be given with {what}: the distance of neighbouring "
            "points [m], got None."
        )
    sizes = [
        plain("pixel_size", size)
        for size in (pixel_size if np.ndim(pixel_size) else [pixel_size])
    ]
    for size in sizes:
        positive("pixel_size", size)
    if len(sizes) not in (1, height.ndim):
        raise InputError(
            "pixel_size must be one number [m] or one for each direction, got "
            f"{len(sizes)}."
        )
    _below(height, what)
    height, dropouts = without_dropouts(height)
    return Scan(
        height,
        tuple(sizes * height.ndim if len(sizes) == 1 else sizes),
        (*report, *dropouts),
    )


def _below(lengths: np.ndarray, what: str) -> None:
    known = np.abs(lengths[np.isfinite(lengths)])
    if known.size and not known.max() < _LARGEST:
        raise InputError(
            f"{what} must be lengths below {_LARGEST:g} m, got one of "
            f"{known.max():g} "
            "m."
        )


def _from_text(path: Path, pixel_size: Any, unit: str | None) -> Scan:
    try:
        table = main_table(read_sheet(path), 2 if pixel_size is None else 1)
    except InputError:
        table = None
        if not path.is_file():
            raise
    if table is None or (pixel_size is None and len(table.heads) not in (2, 3)):
        if path.suffix.lower() not in _TABLES and _can_read_instruments():
            return _from_instrument(path, pixel_size, unit)
        got = (
            f"{len(table.heads)} in {path.name!r}"
            if table
            else f"{path.name!r} without a row of two numbers"
        )
        raise InputError(
            "path must be a table with two columns (x, height) or three (x, y, "
            f"height), got {got}; a matrix of "
            "heights needs pixel_size."
        )
    for row in table.rows:
        if len(row.cells) != len(table.heads):
            raise InputError(
                f"path: {path.name!r} has {len(row.cells)} cells in line {row.line}, "
                f"{len(table.heads)} in line {table.rows[0].line}."
            )
    data = np.stack(
        [
            table.column(head.place) * _metres(head, unit, path.name)
            for head in table.heads
        ],
        axis=1,
    )
    if pixel_size is not None:
        return _even(data[:, 0] if data.shape[1] == 1 else data, pixel_size, "heights")
    _below(data, "columns")
    return _profile(data[:, 0], data[:, 1]) if data.shape[1] == 2 else _grid(data)


def _can_read_instruments() -> bool:
    return importlib.util.find_spec("SurfaceTopography") is not None


def _from_instrument(path: Path, pixel_size: Any, unit: str | None) -> Scan:
    if not _can_read_instruments():
        raise InputError(
            "path must be a table of heights (.csv, .tsv, .txt, .dat), got "
            f"{path.name!r}; files of instruments are "
            "read with SurfaceTopography, which is not installed: pip install "
            "elastomdr[instruments]."
        )
    try:
        read_bytes(path)
        reader = Path(__file__).with_name("instrument.py")
        done = subprocess.run(
            [sys.executable, reader, path],
            capture_output=True,
            timeout=_PATIENCE,
            check=False,
        )
    except (OSError, ValueError) as error:
        raise InputError(
            f"path must be a file that can be read, got {path.name!r}: {error}."
        ) from error
    except subprocess.TimeoutExpired as error:
        raise InputError(
            f"path: {path.name!r} was not read within {_PATIENCE} s."
        ) from error
    if done.returncode != 0:
        why = (
            " ".join(done.stdout.decode(errors="replace").split())[:300]
            or "the reader gave up"
        )
        raise InputError(
            f"path must be a file that SurfaceTopography reads, got {path.name!r}: "
            f"{why}"
        )
    with np.load(io.BytesIO(done.stdout)) as found:
        x, y, height, sized = (
            found["x"],
            found["y"],
            found["height"],
            bool(found["sized"]),
        )
        given = str(found["unit"]) or unit
    if given is None:
        raise InputError(f"path: {path.name!r} says nothing of its unit; give unit=.")
    metres = _length(given, path.name)
    if sized and pixel_size is not None:
        raise InputError(
            f"pixel_size must be left out, {path.name!r} has its own, got "
            f"{pixel_size!r}."
        )
    height = height * metres
    if sized and y.size == 0:
        return _profile(x * metres, height)
    if sized:
        pixel_size = tuple(
            float(axis[1] - axis[0]) * metres if axis.size > 1 else 1.0
            for axis in (x, y)
        )
    return _even(height, pixel_size, f"{path.name!r}, which has none")


def _profile(x: np.ndarray, height: np.ndarray) -> Scan:
    """An even profile from points in any order."""
    order = np.argsort(x, kind="stable")
    measured, report = without_dropouts(height[order])
    height[order] = measured
    known = np.isfinite(x) & np.isfinite(height)
    if not known.all():
        report.append(
            f"{int((~known).sum())} of {known.size} points without a value "
            "bridged by "
            "straight lines"
        )
    x, height = x[known], height[known]
    if (np.diff(x) < 0).any():
        report.append("x was not ascending: sorted")
    x, place = np.unique(x, return_inverse=True)
    if x.size < place.size:
        report.append(
            f"{place.size - x.size} points at an x that came before: heights averaged"
        )
    height = np.bincount(place, height) / np.bincount(place)
    if x.size < 64:
        raise InputError(
            f"a profile must have 64 points or more at different x, got {x.size}."
        )
    n = round(float((x[-1] - x[0]) / np.median(np.diff(x)))) + 1
    if n > _MOST:
        raise InputError(
            f"x of a profile spans {n:.3g} of its median steps, more than "
            f"{_MOST:.0e}: is one of the values mistyped?"
        )
    even = np.linspace(x[0], x[-1], n)
    if n != x.size or np.abs(x - even).max() > _EVEN * (even[1] - even[0]):
        report.append(f"x was not evenly spaced: {n} even points by straight lines")
        height = np.interp(even, x, height)
    return Scan(height, (float(even[1] - even[0]),), tuple(report))


def _grid(data: np.ndarray) -> Scan:
    """The map whose points are the rows x, y, height, in any order."""
    report = []
    placed = np.isfinite(data[:, :2]).all(axis=1)
    if not placed.all():
        report.append(
            f"{int((~placed).sum())} of {placed.size} rows without x or y left out"
        )
    data = data[placed]
    (x, i), (y, j) = (np.unique(data[:, k], return_inverse=True) for k in (0, 1))
    if min(x.size, y.size) < 16 or x.size * y.size > 4 * len(data):
        raise InputError(
            f"a map must lie on a grid of 16 by 16 points or more, got {x.size} x "
            f"and {y.size} y values."
        )
    for axis, values in (("x", x), ("y", y)):
        if np.ptp(np.diff(values)) > 1e-3 * np.diff(values).mean():
            raise InputError(f"{axis} of a map must be evenly spaced.")
    rows = [
        k for a in (i, -i) for b in (j, -j) for k in (a * y.size + b, b * x.size + a)
    ]
    if not any((np.diff(k) >= 0).all() for k in rows):
        report.append("points did not come row by row: sorted")
    place, known = i * y.size + j, np.isfinite(data[:, 2])
    again = place.size - np.unique(place).size
    if again:
        report.append(f"{again} points at a place that came before: heights averaged")
    count = np.bincount(place[known], minlength=x.size * y.size)
    total = np.bincount(place[known], data[known, 2], minlength=x.size * y.size)
    height = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    steps = tuple(float((axis[-1] - axis[0]) / (axis.size - 1)) for axis in (x, y))
    grid, dropouts = without_dropouts(height.reshape(x.size, y.size))
    return Scan(grid, steps, (*report, *dropouts))


def _metres(head: Head, unit: str | None, name: str) -> float:
    """The length of one unit of a column [m]."""
    below = head.below.strip("[]() ")
    ways = [below] if below else [said for _, said in splits(clean(head.title))]
    given = next((said for said in ways if to_si(said, "length")), unit)
    if given is None:
        raise InputError(
            f"path: {name!r} has no unit of length in column {head.place + 1} "
            f'{head.title!r}; write titles such as "x [mm], height [um]", or give '
            'unit, such as "um".'
        )
    return _length(given, name)


def _length(unit: str, name: str) -> float:
    si = to_si(unit, "length")
    if si is None:
        raise InputError(
            f"path: {name!r} has the unit {unit!r}, which is none of length such "
            f"as {usual('length')}."
        )
    return si[0]
