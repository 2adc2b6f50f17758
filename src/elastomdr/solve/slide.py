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
from jaxtyping import Float

from .._runtime import Array
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
    velocity: Float[Array, " n"]  # [m/s]
    stored: Float[Array, " n"]  # in the branches [Pa m^2]
    w: Float[Array, " n"]  # where the rigid surface is [m]


class Forces(NamedTuple):
    """What the body feels, and what became of its work, at the end of each step."""

    depth: Array  # d [m]
    normal: Array  # F_N [N]
    drag: Array  # F_x [N]
    work: Array  # done on the elements since the start [J]
    stored: Array  # in the elements [J]


def untouched(law: Relaxation, surface: AbstractOverLine, position: Array) -> Line:
    """A line at rest, the body just above it."""
    rise = surface.rise(position)
    zero = jnp.zeros_like(rise)
    return Line(zero, jnp.zeros((law.moduli.shape[0], zero.size)), zero, zero, zero, rise - jnp.max(rise))


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


def settle(level: Array, slope: Array, spring: Any, force: Array, guess: Array) -> Array:
    """The depth d at which spring d + sum slope max(0, d - level) = force, exactly, by Newton's method from above.

    `slope` is W S, scalar or (n,). Without a spring the force must not be negative; for no force d is where the first
    element is touched.
    """
    lowest = jnp.min(level)
    given = level, lowest, slope, spring, force
    fixed = jax.lax.stop_gradient(given)
    fixed_level = fixed[0]

    def newton(level, lowest, slope, spring, force, active):
        """The next depth, and the stiffness of what is `active`."""
        stiffness = spring + jnp.sum(jnp.where(active, slope, 0.0))
        # Without a spring one element at least carries the load. (The place of the least level takes long to find.)
        alone = slope if slope.ndim == 0 else jnp.max(jnp.where(level == lowest, slope, 0.0))
        nobody = stiffness <= 0
        load = force + jnp.where(nobody, alone * lowest, jnp.sum(jnp.where(active, slope * level, 0.0)))
        return load / jnp.where(nobody, alone, stiffness), stiffness

    def again(state):
        _, stiffness, before, tries = state
        return (stiffness != before) & (tries < 200)

    def improve(state):
        # From above the elements in contact only become fewer: as stiff as before is the same ones.
        depth, before, _, tries = state
        return *newton(*fixed, fixed_level < depth), before, tries + 1

    guess = jax.lax.stop_gradient(guess)
    depth = jax.lax.while_loop(again, improve, (guess, -1.0, -2.0, 0))[0]
    return newton(*given, fixed_level < depth)[0]


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
    before = Elements(line.u, line.f, line.q, line.velocity, zero, zero, zero, line.stored, zero)
    after = advance(c, before, line.w, w, fading, functools.partial(kept, c.h[0] >= 0))
    work = after.inelastic + 0.5 * c.equilibrium * (after.u**2 - line.u**2)
    return Line(after.u, after.f, after.q, after.velocity, after.stored, w), work


def energy(law: Relaxation, line: Line, weight: Array) -> Array:
    """Energy stored in the springs of all elements [J]."""
    return jnp.sum(weight * (0.5 * law.equilibrium * line.u**2 + line.stored))


@functools.partial(jax.jit, static_argnames=("control", "viscous"))
def march(
    law: Relaxation, surface: AbstractOverLine, steps: Steps, *, control: Control, viscous: bool = True
) -> tuple[Forces, Line]:
    """All steps from an untouched line: the forces at the end of each, and the line at the end.

    `viscous=False` saves some work for a law whose viscosity is known to be zero.
    """
    weight = jnp.asarray(surface.weight)

    def felt(state: Any) -> Forces:
        line, slope, work, depth, _ = state
        normal, drag = jnp.sum(weight * line.q), jnp.sum(weight * line.q * slope)
        return Forces(depth, normal, drag, jnp.sum(weight * work), energy(law, line, weight))

    def step(state: Any, now: Steps) -> tuple[Any, Forces]:
        line, _, work, depth, before = state
        c = coefficients(law, now.h, viscous=viscous)
        rise, slope = surface.rise_and_slope(now.position)
        if viscous:
            _, slope = surface.rise_and_slope(now.position - lag(c) * (now.position - before))
        fading = kept(now.h >= 0, fade, c, line.f)
        if control == "load":
            depth = settle(free(c, line, fading) - rise, weight * c.stiffness[0], 0.0, now.value, depth)
        else:
            depth = now.value
        line, done = press(c, line, fading, rise, depth)
        # Sums of the step before: compiled sums over what is being computed take far longer than over what is kept.
        return (line, slope, work + done, depth, now.position), felt(state)

    @jax.checkpoint
    def block(state: Any, part: Steps) -> tuple[Any, Forces]:
        def nothing(state: Any, part: Steps) -> tuple[Any, Forces]:
            return state, Forces(*(jnp.full(_BLOCK, field) for field in felt(state)))

        going = functools.partial(jax.lax.scan, step)
        return jax.lax.cond(part.h[0] > 0, going, nothing, state, part)

    zero, line = jnp.zeros(()), untouched(law, surface, steps.position[0])
    start = (line, 0 * line.u, 0 * line.u, zero, steps.position[0])
    blocks = jax.tree.map(lambda x: x.reshape(-1, _BLOCK), steps)
    end, before = jax.lax.scan(block, start, blocks)
    forces = jax.tree.map(lambda x, last: jnp.append(x.reshape(-1)[1:], last), before, felt(end))
    return forces, end[0]


def padded(steps: Steps, most: int) -> Steps:
    """The steps with room for `most` of them, rounded up to a number that few histories differ in.

    The last block is filled up with steps at rest; those of further blocks have no length and are not made.
    """
    count = steps.h.shape[0]
    whole, blocks = (max(1, math.ceil(n / _BLOCK)) for n in (count, max(count, most)))
    grain = 2 ** max(0, math.floor(math.log2(blocks)) - 2)
    missing = _BLOCK * grain * math.ceil(blocks / grain) - count
    long = Steps(*(jnp.concatenate([jnp.asarray(x), jnp.repeat(jnp.asarray(x)[-1:], missing)]) for x in steps))
    return long._replace(h=jnp.where(jnp.arange(count + missing) < _BLOCK * whole, long.h, 0.0))
