"""What ten million points of `em.sweep` take on a cluster, planned from measured rates.

    python benchmarks/sweep_plan.py     # two minutes

Rates and sizes are those of small sweeps in one process, second call; the number of
chunks of ten million points is that of the package. What a chunk of 10,000 points costs
the process that writes is measured on a folder, and on a bucket of a local server, in a
process of its own, that answers each request after 30 ms.
"""

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from common import heading, one_thread, save, table
from sweep import scene

import elastomdr as em
from elastomdr.sweeps import grid, run

POINTS = 10_000_000
CORES = 100
TESTS = Path(__file__).parents[1] / "tests" / "sweeps"
SERVER = f"""
import sys, time
sys.path.insert(0, {str(TESTS)!r})
from s3_server import Server
with Server(0.03) as server:
    print(server.url, flush=True)
    time.sleep(3600)
"""
OBJECTS, ARRAYS = scene(1)  # a compound and ten roads; pressures, temperatures, ...
RUBBER, ROAD = OBJECTS["material"][0], OBJECTS["surface"][0]
VELOCITY = np.geomspace(1e-4, 10, 1000)


def scenes() -> dict[str, tuple[Callable, dict, dict]]:
    """The call, its axes and its other arguments, by name."""
    x = np.linspace(0, 0.02, 1024, endpoint=False)
    line = em.RoughLine(x, 1e-5 * np.sin(2 * np.pi * x / 0.002))
    layer, roller = em.layer(RUBBER, 2e-3), em.Cylinder(0.05, 0.1)
    ball = {"material": RUBBER, "shape": em.Sphere(0.005)}
    road = {"material": RUBBER, "surface": ROAD}
    on_line = {"material": RUBBER, "surface": line, "load": 100.0}
    thrown = {"material": RUBBER, "shape": em.Paraboloid(0.005), "mass": 1e-3}
    return {
        "road, `Multiscale`": (em.friction, ARRAYS, road),
        "road, `Persson`": (em.friction, ARRAYS, road | {"model": "persson"}),
        "ball that slides": (
            em.friction,
            {"velocity": VELOCITY},
            ball | {"load": 10.0},
        ),
        "roller on a layer": (
            em.rolling,
            {"velocity": VELOCITY[::5]},
            {"material": layer, "shape": roller, "load": 1e4},
        ),
        "rough line, 1,024 samples": (
            em.friction,
            {"velocity": VELOCITY[::5]},
            on_line,
        ),
        "impact": (em.impact, {"velocity": np.linspace(0.5, 2, 1000)}, thrown),
    }


def planned(name: str, call: Callable, axes: dict, fixed: dict) -> list:
    """A row of the table of scenes."""
    asked = grid.grid(call, axes, fixed)
    (chunk,) = asked.chunks()
    points = int(np.prod(asked.shape))
    run.compute(asked, chunk)
    began = time.process_time()
    run.compute(asked, chunk)
    rate = points / (time.process_time() - began)
    with tempfile.TemporaryDirectory() as folder:
        dataset = em.sweep(call, axes, store=folder, progress=False, **fixed)
        values = Path(folder).glob("*/[0-9]*")
        size = sum(file.stat().st_size for file in values) / points
    many = {
        "material": [fixed["material"]] * (POINTS // 1000),
        "velocity": np.ones(1000),
    }
    others = {key: value for key, value in fixed.items() if key != "material"}
    chunks = len(grid.grid(call, many, others).chunks())
    hours = POINTS / rate / 3600
    files = chunks * (len(dataset.data_vars) + 1)
    return [name, rate, hours, 60 * hours / CORES, chunks, files, size * POINTS / 1e9]


@contextlib.contextmanager
def bucket() -> Iterator[str]:
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER], stdout=subprocess.PIPE, text=True
    )
    try:
        assert server.stdout
        os.environ |= {
            "AWS_ENDPOINT_URL": server.stdout.readline().strip(),
            "AWS_ACCESS_KEY_ID": "user",
            "AWS_SECRET_ACCESS_KEY": "secret",
            "AWS_DEFAULT_REGION": "us-east-1",
        }
        yield "s3://bucket/plan"
    finally:
        server.kill()
        server.wait()


def written(name: str, place: str) -> list:
    """A row of the table of stores: sweeps of which nothing has to be computed."""
    velocity = np.resize(VELOCITY, 10_000) * np.linspace(1, 2, 10_000)
    fixed = {"surface": ROAD, "pressure": 2e5}
    asked = grid.grid(em.friction, {"material": [RUBBER], "velocity": velocity}, fixed)
    compute, computed = run.compute, run.compute(asked, asked.chunks()[0])
    run.compute = lambda *chunk: computed
    used = []
    for count in (1, 10, 60):  # the first of all to warm up
        wall, processor = time.perf_counter(), time.process_time()
        for _ in range(2):  # the second time all is there and is checked
            axes = {"material": [RUBBER] * count, "velocity": velocity}
            em.sweep(
                em.friction,
                axes,
                store=f"{place}/{count}",
                progress=False,
                **fixed,
            )
            used += [time.perf_counter() - wall, time.process_time() - processor]
            wall, processor = time.perf_counter(), time.process_time()
    run.compute = compute
    few, many = np.array(used[4:]).reshape(2, 2, 2)
    each = (many - few) / 50
    return [name, few[0, 0] - 10 * each[0, 0], *(1e3 * each).ravel()]


def main() -> None:
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":  # read when numpy is imported
        one_thread()
        os.execv(sys.executable, [sys.executable, *sys.argv])
    record = heading("Ten million points", f"{CORES} cores")
    run._cores = lambda: 1
    record["scenes"] = table(
        [
            "scene",
            "points/s of a core",
            "core hours",
            f"minutes on {CORES} cores",
            "chunks",
            "files",
            "GB",
        ],
        [planned(name, *scene) for name, scene in scenes().items()],
    )
    with tempfile.TemporaryDirectory() as folder:
        rows = [written("folder", folder)]
    with bucket() as url:
        rows.append(written("bucket", url))
    record["stores"] = table(
        [
            "store",
            "to begin and end [s]",
            "to write a chunk [ms]",
            "of processor [ms]",
            "to check a chunk [ms]",
            "of processor [ms] ",
        ],
        rows,
    )
    save("sweep_plan", record)


if __name__ == "__main__":
    main()
