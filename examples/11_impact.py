"""11: how high a ball bounces on rubber, against speed, at four temperatures.

Teaches: `em.impact` takes arrays of mass, velocity and temperature and returns
restitution, contact time, depth and force, and the whole motion of each impact. One
axis is one line of the figure.

Inputs: `tread-passenger-synthetic` of the library, a synthetic spectrum with the measured
shift law of an SBR; a steel ball of 10 mm radius, 33 g, chosen here.

Check: an integration of the same motion that shares nothing with the solver, for a
Kelvin-Voigt rubber, where the contact force is K (d^1.5 + 1.5 tau d^0.5 d') in the
approach and K (d + tau d')^1.5 in the rebound.

    python examples/11_impact.py [--out DIR]
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

import elastomdr as em

RADIUS, MASS = 10e-3, 33e-3  # m, kg


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)

    rubber = em.load_material("tread-passenger-synthetic")
    speed = np.geomspace(1e-3, 1.0, 10)  # m/s
    kelvin = np.array([[253.15], [273.15], [293.15], [333.15]])  # on an axis of its own
    bounces = em.impact(
        rubber, em.Paraboloid(RADIUS), mass=MASS, velocity=speed, temperature=kelvin
    )
    ax = bounces.plot(title="Bounce of a steel ball on a tread compound")
    ax.figure.savefig(out / "11_impact.png")
    print(bounces.summary())

    modulus, viscosity = 1e6, 300.0  # Pa, Pa s, in shear; E* = 4 G
    found = em.impact(
        em.KelvinVoigt(modulus, viscosity),
        em.Paraboloid(RADIUS),
        mass=MASS,
        velocity=1.0,
    )
    expected = reduced_equations(4 * modulus, viscosity / modulus, 1.0)
    print(
        f"check     restitution {found.restitution:.9f}, reduced equations "
        f"{expected:.9f}"
    )
    assert np.isclose(found.restitution, expected, rtol=1e-6), (
        "both are the same motion"
    )


def reduced_equations(modulus: float, tau: float, speed: float) -> float:
    """Restitution on a Kelvin-Voigt half-space: m d'' = -F, by scipy."""
    k = 4 / 3 * modulus * np.sqrt(RADIUS) / MASS

    def approach(_, y):
        d = max(y[0], 0.0)
        return [y[1], -k * (d**1.5 + 1.5 * tau * d**0.5 * y[1])]

    def rebound(_, y):
        return [y[1], -k * max(y[0] + tau * y[1], 0.0) ** 1.5]

    def turned(_, y):
        return y[1]

    def gone(_, y):
        return y[0] + tau * y[1] - 1e-13

    turned.terminal = gone.terminal = True
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-16}
    first = solve_ivp(approach, (0, 1), [0.0, speed], events=turned, **options)
    second = solve_ivp(rebound, (0, 1), [first.y[0, -1], 0.0], events=gone, **options)
    return -second.y[1, -1] / speed


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
