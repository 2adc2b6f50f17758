"""26: Persson's theory and the MDR line on one figure, for a tread on a rough road.

Teaches: `em.reference.persson` gives mu(v) and the share of real contact by a theory that shares nothing with the line
but material and spectrum. The line needs a rule that turns pressure into a line load (`docs/rough.md`): the textbook's,
for light contact, or that of full contact. Under the second it stays 10 to 25 % below the sum over all waves even where
the rubber fills the road.

Inputs: the synthetic passenger tread at 20 degC; a self-affine road, H = 0.8, rms slope 0.3, wavelengths of 5 mm to
0.2 mm; nominal pressures of 0.3 and 50 MPa, the second to come near full contact. gamma = 1/2, S in mu alone.

Check: at the high pressure there is the sum over waves of the theory of full contact,
mu p = (1/2) int q^3 C dq int cos(phi) E''(q v cos(phi)) dphi, here by quadrature of the material's loss modulus. The
theory is that times P S, which its share of contact bounds; the line is 0.6 to 1 of it, as against three dimensions.

    python examples/26_persson_beside_the_line.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad

import elastomdr as em

TREAD = em.load_material("tread-passenger-synthetic")
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 0.2e-3)
KELVIN, LIGHT, FULL = 293.15, 3e5, 5e7  # K, Pa, Pa
RULES = {"textbook's rule": None, "rule of full contact": "full contact"}


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    velocity = np.geomspace(1e-4, 1.0, 9)
    figure, panels = plt.subplots(1, 2, figsize=(9.6, 4.4), layout="constrained")
    for ax, pressure in zip(panels, (LIGHT, FULL), strict=True):
        asked = {"velocity": velocity, "pressure": pressure, "temperature": KELVIN}
        theory = em.reference.persson(TREAD, ROAD, **asked)
        ax.semilogx(velocity, theory.mu, color="#222222", label="Persson's theory")
        for (name, rule), color in zip(RULES.items(), ("#1f5a94", "#a03030"), strict=True):
            line = em.friction(TREAD, ROAD, equivalent_length=rule, **asked)
            ax.errorbar(velocity, line.mu, line.error, color=color, label=f"MDR line, {name}")
        area = theory.area_ratio
        ax.set_title(f"{1e-6 * pressure:g} MPa, real contact {area.min():.1%} to {area.max():.1%}", fontsize=10)
        ax.set(xlabel="Sliding velocity [m/s]", ylabel="Friction coefficient [-]", ylim=(0, None))
        ax.grid(color="#dddddd")
        ax.legend(frameon=False)
        print(theory.summary())
    figure.savefig(out / "26_persson_beside_the_line.png", dpi=150)
    plt.close(figure)
    check(line, theory)


def check(line: em.FrictionCurve, theory: object) -> None:
    """Full contact, at the high pressure."""
    foundation, a = em.half_space(TREAD), float(TREAD.shift.a(KELVIN))
    for i in (0, 4, 8):
        speed = theory.velocity[i] * a

        def wave(log_q: float, speed: float = speed) -> float:
            q = np.exp(log_q)
            phi = np.pi / 400 * (np.arange(200) + 0.5)  # a quarter of the circle, midpoints
            loss = foundation.complex_modulus(q * speed * np.cos(phi)).imag
            return 0.5 * q**4 * float(ROAD.at(np.array([q]))[0]) * 4 * np.pi / 400 * float(np.cos(phi) @ loss)

        full = quad(wave, np.log(ROAD.q_low), np.log(ROAD.q_high), epsrel=1e-6, limit=200)[0] / FULL
        share = theory.area_ratio[i]
        assert full * share**3 * 0.9 < theory.mu[i] <= full * 1.0001, "less than full contact, by its share"
        print(f"{theory.velocity[i]:g} m/s: full contact {full:.4g}, theory {theory.mu[i]:.4g}, line {line.mu[i]:.4g}")
        assert 0.6 < line.mu[i] / full < 1.0, "the line is where the comparison in three dimensions has it"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(), help="folder for the figure (default: this one)")
    main(parser.parse_args().out)
