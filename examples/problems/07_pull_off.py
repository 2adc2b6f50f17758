"""Problem 7: a sticky ball is pulled off rubber: the same force at any speed, but not
the same way.

Teaches: `adhesion=` with many speeds in one call, one on each row; the radius is zero
where the ball has come off.

Inputs: chosen here: E* = 1 MPa relaxed and 5 MPa glassy, tau = 1 s; work of adhesion
gamma = 50 mJ/m^2; ball of 10 mm radius, at rest at a depth of 0.1 mm until all has
relaxed, then drawn up at speeds from 10 nm/s to 0.1 m/s.

Check: the edge lets go by its glassy modulus (a rule of the package, not a theorem: it
has no process zone, which in measured pull-off makes the force depend on the speed). So
all is JKR with g = gamma E_0/E_inf at a depth D that lags behind d, E_inf (D - d_0) =
int E(t - s) dd: largest pull (3/2) pi g R, break at D = -(3/4) (pi^2 g^2
R/E_inf^2)^(1/3). Both to one in the thousand instants into which the way is cut; the
pull has a flat top, and is met to 5e-3 of it.

    python examples/problems/07_pull_off.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import elastomdr as em

# m, J/m^2, Pa, Pa, s, m
RADIUS, GAMMA, RELAXED, BRANCH, TAU, START = 10e-3, 0.05, 1e6, 4e6, 1.0, 1e-4
STICKY = GAMMA * (RELAXED + BRANCH) / RELAXED  # g [J/m^2]


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    speed = np.geomspace(1e-8, 1e-1, 22)
    way = np.linspace(0.0, 1.2 * START, 1000)
    rubber = em.Foundation(RELAXED, [BRANCH], [TAU])
    found = em.indent(
        rubber,
        em.Paraboloid(RADIUS),
        time=way / speed[:, None],
        depth=START - way,
        adhesion=GAMMA,
    )
    pull = -found.force.min(axis=1)
    broken = way[(found.contact_radius > 0).sum(axis=1)]

    jkr = 1.5 * np.pi * STICKY * RADIUS
    # d_0 - D at the break [m]
    deep = START + 0.75 * np.cbrt((np.pi * STICKY / RELAXED) ** 2 * RADIUS)

    def lag(x: float, v: float) -> float:
        return x - v * TAU * BRANCH / RELAXED * np.expm1(-x / v / TAU) - deep

    exact = np.array([brentq(lag, 0, deep, (v,)) for v in speed])

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    for i, colour in ((0, "#7fa7cc"), (12, "#1f5a94"), (21, "#0b2540")):
        left.plot(
            1e6 * way,
            1e3 * found.force[i],
            color=colour,
            label=f"{1e6 * speed[i]:g} µm/s",
        )
    left.axhline(
        -1e3 * jkr,
        color="#a03030",
        linestyle="--",
        linewidth=1,
        label=r"$-(3/2)\pi g R$",
    )
    left.set(
        xlabel="Way drawn up [µm]", ylabel="Force [mN]", title="Force", ylim=(-20, 40)
    )
    right.semilogx(1e6 * speed, 1e6 * broken, color="#1f5a94", label="em.indent")
    right.semilogx(
        1e6 * speed,
        1e6 * exact,
        "o",
        color="#a03030",
        fillstyle="none",
        label="JKR at the lagging depth",
    )
    right.set(
        xlabel="Speed [µm/s]",
        ylabel="Way to the break [µm]",
        title="Way to the break",
        ylim=(0, None),
    )
    for ax in (left, right):
        ax.legend(frameon=False)
        ax.grid(color="#dddddd")
    figure.savefig(out / "07_pull_off.png", dpi=150)
    plt.close(figure)

    off = np.abs(pull / jkr - 1).max(), np.abs(broken - exact).max() / way[1]
    print(
        f"check  largest pull off by {off[0]:.1e}, way to the break by "
        f"{off[1]:.2f} "
        "instants"
    )
    assert off[0] < 5e-3, "the pull must be that of JKR with the glassy energy"
    assert off[1] < 1.01, "the way must be that of the lagging depth"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
