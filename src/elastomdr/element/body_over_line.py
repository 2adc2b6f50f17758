"""A rigid body above elements at fixed material points: where its surface is, what it
does to each of them, and the depth at which they carry a load.

The body stands at X along the line, at depth d. Over the element at x its surface is at

    w = d + b(x - X),    b = -g(x - X) for an indenter,    b = h(x - X) - max h for a rough line,

and dw = dd + (db/dX) dX: with the force q of the elements, F_N = sum q W and F_x = sum
q (db/dX) W are the forces that do work on d and on X, W the weight of an element. F_x
is positive where it resists a motion towards +x.

With u_free the displacement at which an element needs no force at the end of a step and
S its stiffness, both known before the depth is,

    F_N(d) = sum W S max(0, d - l),    l = u_free - b,

convex, piecewise linear and rising: Newton's method from above (`settle`) ends after a
few steps, exactly.
"""

from __future__ import annotations

import abc
import functools
from typing import TYPE_CHECKING, Any, ClassVar

from ..arrays import compiled, on_numpy, stop_gradient, while_loop, xp
from ..checks import Array
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


def felt_by(
    weight: Array, q: Array, slope: Array, excess: Array | None
) -> tuple[Array, Array]:
    """F_N and F_x of the forces q of the elements, db/dX at each of them being `slope`.

    `excess` is what q is in proportion to where it is positive, if the contact ends
    between two elements (`force_on_line`).
    """
    normal, drag = total(weight, q), total(weight, q * slope)
    if excess is None:
        return normal, drag
    edge, _ = edges(excess)
    a, b = xp.abs(excess[:-1]), xp.abs(excess[1:])
    slope_at_edge = (a * slope[1:] + b * slope[:-1]) / xp.where(a + b > 0, a + b, 1.0)
    top = xp.max(excess)  # q is S times what is positive of it
    stiffness = inner(weight) * xp.max(q) / xp.where(top > 0, top, 1.0)
    at_edge = total(stiffness, edge), total(stiffness, edge * slope_at_edge)
    return normal + at_edge[0], drag + at_edge[1]


def settle(
    touch_depth: Array,
    slope: Array,
    spring: Any,
    force: Array,
    guess: Array,
    between: bool = False,
) -> Array:
    """The depth d at which spring d + sum slope max(0, d - touch_depth) = force,
    exactly, by Newton's method from above.

    `touch_depth` is the depth of the body at which it touches each element.

    `slope` is W S, scalar or (n,). With `between` the sum is that of `force_on_line`.
    Without a spring the force must not be negative; for no force d is where the first
    element is touched.
    """
    return (_settle if on_numpy() else _traced_settle())(
        touch_depth, slope, spring, force, guess, between
    )


def _settle(
    touch_depth: Array,
    slope: Array,
    spring: Array | float,
    force: Array,
    guess: Array,
    between: bool,
) -> Array:
    lowest = xp.min(touch_depth)

    def again(state):
        depth, stiffness, before, last, tries = state
        changes = (depth < last) | (tries < 2) if between else stiffness != before
        return changes & (tries < 200)

    def improve(state):
        # From above the elements in contact only become fewer: as stiff as before is
        # the same ones.
        depth, before, _, _, tries = state
        improved, stiffness = (
            _corrected(touch_depth, lowest, slope, spring, force, depth)
            if between
            else _newton(touch_depth, lowest, slope, spring, force, touch_depth < depth)
        )
        return improved, stiffness, before, depth, tries + 1

    return while_loop(again, improve, (guess, -1.0, -2.0, xp.inf, 0))[0]


@functools.cache
def _traced_settle() -> Any:
    """`_settle` with its derivative, for which the elements in contact stay the same
    ones.
    """
    import jax

    settle = functools.partial(jax.custom_jvp, nondiff_argnums=(5,))(_settle)

    @settle.defjvp
    def derivative(between: bool, given: tuple, tangents: tuple) -> tuple[Array, Array]:
        depth = settle(*given, between)

        def moved(
            touch_depth: Array, slope: Array, spring: Array | float, force: Array
        ) -> Array:
            if between:
                return _corrected(
                    touch_depth, xp.min(touch_depth), slope, spring, force, depth
                )[0]
            return _newton(
                touch_depth, xp.min(touch_depth), slope, spring, force, given[0] < depth
            )[0]

        return depth, jax.jvp(moved, given[:4], tangents[:4])[1]

    return settle


def _corrected(
    touch_depth: Array,
    lowest: Array,
    slope: Array,
    spring: Array | float,
    force: Array,
    depth: Array,
) -> tuple[Array, Array]:
    """The depth after one step of Newton's from `depth`, and the stiffness there."""
    now, stiffness = force_on_line(slope, depth - touch_depth)
    stiffness = stop_gradient(spring + stiffness)
    empty = stiffness <= 0
    step = (force - spring * depth - now) / xp.where(empty, 1.0, stiffness)
    alone = slope if slope.ndim == 0 else xp.max(slope)
    return xp.where(empty, lowest + force / alone, depth + step), stiffness


def _newton(
    touch_depth: Array,
    lowest: Array,
    slope: Array,
    spring: Array | float,
    force: Array,
    active: Array,
) -> tuple[Array, Array]:
    """The depth at which those that are `active` carry the force, and their
    stiffness.
    """
    stiffness = spring + total(slope, xp.where(active, 1.0, 0.0))
    # Without a spring one element at least carries the load. (The place of the least
    # level takes long to find.)
    alone = (
        slope
        if slope.ndim == 0
        else xp.max(xp.where(touch_depth == lowest, slope, 0.0))
    )
    empty = stiffness <= 0
    load = force + xp.where(
        empty, alone * lowest, total(slope, xp.where(active, touch_depth, 0.0))
    )
    return load / xp.where(empty, alone, stiffness), stiffness


def force_on_line(slope: Array, excess: Float[Array, " n"]) -> tuple[Array, Array]:
    """The force where a contact ends between two elements, and how much it grows as all
    of `excess` grows by one.

    It is the integral of the positive part of the line drawn through the elements,
    which are neighbours at equal distances. sum slope max(0, excess) errs by the square
    of their distance as well, but with a factor that depends on where the contact ends,
    so that the limit of ever more elements could not be extrapolated from a few.
    """
    edge, rate = edges(excess)
    inside = excess > 0
    between = inner(slope)
    force = total(slope, xp.where(inside, excess, 0.0)) + total(between, edge)
    return force, total(slope, xp.where(inside, 1.0, 0.0)) + total(between, rate)


def inner(weight: Array) -> Array:
    """The weight of what lies between two elements: of the one nearer to the axis."""
    return weight if weight.ndim == 0 else weight[:-1]


def edges(
    excess: Float[Array, " n"],
) -> tuple[Float[Array, " n-1"], Float[Array, " n-1"]]:
    """What the positive part of a line from a to b, a b < 0, has less than the mean of
    max(0, a) and max(0, b).
    """
    a, b = excess[:-1], excess[1:]
    between = a * b < 0
    span = xp.where(between, 2 * xp.abs(a - b), 1.0)
    return xp.where(between, a * b / span, 0.0), xp.where(between, (a + b) / span, 0.0)


def total(weight: Array, values: Float[Array, " n"]) -> Array:
    """The sum over all elements."""
    return weight * xp.sum(values) if weight.ndim == 0 else xp.sum(weight * values)
