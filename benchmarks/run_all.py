"""Runs every benchmark, each in its own process, and says how long it took: `python benchmarks/run_all.py`."""

import subprocess
import sys
import time
from pathlib import Path

SCRIPTS = (
    "steady_sliding", "skipping", "cold_start", "half_space", "validity_map", "extremes", "indentation",
    "creep_tamaas", "sliding_tamaas", "energy", "impacts", "transient", "rough_sliding", "rough_map", "rough_scenes",
    "fit_coverage", "stress", "fuzz",
)  # fmt: skip


def main() -> int:
    begin, took, failed = time.perf_counter(), {}, []
    for name in SCRIPTS:
        print(f"\n== {name} ==", flush=True)
        start = time.perf_counter()
        if subprocess.run([sys.executable, Path(__file__).with_name(f"{name}.py")]).returncode != 0:
            failed.append(name)
        took[name] = time.perf_counter() - start
    print("\n" + ", ".join(f"{name} {seconds:.0f} s" for name, seconds in took.items()))
    print(f"total {time.perf_counter() - begin:.0f} s; " + (f"FAILED: {', '.join(failed)}" if failed else "all ran"))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
