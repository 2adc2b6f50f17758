"""One rough contact: friction at a crawl, break-out and leak have the same real contact,
a pressed line has the gap, also of rubber that softens; what a verb leaves out is a
doubt.
"""

import dataclasses

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.seal.roughness import pressed
from elastomdr.surface.spectrum import rough_map

TIMES = np.geomspace(1e-8, 10.0, 10)
SOFTENING = em.Softening(
    [1e-3, 1e-2, 0.1, 1.0], [1.0, 0.8, 0.5, 0.3], [1, 1.05, 0.7, 0.4]
)
KINDS = ("elastic", "tread", "softens")
ROAD = em.SelfAffine(0.8, rms_slope=0.4, q_low=1e3, q_high=3e4)


def rubber(kind, modulus=1e6):
    if kind == "elastic":
        return em.Prony(modulus, [], [])
    softening = SOFTENING if kind == "softens" else None
    moduli = modulus * np.geomspace(30.0, 0.3, 10)
    return em.Prony(modulus, moduli, TIMES, softening=softening)


@pytest.mark.parametrize("kind", KINDS)
def test_real_contact_is_the_same_in_every_verb(kind):
    """Ten scenes of each rubber, from 2 % to 80 % of contact."""
    draw = np.random.default_rng(KINDS.index(kind))
    for _ in range(10):
        modulus, slope = 10 ** draw.uniform(5.7, 7), draw.uniform(0.1, 1.0)
        material = rubber(kind, modulus)
        surface = em.SelfAffine(
            draw.uniform(0.5, 1.0), rms_slope=slope, q_low=1e3,
            q_high=1e3 * 10 ** draw.uniform(1.2, 3),
        )  # fmt: skip
        pressure = 4 * modulus * slope * 10 ** draw.uniform(-2.3, -0.4)
        crawls = em.friction(material, surface, velocity=1e-14, pressure=pressure)
        rests = em.break_out(material, surface, pressure=pressure, boundary_shear=1e4)
        leaks = em.leak(
            material, surface, pressure=pressure, pressure_drop=1e-6 * pressure,
            viscosity=1e-3, length=1e-3,
        )  # fmt: skip
        assert rests.area_ratio == pytest.approx(float(crawls.area_ratio), rel=1e-6)
        assert leaks.area_ratio == pytest.approx(float(rests.area_ratio), rel=2e-4)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", ["elastic", "softens"])
@pytest.mark.parametrize("lay", [False, True])
def test_lay_skewness_and_softening_are_in_every_contact(kind, lay):
    """Of a measured surface, worn and ground: friction of an elastic body in any
    direction has the contact and the bound of break-out; leak has that of Gaussian
    heights of this spectrum and lay, which its bound covers.
    """
    road = em.SelfAffine(0.8, rms_slope=0.4, q_low=1e3, q_high=1e4)
    heights, side = rough_map(road, 2, periods=4, points=160)
    worn = np.minimum(heights, 0.7 * heights.std())
    worn = np.repeat(worn, 2, axis=0)[:160] if lay else worn
    surface = em.read_surface(worn, pixel_size=side / 160)
    gaussian = dataclasses.replace(surface, tops=None)
    assert (surface.lay is not None) == lay
    assert surface.skewness < -0.5
    softening = SOFTENING if kind == "softens" else None
    solid = em.Prony(1e6, [], [], softening=softening)
    shear = em.AdhesiveShear(1e4, 1.0, 0.0)
    rests = em.break_out(solid, surface, pressure=1e5, boundary_shear=1e4)
    for direction in (None, 0.0, np.pi / 2):
        slides = em.friction(
            solid, surface, velocity=1.0, pressure=1e5, adhesion=shear,
            direction=direction,
        )  # fmt: skip
        assert slides.area_ratio == pytest.approx(float(rests.area_ratio), rel=1e-6)
        bound = slides.model_error / slides.adhesion
        assert bound == pytest.approx(float(rests.model_error / rests.mu), rel=1e-2)
    leaks, rests = (
        call(solid, gaussian, pressure=1e5, **given)
        for call, given in (
            (em.leak, {"pressure_drop": 1.0, "viscosity": 1e-3, "length": 1e-3}),
            (em.break_out, {"boundary_shear": 1e4}),
        )
    )
    assert leaks.area_ratio == pytest.approx(float(rests.area_ratio), rel=2e-4)


def test_softening_makes_more_contact_and_a_wider_bound():
    """Contact of rubber that is softer by up to f; its strain is known within a factor."""
    scene = {"pressure": [5e4, 3e5], "boundary_shear": 1e4}
    soft = em.break_out(rubber("softens"), ROAD, **scene)
    hard = em.break_out(rubber("tread"), ROAD, **scene)
    more = soft.area_ratio / hard.area_ratio
    assert (more > 1.2).all()
    assert (more < 1 / 0.3).all()
    assert (soft.model_error / soft.mu > hard.model_error / hard.mu + 0.02).all()
    leaks = {"pressure": 5e4, "pressure_drop": 1e3, "viscosity": 1e-3, "length": 1e-3}
    wet, stiff = (em.leak(rubber(k), ROAD, **leaks) for k in ("softens", "tread"))
    assert wet.rate < 0.7 * stiff.rate
    assert wet.mean_gap < stiff.mean_gap
    assert wet.model_error > stiff.model_error


def test_a_softening_that_is_the_same_at_all_strains_is_another_modulus():
    level = em.Softening([1e-9, 1.0], [0.5, 0.5], [1.0, 1.0])
    soft = dataclasses.replace(rubber("elastic"), softening=level)
    scene = {"pressure": 1e5, "pressure_drop": 5e4, "viscosity": 1e-3, "length": 1e-3}
    found = em.leak(soft, ROAD, **scene)
    half = em.leak(rubber("elastic", 0.5e6), ROAD, **scene)
    for field in ("rate", "mean_gap", "critical_gap", "area_ratio"):
        assert getattr(found, field) == pytest.approx(float(getattr(half, field)), 1e-6)
    for motion in ({}, {"velocity": 1.0}):
        pressed, other = (
            em.press(each, ROAD, pressure=1e5, model=em.Line(seeds=2), **motion)
            for each in (soft, rubber("elastic", 0.5e6))
        )
        for field in ("separation", "stiffness", "conductance"):
            expected = pytest.approx(float(getattr(other, field)), 1e-9)
            assert getattr(pressed, field) == expected


def test_derivatives_and_jit_of_rubber_that_softens():
    def flow(pressure):
        return em.leak(
            rubber("softens"), ROAD, pressure=pressure, pressure_drop=1e3,
            viscosity=1e-3, length=1e-3,
        ).rate  # fmt: skip

    def start(pressure):
        return em.break_out(
            rubber("softens"), ROAD, pressure=pressure, boundary_shear=1e4
        ).mu

    def stiffness(pressure):
        model = em.Line(seeds=2, periods=4)
        return em.press(
            rubber("softens"), ROAD, pressure=pressure, model=model
        ).stiffness

    with jax.enable_x64(True):
        value, slope = jax.jit(jax.value_and_grad(stiffness))(1e5)
        assert value == pytest.approx(float(stiffness(1e5)), rel=1e-12)
        change = float(stiffness(1e5 + 0.1) - stiffness(1e5 - 0.1)) / 0.2
        assert float(slope) == pytest.approx(change, rel=1e-3)
        for verb in (flow, start):
            value, slope = jax.jit(jax.value_and_grad(verb))(1e5)
            assert value == pytest.approx(float(verb(1e5)), rel=1e-12)
            change = float(verb(1.001e5) - verb(0.999e5)) / 200
            assert float(slope) == pytest.approx(change, rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_film_has_the_gaps_of_the_leak(kind):
    """The load that asperities carry at a mean gap, up to contacts of 80 %."""
    material, pressure = rubber(kind), np.geomspace(3e4, 3e5, 4)
    gap = em.leak(
        material,
        ROAD,
        pressure=pressure,
        pressure_drop=1.0,
        viscosity=1e-3,
        length=1e-3,
    ).mean_gap
    shared = pressed(material, ROAD, "maps")
    carried, slope = shared.pressure(np.asarray(gap), shared.modulus)
    np.testing.assert_allclose(carried, pressure, rtol=1e-2)
    ahead, behind = (
        shared.pressure(gap * x, shared.modulus)[0] for x in (1.001, 0.999)
    )
    np.testing.assert_allclose(slope, (ahead - behind) / (0.002 * gap), rtol=1e-4)


def doubted(result):
    return [d for d in result.doubts if "softening" in d.says]


@pytest.mark.parametrize("kind", KINDS)
def test_a_pressed_line_has_the_gap_of_the_leak(kind):
    """Up to contacts of 80 %, also of rubber that softens, whose gap is a tenth there."""
    road = em.SelfAffine(0.8, rms_slope=0.4, q_low=1e3, q_high=1e4)
    pressure = np.geomspace(2e4, 4e5 if kind == "softens" else 8e5, 4)
    leaks = em.leak(
        rubber(kind), road, pressure=pressure, pressure_drop=1.0, viscosity=1e-3,
        length=1e-3,
    )  # fmt: skip
    assert leaks.area_ratio[-1] > 0.7
    found = em.press(rubber(kind), road, pressure=pressure)
    np.testing.assert_allclose(found.separation, leaks.mean_gap, rtol=0.15)
    assert not doubted(found)
    assert np.isnan(found.model_error[0]) == (kind == "softens")
    assert np.isnan(found.conductance_low[0]) == (kind == "softens")
    crawls = em.press(rubber(kind), road, pressure=pressure[0], velocity=1e-14)
    for field in ("separation", "stiffness"):
        assert getattr(crawls, field) == pytest.approx(getattr(found, field)[0], 5e-3)


def test_what_leaves_softening_out_says_so():
    """A line of heights and maps are linear: no bound, and a doubt."""
    line = em.RoughLine(np.linspace(0, 1, 8), [0, 1, 0, 2, 1, 0, 3, 1])
    wide = em.Line(equivalent_length=1.0)
    pressed = em.press(rubber("softens"), line, pressure=1e5, model=wide)
    assert np.isnan(pressed.model_error)
    assert doubted(pressed)
    assert not doubted(em.press(rubber("tread"), line, pressure=1e5, model=wide))
    short = em.SelfAffine(0.8, rms_slope=0.4, q_low=1e3, q_high=4e3)
    model = em.HalfSpace(cells=32, seeds=2)
    leaks = em.leak(
        rubber("softens"), short, pressure=1e5, pressure_drop=1e4, viscosity=1e-3,
        length=1e-3, model=model,
    )  # fmt: skip
    assert np.isnan(leaks.model_error)
    assert doubted(leaks)


def test_a_measured_surface_has_no_bound_of_its_conductance():
    """Lines were compared with maps of Gaussian heights, without a lay."""
    road = em.SelfAffine(0.8, rms_slope=0.4, q_low=1e3, q_high=1e4)
    heights, side = rough_map(road, 1, periods=3, points=128)
    worn = np.minimum(heights, 0.3 * heights.std())
    with pytest.warns(UserWarning, match="skewness"):
        surface = em.read_surface(worn, pixel_size=side / 128)
    material = rubber("elastic")
    bound = em.press(material, surface, pressure=3e4).model_error
    assert np.isnan(bound)
    assert np.isfinite(em.press(material, road, pressure=3e4).model_error)
