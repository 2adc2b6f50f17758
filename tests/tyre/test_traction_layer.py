"""Traction of a cylinder on rubber of finite thickness: limits, and what is refused."""

import numpy as np
import pytest

import elastomdr as em

ROLL = em.Cylinder(0.05, 0.5)
CREEP = np.geomspace(1e-4, 1.0, 9)


def test_thick_elastic_layer_begins_and_ends_as_carter_and_is_near_it_between():
    rubber = em.Prony(1e6, [], [])
    given = {"velocity": 1.0, "creepage": CREEP, "friction": 0.5, "load": 300.0}
    layer, exact = (
        em.traction(em.layer(rubber, 2.0), ROLL, **given),
        em.traction(rubber, ROLL, **given),
    )
    np.testing.assert_allclose(layer.coefficient[:2], exact.coefficient[:2], rtol=1e-2)
    np.testing.assert_allclose(layer.coefficient[-1], 0.5, rtol=1e-2)
    assert np.abs(layer.coefficient - exact.coefficient).max() < 0.08 * 0.5


def test_thin_layer_is_the_brush_of_its_shear():
    """Without slip a layer much thinner than its contact carries xi G int r dr/h;
    branches their ramps.
    """
    rubber = em.Prony(1e6, [4e6], [2e-2], poisson=0.3)
    thin = em.traction(
        em.layer(rubber, 2e-4),
        ROLL,
        velocity=0.5,
        creepage=1e-3,
        friction=np.inf,
        load=2e4,
    )
    length = float(thin.contact.leading + thin.contact.trailing)
    r = np.linspace(0, length, 20001)
    s = 0.5 * 2e-2
    expected = (
        1e-3 * 0.5 * np.trapezoid(1e6 * r + 4e6 * s * -np.expm1(-r / s), r) / 2e-4
    )
    # the contact is 50 times as wide as thick
    np.testing.assert_allclose(thin.force, expected, rtol=1e-2)
    assert float(thin.stick) == 1


@pytest.mark.parametrize("thickness", [2e-3, 2e-2, 0.5])
@pytest.mark.parametrize(("speed", "modulus"), [(1e-9, 1e6), (1e9, 5e6)])
def test_slow_and_fast_a_layer_with_slip_is_the_elastic_one(thickness, speed, modulus):
    """Far below and far above the rate of its branch a viscoelastic layer is the
    elastic one of its relaxed and of its glassy modulus, from stick to full slip.
    """
    given = {"creepage": np.geomspace(1e-4, 0.3, 9), "friction": 0.5, "load": 300.0}
    found, exact = (
        em.traction(em.layer(rubber, thickness), ROLL, velocity=speed, **given)
        for rubber in (em.Prony(1e6, [4e6], [2e-2]), em.Prony(modulus, [], []))
    )
    assert found.converged.all()
    assert ((exact.stick > 0.01) & (exact.stick < 0.99)).sum() > 2
    np.testing.assert_allclose(found.coefficient, exact.coefficient, rtol=1e-5)
    np.testing.assert_allclose(found.stick, exact.stick, atol=1e-5)


def test_full_slip_no_creepage_and_sign():
    layer = em.layer(em.Prony(1e6, [4e6], [2e-2]), 5e-3)
    given = {"velocity": 0.5, "friction": 0.3, "load": 300.0}
    found = em.traction(layer, ROLL, creepage=[-0.05, 0.0, 0.05, 50.0], **given)
    assert found.converged.all()
    np.testing.assert_allclose(found.coefficient[0], -found.coefficient[2], rtol=1e-12)
    assert found.coefficient[1] == 0
    np.testing.assert_allclose(found.coefficient[3], 0.3, rtol=1e-3)
    rolled = em.rolling(layer, ROLL, velocity=0.5, load=300.0)
    np.testing.assert_allclose(found.rolling, float(rolled.coefficient), rtol=1e-10)


@pytest.mark.parametrize(
    ("layer", "body", "match"),
    [
        (em.layer(em.Prony(1e6, [], []), 5e-3), em.Sphere(0.05), "Cylinder"),
        (em.layer(em.Prony(1e6, [], []), 5e-3, bonded=False), ROLL, "bonded"),
    ],
)
def test_refused(layer, body, match):
    with pytest.raises(em.InputError, match=match):
        em.traction(layer, body, velocity=1.0, creepage=0.1, friction=0.5, load=1.0)


def test_bound_of_an_elastic_layer_from_stick_to_full_slip():
    """A quarter of the pull at small creepage, 0.12 mu at most, and near full slip what
    is left of mu, within 0.03 mu.
    """
    found = em.traction(
        em.layer(em.Prony(1e6, [], []), 5e-3),
        ROLL,
        velocity=1.0,
        creepage=[1e-5, 8e-3, 1.0],
        friction=0.4,
        load=300.0,
    )
    small, middle, large = found.coefficient
    assert 0.5 * 0.4 < middle < 0.9 * 0.4
    assert large > 0.98 * 0.4
    np.testing.assert_allclose(
        found.model_error, [0.25 * small, 0.12 * 0.4, 1.03 * 0.4 - large], rtol=1e-12
    )
