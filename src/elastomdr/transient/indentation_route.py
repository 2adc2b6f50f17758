"""Which way an indentation is solved: by depth, by load in closed form, or by load in
steps.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import arrays, on_jax, on_numpy, stop_gradient, tree_map, xp
from ..checks import Array, is_traced, nan_unless
from ..element.episode import Modes
from ..material.relaxation import Relaxation
from ..surface.disc import Disc
from .creep import Creep, creep, levels_for
from .depth_history import (
    LAYERS,
    batch,
    cuts,
    edges,
    edges_of_growth,
    indent_all,
    indent_between_smooth,
    over_histories,
    padded,
)
from .refinement import beside, limit

if TYPE_CHECKING:
    from .load_steps import Edges, Marched

_LEVELS = (1, 3, 6, LAYERS)  # of the panels, coarse to fine
_TRACED_LEVELS = 12  # of the panels in time, where the times cannot be looked at
_ROUNDING = 1e-14
# per interval, in the first of three marches whose values cannot be looked at
_BLIND_STEPS = 8
_BLIND_EARLY = 4  # and within the first of them
_MOST_STEPS = 8192  # of a history: a minute and a half
_MARCHED_AT_ONCE = 8
# elements and branches that take NumPy as long as what it does besides in a step
_OF_A_STEP = 14_000
# of them and steps that are marched on NumPy, as long as JAX takes to compile
_MUCH = 6e7
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


def _breaks(sticky: Any) -> str:
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
    time, depth = (
        a.reshape(-1, a.shape[-1]) for a in padded(course.time, course.depth)
    )
    given = (law, modes, disc, time, depth)
    numpy = xp if is_traced(given) else np
    # values, unless under jit or vmap
    frozen = stop_gradient(given) if is_traced(given) else given
    growing = not is_traced(given) and bool((np.diff(frozen[-1], axis=-1) >= 0).all())
    radius = over_histories(edges_of_growth if growing else edges, *frozen)
    sums, levels = None, _LEVELS[1]
    if not is_traced(frozen):
        levels, size = _LEVELS[0], batch(len(time))
        sums = indent_all(*frozen, radius, levels, size)
        for finer in _LEVELS[1:]:
            asked = 0.5 * rtol * abs(sums.force).max(axis=-1)
            which = np.flatnonzero((sums.error > asked[:, None]).any(axis=-1))
            if not which.size:
                break
            levels = finer
            again = indent_all(
                *frozen[:3],
                frozen[3][which],
                frozen[4][which],
                radius[which],
                levels,
                size,
            )
            for field, better in zip(sums, again, strict=True):
                field[which] = better
    if sums is None or is_traced(given):  # with derivatives
        parts = np.tile(np.append(cuts(levels)[:, :-1], 1.0), (len(time), 1))
        sums, _ = over_histories(indent_between_smooth, *given, radius, parts)
    largest = abs(sums.force).max(axis=-1, keepdims=True)
    error = sums.error / (largest + (largest == 0)) + _ROUNDING
    good = numpy.isfinite(sums.force) & (error <= rtol)
    fields = (
        sums.force,
        sums.radius,
        sums.work,
        sums.stored,
        sums.locked,
        sums.heat,
        error,
        good,
    )
    fields = (_unpadded(a, shape) for a in fields)
    return Indented(course.depth, *fields, BY_DEPTH, "")


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
    numpy = xp if traced else np
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
        rows = (time[which], depth[which], load[which], by_depth[which])
        stepped = _stepped(law, modes, disc, rows, rtol)
        back = np.zeros(len(time), int)
        back[which] = np.arange(len(which))
        fields = tuple(
            numpy.where(known, a, b[back]) for a, b in zip(fields, stepped, strict=True)
        )
    depth, force, radius, work, stored, locked, heat, error = (
        a.reshape(shape) for a in fields
    )
    good = numpy.isfinite(depth) & (error <= rtol)
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
    numpy = xp if is_traced(law, modes, disc, time, load) else np
    levels = _TRACED_LEVELS if is_traced(law, time) else levels_for(law, modes, time)
    creep_history: Creep = over_histories(
        creep, law, modes, disc, *padded(time, load), levels=levels
    )
    creep_history = tree_map(lambda a: _unpadded(a, time.shape), creep_history)
    nothing = numpy.zeros(time.shape)
    error = numpy.where(numpy.isfinite(creep_history.depth), _ROUNDING, numpy.nan)
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
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    histories: tuple[Array, Array, Array, Array],  # time, depth, load, by_depth
    rtol: float,
    kept: int = 1,
) -> tuple[Array, ...]:
    """Depth, force, radius, work, stored, locked, heat and relative error, extrapolated
    from marches with ever more steps.

    Two limits that agree, and an energy balance that closes, end the series, which is
    extrapolated once more; what was left of their difference in the finer one is about
    a sixteenth, a third of it counts as the error; of limits that go on by a steady
    ratio (`steady_ratio`) the whole difference. It may vanish by chance at an instant,
    so it is not taken smaller than at its neighbours. The series ends also where
    nothing will come of it, since every march takes four times as long as the one
    before. Under jit or vmap, where nothing can be looked at, three marches are made.
    """
    from .load_steps import early_steps, extrapolated, unaccounted

    given = (law, modes, disc, *histories)
    # values, unless under jit or vmap
    frozen = stop_gradient(given) if is_traced(given) else given
    blind = is_traced(frozen)
    levels = max(kept, _BLIND_STEPS if blind else 4)
    early = _BLIND_EARLY if blind else early_steps(frozen[0], *frozen[3:], levels)
    sizes: Any = {"kept": kept, "early": early, "coarsest": levels}
    marches: list[Marched] = []
    error: Any = None
    ratio: Any = None
    if blind:
        levels *= 4
    else:
        marches, error, ratio, levels = _series(frozen, levels, sizes, rtol)
    if is_traced(given):  # with derivatives
        marches = [
            _marched(*given, levels=n, **sizes)[0]
            for n in (levels // 4, levels // 2, levels)
        ]
    if blind:
        error = _apart(limit(marches[1:], (2,)), limit(marches[:2], (2,)))
    last = extrapolated(marches, ratio)
    fits = xp.where(last.fits, 1.0, xp.nan)
    heat = nan_unless(unaccounted(last) <= rtol, last.heat)
    parts = (
        last.depth,
        last.force,
        xp.maximum(last.radius, 0.0),
        last.work,
        last.stored,
        last.locked,
        heat,
    )
    error = beside(error / 3, 1) + _ROUNDING
    return tuple(
        a if is_traced(a) else np.asarray(a)
        for a in (*(field * fits for field in parts), error)
    )


def _series(
    given: tuple, levels: int, sizes: dict[str, int], rtol: float
) -> tuple[list[Marched], Array, Array, int]:
    """Marches of ever more steps, from `levels` to so many as meet `rtol`, or will not;
    the change of their limit, the ratio of its changes, and the last number of steps.
    """
    from .load_steps import extrapolated, steady_ratio, unaccounted

    instants = given[3].shape[-1]
    marches: list[Marched] = []
    misses: list[float] = []
    edges: Any = None  # of the march before
    before: Any = None
    ratio: Any = None
    while True:
        latest, edges = _marched(*given, before=edges, levels=levels, **sizes)
        marches.append(latest)
        if len(marches) > 2:
            error = _apart(limit(marches[-2:], (2,)), limit(marches[-3:-1], (2,)))
            before, ratio = ratio, steady_ratio(marches)
            if before is not None:
                new = extrapolated(marches, ratio)
                change = _apart(new, extrapolated(marches[:-1], before))
                irregular = np.isnan(ratio + before)
                error = np.where(irregular, error, np.fmin(error, 3 * change))
            imbalance = unaccounted(extrapolated(marches, ratio))
            missed = np.fmax(error / 3, imbalance) / rtol
            misses.append(float(np.fmax.reduce(missed, axis=None, initial=0.0)))
            early = levels // sizes["coarsest"] * sizes["early"]
            steps = levels * (instants - 1) + early
            if misses[-1] <= 1 or _hopeless(misses, int(np.log2(_MOST_STEPS / steps))):
                return marches, error, ratio, levels
        levels *= 2


def _hopeless(misses: list[float], left: int) -> bool:
    """Whether the last miss, a multiple of what is asked, does not become 1 when the
    steps are halved `left` times, each time with twice the gain of the best of the last
    halvings.
    """
    gains = [before / after for before, after in itertools.pairwise(misses[-3:])]
    return left < 1 or (len(gains) > 1 and misses[-1] > (2 * max(gains)) ** left)


def _apart(new: Marched, old: Marched) -> Array:
    """Difference of two histories in depth and force."""
    return _change(new.depth, old.depth) + _change(new.force, old.force)


def _change(new: Array, old: Array) -> Array:
    """Difference of two histories, relative to the largest value of each."""
    largest = abs(new).max(axis=-1, keepdims=True)
    return abs(new - old) / (largest + (largest == 0))


def _marched(
    law: Any,
    modes: Modes,
    disc: Disc,
    *histories: Array,
    before: Edges | None = None,
    **sizes: int,
) -> tuple[Marched, Edges]:
    """`march_load` for every history; a few at once, since each takes memory for all of its
    elements.
    """
    from .load_steps import Edges, march_load

    count, instants = histories[0].shape
    steps = sizes["levels"] * (instants - 1)
    parts = _OF_A_STEP + 3 * steps * (law.moduli.shape[0] + 3)
    if on_numpy() and count * steps * parts > _MUCH:
        return on_jax(_marched, law, modes, disc, *histories, before=before, **sizes)
    law, modes, disc = arrays((law, modes, disc))
    numpy = xp if is_traced(law, disc, *histories) else np
    size = count if on_numpy() else min(_MARCHED_AT_ONCE, 1 << (count - 1).bit_length())
    # Longer to run, but what takes long for a few is to compile.
    out, room = [], count <= 2 and numpy is np and not on_numpy()
    for i in range(0, count, size):
        which = np.minimum(np.arange(i, i + size), count - 1)
        rows = [numpy.asarray(a)[which] for a in histories]
        known = (
            None
            if before is None or numpy is not np
            else Edges(*(a[which] for a in before))
        )
        out.append(
            march_load(law, modes, disc, *rows, room=room, before=known, **sizes)
        )
    return tree_map(
        lambda *parts: numpy.concatenate([numpy.asarray(p) for p in parts])[:count],
        *out,
    )


def refined(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    course: DepthOrLoad,
    depth: Array,
    rtol: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Time and depth of one history, between which the depth is close to linear: as
    given, or solved in between.
    """
    if course.load is None:
        return np.asarray(course.time), np.asarray(depth)
    from .load_steps import places

    kept = 2 ** int(np.clip(np.log2(_KNOTS / len(course.time)), 0, 5))
    fractions = places(kept)[1:]
    time = np.append(
        course.time[0],
        course.time[:-1, None] + np.diff(course.time)[:, None] * fractions,
    )
    if course.by_depth is None:
        load = np.append(
            course.load[0],
            course.load[:-1, None] + np.diff(course.load)[:, None] * fractions,
        )
        creep_history = creep(law, modes, disc, *padded(time, load), levels=3)
        creep_history = tree_map(
            lambda a: _unpadded(np.asarray(a), time.shape), creep_history
        )
        if creep_history.growing.all():
            return time, creep_history.depth
    by_depth = (
        np.zeros(len(depth), bool) if course.by_depth is None else course.by_depth
    )
    given = (
        np.zeros(len(depth)) if course.depth is None else np.nan_to_num(course.depth)
    )
    row = (
        course.time[None],
        given[None],
        np.nan_to_num(course.load)[None],
        by_depth[None],
    )
    return time, np.asarray(_stepped(law, modes, disc, row, rtol, kept)[0][0])


def _unpadded(a: Array, shape: tuple[int, ...]) -> Array:
    """Back to the instants asked for: the last one, and those before the interval that
    was divided.
    """
    kept = [*range(shape[-1] - 1), a.shape[-1] - 1]
    return a[..., np.array(kept)].reshape(shape)
