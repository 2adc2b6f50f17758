"""Search in NumPy, differentiate the equation: one way for numbers and for what JAX
transforms.

A search (a root, an edge, a plan) runs on NumPy alone. Under `jit`, `vmap` and `grad`
the same function runs as a callback from JAX's program, and its derivatives follow from
the equation that it solves: JAX traces and compiles the equation, never the search.

All functions here take (shared, points), two trees of float64 arrays: what all points
have in common, and what each has of its own, the points along the last axis. No point
depends on another.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, is_traced, numpy_unless_traced, reversible

if TYPE_CHECKING:
    from jaxtyping import PyTree


def _quick(version: str) -> dict[str, int | bool]:
    """Options of XLA for what runs a few times and is not worth optimising: it compiles
    four times as fast, and runs as fast where it has some thousands of numbers.

    XLA refuses options that it does not know, and lost one with JAX 0.12.
    """
    plain: dict[str, int | bool] = {"xla_backend_optimization_level": 0}
    if tuple(int(number) for number in version.split(".")[:2]) < (0, 12):
        plain["xla_cpu_use_fusion_emitters"] = False
    return plain


def as_doubles(tree: PyTree) -> Any:
    """Its leaves as float64 arrays of JAX: a user's may have been rounded to
    float32.
    """
    import jax

    return jax.tree.map(lambda x: jax.numpy.asarray(x, np.float64), tree)


def on_host(
    function: Callable[..., Any], like: PyTree, shared: PyTree, points: PyTree
) -> Any:
    """`function(shared, points)` on NumPy: at once where values are known, else when
    they are.

    `like` is a tree of arrays with the shapes of the answer, whose last axis is that of
    the points.
    """
    import jax
    import jax.numpy as jnp

    function = numpy_unless_traced(function)
    if not is_traced(shared, points):
        values = jax.tree.map(np.asarray, (shared, points))
        return jax.tree.map(jnp.asarray, function(*values))
    axes = np.ndim(jax.tree.leaves(points)[0])

    def call(shared: PyTree, points: PyTree) -> Any:
        shared, points = jax.tree.map(_from_words, (shared, points))
        mapped = jax.tree.leaves(points)[0].ndim - axes
        answer = _of_batch(function, shared, points, mapped)
        return jax.tree.map(_to_words, answer)

    def words(x: Array) -> Any:
        return jax.lax.bitcast_convert_type(jnp.asarray(x), np.uint32)

    given = jax.tree.map(words, (shared, points))
    shapes = jax.tree.map(
        lambda x: jax.ShapeDtypeStruct((*x.shape, 2), np.uint32), like
    )
    answer = jax.pure_callback(call, shapes, *given, vmap_method="expand_dims")
    return jax.tree.map(lambda x: jax.lax.bitcast_convert_type(x, np.float64), answer)


# Numbers go to a callback and back as pairs of 32-bit words: it runs in a thread that
# knows nothing of `jax.enable_x64`, and JAX would round them to float32 there.


def _from_words(words: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(words).view(np.float64)[..., 0]


def _to_words(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, np.float64)[..., None].view(np.uint32)


def _of_batch(
    function: Callable[..., Any], shared: PyTree, points: PyTree, mapped: int
) -> Any:
    """`function` of arrays that have `mapped` axes of `vmap` in front, of length 1
    where they are not mapped.
    """
    import jax

    leaves = jax.tree.leaves((shared, points))
    shape = np.broadcast_shapes(*(x.shape[:mapped] for x in leaves))
    front, behind = range(mapped), range(-1 - mapped, -1)

    def joined(x: np.ndarray) -> np.ndarray:
        entries = np.broadcast_to(x, (*shape, *x.shape[mapped:]))
        return np.moveaxis(entries, front, behind).reshape(*x.shape[mapped:-1], -1)

    def parted(x: np.ndarray) -> np.ndarray:
        return np.moveaxis(x.reshape(*x.shape[:-1], *shape, -1), behind, front)

    def entry(x: np.ndarray, place: tuple[int, ...]) -> np.ndarray:
        lengths = x.shape[:mapped]
        return x[tuple(min(i, n - 1) for i, n in zip(place, lengths, strict=True))]

    if all(x.shape[:mapped] == (1,) * mapped for x in jax.tree.leaves(shared)):
        # Only points are mapped: these are all points of one call.
        one = jax.tree.map(lambda x: entry(x, (0,) * mapped), shared)
        return jax.tree.map(parted, function(one, jax.tree.map(joined, points)))
    answers = [
        function(
            *jax.tree.map(lambda x, index=place: entry(x, index), (shared, points))
        )
        for place in np.ndindex(shape)
    ]
    return jax.tree.map(lambda *x: np.stack(x).reshape(*shape, *x[0].shape), *answers)


def implicit(
    search: Callable[..., Any],
    equation: Callable[..., Any],
    like: Callable[..., Any],
    coupled: bool = False,
) -> Callable[..., Any]:
    """A function of (shared, points) whose value `search` finds, differentiable by
    `equation`.

    With res(x(p), p) = 0,  dx = -(d res/dx)^-1 (d res/dp) dp. The rule calls the
    function itself, so that derivatives of every order exist.

    Args:
        search: (x, other) from (shared, points), on NumPy: the unknown, and what else
            the equation takes, which has no derivative (None: nothing).
        equation: of (x, other, shared, points), zero at the solution; traced. Each of
            its entries changes with its own entry of x only.
        like: arrays with the shapes of what `search` gives, from (shared, points).
        coupled: each point has several unknowns, x (unknowns, points), and its entries
            change with all of them.
    """
    import jax
    import jax.numpy as jnp

    equation = jax.jit(equation)  # its Python runs once, however often it is used

    @jax.custom_jvp
    def solution(shared: PyTree, points: PyTree) -> Any:
        return on_host(search, like(shared, points), shared, points)

    @solution.defjvp
    def derivative(given: PyTree, tangents: PyTree) -> Any:
        with jax.enable_x64(True):
            x, other = solution(*given)
            # by both at once: what the derivatives are taken at is traced once, and is
            # half of the program
            slopes = jax.linearize(
                lambda x, given: equation(x, other, *given), x, given
            )[1]
            residual = slopes(jnp.zeros_like(x), tangents)
            held = jax.tree.map(jnp.zeros_like, given)

            def by_x(tangent: Array) -> Any:
                return slopes(tangent, held)

            if coupled:
                units = jnp.eye(x.shape[0])[..., None] + jnp.zeros_like(x)
                slope = jax.vmap(by_x)(units).T  # (points, equations, unknowns)
                moved = jnp.linalg.solve(slope, residual.T[..., None])[..., 0].T
            else:
                moved = residual / by_x(jnp.ones_like(x))
            return (x, other), (-moved, jax.tree.map(jnp.zeros_like, other))

    return lambda shared, points: solution(shared, points)[0]


def stationary(
    function: Callable[..., Any], last: Callable[..., Any]
) -> Callable[..., Any]:
    """function(*given, last(*given)), whose derivative by what `last` gives is zero."""
    import jax

    function = jax.jit(function)

    @jax.custom_jvp
    def whole(*given: Any) -> Any:
        return function(*given, last(*given))

    @whole.defjvp
    def derivative(given: PyTree, tangents: PyTree) -> Any:
        with jax.enable_x64(True):
            held = last(*given)
            return jax.jvp(lambda *given: function(*given, held), given, tangents)

    return whole


def numbers_with_slopes(
    numbers: Callable[..., Any],
    formulas: tuple[tuple[Callable[..., Any], int], ...],
    like: Callable[..., Any],
) -> Callable[..., Any]:
    """A function of (shared, points) with the values of `numbers` and the derivatives
    of `formulas`.

    Args:
        numbers: a tuple of arrays (..., points), on NumPy; asked for the points alone whose
            numbers are finite, and positive in arrays (points,). The others are NaN.
        formulas: each with how many arrays of this tuple it gives, in their order; what
            is left over has no derivatives. They are traced, and their values are not
            used.
        like: arrays with the shapes of what `numbers` gives, from (shared, points).
    """
    import jax

    groups = [(_with_slopes(formula), count) for formula, count in formulas]

    def whole(shared: PyTree, points: PyTree) -> Any:
        with jax.enable_x64(True):
            fixed = jax.lax.stop_gradient((shared, points))
            shapes = like(*fixed)
            values = on_host(_of_sound(numbers, shapes), shapes, *fixed)
            answers: tuple[Any, ...] = ()
            for with_slopes, count in groups:
                group = values[len(answers) : len(answers) + count]
                answers += with_slopes(group, (shared, points))
            return (*answers, *values[len(answers) :])

    return whole


def _of_sound(numbers: Callable[..., Any], like: PyTree) -> Callable[..., Any]:
    """`numbers` of the points that can have some, with the shapes `like`; NaN at the
    others: those with a number that is not finite, or not positive in an array
    (points,). Under `jit` nothing has refused them.
    """
    import jax

    def whole(shared: PyTree, points: PyTree) -> Any:
        leaves = jax.tree.leaves(points)
        size = leaves[0].shape[-1]
        sound = np.full(size, all(map(_finite, jax.tree.leaves(shared))))
        for x in leaves:
            sound &= np.isfinite(x).reshape(-1, size).all(axis=0)
            sound &= (x > 0) if x.ndim == 1 else True
        answer = tuple(np.full((*x.shape[:-1], size), np.nan) for x in like)
        if sound.any():
            sound_points = jax.tree.map(lambda x: x[..., sound], points)
            for array, values in zip(
                answer, numbers(shared, sound_points), strict=True
            ):
                array[..., sound] = values
        return answer

    return whole


def _finite(x: np.ndarray) -> bool:
    return bool(np.isfinite(x).all())


def _with_slopes(formula: Callable[..., Any]) -> Callable[..., Any]:
    """A function of (values, given): the values, with the derivatives of `formula` by
    what is given.
    """
    import jax

    formula = jax.jit(formula)

    def forward(given: PyTree, tangents: PyTree) -> Any:
        return jax.jvp(formula, given, tangents)[1]

    def backward(given: PyTree, cotangents: PyTree) -> Any:
        return jax.vjp(formula, *given)[1](cotangents)

    forward, backward = _compiled(forward), _compiled(backward)

    @jax.custom_jvp
    def both_ways(values: PyTree, given: PyTree) -> Any:
        return values

    @both_ways.defjvp
    def derivative(primals: PyTree, tangents: PyTree) -> Any:
        values, given = primals
        with jax.enable_x64(True):
            return values, forward(given, tangents[1])

    # Under `jax.grad` of plain numbers: a program by itself, once the derivative is
    # asked for.
    @jax.custom_vjp
    def in_reverse(values: PyTree, given: PyTree) -> Any:
        return values

    def pull(given: PyTree, cotangents: PyTree) -> Any:
        with jax.enable_x64(True):
            nothing = jax.tree.map(jax.numpy.zeros_like, cotangents)
            return nothing, backward(given, cotangents)

    in_reverse.defvjp(lambda values, given: (values, given), pull)

    def with_slopes(values: PyTree, given: PyTree) -> Any:
        plain = not is_traced(jax.lax.stop_gradient(given)) and reversible(given)
        return (in_reverse if plain else both_ways)(values, given)

    return with_slopes


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """`jax.jit`, quickly where it is no part of another program, of which JAX allows no
    options.
    """
    import jax

    options = _quick(jax.__version__) if jax.default_backend() == "cpu" else {}
    within = jax.jit(function)
    alone: Any = jax.jit(function, compiler_options=options)
    return lambda *given: (within if is_traced(given) else alone)(*given)
