"""Energy audits: work in against stored and dissipated energy, in every quasi-static
case.

    python benchmarks/energy.py

Indentation: work is int F dd of the body (or int q du of its elements in closed form
under a given depth), stored is in the springs, heat is summed over the dashpots' own
forces and the modes of free elements; under a load in steps it is what the elements
received less what they hold. Shear: springs and slip, summed as the work is
(`tests/transient/test_shear.py` holds them against closed forms). Traction: F_x xi v against int
mu q times the velocity of slip, in closed form. Sliding: int F_N dd + F_x dX over the
steps of one march against what the elements received; that is of second order in the
step, and is listed with its slope and its limit.
"""

import jax
import jax.numpy as jnp
import numpy as np
from common import heading, one_core, save, table, timed, verdict

one_core()
import elastomdr as em  # noqa: E402
from elastomdr.element.body_over_line import indenter  # noqa: E402
from elastomdr.element.moving_body import MotionScene  # noqa: E402
from elastomdr.material.relaxation import Relaxation  # noqa: E402
from elastomdr.surface.lines import SingleLine  # noqa: E402
from elastomdr.transient.march import run  # noqa: E402
from elastomdr.transient.problem import Steps  # noqa: E402

SOLID, BALL = em.Foundation(1.0, [1.0, 3.0], [0.02, 0.5]), em.Paraboloid(1.0)
DAMPED = em.Foundation(1.0, [3.0], [0.5], 0.2)
TIME = np.linspace(0, 3, 13)


def indentation() -> list[dict]:
    depth = np.interp(TIME, [0, 1, 1.5, 2, 3], [0, 0.01, 0.002, 0.004, 0.015])
    falling = np.interp(TIME, [0, 1, 2, 3], [0, 3e-3, 0, 6e-3])
    stepped = np.interp(TIME, [0, 1, 2, 3], [2e-3, 3e-3, 1e-3, 6e-3])
    cases = [
        ("depth: shrinks, grows again", SOLID, {"depth": depth, "rtol": 1e-8}),
        ("depth: the same with a dashpot", DAMPED, {"depth": depth, "rtol": 1e-4}),
        ("load: grows", SOLID, {"load": 1e-3 * (1 + TIME), "rtol": 1e-8}),
        (
            "load: grows, with a dashpot",
            DAMPED,
            {"load": 1e-3 * (1 + TIME), "rtol": 1e-8},
        ),
        ("load: to zero and again", SOLID, {"load": falling, "rtol": 1e-8}),
        ("load: put on, shrinks, grows", SOLID, {"load": stepped, "rtol": 1e-8}),
    ]
    rows = []
    for name, material, given in cases:
        run = timed(lambda m=material, g=given: em.indent(m, BALL, time=TIME, **g))
        found = run.value
        missing = (
            np.abs(found.work - found.stored - found.dissipated).max()
            / found.work.max()
        )
        rows.append(
            (name, f"{given['rtol']:g}", bool(found.converged.all()), missing, run.wall)
        )
    return table(
        ("indentation", "rtol", "converged", "missing of the work", "first call [s]"),
        rows,
    )


def shear() -> list[dict]:
    time = np.linspace(0, 2, 401)
    u = 1e-4 * np.interp(time, [0, 0.7, 1.3, 2], [0, 1, -0.5, 0.8])
    load = 20 * np.interp(time, [0, 1, 2], [0.5, 1, 0.4])
    rows = []
    for name, friction in (("partial slip", 0.5), ("no slip", np.inf)):
        found = em.shear(
            em.Foundation(4e6, [], []),
            em.Paraboloid(0.01),
            time=time,
            displacement=u,
            friction=friction,
            load=load,
            tangential=em.Foundation(8e6 / 3, [], []),
        )
        scale = np.abs(found.work).max()
        rows.append(
            (name, np.abs(found.work - found.stored - found.slip_loss).max() / scale)
        )
    return table(("shear, elastic, oblique", "missing of the work"), rows)


def sliding() -> tuple[list[dict], float]:
    law = Relaxation(*map(jnp.asarray, (4e6, np.array([12e6]), np.array([1e-3]), 0.0)))
    rows = []
    signed: list[float] = []
    for n in (320, 640, 1280, 2560, 5120, 10240):
        spacing, steps = 8e-3 / n, n // 2
        x = np.linspace(0, 4e-3, steps + 1)[1:]
        h, load = (
            np.full(steps, spacing),
            np.interp(x, [0, 2e-3, 4e-3], [10.0, 10.0, 5.0]),
        )
        h[0], x[0] = 1e-12, 0.0
        h, x, load = (
            np.append(a, np.repeat(a[-1:], -steps % 64)) for a in (h, x, load)
        )
        with jax.enable_x64(True):
            surface = indenter(
                SingleLine(em.Paraboloid(0.01)),
                -2.5e-3 + 0.3 * spacing,
                spacing,
                n,
                1.0,
            )
            given = Steps(*map(jnp.asarray, (h, x, load)))
            seen, _ = run(MotionScene(law, surface), given, balance=False)
        normal, drag, depth, work = (
            np.asarray(a) for a in (seen.normal, seen.drag, seen.depth, seen.work)
        )
        done = (normal[1:] + normal[:-1]) @ np.diff(depth) / 2 + (
            drag[1:] + drag[:-1]
        ) @ np.diff(x) / 2
        signed.append((done - (work[-1] - work[0])) / work[-1])
        limit = abs(4 * signed[-1] - signed[-2]) / 3 if len(signed) > 1 else np.nan
        rows.append((n, abs(signed[-1]), limit))
    columns = (
        "elements, sliding on a partial contact",
        "missing of the work",
        "extrapolated from this and the last",
    )
    shown = table(columns, rows)
    return shown, float(
        np.polyfit(
            np.log([row[0] for row in rows]), np.log([row[1] for row in rows]), 1
        )[0]
    )


def main() -> None:
    record = heading(
        "Energy audits",
        "paraboloid; standard solid, two branches, one branch with a dashpot",
        "one core",
    )
    record["indentation"], record["shear"] = indentation(), shear()
    record["sliding"], slope = sliding()
    worst = max(
        row["missing of the work"] for row in record["indentation"] + record["shear"]
    )
    record["verdicts"] = [
        verdict("indentation and shear, worst", worst, 1e-8),
        verdict("sliding, slope against elements", slope, -1.6),
        verdict(
            "sliding, extrapolated",
            record["sliding"][-1]["extrapolated from this and the last"],
            1e-8,
        ),
    ]
    save("energy", record)


if __name__ == "__main__":
    main()
