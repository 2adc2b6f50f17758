"""A material knows where its numbers hold; what uses it beyond that says so, point by
point and in words.
"""

import dataclasses
import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.errors import InputError
from elastomdr.material.validity import Range, shared
from elastomdr.results.base import Result

from ..refused import mentions, warned

LAW = em.WLF(6.0, 110.0, 293.15)
LIMITS = {"omega": (1.0, 1e3), "temperature": (273.15, 313.15)}
RUBBER = em.Prony(1e6, [4e6, 1e6], [1e-3, 1e-1], shift=LAW, name="rubber", range=LIMITS)
BALL = em.Paraboloid(5e-3)
SCENE = {"load": 1.0, "model": em.Line(), "rtol": 1e-3}
VELOCITY = np.geomspace(1e-5, 10.0, 16)


@pytest.fixture(scope="module")
def curve():
    with pytest.warns(em.ExtrapolationWarning) as caught:
        found = em.friction(RUBBER, BALL, velocity=VELOCITY, **SCENE)
    assert len(caught) == 1
    return found, str(caught[0].message)


def test_every_point_is_flagged_by_the_frequency_of_its_passage(curve):
    found, said = curve
    rate = 2 * VELOCITY / (0.5 * (found.contact.leading + found.contact.trailing))
    np.testing.assert_array_equal(found.extrapolated, (rate < 4.0) | (rate > 1e3))
    assert 3 < found.extrapolated.sum() < 13
    assert said.startswith(f"{found.extrapolated.sum()} of 16 points")
    assert "range 1 to 1e+03 rad/s" in said
    assert said.rstrip(".") in found.summary()
    text = found.csv()
    assert any(line.startswith("# extrapolated: ") for line in text.splitlines())
    assert "beyond the range" in text
    assert [line.get_linestyle() for line in found.plot().lines[:2]] == ["-", ":"]


def test_a_scene_within_the_range_is_not_flagged():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = em.friction(RUBBER, BALL, velocity=np.geomspace(3e-3, 0.1, 16), **SCENE)
    assert not found.extrapolated.any()
    assert "extrapolated" not in found.summary()
    assert (
        em.friction(
            em.Prony(1e6, [4e6, 1e6], [1e-3, 1e-1]), BALL, velocity=VELOCITY, **SCENE
        ).extrapolated
        is None
    )


@pytest.mark.parametrize("name", ["psa-468mp", "tread-passenger-synthetic"])
def test_the_slow_end_of_what_was_measured(name):
    """Fitted to its own moduli, without noise: where a passage lasts longer than the
    data, friction is flagged.
    """
    rubber = em.load_material(name)
    reference = float(rubber.shift.reference)
    kelvin, f = reference + np.arange(-10.0, 51.0, 10.0), np.geomspace(0.1, 100, 13)
    moduli = np.concatenate(
        [np.asarray(rubber.at(t).complex_modulus(2 * np.pi * f)) for t in kelvin]
    )
    omega = np.tile(2 * np.pi * f, kelvin.size)
    data = em.fit.dma(
        omega, moduli.real, moduli.imag, np.repeat(kelvin, f.size), kind="shear"
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fitted = em.fit.material(data, reference).material
        velocity, scene = (
            np.geomspace(1e-6, 0.3, 18),
            {"load": 1.0, "temperature": reference, "model": em.Line()},
        )
        found, truth = (
            em.friction(m, em.Sphere(5e-3), velocity=velocity, **scene)
            for m in (fitted, rubber)
        )
    off = np.abs(found.mu / truth.mu - 1)
    assert off[found.extrapolated].max() > 0.1
    assert off[~found.extrapolated].max() < 0.02
    assert (~found.extrapolated).sum() >= 10


def test_temperatures_shift_the_frequency_and_have_a_range_of_their_own():
    kelvin = np.array([[273.15], [313.15]])
    with pytest.warns(em.ExtrapolationWarning):
        found = em.friction(
            RUBBER, BALL, velocity=VELOCITY[:8], temperature=kelvin, **SCENE
        )
    length = found.contact.leading + found.contact.trailing
    rate = 4 * VELOCITY[:8] * np.asarray(LAW.a(kelvin)) / length
    np.testing.assert_array_equal(found.extrapolated, (rate < 4.0) | (rate > 1e3))
    with warned(em.ExtrapolationWarning, "16 of 16", 320, 330, 273.15, 313.15):
        hot = em.friction(
            RUBBER,
            BALL,
            velocity=VELOCITY[:8],
            temperature=np.array([[320.0], [330.0]]),
            **SCENE,
        )
    assert hot.extrapolated.all()


def test_a_material_brought_to_a_temperature_keeps_its_range():
    cold = RUBBER.at(283.15)
    a = float(LAW.a(283.15))
    np.testing.assert_allclose(cold.range.omega, (1 / a, 1e3 / a))
    assert cold.range.temperature is None
    assert cold.range.beyond == ""
    with warned(em.ExtrapolationWarning, "2 of 2", 350, 273.15, 313.15):
        em.friction(RUBBER.at(350.0), BALL, velocity=[0.1, 0.2], **SCENE)


def test_rubber_that_friction_heats_beyond_its_data():
    rubber = dataclasses.replace(RUBBER, range={"temperature": (273.15, 313.15)})
    surface = em.SelfAffine(0.8, rms_slope=1.0, q_low=1e3, q_high=1e4)
    scene = {"velocity": [1e-4, 20.0], "pressure": 1e6, "temperature": 313.0}
    with pytest.warns(em.ExtrapolationWarning, match="1 of 2 .* temperature from 313"):
        hot = em.friction(rubber, surface, heat=em.Heat(0.2, 1.8e6), **scene)
    assert hot.temperature_rise[1] > 1.0
    np.testing.assert_array_equal(hot.extrapolated, [False, True])


def test_an_assumed_range_is_noted_without_a_warning():
    rubber = em.Prony(
        1e6, [4e6, 1e6], [1e-3, 1e-1], range=Range((1.0, 1e3), None, illustrative=True)
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = em.friction(rubber, BALL, velocity=VELOCITY, **SCENE)
    assert found.extrapolated.any()
    assert "points lie beyond" in found.summary()


def test_two_bodies_and_layers():
    other = em.Prony(1e6, [1e6], [1.0], range={"time": (1e-2, 10.0)})
    plain = em.Prony(1e6, [1e6], [1.0])
    assert em.half_space(RUBBER.at(293.15), other).range.omega == pytest.approx(
        (1.0, 100.0)
    )
    assert em.half_space(plain, other).range.omega == pytest.approx((0.1, 100.0))
    assert em.springs(RUBBER, 1e-3, bonded=False).range == RUBBER.range
    apart = shared(Range((1.0, 2.0), None), Range((3.0, 4.0), None))
    assert apart.outside(np.array([1.5]), None).all()


def test_files_keep_the_range(tmp_path):
    em.save_material(RUBBER, tmp_path / "rubber.toml")
    assert em.load_material(tmp_path / "rubber.toml").range == RUBBER.range
    assert em.load_material("epdm-70").range.illustrative is False
    made_up = em.load_material("tread-passenger-synthetic")
    assert made_up.range.illustrative
    em.save_material(made_up, tmp_path / "bare.toml")
    assert em.load_material(tmp_path / "bare.toml").range == made_up.range


def test_the_command_line_says_it(tmp_path, monkeypatch, capsys):
    em.save_material(RUBBER, tmp_path / "rubber.toml")
    scene = (
        'material = "rubber.toml"\n[indenter]\nshape = "paraboloid"\nradius = "5 '
        'mm"\n[contact]\nload = "1 N"\n'
    )
    (tmp_path / "fast.toml").write_text(
        scene
        + 'velocity = ["1 m/s", "9 m/s"]\nmodel = "line"\n[numerics]\nrtol = 1e-3\n'
    )
    monkeypatch.chdir(tmp_path)
    assert main(["friction", "fast.toml"]) == 0
    out, err = capsys.readouterr()
    assert "extrapolated" in out
    assert mentions(err, "warning: 2 of 2 points", "beyond the range")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    "bad",
    [{"omgea": (1, 2)}, {"omega": (2, 1)}, {"time": (0.0, 1.0)}, {"time": 3}, (1, 2)],
)
def test_refusals(bad):
    with pytest.raises(InputError, match="range must"):
        em.Prony(1e6, [1e6], [1.0], range=bad)


def test_gradients_go_through_a_material_with_a_range():
    import jax

    def friction(modulus):
        rubber = em.StandardSolid(1e6, modulus, 1e-3, range=LIMITS)
        return em.friction(rubber, BALL, velocity=100.0, **SCENE).mu

    with jax.enable_x64(True):
        assert np.isfinite(float(jax.grad(friction)(3e6)))


def test_a_rough_surface_at_temperatures_that_were_not_measured():
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e3)
    rubber = em.Prony(
        1e6,
        [4e6, 1e6],
        [1e-3, 1e-1],
        shift=LAW,
        range={"temperature": LIMITS["temperature"]},
    )
    asked = {"velocity": 1.0, "pressure": 1e5, "rtol": 1e-2}
    kelvin = np.array([293.15, 350.0])
    for body in (surface, surface.line(samples=64)):
        length = None if body is surface else 1e-3
        model = em.Line(equivalent_length=length)
        with warned(em.ExtrapolationWarning, 1, 2, 293.15, 350, 273.15, 313.15):
            found = em.friction(rubber, body, temperature=kelvin, model=model, **asked)
        assert found.extrapolated.tolist() == [False, True]
    with pytest.warns(
        em.ExtrapolationWarning,
        match="1 of 1 points .* temperature 350 K, range 273.15",
    ) as caught:
        found = em.friction(rubber.at(350.0), surface, model=em.Line(), **asked)
    assert found.extrapolated.all()
    assert len(caught) == 1


def test_share_of_the_slope_beyond_the_data():
    """C = q^-3 has as much square slope at each wave number; of a line a wave of
    amplitude h has (q h)^2/2.
    """
    from elastomdr.call.extrapolation import excited_outside

    surface = em.Spectrum([1e3, 1.1e4], [1e-9, 1e-9 / 1331], convention="2d")
    # wave numbers 2e3 to 1e4, 200 to 1e3, 2e4 up
    known, velocity = Range((2e2, 1e3), None), np.array([0.1, 1.0, 0.01])
    np.testing.assert_allclose(
        excited_outside(known, surface, velocity), [0.2, 1.0, 1.0], rtol=1e-12
    )
    x = np.arange(64) * 1e-5
    q = 2 * np.pi / (64 * 1e-5) * np.array([2, 5])
    line = em.RoughLine(x, 3e-6 * np.cos(q[0] * x) + 2e-6 * np.cos(q[1] * x))
    share = excited_outside(
        Range((0.9 * q[1], 1.1 * q[1]), None), line, np.array([1.0])
    )
    np.testing.assert_allclose(
        share, (3 * q[0]) ** 2 / ((3 * q[0]) ** 2 + (2 * q[1]) ** 2), rtol=1e-12
    )


class TestHistories:
    """Data from 1 to 1000 rad/s speak of ages from 1 ms to 1 s."""

    rubber = em.Prony(
        1e6,
        [4e6, 1e6],
        [1e-3, 1e-1],
        shift=LAW,
        name="rubber",
        range={"omega": (1.0, 1e3)},
    )

    @pytest.mark.parametrize("what", [{"depth": 1e-5}, {"load": 1e-3}])
    def test_a_step_is_known_by_its_age(self, what):
        time = np.append(0.0, np.geomspace(1e-4, 10.0, 41))
        with warned(em.ExtrapolationWarning, 0.001, 1) as caught:
            found = em.indent(self.rubber, BALL, time=time, **what)
        assert len(caught) == 1
        np.testing.assert_array_equal(
            found.extrapolated, (time < 0.99e-3) | (time > 1.01)
        )
        assert str(caught[0].message).rstrip(".") in found.summary()
        assert "beyond the range" in found.csv()
        assert {":", "-"} == {line.get_linestyle() for line in found.plot().lines}

    def test_temperature_shifts_the_ages(self):
        factor, time = (
            float(LAW.a(283.15)),
            np.append(0.0, np.geomspace(1e-4, 90.0, 61)),
        )
        with pytest.warns(em.ExtrapolationWarning):
            found = em.indent(
                self.rubber, BALL, time=time, depth=1e-5, temperature=283.15
            )
        with pytest.warns(em.ExtrapolationWarning):
            brought = em.indent(self.rubber.at(283.15), BALL, time=time, depth=1e-5)
        assert 2 < factor < 10
        np.testing.assert_array_equal(
            found.extrapolated, (time < 1e-3 * factor) | (time > factor)
        )
        np.testing.assert_array_equal(found.extrapolated, brought.extrapolated)
        rubber = em.Prony(1e6, [4e6], [1e-3], shift=LAW, range=LIMITS)
        with warned(em.ExtrapolationWarning, 350, 273.15, 313.15):
            assert em.indent(
                rubber, BALL, time=[0.0, 1.0], depth=[0, 1e-5], temperature=350.0
            ).extrapolated.all()

    @pytest.mark.parametrize(("omega", "within"), [(30.0, True), (5e3, False)])
    def test_an_oscillation_is_known_by_its_frequency(self, omega, within):
        time = np.linspace(0, 4 * np.pi / omega, 41)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = em.indent(
                self.rubber, BALL, time=time, depth=1e-5 * (1.5 - np.cos(omega * time))
            )
        assert found.extrapolated[20:].all() != within
        assert found.extrapolated[20:].any() != within

    @pytest.mark.parametrize("rest", [0.0, 1e-4])
    def test_a_deeper_press_before_hides_nothing(self, rest):
        """Data within a factor of 1.0003, and forces that differ by one of 32."""
        time, depth = (
            [0, 0.1, 0.2, 0.5, 0.5000001, 0.5000002],
            [0, 1e-3, rest, rest, 2e-4, 4e-4],
        )
        with pytest.warns(em.ExtrapolationWarning, match="within 0.001 s decides"):
            found = em.indent(self.rubber, BALL, time=time, depth=depth)
        assert found.extrapolated[-1]
        assert not found.extrapolated[1]

    def test_histories_of_their_own(self):
        time = np.linspace(0, 0.5, 21)
        depth = 1e-5 * np.stack([time, 0 * time, np.ones_like(time)])
        with pytest.warns(em.ExtrapolationWarning, match="1 of 63 points"):
            found = em.indent(self.rubber, BALL, time=time, depth=depth)
        assert np.argwhere(found.extrapolated).tolist() == [[2, 0]]

    @pytest.mark.parametrize("velocity", [1e-4, 1e-2, 3.0])
    @pytest.mark.parametrize(
        "body", [BALL, em.SelfAffine(0.8, 0.2, 1e3, 4e3).line(samples=64)]
    )
    def test_sliding_agrees_with_steady_sliding(self, body, velocity):
        time = np.linspace(0, 8e-3 / velocity, 13)
        load = 0.1 if body is BALL else 100.0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            moving = em.slide(
                self.rubber,
                body,
                time=time,
                position=velocity * time,
                load=load,
                rtol=0.1,
            )
            steady = em.friction(
                self.rubber,
                body,
                velocity=velocity,
                load=load,
                model=em.Line(),
                rtol=1e-2,
            )
        assert moving.extrapolated[-1] == steady.extrapolated
        assert not moving.extrapolated[0]  # where it is put down

    def test_a_flat_line_excites_nothing(self):
        flat = em.RoughLine(1e-5 * np.arange(64), np.zeros(64))
        assert not em.friction(
            self.rubber, flat, velocity=1e-9, load=100.0, model=em.Line()
        ).extrapolated
        assert not em.slide(
            self.rubber, flat, time=[0, 0.1], position=[0, 1e-3], load=100.0
        ).extrapolated.any()

    def test_a_rest_grows_older(self):
        time = np.linspace(0, 3.0, 61)
        position = np.clip(time - 2, 0, None) * 5e-3
        with pytest.warns(em.ExtrapolationWarning, match="after more than 1 s"):
            found = em.slide(
                self.rubber, BALL, time=time, position=position, load=0.1, rtol=0.1
            )
        old = (time > 1.001) & (time < 2.05)
        assert found.extrapolated[old].all()
        assert not found.extrapolated[(time < 0.999) | (time > 2.5)].any()
        assert {line.get_linestyle() for line in found.plot().lines} == {"-", ":"}

    @pytest.mark.slow  # marched on NumPy for the better part of a minute
    def test_driven(self):
        time = np.linspace(0, 2.0, 41)
        scene = {
            "time": time,
            "position": 1e-4 * time,
            "load": 0.1,
            "tangential": em.Mount(0.01, 1e3, 1.0),
        }
        with pytest.warns(em.ExtrapolationWarning, match="after more than 1 s"):
            found = em.drive(self.rubber, BALL, **scene, rtol=0.1)
        # the contact is wider than its way
        np.testing.assert_array_equal(found.extrapolated, time > 1)
        assert (
            em.drive(em.Prony(1e6, [4e6], [1e-3]), BALL, **scene, rtol=0.1).extrapolated
            is None
        )

    def test_impacts(self):
        velocity = np.geomspace(1e-4, 10.0, 6)
        other = em.Prony(1e6, [1e6], [1.0])
        with pytest.warns(
            em.ExtrapolationWarning, match="contact time means frequencies"
        ) as caught:
            found = em.impact([self.rubber, other], BALL, mass=4e-3, velocity=velocity)
        assert len(caught) == 1
        assert not found.extrapolated[1].any()
        np.testing.assert_array_equal(
            found.extrapolated[0], 4 / found.duration[0] > 1e3
        )
        assert 0 < found.extrapolated[0].sum() < 6
        assert found.plot() is not None

    def test_tangential_loading_and_traction(self):
        time = np.linspace(0, 0.5, 26)
        moved = {"displacement": 1e-7 * np.sin(20 * time), "friction": 0.5, "load": 0.1}
        assert not em.shear(self.rubber, BALL, time=time, **moved).extrapolated.any()
        with pytest.warns(em.ExtrapolationWarning, match="after more than 1 s"):
            found = em.shear(self.rubber, BALL, time=4 * time, **moved)
        np.testing.assert_array_equal(found.extrapolated, 4 * time > 1.001)
        scene = {"velocity": VELOCITY, "load": 1.0, "model": em.Line(), "rtol": 1e-3}
        with pytest.warns(em.ExtrapolationWarning) as caught:
            pulled = em.traction(
                self.rubber, BALL, creepage=0.01, friction=0.5, **scene
            )
        assert len(caught) == 1
        with pytest.warns(em.ExtrapolationWarning):
            rolled = em.rolling(self.rubber, BALL, **scene)
        np.testing.assert_array_equal(pulled.extrapolated, rolled.extrapolated)
        assert "extrapolated" in pulled.summary()

    def test_an_elastic_structure_under_a_tread(self):
        tread = em.half_space(self.rubber, tangential=True)
        with pytest.warns(em.ExtrapolationWarning):
            found = em.traction(
                em.Foundation(1e7, [], []),
                BALL,
                tangential=tread,
                velocity=[1e-5, 1e-2],
                creepage=0.01,
                friction=0.5,
                load=1.0,
                model=em.Line(),
            )
        assert found.extrapolated.tolist() == [True, False]


NO_RANGE = em.Prony(1e6, [4e6, 1e6], [1e-3, 1e-1], shift=LAW, name="rubber")
COLD = 263.15  # below the data
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)
WAVE = em.RoughLine(np.arange(64) * 1e-5, 1e-6 * np.cos(2 * np.pi * np.arange(64) / 64))
EVEN = np.linspace(0.0, 0.02, 9)
ROLLER = em.Cylinder(0.05, 0.5)


def _conveyor(material):
    side = em.Idlers(
        em.springs(material.at(COLD), 1e-2, bonded=False), ROLLER, spacing=1.0
    )
    return em.conveyor(
        side, side, velocity=[2.0, 4.0], belt=20.0, goods=[[0.0], [100.0]]
    )


def _warming(material):
    wheel = {
        "velocity": 1.0,
        "load": 100.0,
        "ambient": COLD,
        "conductance": [1.0, 2.0],
        "hottest": 320.0,
    }
    return em.heat_build_up(
        em.springs(material, 1e-2, bonded=False),
        ROLLER,
        **wheel,
        capacity=1e3,
        time=[0.0, 100.0, 1e3],
        rtol=1e-4,
    )


# Of every class of results, a call outside the range of the material: see
# `results/test_every_doubt.py`.
OUTSIDE = {
    "FrictionCurve": lambda m: em.friction(
        m, ROAD, velocity=[0.1, 1.0], pressure=3e5, temperature=COLD
    ),
    "RollingCurve": lambda m: em.rolling(
        m, BALL, velocity=[0.1, 1.0], temperature=COLD, **SCENE
    ),
    "Dissipation": lambda m: em.dissipation(
        m, BALL, velocity=[0.1, 1.0], temperature=COLD, **SCENE
    ),
    "FrictionSpectrum": lambda m: em.friction_spectrum(
        m, WAVE, velocity=0.1, load=10.0, temperature=COLD
    ),
    "RoughContact": lambda m: em.press(
        m, ROAD, pressure=[1e4, 1e5], model=em.Line(seeds=2, samples=1024)
    ),
    "Indentation": lambda m: em.indent(
        m, BALL, time=[0.0, 1.0], depth=[0.0, 1e-4], temperature=COLD
    ),
    "Impact": lambda m: em.impact(
        m, BALL, mass=1e-3, velocity=[0.5, 1.0], temperature=COLD, rtol=1e-3
    ),
    "Slide": lambda m: em.slide(
        m, BALL, time=EVEN, position=0.02 * EVEN, load=1.0, temperature=COLD, rtol=0.1
    ),
    "Drive": lambda m: em.drive(
        m,
        BALL,
        time=EVEN[:3],
        position=EVEN[:3],
        load=1.0,
        temperature=COLD,
        tangential=em.Mount(0.1, 1e3),
        rtol=0.1,
    ),
    "ForceSpectrum": lambda m: OUTSIDE["Slide"](m).spectrum("normal_force"),
    "Shear": lambda m: em.shear(
        m.at(COLD),
        BALL,
        time=EVEN[:3],
        displacement=1e-6 * EVEN[:3],
        load=1.0,
        friction=0.5,
        elements=8,
        steps=2,
    ),
    "Traction": lambda m: em.traction(
        m,
        BALL,
        velocity=1.0,
        creepage=[1e-3, 1e-2],
        friction=0.5,
        load=1.0,
        temperature=COLD,
    ),
    "Conveyor": _conveyor,
    "HeatBuildUp": _warming,
    "ORing": lambda m: em.o_ring(m, 5e-3, [0.1, 0.15], time=1e8),
    "Leak": lambda m: em.leak(
        m,
        ROAD,
        pressure=[1e5, 2e5],
        pressure_drop=1e4,
        viscosity=1e-3,
        length=1e-3,
        time=1e8,
    ),
    "BreakOut": lambda m: em.break_out(
        m, ROAD, pressure=[1e5, 2e5], boundary_shear=1e5, time=1e8
    ),
    "Lubricated": lambda m: em.lubricated(
        m, em.Cylinder(5e-3, 1.0), velocity=[0.1, 1.0], load=10.0, viscosity=1.0
    ),
    "Reciprocating": lambda m: em.reciprocating(
        m,
        o_ring=em.o_ring(m, 5e-3, 0.15, time=1e8),
        velocity_out=[0.1, 0.2],
        velocity_in=0.1,
        stroke=0.1,
        viscosity=0.1,
    ),
}
# And what does not look at it, and says so.
BLIND = {
    "Stability": lambda: em.stability(
        em.Mount(1.0, 1e3),
        velocity=[1.0, 2.0, 3.0],
        force=[1.0, 0.9, 0.8],
        wavelength=1.0,
    ),
    "HalfPlaneCurve": lambda: em.reference.half_plane_sliding(
        RUBBER, 0.01, velocity=0.1, load_per_length=1.0, points=16
    ),
    "HalfSpaceCurve": lambda: em.reference.half_space_sliding(
        RUBBER,
        1e-6 * np.random.default_rng(1).random((16, 16)),
        cell=(1e-4, 1e-4),
        velocity=0.1,
        load=1e-3,
    ),
}


def _kinds(kind):
    for under in kind.__subclasses__():
        yield under
        yield from _kinds(under)


def test_every_class_of_results_is_looked_at():
    for name in em.__all__:
        getattr(em, name)
    names = {kind.__name__ for kind in _kinds(Result)}
    names -= {"Uncertainty"}  # of a curve, whose doubts it has (test_law_doubts)
    assert {name for name in names if not name.startswith(("_", "Abstract"))} == {
        *OUTSIDE,
        *BLIND,
    }


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "name", ["FrictionCurve", "Dissipation", "Conveyor", "HeatBuildUp", "ORing"]
)
def test_a_result_without_a_range_says_that_nothing_is_marked(name):
    found = OUTSIDE[name](NO_RANGE)
    assert found.extrapolated is None
    assert "marked as extrapolated" in found.summary()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "name",
    [
        "Stability",
        *(pytest.param(n, marks=pytest.mark.slow) for n in list(BLIND)[1:]),
    ],
)
def test_what_looks_at_no_range_says_why(name):
    found = BLIND[name]()
    assert type(found).__name__ == name
    assert found.extrapolated is None
    assert (
        "does not enter" if name == "Stability" else "takes the material as it is given"
    ) in found.summary()


def test_a_cord_held_for_ten_years_is_beyond_data_of_minutes():
    rubber = em.load_material("epdm-70")
    with warned(em.ExtrapolationWarning, "time held means"):
        found = em.o_ring(rubber, 5e-3, 0.15, time=[10.0, 3.156e8], temperature=293.15)
    assert found.extrapolated.tolist() == [False, True]
    with pytest.warns(em.ExtrapolationWarning, match="held for ever"):
        assert em.o_ring(rubber, 5e-3, 0.15).extrapolated


def test_warming_is_extrapolated_from_where_it_began_beyond_the_range():
    with pytest.warns(em.ExtrapolationWarning):
        found = _warming(RUBBER)
    assert found.extrapolated.all()
