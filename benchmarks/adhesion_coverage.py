"""Do the 95 % intervals of `em.fit.adhesion` hold the truth? Synthetic friction with a
known shear law.

    python benchmarks/adhesion_coverage.py [--draws 200]

A tread compound on a self-affine road: 30 points at ten velocities over five decades
and three temperatures, 2 % noise, its size known, estimated in proportion, or estimated
of one size. Counted is how often each interval holds its truth.
"""

import argparse

import numpy as np
from common import heading, save, table, timed, verdict

import elastomdr as em

TRUTH = {"stress": 6e6, "velocity": 4e-3, "width": 0.1, "energy": 9e4}
NOISE = 0.02


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--draws", type=int, default=200)
    draws = parser.parse_args().draws
    record = heading(
        "em.fit.adhesion against known shear laws",
        f"{draws} draws, 30 points, {NOISE:.0%} noise",
    )
    rubber = em.load_material("tread-passenger-synthetic")
    road = em.SelfAffine(0.8, rms_slope=0.7, q_low=1.26e3, q_high=3.1e5)
    law = em.AdhesiveShear(
        TRUTH["stress"],
        TRUTH["velocity"],
        TRUTH["width"],
        shift=em.Arrhenius(TRUTH["energy"], 293.15),
    )
    scene = {
        "velocity": np.geomspace(1e-6, 0.1, 10),
        "temperature": np.array([[278.15], [293.15], [308.15]]),
    }
    bare = em.friction(rubber, road, pressure=3e5, **scene)
    mu = em.friction(rubber, road, pressure=3e5, adhesion=law, **scene).mu
    rows, worst, most = [], 1.0, 0.0
    for name, error in (
        ("known", NOISE * mu),
        ("in proportion", "relative"),
        ("of one size", None),
    ):
        inside = np.zeros((draws, len(TRUTH)), bool)
        for i in range(draws):
            noisy = mu * (1 + NOISE * np.random.default_rng(i).normal(size=mu.shape))
            fit = em.fit.adhesion(bare, noisy, error=error)
            inside[i] = [
                low <= TRUTH[key] <= high
                for key, (low, high) in ((k, fit.interval[k]) for k in TRUTH)
            ]
        each = inside.mean(0)
        rows.append((name, *each, inside[:, :3].all(1).mean()))
        worst, most = min(worst, each.min()), max(most, each.max())
    titles = ("error", *TRUTH, "stress, velocity and width at once")
    record["coverage"] = table(titles, rows)
    noisy = mu * (1 + NOISE * np.random.default_rng(0).normal(size=mu.shape))
    record["seconds"] = timed(
        lambda: em.fit.adhesion(bare, noisy, error="relative"), 3
    ).cpu
    print(f"  one fit: {record['seconds']:.2g} s of processor time")
    record["verdicts"] = [
        verdict(
            "least share of intervals that hold the truth",
            float(worst),
            0.9,
            least=True,
        ),
        verdict("largest share", float(most), 0.99),
    ]
    save("adhesion_coverage", record)


if __name__ == "__main__":
    main()
