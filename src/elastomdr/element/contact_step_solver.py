"""The exact contact step as a solver of `diffrax`; nothing else of the package loads
that.
"""

from collections.abc import Callable
from typing import Any, ClassVar

import diffrax
import jax
import jax.numpy as jnp

from ..checks import Array, whole_number
from ..errors import InputError
from ..material.relaxation import AbstractRelaxation
from .contact_step import Elements, advance, coefficients


class RigidSurface(diffrax.AbstractTerm):
    """Where the rigid surface is, `position(t)` [m, shape (n,)]: the term that
    `ContactStep` solves.

    It is no vector field: `vf` is the position, `contr` the positions at both ends of a
    step.
    """

    position: Callable[[Any], Array]

    def vf(self, t: Any, y: Elements, args: Any) -> Array:
        return self.position(t)

    def contr(self, t0: Any, t1: Any, **kwargs: Any) -> tuple[Array, Array]:
        return self.position(t0), self.position(t1)

    def prod(self, vf: Array, control: tuple[Array, Array]) -> Elements:
        raise InputError(
            "solver must be ContactStep for a RigidSurface: that is a constraint, "
            "not a vector field."
        )


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
    term_structure: ClassVar = RigidSurface
    interpolation_cls: ClassVar[Callable[..., diffrax.LocalLinearInterpolation]] = (
        diffrax.LocalLinearInterpolation
    )

    def __check_init__(self) -> None:
        whole_number("samples", self.samples, 1)

    # `Any` below: terms, instants and jumps are typed by diffrax.AbstractSolver.
    def order(self, terms: Any) -> int:
        return 2

    def init(
        self, terms: Any, t0: Any, t1: Any, y0: Elements, args: AbstractRelaxation
    ) -> None:
        return None

    def step(
        self,
        terms: Any,
        t0: Any,
        t1: Any,
        y0: Elements,
        args: AbstractRelaxation,
        solver_state: None,
        made_jump: Any,
    ) -> tuple[Elements, None, dict[str, Elements], None, diffrax.RESULTS]:
        times = t0 + (t1 - t0) * jnp.linspace(0.0, 1.0, self.samples + 1)
        surface = jax.vmap(lambda t: terms.vf(t, y0, args))(times)

        @jax.checkpoint
        def block(law: AbstractRelaxation, start: Elements, surface: Array) -> Elements:
            c = coefficients(law, (t1 - t0) / self.samples)
            ends = (surface[:-1], surface[1:])
            return jax.lax.scan(
                lambda state, w: (advance(c, state, *w), None), start, ends
            )[0]

        y1 = block(args, y0, surface)
        return y1, None, {"y0": y0, "y1": y1}, None, diffrax.RESULTS.successful

    def func(
        self, terms: Any, t0: Any, y0: Elements, args: AbstractRelaxation
    ) -> Array:
        return terms.vf(t0, y0, args)
