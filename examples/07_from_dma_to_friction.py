"""From DMA isotherms to a friction curve, with what the laboratory's noise does to it.

Teaches: `em.fit.material`, its warnings and intervals, and that a fitted material goes
into `em.friction` like any other.

Inputs: isotherms made here from `sbr-gum-like` of the library, with 1 % noise, as a
rheometer would give them from -20 to 60 degC; ball of 5 mm radius, 1 N. With a file of
your own: dma = em.read_dma("DMA.csv").

Check: shift factors against the law that made the data, within three standard
deviations; friction within 3 %.

    python examples/07_from_dma_to_friction.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

KELVIN = np.arange(253.15, 334.0, 10.0)
REFERENCE = 293.15


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)

    sample = em.load_material("sbr-gum-like")
    fit = em.fit.material(
        measure(sample), REFERENCE, name="sample", citation="Made in examples/07"
    )
    print(fit.summary())

    # m, m/s; within the range of the data
    ball, velocity = em.Sphere(5e-3), np.geomspace(1e-4, 1.0, 32)
    true, fitted = (
        em.friction(
            rubber, ball, velocity=velocity, load=1.0, temperature=REFERENCE, rtol=1e-4
        )
        for rubber in (sample, fit.material)
    )

    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 4.8))
    fit.prony.plot(left)
    right.semilogx(velocity, true.mu, color="#222222", label="sample")
    right.semilogx(
        velocity, fitted.mu, "--", color="#b03a2e", label="material fitted to its DMA"
    )
    right.set(
        xlabel="Sliding velocity $v$ [m/s]",
        ylabel="Friction coefficient [-]",
        ylim=(0, None),
    )
    right.set_title("Friction of a ball, 5 mm, 1 N, 20 °C")
    right.legend()
    figure.savefig(out / "07_from_dma_to_friction.png")
    plt.close(figure)

    off = fit.master.log10_a - (
        sample.shift.log10_a(KELVIN) - sample.shift.log10_a(REFERENCE)
    )
    worst = np.abs(off / np.maximum(fit.master.log10_a_std, 1e-9))[
        KELVIN != REFERENCE
    ].max()
    friction = np.abs(fitted.mu / true.mu - 1).max()
    print(
        f"check      log10 a_T off by {worst:.1f} standard deviations at most; "
        f"friction by {100 * friction:.1f} %"
    )
    assert worst < 4, "shift factors must be within their stated uncertainty"
    assert friction < 0.03, "friction of the fitted material must be that of the sample"


def measure(sample: em.Prony) -> em.fit.Dma:
    """Storage and loss modulus at each temperature, 0.1 to 50 Hz, with 1 % noise."""
    rng = np.random.default_rng(7)
    omega = 2 * np.pi * np.geomspace(0.1, 50.0, 14)
    parts = []
    for kelvin in KELVIN:
        moduli = np.asarray(sample.at(kelvin).complex_modulus(omega))
        storage, loss = (
            part * (1 + 0.01 * rng.normal(size=omega.size))
            for part in (moduli.real, moduli.imag)
        )
        parts.append(em.fit.dma(omega, storage, loss, kelvin, kind="shear"))
    return em.fit.join(*parts)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
