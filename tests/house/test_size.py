"""How large each room is, and how much of it is untyped: numbers that may only fall.

A room that grew says in the commit that raises its number what for. One that shrank
lowers its number: `python tests/house/test_size.py` prints the table of today.
"""

import ast
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

import elastomdr as em

SOURCE = Path(em.__file__).parent
# Thousands of syntax nodes (`ast.walk`), begun ones counted
ROOMS = {
    "transient": 68,
    "rough": 61,
    "fit": 68,
    "smooth": 48,
    "seal": 41,
    "results": 43,
    "io": 36,
    "surface": 31,
    "app": 30,
    "cli": 28,
    "material": 18,
    "sweeps": 16,
    "element": 20,
    "ground": 14,
    "tyre": 11,
    "reference": 9,
    "belt": 9,
    "numerics": 6,
    "call": 7,
    "units": 4,
    "verbs": 4,
}
# of the whole package
FILES = 238
UNTYPED = 144  # parameters annotated `Any`, or not at all
MAPPINGS = 30  # `dict[str, Any]` and `Mapping[str, Any]` in signatures
KEYWORDS = 18  # functions that take **
# functions that return tuples of more than three: that of diffrax for a solver, the
# carries of nine loops, a sweep whose passages lie flat among its numbers, what two
# doubts are compared by, and the names of needed columns
LONG_TUPLES = 13
GROUND = "ground"  # files of no room


@cache
def files() -> tuple[tuple[str, ast.Module], ...]:
    """The room of each file, and its syntax tree."""
    return tuple(_files())


def _files() -> Iterator[tuple[str, ast.Module]]:
    for path in sorted(SOURCE.rglob("*.py")):
        yield room_of(path), ast.parse(path.read_text("utf-8"))


def room_of(path: Path) -> str:
    place = path.relative_to(SOURCE).parts
    return place[0] if len(place) > 1 else GROUND


def functions() -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    for _, tree in files():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield node


@cache
def rooms() -> dict[str, int]:
    nodes: Counter[str] = Counter()
    for room, tree in files():
        nodes[room] += sum(1 for _ in ast.walk(tree))
    return {room: -(-n // 1000) for room, n in nodes.most_common()}


def signature(function: ast.FunctionDef | ast.AsyncFunctionDef) -> list[ast.arg]:
    given = function.args
    named = given.posonlyargs + given.args + given.kwonlyargs
    return [a for a in named if a.arg not in ("self", "cls")]


def untyped() -> int:
    return sum(
        a.annotation is None or ast.unparse(a.annotation) == "Any"
        for function in functions()
        for a in signature(function)
    )


def mappings() -> int:
    written = [
        ast.unparse(said)
        for f in functions()
        for said in (f.returns, *(a.annotation for a in signature(f)))
        if said is not None
    ]
    untyped = ("dict[str, Any]", "Mapping[str, Any]")
    return sum(said.count(each) for said in written for each in untyped)


def keywords() -> int:
    return sum(function.args.kwarg is not None for function in functions())


def is_long(tuple_of: ast.expr | None) -> bool:
    return isinstance(tuple_of, ast.Tuple) and len(tuple_of.elts) > 3


def returned(function: ast.FunctionDef | ast.AsyncFunctionDef) -> Iterator[ast.expr]:
    """What a function returns; not the functions within it."""
    left: list[ast.AST] = [*function.body]
    while left:
        node = left.pop()
        if isinstance(node, ast.Return) and node.value is not None:
            yield node.value
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            left += ast.iter_child_nodes(node)


def long_tuples() -> int:
    """Functions that return a tuple of more than three, by their signature or by a
    `return` that spells it.
    """
    return sum(
        (
            isinstance(f.returns, ast.Subscript)
            and ast.unparse(f.returns.value) == "tuple"
            and is_long(f.returns.slice)
        )
        or any(map(is_long, returned(f)))
        for f in functions()
    )


@pytest.mark.parametrize("room", sorted({*ROOMS, *map(room_of, SOURCE.rglob("*.py"))}))
def test_a_room_only_shrinks(room: str) -> None:
    now, most = rooms().get(room, 0), ROOMS.get(room, 0)
    assert now <= most, f"{room} grew from {most} to {now} thousand nodes: what for?"
    assert now >= 0.97 * most - 1, f"{room} shrank to {now}: lower its number"


@pytest.mark.parametrize(
    ("count", "most"),
    [
        (lambda: sum(1 for _ in files()), FILES),
        (untyped, UNTYPED),
        (mappings, MAPPINGS),
        (keywords, KEYWORDS),
        (long_tuples, LONG_TUPLES),
    ],
    ids=["files", "untyped parameters", "dict[str, Any]", "**", "tuples"],
)
def test_doors_are_typed(count: Callable[[], int], most: int) -> None:
    now = count()
    assert now <= most, f"{now} where {most} were: what for?"
    assert now >= 0.95 * most - 2, f"only {now} are left of {most}: lower the number"


def test_class_names_are_unique():
    names = Counter(
        node.name
        for _, tree in files()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
    )
    assert not {name for name, times in names.items() if times > 1}


if __name__ == "__main__":
    print(rooms(), sum(rooms().values()))
    print(sum(1 for _ in files()), untyped(), mappings(), keywords(), long_tuples())
