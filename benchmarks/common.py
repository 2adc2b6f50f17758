"""What the benchmarks share: one core, the timing, printed tables, figures and JSON
under `results/`.
"""

import json
import os
import platform
import time
from collections.abc import Callable, Iterable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

RESULTS = Path(os.environ.get("BENCHMARK_RESULTS", Path(__file__).parent / "results"))
# then runs of a part are kept too (`robustness/all.py`)
IN_PARTS = "BENCHMARK_RESULTS" in os.environ


class Timed(NamedTuple):
    """What a call gave and took; `cpu` is what it would take on an idle core, however
    busy the machine is.
    """

    value: Any
    wall: float  # least of the repeats [s]
    cpu: float  # least of the repeats, all threads [s]


def one_core() -> None:
    """Keeps this process, and JAX if it has not computed yet, on one core where the
    system allows it.
    """
    os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false " + os.environ.get(
        "XLA_FLAGS", ""
    )
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def one_thread() -> None:
    """For processes still to be started, that share the cores: JAX and BLAS take one
    thread in each.
    """
    os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false " + os.environ.get(
        "XLA_FLAGS", ""
    )
    os.environ["OPENBLAS_NUM_THREADS"] = "1"


def timed(call: Callable[[], Any], repeats: int = 1) -> Timed:
    """The least wall-clock and processor time over the repeats."""
    walls, cpus, value = [], [], None
    for _ in range(repeats):
        wall, cpu = time.perf_counter(), time.process_time()
        value = call()
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    return Timed(value, min(walls), min(cpus))


def heading(title: str, *inputs: str) -> dict[str, Any]:
    """Prints the title, the inputs and the machine; returns them for the JSON file."""
    load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
    machine = (
        f"{platform.machine()}, {os.cpu_count()} cores, load average {load} at the "
        "start"
    )
    packages = ("elastomdr", "jax", "diffrax", "scipy", "numpy")
    versions = ", ".join(
        [
            f"Python {platform.python_version()}",
            *(f"{name} {version(name)}" for name in packages),
        ]
    )
    print(title)
    for line in (*inputs, machine, versions):
        print(f"  {line}")
    return {
        "title": title,
        "inputs": list(inputs),
        "machine": machine,
        "versions": versions,
    }


def table(
    columns: Sequence[str], rows: Iterable[Sequence[Any]]
) -> list[dict[str, Any]]:
    """Prints rows under their column names, units included; returns them as
    dictionaries.
    """
    rows = list(rows)
    cells = [[_cell(value) for value in row] for row in rows]
    widths = [
        max(len(column), *(len(row[i]) for row in cells))
        for i, column in enumerate(columns)
    ]
    print()
    for row in (columns, *cells):
        print(
            "  "
            + "  ".join(
                cell.ljust(width) for cell, width in zip(row, widths, strict=True)
            ).rstrip()
        )
    return [dict(zip(columns, row, strict=True)) for row in rows]


def verdict(
    name: str, measured: float, target: float, unit: str = "", *, least: bool = False
) -> dict[str, Any]:
    """Prints a measured figure beside its target: at most it, or at least it with
    `least`.
    """
    met = bool(measured >= target if least else measured <= target)
    bound = ">=" if least else "<="
    print(
        f"  {'met   ' if met else 'MISSED'}  {name}: {measured:.3g}{unit} (target "
        f"{bound} {target:g}{unit})"
    )
    return {
        "name": name,
        "measured": measured,
        "target": f"{bound} {target:g}{unit}",
        "met": met,
    }


def save(name: str, record: dict[str, Any], figure: Any = None) -> None:
    """Writes `results/NAME.json` and, with a figure, `results/NAME.png`; NAME may begin
    with a folder.
    """
    path = RESULTS / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(record, indent=1, default=_plain) + "\n")
    if figure is not None:
        figure.savefig(RESULTS / f"{name}.png", dpi=150)
        plt.close(figure)


def cached(
    name: str, inputs: dict[str, Any], compute: Callable[[], Any], fresh: bool
) -> Any:
    """`compute()` as kept in `results/NAME.json`, done anew where the inputs have
    changed or with `fresh`.
    """
    path = RESULTS / f"{name}.json"
    inputs = json.loads(json.dumps(inputs, default=_plain))
    kept = json.loads(path.read_text()) if path.exists() and not fresh else {}
    if kept.get("inputs") != inputs:
        print(f"computing {name}, which takes minutes ...", flush=True)
        kept = {
            "inputs": inputs,
            "values": json.loads(json.dumps(compute(), default=_plain)),
        }
        RESULTS.mkdir(exist_ok=True)
        path.write_text(json.dumps(kept, indent=1) + "\n")
    return kept["values"]


def _cell(value: Any) -> str:
    if isinstance(value, (float, np.floating)):
        return "-" if np.isnan(value) else f"{value:.3g}"
    return str(value)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    return str(value)
