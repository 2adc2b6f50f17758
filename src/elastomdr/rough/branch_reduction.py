"""Which branches a velocity on a rough line need not carry one by one: each point has a
window of its own.

A branch that is all but forgotten within a step of length h is a dashpot of viscosity E
tau, exactly so in the discretised motion. Branches much slower than the period T of the
line are lumped into one with their sum of E_k and of E_k/tau_k; what that leaves is E
(T/2 pi tau)^2 in the stiffness and E (T/2 pi tau)^3 in the loss, compared with the
relaxed stiffness and with the loss of the rest at its mean over the wavelengths of the
line.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from ..material.relaxation import Relaxation
from .free_recovery import rates_apart
from .period import PointLaws

if TYPE_CHECKING:
    from jaxtyping import Float

# h/tau from which exp(-h/tau) leaves less than 1e-8 of a branch's force after a step
FORGOTTEN = 20.0
_SAFETY = 10.0  # the estimate is that of a wave as long as the line
_SHARE = 0.05  # of rtol, to be spent on lumping


def point_laws(law: Relaxation, count: int) -> PointLaws:
    """The relaxation function as it is, for each of `count` points, the slowest branch
    first.
    """
    order = slowest_first(law)
    moduli, times = (
        np.asarray(x)[order][:, None] * np.ones(count) for x in (law.moduli, law.times)
    )
    apart = np.asarray(rates_apart(law))[:, :, None] * np.ones(count)
    return PointLaws(
        np.asarray(law.equilibrium),
        moduli,
        times,
        np.full(count, float(law.viscosity)),
        np.zeros(count),
        apart,
    )


def slowest_first(law: Relaxation) -> np.ndarray:
    """The order in which points hold the branches; those without a modulus come last."""
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    return np.argsort(np.where(moduli > 0, 1 / times, np.inf), kind="stable")


def lumped(
    law: Relaxation,
    step: Float[np.ndarray, " points"],
    period: Float[np.ndarray, " points"],
    rtol: float,
) -> tuple[PointLaws, Float[np.ndarray, " points"]]:
    """What each point carries, padded with empty branches to a common and even number;
    and mu's relative change.
    """
    live = np.asarray(law.moduli) > 0
    law = Relaxation(
        law.equilibrium,
        np.asarray(law.moduli)[live],
        np.asarray(law.times)[live],
        law.viscosity,
    )
    whole = point_laws(law, step.size)
    moduli, times = whole.moduli, whole.times
    fast = step / times > FORGOTTEN
    angle = period / (2 * np.pi * times)
    # w tau
    waves = np.geomspace(1.0, period / step, 33)[:, None] * (2 * np.pi * times / period)
    loss = (moduli * waves / (1 + waves**2)).sum(axis=1).mean(
        axis=0
    ) + whole.viscosity * 2 * np.pi / period
    cost = _SAFETY * moduli * (angle**2 / whole.relaxed + angle**3 / loss)
    spent = np.cumsum(np.where(fast, np.inf, cost), axis=0)
    slow = spent <= _SHARE * rtol
    slow &= slow.sum(axis=0) > 1  # one alone is its own lump
    viscosity = whole.viscosity + (moduli * times * fast).sum(axis=0)
    second = (moduli * times**2 * fast).sum(axis=0)
    total, rate = (moduli * slow).sum(axis=0), (moduli / times * slow).sum(axis=0)
    any_slow = slow.any(axis=0)
    nothing = np.zeros((1, step.size))
    kept = np.concatenate([any_slow[None], ~(slow | fast), nothing > 0])
    count = int(kept.sum(axis=0).max())
    count = max(2, count + count % 2)
    # what is carried goes before the rest, in its order
    first = np.argsort(~kept, axis=0, kind="stable")[:count]
    lump_time = total / np.where(any_slow, rate, 1.0)
    moduli = np.where(kept, np.concatenate([total[None], moduli, nothing]), 0.0)
    times = np.where(kept, np.concatenate([lump_time[None], times, nothing]), step)
    lumps = slow.sum(axis=0)
    laws = {size: _with_lump(law, size) for size in np.unique(lumps)}
    apart = np.full((count + 1, count + 1, step.size), np.inf)
    for point, size in enumerate(kept.sum(axis=0)):
        apart[: size + 1, : size + 1, point] = laws[lumps[point]][
            : size + 1, : size + 1
        ]
    spent = np.where(slow, np.where(fast, 0.0, cost), 0.0).sum(axis=0)
    moduli, times = (np.take_along_axis(x, first, axis=0) for x in (moduli, times))
    return PointLaws(whole.relaxed, moduli, times, viscosity, second, apart), spent


def _with_lump(law: Relaxation, size: int) -> np.ndarray:
    """The rates of a law whose `size` slowest branches are one."""
    order = slowest_first(law)
    moduli, times = np.asarray(law.moduli)[order], np.asarray(law.times)[order]
    if size:
        lump_modulus = moduli[:size].sum()
        time = lump_modulus / (moduli[:size] / times[:size]).sum()
        moduli, times = (
            np.append(lump_modulus, moduli[size:]),
            np.append(time, times[size:]),
        )
    return _rates(
        float(law.equilibrium),
        tuple(moduli[::-1]),
        tuple(times[::-1]),
        float(law.viscosity),
    )


@functools.lru_cache(maxsize=256)  # the same for every line of a surface
def _rates(
    equilibrium: float, moduli: tuple, times: tuple, viscosity: float
) -> np.ndarray:
    whole = Relaxation(
        np.asarray(equilibrium),
        np.array(moduli),
        np.array(times),
        np.asarray(viscosity),
    )
    return np.asarray(rates_apart(whole))
