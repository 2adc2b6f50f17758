"""What would correct friction where the heights are not Gaussian? Candidates against maps
in three dimensions that none of them was fitted to.

    python benchmarks/skewed_roads.py [--maps 80]

Maps are drawn and worn as in blind_maps.py, by another seed; `em.HalfSpace()` of each is
the truth. Beside the default stand

- factor: exp(.4 s sqrt(-ln A)), s the skewness (non_gaussian.py),
- top slope: C times the share of the mean square slope, octave by octave, that the
  highest part of the map has, twice the real contact (after the top spectrum of Lorenz
  and Persson, Eur. Phys. J. E 31 (2010) 159, without the kinks of a clipped map),
- top excess: all heights times r, by which the mean of the highest part of the map lies
  above its lowest height, over the same of Gaussian heights; that part is the real
  contact, which is found anew with the scaled heights until it stays.
"""

import argparse
import itertools
import warnings

import numpy as np
from blind_maps import PER_WAVE, worn
from common import heading, save, table, verdict
from non_gaussian import RUBBERS
from scipy.stats import norm

import elastomdr as em

KINDS = ("Gaussian", "low summits", "cut off", "rounded", "pits", "peaks")
WAYS = ("default", "factor", "top slope", "top excess")
LEAST = 0.02  # of a height, where the top is flat
BANDS, ROUNDS = 5, 4


def by_slope(surface, area: float) -> em.Spectrum:
    """The surface with the slopes of its top."""
    height, step = surface.map.height, float(np.ravel(surface.map.steps)[0])
    waves = 2 * np.pi * np.fft.fftfreq(height.shape[0], step)
    size, transform = np.hypot(waves[:, None], waves[None]), np.fft.fft2(height)
    top = height > np.quantile(height, max(1 - 2 * area, 0.0))
    edges = np.geomspace(0.999 * surface.q_low, 1.001 * surface.q_high, BANDS + 1)
    shares = []
    for low, high in itertools.pairwise(edges):
        band = np.where((size >= low) & (size < high), transform, 0)
        square = sum(
            np.fft.ifft2(1j * k * band).real ** 2 for k in (waves[:, None], waves[None])
        )
        shares.append(square[top].mean() / max(square.mean(), 1e-300))
    middle = np.log(np.sqrt(edges[:-1] * edges[1:]))
    share = np.interp(np.log(surface.q), middle, np.log(np.clip(shares, 1e-4, None)))
    return em.Spectrum(surface.q, surface.c * np.exp(share), convention="2d")


def excess(surface, area: float) -> float:
    """r of the highest part of a map."""
    height = np.sort(surface.map.height, axis=None)
    count = max(int(area * height.size), 8)
    top = height[-count:]
    place = (np.arange(height.size - count, height.size) + 0.5) / height.size
    gaussian = norm.ppf(place) * height.std()
    return max((top.mean() - top[0]) / (gaussian.mean() - gaussian[0]), LEAST)


def by_excess(rubber, surface, area: float, at: dict) -> float:
    """Friction of the surface with the heights of its top."""
    mu = np.nan
    for _ in range(ROUNDS):
        scaled = em.Spectrum(surface.q, surface.c, convention="2d").raised(
            excess(surface, area)
        )
        curve = em.friction(rubber, scaled, **at)
        mu, area = float(curve.mu), float(np.sqrt(area * curve.area_ratio))
    return mu


def one(rng: np.random.Generator) -> list | None:
    """One map: what is known of it, its friction, and what each way says of that."""
    periods, ratio = int(rng.choice([2, 3, 4])), 8 * int(rng.choice([1, 2]))
    road = em.SelfAffine(rng.uniform(0.4, 0.95), 0.3, 1e3, 1e3 * ratio)
    cells = PER_WAVE * periods * ratio
    height, side = em.reference.rough_map(
        road, int(rng.integers(1_000_000)), periods=periods, points=cells
    )
    kind = str(rng.choice(KINDS))
    surface = em.read_surface(worn(kind, height, rng), pixel_size=side / cells)
    rubber = RUBBERS[str(rng.choice(list(RUBBERS)))]
    velocity = 10 ** rng.uniform(-3, 0)
    stiffness = abs(rubber.complex_modulus(np.array(1e3 * velocity)))
    pressure = float(stiffness * surface.rms_slope * 10 ** rng.uniform(-2.5, -0.3))
    at = {"velocity": velocity, "pressure": pressure}
    truth = em.friction(rubber, surface, **at, model=em.HalfSpace(), rtol=1e-2)
    if not truth.converged or not truth.mu > 0:
        return None
    curve = em.friction(rubber, surface, **at)
    mu, area = float(curve.mu), float(curve.area_ratio)
    factor = np.exp(0.4 * surface.skewness * np.sqrt(-np.log(area)))
    slope = float(em.friction(rubber, by_slope(surface, area), **at).mu)
    ways = (mu, mu * factor, slope, by_excess(rubber, surface, area, at))
    known = truth.area_ratio, surface.skewness, truth.mu, curve.model_error
    return [kind, *map(float, known), *ways]


def main() -> None:
    warnings.simplefilter("ignore")
    parser = argparse.ArgumentParser()
    parser.add_argument("--maps", type=int, default=80)
    maps = parser.parse_args().maps
    record = heading("Friction of heights that are not Gaussian", f"{maps} maps")
    rng = np.random.default_rng(11)
    rows = [row for row in (one(rng) for _ in range(maps)) if row is not None]
    kind = np.array([row[0] for row in rows])
    truth = np.array([row[3] for row in rows])
    logs = np.log(truth / np.array([row[5:] for row in rows]).T)
    record["points"] = rows
    columns = [np.sqrt((logs[:, kind == each] ** 2).mean(1)) for each in KINDS]
    every = np.sqrt((logs**2).mean(1))
    record["rms of ln(truth over each)"] = table(
        ("heights", "maps", *WAYS),
        [
            *(
                (name, int((kind == name).sum()), *column)
                for name, column in zip(KINDS, columns, strict=True)
            ),
            ("all", len(rows), *every),
        ],
    )
    record["verdicts"] = [
        verdict("top excess over default, rms of all", float(every[3] / every[0]), 0.5)
    ]
    save("skewed_roads", record)


if __name__ == "__main__":
    main()
