"""A rough line and the rubber it slides over, at each sample of the line, from the
periodic state that `em.friction` with `em.Line()` solves for.
"""

from typing import NamedTuple

import numpy as np

import elastomdr as em
from elastomdr.call.problem import Asked
from elastomdr.checks import in_float64
from elastomdr.rough.ensemble import LinePoints
from elastomdr.rough.free_steps import line_law
from elastomdr.rough.line_problem import check
from elastomdr.rough.period import coefficients, motion
from elastomdr.rough.periodic import rises, solve_states
from elastomdr.rough.problem import RoughCall


class LineField(NamedTuple):
    """Heights and surface count from the undeformed rubber, positive into it."""

    x: np.ndarray  # [m], along the motion of the line
    height: np.ndarray  # [m]
    surface: np.ndarray  # u [m]
    force: np.ndarray  # q, 0 out of contact [N/m]
    mu: float
    load: float  # [N/m]
    depth: float  # of the highest point [m]
    error: float  # of mu
    converged: bool


@in_float64
def line_field(
    law: em.Foundation, surface: em.SelfAffine, samples: int | None, **asked: float
) -> LineField:
    """The line of one seed at one velocity and pressure."""
    scene = check(
        RoughCall(law, surface, Asked(**asked), 1e-6), em.Line(samples=samples)
    )
    points = LinePoints(np.ravel(scene.at.reduced), scene.given, scene.control, 1e-6)
    job, relaxation = points.on(scene.lines[0]), law.law()
    line, state = solve_states(job, relaxation)
    mu, load, depth, error = (
        float(x[0]) for x in (line.mu, line.load, line.depth, line.error)
    )
    height, n = job.height, job.height.size
    one_period = motion(
        rises(height),
        line.depth,
        state.branches,
        coefficients(line_law(relaxation), job.spacing / job.velocity),
    )
    # where along +x each sample of the period lies
    back = np.roll(np.arange(n)[::-1], -int(np.argmax(height[::-1])))
    u, q = np.empty((2, n))
    u[back], q[back] = (np.asarray(x)[:, 0] for x in one_period)
    x = np.asarray(scene.lines[0].x)
    raised = height - height.max() + depth
    return LineField(x, raised, u, q, mu, load, depth, error, bool(line.converged[0]))
