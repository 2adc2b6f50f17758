"""The rubber along a rough line in steady periodic sliding: one period of one element,
laid out along the line.

Every element sees the same history, so that what one element does in time is what the
line shows in space, read against the motion. The formulas of a step are those of
`rough.period`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array
from ..material.relaxation import Relaxation
from .branch_reduction import lanes
from .period import Coefficients, coefficients
from .periodic import Line, rises, solve_states

if TYPE_CHECKING:
    from jaxtyping import Float


class Motion(NamedTuple):
    """One period of an element, from the highest point of the line on."""

    surface: Float[Array, "n lanes"]  # u [m]
    force: Float[Array, "n lanes"]  # q [N/m]


class Field(NamedTuple):
    """The line and the rubber at each sample, along +x."""

    line: Line  # of one lane
    surface: Float[np.ndarray, " n"]  # u, how far the rubber is pushed back [m]
    # q, force per length of line [N/m]; 0 out of contact
    force: Float[np.ndarray, " n"]


@jax.jit
def motion(
    rise: Float[Array, " n"],
    depth: Float[Array, " lanes"],
    branches: Float[Array, "branches lanes"],
    by: Coefficients,
) -> Motion:
    """u and q at each sample of a period that begins with the branch forces f_k at the
    highest point, where u = d.
    """

    def one(state, w):
        f, u = state
        loose = u - (by.relaxed * u + (by.seen * f).sum(axis=0)) * by.give
        new = jnp.maximum(loose, w + depth)
        return (by.keep * f + by.gain * (new - u), new), (new, (new - loose) / by.give)

    found = jax.lax.scan(one, (branches, depth), jnp.roll(rise, -1))[1]
    return Motion(*(jnp.roll(field, 1, axis=0) for field in found))


def field(
    height: Float[np.ndarray, " n"],
    spacing: float,
    law: Relaxation,
    velocity: float,
    value: float,
    control: Literal["load", "depth"],
    rtol: float,
) -> Field:
    """Solves one velocity and lays its period out along the line; NaN where it did not
    converge.
    """
    speed, n = np.array([velocity]), height.size
    line, state = solve_states(
        height, spacing, law, speed, np.array([value]), control, rtol
    )
    if not line.converged[0]:
        return Field(line, np.full(n, np.nan), np.full(n, np.nan))
    found = motion(
        rises(height),
        line.depth,
        state.branches,
        coefficients(lanes(law, 1), spacing / speed),
    )
    # where along +x each sample of the period lies
    back = np.roll(np.arange(n)[::-1], -int(np.argmax(height[::-1])))
    laid = Field(line, np.empty(n), np.empty(n))
    laid.surface[back], laid.force[back] = (np.asarray(x)[:, 0] for x in found)
    return laid
