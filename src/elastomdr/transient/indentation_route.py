"""Which way an indentation is solved: by depth, by load in closed form, or by load in
steps; and the closed form.

While the contact grows under a load, every element in contact has been so since it was
first touched, so that F(t) = int E(t-s) dA(d(s)) and, turned round, A(d(t)) = int J(t-s)
dF(s), with A(d) the force of an elastic contact of unit modulus (Lee & Radok 1960). For
a load that is linear between instants this is a sum of exponentials of the Kelvin
chain. It holds until the contact shrinks for the first time, that is, while A has not
fallen. Elements of a flat punch all share one history, and an elastic contact has none;
for them it holds always.

Energies: the work is int F dd. A branch stores E_k P_k/2 with P_k = int weight
(f_k/E_k)^2 dx, which obeys P_k' = -2 P_k/tau_k + 2 B_k d', B_k = int weight f_k/E_k dx
being the branch's share of A (derived here, by differentiating under the integral).
d(t) is no sum of exponentials; both are integrated by Gauss' rule on panels that narrow
towards both ends of each interval, as far as the shortest time of the spectrum needs
it.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import (
    arrays,
    compiled,
    on_jax,
    on_numpy,
    scan,
    stop_gradient,
    tree_map,
    xp,
)
from ..checks import Array, is_traced, known, nan_unless, numpy_unless_traced
from ..element.episode import Modes
from ..material.relaxation import Relaxation
from ..numerics.decay import phi1, phi2
from ..numerics.quadrature import gauss_on_panels
from ..surface.disc import Disc
from .adhesive_contact import AdhesiveEdge
from .depth_history import (
    LAYERS,
    DepthHistory,
    cuts,
    edges,
    edges_of_growth,
    indent_all,
    indent_between_smooth,
    over_histories,
)
from .load_steps import Ruled, march_load
from .problem import places

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_LEVELS = (1, 3, 6, LAYERS)  # of the panels, coarse to fine
_TRACED_LEVELS = 12  # of the panels in time, where the times cannot be looked at
_ROUNDING = 1e-14
# instants of all histories together that NumPy follows sooner than JAX compiles, under a
# load, as long as contact grows: 0.2 ms each when this was chosen
_MANY = 4096
# instants to which a solved history is refined before pressures are computed from it
_KNOTS = 400
_NODES = 6  # Gauss points per panel
_RATIO = 4.0  # of neighbouring panels
_FALL = 1e-12  # of A, below which a fall of it is rounding
STEPS = "exact contact steps at the load, extrapolated from halved steps"
BY_DEPTH = (
    "elements exact in time under the given depth, Gauss' rule between the edges of "
    "all instants"
)
GROWING = "closed form of Lee and Radok: the contact only grows"


class DepthOrLoad(NamedTuple):
    """Histories of one shape (..., m): depth or load, or both with `by_depth` saying
    which rules at each instant.
    """

    time: Any  # (..., m)
    depth: Any  # None, or of the shape of `time`
    load: Any
    by_depth: Any


class Indented(NamedTuple):
    """Solved histories, every field of their shape."""

    depth: Array
    force: Array
    radius: Array
    work: Array
    stored: Array
    locked: Array
    heat: Array
    error: Array  # relative to the largest force or depth
    converged: Array
    plan: str
    reason: str  # why some did not converge
    edge: AdhesiveEdge | None = None
    held_to: float = 0.0  # relative error asked for, where that is above `rtol`


def indent_under(
    law: Relaxation, modes: Modes, disc: Disc, course: DepthOrLoad, rtol: float
) -> Indented:
    """Solves all histories of a course."""
    if course.load is None:
        # compiled 513 instants of one history take four times as long, 100 histories of
        # 51 instants as long as in NumPy
        return _by_depth(law, modes, disc, course, rtol)
    return _by_load(law, modes, disc, course, rtol)


def _by_depth(
    law: Relaxation, modes: Modes, disc: Disc, course: DepthOrLoad, rtol: float
) -> Indented:
    shape = course.time.shape
    time, depth = (a.reshape(-1, shape[-1]) for a in (course.time, course.depth))
    given = (law, modes, disc, time, depth)
    traced = is_traced(given)
    # values, unless under jit or vmap
    frozen = stop_gradient(given) if traced else given
    sums, levels = None, _LEVELS[1]
    if is_traced(frozen):
        radius = over_histories(edges, *frozen)
    else:
        law, modes, disc, time, depth = known(frozen)
        sums, levels = _searched(law, modes, disc, time, depth, rtol)
        radius = sums.radius
    if sums is None or traced:  # with derivatives
        parts = np.tile(np.append(cuts(levels)[:, :-1], 1.0), (len(time), 1))
        sums, _ = over_histories(indent_between_smooth, *given, radius, parts)
    largest = abs(sums.force).max(axis=-1, keepdims=True)
    error = sums.error / (largest + (largest == 0)) + _ROUNDING
    good = xp.isfinite(sums.force) & (error <= rtol)
    found, good = sums._replace(error=error), good.reshape(shape)
    found = DepthHistory(*(a.reshape(shape) for a in found))
    return Indented(
        depth=course.depth,
        force=found.force,
        radius=found.radius,
        work=found.work,
        stored=found.stored,
        locked=found.locked,
        heat=found.heat,
        error=found.error,
        converged=good,
        plan=BY_DEPTH,
        reason="",
    )


@numpy_unless_traced
def _searched(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: np.ndarray,
    depth: np.ndarray,
    rtol: float,
) -> tuple[DepthHistory, int]:
    """Histories on as many panels as `rtol` asks for, and the level of these."""
    growing = bool((np.diff(depth, axis=-1) >= 0).all())
    find = edges_of_growth if growing else edges
    radius = over_histories(find, law, modes, disc, time, depth)
    levels = _LEVELS[0]
    sums = indent_all(law, modes, disc, time, depth, radius, levels)
    for finer in _LEVELS[1:]:
        asked = 0.5 * rtol * abs(sums.force).max(axis=-1)
        which = np.flatnonzero((sums.error > asked[:, None]).any(axis=-1))
        if not which.size:
            break
        levels, rows = finer, (time[which], depth[which], radius[which])
        again = indent_all(law, modes, disc, *rows, levels)
        for field, better in zip(sums, again, strict=True):
            field[which] = better
    return sums, levels


def _by_load(
    law: Relaxation, modes: Modes, disc: Disc, course: DepthOrLoad, rtol: float
) -> Indented:
    """In closed form as long as the contact grows, in steps where it does not."""
    shape = course.time.shape
    load = course.load
    by_depth = np.zeros(shape, bool) if course.by_depth is None else course.by_depth
    depth = np.zeros(shape) if course.depth is None else np.nan_to_num(course.depth)
    load = load if course.by_depth is None else np.nan_to_num(load)
    time, load, depth, by_depth = (
        a.reshape(-1, shape[-1]) for a in (course.time, load, depth, by_depth)
    )
    traced = is_traced(law, modes, disc, time, load)
    if course.by_depth is None:
        if on_numpy() and time.size > _MANY:
            fields, growing = on_jax(_grown, law, modes, disc, time, load)
        else:
            fields, growing = _grown(law, modes, disc, time, load)
        known = stop_gradient(growing) if traced else growing
    else:
        fields, known = (depth,) * 8, np.zeros(time.shape, bool)
    # A contact under a load that never falls only grows, whatever the material; that of
    # a flat punch has one size.
    rises = disc.flat or (
        not is_traced(load) and bool((np.diff(load, axis=1) >= 0).all())
    )
    simple = course.by_depth is None and rises
    rest = (
        np.ones(len(time), bool) if is_traced(known) else ~np.asarray(known).all(axis=1)
    )
    plan = GROWING
    if rest.any() and not simple:
        plan = STEPS if course.by_depth is not None else f"{GROWING}; otherwise {STEPS}"
        which = np.flatnonzero(rest)
        rows = DepthOrLoad(time[which], depth[which], load[which], by_depth[which])
        stepped = _stepped(law, modes, disc, rows, rtol)
        back = np.zeros(len(time), int)
        back[which] = np.arange(len(which))
        fields = tuple(
            xp.where(known, a, b[back]) for a, b in zip(fields, stepped, strict=True)
        )
    depth, force, radius, work, stored, locked, heat, error = (
        a.reshape(shape) for a in fields
    )
    good = xp.isfinite(depth) & (error <= rtol)
    reason = ""
    if not traced and not np.isfinite(depth).all():
        reason = (
            "Where no finite number came out, the contact would be wider than the "
            f"{disc.shape.label} is."
        )
    return Indented(
        depth, force, radius, work, stored, locked, heat, error, good, plan, reason
    )


def _grown(
    law: Relaxation, modes: Modes, disc: Disc, time: Array, load: Array
) -> tuple[tuple[Array, ...], Array]:
    """The closed form: depth, force, radius, work, stored, locked, heat, error; where
    the contact has only grown.
    """
    levels = _TRACED_LEVELS if is_traced(law, time) else levels_for(law, modes, time)
    creep_history: Creep = over_histories(
        creep, law, modes, disc, time, load, levels=levels
    )
    nothing = xp.zeros(time.shape)
    error = xp.where(xp.isfinite(creep_history.depth), _ROUNDING, xp.nan)
    return (
        creep_history.depth,
        load,
        creep_history.radius,
        creep_history.work,
        creep_history.stored,
        nothing,
        creep_history.heat,
        error,
    ), creep_history.growing


def _stepped(
    law: Relaxation, modes: Modes, disc: Disc, rows: DepthOrLoad, rtol: float
) -> tuple[Array, ...]:
    """Depth, force, radius, work, stored, locked, heat and relative error, marched."""
    value = rows.load
    if rows.by_depth.any():
        value = np.where(rows.by_depth, rows.depth, rows.load)
    histories = [
        march_load(law, modes, disc, Ruled(*row), rtol)
        for row in zip(rows.time, value, rows.by_depth, strict=True)
    ]
    marched = tree_map(lambda *parts: xp.stack(parts), *histories)
    largest = xp.max(abs(marched.work), axis=-1, keepdims=True)
    unaccounted = abs(marched.work - marched.stored - marched.locked - marched.heat)
    heat = nan_unless(unaccounted <= rtol * largest, marched.heat)
    return tuple(marched._replace(heat=heat, error=marched.error + _ROUNDING))


def refined(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    course: DepthOrLoad,
    found: tuple[Array, Array],
    rtol: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Time and depth of one history, between which the depth is close to linear: as
    given, or solved in between. `found` are its depth and force.
    """
    if course.load is None:
        return np.asarray(course.time), np.asarray(found[0])
    kept = 2 ** int(np.clip(np.log2(_KNOTS / len(course.time)), 0, 5))
    shares = places(kept, 3)[1:]

    def between(values: Array) -> np.ndarray:
        steps = np.diff(values)[:, None] * shares
        return np.append(values[0], values[:-1, None] + steps)

    time, depth, load = map(between, (course.time, *map(np.asarray, found)))
    by_depth = None
    if course.by_depth is not None:
        by_depth = np.append(course.by_depth[0], np.repeat(course.by_depth[1:], kept))
    again = DepthOrLoad(time, depth, load, by_depth)
    return time, np.asarray(_by_load(law, modes, disc, again, rtol).depth)


class Creep(NamedTuple):
    """A history of growing contact at m instants."""

    depth: Float[Array, " m"]
    radius: Float[Array, " m"]
    work: Float[Array, " m"]  # int F dd [J]
    stored: Float[Array, " m"]  # elastic energy of the elements [J]
    heat: Float[Array, " m"]  # of branches and dashpot [J]
    growing: Bool[Array, " m"]  # whether it holds up to this instant


class _Inside(NamedTuple):
    """The history at nodes inside the intervals, (interval, node)."""

    s: Float[Array, " n"]  # place, of 1
    ds: Float[Array, " n"]
    load: Array  # [N]
    area: Array  # A
    rate: Array  # of A, per interval
    share: Array  # B_k, (interval, node, branch)


@compiled("levels")
def creep(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: Float[Array, " m"],  # ascending [s]
    load: Float[Array, " m"],  # linear in between; load[0] is a step at time[0] [N]
    *,
    levels: int,
) -> Creep:
    """Depth, contact radius and energies under a load, exact while the contact grows;
    NaN where no contact can carry it. `levels` as from `levels_for`.
    """
    law, modes, disc = arrays((law, modes, disc))
    h, rise = xp.diff(time), xp.diff(load)
    y = h[:, None] * modes.rate
    gain = (
        modes.gain * h[:, None] * (load[:-1, None] * phi1(y) + rise[:, None] * phi2(y))
    )
    _, z = scan(_relaxed, xp.zeros_like(modes.rate), (xp.exp(-y), gain))
    # retarded part of A, per mode
    z = xp.concatenate([xp.zeros((1, modes.rate.size)), z])
    area = modes.instantaneous * load + xp.sum(z, axis=1)
    depth, radius = disc.depth_of_area(area), disc.radius_of_area(area)
    inside = _inside(modes, h, load, z, levels)
    growing = xp.all(inside.rate >= -_FALL * xp.abs(inside.area), axis=1) & (
        area[1:] >= area[:-1] * (1 - _FALL)
    )
    elastic = (xp.sum(law.moduli) == 0) & (law.viscosity == 0)
    holds = (xp.cumprod(growing) > 0) | disc.flat | elastic
    growing = xp.concatenate([xp.ones(1, bool), holds])
    work, stored, heat = _energies(law, modes, disc, h, radius, depth, inside)
    return Creep(depth, radius, work, stored, heat, growing)


def _relaxed(z: Array, step: tuple[Array, Array]) -> tuple[Array, Array]:
    """What is left of z after a step, and what is gained."""
    z = step[0] * z + step[1]
    return z, z


def _inside(modes: Modes, h: Array, load: Array, z: Array, levels: int) -> _Inside:
    s, ds = _panels(levels)
    rise = xp.diff(load)
    inner = h[:, None, None] * modes.rate * s[:, None]  # (interval, node, mode)
    ramp = h[:, None] * s
    force = load[:-1, None] + rise[:, None] * s
    z = xp.exp(-inner) * z[:-1, None] + ramp[..., None] * modes.gain * (
        load[:-1, None, None] * phi1(inner)
        + (force - load[:-1, None])[..., None] * phi2(inner)
    )
    area = modes.instantaneous * force + xp.sum(z, axis=-1)
    rate = modes.instantaneous * rise[:, None] + h[:, None] * xp.sum(
        modes.gain * force[..., None] - modes.rate * z, axis=-1
    )
    return _Inside(s, ds, force, area, rate, area[..., None] - z @ modes.shape)


def _energies(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    h: Array,
    radius: Array,
    depth: Array,
    inside: _Inside,
) -> tuple[Array, Array, Array]:
    """Work, elastic energy and heat at every instant."""
    s, ds = inside.s, inside.ds
    flat = disc.width(xp.asarray(disc.shape.largest_contact)) if disc.flat else None
    width = disc.width(disc.radius_of_area(inside.area)) if flat is None else flat
    if flat is None:
        safe = xp.where(width > 0, width, 1.0)
        depth_rate = xp.where(width > 0, inside.rate / safe, 0.0)
    else:
        depth_rate = inside.rate / flat
    # At the first instant the contact is elastic and glassy; a parallel dashpot lets
    # nothing happen there.
    start = _elastic(disc, radius[0], depth[0])
    glassy = xp.where(
        modes.instantaneous > 0, law.equilibrium + xp.sum(law.moduli), 0.0
    )
    work = xp.append(glassy * start, xp.sum(ds * inside.load * depth_rate, axis=1))
    fading = xp.exp(-2 * h[:, None, None] * (1 - s)[:, None] / law.times)
    into = inside.share * depth_rate[..., None]
    gained = xp.sum(2 * ds[:, None] * fading * into, axis=1)
    first = xp.broadcast_to(2 * start, law.times.shape)
    left = xp.exp(-2 * h[:, None] / law.times)
    _, squares = scan(_relaxed, first, (left, gained))
    squares = xp.concatenate([first[None], squares])
    stored = (
        law.equilibrium * _elastic(disc, radius, depth) + 0.5 * squares @ law.moduli
    )
    # What goes into each branch, less what it holds; what goes into the dashpot, whose
    # force is eta d' over the width.
    given = xp.concatenate([0.5 * first[None], xp.sum(ds[:, None] * into, axis=1)])
    spread = xp.cumsum(given, axis=0) - 0.5 * squares
    damped = xp.sum(ds * width * depth_rate**2, axis=1) / h
    heat = spread @ law.moduli + law.viscosity * xp.append(0.0, xp.cumsum(damped))
    return xp.cumsum(work), stored, heat


def levels_for(law: Relaxation, modes: Modes, time: Array) -> int:
    """How many times the panels narrow, so that they see the shortest time of the
    spectrum in every interval.
    """
    times = [
        np.asarray(law.times),
        1 / np.asarray(modes.rate)[np.asarray(modes.rate) > 0],
    ]
    shortest = min((float(t.min()) for t in times if t.size), default=math.inf)
    longest = float(np.diff(time).max(initial=0.0))
    # A dashpot lets a load sink in from nothing, d ~ t^(2/3), and its heat begins with
    # t^(-1/3).
    least = 22 if np.asarray(law.viscosity) > 0 else 3
    if not 0 < longest / shortest < math.inf:
        return least
    return min(max(least, 1 + math.ceil(math.log(longest / shortest, _RATIO))), 30)


def _elastic(disc: Disc, radius: Array, depth: Array) -> Array:
    """V: what an elastic contact of unit modulus stores."""
    if disc.flat:
        return 0.5 * disc.width(xp.asarray(disc.shape.largest_contact)) * depth**2
    return disc.energy(radius)


@functools.cache
def _panels(levels: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights on [0, 1], panels narrowing towards both ends."""
    left = np.concatenate([[0.0], 0.5 * _RATIO ** -np.arange(levels, -1.0, -1)])
    edges = np.concatenate([left, 1 - left[-2::-1]])
    return gauss_on_panels(edges, _NODES)
