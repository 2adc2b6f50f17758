"""Calls that are refused, by what their error is about: wording is free."""

import contextlib
import re
from collections.abc import Iterator

import pytest

import elastomdr as em

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w]|\.\d)")


def numbers(text: str) -> list[float]:
    """The numbers that stand in a text, in order."""
    return [float(found) for found in NUMBER.findall(text)]


@contextlib.contextmanager
def refused(
    argument: str, *named: str | float
) -> Iterator[pytest.ExceptionInfo[em.InputError]]:
    """Holds the error against its argument ("" where another part of the call may be
    at fault) and what it must name: values, units, files, keys, what would help.
    """
    with pytest.raises(em.InputError) as caught:
        yield caught
    said = str(caught.value)
    assert argument in ("", caught.value.argument), said
    for fact in named:
        there = fact in said if isinstance(fact, str) else fact in numbers(said)
        assert there, f"{fact} is not in {said}"
