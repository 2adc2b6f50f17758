"""26: four models beside each other on one rough surface: Multiscale, Persson, three
dimensions, the MDR line.

Teaches: `model=` chooses with what a surface under a pressure is computed, and
`curve.plot(ax)` lays one curve over another. `em.Multiscale()` is the default;
`em.HalfSpace()` solves random maps in three dimensions, and can, since the cutoffs are
near each other here; `em.Persson()` is the theory; `em.Line()` needs a rule that turns
pressure into a line load, the textbook's or that of full contact, and is right by
neither (`docs/rough.md`), averaged over directions here.

Inputs: the synthetic passenger tread at 20 degC, illustrative; a self-affine surface, H
= 0.8, rms slope 0.3, wavelengths of 5 mm to 0.4 mm; nominal pressures of 0.2 and 3 MPa;
four maps of 256 by 256 cells, four lines.

Check: at 100 MPa the rubber fills the surface, and friction is the exact sum over its
waves, mu p = (1/2) int q^3 C dq int cos(phi) E''(q v cos(phi)) dphi, here by quadrature
of the material's loss modulus: the first three models must meet it. In partial contact
Multiscale must lie within a tenth of three dimensions.

    python examples/26_models_beside_each_other.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad

import elastomdr as em

# what the line misses on a wide spectrum: docs/rough.md
warnings.simplefilter("ignore", em.ModelWarning)
TREAD = em.load_material("tread-passenger-synthetic")
ROAD = em.SelfAffine(
    0.8, rms_slope=0.3, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 0.4e-3
)
KELVIN, PRESSURES, FILLED = 293.15, (2e5, 3e6), 1e8  # K, Pa, Pa
VELOCITY, FEW = np.geomspace(1e-4, 1.0, 33), np.geomspace(1e-4, 1.0, 7)  # m/s
MODELS = {
    "Multiscale, the default": (em.Multiscale(), {"color": "#1f5a94"}),
    "Persson's theory": (em.Persson(), {"color": "#222222", "linestyle": "--"}),
    "three dimensions": (em.HalfSpace(cells=256, seeds=4), {"color": "#a03030"}),
    "line, rule of full contact": (
        em.Line(average=True, equivalent_length="full contact", seeds=4),
        {"color": "#3a8a4d"},
    ),
    "line, textbook's rule": (
        em.Line(average=True, seeds=4),
        {"color": "#3a8a4d", "linestyle": ":"},
    ),
}


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, panels = plt.subplots(1, 2, figsize=(8.6, 4.0))
    for ax, pressure in zip(panels, PRESSURES, strict=True):
        found = {}
        for name, (model, style) in MODELS.items():
            velocity = VELOCITY if name in list(MODELS)[:2] else FEW
            curve = found[name] = em.friction(
                TREAD,
                ROAD,
                velocity=velocity,
                pressure=pressure,
                temperature=KELVIN,
                model=model,
                rtol=1e-3,
            )
            if isinstance(model, em.HalfSpace):
                ax.errorbar(
                    velocity,
                    curve.mu,
                    curve.error,
                    fmt="o",
                    capsize=3,
                    zorder=4,
                    label=name,
                    **style,
                )
                continue
            ax.semilogx(velocity, curve.mu, label=name, **style)
            if isinstance(model, em.Multiscale):
                whole = curve.error + np.nan_to_num(curve.model_error)
                ax.fill_between(
                    velocity,
                    curve.mu - whole,
                    curve.mu + whole,
                    alpha=0.16,
                    linewidth=0,
                    **style,
                )
        area = found["three dimensions"].area_ratio
        ax.set_title(
            f"{1e-6 * pressure:g} MPa, real contact {area.min():.0%} to "
            f"{area.max():.0%}"
        )
        ax.set(
            xlabel="Sliding velocity [m/s]",
            ylabel="Friction coefficient [-]",
            xscale="log",
            ylim=(0, None),
        )
        three, fine = found["three dimensions"], found["Multiscale, the default"]
        apart = np.interp(np.log(FEW), np.log(VELOCITY), fine.mu) / three.mu - 1
        print(
            f"{1e-6 * pressure:g} MPa: Multiscale over three dimensions "
            f"{apart.min():+.1%} to {apart.max():+.1%}"
        )
        assert np.abs(apart).max() < 0.1, (
            "Multiscale must lie within a tenth of three dimensions"
        )
    panels[0].legend(loc="upper left")
    figure.savefig(out / "26_models_beside_each_other.png")
    plt.close(figure)
    check()


def check() -> None:
    """Full contact."""
    foundation, a = em.half_space(TREAD), float(TREAD.shift.a(KELVIN))
    for speed in (1e-4, 1.0):

        def wave(log_q: float, speed: float = speed) -> float:
            q = np.exp(log_q)
            # a quarter of the circle, midpoints
            phi = np.pi / 400 * (np.arange(200) + 0.5)
            loss = foundation.complex_modulus(q * speed * a * np.cos(phi)).imag
            return (
                0.5
                * q**4
                * float(ROAD.at(np.array([q]))[0])
                * 4
                * np.pi
                / 400
                * float(np.cos(phi) @ loss)
            )

        full = (
            quad(wave, np.log(ROAD.q_low), np.log(ROAD.q_high), epsrel=1e-6, limit=200)[
                0
            ]
            / FILLED
        )
        for name, (model, _) in list(MODELS.items())[:3]:
            mu = em.friction(
                TREAD,
                ROAD,
                velocity=speed,
                pressure=FILLED,
                temperature=KELVIN,
                model=model,
            ).mu
            print(f"check  full contact, {speed:g} m/s: {full:.6e}, {name} {mu:.6e}")
            assert np.isclose(mu, full, rtol=1e-3), (
                f"{name} must meet the sum over all waves"
            )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    # a minute in all: a bar on a terminal
    with em.progress("solving four models"):
        main(parser.parse_args().out)
