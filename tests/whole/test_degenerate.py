"""Scenes at the end of their range: the right answer, or a clear flag.

Shear, traction and normal impact with such laws, and friction zero and infinite, are in
the `TestExtremes` of their own files.
"""

import numpy as np
import pytest

import elastomdr as em

from ..refused import warned

BALL, MASSIVE = em.Paraboloid(0.01), {"mass": 0.01, "velocity": 0.1}
ELASTIC, SHEAR = em.Foundation(4e6, [], []), em.Foundation(8e6 / 3, [], [])
X = np.arange(64) * 1e-5
WAVY = em.RoughLine(X, 4e-6 * np.cos(2 * np.pi * X / 6.4e-4))
TIME = np.linspace(0, 0.02, 9)
# relaxation times: one that matters, one far below each step [s]
SLOW, FAST = 1e-3, 1e-9 * (TIME[1] - TIME[0])
CREEP = em.Foundation(4e6, [12e6], [SLOW])


def with_branch(modulus):
    """Beside the slow branch one that relaxes in 1e-9 of the time between two instants,
    or, without modulus, none.
    """
    return em.Foundation(4e6, [modulus, 12e6], [FAST, SLOW])


CALLS = {
    "indent, depth": lambda law: em.indent(
        law, BALL, time=TIME, depth=1e-5 + 1e-3 * TIME
    ).force[1:],
    "indent, load": lambda law: em.indent(
        law, BALL, time=TIME, load=1 + 0.5 * np.sin(300 * TIME), rtol=1e-2
    ).depth[1:],
    "slide": lambda law: em.slide(
        law, WAVY, time=TIME, position=0.05 * TIME, load=20.0, rtol=1e-2
    ).mu[1:],
    "drive": lambda law: em.drive(
        law, WAVY, time=TIME, position=0.05 * TIME, load=20.0, rtol=3e-2
    ).mu[1:],
}
SLOW_TO_COMPILE = [
    name if name != "drive" else pytest.param(name, marks=pytest.mark.slow)
    for name in CALLS
]


@pytest.mark.parametrize("name", SLOW_TO_COMPILE)
def test_a_branch_that_relaxes_in_1e_9_of_the_step_is_not_felt(name):
    # a tenth, or less, of the `rtol` that was asked for
    near = 3e-3 if name == "drive" else 2e-4
    np.testing.assert_allclose(
        CALLS[name](with_branch(5e6)), CALLS[name](with_branch(0.0)), rtol=near
    )


def test_such_a_branch_under_a_load_that_is_put_on_and_falls():
    """Closed form: until the load falls nothing but creep; then as without the branch.
    Its heat closes the balance.
    """
    load = np.interp(TIME, [0, 0.005, 0.02], [1, 1, 0.0])
    found, without = (
        em.indent(with_branch(e), BALL, time=TIME, load=load, rtol=1e-4)
        for e in (5e6, 0.0)
    )
    assert found.converged.all()
    np.testing.assert_allclose(found.depth[1:], without.depth[1:], rtol=1e-4)
    creep = 4 / 3 * np.sqrt(0.01) * found.depth[:3] ** 1.5  # J F_N, with F_N = 1 N
    np.testing.assert_allclose(
        creep, with_branch(5e6).creep_compliance(TIME[:3]), rtol=1e-6
    )
    missing = np.abs(found.work - found.stored - found.dissipated)
    assert missing.max() < 1e-4 * found.work.max()
    # Until the depth is that of the relaxed branch, the load does work that only the
    # branch turns into heat.
    assert found.dissipated[1] > without.dissipated[1] + 1e-7


def test_no_load():
    found = em.indent(with_branch(0.0), BALL, time=TIME, load=0.0)
    assert found.converged.all()
    assert not np.any([found.force, found.depth, found.contact_radius, found.work])
    # no contact, no traction coefficient
    with pytest.raises(em.InputError, match="load"):
        em.traction(
            ELASTIC,
            BALL,
            velocity=1.0,
            creepage=0.1,
            friction=0.5,
            load=0.0,
            tangential=SHEAR,
        )


@pytest.mark.parametrize(
    "call", [em.slide, pytest.param(em.drive, marks=pytest.mark.slow)]
)
def test_no_load_on_a_rough_line(call):
    moved = call(
        with_branch(0.0), WAVY, time=TIME, position=0.05 * TIME, load=0.0, rtol=1e-2
    )
    assert moved.converged.all()
    np.testing.assert_allclose(
        [moved.normal_force, moved.friction_force, moved.dissipated], 0, atol=1e-15
    )
    assert np.isnan(moved.mu).all()  # there is none without a normal force


def test_oblique_impact_without_friction_and_without_slip():
    """Endless friction is the limit of a large one: elements lose only what they hold
    when they part from the body.
    """
    found = em.impact(
        ELASTIC,
        BALL,
        **MASSIVE,
        tangential_velocity=0.05,
        friction=np.array([0.0, 1e4, np.inf]),
        tangential=SHEAR,
    )
    after, lost = found.oblique.after, found.oblique.slip_loss
    assert found.converged.all()
    assert lost[0] == 0
    np.testing.assert_allclose(after[0], 0.05, rtol=1e-12)
    np.testing.assert_allclose([after[2], lost[2]], [after[1], lost[1]], rtol=1e-4)
    assert after[2] < 0.05


def flat_contact(depth, step):
    """Force per length [Pa m] of elements that a flat body touches all at once, under
    `depth` at each `step` [s].

    The contact step of u and f alone, by many small steps of the trapezoidal rule: f' =
    E_1 u' - f/tau.
    """
    (modulus,), (time,), equilibrium = (
        CREEP.moduli,
        CREEP.times,
        float(CREEP.equilibrium),
    )
    z = step / time
    keep, gain = (1 - z / 2) / (1 + z / 2), modulus / (1 + z / 2)
    u, f, force = depth[0], modulus * depth[0], [(equilibrium + modulus) * depth[0]]
    for w in depth[1:]:
        change = max(w - u, -(equilibrium * u + keep * f) / (equilibrium + gain))
        u, f = u + change, keep * f + gain * change
        force.append(max(equilibrium * u + f, 0.0))
    return np.array(force)


@pytest.mark.parametrize("call", ["indent", "slide"])
def test_all_elements_are_touched_again_at_the_same_instant(call):
    """A flat body lifted and put back on rubber that has not recovered: one element's
    history is that of all.
    """
    corners = [0, 0.005, 0.0055, 0.006, 0.02], [1e-5, 1e-5, -1e-5, -1e-5, 1e-5]
    depth = np.interp(TIME, *corners)
    corners = TIME, depth  # what is given is linear between the instants
    fine = np.linspace(0, TIME[-1], 80_001)
    exact = flat_contact(np.interp(fine, *corners), fine[1])[::10_000]
    if call == "indent":
        found, width = (
            em.indent(CREEP, em.FlatPunch(1e-3), time=TIME, depth=depth).force,
            2e-3,
        )
    else:
        flat = em.RoughLine(X, 0 * X)
        found, width = (
            em.slide(
                CREEP, flat, time=TIME, position=0 * TIME, depth=depth, rtol=1e-3
            ).normal_force,
            1.0,
        )
    assert (exact == 0).any()
    assert exact[-1] > 0
    np.testing.assert_allclose(
        found, width * exact, rtol=1e-3, atol=1e-3 * width * exact.max()
    )


@pytest.mark.parametrize("power", [2.0, 6.0, 12.0, 40.0])
def test_a_steep_body_under_a_load_that_falls(power):
    """An elastic contact forgets: F = 2 n/(n+1) c a^(n+1) E* at d = c a^n, c of the MDR
    profile.
    """
    body, load = em.PowerLaw(power, 1.0), np.array([5.0, 4.9, 0.5, 3.0])
    found = em.indent(ELASTIC, body, time=[0, 1, 2, 3], load=load)
    c = float(body.profile_1d(np.array(0.5))) / 0.5**power
    radius = (load * (power + 1) / (2 * power * c * 4e6)) ** (1 / (power + 1))
    np.testing.assert_allclose(found.contact_radius, radius, rtol=1e-7)
    np.testing.assert_allclose(found.depth, c * radius**power, rtol=1e-10)
    np.testing.assert_allclose(found.dissipated, 0, atol=1e-10 * found.work.max())


@pytest.mark.parametrize("asked", [{"load": 1e4}, {"depth": 0.05}])
def test_a_sphere_sunk_to_its_equator_has_no_answer_on_the_half_space(asked):
    with warned(em.ConvergenceWarning, "end of the body"):
        found = em.reference.half_space_sliding(
            ELASTIC, em.Sphere(0.01), velocity=1.0, points=32, **asked
        )
    assert np.isnan(found.mu)


def test_how_far_the_average_is_off_is_not_told_beyond_the_map():
    known, steep = (
        em.friction(CREEP, em.PowerLaw(n, 1.0), velocity=1.0, load=1.0)
        for n in (4.0, 8.0)
    )
    assert known.model_error > 0
    assert steep.converged
    assert np.isnan(steep.model_error)
