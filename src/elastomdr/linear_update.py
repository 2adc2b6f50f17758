"""How values change with what they depend on, and what a few that are measured leave of
the spread of the others: the linear update of their covariance.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


def relative(
    value: np.ndarray, ends: list[np.ndarray | float]
) -> tuple[np.ndarray, np.ndarray]:
    """The larger change of a value to either end, and half of the difference of both
    with its sign; relative, NaN where the value is 0.
    """
    up, down = (end / np.where(value == 0, np.nan, value) - 1 for end in ends)
    return np.maximum(np.abs(up), np.abs(down)), 0.5 * (up - down)


class Few(NamedTuple):
    """Measured points; what is relative is to the value that is computed there."""

    slopes: np.ndarray  # how it changes with one standard deviation of each unknown
    error: np.ndarray  # of that which is measured, relative
    reach: np.ndarray  # how far off it may be, relative
    same: np.ndarray  # by point of a curve, which of these it is

    def beside(self, others: Few) -> Few:
        """These and others."""
        joint = zip(self, others, strict=True)
        return Few(*(np.concatenate(each, axis=-1) for each in joint))

    def left(self, slopes: np.ndarray) -> np.ndarray:
        """The share of its spread that they leave at each of other points, of `slopes`
        that run over unknowns, not correlated before, and points; NaN is not narrowed.
        """
        known = np.where(np.isfinite(slopes).all(axis=0), slopes, 0.0)
        with_these = self.slopes.T @ known
        among = self.slopes.T @ self.slopes + np.diag(self.error**2)
        gone = np.sum(with_these * np.linalg.solve(among, with_these), axis=0)
        before = np.sum(known**2, axis=0)
        return np.sqrt(np.maximum(1 - gone / np.where(before > 0, before, 1.0), 0.0))

    def held(self, share: np.ndarray) -> np.ndarray:
        """A bound, where that is measured at most as far off as the value may be."""
        reach = np.where(self.same, self.reach, np.inf).min(axis=-1, initial=np.inf)
        reach = reach.reshape(share.shape)
        return np.where(np.isfinite(reach), np.fmin(share, reach), share)


def apart(slopes: np.ndarray) -> np.ndarray:
    """Three of the points where all `slopes` are known, apart, or fewer."""
    there = np.flatnonzero(np.isfinite(slopes).all(axis=0))
    return there[:: max(1, (there.size - 1) // 2)][:3]
