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

    def moved(name, i, step):
        array = PARAMETERS[name].copy()
        array.reshape(-1)[i] += step
        return {**PARAMETERS, name: array}

    with jax.enable_x64(True):
        both = jax.jit(jax.value_and_grad(value))
        along = jax.jit(
            lambda direction: jax.jvp(value, (PARAMETERS,), (direction,))[1]
        )
        reverse = both(PARAMETERS)[1]
        nothing = jax.tree.map(lambda x: np.zeros(np.shape(x)), PARAMETERS)
        for name, given in PARAMETERS.items():
            for i, scale in enumerate(np.reshape(given, -1)):
                h = 1e-4 * scale
                near, far = (
                    [float(both(moved(name, i, s * step))[0]) for s in (1, -1)]
                    for step in (h, 2 * h)
                )
                difference = (
                    (8 * (near[0] - near[1]) - (far[0] - far[1])) / (12 * h) * scale
                )
                one = np.zeros(np.shape(given))
                one.reshape(-1)[i] = scale
                forward = float(along({**nothing, name: one}))
                backward = float(np.reshape(np.asarray(reverse[name]), -1)[i]) * scale
                for derivative in (forward, backward):
                    np.testing.assert_allclose(
                        derivative, difference, rtol=1e-5, atol=1e-9, err_msg=name
                    )


def test_jit_and_vmap():
    def mu(velocity):
        return em.friction(
            FOUNDATION,
            em.Paraboloid(5e-3),
            velocity=velocity,
            load=1.0,
            model=em.Line(),
            skip=False,
        ).mu

    velocity = np.array([0.01, 1.0])
    with jax.enable_x64(True):
        np.testing.assert_allclose(jax.jit(mu)(velocity), mu(velocity), rtol=1e-12)
        np.testing.assert_allclose(jax.vmap(mu)(velocity), mu(velocity), rtol=1e-12)


# what JAX says of the way back
@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
@pytest.mark.parametrize("shape", [em.Paraboloid(5e-3), em.Sphere(5e-3)])
def test_reverse_mode_with_single_precision_outside(shape):
    def mu(modulus):
        law = em.Foundation(1e6, [modulus], [1e-3])
        return em.friction(law, shape, velocity=0.1, load=1.0, model=em.Line()).mu

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
        values, slopes = jax.jit(lambda load: (mu(load), jax.jacfwd(mu)(load)))(1.0)
        assert np.isnan([values[-1], slopes[-1]]).all()
