"""Calls under the caller's own `jax.jit`, where JAX has no 64-bit types: numbers that
are not traced stay numbers.
"""

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.transient.layer_disc import layer_disc

from ..refused import refused

RUBBER, BALL, TIME = (
    em.StandardSolid(1e6, 4e6, 0.3),
    em.Paraboloid(5e-3),
    np.linspace(0, 1, 5),
)
CARCASS, TREAD = em.Foundation(8e7, [], []), em.Foundation(5e7, [1e8, 1e8], [1e-2, 1.0])
WHEEL = {"velocity": 25.0, "slip": 0.005, "friction": 0.8, "tangential": TREAD}
ROAD = em.SelfAffine(0.8, rms_slope=0.4, q_low=1e3, q_high=1e4)
SEAL = {"viscosity": 1e-3, "length": 1e-3}
CALLS = {
    "indent": lambda k: em.indent(RUBBER, BALL, time=TIME, depth=k * 1e-4 * TIME).force,
    "a load on an elastic body": lambda k: (
        em.rolling(em.Prony(1e6, [], []), BALL, velocity=1.0, load=k).depth
    ),
    "traction": lambda k: (
        em.traction(CARCASS, em.Cylinder(0.3, 0.16), load=4e3 * k, **WHEEL).force
    ),
}


@pytest.mark.parametrize("call", CALLS)
def test_jit_gives_the_same(call):
    np.testing.assert_allclose(jax.jit(CALLS[call])(1.0), CALLS[call](1.0), rtol=1e-6)


def test_an_elastic_body_sinks_with_the_load():
    """d of F = (4/3) E* sqrt(R) d^(3/2): its derivative is 2 d/(3 F)."""
    depth = CALLS["a load on an elastic body"]
    np.testing.assert_allclose(jax.grad(depth)(4.0), 2 * depth(4.0) / 12, rtol=1e-6)


def test_a_march_under_jit():
    """Its grid is given there, outside it is chosen: both within the tolerance."""

    def mu(load):
        return em.slide(
            RUBBER,
            BALL,
            time=TIME,
            position=1e-3 * TIME,
            load=load,
            rtol=1e-1,
            elements=256,
        ).mu

    chosen = mu(1.0)
    np.testing.assert_allclose(jax.jit(mu)(1.0), chosen, atol=0.1 * chosen.max())


def test_a_march_under_jit_that_misses_its_tolerance_has_numbers_and_says_so():
    """Elements are given there: what two levels of them give is handed out with its
    error, and not as converged.
    """

    def found(load):
        result = em.slide(
            RUBBER,
            BALL,
            time=TIME,
            position=1e-3 * TIME,
            load=load,
            rtol=1e-6,
            elements=64,
        )
        return result.mu, result.error, result.converged

    mu, error, converged = map(np.asarray, jax.jit(found)(1.0))
    exact = em.slide(
        RUBBER, BALL, time=TIME, position=1e-3 * TIME, load=1.0, rtol=1e-4
    ).mu
    assert not converged[1:].any()
    assert (np.abs(mu - exact) <= error + 1e-4 * exact.max()).all()


SHORT = np.linspace(0, 1, 3)
COARSE = {"rtol": 1e-1, "elements": 64}
VERBS = {
    "indent": lambda k: em.indent(RUBBER, BALL, time=TIME, depth=k * 1e-4 * TIME).force[
        -1
    ],
    "slide": lambda k: em.slide(
        RUBBER, BALL, time=SHORT, position=1e-3 * SHORT, load=k, **COARSE
    ).mu[-1],
    "drive": lambda k: em.drive(
        RUBBER, BALL, time=SHORT, position=1e-3 * SHORT, load=k, **COARSE
    ).mu[-1],
    "leak": lambda k: (
        em.leak(RUBBER, ROAD, pressure=1e5 * k, pressure_drop=1e3, **SEAL).rate
    ),
    "break_out": lambda k: (
        em.break_out(RUBBER, ROAD, pressure=1e5 * k, boundary_shear=1e4).mu
    ),
    "traction": lambda k: (
        em.traction(CARCASS, em.Cylinder(0.3, 0.16), load=4e3 * k, **WHEEL).force
    ),
    "rolling": lambda k: em.rolling(RUBBER, BALL, velocity=1.0, load=k).coefficient,
    "friction": lambda k: (
        em.friction(
            RUBBER, em.Cone(0.1 * k), velocity=0.01, load=1.0, model=em.Line()
        ).mu
    ),
}


@pytest.mark.slow
# what JAX says of the way back
@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
@pytest.mark.parametrize("wide", [False, True], ids=["32-bit types", "64-bit types"])
@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_under_every_transformation(verb, wide):
    """The list of `docs/transient.md`: jit, vmap and grad against the plain call and
    its differences.
    """

    # a new function each time: JAX keeps programs by it, with constants of either width
    def call(k):
        return VERBS[verb](k)

    with jax.enable_x64(wide):
        near = np.array([1.0, 1.001, 0.999])
        # elements are chosen in a plain call
        plain = jax.jit(call) if verb in ("slide", "drive") else call
        exact = [float(plain(k)) for k in near]
        np.testing.assert_allclose(jax.jit(call)(1.0), exact[0], rtol=1e-5)
        np.testing.assert_allclose(jax.vmap(call)(near), exact, rtol=1e-5)
        np.testing.assert_allclose(
            jax.grad(call)(1.0), (exact[1] - exact[2]) / 2e-3, rtol=5e-2
        )


LAYER = em.layer(em.Prony(1e6, [4e6], [0.3]), 2e-3)
ON_LAYER = {
    "friction": lambda k: (
        em.friction(LAYER, BALL, velocity=0.01, load=k, model=em.Line(), rtol=1e-3).mu
    ),
    "rolling": lambda k: (
        em.rolling(
            LAYER, em.Cylinder(5e-3, 0.01), velocity=0.01, load=10 * k, rtol=1e-4
        ).coefficient
    ),
}
STICKY = em.Adhesion(0.05, cutoff=1e-6)
PLACE = np.linspace(0.0, 1e-3, 51)
STROKE = {"velocity_out": 0.2, "velocity_in": 0.1, "stroke": 0.1, "viscosity": 0.1}
NUMBERS = {
    ("impact", "mass"): lambda k: (
        em.impact(RUBBER, BALL, mass=0.01 * k, velocity=1.0).restitution
    ),
    ("shear", "displacement"): lambda k: em.shear(
        RUBBER, BALL, time=SHORT, displacement=1e-5 * k * SHORT, friction=0.5, load=1.0
    ).force[-1],
    ("indent", "depth"): lambda k: em.indent(
        RUBBER, BALL, time=SHORT, depth=1e-4 * k * SHORT, adhesion=STICKY
    ).force[-1],
    ("lubricated", "load"): lambda k: (
        em.lubricated(
            RUBBER, em.Cylinder(0.01, 0.05), velocity=1.0, load=50.0 * k, viscosity=0.1
        ).mu
    ),
    ("reciprocating", "profile"): lambda k: (
        em.reciprocating(
            None, profile=(PLACE, 1e6 * k * np.sin(1e3 * np.pi * PLACE)), **STROKE
        ).net_leak
    ),
    ("half-space", "load"): lambda k: (
        em.friction(
            RUBBER, BALL, velocity=0.01, load=k, model=em.HalfSpace(cells=32)
        ).mu
    ),
    ("dissipation", "load"): lambda k: em.dissipation(
        LAYER, em.Cylinder(5e-3, 0.01), velocity=0.01, load=10 * k
    ).power[0],
}


@pytest.mark.parametrize(("verb", "argument"), NUMBERS)
def test_what_takes_numbers_alone_says_so_and_has_differences(verb, argument):
    call = NUMBERS[verb, argument]
    with jax.enable_x64(True), refused(argument, "jit", "difference of two calls"):
        jax.grad(call)(1.0)
    near, far = (
        (float(call(1 + step)) - float(call(1 - step))) / (2 * step)
        for step in (0.05, 0.1)
    )
    assert near != 0
    assert near == pytest.approx(far, rel=0.1)


def test_lines_under_jax_name_models_that_have_derivatives():
    def call(k, model):
        return em.friction(RUBBER, ROAD, velocity=k, pressure=1e5, model=model).mu

    with jax.enable_x64(True):
        with refused("model", "em.Multiscale()", "em.Persson()"):
            jax.grad(call)(0.1, em.Line())
        for model in (em.Multiscale(), em.Persson()):
            slope = jax.grad(call)(0.1, model)
            near, far = call(0.101, model), call(0.099, model)
            assert slope == pytest.approx((near - far) / 2e-3, rel=0.01)


WAYS = {
    "jit": jax.jit,
    "vmap": lambda call: lambda k: jax.vmap(call)(np.array([1.0, 1.01, 0.99])),
    "grad": jax.grad,
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("verb", ON_LAYER)
def test_layers_are_refused_without_64_bit_types(verb, way):
    with jax.enable_x64(False), pytest.raises(em.InputError, match="jax_enable_x64"):
        WAYS[way](ON_LAYER[verb])(1.0)


@pytest.mark.slow
@pytest.mark.parametrize("verb", ON_LAYER)
def test_layers_under_every_transformation(verb):
    """With 64-bit types: jit, vmap and grad against the plain call and its
    differences.
    """
    exact = [float(ON_LAYER[verb](k)) for k in (1.0, 1.01, 0.99)]
    with jax.enable_x64(True):
        found = {way: WAYS[way](ON_LAYER[verb])(1.0) for way in WAYS}
    np.testing.assert_allclose(found["jit"], exact[0], rtol=1e-3)
    np.testing.assert_allclose(found["vmap"], exact, rtol=1e-3)
    np.testing.assert_allclose(found["grad"], (exact[1] - exact[2]) / 2e-2, rtol=5e-3)


# what JAX says of the way back
@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
def test_gradient_of_an_indentation_without_64_bit_types():
    """F of a paraboloid at E(t) goes as d^(3/2): its derivative by a factor on the
    depth is 1.5 F.
    """

    def call(k):
        return em.indent(RUBBER, BALL, time=SHORT, depth=k * 1e-4 * SHORT).force[-1]

    with jax.enable_x64(False):
        np.testing.assert_allclose(
            jax.jit(jax.grad(call))(1.0), 1.5 * call(1.0), rtol=1e-6
        )


@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
def test_surfaces_are_made_from_traced_numbers_without_64_bit_types():
    """rms height of a self-affine surface goes as its rms slope; heights of a line are
    its own slope.
    """
    with jax.enable_x64(False):
        rms = jax.grad(
            lambda s: em.SelfAffine(0.8, rms_slope=s, q_low=1e3, q_high=1e5).rms_height
        )(0.1)
        x = np.arange(8.0)
        high = jax.jit(lambda k: em.RoughLine(x, k * np.sin(x)).highest)(2.0)
    assert rms == pytest.approx(
        em.SelfAffine(0.8, rms_slope=1.0, q_low=1e3, q_high=1e5).rms_height, rel=1e-6
    )
    assert high == pytest.approx(em.RoughLine(x, 2 * np.sin(x)).highest, rel=1e-6)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
def test_compiled_gradient_under_a_falling_load_without_64_bit_types():
    """JAX transposes under the caller's setting what the call has left to it."""

    def call(radius):
        material = em.Prony(1e6, [1e8, 1e7], [1e-4, 1e-1], poisson=0.4)
        time, load = [0.0, 0.5, 1.0], [0.0, 1.0, 0.5]
        return em.indent(
            material, em.Sphere(radius), time=time, load=load, rtol=1e-3
        ).depth[-1]

    with jax.enable_x64(False):
        slope = jax.jit(jax.grad(call))(0.01)
    assert slope == pytest.approx((call(0.0101) - call(0.0099)) / 2e-4, rel=1e-3)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
def test_compiled_falling_load_is_handed_out_with_its_error():
    """Its steps are fixed under jit and miss the default tolerance: numbers all the
    same, where they were NaN.
    """
    time, load = np.linspace(0, 0.01, 6), np.array([0.0, 5, 10, 5, 2, 8])

    def call(modulus):
        return em.indent(
            em.Prony(1e6, [modulus], [1e-3]), em.Paraboloid(5e-3), time=time, load=load
        )

    got, plain = (
        jax.jit(lambda g: (lambda r: (r.depth, r.error, r.converged))(call(g)))(5e6),
        call(5e6),
    )
    assert not got[2].all()
    assert (
        np.abs(got[0] - plain.depth) <= (got[1] + plain.error) * plain.depth.max()
    ).all()


# of what is traced, one by one
FACTORS = {"equilibrium": 1.0, "moduli": 1.0, "times": 1.0, "size": 1.0, "asked": 1.0}
TRACED = {
    "indent by depth": lambda m, s, k: (
        em.indent(m, _ball(s), time=TIME, depth=k * 1e-4 * TIME).force
    ),
    "indent by load": lambda m, s, k: (
        em.indent(m, _ball(s), time=TIME, load=k * 0.1 * TIME).depth
    ),
    "slide": lambda m, s, k: (
        em.slide(m, _ball(s), time=SHORT, position=1e-3 * SHORT, load=k, **COARSE).mu
    ),
    "drive": lambda m, s, k: (
        em.drive(m, _ball(s), time=SHORT, position=1e-3 * SHORT, load=k, **COARSE).mu
    ),
    "traction": lambda m, s, k: (
        em.traction(
            m, _ball(s), load=k, velocity=1.0, creepage=0.005, friction=0.5
        ).force
    ),
    "rolling": lambda m, s, k: (
        em.rolling(m, _ball(s), velocity=1.0, load=k).coefficient
    ),
    "press": lambda m, s, k: (
        em.press(
            m, _surface(s), pressure=3e3 * k, model=em.Line(seeds=1, samples=256)
        ).stiffness
    ),
    "a profile": lambda m, s, k: (
        em.friction(m, _profile(s), velocity=0.1, load=k, rtol=1e-2).mu
    ),
    "indent on a layer": lambda m, s, k: (
        em.indent(em.layer(m, 2e-3), _ball(s), time=TIME, depth=k * 1e-4 * TIME).force
    ),
}


def _ball(size):
    return em.Paraboloid(5e-3 * size)


def _profile(size):
    r = np.linspace(0, 5e-3, 9)
    return em.Profile(r, 100 * size * r**2)


def _surface(size):
    return em.SelfAffine(0.8, rms_slope=0.3 * size, q_low=1e3, q_high=8e3)


@pytest.mark.parametrize("wide", [False, True], ids=["32-bit types", "64-bit types"])
@pytest.mark.parametrize("verb", TRACED)
def test_any_argument_alone_may_be_traced(verb, wide):
    """What is not traced stays a number: no error of JAX's own, whichever argument it
    is (traced, not compiled).
    """

    def call(name, factor):
        f = FACTORS | {name: factor}
        law = (
            1e6 * f["equilibrium"],
            f["moduli"] * np.array([4e6, 2e6]),
            f["times"] * np.array([0.3, 0.01]),
        )
        return TRACED[verb](em.Prony(*law), f["size"], f["asked"])

    with jax.enable_x64(wide):
        # on a layer each takes seconds, and moduli stand for the law
        for name in ("moduli", "size", "asked") if "layer" in verb else FACTORS:
            found = jax.eval_shape(lambda k, name=name: call(name, k), 1.0)
            assert isinstance(found, jax.ShapeDtypeStruct)


@pytest.mark.slow
def test_gradients_of_a_profile_from_points():
    """By its points and the load: in a compiled program the points are traced, too."""
    law = em.Prony(1e6, [4e6, 2e6], [0.3, 0.01])

    def mu(size, load):
        return em.friction(
            law, _profile(size), velocity=0.1, load=load, model=em.Line(), rtol=1e-6
        ).mu

    with jax.enable_x64(True):
        slopes = jax.grad(mu, argnums=(0, 1))(1.0, 1.0)
    expected = [
        (mu(1.01, 1.0) - mu(0.99, 1.0)) / 0.02,
        (mu(1.0, 1.01) - mu(1.0, 0.99)) / 0.02,
    ]
    np.testing.assert_allclose(slopes, expected, rtol=1e-3)


def test_compiled_gradient_of_a_punch_under_a_load():
    """Its depth is in proportion to the load; marches that are not needed gave NaN
    where they began without load.
    """

    def depth(load):
        return em.indent(
            RUBBER,
            em.FlatPunch(1e-3),
            time=SHORT,
            load=load * np.array([0.0, 1.0, 0.5]),
        ).depth[-1]

    with jax.enable_x64(True):
        np.testing.assert_allclose(
            jax.jit(jax.grad(depth))(0.1), depth(0.1) / 0.1, rtol=1e-9
        )


def _depth_on_layer(thickness):
    return layer_disc(_profile(1.0), thickness, 0.0, True).profile(np.array([1.5e-3]))[
        0
    ]


def test_the_thickness_of_a_layer_under_a_profile_may_be_traced():
    with jax.enable_x64(True):
        assert jax.eval_shape(_depth_on_layer, 2e-3).shape == ()


@pytest.mark.slow
def test_gradient_of_a_profile_on_a_layer_by_its_thickness():
    """The pieces of its rule end at its points in units of the thickness."""
    with jax.enable_x64(True):
        slope = jax.grad(_depth_on_layer)(2e-3)
        near = [float(_depth_on_layer(h)) for h in (2.001e-3, 1.999e-3)]
    np.testing.assert_allclose(slope, (near[0] - near[1]) / 2e-6, rtol=1e-5)


@pytest.mark.parametrize(
    "times", [[0.3, 0.01, 0.05], [0.3, 0.01, 0.3]], ids=["any order", "equal"]
)
def test_traced_times_in_any_order(times):
    """Retardation times interlace sorted relaxation times, and one is lost where two
    are equal.
    """

    def creep(t):
        return em.Prony(1e6, [4e6, 2e6, 3e6], t).creep_compliance(0.3) * 1e6

    with jax.enable_x64(True):
        value, slope = jax.jit(jax.value_and_grad(creep))(np.array(times))
    np.testing.assert_allclose(value, creep(times), rtol=1e-9)
    for i in range(3):
        near = [np.array(times) * (1 + s * 1e-5 * (np.arange(3) == i)) for s in (1, -1)]
        expected = (creep(near[0]) - creep(near[1])) / (2e-5 * times[i])
        np.testing.assert_allclose(slope[i], expected, rtol=1e-5)
