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
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import tree_map
from ..checks import Array
from ..element.body_over_line import settle
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
from .march import OF_AN_ELEMENT, in_pieces, march

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
    laws = scene.normal, scene.tangential
    put = history.value[0], history.displacement[0]
    start, felt = _start(scene, grid, *put, by_load)
    first = _measured(grid, start, felt, by_load)

    def prepare(block: ShearSteps) -> tuple[ShearSteps, Coefficients, Coefficients]:
        normal, tangential = (coefficients_of_steps(law, block.h) for law in laws)
        return block, normal, tangential

    def advance(
        state: ShearState, now: tuple[ShearSteps, Coefficients, Coefficients]
    ) -> tuple[ShearState, StepFelt]:
        end, cn, ct = now
        return step(scene, grid, cn, ct, state, end.value, end.slide, by_load)

    def look(state: ShearState, felt: StepFelt) -> Sheared:
        return _measured(grid, state, felt, by_load)

    def piece(
        state: ShearState, block: ShearSteps, is_seen: Array
    ) -> tuple[ShearState, Sheared]:
        return march(advance, look, state, block, is_seen, prepare)

    branches = sum(law.moduli.shape[0] + OF_AN_ELEMENT for law in laws)
    size, doing = grid.x.shape[0] * branches, "stick and slip"
    _, later = in_pieces(piece, start, steps_of_history, instants, size, doing)
    return tree_map(lambda a, b: np.concatenate([a[None], b]), first, later)


def line(scene: ShearScene, elements: int, per_area: bool) -> HalfLine:
    """`elements` elements of equal width from the axis to the reach of the scene."""
    width = np.asarray(scene.reach)[..., None] / elements
    x = width * (np.arange(elements) + 0.5)
    return _grid(scene, x, width, width[..., 0], per_area)


def panels(
    scene: ShearScene, radii: Array, parts: int, nodes: int, per_area: bool
) -> HalfLine:
    """Gauss' rule with `nodes` points on `parts` parts of each panel between
    neighbouring `radii` [m].

    Between two radii at which stick or contact ended at some instant all elements have
    the same history of stick and slip, so that all is smooth there. The places carry no
    derivative, since the sums do not depend on them.
    """
    edges = np.concatenate(
        [np.zeros(1), np.sort(np.clip(radii, 0.0, scene.reach)), scene.reach[None]]
    )
    inner = edges[:-1, None] + np.diff(edges)[:, None] * (np.arange(parts) / parts)
    x, dx = gauss_on_panels(np.append(inner.reshape(-1), edges[-1]), nodes)
    return _grid(scene, x, dx, np.asarray(np.nan), per_area)


def _grid(
    scene: ShearScene, x: Array, dx: Array, width: Array, per_area: bool
) -> HalfLine:
    ring = per_area and not isinstance(scene.shape, Cylinder)
    weight = (2 * math.pi * x if ring else np.full(x.shape, 2.0)) * dx
    weight = weight * (scene.shape.length if isinstance(scene.shape, Cylinder) else 1.0)
    profile = scene.shape._height(x) if ring else scene.shape._profile(x)
    return HalfLine(x, weight, np.where(np.isfinite(profile), profile, 1e30), width)


def untouched(scene: ShearScene, grid: HalfLine) -> ShearState:
    """The state before any contact."""
    zero, none = np.zeros_like(grid.x), np.zeros(grid.x.shape[:-1])

    def rest(law: Relaxation) -> Array:
        return np.zeros((law.moduli.shape[0], *grid.x.shape))

    return ShearState(
        zero, rest(scene.normal), zero, zero, rest(scene.tangential), none, none, none
    )


def _start(
    scene: ShearScene, grid: HalfLine, value: Array, displacement: Array, by_load: bool
) -> tuple[ShearState, StepFelt]:
    """The first instant: depth or load, then displacement, put on at once, to which the
    glassy moduli respond.

    Dashpots carry what is put on at once without moving.
    """
    state, none = untouched(scene, grid), np.zeros(())
    if scene.normal.viscosity + scene.tangential.viscosity > 0:
        apart, carried = state.u - 1.0, value if by_load else none
        return state, StepFelt(none, carried, state.u, apart, apart, state.u, none)
    cn, ct = _sudden(scene.normal), _sudden(scene.tangential)
    state, _ = step(scene, grid, cn, ct, state, value, none, by_load)
    return step(scene, grid, cn, ct, state, value, displacement, by_load)


def _sudden(law: Relaxation) -> Coefficients:
    """The contact step in the limit h = 0, of a law without a dashpot."""
    one = np.ones((law.moduli.shape[0], 1))
    glassy = np.atleast_1d(law.equilibrium + np.sum(law.moduli))
    glassy = np.where(glassy > 0, glassy, 1.0)
    moduli = np.asarray(law.moduli)[:, None]
    zero, equilibrium = np.zeros(1), np.atleast_1d(np.asarray(law.equilibrium))
    drag = 0.5 * np.sum(moduli, axis=0)
    energy = np.where(moduli > 0, 0.5 / np.where(moduli > 0, moduli, 1.0), 0.0)
    return Coefficients(
        np.ones(1),
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


class StepFelt(NamedTuple):
    """What elements and body feel at the end of a step."""

    force: Array  # tangential [N]
    normal: Array  # [N]
    tau: Array  # traction
    pushed: Array  # beyond u_free [m]
    room: Array  # what friction allows beyond the traction, negative out of contact
    stored: Array  # tangential elastic energy of the elements
    late: Array  # what a given load misses of the normal force at the end [N]


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
) -> tuple[ShearState, StepFelt]:
    """One contact step, and what is felt at its end.

    `ds` is the body's tangential displacement in the step, or finds it from the force
    as a function of it. Depths and displacements may be those of many bodies, each with
    its elements along the last axis.
    """
    seen = np.sum(cn.seen * state.f, axis=0)
    depth = value
    if by_load:
        touch_depth = grid.profile + released(cn, state.u, seen)
        stiffness = grid.weight * cn.stiffness
        depth = settle(touch_depth, stiffness, 0.0, value, state.depth)
    pushed = np.asarray(depth)[..., None] - grid.profile - state.u
    down = pressed(cn, state.u, seen, pushed)
    share = _share(grid, cn, state, down)
    moved, slide = _moved(scene, grid, ct, state, down.q, share, ds)
    heat = _heat(scene, ct, state, moved)

    mean = (
        ct.equilibrium * (state.s + 0.5 * moved.moved)
        + np.sum(ct.mean * state.p, axis=0)
        + ct.drag * moved.moved
    )
    p = ct.decay * state.p + ct.gain * moved.moved
    s = state.s + moved.moved
    stored = 0.5 * ct.equilibrium * s**2 + np.sum(ct.energy * p**2, axis=0)
    loss = _sum(grid, heat)
    after = ShearState(
        u=state.u + down.change,
        f=cn.decay * state.f + cn.gain * down.change,
        q=down.q,
        s=s,
        p=p,
        depth=depth,
        work=state.work + _sum(grid, mean * moved.moved) + loss,
        slip_loss=state.slip_loss + loss,
    )
    tau, q, late = moved.tau, down.q, np.zeros(())
    if not callable(ds):
        sunk = (down.pushed, depth - state.depth)
        tau, end = _at_end(scene, cn, ct, state, sunk, slide, moved, q)
        if by_load:
            late = np.abs(_sum(grid, end - q))
        else:
            q = end
    return after, StepFelt(
        force=_sum(grid, tau),
        normal=_sum(grid, q),
        tau=tau,
        pushed=down.pushed - down.recovery,
        room=np.where(down.q > 0, moved.limit - np.abs(moved.trial), -1e-300),
        stored=stored,
        late=late,
    )


def _sum(grid: HalfLine, values: Array) -> Array:
    """Over the elements."""
    return np.sum(grid.weight * values, axis=-1)


def _share(grid: HalfLine, cn: Coefficients, state: ShearState, down: Pressed) -> Array:
    """The part of the body's motion that an element can follow: a surface that comes
    from a distance carries it from when it touches, one that leaves it until the normal
    force, linear in the step, is gone.
    """
    depth = np.asarray(state.depth)[..., None]
    before = np.maximum(state.u + grid.profile - depth, 0.0)
    gap = np.where(state.q > 0, 0.0, before)
    fresh, left = down.contact & (gap > 0), ~down.contact & (state.q > 0)
    touching = np.maximum(down.pushed, 0.0) / np.where(fresh, down.pushed + gap, 1.0)
    fall = state.q - cn.stiffness * (down.pushed - down.recovery)
    leaving = state.q / np.where(left, fall, 1.0)
    return np.where(left, leaving, np.where(fresh, touching, 1.0))


def _largest(scene: ShearScene, q: Array) -> Array:
    """The largest traction that friction allows."""
    return np.where(q > 0, scene.friction * np.where(q > 0, q, 1.0), 0.0)


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
    rest = ct.equilibrium * state.s + np.sum(ct.seen * state.p, axis=0)

    def force(ds: Array) -> Array:
        trial = rest + ct.stiffness * share * ds[..., None]
        return _sum(grid, np.clip(trial, -limit, limit))

    slide = np.asarray(ds(force) if callable(ds) else ds)
    stuck_move = slide[..., None] * share
    trial = rest + ct.stiffness * stuck_move
    slips = np.abs(trial) > limit
    bound = np.sign(trial) * np.where(slips, limit, 0.0)
    tau = np.where(slips, bound, trial)
    moved = np.where(slips, (bound - rest) / ct.stiffness, stuck_move)
    return TangentialStep(tau, trial, limit, slips, stuck_move, moved), slide


def _heat(
    scene: ShearScene, ct: Coefficients, state: ShearState, moved: TangentialStep
) -> Array:
    """Turned into heat by slip. It begins where traction and limit, both linear in the
    step, meet: at once if the element slipped before.
    """
    slips, trial = moved.slips, moved.trial
    slid = np.where(slips, np.abs(moved.stuck_move - moved.moved), 0.0)
    before = _largest(scene, state.q)
    known = slips & np.isfinite(before)
    last, now = np.where(known, before, 0.0), np.where(slips, moved.limit, 0.0)
    traction = ct.equilibrium * state.s + np.sum(state.p, axis=0)
    room = np.maximum(last - np.sign(trial) * traction, 0.0)
    over = np.where(known, np.abs(trial) - now, 1.0)
    first = np.where(known, last + (now - last) * room / (room + over), np.abs(trial))
    return np.where(slips, 0.5 * (first + now) * slid, 0.0)


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
    held = cn.equilibrium * state.u + np.sum(cn.decay * state.f, axis=0)
    held = held + (cn.end - cn.rate) * sunk[0] + cn.rate * sunk[1]
    q_end = np.where(q > 0, np.where(cn.rate > 0, np.maximum(held, 0.0), q), 0.0)
    stuck = ct.equilibrium * state.s + np.sum(ct.decay * state.p, axis=0)
    stuck = stuck + (ct.end - ct.rate) * moved.stuck_move + ct.rate * slide
    limit = _largest(scene, q_end)
    stuck = np.clip(np.where(ct.rate > 0, stuck, moved.tau), -limit, limit)
    return np.where(moved.slips, np.sign(moved.tau) * limit, stuck), q_end


def _measured(
    grid: HalfLine, state: ShearState, felt: StepFelt, by_load: bool
) -> Sheared:
    """What is known at the end of a step, with a bound on what its tangential force
    misses.
    """
    missed = _missed(grid.weight * felt.tau)
    contact = _edge(grid, felt.pushed)
    if by_load:
        # Under a load the depth carries the error of the normal sum over to F_x, in
        # proportion.
        ratio = np.abs(felt.force) / (felt.normal if felt.normal > 0 else 1.0)
        missed = missed + ratio * (_missed(grid.weight * state.q) + felt.late)
    return Sheared(
        force=felt.force,
        normal_force=felt.normal,
        depth=state.depth,
        contact_radius=contact,
        stick_radius=np.minimum(_edge(grid, felt.room), contact),
        work=state.work,
        slip_loss=state.slip_loss,
        stored=_sum(grid, felt.stored),
        missed=missed,
    )


def _missed(parts: Array) -> Array:
    """Bound on the error of the midpoint rule whose terms are `parts`, of the total
    variation of their slope, with that at the axis and at the outer end: of a jump
    within an element half is missed, of a bend half as much as this.
    """
    change = np.diff(parts)
    ends = np.abs(change[:1]) + np.abs(change[-1:]) if change.size else np.zeros(1)
    return 0.25 * (np.sum(np.abs(np.diff(change))) + ends[0])


def _edge(grid: HalfLine, value: Array) -> Array:
    """Where a function of the distance from the axis that is positive inside first
    turns negative [m].
    """
    outside = value < 0
    if not outside.any():
        return grid.x[-1] + 0.5 * grid.width
    i = int(np.argmax(outside))
    if i == 0:
        return np.zeros(())
    inner, outer = value[i - 1], value[i]
    fraction = inner / (inner - outer) if inner > outer else 0.0
    share = np.clip(fraction, 0.0, 1.0) if np.isfinite(fraction) else 1.0
    return grid.x[i - 1] + share * grid.width
