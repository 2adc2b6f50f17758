"""Which wrong signs, factors and comparisons does no test notice? Changes drawn from a
seed.

    python benchmarks/robustness/mutations.py --seed 1 --count 60    # an hour or two on one core
    python benchmarks/robustness/mutations.py --seed 1 --count 60 --only tyre/brush.py

Each mutation changes one operator, comparison, number or sign in a copy of the source.
The test files that concern the module run over it: half of them those that mention its
name most often, the others those with the fewest imports between what they import, or
take from `em`, and the module. A mutation survives where they all pass; another test
file may still notice it. Those that survive are printed once more at the end. Each is a
missing test, or code that changes nothing, or a change without a meaning (of a
tolerance, say).
"""

import argparse
import ast
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import elastomdr as em

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"
PACKAGE = SOURCE / "elastomdr"
OPERATORS = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.Pow: ("**", "*"),
    ast.Lt: ("<", ">="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", "<="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
}


class Mutation(NamedTuple):
    """One place of a line, and what is written there instead."""

    file: Path
    line: int  # from 1
    begin: int  # bytes of the line
    end: int
    new: str

    def written(self) -> tuple[str, str]:
        """The line as it is and as it would be."""
        lines = self.file.read_text(encoding="utf-8").splitlines()
        old = lines[self.line - 1].encode()
        return old.decode(), (
            old[: self.begin] + self.new.encode() + old[self.end :]
        ).decode()


def mutations(file: Path) -> list[Mutation]:
    """All places of a file that can be changed."""
    text = file.read_text(encoding="utf-8")
    lines = text.encode().splitlines()
    return [m for node in nodes(ast.parse(text)) for m in changes(file, lines, node)]


def nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """All nodes but those of annotations and of texts, whose numbers are format
    widths.
    """
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not isinstance(child, ast.JoinedStr):
                yield child
                yield from nodes(child)


def changes(file: Path, lines: list[bytes], node: ast.AST) -> Iterator[Mutation]:
    """The one change of a node, if it has any."""
    match node:
        case ast.BinOp(left=left, op=operator, right=right):
            yield from between(file, lines, left, operator, right)
        case ast.Compare(left=left, ops=[operator], comparators=[right]):
            yield from between(file, lines, left, operator, right)
        case ast.UnaryOp(op=ast.USub()):
            yield Mutation(file, node.lineno, node.col_offset, node.col_offset + 1, "")
        case ast.Constant(value=int() | float() as number) if not isinstance(
            number, bool
        ):
            new = repr(2 * number if number else 1)
            yield Mutation(file, node.lineno, node.col_offset, node.end_col_offset, new)


def between(
    file: Path, lines: list[bytes], left: ast.expr, operator: ast.AST, right: ast.expr
) -> Iterator[Mutation]:
    """Another operator between two operands, where all three stand on one line."""
    if type(operator) not in OPERATORS or left.end_lineno != right.lineno:
        return
    old, new = OPERATORS[type(operator)]
    gap = lines[right.lineno - 1][left.end_col_offset : right.col_offset]
    begin = left.end_col_offset + gap.index(old.encode())
    yield Mutation(file, right.lineno, begin, begin + len(old), new)


def imported(file: Path) -> Counter[str]:
    """How often a file imports a module of the package, or takes something of it from
    `em`.
    """
    text = file.read_text(encoding="utf-8")
    inside = file.is_relative_to(PACKAGE)
    package = ["elastomdr", *file.relative_to(PACKAGE).parts[:-1]] if inside else []
    names: Counter[str] = Counter()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            above = package[: len(package) + 1 - node.level] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            names.update([module, *(f"{module}.{alias.name}" for alias in node.names)])
    for first, second in re.findall(r"\bem\.(\w+)(?:\.(\w+))?", text):
        value = getattr(em, first, None)
        value = getattr(value, second, value) if second else value
        names[getattr(value, "__module__", None) or ""] += 1
    return Counter(
        {name: count for name, count in names.items() if name.startswith("elastomdr.")}
    )


def module_of(file: Path) -> str:
    """Dotted name of a file of the package."""
    return ".".join(file.relative_to(SOURCE).with_suffix("").parts).removesuffix(
        ".__init__"
    )


def concerned(
    module: str, users: dict[str, set[str]], tests: dict[str, Counter[str]], most: int
) -> list[str]:
    """The test files that concern a module, those that mention its name first."""
    word = module.rpartition(".")[2]
    texts = {test: test + (ROOT / test).read_text(encoding="utf-8") for test in tests}
    mentions = {test: text.count(word) for test, text in texts.items()}
    named = [
        test
        for test in sorted(tests, key=lambda test: -mentions[test])
        if mentions[test]
    ]
    named = named[: most // 2]
    steps = distances(module, users)
    ranks = {}
    for test, names in tests.items():
        least = min((steps[name] for name in names if name in steps), default=None)
        if least is not None:
            nearest = sum(
                count for name, count in names.items() if steps.get(name) == least
            )
            ranks[test] = (least, -nearest / names.total())
    near = [
        test
        for test in sorted(ranks, key=lambda test: ranks[test])
        if test not in named
    ]
    return named + near[: most - len(named)]


def distances(module: str, users: dict[str, set[str]]) -> dict[str, int]:
    """The number of imports between each module that depends on this one, and this
    one.
    """
    steps, front, step = {module: 0}, {module}, 0
    while front:
        step += 1
        front = {user for name in front for user in users.get(name, ())} - steps.keys()
        steps |= dict.fromkeys(front, step)
    return steps


def pytest(
    source: Path, tests: list[str], limit: float
) -> subprocess.CompletedProcess[str]:
    """Tests over a copy of the source, up to the first that fails."""
    return subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-x",
            "-q",
            "--no-header",
            "-p",
            "no:cacheprovider",
            *tests,
        ],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(source)},
        capture_output=True,
        text=True,
        timeout=limit,
        check=False,
    )


def outcome(mutation: Mutation, tests: list[str], limit: float) -> tuple[str, str]:
    """ "caught", "survived" or "not judged", and by which test or why."""
    if not tests:
        return "survived", "no test file concerns it"
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "src"
        shutil.copytree(SOURCE, source, ignore=shutil.ignore_patterns("__pycache__"))
        # the library of materials and the docs are found beside the source
        for each in ROOT.iterdir():
            if each != SOURCE and not each.name.startswith("."):
                (Path(folder) / each.name).symlink_to(each)
        copy = source / mutation.file.relative_to(SOURCE)
        lines = copy.read_text(encoding="utf-8").splitlines()
        lines[mutation.line - 1] = mutation.written()[1]
        copy.write_text("\n".join(lines) + "\n", encoding="utf-8")
        try:
            run = pytest(source, tests, limit)
        except subprocess.TimeoutExpired:
            return "not judged", f"no end within {limit:g} s"
    if run.returncode == 0:
        return "survived", ""
    failed = re.search(
        r"^(?:FAILED|ERROR) (tests/.+?)(?: - |$)", run.stdout, re.MULTILINE
    )
    if failed is None:
        return "caught", "the tests cannot start"
    try:
        anyway = pytest(SOURCE, [failed[1]], limit).returncode != 0
    except subprocess.TimeoutExpired:
        return "not judged", f"{failed[1]}: no end within {limit:g} s without it"
    return (
        ("not judged", f"{failed[1]} fails without it")
        if anyway
        else ("caught", failed[1])
    )


def main() -> None:
    as_written = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=as_written)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=60, help="how many mutations")
    parser.add_argument(
        "--only", default="", help="only files whose path contains this"
    )
    parser.add_argument("--files", type=int, default=6, help="most test files for each")
    parser.add_argument(
        "--limit", type=float, default=300.0, help="of one run of tests [s]"
    )
    options = parser.parse_args()
    sources = sorted(PACKAGE.rglob("*.py"))
    users: dict[str, set[str]] = {}
    for file in sources:
        for name in imported(file):
            users.setdefault(name, set()).add(module_of(file))
    files = sorted((ROOT / "tests").rglob("test_*.py"))
    tests = {str(file.relative_to(ROOT)): imported(file) for file in files}
    chosen = [
        file for file in sources if options.only in str(file.relative_to(PACKAGE))
    ]
    places = [mutation for file in chosen for mutation in mutations(file)]
    drawn = random.Random(options.seed).sample(places, min(options.count, len(places)))
    outcomes, unnoticed = Counter[str](), []
    for mutation in drawn:
        begin = time.perf_counter()
        concern = concerned(module_of(mutation.file), users, tests, options.files)
        word, why = outcome(mutation, concern, options.limit)
        place = f"{mutation.file.relative_to(PACKAGE)}:{mutation.line}"
        print(
            f"{word:10} {time.perf_counter() - begin:4.0f} s  {place}  {why}",
            flush=True,
        )
        outcomes[word] += 1
        if word != "caught":
            old, new = mutation.written()
            unnoticed.append(
                f"{word}: {place}  {why}\n  - {old.strip()}\n  + {new.strip()}"
            )
    print("", *unnoticed, sep="\n")
    sums = ", ".join(f"{number} {word}" for word, number in outcomes.items())
    print(f"\nseed {options.seed}: of {len(drawn)} mutations {sums}")


if __name__ == "__main__":
    main()
