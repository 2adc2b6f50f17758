"""Friction of measured heights that are not Gaussian: `em.Multiscale()`, which follows
the slopes of their tops, against maps in three dimensions that nothing was fitted to.

    python benchmarks/skewed_roads.py [--maps 140] [--seed 9]      # some minutes

Maps are drawn, worn in one of `KINDS` of ways and read as an instrument gives them;
`em.HalfSpace()` of each map is the truth. Maps hold three to six longest waves a side,
and pressures are those at which some summits carry the load: below, one map has no
answer for its surface. The surface is raised to the rms slope of its map, since what
reading leaves out of the shortest waves (8 % of friction) is no error of the model.
Constants of the bound were chosen on other maps.
"""

import argparse
import warnings

import numpy as np
from common import heading, save, table, verdict
from scipy import stats
from scipy.ndimage import gaussian_filter1d

import elastomdr as em

KINDS = (
    "Gaussian",
    "low summits",
    "cut off",
    "rounded",
    "pits",
    "peaks",
    "lognormal",
    "long waves flat",
    "short waves halved",
    "gravel",
    "honed",
    "ridges",
    "terraces",
    "same spectrum",
)
PER_WAVE, ROUNDS = 4, 40  # cells of the shortest wave; of `skewed`
RUBBERS = {
    "broad": em.Prony(
        2e6,
        [3e6 * 10 ** (-0.35 * i) * 100 for i in range(8)],
        [10.0 ** (i - 8) for i in range(8)],
    ),
    "small loss": em.Prony(2e6, [2e5] * 8, [10.0 ** (i - 8) for i in range(8)]),
    "epdm": em.load_material("epdm-70"),
}


def skewed(gaussian: np.ndarray, skewness: float) -> np.ndarray:
    """Heights with the spectrum of `gaussian` and, nearly, a skewness: in turn a Pearson
    III distribution by rank and the amplitudes of the spectrum (IAAFT; Schreiber and
    Schmitz, Phys. Rev. Lett. 77 (1996) 635).
    """
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


def worn(
    kind: str, height: np.ndarray, periods: int, rng: np.random.Generator
) -> np.ndarray:
    """Heights of which something has become of the summits or the valleys."""
    rms, cut = height.std(), rng.uniform(-0.3, 0.8) * height.std()
    if kind == "low summits":
        return np.where(
            height > cut, cut + rng.uniform(0.05, 0.6) * (height - cut), height
        )
    if kind == "cut off":
        return np.minimum(height, rng.uniform(0.3, 1.5) * rms)
    if kind == "rounded":
        low = cut + 0.2 * rms * np.tanh((height - cut) / (0.2 * rms))
        return np.where(height > cut, low, height)
    bent = {"pits": (-0.6, -0.1), "peaks": (0.1, 0.4), "lognormal": (0.3, 0.7)}
    if kind in bent:
        bend = rng.uniform(*bent[kind])
        return np.expm1(bend * height / rms) * rms / bend
    if kind == "honed":
        other = np.roll(height, (17, 31), (0, 1)).T[::-1]
        return np.minimum(height, cut + rng.uniform(0.1, 0.4) * other)
    if kind == "ridges":
        width = height.shape[0] / periods / rng.uniform(6, 12)
        along = gaussian_filter1d(height, width, axis=0, mode="wrap")
        return worn(str(rng.choice(KINDS[1:6])), along, periods, rng)
    if kind == "terraces":
        place = height / (rng.uniform(0.5, 1.2) * rms)
        within = place - np.floor(place) - 0.5
        steps = np.floor(place) + 0.5 + 0.5 * np.tanh(within / 0.15)
        return steps * rms
    if kind == "same spectrum":
        return skewed(height, float(rng.choice([-1.0, -0.5, 0.5, 1.0])))
    waves = np.hypot(*np.meshgrid(*[np.fft.fftfreq(len(height), 1 / len(height))] * 2))
    kept = waves <= periods * rng.uniform(2, 4)
    long = np.fft.ifft2(np.where(kept, np.fft.fft2(height), 0)).real
    if kind == "long waves flat":
        return np.minimum(long, cut) + height - long
    if kind == "short waves halved":
        return long + (height - long) * np.where(long > cut, rng.uniform(0.2, 0.6), 1.0)
    if kind == "gravel":
        stones = np.tanh((long - cut) / (rng.uniform(0.25, 0.8) * rms)) * rms
        return stones + rng.uniform(0.3, 1) * (height - long)
    return height


def one(seed: int, index: int) -> list | None:
    """One map: what is known of it, its friction and contact, and what the model says."""
    rng = np.random.default_rng([seed, index])
    kind, rubber = KINDS[index % len(KINDS)], RUBBERS[str(rng.choice(list(RUBBERS)))]
    periods, ratio = int(rng.choice([3, 4, 6])), 8 * int(rng.choice([1, 2]))
    road = em.SelfAffine(rng.uniform(0.4, 0.95), 0.3, 1e3, 1e3 * ratio)
    height, side = em.reference.rough_map(
        road,
        int(rng.integers(1_000_000)),
        periods=periods,
        points=PER_WAVE * periods * ratio,
    )
    surface = em.read_surface(
        worn(kind, height, periods, rng), pixel_size=side / len(height)
    )
    velocity = 10 ** rng.uniform(-3, 0)
    modulus = em.half_space(rubber).complex_modulus(np.array(1e3 * velocity))
    pressure = float(abs(modulus) * surface.rms_slope * 10 ** rng.uniform(-1.6, 0.2))
    at = {"velocity": velocity, "pressure": pressure}
    truth = em.friction(rubber, surface, **at, model=em.HalfSpace(), rtol=1e-2)
    if not truth.converged or not truth.mu > 0:
        return None
    level = surface.raised(slope_of_map(surface) / surface.rms_slope)
    curve = em.friction(rubber, level, **at)
    gaussian = em.Spectrum(level.q, level.c, convention="2d")
    other = em.friction(rubber, gaussian, **at)
    numbers = surface.skewness, truth.area_ratio, curve.area_ratio, other.area_ratio
    numbers += truth.mu, curve.mu, other.mu, curve.model_error
    return [kind, *map(float, numbers)]


def slope_of_map(surface) -> float:
    """The rms slope of the map that em.HalfSpace() slides over."""
    whole = surface.map.periodic(surface.map.height.shape)
    power = np.abs(np.fft.fft2(whole.height) / whole.height.size) ** 2
    k_x, k_y = (
        2 * np.pi * np.fft.fftfreq(n, length / n)
        for n, length in zip(whole.height.shape, whole.sides, strict=True)
    )
    return float((power * (k_x[:, None] ** 2 + k_y**2)).sum() ** 0.5)


def main() -> None:
    warnings.simplefilter("ignore")
    parser = argparse.ArgumentParser()
    parser.add_argument("--maps", type=int, default=140)
    parser.add_argument("--seed", type=int, default=9)
    given = parser.parse_args()
    record = heading(
        "Friction of heights that are not Gaussian", f"{given.maps} maps, {given.seed=}"
    )
    rows = [one(given.seed, i) for i in range(given.maps)]
    rows = [row for row in rows if row is not None]
    record["points"] = rows
    kind = np.array([row[0] for row in rows])
    numbers = np.array([row[1:] for row in rows]).T
    _, area, by_tops, by_spectrum, truth, mu, other, bound = numbers
    covered = abs(truth - mu) <= bound
    logs = np.log([truth / mu, truth / other, area / by_tops, area / by_spectrum])

    def line(name: str, which: np.ndarray) -> tuple:
        rms = np.sqrt((logs[:, which] ** 2).mean(1))
        worst = abs(logs[0, which]).max()
        return name, int(which.sum()), *rms, worst, float(covered[which].mean())

    columns = ("heights", "maps", "mu", "mu, Gaussian", "A", "A, Gaussian", "worst mu")
    lines = [line(each, kind == each) for each in KINDS]
    lines.append(line("all", kind == kind))
    record["rms of ln(truth over model)"] = table((*columns, "in bound"), lines)
    rms, gaussian, *_ = lines[-1][2:]
    record["verdicts"] = [
        verdict("rms of ln mu over that of Gaussian heights", rms / gaussian, 0.4),
        verdict("maps within the bound", lines[-1][-1], 0.95, least=True),
        verdict("rms of Gaussian maps", lines[0][2], 0.05),
    ]
    save("skewed_roads", record)


if __name__ == "__main__":
    main()
