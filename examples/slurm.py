"""A sweep of many points on a cluster with SLURM.

    pip install "elastomdr[sweep,cluster]"
    sbatch --time=1-0 --wrap "python slurm.py --store /scratch/runs.zarr"

This process submits jobs of one core, as many as there is work for, hands chunks of
points to them, and is the only one that writes to the store. A job that ends, at its
time limit say, is replaced. When this process ends, give the same command again: it
computes what is missing.
"""

import argparse

import numpy as np
from dask_jobqueue import SLURMCluster
from distributed import Client

import elastomdr as em


def axes(velocities: int) -> dict:
    """Two compounds on ten roads, at 5 pressures and 7 temperatures."""
    materials = ["tread-passenger-synthetic", "tread-winter-synthetic"]
    return {
        "material": [em.load_material(name) for name in materials],
        "surface": [
            em.SelfAffine(0.8, q_low=1e3, q_high=1e6, rms_slope=slope)
            for slope in np.linspace(0.3, 1.2, 10)
        ],
        "pressure": np.linspace(1e5, 5e5, 5),
        "temperature": 273.15 + np.linspace(0, 60, 7),
        "velocity": np.geomspace(1e-5, 10, velocities),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--store", default="runs.zarr", help="a folder or a URL")
    parser.add_argument("--jobs", type=int, default=100, help="at most, at a time")
    parser.add_argument("--velocities", type=int, default=100)
    options = parser.parse_args()
    # One process on one core a job: chunks need no more, and a core is soon free.
    cluster = SLURMCluster(cores=1, memory="2 GB", walltime="04:00:00")
    with cluster, Client(cluster) as client:
        cluster.adapt(minimum=1, maximum=options.jobs)
        dataset = em.sweep(
            em.friction, axes(options.velocities), store=options.store, client=client
        )
    print(dataset)


if __name__ == "__main__":
    main()
