"""Coupled dynamics: a body on springs and dampers, driven over rubber, in one solve
with its contact.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import arrays, xp
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    is_traced,
    nan_unless,
    numpy_unless_traced,
    warn_unless,
)
from ..element.body_over_line import AbstractOverLine, Indenter, rough
from ..element.moving_body import Mount
from ..errors import InputError
from ..results.doubts import Doubt
from ..results.words import brief
from ..surface.lines import AbstractLines, SingleLine
from ..surface.rough_line import RoughLine, spline_coefficients
from ..surface.shapes import AbstractShape
from .age import sliding_beyond
from .history_result import Drive
from .march import MotionHistory
from .problem import (
    GivenHistory,
    SlidePlan,
    SlidingBody,
    describe_line,
    even_steps,
    given_history,
    sliding_body,
)
from .refinement import Cut, Levels, contact_sizes, solve_levels, widened

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from ..call.types import Materials

_ACROSS = 24  # elements over the contact on the coarsest level
_FINEST = 4  # levels beyond the coarsest, unless they are short
_LONG = 1e9  # elements times steps times branches of what is not short: half a minute
# elements times steps times branches marched sooner than another program is compiled
_ROOM = 3e8
_EARLY = 4.0  # ratio of the instants that divide the first interval
_MOST_EARLY, _TRACED_EARLY = 40, 12
# steps per period of a mass on its spring and the contact, on the coarsest level
_PERIOD = 12


@over_materials
@numpy_unless_traced
def drive(
    material: Materials,
    shape: AbstractShape | RoughLine,
    *,
    time: ArrayLike,
    position: ArrayLike,
    load: ArrayLike,
    tangential: Mount | None = None,
    normal: Mount | None = None,
    track: RoughLine | None = None,
    temperature: Number | None = None,
    rtol: float = 1e-2,
    elements: int | None = None,
) -> Drive:
    """Motion of a body that is driven over rubber through springs and dampers, together
    with its contact.

        tangential mount:  m X'' = k (D - X) + c (D' - X') - F_x         without one: X = D
        normal mount:      m d'' = P - k d - c d' - F_N                  without one: F_N = P

    X is the place of the body and d its depth; the drive stands at D(t) and the load is
    P(t), both linear between the instants. The body is put down at once, at rest, with
    the load of the first instant, on rubber that was never touched.

    Args:
        material: a material (then a half-space of it), or a `Foundation` (two bodies, a
            layer).
        shape: an indenter, or an `em.RoughLine` (then loads, masses, stiffnesses and
            dampings are per metre of line).
        time: instants [s], ascending, shape (n,).
        position: place D of the drive at these instants [m], shape (n,).
        load: P [N, or N/m], a number or one for each instant.
        tangential: `em.Mount(mass, stiffness, damping)` through which the drive pulls.
        normal: `em.Mount` that carries the body vertically; its spring is free at d =
            0.
        track: a rough line that belongs to the rubber, under an indenter; heights
            towards the body.
        temperature: one temperature [K], for a material with a shift law.
        rtol: error of mu, depth and normal force to be met, relative to their largest
            values, and of the energy balance, relative to the work done; 1e-1 to 1e-6.
            The place of the body is not held to it.
        elements: number of elements, as for `em.slide`.

    Returns:
        An `em.Drive` with one value for each instant. Instants that do not converge are
        NaN with `converged=False`; one `ConvergenceWarning` counts them.

    Raises:
        InputError: for instants that do not ascend, arguments whose lengths do not
            match, a track under a rough line, and a motion that would take too long,
            with the part of it that would not.

    The bare line of the textbook, in steps of second order. Differentiable with respect
    to material and mounts, in reverse as well, which keeps a state every 64 steps: 400
    instants, 20 branches and 256 elements take 1.6 GB, and 21 s of one core once
    compiled.

    Source: Popov & Hess 2015, ch. 7, 10 and 19; `docs/theory.md`.
    """
    body = sliding_body(material, shape)
    if track is not None and (body.per_length or not isinstance(track, RoughLine)):
        raise InputError(
            argument="track",
            got=track,
            accepted="an em.RoughLine under an indenter, left out under a rough line",
        )
    if not isinstance(body.over, (RoughLine, SingleLine)):
        raise InputError(
            argument="material",
            got=material,
            accepted="a half-space under this shape",
            hint="on a layer em.drive takes an em.Cylinder",
        )
    mounts = {"tangential": tangential, "normal": normal}
    for name, mount in mounts.items():
        if not isinstance(mount, Mount | None):
            accepted = "an em.Mount(mass, stiffness, damping)"
            raise InputError(argument=name, got=mount, accepted=accepted)
    given = (time, position, load, None, temperature, rtol, elements)
    history = given_history(body, *given, mounts, track)
    if (np.diff(history.time) <= 0).any():
        raise InputError(
            argument="time",
            got=history.time,
            accepted="ascending, without repeats",
            hint="bodies with a mass have no jumps",
        )
    solution, plan = _solve(body.over, history, list(mounts.values()), track)
    inputs = [
        *body.words,
        *(
            (f"{name} mount", _in_words(mount, body.per_length))
            for name, mount in mounts.items()
            if mount is not None
        ),
    ]
    if track is not None:
        inputs.append(("track", describe_line(track)))
    deep = solution.seen.depth
    beyond = sliding_beyond(history, body.over, deep, deep)
    inputs = (*inputs, *history.inputs)
    return _report(history, solution, mounts["tangential"], body, plan, inputs, beyond)


def _in_words(mount: Mount, per_length: bool) -> str:
    per = "/m" if per_length else ""
    values = ((mount.mass, "kg"), (mount.stiffness, "N/m"), (mount.damping, "N s/m"))
    return ", ".join(brief(v, unit + per) for v, unit in values)


def _solve(
    body: RoughLine | AbstractLines,
    history: GivenHistory,
    mounts: list[Any],
    track: RoughLine | None,
) -> tuple[Levels, SlidePlan]:
    """Marches at finer and finer levels; more elements where the body turns out to
    reach further.
    """
    law = arrays(history.law)
    traced = history.traced
    if isinstance(body, RoughLine):
        grid = _Grid(body.count, body.spacing, xp.zeros(()))
        slope = body.rms_slope
        return _on_grid(body, history, mounts, track, grid, slope, traced)[:2]
    load, duration = xp.asarray(history.value), float(np.ptp(history.time))
    glassy, widest = contact_sizes(law, body, "load", load, duration)
    # no contact, of which to choose elements
    if not traced and not np.any(history.value > 0):
        glassy = widest = xp.asarray(max(float(np.ptp(history.position)), 1e-6))
    spacing = 2 * xp.sqrt(glassy * widest) / _ACROSS
    if track is not None:
        wanted, spacing = spacing, track.spacing
        if not traced:
            spacing = spacing / math.ceil(float(spacing) / float(wanted))
    slope = body.depth(widest) / widest

    def within(reach: Array) -> tuple[Levels, SlidePlan, bool]:
        place = xp.asarray(history.position)
        low, high = xp.min(place) - reach, xp.max(place) + reach
        if traced:
            grid = _Grid(history.elements, (high - low) / history.elements, low)
        else:
            count = 32 * math.ceil(float(high - low) / float(spacing) / 32)
            path = float(np.ptp(history.position)) / float(high - low)
            grid = _Grid(count, spacing, low, path)
        return _on_grid(body, history, mounts, track, grid, slope, traced)

    return widened(within, 2 * widest, widest)


class _Grid(NamedTuple):
    """Elements on the coarsest level, along the path from `low` on."""

    elements: int
    spacing: Any  # [m]
    low: Any  # [m]
    moving: float = 0.0  # share of the path in that


def _on_grid(
    body: RoughLine | AbstractLines,
    history: GivenHistory,
    mounts: list[Any],
    track: RoughLine | None,
    grid: _Grid,
    slope: Array,
    traced: bool,
) -> tuple[Levels, SlidePlan, bool]:
    """Marches elements from where the drive comes; whether the outermost of them were
    touched.
    """
    samples = 8 if traced else _samples(history, grid.spacing, mounts)
    shortest, early = _early(history)
    given = (history.time, xp.asarray(history.position), xp.asarray(history.value))
    cut = Cut(
        surface=lambda finer, room: _surface(body, track, grid, finer, room),
        steps=lambda finer: even_steps(*given, shortest, early, samples * finer),
        elements=grid.elements,
        strips=1,
        most_steps=samples * (history.time.size - 1 + early),
        traced=traced,
        endless=isinstance(body, RoughLine),
        skipped="elements that cannot be touched are left out",
        mounts=mounts,
        room=_ROOM,
        long=(_LONG, _FINEST),
        moving=grid.moving,
    )
    return solve_levels(history, cut, slope, missing=_missing)


def _samples(history: GivenHistory, spacing: Array | float, mounts: list[Any]) -> int:
    """Contact steps between two instants: none moves further than an element, and a
    mass on its spring is followed.
    """
    step = np.diff(history.time)
    most = float((np.abs(np.diff(history.position)) / float(spacing)).max())
    for mount in mounts:
        if mount is not None:
            rate = math.sqrt(float(mount.stiffness) / float(mount.mass)) + float(
                mount.damping / mount.mass
            )
            most = max(most, _PERIOD * float(step.max()) * rate / (2 * math.pi))
    # few numbers, so that few programs are compiled
    return 2 ** math.ceil(math.log2(max(2.0, most)))


def _early(history: GivenHistory) -> tuple[Any, int]:
    """The shortest time [s], and by how many instants the first interval is divided
    down to it.
    """
    if not is_traced(history.law, history.position, history.value):
        ratio = float(history.time[1] - history.time[0]) / history.shortest
        return history.shortest, min(
            _MOST_EARLY, max(0, math.ceil(math.log(ratio) / math.log(_EARLY)))
        )
    law = history.law
    times = xp.where(xp.asarray(law.moduli) > 0, xp.asarray(law.times), xp.inf)
    return xp.minimum(xp.min(times, initial=xp.inf), history.shortest), _TRACED_EARLY


def _surface(
    body: RoughLine | AbstractLines,
    track: RoughLine | None,
    grid: _Grid,
    finer: int,
    room: int,
) -> AbstractOverLine:
    """The body over `finer` elements for each of the grid, with `room` for more:
    further places, or periods of a rough line.
    """
    spacing = xp.asarray(grid.spacing / finer)
    if isinstance(body, RoughLine):
        height = xp.tile(body._finer(finer), room // finer)
        return rough(height, spacing, xp.asarray(body.highest))
    x = grid.low + spacing * (xp.arange(grid.elements * room) + 0.5)
    weight = spacing * body.weight(xp.ones(1))[0, 0]
    height = xp.zeros(()) if track is None else _heights(track, x)
    return Indenter(weight, spacing, body.shape, x, None, height)


def _heights(track: RoughLine, x: Array) -> Any:
    """Heights of the track at the places x, counted from its highest point."""
    coefficients = arrays(spline_coefficients(track.height))
    whole = xp.floor(x / track.spacing)
    t = x / track.spacing - whole
    i = whole.astype(xp.int64)
    weights = (
        (1 - t) ** 3 / 6,
        (4 - 6 * t**2 + 3 * t**3) / 6,
        (4 - 6 * (1 - t) ** 2 + 3 * (1 - t) ** 3) / 6,
        t**3 / 6,
    )
    total = sum(
        w * coefficients[xp.mod(i + m - 1, track.count)] for m, w in enumerate(weights)
    )
    return total - track.highest


def _missing(seen: MotionHistory) -> tuple[Any, Any]:
    """What the energy balance does not find at each instant, and the largest work that
    was done [J].
    """
    given = seen.driven + seen.pressed
    spent = seen.kinetic + seen.spring + seen.work + seen.damped
    return given - spent, xp.max(xp.maximum(xp.abs(given), xp.abs(spent)))


def _report(
    history: GivenHistory,
    solution: Levels,
    tangential: Mount | None,
    body: SlidingBody,
    plan: SlidePlan,
    inputs: tuple[tuple[str, str], ...],
    beyond: tuple[Doubt, ...],
) -> Drive:
    warn_unless(solution.good, "instants", f" to rtol={history.rtol:g}")

    def shown(field: Array) -> Any:
        return nan_unless(solution.shown, field)

    seen = solution.seen
    pull = seen.drag
    if tangential is not None:
        pull = tangential.stiffness * (history.position - seen.position)
    return Drive(
        time=history.time,
        drive=history.position,
        position=shown(seen.position),
        velocity=shown(seen.velocity),
        depth=shown(seen.depth),
        mu=shown(solution.mu),
        normal_force=shown(seen.normal),
        friction_force=shown(seen.drag),
        pull=shown(pull),
        given=shown(seen.driven + seen.pressed),
        kinetic=shown(seen.kinetic),
        stored=shown(seen.stored + seen.spring),
        dissipated=shown(seen.work - seen.stored + seen.damped),
        imbalance=shown(_missing(seen)[0]),
        error=shown(solution.error),
        model_error=body.bound.at(solution.shown),
        converged=solution.good,
        per_length=body.per_length,
        model=body.model,
        plan=plan,
        inputs=inputs,
        marks=(
            *beyond,
            *body.bound.marks(solution.shown),
            *body.doubt_depth(shown(seen.depth)),
        ),
    )
