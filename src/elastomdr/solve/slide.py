"""Marching a line of elements under a moving body: the exact contact step, all elements at once, and the depth.

At a given load the depth of the body follows from the step itself. With u_free the displacement at which an element
needs no force at the end of the step and S its stiffness, both known before the depth is,

    F_N(d) = sum W S max(0, d - l),    l = u_free - b,

convex, piecewise linear and rising: Newton's method from above ends after a few steps, exactly.
"""

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .._runtime import Array, is_traced
from ..foundation.step import Coefficients, Elements, Fading, advance, coefficients, fade
from ..material.relaxation import Relaxation
from .over_line import AbstractOverLine
from .passage import Control
from .timeline import Steps

_BLOCK = 64  # steps between two states that are kept for reverse mode


class Line(NamedTuple):
    """What n elements remember from one step to the next; see `foundation.step.Elements`."""

    u: Float[Array, " n"]  # [m]
    f: Float[Array, "k n"]  # [Pa m]
    q: Float[Array, " n"]  # [Pa m]
    velocity: Float[Array, " n"] | None  # [m/s], which only a dashpot needs
    stored: Float[Array, " n"]  # in the branches [Pa m^2]
    w: Float[Array, " n"]  # where the rigid surface is [m]


class Forces(NamedTuple):
    """What the body feels, and what became of its work, at the end of each step."""

    depth: Array  # d [m]
    normal: Array  # F_N [N]
    drag: Array  # F_x [N]
    work: Array  # done on the elements since the start [J]
    stored: Array  # in the elements [J]


def untouched(law: Relaxation, surface: AbstractOverLine, position: Array, *, viscous: bool = True) -> Line:
    """A line at rest, the body just above it."""
    rise = surface.rise(position)
    zero, f = jnp.zeros_like(rise), jnp.zeros((law.moduli.shape[0], rise.size))
    return Line(zero, f, zero, zero if viscous else None, zero, rise - jnp.max(rise))


def free(c: Coefficients, line: Line, fading: Fading) -> Float[Array, " n"]:
    """u_free [m]: the displacement of each element at the end of the step that needs no force."""
    return line.u - (c.equilibrium * line.u + fading.seen) / c.stiffness


def lag(c: Coefficients) -> Array:
    """How far before the end of a step its force belongs, as a part of the step: 0 without a dashpot, else up to 1/2.

    With a dashpot the force is a mean over the step with the weight exp(-(h - t) K/eta)
    (`foundation.step.contact_step`), whose centre is 1/z - 1/(exp(z) - 1) before the end, z = h K/eta. The slope of the
    body is taken there.
    """
    rate, static = c.rate[0], (c.end - c.rate)[0]
    z = jnp.minimum(jnp.where(rate > 0, static / jnp.where(rate > 0, rate, 1.0), 700.0), 700.0)
    safe = jnp.maximum(z, 1e-3)
    centre = jnp.where(z > 1e-3, 1 / safe - 1 / jnp.expm1(safe), 0.5 - z / 12)
    return jnp.where(rate > 0, centre, 0.0)


def carried(slope: Array, excess: Float[Array, " n"]) -> tuple[Array, Array]:
    """The force where a contact ends between two elements, and how much it grows as all of `excess` grows by one.

    It is the integral of the positive part of the line drawn through the elements, which are neighbours of one slope.
    sum slope max(0, excess) errs by the square of their distance as well, but with a factor that depends on where the
    contact ends, so that the limit of ever more elements could not be extrapolated from a few.
    """
    edge, rate = _edges(excess)
    inside = excess > 0
    force = jnp.sum(jnp.where(inside, excess, 0.0)) + jnp.sum(edge)
    return slope * force, slope * (jnp.sum(inside) + jnp.sum(rate))


def _edges(excess: Float[Array, " n"]) -> tuple[Float[Array, " n-1"], Float[Array, " n-1"]]:
    """What the positive part of a line from a to b, a b < 0, has less than the mean of max(0, a) and max(0, b)."""
    a, b = excess[:-1], excess[1:]
    between = a * b < 0
    span = jnp.where(between, 2 * jnp.abs(a - b), 1.0)
    return jnp.where(between, a * b / span, 0.0), jnp.where(between, (a + b) / span, 0.0)


def felt_by(weight: Array, q: Array, slope: Array, excess: Array | None) -> tuple[Array, Array]:
    """F_N and F_x of the forces q of the elements, db/dX at each of them being `slope`.

    `excess` is what q is in proportion to where it is positive, if the contact ends between two elements (`carried`).
    """
    normal, drag = total(weight, q), total(weight, q * slope)
    if excess is None:
        return normal, drag
    edge, _ = _edges(excess)
    a, b = jnp.abs(excess[:-1]), jnp.abs(excess[1:])
    there = (a * slope[1:] + b * slope[:-1]) / jnp.where(a + b > 0, a + b, 1.0)
    top = jnp.max(excess)  # q is S times what is positive of it
    stiffness = weight * jnp.max(q) / jnp.where(top > 0, top, 1.0)
    return normal + stiffness * jnp.sum(edge), drag + stiffness * jnp.sum(edge * there)


@functools.partial(jax.custom_jvp, nondiff_argnums=(5,))
def settle(level: Array, slope: Array, spring: Any, force: Array, guess: Array, between: bool = False) -> Array:
    """The depth d at which spring d + sum slope max(0, d - level) = force, exactly, by Newton's method from above.

    `slope` is W S, scalar or (n,). With `between` the sum is that of `carried`. Without a spring the force must not be
    negative; for no force d is where the first element is touched.
    """
    lowest = jnp.min(level)

    def again(state):
        depth, stiffness, before, last, tries = state
        changes = (depth < last) | (tries < 2) if between else stiffness != before
        return changes & (tries < 200)

    def improve(state):
        # From above the elements in contact only become fewer: as stiff as before is the same ones.
        depth, before, _, _, tries = state
        found, stiffness = (
            _corrected(level, lowest, slope, spring, force, depth)
            if between
            else _newton(level, lowest, slope, spring, force, level < depth)
        )
        return found, stiffness, before, depth, tries + 1

    return jax.lax.while_loop(again, improve, (guess, -1.0, -2.0, jnp.inf, 0))[0]


@settle.defjvp
def _(between: bool, given: tuple, tangents: tuple) -> tuple[Array, Array]:
    """The elements in contact stay the same ones."""
    depth = settle(*given, between)

    def moved(level: Array, slope: Array, spring: Any, force: Array) -> Array:
        if between:
            return _corrected(level, jnp.min(level), slope, spring, force, depth)[0]
        return _newton(level, jnp.min(level), slope, spring, force, given[0] < depth)[0]

    return depth, jax.jvp(moved, given[:4], tangents[:4])[1]


def _corrected(
    level: Array, lowest: Array, slope: Array, spring: Any, force: Array, depth: Array
) -> tuple[Array, Array]:
    """The depth after one step of Newton's from `depth`, and the stiffness there."""
    now, stiffness = carried(slope, depth - level)
    stiffness = jax.lax.stop_gradient(spring + stiffness)
    empty = stiffness <= 0
    step = (force - spring * depth - now) / jnp.where(empty, 1.0, stiffness)
    return jnp.where(empty, lowest + force / slope, depth + step), stiffness


def _newton(level: Array, lowest: Array, slope: Array, spring: Any, force: Array, active: Array) -> tuple[Array, Array]:
    """The depth at which those that are `active` carry the force, and their stiffness."""
    stiffness = spring + total(slope, jnp.where(active, 1.0, 0.0))
    # Without a spring one element at least carries the load. (The place of the least level takes long to find.)
    alone = slope if slope.ndim == 0 else jnp.max(jnp.where(level == lowest, slope, 0.0))
    empty = stiffness <= 0
    load = force + jnp.where(empty, alone * lowest, total(slope, jnp.where(active, level, 0.0)))
    return load / jnp.where(empty, alone, stiffness), stiffness


def kept(holds: Array, function: Callable[..., Any], *args: Any) -> Any:
    """`function(*args)` behind a condition that always holds, so that the compiler computes it once.

    Otherwise it would put sums over the branches, and what each branch needs, into every place that uses them.
    """

    def nothing(*args: Any) -> Any:
        return jax.tree.map(lambda x: jnp.zeros(x.shape, x.dtype), jax.eval_shape(function, *args))

    return jax.lax.cond(holds, function, nothing, *args)


def press(c: Coefficients, line: Line, fading: Fading, rise: Array, depth: Array) -> tuple[Line, Array]:
    """The line after a step at whose end the body stands at `depth`, and the work done on each element [Pa m^2]."""
    zero = jnp.zeros_like(line.u)
    w = depth + rise
    # The integrals of `advance` count from zero in each step and are summed at once: an element carries few numbers.
    velocity = zero if line.velocity is None else line.velocity
    before = Elements(line.u, line.f, line.q, velocity, zero, zero, zero, line.stored, zero)
    after = advance(c, before, line.w, w, fading, functools.partial(kept, c.h[0] >= 0))
    work = after.inelastic + 0.5 * c.equilibrium * (after.u**2 - line.u**2)
    velocity = None if line.velocity is None else after.velocity
    return Line(after.u, after.f, after.q, velocity, after.stored, w), work


def energy(law: Relaxation, line: Line, weight: Array) -> Array:
    """Energy stored in the springs of all elements [J]."""
    return total(weight, 0.5 * law.equilibrium * line.u**2 + line.stored)


def total(weight: Array, part: Float[Array, " n"]) -> Array:
    """The sum over all elements."""
    return weight * jnp.sum(part) if weight.ndim == 0 else jnp.sum(weight * part)


@functools.partial(jax.jit, static_argnames=("control", "viscous"))
def march(
    law: Relaxation, surface: AbstractOverLine, steps: Steps, *, control: Control, viscous: bool = True
) -> tuple[Forces, Line]:
    """All steps from an untouched line: the forces at the end of each, the work up to it, and the line at the end.

    `viscous=False` saves some work for a law whose viscosity is known to be zero.
    """
    weight, between = jnp.asarray(surface.weight), surface.between

    def felt(line: Line, slope: Array, done: Array, depth: Array, excess: Array | None) -> tuple[Forces, Array]:
        """The forces, and the depth once more: what needs that one comes after all that has been read here."""
        normal, drag = felt_by(weight, line.q, slope, excess)
        return Forces(depth, normal, drag, total(weight, done), energy(law, line, weight)), depth

    def step(state: Any, now: Steps) -> tuple[Any, Forces]:
        line, last, guess, before = state  # forces at the end of the last step, a guess for this depth, and X
        c = coefficients(law, now.h, viscous=viscous)
        rise, slope = surface.rise_and_slope(now.position)
        if viscous:
            _, slope = surface.rise_and_slope(now.position - lag(c) * (now.position - before))
        fading = kept(now.h >= 0, functools.partial(fade, c), line.f)
        level = free(c, line, fading) - rise
        if control == "load":
            depth = settle(level, weight * c.stiffness[0], 0.0, now.value, guess, between)
        else:
            depth = now.value
        line, done = press(c, line, fading, rise, depth)
        excess = depth - level if between else None
        # Sums of what is being computed take far longer than sums of what is there, and a line that something still
        # reads is copied before the next one is put in its place: hence `kept`, and w last.
        seen, depth = kept(now.h >= 0, felt, line._replace(f=None, w=None, velocity=None), slope, done, depth, excess)
        return (line._replace(w=depth + rise), seen, 2 * depth - last.depth, now.position), seen

    @jax.checkpoint
    def block(state: Any, part: Steps) -> tuple[Any, Forces]:
        def nothing(state: Any, part: Steps) -> tuple[Any, Forces]:
            return state, Forces(*(jnp.full(_BLOCK, field) for field in state[1]._replace(work=0.0)))

        going = functools.partial(jax.lax.scan, step)
        return jax.lax.cond(part.h[0] > 0, going, nothing, state, part)

    zero = jnp.zeros(())
    start = (untouched(law, surface, steps.position[0], viscous=viscous), Forces(*[zero] * 5), zero, steps.position[0])
    blocks = jax.tree.map(lambda x: x.reshape(-1, _BLOCK), steps)
    end, forces = jax.lax.scan(block, start, blocks)
    forces = jax.tree.map(jnp.ravel, forces)
    return forces._replace(work=jnp.cumsum(forces.work)), end[0]


def padded(steps: Steps, most: int) -> Steps:
    """The steps with room for `most` of them, rounded up to a number that few histories differ in.

    The last block is filled up with steps at rest; those of further blocks have no length and are not made.
    """
    count = steps.h.shape[0]
    whole, blocks = (max(1, math.ceil(n / _BLOCK)) for n in (count, max(count, most)))
    grain = 2 ** max(0, math.floor(math.log2(blocks)) - 2)
    missing = _BLOCK * grain * math.ceil(blocks / grain) - count
    xp = jnp if is_traced(steps) else np
    long = Steps(*(xp.concatenate([xp.asarray(x), xp.repeat(xp.asarray(x)[-1:], missing)]) for x in steps))
    return long._replace(h=xp.where(np.arange(count + missing) < _BLOCK * whole, long.h, 0.0))
