"""Tangential loading with Coulomb friction, element by element, for any history of
normal and tangential motion.

Each element has a normal law E* and a tangential law G* (Radok's operators). In the
normal direction it follows Signorini's conditions by the exact contact step
(`element.contact_step`). In the tangential direction it sticks to the body, whose
displacement U(t) is linear over a step, as long as that needs no more than |tau| <= mu
q; otherwise it slips,

    tau+ = min(max(tau_stick, -mu q+), mu q+),    tau_stick = tau_rest + S dU,

with tau_rest the traction that would be left without motion and S the stiffness of the
step. Since the step is linear in the displacement, the slipping element's own
displacement follows without iteration. An element that is touched within the step
sticks from then on. In an elastic contact all of this is exact for motion along
straight lines in (depth, displacement), whatever the length of the step (Cattaneo 1938,
Mindlin 1949, Jaeger 1993 by the method of dimensionality reduction: Popov & Hess 2015,
ch. 5); otherwise the error is of second order in the step. What remains is the sum over
elements, of second order in their width where stick ends between two elements: the
midpoint rule misses at most h^2/8 of the total variation of the integrand's slope,
which is the sum of its second differences times h/8. By Gauss' rule on panels that end
where stick or contact ended at any instant (`panels`) the sum is as good as exact in an
elastic contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import compiled, scan, tree_map, xp
from ..checks import Array, argmax
from ..element.contact_step import (
    Coefficients,
    Pressed,
    coefficients_of_steps,
    pressed,
    released,
)
from ..material.relaxation import Relaxation
from ..numerics.quadrature import gauss_on_panels
from ..surface.shapes import AbstractShape, Cylinder
from .march import OF_AN_ELEMENT, in_pieces, march, settle

if TYPE_CHECKING:
    from jaxtyping import Float


class Prescribed(NamedTuple):
    """What is prescribed; linear in between."""

    time: Float[Array, " times"]  # [s]
    value: Float[Array, " times"]  # load [N] or depth [m]
    displacement: Float[Array, " times"]  # tangential displacement of the body [m]


class Sheared(NamedTuple):
    """What comes out, at the same instants."""

    force: Float[Array, " times"]  # tangential force [N]
    normal_force: Float[Array, " times"]  # [N]
    depth: Float[Array, " times"]  # [m]
    contact_radius: Float[Array, " times"]  # [m]
    # elements inside did not slip in the last step [m]
    stick_radius: Float[Array, " times"]
    work: Float[Array, " times"]  # done by the tangential force [J]
    slip_loss: Float[Array, " times"]  # turned into heat by slip [J]
    stored: Float[Array, " times"]  # tangential elastic energy [J]
    # bound on what a sum over equal elements misses of the tangential force [N]
    missed: Float[Array, " times"]


class ShearState(NamedTuple):
    """The elements, and what has been done on them."""

    u: Array  # normal displacement of the elements [m]
    f: Array  # normal force densities of the branches (k, n)
    q: Array  # normal force density
    s: Array  # tangential displacement [m]
    p: Array  # tangential force densities of the branches (k, n)
    depth: Array
    work: Array
    slip_loss: Array


class ShearScene(NamedTuple):
    """Shape, laws, friction coefficient, and the radius that the elements reach to
    [m].
    """

    shape: AbstractShape
    normal: Relaxation
    tangential: Relaxation
    friction: Float[Array, ""]
    reach: Float[Array, ""]


class HalfLine(NamedTuple):
    """Elements on a half line."""

    x: Array
    weight: Array  # [m], or [m^2] on a layer
    profile: Array  # g [m]
    # between two of equal width; NaN if they differ, and then there is no radius of
    # contact or stick
    width: Array


class ShearSteps(NamedTuple):
    """Contact steps."""

    h: Float[Array, " steps"]  # [s]
    value: Float[Array, " steps"]  # load [N] or depth [m] at the end
    slide: Float[Array, " steps"]  # of the body in the step [m]


def cut(history: Prescribed, steps: int) -> tuple[ShearSteps, np.ndarray]:
    """A history in `steps` equal contact steps between two instants, and which of them
    end at the instants after the first.
    """
    rates = [np.diff(x) / steps for x in history]
    h, rise, slide = (np.repeat(rate, steps) for rate in rates)
    intervals = history.time.shape[0] - 1
    number = np.tile(np.arange(1, steps + 1), intervals)
    value = np.repeat(history.value[:-1], steps) + number * rise
    return ShearSteps(h, value, slide), steps * np.arange(1, intervals + 1) - 1


def shear_history(
    scene: ShearScene, history: Prescribed, grid: HalfLine, *, steps: int, by_load: bool
) -> Sheared:
    """The whole history of the elements of a grid, with `steps` contact steps between
    two instants.
    """
    steps_of_history, instants = cut(history, steps)
    put = history.value[0], history.displacement[0]
    start, first = _begin(scene, grid, *put, by_load=by_load)

    def piece(
        state: ShearState, now: ShearSteps, is_seen: Array | None
    ) -> tuple[ShearState, Sheared]:
        return _piece(scene, grid, state, now, is_seen, by_load=by_load)

    laws = scene.normal, scene.tangential
    branches = sum(law.moduli.shape[0] + OF_AN_ELEMENT for law in laws)
    size, doing = grid.x.shape[0] * branches, "stick and slip"
    _, later = in_pieces(piece, start, steps_of_history, instants, size, doing)
    return tree_map(lambda a, b: xp.concatenate([a[None], b]), first, later)


@compiled("by_load")
def _begin(
    scene: ShearScene,
    grid: HalfLine,
    value: Array,
    displacement: Array,
    *,
    by_load: bool,
) -> tuple[ShearState, Sheared]:
    """The elements after the first instant, and what is seen then."""
    state, seen = _start(scene, grid, value, displacement, by_load)
    return state, _measured(grid, state, seen, by_load)


@compiled("by_load")
def _piece(
    scene: ShearScene,
    grid: HalfLine,
    state: ShearState,
    steps: ShearSteps,
    is_seen: Array | None,
    *,
    by_load: bool,
) -> tuple[ShearState, Sheared]:
    """Some steps of the history."""

    def prepare(block: ShearSteps) -> tuple[ShearSteps, Coefficients, Coefficients]:
        laws = scene.normal, scene.tangential
        normal, tangential = (coefficients_of_steps(law, block.h) for law in laws)
        return block, normal, tangential

    def advance(
        state: ShearState, now: tuple[ShearSteps, Coefficients, Coefficients]
    ) -> tuple[ShearState, tuple]:
        end, normal, tangential = now
        given = (end.value, end.slide, by_load)
        return step(scene, grid, normal, tangential, state, *given)

    def look(state: ShearState, seen: tuple) -> Sheared:
        return _measured(grid, state, seen, by_load)

    return march(advance, look, state, steps, is_seen, prepare)


@compiled("elements", "per_area")
def line(scene: ShearScene, elements: int, per_area: bool) -> HalfLine:
    """`elements` elements of equal width from the axis to the reach of the scene."""
    width = scene.reach / elements
    return _grid(scene, width * (xp.arange(elements) + 0.5), width, width, per_area)


@compiled("parts", "nodes", "per_area")
def panels(
    scene: ShearScene, radii: Array, parts: int, nodes: int, per_area: bool
) -> HalfLine:
    """Gauss' rule with `nodes` points on `parts` parts of each panel between
    neighbouring `radii` [m].

    Between two radii at which stick or contact ended at some instant all elements have
    the same history of stick and slip, so that all is smooth there. The places carry no
    derivative, since the sums do not depend on them.
    """
    edges = xp.concatenate(
        [xp.zeros(1), xp.sort(xp.clip(radii, 0.0, scene.reach)), scene.reach[None]]
    )
    inner = edges[:-1, None] + xp.diff(edges)[:, None] * (np.arange(parts) / parts)
    x, dx = gauss_on_panels(xp.append(inner.reshape(-1), edges[-1]), nodes)
    return _grid(scene, x, dx, xp.asarray(xp.nan), per_area)


def _grid(
    scene: ShearScene, x: Array, dx: Array, width: Array, per_area: bool
) -> HalfLine:
    ring = per_area and not isinstance(scene.shape, Cylinder)
    weight = (2 * math.pi * x if ring else xp.full(x.shape, 2.0)) * dx
    weight = weight * (scene.shape.length if isinstance(scene.shape, Cylinder) else 1.0)
    profile = scene.shape._height(x) if ring else scene.shape._profile(x)
    return HalfLine(x, weight, xp.where(xp.isfinite(profile), profile, 1e30), width)


def untouched(scene: ShearScene, grid: HalfLine) -> ShearState:
    """The state before any contact."""
    zero, none = xp.zeros_like(grid.x), xp.zeros(())

    def rest(law: Relaxation) -> Array:
        return xp.zeros((law.moduli.shape[0], grid.x.shape[0]))

    return ShearState(
        zero, rest(scene.normal), zero, zero, rest(scene.tangential), none, none, none
    )


def _start(
    scene: ShearScene, grid: HalfLine, value: Array, displacement: Array, by_load: bool
) -> tuple[ShearState, tuple]:
    """The first instant: depth or load, then displacement, put on at once, to which the
    glassy moduli respond.

    Dashpots carry what is put on at once without moving.
    """
    none, state = xp.zeros(()), untouched(scene, grid)
    still = (
        state,
        ((none, value if by_load else none, none, none, none, none), state.u),
    )
    normal, tangential = _sudden(scene.normal), _sudden(scene.tangential)

    def put(state: ShearState, ds: Array) -> tuple[ShearState, tuple]:
        return step(scene, grid, normal, tangential, state, value, ds, by_load)

    put_down, seen = scan(put, state, xp.stack([none, displacement]))
    moved = put_down, tree_map(lambda x: x[-1], seen)
    dashpots = xp.asarray(scene.normal.viscosity + scene.tangential.viscosity) > 0
    return tree_map(lambda a, b: xp.where(dashpots, a, b), still, moved)


def _sudden(law: Relaxation) -> Coefficients:
    """The contact step in the limit h = 0, of a law without a dashpot."""
    one = xp.ones((law.moduli.shape[0], 1))
    glassy = xp.atleast_1d(law.equilibrium + xp.sum(law.moduli))
    glassy = xp.where(glassy > 0, glassy, 1.0)
    moduli = xp.asarray(law.moduli)[:, None]
    zero, equilibrium = xp.zeros(1), xp.atleast_1d(xp.asarray(law.equilibrium))
    drag = 0.5 * xp.sum(moduli, axis=0)
    energy = xp.where(moduli > 0, 0.5 / xp.where(moduli > 0, moduli, 1.0), 0.0)
    return Coefficients(
        xp.ones(1),
        equilibrium,
        zero,
        one,
        one,
        moduli,
        energy,
        one,
        glassy,
        glassy,
        drag,
        zero,
    )


class TangentialStep(NamedTuple):
    """What a step does to the elements along the surface."""

    tau: Array  # traction at the end, or its mean with a dashpot
    trial: Array  # traction if they stick
    limit: Array  # the largest that friction allows
    slips: Array
    stuck_move: Array  # by the body, if they stick [m]
    moved: Array  # [m]


def step(
    scene: ShearScene,
    grid: HalfLine,
    cn: Coefficients,
    ct: Coefficients,
    state: ShearState,
    value: Array,
    ds: Array | Callable[[Callable[[Array], Array]], Array],
    by_load: bool,
) -> tuple[ShearState, tuple]:
    """One contact step: the state after it, (F_x, F_N, contact radius, stick radius,
    energy, error of F_N), and tau.

    `ds` is the body's tangential displacement in the step, or finds it from the force
    as a function of it.
    """
    seen = xp.sum(cn.seen * state.f, axis=0)
    depth = value
    if by_load:
        touch_depth = grid.profile + released(cn, state.u, seen)
        stiffness = grid.weight * cn.stiffness
        depth = settle(touch_depth, stiffness, 0.0, value, state.depth)
    down = pressed(cn, state.u, seen, depth - grid.profile - state.u)
    share = _share(grid, cn, state, down)
    moved, slide = _moved(scene, grid, ct, state, down.q, share, ds)
    heat = _heat(scene, ct, state, moved)

    mean = (
        ct.equilibrium * (state.s + 0.5 * moved.moved)
        + xp.sum(ct.mean * state.p, axis=0)
        + ct.drag * moved.moved
    )
    p = ct.decay * state.p + ct.gain * moved.moved
    s = state.s + moved.moved
    stored = 0.5 * ct.equilibrium * s**2 + xp.sum(ct.energy * p**2, axis=0)
    loss = xp.sum(grid.weight * heat)
    after = ShearState(
        u=state.u + down.change,
        f=cn.decay * state.f + cn.gain * down.change,
        q=down.q,
        s=s,
        p=p,
        depth=depth,
        work=state.work + xp.sum(grid.weight * mean * moved.moved) + loss,
        slip_loss=state.slip_loss + loss,
    )
    radius = _edge(grid, down.pushed - down.recovery)
    room = xp.where(down.q > 0, moved.limit - xp.abs(moved.trial), -1e-300)
    stick = xp.minimum(_edge(grid, room), radius)
    tau, q = moved.tau, down.q
    late = xp.zeros(())  # what a given load misses of the normal force at the end
    if not callable(ds):
        sunk = (down.pushed, depth - state.depth)
        tau, end = _at_end(scene, cn, ct, state, sunk, slide, moved, q)
        late, q = (
            (xp.abs(xp.sum(grid.weight * (end - q))), q) if by_load else (late, end)
        )
    seen = (
        xp.sum(grid.weight * tau),
        xp.sum(grid.weight * q),
        radius,
        stick,
        xp.sum(grid.weight * stored),
        late,
    )
    return after, (seen, tau)


def _share(grid: HalfLine, cn: Coefficients, state: ShearState, down: Pressed) -> Array:
    """The part of the body's motion that an element can follow: a surface that comes
    from a distance carries it from when it touches, one that leaves it until the normal
    force, linear in the step, is gone.
    """
    before = xp.maximum(state.u + grid.profile - state.depth, 0.0)
    gap = xp.where(state.q > 0, 0.0, before)
    fresh, left = down.contact & (gap > 0), ~down.contact & (state.q > 0)
    touching = xp.maximum(down.pushed, 0.0) / xp.where(fresh, down.pushed + gap, 1.0)
    fall = state.q - cn.stiffness * (down.pushed - down.recovery)
    leaving = state.q / xp.where(left, fall, 1.0)
    return xp.where(left, leaving, xp.where(fresh, touching, 1.0))


def _largest(scene: ShearScene, q: Array) -> Array:
    """The largest traction that friction allows."""
    return xp.where(q > 0, scene.friction * xp.where(q > 0, q, 1.0), 0.0)


def _moved(
    scene: ShearScene,
    grid: HalfLine,
    ct: Coefficients,
    state: ShearState,
    q: Array,
    share: Array,
    ds: Array | Callable[[Callable[[Array], Array]], Array],
) -> tuple[TangentialStep, Array]:
    """Stick or slip of each element, and the displacement of the body."""
    limit = _largest(scene, q)
    rest = ct.equilibrium * state.s + xp.sum(ct.seen * state.p, axis=0)

    def force(ds: Array) -> Array:
        trial = rest + ct.stiffness * share * ds
        return xp.sum(grid.weight * xp.clip(trial, -limit, limit))

    slide: Any = ds(force) if callable(ds) else ds
    stuck_move = slide * share
    trial = rest + ct.stiffness * stuck_move
    slips = xp.abs(trial) > limit
    bound = xp.sign(trial) * xp.where(slips, limit, 0.0)
    tau = xp.where(slips, bound, trial)
    moved = xp.where(slips, (bound - rest) / ct.stiffness, stuck_move)
    return TangentialStep(tau, trial, limit, slips, stuck_move, moved), slide


def _heat(
    scene: ShearScene, ct: Coefficients, state: ShearState, moved: TangentialStep
) -> Array:
    """Turned into heat by slip. It begins where traction and limit, both linear in the
    step, meet: at once if the element slipped before.
    """
    slips, trial = moved.slips, moved.trial
    slid = xp.where(slips, xp.abs(moved.stuck_move - moved.moved), 0.0)
    before = _largest(scene, state.q)
    known = slips & xp.isfinite(before)
    last, now = xp.where(known, before, 0.0), xp.where(slips, moved.limit, 0.0)
    traction = ct.equilibrium * state.s + xp.sum(state.p, axis=0)
    room = xp.maximum(last - xp.sign(trial) * traction, 0.0)
    over = xp.where(known, xp.abs(trial) - now, 1.0)
    first = xp.where(known, last + (now - last) * room / (room + over), xp.abs(trial))
    return xp.where(slips, 0.5 * (first + now) * slid, 0.0)


def _at_end(
    scene: ShearScene,
    cn: Coefficients,
    ct: Coefficients,
    state: ShearState,
    sunk: tuple[Array, Array],
    slide: Array,
    moved: TangentialStep,
    q: Array,
) -> tuple[Array, Array]:
    """Tractions at the end of a step: with a dashpot the conditions are put on means,
    which do not see the rate there.

    `sunk`: by how much element and body have moved down.
    """
    held = cn.equilibrium * state.u + xp.sum(cn.decay * state.f, axis=0)
    held = held + (cn.end - cn.rate) * sunk[0] + cn.rate * sunk[1]
    q_end = xp.where(q > 0, xp.where(cn.rate > 0, xp.maximum(held, 0.0), q), 0.0)
    stuck = ct.equilibrium * state.s + xp.sum(ct.decay * state.p, axis=0)
    stuck = stuck + (ct.end - ct.rate) * moved.stuck_move + ct.rate * slide
    limit = _largest(scene, q_end)
    stuck = xp.clip(xp.where(ct.rate > 0, stuck, moved.tau), -limit, limit)
    return xp.where(moved.slips, xp.sign(moved.tau) * limit, stuck), q_end


def _measured(grid: HalfLine, state: ShearState, seen: tuple, by_load: bool) -> Sheared:
    """What is known at the end of a step, with a bound on what its tangential force
    misses.
    """
    (force, normal_force, contact, stick, stored, late), tau = seen
    missed = _missed(grid.weight * tau)
    if by_load:
        # Under a load the depth carries the error of the normal sum over to F_x, in
        # proportion.
        ratio = xp.abs(force) / xp.where(normal_force > 0, normal_force, 1.0)
        missed = missed + ratio * (_missed(grid.weight * state.q) + late)
    return Sheared(
        force=force,
        normal_force=normal_force,
        depth=state.depth,
        contact_radius=contact,
        stick_radius=stick,
        work=state.work,
        slip_loss=state.slip_loss,
        stored=stored,
        missed=missed,
    )


def _missed(parts: Array) -> Array:
    """Bound on the error of the midpoint rule whose terms are `parts`, of the total
    variation of their slope, with that at the axis and at the outer end: of a jump
    within an element half is missed, of a bend half as much as this.
    """
    change = xp.diff(parts)
    ends = xp.abs(change[:1]) + xp.abs(change[-1:]) if change.size else xp.zeros(1)
    return 0.25 * (xp.sum(xp.abs(xp.diff(change))) + ends[0])


def _edge(grid: HalfLine, value: Array) -> Array:
    """Where a function of the distance from the axis that is positive inside first
    turns negative [m].
    """
    n = value.shape[0]
    i = xp.where(xp.any(value < 0), argmax(value < 0), n)
    inner, outer = value[xp.clip(i - 1, 0, n - 1)], value[xp.clip(i, 0, n - 1)]
    fraction = xp.where(
        inner > outer, inner / xp.where(inner > outer, inner - outer, 1.0), 0.0
    )
    between = (
        xp.take(grid.x, xp.clip(i - 1, 0, n - 1))
        + xp.clip(xp.where(xp.isfinite(fraction), fraction, 1.0), 0, 1) * grid.width
    )
    return xp.where(
        i == 0, 0.0, xp.where(i == n, grid.x[-1] + 0.5 * grid.width, between)
    )
