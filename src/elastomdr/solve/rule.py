"""How finely the smooth part of the contact integrals is sampled."""

import dataclasses
import functools

import numpy as np


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
