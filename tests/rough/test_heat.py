"""Heat: moving sources against closed forms, and friction at the one flash temperature
of lines.
"""

import pickle
from typing import get_args

import jax
import numpy as np
import pytest
from scipy.integrate import quad

import elastomdr as em
from elastomdr._types import Road
from elastomdr.cli.main import main
from elastomdr.element.law import surface_foundation
from elastomdr.material.shift import thermal_factors
from elastomdr.rough.heat import HIGHEST, TYPICAL, highest_rise
from elastomdr.trees import same

from ..refused import mentions, refused

# of the width of the spectrum
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
RUBBER = em.Heat(0.2, 2e6)  # D = 1e-7 m^2/s
WLF = em.WLF(c1=8.86, c2=101.6, reference=293.15)
COMPOUND = em.Prony(0.5e6, [3e7, 3e6], [1e-6, 1e-3], shift=WLF)
SURFACE = em.SelfAffine(0.8, rms_slope=0.3, q_low=2e3, q_high=6e4)
POOR = em.Heat(0.005, 5e4)  # a fortieth of what a rubber has, for large rises
ASKED = {
    "velocity": np.array([1e-3, 0.1, 1.0, 10.0]),
    "pressure": 5e4,
    "temperature": 293.15,
    "model": em.Line(),
}


def hot(heat=POOR, material=COMPOUND, **changes):
    return em.friction(material, SURFACE, heat=heat, **ASKED | changes)


@pytest.fixture(autouse=True, scope="module")
def any_sampling():
    """Points are handed out whatever the error for the sampling of their lines."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("elastomdr.rough.ensemble.SAMPLING", 1.0)
        yield


@pytest.fixture(scope="module")
def curve():
    return hot()


def test_still_and_moving_sources():
    np.testing.assert_allclose(
        RUBBER.uniform_flux(1e5, 0.002), 7.978845608028654, rtol=1e-12
    )
    slow = RUBBER.moving_band(1e5, 5e-5, 0.001, [-5e-5, 0.0])
    np.testing.assert_allclose(slow, [35.89133510687399, 40.36925612281435], rtol=1e-6)
    fast = RUBBER.moving_band(1e5, 5e-5, 1.0, [-5e-5, 0.0])
    np.testing.assert_allclose(fast, [1.7527389915104155, 1.262196572218204], rtol=1e-6)
    # Ever faster, each point of a band is warmed for the time 2b/v as a half-space is.
    gaps = [
        RUBBER.moving_band(1e5, 5e-5, v, -5e-5) / RUBBER.uniform_flux(1e5, 1e-4 / v) - 1
        for v in (1.0, 100.0, 1e4)
    ]
    assert abs(gaps[2]) < 2e-4
    assert np.all(np.diff(np.abs(gaps)) < 0)


def test_heat_left_behind_is_friction_power():
    """Far behind a band each strip of the surface holds 2 b q/v per area, and cools as
    a plane source does.
    """
    x = 1e-3 * np.array([1e2, 1e3, 1e4])
    left = (
        RUBBER.moving_band(1e5, 5e-5, 0.1, -x)
        * RUBBER.heat_capacity
        * np.sqrt(np.pi * RUBBER.diffusivity * x / 0.1)
    )
    gap = left / (2 * 5e-5 * 1e5 / 0.1) - 1
    assert abs(gap[2]) < 1e-5
    np.testing.assert_allclose(gap[:2] / gap[1:], 10.0, rtol=0.05)


def test_moving_disc():
    at_rest = 8 * 1e5 * 1e-3 / (3 * np.pi * 0.2)
    np.testing.assert_allclose(RUBBER.moving_disc(1e5, 1e-3, 0.0), at_rest, rtol=1e-9)
    # Fast: chords of length c, each the mean of 2 q sqrt(t/(pi lambda rho c)) over t
    # from 0 to c/v.
    chord = quad(lambda s: 2 / np.pi * (2 * np.sqrt(1 - s**2)) ** 1.5 * 2 / 3, 0, 1)[0]
    fast = RUBBER.uniform_flux(1e5, 1e-3 / 1e5) * chord
    np.testing.assert_allclose(RUBBER.moving_disc(1e5, 1e-3, 1e5), fast, rtol=1e-6)


@pytest.mark.parametrize(
    "shape", [em.FlatPunch(1e-3), em.Paraboloid(2 * 0.4 * 1e-3 / (np.pi * 1e5))]
)
def test_thermal_foundation_at_rest(shape):
    """The MDR's line conducts 2 lambda dx where it is pressed with E* dx: temperature
    for displacement.
    """
    line = em.Foundation(2 * 0.2, [], [])
    # an isothermal disc, 50 K, radius a: Q = 4 lambda a dT
    if isinstance(shape, em.FlatPunch):
        got = em.indent(line, shape, time=[0.0, 1.0], depth=[0.0, 50.0])
        np.testing.assert_allclose(got.force[-1], 0.04, rtol=1e-12)
        return
    depth = np.pi * 1e5 * 1e-3 / (4 * 0.2)  # the flux q_0 sqrt(1 - r^2/a^2), a = 1 mm
    np.testing.assert_allclose(depth, 392.69908169872417, rtol=1e-12)
    got = em.indent(line, shape, time=[0.0, 1.0], depth=[0.0, depth])
    np.testing.assert_allclose(got.contact_radius[-1], 1e-3, rtol=1e-12)
    np.testing.assert_allclose(got.force[-1], 0.20943951023931956, rtol=1e-12)
    np.testing.assert_allclose(
        got.displacement(1e-3, time=1.0), 196.34954084936209, rtol=1e-12
    )


def test_a_line_is_as_warm_as_multiscale_finds_it(curve):
    """Of temperatures by length scale the mean; a road takes its part of the heat."""
    by_scale = hot(model=em.Multiscale())
    np.testing.assert_allclose(curve.temperature_rise, by_scale.temperature_rise)
    power = curve.mu * curve.pressure * curve.velocity
    np.testing.assert_allclose(curve.heat_flux, power, rtol=1e-12)  # its own
    cooler = hot(em.Heat(0.005, 5e4, road=(1.0, 2e6)))
    assert (cooler.road_share > 0).all()
    power = cooler.mu * cooler.pressure * cooler.velocity
    np.testing.assert_allclose(cooler.heat_flux, power * (1 - cooler.road_share))
    # a rise that is off as the heat is: mu is off by as much of what the heat did to it
    two = hot(model=em.Line(seeds=2), velocity=ASKED["velocity"][1])
    share = two.heat_flux / by_scale.heat_flux[1] - 1
    off = abs(two.mu - two.cold) * abs(share)
    spread = 2 * two.lines.scatter
    assert two.error > off + spread > spread
    assert off > 0.01 * two.mu
    assert (cooler.temperature_rise < curve.temperature_rise).all()


def test_hot_curve_is_the_cold_one_at_its_own_temperature(curve):
    assert curve.converged.all()
    assert curve.temperature_rise.max() > 10
    warm = em.friction(
        COMPOUND, SURFACE, **ASKED | {"temperature": 293.15 + curve.temperature_rise}
    )
    np.testing.assert_allclose(curve.mu, warm.mu, rtol=1e-6)
    cold = em.friction(COMPOUND, SURFACE, **ASKED)
    np.testing.assert_array_equal(curve.cold, cold.mu)
    assert (np.abs(curve.mu / cold.mu - 1) > 0.05).any()
    assert "flash temperature" in curve.summary()
    assert "length scale" in curve.model


def test_limits_of_the_flash_temperature():
    good = hot(em.Heat(1e6, 1e12))
    np.testing.assert_allclose(good.mu, good.cold, rtol=1e-6)
    full = hot(pressure=1e9)  # heated evenly: no flash
    assert full.converged.all()
    assert (full.temperature_rise < 1e-6).all()


@pytest.mark.parametrize("model", [em.Line(), em.Multiscale()])
def test_elastic_rubber_makes_no_heat(model):
    found = hot(material=em.Prony(0.5e6, [], [], shift=WLF), model=model)
    np.testing.assert_array_equal(found.temperature_rise, 0.0)
    np.testing.assert_allclose(found.mu, 0.0, atol=1e-15)
    assert found.converged.all()


def test_a_temperature_that_is_not_found():
    table = em.ShiftTable([280.0, 293.15, 300.0], WLF.log10_a([280.0, 293.15, 300.0]))
    short = em.Prony(0.5e6, [3e7, 3e6], [1e-6, 1e-3], shift=table)
    with pytest.warns(em.ConvergenceWarning, match="did not converge.*up to 300 K"):
        got = hot(material=short)
    assert got.converged.tolist() == [True, *got.converged[1:]]
    assert not got.converged[-1]
    assert np.isnan(got.mu[~got.converged]).all()
    assert np.isnan(got.temperature_rise[~got.converged]).all()
    assert got.temperature_rise[0] < 7


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"heat": 0.2}, ("heat", "em.Heat")),
        ({"temperature": None}, ("temperature", "heat")),
        ({"pressure": None, "load": 3.0}, ("heat", "pressure")),
        (
            {"shape": em.Sphere(1e-3), "pressure": None, "load": 3.0},
            ("", "indenter"),
        ),
    ],
)
def test_bad_input(change, message):
    asked = {"shape": SURFACE, "heat": RUBBER} | ASKED | change
    with refused(*message):
        em.friction(COMPOUND, asked.pop("shape"), **asked)


def test_bad_heat():
    with refused("conductivity", -0.2):
        em.Heat(-0.2, 2e6)
    with refused("heat_capacity", "single number"):
        em.Heat(0.2, [2e6, 1.0])
    with refused("velocity", 0):
        RUBBER.moving_band(1e5, 1e-3, 0.0, 0.0)
    with refused("rubber", "filled rubber", "foam"):
        em.Heat.preset("foam")
    with refused("road", *get_args(Road), "wood"):
        em.Heat(0.2, 2e6, road="wood")


class TestPresets:
    @pytest.mark.parametrize("road", get_args(Road))
    def test_values_lie_in_their_bands_which_are_said_with_a_source(self, road):
        heat = em.Heat.preset(road=road)
        pairs = (heat.conductivity, heat.heat_capacity), heat.road
        for name, values in zip(("filled rubber", road), pairs, strict=True):
            known = TYPICAL[name]
            low, high = np.array(known.ends)
            assert ((low <= values) & (values <= high) & (low < high)).all()
            ends = np.array([low, high]) / [1, 1e6]
            assert mentions(
                known.says, *ends.ravel(), "table" if name != "concrete" else 2005
            )
            assert mentions(heat.words(), name, known.says)
        assert mentions(heat.words(), "typical, not measured")
        kept = pickle.loads(pickle.dumps(heat))
        assert same(kept, heat)
        assert not same(em.Heat(*pairs[0], road=pairs[1]), heat)
        assert "typical," not in em.Heat(*pairs[0], road=pairs[1]).words()

    @pytest.mark.parametrize(
        ("own", "given"),
        [
            (None, None),
            (None, "asphalt"),
            ((0.3, 1.5e6), (1.0, 2e6)),
            ((0.3, 1.5e6), "asphalt"),
        ],
    )
    def test_the_uncertainty_takes_their_band(self, own, given):
        """What is measured stays; what is typical goes to both ends."""
        heat = em.Heat(*own, road=given) if own else em.Heat.preset(road=given)
        asked = {"velocity": [3.0], "pressure": 3e5, "temperature": 293.15}
        curve = em.friction(COMPOUND, SURFACE, heat=heat, **asked)
        found = curve.uncertainty()
        if own and given != "asphalt":
            assert "heat" not in found.sources
            return
        ends = [
            em.friction(
                COMPOUND,
                SURFACE,
                heat=em.Heat(
                    *(own or rubber), road=road if given == "asphalt" else given
                ),
                **asked,
            ).mu
            for rubber, road in zip(
                TYPICAL["filled rubber"].ends, TYPICAL["asphalt"].ends, strict=True
            )
        ]
        apart = np.max(np.abs(np.array(ends) / curve.mu - 1), axis=0)
        assert apart.max() > 1e-3
        np.testing.assert_allclose(found["heat"].share, apart, rtol=1e-3, atol=1e-6)
        np.testing.assert_allclose(found["heat"].after, 0.25 * found["heat"].share)
        assert mentions(dict(curve.inputs)["heat"], "typical, not measured")

    def test_they_pass_through_jit(self):
        heat = em.Heat.preset(road="asphalt")

        @jax.jit
        def mu(heat, v):
            asked = {"pressure": 3e5, "temperature": 293.15, "velocity": v}
            return em.friction(COMPOUND, SURFACE, heat=heat, **asked).mu

        plain = em.friction(
            COMPOUND, SURFACE, heat=heat, velocity=1.0, pressure=3e5, temperature=293.15
        )
        with jax.enable_x64(True):
            traced = float(mu(heat, 1.0))
        assert traced == pytest.approx(float(plain.mu), rel=1e-6)


SCENE = """
material = "tread-passenger-synthetic"
temperature = ["10 degC", "40 degC"]
measured = "points.csv"
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.3
longest = "3 mm"
shortest = "0.3 mm"
[contact]
model = "line"
pressure = "0.05 MPa"
velocity = ["0.01 m/s", "1 m/s"]
[heat]
conductivity = "{conductivity}"
heat_capacity = "2 MJ/m^3/K"
"""


def test_scene_with_heat_and_measured_points(tmp_path, capsys, monkeypatch):
    scene, points = tmp_path / "tyre.toml", tmp_path / "points.csv"
    scene.write_text(SCENE.format(conductivity="0.25 W/m/K"))
    rows = "10,0.05,10\n100,0.06,10\n100,0.04,40\n1000,0.1,80\n,0.1,80\n"
    points.write_text("velocity [mm/s],mu,temperature [degC]\n" + rows)
    assert main(["friction", str(scene), "--out", str(tmp_path), "--verbose"]) == 0
    said, warned = capsys.readouterr()
    assert mentions(warned, "points.csv", 1, 6, "''")
    for word in (
        "flash temperature",
        "K above",
        "without heating",
        "0.25 W/(m K)",
        "length scale",
        "outside the data",
    ):
        assert word in said
    table = (tmp_path / "tyre-friction.csv").read_text()
    for title in (
        "flash temperature rise [K]",
        "without heating [-]",
        "heat flux into the rubber [W/m^2]",
    ):
        assert title in table
    scene.write_text(SCENE.format(conductivity="0.25 W"))
    assert main(["friction", str(scene)]) == 2
    assert "thermal conductivity" in capsys.readouterr().err
    scene.write_text(SCENE.format(conductivity="0.25 W/m/K"))
    points.write_text("velocity,mu\n10,0.05\n")
    assert main(["friction", str(scene)]) == 2
    assert "has a unit" in capsys.readouterr().err


def test_rises_are_looked_for_as_far_as_the_shift_laws_go():
    """A table ends, whichever of the two it is; a law goes on."""
    ends = em.ShiftTable([280.0, 350.0], [0.0, -2.0])
    softer = em.VerticalTable([280.0, 330.0], [1.0, 0.9])
    free = em.WLF(8.86, 101.6, 280.0)
    for shift, vertical, room in (
        (free, None, HIGHEST),
        (ends, None, 50.0),
        (ends, softer, 30.0),
        (free, softer, 30.0),
    ):
        rubber = em.Prony(1e6, [3e6], [1e-3], shift=shift, vertical=vertical)
        body = surface_foundation(rubber)
        found = highest_rise(body, np.array([290.0, 300.0]))
        expected = [min(room + 10, HIGHEST), room]
        np.testing.assert_allclose(found, expected, rtol=1e-9)
        thermal_factors(body, np.array([290.0, 300.0]) + found)  # holds there
