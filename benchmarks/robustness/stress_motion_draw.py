"""Random histories: what the stress test of motion draws.

1 to 60 branches, their times over 24 decades, around the duration of the scene, or
nearly equal; moduli over 12 decades, with and without equilibrium modulus and dashpot;
bodies from a cone to |x|^12, cylinders on layers.
"""

from typing import Any, NamedTuple

import numpy as np
from slow_route import Law

POWERS = {"paraboloid": 2.0, "cone": 1.0, "r^1.5": 1.5, "r^12": 12.0, "cylinder": 2.0}
# numbers of branches, and how often
BRANCHES, FEW_OFTEN = (1, 3, 8, 60), (0.4, 0.35, 0.2, 0.05)
INSTANTS = 6


class Batch(NamedTuple):
    """Scenes of one compiled shape, as numbers, so that another process can judge
    them.
    """

    family: str
    number: int  # of the batch in its family: seed and number draw it again
    scenes: int
    laws: list[Law]
    body: str
    size: float  # coefficient of g = size |x|^power
    inputs: dict[str, Any]
    rtol: float


def draw(family: str, number: int, scenes: int, random: np.random.Generator) -> Batch:
    """Scenes of a family."""
    body = "paraboloid"
    if family.startswith("indent"):
        body = str(random.choice(list(POWERS)))
    elif family == "impact":
        body = str(random.choice(["paraboloid", "cone", "r^1.5"]))
    elif family == "traction":
        body = str(random.choice(["paraboloid", "cylinder"]))
    power = POWERS[body]
    length = 10 ** random.uniform(-9, 2)  # of the contact
    steepness = 10 ** random.uniform(-4, 0)
    size = steepness * length ** (1 - power)
    depth = size * length**power
    span = 10 ** random.uniform(-12, 12)
    laws = [
        law(random, span, family, body)
        for _ in range(scenes if family in ("impact", "traction") else 1)
    ]
    rtol = 1e-6
    inputs: dict[str, Any] = {}
    if family == "indent, depth":
        times = np.cumsum(
            np.c_[
                np.zeros(scenes),
                span * 10 ** random.uniform(-3, 0, (scenes, INSTANTS - 1)),
            ],
            axis=1,
        )
        moved = random.uniform(-0.4, 1.0, (scenes, INSTANTS))
        moved[:, 0] = (
            0.0
            if laws[0].viscosity > 0
            else np.where(random.random(scenes) < 0.5, 0, abs(moved[:, 0]))
        )
        inputs = {"time": times, "depth": depth * moved}
        rtol = float(random.choice([1e-4, 1e-6, 1e-9]))
    elif family == "indent, load":
        times = np.cumsum(
            np.c_[
                np.zeros(scenes),
                span * 10 ** random.uniform(-2, 0, (scenes, INSTANTS - 1)),
            ],
            axis=1,
        )
        part = np.where(
            random.random((scenes, INSTANTS)) < 0.2,
            0,
            random.uniform(0, 1, (scenes, INSTANTS)),
        )
        part[:, -1] = random.uniform(0.1, 1, scenes)
        inputs = {"time": times, "load": 10 ** random.uniform(-9, 9) * part}
        rtol = 1e-4
    elif family == "impact":
        # Mass and speed so that an elastic body of all moduli has a contact of about
        # `span`.
        stiff = laws[0].equilibrium + laws[0].moduli.sum()
        speed = 10 ** random.uniform(-10, 10) * 10 ** random.uniform(-1, 1, scenes)
        factor = elastic(body, size)
        mass = (
            stiff
            * factor
            * (speed * span) ** (power + 1)
            / speed**2
            * 10 ** random.uniform(-1, 1, scenes)
        )
        inputs = {"mass": mass, "velocity": speed}
    elif family == "traction":
        velocity = length / span * 10 ** random.uniform(-2, 2, scenes)
        sheared = [law(random, span, family, body) for _ in range(scenes)]
        mu = 10 ** random.uniform(-2, 0.5, scenes)
        mu = np.where(
            random.random(scenes) < 0.05, random.choice([0.0, np.inf], scenes), mu
        )
        creepage = (
            np.where(np.isfinite(mu), np.maximum(mu, 0.01), 1.0)
            * steepness
            * 10 ** random.uniform(-4, 1, scenes)
        )
        creepage = np.where(random.random(scenes) < 0.03, 0.0, creepage)
        inputs = {
            "velocity": velocity,
            "creepage": creepage,
            "friction": mu,
            "depth": depth,
            "sheared": sheared,
        }
    else:
        times = np.cumsum(np.r_[0.0, span * 10 ** random.uniform(-2, 0, INSTANTS - 1)])
        mu = 10 ** random.uniform(-2, 0.5)
        top = np.full(INSTANTS, depth)
        if family == "shear, elastic":
            laws = [bare(random), bare(random)]
            if random.random() < 0.6:
                top = depth * random.uniform(0, 1, INSTANTS)
        else:
            laws = [law(random, span, family, body), law(random, span, family, body)]
        ratio = (laws[0].equilibrium + laws[0].moduli.sum()) / (
            laws[1].equilibrium + laws[1].moduli.sum()
        )
        far = mu * depth * ratio * 10 ** random.uniform(-3, 1)
        inputs = {
            "time": times,
            "displacement": far * random.uniform(-1, 1, INSTANTS),
            "friction": mu,
            "depth": top,
        }
        rtol = 1e-2
    return Batch(family, number, scenes, laws, body, size, inputs, rtol)


def bare(random: np.random.Generator) -> Law:
    return Law(10 ** random.uniform(0, 12), np.zeros(0), np.zeros(0), 0.0)


def law(random: np.random.Generator, span: float, family: str, body: str) -> Law:
    """A Prony series: anywhere, around a duration, or with nearly equal times."""
    kind, count = random.random(), 3  # each number and body is compiled once
    if family in ("indent, depth", "impact") and body == "paraboloid":
        count = int(random.choice(BRANCHES, p=FEW_OFTEN))
    times = 10 ** random.uniform(-12, 12, count)
    if kind < 0.6:
        times = span * 10 ** random.uniform(-3, 3, count)
    elif kind < 0.75:
        times = (
            span
            * 10 ** random.uniform(-2, 2)
            * (1 + 10 ** random.uniform(-15, -2, count))
        )
    times = np.unique(times)
    while times.size < count:  # a branch that became equal to another
        times = np.unique(np.append(times, times[-1] * 2.0))
    base = 10 ** random.uniform(0, 12)
    moduli = (
        10 ** random.uniform(0, 12, count)
        if random.random() < 0.4
        else base * 10 ** random.uniform(-2, 2, count)
    )
    soft = (
        10 ** random.uniform(0, 12)
        if random.random() < 0.3
        else base * 10 ** random.uniform(-2, 1)
    )
    if random.random() < 0.15 and family != "traction":
        soft = 0.0
    dashpot = 0.0
    if random.random() < 0.2 and not family.startswith("shear"):
        dashpot = base * span * 10 ** random.uniform(-4, 1)
    return Law(soft, moduli, times, dashpot)


def elastic(body: str, size: float) -> float:
    """A(d)/d^((n+1)/n) of an elastic body with g = size |x|^n: force over E*."""
    n = POWERS[body]
    return 2 * n / (n + 1) * size ** (-1 / n)
