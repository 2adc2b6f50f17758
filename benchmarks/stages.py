"""Rough contact solved in stages of length scales, against the direct solution.

    python benchmarks/stages.py [--far]

Waves from q_low to q_1 are solved on a map in three dimensions; its local pressures are
the nominal pressures of the next stage, waves from q_1 to q_2 on a map of their own,
and so on:

    mu p = tau_1 + int P_1(p') tau_2(p') dp',    A p = int P_1(p') A_2(p') dp'.

Two stages of a ratio of 8 or 16 are held against direct solutions with ratios of 64 and
256. What is between them is the price of separating the scales, and the chance of the
maps. `--far` goes on to four stages of 10 and compares Multiscale with them.
"""

import itertools
import sys

import numpy as np
from common import heading, save, table

import elastomdr as em
from elastomdr.rough import half_space
from elastomdr.rough.random_maps import full_contact, full_contact_of_map

HURST, SLOPE, VELOCITY, Q_LOW = 0.8, 0.5, 1e-2, 2 * np.pi
PER_WAVE = 4  # cells to the shortest wave of the last stage and of direct solutions
FINER = 2  # times as many in earlier stages, whose shortest waves have more below them
PERIODS = 4  # longest waves to a side of the map of a stage
TABULATED = 7  # nominal pressures at which a later stage is solved
LEVELS = (0.02, 0.1)  # pressure over the modulus at q_low times the rms slope
COLUMNS = ("rubber", "ratio", "level", "contact", "mu", "mu of stages")
COLUMNS += ("contact of stages", "multiscale")
SLOWEST = 1 / (Q_LOW * VELOCITY)
RUBBERS = {
    "broad": em.Foundation(
        1e6, 1e6 * 10 ** (0.2 * np.arange(9)), SLOWEST * 10.0 ** (2.0 - np.arange(9))
    ),
    "small loss": em.Foundation(
        1e6, np.full(9, 1e5), SLOWEST * 10.0 ** (2.0 - np.arange(9))
    ),
}
# ratio of a stage, and longest waves to a side and maps of the direct solution
DIRECT = ((8, 2, 2), (16, 1, 2))


def waves_between(road: em.SelfAffine, low: float, high: float) -> em.Spectrum:
    """The waves of a road in one stage."""
    q = np.array([low, high])
    return em.Spectrum(q, road.at(q), convention="2d")


def on_maps(
    rubber: em.Foundation,
    waves: em.Spectrum,
    pressures: np.ndarray,
    periods: int,
    per_wave: int,
    seeds: int,
) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """mu and real contact at each nominal pressure, means over maps, and all local
    pressures [Pa].
    """
    modulus = rubber.complex_modulus
    cells = 32 * int(np.ceil(per_wave * periods * waves.q_high / waves.q_low / 32))
    mu, area = np.zeros((2, seeds, pressures.size))
    local: list[list[np.ndarray]] = [[] for _ in pressures]
    of_waves = full_contact(
        modulus, waves, np.full(pressures.shape, VELOCITY), pressures
    )
    for seed in range(seeds):
        heights, side = em.reference.rough_map(
            waves, seed, periods=periods, points=cells
        )
        sides, start = (side, side), None
        for i in np.argsort(pressures)[::-1]:
            given = {"velocity": VELOCITY, "pressure": float(pressures[i])}
            found = half_space.solve(
                modulus, heights, sides, **given, start=start, double=False
            )
            start = found.pressure if found.settled else None
            on_map = full_contact_of_map(modulus, heights, sides, **given)
            mu[seed, i] = found.stress / pressures[i] * of_waves[i] / on_map
            area[seed, i] = found.area
            local[i].append(found.pressure.ravel())
    return mu.mean(axis=0), area.mean(axis=0), [np.concatenate(one) for one in local]


def in_stages(
    rubber: em.Foundation,
    road: em.SelfAffine,
    ends: np.ndarray,
    pressures: np.ndarray,
    seeds: int,
) -> tuple[np.ndarray, np.ndarray]:
    """mu and real contact at nominal pressures, of the stages between the wave numbers
    `ends`.
    """
    last = len(ends) == 2
    per_wave = PER_WAVE if last else FINER * PER_WAVE
    waves = waves_between(road, *ends[:2])
    mu, area, local = on_maps(rubber, waves, pressures, PERIODS, per_wave, seeds)
    if last:
        return mu, area
    touching = np.concatenate([one[one > 0] for one in local])
    table_of = np.geomspace(*np.quantile(touching, (0.02, 0.9995)), TABULATED)
    later_mu, later_area = in_stages(rubber, road, ends[1:], table_of, seeds)
    whole, contact = [], []
    for i, pressure in enumerate(pressures):
        p = local[i][local[i] > 0]
        # in light contact mu does not depend on the pressure, and the area goes with it
        log_p = np.log(np.clip(p, table_of[0], table_of[-1]))
        share = p / pressure / local[i].size
        later = np.interp(log_p, np.log(table_of), later_mu)
        per_pressure = np.interp(log_p, np.log(table_of), later_area / table_of)
        whole.append(mu[i] + (share * later).sum())
        contact.append(np.minimum(per_pressure * p, 1.0).sum() / local[i].size)
    return np.array(whole), np.array(contact)


def levels_of(rubber: em.Foundation) -> np.ndarray:
    """Nominal pressures [Pa]."""
    stiffness = abs(rubber.complex_modulus(np.array(Q_LOW * VELOCITY)))
    return np.array(LEVELS) * float(stiffness) * SLOPE


def main() -> None:
    record = heading(
        "Rough contact in stages of length scales",
        f"H = {HURST:g}, rms slope {SLOPE:g}, {PERIODS} longest waves to a side",
    )
    rows = []
    for (name, rubber), (ratio, periods, seeds) in itertools.product(
        RUBBERS.items(), DIRECT
    ):
        whole = float(ratio**2)
        road = em.SelfAffine(HURST, rms_slope=SLOPE, q_low=Q_LOW, q_high=whole * Q_LOW)
        pressures = levels_of(rubber)
        waves = waves_between(road, Q_LOW, whole * Q_LOW)
        mu, area, _ = on_maps(rubber, waves, pressures, periods, PER_WAVE, seeds)
        ends = Q_LOW * ratio ** np.arange(3.0)
        staged, contact = in_stages(rubber, road, ends, pressures, 2)
        model = em.friction(rubber, road, velocity=VELOCITY, pressure=pressures)
        for i, level in enumerate(LEVELS):
            row = (name, whole, level, area[i], mu[i], staged[i] / mu[i])
            rows.append((*row, contact[i] / area[i], model.mu[i] / mu[i]))
            print(rows[-1], flush=True)
    record["two stages"] = table(
        COLUMNS,
        rows,
    )
    if "--far" in sys.argv:
        record["four stages"] = far()
    save("stages", record)


def far() -> list:
    """Four stages of a ratio of 10, and Multiscale over them."""
    rows = []
    for name, rubber in RUBBERS.items():
        road = em.SelfAffine(HURST, rms_slope=SLOPE, q_low=Q_LOW, q_high=1e4 * Q_LOW)
        pressures = levels_of(rubber)
        mu, area = in_stages(rubber, road, Q_LOW * 10.0 ** np.arange(5), pressures, 2)
        model = em.friction(rubber, road, velocity=VELOCITY, pressure=pressures)
        for i, level in enumerate(LEVELS):
            ratios = model.mu[i] / mu[i], model.area_ratio[i] / area[i]
            rows.append((name, level, area[i], mu[i], *ratios))
    columns = ("rubber", "level", "contact", "mu", "multiscale", "its contact")
    return table(columns, rows)


if __name__ == "__main__":
    main()
