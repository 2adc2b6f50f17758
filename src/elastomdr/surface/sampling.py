"""How finely the smooth part of the contact integrals is sampled."""

from __future__ import annotations

import dataclasses
import math

from ..numerics.quadrature import graded
from .profile import Profile
from .shapes import AbstractShape, PowerShape

_NARROW = 0.3  # how far a power law's panels reach towards its apex


@dataclasses.dataclass(frozen=True)
class Rule:
    """Gauss-Legendre nodes per panel, and where the panels end.

    The profile is sampled from the apex outwards. `fractions` divides the whole
    contact, or, of a profile from points, the way from each point to the next.
    """

    nodes: int
    split: bool = False  # a kink at the apex, where contact may end
    fractions: tuple[float, ...] = (0.0, 1.0)
    exact: bool = False  # the slope is a polynomial that the nodes sample exactly
    strips: int = 16  # over the half-width of a contact that is solved in strips
    # on the error estimate, where the profile is not analytic within a panel
    safety: float = 1.0

    @property
    def samples(self) -> int:
        """Samples of the profile along one contact, or between two of its points."""
        return self.nodes * (len(self.fractions) - 1)

    @property
    def parabola(self) -> bool:
        """Whether the profile is a parabola: its slope is one straight line."""
        return self.exact and not self.split and self.nodes == 2


def ladder(
    shape: AbstractShape, rtol: float, smallest: float = 0.0, strips: bool = False
) -> tuple[Rule, ...]:
    """Rules for a shape, coarse to fine; the first is expected to meet `rtol`, the
    others wait for where it does not.

    `smallest` is the ratio of the radius of a sphere to the contact radius, if known:
    the profile of a sphere is analytic up to R, so that its Legendre series from the
    apex to a falls as rho^-m, rho = c + sqrt(c^2 - 1) with c = 2R/a - 1. On `strips`
    beside the axis a body is rounded over the strip's distance y from it, f(sqrt(x^2 +
    y^2)): even powers stay polynomials, all others are divided ever finer towards the
    apex.
    """
    rules = _along_line(shape, rtol, smallest)
    if not strips:
        return rules
    if isinstance(shape, PowerShape) and shape.power.exponent % 2:
        rungs = ((10, 3, 24), (14, 3, 24), (16, 4, 40), (20, 5, 64))
        return tuple(
            Rule(nodes, split=True, fractions=graded(levels), strips=count)
            for nodes, levels, count in rungs[sum(rtol < x for x in (3e-5, 1e-7)) :]
        )
    if isinstance(shape, Profile):
        rules = tuple(
            Rule(10, split=True, fractions=graded(levels), safety=30.0)
            for levels in (2, 4, 6)
        )
    counts = (16, 32, 64) if rtol >= 1e-7 else (32, 64, 128)
    return tuple(
        dataclasses.replace(rules[min(i, len(rules) - 1)], strips=n)
        for i, n in enumerate(counts)
    )


def _along_line(shape: AbstractShape, rtol: float, smallest: float) -> tuple[Rule, ...]:
    power = shape.power.exponent if isinstance(shape, PowerShape) else 0.5
    if power == int(power) and power <= 10:
        return (Rule(max(int(power), 2), split=bool(power % 2), exact=True),)
    digits = math.log10(10 / rtol)
    if isinstance(shape, PowerShape):
        # Slopes x^(n-1): panels so narrow that few nodes show one, down to where what
        # is left does not count.
        ratio = max(_NARROW, math.exp(-3 / power))
        per_level = power * math.log10(1 / ratio)
        return tuple(
            Rule(
                max(6, math.ceil(1.4 * (digits + more))),
                split=True,
                fractions=graded(
                    max(2, math.ceil((digits + more - 1) / per_level)), ratio
                ),
            )
            for more in (0, 2, 4)
        )
    if isinstance(shape, Profile):
        # Behind each point the slope has a root of the distance to it.
        rungs = ((8, 0), (8, 1), (10, 3), (12, 6), (14, 9))[
            sum(rtol < bound for bound in (1e-4, 1e-8)) :
        ]
        return tuple(
            Rule(n, split=True, fractions=graded(levels), safety=3.0)
            for n, levels in rungs
        )
    sizes = (8, 10, 12, 14, 16, 20, 24, 32)
    needed = sizes[4]
    if smallest > 1:
        rho = 2 * smallest - 1 + math.sqrt((2 * smallest - 1) ** 2 - 1)
        needed = math.log(10 / rtol) / math.log(rho) + 3
    first = next((n for n in sizes if n >= needed), sizes[-1])
    finer = (2 * first, sizes[-1]) if 2 * first < sizes[-1] else (sizes[-1],)
    return tuple(Rule(n) for n in dict.fromkeys((first, *finer)))
