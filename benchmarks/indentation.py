"""Indentation: creep of a ball, unloading, and loads that fall, against exact
solutions; cost of each, and of many.

    python benchmarks/indentation.py

Creep: paraboloid, three branches, step load, 200 output times; exact: a^3 = (3/4) R F
J(t), d = a^2/R (Lee & Radok). Triangle of depth: Ting's solution at one instant of the
way back. Load that falls and rises again: error against the closed form that holds
again once the contact is wider than ever before, against steps per interval. Histories:
many triangles in one call. Times are of warm calls; the first call, which compiles, is
listed apart.
"""

import numpy as np
from common import heading, one_core, plt, save, table, timed, verdict

one_core()
import elastomdr as em  # noqa: E402

RUBBER = em.Foundation(0.5, [2.0, 1.0, 0.4], [1e-3, 0.1, 10.0])
SOLID, BALL = em.Foundation(1.0, [3.0], [0.5]), em.Paraboloid(1.0)
TING = 0.001043828585770497  # force of the triangle at 1.25 s


def creep() -> list[dict]:
    time = np.append(0.0, np.geomspace(1e-4, 50.0, 199))
    rows = []
    for name, shape in (("paraboloid", em.Paraboloid(2.0)), ("sphere", em.Sphere(2.0))):

        def call(shape=shape):
            return em.indent(RUBBER, shape, time=time, load=0.02)

        first = timed(call)
        warm = timed(call, 20)
        exact = np.cbrt(0.75 * 2.0 * 0.02 * RUBBER.creep_compliance(time)) ** 2 / 2.0
        off = (
            np.abs(warm.value.depth / exact - 1).max()
            if name == "paraboloid"
            else np.nan
        )
        rows.append((name, off, 1e3 * warm.wall, 1e3 * warm.cpu, first.wall))
    return table(
        (
            "creep of a",
            "largest error of depth",
            "warm [ms]",
            "warm, CPU [ms]",
            "first call [s]",
        ),
        rows,
    )


def triangle() -> list[dict]:
    rows = []
    for count in (9, 25, 49, 97, 201):
        time = np.linspace(0.0, 2.0, count)
        depth = 0.01 * np.minimum(time, 2 - time)

        def call(time=time, depth=depth):
            return em.indent(SOLID, BALL, time=time, depth=depth)

        first, warm = timed(call), timed(call, 5)
        off = abs(warm.value.force[np.argmin(abs(time - 1.25))] / TING - 1)
        rows.append(
            (count, off, float(warm.value.error.max()), 1e3 * warm.wall, first.wall)
        )
    return table(
        ("instants", "error of force", "estimated", "warm [ms]", "first call [s]"), rows
    )


def load_steps() -> list[dict]:
    time = np.linspace(0.0, 3.0, 13)
    load = np.interp(time, [0, 1, 2, 3], [0, 3e-3, 0, 6e-3])
    # A(t) of a load linear in pieces, by the creep function's own integral in closed
    # form.
    area = 0.0
    for t0, t1, rate in ((0.0, 1.0, 3e-3), (1.0, 2.0, -3e-3), (2.0, 3.0, 6e-3)):
        nodes, weights = np.polynomial.legendre.leggauss(40)
        s = t0 + (t1 - t0) * (nodes + 1) / 2
        area += rate * (t1 - t0) / 2 * weights @ SOLID.creep_compliance(3.0 - s)
    exact = (0.75 * area) ** (2 / 3)
    rows = []
    for rtol in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7):

        def call(rtol=rtol):
            return em.indent(SOLID, BALL, time=time, load=load, rtol=rtol)

        first, warm = timed(call), timed(call, 3)
        rows.append(
            (
                rtol,
                abs(warm.value.depth[-1] / exact - 1),
                float(warm.value.error[-1]),
                1e3 * warm.wall,
                first.wall,
            )
        )
    return table(
        ("rtol", "error of depth", "estimated", "warm [ms]", "first call [s]"), rows
    )


def many() -> list[dict]:
    time = np.linspace(0.0, 2.0, 15)
    rows = []
    for count in (64, 1024):
        depth = np.linspace(0.001, 0.02, count)[:, None] * np.minimum(time, 2 - time)

        def call(depth=depth):
            return em.indent(SOLID, BALL, time=time, depth=depth)

        first, warm = timed(call), timed(call, 2)
        rows.append((count, time.size, warm.wall, 1e3 * warm.wall / count, first.wall))
    return table(
        ("histories", "instants", "warm [s]", "per history [ms]", "first call [s]"),
        rows,
    )


def main() -> None:
    record = heading(
        "Indentation", "paraboloid, standard solid and three branches", "one core"
    )
    record["creep"] = creep()
    record["triangle"] = triangle()
    record["load"] = load_steps()
    record["many"] = many()
    record["verdicts"] = [
        verdict(
            "creep of a paraboloid, depth error",
            record["creep"][0]["largest error of depth"],
            1e-6,
        ),
        verdict(
            "creep of a paraboloid, 200 times",
            record["creep"][0]["warm [ms]"],
            10.0,
            " ms",
        ),
        verdict(
            "creep of a sphere, 200 times", record["creep"][1]["warm [ms]"], 10.0, " ms"
        ),
        verdict(
            "Ting, force",
            max(row["error of force"] for row in record["triangle"]),
            1e-8,
        ),
    ]
    figure, ax = plt.subplots(figsize=(5.6, 4.0), layout="constrained")
    for key, name in (("error of depth", "true"), ("estimated", "estimated")):
        ax.loglog(
            [row["warm [ms]"] for row in record["load"]],
            [row[key] for row in record["load"]],
            "o-",
            label=name,
        )
    ax.set(
        xlabel="Time of a warm call [ms]",
        ylabel="Relative error of depth [-]",
        title="Load that falls and rises again",
    )
    ax.legend(frameon=False)
    ax.grid(True, which="both", color="#dddddd", linewidth=0.5)
    save("indentation", record, figure)


if __name__ == "__main__":
    main()
