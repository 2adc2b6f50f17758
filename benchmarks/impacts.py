"""How long do 10,000 impacts take? A grid of speed, damping and material in one call.

    python benchmarks/impacts.py

For 1, 3 and 10 branches and a dashpot: wall and processor time of one warm call,
compile time apart, and the error of the restitution against the same call at rtol 1e-9
on a sample of the grid.
"""

import time

import numpy as np
from common import heading, plt, save, table, timed, verdict

import elastomdr as em

RADIUS, MASS = 0.01, 0.02  # m, kg
SPEED = np.geomspace(0.01, 10.0, 100)  # m/s
SOLIDS, DAMPINGS = 10, 10


def materials(branches: int) -> list[em.Foundation]:
    """10 stiffnesses times 10 dashpots, E* in Pa and Pa s."""
    times, moduli = (
        np.geomspace(1e-4, 1e-1, branches),
        np.full(branches, 3e6 / branches),
    )
    return [
        em.Foundation(1e6 * (1 + i), moduli, times, 20.0 * j)
        for i in range(SOLIDS)
        for j in range(DAMPINGS)
    ]


def main() -> None:
    record = heading(
        "10,000 impacts in one call: 100 speeds, 10 stiffnesses, 10 dashpots",
        (
            f"paraboloid, R = {RADIUS:g} m, {MASS:g} kg, {SPEED[0]:g} ... "
            f"{SPEED[-1]:g} m/s, rtol 1e-6"
        ),
    )
    rows = []
    figure, ax = plt.subplots(figsize=(5.6, 4.0), layout="constrained")
    for branches in (1, 3, 10):
        grid = materials(branches)

        def call(grid=grid, **options):
            return em.impact(
                grid,
                em.Paraboloid(RADIUS),
                mass=MASS,
                velocity=options.pop("speed", SPEED),
                **options,
            )

        start = time.perf_counter()
        call()
        first = time.perf_counter() - start
        found, wall, cpu = timed(call, 3)
        exact = call(grid[::7], speed=SPEED[::9], rtol=1e-9)
        off = np.abs(found.restitution[::7, ::9] - exact.restitution).max()
        ax.semilogx(
            SPEED,
            found.restitution[DAMPINGS // 2],
            label=f"{branches} branches" if branches > 1 else "1 branch",
        )
        rows.append(
            (
                branches,
                found.restitution.size,
                first,
                wall,
                cpu,
                off,
                float(found.error.max()),
            )
        )
    columns = (
        "branches",
        "impacts",
        "first call [s]",
        "warm [s]",
        "processor [s]",
        "error",
        "largest estimate",
    )
    record["impacts"] = table(columns, rows)
    record["verdicts"] = [
        verdict(f"10,000 impacts, {row[0]} branches", row[3], 2.0, " s") for row in rows
    ]
    ax.set(
        xlabel="Speed before impact [m/s]",
        ylabel="Restitution [-]",
        title="Impacts, E* = 1 MPa and branches of 3 MPa, 100 Pa s",
    )
    ax.legend(frameon=False)
    ax.grid(True, color="#dddddd", linewidth=0.5)
    save("impacts", record, figure)


if __name__ == "__main__":
    main()
