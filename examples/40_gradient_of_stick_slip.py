"""40: the gradient of the mean friction of a slider in stick-slip, by a modulus.

Teaches: a slider on a spring over a sinusoid is a `MovingBody` whose surface is a
function of its place, and `jax.jvp` goes through the whole motion, stick and slip, with
`diffrax.ForwardMode`.

Inputs: E* = 1 MPa relaxed, 5 MPa glassy, tau = 2 ms; waves of 1 mm and 50 um amplitude,
pressed on with 400 N per metre of line, so that they touch everywhere; 2 kg/m pulled
through 80 kN/m/m.

Check: driven slowly, the slider settles at the closed form A^2 k E''(k v)/2 of full
contact; in stick-slip the gradient is the difference of two motions.

    python examples/40_gradient_of_stick_slip.py [--out DIR]
"""

import argparse
from pathlib import Path

import diffrax
import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RELAXED, BRANCH, TAU = 1e6, 4e6, 2e-3  # Pa, Pa, s
WAVE, AMPLITUDE, COUNT = 1e-3, 5e-5, 32  # m, m, elements of a wave
K = 2 * np.pi / WAVE
LOAD, MASS, SPRING = 400.0, 2.0, 8e4  # per metre of line
TIME = np.linspace(0, 0.2, 201)  # s
SLOW, FAST = 0.05, 0.15  # m/s


def motion(branch: jax.Array, speed: float) -> tuple[jax.Array, jax.Array]:
    """Velocity of the slider and pull of the spring over the load, in time."""
    law = em.Foundation(RELAXED, [branch], [TAU])
    x = jnp.arange(COUNT) * WAVE / COUNT
    slider = em.elements.MovingBody(
        None,
        load=LOAD,
        surface=lambda place: AMPLITUDE * (jnp.cos(K * (x - place)) - 1),
        spacing=1 / COUNT,
        tangential=em.Mount(MASS, SPRING),
        drive=lambda t: speed * t,
    )
    y = diffrax.diffeqsolve(
        slider,
        em.elements.ContactStep(16),
        0.0,
        TIME[-1],
        TIME[1],
        slider.start(law),
        law,
        saveat=diffrax.SaveAt(ts=TIME),
        max_steps=TIME.size,
        adjoint=diffrax.ForwardMode(),
    ).ys
    return y.velocity, SPRING * (speed * TIME - y.position) / LOAD


@jax.jit
@jax.vmap
def along(branch: jax.Array, speed: jax.Array) -> tuple[tuple, tuple]:
    """`motion`, and its derivative by the modulus."""
    return jax.jvp(lambda e: motion(e, speed), (branch,), (jnp.ones(()),))


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    moduli = np.linspace(0.8, 1.2, 5) * BRANCH
    step = 1e-4 * BRANCH
    branch = np.array([BRANCH, *moduli, BRANCH - step, BRANCH + step])
    with jax.enable_x64(True):
        every = along(branch, np.where(np.arange(branch.size) == 0, SLOW, FAST))
        (velocity, pull), (_, change) = jax.tree.map(np.asarray, every)
    late = TIME > 0.1
    mean, slope = pull[:, late].mean(axis=1), change[1:6, late].mean(axis=1)
    mu, difference = mean[1:6], (mean[7] - mean[6]) / (2 * step)
    histories = [(velocity[i], pull[i]) for i in (0, 3)]

    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.2, 6.4))
    for (velocity, _), speed in zip(histories, (SLOW, FAST), strict=True):
        top.plot(1e3 * TIME, velocity / speed, label=f"driven at {speed:g} m/s")
    top.set(
        xlabel="Time [ms]",
        ylabel="Velocity of the slider / of the drive [-]",
        xlim=(0, 200),
    )
    top.set_title("Slider on a spring over a sinusoid, bare MDR line")
    top.legend()
    bottom.plot(1e-6 * moduli, mu, "o", label=f"mean friction at {FAST:g} m/s")
    near = 0.06 * BRANCH * np.array([-1, 1])
    for e, m, s in zip(moduli, mu, slope, strict=True):
        bottom.plot(1e-6 * (e + near), m + s * near, color="C1")
    bottom.plot([], [], color="C1", label="slope by jax.jvp")
    bottom.set(xlabel="Modulus of the branch [MPa]", ylabel="Mean mu [-]")
    bottom.legend()
    figure.savefig(out / "40_gradient_of_stick_slip.png")
    plt.close(figure)

    rate = K * SLOW * TAU
    exact = 0.5 * AMPLITUDE**2 * K * BRANCH * rate / (1 + rate**2) / LOAD
    settled = float(np.mean(histories[0][1][TIME > 0.16]))
    print(f"driven at {SLOW:g} m/s: mu {settled:.5f}, closed form {exact:.5f}")
    assert np.isclose(settled, exact, rtol=1e-2)
    print(f"slope {slope[2]:.4e} /Pa, by differences {difference:.4e} /Pa")
    assert np.isclose(slope[2], difference, rtol=1e-3)
    assert np.ptp(histories[1][0][TIME > 0.15]) > FAST


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
