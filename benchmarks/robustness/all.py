"""Every search for wrong answers, one after the other: `python benchmarks/robustness/all.py [--minutes M]`.

Without `--minutes` each is run whole, which takes two hours on two cores. Its figures go into `results/robustness/`,
and a table of all into `results/robustness/all.json`; `--only` repeats one there and leaves the others. With `--minutes`
each gets its share (how many scenes, files and sweeps follows from what is left of the time), and none is kept.
The exit status is 1 if anything was wrong and not flagged, crashed, or is not covered.
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

# Script, option that scales it, whole size, least size, seconds of a whole run: the newest code first.
PARTS = (
    ("stress_surfaces", "--scenes", 500, 50, 500),
    ("stress_layers", "--scenes", 200, 20, 300),
    ("stress_models", "--scenes", 200, 20, 1300),
    ("stress_motion", "--scenes", 2000, 100, 2200),
    ("sweeps_killed", "--sweeps", 20, 2, 300),
    ("fuzz", "--files", 5000, 300, 600),
    ("stress", "--scenes", 5000, 100, 1700),
    ("rough_scenes", "", 200, 10, 400),
    ("extremes", None, 0, 0, 60),
    ("sliding_matrix", None, 0, 0, 150),
)
START = 15  # s for a process, whatever its size


def main() -> int:
    options = argparse.ArgumentParser(description="Every search for wrong answers.")
    options.add_argument("--minutes", type=float, default=None, help="about how long it may take; default: all whole")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--only", action="append", choices=[part[0] for part in PARTS], help="default: all")
    chosen = options.parse_args()
    parts = [part for part in PARTS if not chosen.only or part[0] in chosen.only]
    kept, complete = RESULTS / "robustness" / "all.json", chosen.minutes is None
    wanted = "whole" if complete else f"in about {chosen.minutes:g} minutes"
    record = heading("Every search for wrong answers", wanted, f"seed {chosen.seed}")
    before = json.loads(kept.read_text()) if chosen.only and complete and kept.exists() else {}
    rows = {row["search"]: row for row in before.get("parts", [])}
    end = time.perf_counter() + 60 * (chosen.minutes or 0)
    with tempfile.TemporaryDirectory() as other:
        place = RESULTS if complete else Path(other)
        for i, (name, option, whole, least, _) in enumerate(parts):
            size = whole
            if not complete and whole:
                fixed = sum(part[4] for part in parts[i:] if not part[2]) + START * len(parts[i:])
                scaled = sum(part[4] for part in parts[i:] if part[2])
                left = max(end - time.perf_counter() - fixed, 0.0) / scaled
                size = max(least, round(min(left, 1.0) * whole))
            command = [sys.executable, str(Path(__file__).parent / f"{name}.py")]
            command += [] if option is None else [*([option] if option else []), str(size)]
            if name.startswith("stress"):
                command += ["--fresh"]
            if name.startswith(("stress", "fuzz", "sweeps")):
                command += ["--seed", str(chosen.seed)]
            print(f"\n== {' '.join(command[1:])} ==", flush=True)
            result = place / "robustness" / f"{name}.json"
            result.unlink(missing_ok=True)
            begin = time.perf_counter()
            status = subprocess.run(command, env=os.environ | {"BENCHMARK_RESULTS": str(place)}).returncode
            found = json.loads(result.read_text()) if result.exists() else {}
            verdicts = found.get("verdicts", found.get("figures", []))
            missed = [one["name"] for one in verdicts if not one["met"]] if verdicts else ["no verdict"]
            rows[name] = {
                "search": name, "size": size or "whole", "seed": chosen.seed, "[s]": time.perf_counter() - begin,
                "status": status, "missed": "; ".join(missed) or "-",
            }  # fmt: skip
            if complete:
                save("robustness/all", record | {"parts": list(rows.values())})
    record["parts"] = table(list(rows[parts[0][0]]), [list(row.values()) for row in rows.values()])
    print()
    failed = [name for name, row in rows.items() if row["status"] or row["missed"] != "-"]
    record["verdicts"] = [verdict("searches with a verdict that is missed, or that failed", len(failed), 0)]
    if complete:
        save("robustness/all", record)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
