"""Sliding along, across and at an angle to the lay of a ground surface: Multiscale and
Persson's theory against three dimensions.

    python benchmarks/anisotropic.py

Isotropic self-affine maps (waves in a ratio of 16) are stretched along x and squeezed
along y by the root of the Peklenik number: 1/g across the lay is g along it. Each is
solved in three dimensions in five directions at four pressures. The models get what
`em.read_surface` would: the spectrum averaged over directions and the Peklenik number
by scale, from second moments over the angle, of the infinite map. What that loses of
the directions is seen in full contact, where both are exact; friction on the map is
divided by what it has there over the stretched spectrum, as in `em.HalfSpace`.
"""

import itertools
import sys

import matplotlib.pyplot as plt
import numpy as np
from common import cached, heading, save, table, verdict

import elastomdr as em
from elastomdr.rough import half_space
from elastomdr.rough.random_maps import full_contact_of_map
from elastomdr.surface.lay import Lay
from elastomdr.surface.topography import MeasuredSurface

CELLS, PERIODS, RATIO, HURST, SLOPE = 128, 2, 16.0, 0.8, 0.3
PEKLENIK = (1.0, 3.0, 9.0)
DIRECTIONS = (0.0, 22.5, 45.0, 67.5, 90.0)  # of the motion to the lay [degrees]
LEVELS = (0.01, 0.04, 0.15, 0.5)  # pressure over the modulus at q_low times the slope
SEEDS = 2
VELOCITY, Q_LOW = 1e-2, 2 * np.pi * PERIODS
COLUMNS = (
    "rubber",
    "g",
    "direction",
    "level",
    "contact",
    "mu",
    "multiscale",
    "persson",
)
COLUMNS += ("area", "bound", "full contact")
SLOWEST = 1 / (Q_LOW * VELOCITY)  # of the waves, their frequency's reciprocal [s]
RUBBERS = {
    "broad": em.Foundation(
        1e6, 1e6 * 10 ** (0.3 * np.arange(8)), SLOWEST * 10.0 ** (2.5 - np.arange(8))
    ),
    "small loss": em.Foundation(
        1e6, np.full(8, 1e5), SLOWEST * 10.0 ** (2.5 - np.arange(8))
    ),
    "one relaxation": em.Foundation(1e6, [9e6], [SLOWEST / 3]),
}


def stretched(peklenik: float) -> MeasuredSurface:
    """The surface as the models take it: the mean of C over directions, and the
    Peklenik number by scale.

    A wave at the angle b to the lay was one of wave number q s before, s^2 = g cos^2 b
    + sin^2 b/g.
    """
    plain = em.SelfAffine(HURST, rms_slope=SLOPE, q_low=Q_LOW, q_high=RATIO * Q_LOW)
    root = np.sqrt(peklenik)
    b = np.pi * (np.arange(20000) + 0.5) / 20000
    factor = np.sqrt(peklenik * np.cos(b) ** 2 + np.sin(b) ** 2 / peklenik)
    # at its ends a stretched spectrum has waves of one direction only
    inside = 1.02 if peklenik > 1 else 1.0
    q = np.geomspace(Q_LOW / root * inside, RATIO * Q_LOW * root / inside, 80)
    c = np.array([plain.at(one * factor) for one in q])
    moment = -(c * np.cos(2 * b)).mean(axis=1) / c.mean(axis=1)
    log_g = np.arctanh(np.clip(moment, -0.999, 0.999))
    return MeasuredSurface(
        q=q,
        c=c.mean(axis=1),
        relative_error=0 * q,
        measured_height=plain.rms_height,
        skewness=0.0,
        report=(),
        lay=Lay(q, log_g, 0 * q, 0.0),
    )


def main() -> None:
    record = heading(
        "Sliding in a direction to the lay of a stretched surface",
        f"maps of {CELLS} x {CELLS} cells, waves in a ratio of {RATIO:g}, H = {HURST:g}",
        f"{SEEDS} maps each, in {len(DIRECTIONS)} directions",
    )
    inputs = {"cells": CELLS, "waves": (PERIODS, RATIO, HURST), "peklenik": PEKLENIK}
    inputs |= {"directions": DIRECTIONS, "levels": LEVELS, "seeds": SEEDS}
    inputs["rubbers"] = {name: rubber.moduli for name, rubber in RUBBERS.items()}
    truth = cached("anisotropic_truth", inputs, solved, "--fresh" in sys.argv)
    rows = []
    for (name, rubber), g in itertools.product(RUBBERS.items(), PEKLENIK):
        rows += compared(name, rubber, g, truth[f"{name} {g}"])
    record["points"] = table(COLUMNS, rows)
    summed(record, rows)
    save("anisotropic", record, drawn(rows))


def pressures(rubber: em.Foundation, g: float) -> np.ndarray:
    """Those of the levels [Pa]."""
    stiffness = float(abs(rubber.complex_modulus(np.array(Q_LOW * VELOCITY))))
    return np.array(LEVELS) * stiffness * SLOPE * np.sqrt((g + 1 / g) / 2)


def directions(g: float) -> tuple[float, ...]:
    """In which a surface is slid over [degrees]."""
    return DIRECTIONS if g > 1 else DIRECTIONS[:1]


def solved() -> dict[str, list]:
    """mu, real contact and mu in full contact on the maps, of each direction and
    level.
    """
    plain = em.SelfAffine(HURST, rms_slope=SLOPE, q_low=Q_LOW, q_high=RATIO * Q_LOW)
    maps = [
        em.reference.rough_map(plain, seed, periods=PERIODS, points=CELLS)[0]
        for seed in range(SEEDS)
    ]
    found = {}
    for (name, rubber), g in itertools.product(RUBBERS.items(), PEKLENIK):
        sides, loads = (np.sqrt(g), 1 / np.sqrt(g)), pressures(rubber, g)
        found[f"{name} {g}"] = [
            np.mean(
                [on_map(rubber, one, sides, loads, np.radians(angle)) for one in maps],
                axis=0,
            )
            for angle in directions(g)
        ]
    return found


def compared(name: str, rubber: em.Foundation, g: float, truth: list) -> list:
    """The models beside the truth: a row for each direction and level."""
    surface, loads = stretched(g), pressures(rubber, g)
    angles = np.radians(directions(g))
    at = {"velocity": VELOCITY, "direction": angles, "rtol": 1e-4}
    multiscale, persson = (
        em.friction(rubber, surface, **at, pressure=loads[:, None], model=model)
        for model in ("multiscale", "persson")
    )
    heavy = 1e6 * loads.max()
    full = em.friction(rubber, surface, **at, pressure=heavy).mu * heavy
    rows = []
    for i, degrees in enumerate(directions(g)):
        mu, area, in_full = np.array(truth[i])
        for j, level in enumerate(LEVELS):
            of_surface = full[i] / loads[j] / in_full[j]
            true = mu[j] * of_surface
            rows.append(
                (
                    name,
                    g,
                    degrees,
                    level,
                    area[j],
                    true,
                    multiscale.mu[j, i] / true,
                    persson.mu[j, i] / true,
                    multiscale.area_ratio[j, i] / area[j],
                    multiscale.model_error[j, i] / multiscale.mu[j, i],
                    of_surface,
                )
            )
    return rows


def on_map(
    rubber: em.Foundation,
    heights: np.ndarray,
    sides: tuple[float, float],
    pressures: np.ndarray,
    angle: float,
) -> np.ndarray:
    """mu, the real contact and mu in full contact: (3, pressures)."""
    found, start = [], None
    for pressure in pressures[::-1]:
        given = {"velocity": VELOCITY, "pressure": float(pressure), "angle": angle}
        contact = half_space.solve(
            rubber.complex_modulus, heights, sides, **given, start=start, double=False
        )
        start = contact.pressure if contact.settled else None
        mu = contact.stress / pressure if contact.settled else np.nan
        full = full_contact_of_map(rubber.complex_modulus, heights, sides, **given)
        found.append((mu, contact.area, full))
    return np.array(found[::-1]).T


def summed(record: dict, rows: list) -> None:
    """How far the models are off, against the isotropic map of the same rubber and
    level, along and across.
    """
    plain = {(row[0], row[3]): row for row in rows if row[1] == 1}
    summary = []
    for g, degrees in itertools.product(PEKLENIK[1:], DIRECTIONS):
        some = [row for row in rows if row[1] == g and row[2] == degrees]
        off = np.log([row[6] for row in some])
        beyond = off - np.log([plain[row[0], row[3]][6] for row in some])
        persson = np.log([row[7] for row in some])
        rms = [np.sqrt((x**2).mean()) for x in (off, beyond, persson)]
        summary.append((g, degrees, off.mean(), beyond.mean(), *rms))
    record["summary"] = table(
        (
            "g",
            "direction",
            "mean of ln(mu/mu_3D)",
            "mean beyond that of g = 1",
            "rms",
            "rms beyond",
            "rms of Persson",
        ),
        summary,
    )
    held = [abs(np.log(row[6])) <= np.log1p(row[9]) for row in rows if row[1] > 1]
    record["verdicts"] = [
        verdict("points within the bound", float(np.mean(held)), 0.95, least=True)
    ]


def drawn(rows: list) -> plt.Figure:
    """mu over the direction, model and truth, one panel for each rubber."""
    figure, axes = plt.subplots(
        1, len(RUBBERS), figsize=(11, 3.8), layout="constrained"
    )
    level = LEVELS[1]
    for axis, name in zip(axes, RUBBERS, strict=True):
        for color, g in zip(("0.5", "C0", "C3"), PEKLENIK, strict=True):
            some = [
                row
                for row in rows
                if row[0] == name and row[1] == g and row[3] == level
            ]
            mean = next(r for r in rows if r[0] == name and r[1] == 1 and r[3] == level)
            degrees, truth = [r[2] for r in some], np.array([r[5] for r in some])
            model = truth * [r[6] for r in some]
            if g == 1:
                axis.axhline(model[0] / mean[5], color=color, lw=1, label="isotropic")
                axis.plot([0, 90], [1, 1], "o", color=color)
                continue
            axis.plot(degrees, truth / mean[5], "o", color=color)
            axis.plot(
                degrees, model / mean[5], color=color, label=f"Peklenik number {g:g}"
            )
        axis.set(title=name, xlabel="direction to the lay [degrees]", ylim=(0, None))
        axis.set_xticks(DIRECTIONS)
    axes[0].set_ylabel("mu over that of the isotropic map")
    axes[0].legend(title="lines: Multiscale, points: 3D", fontsize=8)
    return figure


if __name__ == "__main__":
    main()
