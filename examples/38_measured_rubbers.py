"""38: which measured materials does the library hold? Their master curves.

Teaches: `em.load_material` gives a material of the library with its range and its source;
`storage`, `loss` and `loss_tangent` are its moduli, here at 20 degC within the
frequencies that were measured.

Inputs: the four materials of the library whose moduli were fitted here to measured
ones: one rubber, a filled EPDM, and a polyisoprene melt, an acrylic adhesive and an
encapsulant of solar cells. All others are published series or illustrative
(`elastomdr materials`).

Check: storage and loss modulus belong together by the relation of Kramers and Kronig,
G'(omega) = G'(0) + (2/pi) int omega^2 G''(x)/(x (omega^2 - x^2)) dx, here by SciPy's
quadrature of the principal value, within 1e-6 of the storage modulus.

    python examples/38_measured_rubbers.py [--out DIR]
"""

import argparse
import itertools
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad

import elastomdr as em

NAMES = ("epdm-70", "polyisoprene-34k", "psa-468mp", "pv-encapsulant")
COLOURS = ("#1f5a94", "#c8702a", "#3c8d53", "#8a4fa0")
KELVIN = 293.15
DECADES = 30  # of the quadrature, on either side of a frequency


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (moduli, losses) = plt.subplots(1, 2, figsize=(8.6, 4.0))
    for name, colour in zip(NAMES, COLOURS, strict=True):
        rubber = em.load_material(name).at(KELVIN).shear()
        low, high = rubber.range.omega
        omega = np.geomspace(low, high, 200)
        moduli.loglog(omega, rubber.storage(omega), color=colour, label=name)
        moduli.loglog(omega, rubber.loss(omega), "--", color=colour)
        losses.loglog(omega, rubber.loss_tangent(omega), color=colour, label=name)
        middle = float(np.sqrt(low * high))
        off = kramers_kronig(rubber, middle) / float(rubber.storage(middle)) - 1
        print(
            f"{name}: {np.log10(high / low):.1f} decades, storage modulus "
            f"{1e-6 * float(rubber.storage(middle)):.3g} MPa at {middle:.3g} rad/s, by "
            f"Kramers and Kronig {off:+.0e}"
        )
        assert abs(off) < 1e-6, "storage and loss modulus belong together"
    for ax, label in ((moduli, "Shear modulus [Pa]"), (losses, "Loss tangent [-]")):
        ax.set(xlabel="Angular frequency [rad/s]", ylabel=label)
        ax.legend()
    moduli.set_title("At 20 °C; dashed: loss modulus")
    losses.set_title("Within the measured range of each")
    figure.savefig(out / "38_measured_rubbers.png")
    plt.close(figure)


def kramers_kronig(rubber: em.Prony, omega: float) -> float:
    """The storage modulus from the loss modulus, over x = omega exp(s): the principal
    value takes +s and -s together.
    """

    def integrand(s: float) -> float:
        above, below = omega * np.exp(s), omega * np.exp(-s)
        share = rubber.loss(above) / (1 - np.exp(2 * s))
        share += rubber.loss(below) / (1 - np.exp(-2 * s))
        return float(share)

    steps = np.linspace(0, DECADES * np.log(10), DECADES + 1)
    whole = sum(
        quad(integrand, a + 1e-9 * (a == 0), b, epsrel=1e-10, limit=200)[0]
        for a, b in itertools.pairwise(steps)
    )
    return float(rubber.equilibrium) + 2 / np.pi * whole


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
