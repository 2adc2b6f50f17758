"""Where a rough line touches the rubber it slides over."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ..call.extrapolation import excited_outside, rough_beyond
from ..call.model_choice import is_rough, of_line
from ..call.problem import Asked
from ..call.several_materials import over_materials
from ..checks import in_float64, warn_unless
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..models import seeds_of
from ..results.doubts import Doubt, carried
from ..smooth.problem import BARE
from ..surface.rough_line import RoughLine
from .ensemble import LinePoints
from .free_steps import line_law
from .line import surface_words
from .line_problem import RoughScene, check
from .period import coefficients, motion
from .periodic import Job, SolvedLine, rises, solve_states
from .problem import RoughCall, not_rough
from .results import LineContact

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import Number
    from ..call.types import Material, ModelLike, Surface
    from ..models import Line


@over_materials
@in_float64
def line_contact(
    material: Material,
    surface: Surface,
    *,
    velocity: Number,
    load: Number | None = None,
    depth: Number | None = None,
    pressure: Number | None = None,
    temperature: Number | None = None,
    model: Line | Literal["line"] | None = None,
    rtol: float = 1e-6,
) -> LineContact:
    """Heights, rubber surface and contact along a rough line at one velocity, load and
    temperature.

    The line is that of the first seed of the model, in its own direction: the direction
    average has no single field.

    Args:
        material: as for `em.friction`, a series.
        surface: an `em.RoughLine`, or a surface.
        velocity: sliding velocity [m/s], a single number as all other arguments.
        load: normal force per length of line [N/m].
        depth: depth [m] in place of a load.
        pressure: nominal pressure on a surface [Pa], in place of a load.
        temperature: temperature [K], for a material with a shift law.
        model: `em.Line(...)`.
        rtol: as for `em.friction`.

    Returns:
        An `em.LineContact`. What touches is the contact of the MDR line, not the real
        contact of the surface. A point that does not converge is NaN, with one
        `ConvergenceWarning`.

    Raises:
        InputError: as `em.friction` with `model=em.Line(...)`.

    Exact for the line. Not differentiable.
    """
    model = _check(surface, model)
    solid: Any = material  # `over_materials` has taken a list apart
    asked = Asked(velocity, load, depth, pressure, temperature)
    scene = check(RoughCall(solid, surface, asked, rtol), model)
    points = scene.at
    for name, value in vars(asked).items():
        if np.size(value) != 1:
            raise InputError(argument=name, got=value, accepted="a single number")
    ask = LinePoints(np.ravel(points.reduced), scene.given, scene.control, float(rtol))
    field = _field(ask.on(scene.lines[0]), points.foundation.law())
    warn_unless(field.line.converged, "points")
    known = points.foundation.range
    outside = excited_outside(known, surface, points.reduced.reshape(()))
    beyond = rough_beyond(known, outside, points.temperature, ())
    return _report(scene, surface, field, beyond)


def _check(surface: Surface, model: ModelLike | None) -> Line:
    """The model with its first seed. Raises `InputError`."""
    if not is_rough(surface):
        raise not_rough(surface)
    model = of_line(model, "line_contact")
    if model.average:
        raise InputError(
            argument="model",
            got=model,
            accepted="em.Line() without average in em.line_contact",
            hint="the average has no single field",
        )
    return dataclasses.replace(
        model, seeds=1 if isinstance(surface, RoughLine) else seeds_of(model.seeds)[:1]
    )


def _report(
    scene: RoughScene, surface: Surface, field: _Field, beyond: tuple[Doubt, ...]
) -> LineContact:
    """The result: one error, one flag at every sample."""
    (line,) = scene.lines
    height, vertical = np.asarray(line.height), float(scene.at.vertical.ravel()[0])
    mu, load, depth, share, error = (
        float(getattr(field.line, name)[0])
        for name in ("mu", "load", "depth", "share", "error")
    )
    inputs = scene.inputs(("surface", surface_words(surface, line)))
    return LineContact(
        x=np.asarray(line.x),
        height=height - height.max() + depth,
        surface=field.surface,
        force=vertical * field.force,
        touching=field.force > 0,
        mu=mu,
        load=vertical * load,
        depth=depth,
        share=share,
        error=np.full(height.size, error),
        model_error=np.full(height.size, np.nan),
        converged=np.full(height.size, bool(field.line.converged[0])),
        marks=carried(beyond, lambda points: np.full(height.size, points)),
        model=BARE + scene.rule,
        plan=f"one periodic state of {height.size} samples",
        inputs=tuple(inputs),
    )


class _Field(NamedTuple):
    """The line and the rubber at each sample, along +x.

    Every element sees the same history, so that what one element does in time is what
    the line shows in space, read against the motion.
    """

    line: SolvedLine  # of one point
    surface: Float[np.ndarray, " n"]  # u, how far the rubber is pushed back [m]
    # q, force per length of line [N/m]; 0 out of contact
    force: Float[np.ndarray, " n"]


def _field(job: Job, law: Relaxation) -> _Field:
    """Solves one velocity and lays its period out along the line; NaN where it did not
    converge.
    """
    line, state = solve_states(job, law)
    height, n = job.height, job.height.size
    if not line.converged[0]:
        return _Field(line, np.full(n, np.nan), np.full(n, np.nan))
    one_period = motion(
        rises(height),
        line.depth,
        state.branches,
        coefficients(line_law(law), job.spacing / job.velocity),
    )
    # where along +x each sample of the period lies
    back = np.roll(np.arange(n)[::-1], -int(np.argmax(height[::-1])))
    laid = _Field(line, np.empty(n), np.empty(n))
    laid.surface[back], laid.force[back] = (np.asarray(x)[:, 0] for x in one_period)
    return laid
