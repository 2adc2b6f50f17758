"""A rigid body above elements at fixed material points: where its surface is, and what
it does to each of them.

The body stands at X along the line, at depth d. Over the element at x its surface is at

    w = d + b(x - X),    b = -g(x - X) for an indenter,    b = h(x - X) - max h for a rough line,

and dw = dd + (db/dX) dX: with the force q of the elements, F_N = sum q W and F_x = sum
q (db/dX) W are the forces that do work on d and on X, W the weight of an element. F_x
is positive where it resists a motion towards +x.
"""

from __future__ import annotations

import abc
from typing import TYPE_CHECKING, Any, ClassVar

from ..arrays import compiled, stop_gradient, xp
from ..checks import Array
from ..material.relaxation import Relaxation
from ..smooth.passage import Control, estimate_sizes
from ..surface.lines import AbstractLines, SingleLine
from ..surface.rough_line import spline, spline_coefficients
from ..surface.shapes import AbstractShape
from ..trees import Tree

if TYPE_CHECKING:
    from jaxtyping import Float

# where the surface is beyond the end of a body: far above any rubber [m]
NOTHING = -1e3


class AbstractOverLine(Tree):
    """A rigid surface above n elements."""

    weight: Array  # of an element's force in the total, scalar or (n,)
    spacing: Array  # of elements [m]
    # distances that there are before the first element, of a contact that begins there
    first: ClassVar[float] = 0.0

    @property
    @abc.abstractmethod
    def count(self) -> int:
        """Number of elements n."""

    @property
    @abc.abstractmethod
    def between(self) -> bool:
        """Whether the elements are neighbours, and the contact is taken to end between
        them.
        """

    @abc.abstractmethod
    def rise(self, position: Array) -> Float[Array, " n"]:
        """b [m], the surface over each element when the body stands at X [m] with d =
        0.
        """

    @abc.abstractmethod
    def rise_and_slope(
        self, position: Array
    ) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
        """b [m] and db/dX."""


class Indenter(AbstractOverLine):
    """An indenter above the line of a half-space, or above the strips of a layer;
    `weight` is dx, or dx dy.

    `track` is b of a rough track fixed to the line [m], added to that of the body: zero
    where the line is smooth. db/dX is its mean over the element, (b(x - dx/2) - b(x +
    dx/2))/dx: at the tip of a cone, where it jumps, its value in the middle would make
    F_x first order in dx.
    """

    shape: AbstractShape
    x: Float[Array, " n"]  # places of the elements [m]
    # distance of each element's strip from the middle [m]; None for a single line
    y: Float[Array, " n"] | None
    track: Array  # height of the track at the elements, scalar or (n,) [m]

    @property
    def count(self) -> int:
        return self.x.shape[0]

    @property
    def between(self) -> bool:
        return self.y is None

    def rise(self, position: Array) -> Array:
        return self.rise_and_slope(position)[0]

    def rise_and_slope(self, position: Array) -> tuple[Array, Array]:
        x, half = self.x - position, 0.5 * self.spacing
        inside = self._distance(x) < self.shape.largest_contact
        slope = (self._height(x + half) - self._height(x - half)) / self.spacing
        # Beyond the end of the body there is nothing to touch.
        return xp.where(inside, self.track - self._height(x), NOTHING), xp.where(
            inside, slope, 0.0
        )

    def _distance(self, x: Array) -> Array:
        return xp.abs(x) if self.y is None else xp.hypot(x, self.y)

    def _height(self, x: Array) -> Array:
        """g over the line, or the height of the body over a strip, at x from the
        middle; level beyond its end.
        """
        end = self.shape.largest_contact
        r = self._distance(x)
        r = xp.where(r < end, r, xp.where(xp.isinf(end), 0.0, end * (1 - 1e-12)))
        return self.shape._profile(r) if self.y is None else self.shape._height(r)


class Rough(AbstractOverLine):
    """A rough line above one period of the rubber; the weight 1/n makes means per
    length of all sums.
    """

    coefficients: Float[Array, " n"]  # of its spline [m]
    highest: Array  # max h over the points [m]

    @property
    def count(self) -> int:
        return self.coefficients.shape[0]

    @property
    def between(self) -> bool:
        return False  # of many contacts the errors cancel

    def rise(self, position: Array) -> Array:
        return self.rise_and_slope(position)[0]

    def rise_and_slope(self, position: Array) -> tuple[Array, Array]:
        height, slope = spline(self.coefficients, -position / self.spacing)
        return height - self.highest, -slope / self.spacing


def rough(height: Float[Array, " n"], spacing: Array | float, highest: Array) -> Rough:
    """One element under each point of a rough line; `highest` is what the depth counts
    from.
    """
    return Rough(
        xp.asarray(1 / height.shape[0]),
        xp.asarray(spacing),
        xp.asarray(spline_coefficients(height)),
        highest,
    )


@compiled("count")
def indenter(
    lines: AbstractLines, first: Array | float, spacing: Any, count: int, width: Any
) -> Indenter:
    """Elements at `first` + i `spacing`, i < `count`, under an indenter; on a layer
    also across, up to `width`.
    """
    x, zero = first + spacing * xp.arange(count), xp.zeros(())
    if isinstance(lines, SingleLine):
        weight = spacing * lines.weight(xp.ones(1))[0, 0]
        return Indenter(
            shape=lines.shape,
            x=x,
            y=None,
            spacing=xp.asarray(spacing),
            weight=weight,
            track=zero,
        )
    strips = -(-count // 2)
    across = width / strips
    y = (xp.arange(strips) + 0.5) * across
    x, y = (
        coordinate.reshape(-1)
        for coordinate in xp.broadcast_arrays(x[None], y[:, None])
    )
    weight = 2 * spacing * across
    return Indenter(
        shape=lines.shape,
        x=x,
        y=y,
        spacing=xp.asarray(spacing),
        weight=weight,
        track=zero,
    )


@compiled("control")
def contact_sizes(
    law: Relaxation,
    lines: AbstractLines,
    control: Control,
    value: Array,
    duration: float,
) -> tuple[Any, Any]:
    """The smallest and the largest contact radius to expect [m], each within a factor
    of 2.

    The largest is that of the relaxed rubber under the largest load, or for a liquid of
    what creeps in the time given.
    """
    law, lines, value = stop_gradient((law, lines, value))
    glass = law.equilibrium + xp.sum(law.moduli) + law.viscosity / duration
    # A lower bound of E(t): each branch, and the dashpot, as a spring that has relaxed
    # for the whole time.
    soft = (
        law.equilibrium
        + xp.sum(law.moduli / (1 + duration / law.times))
        + law.viscosity / duration
    )
    top = xp.max(value)
    positive_values = xp.where(value > 0, value, top)
    ends = xp.stack([xp.min(positive_values), top])
    ends = xp.where(ends > 0, ends, 1e-9)
    sizes = []
    for modulus, end in zip((glass, soft), ends, strict=True):
        spring = Relaxation(modulus, xp.zeros(1), xp.ones(1), xp.zeros(()))
        sizes.append(estimate_sizes(spring, lines, control, end[None], xp.ones(1))[0])
    return sizes[0], xp.maximum(*sizes)
