"""Small forms of scenes in which the stress tests of `benchmarks/robustness` found
wrong answers without a flag.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.special import dawsn

import elastomdr as em
from elastomdr.arrays import numpy_unless_traced
from elastomdr.element import episode
from elastomdr.element.episode import recovery_modes, to_branches, to_modes
from elastomdr.surface.disc import Disc
from elastomdr.transient.depth_history import LAYERS, edges, indent_all, over_histories


@pytest.mark.parametrize("slowness", [1e8, 1e17])
def test_cone_whose_edges_agree_to_rounding(slowness: float) -> None:
    """v tau far above the contact: mu = (2/3) c a/(v tau), a the contact of all moduli,
    first order in a/(v tau).
    """
    found = em.friction(
        em.Foundation(0.0, [7e10], [1e8]),
        em.Cone(2e-4),
        velocity=slowness / 1e9,
        load=4e5,
        model=em.Line(),
    )
    a = found.contact.leading
    assert found.mu == pytest.approx(
        2 / 3 * np.pi / 2 * 2e-4 * a / (slowness / 10), rel=1e-6
    )


def test_cone_on_a_liquid_that_relaxes_within_a_trillionth_of_the_contact() -> None:
    """Contact ends within v tau of the apex, so that every element in it has the slope
    c = pi/2 tan(theta): mu = c.
    """
    found = em.friction(
        em.Foundation(0.0, [1e7, 2e6], [1e-12, 1.1e-12]),
        em.Cone(3e-4),
        velocity=1e-3,
        load=1e-3,
        model=em.Line(),
    )
    slope = np.pi / 2 * 3e-4
    assert abs(found.mu - slope) <= found.error + 1e-12 * slope


def test_element_pulled_by_a_dashpot_is_let_go_at_once() -> None:
    """E u + eta u' + sum f_k < 0 from the start of a fast retreat: the element recovers
    from where it was.
    """
    given = em.Foundation(
        600.0, [8.6e4, 6.5e4, 22.0], [5.11e-3, 5.1105e-3, 5.118e-3], 1.2e4
    )
    law, depth = given.law(), 1.0
    with jax.enable_x64(True):
        law, modes = jax.tree.map(jnp.asarray, (law, recovery_modes(law)))
        follow, pressed = jax.jit(episode.follow), jax.jit(episode.pressed)
        g = jnp.linspace(0.0, 0.9, 7)
        state = follow(
            law, modes, pressed(law, modes, -1.0 - g), -g, depth / 1e-3, 1e-3
        )
        held = np.array(state.u)
        for h, v in ((3e-3, -400.0), (1e-9, -400.0), (0.2, -20.0)):
            free = follow(law, modes, state, depth - g, v, h)
            assert not free.contact.any()
            assert (np.array(free.u) <= held * (1 + 1e-12)).all()
            assert (np.array(free.u) >= 0).all()


@pytest.mark.parametrize("apart", [1e-3, 1e-9, 4e-15])
def test_modes_of_nearly_equal_times(apart: float) -> None:
    """Branch forces of an element without force, to its recovery modes and back."""
    with jax.enable_x64(True):
        law = jax.tree.map(
            jnp.asarray,
            em.Foundation(
                2.0, [1.0, 3.0, 0.5], [1.0, 1.0 + apart, 1.0 + 3 * apart]
            ).law(),
        )
        modes = recovery_modes(law)
        f = jnp.array([[-0.5], [-1.5 - 1e-3], [1e-3]])
        m = to_modes(law, modes, jnp.ones(1), f)
        assert float(m.sum()) == pytest.approx(1.0, rel=1e-13)
        np.testing.assert_allclose(to_branches(law, modes, m), f, rtol=0, atol=1e-13)


@pytest.mark.parametrize(("levels", "missed"), [(1, 1e-2), (LAYERS, 1e-8)])
def test_branch_far_faster_than_the_ramp(levels: int, missed: float) -> None:
    """A Maxwell liquid under a paraboloid g = c x^2: q = E v tau (1 - exp(-(d - g)/(v
    tau))), a layer at the edge.

    F = 2 E v tau (a - sqrt(v tau/c) D(sqrt(d/(v tau)))), D Dawson's integral; the first
    ramp of each history.
    """
    e, c, d = 2.0, 1.0, 0.5
    ramp = 1 / np.array([3e-2, 1e-3, 1e-5, 5e-14])  # in relaxation times
    time = ramp[:, None] * np.array([0.0, 1.0, 2.0, 3.0])
    depth = np.broadcast_to(d * np.array([0.0, -0.6, 1.0, 0.2]), time.shape)
    law = em.Foundation(0.0, [e], [1.0]).law()
    given = (law, recovery_modes(law), Disc(em.Paraboloid(1 / c), "half-space"))
    places = numpy_unless_traced(over_histories)(edges, *given, time, depth)
    found = numpy_unless_traced(indent_all)(*given, time, depth, places, levels)
    reached = 1.6 * d / ramp  # v tau
    exact = (
        2
        * e
        * reached
        * (np.sqrt(d / c) - np.sqrt(reached / c) * dawsn(np.sqrt(d / reached)))
    )
    miss = np.abs(found.force[:, 2] - exact)
    assert (miss <= found.error[:, 2] + 1e-13 * exact).all()
    assert (miss <= missed * exact).all()
    np.testing.assert_allclose(found.radius[:, 2], np.sqrt(d / c), rtol=1e-12)


def test_power_that_is_not_whole_is_covered_by_its_error() -> None:
    """Elastic, g = c r^1.5 kappa: F = 2 E int_0^a (d - g) dx = 2 E d a n/(n + 1), g(a)
    = d.
    """
    shape = em.PowerLaw(1.5, 0.3)
    found = em.indent(
        em.Foundation(5.0, [], []),
        shape,
        time=[0.0, 1.0, 2.0],
        depth=[0.0, 0.02, 0.01],
        rtol=1e-5,
    )
    exact = 2 * 5.0 * 0.02 * found.contact_radius[1] * 1.5 / 2.5
    assert found.converged.all()
    assert 0 < abs(found.force[1] / exact - 1) <= found.error[1]


def test_profile_far_smaller_than_its_first_point():
    """A parabola's points have the parabola for their spline: a contact of 1e-3 to 1e-9
    of the first interval keeps its digits, those of the paraboloid, in mu and in the
    depth.
    """
    r = np.linspace(0.0, 1.0, 8)
    rubber = em.Foundation(1e6, [1e9, 1e3], [1e-8, 1e3])
    asked = {
        "velocity": np.geomspace(1e-9, 1e6, 6),
        "depth": [[1e-19], [1e-12], [1e-7]],
        "rtol": 1e-6,
        "model": em.Line(),
    }
    found = em.friction(
        rubber, em.Profile(r, 0.5 * r**2, apex="smooth", curve="spline"), **asked
    )
    exact = em.friction(rubber, em.Paraboloid(1.0), **asked)
    np.testing.assert_allclose(found.mu, exact.mu, rtol=1e-11)
    np.testing.assert_allclose(found.contact.leading, exact.contact.leading, rtol=1e-12)
    assert (found.error < 1e-6 * found.mu).all()


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_road_in_full_contact_far_above_its_relaxation():
    """v tau q from 1e9 on: Im E* = E/(w tau), so that mu = pi m_2 E/(p v tau), in the
    waves across the motion too.
    """
    road = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)
    asked = {"pressure": 1e12, "velocity": 1e9, "rtol": 1e-8, "model": em.Persson()}
    found = em.friction(em.Foundation(1e6, [1e6], [1e-3]), road, **asked)
    assert float(found.mu) == pytest.approx(
        np.pi * road.moment(2) * 1e6 / (1e12 * 1e9 * 1e-3), rel=3e-9
    )


@pytest.mark.slow  # compiles the march of a line
def test_rough_line_whose_friction_is_lost_in_rounding_says_so():
    """Full contact at v tau q of 1e-12 and less: the sum over the waves, far below the
    rounding of the slopes.
    """
    x = 1e-5 * np.arange(256)
    line = em.RoughLine(x, 1e-4 * np.cos(2 * np.pi * x / 2.56e-3))
    law, asked = (
        em.Foundation(1e6, [1e6], [1e-3]),
        {"velocity": np.logspace(-14, -10, 9), "load": 900.0},
    )
    with pytest.warns(em.ConvergenceWarning):
        found = em.friction(law, line, model=em.Line(), **asked)
    exact = np.asarray(em.reference.full_contact_sliding(law, line, **asked))
    some = found.converged
    assert 2 <= some.sum() < some.size
    assert (
        np.abs(found.mu - exact)[some] <= found.error[some] + 1e-4 * exact[some]
    ).all()
    assert (np.abs(found.mu - exact)[some] <= 0.1 * exact[some]).all()


def test_rubber_that_meets_the_body_and_parts_again_between_two_instants() -> None:
    """Contact regained and lost within one interval was left out: 3e-6 of a later
    force, with an error of 1e-14.
    """
    rubber = em.Foundation(3.04, [1.62, 5.33, 3.03], [6.15, 6.40, 17250.0])
    time, depth = (
        [0, 0.476, 8.28, 147.6, 184.0, 184.7],
        1e-3 * np.array([1.9, 7.2, 0.947, -2.07, -1.27, 8.34]),
    )
    closer = np.interp(np.linspace(0, 5, 81), np.arange(6), time)
    found = [
        em.indent(
            rubber,
            em.Paraboloid(1e-2),
            time=t,
            depth=np.interp(t, time, depth),
            rtol=1e-8,
        ).force[-1]
        for t in (np.array(time), closer)
    ]
    # the edge of what was met in between is no end of a panel
    assert found[0] == pytest.approx(found[1], rel=3e-8)
