"""12: fretting loops of a ball on rubber: partial slip, and the rubber's own damping
beside it.

Teaches: `em.shear` follows any history of normal and tangential motion, element by
element, stick or slip. The work of a cycle is split into what slip turns into heat and
what the rubber dissipates.

Inputs: a standard solid with a loss tangent of up to 0.5 and its two elastic limits,
ball of 10 mm radius, 5 N, friction coefficient 0.6, one cycle a second: chosen here.

Check: the elastic loops are those of Mindlin & Deresiewicz (1953): the energy per cycle
in closed form.

    python examples/12_fretting.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RADIUS, LOAD, FRICTION = 10e-3, 5.0, 0.6  # m, N
BALL = em.Paraboloid(RADIUS)
RELAXED, BRANCH, TIME = 0.5e6, 0.8e6, 0.15  # Pa, Pa, s
RUBBERS = {
    "relaxed": em.Prony(RELAXED, [], []),
    "viscoelastic": em.StandardSolid(RELAXED, BRANCH, TIME),
    "glassy": em.Prony(RELAXED + BRANCH, [], []),
}


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)

    time = np.linspace(0.0, 2.0, 73)  # s
    figure, ax = plt.subplots(figsize=(7.2, 4.6))
    for (name, rubber), colour in zip(
        RUBBERS.items(), ("#7fa7cc", "#1f5a94", "#c08a3e"), strict=True
    ):
        motion = 150e-6 * np.sin(2 * np.pi * time)  # m
        found = em.shear(
            rubber, BALL, time=time, displacement=motion, friction=FRICTION, load=LOAD
        )
        cycle = slice(36, 73)  # the second
        ax.plot(1e6 * motion[cycle], found.force[cycle], color=colour, label=name)
        work, slip = (float(x[72] - x[36]) for x in (found.work, found.slip_loss))
        print(
            f"{name:<13} work per cycle {1e6 * work:7.2f} uJ, of it slip "
            f"{1e6 * slip:7.2f} uJ"
        )
        if name != "viscoelastic":
            check(rubber, slip)
    ax.set(xlabel="Tangential displacement [µm]", ylabel="Tangential force [N]")
    ax.set_title(
        f"Fretting loops, 1 Hz, {LOAD:g} N, friction coefficient {FRICTION:g}", pad=18
    )
    ax.text(0, 1.02, found.model, transform=ax.transAxes, fontsize=8, color="#666666")
    ax.legend(loc="upper left")
    figure.savefig(out / "12_fretting.png")
    plt.close(figure)


def check(rubber: em.Prony, slip: float) -> None:
    """W = (18/5) (mu F)^2/(G* a) {1 - (1-T)^(5/3) - (5T/6)[1 + (1-T)^(2/3)]}, T the
    force over mu F at the turn.
    """
    normal, tangential = (
        float(em.half_space(rubber, tangential=t).equilibrium) for t in (False, True)
    )
    radius = (0.75 * LOAD * RADIUS / normal) ** (1 / 3)
    # displacement at which all slips
    full = FRICTION * normal * radius**2 / RADIUS / tangential
    part = 1 - (1 - 150e-6 / full) ** 1.5
    bracket = 1 - (1 - part) ** (5 / 3) - 5 * part / 6 * (1 + (1 - part) ** (2 / 3))
    expected = 18 / 5 * (FRICTION * LOAD) ** 2 / (tangential * radius) * bracket
    print(
        f"check         closed form              {1e6 * expected:7.2f} uJ, off by "
        f"{abs(slip / expected - 1):.0e}"
    )
    assert np.isclose(slip, expected, rtol=1e-8), "an elastic loop must be Mindlin's"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
