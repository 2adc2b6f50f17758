"""What heights that are not Gaussian do to friction at the same spectrum: the factor
that `model_error` holds for a measured surface.

    python benchmarks/non_gaussian.py

Maps in three dimensions with one spectrum and a given skewness of the heights: heights
are given a Pearson III distribution by rank, then the amplitudes of the spectrum with
their own phases, in turn (IAAFT; Schreiber and Schmitz, Phys. Rev. Lett. 77 (1996)
635). Skewness is positive where the surface has peaks, towards the rubber. Beside each
stands the map with the same phases to begin with, and no skewness.
"""

import itertools

import numpy as np
from common import heading, save, table, verdict
from scipy import stats

import elastomdr as em
from elastomdr.rough import half_space
from elastomdr.rough.surface import _PER_SKEWNESS

CELLS, PER_WAVE, WAVES, ROUNDS = 256, 4, 4, 40
SKEWNESS = (-1.0, -0.5, -0.25, 0.25, 0.5, 1.0)
LEVELS = (
    0.005,
    0.015,
    0.05,
    0.15,
    0.4,
)  # pressure over the modulus at q_low times the rms slope
RUBBERS = {
    "broad": em.Prony(
        2e6,
        [3e6 * 10 ** (-0.35 * i) * 100 for i in range(8)],
        [10.0 ** (i - 8) for i in range(8)],
    ),
    "small loss": em.Prony(2e6, [2e5] * 8, [10.0 ** (i - 8) for i in range(8)]),
}
HURST = (0.8, 0.5)
SEEDS = 2
VELOCITY = 1e-2


def skewed(gaussian: np.ndarray, skewness: float) -> np.ndarray:
    """Heights with the spectrum of `gaussian` and, nearly, a skewness."""
    amplitude = np.abs(np.fft.rfft2(gaussian))
    place = (np.arange(gaussian.size) + 0.5) / gaussian.size
    values = stats.pearson3.ppf(place, skewness) * gaussian.std()
    heights = gaussian
    for _ in range(ROUNDS):
        ranked = np.empty(heights.size)
        ranked[np.argsort(heights, axis=None)] = values
        waves = np.fft.rfft2(ranked.reshape(heights.shape))
        heights = np.fft.irfft2(
            amplitude * np.exp(1j * np.angle(waves)), s=heights.shape
        )
    return heights


def gaussian_map(spectrum: em.Spectrum, seed: int) -> np.ndarray:
    """A periodic map [m] of sides 1 m with the spectrum."""
    k = 2 * np.pi * np.fft.fftfreq(CELLS, 1 / CELLS)
    q = np.hypot(k[:, None], k[None])
    white = np.random.default_rng(seed).standard_normal(q.shape)
    amplitude = np.sqrt(spectrum.at(q)) * 2 * np.pi * CELLS
    heights = np.fft.ifft2(np.fft.fft2(white) * amplitude).real
    return heights - heights.mean()


def main() -> None:
    record = heading(
        "Heights that are not Gaussian, at one spectrum",
        f"maps of {CELLS} x {CELLS} cells, {PER_WAVE} to the shortest wave",
    )
    low, high = 2 * np.pi * WAVES, 2 * np.pi * CELLS / PER_WAVE
    rows = []
    for (name, rubber), hurst in itertools.product(RUBBERS.items(), HURST):
        road = em.SelfAffine(hurst, rms_slope=0.3, q_low=low, q_high=high)
        body = em.half_space(rubber)
        stiffness = float(abs(body.complex_modulus(np.array(low * VELOCITY))))
        for seed, level in itertools.product(range(SEEDS), LEVELS):
            plain = gaussian_map(road, seed)

            def solved(heights, level=level, body=body, stiffness=stiffness):
                pressure = level * stiffness * 0.3
                found = half_space.solve(
                    body.complex_modulus,
                    heights,
                    (1.0, 1.0),
                    velocity=VELOCITY,
                    pressure=pressure,
                    double=False,
                )
                return found.stress / pressure, found.area

            mu, area = solved(skewed(plain, 0.0))
            for skewness in SKEWNESS:
                heights = skewed(plain, skewness)
                other, contact = solved(heights)
                rows.append(
                    (
                        name,
                        hurst,
                        seed,
                        area,
                        float(stats.skew(heights, axis=None)),
                        contact / area,
                        other / mu,
                    )
                )
    record["points"] = rows
    area, skewness, ratio = (np.array([row[i] for row in rows]) for i in (3, 4, 6))
    record["table"] = table(
        ("rubber", "H", "seed", "contact", "skewness", "area ratio", "mu ratio"), rows
    )
    slope, of_area = (
        np.log(x) / (skewness * np.sqrt(-np.log(area)))
        for x in (ratio, [row[5] for row in rows])
    )
    record["slope"] = [float(x) for x in np.quantile(slope, (0.025, 0.5, 0.975))]
    record["of area"] = [float(x) for x in np.quantile(of_area, (0.025, 0.5, 0.975))]
    print("  ln(mu/mu_Gaussian) over skewness sqrt(-ln A):", record["slope"])
    print("  the same of the area:", record["of area"])
    bound = _PER_SKEWNESS * np.abs(skewness) * np.sqrt(-np.log(area))
    record["verdicts"] = [
        verdict(
            "points within the bound",
            float(np.mean(np.abs(np.log(ratio)) <= bound)),
            0.95,
            least=True,
        )
    ]
    save("non_gaussian", record)


if __name__ == "__main__":
    main()
