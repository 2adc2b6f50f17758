"""Coupled dynamics: a body on springs and dampers, driven over rubber, in one solve
with its contact.
"""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import arrays, mapped, on_jax, on_numpy, xp
from ..call.several_materials import over_materials
from ..checks import (
    is_traced,
    nan_unless,
    not_negative,
    numpy_unless_traced,
    positive,
    scalar,
)
from ..element.law import as_foundation
from ..errors import ConvergenceWarning, InputError
from ..results.words import brief, describe
from ..smooth.problem import BARE, LAYER, contact
from ..surface.lines import AbstractLines, SingleLine
from ..surface.rough_line import RoughLine, spline_coefficients
from ..surface.shapes import AbstractShape, Cylinder
from .age import sliding_beyond
from .body_motion import History, Scene, run
from .body_over_line import AbstractOverLine, Indenter, rough
from .contact_sizes import check_path, contact_sizes, shared_level
from .history_result import Drive
from .mount import Mount
from .problem import LINE, GivenHistory, SlidePlan, describe_line, given_history
from .refinement import Levels, at_level, finest, refine

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from ..call.types import Materials

_ACROSS = 24  # elements over the contact on the coarsest level
_FINEST = 4  # levels beyond the coarsest, unless they are short
_LONG = 1e9  # elements times steps times branches of what is not short: half a minute
# elements times steps times branches marched sooner than another program is compiled
_ROOM = 3e7
# a step takes NumPy so many times as long as one of em.slide: the motion of the body is
# sought in it
_SLOWER = 4.0
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
            match, and a track under a rough line.

    The bare line of the textbook, in steps of second order.

    Source: Popov & Hess 2015, ch. 7, 10 and 19; `docs/theory.md`.
    """
    foundation = as_foundation(material)
    per_length = isinstance(shape, RoughLine)
    if track is not None and (per_length or not isinstance(track, RoughLine)):
        raise InputError(
            "track must be an em.RoughLine under an indenter; under a rough line "
            "there is no track."
        )
    if per_length and foundation.per_area:
        raise InputError(
            "material must be a half-space under a RoughLine, got a layer: give "
            "the material itself."
        )
    lines = None if per_length else contact(foundation, shape)[0]
    if lines is not None and not isinstance(lines, SingleLine):
        raise InputError(
            "material must be a half-space under this shape; on a layer em.drive "
            "takes an em.Cylinder."
        )
    history = given_history(
        foundation, time, position, load, None, temperature, rtol, elements, per_length
    )
    if (np.diff(history.time) <= 0).any():
        raise InputError(
            "time must ascend without repeats: bodies with a mass have no jumps."
        )
    mounts = [
        _mount(name, mount)
        for name, mount in (("tangential", tangential), ("normal", normal))
    ]
    body: Any = shape if lines is None else lines
    found, size = (
        on_jax(_solve, body, history, mounts, None)
        if per_length
        else _solve(body, history, mounts, track)
    )
    model = LINE if per_length else LAYER if isinstance(shape, Cylinder) else BARE
    what = describe_line(shape) if per_length else describe(shape)
    inputs = [("material", foundation.name or "given directly"), ("shape", what)]
    inputs += [
        (f"{name} mount", _in_words(mount, per_length))
        for name, mount in (("tangential", tangential), ("normal", normal))
        if mount is not None
    ]
    if track is not None:
        inputs.append(("track", describe_line(track)))
    left_out = "elements that cannot be touched are left out"
    plan = SlidePlan(
        size[0], size[1], int(history.law.times.size), found.levels, left_out
    )
    deep = found.forces.depth
    beyond = sliding_beyond(history, body, deep, deep, stacklevel=4)
    inputs = (*inputs, *history.inputs, *beyond.said)
    return _pack(history, found, mounts, plan, model, inputs, per_length, beyond.points)


def _mount(name: str, mount: Any) -> Mount | None:
    if mount is None:
        return None
    if not isinstance(mount, Mount):
        raise InputError(
            f"{name} must be an em.Mount(mass, stiffness, damping), got {mount!r}."
        )
    mass, stiffness, damping = (
        scalar(f"{name} {k}", getattr(mount, k))
        for k in ("mass", "stiffness", "damping")
    )
    positive(f"{name} mass", mass)
    not_negative(f"{name} stiffness", stiffness)
    not_negative(f"{name} damping", damping)
    return Mount(mass, stiffness, damping)


def _in_words(mount: Mount, per_length: bool) -> str:
    per = "/m" if per_length else ""
    values = ((mount.mass, "kg"), (mount.stiffness, "N/m"), (mount.damping, "N s/m"))
    return ", ".join(
        brief(np.asarray(v) if not is_traced(v) else v, unit + per)
        for v, unit in values
    )


def _solve(
    body: RoughLine | AbstractLines,
    history: GivenHistory,
    mounts: list[Any],
    track: RoughLine | None,
) -> tuple[Levels, list[int]]:
    """Marches at finer and finer levels; more elements where the body turns out to
    reach further.
    """
    law = arrays(history.law)
    load = xp.asarray(history.value)
    traced = history.traced or is_traced(body, mounts, track)
    gone = float(np.ptp(history.time))
    reach, spacing, widest = 0.0, None, 1.0
    slope = body.rms_slope if isinstance(body, RoughLine) else None
    if isinstance(body, AbstractLines):
        glassy, widest = contact_sizes(law, body, "load", load, gone)
        # no contact, of which to choose elements
        if not traced and not np.any(history.value > 0):
            glassy = widest = xp.asarray(max(float(np.ptp(history.position)), 1e-6))
        reach, spacing = (
            2 * widest,
            (
                track.spacing
                if track is not None
                else 2 * xp.sqrt(glassy * widest) / _ACROSS
            ),
        )
        slope = body.depth(widest) / widest
        if track is not None and not traced:
            spacing = spacing / math.ceil(
                float(spacing) * _ACROSS / float(2 * xp.sqrt(glassy * widest))
            )
    while True:
        found, size, outside = _within(
            body, history, law, mounts, track, spacing, reach, slope
        )
        if not outside or float(reach) > 30 * float(widest):
            return found, size
        reach = 2 * reach


def _within(
    body: RoughLine | AbstractLines,
    history: GivenHistory,
    law: Any,
    mounts: list[Any],
    track: Any,
    spacing: Any,
    reach: Any,
    slope: Any,
) -> tuple[Levels, list[int], bool]:
    """Marches elements up to `reach` [m] from where the drive comes; whether the
    outermost of them were touched.
    """
    time, place, load = (
        xp.asarray(x) for x in (history.time, history.position, history.value)
    )
    traced = history.traced or is_traced(body, mounts, track)
    low, high = xp.min(place) - reach, xp.max(place) + reach
    if isinstance(body, RoughLine):
        count, spacing = body.count, body.spacing
    elif traced:
        count = history.elements
        spacing = (high - low) / count
    else:
        check_path(float(high - low), float(spacing))
        count = 32 * math.ceil(float(high - low) / float(spacing) / 32)
    samples = 8 if traced else _samples(history, spacing, mounts, law)
    shortest, early = _early(history)
    size, outside = [0, 0], [False]
    work = count * samples * (history.time.size + early) * max(law.times.size, 1)
    most = finest(work, traced)
    most = most if 4.0**most * work <= _LONG else min(_FINEST, most)
    shared = shared_level(work, most, _ROOM)

    def solve(level: int) -> tuple[History, Any]:
        finer = 2**level
        room = finer if on_numpy() else max(finer, 2**shared)
        surface = _surface(
            body,
            track,
            low,
            xp.asarray(spacing / finer),
            count * room,
            finer,
            room // finer,
        )
        scene = Scene(law, surface, *mounts)
        used = xp.asarray(samples * finer)
        seen, line = run(
            scene, time, place, load, shortest, samples * room, used, early
        )
        size[:] = count * finer, samples * finer * (history.time.size - 1 + early)
        inside = (
            xp.bool_(True)
            if isinstance(body, RoughLine)
            else (line.u[0] == 0) & (line.u[count * finer - 1] == 0)
        )
        if is_traced(seen):
            return seen, inside
        outside[0] = not inside
        if not np.any(history.value > 0):  # what is left is rounding
            seen = seen._replace(normal=0 * seen.normal, drag=0 * seen.drag)
        return mapped(np.asarray, (seen, inside))

    def solved(level: int) -> tuple[History, Any]:
        return at_level(solve, level, _SLOWER * work * 4.0**level)

    return refine(solved, history.rtol, most, slope, _missing), size, outside[0]


def _samples(history: GivenHistory, spacing: Any, mounts: list[Any], law: Any) -> int:
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
    if not history.traced:
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
    low: Any,
    spacing: Any,
    count: int,
    finer: int,
    periods: int,
) -> AbstractOverLine:
    """The body over `count` elements; over so many periods of a rough line, with
    `finer` elements for each point.
    """
    if isinstance(body, RoughLine):
        return rough(
            xp.tile(body._finer(finer), periods), spacing, xp.asarray(body.highest)
        )
    x = low + spacing * (xp.arange(count) + 0.5)
    height: Any = xp.zeros(())
    if track is not None:
        height = _heights(track, x)
    weight = spacing * body.weight(xp.ones(1))[0, 0]
    return Indenter(
        shape=body.shape,
        x=x,
        y=None,
        spacing=xp.asarray(spacing),
        weight=weight,
        track=height,
    )


def _heights(track: RoughLine, x: Any) -> Any:
    """Heights of the track at the places x, counted from its highest point."""
    coefficients = spline_coefficients(xp.asarray(track.height))
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


def _missing(seen: Any) -> tuple[Any, Any]:
    """What the energy balance does not find at each instant, and the largest work that
    was done [J].
    """
    numpy = xp if is_traced(seen) else np
    given = seen.driven + seen.pressed
    found = seen.kinetic + seen.spring + seen.work + seen.damped
    return given - found, numpy.max(numpy.maximum(numpy.abs(given), numpy.abs(found)))


def _pack(
    history: GivenHistory,
    found: Levels,
    mounts: list[Any],
    plan: Any,
    model: str,
    inputs: Any,
    per_length: bool,
    extrapolated: Any,
) -> Drive:
    traced = is_traced(found)
    if not traced and not found.good.all():
        text = (
            f"{int((~found.good).sum())} of {found.good.size} instants did not "
            f"converge to rtol={history.rtol:g}; "
        )
        warnings.warn(f"{text}they are NaN.", ConvergenceWarning, stacklevel=4)

    def shown(field: Any) -> Any:
        return nan_unless(found.shown, field)

    seen: Any = found.forces
    tangential = mounts[0]
    pull = (
        seen.drag
        if tangential is None
        else tangential.stiffness * (history.position - seen.position)
    )
    return Drive(
        time=history.time,
        drive=history.position,
        position=shown(seen.position),
        velocity=shown(seen.velocity),
        depth=shown(seen.depth),
        mu=shown(found.mu),
        normal_force=shown(seen.normal),
        friction_force=shown(seen.drag),
        pull=shown(pull),
        given=shown(seen.driven + seen.pressed),
        kinetic=shown(seen.kinetic),
        stored=shown(seen.stored + seen.spring),
        dissipated=shown(seen.work - seen.stored + seen.damped),
        imbalance=shown(_missing(seen)[0]),
        error=shown(found.error),
        converged=found.good,
        per_length=per_length,
        model=model,
        plan=plan,
        inputs=inputs,
        extrapolated=extrapolated,
    )
