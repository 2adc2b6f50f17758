"""Leak through rough contacts in three dimensions: `python benchmarks/leak_maps.py
[--minutes 60]`.

Draws surfaces: Hurst exponent .3 to 1, q_high over q_rolloff 16 to 64, q_rolloff over
q_low 1 to 8. Each is pressed, elastic, at the pressures for which Persson's theory has
a real contact of 1 to 40 %, on several random maps (`elastomdr.seal.gap_maps`, four
cells per shortest wave), and Reynolds' equation is solved on the gaps along both axes.
A load that fewer than three summits carry is left out. Surfaces are appended to
`results/leak_maps.json` as they come, and those that are there are not computed again;
`leak_fit.py` fits the model of `em.leak` to them.

In units of q_low = 1, rms slope = 1, E* = 1: gaps count in rms heights, flow in their
cube.
"""

import argparse
import json
import time
from typing import Any

import numpy as np
from common import RESULTS

import elastomdr as em
from elastomdr.rough.multiscale import contact
from elastomdr.rough.random_maps import Grid, summits
from elastomdr.seal.gap_flow import flow
from elastomdr.seal.gap_maps import pressed
from elastomdr.surface.spectrum import rough_map

FILE = RESULTS / "leak_maps.json"
SURFACES = 60
AREAS = np.array([0.01, 0.02, 0.04, 0.07, 0.11, 0.16, 0.21, 0.26, 0.31, 0.36, 0.40])
MAPS = 4
SUMMITS = 3.0  # that carry the load, at least
WAVES = (64, 128)  # shortest waves to a side of a map: of few scales, of many


def surface(number: int) -> dict[str, float]:
    """Exponent, cutoff ratio and roll-off of a surface."""
    rng = np.random.default_rng([35, number])
    while True:
        hurst = rng.uniform(0.3, 1.0)
        ratio = np.exp(rng.uniform(np.log(16), np.log(64)))
        rolloff = 1.0 if rng.uniform() < 0.35 else np.exp(rng.uniform(0, np.log(8)))
        if ratio * rolloff <= (WAVES[1] if rolloff > 2 else WAVES[0]):
            return {"hurst": hurst, "ratio": ratio, "rolloff": rolloff}


def spectrum_of(hurst: float, ratio: float, rolloff: float) -> em.SelfAffine:
    knee = rolloff if rolloff > 1 else None
    return em.SelfAffine(
        hurst, rms_slope=1.0, q_low=1.0, q_high=ratio * rolloff, q_rolloff=knee
    )


def levels() -> np.ndarray:
    """p/(E* rms slope) at which a share of AREAS touches."""
    level = np.geomspace(1e-4, 1.0, 2000)
    area = contact(1 / (8 * level**2), 0.5, True)
    return np.interp(AREAS, area, level)


def on_maps(shape: dict[str, float], maps: int = MAPS, fine: int = 1) -> dict[str, Any]:
    """A surface at all loads, `fine` times four cells per shortest wave."""
    spectrum = spectrum_of(**shape)
    highest = shape["ratio"] * shape["rolloff"]
    waves = WAVES[0] if highest <= WAVES[0] / 2 else WAVES[1]
    periods = int(waves / highest)
    cells = fine * 32 * int(np.ceil(periods * highest / 8 - 1e-9))
    level = levels()
    grid = Grid(cells, periods, 2 * np.pi * periods)
    carried = summits(
        lambda omega: np.ones(np.shape(omega), complex),
        spectrum,
        np.ones(level.size),
        level,
        grid,
    )
    level = level[carried >= SUMMITS]
    rms = spectrum.rms_height
    area, gap, along, across = (np.full((level.size, maps), np.nan) for _ in range(4))
    for seed in range(maps):
        heights, side = rough_map(spectrum, seed, periods=periods, points=cells)
        start = None
        for i, one in enumerate(level):
            found = pressed(heights, side, one, start)
            start = found.pressure
            if not found.settled:
                start = None
                continue
            through = flow(found.gap).conductance
            area[i, seed], gap[i, seed] = found.area, found.gap.mean() / rms
            along[i, seed], across[i, seed] = (w / rms**3 for w in through)
    return {
        **shape,
        "cells": cells,
        "periods": periods,
        "level": level.tolist(),
        "area": area.tolist(),
        "gap": gap.tolist(),
        "flow": np.stack([along, across], -1).tolist(),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    end = time.monotonic() + 60 * parser.parse_args().minutes
    kept = json.loads(FILE.read_text()) if FILE.exists() else {}
    for number in range(SURFACES):
        if str(number) in kept:
            continue
        if time.monotonic() > end:
            break
        begun = time.process_time()
        kept[str(number)] = on_maps(surface(number))
        FILE.write_text(json.dumps(_rounded(kept)) + "\n")
        print(
            number, surface(number), f"{time.process_time() - begun:.0f} s", flush=True
        )
    print(f"{len(kept)} of {SURFACES} surfaces")


def _rounded(values: Any) -> Any:
    """Five digits are more than maps have."""
    if isinstance(values, dict):
        return {key: _rounded(value) for key, value in values.items()}
    if isinstance(values, list):
        return [_rounded(value) for value in values]
    return float(f"{values:.5g}") if isinstance(values, float) else values


if __name__ == "__main__":
    main()
