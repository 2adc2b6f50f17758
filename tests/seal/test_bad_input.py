"""Bad input of seals: each error names what is wrong, and its advice leads to the right
answer.
"""

import re

import numpy as np
import pint
import pytest

import elastomdr as em
from elastomdr.cli.main import main

from ..refused import refused

UNIT = pint.UnitRegistry()
RUBBER = em.Prony(1e6, [3e6, 2e6], [1e-4, 1e-2])
ROUGH = em.SelfAffine(0.8, rms_height=2e-6, q_low=1e5, q_high=1.6e6)
BODY = em.Cylinder(5e-3, 1.0)
LEAK = {
    "pressure": 3e5,
    "pressure_drop": 2e5,
    "viscosity": 0.05,
    "length": 1e-3,
    "width": 0.1,
}
STROKE = {"velocity_out": 0.1, "velocity_in": 0.1, "stroke": 0.1}
X = np.linspace(0.0, 1e-3, 101)
PROFILE = X, 1e6 * np.sin(np.pi * X / 1e-3)
SCENE = """
material = "epdm-70"
temperature = "20 degC"

[surface]
shape = "self_affine"
hurst = 0.8
rms_height = "2 um"
q_low = "1e5 rad/m"
q_high = "1.6e6 rad/m"

[leak]
pressure = "0.3 MPa"
pressure_drop = "2 bar"
viscosity = "46 cSt"
length = "1 mm"
width = "10 cm"
time = "1 min"
"""


def leak(**change):
    return float(em.leak(RUBBER, ROUGH, **LEAK | change).rate)


def film(**change):
    scene = {"velocity": 0.1, "load": 1e3, "viscosity": 0.04} | change
    return float(em.lubricated(RUBBER, BODY, **scene).film_thickness)


def stroke(**change):
    return float(em.reciprocating(profile=PROFILE, **STROKE, **change).film_out)


@pytest.mark.parametrize("call", [leak, film, stroke])
def test_kinematic_viscosity(call):
    """46 cSt of an oil of 870 kg/m^3 are 40 mPa s."""
    with refused("viscosity", "density"):
        call(viscosity=46 * UNIT.cSt)
    with refused("viscosity", "density"):
        leak(viscosity=46 * UNIT.cSt, density=870 * UNIT.kg / UNIT.m**3)
    oil = 46 * UNIT.cSt * (870 * UNIT.kg / UNIT.m**3)
    assert call(viscosity=oil) == pytest.approx(call(viscosity=46e-6 * 870), rel=1e-12)


def test_kinematic_viscosity_in_a_scene(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "scene.toml"
    path.write_text(SCENE, encoding="utf-8")
    assert main(["leak", str(path)]) == 2
    assert "dynamic viscosity" in capsys.readouterr().err
    path.write_text(SCENE.replace("46 cSt", "40.02 mPa s"), encoding="utf-8")
    assert main(["leak", str(path), "--verbose"]) == 0
    found = em.leak(
        em.load_material("epdm-70"), ROUGH, temperature=293.15, time=60.0,
        **LEAK | {"viscosity": 0.04002},
    )  # fmt: skip
    shown = re.search(r"leak rate +(\S+)", capsys.readouterr().out)
    assert shown
    assert float(shown[1]) == pytest.approx(float(found.rate), rel=1e-5)


def test_gauge_pressure_of_a_gas():
    """Without slip a gas flows by the difference of the squares of absolute pressures."""
    air = {"viscosity": 1.8e-5, "mean_free_path": 0.0}
    with refused("outlet_pressure", "absolute", 101325):
        leak(outlet_pressure=0.0, **air)
    advised = leak(outlet_pressure=101325.0, pressure_drop=1e3, **air)
    squares = (102325.0**2 - 101325.0**2) / (2 * 101325.0)
    liquid = leak(viscosity=1.8e-5, pressure_drop=1e3)
    assert advised == pytest.approx(liquid * squares / 1e3, rel=1e-4)


def test_gauge_and_absolute_pressures_of_a_liquid_differ_alike():
    """A drop from 3 to 1 bar absolute is one from 2 to 0 bar gauge; an inlet pressure
    in place of the drop opens the seal, or is refused as such.
    """
    inlet, outlet = (UNIT.Quantity(bar, "bar") for bar in (3.0, 1.0))
    assert leak(pressure_drop=inlet - outlet) == pytest.approx(leak(pressure_drop=2e5))
    with refused("pressure_drop", "below pressure"):
        leak(pressure_drop=inlet)


def test_pressure_drop_above_the_contact_pressure():
    """An O-ring is pressed by its squeeze and by its fluid."""
    drop = 4e6
    ring = em.o_ring(RUBBER, 3e-3, 0.15)
    with refused("pressure_drop", "squeeze"):
        leak(pressure=ring.pressure, pressure_drop=drop)
    advised = leak(pressure=ring.pressure + drop, pressure_drop=drop)
    whole = em.o_ring(RUBBER, 3e-3, 0.15, fluid_pressure=drop).sealing_pressure
    assert whole == pytest.approx(float(ring.pressure) + drop)
    assert advised == leak(pressure=whole, pressure_drop=drop)


@pytest.mark.parametrize("verb", ["leak", "break_out", "lubricated"])
def test_roughness_of_both_partners(verb):
    """Two surfaces alike add up to one with the square root of two of the height."""

    def found(surface):
        if verb == "leak":
            return float(em.leak(RUBBER, surface, **LEAK).rate)
        if verb == "break_out":
            scene = {"pressure": 3e5, "boundary_shear": 1e5}
            return float(em.break_out(RUBBER, surface, **scene).mu)
        return film(surface=surface, velocity=1e-3)

    with refused("surface", "em.Spectrum(q, first.at"):
        found((ROUGH, ROUGH))
    q = np.geomspace(ROUGH.q_low, ROUGH.q_high, 60)
    advised = em.Spectrum(q, ROUGH.at(q) + ROUGH.at(q), convention="2d")
    higher = em.SelfAffine(0.8, rms_height=2e-6 * 2**0.5, q_low=1e5, q_high=1.6e6)
    assert found(advised) == pytest.approx(found(higher), rel=2e-4)


def test_a_result_says_whose_roughness_it_has():
    said = "the sum of both spectra where the rubber is rough too"
    assert said in em.leak(RUBBER, ROUGH, **LEAK).summary()
    scene = {"velocity": 0.1, "load": 1e3, "viscosity": 0.04, "surface": ROUGH}
    assert said in em.lubricated(RUBBER, BODY, **scene).summary()


def test_squeeze_above_what_formulas_hold_for():
    """28 % by "free", between the finite elements of 25 and 30 % (docs/seal.md)."""
    with refused("squeeze", 0.25, 0.3, 0.28):
        em.o_ring(RUBBER, 3e-3, 0.28)
    advised = em.o_ring(RUBBER, 3e-3, 0.28, formula="free").line_load
    over = float(advised) / (3 * RUBBER.equilibrium * 3e-3)
    assert 0.1638 < over < 0.2236
    with refused("squeeze", 0.3, 0.35):
        em.o_ring(RUBBER, 3e-3, 0.35, formula="free")
    with refused("squeeze", 0.15, 15):
        em.o_ring(RUBBER, 3e-3, 15.0)
    percent = em.o_ring(RUBBER, 3e-3, 15.0 / 100).line_load
    lindley = 3 * RUBBER.equilibrium * 3e-3 * (1.25 * 0.15**1.5 + 50 * 0.15**6)
    assert percent == pytest.approx(lindley, rel=1e-9)


def test_a_layer_under_roughness_is_refused_and_its_rubber_accepted():
    asked = {"pressure": 1e5, "pressure_drop": 1e3, "viscosity": 0.05, "length": 1e-3}
    with refused("material", "half-space"):
        em.leak(em.layer(RUBBER, 1e-3), ROUGH, **asked)
    assert em.leak(RUBBER, ROUGH, **asked).rate > 0
    with refused("molar_mass", "kg/mol", 1, 28):
        em.leak(
            RUBBER,
            ROUGH,
            **asked,
            outlet_pressure=1e5,
            molar_mass=28.0,
            temperature=300.0,
        )


def test_a_profile_with_holes_is_refused():
    pressure = np.array([0.0, 1.0, 2.0, 3.0, np.nan, 3.0, 2.0, 1.0, 0.0])
    with refused("profile", "nan"):
        em.reciprocating(
            profile=(np.arange(9.0), pressure),
            velocity_out=0.1,
            velocity_in=0.1,
            stroke=0.1,
            viscosity=0.1,
        )


AT_REST = {
    em.leak: {"pressure_drop": 1e4, "viscosity": 1e-3, "length": 1e-3, "width": 0.1},
    em.break_out: {"boundary_shear": 1e5},
    em.press: {"model": em.Line(seeds=2, periods=4)},
}


@pytest.mark.parametrize("verb", AT_REST)
def test_a_table_of_moduli_rests_on_its_lowest_one(verb):
    """As the elastic series of that modulus, and beyond the data; not after a time."""
    omega = np.geomspace(1.0, 1e6, 30)
    warm = {
        "shift": em.WLF(8.86, 101.6, 293.15),
        "vertical": em.EntropicVertical(293.15),
    }
    moduli = 1e6 * (1 + omega / 1e3), 1e5 * (1 + omega / 1e3)
    table = em.TabulatedModulus(omega, *moduli, poisson=0.49, **warm)
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=1e4)
    given = {"pressure": 3e5, "temperature": 320.0, **AT_REST[verb]}
    with pytest.warns(em.ExtrapolationWarning):
        found = verb(table, surface, **given)
    elastic = em.Prony(float(table.storage(0.0)), [], [], poisson=0.49, **warm)
    same = verb(elastic, surface, **given)
    shown = {em.leak: "rate", em.break_out: "mu", em.press: "approach"}[verb]
    assert getattr(found, shown) == pytest.approx(getattr(same, shown), rel=1e-12)
    assert found.extrapolated.all()
    with refused("material", "series", "em.fit.prony"):
        verb(table, surface, time=10.0, **given)


def test_a_table_of_moduli_is_not_pressed_in_sliding():
    omega = np.geomspace(1.0, 1e6, 30)
    table = em.TabulatedModulus(omega, 1e6 + 0 * omega, 1e5 + 0 * omega)
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=1e4)
    with refused("material", "series"):
        em.press(table, surface, pressure=1e5, velocity=0.1)
