"""Measured surfaces: what a spectrum of heights or of a table says, and what was found
and mended in the data.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..errors import InputError
from ..trees import static
from .spectrum import AbstractSpectrum, Spectrum

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import Convention

_SAME = 1e-9  # relative distance of two wave numbers that count as one
_APART = 10  # times more or less than the neighbours say: reported
# rms slopes beyond which a table is doubted: of polished surfaces and of the roughest
# roads
_SLOPES = (1e-3, 3.0)


class MeasuredSurface(AbstractSpectrum):
    """A measured surface by its spectrum, with what was found and mended in the
    data.
    """

    q: Float[np.ndarray, " n"]
    c: Float[np.ndarray, " n"]
    # standard error of ln C, from the number of waves in the data
    relative_error: Float[np.ndarray, " n"]
    # rms of the data about the straight line or plane [m]
    measured_height: float = static()
    report: tuple[str, ...] = static()
    label: ClassVar[str] = "measured surface"

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
) -> MeasuredSpectrum:
    """A surface from a table of q [rad/m] and C in any order, cut to the cutoffs `low`
    and `high` [rad/m] if given.
    """
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
        spread = float(
            (
                np.maximum.reduceat(logs, starts) - np.minimum.reduceat(logs, starts)
            ).max()
        )
        report.append(
            f"{q.size - group[-1] - 1} points at a wave number that came before, with "
            f"values up to a factor of {10**spread:.3g} apart: averaged"
        )
        q, c = (np.bincount(group, values) / np.bincount(group) for values in (q, c))
    between = _neighbours(q, c)
    off = np.abs(np.log(c[1:-1]) - between)
    if (off > np.log(_APART)).any():
        at = int(off.argmax()) + 1
        report.append(
            f"C = {c[at]:.3g} at q = {q[at]:.4g} rad/m is "
            f"{c[at] / np.exp(between[at - 1]):.2g} times what its neighbours let "
            f"expect: is it mistyped? ({int((off > np.log(_APART)).sum())} points "
            "are off, or beside such)"
        )
    whole = Spectrum(q, c, convention=convention)
    if low is not None or high is not None:
        first, last = (
            whole.q_low if low is None else low,
            whole.q_high if high is None else high,
        )
        if not whole.q_low * (1 - 1e-9) <= first < last <= whole.q_high * (1 + 1e-9):
            raise InputError(
                "longest and shortest must be wavelengths within the table, "
                f"{2 * np.pi / whole.q_low:.4g} to {2 * np.pi / whole.q_high:.4g} m, "
                f"got {2 * np.pi / first:.4g} and {2 * np.pi / last:.4g} m."
            )
        first, last = float(max(first, whole.q_low)), float(min(last, whole.q_high))
        kept = np.concatenate(
            [[first], whole.q[(whole.q > first) & (whole.q < last)], [last]]
        )
        share = whole.moment(3, first, last) / whole.moment(3)
        report.append(
            f"cut to wavelengths of {2 * np.pi / first:.4g} to "
            f"{2 * np.pi / last:.4g} m, which keeps {share**0.5:.2g} of the rms "
            "slope"
        )
        whole = Spectrum(kept, whole.at(kept), convention="2d")
    slope = whole.rms_slope
    if not _SLOPES[0] <= slope <= _SLOPES[1]:
        report.append(
            f"an rms slope of {slope:.3g} is unlike a real surface's, "
            f"{_SLOPES[0]:g} to {_SLOPES[1]:g}: are "
            "units, convention and cutoffs right?"
        )
    return MeasuredSpectrum(
        q=whole.q, c=whole.c, convention=convention, report=tuple(report)
    )


def _neighbours(q: np.ndarray, c: np.ndarray) -> np.ndarray:
    """ln C at all points but the ends, from the points on either side of each."""
    x, y = np.log(q), np.log(c)
    share = (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
    return y[:-2] + share * (y[2:] - y[:-2])
