"""Problem 9: a rubber wheel drives: traction against creepage, slow and fast, and what
the slip costs.

Teaches: `em.traction` at many velocities and creeps; a stiffer (faster) contact is
smaller and needs less creepage to pull.

Inputs: chosen here: standard solid, G = 1 MPa relaxed, 8 MPa glassy, tau = 1 s; wheel
(paraboloid) of 20 mm radius under 20 N, friction coefficient 0.7.

Check: both ends are elastic, and brushes: F_x/(mu F) = 1 - (1 - zeta)^3, zeta = xi R/(3
a mu) for an incompressible rubber, all slips from zeta = 1 on, and a^3 = 3 F R/(4 E*).
Slow, E* is the relaxed one: the contact moves by (E_0/E_inf) v tau/a of its length,
which changes by the square of it. Fast, the glassy one, to (E_0/E_inf) a/(v tau), of
which it shrinks. Asked: these.

    python examples/problems/09_driven_wheel.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RELAXED, GLASSY, TAU = 1e6, 8e6, 1.0  # G [Pa], [Pa], s
RADIUS, LOAD, FRICTION = 20e-3, 20.0, 0.7  # m, N, -
RUBBER = em.StandardSolid(RELAXED, GLASSY - RELAXED, TAU)


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    creepage = np.linspace(0.0, 0.4, 41)
    velocity = np.geomspace(1e-6, 10, 15)
    wheel = em.traction(
        RUBBER,
        em.Paraboloid(RADIUS),
        velocity=velocity[:, None],
        creepage=creepage,
        friction=FRICTION,
        load=LOAD,
    )
    radius = np.cbrt(0.75 * LOAD * RADIUS / (4 * np.array([[RELAXED], [GLASSY]])))
    brush = FRICTION * (
        1 - (1 - np.minimum(creepage * RADIUS / (3 * radius * FRICTION), 1)) ** 3
    )

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    for i, colour in ((0, "#7fa7cc"), (7, "#3a7fb5"), (14, "#0b2540")):
        left.plot(
            creepage, wheel.coefficient[i], color=colour, label=f"{velocity[i]:.2g} m/s"
        )
    for line, name in zip(brush, ("relaxed", "glassy"), strict=True):
        mark = "o" if name == "relaxed" else "s"
        left.plot(
            creepage[::2],
            line[::2],
            mark,
            color="#a03030",
            fillstyle="none",
            label=f"brush, {name}",
        )
    left.set(xlabel="Creep [-]", ylabel="Traction over load [-]", title="Traction")
    right.semilogx(
        velocity,
        wheel.rolling[:, 0],
        "o-",
        color="#1f5a94",
        label="rolling loss of the rubber",
    )
    slip = wheel.slip_power / (LOAD * velocity[:, None])
    right.semilogx(
        velocity,
        slip[:, 4],
        "s-",
        color="#c08a3e",
        label=f"slip, creepage {creepage[4]:.2g}",
    )
    right.set(
        xlabel="Rolling velocity [m/s]",
        ylabel="Power over load times velocity [-]",
        title="What it costs",
        ylim=(0, 0.1),
    )
    for ax in (left, right):
        ax.legend(frameon=False)
        ax.grid(color="#dddddd")
    figure.savefig(out / "09_driven_wheel.png", dpi=150)
    plt.close(figure)

    slow, fast = (
        np.abs(wheel.coefficient[i] - brush[j]).max() / FRICTION
        for i, j in ((0, 0), (-1, 1))
    )
    contrast = GLASSY / RELAXED
    part = (
        (contrast * velocity[0] * TAU / radius[0, 0]) ** 2,
        contrast * radius[1, 0] / (velocity[-1] * TAU),
    )
    print(
        f"check  brush: slow off by {slow:.1e}, asked {part[0]:.1e}; fast off by "
        f"{fast:.1e}, asked {part[1]:.1e}"
    )
    assert slow < part[0], "slow rolling must be the brush of the relaxed rubber"
    assert fast < part[1], "fast rolling must be the brush of the glassy rubber"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
