"""Steady sliding on a periodic rough line: lines and points, levels of sampling, and
what skipping leaves out.

Every point, a velocity with its load or depth, is solved on every 16th sample of the
line first (and every 64th of long lines), then on every 4th, then on all: the state at
the period's start, the depth and what is known of the Jacobian pass from one to the
next (`rough.periodic_state`). Points are solved in batches, on every core.

Every periodic motion has mean q = E_inf mean u (Popov & Hess 2015, ch. 7: the mean sees
only the relaxed modulus). So the load gives mean u, and with the branches split into
slow ones, f_k = E_k (u - mean u), and relaxed ones, the first guess.
"""

from __future__ import annotations

import hashlib
import itertools
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import jax
import numpy as np

from .. import __version__
from ..material.relaxation import Relaxation
from .branch_reduction import lumped, point_laws
from .period import PointLaws
from .periodic_state import PeriodicState, finish, iterate, jacobian, sampling_of

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_LONG = 65536  # samples from which every 64th comes first
_FEWEST = 256  # samples of the coarsest period, unless the line itself has few
_FEWEST_AT_ONCE = 8  # in a batch, where there are as many
_MANY = 32  # points of a load from which they make batches of their own
# at most, in a batch: wider sums over branches XLA would hand to a library that no
# kernel can call
_AT_ONCE = 64
# over the square of a contact's samples: relative error of 99 % of light contacts on
# drawn lines
_FEW = 2.5
LIGHT = 0.3  # share of contact up to which free stretches are looked for
# of the work of elements, over their load and slope
ROUNDING = 16 * np.finfo(float).eps
# waves in a period that decide which branches are slow, for the first guess only
_CYCLES = 8


class SolvedLine(NamedTuple):
    """Solved points; NaN where one did not converge."""

    mu: Float[np.ndarray, " points"]
    load: Float[np.ndarray, " points"]  # mean force per length [N/m]
    depth: Float[np.ndarray, " points"]  # [m]
    share: Float[np.ndarray, " points"]  # share of the line in contact
    error: Float[np.ndarray, " points"]  # of mu, from the sampling
    # bound of mu's relative change by lumped branches
    cost: Float[np.ndarray, " points"]
    residual: Float[np.ndarray, " points"]
    sweeps: Float[np.ndarray, " points"]  # full sweeps' worth
    converged: Bool[np.ndarray, " points"]


def rises(height: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Heights against the highest, from there on backwards: in the order in which a
    line moving to +x passes.
    """
    height = np.asarray(height)[::-1]
    return np.roll(height, -int(np.argmax(height))) - height.max()


class Job(NamedTuple):
    """Points to be solved on one line."""

    height: Float[np.ndarray, " n"]
    spacing: float
    velocity: Float[np.ndarray, " points"]
    value: Float[np.ndarray, " points"]
    control: Literal["load", "depth"]


def solve_line(
    height: Float[np.ndarray, " n"],
    spacing: float,
    law: Relaxation,
    velocity: Float[np.ndarray, " points"],
    value: Float[np.ndarray, " points"],
    control: Literal["load", "depth"],
    rtol: float,
    skip: bool = True,
) -> SolvedLine:
    """Solves all points on one line, in batches on every core."""
    return solve_lines(
        [Job(height, spacing, velocity, value, control)], law, rtol, skip
    )[0]


def solve_lines(
    jobs: Sequence[Job],
    law: Relaxation,
    rtol: float,
    skip: bool = True,
    finished: Any = None,  # called with the number of points whenever some are finished
    # keeps what is finished: get(key) gives None or what was put(key, arrays)
    store: Any = None,
) -> list[SolvedLine]:
    """Solves all points of all jobs; the batches of every line share the cores."""
    threads = (
        len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else os.cpu_count() or 1
    )
    lane_count = sum(job.velocity.size for job in jobs)
    size = min(_AT_ONCE, max(_FEWEST_AT_ONCE, -(-lane_count // threads)))
    batches = [_batches_of(job, size) for job in jobs]
    tasks = []
    for job, parts in zip(jobs, batches, strict=True):
        rise = rises(job.height)
        tasks += [(job, rise, batch) for batch in parts]

    def run(task: tuple[Job, np.ndarray, np.ndarray]) -> SolvedLine:
        job, rise, batch = task
        line = _stored_batch(job, rise, batch, law, rtol, skip, store)
        if finished is not None:
            finished(batch.size)
        return line

    with ThreadPoolExecutor(min(threads, len(tasks))) as pool:
        solved_batches = iter(list(pool.map(run, tasks)))
    lines = []
    for parts in batches:
        back = np.argsort(np.concatenate(parts), kind="stable")
        solved = [next(solved_batches) for _ in parts]
        lines.append(
            SolvedLine(
                *(np.concatenate(fields)[back] for fields in zip(*solved, strict=True))
            )
        )
    return lines


def _batches_of(job: Job, size: int) -> list[np.ndarray]:
    """The points of a job in batches of about `size`, each of points that are alike."""
    # Speeds near each other need the same branches, and light loads leave the same
    # stretches free.
    apart = job.value.size >= _MANY * np.unique(job.value).size
    order = (
        np.lexsort((job.velocity, job.value))
        if apart
        else np.argsort(job.velocity, kind="stable")
    )
    # of one size nearly, so that the last core is not left alone
    return np.array_split(order, -(-order.size // size))


def _stored_batch(
    job: Job,
    rise: np.ndarray,
    batch: np.ndarray,
    law: Relaxation,
    rtol: float,
    skip: bool,
    store: Any,
) -> SolvedLine:
    """A batch of points, from the store where it is kept."""
    velocity, value = job.velocity[batch], job.value[batch]
    spacing = float(job.spacing)
    # the settings belong to the thread
    with jax.enable_x64(True), np.errstate(all="ignore"):
        key = ""
        if store is not None:
            how = (spacing, job.control, rtol, skip)
            key = _key(rise, law, velocity, value, how)
            if (kept := store.get(key)) is not None:
                return SolvedLine._make((*kept[:-1], kept[-1] > 0))
        line, _ = _batch(rise, spacing, law, velocity, value, job.control, rtol, skip)
        if store is not None:
            store.put(key, np.array(line, dtype=np.float64))
    return line


def solve_states(
    height: Float[np.ndarray, " n"],
    spacing: float,
    law: Relaxation,
    velocity: Float[np.ndarray, " points"],
    value: Float[np.ndarray, " points"],
    control: Literal["load", "depth"],
    rtol: float,
) -> tuple[SolvedLine, PeriodicState]:
    """All points with every branch carried, and the state at the highest point, the
    slowest branch first.
    """
    rise, lines, states = rises(height), [], []
    with jax.enable_x64(True):
        for start in range(0, velocity.size, _AT_ONCE):
            batch = slice(start, start + _AT_ONCE)
            line, state = _batch(
                rise,
                float(spacing),
                law,
                velocity[batch],
                value[batch],
                control,
                rtol,
                False,
            )
            lines.append(line)
            states.append(state)
    return SolvedLine(*map(np.concatenate, zip(*lines, strict=True))), PeriodicState(
        np.concatenate([s.branches for s in states], axis=1),
        np.concatenate([s.depth for s in states]),
        np.concatenate([s.inverse for s in states]),
    )


def _key(
    rise: np.ndarray,
    law: Relaxation,
    velocity: np.ndarray,
    value: np.ndarray,
    how: tuple,
) -> str:
    """What a batch depends on, in a few letters."""
    digest = hashlib.sha256(repr((__version__, how)).encode())
    for array in (rise, *jax.tree.leaves(law), velocity, value):
        digest.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
    return digest.hexdigest()[:24]


def _batch(
    rise, spacing, law, velocity, value, control, rtol, skip
) -> tuple[SolvedLine, PeriodicState]:
    n = rise.size
    step = spacing / velocity
    if skip:
        reduced_law, cost = lumped(law, step, n * step, rtol)
    else:
        reduced_law, cost = point_laws(law, velocity.size), np.zeros(velocity.size)
    state, load, stiffness, share = first_guess(
        rise, reduced_law, n * step, value, control
    )
    strides = strides_of(n)
    sweeps, mus, full = np.zeros(velocity.size), [], np.ones(velocity.size, bool)
    fine = settled = good = None
    for stride in strides:
        sampling = sampling_of(
            rise,
            spacing,
            stride,
            step,
            reduced_law,
            load,
            stiffness,
            control,
            skip and share.max() < LIGHT,
        )
        if stride == strides[0]:
            state = state._replace(
                inverse=jacobian(sampling, state, np.ones(velocity.size, bool))
            )
        settled, turns, good = iterate(sampling, state)
        fine = finish(sampling, settled)
        sweeps += (turns + 1) / stride
        mus.append(np.where(good, fine.mu, np.nan))
        full &= fine.share == 1
        state = _where(good, settled, state)
    assert fine is not None  # the last stride is always 1
    assert settled is not None
    mu, error = _limit(mus, full)
    touching = np.where(full, np.inf, np.round(fine.share * n))  # samples
    touching = np.where(touching < 3, 1.0, touching)
    error = (
        np.maximum(error, _FEW * (fine.contacts / touching) ** 2 * np.abs(mu))
        + fine.unsure
    )
    good = good & np.isfinite(fine.mu) & np.isfinite(error)
    error = (
        error
        + ROUNDING * np.sqrt(np.mean(np.diff(rise, append=rise[0]) ** 2)) / spacing
    )
    answer = (mu, fine.load, settled.depth, fine.share, error, cost, fine.residual)
    return SolvedLine._make(
        (*(np.where(good, x, np.nan) for x in answer), sweeps, good)
    ), settled


def _where(
    good: np.ndarray, settled: PeriodicState, before: PeriodicState
) -> PeriodicState:
    """The settled states; where they are not, those before, with nothing learnt."""
    unknown = np.eye(settled.inverse.shape[1])
    return PeriodicState(
        np.where(good, settled.branches, before.branches),
        np.where(good, settled.depth, before.depth),
        np.where(good[:, None, None], settled.inverse, unknown),
    )


def strides_of(n: int) -> list[int]:
    """Every how manieth of the samples is taken, level by level."""
    coarse = [
        s
        for s in ((64, 16, 4) if n >= _LONG else (16, 4))
        if n % s == 0 and n // s >= min(_FEWEST, n // 4)
    ]
    return [*coarse, 1]


def _limit(mus: list[np.ndarray], full: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """mu and its error from the sampling, from the mu of steps that are a quarter of
    the one before each.

    In full contact everything is smooth and the error falls as the square of the step:
    the limit is extrapolated, where the fall itself is as it should be. Otherwise it
    falls as the square too, but for a factor that depends on where between two samples
    the edges of contacts lie: the last value stands. Its error is half of the last
    change, where a 15th would be a fall as it should be: contacts of a few samples fall
    more slowly. As that change is small by accident now and then, the one before it
    counts in proportion.

    A coarse level that was not solved (NaN) is left out: the next one is compared with
    the one before, a larger change.
    """
    for coarser, finer in itertools.pairwise(range(len(mus) - 1)):
        mus[finer] = np.where(np.isnan(mus[finer]), mus[coarser], mus[finer])
    fine, changes = mus[-1], [np.abs(b - a) for a, b in itertools.pairwise(mus)][::-1]
    known = [changes[0], *(np.nan_to_num(change) for change in changes[1:])]
    bounds = [change / (2 * 16.0**level) for level, change in enumerate(known)]
    error = np.where(full, changes[0] / 3, np.max(bounds, axis=0))
    if len(changes) > 1:
        change, before = fine - mus[-2], mus[-2] - mus[-3]
        smooth = full & (np.abs(before - 16 * change) < 0.2 * np.abs(before))
        fine = np.where(smooth, fine + change / 15, fine)
        error = np.where(smooth, np.abs(change - before / 16) / 15, error)
    return fine, error + 1e-9 * np.abs(fine)


def first_guess(
    rise, law: PointLaws, period, value, control
) -> tuple[PeriodicState, np.ndarray, np.ndarray, np.ndarray]:
    """State, load, stiffness and share for branches that are either elastic or relaxed;
    in closed form.
    """
    n, relaxed = rise.size, float(law.relaxed)
    x = law.times / period * 2 * np.pi * _CYCLES
    elastic = law.moduli * x**2 / (1 + x**2)
    memory = elastic.sum(axis=0)
    below = np.sort(-rise)
    # of max(w + D, 0), at D = below
    mean = (below * np.arange(1, n + 1) - np.cumsum(below)) / n

    # u is the line in contact, and u_free = mean u (1 - in_contact) outside, so that
    # mean u in_contact is the mean of max(w + D, 0) at D = d - u_free
    in_contact = relaxed / (relaxed + memory)
    if control == "load":
        mean_u = value / relaxed
        rest = mean_u * in_contact
        beyond = below[-1] + rest - mean[-1]
        offset = np.where(rest < mean[-1], np.interp(rest, mean, below), beyond)
        depth = offset + mean_u * (1 - in_contact)
    else:
        depth = value
        mean_u = np.empty_like(value)
        for point, share in enumerate(in_contact):
            depths = below + mean * (1 - share) / share
            mean_u[point] = np.interp(depth[point], depths, mean / share)
        # of a line wholly in contact, d = mean u - mean w
        mean_u = np.maximum(mean_u, depth - below[-1] + mean[-1])
    free = mean_u * (1 - in_contact)
    share = np.maximum(np.searchsorted(below, depth - free) / n, 2 / n)
    unknowns = elastic.shape[0] + 1
    state = PeriodicState(
        elastic * (depth - mean_u), depth, np.tile(np.eye(unknowns), (value.size, 1, 1))
    )
    return state, np.asarray(relaxed * mean_u), (relaxed + memory) * share, share
