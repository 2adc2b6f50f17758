"""`em.dissipation`: the loss of each branch, against Lyapunov's equation and
quadrature, limits, and its refusals.
"""

import jax
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import solve_continuous_lyapunov

import elastomdr as em

from ..refused import refused

MODULI, TIMES = np.array([3e6, 2e6, 5e6]), np.array([1e-4, 1e-3, 3e-2])
BALL = em.Paraboloid(0.01)
VELOCITY = np.array([0.01, 0.3, 10.0])
LINE = {"velocity": VELOCITY, "load": 1.0, "model": em.Line()}


def by_hand(relaxed, viscosity, v, a, b):
    """int f_k^2/(E_k tau_k) dt in the contact by quadrature, behind it from A^T M + M A
    = -1; g = x^2/R.
    """
    s, slope = v * TIMES, 2 / float(BALL.radius)

    def force(k, y):  # at x = a - y, E_k int_0^y exp(-(y-t)/s_k) g'(a-t) dt
        w = y / s[k]
        second = 0.5 - w / 6 + w**2 / 24 if w < 1e-3 else (w + np.expm1(-w)) / w**2
        return MODULI[k] * slope * (a * s[k] * -np.expm1(-w) - y**2 * second)

    ends = [np.minimum(a + b, s[k] * np.array([1.0, 5.0, 40.0])) for k in range(3)]
    whole = [
        quad(lambda y, k=k: force(k, y) ** 2, 0, a + b, points=ends[k], epsrel=1e-11)[0]
        for k in range(3)
    ]
    inside = np.array(whole) / (MODULI * s)
    state = np.array([force(k, a + b) for k in range(3)])
    if viscosity == 0:
        matrix = np.outer(MODULI, 1 / TIMES) / (relaxed + MODULI.sum()) - np.diag(
            1 / TIMES
        )
    else:  # u' = -(E_0 u + sum f)/eta
        rate = -np.append(np.ones(3), relaxed) / viscosity
        matrix = np.vstack(
            [
                np.outer(MODULI, rate)
                - np.hstack([np.diag(1 / TIMES), np.zeros((3, 1))]),
                rate,
            ]
        )
        state = np.append(state, slope / 2 * (a**2 - b**2))
    for k in range(3):
        one = np.zeros_like(matrix)
        one[k, k] = 1.0
        inside[k] += (
            state
            @ solve_continuous_lyapunov(matrix.T, -one)
            @ state
            / (MODULI[k] * TIMES[k])
        )
    return inside


@pytest.mark.parametrize(("relaxed", "viscosity"), [(1e6, 0.0), (1e6, 200.0)])
def test_against_the_history_of_each_branch(relaxed, viscosity):
    law = em.Foundation(relaxed, MODULI, TIMES, viscosity)
    found = em.dissipation(law, BALL, **LINE)
    slid = em.friction(law, BALL, **LINE)
    np.testing.assert_allclose(found.share.sum(axis=-1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(
        found.resistance.sum(axis=-1), slid.friction_force, rtol=1e-9
    )
    np.testing.assert_allclose(
        found.power, found.resistance * VELOCITY[:, None], rtol=1e-12
    )
    for i, v in enumerate(VELOCITY):
        expected = by_hand(
            relaxed, viscosity, v, slid.contact.leading[i], slid.contact.trailing[i]
        )
        np.testing.assert_allclose(
            found.resistance[i, -3:], expected, rtol=2e-6, atol=2e-6 * expected.max()
        )
    if viscosity:
        assert (found.time[..., 0] == 0).all()
        assert (found.resistance[:, 0] > 0).all()


def test_limits():
    """Slow: E_k tau_k. One branch: everything. Split into two of one time: halves.
    Liquids lose all the same.
    """
    law = em.Foundation(1e6, MODULI, TIMES)
    slow = em.dissipation(
        law, BALL, velocity=np.array([1e-7, 1.0, 1.0]), load=1.0, model=em.Line()
    )
    np.testing.assert_allclose(
        slow.share[0], MODULI * TIMES / (MODULI @ TIMES), rtol=1e-4
    )
    fast = em.dissipation(
        law, BALL, velocity=np.array([1e7, 1.0, 1.0]), load=1.0, model=em.Line()
    )
    np.testing.assert_allclose(
        fast.share[0], MODULI / TIMES / (MODULI / TIMES).sum(), rtol=1e-4
    )
    one = em.dissipation(em.Foundation(1e6, [3e6, 0.0, 0.0], TIMES), BALL, **LINE)
    np.testing.assert_allclose(one.share, [[1.0, 0.0, 0.0]] * 3, atol=1e-12)
    two = em.dissipation(
        em.Foundation(1e6, [3e6, 3e6, 0.0], [1e-3, 1e-3 * (1 + 1e-9), 1.0]),
        BALL,
        **LINE,
    )
    np.testing.assert_allclose(two.share, [[0.5, 0.5, 0.0]] * 3, atol=1e-6)
    liquid = em.dissipation(em.Foundation(0.0, MODULI, TIMES), BALL, **LINE)
    assert liquid.error.max() < 1e-10


def test_weak_loss_follows_the_direction_average():
    """To first order in the loss each branch's part is its own friction, with the
    average taken of each.
    """
    part = 1e-4
    law = em.Foundation(1e6, part * MODULI, TIMES)
    scene = {
        "velocity": VELOCITY,
        "load": 1.0,
        "model": em.Averaged(corrected=False),
        "rtol": 1e-3,
    }
    found = em.dissipation(law, BALL, **scene)
    for k in range(3):
        alone = em.friction(
            em.Foundation(1e6, [part * MODULI[k]], [TIMES[k]]), BALL, **scene
        )
        np.testing.assert_allclose(
            found.resistance[:, k], alone.friction_force, rtol=5e-3
        )


def test_temperature_and_layers():
    rubber = em.Prony(
        1e6,
        MODULI,
        TIMES,
        poisson=0.4,
        shift=em.WLF(c1=8.86, c2=101.6, reference=293.15),
    )
    layer, roller = em.springs(rubber, 1e-3), em.Cylinder(0.01, 0.02)
    kelvin = np.array([283.15, 293.15, 303.15])
    warm = em.dissipation(layer, roller, velocity=0.1, load=1.0, temperature=kelvin)
    factor = rubber.shift.a(kelvin)
    same = em.dissipation(layer, roller, velocity=0.1 * factor, load=1.0)
    np.testing.assert_allclose(warm.share, same.share, rtol=1e-9)
    np.testing.assert_allclose(warm.time, TIMES * factor[:, None], rtol=1e-12)
    rolled = em.rolling(layer, roller, velocity=0.1, load=1.0, temperature=kelvin)
    np.testing.assert_allclose(warm.power.sum(axis=-1), rolled.power, rtol=1e-5)
    assert "most" in warm.summary()
    assert len(warm.to_dict()["share"]) == 3
    warm.plot()


@pytest.mark.slow
def test_gradient():
    def share(modulus):
        law = em.Foundation(1e6, [modulus, 2e6, 5e6], TIMES)
        return em.dissipation(law, BALL, velocity=0.3, load=1.0, model=em.Line()).share[
            0
        ]

    with jax.enable_x64(True):
        slope = (share(3.01e6) - share(2.99e6)) / 2e4
        np.testing.assert_allclose(jax.jvp(share, (3e6,), (1.0,))[1], slope, rtol=1e-5)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"material": em.Foundation(1e6, [], [])}, ("material", "relaxation")),
        (
            {"shape": em.Profile([0, 1e-3, 2e-3, 3e-3], [0, 1e-4, 1.5e-4, 3e-4])},
            ("shape", "convex"),
        ),
        ({"velocity": -1.0}, ("velocity", -1)),
        ({"temperature": 293.15}, ("", "shift law")),
    ],
)
def test_refusals(change, words):
    scene = {
        "material": em.Foundation(1e6, MODULI, TIMES),
        "shape": BALL,
        "velocity": 1.0,
        "load": 1.0,
    } | change
    with refused(*words):
        em.dissipation(scene.pop("material"), scene.pop("shape"), **scene)
