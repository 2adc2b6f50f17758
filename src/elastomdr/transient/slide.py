"""Transient sliding of one body: from rest, with jumps of velocity and load."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import arrays, xp
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    is_traced,
    known,
    nan_unless,
    numpy_unless_traced,
    warn_unless,
)
from ..element.body_over_line import indenter, rough
from ..errors import InputError, amount
from ..surface.lines import AbstractLines, SingleLine
from ..surface.rough_line import RoughLine
from .age import sliding_beyond
from .history_result import Slide
from .march import MotionHistory
from .problem import (
    GivenHistory,
    SlidePlan,
    Timeline,
    cut,
    given_history,
    sliding_body,
    timeline,
)
from .refinement import Cut, Levels, contact_sizes, solve_levels, widened

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from ..call.types import Indenter, Materials

_STEPS = 1e6  # along a path: more than anybody waits for
_ACROSS = 40  # elements over the contact on the coarsest level


@over_materials
@numpy_unless_traced
def slide(
    material: Materials,
    shape: Indenter | RoughLine,
    *,
    time: ArrayLike,
    position: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    temperature: Number | None = None,
    rtol: float = 1e-3,
    elements: int | None = None,
) -> Slide:
    """Sliding of a body over rubber at rest, through any history of position and load,
    or of position and depth.

    The history is linear between the instants. At the first one the body is put down,
    at once, with the load or depth given there, on rubber that was never touched. Where
    two instants are equal, load or depth jump.

    Args:
        material: a material (then a half-space of it), or a `Foundation` (two bodies, a
            layer).
        shape: an indenter, or an `em.RoughLine`, whose load and forces are means per
            length of line [N/m].
        time: instants [s], ascending, equal neighbours allowed, shape (n,).
        position: place of the body at these instants [m], shape (n,).
        load: normal force [N, or N/m], a number or one for each instant.
        depth: indentation depth [m], in place of a load, likewise.
        temperature: one temperature [K], for a material with a shift law.
        rtol: error of mu to be met, relative to the largest mu of the history (or to
            0.03 of the slope of the body, if that is more), 1e-1 to 1e-6.
        elements: number of elements of the coarser of two levels, needed under
            `jax.jit`, `grad` and `vmap`, where the size of the contact is not known
            beforehand (`time` must be plain numbers there).

    Returns:
        An `em.Slide` with one value for each instant. Points that do not converge are
        NaN with `converged=False`; one `ConvergenceWarning` counts them.

    Raises:
        InputError: for instants that descend, arguments whose lengths do not match, and
            neither or both of load and depth.

    Exact for the bare line of the textbook, to which a direction average does not
    apply: it is defined for steady motion only. Long slides end in `em.friction(...,
    model=em.Line())`.

    Source: Popov & Hess 2015, ch. 7; `docs/theory.md`.
    """
    body = sliding_body(material, shape)
    given = (time, position, load, depth, temperature, rtol, elements)
    history = given_history(body, *given)
    solve: Any = _rough if body.per_length else _indenter
    solution, plan = solve(body.over, history)
    seen = solution.seen
    beyond = sliding_beyond(history, body.over, seen.depth, history.value)
    bound = body.bound
    warn_unless(solution.good, "points", f" to rtol={history.rtol:g}")

    def shown(field: Array) -> Any:
        return nan_unless(solution.shown, field)

    return Slide(
        time=history.time,
        position=history.position,
        velocity=_velocity(history),
        mu=shown(solution.mu),
        normal_force=shown(seen.normal),
        friction_force=shown(seen.drag),
        depth=shown(seen.depth),
        work=shown(seen.work),
        stored=shown(seen.stored),
        dissipated=shown(seen.work - seen.stored),
        error=shown(solution.error),
        model_error=bound.at(solution.shown),
        converged=solution.good,
        per_length=body.per_length,
        model=body.model,
        plan=plan,
        inputs=(*body.words, *history.inputs),
        marks=(
            *beyond,
            *bound.marks(solution.shown),
            *body.doubt_depth(shown(seen.depth)),
        ),
    )


def _velocity(history: GivenHistory) -> Any:
    """Of the body before each instant [m/s]; zero at the first, and at jumps."""
    gone = np.diff(history.time)
    speed = xp.diff(history.position) / np.where(gone > 0, gone, 1.0)
    return xp.concatenate([np.zeros(1), xp.where(gone > 0, speed, 0.0)])


def _rough(shape: RoughLine, history: GivenHistory) -> tuple[Levels, SlidePlan]:
    """Marches one period under a rough line."""
    known_path = not is_traced(history.position, history.value)
    line, steps = _steps(history, float(shape.spacing) if known_path else None)

    def surface(finer: int, room: int) -> Any:
        height = xp.tile(shape._finer(finer), room // finer)
        return rough(height, shape.spacing / finer, xp.asarray(shape.highest))

    skipped_because = (
        f"every element of the period of {float(shape.period):.4g} m can be touched"
    )
    resolution = Cut(
        surface=surface,
        steps=steps,
        elements=shape.count,
        strips=1,
        most_steps=line.share.size,
        traced=history.traced,
        endless=True,
        skipped=skipped_because,
    )
    return solve_levels(history, resolution, shape.rms_slope)[:2]


def _steps(history: GivenHistory, spacing: float | None) -> tuple[Timeline, Any]:
    """The coarsest steps, one at most per `spacing` [m], and those of finer levels.
    Raises `InputError` for more of them than anybody waits for.
    """
    if spacing is not None:
        way = float(np.abs(np.diff(history.position)).sum())
        if not way <= _STEPS * spacing:
            raise InputError(
                argument="position",
                got=way,
                accepted="a way of at most "
                + amount(_STEPS * spacing, "m", 3)
                + " (a scene's stages), "
                f"which are {_STEPS:g} elements as wide as the contact asks for",
                hint="for steady sliding take em.friction(..., model=em.Line())",
            )
    even = max(4, -(-history.elements // max(history.time.size - 1, 1)))
    given = (history.time, history.position, history.value)
    line = timeline(*given, spacing, history.shortest, even)
    return line, lambda finer: cut(line, *given, history.shortest, finer)


def _indenter(lines: AbstractLines, history: GivenHistory) -> tuple[Levels, SlidePlan]:
    """Marches the elements that an indenter can touch; more of them where it turns out
    to reach further.
    """
    if not history.traced and not (np.asarray(history.value) > 0).any():
        return _apart(history)
    law, duration = arrays(history.law), float(np.ptp(history.time))
    sizes = known(contact_sizes(law, lines, history.control, history.value, duration))

    def within(reach: Array | float) -> tuple[Levels, SlidePlan, bool]:
        return _solve(lines, history, sizes, reach)

    return widened(within, 1.6 * sizes[1], sizes[1])


def _apart(history: GivenHistory) -> tuple[Levels, SlidePlan]:
    """A body that is never pressed down: no contact, hence no size of it either, by
    which to choose elements.
    """
    none = np.zeros(history.time.shape)
    depth = np.asarray(history.value) if history.control == "depth" else none
    seen = MotionHistory(*[none] * len(MotionHistory._fields))._replace(depth=depth)
    no_mu, all_of_them = none * np.nan, none == 0
    solution = Levels(seen, no_mu, no_mu, all_of_them, 0, all_of_them)
    branches = int(history.law.times.size)
    skipped_because = "the body touches no element"
    return solution, SlidePlan(0, 0, branches, 0, skipped_because)


def _solve(
    lines: AbstractLines,
    history: GivenHistory,
    sizes: tuple[Any, Any],
    reach: Array | float,
) -> tuple[Levels, SlidePlan, bool]:
    """Marches the elements up to `reach` [m] from the body's path; whether the
    outermost of them were touched.
    """
    glassy, widest = sizes
    first = xp.min(history.position) - reach
    length = xp.ptp(history.position) + 2 * reach
    if history.traced:
        spacing, count = length / history.elements, history.elements
        line, steps = _steps(history, None)
    else:
        spacing = float(2 * math.sqrt(glassy * widest) / _ACROSS)
        count = 32 * math.ceil(float(length) / spacing / 32)
        line, steps = _steps(history, spacing)

    def surface(finer: int, room: int) -> Any:
        first_place, width = first + 0.5 * spacing / finer, reach * (room // finer)
        return indenter(lines, first_place, spacing / finer, count * room, width)

    resolution = Cut(
        surface=surface,
        steps=steps,
        elements=count,
        strips=1 if isinstance(lines, SingleLine) else count // 2,
        most_steps=line.share.size,
        traced=history.traced,
        endless=False,
        skipped="elements that the body cannot touch are left out",
        moving=0.0
        if history.traced
        else float(np.ptp(history.position)) / float(length),
    )
    slope = lines.depth(widest) / widest
    return solve_levels(history, resolution, slope, deepest=_deepest(lines))


def _deepest(lines: AbstractLines) -> Any:
    """The depth [m] at which the contact reaches the end of the body."""
    largest: Any = lines.shape.largest_contact
    if not is_traced(largest) and np.isinf(largest):
        return np.inf
    depth = lines.depth(largest * (1 - 1e-12))
    return xp.where(xp.isinf(largest), xp.inf, depth)
