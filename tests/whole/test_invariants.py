"""What must hold for any rubber and any speed, on scenes that Hypothesis draws:
scaling, splitting, dissipation.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import elastomdr as em

SPEEDS = np.geomspace(1e-3, 1e3, 7)  # times R/tau
# the same scenes in every run
FEW = settings(max_examples=25, deadline=None, derandomize=True)


def power(least: float, most: float) -> st.SearchStrategy[float]:
    """10 to an exponent between two bounds."""
    return st.floats(least, most).map(lambda exponent: 10.0**exponent)


SCENE = st.tuples(
    power(-2, 2),
    power(-2, 2),  # E_1 and E_2 over E_inf
    power(-3, 3),  # tau_2 over tau_1, but for being larger
    power(-6, -1),  # depth over R
)


def rubber(first, second, gap, modulus=1.0, time=1.0):
    return em.Foundation(
        modulus, [modulus * first, modulus * second], [time, time * (1 + gap)]
    )


@pytest.mark.filterwarnings("ignore:The radius")  # of a ball of metres
@FEW
@given(SCENE, power(-6, 6), power(-12, 12), power(-9, 3))
def test_units_of_modulus_time_and_length(scene, modulus, time, length):
    *branches, depth = scene
    plain = em.friction(
        rubber(*branches), em.Paraboloid(1.0), velocity=SPEEDS, depth=depth
    )
    other = em.friction(
        rubber(*branches, modulus, time),
        em.Paraboloid(length),
        velocity=SPEEDS * length / time,
        depth=depth * length,
    )
    np.testing.assert_allclose(other.mu, plain.mu, rtol=1e-10)
    np.testing.assert_allclose(
        other.normal_force, plain.normal_force * modulus * length**2, rtol=1e-10
    )


@FEW
@given(SCENE, st.floats(0.05, 0.95))
def test_a_branch_in_two_parts_is_one(scene, part):
    first, second, gap, depth = scene
    late = 1 + gap
    whole = em.Foundation(1.0, [first, second], [1.0, late])
    parts = em.Foundation(
        1.0,
        [first, part * second, (1 - part) * second],
        [1.0, late, late * (1 + 1e-13)],
    )
    one, two = (
        em.friction(r, em.Paraboloid(1.0), velocity=SPEEDS, depth=depth)
        for r in (whole, parts)
    )
    # twice rtol, and what condensing may cost
    np.testing.assert_allclose(two.mu, one.mu, rtol=3e-6)


@FEW
@given(SCENE)
def test_friction_is_never_negative_and_force_lies_between_the_elastic_ends(scene):
    *branches, depth = scene
    for model in (em.Line(), em.Averaged(corrected=False), em.Averaged()):
        found = em.friction(
            rubber(*branches),
            em.Paraboloid(1.0),
            velocity=SPEEDS,
            depth=depth,
            model=model,
        )
        assert found.converged.all()
        assert (found.mu > 0).all()
        relaxed = 4 / 3 * depth**1.5  # (4/3) E sqrt(R) d^(3/2)
        glassy = relaxed * (1 + branches[0] + branches[1])
        assert (found.normal_force < glassy * (1 + 1e-9)).all()
        # at least the half that moves in
        assert (found.normal_force > 0.5 * relaxed).all()


@FEW
@given(st.permutations(range(4)))
def test_branches_come_in_one_order(order):
    """Given in any other, they are put into it."""
    times, moduli = np.array([1e-3, 1e-1, 10.0, 1e3]), np.array([3.0, 1.0, 2.0, 0.5])
    given = {"moduli": moduli[list(order)], "times": times[list(order)]}
    found = em.Foundation(1.0, **given)
    assert (found.times == times).all()
    assert (found.moduli == moduli).all()


LINE = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e3).line(samples=64)
SOFT = em.Foundation(1e6, [3e6, 1e6], [1e-4, 1e-2])


@settings(FEW, max_examples=5)
@given(st.integers(1, 63))
def test_translation_of_a_line(places):
    moved = em.RoughLine(LINE.x, np.roll(np.asarray(LINE.height), places))
    one, two = (
        em.friction(SOFT, line, velocity=[0.01, 1.0], load=200.0, model=em.Line())
        for line in (LINE, moved)
    )
    np.testing.assert_allclose(two.mu, one.mu, rtol=1e-10)
    np.testing.assert_allclose(two.depth, one.depth, rtol=1e-10)


@settings(FEW, max_examples=2)
@given(st.floats(-1, 1), power(-3, 3))
def test_translation_in_place_and_time(place, later):
    time = np.linspace(0, 1e-2, 5)
    position = 1e-3 * np.sin(300 * time)
    one, two = (
        em.slide(
            SOFT,
            em.Paraboloid(1e-3),
            time=time + t,
            position=position + x,
            load=1e-2,
            rtol=0.1,
        )
        for x, t in ((0.0, 0.0), (place, later))
    )
    # Places and instants lose the digits that the shift takes.
    np.testing.assert_allclose(two.friction_force, one.friction_force, atol=1e-6 * 1e-2)


@pytest.mark.parametrize("body", [em.Paraboloid(1e-3), LINE], ids=["indenter", "line"])
def test_reversal_of_a_slide(body):
    """Mirrored in space: the other way over the mirrored line."""
    time = np.linspace(0, 2e-2, 9)
    position = 0.1 * time + 2e-4 * np.sin(300 * time)
    load = 1e-2 if body is not LINE else 200.0
    mirrored = (
        body
        if body is not LINE
        else em.RoughLine(LINE.x, np.roll(np.asarray(LINE.height)[::-1], 1))
    )
    one = em.slide(SOFT, body, time=time, position=position, load=load, rtol=0.05)
    two = em.slide(SOFT, mirrored, time=time, position=-position, load=load, rtol=0.05)
    # Elements begin at the left end of the way in both.
    stated = one.error + two.error if body is not LINE else 1e-9
    assert (np.abs(two.mu + one.mu) <= stated).all()
    np.testing.assert_allclose(
        two.depth, one.depth, rtol=1e-9 if body is LINE else 1e-2
    )
    assert np.abs(one.friction_force).max() > 1e-3 * load


@settings(FEW, max_examples=3)
@given(power(-4, 0), power(-3, 0))
def test_reversal_of_creep_and_shear(creep, friction):
    ball, time = em.Paraboloid(1e-3), np.linspace(0, 1.0, 5)
    shared = {"tangential": SOFT, "friction": friction, "load": 1e-2}
    one, two = (
        em.traction(SOFT, ball, velocity=1e-2, creepage=s * creep, **shared)
        for s in (1, -1)
    )
    np.testing.assert_allclose(two.force, -one.force, rtol=1e-12)
    np.testing.assert_allclose(two.slip_power, one.slip_power, rtol=1e-12)
    moved = creep * 1e-5 * np.sin(5 * time)
    one, two = (
        em.shear(SOFT, ball, time=time, displacement=s * moved, elements=32, **shared)
        for s in (1, -1)
    )
    np.testing.assert_allclose(two.force, -one.force, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(two.slip_loss, one.slip_loss, rtol=1e-12, atol=1e-20)
