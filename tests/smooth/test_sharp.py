"""Cones, power laws below 2 and profiles from points: the memory of their panels, its
error, its derivatives.
"""

from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import dblquad, quad

import elastomdr as em
from elastomdr.arrays import numpy_unless_traced
from elastomdr.material.relaxation import Relaxation
from elastomdr.smooth import solve as sweep_of_points
from elastomdr.smooth.memory import Passage, direct, memory, tabulated
from elastomdr.surface.lines import SingleLine
from elastomdr.surface.sampling import ladder

BARE = em.Averaged(corrected=False)
RUBBER = em.Foundation(1e6, np.full(8, 2.5e6), np.logspace(-6, 0, 8))
R = np.linspace(0, 2e-3, 41)
VELOCITY = np.logspace(-4, 3, 9)


@pytest.mark.parametrize("decay", [1e-7, 1e-5, 3e-4, 1e-2, 1e6])
@pytest.mark.parametrize(
    "shape",
    [em.PowerLaw(1.3, 0.5), em.Cone(0.2), em.Profile(R, R**1.5)],
    ids=["power", "cone", "profile"],
)
def test_the_memory_is_its_integrals(shape, decay):
    """All of them against adaptive quadrature, for decay lengths from 1e-4 to 1e10 of
    the contact's.
    """
    rule = ladder(shape, 1e-9)[0]
    law = Relaxation(np.array(0.0), np.ones(1), np.full(1, decay), np.array(0.0))
    place = 6.1e-4
    size = np.array([place])

    @numpy_unless_traced
    def found():
        p = tabulated(Passage(law, SingleLine(shape), rule, np.ones(1)), 1.1 * size)
        m = memory(p, size, size[None, None], full=True)
        return {name: x.ravel()[0] for name, x in m._asdict().items()}

    def slope(x):
        return float(shape.slope_1d(x))

    cuts = np.unique(
        np.concatenate([R[place > R], place * np.logspace(-5, 0, 11), [0, place]])
    )
    panels = list(pairwise(cuts))
    if decay < 1e-5:  # a layer: add it up on its own scale
        near = [x for x in decay * np.array([0.3, 1, 3, 10, 40]) if x < place]
        cuts = np.unique(np.concatenate([cuts, near, place - np.array(near)]))
        panels = list(pairwise(cuts))

    def integral(weight):
        return sum(
            quad(lambda x: weight(x) * slope(x), *ends, epsabs=0, epsrel=1e-11)[0]
            for ends in panels
        )

    got = found()
    expected = (
        integral(lambda x: np.exp(-x / decay)),
        integral(lambda x: -np.expm1(-x / decay)),
        integral(lambda x: np.exp(-(place - x) / decay)),
        integral(lambda x: -np.expm1(-(place - x) / decay)),
    )
    np.testing.assert_allclose(
        [got[x] for x in ("near", "near_lost", "far", "far_lost")], expected, rtol=2e-9
    )
    np.testing.assert_allclose(
        (got["moment"], got["square"]),
        (integral(lambda x: x), integral(slope)),
        rtol=2e-9,
    )
    if decay == 3e-4 and not isinstance(shape, em.Profile):

        def work(x, y):
            return np.exp(-(y - x) / decay) * slope(x) * slope(y)

        both = dblquad(work, 0, place, 0, lambda y: y, epsabs=0, epsrel=1e-8)[0]
        half = 0.5 * float(shape.profile_1d(place)) ** 2
        np.testing.assert_allclose(
            (got["work"], got["work_lost"]), (both, half - both), rtol=1e-7
        )


def test_a_place_ahead_of_the_apex_feels_what_lies_before_it():
    law = Relaxation(np.array(0.0), np.ones(2), np.array([2e-5, 1e-2]), np.array(0.0))
    shape, size, places = (
        em.PowerLaw(1.4, 0.5),
        np.full(3, 1e-3),
        np.array([-4e-4, 0.0, 7e-4]),
    )
    passage = Passage(law, SingleLine(shape), ladder(shape, 1e-9)[0], np.ones(3))
    kept, lost, _ = numpy_unless_traced(lambda: direct(passage, size, places))()
    for i, b in enumerate(places):
        for k, s in enumerate(law.times):
            cuts = np.unique(
                np.clip(
                    [
                        -b,
                        *(-b + s * np.array([0.5, 2, 8, 40])),
                        0.0,
                        1e-6,
                        1e-5,
                        1e-4,
                        1e-3,
                    ],
                    -b,
                    1e-3,
                )
            )
            expected = [0.0, 0.0]
            for low, high in pairwise(cuts):
                for j, weight in enumerate(
                    (lambda r, s=s: np.exp(-r / s), lambda r, s=s: -np.expm1(-r / s))
                ):
                    expected[j] += quad(
                        lambda x, weight=weight, b=b: (
                            weight(x + b) * float(shape.slope_1d(x))
                        ),
                        low,
                        high,
                        epsrel=1e-11,
                    )[0]
            np.testing.assert_allclose(
                (kept[0, 0, k, i], lost[0, 0, k, i]), expected, rtol=1e-6
            )


@pytest.mark.parametrize("model", [em.Line(), BARE])
@pytest.mark.parametrize(
    ("shape", "points", "rtol"),
    [
        (em.Cone(0.2), 0.2 * R, 1e-9),
        (em.Paraboloid(5e-3), R**2 / 1e-2, 1e-9),
        # fourth order in the distance of the points
        (em.Sphere(5e-3), 5e-3 - np.sqrt(25e-6 - R**2), 1e-7),
    ],
    ids=["cone", "paraboloid", "sphere"],
)
def test_points_of_a_body_slide_as_the_body(shape, points, rtol, model):
    scene = {"velocity": VELOCITY, "load": 0.1, "rtol": 1e-8, "model": model}
    body, through = (
        em.friction(RUBBER, shape, **scene),
        em.friction(RUBBER, em.Profile(R, points), **scene),
    )
    assert through.converged.all()
    np.testing.assert_allclose(through.mu, body.mu, rtol=rtol + 2e-8 * (model is BARE))
    for edge in ("leading", "trailing"):
        np.testing.assert_allclose(
            getattr(through.contact, edge), getattr(body.contact, edge), rtol=10 * rtol
        )


@pytest.mark.parametrize(
    "shape", [em.Cone(0.2), em.Profile(R, 0.2 * R)], ids=["cone", "points"]
)
def test_kelvin_voigt_cone_in_closed_form(shape):
    """mu/c = 2 z sqrt(1 - z^2/2) - z^2/2 up to z = sqrt(2/3), then 1; c = (pi/2)
    tan(theta), z = v tau sqrt(E c/F).
    """
    modulus, tau, load, c = 1e6, 1e-3, 0.1, np.pi / 2 * 0.2
    z = np.array([1e-3, 0.03, 0.3, 0.7, 0.81, 0.9, 3.0])
    got = em.friction(
        em.Foundation.kelvin(modulus, modulus * tau),
        shape,
        velocity=z / (tau * np.sqrt(modulus * c / load)),
        load=load,
        model=em.Line(),
        rtol=1e-9,
    )
    expected = np.where(
        z < np.sqrt(2 / 3), 2 * z * np.sqrt(np.maximum(1 - z**2 / 2, 0)) - z**2 / 2, 1.0
    )
    np.testing.assert_allclose(got.mu / c, expected, rtol=1e-9)


@pytest.mark.parametrize(
    "shape",
    [
        em.PowerLaw(1.05, 0.3),
        em.PowerLaw(1.3, 1.0),
        em.PowerLaw(1.8, 10.0),
        em.Profile(R, 0.3 * R**1.1),
    ],
    ids=["1.05", "1.3", "1.8", "points"],
)
def test_the_error_covers_and_the_tolerance_is_met(shape):
    truth = em.friction(
        RUBBER, shape, velocity=VELOCITY, load=0.1, rtol=1e-10, model=em.Line()
    )
    for rtol in (1e-2, 1e-4, 1e-6, 1e-7):
        got = em.friction(
            RUBBER, shape, velocity=VELOCITY, load=0.1, rtol=rtol, model=em.Line()
        )
        miss = np.abs(got.mu - truth.mu)
        assert got.converged.all()
        assert (miss <= got.error + truth.error).all(), (rtol, miss / got.error)
        assert (got.error <= rtol * got.mu).all()


def test_shorter_steps_of_an_average_solve_only_what_is_new(monkeypatch):
    solved, solve = [], sweep_of_points._solve

    def counted(*scene):
        solved.extend(zip(scene[2].tolist(), scene[3].tolist(), strict=True))
        return solve(*scene)

    monkeypatch.setattr(sweep_of_points, "_solve", counted)
    em.friction(
        RUBBER, em.Cone(0.2), velocity=[0.1, 0.3], load=0.1, rtol=1e-6, model=BARE
    )
    assert len(solved) > 150  # steps were halved
    assert len(set(solved)) == len(solved)


@pytest.mark.parametrize("exponent", [1.3, 1.0])
def test_derivatives_are_those_of_the_numbers(exponent):
    def mu(x):
        law = em.Foundation(x[0], [x[1], 4e6], [x[2], 1e-2])
        shape = em.Cone(x[3]) if exponent == 1 else em.PowerLaw(exponent, x[3])
        return em.friction(
            law, shape, velocity=x[4], load=x[5], rtol=1e-8, model=em.Line()
        ).mu

    x = np.array([1e6, 8e6, 1e-4, 0.2, 0.3, 0.1])
    with jax.enable_x64(True):
        value, slope = jax.value_and_grad(mu)(jnp.asarray(x))
    assert float(value) == pytest.approx(float(mu(x)), rel=1e-7)
    step = 1e-4 * x * np.array([0.7, -1.3, 1.1, 0.8, -0.6, 1.2])
    change = 0.5 * (float(mu(x + step)) - float(mu(x - step)))
    assert float(np.asarray(slope) @ step) == pytest.approx(change, rel=1e-5)
