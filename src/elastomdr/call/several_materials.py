"""A list of materials in place of one: the verb is called for each, and the results
share a first axis.

Draws of a material, of a surface, or of both are such a list, computed to a relative
error of 1e-4 if nothing else is asked for, since they are to give a band.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Sequence
from typing import Any, ParamSpec, TypeVar

from ..arrays import one_thread
from ..errors import Heard, InputError, heard, warn
from ..material.validity import Draws
from ..progress_bar import counted
from ..results.base import Again, Result, distinct

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

    takes_rtol = "rtol" in inspect.signature(verb).parameters

    @functools.wraps(verb)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        material = args[0] if args else kwargs.get("material")
        shape = args[1] if len(args) > 1 else None
        if len(args) < 2:
            shape = next((kwargs[key] for key in _SHAPES if key in kwargs), None)
        if isinstance(shape, Draws):
            material = _beside(shape, material)
        if not isinstance(material, (list, tuple)):
            return verb(*args, **kwargs)
        if not material:
            raise InputError(
                argument="material",
                got=material,
                accepted="a material or a list of one or more",
            )
        named: dict[str, Any] = dict(kwargs)
        if takes_rtol and isinstance(material, Draws):
            named.setdefault("rtol", RTOL)
        call = functools.partial(verb, *args, **named)
        calls = [_of_one(i, material, shape, call) for i in range(len(material))]
        names = [
            getattr(each, "name", "") or f"material {i}"
            for i, each in enumerate(material, 1)
        ]
        drawn = None
        if isinstance(material, Draws):
            draws_in_words = (
                f"{len(material)} draws of {material.name or 'the material'}"
            )
            drawn = (draws_in_words, material.words)
        results = _computed(calls, names, drawn)
        again: Any = getattr(results[0], "again", None)
        if (
            isinstance(material, Draws) and again is not None
        ):  # of what they are draws of
            road = getattr(shape, "errors", None), getattr(shape, "of", None)
            again = again.of(material.of, *road)
        return _packed(results, names, drawn, again)

    return wrapper


def _of_one(
    i: int, material: Sequence[Any], shape: object, call: functools.partial[R]
) -> functools.partial[R]:
    """The call for one material, and for one surface where these are drawn."""
    others = call.args[1:]
    named = {key: value for key, value in call.keywords.items() if key != "material"}
    if isinstance(shape, Draws):
        others = (shape[i], *others[1:]) if others else ()
        named |= {key: shape[i] for key in _SHAPES if key in named}
    return functools.partial(call.func, material[i], *others, **named)


def _computed(
    calls: list[functools.partial[R]], names: list[str], drawn: tuple[str, str] | None
) -> list[R]:
    """The results of all calls; their warnings are given out together."""
    results: list[R] = []
    each = counted("each draw" if drawn else "each material", len(calls))
    with one_thread(), heard() as caught, each as add:
        of_whom: list[str] = []  # whose call gave each warning
        for i, (call, name) in enumerate(zip(calls, names, strict=True)):
            try:
                results.append(call())
                add(1)
            except InputError as error:
                of_material = error.argument == "material"
                if i == 0 and not of_material and _alike(calls[1:], error):
                    raise  # of the other arguments
                called = getattr(call.args[0], "name", "")
                which = f"material[{i}] ({called})" if called else f"material[{i}]"
                if error.argument == "material":
                    error.called(f"material[{i}]", which)
                else:
                    error.inside(which)
                raise
            of_whom += [drawn[0] if drawn else name] * (len(caught) - len(of_whom))
    of_each = list(zip(of_whom, caught, strict=True))
    _warn_once(of_each, _TEXTS if drawn is None else 1)
    return results


def _alike(calls: list[functools.partial[R]], error: InputError) -> bool:
    """Whether all calls fail in the same way."""
    for call in calls:
        try:
            call()
        except InputError as other:
            if (other.argument, other.accepted) == (error.argument, error.accepted):
                continue
        return False
    return True


def _packed(
    results: list[Any],
    names: list[str],
    drawn: tuple[str, str] | None,
    again: Again | None,
) -> Any:
    """One result with a first axis `material`, or all plans."""
    if isinstance(results[0], Result):
        return results[0].stack(results, names, drawn, again)
    if drawn is None:
        return Plans(results, distinct(names))
    return Plans(results[:1], [f"one of {drawn[0]}"])


def _beside(surfaces: Draws[Any], material: Any) -> Draws[Any]:
    """The materials that go with draws of a surface, one each. Raises `InputError` for
    lists that do not fit.
    """
    if not isinstance(material, (list, tuple)):
        words = f"{surfaces.name}: {surfaces.words}"
        return Draws([material] * len(surfaces), material, words)
    if not isinstance(material, Draws) or len(material) != len(surfaces):
        raise InputError(
            argument="material",
            got=material,
            accepted=f"one material, or {len(surfaces)} draws of one, as many draws "
            "as shape has of its surface",
        )
    words = f"{material.words}; {surfaces.name}: {surfaces.words}"
    return Draws(material, material.of, words)


def _warn_once(caught: list[tuple[str, Heard]], most: int) -> None:
    """One warning of each category for all materials; what is said of all of them alike
    is said once.
    """
    of_category: dict[type[Warning], dict[str, list[str]]] = {}
    for name, warning in caught:
        texts = of_category.setdefault(warning.category, {})
        texts.setdefault(warning.message, []).append(name)
    for category, texts in of_category.items():
        few = list(texts.items())[:most]
        sentence = "; ".join(
            f"{', '.join(dict.fromkeys(names))}: {message}" for message, names in few
        )
        sentence += f"; and {len(texts) - most} more" if len(texts) > most else ""
        warn(sentence, category)
