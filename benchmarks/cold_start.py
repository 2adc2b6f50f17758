"""How long until the first number? Every case in a process of its own, with no cache of
compiled code.

    python benchmarks/cold_start.py

Times are medians of five processes, from their start to their first number: wall-clock
time, by which the verdicts go (so run it on an idle machine), and processor time, by
which that of a gradient goes. A second start finds the compiled code that the first one
left. Of each first call the shares of its wall-clock time are given: what is computed
(the time of the same call again), what JAX traces and compiles (as JAX reports it),
what is drawn, and the rest, which is the start of Python and imports; of a command
imports are measured and what is computed is the rest. Last, what a warm call takes.
"""

import functools
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from common import heading, plt, save, table, timed, verdict

import elastomdr as em

EXAMPLES = Path(__file__).parents[1] / "examples"
REPEATS = 5
OF_PROCESSOR = " s of processor"
SHARES = ("import", "tracing", "compiling", "computing", "drawing")

RUBBER = (
    "em.Prony(1e6, np.geomspace(1e8, 1e6, 16), np.logspace(-7, 2, 16), poisson=0.4)"
)
VELOCITIES = "np.logspace(-5, 1, 64)"
SOLID, TIME = (
    "em.StandardSolid(1e6, 1e7, 1e-2)",
    "time=(time := np.linspace(0, 0.1, 51))",
)
ROAD = "em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e6)"


class Case(NamedTuple):
    """A call, the most that its first number and its second start may take [s], and
    whether JAX computes it.
    """

    name: str
    call: str
    target: float
    second: float | None = None
    jax: bool = False


CASES = (
    Case(
        "friction of a ball",
        f"em.friction({RUBBER}, em.Sphere(5e-3), velocity={VELOCITIES}, load=1.0)",
        0.8,
    ),
    Case(
        "friction of a cone",
        f"em.friction({RUBBER}, em.Cone(0.1), velocity={VELOCITIES}, load=1.0)",
        0.8,
    ),
    Case(
        "rolling of a roller",
        (
            f"em.rolling(em.springs({RUBBER}, 1e-2), em.Cylinder(0.05, 0.5), "
            f"velocity={VELOCITIES}, load=100.0)"
        ),
        0.8,
    ),
    Case(
        "a road by Multiscale",
        f"em.friction({RUBBER}, {ROAD}, velocity={VELOCITIES}, pressure=3e5)",
        0.8,
    ),
    Case(
        "indent, depth",
        f"em.indent({RUBBER}, em.Sphere(5e-3), time=[0, 1, 2], depth=[0, 1e-4, 0])",
        3.0,
        1.5,
    ),
    Case(
        "indent, growing load",
        f"em.indent({RUBBER}, em.Sphere(5e-3), time=[0, 1, 2], load=[0, 1, 2])",
        3.0,
        1.5,
    ),
    Case(
        "indent, falling load",
        f"em.indent({RUBBER}, em.Sphere(5e-3), time=[0, 1, 2], load=[0, 1, 0.2])",
        3.0,
        1.5,
    ),
    Case(
        "impact",
        f"em.impact({RUBBER}, em.Sphere(5e-3), mass=1e-3, velocity=1.0)",
        3.0,
        1.5,
    ),
    Case(
        "traction",
        (
            f"em.traction({RUBBER}, em.Paraboloid(5e-3), velocity=1.0, "
            "creepage=[1e-3, 0.02, 0.1], friction=0.8, load=5.0)"
        ),
        3.0,
        1.5,
    ),
    Case(
        "shear",
        f"em.shear({SOLID}, em.Paraboloid(5e-3), {TIME}, load=1.0, friction=0.5, "
        "displacement=2e-5 * np.sin(60 * time))",
        3.0,
        1.5,
    ),
    Case(
        "slide",
        (
            f"em.slide({SOLID}, em.Sphere(5e-3), {TIME}, load=1.0, position=0.02 * "
            "time, rtol=1e-4)"
        ),
        3.0,
        1.5,
    ),
    Case(
        "drive",
        f"em.drive({SOLID}, em.Sphere(5e-3), {TIME}, load=1.0, position=0.02 * time, "
        "tangential=em.Mount(0.1, 1e3, 1.0), rtol=1e-2)",
        3.0,
        1.5,
    ),
    Case(
        "gradient of the README",
        "jax.grad(lambda modulus: em.friction(em.StandardSolid(1e6, modulus, 1e-3), "
        "em.Paraboloid(5e-3), velocity=1.0, load=1.0).mu)(3e6)",
        4.0,
        jax=True,
    ),
)
LISTENER = """
import jax, jax.monitoring
def listen(name, seconds, **_):
    for share in ("trace", "compile"):
        if share in name.rpartition("/")[2]: shares[share] += seconds
jax.monitoring.register_event_duration_secs_listener(listen)
jax.config.update("jax_enable_x64", True)
"""
CHILD = """
import time
shares = {{"trace": 0.0, "compile": 0.0}}
{listener}
import numpy as np
import elastomdr as em
call = lambda: {call}
import time as clock
call()
processor, told = clock.process_time(), dict(shares)
start = clock.perf_counter(); call(); again = clock.perf_counter() - start
import sys
print(processor, told["trace"], told["compile"], again, *sorted({{"jax", "scipy", "matplotlib"}} & set(sys.modules)))
"""
COMMAND = """
import builtins, sys, time
imports, drawn, nested, load = [0.0], [0.0], [], builtins.__import__
def counted(*what, **how):
    if nested: return load(*what, **how)
    nested.append(True)
    start = time.perf_counter()
    try: return load(*what, **how)
    finally:
        nested.clear()
        imports[0] += time.perf_counter() - start
def timed(owner, name):
    draw = getattr(owner, name)
    def function(*what, **how):
        start, before = time.perf_counter(), imports[0]
        try: return draw(*what, **how)
        finally: drawn[0] += time.perf_counter() - start - (imports[0] - before)
    setattr(owner, name, function)
builtins.__import__ = counted
import elastomdr.cli.main as command
if sys.argv[1] == "fit":
    from elastomdr.fit import figures
    timed(figures, "figures")
else:
    from elastomdr.cli import compute
    from elastomdr.results.base import Result
    timed(compute, "_write_figure")
    timed(Result, "plot")
status = command.main(sys.argv[1:])
print(imports[0], drawn[0], *sorted({"jax", "scipy", "matplotlib"} & set(sys.modules)))
sys.exit(status)
"""


class Process(NamedTuple):
    """What a process took and printed."""

    wall: float  # [s]
    cpu: float  # [s]; NaN where the system does not tell
    memory: float  # peak resident memory [MB], at least that of this script; likewise
    last: list[str]  # the words of the last line


def run(code: str, *arguments: str, **variables: str) -> Process:
    """One new process of Python."""
    dropped = ("JAX_COMPILATION_CACHE_DIR", "MPLCONFIGDIR")
    environment = {k: v for k, v in os.environ.items() if k not in dropped} | variables
    with tempfile.TemporaryFile("w+") as output:
        start = time.perf_counter()
        command = [sys.executable, "-c", code, *arguments]
        process = subprocess.Popen(
            command, env=environment, stdout=output, stderr=subprocess.STDOUT
        )
        cpu = memory = float("nan")
        if hasattr(os, "wait4"):
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            memory = usage.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
            cpu = usage.ru_utime + usage.ru_stime
        process.wait()
        wall = time.perf_counter() - start
        output.seek(0)
        text = output.read()
    if process.returncode != 0:
        raise SystemExit(
            f"{code}\nfailed with exit status {process.returncode}:\n{text}"
        )
    lines = text.splitlines() or [""]
    return Process(wall, cpu, memory, lines[-1].split())


def median(runs: list[Process]) -> Process:
    """The process of the median time, with the median processor time and the largest
    memory.
    """
    middle = sorted(runs, key=lambda one: one.wall)[len(runs) // 2]
    return middle._replace(
        cpu=statistics.median(r.cpu for r in runs), memory=max(r.memory for r in runs)
    )


def first_number(case: Case) -> tuple[dict[str, Any], Process]:
    """A case in new processes that keep no compiled code: its row, and the median
    process.
    """
    code = CHILD.format(listener=LISTENER if case.jax else "", call=case.call)
    found = median(
        [run(code, JAX_ENABLE_COMPILATION_CACHE="0") for _ in range(REPEATS)]
    )
    processor, trace, compiling, again = map(float, found.last[:4])
    wall = found.wall - again  # the call is made twice
    shares = (max(wall - trace - compiling - again, 0.0), trace, compiling, again, 0.0)
    found = found._replace(wall=wall, cpu=processor)
    return _row(case.name, wall, found, shares, found.last[4:]), found


def second_start(case: Case) -> float:
    """Time [s] to the first number of a process that finds the compiled code of one
    before.
    """
    code = CHILD.format(listener="", call=case.call)
    with tempfile.TemporaryDirectory() as folder:
        where = {"XDG_CACHE_HOME": folder, "LOCALAPPDATA": folder}
        run(code, **where)
        runs = [run(code, **where) for _ in range(REPEATS)]
        return statistics.median(one.wall - float(one.last[3]) for one in runs)


def command(*argv: str) -> tuple[dict[str, Any], Process]:
    """A command of `elastomdr` with its tables and figures, matplotlib's list of fonts
    being known.
    """
    bare = min(run("pass").wall for _ in range(3))
    with tempfile.TemporaryDirectory() as folder:
        where, runs = {"XDG_CACHE_HOME": folder, "LOCALAPPDATA": folder}, []
        for _ in range(REPEATS + 1):  # the first makes the list of fonts
            runs.append(
                run(COMMAND, *argv, "--out", str(Path(folder) / "out"), **where)
            )
            for made in ("out", "elastomdr"):
                shutil.rmtree(Path(folder) / made, ignore_errors=True)
    found = median(runs[1:])
    imported, drawing = float(found.last[0]) + bare, float(found.last[1])
    shares = (imported, 0.0, 0.0, found.wall - imported - drawing, drawing)
    return _row(
        f"elastomdr {argv[0]} {Path(argv[1]).name}",
        found.wall,
        found,
        shares,
        found.last[2:],
    ), found


def warm() -> list[dict[str, Any]]:
    """Calls in a process that has made the same call before: the median processor time
    of many.
    """
    foundation = em.half_space(
        em.Prony(1e6, np.geomspace(1e8, 1e6, 16), np.logspace(-7, 2, 16), poisson=0.4)
    )
    curve, found = np.logspace(-5, 1, 64), []
    for name, shape, velocity, target in (
        (
            "64 loaded, averaged velocities of a paraboloid, 16 branches",
            em.Paraboloid(5e-3),
            curve,
            2.0,
        ),
        ("one point of a paraboloid", em.Paraboloid(5e-3), 0.1, 0.3),
        ("one point of a cone", em.Cone(0.1), 0.1, 3.0),
    ):
        times = [
            timed(
                functools.partial(
                    em.friction, foundation, shape, velocity=velocity, load=1.0
                )
            ).cpu
            for _ in range(200)
        ]
        found.append(
            verdict(f"warm: {name}", 1e3 * statistics.median(times), target, " ms")
        )
    return found


def _row(
    name: str, wall: float, found: Process, shares: tuple[float, ...], loaded: list[str]
) -> dict[str, Any]:
    columns = {
        "case": name,
        "wall [s]": wall,
        "processor [s]": found.cpu,
        "memory [MB]": found.memory,
    }
    return (
        columns
        | {f"{k} [s]": v for k, v in zip(SHARES, shares, strict=True)}
        | {"loads": " ".join(loaded) or "-"}
    )


def main() -> None:
    record = heading(
        "Cold start: from a new process to the answer",
        f"median of {REPEATS} processes, no cache",
    )
    bare = median([run("pass") for _ in range(REPEATS)])
    imported = median([run("import elastomdr") for _ in range(REPEATS)])
    usage = median(
        [
            run("from elastomdr.cli.main import main; main(['--help'])")
            for _ in range(REPEATS)
        ]
    )
    rows, figures = (
        [],
        [
            verdict("import elastomdr", imported.wall - bare.wall, 0.1, " s"),
            verdict("elastomdr --help", usage.wall, 0.1, " s"),
        ],
    )
    for case in CASES:
        row, found = first_number(case)
        rows.append(row)
        time_of = (
            (found.cpu, case.target, OF_PROCESSOR)
            if case.jax
            else (found.wall, case.target, " s")
        )
        figures.append(verdict(case.name, *time_of))
        if case.second is not None:
            figures.append(
                verdict(
                    f"{case.name}, second start", second_start(case), case.second, " s"
                )
            )
    for target, argv in (
        (1.5, ("friction", str(EXAMPLES / "scenes" / "slider.toml"))),
        (2.0, ("friction", str(EXAMPLES / "scenes" / "tread.toml"))),  # the README's
        (2.5, ("fit", str(EXAMPLES / "data" / "dma.csv"))),
    ):
        row, found = command(*argv)
        rows.append(row)
        figures.append(verdict(str(row["case"]), found.wall, target, " s"))
    figures += warm()
    record["processes"] = table(tuple(rows[0]), [tuple(row.values()) for row in rows])
    record["figures"] = figures
    figure, ax = plt.subplots(figsize=(8, 4), layout="constrained")
    names, left = [row["case"] for row in rows], [0.0] * len(rows)
    for share in SHARES:
        width = [row[f"{share} [s]"] for row in rows]
        ax.barh(names, width, left=left, label=share)
        left = [a + b for a, b in zip(left, width, strict=True)]
    ax.set(xlabel="wall-clock time [s]", title="From a new process to the first number")
    ax.invert_yaxis()
    ax.legend()
    save("cold_start", record, figure)


if __name__ == "__main__":
    main()
