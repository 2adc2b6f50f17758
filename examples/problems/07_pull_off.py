"""Problem 7: a sticky ball is pulled off rubber: the faster, the harder, from the pull
of JKR up to that of the glassy modulus.

Teaches: `em.Adhesion` with a cutoff; many speeds in one call, one on each row;
`pull_off` and `work_factor` of the edge.

Inputs: chosen here: E* = 1 MPa relaxed and 5 MPa glassy, tau = 1 s; work of adhesion
50 mJ/m^2 at rest, cutoff 0.1 um; ball of 10 mm radius, at rest at a depth of 50 um until
all has relaxed, then drawn up at speeds from 1 pm/s to 1 mm/s.

Check: as the edge alone is fast and the rest of the rubber relaxed, the ball pulls with
JKR's force times the factor Gamma of its edge; ends are JKR's (3/2) pi w R and E_0/E_inf
times it. Gamma is solved again by hand: 1/Gamma = 1 - (1-k)(sqrt(1+b^2) - 1)/b with
b = 2 pi v lambda/(a_0 Gamma), k = E_inf/E_0, lambda = tau/k (Persson & Brener 2005).

    python examples/problems/07_pull_off.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import elastomdr as em

# m, J/m^2, m, Pa, Pa, s, m
RADIUS, WORK, CUTOFF, RELAXED, BRANCH, TAU = 10e-3, 0.05, 1e-7, 1e6, 4e6, 1.0
START = 5e-5
GLASSY = (RELAXED + BRANCH) / RELAXED  # E_0/E_inf
JKR = 1.5 * np.pi * WORK * RADIUS


def gamma(v: float) -> float:
    """Gamma of an edge at v [m/s]."""

    def surplus(factor: float) -> float:
        b = 2 * np.pi * v * TAU * GLASSY / (CUTOFF * factor)
        return 1 / factor - 1 + (1 - 1 / GLASSY) * b / (1 + np.sqrt(1 + b**2))

    return float(brentq(surplus, 1.0, GLASSY))


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    speed = np.geomspace(1e-12, 1e-3, 13)
    way = np.linspace(0.0, 2 * START, 300)
    rest = 1e6 * TAU
    found = em.indent(
        em.Foundation(RELAXED, [BRANCH], [TAU]),
        em.Paraboloid(RADIUS),
        time=np.insert(rest + way / speed[:, None], 0, 0.0, axis=1),
        depth=START - np.insert(way, 0, 0.0),
        adhesion=em.Adhesion(WORK, cutoff=CUTOFF),
    )
    pull = -found.pull_off.force / JKR
    instant = np.argmin(found.force, axis=1)[:, None]
    edge = np.take_along_axis(-found.edge_speed, instant, axis=1)[:, 0]
    factor = np.array([gamma(v) for v in edge])

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    for i, name in ((0, "1 pm/s"), (6, "32 nm/s"), (12, "1 mm/s")):
        left.plot(1e6 * way, 1e3 * found.force[i, 1:], label=name)
    left.set(xlabel="Way drawn up [µm]", ylabel="Force [mN]", ylim=(-14, 20))
    right.semilogx(1e6 * speed, pull, label="em.indent")
    right.semilogx(1e6 * speed, factor, "o", fillstyle="none", label="Γ of the edge")
    right.set(xlabel="Speed [µm/s]", ylabel="Largest pull over that of JKR [-]")
    for ax in (left, right):
        ax.legend()
    figure.savefig(out / "07_pull_off.png", dpi=150)
    plt.close(figure)

    off = abs(pull / factor - 1)
    print(f"check  pull over JKR {pull[0]:.3f} to {pull[-1]:.3f}, E_0/E_inf {GLASSY:g}")
    print(f"check  pull off Gamma of its edge by {off.max():.1%} at most")
    assert np.isclose(pull[0], 1, atol=0.02), "slowly it is JKR's pull"
    assert np.isclose(pull[-1], GLASSY, rtol=0.02), "fast it is that of the glassy edge"
    assert off.max() < 0.1, "the pull must be JKR's times Gamma of its edge"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
