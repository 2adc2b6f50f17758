"""Is every answer on a rough surface right or flagged? Random spectra and rubbers
against slow routes.

    python benchmarks/robustness/stress_surfaces.py [--scenes N] [--seed S] [--family F] [--show K]

Spectra from 0.1 to 6 decades, self-affine with and without roll-off or tables with
bends; 1 to 30 branches over 16 decades of time, shifted by WLF and by an entropic
vertical law; pressures from light to full contact, velocities over 18 decades; strain
softening, adhesive shear. `persson` and `multiscale`: against the integrals of
`docs/theory.md`, a second time; `full contact`: both at so high a pressure that the
closed integral is exact; `line`: a rough line that touches everywhere; `cells`:
`em.reference.half_space_sliding` on a map, against elimination with a dense matrix;
`press`: a line pressed on, against bisection and Laplace's inversion. The routes are in
`slow_surface.py`.
"""

import math
import sys
from typing import Any, NamedTuple

import numpy as np
from slow_route import Law
from stress_harness import Suite, Verdict, run

FAMILIES = {
    "persson": (0.3, 1),
    "multiscale": (0.42, 1),
    "full contact": (0.1, 1),
    "line": (0.04, 1),
    "cells": (0.06, 1),
    "press": (0.08, 1),
}
C1, C2, REFERENCE = 8.86, 101.6, 293.15  # of WLF's law


class Drawn(NamedTuple):
    """A scene as numbers, so that another process can judge it."""

    family: str
    number: int
    scenes: int
    law: Law  # of E*, at the reference temperature
    q: np.ndarray  # of the spectrum, or x of a line
    c: np.ndarray  # or heights
    velocity: np.ndarray  # or times under a load
    pressure: np.ndarray
    kelvin: float
    options: dict[str, Any]
    rtol: float


def draw(family: str, number: int, scenes: int, random: np.random.Generator) -> Drawn:
    """One scene of a family."""
    count = int(random.choice([1, 2, 3, 8, 30]))
    times = np.unique(10 ** random.uniform(-12, 4, count))
    base = 10 ** random.uniform(3, 9)
    moduli = base * 10 ** random.uniform(-3, random.uniform(-1, 4), times.size)
    dashpot = (
        base * 10 ** random.uniform(-12, -2)
        if random.random() < 0.1 and family != "cells"
        else 0.0
    )
    law = Law(base, moduli, times, dashpot)
    low = 10 ** random.uniform(1, 6)
    decades = (
        random.uniform(0.1, 1.5) if random.random() < 0.3 else random.uniform(1.0, 6.0)
    )
    if random.random() < 0.5:  # self-affine
        hurst, knee = (
            random.uniform(0.05, 1.0),
            random.uniform(0, decades) if random.random() < 0.4 else 0.0,
        )
        q = low * 10 ** np.unique([0.0, knee, decades])
        c = np.append([1.0] * (q.size - 1), (q[-1] / q[-2]) ** (-2 - 2 * hurst))
    else:
        q = low * 10 ** (decades * np.linspace(0, 1, int(random.integers(2, 12))))
        c = np.exp(
            np.r_[
                0.0, np.cumsum(-random.uniform(-1, 6, q.size - 1) * np.diff(np.log(q)))
            ]
        )
    slope = 10 ** random.uniform(-3, 0.3)
    c = c * slope**2 / (2 * np.pi * moment(q, c, 3))
    stiff = base * 10 ** random.uniform(0, np.log10(1 + moduli.sum() / base))
    pressure = stiff * slope * 10 ** random.uniform(-3, 1, 2)
    velocity = 10 ** random.uniform(-14, 4, 2) / low
    options: dict[str, Any] = {"gamma": 0.5, "stored": True}
    kelvin = 0.0
    if random.random() < 0.4:
        kelvin = random.uniform(250, 380)
        options["vertical"] = bool(random.random() < 0.5)
    if family in ("persson", "multiscale"):
        if random.random() < 0.3:
            options["soft"] = (
                10 ** random.uniform(-3, -0.5),
                random.uniform(1.2, 10),
                *random.uniform(0.1, 1, 4),
            )
            options["share"] = random.uniform(0.2, 1.0)
        if random.random() < 0.3:
            options["shear"] = (
                10 ** random.uniform(2, 8),
                10 ** random.uniform(-6, 2),
                random.uniform(0, 0.5),
            )
    if family == "persson" and random.random() < 0.5:
        options |= {
            "gamma": float(random.choice([0.0, 1.0, random.random()])),
            "stored": bool(random.random() < 0.5),
        }
    if family == "full contact":
        options["model"] = str(random.choice(["persson", "multiscale"]))
        pressure = (
            1e4
            * slope
            * (base + moduli.sum() + dashpot * velocity.max() * q[-1])
            * np.ones(2)
        )
    rtol = float(random.choice([1e-3, 1e-6, 1e-8]))
    if family in ("line", "press"):
        n = int(random.choice([64, 100, 256]))
        q, rough = 2 * np.pi / low / n * np.arange(n), np.zeros(n)
        for j in range(1, n // 8):
            rough += (
                random.normal()
                * j ** -random.uniform(0.6, 2.5)
                * np.cos(2 * np.pi * (j * np.arange(n) / n + random.random()))
            )
        c = slope / low * rough / rough.std()
        if family == "line":
            top = stiff if dashpot == 0 else stiff + dashpot * velocity.max() * low * n
            pressure = (
                (top + moduli.sum())
                * np.ptp(c)
                * low
                * n
                * 10 ** random.uniform(-1, 1, 2)
                / low
            )
        else:
            pressure = (
                base * np.ptp(c) * low / 2 / np.pi * 10 ** random.uniform(-3, 0.3, 2)
            )
            velocity = 10 ** random.uniform(-13, 5, 2)
            options |= {
                "length": 10 ** random.uniform(-1, 1) / low,
                "long": bool(random.random() < 0.3),
            }
    if family == "cells":
        q = low * np.array([1.0, random.uniform(1.5, 8.0)])
        c = np.array([1.0, (q[1] / q[0]) ** -random.uniform(2, 4)])
        c = c * slope**2 / (2 * np.pi * moment(q, c, 3))
        pressure = stiff * slope * 10 ** random.uniform(-1.5, 0.7, 1)
        velocity, kelvin = velocity[:1], 0.0
        options["seed"] = int(random.integers(1000))
    return Drawn(
        family, number, scenes, law, q, c, velocity, pressure, kelvin, options, rtol
    )


def moment(q: np.ndarray, c: np.ndarray, power: float) -> float:
    """int q^power C dq of a spectrum of power laws."""
    total = 0.0
    for a, b, at, to in zip(q[:-1], q[1:], c[:-1], c[1:], strict=True):
        s = np.log(to / at) / np.log(b / a) + power + 1
        total += (
            at
            * a ** (power + 1)
            * (np.expm1(s * np.log(b / a)) / s if abs(s) > 1e-12 else np.log(b / a))
        )
    return float(total)


def answer(scene: Drawn) -> dict[str, Any]:
    """The public call, and what of it is judged."""
    import elastomdr as em

    law, more = scene.law, scene.options
    softening = adhesion = None
    if "soft" in more:
        first, times, *f = more["soft"]
        factors = sorted(f[:2], reverse=True), [2 * f[2], 2 * f[3]]
        softening = em.Softening([first, first * times], *factors)
    if "shear" in more:
        adhesion = em.AdhesiveShear(*more["shear"])
    # E* = 4 G
    rubber = em.Prony(
        law.equilibrium / 4,
        law.moduli / 4,
        law.times,
        viscosity=law.viscosity / 4,
        softening=softening,
        shift=em.WLF(C1, C2, REFERENCE),
        vertical=em.EntropicVertical(REFERENCE) if more.get("vertical") else None,
    )
    warm = {"temperature": scene.kelvin} if scene.kelvin else {}
    given = {"velocity": scene.velocity, **warm}
    if scene.family == "press":
        model, line = (
            em.Line(equivalent_length=more["length"]),
            em.RoughLine(scene.q, scene.c),
        )
        time = {} if more["long"] else {"time": scene.velocity}
        got = em.press(
            rubber, line, pressure=scene.pressure, model=model, **time, **warm
        )
        names = ("separation", "conductance", "stiffness", "converged")
        return {name: np.asarray(getattr(got, name)) for name in names}
    if scene.family == "line":
        line = em.RoughLine(scene.q, scene.c)
        curve = em.friction(
            rubber, line, load=scene.pressure, model=em.Line(), rtol=scene.rtol, **given
        )
        closed = em.reference.full_contact_sliding(
            rubber, line, load=scene.pressure, **given
        )
        return {
            "mu": curve.mu,
            "error": curve.error,
            "converged": curve.converged,
            "closed": np.asarray(closed),
        }
    road = em.Spectrum(scene.q, scene.c, convention="2d")
    if scene.family == "cells":
        heights, side = em.reference.rough_map(road, more["seed"], periods=1, points=32)
        curve = em.reference.half_space_sliding(
            rubber, heights, load=scene.pressure * side**2, cell=(side, side), **given
        )
        return {
            "mu": curve.mu,
            "converged": curve.converged,
            "heights": heights,
            "side": side,
            "error": curve.error,
        }
    own = more.get("model", scene.family)
    model = (
        em.Multiscale()
        if own == "multiscale"
        else em.Persson(more["gamma"], more["stored"])
    )
    try:
        curve = em.friction(
            rubber,
            road,
            pressure=scene.pressure,
            model=model,
            adhesion=adhesion,
            rtol=scene.rtol,
            strain_share=more.get("share", 0.5),
            **given,
        )
    except em.InputError as error:
        if "enough for a real contact" not in str(error):
            raise
        # refused: as good as flagged
        return {"mu": np.full(2, np.nan), "converged": np.zeros(2, bool)}
    return {
        "mu": curve.mu,
        "hysteresis": curve.hysteresis,
        "area": curve.area_ratio,
        "error": curve.error,
        "converged": curve.converged,
    }


def judge(scene: Drawn, found: dict[str, Any]) -> list[Verdict]:
    """A verdict per point."""
    out = []
    for i in range(scene.velocity.size):
        if not found["converged"][i]:
            first = found["separation" if scene.family == "press" else "mu"][i]
            out.append(("flagged" if np.isnan(first) else "wrong", np.nan, np.nan))
            continue
        miss, own, over = JUDGES.get(scene.family, _theory)(scene, found, i)
        if math.isnan(miss) or own > 0.1 * scene.rtol:
            kind = "unjudged"
        else:
            kind = "right" if miss <= scene.rtol + own else "wrong"
        out.append((kind, float(miss), float(over)))
    return out


def _thermal(scene: Drawn) -> tuple[float, float]:
    """a_T and b_T."""
    if not scene.kelvin:
        return 1.0, 1.0
    warmer = scene.kelvin - REFERENCE
    return 10 ** (
        -C1 * warmer / (C2 + warmer)
    ), scene.kelvin / REFERENCE if scene.options.get("vertical") else 1.0


def _theory(scene: Drawn, found: dict[str, Any], i: int) -> tuple[float, float, float]:
    from slow_surface import theory

    more, (a, b) = scene.options, _thermal(scene)
    soften, kinks = None, ()
    if "soft" in more:
        soften = _softened(*more["soft"][:2], more["soft"][2:], more["share"])
        kinks = _kinks(scene)
    model = more.get("model", scene.family)
    law = Law(
        b * scene.law.equilibrium,
        b * scene.law.moduli,
        a * scene.law.times,
        a * b * scene.law.viscosity,
    )
    point = (
        law,
        scene.q,
        scene.c,
        float(scene.velocity[i]),
        float(scene.pressure[i]),
        model,
    )
    truth, own = None, math.inf
    for fine in (2, 3, 6, 9):  # finer until the judge knows a tenth of what it allows
        coarse, truth = (
            truth,
            theory(*point, more["gamma"], more["stored"], soften, kinks, fine),
        )
        if coarse is not None:
            own = (
                abs(coarse.mu / truth.mu - 1) + abs(coarse.area / truth.area - 1)
            ) / 4 + 3e-10
        if own <= 0.1 * scene.rtol:
            break
    mu, area = float(found["mu"][i]), float(found["area"][i])
    whole, parts = truth.mu, []
    if "shear" in more:
        stress, peak, width = more["shear"]
        whole += (
            stress
            * math.exp(-width * math.log10(scene.velocity[i] / peak) ** 2)
            * truth.area
            / scene.pressure[i]
        )
        parts = [abs(float(found["hysteresis"][i]) / truth.mu - 1)]
    if scene.family == "full contact":
        parts = [abs(mu / truth.full - 1) - 1e-6]
    miss = abs(mu / whole - 1)
    return (
        max(miss, *parts, abs(area / truth.area - 1)),
        own,
        _over(miss - own, found, i),
    )


def _over(miss: float, found: dict[str, Any], i: int) -> float:
    """How often the stated error a relative miss of mu is."""
    return max(miss, 0.0) * float(found["mu"][i]) / float(found["error"][i])


def _kinks(scene: Drawn) -> list[float]:
    """Wave numbers at which the strain is that of a point of the sweep."""
    from scipy.optimize import brentq

    q, c, (first, times) = scene.q, scene.c, scene.options["soft"][:2]

    def strain(log_q: float) -> float:
        at = np.append(q[q < math.exp(log_q)], math.exp(log_q))
        some = np.append(c[q < at[-1]], np.exp(np.interp(log_q, np.log(q), np.log(c))))
        return scene.options["share"] * math.sqrt(2 * np.pi * moment(at, some, 3))

    low, high = math.log(q[0]) + 1e-9, math.log(q[-1])
    wanted = [x for x in (first, first * times) if strain(low) < x < strain(high)]
    return [
        math.exp(brentq(lambda log_q, x=x: strain(log_q) - x, low, high, xtol=1e-14))
        for x in wanted
    ]


def _softened(first: float, times: float, factors: Any, share: float) -> Any:
    """A sweep of two points: a monotone cubic over log strain, that leaves the straight
    start with its slope.
    """
    from scipy.interpolate import CubicHermiteSpline

    sweeps = sorted(factors[:2], reverse=True), [2 * factors[2], 2 * factors[3]]
    ends, curves = np.log([first, first * times]), []
    for low, high in sweeps:
        steepest = 3 * (high - low) / np.log(times)
        start = (low - 1) if (low - 1) * steepest > 0 else 0.0
        start = math.copysign(min(abs(start), abs(steepest)), start)
        curves.append(CubicHermiteSpline(ends, [low, high], [start, 0.0]))

    def soften(slope: Any) -> Any:
        strain = np.maximum(share * slope, 1e-300)
        inside = np.clip(np.log(strain), *ends)
        return tuple(
            np.where(strain < first, 1 - (1 - f[0]) * strain / first, curve(inside))
            for f, curve in zip(sweeps, curves, strict=True)
        )

    return soften


def _line(scene: Drawn, found: dict[str, Any], i: int) -> tuple[float, float, float]:
    from slow_surface import full_contact

    a, b = _thermal(scene)
    spacing = float(scene.q[1] - scene.q[0])
    load = float(scene.pressure[i]) / b
    law = scene.law._replace(
        times=a * scene.law.times, viscosity=a * scene.law.viscosity
    )
    truth = full_contact(law, scene.c, spacing, float(scene.velocity[i]), load)
    closed, mu = float(found["closed"][i]), float(found["mu"][i])
    if math.isnan(truth) or math.isnan(closed):
        return (0.0 if math.isnan(truth) == math.isnan(closed) else math.nan), 0.0, 0.0
    # Between its points the line is a spline, which has other short waves than the sum.
    apart = abs(closed / truth - 1) * 1e3
    miss = max(abs(mu / truth - 1) - 2e-3, 0.0)
    return max(miss, apart), 0.0, _over(miss, found, i)


def _cells(scene: Drawn, found: dict[str, Any], i: int) -> tuple[float, float, float]:
    from slow_surface import cells

    truth = cells(
        scene.law,
        found["heights"],
        found["side"],
        float(scene.velocity[i]),
        float(scene.pressure[i]),
    )
    return abs(float(found["mu"][i]) / truth - 1), 0.1 * scene.rtol, 0.0


def _press(scene: Drawn, found: dict[str, Any], i: int) -> tuple[float, float, float]:
    from scipy.interpolate import CubicSpline
    from slow_surface import at_rest, creep

    a, b = _thermal(scene)
    law, length = scene.law, scene.options["length"]
    compliance = (
        1 / law.equilibrium
        if scene.options["long"]
        else creep(law, float(scene.velocity[i]) / a)
    )
    n, load = scene.c.size, float(scene.pressure[i]) / b * compliance * length
    spline = CubicSpline(
        np.arange(n + 1), np.append(scene.c, scene.c[0]), bc_type="periodic"
    )
    gap, share = at_rest(spline(np.arange(n * 128) / 128), load)
    if share == 1 or gap <= 0:
        return (
            (
                0.0
                if np.isinf(found["conductance"][i])
                or found["conductance"][i] > 1e3 / length
                else 1.0
            ),
            0.0,
            0.0,
        )
    conductance = 2 / length * share / (1 - share)
    off = abs(found["separation"][i] - gap) / np.ptp(scene.c)
    off = max(off, abs(found["conductance"][i] / conductance - 1) - 3e-2)
    stiff = 0.5 * conductance * b / compliance
    return max(off, abs(found["stiffness"][i] / stiff - 1) - 3e-2) - 1e-3, 0.0, 0.0


JUDGES = {"line": _line, "cells": _cells, "press": _press}


def about(scene: Drawn) -> str:
    return (
        f"{scene.law.moduli.size} branches, {scene.q.size} points, velocities "
        f"{scene.velocity}, pressures {scene.pressure}, {scene.options}, rtol "
        f"{scene.rtol:g}"
    )


SUITE = Suite(
    name="stress_surfaces",
    title="Stress: random surfaces, each right or flagged",
    scenes=500,
    families=FAMILIES,
    draw=draw,
    answer=answer,
    judge=judge,
    about=about,
)

if __name__ == "__main__":
    sys.exit(run(SUITE))
