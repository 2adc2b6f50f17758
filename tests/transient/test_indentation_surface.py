"""Back to three dimensions: pressure and displacement of an indentation."""

import jax
import numpy as np
import pytest

import elastomdr as em

from ..whole.problems.indentation import BALL, PROBLEMS, SOLID, TIMES, TWICE


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


def test_surface_of_an_elastic_contact_is_hertz():
    result = em.indent(
        em.Foundation(1.0, [], []), BALL, time=TIMES, depth=0.01 * TIMES / 2
    )
    r = np.linspace(0, 0.18, 10)
    a = 0.1
    np.testing.assert_allclose(
        result.pressure(r, 2.0),
        2 / np.pi * np.sqrt(np.maximum(a**2 - r**2, 0)),
        rtol=1e-9,
        atol=1e-12,
    )
    s = np.maximum(r, a)
    outside = ((2 * a**2 - s**2) * np.arcsin(a / s) + a * np.sqrt(s**2 - a**2)) / np.pi
    np.testing.assert_allclose(
        result.displacement(r, 2.0),
        np.where(r < a, 0.01 - r**2 / 2, outside),
        rtol=1e-9,
    )


def test_pressure_carries_the_force_and_contact_follows_the_body():
    result = em.indent(SOLID, BALL, time=TIMES, depth=TWICE)
    for i in (5, 9):
        t, a = TIMES[i], result.contact_radius[i]
        s, ds = np.polynomial.legendre.leggauss(60)
        r = a * np.sin(np.pi / 4 * (1 + s))  # 2 pi r dr, with r = a sin
        carried = (
            np.pi
            / 4
            * ds
            * 2
            * np.pi
            * r
            * np.sqrt(a**2 - r**2)
            @ result.pressure(r, t)
        )
        np.testing.assert_allclose(carried, result.force[i], rtol=1e-5)
        r = np.linspace(0, 0.999 * a, 7)
        np.testing.assert_allclose(
            result.displacement(r, t), TWICE[i] - r**2 / 2, rtol=1e-8
        )
        assert (result.pressure(np.linspace(1.001, 3, 5) * a, t) == 0).all()
        assert (
            result.displacement(np.array([1.1, 1.5]) * a, t)
            > TWICE[i] - (np.array([1.1, 1.5]) * a) ** 2 / 2
        ).all()


def test_imprint_stays_and_recovers():
    result = PROBLEMS[0].solve()
    imprint = (
        result.displacement(np.array([0.0, 0.05]), 1.6),
        result.displacement(np.array([0.0, 0.05]), 2.0),
    )
    assert (imprint[0] > imprint[1]).all()
    assert (imprint[1] > 0).all()
    assert (result.pressure(np.array([0.0, 0.05]), 1.6) == 0).all()
