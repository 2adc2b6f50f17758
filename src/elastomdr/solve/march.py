"""Steady sliding where an element may leave and touch again: one element marched through the whole profile.

In steady motion every element has the same history, so the passage of one element from the leading edge x = a to x = -a
(beyond which the surface only retreats) is the whole field: with the velocity v, int q dx = v int q dt is the normal
force and int q du the friction force of the line. `solve.passage` is faster and more accurate, but rests on a profile
that is convex, so that contact is lost once and for all.

All points and lines march together as elements of one `diffrax` solve, each in units of its own passage time. The march
is of second order in the sample spacing; the answer is the extrapolation of the last two of a series of marches.
"""

import functools
import math
from typing import Any, NamedTuple

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .._runtime import is_traced
from ..foundation.step import ContactStep, RigidSurface, rest
from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .passage import Control, Passages, _first_guess, _size_of_depth
from .integrals import Passage
from .rule import Rule

_BLOCK = 64  # contact steps per step of the solver
_FEWEST, _MOST = 256, 2**15  # samples per passage
_ITERATIONS = 60  # marches after which the search for a load is given up
_TILT = 3e-4  # change of log A by which slopes are measured


class _March(NamedTuple):
    """Forces of one march, per point."""

    size: Float[Array, " points"]  # contact size A [m]
    normal: Float[Array, " points"]  # [N]
    drag: Float[Array, " points"]  # [N]
    trailing: Float[Array, " points"]  # [m]
    good: Bool[Array, " points"]


class _Passing(eqx.Module):
    """The rigid surface above an element, w = g(a) - g(x) with x = a (1 - 2 t), t = 0 ... 1 through the passage."""

    lines: AbstractLines
    size: Float[Array, " points"]

    def __call__(self, t: Any) -> Float[Array, " lines*points"]:
        entry, line = self.lines.entry(self.size), jnp.arange(self.lines.count)[:, None]
        top = self.lines.profile(entry, self.size, line)
        return (top - self.lines.profile(entry * (1 - 2 * t), self.size, line)).reshape(-1)


def march_passages(
    law: Relaxation,
    lines: AbstractLines,
    control: Control,
    value: Float[Array, " points"],  # load [N] or depth [m]
    velocity: Float[Array, " points"],  # times a_T [m/s]
    rtol: float,
) -> Passages:
    """Steady passages by marching; samples double until `rtol` of mu is met, or 2^15 are used up: not converged.

    Differentiable as `solve_passages` is. Under `jit` or `vmap`, where errors cannot be looked at, the number of samples
    follows from `rtol` alone; the error is reported all the same.
    """
    law, lines, value, velocity = jax.tree.map(jnp.asarray, (law, lines, value, velocity))
    frozen = jax.lax.stop_gradient((law, lines, value, velocity))
    blind = is_traced(frozen)
    samples = _FEWEST
    if blind:
        samples = min(max(2 ** math.ceil(math.log2(8 / math.sqrt(rtol))), _FEWEST), _MOST) // 4
    size = _start(*frozen, control=control)
    marches: list[_March] = []
    while True:
        marches.append(_solve(*frozen, size, samples, 1e-3 * rtol, control=control))
        size = marches[-1].size
        if len(marches) > 2:
            mu, error = _extrapolated(marches)
            unsettled = marches[-1].good & ~(error <= rtol * jnp.abs(mu))
            if samples >= _MOST or (blind and len(marches) == 3) or (not blind and not np.any(unsettled)):
                break
        samples *= 2

    good = marches[-1].good & marches[-2].good & (error <= rtol * jnp.abs(mu))
    if is_traced(law, lines, value, velocity):
        steps = ((marches[-2], samples // 2), (marches[-1], samples))
        marches[-2:] = [
            _differentiable(law, lines, value, velocity, m.size, control=control, samples=n) for m, n in steps
        ]
        mu, _ = _extrapolated(marches)
    coarse, fine = marches[-2:]
    size = fine.size + (fine.size - coarse.size) / 3
    normal = fine.normal + (fine.normal - coarse.normal) / 3
    return Passages(
        mu=mu,
        normal_force=normal,
        friction_force=mu * normal,
        depth=lines.depth(size),
        leading=lines.entry(size)[0],
        trailing=fine.trailing,
        error=jax.lax.stop_gradient(error),
        converged=good,
    )


def _extrapolated(marches: list[_March]) -> tuple[Array, Array]:
    """mu to h -> 0, and its error: the last change, since where between two samples contact ends is not smooth in h."""
    first, second, third = (m.drag / m.normal for m in marches[-3:])
    change = third - second
    rounding = 1e-15 * jnp.abs(third)
    return third + change / 3, jnp.maximum(jnp.abs(change), 0.25 * jnp.abs(second - first)) + rounding


@functools.partial(jax.jit, static_argnames="control")
def _start(law: Relaxation, lines: AbstractLines, value: Array, velocity: Array, *, control: Control) -> Array:
    top = _top(lines, value)
    if control == "depth":
        return _size_of_depth(lines, value, top)
    return jnp.exp(_first_guess(Passage(law, lines, Rule(6), velocity), value, top))


def _top(lines: AbstractLines, value: Array) -> Array:
    """Logarithm of the largest size that the shape allows."""
    largest = jnp.broadcast_to(jnp.asarray(lines.shape.largest_contact, dtype=value.dtype), value.shape)
    return jnp.log(jnp.minimum(largest * (1 - 1e-13), 1e60))


@functools.partial(jax.jit, static_argnames="control")
def _solve(law, lines, value, velocity, size, samples, tolerance, *, control: Control) -> _March:
    """A march at the depth that `size` has, or at the load: secant steps on log F_N against log A, kept in a bracket."""
    if control == "depth":
        return _march(law, lines, velocity, size, samples)

    def advance(state):
        log_size, before, excess_before, slope, low, high, done, count, kept = state
        march = _march(law, lines, velocity, jnp.exp(log_size), samples)
        excess = jnp.log(march.normal / value)
        moved = log_size - before
        secant = (excess - excess_before) / jnp.where(moved == 0, 1.0, moved)
        slope = jnp.where((moved != 0) & (secant > 0.3) & (secant < 30), secant, slope)
        low, high = jnp.where(excess < 0, log_size, low), jnp.where(excess < 0, high, log_size)
        following = log_size - jnp.clip(excess / slope, -3.0, 3.0)
        middle = 0.5 * (jnp.maximum(low, log_size - 3) + jnp.minimum(high, log_size + 3))
        following = jnp.where((following > low) & (following < high), following, middle)
        met = jnp.abs(excess) <= tolerance
        march = march._replace(good=march.good & met)
        kept = jax.tree.map(functools.partial(jnp.where, done), kept, march)
        done = done | met
        following, before = jnp.where(done, log_size, following), jnp.where(done, before, log_size)
        return following, before, excess, slope, low, high, done, count + 1, kept

    log_size, nan = jnp.log(size), jnp.full_like(value, jnp.nan)
    none = _March(nan, nan, nan, nan, jnp.zeros(value.shape, bool))
    state = (log_size, log_size, nan, jnp.full_like(value, 2.5), jnp.full_like(value, -140.0), _top(lines, value))
    state = (*state, jnp.zeros(value.shape, bool), 0, none)
    state = jax.lax.while_loop(lambda s: ~jnp.all(s[6]) & (s[7] < _ITERATIONS), advance, state)
    return state[-1]


@functools.partial(jax.jit, static_argnames=("control", "samples"))
def _differentiable(law, lines, value, velocity, size, *, control: Control, samples: int) -> _March:
    """A march at a size found before, with derivatives: the size moves with its equation by one Newton step."""
    kept = jax.lax.stop_gradient
    if control == "depth":
        depth, slope = jax.jvp(lines.depth, (size,), (jnp.ones_like(size),))
        size = size - (depth - value) / kept(slope)
        return _march(law, lines, velocity, size, samples, adjoint=diffrax.DirectAdjoint())
    march = _march(law, lines, velocity, size, samples, adjoint=diffrax.DirectAdjoint())
    fixed = kept((law, lines, velocity))
    up, down = (_march(*fixed, size * math.exp(tilt), samples) for tilt in (_TILT, -_TILT))
    slope = jax.tree.map(lambda a, b: (a - b) / (2 * _TILT), up[:-1], down[:-1])
    step = -(march.normal - value) / slope[1]
    size, normal, drag, trailing = (part + change * step for part, change in zip(march[:-1], slope, strict=True))
    return _March(size, normal, drag, trailing, march.good)


def _march(law, lines, velocity, size, samples, adjoint: diffrax.AbstractAdjoint | None = None) -> _March:
    """One march of all points and lines with a given number of samples."""
    entry = lines.entry(size)
    duration = (2 * entry / velocity).reshape(-1)
    scaled = Relaxation(law.equilibrium, law.moduli, law.times[:, None] / duration, law.viscosity / duration)
    solution = diffrax.diffeqsolve(
        RigidSurface(_Passing(lines, size)),
        ContactStep(_BLOCK),
        t0=0.0,
        t1=1.0,
        dt0=_BLOCK / samples,
        y0=rest(law, duration.size),
        args=scaled,
        max_steps=_MOST // _BLOCK if adjoint is None else samples // _BLOCK,
        adjoint=adjoint or diffrax.RecursiveCheckpointAdjoint(),
        throw=False,
    )
    impulse, work, away = (getattr(solution.ys, name)[-1].reshape(entry.shape) for name in ("impulse", "work", "away"))
    weight = lines.weight(size)
    normal, drag = jnp.sum(weight * 2 * entry * impulse, axis=0), jnp.sum(weight * work, axis=0)
    good = (solution.result == diffrax.RESULTS.successful) & jnp.isfinite(normal) & jnp.isfinite(drag)
    return _March(size, normal, drag, (entry * (1 - 2 * away))[0], good)
