"""09: pressed in twice: unloading, recovery, and contact with a surface that has not
recovered.

Teaches: `em.indent` with a depth; that the second loop is not the first; the imprint a
contact leaves behind; the energy account (`work`, `stored`, `locked`, `dissipated`).

Inputs: a synthetic standard solid, E_inf = 1 MPa, E_1 = 3 MPa, tau = 0.5 s (moduli
E* of the half-space). Ball of 10 mm radius, 0.1 mm deep, 1 s down and 1 s up: chosen
here.

Check: Ting's solution of the first unloading. Contact is lost at t_1 + 1 s where int
E(t-s) d'(s) ds = 0, and the force while it shrinks is 2 int_0^t1 E(t-s) d'(s) a(s) ds
(Ting 1966).

    python examples/09_press_twice.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad

import elastomdr as em

RADIUS, DEPTH = 10e-3, 1e-4  # m
RELAXED, BRANCH, TAU = 1e6, 3e6, 0.5  # Pa, Pa, s


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    rubber, ball = em.Foundation(RELAXED, [BRANCH], [TAU]), em.Paraboloid(RADIUS)
    time = np.linspace(0.0, 4.5, 181)
    depth = DEPTH * np.interp(time, [0, 1, 2, 2.5, 3.5, 4.5], [0, 1, 0, 0, 1, 0])
    twice = em.indent(rubber, ball, time=time, depth=depth)
    print(twice.summary())

    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    first = time <= 2.0
    left.plot(1e3 * depth[first], twice.force[first], label="first time")
    left.plot(1e3 * depth[~first], twice.force[~first], label="second time")
    left.set(xlabel="Depth [mm]", ylabel="Force [N]", title="Force against depth")
    r = np.linspace(0, 2e-3, 121)
    for t in (1.0, 1.6, 2.0, 2.5):
        right.plot(1e3 * r, -1e3 * twice.displacement(r, t), label=f"at {t:g} s")
    right.set(
        xlabel="Radius [mm]",
        ylabel="Height of the surface [mm]",
        title="The imprint recovers",
    )
    for ax in (left, right):
        ax.legend()
    figure.savefig(out / "09_press_twice.png")
    plt.close(figure)

    at = int(np.argmin(np.abs(time - 1.25)))
    exact = ting(time[at])
    print(
        f"check     force at {time[at]:g} s: {twice.force[at]:.12g} N, Ting "
        f"{exact:.12g} N"
    )
    assert np.isclose(twice.force[at], exact, rtol=1e-9), (
        "unloading must meet Ting's solution"
    )


def ting(t: float) -> float:
    """Force on the way back, from t = 1 s on: elements touched before t_1 are still in
    contact.
    """
    back = quad(lambda s: relaxation(t - s), 1.0, t)[0]
    low, high = 0.0, 1.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (
            (middle, high)
            if quad(lambda s: relaxation(t - s), middle, 1.0)[0] > back
            else (low, middle)
        )
    rate = DEPTH  # per second
    return (
        2
        * quad(
            lambda x: relaxation(t - x**2) * rate * np.sqrt(RADIUS * rate) * x * 2 * x,
            0,
            np.sqrt(low),
        )[0]
    )


def relaxation(t: float) -> float:
    return RELAXED + BRANCH * np.exp(-t / TAU)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
