"""A rough line: heights at even spacing, periodic, joined by a cubic spline."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..arrays import compiled, on_numpy, stop_gradient, xp
from ..checks import (
    Array,
    alike,
    argmax,
    as_float64,
    ascending,
    finite,
    numpy_unless_traced,
    untraced,
)
from ..errors import InputError
from ..trees import Tree, fill, replaced

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike

_EVEN = 1e-6  # unevenness of x, relative to its spacing, that counts as rounding


class RoughLine(Tree):
    """A rigid rough line h(x), periodic with n dx; heights [m] count positive into the
    rubber.

    Its depth is how far its highest point stands below the undeformed surface, its load
    the mean load per length [N/m]. `x` [m] ascends in even steps, and the last point is
    not the first one again. Between the points the line is the periodic cubic spline through
    them. Differentiable with respect to the heights. Raises `InputError`.
    """

    height: Float[Array, " n"]  # h_i, positive into the rubber [m]
    spacing: Float[Array, ""]  # dx [m]
    label: ClassVar[str] = "rough line"
    load_unit: ClassVar[str] = "N/m"  # per length of line, as of any rough surface

    def __init__(self, x: ArrayLike, height: ArrayLike):
        x, height = as_float64("x", x), as_float64("height", height)
        alike(4, {"x": x, "height": height})
        untraced(
            InputError(
                argument="x",
                accepted="plain numbers",
                hint="a RoughLine has derivatives by its heights",
            ),
            x,
        )
        finite("x", x)
        finite("height", height)
        ascending("x", x)
        n = x.shape[0]
        spacing = (x[-1] - x[0]) / (n - 1)
        even = x[0] + spacing * np.arange(n)
        if np.abs(x - even).max() > _EVEN * spacing:
            worst = float(np.abs(np.diff(x) / spacing - 1).max())
            raise InputError(
                argument="x",
                got=worst,
                accepted="evenly spaced, each step within 1e-6 of their mean",
                hint="np.interp takes the heights at even places",
            )
        fill(self, height=height, spacing=np.asarray(spacing))

    @property
    def count(self) -> int:
        """Number of points n."""
        return self.height.shape[0]

    @property
    def period(self) -> Array:
        """n dx [m]."""
        return self.count * self.spacing

    @property
    def x(self) -> Float[Array, " n"]:
        """Places of the points [m], from 0."""
        return np.arange(self.count) * self.spacing

    @property
    @numpy_unless_traced
    def highest(self) -> Array:
        """The highest place of the spline [m], from which a depth counts; seldom one of
        the points.
        """
        share, heights = _summits(stop_gradient(self.height))
        place = argmax(heights)
        coefficients = spline_coefficients(self.height)
        # Sums, not an index: its derivative would be taken outside of this call.
        near = [
            (place + m) % self.count == xp.arange(self.count) for m in (-1, 0, 1, 2)
        ]
        return _cubic(
            xp.stack([xp.sum(xp.where(here, coefficients, 0.0)) for here in near]),
            share[place],
        )

    @property
    def rms_height(self) -> Array:
        """Root of the mean square of the heights about their mean [m]."""
        return self.height.std()

    @property
    @numpy_unless_traced
    def rms_slope(self) -> Array:
        """Root of the mean square slope of the spline at its points."""
        coefficients = spline_coefficients(self.height)
        slope = (xp.roll(coefficients, -1) - xp.roll(coefficients, 1)) / (
            2 * self.spacing
        )
        return xp.sqrt(xp.mean(slope**2))

    @numpy_unless_traced
    def finer(self, factor: int) -> "RoughLine":
        """The same spline through `factor` times as many points."""
        return line_of_heights(self._finer(factor), self.spacing / factor)

    def _finer(self, factor: int) -> Float[Array, " m"]:
        coefficients = spline_coefficients(self.height)
        near = xp.stack([xp.roll(coefficients, 1 - m) for m in range(4)])
        parts = [_cubic(near, np.asarray(j / factor)) for j in range(factor)]
        return xp.stack(parts, axis=1).reshape(-1)


def line_of_heights(height: Array, spacing: Array | float) -> RoughLine:
    """A line from what needs no check: either may be traced."""
    blank = RoughLine(np.arange(4.0), np.zeros(4))
    return replaced(blank, height=height, spacing=spacing)


def spline_coefficients(height: Float[Array, " n"]) -> Float[Array, " n"]:
    """B-spline coefficients c of the periodic cubic spline: (c_{i-1} + 4 c_i +
    c_{i+1})/6 = h_i.
    """
    angle = 2 * np.pi * np.arange(height.shape[0] // 2 + 1) / height.shape[0]
    spectrum = xp.fft.rfft(height) * 3 / (2 + np.cos(angle))
    return xp.fft.irfft(spectrum, n=height.shape[0])


def _slice(x: Array, start: Array, count: int) -> Array:
    """`count` entries from `start` on: so the compiled loop over four such slices runs
    over whole vectors, five times as fast as over parts of one.
    """
    if on_numpy():
        return x[start : start + count]
    from jax.lax import dynamic_slice

    return dynamic_slice(x, (start,), (count,))


def _cubic(c: Array, t: Array) -> Array:
    """The spline a part t of the way from its second to its third coefficient, of four
    along the first axis.
    """
    u = 1 - t
    return (
        u**3 * c[0]
        + (4 - 6 * t**2 + 3 * t**3) * c[1]
        + (4 - 6 * u**2 + 3 * u**3) * c[2]
        + t**3 * c[3]
    ) / 6


@compiled()
def _summits(height: Float[Array, " n"]) -> tuple[Array, Array]:
    """Where the spline is highest between each point and the next (0 to 1 of the way),
    and how high.
    """
    c = spline_coefficients(height)
    c = xp.stack([xp.roll(c, 1 - m) for m in range(4)])
    # 2 s'(t) = a t^2 + 2 b t + d: the root at which it falls through zero, in the form
    # that loses no digits.
    a, b, d = c[3] - 3 * c[2] + 3 * c[1] - c[0], c[2] - 2 * c[1] + c[0], c[2] - c[0]
    root = xp.sqrt(xp.maximum(b**2 - a * d, 0.0))
    below = root - b
    t = xp.where(below > 0, d / xp.where(below > 0, below, 1.0), 0.0)
    ends = xp.stack([xp.clip(t, 0.0, 1.0), xp.zeros_like(t)])
    heights = _cubic(c[:, None], ends)
    return xp.where(heights[0] > heights[1], ends[0], 0.0), xp.max(heights, axis=0)


def spline(
    coefficients: Float[Array, " n"], shift: Array
) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
    """The spline and its derivative per spacing at the places i + shift, i = 0 ... n-1,
    in units of the spacing.

    All places lie equally far between two points, so that the four weights are common
    to all of them.
    """
    n = coefficients.shape[0]
    whole = xp.floor(shift)
    t = shift - whole
    start = xp.mod(whole.astype(xp.int64) - 1, n)
    wrapped = xp.concatenate([coefficients, coefficients, coefficients[:3]])
    near = [_slice(wrapped, start + m, n) for m in range(4)]
    u = 1 - t
    value = (
        u**3 / 6,
        (4 - 6 * t**2 + 3 * t**3) / 6,
        (4 - 6 * u**2 + 3 * u**3) / 6,
        t**3 / 6,
    )
    slope = (-(u**2) / 2, (3 * t**2 - 4 * t) / 2, (4 * u - 3 * u**2) / 2, t**2 / 2)
    height, steepness = xp.zeros(n), xp.zeros(n)
    for m in range(4):
        height, steepness = height + value[m] * near[m], steepness + slope[m] * near[m]
    return height, steepness
