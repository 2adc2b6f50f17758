"""Steady sliding of a periodic height map on a three-dimensional viscoelastic
half-space, in Fourier space.

In the frame of the map, which moves along +x with velocity v, the wave (kx, ky) shakes
the rubber at the frequency kx v, and a pressure p of that wave displaces the surface by

    u = 2 p / (|k| E*(-kx v)),
    so that
    tau = <p dh/dx> = sum_k |p_k|^2 2 kx E''(kx v) / (|k| |E*(kx v)|^2)

is the mean friction stress: only the loss, so that the smallest keeps its digits. The
mean displacement of a periodic half-space is not defined and left out: what the contact
decides is the separation, the mean distance of the two surfaces. Contact by
`reference.contact.settle`, without doubling the grid. Every indenter of the array meets
the wakes of those before it.
"""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, as_float64, positive
from ..element.law import Foundation
from ..errors import ConvergenceWarning, InputError
from ..material.relaxation import Relaxation
from ..results.curve import HalfSpaceCurve
from ..results.words import brief, describe
from ..surface.shapes import AbstractShape
from .contact import LEADS, Grid, settle
from .points import NOT_COMPARED, broadcast

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

MODEL = (
    "periodic half-space in three dimensions, one pressure per point of the map (no "
    "reduction)"
)


class _Found(NamedTuple):
    """One contact."""

    stress: Float[Array, ""]  # friction force over the area of the cell [Pa]
    area: Float[Array, ""]  # part of the points in contact
    separation: Float[Array, ""]  # mean gap [m]
    touching: Bool[Array, "along across"]
    settled: Bool[Array, ""]


def slide_periodic(
    foundation: Foundation,
    shape: Any,
    *,
    cell: Any,
    velocity: Any,
    load: Any,
    temperature: Any,
    points: int,
) -> HalfSpaceCurve:
    """`half_space_sliding` of a map or an array of bodies on a periodic cell."""
    sides = _sides(cell)
    heights, name = _heights(shape, sides, points)
    scene = broadcast(
        foundation, velocity=velocity, load=load, temperature=temperature, points=points
    )
    at, law, area = scene.at, foundation.law(), float(np.prod(sides))
    found = []
    for value, speed in zip(scene.value / area, scene.velocity, strict=True):
        found.append(_one(law, speed, value, heights, sides))
    good = np.array([bool(fine.settled & coarse.settled) for fine, coarse in found])
    if not good.all():
        text = (
            f"{int((~good).sum())} of {good.size} contacts did not settle; they are "
            "NaN."
        )
        warnings.warn(text, ConvergenceWarning, stacklevel=4)

    def field(values: list[Any]) -> Any:
        return np.where(good, np.array([float(v) for v in values]), np.nan).reshape(
            at.shape
        )

    drag, force = (
        field([area * fine.stress for fine, _ in found]),
        scene.value.reshape(at.shape),
    )
    grid = f"{heights.shape[0]} by {heights.shape[1]} points"
    inputs = {
        **dict(scene.inputs(("shape", name))),
        "cell": _metres(sides),
        "grid": grid,
    }
    return HalfSpaceCurve(
        velocity=at.full(at.velocity),
        mu=drag / force,
        normal_force=force * at.vertical,
        friction_force=drag * at.vertical,
        area=field([fine.area for fine, _ in found]),
        separation=field([fine.separation for fine, _ in found]),
        error=field([area * abs(fine.stress - coarse.stress) for fine, coarse in found])
        / force,
        converged=good.reshape(at.shape),
        temperature=at.full(at.kelvin),
        model=MODEL,
        plan=f"{grid}, and every second of them along each side for the error",
        inputs=(*inputs.items(), NOT_COMPARED),
    )


def _one(
    law: Relaxation, velocity: Array, pressure: Array, heights: np.ndarray, sides: Array
) -> tuple[_Found, _Found]:
    """A point on the whole map, from the contact on every second row and column of it,
    and that.
    """
    half = heights[::2, ::2]

    def solved(lead: float) -> tuple[_Found, _Found]:
        coarse = _solve(
            law, velocity, pressure, half, half >= np.median(half), sides, lead
        )
        start = np.repeat(np.repeat(np.asarray(coarse.touching), 2, axis=0), 2, axis=1)
        return _solve(law, velocity, pressure, heights, start, sides, lead), coarse

    found = solved(LEADS[0])
    for lead in LEADS[1:]:
        if bool(found[0].settled & found[1].settled):
            break
        found = solved(lead)
    return found


@jax.jit
def _solve(
    law: Relaxation,
    velocity: Array,
    pressure: Array,
    heights: Array,
    start: Array,
    sides: Array,
    lead: Array,
) -> _Found:
    """Contact at a mean pressure, and the friction stress."""
    kx = (
        2
        * jnp.pi
        * jnp.fft.fftfreq(heights.shape[0], 1 / heights.shape[0])[:, None]
        / sides[0]
    )
    ky = (
        2
        * jnp.pi
        * jnp.fft.rfftfreq(heights.shape[1], 1 / heights.shape[1])[None]
        / sides[1]
    )
    k = jnp.hypot(kx, ky)
    # any will do: it only counts depths from elsewhere
    k = jnp.where(k == 0, jnp.min(jnp.where(k > 0, k, jnp.inf)), k)
    x = (kx * velocity)[..., None] * law.times
    storage = law.equilibrium + jnp.sum(law.moduli * x**2 / (1 + x**2), axis=-1)
    loss = jnp.sum(law.moduli * x / (1 + x**2), axis=-1) + kx * velocity * law.viscosity
    # a wave that has no direction of its own
    nyquist = jnp.arange(heights.shape[0])[:, None] == heights.shape[0] // 2
    modulus = storage - 1j * jnp.where(nyquist, 0.0, loss)
    # Gap and displacement are looked at a part of a cell behind the pressures.
    angle = kx * lead * sides[0] / heights.shape[0]
    back = jnp.where(nyquist, jnp.cos(angle), jnp.exp(-1j * angle))
    height = jnp.fft.irfft2(
        jnp.fft.rfft2(jnp.max(heights) - heights) * back, s=heights.shape
    )
    height = jnp.where(lead == 0, jnp.max(heights) - heights, height)
    on = Grid(2 / (k * modulus) * back, k * modulus / 2 / jnp.where(nyquist, 1.0, back))
    solution = settle(on, height, start, "load", pressure * heights.size, periodic=True)
    pressed = jnp.fft.rfft2(solution.pressure)
    # The mean of u is that of no pressure: on the contact u and height differ by the
    # level of the far surface.
    u = jnp.fft.irfft2(
        jnp.where((kx == 0) & (ky == 0), 0.0, pressed * on.kernel), s=heights.shape
    )
    touching = solution.pressure > 0
    level = jnp.sum(jnp.where(touching, u + height, 0.0)) / jnp.maximum(
        jnp.sum(touching), 1
    )
    waves = jnp.abs(pressed / heights.size) ** 2
    # waves that the transform of a real map leaves out
    twice = jnp.where((ky == 0) | (ky == jnp.max(ky)), 1.0, 2.0)
    stress = jnp.sum(
        jnp.where(
            nyquist, 0.0, twice * waves * 2 * kx * loss / (k * jnp.abs(modulus) ** 2)
        )
    )
    return _Found(
        stress, jnp.mean(touching), jnp.mean(height) - level, touching, solution.settled
    )


def _sides(cell: Any) -> np.ndarray:
    sides = as_float64("cell", cell)
    if sides.shape not in ((), (2,)):
        raise InputError(
            "cell must be the sides (L_x, L_y) of a periodic cell in m, or one for "
            f"both, got {cell!r}."
        )
    positive("cell", sides)
    return np.broadcast_to(sides, (2,)).copy()


def _heights(shape: Any, sides: np.ndarray, points: int) -> tuple[np.ndarray, str]:
    """Heights into the rubber [m] on the cell, and what they are in words."""
    if isinstance(shape, AbstractShape):
        x, y = (np.arange(points) / points - 0.5 for _ in range(2))
        r = np.hypot(x[:, None] * sides[0], y[None] * sides[1])
        widest = float(shape.largest_contact)
        if widest < r.max():
            raise InputError(
                f"cell must lie within the body, whose radius is {widest:g} m, got "
                f"{_metres(sides)}."
            )
        return -np.asarray(shape.height(r)), f"{describe(shape)}, one in each cell"
    heights = np.asarray(as_float64("shape", shape))
    if (
        heights.ndim != 2
        or any(n % 4 or n < 8 for n in heights.shape)
        or not np.isfinite(heights).all()
    ):
        raise InputError(
            "shape must be a body or a map of heights [m] into the rubber, finite, "
            "(n_x, n_y), with n_x and n_y "
            f"multiples of 4 and at least 8, got shape {heights.shape}."
        )
    return heights, f"map of heights, {math.sqrt(np.var(heights)):.3g} m rms"


def _metres(sides: np.ndarray) -> str:
    return f"{brief(sides[0], 'm')} by {brief(sides[1], 'm')}"
