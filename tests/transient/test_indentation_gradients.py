"""Derivatives of indentations in both modes, against finite differences."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em

from ..refused import refused
from ..whole.problems.indentation import PULSES, TIMES, TWICE


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


def _directional(function, point, rtol, forward=jax.jvp):
    """Forward derivative in one direction against central differences of two steps."""
    way = np.array([0.7, -0.4, 0.5, 0.3, 0.6])[: point.size] * point
    got = forward(function, (point,), (way,))[1]
    slow = [
        (np.asarray(function(point + h * way)) - np.asarray(function(point - h * way)))
        / (2 * h)
        for h in (2e-4, 1e-4)
    ]
    expected = slow[1] + (slow[1] - slow[0]) / 3
    for row, wanted in zip(got, expected, strict=True):
        np.testing.assert_allclose(
            row, wanted, rtol=rtol, atol=rtol * np.abs(wanted).max()
        )


def test_derivatives_under_a_depth():
    def call(p):
        foundation = em.Foundation(p[0], p[1:2], p[2:3])
        result = em.indent(
            foundation, em.Paraboloid(p[3]), time=TIMES, depth=p[4] * TWICE
        )
        return jnp.stack([result.force, result.contact_radius, result.dissipated])

    forward = jax.jit(jax.jvp, static_argnums=0)
    _directional(call, np.array([1.0, 3.0, 0.5, 1.0, 1.0]), 1e-6, forward)


def test_derivatives_under_a_growing_load():
    def call(p):
        foundation = em.Foundation(p[0], p[1:2], p[2:3])
        result = em.indent(
            foundation, em.Paraboloid(p[3]), time=TIMES, load=3e-3 * (1 + TIMES)
        )
        return jnp.stack([result.depth, result.contact_radius, result.dissipated])

    point = np.array([1.0, 3.0, 0.5, 1.0])
    _directional(call, point, 1e-7)
    way = np.array([0.7, -0.4, 0.5, 0.3]) * point
    back = jax.grad(lambda p: call(p)[0, -1])(point)
    np.testing.assert_allclose(
        back @ way, jax.jvp(call, (point,), (way,))[1][0, -1], rtol=1e-10
    )


@pytest.mark.slow
def test_derivatives_under_a_falling_load():
    """On the elements of a transformation, which move with the body in a difference:
    forward, and back.
    """
    load = np.interp(TIMES, [0, 0.5, 1.0, 2.0], [0, 3e-3, 1e-3, 2e-3])

    @jax.jit
    def call(p):
        foundation = em.Foundation(p[0], p[1:2], p[2:3])
        return em.indent(
            foundation, em.Paraboloid(p[3]), time=TIMES, load=p[4] * load
        ).depth

    point = np.array([1.0, 3.0, 0.5, 1.0, 1.0])
    _directional(lambda p: call(p)[None], point, 3e-4)
    way = np.array([0.7, -0.4, 0.5, 0.3, 0.6])
    back = jax.grad(lambda p: call(p)[-1])(point)
    forth = jax.jvp(call, (point,), (way,))[1][-1]
    np.testing.assert_allclose(back @ way, forth, rtol=1e-10)


def test_times_are_plain_numbers_under_a_falling_load():
    def call(k):
        load = np.array([0.0, 3e-3, 1e-3])
        foundation = em.Foundation(1.0, [3.0], [0.5])
        return em.indent(
            foundation, em.Paraboloid(1.0), time=k * np.arange(3.0), load=load
        ).depth[-1]

    with refused("time", "plain numbers"):
        jax.grad(call)(1.0)


@pytest.mark.slow
def test_derivatives_with_adhesion():
    def call(p):
        result = em.indent(
            em.Foundation(p[0], [], []),
            em.Paraboloid(p[1]),
            time=TIMES,
            load=p[3] * PULSES,
            adhesion=p[2],
        )
        return jnp.stack([result.depth, result.contact_radius])

    _directional(call, np.array([1e6, 0.01, 0.05, 1.0]), 1e-7)
