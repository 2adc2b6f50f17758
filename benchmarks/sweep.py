"""`em.sweep` against the plain calls it consists of: cost of the machinery, gain of a second worker, memory.

    python benchmarks/sweep.py [--materials 100]

Multiscale friction of so many materials on 10 roads, at 4 pressures, 5 temperatures and 50 velocities: 1e6 points by
default. The plain calls are one per material and road, on arrays of 1,000 points, without anything written.
"""

import argparse
import resource
import tempfile
import time
from pathlib import Path

import numpy as np
from common import heading, one_thread, save, table, verdict

import elastomdr as em
from elastomdr.sweeps import run


def rubber(rng: np.random.Generator, number: int) -> em.Prony:
    times = np.logspace(-9, 3, 13)
    moduli = 10 ** (6 + 0.2 * np.log10(times.max() / times) + 0.1 * rng.standard_normal(times.size))
    return em.Prony(1e6, moduli, times, shift=em.WLF(8.9, 101.6, 293.15), name=f"rubber {number}")


def scene(materials: int) -> tuple[dict, dict]:
    rng = np.random.default_rng(1)
    objects = {
        "material": [rubber(rng, k) for k in range(materials)],
        "surface": [em.SelfAffine(0.7 + 0.02 * k, q_low=1e3, q_high=1e6, rms_slope=1.0) for k in range(10)],
    }
    arrays = {"pressure": np.linspace(1e5, 4e5, 4), "temperature": 273.15 + np.linspace(0, 60, 5)}
    return objects, arrays | {"velocity": np.logspace(-4, 1, 50)}


def plain(objects: dict, arrays: dict) -> float:
    """Seconds of the calls alone."""
    began = time.perf_counter()
    pressure, temperature, velocity = np.ix_(*arrays.values())
    for material in objects["material"]:
        for surface in objects["surface"]:
            em.friction(material, surface, pressure=pressure, temperature=temperature, velocity=velocity)
    return time.perf_counter() - began


def swept(objects: dict, arrays: dict, workers: int) -> tuple[float, float]:
    """Seconds of a sweep once its workers are there, and the largest memory of a worker [MB]."""
    from distributed import Client

    def peak() -> float:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    with tempfile.TemporaryDirectory() as folder, run._cluster(workers) as cluster, Client(cluster) as client:
        client.wait_for_workers(workers)
        client.run(
            em.friction, objects["material"][0], objects["surface"][0], pressure=3e5, temperature=300.0, velocity=1
        )
        began = time.perf_counter()
        em.sweep(em.friction, objects | arrays, store=Path(folder) / "s.zarr", client=client)
        return time.perf_counter() - began, max(client.run(peak).values())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--materials", type=int, default=100)
    options = parser.parse_args()
    one_thread()
    objects, arrays = scene(options.materials)
    few = objects | {"material": objects["material"][: max(2, options.materials // 10)]}
    record = heading("Sweep of friction by Multiscale", f"{10_000 * options.materials} points")
    calls, (one, _), (both, _) = plain(few, arrays), swept(few, arrays, 1), swept(few, arrays, 2)
    whole, memory = swept(objects, arrays, 2)
    record["seconds"] = table(
        ["points", "plain calls [s]", "one worker [s]", "two workers [s]"],
        [[10_000 * len(few["material"]), calls, one, both], [10_000 * options.materials, np.nan, np.nan, whole]],
    )
    print()
    record["verdicts"] = [
        verdict("all points on two workers", whole / 60, 15, " min"),
        verdict("memory of a worker", memory / 1000, 2, " GB"),
        verdict("one worker beside plain calls", 100 * (one / calls - 1), 10, " %"),
        verdict("two workers over one", one / both, 1.8, least=True),
    ]
    save("sweep", record)


if __name__ == "__main__":
    main()
