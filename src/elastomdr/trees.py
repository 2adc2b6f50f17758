"""Frozen dataclasses that JAX takes apart and puts together, whichever of JAX and
elastomdr is imported first.

A class that derives from `Tree` is a frozen dataclass. If JAX is loaded when the class
is made, the class is registered with it as a pytree at once; if not, as soon as JAX has
been imported. A check at the first call of ours would be too late: `jax.jit` takes its
arguments apart before it calls anything.
"""

from __future__ import annotations

import abc
import copy
import dataclasses
import functools
import importlib.abc
import importlib.machinery
import sys
import threading
from collections.abc import Callable, Iterable, Sequence
from types import ModuleType
from typing import Any, TypeVar, dataclass_transform

from .units.arguments import constructor_in_si

T = TypeVar("T")


def static(default: Any = dataclasses.MISSING) -> Any:
    """A field that JAX does not look into: part of the class, so to speak, and compared
    by `==`.
    """
    return dataclasses.field(metadata={"static": True}, default=default)


@dataclass_transform(
    frozen_default=True, eq_default=False, field_specifiers=(static, dataclasses.field)
)
class Tree(abc.ABC):  # noqa: B024
    """Base of frozen dataclasses that are pytrees; a class with an `__init__` of its
    own sets its fields by `fill`.

    Arguments with units come to `__init__` as numbers in SI units
    (`units/arguments.py`). Two of them are equal only if they are the same object;
    `same` compares their values.
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        init, repr = (not _has_own(cls, name) for name in ("__init__", "__repr__"))
        dataclasses.dataclass(frozen=True, eq=False, init=init, repr=repr)(cls)
        cls._generated = [
            name for name, made in (("__init__", init), ("__repr__", repr)) if made
        ]  # type: ignore
        if "__init__" in vars(cls):
            constructor_in_si(cls)
        pytree(cls)


def _has_own(cls: type, method: str) -> bool:
    """Whether a class or one it derives from has a method that `dataclass` did not
    write.
    """
    bases = (
        base for base in cls.__mro__ if base is not Tree and issubclass(base, Tree)
    )
    return any(
        method in vars(base) and method not in vars(base).get("_generated", ())
        for base in bases
    )


def fill(tree: Tree, **fields: Any) -> None:
    """Sets fields from within `__init__`."""
    vars(tree).update(fields)


def replaced(tree: T, **fields: Any) -> T:
    """A copy with some fields replaced, nothing checked."""
    tree = copy.copy(tree)
    vars(tree).update(fields)
    return tree


def same(one: Any, other: Any) -> bool:
    """Whether two objects are of one class and all their fields have the same values,
    arrays by shape and entries.
    """
    if isinstance(one, Tree):
        return type(one) is type(other) and all(
            same(vars(one)[k], vars(other)[k]) for k in _names(type(one))
        )
    if hasattr(one, "shape") or hasattr(other, "shape"):
        import numpy as np

        return np.shape(one) == np.shape(other) and bool(
            np.all(np.asarray(one) == np.asarray(other))
        )
    return bool(one == other)


def _names(cls: type) -> list[str]:
    return [field.name for field in dataclasses.fields(cls)]  # type: ignore[arg-type]


_lock = threading.RLock()
_waiting: list[Callable[[], None]] = []


def pytree(cls: type[T]) -> type[T]:
    """Lets a dataclass pass through JAX's transformations, at once or from when JAX is
    loaded.
    """
    after_jax(functools.partial(_make_pytree, cls))
    return cls


def after_jax(action: Callable[[], None]) -> None:
    """Does something at once or, where JAX is not loaded, as soon as it is."""
    with _lock:
        _waiting.append(action)
    if sys.modules.get("jax") is not None:
        _do_waiting()


def _do_waiting() -> None:
    # Waits for another thread that is in the middle of importing JAX; in the same
    # thread this part of it is enough.
    from jax import tree_util as _  # noqa: F401

    with _lock:
        while _waiting:
            _waiting.pop(0)()


def _make_pytree(cls: type) -> None:
    from jax import tree_util

    fields = dataclasses.fields(cls)  # type: ignore[arg-type]
    leaves = tuple(field.name for field in fields if not field.metadata.get("static"))
    others = tuple(field.name for field in fields if field.metadata.get("static"))
    keys = tuple(tree_util.GetAttrKey(name) for name in leaves)

    def parts(tree: Tree) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        values = vars(tree)
        return tuple(values[name] for name in leaves), tuple(
            values[name] for name in others
        )

    def parts_with_keys(tree: Tree) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        values, rest = parts(tree)
        return tuple(zip(keys, values, strict=True)), rest

    def whole(rest: tuple[Any, ...], values: Iterable[Any]) -> Any:
        tree = object.__new__(cls)
        vars(tree).update(zip(leaves, values, strict=True))
        vars(tree).update(zip(others, rest, strict=True))
        return tree

    tree_util.register_pytree_with_keys(cls, parts_with_keys, whole, parts)


class _AfterJax(importlib.abc.MetaPathFinder):
    """Finds JAX as the other finders do, and does what waits when it has been
    imported.
    """

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,
        target: ModuleType | None = None,
    ) -> importlib.machinery.ModuleSpec | None:
        if fullname != "jax":
            return None
        for finder in sys.meta_path:
            spec = None if finder is self else finder.find_spec(fullname, path, target)
            if spec is not None and spec.loader is not None:
                spec.loader.exec_module = _followed(spec.loader.exec_module)  # type: ignore[method-assign]
                return spec
        return None


def _followed(run: Callable[[ModuleType], None]) -> Callable[[ModuleType], None]:
    def exec_module(module: ModuleType) -> None:
        run(module)
        _do_waiting()

    return exec_module


if not any(type(finder).__name__ == _AfterJax.__name__ for finder in sys.meta_path):
    sys.meta_path.insert(0, _AfterJax())
