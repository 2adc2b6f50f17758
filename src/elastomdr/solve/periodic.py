"""Steady sliding on a periodic rough line: the periodic state and, for a given load, the depth, by quasi-Newton sweeps.

One sweep from a state f_k(0) tells how far that state is from a periodic one. The motion that the sweep has found would
leave, when repeated for ever, the branch at

    f_k(0) + [f_k(T) - f_k(0) + g_k (u(0) - u(T))]/(1 - exp(-T/tau_k)),

and since periodic forces have no mean, sum_n f_k(n) = 0, a slow branch (tau_k >> T) more accurately at
f_k(0) - sum_n f_k(n) / sum_n exp(-n h/tau_k). The differences, with that of the load, are the residuals r(f_k(0), d).
Repeating the motion is a contraction, but a slow one for light contacts with slow branches; Broyden's method, which
learns the Jacobian as it goes, needs 5 to 10 sweeps. It is done on every 16th sample first (and every 64th of long
lines), then on every 4th, then on all: state, depth and Jacobian pass from one to the next.

Every periodic motion has mean q = E_inf mean u (Popov & Hess 2015, ch. 7: the mean sees only the relaxed modulus). So
the load gives mean u, and with the branches split into slow ones, f_k = E_k (u - mean u), and relaxed ones, the first
guess.
"""

import hashlib
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Literal, NamedTuple

import jax
import numpy as np
from jaxtyping import Bool, Float

from .. import __version__
from ..material.relaxation import Relaxation
from .condense import Condensation, choose, condensed
from .period import Coefficients, Swept, coefficients, sweep

RESIDUAL = 1e-9  # of the state and of the load, relative to the load
_SMALL = 1.0  # mu below which the residual is smaller in proportion: friction is a small part of the forces
_LONG = 65536  # samples from which every 64th comes first
_FEWEST = 256  # samples of the coarsest period
_SLOW = 1e-2  # T/tau below which a branch is made periodic by its mean
_LANES = (8, 32)  # sizes that are compiled
_SWEEPS = 60  # at most, per level
_CYCLES = 8  # waves in a period that decide which branches are slow, for the first guess only


class Line(NamedTuple):
    """Solved lanes; NaN where one did not converge."""

    mu: Float[np.ndarray, " lanes"]
    load: Float[np.ndarray, " lanes"]  # mean force per length [N/m]
    depth: Float[np.ndarray, " lanes"]  # [m]
    share: Float[np.ndarray, " lanes"]  # share of the line in contact
    error: Float[np.ndarray, " lanes"]  # of mu, from the sampling
    cost: Float[np.ndarray, " lanes"]  # bound of mu's relative change by condensed branches
    residual: Float[np.ndarray, " lanes"]
    sweeps: Float[np.ndarray, " lanes"]  # full sweeps' worth
    converged: Bool[np.ndarray, " lanes"]


class _State(NamedTuple):
    """The unknowns of each lane: f_k(0) and d; and the inverse Jacobian learnt so far, in units of the load."""

    branches: Float[np.ndarray, "branches lanes"]
    depth: Float[np.ndarray, " lanes"]
    inverse: Float[np.ndarray, "lanes unknowns unknowns"]


def rises(height: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Heights against the highest, from there on backwards: in the order in which a line moving to +x passes."""
    height = np.asarray(height)[::-1]
    return np.roll(height, -int(np.argmax(height))) - height.max()


def solve_line(
    height: Float[np.ndarray, " n"],
    spacing: float,
    law: Relaxation,
    velocity: Float[np.ndarray, " lanes"],
    value: Float[np.ndarray, " lanes"],
    control: Literal["load", "depth"],
    rtol: float,
    skip: bool = True,
    done: Any = None,  # called with the number of lanes whenever some are finished
    store: Any = None,  # keeps what is finished: get(key) gives None or what was put(key, arrays)
) -> Line:
    """Solves all lanes on one line, in batches on every core."""
    rise = rises(height)
    how = Condensation(np.size(law.moduli))
    if skip:  # between the passage of one sample and that of the whole line
        how = choose(law, spacing / velocity.max(), rise.size * spacing / velocity.min(), rtol)
    law = condensed(law, how)
    order = np.argsort(velocity, kind="stable")
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    size = min(_LANES[-1], max(_LANES[0], -(-velocity.size // threads)))
    batches = [order[i : i + size] for i in range(0, velocity.size, size)]

    def run(batch: np.ndarray) -> Line:
        with jax.enable_x64(True):  # the setting belongs to the thread
            key = (
                "" if store is None else _key(rise, law, velocity[batch], value[batch], (spacing, control, rtol, skip))
            )
            kept = None if store is None else store.get(key)
            if kept is None:
                found = _batch(rise, float(spacing), law, velocity[batch], value[batch], control, how.cost)
                if store is not None:
                    store.put(key, np.array(found, dtype=np.float64))
            else:
                found = Line._make((*kept[:-1], kept[-1] > 0))
        if done is not None:
            done(batch.size)
        return found

    with ThreadPoolExecutor(min(threads, len(batches))) as pool:
        parts = list(pool.map(run, batches))
    back = np.argsort(np.concatenate(batches), kind="stable")
    return Line(*(np.concatenate(fields)[back] for fields in zip(*parts, strict=True)))


def _key(rise: np.ndarray, law: Relaxation, velocity: np.ndarray, value: np.ndarray, how: tuple) -> str:
    """What a batch depends on, in a few letters."""
    digest = hashlib.sha256(repr((__version__, how)).encode())
    for part in (rise, *jax.tree.leaves(law), velocity, value):
        digest.update(np.ascontiguousarray(part, dtype=np.float64).tobytes())
    return digest.hexdigest()[:24]


def _batch(rise, spacing, law, velocity, value, control, cost) -> Line:
    n = rise.size
    state, load, stiffness = _first_guess(rise, spacing, law, velocity, value, control)
    strides = [
        s for s in ((64, 16, 4, 1) if n >= _LONG else (16, 4, 1)) if s == 1 or (n % s == 0 and n // s >= _FEWEST)
    ]
    sweeps, mus, full = np.zeros(velocity.size), [np.full(velocity.size, np.nan)], np.ones(velocity.size, bool)
    fine = None
    for stride in strides:
        guess = state
        fine = _iterate(rise, stride, spacing, law, velocity, load, stiffness, control, state)
        sweeps += fine.sweeps / stride
        good = fine.converged
        mus.append(np.where(good, fine.mu, np.nan))
        full &= fine.share == 1
        state = _State(
            np.where(good, fine.state.branches, guess.branches), np.where(good, fine.state.depth, guess.depth),
            np.where(good[:, None, None], fine.state.inverse, np.eye(guess.inverse.shape[1])),
        )  # fmt: skip
    assert fine is not None  # the last stride is always 1
    good = fine.converged & np.isfinite(fine.mu)
    mu, error = _limit(mus, full)
    lanes = (mu, fine.load, fine.state.depth, fine.share, error, np.full(velocity.size, cost), fine.residual)
    return Line._make((*(np.where(good, x, np.nan) for x in lanes), sweeps, good))


def _limit(mus: list[np.ndarray], full: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """mu and its error from the sampling, from the mu of steps that are a quarter of the one before each.

    In full contact everything is smooth and the error falls as the square of the step: the limit is extrapolated, where
    the fall itself is as it should be. Otherwise edges of contacts fall anywhere between samples: the last value
    stands, and a third of the last change bounds an error of first order, where a 15th would be the second.
    """
    fine, change = mus[-1], mus[-1] - mus[-2]
    error = np.abs(change) / 3
    if len(mus) > 3:
        before = mus[-2] - mus[-3]
        smooth = full & (np.abs(before - 16 * change) < 0.2 * np.abs(before))
        fine = np.where(smooth, fine + change / 15, fine)
        error = np.where(smooth, np.abs(change - before / 16) / 15, error)
    return fine, error + 1e-9 * np.abs(fine)


class _Solved(NamedTuple):
    state: _State
    mu: np.ndarray
    load: np.ndarray
    share: np.ndarray
    residual: np.ndarray
    sweeps: np.ndarray
    converged: np.ndarray


def _first_guess(rise, spacing, law, velocity, value, control) -> tuple[_State, np.ndarray, np.ndarray]:
    """State, load and stiffness against depth for branches that are either elastic or relaxed; in closed form."""
    n, relaxed = rise.size, float(law.equilibrium)
    x = velocity / (n * spacing) * np.asarray(law.times)[:, None] * 2 * np.pi * _CYCLES
    elastic = np.asarray(law.moduli)[:, None] * x**2 / (1 + x**2)
    memory = elastic.sum(axis=0)
    below = np.sort(-rise)
    mean = (below * np.arange(1, n + 1) - np.cumsum(below)) / n  # of max(w + D, 0), at D = below

    def over(rest):  # D for a mean of `rest`
        return np.where(rest < mean[-1], np.interp(rest, mean, below), below[-1] + rest - mean[-1])

    part = relaxed / (relaxed + memory)

    def depth_of(level):  # d for a mean u of `level`: u is the line in contact, u_free = level (1 - part) outside
        return over(level * part) + level * (1 - part)

    level = value / relaxed
    if control == "load":
        depth = depth_of(level)
    else:
        depth, low, high = value, np.zeros_like(value), value.copy()
        for _ in range(80):
            level = 0.5 * (low + high)
            deep = depth_of(level) > depth
            low, high = np.where(deep, low, level), np.where(deep, level, high)
    share = np.maximum(np.searchsorted(below, depth - level * (1 - part)) / n, 2 / n)
    unknowns = elastic.shape[0] + 1
    state = _State(elastic * (depth - level), depth, np.tile(np.eye(unknowns), (velocity.size, 1, 1)))
    return state, np.asarray(relaxed * level), (relaxed + memory) * share


def _iterate(rise, stride, spacing, law, velocity, load, stiffness, control, state: _State) -> _Solved:
    count = rise.size // stride
    step = stride * spacing / velocity
    by = coefficients(law, step)
    x = count * step / np.asarray(law.times)[:, None]
    whole = -np.expm1(-x)
    slow = x < _SLOW
    sums = np.where(slow, by.keep * whole / -np.expm1(-step / np.asarray(law.times)[:, None]), 1.0)
    floor = 2e-16 * np.sqrt(count) * state.depth / (by.give * load)  # what rounding of u leaves
    lanes, unknowns = velocity.size, state.inverse.shape[1]
    branches, depth, inverse = (np.array(a) for a in state)
    best, kept, failures = np.full(lanes, np.inf), None, np.zeros(lanes, int)
    moved = before = None
    force, active = np.zeros(lanes), np.ones(lanes, bool)
    out = [np.full(lanes, np.nan) for _ in range(4)]
    turns = np.zeros(lanes)
    for _ in range(_SWEEPS):
        end = _sweep(rise, count, stride, depth, force, branches, by, active)
        turns += active
        mean = end.load / count
        back = (end.branches - branches + by.gain * (depth - end.u)) / whole
        r = np.where(slow, -end.sums / sums, back) / load
        last = (load - mean) / load if control == "load" else np.zeros(lanes)
        r = np.concatenate([r, last[None]]).T
        size = np.where(np.isfinite(r).all(axis=1), np.abs(r).max(axis=1), np.inf)
        late = np.abs(end.q - force) * np.abs(depth) / np.maximum(np.abs(end.work), 1e-300) / count
        length = count * stride * spacing
        mu = end.work / (length * np.where(mean > 0, mean, np.nan))
        goal = np.maximum(RESIDUAL * np.clip(mu / _SMALL, 1e-4, 1.0), floor)
        finished = active & (size <= goal) & (late < 1e-6)
        for field, new in zip(out, (mu, mean, end.touching / count, size), strict=True):
            field[active] = new[active]
        active = active & ~finished
        if not active.any():
            break
        if moved is not None and before is not None:
            inverse = _learn(inverse, moved, before - r, active)
        force = np.where(active, end.q, force)
        if kept is None:
            kept = (depth.copy(), branches.copy(), r.copy())
        worse = active & ~(size <= 2 * best)
        failures = np.where(worse, failures + 1, 0)
        retry = failures >= 3  # what was learnt misleads: start over from the best point, with shorter steps
        inverse = np.where(
            retry[:, None, None], np.eye(unknowns) * 0.5 ** np.minimum(failures, 8)[:, None, None], inverse
        )
        depth, branches = np.where(worse, kept[0], depth), np.where(worse, kept[1], branches)
        r = np.where(worse[:, None], kept[2], r)
        better = active & (size <= best)
        kept = (
            np.where(better, depth, kept[0]), np.where(better, branches, kept[1]), np.where(better[:, None], r, kept[2])
        )  # fmt: skip
        best = np.where(better, size, best)
        moved = np.einsum("vij,vj->vi", inverse, r)
        down = moved[:, -1] * load / stiffness
        moved *= (np.minimum(1.0, 0.5 * depth / np.maximum(np.abs(down), 1e-300)) * active)[:, None]
        if control == "depth":
            moved[:, -1] = 0.0
        branches = branches + moved[:, :-1].T * load
        depth = depth + moved[:, -1] * load / stiffness
        before = r
    mu, mean, share, size = out
    return _Solved(_State(branches, depth, inverse), mu, mean, share, size, turns, ~active)


def _learn(inverse, moved, change, active):
    """Broyden's update of the inverse Jacobian, H += (s - H y)(s^T H)/(s^T H y), where it is well defined."""
    seen = np.einsum("vij,vj->vi", inverse, change)
    row = np.einsum("vi,vij->vj", moved, inverse)
    pivot = np.einsum("vi,vi->v", moved, seen)
    use = active & (np.abs(pivot) > 1e-4 * np.sum(moved**2, axis=1)) & np.isfinite(pivot)
    factor = np.where(use, 1 / np.where(use, pivot, 1.0), 0.0)
    seen = np.where(use[:, None], seen, 0.0)
    return inverse + factor[:, None, None] * (moved - seen)[:, :, None] * row[:, None, :]


def _sweep(rise, count, stride, depth, force, branches, by: Coefficients, active) -> Swept:
    """A sweep of the lanes that are still active, padded to a size that is compiled; zeros for the others."""
    chosen = np.flatnonzero(active)
    size = next((s for s in _LANES if s >= chosen.size), chosen.size)
    pick = np.concatenate([chosen, np.full(size - chosen.size, chosen[0])])
    found = sweep(
        rise, count, stride, depth[pick], force[pick], branches[:, pick],
        Coefficients(by.keep[:, pick], by.gain[:, pick], by.give[pick], by.relaxed),
    )  # fmt: skip
    whole = []
    for field in found:
        part = np.asarray(field)[..., : chosen.size]
        full = np.zeros((*part.shape[:-1], depth.size))
        full[..., chosen] = part
        whole.append(full)
    return Swept(*whole)
