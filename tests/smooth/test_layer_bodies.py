"""Balls, cones and punches on rubber of finite thickness: pressed, struck, sliding."""

import contextlib
import re
import subprocess
import sys

import numpy as np
import pytest

import elastomdr as em
from elastomdr.transient import surface_fields

from ..refused import refused

ELASTIC = em.Prony(0.25, [], [], poisson=0.5)  # E* = 1 Pa
# E* = 1 Pa and branches of 3 and 2 Pa
RUBBER = em.Prony(0.25, [0.75, 0.5], [0.2, 2.0], poisson=0.5)
BALL = em.Paraboloid(1.0)


@pytest.mark.parametrize(
    ("poisson", "expected"),
    [
        (
            0.5,
            [
                1.2806366058124934,
                1.9329343708474207,
                3.6187358489597594,
                9.14945045204435,
            ],
        ),
        (
            0.4,
            [
                1.232253364426284,
                1.7229883760653142,
                2.7937680024313005,
                5.298546880006652,
            ],
        ),
        (
            0.3,
            [
                1.2065582409010307,
                1.624025413213734,
                2.4835246291425834,
                4.353244290302378,
            ],
        ),
    ],
)
def test_stiffness_of_a_punch(poisson, expected):
    """Hayes, Keer, Herrmann and Mockros 1972: over that of a half-space, at a/h = 0.2,
    0.5, 1 and 2.
    """
    solid = em.Prony(0.5 * (1 - poisson), [], [], poisson=poisson)
    for thickness, factor in zip((5.0, 2.0, 1.0, 0.5), expected, strict=True):
        found = em.indent(
            em.layer(solid, thickness),
            em.FlatPunch(1.0),
            time=[0.0, 1.0],
            depth=[0.0, 0.1],
        )
        np.testing.assert_allclose(found.force[-1], 0.2 * factor, rtol=1e-8)


def test_elastic_ball():
    depth = [0.05152127426939153, 0.17406157673238493, 0.5594154855629038]
    found = em.indent(em.layer(ELASTIC, 1.0), BALL, time=[0.0, 1.0, 2.0], depth=depth)
    np.testing.assert_allclose(
        found.force,
        [0.021078326891450304, 0.17981764909293751, 1.8806668991706832],
        rtol=1e-9,
    )
    np.testing.assert_allclose(found.contact_radius, [0.25, 0.5, 1.0], rtol=1e-9)


def test_pressed_and_withdrawn():
    """A triangle of depth: Ting's rule on the elastic layer's curve."""
    time = np.array([0.0, 0.5, 1.0, 1.3, 1.59, 1.6])
    found = em.indent(
        em.layer(RUBBER, 1.0), BALL, time=time, depth=0.5 * (1 - np.abs(1 - time))
    )
    np.testing.assert_allclose(
        found.force[1:4],
        [1.5537335604875113, 5.467137912905926, 0.8999993277958265],
        rtol=1e-8,
    )
    np.testing.assert_allclose(found.contact_radius[3], 0.6376202282125522, rtol=1e-8)
    assert found.contact_radius[4] > 0
    assert found.contact_radius[5] == 0
    balance = found.work - found.stored - found.dissipated
    np.testing.assert_allclose(balance, 0.0, atol=1e-6 * found.work.max())


def test_creep_follows_the_elastic_curve():
    """Under a load that is kept, P_el(a(t)) = P J(t)."""
    cover, time = em.layer(RUBBER, 1.0), np.array([0.0, 0.1, 1.0, 10.0])
    found = em.indent(cover, BALL, time=time, load=np.full(4, 0.1))
    elastic = em.indent(em.layer(ELASTIC, 1.0), BALL, time=time + 1, depth=found.depth)
    compliance = em.half_space(RUBBER).creep_compliance(time)
    np.testing.assert_allclose(elastic.force, 0.1 * compliance, rtol=1e-9)


def test_limits():
    """Thick: a half-space, off by a/h. Thin and compressible: springs, off by about
    h/a.
    """
    ball, half = (
        em.Paraboloid(1.0),
        em.indent(RUBBER, BALL, time=[0.0, 1.0], depth=[0.0, 0.01]).force[-1],
    )
    off = [
        em.indent(em.layer(RUBBER, h), ball, time=[0.0, 1.0], depth=[0.0, 0.01]).force[
            -1
        ]
        / half
        - 1
        for h in (10.0, 100.0)
    ]
    assert 0.01 < off[0] < 0.02
    assert 8 < off[0] / off[1] < 12
    soft = em.Prony(0.35, [], [], poisson=0.3)
    off = []
    for h in (0.1, 0.05):
        forces = [make(soft, h) for make in (em.layer, em.springs)]
        found = [
            em.indent(f, em.FlatPunch(1.0), time=[0.0, 1.0], depth=[0.0, 0.01]).force[
                -1
            ]
            for f in forces
        ]
        off.append(found[0] / found[1] - 1)
    assert 0 < off[1] < off[0] < 0.2
    assert 1.7 < off[0] / off[1] < 2.3


def test_surface(monkeypatch):
    made, surface_at = [], surface_fields.surface_at

    def once(*given):
        """The surface of the one instant that is asked for, not solved twice."""
        made.extend([] if made else [surface_at(*given)])
        return made[0]

    monkeypatch.setattr(surface_fields, "surface_at", once)
    found = em.indent(
        em.layer(RUBBER, 1.0), BALL, time=[0.0, 0.5, 1.0], depth=[0.0, 0.15, 0.3]
    )
    a = found.contact_radius[-1]
    places = np.array([0.3, 0.8, 1.5]) * a
    moved = found.displacement(places, 1.0)
    np.testing.assert_allclose(moved[:2], 0.3 - places[:2] ** 2 / 2, rtol=1e-5)
    # incompressible rubber rises beside the contact
    assert moved[2] < 0
    node, weight = np.polynomial.legendre.leggauss(16)
    angle = np.pi / 4 * (1 + node)
    r = a * np.sin(angle)
    *pressure, beside = found.pressure(np.append(r, 1.01 * a), 1.0)
    force = np.sum(np.pi / 4 * weight * a * np.cos(angle) * 2 * np.pi * r * pressure)
    np.testing.assert_allclose(force, found.force[-1], rtol=1e-4)
    assert beside == 0


def test_impact():
    """Its motion obeys m d'' = -F, F of `em.indent` under the same depth; a thick layer
    is a half-space.
    """
    drop = {"mass": 1.0, "velocity": 0.3, "rtol": 1e-3}
    found = em.impact(em.layer(RUBBER, 1.0), BALL, **drop)
    assert found.converged
    assert 0 < found.restitution < 1
    work = 0.5 * 0.3**2 * (1 - found.restitution**2)
    np.testing.assert_allclose(found.lost, work, rtol=1e-12)
    thick = em.impact(em.layer(RUBBER, 1e4), BALL, **drop)
    half = em.impact(RUBBER, BALL, **drop)
    np.testing.assert_allclose(thick.restitution, half.restitution, rtol=1e-4)
    assert found.duration < half.duration  # stiffer


def _cover(moduli, times):
    return em.layer(em.Prony(0.25, [m / 4 for m in moduli], times, poisson=0.5), 1.0)


BROAD = _cover([20.0, 15.0, 10.0, 4.0], [0.003, 0.05, 0.6, 6.0])
SLIDING = [
    (
        _cover([9.0], [1.0]),
        0.25,
        0.17981764909293751,
        0.09810408262992856,
        0.12295069766372348,
        0.1027713688389278,
    ),
    (
        _cover([9.0], [1.0]),
        1.0,
        27.71328985855635,
        0.2958382585139159,
        0.37091977424139444,
        0.31191151470850575,
    ),
    (
        BROAD,
        0.1,
        1.8806668991706832,
        0.2479132833539718,
        0.3677400553100382,
        0.2563350055926387,
    ),
]


# one contact is wider than the ball: what is compared is linear
@pytest.mark.filterwarnings("ignore:.*beyond the linear theory:elastomdr.ModelWarning")
@pytest.mark.parametrize(
    ("cover", "velocity", "load", "solid", "line", "average"), SLIDING
)
def test_sliding_ball(cover, velocity, load, solid, line, average):
    """Line and average by collocation, three dimensions by 128 x 128 cells."""
    given = {"velocity": velocity, "load": load, "rtol": 1e-5}
    bare = em.friction(cover, BALL, model=em.Line(), **given)
    np.testing.assert_allclose(bare.mu, line, rtol=1e-5)
    mean = em.friction(cover, BALL, model=em.Averaged(corrected=False), **given)
    np.testing.assert_allclose(mean.mu, average, rtol=1e-5)
    best = em.friction(cover, BALL, **given)
    assert abs(best.mu - solid) <= best.model_error
    if velocity == 1.0:
        assert em.rolling(cover, BALL, **given).coefficient == best.mu


def test_cells_on_a_layer():
    cover, velocity, load, solid, *_ = SLIDING[0]
    found = em.friction(
        cover, BALL, velocity=velocity, load=load, model=em.HalfSpace(cells=64)
    )
    np.testing.assert_allclose(found.mu, solid, rtol=3e-4)
    np.testing.assert_allclose(found.depth, 0.07583435845866082, rtol=3e-4)


def test_sliding_thick_layer_is_a_half_space():
    rubber = SLIDING[2][0].material
    for shape in (BALL, em.Cone(0.2), em.PowerLaw(3.0, 1.0)):
        given = {"velocity": [0.01, 1.0], "load": 1e-3, "rtol": 1e-4}
        layer = em.friction(
            em.layer(rubber, 1e3), shape, model=em.Averaged(corrected=False), **given
        )
        half = em.friction(rubber, shape, model=em.Averaged(corrected=False), **given)
        np.testing.assert_allclose(layer.mu, half.mu, rtol=5e-4)


def test_many_loads_and_depths():
    cover = SLIDING[0][0]
    loads = np.array([0.1, 0.5])[:, None]
    curve = em.friction(cover, BALL, velocity=[0.1, 1.0], load=loads, rtol=1e-3)
    again = em.friction(cover, BALL, velocity=[0.1, 1.0], depth=curve.depth, rtol=1e-3)
    np.testing.assert_allclose(
        again.normal_force, np.broadcast_to(loads, (2, 2)), rtol=5e-3
    )
    np.testing.assert_allclose(again.mu, curve.mu, rtol=5e-3)


def test_finite_bulk_modulus():
    """A large bulk modulus changes little; a history refuses one that shows."""
    shear = {"equilibrium": 0.25, "moduli": [2.25], "times": [1.0]}
    given = {"velocity": 0.5, "load": 1.0, "rtol": 1e-4}
    stiff = em.friction(
        em.layer(em.Prony(**shear, poisson=None, bulk=2e4), 1.0), BALL, **given
    )
    solid = em.friction(em.layer(em.Prony(**shear, poisson=0.5), 1.0), BALL, **given)
    np.testing.assert_allclose(stiff.mu, solid.mu, rtol=2e-3)
    soft = em.layer(em.Prony(**shear, poisson=None, bulk=10.0), 1.0)
    with refused("bulk", 10):
        em.indent(soft, BALL, time=[0.0, 1.0], depth=[0.0, 0.4])


def test_bad_input():
    cover = em.layer(RUBBER, 1.0)
    with refused("depth", "thickness", 1.5):
        em.indent(cover, BALL, time=[0.0, 1.0], depth=[0.0, 1.5])
    with refused("depth", "thickness", 1.5):
        em.friction(cover, BALL, velocity=1.0, depth=1.5)
    with refused("adhesion", 0.1):
        em.indent(cover, BALL, time=[0.0, 1.0], depth=[0.0, 0.1], adhesion=0.1)
    with refused("thickness", 0):
        em.layer(RUBBER, 0.0)
    with pytest.warns(em.ConvergenceWarning, match="thick"):
        assert np.isnan(em.friction(cover, BALL, velocity=1.0, load=50.0, rtol=1e-3).mu)
    with pytest.warns(em.ConvergenceWarning, match="carries the load"):
        assert np.isnan(
            em.indent(cover, BALL, time=[0.0, 1.0], load=[0.0, 50.0]).depth[-1]
        )


def test_plain_sliding_loads_no_jax():
    code = (
        "import sys, elastomdr as em; m = em.Prony(0.25, [2.25], [1.0], "
        "poisson=0.5);em.friction(em.layer(m, 1.0), em.Paraboloid(1.0), "
        "velocity=[0.1, 1.0], load=0.5, rtol=1e-3);assert 'jax' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


@pytest.mark.slow
def test_gradients():
    """Of friction in thickness, modulus, radius, load and speed, against
    differences.
    """
    import jax
    import jax.numpy as jnp

    def mu(x):
        thickness, modulus, radius, load, speed = x
        cover = em.layer(
            em.Prony(0.25, jnp.reshape(modulus, (1,)), [1.0], poisson=0.5), thickness
        )
        return em.friction(
            cover,
            em.Paraboloid(radius),
            velocity=speed,
            load=load,
            model=em.Line(),
            rtol=1e-4,
        ).mu

    with jax.enable_x64(True):
        x = jnp.array([1.0, 2.25, 1.0, 0.5, 0.4])
        found = jax.grad(mu)(x)
        each = jax.jit(mu)
        for i in range(5):
            step = 1e-4 * jnp.eye(5)[i]
            slope = (
                8 * (each(x + step) - each(x - step))
                - each(x + 2 * step)
                + each(x - 2 * step)
            ) / 12e-4
            np.testing.assert_allclose(found[i], slope, rtol=1e-6)


_HALF = em.Prony(1e6, [2e6], [0.1])


@pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
@pytest.mark.parametrize("shape", [em.Sphere(0.01), em.Cylinder(0.01, 0.1)])
@pytest.mark.parametrize(
    "body",
    [
        _HALF,
        em.half_space(_HALF),
        em.layer(_HALF, 5e-3),
        em.springs(_HALF, 5e-3, bonded=False),
        em.Foundation(1e6, [2e6], [0.1]),
    ],
    ids=["rubber", "half-space", "layer", "springs", "numbers"],
)
def test_models_that_an_error_lists_are_those_there_are(body, shape):
    def computed(model):
        return em.friction(
            body, shape, velocity=0.1, load=1.0, model=model, rtol=1e-2
        ).mu

    kinds = {
        kind.__name__: kind()
        for kind in (em.Averaged, em.Line, em.Marched, em.Multiscale, em.Persson)
    }
    kinds["HalfSpace"] = em.HalfSpace(cells=16)
    there = set()
    for name, model in kinds.items():
        with contextlib.suppress(em.InputError):
            assert np.isfinite(computed(model))
            there.add(name)
    with pytest.raises(em.InputError) as refusal:
        computed(em.Persson())
    assert refusal.value.argument == "model"
    assert set(re.findall(r"em\.(\w+)\(", str(refusal.value.accepted))) == there
