"""Steady sliding on a rough line: time against the targets and against a C loop, and
what cores give.

    python benchmarks/rough_sliding.py

64 velocities x 16384 samples x 20 branches over 14 decades of relaxation time, a load
given. The C loop (`cc -O3 -march=native`) does one plain sweep of the same samples,
velocities and branches, with nothing but the contact step, on one core. Compile time is
left out: every call is made once before it is timed. The whole call `em.friction` on a
line of 16384 points, which it takes four times as finely, is compared with one such
sweep over the samples that it takes.
"""

import ctypes
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from common import heading, save, table, timed, verdict

import elastomdr as em
from elastomdr.rough import periodic
from elastomdr.rough.free_steps import line_law
from elastomdr.rough.period import coefficients
from elastomdr.surface.spectrum import synthesise

TIMES = np.geomspace(1e-10, 1e4, 20)  # tau_k [s]
LAW = em.Foundation(1e6, 1e6 * (TIMES / 1e4) ** -0.15, TIMES)
VELOCITY = np.geomspace(1e-6, 10, 64)  # v [m/s]
GLASSY = em.Foundation(2e6, 3e6 * (TIMES / 1e-10) ** -0.1, TIMES)
FAST = np.geomspace(1e-6, 100, 64)  # v of the whole call [m/s]
SURFACE = em.SelfAffine(
    0.8, rms_slope=0.3, q_low=2 * np.pi / 1e-2, q_high=2 * np.pi / 1e-2 * 200
)
SOURCE = """
#include <math.h>
void sweep(long n, long lanes, long m, const double *w, const double *d, const double *e, const double *g,
           const double *c, double soft, double *f, double *u, double *sum) {
  for (long i = 0; i < n; i++) {
    double p[64];
    for (long v = 0; v < lanes; v++) p[v] = soft * u[v];
    for (long k = 0; k < m; k++)
      for (long v = 0; v < lanes; v++) { f[k*lanes+v] *= e[k*lanes+v]; p[v] += f[k*lanes+v]; }
    double du[64];
    for (long v = 0; v < lanes; v++) {
      double free = u[v] - p[v] * c[v], up = w[i] + d[v];
      double new = free > up ? free : up;
      sum[v] += (new - free) / c[v];
      du[v] = new - u[v]; u[v] = new;
    }
    for (long k = 0; k < m; k++)
      for (long v = 0; v < lanes; v++) f[k*lanes+v] += g[k*lanes+v] * du[v];
  }
}
"""


def c_sweep(
    line: em.RoughLine, depth: np.ndarray, law: em.Foundation, velocity: np.ndarray
) -> float:
    """Seconds of processor time of one sweep in C, the least of seven."""
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "sweep.c", Path(folder) / "sweep.so"
        source.write_text(SOURCE)
        subprocess.run(
            ["cc", "-O3", "-march=native", "-shared", "-fPIC", "-o", library, source],
            check=True,
        )
        run = ctypes.CDLL(str(library)).sweep
    by = coefficients(line_law(law.law()), float(line.spacing) / velocity)
    rise = np.ascontiguousarray(periodic.rises(line.height))
    f, u, total = (
        np.zeros((TIMES.size, velocity.size)),
        depth.copy(),
        np.zeros(velocity.size),
    )

    def pointer(array: np.ndarray) -> ctypes.c_void_p:
        return ctypes.c_void_p(array.ctypes.data)

    def call() -> None:
        run(
            ctypes.c_long(rise.size),
            ctypes.c_long(velocity.size),
            ctypes.c_long(TIMES.size),
            pointer(rise),
            pointer(depth),
            pointer(by.keep),
            pointer(by.gain),
            pointer(by.give),
            ctypes.c_double(float(law.equilibrium)),
            pointer(f),
            pointer(u),
            pointer(total),
        )

    return timed(call, 7).cpu


def memory(samples: int) -> float:
    """Peak memory [MB] of a process that computes one curve on a line of so many
    samples.
    """
    script = (
        "import resource, rough_sliding as r; line = r.synthesise(r.SURFACE, 1, "
        f"{samples} // 2048, {samples}); r.solved(line, 200.0); "
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3)"
    )
    found = subprocess.run(
        [sys.executable, "-c", script],
        cwd=Path(__file__).parent,
        check=True,
        capture_output=True,
    )
    return float(found.stdout.split()[-1])


def solved(
    line: em.RoughLine,
    load: float,
    law: em.Foundation = LAW,
    velocity: np.ndarray = VELOCITY,
) -> periodic.SolvedLine:
    """All velocities at one line load [N/m]."""
    loads = np.full(velocity.size, load)
    job = periodic.Job(line.height, float(line.spacing), velocity, loads, "load")
    return periodic.solve_line(job, law.law())


def one_core(load: float) -> float:
    """Processor time [s], the least of twelve, of a process that has one core from its
    start: JAX then has one thread, and no time goes into handing work from one to
    another.
    """
    script = (
        "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
        "import rough_sliding as r\n"
        "line = r.synthesise(r.SURFACE, 1, 8, 16384)\n"
        f"def run(): return r.solved(line, {load})\n"
        "run()\n"
        "print(min(r.timed(run).cpu for _ in range(12)))"
    )
    found = subprocess.run(
        [sys.executable, "-c", script],
        cwd=Path(__file__).parent,
        check=True,
        capture_output=True,
    )
    return float(found.stdout)


def whole_call(seed: int) -> tuple[float, ...]:
    """Points of `em.friction` that converge, the largest error over mu, and processor
    times [s]: of the call, of one sweep in C over the samples that it takes, and of one
    over the points of the line.
    """
    line = synthesise(SURFACE, seed, 1, 16384)

    def call() -> em.FrictionCurve:
        return em.friction(GLASSY, line, velocity=FAST, load=0.6, model=em.Line())

    call()
    curve, _, cpu = timed(call, 7)
    depth = np.nan_to_num(curve.depth, nan=1e-5)
    sweeps = [c_sweep(one, depth, GLASSY, FAST) for one in (line.finer(4), line)]
    return (
        int(curve.converged.sum()),
        float(np.nanmax(curve.error / curve.mu)),
        cpu,
        *sweeps,
    )


def whole_calls() -> list[tuple]:
    """Rows of `whole_call` for three lines, in a process of one core."""
    script = (
        "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
        "import rough_sliding as r\n"
        "for seed in range(3): print(*r.whole_call(seed))"
    )
    found = subprocess.run(
        [sys.executable, "-c", script],
        cwd=Path(__file__).parent,
        check=True,
        capture_output=True,
    )
    rows = [
        [float(x) for x in row.split()]
        for row in found.stdout.decode().strip().split("\n")
    ]
    return [
        (seed, int(row[0]), *row[1:4], row[2] / row[3], row[2] / row[4])
        for seed, row in enumerate(rows)
    ]


def main() -> None:
    record = heading(
        "Steady sliding on a rough line",
        f"{VELOCITY.size} velocities, {TIMES.size} branches, {SURFACE}",
    )
    line = synthesise(SURFACE, 1, 8, 16384)
    rows, cores = [], os.sched_getaffinity(0)
    for load in (5.0, 200.0, 3000.0):

        def run(load=load, line=line, many=1):
            velocity = np.geomspace(VELOCITY[0], VELOCITY[-1], many * VELOCITY.size)
            return solved(line, load, velocity=velocity)

        run()
        wall = timed(run, 5).wall
        os.sched_setaffinity(0, {min(cores)})
        found = run()
        lean = one_core(load)
        plain = c_sweep(line, np.nan_to_num(found.depth, nan=1e-5), LAW, VELOCITY)
        os.sched_setaffinity(0, cores)
        rows.append(
            (
                load,
                float(np.nanmin(found.share)),
                float(np.nanmax(found.share)),
                int(found.converged.sum()),
                float(found.sweeps.mean()),
                wall,
                lean,
                plain,
                lean / plain,
            )
        )
    columns = (
        "load [N/m]",
        "least share",
        "largest share",
        "converged",
        "sweeps",
        "wall, all cores [s]",
        "one core [s]",
        "C sweep, one core [s]",
        "ratio",
    )
    record["loads"] = table(columns, rows)
    print()
    record["verdicts"] = [
        verdict(
            "wall clock, warm, the slowest load", max(row[5] for row in rows), 1.0, " s"
        ),
        verdict(
            "one core's time over one sweep in C, the worst load",
            max(row[8] for row in rows),
            25.0,
        ),
    ]
    calls = whole_calls()
    columns = (
        "seed",
        "converged",
        "error/mu, largest",
        "em.friction, one core [s]",
        "C sweep [s]",
        "ratio",
        "over one of the points",
    )
    record["whole calls"] = table(columns, calls)
    record["verdicts"] += [
        verdict(
            "points of em.friction that converge, glassy spectrum, the least",
            min(row[1] for row in calls),
            64,
            least=True,
        ),
        verdict(
            "em.friction over one sweep in C of the samples it takes",
            max(row[5] for row in calls),
            20.0,
        ),
    ]
    four = [synthesise(SURFACE, seed, 32, 65536) for seed in range(4)]

    def ensemble():
        value = np.full(VELOCITY.size, 200.0)
        jobs = [
            periodic.Job(
                np.asarray(x.height), float(x.spacing), VELOCITY, value, "load"
            )
            for x in four
        ]
        return periodic.solve_lines(jobs, LAW.law())

    if len(cores) > 1:
        os.sched_setaffinity(0, {min(cores)})
        ensemble(), run(many=4)
        one = timed(ensemble, 5).wall, timed(lambda: run(many=4), 5).wall
        os.sched_setaffinity(0, cores)
        ensemble(), run(many=4)
        two = timed(ensemble, 5).wall, timed(lambda: run(many=4), 5).wall
        words = (
            "64 velocities on 4 lines of 65536 samples",
            "256 velocities on one line of 16384",
        )
        record["verdicts"] += [
            verdict(f"{len(cores)} cores over one, {word}", a / b, 1.7, least=True)
            for word, a, b in zip(words, one, two, strict=True)
        ]
    sizes = []
    for power in (14, 16, 18, 20):
        n = 2**power
        long = synthesise(SURFACE, 1, n // 2048, n)
        run(line=long)
        sizes.append(
            (n, timed(lambda long=long: run(line=long), 3).cpu / n * 1e6, memory(n))
        )
    record["sizes"] = table(
        (
            "samples",
            "cpu per sample [us], all 64 velocities",
            "peak memory of a process [MB]",
        ),
        sizes,
    )
    branches = []
    for count in (5, 10, 20, 40, 60):
        times = np.geomspace(TIMES[0], TIMES[-1], count)
        law = em.Foundation(1e6, 20 / count * 1e6 * (times / 1e4) ** -0.15, times)

        def swept(law=law):
            return solved(line, 200.0, law)

        swept()
        found = timed(swept, 3)
        branches.append(
            (
                count,
                found.cpu,
                float(found.value.sweeps.mean()),
                found.cpu / found.value.sweeps.mean(),
            )
        )
    record["branches"] = table(
        ("branches", "cpu [s]", "sweeps", "cpu per sweep [s]"), branches
    )
    record["verdicts"] += [
        verdict(
            "cost of a sweep per branch, 60 branches over 20",
            branches[4][3] / branches[2][3] / 3,
            1.3,
        ),
        verdict(
            "cost per sample at 2^20 over that at 2^16", sizes[3][1] / sizes[1][1], 1.3
        ),
        verdict("peak memory at 2^18 samples", sizes[2][2], 1000.0, " MB"),
    ]
    save("rough_sliding", record)


if __name__ == "__main__":
    main()
