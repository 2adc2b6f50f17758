"""Calls under the caller's own `jax.jit`, where JAX has no 64-bit types: numbers that are not traced stay numbers."""

import jax
import numpy as np
import pytest

import elastomdr as em

RUBBER, BALL, TIME = em.StandardSolid(1e6, 4e6, 0.3), em.Paraboloid(5e-3), np.linspace(0, 1, 5)
CALLS = {
    "indent": lambda k: em.indent(RUBBER, BALL, time=TIME, depth=k * 1e-4 * TIME).force,
    "impact": lambda k: em.impact(RUBBER, BALL, mass=0.01 * k, velocity=1.0).restitution,
    "shear": lambda k: em.shear(RUBBER, BALL, time=TIME, displacement=1e-5 * k * TIME, friction=0.5, load=1.0).force,
}


@pytest.mark.parametrize("call", CALLS)
def test_jit_gives_the_same(call):
    np.testing.assert_allclose(jax.jit(CALLS[call])(1.0), CALLS[call](1.0), rtol=1e-6)
