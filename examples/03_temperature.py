"""03: temperature shifts the friction curve along the velocity axis.

Teaches: where temperature does no more than multiply all relaxation times by a_T, mu(v,
T) = mu(v a_T, T_ref): curves at six temperatures are one curve of v a_T, as Grosch
(1963) found by experiment.

Inputs: `tread-passenger-synthetic` of the library, a synthetic spectrum with the
published shift law of a cured SBR (Wu, Fujii, Kawahara & Isono 2007, e-J. Soft Mater.
3:41: c1 = 13.2, c2 = 39.7 K about -42 degC); load and radius chosen here. Shaded:
slower than the material file vouches for.

Check: the shift factors are computed here from the constants as published, not from the
library's, rewritten for 20 degC.

    python examples/03_temperature.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

CELSIUS = np.array([-20.0, -10.0, 5.0, 20.0, 40.0, 60.0])
REFERENCE = 20.0  # degC
LOWEST_FREQUENCY = 0.01  # rad/s, from the [range] of the material file


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)

    rubber = em.load_material("tread-passenger-synthetic")
    ball = em.Paraboloid(radius=5e-3)  # m
    velocity = np.geomspace(1e-6, 10.0, 64)  # m/s
    temperature = CELSIUS[:, None] + 273.15  # K, on an axis of its own
    curve = em.friction(
        rubber, ball, velocity=velocity, load=1.0, temperature=temperature
    )

    reduced = velocity * published_shift()[:, None]
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8), sharey=True)
    for i, celsius in enumerate(CELSIUS):
        colour = plt.colormaps["viridis"](0.17 * i)
        left.semilogx(velocity, curve.mu[i], color=colour, label=f"{celsius:g} °C")
        right.semilogx(
            reduced[i],
            curve.mu[i],
            "o",
            color=colour,
            markersize=4,
            markevery=(i % 3, 3),
        )
    slowest = LOWEST_FREQUENCY * float(curve.contact.leading.max())
    right.axvspan(reduced.min() / 2, slowest, color="#eeeeee", zorder=0)
    right.text(
        1.6 * slowest,
        0.0012,
        "\u2190 outside the material file's range",
        fontsize=9,
        color="#666666",
    )
    left.set(
        xlabel="Sliding velocity $v$ [m/s]",
        ylabel="Friction coefficient [-]",
        ylim=(0, 0.032),
    )
    right.set(
        xlabel=f"Reduced velocity $v\\,a_T$ [m/s], reference {REFERENCE:g} °C",
        xlim=(reduced.min() / 2, None),
    )
    left.legend(loc="upper left")
    for ax, title in (
        (left, "As slid"),
        (right, f"Shifted to {REFERENCE:g} °C: one curve"),
    ):
        ax.set_title(title)
    about = f"Ball of 5 mm radius, 1 N, on {rubber.name}, illustrative moduli\n{curve.model}"
    figure.suptitle(about, fontsize=8, color="#666666")
    figure.savefig(out / "03_temperature.png")
    plt.close(figure)

    print(
        "log10 a_T ",
        ", ".join(
            f"{x:.3f} at {t:g} °C"
            for x, t in zip(np.log10(published_shift()), CELSIUS, strict=True)
        ),
    )
    at_reference = em.friction(rubber, ball, velocity=reduced, load=1.0)
    worst = np.abs(curve.mu / at_reference.mu - 1).max()
    print(
        "check      six curves against the one at 20 °C at v a_T, a_T as "
        "published: "
        f"{worst:.1e} at most"
    )
    assert worst < 1e-4, "mu(v, T) must be mu(v a_T) at the reference temperature"


def published_shift() -> np.ndarray:
    """a_T about the reference temperature, from the constants that the paper gives
    about -42 degC.
    """

    def log10_a(celsius: float | np.ndarray) -> float | np.ndarray:
        return -13.2 * (celsius + 42.0) / (39.7 + celsius + 42.0)

    return 10 ** (log10_a(CELSIUS) - log10_a(REFERENCE))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
