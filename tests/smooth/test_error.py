"""The stated error of steady sliding covers the true one, and what is skipped costs
what the plan says.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import elastomdr as em

from .test_steady import BROAD, SHAPES


@pytest.mark.parametrize(
    ("shape", "rtol"),
    [
        ("paraboloid", 1e-3),
        ("paraboloid", 1e-6),
        ("paraboloid", 1e-10),
        pytest.param("sphere", 1e-6, marks=pytest.mark.slow),
    ],
)
@pytest.mark.filterwarnings("ignore:.*deeper than the radius")
def test_rtol_is_honoured_and_covered(shape, rtol):
    foundations = {
        "broad": BROAD,
        "one branch": em.Foundation(4e6, [12e6], [1e-3]),
        "strong": em.Foundation(1e5, [1e9], [1e-3]),
        "liquid": em.Foundation(0.0, [1e7, 1e6], [1e-4, 1.0]),
        "dashpot": em.Foundation.kelvin(1e6, 1e3),
    }
    if shape == "sphere":
        # A liquid lets it sink to the equator in slow directions:
        # test_a_sphere_sinks_in_a_liquid.
        foundations = {name: foundations[name] for name in ("broad", "strong")}
    velocity = np.logspace(-2, 3, 4)
    for name, foundation in foundations.items():
        got = em.friction(
            foundation,
            SHAPES[shape],
            velocity=velocity,
            load=0.1,
            rtol=rtol,
            model=em.Averaged(corrected=False),
        )
        # Independent quadrature: cos(phi) = sin(theta), theta = (pi/2) exp(-s), Gauss
        # on panels in s.
        node, weight = np.polynomial.legendre.leggauss(8)
        s = (0.5 * np.arange(50)[:, None] + 0.25 * (node + 1)).ravel()
        theta = np.pi / 2 * np.exp(-s)
        line = em.friction(
            foundation,
            SHAPES[shape],
            velocity=velocity[:, None] * np.sin(theta),
            load=0.1,
            rtol=1e-10,
            model=em.Line(),
        ).mu
        truth = (
            (line * np.sin(theta) * theta * np.tile(0.25 * weight, 50)).sum(axis=1)
            * 2
            / np.pi
        )
        miss = np.abs(got.mu - truth)
        assert got.converged.all(), name
        assert (miss <= got.error + 3e-11 * truth).all(), (name, miss / truth)
        assert (got.error <= rtol * got.mu).all(), name


@pytest.mark.slow
def test_strips_of_a_layer_are_counted_in_the_error():
    # Across a cone's tip strips converge slowly. Elastic with a weak dashpot, mu = eta
    # v int g'^2 / F, by quadrature of its own: strips of half-width X = sqrt(A^2 -
    # y^2), int g'^2 dx = 2 s^2 [X - y atan(X/y)].
    stiffness, viscosity, slope, load = 1e9, 1.0, 0.1, 0.5
    foundation = em.Foundation(stiffness, [], [], viscosity, per_area=True)
    got = em.friction(foundation, em.Cone(slope), velocity=1e-3, load=load)
    radius = (3 * load / (np.pi * stiffness * slope)) ** (1 / 3)
    node, weight = np.polynomial.legendre.leggauss(400)
    theta = np.pi / 4 * (node + 1)
    y, x = radius * np.sin(theta), radius * np.cos(theta)
    loss = np.pi / 4 * weight @ (2 * x * 2 * slope**2 * (x - y * np.arctan2(x, y)))
    np.testing.assert_allclose(got.contact.leading, radius, rtol=1e-6)
    assert abs(got.mu - viscosity * 1e-3 * loss / load) <= got.error + 1e-9 * got.mu
    assert got.error <= 1e-6 * got.mu


@pytest.mark.slow
def test_a_power_law_counts_what_its_tip_costs():
    # One branch at a depth, by adaptive quadrature of q(x) = E_inf [g(a) - g(x)] + E_1
    # int_x^a exp(-(y-x)/s) g'(y) dy.
    exponent, velocity = 1.5, 10.0
    body, decay = em.PowerLaw(exponent, 0.3 * 1e-3 ** (1 - exponent)), velocity * 1e-3
    steep = float(body.profile_1d(1.0))  # g = steep |x|^n
    edge = (1e-4 / steep) ** (1 / exponent)

    def slope(x):
        return steep * exponent * abs(x) ** (exponent - 1) * np.sign(x)

    def integral(function, low, high):
        options = {"epsabs": 0.0, "epsrel": 1e-12, "limit": 200}
        ends = [low, 0.0, high] if low < 0 < high else [low, high]
        return sum(quad(function, x, y, **options)[0] for x, y in pairwise(ends))

    def density(x):
        memory = (
            integral(lambda y: np.exp(-(y - x) / decay) * slope(y), x, edge)
            if x < edge
            else 0.0
        )
        return 1e6 * steep * (edge**exponent - abs(x) ** exponent) + 4e6 * memory

    exit = brentq(
        lambda b: density(-b),
        0.1 * edge,
        edge * (1 - 1e-9),
        xtol=1e-15 * edge,
        rtol=1e-14,
    )
    truth = integral(lambda x: density(x) * slope(x), -exit, edge) / integral(
        density, -exit, edge
    )
    got = em.friction(
        em.Foundation(1e6, [4e6], [1e-3]),
        body,
        velocity=velocity,
        depth=1e-4,
        model=em.Line(),
        rtol=1e-3,
    )
    assert abs(got.mu - truth) <= got.error + 1e-11 * truth
    assert got.error <= 1e-3 * got.mu


def test_a_loss_lost_in_rounding_is_not_returned():
    solid = em.StandardSolid(1e6, 1e6, 1e-3)
    with pytest.warns(em.ConvergenceWarning, match="1 of 2 points"):
        curve = em.friction(
            solid, em.Paraboloid(5e-3), velocity=[1e10, 1e40], load=1.0, model=em.Line()
        )
    assert curve.converged.tolist() == [True, False]
