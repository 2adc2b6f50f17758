"""Gauss' rule between the edges that a contact has had: its panels, and what it misses
of a force.

Three kinds of integrand. Smooth in x, where the Legendre coefficients of a panel fall
geometrically and tell the error. A power x^s that is not whole, at the axis, where they
fall as j^-(2s+1) and the error is a known part of the last ones. And a layer at an edge
that advances: an element touched a time t ago carries E_k v tau_k (1 - exp(-t/tau_k)),
so that where v tau_k/g' is far below a panel no node sees the exponential, of which the
sum then is too large by its integral.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import fixed, in_steps, xp
from ..checks import Array
from ..material.relaxation import Relaxation
from ..numerics.quadrature import gauss, shares_to_legendre
from ..surface.disc import Disc

if TYPE_CHECKING:
    from jaxtyping import Float

NODES = 6  # per panel
_RATIO = 0.2  # of neighbouring panels within one that narrows
_NARROWING = {1: 1, 2: 2, 3: 3}  # levels: how often their panels narrow
# the same of higher levels, and of those that look for layers
_NARROWEST, _DEEP = 4, 13
LAYERS = 7  # the level from which panels narrow that far
_IN_A_ROW = 2  # parts of a panel that are summed at once
_SAFETY = 2.0  # on the error of a power at the axis
# on that of a layer, which is wider than v tau/g' where the profile is curved
_CURVED = 1.1


def cuts(levels: int) -> Float[np.ndarray, "rows n"]:
    """Where panels are cut, from 0 to 1, in rows of a few parts each: of one size on
    all levels, from 1 to `LAYERS`.
    """
    at = np.append(_fractions(levels), 1.0)
    return at[np.arange(0, len(at) - 1, _IN_A_ROW)[:, None] + np.arange(_IN_A_ROW + 1)]


@functools.cache
def _fractions(levels: int) -> np.ndarray:
    """Where the parts of a panel begin, from 0 to 1."""
    deep = _NARROWING.get(levels, _NARROWEST if levels < LAYERS else _DEEP)
    left = 0.5 * _RATIO ** np.arange(deep - 1, -1.0, -1)
    ends = np.concatenate([[0.0], left, 1 - left[-2::-1], [1.0]])
    parts = 1 + min(levels, LAYERS - 1) // 2
    return (ends[:-1, None] + np.diff(ends)[:, None] * np.arange(parts) / parts).ravel()


def missed(
    shares: Float[Array, " n"], begin: Float[Array, " panels"], disc: Disc
) -> Float[Array, ""]:
    """What Gauss' rule misses of an integral, from the nodes' shares of it; layers
    apart. Panels begin at `begin`.

    About the Legendre coefficient 2 `NODES`, four times as far from the last even and
    odd ones as those are from the ones before, by geometric fall (kept apart: a
    parabola would hide in the second how the others fall). In the panel at the axis of
    a profile c x^n, n not whole, what the rule misses of that power.
    """
    size = xp.abs(shares.reshape(-1, NODES) @ xp.asarray(shares_to_legendre(NODES)).T)
    before, last = size[:, 2:4], size[:, 4:6]
    error = xp.sum(
        last * xp.minimum(last / xp.where(before > 0, before, 1.0), 1.0) ** 4, axis=1
    )
    power, _ = disc._power()
    if power is not None and power != int(power):
        at_axis = (
            _SAFETY * _of_power(power + (disc.kind == "layer")) * xp.max(last, axis=1)
        )
        error = xp.where(begin == 0, xp.maximum(error, at_axis), error)
    return xp.sum(error)


def missed_layers(
    law: Relaxation,
    disc: Disc,
    time: Array,
    depth: Array,
    radius: Float[Array, " m"],
    part: Any,
) -> Float[Array, " m"]:
    """What the panels miss of layers at the edges: sum over W E_k v tau_k w_k r(q), [N]
    at every instant.

    `part` is the share of a panel between two edges that the part of it at an edge has.

    w_k = v tau_k/g'(a) is the layer's width, W the weight at the edge, q the widths in
    a panel that ends there (less of the layer is left in panels further in), r what the
    rule misses of an exponential over its integral. A layer fades with its branch after
    its instant. Holds for rubber that is touched for the first time; elsewhere an
    estimate.
    """
    law, disc, time, depth, radius = fixed((law, disc, time, depth, radius))
    h = xp.diff(time)
    pressing = xp.maximum(xp.diff(depth) / h, 0.0)
    ends = xp.sort(xp.append(radius, 0.0))
    panel = xp.diff(ends) * part
    edge = radius[1:]
    slope = disc.slope(xp.where(edge > 0, edge, 1.0))
    width = xp.where(edge > 0, pressing / slope, 0.0)[:, None] * law.times  # (m-1, k)
    behind = edge[:, None] - ends[1:]  # of every panel
    fits = xp.maximum(panel, 1e-300) / xp.where(width > 0, width, 1.0)[..., None]
    # From above within a factor of 15 for q from 5 on, of 2 from 60 on; r = 1 - (...)/q
    # once no node sees the layer.
    unseen = (
        85 / fits * xp.exp(-((fits / 80) ** 1.5))
        + xp.maximum(behind, 0.0)[:, None] / xp.where(panel > 0, panel, 1.0) * fits
    )
    unseen = xp.where((behind >= 0)[:, None] & (panel > 0), xp.exp(-unseen), 0.0)
    size = _CURVED * width * unseen.sum(-1)
    amount = (
        disc.weight(edge)[:, None] * law.moduli * pressing[:, None] * law.times * size
    )

    def fading(left: Array, new: tuple[Array, Array]) -> tuple[Array, Array]:
        left = left * xp.exp(-new[0] / law.times) + new[1]
        return left, xp.sum(left)

    _, total = in_steps(fading, xp.zeros_like(law.times), (h, amount))
    return xp.append(0.0, total)


@functools.cache
def _of_power(s: float) -> float:
    """What the rule misses of int x^s over a panel at x = 0, over the larger of the
    last two coefficients.
    """
    nodes, weights = gauss(NODES)
    shares = 0.5 * weights * (0.5 + 0.5 * nodes) ** s
    last = np.abs(shares_to_legendre(NODES) @ shares)[-2:].max()
    return abs(shares.sum() - 1 / (s + 1)) / last
