"""Steady sliding on a periodic rough line: lines and points, and levels of sampling.

Every point, a velocity with its load or depth, is solved on every 16th sample of the
line first (and every 64th of long lines), then on every 4th, then on all: the state at
the period's start, the depth and what is known of the Jacobian pass from one to the
next (`rough.periodic_state`). Points are solved in batches, on every core.

Every periodic motion has mean q = E_inf mean u (Popov & Hess 2015, ch. 7: the mean sees
only the relaxed modulus). So the load gives mean u, and with the branches split into
slow ones, f_k = E_k (u - mean u), and relaxed ones, the first guess.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Literal, NamedTuple

import jax
import numpy as np

from ..material.relaxation import Relaxation
from .free_steps import LineLaw, line_law
from .periodic_state import (
    PeriodicState,
    Target,
    finish,
    iterate,
    jacobian,
    sampling_of,
)

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_LONG = 65536  # samples from which every 64th comes first
_FEWEST = 256  # samples of the coarsest period, unless the line itself has few
_FEWEST_AT_ONCE = 8  # in a batch, where there are as many
_AT_ONCE = 64  # in a batch, at most
# over the square of a contact's samples: relative error of 99 % of light contacts on
# drawn lines
_FEW = 2.5
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


def solve_line(job: Job, law: Relaxation) -> SolvedLine:
    """Solves all points on one line, in batches on every core."""
    return solve_lines([job], law)[0]


def solve_lines(
    jobs: Sequence[Job],
    law: Relaxation,
    # called with the number of points whenever some are finished
    finished: Callable[[int], None] | None = None,
) -> list[SolvedLine]:
    """Solves all points of all jobs; the batches of every line share the cores."""
    threads = (
        len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else os.cpu_count() or 1
    )
    point_count = sum(job.velocity.size for job in jobs)
    size = min(_AT_ONCE, max(_FEWEST_AT_ONCE, -(-point_count // threads)))
    of_elements, batches = line_law(law), []
    for job in jobs:
        parts = -(-job.velocity.size // size)
        # of one size nearly, so that the last core is not left alone
        batches += [
            job._replace(velocity=velocity, value=value)
            for velocity, value in zip(
                np.array_split(job.velocity, parts),
                np.array_split(job.value, parts),
                strict=True,
            )
        ]

    def run(job: Job) -> SolvedLine:
        line, _ = _batch(job, of_elements)
        if finished is not None:
            finished(job.velocity.size)
        return line

    with ThreadPoolExecutor(min(threads, len(batches))) as pool:
        solved = pool.map(run, batches)
        return [
            _joined(itertools.islice(solved, -(-job.velocity.size // size)))
            for job in jobs
        ]


def solve_states(job: Job, law: Relaxation) -> tuple[SolvedLine, PeriodicState]:
    """All points, and the state at the highest point of each, in one batch."""
    return _batch(job, line_law(law))


def _joined(batches: Iterable[SolvedLine]) -> SolvedLine:
    return SolvedLine(*map(np.concatenate, zip(*batches, strict=True)))


def _batch(job: Job, law: LineLaw) -> tuple[SolvedLine, PeriodicState]:
    # the settings belong to the thread
    with jax.enable_x64(True), np.errstate(all="ignore"):
        return _on_all_levels(job, law)


def _on_all_levels(job: Job, law: LineLaw) -> tuple[SolvedLine, PeriodicState]:
    rise = rises(job.height)
    n, spacing, velocity = rise.size, job.spacing, job.velocity
    to, state = first_guess(rise, law, job)
    strides = strides_of(n)
    every = np.ones(velocity.size, bool)
    sweeps, mus, full = np.zeros(velocity.size), [], every
    fine = settled = good = None
    for stride in strides:
        sampling = sampling_of(rise, spacing, stride, velocity, law, to)
        if stride == strides[0]:
            state = state._replace(inverse=jacobian(sampling, state, every))
        settled, turns, good = iterate(sampling, state)
        fine = finish(sampling, settled)
        sweeps += (turns + 1) / stride
        mus.append(np.where(good, fine.mu, np.nan))
        full = full & (fine.share == 1)
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
    answer = (mu, fine.load, settled.depth, fine.share, error, fine.residual)
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
    rise: Float[np.ndarray, " n"], law: LineLaw, job: Job
) -> tuple[Target, PeriodicState]:
    """The state for branches that are either elastic or relaxed, in closed form, and
    what the points are pressed with.
    """
    n, relaxed = rise.size, law.relaxed
    period = n * job.spacing / job.velocity
    x = law.times[:, None] / period * 2 * np.pi * _CYCLES
    elastic = law.moduli[:, None] * x**2 / (1 + x**2)
    memory = elastic.sum(axis=0)
    below = np.sort(-rise)
    # of max(w + D, 0), at D = below
    mean = (below * np.arange(1, n + 1) - np.cumsum(below)) / n

    # u is the line in contact, and u_free = mean u (1 - in_contact) outside, so that
    # mean u in_contact is the mean of max(w + D, 0) at D = d - u_free
    in_contact = relaxed / (relaxed + memory)
    if job.control == "load":
        mean_u = job.value / relaxed
        rest = mean_u * in_contact
        beyond = below[-1] + rest - mean[-1]
        offset = np.where(rest < mean[-1], np.interp(rest, mean, below), beyond)
        depth = offset + mean_u * (1 - in_contact)
    else:
        depth = job.value
        mean_u = np.empty_like(depth)
        for point, share in enumerate(in_contact):
            depths = below + mean * (1 - share) / share
            mean_u[point] = np.interp(depth[point], depths, mean / share)
        # of a line wholly in contact, d = mean u - mean w
        mean_u = np.maximum(mean_u, depth - below[-1] + mean[-1])
    free = mean_u * (1 - in_contact)
    share = np.maximum(np.searchsorted(below, depth - free) / n, 2 / n)
    unknowns = elastic.shape[0] + 1
    to = Target(relaxed * mean_u, (relaxed + memory) * share, job.control == "load")
    return to, PeriodicState(
        elastic * (depth - mean_u),
        depth,
        np.tile(np.eye(unknowns), (depth.size, 1, 1)),
    )
