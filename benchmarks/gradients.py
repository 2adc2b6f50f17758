"""How long until the first gradient, and is it right?

    python benchmarks/gradients.py                       # this checkout alone
    python benchmarks/gradients.py --against ../other    # and another, in turns

Processor seconds of the first `jax.grad` in new processes that keep no compiled code,
without the import of JAX, and of the same gradient again. On a busy machine only their
ratios mean something. The gradient and the Hessian of a sliding paraboloid are compared
with mpmath in 40 digits.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
from common import heading, save, table, verdict

HERE = Path(__file__).parents[1]
REPEATS = 3


class Scene(NamedTuple):
    """A number to be differentiated by a vector p, and what its gradient may take."""

    name: str
    setup: str
    number: str
    parameters: int
    target: float  # of processor time [s]
    before: float  # the same in version 0.2, by searches that JAX compiled


ROAD = "times = np.logspace(-6, -1, 4)"
SCENES = (
    Scene(
        "a paraboloid",
        "shape = em.Paraboloid(5e-3)",
        """em.friction(
            em.StandardSolid(1e6, 3e6 * p[0], 1e-3), shape, velocity=1.0, load=1.0).mu""",
        1,
        2.0,
        5.7,
    ),
    Scene(
        "a sphere",
        "shape = em.Sphere(5e-3)",
        """em.friction(
            em.StandardSolid(1e6, 3e6 * p[0], 1e-3), shape, velocity=1.0, load=1.0).mu""",
        1,
        2.0,
        np.nan,
    ),
    Scene(
        "a road by Multiscale",
        ROAD,
        """em.friction(
            em.Prony(1e6 * p[0], 1e7 * p[1:5], times * p[5:9], poisson=0.49),
            em.SelfAffine(0.8 * p[9], rms_slope=0.5 * p[10], q_low=1e3, q_high=1e6),
            velocity=0.1 * p[11], pressure=3e5).mu""",
        12,
        5.0,
        19.5,
    ),
    Scene(
        "a cylinder that rolls on a layer",
        "times = np.logspace(-4, 0, 3)",
        """em.rolling(
            em.layer(em.Prony(1e6 * p[0], 1e6 * p[1:4], times, poisson=0.49), 0.01 * p[4]),
            em.Cylinder(0.05, 0.5), velocity=1.0, load=100.0 * p[5]).coefficient""",
        6,
        5.0,
        28.0,
    ),
    Scene(
        "a road with heat, softening and adhesion",
        ROAD
        + """
softening = em.Softening(
    strain=[1e-3, 0.01, 0.1, 0.5], storage=[1.0, 0.9, 0.6, 0.4], loss=[1.0, 1.05, 0.8, 0.5])""",
        """em.friction(
            em.Prony(1e6 * p[0], 1e7 * p[1:5], times, poisson=0.49,
                     shift=em.WLF(8.86, 101.6, 300.0), softening=softening),
            em.SelfAffine(0.8, rms_slope=0.5 * p[5], q_low=1e3, q_high=1e6),
            velocity=p[6], pressure=3e5 * p[7], temperature=300.0,
            heat=em.Heat(0.3, 2e6), adhesion=em.AdhesiveShear(1e5, 1e-2, 0.1)).mu""",
        8,
        15.0,
        78.0,
    ),
)
START = """
import json, time
import numpy as np
import elastomdr as em
import jax
jax.config.update("jax_enable_x64", True)
"""
TIMED = (
    START
    + """
{setup}
def mu(p):
    return {number}
def once():
    start = time.process_time()
    value = jax.block_until_ready(jax.grad(mu)(jax.numpy.ones({parameters})))
    return value, time.process_time() - start
value, first = once()
again = min(once()[1] for _ in range(3))
print(json.dumps([first, again, value.tolist()]))
"""
)
EXACT = (
    START
    + """
def mu(p):
    law = em.Foundation(p[0], [p[1]], [p[2]])
    shape = em.Paraboloid(p[3])
    return em.friction(law, shape, velocity=p[4], load=p[5], model=em.Line(), rtol=1e-10).mu
p = jax.numpy.array([1e6, 3e6, 1e-3, 5e-3, 1.0, 1.0])
gradients = [f(mu)(p) * p for f in (jax.grad, lambda mu: jax.jit(jax.grad(mu)), jax.jacfwd)]
hessian = jax.hessian(mu)(p) * p * p[:, None]
print(json.dumps([[x.tolist() for x in gradients], hessian.tolist()]))
"""
)


def process(code: str, source: Path) -> Any:
    """What a new process prints last, with the package from `source`."""
    variables = {
        "PYTHONPATH": str(source / "src"),
        "JAX_ENABLE_COMPILATION_CACHE": "false",
    }
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"{code}\nfailed with {source}:\n{done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


def first_gradients(sources: list[Path], repeats: int) -> list[tuple[Any, ...]]:
    """A row for each scene and checkout, which take turns."""
    rows = []
    for scene in SCENES:
        code = TIMED.format(**scene._asdict())
        runs: dict[Path, list[Any]] = {source: [] for source in sources}
        for _ in range(repeats):
            for source in sources:
                runs[source].append(process(code, source))
        gradients = [np.array(runs[source][0][2]) for source in sources]
        apart = max(np.abs(gradients[0] - x).max() for x in gradients)
        apart /= np.abs(gradients[0]).max()
        for source in sources:
            first, again = (
                statistics.median(run[i] for run in runs[source]) for i in (0, 1)
            )
            name = source.name if len(sources) > 1 else "this one"
            rows.append((scene.name, name, scene.before, first, 1e3 * again, apart))
    return rows


def exact_errors() -> list[tuple[str, float]]:
    """Largest errors of x d mu/dx and of x y d2 mu/(dx dy)."""
    slope, curvature = exact()
    gradients, hessian = process(EXACT, HERE)
    rows = [
        (name, float(np.abs(np.array(x) - slope).max()))
        for name, x in zip(("grad", "jit(grad)", "jacfwd"), gradients, strict=True)
    ]
    return [*rows, ("hessian", float(np.abs(np.array(hessian) - curvature).max()))]


def paraboloid(
    relaxed: Any, modulus: Any, time: Any, radius: Any, velocity: Any, load: Any
) -> Any:
    """mu of a standard solid under a sliding paraboloid, from its line force density.

    q = E (a^2 - x^2)/R + (2 E_1 s/R) [(x + s) - (a + s) exp(-(a - x)/s)],  s = v tau,
    with q(-b) = 0, integrated.
    """
    s = velocity * time
    share = 2 * modulus * s / relaxed

    def density(x: Any, a: Any) -> Any:
        return a**2 - x**2 + share * (x + s - (a + s) * mp.exp(-(a - x) / s))

    def force(x: Any, a: Any) -> Any:
        memory = x**2 / 2 + s * x - (a + s) * s * mp.exp(-(a - x) / s)
        return a**2 * x - x**3 / 3 + share * memory

    def drag(x: Any, a: Any) -> Any:
        memory = x**3 / 3 + s * x**2 / 2
        memory -= (a + s) * s * (x - s) * mp.exp(-(a - x) / s)
        return a**2 * x**2 / 2 - x**4 / 4 + share * memory

    def residual(a: Any, b: Any) -> list[Any]:
        carried = relaxed / radius * (force(a, a) - force(-b, a))
        return [density(-b, a), carried / load - 1]

    start = (mp.mpf("7e-4"), mp.mpf("6e-4"))
    a, b = mp.findroot(residual, start, tol=mp.mpf(10) ** -60)
    return 2 * relaxed / radius**2 * (drag(a, a) - drag(-b, a)) / load


def exact() -> tuple[np.ndarray, np.ndarray]:
    """Gradient and Hessian of `paraboloid`, each derivative times its arguments."""
    mp.mp.dps = 40
    place = [mp.mpf(x) for x in ("1e6", "3e6", "1e-3", "5e-3", "1", "1")]
    count = len(place)

    def scaled(*steps: Any) -> Any:
        return paraboloid(*(x * (1 + t) for x, t in zip(place, steps, strict=True)))

    def derivative(*along: int) -> float:
        orders = tuple(along.count(i) for i in range(count))
        step = mp.mpf(10) ** -8
        return float(mp.diff(scaled, (0,) * count, orders, h=step))

    slope = np.array([derivative(i) for i in range(count)])
    pairs = [[derivative(i, j) for j in range(count)] for i in range(count)]
    return slope, np.array(pairs)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--against", type=Path)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    given = parser.parse_args()
    sources = [HERE] if given.against is None else [HERE, given.against.resolve()]
    record = heading("Gradients", f"median of {given.repeats} processes, no cache")
    record["exact"] = table(("against 40 digits", "largest error"), exact_errors())
    rows = first_gradients(sources, given.repeats)
    columns = (
        "scene",
        "checkout",
        "version 0.2 [s]",
        "first [s]",
        "again [ms]",
        "apart",
    )
    record["processes"] = table(columns, rows)
    print()
    first = {row[0]: row[3] for row in rows[:: len(sources)]}
    record["figures"] = [
        verdict(scene.name, first[scene.name], scene.target, " s of processor")
        for scene in SCENES
    ]
    save("gradients", record)


if __name__ == "__main__":
    main()
