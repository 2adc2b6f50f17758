"""Heights that a profilometer could not measure, and wrote as numbers: codes, such as
-9999, and single spikes.
"""

import numpy as np

from ..errors import InputError

LEFT_OUT = "left out, and bridged"  # ends what is said of dropouts
_CODES = (9.999, 9.9999, 9.99999, 3.2768, 3.2767)  # digits of -9999, 99999, -32768, ...
# of the range of all other heights, that such a code is away from them, be it there but
# once
_USUAL = 0.2
_MOST_CODES = 0.25  # share of codes above which too little was measured,
_MOST_SPIKES = 0.02  # and that of spikes
# different heights beside a code: with fewer, a far one may be the bottom of a groove
_FEWEST_LEVELS = 16
_WIDTH = 3  # points of the widest spike
_COMMON = 0.9  # of all differences over that width, which are below a scale
# times that scale, above which a spike is none of the surface: 20 standard deviations
# of Gaussian heights
_FAR = 12.0


def without_dropouts(height: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Heights of a profile or map with NaN in place of dropouts, and what was left out
    in words.

    Raises `InputError` where more than a quarter are codes, or more than 2 % spikes.
    """
    codes: dict[float, int] = {}
    left = np.array(height, dtype=np.float64)
    _take_codes(left, codes)
    largest = _take_spikes(left)
    if largest:
        # beside a spike that is further away a code is not the furthest
        _take_codes(left, codes)
    lost, coded = int((np.isfinite(height) & np.isnan(left)).sum()), sum(codes.values())
    words = []
    if codes:
        values = " and ".join(
            f"{count} times {value:.6g} m" for value, count in codes.items()
        )
        if coded > _MOST_CODES * height.size:
            raise InputError(
                "heights must be measured at three quarters of the points or more, "
                f"got {coded} of {height.size} dropouts, {values}: measure again, or "
                "cut that part away."
            )
        words.append(
            f"{coded} of {height.size} points are dropouts, {values}: {LEFT_OUT}"
        )
    if lost > coded:
        if lost - coded > _MOST_SPIKES * height.size:
            raise InputError(
                f"heights must be free of spikes at {1 - _MOST_SPIKES:.0%} of the "
                f"points or more, got {lost - coded} of {height.size}, by up to "
                f"{largest:.3g} m beyond their neighbours: filter them, or measure "
                "again."
            )
        words.append(
            f"{lost - coded} of {height.size} points are spikes, by up to "
            f"{largest:.3g} m beyond what their neighbours allow: {LEFT_OUT}"
        )
    return left, words


def _take_codes(height: np.ndarray, codes: dict[float, int]) -> None:
    """Puts NaN in place of codes, and how often each was there into `codes`.

    A code is the lowest or the highest value, is there twice or more, bit for bit, and
    is further from all other heights than these are from each other; those in use may
    be there once, and a fifth as far.
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
        apart = np.abs(rest - value).min()
        if (
            apart > np.ptp(rest) * (_USUAL if usual else 1.0)
            and np.unique(rest).size >= _FEWEST_LEVELS
        ):
            return float(value), count
    return 0.0, 0


def _is_usual_code(value: float) -> bool:
    """Whether a height is a code that is in use, in whatever unit of ten."""
    digits = abs(value) / 10.0 ** np.floor(np.log10(abs(value))) if value else 0.0
    return bool(np.isclose(digits, _CODES, rtol=1e-6, atol=0).any())


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
    spikes = outstanding > _FAR * scale
    if not scale or not spikes.any():
        return 0.0
    height[spikes] = np.nan
    return float(outstanding[spikes].max())


def _outstanding(height: np.ndarray, axis: int) -> np.ndarray:
    """How far each point is above (or below) what is within three points on either side
    of it, by the nearer side.
    """
    sides = [_reach(height, axis, side) for side in (-1, 1)]
    above = np.fmin(*(height - lowest for lowest, _ in sides))
    below = np.fmin(*(highest - height for _, highest in sides))
    return np.nan_to_num(np.fmax(above, below), nan=0.0)


def _reach(height: np.ndarray, axis: int, side: int) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest height within three points on one side; NaN where
    there is none.
    """
    lowest = highest = np.full(height.shape, np.nan)
    for distance in range(1, _WIDTH + 1):
        neighbour = _shifted(height, axis, side * distance)
        lowest, highest = np.fmin(lowest, neighbour), np.fmax(highest, neighbour)
    return lowest, highest


def _shifted(height: np.ndarray, axis: int, steps: int) -> np.ndarray:
    """The heights so many steps further along an axis; NaN beyond its end."""
    moved = np.full_like(height, np.nan)
    source, target = np.moveaxis(height, axis, 0), np.moveaxis(moved, axis, 0)
    if steps > 0:
        target[:-steps] = source[steps:]
    else:
        target[-steps:] = source[:steps]
    return moved


def _usual_difference(height: np.ndarray, axis: int) -> float:
    """What nine tenths of the differences between points three apart are below."""
    along = np.moveaxis(height, axis, 0)
    apart = np.abs(along[_WIDTH:] - along[:-_WIDTH])
    apart = apart[np.isfinite(apart)]
    return float(np.quantile(apart, _COMMON)) if apart.size else 0.0
