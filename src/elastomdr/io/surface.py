"""Measured heights: arrays, text files with units, and the files of instruments, without
what a profilometer could not measure and wrote as numbers: codes, such as -9999, and
single spikes.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import itertools
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..checks import as_float64, in_si, plain, positive, untraced
from ..errors import InputError, typed_as, warn
from ..surface.topography import MeasuredSurface, Scan, surface
from ..units.registry import to_si, usual
from .data import FitWarning
from .sheets import bytes_of, read_sheet, run_reader
from .tables import Head, main_table, named_heads, refuse_ragged, titled_unit

if TYPE_CHECKING:
    from jaxtyping import Float

    Heights = Float[np.ndarray, " n"] | Float[np.ndarray, "n_x n_y"]

_LARGEST = 1e100  # [m]
# names of tables, or of an instrument's text; other files are an instrument's
_TEXT = (".csv", ".tsv", "", ".txt", ".dat")
_PATIENCE = 120  # seconds for an instrument's file
_EVEN = 1e-4  # unevenness of x, relative to its step, that counts as rounding
_MOST = 4_000_000  # even points along a profile
_LEAST_TRACE = 64  # points of a profile
_OVERLAP = 1.5  # times the whole of x, which traces one below the other are together
# share of points at an x (or place) that came before, and of the rms height by which
# they may be apart, up to which they are the same place measured again
_MOST_AGAIN, _MOST_APART = 0.01, 0.1
# end what is said of dropouts
_CODES = (9.999, 9.9999, 9.99999, 3.2768, 3.2767)  # digits of -9999, 99999, -32768, ...
# of the range of all other heights, that such a code is away from them, be it there but
# once
_USUAL = 0.2
_MOST_CODES = 0.25  # share of codes above which too little was measured,
_MOST_SPIKES = 0.02  # and that of spikes
# different heights beside a code: with fewer, a far one may be the bottom of a groove
_FEWEST_LEVELS = 16
# share of the places, and times as often as any other height, from which the end of a
# type is a code though not far away; and the share from which any lowest one may be
_FREQUENT, _OFTEN, _FLOOR = 0.001, 5, 0.005
_TYPE_ENDS = (-(2**15), 2**15 - 1, 2**16 - 1, -(2**31), 2**31 - 1, 2**32 - 1)
_SPIKE_WIDTH = 3  # points of the widest spike
_COMMON_SHARE = 0.9  # of all differences over that width, which are below a scale
# times that scale, above which a spike is none of the surface: 20 standard deviations
# of Gaussian heights
_SPIKE = 12.0

Path_ = str | os.PathLike[str]
PixelSize = float | tuple[float, float] | None


@in_si
@typed_as("heights", "path_or_heights")
@typed_as("path", "path_or_heights")
def read_surface(
    path_or_heights: Path_ | Heights | Sequence[Path_ | Heights],
    *,
    pixel_size: PixelSize | Sequence[PixelSize] = None,
    unit: str | Sequence[str] | None = None,
    columns: Sequence[int | str] | None = None,
    shortest: float | None = None,
    detrend: bool = True,
) -> MeasuredSurface:
    """The isotropic spectrum of a measured profile or map, or of several scans of the
    same surface.

    A text file (.csv, .tsv, .txt, .dat) holds a profile in two columns, x and height,
    or a map in three, x, y and height, with titles such as "x [mm], height [um]". With
    `pixel_size` it holds heights only: one column for a profile, a matrix for a map.
    Cells that are empty or no number are holes. Traces one below the other, where x
    starts again, are scans. What is no such table, and every other file, is read by
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
        unit: unit of the lengths in a file that names none, such as "um", or one for
            each of its columns.
        columns: the columns of a table by number from 1 or by title, where it has more:
            x and height, or x, y and height.
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
    units: list[Any] = list(unit) if isinstance(unit, (list, tuple)) else [unit]
    for one in units if unit is not None else []:
        if not (isinstance(one, str) and to_si(one, "length")):
            raise InputError(
                argument="unit",
                got=unit,
                accepted=f"a unit of length such as {usual('length')}, or one for "
                "each column",
            )
    if columns is not None and not isinstance(columns, (list, tuple)):
        raise InputError(
            argument="columns",
            got=columns,
            accepted="a list of numbers from 1 or of titles",
        )
    layout = _Layout(units, None if columns is None else list(columns))
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
            argument="pixel_size",
            got=pixel_size,
            accepted=f"one, or a list of one for each of the {len(sources)} scans",
        )
    scans = [
        scan
        for source, size in zip(sources, sizes, strict=True)
        for scan in _scans(source, size, layout)
    ]
    paths = [
        Path(source).name
        for source in sources
        if isinstance(source, (str, os.PathLike))
    ]
    for warning in dict.fromkeys(
        warning for scan in scans for warning in scan.dropouts
    ):
        warn(f"{', '.join(paths) or 'heights'}: {warning}.", FitWarning)
    try:
        return surface(scans, shortest, detrend)
    except InputError as error:
        if paths:
            error.inside(", ".join(map(repr, paths)))
        raise


class _Layout(NamedTuple):
    """What the user says of the columns of a table."""

    units: Sequence[str | None]  # one for all, or one for each
    columns: list[int | str] | None

    def unit(self, place: int, count: int) -> str | None:
        """The unit given for one of `count` columns."""
        if len(self.units) not in (1, count):
            raise InputError(
                argument="unit",
                got=list(self.units),
                accepted=f"one unit, or one for each of the {count} columns",
            )
        return self.units[place if len(self.units) > 1 else 0]


def _scans(source: Any, pixel_size: Any, layout: _Layout) -> list[Scan]:
    if isinstance(source, (str, os.PathLike)):
        path = Path(source)
        try:
            if path.suffix.lower() not in _TEXT:
                return [_from_instrument(path, pixel_size, layout)]
            return _from_text(path, pixel_size, layout)
        except InputError as error:
            if error.argument == "path" and error.got is None:
                error.got = source
            else:
                error.inside(repr(path.name))
            raise
    if layout != _Layout([None], None):
        raise InputError(
            argument="columns" if layout.columns else "unit",
            got=layout.columns or layout.units,
            accepted="left out for heights of an array, which are in metres",
        )
    try:
        is_complex = np.iscomplexobj(source)
        numbers = np.float64 if not is_complex else np.complex128
        height = np.ma.filled(np.ma.asarray(source, dtype=numbers), np.nan)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            argument="path_or_heights",
            got=source,
            accepted="a path, heights [m] or a list of these",
        ) from error
    if is_complex:
        raise InputError(
            argument="path_or_heights", got=source, accepted="real numbers [m]"
        )
    if height.ndim not in (1, 2):
        raise InputError(
            argument="path_or_heights",
            got=source,
            accepted="heights of the shape (n,) or (n_x, n_y)",
        )
    return [_even(height, pixel_size, "heights")]


def _even(
    height: np.ndarray, pixel_size: Any, source_words: str, report: Sequence[str] = ()
) -> Scan:
    """Heights [m] whose points are `pixel_size` [m] apart."""
    if pixel_size is None:
        raise InputError(
            argument="pixel_size",
            got=None,
            accepted=f"given with {source_words}: the distance of neighbouring points "
            "[m]",
        )
    untraced(
        InputError(
            argument="pixel_size", accepted="plain numbers: a scan is read as numbers"
        ),
        pixel_size,
    )
    sizes = np.atleast_1d(as_float64("pixel_size", pixel_size)).tolist()
    positive("pixel_size", sizes)
    if len(sizes) not in (1, height.ndim) or np.ndim(sizes) > 1:
        raise InputError(
            argument="pixel_size",
            got=pixel_size,
            accepted="one number [m] or one for each direction",
        )
    _below(height, source_words)
    height, dropouts = without_dropouts(height)
    return Scan(
        height,
        tuple(sizes * height.ndim if len(sizes) == 1 else sizes),
        (*report, *dropouts),
        dropouts=dropouts,
    )


def _below(lengths: np.ndarray, source_words: str) -> None:
    known = np.abs(lengths[np.isfinite(lengths)])
    if known.size and not known.max() < _LARGEST:
        raise InputError(
            argument="path",
            got=float(known.max()),
            accepted=f"of lengths below {_LARGEST:g} m in its {source_words}",
        )


def _from_text(path: Path, pixel_size: Any, layout: _Layout) -> list[Scan]:
    try:
        table = main_table(read_sheet(path), 2 if pixel_size is None else 1)
    except InputError:
        table = None
        if not os.path.isfile(path):  # False also of what is no name
            raise
    heads = [] if table is None else table.heads
    if table is not None and layout.columns is not None:
        heads = named_heads(layout.columns, table)
    if table is None or (pixel_size is None and len(heads) not in (2, 3)):
        titled = table is not None and any(head.title for head in table.heads)
        if _can_read_instruments() and not titled:
            with contextlib.suppress(InputError):
                return [_from_instrument(path, pixel_size, layout)]
        found = f"it has {len(heads)}" if table else "it has no row of two numbers"
        raise InputError(
            argument="path",
            accepted="a table with two columns (x, height) or three (x, y, height)",
            hint=f"{found}; columns=[N, M] selects some, and a matrix of heights "
            "needs pixel_size",
        )
    refuse_ragged(table)
    data = np.stack(
        [
            table.column(head.place)
            * _metres(head, layout.unit(i, len(heads)), path.name)
            for i, head in enumerate(heads)
        ],
        axis=1,
    )
    if pixel_size is not None:
        heights = data[:, 0] if data.shape[1] == 1 else data
        return [_even(heights, pixel_size, "heights")]
    _below(data, "columns")
    return _profiles(data[:, 0], data[:, 1]) if len(heads) == 2 else [_grid(data)]


def _can_read_instruments() -> bool:
    return importlib.util.find_spec("SurfaceTopography") is not None


def _from_instrument(path: Path, pixel_size: Any, layout: _Layout) -> Scan:
    if not _can_read_instruments():
        raise InputError(
            argument="path",
            accepted="a table of heights (.csv, .tsv, .txt, .dat)",
            hint="files of instruments are read with SurfaceTopography, which is not "
            "installed: pip install elastomdr[instruments]",
        )
    bytes_of(path)
    printed = run_reader("instrument", path, _PATIENCE, "a file of an instrument")
    with np.load(io.BytesIO(printed)) as read:
        x, y, height, unit, sized = _Instrument(**read)
    given = str(unit) or layout.unit(0, 1)
    if given is None:
        raise InputError(
            argument="unit",
            got=None,
            accepted=f"given, since {path.name!r} says nothing of its unit",
        )
    metres = _length(given, path.name)
    if sized and pixel_size is not None:
        raise InputError(
            argument="pixel_size",
            got=pixel_size,
            accepted=f"left out, since {path.name!r} has its own",
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


class _Instrument(NamedTuple):
    """What the reader of instruments prints."""

    x: np.ndarray
    y: np.ndarray  # empty of a profile
    height: np.ndarray
    unit: np.ndarray
    sized: np.ndarray  # whether the file says the size, or x and y count points


def _profiles(x: np.ndarray, height: np.ndarray) -> list[Scan]:
    """The traces of a table, one below the other where x starts again or turns."""
    along = np.sign(np.diff(x))
    moved = np.maximum.accumulate(np.where(along != 0, np.arange(along.size), 0))
    along = along[moved]  # a place that is measured twice is no turn
    turns = np.flatnonzero(along[1:] * along[:-1] < 0) + 1
    edges = np.concatenate([[0], turns, [along.size]])
    # a single step against the others leads back to the start of x
    traces = [
        slice(first, last + 1)
        for first, last in itertools.pairwise(edges)
        if last - first > 1
    ]
    spans = [np.ptp(x[trace]) for trace in traces]
    if (
        len(traces) < 2
        or min(trace.stop - trace.start for trace in traces) < _LEAST_TRACE
        or sum(spans) < _OVERLAP * np.ptp(x)
    ):
        return [_profile(x, height)]
    scans = [_profile(x[trace], height[trace].copy()) for trace in traces]
    said = f"x starts again: read as {len(scans)} traces of one surface"
    return [scans[0]._replace(report=(said, *scans[0].report)), *scans[1:]]


def _means(
    place: np.ndarray, height: np.ndarray, size: int, words: str, report: list[str]
) -> np.ndarray:
    """The mean height at each of `size` places, NaN where there is none. Raises
    `InputError` where many places come again with other heights.
    """
    count = np.bincount(place, minlength=size)
    mean = np.bincount(place, height, minlength=size) / np.where(count, count, np.nan)
    again = height.size - np.count_nonzero(count)
    apart = float(np.std(height - mean[place])) if again else 0.0
    if again > _MOST_AGAIN * height.size and apart > _MOST_APART * np.std(height):
        raise InputError(
            argument="path",
            got=again,
            accepted="a scan without other heights at places that came before",
            hint=f"{again} of {height.size} points are at {words} that came before, "
            f"{apart:.3g} m (rms) from their mean: give several scans one by "
            "one, as a list",
        )
    if again:
        report.append(f"{again} points at {words} that came before: heights averaged")
    return mean


def _profile(x: np.ndarray, height: np.ndarray) -> Scan:
    """An even profile from points in any order."""
    order = np.argsort(x, kind="stable")
    measured, dropouts = without_dropouts(height[order])
    height[order], report = measured, list(dropouts)
    known = np.isfinite(x) & np.isfinite(height)
    if not known.all():
        report.append(
            f"{int((~known).sum())} of {known.size} points without a value "
            "bridged by "
            "straight lines"
        )
    x, height = x[known], height[known]
    x, place = np.unique(x, return_inverse=True)
    if x.size < _LEAST_TRACE:
        raise InputError(
            argument="path",
            got=int(x.size),
            accepted=f"a profile of {_LEAST_TRACE} points or more at different x",
        )
    height = _means(place, height, x.size, "an x", report)
    n = round(float((x[-1] - x[0]) / np.median(np.diff(x)))) + 1
    if n > _MOST:
        raise InputError(
            argument="path",
            got=n,
            accepted=f"a profile of {_MOST:.0e} of its median steps at most",
            hint="is one of the values of x mistyped?",
        )
    even = np.linspace(x[0], x[-1], n)
    if n != x.size or np.abs(x - even).max() > _EVEN * (even[1] - even[0]):
        report.append(f"x was not evenly spaced: {n} even points by straight lines")
        height = np.interp(even, x, height)
    return Scan(height, (float(even[1] - even[0]),), tuple(report), dropouts=dropouts)


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
            argument="path",
            got=(int(x.size), int(y.size)),
            accepted="a map on a grid of 16 by 16 points or more",
        )
    for axis, values in (("x", x), ("y", y)):
        if np.ptp(np.diff(values)) > 1e-3 * np.diff(values).mean():
            raise InputError(
                argument="path", got=axis, accepted="a map that is evenly spaced"
            )
    place, known = i * y.size + j, np.isfinite(data[:, 2])
    height = _means(place[known], data[known, 2], x.size * y.size, "a place", report)
    steps = tuple(float((axis[-1] - axis[0]) / (axis.size - 1)) for axis in (x, y))
    grid, dropouts = without_dropouts(height.reshape(x.size, y.size))
    return Scan(grid, steps, (*report, *dropouts), dropouts=dropouts)


def _metres(head: Head, unit: str | None, name: str) -> float:
    """The length of one unit of a column [m]."""
    given = titled_unit(head, "length")[1] or unit
    if given is None:
        raise InputError(
            argument="unit",
            got=None,
            accepted='given, such as "um", or said by titles such as "x [mm], height '
            '[um]"',
            hint=f"column {head.words} of {name!r} has no unit of length",
        )
    return _length(given, name)


def _length(unit: str, name: str) -> float:
    si = to_si(unit, "length")
    if si is None:
        raise InputError(
            argument="path",
            got=unit,
            accepted=f"with a unit of length such as {usual('length')}",
            hint=f"that of {name!r} is none",
        )
    return si[0]


def without_dropouts(height: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Heights of a profile or map with NaN in place of dropouts, and what was left out
    in words.

    Raises `InputError` where more than a quarter are codes, or more than 2 % spikes.
    """
    codes: dict[float, int] = {}
    left = np.where(np.isfinite(height), height, np.nan)
    _take_codes(left, codes)
    largest = _take_spikes(left)
    if largest:
        # beside a spike that is further away a code is not the furthest
        _take_codes(left, codes)
    words = _floor(left)
    lost, coded = int((np.isfinite(height) & np.isnan(left)).sum()), sum(codes.values())
    if codes:
        values = " and ".join(
            f"{count} times {value:.6g} m" for value, count in codes.items()
        )
        if coded > _MOST_CODES * height.size:
            raise InputError(
                argument="path",
                got=coded,
                accepted="of heights measured at three quarters of the points or more",
                hint=f"of {height.size} points {coded} are dropouts, {values}: "
                "measure again, or cut that part away",
            )
        words.append(
            f"{coded} of {height.size} points are dropouts, {values}: left out, and "
            "bridged"
        )
    if lost > coded:
        if lost - coded > _MOST_SPIKES * height.size:
            raise InputError(
                argument="path",
                got=lost - coded,
                accepted=f"free of spikes at {1 - _MOST_SPIKES:.0%} of the points or "
                "more",
                hint=f"of {height.size} points {lost - coded} are spikes, by up to "
                f"{largest:.3g} m beyond their neighbours: filter them, or "
                "measure again",
            )
        words.append(
            f"{lost - coded} of {height.size} points are spikes, by up to "
            f"{largest:.3g} m beyond what their neighbours allow: left out, and bridged"
        )
    return left, words


def _floor(height: np.ndarray) -> list[str]:
    """What there is to say of a lowest height that is there often, bit for bit, where
    its neighbours are no flanks of a flat: it may be a code that is next to the others.
    """
    levels, often = np.unique(height[np.isfinite(height)], return_counts=True)
    if levels.size < _FEWEST_LEVELS or often[0] < max(
        _FLOOR * height.size, _OFTEN * often[1:].max()
    ):
        return []
    from scipy.ndimage import binary_dilation

    beside = height[binary_dilation(height == levels[0]) & (height > levels[0])]
    usual = max(_usual_difference(height, axis) for axis in range(height.ndim))
    if not beside.size or not np.median(beside) - levels[0] > usual:
        return []
    return [
        f"the lowest height, {levels[0]:.6g} m, is there {often[0]} times: where it "
        "stands for no value, remove it"
    ]


def _take_codes(height: np.ndarray, codes: dict[float, int]) -> None:
    """Puts NaN in place of codes, and how often each was there into `codes`.

    A code is the lowest or the highest value, is there twice or more, bit for bit, and
    is further from all other heights than these are from each other; those in use may
    be there once, and a fifth as far. One that is in use, or the end of a type of whole
    numbers, may be next to the others if it is at a thousandth of the places and five
    times as often as any other.
    """
    while True:
        value, count = _code(height[np.isfinite(height)])
        if not count:
            return
        codes[value] = count
        height[height == value] = np.nan


def _code(height: np.ndarray) -> tuple[float, int]:
    """The code among heights, and how often it is there; (0, 0) where there is none."""
    for value in (height.min(), height.max()) if height.size else ():
        rest = height[height != value]
        count = height.size - rest.size
        usual = _is_usual_code(value)
        if (count < 2 and not usual) or not rest.size:
            continue
        far = np.abs(rest - value).min() > np.ptp(rest) * (_USUAL if usual else 1.0)
        if not far and count < _FREQUENT * height.size:
            continue
        levels, often = np.unique(rest, return_counts=True)
        frequent = count >= max(_FREQUENT * height.size, _OFTEN * often.max())
        if levels.size >= _FEWEST_LEVELS and (
            far or (frequent and (usual or _ends_type(value, levels)))
        ):
            return float(value), count
    return 0.0, 0


def _is_usual_code(value: float) -> bool:
    """Whether a height is a code that is in use, in whatever unit of ten."""
    digits = abs(value) / 10.0 ** np.floor(np.log10(abs(value))) if value else 0.0
    return bool(np.isclose(digits, _CODES, rtol=1e-6, atol=0).any())


def _ends_type(value: float, levels: np.ndarray) -> bool:
    """Whether a height is the first or the last whole number of a type, in steps
    between heights.
    """
    step = np.diff(levels).min()
    counts = value / step
    return any(abs(counts / end - 1) < 1e-6 for end in _TYPE_ENDS)


def _take_spikes(height: np.ndarray) -> float:
    """Puts NaN in place of spikes; returns how far the largest stood out, 0 where there
    is none.

    A spike is up to three points wide (in both directions of a map: scratches and edges
    stay) and stands out from the points on either side by twelve times the difference
    that nine tenths of all points three apart are below.
    """
    outstanding = np.minimum.reduce(
        [_outstanding(height, axis) for axis in range(height.ndim)]
    )
    scale = max(_usual_difference(height, axis) for axis in range(height.ndim))
    spikes = outstanding > _SPIKE * scale
    if not scale or not spikes.any():
        return 0.0
    height[spikes] = np.nan
    return float(outstanding[spikes].max())


def _outstanding(height: np.ndarray, axis: int) -> np.ndarray:
    """How far each point is above (or below) what is within three points on either side
    of it, by the nearer side.
    """
    return np.nan_to_num(np.fmax(_above(height, axis), _above(-height, axis)))


def _above(height: np.ndarray, axis: int) -> np.ndarray:
    """How far each point is above the lowest of three on either side, by the nearer
    side; NaN where there is none.
    """
    from scipy.ndimage import minimum_filter

    known = np.where(np.isnan(height), np.inf, height)
    behind = np.arange(2 * _SPIKE_WIDTH + 1) > _SPIKE_WIDTH
    sides = []
    for side in (behind, behind[::-1]):
        footprint = np.expand_dims(side, [i for i in range(height.ndim) if i != axis])
        lowest = minimum_filter(
            known, footprint=footprint, mode="constant", cval=np.inf
        )
        sides.append(height - np.where(np.isinf(lowest), np.nan, lowest))
    return np.fmin(*sides)


def _usual_difference(height: np.ndarray, axis: int) -> float:
    """What nine tenths of the differences between points three apart are below."""
    along = np.moveaxis(height, axis, 0)
    apart = np.abs(along[_SPIKE_WIDTH:] - along[:-_SPIKE_WIDTH])
    apart = apart[np.isfinite(apart)]
    return float(np.quantile(apart, _COMMON_SHARE)) if apart.size else 0.0
