"""Indentation under a load that lets the contact shrink, or under depth and load in turn: marched by the exact contact
step.

Each interval is divided into steps that narrow towards its ends, where the material answers fastest and where a contact
begins or ends; after a load that is put on at once geometrically, down to the shortest relaxation time, since the depth
then follows every branch, and what branches turn into heat is lost from the balance where that is not resolved. In a
step an element carries q = S (w - u_free) wherever that is positive (`foundation.step`), so that the force is a convex,
piecewise linear function of the depth at the end of the step: Newton's method finds the depth that carries the load in
finitely many steps. The elements are Gauss nodes on panels that end at the edges of the contact at all instants; these
are found by marching a few times, each time on the edges of the march before. Of second order in the step; the limit is
extrapolated from halved steps.
"""

import itertools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, is_traced
from ..foundation.decay import phi1
from ..foundation.modes import Modes
from ..foundation.step import Elements, advance, coefficients, lag, released, rest
from ..mapping.disc import Disc, gauss
from ..material.relaxation import Relaxation
from .carried import settle

_NODES = 3  # per panel between the edges
_INNER = 16  # per panel of what never parts: few panels, whatever the steps, and a profile may rise as r^40
_MARCHES = 4  # to find the edges
_GRADING = 3  # power by which steps narrow
_TIP = np.concatenate([[0.0], 0.3 ** np.arange(12.0, -1.0, -1)])
_EARLY = 4.0  # ratio of the first steps after a sudden load, and share of the shortest time with which they begin
_MOST_EARLY = 24
_SIZES = (128, 512)  # numbers of steps that short marches are filled up to


class Steps(NamedTuple):
    """What rules in each of the steps of a history, and how far they are on their way to the next instant."""

    h: Float[Array, " s"]  # [s]
    part: Float[Array, " s"]  # of the interval, at the end of the step
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


def march(
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
    early: int = 0,  # by how many more the first step of the coarsest march of the series is divided
    coarsest: int | None = None,  # steps per interval of that march, if it is not this one
    room: bool = False,  # steps are added at the end, so that few sizes are compiled
) -> Marched:
    """One march of b histories at a given number of steps. Differentiable in both modes."""
    coarsest = coarsest or levels
    xp: Any = jnp if is_traced(law, time, depth, load) else np  # NumPy has nothing to compile for a new size
    target = xp.where(by_depth, depth, load)
    batch, intervals = time.shape[0], time.shape[1] - 1
    part = np.tile(places(levels), (batch, intervals, 1))
    early_ends = _early(xp, law, time[:, 1:2] - time[:, :1], levels, coarsest, early)
    rest_of_first, others = part[:, 0, 1 + levels // coarsest :], part[:, 1:, 1:].reshape(batch, -1)
    share = xp.concatenate([early_ends, rest_of_first, others], axis=1)
    more = early * (levels // coarsest)
    interval = np.repeat(np.arange(intervals), [levels + more] + [levels] * (intervals - 1))
    first = np.append(True, np.diff(interval) > 0)
    before = xp.where(first, 0.0, xp.concatenate([share[:, :1], share[:, :-1]], axis=1))
    steps = Steps(
        h=xp.diff(time)[:, interval] * (share - before),
        part=share,
        first=np.tile(first, (batch, 1)),
        by_depth=by_depth[:, 1:][:, interval],
        target=target[:, 1:][:, interval],
    )
    if room:
        size = next((n for n in _SIZES if n >= interval.size), interval.size)
        held = np.minimum(np.arange(size), interval.size - 1)
        steps = jax.tree.map(lambda a: a[:, held], steps)
    reach = jax.lax.stop_gradient(_reach(modes, disc, time, depth, load, by_depth))
    fixed = jax.lax.stop_gradient((law, disc, steps, (target[:, 0], by_depth[:, 0]), reach))
    radius = reach[:, None] * np.linspace(0.0, 1.0, steps.h.shape[1] + 2)[1:]
    if is_traced(fixed):  # a loop, since there the code of every march is compiled
        radius = jax.lax.fori_loop(0, _MARCHES - 1, lambda _, radius: _all(*fixed, radius)[1], radius)
    else:
        for _ in range(_MARCHES - 1):
            radius = _all(*fixed, radius)[1]
    sums, radius, fits = _all(law, disc, steps, (target[:, 0], by_depth[:, 0]), reach, radius)
    every = np.arange(intervals * kept + 1) * (levels // kept)
    every[1:] += more
    return Marched(*(xp.asarray(a)[:, every] for a in (*sums[:2], radius, *sums[2:], fits)))


def extrapolated(marches: list[Marched]) -> Marched:
    """The limit of marches of ever more steps."""
    # An element that is touched or lost within a step errs by the cube of the step in what it receives.
    return limit(marches, (2, 4, 6))._replace(heat=limit(marches, (2, 3, 4)).heat)


def unaccounted(found: Marched) -> Array:
    """Work that was neither stored nor turned into heat, relative to the largest work of the history."""
    largest = abs(found.work).max(axis=-1, keepdims=True)
    return abs(found.work - found.stored - found.locked - found.heat) / (largest + (largest == 0))


def limit(marches: list[Marched], powers: tuple[int, ...]) -> Marched:
    """The last marches, each with twice the steps of the one before, without the given powers of the step."""
    rows = marches[-1 - len(powers) :]
    for power in powers[: len(rows) - 1]:
        gain = 2**power - 1
        rows = [
            jax.tree.map(lambda a, b: a & b if b.dtype == bool else b + (b - a) / gain, *pair)  # noqa: B023
            for pair in itertools.pairwise(rows)
        ]
    return rows[-1]


def places(levels: int) -> np.ndarray:
    """Divisions of [0, 1] that narrow towards both ends; those of `levels` are among those of twice as many."""
    place = np.linspace(0.0, 1.0, levels + 1) ** _GRADING
    return place / (place + place[::-1])


def early_steps(law: Relaxation, time: Any, depth: Any, load: Any, by_depth: Any, coarsest: int) -> int:
    """How many more steps the first one after a sudden load is divided into, in the coarsest march; values known."""
    times = np.asarray(law.times)[np.asarray(law.moduli) > 0]
    sudden = np.where(by_depth, depth, load)[:, 0] > 0
    if not times.size or not sudden.any():
        return 0
    first = places(coarsest)[1] * float(np.max(time[:, 1] - time[:, 0]))
    return int(np.clip(np.ceil(np.log(_EARLY * first / times.min()) / np.log(_EARLY)), 0, _MOST_EARLY))


def _early(xp: Any, law: Relaxation, h: Array, levels: int, coarsest: int, early: int) -> Array:
    """Ends of the steps within the first one of the coarsest march, as parts of the first interval; (b, steps)."""
    first, finer = places(coarsest)[1], levels // coarsest
    if not early:
        return np.tile(places(levels)[1 : 1 + finer], (h.shape[0], 1))
    moduli, times, h = jax.lax.stop_gradient((law.moduli, law.times, h))
    shortest = xp.min(xp.where(xp.asarray(moduli) > 0, xp.asarray(times), xp.inf), initial=xp.inf)
    # Not above 1/_EARLY: no step may be without length where no branch is short.
    ratio = xp.minimum(shortest / (_EARLY * first * xp.asarray(h)), 1 / _EARLY) ** (1 / early)
    knots = first * ratio ** np.arange(early, -1.0, -1)
    knots = xp.concatenate([xp.zeros_like(ratio), knots], axis=1)
    return (knots[:, :-1, None] + xp.diff(knots)[..., None] * np.arange(1, finer + 1) / finer).reshape(h.shape[0], -1)


def _once(
    law: Relaxation, disc: Disc, steps: Steps, start: tuple[Array, Array], reach: Array, edges: Array
) -> tuple[tuple[Array, ...], Array, Array]:
    """(depth, force, work, stored, locked, heat), contact radius, whether the shape was wide enough, at every step."""
    tip = jnp.min(jnp.where(edges > 0, edges, reach)) * _TIP  # a light load is carried near the axis
    outer = jnp.sort(jnp.append(jax.lax.stop_gradient(edges), tip[-1]))
    rules = (np.polynomial.legendre.leggauss(n) for n in (_INNER, _NODES))
    parts = [gauss(ends, *rule) for ends, rule in zip((tip, jnp.maximum(outer, tip[-1])), rules, strict=True)]
    x, dx = (jnp.concatenate(part) for part in zip(*parts, strict=True))
    weight, g = disc.weight(x) * dx, disc.profile(x)
    strength = jnp.where(law.moduli > 0, 0.5 / jnp.where(law.moduli > 0, law.moduli, 1.0), 0.0)

    def measure(state: Elements, d: Array, total: Array, work: Array) -> tuple[Array, ...]:
        held = 0.5 * law.equilibrium * state.u**2 + strength @ state.f**2
        touching = state.q > 0
        stored, locked = (jnp.sum(weight * jnp.where(is_in, held, 0.0)) for is_in in (touching, ~touching))
        return d, total, work, stored, locked, jnp.sum(weight * state.work) - stored - locked

    # A step at the first instant meets a glassy foundation; a dashpot lets nothing happen at once.
    value, depth_rules = start
    glassy, damped = law.equilibrium + jnp.sum(law.moduli), law.viscosity > 0
    area = jnp.where(damped, 0.0, value / jnp.where(damped, 1.0, glassy))
    d = jnp.where(depth_rules, value, disc.depth_of_area(area))
    u = jnp.maximum(d - g, 0.0)
    f = law.moduli[:, None] * u
    q = jnp.where(damped, 0.0, glassy * u)
    branches = strength @ f**2
    first = rest(law, x.size)._replace(
        u=u, f=f, q=q, work=branches + 0.5 * law.equilibrium * u**2, inelastic=branches, stored=branches
    )
    total, work = jnp.where(depth_rules, jnp.sum(weight * q), value), jnp.sum(weight * first.work)

    def step(carry: tuple, now: Steps) -> tuple[tuple, tuple]:
        state, d, total, work, d_start, total_start = carry
        d_start, total_start = jnp.where(now.first, d, d_start), jnp.where(now.first, total, total_start)
        c = coefficients(law, now.h)
        end = total_start + (now.target - total_start) * now.part
        free = released(c, state.u, jnp.sum(c.seen * state.f, axis=0))
        # With a dashpot q is a mean over the end of the step: the load is averaged in the same way.
        carried = end - (end - total) * lag(c)
        found = settle(g + free, weight * c.stiffness, 0.0, jnp.maximum(carried, 0.0), d)
        found = jnp.where(carried > 0, found, jnp.min(g + free))  # without a load it lies on the surface
        new = jnp.where(now.by_depth, d_start + (now.target - d_start) * now.part, found)
        received, state = state.work, advance(c, state, d - g, new - g)
        force = law.equilibrium * state.u + jnp.sum(state.f, axis=0) + law.viscosity * (new - d) / now.h
        before, total = total, jnp.where(now.by_depth, jnp.sum(weight * jnp.where(state.q > 0, force, 0.0)), end)
        # int F dd of the body, apart from what elements receive; a dashpot's force jumps with the rate of the depth.
        done = 0.5 * (before + total) * (new - d)
        work = work + jnp.where(now.by_depth & damped, jnp.sum(weight * (state.work - received)), done)
        kept = measure(state, new, total, work), _edge(x, new - g - free, state.q > 0)
        return (state, new, total, work, d_start, total_start), kept

    _, (sums, radius) = jax.lax.scan(step, (first, d, total, work, d, total), steps)
    radius = jnp.append(_edge(x, d - g, u > 0), radius)
    sums = tuple(jnp.append(a, b) for a, b in zip(measure(first, d, total, work), sums, strict=True))
    if disc.flat:
        radius = jnp.where(radius > 0, disc.shape.largest_contact, 0.0)
    return sums, jnp.minimum(radius, disc.largest), radius < disc.largest


def _edge(x: Array, excess: Array, touching: Array) -> Array:
    """Where w - u_free, which is smooth across the edge, passes zero; beyond the last node by continuation."""
    count = jnp.sum(touching)
    i = jnp.clip(count - 1, 0, x.size - 2)
    low, high = excess[i], excess[i + 1]
    fall = jnp.where(low > high, low - high, jnp.inf)
    return jnp.where(count > 0, jnp.maximum(x[i] + (x[i + 1] - x[i]) * low / fall, 0.0), 0.0)


@jax.jit
def _reach(modes: Modes, disc: Disc, time: Array, depth: Array, load: Array, by_depth: Array) -> Array:
    """A radius that no contact of a history exceeds: that of the largest load, kept, or of the largest depth."""
    span = (time[:, -1] - time[:, 0])[:, None]
    creep = modes.instantaneous + jnp.sum(modes.gain * span * phi1(modes.rate * span), axis=1)
    largest = [jnp.max(jnp.where(rules, value, 0.0), axis=1) for rules, value in ((~by_depth, load), (by_depth, depth))]
    radii = disc.radius_of_area(creep * largest[0]), disc.radius_of_depth(largest[1])
    return jnp.maximum(*(jnp.where(radius < disc.largest, radius, disc.largest) for radius in radii))


_all = jax.jit(jax.vmap(_once, in_axes=(None, None, 0, 0, 0, 0)))
