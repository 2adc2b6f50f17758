"""One period of a rough line over one element: the exact contact step of every sample, for many velocities at once.

In steady sliding every element sees the same periodic history, so that one element is the whole line. With
e_k = exp(-h/tau_k), g_k = E_k (1-e_k) tau_k/h and S = E_inf + eta/h + sum g_k a step of length h = dx/v is

    u_free = u - (E_inf u + sum e_k f_k)/S,   u+ = max(u_free, w+),   f_k+ = e_k f_k + g_k (u+ - u),   q+ = S (u+ -
    u_free),

and the period starts at the highest point of the line, which touches in every steady motion: u = d there. The work of
that motion is summed exactly on demand: with z_k = h/tau_k and a_k = (1 - e_k)/z_k

    int q du = du [E_inf (u + u+)/2 + du (eta/h + sum E_k (1 - a_k)/z_k) + sum a_k f_k],

which over a period is what the branches dissipate along the same motion. Otherwise the rectangular rule serves. A
branch that is forgotten within a step, e_k = 0, has f_k = E_k tau_k du-/h from the step before: with eta holding its
E_k tau_k, it adds E_k tau_k^2 (du- - du)/h^2 in the brackets.
"""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .._runtime import Array, one_kernel
from .stretches import Stretches, recover

_UNROLL = 4  # steps in one turn of the compiled loop
_FADED = 128  # samples after contact from which the work within free steps is left out


class Lanes(NamedTuple):
    """The relaxation function of each lane; a lane is a velocity with its load or depth."""

    relaxed: Float[np.ndarray, ""]  # E_inf [Pa]
    moduli: Float[np.ndarray, "branches lanes"]  # E_k [Pa]
    times: Float[np.ndarray, "branches lanes"]  # tau_k [s], the longest first
    viscosity: Float[np.ndarray, " lanes"]  # eta [Pa s]
    second: Float[np.ndarray, " lanes"]  # theta, the sum of E tau^2 of branches that are part of eta [Pa s^2]


class Coefficients(NamedTuple):
    """What a step of each lane needs."""

    keep: Float[np.ndarray, "branches lanes"]  # e_k
    lost: Float[np.ndarray, "branches lanes"]  # 1 - e_k
    gain: Float[np.ndarray, "branches lanes"]  # g_k [Pa]
    give: Float[np.ndarray, " lanes"]  # 1/S [1/Pa]
    relaxed: Float[np.ndarray, ""]  # E_inf [Pa]
    held: Float[np.ndarray, "branches lanes"]  # a_k
    drag: Float[np.ndarray, " lanes"]  # eta/h + sum E_k (1 - a_k)/z_k [Pa]
    late: Float[np.ndarray, " lanes"]  # theta/h^2 [Pa]

    def of(self, lanes: np.ndarray) -> "Coefficients":
        """Those of some lanes."""
        return Coefficients(*(x if np.ndim(x) == 0 else x[..., lanes] for x in self))


class Swept(NamedTuple):
    """The end of a period, and sums over it."""

    branches: Float[Array, "branches lanes"]  # f_k at the end [Pa m, force per length]
    u: Float[Array, " lanes"]  # u at the end [m]
    work: Float[Array, " lanes"]  # int q du [Pa m^2]: exact, or by the rectangular rule
    load: Float[Array, " lanes"]  # sum of q
    sums: Float[Array, "slow lanes"]  # sum of f_k, of the slow branches
    touching: Float[Array, " lanes"]  # number of samples in contact


def coefficients(law: Lanes, step: Float[Array, " lanes"]) -> Coefficients:
    """Coefficients of steps of `step` seconds."""
    z = step / law.times
    lost = -np.expm1(-z)
    held = lost / z
    with np.errstate(over="ignore"):
        late = np.where(z < 1e-4, 0.5 - z / 6 + z**2 / 24, (z - lost) / z**2)  # (1 - a_k)/z_k
    gain = law.moduli * held
    dashpot = law.viscosity / step
    stiffness = law.relaxed + dashpot + gain.sum(axis=0)
    return Coefficients(
        np.exp(-z), lost, gain, 1 / stiffness, law.relaxed, held, dashpot + (law.moduli * late).sum(axis=0),
        law.second / step**2,
    )  # fmt: skip


@partial(jax.jit, static_argnames=("slow", "exact"))
def sweep(
    rise: Float[np.ndarray, " n"],  # heights against the highest [m], in the order in which an element meets them
    count: int,  # samples of the period
    stride: int,  # points of the line per sample
    depth: Float[np.ndarray, " lanes"],
    branches: Float[np.ndarray, "branches lanes"],  # f_k at the start
    by: Coefficients,
    free: Stretches | None,  # passes stretches that nothing can touch in one go
    slow: int,  # number of branches whose sums are needed, from the first on
    exact: bool,
) -> Swept:
    """Runs through one period from u = d.

    After the last height the first stands again. What follows it in `rise` is not read, so that lines of many lengths
    share what is compiled.
    """
    whole = one_kernel(partial(_sweep, slow=slow, exact=exact))
    return whole(rise, count, stride, depth, branches, by, free)


# `foundation.step` again, without what only indentation and impacts need: half the work, in a loop that XLA makes one
# kernel of. `tests/test_element.py` holds one against the other.
def _sweep(rise, count, stride, depth, branches, by: Coefficients, free: Stretches | None, slow: int, exact: bool):
    def one(i, state):
        f, u, du, work, load, sums, touching = state
        kept = by.keep * f
        loose = u - (by.relaxed * u + kept.sum(axis=0)) * by.give
        new = jnp.maximum(loose, rise[(i + 1) * stride] + depth)
        before, du = du, new - u
        after = (new - loose) / by.give
        mean = after
        if exact:
            mean = 0.5 * by.relaxed * (u + new) + by.drag * du + by.late * (before - du) + (by.held * f).sum(axis=0)
        f = kept + by.gain * du
        return f, new, du, work + mean * du, load + after, sums + f[:slow], touching + (after > 0)

    def steps(first, last, state):
        def several(i, state):
            for j in range(_UNROLL):
                state = one(first + _UNROLL * i + j, state)
            return state

        turns = (last - first) // _UNROLL
        state = jax.lax.fori_loop(0, turns, several, state)
        return jax.lax.fori_loop(first + turns * _UNROLL, last, one, state)

    def on(free, carry):
        """Passes the stretches that nothing touches, and then takes the steps of the next."""
        first, quiet, (f, u, du, work, load, sums, touching) = carry
        # Within its steps an element that has just been let go works still: the exact sum waits until that has faded.
        ready = length * quiet >= _FADED if exact else jnp.asarray(True)
        y = jnp.concatenate([(by.relaxed * u)[None], f])
        j, y, summed = recover(free, first, ready, y, depth, length, slow)
        fall = -(y[0] + (by.keep * y[1:]).sum(axis=0)) * by.give  # du of the next free step, that of the last nearly
        state = y[1:], y[0] / by.relaxed, jnp.where(j > first, fall, du), work, load, sums + summed, touching
        state = steps(length * j, jnp.minimum(length * (j + 1), count), state)
        return j + 1, jnp.where((state[-1] == touching).all(), quiet + 1, 0), state

    nothing = jnp.zeros_like(depth)
    state: Any = (branches, depth, nothing, nothing, nothing, jnp.zeros_like(branches[:slow]), nothing)
    if free is None:
        f, u, _, *sums = steps(0, count, state)
    else:
        length = count // free.highest.size
        f, u, _, *sums = jax.lax.while_loop(lambda s: s[0] < free.highest.size, partial(on, free), (0, 0, state))[-1]
    return Swept(f, u, *sums)
