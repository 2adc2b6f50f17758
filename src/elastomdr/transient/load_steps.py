"""Indentation under a load that lets the contact shrink, or under depth and load in
turn: marched by the exact contact step.

Each interval is divided into steps that narrow towards its ends, where the material
answers fastest and where a contact begins or ends; after a load that is put on at once
geometrically, down to the shortest relaxation time, since the depth then follows every
branch, and what branches turn into heat is lost from the balance where that is not
resolved. In a step an element carries q = S (w - u_free) wherever that is positive
(`element.contact_step`), so that the force is a convex, piecewise linear function of
the depth at the end of the step: Newton's method finds the depth that carries the load
in finitely many steps. The elements are Gauss nodes on panels that end at the edges of
the contact at all instants; these are found by marching a few times, each time on the
edges of the march before. Of second order in the step; the limit is extrapolated from
halved steps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import compiled, fori_loop, on_numpy, stop_gradient, tree_map, xp
from ..checks import Array, is_traced
from ..element.contact_step import (
    Coefficients,
    Elements,
    advance,
    coefficients_of_steps,
    fade,
    lag,
    released,
    rest,
)
from ..element.episode import Modes
from ..material.relaxation import Relaxation
from ..numerics.decay import phi1
from ..numerics.quadrature import gauss_on_panels
from ..surface.disc import Disc
from .march import march, settle
from .refinement import limit

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_NODES = 3  # per panel between the edges
# per panel of what never parts: few panels, whatever the steps, and a profile may rise
# as r^40
_INNER = 16
_MARCHES, _AGAIN = 4, 2  # to find the edges; and from those of a march with fewer steps
_GRADING = 3  # power by which steps narrow
_TIP = np.concatenate([[0.0], 0.3 ** np.arange(12.0, -1.0, -1)])
# ratio of the first steps after a sudden load, and share of the shortest time with
# which they begin
_EARLY = 4.0
_MOST_EARLY = 24
# relative change of a ratio that is taken as it is, and the ratios
_STEADY, _SLOW = 0.1, (0.15, 0.5)
_SIZES = (128, 512)  # numbers of steps that short marches are filled up to


class LoadSteps(NamedTuple):
    """What rules in each of the steps of a history, and how far they are on their way
    to the next instant.
    """

    h: Float[Array, " s"]  # [s]
    fraction: Float[Array, " s"]  # of the interval, at the end of the step
    first: Bool[Array, " s"]  # first step of its interval
    by_depth: Bool[Array, " s"]
    target: Float[Array, " s"]  # depth or load at the end of the interval


class Marched(NamedTuple):
    """A history at its instants, the first one included."""

    depth: Float[Array, " m"]
    force: Float[Array, " m"]
    radius: Float[Array, " m"]
    work: Float[Array, " m"]
    stored: Float[Array, " m"]
    locked: Float[Array, " m"]
    heat: Float[Array, " m"]  # what the elements received, less what they hold
    fits: Bool[Array, " m"]  # the contact is within what the shape has


class Edges(NamedTuple):
    """Where the contact ends at the end of every step, the first instant included."""

    place: Float[Array, "b s"]  # instants passed, and the part of the interval
    radius: Float[Array, "b s"]


def march_load(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: Float[Array, "b m"],
    depth: Float[Array, "b m"],  # not looked at where the load rules
    load: Float[Array, "b m"],  # not looked at where the depth rules
    by_depth: Bool[Array, "b m"],
    *,
    levels: int,  # steps per interval
    kept: int = 1,  # instants per interval that are kept, a divisor of `levels`
    # by how many more the first step of the coarsest march of the series is divided
    early: int = 0,
    # steps per interval of that march, if it is not this one
    coarsest: int | None = None,
    room: bool = False,  # steps are added at the end, so that few sizes are compiled
    before: Edges | None = None,  # of a march with fewer steps
) -> tuple[Marched, Edges]:
    """One march of b histories at a given number of steps. Differentiable in both
    modes.
    """
    coarsest = coarsest or levels
    # NumPy has nothing to compile for a new size
    numpy: Any = xp if is_traced(law, time, depth, load) else np
    target = numpy.where(by_depth, depth, load)
    share = _shares(numpy, law, time, levels, coarsest, early)
    intervals, more = time.shape[1] - 1, early * (levels // coarsest)
    interval = np.repeat(
        np.arange(intervals), [levels + more] + [levels] * (intervals - 1)
    )
    steps = _steps(numpy, time, target, by_depth, interval, share)
    count = interval.size
    size = next((n for n in _SIZES if room and n >= count), count)
    steps = LoadSteps(*(a[:, np.minimum(np.arange(size), count - 1)] for a in steps))
    place = numpy.concatenate([numpy.zeros((len(time), 1)), interval + share], axis=1)
    place = place[:, np.minimum(np.arange(size + 1), count)]
    reach = stop_gradient(_reach(modes, disc, time, depth, load, by_depth))
    start = target[:, 0], by_depth[:, 0]
    radius = _edges(law, disc, steps, start, reach, place, before)
    sums, radius, fits = _all(law, disc, steps, start, reach, radius)
    every = np.arange(intervals * kept + 1) * (levels // kept)
    every[1:] += more
    marched = Marched(
        *(numpy.asarray(a)[:, every] for a in (*sums[:2], radius, *sums[2:], fits))
    )
    return marched, Edges(place, stop_gradient(radius))


def _shares(
    numpy: Any, law: Relaxation, time: Array, levels: int, coarsest: int, early: int
) -> Float[Array, "b s"]:
    """Where each step ends, as a part of its interval."""
    batch, intervals = time.shape[0], time.shape[1] - 1
    fractions = np.tile(places(levels), (batch, intervals, 1))
    early_ends = _early(numpy, law, time[:, 1:2] - time[:, :1], levels, coarsest, early)
    rest_of_first = fractions[:, 0, 1 + levels // coarsest :]
    others = fractions[:, 1:, 1:].reshape(batch, -1)
    return numpy.concatenate([early_ends, rest_of_first, others], axis=1)


def _steps(
    numpy: Any,
    time: Array,
    target: Array,
    by_depth: Array,
    interval: np.ndarray,
    share: Array,
) -> LoadSteps:
    first = np.append(True, np.diff(interval) > 0)
    before = numpy.concatenate([share[:, :1], share[:, :-1]], axis=1)
    return LoadSteps(
        h=numpy.diff(time)[:, interval] * (share - numpy.where(first, 0.0, before)),
        fraction=share,
        first=np.tile(first, (len(time), 1)),
        by_depth=by_depth[:, 1:][:, interval],
        target=target[:, 1:][:, interval],
    )


def _edges(
    law: Relaxation,
    disc: Disc,
    steps: LoadSteps,
    start: tuple[Array, Array],
    reach: Array,
    place: Array,
    before: Edges | None,
) -> Array:
    """The edges at the ends of all steps, from a few marches, each on the edges of the
    march before.
    """
    frozen = stop_gradient((law, disc, steps, start, reach))
    radius = reach[:, None] * np.linspace(0.0, 1.0, steps.h.shape[1] + 2)[1:]
    if before is not None:
        radius = np.stack([np.interp(*row) for row in zip(place, *before, strict=True)])
    marches = (_MARCHES if before is None else _AGAIN) - 1
    if is_traced(frozen):  # a loop, since there the code of every march is compiled
        return fori_loop(0, marches, lambda _, radius: _all(*frozen, radius)[1], radius)
    for _ in range(marches):
        radius = _all(*frozen, radius)[1]
    return radius


def extrapolated(marches: list[Marched], ratio: Array | None = None) -> Marched:
    """The limit of marches of ever more steps; `ratio` as in `steady_ratio`."""
    # An element that is touched or lost within a step errs by the cube of the step in
    # what it receives.
    by_power = limit(marches, (2, 4, 6))._replace(heat=limit(marches, (2, 3, 4)).heat)
    if ratio is None or np.isnan(ratio).all():
        return by_power
    steady, gain = ~np.isnan(ratio), np.nan_to_num(ratio / (1 - ratio))

    def goes_on(by_power: Array, a: Array, b: Array) -> Array:
        return (
            by_power
            if b.dtype == bool
            else xp.where(steady, b + (b - a) * gain, by_power)
        )

    return tree_map(
        goes_on, by_power, limit(marches[:-1], (2,)), limit(marches[-2:], (2,))
    )


def steady_ratio(marches: list[Marched]) -> Array:
    """By what each change of the limit without the square of the step is smaller than
    the one before, (b, 1), where that hardly changes any more; else NaN.

    Branches that are shorter than a step act as dashpots do, whose force is a mean over
    the step, so that they err by the step itself. With many times in a broad spectrum
    there are the fewer of these the shorter the step is, and the error falls by a power
    that is not whole.
    """
    ratios = [_ratio(marches[: len(marches) - back]) for back in (1, 0)]
    steady = (
        (abs(ratios[1] - ratios[0]) < _STEADY * ratios[1])
        & (ratios[1] > _SLOW[0])
        & (ratios[1] < _SLOW[1])
    )
    return np.where(steady, ratios[1], np.nan)


def _ratio(marches: list[Marched]) -> Array:
    if len(marches) < 4:
        return np.full((len(marches[0].work), 1), np.nan)
    limits = [
        limit(marches[i : i + 2], (2,)).work
        for i in range(len(marches) - 4, len(marches) - 1)
    ]
    older, newer = np.diff(limits, axis=0)
    square = (older**2).sum(axis=1, keepdims=True)
    return (older * newer).sum(axis=1, keepdims=True) / (square + (square == 0))


def unaccounted(marched: Marched) -> Array:
    """Work that was neither stored nor turned into heat, relative to the largest work
    of the history.
    """
    largest = abs(marched.work).max(axis=-1, keepdims=True)
    return abs(marched.work - marched.stored - marched.locked - marched.heat) / (
        largest + (largest == 0)
    )


def places(levels: int) -> np.ndarray:
    """Divisions of [0, 1] that narrow towards both ends; those of `levels` are among
    those of twice as many.
    """
    place = np.linspace(0.0, 1.0, levels + 1) ** _GRADING
    return place / (place + place[::-1])


def early_steps(
    law: Relaxation, time: Any, depth: Any, load: Any, by_depth: Any, coarsest: int
) -> int:
    """How many more steps the first one after a sudden load is divided into, in the
    coarsest march; values known.
    """
    times = np.asarray(law.times)[np.asarray(law.moduli) > 0]
    sudden = np.where(by_depth, depth, load)[:, 0] > 0
    if not times.size or not sudden.any():
        return 0
    first = places(coarsest)[1] * float(np.max(time[:, 1] - time[:, 0]))
    return int(
        np.clip(
            np.ceil(np.log(_EARLY * first / times.min()) / np.log(_EARLY)),
            0,
            _MOST_EARLY,
        )
    )


def _early(
    numpy: Any, law: Relaxation, h: Array, levels: int, coarsest: int, early: int
) -> Array:
    """Ends of the steps within the first one of the coarsest march, as parts of the
    first interval; (b, steps).
    """
    first, finer = places(coarsest)[1], levels // coarsest
    if not early:
        return np.tile(places(levels)[1 : 1 + finer], (h.shape[0], 1))
    moduli, times, h = (
        stop_gradient((law.moduli, law.times, h))
        if numpy is not np
        else (law.moduli, law.times, h)
    )
    shortest = numpy.min(
        numpy.where(numpy.asarray(moduli) > 0, numpy.asarray(times), numpy.inf),
        initial=numpy.inf,
    )
    # Not above 1/_EARLY: no step may be without length where no branch is short.
    ratio = numpy.minimum(
        shortest / (_EARLY * first * numpy.asarray(h)), 1 / _EARLY
    ) ** (1 / early)
    knots = first * ratio ** np.arange(early, -1.0, -1)
    knots = numpy.concatenate([numpy.zeros_like(ratio), knots], axis=1)
    return (
        knots[:, :-1, None]
        + numpy.diff(knots)[..., None] * np.arange(1, finer + 1) / finer
    ).reshape(h.shape[0], -1)


class _Row(NamedTuple):
    """Elements under the disc: Gauss nodes on panels that end at all edges."""

    x: Array  # [m]
    weight: Array  # [m]
    profile: Array  # g [m]


class _LoadState(NamedTuple):
    """Elements and body at the end of a step, and where its interval began."""

    elements: Elements
    depth: Array
    force: Array
    work: Array
    first_depth: Array
    first_force: Array


def _row(disc: Disc, reach: Array, edges: Array) -> _Row:
    # a light load is carried near the axis
    tip = xp.min(xp.where(edges > 0, edges, reach)) * _TIP
    outer = xp.sort(xp.append(stop_gradient(edges), tip[-1]))
    rules = (
        gauss_on_panels(tip, _INNER),
        gauss_on_panels(xp.maximum(outer, tip[-1]), _NODES),
    )
    x, dx = (xp.concatenate(both) for both in zip(*rules, strict=True))
    return _Row(x, disc.weight(x) * dx, disc.profile(x))


def _once(
    law: Relaxation,
    disc: Disc,
    steps: LoadSteps,
    start: tuple[Array, Array],
    reach: Array,
    edges: Array,
) -> tuple[tuple[Array, ...], Array, Array]:
    """(depth, force, work, stored, locked, heat), contact radius, whether the shape was
    wide enough, at every step.
    """
    row = _row(disc, reach, edges)
    viscous = not on_numpy() or bool(law.viscosity > 0)

    def prepare(block: LoadSteps) -> tuple[LoadSteps, Coefficients]:
        return block, coefficients_of_steps(law, block.h, viscous=viscous)

    def step(
        state: _LoadState, now: tuple[LoadSteps, Coefficients]
    ) -> tuple[_LoadState, Array]:
        end, c = now
        # so that sums over both are made once
        c = c if viscous else c._replace(seen=c.decay)
        return _advance(law, row, c, state, end)

    def look(state: _LoadState, excess: Array) -> tuple[tuple[Array, ...], Array]:
        edge = _edge(row.x, excess, state.elements.q > 0)
        return _measured(law, row, state), edge

    first = _put_down(law, disc, row, *start)
    _, (sums, radius) = march(step, look, first, steps, None, prepare)
    count = edges.shape[0]
    radius = xp.append(
        _edge(row.x, first.depth - row.profile, first.elements.u > 0), radius
    )[:count]
    sums = tuple(
        xp.append(a, b)[:count]
        for a, b in zip(_measured(law, row, first), sums, strict=True)
    )
    if disc.flat:
        radius = xp.where(radius > 0, disc.shape.largest_contact, 0.0)
    return sums, xp.minimum(radius, disc.largest), radius < disc.largest


def _put_down(
    law: Relaxation, disc: Disc, row: _Row, value: Array, by_depth: Array
) -> _LoadState:
    """A step of depth or load at the first instant meets a glassy foundation; a dashpot
    lets nothing happen at once.
    """
    glassy, damped = law.equilibrium + xp.sum(law.moduli), law.viscosity > 0
    area = xp.where(damped, 0.0, value / xp.where(damped, 1.0, glassy))
    depth = xp.where(by_depth, value, disc.depth_of_area(area))
    u = xp.maximum(depth - row.profile, 0.0)
    f, q = law.moduli[:, None] * u, xp.where(damped, 0.0, glassy * u)
    branches = _strength(law) @ f**2
    elements = rest(law, row.x.size)._replace(
        u=u,
        f=f,
        q=q,
        work=branches + 0.5 * law.equilibrium * u**2,
        inelastic=branches,
        stored=branches,
    )
    force = xp.where(by_depth, xp.sum(row.weight * q), value)
    work = xp.sum(row.weight * elements.work)
    return _LoadState(elements, depth, force, work, depth, force)


def _strength(law: Relaxation) -> Array:
    """1/(2 E_k), zero for an empty branch."""
    return xp.where(
        law.moduli > 0, 0.5 / xp.where(law.moduli > 0, law.moduli, 1.0), 0.0
    )


def _advance(
    law: Relaxation, row: _Row, c: Coefficients, before: _LoadState, now: LoadSteps
) -> tuple[_LoadState, Array]:
    """One step, and w - u_free at its end."""
    elements, weight = before.elements, row.weight
    first_depth = xp.where(now.first, before.depth, before.first_depth)
    first_force = xp.where(now.first, before.force, before.first_force)
    load = first_force + (now.target - first_force) * now.fraction
    fading = fade(c, elements.f)
    free = released(c, elements.u, fading.seen)
    touch_depth, stiffness = row.profile + free, weight * c.stiffness
    # With a dashpot q is a mean over the end of the step: the load is averaged in the
    # same way.
    mean_load = load - (load - before.force) * lag(c)
    depth = settle(
        touch_depth, stiffness, 0.0, xp.maximum(mean_load, 0.0), before.depth
    )
    # without a load it lies on the surface
    depth = xp.where(mean_load > 0, depth, xp.min(touch_depth))
    given = first_depth + (now.target - first_depth) * now.fraction
    depth = xp.where(now.by_depth, given, depth)
    places = before.depth - row.profile, depth - row.profile
    after = advance(c, elements, *places, fading)
    felt = (
        law.equilibrium * after.u
        + xp.sum(after.f, axis=0)
        + law.viscosity * (depth - before.depth) / now.h
    )
    held = xp.sum(weight * xp.where(after.q > 0, felt, 0.0))
    force = xp.where(now.by_depth, held, load)
    # int F dd of the body, apart from what elements receive; a dashpot's force jumps
    # with the rate of the depth.
    received = xp.sum(weight * (after.work - elements.work))
    body_work = 0.5 * (before.force + force) * (depth - before.depth)
    work = xp.where(now.by_depth & (law.viscosity > 0), received, body_work)
    state = _LoadState(
        after, depth, force, before.work + work, first_depth, first_force
    )
    return state, depth - touch_depth


def _measured(law: Relaxation, row: _Row, state: _LoadState) -> tuple[Array, ...]:
    """Depth, force, work, and the energies stored in contact, locked out of it and
    turned into heat.
    """
    elements, weight = state.elements, row.weight
    held = 0.5 * law.equilibrium * elements.u**2 + _strength(law) @ elements.f**2
    touching = elements.q > 0
    stored, locked = (
        xp.sum(weight * xp.where(is_in, held, 0.0)) for is_in in (touching, ~touching)
    )
    heat = xp.sum(weight * elements.work) - stored - locked
    return state.depth, state.force, state.work, stored, locked, heat


def _edge(x: Array, excess: Array, touching: Array) -> Array:
    """Where w - u_free, which is smooth across the edge, passes zero; beyond the last
    node by continuation.
    """
    count = xp.sum(touching)
    # 32 bits, since the caller's `jax.jit` may transpose what follows under its own
    # setting.
    i = xp.clip(count - 1, 0, x.size - 2).astype("int32")
    low, high = excess[i], excess[i + 1]
    fall = xp.where(low > high, low - high, xp.inf)
    return xp.where(
        count > 0, xp.maximum(x[i] + (x[i + 1] - x[i]) * low / fall, 0.0), 0.0
    )


@compiled()
def _reach(
    modes: Modes, disc: Disc, time: Array, depth: Array, load: Array, by_depth: Array
) -> Array:
    """A radius that no contact of a history exceeds: that of the largest load, kept, or
    of the largest depth.
    """
    span = (time[:, -1] - time[:, 0])[:, None]
    creep = modes.instantaneous + xp.sum(
        modes.gain * span * phi1(modes.rate * span), axis=1
    )
    largest = [
        xp.max(xp.where(rules, value, 0.0), axis=1)
        for rules, value in ((~by_depth, load), (by_depth, depth))
    ]
    radii = disc.radius_of_area(creep * largest[0]), disc.radius_of_depth(largest[1])
    return xp.maximum(
        *(xp.where(radius < disc.largest, radius, disc.largest) for radius in radii)
    )


def _all(
    law: Relaxation,
    disc: Disc,
    steps: LoadSteps,
    start: tuple[Array, Array],
    reach: Array,
    edges: Array,
) -> tuple[tuple[Array, ...], Array, Array]:
    """`_once` for every history."""
    if not on_numpy():
        return _together(law, disc, steps, start, reach, edges)
    rows = [
        _once(
            law,
            disc,
            LoadSteps(*(a[i] for a in steps)),
            (start[0][i], start[1][i]),
            reach[i],
            edges[i],
        )
        for i in range(len(reach))
    ]
    return tree_map(lambda *a: np.stack(a), *rows)


@compiled()
def _together(
    law: Relaxation, disc: Disc, *histories: Any
) -> tuple[tuple[Array, ...], Array, Array]:
    import jax

    return jax.vmap(_once, in_axes=(None, None, 0, 0, 0, 0))(law, disc, *histories)
