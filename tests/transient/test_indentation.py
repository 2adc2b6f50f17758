"""Indentation: exact answers, slow independent routes, invariants, derivatives,
refusals.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import elastomdr as em
from elastomdr.element.contact_step import contact_step, rest
from elastomdr.material.relaxation import to_kelvin
from elastomdr.surface.disc import Disc, disc_under
from elastomdr.surface.shapes import Paraboloid, PowerLaw, Sphere
from elastomdr.transient.adhesive_contact import Sticky

from ..refused import refused
from ..whole.problems.indentation import BALL, PROBLEMS, PULSES, SOLID, TIMES, TWICE


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


# ---------------------------------------------------------------- exact answers


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_exact_answer(problem):
    result = problem.solve()
    for field, values in problem.expected.items():
        for i, value in values.items():
            got = float(getattr(result, field)[i])
            scale = np.nanmax(np.abs(getattr(result, field)))
            np.testing.assert_allclose(
                got,
                value,
                rtol=problem.rtol,
                atol=1e-9 * scale * (value == 0),
                err_msg=field,
            )


def test_broad_spectrum_after_a_peak_is_tings():
    """Sixteen times over nine decades, where the error falls by no whole power of the
    step: the radius on the way back is that of the way there at t1, int_0^t1 E(t - s)
    J(s) ds = F(t) under a load that rose by 1 N/s (Ting 1966).
    """
    rubber = em.Prony(
        1e6, np.geomspace(1e8, 1e6, 16), np.logspace(-7, 2, 16), poisson=0.4
    )
    result = em.indent(
        rubber, Paraboloid(5e-3), time=[0, 1, 2], load=[0, 1, 0.2], rtol=1e-5
    )
    law = em.half_space(rubber).law()
    chain = to_kelvin(law)
    node, weight = np.polynomial.legendre.leggauss(20)

    def up_to(end, function):
        ends = end * np.append(0.0, np.logspace(-9, 0, 60))
        half = 0.5 * np.diff(ends)[:, None]
        return np.sum(half * weight * function(ends[:-1, None] + half * (1 + node)))

    def creep(s):
        return (
            chain.instantaneous
            - np.expm1(-s[..., None] / chain.times) @ chain.compliances
        )

    def relaxing(s):
        return law.equilibrium + np.exp(-s[..., None] / law.times) @ law.moduli

    back = brentq(
        lambda end: up_to(end, lambda s: relaxing(2 - s) * creep(s)) - 0.2, 1e-6, 1
    )
    radius = (0.75 * 5e-3 * up_to(back, creep)) ** (1 / 3)
    np.testing.assert_allclose(result.contact_radius[-1], radius, rtol=1e-5)
    assert result.converged.all()


def test_error_covers_the_truth():
    problem = PROBLEMS[0]
    result = problem.solve()
    for i, value in problem.expected["force"].items():
        assert abs(result.force[i] - value) <= result.error[i] * result.force.max()


# ---------------------------------------------------------------- whole contacts,
# against each other


def test_renewed_contact_against_elements_summed_slowly():
    """The sum over many elements, each marched in 4000 steps: force while shrinking,
    growing again, and held.
    """
    result = em.indent(SOLID, BALL, time=TIMES, depth=TWICE)
    assert result.converged.all()
    assert (np.diff(result.contact_radius) < 0).any()
    law = jax.tree.map(jnp.asarray, SOLID.law())
    x, dx = np.polynomial.legendre.leggauss(400)
    reach = float(np.sqrt(TWICE.max()))
    x, dx = reach * (x + 1) / 2, reach * dx / 2
    t = np.linspace(0, 2, 4001)
    w = np.interp(t, TIMES, TWICE)

    def step(state, d):
        state = contact_step(law, state, d[0] - x**2, d[1] - x**2, t[1])
        return state, 2 * jnp.sum(dx * state.q)

    _, slow = jax.jit(lambda w: jax.lax.scan(step, rest(law, x.size), (w[:-1], w[1:])))(
        w
    )
    np.testing.assert_allclose(
        result.force[1:],
        np.interp(TIMES[1:], t[1:], slow),
        atol=3e-5 * result.force.max(),
    )


def test_work_is_the_integral_of_force_over_depth():
    """Gauss' rule in time over the closed force, interval by interval of a history
    without a kink.
    """
    nodes, weights = np.polynomial.legendre.leggauss(5)
    corners = np.array([0, 0.02, 0.05, 0.12, 0.25, 0.5, 1.0, 1.1])
    inner = corners[:-1, None] + np.diff(corners)[:, None] * (nodes + 1) / 2
    time = np.sort(np.concatenate([corners, inner.ravel()]))
    depth = np.interp(time, [0, 1, 1.2], [0, 0.01, 0.009])
    result = em.indent(SOLID, BALL, time=time, depth=depth, rtol=1e-9)
    got = result.force[np.isin(time, inner)].reshape(inner.shape)
    rate = np.where(corners[:-1] < 1, 0.01, -0.005)
    summed = np.cumsum((got @ weights) * np.diff(corners) / 2 * rate)
    # The first two intervals hold the root with which a contact begins.
    got = np.diff(result.work[np.isin(time, corners)])[2:]
    np.testing.assert_allclose(got, np.diff(summed)[1:], rtol=1e-8)
    np.testing.assert_allclose(
        result.work, result.stored + result.dissipated, rtol=1e-14
    )
    assert (result.locked <= result.dissipated * (1 + 1e-12) + 1e-20).all()


def test_creep_in_closed_form_against_its_own_depth():
    """The depth that comes out under a load, given back as a depth, needs that load,
    and stores the same energy.
    """
    time = np.append(0.0, np.geomspace(1e-3, 5.0, 100))
    crept = em.indent(SOLID, BALL, time=time, load=3e-3)
    pressed_again = em.indent(SOLID, BALL, time=time, depth=crept.depth)
    np.testing.assert_allclose(pressed_again.force, 3e-3, rtol=1e-3)
    np.testing.assert_allclose(
        pressed_again.contact_radius, crept.contact_radius, rtol=1e-9
    )
    for field in ("work", "stored"):
        np.testing.assert_allclose(
            getattr(pressed_again, field), getattr(crept, field), rtol=1e-3
        )
    # Under a dead load the work is the load times the way.
    np.testing.assert_allclose(
        np.diff(crept.work), 3e-3 * np.diff(crept.depth), rtol=1e-8, atol=1e-16
    )


@pytest.mark.parametrize("viscosity", [0.0, 0.2])
def test_load_in_steps_converges_and_meets_the_closed_form(viscosity):
    foundation = em.Foundation(1.0, [3.0], [0.5], viscosity)
    result = em.indent(foundation, BALL, time=TIMES, load=PULSES, rtol=1e-5)
    assert result.converged.all()
    np.testing.assert_allclose(result.force, PULSES, rtol=1e-14)
    coarse = em.indent(foundation, BALL, time=TIMES, load=PULSES, rtol=1e-3)
    off = np.abs(coarse.depth - result.depth).max() / result.depth.max()
    assert off <= np.max(coarse.error) <= 1e-3
    law = foundation.law()
    # Where the contact is wider than ever before, its history is forgotten: the closed
    # form holds again (Ting 1966).
    last = float(_lee_radok_depth(law, TIMES, PULSES))
    np.testing.assert_allclose(result.depth[-1], last, rtol=2e-6)
    assert result.contact_radius[-1] > result.contact_radius[:-1].max()


def _lee_radok_depth(law, time, load):
    """d from A(t) = int J(t-s) dF(s), by quadrature over the piecewise linear load; A =
    (4/3) d^(3/2) for R = 1.
    """
    foundation = em.Foundation(law.equilibrium, law.moduli, law.times, law.viscosity)
    area = 0.0
    for i in range(len(time) - 1):
        rate = (load[i + 1] - load[i]) / (time[i + 1] - time[i])
        area += (
            rate
            * quad(
                lambda s: float(foundation.creep_compliance(time[-1] - s)),
                time[i],
                time[i + 1],
                epsabs=0,
            )[0]
        )
    return (0.75 * area) ** (2 / 3)


def test_depth_and_load_in_turn():
    depth = np.where(TIMES <= 1.0, 0.01 * TIMES, np.nan)
    load = np.where(TIMES <= 1.0, np.nan, 1e-3)
    result = em.indent(SOLID, BALL, time=TIMES, depth=depth, load=load, rtol=1e-5)
    assert result.converged.all()
    np.testing.assert_allclose(result.force[4], 0.00337335122148522, rtol=1e-5)
    np.testing.assert_allclose(result.depth[:5], depth[:5], rtol=1e-14)
    np.testing.assert_allclose(result.force[5:], 1e-3, rtol=1e-14)
    # A half with the depth given throughout, at the depths that were found, carries
    # nearly the same.
    np.testing.assert_allclose(
        em.indent(SOLID, BALL, time=TIMES, depth=result.depth).force[-1],
        1e-3,
        rtol=0.02,
    )


def test_many_histories_are_the_single_ones():
    peaks = np.array([[0.5], [1.0], [2.0]])
    many = em.indent(SOLID, BALL, time=TIMES, depth=peaks * TWICE)
    for i, peak in enumerate(peaks[:, 0]):
        np.testing.assert_allclose(
            many.force[i],
            em.indent(SOLID, BALL, time=TIMES, depth=peak * TWICE).force,
            rtol=1e-9,
        )
    # A paraboloid has one length: forces at depths d go as d^(3/2).
    np.testing.assert_allclose(many.force[2], many.force[0] * 8, rtol=1e-8, atol=1e-15)


# ---------------------------------------------------------------- stiff and degenerate


@pytest.mark.parametrize("fast", [1e-9, 1e-12])
def test_a_branch_much_faster_than_the_steps(fast):
    plain = em.indent(SOLID, BALL, time=TIMES, depth=TWICE)
    more = em.indent(
        em.Foundation(1.0, [5.0, 3.0], [fast, 0.5]), BALL, time=TIMES, depth=TWICE
    )
    assert more.converged.all()
    np.testing.assert_allclose(
        more.force, plain.force, atol=1e3 * fast * plain.force.max()
    )


def test_a_liquid_keeps_its_imprint_and_is_touched_everywhere_at_once():
    # A dashpot alone does not recover: the surface comes back to an imprint of its own
    # shape.
    depth = np.interp(TIMES, [0, 0.5, 1.0, 1.4, 2.0], [0, 0.01, 0.0, 0.01, 0.02])
    result = em.indent(
        em.Foundation(0.0, [], [], 2.0), BALL, time=TIMES, depth=depth, rtol=1e-4
    )
    assert result.converged.all()
    speed = np.diff(depth) / np.diff(TIMES)
    rising = (speed > 0) & (
        (depth[1:] <= 0.01) & (TIMES[1:] <= 0.5) | (depth[1:] > 0.01)
    )
    expected = 2 * 2.0 * speed * np.sqrt(np.maximum(depth[1:], 0))  # F = 2 a eta v
    np.testing.assert_allclose(result.force[1:][rising], expected[rising], rtol=1e-9)
    np.testing.assert_allclose(result.force[1:][speed <= 0], 0, atol=1e-15)


def test_a_dashpot_under_the_first_touch_of_a_history_that_returns():
    """The force jumps at the edge: of a contact a thousandth as wide as the widest, the
    edge is still exact.
    """
    time = np.append(0.0, np.geomspace(1e-5, 2.0, 30))
    result = em.indent(
        em.Foundation(1.0, [3.0], [0.5], 0.2),
        BALL,
        time=time,
        depth=0.01 * np.minimum(time, 2 - time),
    )
    assert result.converged.all()
    rising = time <= 1.0
    np.testing.assert_allclose(
        result.contact_radius[rising], 0.1 * np.sqrt(time[rising]), rtol=1e-12
    )
    s = time[rising]
    branch = [
        quad(
            lambda r, t=t: 3 * np.exp(-(t - r) / 0.5) * 0.02 * 0.1 * np.sqrt(r),
            0,
            t,
            epsabs=0,
        )[0]
        for t in s
    ]
    # int E(t-s) 2 a dd, Lee and Radok
    force = 4 / 3 * 1e-3 * s**1.5 + 0.2 * 0.02 * 0.1 * np.sqrt(s) + branch
    np.testing.assert_allclose(result.force[rising], force, rtol=1e-7)


def test_zero_load_and_negative_depth_touch_nothing():
    nothing = em.indent(SOLID, BALL, time=TIMES, load=0.0)
    away = em.indent(SOLID, BALL, time=TIMES, depth=-0.01)
    for result in (nothing, away):
        assert result.converged.all()
        for field in ("force", "contact_radius", "work", "dissipated"):
            assert (getattr(result, field) == 0).all()
    assert (nothing.depth == 0).all()


def test_a_flat_punch_under_any_load():
    punch = em.FlatPunch(0.1)
    crept = em.indent(SOLID, punch, time=TIMES, load=PULSES)
    assert crept.converged.all()
    again = em.indent(SOLID, punch, time=TIMES, depth=0.01 + 0 * TIMES)
    np.testing.assert_allclose(
        again.force, 0.2 * 0.01 * SOLID.relaxation(TIMES), rtol=1e-12
    )
    np.testing.assert_allclose(again.contact_radius, 0.1)
    step = em.indent(SOLID, punch, time=TIMES, load=1e-3)
    np.testing.assert_allclose(
        step.depth, 1e-3 / 0.2 * SOLID.creep_compliance(TIMES), rtol=1e-12
    )


def test_layer_profile_and_cylinder():
    layer = em.Foundation(2e9, [], [], per_area=True)
    ball = em.indent(layer, em.Paraboloid(0.5), time=TIMES, depth=5e-5 * TIMES)
    # pi k R d^2
    np.testing.assert_allclose(
        ball.force[-1], np.pi * 2e9 * (1e-4) ** 2 * 0.5, rtol=1e-9
    )
    roll = em.indent(layer, em.Cylinder(0.5, 2.0), time=TIMES, load=5e2 * TIMES)
    a = (1e3 * 3 * 0.5 / (2 * 2e9 * 2.0)) ** (1 / 3)  # F = 2 k L a^3/(3 R)
    np.testing.assert_allclose(roll.contact_radius[-1], a, rtol=1e-12)
    r = np.linspace(0, 2e-2, 30)
    spline = em.indent(
        SOLID, em.Profile(r, r**2 / 0.02), time=[0.0, 1.0], load=[1e-4, 1e-4]
    )
    exact = em.indent(SOLID, em.Paraboloid(0.01), time=[0.0, 1.0], load=[1e-4, 1e-4])
    np.testing.assert_allclose(spline.depth, exact.depth, rtol=1e-9)


@pytest.mark.filterwarnings("ignore:.*deeper than the radius")
def test_a_sphere_pressed_to_its_equator():
    with pytest.warns(em.ConvergenceWarning, match="wider than the sphere"):
        result = em.indent(
            SOLID, em.Sphere(0.01), time=TIMES, load=1e-3 * np.arange(10.0)
        )
    assert np.isnan(result.depth[~result.converged]).all()
    assert result.converged[0]
    assert not result.converged[-1]
    with refused("depth", "profile", 1):
        em.indent(SOLID, em.Sphere(0.01), time=TIMES, depth=1.0)


@pytest.mark.parametrize("shape", [Sphere(0.01), PowerLaw(3.0, 20.0), Paraboloid(0.02)])
@pytest.mark.parametrize("kind", ["half-space", "layer"])
def test_area_and_energy_against_quadrature(shape, kind):
    disc, a = Disc(shape, kind), 0.007
    g = float(disc.profile(jnp.asarray(a)))

    def integral(power):
        def integrand(x):
            return (
                float(disc.weight(jnp.asarray(x)))
                * (g - float(disc.profile(jnp.asarray(x)))) ** power
            )

        return quad(integrand, 0, a, epsabs=0, epsrel=1e-10)[0]

    np.testing.assert_allclose(disc.area(jnp.asarray(a)), integral(1), rtol=1e-9)
    np.testing.assert_allclose(disc.energy(jnp.asarray(a)), integral(2) / 2, rtol=1e-9)
    np.testing.assert_allclose(
        disc.radius_of_area(disc.area(jnp.asarray(a))), a, rtol=1e-13
    )
    np.testing.assert_allclose(disc.radius_of_depth(jnp.asarray(g)), a, rtol=1e-13)


# ---------------------------------------------------------------- refusals

BAD = {
    "neither": ({}, ("load", "depth")),
    "one instant": ({"time": [1.0], "depth": [0.1]}, ("time", "two instants")),
    "descending": ({"time": [1.0, 0.0], "depth": 0.1}, ("time", "[1, 0]")),
    "pulling": ({"load": [0.0, -1.0]}, ("load", "adhesion", -1)),
    "infinite depth": ({"depth": [0.0, np.inf]}, ("depth", "inf")),
    "shapes": ({"depth": [0.0, 1.0, 2.0]}, ("", "broadcast")),
    "both everywhere": ({"depth": [0.0, 1.0], "load": [0.0, 1.0]}, ("depth", "NaN")),
    "rtol": ({"depth": [0.0, 1e-3], "rtol": 1e-13}, ("rtol",)),
    "no shift law": ({"depth": [0.0, 1e-3], "temperature": 300.0}, ("", "shift law")),
    "negative adhesion": ({"depth": [0.0, 1e-3], "adhesion": -1.0}, ("adhesion", -1)),
}


@pytest.mark.parametrize("name", BAD)
def test_refuses(name):
    arguments, message = BAD[name]
    with refused(*message):
        em.indent(SOLID, BALL, **{"time": [0.0, 1.0], **arguments})


def test_refuses_what_has_no_answer():
    with refused("depth", "dashpot cannot"):
        em.indent(
            em.Foundation(1.0, [], [], 1.0), BALL, time=[0.0, 1.0], depth=[1e-3, 1e-3]
        )
    with refused("material", "solid", "adhesion"):
        em.indent(
            em.Foundation(0.0, [1.0], [1.0]),
            BALL,
            time=[0.0, 1.0],
            depth=0.0,
            adhesion=0.1,
        )
    with pytest.warns(em.ConvergenceWarning, match="pulled the body off"):
        off = em.indent(
            em.Foundation(1e6, [], []),
            em.Paraboloid(0.01),
            time=[0.0, 1.0],
            load=[0.0, -1.0],
            adhesion=0.05,
        )
    assert np.isnan(off.depth[1])
    result = PROBLEMS[0].solve()
    with refused("time", "history"):
        result.pressure(0.0, 3.0)
    assert "contact radius [m]" in result.columns()
    assert "dissipated" in result.summary()


@pytest.mark.parametrize(
    ("shape", "per_area"),
    [(em.Sphere(5e-3), False), (em.Cone(0.1), False), (em.Sphere(5e-3), True)],
)
def test_the_energy_of_a_sticky_contact(shape, per_area):
    """Its rate along the depth is the force, and along the radius nothing at the edge,
    where elastic energy pays for the area (Griffith).
    """
    radius = np.array([2e-4, 5e-4])
    with jax.enable_x64(True):
        sticky = Sticky(
            disc_under(shape, per_area), jnp.asarray(4e6), jnp.asarray(0.05)
        )
        for a in map(jnp.asarray, radius):
            edge = sticky.depth(a)
            along_a, along_d = jax.grad(sticky.potential, (0, 1))(a, edge)
            np.testing.assert_allclose(along_d, sticky.force(a, edge), rtol=1e-9)
            work = 2 * np.pi * a * sticky.work
            np.testing.assert_allclose(along_a, 0.0, atol=1e-9 * work)


@pytest.mark.parametrize("per_area", [True, False])
def test_a_punch_touches_with_all_of_its_face_or_nothing(per_area):
    disc = disc_under(em.FlatPunch(5e-3), per_area)
    for radius in (disc.radius_of_depth, disc.radius_of_area):
        found = np.asarray(radius(np.array([-1e-9, 0.0, 1e-9])))
        assert found.tolist() == [0.0, 0.0, 5e-3]
