"""How values change with what they depend on, and what a few that are measured leave of
the spread of the others: the linear update of their covariance.
"""

import numpy as np


def relative(
    value: np.ndarray, ends: list[np.ndarray | float]
) -> tuple[np.ndarray, np.ndarray]:
    """The larger change of a value to either end, and half of the difference of both
    with its sign; relative, NaN where the value is 0.
    """
    up, down = (end / np.where(value == 0, np.nan, value) - 1 for end in ends)
    return np.maximum(np.abs(up), np.abs(down)), 0.5 * (up - down)


def narrowed(slopes: np.ndarray, error: float) -> tuple[np.ndarray, np.ndarray]:
    """The share of its spread that measured points leave at each; and whether it is
    one of these, which are three, apart.

    The first axis of `slopes` runs over unknowns, the others over points: how the value
    there changes with one standard deviation of each. Unknowns are not correlated
    before; a point with NaN is neither measured nor narrowed; `error` is that of each
    measured value.
    """
    shape = slopes.shape[1:]
    slopes = slopes.reshape(len(slopes), -1)
    known = np.isfinite(slopes).all(axis=0)
    slopes, there = np.where(known, slopes, 0.0), np.flatnonzero(known)
    there = there[:: max(1, (there.size - 1) // 2)][:3]
    with_these = slopes[:, there].T @ slopes
    among = with_these[:, there] + error**2 * np.eye(there.size)
    gone = np.sum(with_these * np.linalg.solve(among, with_these), axis=0)
    before = np.sum(slopes**2, axis=0)
    left = np.sqrt(np.maximum(1 - gone / np.where(before > 0, before, 1.0), 0.0))
    measured = np.isin(np.arange(known.size), there)
    return left.reshape(shape), measured.reshape(shape)
