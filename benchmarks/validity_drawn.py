"""Does `model_error` hold on scenes that no fit has seen? Drawn powers, profiles and
spectra of three branches.

    python benchmarks/validity_drawn.py [--fresh]

The truth is `em.reference.half_space_sliding` on 64 by 64 cells, kept in
results/validity_drawn_truth.json, since it takes half an hour. Bodies in turn: powers
of 1 to 6 in halves, a sphere, and five profiles from points, pressed to relaxed
contacts of 0.3 to 3 mm. Glassy over relaxed modulus 3 to 1000, three branches over up
to 7 decades, three speeds down to 3 % of the peak's friction on its slow side and 0.1 %
on the other.
"""

import sys
import warnings
from typing import Any

import numpy as np
from common import cached, heading, save, table, verdict

import elastomdr as em

# E_inf [Pa] (as E*), the longest relaxation time [s], r_0 [m]
EQUILIBRIUM, TIME, LENGTH = 4e6, 1e-3, 1e-3
PROFILES = ("rounded cone", "crowned", "r^2 + r^4", "r + r^4", "wavy")
BODIES = (*(f"r^{n / 2:g}" for n in range(2, 13)), "sphere", *PROFILES)
SCENES, SPEEDS, CELLS, SEED = 170, 3, 64, 7
COLUMNS = ("body", "points", "95 % within [%]", "worst [%]", "covered [%]")


def shape(body: str) -> Any:
    if body == "sphere":
        return em.Sphere(1e-2)
    if body not in PROFILES:
        n = float(body[2:])
        return em.Cone(0.15) if n == 1 else em.PowerLaw(n, 0.1 * LENGTH ** (1 - n))
    r = LENGTH * np.concatenate(
        [np.linspace(0, 0.95, 6), np.linspace(0.98, 1.3, 8), np.geomspace(1.4, 14, 18)]
    )
    quartic = 0.05 * LENGTH * (r / LENGTH) ** 4
    heights = {
        "rounded cone": 0.15 * (np.hypot(r, LENGTH) - LENGTH),
        "crowned": r**2 / 0.2 + np.maximum(r - LENGTH, 0) ** 2 / 0.02,
        "r^2 + r^4": r**2 / 0.02 + quartic,
        "r + r^4": 0.05 * r + quartic,
        "wavy": r**2 / 0.02 + 0.3e-6 * (1 - np.cos(3 * r / LENGTH)),
    }
    return em.Profile(r, heights[body])


def law(moduli: list[float], times: list[float]) -> em.Foundation:
    return em.Foundation(EQUILIBRIUM, EQUILIBRIUM * np.array(moduli), np.array(times))


def drawn(number: int, draw: np.random.Generator) -> dict[str, Any]:
    """One scene and its truth."""
    body = BODIES[number % len(BODIES)]
    contrast, share = 10 ** draw.uniform(0.5, 3), draw.dirichlet([0.7] * 3)
    if draw.random() < 0.5:  # each branch raises the modulus by a factor
        levels = np.exp(
            [0, *np.sort(draw.uniform(0, np.log(contrast), 2)), np.log(contrast)]
        )
        share = np.diff(levels) / (contrast - 1)
    span = draw.uniform(0, 7)
    times = TIME * 10 ** (-span * np.array([0, draw.uniform(0.2, 0.8), 1]))
    radius = LENGTH
    if body == "sphere":
        radius *= 10 ** draw.uniform(-0.5, 0.5)
    elif body in PROFILES:
        radius *= draw.choice([0.7, 1.15, 1.6, 3.0])
    whole, x = shape(body), np.linspace(0, radius, 2001)
    g = np.asarray(whole._profile(x))
    load = float(2 * EQUILIBRIUM * np.trapezoid(g[-1] - g, x))
    moduli = ((contrast - 1) * np.maximum(share, 1e-12)).tolist()
    material, sweep = law(moduli, times.tolist()), np.geomspace(1e-3, 1e11, 60)
    line = em.friction(
        material, whole, velocity=sweep, load=load, model=em.Line(), rtol=1e-2
    ).mu
    slow, fast = (
        sweep[line > 0.03 * np.nanmax(line)][0],
        sweep[line > 1e-3 * np.nanmax(line)][-1],
    )
    velocity = np.exp(draw.uniform(np.log(slow), np.log(fast), SPEEDS))
    found = em.reference.half_space_sliding(
        material, whole, velocity=velocity, load=load, points=CELLS
    )
    print(f"  {number}: {body}, contrast {contrast:.3g}", file=sys.stderr, flush=True)
    return {
        "body": body,
        "moduli": moduli,
        "times": times.tolist(),
        "load": load,
        "velocity": velocity.tolist(),
        "mu": found.mu.tolist(),
        "error": found.error.tolist(),
    }


def truths(fresh: bool) -> list[dict[str, Any]]:
    inputs = {
        "E_inf": EQUILIBRIUM,
        "tau": TIME,
        "r_0": LENGTH,
        "bodies": BODIES,
        "scenes": SCENES,
        "speeds": SPEEDS,
        "cells": CELLS,
        "seed": SEED,
    }
    draw = np.random.default_rng(SEED)
    return cached(
        "validity_drawn_truth",
        inputs,
        lambda: [drawn(i, draw) for i in range(SCENES)],
        fresh,
    )


def compare(scene: dict[str, Any]) -> np.ndarray:
    """Per speed: deviation, bound and the reference's own error, all relative."""
    whole = shape(scene["body"])
    curve = em.friction(
        law(scene["moduli"], scene["times"]),
        whole,
        velocity=scene["velocity"],
        load=scene["load"],
        rtol=1e-2 if scene["body"] in PROFILES else 1e-3,
    )
    exact = np.array(scene["mu"])
    return np.stack(
        [
            np.abs(curve.mu / exact - 1),
            curve.model_error / exact,
            np.array(scene["error"]) / exact,
        ],
        axis=1,
    )


def covered(points: np.ndarray) -> float:
    """Points that the bound covers, to the reference's own error [%]."""
    off, bound, own = points[np.isfinite(points).all(axis=1)].T
    return 100 * float(np.mean(off <= bound + own))


def main() -> None:
    warnings.simplefilter("ignore")
    record = heading(
        "The bound of the direction average on drawn scenes",
        f"{SCENES} scenes, {SPEEDS} speeds each, seed {SEED}; {CELLS} by {CELLS} cells",
        "three branches, glassy over relaxed modulus 3 to 1000",
    )
    parts: dict[str, list[np.ndarray]] = {}
    for scene in truths("--fresh" in sys.argv):
        parts.setdefault(scene["body"], []).append(compare(scene))
    points = {body: np.concatenate(of) for body, of in parts.items()}
    sharp = {
        body: of[np.isfinite(of).all(axis=1) & (of[:, 2] < 0.02)]
        for body, of in points.items()
    }
    record["table"] = table(
        COLUMNS,
        [
            (
                body,
                len(of),
                *(100 * np.quantile(sharp[body][:, 0], q) for q in (0.95, 1.0)),
                covered(of),
            )
            for body, of in points.items()
        ],
    )
    every = np.concatenate(list(points.values()))
    gentle = ("r^1", "r^2", "sphere")  # balls and cones
    other = np.concatenate([of for body, of in sharp.items() if body not in gentle])
    limits = np.concatenate(
        [
            np.full(len(of), 0.02 if body in gentle else 0.05)
            for body, of in sharp.items()
        ]
    )
    off, bound, own = np.concatenate(list(sharp.values())).T
    quiet = (off - own > limits) & (bound < limits)
    print()
    record["verdicts"] = [
        verdict("points that the bound covers", covered(every), 95, " %", least=True),
        verdict(
            "bodies but balls and cones: 95 % of the points within",
            100 * np.quantile(other[:, 0], 0.95),
            5,
            " %",
        ),
        verdict(
            (
                "balls and cones off by over 2 %, others by over 5 %, and the bound "
                "below that"
            ),
            int(quiet.sum()),
            0,
        ),
    ]
    save("validity_drawn", record)


if __name__ == "__main__":
    main()
