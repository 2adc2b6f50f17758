"""Runs every benchmark, each in its own process, and records how long it took: `python
benchmarks/run_all.py`.

The stress tests, the coverage of fits and of hot friction and the damaged files run in
part here, and such a run is not recorded; run in full they are `robustness/stress.py`,
`robustness/stress_motion.py`, `fit_coverage.py`, `heat_coverage.py` and
`robustness/fuzz.py`. The half-space solutions of the validity map are kept from its own
run (`validity_map.py --fresh`, five minutes). With `--data DIR`, a folder of the
measured data, fits are compared with other tools too (`fit_peers.py`). Four long
scripts that measure no time are left out: `robustness/sliding_matrix.py`,
`fit_held_out.py`, `fit_relaxation.py`, `marched.py`. `fit_library.py` makes the library.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path

from common import heading, save, table, verdict

MINUTES = 20
SCRIPTS = (
    "steady_sliding",
    "sharp",
    "cold_start",
    "half_space",
    "validity_map",
    "validity_shapes",
    "validity_drawn",
    "robustness/extremes",
    "indentation",
    "creep_tamaas",
    "sliding_tamaas",
    "energy",
    "impacts",
    "transient",
    "rough_sliding",
    "rough_fit",
    "time_error",
    "budget",
    "rough_press",
    "leak_fit",
    "leak_surfaces",
    "lubricated",
    "robustness/rough_scenes",
    "topography",
    "fit_coverage --sets 50",
    "heat_coverage --scenes 50",
    "robustness/stress --scenes 100 --family paraboloid --family cone",
    "robustness/stress_motion --scenes 200 --family traction --family impact",
    "robustness/fuzz --files 500",
)


def main() -> int:
    parser = argparse.ArgumentParser(description="All benchmarks, one after the other.")
    parser.add_argument(
        "--data", type=Path, help="folder of the measured data, for fit_peers.py"
    )
    data = parser.parse_args().data
    record = heading("All benchmarks, one after the other", "stress tests in part")
    begin, rows = time.perf_counter(), []
    scripts = [script.split() for script in SCRIPTS] + (
        [["fit_peers", str(data.resolve())]] if data else []
    )
    for name, *options in scripts:
        print(f"\n== {' '.join([name, *options])} ==", flush=True)
        start = time.perf_counter()
        command = [sys.executable, str(Path(__file__).parent / f"{name}.py"), *options]
        status = subprocess.run(command).returncode
        rows.append(
            (name, time.perf_counter() - start, "ran" if status == 0 else "FAILED")
        )
    record["scripts"] = table(("script", "[s]", ""), rows)
    print()
    record["verdicts"] = [
        verdict("all benchmarks", (time.perf_counter() - begin) / 60, MINUTES, " min"),
        verdict("benchmarks that failed", sum(row[2] != "ran" for row in rows), 0),
    ]
    save("run_all", record)
    return 1 if any(row[2] != "ran" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
