"""The exact contact step as a solver of `diffrax`, which loads that.

A row of elements is no vector field: what happens to it in a step is said by the term
that `ContactStep` solves, a rigid surface or a history cut into blocks of steps.
"""

from __future__ import annotations

import abc
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import diffrax
import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, whole_number
from ..errors import InputError
from ..material.relaxation import AbstractRelaxation
from .contact_step import Elements, advance, coefficients

if TYPE_CHECKING:
    from jaxtyping import PyTree

State = TypeVar("State")
Instant = bool | int | float | jax.Array | np.ndarray


class AbstractOverElements(diffrax.AbstractTerm):
    """What happens to elements in time: a constraint, which only `ContactStep` solves.

    It is no vector field: `vf` and `contr` are there for what diffrax asks of a term.
    """

    @abc.abstractmethod
    def after(
        self, t0: Instant, t1: Instant, state: PyTree, args: PyTree, samples: int
    ) -> Any:
        """The state at t1, after so many contact steps from t0 on."""

    def vf(self, t: Instant, y: PyTree, args: PyTree) -> PyTree:
        return y

    def contr(self, t0: Instant, t1: Instant, **kwargs: PyTree) -> Any:
        return t0, t1

    def prod(self, vf: PyTree, control: PyTree) -> Any:
        raise InputError(
            f"solver must be ContactStep for a {type(self).__name__}: that is a "
            "constraint, not a vector field."
        )


class RigidSurface(AbstractOverElements):
    """Where the rigid surface is, `position(t)` [m, shape (n,)]."""

    position: Callable[[Any], Array]

    def after(
        self,
        t0: Instant,
        t1: Instant,
        state: Elements,
        args: AbstractRelaxation,
        samples: int,
    ) -> Elements:
        times = t0 + (t1 - t0) * jnp.linspace(0.0, 1.0, samples + 1)
        surface = jax.vmap(self.position)(times)

        @jax.checkpoint
        def block(law: AbstractRelaxation, start: Elements, surface: Array) -> Elements:
            c = coefficients(law, (t1 - t0) / samples)
            ends = (surface[:-1], surface[1:])
            return jax.lax.scan(
                lambda state, w: (advance(c, state, *w), None), start, ends
            )[0]

        return block(args, state, surface)


class Blocks(AbstractOverElements):
    """Histories cut into blocks of steps, `args`, one along the first axis of each
    array; time counts them.

    `block(state, steps)` gives the state after a block, and what was seen in it. The
    state of this term is both, what was seen in all blocks; see `in_blocks`.
    """

    block: Callable[[Any, Any], tuple[Any, Any]]

    def after(
        self,
        t0: Instant,
        t1: Instant,
        state: tuple[Any, Any],
        args: PyTree,
        samples: int,
    ) -> tuple[Any, Any]:
        number = jnp.round(t0).astype(int)
        end, seen = self.block(state[0], jax.tree.map(lambda x: x[number], args))
        return end, jax.tree.map(lambda all, x: all.at[number].set(x), state[1], seen)


def in_blocks(
    block: Callable[[State, Any], tuple[State, Any]], start: State, blocks: PyTree
) -> tuple[State, Any]:
    """The state after all blocks, and what was seen in each; derivatives in both modes.

    What was seen is kept in the state: the buffers of `diffrax.SaveAt` are compiled
    under the caller's types, which may be of 32 bits.
    """
    number = jax.tree.leaves(blocks)[0].shape[0]
    first = jax.tree.map(lambda x: x[0], blocks)
    seen = jax.tree.map(
        lambda x: jnp.zeros((number, *x.shape), x.dtype),
        jax.eval_shape(block, start, first)[1],
    )
    solution = diffrax.diffeqsolve(
        Blocks(block),
        ContactStep(),
        t0=0.0,
        t1=float(number),
        dt0=1.0,
        y0=(start, seen),
        args=blocks,
        max_steps=number,
        adjoint=diffrax.DirectAdjoint(),
        throw=False,  # which would be a callback, and keep no compiled code
    )
    end, looked = jax.tree.map(lambda x: x[-1], solution.ys)
    return end, looked


class ContactStep(diffrax.AbstractSolver):
    """Marches elements under a rigid surface: second order, stable for every step, no
    events.

        diffeqsolve(RigidSurface(w), ContactStep(), t0, t1, dt0, y0=rest(law, n), args=law)

    `samples` contact steps of equal length make one step of the solver, since
    `diffeqsolve` costs microseconds a step; they share their coefficients, and output
    between the solver's steps is interpolated linearly. Differentiable, in reverse mode
    with one stored state per step of the solver; `adjoint=diffrax.DirectAdjoint()`
    allows both modes.
    """

    samples: int = 1
    term_structure: ClassVar = AbstractOverElements
    interpolation_cls: ClassVar[Callable[..., diffrax.LocalLinearInterpolation]] = (
        diffrax.LocalLinearInterpolation
    )

    def __check_init__(self) -> None:
        whole_number("samples", self.samples, 1)

    def order(self, terms: PyTree) -> int:
        return 2

    def init(
        self, terms: PyTree, t0: Instant, t1: Instant, y0: PyTree, args: PyTree
    ) -> None:
        return None

    def step(
        self,
        terms: PyTree,
        t0: Instant,
        t1: Instant,
        y0: State,
        args: PyTree,
        solver_state: None,
        made_jump: PyTree,
    ) -> tuple[State, None, dict[str, State], None, diffrax.RESULTS]:
        # diffeqsolve wraps it
        term: AbstractOverElements = getattr(terms, "term", terms)
        y1 = term.after(t0, t1, y0, args, self.samples)
        return y1, None, {"y0": y0, "y1": y1}, None, diffrax.RESULTS.successful

    def func(self, terms: PyTree, t0: Instant, y0: PyTree, args: PyTree) -> Any:
        return terms.vf(t0, y0, args)
