"""The exact contact step: independent viscoelastic elements under a rigid body.

One element of displacement u carries the force density q = E_inf u + eta u' + sum_k
f_k, f_k' = E_k u' - f_k/tau_k, under Signorini's conditions q >= 0, u >= w(t), q (u -
w) = 0, with w(t) the place of the rigid surface (Popov & Hess 2015, ch. 7). Over a step
h the displacement is taken as linear; all else is then exact, for every h:

    f_k+ = e_k f_k + E_k phi_k (u+ - u),    e_k = exp(-h/tau_k),    phi_k = (1 - e_k) tau_k/h,

the force at the end is linear in u+, so that u+ = max(u_free, w+) decides about
contact, u_free being the displacement that needs no force, and int q dt, int q du are
closed forms. Kelvin elements (`Foundation.kelvin`: no branch, a dashpot) and Maxwell
elements (`Foundation.maxwell`: one branch, E_inf = 0) are the smallest cases.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arrays import on_numpy, tree_map, xp
from ..checks import Array, whole_number
from ..material.relaxation import AbstractRelaxation
from ..numerics.decay import phi1, phi2

if TYPE_CHECKING:
    from jaxtyping import Float

_WRITTEN_OUT = 32  # branches up to which sums over them are


class Elements(NamedTuple):
    """State of n elements with k branches each; the integrals count from `rest`.
    Layers: Pa in place of Pa m.
    """

    u: Float[Array, " n"]  # displacement, positive into the material [m]
    f: Float[Array, "k n"]  # force densities f_k of the branches [Pa m]
    # contact force density, zero out of contact; with a dashpot see `contact_step` [Pa
    # m]
    q: Float[Array, " n"]
    velocity: Float[Array, " n"]  # mean of u' over the last step [m/s]
    impulse: Float[Array, " n"]  # int q dt [Pa m s]
    work: Float[Array, " n"]  # int q du [Pa m^2]
    # int (q - E_inf u) du: keeps its digits where little is lost [Pa m^2]
    inelastic: Float[Array, " n"]
    stored: Float[Array, " n"]  # energy in the branches, sum f_k^2/(2 E_k) [Pa m^2]
    # time since the element was last in contact, or since the start [s]
    away: Float[Array, " n"]


class Coefficients(NamedTuple):
    """What a step of given length needs of the law: arrays (n,) or (1,), those of the
    branches (k, n) or (k, 1).
    """

    h: Array  # step [s]
    equilibrium: Array  # E_inf
    rate: Array  # eta/h
    decay: Array  # e_k
    mean: Array  # phi_k, the mean of a decaying f_k over the step
    gain: Array  # E_k phi_k
    energy: Array  # 1/(2 E_k), zero for an empty branch
    seen: Array  # share of f_k in the force on which Signorini's conditions are put
    stiffness: Array  # S, change of that force per change of u
    end: Array  # change of the force at the end per change of u
    drag: Array  # change of the mean force of branches and dashpot per change of u
    blow: Array  # loss of branches and dashpot on a ramp, per square of the change of u


class Fading(NamedTuple):
    """What is left of the branch forces in a step in which u stays where it is, summed
    over the branches, (n,).
    """

    seen: Array  # in the force on which Signorini's conditions are put
    mean: Array  # over the step
    end: Array | None  # at its end, unless that is the first


class Pressed(NamedTuple):
    """What Signorini's conditions make of the end of a step."""

    pushed: Array  # change of u were the element to follow the surface
    recovery: Array  # change of u without a force at the end
    contact: Array
    change: Array  # of u
    q: Array  # force density at the end, zero out of contact


def rest(law: AbstractRelaxation, n: int) -> Elements:
    """n elements that have never been touched, the state y0 of a `RigidSurface`.

    `law` says how many branches they have. Raises `InputError`.
    """
    whole_number("n", n, 1)
    zero = xp.zeros(n)
    return Elements(zero, xp.zeros((law.moduli.shape[0], n)), *[zero] * 7)


def contact_step(
    law: AbstractRelaxation,
    state: Elements,
    w_start: Array,
    w_end: Array,
    h: Array | float,
) -> Elements:
    """The state after a step h [s] in which the rigid surface moves from `w_start` to
    `w_end` [m, shape (n,)].

    Signorini's conditions hold at the end to rounding, with q+ = S (u+ - u_free),
    whatever the step, and `work` never falls behind the energy stored, E_inf u^2/2 +
    sum f_k^2/(2 E_k). Second order in h. `h` is a scalar or (n,); the law's times may
    be (k, n) and its other numbers (n,), one law per element.

    Without a dashpot q+ is the force at the end, E_inf u+ + sum f_k+. A dashpot knows
    eta u' only as a mean over the step; beside end values of the rest it would recover
    from contact at first order only. So with a dashpot q is the mean over the part of
    the step that the dashpot remembers, weight exp(-(h - t) K/eta), K = E_inf + sum E_k
    phi_k: a Kelvin element recovers exactly, u+ = u exp(-E h/eta), and a long step sees
    its end alone.
    """
    return advance(coefficients(law, h), state, w_start, w_end)


def coefficients(
    law: AbstractRelaxation, h: Array | float, *, viscous: bool = True
) -> Coefficients:
    """Coefficients of `contact_step`, to full relative accuracy whatever h/tau_k.

    `viscous=False` is for a law whose viscosity is known to be zero: equal sums over
    branches are then computed once.
    """
    width: Array = xp.atleast_1d(xp.asarray(h))
    moduli, times = _by_element(law.moduli), _by_element(law.times)
    equilibrium = xp.atleast_1d(xp.asarray(law.equilibrium))
    viscosity = xp.atleast_1d(xp.asarray(law.viscosity))
    y = width[None] / times
    rate, decay, mean, half = viscosity / width, xp.exp(-y), phi1(y), phi2(y)
    gain = moduli * mean
    static = equilibrium + xp.sum(gain, axis=0)
    seen, stiffness = (
        _signorini(static, viscosity, y, decay, width) if viscous else (decay, static)
    )
    return Coefficients(
        h=width,
        equilibrium=equilibrium,
        rate=rate,
        decay=decay,
        mean=mean,
        gain=gain,
        energy=xp.where(moduli > 0, 0.5 / xp.where(moduli > 0, moduli, 1.0), 0.0),
        seen=seen,
        stiffness=stiffness,
        end=static + rate,
        drag=xp.sum(moduli * half, axis=0) + rate,
        blow=xp.sum(moduli * (half - 0.5 * mean**2), axis=0) + rate,
    )


def coefficients_of_steps(
    law: AbstractRelaxation, h: Float[Array, " steps"], *, viscous: bool = True
) -> Coefficients:
    """`coefficients` of all steps of a march at once, with the steps along the first
    axis of each field.
    """
    c = coefficients(law, h, viscous=viscous)
    return tree_map(
        lambda x: xp.moveaxis(xp.broadcast_to(x, (*x.shape[:-1], h.size)), -1, 0)[
            ..., None
        ],
        c,
    )


def fade(c: Coefficients, f: Float[Array, "k n"]) -> Fading:
    """The sums over the branches that a step needs beforehand."""
    seen, mean = over_branches(c.seen * f), over_branches(c.mean * f)
    return Fading(seen, mean, None if c.decay is c.seen else over_branches(c.decay * f))


def advance(
    c: Coefficients,
    state: Elements,
    w_start: Array,
    w_end: Array,
    fading: Fading | None = None,
    keep: Callable[..., Any] = lambda function, *args: function(*args),
) -> Elements:
    """`contact_step` with its coefficients, and `fade` if it is known, at hand; `keep`
    as in `if_so`.
    """
    u, f = state.u, state.f
    fading = fade(c, f) if fading is None else fading
    pushed, recovery, contact, change, q = pressed(c, u, fading.seen, w_end - u, keep)
    free = ~contact & (state.q <= 0)
    end = xp.where(contact, w_end, xp.maximum(u + recovery, w_end))
    f_end = c.decay * f + c.gain * change
    stored = keep(lambda f: over_branches(c.energy * f**2), f_end)
    work, impulse, kept = _integrals(c, state, fading, change, pushed, free)
    # A surface that comes from a distance strikes within the step. To a dashpot that is
    # a shorter, faster motion: with contact from theta h on, the mean of u'^2 grows by
    # theta (1 - theta) (jump of u')^2.
    struck = xp.where(contact & (u > w_start), (u - w_start) * (pushed - recovery), 0.0)
    # Where the work is an estimate (contact lost within the step, free recovery), it
    # must not gain energy.
    inelastic = (
        state.inelastic + xp.maximum(work, stored - state.stored) + c.blow * struck
    )
    return Elements(
        u=end,
        f=f_end,
        q=q,
        velocity=change / c.h,
        impulse=state.impulse + impulse,
        work=inelastic + 0.5 * c.equilibrium * end**2,
        inelastic=inelastic,
        stored=stored,
        away=xp.where(contact, 0.0, state.away) + c.h * (1 - kept),
    )


def released(c: Coefficients, u: Array, seen: Array) -> Array:
    """u_free [m]: the displacement at the end of the step that needs no force; `seen`
    as in `Fading`.
    """
    return u - (c.equilibrium * u + seen) / c.stiffness


def pressed(
    c: Coefficients,
    u: Array,
    seen: Array,
    pushed: Array,
    keep: Callable[..., Any] = lambda function, *args: function(*args),
) -> Pressed:
    """Signorini's conditions at the end of a step in which the surface would push the
    elements by `pushed`.
    """
    standing_force = c.equilibrium * u + seen  # force if u stays where it is
    recovery = -standing_force / c.stiffness
    contact = pushed > recovery
    change = keep(xp.where, contact, pushed, recovery)
    q = xp.where(contact, xp.maximum(standing_force + c.stiffness * pushed, 0.0), 0.0)
    return Pressed(pushed, recovery, contact, change, q)


def lag(c: Coefficients) -> Array:
    """How far before the end of a step its force belongs, as a part of the step: 0
    without a dashpot, else up to 1/2.

    With a dashpot the force is a mean over the step with the weight exp(-(h - t) K/eta)
    (`contact_step`), whose centre is 1/z - 1/(exp(z) - 1) before the end, z = h K/eta.
    """
    rate, static = c.rate[0], (c.end - c.rate)[0]
    z = static / xp.where(rate > 0, rate, 1.0)
    small, large = xp.minimum(z, 0.1), xp.maximum(z, 0.1)
    series = 0.5 - small / 12 + small**3 / 720 - small**5 / 30240
    centre = xp.where(z < 0.1, series, 1 / large + xp.exp(-large) / xp.expm1(-large))
    return xp.where(rate > 0, centre, 0.0)


def _integrals(
    c: Coefficients,
    state: Elements,
    fading: Fading,
    change: Array,
    pushed: Array,
    free: Array,
) -> tuple[Array, ...]:
    """int (q - E_inf u) du and int q dt over a step, and the fraction of the step that
    the element was in contact.
    """
    u, faded = state.u, fading.mean
    drag, spring = faded + c.drag * change, c.equilibrium * (u + 0.5 * change)

    # The straight path is exact where the element follows the surface, or is pushed
    # down by it. Where following the surface to the end would take tension, contact has
    # ended when the force, linear in time, passed zero. A dashpot feels the surface
    # bend, not only its mean slope; twice the slope or its reverse is taken for a kink.
    bend = pushed - state.velocity * c.h
    bend = xp.where(xp.abs(bend) < xp.abs(pushed), bend, 0.0)
    mean = c.equilibrium * (u + 0.5 * pushed) + faded + c.drag * pushed
    end = fading.seen if fading.end is None else fading.end
    last = c.equilibrium * u + end + c.end * pushed + 0.5 * c.rate * bend
    first = xp.maximum(2 * mean - last, 0.0)
    lost = ~free & (last < 0)
    kept = xp.where(
        lost, first / xp.where(lost, first - last, 1.0), xp.where(free, 0.0, 1.0)
    )
    area = 0.5 * first * kept

    work = xp.where(lost, area * pushed, (drag + spring) * change)
    impulse = xp.where(lost, area, drag + spring) * c.h
    # An element that recovers freely feels no force, though on the straight path
    # between two instants it would.
    return (
        xp.where(free, 0.0, work) - spring * change,
        xp.where(free, 0.0, impulse),
        kept,
    )


def _signorini(
    static: Array, viscosity: Array, y: Array, decay: Array, h: Array
) -> tuple[Array, Array]:
    """`seen` and S of the force that Signorini's conditions are put on.

    With z = h K/eta the mean of exp(-t/tau_k) under the weight exp(-(h - t) K/eta) is
    seen_k = z (exp(-y_k) - exp(-z)) / ((z - y_k) (1 - exp(-z))), and S = K/(1 -
    exp(-z)). Without a dashpot z is infinite and both are values at the end of the
    step; without stiffness z is zero and they are plain means.
    """
    present = viscosity > 0
    z = h * static / xp.where(present, viscosity, 1.0)
    stiffness = xp.where(present, viscosity / h / phi1(z), static)
    # 1/z without a dashpot: zero, but what is seen has a derivative by the viscosity
    # there too.
    inverse = xp.where(present, 0.0, viscosity) / xp.where(static > 0, h * static, 1.0)
    z, inverse, present = z[None], inverse[None], present[None]
    seen = xp.exp(-xp.minimum(y, z)) * phi1(xp.abs(z - y)) / phi1(z)
    return xp.where(present, seen, decay * (1 + y * inverse)), stiffness


def if_so(condition: Array, function: Callable[..., Any], *args: Any) -> Any:
    """`function(*args)`, or zeros in its place, as a branch of the compiled program.

    With a condition that always holds, the compiler computes it once. Otherwise it
    would put sums over the branches, and what each branch needs, into every place that
    uses them.
    """
    if on_numpy():
        return function(*args)
    import jax

    return jax.lax.cond(
        condition, function, functools.partial(zeros_of, function), *args
    )


def zeros_of(function: Callable[..., Any], *args: Any) -> Any:
    import jax

    return jax.tree.map(
        lambda x: xp.zeros(x.shape, x.dtype), jax.eval_shape(function, *args)
    )


def over_branches(parts: Float[Array, "k n"]) -> Float[Array, " n"]:
    """Sum over the branches; written out, since compiled reductions over the slow axis
    take several times as long.
    """
    if on_numpy() or not 0 < parts.shape[0] <= _WRITTEN_OUT:
        return xp.sum(parts, axis=0)
    total = parts[0]
    for following in parts[1:]:
        total = total + following
    return total


def _by_element(branches: Array) -> Array:
    """(k,) as (k, 1), (k, n) as it is."""
    branches = xp.asarray(branches)
    return branches[:, None] if branches.ndim == 1 else branches
