"""04: the indentation rolling resistance of a conveyor belt on an idler.

Teaches: an idler is an `em.Cylinder`, and `em.rolling` gives the resistance; on a cover
as independent springs (`em.springs`), as in much of this literature, and on the cover
as what it is, a bonded layer (`em.layer`). Rubber that can be compressed freely, as
`conveyor-cover` is taken to be, makes little of the difference; a nearly incompressible
one, as `epdm-70` is, does.

Inputs: `conveyor-cover` of the library: E0 = 7 MPa, E1 = 250 MPa, eta = 1875 Pa s,
numbers of the kind that the conveyor literature uses, illustrative. Cover 8 mm, idler
159 mm in diameter, one metre of belt width: chosen here.

Check: the exact solution for a three-parameter cover (of the type of Lodewijks 1995):
pressure behind the leading edge in closed form, trailing edge where it falls to zero,
forces by quadrature.

    python examples/04_belt_idler.py [--out DIR]
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

import elastomdr as em

THICKNESS, DIAMETER, WIDTH = 8e-3, 0.159, 1.0  # m


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)

    cover = em.springs(em.load_material("conveyor-cover"), THICKNESS)
    idler = em.Cylinder(DIAMETER / 2, WIDTH)
    velocity = np.geomspace(0.1, 100.0, 61)  # m/s
    load = np.array([[1e3], [2e3], [4e3]])  # N, on an axis of its own
    curve = em.rolling(cover, idler, velocity=velocity, load=load)
    ax = curve.plot(title="Indentation rolling resistance of a belt, per idler")
    ax.figure.savefig(out / "04_belt_idler.png")

    at_work = em.rolling(cover, idler, velocity=5.2, load=2e3)
    print(at_work.summary())
    print(f"power     {at_work.power:.1f} W per idler and metre of width")
    expected = three_parameter_solution(velocity=5.2, load=2e3)
    print(
        f"check     coefficient {at_work.coefficient:.10f}, exact solution "
        f"{expected:.10f}"
    )
    assert np.isclose(at_work.coefficient, expected, rtol=1e-8), (
        "the springs must meet the exact solution"
    )

    epdm = em.load_material("epdm-70")
    print(
        "cover of 6 mm of epdm-70 at 20 degC: resistance over load as springs "
        "free at the base, as a bonded layer"
    )
    for load_per_roll in (300.0, 1000.0, 3000.0):
        given = {"velocity": 5.0, "load": load_per_roll, "temperature": 293.15}
        roll = em.Cylinder(DIAMETER / 2, 0.4)
        springs = em.rolling(em.springs(epdm, 6e-3, bonded=False), roll, **given)
        layer = em.rolling(em.layer(epdm, 6e-3), roll, **given)
        wide = (layer.contact.leading + layer.contact.trailing) / 6e-3
        print(
            f"  {load_per_roll:5.0f} N  springs {springs.coefficient:.5f}  layer "
            f"{layer.coefficient:.5f}  springs over layer "
            f"{springs.coefficient / layer.coefficient:.2f} at contact "
            f"width/thickness {wide:.2f}"
        )


def three_parameter_solution(velocity: float, load: float) -> float:
    """Rolling resistance over load: sigma(x) = u E/h under an idler whose surface is w
    = d - x^2/D.
    """
    relaxed, modulus, viscosity = 7e6, 250e6, 1875.0  # E0, E1 [Pa], eta [Pa s]
    s = velocity * viscosity / modulus  # distance rolled within the relaxation time [m]

    def pressure(x: float, a: float) -> float:
        branch = (x + s) - (a + s) * np.exp(-(a - x) / s)
        return (relaxed * (a**2 - x**2) + 2 * modulus * s * branch) / (
            DIAMETER * THICKNESS
        )

    def forces(a: float) -> tuple[float, float]:
        trailing = brentq(lambda x: pressure(x, a), -a, 0.0, xtol=1e-16)
        normal, _ = quad(lambda x: pressure(x, a), trailing, a, epsrel=1e-12)
        resistance, _ = quad(
            lambda x: pressure(x, a) * 2 * x / DIAMETER, trailing, a, epsrel=1e-12
        )
        return WIDTH * normal, WIDTH * resistance

    a = brentq(lambda a: forces(a)[0] - load, 1e-4, 5e-2, xtol=1e-16)
    normal, resistance = forces(a)
    return resistance / normal


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
