"""Does a sweep that is killed at random lose, repeat wrongly or mix up anything?

    python benchmarks/robustness/sweeps_killed.py [--sweeps N] [--seed S]

Sweeps with random axes are computed by worker processes. After a random time all
processes, the one that called, the scheduler or a worker get SIGKILL, up to three
times; the same call then goes on. Nothing may be left running. At the end every point
must be done and equal to a call of its own.
"""

import argparse
import contextlib
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil

sys.path.append(str(Path(__file__).parents[1]))
from common import heading, save, table, verdict

import elastomdr as em

LIMIT = 180.0  # s for one start
SCHEDULER = "distributed.Scheduler"  # in its command line
SCRIPT = """
import sys, time
import elastomdr as em
from elastomdr.sweeps import grid, run
sys.path.insert(0, {here!r})
from sweeps_killed import arguments
grid._POINTS = {points}
run._cores = lambda: {workers}
keep = run.Store.keep
def slowly(self, *rest):
    time.sleep({pause})
    keep(self, *rest)
run.Store.keep = slowly
axes, fixed = arguments({seed}, {number})
em.sweep(em.friction, axes, store={store!r}, progress=False, **fixed)
"""


def arguments(seed: int, number: int) -> tuple[dict, dict]:
    """Axes and fixed arguments of a sweep; the same in every process."""
    random = np.random.default_rng([seed, number])
    rubbers = [
        em.Prony(
            1e6,
            10 ** random.uniform(5, 7, 2),
            10 ** random.uniform([-6, -4], [-5, -3]),
            name=f"rubber {i}",
        )
        for i in range(int(random.integers(1, 4)))
    ]
    axes: dict = {
        "material": rubbers,
        "velocity": np.sort(10 ** random.uniform(-4, 1, int(random.integers(3, 9)))),
    }
    if random.random() < 0.5:
        axes = {"load": 10 ** random.uniform(-1, 1, int(random.integers(2, 5)))} | axes
        return axes, {"shape": em.Sphere(0.01)}
    axes |= {"pressure": 10 ** random.uniform(4.5, 6, int(random.integers(2, 5)))}
    return axes, {"shape": em.SelfAffine(0.8, q_low=1e3, q_high=1e5, rms_slope=0.5)}


def members(leader: int) -> list[psutil.Process]:
    """The processes that a process has started: scheduler and workers."""
    try:
        return psutil.Process(leader).children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def schedules(process: psutil.Process) -> bool | None:
    """Whether it is the scheduler; None of one that has ended."""
    try:
        return SCHEDULER in " ".join(process.cmdline())
    except psutil.NoSuchProcess:
        return None


def states(store: Path) -> np.ndarray:
    """What is marked as done; nothing where there is no store yet."""
    import zarr

    try:
        return np.asarray(zarr.open_group(str(store), mode="r")["state"][...]).ravel()
    except Exception:  # killed before there was anything to open
        return np.zeros(0)


def one(seed: int, number: int, place: Path) -> tuple:
    """One sweep: what was killed, how many chunks were done by then, and what is
    wrong.
    """
    random = np.random.default_rng([seed, number, 1])
    store, kills, found, wrong = place / f"{number}.zarr", [], np.zeros(0), ""
    script = place / f"{number}.py"
    values = {
        "here": str(Path(__file__).parent),
        "seed": seed,
        "number": number,
        "store": str(store),
    }
    script.write_text(
        SCRIPT.format(points=int(random.integers(1, 6)), workers=2, pause=0.1, **values)
    )
    for turn in range(4):
        going = subprocess.Popen(
            [sys.executable, str(script)],
            start_new_session=True,
            stderr=subprocess.PIPE,
            text=True,
        )
        kind = (
            str(random.choice(["all", "main", "worker", "scheduler"]))
            if turn < 3
            else "nothing"
        )
        before, begin = (states(store) == 1).sum(), time.monotonic()
        wanted = before + int(random.integers(0, 4)) if kind != "nothing" else 10**9
        while (
            going.poll() is None
            and time.monotonic() < begin + LIMIT
            and (states(store) == 1).sum() <= wanted
        ):
            time.sleep(0.05)
        started = members(going.pid)
        if going.poll() is None and kind in ("worker", "scheduler"):
            of_kind = [
                each for each in started if schedules(each) == (kind == "scheduler")
            ]
            if of_kind:
                of_kind[int(random.integers(len(of_kind)))].kill()
                kills.append(kind)
            # the sweep goes on by itself, or has closed its cluster already
            if kind == "worker" or not of_kind:
                kind = "nothing"
        elif going.poll() is None and kind != "nothing":
            for each in [*started] * (kind == "all") + [psutil.Process(going.pid)]:
                with contextlib.suppress(psutil.NoSuchProcess):
                    each.kill()
            kills.append(kind)
        try:
            said = going.communicate(timeout=LIMIT if kind == "nothing" else 60)[1]
        except subprocess.TimeoutExpired:
            said, wrong = (
                "",
                f"still there after {LIMIT:g} s"
                if kind == "nothing"
                else f"hangs without its {kind}",
            )
        if (
            kind == "scheduler"
            and "the same call goes on from there" not in said
            and going.returncode != 0
        ):
            wrong = "the lost cluster is not named"
        if psutil.wait_procs(started, timeout=20)[1]:
            wrong = "processes are left"
        if going.poll() is None:
            going.kill()
            going.wait()
        now = states(store) == 1
        found = now if now.size else found
        if going.returncode == 0:
            break
        if kind == "nothing" and not wrong:
            wrong = (
                said.strip().splitlines()[-1]
                if said.strip()
                else f"status {going.returncode}"
            )
            if kills and kills[-1] == "worker":  # a start of its own has to finish it
                wrong = "" if turn < 3 else wrong
    return (
        number,
        " ".join(kills) or "none",
        int(found.sum()),
        wrong or compared(seed, number, store),
    )


def compared(seed: int, number: int, store: Path) -> str:
    """What differs from a call of its own at each point."""
    import xarray

    axes, fixed = arguments(seed, number)
    whole = xarray.open_zarr(store)
    if not (whole.state.values == 1).all() or not whole.converged.values.all():
        return "not all of it is done"
    others = [name for name in axes if name not in ("material", "velocity")]
    for i, material in enumerate(axes["material"]):
        for j, value in enumerate(axes[others[0]]):
            given = {others[0]: value, "velocity": axes["velocity"]}
            alone = em.friction(material, fixed["shape"], **given)
            for name in ("mu", "model_error"):
                here = (
                    whole[name]
                    .isel({"material": i, others[0]: j})
                    .transpose("velocity")
                    .values
                )
                if not np.allclose(
                    here, getattr(alone, name), rtol=1e-12, equal_nan=True
                ):
                    return f"{name} of material {i}, {others[0]} {j} differs"
    return ""


def main() -> int:
    options = argparse.ArgumentParser(description="Sweeps that are killed at random.")
    options.add_argument("--sweeps", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    chosen = options.parse_args()
    record = heading(
        "Sweeps killed at random", f"{chosen.sweeps} sweeps, seed {chosen.seed}"
    )
    with tempfile.TemporaryDirectory() as place:
        rows = [
            one(chosen.seed, number, Path(place)) for number in range(chosen.sweeps)
        ]
    record["sweeps"] = table(("sweep", "killed", "chunks", "wrong"), rows)
    wrong = sum(bool(row[3]) for row in rows)
    record["verdicts"] = [
        verdict("sweeps not finished or not equal to single calls", wrong, 0),
        verdict(
            "kills",
            sum(len(row[1].split()) for row in rows if row[1] != "none"),
            chosen.sweeps,
            least=True,
        ),
    ]
    save("robustness/sweeps_killed", record)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
