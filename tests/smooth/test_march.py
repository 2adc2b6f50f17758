"""Marching through a profile: against the closed passage where that holds, and where
contact returns.
"""

import math
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.arrays import xp
from elastomdr.element.contact_step import contact_step, rest
from elastomdr.material.relaxation import Relaxation
from elastomdr.smooth.march import march_passages
from elastomdr.smooth.passage import solve_passages
from elastomdr.surface.lines import SingleLine, Strips
from elastomdr.surface.profile import Profile
from elastomdr.surface.sampling import Rule
from elastomdr.surface.shapes import AbstractShape, Cone, Paraboloid, Sphere

from ..refused import refused, warned


def six(equilibrium, moduli, times, viscosity=0.0):
    """A law with six branches, empty ones included: laws of one size share their
    compiled code.
    """
    empty = 6 - len(moduli)
    moduli, times = (
        [*moduli, *[0.0] * empty],
        [*times, *10.0 ** np.arange(3, 3 + empty)],
    )
    return Relaxation(*map(np.asarray, (equilibrium, moduli, times, viscosity)))


RUBBER = six(4e6, np.geomspace(1e8, 1e6, 6), np.logspace(-6, 1, 6))
DAMPED = six(4e6, [8e6], [1e-3], 4e2)
LIQUID = six(0.0, [8e6], [1e-3])
BODY = em.Foundation(4e6, [8e6], [1e-3])
VELOCITIES = np.logspace(-4, 3, 15)


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


class Terraces(AbstractShape):
    """g = s (|x| + (1 - cos kx) b/k): nearly flat terraces, on which a recovering
    element meets the body again.
    """

    slope: float
    wave: float
    depth: float
    label: ClassVar[str] = "terraces"

    def _height(self, r):
        return xp.full_like(r, xp.nan)  # given on its line only

    def _profile(self, x):
        x = xp.abs(x)
        return self.slope * (x + self.depth * (1 - xp.cos(self.wave * x)) / self.wave)

    def _slope(self, x):
        return (
            self.slope * xp.sign(x) * (1 + self.depth * xp.sin(self.wave * xp.abs(x)))
        )


TERRACES = SingleLine(Terraces(0.1, 2 * np.pi / 1e-3, 0.95))


def bumpy(height=1.5e-5):
    r = np.linspace(0, 4e-3, 33)
    return SingleLine(
        Profile(r, r**2 / 0.02 + height * (1 - np.cos(2 * np.pi * r / 1.5e-3)))
    )


# ---------------------------------------------------------------- where the closed
# passage holds


@pytest.mark.parametrize(
    ("shape", "rule", "law", "control", "value"),
    [
        (Paraboloid(0.01), Rule(4, exact=True), RUBBER, "load", 1.0),
        (Paraboloid(0.01), Rule(4, exact=True), LIQUID, "load", 1.0),
        (Paraboloid(0.01), Rule(4, exact=True), DAMPED, "load", 100.0),
        (Paraboloid(0.01), Rule(4, exact=True), DAMPED, "depth", 3e-4),
        (Cone(0.1), Rule(4, split=True, exact=True), DAMPED, "load", 1.0),
        (Cone(0.1), Rule(4, split=True, exact=True), RUBBER, "load", 1.0),
        (Sphere(0.01), Rule(12), RUBBER, "depth", 1e-3),
    ],
    ids=[
        "rubber",
        "liquid",
        "damped",
        "damped-depth",
        "cone-damped",
        "cone-rubber",
        "sphere-depth",
    ],
)
@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
def test_agrees_with_the_passage(shape, rule, law, control, value, rtol):
    value, lines = np.full(VELOCITIES.shape, value), SingleLine(shape)
    exact = solve_passages(law, lines, rule, control, value, VELOCITIES)
    march = march_passages(law, lines, control, value, VELOCITIES, rtol)
    assert march.converged.all()
    assert (march.error <= rtol * march.mu).all()
    assert (
        np.abs(march.mu - exact.mu) <= march.error + exact.error + 1e-11 * exact.mu
    ).all()
    for name in ("normal_force", "friction_force", "depth", "leading"):
        np.testing.assert_allclose(
            getattr(march, name), getattr(exact, name), rtol=max(rtol, 1e-7)
        )
    np.testing.assert_allclose(
        march.trailing, exact.trailing, atol=2e-3 * float(exact.leading.max())
    )


def test_strips_of_a_layer():
    """A paraboloid on a Kelvin layer, k and eta per area, at low speed: F_N = pi k
    a^4/(4R), mu = eta v/(k R).
    """
    layer, lines = (
        Relaxation(*map(np.asarray, (2e10, [], [], 2e7))),
        Strips(Paraboloid(0.5)),
    )
    march = march_passages(
        layer, lines, "depth", np.full(2, 1e-4), np.array([1e-7, 1e-6]), 1e-6
    )
    assert march.converged.all()
    np.testing.assert_allclose(
        march.leading, 0.01 * np.cos(np.pi / 4 * (1 - 0.98940093499164993)), rtol=1e-12
    )
    np.testing.assert_allclose(march.normal_force, np.pi * 2e10 * 1e-8 / 2, rtol=1e-6)
    np.testing.assert_allclose(march.mu, 2e7 * np.array([1e-7, 1e-6]) / 1e10, rtol=1e-6)


# ---------------------------------------------------------------- where contact returns


@jax.jit
def contacts(law, size, velocity):
    """How many times an element is in contact on its way from a to -a."""
    profile, count = TERRACES.shape._profile, 4096
    w = (profile(size) - profile(size * (1 - 2 * jnp.linspace(0.0, 1.0, count + 1))))[
        :, None
    ]

    def step(state, ends):
        state = contact_step(law, state, *ends, 2 * size / velocity / count)
        return state, state.q[0] > 0

    _, touching = jax.lax.scan(step, rest(law, 1), (w[:-1], w[1:]))
    return touching[0] + jnp.sum(touching[1:] & ~touching[:-1])


@pytest.mark.parametrize("law", [RUBBER, DAMPED], ids=["rubber", "damped"])
def test_contact_returns_and_the_error_covers_it(law):
    law = jax.tree.map(jnp.asarray, law)
    velocity, depth = np.logspace(-3, 2, 11), np.full(11, 8e-4)
    coarse, fine = (
        march_passages(law, TERRACES, "depth", depth, velocity, rtol)
        for rtol in (1e-3, 1e-6)
    )
    assert max(contacts(law, fine.leading[i], velocity[i]) for i in (4, 6, 10)) > 1
    assert coarse.converged.all()
    assert fine.converged.all()
    assert (fine.mu > 0).all()
    np.testing.assert_allclose(fine.depth, 8e-4, rtol=1e-12)
    assert (np.abs(coarse.mu - fine.mu) <= coarse.error + fine.error).all()


@pytest.mark.slow
def test_profile_from_points_that_is_not_convex():
    lines, velocity = bumpy(), np.logspace(-3, 2, 9)
    assert not lines.shape.convex
    load = np.full(9, 5.0)
    march, finer = (
        march_passages(DAMPED, lines, "load", load, velocity, rtol)
        for rtol in (1e-6, 1e-8)
    )
    assert march.converged.all()
    assert (np.abs(march.mu - finer.mu) <= march.error + finer.error).all()
    np.testing.assert_allclose(march.normal_force, load, rtol=1e-8)
    # nearly elastic and nearly glassy: friction vanishes as v and as 1/v
    extreme = np.array([1e-9, 1e-8, 1e-7, 1e-2, 1e0, 1e2, 1e7, 1e8, 1e9])
    mu = march_passages(RUBBER, lines, "load", load, extreme, 1e-4).mu
    np.testing.assert_allclose(
        [mu[1] / mu[0], mu[2] / mu[1], mu[6] / mu[7], mu[7] / mu[8]], 10, rtol=1e-3
    )
    # a load beyond what the points of the profile can carry; its neighbours are not
    # disturbed
    load[4] = 1e6
    march = march_passages(DAMPED, lines, "load", load, velocity, 1e-5)
    np.testing.assert_array_equal(march.converged, load < 1e6)


@pytest.mark.slow
def test_truncated_paraboloid():
    """f = (r^2 - b^2)_+ / 2R has g = x sqrt(x^2 - b^2)/R and F = 2 E*/(3R) (2 a^2 +
    b^2) sqrt(a^2 - b^2), elastic; the march meets it as it meets two sampling rates of
    each other.
    """
    bottom, radius, contact = 1e-3, 2e-2, 2.5e-3
    depth = contact / radius * math.sqrt(contact**2 - bottom**2)
    force = (
        2
        / (3 * radius)
        * (2 * contact**2 + bottom**2)
        * math.sqrt(contact**2 - bottom**2)
    )
    errors = []
    for spacing in (5e-5, 2.5e-5, 1.25e-5):
        r = np.arange(0, 4e-3 + 0.5 * spacing, spacing)
        body = Profile(r, np.maximum(r**2 - bottom**2, 0) / (2 * radius))
        assert not body.sharp
        assert not body.convex
        errors.append(abs(float(body.profile_1d(contact)) / depth - 1))
    assert errors[0] < 1e-5
    assert errors[2] < errors[0] / 8  # towards second order in the spacing, at the bend
    with pytest.raises(em.InputError, match="grows as a disc"):
        Profile(r, np.maximum(r**2 - bottom**2, 0) / (2 * radius), curve="spline")
    body = Profile(
        np.arange(0, 4.05e-3, 1e-4),
        np.maximum(np.arange(0, 4.05e-3, 1e-4) ** 2 - bottom**2, 0) / (2 * radius),
    )
    solid = em.StandardSolid(1e6, 3e6, 1e-3)
    curve = em.friction(
        solid,
        body,
        velocity=np.array([1e-3, 1.0, 1e4]),
        depth=depth,
        rtol=1e-3,
        model=em.Line(),
    )
    assert curve.converged.all()
    np.testing.assert_allclose(
        curve.normal_force[[0, 2]], [4e6 * force, 1.6e7 * force], rtol=5e-4
    )
    with warned(em.ConvergenceWarning, "larger rtol would"):
        fine = em.friction(
            solid,
            body,
            velocity=np.array([1e-3, 1.0, 1e4]),
            depth=depth,
            rtol=1e-8,
            model=em.Line(),
        )
    assert np.isnan(fine.mu[0])


def test_refused_under_a_transformation():
    shape = bumpy().shape
    with refused("shape", "convex", "jit"):
        jax.grad(lambda v: em.friction(BODY, shape, velocity=v, load=1.0).mu)(1.0)


def drawn_scene(number):
    """A body on a half-space or on springs, rubber of four branches over decades, with
    a dashpot now and then, one velocity, a load or a depth.
    """
    draw = np.random.default_rng([45, number])
    size = 10 ** draw.uniform(-4, -2)  # of the contact, about [m]
    deep = 10 ** draw.uniform(-2.5, -0.7)  # over that
    shape: Any = (
        em.Paraboloid(size / deep),
        em.Sphere(size / deep),
        em.Cone(deep),
        em.PowerLaw(draw.uniform(1.5, 5), 1.0),
    )[number % 4]
    if number % 4 == 3:
        shape = em.PowerLaw(
            float(shape.exponent), deep * size ** (1 - float(shape.exponent))
        )
    soft, glassy = 10 ** draw.uniform(5, 7), 10 ** draw.uniform(0, 2.5)
    moduli = soft * glassy * draw.dirichlet([0.7] * 4)
    times = np.sort(10 ** draw.uniform(-5, 0, 4))
    viscosity = soft * times[0] * (number % 5 == 0)
    law = em.Foundation(soft, moduli, times, viscosity)
    velocity = size / times[draw.integers(4)] * 10 ** draw.uniform(-1.5, 1.5)
    if number % 3 == 0:
        solid = em.Prony(soft, moduli, times, poisson=0.45, viscosity=viscosity)
        law = em.springs(solid, size, bonded=False)
    if number % 2:
        return law, shape, {"velocity": velocity, "depth": 0.5 * size * deep}
    return law, shape, {"velocity": velocity, "load": 0.5 * soft * size**2 * deep}


@pytest.mark.parametrize("number", range(12))
def test_marched_elements_have_the_friction_of_the_closed_forms(number):
    """Within the stated errors of both; `python benchmarks/marched.py` has 200 such
    scenes.
    """
    law, shape, given = drawn_scene(number)
    closed: Any = em.friction(law, shape, **given)
    marched: Any = em.friction(law, shape, model=em.Marched(), rtol=1e-3, **given)
    assert marched.converged
    assert abs(marched.mu - closed.mu) <= marched.error + closed.error
    np.testing.assert_allclose(marched.depth, closed.depth, rtol=1e-3)
    assert "marched by diffrax" in marched.model


def test_rolling_and_what_the_elements_do(tmp_path):
    """Their forces are those of the curve, and Signorini's conditions hold; a figure
    and a moving picture show them.
    """
    rubber = em.Prony(0.5e6, [1e6, 2e6], [1e-3, 1e-1])
    ball, given = em.Sphere(5e-3), {"velocity": [1e-3, 0.3], "load": 1.0}
    curve = em.rolling(rubber, ball, model="marched", rtol=1e-4, **given)
    closed = em.rolling(rubber, ball, **given)
    np.testing.assert_allclose(curve.coefficient, closed.coefficient, rtol=1e-4)
    line = em.friction(rubber, ball, model=em.Line(), **given)
    elements = curve.elements(1)
    np.testing.assert_allclose(np.trapezoid(elements.q, elements.x), 1.0, rtol=1e-4)
    drag = np.trapezoid(elements.q * np.gradient(elements.u, elements.x), elements.x)
    np.testing.assert_allclose(-drag, line.friction_force[1], rtol=1e-3)
    touched = elements.q > 0
    # to rounding, as `u` and the surface come from two compiled programs
    at_surface = elements.u[touched], elements.surface[touched]
    np.testing.assert_allclose(*at_surface, rtol=1e-14, atol=1e-19)
    assert (elements.u >= elements.surface - 1e-19).all()
    total = elements.spring + elements.branches.sum(axis=0)
    np.testing.assert_allclose(total[touched], elements.q[touched], rtol=1e-9)
    assert elements.branches.shape == (2, elements.x.size)
    assert not elements.q[elements.x < -1e-9 - line.contact.trailing[1] * 1.02].any()

    ax = elements.plot()
    assert len(ax.figure.axes) == 2
    elements.animate(tmp_path / "ball.gif", frames=3)
    from PIL import Image

    with Image.open(tmp_path / "ball.gif") as picture:
        assert picture.n_frames == 3


def test_the_figure_of_many_branches_names_those_that_carry_most():
    rubber = em.Prony(0.5e6, np.geomspace(3e6, 1e5, 9), np.logspace(-5, 3, 9))
    curve = em.friction(
        rubber, em.Sphere(5e-3), velocity=0.1, load=1.0, model=em.Marched(), rtol=1e-3
    )
    elements = curve.elements()
    lower = elements.plot().figure.axes[1]
    labels = [text.get_text() for text in lower.get_legend().get_texts()]
    largest = np.argsort(-np.abs(elements.branches).max(axis=1))[:4]
    assert labels[2:] == [*(f"branch {k + 1}" for k in largest), "other branches"]
    assert len(lower.lines) == 2 + 9


def test_elastic_rubber_has_elements_and_no_friction():
    """And says so without a share of nothing, by every model."""
    rubber, ball = em.Prony(0.5e6, [], []), em.Sphere(5e-3)
    for model in (None, em.Marched()):
        curve = em.friction(rubber, ball, velocity=[0.1, 0.3], load=1.0, model=model)
        assert (curve.mu == 0).all()
        assert "nan" not in curve.summary()
    elements = curve.elements(1)
    np.testing.assert_allclose(np.trapezoid(elements.q, elements.x), 1.0, rtol=1e-4)
    under = elements.q[np.abs(elements.x) <= elements.x[-1]]
    np.testing.assert_allclose(under, under[::-1], atol=1e-9 * under.max())


def test_marched_is_refused_where_there_are_no_such_elements():
    rubber, ball = em.Prony(0.5e6, [1e6], [1e-3]), em.Sphere(5e-3)
    road = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1e5)
    line = em.RoughLine(np.arange(64) * 1e-5, np.sin(np.arange(64)))
    given = {"velocity": 0.3, "model": em.Marched()}
    with refused("model", "Marched", "em.springs"):
        em.friction(em.layer(rubber, 1e-2), ball, load=1.0, **given)
    for surface, by in ((road, {"pressure": 1e5}), (line, {"load": 1e3})):
        with refused("model", "Marched"):
            em.friction(rubber, surface, **by, **given)
    with refused("model", "branches"):
        em.dissipation(rubber, ball, load=1.0, **given)
    with refused("model", "em.Averaged()"):
        em.friction(rubber, em.Cylinder(5e-3, 0.05), load=1.0, **given)
    marched: Any = em.friction(rubber, ball, load=1.0, rtol=1e-3, **given)
    calls: Any = (
        (em.friction(rubber, ball, velocity=0.3, load=1.0), 0, "model"),
        *((marched, point, "point") for point in (1, -2, (0,), "first", 0.0, None)),
    )
    for curve, point, name in calls:
        with pytest.raises(em.InputError) as raised:
            curve.elements(point)
        assert raised.value.argument == name
    assert marched.elements(()).q.max() == marched.elements(0).q.max()

    def friction(velocity):
        return em.friction(
            rubber, ball, load=1.0, velocity=velocity, model=em.Marched()
        ).mu

    with refused("model", "em.Averaged()"):
        jax.grad(friction)(0.3)
