"""The exact contact step: independent viscoelastic elements under a rigid body, as a `diffrax` solver.

One element of displacement u carries the force density q = E_inf u + eta u' + sum_k f_k with f_k' = E_k u' - f_k/tau_k
under Signorini's conditions q >= 0, u >= w(t), q (u - w) = 0, w being where the rigid surface is. Over a step h the
displacement is taken as linear; everything else is then exact, for every h:

    f_k+ = e_k f_k + E_k phi_k (u+ - u),    e_k = exp(-h/tau_k),    phi_k = (1 - e_k) tau_k/h,

the force at the end is linear in u+, so that u+ = max(u_free, w+) decides between contact and no contact, and the
integrals of q dt and q du are closed forms. The element's path is a possible one and its forces on that path are exact:
no step, however long, creates energy. Kelvin elements (`Foundation.kelvin`: no branch, a dashpot) and Maxwell elements
(`Foundation.maxwell`: one branch, E_inf = 0) are the smallest cases. Contact algorithm: Popov & Hess 2015, ch. 7 and 19.
"""

from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import diffrax
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..material.relaxation import AbstractRelaxation

_SETTLED = 80.0  # z beyond which exp(-z/2) is below rounding: the dashpot has no time of its own within the step


class Elements(NamedTuple):
    """State of n elements with k branches each. Integrals count from the state that `rest` makes."""

    u: Float[Array, " n"]  # displacement, positive into the material [m]
    f: Float[Array, "k n"]  # force densities f_k of the branches [Pa m; Pa for a layer], likewise below
    q: Float[Array, " n"]  # contact force density, zero out of contact; see `contact_step` for the dashpot's share
    impulse: Float[Array, " n"]  # int q dt
    work: Float[Array, " n"]  # int q du
    inelastic: Float[Array, " n"]  # int (q - E_inf u) du: keeps the digits of a loss that is small beside the work
    away: Float[Array, " n"]  # time since the element was last in contact, or since the start [s]


class Coefficients(NamedTuple):
    """What a step of given length needs of the law; branches first, then elements (or 1)."""

    h: Array  # step [s]
    equilibrium: Array  # E_inf
    viscosity: Array  # eta
    decay: Array  # e_k
    gain: Array  # E_k phi_k
    mean: Array  # phi_k: mean of a decaying f_k over the step
    seen: Array  # what is left of f_k where Signorini's conditions look at it
    stiffness: Array  # S = dq/du+
    drag: Array  # mean force of branches and dashpot per change of u


def rest(law: AbstractRelaxation, n: int) -> Elements:
    """n elements that have never been touched."""
    zero = jnp.zeros(n)
    return Elements(zero, jnp.zeros((law.moduli.shape[0], n)), zero, zero, zero, zero, zero)


def coefficients(law: AbstractRelaxation, h: Any) -> Coefficients:
    """Coefficients of a step h [s]: a scalar or one per element, accurate for h/tau_k from 1e-200 to 1e200.

    The law's times may be (k, n) and its other numbers (n,), one law per element: so points of different velocity
    march together in units of their own passage.
    """
    h = jnp.asarray(h)
    moduli, times = _by_element(law.moduli), _by_element(law.times)
    equilibrium, viscosity = jnp.asarray(law.equilibrium), jnp.asarray(law.viscosity)
    y = h / times
    decay, mean = jnp.exp(-y), _phi1(y)
    gain = moduli * mean
    static = equilibrium + jnp.sum(gain, axis=0)
    seen, stiffness = _signorini(static, viscosity, y, decay, h)
    drag = jnp.sum(moduli * _phi2(y), axis=0) + viscosity / h
    return Coefficients(h, equilibrium, viscosity, decay, gain, mean, seen, stiffness, drag)


def contact_step(law: AbstractRelaxation, state: Elements, w_start: Array, w_end: Array, h: Any) -> Elements:
    """The state after a step h [s] in which the rigid surface moves from `w_start` to `w_end` [m, shape (n,)].

    Signorini's conditions hold at the end of the step to rounding: u+ = max(u_free, w+) and q+ = S (u+ - u_free), u_free
    being the displacement that needs no force. Second order in h; at a jump of q (a first touch) u is still linear.

    Without a dashpot q+ is the force at the end, E_inf u+ + sum f_k+. A dashpot's eta u' is known only as a mean over
    the step, and adding it to end values would make free recovery first order. So with a dashpot q is the mean over the
    last part of the step that the dashpot itself remembers, weight exp(-(h - t) K/eta), K = E_inf + sum E_k phi_k: free
    recovery of a Kelvin element is exact, u+ = u exp(-E h/eta), and a long step sees the end alone.
    """
    return advance(coefficients(law, h), state, w_start, w_end)


def advance(c: Coefficients, state: Elements, w_start: Array, w_end: Array) -> Elements:
    """`contact_step` with its coefficients at hand."""
    u, f = state.u, state.f
    held = c.equilibrium * u + jnp.sum(c.seen * f, axis=0)  # force if u stays
    recovery, pushed = -held / c.stiffness, w_end - u
    contact = pushed > recovery
    change = jnp.where(contact, pushed, recovery)
    end = jnp.where(contact, w_end, jnp.maximum(u + recovery, w_end))
    force = held + c.stiffness * pushed  # if the surface is followed; negative where that takes tension

    mean = jnp.sum(c.mean * f, axis=0) + c.drag * change
    inelastic = state.inelastic + mean * change
    # A surface that comes from a distance strikes within the step; the dashpot then sees a shorter, faster motion:
    # eta theta (1 - theta) (slope jump)^2 h more, with theta the fraction of the step before contact.
    struck = jnp.where(contact, (u - w_start) * (pushed - recovery), 0.0)
    inelastic = inelastic + c.viscosity / c.h * jnp.maximum(struck, 0.0)

    left = ~contact & (state.q > 0)  # contact ends where the force, linear in time, passes zero
    held_on = jnp.where(left, state.q / jnp.where(left, state.q - force, 1.0), 0.0)
    return Elements(
        u=end,
        f=c.decay * f + c.gain * change,
        q=jnp.where(contact, jnp.maximum(force, 0.0), 0.0),
        impulse=state.impulse + c.h * (c.equilibrium * (u + 0.5 * change) + mean),
        work=inelastic + 0.5 * c.equilibrium * end**2,
        inelastic=inelastic,
        away=jnp.where(contact, 0.0, state.away * jnp.where(left, 0.0, 1.0) + c.h * (1 - held_on)),
    )


class RigidSurface(diffrax.AbstractTerm):
    """Where the rigid surface is: `position(t)` [m], one value per element, for `ContactStep`.

    It is not a vector field: `vf` is the position itself and `contr` the positions at both ends of a step.
    """

    position: Callable[[Any], Array]

    def vf(self, t: Any, y: Elements, args: Any) -> Array:
        return self.position(t)

    def contr(self, t0: Any, t1: Any, **kwargs: Any) -> tuple[Array, Array]:
        return self.position(t0), self.position(t1)

    def prod(self, vf: Array, control: tuple[Array, Array]) -> Elements:
        raise NotImplementedError("RigidSurface constrains the elements; solve it with ContactStep.")


class ContactStep(diffrax.AbstractSolver):
    """Marches elements under a rigid surface: second order, stable for every step, no events.

        diffeqsolve(RigidSurface(w), ContactStep(), t0, t1, dt0, y0=rest(law, n), args=law)

    `samples` contact steps of equal length make one step of the solver, since `diffeqsolve` costs microseconds a step;
    the coefficients are computed once for all of them. Output between steps is interpolated linearly. Differentiable in
    forward and reverse mode (`adjoint=diffrax.DirectAdjoint()` for both): reverse mode stores one state per `samples`.
    """

    samples: int = 1
    term_structure: ClassVar = RigidSurface
    interpolation_cls: ClassVar[Callable[..., diffrax.LocalLinearInterpolation]] = diffrax.LocalLinearInterpolation

    def order(self, terms: Any) -> int:
        return 2

    def init(self, terms: Any, t0: Any, t1: Any, y0: Elements, args: AbstractRelaxation) -> None:
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

        @jax.checkpoint
        def block(law: AbstractRelaxation, start: Elements, w: Array) -> Elements:
            c = coefficients(law, (t1 - t0) / self.samples)
            end, _ = jax.lax.scan(lambda y, ends: (advance(c, y, *ends), None), start, (w[:-1], w[1:]))
            return end

        y1 = block(args, y0, jax.vmap(lambda t: terms.vf(t, y0, args))(times))
        return y1, None, {"y0": y0, "y1": y1}, None, diffrax.RESULTS.successful

    def func(self, terms: Any, t0: Any, y0: Elements, args: AbstractRelaxation) -> Array:
        return terms.vf(t0, y0, args)


def _signorini(static: Array, viscosity: Array, y: Array, decay: Array, h: Array) -> tuple[Array, Array]:
    """`seen` and S: means of exp(-t/tau_k) and of the force per change of u, weighted by exp(-(h - t) K/eta).

    With z = h K/eta: seen_k = z (exp(-y_k) - exp(-z)) / ((z - y_k) (1 - exp(-z))) and S = K/(1 - exp(-z)). No dashpot is
    z = infinity, the values at the end of the step; no stiffness is z = 0, the plain means.
    """
    present = viscosity > 0
    z = h * static / jnp.where(present, viscosity, 1.0)
    settled = ~present | (z > _SETTLED)
    z = jnp.where(settled, _SETTLED, z)
    stiffness = jnp.where(settled, static, viscosity / h / _phi1(z))
    lag = jnp.where(settled, viscosity / jnp.where(settled, h * static, 1.0), 0.0)  # 1/z
    # |z - y| loses nothing that matters: exp(-min) phi1(|z - y|) is smooth there.
    unsettled = jnp.exp(-jnp.minimum(y, z)) * _phi1(jnp.abs(z - y)) / _phi1(z)
    seen = jnp.where(settled, decay / (1 - jnp.minimum(y * lag, 0.5)), unsettled)
    return seen, stiffness


def _phi1(y: Array) -> Array:
    """(1 - exp(-y))/y for y >= 0."""
    safe = jnp.where(y > 0, y, 1.0)
    return jnp.where(y > 0, -jnp.expm1(-safe) / safe, 1.0)


def _phi2(y: Array) -> Array:
    """(1 - phi1(y))/y, by its series where the difference would lose digits."""
    small = jnp.minimum(y, 1.0)
    series = jnp.ones_like(y)
    for k in range(17, 2, -1):
        series = 1 - small / k * series
    large = jnp.maximum(y, 1.0)
    return jnp.where(y < 1, 0.5 * series, (1 - _phi1(large)) / large)


def _by_element(branches: Array) -> Array:
    """(k,) as (k, 1); (k, n) as it is."""
    branches = jnp.asarray(branches)
    return branches[:, None] if branches.ndim == 1 else branches
