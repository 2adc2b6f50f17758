"""The periodic state of a rough line and, for a given load, its depth, by quasi-Newton
sweeps.

One sweep from a state f_k(0) shows how far that state is from a periodic one. The
motion that the sweep has found would leave, when repeated for ever, the branch at

    f_k(0) + [f_k(T) - f_k(0) + g_k (u(0) - u(T))]/(1 - exp(-T/tau_k)),

and since periodic forces have no mean, sum_n f_k(n) = 0, a slow branch (tau_k >> T)
more accurately at f_k(0) - sum_n f_k(n) / sum_n exp(-n h/tau_k). The differences, with
that of the load, are the residuals r(f_k(0), d). Repeating the motion is a contraction,
but a slow one for light contacts with slow branches. Broyden's method, which learns the
Jacobian as it goes, starts from the Jacobian by differences on the coarsest samples,
where a sweep costs little.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import jax
import numpy as np

from .free_steps import LineLaw
from .period import PointCoefficients, Swept, coefficients, sweep

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_RESIDUAL = 1e-9  # of the state and of the load, relative to the load
# mu below which the residual is smaller in proportion: friction is a small part of the
# forces
_SMALL = 1.0
_SLOW = 1e-3  # T/tau below which a branch is made periodic by its mean
_INSTANT = 100.0  # T/tau from which a branch forgets at once what it was at the start
# numbers of points that are compiled: each takes a second, and more of them save little
_FEW, _MANY = 8, (32, 64)
_SHORT = 8192  # samples
_ROOM = 8  # lines are kept with room for the next power of it, in samples
_SUMS = (2, 8)  # numbers of slow branches that are compiled
_SWEEPS = (60, 30)  # at most, with all samples and with fewer
# sweeps without halving the residual, after which the Jacobian is computed anew
_STALLED = 3
_SINGULAR = 1e8  # largest entry in the inverse of a Jacobian that is used
# relaxation times; a branch is a spring to contacts much shorter than that
_LASTING = 2.0
_NUDGE = 1e-5  # of the load, by which an unknown is moved for the Jacobian


class PeriodicState(NamedTuple):
    """The unknowns of each point, f_k(0) and d, and the inverse of minus the Jacobian,
    all in units of the load.
    """

    branches: Float[np.ndarray, "branches points"]
    depth: Float[np.ndarray, " points"]
    inverse: Float[np.ndarray, "points unknowns unknowns"]


class Target(NamedTuple):
    """What the points are pressed with."""

    load: Float[np.ndarray, " points"]  # mean force per length, about if not by load
    stiffness: Float[np.ndarray, " points"]  # of the load against depth, about
    by_load: bool  # or by depth


class Sampling(NamedTuple):
    """One sampling of the line, for all points."""

    samples: int
    stride: int  # points of the line per sample
    by: PointCoefficients
    slow: int  # number of branches that may be slow
    is_slow: Bool[np.ndarray, "slow points"]  # of those, which are, in which point
    sums: Float[np.ndarray, "slow points"]  # sum_n exp(-n h/tau_k)
    whole: Float[np.ndarray, "branches points"]  # 1 - exp(-T/tau_k)
    # branches whose state at the start is felt for more than an instant, in which point
    lasting: Bool[np.ndarray, "branches points"]
    to: Target
    spacing: float  # h v, between samples [m]
    step: Float[np.ndarray, " points"]  # h [s]
    times: Float[np.ndarray, "branches 1"]  # tau_k [s]
    # rise, with room, and by, where the computation is done
    ready: tuple[jax.Array, PointCoefficients]


class PeriodicSolution(NamedTuple):
    """What a periodic motion is."""

    mu: Float[np.ndarray, " points"]
    load: Float[np.ndarray, " points"]
    share: Float[np.ndarray, " points"]
    contacts: Float[np.ndarray, " points"]  # in a period
    residual: Float[np.ndarray, " points"]
    unsure: Float[np.ndarray, " points"]  # of mu, from bends within a step


def sampling_of(
    rise: Float[np.ndarray, " n"],
    spacing: float,
    stride: int,
    velocity: Float[np.ndarray, " points"],
    law: LineLaw,
    to: Target,
) -> Sampling:
    """The line on every `stride`-th of its points, which are `spacing` [m] apart."""
    count, spacing = rise.size // stride, stride * spacing
    step, times = spacing / velocity, law.times[:, None]
    period = count * step
    by = coefficients(law, step)
    slow = period / times < _SLOW
    most = int(slow.sum(axis=0).max())
    most = min(next((s for s in _SUMS if s >= most), slow.shape[0]), slow.shape[0])
    whole = -np.expm1(-period / times)
    sums = by.keep * whole / -np.expm1(-step / times)
    return Sampling(
        samples=count,
        stride=stride,
        by=by,
        slow=most,
        is_slow=slow[:most],
        sums=np.where(slow, sums, 1.0)[:most],
        whole=whole,
        lasting=period / times < _INSTANT,
        to=to,
        spacing=spacing,
        step=step,
        times=times,
        ready=jax.device_put((_closed(rise), by)),
    )


def _closed(rise: Float[np.ndarray, " n"]) -> Float[np.ndarray, " m"]:
    """The first point again after the last, and zeros up to one of few lengths."""
    size = _ROOM ** math.ceil(math.log(max(rise.size, _SHORT), _ROOM) - 1e-9)
    return np.concatenate([rise, rise[:1], np.zeros(size - rise.size)])


def iterate(
    sampling: Sampling, state: PeriodicState
) -> tuple[PeriodicState, Float[np.ndarray, " points"], np.ndarray]:
    """The periodic state, the number of sweeps of each point, and which points have
    converged.
    """
    branches, depth, inverse = (np.array(a) for a in state)
    point_count, (load, stiffness, by_load) = depth.size, sampling.to
    # what rounding of u leaves
    floor = 2e-16 * np.sqrt(sampling.samples) * depth / (sampling.by.give * load)
    best, kept = np.full(point_count, np.inf), None
    stalled, restarts = np.zeros(point_count, int), np.zeros(point_count, int)
    moved = before = None
    active, turns = np.ones(point_count, bool), np.zeros(point_count)
    for _ in range(_SWEEPS[sampling.stride > 1]):
        r, end = _residual(sampling, branches, depth, active)
        turns += active
        size = np.where(np.isfinite(r).all(axis=1), np.abs(r).max(axis=1), np.inf)
        goal = np.maximum(
            _RESIDUAL * np.clip(_mu(sampling, end) / _SMALL, 1e-4, 1.0), floor
        )
        active = active & ~(size <= goal)
        if not active.any():
            break
        if moved is not None and before is not None:
            inverse = _learn(inverse, moved, before - r, active)
        if kept is None:
            kept = (depth.copy(), branches.copy(), r.copy())
        worse = active & ~(size <= 2 * best)
        stalled = np.where(size < 0.5 * best, 0, stalled + active)
        depth, branches = (
            np.where(worse, kept[0], depth),
            np.where(worse, kept[1], branches),
        )
        r = np.where(worse[:, None], kept[2], r)
        # what was learnt misleads: start over from the best point, with shorter steps
        retry = stalled > _STALLED
        if retry.any():
            fresh = (
                jacobian(sampling, PeriodicState(branches, depth, inverse), retry)
                * 0.5 ** restarts[:, None, None]
            )
            inverse = np.where(retry[:, None, None], fresh, inverse)
            stalled, restarts = np.where(retry, 0, stalled), restarts + retry
        better = active & (size <= best)
        kept = (
            np.where(better, depth, kept[0]),
            np.where(better, branches, kept[1]),
            np.where(better[:, None], r, kept[2]),
        )
        best = np.where(better, size, best)
        moved = (inverse @ r[:, :, None])[:, :, 0]
        down = moved[:, -1] * load / stiffness
        moved *= (
            np.minimum(1.0, 0.5 * depth / np.maximum(np.abs(down), 1e-300)) * active
        )[:, None]
        if not by_load:
            moved[:, -1] = 0.0
        branches = branches + moved[:, :-1].T * load
        depth = depth + moved[:, -1] * load / stiffness
        before = r
    return PeriodicState(branches, depth, inverse), turns, ~active


def finish(sampling: Sampling, state: PeriodicState) -> PeriodicSolution:
    """The periodic motion's friction, its work summed exactly.

    An element that is met within a step was free in the step's first part, theta h,
    while u was taken to be straight. A dashpot has taken eta J^2 theta (1 - theta) h
    more work then, J the jump of u' and J^2 theta (1 - theta) h^2 what `struck` sums,
    and a branch that relaxes while the contact lasts likewise, with E_k phi2(h/tau_k)
    for eta/h: the impulse of its force does not depend on the bend, and all of it moves
    with the line. An element that is lost within a step bends as much: the same holds,
    with the push before, J theta h, and the gap after, J (1 - theta) h. For a branch
    that outlasts the contact the straight path has the work right, as it has for a
    spring.
    """
    r, end = _residual(
        sampling,
        state.branches,
        state.depth,
        np.ones(state.depth.size, bool),
        exact=True,
    )
    load, touching = np.asarray(end.load), np.asarray(end.touching)
    contacts = np.maximum(end.begun, 1)
    duration = touching / contacts * sampling.step
    by, outlasts = sampling.by, 1 / (1 + (duration / (_LASTING * sampling.times)) ** 2)
    stiff = by.drag - (by.each * outlasts).sum(axis=0)
    bent = stiff * np.asarray(end.struck)
    # Where rubber gives way within a step contact ends the earlier by that time, where
    # it takes many steps no bend is left: in between twice the smaller of both shares
    # covers what the closed form of a dashpot shows.
    quick = by.relaxed / np.where(stiff > 0, stiff, np.inf)
    share = np.minimum(quick, 1 / np.maximum(quick, 1e-300))
    unsure = np.abs(_mu(sampling, end._replace(work=2 * share * bent)))
    end = end._replace(work=end.work + bent)
    return PeriodicSolution(
        _mu(sampling, end),
        load / sampling.samples,
        touching / sampling.samples,
        contacts,
        np.abs(r).max(axis=1),
        unsure,
    )


def jacobian(
    sampling: Sampling, state: PeriodicState, every: np.ndarray
) -> Float[np.ndarray, "points unknowns unknowns"]:
    """The inverse of minus the Jacobian of the residuals of some points, by differences;
    the identity elsewhere.
    """
    point_count, unknowns = state.depth.size, state.inverse.shape[1]
    load, stiffness, by_load = sampling.to
    start = _residual(sampling, state.branches, state.depth, every)[0]
    matrix = np.tile(np.eye(unknowns), (point_count, 1, 1))  # of minus the Jacobian
    for j in range(unknowns if by_load else unknowns - 1):
        felt = every if j == unknowns - 1 else every & sampling.lasting[j]
        if not felt.any():
            continue
        branches, depth = state.branches.copy(), state.depth
        if j < unknowns - 1:
            branches[j] += _NUDGE * load
        else:
            depth = depth + _NUDGE * load / stiffness
        column = (start - _residual(sampling, branches, depth, felt)[0]) / _NUDGE
        matrix[:, :, j] = np.where(felt[:, None], column, matrix[:, :, j])
    matrix[~every | ~np.isfinite(matrix).all(axis=(1, 2))] = np.eye(unknowns)
    matrix[np.linalg.slogdet(matrix)[0] == 0] = np.eye(unknowns)
    matrix = np.linalg.inv(matrix)
    matrix[~(np.abs(matrix) < _SINGULAR).all(axis=(1, 2))] = np.eye(unknowns)
    return matrix


def _residual(
    sampling: Sampling,
    branches: Float[np.ndarray, "branches points"],
    depth: Float[np.ndarray, " points"],
    active: Bool[np.ndarray, " points"],
    exact: bool = False,
) -> tuple[Float[np.ndarray, "points unknowns"], Swept]:
    """What a sweep leaves of periodicity and of the load, in units of the load."""
    end, (load, _, by_load) = (
        _sweep(sampling, branches, depth, active, exact),
        sampling.to,
    )
    r = (end.branches - branches + sampling.by.gain * (depth - end.u)) / sampling.whole
    r[: sampling.slow] = np.where(
        sampling.is_slow, -end.sums / sampling.sums, r[: sampling.slow]
    )
    mean = end.load / sampling.samples
    last = load - mean if by_load else np.zeros_like(mean)
    return (np.concatenate([r, last[None]]) / load).T, end


def _mu(sampling: Sampling, end: Swept) -> Float[np.ndarray, " points"]:
    work, load = np.asarray(end.work), np.asarray(end.load)
    return work / sampling.spacing / np.where(load > 0, load, np.nan)


def _learn(
    inverse: Float[np.ndarray, "points unknowns unknowns"],
    moved: Float[np.ndarray, "points unknowns"],
    change: Float[np.ndarray, "points unknowns"],
    active: Bool[np.ndarray, " points"],
) -> Float[np.ndarray, "points unknowns unknowns"]:
    """Broyden's update of the inverse Jacobian, H += (s - H y)(s^T H)/(s^T H y), where
    it is well defined.
    """
    seen = (inverse @ change[:, :, None])[:, :, 0]
    row = (moved[:, None] @ inverse)[:, 0]
    pivot = np.einsum("vi,vi->v", moved, seen)
    use = (
        active & (np.abs(pivot) > 1e-4 * np.sum(moved**2, axis=1)) & np.isfinite(pivot)
    )
    factor = np.where(use, 1 / np.where(use, pivot, 1.0), 0.0)
    seen = np.where(use[:, None], seen, 0.0)
    return (
        inverse + factor[:, None, None] * (moved - seen)[:, :, None] * row[:, None, :]
    )


def _sweep(
    sampling: Sampling,
    branches: Float[np.ndarray, "branches points"],
    depth: Float[np.ndarray, " points"],
    active: Bool[np.ndarray, " points"],
    exact: bool,
) -> Swept:
    """A sweep of the points that are still active, padded to a size that is compiled;
    zeros for the others.
    """
    chosen, (rise, by) = np.flatnonzero(active), sampling.ready
    # On a short line a few sweeps of fewer points do not make up for compiling them.
    few = chosen.size <= _FEW and (depth.size <= _FEW or sampling.samples > _SHORT)
    size = _FEW if few else next((s for s in _MANY if s >= depth.size), depth.size)
    pick = np.concatenate([chosen, np.full(size - chosen.size, chosen[0])])
    if size > chosen.size or size < depth.size:
        by = sampling.by.of(pick)
    swept = sweep(
        rise,
        sampling.samples,
        sampling.stride,
        depth[pick],
        branches[:, pick],
        by,
        sampling.slow,
        exact,
    )

    def of_all(field: jax.Array) -> np.ndarray:
        values = np.asarray(field)[..., : chosen.size]
        whole = np.zeros((*values.shape[:-1], depth.size))
        whole[..., chosen] = values
        return whole

    return Swept(*map(of_all, swept))
