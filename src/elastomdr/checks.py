"""Arguments and answers: float64 whatever the caller's JAX configuration, checks, and
numbers as text.
"""

from __future__ import annotations

import functools
import math
import re
import sys
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ParamSpec, TypeGuard, TypeVar

import numpy as np

from .arrays import (
    Array,
    as_numpy,
    in_float64,
    is_traced,
    numpy_unless_traced,
    xp,
)
from .errors import ConvergenceWarning, InputError, either, warn
from .units.arguments import in_si, number_in_si

if TYPE_CHECKING:
    from ._types import ArrayLike

__all__ = ["Array", "in_float64", "in_si", "is_traced", "numpy_unless_traced"]

P = ParamSpec("P")
R = TypeVar("R")


def one_kernel(function: Callable[..., R]) -> Callable[..., R]:
    """Compiles `function` of arrays into one kernel.

    XLA's runtime for CPUs starts every operation in the body of a loop by itself, which
    takes longer than the arithmetic of a small step. Under this mark the loop is one
    piece of machine code, two to four times as fast. Not for functions that scatter,
    sort or factorise matrices: there is no such kernel. Other devices ignore it.
    """

    @functools.wraps(function)
    def wrapper(*args: object) -> R:
        import jax
        from jax.experimental.xla_metadata import set_xla_metadata

        with set_xla_metadata(xla_cpu_small_call="true", inlineable="false"):
            return jax.jit(function)(*args)

    return wrapper


def argmax(x: Array) -> Array:
    """`jnp.argmax` along the first axis, the first of equal ones.

    JAX's own is compiled with 32-bit indices where the caller's `jax.jit` has no 64-bit
    types, and fails there.
    """
    x = xp.asarray(x)
    place = xp.arange(x.shape[0]).reshape(-1, *[1] * (x.ndim - 1))
    return xp.min(xp.where(x == xp.max(x, axis=0), place, x.shape[0] - 1), axis=0)


def nan_unless(good: Array | np.bool_, values: Array) -> Any:
    """`values` where `good`, NaN elsewhere; under JAX's transformations so are the
    derivatives, which `jnp.where` would give as zero, and a search by gradients would
    take for a minimum.
    """
    if not is_traced(good, values):
        return np.where(good, values, np.nan)
    import jax.numpy as jnp

    return _traced_nan_unless()(
        jnp.asarray(good) != 0, jnp.asarray(values, jnp.float64)
    )


@functools.cache
def _traced_nan_unless() -> Any:
    import jax
    import jax.numpy as jnp

    @jax.custom_jvp
    def nan_unless(good: Array, values: Array) -> Array:
        return jnp.where(good, values, jnp.nan)

    @nan_unless.defjvp
    def derivative(primals: tuple, tangents: tuple) -> tuple:
        # A linear map, the same from both ends, so that forward and reverse mode work
        # alike: where not good, zero stays zero (what nobody asked about spoils
        # nothing) and all else overflows to infinity, then times zero gives NaN.
        good, _ = primals
        huge, zero = jnp.where(good, 1.0, 1e300), jnp.where(good, 1.0, 0.0)
        return nan_unless(*primals), tangents[1] * huge * huge * zero * huge * huge

    return nan_unless


def certain(test: Callable[..., Any], *values: object) -> bool:
    """Whether values pass a test at every entry; never those that JAX traces, which
    are not looked at.
    """
    return not is_traced(*values) and bool(np.all(test(*values)))


def possible(test: Callable[..., Any], *values: object) -> bool:
    """Whether values may pass a test at some entry; always those that JAX traces, which
    are not looked at.
    """
    return is_traced(*values) or bool(np.any(test(*values)))


def known(tree: Any) -> Any:
    """Its arrays as NumPy's, whose arithmetic compiles nothing, unless one of them is
    traced.
    """
    if "jax" not in sys.modules or is_traced(tree):
        return tree
    import jax

    return jax.tree.map(as_numpy, tree)


def as_float64(name: str, value: object) -> Array:
    """Turns `value` into a float64 NumPy array, or a float64 JAX array where it is
    traced.

    Concrete values become NumPy arrays, since JAX would round them to float32 under its
    default configuration. A value with a unit comes to a public function as a number
    already (`units/arguments.py`); of what is no argument of one it is converted here.
    """
    value = number_in_si(name, value)
    if is_traced(value):
        import jax

        with jax.enable_x64(True):
            return jax.numpy.asarray(value, dtype=jax.numpy.float64)
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise InputError(
            argument=name,
            got=value,
            accepted="without masked entries",
            hint="leave them out, or put numbers in their place with `.filled(...)`",
        )
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise InputError(
            argument=name, got=value, accepted="a number or an array of numbers"
        ) from error
    if array.dtype.kind not in "fiu":
        raise InputError(
            argument=name,
            got=value,
            accepted="a number or an array of numbers in SI units",
        )
    return np.array(array, dtype=np.float64)


def require(
    name: str, value: ArrayLike, accepted: str, test: Callable[[np.ndarray], Any]
) -> None:
    """Raises `InputError` unless every entry passes `test`; values under a JAX
    transformation are not looked at.
    """
    if is_traced(value):
        return
    array = np.asarray(value, dtype=np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        good = np.asarray(test(array) & ~np.isnan(array))
    if not good.all():
        first = (
            array.reshape(-1)[int(np.argmin(good.reshape(-1)))]
            if array.ndim
            else float(array)
        )
        raise InputError(argument=name, got=float(first), accepted=accepted)


_shape: Callable[[Any], tuple[int, ...]] = np.shape
# beyond them products of a few numbers leave the range of float64
_LEAST, _MOST = 1e-100, 1e100


def positive(name: str, value: ArrayLike) -> None:
    if (
        isinstance(value, np.ndarray)
        and value.size
        and value.min() > _LEAST
        and value.max() < _MOST
    ):
        return
    require(name, value, "positive and finite", lambda x: (x > 0) & np.isfinite(x))
    representable(name, value)


def positive_arrays(arguments: Mapping[str, ArrayLike | None]) -> dict[str, Array]:
    """Those arguments that are not None, as float64 arrays; raises `InputError` unless
    all their entries are positive.
    """
    arrays = {
        name: as_float64(name, value)
        for name, value in arguments.items()
        if value is not None
    }
    for name, value in arrays.items():
        positive(name, value)
    return arrays


def not_negative(name: str, value: ArrayLike) -> None:
    require(
        name, value, "zero or positive and finite", lambda x: (x >= 0) & np.isfinite(x)
    )
    representable(name, value)


def finite(name: str, value: ArrayLike) -> None:
    """Raises `InputError` unless every entry is finite, of either sign, and not beyond
    what can be computed with.
    """
    require(name, value, "finite", np.isfinite)
    require(
        name, value, "between -1e100 and 1e100 in SI units", lambda x: abs(x) < _MOST
    )


def in_kelvin(name: str, value: ArrayLike, coldest: float = 60.0) -> None:
    """Raises `InputError` for temperatures that are not positive, or can only be meant
    in degrees Celsius.
    """
    if is_traced(value):
        return
    array = np.asarray(value, dtype=float)
    low = float(array[np.isfinite(array)].min(initial=np.inf))
    if -273.15 < low < coldest:
        raise InputError(
            argument=name,
            got=low,
            accepted=f"in kelvin, {coldest:g} at least",
            hint=f"{low:g} degC is {low + 273.15:.6g} K ({low:g}degC on the command "
            "line)",
        )
    positive(name, value)


def representable(name: str, value: ArrayLike) -> None:
    """Refuses numbers whose products would leave the range of float64."""
    accepted = "zero or between 1e-100 and 1e100 in SI units"
    require(name, value, accepted, lambda x: (x == 0) | ((x > _LEAST) & (x < _MOST)))


def ascending(name: str, values: ArrayLike) -> None:
    """Raises `InputError` unless a list rises from entry to entry without repeats."""
    if not possible(lambda x: (np.diff(x) > 0).all(), values):
        values = np.asarray(values)
        i = int(np.argmin(np.diff(values) > 0))
        raise InputError(
            argument=name,
            got=values,
            accepted="ascending, without repeats",
            hint=f"entry {i} is {values[i]:g}, entry {i + 1} is {values[i + 1]:g}",
        )


def warn_unless(
    good: Array | np.bool_,
    points: str,
    asked: str = "",
    reason: str = "",
    known: Array | bool = False,
) -> None:
    """Counts the points that are not `good` in one `ConvergenceWarning`, with what was
    `asked` of them and a sentence for the `reason`; none where JAX traces them, and
    none that are `known` to have failed, with a warning of their own.
    """
    if not is_traced(good, known):
        failed = int(np.sum(~(good | known)))
        warn_of_failed(failed, np.size(good), points, asked, reason)


def warn_of_failed(
    failed: int, count: int, points: str, asked: str = "", reason: str = ""
) -> None:
    """The warning of `warn_unless`, where `failed` of `count` points did not converge;
    none where all did.
    """
    if failed:
        sentence = (
            f"{failed} of {count} {points} did not converge{asked}; they are NaN."
        )
        warn(f"{sentence} {reason}".strip(), ConvergenceWarning)


def alike(least: int, lists: Mapping[str, ArrayLike]) -> None:
    """Raises `InputError` unless these, by name, are lists of one length, with `least`
    entries or more.
    """
    first, *others = lists
    shape = _shape(lists[first])
    wrong = [name for name in others if _shape(lists[name]) != shape]
    if len(shape) != 1 or shape[0] < least:
        wrong = [first]
    for name in wrong:
        beside = " and ".join(each for each in lists if each != name)
        raise InputError(
            argument=name,
            got=lists[name],
            accepted=f"a list of {least} entries or more, as long as {beside}",
            hint=_shapes(lists),
        )


def broadcast_shape(arrays: Mapping[str, ArrayLike | None]) -> tuple[int, ...]:
    """The shape to which arguments broadcast, those that are not None; raises
    `InputError` with the shape of each.
    """
    given = {name: array for name, array in arrays.items() if array is not None}
    shape: tuple[int, ...] = ()
    for name, array in given.items():
        try:
            shape = np.broadcast_shapes(shape, _shape(array))
        except ValueError as error:
            raise InputError(
                argument=name,
                got=array,
                accepted=f"of a shape that broadcasts with {shape}",
                hint=_shapes(given),
            ) from error
        if 0 in shape:
            raise InputError(
                argument=name, got=array, accepted="a number, or one or more in a list"
            )
    return shape


def _shapes(arrays: Mapping[str, ArrayLike | None]) -> str:
    """The shapes of arguments, in words."""
    shapes = {name: _shape(array) for name, array in arrays.items()}
    return ", ".join(
        f"{name} has the shape {shape}" if shape else f"{name} is a number"
        for name, shape in shapes.items()
    )


def broadcast(arrays: Mapping[str, ArrayLike | None]) -> dict[str, Any]:
    """Arguments in the shape to which they broadcast; None stays None. Raises
    `InputError` as `broadcast_shape` does.
    """
    shape = broadcast_shape(arrays)
    return {
        name: None if array is None else xp.broadcast_to(array, shape)
        for name, array in arrays.items()
    }


def only_one(arguments: Mapping[str, object]) -> str:
    """The name of the only argument that is not None. Raises `InputError` where none
    is, or several are.
    """
    given = [name for name, value in arguments.items() if value is not None]
    if len(given) == 1:
        return given[0]
    if not given:
        first, *others = arguments
        raise InputError(
            argument=first, got=None, accepted=f"given, or {' or '.join(others)}"
        )
    first, *_, last = given
    raise InputError(
        argument=last,
        got=arguments[last],
        accepted=f"left out where {first} is given",
    )


def scalar(name: str, value: object) -> Array:
    """A float64 scalar from `value`; raises `InputError` for anything with a shape."""
    array = as_float64(name, value)
    if array.shape != ():
        raise InputError(argument=name, got=value, accepted="a single number")
    return array


def plain(name: str, value: object) -> float:
    """A Python float, for what decides how a scene is computed; raises `InputError` for
    a value that JAX traces.
    """
    untraced(
        InputError(
            argument=name,
            accepted="a plain number",
            hint="it is not differentiable, nor seen by jit and vmap",
        ),
        value,
    )
    return float(scalar(name, value))


def as_number(value: Any) -> Any:
    """A Python float; what JAX traces as it is."""
    known = type(value) is np.float64 or not is_traced(value)
    return float(value) if known else value


def is_whole(value: object) -> TypeGuard[int]:
    """Whether a value is a whole number, and no flag."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def whole_number(name: str, value: object, least: int, most: int | None = None) -> None:
    """Raises `InputError` unless `value` is a whole number from `least` to `most`."""
    if not is_whole(value) or value < least or (most is not None and value > most):
        accepted = f"{least} or more" if most is None else f"{least} to {most}"
        raise InputError(
            argument=name, got=value, accepted=f"a whole number, {accepted}"
        )


def one_of(name: str, value: object, *accepted: str) -> None:
    """Raises `InputError` unless a value is one of some texts."""
    if not isinstance(value, str) or value not in accepted:
        words = either([repr(word) for word in accepted])
        raise InputError(argument=name, got=value, accepted=words)


def a_text(name: str, value: object) -> None:
    """Raises `InputError` for what is no text."""
    if not isinstance(value, str):
        raise InputError(argument=name, got=value, accepted="a text")


def untraced(error: InputError, *values: object) -> None:
    """Raises this error where JAX traces one of the values."""
    if is_traced(*values):
        raise error


def numbers_only(
    arguments: Mapping[str, object],
    hint: str = "a derivative is the difference of two calls",
) -> None:
    """Raises `InputError`, of the first of these arguments that JAX traces."""
    for name, value in arguments.items():
        accepted = "in plain numbers, outside jax.jit, grad and vmap"
        untraced(InputError(argument=name, accepted=accepted, hint=hint), value)


def written(module: object) -> str:
    """A module as its class and its fields, numbers with six digits: what `repr` shows
    of shapes and shift laws.
    """
    fields = (f"{key}={_brief(value)}" for key, value in vars(module).items())
    return f"{type(module).__name__}({', '.join(fields)})"


def _brief(value: Any) -> str:
    if is_traced(value):
        return "traced"
    if isinstance(as_numpy(value), np.ndarray):
        if value.size > 6:
            return f"[{value.size} values]"
        return re.sub(
            r"\s+", " ", np.array2string(np.asarray(value), precision=6, separator=", ")
        )
    return f"{value:.6g}" if isinstance(value, float) else repr(value)


def significant(value: float, digits: int = 4) -> str:
    """A number as an engineer writes it: `digits` significant digits, no trailing
    noise.
    """
    return f"{value:.{digits}g}" if math.isfinite(value) else str(value)


SEEN = 1e-3  # the smallest share that words give


def shares_in_words(shares: np.ndarray) -> str:
    """The smallest and the largest of shares, where they differ."""
    known = shares[np.isfinite(shares)]
    if not known.size:
        return "not known"
    low, high = float(known.min()), float(known.max())
    words = percent(high) + " where it is known" * (known.size < shares.size)
    return words if low >= 0.9 * high or high < SEEN else f"{percent(low)} to {words}"


def percent(share: float) -> str:
    """A share in words."""
    if np.isnan(share):
        return "not known"
    words = significant(100 * share, 2 if share < 1 else 3)
    return f"{words} %" if share >= SEEN else "below 0.1 %"
