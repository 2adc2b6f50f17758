"""Run time against error, one figure for each question: rolling on a layer, a rough
line, a road, a fit. That of smooth friction is in `steady_sliding.py`.

    python benchmarks/time_error.py

Rolling: tolerances from coarse to fine, errors from the finest. Rough lines and maps:
samples from coarse to fine, beside plain sweeps that are given the depth. Errors of
road models and fits stand in the records of `rough_fit.py` and `fit_peers.py`.
Processor time of one core, warm; with the whole call on a rough line over one plain
sweep of the samples that it takes.
"""

import json
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import numpy as np
import rough_sliding
from common import RESULTS, heading, one_core, plt, save, table, timed, verdict

import elastomdr as em
from elastomdr.rough import half_space, period, periodic
from elastomdr.rough.free_steps import line_law

RUBBER = em.Prony(1e6, np.geomspace(1e8, 1e6, 16), np.logspace(-7, 2, 16), poisson=0.49)
VELOCITY = np.logspace(-5, 1, 64)
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=600.0, q_high=1e5)
Rows = list[tuple[str, str, float, float]]  # question, method, error, seconds


def _converging(
    question: str, method: str, call: Callable[[float], Any], tolerances: Any
) -> tuple[Rows, np.ndarray]:
    """Errors and times at tolerances, from the last of them, and its numbers."""
    truth = np.asarray(call(tolerances[-1]))
    rows = []
    for rtol in tolerances[:-1]:
        run = timed(lambda rtol=rtol: call(rtol), 3)
        error = float(np.nanmax(np.abs(run.value / truth - 1)))
        rows.append((question, method, max(error, 1e-16), run.cpu))
    return rows, truth


def layers() -> Rows:
    question = "rolling on a layer: 64 velocities, 16 branches"
    roller, ball = em.Cylinder(0.05, 0.5), em.Sphere(5e-3)
    layer = em.layer(RUBBER, 5e-3)
    springs = em.springs(RUBBER, 5e-3, bonded=False)

    def roll(body: Any, cover: Any, load: float, rtol: float) -> Any:
        scene = {"velocity": VELOCITY, "load": load}
        return em.rolling(cover, body, **scene, rtol=rtol).coefficient

    rows, truth = _converging(
        question, "roller", lambda r: roll(roller, layer, 200.0, r), TOLERANCES
    )
    more, _ = _converging(
        question, "ball", lambda r: roll(ball, layer, 1.0, r), TOLERANCES
    )
    run = timed(lambda: roll(roller, springs, 200.0, 1e-6), 3)
    off = float(np.max(np.abs(run.value / truth - 1)))
    return [*rows, *more, (question, "roller on independent springs", off, run.cpu)]


def lines() -> Rows:
    """Samples as given, twice and four times as fine, against eight times; and plain
    sweeps over the four times finer ones, with the depth of each velocity known.
    """
    question = "a rough line: 64 velocities, 16,384 points, 20 branches"
    rubber = em.half_space(
        em.Prony(1e6, np.geomspace(1e8, 1e6, 20), np.logspace(-8, 3, 20), poisson=0.49)
    )
    law, line = rubber.law(), ROAD.line(seed=1, samples=16384)
    load = np.full(VELOCITY.size, 200.0)

    def solved(fine: int) -> Any:
        one = line.finer(fine) if fine > 1 else line
        job = periodic.Job(one.height, float(one.spacing), VELOCITY, load, "load")
        return periodic.solve_line(job, law)

    truth = solved(8).mu
    rows = []
    for fine in (1, 2, 4):
        solved(fine)
        run = timed(partial(solved, fine), 5)
        rows.append(
            (
                question,
                "periodic state: 1, 2, 4 samples a point",
                _error(run.value.mu, truth),
                run.cpu,
            )
        )

    def call() -> Any:
        return em.friction(rubber, line, velocity=VELOCITY, load=200.0, model=em.Line())

    call()
    run = timed(call, 5)
    rows.append((question, "em.friction", _error(run.value.mu, truth), run.cpu))
    finer, state = line.finer(4), solved(4)
    sweep = rough_sliding.c_sweep(finer, state.depth, rubber, VELOCITY)
    for count, mu in _plain_sweeps(finer, law, state.depth):
        off = _error(mu, state.mu)
        rows.append(
            (question, "plain sweeps in C, 1 to 100, depth known", off, count * sweep)
        )
    RATIOS["a rough line"] = run.cpu / sweep
    return rows


RATIOS: dict[str, float] = {}  # of a call of the package, over one plain sweep


def _error(mu: Any, truth: Any) -> float:
    return float(np.nanmax(np.abs(np.asarray(mu) / np.asarray(truth) - 1)))


def _plain_sweeps(line: Any, law: Any, depth: Any) -> list[tuple[int, Any]]:
    """Friction after some sweeps over a line from rest, period by period."""
    rise, spacing = periodic.rises(line.height), float(line.spacing)
    after = []
    with jax.enable_x64(True):
        by = period.coefficients(line_law(law), spacing / VELOCITY)
        branches = np.zeros((law.moduli.size, VELOCITY.size))
        for count in range(1, 101):
            end = period.sweep(
                rise, rise.size, 1, np.asarray(depth), branches, by, 0, True
            )
            branches = np.asarray(end.branches)
            if count in (1, 2, 5, 10, 20, 50, 100):
                mu = np.asarray(end.work) / np.asarray(end.load) / spacing
                after.append((count, mu))
    return after


TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8)


def roads() -> Rows:
    """Errors of the models against maps in three dimensions by real contact, and of
    coarser maps against one of 512 by 512 cells.
    """
    question = "a road: one velocity of many, error against three dimensions"
    recorded, judged = _recorded("roads"), _recorded("rough_fit")
    rows = []
    for name in ("Multiscale", "Persson"):
        each = [x for x in recorded["closed"] if x["model"] == name]
        seconds = float(np.mean([x["a point of 64 [ms]"] for x in each]))
        for row in judged[name.lower()]:
            if str(row[name]).startswith("contact"):
                method = f"em.{name}, light to full contact"
                rows.append((question, method, float(row["rms"]), seconds / 1e3))
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1.6e4)
    heights, side = em.reference.rough_map(surface, 0, periods=1, points=512)
    modulus = em.half_space(RUBBER).complex_modulus

    def slide(cells: int) -> Any:
        step = len(heights) // cells
        scene = {"velocity": 0.1, "pressure": 1e6}
        return half_space.solve(modulus, heights[::step, ::step], (side, side), **scene)

    truth = slide(512).stress
    for cells in (32, 64, 128, 256):
        slide(cells)
        run = timed(partial(slide, cells), 3)
        off = abs(run.value.stress / truth - 1)
        rows.append((question, "em.HalfSpace, 32 to 256 cells a side", off, run.cpu))
    return rows


def fits() -> Rows:
    question = "a fit: shift factors of two sets of isotherms"
    rows = []
    for row in _recorded("fit_peers")["shifts"]:
        error = row["rms log10 a_T off the known"]
        if np.isfinite(error):
            method = f"{row['shifted by']}, {row['moduli']}"
            rows.append((question, method, error, row["seconds of one core"]))
    return rows


def _recorded(name: str) -> dict[str, Any]:
    return json.loads((RESULTS / f"{name}.json").read_text())


def main() -> None:
    warnings.simplefilter("ignore")
    one_core()
    record = heading("Run time against error", "one core, warm, processor time")
    rows = [*layers(), *lines(), *roads(), *fits()]
    columns = "question", "method", "error, relative", "processor time [s]"
    record["points"] = table(columns, rows)
    questions = list(dict.fromkeys(row[0] for row in rows))
    figure, panels = plt.subplots(2, 2, figsize=(11, 8.5), layout="constrained")
    for ax, question in zip(panels.ravel(), questions, strict=True):
        own = [row for row in rows if row[0] == question]
        for method in dict.fromkeys(row[1] for row in own):
            points = [row[2:] for row in own if row[1] == method]
            ax.loglog(*zip(*points, strict=True), "o-", label=method, markersize=5)
        ax.set_title(question, fontsize=10)
        fit = question.startswith("a fit")
        ax.set_xlabel("rms error of log10 a_T" if fit else "error, relative")
        low, high = ax.get_ylim()
        ax.set_ylim(low / 2, high * 2)
        ax.set_ylabel("processor time, one core [s]")
        ax.invert_xaxis()
        ax.grid(alpha=0.3)
        ax.legend(fontsize=7)
    name = "em.friction on a rough line over one plain sweep of its samples"
    record["verdicts"] = [verdict(name, RATIOS["a rough line"], 20)]
    save("time_error", record, figure)


if __name__ == "__main__":
    main()
