"""`em.sweep` against the plain calls it consists of: cost of the machinery, gain of a
second worker; draws.

    python benchmarks/sweep.py
    # 100,000 points, three rounds: two minutes on an idle machine
    python benchmarks/sweep.py --million
    # 1e6 points on two workers, minutes and memory: another two

Multiscale friction of so many materials on 10 roads, at 4 pressures, 5 temperatures and
50 velocities. The plain calls are one per material and road, on arrays of the same
1,000 points, without anything written. Rounds take plain calls, one worker and two
workers in turn. Cost is processor time of all processes of a sweep, with scheduler and
the process that writes, over that of the plain calls; the gain of a second worker is of
wall time, so it needs an idle machine.
"""

import argparse
import contextlib
import os
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import psutil
from common import heading, one_thread, save, table, verdict
from distributed import Client, LocalCluster

import elastomdr as em


def rubber(rng: np.random.Generator, number: int) -> em.Prony:
    times = np.logspace(-9, 3, 13)
    moduli = 10 ** (
        6 + 0.2 * np.log10(times.max() / times) + 0.1 * rng.standard_normal(times.size)
    )
    return em.Prony(
        1e6, moduli, times, shift=em.WLF(8.9, 101.6, 293.15), name=f"rubber {number}"
    )


def scene(materials: int) -> tuple[dict, dict]:
    rng = np.random.default_rng(1)
    objects = {
        "material": [rubber(rng, k) for k in range(materials)],
        "surface": [
            em.SelfAffine(0.7 + 0.02 * k, q_low=1e3, q_high=1e6, rms_slope=1.0)
            for k in range(10)
        ],
    }
    arrays = {
        "pressure": np.linspace(1e5, 4e5, 4),
        "temperature": 273.15 + np.linspace(0, 60, 5),
    }
    return objects, arrays | {"velocity": np.logspace(-4, 1, 50)}


def plain(objects: dict, arrays: dict) -> float:
    """Processor seconds of the calls alone."""
    began = time.process_time()
    pressure, temperature, velocity = np.ix_(*arrays.values())
    for material in objects["material"]:
        for surface in objects["surface"]:
            em.friction(
                material,
                surface,
                pressure=pressure,
                temperature=temperature,
                velocity=velocity,
            )
    return time.process_time() - began


class Cluster:
    """Workers that have made their first call, and the processor time of everything
    that a sweep on them takes.
    """

    def __init__(
        self,
        client: Client,
        workers: int,
        processes: list[psutil.Process],
        objects: dict,
        arrays: dict,
    ):
        self.client, self._processes = client, processes
        first = {name: values[:1] for name, values in objects.items()}
        for _ in range(2 * workers):
            self.swept(first, arrays)

    def _seconds(self) -> float:
        return sum(sum(process.cpu_times()[:2]) for process in self._processes)

    def swept(self, objects: dict, arrays: dict) -> tuple[float, float]:
        """Wall and processor seconds of a sweep."""
        with tempfile.TemporaryDirectory() as folder:
            wall, cpu = time.perf_counter(), self._seconds()
            em.sweep(
                em.friction,
                objects | arrays,
                store=Path(folder) / "s.zarr",
                client=self.client,
                progress=False,
            )
            return time.perf_counter() - wall, self._seconds() - cpu

    def memory(self) -> float:
        """The most that a worker has taken [GB]."""

        def peak() -> float:
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6

        return max(self.client.run(peak).values())


@contextlib.contextmanager
def cluster(workers: int, objects: dict, arrays: dict) -> Iterator[Cluster]:
    me = psutil.Process()
    before = set(me.children(recursive=True))
    started = LocalCluster(n_workers=workers, threads_per_worker=1)
    with started, Client(started) as client:
        own = [
            process for process in me.children(recursive=True) if process not in before
        ]
        yield Cluster(client, workers, [me, *own], objects, arrays)


def drawn() -> float:
    """Processor seconds of 1000 draws of a ball's friction curve."""
    draws, velocity = (
        em.load_material("epdm-70").draws(1000),
        np.geomspace(1e-4, 10, 64),
    )
    ball = {"velocity": velocity, "load": 1.0, "temperature": 293.15}
    em.friction(draws[0], em.Sphere(5e-3), **ball)
    began = time.process_time()
    curve = em.friction(draws, em.Sphere(5e-3), **ball)
    assert curve.converged.all()
    return time.process_time() - began


def rounds(count: int, materials: int) -> None:
    objects, arrays = scene(materials)
    points = 10_000 * materials
    record = heading(
        "Sweep of friction by Multiscale", f"{points} points, {count} rounds"
    )
    rows = []
    with cluster(1, objects, arrays) as alone, cluster(2, objects, arrays) as both:
        for _ in range(count):
            calls, (one, one_cpu), (two, two_cpu) = (
                plain(objects, arrays),
                *(each.swept(objects, arrays) for each in (alone, both)),
            )
            rows.append([calls, one_cpu, two_cpu, one, two])
    record["seconds"] = table(
        [
            "plain calls, processor [s]",
            "one worker, processor [s]",
            "two workers, processor [s]",
            "one worker, wall [s]",
            "two workers, wall [s]",
        ],
        rows,
    )
    calls, one_cpu, _, one, two = np.array(rows).T
    print()
    record["verdicts"] = [
        verdict(
            "one worker beside plain calls",
            100 * float(np.median(one_cpu / calls) - 1),
            10,
            " %",
        ),
        verdict("two workers over one", float(np.median(one / two)), 1.8, least=True),
        verdict(
            "1000 draws of a ball's friction curve of 64 velocities",
            drawn(),
            10,
            " s of processor",
        ),
    ]
    save("sweep", record)


def million() -> None:
    objects, arrays = scene(100)
    record = heading("Sweep of friction by Multiscale", "1000000 points on two workers")
    with cluster(2, objects, arrays) as both:
        wall, cpu = both.swept(objects, arrays)
        memory = both.memory()
    record["seconds"] = table(["wall [s]", "processor [s]"], [[wall, cpu]])
    print()
    record["verdicts"] = [
        verdict("1e6 points on two workers", wall / 60, 15, " min"),
        verdict("1e6 points, all processes", cpu, 1800, " s of processor"),
        verdict("memory of a worker", memory, 2, " GB"),
    ]
    save("sweep_million", record)


def main() -> None:
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":  # read when numpy is imported
        one_thread()
        os.execv(sys.executable, [sys.executable, *sys.argv])
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--materials", type=int, default=10)
    parser.add_argument(
        "--million", action="store_true", help="1e6 points on two workers instead"
    )
    options = parser.parse_args()
    if options.million:
        million()
    else:
        rounds(options.rounds, options.materials)


if __name__ == "__main__":
    main()
