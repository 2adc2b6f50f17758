"""How long until the first figure? Import, help and the shipped scene, each from a cold process.

    python benchmarks/cold_start.py

The scene is run with every cache of the user empty (compiled code, and matplotlib's list of fonts), with only the cache
of compiled code empty, and with both filled. Times are the least of the repeats, memory is the largest.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from common import heading, plt, save, table, verdict

SCENE = Path(__file__).parents[1] / "examples" / "scenes" / "slider.toml"
IMPORT = """
import sys, time
start = time.perf_counter()
import elastomdr
print(time.perf_counter() - start, *sorted({"jax", "matplotlib"} & set(sys.modules)))
"""


class Process(NamedTuple):
    """What a process took and printed."""

    wall: float  # [s]
    memory: float  # peak resident memory [MB], at least that of this script; NaN where the system does not tell
    output: str


def run(command: list[str], repeats: int, **variables: str) -> Process:
    """The least time and the largest memory of a command over the repeats, with environment variables added."""
    environment = {k: v for k, v in os.environ.items() if k not in ("JAX_COMPILATION_CACHE_DIR", "MPLCONFIGDIR")}
    return _best([_once(command, environment | variables) for _ in range(repeats)])


def _best(runs: list[Process]) -> Process:
    return Process(min(r.wall for r in runs), max(r.memory for r in runs), runs[-1].output)


def _once(command: list[str], environment: dict[str, str]) -> Process:
    with tempfile.TemporaryFile("w+") as output:
        start = time.perf_counter()
        process = subprocess.Popen(command, env=environment, stdout=output, stderr=subprocess.STDOUT)
        memory = float("nan")
        if hasattr(os, "wait4"):
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            memory = usage.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
        wall = time.perf_counter() - start if process.wait() == 0 else float("nan")
        output.seek(0)
        text = output.read()
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)} failed with exit status {process.returncode}:\n{text}")
    return Process(wall, memory, text)


def scene_from_cold(repeats: int) -> dict[str, Process]:
    """`elastomdr friction slider.toml` with all caches empty, with the compiled-code cache empty, with both filled."""
    found: dict[str, list[Process]] = {"all caches empty": [], "compiled-code cache empty": [], "caches filled": []}
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            for name in found:
                if name == "compiled-code cache empty":
                    shutil.rmtree(Path(folder) / "elastomdr")
                command = [elastomdr(), "friction", str(SCENE), "--out", str(Path(folder) / "out")]
                found[name].append(run(command, 1, XDG_CACHE_HOME=folder, LOCALAPPDATA=folder))
    return {name: _best(runs) for name, runs in found.items()}


def elastomdr() -> str:
    """The installed command that belongs to this Python."""
    command = shutil.which("elastomdr", path=str(Path(sys.executable).parent)) or shutil.which("elastomdr")
    if command is None:
        raise SystemExit("the command elastomdr is not installed")
    return command


def main() -> None:
    record = heading("Cold start: from a new process to the answer", f"scene: examples/scenes/{SCENE.name}")
    bare = run([sys.executable, "-c", "pass"], 5)
    imports = [run([sys.executable, "-c", IMPORT], 1).output.split() for _ in range(7)]
    importing, loaded = min(float(words[0]) for words in imports), imports[-1][1:]
    usage = run([elastomdr(), "--help"], 7)
    scene = scene_from_cold(3)
    rows = [("python -c pass", bare.wall, float("nan")), ("elastomdr --help", usage.wall, float("nan"))]
    rows += [(f"elastomdr friction, {name}", found.wall, found.memory) for name, found in scene.items()]
    record["processes"] = table(("process", "wall [s]", "peak memory [MB]"), rows)
    print(f"\n  import elastomdr loads of jax and matplotlib: {' '.join(loaded) or 'neither'}")
    memory = max(found.memory for found in scene.values())
    record["loaded by import"] = loaded
    record["figures"] = [
        verdict("import elastomdr", importing, 0.3, " s"),
        verdict("elastomdr --help", usage.wall, 0.3, " s"),
        verdict("scene, compiled-code cache empty", scene["compiled-code cache empty"].wall, 12, " s"),
        verdict("scene, caches filled", scene["caches filled"].wall, 4, " s"),
        verdict("peak memory", memory, 700, " MB"),
    ]
    figure, ax = plt.subplots(figsize=(8, 3), layout="constrained")
    names = [row[0] for row in rows] + ["import elastomdr"]
    times = [row[1] for row in rows] + [importing]
    bars = ax.barh(names, times)
    targets = {"elastomdr --help": 0.3, "import elastomdr": 0.3}
    targets |= {"elastomdr friction, compiled-code cache empty": 12, "elastomdr friction, caches filled": 4}
    ax.plot(list(targets.values()), list(targets), "k|", ms=14, label="target")
    ax.bar_label(bars, fmt="%.2f s", label_type="center", color="w", fontsize=8)
    ax.set(xlabel="wall-clock time [s]", xscale="log", xlim=(None, 40), title="Cold start")
    ax.invert_yaxis()
    ax.legend()
    save("cold_start", record, figure)


if __name__ == "__main__":
    main()
