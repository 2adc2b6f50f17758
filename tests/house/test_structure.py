"""The rooms of docs/structure.md: each imports only from those above it; figures and
files have their rooms.
"""

import ast
import functools
import re
import subprocess
import sys
from pathlib import Path

import pytest

import elastomdr as em

SOURCE = Path(em.__file__).parent
FLOORS = (
    "errors",
    "_types",
    "units",
    "linear_update",
    "notebook_tables",
    "trees",
    "arrays",
    "checks",
    "files",
    "progress_bar",
    "models",
    "numerics",
    "results",
    "material",
    "surface",
    "element",
    "call",
    "smooth",
    "rough",
    "transient",
    "reference",
    "verbs",
    "tyre",
    "belt",
    "seal",
    "sweeps",
    "io",
    "fit",
    "cli",
    "app",
)

# functions that are a verb's steps, in the file that computes it
STEPS = {
    "smooth/problem": "check solve report",
    "smooth/cylinder": "_check _solve _judge",
    "rough/surface": "_check _plan _solve _judge _report",
    "rough/line": "_plan _judge _report",
    "rough/friction_spectrum": "_check _solve _report",
    "rough/press": "_check _judge _report",
    "transient/indent": "_check _solve _judge",
    "transient/impact": "_check _judge _report",
    "transient/slide": "_solve",
    "transient/drive": "_solve _report",
    "transient/shear": "_check _solve _judge",
    "tyre/traction": "_solve _report",
    "belt/conveyor": "_check _solve",
    "belt/heat_build_up": "_check _solve",
    "seal/leak": "_check _judge _report",
    "seal/o_ring": "_check _solve",
    "seal/lubricated": "_check _solve _judge _report",
    "seal/reciprocating": "_check _judge _report",
}


@functools.cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@functools.cache
def imports(path: Path, types: bool = False) -> list[tuple[str, ...]]:
    """The modules of this package that a file imports, and other packages by their
    name; with `types`, also what only a reader of types sees.
    """
    home = ("elastomdr", *path.relative_to(SOURCE).with_suffix("").parts)
    tree = tree_of(path)
    nodes = list(ast.walk(tree))
    skipped = set()
    for node in nodes:
        if (
            not types
            and isinstance(node, ast.If)
            and "TYPE_CHECKING" in ast.unparse(node.test)
        ):
            skipped |= {id(inner) for inner in ast.walk(node)}
    modules: list[tuple[str, ...]] = []
    for node in nodes:
        if id(node) in skipped:
            continue
        if isinstance(node, ast.ImportFrom):
            base = home[: len(home) - node.level] if node.level else ()
            module = (*base, *filter(None, (node.module or "").split(".")))
            modules.append(module)
            modules += [  # files imported by name, as in `from . import road_models`
                (*module, name.name)
                for name in node.names
                if SOURCE.joinpath(*module[1:], f"{name.name}.py").is_file()
            ]
        elif isinstance(node, ast.Import):
            modules += [tuple(name.name.split(".")) for name in node.names]
    return modules


def files(*parts: str) -> list[Path]:
    place = SOURCE.joinpath(*parts)
    found = (
        sorted(place.rglob("*.py")) if place.is_dir() else [place.with_suffix(".py")]
    )
    assert found
    return found


def is_figure(module: tuple[str, ...]) -> bool:
    """A method `plot` imports what draws where it is called."""
    return module[1:] == ("results", "plotting")


def test_floors():
    for floor, name in enumerate(FLOORS):
        below = set(FLOORS[floor + 1 :])
        for path in files(name):
            inside = [
                module
                for module in imports(path)
                if module[0] == "elastomdr" and not is_figure(module)
            ]
            wrong = [module for module in inside if below & {*module[1:2]}]
            assert not wrong, f"{path.relative_to(SOURCE)} imports {wrong}"


def test_structure_shows_the_rooms_in_their_order():
    page = Path(__file__).parents[2] / "docs" / "structure.md"
    section = page.read_text(encoding="utf-8").partition("## Rooms\n")[2]
    table = section.partition("\n## ")[0]
    rows = re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
    assert tuple(re.findall(r"`(\w+)`", " ".join(rows))) == FLOORS


@pytest.mark.parametrize("file", STEPS)
def test_steps_of_a_verb_have_their_names(file):
    """Each is called by its name, in its file or in one that imports it."""
    tree, steps = tree_of(SOURCE / f"{file}.py"), STEPS[file].split()
    assert {*steps} <= {n.name for n in tree.body if isinstance(n, ast.FunctionDef)}
    called = {
        n.func.id
        for path in files()
        if path == SOURCE / f"{file}.py"
        or ("elastomdr", *file.split("/")) in imports(path)
        for n in ast.walk(tree_of(path))
        if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
    }
    assert {*steps} <= called


def test_the_package_holds_what_it_reads():
    """Not the remains of a patch or of an editor."""
    known = {".py", ".pyi", ".typed", ".css", ".js", ".mplstyle", ".toml", ".bib"}
    stray = {
        path.name
        for path in SOURCE.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
        if path.suffix not in known
    }
    assert not stray


def test_files_of_structure_exist():
    """`smooth/plan.py` of a table or a sentence, the first one of a list in full."""
    page = Path(__file__).parents[2] / "docs" / "structure.md"
    named = re.findall(r"`(\w+/[\w/]+\.py)`", page.read_text(encoding="utf-8"))
    assert len(named) > 30
    for name in named:
        place = page.parents[1] / name if name.startswith("docs/") else SOURCE / name
        assert place.exists(), name


FILES_OF_A_CALL = """
import sys
import elastomdr as em
rubber = em.Prony(equilibrium=1e6, moduli=[1e6], times=[1e-3])
passed = set()
for note in (None, lambda frame, *_: passed.add(frame.f_code.co_filename)):
    # once beforehand, so that a file that is only imported does not count
    sys.settrace(note)
    em.friction(rubber, em.Sphere(5e-3), velocity=[0.1, 1.0], load=1.0)
    sys.settrace(None)
print(*passed, sep="\\n")
"""


def test_a_call_passes_the_files_of_its_walk():
    """In a process of its own: where tests before have run, CPython 3.11 was seen not to
    come back from a traced call.
    """
    page = Path(__file__).parents[2] / "docs" / "structure.md"
    walk = page.read_text(encoding="utf-8").partition("`em.friction` of a ball")[2]
    rows = re.findall(r"^\| (`.*?) \|", walk.partition("\n\n`em.")[0], re.MULTILINE)
    named = re.findall(r"`(\w+/\w+\.py)`", " ".join(rows))
    done = subprocess.run(
        [sys.executable, "-c", FILES_OF_A_CALL],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert len(named) > 10
    passed = {*map(Path, done.stdout.splitlines())}
    assert not {SOURCE / name for name in named} - passed


def test_only_io_reads_files_of_others():
    """A fit takes measurements as data; what units and titles mean is known in `io`
    alone.
    """
    for path in files("fit"):
        for module in imports(path):
            assert module[:2] != ("elastomdr", "io") or module[2] == "data", (
                f"{path.name} imports {module}"
            )
        assert (
            "read_"
            not in path.read_text(encoding="utf-8")
            .partition("files import")[2]
            .partition("\n")[0]
        ), path


def test_figures_have_their_files():
    for path in files():
        if path.relative_to(SOURCE).as_posix() in (
            "results/plotting.py",
            "results/plot_contacts.py",
            "results/plot_curves.py",
            "fit/figures.py",
            "results/chart.py",
        ):
            continue
        assert not [module for module in imports(path) if module[0] == "matplotlib"], (
            path
        )


def test_a_result_never_solves():
    for path in files("results"):
        inside = {
            module[1]
            for module in imports(path)
            if module[0] == "elastomdr" and len(module) > 1
        }
        ground = {
            "errors",
            "files",
            "checks",
            "arrays",
            "linear_update",
            "notebook_tables",
            "trees",
            "units",
            "",
        }
        assert inside <= ground | {"results"}, f"{path.name} imports {inside}"


def test_results_import_no_jax():
    """Apart from what the ground imports."""
    for path in files("results"):
        tree = tree_of(path)
        at_import = [
            node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))
        ]
        names = {
            (node.module or "")
            if isinstance(node, ast.ImportFrom)
            else node.names[0].name
            for node in at_import
        }
        assert not {name.partition(".")[0] for name in names} & {
            "jax",
            "equinox",
            "diffrax",
            "jaxtyping",
            "matplotlib",
        }


def circle(paths: list[Path], types: bool = False) -> list[str]:
    """Files that import each other in a circle, and files that import those."""
    modules = {
        (*path.relative_to(SOURCE).with_suffix("").parts,): path for path in paths
    }
    needs = {}
    for home, path in modules.items():
        inside = {
            module[1:] for module in imports(path, types) if module[0] == "elastomdr"
        }
        needs[home] = {
            module for module in inside if module in modules and module != home
        }
    while ready := [
        home for home, inside in needs.items() if not inside & needs.keys()
    ]:
        for home in ready:
            del needs[home]
    return sorted("/".join(home) for home in needs)


@pytest.mark.parametrize("types", [False, True], ids=["as it runs", "types counted"])
def test_no_circle_of_imports(types):
    """Not inside a room either, nor where a function imports when it is called."""
    assert not circle(files(), types)
