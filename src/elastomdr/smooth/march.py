"""Steady sliding where an element may leave and touch again: one element marched
through the whole profile.

In steady motion every element has the same history, so the passage of one element from
the leading edge x = a to x = -a (beyond which the surface only retreats) is the whole
field: the normal force is int q dx = v int q dt, and the friction force of the line int
q du. `smooth.passage` is faster and more accurate, but holds for convex profiles, where
contact is lost once and for all.

All points and lines march together as the elements of one `diffrax` solve, each in
units of its own passage time. The march is of second order in the sample spacing; its
limit is extrapolated from a series of marches, with an error.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, in_float64, is_traced
from ..element.contact_step import Elements, rest
from ..element.contact_step_solver import ContactStep, RigidSurface
from ..material.relaxation import Relaxation
from ..numerics.interpolation import halving_limit
from ..surface.lines import AbstractLines
from .passage import Control, Passages, estimate_sizes

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_BLOCK = 64  # contact steps per step of the solver
_FEWEST, _MOST = 256, 2**15  # samples per passage
_ITERATIONS = 60  # marches after which the search for a load is given up
_TILT = 3e-4  # change of log A by which slopes are measured
_SMALL = 0.1  # error of mu, relative, up to which it is an estimate
_ROUNDING = 1e-13  # relative error of mu per square root of samples


class _March(NamedTuple):
    """One march, per point."""

    size: Float[Array, " points"]  # contact size A [m]
    normal: Float[Array, " points"]  # [N]
    drag: Float[Array, " points"]  # [N]
    trailing: Float[Array, " points"]  # [m]
    good: Bool[Array, " points"]


class _Passing(eqx.Module):
    """The rigid surface over one element per line and point: w = g(a) - g(x), x = a (1
    - 2 t), t from 0 to 1.
    """

    lines: AbstractLines
    size: Float[Array, " points"]

    def __call__(self, t: Any) -> Float[Array, " elements"]:
        entry, line = self.lines.entry(self.size), jnp.arange(self.lines.count)[:, None]
        top = self.lines.profile(entry, self.size, line)
        return (top - self.lines.profile(entry * (1 - 2 * t), self.size, line)).reshape(
            -1
        )


@in_float64
def march_passages(
    law: Relaxation,
    lines: AbstractLines,
    control: Control,
    value: Float[Array, " points"],  # load [N] or depth [m]
    velocity: Float[Array, " points"],  # times a_T [m/s]
    rtol: float,
) -> Passages:
    """Steady passages by marching; samples double until `rtol` of mu is met or 2^15 are
    used up.

    What a direction misses of `rtol` is in its `error`, since it may weigh little in an
    average; not converged is where the error is no longer small against mu. `trailing`
    is where contact is lost for the last time, to within one sample. Differentiable as
    `solve_passages` is. Under `jit` or `vmap`, where errors cannot be looked at, `rtol`
    alone decides about the number of samples; errors are reported all the same.
    """
    law, lines, value, velocity = jax.tree.map(
        jnp.asarray, (law, lines, value, velocity)
    )
    frozen = jax.lax.stop_gradient((law, lines, value, velocity))
    blind = is_traced(frozen)
    samples = _FEWEST
    if blind:
        enough = max(_power_of_two(8 / math.sqrt(rtol)), 4 * _FEWEST)
        samples = min(enough, _MOST) // 4
    size = estimate_sizes(frozen[0], frozen[1], control, frozen[2], frozen[3])
    marches: list[_March] = []
    while True:
        marches.append(_solve(*frozen, size, samples, 1e-3 * rtol, control=control))
        size = jnp.where(marches[-1].good, marches[-1].size, size)
        if len(marches) >= 3:
            good, error = _judged(
                marches[-3:], samples, frozen[2] if control == "load" else None
            )
            met = error <= rtol * jnp.abs(marches[-1].drag / marches[-1].normal)
            last = samples >= _MOST or blind
            if last or not np.any(marches[-1].good & ~(good & met)):
                break
        samples *= 2

    coarse, fine = marches[-2:]
    limit = _March(*map(halving_limit, coarse[:-1], fine[:-1]), good=good)
    limit = limit._replace(trailing=fine.trailing)
    if is_traced(law, lines, value, velocity):
        moved = _differentiable(
            law, lines, value, velocity, fine.size, control=control, samples=samples
        )
        limit = jax.tree.map(_with_tangent, limit, moved._replace(good=good))
    return Passages(
        mu=limit.drag / limit.normal,
        normal_force=limit.normal,
        friction_force=limit.drag,
        depth=lines.depth(limit.size),
        leading=lines.entry(limit.size)[0],
        trailing=limit.trailing,
        exponent=lines.rise(lines.entry(limit.size)[0], limit.trailing),
        error=error,
        converged=limit.good,
    )


def _with_tangent(value: Array, moved: Array) -> Array:
    """`value` with the derivatives of `moved`."""
    return (
        value if value.dtype == bool else value + (moved - jax.lax.stop_gradient(moved))
    )


def _judged(
    marches: list[_March], samples: int, load: Array | None
) -> tuple[Array, Array]:
    """Which points have an error that is small against mu, and the error of mu.

    If two changes from N to 2N samples stand as h^2 has them, the limit is off by a
    third of the last change at most; half of it is taken. Otherwise something is not
    yet resolved (where contact ends between two samples, a branch much faster than a
    sample), and the larger of three times the last change and the one before is taken.
    Measured against `solve_passages` on 3000 random points (8 branches over 11 decades,
    with and without a dashpot) it covered the true error of all but a few.
    """
    first, second, third = (march.drag / march.normal for march in marches)
    change, before = jnp.abs(third - second), jnp.abs(second - first)
    regular = jnp.abs(second - first - 4 * (third - second)) < 0.2 * change
    error = jnp.where(regular, 0.5 * change, jnp.maximum(3 * change, before))
    error = error + _ROUNDING * math.sqrt(samples) * jnp.abs(third)
    if load is not None:
        missed = [jnp.abs(march.normal / load - 1) for march in marches]
        error = error + jnp.abs(third) * (missed[-2] + missed[-1])
    good = functools.reduce(jnp.logical_and, (march.good for march in marches))
    return good & (error <= _SMALL * jnp.abs(third)), error


@functools.partial(jax.jit, static_argnames="control")
def _solve(
    law, lines, value, velocity, size, samples, tolerance, *, control: Control
) -> _March:
    """A march at the given depth, or at the load: secant steps on log F_N against log
    A, kept in a bracket.

    Not by the search of `numerics/root.py`: a march is what costs, to compile as well,
    and stands in its program three times.
    """
    if control == "depth":
        return _march(law, lines, velocity, _at_depth(lines, size, value), samples)

    def advance(state):
        log_size, log_before, excess_before, slope, low, high, settled, count, kept = (
            state
        )
        march = _march(law, lines, velocity, jnp.exp(log_size), samples)
        excess = jnp.log(march.normal / value)
        moved = log_size - log_before
        secant = (excess - excess_before) / jnp.where(moved == 0, 1.0, moved)
        slope = jnp.where((moved != 0) & (secant > 0.3) & (secant < 30), secant, slope)
        low = jnp.where(excess < 0, log_size, low)
        high = jnp.where(excess < 0, high, log_size)
        following = log_size - jnp.clip(excess / slope, -3.0, 3.0)
        middle = 0.5 * (
            jnp.maximum(low, log_size - 3) + jnp.minimum(high, log_size + 3)
        )
        following = jnp.where((following > low) & (following < high), following, middle)
        met = jnp.abs(excess) <= tolerance
        kept = jax.tree.map(
            lambda old, new: jnp.where(settled, old, new),
            kept,
            march._replace(good=march.good & met),
        )
        return (
            following,
            log_size,
            excess,
            slope,
            low,
            high,
            settled | met,
            count + 1,
            kept,
        )

    largest = jnp.broadcast_to(
        jnp.asarray(lines.shape.largest_contact, dtype=value.dtype), value.shape
    )
    top = jnp.log(jnp.minimum(largest * (1 - 1e-13), 1e60))
    log_size, no = jnp.log(size), jnp.zeros(value.shape, bool)
    nan, slope, low = (jnp.full_like(value, x) for x in (jnp.nan, 2.5, -140.0))
    start = (log_size, log_size, nan, slope, low, top, no, 0)
    state = (*start, _March(nan, nan, nan, nan, no))
    return jax.lax.while_loop(
        lambda s: ~jnp.all(s[6]) & (s[7] < _ITERATIONS), advance, state
    )[-1]


@functools.partial(jax.jit, static_argnames=("control", "samples"))
def _differentiable(
    law, lines, value, velocity, size, *, control: Control, samples: int
) -> _March:
    """A march at a size found before, with derivatives: the size moves with its
    equation by one Newton step.
    """
    if control == "depth":
        return _march(
            law,
            lines,
            velocity,
            _at_depth(lines, size, value),
            samples,
            differentiable=True,
        )
    march = _march(law, lines, velocity, size, samples, differentiable=True)
    fixed_law, fixed_lines, fixed_velocity = jax.lax.stop_gradient(
        (law, lines, velocity)
    )
    tilted = jnp.concatenate([size * math.exp(_TILT), size * math.exp(-_TILT)])
    sides = _march(fixed_law, fixed_lines, jnp.tile(fixed_velocity, 2), tilted, samples)
    points = size.shape[0]
    slopes = [(side[:points] - side[points:]) / (2 * _TILT) for side in sides[:-1]]
    step = -(march.normal - value) / slopes[1]  # of log A
    return _March(
        *(
            quantity + slope * step
            for quantity, slope in zip(march[:-1], slopes, strict=True)
        ),
        good=march.good,
    )


def _at_depth(lines: AbstractLines, size: Array, depth: Array) -> Array:
    """One Newton step to the size that has the depth."""
    now, slope = jax.jvp(lines.depth, (size,), (jnp.ones_like(size),))
    return size - (now - depth) / jax.lax.stop_gradient(slope)


def _march(
    law: Relaxation,
    lines: AbstractLines,
    velocity: Array,
    size: Array,
    samples: Any,
    differentiable: bool = False,
) -> _March:
    """One march of all points and lines. The number of samples may be traced, unless it
    is to be differentiated.
    """
    entry = lines.entry(size)
    duration = (2 * entry / velocity[None]).reshape(-1)
    scaled = Relaxation(
        law.equilibrium,
        law.moduli,
        law.times[:, None] / duration[None],
        law.viscosity / duration,
    )
    solver, surface, start = (
        ContactStep(_BLOCK),
        RigidSurface(_Passing(lines, size)),
        rest(law, duration.size),
    )
    succeeded: Any = True
    if differentiable:
        # The same steps in a plain scan: diffrax's adjoint for both modes nests its
        # loops and is slow to compile.
        times = jnp.linspace(0.0, 1.0, samples // _BLOCK + 1)

        def step(state: Elements, ends: tuple[Array, Array]) -> tuple[Elements, None]:
            return solver.step(surface, ends[0], ends[1], state, scaled, None, False)[
                0
            ], None

        state, _ = jax.lax.scan(step, start, (times[:-1], times[1:]))
    else:
        solution = diffrax.diffeqsolve(
            surface,
            solver,
            t0=0.0,
            t1=1.0,
            dt0=_BLOCK / samples,
            y0=start,
            args=scaled,
            max_steps=_MOST // _BLOCK,
            throw=False,
        )
        state = jax.tree.map(lambda saved: saved[-1], solution.ys)
        succeeded = solution.result == diffrax.RESULTS.successful
    impulse, work, away = (
        integral.reshape(entry.shape)
        for integral in (state.impulse, state.work, state.away)
    )
    weight = lines.weight(size)
    normal, drag = (
        jnp.sum(weight * 2 * entry * impulse, axis=0),
        jnp.sum(weight * work, axis=0),
    )
    good = succeeded & jnp.isfinite(normal) & jnp.isfinite(drag)
    return _March(size, normal, drag, (entry * (1 - 2 * away))[0], good)


def _power_of_two(number: float) -> int:
    return 2 ** math.ceil(math.log2(number))
