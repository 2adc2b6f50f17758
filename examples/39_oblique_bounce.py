"""39: a ball that bounces obliquely: a scene of its own in twenty lines.

Teaches: `em.elements.MovingBody` puts a body of any surface on a row of elements; depth
and place are unknowns of one `diffrax.diffeqsolve`, whose `Event` ends the contact.
Rubber takes from the speed across the surface what it takes from the motion along it,
without any friction between the surfaces.

Inputs: a standard solid, E* = 1.2 MPa relaxed, 4 MPa glassy, tau = 2 ms; a ball of
10 mm radius and 5 g at 1 m/s, at five angles.

Check: straight down the ball bounces as by `em.impact`, which marches no elements; and
what it loses is the work of the contact.

    python examples/39_oblique_bounce.py [--out DIR]
"""

import argparse
from pathlib import Path

import diffrax
import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.Foundation(1.2e6, [2.8e6], [2e-3])
RADIUS, MASS, SPEED = 10e-3, 5e-3, 1.0  # m, kg, m/s
ANGLES = np.radians([0, 20, 40, 60, 75])  # from the normal
LENGTH, COUNT = 8e-3, 320  # of the row of elements [m]


def bounce(angle: jax.Array) -> diffrax.Solution:
    """The ball from first touch to the end of contact."""
    x = LENGTH * ((jnp.arange(COUNT) + 0.5) / COUNT - 0.5)
    ball = em.elements.MovingBody(
        MASS,
        surface=lambda place: -((x - place) ** 2) / RADIUS,
        spacing=LENGTH / COUNT,
        tangential=em.Mount(MASS),
    )
    start = ball.start(
        RUBBER, sinking=SPEED * jnp.cos(angle), velocity=SPEED * jnp.sin(angle)
    )
    lost = diffrax.Event(
        lambda t, y, args, **_: (y.sinking < 0) & (jnp.max(y.line.q) <= 0)
    )
    step = em.elements.ContactStep(4)
    return diffrax.diffeqsolve(ball, step, 0.0, 8e-3, 4e-5, start, RUBBER, event=lost)


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    with jax.enable_x64(True):
        ends = jax.jit(jax.vmap(lambda angle: bounce(angle).ys))(ANGLES)
    down, along, work = (
        np.asarray(x)[:, 0] for x in (ends.sinking, ends.velocity, ends.work)
    )

    figure, ax = plt.subplots(figsize=(6.4, 4.4))
    for i, angle in enumerate(ANGLES):
        colour = f"C{i}"
        inward = -np.sin(angle), np.cos(angle)
        ax.plot([inward[0], 0], [inward[1], 0], color=colour, lw=1.5, ls="--")
        label = f"{np.degrees(angle):.0f}° in, "
        label += f"{abs(np.degrees(np.arctan2(along[i], -down[i]))):.0f}° out"
        ax.plot([0, along[i]], [0, -down[i]], "o-", color=colour, label=label)
    ax.axhline(0, color="0.3", lw=1)
    ax.set(
        xlabel="Along the rubber [m/s]",
        ylabel="Away from the rubber [m/s]",
        xlim=(-1.05, 1.05),
        ylim=(0, 1.08),
    )
    ax.set_title("Velocity before (dashed) and after a bounce on the MDR line")
    ax.legend(loc="upper right")
    figure.savefig(out / "39_oblique_bounce.png")
    plt.close(figure)

    exact = em.impact(RUBBER, em.Paraboloid(RADIUS), mass=MASS, velocity=SPEED)
    print(
        f"straight down {-down[0]:.4f} of the speed, em.impact {exact.restitution:.4f}"
    )
    assert np.isclose(-down[0], exact.restitution, rtol=2e-3)
    lost = 0.5 * MASS * (SPEED**2 - down**2 - along**2)
    print("lost / work of the contact:", np.round(lost / work, 4))
    np.testing.assert_allclose(lost, work, rtol=5e-3)
    assert (np.diff(along / np.sin(np.maximum(ANGLES, 1e-9)))[1:] > 0).all()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
