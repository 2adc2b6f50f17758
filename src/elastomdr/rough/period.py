"""One period of a rough line over one element: the exact contact step of every sample,
for many velocities at once.

In steady sliding every element sees the same periodic history, so that one element is
the whole line. With e_k = exp(-h/tau_k) and g_k = E_k (1-e_k) tau_k/h a step of length
h = dx/v is

    u_free = u - r_0 (E_inf u + sum s_k f_k),
    u+ = max(u_free, w+),
    f_k+ = e_k f_k + g_k (u+ - u),
    q+ = (u+ - u_free)/r_0,

with r_0 and s_k such that a free element recovers exactly (`rough.free_recovery`), and
the period starts at the highest point of the line, which touches in every steady
motion: u = d there. Over a period the sum of q is that of E_inf u.

While the state is searched the work is the sum of q+ du. That of its motion is summed
on demand: with z_k = h/tau_k and a_k = (1 - e_k)/z_k, for u straight over the step,

    int q du = du [E_inf (u + u+)/2 + du (eta/h + sum E_k (1 - a_k)/z_k) + sum a_k f_k],

none in a step that is free from end to end, and what bends add where contact begins or
ends (`rough.periodic_state`). A branch that is forgotten within a step, e_k = 0, has
f_k = E_k tau_k du-/h from the step before: with eta holding its E_k tau_k, it adds E_k
tau_k^2 (du- - du)/h^2 in the brackets.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, one_kernel
from .free_recovery import FreeRecovery, recover, weights

if TYPE_CHECKING:
    from jaxtyping import Float

_FORGOTTEN = 1e-200
# the highest point touches as the period begins; how hard is not known yet
PUSHED = 1e-300
_UNROLL = 4  # steps in one turn of the compiled loop


class PointLaws(NamedTuple):
    """The relaxation function of each point; a point is a velocity with its load or
    depth.
    """

    relaxed: Float[np.ndarray, ""]  # E_inf [Pa]
    moduli: Float[np.ndarray, "branches points"]  # E_k [Pa]
    times: Float[np.ndarray, "branches points"]  # tau_k [s], the longest first
    viscosity: Float[np.ndarray, " points"]  # eta [Pa s]
    # theta, the sum of E tau^2 of branches that are part of eta [Pa s^2]
    second: Float[np.ndarray, " points"]
    # of the rates, see `rough.free_recovery` [1/s]
    apart: Float[np.ndarray, "1+branches 1+branches points"]


class PointCoefficients(NamedTuple):
    """What a step of each point needs."""

    keep: Float[np.ndarray, "branches points"]  # e_k
    seen: Float[np.ndarray, "branches points"]  # s_k
    lost: Float[np.ndarray, "branches points"]  # 1 - e_k
    gain: Float[np.ndarray, "branches points"]  # g_k [Pa]
    give: Float[np.ndarray, " points"]  # 1/S [1/Pa]
    relaxed: Float[np.ndarray, ""]  # E_inf [Pa]
    held: Float[np.ndarray, "branches points"]  # a_k
    drag: Float[np.ndarray, " points"]  # eta/h + sum E_k (1 - a_k)/z_k [Pa]
    late: Float[np.ndarray, " points"]  # theta/h^2 [Pa]
    each: Float[np.ndarray, "branches points"]  # E_k (1 - a_k)/z_k [Pa]

    def of(self, chosen: np.ndarray) -> "PointCoefficients":
        """Those of some points."""
        return PointCoefficients(
            *(x if np.ndim(x) == 0 else x[..., chosen] for x in self)
        )


class Swept(NamedTuple):
    """The end of a period, and sums over it."""

    branches: Float[Array, "branches points"]  # f_k at the end [Pa m, force per length]
    u: Float[Array, " points"]  # u at the end [m]
    work: Float[
        Array, " points"
    ]  # int q du [Pa m^2]: exact, or by the rectangular rule
    load: Float[Array, " points"]  # sum of q
    sums: Float[Array, "slow points"]  # sum of f_k, of the slow branches
    touching: Float[Array, " points"]  # number of samples in contact
    # of (height of u over the line)(depth below u_free), before and after [m^2]
    struck: Float[Array, " points"]
    begun: Float[Array, " points"]  # number of contacts; these two if exact


def coefficients(law: PointLaws, step: Float[Array, " points"]) -> PointCoefficients:
    """Coefficients of steps of `step` seconds."""
    z = step / law.times
    lost = -np.expm1(-z)
    held = lost / z
    with np.errstate(over="ignore"):
        # (1 - a_k)/z_k
        late = np.where(z < 1e-4, 0.5 - z / 6 + z**2 / 24, (z - lost) / z**2)
    gain = law.moduli * held
    dashpot, second = law.viscosity / step, law.second / step**2
    give, seen = map(np.asarray, weights(law.apart, law.times, gain, law.relaxed, step))
    each = law.moduli * late
    return PointCoefficients(
        np.exp(-z),
        seen,
        lost,
        gain,
        give,
        law.relaxed,
        held,
        dashpot + each.sum(axis=0),
        second,
        each,
    )


@partial(jax.jit, static_argnames=("slow", "exact"))
def sweep(
    # heights against the highest [m], in the order in which an element meets them
    rise: Float[np.ndarray, " n"],
    count: int,  # samples of the period
    stride: int,  # points of the line per sample
    depth: Float[np.ndarray, " points"],
    branches: Float[np.ndarray, "branches points"],  # f_k at the start
    by: PointCoefficients,
    free: FreeRecovery | None,  # passes stretches that nothing can touch in one go
    slow: int,  # number of branches whose sums are needed, from the first on
    exact: bool,
) -> Swept:
    """Runs through one period from u = d.

    After the last height the first stands again. What follows it in `rise` is not read,
    so that lines of many lengths share what is compiled.
    """
    whole = one_kernel(partial(_sweep, slow=slow, exact=exact))
    return whole(rise, count, stride, depth, branches, by, free)


# `element.contact_step` again, without what only indentation and impacts need: half the
# work, in a loop that XLA makes one kernel of. `tests/element/test_element.py` holds one
# against the other.
def _sweep(
    rise,
    count,
    stride,
    depth,
    branches,
    by: PointCoefficients,
    free: FreeRecovery | None,
    slow: int,
    exact: bool,
):
    # The loop holds r_k f_k/e_k, so that what is left of it after a step sums up to
    # what a free element moves: a sum with factors of its own XLA would do twice.
    keep = jnp.maximum(by.keep, _FORGOTTEN)
    scale = jnp.maximum(by.seen, _FORGOTTEN) / keep * by.give
    gain, held, stays = scale * by.gain, by.held / scale, 1 - by.relaxed * by.give

    def one(i, state):
        f, u, du, push, work, load, sums, touching, struck, begun = state
        kept = keep * f
        loose = stays * u - kept.sum(axis=0)
        w = rise[(i + 1) * stride] + depth
        new = jnp.maximum(loose, w)
        last, du = du, new - u
        free, last_push, push = push <= 0, push, new - loose
        q = push / by.give
        mean = q
        if exact:
            mean = (
                0.5 * by.relaxed * (u + new)
                + by.drag * du
                + by.late * (last - du)
                + (held * f).sum(axis=0)
            )
            mean = jnp.where(free & (q <= 0), 0.0, mean)
            struck = (
                struck + (u - (rise[i * stride] + depth)) * push + (new - w) * last_push
            )
            begun = begun + (free & (q > 0))
        work = work + mean * du
        f = kept + gain * du
        return (
            f,
            new,
            du,
            push,
            work,
            load + q,
            sums + f[:slow],
            touching + (q > 0),
            struck,
            begun,
        )

    def steps(first, last, state):
        def several(i, state):
            for j in range(_UNROLL):
                state = one(first + _UNROLL * i + j, state)
            return state

        turns = (last - first) // _UNROLL
        state = jax.lax.fori_loop(0, turns, several, state)
        return jax.lax.fori_loop(first + turns * _UNROLL, last, one, state)

    def on(free, carry):
        """Passes the stretches that nothing touches, and then takes the steps of the
        next.
        """
        first, (f, u, du, push, work, load, sums, *counts) = carry
        y = jnp.concatenate([(by.relaxed * u)[None], f / scale])
        # a step in which contact ends takes work: none is passed
        above = jnp.where(push > 0, jnp.inf, depth)
        j, y, summed = recover(free, first, y, above, length, slow)
        passed = j > first
        # du of the next free step, that of the last nearly
        fall = -(y[0] + (by.seen * y[1:]).sum(axis=0)) * by.give
        state = (
            scale * y[1:],
            y[0] / by.relaxed,
            jnp.where(passed, fall, du),
            jnp.where(passed, 0.0, push),
            work,
            load,
        )
        state = *state, sums + scale[:slow] * summed, *counts
        return j + 1, steps(length * j, jnp.minimum(length * (j + 1), count), state)

    nothing = jnp.zeros_like(depth)
    pushed = jnp.full_like(depth, PUSHED)
    none = jnp.zeros_like(branches[:slow])
    state: Any = (
        scale * branches,
        depth,
        nothing,
        pushed,
        nothing,
        nothing,
        none,
        nothing,
        nothing,
        nothing,
    )
    if free is None:
        state = steps(0, count, state)
    else:
        length = count // free.highest.size
        state = jax.lax.while_loop(
            lambda s: s[0] < free.highest.size, partial(on, free), (0, state)
        )[-1]
    f, u, _, _, work, load, sums, *counts = state
    return Swept(f / scale, u, work, load, sums / scale[:slow], *counts)


class PeriodMotion(NamedTuple):
    """One period of an element, from the highest point of the line on."""

    surface: Float[Array, "n points"]  # u [m]
    force: Float[Array, "n points"]  # q [N/m]


@jax.jit
def motion(
    rise: Float[Array, " n"],
    depth: Float[Array, " points"],
    branches: Float[Array, "branches points"],
    by: PointCoefficients,
) -> PeriodMotion:
    """u and q at each sample of a period that begins with the branch forces f_k at the
    highest point, where u = d.
    """

    def one(state, w):
        f, u = state
        loose = u - (by.relaxed * u + (by.seen * f).sum(axis=0)) * by.give
        new = jnp.maximum(loose, w + depth)
        return (by.keep * f + by.gain * (new - u), new), (new, (new - loose) / by.give)

    path = jax.lax.scan(one, (branches, depth), jnp.roll(rise, -1))[1]
    return PeriodMotion(*(jnp.roll(field, 1, axis=0) for field in path))
