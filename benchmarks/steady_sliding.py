"""How long does a friction curve take, against how exact it is? Work-precision of
steady sliding on one core.

    python benchmarks/steady_sliding.py [--fresh]

The main job: 64 velocities over 10 decades, 16 branches, load-controlled,
direction-averaged. Beside it, since stock solvers do no more in one go, its core: the
line passages of 64 velocities at a given depth. For the main job stock solvers get what
a straightforward user gives them: Gauss-Legendre directions, and secant steps for the
load; `em.Marched` shares curves, directions and loads as the closed forms do.

References are the closed forms of `exact.py` in many digits, averaged over directions
by adaptive quadrature; they are kept in results/ (`--fresh` computes them anew, in some
ten minutes). Times are the least of the repeats, compilation apart; ratios are of
processor time, which a busy machine changes less than wall-clock time.
"""

import argparse
from collections.abc import Callable, Sequence

import exact
import numpy as np
import scene
from common import cached, heading, one_core, plt, save, table, timed, verdict
from competitors import Lines, at_load, contact_step, exponential, kvaerno5, solve_ivp

import elastomdr as em

RTOLS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
MARCHED = (1e-3, 1e-4, 1e-6)
SHAPES = {"paraboloid": em.Paraboloid(scene.RADIUS), "sphere": em.Sphere(scene.RADIUS)}
SLOPES = {
    "paraboloid": exact.paraboloid(scene.RADIUS),
    "sphere": exact.sphere(scene.RADIUS, 3e-3),
}
# velocities with a reference: line, fixed depth
ON_LINE = {"paraboloid": np.arange(64), "sphere": np.arange(0, 64, 4)}
AVERAGED = {
    "paraboloid": np.array([0, 8, 16, 24, 32, 40, 48, 56, 63]),
    "sphere": np.array([0, 16, 32, 48, 63]),
}
# velocities of the loop over solve_ivp; its time is scaled to all
SUBSET = np.arange(3, 64, 8)
STEPS = (256, 1024, 2048, 4096, 8192, 16384)  # of the exponential loop
# Gauss-Legendre nodes over directions for the stock solvers: 3e-7 in the median, 5e-6
# at worst
ANGLES = 24
SAME_ERROR = 1e-6
COLUMNS = (
    "method",
    "setting",
    "first call [s]",
    "wall [ms]",
    "processor [ms]",
    "largest error",
    "median error",
)


def reference(fresh: bool) -> dict:
    """mu of the line at fixed depth and of the direction average, at the velocities of
    `ON_LINE` and `AVERAGED`.
    """
    names = ("EQUILIBRIUM", "MODULI", "TIMES", "RADIUS", "LOAD", "LEADING", "VELOCITY")
    inputs = {name: vars(scene)[name] for name in names}
    series = (scene.EQUILIBRIUM, tuple(scene.MODULI), tuple(scene.TIMES))

    def compute() -> dict:
        lines = {name: exact.Line(slope, *series) for name, slope in SLOPES.items()}
        v, a, load = scene.VELOCITY, scene.LEADING, scene.LOAD
        return {
            "line": {
                k: [exact.slide(lines[k], x, leading=a).mu for x in v[at]]
                for k, at in ON_LINE.items()
            },
            "averaged": {
                k: [exact.direction_average(lines[k], x, load, a) for x in v[at]]
                for k, at in AVERAGED.items()
            },
        }

    return cached(
        "steady_sliding_reference",
        {**inputs, "on_line": ON_LINE, "averaged": AVERAGED},
        compute,
        fresh,
    )


def measure(
    method: str,
    setting: str,
    call: Callable[[], np.ndarray],
    truth: Sequence[float],
    at: np.ndarray,
    repeats: int,
    scale: float = 1.0,
) -> tuple:
    """One row of the table. `call` gives mu, of which entries `at` are compared; its
    times are scaled by `scale`.
    """
    first = timed(call).wall
    warm = timed(call, repeats)
    error = np.abs(warm.value[at] / truth - 1)
    return (
        method,
        setting,
        first,
        1e3 * scale * warm.wall,
        1e3 * scale * warm.cpu,
        error.max(),
        np.median(error),
    )


def line_passages(truth: dict) -> list[tuple]:
    """64 line passages at fixed depth by every method."""
    size, velocity = np.full(64, scene.LEADING), scene.VELOCITY
    rows = []
    for name, shape in SHAPES.items():
        depth = float(shape.profile_1d(scene.LEADING))
        for rtol in (1e-2, 1e-6, 1e-10):

            def ours(shape=shape, depth=depth, rtol=rtol) -> np.ndarray:
                return em.friction(
                    scene.FOUNDATION,
                    shape,
                    velocity=velocity,
                    depth=depth,
                    model=em.Line(),
                    rtol=rtol,
                ).mu

            rows.append(
                measure(
                    f"elastomdr, {name}",
                    f"rtol {rtol:g}",
                    ours,
                    truth[name],
                    ON_LINE[name],
                    20,
                )
            )

        if name == "sphere":
            continue
        for rtol in MARCHED:

            def marched(shape=shape, depth=depth, rtol=rtol) -> np.ndarray:
                return em.friction(
                    scene.FOUNDATION,
                    shape,
                    velocity=velocity,
                    depth=depth,
                    model=em.Marched(average=False),
                    rtol=rtol,
                ).mu

            rows.append(
                measure(
                    "em.Marched",
                    f"rtol {rtol:g}",
                    marched,
                    truth[name],
                    ON_LINE[name],
                    1,
                )
            )

    def add(
        method: str,
        setting: str,
        lines: Lines,
        repeats: int,
        at: np.ndarray | None = None,
    ) -> None:
        at = np.arange(64) if at is None else at
        exact_mu = np.array(truth["paraboloid"])[at]
        here, scale = np.arange(at.size), 64 / at.size
        rows.append(
            measure(
                method,
                setting,
                lambda: lines(size[at], velocity[at])[0],
                exact_mu,
                here,
                repeats,
                scale,
            )
        )

    for samples in (64, 256, 1024, 4096, 16384, 65536):
        add("contact step in diffrax", f"{samples} steps", contact_step(samples), 3)
    for samples in STEPS:
        add(
            "exponential steps in a compiled loop",
            f"{samples} steps",
            exponential(samples),
            3,
        )
    for tolerance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10):
        add(
            "Kvaerno5 and event", f"rtol = atol = {tolerance:g}", kvaerno5(tolerance), 2
        )
    for method in ("LSODA", "Radau"):
        for tolerance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10):
            add(
                f"solve_ivp {method} loop",
                f"rtol = atol = {tolerance:g}",
                solve_ivp(method, tolerance),
                1,
                SUBSET,
            )
    return rows


def main_job(truth: dict, steps: int) -> tuple[list[tuple], int]:
    """The whole job: by elastomdr at every tolerance, by Kvaerno5 and a loop of `steps`
    at one; and the passes that the load took there.
    """
    rows, passes = [], 0
    for name, shape in SHAPES.items():
        for rtol in RTOLS:

            def ours(shape=shape, rtol=rtol) -> np.ndarray:
                return em.friction(
                    scene.FOUNDATION,
                    shape,
                    velocity=scene.VELOCITY,
                    load=scene.LOAD,
                    model=em.Averaged(corrected=False),
                    rtol=rtol,
                ).mu

            repeats = 20 if rtol >= 1e-7 else 3
            rows.append(
                measure(
                    f"elastomdr, {name}",
                    f"rtol {rtol:g}",
                    ours,
                    truth[name],
                    AVERAGED[name],
                    repeats,
                )
            )

    for rtol in MARCHED:

        def marched(rtol=rtol) -> np.ndarray:
            return em.friction(
                scene.FOUNDATION,
                SHAPES["paraboloid"],
                velocity=scene.VELOCITY,
                load=scene.LOAD,
                model=em.Marched(corrected=False),
                rtol=rtol,
            ).mu

        rows.append(
            measure(
                "em.Marched",
                f"rtol {rtol:g}",
                marched,
                truth["paraboloid"],
                AVERAGED["paraboloid"],
                1,
            )
        )

    node, weight = np.polynomial.legendre.leggauss(ANGLES)
    cosine = np.cos(np.pi / 4 * (node + 1))
    slowed = np.outer(scene.VELOCITY, cosine)

    def averaged(lines: Lines) -> Callable[[], np.ndarray]:
        def call() -> np.ndarray:
            nonlocal passes
            mu, passes = at_load(lines, slowed.ravel(), scene.LOAD)
            return mu.reshape(slowed.shape) @ (0.5 * weight * cosine)

        return call

    at = AVERAGED["paraboloid"]
    for method, setting, lines in (
        ("exponential steps in a compiled loop", f"{steps} steps", exponential(steps)),
        ("Kvaerno5 and event", f"tolerance {SAME_ERROR:g}", kvaerno5(SAME_ERROR)),
    ):
        setting = f"{setting}, {ANGLES} directions"
        rows.append(
            measure(method, setting, averaged(lines), truth["paraboloid"], at, 1)
        )
    return rows, passes


def cheapest(rows: list[tuple], method: str, column: int = 6) -> tuple:
    """The fastest row of a method whose error, median by default, is at most
    `SAME_ERROR`.
    """
    good = [row for row in rows if row[0] == method and row[column] <= SAME_ERROR]
    return min(good, key=lambda row: row[4], default=(method, "none", *[np.nan] * 5))


def draw(lines: list[tuple], job: list[tuple], scaled: list[tuple]):
    figure, axes = plt.subplots(
        1, 2, figsize=(11, 4.6), sharey=True, layout="constrained"
    )
    titles = (
        "64 line passages at fixed depth",
        "64 velocities at a load, averaged over directions",
    )
    styles = {}
    for ax, rows, title in zip(axes, (lines, job + scaled), titles, strict=True):
        for method in dict.fromkeys(row[0] for row in rows):
            points = np.array(
                [row[4:] for row in rows if row[0] == method], dtype=float
            )
            colour = styles.setdefault(
                method.removesuffix(", scaled"), f"C{len(styles)}"
            )
            ax.loglog(
                np.maximum(points[:, 1], 1e-16),
                points[:, 0],
                "o-",
                color=colour,
                label=method,
                ms=4,
            )
            ax.loglog(
                np.maximum(points[:, 2], 1e-16),
                points[:, 0],
                "o:",
                color=colour,
                ms=4,
                mfc="none",
            )
        ax.set(
            title=title,
            xlabel="relative error of mu: largest (solid), median (dotted)",
            xlim=(3e-1, 1e-16),
        )
        ax.axvline(SAME_ERROR, color="0.8", lw=1, zorder=0)
        ax.grid(color="0.92")
        ax.legend(fontsize=8)
    axes[0].set_ylabel("processor time, one core [ms]")
    axes[1].axhline(20, color="0.8", lw=1, zorder=0)
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--fresh", action="store_true", help="compute the reference anew"
    )
    truth = reference(parser.parse_args().fresh)
    one_core()
    record = heading("Steady sliding: time against error, one core", *scene.INPUTS)

    lines = line_passages(truth["line"])
    print(
        "\n64 line passages at fixed depth (solve_ivp: 8 of them, times scaled by 8)",
        end="",
    )
    record["line passages"] = table(COLUMNS, lines)
    steps = np.array(
        [[int(r[1].split()[0]), r[6]] for r in lines if r[0].startswith("contact step")]
    )[1:-1]
    order = -np.polyfit(*np.log(steps.T), 1)[0]

    loop_line = cheapest(lines, "exponential steps in a compiled loop")
    job, passes = main_job(truth["averaged"], int(loop_line[1].split()[0]))
    share = ANGLES * passes
    loops = [row for row in lines if row[0].startswith("solve_ivp")]
    scaled = [
        (f"{r[0]}, scaled", r[1], np.nan, share * r[3], share * r[4], *r[5:])
        for r in loops
    ]
    print(
        f"\nThe main job. Stock solvers: {ANGLES} directions, {passes} passes of "
        "secant steps for the load; loops"
    )
    print(
        (
            f"over solve_ivp are not run but line passages times {ANGLES} times "
            f"{passes}, "
            "with the line's error"
        ),
        end="",
    )
    record["main job"] = table(COLUMNS, job + scaled)

    print(
        "\nAgainst the targets, at an error of 1e-6: the largest for elastomdr, "
        "the median for the others"
    )
    strict = [cheapest(job, f"elastomdr, {name}", 5) for name in SHAPES]
    ours, ours_line = strict[0], cheapest(lines, "elastomdr, paraboloid", 5)
    stock_line = cheapest(lines, "Kvaerno5 and event")
    loops_line = [cheapest(lines, f"solve_ivp {m} loop") for m in ("LSODA", "Radau")]
    loops = [cheapest(scaled, f"{row[0]}, scaled") for row in loops_line]
    record["figures"] = [
        *(verdict(f"main job, {row[0]}, wall", row[3], 20, " ms") for row in strict),
        *(
            verdict(f"main job, {row[0]}, processor", row[4], 20, " ms")
            for row in strict
        ),
        verdict(
            "main job, Kvaerno5 over elastomdr", job[-1][4] / ours[4], 50, least=True
        ),
        *(
            verdict(
                f"main job, {r[0]} over elastomdr", r[4] / ours[4], 1000, least=True
            )
            for r in loops
        ),
        verdict(
            "main job, em.Marched over elastomdr",
            cheapest(job, "em.Marched")[4] / ours[4],
            1000,
        ),
        verdict(
            "main job, exponential steps over elastomdr",
            job[-2][4] / ours[4],
            50,
            least=True,
        ),
        verdict(
            "line passages, Kvaerno5 over elastomdr",
            stock_line[4] / ours_line[4],
            50,
            least=True,
        ),
        verdict(
            "line passages, em.Marched over elastomdr",
            cheapest(lines, "em.Marched")[4] / ours_line[4],
            1000,
        ),
        *(
            verdict(
                f"line passages, {row[0]} over elastomdr",
                row[4] / ours_line[4],
                2,
                least=True,
            )
            for row in (loop_line, cheapest(lines, "contact step in diffrax"))
        ),
        *(
            verdict(
                f"what sharing one curve saves, against {row[0]}",
                row[4] / ours[4] / (line[4] / ours_line[4]),
                5,
                least=True,
            )
            for row, line in ((job[-2], loop_line), (job[-1], stock_line))
        ),
        *(
            verdict(
                f"line passages, {r[0]} over elastomdr",
                r[4] / ours_line[4],
                1000,
                least=True,
            )
            for r in loops_line
        ),
        verdict("line passages, largest error at rtol 1e-10", lines[2][5], 1e-10),
        verdict("order of the contact step", order, 1.9, least=True),
    ]
    save("steady_sliding", record, draw(lines, job, scaled))


if __name__ == "__main__":
    main()
