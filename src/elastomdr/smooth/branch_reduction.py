"""Which branches of the spectrum a scene need not carry one by one, and what that
costs.

A branch much slower than the longest passage is a spring that barely relaxes, one much
faster than the shortest is a dashpot. All the slow ones are lumped into one branch with
their sum of E_k and of E_k/tau_k, all the fast ones into one with their sum of E_k
tau_k and of E_k tau_k^2. With z = passage/tau, what a branch changes by that is E z^2
(slow) or E/z^3 (fast), the first terms that are not matched; E/z^2 (fast) under a kink
at the apex, if contact may end within the layer that a fast branch leaves behind it (a
liquid under a cone). Both are compared with the loss and with the modulus of the rest,
over the whole range of passages of the scene, and the cheapest are condensed while the
sum of their costs stays within the budget.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ..material.relaxation import Relaxation

# the estimate's constants are those of an elastic paraboloid; other shapes move them by
# less than this
_SAFETY = 10.0
_SHARE = 0.02  # of rtol, to be spent on condensing


@dataclasses.dataclass(frozen=True)
class Condensation:
    """Branch numbers condensed, and the bound on the relative change of mu."""

    branches: int
    # too slow to relax: one branch stands for all of them
    springs: tuple[int, ...] = ()
    dashpots: tuple[int, ...] = ()  # relaxed long before the passage ends: likewise
    cost: float = 0.0

    @property
    def kept(self) -> tuple[int, ...]:
        """Numbers of the branches that are carried as they are."""
        gone = set(self.springs) | set(self.dashpots)
        return tuple(k for k in range(self.branches) if k not in gone)


def choose(
    law: Relaxation, shortest: float, longest: float, rtol: float, kinked: bool
) -> Condensation:
    """Condenses what a scene with passages between `shortest` and `longest` [s] does
    not need at `rtol`; `kinked` says that the body has a kink at its apex.
    """
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    if not (moduli > 0).any():
        return Condensation(moduli.size)
    passages = np.exp(
        np.linspace(np.log(shortest), np.log(longest), 65 if longest > shortest else 1)
    )
    z = passages[:, None] / times
    with np.errstate(over="ignore"):
        square, drag = z * z, float(law.viscosity) / passages
        loss = (z / (1 + square)) @ moduli + drag
        modulus = float(law.equilibrium) + (1 / (1 + z)) @ moduli + drag
        share = (1 / loss + 1 / modulus)[:, None]
        as_spring = moduli * (square * share).max(axis=0)
        as_dashpot = moduli * (share / (square if kinked else square * z)).max(axis=0)
    cost = _SAFETY * np.minimum(as_spring, as_dashpot)
    budget, spent = _SHARE * rtol, 0.0
    springs, dashpots = [], []
    order = np.argsort(cost)
    for k, one, spring in zip(
        order.tolist(),
        cost[order].tolist(),
        (as_spring < as_dashpot)[order],
        strict=True,
    ):
        if spent + one > budget:
            break
        spent += one
        (springs if spring else dashpots).append(k)
    return Condensation(
        moduli.size, tuple(sorted(springs)), tuple(sorted(dashpots)), spent
    )


def condensed(law: Relaxation, how: Condensation) -> Relaxation:
    """The relaxation function with its slow and its fast branches lumped."""
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    if not how.springs and not how.dashpots and moduli.all():
        return law
    springs, dashpots, kept = (
        [k for k in x if moduli[k] > 0] for x in (how.springs, how.dashpots, how.kept)
    )
    fewer = [(moduli[kept], times[kept])]
    if springs:
        total, rate = moduli[springs].sum(), (moduli[springs] / times[springs]).sum()
        fewer.append((total[None], (total / rate)[None]))
    if dashpots:
        first, second = (
            (moduli[dashpots] * times[dashpots]).sum(),
            (moduli[dashpots] * times[dashpots] ** 2).sum(),
        )
        fewer.append(((first / second * first)[None], (second / first)[None]))
    moduli, times = (np.concatenate(branches) for branches in zip(*fewer, strict=True))
    return Relaxation(law.equilibrium, moduli, times, law.viscosity)


def filled(law: Relaxation) -> Relaxation:
    """The same with branches of no modulus, up to one of few numbers of them, each of
    which is compiled once.
    """
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    padding = (
        4 - moduli.size
        if moduli.size < 4
        else -moduli.size % (4 if moduli.size <= 8 else 8)
    )
    moduli, times = (
        np.pad(moduli, (0, padding)),
        np.pad(times, (0, padding), constant_values=1.0),
    )
    return Relaxation(law.equilibrium, moduli, times, law.viscosity)
