"""A list of materials in place of one: the verb is called for each, and the results
share a first axis.

Draws of a material, of a surface, or of both are such a list, computed to a relative
error of 1e-4 if nothing else is asked for, since they are to give a band.
"""

from __future__ import annotations

import functools
import inspect
import warnings
from collections.abc import Callable, Sequence
from typing import Any, ParamSpec, TypeVar

from ..arrays import one_thread
from ..errors import InputError
from ..material.validity import Draws
from ..results.base import Result, distinct

P = ParamSpec("P")
R = TypeVar("R")
RTOL = 1e-4  # of draws
_TEXTS = 12  # that a warning repeats; one of draws, which differ in numbers only
_SHAPES = ("shape", "surface")


class Plans(tuple[Any, ...]):
    """The plans of several materials, in their order; printing shows all of them, with
    their names.
    """

    names: tuple[str, ...]

    def __new__(cls, plans: Sequence[Any], names: Sequence[str]) -> Plans:
        self = super().__new__(cls, plans)
        self.names = tuple(names)
        return self

    def __str__(self) -> str:
        return "\n\n".join(
            f"{name}\n{plan}" for name, plan in zip(self.names, self, strict=True)
        )


def over_materials(verb: Callable[P, R]) -> Callable[P, R]:
    """Lets `verb` take a list of materials: its result then has a first axis
    `material`, with their names.
    """

    exact = "rtol" in inspect.signature(verb).parameters

    @functools.wraps(verb)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        material = args[0] if args else kwargs.get("material")
        shape = (
            args[1]
            if len(args) > 1
            else next((kwargs[key] for key in _SHAPES if key in kwargs), None)
        )
        if isinstance(shape, Draws):
            material = _beside(shape, material)
        if not isinstance(material, (list, tuple)):
            return verb(*args, **kwargs)
        if not material:
            raise InputError(
                "material must be a material or a list of one or more, got an "
                "empty list."
            )
        call: Callable[..., R] = verb
        rest = {name: value for name, value in kwargs.items() if name != "material"}
        drawn = None
        if isinstance(material, Draws):
            drawn = (
                f"{len(material)} draws of {material.name or 'the material'}",
                material.words,
            )
            rest |= {"rtol": rest.get("rtol", RTOL)} if exact else {}
        names = [
            getattr(each, "name", "") or f"material {i}"
            for i, each in enumerate(material, 1)
        ]
        results: list[Any] = []
        with one_thread(), warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            said = []  # which material each warning is of
            for i, (name, each) in enumerate(zip(names, material, strict=True)):
                others = args[1:]
                if isinstance(shape, Draws):
                    others = (shape[i], *others[1:]) if others else ()
                    rest |= {key: shape[i] for key in _SHAPES if key in kwargs}
                try:
                    results.append(call(each, *others, **rest))
                except InputError as error:
                    if i == 0 and not str(error).startswith("material"):
                        raise  # of the other arguments
                    raise InputError(
                        f"material[{i}]{_called(each)}: {error}"
                    ) from error
                said += [drawn[0] if drawn else name] * (len(caught) - len(said))
        _once(list(zip(said, caught, strict=True)), _TEXTS if drawn is None else 1)
        first: Any = results[0]
        together: Any = (
            Plans(results, distinct(names))
            if drawn is None
            else Plans(results[:1], [f"one of {drawn[0]}"])
        )
        return (
            first.stack(results, names, drawn)
            if isinstance(results[0], Result)
            else together
        )

    return wrapper


def _beside(surfaces: Draws[Any], material: Any) -> Draws[Any]:
    """The materials that go with draws of a surface, one each. Raises `InputError` for
    lists that do not fit.
    """
    if not isinstance(material, (list, tuple)):
        words = f"{surfaces.name}: {surfaces.words}"
        return Draws([material] * len(surfaces), getattr(material, "name", ""), words)
    if not isinstance(material, Draws) or len(material) != len(surfaces):
        raise InputError(
            "material must be one, or as many draws of one, where shape is "
            f"{len(surfaces)} draws of a surface, got a list of {len(material)}."
        )
    return Draws(
        material, material.name, f"{material.words}; {surfaces.name}: {surfaces.words}"
    )


def _called(material: Any) -> str:
    name = getattr(material, "name", "")
    return f" ({name})" if name else ""


def _once(caught: list[tuple[str, warnings.WarningMessage]], most: int) -> None:
    """One warning of each category for all materials; what is said of all of them alike
    is said once.
    """
    of_category: dict[type[Warning], dict[str, list[str]]] = {}
    for name, one in caught:
        of_category.setdefault(one.category, {}).setdefault(
            str(one.message), []
        ).append(name)
    for category, texts in of_category.items():
        few = list(texts.items())[:most]
        said = "; ".join(
            f"{', '.join(dict.fromkeys(names))}: {text}" for text, names in few
        )
        said += f"; and {len(texts) - most} more" if len(texts) > most else ""
        warnings.warn(said, category, stacklevel=3)
