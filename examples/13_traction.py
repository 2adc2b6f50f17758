"""13: traction of a rolling ball against creepage, and the rolling loss it pays for.

Teaches: `em.traction` gives traction, the part of the contact that sticks, the power of
creepage, and the rolling loss beside them, for any broadcast of velocity, creepage and
friction coefficient.

Inputs: `tread-passenger-synthetic` of the library at 20 degC; ball of 10 mm radius, 5
N, friction coefficient 0.8: chosen here.

Check: an elastic ball has F_x/(mu F_N) = 1 - (1 - zeta)^3, zeta = xi R G*/(2 a mu E*),
the brush of tyre mechanics.

    python examples/13_traction.py [--out DIR]
"""

import argparse
from pathlib import Path

import numpy as np

import elastomdr as em

RADIUS, LOAD, FRICTION = 10e-3, 5.0, 0.8  # m, N
BALL = em.Paraboloid(RADIUS)


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)

    rubber = em.load_material("tread-passenger-synthetic").at(293.15)
    creepage = np.linspace(-0.2, 0.2, 81)
    velocity = np.array([[1e-4], [1e-2], [1.0], [100.0]])  # m/s, on an axis of its own
    found = em.traction(
        rubber, BALL, velocity=velocity, creepage=creepage, friction=FRICTION, load=LOAD
    )
    ax = found.plot(title="Traction of a ball on a tread compound, 20 °C")
    ax.figure.savefig(out / "13_traction.png")
    for v, row in zip(velocity[:, 0], found.rolling, strict=True):
        print(f"v = {v:8.1e} m/s: rolling loss {row[0]:.4f} of the load")

    solid = em.Prony(1e6, [], [])
    pulled = em.traction(
        solid, BALL, velocity=1.0, creepage=creepage, friction=FRICTION, load=LOAD
    )
    radius = (0.75 * LOAD * RADIUS / 4e6) ** (1 / 3)
    zeta = np.minimum(np.abs(creepage) * RADIUS * (2 / 3) / (2 * radius * FRICTION), 1)
    off = np.abs(
        pulled.coefficient - np.sign(creepage) * FRICTION * (1 - (1 - zeta) ** 3)
    ).max()
    print(f"check  elastic brush: off by {off:.0e}")
    assert off < 1e-10, "an elastic ball must follow the brush"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
