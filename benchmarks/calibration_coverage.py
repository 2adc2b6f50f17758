"""Do the 90 % intervals of `em.fit.calibrate` hold the truth? Synthetic friction whose
cutoff and shear law are drawn from what is assumed beforehand.

    python benchmarks/calibration_coverage.py [--cases 60] [--draws 150]

A tread compound on a self-affine road: 24 points at eight velocities over five decades
and three temperatures, 3 % noise, which is known in every other case and estimated in
the rest. Counted is how often the interval of each parameter holds its truth, by the
standard deviation and by draws.
"""

import argparse
import warnings
from dataclasses import replace

import numpy as np
from common import heading, save, table, timed, verdict

import elastomdr as em

NOISE, SHARE = 0.03, 0.9
# decades of what is drawn about the start
WIDTHS = {"q_high": 0.5, "stress": 0.3, "velocity": 1.0, "width": 0.3, "energy": 0.1}
STRESS, VELOCITY, WIDTH, ENERGY = 6e6, 5e-3, 0.1, 9e4
RUBBER = em.load_material("tread-passenger-synthetic")
ROAD = em.SelfAffine(0.8, rms_slope=0.7, q_low=1.26e3, q_high=1e5)
SCENE = {
    "velocity": np.tile(np.geomspace(1e-6, 0.1, 8), 3),
    "temperature": np.repeat([278.15, 293.15, 308.15], 8),
    "pressure": 3e5,
}


def case(seed: int, draws: int) -> tuple[np.ndarray, em.fit.Calibration]:
    """The true logarithms of the factors, and the calibration."""
    random = np.random.default_rng(seed)
    truth = random.normal(size=len(WIDTHS)) * list(WIDTHS.values())
    cutoff, stress, velocity, width, energy = 10.0**truth
    law = em.AdhesiveShear(
        STRESS * stress,
        VELOCITY * velocity,
        WIDTH * width,
        shift=em.Arrhenius(ENERGY * energy, 293.15),
    )
    road = ROAD.ended(float(ROAD.q_high) * cutoff)
    mu = em.friction(RUBBER, road, adhesion=law, **SCENE).mu
    mu = mu + NOISE * mu.mean() * random.normal(size=mu.shape)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = em.fit.calibrate(
            RUBBER,
            ROAD,
            measured=mu,
            error=NOISE * mu.mean() if seed % 2 else None,
            parameters=("q_high", "shear"),
            widths=WIDTHS,
            draws=draws,
            seed=seed,
            **SCENE,
        )
    return truth, found


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--draws", type=int, default=150)
    options = parser.parse_args()
    record = heading(
        "em.fit.calibrate against known cutoffs and shear laws",
        f"{options.cases} cases of 24 points, {NOISE:.0%} noise, {options.draws} draws",
    )
    hits: dict[str, list[np.ndarray]] = {"draws": [], "standard deviation": []}
    widths: dict[str, list[np.ndarray]] = {name: [] for name in hits}
    for seed in range(options.cases):
        truth, found = case(seed, options.draws)
        for way in hits:
            of_way = found if way == "draws" else replace(found, draws=None)
            low, high = np.array(
                [of_way.interval(name, SHARE) for name in found.parameters]
            ).T
            hits[way].append((low <= truth) & (truth <= high))
            widths[way].append(high - low)
    rows = [(way, *np.mean(of_way, 0), np.mean(of_way)) for way, of_way in hits.items()]
    record["coverage"] = table(("interval", *WIDTHS, "all"), rows)
    size = {way: np.median(of_way, 0).tolist() for way, of_way in widths.items()}
    record["median width in decades"] = size
    record["seconds"] = timed(lambda: case(0, options.draws), 1).cpu
    share = {way: float(np.mean(of_way)) for way, of_way in hits.items()}
    least = min(float(np.mean(of_way, 0).min()) for of_way in hits.values())
    record["verdicts"] = [
        *(
            verdict(f"intervals that hold the truth, {way}", value, 0.85, least=True)
            for way, value in share.items()
        ),
        verdict("least of a parameter", least, 0.78, least=True),
        verdict("largest share", max(share.values()), 0.96),
    ]
    save("calibration_coverage", record)


if __name__ == "__main__":
    main()
