"""Free recovery of an element, and the way between branch forces and recovery modes.

An element that carries no force recovers as a sum of exponentials, one per retardation
time lambda_j of its Kelvin chain: u = sum_j m_j, m_j' = c_j q - m_j/lambda_j (and u has
J_0 q besides), with c_j = J_j/lambda_j. A liquid has one more mode that does not
recover, c = phi, its rate zero. Branch k, with its dashpot at y_k = u - f_k/E_k,
follows the modes as

    y_k = sum_j Y_jk m_j,    Y_jk = lambda_j/(lambda_j - tau_k),

and the modes are orthogonal to each other in the dissipation of the dashpots, sum_k E_k
tau_k Y_ik Y_jk + eta = 0 for i /= j, since a dissipation and an energy that are
quadratic have common modes. So both ways are plain sums, derived here: no equation is
solved. Source of the modes: Gross 1953 (see `material.relaxation`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..arrays import xp
from ..checks import Array, is_traced, numpy_unless_traced
from ..material.relaxation import Relaxation, kelvin_and_gaps

if TYPE_CHECKING:
    from jaxtyping import Float

# of 1 - tau/lambda, where a branch without strength makes the two coincide
_NEAREST = 1e-60


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
    there = xp.asarray(chain.compliances) > 0
    rate = xp.where(there, 1 / xp.where(there, chain.times, 1.0), 0.0)
    gain = xp.where(there, chain.compliances * rate, 0.0)
    gap = rate[:, None] * gaps + xp.where(there, 0.0, 1.0)[:, None]
    if is_traced(law) or chain.fluidity > 0:
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
