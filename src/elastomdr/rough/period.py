"""One period of a rough line over one element: the exact contact step of every sample,
for many velocities at once.

In steady sliding every element sees the same periodic history, so that one element is
the whole line. With e_k = exp(-h/tau_k) and g_k = E_k (1-e_k) tau_k/h a step of length
h = dx/v is

    u_free = u - r_0 (E_inf u + sum s_k f_k),
    u+ = max(u_free, w+),
    f_k+ = e_k f_k + g_k (u+ - u),
    q+ = (u+ - u_free)/r_0,

with r_0 and s_k such that a free element recovers exactly (`rough.free_steps`), and the
period starts at the highest point of the line, which touches in every steady motion: u
= d there. Over a period the sum of q is that of E_inf u.

While the state is searched the work is the sum of q+ du. That of its motion is summed
on demand: with z_k = h/tau_k and a_k = (1 - e_k)/z_k, for u straight over the step,

    int q du = du [E_inf (u + u+)/2 + du (eta/h + sum E_k (1 - a_k)/z_k) + sum a_k f_k],

none in a step that is free from end to end, and what bends add where contact begins or
ends (`rough.periodic_state`).
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, one_kernel
from .free_steps import LineLaw, free_steps

if TYPE_CHECKING:
    from jaxtyping import Float

_FORGOTTEN = 1e-200
# the highest point touches as the period begins; how hard is not known yet
_PUSHED = 1e-300
_Pair = tuple[Array, Array]  # branch forces and u
_UNROLL = 4  # steps in one turn of the compiled loop


class PointCoefficients(NamedTuple):
    """What a step of each point needs; a point is a velocity with its load or depth."""

    keep: Float[np.ndarray, "branches points"]  # e_k
    seen: Float[np.ndarray, "branches points"]  # s_k
    gain: Float[np.ndarray, "branches points"]  # g_k [Pa]
    give: Float[np.ndarray, " points"]  # r_0 [1/Pa]
    relaxed: Float[np.ndarray, ""]  # E_inf [Pa]
    held: Float[np.ndarray, "branches points"]  # a_k
    drag: Float[np.ndarray, " points"]  # eta/h + sum E_k (1 - a_k)/z_k [Pa]
    each: Float[np.ndarray, "branches points"]  # E_k (1 - a_k)/z_k [Pa]

    def of(self, chosen: np.ndarray) -> PointCoefficients:
        """Those of some points."""
        return PointCoefficients(
            *(x if np.ndim(x) == 0 else x[..., chosen] for x in self)
        )


class Swept(NamedTuple):
    """The end of a period, and sums over it."""

    branches: Float[Array, "branches points"]  # f_k at the end [Pa m, force per length]
    u: Float[Array, " points"]  # u at the end [m]
    # int q du [Pa m^2]: exact, or by the rectangular rule
    work: Float[Array, " points"]
    load: Float[Array, " points"]  # sum of q
    sums: Float[Array, "slow points"]  # sum of f_k, of the slow branches
    touching: Float[Array, " points"]  # number of samples in contact
    # of (height of u over the line)(depth below u_free), before and after [m^2]
    struck: Float[Array, " points"]
    begun: Float[Array, " points"]  # number of contacts; these two if exact


def coefficients(law: LineLaw, step: Float[np.ndarray, " points"]) -> PointCoefficients:
    """Coefficients of steps of `step` seconds."""
    z = step / law.times[:, None]
    held = -np.expm1(-z) / z
    moduli = law.moduli[:, None]
    late = np.where(z < 1e-4, 0.5 - z / 6 + z**2 / 24, (1 - held) / z)  # (1 - a_k)/z_k
    gain = moduli * held
    give, seen = free_steps(law, gain, step)
    each = moduli * late
    return PointCoefficients(
        keep=np.exp(-z),
        seen=seen,
        gain=gain,
        give=give,
        relaxed=np.asarray(law.relaxed),
        held=held,
        drag=law.viscosity / step + each.sum(axis=0),
        each=each,
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
    slow: int,  # number of branches whose sums are needed, from the first on
    exact: bool,
) -> Swept:
    """Runs through one period from u = d.

    After the last height the first stands again. What follows it in `rise` is not read,
    so that lines of many lengths share what is compiled.
    """
    whole = one_kernel(partial(_sweep, slow=slow, exact=exact))
    return whole(rise, count, stride, depth, branches, by)


# `element.contact_step` again, without what only indentation and impacts need: half the
# work, in a loop that XLA makes one kernel of. `tests/element/test_element.py` holds one
# against the other.
def _sweep(
    rise: Array,
    count: int,
    stride: int,
    depth: Array,
    branches: Array,
    by: PointCoefficients,
    slow: int,
    exact: bool,
) -> Swept:
    # The loop holds r_k f_k/e_k, so that what is left of it after a step sums up to
    # what a free element moves: a sum with factors of its own XLA would do twice.
    keep = jnp.maximum(by.keep, _FORGOTTEN)
    scale = jnp.maximum(by.seen, _FORGOTTEN) / keep * by.give
    gain, held, stays = scale * by.gain, by.held / scale, 1 - by.relaxed * by.give

    def one(i: Array, state: tuple[Array, ...]) -> tuple[Array, ...]:
        f, u, push, work, load, sums, touching, struck, begun = state
        kept = keep * f
        loose = stays * u - kept.sum(axis=0)
        w = rise[(i + 1) * stride] + depth
        new = jnp.maximum(loose, w)
        du = new - u
        free, last_push, push = push <= 0, push, new - loose
        q = push / by.give
        mean = q
        if exact:
            mean = 0.5 * by.relaxed * (u + new) + by.drag * du + (held * f).sum(axis=0)
            mean = jnp.where(free & (q <= 0), 0.0, mean)
            struck = (
                struck + (u - (rise[i * stride] + depth)) * push + (new - w) * last_push
            )
            begun = begun + (free & (q > 0))
        f = kept + gain * du
        return (
            f,
            new,
            push,
            work + mean * du,
            load + q,
            sums + f[:slow],
            touching + (q > 0),
            struck,
            begun,
        )

    def several(i: Array, state: tuple[Array, ...]) -> tuple[Array, ...]:
        for j in range(_UNROLL):
            state = one(_UNROLL * i + j, state)
        return state

    nothing = jnp.zeros_like(depth)
    state = (
        scale * branches,
        depth,
        jnp.full_like(depth, _PUSHED),
        nothing,
        nothing,
        jnp.zeros_like(branches[:slow]),
        nothing,
        nothing,
        nothing,
    )
    turns = count // _UNROLL
    state = jax.lax.fori_loop(0, turns, several, state)
    f, u, _, work, load, sums, *counts = jax.lax.fori_loop(
        turns * _UNROLL, count, one, state
    )
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

    def one(state: _Pair, w: Array) -> tuple[_Pair, _Pair]:
        f, u = state
        loose = u - (by.relaxed * u + (by.seen * f).sum(axis=0)) * by.give
        new = jnp.maximum(loose, w + depth)
        return (by.keep * f + by.gain * (new - u), new), (new, (new - loose) / by.give)

    path = jax.lax.scan(one, (branches, depth), jnp.roll(rise, -1))[1]
    return PeriodMotion(*(jnp.roll(field, 1, axis=0) for field in path))
