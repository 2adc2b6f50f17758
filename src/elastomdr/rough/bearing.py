"""A rigid rough line pressed into elements: how deep it comes, how much of it touches,
and what that conducts.

Let g be how far each place of a line of heights h lies below its highest one. At the
depth d a share s(d) has g < d, and the elements carry the mean N(d) = <max(d - g, 0)>
times the modulus, so that N' = s. Between its points the line is taken as straight: s
is then a straight line and N a parabola between one sorted end of a piece and the next,
and the depth for a load follows in closed form, with its derivatives.

The mean displacement of the surface belongs to the bulk, not to the interface. Less of
it, the mean gap and the stiffness against it are

    gap = <g> - d + N,    d(load)/d(-gap) = s/(1 - s),

which goes to infinity in full contact, as that of a half-space does.
"""

from typing import Any, NamedTuple

import numpy as np

from ..arrays import xp

# least rise of a piece over that of the line: a horizontal one would be a jump of s
_FLAT = 1e-6


class Bearing(NamedTuple):
    """The share and the mean load of a line over its depth, at the sorted ends of its
    pieces.
    """

    depth: Any  # [m]
    share: Any
    load: Any  # N [m]
    rate: Any  # ds/dd from here to the next [1/m]
    mean: Any  # <g> [m], the height of the highest peak over the mean


class Pressed(NamedTuple):
    """A line under a load."""

    depth: Any  # from the first touch, with the mean displacement of the surface [m]
    gap: Any  # mean distance of the surfaces [m]
    share: Any  # of the line in contact


def bearing(height: Any) -> Bearing:
    """The table of a periodic line of evenly spaced heights [m]."""
    g = xp.max(height) - height
    least = _FLAT * xp.max(g)
    following = xp.roll(g, -1)
    middle, half = 0.5 * (g + following), 0.5 * xp.maximum(abs(following - g), least)
    middle = xp.maximum(middle, half)  # a flat summit begins at the first touch
    ends = xp.concatenate([middle - half, middle + half])
    steps = xp.concatenate([0.5 / half, -0.5 / half]) / g.size
    order = xp.argsort(ends)
    depth, rate = ends[order], xp.cumsum(steps[order])
    width = xp.diff(depth)
    share = xp.concatenate([xp.zeros(1), xp.cumsum(rate[:-1] * width)])
    load = xp.concatenate(
        [xp.zeros(1), xp.cumsum((share[:-1] + 0.5 * rate[:-1] * width) * width)]
    )
    return Bearing(depth, share, load, rate, xp.mean(middle))


def pressed(on: Bearing, load: Any) -> Pressed:
    """The line under mean loads over the modulus [m], p L/E*, any shape."""
    last = on.depth.shape[0] - 1
    at = xp.clip(xp.searchsorted(on.load, load, side="right") - 1, 0, last - 1)
    share, rate, more = on.share[at], on.rate[at], load - on.load[at]
    root = xp.sqrt(xp.maximum(share**2 + 2 * rate * more, 1e-300))
    further = 2 * more / (share + root)
    full = load >= on.load[last]
    depth = xp.where(full, on.mean + load, on.depth[at] + further)
    share = xp.where(full, 1.0, xp.clip(share + rate * further, 0.0, 1.0))
    return Pressed(
        depth, xp.where(full, 0.0, xp.maximum(on.mean - depth + load, 0.0)), share
    )


def highest(spread: Any, steepness: Any, area: Any, chance: float = 0.05) -> Any:
    """Height that the highest peak of a Gaussian surface exceeds with a small chance,
    in units of `spread`.

    `spread` is the rms height, `steepness` the rms slope along one direction. The
    expected Euler characteristic of what stands above u rms heights, area
    (steepness/spread)^2 u exp(-u^2/2)/(2 pi)^(3/2), is the chance that anything does
    (Adler, The Geometry of Random Fields, 1981).
    """
    number = xp.maximum(
        area * (steepness / spread) ** 2 / (2 * np.pi) ** 1.5 / chance, 2.0
    )
    u = xp.sqrt(2 * xp.log(number))
    for _ in range(20):
        u = xp.sqrt(2 * xp.log(number * xp.maximum(u, 1.0)))
    return u


def least_conductance(load: Any, peak: Any) -> Any:
    """Least conductance over conductivity [1/m] of elastic rough surfaces under p/E* =
    `load`.

    `peak` is the height of the highest point over the mean [m]. The pressure is a
    convex function of the approach that begins at zero, so that its slope is at least
    that of the chord from there, p/approach >= p/peak (Barber 2003).
    """
    return 2 * load / peak
