"""Random scenes of steady sliding, judged by slow routes that share nothing with
elastomdr.

Paraboloids, cones and cylinders on layers in closed form with mpmath, spheres, power
laws and profiles by a march (both `slow_route.py`), the direction average by Gauss'
rule over 336 bare lines (2,688 under cones) that are judged apart. An answer is taken
at the contact size it came with: how far the judge's load is off there counts as an
error of mu too.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from slow_route import Body, Law, closed, from_points, marched
from stress_harness import Verdict

# what each route itself is good to, relative
JUDGES = {"closed": 3e-14, "marched": 1e-9, "lines": 3e-11}


class Drawn(NamedTuple):
    """A scene as numbers, so that another process can judge it."""

    family: str
    number: int
    scenes: int
    law: Law
    body: tuple  # its numbers
    control: str
    value: float  # load [N] or depth [m]
    velocity: np.ndarray  # [m/s]
    rtol: float


def judge(scene: Drawn, found: dict[str, Any]) -> list[Verdict]:
    """Per velocity: "right", "wrong", "flagged" or "unjudged", the relative miss, and
    that over the stated error.
    """
    judged = []
    for i, velocity in enumerate(scene.velocity):
        mu, error = float(found["mu"][i]), float(found["error"][i])
        if not found["converged"][i]:
            judged.append(("flagged" if np.isnan(mu) else "wrong", np.nan, np.nan))
            continue
        try:
            miss, route = _miss(scene, found, i, float(velocity), mu)
        except Exception:  # the judge's own failure: reported, never counted as right
            judged.append(("unjudged", np.nan, np.nan))
            continue
        own = JUDGES[route]
        right = mu >= 0 and miss <= scene.rtol + own
        judged.append(
            (
                "right" if right else "wrong",
                miss,
                max(miss - own, 0.0) / (error / mu if mu > 0 else np.inf),
            )
        )
    return judged


def _miss(
    scene: Drawn, found: dict[str, Any], i: int, velocity: float, mu: float
) -> tuple[float, str]:
    """Relative difference of mu to the judge's, with that of the load or depth at the
    contact size given.
    """
    if "average" in scene.family:
        if not math.isfinite(found["average"][i]):
            raise ArithmeticError("a line of the judge failed")
        if "off" in found and not found["off"][i] <= scene.rtol:
            return math.inf, "lines"
        return abs(mu / found["average"][i] - 1), "lines"
    a = float(found["leading"][i])
    power, steepness, body = _line(scene)
    if body is None:
        truth, route = closed(power, steepness, scene.law, velocity, a), "closed"
        depth = steepness * a**power
    else:
        truth, route = marched(body, scene.law, velocity, a), "marched"
        depth = float(body.profile(a))
    wanted = (
        truth.normal_force if scene.control == "load" else depth
    ) / scene.value - 1
    force = truth.normal_force / found["normal"][i] - 1
    edge = abs(truth.trailing - found["trailing"][i]) / a
    if not math.isfinite(truth.mu):
        raise ArithmeticError("the judge has no answer")
    glassy = scene.law.equilibrium + scene.law.moduli.sum()
    # Under a dashpot a flat body presses with less than rounding near its trailing
    # edge.
    if edge > 1e-5 and glassy * depth * edge * a > 1e-13 * truth.normal_force:
        return math.inf, route
    return abs(mu / truth.mu - 1) + abs(wanted) + abs(force), route


def _line(scene: Drawn) -> tuple[int, float, Body | None]:
    """Power and steepness of g = c |x|^n for the closed forms, or the body for the
    march.
    """
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
    c = (
        scene.body[1]
        * math.sqrt(math.pi)
        * n
        * math.gamma(n / 2)
        / (2 * math.gamma((n + 1) / 2))
    )
    return (
        0,
        0.0,
        Body(
            lambda x: c * np.abs(x) ** n,
            lambda x: c * n * np.sign(x) * np.abs(x) ** (n - 1),
        ),
    )
