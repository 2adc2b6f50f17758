"""The example for SLURM, on a scheduler of jobs that is made of two shell scripts."""

import os
import runpy
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

import elastomdr as em
from elastomdr.sweeps import grid, run

before = signal.getsignal(signal.SIGINT)
pytest.importorskip("dask_jobqueue")  # it takes Ctrl-C for itself
signal.signal(signal.SIGINT, before)
EXAMPLE = Path(__file__).parents[2] / "examples" / "slurm.py"
# like those of SLURM they keep a copy of the script of a job, say its number, and end
# all of its processes
SBATCH = """#!/bin/bash
cp "$1" "$0.$$"
setsid bash "$0.$$" >>"$0.log" 2>&1 </dev/null &
echo $! >>"$0.jobs"
echo "Submitted batch job $!"
"""
SCANCEL = """#!/bin/bash
kill -- "-$1"
"""
SETTINGS = {
    # a laboratory sets such things in ~/.config/dask
    "DASK_JOBQUEUE__SLURM__SCHEDULER_OPTIONS": '{"host": "127.0.0.1"}',
    "DASK_JOBQUEUE__SLURM__WORKER_EXTRA_ARGS": '["--no-dashboard"]',
    "DASK_DISTRIBUTED__DEPLOY__LOST_WORKER_TIMEOUT": "0.2s",
    "DASK_DISTRIBUTED__ADAPTIVE__INTERVAL": "0.2s",
}


def wait_until(is_so, going, seconds=120):
    end = time.monotonic() + seconds
    while not is_so() and going.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
    assert is_so()


@pytest.mark.skipif(sys.platform == "win32", reason="shell scripts")
def test_the_example_survives_losses(tmp_path, monkeypatch):
    """Its job is killed, and another one takes its place; it is killed itself, and its
    job ends; started again it computes only what is missing.
    """
    for name, content in (("sbatch", SBATCH), ("scancel", SCANCEL)):
        (tmp_path / name).write_text(content)
        (tmp_path / name).chmod(0o755)
    path, jobs = tmp_path / "runs.zarr", tmp_path / "sbatch.jobs"
    options = ["--store", str(path), "--jobs", "1", "--velocities", "1"]
    program = textwrap.dedent(f"""
        import runpy, sys, time
        from elastomdr.sweeps import grid, run
        grid._POINTS, keep = 35, run.ZarrStore.keep
        def slowly(*given):
            time.sleep(0.1)
            keep(*given)
        run.ZarrStore.keep = slowly
        sys.argv = ["slurm.py", *{options!r}]
        runpy.run_path({str(EXAMPLE)!r}, run_name="__main__")
        """)

    def kept():
        return sorted(path.glob("state/.record/chunk.*"))

    def started():
        return [int(line) for line in jobs.read_text().split()]

    going = subprocess.Popen(
        [sys.executable, "-c", program],
        env=os.environ | SETTINGS | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
        stderr=subprocess.DEVNULL,
    )
    try:
        wait_until(lambda: len(kept()) > 1, going)
        os.killpg(started()[0], signal.SIGKILL)
        before = len(kept()) + 5  # of those that are still on their way
        wait_until(lambda: len(kept()) > before, going)
    finally:
        going.kill()
        going.wait()
    assert len(started()) == 2
    lost = [p for p in psutil.process_iter() if os.getpgid(p.pid) == started()[1]]
    assert not psutil.wait_procs(lost, timeout=30)[1]
    done = {record: record.stat().st_mtime_ns for record in kept()}
    assert len(done) < 20
    monkeypatch.setattr(grid, "_POINTS", 35)
    monkeypatch.setattr(run, "_cores", lambda: 1)
    axes = runpy.run_path(str(EXAMPLE))["axes"](velocities=1)
    found = em.sweep(em.friction, axes, store=path, progress=False)
    assert found.converged.values.all()
    assert len(kept()) == 20
    assert all(record.stat().st_mtime_ns == at for record, at in done.items())
    alone = em.friction(
        em.load_material("tread-winter-synthetic"),
        axes["surface"][0],
        pressure=axes["pressure"][:, None, None],
        temperature=axes["temperature"][:, None],
        velocity=axes["velocity"],
    )
    np.testing.assert_allclose(found.mu[1, 0], alone.mu, rtol=1e-12)
