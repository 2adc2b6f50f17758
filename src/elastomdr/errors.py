"""What elastomdr raises and warns with; every message names the argument, the value and
what is accepted.
"""

import contextlib
import difflib
import os
import reprlib
import sys
import warnings
from collections.abc import Iterable, Iterator
from contextvars import ContextVar
from typing import NamedTuple

_PACKAGE = os.path.dirname(__file__) + os.sep


class InputError(ValueError):
    """Raised for input that has no meaning: it names the argument, the value and what
    is accepted.

    Args:
        said: the whole sentence; by default "ARGUMENT must be ACCEPTED, got GOT: HINT."
        argument: its name, also an attribute of the error; "" where the sentence has it.
        got: the value that is refused, likewise.
        accepted: what is accepted, in words, likewise.
        hint: what to do, in words, likewise.
    """

    def __init__(
        self,
        said: str = "",
        *,
        argument: str = "",
        got: object = None,
        accepted: str = "",
        hint: str = "",
    ):
        self.argument, self.got = argument, got
        self.accepted, self.hint = accepted, hint
        value = f"{got:g}" if isinstance(got, float) else reprlib.repr(got)
        reason = f": {hint}" if hint else ""
        super().__init__(said or f"{argument} must be {accepted}, got {value}{reason}.")


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


def closest(word: str, valid: Iterable[str]) -> str:
    """Returns " Did you mean 'x'?" for the valid word nearest to `word`, or an empty
    string.
    """
    near = difflib.get_close_matches(word, list(valid), n=1, cutoff=0.5)
    return f" Did you mean {near[0]!r}?" if near else ""


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
