"""The spectrum C(q) of measured heights, averaged over directions.

With a Hann window w, <w^2> = 1, and heights h about their straight line or plane, the
periodogram of a profile and of a map is

    P(k) = L/(2 pi) |a_k|^2,    P(k) = L_x L_y/(4 pi^2) |a_k|^2,    a_k = (1/n) sum w h exp(-i k x).

C is a power law between nodes, ten per decade. It is the maximum of the likelihood of
P, whose waves are exponentially distributed about their expectation E (Whittle 1953),
and of a prior that bends ln C by 0.5 from node to node:

    sum N (ln E + P/E) + sum (d^2 ln C)^2/(2 0.5^2).

E is C(|k|) for a map and 2 int_0^inf C(sqrt(k^2 + l^2)) dl for a profile, both smeared
by the window. N is the number of independent waves. Nothing is scaled to the rms height
of the data. Several scans add their likelihoods.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..arrays import xp
from ..checks import is_traced, scalar
from ..errors import InputError, ModelWarning, amount, warn
from ..material.validity import Draws
from ..trees import static
from .height_map import HeightMap, top_slopes
from .lay import Lay, Periodogram, measured_lay
from .spectrum import AbstractSpectrum, Spectrum

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import Convention, Number, Scalar


_NODES = 10  # per decade of q
_FINE = 40  # bands per decade in which waves are averaged
_BEND = 0.5  # of ln C from node to node, standard deviation of the prior
# nodes after the last wave used: they carry what a profile's cut has of shorter waves
_BEYOND = 10
# lowest wave used, in waves per length of the scan: window and plane hide longer ones
_FIRST = 2.0
# steps in the shortest wave used; aliasing and the averaging over a pixel change C by
# less than 15 %
_STEPS = 4.0
# share of waves that are independent under a Hann window, <w^2>^2/<w^4>, along each
# direction
_INDEPENDENT = 18 / 35
# |window|^2 in waves per length, and its weights
_TAPS, _SMEAR = np.array([-1, 0, 1]), np.array([1, 4, 1]) / 6
# exponent of C above which the shortest octave is taken for noise; aliasing gives -1.9
# at H = 0.5
_WHITE = -1.85
_NOISE = 8.0  # C over the noise that is kept
_REST = 1e-4  # share of the mean square slope that is left where a spectrum ends
# Peklenik number from which there is a Python warning; skewness likewise, and how many
# of its standard errors it must be
_UNEQUAL = 1.2
_SKEWED, _CERTAIN = 0.3, 2.5
# standard deviations beyond which a height is an outlier, and share of the points up to
# which such are left out of skewness and kurtosis
_FAR, _FEW = 6.0, 1e-3
_ALIKE = 1.25  # ratio of the lowest wave numbers of scans that begin alike
_COARSE = 64  # different heights, or fewer, that count as coarsely rounded
_HOLE = 5  # points across a hole from which on its bridge holds no short waves
_HOLLOW = 0.05  # share of such holes from which they are mentioned
_PASSES = 30  # over the points of holes, at each of the sizes
# standard errors of a skewness that its bound holds, see benchmarks/blind_maps.py
_ERRORS = 1.5
_FADE = 0.3  # about its end in which a spectrum's waves fade out of the tops
_LEAST = {1: 64, 2: 16}  # points along each direction

_SAME = 1e-9  # relative distance of two wave numbers that count as one
# rms slopes beyond which units are doubted: of polished surfaces and of the roughest
# roads; and lengths of a profile and of a map likewise [m]
_LONGEST = {1: 1e4, 2: 10.0}
_SLOPES = (1e-3, 3.0)


_NO_SHORTEST = (
    "no `shortest` is given: waves are kept as the data have them. Friction grows with "
    "each shorter wave: give the shortest that the rubber follows, usually some "
    "micrometres"
)


class Scan(NamedTuple):
    """Heights on an even grid."""

    height: np.ndarray  # (n,) or (n_x, n_y), NaN in holes [m]
    steps: tuple[float, ...]  # distance of neighbours along each direction [m]
    report: tuple[str, ...] = ()  # what was mended before
    # where holes are too large to hold short waves when they are bridged
    holes: np.ndarray | None = None
    dropouts: Sequence[str] = ()  # what of the report is worth a warning


class _Waves(NamedTuple):
    """The periodogram of a scan: the half of its waves that determines the other."""

    k: tuple[np.ndarray, ...]  # components [rad/m]
    q: np.ndarray  # [rad/m]
    power: np.ndarray  # [m^3] or [m^4]
    copies: np.ndarray  # 2 for waves that stand for their opposite as well
    lowest: tuple[float, ...]  # 2 pi/length along each direction [rad/m]

    @property
    def dimensions(self) -> int:
        return len(self.k)

    @property
    def first(self) -> float:
        return _FIRST * max(self.lowest)

    def banded(
        self, low: float, high: float, density: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """q, mean power and number of independent waves in bands that hold any."""
        edges = np.geomspace(
            low * 0.999,
            high * 1.001,
            max(2, int(density * np.log10(high / low) + _SAME) + 1),
        )
        band = np.digitize(self.q, edges) - 1
        inside = (band >= 0) & (band < edges.size - 1)
        band, count = band[inside], self.copies[inside]
        sums = [
            np.bincount(band, count * values, edges.size - 1)
            for values in (1.0, np.log(self.q[inside]), self.power[inside])
        ]
        number, logs, power = (total[sums[0] > 0] for total in sums)
        return (
            np.exp(logs / number),
            power / number,
            number / 2 * _INDEPENDENT**self.dimensions,
        )


class _Limit(NamedTuple):
    """The highest wave number that a scan resolves [rad/m], and why it is that one."""

    q: float
    reason: str = ""
    noisy: bool = False  # whether waves beyond are noise


class _Part(NamedTuple):
    """A scan without holes and trend, and its share in the spectrum."""

    scan: Scan
    waves: _Waves
    limit: _Limit
    highest: float  # wave number that is used [rad/m]
    name: str  # how sentences about it begin, where there are several


class _Fit(NamedTuple):
    q: np.ndarray
    c: np.ndarray
    error: np.ndarray  # standard error of ln C


def _within(q: np.ndarray, low: float, high: float) -> np.ndarray:
    """Which wave numbers lie between two others, waves exactly at these included in any
    unit of length.
    """
    return (q >= low * (1 - _SAME)) & (q <= high * (1 + _SAME))


def surface(
    scans: Sequence[Scan], shortest: float | None, detrend: bool
) -> MeasuredSurface:
    """The measured surface of one scan or of several of the same surface.

    Args:
        scans: heights with their steps.
        shortest: shortest wavelength kept [m]; None: what the finest scan resolves.
        detrend: whether a straight line or plane is subtracted from each scan.

    Raises:
        InputError: where a scan is too small, flat, not in metres, or shorter than
            `shortest`.
    """
    parts = _parts([_mended(scan, detrend) for scan in scans], shortest)
    several = len(parts) > 1
    alone = [_fitted([part]) for part in parts]
    fit = _fitted(parts) if several else alone[0]
    doubts = _doubts_of_size(fit, parts)
    widest = min(parts, key=lambda part: part.waves.first)
    height = float(widest.scan.height.std())

    report = [part.name + said for part in parts for said in part.scan.report]
    report += [part.name + part.limit.reason for part in parts if part.limit.reason]
    report += doubts
    report += [_overlap(alone)] if several else []
    report.append(_heights(fit, height))
    asymmetry = [_asymmetry(part.scan, part.waves, part.highest) for part in parts]
    joined = _joined_asymmetry(parts) if several else asymmetry[0]
    report += [
        part.name + heights.words
        for part, heights in zip(parts, asymmetry, strict=True)
    ]
    report += [part.name + _slope(part) for part in parts]
    slope = _moment(fit, 3) ** 0.5
    report.append(f"rms slope {slope:.4g} in the spectrum")
    if several:
        report.append(joined.words)
    _warn_of_skewness(joined)
    lay, sentences = _directions(parts, fit)
    finest = max(parts, key=lambda part: part.highest)
    wide = [x for x in parts if x.waves.first <= _ALIKE * widest.waves.first]
    tops, flat, unlike = np.mean([_tops(part, joined.error) for part in wide], axis=0)
    spectrum = Spectrum(fit.q, fit.c, convention="2d")
    cut = shortest is not None or finest.limit.noisy
    report += sentences
    report += [_NO_SHORTEST] if shortest is None else []
    return MeasuredSurface(
        q=fit.q,
        c=fit.c,
        relative_error=fit.error,
        measured_height=height,
        skewness=joined.skewness,
        skewness_error=joined.error,
        report=tuple(report),
        lay=lay,
        map=_only_map(parts, shortest is not None),
        tops=tops,
        flat=flat,
        unlike=unlike,
        left_out=_left_out(finest, spectrum, cut),
    )


def _tops(part: _Part, error: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`top_slopes` of the waves of a scan that the spectrum has, whose skewness has a
    standard error; they fade out about its end, since a sharp one puts ripples on
    summits that are flat. Long waves are those that have half of its mean square slope.
    """
    height, _ = _without_outliers(part.scan.height)
    spread = np.fft.rfftn(height)
    q = part.waves.q.reshape(spread.shape)

    def up_to(end: float) -> np.ndarray:
        kept = 0.5 - 0.5 * np.sin(np.pi / 2 * np.clip((q / end - 1) / _FADE, -1, 1))
        return spread * kept

    def heights(waves: np.ndarray) -> np.ndarray:
        axes = tuple(range(height.ndim))
        return np.fft.irfftn(waves, s=height.shape, axes=axes)

    waves, order = up_to(part.highest), np.argsort(q, axis=None)
    steep = np.cumsum(np.abs(q * waves).ravel()[order] ** 2)
    half = q.ravel()[order][np.searchsorted(steep, steep[-1] / 2)]
    long = heights(up_to(float(half)))
    return top_slopes(heights(waves), long, part.scan.steps, error)


def _between(
    height: np.ndarray, waves: _Waves, low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """The waves of heights between two wave numbers [rad/m], and their heights."""
    spread = np.fft.rfftn(height)
    kept = np.where(_within(waves.q.reshape(spread.shape), low, high), spread, 0.0)
    axes = tuple(range(height.ndim))
    return kept, np.fft.irfftn(kept, s=height.shape, axes=axes)


def _only_map(parts: Sequence[_Part], cut: bool) -> HeightMap | None:
    """The heights, where they are those of one map."""
    part = parts[0]
    if len(parts) > 1 or part.scan.height.ndim == 1:
        return None
    end = part.highest if cut or part.limit.noisy else None
    return HeightMap(part.scan.height, part.scan.steps, end)


def _parts(scans: Sequence[Scan], shortest: float | None) -> list[_Part]:
    """The scans with their waves, up to the highest that is used. Raises
    `InputError`.
    """
    every = [_waves(scan) for scan in scans]
    limits = [_limit(waves, scan) for waves, scan in zip(every, scans, strict=True)]
    highest = [limit.q for limit in limits]
    if shortest is not None:
        finest = int(np.argmax(highest))
        least = 2 * max(scans[finest].steps)
        longest = min(2 * np.pi / waves.first for waves in every)
        if not least <= shortest <= longest / 2:
            raise InputError(
                argument="shortest",
                got=float(shortest),
                accepted=amount(least, "m", 4)
                + " to "
                + amount(longest / 2, "m", 4)
                + ", two steps of the data to a quarter of their length",
            )
        highest = [min(q, 2 * np.pi / shortest) for q in highest]
        highest[finest] = 2 * np.pi / shortest
    names = [f"scan {i}: " if len(scans) > 1 else "" for i in range(1, len(scans) + 1)]
    parts = list(map(_Part, scans, every, limits, highest, names))
    for part in parts:
        if part.highest < 2 * part.waves.first:
            raise InputError(
                argument="heights",
                got=float(2 * np.pi / part.highest),
                accepted=f"resolved to waves of {np.pi / part.waves.first:.4g} m, "
                "half of the longest",
                hint=part.limit.reason,
            )
    return parts


def _mended(scan: Scan, detrend: bool) -> Scan:
    """The scan without holes and trend, about zero."""
    height, report = np.array(scan.height, dtype=np.float64), list(scan.report)
    missing = ~np.isfinite(height)
    _check_size(height.shape)
    if missing.all():
        raise InputError(
            argument="heights", got=np.nan, accepted="numbers, some of them finite"
        )
    report += _coarse(height[~missing])
    # holes are bridged about the plane: on a slope their bridges would be steps
    plane = _plane(height, ~missing)
    height = height - plane
    if missing.any():
        height = _bridged(height)
        ways = "by straight lines" if height.ndim == 1 else "smoothly"
        report.append(
            f"{int(missing.sum())} of {missing.size} points without a value bridged "
            f"{ways}"
        )
    if not detrend:
        height = height + plane
    height = height - height.mean()
    # What rounding leaves of a plane is no roughness.
    if not height.std() > 1e-12 * np.abs(np.where(missing, 0, scan.height)).max():
        raise InputError(
            argument="heights",
            got=float(height.std()),
            accepted="rough beyond rounding, no straight line or plane",
        )
    from scipy.ndimage import binary_opening

    holes = binary_opening(missing, np.ones((_HOLE,) * height.ndim))
    if holes.all():
        raise InputError(
            argument="heights",
            got=float(missing.mean()),
            accepted="known outside of large holes",
            hint="this part of them is missing",
        )
    if holes.mean() > _HOLLOW:
        report.append(
            f"{holes.mean():.0%} of the scan are large holes, which hold no short "
            "waves: C is that of the rest"
        )
    return Scan(height, scan.steps, tuple(report), holes)


def _check_size(shape: tuple[int, ...]) -> None:
    """Raises `InputError` for a scan of too few points."""
    least = _LEAST[len(shape)]
    if min(shape) >= least:
        return
    hint = "give a profile as an array of shape (n,)" if 1 in shape else ""
    size = " x ".join([str(least)] * len(shape))
    raise InputError(
        argument="heights", got=shape, accepted=f"{size} points or more", hint=hint
    )


def _plane(height: np.ndarray, known: np.ndarray) -> np.ndarray:
    """The straight line or plane through the known points, by least squares."""
    axes = [np.linspace(-1, 1, n) for n in height.shape]
    along = [np.ones(()), *np.meshgrid(*axes, indexing="ij", sparse=True)]
    heights = np.where(known, height, 0.0)
    products = [[(one * other * known).sum() for one in along] for other in along]
    sums = [(one * heights).sum() for one in along]
    shares = np.linalg.lstsq(np.array(products), np.array(sums))[0]
    plane = sum(share * one for share, one in zip(shares, along, strict=True))
    return np.broadcast_to(plane, height.shape)


def _waves(scan: Scan) -> _Waves:
    window, holes = (
        np.ones(()),
        np.zeros((), dtype=bool) if scan.holes is None else scan.holes,
    )
    for n in scan.height.shape:
        window = np.multiply.outer(
            window, np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2
        )
    height = scan.height * window / np.sqrt((window**2 * ~holes).sum() / window.size)
    lowest = tuple(
        2 * np.pi / (n * step) for n, step in zip(height.shape, scan.steps, strict=True)
    )
    power = np.abs(np.fft.rfftn(height) / height.size) ** 2 / np.prod(lowest)
    k = [
        2 * np.pi * np.fft.fftfreq(n, step)
        for n, step in zip(height.shape, scan.steps, strict=True)
    ]
    k[-1] = np.abs(k[-1][: power.shape[-1]])
    copies = np.full(power.shape, 2.0)
    copies[..., 0] = 1
    grid = np.meshgrid(*k, indexing="ij")
    q = np.sqrt(sum(component**2 for component in grid))
    q.flat[0] = 1e-3 * min(lowest)  # the mean, below every band; its logarithm exists
    return _Waves(
        tuple(component.ravel() for component in grid),
        q.ravel(),
        power.ravel(),
        copies.ravel(),
        lowest,
    )


def _limit(waves: _Waves, scan: Scan) -> _Limit:
    """Four steps, or where noise begins, or where nothing is left."""
    nyquist = np.pi / max(scan.steps)
    bands = waves.banded(waves.first, nyquist, _NODES)
    quiet = _above_noise(*bands, nyquist, waves.dimensions)
    order = np.argsort(waves.q)
    square = np.cumsum((waves.copies * waves.power * waves.q**2)[order])
    last = float(waves.q[order][np.searchsorted(square, (1 - _REST) * square[-1])])
    last = max(last, 2 * waves.first)
    limit = min(2 * nyquist / _STEPS, quiet, last)
    cut = f"cut at a wavelength of {2 * np.pi / limit:.4g} m, unless `shortest` says "
    if limit == quiet:
        why = "otherwise: the spectrum of shorter waves flattens to white noise of the "
        return _Limit(limit, f"{cut}{why}instrument", noisy=True)
    if limit == last:
        why = "otherwise: shorter waves hold no slope, or were not resolved"
        return _Limit(limit, cut + why)
    return _Limit(limit)


def _above_noise(
    q: np.ndarray,
    power: np.ndarray,
    number: np.ndarray,
    nyquist: float,
    dimensions: int,
) -> float:
    """The last wave number at which the power is well above the level that the shortest
    waves flatten to.
    """
    octave, power = q > nyquist / 2, np.maximum(power, 1e-300)
    if octave.sum() < 3:
        return np.inf
    exponent, error = _exponent(q[octave], power[octave], number[octave])
    if exponent - error < _WHITE * dimensions / 2:
        return np.inf
    last = q > 0.7 * nyquist
    noise = np.average(power[last], weights=number[last])
    above = int(np.cumprod(power > _NOISE * noise).sum())
    return float(q[above - 1]) if above > 3 else np.inf


def _exponent(
    q: np.ndarray, power: np.ndarray, number: np.ndarray
) -> tuple[float, float]:
    """The exponent of a power law through bands of waves, and its standard error."""
    x = np.log(q) - np.average(np.log(q), weights=number)
    spread = float((number * x**2).sum())
    return float((number * x * np.log(power)).sum()) / spread, spread**-0.5


def _fitted(parts: Sequence[_Part]) -> _Fit:
    """C at nodes from the first wave used to the highest one, see the head of this
    file.
    """
    low = min(max(part.waves.lowest) for part in parts)
    first = min(part.waves.first for part in parts)
    high = max(part.highest for part in parts)
    count = int(np.ceil(_NODES * np.log10(high / first) - _SAME))
    gap = np.log(high / first) / count
    # waves that the window brings in
    before = int(np.ceil(np.log(first / low) / gap - _SAME))
    nodes = np.log(first) + gap * np.arange(-before, count + _BEYOND + 1)
    terms = []
    for _, waves, _, end, _ in parts:
        q, power, number = waves.banded(waves.first, end, _FINE)
        place, weight = _expected(waves, q)
        place = np.clip((np.log(place) - nodes[0]) / gap, 0, nodes.size - 1 - 1e-9)
        hats = np.maximum(1 - np.abs(place[..., None] - np.arange(nodes.size)), 0)
        terms.append((q, power, number, weight, hats))
    q = np.concatenate([term[0] for term in terms])
    shape = np.concatenate([term[1] / term[3].sum(axis=1) for term in terms])
    log_c = np.polyval(
        np.polyfit(np.log(q), np.log(np.maximum(shape, 1e-300)), 1), nodes
    )
    bend = np.diff(np.eye(nodes.size), 2, axis=0) / _BEND
    curvature = bend.T @ bend
    for _ in range(200):
        curvature, ascent = bend.T @ bend, -bend.T @ bend @ log_c
        for _, power, number, weight, hats in terms:
            contributions = weight * np.exp(hats @ log_c)
            mean = contributions.sum(axis=1)  # E
            slope = np.einsum("bt,btn->bn", contributions, hats) / mean[:, None]
            curvature = curvature + slope.T * number @ slope
            ascent = ascent + slope.T @ (number * (power / mean - 1))
        change = np.linalg.solve(curvature, ascent)
        log_c = log_c + change * min(1, 1.5 / np.abs(change).max())
        if np.abs(change).max() < 1e-4:
            break
    kept = slice(before, before + count + 1)
    error = np.sqrt(np.diag(np.linalg.inv(curvature)))
    return _Fit(np.exp(nodes[kept]), np.exp(log_c[kept]), error[kept])


def _expected(waves: _Waves, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Wave numbers and weights whose sum over C is the mean power at `q`, each (len(q),
    terms).
    """
    if waves.dimensions == 2:
        angle = np.pi * (np.arange(16) + 0.5) / 16
        x = (q[:, None] * np.cos(angle))[..., None, None] + waves.lowest[0] * _TAPS[
            :, None
        ]
        y = (q[:, None] * np.sin(angle))[..., None, None] + waves.lowest[1] * _TAPS
        place, weight = np.hypot(x, y), _SMEAR[:, None] * _SMEAR / angle.size
    else:  # q = k cosh(u)
        u, step = np.linspace(0, 6, 61, retstep=True)
        k = np.abs(q[:, None, None] + waves.lowest[0] * _TAPS[:, None])
        place = k * np.cosh(u)
        weight = _SMEAR[:, None] * 2 * place * np.where(u > 0, step, step / 2)
    return place.reshape(q.size, -1), np.broadcast_to(weight, place.shape).reshape(
        q.size, -1
    )


def _doubts_of_size(fit: _Fit, parts: Sequence[_Part]) -> list[str]:
    """What makes one doubt that heights and steps are in metres, with a warning. Raises
    `InputError` for slopes that no surface has.
    """
    slope = _moment(fit, 3) ** 0.5
    if slope > _SLOPES[1]:
        raise InputError(
            argument="heights",
            got=slope,
            accepted=f"of an rms slope of {_SLOPES[1]:g} or less",
            hint="heights or pixel_size may be in the wrong unit",
        )
    doubts = _unlike(slope, "are heights and pixel_size in the right unit")
    for scan in (part.scan for part in parts):
        side = max(n * d for n, d in zip(scan.height.shape, scan.steps, strict=True))
        if side > _LONGEST[scan.height.ndim]:
            doubts.append(
                f"a scan is {side:.3g} m long: is pixel_size in the right unit?"
            )
    for sentence in doubts:
        warn(sentence, UserWarning)
    return doubts


def _unlike(slope: Scalar, question: str) -> list[str]:
    """What there is to say of an rms slope that no real surface has."""
    if _SLOPES[0] <= slope <= _SLOPES[1]:
        return []
    return [
        f"an rms slope of {slope:.3g} is unlike a real surface's, {_SLOPES[0]:g} to "
        f"{_SLOPES[1]:g}: {question}?"
    ]


def _moment(fit: _Fit, power: int) -> float:
    """2 pi int q^power C dq."""
    return float(2 * np.pi * Spectrum(fit.q, fit.c, convention="2d").moment(power))


def _left_out(part: _Part, spectrum: AbstractSpectrum, cut: bool) -> Any:
    """ln of the rms slope of the waves of a scan, with those beyond the highest unless
    the data are `cut` there, over that of its spectrum.
    """
    waves, end = part.waves, part.highest if cut else np.inf
    kept = _within(waves.q, waves.first, end)
    square = (waves.copies * waves.power * waves.q**2)[kept].sum()
    square *= np.prod(waves.lowest) * (3 - waves.dimensions)  # twice that of a profile
    moment = spectrum.moment(3, waves.first, part.highest)
    return 0.5 * xp.log(square / (2 * np.pi * moment))


def _overlap(alone: Sequence[_Fit]) -> str:
    """How far the spectra of the scans are from each other where they overlap."""
    worst, place = -1.0, 0.0
    for i, one in enumerate(alone):
        for other in alone[:i]:
            q = one.q[(one.q >= other.q[0]) & (one.q <= other.q[-1])]
            if q.size == 0:
                continue
            values = [
                np.interp(np.log(q), np.log(fit.q), np.log(fit.c))
                for fit in (one, other)
            ]
            apart = np.abs(values[0] - values[1])
            if apart.max() > worst:
                worst, place = float(apart.max()), float(q[apart.argmax()])
    if place == 0:
        return f"{len(alone)} scans joined; their spectra do not overlap"
    return (
        f"{len(alone)} scans joined; where they overlap their C differ by a factor of "
        f"{np.exp(worst):.3g} or less (at a wavelength of {2 * np.pi / place:.3g} m)"
    )


def _heights(fit: _Fit, measured: float) -> str:
    in_spectrum = _moment(fit, 1) ** 0.5
    share = max(0.0, 1 - (in_spectrum / measured) ** 2)
    return (
        f"rms height {measured:.4g} m in the data, {in_spectrum:.4g} m in the spectrum: "
        f"{share:.0%} of <h^2> is in waves longer than {2 * np.pi / fit.q[0]:.4g} m, "
        "which the spectrum leaves out"
    )


class _Asymmetry(NamedTuple):
    """How far heights are from a Gaussian distribution."""

    skewness: float
    error: float  # standard error of the skewness if the heights are Gaussian
    words: str


def skewness_bound(skewness: float, error: float) -> float:
    """What |skewness| is taken for in a bound, of a map as a sample of its surface.

    Where ln(mu) changes by .4 +- .15 (95 % of surfaces) times the skewness, the bound
    with 1.5 errors covers at least 93 % of the maps at any skewness; without errors it
    covers 68 %.
    """
    return float(np.hypot(skewness, _ERRORS * error))


def skewness_of(surface: object) -> float:
    """`skewness_bound` of a surface; zero of one that does not know its heights."""
    names = ("skewness", "skewness_error")
    return skewness_bound(*(getattr(surface, name, 0.0) for name in names))


class _Moments(NamedTuple):
    """Moments of the heights of some scales."""

    rms: float  # [m]
    skewness: float
    error: float  # standard error of the skewness if the heights are Gaussian
    kurtosis: float
    outliers: int = 0  # points that were left out of these numbers


def _moments(scan: Scan, waves: _Waves, low: float, high: float) -> _Moments:
    """Of the heights between two wave numbers [rad/m]."""
    height, outliers = _without_outliers(scan.height)
    kept, heights = _between(height, waves, low, high)
    variance = np.mean(heights**2)
    power = np.abs(kept) ** 2
    independent = 2 * power.sum() ** 2 / (power**2).sum()  # half of the waves
    return _Moments(
        float(variance**0.5),
        float(np.mean(heights**3) / variance**1.5),
        float((6 / independent) ** 0.5),
        float(np.mean(heights**4) / variance**2),
        outliers,
    )


def _without_outliers(height: np.ndarray) -> tuple[np.ndarray, int]:
    """Heights with a bridge in place of the few that stand far out, and how many these
    are: one speck of dust makes a skewness of its own, which says nothing of the
    surface.
    """
    apart = np.abs(height - np.median(height))
    far = apart > _FAR * np.median(apart) / 0.6745  # deviations of a Gaussian
    if not far.any() or far.mean() > _FEW:
        return height, 0
    return _bridged(np.where(far, np.nan, height)), int(far.sum())


def _asymmetry(scan: Scan, waves: _Waves, highest: float) -> _Asymmetry:
    """Skewness and kurtosis of the heights from the first wave to the highest, and of
    the longer and the shorter half of these scales.
    """
    middle = (waves.first * highest) ** 0.5
    whole, longer, shorter = (
        _moments(scan, waves, *scales)
        for scales in (
            (waves.first, highest),
            (waves.first, middle),
            (middle, highest),
        )
    )
    words = (
        f"heights of these scales: skewness {whole.skewness:.2f} +- {whole.error:.2f}, "
        f"kurtosis {whole.kurtosis:.2f}; longer than {2 * np.pi / middle:.3g} m "
        f"{longer.skewness:.2f}, {longer.kurtosis:.2f}; shorter {shorter.skewness:.2f}, "
        f"{shorter.kurtosis:.2f}"
    )
    if whole.outliers:
        words += (
            f"; {whole.outliers} of {scan.height.size} points stand more than {_FAR:g} "
            "times the rms height out and are left out of these numbers: dust, or pits?"
        )
    return _Asymmetry(whole.skewness, whole.error, words)


def _joined_asymmetry(parts: Sequence[_Part]) -> _Asymmetry:
    """Skewness of the heights of all scales: the scales of several scans follow each
    other, each from the scan that knows them best, and their third cumulants add up.
    """
    by_scale: list[_Moments] = []
    known = min(part.waves.first for part in parts)
    while True:
        candidates = []
        for scan, waves, _, high, _ in parts:
            low = max(known, waves.first)
            if high >= 2 * low * (1 - _SAME):
                candidates.append((low, high, _moments(scan, waves, low, high)))
        if not candidates:
            break
        nearest = min(low for low, _, _ in candidates)
        _, known, best = min(
            (one for one in candidates if one[0] <= _ALIKE * nearest),
            key=lambda one: one[2].error,
        )
        by_scale.append(best)
    weight = np.array([scales.rms for scales in by_scale])
    weight = (weight / np.linalg.norm(weight)) ** 3
    skewness = float(weight @ [scales.skewness for scales in by_scale])
    error = float(np.linalg.norm(weight * [scales.error for scales in by_scale]))
    words = f"heights of all scans: skewness {skewness:.2f} +- {error:.2f}"
    return _Asymmetry(skewness, error, words)


def _warn_of_skewness(heights: _Asymmetry) -> None:
    """One warning where chance does not explain the skewness of the heights."""
    if abs(heights.skewness) < max(_SKEWED, _CERTAIN * heights.error):
        return
    worn = "less" if heights.skewness < 0 else "more"
    warn(
        f"heights of skewness {heights.skewness:.2f} are not Gaussian: friction by "
        "em.Multiscale(), the default, follows the slopes of their tops. By other models "
        f"it is likely to be {worn} than they say, which model_error holds, but by "
        "em.HalfSpace(), which slides over the heights of one map themselves.",
        ModelWarning,
    )


def _slope(part: _Part) -> str:
    """The rms slope by differences of neighbours."""
    squares = (
        np.mean(np.diff(part.scan.height, axis=i) ** 2) / d**2
        for i, d in enumerate(part.scan.steps)
    )
    return f"rms slope {sum(squares) ** 0.5:.4g} by differences of neighbours"


def _directions(parts: Sequence[_Part], fit: _Fit) -> tuple[Lay | None, list[str]]:
    """The lay of a surface that has one, and what there is to say of it."""
    maps = []
    for _, waves, _, high, _ in parts:
        if waves.dimensions == 1:
            continue
        inside = _within(waves.q, waves.first, high)
        q, power, copies, kx, ky = (
            x[inside] for x in (waves.q, waves.power, waves.copies, *waves.k)
        )
        c = np.exp(np.interp(np.log(q), np.log(fit.q), np.log(fit.c)))
        angle = np.arctan2(ky, kx)
        maps.append(Periodogram(q, angle, power / c, copies, _INDEPENDENT**2))
    if not maps:
        return None, []
    lay, crossed = measured_lay(maps, fit.q)
    remarks = [] if lay is None else [lay.words()]
    remarks += [crossed] if crossed else []
    if not remarks:
        return lay, []
    sentence = "; ".join(["the surface is not isotropic", *remarks])
    sentence += (
        "; em.friction takes a `direction`, all else the mean over directions"
        if lay is not None
        else "; the mean over directions is used"
    )
    if lay is not None and lay.log_peklenik.max() > np.log(_UNEQUAL):
        warn(sentence, UserWarning)
    return lay, [sentence]


def _coarse(height: np.ndarray) -> list[str]:
    """What there is to say of heights that take few values."""
    levels = np.unique(height)
    if levels.size > _COARSE:
        return []
    step = float(np.diff(levels).min()) if levels.size > 1 else 0.0
    return [
        (
            f"heights are coarsely rounded: {levels.size} levels, {step:.3g} m apart; "
            "short waves are rounding noise"
        )
    ]


def _bridged(height: np.ndarray) -> np.ndarray:
    """Heights with their holes filled: of a profile by straight lines; of a map as by a
    membrane, each point there about the mean of its four neighbours.

    From a map of half the points, bridged in the same way, so that a hole of any size
    needs few passes.
    """
    missing = ~np.isfinite(height)
    if not missing.any():
        return height
    if height.ndim == 1:
        x = np.arange(height.size)
        return np.interp(x, x[~missing], height[~missing])
    from scipy.ndimage import zoom

    padded = np.pad(height, [(0, n % 2) for n in height.shape], constant_values=np.nan)
    blocks = padded.reshape(padded.shape[0] // 2, 2, padded.shape[1] // 2, 2)
    count = np.isfinite(blocks).sum(axis=(1, 3))
    coarse = np.where(
        count > 0, np.nansum(blocks, axis=(1, 3)) / np.maximum(count, 1), np.nan
    )
    coarse = _bridged(coarse)
    # between the middles of the blocks, by straight lines
    finer = np.asarray(zoom(coarse, 2, order=1, mode="nearest", grid_mode=True))
    rows, columns = height.shape
    filled = np.where(missing, finer[:rows, :columns], height)
    i, j = np.nonzero(missing)
    places = np.arange(height.size).reshape(height.shape)
    places = np.pad(places, 1, mode="edge")
    sides = np.stack(
        [
            places[i, j + 1],
            places[i + 2, j + 1],
            places[i + 1, j],
            places[i + 1, j + 2],
        ]
    )
    for _ in range(_PASSES):
        filled[i, j] = np.take(filled, sides).sum(axis=0) / 4
    return filled


class MeasuredSurface(AbstractSpectrum):
    """A measured surface by its spectrum, with what was found and mended in the
    data.
    """

    q: Float[np.ndarray, " n"]
    c: Float[np.ndarray, " n"]
    # standard error of ln C, from the number of waves in the data
    relative_error: Float[np.ndarray, " n"]
    # rms of the data about the straight line or plane [m]
    measured_height: float
    skewness: float = static()  # of the heights that the spectrum holds
    report: tuple[str, ...] = static()
    skewness_error: float = static(default=0.0)  # standard error, of Gaussian heights
    lay: Lay | None = None  # where C depends on direction; `c` is its mean then
    map: HeightMap | None = static(default=None)  # the heights of a single map
    changed: bool = static(default=False)  # after it was read, which begins its report
    # `top_slopes` of the heights; those of Gaussian ones are zero
    tops: Float[np.ndarray, " shares"] | None = None
    flat: Float[np.ndarray, " shares"] | None = None
    unlike: Float[np.ndarray, " shares"] | None = None
    # ln of the rms slope of all waves of the data over that of the spectrum
    left_out: Scalar = 0.0
    label: ClassVar[str] = "measured surface"

    def ended(self, q_high: Number) -> MeasuredSurface:
        """The same surface up to `q_high` [rad/m], with its lay and skewness; beyond its
        last point spectrum and lay go on, and the map itself is left out.
        """
        return self._up_to(super().ended(q_high))._described()

    def _up_to(self, spectrum: AbstractSpectrum) -> MeasuredSurface:
        """`ended`, with its spectrum and the report of this surface."""
        end = float(spectrum.q[-1])
        log_q, old = np.log(spectrum.q), np.log(self.q)
        longer = max(self.measured_height**2 - self.rms_height**2, 0.0)
        height = (longer + spectrum.rms_height**2) ** 0.5
        shortened = dataclasses.replace(
            self,
            q=spectrum.q,
            c=spectrum.c,
            relative_error=np.interp(log_q, old, self.relative_error),
            measured_height=height,
            lay=None if self.lay is None else self.lay.at(spectrum.q),
        )
        if self.map is None or abs(end / self.q_high - 1) < _SAME:
            return shortened
        if end > self.q_high:
            warn(
                f"the map has no waves beyond {self.q_high:.4g} rad/m: with a spectrum "
                f"up to {end:.4g} rad/m em.HalfSpace() takes random maps.",
                ModelWarning,
            )
            return dataclasses.replace(shortened, map=None)
        scan = Scan(self.map.height, self.map.steps)
        waves = _waves(scan)
        skewness, error = self.skewness, 1.0
        if end >= 2 * waves.first:  # else too few waves to know any skewness
            skewness, error, _ = _asymmetry(scan, waves, end)
        part = _Part(scan, waves, _Limit(end), end, "")
        tops, flat, unlike = _tops(part, error)
        return dataclasses.replace(
            shortened,
            map=self.map.ended(end),
            tops=tops,
            flat=flat,
            unlike=unlike,
            left_out=_left_out(part, shortened, True),
            skewness=skewness,
            skewness_error=error,
        )

    def raised(self, factor: Number) -> MeasuredSurface:
        """The same surface with all heights times `factor`, its lay and skewness."""
        higher = super().raised(factor)
        times: Any = scalar("factor", factor)
        heights = None
        if self.map is not None and not is_traced(times):
            heights = self.map.raised(float(times))
        changed = dataclasses.replace(
            self,
            c=higher.c,
            measured_height=self.measured_height * times,
            map=heights,
        )
        return changed._described()

    def sampled(self, errors: float) -> MeasuredSurface:
        """The same surface, ln C off by so many of its standard errors at all scales."""
        return dataclasses.replace(
            self, c=self.c * np.exp(errors * self.relative_error)
        )

    def _described(self) -> MeasuredSurface:
        """The same surface, whose report begins with what it is now."""
        if is_traced(self):
            return self
        now = (
            f"changed after it was read, {self.words()}; rms height with longer waves "
            f"{self.measured_height:.4g} m; skewness {self.skewness:.2f} +- "
            f"{self.skewness_error:.2f}. What follows is of the surface as read"
        )
        read = self.report[self.changed :]
        return dataclasses.replace(self, report=(now, *read), changed=True)

    def draws(
        self, n: int, *, level: Number = 0.0, cutoff: Number = 0.0, seed: int = 0
    ) -> Draws[AbstractSpectrum]:
        """As of every spectrum. The Peklenik number, by one factor for all scales, and
        the skewness of each differ within their sampling errors; that of the skewness
        stays, since the map is as small as it was. The map itself has no other cutoff:
        with `cutoff` em.HalfSpace() takes random maps of all draws.
        """
        drawn = self if cutoff == 0 else dataclasses.replace(self, map=None)
        surfaces: Draws[Any] = AbstractSpectrum.draws(
            drawn, n, level=level, cutoff=cutoff, seed=seed
        )
        # random numbers of their own: C and cutoff are those of a surface without a lay
        off = np.random.default_rng([seed, 1]).standard_normal((n, 2))
        each: list[AbstractSpectrum] = [
            dataclasses.replace(
                surface,
                lay=None if surface.lay is None else surface.lay.off(errors),
                skewness=surface.skewness + skewed * surface.skewness_error,
            )._described()
            for surface, (errors, skewed) in zip(surfaces, off, strict=True)
        ]
        varied = "skewness" if self.lay is None else "skewness and Peklenik number"
        words = f"{surfaces.words}, {varied} within their sampling errors"
        return Draws(each, self, words, surfaces.errors)

    def __repr__(self) -> str:
        return f"MeasuredSurface({self.words()}; {'; '.join(self.report)})"


class MeasuredSpectrum(AbstractSpectrum):
    """A surface by a spectrum that was read from a file, with what was found and mended
    in the table.
    """

    q: Float[np.ndarray, " n"]
    c: Float[np.ndarray, " n"]
    # of the table; c is normalised by <h^2> = int C d^2q, whatever it is
    convention: str = static()
    report: tuple[str, ...] = static()
    label: ClassVar[str] = "surface by its measured spectrum"

    def __repr__(self) -> str:
        return (
            f"MeasuredSpectrum({self.words()}; "
            f"{'; '.join(self.report) or 'nothing to report'})"
        )


def from_spectrum(
    q: np.ndarray,
    c: np.ndarray,
    convention: Convention,
    low: float | None,
    high: float | None,
    report: Sequence[str],
) -> MeasuredSpectrum:
    """A surface from a table of q [rad/m] and C in any order, cut to the cutoffs `low`
    and `high` [rad/m] if given; `report` says what was done before.
    """
    report = list(report)
    # a table of wavelengths runs the other way round, which needs no mention
    if len(set(np.sign(np.diff(q)))) > 1:
        report.append("wave numbers were not in order: sorted")
    order = np.argsort(q, kind="stable")
    q, c = q[order], c[order]
    spectrum = Spectrum(q, c, convention=convention)
    if low is not None or high is not None:
        spectrum = _cut(spectrum, low, high, report)
    doubts = _unlike(spectrum.rms_slope, "are units, convention and cutoffs right")
    for sentence in doubts:
        warn(sentence, UserWarning)
    report += doubts
    if low is None or high is None:
        report.append(_asks_for_cutoffs(spectrum, low, high))
    return MeasuredSpectrum(
        q=spectrum.q, c=spectrum.c, convention=convention, report=tuple(report)
    )


def _asks_for_cutoffs(spectrum: Spectrum, low: float | None, high: float | None) -> str:
    """Which waves are taken, where the table's ends decide."""
    missing = [
        name for name, q in (("`longest`", low), ("`shortest`", high)) if q is None
    ]
    return (
        f"no {' and no '.join(missing)} is given: all waves of the table from "
        f"{2 * np.pi / spectrum.q_low:.3g} m down to {2 * np.pi / spectrum.q_high:.3g} m "
        "are taken. Friction grows with each shorter wave: usual are 5 mm to some "
        "micrometres"
    )


def _cut(
    spectrum: Spectrum, low: float | None, high: float | None, report: list[str]
) -> Spectrum:
    """The spectrum between two wave numbers of its table."""
    lowest, highest = spectrum.q_low, spectrum.q_high
    first, last = lowest if low is None else low, highest if high is None else high
    least, most = 2 * np.pi / highest, 2 * np.pi / lowest
    for name, q in (("longest", first), ("shortest", last)):
        if not lowest * (1 - 1e-9) <= q <= highest * (1 + 1e-9):
            raise InputError(
                argument=name,
                got=2 * np.pi / q,
                accepted="within the table, "
                + amount(least, "m", 4)
                + " to "
                + amount(most, "m", 4),
            )
    if not first < last:
        raise InputError(
            argument="shortest",
            got=2 * np.pi / last,
            accepted="shorter than the longest, " + amount(2 * np.pi / first, "m", 4),
        )
    first, last = float(max(first, lowest)), float(min(last, highest))
    inner = spectrum.q[(spectrum.q > first) & (spectrum.q < last)]
    kept = np.concatenate([[first], inner, [last]])
    share = spectrum.moment(3, first, last) / spectrum.moment(3)
    report.append(
        f"cut to wavelengths of {2 * np.pi / first:.4g} to "
        f"{2 * np.pi / last:.4g} m, which keeps {share**0.5:.2g} of the rms "
        "slope"
    )
    return Spectrum(kept, spectrum.at(kept), convention="2d")
