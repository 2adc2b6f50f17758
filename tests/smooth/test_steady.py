"""Limits, invariances, the error estimate and the plan of steady sliding and
rolling.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.smooth import solve as sweep_of_points

from ..refused import warned

BROAD = em.Foundation(1e6, 1e8 / 10 ** np.linspace(0, 2, 16), 10.0 ** np.arange(-8, 8))
SHAPES = {
    "paraboloid": em.Paraboloid(5e-3),
    "sphere": em.Sphere(5e-3),
    "cone": em.Cone(0.1),
    "fourth power": em.PowerLaw(4, 2e6),
}


def _hertz(modulus, load, radius):
    return (0.75 * load * radius / modulus) ** (1 / 3)


def test_extreme_velocities_with_40_branches_over_24_decades():
    foundation = em.Foundation(1e5, np.full(40, 1e6), np.logspace(-12, 12, 40))
    velocity = np.logspace(-12, 8, 41)
    for model in (em.Averaged(corrected=False), em.Averaged(), em.Line()):
        curve = em.friction(
            foundation, em.Paraboloid(5e-3), velocity=velocity, load=1.0, model=model
        )
        assert curve.converged.all()
        assert np.isfinite(curve.mu).all()
        assert (curve.mu > 0).all()
        assert (curve.error <= 1e-6 * curve.mu).all()


@pytest.mark.parametrize("model", [em.Averaged(corrected=False), em.Line()])
def test_both_ends_meet_hertz_and_friction_falls_as_it_must(model):
    # Twelve decades of spectrum, and velocities that put every passage a long way
    # outside of it.
    moduli, times = np.full(40, 1e6), np.logspace(-6, 6, 40)
    foundation, radius, load = em.Foundation(1e6, moduli, times), 5e-3, 1.0
    slow, fast = np.array([1e-20, 1e-19]), np.array([1e15, 1e16])
    low = em.friction(
        foundation, em.Paraboloid(radius), velocity=slow, load=load, model=model
    )
    high = em.friction(
        foundation, em.Paraboloid(radius), velocity=fast, load=load, model=model
    )
    relaxed, glassy = _hertz(1e6, load, radius), _hertz(41e6, load, radius)
    for edge in (low.contact.leading, low.contact.trailing):
        np.testing.assert_allclose(edge, relaxed, rtol=1e-9)
    for edge in (high.contact.leading, high.contact.trailing):
        np.testing.assert_allclose(edge, glassy, rtol=1e-9)
    factor = 2 if isinstance(model, em.Line) else 1
    np.testing.assert_allclose(
        low.mu, factor * slow * (moduli * times).sum() / (1e6 * radius), rtol=1e-6
    )
    depth = glassy**2 / radius
    np.testing.assert_allclose(
        high.mu, 0.8 * depth * (moduli / times).sum() / (41e6 * fast), rtol=1e-6
    )


@pytest.mark.parametrize("shape", ["paraboloid", "fourth power"])
def test_ratio_of_line_to_half_space_is_two_at_low_and_one_at_high_speed(shape):
    foundation = em.Foundation(1e6, [1e6], [1e-3])
    scene = {"velocity": [1e-7, 1e7], "load": 1.0}
    line = em.friction(foundation, SHAPES[shape], model=em.Line(), **scene).mu
    average = em.friction(foundation, SHAPES[shape], **scene).mu
    np.testing.assert_allclose(line / average, [2.0, 1.0], rtol=1e-5)


@pytest.mark.parametrize("shape", ["paraboloid", "sphere"])
def test_depth_and_load_control_agree(shape):
    velocity, rtol = np.logspace(-5, 2, 4), 1e-8 if shape == "paraboloid" else 1e-6
    by_load = em.friction(BROAD, SHAPES[shape], velocity=velocity, load=0.3, rtol=rtol)
    by_depth = em.friction(
        BROAD, SHAPES[shape], velocity=velocity, depth=by_load.depth, rtol=rtol
    )
    np.testing.assert_allclose(by_depth.normal_force, 0.3, rtol=1e-10)
    np.testing.assert_allclose(by_depth.mu, by_load.mu, rtol=2 * rtol)


def test_scaling_of_length_modulus_and_time():
    velocity = np.logspace(-4, 2, 7)
    base = em.friction(BROAD, em.Sphere(5e-3), velocity=velocity, load=0.3)
    length, stiffness, time = 3.7e2, 4.1e-3, 8.3e5
    foundation = em.Foundation(
        BROAD.equilibrium * stiffness, BROAD.moduli * stiffness, BROAD.times * time
    )
    scaled = em.friction(
        foundation,
        em.Sphere(5e-3 * length),
        velocity=velocity * length / time,
        load=0.3 * stiffness * length**2,
    )
    # two grids in log v, each to 1e-8
    np.testing.assert_allclose(scaled.mu, base.mu, rtol=1e-7)
    np.testing.assert_allclose(scaled.depth, base.depth * length, rtol=1e-12)


def test_two_half_branches_equal_one():
    one = em.Foundation(1e6, [4e6], [1e-3])
    two = em.Foundation(1e6, [2e6, 2e6], [1e-3 * (1 - 1e-15), 1e-3])
    scene = {"velocity": np.logspace(-2, 2, 5), "load": 1.0, "rtol": 1e-9}
    a, b = (em.friction(f, em.Paraboloid(5e-3), **scene).mu for f in (one, two))
    np.testing.assert_allclose(a, b, rtol=1e-12)


def test_broadcasting():
    velocity, load = np.logspace(-3, 0, 4), np.array([[0.1], [1.0]])
    curve = em.friction(BROAD, em.Paraboloid(5e-3), velocity=velocity, load=load)
    assert (
        curve.mu.shape
        == curve.depth.shape
        == curve.contact.leading.shape
        == curve.converged.shape
        == (2, 4)
    )
    single = em.friction(BROAD, em.Paraboloid(5e-3), velocity=velocity[2], load=1.0)
    np.testing.assert_allclose(curve.mu[1, 2], single.mu, rtol=2e-6)
    assert single.mu.shape == ()


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_elastic_bodies_lose_nothing(shape):
    """Under an elastic cone nothing in the exit density tells where the edge is but
    rounding.
    """
    for model in (em.Averaged(corrected=False), em.Averaged(), em.Line()):
        curve = em.friction(
            em.Foundation(4e6, [], []),
            shape,
            velocity=[1.0, 2.0],
            load=1.0,
            model=model,
        )
        assert curve.converged.all()
        assert (curve.mu == 0).all()
        assert (curve.depth > 0).all()
        np.testing.assert_allclose(
            curve.contact.leading, curve.contact.trailing, rtol=1e-12
        )


def test_temperature_is_a_shift_of_velocity():
    shift = em.WLF(8.86, 101.6, 293.15)
    material = em.Prony(1e5, [1e6, 1e7], [1e-3, 1.0], shift=shift)
    temperature = np.array([[283.15], [313.15]])
    velocity = np.logspace(-4, 1, 6)
    warm = em.friction(
        material, em.Sphere(5e-3), velocity=velocity, load=1.0, temperature=temperature
    )
    assert warm.temperature.shape == warm.mu.shape == (2, 6)
    shifted = em.friction(
        material, em.Sphere(5e-3), velocity=velocity * shift.a(temperature), load=1.0
    )
    np.testing.assert_allclose(warm.mu, shifted.mu, rtol=2e-6)
    at = em.friction(material.at(313.15), em.Sphere(5e-3), velocity=velocity, load=1.0)
    np.testing.assert_allclose(warm.mu[1], at.mu, rtol=2e-6)


def test_two_bodies_halve_the_modulus():
    material = em.StandardSolid(1e6, 3e6, 1e-3)
    both, one = em.half_space(material, material), em.half_space(material)
    np.testing.assert_allclose(
        both.relaxation(2e-3), 0.5 * one.relaxation(2e-3), rtol=1e-12
    )
    scene = {"velocity": 0.1, "load": 1.0}
    half = em.Foundation(one.equilibrium / 2, one.moduli / 2, one.times)
    got, expected = (em.friction(f, em.Sphere(5e-3), **scene).mu for f in (both, half))
    np.testing.assert_allclose(got, expected, rtol=1e-6)


@pytest.mark.parametrize("model", [em.Averaged(corrected=False), em.Line()])
def test_rolling_is_the_dissipated_power(model):
    scene = {"velocity": np.array([0.1, 1.0]), "load": 1.0, "model": model}
    rolls = em.rolling(BROAD, em.Sphere(5e-3), **scene)
    slides = em.friction(BROAD, em.Sphere(5e-3), **scene)
    np.testing.assert_array_equal(rolls.coefficient, slides.mu)
    np.testing.assert_allclose(
        rolls.power, slides.friction_force * scene["velocity"], rtol=1e-15
    )
    np.testing.assert_allclose(rolls.moment, 5e-3 * rolls.resistance, rtol=1e-15)


def test_a_sphere_on_a_layer_is_its_strips():
    # Strips of a paraboloid are parabolas of the same curvature: many cylinders of
    # small length, each at its own depth.
    layer = em.Foundation(1e9, [4e9], [1e-3], per_area=True)
    total = em.friction(layer, em.Paraboloid(0.05), velocity=2.0, depth=1e-4, rtol=1e-8)
    half_width = np.sqrt(2 * 0.05 * 1e-4)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    y, dy = (
        half_width * np.sin(np.pi / 2 * nodes),
        half_width * np.pi / 2 * np.cos(np.pi / 2 * nodes) * weights,
    )
    strip = em.friction(
        layer, em.Cylinder(0.05, 1.0), velocity=2.0, depth=1e-4 - y**2 / 0.1, rtol=1e-8
    )
    np.testing.assert_allclose(
        total.normal_force, (strip.normal_force * dy).sum(), rtol=1e-7
    )
    np.testing.assert_allclose(
        total.friction_force, (strip.friction_force * dy).sum(), rtol=1e-7
    )
    assert "layer" in total.model


def test_a_cone_on_springs():
    # Springs k and dashpots eta per area at low speed: F_N = k slope pi a^3/3 and
    # F_x = eta v slope^2 pi a^2/2.
    layer = em.Foundation(2e10, [], [], viscosity=2e7, per_area=True)
    cone = em.Cone(0.1)
    slow = em.friction(layer, cone, velocity=1e-6, depth=1e-4)
    np.testing.assert_allclose(slow.normal_force, 2e10 * 0.1 * np.pi * 1e-9 / 3, 1e-6)
    np.testing.assert_allclose(slow.mu, 1.5 * 2e7 * 1e-6 * 0.1 / (2e10 * 1e-3), 1e-5)
    # It has no length of its own: at twice the velocity and eight times the load all
    # lengths are twice as large. Edges are found from the tip to the last strip.
    rubber = em.Foundation(
        2e8, np.geomspace(2e10, 2e8, 16), np.logspace(-7, 2, 16), per_area=True
    )
    velocity = np.array([1e-5, 1e-3, 0.1, 10.0])
    near = em.friction(rubber, cone, velocity=velocity, load=1.0)
    far = em.friction(rubber, cone, velocity=2 * velocity, load=8.0, rtol=1e-4)
    assert (np.abs(far.mu - near.mu) <= far.error + near.error).all()
    assert (near.error <= 1e-6 * near.mu).all()


def test_a_sphere_given_as_points_is_the_sphere():
    radius = 5e-3
    r = np.linspace(0, 0.6 * radius, 80)
    points = em.Profile(r, radius - np.sqrt(radius**2 - r**2))
    scene = {
        "velocity": np.logspace(-3, 1, 4),
        "load": 0.3,
        "rtol": 1e-6,
        "model": em.Line(),
    }
    got, expected = (
        em.friction(BROAD, points, **scene),
        em.friction(BROAD, em.Sphere(radius), **scene),
    )
    assert got.converged.all()
    np.testing.assert_allclose(got.mu, expected.mu, rtol=1e-6)  # the spline's own error


def test_a_sharp_profile_is_the_cone():
    r = np.linspace(0, 5e-3, 20)
    scene = {"velocity": np.logspace(-3, 1, 3), "load": 0.3, "model": em.Line()}
    got = em.friction(BROAD, em.Profile(r, 0.1 * r), **scene)
    np.testing.assert_allclose(
        got.mu, em.friction(BROAD, em.Cone(0.1), **scene).mu, rtol=1e-9
    )


def test_power_laws_join_up():
    # A quadratic power law is the paraboloid (an exact rule); 2.0001 takes the graded
    # rule and must come out beside it.
    scene = {"velocity": 0.1, "load": 1.0, "model": em.Line()}
    exact = em.friction(BROAD, em.Paraboloid(5e-3), **scene)
    np.testing.assert_allclose(
        em.friction(BROAD, em.PowerLaw(2, 100.0), **scene).mu, exact.mu, rtol=1e-13
    )
    near = em.friction(BROAD, em.PowerLaw(2.0001, 100.0), **scene)
    np.testing.assert_allclose(near.mu, exact.mu, rtol=2e-3)


@pytest.mark.parametrize("exponent", [1.001, 1.5, 9.5, 40.0, 120.0])
@pytest.mark.filterwarnings("ignore:.*deeper than the radius")
def test_small_losses_of_power_laws_keep_their_digits(exponent):
    """Slowly, mu = (E_1/E_inf) v tau (1/a^2) d n (n + 1)/(2 n - 1): int g'^2 over the
    elastic contact; by hand.
    """
    n, coefficient, depth = exponent, 1e3, 1e-6
    kappa = (
        math.sqrt(math.pi)
        * n
        / 2
        * math.exp(math.lgamma(n / 2) - math.lgamma((n + 1) / 2))
    )
    a = (depth / (kappa * coefficient)) ** (1 / n)
    velocity = a / 1e-3 * np.array([1e-11, 1e-9])
    slow = em.friction(
        em.Foundation(1e6, [4e6], [1e-3]),
        em.PowerLaw(n, coefficient),
        velocity=velocity,
        depth=depth,
        model=em.Line(),
    )
    assert slow.converged.all()
    # What follows is of the next order, v tau/a times how steep the slope is: 120 x
    # 1e-9 at most.
    expected = 4 * velocity * 1e-3 * depth * n * (n + 1) / ((2 * n - 1) * a**2)
    np.testing.assert_allclose(slow.mu, expected, rtol=1e-6)


def test_plan_reads_well_and_agrees_with_the_run():
    scene = {"velocity": np.logspace(-6, 1, 64), "load": 10.0}
    plan = em.plan(BROAD, em.Sphere(5e-3), **scene)
    text = str(plan)
    for word in (
        "friction",
        "sphere",
        "64 points",
        "branches",
        "directions",
        "not needed",
    ):
        assert word in text
    plan = em.plan(BROAD, em.Paraboloid(5e-3), **scene)
    assert "closed form" in str(plan)
    assert plan == em.friction(BROAD, em.Paraboloid(5e-3), **scene).plan
    assert "mu is zero" in str(
        em.plan(em.Foundation(1e6, [], []), em.Sphere(5e-3), **scene)
    )


def test_leaves_the_users_jax_setting_alone():
    before = jax.config.jax_enable_x64
    curve = em.friction(BROAD, em.Paraboloid(5e-3), velocity=[0.1], load=1.0)
    assert curve.mu.dtype == np.float64
    assert jax.config.jax_enable_x64 == before
    assert jnp.ones(1).dtype == (np.float64 if before else np.float32)


@pytest.mark.slow
def test_a_sphere_sinks_in_a_liquid():
    liquid = em.Foundation(0.0, [1e7, 1e6], [1e-4, 1.0])
    with warned(em.ConvergenceWarning, "1 of 2", 0.005):
        curve = em.friction(
            liquid, SHAPES["sphere"], velocity=[1e-8, 1.0], load=0.1, model=em.Line()
        )
    assert curve.converged.tolist() == [False, True]
    assert np.isnan(curve.mu[0])
    assert np.isfinite(curve.mu[1])
    with pytest.warns(em.ConvergenceWarning, match="carries nothing at rest"):
        curve = em.friction(liquid, SHAPES["sphere"], velocity=1.0, load=0.1)
    assert np.isnan(curve.mu)


def test_a_branch_of_no_modulus_changes_nothing():
    scene = {
        "shape": em.Paraboloid(5e-3),
        "velocity": 1.0,
        "load": 1.0,
        "model": em.Line(),
    }
    with_empty = em.friction(em.Foundation(1e6, [0.0, 1e6], [1e-9, 1e-3]), **scene)
    np.testing.assert_allclose(
        with_empty.mu,
        em.friction(em.Foundation(1e6, [1e6], [1e-3]), **scene).mu,
        rtol=1e-13,
    )
    elastic = em.Foundation(1e6, [0.0], [1e-3])
    assert em.friction(elastic, **scene).mu == 0
    np.testing.assert_allclose(elastic.creep_compliance([0.0, 1.0]), 1e-6, rtol=1e-15)


def averaged(law, shape, velocity, load):
    """The direction average by Gauss' rule over 960 bare lines: panels so short that a
    bend does no harm.
    """
    node, weight = np.polynomial.legendre.leggauss(12)
    panels = 80
    s = 20 * ((np.arange(panels)[:, None] + 0.5 * (node + 1)) / panels).ravel()
    angle = np.pi / 2 * np.exp(-s)
    lines = em.friction(
        law,
        shape,
        velocity=velocity[:, None] * np.sin(angle),
        load=load,
        rtol=1e-9,
        model=em.Line(),
    )
    return (
        2
        / np.pi
        * (lines.mu * np.sin(angle) * angle)
        @ np.tile(10 * weight / panels, panels)
    )


@pytest.mark.parametrize("contrast", [9.0, 999.0])
def test_where_friction_of_a_cone_bends_its_average_holds(contrast):
    """mu_line(log v) is as good as kinked there: 40 directions are off by 2e-5 to 4e-4,
    and nothing in them says so.
    """
    law = em.Foundation(4e6, [contrast * 4e6], [1e-3])
    velocity = np.geomspace(0.1 / contrast**0.5, 10 * contrast**0.5, 9)
    bare = em.Averaged(corrected=False)
    truth = averaged(law, em.Cone(0.1), velocity, 10.0)
    for rtol in (1e-3, 1e-6):
        alone = [
            em.friction(law, em.Cone(0.1), velocity=v, load=10.0, rtol=rtol, model=bare)
            for v in velocity[3:6]
        ]
        sweep = em.friction(
            law, em.Cone(0.1), velocity=velocity, load=10.0, rtol=rtol, model=bare
        )
        depth = em.friction(
            law,
            em.Cone(0.1),
            velocity=velocity[4],
            depth=float(alone[1].depth),
            rtol=rtol,
            model=bare,
        )
        found = np.array([*(one.mu for one in alone), *sweep.mu, depth.mu])
        error = np.array([*(one.error for one in alone), *sweep.error, depth.error])
        off = np.abs(found / np.array([*truth[3:6], *truth, truth[4]]) - 1)
        assert (off <= rtol).all()
        assert (off <= error / found + 1e-9).all()


@pytest.mark.parametrize(
    "shape", [em.Paraboloid(0.01), em.Cone(0.1)], ids=["paraboloid", "cone"]
)
def test_a_long_sweep_reads_depth_and_edges_from_its_curve(shape, monkeypatch):
    solved, solve = [], sweep_of_points._solve

    def counted(*scene):
        solved.append(scene[3].size)
        return solve(*scene)

    law = em.Foundation(4e6, [36e6], [1e-3])
    velocity = np.geomspace(1e-3, 1e3, 700)
    some = velocity[::70]
    bare = em.Averaged(corrected=False)
    for rtol in (1e-2, 1e-6):
        solved.clear()
        with monkeypatch.context() as patched:
            patched.setattr(sweep_of_points, "_solve", counted)
            sweep = em.friction(
                law, shape, velocity=velocity, load=10.0, rtol=rtol, model=bare
            )
        if rtol > 1e-3:
            assert sweep.plan.solutions - 2 <= sum(solved) < velocity.size / 2
        alone = em.friction(
            law, shape, velocity=some, load=10.0, rtol=1e-9, model=em.Line()
        )
        np.testing.assert_allclose(
            sweep.mu[::70], averaged(law, shape, some, 10.0), rtol=rtol
        )
        for field in ("depth", "normal_force"):
            np.testing.assert_allclose(
                getattr(sweep, field)[::70], getattr(alone, field), rtol=rtol
            )
        np.testing.assert_allclose(
            sweep.contact.leading[::70], alone.contact.leading, rtol=rtol
        )
        np.testing.assert_allclose(
            sweep.contact.trailing[::70], alone.contact.trailing, rtol=rtol
        )
