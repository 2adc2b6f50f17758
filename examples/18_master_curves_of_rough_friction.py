"""18: master curves of rough friction, over temperature and over load.

Teaches: friction on a rough line depends on velocity and temperature by v a_T alone, so
that curves of all temperatures fall on one. With load there is a second rule: where
long waves and short ones matter little, each curve is that of another load, shifted
along the velocity by a power of the load and in height by another (Popov, Voll, Kusche,
Li and Rozhkova, Tribol. Int. 120 (2018) 376). The powers are fitted here, up to the
peak; beyond it, where a few peaks of the line carry all of the load, the curves part
again.

Inputs: a standard solid, E* = 4 MPa relaxed and 40 MPa glassy, tau = 0.1 ms at 20 degC,
WLF 8.86 and 101.6 K; two self-affine lines of H = 0.7, rms slope 0.1, wavelengths of
6.3 mm to 0.1 mm; bare line; 8, 16 and 32 N/m.

Check: three temperatures on one curve; a line dilated by b with its heights by b^H is
the same line at v b and load b^H, with mu b^(1-H) unchanged, exactly; up to the peak
the shifted curves are twice as close as the others.

    python examples/18_master_curves_of_rough_friction.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import least_squares

import elastomdr as em

HURST = 0.7
WLF = em.WLF(c1=8.86, c2=101.6, reference=293.15)
RUBBER = em.StandardSolid(1e6, 9e6, 1e-4, shift=WLF)
SURFACE = em.SelfAffine(HURST, rms_slope=0.1, q_low=1e3, q_high=6e4)
VELOCITY = np.geomspace(1e-2, 2.0, 13)  # times a_T [m/s]
PEAK = 0.4  # where mu is largest [m/s]
LOADS = np.array([8.0, 16.0, 32.0])  # N/m
KELVIN = np.array([278.15, 293.15, 313.15])
ASKED = {"model": em.Line(seeds=2)}


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    curves = em.friction(
        RUBBER,
        SURFACE,
        velocity=VELOCITY,
        load=LOADS[:, None],
        temperature=293.15,
        **ASKED,
    )
    velocity = VELOCITY[::3] / WLF.a(KELVIN)[:, None]
    warm = em.friction(
        RUBBER,
        SURFACE,
        velocity=velocity,
        load=16.0,
        temperature=KELVIN[:, None],
        **ASKED,
    )
    along, up = powers(curves.mu)

    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8), sharey=True)
    for i, (load, colour) in enumerate(
        zip(LOADS, ("#8bb4d9", "#1f5a94", "#0b2540"), strict=True)
    ):
        left.loglog(VELOCITY, curves.mu[i], color=colour, label=f"{load:g} N/m, 20 °C")
        shift = LOADS[1] / load
        right.loglog(
            VELOCITY * shift**along,
            curves.mu[i] * shift**up,
            color=colour,
            label=f"{load:g} N/m",
        )
    for row, kelvin, mark in zip(warm.mu, KELVIN, "vo^", strict=True):
        left.loglog(
            VELOCITY[::3],
            row,
            mark,
            color="#a03030",
            fillstyle="none",
            label=f"16 N/m, {kelvin - 273.15:g} °C",
        )
    left.set(
        xlabel=r"Velocity times shift factor, v $a_T$ [m/s]",
        ylabel="Friction coefficient [-]",
    )
    left.set_title("Three temperatures on one curve, three loads")
    right.set(xlabel=rf"v $a_T\,(16\,$N/m / load$)^{{{along:.2f}}}$ [m/s]")
    right.set_title(rf"Loads shifted, mu $(16\,$N/m / load$)^{{{up:.2f}}}$")
    for ax in (left, right):
        ax.legend()
    figure.savefig(out / "18_master_curves_of_rough_friction.png")
    plt.close(figure)

    check(curves.mu, warm.mu, along, up)


def misfit(mu: np.ndarray, along: float, up: float) -> np.ndarray:
    """log of each curve, shifted, over that at the middle load, where the two overlap,
    up to the peak.
    """
    x, y = np.log(VELOCITY), np.log(mu)
    gaps = []
    for i in (0, 2):
        shift = np.log(LOADS[1] / LOADS[i])
        gap = np.interp(x, x + along * shift, y[i] + up * shift) - y[1]
        inside = np.clip((x - x[0] - along * shift) / 0.2, 0, 1) * np.clip(
            (x[-1] + along * shift - x) / 0.2, 0, 1
        )
        gaps.append(np.where(VELOCITY <= PEAK, gap, 0.0) * inside)
    return np.concatenate(gaps)


def powers(mu: np.ndarray) -> tuple[float, float]:
    """Powers of the load by which the curves are shifted along the velocity and in
    height.
    """
    along, up = least_squares(lambda p: misfit(mu, *p), (0.3, 0.1), diff_step=1e-3).x
    return float(along), float(up)


def check(mu: np.ndarray, warm: np.ndarray, along: float, up: float) -> None:
    assert np.allclose(warm, mu[1, ::3], rtol=1e-6), (
        "curves of all temperatures must be one in v a_T"
    )
    before, after = (
        np.sqrt(np.mean(misfit(mu, *p) ** 2)) for p in ((0.0, 0.0), (along, up))
    )
    print(
        f"loads shifted by powers {along:.3f} (velocity) and {up:.3f} (mu): "
        f"{after:.1%} rms apart, before {before:.1%}"
    )
    line = em.RoughLine(np.arange(512) * 1e-5, rough_heights())
    wide = em.RoughLine(3 * np.arange(512) * 1e-5, 3**HURST * rough_heights())
    for load in (1.0, 4.0):
        one = em.friction(RUBBER, line, velocity=1.0, load=load, model=em.Line()).mu
        other = em.friction(
            RUBBER, wide, velocity=3.0, load=load * 3**HURST, model=em.Line()
        ).mu
        assert np.isclose(other * 3 ** (1 - HURST), one, rtol=1e-6), (
            "a dilated line is the same one"
        )
    assert after < 0.5 * before, (
        "up to the peak the curves of three loads must nearly be one"
    )


def rough_heights() -> np.ndarray:
    wave = np.arange(1, 33)
    phase = np.random.default_rng(0).uniform(0, 2 * np.pi, 32)
    x = 2 * np.pi * np.arange(512) / 512
    return 1e-5 * (
        wave ** -(HURST + 0.5) @ np.cos(np.multiply.outer(wave, x) + phase[:, None])
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
