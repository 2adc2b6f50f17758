"""What a lay and heights that are not Gaussian do to a leak: the factor that
`model_error` of `em.leak` holds for a measured surface.

    python benchmarks/leak_surfaces.py [--seeds 2]

Maps in three dimensions: with a lay of a Peklenik number on all scales (`rough_map`),
and with a skewness at the same spectrum (`skewed_roads.skewed`). Each is pressed at the
pressures for which Persson's theory has a real contact of 2 to 33 %, and Reynolds'
equation is solved on its gaps, along the lay and across it. Flow is counted over that
of the map without lay or skewness with the same random numbers.
"""

import argparse
import itertools

import numpy as np
from common import heading, save, table, verdict
from leak_maps import levels
from skewed_roads import skewed

import elastomdr as em
from elastomdr.seal.gap_maps import flow, pressed
from elastomdr.seal.leak_form import of_lay, of_skewness
from elastomdr.surface.lay import Lay
from elastomdr.surface.spectrum import rough_map
from elastomdr.surface.topography import MeasuredSurface

CELLS, PERIODS, RATIO = 128, 2, 16.0
HURST = (0.8, 0.5)
PEKLENIK = (1.5, 2.0, 3.0, 5.0)
SKEWNESS = (-1.0, -0.5, 0.5, 1.0)
AREAS = np.array([0.02, 0.07, 0.16, 0.26, 0.31])  # of those of `leak_maps`


def laid(hurst: float, peklenik: float) -> MeasuredSurface:
    plain = em.SelfAffine(hurst, rms_slope=1.0, q_low=1.0, q_high=RATIO)
    log_g = np.full(plain.q.size, np.log(peklenik))
    return MeasuredSurface(
        q=plain.q,
        c=plain.c,
        relative_error=0 * plain.q,
        measured_height=plain.rms_height,
        skewness=0.0,
        report=(),
        lay=Lay(plain.q, log_g, 0 * log_g, 0.0) if peklenik > 1 else None,
    )


def flows(heights: np.ndarray, side: float, pressures: np.ndarray) -> np.ndarray:
    """w along both axes at each pressure (pressures, 2), and the real contact."""
    start, rows = None, []
    for pressure in pressures:
        contact = pressed(heights, side, float(pressure), start)
        start = contact.pressure
        rows.append((*flow(contact.gap).conductance, contact.area))
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--seeds", type=int, default=2)
    seeds = range(parser.parse_args().seeds)
    record = heading(
        "Leaks past surfaces with a lay, or heights that are not Gaussian",
        f"maps of {CELLS} x {CELLS} cells, waves in a ratio of {RATIO:g}",
    )
    chosen = levels()[[1, 3, 5, 7, 8]]
    rows = []
    for hurst, seed in itertools.product(HURST, seeds):
        options = {"periods": PERIODS, "points": CELLS}
        plain, side = rough_map(laid(hurst, 1.0), seed, **options)
        alone = flows(plain, side, chosen)
        mean, area = np.sqrt(alone[:, 0] * alone[:, 1]), alone[:, 2]
        open_ = mean > 0  # a map that is closed without lay tells nothing
        for peklenik in PEKLENIK:
            heights, _ = rough_map(laid(hurst, peklenik), seed, **options)
            along = flows(heights, side, chosen)
            for axis, way in ((0, "along"), (1, "across")):
                log = np.log(np.maximum(along[open_, axis], 1e-300) / mean[open_])
                rows += [
                    (way, hurst, seed, peklenik, float(a), float(y))
                    for a, y in zip(area[open_], log, strict=True)
                ]
        gauss = flows(skewed(plain, 0.0), side, chosen)
        mean = np.sqrt(gauss[:, 0] * gauss[:, 1])
        open_ = mean > 0
        for skewness in SKEWNESS:
            other = flows(skewed(plain, skewness), side, chosen)
            both = np.sqrt(other[open_, 0] * other[open_, 1])
            log = np.log(np.maximum(both, 1e-300) / mean[open_])
            rows += [
                ("skewed", hurst, seed, skewness, float(a), float(y))
                for a, y in zip(gauss[open_, 2], log, strict=True)
            ]
        print(f"  H = {hurst:g}, map {seed}", flush=True)
    names = ("what", "H", "seed", "g or skewness", "contact", "ln of flow over plain")
    record["table"] = table(names, rows)
    what = np.array([row[0] for row in rows])
    size, area, log = (np.array([row[i] for row in rows]) for i in (3, 4, 5))
    bound = np.where(
        what == "skewed", of_skewness(size, area), of_lay(np.log(np.abs(size)), area)
    )
    record["verdicts"] = [
        verdict(
            f"{each} within the bound",
            float(np.mean(np.abs(log[what == each]) <= bound[what == each])),
            0.95,
            least=True,
        )
        for each in ("along", "across", "skewed")
    ]
    save("leak_surfaces", record)


if __name__ == "__main__":
    main()
