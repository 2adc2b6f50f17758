"""A rigid body on a grid of cells: pressure where there is contact, a gap where there
is none.

Block pivoting on the linear complementarity problem p >= 0, gap = K p + f - d >= 0, p
gap = 0 (Portugal, Judice & Vicente 1994): solve on the cells in contact, let go those
that pull, take in those that overlap, until nothing changes. Where that goes in circles
(at a glassy leading edge thinner than a cell a pressure sinks in further behind than at
its own place), cells are let go first, and taken in when none pulls. Each solve is
BiCGSTAB, with K by FFT on a grid of twice the size, preconditioned by the exact inverse
on the infinite surface, E*(k v)|k|/2, restricted to the contact: a dozen products,
whatever the material.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
from jax.scipy.sparse.linalg import bicgstab

from ..checks import Array
from ..element.layer import layer_kernel
from ..material.relaxation import Relaxation

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

# Shares of a cell by which the observer is moved back where contacts do not settle from
# centre to centre.
LEADS = (0.0, 0.125, 0.25, 0.375, 0.5)
_PIVOTS = 60
# pivots in which fewer cells change than ever before, or those that pull are let go
# first
_PATIENCE = 2
_ITERATIONS = 100
_TOLERANCE = 1e-10  # of the residual of a solve
_RESIDUAL = 1e-7  # beyond which a solve has failed


class Grid(NamedTuple):
    """K and the preconditioner as transforms on twice the grid."""

    kernel: Array  # complex
    inverse: Array  # complex


class Solution(NamedTuple):
    """Pressure and depth; `settled` says that every cell agrees with its condition."""

    pressure: Float[Array, "along across"]  # [Pa]
    depth: Float[Array, ""]  # [m]
    settled: Bool[Array, ""]


def grid(
    kernel: Float[Array, "offsets across"],
    law: Relaxation,
    velocity: Array,
    sides: tuple[Array, Array],
    lead: float | Array,
    cover: Any = None,
) -> Grid:
    """Transforms of a kernel that is even across the motion, given for offsets 0 to
    (m-1) h across.
    """
    along, across = (kernel.shape[0] + 1) // 2, kernel.shape[1]
    even = jnp.concatenate([kernel[:, :0:-1], kernel], axis=1)
    padded = (
        jnp.pad(even, ((0, 1), (0, 1)))
        if across > 1
        else jnp.pad(even, ((0, 1), (0, 0)))
    )
    padded = jnp.roll(padded, (-(along - 1), -(across - 1)), (0, 1))
    kx = 2 * jnp.pi * jnp.fft.fftfreq(padded.shape[0], 1.0)[:, None] / sides[0]
    ky = 2 * jnp.pi * jnp.fft.rfftfreq(padded.shape[1], 1.0)[None] / sides[1]
    k = jnp.hypot(kx, ky)
    k = jnp.where(k == 0, 0.5 * jnp.min(jnp.where(k > 0, k, jnp.inf)), k)
    turn = 1j * kx * velocity
    x = turn[..., None] * law.times
    modulus = (
        law.equilibrium
        + jnp.sum(law.moduli * x / (1 + x), axis=-1)
        + turn * law.viscosity
    )
    if cover is not None:
        modulus = modulus / layer_kernel(
            k * cover.thickness, cover.squeeze, cover.bonded
        )
    return Grid(
        jnp.fft.rfft2(padded),
        jnp.conj(modulus) * k / 2 * jnp.exp(1j * kx * lead * sides[0]),
    )


def settle(
    on: Grid,
    height: Float[Array, "along across"],
    start: Bool[Array, "along across"],
    control: str,
    value: Array,
    *,
    periodic: bool = False,
) -> Solution:
    """Contact at a depth [m], or at a load over the area of a cell [Pa]; `periodic`
    wraps around, without doubling.
    """
    shape = height.shape
    transformed = (
        shape if periodic else (2 * shape[0], 2 * shape[1] if shape[1] > 1 else 1)
    )

    def convolve(transform: Array, field: Array) -> Array:
        spread = jnp.fft.irfft2(
            jnp.fft.rfft2(field, transformed) * transform, transformed
        )
        return spread[: shape[0], : shape[1]]

    @functools.partial(jax.vmap, in_axes=(None, 0, 0))
    def solve(touching: Array, right: Array, guess: Array) -> tuple[Array, Array]:
        right = touching * right

        def product(p):
            return touching * convolve(on.kernel, touching * p)

        def nearly(p):
            return touching * convolve(on.inverse, touching * p)

        p, _ = bicgstab(
            product,
            right,
            touching * guess,
            tol=_TOLERANCE,
            atol=0.0,
            maxiter=_ITERATIONS,
            M=nearly,
        )
        size = jnp.linalg.norm(right)
        missed = jnp.linalg.norm(product(p) - right) / jnp.where(size > 0, size, 1.0)
        return p, missed

    def pivot(state):
        touching, both, _, _, _, count, least, waited = state
        both, missed = solve(
            touching,
            jnp.stack([jnp.ones(shape), jnp.where(touching, height, 0.0)]),
            both,
        )
        one, two = both
        total = jnp.sum(one)
        depth = (
            value
            if control == "depth"
            else (value + jnp.sum(two)) / jnp.where(total == 0, 1.0, total)
        )
        pressure = depth * one - two
        gap = convolve(on.kernel, pressure) + height - depth
        pulling, overlapping = touching & ~(pressure > 0), ~touching & (gap < 0)
        changed = jnp.sum(pulling | overlapping)
        waited = jnp.where(changed < least, 0, waited + 1)
        taken = overlapping & ~((waited >= _PATIENCE) & jnp.any(pulling))
        following = (touching & ~pulling) | taken
        ends = changed, jnp.max(missed)
        return (
            following,
            both,
            pressure,
            depth,
            ends,
            count + 1,
            jnp.minimum(changed, least),
            waited,
        )

    def going(state):
        (changed, missed), count = state[4], state[5]
        return (changed > 0) & (count < _PIVOTS) & ~(missed > _RESIDUAL)

    nothing = jnp.zeros(shape)
    ends, most = (jnp.asarray(1), jnp.asarray(0.0)), jnp.asarray(start.size + 1)
    begin = (
        start,
        jnp.stack([nothing, nothing]),
        nothing,
        jnp.asarray(0.0),
        ends,
        0,
        most,
        0,
    )
    _, _, pressure, depth, (changed, missed), *_ = jax.lax.while_loop(
        going, pivot, begin
    )
    return Solution(pressure, depth, (changed == 0) & (missed <= _RESIDUAL))


def work_against(
    slope: Float[Array, "offsets across"], pressure: Float[Array, "along across"]
) -> Float[Array, ""]:
    """-sum p (dK/dx * p), the friction force per area of a cell: what the dissipating
    part of the kernel takes.
    """
    along, across = pressure.shape
    even = jnp.concatenate([slope[:, :0:-1], slope], axis=1)
    padded = (
        jnp.pad(even, ((0, 1), (0, 1)))
        if across > 1
        else jnp.pad(even, ((0, 1), (0, 0)))
    )
    padded = jnp.roll(padded, (-(along - 1), -(across - 1)), (0, 1))
    spread = jnp.fft.irfft2(
        jnp.fft.rfft2(pressure, padded.shape) * jnp.fft.rfft2(padded), padded.shape
    )
    return -jnp.sum(pressure * spread[:along, :across])
