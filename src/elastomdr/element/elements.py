"""The elements in the open, `em.elements`: the exact contact step as a solver of
diffrax, and what moves over the elements as its terms.

    law = em.half_space(material)
    body = em.elements.MovingBody(mass, load=10.0, surface=lambda X: -g(x - X), spacing=dx)
    diffrax.diffeqsolve(body, em.elements.ContactStep(), t0, t1, dt0, body.start(law), law)

A row of elements is no vector field: what happens to it in a step is said by the term
that `ContactStep` solves: a rigid surface on a given way, or a body that moves.
"""

from __future__ import annotations

import abc
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeVar

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, not_negative, positive, scalar, whole_number
from ..errors import InputError
from ..material.relaxation import AbstractRelaxation, Relaxation
from ..trees import static
from .body_over_line import AbstractOverLine
from .contact_step import Elements, advance, coefficients, rest
from .law import Foundation
from .moving_body import (
    BodyMotion,
    LineMemory,
    MotionScene,
    Mount,
    Steps,
    advance_body,
    untouched,
)

if TYPE_CHECKING:
    from jaxtyping import Float, PyTree

    from .._types import Number

__all__ = ["ContactStep", "MovingBody", "RigidSurface", "energy", "forces", "rest"]

State = TypeVar("State")
Instant = bool | int | float | jax.Array | np.ndarray


class AbstractOverElements(diffrax.AbstractTerm):
    """What happens to elements in time: a constraint, which only `ContactStep` solves.

    It is no vector field: `vf` and `contr` are there for what diffrax asks of a term.
    """

    @abc.abstractmethod
    def after(
        self, t0: Instant, t1: Instant, state: PyTree, args: PyTree, samples: int
    ) -> PyTree:
        """The state at t1, after so many contact steps from t0 on."""

    def vf(self, t: Instant, y: PyTree, args: PyTree) -> PyTree:
        return y

    def contr(self, t0: Instant, t1: Instant, **kwargs: PyTree) -> PyTree:
        return t0, t1

    def prod(self, vf: PyTree, control: PyTree) -> PyTree:
        raise InputError(
            argument="solver",
            accepted=f"ContactStep for a {type(self).__name__}",
            hint="that is a constraint, not a vector field",
        )


class RigidSurface(AbstractOverElements):
    """A rigid surface over n elements, on a way that is given.

        diffeqsolve(RigidSurface(w), ContactStep(), t0, t1, dt0, y0=rest(law, n), args=law)

    Args:
        position: w(t) [m, shape (n,)], where the surface is over each element, positive
            into the material.
    """

    position: Callable[[Array], Array]

    def after(
        self,
        t0: Instant,
        t1: Instant,
        state: Elements,
        args: AbstractRelaxation,
        samples: int,
    ) -> Elements:
        surface = jax.vmap(self.position)(_instants(t0, t1, samples))

        @jax.checkpoint
        def block(law: AbstractRelaxation, start: Elements, surface: Array) -> Elements:
            c = coefficients(law, (t1 - t0) / samples)
            ends = (surface[:-1], surface[1:])
            return jax.lax.scan(
                lambda state, w: (advance(c, state, *w), None), start, ends
            )[0]

        return block(args, state, surface)


class MovingBody(AbstractOverElements):
    """A rigid body over elements at equal distances; its depth d and its place X are
    unknowns of the same `diffeqsolve`.

        normal:      m d'' = P(t) - k d - c d' - F_N          without a mass: F_N = P
        tangential:  m X'' = k (D(t) - X) + c (D' - X') - F_x     without a mount: X = D

    `body.start(law)` is its state y0, `em.half_space(material)` or another law `args`.

    Args:
        mass: m [kg], or None: what carries the load has no inertia.
        spring: k [N/m], free at d = 0.
        damper: c [N s/m].
        load: P [N], a number or a function of time, positive into the material.
        surface: b(X) [m, shape (n,)], where the surface is over each element when the
            body stands at X and d = 0; -g(x - X) for the line profile g of an indenter.
        spacing: distance of the elements [m], by which forces per length of line are
            multiplied; times the length of a cylinder on springs, 1/n for means per
            length of a period.
        tangential: `em.Mount(mass, stiffness, damping)` through which the drive pulls.
        drive: D [m], a number or a function of time.

    Bodies take the trapezoidal rule, elements the exact contact step; both are of
    second order, and solved together. The line is that of the textbook: it overstates
    the friction of a half-space by up to a factor of 2.

    Source: Popov & Hess 2015, ch. 7 and 19; `docs/theory.md`.
    """

    mass: Number | None
    spring: Number = 0.0
    damper: Number = 0.0
    load: Number | Callable[[Array], Number] = 0.0
    surface: Callable[[Array], Array] = eqx.field(kw_only=True)
    spacing: Number = eqx.field(kw_only=True)
    tangential: Mount | None = eqx.field(kw_only=True, default=None)
    drive: Number | Callable[[Array], Number] = eqx.field(kw_only=True, default=0.0)

    def __check_init__(self) -> None:
        positive("spacing", scalar("spacing", self.spacing))
        if self.mass is not None:
            positive("mass", scalar("mass", self.mass))
        for name in ("spring", "damper"):
            value = scalar(name, getattr(self, name))
            not_negative(name, value)
            if self.mass is None:
                free = bool(isinstance(value, np.ndarray) and value == 0)
                if not free:
                    raise InputError(
                        argument=name, got=value, accepted="0 where mass is None"
                    )
        if not isinstance(self.tangential, Mount | None):
            raise InputError(
                argument="tangential",
                got=self.tangential,
                accepted="an em.Mount(mass, stiffness, damping)",
            )

    def start(
        self,
        law: AbstractRelaxation,
        t0: Instant = 0.0,
        *,
        velocity: Number = 0.0,
        depth: Number = 0.0,
        sinking: Number = 0.0,
    ) -> BodyMotion:
        """The body before the first step, on rubber that was never touched.

        Args:
            law: the law of the elements.
            t0: time [s]; the body stands at X = D(t0).
            velocity: X' [m/s].
            depth: d [m], 0 where the highest point of `surface` at b = 0 just touches.
            sinking: d' [m/s].

        Returns:
            A `BodyMotion`: `depth`, `sinking`, `position`, `velocity` of the body,
            `line.u` [m], `line.f` [Pa m, shape (k, n)] and `line.q` [Pa m] of the
            elements, the works `work` of the contact, `driven` and `pressed` of drive
            and load, and `damped` [J].
        """
        place, load = (jnp.asarray(_at(x, t0), float) for x in (self.drive, self.load))
        _in_64_bits("y0", (place, load))
        scene = self._scene(law)
        body = untouched(scene, place, viscous=True)
        depth = jnp.asarray(depth, float)
        body = body._replace(
            line=body.line._replace(w=depth + scene.surface.rise(place)),
            value=load,
            velocity=jnp.asarray(velocity, float),
            depth=depth,
            sinking=jnp.asarray(sinking, float),
            ahead=depth,
        )
        return jax.tree.map(jnp.asarray, body)

    def _scene(self, law: AbstractRelaxation) -> MotionScene:
        bare = Relaxation(law.equilibrium, law.moduli, law.times, law.viscosity)
        spacing = jnp.asarray(self.spacing)
        normal = None
        if self.mass is not None:
            normal = Mount(self.mass, self.spring, self.damper)
        surface = _GivenSurface(spacing, spacing, self.surface)
        return MotionScene(bare, surface, self.tangential, normal)

    def after(
        self,
        t0: Instant,
        t1: Instant,
        state: BodyMotion,
        args: AbstractRelaxation,
        samples: int,
    ) -> BodyMotion:
        ends = _instants(t0, t1, samples)[1:]
        drive, load = (
            jax.vmap(lambda t, of=of: jnp.asarray(_at(of, t), float))(ends)
            for of in (self.drive, self.load)
        )
        steps = Steps(jnp.full(samples, (t1 - t0) / samples), drive, load)

        @jax.checkpoint
        def block(law: AbstractRelaxation, start: BodyMotion, steps: Steps) -> Any:
            c, scene = coefficients(law, (t1 - t0) / samples), self._scene(law)

            def step(state: BodyMotion, end: Steps) -> tuple[BodyMotion, None]:
                return advance_body(scene, c, state, end, "load", True, True)[0], None

            return jax.lax.scan(step, start, steps)[0]

        return block(args, state, steps)


class _GivenSurface(AbstractOverLine):
    """A surface given as a function of the place of the body."""

    function: Callable[[Array], Array] = static()

    @property
    def count(self) -> int:
        return jax.eval_shape(self.function, 0.0).shape[0]

    @property
    def between(self) -> bool:
        return True

    def rise(self, position: Array) -> Array:
        return jnp.asarray(self.function(position))

    def rise_and_slope(self, position: Array) -> tuple[Array, Array]:
        return jax.jvp(self.rise, (position,), (jnp.ones_like(position),))


def _at(value: Number | Callable[[Array], Number], t: Instant | Array) -> Any:
    return value(jnp.asarray(t)) if callable(value) else value


def _instants(t0: Instant, t1: Instant, samples: int) -> Array:
    return t0 + (t1 - t0) * jnp.linspace(0.0, 1.0, samples + 1)


class ElementForces(NamedTuple):
    """Force densities of elements; with a dashpot its force is what they leave of
    q.
    """

    q: Float[Array, " n"]  # of the contact [Pa m]
    spring: Float[Array, " n"]  # E_inf u [Pa m]
    branches: Float[Array, "k n"]  # f_k [Pa m]


def forces(law: AbstractRelaxation, state: Elements | BodyMotion) -> ElementForces:
    """Force densities of the elements in a state.

    Args:
        law: the law of the elements.
        state: that of a `RigidSurface` or of a `MovingBody`.

    Returns:
        `q` of the contact [Pa m, shape (n,)], zero out of contact, `spring` of the
        equilibrium modulus, and `branches` [shape (k, n)]; Pa on springs. Times the
        distance of the elements they are forces [N].
    """
    line = _elements(state)
    found = ElementForces(line.q, law.equilibrium * line.u, line.f)
    return _in_64_bits("state", found)


def energy(law: AbstractRelaxation, state: Elements | BodyMotion) -> Float[Array, " n"]:
    """Energy stored in each element, E_inf u^2/2 + sum f_k^2/(2 E_k) [Pa m^2, shape
    (n,)]; times the distance of the elements it is in J.

    Args:
        law: the law of the elements.
        state: that of a `RigidSurface` or of a `MovingBody`; its `work` less this is
            what was dissipated.
    """
    line = _elements(state)
    return _in_64_bits("state", 0.5 * law.equilibrium * line.u**2 + line.stored)


def _in_64_bits(argument: str, values: PyTree) -> PyTree:
    """The values as they are. Raises `InputError` where JAX would round them."""
    for leaf in jax.tree.leaves(values):
        if leaf.dtype != jnp.float64:
            raise InputError(
                argument=argument,
                got=str(leaf.dtype),
                accepted="of 64 bits",
                hint="put `with jax.enable_x64(True):` around the call, or set "
                "JAX_ENABLE_X64=1",
            )
    return values


def _elements(state: Elements | BodyMotion) -> Elements | LineMemory:
    return state.line if isinstance(state, BodyMotion) else state


class ContactStep(diffrax.AbstractSolver):
    """The exact contact step: second order, stable for every step, Signorini's
    conditions exact at its ends.

    Args:
        samples: contact steps of equal length that make one step of the solver, since
            `diffeqsolve` costs microseconds a step.

    For `RigidSurface` and `MovingBody`, in 64 bits: put `with jax.enable_x64(True):`
    around all of the call. Output between steps is interpolated linearly, and an
    `Event` found by that. For `diffrax.PIDController` the error is that of halved
    steps, all in metres: of the displacement of each element, its force divided by the
    glassy modulus, and of depth and place of a body. `atol` is a length, and a solve
    takes three times as long. Differentiable by every adjoint of diffrax that goes
    through the solver: `ForwardMode`, `RecursiveCheckpointAdjoint`, `DirectAdjoint`.

    Not for `SaveAt(ts=...)` at instants that a step ends on: `RecursiveCheckpointAdjoint`
    of diffrax 0.7.2, the default, can leave out their derivative without a word, with
    any solver. Let steps end there by `StepTo(ts=...)`, or take `SaveAt(steps=True)` or
    `ForwardMode`.

    Raises `InputError` for a state of 32 bits and for args that are no law.
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

    def error_order(self, terms: PyTree) -> int:
        return 3

    def init(
        self, terms: PyTree, t0: Instant, t1: Instant, y0: PyTree, args: PyTree
    ) -> None:
        # what JAX makes here has as many as it was told, whatever the state has
        _in_64_bits("y0", (y0, jnp.zeros(())))
        law = isinstance(args, Foundation | Relaxation)
        if not law or getattr(args, "softening", None) is not None:
            raise InputError(
                argument="args",
                got=args,
                accepted="the law of the elements, an em.Foundation that does not "
                "soften",
                hint="em.half_space(material) makes one of a material",
            )

    def step(
        self,
        terms: PyTree,
        t0: Instant,
        t1: Instant,
        y0: State,
        args: PyTree,
        solver_state: None,
        made_jump: PyTree,
    ) -> tuple[State, State, dict[str, State], None, diffrax.RESULTS]:
        term = getattr(terms, "term", terms)  # diffeqsolve wraps it
        y1 = term.after(t0, t1, y0, args, self.samples)
        # which the compiler leaves out where no controller asks for it
        halved = term.after(t0, t1, y0, args, 2 * self.samples)
        error = _error(args, y1, halved, (t1 - t0) / self.samples)
        return y1, error, {"y0": y0, "y1": y1}, None, diffrax.RESULTS.successful

    def func(self, terms: PyTree, t0: Instant, y0: PyTree, args: PyTree) -> PyTree:
        return terms.vf(t0, y0, args)


def _error(law: AbstractRelaxation, one: State, halved: State, h: Instant) -> State:
    """The error of a step as lengths [m], whose root mean square over the whole state,
    as controllers take it, is that over elements, of depth and of place.
    """
    glass = (
        law.equilibrium + jnp.sum(law.moduli, axis=0) + law.viscosity / jnp.asarray(h)
    )
    off = jax.tree.map(lambda a, b: jnp.abs(a - b), one, halved)
    none = jax.tree.map(jnp.zeros_like, off)
    size = sum(leaf.size for leaf in jax.tree.leaves(off))
    line = _elements(off)
    length = (line.u + line.q / glass) * math.sqrt(size / line.u.size)
    if isinstance(off, Elements):
        return none._replace(u=length)
    return none._replace(
        line=none.line._replace(u=length),
        depth=off.depth * math.sqrt(size),
        position=off.position * math.sqrt(size),
    )
