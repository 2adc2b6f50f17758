"""Transient sliding of one body: from rest, with jumps of velocity and load."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import arrays, on_jax, on_numpy, xp
from ..call.several_materials import over_materials
from ..checks import is_traced, known, nan_unless, numpy_unless_traced
from ..element.law import as_foundation
from ..errors import ConvergenceWarning, InputError
from ..material.relaxation import Relaxation
from ..results.words import describe
from ..smooth.problem import BARE, LAYER, contact
from ..surface.lines import AbstractLines, SingleLine
from ..surface.rough_line import RoughLine
from ..surface.shapes import Cylinder
from .age import sliding_beyond
from .body_over_line import indenter, rough
from .contact_sizes import check_path, contact_sizes, shared_level
from .history_result import Slide
from .problem import LINE, GivenHistory, SlidePlan, describe_line, given_history
from .refinement import Levels, at_level, finest, refine
from .slide_march import Forces, march, padded
from .timeline import cut, timeline

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from ..call.types import Indenter, Materials

_ACROSS = 40  # elements over the contact on the coarsest level
# elements times steps times branches marched sooner than another program is compiled
_ROOM = 5e6


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
    per_length = isinstance(shape, RoughLine)
    foundation = as_foundation(material)
    if per_length and foundation.per_area:
        raise InputError(
            "material must be a half-space under a RoughLine, got a layer: give "
            "the material itself."
        )
    lines = None if per_length else contact(foundation, shape)[0]
    body: Any = shape if lines is None else lines
    history = given_history(
        foundation, time, position, load, depth, temperature, rtol, elements, per_length
    )
    found, plan = (
        on_jax(_rough, body, history) if lines is None else _indenter(lines, history)
    )
    model = (
        LINE
        if per_length
        else LAYER
        if foundation.per_area or isinstance(shape, Cylinder)
        else BARE
    )
    what = describe_line(shape) if per_length else describe(shape)
    inputs = [
        ("material", foundation.name or "given directly"),
        ("shape", what),
        *history.inputs,
    ]
    beyond = sliding_beyond(
        history, body, found.forces.depth, history.value, stacklevel=3
    )
    return _pack(
        history, found, plan, model, (*inputs, *beyond.said), per_length, beyond.points
    )


def _rough(shape: RoughLine, history: GivenHistory) -> tuple[Levels, SlidePlan]:
    """Marches one period under a rough line."""
    law = arrays(history.law)
    traced = history.traced or is_traced(shape)
    even = max(4, -(-history.elements // max(history.time.size - 1, 1)))
    spacing = (
        None if is_traced(history.position, history.value) else float(shape.spacing)
    )
    line = timeline(
        history.time, history.position, history.value, spacing, history.shortest, even
    )
    size: list[int] = []
    work = shape.count * line.part.size * max(law.times.size, 1)
    most = finest(work, traced)
    shared = shared_level(work, most, _ROOM)

    def solve(level: int) -> tuple[Forces, Any]:
        finer = 2**level
        room = max(finer, 2**shared)
        steps, last = cut(
            line, history.time, history.position, history.value, history.shortest, finer
        )
        surface = rough(
            xp.tile(shape._finer(finer), room // finer),
            shape.spacing / finer,
            xp.asarray(shape.highest),
        )
        steps_padded = padded(steps, line.part.size * room)
        forces, _ = march(
            law, surface, steps_padded, control=history.control, viscous=history.viscous
        )
        size[:] = shape.count * finer, steps.h.shape[0]
        return Forces(*(field[last] for field in known(forces))), np.bool_(True)

    found = refine(solve, history.rtol, most, shape.rms_slope)
    text = f"every element of the period of {float(shape.period):.4g} m can be touched"
    return found, SlidePlan(size[0], size[1], int(law.times.size), found.levels, text)


def _indenter(lines: AbstractLines, history: GivenHistory) -> tuple[Levels, SlidePlan]:
    """Marches the elements that an indenter can touch; more of them where it turns out
    to reach further.
    """
    if (
        not history.traced
        and not is_traced(lines)
        and not (np.asarray(history.value) > 0).any()
    ):
        return _apart(history)
    law = arrays(history.law)
    sizes = known(
        contact_sizes(
            law, lines, history.control, history.value, float(np.ptp(history.time))
        )
    )
    reach = 1.6 * sizes[1]
    while True:
        found, plan, outside = _within(lines, law, history, sizes, reach)
        if not outside or float(reach) > 30 * float(sizes[1]):
            return found, plan
        reach = 2 * reach


def _apart(history: GivenHistory) -> tuple[Levels, SlidePlan]:
    """A body that is never pressed down: no contact, hence no size of it either, by
    which to choose elements.
    """
    none = np.zeros(history.time.shape)
    depth = np.asarray(history.value) if history.control == "depth" else none
    found = Levels(
        Forces(depth, none, none, none, none),
        none * np.nan,
        none * np.nan,
        none == 0,
        0,
        none == 0,
    )
    return found, SlidePlan(
        0, 0, int(history.law.times.size), 0, "the body touches no element"
    )


def _within(
    lines: AbstractLines,
    law: Relaxation,
    history: GivenHistory,
    sizes: tuple[Any, Any],
    reach: Any,
) -> tuple[Levels, SlidePlan, bool]:
    """Marches the elements up to `reach` [m] from the body's path; whether the
    outermost of them were touched.
    """
    glassy, widest = sizes
    traced = history.traced or is_traced(lines)
    numpy = xp if is_traced(history.position) else np
    first, length = (
        numpy.min(history.position) - reach,
        numpy.ptp(history.position) + 2 * reach,
    )
    if traced:
        spacing, count = length / history.elements, history.elements
        even = max(4, -(-history.elements // max(history.time.size - 1, 1)))
        line = timeline(
            history.time, history.position, history.value, None, history.shortest, even
        )
    else:
        spacing = float(2 * math.sqrt(glassy * widest) / _ACROSS)
        check_path(float(length), spacing)
        count = 32 * math.ceil(float(length) / spacing / 32)
        line = timeline(
            history.time, history.position, history.value, spacing, history.shortest, 0
        )
    size, outside = [0, 0], [False]
    largest: Any = lines.shape.largest_contact
    deepest = np.inf
    if is_traced(largest) or not np.isinf(largest):
        deepest = xp.where(
            xp.isinf(largest), xp.inf, lines.depth(largest * (1 - 1e-12))
        )

    single = isinstance(lines, SingleLine)
    work = (
        count * line.part.size * max(law.times.size, 1) * (1 if single else count // 2)
    )
    most = finest(work, traced)
    shared = shared_level(work, most, _ROOM, 4.0 if single else 8.0)

    def solve(level: int) -> tuple[Forces, Any]:
        finer = 2**level
        room = finer if on_numpy() else max(finer, 2**shared)
        steps, last = cut(
            line, history.time, history.position, history.value, history.shortest, finer
        )
        surface = indenter(
            lines,
            first + 0.5 * spacing / finer,
            spacing / finer,
            count * room,
            reach * (room // finer),
        )
        given = steps if on_numpy() else padded(steps, line.part.size * room)
        forces, end = march(
            law, surface, given, control=history.control, viscous=history.viscous
        )
        forces, u = known((forces, end.u))
        size[:] = (
            count * finer * (1 if single else -(-count * finer // 2)),
            steps.h.shape[0],
        )
        # The outermost elements must never have been touched, else the body reaches
        # further than was thought.
        u = u.reshape(-1, count * room)
        inside = (u[:, 0] == 0).all() & (u[:, count * finer - 1] == 0).all()
        forces = Forces(*(field[last] for field in forces))
        if not is_traced(forces):
            outside[0] = not inside
        return forces, inside & (forces.depth < deepest)

    def solved(level: int) -> tuple[Forces, Any]:
        return at_level(solve, level, work * (4.0 if single else 8.0) ** level)

    found = refine(solved, history.rtol, most, lines.depth(widest) / widest)
    text = "elements that the body cannot touch are left out"
    return (
        found,
        SlidePlan(size[0], size[1], int(law.times.size), found.levels, text),
        outside[0],
    )


def _pack(
    history: GivenHistory,
    found: Levels,
    plan: Any,
    model: str,
    inputs: tuple[tuple[str, str], ...],
    per_length: bool,
    extrapolated: Any,
) -> Slide:
    numpy = xp if is_traced(found) else np
    if not is_traced(found) and not found.good.all():
        text = (
            f"{int((~found.good).sum())} of {found.good.size} points did not converge "
            f"to rtol={history.rtol:g}; "
        )
        warnings.warn(f"{text}they are NaN.", ConvergenceWarning, stacklevel=4)

    def shown(field: Any) -> Any:
        return nan_unless(found.shown, field)

    forces = found.forces
    gone = np.diff(history.time)
    speed = numpy.where(
        gone > 0, numpy.diff(history.position) / np.where(gone > 0, gone, 1.0), 0.0
    )
    velocity = numpy.concatenate([numpy.zeros(1), speed])
    return Slide(
        time=history.time,
        position=history.position,
        velocity=velocity,
        mu=shown(found.mu),
        normal_force=shown(forces.normal),
        friction_force=shown(forces.drag),
        depth=shown(forces.depth),
        work=shown(forces.work),
        stored=shown(forces.stored),
        dissipated=shown(forces.work - forces.stored),
        error=shown(found.error),
        converged=found.good,
        per_length=per_length,
        model=model,
        plan=plan,
        inputs=inputs,
        extrapolated=extrapolated,
    )
