"""One period of a rough line over one element: the exact contact step of every sample, for many velocities at once.

In steady sliding every element sees the same periodic history, so that one element is the whole line. With
e_k = exp(-h/tau_k), g_k = E_k (1-e_k) tau_k/h and S = E_inf + eta/h + sum g_k a step of length h = dx/v is

    u_free = u - (E_inf u + sum e_k f_k)/S,   u+ = max(u_free, w+),   f_k+ = e_k f_k + g_k (u+ - u),   q+ = S (u+ -
    u_free),

and the period starts at the highest point of the line, which touches in every steady motion: u = d there.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..material.relaxation import Relaxation

_UNROLL = 4  # steps in one turn of the compiled loop, twice as fast as one


class Coefficients(NamedTuple):
    """What a step of each lane needs; a lane is a velocity with its load or depth."""

    keep: Float[np.ndarray, "branches lanes"]  # e_k
    gain: Float[np.ndarray, "branches lanes"]  # g_k [Pa]
    give: Float[np.ndarray, " lanes"]  # 1/S [1/Pa]
    relaxed: Float[np.ndarray, ""]  # E_inf [Pa]


class Swept(NamedTuple):
    """The end of a period, and sums over it."""

    branches: Float[np.ndarray, "branches lanes"]  # f_k at the end [Pa m, force per length]
    u: Float[np.ndarray, " lanes"]  # u at the end [m]
    q: Float[np.ndarray, " lanes"]  # q at the end
    work: Float[np.ndarray, " lanes"]  # int q du, trapezoidal
    load: Float[np.ndarray, " lanes"]  # sum of q
    sums: Float[np.ndarray, "branches lanes"]  # sum of f_k
    touching: Float[np.ndarray, " lanes"]  # number of samples in contact


def coefficients(law: Relaxation, step: Float[np.ndarray, " lanes"]) -> Coefficients:
    """Coefficients of steps of `step` seconds."""
    z = step / np.asarray(law.times)[:, None]
    gain = np.asarray(law.moduli)[:, None] * -np.expm1(-z) / z
    stiffness = np.asarray(law.equilibrium) + np.asarray(law.viscosity) / step + gain.sum(axis=0)
    return Coefficients(np.exp(-z), gain, 1 / stiffness, np.asarray(law.equilibrium))


@jax.jit
def sweep(
    rise: Float[np.ndarray, " n"],  # heights against the highest, in the order in which an element meets them [m]
    count: int,  # samples of the period
    stride: int,  # points of the line per sample
    depth: Float[np.ndarray, " lanes"],
    force: Float[np.ndarray, " lanes"],  # q at the start, for the work of the first step
    branches: Float[np.ndarray, "branches lanes"],  # f_k at the start
    by: Coefficients,
) -> Swept:
    """Runs through one period from u = d."""
    n = rise.shape[0]

    def one(i, state):
        f, u, q, work, load, sums, touching = state
        kept = by.keep * f
        free = u - (by.relaxed * u + kept.sum(axis=0)) * by.give
        new = jnp.maximum(free, rise[(i + 1) * stride % n] + depth)
        du = new - u
        f = kept + by.gain * du
        after = (new - free) / by.give
        return f, new, after, work + 0.5 * (q + after) * du, load + after, sums + f, touching + (after > 0)

    def several(i, state):
        for j in range(_UNROLL):
            state = one(_UNROLL * i + j, state)
        return state

    nothing = jnp.zeros_like(depth)
    state = (branches, depth, force, nothing, nothing, jnp.zeros_like(branches), nothing)
    state = jax.lax.fori_loop(0, count // _UNROLL, several, state)
    return Swept(*jax.lax.fori_loop(count // _UNROLL * _UNROLL, count, one, state))
