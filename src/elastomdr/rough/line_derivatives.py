"""Friction of a rough line or surface under a transformation of JAX, with derivatives,
forward and reverse, with respect to all that goes into it. Each point has its own
directions.

The periodic state y = (f_k(0), d) solves r(y, p) = 0, with p the moduli, times,
heights, velocity and load. It is found outside of what JAX traces (`rough.periodic`).
From there one step of Newton's method,

    y(p) = y - (dr/dy)^-1 r(y, p),

changes nothing in y, to the residual it was left with, and gives it the derivative of
the implicit function. Friction is a function of y(p) and p, so that its derivative
follows by running through the period, twice: the contact step is differentiable but
where an element is just touched, and those are few.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, argmax, is_traced, nan_unless
from ..material.relaxation import Relaxation
from ..surface.direction import directions, quadrature_error
from ..surface.rough_line import RoughLine
from .branch_reduction import slowest_first
from .ensemble import AVERAGE, Mean
from .free_recovery import rates_apart, weights
from .period import PUSHED
from .periodic import solve_states
from .periodic_state import LASTING, SLOW

if TYPE_CHECKING:
    from jaxtyping import Float

# steps whose intermediate values are computed again for the reverse mode instead of
# being kept
_CHUNK = 64


class Differentiable(NamedTuple):
    """Solved points under a transformation of JAX; NaN where one did not converge."""

    mu: Float[Array, " points"]
    load: Float[Array, " points"]  # [N/m]
    depth: Float[Array, " points"]  # [m]
    share: Float[Array, " points"]  # without a derivative, as are those below
    error: Float[Array, " points"]
    good: Float[Array, " points"]  # 1 where converged


def traced_mean_of_lines(
    lines: list[RoughLine],
    law: Relaxation,
    velocity: Float[Array, " n"],
    value: Float[Array, " n"],
    control: Any,
    rtol: float,
    average: bool,
) -> Mean:
    """Mean over the lines, as `rough.ensemble.mean_of_lines`: the same numbers, with
    derivatives.
    """
    runs = [
        _one_line(line, law, velocity, value, control, rtol, average) for line in lines
    ]
    mu, error, load, depth, share = (
        jnp.stack(values).mean(axis=0) for values in list(zip(*runs, strict=True))[:5]
    )
    good = jnp.stack([run.good for run in runs]).all(axis=0)
    scatter = (
        jnp.std(jnp.stack([run.mu for run in runs]), axis=0, ddof=1) / len(runs) ** 0.5
        if len(runs) > 1
        else None
    )
    return Mean(mu, error, load, depth, share, good & jnp.isfinite(mu), scatter)


def _one_line(line: RoughLine, law, velocity, value, control, rtol, average) -> Mean:
    spacing = line.spacing

    def solved(velocity: Array, value: Array, control: Any) -> Differentiable:
        if not is_traced(spacing):
            return solve_traced(
                line.height, float(spacing), law, velocity, value, control, rtol
            )
        # A line stretched by a factor passes in the same time at as many times the
        # speed, with slopes as much smaller.
        unit_spaced = solve_traced(
            line.height, 1.0, law, velocity / spacing, value, control, rtol
        )
        return unit_spaced._replace(
            mu=unit_spaced.mu / spacing, error=unit_spaced.error / spacing
        )

    if not average:
        ahead = solved(velocity, value, control)
        return Mean(
            ahead.mu,
            ahead.error,
            ahead.load,
            ahead.depth,
            ahead.share,
            ahead.good > 0,
            None,
        )
    rule = directions(max(rtol, AVERAGE))
    ahead = solved(velocity, value, control)
    slowed = velocity[:, None] * rule.cosines
    loads = jnp.broadcast_to(ahead.load[:, None], slowed.shape)
    every = solved(slowed.ravel(), loads.ravel(), "load")
    each = every.mu.reshape(slowed.shape)
    mu, half, quarter = (
        (each * weights).sum(axis=1)
        for weights in (rule.weights, rule.half, rule.quarter)
    )
    sampled = (every.error.reshape(slowed.shape) * rule.weights).sum(axis=1)
    error = quadrature_error(mu, half, quarter, rule.tail) + sampled
    good = (ahead.good > 0) & (every.good.reshape(slowed.shape) > 0).all(axis=1)
    return Mean(mu, error, ahead.load, ahead.depth, ahead.share, good, None)


def solve_traced(
    height: Float[Array, " n"],
    spacing: float,
    law: Relaxation,
    velocity: Float[Array, " points"],
    value: Float[Array, " points"],
    control: Literal["load", "depth"],
    rtol: float,
) -> Differentiable:
    """As `rough.periodic.solve_line`, for arguments that JAX traces."""
    branches, lane_count = jnp.shape(law.moduli)[0], jnp.shape(velocity)[0]
    answer = [
        jax.ShapeDtypeStruct((*s, 2), jnp.uint32)
        for s in ((branches, lane_count), *[(lane_count,)] * 4)
    ]
    fixed = jax.lax.stop_gradient((jnp.asarray(height), law, velocity, value))
    # JAX calls back from threads of its own, where it would round float64 to float32:
    # bits pass unchanged.
    bits = jax.tree.map(
        lambda x: jax.lax.bitcast_convert_type(jnp.asarray(x, jnp.float64), jnp.uint32),
        fixed,
    )
    solved = partial(_solved, spacing=spacing, control=control, rtol=rtol)
    answer_bits = jax.pure_callback(solved, answer, *bits, vmap_method="sequential")
    state, depth, share, error, good = (
        jax.lax.bitcast_convert_type(x, jnp.float64) for x in answer_bits
    )
    mu, load, depth = _followed(
        jnp.asarray(height), law, velocity, value, state, depth, spacing, control
    )
    mu, load, depth, share, error = (
        nan_unless(good, x) for x in (mu, load, depth, share, error)
    )
    return Differentiable(mu, load, depth, share, error, good)


def _solved(*bits, spacing, control, rtol) -> tuple[np.ndarray, ...]:
    """The solution outside of JAX; in and out as pairs of 32 bits."""
    plain = jax.tree.map(
        lambda x: np.ascontiguousarray(x).view(np.float64)[..., 0], bits
    )
    height, law, velocity, value = plain
    line, state = solve_states(height, spacing, law, velocity, value, control, rtol)
    order = np.argsort(slowest_first(law))
    answer = (
        state.branches[order],
        state.depth,
        line.share,
        line.error,
        line.converged,
    )
    return tuple(
        np.ascontiguousarray(x, dtype=np.float64)[..., None].view(np.uint32)
        for x in answer
    )


@partial(jax.jit, static_argnames=("spacing", "control"))
def _followed(height, law, velocity, value, state, depth, spacing, control):
    height = height[::-1]
    top = argmax(jax.lax.stop_gradient(height))
    rise = jnp.roll(height, -top) - height[top]
    state_and_depth = jnp.concatenate([state, depth[None]])

    def residual(y, rise, law, velocity, value):
        return _period(y, rise, spacing, law, velocity, value, control)[0]

    inputs = (rise, law, velocity, value)
    fixed = jax.lax.stop_gradient(inputs)
    # the depth is no unknown where it is given
    size = state_and_depth.shape[0] - (control == "depth")

    def column(j):
        along = jnp.zeros_like(state_and_depth).at[j].set(1.0)
        return jax.jvp(lambda y: residual(y, *fixed), (state_and_depth,), (along,))[1][
            :size
        ]

    # point, row, column
    jacobian = jnp.moveaxis(jax.vmap(column)(jnp.arange(size)), (0, 1, 2), (2, 1, 0))
    if control == "depth":
        state_and_depth = jnp.concatenate([state, value[None]])
    step = jnp.linalg.solve(
        jacobian, residual(state_and_depth, *inputs)[:size].T[..., None]
    )[..., 0].T
    y = state_and_depth - (
        step
        if size == state_and_depth.shape[0]
        else jnp.concatenate([step, jnp.zeros_like(step[:1])])
    )
    _, mu, load = _period(y, rise, spacing, law, velocity, value, control)
    return mu, load, y[-1]


def _decays(step: Any, law: Relaxation) -> tuple[Any, ...]:
    """z = step/tau_k of each branch, exp(-z), 1 - exp(-z), its mean (1 - exp(-z))/z,
    and (z - 1 + exp(-z))/z^2.
    """
    z = step / law.times[:, None]
    lost = -jnp.expm1(-z)
    # what is not chosen must not be infinite either, for the derivative
    safe = jnp.maximum(z, 1e-4)
    late = jnp.where(
        z < 1e-4, 0.5 - z / 6 + z**2 / 24, (safe + jnp.expm1(-safe)) / safe**2
    )
    return z, jnp.exp(-z), lost, lost / z, late


def _yield_of_branches(step: Any, law: Relaxation, gain: Any) -> tuple[Any, Any]:
    """How far a free element gives way per force, and how much of each branch's force
    it sees in a step.
    """
    # the order of `rates_apart`
    order = jnp.argsort(jnp.where(law.moduli > 0, 1 / law.times, jnp.inf))
    apart = rates_apart(law)[:, :, None]
    times = law.times[:, None]
    give, seen = weights(
        apart, times[order] * jnp.ones_like(step), gain[order], law.equilibrium, step
    )
    return give, seen[jnp.argsort(order)]


def _period(
    y: Float[Array, "m points"],
    rise,
    spacing,
    law: Relaxation,
    velocity,
    value,
    control: str,
) -> Any:
    """Residuals, friction and mean load of one period; the formulas are those of
    `rough.period`.
    """
    n = rise.shape[0]
    step = spacing / velocity
    z, keep, lost, held, late = _decays(step, law)
    gain = law.moduli[:, None] * held
    give, seen = _yield_of_branches(step, law, gain)
    each = law.moduli[:, None] * late
    drag = law.viscosity / step + each.sum(axis=0)
    depth = y[-1]

    def one(state, w):
        f, u, before, last_push, work, load, sums, counts = state
        loose = u - (law.equilibrium * u + (seen * f).sum(axis=0)) * give
        w = w + depth
        new = jnp.maximum(loose, w)
        du, push, free = new - u, new - loose, last_push <= 0
        q = push / give
        mean = 0.5 * law.equilibrium * (u + new) + drag * du + (held * f).sum(axis=0)
        work = work + jnp.where(free & (q <= 0), 0.0, mean * du)
        counts = counts + jnp.stack(
            [(u - before) * push + (new - w) * last_push, free & (q > 0), q > 0]
        )
        f = keep * f + gain * du
        return (f, new, w, push, work, load + q, sums + f, counts), None

    chunk = _CHUNK if n % _CHUNK == 0 else 1
    chunks = jnp.roll(rise, -1).reshape(-1, chunk)
    several = jax.checkpoint(lambda state, w: jax.lax.scan(one, state, w))
    nothing = jnp.zeros_like(depth)
    pushed = jnp.full_like(depth, PUSHED)
    start = (
        y[:-1],
        depth,
        depth,
        pushed,
        nothing,
        nothing,
        jnp.zeros_like(y[:-1]),
        jnp.zeros((3, *depth.shape)),
    )
    (f, u, _, _, work, load, sums, counts), _ = jax.lax.scan(several, start, chunks)
    struck, begun, touching = counts
    duration = jax.lax.stop_gradient(touching / jnp.maximum(begun, 1)) * step
    outlasts = 1 / (1 + (duration / (LASTING * law.times[:, None])) ** 2)
    work = work + (drag - (each * outlasts).sum(axis=0)) * struck
    load = load / n
    whole = -jnp.expm1(-n * z)
    back = (f - y[:-1] + gain * (depth - u)) / whole
    slow = n * z < SLOW
    r = jnp.where(slow, -sums / jnp.where(slow, keep * whole / lost, 1.0), back)
    target = value if control == "load" else jax.lax.stop_gradient(load)
    r = jnp.concatenate([r, (target - load)[None]]) / jax.lax.stop_gradient(target)
    return r, work / (n * spacing * load), load
