"""A list of materials in place of one: the verb is called for each, and the results share a first axis."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable, Sequence
from typing import Any, ParamSpec, TypeVar

from ..errors import InputError
from ..results.base import Result, distinct

P = ParamSpec("P")
R = TypeVar("R")


class Plans(tuple[Any, ...]):
    """The plans of several materials, in their order; printing shows all of them, with their names."""

    names: tuple[str, ...]

    def __new__(cls, plans: Sequence[Any], names: Sequence[str]) -> Plans:
        self = super().__new__(cls, plans)
        self.names = tuple(names)
        return self

    def __str__(self) -> str:
        return "\n\n".join(f"{name}\n{plan}" for name, plan in zip(self.names, self, strict=True))


def over_materials(verb: Callable[P, R]) -> Callable[P, R]:
    """Lets `verb` take a list of materials: its result then has a first axis `material`, with their names."""

    @functools.wraps(verb)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        material = args[0] if args else kwargs.get("material")
        if not isinstance(material, (list, tuple)):
            return verb(*args, **kwargs)
        if not material:
            raise InputError("material must be a material or a list of one or more, got an empty list.")
        call: Callable[..., R] = verb
        rest = {name: value for name, value in kwargs.items() if name != "material"}
        names = [getattr(each, "name", "") or f"material {i}" for i, each in enumerate(material, 1)]
        results: list[Any] = []
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            said = []  # which material each warning is of
            for i, (name, each) in enumerate(zip(names, material, strict=True)):
                try:
                    results.append(call(each, *args[1:], **rest))
                except InputError as error:
                    if i == 0 and not str(error).startswith("material"):
                        raise  # of the other arguments
                    raise InputError(f"material[{i}]{_called(each)}: {error}") from error
                said += [name] * (len(caught) - len(said))
        _once(list(zip(said, caught, strict=True)))
        first: Any = results[0]
        together: Any = Plans(results, distinct(names))
        return first.stack(results, names) if isinstance(results[0], Result) else together

    return wrapper


def _called(material: Any) -> str:
    name = getattr(material, "name", "")
    return f" ({name})" if name else ""


def _once(caught: list[tuple[str, warnings.WarningMessage]]) -> None:
    """One warning of each category for all materials; what is said of all of them alike is said once."""
    of_category: dict[type[Warning], dict[str, list[str]]] = {}
    for name, one in caught:
        of_category.setdefault(one.category, {}).setdefault(str(one.message), []).append(name)
    for category, texts in of_category.items():
        said = "; ".join(f"{', '.join(names)}: {text}" for text, names in texts.items())
        warnings.warn(said, category, stacklevel=3)
