"""A map of rough friction in three dimensions: `python benchmarks/rough_map.py --seed 1
[--minutes 60]`.

Draws scenes: a self-affine surface, with or without roll-off, a material of contrast
1.3 to 1000 with a narrow or a broad spectrum, a speed within its losses, and a pressure
for a real contact of 0.2 to 99 % by Persson's theory. Each is solved on random maps by
`elastomdr.rough.half_space`, on cells wide enough that eight summits or more carry the
load (four where contact is heavier than 30 %), and 3 to 4 cells per shortest wave.
Points are appended to `results/rough_map.json` as they come; `rough_fit.py` fits the
constants of `em.Multiscale` to them.

In units of E*(0) = 1, wave number of the roll-off (or q_low) = 1, rms slope = 1:
friction goes with the rms slope and depends on p/(E* rms slope).
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from common import RESULTS

import elastomdr as em
from elastomdr.rough import half_space, multiscale
from elastomdr.rough import random_maps as maps
from elastomdr.surface.spectrum import rough_map

FILE = RESULTS / "rough_map.json"
# Hurst exponent, q_high over q_rolloff, q_rolloff over q_low.
SURFACES = [
    (0.8, 8, 1),
    (0.8, 16, 1),
    (0.8, 32, 1),
    (0.8, 64, 1),
    (0.8, 128, 1),
    (0.8, 256, 1),
    (0.5, 16, 1),
    (0.5, 64, 1),
    (0.5, 256, 1),
    (0.65, 32, 1),
    (0.65, 128, 1),
    (0.9, 16, 1),
    (0.9, 64, 1),
    (0.9, 256, 1),
    (0.7, 8, 4),
    (0.7, 32, 4),
    (0.8, 16, 4),
    (0.9, 32, 4),
    (0.6, 16, 8),
    (0.8, 64, 4),
    (0.6, 8, 1),
    (0.9, 8, 1),
]
SIZES = np.array(
    [
        64,
        96,
        128,
        160,
        192,
        256,
        288,
        320,
        384,
        480,
        512,
        576,
        640,
        768,
        800,
        864,
        960,
        1024,
        1152,
        1280,
        1536,
    ]
)


def materials() -> dict[str, tuple[np.ndarray, np.ndarray, int]]:
    """Moduli beside an equilibrium modulus of 1, relaxation times, decades of the
    times.
    """
    found: dict[str, tuple[np.ndarray, np.ndarray, int]] = {}
    for contrast in (1.3, 3, 11, 30, 100):
        found[f"one{contrast}"] = np.array([contrast - 1.0]), np.ones(1), 0
    for decades, contrasts in ((3, (2, 11, 100, 1000)), (6, (3, 11, 30, 300))):
        count = 2 * decades + 1
        for contrast in contrasts:
            times = np.geomspace(10 ** (-decades / 2), 10 ** (decades / 2), count)
            found[f"flat{decades}_{contrast}"] = (
                np.full(count, (contrast - 1) / count),
                times,
                decades,
            )
    for contrast, decades in ((30, 4), (100, 5), (1000, 6), (1000, 8), (300, 8)):
        times = np.geomspace(10 ** (-decades / 2), 10 ** (decades / 2), 2 * decades + 1)
        weight = times ** -(np.log10(contrast) / decades)
        found[f"pow{decades}_{contrast}"] = (
            (contrast - 1) * weight / weight.sum(),
            times,
            decades,
        )
    for contrast in (30, 300):
        root = contrast**0.5
        found[f"two_{contrast}"] = (
            np.array([contrast - root, root - 1]),
            np.array([1e-2, 1e2]),
            4,
        )
    return found


MATERIALS = materials()


def rubber(name: str) -> em.Foundation:
    moduli, times, _ = MATERIALS[name]
    return em.Foundation(1.0, moduli, times)


def surface_of(number: int) -> em.SelfAffine:
    hurst, ratio, rolloff = SURFACES[number]
    knee = 1.0 if rolloff > 1 else None
    return em.SelfAffine(
        hurst, rms_slope=1.0, q_low=1 / rolloff, q_high=float(ratio), q_rolloff=knee
    )


def draw(rng: np.random.Generator, largest: int) -> dict[str, Any] | None:
    """A scene and its grid; None where it would have more than `largest` cells to a
    side.
    """
    number, name = int(rng.integers(len(SURFACES))), str(rng.choice(list(MATERIALS)))
    surface, material, decades = surface_of(number), rubber(name), MATERIALS[name][2]
    half = decades / 2 + 1.2
    velocity = 10 ** rng.uniform(-half, half) / np.sqrt(surface.q_low * surface.q_high)
    u = rng.uniform()
    ranges = [
        10 ** (-2.7 + 1.4 * u),
        10 ** (-1.3 + 0.7 * u),
        0.25 + 0.5 * u,
        0.75 + 0.24 * u,
    ]
    area = ranges[int(rng.choice(4, p=[0.34, 0.36, 0.2, 0.1]))]
    low, high = np.log(1e-5), np.log(3e3)
    for _ in range(18):
        middle = 0.5 * (low + high)
        at = np.array([velocity]), np.exp([middle])
        found = multiscale.solve(
            material.complex_modulus, surface, *at, em.Persson(), 1e-3
        )
        low, high = (middle, high) if found.area[0] < area else (low, middle)
    pressure = np.exp([middle])
    _, ratio, rolloff = SURFACES[number]
    one = maps.Grid(4 * ratio * rolloff, 1, 2 * np.pi * rolloff)
    carried = maps.summits(
        material.complex_modulus, surface, np.array([velocity]), pressure, one
    )[0]
    summits = 10 if area < 0.3 else 4  # of heavy contact fewer will do
    periods = int(np.ceil(np.sqrt(summits / carried)))
    enough = SIZES[3 * periods * ratio * rolloff <= SIZES]
    if not enough.size or enough[0] > largest:
        return None
    fine = SIZES[4 * periods * ratio * rolloff <= SIZES]
    cells = int(fine[0] if fine.size and fine[0] <= 640 else enough[0])
    return {
        "surface": number,
        "material": name,
        "velocity": velocity,
        "pressure": float(pressure[0]),
        "cells": cells,
        "periods": periods,
        "summits": float(carried * periods**2),
    }


def solve(scene: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """The scene with friction over that of full contact on the same map, area and
    whether it settled, of each map.
    """
    surface, material = surface_of(scene["surface"]), rubber(scene["material"])
    v, p, cells = scene["velocity"], scene["pressure"], scene["cells"]
    side = 2 * np.pi * scene["periods"] / surface.q_low
    full = maps.full_contact(
        material.complex_modulus, surface, np.array([v]), np.array([p])
    )[0]
    guess = multiscale.solve(
        material.complex_modulus,
        surface,
        np.array([v]),
        np.array([p]),
        em.Persson(),
        1e-3,
    )
    seeds = 4 if guess.area[0] < 0.05 else 2
    mu, area, settled = [], [], True
    for _ in range(seeds):
        at = maps.Grid(cells, scene["periods"], side)
        points = max(
            cells, 4 * int(np.ceil(scene["periods"] * surface.q_high / surface.q_low))
        )
        heights, _ = rough_map(
            surface,
            int(rng.integers(2**26)),
            periods=scene["periods"],
            points=4 * -(-points // 4),
        )
        heights = _coarser(heights, cells)
        found = half_space.solve(
            material.complex_modulus,
            heights,
            (at.side, at.side),
            velocity=v,
            pressure=p,
            double=False,
        )
        own = maps.full_contact_of_map(
            material.complex_modulus, heights, (side, side), v, p
        )
        mu.append(found.stress / p * full / own)
        area.append(found.area)
        settled = settled and found.settled
    return {**scene, "mu": mu, "area": area, "settled": settled}


def _coarser(heights: np.ndarray, cells: int) -> np.ndarray:
    """The same waves on fewer cells."""
    n = heights.shape[0]
    if cells == n:
        return heights
    waves, half = np.fft.rfft2(heights), cells // 2
    kept = np.zeros((cells, half + 1), complex)
    kept[:half, :half], kept[-half + 1 :, :half] = (
        waves[:half, :half],
        waves[-half + 1 :, :half],
    )
    return np.fft.irfft2(kept, s=(cells, cells)) * (cells / n) ** 2


def main() -> None:
    options = argparse.ArgumentParser(
        description="A map of rough friction in three dimensions."
    )
    options.add_argument("--minutes", type=float, default=60.0)
    options.add_argument(
        "--seed",
        type=int,
        required=True,
        help="of the scenes; a new one adds new scenes",
    )
    options.add_argument(
        "--ratio", type=int, default=1, help="least cutoff ratio that is drawn"
    )
    options.add_argument(
        "--largest", type=int, default=1536, help="cells to a side of the largest grid"
    )
    options.add_argument("--file", type=Path, default=FILE)
    asked = options.parse_args()
    rng, end = np.random.default_rng(asked.seed), time.monotonic() + 60 * asked.minutes
    while time.monotonic() < end:
        scene = draw(rng, asked.largest)
        if scene is None or np.prod(SURFACES[scene["surface"]][1:]) < asked.ratio:
            continue
        point = solve(scene, rng)
        points = (
            json.loads(asked.file.read_text())["points"] if asked.file.exists() else []
        )
        write([*points, point], asked.file)
        print(
            (
                f"{len(points) + 1}: {point['material']}, surface {point['surface']}, "
                f"mu {np.mean(point['mu']):.4g}"
            ),
            flush=True,
        )


def write(points: list[dict[str, Any]], file: Path) -> None:
    """One line for each point."""
    head = json.dumps({"surfaces": SURFACES})[:-1]
    rows = ",\n".join(json.dumps(point) for point in points)
    file.write_text(f'{head},\n"points": [\n{rows}\n]}}\n')


if __name__ == "__main__":
    main()
