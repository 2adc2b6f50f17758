"""29: how stiff a rough contact is and how well it conducts heat, under load, in time,
and while it slides.

Teaches: `em.press` presses a rough surface into rubber. Contact spots conduct in
proportion to how stiff they are (Barber 2003), and both grow as the rubber creeps; in
sliding the rubber is stiff again, and both fall.

Inputs: the synthetic passenger tread at 20 degC, illustrative; a self-affine surface, H
= 0.8, rms slope 0.3, wavelengths of 2 mm to 50 um; nominal pressures of 0.01 to 1 MPa;
0.2 W/(m K) for the rubber, 1 for the counterface.

Check: creep under 0.1 MPa gives the conductance that the relaxed contact has under p
J(t) E*(0), and slow sliding that of rest; the conductance lies above Barber's bound,
2p/(E* s), s the height of the highest peak.

    python examples/29_pressed_rough_surface.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

TREAD = em.load_material("tread-passenger-synthetic").at(293.15)
SURFACE = em.SelfAffine(
    0.8, rms_slope=0.3, q_low=2 * np.pi / 2e-3, q_high=2 * np.pi / 50e-6
)
# Pa, Pa, W/(m K)
PRESSURE, USUAL, CONDUCTIVITY = np.geomspace(1e4, 1e6, 25), 1e5, (0.2, 1.0)
TIMES = {"1 ms": 1e-3, "1 s": 1.0, "1 min": 60.0}
TIME, VELOCITY = np.geomspace(1e-4, 1e2, 31), np.geomspace(1e-7, 1.0, 8)  # s, m/s


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(8.6, 3.4), sharey=True)
    for (name, time), colour in zip(
        TIMES.items(), ("#7fb0dd", "#3c7fbf", "#123c66"), strict=True
    ):
        found = em.press(
            TREAD, SURFACE, pressure=PRESSURE, time=time, conductivity=CONDUCTIVITY
        )
        left.loglog(
            PRESSURE / 1e6, found.thermal, color=colour, label=f"{name} under load"
        )
        known = np.isfinite(found.model_error)
        spread = found.thermal * (found.error + found.model_error)
        left.fill_between(
            PRESSURE[known] / 1e6,
            (found.thermal - spread)[known],
            (found.thermal + spread)[known],
            color=colour,
            alpha=0.15,
            linewidth=0,
        )
    creep = em.press(
        TREAD, SURFACE, pressure=USUAL, time=TIME, conductivity=CONDUCTIVITY
    )
    slide = em.press(
        TREAD, SURFACE, pressure=USUAL, velocity=VELOCITY, conductivity=CONDUCTIVITY
    )
    middle.loglog(TIME, creep.thermal, color="#1f5a94")
    right.loglog(VELOCITY, slide.thermal, color="#a03030", marker="o", markersize=3)
    left.set(
        xlabel="Nominal pressure [MPa]",
        ylabel="Thermal conductance [W/(m² K)]",
        title="At rest",
    )
    middle.set(xlabel="Time under 0.1 MPa [s]", title="Creep")
    right.set(xlabel="Velocity under 0.1 MPa [m/s]", title="Sliding")
    left.legend()
    figure.savefig(out / "29_pressed_rough_surface.png")
    plt.close(figure)
    print(creep.summary())
    check(creep, slide)


def check(creep: em.RoughContact, slide: em.RoughContact) -> None:
    relaxed = float(em.half_space(TREAD).equilibrium)
    factor = np.asarray(em.half_space(TREAD).creep_compliance(TIME)) * relaxed
    same = em.press(TREAD, SURFACE, pressure=USUAL * factor)
    assert np.allclose(creep.conductance, same.conductance, rtol=1e-10), (
        "creep is the relaxed contact under more load"
    )
    rest = float(em.press(TREAD, SURFACE, pressure=USUAL).conductance)
    ratio = slide.conductance[0] / rest
    print(
        f"slow sliding over rest: {ratio:.4f}; fast over slow: "
        f"{slide.conductance[-1] / slide.conductance[0]:.3f}"
    )
    assert slide.converged.all()
    assert (np.diff(creep.conductance) > 0).all(), (
        "creep brings more spots into contact"
    )
    assert ratio < 1.01, "in sliding the rubber is no softer than at rest"
    assert slide.conductance[-1] < 0.8 * slide.conductance[0], (
        "fast sliding meets stiff rubber"
    )
    assert (creep.conductance > creep.conductance_low).all(), "Barber's bound"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
