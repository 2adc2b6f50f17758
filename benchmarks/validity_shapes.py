"""How far is the direction average from the half-space for flat, worn and crowned
bodies, and far above the peak?

    python benchmarks/validity_shapes.py [--fresh] [--worn]

The truth is `em.reference.half_space_sliding` on 64 by 64 cells, kept in
results/validity_shapes_truth.json, since it takes 15 minutes. With --worn the models
are compared under bodies given as points too, which takes half an hour. Bodies: r^n, n
from 1.5 to 8, and five with a length r_0 of their own, pressed to relaxed contacts of
1.15 to 3 r_0. Spectra: one branch, and two branches 3 to 6 decades apart. Glassy over
relaxed modulus 10 to 1000. Four speeds are drawn for each, down to 0.1 % of the peak's
friction. The rule of `surface.direction.asymmetry` was fitted to this map and to that
of validity_map.py, without the bodies r^1.5, r^2.5 and r^5.
"""

import sys
import warnings
from typing import Any

import numpy as np
from common import cached, heading, save, table, verdict

import elastomdr as em

EQUILIBRIUM, TIME = 4e6, 1e-3  # E_inf [Pa] (as E*), the longest relaxation time [s]
# r_0 of worn and crowned bodies, radius of their curvature beyond [m]
LENGTH, RADIUS = 1e-3, 1e-2
WIDTHS = (1.15, 1.6, 3.0)  # relaxed contact radius at rest over r_0
SECOND = {
    "one branch": 1e-2,
    "two equal, 5 decades apart": 1e-5,
    "two, 3 decades apart": 1e-3,
    "two, 6 decades apart": 1e-6,
}
SPECTRA = tuple(SECOND)  # with the time of the second branch over that of the first
# of E_inf: the second modulus of one branch, so that one compiled program serves all
ABSENT = 1e-12
HELD_OUT = ("r^1.5", "r^2.5", "r^5")
WORN = ("worn ball", "worn cone", "flat with a rounded edge", "crowned", "rounded cone")
BODIES = ("r^1.5", "r^2", "r^3", "r^4", "r^6", "r^8", *WORN, "r^2.5", "r^5")
CONTRASTS = (10.0, 100.0, 1000.0)
# drawn over the range in which the line's friction is above this part of its peak
SPEEDS, WHERE = 4, 1e-3
SLOW = 0.03  # the same below the peak, under worn bodies
CELLS = 64
SEED = 28
GOOD = 0.02  # relative error of the reference below which deviations are counted
MODELS = {"direction": em.Averaged(corrected=False), "corrected": em.Averaged()}
COLUMNS = (
    "body",
    "points",
    "with a bound",
    "direction, 95 % [%]",
    "worst [%]",
    "corrected, 95 % [%]",
    "worst of it [%]",
    "covered, direction [%]",
    "covered, corrected [%]",
    "bound, median [%]",
)


def law(spectrum: str, contrast: float) -> em.Foundation:
    """Two branches: of equal modulus, or each raising the modulus by the same
    factor.
    """
    first = {
        "one branch": contrast - 1 - ABSENT,
        "two equal, 5 decades apart": (contrast - 1) / 2,
    }
    slow = first.get(spectrum, contrast**0.5 - 1)
    moduli = np.array([slow, contrast - 1 - slow])
    return em.Foundation(
        EQUILIBRIUM, EQUILIBRIUM * moduli, TIME * np.array([1.0, SECOND[spectrum]])
    )


def heights(body: str, r: np.ndarray) -> np.ndarray:
    past = np.maximum(r - LENGTH, 0.0)
    return {
        "worn ball": np.maximum(r**2 - LENGTH**2, 0) / (2 * RADIUS),
        "worn cone": 0.15 * past,
        "flat with a rounded edge": past**2 / (2 * RADIUS),
        "crowned": r**2 / (20 * RADIUS) + past**2 / (2 * RADIUS),
        "rounded cone": 0.15 * (np.hypot(r, LENGTH) - LENGTH),
    }[body]


def shape(body: str) -> Any:
    if body not in WORN:
        power = float(body[2:])
        return em.PowerLaw(power, 0.1 * LENGTH / LENGTH**power)
    near = np.concatenate(
        [np.linspace(0, 0.95, 4), np.linspace(0.98, 1.2, 6), np.geomspace(1.3, 12, 14)]
    )
    return em.Profile(
        LENGTH * near, heights(body, LENGTH * near), curve="monotone", apex="smooth"
    )


def scenes(body: str) -> list[tuple[str, float, float]]:
    """Spectrum, contrast and load of each scene; worn bodies are pressed to one width
    after the other.
    """
    found, whole = [], shape(body)
    for i, spectrum in enumerate(SPECTRA):
        for j, contrast in enumerate(CONTRASTS):
            radius = LENGTH * (WIDTHS[(i + j) % len(WIDTHS)] if body in WORN else 1.0)
            found.append((spectrum, contrast, _load(whole, radius)))
    return found


def _load(whole: Any, radius: float) -> float:
    """Load of the relaxed contact at rest of this radius: 2 E* int_0^a (d - g) dx."""
    x = np.linspace(0, radius, 2001)
    g = np.asarray(whole._profile(x))
    return float(2 * EQUILIBRIUM * np.trapezoid(g[-1] - g, x))


def speeds(
    body: str, material: em.Foundation, load: float, draw: np.random.Generator
) -> np.ndarray:
    """Drawn evenly in their logarithm, one from each quarter; under worn bodies not
    below 3 % of the peak on its slow side, where the average is exact and the reference
    coarse.
    """
    worn = body in WORN
    sweep = np.geomspace(1e-5, 1e13, 36 if worn else 160)
    line = em.friction(
        material, shape(body), velocity=sweep, load=load, model=em.Line(), rtol=1e-3
    ).mu
    there = np.log(sweep[line > WHERE * np.nanmax(line)])
    if worn:
        there = there[there >= np.log(sweep[line > SLOW * np.nanmax(line)][0])]
    part = (np.arange(SPEEDS) + draw.random(SPEEDS)) / SPEEDS
    return np.exp(there[0] + (there[-1] - there[0]) * part)


def truth(body: str) -> list[dict[str, Any]]:
    draw, whole, found = (
        np.random.default_rng((SEED, 1 + BODIES.index(body))),
        shape(body),
        [],
    )
    for spectrum, contrast, load in scenes(body):
        material = law(spectrum, contrast)
        velocity = speeds(body, material, load, draw)
        one = em.reference.half_space_sliding(
            material, whole, velocity=velocity, load=load, points=CELLS
        )
        found.append(
            {
                "body": body,
                "spectrum": spectrum,
                "contrast": contrast,
                "load": load,
                "velocity": velocity.tolist(),
                "mu": one.mu.tolist(),
                "error": one.error.tolist(),
            }
        )
        print(
            f"  {body}, {spectrum}, contrast {contrast:g}", file=sys.stderr, flush=True
        )
    return found


def truths(fresh: bool) -> dict[str, list[dict[str, Any]]]:
    inputs = {
        "E_inf": EQUILIBRIUM,
        "tau": TIME,
        "bodies": BODIES,
        "r_0": LENGTH,
        "R": RADIUS,
        "widths": WIDTHS,
        "spectra": SECOND,
        "contrasts": CONTRASTS,
        "speeds": SPEEDS,
        "where": WHERE,
        "slow": SLOW,
        "cells": CELLS,
        "seed": SEED,
    }
    return cached(
        "validity_shapes_truth",
        inputs,
        lambda: {body: truth(body) for body in BODIES},
        fresh,
    )


def compare(body: str, scene: dict[str, Any]) -> list[dict[str, float]]:
    """Relative deviations of both averages from the reference, their bounds and the
    reference's own error.
    """
    given = {
        "velocity": scene["velocity"],
        "load": scene["load"],
        "rtol": 1e-2 if body in WORN else 1e-3,
    }
    material, whole = law(scene["spectrum"], scene["contrast"]), shape(body)
    exact = np.array(scene["mu"], dtype=float)
    found: dict[str, np.ndarray] = {
        "own": np.array(scene["error"], dtype=float) / exact
    }
    for name, model in MODELS.items():
        curve = em.friction(material, whole, model=model, **given)
        found[name], found[f"{name} bound"] = (
            curve.mu / exact - 1,
            curve.model_error / exact,
        )
    return [
        dict(zip(found, point, strict=True))
        for point in zip(*found.values(), strict=True)
    ]


def summarise(body: str, points: list[dict[str, float]]) -> tuple:
    """One row: how many have a bound, how far off they are where the reference is good,
    how many are covered.
    """
    known = [
        p for p in points if np.isfinite(p["corrected bound"]) and np.isfinite(p["own"])
    ]
    sharp = [p for p in known if p["own"] < GOOD]
    off = [np.abs([p[name] for p in sharp]) for name in MODELS]
    return (
        body,
        len(points),
        len(known),
        *(100 * q(values) for values in off for q in (_most, np.max)),
        *(share(known, name) for name in MODELS),
        100 * float(np.median([p["corrected bound"] for p in known])),
    )


def share(points: list[dict[str, float]], name: str) -> float:
    """Points that the bound covers, to the reference's own error [%]."""
    return 100 * float(
        np.mean([abs(p[name]) <= p[f"{name} bound"] + p["own"] for p in points])
    )


def _most(values: np.ndarray) -> float:
    return float(np.quantile(values, 0.95))


def main() -> None:
    warnings.simplefilter("ignore", em.ConvergenceWarning)
    record = heading(
        "Validity of the direction average under flat, worn and crowned bodies",
        (
            f"E_inf = {EQUILIBRIUM:g} Pa (E*), longest time {TIME:g} s; {CELLS} by "
            f"{CELLS} cells; "
        )
        + ", ".join(SPECTRA),
        (
            f"glassy over relaxed modulus {', '.join(f'{c:g}' for c in CONTRASTS)}; "
            f"{SPEEDS} speeds each"
        ),
    )
    points = {
        body: [p for scene in scenes for p in compare(body, scene)]
        for body, scenes in truths("--fresh" in sys.argv).items()
        if body not in WORN or "--worn" in sys.argv
    }
    bounded = {
        body: of
        for body, of in points.items()
        if any(np.isfinite(p["corrected bound"]) for p in of)
    }
    record["table"] = table(
        COLUMNS, [summarise(body, of) for body, of in bounded.items()]
    )
    record["without a bound"] = [body for body in points if body not in bounded]
    known = [
        p
        for of in bounded.values()
        for p in of
        if np.isfinite(p["corrected bound"] + p["own"])
    ]
    held = [
        p
        for body in HELD_OUT
        for p in points[body]
        if np.isfinite(p["corrected bound"] + p["own"])
    ]
    print()
    record["verdicts"] = [
        verdict(
            "corrected: points that the bound covers",
            share(known, "corrected"),
            95,
            " %",
            least=True,
        ),
        verdict(
            "corrected, bodies not fitted: the same",
            share(held, "corrected"),
            95,
            " %",
            least=True,
        ),
        verdict(
            "direction: points that the bound covers",
            share(known, "direction"),
            95,
            " %",
            least=True,
        ),
        *(
            verdict(
                f"corrected, {name}: 95 % of the points within",
                summarise("", points[name])[5],
                goal,
                " %",
            )
            for name, goal in (
                ("r^2", 2),
                ("r^3", 5),
                ("r^4", 5),
                ("r^5", 5),
                ("r^6", 5),
            )
        ),
    ]
    save("validity_shapes", record)


if __name__ == "__main__":
    main()
