"""10: a ball that sticks: JKR adhesion, and how a viscoelastic rubber holds on when it
is pulled fast.

Teaches: `adhesion=` of `em.indent`, in J/m^2; loads that pull; that a point where the
body has come off is NaN.

Inputs: elastic E* = 1 MPa, or 1 MPa relaxed and 4 MPa glassy with tau = 1 s, work of
adhesion 50 mJ/m^2, ball of 10 mm radius: illustrative.

Check: the largest pull of JKR, (3/2) pi gamma R, and that of the viscoelastic rule,
E_0/E_inf times as much.

    python examples/10_adhesion.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RADIUS, GAMMA, RELAXED, GLASSY = 10e-3, 0.05, 1e6, 4e6  # m, J/m^2, Pa, Pa


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    ball = em.Paraboloid(RADIUS)
    # m
    way = np.concatenate(
        [np.linspace(-4e-6, 6e-5, 200), np.linspace(6e-5, -6e-6, 1500)]
    )
    elastic = em.indent(
        em.Foundation(RELAXED, [], []),
        ball,
        time=np.arange(float(way.size)),
        depth=way,
        adhesion=GAMMA,
    )
    rubber = em.Foundation(RELAXED, [GLASSY - RELAXED], [1.0])
    pull = np.linspace(6e-5, -1e-5, 3000)  # m, after a long rest
    slow, fast = (
        em.indent(
            rubber,
            ball,
            time=np.linspace(0, duration, pull.size),
            depth=pull,
            adhesion=GAMMA,
        )
        for duration in (10.0, 1e-3)
    )
    print(fast.summary())

    figure, ax = plt.subplots(figsize=(6.6, 4.4))
    ax.plot(1e6 * elastic.depth, 1e3 * elastic.force, label="elastic (JKR)")
    ax.plot(
        1e6 * slow.depth, 1e3 * slow.force, label="viscoelastic rule, pulled in 10 s"
    )
    ax.plot(
        1e6 * fast.depth, 1e3 * fast.force, label="viscoelastic rule, pulled in 1 ms"
    )
    ax.axhline(0, color="#888888", linewidth=0.8)
    ax.set(xlabel="Depth [µm]", ylabel="Force [mN]", title="Pulling a sticky ball off")
    ax.legend()
    figure.savefig(out / "10_adhesion.png")
    plt.close(figure)

    jkr = 1.5 * np.pi * GAMMA * RADIUS
    print(f"check     largest pull {-elastic.force.min():.6g} N, JKR {jkr:.6g} N")
    print(
        f"check     pulled fast {-fast.force.min():.6g} N, rule "
        f"{jkr * GLASSY / RELAXED:.6g} N"
    )
    assert np.isclose(-elastic.force.min(), jkr, rtol=1e-4), "JKR's pull-off force"
    assert np.isclose(-fast.force.min(), jkr * GLASSY / RELAXED, rtol=1e-3), (
        "pull-off force of the rule"
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
