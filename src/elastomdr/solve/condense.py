"""Which branches of the spectrum a scene can do without: springs, dashpots, and what that costs.

A branch much slower than the longest passage never relaxes: its modulus joins the equilibrium modulus. One much faster
than the shortest is a dashpot. With z = passage/tau, the loss of a branch is about E z for z << 1 and E/z for z >> 1.
As a spring the branch loses the first; as a dashpot it keeps the second and errs by E/z^2. Both are compared with the
loss and with the modulus that remain, over the whole range of passages of the scene, and the cheapest are condensed
while the sum of their costs stays within the budget.
"""

import dataclasses

import numpy as np

from ..material.relaxation import Relaxation

_SAFETY = (
    10.0  # the estimate's constants are those of an elastic paraboloid; contact shape moves them by less than this
)
_SHARE = 0.02  # of rtol, to be spent on condensing


@dataclasses.dataclass(frozen=True)
class Condensation:
    """Branch numbers condensed, and the bound on the relative change of mu."""

    branches: int
    springs: tuple[int, ...] = ()
    dashpots: tuple[int, ...] = ()
    cost: float = 0.0

    @property
    def kept(self) -> tuple[int, ...]:
        """Numbers of the branches that are integrated."""
        gone = set(self.springs) | set(self.dashpots)
        return tuple(k for k in range(self.branches) if k not in gone)


def choose(law: Relaxation, shortest: float, longest: float, rtol: float) -> Condensation:
    """Condenses what a scene with passages between `shortest` and `longest` [s] does not need at `rtol`."""
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    if moduli.size == 0:
        return Condensation(0)
    passages = np.geomspace(shortest, longest, 65) if longest > shortest else np.array([shortest])
    z = passages[:, None] / times
    loss = np.sum(moduli * z / (1 + z**2), axis=1) + float(law.viscosity) / passages
    modulus = float(law.equilibrium) + np.sum(moduli / (1 + z), axis=1) + float(law.viscosity) / passages
    with np.errstate(over="ignore"):
        as_spring = np.max(moduli * z * (1 / loss + 1 / modulus)[:, None], axis=0)
        as_dashpot = np.max(moduli / z**2 * (1 / loss + 1 / modulus)[:, None], axis=0)
    cost = _SAFETY * np.minimum(as_spring, as_dashpot)
    budget, spent = _SHARE * rtol, 0.0
    springs, dashpots = [], []
    for k in np.argsort(cost):
        if spent + cost[k] > budget:
            break
        spent += float(cost[k])
        (springs if as_spring[k] < as_dashpot[k] else dashpots).append(int(k))
    return Condensation(moduli.size, tuple(sorted(springs)), tuple(sorted(dashpots)), spent)


def condensed(law: Relaxation, how: Condensation) -> Relaxation:
    """The relaxation function with its springs and dashpots set aside; padded so that few sizes are compiled."""
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    springs, dashpots, kept = (list(x) for x in (how.springs, how.dashpots, how.kept))
    padding = -len(kept) % 4
    return Relaxation(
        law.equilibrium + moduli[springs].sum(),
        np.concatenate([moduli[kept], np.zeros(padding)]),
        np.concatenate([times[kept], np.ones(padding)]),
        law.viscosity + (moduli[dashpots] * times[dashpots]).sum(),
    )
