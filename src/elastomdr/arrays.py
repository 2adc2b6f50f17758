"""One source for numbers and for what JAX transforms: the array namespace `xp`, what
differs besides, and JAX's cache of compiled code.

While a public call of numbers runs, `xp` stands for NumPy; if one of its arguments is
traced, or the call belongs to what only JAX computes, for `jax.numpy`. A formula is
written once, over `xp`. A tracer that reaches NumPy raises.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from .trees import Tree, after_jax
from .units.arguments import arguments_in_si

if TYPE_CHECKING:
    import jax
    from jaxtyping import PyTree

    # JAX while tracing or inside a computation, NumPy where values are handed out
    Array = jax.Array | np.ndarray
else:
    Array = Any

P = ParamSpec("P")
R = TypeVar("R")

# JAX by itself leaves out what compiles in less than a second, which is most of what a
# scene needs
_SETTINGS = {
    "jax_persistent_cache_min_compile_time_secs": 0.0,
    "jax_persistent_cache_min_entry_size_bytes": -1,
}


class _Mode(threading.local):
    numpy = False  # of a new thread, and outside of public calls


_mode = _Mode()


class _Namespace:
    """NumPy, or `jax.numpy` where one of a function's arguments is an array of JAX's.

    What is known thus stays known under `jit`, and what is made of nothing, as `zeros`,
    is NumPy's, a constant to JAX. What is known and indexed by what JAX traces needs
    `arrays`, or `xp.take`. Until JAX is loaded all are NumPy's own.
    """

    def __init__(self, numpy: str, jax: str):
        self._modules = numpy, jax
        after_jax(self._forget)

    def __getattr__(self, name: str) -> Any:
        numpy, jax = self._modules
        found = getattr(import_module(numpy), name)
        if "jax" in sys.modules:
            if isinstance(found, ModuleType):
                found = _Namespace(f"{numpy}.{name}", f"{jax}.{name}")
            elif callable(found) and not isinstance(found, type):
                found = _by_arguments(found, name, jax)
        vars(self)[name] = found
        return found

    def _forget(self) -> None:
        for name in set(vars(self)) - {"_modules"}:
            del vars(self)[name]


def _by_arguments(plain: Callable[..., Any], name: str, jax: str) -> Any:
    def function(*args: Any, **kwargs: Any) -> Any:
        if _mode.numpy or not any(map(_of_jax, (*args, *kwargs.values()))):
            return plain(*args, **kwargs)
        return getattr(import_module(jax), name)(*args, **kwargs)

    return function


def _of_jax(value: object) -> bool:
    """Whether it is an array of JAX's, or a list of some."""
    if type(value) in _PLAIN:
        return False
    if isinstance(value, (tuple, list)):
        return any(map(_of_jax, value))
    return isinstance(value, getattr(sys.modules.get("jax"), "Array", ()))


xp: Any = _Namespace("numpy", "jax.numpy")
special: Any = _Namespace("scipy.special", "jax.scipy.special")


def on_numpy() -> bool:
    """Whether `xp` is NumPy at the moment."""
    return _mode.numpy


def numpy_unless_traced(function: Callable[P, R]) -> Callable[P, R]:
    """Runs `function` on NumPy, or, if JAX traces one of its arguments, on `jax.numpy`
    with 64-bit types.

    Arguments with units come to it as numbers in SI units (`units/arguments.py`).
    """
    in_si = arguments_in_si(function)

    @functools.wraps(function)
    def wrapper(*given: P.args, **named: P.kwargs) -> R:
        args, kwargs = (given, named) if _mode.numpy else in_si(given, named)
        if is_traced(args, kwargs):
            return on_jax(function, *args, **kwargs)
        if _mode.numpy:  # inside of another such call
            return function(*args, **kwargs)
        _mode.numpy = True
        try:
            with np.errstate(all="ignore"):
                return function(*args, **kwargs)
        finally:
            _mode.numpy = False

    return wrapper


def in_float64(function: Callable[P, R]) -> Callable[P, R]:
    """Runs `function` on JAX with 64-bit types enabled and leaves the caller's JAX
    setting as it was.

    Arrays in its answer that are not traced come back as NumPy arrays: JAX's own would
    be rounded to float32 by the caller's next operation under JAX's default
    configuration. Units as in `numpy_unless_traced`.
    """
    in_si = arguments_in_si(function)

    @functools.wraps(function)
    def wrapper(*given: P.args, **named: P.kwargs) -> R:
        args, kwargs = in_si(given, named)
        return on_jax(function, *args, **kwargs)

    return wrapper


def on_jax(function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
    """One call on JAX with 64-bit types; see `in_float64`."""
    import jax

    keep_compiled_code()
    if not jax.config.read("jax_enable_x64") and reversible(args, kwargs):
        return _with_its_way_back(function, args, kwargs)
    before, _mode.numpy = _mode.numpy, False
    try:
        # as of NumPy's calls: what overflows is found by its NaN
        with jax.enable_x64(True), np.errstate(all="ignore"):
            return jax.tree.map(as_numpy, function(*args, **kwargs))
    finally:
        _mode.numpy = before


def reversible(*trees: Any) -> bool:
    """Whether JAX traces some of it, and none of that for forward derivatives, which a
    reverse rule would exclude.
    """
    import jax
    from jax.core import Tracer
    from jax.interpreters.ad import JVPTracer

    def forward(tracer: object) -> bool:
        inner = getattr(tracer, "val", None)
        return isinstance(tracer, JVPTracer) or (
            isinstance(inner, Tracer) and forward(inner)
        )

    traced = [leaf for leaf in jax.tree.leaves(trees) if isinstance(leaf, Tracer)]
    return bool(traced) and not any(map(forward, traced))


def _with_its_way_back(
    function: Callable[..., R], args: tuple[Any, ...], kwargs: dict[str, object]
) -> R:
    """`on_jax` with a reverse derivative that has 64-bit types too: JAX transposes
    after the call has returned, under the caller's setting, where 32-bit zeros would
    meet 64-bit numbers.
    """
    import jax
    from jax.core import Tracer

    leaves, tree = jax.tree.flatten((args, kwargs))
    places = [i for i, leaf in enumerate(leaves) if isinstance(leaf, Tracer)]
    rest: list[Any] = []

    def run(*given: Any) -> tuple[Any, ...]:
        full = list(leaves)
        for i, value in zip(places, given, strict=True):
            full[i] = value
        arguments, named = jax.tree.unflatten(tree, full)
        with jax.enable_x64(True):
            result_leaves, shape = jax.tree.flatten(
                on_jax(function, *arguments, **named)
            )
            kept = [isinstance(leaf, jax.Array) for leaf in result_leaves]
            rest[:] = [
                shape,
                [
                    None if array else leaf
                    for leaf, array in zip(result_leaves, kept, strict=True)
                ],
                kept,
            ]
            return tuple(
                leaf for leaf, array in zip(result_leaves, kept, strict=True) if array
            )

    @jax.custom_vjp
    def whole(*given: Any) -> tuple[Any, ...]:
        return run(*given)

    def forth(*given: Any) -> tuple[Any, Any]:
        with jax.enable_x64(True):
            return jax.vjp(run, *given)

    def back(pull: Callable[..., PyTree], slopes: PyTree) -> Any:
        with jax.enable_x64(True):
            return pull(slopes)

    whole.defvjp(forth, back)
    arrays = iter(whole(*(leaves[i] for i in places)))
    shape, others, kept = rest
    return jax.tree.unflatten(
        shape,
        [
            next(arrays) if array else leaf
            for leaf, array in zip(others, kept, strict=True)
        ],
    )


def as_numpy(leaf: object) -> Any:
    """A NumPy array in place of an array of JAX's that is not traced; anything else as
    it is.
    """
    jax = sys.modules.get("jax")
    if (
        jax is not None
        and isinstance(leaf, jax.Array)
        and not isinstance(leaf, jax.core.Tracer)
    ):
        return np.asarray(leaf)
    return leaf


_PLAIN = {np.ndarray, np.float64, np.bool_, float, int, bool, str, type(None)}


def is_traced(*trees: Any) -> bool:
    """Whether any leaf is under a JAX transformation, so that its value cannot be
    looked at.
    """
    tracer = getattr(getattr(sys.modules.get("jax"), "core", None), "Tracer", None)
    if tracer is None:
        return False
    # one loop in place of a call for each part: this is asked hundreds of times a point
    waiting, lists = list(trees), set()
    while waiting:
        tree = waiting.pop()
        if type(tree) in _PLAIN:
            continue
        if isinstance(tree, tuple):
            waiting.extend(tree)
        elif isinstance(tree, (list, dict)):  # of which one may hold itself
            if id(tree) not in lists:
                lists.add(id(tree))
                waiting.extend(tree.values() if isinstance(tree, dict) else tree)
        elif isinstance(tree, Tree):
            waiting.extend(vars(tree).values())
        elif isinstance(tree, tracer) or _holds(tree, tracer):
            return True
    return False


def _holds(tree: object, tracer: type) -> bool:
    """Whether a tree that is none of ours holds a tracer."""
    if hasattr(type(tree), "__next__"):  # JAX warns of what can be read only once
        return False
    import jax

    return any(isinstance(leaf, tracer) for leaf in jax.tree.leaves(tree))


def compiled(*static: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """`jax.jit`, with some arguments static, where JAX computes; the function itself
    where NumPy does.
    """

    def mark(function: Callable[P, R]) -> Callable[P, R]:
        program: Any = None

        @functools.wraps(function)
        def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
            nonlocal program
            if _mode.numpy:
                return function(*args, **kwargs)
            if program is None:
                import jax

                program = jax.jit(function, static_argnames=static)
            return program(*args, **kwargs)

        return wrapper

    return mark


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """Keeps linear algebra on one thread; as `with` or as a decorator.

    For matrices of a hundred rows threads only wait for each other, eight times as long
    as one takes.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield


def while_loop(
    condition: Callable[[Any], Any], body: Callable[[Any], Any], state: PyTree
) -> Any:
    """`jax.lax.while_loop`."""
    if not _mode.numpy:
        import jax

        return jax.lax.while_loop(condition, body, state)
    while condition(state):
        state = body(state)
    return state


def fori_loop(
    start: int, stop: int, body: Callable[[Any, Any], Any], state: PyTree
) -> Any:
    """`jax.lax.fori_loop`."""
    if not _mode.numpy:
        import jax

        return jax.lax.fori_loop(start, stop, body, state)
    for i in range(start, stop):
        state = body(i, state)
    return state


def stop_gradient(tree: R) -> R:
    """`jax.lax.stop_gradient`; of what is known nothing, since JAX would trace it."""
    if _mode.numpy or not is_traced(tree):
        return tree
    import jax

    return jax.lax.stop_gradient(tree)


def arrays(tree: PyTree) -> Any:
    """Its leaves as arrays that those of JAX may index; on NumPy as they are."""
    if _mode.numpy:
        return tree
    import jax

    return jax.tree.map(jax.numpy.asarray, tree)


def lax_map(function: Callable[[Any], Any], over: PyTree) -> Any:
    """`jax.lax.map`: the results of a function of each entry along the first axis,
    stacked; one array each.
    """
    if not _mode.numpy:
        import jax

        return jax.lax.map(function, over)
    return np.stack([function(entry) for entry in over])


def scan(
    step: Callable[[Any, Any], tuple[Any, Any]], carry: PyTree, over: PyTree
) -> tuple[Any, Any]:
    """`jax.lax.scan` over a tuple of arrays or None, or tuples of them: the last carry,
    and what each step leaves, stacked.
    """
    if not _mode.numpy:
        import jax

        return jax.lax.scan(step, carry, over)
    outputs = []
    for entry in entries(over):
        carry, kept = step(carry, entry)
        outputs.append(kept)
    return carry, tree_map(lambda *x: np.stack(x), *outputs)


def cond(
    condition: Array | bool,
    true: Callable[..., Any],
    false: Callable[..., Any],
    *given: Any,
) -> Any:
    """`jax.lax.cond`."""
    if not _mode.numpy:
        import jax

        return jax.lax.cond(condition, true, false, *given)
    return true(*given) if condition else false(*given)


def tree_map(function: Callable[..., Any], tree: PyTree, *trees: Any) -> Any:
    """`jax.tree.map`; on NumPy for tuples of arrays, tuples and None."""
    if not _mode.numpy:
        import jax

        return jax.tree.map(function, tree, *trees)
    if tree is None:
        return None
    if not isinstance(tree, tuple):
        return function(tree, *trees)
    parts = [tree_map(function, *parts) for parts in zip(tree, *trees, strict=True)]
    return type(tree)(*parts) if hasattr(tree, "_fields") else tuple(parts)


def entries(tree: PyTree) -> Iterator[Any]:
    """The entries of a tuple of arrays, or of tuples of them, along their first axis;
    at least one is an array.
    """
    if tree is None:
        return itertools.repeat(None)
    if not isinstance(tree, tuple):
        return iter(tree)
    rows = zip(*map(entries, tree))  # noqa: B905  None has no length
    return itertools.starmap(type(tree), rows) if hasattr(tree, "_fields") else rows


@functools.cache
def keep_compiled_code() -> None:
    """Lets JAX keep compiled code between runs, in the user's cache folder.

    Nothing is changed where JAX has been given a cache already, by
    `JAX_COMPILATION_CACHE_DIR` or in its configuration, where it has been told to keep
    none, or where the folder cannot be written.
    """
    import jax

    config: Any = jax.config  # its attributes are made at run time
    if (
        config.jax_compilation_cache_dir is not None
        or not config.jax_enable_compilation_cache
    ):
        return
    if (folder := _usable(_default_folder())) is None:
        return
    config.update("jax_compilation_cache_dir", folder)
    for name, value in _SETTINGS.items():
        if name.upper() not in os.environ:
            config.update(name, value)


def _default_folder() -> str | None:
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
    elif sys.platform == "darwin":
        base = "~/Library/Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    folder = os.path.expanduser(os.path.join(base, "elastomdr", "jax")) if base else ""
    # no home folder: "~" stays as it is
    return folder if os.path.isabs(folder) else None


def _usable(folder: str | None) -> str | None:
    """The folder, made if need be, or None where nothing can be written in it."""
    if folder is None:
        return None
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except (OSError, ValueError):
        return None
