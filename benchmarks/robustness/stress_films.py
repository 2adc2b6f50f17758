"""Is every lubricated point right or flagged? Random scenes against a finer grid.

    python benchmarks/robustness/stress_films.py [--scenes N] [--seed S] [--family F] [--show K]

Half-spaces and layers, smooth and rough, that rest, pass and roll, each over eight
decades of eta U. The judge is the same solver on a grid four times finer: wrong is a
converged point whose friction, films or flow is off by more than 1e-4, or whose flow is
not even to 1e-10.
"""

import sys
from typing import Any, NamedTuple

import numpy as np
from slow_route import Law
from stress_harness import Suite, Verdict, run

FAMILIES = {"half-space": (0.4, 1), "layer": (0.25, 1), "rough": (0.35, 1)}
LIMIT, EVEN = 1e-4, 1e-10
POINTS = 5
NUMBERS = ("mu", "film_thickness", "least_film", "flow")


class Drawn(NamedTuple):
    """A scene as numbers, so that another process can judge it."""

    family: str
    number: int
    scenes: int
    law: Law  # of the shear modulus
    poisson: float
    rubber: str
    radius: float
    load: float
    thickness: float | None
    bonded: bool
    drag: np.ndarray  # eta U [N/m]
    viscosity: float
    roughness: tuple[float, float, float, float] | None  # H, rms, q_low, q_high


def draw(family: str, number: int, scenes: int, random: np.random.Generator) -> Drawn:
    """One scene of a family."""
    count = int(random.choice([1, 2, 4]))
    base = 10 ** random.uniform(5.5, 7.0)
    moduli = base * 10 ** random.uniform(-1.0, 0.8, count)
    law = Law(base, moduli, np.sort(10 ** random.uniform(-6, 1, count)), 0.0)
    radius, load = 10 ** random.uniform(-3, -1.5), 10 ** random.uniform(2, 4)
    half = (radius * load / (np.pi * base)) ** 0.5  # about that of the contact
    roughness = None
    if family == "rough":
        low = 2 * np.pi / half * 10 ** random.uniform(0.5, 1.5)
        high = low * 10 ** random.uniform(1.0, 2.5)
        rms = half**2 / radius * 10 ** random.uniform(-4, -2)
        roughness = (random.uniform(0.5, 1.0), rms, low, high)
    layered = family == "layer"
    return Drawn(
        family,
        number,
        scenes,
        law,
        float(random.choice([0.5, 0.45, 0.3])),
        str(random.choice(["rests", "passes", "rolls"])),
        radius,
        load,
        half * 10 ** random.uniform(-0.7, 1.0) if layered else None,
        bool(random.random() < 0.6),
        10 ** random.uniform(-7, -5) * np.geomspace(1, 1e8, POINTS),
        10 ** random.uniform(-3, 1),
        roughness,
    )


def curve(scene: Drawn) -> Any:
    """The public call."""
    import elastomdr as em

    rubber = em.Prony(
        scene.law.equilibrium, scene.law.moduli, scene.law.times, poisson=scene.poisson
    )
    body, rough = rubber, {}
    if scene.thickness is not None:
        body = em.layer(rubber, scene.thickness, bonded=scene.bonded)
    if scene.roughness is not None:
        hurst, rms, low, high = scene.roughness
        surface = em.SelfAffine(hurst=hurst, rms_height=rms, q_low=low, q_high=high)
        rough = {"surface": surface, "boundary_shear": 1e5}
    return em.lubricated(
        body,
        em.Cylinder(scene.radius, 1.0),
        velocity=scene.drag / scene.viscosity,
        load=scene.load,
        viscosity=scene.viscosity,
        rubber=scene.rubber,
        **rough,
    )


def answer(scene: Drawn) -> dict[str, Any]:
    """What of the call is judged."""
    found = curve(scene)
    kept = (*NUMBERS, "error", "imbalance", "converged")
    return {name: getattr(found, name) for name in kept}


def judge(scene: Drawn, found: dict[str, Any]) -> list[Verdict]:
    """A verdict per point."""
    from elastomdr.seal import lubricated

    usual = lubricated._FEWEST, lubricated._MOST
    lubricated._FEWEST, lubricated._MOST = 4, 5
    try:
        fine = curve(scene)
    finally:
        lubricated._FEWEST, lubricated._MOST = usual
    out: list[Verdict] = []
    for i in range(scene.drag.size):
        if not found["converged"][i]:
            flagged = np.isnan(found["mu"][i])
            out.append(("flagged" if flagged else "wrong", np.nan, np.nan))
        elif not fine.converged[i]:
            out.append(("unjudged", np.nan, np.nan))
        else:
            off = {
                name: abs(float(found[name][i] / getattr(fine, name)[i]) - 1)
                for name in NUMBERS
            }
            miss = max(off.values())
            right = miss <= LIMIT and found["imbalance"][i] <= EVEN
            error = float(found["error"][i] / found["mu"][i])
            out.append(
                ("right" if right else "wrong", miss, off["mu"] / max(error, 1e-15))
            )
    return out


def about(scene: Drawn) -> str:
    layer = "" if scene.thickness is None else f", {scene.thickness:.3g} m thick"
    rough = "" if scene.roughness is None else f", rough {scene.roughness}"
    return (
        f"{scene.law.moduli.size} branches, {scene.rubber}, R {scene.radius:.3g} m, "
        f"{scene.load:.3g} N/m, eta {scene.viscosity:.3g}, eta U "
        f"{scene.drag[0]:.3g} on{layer}{rough}"
    )


SUITE = Suite(
    name="stress_films",
    title="Stress: random lubricated contacts, each right or flagged",
    scenes=40,
    families=FAMILIES,
    draw=draw,
    answer=answer,
    judge=judge,
    about=about,
)

if __name__ == "__main__":
    sys.exit(run(SUITE))
