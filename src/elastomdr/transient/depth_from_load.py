"""The depth at which elements carry a load: of every march in which the load rules.

With u_free the displacement at which an element needs no force at the end of the step
and S its stiffness, both known before the depth is (`element.contact_step`), and with g
the distance of the body from the element at the depth 0,

    F_N(d) = sum W S max(0, d - l),    l = u_free + g,

convex, piecewise linear and rising: Newton's method from above ends after a few steps,
exactly.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

from ..arrays import fixed, on_numpy, while_loop, xp
from ..checks import Array

if TYPE_CHECKING:
    from jaxtyping import Float


def settle(
    level: Array,
    slope: Array,
    spring: Any,
    force: Array,
    guess: Array,
    between: bool = False,
) -> Array:
    """The depth d at which spring d + sum slope max(0, d - level) = force, exactly, by
    Newton's method from above.

    `slope` is W S, scalar or (n,). With `between` the sum is that of `carried`. Without
    a spring the force must not be negative; for no force d is where the first element
    is touched.
    """
    return (_settle if on_numpy() else _traced_settle())(
        level, slope, spring, force, guess, between
    )


def _settle(
    level: Array, slope: Array, spring: Any, force: Array, guess: Array, between: bool
) -> Array:
    lowest = xp.min(level)

    def again(state):
        depth, stiffness, before, last, tries = state
        changes = (depth < last) | (tries < 2) if between else stiffness != before
        return changes & (tries < 200)

    def improve(state):
        # From above the elements in contact only become fewer: as stiff as before is
        # the same ones.
        depth, before, _, _, tries = state
        found, stiffness = (
            _corrected(level, lowest, slope, spring, force, depth)
            if between
            else _newton(level, lowest, slope, spring, force, level < depth)
        )
        return found, stiffness, before, depth, tries + 1

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

        def moved(level: Array, slope: Array, spring: Any, force: Array) -> Array:
            if between:
                return _corrected(level, xp.min(level), slope, spring, force, depth)[0]
            return _newton(
                level, xp.min(level), slope, spring, force, given[0] < depth
            )[0]

        return depth, jax.jvp(moved, given[:4], tangents[:4])[1]

    return settle


def _corrected(
    level: Array, lowest: Array, slope: Array, spring: Any, force: Array, depth: Array
) -> tuple[Array, Array]:
    """The depth after one step of Newton's from `depth`, and the stiffness there."""
    now, stiffness = carried(slope, depth - level)
    stiffness = fixed(spring + stiffness)
    empty = stiffness <= 0
    step = (force - spring * depth - now) / xp.where(empty, 1.0, stiffness)
    return xp.where(empty, lowest + force / slope, depth + step), stiffness


def _newton(
    level: Array, lowest: Array, slope: Array, spring: Any, force: Array, active: Array
) -> tuple[Array, Array]:
    """The depth at which those that are `active` carry the force, and their
    stiffness.
    """
    stiffness = spring + total(slope, xp.where(active, 1.0, 0.0))
    # Without a spring one element at least carries the load. (The place of the least
    # level takes long to find.)
    alone = slope if slope.ndim == 0 else xp.max(xp.where(level == lowest, slope, 0.0))
    empty = stiffness <= 0
    load = force + xp.where(
        empty, alone * lowest, total(slope, xp.where(active, level, 0.0))
    )
    return load / xp.where(empty, alone, stiffness), stiffness


def carried(slope: Array, excess: Float[Array, " n"]) -> tuple[Array, Array]:
    """The force where a contact ends between two elements, and how much it grows as all
    of `excess` grows by one.

    It is the integral of the positive part of the line drawn through the elements,
    which are neighbours of one slope. sum slope max(0, excess) errs by the square of
    their distance as well, but with a factor that depends on where the contact ends, so
    that the limit of ever more elements could not be extrapolated from a few.
    """
    edge, rate = edges(excess)
    inside = excess > 0
    force = xp.sum(xp.where(inside, excess, 0.0)) + xp.sum(edge)
    return slope * force, slope * (xp.sum(inside) + xp.sum(rate))


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


def total(weight: Array, part: Float[Array, " n"]) -> Array:
    """The sum over all elements."""
    return weight * xp.sum(part) if weight.ndim == 0 else xp.sum(weight * part)
