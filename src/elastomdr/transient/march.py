"""One march in time, and the depth at which elements carry a load.

A motion is marched wherever no closed form answers its history: sliding and driven
bodies, tangential loading, a load that falls, oblique impact. Each has a step of its own
over the exact contact step (`element.contact_step`); the loop, and what is kept of it,
are those of `march`.

With u_free the displacement at which an element needs no force at the end of the step
and S its stiffness, both known before the depth is, and with g the distance of the body
from the element at the depth 0,

    F_N(d) = sum W S max(0, d - l),    l = u_free + g,

convex, piecewise linear and rising: Newton's method from above (`settle`) ends after a
few steps, exactly.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import entries, on_numpy, stop_gradient, tree_map, while_loop, xp
from ..checks import Array, is_traced
from ..progress_bar import counted

if TYPE_CHECKING:
    from jaxtyping import Float

# steps whose coefficients are computed at once, and between two states that are kept
# for reverse mode
_BLOCK = 64
# elements times branches times steps of a piece of compiled march: about half a second;
# the rest of an element takes as long as so many branches
_PIECE, OF_AN_ELEMENT = 2e7, 5


def march(
    step: Callable[[Any, Any], tuple[Any, Any]],
    look: Callable[[Any, Any], Any],
    start: Any,
    steps: Any,
    is_seen: Array | None,
    prepare: Callable[[Any], Any],
) -> tuple[Any, Any]:
    """The state after all steps, and what is seen at the end of each.

    `steps` is a named tuple of arrays, one entry a step; `prepare` adds to a block of
    them what its steps need, such as their coefficients. `step(state, now)` gives the
    state at the end of a step and what `look(state, details)` needs besides. Where
    steps are marked by `is_seen`, NumPy leaves the others out, and compiled code leaves
    zeros there. A block whose first step has no length `h` is not made.
    """
    march_blocks = _on_numpy if on_numpy() else _on_jax
    return march_blocks(step, look, start, steps, is_seen, prepare)


def _on_numpy(
    step: Callable[[Any, Any], tuple[Any, Any]],
    look: Callable[[Any, Any], Any],
    state: Any,
    steps: Any,
    is_seen: Array | None,
    prepare: Callable[[Any], Any],
) -> tuple[Any, Any]:
    seen = []
    for first in range(0, steps.h.shape[0], _BLOCK):
        block = tree_map(lambda x, i=first: x[i : i + _BLOCK], steps)
        for number, now in enumerate(entries(prepare(block)), first):
            state, details = step(state, now)
            if is_seen is None or is_seen[number]:
                seen.append(look(state, details))
    return state, tree_map(lambda *x: np.stack(x), *seen) if seen else None


def in_pieces(
    piece: Callable[[Any, Any, Any], tuple[Any, Any]],
    state: Any,
    steps: Any,
    instants: Array | None,
    size: int,
    doing: str,
) -> tuple[Any, Any]:
    """A `march` by `piece(state, steps, is_seen)`, the compiled march of some steps,
    and what is seen at the end of those at `instants`, which ascend, or of all.

    Between two pieces it is counted under `doing`, and can be interrupted, which
    compiled code cannot be. `size` is the work of a step: elements times branches.
    Under a transformation of JAX there is one piece, and so one derivative.
    """
    count = steps.h.shape[0]
    is_seen = np.full(count, instants is None)
    is_seen[slice(None) if instants is None else instants] = True
    if is_traced(state, steps) or not count:
        state, looked = piece(state, steps, is_seen)
        return state, tree_map(lambda x: x[is_seen], looked)
    length, numpy = _BLOCK, on_numpy()
    if not numpy:  # few lengths, since each is a program of its own
        blocks = max(1.0, _PIECE / (size * _BLOCK))
        length = _BLOCK * 2 ** math.floor(math.log2(blocks))
        steps = padded(steps, length)
    seen = []
    with counted(doing, count) as count_steps:
        for i in range(0, count, length):
            cut = tree_map(lambda x, i=i: x[i : i + length], steps)
            here = np.zeros(cut.h.shape, bool)
            here[: count - i] = is_seen[i : i + length]
            state, looked = piece(state, cut, here)
            if not numpy:
                looked = tree_map(lambda x, here=here: np.asarray(x)[here], looked)
            seen.append(looked)
            count_steps(min(length, count - i))
    return state, tree_map(
        lambda *x: np.concatenate(x), *(each for each in seen if each is not None)
    )


def _on_jax(
    step: Callable[[Any, Any], tuple[Any, Any]],
    look: Callable[[Any, Any], Any],
    state: Any,
    steps: Any,
    is_seen: Array | None,
    prepare: Callable[[Any], Any],
) -> tuple[Any, Any]:
    """The same as one `diffrax.diffeqsolve`, a block of steps a step of its solver."""
    import jax

    from ..element.contact_step_solver import in_blocks

    count = steps.h.shape[0]
    steps = padded(steps)
    filled = steps.h.shape[0]
    # which the compiler does not know to be always true
    marks = steps.h >= 0
    if is_seen is not None:
        marks = xp.append(is_seen, xp.zeros(filled - count, bool))

    def one(state: Any, now: Any) -> tuple[Any, Any]:
        state, details = step(state, now[0])
        return state, if_so(now[1], look, state, details)

    @jax.checkpoint
    def block(state: Any, steps_and_seen: tuple[Any, Array]) -> tuple[Any, Any]:
        steps, is_seen = steps_and_seen
        # what the last block is filled up with goes on with its steps
        steps = steps._replace(h=xp.where(steps.h > 0, steps.h, steps.h[0]))
        return jax.lax.scan(one, state, (prepare(steps), is_seen))

    blocks = jax.tree.map(
        lambda x: xp.reshape(x, (-1, _BLOCK, *x.shape[1:])), (steps, marks)
    )

    def left_out(state: Any, *part: Any) -> tuple[Any, Any]:
        return state, _zeros(lambda *x: block(*x)[1], state, *part)

    def made(state: Any, part: tuple[Any, Array]) -> tuple[Any, Any]:
        return jax.lax.cond(part[0].h[0] > 0, block, left_out, state, part)

    state, seen = in_blocks(made, state, blocks)
    return state, jax.tree.map(lambda x: x.reshape(filled, *x.shape[2:])[:count], seen)


def padded(steps: Any, piece: int = 0) -> Any:
    """The steps in whole pieces, or in a number of blocks that few histories differ in.

    What is filled up has no length; blocks of it are not made.
    """
    count = steps.h.shape[0]
    blocks = math.ceil(max(count, 1) / _BLOCK)
    grain = piece // _BLOCK or 2 ** max(0, math.floor(math.log2(blocks)) - 2)
    missing = _BLOCK * grain * math.ceil(blocks / grain) - count
    numpy = xp if is_traced(steps) else np
    long = tree_map(
        lambda x: numpy.concatenate(
            [numpy.asarray(x), numpy.repeat(numpy.asarray(x)[-1:], missing, axis=0)]
        ),
        steps,
    )
    return long._replace(h=numpy.where(np.arange(count + missing) < count, long.h, 0.0))


def if_so(condition: Array, function: Callable[..., Any], *args: Any) -> Any:
    """`function(*args)`, or zeros in its place, as a branch of the compiled program.

    With a condition that always holds, the compiler computes it once. Otherwise it
    would put sums over the branches, and what each branch needs, into every place that
    uses them.
    """
    if on_numpy():
        return function(*args)
    import jax

    return jax.lax.cond(condition, function, functools.partial(_zeros, function), *args)


def _zeros(function: Callable[..., Any], *args: Any) -> Any:
    import jax

    return jax.tree.map(
        lambda x: xp.zeros(x.shape, x.dtype), jax.eval_shape(function, *args)
    )


def settle(
    touch_depth: Array,
    slope: Array,
    spring: Any,
    force: Array,
    guess: Array,
    between: bool = False,
) -> Array:
    """The depth d at which spring d + sum slope max(0, d - touch_depth) = force,
    exactly, by Newton's method from above.

    `touch_depth` is the depth of the body at which it touches each element.

    `slope` is W S, scalar or (n,). With `between` the sum is that of `force_on_line`.
    Without a spring the force must not be negative; for no force d is where the first
    element is touched.
    """
    return (_settle if on_numpy() else _traced_settle())(
        touch_depth, slope, spring, force, guess, between
    )


def _settle(
    touch_depth: Array,
    slope: Array,
    spring: Array | float,
    force: Array,
    guess: Array,
    between: bool,
) -> Array:
    lowest = xp.min(touch_depth)

    def again(state):
        depth, stiffness, before, last, tries = state
        changes = (depth < last) | (tries < 2) if between else stiffness != before
        return changes & (tries < 200)

    def improve(state):
        # From above the elements in contact only become fewer: as stiff as before is
        # the same ones.
        depth, before, _, _, tries = state
        improved, stiffness = (
            _corrected(touch_depth, lowest, slope, spring, force, depth)
            if between
            else _newton(touch_depth, lowest, slope, spring, force, touch_depth < depth)
        )
        return improved, stiffness, before, depth, tries + 1

    return while_loop(again, improve, (guess, -1.0, -2.0, xp.inf, 0))[0]


@functools.cache
def _traced_settle() -> Any:
    """`_settle` with its derivative, for which the elements in contact stay the same
    ones.
    """
    import jax

    settle = functools.partial(jax.custom_jvp, nondiff_argnums=(5,))(_settle)

    @settle.defjvp
    def derivative(between: bool, given: tuple, tangents: tuple) -> tuple[Array, Array]:
        depth = settle(*given, between)

        def moved(
            touch_depth: Array, slope: Array, spring: Array | float, force: Array
        ) -> Array:
            if between:
                return _corrected(
                    touch_depth, xp.min(touch_depth), slope, spring, force, depth
                )[0]
            return _newton(
                touch_depth, xp.min(touch_depth), slope, spring, force, given[0] < depth
            )[0]

        return depth, jax.jvp(moved, given[:4], tangents[:4])[1]

    return settle


def _corrected(
    touch_depth: Array,
    lowest: Array,
    slope: Array,
    spring: Array | float,
    force: Array,
    depth: Array,
) -> tuple[Array, Array]:
    """The depth after one step of Newton's from `depth`, and the stiffness there."""
    now, stiffness = force_on_line(slope, depth - touch_depth)
    stiffness = stop_gradient(spring + stiffness)
    empty = stiffness <= 0
    step = (force - spring * depth - now) / xp.where(empty, 1.0, stiffness)
    alone = slope if slope.ndim == 0 else xp.max(slope)
    return xp.where(empty, lowest + force / alone, depth + step), stiffness


def _newton(
    touch_depth: Array,
    lowest: Array,
    slope: Array,
    spring: Array | float,
    force: Array,
    active: Array,
) -> tuple[Array, Array]:
    """The depth at which those that are `active` carry the force, and their
    stiffness.
    """
    stiffness = spring + total(slope, xp.where(active, 1.0, 0.0))
    # Without a spring one element at least carries the load. (The place of the least
    # level takes long to find.)
    alone = (
        slope
        if slope.ndim == 0
        else xp.max(xp.where(touch_depth == lowest, slope, 0.0))
    )
    empty = stiffness <= 0
    load = force + xp.where(
        empty, alone * lowest, total(slope, xp.where(active, touch_depth, 0.0))
    )
    return load / xp.where(empty, alone, stiffness), stiffness


def force_on_line(slope: Array, excess: Float[Array, " n"]) -> tuple[Array, Array]:
    """The force where a contact ends between two elements, and how much it grows as all
    of `excess` grows by one.

    It is the integral of the positive part of the line drawn through the elements,
    which are neighbours at equal distances. sum slope max(0, excess) errs by the square
    of their distance as well, but with a factor that depends on where the contact ends,
    so that the limit of ever more elements could not be extrapolated from a few.
    """
    edge, rate = edges(excess)
    inside = excess > 0
    between = inner(slope)
    force = total(slope, xp.where(inside, excess, 0.0)) + total(between, edge)
    return force, total(slope, xp.where(inside, 1.0, 0.0)) + total(between, rate)


def inner(weight: Array) -> Array:
    """The weight of what lies between two elements: of the one nearer to the axis."""
    return weight if weight.ndim == 0 else weight[:-1]


def edges(
    excess: Float[Array, " n"],
) -> tuple[Float[Array, " n-1"], Float[Array, " n-1"]]:
    """What the positive part of a line from a to b, a b < 0, has less than the mean of
    max(0, a) and max(0, b).
    """
    a, b = excess[:-1], excess[1:]
    between = a * b < 0
    span = xp.where(between, 2 * xp.abs(a - b), 1.0)
    return xp.where(between, a * b / span, 0.0), xp.where(between, (a + b) / span, 0.0)


def total(weight: Array, values: Float[Array, " n"]) -> Array:
    """The sum over all elements."""
    return weight * xp.sum(values) if weight.ndim == 0 else xp.sum(weight * values)
