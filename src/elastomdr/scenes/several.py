"""A list of materials in place of one: the verb is called for each, and the results share a first axis."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from ..errors import InputError

P = ParamSpec("P")
R = TypeVar("R")


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
            for name, each in zip(names, material, strict=True):
                results.append(call(each, *args[1:], **rest))
                said += [name] * (len(caught) - len(said))
        _once(list(zip(said, caught, strict=True)))
        return type(results[0]).stack(results, names)

    return wrapper


def _once(caught: list[tuple[str, warnings.WarningMessage]]) -> None:
    """One warning of each category for all materials; what is said of all of them alike is said once."""
    of_category: dict[type[Warning], dict[str, list[str]]] = {}
    for name, one in caught:
        of_category.setdefault(one.category, {}).setdefault(str(one.message), []).append(name)
    for category, texts in of_category.items():
        said = "; ".join(f"{', '.join(names)}: {text}" for text, names in texts.items())
        warnings.warn(said, category, stacklevel=3)
