"""Every problem with an exact answer, through the public calls."""

import numpy as np
import pytest

import elastomdr as em

from .problems import prony
from .problems.steady import PROBLEMS


def _fields(result):
    return {
        **{name: getattr(result, name) for name in result.__dataclass_fields__},
        **vars(result.contact),
    }


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_exact_answer(problem):
    result = problem.solve(rtol=1e-8)
    assert result.converged.all()
    fields = _fields(result)
    for name, value in problem.expected.items():
        np.testing.assert_allclose(fields[name], value, rtol=problem.rtol, err_msg=name)


@pytest.mark.parametrize(
    "problem", [p for p in PROBLEMS if p.rtol <= 1e-8], ids=lambda p: p.name
)
def test_error_covers_the_truth(problem):
    # The expected numbers have 16 digits, so that the true error can be seen down to
    # rounding.
    result = problem.solve()
    fields = _fields(result)
    coefficient = "coefficient" if "coefficient" in problem.expected else "mu"
    assert abs(fields[coefficient] - problem.expected[coefficient]) <= result.error


WIDE = ([3e5, 1e6, 2e6, 4e6, 1e7, 3e7], [1e2, 1.0, 1e-2, 1e-4, 1e-6, 1e-8])


@pytest.mark.parametrize(
    ("equilibrium", "velocity"),
    [(1e6, 1e-9)]
    + [(modulus, v) for modulus in (1e6, 0.0) for v in (1e-5, 1e-2, 3.0, 1e3, 1e8)],
)
def test_broad_spectrum_against_many_digits(equilibrium, velocity):
    moduli, times = WIDE[0], WIDE[1][::-1]
    mu, normal, drag, a, b = prony.line(
        equilibrium, moduli, times, 0.01, velocity, load=1.0
    )
    foundation = em.Foundation(equilibrium, moduli, times)
    got = em.friction(
        foundation,
        em.Paraboloid(0.01),
        velocity=velocity,
        load=1.0,
        model=em.Line(),
        rtol=1e-10,
    )
    assert got.converged
    np.testing.assert_allclose(
        [got.contact.leading, got.contact.trailing], [a, b], rtol=1e-12
    )
    np.testing.assert_allclose(
        [got.normal_force, got.friction_force], [normal, drag], rtol=1e-10
    )
    assert abs(got.mu - mu) <= got.error


def test_depth_control_is_exact_to_1e_10():
    moduli, times = WIDE[0], WIDE[1][::-1]
    velocity = np.logspace(-8, 6, 15)
    foundation = em.Foundation(1e6, moduli, times)
    got = em.friction(
        foundation,
        em.Paraboloid(0.01),
        velocity=velocity,
        depth=1e-4,
        model=em.Line(),
        rtol=1e-10,
    )
    exact = [prony.line(1e6, moduli, times, 0.01, v, size=1e-3)[0] for v in velocity]
    np.testing.assert_allclose(got.mu, exact, rtol=1e-10)


def test_saturated_cone():
    # Kelvin-Voigt beyond z = v tau sqrt(E c/F_N) = sqrt(2/3): contact ends at the apex,
    # and mu = c.
    modulus, slope, tau = 4e6, 0.2, 2e-3
    c = np.pi / 2 * slope
    z = np.array([0.9, 3.0, 1e4])
    rubber = em.KelvinVoigt(modulus / 4, modulus / 4 * tau)
    velocity = z / (tau * np.sqrt(modulus * c))
    got = em.friction(
        rubber, em.Cone(slope), velocity=velocity, load=1.0, model=em.Line()
    )
    assert (np.abs(got.mu - c) <= got.error).all()


def test_weak_loss_to_first_order():
    # mu = (E_1/E_inf) times a number that follows from the elastic contact alone
    # (spectral integral, 3D and line).
    share = 1e-6
    foundation = em.Foundation(4e6, [4e6 * share], [1e-3])
    sphere = em.Paraboloid(0.01)
    average = em.friction(
        foundation, sphere, velocity=2.0, load=10.0, model=em.Averaged(corrected=False)
    ).mu
    line = em.friction(foundation, sphere, velocity=2.0, load=10.0, model=em.Line()).mu
    np.testing.assert_allclose(average / share, 0.06640620163955166, rtol=1e-5)
    np.testing.assert_allclose(line / share, 0.1069025576568546, rtol=1e-5)


def test_constant_loss_tangent():
    # Greenwood & Tabor: the hysteresis share of the line is twice the sphere's 3/16;
    # with E'' = E' tan(delta) independent of frequency the ratio of line to half-space
    # is pi/2. A spectrum evenly dense in log tau comes near.
    times = np.logspace(-12, 12, 241)
    foundation = em.Foundation(1e6, np.full(times.size, 1.0), times)
    tan_delta = foundation.loss_tangent(1.0 / 1e-3)
    sphere = em.Paraboloid(0.01)
    line = em.friction(foundation, sphere, velocity=1.0, load=1.0, model=em.Line())
    average = em.friction(foundation, sphere, velocity=1.0, load=1.0)
    a_over_r = line.contact.leading / 0.01
    np.testing.assert_allclose(
        line.mu / tan_delta / a_over_r, 0.954929658551372, rtol=1e-3
    )
    np.testing.assert_allclose(
        average.mu / tan_delta / a_over_r, 0.6079271018540267, rtol=1e-3
    )


# (E_1/E_inf, v [m/s], mu of the half-space, mu of the bare line, relative tolerance)
REFERENCE_3D = [
    (0.5, 1.0, 0.02444, 0.0421, 0.015),
    (0.5, 15.0, 0.00769, 0.00879, 0.015),
    (3.0, 0.1, 0.02643, 0.05162, 0.015),
    (3.0, 1.0, 0.07147, 0.10866, 0.015),
    (3.0, 10.0, 0.01475, 0.01622, 0.015),
    (9.0, 0.1, 0.06731, 0.12718, 0.03),
    (9.0, 1.0, 0.071, 0.09498, 0.03),
]


@pytest.mark.parametrize(
    ("contrast", "velocity", "half_space", "bare", "rtol"), REFERENCE_3D
)
def test_against_a_three_dimensional_solution(
    contrast, velocity, half_space, bare, rtol
):
    # A sphere on a standard solid, boundary elements to about 1%. The model's own
    # error: 2.3% to contrast 3, 5% at 9.
    foundation = em.Foundation(4e6, [4e6 * contrast], [1e-3])
    scene = {"velocity": velocity, "load": 10.0}
    line = em.friction(foundation, em.Paraboloid(0.01), **scene, model=em.Line()).mu
    average = em.friction(foundation, em.Paraboloid(0.01), **scene).mu
    np.testing.assert_allclose(line, bare, rtol=1e-3)
    np.testing.assert_allclose(
        average, half_space, rtol=rtol + (0.023 if contrast <= 3 else 0.05)
    )
