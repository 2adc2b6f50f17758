"""06: what the direction average corrects.

Teaches: the textbook line (`model=em.Line()`) overstates the sliding friction of a
half-space: by 2 at low velocity, where the loss modulus rises in proportion to
frequency, by 1 at high velocity, where it falls as its inverse. The average over
directions takes that out.

Inputs: a standard solid with E* = 4 MPa relaxed, 16 MPa glassy, tau = 1 ms; a
paraboloid of R = 10 mm under 10 N. The three points are a three-dimensional boundary
element solution of the same half-space, made for docs/accuracy.md, good to about 1.5 %.

Check: low velocity, on a half-space: mu = v E_1 tau/(E_inf R) (Brilliantov & Poeschel
1998). High velocity, line and half-space alike: mu = (4/5) (d/v) (E_1/tau)/E_0, with
Hertz's depth d for the glassy modulus (docs/theory.md). In between: the
three-dimensional points, to 3 %.

    python examples/06_direction_average.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RELAXED, BRANCH, TIME = 4e6, 12e6, 1e-3  # E_inf, E_1 [Pa], tau [s]
RADIUS, LOAD = 0.01, 10.0  # m, N
# velocity [m/s], mu of the half-space
POINTS = np.array([[0.1, 0.02643], [1.0, 0.07147], [10.0, 0.01475]])


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)

    rubber = em.Foundation(RELAXED, [BRANCH], [TIME])
    # m/s, eight a decade: those of the points are among them
    velocity = np.geomspace(1e-4, 1e4, 65)
    line = em.friction(
        rubber, em.Paraboloid(RADIUS), velocity=velocity, load=LOAD, model=em.Line()
    )
    average = em.friction(
        rubber,
        em.Paraboloid(RADIUS),
        velocity=velocity,
        load=LOAD,
        model=em.Averaged(corrected=False),
    )

    figure, (top, bottom) = plt.subplots(
        2, 1, figsize=(7.2, 6.0), sharex=True, height_ratios=(3, 2)
    )
    top.loglog(
        velocity, line.mu, "--", color="#a03030", label="MDR line (model=em.Line())"
    )
    top.loglog(velocity, average.mu, color="#1f5a94", label="averaged over directions")
    top.loglog(*POINTS.T, "ko", markersize=5, label="three-dimensional half-space")
    top.set(ylabel="Friction coefficient [-]")
    top.set_title(
        "Paraboloid of 10 mm radius, 10 N, standard solid: 4 MPa relaxed, 16 MPa "
        "glassy, 1 ms"
    )
    top.legend(loc="lower center")
    bottom.semilogx(velocity, line.mu / average.mu, color="#1f5a94")
    bottom.text(
        velocity[-1],
        2.03,
        "2: loss modulus proportional to frequency",
        ha="right",
        fontsize=9,
    )
    bottom.text(velocity[0], 1.03, "1: inversely proportional", fontsize=9)
    bottom.set(
        xlabel="Sliding velocity [m/s]",
        ylabel="Line over average [-]",
        ylim=(0.9, 2.2),
        yticks=(1.0, 1.25, 1.5, 1.75, 2.0),
    )
    figure.savefig(out / "06_direction_average.png")
    plt.close(figure)

    check(velocity, line.mu, average.mu)


def check(velocity: np.ndarray, line: np.ndarray, average: np.ndarray) -> None:
    slow, fast = velocity[0], velocity[-1]
    glassy = RELAXED + BRANCH
    depth = (9 * LOAD**2 / (16 * RADIUS * glassy**2)) ** (1 / 3)
    expected = np.array(
        [
            slow * BRANCH * TIME / (RELAXED * RADIUS),
            0.8 * depth * BRANCH / (fast * TIME * glassy),
        ]
    )
    print(
        f"low velocity   exact {expected[0]:.6e}, average {average[0]:.6e}, line "
        f"{line[0]:.6e}"
    )
    print(
        f"high velocity  exact {expected[1]:.6e}, average {average[-1]:.6e}, line "
        f"{line[-1]:.6e}"
    )
    assert np.allclose(average[[0, -1]], expected, rtol=2e-3), (
        "the average must meet both limits of the half-space"
    )
    assert np.allclose((line / average)[[0, -1]], [2, 1], rtol=2e-3), (
        "the line overstates them by 2 and by 1"
    )

    at_points = average[[24, 32, 40]]
    assert np.allclose(velocity[[24, 32, 40]], POINTS[:, 0]), (
        "the velocities of the points"
    )
    for (v, exact), mu in zip(POINTS, at_points, strict=True):
        print(
            f"v = {v:4g} m/s   three-dimensional {exact:.5f}, average {mu:.5f} "
            f"({100 * (mu / exact - 1):+.1f} %)"
        )
    assert np.allclose(at_points, POINTS[:, 1], rtol=0.03), (
        "the average must be within 3 % of the half-space"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
