"""08: a ball sinks into rubber: creep under a dead load.

Teaches: `em.indent` with a load; several loads at once on an axis of their own; the
pressure in three dimensions.

Inputs: `silicone-like` of the library, illustrative. Ball of 10 mm radius, loads and
times: chosen here.

Check: as long as the contact grows, a^3 = (3/4) R F J(t) and d = a^2/R for a paraboloid
(Lee & Radok 1960), with J the creep function of the half-space.

    python examples/08_creep.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RADIUS = 10e-3  # m


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    rubber = em.load_material("silicone-like")
    ball = em.Paraboloid(RADIUS)
    time = np.append(0.0, np.geomspace(1e-4, 1e3, 199))  # s
    load = np.array([[0.5], [1.0], [2.0]])  # N
    creep = em.indent(rubber, ball, time=time, load=load)
    print(creep.summary())

    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    for depth, force in zip(creep.depth, load[:, 0], strict=True):
        left.semilogx(time[1:], 1e3 * depth[1:], label=f"{force:g} N")
    left.set(xlabel="Time under load [s]", ylabel="Depth [mm]", title="A ball sinks in")
    left.legend()
    single = em.indent(rubber, ball, time=time, load=1.0)
    r = np.linspace(0, 2 * single.contact_radius[-1], 121)
    for t in (1e-3, 1.0):
        right.plot(1e3 * r, 1e-6 * single.pressure(r, t), label=f"after {t:g} s")
    right.set(
        xlabel="Radius [mm]",
        ylabel="Contact pressure [MPa]",
        title="Pressure under 1 N",
    )
    right.legend()
    figure.savefig(out / "08_creep.png")
    plt.close(figure)

    radius = np.cbrt(
        0.75 * RADIUS * load * em.half_space(rubber).creep_compliance(time)
    )
    off = np.abs(creep.depth / (radius**2 / RADIUS) - 1).max()
    print(f"check     depth against Lee and Radok: {off:.1e}")
    assert off < 1e-10, "creep must meet the closed form"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
