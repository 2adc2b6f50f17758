"""Energy audits: work in = stored + dissipated, each side by a route of its own."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import quad

import elastomdr as em
from elastomdr.element.body_over_line import indenter
from elastomdr.element.episode import energies, follow, pressed, recovery_modes
from elastomdr.element.moving_body import MotionScene
from elastomdr.material.relaxation import Relaxation
from elastomdr.surface.lines import SingleLine
from elastomdr.transient import load_steps
from elastomdr.transient.march import run
from elastomdr.transient.problem import Steps

from ..refused import warned
from .problems.indentation import BALL, PULSES, SOLID, TIMES, TWICE


def missing(found):
    """What the audit does not find, over the largest work of the history."""
    return np.abs(found.work - found.stored - found.dissipated).max() / found.work.max()


# ---------------------------------------------------------------- indentation


@pytest.mark.parametrize(
    "given",
    [
        {"depth": TWICE},
        {"depth": 0.003 + 0 * TIMES},
        {"load": 3e-3 * (1 + TIMES)},
        {"load": 3e-3 + 0 * TIMES},
    ],
    ids=["depth, shrinking and growing", "depth held", "load growing", "load held"],
)
def test_indentation_without_steps(given):
    """Heat from the dashpots' own forces, and from the modes of free elements, beside
    int q du and the springs.
    """
    found = em.indent(SOLID, BALL, time=TIMES, **given)
    assert missing(found) < 1e-12
    # heat never comes back
    assert (np.diff(found.dissipated - found.locked) >= -1e-14 * found.work.max()).all()


@pytest.mark.slow
def test_a_dashpot_is_in_the_audit():
    damped = em.Foundation(1.0, [3.0], [0.5], 0.2)
    for given in ({"depth": TWICE, "rtol": 1e-4}, {"load": 3e-3 * (1 + TIMES)}):
        assert missing(em.indent(damped, BALL, time=TIMES, **given)) < 1e-8


@pytest.mark.parametrize("rtol", [1e-6, pytest.param(1e-8, marks=pytest.mark.slow)])
def test_indentation_by_steps(rtol):
    """A load that falls to zero and returns: int F dd against what the elements
    received, to the tolerance.
    """
    found = em.indent(SOLID, BALL, time=TIMES, load=PULSES, rtol=rtol)
    assert found.converged.all()
    assert missing(found) <= rtol


def test_adhesive_cycle():
    """JKR: the work of a whole cycle of depth is int F dd between touching and
    breaking, from the closed forms.
    """
    modulus, radius, gamma = 1e6, 0.01, 0.05

    # F dd/da on the branch d = a^2/R - delta, F = (4/3) E a^3/R - 2 a E delta
    def rate(a):
        delta = np.sqrt(2 * np.pi * a * gamma / modulus)
        return (4 / 3 * modulus * a**3 / radius - 2 * a * modulus * delta) * (
            2 * a / radius - 0.5 * delta / a
        )

    depth = np.concatenate([np.linspace(-1e-6, 3e-5, 20), np.linspace(3e-5, -6e-6, 20)])
    found = em.indent(
        em.Foundation(modulus, [], []),
        em.Paraboloid(radius),
        time=np.arange(40.0),
        depth=depth,
        adhesion=gamma,
    )
    touch = (2 * np.pi * gamma * radius**2 / modulus) ** (1 / 3)  # d = 0
    break_ = (np.pi * gamma * radius**2 / (8 * modulus)) ** (1 / 3)  # dd/da = 0
    cycle = quad(rate, touch, break_, epsrel=1e-12)[0]
    np.testing.assert_allclose(found.work[-1], cycle, rtol=1e-8)
    np.testing.assert_allclose(found.dissipated[-1], cycle, rtol=1e-8)
    half = np.argmax(found.depth)
    end = found.contact_radius[half]
    np.testing.assert_allclose(
        found.work[half], quad(rate, touch, end, epsrel=1e-12)[0], rtol=1e-8
    )


# ---------------------------------------------------------------- shear and traction


def test_shear_in_an_elastic_contact():
    """Oblique motion, the load rising and falling: int F dU against stored energy and
    slip, with the square of the time between instants, and to 3e-8 of the work in the
    limit that the two finer ones extrapolate to.
    """
    gaps = []
    for n in (200, 400, 800):
        time = np.linspace(0, 2, n + 1)
        u = 1e-4 * np.interp(time, [0, 0.7, 1.3, 2], [0, 1, -0.5, 0.8])
        load = 20 * np.interp(time, [0, 1, 2], [0.5, 1, 0.4])
        found = em.shear(
            em.Foundation(4e6, [], []),
            em.Paraboloid(0.01),
            time=time,
            displacement=u,
            friction=0.5,
            load=load,
            tangential=em.Foundation(8e6 / 3, [], []),
            elements=2500,
        )
        scale = np.abs(found.work).max()
        np.testing.assert_allclose(
            found.work, found.stored + found.slip_loss, rtol=0, atol=1e-12 * scale
        )
        done = np.append(
            0, np.cumsum((found.force[1:] + found.force[:-1]) / 2 * np.diff(u))
        )
        gaps.append((done - found.work)[:: n // 4] / scale)
    np.testing.assert_allclose(gaps[1][1:] / gaps[2][1:], 4, rtol=0.02)
    np.testing.assert_allclose((4 * gaps[2] - gaps[1]) / 3, 0, atol=3e-8)


def test_shear_of_a_viscoelastic_contact_that_sticks():
    """Infinite friction, a ramp: F = 2 a int G(t-s) dU, so that work and loss of the
    branch are closed forms.
    """
    a, rate, g0, g1, tau = 2e-3, 1e-4, 2e6, 6e6, 0.3
    time = np.linspace(0, 2, 9)
    found = em.shear(
        em.Foundation(4e6, [], []),
        em.Paraboloid(0.01),
        time=time,
        displacement=rate * time,
        friction=np.inf,
        tangential=em.Foundation(g0, [g1], [tau]),
        depth=a**2 / 0.01,
        elements=2000,
    )
    y = time / tau
    f = g1 * tau * rate * -np.expm1(-y)  # of the branch
    # of the elements in contact
    width = found.force[-1] / (g0 * rate * time[-1] + f[-1])
    np.testing.assert_allclose(width, 2 * a, rtol=1e-5)
    stored = width * (0.5 * g0 * (rate * time) ** 2 + 0.5 * f**2 / g1)
    # int f^2/(G_1 tau) dt
    heat = (
        width
        * g1
        * tau**2
        * rate**2
        * (y - 1.5 + 2 * np.exp(-y) - 0.5 * np.exp(-2 * y))
    )
    heat[0] = 0.0
    scale = (stored + heat)[-1]
    np.testing.assert_allclose(found.stored, stored, rtol=0, atol=1e-8 * scale)
    np.testing.assert_allclose(
        found.work - found.stored - found.slip_loss, heat, rtol=0, atol=1e-8 * scale
    )


def test_traction_power_of_an_elastic_brush():
    """F_x xi v is the power of slip: int mu q (xi - s') dx over the elements that slip,
    s = mu q/G.
    """
    modulus, shear, radius, mu, a, xi = 4e6, 8e6 / 3, 0.01, 0.5, 2e-3, 0.05
    found = em.traction(
        em.Foundation(modulus, [], []),
        em.Paraboloid(radius),
        velocity=2.0,
        creepage=xi,
        friction=mu,
        depth=a**2 / radius,
        tangential=em.Foundation(shear, [], []),
    )
    # behind it tau = mu q, x from +a to -a
    slip_from = a * (1 - 2 * xi * radius * shear / (2 * a * mu * modulus))

    def power(x):
        q, slope = modulus * (a**2 - x**2) / radius, -2 * modulus * x / radius
        return mu * q * (xi + mu * slope / shear)  # the element moves towards -x

    lost = 2.0 * quad(power, -a, -slip_from, epsrel=1e-12)[0]
    np.testing.assert_allclose(found.slip_power, lost, rtol=1e-8)


# ---------------------------------------------------------------- sliding


def test_sliding_on_a_partial_contact_converges_with_the_square_of_the_step():
    """int F_N dd + F_x dX over the steps, against what the elements received; a rest, a
    start, a step of load.
    """
    law = Relaxation(*map(jnp.asarray, (4e6, np.array([12e6]), np.array([1e-3]), 0.0)))

    def gap(n):
        spacing = 8e-3 / n
        steps = n // 2
        x = np.linspace(0, 4e-3, steps + 1)[1:]
        h, load = (
            np.full(steps, 1e-3 / n * 8),
            np.interp(x, [0, 2e-3, 4e-3], [10.0, 10.0, 5.0]),
        )
        h[0], x[0] = 1e-12, 0.0
        with jax.enable_x64(True):
            surface = indenter(
                SingleLine(em.Paraboloid(0.01)),
                -2.5e-3 + 0.3 * spacing,
                spacing,
                n,
                1.0,
            )
            steps = Steps(*map(jnp.asarray, (h, x, load)))
            seen, _ = run(MotionScene(law, surface), steps, balance=False)
        normal, drag, depth, work = (
            np.asarray(a) for a in (seen.normal, seen.drag, seen.depth, seen.work)
        )
        done = (normal[1:] + normal[:-1]) @ np.diff(depth) / 2 + (
            drag[1:] + drag[:-1]
        ) @ np.diff(x) / 2
        return abs(done - (work[-1] - work[0])) / work[-1]

    # half as many steps: whole blocks of the march
    counts = np.array([128, 256, 512, 1024])
    slope = np.polyfit(np.log(counts), np.log([gap(n) for n in counts]), 1)[0]
    assert -2.8 < slope < -1.5


@pytest.mark.parametrize("steps", [16, 40])
def test_sliding_on_a_partial_contact_without_time_steps(steps):
    """Elements that meet and leave the surface each at its own instant: what the body
    does on them is stored or lost, to rounding and whatever the step, if the body moves
    straight from place to place over each element.
    """
    count, spacing = 48, 1e-4
    with jax.enable_x64(True):
        law = Relaxation(
            *map(jnp.asarray, (4e6, np.array([12e6]), np.array([1e-3]), 0.0))
        )
        modes = recovery_modes(law)
        surface = indenter(SingleLine(em.Paraboloid(0.01)), -2e-3, spacing, count, 1.0)
        place, depth = (
            np.linspace(0, 2e-3, steps + 1),
            1e-4 * (1 + 0.3 * np.sin(np.arange(steps + 1))),
        )
        w = depth[:, None] + np.asarray(jax.jit(jax.vmap(surface.rise))(place))
        h = 2e-3 / steps
        advance = jax.jit(
            lambda state, start, end: follow(
                law, modes, state, start, (end - start) / h, h
            )
        )
        state = jax.jit(pressed)(law, modes, w[0])
        touched = []
        for start, end in itertools.pairwise(w):
            state = advance(state, start, end)
            touched.append(np.asarray(state.contact))
        left = sum(jax.jit(energies)(law, modes, state))
        touched = np.array(touched)
        assert (touched[1:] > touched[:-1]).any()
        assert (touched[1:] < touched[:-1]).any()
        np.testing.assert_allclose(
            jnp.sum(state.work), jnp.sum(left + state.heat), rtol=1e-13
        )
        np.testing.assert_allclose(
            state.work, left + state.heat, rtol=0, atol=1e-13 * float(state.work.max())
        )
        assert (state.heat > -1e-16 * state.work.max()).all()


@pytest.mark.slow
def test_steady_sliding_turns_all_its_power_into_heat():
    rubber, ball, speed = em.Foundation(4e6, [12e6], [1e-3]), em.Paraboloid(0.01), 1.0
    time = np.linspace(0, 0.024, 49)
    found = em.slide(
        rubber, ball, time=time, position=speed * time, load=10.0, rtol=1e-3
    )
    steady = em.friction(rubber, ball, velocity=speed, load=10.0, model=em.Line())
    power = (found.dissipated[-1] - found.dissipated[-9]) / (time[-1] - time[-9])
    np.testing.assert_allclose(power, steady.friction_force * speed, rtol=1e-3)


def test_heat_that_is_not_resolved_is_not_told(monkeypatch):
    """Rubber that lets go within a dashpot's time of an interval a million times
    longer: the depth is soon known.
    """
    rubber = em.Foundation(1e6, [1e6, 1e7], [1e-6, 1e-1], per_area=True, viscosity=1e7)
    scene = {"time": [0.0, 1e4, 2e4, 3e4], "load": [2.0, 3.0, 0.0, 1.0], "rtol": 1e-2}
    resolved = em.indent(rubber, em.Cylinder(0.01, 0.1), **scene)
    assert np.isfinite(resolved.dissipated).all()
    monkeypatch.setattr(load_steps, "_FINEST", 1)
    with warned(em.ConvergenceWarning, "2 of 4"):
        found = em.indent(rubber, em.Cylinder(0.01, 0.1), **scene)
    assert found.converged.all()
    np.testing.assert_allclose(
        found.depth, resolved.depth, atol=1e-2 * resolved.depth.max()
    )
    np.testing.assert_array_equal(
        np.isnan(found.dissipated), [False, False, True, True]
    )
