"""Measured profiles and maps: put in order, detrended, windowed, and turned into an isotropic spectrum.

With a Hann window w, <w^2> = 1, and heights h about their straight line or plane,

    C_cut(q) = L/(2 pi) |a_q|^2,   C(q) = L_x L_y/(4 pi^2) |a_q|^2,   a_q = (1/n) sum w h exp(-i q x),

averaged over bands of even width in log q. A profile's C_cut is made to fall with q and turned into the C of an
isotropic surface (`mapping.spectrum`); C is then scaled to the measured rms height. What had to be mended stands in
`report`. A table of a spectrum is put in order and cut to its cutoffs, and not changed otherwise.
"""

from collections.abc import Sequence
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Float

from ..errors import InputError
from .spectrum import AbstractSpectrum, Spectrum

_BANDS = 10  # per decade of q
_EVEN = 1e-4  # unevenness of x, relative to its step, that counts as rounding
_MOST = 4_000_000  # even points along a profile
_SAME = 1e-9  # relative distance of two wave numbers that count as one
_APART = 10  # times more or less than the neighbours say: reported
_SLOPES = (1e-3, 3.0)  # rms slopes beyond which a table is doubted: of polished surfaces and of the roughest roads
_COARSE = 64  # different heights, or fewer, that count as coarsely rounded
_HOLLOW = 0.05  # share of holes in a map from which their smoothness is mentioned
_PASSES = 30  # over the points of holes, at each of the sizes


class MeasuredSurface(AbstractSpectrum):
    """A measured surface by its spectrum, with what was found and mended in the data."""

    q: Float[np.ndarray, " n"]
    c: Float[np.ndarray, " n"]
    measured_height: float = eqx.field(static=True)  # rms of the data about the straight line or plane [m]
    report: tuple[str, ...] = eqx.field(static=True)
    label: ClassVar[str] = "measured surface"

    def __repr__(self) -> str:
        return f"MeasuredSurface({self.words()}; {'; '.join(self.report) or 'nothing to report'})"


class MeasuredSpectrum(AbstractSpectrum):
    """A surface by a spectrum that was read from a file, with what was found and mended in the table."""

    q: Float[np.ndarray, " n"]
    c: Float[np.ndarray, " n"]
    convention: str = eqx.field(static=True)  # of the table; c is normalised by <h^2> = int C d^2q, whatever it is
    report: tuple[str, ...] = eqx.field(static=True)
    label: ClassVar[str] = "surface by its measured spectrum"

    def __repr__(self) -> str:
        return f"MeasuredSpectrum({self.words()}; {'; '.join(self.report) or 'nothing to report'})"


def from_spectrum(
    q: np.ndarray, c: np.ndarray, convention: str, low: float | None, high: float | None
) -> MeasuredSpectrum:
    """A surface from a table of q [rad/m] and C in any order, cut to the cutoffs `low` and `high` [rad/m] if given."""
    report: list[str] = []
    if (np.diff(q) < 0).any():
        # A table of wavelengths runs the other way round, which needs no mention.
        if (np.diff(q) > 0).any():
            report.append("wave numbers were not in order: sorted")
        order = np.argsort(q, kind="stable")
        q, c = q[order], c[order]
    group = np.concatenate([[0], np.cumsum(np.diff(q) > _SAME * q[1:])])
    if group[-1] + 1 < q.size:
        logs, starts = np.log10(c), np.flatnonzero(np.diff(group, prepend=-1))
        spread = float((np.maximum.reduceat(logs, starts) - np.minimum.reduceat(logs, starts)).max())
        report.append(
            f"{q.size - group[-1] - 1} points at a wave number that came before, with values up to a factor of "
            f"{10**spread:.3g} apart: averaged"
        )
        q, c = (np.bincount(group, values) / np.bincount(group) for values in (q, c))
    between = _neighbours(q, c)
    off = np.abs(np.log(c[1:-1]) - between)
    if (off > np.log(_APART)).any():
        at = int(off.argmax()) + 1
        report.append(
            f"C = {c[at]:.3g} at q = {q[at]:.4g} rad/m is {c[at] / np.exp(between[at - 1]):.2g} times what its "
            f"neighbours let expect: is it mistyped? ({int((off > np.log(_APART)).sum())} points "
            "are off, or beside such)"
        )
    whole = Spectrum(q, c, convention=convention)
    if low is not None or high is not None:
        first, last = whole.q_low if low is None else low, whole.q_high if high is None else high
        if not whole.q_low * (1 - 1e-9) <= first < last <= whole.q_high * (1 + 1e-9):
            raise InputError(
                f"longest and shortest must be wavelengths within the table, {2 * np.pi / whole.q_low:.4g} to "
                f"{2 * np.pi / whole.q_high:.4g} m, got {2 * np.pi / first:.4g} and {2 * np.pi / last:.4g} m."
            )
        first, last = max(first, whole.q_low), min(last, whole.q_high)
        kept = np.concatenate([[first], whole.q[(whole.q > first) & (whole.q < last)], [last]])
        share = whole.moment(3, first, last) / whole.moment(3)
        report.append(f"cut to wavelengths of {2 * np.pi / first:.4g} to {2 * np.pi / last:.4g} m, which keeps "
                      f"{share**0.5:.2g} of the rms slope")  # fmt: skip
        whole = Spectrum(kept, whole.at(kept), convention="2d")
    slope = whole.rms_slope
    if not _SLOPES[0] <= slope <= _SLOPES[1]:
        report.append(f"an rms slope of {slope:.3g} is unlike a real surface's, {_SLOPES[0]:g} to {_SLOPES[1]:g}: are "
                      "units, convention and cutoffs right?")  # fmt: skip
    return _filled(MeasuredSpectrum, q=whole.q, c=whole.c, convention=convention, report=tuple(report))


def _neighbours(q: np.ndarray, c: np.ndarray) -> np.ndarray:
    """ln C at all points but the ends, from the points on either side of each."""
    x, y = np.log(q), np.log(c)
    share = (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
    return y[:-2] + share * (y[2:] - y[:-2])


def from_profile(x: np.ndarray, height: np.ndarray, shortest: float | None, detrend: bool) -> MeasuredSurface:
    """A surface from a profile; `shortest` [m] cuts the spectrum, the least it can be is two steps of x."""
    report: list[str] = []
    known = np.isfinite(x) & np.isfinite(height)
    if not known.all():
        report.append(f"{int((~known).sum())} of {known.size} points without a value bridged by straight lines")
    x, height = x[known], height[known]
    if (np.diff(x) < 0).any():
        report.append("x was not ascending: sorted")
    x, place = np.unique(x, return_inverse=True)
    if x.size < place.size:
        report.append(f"{place.size - x.size} points at an x that came before: heights averaged")
    height = np.bincount(place, height) / np.bincount(place)
    if x.size < 64:
        raise InputError(f"a profile must have 64 points or more at different x, got {x.size}.")
    report += _coarse(height)
    n = round(float((x[-1] - x[0]) / np.median(np.diff(x)))) + 1
    if n > _MOST:
        raise InputError(
            f"x of a profile spans {n:.3g} of its median steps, more than {_MOST:.0e}: is one of the values mistyped?"
        )
    even = np.linspace(x[0], x[-1], n)
    if n != x.size or np.abs(x - even).max() > _EVEN * (even[1] - even[0]):
        report.append(f"x was not evenly spaced: {n} even points by straight lines")
    height = np.interp(even, x, height)
    height = height - (np.polyval(np.polyfit(even, height, 1), even) if detrend else height.mean())
    window = np.hanning(n) * np.sqrt(8 / 3)
    length = n * (even[1] - even[0])
    power = length / (2 * np.pi) * np.abs(np.fft.rfft(window * height) / n) ** 2
    q = 2 * np.pi / length * np.arange(power.size)
    q, cut = _bands(q[2:], power[2:], _cut(shortest, even[1] - even[0]))  # a Hann window mixes the first two waves
    falling = np.sqrt(np.minimum.accumulate(cut) * np.maximum.accumulate(cut[::-1])[::-1])
    if (np.abs(falling / cut - 1) > 0.3).any():
        report.append("its spectrum does not fall everywhere, as that of a cut of an isotropic surface must: smoothed")
    found = Spectrum(q, falling * (q / q[0]) ** -1e-3, convention="1d")
    return _scaled(found, float(height.std()), report)


def from_map(
    x: np.ndarray, y: np.ndarray, height: np.ndarray, shortest: float | None, detrend: bool, mended: Sequence[str] = ()
) -> MeasuredSurface:
    """A surface from heights (len(x), len(y)) on an even grid; `mended`: what was done to them before."""
    missing = ~np.isfinite(height)
    if missing.all():
        raise InputError("a map must have heights, got none that is a number.")
    report = [*mended, *_coarse(height[~missing])]
    if missing.any():
        share = float(missing.mean())
        low = f"; they hold no short waves: the rms slope is low by about {share / 2:.0%}" if share > _HOLLOW else ""
        report.append(f"{int(missing.sum())} of {missing.size} points without a value bridged smoothly{low}")
        height = _bridged(height)
    flat = np.stack([np.ones(height.size), *(a.ravel() for a in np.meshgrid(x, y, indexing="ij"))], axis=1)
    if detrend:
        height = height - (flat @ np.linalg.lstsq(flat, height.ravel(), rcond=None)[0]).reshape(height.shape)
    height = height - height.mean()
    dx, dy = float(x[1] - x[0]), float(y[1] - y[0])
    window = np.hanning(x.size)[:, None] * np.hanning(y.size) * 8 / 3
    area = x.size * dx * y.size * dy
    power = area / (4 * np.pi**2) * np.abs(np.fft.fft2(window * height) / height.size) ** 2
    q = np.hypot(*np.meshgrid(*(2 * np.pi * np.fft.fftfreq(a.size, d) for a, d in ((x, dx), (y, dy))), indexing="ij"))
    first = 4 * np.pi / min(x.size * dx, y.size * dy)
    keep = q >= 0.999 * first
    q, c = _bands(q[keep], power[keep], _cut(shortest, max(dx, dy)))
    return _scaled(Spectrum(q, c, convention="2d"), float(height.std()), report)


def _coarse(height: np.ndarray) -> list[str]:
    """What there is to say of heights that take few values."""
    levels = np.unique(height)
    if levels.size > _COARSE:
        return []
    step = float(np.diff(levels).min()) if levels.size > 1 else 0.0
    return [f"heights are coarsely rounded: {levels.size} levels, {step:.3g} m apart; short waves are rounding noise"]


def _bridged(height: np.ndarray) -> np.ndarray:
    """A map with its holes filled as by a membrane: each point there is about the mean of its four neighbours.

    From a map of half the points, bridged in the same way, so that a hole of any size needs few passes.
    """
    missing = ~np.isfinite(height)
    if not missing.any():
        return height
    padded = np.pad(height, [(0, n % 2) for n in height.shape], constant_values=np.nan)
    blocks = padded.reshape(padded.shape[0] // 2, 2, padded.shape[1] // 2, 2)
    count = np.isfinite(blocks).sum(axis=(1, 3))
    coarse = np.where(count > 0, np.nansum(blocks, axis=(1, 3)) / np.maximum(count, 1), np.nan)
    coarse = _bridged(coarse)
    for axis in (0, 1):  # between the middles of the blocks, by straight lines
        at = np.clip((np.arange(2 * coarse.shape[axis]) - 0.5) / 2, 0, coarse.shape[axis] - 1)
        low = np.minimum(at.astype(int), max(coarse.shape[axis] - 2, 0))
        high = np.minimum(low + 1, coarse.shape[axis] - 1)
        share = np.expand_dims(at - low, 1 - axis)
        coarse = np.take(coarse, low, axis) * (1 - share) + np.take(coarse, high, axis) * share
    filled = np.where(missing, coarse[: height.shape[0], : height.shape[1]], height)
    i, j = np.nonzero(missing)
    last_i, last_j = height.shape[0] - 1, height.shape[1] - 1
    around = [(np.clip(i + a, 0, last_i), np.clip(j + b, 0, last_j)) for a, b in ((-1, 0), (1, 0), (0, -1), (0, 1))]
    for _ in range(_PASSES):
        filled[i, j] = sum(filled[at] for at in around) / 4
    return filled


def _cut(shortest: float | None, step: float) -> float:
    least = 2 * step
    if shortest is None:
        return 2 * np.pi / least
    if shortest < least:
        raise InputError(f"shortest must be two steps of the data or more, {least:.4g} m, got {shortest:.4g} m.")
    return 2 * np.pi / shortest


def _bands(q: np.ndarray, power: np.ndarray, highest: float) -> tuple[np.ndarray, np.ndarray]:
    low = q.min()
    if highest < 2 * low:
        raise InputError(f"the data are too short for a spectrum from {low:.4g} to {highest:.4g} rad/m.")
    edges = np.geomspace(low * 0.999, highest * 1.001, max(3, round(_BANDS * np.log10(highest / low)) + 1))
    band = np.digitize(q, edges) - 1
    inside = (band >= 0) & (band < edges.size - 1)
    count, total = (np.bincount(band[inside], w, edges.size - 1) for w in (None, power[inside]))
    middle = np.bincount(band[inside], np.log(q[inside]), edges.size - 1)
    used = (count > 0) & (total > 0)
    return np.exp(middle[used] / count[used]), total[used] / count[used]


def _scaled(found: Spectrum, measured: float, report: list[str]) -> MeasuredSurface:
    if not measured > 0:
        raise InputError("the heights must differ, got a flat surface.")
    factor = (measured / found.rms_height) ** 2
    return _filled(MeasuredSurface, q=found.q, c=found.c * factor, measured_height=measured, report=tuple(report))


def _filled(kind: type, **fields: Any) -> Any:
    made = object.__new__(kind)
    for name, value in fields.items():
        object.__setattr__(made, name, value)
    return made
