"""One element without a time step: its free recovery in modes, and an episode in which
the rigid surface over it moves at a constant rate, with contact gained and lost each at
its own instant.

**Modes.** An element that carries no force recovers as a sum of exponentials, one per
retardation time lambda_j of its Kelvin chain: u = sum_j m_j, m_j' = c_j q -
m_j/lambda_j (and u has J_0 q besides), with c_j = J_j/lambda_j. A liquid has one more
mode that does not recover, c = phi, its rate zero. Branch k, with its dashpot at y_k =
u - f_k/E_k, follows the modes as

    y_k = sum_j Y_jk m_j,    Y_jk = lambda_j/(lambda_j - tau_k),

and the modes are orthogonal to each other in the dissipation of the dashpots, sum_k E_k
tau_k Y_ik Y_jk + eta = 0 for i /= j, since a dissipation and an energy that are
quadratic have common modes. So both ways are plain sums, derived here: no equation is
solved. Source of the modes: Gross 1953 (see `material.relaxation`).

**Episodes.** Between two instants the surface is at w0 + v t. What can happen, and in
which order, follows from the signs of a viscoelastic element (derived here; a parallel
dashpot changes nothing in it):

- Free recovery is a sum of decaying exponentials with positive weights, since an
  element is only ever pushed. So the gap to the surface is convex in time: the surface
  is met at the first root of the gap, or not at all, and Newton's method from the left
  finds either without overshooting.
- In contact u follows the surface and q is a closed form. Once q would be negative it
  stays so: contact ends at its one change of sign. An element let go cannot meet the
  same straight path again.

So each element is free for a time, in contact for a time, free for the rest; any of the
three may be empty.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import on_numpy, stop_gradient, tree_map, while_loop, xp
from ..checks import Array, numpy_unless_traced, possible
from ..material.relaxation import Relaxation, kelvin_and_gaps
from ..numerics.decay import phi1, phi2

if TYPE_CHECKING:
    from jaxtyping import Bool, Float


_MOST = 100  # iterations in search of an instant
_NEWTON = 8  # of them per one that halves the bracket whatever Newton's method says
_ROUNDING = 1e-15
_BLUR = 1e-12  # of a force: below it its sign may be one of rounding

# of 1 - tau/lambda, where a branch without strength makes the two coincide
_NEAREST = 1e-60


class EpisodeState(NamedTuple):
    """State of n elements: `f` where in contact, `m` where free (the other is not
    looked at).
    """

    contact: Bool[Array, " n"]
    u: Float[Array, " n"]  # displacement [m]
    f: Float[Array, "k n"]  # branch forces [Pa m; on a layer Pa]
    m: Float[Array, "j n"]  # recovery modes [m]
    work: Float[Array, " n"]  # int q du [Pa m^2; on a layer Pa m]
    heat: Float[Array, " n"]  # turned into heat by branches and dashpot, likewise


def pressed(law: Relaxation, modes: Modes, w: Float[Array, " n"]) -> EpisodeState:
    """Elements at rest until a surface at w is pressed on them at once: glassy where w
    > 0, untouched elsewhere.
    """
    u = xp.maximum(w, 0.0)
    glassy = law.equilibrium + xp.sum(law.moduli)
    m = xp.zeros((modes.rate.size, w.size))
    return EpisodeState(
        w > 0, u, law.moduli[:, None] * u, m, 0.5 * glassy * u**2, xp.zeros_like(u)
    )


def force(law: Relaxation, state: EpisodeState, v: Array | float) -> Float[Array, " n"]:
    """q of each element while the surface moves at rate v."""
    q = law.equilibrium * state.u + law.viscosity * v + xp.sum(state.f, axis=0)
    return xp.where(state.contact, q, 0.0)


def energies(law: Relaxation, modes: Modes, state: EpisodeState) -> tuple[Array, Array]:
    """Elastic energy of the elements in contact, and of those that are free, each zero
    for the others.
    """
    strength = xp.where(
        law.moduli > 0, 0.5 / xp.where(law.moduli > 0, law.moduli, 1.0), 0.0
    )
    in_contact = 0.5 * law.equilibrium * state.u**2 + strength @ state.f**2
    in_modes = (0.5 * modes.norm * modes.rate) @ state.m**2
    return xp.where(state.contact, in_contact, 0.0), xp.where(
        state.contact, 0.0, in_modes
    )


def follow(
    law: Relaxation,
    modes: Modes,
    state: EpisodeState,
    w: Float[Array, " n"],
    v: Array,
    h: Array,
) -> EpisodeState:
    """The state after a time h in which the surface moves from w to w + v h. Exact;
    differentiable in both modes.
    """
    # Free, until it meets the surface.
    was_free = ~state.contact
    wait, touched = _until_met(modes, state, w, v, h)
    decayed = _of_those(was_free, _decayed, modes, state.m, wait)
    u = xp.where(touched, w + v * wait, xp.sum(decayed, axis=0))
    f = _of_those(touched & was_free, to_branches, law, modes, decayed)
    f = xp.where(state.contact, state.f, f)

    # In contact, until it would be pulled.
    rest = xp.where(touched, h - wait, 0.0)
    stay, lost = _of_those(touched, _until_pulled, law, u, f, v, rest, touched)
    u_end, f_end, spent, warmed = _of_those(touched, _in_contact, law, u, f, v, stay)
    u_end = xp.where(touched, u_end, u)

    # Free again.
    let_go = _of_those(lost, to_modes, law, modes, u_end, f_end)
    m = xp.where(touched, let_go, decayed)
    m = xp.where(lost, _of_those(lost, _decayed, modes, m, rest - stay), m)
    recovered = _of_those(was_free, _recovery_loss, modes, state.m, wait)
    again = _of_those(lost, _recovery_loss, modes, let_go, rest - stay)
    recovered = xp.where(was_free, recovered, 0.0) + xp.where(lost, again, 0.0)
    contact = touched & ~lost
    return EpisodeState(
        contact=contact,
        u=xp.where(contact, u_end, xp.sum(m, axis=0)),
        f=f_end,
        m=m,
        work=state.work + xp.where(touched, spent, 0.0),
        heat=state.heat + xp.where(touched, warmed, 0.0) + recovered,
    )


def _of_those(where: Array, function: Callable[..., Any], *given: Any) -> Any:
    """A function of elements, which run over the last axis of the arrays given: on
    NumPy of those `where` it is asked for alone, and zeros for the others.
    """
    if not on_numpy() or where.all():
        return function(*given)
    here, count = np.flatnonzero(where), where.size

    def placed(values: Array) -> Array:
        whole = np.zeros((*values.shape[:-1], count), values.dtype)
        whole[..., here] = values
        return whole

    chosen_given = (
        x[..., here] if isinstance(x, np.ndarray) and x.shape[-1:] == (count,) else x
        for x in given
    )
    return tree_map(placed, function(*chosen_given))


def _decayed(modes: Modes, m: Array, t: Array) -> Array:
    """Modes after a time of free recovery."""
    return xp.exp(-modes.rate[:, None] * t) * m


def _until_met(
    modes: Modes, state: EpisodeState, w: Array, v: Array, h: Array
) -> tuple[Array, Array]:
    """The time for which an element is free, and whether it is touched then."""

    def meeting(m: Array, w: Array) -> tuple[Array, Array]:
        # The search is on numbers; a Newton step from its end carries the derivatives.
        met, wait = _meeting(*stop_gradient((modes, m, w, v, h)))
        gap, closing = _gap(modes, m, w, v, wait)
        closing = stop_gradient(xp.where(closing < 0, closing, -xp.inf))
        return met, xp.where(met, wait - gap / closing, h)

    met, wait = _of_those(~state.contact, meeting, state.m, w)
    return xp.where(state.contact, 0.0, wait), state.contact | met


def _until_pulled(
    law: Relaxation, u: Array, f: Array, v: Array, rest: Array, touched: Array
) -> tuple[Array, Array]:
    """The time for which an element stays in contact, and whether it is let go then."""
    lost, at_once = _is_lost(*stop_gradient((law, u, f, v, rest)), touched)

    def parting(u: Array, f: Array, rest: Array, sought: Array) -> Array:
        stay = _parting(*stop_gradient((law, u, f, v, rest)), sought)
        pull, falling = _pull(law, u, f, v, stay)
        falling = stop_gradient(xp.where(falling < 0, falling, -xp.inf))
        polished = xp.clip(stay - pull / falling, 0.0, rest)
        return xp.where(stay > 0, polished, 0.0)

    sought = lost & ~at_once
    stay = _of_those(sought, parting, u, f, rest, sought)
    return xp.where(sought, stay, xp.where(lost, 0.0, rest)), lost


class _Followed(NamedTuple):
    u: Array
    f: Array
    work: Array  # done on the element
    heat: Array  # what of it became heat


def _in_contact(
    law: Relaxation, u: Array, f: Array, v: Array, stay: Array
) -> _Followed:
    """An element that has followed the surface for a time."""
    y = stay / law.times[:, None]
    first, second = phi1(y), phi2(y)
    moved = law.moduli[:, None] * v * stay
    f_end = (1 - y * first) * f + moved * first
    u_end = u + v * stay
    spent = 0.5 * law.equilibrium * (u_end**2 - u**2) + law.viscosity * v**2 * stay
    spent = spent + v * stay * xp.sum(first * f + moved * second, axis=0)
    losses = _branch_loss(law, f, v * stay, y, first, second)
    heat = law.viscosity * v**2 * stay + xp.sum(losses, axis=0)
    return _Followed(u_end, f_end, spent, heat)


def _branch_loss(
    law: Relaxation, f: Array, moved: Array, y: Array, first: Array, second: Array
) -> Array:
    """int f_k^2/(E_k tau_k) dt of each branch while the element moves by `moved` at a
    constant rate; y = h/tau_k, phi_1 and phi_2 of it.
    """
    moduli = law.moduli[:, None]
    compliance = xp.where(moduli > 0, 1 / xp.where(moduli > 0, moduli, 1.0), 0.0)
    faded = y * first  # 1 - exp(-y)
    loss = f**2 * compliance * faded * (1 - 0.5 * faded) + f * moved * faded * first
    return loss + moduli * moved**2 * (second - 0.5 * first**2)


def _recovery_loss(modes: Modes, m: Array, t: Array) -> Array:
    """What free modes turn into heat in a time t: norm_j int m_j'^2 dt, the modes being
    orthogonal in dissipation.
    """
    rate = modes.rate[:, None]
    return (0.5 * modes.norm * modes.rate) @ (m**2 * -xp.expm1(-2 * rate * t))


def _gap(modes: Modes, m: Array, w: Array, v: Array, t: Array) -> tuple[Array, Array]:
    """Gap between a free element and the surface at time t, and its rate."""
    now = _decayed(modes, m, t)
    return xp.sum(now, axis=0) - (w + v * t), -xp.sum(
        modes.rate[:, None] * now, axis=0
    ) - v


def _pull(
    law: Relaxation, u: Array, f: Array, v: Array, t: Array
) -> tuple[Array, Array]:
    """Force of an element that follows the surface, a time t later, and its rate."""
    y = t / law.times[:, None]
    first = phi1(y)
    f = (1 - y * first) * f + law.moduli[:, None] * v * t * first
    q = law.equilibrium * (u + v * t) + law.viscosity * v + xp.sum(f, axis=0)
    return q, law.equilibrium * v + xp.sum(
        law.moduli[:, None] * v - f / law.times[:, None], axis=0
    )


def _meeting(
    modes: Modes, m: Array, w: Array, v: Array, h: Array
) -> tuple[Array, Array]:
    """Whether and when a free element meets the surface: Newton's method from the left
    on a convex gap, which needs no bracket and ends at the first root.
    """
    size = _ROUNDING * (xp.abs(w) + xp.abs(v) * h + xp.sum(xp.abs(m), axis=0))

    def advance(carry: tuple) -> tuple:
        t, met, ended, count = carry
        gap, rate = _gap(modes, m, w, v, t)
        following = t - gap / xp.where(rate < 0, rate, -1.0)
        touches = (gap <= size) | ((rate < 0) & (following <= t))
        never = ~touches & ((rate >= 0) | (following > h * (1 + _ROUNDING)))
        met = xp.where(ended, met, touches)
        ends = ended | touches | never
        return xp.where(ends, t, xp.minimum(following, h)), met, ends, count + 1

    nowhere = xp.zeros(w.shape, bool)
    start = (xp.zeros_like(w), nowhere, nowhere, 0)
    t, met, _, _ = while_loop(lambda c: ~xp.all(c[2]) & (c[3] < _MOST), advance, start)
    return met, t


def _is_lost(
    law: Relaxation, u: Array, f: Array, v: Array, rest: Array, touched: Array
) -> tuple[Array, Array]:
    """Whether an element in contact would be pulled, and whether at once: where a
    dashpot is, q does not pass zero, and there is no root to search for.
    """
    end, _ = _pull(law, u, f, v, rest)
    lost = touched & (end < 0)
    begin, change = _pull(law, u, f, v, xp.zeros_like(rest))
    blur = _BLUR * _size_of_force(law, u, f, v)
    return lost, lost & (begin <= 0) & ((change <= 0) | (begin < -blur))


def _size_of_force(law: Relaxation, u: Array, f: Array, v: Array) -> Array:
    """The sum of what adds up to q, without signs."""
    return (
        law.equilibrium * xp.abs(u)
        + law.viscosity * xp.abs(v)
        + xp.sum(xp.abs(f), axis=0)
    )


def _parting(
    law: Relaxation, u: Array, f: Array, v: Array, rest: Array, sought: Array
) -> Array:
    """When an element in contact would be pulled, zero where that is not `sought`:
    Newton's method within a bracket, from where a straight line between its ends is
    zero. Of q, a sum of exponentials, the slope is at hand, and it may rise before it
    falls: a secant could leave for the wrong side.
    """
    begin, _ = _pull(law, u, f, v, xp.zeros_like(rest))
    end, _ = _pull(law, u, f, v, rest)
    size = _size_of_force(law, u, f, v)

    def advance(carry: tuple) -> tuple:
        t, low, high, ended, count = carry
        q, rate = _pull(law, u, f, v, t)
        # an element that has just met the surface begins at zero
        rising = (rate > 0) & (q > -_BLUR * size)
        low = xp.where((q > 0) | rising, t, low)
        high = xp.where((q > 0) | rising, high, t)
        following = t - q / xp.where(rate < 0, rate, -1.0)
        inside = (
            (following > low)
            & (following < high)
            & (rate < 0)
            & (count % _NEWTON < _NEWTON - 1)
        )
        following = xp.where(inside, following, 0.5 * (low + high))
        close = (xp.abs(following - t) <= 4 * _ROUNDING * rest) | (
            high <= low * (1 + 4 * _ROUNDING)
        )
        done = ended | close | ((xp.abs(q) <= 2 * _ROUNDING * size) & ~rising)
        return xp.where(done, t, following), low, high, done, count + 1

    straight = rest * xp.clip(begin / xp.where(sought, begin - end, 1.0), 0.0, 1.0)
    start = (straight, xp.zeros_like(rest), rest, ~sought, 0)
    t, *_ = while_loop(lambda c: ~xp.all(c[3]) & (c[4] < _MOST), advance, start)
    return xp.where(~sought | (t <= 4 * _ROUNDING * rest), 0.0, t)


class Modes(NamedTuple):
    """Recovery modes of a law: j runs over retardation times (and flow), k over
    branches.
    """

    rate: Float[Array, " j"]  # 1/lambda_j, zero for flow [1/s]
    gain: Float[Array, " j"]  # c_j, growth of the mode per force and time [1/(Pa s)]
    shape: Float[Array, "j k"]  # Y_jk
    norm: Float[Array, " j"]  # sum_k E_k tau_k Y_jk^2 + eta [Pa s]
    instantaneous: Float[Array, ""]  # J_0 [1/Pa]


@numpy_unless_traced
def recovery_modes(law: Relaxation) -> Modes:
    """The modes of a law, to full relative accuracy; exact. NumPy arrays unless the law
    is traced.
    """
    chain, gaps = kelvin_and_gaps(law)
    has_branch = chain.compliances > 0
    rate = xp.where(has_branch, 1 / xp.where(has_branch, chain.times, 1.0), 0.0)
    gain = xp.where(has_branch, chain.compliances * rate, 0.0)
    gap = rate[:, None] * gaps + xp.where(has_branch, 0.0, 1.0)[:, None]
    if possible(lambda fluidity: fluidity > 0, chain.fluidity):
        rate, gain = xp.append(rate, 0.0), xp.append(gain, chain.fluidity)
        gap = xp.concatenate([gap, xp.ones((1, gap.shape[1]))])
    shape = 1 / xp.where(xp.abs(gap) < _NEAREST, _NEAREST, gap)
    norm = xp.sum(law.moduli * law.times * shape**2, axis=1) + law.viscosity
    return Modes(rate, gain, shape, norm, xp.asarray(chain.instantaneous))


def to_branches(
    law: Relaxation, modes: Modes, m: Float[Array, " j *n"]
) -> Float[Array, " k *n"]:
    """Forces f_k of an element that recovers freely, from its modes: f_k = -sum_j E_k
    tau_k Y_jk m_j/lambda_j.
    """
    weights = -(law.moduli * law.times)[:, None] * (modes.rate[:, None] * modes.shape).T
    return xp.tensordot(weights, m, axes=1)


def to_modes(
    law: Relaxation, modes: Modes, u: Float[Array, "*n"], f: Float[Array, " k *n"]
) -> Float[Array, " j *n"]:
    """Modes of an element that carries no force, from its displacement and branch
    forces.
    """
    lagging = xp.expand_dims(law.moduli * law.times, tuple(range(1, f.ndim))) * u
    # E_k tau_k y_k
    lagging = lagging - xp.expand_dims(law.times, tuple(range(1, f.ndim))) * f
    present = modes.gain > 0
    share = xp.where(present, 1 / xp.where(present, modes.norm, 1.0), 0.0)[:, None]
    return xp.tensordot(share * modes.shape, lagging, axes=1) + xp.tensordot(
        share * law.viscosity, u[None], axes=1
    )
