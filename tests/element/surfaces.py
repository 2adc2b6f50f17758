"""Surfaces that move over elements, and their march through `diffrax`."""

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp

from elastomdr.element.contact_step import rest
from elastomdr.element.elements import ContactStep, RigidSurface


class Indenter(eqx.Module):
    """A paraboloid's line, g = x^2/R, sliding at v over one element that enters contact
    at t = 0.
    """

    entry: jax.Array
    radius: jax.Array
    velocity: jax.Array

    def __call__(self, t):
        return (
            (self.entry**2 - (self.entry - self.velocity * t) ** 2) / self.radius
        ).reshape(-1)


class Waves(eqx.Module):
    """A surface that comes from a distance, leaves and comes back, at another time for
    each of n elements.
    """

    n: int = eqx.field(static=True)

    def __call__(self, t):
        return (
            jnp.sin(7 * t + 0.3 * jnp.linspace(0, 1, self.n))
            + 0.4 * jnp.sin(16 * t)
            - 0.5
        )


def solve(law, surface, end, count, n=1, samples=64, most=1024, **kwargs):
    """`count` contact steps; it may be traced, so that one compiled solve serves every
    step size.
    """
    return diffrax.diffeqsolve(
        RigidSurface(surface),
        ContactStep(samples),
        t0=0.0,
        t1=end,
        dt0=end * samples / count,
        y0=rest(law, n),
        args=law,
        max_steps=most,
        **kwargs,
    )
