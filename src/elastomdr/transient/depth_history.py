"""Depth-controlled indentation under any history: every element on its own, exact in
time, Gauss' rule in space.

The depth is linear between instants. The elements in contact always form a disc
(derived here: by the signs of a viscoelastic element du/dg stays between -1 and 0, so
that u + g never falls with x), whose edge at every instant is a root in x. Between
neighbouring edges force density and displacement are smooth in x: panels of Gauss' rule
that end at all the edges sum forces and energies without an error from the moving
contact. The panels narrow towards their ends as far as short relaxation times ask for
it. Their places carry no derivative, since the sums do not depend on them.

Three kinds of integrand. Smooth in x, where the Legendre coefficients of a panel fall
geometrically and tell the error. A power x^s that is not whole, at the axis, where they
fall as j^-(2s+1) and the error is a known part of the last ones. And a layer at an edge
that advances: an element touched a time t ago carries E_k v tau_k (1 - exp(-t/tau_k)),
so that where v tau_k/g' is far below a panel no node sees the exponential, of which the
sum then is too large by its integral.

Many histories are computed at once, in batches.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import compiled, fori_loop, on_numpy, scan, stop_gradient, tree_map, xp
from ..checks import Array, is_traced
from ..element.episode import EpisodeState, Modes, energies, follow, force, pressed
from ..material.relaxation import Relaxation
from ..numerics.quadrature import gauss, gauss_on_panels, shares_to_legendre
from ..surface.disc import Disc

if TYPE_CHECKING:
    from jaxtyping import Float

_COARSE = 49  # elements that bracket the edges, at least
_SEARCH = 8  # steps of that search
# change of a force, relative, below which it does not show where the edge is
_FLAT = 1e-9
NODES = 6  # per panel
_RATIO = 0.2  # of neighbouring panels within one that narrows
_NARROWING = {1: 1, 2: 2, 3: 3}  # levels: how often their panels narrow
# the same of higher levels, and of those that look for layers
_NARROWEST, _DEEP = 4, 13
LAYERS = 7  # the level from which panels narrow that far
_IN_A_ROW = 2  # parts of a panel that are summed at once
_SAFETY = 2.0  # on the error of a power at the axis
# on that of a layer, which is wider than v tau/g' where the profile is curved
_CURVED = 1.1
_BATCH = 64  # histories computed at once


class DepthHistory(NamedTuple):
    """An indentation at m instants."""

    force: Float[Array, " m"]  # [N]
    radius: Float[Array, " m"]  # of the contact [m]
    work: Float[Array, " m"]  # int F dd [J]
    stored: Float[Array, " m"]  # elastic energy of the elements in contact [J]
    locked: Float[Array, " m"]  # elastic energy of the elements that are free [J]
    heat: Float[Array, " m"]  # of branches and dashpot [J]
    error: Float[Array, " m"]  # of the force, estimated [N]


class LastRow(NamedTuple):
    """The elements at the last instant."""

    edges: Float[Array, " panels+1"]  # [m]
    x: Float[Array, "panels n"]  # places [m]
    q: Float[Array, "panels n"]  # force density
    u: Float[Array, "panels n"]  # displacement [m]


def indent_between(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: Array,
    depth: Array,
    radius: Array,
    parts: Array,
) -> tuple[DepthHistory, LastRow]:
    """Force and energies of the elements in some parts of each panel between the edges
    `radius`, cut at `parts`.

    The depth is linear between the m instants, depth[0] being a step. Sums over all
    parts are those of the contact.
    """
    between = xp.sort(xp.append(radius, 0.0))
    edges = between[:-1, None] + xp.diff(between)[:, None] * parts
    x, dx = (nodes.reshape(-1) for nodes in gauss_on_panels(edges, NODES))
    begin = edges[:, :-1].reshape(-1)
    weight = disc.weight(x) * dx

    def measure(state: EpisodeState, q: Array) -> tuple[Array, ...]:
        held, left = energies(law, modes, state)
        sums = [
            xp.sum(weight * density)
            for density in (q, state.work, held, left, state.heat)
        ]
        return *sums, missed(weight * q, begin, disc)

    state, q, (total, work, stored, locked, heat, error) = _run(
        law, modes, disc.profile(x), time, depth, measure
    )
    if law.moduli.size and not disc.flat:
        layers = missed_layers(law, disc, time, depth, radius, parts[1] - parts[0])
        error = error + xp.where(parts[0] == 0, layers, 0.0)
    rows = (-1, NODES)
    return DepthHistory(total, radius, work, stored, locked, heat, error), LastRow(
        xp.append(begin, edges[-1, -1]),
        x.reshape(rows),
        q.reshape(rows),
        state.u.reshape(rows),
    )


def indent_between_smooth(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: Array,
    depth: Array,
    radius: Array,
    parts: Array,
) -> tuple[DepthHistory, LastRow]:
    """The same; the edges get their own derivatives, by a Newton step."""
    if disc.flat:
        return indent_between(law, modes, disc, time, depth, radius, parts)

    def residual(x: Array) -> Array:
        return xp.diagonal(_signed(law, modes, disc.profile(x), time, depth)[0])

    import jax

    off, slope = jax.jvp(residual, (radius,), (xp.ones_like(radius),))
    slope = stop_gradient(slope)
    moved = xp.where(
        (slope < 0) & (radius > 0), off / xp.where(slope < 0, slope, 1.0), 0.0
    )
    radius = radius - (moved - stop_gradient(moved))
    return indent_between(law, modes, disc, time, depth, radius, parts)


def _run(
    law: Relaxation,
    modes: Modes,
    g: Array,
    time: Array,
    depth: Array,
    measure: Callable[..., Any],
) -> tuple[EpisodeState, Array, Any]:
    """Elements of profile g through the whole history; `measure(state, q)` is kept for
    every instant.
    """
    start = pressed(law, modes, depth[0] - g)

    def step(
        state: EpisodeState, interval: tuple[Array, Array, Array]
    ) -> tuple[EpisodeState, Any]:
        d, h, v = interval
        state = follow(law, modes, state, d - g, v, h)
        return state, measure(state, force(law, state, v))

    h = xp.diff(time)
    v = xp.diff(depth) / h
    last, kept = scan(step, start, (depth[:-1], h, v))
    first = measure(start, force(law, start, 0.0))
    return (
        last,
        force(law, last, v[-1]),
        tree_map(lambda a, b: xp.concatenate([a[None], b]), first, kept),
    )


def _signed(
    law: Relaxation, modes: Modes, g: Array, time: Array, depth: Array
) -> tuple[Array, Array]:
    """At every instant, for elements of profile g: the force density in contact, or
    minus the gap to the surface times a stiffness; and whether they are free. Falls
    with g; the edge of the contact is where it passes zero. Shape (m, n).
    """
    scale = law.equilibrium + xp.sum(law.moduli)
    scale = xp.where(scale > 0, scale, law.viscosity / (time[-1] - time[0]))
    value, free = _run(
        law,
        modes,
        g,
        time,
        depth,
        lambda s, q: (xp.where(s.contact, q, s.u + g), ~s.contact),
    )[2]
    return xp.where(free, scale * (depth[:, None] - value), value), free


def _secant(near: tuple[Array, Array], far: tuple[Array, Array]) -> Array:
    """Where the line through two places, (g, residual) each, is zero."""
    rise = near[1] - far[1]
    return near[0] - near[1] * (near[0] - far[0]) / xp.where(
        _carry_the_same(near, far), xp.inf, rise
    )


def _choose(new: Any, old: Any, where: Array) -> Any:
    return tree_map(lambda n, o: xp.where(where, n, o), new, old)


def edges(
    law: Relaxation, modes: Modes, disc: Disc, time: Array, depth: Array
) -> Array:
    """Radius of the contact at every instant, by secants from both sides of the edge,
    where the residual has a kink.

    With a dashpot it has a jump. The secants run in g: what an element has seen depends
    on x through g alone, and the gap to rubber that was not touched before is linear in
    it, however small the contact. They begin at neighbours of a grid, which the first
    round looks at. A search on one side, as in `numerics/root.py`, would meet the kink.
    """
    if disc.flat:
        _, free = _signed(law, modes, xp.zeros(1), time, depth)
        return xp.where(free[:, 0], 0.0, disc.shape.largest_contact)
    reach = disc.radius_of_depth(xp.max(depth))
    # so that every edge lies inside
    reach = xp.minimum(1.02 * reach, 0.5 * reach + 0.5 * disc.largest)
    m, size = depth.size, max(depth.size, _COARSE)
    grid = disc.profile(reach * xp.linspace(0.0, 1.0, size))

    def search(i: Any, bracket: tuple) -> tuple:
        count, ends = bracket
        inner, inner_far, outer, outer_far = ends
        g = 0.5 * (inner[0] + outer[0])
        for guess in (_secant(outer, outer_far), _secant(inner, inner_far)):
            g = xp.where((guess > inner[0]) & (guess < outer[0]), guess, g)
        looked = xp.where(i == 0, grid, xp.pad(g, (0, size - m)))
        value, free = _signed(law, modes, looked, time, depth)

        def pick(j: Array) -> tuple[Array, Array]:
            j = xp.clip(j, 0, size - 1)
            return xp.take(grid, j), xp.take_along_axis(value, j[:, None], axis=1)[:, 0]

        touched = xp.sum(~free, axis=1)  # elements in contact, the innermost ones
        first = (pick(touched - 1), pick(touched - 2), pick(touched), pick(touched + 1))
        new, free = (g, xp.diagonal(value)), xp.diagonal(free)
        closer = (
            _choose(new, inner, ~free),
            _choose(inner, inner_far, ~free),
            _choose(new, outer, free),
            _choose(outer, outer_far, free),
        )
        return _choose(touched, count, i == 0), _choose(first, closer, i == 0)

    nowhere = (xp.zeros(m), xp.zeros(m))
    start = (xp.zeros(m, int), (nowhere,) * 4)
    count, (inner, inner_far, outer, outer_far) = fori_loop(
        0, _SEARCH + 1, search, start
    )
    g = _secant(inner, inner_far)
    outside = xp.clip(_secant(outer, outer_far), inner[0], outer[0])
    # Where the force jumps at the edge, or falls within less than was looked at, it
    # does not tell where; the gap does.
    other = xp.where(inner[1] > -outer[1], outside, inner[0])
    g = xp.where(
        (g >= inner[0]) & (g <= outer[0]) & ~_carry_the_same(inner, inner_far), g, other
    )
    return xp.where(count > 0, disc.radius_of_depth(g), 0.0)


def edges_of_growth(
    law: Relaxation, modes: Modes, disc: Disc, time: Array, depth: Array
) -> Array:
    """The same where the depth never falls: the edge is that of the undeformed
    surface.
    """
    return disc.radius_of_depth(depth)


def _carry_the_same(near: tuple[Array, Array], far: tuple[Array, Array]) -> Array:
    """Whether two elements carry the same but for rounding."""
    return xp.abs(near[1] - far[1]) <= _FLAT * xp.abs(near[1])


def cuts(levels: int) -> Float[np.ndarray, "rows n"]:
    """Where panels are cut, from 0 to 1, in rows of a few parts each: of one size on
    all levels, from 1 to `LAYERS`.
    """
    fractions = np.append(_fractions(levels), 1.0)
    return fractions[
        np.arange(0, len(fractions) - 1, _IN_A_ROW)[:, None] + np.arange(_IN_A_ROW + 1)
    ]


@functools.cache
def _fractions(levels: int) -> np.ndarray:
    """Where the parts of a panel begin, from 0 to 1."""
    deep = _NARROWING.get(levels, _NARROWEST if levels < LAYERS else _DEEP)
    left = 0.5 * _RATIO ** np.arange(deep - 1, -1.0, -1)
    ends = np.concatenate([[0.0], left, 1 - left[-2::-1], [1.0]])
    parts = 1 + min(levels, LAYERS - 1) // 2
    return (ends[:-1, None] + np.diff(ends)[:, None] * np.arange(parts) / parts).ravel()


def missed(
    shares: Float[Array, " n"], begin: Float[Array, " panels"], disc: Disc
) -> Float[Array, ""]:
    """What Gauss' rule misses of an integral, from the nodes' shares of it; layers
    apart. Panels begin at `begin`.

    About the Legendre coefficient 2 `NODES`, four times as far from the last even and
    odd ones as those are from the ones before, by geometric fall (kept apart: a
    parabola would hide in the second how the others fall). In the panel at the axis of
    a profile c x^n, n not whole, what the rule misses of that power.
    """
    size = xp.abs(shares.reshape(-1, NODES) @ xp.asarray(shares_to_legendre(NODES)).T)
    before, last = size[:, 2:4], size[:, 4:6]
    error = xp.sum(
        last * xp.minimum(last / xp.where(before > 0, before, 1.0), 1.0) ** 4, axis=1
    )
    power, _ = disc._power()
    if power is not None and power != int(power):
        at_axis = (
            _SAFETY * _of_power(power + (disc.kind == "layer")) * xp.max(last, axis=1)
        )
        error = xp.where(begin == 0, xp.maximum(error, at_axis), error)
    return xp.sum(error)


def missed_layers(
    law: Relaxation,
    disc: Disc,
    time: Array,
    depth: Array,
    radius: Float[Array, " m"],
    panel_share: Array,
) -> Float[Array, " m"]:
    """What the panels miss of layers at the edges: sum over W E_k v tau_k w_k r(q), [N]
    at every instant.

    `panel_share` is the share of a panel between two edges that the part of it at an
    edge has.

    w_k = v tau_k/g'(a) is the layer's width, W the weight at the edge, q the widths in
    a panel that ends there (less of the layer is left in panels further in), r what the
    rule misses of an exponential over its integral. A layer fades with its branch after
    its instant. Holds for rubber that is touched for the first time; elsewhere an
    estimate.
    """
    law, disc, time, depth, radius = stop_gradient((law, disc, time, depth, radius))
    h = xp.diff(time)
    pressing = xp.maximum(xp.diff(depth) / h, 0.0)
    ends = xp.sort(xp.append(radius, 0.0))
    panel = xp.diff(ends) * panel_share
    edge = radius[1:]
    slope = disc.slope(xp.where(edge > 0, edge, 1.0))
    width = xp.where(edge > 0, pressing / slope, 0.0)[:, None] * law.times  # (m-1, k)
    behind = edge[:, None] - ends[1:]  # of every panel
    fits = xp.maximum(panel, 1e-300) / xp.where(width > 0, width, 1.0)[..., None]
    # From above within a factor of 15 for q from 5 on, of 2 from 60 on; r = 1 - (...)/q
    # once no node sees the layer.
    unseen = (
        85 / fits * xp.exp(-((fits / 80) ** 1.5))
        + xp.maximum(behind, 0.0)[:, None] / xp.where(panel > 0, panel, 1.0) * fits
    )
    unseen = xp.where((behind >= 0)[:, None] & (panel > 0), xp.exp(-unseen), 0.0)
    size = _CURVED * width * unseen.sum(-1)
    amount = (
        disc.weight(edge)[:, None] * law.moduli * pressing[:, None] * law.times * size
    )

    def fading(left: Array, new: tuple[Array, Array]) -> tuple[Array, Array]:
        left = left * xp.exp(-new[0] / law.times) + new[1]
        return left, xp.sum(left)

    _, total = scan(fading, xp.zeros_like(law.times), (h, amount))
    return xp.append(0.0, total)


@functools.cache
def _of_power(s: float) -> float:
    """What the rule misses of int x^s over a panel at x = 0, over the larger of the
    last two coefficients.
    """
    nodes, weights = gauss(NODES)
    shares = 0.5 * weights * (0.5 + 0.5 * nodes) ** s
    last = np.abs(shares_to_legendre(NODES) @ shares)[-2:].max()
    return abs(shares.sum() - 1 / (s + 1)) / last


def over_histories(
    function: Callable[..., Any],
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    *histories: Any,
    levels: int | None = None,
) -> Any:
    """`function` for every history, where JAX computes in one compiled call; NumPy
    arrays unless traced.
    """
    count = histories[0].shape[0]
    if on_numpy():
        static = {} if levels is None else {"levels": levels}
        by_history = [
            function(law, modes, disc, *(h[i] for h in histories), **static)
            for i in range(count)
        ]
        return tree_map(lambda *a: np.stack(a), *by_history)
    size = batch(count)
    more = -count % size
    traced = is_traced(law, modes, disc, *histories)
    numpy = xp if traced else np
    filled_up = tuple(
        numpy.concatenate([h, numpy.repeat(h[:1], more, axis=0)]) if more else h
        for h in histories
    )
    out = _mapped(
        law, modes, disc, *filled_up, function=function, levels=levels, size=size
    )
    return tree_map(lambda a: a[:count] if traced else np.asarray(a)[:count], out)


def batch(count: int) -> int:
    """How many of `count` histories are computed at once."""
    return min(_BATCH, 1 << (count - 1).bit_length())


@compiled("function", "levels", "size")
def _mapped(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    *histories: Any,
    function: Callable[..., Any],
    levels: int | None,
    size: int,
) -> Any:
    import jax

    static = {} if levels is None else {"levels": levels}

    def one(history: tuple[Array, ...]) -> Any:
        return function(law, modes, disc, *history, **static)

    if histories[0].shape[0] == size:
        return jax.vmap(one)(histories)
    return jax.lax.map(one, histories, batch_size=size)


def indent_all(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: np.ndarray,
    depth: np.ndarray,
    radius: np.ndarray,
    levels: int,
) -> DepthHistory:
    """Depths that are linear between the instants, (histories, m), with panels of a
    level between the edges; on NumPy.
    """
    parts = np.tile(np.append(cuts(levels)[:, :-1], 1.0), (len(time), 1))
    history_sums, _ = over_histories(
        indent_between, law, modes, disc, time, depth, radius, parts
    )
    return history_sums._replace(radius=np.array(radius))
