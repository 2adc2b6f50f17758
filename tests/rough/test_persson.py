"""Persson's theory against values computed apart from this code, and as a curve beside
the line's.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import erf, erfinv

import elastomdr as em

RUBBER = em.Foundation(1e6, [2e7, 5e6], [1e-5, 1e-3])
TABLE = np.array([1e3, 1e6])
SURFACE = em.Spectrum(TABLE, 1e-17 * (TABLE / 1e3) ** -3.6, convention="2d")


def persson(pressure, velocity, gamma, stored=False, rtol=1e-7):
    model = em.Persson(gamma=gamma, stored=stored)
    return em.friction(
        RUBBER, SURFACE, pressure=pressure, velocity=velocity, model=model, rtol=rtol
    )


def test_persson():
    got = persson(3e5, [0.3, 0.3], 0.5)
    np.testing.assert_allclose(got.mu, 0.012198893352743344, rtol=1e-6)
    np.testing.assert_allclose(got.area_ratio, 0.639337598626935, rtol=1e-6)
    # A = erf(1/(2 sqrt G))
    spread = (0.5 / erfinv(got.area_ratio)) ** 2
    np.testing.assert_allclose(spread, 0.5983828641409461, rtol=3e-6)
    assert persson(3e5, 0.3, 0.5, stored=True).area_ratio > got.area_ratio[0]
    whole = persson(3e5, 0.3, 1.0, stored=True)
    # S = 1: nothing to put inside
    np.testing.assert_allclose(whole.area_ratio, got.area_ratio[0], rtol=1e-6)
    usual = persson(3e5, 0.3, 0.5, rtol=1e-6)
    assert abs(usual.mu - 0.012198893352743344) <= usual.error


@pytest.mark.filterwarnings("ignore:pressure is taken in Pa")
def test_full_contact():
    full = persson(1e12, 0.3, 1.0)
    np.testing.assert_allclose(full.mu * 1e12, 4592.225558045976, rtol=1e-7)


def test_light_contact():
    """G leaves zero at once and P falls with it: mu and G by an adaptive integrator in
    log q, with S = 1.
    """
    pressure, velocity = 1e3, 0.3
    t = np.pi / 8000 * (np.arange(4000) + 0.5)  # a quarter of the circle

    def rate(log_q, y):
        q = np.exp(log_q)
        modulus = RUBBER.complex_modulus(q * velocity * np.cos(t)) / pressure
        c = q**4 * float(SURFACE.at(np.array([q]))[0]) * 4 * np.pi / 8000
        share = erf(0.5 / np.sqrt(max(y[0], 1e-300)))
        return [
            c / 8 * np.sum(np.abs(modulus) ** 2),
            0.5 * c * share * np.sum(np.cos(t) * modulus.imag),
        ]

    ends = np.log([SURFACE.q_low, SURFACE.q_high])
    exact = solve_ivp(
        rate, ends, [0.0, 0.0], rtol=1e-8, atol=1e-13, first_step=1e-12
    ).y[:, -1]
    got = persson(pressure, velocity, 1.0)
    spread = (0.5 / erfinv(got.area_ratio)) ** 2
    np.testing.assert_allclose([spread, got.mu], exact, rtol=1e-5)
    assert got.error < 1e-5 * got.mu


def test_elastic_rubber_loses_nothing():
    """Zero, not what underflow leaves of it."""
    road = em.SelfAffine(0.8, rms_slope=0.6, q_low=1e4, q_high=1e6)
    for model in (em.Persson(), em.Multiscale()):
        curve = em.friction(
            em.Prony(1e6, [], []), road, velocity=[1e-3, 1.0], pressure=1e5, model=model
        )
        assert (curve.mu == 0).all()
        assert curve.converged.all()
