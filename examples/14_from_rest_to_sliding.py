"""14: from rest to steady sliding.

Teaches: friction has a history. A ball that has rested on rubber has sunk in; to start,
it has to climb out of its own dent, and the friction coefficient passes a peak that
grows with the time of rest. A jump of velocity is answered within about one contact
length. `em.slide` follows any such history, and ends where `em.friction` begins.

Inputs: a standard solid with E* = 4 MPa relaxed, 16 MPa glassy, tau = 10 ms; a
paraboloid of R = 10 mm under 10 N, at rest for 0.1 ms, 5 ms and 100 ms, then drawn at
0.5 m/s.

Check: steady sliding on the line in closed form, q R = E_inf (a^2 - x^2) + 2 E_1 s [(x
+ s) - (a + s) e^(-(a - x)/s)] with s = v tau, up to q = 0, forces by quadrature:
em.friction(..., model=em.Line()) and the end of each curve are held against it. The
work done on the rubber over the last stretch is the friction force times its length,
part of it still stored in the track that recovers.

    python examples/14_from_rest_to_sliding.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

import elastomdr as em

RELAXED, BRANCH, TAU, RADIUS = 4e6, 12e6, 1e-2, 0.01  # Pa, Pa, s, m
RUBBER, BALL = em.Foundation(RELAXED, [BRANCH], [TAU]), em.Paraboloid(RADIUS)
LOAD, VELOCITY, WAY = 10.0, 0.5, 16e-3  # N, m/s, m
RESTS = (1e-4, 5e-3, 0.1)  # s


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    steady = em.friction(RUBBER, BALL, velocity=VELOCITY, load=LOAD, model=em.Line())
    way = np.linspace(0, WAY, 97)

    figure, ax = plt.subplots(figsize=(7.2, 4.2))
    slides = []
    for rest, colour in zip(RESTS, ("#7fb3d8", "#3a7fb5", "#123f66"), strict=True):
        time = np.concatenate([[0.0], rest + way / VELOCITY])
        position = np.concatenate([[0.0], way])
        slides.append(
            em.slide(RUBBER, BALL, time=time, position=position, load=LOAD, rtol=3e-3)
        )
        ax.plot(
            1e3 * way,
            slides[-1].mu[1:],
            color=colour,
            label=f"after {1e3 * rest:g} ms at rest",
        )
    ax.axhline(
        steady.mu,
        color="#a03030",
        linestyle="--",
        linewidth=1,
        label="steady: em.friction, bare line",
    )
    ax.set(xlabel="Way [mm]", ylabel="Friction coefficient [-]", ylim=(0, None))
    ax.set_title(
        "Paraboloid of 10 mm radius under 10 N, started at 0.5 m/s, bare MDR line"
    )
    ax.legend()
    figure.savefig(out / "14_from_rest_to_sliding.png")
    plt.close(figure)

    check(slides, steady)


def closed_form() -> float:
    """Friction coefficient of steady sliding: contact from x = a, where the rubber is
    met, to where q is zero.
    """
    s = VELOCITY * TAU

    def pressure(x: float, a: float) -> float:
        memory = (x + s) - (a + s) * np.exp(-(a - x) / s)
        return (RELAXED * (a**2 - x**2) + 2 * BRANCH * s * memory) / RADIUS

    # int q (2 x/R)^of dx: the load, and the friction force
    def force(a: float, of: float) -> float:
        end = brentq(pressure, -a, a * (1 - 1e-6), args=(a,), xtol=1e-16)
        return quad(
            lambda x: pressure(x, a) * (2 * x / RADIUS) ** of, end, a, epsrel=1e-11
        )[0]

    a = brentq(lambda a: force(a, 0) - LOAD, 1e-4, 1e-2, xtol=1e-15)
    return force(a, 1) / LOAD


def check(slides: list[em.Slide], steady: em.FrictionCurve) -> None:
    expected = closed_form()
    print(f"check     steady mu {float(steady.mu):.7f}, closed form {expected:.7f}")
    assert abs(steady.mu / expected - 1) < 2e-6, "steady sliding in closed form"
    for rest, slide in zip(RESTS, slides, strict=True):
        peak, end = slide.mu.max(), slide.mu[-1]
        print(
            f"rest {rest:7.4f} s: peak mu {peak:.4f}, end {end:.5f}, steady "
            f"{expected:.5f}"
        )
        assert slide.converged.all(), "every instant must converge"
        assert abs(end / expected - 1) < 5e-3, "every start must end in steady sliding"
        done = slide.work[-1] - slide.work[-13]
        gone = slide.position[-1] - slide.position[-13]
        assert abs(done / (steady.friction_force * gone) - 1) < 1e-2, (
            "the work is that of the friction force"
        )
    peaks = [slide.mu.max() for slide in slides]
    assert peaks[0] < peaks[1] < peaks[2], "the longer the rest, the higher the peak"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
