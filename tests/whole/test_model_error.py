"""`model_error` of histories and of what rolls: 0 where the model is exact, NaN with its
reason where no bound is established.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.results.base import Result

RUBBER = em.Prony(1e6, [2e6], [1e-2])
NEARLY = em.Prony(1e6, [2e6], [1e-2], poisson=0.45)
DIRECT = em.Foundation(1e9, [2e9], [1e-2], per_area=True)
HALF = em.Foundation(4e6, [8e6], [1e-2])
G_STAR = em.half_space(RUBBER, tangential=True)
BALL, ROLL = em.Paraboloid(0.01), em.Cylinder(0.01, 0.1)
LINE = em.RoughLine(np.arange(32) * 1e-5, 1e-6 * np.cos(np.arange(32) * np.pi / 8))
TIME = np.linspace(0.0, 0.01, 5)


def indent(material, shape, **more):
    return em.indent(material, shape, time=TIME, load=200 * TIME, **more)


def impact(material, shape, **more):
    return em.impact(material, shape, mass=0.01, velocity=0.1, **more)


def slide(material, shape):
    return em.slide(
        material, shape, time=TIME, position=0.01 * TIME, load=1.0, rtol=1e-1
    )


def drive(material, shape):
    return em.drive(
        material, shape, time=TIME, position=0.01 * TIME, load=1.0, rtol=1e-1
    )


def shear(material, shape, **more):
    return em.shear(
        material,
        shape,
        time=TIME,
        displacement=1e-3 * TIME,
        friction=0.5,
        load=1.0,
        **more,
    )


def traction(material, shape, friction=0.5, **more):
    return em.traction(
        material,
        shape,
        velocity=0.1,
        creepage=0.01,
        friction=friction,
        load=5.0,
        **more,
    )


EXACT = {
    "half-space": lambda: indent(RUBBER, BALL),
    "thick and thin layers": lambda: indent(em.layer(RUBBER, 5e-3), BALL),
    "springs that are meant": lambda: indent(DIRECT, ROLL),
    "impact": lambda: impact(RUBBER, em.Sphere(0.01)),
    "impact on a layer": lambda: impact(em.layer(RUBBER, 5e-3), BALL),
    "half-space by its numbers": lambda: indent(HALF, BALL),
    "springs under a ball": lambda: em.friction(DIRECT, BALL, velocity=0.1, load=1.0),
    "friction of springs": lambda: em.friction(DIRECT, ROLL, velocity=0.1, load=1.0),
    "sliding over springs that are meant": lambda: slide(DIRECT, ROLL),
    "shear of springs that are meant": lambda: shear(DIRECT, ROLL, tangential=DIRECT),
    "a brush that is meant": lambda: traction(DIRECT, ROLL, tangential=DIRECT),
}
UNKNOWN = {
    "springs for a layer": (
        lambda: indent(em.springs(NEARLY, 5e-3), BALL),
        "springs stand for a layer",
    ),
    "adhesion": (
        lambda: indent(em.Prony(1e6, [], []), BALL, adhesion=0.05),
        "adhesion acts at the very edge",
    ),
    "impact on springs": (
        lambda: impact(em.springs(NEARLY, 5e-3), BALL),
        "springs stand for a layer",
    ),
    "slide": (lambda: slide(RUBBER, BALL), "bare line"),
    "slide, E* given": (lambda: slide(HALF, BALL), "bare line"),
    "slide, rough": (lambda: slide(RUBBER, LINE), "a rough line is no surface"),
    "drive": (lambda: drive(RUBBER, BALL), "bare line"),
    "shear": (lambda: shear(RUBBER, BALL), "whose size changes"),
    "shear, compressible": (lambda: shear(NEARLY, BALL), "influence each other"),
    "shear, a cone": (lambda: shear(RUBBER, em.Cone(0.1)), "no body but a ball"),
    "traction": (lambda: traction(RUBBER, BALL), "elements side by side"),
    "traction, springs": (
        lambda: traction(
            em.springs(NEARLY, 5e-3),
            ROLL,
            tangential=em.springs(NEARLY, 5e-3, tangential=True),
        ),
        "springs stand for a layer",
    ),
    "traction, E* given": (
        lambda: traction(HALF, BALL, tangential=HALF),
        "elements side by side",
    ),
    "shear, E* given": (lambda: shear(HALF, BALL, tangential=G_STAR), "size changes"),
    "friction, no unit": (
        lambda: em.friction(HALF, ROLL, velocity=0.1, load=1.0),
        "per area [Pa/m] under a cylinder",
    ),
    "rolling, no unit": (
        lambda: em.rolling(HALF, ROLL, velocity=0.1, load=1.0),
        "per area [Pa/m] under a cylinder",
    ),
    "slide, no unit": (lambda: slide(HALF, ROLL), "per area [Pa/m]"),
    "indent, no unit": (lambda: indent(HALF, ROLL), "per area [Pa/m]"),
    "impact, no unit": (lambda: impact(HALF, ROLL), "per area [Pa/m]"),
    "traction, layer": (
        lambda: traction(em.layer(RUBBER, 5e-3), ROLL),
        "elements side by side",
    ),
    "traction, a law": (
        lambda: traction(
            em.Prony(1e6, [], []),
            BALL,
            friction=em.friction(RUBBER, BALL, velocity=[1e-5, 10.0], load=5.0).law(),
        ),
        "friction of one sliding velocity",
    ),
    "traction, Carter": (
        lambda: traction(em.Prony(1e6, [], []), ROLL),
        "ends of the cylinder",
    ),
}


@pytest.mark.parametrize("name", EXACT)
def test_exact(name):
    found = EXACT[name]()
    assert found.converged.all()
    np.testing.assert_array_equal(found.model_error, np.zeros(found.converged.shape))


@pytest.mark.parametrize("name", UNKNOWN)
def test_not_known_and_why(name):
    call, reason = UNKNOWN[name]
    found = call()
    assert found.converged.any()
    assert found.model_error.shape == found.converged.shape
    assert np.isnan(found.model_error).all()
    (doubt,) = [each for each in found.doubts if each.kind == "no prediction"]
    assert reason in doubt.says
    np.testing.assert_array_equal(doubt.points, found.converged)
    assert reason in found.summary()
    assert np.isnan(found.to_dict()["model_error"]).all()


SOFT = em.Prony(
    1e6, [2e6], [1e-2], softening=em.Softening([1e-3, 0.1], [1.0, 0.5], [1.0, 0.6])
)
NEARLY_SOFT = em.Prony(1e6, [2e6], [1e-2], poisson=0.45, softening=SOFT.softening)
LINEAR = {
    "half-space": lambda: indent(SOFT, BALL),
    "layer": lambda: indent(em.layer(SOFT, 5e-3), BALL),
    "compressible layer": lambda: indent(em.layer(SOFT, 5e-3, bonded=False), BALL),
    "springs": lambda: indent(em.springs(NEARLY_SOFT, 5e-3), BALL),
    "adhesion": lambda: indent(SOFT, BALL, adhesion=em.Adhesion(0.05, cutoff=1e-7)),
    "impact": lambda: impact(SOFT, em.Sphere(0.01)),
    "slide": lambda: slide(SOFT, BALL),
    "slide, rough": lambda: slide(SOFT, LINE),
    "drive": lambda: drive(SOFT, BALL),
    "shear": lambda: shear(SOFT, BALL),
    "traction": lambda: traction(SOFT, BALL),
}


@pytest.mark.parametrize("name", LINEAR)
def test_a_history_leaves_a_softening_out_and_warns(name):
    with pytest.warns(em.ModelWarning, match="softening of the rubber"):
        found = LINEAR[name]()
    assert np.isnan(found.model_error).all()
    assert any("softening" in doubt.says for doubt in found.doubts)


@pytest.mark.parametrize("verb", [em.friction, em.rolling])
def test_numbers_of_a_half_space_have_its_bound(verb):
    found = verb(HALF, BALL, velocity=[0.1, 1.0], load=5.0, model="line")
    rubber = verb(RUBBER, BALL, velocity=[0.1, 1.0], load=5.0, model="line")
    three = verb(RUBBER, BALL, velocity=[0.1, 1.0], load=5.0)
    name = "mu" if verb is em.friction else "coefficient"
    off = getattr(found, name) - getattr(three, name)
    assert (off > 0).all()
    assert (off < found.model_error + three.model_error).all()
    np.testing.assert_allclose(found.model_error, rubber.model_error, rtol=1e-9)
    assert {doubt.kind for doubt in found.doubts} == {"bound"}


def test_a_rough_line_is_no_surface():
    found = em.friction(RUBBER, LINE, velocity=[0.01, 1.0], load=1.0)
    assert found.converged.all()
    assert np.isnan(found.model_error).all()
    assert "no prediction" in {doubt.kind for doubt in found.doubts}


def test_materials_side_by_side_have_their_own():
    both = indent([RUBBER, em.springs(NEARLY, 5e-3)], BALL)
    assert (both.model_error[0] == 0).all()
    assert np.isnan(both.model_error[1]).all()


def test_a_belt_has_that_of_its_rolls_and_a_warm_body_none():
    springs = em.Idlers(
        em.springs(NEARLY, 5e-3), ROLL, spacing=1.0, shares=(0.2, 0.6, 0.2)
    )
    found = em.conveyor(springs, springs, velocity=1.0, belt=1.0, goods=3.0)
    sums = 0.0
    for share in (0.2, 0.6, 0.2):
        for weight in (4 * 9.81, 9.81):
            roll = em.rolling(springs.cover, ROLL, velocity=1.0, load=share * weight)
            sums += float(np.asarray(roll.model_error) * roll.normal_force)
    assert sums > 0
    np.testing.assert_allclose(found.model_error, sums / (5 * 9.81), rtol=1e-9)
    thermal = em.Prony(1e6, [2e6], [1e-2], shift=em.WLF(8.9, 101.6, 293.15))
    warm = em.heat_build_up(
        thermal, em.Sphere(0.02), velocity=1.0, load=5.0, ambient=293.15,
        conductance=0.05, hottest=350.0, rtol=1e-3,
    )  # fmt: skip
    assert np.isfinite(warm.temperature).all()
    assert np.isnan(warm.model_error).all()


def test_every_result_says_how_far_its_model_may_be_off():
    def below(kind):
        for child in kind.__subclasses__():
            yield child
            yield from below(child)

    for name in em.__all__:
        getattr(em, name)  # is imported when it is first asked for
    kinds = [kind for kind in below(Result) if kind.__module__.startswith("elastomdr")]
    assert len(kinds) > 20
    lacking = [k.__name__ for k in kinds if "model_error" not in k.__dataclass_fields__]
    assert not lacking
