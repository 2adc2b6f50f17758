"""Does friction come back from data with vertical shifts, at every temperature?

    python benchmarks/fit_vertical.py [--seeds 3]

A rubber of ten relaxation times with a WLF law is measured from -40 to 60 degC (0.1 to
100 Hz, noise 0.5 %). Its moduli follow entropy elasticity exactly, none at all, or a
table (a step of 15 % between 0 and 20 degC). `em.fit.material` chooses the law of
vertical shifts by itself. The friction of a ball under a load, at velocities that
strain the rubber within the measured frequencies at all temperatures, is compared with
that of the rubber itself; beside it stands the material without vertical shifts
(`--no-vertical`), which is what a law of times alone can do.
"""

import argparse

import numpy as np
from common import heading, one_thread, save, table, verdict

import elastomdr as em

CELSIUS, HERTZ, REFERENCE = (
    np.arange(-40.0, 61.0, 10.0),
    np.geomspace(0.1, 100.0, 13),
    293.15,
)
BALL, VELOCITY, LOAD = em.Paraboloid(5e-3), np.geomspace(2e-3, 0.05, 6), 1.0
LAWS = {
    "entropy elasticity": em.EntropicVertical(REFERENCE),
    "none": None,
    "table": em.VerticalTable([133.15, 273.15, 293.15, 433.15], [0.87, 0.87, 1.0, 1.0]),
}


def rubber(vertical) -> em.Prony:
    return em.Prony(
        6e5,
        np.geomspace(6e7, 2e5, 10),
        np.geomspace(1e-9, 1.0, 10),
        shift=em.WLF(5.8, 125.0, REFERENCE),
        vertical=vertical,
    )


def measured(material: em.Prony, seed: int):
    rng, omega, parts = np.random.default_rng(seed), 2 * np.pi * HERTZ, []
    for kelvin in CELSIUS + 273.15:
        moduli = np.asarray(material.at(kelvin).complex_modulus(omega))
        noise = 1 + 0.005 * rng.normal(size=(2, omega.size))
        parts.append(
            em.fit.dma(
                omega,
                moduli.real * noise[0],
                moduli.imag * noise[1],
                kelvin,
                kind="shear",
            )
        )
    return em.fit.join(*parts)


def friction(material: em.Prony) -> np.ndarray:
    kelvin = CELSIUS[:, None] + 273.15
    return np.asarray(
        em.friction(
            material, BALL, velocity=VELOCITY, load=LOAD, temperature=kelvin, rtol=1e-4
        ).mu
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=3)
    seeds = parser.parse_args().seeds
    one_thread()
    record = heading(
        "Friction from data with vertical shifts",
        f"{seeds} sets of noise each, -40 to 60 degC",
    )
    rows = []
    for name, law in LAWS.items():
        truth = friction(rubber(law))
        off, chosen, plain = [], [], []
        for seed in range(seeds):
            dma = measured(rubber(law), seed)
            found = em.fit.material(dma, REFERENCE).material
            chosen.append(type(found.vertical).__name__)
            off.append(100 * (friction(found) / truth - 1))
            if seed == 0:
                plain = 100 * (
                    friction(em.fit.material(dma, REFERENCE, vertical=False).material)
                    / truth
                    - 1
                )
        rows.append(
            (
                name,
                ", ".join(sorted(set(chosen))),
                np.min(off),
                np.max(off),
                np.min(plain),
                np.max(plain),
            )
        )
    columns = (
        "truth",
        "law chosen",
        "lowest error of mu [%]",
        "highest [%]",
        "without vertical shifts, lowest [%]",
        "highest [%]",
    )
    record["friction"] = table(columns, rows)
    record["verdicts"] = [
        verdict(
            f"{row[0]}: largest error of friction",
            max(abs(row[2]), abs(row[3])),
            3.0,
            " %",
        )
        for row in rows
    ]
    save("fit_vertical", record)


if __name__ == "__main__":
    main()
