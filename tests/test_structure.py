"""The floors of docs/structure.md: each package imports only from those above it; figures, files have their rooms."""

import ast
from collections.abc import Iterator
from pathlib import Path

import elastomdr as em

SOURCE = Path(em.__file__).parent
FLOORS = ("material", "mapping", "foundation", "solve", "results", "scenes", "reference", "fit", "cli")


def imports(path: Path) -> Iterator[tuple[str, ...]]:
    """The modules of this package that a file imports, and other packages by their name."""
    home = ("elastomdr", *path.relative_to(SOURCE).with_suffix("").parts)
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    skipped = set()
    for node in nodes:  # what only a reader of types sees
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            skipped |= {id(inner) for inner in ast.walk(node)}
    for node in nodes:
        if id(node) in skipped:
            continue
        if isinstance(node, ast.ImportFrom):
            base = home[: len(home) - node.level] if node.level else ()
            yield (*base, *(node.module or "").split("."))
        elif isinstance(node, ast.Import):
            yield from (tuple(name.name.split(".")) for name in node.names)


def files(*parts: str) -> list[Path]:
    found = sorted(SOURCE.joinpath(*parts).rglob("*.py"))
    assert found
    return found


def is_figure(module: tuple[str, ...]) -> bool:
    """A method `plot` imports its figure where it is called."""
    return module[1:2] == ("results",) and module[-1].endswith("_figure")


def test_floors():
    for floor, name in enumerate(FLOORS):
        below = set(FLOORS[floor + 1 :])
        for path in files(name):
            inside = [module for module in imports(path) if module[0] == "elastomdr" and not is_figure(module)]
            wrong = [module for module in inside if below & {*module[1:2]}]
            assert not wrong, f"{path.relative_to(SOURCE)} imports {wrong}"


def test_reading_knows_no_fit():
    """What reads files may group and check points; no fit reads files."""
    allowed = {"data", "isotherms", "passive", "spectrum"}
    for path in files("fit"):
        inside = path.parent.name == "reading"
        for module in imports(path):
            if module[:2] != ("elastomdr", "fit"):
                continue
            if inside:
                assert module[2] in allowed | {"reading"}, f"{path.name} imports {module}"
            else:
                assert module[2] != "reading", f"{path.name} imports {module}"


def test_figures_have_their_files():
    for path in files():
        if path.name.endswith("figure.py") and path.parent.name == "results":
            continue
        assert not [module for module in imports(path) if module[0] == "matplotlib"], path
