"""Stability of a drive about steady sliding: what the call returns."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..checks import significant
from ..results.axes import Axis
from ..results.base import Array, Result, quantity, record
from ..results.words import in_words, span

if TYPE_CHECKING:
    pass

_SHOWN = 6  # curves that a summary lists one by one
_ALIKE = 1e-9  # relative, of two velocities


@record
class Stability(Result):
    """Damping of a drive about steady sliding, for each velocity; the last axis is that
    of the velocities.

    Where `follows` is False the ratio decides nothing. A velocity at which the force is
    not known, or beside one, is NaN with `converged=False`. `plot` draws the ratio,
    dotted where it decides nothing, the unstable range shaded.
    """

    velocity: Array = quantity(
        "velocity", "m/s", "V of the drive", axis="velocity of the drive"
    )
    force: Array = quantity("friction force", "N", "F(V), as given")
    slope: Array = quantity("slope of the friction force", "N s/m", "F'(V)")
    ratio: Array = quantity(
        "damping ratio",
        "-",
        "zeta; below zero swings grow",
        axis=r"damping ratio $\zeta$",
    )
    follows: Array = quantity(
        "friction follows the speed at once",
        "",
        "V > lambda sqrt(k/m); where it does not, ask em.drive",
    )
    error: Array = quantity(
        "estimated error of the damping ratio",
        "-",
        "by the differences; NaN for fewer than five velocities together",
    )
    slowest: Array = quantity(
        "slowest velocity that friction follows", "m/s", "lambda sqrt(k/m)", dims=""
    )

    title: ClassVar[str] = "Stability of a drive"
    figure: ClassVar[str] = "draw_stability"
    shows: ClassVar[str] = "ratio"
    scale: ClassVar[str] = "log"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the damping ratio"
    unflagged: ClassVar[str] = (
        "does not enter: the forces are given, what they are extrapolated from is not "
        "seen"
    )

    def axes(self) -> list[Axis]:
        """The axes of the fields by name, with their values; a force that is the same
        at all velocities names one.
        """
        return [
            axis._replace(name="friction_force") if axis.name == "load" else axis
            for axis in super().axes()
        ]

    def outcome(self) -> Iterator[tuple[str, str]]:
        """From which velocity on the ratio decides, the least ratio there, and where
        swings grow.
        """
        yield (
            "decides",
            (
                f"above {in_words('velocity', float(self.slowest))}; slower than that "
                "ask "
                "em.drive"
            ),
        )
        fields = {q.key: value for q, value in self.fields().items()}
        for curve in self.curves()[1][:_SHOWN]:
            velocity, ratio, counts = (
                fields[key][curve.at] for key in ("velocity", "ratio", "follows")
            )
            counts = counts & np.isfinite(ratio)
            text = _growing(velocity, ratio, counts, float(self.slowest))
            yield "at " + curve.label if curve.label else "result", text
            known = _sticks(
                velocity, fields["force"][curve.at], ratio, counts, float(self.slowest)
            )
            yield "stick-slip", known
        holes, alone = (
            np.isnan(fields["force"]),
            fields["converged"] & np.isnan(fields["error"]),
        )
        if holes.any():
            text = (
                f"{holes.sum()} of {holes.size} forces; the ratio there and beside "
                "them is left out"
            )
            yield (
                "not known",
                text
                + (f", and its error at {alone.sum()} others" if alone.any() else ""),
            )


def unstable(
    velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, limit: float
) -> list[tuple[float, float]]:
    """Ranges of velocity in which swings grow, from where the ratio crosses zero,
    linear in ln V in between.

    One that begins below `limit`, from which on the ratio counts, begins there.
    """
    found: list[tuple[float, float]] = []
    at = np.log(velocity)
    for i in np.flatnonzero(counts & (ratio < 0)):
        ends = []
        for j in (i - 1, i + 1):
            known = 0 <= j < ratio.size and np.isfinite(ratio[j])
            if known and ratio[j] >= 0:
                crossing = at[i] + (at[j] - at[i]) * ratio[i] / (ratio[i] - ratio[j])
                ends.append(max(crossing, np.log(limit)))
            else:
                ends.append(np.log(limit) if known and not counts[j] else at[i])
        if found and i > 0 and counts[i - 1] and ratio[i - 1] < 0:
            found[-1] = (found[-1][0], float(np.exp(ends[1])))
        else:
            found.append((float(np.exp(ends[0])), float(np.exp(ends[1]))))
    return found


def _sticks(
    velocity: np.ndarray,
    force: np.ndarray,
    ratio: np.ndarray,
    counts: np.ndarray,
    limit: float,
) -> str:
    """Yes or no, and the friction force there."""
    if not counts.any():
        return (
            "not decided: friction follows the speed only above "
            f"{in_words('velocity', limit)}; ask em.drive"
        )
    ranges = unstable(velocity, ratio, counts, limit)
    if not ranges:
        return (
            f"no, above {in_words('velocity', limit)}: swings die out; friction "
            f"{span(force[counts], 'N')}"
        )
    falls = force[counts & (ratio < 0)]
    return (
        f"yes, {' and '.join(_range(*ends, limit) for ends in ranges)}: swings grow; "
        f"friction {span(falls, 'N')}"
    )


def _growing(
    velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, limit: float
) -> str:
    if not counts.any():
        return "no velocity at which the ratio decides"
    least = np.flatnonzero(counts)[ratio[counts].argmin()]
    place = in_words("velocity", float(velocity[least]))
    text = f"damping ratio at least {significant(float(ratio[least]))}, at {place}: "
    ranges = unstable(velocity, ratio, counts, limit)
    if not ranges:
        return text + "swings die out"
    return (
        text
        + "swings grow "
        + " and ".join(_range(low, high, limit) for low, high in ranges)
    )


def _range(low: float, high: float, limit: float) -> str:
    if low <= limit * (1 + _ALIKE):
        return f"from below {significant(limit)} to {significant(high)} m/s"
    return (
        f"at {in_words('velocity', low)}"
        if low == high
        else f"at {significant(low)} to {significant(high)} m/s"
    )
