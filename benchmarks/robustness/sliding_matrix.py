"""Does a long slide end in steady friction? Every indenter over every foundation, under
a load and at a depth.

    python benchmarks/robustness/sliding_matrix.py [rtol ...]

`em.slide` slides each body far enough for the memory of its start to fade, exp(-20);
its last instant is held against `em.friction(..., model=em.Line())`, which solves the
steady passage by other means. Each tolerance must be met in mu, friction and normal
force or depth, and the estimate `error` must not be below the true error.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from common import heading, one_core, save, table, timed, verdict

one_core()
import elastomdr as em  # noqa: E402

SPEED, LOAD, LINE_LOAD = 0.5, 10.0, 2.0
HALF_SPACE = em.Foundation(4e6, [6e6], [2e-4])
LAYER = em.springs(em.Prony(1e6, [1.5e6], [2e-4], poisson=0.3), 4e-3)
R = np.linspace(0, 6e-3, 61)
X = np.arange(64) * 1e-5
BODIES = {
    "sphere": em.Sphere(0.01),
    "paraboloid": em.Paraboloid(0.01),
    "cone": em.Cone(0.1),
    "power law 1.5": em.PowerLaw(1.5, 1.2),
    "power law 4": em.PowerLaw(4.0, 2e7),
    "profile": em.Profile(R, R**2 / 0.02 + 20 * R**3),
    "profile, wavy": em.Profile(
        R, R**2 / 0.02 + 4e-6 * (1 - np.cos(2 * np.pi * R / 1e-3))
    ),
    "cylinder": em.Cylinder(0.01, 0.005),
    "rough line": em.RoughLine(
        X,
        4e-6 * np.cos(2 * np.pi * X / 6.4e-4)
        + 1e-6 * np.cos(6 * np.pi * X / 6.4e-4 + 1),
    ),
}
FOUNDATIONS = {"half-space": HALF_SPACE, "layer": LAYER}


def meets(material, body, control: str, rtol: float):
    """The slide, and the differences of mu and of what was not given, over the largest
    of the history.
    """
    rough = isinstance(body, em.RoughLine)
    load = LINE_LOAD if rough else LOAD
    steady = em.friction(
        material, body, velocity=SPEED, load=load, model=em.Line(), rtol=1e-6
    )
    given = {
        control: float(
            getattr(steady, "normal_force" if control == "load" else "depth")
        )
    }
    time = np.linspace(0, 0.016, 9)
    run = timed(
        lambda: em.slide(
            material, body, time=time, position=SPEED * time, rtol=rtol, **given
        )
    )
    slide = run.value
    other = "depth" if control == "load" else "normal_force"
    # As `em.slide` states its tolerance: against the largest of the history.
    gaps = [
        abs(float(getattr(slide, name)[-1]) - float(getattr(steady, name)))
        / float(np.nanmax(getattr(slide, name)))
        for name in ("mu", other)
    ]
    return slide, gaps, run.wall


def main() -> None:
    tolerances = [float(a) for a in sys.argv[1:]] or [1e-2, 1e-3]
    record = heading(
        "Long slides against steady friction",
        f"{SPEED} m/s, {LOAD} N or {LINE_LOAD} N/m; one branch",
    )
    rows, refused = [], []
    for name, body in BODIES.items():
        for where, material in FOUNDATIONS.items():
            for control in ("load", "depth"):
                for rtol in tolerances:
                    try:
                        slide, gaps, wall = meets(material, body, control, rtol)
                    except em.InputError as error:
                        refused.append((name, where, control, str(error)))
                        break
                    estimate = float(slide.error[-1]) / float(np.nanmax(slide.mu))
                    rows.append(
                        (
                            name,
                            where,
                            control,
                            rtol,
                            bool(slide.converged.all()),
                            *gaps,
                            estimate,
                            wall,
                        )
                    )
    columns = (
        "body",
        "foundation",
        "given",
        "rtol",
        "converged",
        "mu",
        "depth or F_N",
        "stated error",
        "first call [s]",
    )
    record["rows"] = table(columns, rows)
    record["refused"] = (
        table(("body", "foundation", "given", "refused"), refused) if refused else []
    )
    worst = max(max(row[5:7]) / row[3] for row in rows)
    below = max(row[5] / max(row[7], 1e-9) for row in rows)
    record["verdicts"] = [
        verdict("largest difference over its tolerance", worst, 1.0),
        verdict("true error of mu over its estimate, largest", below, 1.0),
        verdict("histories that did not converge", sum(not row[4] for row in rows), 0),
    ]
    save("robustness/sliding_matrix", record)


if __name__ == "__main__":
    main()
