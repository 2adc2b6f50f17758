"""Free recovery of an element that nothing touches, in steps that are exact whatever
their length.

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

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..material.relaxation import Relaxation, kelvin_and_gaps

if TYPE_CHECKING:
    from jaxtyping import Float


class LineLaw(NamedTuple):
    """The relaxation function of an element, the slowest branch first."""

    relaxed: float  # E_inf [Pa]
    moduli: Float[np.ndarray, " branches"]  # E_k [Pa], all above zero
    times: Float[np.ndarray, " branches"]  # tau_k [s]
    viscosity: float  # eta [Pa s]
    # |1/tau_i - 1/lambda_j| [1/s] of root j (rows) and pole i, both the slowest first,
    # to full relative accuracy; pole 0 is the spring, whose rate is zero, and the last
    # root is infinite without a dashpot
    apart: Float[np.ndarray, "1+branches 1+branches"]


def line_law(law: Relaxation) -> LineLaw:
    """The law of the elements of a line."""
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    order = np.argsort(-times, kind="stable")
    order = order[moduli[order] > 0]
    moduli, times = moduli[order], times[order]
    relaxed, viscosity = np.asarray(law.equilibrium), np.asarray(law.viscosity)
    # the shortest first, as laws are given
    chain, gaps = kelvin_and_gaps(
        Relaxation(relaxed, moduli[::-1], times[::-1], viscosity)
    )
    roots = np.asarray(chain.times)[:, None]
    apart = np.full((times.size + 1, times.size + 1), np.inf)
    rates = np.concatenate([1 / roots, np.abs(gaps)[:, ::-1] / (roots * times)], axis=1)
    apart[: rates.shape[0]] = rates[np.argsort(rates[:, 0])]
    return LineLaw(float(relaxed), moduli, times, float(viscosity), apart)


def free_steps(
    law: LineLaw, gain: Float[np.ndarray, "branches points"], step: np.ndarray
) -> tuple[Float[np.ndarray, " points"], Float[np.ndarray, "branches points"]]:
    """r_0 [1/Pa], by which a force that lasts moves u in a step, and r_k/r_0, from g_k
    [Pa] and h [s], (points,).
    """
    every = np.arange(law.times.size + 1)
    ever = np.isfinite(law.apart)[:, :, None]
    x = step * np.where(ever, law.apart[:, :, None], 0.0)  # |z_i - h/lambda_j|
    rate = np.append(0.0, 1 / law.times)[:, None]
    others = every[:, None] != every
    apart = np.abs(rate - rate.T)[:, :, None]
    between = np.where(others[:, :, None], -np.expm1(-step * apart), 1.0)
    lost = np.where(ever, -np.expm1(-x), 1.0)
    beyond_pole = x[every, every]  # by how much root i lies beyond pole i
    late = step * rate
    late[1:] += np.cumsum(beyond_pole, axis=0)[:-1]
    strength = (
        np.exp(-late)
        * lost[every, every]
        * np.prod(np.where(others[:, :, None], lost / between, 1.0), axis=0)
    )
    first = strength[0] / law.relaxed
    return first, strength[1:] / gain / first
