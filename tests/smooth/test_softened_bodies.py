"""Softening with strain under smooth bodies and on layers: rule of the strain, fixed
point, limits, derivatives.

The contact is checked against closed forms: Hertz with a softened modulus, solved by
bisection here.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

AMPLITUDE = np.geomspace(1e-4, 0.5, 30)
SOFT = em.Softening(
    AMPLITUDE,
    1 - 0.6 * AMPLITUDE / (0.02 + AMPLITUDE),
    1 + AMPLITUDE / (0.02 + AMPLITUDE),
)

NONE = em.Softening([1e-3, 1e-1], [1.0, 1.0], [1.0, 1.0])
VELOCITY = np.geomspace(1e-3, 10, 9)


def solid(softening=None, glassy=3e6):
    return em.StandardSolid(1e6, glassy, 1e-2, softening=softening)


def root(f, low, high):
    for _ in range(200):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if f(middle) < 0 else (low, middle)
    return middle


def test_an_elastic_ball_has_the_contact_of_hertz_with_the_modulus_at_its_own_strain():
    load, radius = 2.0, 0.01

    def missing(a):  # of the load, with E* = 4 G f(0.2 a/R)
        return (
            4 / 3 * 4e6 * float(SOFT.factors(0.2 * a / radius)[0]) * a**3 / radius
            - load
        )

    a = root(missing, 1e-5, 1e-2)
    curve = em.friction(
        em.Prony(1e6, [1e-3], [1.0], softening=SOFT),
        em.Paraboloid(radius),
        velocity=1.0,
        load=load,
        adhesion=em.AdhesiveShear(1e5, 1.0, 0.0),
    )
    assert curve.contact.leading == pytest.approx(a, rel=1e-6)
    assert curve.strain == pytest.approx(0.2 * a / radius, rel=1e-6)
    assert curve.normal_force == pytest.approx(load, rel=1e-7)
    assert curve.contact_area == pytest.approx(np.pi * a**2, rel=1e-6)


def test_a_softened_contact_is_the_linear_one_at_its_strain():
    """To first order in the loss, G' f and G'' g: the load over f, mu times g/f."""
    soft = em.friction(solid(SOFT), em.Sphere(0.01), velocity=VELOCITY, load=2.0)
    f, g = SOFT.factors(soft.strain)
    plain = em.friction(solid(), em.Sphere(0.01), velocity=VELOCITY, load=2.0 / f)
    assert soft.mu == pytest.approx(g / f * plain.mu, rel=1e-6)
    assert soft.normal_force == pytest.approx(2.0, rel=1e-7)
    assert soft.friction_force == pytest.approx(2.0 * soft.mu, rel=1e-7)
    assert soft.linear == pytest.approx(
        em.friction(solid(), em.Sphere(0.01), velocity=VELOCITY, load=2.0).mu, rel=1e-6
    )
    assert np.all(soft.mu > 1.5 * soft.linear)
    assert np.isnan(soft.model_error).all()  # no bound is established for one strain
    assert "effective strain" in soft.summary()


def test_weak_loss_is_that_of_a_solid_with_the_softened_moduli():
    """One branch at low velocity: loss modulus times g and storage modulus times f make
    another standard solid.
    """
    slope, weak = 0.1, 1e4
    soft = em.friction(solid(SOFT, weak), em.Cone(slope), velocity=1e-3, load=1.0)
    assert soft.strain == pytest.approx(0.2 * slope, rel=1e-12)
    f, g = (float(x) for x in SOFT.factors(0.02))
    other = em.friction(
        em.StandardSolid(1e6 * f, weak * g, 1e-2),
        em.Cone(slope),
        velocity=1e-3,
        load=1.0,
    )
    assert soft.mu == pytest.approx(float(other.mu), rel=3e-3)
    assert soft.depth == pytest.approx(float(other.depth), rel=3e-3)


def test_without_softening_or_with_factors_of_one_all_is_as_before():
    plain = em.friction(solid(), em.Sphere(0.01), velocity=VELOCITY, load=2.0)
    ones = em.friction(solid(NONE), em.Sphere(0.01), velocity=VELOCITY, load=2.0)
    assert plain.strain is None
    assert ones.mu == pytest.approx(plain.mu, rel=1e-13)
    assert ones.model_error == pytest.approx(plain.model_error, rel=1e-12)
    deep = em.friction(solid(NONE), em.Cone(0.1), velocity=VELOCITY, depth=1e-4)
    assert deep.mu == pytest.approx(
        em.friction(solid(), em.Cone(0.1), velocity=VELOCITY, depth=1e-4).mu, rel=1e-13
    )


def test_under_a_depth_the_contact_stays_and_the_force_falls():
    soft = em.friction(solid(SOFT), em.Paraboloid(0.01), velocity=VELOCITY, depth=1e-4)
    plain = em.friction(solid(), em.Paraboloid(0.01), velocity=VELOCITY, depth=1e-4)
    assert soft.contact.leading == pytest.approx(plain.contact.leading, rel=1e-12)
    assert soft.normal_force == pytest.approx(
        SOFT.factors(soft.strain)[0] * plain.normal_force, rel=1e-12
    )


def test_on_a_layer_the_strain_is_its_compression():
    thickness, radius = 5e-3, 0.05
    belt = em.springs(
        em.Prony(1e6, [1e-3], [1.0], softening=SOFT), thickness, bonded=False
    )
    roll = em.rolling(belt, em.Cylinder(radius, 0.1), velocity=1.0, load=500.0)
    # rms of d (1 - x^2/a^2)
    assert roll.strain == pytest.approx(
        np.sqrt(8 / 15) * roll.depth / thickness, rel=1e-6
    )
    # E/((1 - nu^2) h)
    stiffness = 4e6 / thickness * float(SOFT.factors(roll.strain)[0])
    a = np.sqrt(2 * radius * roll.depth)
    force = 0.1 * stiffness * (2 * roll.depth * a - a**3 / (3 * radius))
    assert force == pytest.approx(500.0, rel=1e-6)
    ball = em.friction(belt, em.Paraboloid(radius), velocity=1.0, load=5.0)
    assert ball.strain == pytest.approx(
        np.sqrt(1 / 3) * ball.depth / thickness, rel=1e-6
    )
    with refused("thickness", "em.springs"):
        em.rolling(
            em.Foundation(1e9, [], [], softening=SOFT),
            em.Cylinder(radius, 0.1),
            velocity=1.0,
            load=500.0,
        )


def test_what_stays_linear_says_so():
    found = em.dissipation(solid(SOFT), em.Paraboloid(0.01), velocity=0.01, load=1.0)
    assert "small strain" in found.summary()


def test_strains_beyond_the_sweep_are_flagged():
    short = em.Softening([1e-4, 1e-2], [0.99, 0.8], [1.1, 1.5])
    known = em.StandardSolid(
        1e6, 3e6, 1e-2, softening=short, range={"omega": (1e-3, 1e6)}
    )
    curve = em.friction(known, em.Paraboloid(0.01), velocity=0.1, load=[1e-3, 2.0])
    assert curve.extrapolated.tolist() == [False, True]
    assert "beyond the strain sweep" in curve.summary()


def test_derivatives_go_through_the_fixed_point():
    def mu(load, glassy, drop):
        soft = em.Softening(
            AMPLITUDE, 1 - drop * AMPLITUDE / (0.02 + AMPLITUDE), SOFT.loss
        )
        return em.friction(
            solid(soft, glassy * 3e6),
            em.Paraboloid(0.01),
            velocity=0.02,
            load=load,
            rtol=1e-8,
        ).mu

    start, way = np.array([2.0, 1.0, 0.6]), np.array([1.4, -0.8, 0.5])
    with jax.enable_x64(True):
        slope = jax.jit(jax.grad(mu, (0, 1, 2)))(*(jnp.asarray(x) for x in start))
    h = 1e-3
    one, other, two, three = (float(mu(*(start + s * h * way))) for s in (1, -1, 2, -2))
    centred = (8 * (one - other) - (two - three)) / (12 * h)
    assert float(np.asarray(slope) @ way) == pytest.approx(centred, rel=1e-5)
