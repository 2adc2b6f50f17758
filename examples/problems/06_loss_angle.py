"""Problem 6: a ball on rubber is shaken up and down: dynamic stiffness and loss angle,
as an instrument sees them.

Teaches: `em.indent` takes many histories in one call, one per frequency or amplitude,
on an axis of their own.

Inputs: chosen here: three branches, E* = 2 MPa relaxed and 2 MPa each at 0.1, 1 and 10
s; ball of 5 mm radius at a mean depth of 50 um, shaken by 0.1 um from 0.01 to 100
rad/s, and by up to 3.2 um at 10 rad/s.

Check: a small shake meets a contact of constant radius a: K = 2 a E*(omega), and its
phase is the loss angle. At the edge the relaxed pressure is lower than what the stiff
motion takes away: a ring of width (E_0/E_inf) A/d comes off, and the stiffness falls by
a part of that. Asked is that number, plus (pi/24)^2/3 for a sine drawn with 24 lines;
and a fall in proportion to A.

    python examples/problems/06_loss_angle.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RADIUS, DEPTH, LINES = 5e-3, 50e-6, 24  # m, m, lines per cycle
RUBBER = em.Foundation(2e6, [2e6, 2e6, 2e6], [0.1, 1.0, 10.0])
RING = float(RUBBER.relaxation(0.0) / RUBBER.equilibrium) / DEPTH  # E_0/(E_inf d) [1/m]


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    omega = np.array([0.01, 0.1, 1.0, 100.0, 10.0, 10.0, 10.0, 10.0])[:, None]
    shake = np.array([0.1, 0.1, 0.1, 0.1, 0.1, 0.8, 1.6, 3.2])[:, None] * 1e-6
    # two cycles, after 100 s of rest
    angle = np.append(0.0, 2 * np.pi * np.arange(2 * LINES + 1) / LINES)
    time = np.where(np.arange(angle.size) == 0, -100.0, angle / omega)
    depth = DEPTH + shake * np.sin(angle)
    ball = em.indent(RUBBER, em.Paraboloid(RADIUS), time=time, depth=depth)
    harmonic = np.exp(-1j * angle[-LINES:])
    stiffness = (ball.force[:, -LINES:] @ harmonic) / (depth[:, -LINES:] @ harmonic)
    exact = 2 * np.sqrt(RADIUS * DEPTH) * RUBBER.complex_modulus(omega[:, 0])
    off = np.abs(stiffness / exact - 1)
    # against the smallest amplitude, whose sine is drawn as well
    fall = 1 - np.abs(stiffness[5:] / stiffness[4])

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    smooth = np.geomspace(0.01, 100, 80)
    limit = 2 * np.sqrt(RADIUS * DEPTH) * RUBBER.complex_modulus(smooth)
    left.semilogx(
        smooth, 1e-3 * np.abs(limit), color="#1f5a94", label=r"$2a|E^*(\omega)|$ [kN/m]"
    )
    left.semilogx(
        omega[:5, 0],
        1e-3 * np.abs(stiffness[:5]),
        "o",
        color="#1f5a94",
        label="stiffness, em.indent [kN/m]",
    )
    left.semilogx(
        smooth,
        10 * np.angle(limit),
        color="#a03030",
        label="10 x loss angle of the rubber [rad]",
    )
    left.semilogx(
        omega[:5, 0],
        10 * np.angle(stiffness[:5]),
        "s",
        color="#a03030",
        label="10 x phase, em.indent [rad]",
    )
    left.set(
        xlabel="Frequency [rad/s]",
        ylabel="Stiffness, 10 x angle",
        ylim=(0, 13),
        title="Shaken by 0.1 µm",
    )
    right.loglog(
        1e6 * shake[5:, 0],
        fall,
        "o-",
        color="#1f5a94",
        label="fall of stiffness, em.indent",
    )
    right.loglog(
        1e6 * shake[5:, 0],
        RING * shake[5:, 0],
        "--",
        color="#a03030",
        label=r"$(E_0/E_\infty)\,A/d$",
    )
    right.set(
        xlabel="Amplitude [µm]",
        ylabel="Relative difference [-]",
        title="Shaken at 10 rad/s",
    )
    for ax in (left, right):
        ax.legend(frameon=False, fontsize=9)
        ax.grid(color="#dddddd")
    figure.savefig(out / "06_loss_angle.png", dpi=150)
    plt.close(figure)

    power = np.polyfit(np.log(shake[5:, 0]), np.log(fall), 1)[0]
    print(
        f"check  off the limit by at most {off[:5].max():.1e} at 0.1 um, and as "
        f"amplitude to the power {power:.2f}"
    )
    assert (off < RING * shake[:, 0] + (np.pi / LINES) ** 2 / 3).all(), (
        "a small shake must show the rubber's modulus"
    )
    assert abs(power - 1) < 0.15, "the ring that comes off is as wide as the amplitude"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
