"""The same scene in any units, and single arguments at their ends: the right limit, or
NaN with a warning.
"""

import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

LENGTHS = [1e-30, 1e30, 1e45]
TIME = np.linspace(0, 0.02, 3)
NO_SI = pytest.mark.filterwarnings("ignore:The radius of the paraboloid")


def rubber(*branches):
    return (
        em.Prony(1e6, *zip(*branches, strict=True))
        if branches
        else em.Prony(1e6, [], [])
    )


LOSSY = rubber((3e6, 1e-3), (10e6, 1e-5))


def road(unit=1.0):
    return em.SelfAffine(0.8, 0.3, q_low=1e3 / unit, q_high=8e3 / unit)


def on_cells(unit, **given):
    return em.friction(
        LOSSY, road(unit), **given, model=em.HalfSpace(cells=64), rtol=1e-3
    )


@NO_SI
@pytest.mark.parametrize("unit", LENGTHS)
def test_adhesion_in_any_unit_of_length(unit):
    """It was sought between 1e-30 and 1e9 m, and what lay beyond came out at the end of
    that range.
    """

    def depth(unit):
        ball = em.Paraboloid(0.01 * unit)
        return (
            em.indent(
                rubber(),
                ball,
                time=TIME,
                load=unit**2 * (1 + TIME),
                adhesion=0.1 * unit,
            ).depth
            / unit
        )

    np.testing.assert_allclose(depth(unit), depth(1.0), rtol=1e-12)


@NO_SI
@pytest.mark.parametrize("unit", LENGTHS)
def test_shear_in_any_unit_of_length(unit):
    """The elements of the line reached too far, or not far enough, and depths were
    wrong by decades.
    """

    def found(unit):
        moved = em.shear(
            rubber(),
            em.Paraboloid(0.01 * unit),
            time=TIME,
            displacement=1e-3 * TIME * unit,
            friction=0.5,
            load=unit**2,
        )
        assert moved.converged.all()
        return [moved.depth / unit, moved.contact_radius / unit]

    np.testing.assert_allclose(found(unit), found(1.0), rtol=1e-9)


@pytest.mark.parametrize("unit", LENGTHS)
def test_cells_under_a_surface_in_any_unit_of_length(unit):
    """32 bits did not hold some of it: NumPy's own errors, or no friction."""
    np.testing.assert_allclose(
        on_cells(unit, velocity=0.1 * unit, pressure=1e5).mu,
        on_cells(1.0, velocity=0.1, pressure=1e5).mu,
        rtol=1e-6,
    )


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_cells_in_full_contact_and_at_a_crawl():
    """In full contact friction stress does not depend on the pressure; at a crawl mu ~
    v.
    """
    full = on_cells(1.0, velocity=1.0, pressure=[1e8, 1e30, 1e90])
    assert (full.area_ratio == 1).all()
    np.testing.assert_allclose(full.friction_force, full.friction_force[0], rtol=1e-12)
    slow = on_cells(1.0, velocity=[1e-60, 1e-9], pressure=1e5)
    assert slow.mu[1] / slow.mu[0] == pytest.approx(1e51, rel=1e-6)
    with pytest.warns(em.ConvergenceWarning):
        assert np.isnan(on_cells(1.0, velocity=1.0, pressure=1e-30).mu)


@pytest.mark.parametrize(
    "asked", [{"velocity": 1e-90, "load": 1e2}, {"velocity": 1.0, "load": 1e-60}]
)
def test_a_rough_line_that_no_sampling_answers_is_given_up_at_once(asked):
    """It was tried on ever more samples, up to a million, for a minute."""
    x = 1e-5 * np.arange(64)
    line = em.RoughLine(x, 4e-6 * np.cos(2 * np.pi * x / 6.4e-4))
    seen = []
    with pytest.warns(em.ConvergenceWarning):
        found = em.friction(
            LOSSY, line, **asked, rtol=1e-3, progress=lambda done, _: seen.append(done)
        )
    assert np.isnan(found.mu)
    assert len(seen) == 1


def test_a_ball_on_a_layer_too_slow_for_a_loss_is_flagged():
    """Its friction was 3e-18 at any velocity, and counted as converged."""
    layer = em.layer(rubber((3e6, 1e-3)), 5e-3)
    with pytest.warns(em.ConvergenceWarning):
        found = em.friction(
            layer, em.Paraboloid(0.01), velocity=1e-60, load=10.0, model="line"
        )
    assert np.isnan(found.mu)


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_a_pressed_surface_in_motion_at_both_ends():
    """Stiffness was negative in full contact, and finite without a load."""
    found = em.press(LOSSY, road(), pressure=[1e12, 1e90], velocity=1.0)
    assert (found.separation == 0).all()
    assert np.isinf(found.stiffness).all()
    with pytest.warns(em.ConvergenceWarning):
        assert np.isnan(em.press(LOSSY, road(), pressure=1e-30, velocity=1.0).stiffness)


def test_coefficient_of_a_steep_body_in_metres() -> None:
    """(1 mm)^(1-n) is 1e117 for r^40; the same body in another unit of length has the
    same friction.
    """
    rubber = em.Foundation(1e6, [9e6], [1e-3])
    near, far = (
        em.friction(
            rubber,
            em.PowerLaw(40, s * (1e-3 * s) ** -40 * 1e-4),
            velocity=s * 1e-2,
            load=s**2 * 1e-3,
        )
        for s in (1.0, 1e-3)
    )
    assert near.converged
    assert near.mu == pytest.approx(far.mu, rel=1e-9)
    with refused("coefficient", 1e-100, 1e100):
        em.PowerLaw(2, 1e120)


def test_roads_at_the_ends_of_velocity() -> None:
    """mu ~ v and 1/v over 150 decades; beyond them the velocity is refused by name."""
    rubber, road = (
        em.StandardSolid(1e6, 9e6, 1e-3),
        em.SelfAffine(0.8, rms_slope=0.1, q_low=1e3, q_high=3e4),
    )
    mu = em.friction(rubber, road, velocity=[1e-91, 1e-20, 1e20, 1e90], pressure=1e5).mu
    assert mu[1] / mu[0] == pytest.approx(1e71, rel=1e-6)
    assert mu[3] / mu[2] == pytest.approx(1e-70, rel=1e-6)
    for beyond in (1e-95, 1e95):
        with refused("velocity", 1e-92, "3e"):
            em.friction(rubber, road, velocity=beyond, pressure=1e5)
