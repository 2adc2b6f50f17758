"""Friction at a million points of a road: how many a second, where JAX computes?

    python benchmarks/accelerator.py [--points 1000000]

Points are drawn over five decades of velocity and 1.5 of pressure, on a self-affine road
of three decades, for a rubber of twelve branches. `integrals`: those of one level of
cells alone, compiled, without what it takes to compile. `em.friction`: the whole call,
with three levels of cells, the bound of the model and the flags. `NumPy`: the integrals of 4,096
of the points as they are computed where no accelerator is; the largest difference
stands beside it.
"""

import argparse
import json
import time

import numpy as np
from common import RESULTS, heading

import elastomdr as em
from elastomdr.rough import many_points, multiscale
from elastomdr.rough.psd_integrals import PER_DECADE, nodes

RUBBER = em.Prony(
    1e6,
    np.geomspace(3e7, 1e6, 12),
    np.geomspace(1e-9, 1e2, 12),
    shift=em.WLF(8.86, 101.6, 293.15),
)
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e6)
MODEL = em.Multiscale()
SAMPLE = 4096


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=1_000_000)
    count = parser.parse_args().points
    rng = np.random.default_rng(0)
    velocity, pressure = (
        10 ** rng.uniform(-4, 1, count),
        10 ** rng.uniform(4.5, 6, count),
    )
    plain = multiscale.Local()
    at = nodes(ROAD, PER_DECADE, multiscale.bends(ROAD, plain))
    table = multiscale.table_of(RUBBER.complex_modulus, at, velocity, PER_DECADE, plain)

    def integrals() -> np.ndarray:
        return many_points.friction_and_area(MODEL, at, table, velocity, pressure)[0]

    import jax

    device = str(jax.devices()[0])
    integrals()  # compiles
    began = time.perf_counter()
    mu = integrals()
    rate = count / (time.perf_counter() - began)
    began, few = time.process_time(), slice(0, SAMPLE)
    by_numpy = np.concatenate(
        [
            multiscale._evaluate(
                table,
                at,
                velocity[i : i + 64],
                pressure[i : i + 64],
                MODEL,
                plain,
            )[0]
            for i in range(0, SAMPLE, 64)
        ]
    )
    rate_of_numpy = SAMPLE / (time.process_time() - began)
    off = float(np.max(np.abs(mu[few] / by_numpy - 1)))
    asked = {"velocity": velocity, "pressure": pressure}
    em.friction(RUBBER, ROAD, **asked)  # compiles
    began = time.perf_counter()
    curve = em.friction(RUBBER, ROAD, **asked)
    whole = count / (time.perf_counter() - began)
    heading(f"Friction on a road, {count} points, {device}")
    print(f"integrals    {rate:12,.0f} points/s")
    print(
        f"em.friction  {whole:12,.0f} points/s, {curve.converged.mean():.2%} converged"
    )
    print(
        f"NumPy        {rate_of_numpy:12,.0f} points/s of one core, off by {off:.1e} at most"
    )
    record = {
        "device": device,
        "points": count,
        "integrals": rate,
        "em.friction": whole,
        "numpy": rate_of_numpy,
        "difference": off,
    }
    RESULTS.mkdir(exist_ok=True)
    name = f"accelerator_{jax.default_backend()}.json"
    (RESULTS / name).write_text(json.dumps(record, indent=1))
    assert off < 1e-9


if __name__ == "__main__":
    main()
