"""Sharp bodies: what a velocity of a cone, a power law below 2 and a profile from
points costs.

    python benchmarks/sharp.py

16 branches over 6 decades, direction average at rtol 1e-6 unless a row says otherwise.
The opponent is a plain march of the same passages over equal steps, exact in every
branch (f <- e f + E phi du), all lines at once in NumPy, at the contact sizes that
elastomdr found; its error is that of mu. Times are processor time, the least of a few.
"""

import os

# its threads would wait for each other on one core
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import jax
import jax.numpy as jnp
import numpy as np
from common import heading, one_core, save, table, timed, verdict

import elastomdr as em

LOAD, VELOCITY = 0.1, np.geomspace(1e-3, 1e2, 64)  # [N], [m/s]
R = np.linspace(0, 2e-3, 21)  # [m]
SHAPES = {
    "cone": em.Cone(0.2),
    "r^1.2": em.PowerLaw(1.2, 0.2 / 1e-3**0.2),
    "r^1.5": em.PowerLaw(1.5, 0.2 / 1e-3**0.5),
    "21 points of r^1.2": em.Profile(R, 0.2 * R**1.2 / 1e-3**0.2),
    "21 points of a cone": em.Profile(R, 0.2 * R),
    "21 points of a sphere": em.Profile(R, 5e-3 - np.sqrt(25e-6 - R**2)),
}
AVERAGED = em.Averaged(corrected=False)
REPEATS = 5


def foundation(branches: int) -> em.Foundation:
    return em.Foundation(
        1e6, np.full(branches, 20e6 / branches), np.geomspace(1e-6, 1.0, branches)
    )


def cost(shape, velocity, rtol=1e-6, branches=16, model=AVERAGED):
    """Least processor time [ms] and the curve."""

    def call():
        return em.friction(
            foundation(branches),
            shape,
            velocity=velocity,
            load=LOAD,
            rtol=rtol,
            model=model,
        )

    call()
    curve, _, cpu = timed(call, REPEATS)
    return 1e3 * cpu, curve


def marched(shape, velocity, leading, steps):
    """mu of lines with given leading edges by equal steps through the contact, each
    with its exit where q = 0.
    """
    law = foundation(16)
    moduli, times = np.asarray(law.moduli)[:, None], np.asarray(law.times)[:, None]
    place = leading * (1 - 2 * np.arange(steps + 1)[:, None] / steps)  # from a to -a
    height = np.asarray(shape.profile_1d(place))
    z = 2 * leading / steps / (velocity * times)
    keep, share = np.exp(-z), moduli * -np.expm1(-z) / z
    force, u, q_before = (
        np.zeros_like(z),
        np.zeros_like(leading),
        np.zeros_like(leading),
    )
    normal, drag, touching = (
        np.zeros_like(leading),
        np.zeros_like(leading),
        np.ones(leading.shape, bool),
    )
    for i in range(1, steps + 1):
        after = height[0] - height[i]
        force = keep * force + share * (after - u)
        q = float(law.equilibrium) * after + force.sum(axis=0)
        part = np.where(
            touching,
            np.where(q > 0, 1.0, q_before / np.where(q_before > q, q_before - q, 1.0)),
            0.0,
        )
        ends = np.where(q > 0, q, 0.0)
        normal += part * 0.5 * (q_before + ends) * 2 * leading / steps
        drag += part * 0.5 * (q_before + ends) * (after - u)
        touching &= q > 0
        u, q_before = after, q
    return drag / normal


def opponent() -> list[dict]:
    rows = []
    for name in ("cone", "r^1.2", "21 points of r^1.2"):
        shape = SHAPES[name]
        ours, curve = cost(shape, VELOCITY, model=em.Line())
        truth = em.friction(
            foundation(16),
            shape,
            velocity=VELOCITY,
            load=LOAD,
            rtol=1e-10,
            model=em.Line(),
        )
        error = np.abs(curve.mu / truth.mu - 1).max()
        for steps in (200, 2000):
            marched_mu, _, cpu = timed(
                lambda s=shape, n=steps, c=curve: marched(
                    s, VELOCITY, c.contact.leading, n
                ),
                3,
            )
            missed = np.abs(marched_mu / truth.mu - 1)
            rows.append(
                (
                    name,
                    steps,
                    1e3 * cpu,
                    missed.max(),
                    np.median(missed),
                    ours,
                    error,
                    1e3 * cpu / ours,
                )
            )
    return table(
        (
            "64 bare lines",
            "steps",
            "march, edges given [ms]",
            "worst error",
            "median",
            "elastomdr, edges sought [ms]",
            "worst error ",
            "ratio",
        ),
        rows,
    )


def materials() -> tuple[list[dict], float]:
    """vmap over 32 materials against a loop of calls, bare line, both after the first
    call.
    """
    factors = np.geomspace(0.5, 2.0, 32)
    law = foundation(16)

    def mu(factor, shape):
        scaled = em.Foundation(
            law.equilibrium, factor * jnp.asarray(law.moduli), law.times
        )
        return em.friction(
            scaled, shape, velocity=0.1, load=LOAD, model=em.Line(), rtol=1e-6
        ).mu

    def one(factor, shape):
        scaled = em.Foundation(
            law.equilibrium, factor * np.asarray(law.moduli), law.times
        )
        return float(
            em.friction(
                scaled, shape, velocity=0.1, load=LOAD, model=em.Line(), rtol=1e-6
            ).mu
        )

    rows = []
    with jax.enable_x64(True):
        for name in ("cone", "r^1.5"):
            shape = SHAPES[name]
            together = jax.jit(jax.vmap(lambda factor, shape=shape: mu(factor, shape)))
            jax.block_until_ready(together(factors))
            value, _, mapped = timed(lambda f=together: np.asarray(f(factors)), REPEATS)
            looped = timed(
                lambda s=shape: np.array([one(factor, s) for factor in factors]), 2
            )
            rows.append(
                (
                    name,
                    1e3 * mapped / 32,
                    1e3 * looped.cpu / 32,
                    mapped / looped.cpu,
                    np.max(np.abs(value / looped.value - 1)),
                )
            )
    columns = (
        "32 materials",
        "vmap [ms per point]",
        "loop [ms per point]",
        "ratio",
        "largest difference",
    )
    return table(columns, rows), max(row[3] for row in rows)


def main() -> None:
    one_core()
    record = heading(
        "Sharp bodies", "load 0.1 N, 16 branches from 1e-6 to 1 s, E_0/E_inf = 21"
    )
    rows, first = [], {}
    for name, shape in SHAPES.items():
        one, curve = cost(shape, 0.1)
        many = cost(shape, VELOCITY)[0]
        line = (
            cost(shape, 0.1, model=em.Line())[0],
            cost(shape, VELOCITY, model=em.Line())[0],
        )
        first[name] = one
        rows.append((name, *line, one, many, float(curve.error / curve.mu)))
    columns = (
        "body",
        "line: 1 velocity [ms]",
        "64 [ms]",
        "average: 1 velocity [ms]",
        "64 [ms] ",
        "stated error",
    )
    record["velocities"] = table(columns, rows)
    rows = []
    for name in ("cone", "r^1.5", "21 points of r^1.2"):
        rows.append(
            (
                name,
                *(
                    cost(SHAPES[name], 0.1, rtol=rtol)[0]
                    for rtol in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
                ),
            )
        )
    record["tolerances"] = table(
        ("average, 1 velocity [ms]; rtol", "1e-2", "1e-4", "1e-6", "1e-8", "1e-10"),
        rows,
    )
    loose = max(row[1] / row[-1] for row in rows)
    rows = []
    for name in ("cone", "r^1.5", "21 points of r^1.2"):
        rows.append(
            (
                name,
                *(
                    cost(SHAPES[name], VELOCITY, branches=n, model=em.Line())[0]
                    for n in (10, 50, 200)
                ),
            )
        )
    record["branches"] = table(
        ("64 bare lines [ms]; branches", "10", "50", "200"), rows
    )
    growth = max(row[3] / row[1] for row in rows)
    record["opponent"] = opponent()
    record["materials"], share = materials()
    print()
    record["verdicts"] = [
        verdict(
            "one velocity of 21 points of r^1.2 at rtol 1e-6",
            first["21 points of r^1.2"],
            50,
            " ms",
        ),
        verdict("one velocity of a cone at rtol 1e-6", first["cone"], 3, " ms"),
        verdict("rtol 1e-2 over 1e-10", loose, 1),
        verdict("200 branches over 10", growth, 20),
        verdict("vmap over materials over a loop of calls, per point", share, 1),
    ]
    save("sharp", record)


if __name__ == "__main__":
    main()
