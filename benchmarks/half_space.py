"""How near is the direction average to the half-space? Against three-dimensional
solutions of a sliding sphere.

    python benchmarks/half_space.py

Reference: a spectral boundary-element solution of steady sliding on a half-space of a
standard solid, grid 1.6e-4 m, some 4e-5 m, periodic cell 0.08 to 0.16 m (the project's
oracles `sphere3D_BEM_SLS_*`; good to about 1.5%, 3% at E_1/E_inf = 9), and the limit of
weak loss (`sphere3D_SLS_weakloss_v2.0`), an integral over the loss modulus with the
structure of Persson 2010, good to 1e-5. Writes the table of the documentation,
results/half_space.md.

Then the price of a velocity: `em.friction` for 64 and for 1024 velocities against
`em.reference.half_space_sliding` on the coarsest grid whose error is below 1%, both on
one core, warm.
"""

from typing import Any

import numpy as np
from common import RESULTS, heading, one_core, plt, save, table, timed, verdict

import elastomdr as em

# E_inf [Pa] (as E*), tau [s], R [m], F_N [N]
EQUILIBRIUM, TIME, RADIUS, LOAD = 4e6, 1e-3, 0.01, 10.0
SHAPE = em.Paraboloid(RADIUS)
THREE_D = {  # (E_1/E_inf, v [m/s]): (mu in 3D, its relative uncertainty)
    (0.5, 1.0): (0.02444, 0.015),
    (0.5, 15.0): (0.00769, 0.015),
    (3.0, 0.1): (0.02643, 0.015),
    (3.0, 1.0): (0.07147, 0.015),
    (3.0, 10.0): (0.01475, 0.015),
    (9.0, 0.1): (0.06731, 0.03),
    (9.0, 1.0): (0.071, 0.03),
}
WEAK = 1e-7  # E_1/E_inf that stands for the weak-loss limit
# v, mu E_inf/E_1 in 3D, and on the line
WEAK_LOSS = (2.0, 0.06640620163955166, 0.1069025576568546)
COLUMNS = (
    "E_1/E_inf",
    "v [m/s]",
    "mu in 3D",
    "uncertainty [%]",
    "direction average",
    "average off by [%]",
    "bare line",
    "line off by [%]",
)


PRICED = 9.0  # E_1/E_inf
SPEEDS = np.array([0.23, 0.8, 2.8])  # about its peak [m/s]
SWEEPS = (64, 1024)  # velocities of a sweep
# cells along a side; that of the truth; error to be met
GRIDS, FINE, WANTED = (32, 48, 64), 96, 0.01


def friction(ratio: float, velocity: float, model: Any) -> float:
    law = em.Foundation(EQUILIBRIUM, [ratio * EQUILIBRIUM], [TIME])
    return float(
        em.friction(law, SHAPE, velocity=velocity, load=LOAD, model=model, rtol=1e-8).mu
    )


def compare(ratio: float, velocity: float, truth: float, uncertainty: float) -> tuple:
    averaged, bare = (
        friction(ratio, velocity, em.Averaged(corrected=False)),
        friction(ratio, velocity, em.Line()),
    )
    off = 100 * (averaged / truth - 1), 100 * (bare / truth - 1)
    return ratio, velocity, truth, 100 * uncertainty, averaged, off[0], bare, off[1]


def markdown(rows: list[tuple]) -> str:
    """The table as the documentation shows it."""
    lines = [
        (
            "| E₁/E∞ | v [m/s] | μ, 3D solution | uncertainty | direction average | "
            "off by | bare line | off by |"
        ),
        "|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for ratio, velocity, truth, uncertainty, averaged, off, bare, bare_off in rows:
        weak = ratio == WEAK
        name, scale = ("→ 0 (μ E∞/E₁)", WEAK) if weak else (f"{ratio:g}", 1.0)
        numbers = f"{truth / scale:.5g} | {uncertainty:.2g}% | {averaged / scale:.5g}"
        digits = 3 if weak else 1
        lines.append(
            f"| {name} | {velocity:g} | {numbers} | {off:+.{digits}f}% | "
            f"{bare / scale:.5g} | {bare_off:+.1f}% |"
        )
    return "\n".join(lines) + "\n"


def price() -> dict[str, object]:
    """CPU time of one velocity at 1% error, ours and the reference's."""
    law = em.Foundation(EQUILIBRIUM, [PRICED * EQUILIBRIUM], [TIME])

    def ours(velocity: np.ndarray) -> em.FrictionCurve:
        return em.friction(
            law, SHAPE, velocity=velocity, load=LOAD, model=em.Averaged(), rtol=WANTED
        )

    def slow(points: int) -> em.FrictionCurve:
        return em.reference.half_space_sliding(
            law, SHAPE, velocity=SPEEDS, load=LOAD, points=points
        )

    exact, rows = slow(FINE).mu, []
    price = []
    for count in SWEEPS:
        sweep = np.geomspace(1e-2, 1e2, count)
        ours(sweep)
        price.append(timed(lambda sweep=sweep: ours(sweep), repeats=20).cpu / count)
        off, name = (
            np.abs(ours(SPEEDS).mu / exact - 1).max(),
            f"em.friction, corrected average, each of {count}",
        )
        rows.append((name, 100 * off, 1e6 * price[-1], price[-1] / price[0]))
    for points in GRIDS:
        slow(points)
        run = timed(lambda points=points: slow(points), repeats=2)
        off, cost = np.abs(run.value.mu / exact - 1).max(), run.cpu / SPEEDS.size
        rows.append(
            (
                f"half-space, {points} by {points} cells",
                100 * off,
                1e6 * cost,
                cost / price[0],
            )
        )
    columns = (
        "solver",
        "largest error at 3 speeds [%]",
        "CPU per velocity [us]",
        f"over the one of {SWEEPS[0]}",
    )
    record = table(columns, rows)
    enough = [row[2] for row in rows[len(SWEEPS) :] if row[1] <= 100 * WANTED]
    slowest = 1e-6 * enough[0] if enough else float("nan")
    verdicts = [
        verdict(
            f"half-space over em.friction at 1 % error, {count} velocities",
            slowest / fast,
            1e4,
            least=True,
        )
        for count, fast in zip(SWEEPS, price, strict=True)
    ]
    return {"price": record, "verdicts": verdicts}


def main() -> None:
    one_core()
    record = heading(
        (
            "Half-space: the direction average and the bare line against "
            "three-dimensional solutions of sliding"
        ),
        (
            f"standard solid, E_inf = {EQUILIBRIUM:g} Pa (E*), tau = {TIME:g} s; "
            f"paraboloid, R = {RADIUS:g} m, {LOAD:g} N"
        ),
        f"first row: the limit of weak loss, computed at E_1/E_inf = {WEAK:g}",
    )
    velocity, weak_3d, weak_line = WEAK_LOSS
    rows = [compare(WEAK, velocity, WEAK * weak_3d, 1e-5)]
    rows += [compare(*key, *value) for key, value in THREE_D.items()]
    record["table"] = table(COLUMNS, rows)
    inside = sum(abs(row[5]) <= row[3] for row in rows)
    largest = max(rows, key=lambda row: abs(row[5]))
    print(
        f"\n  direction average within the reference's own uncertainty: {inside} "
        f"of {len(rows)}"
    )
    print(
        f"  largest deviation: {largest[5]:+.2f}% at E_1/E_inf = {largest[0]:g}, "
        f"{largest[1]:g} m/s"
    )
    print(
        "  bare line in the limit of weak loss, against its own formula: "
        f"{rows[0][6] / (WEAK * weak_line) - 1:+.1e}"
    )
    print(
        f"\n  Price of a velocity, E_1/E_inf = {PRICED:g}; error against {FINE} by "
        f"{FINE} cells"
    )
    record |= price()
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "half_space.md").write_text(markdown(rows), encoding="utf-8")

    figure, axes = plt.subplots(1, 3, figsize=(11, 3.8), layout="constrained")
    sweep = np.geomspace(1e-2, 1e2, 60)
    for ax, ratio in zip(axes, (0.5, 3.0, 9.0), strict=True):
        law = em.Foundation(EQUILIBRIUM, [ratio * EQUILIBRIUM], [TIME])
        for model, style, label in (
            (em.Averaged(corrected=False), "C0-", "direction average"),
            (em.Line(), "C1--", "bare line"),
        ):
            curve = em.friction(law, SHAPE, velocity=sweep, load=LOAD, model=model)
            ax.semilogx(sweep, curve.mu, style, label=label)
        points = np.array(
            [(v, mu, mu * u) for (r, v), (mu, u) in THREE_D.items() if r == ratio]
        )
        ax.errorbar(*points.T, fmt="ko", ms=5, capsize=3, label="3D solution")
        ax.set(title=f"E_1/E_inf = {ratio:g}", xlabel="velocity [m/s]", ylim=(0, None))
        ax.grid(color="0.92")
    axes[0].set_ylabel("mu")
    axes[2].legend()
    save("half_space", record, figure)


if __name__ == "__main__":
    main()
