"""Every search for wrong answers, one after the other: `python
benchmarks/robustness/all.py [--minutes M]`.

Without `--minutes` each is run whole, which takes over an hour on two cores. Its
figures go into `results/robustness/`, and a table of all records there into
`results/robustness/all.json`; `--only` repeats one, `--report` none. With `--minutes`
each gets its share (how many scenes, files and sweeps follows from what is left of the
time), and none is kept. The exit status is 1 if anything was wrong and not flagged,
crashed, or is not covered.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))
from common import RESULTS, heading, save, table, verdict

# Script, option that scales it, whole size, least size, seconds of a whole run: the
# newest code first.
PARTS = (
    ("stress_surfaces", "--scenes", 500, 50, 500),
    ("stress_layers", "--scenes", 200, 20, 300),
    ("stress_films", "--scenes", 40, 10, 200),
    ("stress_models", "--scenes", 200, 20, 1300),
    ("stress_motion", "--scenes", 2000, 100, 2200),
    ("sweeps_killed", "--sweeps", 20, 2, 300),
    ("fuzz", "--files", 5000, 300, 600),
    ("stress", "--scenes", 5000, 100, 1700),
    ("rough_scenes", "", 200, 10, 700),
    ("extremes", None, 0, 0, 60),
    ("sliding_matrix", None, 0, 0, 150),
)
START = 15  # s for a process, whatever its size


def main() -> int:
    options = argparse.ArgumentParser(description="Every search for wrong answers.")
    options.add_argument(
        "--minutes",
        type=float,
        default=None,
        help="about how long it may take; default: all whole",
    )
    options.add_argument("--seed", type=int, default=1)
    options.add_argument(
        "--only",
        action="append",
        choices=[part[0] for part in PARTS],
        help="default: all",
    )
    options.add_argument(
        "--report", action="store_true", help="sum up the records that there are"
    )
    chosen = options.parse_args()
    parts = [
        part
        for part in PARTS
        if not chosen.report and (not chosen.only or part[0] in chosen.only)
    ]
    complete = chosen.minutes is None
    wanted = (
        "the records"
        if chosen.report
        else "whole"
        if complete
        else f"in about {chosen.minutes:g} minutes"
    )
    record = heading(
        "Every search for wrong answers",
        wanted,
        *([f"seed {chosen.seed}"] if parts else []),
    )
    end, crashed = time.perf_counter() + 60 * (chosen.minutes or 0), []
    with tempfile.TemporaryDirectory() as other:
        place = RESULTS if complete else Path(other)
        for i, (name, option, whole, least, _) in enumerate(parts):
            size = whole
            if not complete and whole:
                fixed = sum(part[4] for part in parts[i:] if not part[2]) + START * len(
                    parts[i:]
                )
                scaled = sum(part[4] for part in parts[i:] if part[2])
                left = max(end - time.perf_counter() - fixed, 0.0) / scaled
                size = max(least, round(min(left, 1.0) * whole))
            command = [sys.executable, str(Path(__file__).parent / f"{name}.py")]
            command += (
                [] if option is None else [*([option] if option else []), str(size)]
            )
            if name.startswith("stress"):
                command += ["--fresh"]
            if name.startswith(("stress", "fuzz", "sweeps")):
                command += ["--seed", str(chosen.seed)]
            print(f"\n== {' '.join(command[1:])} ==", flush=True)
            (place / "robustness" / f"{name}.json").unlink(missing_ok=True)
            status = subprocess.run(
                command, env=os.environ | {"BENCHMARK_RESULTS": str(place)}
            ).returncode
            crashed += [name] if status else []
        names = [part[0] for part in (PARTS if complete else parts)]
        rows = [
            (name, *_missed(place / "robustness" / f"{name}.json")) for name in names
        ]
    record["parts"] = table(("search", "inputs", "missed"), rows)
    print()
    failed = {name for name, _, missed in rows if missed != "-"} | set(crashed)
    record["verdicts"] = [
        verdict(
            "searches with a verdict that is missed, or that failed", len(failed), 0
        )
    ]
    if complete:
        save("robustness/all", record)
    return 1 if failed else 0


def _missed(kept: Path) -> tuple[str, str]:
    """What a record was made of, and which of its verdicts are missed."""
    found = json.loads(kept.read_text()) if kept.exists() else {}
    verdicts = found.get("verdicts", found.get("figures", []))
    missed = [
        f"{one['name']}: {one['measured']:.3g} ({one['target']})"
        for one in verdicts
        if not one["met"]
    ]
    return "; ".join(found.get("inputs", [])[:1]), "; ".join(
        missed if verdicts else ["no record"]
    ) or "-"


if __name__ == "__main__":
    sys.exit(main())
