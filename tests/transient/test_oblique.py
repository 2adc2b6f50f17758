"""Oblique impact with friction: limits, symmetry, against em.shear, energy,
extremes.
"""

import functools
import sys

import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

R, M, V, E = 0.01, 0.02, 1.5, 4e6
BALL = em.Paraboloid(R)
NORMAL, TANGENTIAL = em.Foundation(E, [], []), em.Foundation(E * 2 / 3, [], [])


def strike(u, mu, **changes):
    scene = {"tangential_velocity": u, "friction": mu, "tangential": TANGENTIAL}
    return em.impact(NORMAL, BALL, mass=M, velocity=V, **scene | changes)


# velocities of the point of contact and friction: none, full slip, partial slip, and
# infinite and nearly infinite friction
U, MU = [1.0, 5.0, 0.4, 0.5, 0.5], [0.0, 0.3, 0.3, np.inf, 100.0]


@functools.cache
def all_strikes():
    return strike(U, MU).oblique


def test_limits_of_friction():
    """Full slip: the impulse is mu (1 + e) m v; without friction nothing happens;
    nothing slips at mu = inf.
    """
    found = all_strikes()
    np.testing.assert_allclose(found.tangential_mass, 2 / 7 * M, rtol=1e-12)
    np.testing.assert_allclose(found.after[0], 1, rtol=1e-12)
    np.testing.assert_allclose(found.after[1], 5 - 0.3 * 2 * V * 3.5, rtol=1e-7)
    assert np.all(found.error[:2] < 1e-4)


def test_what_is_lost_is_lost_by_slip_of_an_elastic_contact():
    """With infinite friction too: elements that let go, strained as they are, give
    their energy to nobody.
    """
    found = all_strikes()
    np.testing.assert_allclose(found.slip_loss[1], found.lost[1], rtol=1e-7)
    np.testing.assert_allclose(found.slip_loss[2], found.lost[2], rtol=1e-5)
    # of first order
    np.testing.assert_allclose(found.slip_loss[3], found.lost[3], rtol=1e-3)


def test_error_covers_what_finer_steps_and_more_elements_change(monkeypatch):
    found = all_strikes()
    module = sys.modules["elastomdr.transient.oblique_impact"]
    monkeypatch.setattr(module, "_ELEMENTS", 1000)
    monkeypatch.setattr(module, "_STEPS", 32)
    finer = strike(U[1:], MU[1:]).oblique.after
    assert (np.abs(found.after[1:] - finer) <= found.error[1:]).all()


@pytest.mark.parametrize("mu", [0.3, 0.0])
def test_full_slip_of_a_viscoelastic_impact(mu):
    """F_x = mu F_N throughout, so that the impulse is mu (1 + e) m v whatever the
    rubber is.
    """
    normal, tangential = (em.Foundation(k * E, [2 * k * E], [1e-3]) for k in (1, 2 / 3))
    found = em.impact(
        normal,
        BALL,
        mass=M,
        velocity=V,
        tangential_velocity=5.0,
        friction=mu,
        tangential=tangential,
    )
    np.testing.assert_allclose(
        found.oblique.after, 5 - mu * (1 + found.restitution) * V * 3.5, rtol=1e-5
    )


def test_is_odd_and_scales_and_agrees_with_shear():
    """u/(mu v) decides, so that twice the friction and twice the velocity are the same
    impact; the motion, imposed by `em.shear` along straight lines, gives about the same
    tangential forces.
    """
    found = strike([0.4, -0.4, 0.8], [0.3, 0.3, 0.6])
    h, t = found.history, found.oblique
    np.testing.assert_allclose(t.after / t.after[0], [1, -1, 2], rtol=1e-9)
    assert t.after[0] < 0  # it comes back: the contact stores tangential energy
    speed, time = t.velocity[0], h.time[0]
    u = np.concatenate([[0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    force = em.shear(
        NORMAL,
        BALL,
        time=time,
        displacement=u,
        friction=0.3,
        depth=np.maximum(h.depth[0], 0),
        tangential=TANGENTIAL,
        elements=1000,
    ).force
    np.testing.assert_allclose(t.force[0], force, atol=0.04 * np.abs(force).max())


def test_energy_and_bad_input():
    rubber = em.StandardSolid(1e6, 3e6, 1e-3)
    found = em.impact(
        rubber, BALL, mass=M, velocity=V, tangential_velocity=1.0, friction=0.5
    )
    assert 0 < found.oblique.slip_loss < found.oblique.lost
    assert "tangential velocity at separation [m/s]" in found.csv()
    for changes, message in (
        ({"friction": None}, ("friction", "tangential_velocity")),
        ({"tangential": None}, ("tangential", "Foundation")),
        ({"u": None}, ("friction", "tangential_velocity", 0.3)),
        ({"inertia": -1.0}, ("inertia", -1)),
    ):
        arguments = {"u": 1.0, "mu": 0.3} | {
            ("mu" if k == "friction" else k): v for k, v in changes.items()
        }
        with refused(*message):
            strike(**arguments)
