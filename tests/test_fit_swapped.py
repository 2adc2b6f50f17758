"""Storage and loss modulus in each other's place, or in different units: found where no passive material has them, and
nowhere else.
"""

import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.fit import FitWarning
from elastomdr.fit.reading.swapped import look_swapped, other_readings

from .dma_files import KNOWN, data, isotherms, measure, plain_csv, reptate, trios, two_rows

LAW = em.WLF(7.0, 120.0, 293.15)
MELT = em.Prony(0.0, [1e9, 1e8, 1e6, 3e5, 3e5], [1e-9, 1e-7, 1e-5, 1e-3, 1e-2], shift=LAW)  # ends as omega^2, omega
BRANCHES = np.geomspace(1e-9, 1e3, 25)
GLASS = em.Prony(1e9, np.full(25, 1e7), BRANCHES, shift=LAW)  # tan delta of 0.01
FILLED = em.Prony(4e6, 4e5 * BRANCHES**-0.05, BRANCHES, shift=LAW)
MATERIALS = {"melt": MELT, "glass": GLASS, "filled": FILLED, "gum": KNOWN}
CELSIUS = np.array([-20.0, 0.0, 20.0, 60.0])


def swap(dma):
    return look_swapped(dma.temperature, dma.frequency, dma.loss, dma.storage)


@pytest.mark.parametrize("noise", [0.002, 0.05])
@pytest.mark.parametrize("name", MATERIALS)
def test_passive_materials_are_told_from_swapped_ones(name, noise):
    for seed, decades in enumerate((0.7, 1.0, 2.0, 3.0)):
        for count in (5, 20):
            hertz = np.geomspace(0.1, 0.1 * 10**decades, count)
            dma = data(CELSIUS, noise, seed, MATERIALS[name], hertz=hertz)
            assert other_readings(dma.temperature, dma.frequency, dma.storage, dma.loss) == []
            assert swap(dma)


@pytest.mark.parametrize(
    ("name", "factors"),
    [("melt", (1e3, 1e-3, 10.0)), ("gum", (1e3, 10.0)), ("filled", (1e3, 10.0)), ("glass", (1e3,))],
)
def test_a_loss_modulus_in_another_unit_is_found(name, factors):
    """Low loss too: a tangent of 0.03 that becomes 30 is none that the median of a file could not have."""
    for seed, decades in enumerate((1.0, 2.7)):
        dma = data(CELSIUS, 0.01, seed, MATERIALS[name], hertz=np.geomspace(0.1, 0.1 * 10**decades, 12))
        for factor in factors:
            found = other_readings(dma.temperature, dma.frequency, dma.storage, factor * dma.loss)
            assert found == [factor] or (name == "glass" and set(found) <= {None, factor})  # both moduli are flat
            assert factor in found


def test_mixed_up_units_are_said_and_no_diagnosis_is_made_of_them(tmp_path):
    """kPa under a title of MPa, in a rubber of low loss: one warning, and none that blames material or terms."""
    rows = measure(FILLED, CELSIUS, np.geomspace(0.1, 50.0, 10), 0.01)
    assert 0.02 < np.median(rows[:, 3] / rows[:, 2]) < 0.1
    rows[:, 3] *= 1000
    with pytest.warns(
        FitWarning, match=r"one if the loss modulus is 1000 times smaller: are their units mixed up\? Assumed"
    ):
        dma = em.fit.read_dma(plain_csv(tmp_path, rows))
    assert dma.doubtful
    assert len(dma.warnings) == 1
    assert "in Pa and 'G_loss_pa' in Pa" in dma.warnings[0]
    assert em.fit.join(em.fit.dma([1.0], [1e6], [1e5], 293.15, kind="shear"), dma).doubtful
    fit = em.fit.material(dma, 293.15)
    for wrong in ("Not thermorheologically simple", "more terms may help", "data scatter", "contradict"):
        assert not any(wrong in text for text in fit.warnings)
    said = [text for text in fit.warnings if "look misread (columns or units), which is to be put right first" in text]
    assert [text.split(" ", 3)[:3] for text in said] == [
        ["No", "shift", "makes"], ["The", "storage", "modulus"], ["The", "loss", "modulus"]
    ]  # fmt: skip


def test_what_cannot_be_told_is_not_said():
    """G' and G'' as the square root of the frequency are alike; at one frequency or two points nothing is seen."""
    omega = np.geomspace(0.1, 100, 20)
    rouse = 1e5 * np.sqrt(omega)
    assert not look_swapped(np.full(20, 300.0), omega, rouse, rouse)
    assert not look_swapped(np.arange(20) + 200.0, np.full(20, 6.28), rouse, 10 * rouse)  # a ramp
    assert not look_swapped(np.full(2, 300.0), omega[[0, -1]], np.array([1e5, 1.1e5]), np.array([1e6, 1e6]))


def test_damaged_numbers_do_no_harm():
    rng = np.random.default_rng(0)
    for _ in range(20):
        omega, storage, loss = 10 ** rng.uniform(-290, 290, (3, 12))
        kelvin = np.array(6 * [300.0] + 6 * [1e304])
        look_swapped(kelvin, np.sort(omega), storage, loss)  # without an error or a warning


def test_noise_and_ramps_are_no_reason():
    """Three frequencies through the glass transition: isotherms several kelvins wide, 5 % of noise."""
    kelvin = np.repeat(np.arange(243.0, 333.0, 0.4), 3)
    omega = 2 * np.pi * np.tile([0.5, 5.0, 50.0], kelvin.size // 3)
    moduli = np.asarray(MELT.at(293.15).complex_modulus(omega * 10 ** np.asarray(LAW.log10_a(kelvin))))
    noise = 1 + 0.05 * np.random.default_rng(0).normal(size=(2, kelvin.size))
    assert not look_swapped(kelvin, omega, moduli.real * noise[0], moduli.imag * noise[1])


@pytest.mark.parametrize("writer", [plain_csv, two_rows, trios, reptate], ids=lambda writer: writer.__name__)
def test_a_file_with_swapped_titles_gets_one_warning_that_says_how_to_swap_them(writer, tmp_path):
    rows = measure(KNOWN)
    swapped = np.concatenate([part[:, [0, 1, 3, 2]] for part in isotherms(rows)])
    with pytest.warns(FitWarning, match="look exchanged: no passive material .* Assumed are the names") as caught:
        dma = em.fit.read_dma(writer(tmp_path, swapped))
    assert len([text for text in dma.warnings if "look exchanged" in text]) == 1
    np.testing.assert_allclose(dma.storage, rows[:, 3], rtol=1e-5)
    text = next(str(warning.message) for warning in caught if "look exchanged" in str(warning.message))
    columns = eval(text.split("columns=")[1].split(" (")[0])
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the loss tangent ")  # of TRIOS: a column of its own, which contradicts now
        again = em.fit.read_dma(sorted({*writer(tmp_path, swapped)}), columns=columns)
    assert again.kind == "shear"
    np.testing.assert_allclose(np.sort(again.storage), np.sort(rows[:, 2]), rtol=1e-5)


def test_a_damaged_modulus_is_no_overflow():
    """In multiples of it neither."""
    omega, storage = np.geomspace(0.1, 100, 12), np.geomspace(1e5, 1e7, 12)
    loss = 0.3 * storage
    loss[3] = 1e306
    assert not look_swapped(np.full(12, 293.15), omega, storage, loss)
