"""How finely the smooth part of the contact integrals is sampled."""

import dataclasses
import functools
import math

import numpy as np

from ..mapping.profile import Profile
from ..mapping.shapes import AbstractShape, Cone, Cylinder, Paraboloid, PowerLaw

_STEEP = 8.0  # exponent of a power law from which it is a punch with a rounded edge


@dataclasses.dataclass(frozen=True)
class Rule:
    """Gauss-Legendre nodes per panel, and where the panels end.

    The contact integrals run over the distance r behind the leading edge. A profile that is smooth through its apex
    needs one panel. A kink at the apex shows in the integrands at r = b and r = a (trailing and leading edge), so
    `split` puts panel ends there; `fractions` divides each part further.
    """

    nodes: int
    split: bool = False
    fractions: tuple[float, ...] = (0.0, 1.0)
    exact: bool = False  # the integrands are polynomials that the nodes integrate exactly
    strips: int = 16  # over the half-width of a contact that is solved in strips
    safety: float = 1.0  # on the error estimate, where a profile has kinks that the nodes straddle

    @property
    def samples(self) -> int:
        """Samples of the profile along one contact."""
        return self.nodes * (len(self.fractions) - 1) * (3 if self.split else 1)


@functools.cache
def gauss(nodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes c and weights w on [0, 1], and T[i, j] = (2j+1) w_i P_j(1 - 2 c_i), samples to Legendre coefficients."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    c, w = 0.5 * (1 + x), 0.5 * w
    legendre = np.polynomial.legendre.legvander(1 - 2 * c, nodes - 1)
    return c, w, w[:, None] * legendre * (2 * np.arange(nodes) + 1)


def graded(levels: int, ratio: float = 0.15) -> tuple[float, ...]:
    """Divisions of [0, 1] that shrink geometrically towards both ends, for an algebraic singularity there."""
    left = [0.0] + [0.5 * ratio**k for k in range(levels, 0, -1)]
    return tuple(left + [0.5] + [1 - x for x in reversed(left)])


def ladder(shape: AbstractShape, rtol: float, smallest: float = 0.0, strips: bool = False) -> tuple[Rule, ...]:
    """Rules for a shape, coarse to fine; the first is expected to meet `rtol`, the others wait for where it does not.

    `smallest` is the ratio of the radius of a sphere to the contact radius, if known: the profile of a sphere is
    analytic up to R, so that its Legendre series falls as rho^-m with rho = R/a + sqrt((R/a)^2 - 1). On `strips` beside
    the axis a body is rounded over the strip's distance y from it, f(sqrt(x^2 + y^2)): even powers stay polynomials,
    all others are divided ever finer towards the apex.
    """
    if not strips:
        return _along_line(shape, rtol, smallest)
    power = 1 if isinstance(shape, Cone) else shape.exponent if isinstance(shape, PowerLaw) else 2
    rules = _along_line(shape, rtol, smallest)
    if power % 2:
        rules = tuple(Rule(nodes, split=True, fractions=graded(levels)) for nodes, levels in ((8, 3), (12, 3), (16, 4)))
    if isinstance(shape, Profile):
        rules = tuple(rule for rule in rules if len(rule.fractions) <= 7) or _along_line(shape, 1e-6, smallest)[:1]
    counts = (16, 32, 64) if rtol >= 1e-7 else (32, 64, 128)
    if power < 2:  # the tip leaves a kink across the strips
        rules, counts = rules[1:], (48, 96)
    return tuple(dataclasses.replace(rules[min(i, len(rules) - 1)], strips=n) for i, n in enumerate(counts))


def _along_line(shape: AbstractShape, rtol: float, smallest: float) -> tuple[Rule, ...]:
    if isinstance(shape, (Paraboloid, Cylinder)):
        return (Rule(4, exact=True),)
    if isinstance(shape, Cone):
        return (Rule(2, split=True, exact=True),)
    if isinstance(shape, PowerLaw) and shape.exponent == int(shape.exponent) and shape.exponent <= 10:
        return (Rule(2 * int(shape.exponent), split=bool(shape.exponent % 2), exact=True),)
    if isinstance(shape, PowerLaw):
        levels = max(2, math.ceil(math.log10(1 / rtol) / shape.exponent))
        steps = (graded(levels + more) for more in (0, 2, 4))
        if shape.exponent > _STEEP:  # the apex is flat; what has to be divided is the rise of the last 1/n at the edges
            levels = math.ceil(math.log2(shape.exponent))
            steps = (graded(levels + more, 0.5) for more in (-1, 0, 1))
        return tuple(Rule(n, split=True, fractions=f) for n, f in zip((8, 10, 14), steps, strict=True))
    if isinstance(shape, Profile):
        # The profile's points leave kinks of order 5/2: the error falls as pieces^-2.5, and the estimate, the last
        # polynomials' part, is up to 70 times below it (measured on spheres, cones and wavy bodies).
        pieces = (1, 2, 6, 16, 48)[sum(rtol < bound for bound in (1e-4, 1e-5, 1e-7)) :]
        return tuple(
            Rule(10, split=True, fractions=tuple(np.linspace(0, 1, n + 1).tolist()), safety=70.0) for n in pieces
        )
    sizes = (8, 10, 12, 14, 16, 20, 24, 32)
    needed = sizes[4]
    if smallest > 1:
        rho = smallest + math.sqrt(smallest**2 - 1)
        needed = math.log(10 / rtol) / math.log(rho) + 3
    first = next((n for n in sizes if n >= needed), sizes[-1])
    finer = (2 * first, sizes[-1]) if 2 * first < sizes[-1] else (sizes[-1],)
    return tuple(Rule(n) for n in dict.fromkeys((first, *finer)))
