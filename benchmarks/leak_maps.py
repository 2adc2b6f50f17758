"""Leak through rough contacts in three dimensions: `python benchmarks/leak_maps.py
[--minutes 60]`.

Draws surfaces: Hurst exponent .3 to 1, q_high over q_rolloff 16 to 64, q_rolloff over
q_low 1 to 8. Each is pressed, elastic, at the pressures for which Persson's theory has
a real contact of 1 to 40 %, on several random maps (`elastomdr.seal.gap_maps`, four
cells per shortest wave), and Reynolds' equation is solved on the gaps along both axes.
A load is computed on the smallest maps on which three summits or more carry it, and
left out where none of them is large enough. Maps are appended to
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
from elastomdr.rough.random_maps import MapGrid, summits
from elastomdr.seal.gap_maps import flow, pressed
from elastomdr.surface.spectrum import rough_map

FILE = RESULTS / "leak_maps.json"
SURFACES = 60
AREAS = np.array([0.01, 0.02, 0.04, 0.07, 0.11, 0.16, 0.21, 0.26, 0.31, 0.36, 0.40])
MAPS = {64: 4, 128: 4, 192: 2}  # of so many shortest waves to a side
SUMMITS = 3.0  # that carry the load, at least


def surface(number: int) -> dict[str, float]:
    """Exponent, cutoff ratio and roll-off of a surface."""
    rng = np.random.default_rng([35, number])
    while True:
        hurst = rng.uniform(0.3, 1.0)
        ratio = np.exp(rng.uniform(np.log(16), np.log(64)))
        rolloff = 1.0 if rng.uniform() < 0.35 else np.exp(rng.uniform(0, np.log(8)))
        if ratio * rolloff <= (128 if rolloff > 2 else 64):
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


def grid_of(spectrum: em.SelfAffine, waves: int) -> MapGrid | None:
    """A map of about so many shortest waves to a side; None where they are fewer than
    two of the longest, or one where that is far in the roll-off.
    """
    least = 1 if spectrum.q.size > 2 and spectrum.q[1] > 2 else 2
    periods = int(waves / spectrum.q_high)
    if periods < least:
        return None
    cells = 32 * int(np.ceil(periods * spectrum.q_high / 8 - 1e-9))
    return MapGrid(cells, periods, 2 * np.pi * periods)


def carried(spectrum: em.SelfAffine, grid: MapGrid) -> np.ndarray:
    """Which of the levels enough summits carry."""
    level = levels()
    modulus = lambda omega: np.ones(np.shape(omega), complex)  # noqa: E731
    found = summits(modulus, spectrum, np.ones(level.size), level, grid)
    return found >= SUMMITS


def on_maps(
    spectrum: em.SelfAffine, grid: MapGrid, level: np.ndarray, maps: int
) -> dict[str, Any]:
    """A surface at levels, lightest first, on maps of one size."""
    rms = spectrum.rms_height
    area, gap = (np.full((level.size, maps), np.nan) for _ in range(2))
    flows = np.full((level.size, maps, 2), np.nan)
    for seed in range(maps):
        heights, side = rough_map(
            spectrum, seed, periods=grid.periods, points=grid.cells
        )
        start = None
        for i, one in enumerate(level):
            found = pressed(heights, side, one, start)
            start = found.pressure if found.settled else None
            if found.settled:
                area[i, seed], gap[i, seed] = found.area, found.gap.mean() / rms
                flows[i, seed] = np.array(flow(found.gap).conductance) / rms**3
    return {
        "cells": grid.cells,
        "periods": grid.periods,
        "level": level.tolist(),
        "area": area.tolist(),
        "gap": gap.tolist(),
        "flow": flows.tolist(),
    }


def left(spectrum: em.SelfAffine, waves: int) -> tuple[MapGrid | None, np.ndarray]:
    """Maps of a size, and the levels that smaller ones do not carry."""
    done = np.zeros(AREAS.size, bool)
    for size in MAPS:
        grid = grid_of(spectrum, size)
        enough = done & False if grid is None else carried(spectrum, grid)
        if size == waves:
            return grid, levels()[enough & ~done]
        done |= enough
    raise ValueError(waves)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    end = time.monotonic() + 60 * parser.parse_args().minutes
    kept = json.loads(FILE.read_text()) if FILE.exists() else {}
    for waves, maps in MAPS.items():
        for number in range(SURFACES):
            own = kept.setdefault(str(number), {**surface(number), "maps": {}})
            if str(waves) in own["maps"]:
                continue
            if time.monotonic() > end:
                return
            spectrum = spectrum_of(*(own[key] for key in ("hurst", "ratio", "rolloff")))
            grid, level = left(spectrum, waves)
            begun = time.process_time()
            own["maps"][str(waves)] = (
                None
                if grid is None or not level.size
                else on_maps(spectrum, grid, level, maps)
            )
            FILE.write_text(json.dumps(_rounded(kept)) + "\n")
            took = time.process_time() - begun
            print(waves, number, level.size, f"{took:.0f} s", flush=True)
    print("done")


def _rounded(values: Any) -> Any:
    """Five digits are more than maps have."""
    if isinstance(values, dict):
        return {key: _rounded(value) for key, value in values.items()}
    if isinstance(values, list):
        return [_rounded(value) for value in values]
    return float(f"{values:.5g}") if isinstance(values, float) else values


if __name__ == "__main__":
    main()
