"""Problem 2: a cone is pressed into rubber, and dragged: friction that cannot exceed
the slope.

Teaches: `em.indent` under a load, `em.friction` on the bare line (`model=em.Line()`),
where many answers are in closed form.

Inputs: chosen here: cone of slope 0.1 under 1 N; Kelvin-Voigt, G = 1 MPa, tau = eta/G =
10 ms.

Check: c = (pi/2) slope is the slope on the line. Pressed: the contact grows, so that
d^2 = c F J(t), J = (1 - e^(-t/tau))/E*. Dragged: mu/c = 2 z sqrt(1 - z^2/2) - z^2/2
with z = v tau sqrt(E* c/F) up to z = sqrt(2/3), and mu = c beyond, where only the flank
ahead is touched. Both are exact on the line: 1e-9 and 1e-6, the tolerance that
em.friction is asked for.

    python examples/problems/02_cone.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

SLOPE, LOAD = 0.1, 1.0  # -, N
G, TAU = 1e6, 10e-3  # Pa, s
RUBBER = em.KelvinVoigt(G, G * TAU)
CONE = em.Cone(SLOPE)
C = 0.5 * np.pi * SLOPE


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    time = np.linspace(0.0, 5 * TAU, 41)
    pressed = em.indent(RUBBER, CONE, time=time, load=LOAD)
    depth = np.sqrt(C * LOAD * -np.expm1(-time / TAU) / (4 * G))

    z = np.linspace(0.02, 1.4, 70)
    velocity = z / (TAU * np.sqrt(4 * G * C / LOAD))
    line = em.friction(RUBBER, CONE, velocity=velocity, load=LOAD, model=em.Line())
    # the kink at mu = c costs digits
    half_space = em.friction(RUBBER, CONE, velocity=velocity, load=LOAD, rtol=1e-3)
    free = np.sqrt(2 / 3)
    mu = C * np.where(
        z < free, 2 * z * np.sqrt(1 - np.minimum(z, free) ** 2 / 2) - z**2 / 2, 1.0
    )

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    left.plot(1e3 * time, 1e3 * pressed.depth, color="#1f5a94", label="em.indent")
    left.plot(
        1e3 * time,
        1e3 * depth,
        "o",
        color="#a03030",
        fillstyle="none",
        label="closed form",
    )
    left.set(xlabel="Time under load [ms]", ylabel="Depth [mm]", title="Pressed")
    right.plot(z, line.mu / C, color="#1f5a94", label="em.friction, bare line")
    right.plot(
        z[::4],
        mu[::4] / C,
        "o",
        color="#a03030",
        fillstyle="none",
        label="closed form, bare line",
    )
    right.plot(
        z,
        half_space.mu / C,
        "--",
        color="#888888",
        label="direction average (half-space, estimate)",
    )
    right.set(
        xlabel=r"$v\tau\sqrt{E^* c/F}$ [-]", ylabel=r"$\mu/c$ [-]", title="Dragged"
    )
    for ax in (left, right):
        ax.legend(frameon=False)
        ax.grid(color="#dddddd")
    figure.savefig(out / "02_cone.png", dpi=150)
    plt.close(figure)

    off = (
        np.abs(pressed.depth[1:] / depth[1:] - 1).max(),
        np.abs(line.mu / mu - 1).max(),
    )
    print(f"check  depth off by {off[0]:.1e}, friction by {off[1]:.1e}")
    assert off[0] < 1e-9, "creep must meet the closed form"
    assert off[1] < 1e-6, "friction must meet the closed form"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
