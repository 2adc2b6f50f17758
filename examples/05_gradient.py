"""05: the gradient of friction, and which branch of the spectrum carries it at which velocity.

Teaches: `jax.grad` goes through `em.friction`. The relative sensitivity (G_k/mu) d mu/d G_k says what a change of one
branch does: a branch that relaxes during the passage adds loss; one too slow to relax is a spring that only stiffens the
rubber, which makes the contact smaller and the friction lower.

Inputs: `natural-rubber-like` of the library, a made-up spectrum, at its reference temperature of -25 degC; radius and load
chosen here.

Check: finite differences; and two facts that no solver knows of. Moduli and load multiplied by one factor leave mu as
it is, so the sensitivities to all moduli and to the load add up to zero. At low velocity mu = v sum(G_k tau_k)/(G_inf R)
(Brilliantov & Poeschel 1998), so that the sensitivity to G_k is the share of G_k tau_k in the sum.

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


def friction(moduli: np.ndarray, load: float, velocity: float) -> jax.Array:
    """mu of a Prony series whose relaxed modulus comes first [Pa]."""
    rubber = em.Prony(moduli[0], moduli[1:], RUBBER.times)
    return em.friction(rubber, BALL, velocity=velocity, load=load).mu


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)

    velocity = np.geomspace(1e-6, 1e3, 64)  # m/s
    moduli = np.array([RUBBER.equilibrium, *RUBBER.moduli])  # Pa
    with jax.enable_x64(True):  # JAX itself rounds to float32 unless told otherwise
        by_velocity = jax.vmap(jax.value_and_grad(friction, argnums=(0, 1)), in_axes=(None, None, 0))
        mu, (by_moduli, by_load) = map(np.asarray, jax.tree.leaves(x)) if False else jax.jit(by_velocity)(moduli, LOAD, velocity)
    mu, by_moduli, by_load = np.asarray(mu), np.asarray(by_moduli), np.asarray(by_load)
    sensitivity = by_moduli * moduli / mu[:, None]  # d ln mu / d ln G, (velocities, moduli)
