"""The sentences of the package, one of each kind, word for word; everywhere else tests
hold what is said against its values only.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.app import words as page
from elastomdr.cli.units import shown
from elastomdr.results.doubts import KINDS

DOUBTS = {
    "not converged": (
        "did not converge and are NaN; surer: what the ConvergenceWarning beside them "
        "names"
    ),
    "no prediction": (
        "have no bound on the model; surer: a measured value to compare with"
    ),
    "extrapolated": (
        "lie beyond the range of the material; surer: moduli measured at those "
        "frequencies and temperatures"
    ),
    "hot branch": (
        "have another steady state (`other_states`), which rubber reaches that was "
        "hotter or colder before"
    ),
    "bound": "have a bound on the model above half of the value",
    "illustrative": (
        "rest on moduli that are illustrative, of no particular rubber; surer: a "
        "material fitted to your own data"
    ),
    "estimate": "are estimates",
}
RUBBER = em.Prony(1e6, [1e6], [1e-3], range={"omega": (1.0, 1e2)})
ROAD = em.SelfAffine(0.8, rms_slope=1.0, q_low=1e3, q_high=1e5)
# an error, and what Python, the terminal and the page say
RADIUS = em.InputError(
    argument="radius", accepted="positive", got="-5 mm", hint="radii are lengths"
)


def terminal(error):
    return error.words(shown=shown)


ERRORS = {
    str: "radius must be positive, got '-5 mm': radii are lengths.",
    terminal: 'radius must be positive, got "-5 mm": radii are lengths.',
    page.in_words: '“Radius R” must be positive, got "-5 mm": radii are lengths.',
}


def test_doubts():
    mask = np.array([True, False, True])
    said = {kind: em.Doubt(kind, mask).words() for kind in KINDS}
    assert said == {kind: f"2 of 3 points {words}" for kind, words in DOUBTS.items()}


@pytest.mark.parametrize("words", ERRORS)
def test_an_error_in_the_words_of_where_it_is_read(words):
    assert words(RADIUS) == ERRORS[words]


def test_a_hint_that_is_a_question():
    error = em.InputError(argument="shape", accepted="a body", got=3, hint="A ball?")
    assert str(error) == "shape must be a body, got 3. A ball?"


def test_points_beyond_the_data():
    said = (
        "2 of 2 points lie beyond the range of the material: the passage means "
        "frequencies (v a_T/(2a) to 2 v a_T/a) from 0.188 to 878 rad/s, range 1 to 100 "
        "rad/s."
    )
    with pytest.warns(em.ExtrapolationWarning) as caught:
        em.friction(RUBBER, em.Sphere(0.1), velocity=[1e-3, 1.0], load=1.0)
    assert [str(each.message) for each in caught] == [said]


def test_a_pressure_in_another_unit():
    said = (
        "pressure is taken in Pa, and load in N: a pressure of 3e+08 Pa is 75 times the "
        "modulus of the rubber under it, 4e+06 Pa. Rubber is not linear there."
    )
    soft = em.Prony(1e6, [1e6], [1e-3])
    with pytest.warns(em.ModelWarning) as caught:
        em.press(soft, ROAD, pressure=3e8, model=em.Line(seeds=2))
    assert said in [str(each.message) for each in caught]
