"""Everything that src imports from elsewhere is declared in pyproject.toml: for users,
or as an optional extra.
"""

import ast
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]


def names(requirements: list[str]) -> set[str]:
    """The packages of a list of requirements, as they are imported."""
    return {
        re.match(r"[\w-]+", one)[0].lower().replace("-", "_") for one in requirements
    }


def imported() -> dict[str, list[tuple[str, bool]]]:
    """Package to the files that import it, and whether they do so when they are
    loaded.
    """
    found: dict[str, list[tuple[str, bool]]] = {}
    for path in sorted((ROOT / "src").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            modules = []
            if isinstance(node, ast.Import):
                modules = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
                modules = [node.module]
            for module in modules:
                found.setdefault(module.split(".")[0].lower(), []).append(
                    (
                        path.relative_to(ROOT / "src/elastomdr").as_posix(),
                        node in tree.body,
                    )
                )
    return found


def test_imports_are_declared():
    required = names(PROJECT["dependencies"])
    users = ("tables", "excel", "interactive", "instruments", "sweep", "app")
    optional = {
        name
        for extra in users
        for name in names(PROJECT["optional-dependencies"][extra])
    }
    own = {"elastomdr", *(name.lower() for name in sys.stdlib_module_names)}
    found = {
        package: where for package, where in imported().items() if package not in own
    }
    assert {"numpy", "jax", "pint"} <= set(found)
    undeclared = set(found) - required - optional
    assert not undeclared
    for package in optional & set(found):  # an extra may be absent
        loaded = [
            name
            for name, loaded in found[package]
            if loaded and not name.startswith("app/")
        ]
        # the page needs NiceGUI, and nothing else loads the page
        assert not loaded, package
    assert required <= set(found), "declared and never imported"
