"""Does `model_error` cover the distance from three dimensions? Random bodies, layers
and roads, 95 % of the points.

    python benchmarks/robustness/stress_models.py [--scenes N] [--seed S] [--family F] [--show K]

The default models against cells without a reduction: `em.Averaged()` under balls, cones
and power laws against `em.reference.half_space_sliding`, the same on layers against
`layer_sliding`, `em.Multiscale()` on drawn spectra against `em.HalfSpace` on four maps.
What the cells state as their own error is granted. Wrong is a distance of more than
three times the bound; a bound that is NaN counts as flagged.
"""

import sys
from typing import Any, NamedTuple

import numpy as np
from slow_route import Law
from stress_harness import Suite, Verdict, run

FAMILIES = {"road": (0.6, 1), "body": (0.25, 1), "ball on a layer": (0.15, 1)}
SIZE = 1e-3  # of a contact [m]: everything else is in proportion
CELLS, ROAD_CELLS, MAPS = 64, 256, 4


class Drawn(NamedTuple):
    """A scene as numbers, so that another process can judge it."""

    family: str
    number: int
    scenes: int
    law: Law
    body: tuple
    load: float  # [N], or pressure [Pa]
    velocity: float


def draw(family: str, number: int, scenes: int, random: np.random.Generator) -> Drawn:
    """One scene of a family."""
    # each number is compiled once
    count = int(random.choice([1, 2, 5, 10])) if family == "road" else 2
    times = 10 ** random.uniform(-5, 1, count)
    contrast = 10 ** random.uniform(-0.5, 2.0)
    weights = random.dirichlet(np.ones(count))
    law = Law(1e6, contrast * 1e6 * weights, times, 0.0)
    velocity = SIZE / 10 ** random.uniform(
        np.log10(times.min()) - 1, np.log10(times.max()) + 1
    )
    if family == "road":
        ratio = random.choice([8.0, 12.0, 16.0])
        hurst, slope = random.uniform(0.2, 1.0), 10 ** random.uniform(-1.5, -0.3)
        low = 1 / SIZE
        pressure = (
            1e6
            * slope
            * 10 ** random.uniform(-1.5, 0.5)
            * (1 + contrast) ** random.uniform(0, 1)
        )
        return Drawn(
            family,
            number,
            scenes,
            law,
            (hurst, slope, low, low * ratio),
            pressure,
            velocity,
        )
    kind = float(random.choice([2.0, 2.0, 1.0, 1.5, 3.0, 4.0]))
    steep = 10 ** random.uniform(-2, -0.5)
    thickness = SIZE * 10 ** random.uniform(-0.3, 1.0)
    load = (
        4 / 3 * 1e6 * steep * SIZE**2 * 10 ** random.uniform(0, np.log10(1 + contrast))
    )
    return Drawn(
        family,
        number,
        scenes,
        law,
        (2.0 if "layer" in family else kind, steep, thickness),
        load,
        velocity,
    )


def _made(scene: Drawn) -> tuple[Any, Any]:
    """Material and shape."""
    import elastomdr as em

    # E* = 4 G
    rubber = em.Prony(scene.law.equilibrium / 4, scene.law.moduli / 4, scene.law.times)
    if scene.family == "road":
        hurst, slope, low, high = scene.body
        return rubber, em.SelfAffine(hurst, rms_slope=slope, q_low=low, q_high=high)
    power, steep, thickness = scene.body
    shape = (
        em.Cone(steep)
        if power == 1
        else em.PowerLaw(power, steep * SIZE ** (1 - power))
    )
    shape = em.Paraboloid(0.5 * SIZE / steep) if power == 2 else shape
    return (em.layer(rubber, thickness) if "layer" in scene.family else rubber), shape


def answer(scene: Drawn) -> dict[str, Any]:
    """The public call, and what of it is judged."""
    import elastomdr as em

    control = {"pressure" if scene.family == "road" else "load": scene.load}
    curve = em.friction(*_made(scene), velocity=scene.velocity, **control)
    names = ("mu", "model_error", "error", "converged")
    return {name: np.atleast_1d(getattr(curve, name)) for name in names}


def judge(scene: Drawn, found: dict[str, Any]) -> list[Verdict]:
    """One verdict."""
    import warnings

    import elastomdr as em

    warnings.simplefilter("ignore")
    mu, bound = float(found["mu"][0]), float(found["model_error"][0])
    if not found["converged"][0] or np.isnan(bound):
        return [("flagged", np.nan, np.nan)]
    at: dict[str, Any] = {"velocity": scene.velocity}
    if scene.family == "road":
        truth = em.friction(
            *_made(scene),
            pressure=scene.load,
            model=em.HalfSpace(cells=ROAD_CELLS, seeds=MAPS),
            **at,
        )
    elif scene.family == "body":
        truth = em.reference.half_space_sliding(
            *_made(scene), load=scene.load, points=CELLS, **at
        )
    else:
        truth = em.reference.layer_sliding(
            *_made(scene), load=scene.load, points=CELLS, **at
        )
    own = float(truth.error) / float(truth.mu)
    if not (bool(truth.converged) or np.isfinite(float(truth.mu))) or not own < 0.2:
        return [("unjudged", np.nan, np.nan)]
    miss = abs(mu / float(truth.mu) - 1)
    over = max(miss - own, 0.0) * float(truth.mu) / bound
    return [("wrong" if over > 3 else "right", miss, over)]


def about(scene: Drawn) -> str:
    sums = float(scene.law.moduli.sum() / scene.law.equilibrium)
    return (
        f"{scene.law.moduli.size} branches, contrast {sums:.3g}, body {scene.body}, "
        f"load {scene.load:.3g}, "
    ) + (f"v tau/a {np.round(scene.velocity * np.sort(scene.law.times) / SIZE, 3)}")


SUITE = Suite(
    name="stress_models",
    title="Stress: models against three dimensions",
    scenes=200,
    families=FAMILIES,
    draw=draw,
    answer=answer,
    judge=judge,
    about=about,
    covers="model_error",
    covered=95.0,
    flagged=20.0,
)

if __name__ == "__main__":
    sys.exit(run(SUITE))
