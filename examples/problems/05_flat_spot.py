"""Problem 5: a wheel that stood overnight: how deep the flat spot is, and how long it
stays.

Teaches: `em.indent` on a layer under a load, then let go; `displacement` of the free
surface afterwards.

Inputs: chosen here: solid tyre of 4 mm, a rubber with relaxed E = 6 MPa and three slow
branches of 1 MPa each at 1 s, 1 min and 30 min, on a rim that does not yield; wheel of
0.1 m radius and 40 mm width, 1 kN, ten hours. The contact is twice as wide as the tyre
is thick: independent elements are an estimate of it.

Check: while the wheel stands, d^(3/2) = 3 F J(t)/(4 sqrt(2 R) L), J the creep of the
layer. Lifted, the flat recovers as u(t) = q (J_inf - J(t)), q the pressure on its
middle; at once that is d (1 - E_inf/E_0). The night is 20 times the slowest time, in
which pressures have settled: to 1e-4. The creep is exact.

    python examples/problems/05_flat_spot.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RADIUS, WIDTH, LOAD, NIGHT = 0.1, 0.04, 1000.0, 36e3  # m, m, N, s
RUBBER = em.Prony(
    6e6, [1e6, 1e6, 1e6], [1.0, 60.0, 1800.0], kind="tensile", poisson=0.45
)
TYRE, TREAD = em.springs(RUBBER, 4e-3), em.Cylinder(RADIUS, WIDTH)


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    standing = np.append(0.0, np.geomspace(0.1, NIGHT, 24))
    lifted = np.append(1e-3, np.geomspace(0.1, 2 * 3600, 10))
    wheel = em.indent(TYRE, TREAD, time=standing, load=LOAD)
    time, depth = (
        np.append(standing, NIGHT + lifted),
        np.append(wheel.depth, 0 * lifted),
    )
    left_alone = em.indent(TYRE, TREAD, time=time, depth=depth)
    flat = np.array([left_alone.displacement(0.0, NIGHT + t) for t in lifted])

    creep = (
        0.75 * LOAD * TYRE.creep_compliance(standing) / (np.sqrt(2 * RADIUS) * WIDTH)
    ) ** (2 / 3)
    final = creep[-1]
    recovery = (
        TYRE.equilibrium
        * final
        * (TYRE.creep_compliance(1e9) - TYRE.creep_compliance(lifted))
    )

    figure, (left, right) = plt.subplots(
        1, 2, figsize=(9.6, 4.2), layout="constrained", sharey=True
    )
    left.semilogx(
        standing[1:], 1e3 * wheel.depth[1:], color="#1f5a94", label="em.indent"
    )
    left.semilogx(
        standing[1::2],
        1e3 * creep[1::2],
        "o",
        color="#a03030",
        fillstyle="none",
        label="closed form",
    )
    left.set(
        xlabel="Time standing [s]",
        ylabel="Depth, and depth of the flat [mm]",
        ylim=(0, None),
    )
    right.semilogx(lifted, 1e3 * flat, color="#1f5a94", label="em.indent, displacement")
    right.semilogx(
        lifted,
        1e3 * recovery,
        "o",
        color="#a03030",
        fillstyle="none",
        label="limit of a long night",
    )
    right.set(xlabel="Time since the wheel was lifted [s]")
    left.set_title("Solid tyre under 1 kN: the axle sinks", fontsize=10)
    right.set_title("Lifted after ten hours: the flat recovers", fontsize=10)
    for ax in (left, right):
        ax.legend(frameon=False)
        ax.grid(color="#dddddd")
    figure.savefig(out / "05_flat_spot.png", dpi=150)
    plt.close(figure)

    off = (
        np.abs(wheel.depth[1:] / creep[1:] - 1).max(),
        np.abs(flat - recovery).max() / flat[0],
    )
    print(
        f"check  sinking off by {off[0]:.1e}; flat off by {off[1]:.1e}, after 1 ms "
        f"{1e3 * flat[0]:.4f} mm"
    )
    assert off[0] < 1e-9, "creep must meet the closed form"
    assert off[1] < 1e-3, "the flat must recover as a pressure that had settled"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
