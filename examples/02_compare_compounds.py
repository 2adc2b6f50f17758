"""02: compare compounds under the same slider.

Teaches: one call per material puts compounds side by side, and the order they come in
changes with the velocity.

Inputs: four rubbers of the library at 20 degC. Only `epdm-70` was fitted to measured
moduli; the others are synthetic spectra of the library (see the grades in their files
under materials/). Radius and load are chosen here, the velocities so that velocity over
contact radius, about 0.01 to 10^4 rad/s, stays within the range of every material file.

Check: at low velocity the friction of a paraboloid on a half-space is mu = v sum(E_k
tau_k)/(E_inf R), the result of Brilliantov & Poeschel (1998) for a slowly rolling
sphere, written for a spectrum.

    python examples/02_compare_compounds.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

NAMES = (
    "tread-winter-synthetic",
    "tread-passenger-synthetic",
    "epdm-70",
    "silicone-like",
)
BALL, LOAD, TEMPERATURE = em.Paraboloid(radius=5e-3), 1.0, 293.15  # m, N, K


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    velocity = np.geomspace(1e-5, 10.0, 61)  # m/s

    figure, ax = plt.subplots(figsize=(7.2, 4.6))
    print(f"{'compound':<28}{'mu at 1 mm/s':>14}{'mu at 1 m/s':>14}{'largest mu':>12}")
    for name in NAMES:
        rubber = em.load_material(name)
        curve = em.friction(
            rubber, BALL, velocity=velocity, load=LOAD, temperature=TEMPERATURE
        )
        illustrative = "illustrative" in [doubt.kind for doubt in curve.doubts]
        label = f"{name} (illustrative)" if illustrative else name
        ax.semilogx(curve.velocity, curve.mu, label=label)
        slow, fast = np.exp(
            np.interp(np.log([1e-3, 1.0]), np.log(velocity), np.log(curve.mu))
        )
        print(f"{name:<28}{slow:>14.4f}{fast:>14.4f}{curve.mu.max():>12.4f}")
        check_low_velocity(rubber)

    ax.set(
        xlabel="Sliding velocity [m/s]",
        ylabel="Friction coefficient [-]",
        ylim=(0, 0.03),
    )
    ax.set_title("Four compounds at 20 °C", pad=18)
    ax.text(0, 1.02, curve.model, transform=ax.transAxes, fontsize=8, color="#666666")
    ax.legend()
    figure.savefig(out / "02_compare_compounds.png")
    plt.close(figure)


def check_low_velocity(rubber: em.Prony) -> None:
    rubber = rubber.at(TEMPERATURE)
    # a limit, beyond any range
    rubber = em.Prony(rubber.equilibrium, rubber.moduli, rubber.times, name=rubber.name)
    # sum(E_k tau_k)/E_inf [s]
    viscosity = np.sum(rubber.moduli * rubber.times) / rubber.equilibrium
    velocity = 1e-7 * float(BALL.radius) / rubber.times[-1]
    found = em.friction(rubber, BALL, velocity=velocity, load=LOAD)
    expected = velocity * viscosity / float(BALL.radius)
    assert np.isclose(found.mu, expected, rtol=1e-4), (
        f"{rubber.name}: mu = {found.mu} where {expected} is exact"
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
