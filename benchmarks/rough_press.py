"""Mean gap and stiffness of a rough contact by the line of `em.press`, against three
dimensions, at three loads.

    python benchmarks/rough_press.py

In three dimensions: random maps on the cells of `em.HalfSpace`, four per shortest wave,
their mean gap, and their stiffness from the gaps at pressures 5 % below and above.
Surfaces of several exponents, cutoff ratios and roll-offs at rest, where creep is the
elastic contact with 1/J(t), and one in steady sliding at three velocities. `book` is
the line with L = 2 pi/q_low. Each map is also held against the bounds of its own
highest peak and full contact.
"""

import numpy as np
from common import heading, one_thread, save, table

import elastomdr as em
from elastomdr.rough.half_space import solve
from elastomdr.rough.press import least_conductance
from elastomdr.surface.spectrum import rough_map

MODULUS, LOW, SLOPE = 1e6, 1e3, 0.3  # E* [Pa], q_low [rad/m], rms slope
LEVELS = np.array([0.01, 0.05, 0.2])  # p/(E* rms slope)
SURFACES = {  # exponent, cutoff ratio, roll-off over q_low, periods of the map
    "H 0.8, ratio 4": (0.8, 4, 1, 8),
    "H 0.8, ratio 8": (0.8, 8, 1, 6),
    "H 0.8, ratio 16": (0.8, 16, 1, 4),
    "H 0.8, ratio 32": (0.8, 32, 1, 2),
    "H 0.8, ratio 64": (0.8, 64, 1, 2),
    "H 0.3, ratio 8": (0.3, 8, 1, 6),
    "H 0.3, ratio 32": (0.3, 32, 1, 2),
    "H 0.8, ratio 16, roll-off 4": (0.8, 16, 4, 4),
    "H 0.3, ratio 16, roll-off 4": (0.3, 16, 4, 4),
}
SEEDS, STEP = 4, 0.05
RUBBER = em.Foundation(MODULUS, [9e6], [1e-3])
SLIDING = np.array([0.01, 1.0, 100.0])  # v [m/s]; q_low v tau = 0.01 to 100


def surface(name: str) -> em.SelfAffine:
    hurst, ratio, knee, _ = SURFACES[name]
    return em.SelfAffine(
        hurst, SLOPE, LOW, LOW * ratio, LOW * knee if knee > 1 else None
    )


def in_three_dimensions(
    name: str, modulus, pressure: float, velocity: float = 1.0
) -> tuple[np.ndarray, ...]:
    """Gap [m], stiffness [Pa/m], contact area and the bounds of the stiffness of each
    map.
    """
    spectrum, (_, ratio, _, periods) = surface(name), SURFACES[name]
    rows = []
    for seed in range(SEEDS):
        heights, side = rough_map(
            spectrum, seed, periods=periods, points=4 * ratio * periods
        )
        found = [
            solve(
                modulus,
                heights,
                (side, side),
                velocity=velocity,
                pressure=pressure * (1 + s),
            )
            for s in (-STEP, 0.0, STEP)
        ]
        q = 2 * np.pi / side * np.fft.fftfreq(len(heights), 1 / len(heights))
        k = np.hypot(q[:, None], q[None])
        waves = np.fft.fft2(heights - heights.mean())
        # p that closes the deepest valley, over E*
        full = -np.fft.ifft2(0.5 * k * waves).real.min()
        energy = 0.25 * float((k * np.abs(waves / heights.size) ** 2).sum())
        low, high = bounds(
            pressure / MODULUS, heights.max() - heights.mean(), full, energy
        )
        stiffness = 2 * STEP * pressure / (found[0].separation - found[2].separation)
        rows.append(
            (
                found[1].separation,
                stiffness,
                found[1].area,
                0.5 * MODULUS * low,
                0.5 * MODULUS * high,
            )
        )
    return tuple(np.array(rows).T)


def bounds(load: float, peak: float, full: float, energy: float) -> tuple[float, float]:
    """Least and largest conductance over conductivity [1/m] of elastic surfaces under
    p/E* = `load`.

    `peak` is the height of the highest point over the mean [m], `full` the pressure and
    `energy` the energy per area [m] of full contact, both over E*. Pressure is convex
    in the approach: its slope is at most that of the chord to full contact,
    (full - p)/gap; and so is the complementary energy in the pressure, whose slope is
    the gap: gap >= (energy - peak p)/(full - p).
    """
    left, rest = energy - peak * load, full - load
    low = float(least_conductance(load, peak))
    return low, 2 * rest**2 / left if left > 0 and rest > 0 else np.inf


def elastic(omega: np.ndarray) -> np.ndarray:
    return np.full(np.shape(omega), MODULUS + 0j)


def filled(ratio: float) -> float | None:
    """None where the book's line is in full contact and has no stiffness of an
    interface.
    """
    return ratio if 0 < ratio < 1e3 else None


def row(
    name: str, spectrum, truth, line, book, level: float, velocity: float | None
) -> dict:
    gap, stiffness, area, low, high = truth
    rms = spectrum.rms_height
    return {
        "surface": name,
        "p/(E* slope)": level,
        "velocity": velocity,
        "area": area.mean(),
        "stiffness of maps": stiffness.mean(),
        "scatter of maps": stiffness.std(ddof=1) / stiffness.mean() / SEEDS**0.5,
        "line over maps": float(line.stiffness) / stiffness.mean(),
        "error of line": float(line.error),
        "book over maps": filled(float(book.stiffness) / stiffness.mean()),
        "gap of maps over rms": gap.mean() / rms,
        "gap of line less maps over rms": (float(line.separation) - gap.mean()) / rms,
        "within bounds": bool(((stiffness > low) & (stiffness < high)).all())
        if velocity is None
        else None,
        "lower bound over maps": float((low / stiffness).max())
        if velocity is None
        else None,
    }


def main() -> None:
    one_thread()
    inputs = heading(
        "Rough contact: line against maps",
        f"{SEEDS} maps, E* = {MODULUS:g} Pa, rms slope {SLOPE}",
    )
    rows = []
    solid = em.Foundation(MODULUS, [], [])
    for name in SURFACES:
        spectrum = surface(name)
        book = em.Line(seeds=8, periods=16, equivalent_length=2 * np.pi / LOW)
        for level in LEVELS:
            p = level * MODULUS * SLOPE
            truth = in_three_dimensions(name, elastic, p)
            by_book = em.press(solid, spectrum, pressure=p, model=book)
            rows.append(
                row(
                    name,
                    spectrum,
                    truth,
                    em.press(solid, spectrum, pressure=p),
                    by_book,
                    level,
                    None,
                )
            )
            print(name, level, f"{rows[-1]['line over maps']:.3f}", flush=True)
    name = "H 0.8, ratio 8"
    spectrum = surface(name)
    for velocity in SLIDING:
        for level in LEVELS:
            p = level * MODULUS * SLOPE
            truth = in_three_dimensions(name, RUBBER.complex_modulus, p, velocity)
            line = em.press(RUBBER, spectrum, pressure=p, velocity=velocity)
            by_book = em.press(
                RUBBER, spectrum, pressure=p, velocity=velocity, model=book
            )
            rows.append(
                row(name, spectrum, truth, line, by_book, level, float(velocity))
            )
    keys = [
        "surface",
        "velocity",
        "p/(E* slope)",
        "area",
        "line over maps",
        "book over maps",
        "gap of maps over rms",
        "gap of line less maps over rms",
        "lower bound over maps",
        "within bounds",
    ]
    table(
        keys,
        [
            [
                r[k]
                if isinstance(r[k], str)
                else str(r[k] if r[k] is None else round(r[k], 3))
                for k in keys
            ]
            for r in rows
        ],
    )
    rest = [r for r in rows if r["velocity"] is None]
    off = np.array([abs(np.log(r["line over maps"])) for r in rest])
    print(
        f"at rest: stiffness within a factor of {np.exp(off.max()):.2f}, rms "
        f"{off.std():.2f}"
    )
    save(
        "rough_press",
        inputs | {"rows": rows, "largest factor at rest": float(np.exp(off.max()))},
    )


if __name__ == "__main__":
    main()
