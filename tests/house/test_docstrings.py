"""Docstrings of public calls: one sentence, the arguments that the call has, what it
returns and what it raises.
"""

import inspect
import re
from pathlib import Path

import pytest

import elastomdr as em

CALLS = {
    f"{package.__name__}.{name}": call
    for package in (em, em.fit, em.reference)
    for name in package.__all__
    if inspect.isfunction(call := getattr(package, name))
}


def section(text: str, title: str) -> str:
    """What is indented below a title."""
    found = re.search(rf"^{title}:\n((?:    .*\n?|\n)+)", text, re.MULTILINE)
    return found[1] if found else ""


def test_calls_are_found():
    assert {
        "elastomdr.friction",
        "elastomdr.fit.material",
        "elastomdr.reference.half_space_sliding",
    } <= set(CALLS)


@pytest.mark.parametrize(
    "name", [name for name, call in CALLS.items() if "Args:" in inspect.getdoc(call)]
)
def test_docstring_has_the_arguments_of_the_call(name):
    text, parameters = (
        inspect.getdoc(CALLS[name]),
        inspect.signature(CALLS[name]).parameters,
    )
    first = text.partition("\n\n")[0]
    assert first.endswith(".")
    assert "Args:" not in first
    assert re.findall(r"^    (\w+): ", section(text, "Args"), re.MULTILINE) == list(
        parameters
    )
    assert section(text, "Returns")


def test_no_docstring_has_code_that_nothing_runs():
    """pytest is not asked to look for doctests, which takes it seconds."""
    sources = Path(em.__file__).parent.rglob("*.py")
    assert not [path for path in sources if ">>> " in path.read_text(encoding="utf-8")]
