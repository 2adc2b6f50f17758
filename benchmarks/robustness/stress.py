"""Is every answer right or flagged? 5,000 random scenes against slow routes that share
nothing with elastomdr.

    python benchmarks/robustness/stress.py [--scenes N] [--seed S] [--family F] [--show K]

Every scene has a material, a body and a load or depth of its own, and two velocities: 1
to 60 branches, their times over 24 decades or nearly equal, moduli over 12 decades,
with and without equilibrium modulus and dashpot; velocities over 20 decades;
paraboloids and cones, spheres, power laws with exponents from 1 to 40, cylinders on
layers, profiles from points; and the direction average of paraboloids, of cones, whose
friction bends, and of sweeps of 301 velocities for a paraboloid, of which two are
judged, with their depth and edges. `stress_judge.py` judges them; `stress_harness.py`
runs both, goes on where it was stopped, and says what the words of the table mean.
"""

import sys
from typing import Any

import numpy as np
from slow_route import Law
from stress_harness import Suite, run
from stress_judge import Drawn, judge

EXPONENTS = (1.0, 1.001, 3.0, 1.5, 7.0, 40.0)
SHARES = {
    "paraboloid": 0.4,
    "cone": 0.2,
    "cylinder on a layer": 0.1,
    "sphere": 0.14,
    "power law": 0.1,
    "profile": 0.004,
    "direction average": 0.056,
    "average, cone": 0.02,
    "average, sweep": 0.01,
}
# numbers of branches: each size is compiled once
FEW, MANY = (1, 2, 3), (1, 2, 3, 5, 8, 16, 30, 60)


def draw(family: str, number: int, scenes: int, random: np.random.Generator) -> Drawn:
    """One scene of a family."""
    few = family not in ("paraboloid", "cone", "cylinder on a layer")
    count = int(random.choice(FEW if few else MANY))
    times = 10 ** random.uniform(-12, 12, count)
    if random.random() < 0.2:  # nearly equal
        times = 10 ** random.uniform(-12, 12) * (
            1 + 10 ** random.uniform(-15, -2, count)
        )
    times = np.unique(times)
    moduli = 10 ** random.uniform(0, 12, times.size)
    equilibrium = (
        0.0 if random.random() < 0.15 and not few else 10 ** random.uniform(0, 12)
    )
    viscosity = 10 ** random.uniform(-12, 12) if random.random() < 0.2 else 0.0
    law = Law(equilibrium, moduli, times, viscosity)
    control = str(random.choice(["load", "depth"]))
    load, depth = 10 ** random.uniform(-12, 12), 10 ** random.uniform(-9, -0.5)
    if family == "power law":
        which, size = random.integers(len(EXPONENTS)), 10 ** random.uniform(-6, 0)
        # half as much to compile
        exponent, control = EXPONENTS[which], ("load", "depth")[which % 2]
        body = (exponent, 10 ** random.uniform(-3, 0) * size ** (1 - exponent))
        depth *= body[1] * size**exponent
    elif family in ("cone", "average, cone"):
        body = (10 ** random.uniform(-4, 1),)
    elif family == "profile":
        r = np.linspace(0, 1, 8) * 10 ** random.uniform(-6, 0)
        powers, shares = (2, 3, 4), 10 ** random.uniform(-1, 0, 3)
        body = (
            r,
            r[-1]
            * sum(
                s * np.linspace(0, 1, 8) ** p
                for s, p in zip(shares, powers, strict=True)
            ),
        )
        depth, control = depth * body[1][-1], "load"  # half as much to compile
    else:
        body = (10 ** random.uniform(-6, 3),)
        depth *= body[0]
    if family in ("sphere", "profile"):
        # A load that the body can carry at any velocity: that of a relaxed contact of
        # 1e-4 to 0.5 of its radius.
        size = (
            random.uniform(0, 0.5)
            if random.random() < 0.5
            else 10 ** random.uniform(-4, -0.3)
        )
        size *= body[0][-1] if family == "profile" else body[0]
        load = (
            equilibrium
            * size
            * (
                size**2 / body[0]
                if family == "sphere"
                else body[1][-1] * (size / r[-1]) ** 2
            )
        )
    velocity = 10 ** random.uniform(-10, 10, 2)
    if family == "average, sweep":
        velocity[1] = _sweep(velocity)[random.integers(301)]
    rtol = (
        (1e-3 if family == "profile" else 1e-6)
        if few
        else float(random.choice([1e-3, 1e-6, 1e-9]))
    )
    return Drawn(
        family,
        number,
        scenes,
        law,
        body,
        control,
        load if control == "load" else depth,
        velocity,
        rtol,
    )


def answer(scene: Drawn) -> dict[str, Any]:
    """The public call."""
    import elastomdr as em

    law, body = scene.law, scene.body
    layer = scene.family == "cylinder on a layer"
    material = em.Foundation(*law, per_area=layer or None)
    shapes = {
        "power law": em.PowerLaw,
        "cone": em.Cone,
        "average, cone": em.Cone,
        "sphere": em.Sphere,
        "profile": _profile,
    }
    shape = (
        em.Cylinder(body[0], 1.0)
        if layer
        else shapes.get(scene.family, em.Paraboloid)(*body)
    )
    model = em.Averaged(corrected=False) if "average" in scene.family else em.Line()
    if scene.family == "average, sweep":
        return _of_sweep(scene, material, shape)
    options = {
        "velocity": scene.velocity,
        scene.control: scene.value,
        "rtol": scene.rtol,
        "model": model,
    }
    if layer:
        got = em.rolling(material, shape, **options)
        mu = got.coefficient
    else:
        got = em.friction(material, shape, **options)
        mu = got.mu
    found = {
        "mu": mu,
        "error": got.error,
        "normal": got.normal_force,
        "converged": got.converged,
    }
    if isinstance(model, em.Line):
        return found | {
            "leading": got.contact.leading,
            "trailing": got.contact.trailing,
        }
    panels = 8 if scene.family == "average, cone" else 1
    return found | {
        "average": _average(material, shape, scene.velocity, got.normal_force, panels)
    }


def _sweep(velocity: np.ndarray) -> np.ndarray:
    return np.geomspace(1e-3, 1e3, 301) * velocity[0]


def _of_sweep(scene: Drawn, material: Any, shape: Any) -> dict[str, Any]:
    """Two velocities of a sweep, and how far their depth and edges are from those of
    the line by itself.
    """
    import elastomdr as em

    sweep = _sweep(scene.velocity)
    got = em.friction(
        material,
        shape,
        velocity=sweep,
        rtol=scene.rtol,
        model=em.Averaged(corrected=False),
        **{scene.control: scene.value},
    )
    at = [int(np.argmin(np.abs(np.log(sweep / v)))) for v in scene.velocity]
    load = got.normal_force[at]
    line = em.friction(
        material,
        shape,
        velocity=scene.velocity,
        load=np.where(np.isfinite(load), load, 1.0),
        rtol=1e-10,
        model=em.Line(),
    )
    edges = (got.contact.trailing[at] - line.contact.trailing) / line.contact.leading
    ratios = (
        got.depth[at] / line.depth,
        got.contact.leading[at] / line.contact.leading,
        1 + edges,
    )
    found = {
        "mu": got.mu[at],
        "error": got.error[at],
        "normal": load,
        "converged": got.converged[at],
    }
    off = np.max([np.abs(ratio - 1) for ratio in ratios], axis=0)
    return found | {
        "average": _average(material, shape, scene.velocity, load),
        "off": off,
    }


def _profile(r: np.ndarray, z: np.ndarray) -> Any:
    import elastomdr as em

    return em.Profile(r, z, apex="smooth", curve="spline")


def _average(
    material: Any, shape: Any, velocity: np.ndarray, load: np.ndarray, panels: int = 1
) -> np.ndarray:
    """Gauss' rule on panels in s, so many to a unit, cos(phi) = sin((pi/2) exp(-s))."""
    import elastomdr as em

    node, weight = np.polynomial.legendre.leggauss(12)
    # Beyond the peak all angles down to exp(-28) count alike.
    s = ((np.arange(28 * panels)[:, None] + 0.5 * (node + 1)) / panels).ravel()
    theta = np.pi / 2 * np.exp(-s)
    load = np.where(np.isfinite(load), load, 1.0)
    slowed = velocity[:, None] * np.sin(theta)
    mu = em.friction(
        material,
        shape,
        velocity=slowed,
        load=load[:, None],
        rtol=1e-10,
        model=em.Line(),
    ).mu
    # The slowest lines may lose their loss to rounding. There mu rises with v, and what
    # they add is below theta^2.
    lost = np.cumprod(np.isnan(mu)[:, ::-1], axis=1)[:, ::-1].astype(bool) & (
        theta < 1e-6
    )
    return (
        2
        / np.pi
        * (np.where(lost, 0.0, mu) * np.sin(theta) * theta)
        @ np.tile(0.5 * weight / panels, 28 * panels)
    )


def about(scene: Drawn) -> str:
    size, value = (
        ", ".join(f"{x:g}" for x in np.ravel(scene.body)[:2]),
        f"{scene.control} {scene.value:.3g}",
    )
    return (
        f"{scene.law.moduli.size} branches, body ({size}), {value}, velocities "
        f"{scene.velocity}, rtol {scene.rtol:g}"
    )


SUITE = Suite(
    name="stress",
    title="Stress: random scenes, each right or flagged",
    scenes=5000,
    families={name: (share, 1) for name, share in SHARES.items()},
    draw=draw,
    answer=answer,
    judge=judge,
    about=about,
)

if __name__ == "__main__":
    sys.exit(run(SUITE))
