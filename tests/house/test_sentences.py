"""How many of our own sentences tests compare word for word: a number that may only fall.

Words may get better without a test that fails. What a test holds are values, kinds of
doubts, and the argument of an error with what it names (`tests/refused.py`). The
sentences themselves stand once, in `tests/whole/test_catalogue.py`.

Counted are texts on one line of five words or more in an assertion or as what a raised
error or warning must match; also those that stand there by name: of a variable, or of a
parameter of the test. `python tests/house/test_sentences.py` prints where they are.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

TESTS = Path(__file__).parents[1]
CATALOGUE = "test_catalogue.py"
MOST = 67  # 556 at first
WORDS = 5
WORD = re.compile(r"\S*[A-Za-z]{2}\S*")
Named = dict[str, list[ast.expr]]  # what names stand for


def text(node: ast.expr) -> str:
    """A literal, with a gap for what is put into it."""
    if isinstance(node, ast.JoinedStr):
        return "".join(text(part) for part in node.values)
    value = node.value if isinstance(node, ast.Constant) else " "
    return value if isinstance(value, str) else ""


def sentences(node: ast.AST, named: Named) -> Iterator[ast.expr]:
    """Those of an expression, and of what its names stand for."""
    match node:
        case ast.JoinedStr() | ast.Constant():
            said = text(node)
            if "\n" not in said and len(WORD.findall(said)) >= WORDS:
                yield node
        case ast.Name(id=name):
            for value in named.get(name, ()):
                yield from sentences(value, {})
        case _:
            for child in ast.iter_child_nodes(node):
                yield from sentences(child, named)


def compared(function: ast.FunctionDef) -> Iterator[ast.expr]:
    for node in ast.walk(function):
        if isinstance(node, ast.Assert):
            yield node.test
        elif isinstance(node, ast.keyword) and node.arg == "match":
            yield node.value


def assigned(nodes: Iterable[ast.AST]) -> Named:
    """Literals that have a name."""
    literal = ast.Constant | ast.JoinedStr | ast.Dict | ast.List | ast.Tuple
    named: Named = {}
    for node in nodes:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                if isinstance(value, literal):
                    named.setdefault(name, []).append(value)
    return named


def parameters(function: ast.FunctionDef, module: Named) -> Named:
    """The values of the parameters of a test."""
    named: Named = {}
    for mark in function.decorator_list:
        match mark:
            case ast.Call(
                func=ast.Attribute(attr="parametrize"), args=[names, rows, *_]
            ):
                listed = ast.literal_eval(names)
                if isinstance(listed, str):
                    listed = [name.strip() for name in listed.split(",")]
                if isinstance(rows, ast.Name):
                    rows = module.get(rows.id, [rows])[0]
                for row in rows.elts if isinstance(rows, ast.List | ast.Tuple) else ():
                    cells = [row]
                    if isinstance(row, ast.Call):
                        cells = row.args  # pytest.param
                    elif len(listed) > 1 and isinstance(row, ast.Tuple | ast.List):
                        cells = row.elts
                    for name, cell in zip(listed, cells, strict=False):
                        named.setdefault(name, []).append(cell)
    return named


def found(file: Path) -> list[tuple[int, str]]:
    """The sentences of a file that its tests compare, with their lines."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    module = assigned(tree.body)
    functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)]
    places = {}
    for function in functions:
        own = assigned(ast.walk(function))
        named = module | own | parameters(function, module)
        for expression in compared(function):
            for node in sentences(expression, named):
                places[node.lineno, node.col_offset] = text(node)
    return [(line, said) for (line, _), said in sorted(places.items())]


def every() -> dict[Path, list[tuple[int, str]]]:
    files = sorted(TESTS.rglob("*.py"))
    return {file: found(file) for file in files if file.name != CATALOGUE}


def test_sentences_only_become_fewer():
    now = sum(len(places) for places in every().values())
    assert now <= MOST, f"{now} sentences are compared where {MOST} were"
    assert now >= 0.9 * MOST - 5, f"only {now} are left of {MOST}: lower the number"


if __name__ == "__main__":
    for file, places in every().items():
        for line, said in places:
            print(f"{file.relative_to(TESTS)}:{line}: {said}")
    print(sum(len(places) for places in every().values()))
