"""Losses by branch of a cylinder on rubber of finite thickness."""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.material.relaxation import Relaxation, to_kelvin
from elastomdr.smooth.cylinder_galerkin import Cover, Solution, losses

from ..refused import refused

RUBBER = em.Prony(1e6, [2e6, 5e6], [1e-3, 1e-1], name="two times")
ROLL, AT = (
    em.Cylinder(0.05, 0.5),
    {"velocity": np.geomspace(1e-4, 1e2, 7), "load": 300.0},
)


@pytest.mark.parametrize("thickness", [2e-3, 20e-3])
def test_branches_account_for_the_work(thickness):
    """The sum over waves of the branches' losses against the friction from the slope of
    the pressure's moments.
    """
    parts = em.dissipation(em.layer(RUBBER, thickness), ROLL, **AT)
    assert parts.converged.all()
    assert parts.error.max() < 1e-5
    np.testing.assert_allclose(parts.share.sum(axis=-1), 1, rtol=1e-12)
    rolled = em.rolling(em.layer(RUBBER, thickness), ROLL, **AT)
    np.testing.assert_allclose(parts.power.sum(axis=-1), rolled.power, rtol=1e-10)
    assert parts.share[0, 1] > 0.9  # slow: E_k tau_k
    np.testing.assert_allclose(parts.share[0, 1] / parts.share[0, 0], 250, rtol=0.02)


@pytest.mark.parametrize("n", [0, 1, 8])
def test_waves_beyond_the_last_one_that_is_summed_are_counted(n):
    """The pressure c sqrt(1 - t^2) U_n(t) has the transform pi L c (n + 1) J_n+1(y)/y,
    y = kL, and under losses in proportion to the frequency, E_1 k v tau, the half-space
    loses (2/pi) L (pi c (n + 1))^2 E_1 (v tau/L)/E_inf^2 int J_n+1^2/y dy, the last
    integral being 1/(2 n + 2).

    The waves above kL = 4097 have (2/pi) (2 n + 2)/4097 of it; their weight is a mean
    over a quarter of the waves that are summed.
    """
    law = Relaxation(np.array(2e6), np.array([3e6]), np.array([1e-3]), np.array(0.0))
    half, pressure, slow = 2e-3, 1e5, 1e-15
    terms = np.zeros((1, 16))
    terms[0, n] = pressure
    none = np.zeros(1)
    solution = Solution(np.array([half]), none, none, none, terms)
    lost = losses(np.array([slow * half / 1e-3]), law, Cover(to_kelvin(law)), solution)
    spread = (np.pi * pressure * (n + 1)) ** 2 / (2 * n + 2)
    expected = 2 / np.pi * half * spread * 3e6 * slow / 2e6**2
    np.testing.assert_allclose(lost, [[expected]], rtol=1.2e-8 * (n + 1))


def test_thick_layer_is_a_half_space_and_other_bodies_are_refused():
    # what is remembered over less than the thickness
    slow = {"velocity": AT["velocity"][:4], "load": 300.0}
    thick, whole = (
        em.dissipation(m, ROLL, **slow).share for m in (em.layer(RUBBER, 5.0), RUBBER)
    )
    np.testing.assert_allclose(thick, whole, rtol=1e-4, atol=1e-6)
    with refused("shape", "Cylinder"):
        em.dissipation(em.layer(RUBBER, 0.01), em.Sphere(0.05), velocity=1.0, load=1.0)
    with refused("material", "Poisson"):
        em.dissipation(
            em.layer(em.Prony(1e6, [1e6], [1.0], bulk=1e9), 0.01),
            ROLL,
            velocity=1.0,
            load=1.0,
        )


def test_warming_of_a_layer_is_where_the_power_of_rolling_meets_the_surroundings():
    rubber = em.Prony(1e6, [2e6, 5e6], [1e-3, 1e-1], shift=em.WLF(8.86, 101.6, 293.15))
    for body, load in ((ROLL, 300.0), (em.Sphere(0.02), 5.0)):
        layer = em.layer(rubber, 5e-3)
        at = {"velocity": 1.0, "load": load, "rtol": 1e-4}
        warm = em.heat_build_up(
            layer, body, ambient=293.15, conductance=0.05, hottest=350.0, **at
        )
        rolled = em.rolling(layer, body, temperature=warm.steady, **at)
        np.testing.assert_allclose(
            rolled.power, 0.05 * (warm.steady - 293.15), rtol=1e-3
        )
