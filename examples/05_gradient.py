"""05: the gradient of friction, and which branch of the spectrum carries it at which
velocity.

Teaches: `jax.grad` goes through `em.friction`. The relative sensitivity (G_k/mu) d mu/d
G_k says what a change of one branch does: a branch that relaxes during the passage adds
loss; one too slow for that is a spring, which only stiffens the rubber, so that the
contact is smaller and the friction lower.

Inputs: `natural-rubber-like` of the library, a synthetic spectrum, at its reference
temperature of -25 degC; radius and load chosen here.

Check: a finite difference, and two facts that no solver knows of. Moduli and load
multiplied by one factor leave mu as it is, so the sensitivities to all moduli and to
the load add up to zero. At low velocity mu = v sum(G_k tau_k)/(G_inf R) (Brilliantov &
Poeschel 1998), so that the sensitivity to G_k is the share of G_k tau_k in the sum.

    python examples/05_gradient.py [--out DIR]
"""

import argparse
from pathlib import Path

import jax
import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.load_material("natural-rubber-like")
BALL, LOAD = em.Paraboloid(radius=5e-3), 1.0  # m, N
# the relaxed modulus first [Pa]
MODULI = np.array([RUBBER.equilibrium, *RUBBER.moduli])


def friction(
    moduli: np.ndarray, load: float, velocity: float
) -> tuple[jax.Array, jax.Array]:
    """mu, and the contact radius [m], which is not differentiated."""
    curve = em.friction(
        em.Prony(moduli[0], moduli[1:], RUBBER.times),
        BALL,
        velocity=velocity,
        load=load,
    )
    return curve.mu, curve.contact.leading


# The derivatives with respect to moduli and load, at many velocities in one compiled
# call.
gradient = jax.jit(
    jax.vmap(
        jax.value_and_grad(friction, argnums=(0, 1), has_aux=True),
        in_axes=(None, None, 0),
    )
)


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)

    velocity = np.geomspace(1e-7, 1e2, 40)  # m/s
    # float64 for what JAX itself handles: the arguments and the gradient
    with jax.enable_x64(True):
        (mu, radius), (by_moduli, by_load) = gradient(MODULI, LOAD, velocity)
        check_difference(velocity, by_moduli)
    mu, radius, by_moduli, by_load = map(np.asarray, (mu, radius, by_moduli, by_load))
    # d ln mu/d ln G: (velocities, moduli)
    sensitivity = by_moduli * MODULI / mu[:, None]

    draw(velocity, mu, radius, sensitivity, out / "05_gradient.png")
    for v, row in zip(velocity[::5], sensitivity[::5], strict=True):
        k = int(row[1:].argmax())
        print(
            f"v = {v:8.1e} m/s: most from tau = {RUBBER.times[k]:.0e} s, "
            f"sensitivity {row[1:][k]:+.3f}"
        )
    check_facts(sensitivity, by_load * LOAD / mu)


def draw(
    velocity: np.ndarray,
    mu: np.ndarray,
    radius: np.ndarray,
    sensitivity: np.ndarray,
    path: Path,
) -> None:
    figure, (top, bottom) = plt.subplots(
        2, 1, figsize=(7.2, 6.2), sharex=True, height_ratios=(2, 3)
    )
    top.semilogx(velocity, mu, color="#1f5a94")
    top.set(ylabel="Friction coefficient [-]", ylim=(0, None))
    model = em.plan(RUBBER, BALL, velocity=velocity, load=LOAD).model
    top.set_title(f"Ball of 5 mm radius, 1 N, on {RUBBER.name} at -25 °C", pad=30)
    about = f"{model}\nillustrative moduli"
    top.text(0, 1.02, about, transform=top.transAxes, fontsize=8, color="#666666")
    cells = edges(velocity), edges(RUBBER.times)
    colours = bottom.pcolormesh(
        *cells, sensitivity[:, 1:].T, cmap="RdBu_r", vmin=-0.8, vmax=0.8
    )
    bottom.loglog(
        velocity,
        radius / velocity,
        "k--",
        linewidth=1.2,
        label="contact radius over velocity",
    )
    bottom.set(
        xlabel="Sliding velocity [m/s]",
        ylabel="Relaxation time of the branch [s]",
        ylim=cells[1][[0, -1]],
    )
    words = "red: its loss adds friction\nblue: as a spring, it takes friction away"
    bottom.text(0.03, 0.08, words, transform=bottom.transAxes, fontsize=9)
    bottom.legend(loc="upper right", fontsize=9)
    figure.colorbar(
        colours,
        ax=bottom,
        label="Sensitivity $(G_k/\\mu)\\,\\partial\\mu/\\partial G_k$ [-]",
    )
    figure.savefig(path)
    plt.close(figure)


def edges(x: np.ndarray) -> np.ndarray:
    """Where the cells around evenly log-spaced values end."""
    half = np.sqrt(x[1] / x[0])
    return np.append(x / half, x[-1] * half)


def check_difference(velocity: np.ndarray, by_moduli: jax.Array) -> None:
    k, step = 6, 1e-3  # the branch of 0.1 s, changed by a thousandth
    change = step * MODULI[k] * (np.arange(MODULI.size) == k)
    (up, _), _ = gradient(MODULI + change, LOAD, velocity)
    (down, _), _ = gradient(MODULI - change, LOAD, velocity)
    off = (
        np.abs(by_moduli[:, k] - (up - down) / (2 * change[k])).max()
        / np.abs(by_moduli[:, k]).max()
    )
    print(f"check  gradient against finite difference: {off:.0e} of its largest value")
    assert off < 1e-5, "the gradient must meet the finite difference"


def check_facts(sensitivity: np.ndarray, to_load: np.ndarray) -> None:
    total = np.abs(sensitivity.sum(axis=1) + to_load).max()
    print(f"check  sensitivities to all moduli and the load add up to {total:.0e}")
    assert total < 1e-6, "mu depends on moduli over load only"

    share = RUBBER.moduli * RUBBER.times / np.sum(RUBBER.moduli * RUBBER.times)
    assert np.allclose(sensitivity[0, 1:], share, atol=3e-3), (
        "at low velocity G_k tau_k carries the friction"
    )
    assert np.isclose(sensitivity[0, 0], -1, atol=3e-3), "and mu falls as 1/G_inf"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
