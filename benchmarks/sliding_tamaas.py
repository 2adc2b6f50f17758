"""A ball that slides in steady state: `em.friction` beside tamaas stepped through time
until nothing changes.

    python benchmarks/sliding_tamaas.py
    (pip install tamaas; without it there is nothing to compare)

Paraboloid on a standard solid of E_1/E_inf = 9 near the peak of its friction, load
given. tamaas solves the contact of a periodic half-space by conjugate gradients; the
branch is advanced around it by implicit Euler, p = K [E u + f], K the elastic operator
of unit modulus (as in `creep_tamaas.py`), and the ball moves on by one cell per step,
until mu of a contact length differs by less than half a per cent from that of the one
before. Its error is of first order in cells and steps, and it does not get to 1 % here.
The truth is `em.reference.half_space_sliding` on 96 by 96 cells. All on one core, warm.
"""

import importlib.util
from typing import Any

import numpy as np
from common import heading, one_core, save, table, timed, verdict

one_core()
import elastomdr as em  # noqa: E402

tamaas: Any = (
    importlib.import_module("tamaas") if importlib.util.find_spec("tamaas") else None
)

# E* [Pa], s, m, N, m/s
RELAXED, BRANCH, TIME, RADIUS, LOAD, SPEED = 4e6, 3.6e7, 1e-3, 0.01, 10.0, 0.8
RUBBER, BALL = em.Foundation(RELAXED, [BRANCH], [TIME]), em.Paraboloid(RADIUS)
SIZE = np.cbrt(0.75 * RADIUS * LOAD / RELAXED)  # the largest contact radius [m]
CELL = 8 * SIZE
STEADY, MOST = 0.005, 2000  # change of mu per contact length; steps


def slide(n: int) -> tuple[float, int]:
    """mu in steady state by tamaas on n by n cells, and the steps it took."""
    x = (np.arange(n) - n / 2) * CELL / n
    height = -(x[:, None] ** 2 + x**2) / (2 * RADIUS)
    slope = -x[:, None] / RADIUS * np.ones(n)
    solved = tamaas.Model(tamaas.model_type.basic_2d, [CELL, CELL], [n, n])
    solved.nu, solved.E = 0.5, 0.75  # E* = 1
    dt, lengths = CELL / n / SPEED, max(2, int(n / 8))
    left = TIME / (TIME + dt)
    stiffness = RELAXED + left * BRANCH
    u, f, found = np.zeros((n, n)), np.zeros((n, n)), []
    for step in range(MOST):
        past = left * (f - BRANCH * u)
        tamaas.PolonskyKeerRey(
            solved, stiffness * np.roll(height, step, 0) + past, 1e-8
        ).solve(LOAD / CELL**2)
        change = (np.asarray(solved.displacement).reshape(n, n) - past) / stiffness - u
        f, u = left * (f + BRANCH * change), u + change
        pressure = np.asarray(solved.traction).reshape(n, n)
        found.append(-(pressure * np.roll(slope, step, 0)).mean() / (LOAD / CELL**2))
        if step > 3 * lengths:
            now, before = (
                np.mean(found[-lengths:]),
                np.mean(found[-2 * lengths : -lengths]),
            )
            if abs(now - before) < STEADY * abs(now):
                break
    return float(np.mean(found[-lengths:])), len(found)


def main() -> None:
    record = heading(
        "Steady sliding of a ball beside tamaas",
        (
            f"paraboloid, R = {RADIUS:g} m, F = {LOAD:g} N, E* = {RELAXED:g} Pa, E_1 "
            f"= {BRANCH:g} Pa, tau = {TIME:g} s"
        ),
        f"v = {SPEED:g} m/s, cell {CELL / SIZE:g} contact radii wide",
        f"tamaas {tamaas.__version__}" if tamaas else "tamaas is not installed",
    )
    truth = float(
        em.reference.half_space_sliding(
            RUBBER, BALL, velocity=SPEED, load=LOAD, points=96
        ).mu
    )
    many = SPEED * np.geomspace(0.1, 10, 64)

    def ours() -> em.FrictionCurve:
        return em.friction(
            RUBBER, BALL, velocity=many, load=LOAD, model=em.Averaged(), rtol=1e-3
        )

    ours()
    mu = float(
        em.friction(
            RUBBER, BALL, velocity=SPEED, load=LOAD, model=em.Averaged(), rtol=1e-3
        ).mu
    )
    price = timed(ours, 7).cpu / many.size
    rows = [("em.friction, each of 64 velocities", mu, mu / truth - 1, 0, price, 1.0)]
    if tamaas:
        tamaas.set_log_level(tamaas.LogLevel.warning)
        for n in (32, 64, 128):
            slid = timed(lambda n=n: slide(n))
            found, steps = slid.value
            rows.append(
                (
                    f"tamaas, {n} by {n} cells",
                    found,
                    found / truth - 1,
                    steps,
                    slid.cpu,
                    slid.cpu / price,
                )
            )
    columns = (
        "method",
        "mu",
        "off three dimensions",
        "steps",
        "processor time of a velocity [s]",
        "over elastomdr's",
    )
    record["sliding"] = table(columns, rows)
    if not tamaas:
        return  # half a comparison would replace the whole one that is recorded
    record["verdicts"] = [
        verdict(
            "tamaas, finest, stepped to steady state, over em.friction",
            rows[-1][-1],
            1000.0,
            least=True,
        ),
        verdict("em.friction off three dimensions", abs(rows[0][2]), 0.01),
    ]
    save("sliding_tamaas", record)


if __name__ == "__main__":
    main()
