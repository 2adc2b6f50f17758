"""Every refusal names the argument and what is accepted; nothing that has no meaning
gets a number.
"""

import jax
import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

SOLID = em.Foundation(1e6, [1e6], [1e-3])
SPHERE = em.Sphere(5e-3)
WARM = em.Prony(1e5, [1e6], [1e-3], shift=em.WLF(8.86, 101.6, 293.15))

CASES = {
    "negative times": (lambda: em.Prony(1.0, [1.0], [-1.0]), "times must be positive"),
    "masked moduli": (
        lambda: em.Prony(1.0, np.ma.masked_invalid([1.0, np.nan]), [1.0, 2.0]),
        "moduli must be without masked entries",
    ),
    "reference in Celsius": (
        lambda: em.WLF(8.86, 101.6, 20.0),
        "reference must be.*in kelvin.*20 degC is 293.15 K",
    ),
    "vertical in Celsius": (
        lambda: em.EntropicVertical(293.15).b(25.0),
        "temperature must be.*25 degC is 298.15 K",
    ),
    "NaN moduli": (
        lambda: em.Prony(1.0, [np.nan], [1.0]),
        "moduli must be zero or positive.*nan",
    ),
    "negative modulus": (
        lambda: em.Foundation(1.0, [-1.0], [1.0]),
        "moduli must be zero or positive",
    ),
    "lengths": (
        lambda: em.Prony(1.0, [1.0], [1.0, 2.0]),
        "times must be a list of .* as long as moduli",
    ),
    "nothing carries": (lambda: em.Prony(0.0, [], []), "equilibrium must be above 0"),
    "text": (lambda: em.Prony("soft", [1.0], [1.0]), "equilibrium must be a number"),
    "poisson": (
        lambda: em.Prony(1.0, [], [], poisson=0.6),
        "poisson must be above -1 and at most 0.5, got 0.6",
    ),
    "poisson below": (lambda: em.Prony(1.0, [], [], poisson=-1.0), "poisson"),
    "poisson and bulk": (
        lambda: em.Prony(1.0, [], [], poisson=0.4, bulk=1e9),
        "bulk must be left out",
    ),
    "bulk below a ninth": (
        lambda: em.Prony(1e6, [1e9], [1.0], kind="tensile", bulk=1e8),
        "ninth",
    ),
    "kind": (lambda: em.Prony(1.0, [], [], kind="bulk"), "'shear' or 'tensile'"),
    "name": (lambda: em.Prony(1.0, [], [], name=3), "name must be a text, got 3"),
    "traced exponent": (
        lambda: jax.grad(lambda n: em.PowerLaw(n, 1.0).profile_1d(1.0))(1.5),
        "exponent must be a plain number",
    ),
    "profile curve": (
        lambda: em.Profile([0, 1, 2, 3], [0, 1, 4, 9], curve="linear"),
        "'spline' or 'monotone'",
    ),
    "shift": (lambda: em.Prony(1.0, [], [], shift=0.5), "shift must be a WLF"),
    "shift table": (
        lambda: em.ShiftTable([300.0, 290.0], [0.0, 1.0]),
        "temperature must be ascending",
    ),
    "outside the table": (
        lambda: em.ShiftTable([290.0, 300.0], [1.0, 0.0]).a(310.0),
        "within the shift table",
    ),
    "WLF pole": (
        lambda: em.WLF(8.86, 101.6, 293.15).a(190.0),
        "above the WLF pole at 191.55 K.*got 190",
    ),
    "close above the WLF pole": (
        lambda: em.friction(
            em.StandardSolid(1e6, 1e6, 1e-3, shift=em.WLF(8.86, 101.6, 293.15)),
            em.Sphere(5e-3),
            velocity=1.0,
            load=1.0,
            temperature=194.0,
        ),
        "temperature must be such that the velocity times a_T.*got 194",
    ),
    "no velocity": (
        lambda: em.friction(
            em.StandardSolid(1e6, 1e6, 1e-3), em.Sphere(5e-3), velocity=[], load=1.0
        ),
        "velocity must be a number, or one or more",
    ),
    "time before the step": (
        lambda: em.StandardSolid(1e6, 1e6, 1e-3).relaxation([-1.0]),
        "t must be zero or positive",
    ),
    "negative frequency": (
        lambda: em.StandardSolid(1e6, 1e6, 1e-3).storage(-1.0),
        "omega must be zero or positive",
    ),
    "Maxwell modulus": (
        lambda: em.Maxwell(-1.0, 1.0),
        "modulus must be zero or positive",
    ),
    "Maxwell time": (lambda: em.Maxwell(1.0, -1.0), "time must be positive"),
    "VFT pole": (lambda: em.VFT(2000.0, 141.5, 243.15).a(141.0), "above the VFT pole"),
    "radius": (lambda: em.Sphere(-1.0), "radius must be positive"),
    "radius array": (lambda: em.Sphere([1.0, 2.0]), "radius must be a single number"),
    "thickness": (
        lambda: em.springs(em.Prony(1e6, [], [], poisson=0.4), 0.0),
        "thickness must be positive",
    ),
    "bonded incompressible layer": (
        lambda: em.springs(em.Prony(1e6, [], []), 1e-3),
        "poisson must be below 0.5",
    ),
    "profile start": (
        lambda: em.Profile([1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 2.0, 3.0]),
        "r must be 0 for its first",
    ),
    "profile falls": (
        lambda: em.Profile([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 0.5, 3.0]),
        "z must be 1 m or more at r=2",
    ),
    "material": (
        lambda: em.friction("rubber", SPHERE, velocity=1.0, load=1.0),
        "material must be",
    ),
    "shape": (
        lambda: em.friction(SOLID, 5e-3, velocity=1.0, load=1.0),
        "shape must be",
    ),
    "both": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, depth=1e-4),
        "depth must be left out where load is given",
    ),
    "neither": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0),
        "load must be given, or depth",
    ),
    "zero velocity": (
        lambda: em.friction(SOLID, SPHERE, velocity=0.0, load=1.0),
        "velocity must be positive.*got 0",
    ),
    "one bad velocity": (
        lambda: em.friction(SOLID, SPHERE, velocity=[1.0, -2.0], load=1.0),
        "velocity.*got -2",
    ),
    "infinite load": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=np.inf),
        "load must be positive and finite",
    ),
    "zero depth": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, depth=0.0),
        "depth must be positive",
    ),
    "pressure": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, pressure=1e5),
        "pressure must be left out",
    ),
    "no shift law": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, temperature=300.0),
        "temperature must be left out.*no shift law",
    ),
    "below the pole": (
        lambda: em.friction(WARM, SPHERE, velocity=1.0, load=1.0, temperature=150.0),
        "above the WLF pole",
    ),
    "celsius taken for kelvin": (
        lambda: em.friction(WARM, SPHERE, velocity=1.0, load=1.0, temperature=-10.0),
        "temperature must be in kelvin.*got -10: -10 degC is 263.15 K",
    ),
    "broadcast": (
        lambda: em.friction(SOLID, SPHERE, velocity=[1.0, 2.0], load=[1.0, 2.0, 3.0]),
        "load must be of a shape that broadcasts",
    ),
    "model": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, model="lines"),
        "model must be",
    ),
    "rtol": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, rtol=1e-14),
        "rtol must be",
    ),
    "flat punch": (
        lambda: em.friction(SOLID, em.FlatPunch(1e-3), velocity=1.0, load=1.0),
        "FlatPunch.*edge",
    ),
    "sharp tip": (
        lambda: em.friction(SOLID, em.PowerLaw(0.5, 1.0), velocity=1.0, load=1.0),
        "exponent must be 1",
    ),
    "cone rolls": (
        lambda: em.rolling(SOLID, em.Cone(0.1), velocity=1.0, load=1.0),
        "shape must be one that rolls",
    ),
    "cylinder on a half-space": (
        lambda: em.friction(WARM, em.Cylinder(0.1, 1.0), velocity=1.0, depth=1e-4),
        "depth must be left out for a cylinder on a half-space",
    ),
    "beyond the profile": (
        lambda: em.friction(
            SOLID,
            em.Profile([0.0, 1e-3, 2e-3, 3e-3], [0.0, 1e-4, 4e-4, 9e-4]),
            velocity=1.0,
            depth=1.0,
        ),
        "depth must be below",
    ),
    "quantity": (
        lambda: em.plan(SOLID, SPHERE, velocity=1.0, load=1.0, quantity="wear"),
        "quantity must be",
    ),
    "two shift laws": (
        lambda: em.half_space(WARM, em.Prony(1.0, [], [])),
        "other must be of the shift law",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_refused(case):
    call, message = CASES[case]
    with pytest.raises(em.InputError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ValueError)


RUBBER, BALL, TIME = (
    em.StandardSolid(1e6, 4e6, 0.3),
    em.Paraboloid(5e-3),
    np.linspace(0.0, 1.0, 4),
)
ROUGH = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)
LINE = em.RoughLine(1e-5 * np.arange(64), 1e-6 * np.sin(2 * np.pi * np.arange(64) / 64))
TREAD = em.Foundation(5e7, [1e8], [1e-2])
WHEEL = {"slip": 0.005, "friction": 0.8, "tangential": TREAD}
EVERYWHERE = {
    "velocity": (
        lambda v: em.friction(RUBBER, SPHERE, velocity=v, load=1.0),
        lambda v: em.friction(RUBBER, LINE, velocity=v, load=1e3),
        lambda v: em.friction(RUBBER, ROUGH, velocity=v, pressure=1e5),
        lambda v: em.rolling(RUBBER, SPHERE, velocity=v, load=1.0),
        lambda v: em.impact(RUBBER, BALL, mass=0.01, velocity=v),
        lambda v: em.traction(
            TREAD, em.Cylinder(0.3, 0.16), load=4e3, velocity=v, **WHEEL
        ),
    ),
    "load": (
        lambda f: em.friction(RUBBER, SPHERE, velocity=1.0, load=f),
        lambda f: em.friction(RUBBER, LINE, velocity=1.0, load=f),
        lambda f: em.rolling(RUBBER, SPHERE, velocity=1.0, load=f),
        lambda f: em.indent(RUBBER, BALL, time=TIME, load=f),
        lambda f: em.slide(RUBBER, BALL, time=TIME, position=1e-3 * TIME, load=f),
        lambda f: em.drive(RUBBER, BALL, time=TIME, position=1e-3 * TIME, load=f),
        lambda f: em.shear(
            RUBBER, BALL, time=TIME, displacement=1e-5 * TIME, friction=0.5, load=f
        ),
        lambda f: em.traction(
            TREAD, em.Cylinder(0.3, 0.16), load=f, velocity=25.0, **WHEEL
        ),
    ),
    "pressure": (lambda p: em.friction(RUBBER, ROUGH, velocity=1.0, pressure=p),),
    "position": (
        lambda x: em.slide(RUBBER, BALL, time=TIME, position=x * TIME, load=1.0),
        lambda x: em.drive(RUBBER, BALL, time=TIME, position=x * TIME, load=1.0),
    ),
    "displacement": (
        lambda u: em.shear(
            RUBBER, BALL, time=TIME, displacement=u * TIME, friction=0.5, load=1.0
        ),
    ),
    "depth": (
        lambda d: em.friction(RUBBER, SPHERE, velocity=1.0, depth=d),
        lambda d: em.indent(RUBBER, BALL, time=TIME, depth=d * TIME),
    ),
    "mass": (lambda m: em.impact(RUBBER, BALL, mass=m, velocity=1.0),),
}
SIGNED = ("position", "displacement")  # of which a tiny one is rest


@pytest.mark.parametrize("name", EVERYWHERE)
def test_numbers_beyond_what_can_be_computed_are_refused_in_every_verb(name):
    for call in EVERYWHERE[name]:
        for value in (1e300, *(() if name in SIGNED else (1e-300,))):
            if value < 1 and "indent" in call.__code__.co_names and name == "depth":
                continue  # a depth may have either sign, and a tiny one is none
            with pytest.raises(
                em.InputError, match=f"{name} must be .*between -?1e-?100 and 1e100"
            ):
                call(value)


@pytest.mark.parametrize("name", EVERYWHERE)
def test_masked_entries_are_refused_in_every_verb(name):
    values = np.ma.masked_greater(np.array([1.0, 1.0, 1.0, 9.0]), 5.0)
    for call in EVERYWHERE[name]:
        with refused(name, "masked") as caught:
            call(values)
        assert np.ma.count_masked(caught.value.got) == 1


def test_a_history_that_would_need_billions_of_elements_is_refused():
    for verb in (em.slide, em.drive):
        with refused("position", "stages", "em.friction"):
            verb(RUBBER, BALL, time=TIME, position=1e9 * TIME, load=1.0)


def test_an_array_with_an_empty_mask_is_an_array():
    velocity = np.ma.masked_array([0.1, 1.0], mask=[False, False])
    found = em.friction(RUBBER, SPHERE, velocity=velocity, load=1.0, model=em.Line())
    exact = em.friction(RUBBER, SPHERE, velocity=[0.1, 1.0], load=1.0, model=em.Line())
    np.testing.assert_array_equal(found.mu, exact.mu)


@pytest.mark.parametrize("kind", [em.Prony, em.Foundation])
def test_branches_in_any_order_and_of_one_time(kind):
    """Sorted, and those of one time added: the same law, moduli that JAX traces
    included.
    """
    given = kind(1.0, [2.0, 3.0, 0.5, 4.0], [1.0, 1e-3, 1.0, 1e2])
    np.testing.assert_array_equal(given.times, [1e-3, 1.0, 1e2])
    np.testing.assert_array_equal(given.moduli, [3.0, 2.5, 4.0])
    omega = np.geomspace(1e-3, 1e4, 9)
    x = 1j * omega[:, None] * np.array([1.0, 1e-3, 1.0, 1e2])
    exact = 1.0 + (x / (1 + x) * [2.0, 3.0, 0.5, 4.0]).sum(axis=1)
    np.testing.assert_allclose(given.complex_modulus(omega), exact, rtol=1e-13)
    slope = jax.grad(lambda m: kind(1.0, m, [1.0, 1e-3, 1.0, 1e2]).relaxation(1.0))(
        np.array([2.0, 3.0, 0.5, 4.0])
    )
    np.testing.assert_allclose(
        slope, np.exp(-1 / np.array([1.0, 1e-3, 1.0, 1e2])), rtol=1e-6
    )


def test_a_cylinder_far_from_any_passage_keeps_its_limits():
    """Friction was rounding there, of either sign; large loads filled the memory."""
    roll, layer = em.Cylinder(0.05, 0.1), em.layer(RUBBER, 2e-3)
    slow, fast = np.array([1e-90, 1e-14, 1e-10]), np.array([1e10, 1e12])
    for body in (layer, RUBBER):
        mu = em.friction(body, roll, velocity=slow, load=1.0).mu
        np.testing.assert_allclose(mu / mu[-1], slow / slow[-1], rtol=1e-6)
    mu = em.friction(layer, roll, velocity=fast, load=1.0).mu
    assert mu[0] / mu[1] == pytest.approx(100, rel=1e-5)
    fast = em.friction(layer, roll, velocity=1e90, load=1.0)
    assert abs(fast.mu) < fast.error
    with pytest.warns(em.ConvergenceWarning):
        found = em.friction(layer, roll, velocity=1.0, load=[1e30, 1e90])
    assert not found.converged.any()
    assert np.isnan(found.mu).all()


def test_traction_refuses_friction_that_rounding_would_lose():
    for value in (1e-300, 1e300):
        with refused("friction", 1e-12, 1e12):
            em.traction(
                TREAD,
                em.Cylinder(0.3, 0.16),
                load=4e3,
                velocity=25.0,
                **WHEEL | {"friction": value},
            )
