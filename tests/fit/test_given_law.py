"""Shift laws that the user gives: temperature sweeps at one frequency, factors shifted
by hand, the universal law.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.fit import law_of
from elastomdr.cli.main import main

from ..io.dma_files import data, measure
from ..material.check import check_material
from ..refused import refused

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")

GLASS = 213.15  # K
LAW = em.WLF(17.44, 51.6, GLASS)
TAU = np.geomspace(1e-10, 1e3, 14)
RUBBER = em.Prony(
    1e6,
    np.array([400, 350, 250, 120, 45, 14, 5, 2.2, 1.2, 0.8, 0.55, 0.4, 0.3, 0.2]) * 1e6,
    TAU,
    shift=LAW.at_reference(293.15),
)


def sweep(hertz=(10.0,), noise=0.01):
    f, t, s, l = measure(RUBBER, np.arange(-50.0, 61.0, 2.0), np.array(hertz), noise).T
    return em.fit.dma(2 * np.pi * f, s, l, t + 273.15, kind="shear")


def off(fit, kelvin=293.15, cut=1.0):
    """Largest relative error of storage and loss modulus over the window, without its
    fast end.
    """
    low, high = fit.master.window
    omega = np.geomspace(low, high**cut * low ** (1 - cut), 40)
    found, true = (
        np.asarray(one.at(kelvin).complex_modulus(omega))
        for one in (fit.material, RUBBER)
    )
    return np.abs(found.real / true.real - 1).max(), np.abs(
        found.imag / true.imag - 1
    ).max()


def test_a_temperature_sweep_at_one_frequency_needs_a_law():
    with refused("dma", "--shift", "'WLF(8.86, 101.6, 20degC)'"):
        em.fit.material(sweep())
    fit = em.fit.material(sweep(), 293.15, shift=LAW)
    assert max(off(fit)) < 0.05
    assert (fit.law, fit.master.laws) == ("given", {})
    np.testing.assert_allclose(
        fit.material.shift.log10_a(273.15), RUBBER.shift.log10_a(273.15), rtol=1e-9
    )
    np.testing.assert_allclose(
        fit.master.log10_a, RUBBER.shift.log10_a(fit.master.temperature), atol=1e-6
    )


@pytest.mark.parametrize(
    "law",
    [
        em.VFT(np.log(10) * LAW.c1 * LAW.c2, LAW.reference - LAW.c2, LAW.reference),
        em.ShiftTable(
            np.arange(223.15, 334, 2), LAW.log10_a(np.arange(223.15, 334, 2))
        ),
    ],
)
def test_laws_of_other_kinds(law):
    fit = em.fit.material(sweep(), 293.15, shift=law)
    assert max(off(fit)) < 0.05
    assert float(fit.material.shift.log10_a(293.15)) == pytest.approx(0.0, abs=1e-9)


def test_the_universal_law_finds_its_glass_temperature(tmp_path):
    """From storage and loss modulus, which a passive material cannot have apart; graded
    as an estimate.
    """
    fit = em.fit.material(sweep(), 293.15, shift="universal")
    assert float(fit.material.shift.reference - fit.material.shift.c2) == pytest.approx(
        GLASS - 51.6, abs=1.0
    )
    assert off(fit, cut=0.8)[0] < 0.1
    fit.save(tmp_path)
    assert check_material(tmp_path / "arrays.toml") == []
    assert 'grade = "estimated"' in (tmp_path / "arrays.toml").read_text()
    plateau = em.Prony(1e6, [1e5], [1e-3])
    t = np.arange(263.15, 330, 3)
    flat = plateau.complex_modulus(10.0) * np.ones(t.size)
    with refused("shift", "reference temperature"):
        em.fit.material(
            em.fit.dma(np.full(t.size, 10.0), flat.real, flat.imag, t, kind="shear"),
            shift="universal",
        )


def test_with_several_frequencies_the_law_is_found():
    fit = em.fit.material(sweep((1.0, 10.0, 50.0)), 293.15)
    assert max(off(fit)) < 0.12


def test_isotherms_along_a_law_keep_its_factors():
    """Also factors shifted by hand that are off: nobody corrects them."""
    dma = data()
    kelvin = np.unique(dma.temperature)
    by_hand = em.ShiftTable(kelvin, 0.1 + em.WLF(7.5, 120.0, 293.15).log10_a(kelvin))
    fit = em.fit.material(dma, 293.15, shift=by_hand)
    np.testing.assert_allclose(
        fit.master.log10_a, by_hand.log10_a(kelvin) - by_hand.log10_a(293.15), atol=1e-6
    )
    np.testing.assert_allclose(
        fit.material.shift.log10_a(kelvin), fit.master.log10_a, atol=1e-6
    )
    with refused("shift", "temperatures of the data"):
        em.fit.material(dma, 293.15, shift=em.ShiftTable([280.0, 300.0], [1.0, 0.0]))
    with refused("law", "left out"):
        em.fit.material(dma, 293.15, shift=by_hand, law="WLF")
    with refused("shift", "law"):
        em.fit.material(dma, 293.15, shift="WLF")


def test_swapped_moduli_of_a_temperature_sweep_are_refused():
    one = sweep()
    swapped = em.fit.dma(
        one.omega, one.loss, one.storage, one.temperature, kind="shear"
    )
    with pytest.raises(em.InputError, match="look exchanged"):
        em.fit.material(swapped, shift=LAW)


def test_the_command_line(tmp_path, monkeypatch, capsys):
    dma = sweep()
    rows = [
        f"{t - 273.15:.6g},{s:.8g},{l:.8g}"
        for t, s, l in zip(dma.temperature, dma.storage, dma.loss, strict=True)
    ]
    (tmp_path / "sweep.csv").write_text("T [degC],G' [Pa],G'' [Pa]\n" + "\n".join(rows))
    kelvin = np.arange(223.15, 334, 10)
    factors = [
        f"{t - 273.15:.6g},{x:.8g}"
        for t, x in zip(kelvin, LAW.log10_a(kelvin), strict=True)
    ]
    (tmp_path / "factors.csv").write_text("T [degC],log_aT\n" + "\n".join(factors))
    monkeypatch.chdir(tmp_path)
    base = ["fit", "sweep.csv", "--column", "frequency=10 Hz", "--reference", "20degC"]
    assert main(base) == 2
    assert "--shift universal" in capsys.readouterr().err
    for law in ("factors.csv", "universal"):
        assert main([*base, "--shift", law, "--verbose"]) == 0
        assert "shift factors" in capsys.readouterr().out
    for wrong, said in (
        ("WLF(1, 2)", "WLF(8.9, 101.6, 20degC)"),
        ("Arrhenius(80, 20degC)", "80 kJ/mol"),
        ("x.csv", "x.csv"),
    ):
        assert main([*base, "--shift", wrong]) == 2
        assert said in capsys.readouterr().err
    assert float(law_of("Arrhenius(80 kJ/mol, 20degC)")[0].energy) == 8e4
    assert float(law_of("WLF(17.44, 51.6, -60degC)")[0].c2) == 51.6
    assert float(law_of("VFT(1000 K, -100 degC, 20)")[0].t0) == pytest.approx(173.15)
