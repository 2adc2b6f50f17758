"""What is said, held against what it is about and must name: its wording is free."""

import contextlib
import re
import warnings
from collections.abc import Iterator

import pytest

import elastomdr as em

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w]|\.\d)")


def numbers(text: str) -> list[float]:
    """The numbers that stand in a text, in order."""
    return [float(found) for found in NUMBER.findall(text)]


def mentions(text: object, *facts: str | float) -> bool:
    """Whether a text has all of these values, units, files, keys, or words."""
    said = str(text)
    for fact in facts:
        there = fact in said if isinstance(fact, str) else fact in numbers(said)
        assert there, f"{fact} is not in {said}"
    return True


@contextlib.contextmanager
def refused(
    argument: str, *facts: str | float
) -> Iterator[pytest.ExceptionInfo[em.InputError]]:
    """Holds the error against its argument ("" where another part of the call may be
    at fault) and what it must name.
    """
    with pytest.raises(em.InputError) as caught:
        yield caught
    said = str(caught.value)
    assert argument in ("", caught.value.argument), said
    assert mentions(said, *facts)


@contextlib.contextmanager
def warned(
    category: type[Warning], *facts: str | float
) -> Iterator[pytest.WarningsRecorder]:
    """Holds a warning of this category against what it must name; others are issued."""
    with pytest.warns(category) as caught:
        yield caught
    others = [each for each in caught if not held(str(each.message), facts)]
    assert len(others) < len(caught), [str(each.message) for each in caught]
    for each in others:
        warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)


def held(said: str, facts: tuple[str | float, ...]) -> bool:
    try:
        return mentions(said, *facts)
    except AssertionError:
        return False
