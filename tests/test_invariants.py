"""What must hold for any rubber and any speed, on scenes that Hypothesis draws: scaling, splitting, dissipation."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import elastomdr as em

SPEEDS = np.geomspace(1e-3, 1e3, 7)  # times R/tau
FEW = settings(max_examples=25, deadline=None, derandomize=True)  # the same scenes in every run


def power(least: float, most: float) -> st.SearchStrategy[float]:
    """10 to an exponent between two bounds."""
    return st.floats(least, most).map(lambda exponent: 10.0**exponent)


SCENE = st.tuples(
    power(-2, 2), power(-2, 2),  # E_1 and E_2 over E_inf
    power(-3, 3),  # tau_2 over tau_1, but for being larger
    power(-6, -1),  # depth over R
)  # fmt: skip


def rubber(first, second, gap, modulus=1.0, time=1.0):
    return em.Foundation(modulus, [modulus * first, modulus * second], [time, time * (1 + gap)])


@FEW
@given(SCENE, power(-6, 6), power(-12, 12), power(-9, 3))
def test_units_of_modulus_time_and_length(scene, modulus, time, length):
    *branches, depth = scene
    plain = em.friction(rubber(*branches), em.Paraboloid(1.0), velocity=SPEEDS, depth=depth)
    other = em.friction(
        rubber(*branches, modulus, time), em.Paraboloid(length), velocity=SPEEDS * length / time, depth=depth * length
    )
    np.testing.assert_allclose(other.mu, plain.mu, rtol=1e-10)
    np.testing.assert_allclose(other.normal_force, plain.normal_force * modulus * length**2, rtol=1e-10)


@FEW
@given(SCENE, st.floats(0.05, 0.95))
def test_a_branch_in_two_parts_is_one(scene, part):
    first, second, gap, depth = scene
    late = 1 + gap
    whole = em.Foundation(1.0, [first, second], [1.0, late])
    parts = em.Foundation(1.0, [first, part * second, (1 - part) * second], [1.0, late, late * (1 + 1e-13)])
    one, two = (em.friction(r, em.Paraboloid(1.0), velocity=SPEEDS, depth=depth) for r in (whole, parts))
    np.testing.assert_allclose(two.mu, one.mu, rtol=3e-6)  # twice rtol, and what condensing may cost


@FEW
@given(SCENE)
def test_friction_is_never_negative_and_force_lies_between_the_elastic_ends(scene):
    *branches, depth = scene
    for average in (None, "direction"):
        found = em.friction(rubber(*branches), em.Paraboloid(1.0), velocity=SPEEDS, depth=depth, average=average)
        assert found.converged.all()
        assert (found.mu > 0).all()
        relaxed = 4 / 3 * depth**1.5  # (4/3) E sqrt(R) d^(3/2)
        glassy = relaxed * (1 + branches[0] + branches[1])
        assert (found.normal_force < glassy * (1 + 1e-9)).all()
        assert (found.normal_force > 0.5 * relaxed).all()  # at least the half that moves in
