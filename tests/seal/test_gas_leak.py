"""A gas through a static seal: expansion and slip against integrals along the flow, maps
and the mean free path of air.
"""

from typing import Any

import jax
import numpy as np
import pytest
from scipy.integrate import quad

import elastomdr as em
from elastomdr.cli.kinds import read_scene
from elastomdr.seal.gap_maps import flow, pressed
from elastomdr.surface.spectrum import rough_map

from ..refused import refused

RUBBER = em.StandardSolid(1e6, 3e6, 2.0, shift=em.WLF(8.86, 101.6, 293.15))  # in shear
ROUGH = em.SelfAffine(0.8, rms_slope=0.6, q_low=1e5, q_high=1.6e6)
SCENE = {
    "pressure": 3e5,
    "pressure_drop": 2e5,
    "viscosity": 1.81e-5,
    "length": 2e-3,
    "width": 0.1,
    "time": 100.0,
    "temperature": 293.15,
}
AIR = {"outlet_pressure": 101325.0, "molar_mass": 0.02897}


def conductance(pressure):
    """s [m^3/(Pa s)] of a contact that bears the pressure."""
    faint = SCENE | {"pressure": pressure, "pressure_drop": 1e-6 * pressure}
    return float(em.leak(RUBBER, ROUGH, **faint).conductance)


def test_without_slip_it_flows_by_the_difference_of_squares():
    """Under a pressure that hardly changes along the seal; else by the integral of
    density times conductance over the pressure of the gas.
    """
    outlet = 1e3
    little = SCENE | {"pressure_drop": 2e3}
    liquid = em.leak(RUBBER, ROUGH, **little)
    gas = em.leak(RUBBER, ROUGH, outlet_pressure=outlet, mean_free_path=0.0, **little)
    squares = ((outlet + 2e3) ** 2 - outlet**2) / (2 * outlet)
    even = 0.1 / 2e-3 * float(liquid.conductance) * squares
    assert gas.rate == pytest.approx(even, rel=3e-3)
    outlet = 101325.0
    gas = em.leak(RUBBER, ROUGH, outlet_pressure=outlet, mean_free_path=0.0, **SCENE)
    whole, _ = quad(lambda p: (1 + p / outlet) * conductance(3e5 - p), 0, 2e5)
    assert gas.rate == pytest.approx(0.1 / 2e-3 * whole, rel=1e-5)
    assert gas.knudsen == 0
    little = SCENE | {"pressure_drop": 1e-3}
    gas = em.leak(RUBBER, ROUGH, outlet_pressure=outlet, mean_free_path=0.0, **little)
    liquid = em.leak(RUBBER, ROUGH, **little)
    assert gas.rate == pytest.approx(float(liquid.rate))
    assert gas.model_error == pytest.approx(float(liquid.model_error), rel=1e-6)


def test_the_temperature_of_a_gas_needs_no_shift_law():
    """A rubber without one is the same at every temperature; the gas is not."""
    rubber = em.StandardSolid(1e6, 3e6, 2.0)
    scene = {name: value for name, value in SCENE.items() if name != "temperature"}
    liquid = em.leak(rubber, ROUGH, **scene)
    cold, warm = (
        em.leak(rubber, ROUGH, temperature=kelvin, **AIR, **scene)
        for kelvin in (293.15, 4 * 293.15)
    )
    assert float(cold.area_ratio) == float(warm.area_ratio) == float(liquid.area_ratio)
    assert float(warm.knudsen / cold.knudsen) == pytest.approx(2.0, rel=1e-12)
    assert "every temperature" in cold.summary()
    with refused("", "shift law"):
        em.leak(rubber, ROUGH, temperature=293.15, **scene)


def test_slip_along_the_seal():
    """The flux of mass is the same at every place: the integral over p of density times
    the conductance with the mean free path there, under what contact bears there.
    """
    gas = em.leak(RUBBER, ROUGH, **AIR, **SCENE)
    per_pressure = 0.02897 / (8.314462618 * 293.15)  # density over pressure

    def of_pressure(p):
        w = conductance(3e5 + 101325.0 - p) * 12 * 1.81e-5
        path = 1.81e-5 / p * np.sqrt(np.pi / (2 * per_pressure))
        return per_pressure * p * (w + 6 * path * w ** (2 / 3)) / (12 * 1.81e-5)

    flux, _ = quad(of_pressure, 101325.0, 301325.0)
    assert gas.mass_rate == pytest.approx(0.1 / 2e-3 * flux, rel=1e-5)
    assert gas.rate == pytest.approx(
        float(gas.mass_rate) / (per_pressure * 101325.0), rel=1e-12
    )
    assert 0.01 < gas.knudsen < 0.1
    assert 6 * gas.knudsen < gas.model_error < np.inf


def test_mean_free_path_of_air():
    """65.4 to 66.5 nm at 20 degC and one atmosphere (Jennings 1988; Willeke 1976)."""
    air = em.leak(RUBBER, ROUGH, **AIR, **SCENE)
    given = {"outlet_pressure": 101325.0, "mean_free_path": 66e-9}
    same = em.leak(RUBBER, ROUGH, **given, **SCENE)
    assert air.knudsen == pytest.approx(float(same.knudsen), rel=0.025)


def test_slip_of_each_gap_on_maps():
    """The gap of even planes has the slip of maps, on which each gap conducts g^3 + 6 l
    g^2: nearly in light contact, and too much of it in heavy contact.
    """
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e4, q_high=16e4)
    shares = []
    for level in (0.005, 0.05):
        gained = []
        for seed in (1, 2):
            heights, side = rough_map(surface, seed, periods=2, points=128)
            gap = pressed(heights, side, level).gap
            w = np.mean(flow(gap).conductance)
            path = 1e-2 * w ** (1 / 3)
            slips = np.mean(flow((gap**3 + 6 * path * gap**2) ** (1 / 3)).conductance)
            gained.append((slips / w - 1) / 6e-2)
        shares.append(np.mean(gained))
    assert shares[0] == pytest.approx(1.0, abs=0.08)
    assert 1 / 1.7 < shares[1] < 1


def test_slip_to_first_order_on_a_map():
    """Against the flow with a small mean free path in every gap."""
    x = np.arange(24) * 2 * np.pi / 24
    gap = np.maximum(0.4 + np.cos(2 * x[:, None]) * np.sin(x - x[:, None]), 0.0)
    found, path = flow(gap), 1e-6
    more = flow((gap**3 + 6 * path * gap**2) ** (1 / 3)).conductance
    slope = (np.array(more) - found.conductance) / path
    assert found.slip == pytest.approx(slope, rel=1e-4)


def test_maps_let_each_gap_slip():
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e4, q_high=8e4)
    scene = SCENE | {"pressure": 8e4, "pressure_drop": 4e4}
    scene |= {"model": em.HalfSpace(cells=128, seeds=1)}
    still, slips = (
        em.leak(RUBBER, surface, outlet_pressure=1e5, mean_free_path=path, **scene)
        for path in (0.0, 5e-8)
    )
    share = (slips.rate / still.rate - 1) / (6 * slips.knudsen)
    assert 1 / 1.7 < share < 1
    assert slips.model_error == 0
    assert not slips.slip_estimated
    assert "each gap" in slips.summary()


def test_no_bound_where_molecules_fly():
    vacuum = em.leak(
        RUBBER, ROUGH, **SCENE | {"pressure_drop": 100.0},
        outlet_pressure=1.0, molar_mass=0.02897,
    )  # fmt: skip
    assert vacuum.knudsen > 1
    assert np.isnan(vacuum.model_error)
    assert vacuum.slip_estimated
    assert "slips (an estimate" in vacuum.summary()
    assert "Knudsen number" in vacuum.summary()


def test_a_closed_seal_leaks_no_gas():
    found = em.leak(RUBBER, ROUGH, **AIR, **SCENE | {"pressure": [3e5, 1e7]})
    assert found.rate[0] > 0
    assert found.rate[1] == found.mass_rate[1] == 0
    assert np.isnan(found.knudsen[1])
    assert found.converged.all()


def test_derivative():
    def rate(outlet):
        given = {"outlet_pressure": outlet, "molar_mass": 0.02897}
        return em.leak(RUBBER, ROUGH, **given, **SCENE).rate

    with jax.enable_x64(True):
        slope = float(jax.jit(jax.grad(rate))(1e5))
    assert slope == pytest.approx((rate(1.001e5) - rate(0.999e5)) / 200, rel=1e-4)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"outlet_pressure": 0.0}, ("outlet_pressure", "absolute pressure")),
        ({"outlet_pressure": -1e5}, ("outlet_pressure", "absolute pressure")),
        ({"outlet_pressure": None}, ("molar_mass", "outlet_pressure", 101325)),
        ({"molar_mass": None}, ("molar_mass", "mean_free_path")),
        ({"mean_free_path": 7e-8}, ("mean_free_path", "molar_mass", 7e-8)),
        ({"mean_free_path": -7e-8, "molar_mass": None}, ("mean_free_path", "zero")),
        ({"molar_mass": -0.03}, ("molar_mass", "positive")),
        ({"temperature": None}, ("temperature", "molar_mass")),
        ({"density": 1.2}, ("density", "molar_mass")),
        ({"pressure_drop": 4e5}, ("pressure_drop", "seal opens")),
    ],
)
def test_bad_input(change, words):
    with refused(*words):
        em.leak(RUBBER, ROUGH, **SCENE | AIR | change)


def test_scene_with_a_molar_mass(tmp_path):
    scene = tmp_path / "gas.toml"
    scene.write_text(
        'material = "epdm-70"\ntemperature = "20 degC"\n[surface]\n'
        'shape = "self_affine"\nhurst = 0.8\nrms_height = "3 um"\n'
        'longest = "200 um"\nshortest = "4 um"\n[leak]\npressure = "0.4 MPa"\n'
        'pressure_drop = "1 bar"\noutlet_pressure = "1 bar"\n'
        'molar_mass = "28.97 g/mol"\nviscosity = "18.1 uPa s"\nlength = "1 mm"\n'
        'time = "1 min"\n',
        encoding="utf-8",
    )
    written: Any = em.leak(**read_scene("leak", scene).arguments(tmp_path))
    found = em.leak(
        em.load_material("epdm-70"),
        em.SelfAffine(
            0.8, rms_height=3e-6, q_low=2 * np.pi / 2e-4, q_high=2 * np.pi / 4e-6
        ),
        pressure=4e5, pressure_drop=1e5, viscosity=1.81e-5, length=1e-3, time=60.0,
        temperature=293.15, outlet_pressure=1e5, molar_mass=0.02897,
    )  # fmt: skip
    assert written.mass_rate == pytest.approx(float(found.mass_rate), rel=1e-9)
