"""The rubber along a rough line in steady periodic sliding: one period of one element, laid out along the line.

Every element sees the same history, so that what one element does in time is what the line shows in space, read
against the motion. The formulas of a step are those of `solve.period`.
"""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from ..material.relaxation import Relaxation
from .lump import lanes
from .period import coefficients
from .periodic import Line, rises, solve_states


class Field(NamedTuple):
    """The line and the rubber at each sample, along +x."""

    line: Line  # of one lane
    surface: Float[np.ndarray, " n"]  # u, how far the rubber is pushed back [m]
    force: Float[np.ndarray, " n"]  # q, force per length of line [N/m]; 0 out of contact


def field(
    height: Float[np.ndarray, " n"], spacing: float, law: Relaxation, velocity: float, value: float,
    control: Literal["load", "depth"], rtol: float,
) -> Field:  # fmt: skip
    """Solves one velocity and lays its period out along the line; NaN where it did not converge."""
    speed = np.array([velocity])
    line, state = solve_states(height, spacing, law, speed, np.array([value]), control, rtol)
    n = height.size
    if not line.converged[0]:
        return Field(line, np.full(n, np.nan), np.full(n, np.nan))
    by = coefficients(lanes(law, 1), spacing / speed)
    keep, gain, give = by.keep[:, 0], by.gain[:, 0], float(by.give[0])
    rise, depth = rises(height), float(line.depth[0])
    f, u = state.branches[:, 0], depth
    surface, force = np.empty(n), np.empty(n)
    for i in range(1, n + 1):
        kept = keep * f
        loose = u - (float(by.relaxed) * u + kept.sum()) * give
        new = max(loose, rise[i % n] + depth)
        f, u, j = kept + gain * (new - u), new, i % n
        surface[j], force[j] = new, (new - loose) / give
    back = np.roll(np.arange(n)[::-1], -int(np.argmax(height[::-1])))  # where along +x each sample of the period lies
    laid = Field(line, np.empty(n), np.empty(n))
    laid.surface[back], laid.force[back] = surface, force
    return laid
