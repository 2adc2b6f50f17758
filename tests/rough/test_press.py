"""em.press: a rough surface under a pressure, against closed forms of one wave, creep,
fast sliding and 3D maps.
"""

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.rough.half_space import solve
from elastomdr.rough.press import least_conductance
from elastomdr.surface.spectrum import rough_map

from ..refused import refused

RUBBER = em.Foundation(1e6, [3e6], [0.1])
SOLID = em.Foundation(1e6, [], [])
SURFACE = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3)
WAVE, AMPLITUDE, LENGTH = 1e3, 1e-5, 1e-3
X = np.arange(256) / 256 * 2 * np.pi / WAVE
LINE = em.RoughLine(X, AMPLITUDE * np.cos(WAVE * X))
WIDE = em.Line(equivalent_length=LENGTH)


def test_one_wave():
    """h = A cos(kx), in contact up to kx = a: p L/E* = (A/pi)(sin a - a cos a), share
    a/pi, depth A (1 - cos a).
    """
    angle = np.linspace(0.2, 3.0, 8)
    p = 1e6 * AMPLITUDE / np.pi * (np.sin(angle) - angle * np.cos(angle)) / LENGTH
    found = em.press(SOLID, LINE, pressure=p, model=WIDE)
    share, depth = angle / np.pi, AMPLITUDE * (1 - np.cos(angle))
    np.testing.assert_allclose(found.approach, depth - p * LENGTH / 1e6, rtol=2e-5)
    np.testing.assert_allclose(
        found.separation, AMPLITUDE - found.approach, rtol=0, atol=1e-8 * AMPLITUDE
    )
    np.testing.assert_allclose(
        found.conductance, 2 / LENGTH * share / (1 - share), rtol=3e-5
    )
    np.testing.assert_allclose(found.stiffness, 1e6 / 2 * found.conductance, rtol=1e-12)
    up, down = (
        em.press(SOLID, LINE, pressure=p * f, model=WIDE).approach
        for f in (1.001, 0.999)
    )
    np.testing.assert_allclose(found.stiffness, 0.002 * p / (up - down), rtol=1e-3)


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_full_contact():
    """Beyond p L = E* A one wave is filled: no gap is left, and the interface has no
    compliance.
    """
    found = em.press(
        SOLID, LINE, pressure=[1.01e6 * AMPLITUDE / LENGTH, 1e6], model=WIDE
    )
    assert (found.separation == 0).all()
    assert np.isinf(found.conductance).all()
    np.testing.assert_allclose(found.approach, AMPLITUDE, rtol=1e-6)
    # The energy of full contact is that of the surface, int p d(approach) = (pi/2) m_2
    # E*.
    p = np.geomspace(1, 1e7, 4000)
    wide = em.press(SOLID, SURFACE, pressure=p, model=em.Line(seeds=[3], samples=16384))
    energy = np.trapezoid(p, wide.approach)
    assert energy == pytest.approx(1e6 * np.pi / 2 * float(SURFACE.moment(2)), rel=2e-3)


def test_stiffness_grows_with_the_pressure_in_light_contact():
    p = 1e6 * 0.3 * np.array([2e-3, 6e-3, 2e-2])
    found = em.press(SOLID, SURFACE, pressure=p)
    over = found.stiffness * SURFACE.rms_height / p  # about 2 to 3 in three dimensions
    assert ((over > 1.8) & (over < 4.5)).all()
    powers = np.diff(np.log(found.stiffness)) / np.diff(np.log(p))
    assert ((powers > 0.75) & (powers < 1.0)).all()


def test_creep_is_the_relaxed_contact_under_more_pressure():
    time = np.array([1e-4, 0.1, 1.0, 50.0])
    crept = em.press(RUBBER, SURFACE, pressure=3e3, time=time)
    factor = np.asarray(RUBBER.creep_compliance(time)) * 1e6
    relaxed = em.press(RUBBER, SURFACE, pressure=3e3 * factor)
    np.testing.assert_allclose(crept.separation, relaxed.separation, rtol=1e-12)
    np.testing.assert_allclose(crept.conductance, relaxed.conductance, rtol=1e-12)
    np.testing.assert_allclose(crept.stiffness * factor, relaxed.stiffness, rtol=1e-12)
    assert crept.conductance[-1] > 2 * crept.conductance[0]


def test_sliding_goes_from_the_relaxed_to_the_glassy_contact():
    few = em.Line(seeds=2, samples=4096)
    found = em.press(RUBBER, SURFACE, pressure=3e3, velocity=[1e-7, 1e5], model=few)
    relaxed = em.press(RUBBER, SURFACE, pressure=3e3, model=few)
    glassy = em.press(em.Foundation(4e6, [], []), SURFACE, pressure=3e3, model=few)
    for end, rest in zip((0, 1), (relaxed, glassy), strict=True):
        assert found.conductance[end] == pytest.approx(
            float(rest.conductance), rel=0.01
        )
        assert found.separation[end] == pytest.approx(float(rest.separation), rel=0.002)
    assert found.stiffness[0] == pytest.approx(float(relaxed.stiffness), rel=0.03)
    assert np.isnan(found.conductance_low).all()


def test_the_bound_holds_for_maps_and_the_line_is_near_them():
    """Stiffness of a map in three dimensions at three loads: above the bound of its own
    peak, near the line.
    """
    spectrum = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=4e3)
    heights, side = rough_map(spectrum, 1, periods=6, points=96)
    for level in (0.01, 0.05, 0.2):
        p = level * 0.3 * 1e6
        gaps = [
            solve(
                lambda w: np.full(np.shape(w), 1e6 + 0j),
                heights,
                (side, side),
                velocity=1.0,
                pressure=p * f,
            ).separation
            for f in (0.95, 1.0, 1.05)
        ]
        stiffness = 0.1 * p / (gaps[0] - gaps[2])
        assert (
            0.5e6 * least_conductance(p / 1e6, heights.max() - heights.mean())
            < stiffness
        )
        line = em.press(SOLID, spectrum, pressure=p)
        assert float(line.stiffness) == pytest.approx(stiffness, rel=0.3)
        assert float(line.separation) == pytest.approx(
            gaps[1], abs=0.2 * spectrum.rms_height
        )
        assert line.conductance / 300 < line.conductance_low < line.conductance


def test_heat_and_current():
    found = em.press(
        SOLID, SURFACE, pressure=3e3, conductivity=[0.2, 0.6], resistivity=1e-3
    )
    assert float(found.thermal) == pytest.approx(
        0.15 * float(found.conductance), rel=1e-12
    )
    assert float(found.electrical) == pytest.approx(
        1e3 * float(found.conductance), rel=1e-12
    )
    assert em.press(SOLID, SURFACE, pressure=3e3).thermal is None


def test_shapes_materials_and_temperature():
    rubber = em.Prony(
        1e6,
        [3e6],
        [0.1],
        shift=em.WLF(8.86, 101.6, 293.15),
        vertical=em.EntropicVertical(293.15),
    )
    p, t = np.array([1e3, 3e3]), np.array([[0.1], [1.0], [10.0]])
    found = em.press([rubber, rubber], SURFACE, pressure=p, time=t, temperature=303.15)
    assert found.conductance.shape == (2, 3, 2)
    a = float(rubber.shift.a(303.15))
    same = em.press(rubber, SURFACE, pressure=p * 293.15 / 303.15, time=t / a)
    np.testing.assert_allclose(found.conductance[0], same.conductance, rtol=1e-10)
    np.testing.assert_allclose(
        found.stiffness[0], same.stiffness * 303.15 / 293.15, rtol=1e-10
    )
    assert "Rough contact" in found.summary()
    found.select(found.materials[0]).plot(show="separation")


def test_gradients():
    """In both modes, by equilibrium modulus, pressure, time and rms slope at once."""
    start = np.array([1e6, 3e3, 0.2, 0.3])

    def logarithms(factor):
        equilibrium, pressure, time, slope = start * factor
        found = em.press(
            em.Foundation(equilibrium, [3e6], [0.1]),
            em.SelfAffine(0.8, rms_slope=slope, q_low=1e3, q_high=8e3),
            pressure=pressure,
            time=time,
            model=em.Line(seeds=2, periods=4, samples=64),
        )
        xp = jax.numpy if isinstance(factor, jax.core.Tracer) else np
        return xp.stack([xp.log(found.separation), xp.log(found.stiffness)])

    along, ones = np.array([1.0, 0.8, -0.5, 0.3]), np.ones(4)
    with jax.enable_x64(True):
        value, slope = jax.jit(lambda x: jax.jvp(logarithms, (x,), (along,)))(ones)
        back = jax.jit(jax.grad(lambda x: logarithms(x) @ np.array([1.0, 0.5])))(ones)
        back, slope = np.asarray(back), np.asarray(slope)
    h = 1e-6 * along
    difference = (logarithms(1 + h) - logarithms(1 - h)) / 2e-6
    np.testing.assert_allclose(value, logarithms(ones), rtol=1e-7)
    np.testing.assert_allclose(slope, difference, rtol=2e-3)
    np.testing.assert_allclose(back @ along, slope @ [1.0, 0.5], rtol=1e-7)
    assert (np.abs(back) > 0.05).all()


SPRINGS = em.springs(em.Prony(1e6, [], [], poisson=0.4), 1e-3)
FLAT = {"surface": em.RoughLine(X, 0 * X), "model": WIDE}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"time": 1.0, "velocity": 1.0}, ("time", "velocity", 1)),
        ({"pressure": -1.0}, ("pressure", -1)),
        ({"pressure": [1.0, 2.0], "time": [1.0, 2.0, 3.0]}, ("", "broadcast")),
        ({"conductivity": [1.0, 2.0, 3.0]}, ("conductivity", "pair")),
        ({"model": em.Line(average=True)}, ("model", "average")),
        ({"model": em.Multiscale()}, ("model", "em.press")),
        ({"surface": LINE}, ("equivalent_length", "RoughLine")),
        ({"surface": em.Sphere(1.0)}, ("surface", "em.RoughLine", "Sphere")),
        ({"material": em.Foundation(0.0, [1e6], [1.0])}, ("material", "equilibrium")),
        ({"material": SPRINGS}, ("material", "half-space")),
        (FLAT, ("surface", "differ")),
    ],
)
def test_bad_input(change, said):
    arguments = {"material": RUBBER, "surface": SURFACE, "pressure": 3e3} | change
    with refused(*said):
        em.press(arguments.pop("material"), arguments.pop("surface"), **arguments)


def test_sliding_is_not_traced():
    with refused("velocity", "jit"):
        jax.jit(
            lambda v: em.press(RUBBER, SURFACE, pressure=3e3, velocity=v).conductance
        )(1.0)


@pytest.mark.filterwarnings("ignore:heights of skewness")
def test_heights_that_are_not_gaussian_are_a_doubt():
    height, side = rough_map(SURFACE, 3, periods=3, points=96)
    worn = em.read_surface(np.minimum(height, 0.0), pixel_size=side / 96)
    at = {"pressure": [1e4, 2e4], "time": 1.0}
    found = em.press(RUBBER, worn, **at)
    assert np.isnan(found.model_error).all()
    (doubt,) = found.doubts
    assert doubt.kind == "no prediction"
    assert "not Gaussian" in doubt.says
    assert doubt.points.all()
    assert "Gaussian" not in str(em.press(RUBBER, SURFACE, **at).doubts)


def test_what_lies_under_a_rough_surface_is_said_alike():
    """A layer's rubber alone, by friction and press; a table as it was given."""
    rubber = em.Prony(1e6, [3e6], [0.1])
    layer = em.layer(rubber, 1e-2)
    with refused("material", "rubber alone"):
        em.friction(layer, SURFACE, velocity=1.0, pressure=1e5)
    with refused("material", "rubber alone"):
        em.press(layer, SURFACE, pressure=1e5)
    with refused("material", "rubber alone"):
        em.friction(layer, LINE, velocity=1.0, pressure=1e5, model=WIDE)
    omega = np.logspace(-2, 6, 60)
    modulus = rubber.complex_modulus(omega)
    table = em.TabulatedModulus(omega, modulus.real, modulus.imag)
    with refused("material", "TabulatedModulus", "em.fit.prony"):
        em.press(table, SURFACE, pressure=1e5, velocity=1.0)
