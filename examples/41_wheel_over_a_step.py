"""41: a wheel over a step in the rubber, slow and fast.

Teaches: what lies under a `MovingBody` needs no class: its surface is one function of
its place, here that of a wheel less the rubber's step. The body has a mass, a load and
a damper; its place is given.

Inputs: a standard solid, E* = 2 MPa relaxed, 10 MPa glassy, tau = 5 ms; a wheel of 20 mm
radius and 0.3 kg, pressed on with 5 N, over a step of 0.5 mm, 3 mm long, at three
velocities; 20 N s/m beside the load.

Check: the wheel ends higher by the step, and what drive and load gave is in its motion,
in the damper or in the work of the contact.

    python examples/41_wheel_over_a_step.py [--out DIR]
"""

import argparse
from pathlib import Path

import diffrax
import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.Foundation(2e6, [8e6], [5e-3])
RADIUS, MASS, LOAD, DAMPER = 20e-3, 0.3, 5.0, 20.0  # m, kg, N, N s/m
STEP, WIDE = 0.5e-3, 1e-3  # height, and length scale of the step [m]
FROM, TO, COUNT = -16e-3, 16e-3, 640  # of the row of elements [m]
PATH = 20e-3  # m
SPEEDS = np.array([0.02, 0.2, 1.0])  # m/s


def ride(speed: jax.Array) -> tuple[jax.Array, ...]:
    """Place, height and normal force of the wheel, and the energy that is missing."""
    spacing = (TO - FROM) / COUNT
    x = FROM + spacing * (jnp.arange(COUNT) + 0.5)
    ground = STEP / (1 + jnp.exp(-4 * x / WIDE))
    wheel = em.elements.MovingBody(
        MASS,
        damper=DAMPER,
        load=LOAD,
        surface=lambda place: ground - (x - place) ** 2 / RADIUS,
        spacing=spacing,
        drive=lambda t: speed * t - PATH / 2,
    )
    end = PATH / speed
    y = diffrax.diffeqsolve(
        wheel,
        em.elements.ContactStep(8),
        0.0,
        end,
        end / 400,
        wheel.start(RUBBER),
        RUBBER,
        saveat=diffrax.SaveAt(ts=jnp.linspace(0, end, 401)),
    ).ys
    force = spacing * jnp.sum(y.line.q, axis=1)
    given = y.driven + y.pressed
    missing = given - y.work - y.damped - 0.5 * MASS * y.sinking**2
    return y.position, -y.depth, force, missing / jnp.max(jnp.abs(given))


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    with jax.enable_x64(True):
        place, height, force, missing = map(np.asarray, jax.jit(jax.vmap(ride))(SPEEDS))

    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.2, 6.0), sharex=True)
    x = np.linspace(-PATH / 2, PATH / 2, 200)
    top.plot(1e3 * x, 1e3 * STEP / (1 + np.exp(-4 * x / WIDE)), "0.6", label="rubber")
    for i, speed in enumerate(SPEEDS):
        top.plot(1e3 * place[i], 1e3 * height[i], label=f"{speed:g} m/s")
        bottom.plot(1e3 * place[i], force[i])
    top.set(ylabel="Lowest point of the wheel [mm]")
    top.set_title("Wheel over a step in rubber, bare MDR line")
    top.legend()
    bottom.set(xlabel="Place of the wheel [mm]", ylabel="Normal force [N]")
    figure.savefig(out / "41_wheel_over_a_step.png")
    plt.close(figure)

    slow = height[0]
    risen = slow[-1] - slow[100]
    print(f"at {SPEEDS[0]:g} m/s the wheel rises by {1e3 * risen:.4f} mm")
    assert np.isclose(risen, STEP, rtol=2e-2)
    print("energy that is missing:", np.abs(missing).max(axis=1))
    assert np.abs(missing).max() < 2e-2


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
