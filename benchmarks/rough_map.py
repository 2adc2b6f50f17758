"""Friction and force against approach of a rough surface: the line of the MDR beside a periodic half-space in 3D.

    python benchmarks/rough_map.py

A self-affine surface at three loads, light to nearly full contact of the relaxed rubber. In three dimensions: maps of
random phases, two longest waves wide, eight points on the shortest, by `em.reference.half_space_sliding`. Beside them
the mean over eight lines, by the pressure rule of the textbook, L = 2 pi/q_low, and by that of full contact. Approach:
the distance between the mean plane of the surface and the undeformed rubber, of a patch L by L, L = 2 pi/q_low, whose
own compression is p L/E*; what is left without that is the mean gap.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np
from common import heading, save, table, verdict

import elastomdr as em
from elastomdr.mapping.synthesis import synthesise

warnings.simplefilter("ignore", em.ConvergenceWarning)  # NaN shows in the table
LONGEST, RATIO, PERIODS, POINTS, MAPS, LINES = 1e-2, 16, 2, 256, 2, 8
SURFACE = em.SelfAffine(0.8, rms_slope=0.3, q_low=2 * np.pi / LONGEST, q_high=2 * np.pi / LONGEST * RATIO)
SOFT = 1e6  # E*_inf [Pa]
RUBBER = em.Foundation(SOFT, np.full(10, 1e6), np.geomspace(1e-7, 1e-2, 10))
VELOCITY = np.array([1e-2, 1e-1, 1.0, 10.0, 100.0, 1000.0])  # [m/s]
SHARES = np.array([0.01, 0.1, 1.0])  # p/(E*_inf rms slope)
LIGHT = 0.03  # of these, up to which the book's rule is advised
RULES = {"book": None, "full contact": "full contact"}


def three_dimensions(material: em.Foundation, pressure: float, velocity: np.ndarray) -> list:
    """One curve for each map."""
    maps = [em.reference.rough_map(SURFACE, seed, periods=PERIODS, points=POINTS) for seed in range(MAPS)]
    return [
        em.reference.half_space_sliding(material, height, cell=side, velocity=velocity, load=pressure * side**2)
        for height, side in maps
    ]


def on_lines(pressure: float, **how: object) -> em.FrictionCurve:
    return em.friction(
        RUBBER, SURFACE, velocity=VELOCITY, pressure=pressure, seeds=LINES, samples=4096, rtol=1e-3, sampling=1.0, **how
    )


def approach(pressure: np.ndarray, length: float) -> np.ndarray:
    """Distance [m] between the mean plane of the lines and the undeformed rubber, relaxed."""
    lines = [synthesise(SURFACE, seed, samples=4096) for seed in range(LINES)]
    elastic = em.Foundation(SOFT, [], [])
    found = [em.friction(elastic, line, velocity=1.0, load=pressure * length, average=None).depth for line in lines]
    return np.mean([float(line.height.max()) - depth for line, depth in zip(lines, found, strict=True)], axis=0)


def main() -> None:
    record = heading("Rough surfaces in three dimensions and by the MDR", str(SURFACE), f"{MAPS} maps, {LINES} lines")
    figure, axes = plt.subplots(2, 2, figsize=(10, 7.6), layout="constrained")
    rows = []
    for ax, share in zip(axes.flat, SHARES, strict=False):
        pressure = share * SOFT * SURFACE.rms_slope
        truth = three_dimensions(RUBBER, pressure, VELOCITY)
        mu, area = (np.mean([getattr(c, name) for c in truth], axis=0) for name in ("mu", "area"))
        grid = np.max([c.error / c.mu for c in truth], axis=0)
        ax.loglog(VELOCITY, mu, "ko-", label="three dimensions", markersize=4)
        curves = {name: on_lines(pressure, equivalent_length=rule) for name, rule in RULES.items()}
        curves["bare line, book"] = on_lines(pressure, average=None)
        for (name, curve), style in zip(curves.items(), ("C0-", "C1-", "C0:"), strict=True):
            ax.loglog(VELOCITY, curve.mu, style, label=f"line, {name}" if "bare" not in name else name)
        for i, v in enumerate(VELOCITY):
            ratios = [float(curve.mu[i] / mu[i]) for curve in curves.values()]
            rows.append((float(share), v, float(mu[i]), float(grid[i]), float(area[i]), *ratios))
        ax.set(xlabel="Velocity [m/s]", ylabel="Friction coefficient [-]")
        ax.set_title(f"p = {share:g} E*(0) rms slope: {area[0]:.0%} in contact at rest", fontsize=10, loc="left")
        ax.grid(color="#dddddd", linewidth=0.6)
    columns = (
        "p/(E* slope)", "velocity [m/s]", "mu in 3D", "error of the grid", "contact area",
        *(f"{name} over 3D" for name in curves),
    )  # fmt: skip
    record["friction"] = table(columns, rows)
    light = [row[5] for row in rows if row[0] <= LIGHT]
    heavy = [row[6] for row in rows if row[0] > LIGHT]
    record["verdicts"] = [
        verdict("light contact, book's rule: lowest mu over 3D", min(light), 0.55, least=True),
        verdict("light contact, book's rule: highest mu over 3D", max(light), 1),
        verdict("higher loads, rule of full contact: lowest mu over 3D", min(heavy), 0.55, least=True),
        verdict("higher loads, rule of full contact: highest mu over 3D", max(heavy), 1),
    ]
    axes[0, 0].legend(frameon=False, fontsize=8.5)
    pressure = np.geomspace(0.003, 1, 9) * SOFT * SURFACE.rms_slope
    elastic = em.Foundation(SOFT, [], [])
    gaps = np.mean(
        [[float(three.separation) for three in three_dimensions(elastic, p, np.array(1.0))] for p in pressure], 1
    )
    whole = gaps - pressure * LONGEST / SOFT
    lengths = {"book": LONGEST, "full contact": SURFACE.full_contact_length}
    # The patch is one longest wave wide by either rule; what a shorter line lacks in compression is added.
    lines = {
        name: approach(pressure, length) - pressure * (LONGEST - length) / SOFT for name, length in lengths.items()
    }
    high = SURFACE.rms_height
    record["approach"] = table(
        (
            "p/(E* slope)",
            "gap in 3D/rms height",
            "approach in 3D/rms height",
            *(f"{name}/rms height" for name in lines),
        ),
        [
            (
                float(p / (SOFT * SURFACE.rms_slope)),
                gaps[i] / high,
                whole[i] / high,
                *(z[i] / high for z in lines.values()),
            )
            for i, p in enumerate(pressure)
        ],
    )
    ax = axes[1, 1]
    ax.semilogy(gaps / high, pressure / SOFT, "ko-", markersize=4)
    for z, style in zip(lines.values(), ("C0-", "C1-"), strict=True):
        ax.semilogy((z + pressure * LONGEST / SOFT) / high, pressure / SOFT, style)
    ax.set(xlabel="Mean gap over rms height [-]", ylabel="Pressure over E*(0) [-]")
    ax.set_title("Pressure against mean gap, relaxed rubber", fontsize=10, loc="left")
    ax.grid(color="#dddddd", linewidth=0.6)
    save("rough_map", record, figure)


if __name__ == "__main__":
    main()
