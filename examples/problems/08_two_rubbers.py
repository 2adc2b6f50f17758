"""Problem 8: a soft slider on a hard track, both of rubber: which of the two rubs?

Teaches: `em.half_space(a, b)` puts two materials in series, exactly; the pair goes
wherever a material does.

Inputs: chosen here: soft, G = 0.5 and 1.5 MPa, tau = 10 ms; hard, G = 4 and 12 MPa, tau
= 10 us; ball (paraboloid) of 5 mm radius under 1 N.

Check: compliances add, so creep under a dead load is a^3 = (3/4) R F (J_a + J_b),
exactly: 1e-9. At low speed the loss compliances add: mu = (v/R) E_inf sum_i
eta_i/E_i^2, eta = sum(E_k tau_k), 1/E_inf = sum_i 1/E_i (three-dimensional limit, first
order in the loss). What is left out is a part of order (E_0/E_inf) v tau/a: asked is
that number.

    python examples/problems/08_two_rubbers.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RADIUS, LOAD = 5e-3, 1.0  # m, N
SOFT, HARD = em.StandardSolid(0.5e6, 1.0e6, 1e-2), em.StandardSolid(4e6, 8e6, 1e-5)
BALL = em.Paraboloid(RADIUS)


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    bodies = [em.half_space(rubber) for rubber in (SOFT, HARD)]
    pair = em.half_space(SOFT, HARD)
    velocity = np.geomspace(1e-4, 1e3, 50)
    names = ("soft on a rigid ball", "hard on a rigid ball", "soft and hard")
    curves = [
        em.friction(b, BALL, velocity=velocity, load=LOAD) for b in (*bodies, pair)
    ]

    relaxed = 1 / sum(1 / b.equilibrium for b in bodies)
    # of loss [s]
    share = [relaxed * np.sum(b.moduli * b.times) / b.equilibrium**2 for b in bodies]
    slow = velocity[:9]

    figure, ax = plt.subplots(figsize=(7.2, 4.6), layout="constrained")
    for curve, name, colour in zip(
        curves, names, ("#7fa7cc", "#c08a3e", "#1f5a94"), strict=True
    ):
        ax.loglog(velocity, curve.mu, color=colour, label=name)
    ax.loglog(
        slow,
        sum(share) / RADIUS * slow,
        "o",
        color="#a03030",
        fillstyle="none",
        label="pair, low speed",
    )
    ax.set(
        xlabel="Sliding velocity [m/s]",
        ylabel="Friction coefficient [-]",
        ylim=(1e-5, 1),
    )
    ax.set_title(f"Two rubbers in series, 1 N\n{curves[-1].model}", fontsize=10)
    ax.legend(frameon=False)
    ax.grid(color="#dddddd")
    figure.savefig(out / "08_two_rubbers.png", dpi=150)
    plt.close(figure)

    time = np.geomspace(1e-7, 1.0, 30)
    sunk = em.indent(pair, BALL, time=np.append(0.0, time), load=LOAD)
    radius = np.cbrt(
        0.75 * RADIUS * LOAD * sum(b.creep_compliance(time) for b in bodies)
    )
    creep = np.abs(sunk.contact_radius[1:] / radius - 1).max()
    off = np.abs(curves[-1].mu[:9] * RADIUS / (sum(share) * slow) - 1)
    part = 3 * slow * 1e-2 / curves[-1].contact.leading[:9]
    print(
        f"check  creep off by {creep:.1e}; low speed off by {off[0]:.1e} at "
        f"(E_0/E_inf) v tau/a = {part[0]:.1e}"
    )
    print(
        f"       the soft body has {share[0] / sum(share):.1%} of the loss at low speed"
    )
    assert creep < 1e-9, "compliances in series must add"
    assert (off < part).all(), "at low speed the losses must add"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
