"""`em.Multiscale` against three dimensions on measured spectra, which no constant was
fitted to.

    python benchmarks/measured_spectra.py                  # some 8 minutes of the processor
    python benchmarks/measured_spectra.py MAP.txt --pixel 1e-6 --ratio 32

Without a file the heights are those that matplotlib has among its samples, elevations
of the ground and of the sea floor: what is read off them is their spectrum, which bends
as no law does, and its unit does not matter. Each spectrum is cut to a ratio of its
cutoffs and solved on random maps as the points of `rough_truth.py` are, of which
`rough_fit.py` is made. Points that are in the record are not solved again.
"""

import argparse
import itertools
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import rough_truth as solved
from common import RESULTS, heading, save, table, verdict
from matplotlib import cbook

import elastomdr as em
from elastomdr.rough import random_maps as maps

FILE = RESULTS / "measured_spectra_truth.json"
SAMPLES = (  # file, heights in it, cutoff ratios
    ("jacksboro_fault_dem.npz", "elevation", (16.0, 32.0)),
    ("topobathy.npz", "topo", (11.0,)),
)
RUBBERS = ("pow8_300", "flat6_30")
CONTACT = (0.02, 0.1)
LARGEST = 1024  # cells to a side
COLUMNS = ("spectrum", "ratio", "rubber", "contact", "unsure", "mu", "bound", "persson")


def spectrum_of(heights: np.ndarray, pixel: float, ratio: float) -> em.Spectrum:
    """The spectrum of measured heights over its first wave number, of rms slope 1."""
    # any heights of a slope that a surface may have
    gentle = heights / np.std(np.diff(heights, axis=0)) * pixel / 4
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        surface = em.read_surface(gentle, pixel_size=pixel)
        cut = surface.ended(min(ratio * surface.q_low, surface.q_high))
    plain = em.Spectrum(cut.q / cut.q_low, cut.c, convention="2d")
    return plain.raised(1 / float(plain.rms_slope))


def scene_of(spectrum: Any, name: str, area: float) -> dict[str, Any] | None:
    """Speed in the middle of the losses, pressure for the real contact, and the grid;
    None where it would be too large.
    """
    material = solved.rubber(name)
    ratio = float(spectrum.q_high)
    velocity = 1 / np.sqrt(ratio)
    pressure = solved.pressure_for(area, material, spectrum, velocity)
    one = maps.MapGrid(maps.SAMPLES * int(ratio), 1, 2 * np.pi)
    at = np.array([velocity]), np.array([pressure])
    carried = maps.summits(material.complex_modulus, spectrum, *at, one)[0]
    periods = int(np.ceil(np.sqrt(8 / carried)))
    fits = [n for n in (8, 4) if n * periods * ratio <= LARGEST]
    if not fits:
        return None
    return {
        "ratio": ratio,
        "material": name,
        "velocity": velocity,
        "pressure": pressure,
        "periods": periods,
        "per_wave": fits[0],
    }


def points_of(spectra: dict[str, em.Spectrum]) -> list[dict[str, Any]]:
    """Those of the record, and what it lacks of these spectra."""
    points = json.loads(FILE.read_text()) if FILE.exists() else []
    done = {(p["name"], p["material"], p["wanted"]) for p in points}
    for (name, spectrum), rubber, area in itertools.product(
        spectra.items(), RUBBERS, CONTACT
    ):
        scene = None
        if (name, rubber, area) not in done:
            scene = scene_of(spectrum, rubber, area)
        if scene is None:
            continue
        seeds = np.random.default_rng([7, len(points)])
        point = solved.solve(scene, seeds, spectrum)
        table_of = {"q": spectrum.q.tolist(), "c": spectrum.c.tolist()}
        points.append({"name": name, "wanted": area, **point, **table_of})
        FILE.write_text(json.dumps(points, indent=1) + "\n")
        print(name, rubber, area, scene["periods"], scene["per_wave"], flush=True)
    return points


def row_of(point: dict[str, Any]) -> tuple:
    """What the models have over three dimensions."""
    spectrum = em.Spectrum(point["q"], point["c"], convention="2d")
    rubber = solved.rubber(point["material"])
    at = {"velocity": point["velocity"], "pressure": point["pressure"]}
    over_full, unsure = solved.truth(point["mu"])
    area, _ = solved.truth(point["area"])
    ends = np.array([at["velocity"]]), np.array([at["pressure"]])
    full = maps.full_contact(rubber.complex_modulus, spectrum, *ends)[0]
    curve, persson = (
        em.friction(rubber, spectrum, **at, model=model)
        for model in (em.Multiscale(), em.Persson())
    )
    mu = over_full * full
    return (
        point["name"],
        point["ratio"],
        point["material"],
        area,
        unsure,
        float(curve.mu / mu),
        float(curve.model_error / curve.mu),
        float(persson.mu / mu),
    )


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    options.add_argument("file", nargs="?", type=Path, help="heights as text")
    options.add_argument("--pixel", type=float, default=1e-6, help="their distance [m]")
    options.add_argument("--ratio", type=float, default=32.0, help="of the cutoffs")
    asked = options.parse_args()
    if asked.file is None:
        spectra = {
            f"{Path(file).stem} {ratio:g}": spectrum_of(
                cbook.get_sample_data(file)[field].astype(float), 1.0, ratio
            )
            for file, field, ratios in SAMPLES
            for ratio in ratios
        }
    else:
        heights = np.loadtxt(asked.file)
        spectrum = spectrum_of(heights, asked.pixel, asked.ratio)
        spectra = {f"{asked.file.stem} {asked.ratio:g}": spectrum}
    record = heading(
        "Multiscale on measured spectra", f"{len(spectra)} spectra, none of a fit"
    )
    points = [p for p in points_of(spectra) if p["mu"]]
    rows = [row_of(point) for point in points]
    record["points"] = table(COLUMNS, rows)
    off, persson = (np.log([row[i] for row in rows]) for i in (5, 7))
    rms, rms_of_persson = (float(np.sqrt((x**2).mean())) for x in (off, persson))
    record["rms"], record["rms of persson"] = rms, rms_of_persson
    held = np.abs(off) <= np.log1p([row[6] for row in rows])
    record["verdicts"] = [
        verdict("Multiscale over three dimensions, rms", rms, 0.08),
        verdict("points within the bound", float(held.mean()), 0.95, least=True),
    ]
    print(f"  Persson's theory: {rms_of_persson:.3f} rms")
    save("measured_spectra", record)


if __name__ == "__main__":
    main()
