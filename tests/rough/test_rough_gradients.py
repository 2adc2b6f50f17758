"""Derivatives of the friction of rough lines and surfaces, in both modes, against
differences.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.surface.spectrum import synthesise

SURFACE = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=8e3)
LINE = synthesise(SURFACE, 0, 4, 64)
SHIFT = em.WLF(c1=8.86, c2=101.6, reference=293.15)
# E_1, E_2, tau_1, tau_2, v, p, T
GIVEN = np.array([2e7, 3e6, 1e-4, 1e-2, 0.3, 3e4, 298.0])
# Hurst exponent, rms slope, q_low, q_rolloff, q_high
BROAD = np.array([0.8, 0.2, 1e3, 2e3, 8e3])


@pytest.fixture(autouse=True)
def any_sampling(monkeypatch):
    """Points are handed out whatever the error for the sampling of their lines."""
    monkeypatch.setattr("elastomdr.rough.ensemble.SAMPLING", 1.0)


def by_pressure(x):
    rubber = em.Prony(1e6, x[:2], x[2:4], shift=SHIFT)
    return em.friction(
        rubber,
        SURFACE,
        velocity=x[4],
        pressure=x[5],
        temperature=x[6],
        model=em.Line(samples=256),
    ).mu


def by_all(x):
    """By rubber and surface, averaged over directions, the load by the rule of full
    contact.
    """
    rubber = em.Prony(1e6, x[:2], x[2:4], shift=SHIFT)
    surface = em.SelfAffine(
        x[7], rms_slope=x[8], q_low=x[9], q_rolloff=x[10], q_high=x[11]
    )
    return em.friction(
        rubber,
        surface,
        velocity=x[4],
        pressure=x[5],
        temperature=x[6],
        model=em.Line(average=True, samples=256, equivalent_length="full contact"),
    ).mu


def by_depth(x):
    """Of a line whose heights and depth are given: the first heights, and the depth."""
    line = em.RoughLine(
        LINE.x,
        LINE.height * (1 + x[0]) + x[1] * jnp.cos(2 * jnp.pi * np.arange(64) / 64),
    )
    rubber = em.Foundation(1e6, [2e7], [1e-4])
    return em.friction(
        rubber, line, velocity=0.3, depth=x[2], model=em.Line(samples=256)
    ).mu


def against_differences(friction, at, step):
    """Compares the gradient with a difference in one direction, in which all parameters
    take parts of one size, so that none hides behind another; returns both.
    """
    both = jax.jit(jax.value_and_grad(friction))
    slopes = np.asarray(both(at)[1])
    parts = slopes * step
    along = 0.1 * step * np.sign(parts) * np.abs(parts).max() / np.abs(parts)
    difference = (both(at + along)[0] - both(at - along)[0]) / 2
    np.testing.assert_allclose(slopes @ along, difference, rtol=1e-5)
    return slopes, along


def test_gradient_by_rubber_and_surface():
    at = np.append(GIVEN, BROAD)
    with jax.enable_x64(True):
        against_differences(by_all, at, 1e-6 * at)


def test_both_modes_by_depth_and_heights():
    at, step = np.array([0.0, 1e-6, 2e-5]), np.array([1e-5, 1e-10, 1e-10])
    with jax.enable_x64(True):
        slopes, along = against_differences(by_depth, at, step)
        forward = jax.jit(lambda x: jax.jvp(by_depth, (x,), (along,))[1])(at)
    np.testing.assert_allclose(forward, slopes @ along, rtol=1e-8)


def test_more_lanes_than_are_solved_at_once():
    velocity = np.geomspace(0.01, 10, 70)

    def mu(load):
        return em.friction(
            em.Foundation(1e6, np.full(13, 1e6), np.geomspace(1e-9, 1e3, 13)),
            LINE,
            velocity=velocity,
            load=load,
            model=em.Line(samples=256),
        ).mu

    with jax.enable_x64(True):
        slope = jax.jit(jax.jacfwd(mu))(3.0)
        np.testing.assert_allclose(
            slope, (mu(3.0003) - mu(2.9997)) / 6e-4, rtol=2e-3, atol=1e-5
        )


def test_traced_cutoffs_need_samples():
    def friction(q):
        surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=q)
        return em.friction(
            em.Foundation(1e6, [2e7], [1e-4]),
            surface,
            velocity=0.3,
            pressure=3e4,
            model="line",
        ).mu

    with (
        jax.enable_x64(True),
        pytest.raises(em.InputError, match="samples must be given"),
    ):
        jax.jit(jax.grad(friction))(8e3)


def test_many_at_once():
    with jax.enable_x64(True):
        found = jax.jit(
            jax.vmap(lambda v: by_pressure(jnp.asarray(GIVEN).at[4].set(v)))
        )(jnp.asarray([0.1, 0.3]))
        assert np.isclose(found[1], by_pressure(GIVEN), rtol=1e-7)


def test_flash_temperature_has_no_derivative():
    heat = em.Heat(conductivity=0.2, heat_capacity=2e6)
    rubber = em.StandardSolid(1e6, 2e7, 1e-4, shift=SHIFT)

    def hot(v):
        return em.friction(
            rubber,
            SURFACE,
            velocity=v,
            pressure=3e4,
            temperature=298.0,
            heat=heat,
            model=em.Line(),
        ).mu

    with jax.enable_x64(True), pytest.raises(em.InputError, match="not differentiable"):
        jax.jit(jax.grad(hot))(0.3)
