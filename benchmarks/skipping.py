"""What does skipping save, and what does it cost? 40 branches over 24 decades, with and
without.

    python benchmarks/skipping.py

`skip=True` (the default) turns branches that are too slow or too fast for a scene into
springs and dashpots, at a stated cost, and lets all velocities share one curve for the
direction average. `skip=False` computes everything. Where the line solutions are as
many either way, the scene shows the branches alone; the last scene, which needs all its
16 branches, shows the shared curve alone. Reference where there is no average: the
closed form of `exact.py` in many digits, with all 40 branches.
"""

from typing import Any

import exact
import numpy as np
import scene
from common import heading, one_core, plt, save, table, timed, verdict

import elastomdr as em

TIMES = np.geomspace(1e-12, 1e12, 40)  # tau_k [s]
MODULI = scene.EQUILIBRIUM * (TIMES / TIMES[-1]) ** -0.12  # E_k [Pa]
BROAD = em.Foundation(scene.EQUILIBRIUM, MODULI, TIMES)
SHAPE = em.Paraboloid(scene.RADIUS)
SWEEP = np.geomspace(1e-6, 1e4, 64)  # v [m/s]
SCENES: dict[str, tuple[em.Foundation, np.ndarray, dict[str, Any]]] = {
    "one velocity, bare line": (BROAD, np.array([1e-2]), {"model": em.Line()}),
    "one velocity, averaged": (
        BROAD,
        np.array([1e-2]),
        {"model": em.Averaged(corrected=False)},
    ),
    "10 decades, bare line": (BROAD, SWEEP, {"model": em.Line()}),
    "10 decades, averaged": (BROAD, SWEEP, {"model": em.Averaged(corrected=False)}),
    "10 decades, averaged, 16 branches": (
        scene.FOUNDATION,
        scene.VELOCITY,
        {"model": em.Averaged(corrected=False)},
    ),
}
RTOLS = (1e-3, 1e-6)
COLUMNS = (
    "scene",
    "rtol",
    "branches kept",
    "line solutions",
    "of",
    "skip [ms]",
    "no skip [ms]",
    "ratio",
    "change of mu",
    "stated cost",
    "true error",
)


def compare(name: str, rtol: float) -> tuple:
    """One row: both ways of one scene, in processor time, and what skipping changes."""
    foundation, velocity, options = SCENES[name]
    results = {}
    for skip in (True, False):

        def call(skip=skip) -> em.FrictionCurve:
            return em.friction(
                foundation,
                SHAPE,
                velocity=velocity,
                load=scene.LOAD,
                rtol=rtol,
                skip=skip,
                **options,
            )

        call()  # compiles
        results[skip] = timed(call, 7)
    (lean, _, fast), (full, _, slow) = results[True], results[False]
    how = lean.plan.condensation
    truth = np.full(velocity.size, np.nan)
    if options.get("model") == em.Line():
        line = exact.Line(
            exact.paraboloid(scene.RADIUS),
            scene.EQUILIBRIUM,
            tuple(MODULI),
            tuple(TIMES),
        )
        truth = np.array(
            [
                exact.slide(line, v, load=scene.LOAD, leading=scene.LEADING).mu
                for v in velocity
            ]
        )
    return (
        name,
        rtol,
        f"{len(how.kept)} of {how.branches}",
        lean.plan.solutions,
        full.plan.solutions,
        1e3 * fast,
        1e3 * slow,
        slow / fast,
        np.max(np.abs(lean.mu / full.mu - 1)),
        how.cost,
        np.max(np.abs(lean.mu / truth - 1)),
    )


def draw(rows: list[tuple]):
    figure, ax = plt.subplots(figsize=(8, 4), layout="constrained")
    for i, rtol in enumerate(RTOLS):
        chosen = [row for row in rows if row[1] == rtol]
        place = np.arange(len(chosen)) + 0.36 * (i - 0.5)
        bars = ax.barh(place, [row[7] for row in chosen], 0.34, label=f"rtol {rtol:g}")
        ax.bar_label(bars, [f"{row[7]:.1f}" for row in chosen], padding=2, fontsize=8)
    ax.set_yticks(range(len(SCENES)), list(SCENES))
    ax.invert_yaxis()
    ax.axvline(1, color="0.6", lw=1)
    ax.set(
        xlabel="processor time without skipping over that with it",
        title="What skipping saves",
    )
    ax.legend()
    return figure


def main() -> None:
    one_core()
    record = heading(
        "Skipping: processor time on one core, with and without, and the change of mu",
        f"{TIMES.size} branches, tau = {TIMES[0]:g} ... {TIMES[-1]:g} s, E_inf = "
        f"{scene.EQUILIBRIUM:g} Pa, E_k = E_inf (tau_k/{TIMES[-1]:g} s)^-0.12",
        f"paraboloid, R = {scene.RADIUS:g} m, {scene.LOAD:g} N, {SWEEP.size} "
        f"velocities, {SWEEP[0]:g} ... {SWEEP[-1]:g} m/s, or 0.01 m/s alone; the last "
        "scene is that of steady_sliding.py",
    )
    rows = [compare(name, rtol) for rtol in RTOLS for name in SCENES]
    record["scenes"] = table(COLUMNS, rows)
    # the same line solutions either way: only branches are left out
    bare = [row for row in rows if row[3] == row[4]]
    kept = all(row[8] <= row[9] + 1e-13 for row in bare)
    print(
        "\n  change of mu within the stated cost wherever only branches are left "
        f"out: {'yes' if kept else 'NO'}"
    )
    within = all(row[8] <= row[1] for row in rows)
    print(f"  change of mu within rtol everywhere: {'yes' if within else 'NO'}")
    record |= {"within stated cost": kept, "within rtol": within}
    whole = next(row for row in rows if row[0] == "10 decades, averaged")
    record["verdicts"] = [
        verdict(
            "scenes in which skipping changes mu by more than rtol",
            sum(row[8] > row[1] for row in rows),
            0,
        ),
        verdict(
            f"time without skipping over that with it, {whole[0]}, rtol {whole[1]:g}",
            whole[7],
            1.5,
            least=True,
        ),
    ]
    save("skipping", record, draw(rows))


if __name__ == "__main__":
    main()
