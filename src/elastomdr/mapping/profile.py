"""An axisymmetric indenter given as points, and the exact MDR profile of the spline through them."""

from typing import Any, ClassVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

from .._runtime import Array, as_float64, ascending, is_traced, not_negative, require
from ..errors import InputError
from .shapes import AbstractShape


class Profile(AbstractShape):
    """f(r) through given points, joined by a cubic spline (twice continuously differentiable, not-a-knot outside).

    The MDR profile of the spline is exact: on f'(r) = A_0 + A_1 r + A_2 r^2 + sum_i c_i (r - r_i)_+^2 Abel's integral
    has a closed form. So what remains is the spline's own error, of fourth order in the spacing of the points.

    `r` [m] starts at 0 and ascends, four points at least; `z` [m] is the height, counted from z[0]. `apex` says whether
    the body is "smooth" on its axis (f'(0) = 0) or "sharp"; "auto" looks at the points. Raises `InputError` where the
    points do not describe an indenter: z must not fall, and the contact must be able to grow as a disc (dg/dx > 0).
    """

    r: Float[Array, " n"]  # [m]
    z: Float[Array, " n"]  # [m]
    apex: Float[Array, "3"]  # A_0, A_1, A_2 of f' in the first interval
    jumps: Float[Array, " n-2"]  # c_i at the inner points
    sharp: bool = eqx.field(static=True)  # f'(0) > 0
    convex: bool = eqx.field(static=True)  # g is convex: an element that has left the contact never touches again
    label: ClassVar[str] = "profile from points"

    def __init__(self, r: Any, z: Any, *, apex: str = "auto"):
        r, z = as_float64("r", r), as_float64("z", z)
        if r.ndim != 1 or r.shape != z.shape or r.shape[0] < 4:
            raise InputError(
                "r and z must be lists of the same length with four points at least, "
                f"got shapes {r.shape} and {z.shape}."
            )
        if is_traced(r):
            raise InputError("r must be plain numbers: a Profile is differentiable in its heights z, not in its radii.")
        not_negative("r", r)
        ascending("r", r)
        require("z", z, "finite", np.isfinite)
        if r[0] != 0:
            raise InputError(f"r must start at 0, the lowest point of the indenter, got r[0]={r[0]:g}.")
        if apex not in ("auto", "smooth", "sharp"):
            raise InputError(f"apex must be 'auto', 'smooth' or 'sharp', got {apex!r}.")
        self.r, self.z, self.convex = r, z, True
        self.sharp = apex == "sharp"
        if apex == "auto" and not is_traced(z):
            start = CubicSpline(r, z, bc_type="not-a-knot").derivative()([0.0, r[1]])
            self.sharp = bool(abs(start[0]) > 0.2 * abs(start[1]))
        first, jumps = _spline_matrices(r, self.sharp)
        self.apex, self.jumps = first @ z, jumps @ z
        if not is_traced(z):
            if (np.diff(z) < 0).any():
                raise InputError(f"z must not fall with r, got a fall at r={r[1:][np.diff(z) < 0][0]:g}.")
            x = np.linspace(0.0, float(r[-1]), 8 * r.size + 1)[1:]
            slope = np.asarray(self.slope_1d(x))
            if not (slope > -1e-9 * np.abs(slope).max()).all() or slope.max() <= 0:
                raise InputError(
                    "z must describe a body whose contact grows as a disc (its MDR profile must rise with x), but "
                    f"dg/dx = {slope.min():.3g} near x = {x[int(np.argmin(slope))]:.3g} m. Smooth the points, or leave "
                    "out the part beyond which the contact would jump."
                )
            self.convex = bool((np.diff(slope) > -1e-6 * slope.max()).all())

    def _height(self, r: Array) -> Array:
        first, knots, jumps = map(jnp.asarray, (self.apex, self.r[1:-1], self.jumps))
        inner = jnp.sum(jumps * jnp.maximum(r[..., None] - knots, 0.0) ** 3, axis=-1) / 3
        return self._guard(r, first[0] * r + first[1] * r**2 / 2 + first[2] * r**3 / 3 + inner)

    def _profile(self, x: Array) -> Array:
        first, knots, jumps = map(jnp.asarray, (self.apex, self.r[1:-1], self.jumps))
        x = jnp.abs(x)
        base = x * (0.5 * jnp.pi * first[0] + x * (first[1] + 0.25 * jnp.pi * first[2] * x))
        k0, k1, k2 = _abel_integrals(x[..., None], knots)
        return self._guard(x, base + x * jnp.sum(jumps * (k2 - 2 * knots * k1 + knots**2 * k0), axis=-1))

    def _slope(self, x: Array) -> Array:
        # dg/dx = int_0^x (r f')' / sqrt(x^2 - r^2) dr: the same integrals on another quadratic.
        first, knots, jumps = map(jnp.asarray, (self.apex, self.r[1:-1], self.jumps))
        sign, x = jnp.sign(x), jnp.abs(x)
        base = 0.5 * jnp.pi * first[0] + x * (2 * first[1] + 0.75 * jnp.pi * first[2] * x)
        k0, k1, k2 = _abel_integrals(x[..., None], knots)
        inner = jnp.sum(jumps * (3 * k2 - 4 * knots * k1 + knots**2 * k0), axis=-1)
        return self._guard(x, sign * (base + inner))

    def _guard(self, x: Array, value: Array) -> Array:
        return jnp.where(x <= self.r[-1] * (1 + 1e-12), value, jnp.nan)

    @property
    def largest_contact(self) -> Any:
        return self.r[-1]


def _abel_integrals(x: Array, knots: Array) -> tuple[Array, Array, Array]:
    """int r^p / sqrt(x^2 - r^2) dr from each knot to x, for p = 0, 1, 2; zero where the knot lies beyond x."""
    inside = x > knots
    x = jnp.where(inside, x, knots + 1.0)  # any value will do: the result is masked
    root = jnp.sqrt((x - knots) * (x + knots))
    k0 = jnp.where(inside, jnp.arctan2(root, knots), 0.0)
    k1 = jnp.where(inside, root, 0.0)
    k2 = 0.5 * (x**2 * k0 + knots * k1)
    return k0, k1, jnp.where(inside, k2, 0.0)


def _spline_matrices(r: np.ndarray, sharp: bool) -> tuple[np.ndarray, np.ndarray]:
    """Linear maps from heights to f' = A_0 + A_1 r + A_2 r^2 in the first interval, and to its jumps c_i at inner
    points.
    """
    start: Any = "not-a-knot" if sharp else (1, np.zeros(r.size))
    cubic, square, linear, _ = CubicSpline(r, np.eye(r.size), bc_type=(start, "not-a-knot")).c  # (intervals, n) each
    return np.stack([linear[0], 2 * square[0], 3 * cubic[0]]), 3 * np.diff(cubic, axis=0)
