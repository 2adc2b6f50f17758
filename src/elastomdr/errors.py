"""What elastomdr raises and warns with; every message names the argument, the value and
what is accepted.
"""

from __future__ import annotations

import contextlib
import difflib
import os
import reprlib
import shlex
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from typing import NamedTuple, SupportsFloat

_PACKAGE = os.path.dirname(__file__) + os.sep


class InputError(ValueError):
    """Raised for input that has no meaning: it names the argument, the value and what
    is accepted.

    Args:
        argument: its name, as it was typed; also an attribute of the error.
        accepted: what is accepted, in words that follow "must be", likewise.
        got: the value that is refused, likewise; None where nothing was given, or it
            is not told.
        hint: what to do, in words, likewise; an advice may be in it.
    """

    def __init__(
        self, *, argument: str, accepted: str, got: object = None, hint: str = ""
    ):
        super().__init__()
        self.argument, self.accepted, self.hint = argument, accepted, hint
        self.got = got
        # what holds it, outermost first: the argument that names a file, and the file
        self.places: tuple[tuple[str, str], ...] = ()
        # what the sentence begins with, which may say more than the argument
        self.subject = argument
        self.args = (str(self),)

    def __reduce__(self) -> tuple[object, ...]:
        return _as_it_was, (type(self), self.__dict__)

    def __str__(self) -> str:
        return self.words()

    def words(
        self,
        called: Callable[[str], str] = str,
        shown: Callable[[object], str] | None = None,
        advice: Callable[[Options], str] | None = None,
    ) -> str:
        """The sentence behind its places: arguments have the names that `called` gives
        them, the value is as `shown` writes it, and what the hint says to type as
        `advice` does.
        """
        hint, accepted = (told(x, shown, advice) for x in (self.hint, self.accepted))
        if hint:
            hint = f". {hint}" if hint.endswith(("?", ".")) else f": {hint}."
        got = "" if self.got is None else f", got {(shown or written)(self.got)}"
        places = (
            f"{called(argument) if argument else ''} {place}".strip()
            for argument, place in self.places
        )
        sentence = f"{called(self.subject)} must be {accepted}{got}{hint or '.'}"
        return ": ".join((*places, sentence))

    def inside(self, place: str, argument: str = "") -> None:
        """Puts what holds the argument before the sentence; then `raise`.

        Args:
            place: such as a file, or one of several materials.
            argument: the argument that was typed where the own one is a part of the
                place; nothing is put before an error that is about this argument.
        """
        if not argument or self.argument != argument:
            self.places = ((argument, place), *self.places)
            self.argument = argument or self.argument

    def called(self, argument: str, subject: str = "") -> None:
        """Names the argument as it was typed, and, if that says more, as the sentence
        calls it.
        """
        old, self.argument = self.argument, argument
        if self.subject == old:
            self.subject = subject or argument
        self.places = tuple(
            (argument if named == old and old else named, place)
            for named, place in self.places
        )


def _as_it_was(kind: type[InputError], attributes: dict[str, object]) -> InputError:
    """An error that comes from another process."""
    error = kind.__new__(kind)
    vars(error).update(attributes)
    return error


class _Brief(reprlib.Repr):
    def repr_float(self, x: float, level: int) -> str:
        return f"{x:g}"

    repr_float64 = repr_float  # of NumPy


_BRIEF = _Brief()
_BRIEF.maxstring = _BRIEF.maxother = 120
_MOST = 6  # entries that are shown


def written(value: object) -> str:
    """A value in a sentence: numbers of six digits, an array of a few entries."""
    units = getattr(value, "units", None)  # of a quantity of pint
    if units is not None and (number := getattr(value, "magnitude", None)) is not None:
        return f"{written(number)} {units}"
    shape = getattr(value, "shape", None)
    if isinstance(value, float):
        return f"{value:g}"
    if hasattr(value, "in_python") and not isinstance(value, type):  # a model
        return f"em.{value.in_python()}"  # pyright: ignore[reportAttributeAccessIssue]
    if isinstance(shape, tuple):
        if sum(shape) > _MOST or len(shape) > 1:
            return f"an array of the shape {shape}"
        value = getattr(value, "tolist", lambda: value)()
    value = str(value) if isinstance(value, os.PathLike) else value
    return " ".join(_BRIEF.repr(value).split())


@contextlib.contextmanager
def typed_as(argument: str, name: str) -> Iterator[None]:
    """Calls an argument of an `InputError` by the name under which it was typed."""
    try:
        yield
    except InputError as error:
        if error.argument == argument:
            error.called(name)
        raise


class ConvergenceWarning(UserWarning):
    """Issued once per call when points did not converge; those points are NaN with
    `converged=False`.
    """


class ExtrapolationWarning(UserWarning):
    """Issued once per call when a material is used at frequencies or temperatures
    beyond those it was measured at.
    """


class ModelWarning(UserWarning):
    """Issued once per call when a model leaves out what matters for the body or surface
    it is used on.
    """


Options = Mapping[str, str | list[str]]  # of the command line


class Advised(str):
    """A text in parts: of each what Python says, and the data that the command line and
    the page have other words for, such as options (`advise`), a model, or an `amount`.
    """

    parts: tuple[tuple[str, object], ...]

    @classmethod
    def of(cls, *parts: tuple[str, object]) -> Advised:
        self = cls("".join(said for said, _ in parts))
        self.parts = parts
        return self

    def __add__(self, other: str) -> Advised:
        return Advised.of(*self.parts, *_parts(other))

    def __radd__(self, other: str) -> Advised:
        return Advised.of(*_parts(other), *self.parts)


def _parts(text: str) -> tuple[tuple[str, object], ...]:
    return text.parts if isinstance(text, Advised) else ((text, None),)


def advise(python: str, options: Options) -> Advised:
    """Arguments to give, for a sentence: in Python, and as options of the command line,
    such as "temperature=293.15 (--temperature 20degC)". Sentences are added to it,
    since an f-string would make a plain text of it.
    """
    return Advised.of((f"{python} ({as_options(options)})", options))


def as_options(options: Options) -> str:
    """Options as the command line has them."""
    return " ".join(
        f"--{name.replace('_', '-')} {shlex.quote(value) if value else ''}".strip()
        for name, values in options.items()
        for value in ([values] if isinstance(values, str) else values)
    )


class Amount(NamedTuple):
    """A number within a text."""

    value: float  # in SI units
    unit: str


def amount(value: SupportsFloat, unit: str, digits: int = 6) -> Advised:
    """A number in SI units, for a sentence; scenes say it in the unit that was typed.
    Sentences are added to it, as to what `advise` returns.
    """
    number = float(value)
    return Advised.of((f"{number:.{digits}g} {unit}", Amount(number, unit)))


def told(
    text: str,
    shown: Callable[[object], str] | None = None,
    advice: Callable[[Options], str] | None = None,
) -> str:
    """A text whose values are as `shown` writes them, and whose advices as `advice`
    writes their options.
    """

    def part(said: str, data: object) -> str:
        if isinstance(data, Mapping):
            return advice(data) if advice else said
        return said if data is None or shown is None else shown(data)

    return "".join(part(said, data) for said, data in _parts(text))


def advised(text: str) -> list[Options]:
    """The options that a text advises to give, in order."""
    return [data for _, data in _parts(text) if isinstance(data, Mapping)]


def either(ways: Sequence[str]) -> str:
    """Several of which one is enough, in words."""
    *others, last = ways
    for i, way in enumerate(reversed(others)):
        last = way + (", " if i else " or ") + last
    return last


def closest(word: str, valid: Iterable[str]) -> str:
    """Returns "Did you mean 'x'?" for the valid word nearest to `word`, or an empty
    string.
    """
    near = difflib.get_close_matches(word, list(valid), n=1, cutoff=0.65)
    return f"Did you mean {near[0]!r}?" if near else ""


class Heard(NamedTuple):
    """A warning of this package that somebody has listened to."""

    message: str
    category: type[Warning]


_LISTENER: ContextVar[list[Heard] | None] = ContextVar("listener", default=None)


@contextlib.contextmanager
def heard() -> Iterator[list[Heard]]:
    """Lists the warnings of this package and thread in place of issuing them.

    `warnings.catch_warnings` is no way for that where threads work side by side: it
    changes what is done with those of all, and puts back what was there when it began.
    """
    said: list[Heard] = []
    token = _LISTENER.set(said)
    try:
        yield said
    finally:
        _LISTENER.reset(token)


@contextlib.contextmanager
def quiet(*ignored: type[Warning]) -> Iterator[None]:
    """Leaves out the package's warnings of these kinds, of all where none is named."""
    with heard() as said:
        yield
    for message, category in said:
        if ignored and not issubclass(category, ignored):
            warn(message, category)


def warn(message: str, category: type[Warning]) -> None:
    """Issues a warning at the line that called this package, or tells who listens.

    That line is just outside of the outermost frame of the package: decorators of the
    standard library, SciPy and JAX may stand between inner ones.
    """
    if (said := _LISTENER.get()) is not None:
        said.append(Heard(message, category))
        return
    caller, frames, frame = 2, 1, sys._getframe(0)
    while frame is not None:
        frames += 1
        if frame.f_code.co_filename.startswith(_PACKAGE):
            caller = frames
        frame = frame.f_back
    warnings.warn(message, category, stacklevel=caller)


@contextlib.contextmanager
def warned_once() -> Iterator[None]:
    """Issues the warnings of several calls together, one of each category; what they
    say alike is said once.
    """
    with heard() as said:
        yield
    texts: dict[type[Warning], dict[str, None]] = {}
    for message, category in said:
        texts.setdefault(category, {})[message] = None
    for category, distinct in texts.items():
        warn(" ".join(distinct), category)
