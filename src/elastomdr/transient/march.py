"""One march in time, and that of a body over elements.

A motion is marched wherever no closed form answers its history: sliding and driven
bodies, tangential loading, a load that falls, oblique impact. Each has a step of its own
over the exact contact step (`element.contact_step`); the loop, and what is kept of it,
are those of `march`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ..arrays import compiled, entries, on_numpy, tree_map, xp
from ..checks import Array, is_traced
from ..element.body_over_line import edges, felt_by, inner, total
from ..element.contact_step import (
    Coefficients,
    coefficients_of_steps,
    if_so,
    zeros_of,
)
from ..element.moving_body import (
    BodyMotion,
    LineMemory,
    MotionScene,
    Steps,
    advance_body,
    put_down,
    untouched,
)
from ..progress_bar import counted
from ..smooth.passage import Control

S = TypeVar("S")  # a state
Felt = TypeVar("Felt")  # what is needed besides to look at one
Seen = TypeVar("Seen")

# steps whose coefficients are computed at once, and between two states that are kept
# for reverse mode
_BLOCK = 64
# elements times branches times steps of a piece of compiled march: about half a second;
# the rest of an element takes as long as so many branches
_PIECE, OF_AN_ELEMENT = 2e7, 5


def march(
    step: Callable[[S, Any], tuple[S, Felt]],
    look: Callable[[S, Felt], Seen],
    start: S,
    steps: Any,
    is_seen: Array | None,
    prepare: Callable[[Any], Any],
) -> tuple[S, Seen]:
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
    step: Callable[[S, Any], tuple[S, Felt]],
    look: Callable[[S, Felt], Seen],
    state: S,
    steps: Any,
    is_seen: Array | None,
    prepare: Callable[[Any], Any],
) -> tuple[S, Any]:
    seen = []
    for first in range(0, steps.h.shape[0], _BLOCK):
        block = tree_map(lambda x, i=first: x[i : i + _BLOCK], steps)
        for number, now in enumerate(entries(prepare(block)), first):
            state, details = step(state, now)
            if is_seen is None or is_seen[number]:
                seen.append(look(state, details))
    return state, tree_map(lambda *x: np.stack(x), *seen) if seen else None


def in_pieces(
    piece: Callable[[S, Any, Any], tuple[S, Any]],
    state: S,
    steps: Any,
    instants: Array | None,
    size: int,
    doing: str,
) -> tuple[S, Any]:
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
    step: Callable[[S, Any], tuple[S, Felt]],
    look: Callable[[S, Felt], Seen],
    state: S,
    steps: Any,
    is_seen: Array | None,
    prepare: Callable[[Any], Any],
) -> tuple[S, Any]:
    """The same, compiled; reverse mode keeps the state before each block of steps."""
    import jax

    count = steps.h.shape[0]
    steps = padded(steps)
    filled = steps.h.shape[0]
    # which the compiler does not know to be always true
    marks = steps.h >= 0
    if is_seen is not None:
        marks = xp.append(is_seen, xp.zeros(filled - count, bool))

    def one(state: S, now: tuple[Any, Array]) -> tuple[S, Any]:
        state, details = step(state, now[0])
        return state, if_so(now[1], look, state, details)

    @jax.checkpoint
    def block(state: S, steps_and_seen: tuple[Any, Array]) -> tuple[S, Any]:
        steps, is_seen = steps_and_seen
        # what the last block is filled up with goes on with its steps
        steps = steps._replace(h=xp.where(steps.h > 0, steps.h, steps.h[0]))
        return jax.lax.scan(one, state, (prepare(steps), is_seen))

    blocks = jax.tree.map(
        lambda x: xp.reshape(x, (-1, _BLOCK, *x.shape[1:])), (steps, marks)
    )

    def left_out(state: S, *part: object) -> tuple[S, Any]:
        return state, zeros_of(lambda *x: block(*x)[1], state, *part)

    def made(state: S, part: tuple[Any, Array]) -> tuple[S, Any]:
        return jax.lax.cond(part[0].h[0] > 0, block, left_out, state, part)

    state, seen = jax.lax.scan(made, state, blocks)
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


class MotionHistory(NamedTuple):
    """What a motion leaves behind at each instant."""

    depth: Array  # d [m]
    normal: Array  # F_N [N]
    drag: Array  # F_x [N]
    work: Array
    stored: Array  # in the elements [J]
    position: Array
    velocity: Array
    driven: Array
    pressed: Array
    damped: Array
    contact: Array  # its length, where it ends between two elements [m]
    locked: Array  # of `stored`, in elements out of contact [J]
    kinetic: Array  # [J]
    spring: Array  # in the springs of the mounts [J]


def run(
    scene: MotionScene,
    steps: Steps,
    instants: np.ndarray | None = None,
    *,
    control: Control = "load",
    viscous: bool = True,
    balance: bool = True,
    doing: str = "motion",
) -> tuple[MotionHistory, LineMemory]:
    """The whole motion: what is known at the ends of the steps `instants`, or of all,
    and the line at the end. In the first step, always kept, the body is put down at
    once, at rest, on rubber that was never touched.

    `viscous=False` saves some work for a law whose viscosity is known to be zero,
    `balance=False` for motions whose energy balance nobody asks for; `doing` says what
    is counted (`in_pieces`).
    """

    def piece(
        state: BodyMotion, cut: Steps, is_seen: np.ndarray | None
    ) -> tuple[BodyMotion, MotionHistory]:
        return _piece(
            scene,
            state,
            cut,
            is_seen,
            control=control,
            viscous=viscous,
            balance=balance,
        )

    size = scene.surface.count * (scene.law.moduli.shape[0] + OF_AN_ELEMENT)
    begin, others = (tree_map(lambda x, i=i: x[i], steps) for i in (0, slice(1, None)))
    start, first = _begin(scene, begin, viscous=viscous, balance=balance)
    if not balance:
        end, seen = in_pieces(piece, start, steps, instants, size, doing)
        return seen, end.line
    later = None if instants is None else instants[1:] - 1
    end, seen = in_pieces(piece, start, others, later, size, doing)
    return tree_map(lambda a, b: xp.concatenate([a[None], b]), first, seen), end.line


@compiled("control", "viscous", "balance")
def _piece(
    scene: MotionScene,
    state: BodyMotion,
    steps: Steps,
    is_seen: np.ndarray | None,
    *,
    control: Control,
    viscous: bool,
    balance: bool,
) -> tuple[BodyMotion, MotionHistory]:
    """Some steps of the motion."""

    def prepare(block: Steps) -> tuple[Steps, Coefficients]:
        return block, coefficients_of_steps(scene.law, block.h, viscous=viscous)

    def step(y: BodyMotion, now: tuple[Steps, Coefficients]) -> tuple[BodyMotion, Any]:
        end, c = now
        # sums over both are made once
        c = c if viscous else c._replace(seen=c.decay)
        return advance_body(scene, c, y, end, control, viscous, balance)

    def look(y: BodyMotion, felt: tuple[Array, Array | None]) -> MotionHistory:
        return _history(scene, y, *felt)

    return march(step, look, state, steps, is_seen, prepare)


@compiled("viscous", "balance")
def _begin(
    scene: MotionScene, begin: Steps, *, viscous: bool, balance: bool
) -> tuple[BodyMotion, MotionHistory | None]:
    """The body before its first step, or with `balance` after it, and what is seen
    then.
    """
    y = untouched(scene, begin.position, viscous)
    if not balance:
        return y, None
    y, felt = put_down(scene, y, begin, viscous)
    return y, _history(scene, y, *felt)


def _history(
    scene: MotionScene, y: BodyMotion, slope: Array, excess: Array | None
) -> MotionHistory:
    """What is known at an instant."""
    weight, line = scene.surface.weight, y.line
    normal, drag = felt_by(weight, line.q, slope, excess)
    kinetic = spring = contact = xp.zeros(())
    held = 0.5 * scene.law.equilibrium * line.u**2 + line.stored
    locked = total(weight, xp.where(line.q > 0, 0.0, held))
    if excess is not None:
        _, beyond = edges(excess)
        inside = xp.sum(excess > 0) + xp.sum(beyond) - scene.surface.first
        contact = scene.surface.spacing * inside
        part = 0.5 * beyond * (held[:-1] + held[1:])
        locked = locked - total(inner(weight), part)
    if scene.tangential is not None:
        kinetic = scene.tangential.mass * y.velocity**2 / 2
        spring = scene.tangential.stiffness * (y.drive - y.position) ** 2 / 2
    if scene.normal is not None:
        kinetic = kinetic + scene.normal.mass * y.sinking**2 / 2
        spring = spring + scene.normal.stiffness * y.depth**2 / 2
    return MotionHistory(
        depth=y.depth,
        normal=normal,
        drag=drag,
        work=y.work,
        stored=total(weight, held),
        position=y.position,
        velocity=y.velocity,
        driven=y.driven,
        pressed=y.pressed,
        damped=y.damped,
        contact=contact,
        locked=locked,
        kinetic=kinetic,
        spring=spring,
    )
