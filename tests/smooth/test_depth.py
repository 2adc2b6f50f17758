"""A smooth body deeper than its contact is wide is beyond the theory of small strains:
every verb says so, and whatever is made from its numbers.
"""

import warnings

import jax
import numpy as np
import pytest

import elastomdr as em

from ..refused import warned

RUBBER = em.Prony(1e6, [1e6], [1e-2])
R = 0.01
BALL = em.Paraboloid(R)
SPRINGS = em.springs(RUBBER, 1e-3, bonded=False)


def shallow_and_deep(depth):
    """A call of each verb, at this depth [m] or under a load that reaches it or more."""
    time = np.linspace(0.0, 1.0, 5)
    load = 1e7 * depth**1.5 * (1 if depth < R else 3)
    mass = 1e7 * depth**2.5 * (0.1 if depth < R else 10)
    ramp, moved = depth * time, np.linspace(0, depth, 5)
    roll = em.Cylinder(R, 1.0)
    return {
        "friction": lambda: em.friction(RUBBER, BALL, velocity=1.0, depth=depth),
        "friction, load": lambda: em.friction(RUBBER, BALL, velocity=1.0, load=load),
        "rolling": lambda: em.rolling(RUBBER, BALL, velocity=1.0, depth=depth),
        "dissipation": lambda: em.dissipation(RUBBER, BALL, velocity=1.0, depth=depth),
        "cylinder": lambda: em.rolling(
            RUBBER, roll, velocity=1.0, load=1e6 * depth * (1 if depth < R else 20)
        ),
        "indent": lambda: em.indent(RUBBER, BALL, time=time, depth=ramp),
        "impact": lambda: em.impact(RUBBER, BALL, mass=mass, velocity=1.0),
        "slide": lambda: em.slide(
            RUBBER, BALL, time=time, position=moved, depth=ramp, rtol=1e-2
        ),
        "shear": lambda: em.shear(
            RUBBER, BALL, time=time, displacement=moved, friction=0.5, depth=ramp
        ),
        "traction": lambda: em.traction(
            RUBBER, BALL, velocity=1.0, creepage=0.01, friction=0.5, depth=depth
        ),
        "three dimensions": lambda: em.reference.half_space_sliding(
            RUBBER, BALL, velocity=1.0, depth=depth, points=16
        ),
    }


def estimates(result):
    """Where the depth is doubted."""
    (doubt,) = (d for d in result.examined() if "beyond the linear" in d.says)
    assert doubt.kind == "estimate"
    return np.asarray(doubt.points)


@pytest.mark.parametrize("verb", shallow_and_deep(R))
@pytest.mark.filterwarnings("ignore::elastomdr.ConvergenceWarning")
def test_every_verb_doubts_a_body_deeper_than_its_contact_is_wide(verb):
    assert not estimates(shallow_and_deep(0.05 * R)[verb]()).any()
    with warned(em.ModelWarning, "deeper than the radius"):
        deep = shallow_and_deep(3 * R)[verb]()
    assert estimates(deep).any()
    assert "estimate" in {doubt.kind for doubt in deep.doubts}


@pytest.mark.parametrize(
    ("shape", "ends"),
    [
        (BALL, R),  # a = R: where a parabola has left the ball
        (em.Sphere(R), R * np.tanh(1)),  # of d = a artanh(a/R), d = a
        (em.FlatPunch(R), R),
        (em.PowerLaw(4, 1e6), (1e6 * 8 / 3) ** (-1 / 3)),  # g = (8/3) c x^4
    ],
)
def test_it_begins_where_the_depth_is_the_radius_of_contact(shape, ends):
    time = np.array([0.0, 1.0, 2.0])
    with pytest.warns(em.ModelWarning, match="radius of contact"):
        pressed = em.indent(
            RUBBER, shape, time=time, depth=ends * np.array([0.1, 0.999, 1.001])
        )
    np.testing.assert_array_equal(estimates(pressed), [False, False, True])
    if not isinstance(shape, em.FlatPunch):
        np.testing.assert_allclose(pressed.contact_radius[1:] / ends, 1, rtol=2e-3)


def test_springs_end_where_they_are_compressed_to_nothing():
    depth = np.array([0.9e-3, 1.1e-3])
    with pytest.warns(em.ModelWarning, match="1 of 2 points"):
        curve = em.friction(SPRINGS, BALL, velocity=1.0, depth=depth)
    np.testing.assert_array_equal(estimates(curve), [False, True])


@pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
@pytest.mark.parametrize("verb", ["friction", "indent", "slide"])
def test_numbers_given_directly_are_a_half_space_under_a_ball(verb):
    """And springs without a thickness, of no strain, under a cylinder or by name."""
    depth, time = np.array([0.5, 3.0]) * R, np.array([0.0, 1.0])
    calls = {
        "friction": lambda *on: em.friction(*on, velocity=1.0, depth=depth),
        "indent": lambda *on: em.indent(*on, time=time, depth=depth),
        "slide": lambda *on: em.slide(
            *on, time=time, position=R * time, depth=depth, rtol=1e-2
        ),
    }
    given, springs = (
        em.Foundation(1e6, [1e6], [1e-2], per_area=kind) for kind in (None, True)
    )
    np.testing.assert_array_equal(estimates(calls[verb](given, BALL)), [False, True])
    for on in ((springs, BALL), (given, em.Cylinder(R, 1.0))):
        found = calls[verb](*on).examined()
        assert not any("beyond the linear" in doubt.says for doubt in found)


def test_under_jit_the_mask_is_that_of_the_plain_call():
    depth = np.array([0.5, 2.0]) * R

    def deep(depth):
        return estimates_of(em.friction(RUBBER, BALL, velocity=1.0, depth=depth))

    def estimates_of(curve):
        (doubt,) = (d for d in curve.marks if "beyond the linear" in d.says)
        return doubt.points

    np.testing.assert_array_equal(jax.jit(deep)(depth), [False, True])


@pytest.mark.parametrize("rtol", [1e-1, 1e-2, 1e-3, 1e-6])
def test_a_load_near_the_end_of_a_ball_is_solved_to_any_tolerance(rtol):
    """Contacts in slow directions reach near the equator, where the profile is
    steep.
    """
    rubber = em.Prony(7e5, [2.3e6, 5e6, 3e7, 9e7], [0.3, 4e-3, 2e-5, 1e-7])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ModelWarning)
        mu, mean = (
            em.friction(rubber, em.Sphere(7e-3), velocity=0.1, load=400.0, rtol=r).mu
            for r in (rtol, 1e-7)
        )
        roll = em.rolling(rubber, em.Sphere(7e-3), velocity=0.1, load=400.0, rtol=rtol)
    assert abs(mu / mean - 1) < rtol
    assert roll.converged
