"""Run time against error, one figure for each question: rolling on a layer, a rough
line, a road, a fit. That of smooth friction is in `steady_sliding.py`.

    python benchmarks/time_error.py

The first two are computed here, 64 velocities each at tolerances from coarse to fine,
their errors from the finest. Those of roads and fits stand in the records of
`roads.py`, `rough_fit.py` and `fit_peers.py`. Processor time of one core, warm.
"""

import json
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from common import RESULTS, heading, one_core, plt, save, table, timed

import elastomdr as em

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
    question = "a rough line: 64 velocities, 16,384 samples, 20 branches"
    rubber = em.Prony(1e6, np.geomspace(1e8, 1e6, 20), np.logspace(-8, 3, 20))
    line = ROAD.line(seed=1, samples=16384)

    def slide(rtol: float) -> Any:
        scene = {"velocity": VELOCITY, "load": 200.0}
        return em.friction(rubber, line, **scene, rtol=rtol).mu

    rows, _ = _converging(question, "em.friction", slide, (1e-2, 1e-3, 1e-4, 1e-6))
    sweeps = [
        row["C sweep, one core [s]"] for row in _recorded("rough_sliding")["loads"]
    ]
    plain = "ten plain sweeps in C, no search for loads"
    return [*rows, (question, plain, np.nan, 10 * float(np.mean(sweeps)))]


TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8)


def roads() -> Rows:
    """Errors of the models against maps in three dimensions, at 1 to 5 % contact."""
    question = "a road: one velocity, error against three dimensions"
    recorded, judged = _recorded("roads"), _recorded("rough_fit")
    rows = []
    for name in ("Multiscale", "Persson"):
        error = next(
            row["rms"]
            for row in judged[name.lower()]
            if row.get(name) == "contact 1% to 5%"
        )
        seconds = np.mean(
            [x["a point of 64 [ms]"] for x in recorded["closed"] if x["model"] == name]
        )
        rows.append((question, f"em.{name}", float(error), float(seconds) / 1e3))
    # what the errors are counted from: a line across
    cells = [x["a velocity more [s]"] for x in recorded["cells"] if x["cells"] == 512]
    rows.append((question, "em.HalfSpace, 512 x 512", np.nan, float(np.mean(cells))))
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
            errors, seconds = zip(*points, strict=True)
            if np.isnan(errors).all():
                ax.axhline(seconds[0], color="0.5", label=method)
                continue
            ax.loglog(errors, seconds, "o-", label=method, markersize=5)
        ax.set_title(question, fontsize=10)
        fit = question.startswith("a fit")
        ax.set_xlabel("rms error of log10 a_T" if fit else "error, relative")
        low, high = ax.get_ylim()
        ax.set_ylim(low / 2, high * 2)
        ax.set_ylabel("processor time, one core [s]")
        ax.invert_xaxis()
        ax.grid(alpha=0.3)
        road = question.startswith("a road")
        ax.legend(fontsize=7, loc="center" if road else "best")
    save("time_error", record, figure)


if __name__ == "__main__":
    main()
