"""Which way an indentation is solved: by depth, by load in closed form, or by load in
steps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import on_jax, on_numpy, stop_gradient, tree_map, xp
from ..checks import Array, is_traced, known, nan_unless, numpy_unless_traced
from ..element.episode import Modes
from ..material.relaxation import Relaxation
from ..surface.disc import Disc
from .creep import Creep, creep, levels_for
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
    from .adhesive_contact import Sticky

_LEVELS = (1, 3, 6, LAYERS)  # of the panels, coarse to fine
_TRACED_LEVELS = 12  # of the panels in time, where the times cannot be looked at
_ROUNDING = 1e-14
# instants of all histories together that NumPy follows sooner than JAX compiles, under a
# load, as long as contact grows: 0.2 ms each when this was chosen
_MANY = 4096
# instants to which a solved history is refined before pressures are computed from it
_KNOTS = 400
STEPS = "exact contact steps at the load, extrapolated from halved steps"
JKR = "JKR in closed form, root by root"
STICKY = (
    "relaxed at first, then receding by the glassy energy of the edge, in closed form"
)
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


def indent_under(
    law: Relaxation, modes: Modes, disc: Disc, course: DepthOrLoad, rtol: float
) -> Indented:
    """Solves all histories of a course."""
    if course.load is None:
        # compiled 513 instants of one history take four times as long, 100 histories of
        # 51 instants as long as in NumPy
        return _by_depth(law, modes, disc, course, rtol)
    return _by_load(law, modes, disc, course, rtol)


def indent_with_adhesion(
    law: Relaxation, modes: Modes, disc: Disc, course: DepthOrLoad, gamma: Array
) -> Indented:
    """JKR for an elastic foundation; for a viscoelastic one the rule of
    `transient.adhesive_contact`.
    """
    import jax

    from .adhesive_contact import Sticky, elastic, receding

    shape = course.time.shape
    traced = is_traced(law, disc, course, gamma)
    numpy = xp if traced else np
    zero, by_depth = numpy.zeros(shape), course.by_depth
    if by_depth is None:
        by_depth = numpy.full(shape, course.load is None)
    depth, load = (
        zero if values is None else numpy.nan_to_num(values)
        for values in (course.depth, course.load)
    )
    rows = tuple(a.reshape(-1, shape[-1]) for a in (course.time, depth, load, by_depth))
    simple = law.moduli.shape[0] == 0 or (not is_traced(law) and not law.moduli.any())
    sticky, plan = Sticky(disc, law.equilibrium, gamma), JKR
    if simple:
        out = jax.vmap(elastic, in_axes=(None, 0, 0, 0))(sticky, *rows[1:])
    else:
        axes = (None, None, None, None, 0, 0, 0, 0)
        out = jax.vmap(receding, in_axes=axes)(law, modes, disc, gamma, *rows)
        glassy = (law.equilibrium + law.moduli.sum()) / law.equilibrium
        sticky, plan = sticky._replace(gamma=gamma * glassy), STICKY
    depth, force, radius, work, stored = (numpy.asarray(a).reshape(shape) for a in out)
    known, reason = numpy.isfinite(force), ""
    if not traced:
        plan += _breaks(sticky)
        if not known.all():
            reason = "A load pulled the body off"
            if not simple:
                reason += (
                    ", or the contact would have grown, for which there is no rule"
                )
            reason += "."
    return Indented(
        depth=depth,
        force=force,
        radius=radius,
        work=work,
        stored=stored,
        locked=zero,
        heat=work - stored,
        error=numpy.where(known, _ROUNDING, numpy.nan),
        converged=known,
        plan=plan,
        reason=reason,
    )


def _breaks(sticky: Sticky) -> str:
    """Where an adhesive contact breaks, in words."""
    import jax

    words = ""
    for name in ("load", "depth"):
        edge = jax.jit(type(sticky).breaks, static_argnums=1)(sticky, name)
        a, d, f = (float(x) for x in edge)
        words += (
            f"; breaks under falling {name} at F = {f:.6g} N, d = {d:.6g} m, a = "
            f"{a:.6g} m"
        )
    return words


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
