"""Is every answer right or flagged? 5,000 random scenes against slow routes that share nothing with elastomdr.

    python benchmarks/stress.py [--scenes N] [--seed S] [--show K]

Every scene has a material, a body and a load or depth of its own, and two velocities: 1 to 60 branches, their times
over 24 decades or nearly equal, moduli over 12 decades, with and without equilibrium modulus and dashpot; velocities
over 20 decades; paraboloids and cones (judged in closed form with mpmath), spheres, power laws with exponents from 1
to 40, cylinders on layers, profiles from points (judged by a march of their own, `slow_route.py`), and the direction
average (judged by Gauss' rule over 336 bare lines). An answer is taken at the contact size it came with: how far the
judge's load is off there counts as an error of mu too. Wrong is a converged answer off by more than rtol; covered one
that is off by no more than its `error`; flagged one that is NaN with converged=False.
"""

import argparse
import math
import multiprocessing
import os
import sys
import time
import traceback
import warnings
from concurrent.futures import ProcessPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from slow_route import Body, Law, closed, from_points, marched

JUDGES = {"closed": 3e-14, "marched": 1e-9, "lines": 3e-11}  # what each route itself is good to, relative
EXPONENTS = (1.0, 1.001, 3.0, 1.5, 7.0, 40.0)
SHARES = {  # of the scenes
    "paraboloid": 0.4, "cone": 0.2, "cylinder on a layer": 0.1, "sphere": 0.14, "power law": 0.1, "profile": 0.004,
    "direction average": 0.056,
}  # fmt: skip
FEW, MANY = (1, 2, 3), (1, 2, 3, 5, 8, 16, 30, 60)  # numbers of branches: each size is compiled once


class Drawn(NamedTuple):
    """A scene as numbers, so that another process can judge it."""

    family: str
    law: Law
    body: tuple  # its numbers
    control: str
    value: float  # load [N] or depth [m]
    velocity: np.ndarray  # [m/s]
    rtol: float


class Answer(NamedTuple):
    """What elastomdr said of a scene, per velocity."""

    mu: np.ndarray
    error: np.ndarray
    normal: np.ndarray
    leading: np.ndarray
    trailing: np.ndarray
    converged: np.ndarray


def draw(family: str, random: np.random.Generator) -> Drawn:
    """One scene of a family."""
    few = family not in ("paraboloid", "cone", "cylinder on a layer")
    count = int(random.choice(FEW if few else MANY))
    times = 10 ** random.uniform(-12, 12, count)
    if random.random() < 0.2:  # nearly equal
        times = 10 ** random.uniform(-12, 12) * (1 + 10 ** random.uniform(-15, -2, count))
    times = np.unique(times)
    moduli = 10 ** random.uniform(0, 12, times.size)
    equilibrium = 0.0 if random.random() < 0.15 and not few else 10 ** random.uniform(0, 12)
    viscosity = 10 ** random.uniform(-12, 12) if random.random() < 0.2 else 0.0
    law = Law(equilibrium, moduli, times, viscosity)
    control = str(random.choice(["load", "depth"]))
    load, depth = 10 ** random.uniform(-12, 12), 10 ** random.uniform(-9, -0.5)
    if family == "power law":
        which, size = random.integers(len(EXPONENTS)), 10 ** random.uniform(-6, 0)
        exponent, control = EXPONENTS[which], ("load", "depth")[which % 2]  # half as much to compile
        body = (exponent, 10 ** random.uniform(-3, 0) * size ** (1 - exponent))
        depth *= body[1] * size**exponent
    elif family == "cone":
        body = (10 ** random.uniform(-4, 1),)
    elif family == "profile":
        r = np.linspace(0, 1, 8) * 10 ** random.uniform(-6, 0)
        powers, shares = (2, 3, 4), 10 ** random.uniform(-1, 0, 3)
        body = (r, r[-1] * sum(s * np.linspace(0, 1, 8) ** p for s, p in zip(shares, powers, strict=True)))
        depth, control = depth * body[1][-1], "load"  # half as much to compile
    else:
        body = (10 ** random.uniform(-6, 3),)
        depth *= body[0]
    if family in ("sphere", "profile"):
        # A load that the body can carry at any velocity: that of a relaxed contact of 1e-4 to 0.5 of its radius.
        size = random.uniform(0, 0.5) if random.random() < 0.5 else 10 ** random.uniform(-4, -0.3)
        size *= body[0][-1] if family == "profile" else body[0]
        load = equilibrium * size * (size**2 / body[0] if family == "sphere" else body[1][-1] * (size / r[-1]) ** 2)
    velocity = 10 ** random.uniform(-10, 10, 2)
    rtol = (1e-3 if family == "profile" else 1e-6) if few else float(random.choice([1e-3, 1e-6, 1e-9]))
    return Drawn(family, law, body, control, load if control == "load" else depth, velocity, rtol)


def answer(scene: Drawn) -> Answer:
    """The public call."""
    import elastomdr as em

    law, body = scene.law, scene.body
    layer = scene.family == "cylinder on a layer"
    material = em.Foundation(*law, per_area=layer or None)
    shapes = {"power law": em.PowerLaw, "cone": em.Cone, "sphere": em.Sphere, "profile": _profile}
    shape = em.Cylinder(body[0], 1.0) if layer else shapes.get(scene.family, em.Paraboloid)(*body)
    average = "direction" if scene.family == "direction average" else None
    options = {"velocity": scene.velocity, scene.control: scene.value, "rtol": scene.rtol, "average": average}
    if layer:
        rolled = em.rolling(material, shape, **options)
        return Answer(rolled.coefficient, rolled.error, rolled.normal_force, *rolled.contact, rolled.converged)
    got = em.friction(material, shape, **options)
    if average is None:
        return Answer(got.mu, got.error, got.normal_force, *got.contact, got.converged)
    truth = _average(material, shape, scene.velocity, got.normal_force)  # rides in the place of the leading edge
    return Answer(got.mu, got.error, got.normal_force, truth, truth, got.converged)


def _profile(r: np.ndarray, z: np.ndarray) -> Any:
    import elastomdr as em

    return em.Profile(r, z, apex="smooth", curve="spline")


def _average(material: Any, shape: Any, velocity: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Gauss' rule on panels in s, cos(phi) = sin((pi/2) exp(-s))."""
    import elastomdr as em

    node, weight = np.polynomial.legendre.leggauss(12)
    s = (np.arange(28)[:, None] + 0.5 * (node + 1)).ravel()  # beyond the peak all angles down to exp(-28) count alike
    theta = np.pi / 2 * np.exp(-s)
    load = np.where(np.isfinite(load), load, 1.0)
    slowed = velocity[:, None] * np.sin(theta)
    mu = em.friction(material, shape, velocity=slowed, load=load[:, None], rtol=1e-10, average=None).mu
    # The slowest lines may lose their loss to rounding. There mu rises with v, and what they add is below theta^2.
    lost = np.cumprod(np.isnan(mu)[:, ::-1], axis=1)[:, ::-1].astype(bool) & (theta < 1e-6)
    return 2 / np.pi * (np.where(lost, 0.0, mu) * np.sin(theta) * theta) @ np.tile(0.5 * weight, 28)


def judge(scene: Drawn, found: Answer) -> list[tuple[str, float, float]]:
    """Per velocity: "right", "wrong", "flagged" or "unjudged", the relative miss, and that over the stated error."""
    judged = []
    for i, velocity in enumerate(scene.velocity):
        mu, error = float(found.mu[i]), float(found.error[i])
        if not found.converged[i]:
            judged.append(("flagged" if np.isnan(mu) else "wrong", np.nan, np.nan))
            continue
        try:
            miss, route = _miss(scene, found, i, float(velocity), mu)
        except Exception:  # the judge's own failure: reported, never counted as right
            judged.append(("unjudged", np.nan, np.nan))
            continue
        own = JUDGES[route]
        right = mu >= 0 and miss <= scene.rtol + own
        judged.append(("right" if right else "wrong", miss, max(miss - own, 0.0) / (error / mu if mu > 0 else np.inf)))
    return judged


def _miss(scene: Drawn, found: Answer, i: int, velocity: float, mu: float) -> tuple[float, str]:
    """Relative difference of mu to the judge's, with that of the load or depth at the contact size given."""
    if scene.family == "direction average":
        if not math.isfinite(found.leading[i]):
            raise ArithmeticError("a line of the judge failed")
        return abs(mu / found.leading[i] - 1), "lines"
    a = float(found.leading[i])
    power, steepness, body = _line(scene)
    if body is None:
        truth, route = closed(power, steepness, scene.law, velocity, a), "closed"
        depth = steepness * a**power
    else:
        truth, route = marched(body, scene.law, velocity, a), "marched"
        depth = float(body.profile(a))
    wanted = (truth.normal_force if scene.control == "load" else depth) / scene.value - 1
    force = truth.normal_force / found.normal[i] - 1
    edge = abs(truth.trailing - found.trailing[i]) / a
    if not math.isfinite(truth.mu):
        raise ArithmeticError("the judge has no answer")
    if edge > 1e-5:
        return math.inf, route
    return abs(mu / truth.mu - 1) + abs(wanted) + abs(force), route


def _line(scene: Drawn) -> tuple[int, float, Body | None]:
    """Power and steepness of g = c |x|^n for the closed forms, or the body for the march."""
    first = scene.body[0]
    if scene.family == "paraboloid":
        return 2, 1 / first, None
    if scene.family == "cylinder on a layer":
        return 2, 0.5 / first, None
    if scene.family == "cone":
        return 1, 0.5 * math.pi * first, None
    if scene.family == "sphere":

        def rise(x: Any) -> Any:
            c = x / first
            return np.arctanh(c) + c / (1 - c**2)

        return 0, 0.0, Body(lambda x: x * np.arctanh(x / first), rise)
    if scene.family == "profile":
        return 0, 0.0, from_points(*scene.body)
    n = first
    c = scene.body[1] * math.sqrt(math.pi) * n * math.gamma(n / 2) / (2 * math.gamma((n + 1) / 2))
    return 0, 0.0, Body(lambda x: c * np.abs(x) ** n, lambda x: c * n * np.sign(x) * np.abs(x) ** (n - 1))


def main() -> int:
    options = argparse.ArgumentParser(description="Random scenes against slow routes.")
    options.add_argument("--scenes", type=int, default=5000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--show", type=int, default=10, help="how many wrong scenes are printed")
    options.add_argument("--others", type=int, default=0, help="how many flagged and uncovered ones are printed")
    options.add_argument("--family", choices=list(SHARES))
    chosen = options.parse_args()
    from common import heading, save, table, verdict

    record = heading(
        "Stress: random scenes, each right or flagged",
        f"{chosen.scenes} scenes, two velocities each, seed {chosen.seed}",
    )
    begin = time.perf_counter()
    scenes, crashed = [], []
    for number, (family, share) in enumerate(SHARES.items()):
        if chosen.family in (None, family):
            for i in range(round(share * chosen.scenes)):
                scenes.append(draw(family, np.random.default_rng([chosen.seed, number, i])))
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn")) as pool:
        waiting = []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for scene in scenes:
                try:
                    waiting.append((scene, found := answer(scene), pool.submit(judge, scene, found)))
                except Exception:
                    crashed.append((scene, traceback.format_exc(limit=-3)))
        took = time.perf_counter() - begin
        verdicts = [(scene, found, said.result()) for scene, found, said in waiting]
    rows, wrong, others = [], [], []
    for family in dict.fromkeys(scene.family for scene in scenes):
        ours = [(s, f, said) for s, f, all_said in verdicts if s.family == family for said in all_said]
        kinds = [said[0] for *_, said in ours]
        misses = np.array([said[1] for *_, said in ours])
        ratios = np.array([said[2] for *_, said in ours if said[0] in ("right", "wrong")])
        failed = sum(s.family == family for s, _ in crashed)
        rows.append(
            (family, sum(s.family == family for s in scenes), len(kinds), kinds.count("wrong"), kinds.count("flagged"),
             kinds.count("unjudged"), failed, float(np.nanmax(misses, initial=0)),
             100 * float(np.mean(np.append(ratios, 1.0)[: max(ratios.size, 1)] <= 1)))
        )  # fmt: skip
        wrong += [(s, f, said) for s, f, said in ours if said[0] == "wrong"]
        others += [(s, f, said) for s, f, said in ours if said[0] in ("flagged", "unjudged") or said[2] > 1]
    record["families"] = table(
        ("family", "scenes", "points", "wrong", "flagged", "unjudged", "crashed", "largest miss of mu", "covered [%]"),
        rows,
    )
    for scene, found, said in wrong[: chosen.show]:
        print(f"\n  WRONG {said}\n    {scene}\n    {found}")
    for scene, found, said in others[: chosen.others]:
        print(f"\n  {said}\n    {scene}\n    {found}")
    for scene, text in crashed[: chosen.show]:
        print(f"\n  CRASHED {scene}\n{text}")
    ratios = np.array([r for *_, all_said in verdicts for kind, _, r in all_said if kind in ("right", "wrong")])
    points = sum(row[2] for row in rows)
    print()
    record["verdicts"] = [
        verdict("points wrong and not flagged", len(wrong), 0),
        verdict("scenes that crashed", len(crashed), 0),
        verdict("points that the judge could not judge", sum(row[5] for row in rows), 0),
        verdict("true error within `error`", 100 * float(np.mean(ratios <= 1)), 99, " %", least=True),
        verdict("points flagged", 100 * sum(row[4] for row in rows) / max(points, 1), 1, " %"),
    ]
    record["seconds"] = {"answers": took, "all": time.perf_counter() - begin}
    print(f"  {took:.0f} s for the answers, compiling included; {record['seconds']['all']:.0f} s with the judges")
    if chosen.family is None and chosen.scenes >= 5000:
        save("stress", record)
    return 1 if wrong or crashed else 0


if __name__ == "__main__":
    sys.exit(main())
