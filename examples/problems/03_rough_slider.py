"""Problem 3: a rough slider starts from rest: the break-out friction that a long stand
costs.

Teaches: `em.slide` with an `em.RoughLine`. Rubber that has relaxed under the slider's
waves must be dented anew.

Inputs: chosen here: two waves, 2 mm and 0.5 mm long, amplitudes of 60 and 12 um,
pressed so hard that all is in contact; E* = 1 MPa relaxed, branches of 2 MPa at 0.5 ms
and 2 MPa at 5 ms; at rest for 0.5 ms or 50 ms, then drawn at 0.3 m/s.

Check: in full contact each wave k and branch E_j adds (1/2) A^2 k E_j Im[w +
(e^(-rest/tau) - w) e^(-(i k v + 1/tau) t)] to the force per length, w = i k v tau/(1 +
i k v tau): memory of the rest, then of the way. Its end is (1/2) A^2 k E''(k v). The
march is asked for 1e-3 of the largest mu, and its estimate may be off by a factor:
3e-3.

    python examples/problems/03_rough_slider.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

PERIOD, POINTS, LOAD, V = 2e-3, 64, 450.0, 0.3  # m, -, N/m, m/s
# 1/m, m
K, AMPLITUDE = 2 * np.pi / PERIOD * np.array([[1], [4]]), np.array([[60e-6], [12e-6]])
MODULI, TIMES = np.array([2e6, 2e6]), np.array([5e-4, 5e-3])  # Pa, s
RUBBER = em.Foundation(1e6, MODULI, TIMES)
X = np.arange(POINTS) * PERIOD / POINTS
SLIDER = em.RoughLine(X, (AMPLITUDE * np.cos(K * X)).sum(axis=0))


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    # m; then axes for waves and branches
    way = np.linspace(0, 6e-3, 121)[:, None, None]
    turn = 1j * K * V * TIMES
    steady = turn / (1 + turn)

    figure, ax = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    worst = []
    for rest, colour in ((5e-4, "#7fa7cc"), (5e-2, "#1f5a94")):
        time, position = (
            np.append(0.0, rest + way.ravel() / V),
            np.append(0.0, way.ravel()),
        )
        mu = em.slide(RUBBER, SLIDER, time=time, position=position, load=LOAD).mu[1:]
        memory = steady + (np.exp(-rest / TIMES) - steady) * np.exp(
            -(1j * K + 1 / (V * TIMES)) * way
        )
        exact = (0.5 * AMPLITUDE**2 * K * MODULI * memory.imag).sum(axis=(1, 2)) / LOAD
        ax.plot(
            1e3 * way.ravel(),
            mu,
            color=colour,
            label=f"em.slide, {1e3 * rest:g} ms at rest",
        )
        ax.plot(
            1e3 * way.ravel()[::4],
            exact[::4],
            "o",
            color="#a03030",
            fillstyle="none",
            markersize=4,
        )
        worst.append(np.abs(mu - exact).max() / exact.max())
    ax.plot(
        [],
        [],
        "o",
        color="#a03030",
        fillstyle="none",
        markersize=4,
        label="closed form",
    )
    end = (0.5 * AMPLITUDE**2 * K * RUBBER.loss(K * V)).sum() / LOAD
    ax.axhline(
        end,
        color="#888888",
        linestyle="--",
        linewidth=1,
        label="steady, from the loss modulus",
    )
    ax.set(xlabel="Way [mm]", ylabel="Friction coefficient [-]", ylim=(0, None))
    ax.set_title(
        "Two waves in full contact, started at 0.3 m/s, bare MDR line", fontsize=10
    )
    ax.legend(frameon=False)
    ax.grid(color="#dddddd")
    figure.savefig(out / "03_rough_slider.png", dpi=150)
    plt.close(figure)

    print(
        f"check  off the closed form by {max(worst):.1e} of the peak; end "
        f"{mu[-1]:.5f}, steady {end:.5f}"
    )
    assert max(worst) < 3e-3, "the start must meet the closed form"
    assert abs(mu[-1] / end - 1) < 0.02, (
        "and end in steady sliding: e^-4 of the slow branch is left after 20 ms"
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
