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
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy import fft
from scipy.signal import lfilter

from ..element.layer import layer_kernel
from ..element.moments import moments
from ..material.relaxation import KelvinChain, Relaxation
from ..numerics.quadrature import gauss_laguerre, gauss_unit
from ..rough.half_space import Convolution

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Float

    Elastic = Callable[[np.ndarray], Float[np.ndarray, "places across"]]

# Shares of a cell by which the observer is moved back where contacts do not settle from
# centre to centre.
LEADS = (0.0, 0.125, 0.25, 0.375, 0.5)
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
    displacement: Float[np.ndarray, "offsets across"]
    slope: Float[
        np.ndarray, "offsets across"
    ]  # the part of dK/dx that does work [1/Pa]


def area_cell(x: np.ndarray, y: np.ndarray, h: float, width: float) -> np.ndarray:
    """(1/pi) int dA/r over a cell of sides h and `width`: surface of a half-space of
    unit E* (Love 1929).
    """

    def corner(a: np.ndarray, b: np.ndarray) -> Any:
        safe_a, safe_b = (np.where(x == 0, 1.0, np.abs(x)) for x in (a, b))
        return a * np.arcsinh(b / safe_a) + b * np.arcsinh(a / safe_b)

    low, high, near, far = x - h / 2, x + h / 2, y - width / 2, y + width / 2
    return (
        corner(high, far) - corner(low, far) - corner(high, near) + corner(low, near)
    ) / math.pi


def strip_cell(x: np.ndarray, h: float, length: float) -> np.ndarray:
    """(2/pi) int ln(length/|x|) dx over a cell of width h: surface of a half-plane of
    unit E*, to a constant.
    """

    def integral(a: np.ndarray) -> Any:
        return a * (1 - np.log(np.where(a == 0, 1.0, np.abs(a)) / length))

    return 2 / math.pi * (integral(x + h / 2) - integral(x - h / 2))


def sliding_kernel(
    elastic: Elastic,
    chain: KelvinChain,
    velocity: float,
    h: float,
    count: int,
    lead: float,
) -> Kernel:
    """`Kernel` for `count` cells along the motion. `lead` moves the observer back by
    that share of a cell.
    """
    offsets = (np.arange(-(count - 1), count) - lead) * h
    # Pieces between one observer and the next end where a cell ends: there e has kinks.
    cut = (0.5 + lead) % 1.0 * h
    before = _legendre(elastic, offsets[:-1], np.full(2 * count - 2, cut))
    after = _legendre(elastic, offsets[:-1] + cut, np.full(2 * count - 2, h - cut))
    edges = offsets[-1] + (offsets[-1] + 4 * h) * np.concatenate(
        [[0.0], 2.0 ** np.arange(_PANELS) - 0.5]
    )
    widths = np.diff(edges)
    behind = _legendre(elastic, edges[:-1], widths)
    e = elastic(offsets)
    displacement: Any = chain.instantaneous * e
    slope = np.zeros_like(e)
    for compliance, decay in zip(
        np.asarray(chain.compliances), velocity * np.asarray(chain.times), strict=True
    ):
        last = np.exp(-(edges[:-1] - edges[0]) / decay) @ _decaying(
            behind, widths, decay
        )
        local = _decaying(before, cut, decay) + math.exp(-cut / decay) * _decaying(
            after, h - cut, decay
        )
        # I(x) = exp(-h/l) I(x + h) + local, from the last offset backwards
        shrink = math.exp(-h / decay)
        recurrence, _ = lfilter(
            [1.0], [1.0, -shrink], local[::-1], axis=0, zi=shrink * last[None]
        )
        integral = np.concatenate([recurrence[::-1], last[None]])
        even = (
            _bend(elastic, offsets, e, h, decay)
            if decay < _SHORT * h
            else 0.5 * (integral + integral[::-1]) - e
        )
        displacement = displacement + compliance * integral
        slope = slope + compliance * even / decay
    return Kernel(displacement, slope)


def _legendre(
    elastic: Elastic, start: np.ndarray, width: np.ndarray
) -> Float[np.ndarray, "degree places across"]:
    """Legendre coefficients of e over intervals of `width` from `start` on."""
    nodes, _, to_legendre = gauss_unit(_NODES)
    samples = elastic((start[:, None] + width[:, None] * nodes).reshape(-1))
    samples = samples.reshape(start.size, _NODES, -1)
    return np.einsum("snb,nj->jsb", samples, to_legendre, optimize=True)


def _decaying(
    coefficients: Float[np.ndarray, "degree places across"], width: float, decay: float
) -> Float[np.ndarray, "places across"]:
    """int exp(-s/l) e ds/l over intervals of `width`."""
    z = np.broadcast_to(width / decay, coefficients.shape[1:2])
    return np.einsum("js,jsb->sb", z * moments(_NODES, z), coefficients)


def _bend(
    elastic: Elastic, offsets: np.ndarray, e: np.ndarray, h: float, decay: float
) -> np.ndarray:
    """[I(x) + I(-x) - 2 e(x)]/2 for a decay length that is short against a cell."""
    total = np.zeros_like(e)
    for node, weight in zip(*gauss_laguerre(12), strict=True):
        step = max(node * decay, _STEP * h)
        mean = 0.5 * (elastic(offsets + step) + elastic(offsets - step))
        total += weight * (node * decay / step) ** 2 * (mean - e)
    return total


def convolution(
    kernel: Float[np.ndarray, "offsets across"],
    law: Relaxation,
    velocity: float,
    sides: tuple[float, float],
    lead: float,
    cover: Any = None,
) -> Convolution:
    """The kernel of cells of `sides`, which is even across the motion, on twice the
    grid; its inverse is that of the infinite surface, E*(kx v) |k|/2.
    """
    padded = _around(kernel)
    kx = 2 * np.pi * np.fft.fftfreq(padded.shape[0])[:, None] / sides[0]
    ky = 2 * np.pi * np.fft.rfftfreq(padded.shape[1])[None] / sides[1]
    k = np.hypot(kx, ky)
    k[0, 0] = 0.5 * k[k > 0].min()
    modulus = np.conj(law.complex_modulus(np.abs(kx) * velocity))  # E*(-kx v)
    modulus = np.where(kx < 0, np.conj(modulus), modulus)
    if cover is not None:
        modulus = modulus / layer_kernel(
            k * cover.thickness, cover.squeeze, cover.bonded
        )
    inverse = 0.5 * k * modulus * np.exp(1j * kx * lead * sides[0])
    return Convolution(np.asarray(fft.rfft2(padded)), inverse, padded.shape)


def work_against(
    slope: Float[np.ndarray, "offsets across"],
    pressure: Float[np.ndarray, "along across"],
) -> float:
    """-sum p (dK/dx * p), the friction force per area of a cell: what the dissipating
    part of the kernel takes.
    """
    padded = _around(slope)
    factor: Any = fft.rfft2(padded)
    waves: Any = fft.rfft2(pressure, padded.shape)
    spread: Any = fft.irfft2(factor * waves, padded.shape)
    return -float((pressure * spread[: pressure.shape[0], : pressure.shape[1]]).sum())


def _around(kernel: Float[np.ndarray, "offsets across"]) -> np.ndarray:
    """A kernel of offsets 0 to (m-1) across, even there, on twice the grid, around the
    offset 0.
    """
    along, across = (kernel.shape[0] + 1) // 2, kernel.shape[1]
    even = np.concatenate([kernel[:, :0:-1], kernel], axis=1)
    padded = np.pad(even, ((0, 1), (0, 1 if across > 1 else 0)))
    return np.roll(padded, (-(along - 1), -(across - 1)), (0, 1))
