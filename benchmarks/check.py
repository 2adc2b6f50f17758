"""Has anything become slower or worse? Compares what `results/` records now with what
is committed.

    python benchmarks/run_all.py && python benchmarks/check.py [--against REVISION]

Every benchmark records `verdicts` (or `figures`): a name, a measured figure and its
target, at least or at most. A ratio, of which more is better, has fallen if it lost
more than a third against the revision (default: HEAD). A time has if it grew by half,
within its target too, by more than comes and goes; compare on one machine. An error, of
which less is better too, has if it grew by half and is beyond its target: errors at
rounding move by themselves.
Exit status 1 if any has, or if a figure or a whole record is gone.
"""

import argparse
import json
import math
import subprocess
import sys
from typing import Any

from common import RESULTS, table

THIRD = 1 / 3
# seconds of processor time that come and go on a machine with others, by what a figure
# of the budget is: below these a time may double
NOISE = {"first": 0.03, "curve": 0.03, "gradient": 0.03, "warm": 0.001}


TIMES = (" s", " ms", " min", " s of processor")


def figures(record: Any) -> dict[str, tuple[float, bool, bool]]:
    """Name to (measured, whether more is better, whether it may grow: its target is
    met, and it is no time). A list of points has none.
    """
    if isinstance(record, list):
        return {}
    entries = [
        e
        for key in ("verdicts", "figures")
        for e in record.get(key) or ()
        if isinstance(e, dict)
    ]
    return {
        e["name"]: (
            float(e["measured"]),
            e["target"].startswith(">="),
            bool(e["met"]) and not _is_time(e["target"]),
        )
        for e in entries
        if "target" in e
    }


def _is_time(target: str) -> bool:
    return target.lstrip("<>= ").lstrip("0123456789.e+-") in TIMES


def recorded(name: str, revision: str) -> dict[str, Any]:
    """A result as it was committed, or an empty record."""
    command = ["git", "show", f"{revision}:./{name}"]
    shown = subprocess.run(
        command, cwd=RESULTS, capture_output=True, text=True, check=False
    )
    return json.loads(shown.stdout) if shown.returncode == 0 else {}


def committed(revision: str) -> set[str]:
    """Names of the records of a revision."""
    command = ["git", "ls-tree", "-r", "--name-only", revision, "./"]
    shown = subprocess.run(
        command, cwd=RESULTS, capture_output=True, text=True, check=True
    )
    return {name for name in shown.stdout.split("\n") if name.endswith(".json")}


def main() -> int:
    options = argparse.ArgumentParser(
        description="Benchmark results against those of a revision."
    )
    options.add_argument("--against", default="HEAD")
    options.add_argument("--only", default="", help="records with this word alone")
    given = options.parse_args()
    revision = given.against
    rows, compared = [], 0
    present = {path.relative_to(RESULTS).as_posix() for path in RESULTS.rglob("*.json")}
    for file in sorted(present | committed(revision)):
        if given.only not in file:
            continue
        benchmark = file.removesuffix(".json")
        before = figures(recorded(file, revision))
        now = (
            figures(json.loads((RESULTS / file).read_text())) if file in present else {}
        )
        if file not in present:
            rows.append((benchmark, "the record", float("nan"), float("nan"), "gone"))
        for name, (old, more, _) in before.items():
            compared += 1
            if name not in now:
                rows.append((benchmark, name, old, float("nan"), "gone"))
                continue
            new, _, may_grow = now[name]
            noise = 0.0 if more else NOISE.get(name.rpartition(", ")[2], 0.0)
            bad = (
                new < old - THIRD * abs(old)
                if more
                else new > 1.5 * old and new > old + min(noise, old) and not may_grow
            )
            if bad or (math.isnan(new) and not math.isnan(old)):
                rows.append((benchmark, name, old, new, "fallen"))
    fallen = len(rows)
    if rows:
        table(("benchmark", "figure", "recorded", "now", ""), rows)
    print(
        f"\n{compared} recorded figures, {fallen} fallen by more than a third or gone"
    )
    return 1 if fallen else 0


if __name__ == "__main__":
    sys.exit(main())
