"""`em.impact` against solutions of reduced equations, closed forms, and the
element-by-element contact step.
"""

import math

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import elastomdr as em
from elastomdr.arrays import numpy_unless_traced
from elastomdr.element.contact_step import contact_step, rest
from elastomdr.material.relaxation import Relaxation
from elastomdr.transient.impact_motion import Striker, grid, march

from ..refused import refused
from .bouncing import BALL, DM, KELVIN_VOIGT, E, M, R, V, impact, kelvin_voigt


@pytest.mark.parametrize("beta", KELVIN_VOIGT)
def test_kelvin_voigt(beta):
    found, (restitution, depth, duration) = (
        impact(kelvin_voigt(beta)),
        KELVIN_VOIGT[beta],
    )
    np.testing.assert_allclose(
        found.restitution, restitution, rtol=1e-8 if depth else 4e-8
    )
    if depth:
        np.testing.assert_allclose(
            [found.max_depth / DM, found.duration * V / DM],
            [depth, duration],
            rtol=1e-7,
        )
    assert found.error < 1e-6


@pytest.mark.parametrize(
    ("part", "b", "expected"),
    [
        (0.75, 0.5, (0.4450752121460099, 1.220244725790278, 3.859939530721329)),
        (1.0, 1.0, (0.27025292059921796, 1.1744982650208484, 2.9282008601033933)),
    ],
)
def test_one_branch(part, b, expected):
    """Ting's solution inside an integrator of high order; the second is a Maxwell
    liquid.
    """
    found = impact(em.Foundation(E * (1 - part), [E * part], [b * DM / V]))
    out = [found.restitution, found.max_depth / DM, found.duration * V / DM]
    np.testing.assert_allclose(out, expected, rtol=1e-7)


def test_elastic():
    """Hertz: T = 2 sqrt(pi) Gamma(7/5)/Gamma(9/10) dm/v0, and nothing is lost."""
    found = impact(em.Foundation(E, [], []))
    duration = 2 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9) * DM / V
    np.testing.assert_allclose(
        [found.restitution, found.duration], [1, duration], rtol=1e-9
    )
    np.testing.assert_allclose(found.max_depth, DM, rtol=1e-8)
    np.testing.assert_allclose(
        found.max_force, 4 / 3 * E * math.sqrt(R * DM**3), rtol=1e-7
    )
    slope = (1 - impact(kelvin_voigt(1e-5)).restitution) / 1e-5
    # the next term is of order beta
    np.testing.assert_allclose(slope, 1.891705853511856, rtol=1e-4)


def test_converges_with_the_square_of_the_steps():
    """One grid alone, without extrapolation: an error that is a series in n^-2."""
    viscosity, one = np.array([E * 0.5 * DM / V]), np.ones(1)
    body = Striker(
        BALL, np.zeros((1, 1)), np.full((1, 1), E), viscosity, M * one, V * one
    )
    solve = numpy_unless_traced(march)
    found = [solve(body, grid(n, 64), per_area=False) for n in (16, 32, 64)]
    error = [abs(float(one.restitution[0]) - KELVIN_VOIGT[0.5][0]) for one in found]
    slopes = np.log2(np.array(error[:-1]) / error[1:])
    np.testing.assert_allclose(slopes, 2, atol=0.1)


def oscillator(stiffness, damping):
    """Restitution and duration of m d'' + c d' + k d = 0 until c d' + k d = 0, in
    closed form.
    """
    beta = damping / (2 * math.sqrt(stiffness * M))
    w = math.sqrt(stiffness / M)
    damped = w * math.sqrt(1 - beta**2)
    end = math.atan2(2 * beta * math.sqrt(1 - beta**2), 2 * beta**2 - 1) / damped
    return math.exp(-beta * w * end), end


def test_punch_is_a_linear_oscillator():
    radius, viscosity = 2e-3, 800.0  # beta = 0.09
    punch = em.FlatPunch(radius)
    found = em.impact(em.Foundation.kelvin(E, viscosity), punch, mass=M, velocity=V)
    restitution, end = oscillator(2 * radius * E, 2 * radius * viscosity)
    np.testing.assert_allclose(
        [found.restitution, found.duration], [restitution, end], rtol=1e-7
    )
    np.testing.assert_allclose(
        found.lost, 0.5 * M * V**2 * (1 - restitution**2), rtol=1e-7
    )


def test_a_dashpot_at_temperatures():
    """Its viscosity goes with a_T b_T, the spring with b_T."""
    shift, vertical = (
        em.WLF(8.86, 101.6, 293.15),
        em.VerticalTable([263.15, 293.15, 333.15], [0.8, 1.0, 1.3]),
    )
    rubber = em.Foundation(E, [], [], 800.0, shift=shift, vertical=vertical)
    kelvin, radius = np.array([288.15, 313.15]), 2e-3
    found = em.impact(
        rubber, em.FlatPunch(radius), mass=M, velocity=V, temperature=kelvin
    )
    a, b = shift.a(kelvin), vertical.b(kelvin)
    expected = [
        oscillator(2 * radius * E * b[i], 2 * radius * 800.0 * a[i] * b[i])[0]
        for i in range(2)
    ]
    assert expected[0] < 0.8 * expected[1]
    np.testing.assert_allclose(found.restitution, expected, rtol=1e-7)


def test_elastic_cone():
    """F = 2 E* d^2/(pi tan) (Sneddon 1965), so that m v^2/2 = 2 E* dm^3/(3 pi tan); T =
    2 int dd/v.
    """
    slope = 0.4
    found = em.impact(em.Foundation(E, [], []), em.Cone(slope), mass=M, velocity=V)
    depth = (0.75 * math.pi * slope * M * V**2 / E) ** (1 / 3)
    duration = (
        2 * depth / V * math.sqrt(math.pi) * math.gamma(4 / 3) / math.gamma(5 / 6)
    )
    np.testing.assert_allclose(
        [found.max_depth, found.duration], [depth, duration], rtol=1e-7
    )
    np.testing.assert_allclose(
        found.max_force, 2 * E * depth**2 / (math.pi * slope), rtol=1e-7
    )


def test_cylinder_on_a_layer():
    """F = 2 L E A'(d) ...: against the reduced equations in the approach, by scipy."""
    k, eta, length = 2e9, 2e5, 0.02

    def approach(_, y):
        a = math.sqrt(2 * R * max(y[0], 0.0))
        return [y[1], -(k * 4 / 3 * a * y[0] + 2 * a * eta * y[1]) * length / M]

    def turn(_, y):
        return y[1]

    turn.terminal = True
    run = solve_ivp(
        approach,
        (0, 1),
        [1e-14, V],
        events=turn,
        rtol=1e-11,
        atol=1e-16,
        method="DOP853",
    )
    found = em.impact(
        em.Foundation.kelvin(k, eta), em.Cylinder(R, length), mass=M, velocity=V
    )
    np.testing.assert_allclose(found.max_depth, run.y_events[0][0][0], rtol=1e-7)
    assert 0.5 < found.restitution < 1


RUBBER = em.Foundation(2e6, [6e6, 3e6, 1e6], [2e-5, 5e-4, 3e-2], 30.0)
BRANCHES = em.Foundation(2e6, [6e6, 3e6, 1e6], [2e-5, 5e-4, 3e-2])


@pytest.mark.slow
def test_elements_agree():
    """The depths of the impact, imposed on independent elements by the contact step:
    same force, same energy lost.
    """
    found = impact(BRANCHES)
    history = found.history
    knots = history.time
    size = 400
    fine = np.unique(
        np.concatenate(
            [np.linspace(knots[i], knots[i + 1], 41) for i in range(len(knots) - 1)]
        )
    )
    depth = _quintic(history, M, fine)
    x = (np.arange(size) + 0.5) / size * math.sqrt(R * found.max_depth)
    law = Relaxation(
        *(np.asarray(v) for v in (2e6, BRANCHES.moduli, BRANCHES.times, 0.0))
    )
    with jax.enable_x64(True):
        places = depth[:, None] - x**2 / R

        def step(state, ends):
            state = contact_step(law, state, ends[0], ends[1], ends[2])
            return state, (state.q.sum(), state.work.sum())

        run = jax.jit(
            lambda: jax.lax.scan(
                step, rest(law, size), (places[:-1], places[1:], np.diff(fine))
            )[1]
        )
        force, work = (2 * x[0] * 2 * np.asarray(y) for y in run())
    middle = np.searchsorted(fine, knots[10])
    np.testing.assert_allclose(force[middle - 1], history.force[10], rtol=1e-4)
    lost = 0.5 * M * V**2 * (1 - found.restitution**2)
    np.testing.assert_allclose(found.lost, lost, rtol=1e-12)
    np.testing.assert_allclose(work[-1], lost, rtol=3e-4)
    assert np.all(np.diff(history.velocity) < 0)  # F > 0 throughout: it turns once


def _quintic(history, mass, t):
    """Depth between the instants of a history, from depth, velocity and force at their
    ends.
    """
    from scipy.interpolate import BPoly

    values = np.stack([history.depth, history.velocity, -history.force / mass], axis=1)
    return BPoly.from_derivatives(history.time, values)(t)


def test_energy_of_the_history():
    """int F d' dt over the history is the kinetic energy lost, to what interpolating 33
    instants allows.
    """
    from scipy.interpolate import CubicSpline

    h = impact(RUBBER).history
    work = CubicSpline(h.time, h.force * h.velocity).integrate(h.time[0], h.time[-1])
    np.testing.assert_allclose(work, 0.5 * M * (V**2 - h.velocity[-1] ** 2), rtol=2e-3)


@pytest.mark.filterwarnings("ignore:.*deeper than the radius")
def test_broadcasts_and_many_materials():
    """Masses, velocities and materials in one call are the same as one by one; branches
    need not be as many.
    """
    materials = [em.Foundation(E, [], []), kelvin_voigt(0.5), RUBBER]
    mass, velocity = np.array([[0.5], [1.0]]) * M, np.array([0.1, 1.0, 10.0]) * V
    found = impact(materials, mass=mass, velocity=velocity)
    assert found.restitution.shape == (3, 2, 3) == found.converged.shape
    assert found.history.depth.shape == (3, 2, 3, 33)
    one = impact(RUBBER, mass=mass[1, 0], velocity=velocity[2])
    np.testing.assert_allclose(found.restitution[2, 1, 2], one.restitution, rtol=1e-9)
    np.testing.assert_allclose(found.restitution[0], 1, rtol=1e-9)


def test_temperature_is_a_change_of_times():
    rubber = em.Prony(
        0.5e6,
        [1.5e6, 0.8e6, 0.2e6],
        [2e-5, 5e-4, 3e-2],
        shift=em.WLF(8.86, 101.6, 293.15),
    )
    warm = em.impact(
        rubber, BALL, mass=M, velocity=V, temperature=np.array([273.15, 313.15])
    )
    cold = em.impact(rubber.at(273.15), BALL, mass=M, velocity=V)
    np.testing.assert_allclose(warm.restitution[0], cold.restitution, rtol=1e-9)
    assert abs(warm.restitution[1] - warm.restitution[0]) > 0.01


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": 0.0}, ("mass", 0)),
        ({"velocity": -1.0}, ("velocity", -1)),
        ({"mass": [1.0, 2.0], "velocity": [1.0, 2.0, 3.0]}, ("", "broadcast")),
        ({"velocity": []}, ("velocity", "[]")),
        ({"temperature": 300.0}, ("", "shift law")),
        ({"rtol": 1.0}, ("rtol", 1)),
    ],
)
def test_bad_input(changes, message):
    with refused(*message):
        impact(RUBBER, **changes)


def test_a_table_of_impacts_without_a_bound_has_its_doubts():
    springs = em.springs(em.KelvinVoigt(1e6, 1.0), 0.01, bonded=False)
    found = em.impact(springs, BALL, mass=[[M], [2 * M], [3 * M]], velocity=[V, 2 * V])
    (doubt,) = (x for x in found.doubts if x.kind == "no prediction")
    assert np.shape(doubt.points) == np.shape(found.restitution) == (3, 2)


def test_bad_scenes():
    given = em.KelvinVoigt(1e6, 1.0)
    with pytest.raises(em.InputError, match=r"em\.springs.*Cylinder") as error:
        em.impact(given, em.Cylinder(R, 0.1), mass=M, velocity=V)
    assert error.value.argument == "material"
    assert error.value.got is given
    with refused("material", "[]"):
        em.impact([], BALL, mass=M, velocity=V)
    kinds = [
        em.half_space(em.KelvinVoigt(1e6, 1.0)),
        em.Foundation(1e6, [], [], per_area=True),
    ]
    with refused("material", "half-spaces", "layers"):
        em.impact(kinds, BALL, mass=1, velocity=1)


def test_tables_and_figures(tmp_path):
    found = impact(
        [RUBBER, kelvin_voigt(0.5)], velocity=np.array([0.5, 1.0, 2.0]), rtol=1e-3
    )
    found.to_csv(tmp_path / "impact.csv")
    text = (tmp_path / "impact.csv").read_text()
    assert "coefficient of restitution [-]" in text
    assert "mass: 0.02 kg" in text
    assert "all converged" in found.summary()
    assert found.plot().get_ylabel() == "Coefficient of restitution [-]"
    single = impact(RUBBER, rtol=1e-2).plot()
    assert single.get_xlabel() == "Time since touch [ms]"
    assert len(single.get_lines()[0].get_xdata()) > 100


def test_many_impacts_are_those_of_each_alone():
    """More than a block of them, on NumPy: 300, with the ends of both blocks."""
    velocity = np.geomspace(0.1, 10.0, 300)
    rubber = em.Foundation(E, [E], [1e-3])
    together = impact(rubber, velocity=velocity, rtol=1e-4)
    assert together.converged.all()
    for i in (0, 255, 256, 299):
        alone = impact(rubber, velocity=velocity[i], rtol=1e-4)
        for field in ("restitution", "duration", "max_depth", "max_force", "error"):
            np.testing.assert_allclose(
                getattr(together, field)[i],
                getattr(alone, field),
                rtol=1e-9,
                atol=1e-14,
            )
