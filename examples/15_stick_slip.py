"""15: a slider on a spring: steady sliding below the peak of friction, stick-slip above
it.

Teaches: `em.drive` couples a body on a mount to its contact, and takes a whole map of
driving speeds in one compiled `jax.vmap`. Rubber friction rises with speed up to a peak and
falls beyond. Pulled through a spring slower than the peak the slider settles; pulled
faster, on the falling side, it swings ever further, until it stops, or runs back, once
a cycle.

Inputs: a standard solid with E* = 1 MPa relaxed, 5 MPa glassy, tau = 2 ms; a corrugated
slider, waves of 1 mm and 50 um amplitude, pressed on with 400 N per metre of line so
that it touches everywhere, 2 kg/m on 80 kN/m/m.

Check: in full contact the memory of the rubber is one complex number s per branch, s' =
z' - s/tau with z = exp(i k X), and F_x = (1/2) A^2 k E_1 Im(conj(z) s): the same motion
by scipy's integrator, which knows no element; and the peak at v = 1/(k tau).

    python examples/15_stick_slip.py [--out DIR]
"""

import argparse
from pathlib import Path

import jax
import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import elastomdr as em

RELAXED, BRANCH, TAU = 1e6, 4e6, 2e-3  # Pa, Pa, s
LENGTH, AMPLITUDE, POINTS = 1e-3, 5e-5, 32  # of a wave [m], [m]
K = 2 * np.pi / LENGTH
LOAD, MASS, SPRING = 400.0, 2.0, 8e4  # per metre of line: N, kg, N/m
RUBBER = em.Foundation(RELAXED, [BRANCH], [TAU])
SLIDER = em.RoughLine(
    np.arange(POINTS) * LENGTH / POINTS,
    AMPLITUDE * np.cos(2 * np.pi * np.arange(POINTS) / POINTS),
)
TIME = np.linspace(0, 0.25, 251)  # s
SPEEDS = np.array([0.03, 0.06, 0.08, 0.1, 0.15, 0.22])  # m/s
PEAK = 1 / (K * TAU)


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)

    def pulled(speed: jax.Array) -> tuple[jax.Array, jax.Array]:
        drive = em.drive(
            RUBBER,
            SLIDER,
            time=TIME,
            position=speed * TIME,
            load=LOAD,
            tangential=em.Mount(MASS, SPRING),
        )
        return drive.position, drive.velocity

    with jax.enable_x64(True):
        position, velocity = (np.asarray(x) for x in jax.jit(jax.vmap(pulled))(SPEEDS))
    exact = [reduced(speed) for speed in SPEEDS]

    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.2, 6.4))
    for i, colour in ((1, "#7fb3d8"), (3, "#3a7fb5"), (4, "#123f66")):
        top.plot(
            1e3 * TIME,
            velocity[i] / SPEEDS[i],
            color=colour,
            label=f"driven at {SPEEDS[i]:g} m/s",
        )
    top.set(
        xlabel="Time [ms]",
        ylabel="Velocity of the slider / of the drive [-]",
        xlim=(0, 250),
        ylim=(-0.8, 3.2),
    )
    top.set_title(
        "Corrugated slider on a spring, 400 N/m, bare MDR line in full contact"
    )
    late = TIME > 0.17
    for name, value in (("largest", np.max), ("least", np.min)):
        ends = [value(v[late]) / s for v, s in zip(velocity, SPEEDS, strict=True)]
        known = [value(y[1][late]) / s for y, s in zip(exact, SPEEDS, strict=True)]
        colour = "#a03030" if name == "largest" else "#1f5a94"
        bottom.plot(SPEEDS, ends, color=colour, label=f"{name}, em.drive")
        bottom.plot(
            SPEEDS,
            known,
            "o",
            color=colour,
            markerfacecolor="none",
            label=f"{name}, reduced equations",
        )
    bottom.axvline(
        PEAK,
        color="#888888",
        linestyle="--",
        linewidth=1,
        label="peak of the steady friction",
    )
    bottom.set(
        xlabel="Driving speed [m/s]",
        ylabel="Velocity after 0.17 s / of the drive [-]",
        xlim=(0, 0.23),
    )
    for ax in (top, bottom):
        ax.legend(ncols=3 if ax is top else 1)
    figure.savefig(out / "15_stick_slip.png")
    plt.close(figure)

    swing = np.array(
        [np.ptp(v[late]) / s for v, s in zip(velocity, SPEEDS, strict=True)]
    )
    for i, speed in enumerate(SPEEDS):
        off = np.abs(position[i] - exact[i][0]).max() / np.ptp(
            position[i] - speed * TIME
        )
        print(
            f"{speed:5.2f} m/s: swing {swing[i]:.3f} of the speed; off the reduced "
            f"equations by {off:.1e}"
        )
        assert off < 1e-2, "the engine must follow the reduced equations"
    assert (
        swing[SPEEDS < 0.8 * PEAK].max() < 0.1 < 1 < swing[SPEEDS > 1.5 * PEAK].min()
    ), "stick-slip above the peak"


def reduced(speed: float) -> np.ndarray:
    """X and X' of the slider, with one complex memory for all elements in full
    contact.
    """

    def rates(t: float, y: np.ndarray) -> list[float]:
        place, velocity, real, imaginary = y
        z, s = np.exp(1j * K * place), real + 1j * imaginary
        change = 1j * K * velocity * z - s / TAU
        drag = 0.5 * AMPLITUDE**2 * K * BRANCH * (np.conj(z) * s).imag
        return [
            velocity,
            (SPRING * (speed * t - place) - drag) / MASS,
            change.real,
            change.imag,
        ]

    start = [0.0, 0.0, 1.0, 0.0]  # put down at once: glassy
    return solve_ivp(
        rates, (0, TIME[-1]), start, "DOP853", t_eval=TIME, rtol=1e-9, atol=1e-12
    ).y


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
