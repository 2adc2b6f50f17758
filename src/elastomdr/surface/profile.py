"""An axisymmetric indenter given as points, and the exact MDR profile of the curve
through them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from ..arrays import arrays, compiled, fori_loop, lax_map, xp
from ..checks import (
    Array,
    alike,
    as_float64,
    ascending,
    certain,
    is_traced,
    not_negative,
    numpy_unless_traced,
    one_of,
    possible,
    require,
    untraced,
)
from ..errors import InputError
from ..numerics.interpolation import monotone_slopes
from ..trees import fill, static
from .shapes import AbstractShape

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike

# of the Chebyshev series of g between two points: its singularities are an interval
# away
_TERMS = 18
_DELTA = 1e-12  # of an interval
_FALL = 1e-9  # of the largest dg/dx: what counts as rounding in a fall
_START, _END = _DELTA**0.5, (1 + _DELTA) ** 0.5


class Profile(AbstractShape):
    """f(r) through given points, joined by cubics.

    `curve`: "spline" is twice continuously differentiable (not-a-knot outside), with an
    error of fourth order in the spacing of the points. At a bend, as on a truncated or
    crowned body, it overshoots; "monotone" does not: f' is continuous and nowhere
    negative (Fritsch & Butland 1984), of second order at a bend and third elsewhere.
    "auto" takes the spline unless it falls somewhere.

    The MDR profile of the curve is exact: Abel's integral has a closed form on f'(r) =
    A_0 + A_1 r + A_2 r^2 + sum_i [b_i (r - r_i)_+ + c_i (r - r_i)_+^2] (kept as
    Chebyshev series between the points, to rounding).

    `r` [m] starts at 0 and ascends, four points at least; `z` [m] is the height,
    counted from z[0]. `apex` says whether the body is "smooth" on its axis (f'(0) = 0)
    or "sharp"; "auto" looks at the points. Raises `InputError` where the points do not
    describe an indenter: z must not fall, and the contact must be able to grow as a
    disc (dg/dx >= 0).
    """

    r: Float[Array, " n"]  # [m]
    z: Float[Array, " n"]  # [m]
    pieces: Float[Array, "3 n-1"]  # f = z_i + p_1 t + p_2 t^2 + p_3 t^3, t = r - r_i
    # g and dg/dx as Chebyshev series between the points
    line: Float[Array, "2 degree n-1"]
    sharp: bool = static()  # f'(0) > 0
    # g is convex: an element that has left the contact never touches again
    convex: bool = static()
    label: ClassVar[str] = "profile from points"

    def __init__(
        self,
        r: ArrayLike,
        z: ArrayLike,
        *,
        apex: Literal["auto", "smooth", "sharp"] = "auto",
        curve: Literal["auto", "spline", "monotone"] = "auto",
    ):
        r, z = as_float64("r", r), as_float64("z", z)
        _check_points(r, z)
        one_of("apex", apex, "auto", "smooth", "sharp")
        one_of("curve", curve, "auto", "spline", "monotone")
        sharp = apex == "sharp" or (apex == "auto" and certain(_looks_sharp, r, z))
        fill(self, r=r, z=z, sharp=sharp, convex=True)
        self._join("spline" if curve == "auto" else curve)
        if is_traced(z):
            return
        slope = self._slopes()
        if curve == "auto" and slope.min() < -_FALL * np.abs(slope).max():
            self._join("monotone")
            slope = self._slopes()
        if not (slope >= -_FALL * np.abs(slope).max()).all() or slope.max() <= 0:
            raise InputError(
                argument="z",
                got=float(slope.min()),
                accepted="of a body whose contact grows as a disc, with an MDR "
                "profile that rises (0 < dg/dx)",
                hint="it falls like this near x = "
                f"{8 * r[-1] * (slope.argmin() + 1) / (64 * r.size + 8):.3g} m; "
                "smooth the points, or leave out the part beyond which the contact "
                "would jump",
            )
        fill(self, convex=bool((np.diff(slope) > -1e-6 * slope.max()).all()))

    def _join(self, curve: Literal["spline", "monotone"]) -> None:
        """Joins the points by cubics, and finds the MDR profile of that curve."""
        pieces, line = _joined(self.r, self.z, self.sharp, curve)
        fill(self, pieces=pieces, line=line)

    def __repr__(self) -> str:
        apex = "sharp" if self.sharp else "smooth"
        return (
            f"Profile({self.r.size} points to r={float(self.r[-1]):.6g} m, {apex} apex)"
        )

    def _slopes(self) -> np.ndarray:
        """dg/dx at eight places between any two points."""
        return np.asarray(
            self.slope_1d(np.linspace(0.0, float(self.r[-1]), 8 * self.r.size + 1)[1:])
        )

    def _height(self, r: Array) -> Array:
        knots, heights, pieces = arrays((self.r, self.z, self.pieces))
        i = _interval(knots, r)
        t = r - knots[i]
        height = (
            heights[i]
            + t * (pieces[0][i] + t * (pieces[1][i] + t * pieces[2][i]))
            - heights[0]
        )
        return self._guard(r, height)

    def _steepness(self, r: Array) -> Array:
        knots, pieces = arrays((self.r, self.pieces))
        i = _interval(knots, r)
        t = r - knots[i]
        return self._guard(
            r, pieces[0][i] + t * (2 * pieces[1][i] + 3 * t * pieces[2][i])
        )

    def _profile(self, x: Array) -> Array:
        x = xp.abs(x)
        linear, square, cubic = self.pieces[:, 0]
        near = x * (0.5 * xp.pi * linear + x * (2 * square + 0.75 * xp.pi * cubic * x))
        return self._guard(
            x, xp.where(x <= self.r[1], near, _interpolated(self.r, self.line[0], x))
        )

    def _slope(self, x: Array) -> Array:
        # Up to the first point the curve is one cubic. Its own form keeps its digits in
        # a contact far smaller than that, where a series that is right to rounding of
        # its largest value has none left.
        sign, x = xp.sign(x), xp.abs(x)
        linear, square, cubic = self.pieces[:, 0]
        near = 0.5 * xp.pi * linear + x * (4 * square + 2.25 * xp.pi * cubic * x)
        return self._guard(
            x,
            sign
            * xp.where(x <= self.r[1], near, _interpolated(self.r, self.line[1], x)),
        )

    def _guard(self, x: Array, value: Array) -> Array:
        return xp.where(x <= self.r[-1] * (1 + 1e-12), value, xp.nan)

    @property
    def largest_contact(self) -> Array | float:
        return self.r[-1]


def _check_points(r: Array, z: Array) -> None:
    """Raises `InputError` unless they are radii from 0 on and heights that do not
    fall.
    """
    alike(4, {"r": r, "z": z})
    untraced(
        InputError(
            argument="r",
            accepted="plain numbers",
            hint="a Profile has derivatives by its heights z only",
        ),
        r,
    )
    not_negative("r", r)
    ascending("r", r)
    require("r", r, "below 1e50 m", lambda x: x < 1e50)
    require("z", z, "finite, and below 1e50 m", lambda x: np.abs(x) < 1e50)
    if r[0] != 0:
        raise InputError(
            argument="r",
            got=float(r[0]),
            accepted="0 for its first point, the lowest of the indenter",
        )
    if not possible(lambda z: (np.diff(z) >= 0).all(), z):
        i = int(np.argmax(np.diff(z) < 0))
        raise InputError(
            argument="z",
            got=float(z[i + 1]),
            accepted=f"{z[i]:g} m or more at r={r[i + 1]:g}, since it may not fall",
        )


def _looks_sharp(r: Array, z: Array) -> bool:
    """Whether the points rise from the axis at an angle."""
    from scipy.interpolate import CubicSpline

    slope = CubicSpline(r, z, bc_type="not-a-knot").derivative()([0.0, r[1]])
    flat = z[1] - z[0] <= _FALL * (z[-1] - z[0])
    return bool(slope[0] > 0.2 * abs(slope[1])) and not flat


@numpy_unless_traced
def _joined(r: Array, z: Array, sharp: bool, curve: str) -> tuple[Array, Array]:
    """`pieces` and `line` of a curve through the points."""
    pieces = (
        _spline_matrices(np.asarray(r), sharp) @ z
        if curve == "spline"
        else _monotone(r, z, sharp)
    )
    return pieces, _line(r, pieces)


@numpy_unless_traced
@compiled()
def _line(r: Array, pieces: Array) -> Float[Array, "2 degree intervals"]:
    """Chebyshev coefficients of g and of dg/dx between the points.

    Each point leaves a term (x - r_i)^(1/2) or (x - r_i)^(3/2) in dg/dx, so that it is
    analytic in s = sqrt((x - r_i)/h_i + delta) on the interval behind the point; delta
    keeps ds/dx finite at the point itself.
    """
    linear, square, cubic = pieces
    apex = xp.stack([linear[0], 2 * square[0], 3 * cubic[0]])
    jumps = xp.stack(
        [2 * xp.diff(square) - 6 * cubic[:-1] * xp.diff(r)[:-1], 3 * xp.diff(cubic)]
    )
    angle = np.pi * (np.arange(_TERMS) + 0.5) / _TERMS
    s = _START + (_END - _START) * 0.5 * (1 - np.cos(angle))
    to_chebyshev = np.cos(np.arange(_TERMS)[:, None] * (np.pi - angle)) * 2 / _TERMS
    to_chebyshev[0] *= 0.5

    def fit(ends):
        x = ends[0] + (ends[1] - ends[0]) * (s**2 - _DELTA)
        return to_chebyshev @ xp.stack(_abel(x, apex, r[1:-1], jumps), axis=1)

    return xp.moveaxis(lax_map(fit, xp.stack([r[:-1], r[1:]], axis=1)), 0, 2).swapaxes(
        0, 1
    )


def _interpolated(r: Array, table: Float[Array, "degree intervals"], x: Array) -> Array:
    """A Chebyshev series of `_line` at places x >= 0, by Clenshaw's recurrence."""
    r, table = arrays((r, table))
    interval = _interval(r, x)
    start, width = r[interval], (r[1:] - r[:-1])[interval]
    s = xp.sqrt(xp.maximum((x - start) / width, 0.0) + _DELTA)
    t = 2 * (s - _START) / (_END - _START) - 1

    def down(i, state):
        value, after = state
        return 2 * t * value - after + table[_TERMS - 1 - i][interval], value

    # A loop, not a chain of gathers: that takes a minute to compile where a scene has
    # many calls of it.
    value, after = fori_loop(0, _TERMS - 1, down, (xp.zeros_like(x), xp.zeros_like(x)))
    return t * value - after + table[0][interval]


def _interval(r: Array, x: Array) -> Array:
    """The interval of `r` in which each x lies; the outer ones for what lies
    outside.
    """
    return xp.clip(xp.searchsorted(r, x, side="right") - 1, 0, r.shape[0] - 2)


def _abel(x: Array, apex: Array, knots: Array, jumps: Array) -> tuple[Array, Array]:
    """g and dg/dx of the curve at places x >= 0, in closed form.

    g = x int_0^x f'/sqrt(x^2 - r^2) dr and dg/dx = int_0^x (r f')'/sqrt(x^2 - r^2) dr:
    the same integrals on two quadratics.
    """
    inside = x[:, None] > knots
    # any value will do: the result is masked
    safe = xp.where(inside, x[:, None], knots + 1.0)
    root = xp.sqrt((safe - knots) * (safe + knots))
    # int r^p / sqrt(x^2 - r^2) dr from the knot to x, p = 0, 1, 2
    k0, k1 = xp.arctan2(root, knots), root
    k2 = 0.5 * (safe**2 * k0 + knots * k1)
    b, c = xp.where(inside, jumps[0], 0.0), xp.where(inside, jumps[1], 0.0)
    g = x * (0.5 * xp.pi * apex[0] + x * (apex[1] + 0.25 * xp.pi * apex[2] * x))
    slope = 0.5 * xp.pi * apex[0] + x * (2 * apex[1] + 0.75 * xp.pi * apex[2] * x)
    g = g + x * xp.sum(
        b * (k1 - knots * k0) + c * (k2 - 2 * knots * k1 + knots**2 * k0), axis=1
    )
    return g, slope + xp.sum(
        b * (2 * k1 - knots * k0) + c * (3 * k2 - 4 * knots * k1 + knots**2 * k0),
        axis=1,
    )


def _spline_matrices(r: np.ndarray, sharp: bool) -> Float[np.ndarray, "3 n-1 n"]:
    """Linear map from heights to the pieces of the spline."""
    ends: Any = ("not-a-knot" if sharp else (1, np.zeros(r.size)), "not-a-knot")
    from scipy.interpolate import CubicSpline

    return CubicSpline(r, np.eye(r.size), bc_type=ends).c[2::-1]


@numpy_unless_traced
@compiled()
def _monotone(r: Array, z: Array, sharp: bool) -> Float[Array, "3 n-1"]:
    """Pieces of the cubics whose slope at a point is the weighted harmonic mean of the
    slopes on its two sides.
    """
    h = xp.diff(r)
    m = xp.diff(z) / h
    slopes = monotone_slopes(r, z)
    start = xp.where(sharp, slopes[:1], 0.0)
    d = xp.concatenate([start, slopes[1:]])
    return xp.stack(
        [d[:-1], (3 * m - 2 * d[:-1] - d[1:]) / h, (d[:-1] + d[1:] - 2 * m) / h**2]
    )
