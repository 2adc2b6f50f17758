"""Is every answer on a layer of rubber right or flagged? Random layers against cells.

    python benchmarks/robustness/stress_layers.py [--scenes N] [--seed S] [--family F] [--show K]

Bonded layers and such that slip, of any Poisson's ratio, a fifteenth to thirty times as
thick as the contact is wide; a cylinder slides or rolls under a load, a ball is held at
a depth. The cells of `slow_layer.py` are good to a few in a thousand: wrong is a
converged answer that is off by more than that.
"""

import sys
from typing import Any, NamedTuple

import numpy as np
from slow_route import Law
from stress_harness import Suite, Verdict, run

FAMILIES = {"cylinder": (0.7, 1), "ball, held": (0.3, 1)}
LIMIT = 3e-3  # of mu, of the force and of the edges


class Drawn(NamedTuple):
    """A scene as numbers, so that another process can judge it."""

    family: str
    number: int
    scenes: int
    law: Law  # of E*
    poisson: float
    bonded: bool
    thickness: float
    radius: float
    size: float  # about that of the contact
    values: np.ndarray  # velocities [m/s] or times [s]


def draw(family: str, number: int, scenes: int, random: np.random.Generator) -> Drawn:
    """One scene of a family."""
    count = int(random.choice([1, 2, 5]))
    base, size = 10 ** random.uniform(4, 8), 10 ** random.uniform(-6, 0)
    times = np.sort(10 ** random.uniform(-9, 3) * 10 ** random.uniform(-1.5, 0, count))
    law = Law(base, base * 10 ** random.uniform(-1.5, 0.8, count), times, 0.0)
    poisson = 0.5 if random.random() < 0.5 else random.uniform(0.0, 0.499)
    thickness = size * 10 ** random.uniform(-1.2, 1.5)
    radius = size * 10 ** random.uniform(1, 3)
    values = size / times.max() * 10 ** random.uniform(-2.5, 0.7, 1)
    if family == "ball, held":
        thickness = size * 10 ** random.uniform(-0.7, 0.8)
        values = times.max() * np.r_[0.0, np.sort(10 ** random.uniform(-4, 1.5, 3))]
    return Drawn(
        family,
        number,
        scenes,
        law,
        poisson,
        bool(random.random() < 0.6),
        thickness,
        radius,
        size,
        values,
    )


def answer(scene: Drawn) -> dict[str, Any]:
    """The public call, and what of it is judged."""
    import elastomdr as em

    shear = 0.5 * (1 - scene.poisson)  # G over E*
    rubber = em.Prony(
        shear * scene.law.equilibrium,
        shear * scene.law.moduli,
        scene.law.times,
        poisson=scene.poisson,
    )
    layer = em.layer(rubber, scene.thickness, bonded=scene.bonded)
    if scene.family == "cylinder":
        body = em.Cylinder(scene.radius, 100 * scene.size)
        got = em.friction(
            layer, body, velocity=scene.values, load=100 * scene.size * load(scene)
        )
        return {
            "mu": got.mu,
            "error": got.error,
            "converged": got.converged,
            "leading": got.contact.leading,
            "trailing": got.contact.trailing,
        }
    depth = np.full(scene.values.size, scene.size**2 / scene.radius)
    got = em.indent(layer, em.Paraboloid(scene.radius), time=scene.values, depth=depth)
    return {"mu": got.force, "error": got.error, "converged": got.converged}


def load(scene: Drawn) -> float:
    """Per length [N/m]: for a contact of about the half-width `size` on relaxed rubber,
    thin or thick.
    """
    stiff = np.pi * scene.law.equilibrium / 4 * scene.size**2 / scene.radius
    return float(
        stiff
        * (
            1
            + 0.1 * (scene.size / scene.thickness) ** (2 if scene.poisson > 0.45 else 1)
        )
    )


def judge(scene: Drawn, found: dict[str, Any]) -> list[Verdict]:
    """A verdict per point."""
    from slow_layer import ball, cylinder

    out: list[Verdict] = []
    for i in range(scene.values.size):
        value = float(found["mu"][i])
        if not found["converged"][i]:
            out.append(("flagged" if np.isnan(value) else "wrong", np.nan, np.nan))
            continue
        if scene.family == "cylinder":
            # how wide a window, no more
            size = max(float(found["leading"][i]), float(found["trailing"][i]))
            scale = (
                scene.law,
                scene.poisson,
                scene.bonded,
                scene.thickness,
                scene.radius,
                float(scene.values[i]),
            )
            rows = [cylinder(*scale, load(scene), size, cells) for cells in (150, 300)]
            coarse, fine = rows[0][0], rows[1][0]
            edges = abs(rows[1][1] - float(found["leading"][i])) + abs(
                rows[1][2] - float(found["trailing"][i])
            )
            miss, own = abs(value / fine - 1), 2 * abs(coarse / fine - 1)
            miss = max(miss, edges / size - 0.02)
        else:
            depth = scene.size**2 / scene.radius
            if i == 0:
                forces = [
                    ball(
                        scene.poisson,
                        scene.bonded,
                        scene.thickness,
                        scene.radius,
                        depth,
                        cells,
                    )
                    for cells in (16, 32)
                ]
            relaxed = (
                scene.law.equilibrium
                + (scene.law.moduli * np.exp(-scene.values[i] / scene.law.times)).sum()
            )
            miss = abs(value / (relaxed * forces[1]) - 1)
            own = 2 * abs(forces[0] / forces[1] - 1)
        if own > 5 * LIMIT:
            out.append(("unjudged", np.nan, np.nan))
        else:
            out.append(("right" if miss <= LIMIT + own else "wrong", float(miss), 0.0))
    return out


def about(scene: Drawn) -> str:
    return (
        f"{scene.law.moduli.size} branches, Poisson {scene.poisson:.3g}, "
        f"{'bonded' if scene.bonded else 'slips'}, h/a "
        f"{scene.thickness / scene.size:.3g}, {scene.values}"
    )


SUITE = Suite(
    name="stress_layers",
    title="Stress: random layers, each right or flagged",
    scenes=200,
    families=FAMILIES,
    draw=draw,
    answer=answer,
    judge=judge,
    about=about,
)

if __name__ == "__main__":
    sys.exit(run(SUITE))
