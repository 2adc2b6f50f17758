"""Influence functions of steady sliding: displacement around one loaded cell of a
viscoelastic half-space or -plane.

In the frame of the indenter, which moves along +x with velocity v, the point at x was
at x + v t a time t ago. With the creep function of E*, J(t) = J_0 + sum_k J_k (1 -
exp(-t/lambda_k)), and the elastic displacement e of unit modulus,

    K(x) = J_0 e(x) + sum_k J_k I_k(x),
    I_k(x) = int_0^inf exp(-s/l_k) e(x + s) ds / l_k,
    l_k = v lambda_k,

The integrals reach back along the whole way that the indenter has come, so that it
never meets its own wake. They follow from one another along the grid, I(x) = exp(-h/l)
I(x + h) + int_0^h, each piece by Gauss points and the exact moments of
`element.moments`.

Friction takes the slope dK/dx, of which only the part even in x does work, sum_k J_k
[I_k(x) + I_k(-x) - 2 e(x)]/(2 l_k): nothing of the elastic answer is left in it, so
that the smallest loss keeps its digits.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array
from ..element.moments import contract
from ..material.relaxation import KelvinChain
from ..numerics.quadrature import gauss_unit

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Float

    Elastic = Callable[[Array], Float[Array, "places across"]]

# Gauss points per half cell: e has logarithmic slopes at the ends of the cell, where
# the pieces meet
_NODES = 10
# of a cell: decay lengths below which I - e is taken from second differences of e
_SHORT = 0.1
# of a cell: the least step of such a difference, below which it is a parabola
_STEP = 1e-3
_PANELS = 44  # of doubling length, behind the grid: 13 decades


class Kernel(NamedTuple):
    """On the grid of offsets observer minus source, -(n-1) h to (n-1) h along the
    motion.
    """

    # K, per unit of pressure in the cell [m/Pa]
    displacement: Float[Array, "offsets across"]
    slope: Float[Array, "offsets across"]  # the part of dK/dx that does work [1/Pa]


def area_cell(x: Array, y: Array, h: Array, width: Array) -> Array:
    """(1/pi) int dA/r over a cell of sides h and `width`: surface of a half-space of
    unit E* (Love 1929).
    """

    def corner(a, b):
        safe_a, safe_b = (
            jnp.where(a == 0, 1.0, jnp.abs(a)),
            jnp.where(b == 0, 1.0, jnp.abs(b)),
        )
        return a * jnp.arcsinh(b / safe_a) + b * jnp.arcsinh(a / safe_b)

    low, high, near, far = x - h / 2, x + h / 2, y - width / 2, y + width / 2
    return (
        corner(high, far) - corner(low, far) - corner(high, near) + corner(low, near)
    ) / math.pi


def strip_cell(x: Array, h: float | Array, length: float | Array) -> Array:
    """(2/pi) int ln(length/|x|) dx over a cell of width h: surface of a half-plane of
    unit E*, to a constant.
    """

    def part(a):
        return a * (1 - jnp.log(jnp.where(a == 0, 1.0, jnp.abs(a)) / length))

    return 2 / math.pi * (part(x + h / 2) - part(x - h / 2))


def sliding_kernel(
    elastic: Elastic,
    chain: KelvinChain,
    velocity: Array,
    h: Array,
    count: int,
    lead: float | Array,
) -> Kernel:
    """`Kernel` for `count` cells along the motion. `lead` moves the observer back by
    that share of a cell.
    """
    offsets = (jnp.arange(-(count - 1), count) - lead) * h
    # Pieces between one observer and the next end where a cell ends: there e has kinks.
    cut = (0.5 + lead) % 1.0
    pieces = [(0.0, cut), (cut, 1.0)]
    nodes, _, to_legendre = gauss_unit(_NODES)
    decay = velocity * chain.times

    def coefficients(
        start: Array, width: Array
    ) -> Float[Array, "degree places across"]:
        samples = elastic((start[:, None] + width[:, None] * nodes).reshape(-1))
        return jnp.einsum(
            "snb,nj->jsb",
            samples.reshape(start.shape[0], _NODES, -1),
            jnp.asarray(to_legendre),
        )

    own = [
        coefficients(offsets[:-1] + a * h, jnp.full(2 * count - 2, (b - a) * h))
        for a, b in pieces
    ]
    reach = offsets[-1] + 4 * h
    edges = offsets[-1] + reach * np.concatenate(
        [[0.0], 2.0 ** np.arange(_PANELS) - 0.5]
    )
    behind = coefficients(edges[:-1], edges[1:] - edges[:-1])
    e = elastic(offsets)
    laguerre, share = np.polynomial.laguerre.laggauss(12)

    def bend(decay: Array) -> Array:
        """[I(x) + I(-x) - 2 e(x)]/2 for a decay length that is short against a cell."""

        def add(total: Array, node: Array) -> tuple[Array, None]:
            s, weight = node[0] * decay, node[1]
            step = jnp.maximum(s, _STEP * h)
            sides = elastic(jnp.concatenate([offsets + step, offsets - step])).reshape(
                2, *e.shape
            )
            return total + weight * (s / step) ** 2 * (
                0.5 * (sides[0] + sides[1]) - e
            ), None

        return jax.lax.scan(
            add, jnp.zeros_like(e), jnp.asarray(np.stack([laguerre, share], axis=1))
        )[0]

    def piece(c: Array, width: Array, decay: Array) -> Array:
        return width / decay * contract(c, jnp.broadcast_to(width / decay, c.shape[1:]))

    def branch(total: Kernel, values: tuple[Array, Array]) -> tuple[Kernel, None]:
        compliance, decay = values
        widths = (edges[1:] - edges[:-1])[:, None]
        last = jnp.sum(
            jnp.exp(-(edges[:-1] - edges[0]) / decay)[:, None]
            * piece(behind, widths, decay),
            axis=0,
        )
        parts = [
            piece(c, (b - a) * h, decay) for c, (a, b) in zip(own, pieces, strict=True)
        ]
        local = parts[0] + jnp.exp(-cut * h / decay) * parts[1]

        def back(after: Array, local: Array) -> tuple[Array, Array]:
            here = local + jnp.exp(-h / decay) * after
            return here, here

        _, integral = jax.lax.scan(back, last, local, reverse=True)
        integral = jnp.concatenate([integral, last[None]])
        even = jnp.where(
            decay < _SHORT * h, bend(decay), 0.5 * (integral + integral[::-1]) - e
        )
        return Kernel(
            total.displacement + compliance * integral,
            total.slope + compliance * even / decay,
        ), None

    start = Kernel(chain.instantaneous * e, jnp.zeros_like(e))
    return jax.lax.scan(branch, start, (jnp.asarray(chain.compliances), decay))[0]
