"""Friction under JAX's transformations: gradients in both modes against central
differences, jit and vmap.
"""

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.checks import nan_unless

FOUNDATION = em.Foundation(1e6, [4e6], [1e-3])
PARAMETERS = {
    "equilibrium": 5e5,
    "moduli": np.array([1e7, 3e6]),
    "times": np.array([1e-5, 1e-2]),
    "geometry": 1.0,
    "load": 2.0,
    "velocity": 0.3,
    "temperature": 300.0,
}
# Python numbers would compile anew
PARAMETERS = {name: np.asarray(value) for name, value in PARAMETERS.items()}
SCALED = {
    "paraboloid": lambda x: em.Paraboloid(5e-3 * x),
    "sphere": lambda x: em.Sphere(5e-3 * x),
}


def _mu(p, shape, model, rtol=1e-8):
    shift = em.WLF(8.86, 101.6, 293.15)
    material = em.Prony(
        p["equilibrium"], p["moduli"], p["times"], bulk=2e9, shift=shift
    )
    return em.friction(
        material,
        SCALED[shape](p["geometry"]),
        velocity=p["velocity"],
        load=p["load"],
        temperature=p["temperature"],
        model=model,
        rtol=rtol,
    ).mu


@pytest.mark.parametrize(
    ("shape", "model"),
    [
        ("paraboloid", "averaged"),
        pytest.param("sphere", "line", marks=pytest.mark.slow),
    ],
)
def test_gradients_in_both_modes_against_differences(shape, model):
    def value(parameters):
        return _mu(parameters, shape, model)

    # all at once; the temperature moves the times by exp(30 dT/T), so less of it
    weight = dict(zip(PARAMETERS, (1.2, -0.7, 0.9, 0.6, -1.1, 0.8, 0.03), strict=True))
    way = {name: weight[name] * x for name, x in PARAMETERS.items()}

    def moved(share):
        return {name: x + share * way[name] for name, x in PARAMETERS.items()}

    with jax.enable_x64(True):
        both = jax.jit(jax.value_and_grad(value))
        reverse = both(PARAMETERS)[1]
        forward = jax.jit(lambda x: jax.jvp(value, (x,), (way,))[1])(PARAMETERS)
        ends = [float(both(moved(share))[0]) for share in (1e-4, -1e-4, 2e-4, -2e-4)]
    difference = (8 * (ends[0] - ends[1]) - (ends[2] - ends[3])) / 12e-4
    backward = sum(np.sum(np.asarray(reverse[name]) * way[name]) for name in way)
    np.testing.assert_allclose([forward, backward], difference, rtol=1e-5)


def test_jit_and_vmap():
    def mu(velocity):
        return em.friction(
            FOUNDATION,
            em.Paraboloid(5e-3),
            velocity=velocity,
            load=1.0,
            model=em.Line(),
        ).mu

    velocity = np.array([0.01, 1.0])
    with jax.enable_x64(True):
        np.testing.assert_allclose(jax.jit(mu)(velocity), mu(velocity), rtol=1e-12)
        np.testing.assert_allclose(jax.vmap(mu)(velocity), mu(velocity), rtol=1e-12)


# what JAX says of the way back
@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
def test_reverse_mode_with_single_precision_outside():
    def mu(modulus):
        law, ball = em.Foundation(1e6, [modulus], [1e-3]), em.Sphere(5e-3)
        return em.friction(law, ball, velocity=0.1, load=1.0, model=em.Line()).mu

    with jax.enable_x64(False):
        forward = jax.jvp(mu, (4e6,), (1.0,))[1]
        np.testing.assert_allclose(jax.grad(mu)(4e6), forward, rtol=1e-5)


def test_a_number_that_is_not_known_has_no_derivative():
    """Zero would pass for a minimum. What is known beside it keeps its own."""

    def shown(x):
        return nan_unless(np.array([True, False]), np.array([2.0, 3.0]) * x)

    with jax.enable_x64(True):
        for derivative in (
            jax.jacfwd(shown),
            jax.jacrev(shown),
            jax.jit(jax.jacrev(shown)),
        ):
            np.testing.assert_array_equal(derivative(1.0), [2.0, np.nan])
        assert jax.grad(lambda x: shown(x)[0])(1.0) == 2.0
        assert np.isnan(jax.grad(lambda x: shown(x).sum())(1.0))


def test_a_march_off_its_grid_has_no_derivative():
    """Under a transformation `elements` fixes the grid: here the way is far longer."""
    time = np.linspace(0, 1, 5)

    def mu(load):
        law = em.StandardSolid(1e6, 4e6, 0.3)
        return em.slide(
            law,
            em.Paraboloid(5e-3),
            time=time,
            position=0.1 * time,
            load=load,
            rtol=0.1,
            elements=64,
        ).mu

    with jax.enable_x64(True):
        values, slopes = jax.jit(lambda load: jax.jvp(mu, (load,), (1.0,)))(1.0)
        assert np.isnan([values[-1], slopes[-1]]).all()
