"""Does `error` of hot friction on a rough surface cover? Drawn scenes against finer
cells and a second solution.

    python benchmarks/heat_coverage.py [--scenes 500] [--first 0]

Each scene is drawn from its number: rubber, road, roll-off, velocity, pressure,
temperature, model, softening, vertical shift, heat into the road, adhesive shear, a
fourth of them cold rubber with thermally activated shear. Its mu is compared with that
on cells, stations and nodes in depth four times finer, and with `heat_reference.py`.
The materials have no recorded misfit, so that `error` is numerical alone.
"""

import argparse
import warnings
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import heat_reference
import numpy as np
from common import heading, one_thread, save, table, timed, verdict

import elastomdr as em
from elastomdr.rough import temperature_by_scale as warm

FULL = 500  # scenes from which the record is kept
FINER = 4
# relative distance of mu from which two solutions are two steady states
OTHER_STATE = 0.1


def rubber_of(rng: np.random.Generator) -> em.Prony:
    """A spectrum of random width and slope, softening and vertical shift in a part of
    them.
    """
    times = 10.0 ** np.arange(-11.0, rng.uniform(-2, 3), rng.choice([0.5, 1.0]))
    glassy = 10 ** rng.uniform(8, 9)
    slope = rng.uniform(0.15, 0.6)
    moduli = glassy * (times / times[0]) ** -slope * rng.uniform(0.7, 1.3, times.size)
    shift = em.WLF(rng.uniform(7, 14), rng.uniform(70, 130), 293.15)
    if rng.random() < 0.15:
        shift = em.Arrhenius(rng.uniform(3e4, 1.2e5), 293.15)
    softening = None
    if rng.random() < 0.2:
        softening = em.Softening(
            [1e-3, 1e-2, 0.1, 1.0], [1.0, 0.8, 0.5, 0.4], [1.0, 1.1, 0.9, 0.5]
        )
    vertical = em.EntropicVertical(293.15) if rng.random() < 0.2 else None
    equilibrium = 10 ** rng.uniform(5.3, 6.5)
    return em.Prony(
        equilibrium, moduli, times, shift=shift, softening=softening, vertical=vertical
    )


def road_of(rng: np.random.Generator) -> Any:
    low, decades = 10 ** rng.uniform(2.7, 4), rng.uniform(0.8, 3.2)
    roll_off = low * 10 ** rng.uniform(0.1, 0.5) if rng.random() < 0.3 else None
    return em.SelfAffine(
        rng.uniform(0.65, 0.95),
        rms_slope=rng.uniform(0.15, 1.2),
        q_low=low,
        q_high=low * 10**decades,
        q_rolloff=roll_off,
    )


def scene_of(number: int) -> dict[str, Any]:
    """The arguments of `em.friction`."""
    rng = np.random.default_rng(number)
    cold = number % 4 == 3
    counterface = (10 ** rng.uniform(-0.5, 1), 2e6) if rng.random() < 0.4 else None
    adhesion = None
    if cold or rng.random() < 0.35:
        shift = (
            em.Arrhenius(rng.uniform(5e4, 1e5), 298.15)
            if cold or rng.random() < 0.6
            else None
        )
        adhesion = em.AdhesiveShear(
            rng.uniform(2e6, 8e6),
            10 ** rng.uniform(-3, -1.5),
            rng.uniform(0.05, 0.2),
            shift=shift,
        )
    return {
        "material": rubber_of(rng),
        "shape": road_of(rng),
        "velocity": 10 ** (rng.uniform(-0.5, 1.3) if cold else rng.uniform(-3, 1.3)),
        "pressure": 10 ** rng.uniform(4.9, 6.2),
        "temperature": rng.uniform(253, 278) if cold else rng.uniform(263, 333),
        "heat": em.Heat(
            rng.uniform(0.15, 0.4), rng.uniform(1.5e6, 2.5e6), road=counterface
        ),
        "adhesion": adhesion,
        "model": em.Persson() if rng.random() < 0.25 else em.Multiscale(),
    }


def finer(arguments: dict[str, Any]) -> Any:
    """The same point with cells, stations and nodes in depth four times finer than
    where all points end.
    """
    before = warm._CELLS, warm._STATIONS, warm._K
    try:
        warm._CELLS, warm._STATIONS, warm._K = (FINER * n for n in before)
        return em.friction(**arguments)
    finally:
        warm._CELLS, warm._STATIONS, warm._K = before


def compared(number: int) -> dict[str, float] | None:
    """One scene; None where its point is flagged as not converged."""
    arguments = scene_of(number)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        took = timed(lambda: em.friction(**arguments))
        if not took.value.converged:
            return None
        fine = finer(arguments)
    own = dict(arguments)
    second = heat_reference.Point(own.pop("material"), own.pop("shape"), **own).solve()
    mu = float(took.value.mu)
    return {
        "scene": number,
        "shear": arguments["adhesion"] is not None,
        "mu": mu,
        "error": float(took.value.error),
        "finer": float(fine.mu) - mu,
        "second": second.mu - mu if second.settled else np.nan,
        "cpu": took.cpu,
        "rise": float(took.value.contact_rise),
        "several": bool(took.value.other_states),
    }


def counted(name: str, rows: list[dict[str, float]], against: str) -> tuple[Any, ...]:
    """Coverage of some scenes; those in another steady state, and those without a
    second solution, apart.
    """
    off = np.array([abs(row[against]) for row in rows])
    mu, error = (np.array([row[key] for row in rows]) for key in ("mu", "error"))
    known = np.isfinite(off)
    elsewhere = known & (off > OTHER_STATE * mu)
    same = known & ~elsewhere
    covered = off[known] <= error[known]
    share, of_error = off[same] / mu[same], error[same] / mu[same]
    return (
        name,
        against,
        int(known.sum()),
        int(elsewhere.sum()),
        float(covered.mean()),
        float(share.max()),
        float(np.median(of_error)),
        float(of_error.max()),
        float(np.median(share)),
        float((share / of_error).max()),
    )


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes", type=int, default=FULL)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    record = heading(
        "`error` of hot friction on rough surfaces", f"{options.scenes} drawn scenes"
    )
    numbers = range(options.first, options.first + options.scenes)
    one_thread()
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        found = list(pool.map(compared, numbers, chunksize=10))
    rows = [row for row in found if row is not None]
    print(f"  {len(rows)} of {len(found)} scenes converged")
    record["scenes"], record["converged"] = len(found), len(rows)
    titles = (
        "scenes",
        "against",
        "known",
        "other state",
        "covered",
        "largest off",
        "median error",
        "largest error",
        "median off",
        "largest off/error",
    )
    groups = (
        ("all", rows),
        ("no shear", [r for r in rows if not r["shear"]]),
        ("shear", [r for r in rows if r["shear"]]),
        ("cold, activated shear", [r for r in rows if r["scene"] % 4 == 3]),
    )
    table_rows = [
        counted(name, some, against)
        for name, some in groups
        for against in ("finer", "second")
    ]
    record["coverage"] = table(titles, table_rows)
    missed = [
        row
        for row in rows
        for against in ("finer", "second")
        if abs(row[against]) > row["error"]
    ]
    for row in missed:
        print(" ", {key: float(f"{value:.4g}") for key, value in row.items()})
    record["cpu"] = float(np.median([row["cpu"] for row in rows]))
    print(f"  a call takes {record['cpu']:.2g} s of processor time (median)")
    record["verdicts"] = [
        verdict(f"covered, all scenes, against {row[1]}", row[4], 0.99, least=True)
        for row in table_rows[:2]
    ]
    if options.scenes >= FULL:
        save("heat_coverage", record)


if __name__ == "__main__":
    main()
