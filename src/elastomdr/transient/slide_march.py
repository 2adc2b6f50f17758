"""Marching a line of elements under a moving body: the exact contact step, all elements
at once, and the depth.

At a given load the depth of the body follows from the step itself
(`transient.depth_from_load`).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import compiled, in_steps, on_numpy, xp
from ..checks import Array, is_traced
from ..element.contact_step import (
    Coefficients,
    Elements,
    Fading,
    advance,
    coefficients,
    fade,
    lag,
    released,
)
from ..material.relaxation import Relaxation
from ..smooth.passage import Control
from .body_over_line import AbstractOverLine
from .depth_from_load import edges, settle, total
from .timeline import Steps

if TYPE_CHECKING:
    from jaxtyping import Float

_BLOCK = 64  # steps between two states that are kept for reverse mode


class Line(NamedTuple):
    """What n elements remember from one step to the next; see
    `element.contact_step.Elements`.
    """

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


def untouched(
    law: Relaxation, surface: AbstractOverLine, position: Array, *, viscous: bool = True
) -> Line:
    """A line at rest, the body just above it."""
    rise = surface.rise(position)
    zero, f = xp.zeros_like(rise), xp.zeros((law.moduli.shape[0], rise.size))
    return Line(zero, f, zero, zero if viscous else None, zero, rise - xp.max(rise))


def felt_by(
    weight: Array, q: Array, slope: Array, excess: Array | None
) -> tuple[Array, Array]:
    """F_N and F_x of the forces q of the elements, db/dX at each of them being `slope`.

    `excess` is what q is in proportion to where it is positive, if the contact ends
    between two elements (`carried`).
    """
    normal, drag = total(weight, q), total(weight, q * slope)
    if excess is None:
        return normal, drag
    edge, _ = edges(excess)
    a, b = xp.abs(excess[:-1]), xp.abs(excess[1:])
    there = (a * slope[1:] + b * slope[:-1]) / xp.where(a + b > 0, a + b, 1.0)
    top = xp.max(excess)  # q is S times what is positive of it
    stiffness = weight * xp.max(q) / xp.where(top > 0, top, 1.0)
    return normal + stiffness * xp.sum(edge), drag + stiffness * xp.sum(edge * there)


def kept(holds: Array, function: Callable[..., Any], *args: Any) -> Any:
    """`function(*args)` behind a condition that always holds, so that the compiler
    computes it once.

    Otherwise it would put sums over the branches, and what each branch needs, into
    every place that uses them.
    """

    if on_numpy():
        return function(*args)
    import jax

    def nothing(*args: Any) -> Any:
        return jax.tree.map(
            lambda x: xp.zeros(x.shape, x.dtype), jax.eval_shape(function, *args)
        )

    return jax.lax.cond(holds, function, nothing, *args)


def press(
    c: Coefficients, line: Line, fading: Fading, rise: Array, depth: Array
) -> tuple[Line, Array]:
    """The line after a step at whose end the body stands at `depth`, and the work done
    on each element [Pa m^2].
    """
    zero = xp.zeros_like(line.u)
    w = depth + rise
    # The integrals of `advance` count from zero in each step and are summed at once: an
    # element carries few numbers.
    velocity = zero if line.velocity is None else line.velocity
    before = Elements(
        line.u, line.f, line.q, velocity, zero, zero, zero, line.stored, zero
    )
    after = advance(c, before, line.w, w, fading, functools.partial(kept, c.h[0] >= 0))
    work = after.inelastic + 0.5 * c.equilibrium * (after.u**2 - line.u**2)
    velocity = None if line.velocity is None else after.velocity
    return Line(after.u, after.f, after.q, velocity, after.stored, w), work


def energy(law: Relaxation, line: Line, weight: Array) -> Array:
    """Energy stored in the springs of all elements [J]."""
    return total(weight, 0.5 * law.equilibrium * line.u**2 + line.stored)


@compiled("control", "viscous")
def march(
    law: Relaxation,
    surface: AbstractOverLine,
    steps: Steps,
    *,
    control: Control,
    viscous: bool = True,
) -> tuple[Forces, Line]:
    """All steps from an untouched line: the forces at the end of each, the work up to
    it, and the line at the end.

    `viscous=False` saves some work for a law whose viscosity is known to be zero.
    """
    weight, between = xp.asarray(surface.weight), surface.between

    def felt(
        line: Line, slope: Array, done: Array, depth: Array, excess: Array | None
    ) -> tuple[Forces, Array]:
        """The forces, and the depth once more: what needs that one comes after all that
        has been read here.
        """
        normal, drag = felt_by(weight, line.q, slope, excess)
        return Forces(
            depth, normal, drag, total(weight, done), energy(law, line, weight)
        ), depth

    def step(state: Any, now: Steps) -> tuple[Any, Forces]:
        # forces at the end of the last step, a guess for this depth, and X
        line, last, guess, before = state
        c = coefficients(law, now.h, viscous=viscous)
        rise, slope = surface.rise_and_slope(now.position)
        if viscous:
            _, slope = surface.rise_and_slope(
                now.position - lag(c) * (now.position - before)
            )
        fading = kept(now.h >= 0, functools.partial(fade, c), line.f)
        level = released(c, line.u, fading.seen) - rise
        if control == "load":
            depth = settle(
                level, weight * c.stiffness[0], 0.0, now.value, guess, between
            )
        else:
            depth = now.value
        line, done = press(c, line, fading, rise, depth)
        excess = depth - level if between else None
        # Sums of what is being computed take far longer than sums of what is there, and
        # a line that something still reads is copied before the next one is put in its
        # place: hence `kept`, and w last.
        seen, depth = kept(
            now.h >= 0,
            felt,
            line._replace(f=None, w=None, velocity=None),
            slope,
            done,
            depth,
            excess,
        )
        return (
            line._replace(w=depth + rise),
            seen,
            2 * depth - last.depth,
            now.position,
        ), seen

    zero = xp.zeros(())
    start = (
        untouched(law, surface, steps.position[0], viscous=viscous),
        Forces(*[zero] * 5),
        zero,
        steps.position[0],
    )
    if on_numpy():
        end, forces = in_steps(step, start, steps)
        return forces._replace(work=np.cumsum(forces.work)), end[0]
    import jax

    @jax.checkpoint
    def block(state: Any, part: Steps) -> tuple[Any, Forces]:
        def nothing(state: Any, part: Steps) -> tuple[Any, Forces]:
            return state, Forces(
                *(xp.full(_BLOCK, field) for field in state[1]._replace(work=0.0))
            )

        going = functools.partial(jax.lax.scan, step)
        return jax.lax.cond(part.h[0] > 0, going, nothing, state, part)

    blocks = jax.tree.map(lambda x: x.reshape(-1, _BLOCK), steps)
    end, forces = jax.lax.scan(block, start, blocks)
    forces = jax.tree.map(xp.ravel, forces)
    return forces._replace(work=xp.cumsum(forces.work)), end[0]


def padded(steps: Steps, most: int) -> Steps:
    """The steps with room for `most` of them, rounded up to a number that few histories
    differ in.

    The last block is filled up with steps at rest; those of further blocks have no
    length and are not made.
    """
    count = steps.h.shape[0]
    whole, blocks = (max(1, math.ceil(n / _BLOCK)) for n in (count, max(count, most)))
    grain = 2 ** max(0, math.floor(math.log2(blocks)) - 2)
    missing = _BLOCK * grain * math.ceil(blocks / grain) - count
    numpy = xp if is_traced(steps) else np
    long = Steps(
        *(
            numpy.concatenate(
                [numpy.asarray(x), numpy.repeat(numpy.asarray(x)[-1:], missing)]
            )
            for x in steps
        )
    )
    return long._replace(
        h=numpy.where(np.arange(count + missing) < _BLOCK * whole, long.h, 0.0)
    )
