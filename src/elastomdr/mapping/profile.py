"""An axisymmetric indenter given as points, and the exact MDR profile of the spline through them."""

from typing import Any, ClassVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

from .._runtime import Array, as_float64, ascending, in_float64, is_traced, not_negative, require
from ..errors import InputError
from .shapes import AbstractShape

_TERMS = 18  # of the Chebyshev series of g between two points: its singularities are an interval away
_DELTA = 1e-12  # of an interval
_START, _END = _DELTA**0.5, (1 + _DELTA) ** 0.5


class Profile(AbstractShape):
    """f(r) through given points, joined by a cubic spline (twice continuously differentiable, not-a-knot outside).

    The MDR profile of the spline is exact: on f'(r) = A_0 + A_1 r + A_2 r^2 + sum_i c_i (r - r_i)_+^2 Abel's integral
    has a closed form (kept as Chebyshev series between the points, to rounding). So what remains is the spline's own
    error, of fourth order in the spacing of the points.

    `r` [m] starts at 0 and ascends, four points at least; `z` [m] is the height, counted from z[0]. `apex` says whether
    the body is "smooth" on its axis (f'(0) = 0) or "sharp"; "auto" looks at the points. Raises `InputError` where the
    points do not describe an indenter: z must not fall, and the contact must be able to grow as a disc (dg/dx > 0).
    """

    r: Float[Array, " n"]  # [m]
    z: Float[Array, " n"]  # [m]
    apex: Float[Array, "3"]  # A_0, A_1, A_2 of f' in the first interval
    jumps: Float[Array, " n-2"]  # c_i at the inner points
    line: Float[Array, "2 degree n-1"]  # g and dg/dx as Chebyshev series between the points
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
        self.line = _line(r, self.apex, self.jumps)
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
        x = jnp.abs(x)
        return self._guard(x, _interpolated(self.r, self.line[0], x))

    def _slope(self, x: Array) -> Array:
        sign, x = jnp.sign(x), jnp.abs(x)
        return self._guard(x, sign * _interpolated(self.r, self.line[1], x))

    def _guard(self, x: Array, value: Array) -> Array:
        return jnp.where(x <= self.r[-1] * (1 + 1e-12), value, jnp.nan)

    @property
    def largest_contact(self) -> Any:
        return self.r[-1]


@in_float64
@jax.jit
def _line(r: Array, apex: Array, jumps: Array) -> Float[Array, "2 degree intervals"]:
    """Chebyshev coefficients of g and of dg/dx between the points.

    Each point leaves a term (x - r_i)^(3/2) in dg/dx, so that it is analytic in s = sqrt((x - r_i)/h_i + delta) on the
    interval behind the point; delta keeps ds/dx finite at the point itself.
    """
    angle = jnp.pi * (np.arange(_TERMS) + 0.5) / _TERMS
    s = _START + (_END - _START) * 0.5 * (1 - jnp.cos(angle))
    to_chebyshev = jnp.cos(np.arange(_TERMS)[:, None] * (jnp.pi - angle)) * 2 / _TERMS
    to_chebyshev = to_chebyshev.at[0].multiply(0.5)

    def fit(ends):
        x = ends[0] + (ends[1] - ends[0]) * (s**2 - _DELTA)
        return to_chebyshev @ jnp.stack(_abel(x, apex, r[1:-1], jumps), axis=1)

    return jnp.moveaxis(jax.lax.map(fit, jnp.stack([r[:-1], r[1:]], axis=1)), 0, 2).swapaxes(0, 1)


def _interpolated(r: Array, table: Float[Array, "degree intervals"], x: Array) -> Array:
    """A Chebyshev series of `_line` at places x >= 0, by Clenshaw's recurrence."""
    r, table = jnp.asarray(r), jnp.asarray(table)
    interval = jnp.clip(jnp.searchsorted(r, x, side="right", method="scan") - 1, 0, table.shape[1] - 1)
    start, width = r[interval], (r[1:] - r[:-1])[interval]
    s = jnp.sqrt(jnp.maximum((x - start) / width, 0.0) + _DELTA)
    t = 2 * (s - _START) / (_END - _START) - 1

    def down(i, state):
        value, after = state
        return 2 * t * value - after + table[_TERMS - 1 - i][interval], value

    # A loop, not a chain of gathers: that takes a minute to compile where a scene has many calls of it.
    value, after = jax.lax.fori_loop(0, _TERMS - 1, down, (jnp.zeros_like(x), jnp.zeros_like(x)))
    return t * value - after + table[0][interval]


def _abel(x: Array, apex: Array, knots: Array, jumps: Array) -> tuple[Array, Array]:
    """g and dg/dx of the spline at places x >= 0, in closed form.

    g = x int_0^x f'/sqrt(x^2 - r^2) dr and dg/dx = int_0^x (r f')'/sqrt(x^2 - r^2) dr: the same integrals on two
    quadratics.
    """
    inside = x[:, None] > knots
    safe = jnp.where(inside, x[:, None], knots + 1.0)  # any value will do: the result is masked
    root = jnp.sqrt((safe - knots) * (safe + knots))
    k0, k1 = jnp.arctan2(root, knots), root  # int r^p / sqrt(x^2 - r^2) dr from the knot to x, p = 0, 1, 2
    k2 = 0.5 * (safe**2 * k0 + knots * k1)
    jumps = jnp.where(inside, jumps, 0.0)
    g = x * (0.5 * jnp.pi * apex[0] + x * (apex[1] + 0.25 * jnp.pi * apex[2] * x))
    slope = 0.5 * jnp.pi * apex[0] + x * (2 * apex[1] + 0.75 * jnp.pi * apex[2] * x)
    g = g + x * jnp.sum(jumps * (k2 - 2 * knots * k1 + knots**2 * k0), axis=1)
    return g, slope + jnp.sum(jumps * (3 * k2 - 4 * knots * k1 + knots**2 * k0), axis=1)


def _spline_matrices(r: np.ndarray, sharp: bool) -> tuple[np.ndarray, np.ndarray]:
    """Linear maps from heights to f' = A_0 + A_1 r + A_2 r^2 in the first interval, and to its jumps c_i at inner
    points.
    """
    ends: Any = ("not-a-knot" if sharp else (1, np.zeros(r.size)), "not-a-knot")
    cubic, square, linear, _ = CubicSpline(r, np.eye(r.size), bc_type=ends).c  # (intervals, n) each
    return np.stack([linear[0], 2 * square[0], 3 * cubic[0]]), 3 * np.diff(cubic, axis=0)
