"""Problem 4: fretting loss against amplitude: the rubber's own damping at small, slip
at large amplitudes.

Teaches: `em.shear` counts the work of a cycle and how much of it slip turns into heat;
the rest is the rubber's.

Inputs: chosen here: standard solid with G = 0.5 MPa relaxed, 0.7 MPa glassy, tau = 20
ms; ball of 10 mm radius at a depth of 0.1 mm, so that a = 1 mm; friction coefficient
0.8; ten shakes a second, after 0.2 s of rest.

Check: A small: all but a thin ring sticks, W = 2 pi a Im G*(omega) A^2, short of slip
by a part of the order of A/U. A large: slips, W = 4 mu F A less a part of the order of
U/A, with U = mu E* d/G* where all begins to slip. Asked is A/U at the two smallest, U/A
at the two largest amplitudes, at which the ball does not leave its dent (that would be
rolling or sliding friction, which em.shear leaves out).

    python examples/problems/04_fretting.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RADIUS, DEPTH, FRICTION, OMEGA = 10e-3, 1e-4, 0.8, 20 * np.pi  # m, m, -, rad/s
BALL = em.Paraboloid(RADIUS)
RUBBER = em.StandardSolid(0.5e6, 0.2e6, 20e-3)
SHEARED = em.half_space(RUBBER, tangential=True)
RADIUS_OF_CONTACT = np.sqrt(RADIUS * DEPTH)
# U [m]
FULL = FRICTION * em.half_space(RUBBER).equilibrium * DEPTH / SHEARED.equilibrium


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    time = np.append(0.0, 0.2 + np.linspace(0, 0.2, 61))  # two cycles of 30 instants
    amplitude = FULL * np.geomspace(0.01, 8, 8)
    work, slip, force = [], [], 0.0
    for a in amplitude:
        motion = np.append(0.0, a * np.sin(OMEGA * (time[1:] - 0.2)))
        found = em.shear(
            RUBBER,
            BALL,
            time=time,
            displacement=motion,
            friction=FRICTION,
            depth=DEPTH,
            elements=500,
            steps=4,
        )
        work.append(found.work[-1] - found.work[-31])
        slip.append(found.slip_loss[-1] - found.slip_loss[-31])
        force = found.normal_force[-1]
    stuck = 2 * np.pi * RADIUS_OF_CONTACT * SHEARED.loss(OMEGA) * amplitude**2
    sliding = 4 * FRICTION * force * amplitude

    figure, ax = plt.subplots(figsize=(7.2, 4.6), layout="constrained")
    ax.loglog(
        amplitude / FULL, work, "o-", color="#1f5a94", label="work of a cycle, em.shear"
    )
    ax.loglog(
        amplitude / FULL,
        slip,
        "s:",
        color="#1f5a94",
        fillstyle="none",
        label="of it turned into heat by slip",
    )
    ax.loglog(
        amplitude / FULL, stuck, "--", color="#a03030", label=r"stuck: $2\pi a G''A^2$"
    )
    ax.loglog(
        amplitude / FULL, sliding, "-.", color="#c08a3e", label=r"sliding: $4\mu F A$"
    )
    ax.set(
        xlabel="Amplitude over that at which all slips, A/U [-]",
        ylabel="Energy per cycle [J]",
        ylim=(1e-9, 1e-1),
    )
    ax.set_title("Fretting of a ball on rubber, 10 Hz, depth 0.1 mm", fontsize=10)
    ax.legend(frameon=False)
    ax.grid(color="#dddddd")
    figure.savefig(out / "04_fretting.png", dpi=150)
    plt.close(figure)

    part = amplitude / FULL
    low, high = (np.abs(np.array(work) / limit - 1) for limit in (stuck, sliding))
    print(
        f"check  stuck: off by {low[0] / part[0]:.2f} A/U, sliding: off by "
        f"{high[-1] * part[-1]:.2f} U/A"
    )
    assert (low < part)[:2].all(), "small amplitudes must meet the rubber's damping"
    assert (high < 1 / part)[-2:].all(), "large amplitudes must meet Coulomb's friction"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
