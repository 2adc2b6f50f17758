"""Depth-controlled indentation under any history: every element on its own, exact in
time, Gauss' rule in space.

The depth is linear between instants. The elements in contact always form a disc
(derived here: by the signs of a viscoelastic element du/dg stays between -1 and 0, so
that u + g never falls with x), whose edge at every instant is a root in x. Between
neighbouring edges force density and displacement are smooth in x: panels of Gauss' rule
that end at all the edges sum forces and energies without an error from the moving
contact. The panels narrow towards their ends as far as short relaxation times ask for
it. Their places carry no derivative, since the sums do not depend on them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import fixed, fori_loop, in_steps, mapped, on_numpy, xp
from ..checks import Array, is_traced
from ..element.episode import Modes, Touching, energies, follow, force, pressed
from ..material.relaxation import Relaxation
from ..numerics.quadrature import gauss_on_panels
from ..surface.disc import Disc
from .panels import NODES, missed, missed_layers

if TYPE_CHECKING:
    from jaxtyping import Float

_COARSE = 49  # elements that bracket the edges, at least
_SEARCH = 8  # steps of that search
# change of a force, relative, below which it does not show where the edge is
_FLAT = 1e-9
_SIZES = (32, 64, 104, 208, 320, 512)  # numbers of instants that are compiled


class History(NamedTuple):
    """An indentation at m instants."""

    force: Float[Array, " m"]  # [N]
    radius: Float[Array, " m"]  # of the contact [m]
    work: Float[Array, " m"]  # int F dd [J]
    stored: Float[Array, " m"]  # elastic energy of the elements in contact [J]
    locked: Float[Array, " m"]  # elastic energy of the elements that are free [J]
    heat: Float[Array, " m"]  # of branches and dashpot [J]
    error: Float[Array, " m"]  # of the force, estimated [N]


class Row(NamedTuple):
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
) -> tuple[History, Row]:
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

    def measure(state: Touching, q: Array) -> tuple[Array, ...]:
        held, left = energies(law, modes, state)
        sums = [
            xp.sum(weight * part) for part in (q, state.work, held, left, state.heat)
        ]
        return *sums, missed(weight * q, begin, disc)

    state, q, (total, work, stored, locked, heat, error) = _run(
        law, modes, disc.profile(x), time, depth, measure
    )
    if law.moduli.size and not disc.flat:
        layers = missed_layers(law, disc, time, depth, radius, parts[1] - parts[0])
        error = error + xp.where(parts[0] == 0, layers, 0.0)
    rows = (-1, NODES)
    return History(total, radius, work, stored, locked, heat, error), Row(
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
) -> tuple[History, Row]:
    """The same; the edges get their own derivatives, by a Newton step."""
    if disc.flat:
        return indent_between(law, modes, disc, time, depth, radius, parts)

    def residual(x: Array) -> Array:
        return xp.diagonal(_signed(law, modes, disc.profile(x), time, depth)[0])

    import jax

    off, slope = jax.jvp(residual, (radius,), (xp.ones_like(radius),))
    slope = fixed(slope)
    moved = xp.where(
        (slope < 0) & (radius > 0), off / xp.where(slope < 0, slope, 1.0), 0.0
    )
    radius = radius - (moved - fixed(moved))
    return indent_between(law, modes, disc, time, depth, radius, parts)


def padded(*histories: Any, like: int = 0) -> tuple[Any, ...]:
    """Histories with their last interval divided where JAX computes, so that few sizes
    are compiled; instants along the last axis.

    The size is that of a history of `like` instants, if that is more.
    """
    if on_numpy():
        return histories
    count = histories[0].shape[-1]
    size = _size(max(count, like))
    part = np.arange(1, size - count + 1) / (size - count + 1)

    def pad(a: Any) -> Any:
        numpy = xp if is_traced(a) else np
        inner = a[..., -2:-1] + (a[..., -1:] - a[..., -2:-1]) * part
        return numpy.concatenate([a[..., :-1], inner, a[..., -1:]], axis=-1)

    return tuple(pad(a) for a in histories)


def _size(count: int) -> int:
    return next(
        n
        for n in itertools.chain(_SIZES, itertools.count(2 * _SIZES[-1], _SIZES[-1]))
        if n >= count
    )


def _run(
    law: Relaxation,
    modes: Modes,
    g: Array,
    time: Array,
    depth: Array,
    measure: Callable[..., Any],
) -> tuple[Touching, Array, Any]:
    """Elements of profile g through the whole history; `measure(state, q)` is kept for
    every instant.
    """
    start = pressed(law, modes, depth[0] - g)

    def step(
        state: Touching, interval: tuple[Array, Array, Array]
    ) -> tuple[Touching, Any]:
        d, h, v = interval
        state = follow(law, modes, state, d - g, v, h)
        return state, measure(state, force(law, state, v))

    h = xp.diff(time)
    v = xp.diff(depth) / h
    last, kept = in_steps(step, start, (depth[:-1], h, v))
    first = measure(start, force(law, start, 0.0))
    return (
        last,
        force(law, last, v[-1]),
        mapped(lambda a, b: xp.concatenate([a[None], b]), first, kept),
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


def edges(
    law: Relaxation, modes: Modes, disc: Disc, time: Array, depth: Array
) -> Array:
    """Radius of the contact at every instant, by secants from both sides of the edge,
    where the residual has a kink.

    With a dashpot it has a jump. The secants run in g: what an element has seen depends
    on x through g alone, and the gap to rubber that was not touched before is linear in
    it, however small the contact. They begin at neighbours of a grid, which the first
    round looks at.
    """
    if disc.flat:
        _, free = _signed(law, modes, xp.zeros(1), time, depth)
        return xp.where(free[:, 0], 0.0, disc.shape.largest_contact)
    reach = disc.radius_of_depth(xp.max(depth))
    # so that every edge lies inside
    reach = xp.minimum(1.02 * reach, 0.5 * reach + 0.5 * disc.largest)
    m, size = depth.size, max(depth.size, _COARSE)
    grid = disc.profile(reach * xp.linspace(0.0, 1.0, size))

    def secant(near: tuple[Array, Array], far: tuple[Array, Array]) -> Array:
        rise = near[1] - far[1]
        return near[0] - near[1] * (near[0] - far[0]) / xp.where(
            _level(near, far), xp.inf, rise
        )

    def choose(new: Any, old: Any, where: Array) -> Any:
        return mapped(lambda n, o: xp.where(where, n, o), new, old)

    def search(i: Any, found: tuple) -> tuple:
        count, ends = found
        inner, inner_far, outer, outer_far = ends
        g = 0.5 * (inner[0] + outer[0])
        for guess in (secant(outer, outer_far), secant(inner, inner_far)):
            g = xp.where((guess > inner[0]) & (guess < outer[0]), guess, g)
        looked = xp.where(i == 0, grid, xp.pad(g, (0, size - m)))
        value, free = _signed(law, modes, looked, time, depth)

        def pick(j: Array) -> tuple[Array, Array]:
            j = xp.clip(j, 0, size - 1)
            return grid[j], xp.take_along_axis(value, j[:, None], axis=1)[:, 0]

        touched = xp.sum(~free, axis=1)  # elements in contact, the innermost ones
        first = (pick(touched - 1), pick(touched - 2), pick(touched), pick(touched + 1))
        new, free = (g, xp.diagonal(value)), xp.diagonal(free)
        closer = (
            choose(new, inner, ~free),
            choose(inner, inner_far, ~free),
            choose(new, outer, free),
            choose(outer, outer_far, free),
        )
        return choose(touched, count, i == 0), choose(first, closer, i == 0)

    nowhere = (xp.zeros(m), xp.zeros(m))
    start = (xp.zeros(m, int), (nowhere,) * 4)
    count, (inner, inner_far, outer, outer_far) = fori_loop(
        0, _SEARCH + 1, search, start
    )
    g, outside = (
        secant(inner, inner_far),
        xp.clip(secant(outer, outer_far), inner[0], outer[0]),
    )
    # Where the force jumps at the edge, or falls within less than was looked at, it
    # does not tell where; the gap does.
    other = xp.where(inner[1] > -outer[1], outside, inner[0])
    g = xp.where(
        (g >= inner[0]) & (g <= outer[0]) & ~_level(inner, inner_far), g, other
    )
    return xp.where(count > 0, disc.radius_of_depth(g), 0.0)


def edges_of_growth(
    law: Relaxation, modes: Modes, disc: Disc, time: Array, depth: Array
) -> Array:
    """The same where the depth never falls: the edge is that of the undeformed
    surface.
    """
    return disc.radius_of_depth(depth)


def _level(near: tuple[Array, Array], far: tuple[Array, Array]) -> Array:
    """Whether two elements carry the same but for rounding."""
    return xp.abs(near[1] - far[1]) <= _FLAT * xp.abs(near[1])
