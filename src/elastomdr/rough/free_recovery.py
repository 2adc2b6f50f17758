"""Free recovery of an element that nothing touches: in steps that are exact whatever
their length, and over stretches of many samples in one go.

**Steps.** A free step of length h moves u by du = -sum_i r_i F_i, with F_0 = E_inf u the force of
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

**Stretches.** With no contact a step of the element is linear, y+ = (diag(e) - g e^T/S) y, with y =
(E_inf u, f_1, ...), e = (1, e_1, ...) and g = (E_inf, g_1, ...). Scaled by sqrt(e/g)
the matrix is symmetric, diag(e) - s s^T/S with s = sqrt(e g). Its eigenvalues lie
between 0 and 1: y after n steps is a sum of modes that shrink as lambda^n, and so is u.
Every term of u is monotone, so that the sum of the lesser of its two ends bounds u from
below over the whole stretch. Where that stays above the highest point of the line
there, the stretch is passed in one go, to rounding as step by step; the work of a free
element within its steps, of second order in the step and zero in truth, is left out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..arrays import xp
from ..checks import Array, numpy_unless_traced
from ..material.relaxation import Relaxation, kelvin_and_gaps

if TYPE_CHECKING:
    from jaxtyping import Float, Int

_FORGOTTEN = 1e-24  # s_k below which a branch force leaves no trace after a step


@numpy_unless_traced
def rates_apart(law: Relaxation) -> Float[Array, "m m"]:
    """|1/tau_i - 1/lambda_j| [1/s] of root j (rows) and pole i, both the slowest first;
    m = 1 + number of branches.

    Pole 0 is the spring, whose rate is zero; branches without a modulus come last. The
    last root is infinite without a dashpot. All to full relative accuracy.
    """
    chain, gaps = kelvin_and_gaps(law)
    count = law.times.shape[0] + 1
    has_root = (xp.asarray(chain.compliances) > 0)[:, None]
    roots = xp.where(has_root, xp.asarray(chain.times)[:, None], 1.0)
    apart = xp.concatenate([1 / roots, xp.abs(gaps) / (roots * law.times)], axis=1)
    apart = xp.where(has_root, apart, xp.inf)
    missing = xp.full((max(0, count - apart.shape[0]), count), xp.inf)
    apart = xp.concatenate([apart, missing])[
        xp.argsort(xp.concatenate([apart[:, 0], missing[:, 0]]))
    ][:count]
    poles = xp.where(law.moduli > 0, 1 / law.times, xp.inf)
    return apart[:, xp.concatenate([xp.zeros(1, int), 1 + xp.argsort(poles)])]


@numpy_unless_traced
def weights(
    apart: Float[Array, "m m points"],  # see `rates_apart`
    times: Float[Array, "branches points"],  # in the order of `apart` [s]
    gain: Float[Array, "branches points"],  # g_k [Pa]; without a modulus last
    relaxed: Any,  # E_inf [Pa]
    step: Float[Array, " points"],  # h [s]
) -> tuple[Float[Array, " points"], Float[Array, "branches points"]]:
    """r_0 [1/Pa], by which a force that lasts moves u in a step, and r_k/r_0."""
    m = apart.shape[0]
    ever = xp.isfinite(apart)
    x = step * xp.where(ever, apart, 0.0)  # |z_i - h/lambda_j|
    rate = xp.concatenate([xp.zeros_like(step)[None], 1 / times])
    live = xp.concatenate([xp.ones_like(step)[None] > 0, gain > 0])
    pairs = live[:, None] & live & ~xp.eye(m, dtype=bool)[:, :, None]
    between = xp.where(pairs, -xp.expm1(-step * xp.abs(rate[:, None] - rate)), 1.0)
    lost = xp.where(ever, -xp.expm1(-x), 1.0)
    beyond_pole = x[xp.arange(m), xp.arange(m)]  # by how much root i lies beyond pole i
    late = step * rate + xp.concatenate(
        [xp.zeros_like(beyond_pole[:1]), xp.cumsum(beyond_pole, axis=0)[:-1]]
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


class FreeRecovery(NamedTuple):
    """Free motion over the equal stretches that a line is cut into; m = 1 + number of
    branches.
    """

    # the highest point of the line in each [m]
    highest: Float[np.ndarray, " stretches"]
    to_modes: Float[np.ndarray, "m m points"]  # y to the strengths of the modes
    from_modes: Float[np.ndarray, "m m points"]
    rate: Float[np.ndarray, "m points"]  # -log(lambda), per sample
    relaxed: Float[np.ndarray, ""]  # E_inf [Pa]

    def of(self, chosen: np.ndarray) -> "FreeRecovery":
        """Those of some points."""
        return self._replace(
            to_modes=self.to_modes[..., chosen],
            from_modes=self.from_modes[..., chosen],
            rate=self.rate[..., chosen],
        )


def free_recovery(
    rise: Float[np.ndarray, " n"], pieces: int, seen, lost, gain, give, relaxed
) -> FreeRecovery:
    """The maps of each point, from the coefficients of its steps (see
    `rough.period`).
    """
    point_count = give.size
    seen = np.maximum(np.concatenate([np.ones((1, point_count)), seen]), _FORGOTTEN)
    lost = np.concatenate([np.zeros((1, point_count)), lost])
    gain = np.concatenate([np.full((1, point_count), float(relaxed)), gain])
    s, live = np.sqrt(seen * gain), gain > 0
    scale = np.where(live, np.sqrt(seen / np.where(live, gain, 1.0)), 1.0)
    matrix = s.T[:, :, None] * (s * give).T[:, None]  # 1 less the step's matrix
    index = np.arange(s.shape[0])
    matrix[:, index, index] += lost.T
    vector = np.linalg.eigh(matrix)[1]  # point, component, mode
    # `eigh` leaves rounding of the fast modes in the slow ones. The matrix between its
    # vectors, summed from parts that are small where the modes are slow, tells how
    # much, and two steps of perturbation theory take it out.
    fall = np.zeros((point_count, s.shape[0]))
    for _ in range(2):
        stiff = (s.T[:, None] @ vector)[:, 0]
        rest = np.swapaxes(vector, 1, 2) @ (lost.T[:, :, None] * vector)
        rest = rest + stiff[:, :, None] * stiff[:, None] * give[:, None, None]
        fall = np.diagonal(rest, axis1=1, axis2=2)
        apart = fall[:, None] - fall[:, :, None]
        turn = np.where(
            np.abs(rest) < 0.1 * np.abs(apart),
            rest / np.where(apart == 0, 1.0, apart),
            0.0,
        )
        vector = vector + vector @ turn
    fall, vector = fall.T, np.moveaxis(vector, 0, -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = np.nan_to_num(-np.log1p(-fall), nan=700.0, posinf=700.0)
    highest = np.append(rise, rise[0])[1:].reshape(pieces, -1).max(axis=1)
    return FreeRecovery(
        highest,
        np.swapaxes(vector * scale[:, None], 0, 1),
        vector / scale[:, None],
        np.clip(rate, 1e-30, 700.0),
        np.asarray(relaxed),
    )


def recover(
    free: FreeRecovery,
    first: Int[Array, ""],
    y: Float[Array, "m points"],
    depth: Float[Array, " points"],
    samples: int,
    slow: int,
) -> tuple[Int[Array, ""], Float[Array, "m points"], Float[Array, "slow points"]]:
    """Recovers from `first` on for as many stretches, of `samples`, as nothing touches
    in any point.

    Returns the number of the next stretch, y before it, and the sum over the samples
    passed of the first `slow` branches.
    """
    shrink = jnp.exp(-samples * free.rate)
    # sum of lambda^n over a stretch; both differences are small together where the mode
    # is slow
    total = (
        jnp.exp(-free.rate) * jnp.expm1(-samples * free.rate) / jnp.expm1(-free.rate)
    )
    relaxed = free.relaxed

    def untouched(state):
        j, modes, _ = state
        parts = free.from_modes[0] * modes  # of E_inf u
        lowest = jnp.minimum(parts, parts * shrink).sum(axis=0)
        above = lowest > relaxed * (
            free.highest[jnp.minimum(j, free.highest.size - 1)] + depth
        )
        return (j < free.highest.size) & above.all()

    def one(state):
        j, modes, summed = state
        return j + 1, modes * shrink, summed + modes * total

    start = _times(free.to_modes, y)
    j, modes, summed = jax.lax.while_loop(
        untouched, one, (first, start, jnp.zeros_like(start))
    )
    # Modes do not hold the forces of branches that are forgotten within a step: in
    # contact y must stay as it is.
    end = jnp.where(j > first, _times(free.from_modes, modes), y)
    return j, end, _times(free.from_modes[1 : 1 + slow], summed)


def _times(
    matrix: Float[Array, "n m points"], vector: Float[Array, "m points"]
) -> Float[Array, "n points"]:
    """Matrix times vector in each point, as one sum: a reduction would pass through
    memory once more.
    """
    return sum(
        (matrix[:, j] * vector[j] for j in range(1, vector.shape[0])),
        matrix[:, 0] * vector[0],
    )
