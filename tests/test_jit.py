"""Calls under the caller's own `jax.jit`, where JAX has no 64-bit types: numbers that are not traced stay numbers."""

import jax
import numpy as np
import pytest

import elastomdr as em

RUBBER, BALL, TIME = em.StandardSolid(1e6, 4e6, 0.3), em.Paraboloid(5e-3), np.linspace(0, 1, 5)
CARCASS, TREAD = em.Foundation(8e7, [], []), em.Foundation(5e7, [1e8, 1e8], [1e-2, 1.0])
WHEEL = {"velocity": 25.0, "slip": 0.005, "friction": 0.8, "tangential": TREAD}
CALLS = {
    "indent": lambda k: em.indent(RUBBER, BALL, time=TIME, depth=k * 1e-4 * TIME).force,
    "impact": lambda k: em.impact(RUBBER, BALL, mass=0.01 * k, velocity=1.0).restitution,
    "a load on an elastic body": lambda k: em.rolling(em.Prony(1e6, [], []), BALL, velocity=1.0, load=k).depth,
    "traction": lambda k: em.traction(CARCASS, em.Cylinder(0.3, 0.16), load=4e3 * k, **WHEEL).force,
    "shear": lambda k: em.shear(RUBBER, BALL, time=TIME, displacement=1e-5 * k * TIME, friction=0.5, load=1.0).force,
}


@pytest.mark.parametrize("call", CALLS)
def test_jit_gives_the_same(call):
    np.testing.assert_allclose(jax.jit(CALLS[call])(1.0), CALLS[call](1.0), rtol=1e-6)


def test_an_elastic_body_sinks_with_the_load():
    """d of F = (4/3) E* sqrt(R) d^(3/2): its derivative is 2 d/(3 F)."""
    depth = CALLS["a load on an elastic body"]
    np.testing.assert_allclose(jax.grad(depth)(4.0), 2 * depth(4.0) / 12, rtol=1e-6)


def test_a_march_under_jit():
    """Its grid is given there, outside it is chosen: both within the tolerance."""

    def mu(load):
        return em.slide(RUBBER, BALL, time=TIME, position=1e-3 * TIME, load=load, rtol=1e-1, elements=256).mu

    chosen = mu(1.0)
    np.testing.assert_allclose(jax.jit(mu)(1.0), chosen, atol=0.1 * chosen.max())


def test_what_diffrax_marches_asks_for_64_bit_types():
    def mu(load):
        return em.drive(RUBBER, BALL, time=TIME, position=1e-4 * TIME, load=load).mu

    with pytest.raises(em.InputError, match=r"em\.drive under jit, grad or vmap needs JAX's 64-bit types"):
        jax.jit(mu)(1.0)
