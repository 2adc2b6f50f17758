"""Free recovery in steps, exact for every step: what the displacement without a force
takes of spring and branches.

A free step of length h moves u by du = -sum_i r_i F_i, with F_0 = E_inf u the force of
the spring and F_k = f_k those of the branches, and then F_i to p_i F_i + g_i du: p_0 =
1, g_0 = E_inf, p_k = exp(-h/tau_k), g_k = E_k (1 - p_k) tau_k/h. The matrix of the step
is diag(p) - g r^T. Here r is such that its eigenvalues are exp(-h/lambda_j), with the
retardation times lambda_j of the law (`material.relaxation.to_kelvin`): a free element
recovers at its own rates, whatever the step. No force at the end of each step instead,
r_i = p_i/S, would slow down what a dashpot or a branch shorter than the step holds
back. From det(x - diag(p) + g r^T) = prod_j (x - exp(-h/lambda_j)) at x = p_i,

    g_i r_i = prod_j (p_i - exp(-h/lambda_j)) / prod_{j /= i} (p_i - p_j).

All of them are positive, as the two kinds of times interlace. Branches that are
forgotten within a step have p_k = 0 and are left out, with as many of the shortest
retardation times. Derived here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..arrays import xp
from ..checks import Array, numpy_unless_traced
from ..material.relaxation import Relaxation, kelvin_and_gaps

if TYPE_CHECKING:
    from jaxtyping import Float


@numpy_unless_traced
def rates_apart(law: Relaxation) -> Float[Array, "m m"]:
    """|1/tau_i - 1/lambda_j| [1/s] of root j (rows) and pole i, both the slowest first;
    m = 1 + number of branches.

    Pole 0 is the spring, whose rate is zero; branches without a modulus come last. The
    last root is infinite without a dashpot. All to full relative accuracy.
    """
    chain, gaps = kelvin_and_gaps(law)
    count = law.times.shape[0] + 1
    there = (xp.asarray(chain.compliances) > 0)[:, None]
    roots = xp.where(there, xp.asarray(chain.times)[:, None], 1.0)
    apart = xp.concatenate([1 / roots, xp.abs(gaps) / (roots * law.times)], axis=1)
    apart = xp.where(there, apart, xp.inf)
    missing = xp.full((max(0, count - apart.shape[0]), count), xp.inf)
    apart = xp.concatenate([apart, missing])[
        xp.argsort(xp.concatenate([apart[:, 0], missing[:, 0]]))
    ][:count]
    poles = xp.where(law.moduli > 0, 1 / law.times, xp.inf)
    return apart[:, xp.concatenate([xp.zeros(1, int), 1 + xp.argsort(poles)])]


@numpy_unless_traced
def weights(
    apart: Float[Array, "m m lanes"],  # see `rates_apart`
    times: Float[Array, "branches lanes"],  # in the order of `apart` [s]
    gain: Float[Array, "branches lanes"],  # g_k [Pa]; without a modulus last
    relaxed: Any,  # E_inf [Pa]
    step: Float[Array, " lanes"],  # h [s]
) -> tuple[Float[Array, " lanes"], Float[Array, "branches lanes"]]:
    """r_0 [1/Pa], by which a force that lasts moves u in a step, and r_k/r_0."""
    m = apart.shape[0]
    ever = xp.isfinite(apart)
    x = step * xp.where(ever, apart, 0.0)  # |z_i - h/lambda_j|
    rate = xp.concatenate([xp.zeros_like(step)[None], 1 / times])
    live = xp.concatenate([xp.ones_like(step)[None] > 0, gain > 0])
    pairs = live[:, None] & live & ~xp.eye(m, dtype=bool)[:, :, None]
    between = xp.where(pairs, -xp.expm1(-step * xp.abs(rate[:, None] - rate)), 1.0)
    lost = xp.where(ever, -xp.expm1(-x), 1.0)
    own = x[xp.arange(m), xp.arange(m)]  # by how much root i lies beyond pole i
    late = step * rate + xp.concatenate(
        [xp.zeros_like(own[:1]), xp.cumsum(own, axis=0)[:-1]]
    )
    strength = (
        xp.exp(-late)
        * lost[xp.arange(m), xp.arange(m)]
        * xp.prod(xp.where(pairs, lost / between, 1.0), axis=0)
    )
    first = strength[0] / relaxed
    return first, xp.where(
        gain > 0, strength[1:] / xp.where(gain > 0, gain, 1.0), 0.0
    ) / first
