"""What a road costs and how its models agree: `python benchmarks/roads.py`.

Price of `em.Multiscale` a point over 1.4 to 5 decades of wave number, of the
three-dimensional solver on 256 by 256 and 512 by 512 cells, and of `em.Persson`;
Multiscale beside Persson's theory on a spectrum of 4.8 decades with tabulated moduli of
a tread compound, at 0.3 MPa.
"""

from functools import partial

import numpy as np
from common import heading, one_core, save, table, timed, verdict

import elastomdr as em
from elastomdr.rough import half_space

TREAD = em.load_material("tread-passenger-synthetic")
LONGEST, ROLLOFF, SHORTEST = 0.1, 6e-3, 1.6e-6  # wavelengths of an asphalt [m]
ASPHALT = em.SelfAffine(
    0.8,
    rms_slope=1.3,
    q_low=2 * np.pi / LONGEST,
    q_high=2 * np.pi / SHORTEST,
    q_rolloff=2 * np.pi / ROLLOFF,
)
VELOCITY = np.geomspace(1e-6, 10, 29)


def tabulated() -> em.TabulatedModulus:
    omega = np.geomspace(1e-4, 1e12, 129)
    value = TREAD.complex_modulus(omega)
    return em.TabulatedModulus(
        omega, value.real, value.imag, shift=TREAD.shift, name=TREAD.name
    )


def prices() -> list[tuple]:
    rows = []
    for decades in (1.4, 3, 4.8, 5):
        road = em.SelfAffine(0.8, rms_slope=1.0, q_low=6e1, q_high=6e1 * 10**decades)
        given = {
            "velocity": np.geomspace(1e-4, 10, 64),
            "pressure": 3e5,
            "temperature": 293.15,
        }
        for model in (em.Multiscale(), em.Persson()):
            em.friction(TREAD, road, **given, model=model)
            many = (
                timed(
                    lambda m=model, r=road, g=given: em.friction(
                        TREAD, r, **g, model=m
                    ),
                    3,
                ).cpu
                / 64
            )
            alone = given | {"velocity": 0.1}
            one = timed(
                lambda m=model, r=road, g=alone: em.friction(TREAD, r, **g, model=m), 5
            ).cpu
            rows.append((type(model).__name__, decades, 1e3 * many, 1e3 * one))
    return rows


def cells() -> list[tuple]:
    """Processor seconds a velocity, on the contact of the velocity before; and
    alone.
    """
    rows = []
    for contrast in (11, 300):
        rubber = em.Foundation(
            1e6, np.full(10, (contrast - 1) * 1e5), np.geomspace(1e-6, 1e-1, 10)
        )
        for count, periods in ((256, 1), (512, 2)):
            surface = em.SelfAffine(
                0.8, rms_slope=0.3, q_low=1e3, q_high=1e3 * count / periods / 4
            )
            heights, side = em.reference.rough_map(
                surface, 0, periods=periods, points=count
            )
            for share in (0.02, 0.3):
                start, times, alone = None, [], 0.0
                for velocity in (0.03, 0.05, 0.1):
                    given = {
                        "velocity": velocity,
                        "pressure": share * 3e5,
                        "start": start,
                    }
                    run = timed(
                        partial(
                            half_space.solve,
                            rubber.complex_modulus,
                            heights,
                            (side, side),
                            **given,
                        )
                    )
                    assert run.value.settled
                    alone = run.cpu if start is None else alone
                    if start is not None:
                        times.append(run.cpu)
                    start = run.value.pressure
                rows.append(
                    (
                        contrast,
                        count,
                        share,
                        alone,
                        float(np.mean(times)),
                        run.value.area,
                    )
                )
    return rows


def main() -> None:
    one_core()
    record = heading("Roads: price and agreement of the models", "one core")
    closed = prices()
    record["closed"] = table(
        ("model", "decades", "a point of 64 [ms]", "a point alone [ms]"), closed
    )
    solved = cells()
    columns = (
        "contrast",
        "cells",
        "p/(E* slope)",
        "first [s]",
        "a velocity more [s]",
        "real contact",
    )
    record["cells"] = table(columns, solved)
    given = {"velocity": VELOCITY, "pressure": 3e5, "temperature": 293.15}
    rubber = tabulated()
    multiscale, persson = (
        em.friction(rubber, ASPHALT, **given, model=m, rtol=1e-4)
        for m in ("multiscale", "persson")
    )
    ratio = multiscale.mu / persson.mu
    rows = list(
        zip(
            VELOCITY,
            multiscale.area_ratio,
            multiscale.mu,
            persson.mu,
            ratio,
            strict=True,
        )
    )
    record["4.8 decades"] = table(
        ("velocity [m/s]", "real contact", "Multiscale", "Persson", "ratio"), rows[::4]
    )
    heavy = multiscale.area_ratio > 0.05
    soft = em.friction(
        rubber, ASPHALT, **given | {"pressure": 3e6}, model="multiscale", rtol=1e-4
    )
    other = em.friction(
        rubber, ASPHALT, **given | {"pressure": 3e6}, model="persson", rtol=1e-4
    )
    above = soft.area_ratio > 0.05
    off = np.concatenate(
        [np.abs(np.log(ratio[heavy])), np.abs(np.log((soft.mu / other.mu)[above]))]
    )
    point = max(row[2] for row in closed if row[0] == "Multiscale")
    small = min(row[3] for row in solved if row[1] == 256)
    record["verdicts"] = [
        verdict(
            "Multiscale, a point over any number of decades",
            max(max(r[2:]) for r in closed),
            20,
            " ms",
        ),
        verdict(
            "3D at 256 by 256 over Multiscale, a point",
            1e3 * small / point,
            1000,
            least=True,
        ),
        *(
            verdict(
                f"3D at 512 by 512, contrast {contrast}, a velocity",
                max(r[4] for r in solved if r[0] == contrast and r[1] == 512),
                limit,
                " s",
            )
            for contrast, limit in ((11, 1), (300, 3))
        ),
        verdict(
            "4.8 decades, contact above 5 %: Multiscale from Persson",
            float(np.expm1(off.max())),
            0.15,
        ),
    ]
    save("roads", record)


if __name__ == "__main__":
    main()
