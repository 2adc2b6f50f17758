"""01: a friction curve in five lines.

Teaches: a material from the library, a ball, a range of velocities and a load make a
curve, a figure and a summary.

Inputs: the compound is `tread-passenger-synthetic` of the library, a spectrum synthesised
for it (see its file under materials/); radius and load are chosen here.

Check: far below and far above all relaxation times the rubber is elastic and friction
vanishes, so that the depth must be the one of Hertz (1882), d = [9 F^2/(16 R
E*^2)]^(1/3), with E* = 4 G, relaxed or glassy.

    python examples/01_friction_curve.py [--out DIR]
"""

import argparse
from pathlib import Path

import numpy as np

import elastomdr as em


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)

    rubber = em.load_material("tread-passenger-synthetic")
    ball = em.Paraboloid(radius=5e-3)  # m
    velocity = np.geomspace(1e-6, 10.0, 64)  # m/s
    curve = em.friction(rubber, ball, velocity=velocity, load=1.0)  # N
    curve.plot().figure.savefig(out / "01_friction_curve.png")

    print(curve.summary())
    check_hertz(rubber)


def check_hertz(rubber: em.Prony, radius: float = 5e-3, load: float = 1.0) -> None:
    """Slow enough that nothing is left to relax, and so fast that nothing has relaxed
    yet: a millionth off Hertz.
    """
    slow, fast = 1e-7 * radius / rubber.times[-1], 1e7 * radius / rubber.times[0]
    ends = em.friction(rubber, em.Paraboloid(radius), velocity=[slow, fast], load=load)
    # E* of an incompressible half-space
    modulus = 4 * np.array([rubber.equilibrium, rubber.instantaneous])
    hertz = (9 * load**2 / (16 * radius * modulus**2)) ** (1 / 3)
    relaxed, glassy = ends.depth / hertz
    print(
        f"check               depth over Hertz's depth: {relaxed:.8f} relaxed, "
        f"{glassy:.8f} glassy"
    )
    assert np.allclose(ends.depth, hertz, rtol=1e-5), (
        "the depth must meet Hertz at both ends"
    )
    assert (ends.mu < 1e-6).all(), "an elastic half-space has no hysteresis friction"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
