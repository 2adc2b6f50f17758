"""Strain softening: the class, its place in materials and files, and what it makes of friction on surfaces."""

import re

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.fit.cards import abaqus_card, plain_card
from elastomdr.material.check import check_material
from elastomdr.material.library import load_material, save_material

STRAIN, STORAGE, LOSS = [1e-3, 1e-2, 0.1, 1.0], [1.0, 0.8, 0.5, 0.4], [1.0, 1.3, 0.9, 0.5]
PAYNE = em.Softening(STRAIN, STORAGE, LOSS)


def rubber(**options):
    return em.Prony(1e6, [5e6, 2e7], [1e-5, 1e-3], softening=PAYNE, name="filled", **options)


def test_factors_meet_the_sweep_stay_monotone_and_are_held_beyond_it():
    for factor, given in zip(PAYNE.factors(STRAIN), (STORAGE, LOSS), strict=True):
        np.testing.assert_allclose(factor, given, rtol=1e-14)
    strain = np.geomspace(1e-6, 100.0, 4001)
    storage, loss = PAYNE.factors(strain)
    assert (np.diff(storage) <= 1e-15).all()
    assert (storage[0], storage[-1], loss[-1]) == (1, 0.4, 0.5)
    assert loss.max() == pytest.approx(1.3, abs=1e-5)  # no overshoot between the points
    np.testing.assert_array_equal(PAYNE.outside([1.0, 1.001]), [False, True])


def test_below_its_first_strain_a_sweep_goes_to_one_as_the_strain():
    storage, loss = em.Softening([0.1, 1.0], [0.8, 0.5], [1.2, 0.7]).factors([0.0, 0.05, 0.0999999, 0.1])
    np.testing.assert_allclose(storage, [1.0, 0.9, 0.8, 0.8], rtol=1e-6)
    np.testing.assert_allclose(loss, [1.0, 1.1, 1.2, 1.2], rtol=1e-6)


def test_a_complex_modulus_softens_part_by_part():
    np.testing.assert_allclose(PAYNE.of(2e6 + 1e6j, 0.1), 1e6 + 0.9e6j)


def test_factors_differentiate():
    def value(table, strain):
        return sum(em.Softening(STRAIN, table, LOSS).factors(strain))

    table, strain = np.array(STORAGE), 0.037
    with jax.enable_x64(True):
        by_table, by_strain = jax.grad(value, (0, 1))(table, strain)
    h = 1e-6
    assert by_strain == pytest.approx((value(table, strain + h) - value(table, strain - h)) / (2 * h), rel=1e-6)
    step = h * np.eye(4)[2]
    assert by_table[2] == pytest.approx((value(table + step, strain) - value(table - step, strain)) / (2 * h), rel=1e-6)


@pytest.mark.parametrize(("strain", "storage", "loss", "said"), [
    ([0.1, 1, 10], [1, 0.9, 0.8], [1, 1, 1], "strain must be an amplitude without unit.*got 10; divide per cent"),
    (STRAIN, [1.2, 1, 1, 1], LOSS, "storage must be factors on the modulus of small strain, 1 at most, got 1.2"),
    (STRAIN, [1, 0.8, 0.9, 0.4], LOSS, r"storage must fall .* got 0.8 followed by 0.9 \(entries 1 and 2\)"),
    (STRAIN, [1, 0.8, 0.5, 0], LOSS, "storage must be positive and finite, got 0"),
    (STRAIN, [1, 0.8, 0.5, np.nan], LOSS, "storage must be positive and finite, got nan"),
    (STRAIN, STORAGE, [1, 1, 1, 11], "loss must be factors.*10 at most, got 11"),
    (STRAIN, STORAGE, LOSS[:3], "lists of the same length"),
    ([0.1], [1], [1], "two entries at least"),
    ([0.1, 0.1], [1, 1], [1, 1], "strain must be ascending"),
])  # fmt: skip
def test_bad_sweeps_get_one_clear_line(strain, storage, loss, said):
    with pytest.raises(em.InputError, match=said) as error:
        em.Softening(strain, storage, loss)
    assert str(error.value).startswith("softening: ")
    assert "\n" not in str(error.value)


def test_materials_and_foundations_carry_it():
    table = em.TabulatedModulus([1, 10, 100], [1e6] * 3, [1e5] * 3, softening=PAYNE, shift=em.WLF(5, 100, 293))
    series = rubber(shift=em.WLF(5, 100, 293))
    for material in (series, table, rubber(bulk=2e9, shift=em.WLF(5, 100, 293))):
        changed = material.at(313.0), material.shear(), material.tensile(), em.half_space(material)
        assert all(other.softening is PAYNE for other in changed)
    assert em.KelvinVoigt(1e6, 10.0, softening=PAYNE).softening is PAYNE
    assert em.springs(series, 0.01, bonded=False).softening is PAYNE
    assert em.half_space(rubber(), rubber()).softening is PAYNE
    with pytest.warns(em.ModelWarning, match="taken as linear"):
        assert em.half_space(rubber(), em.Prony(1e6, [], [])).softening is None
    with pytest.raises(em.InputError, match=r"softening must be an em\.Softening"):
        em.Prony(1e6, [], [], softening=0.5)


def test_files_carry_it(tmp_path):
    path = tmp_path / "filled.toml"
    save_material(rubber(), path)
    back = load_material(path).softening
    for key in ("strain", "storage", "loss"):
        np.testing.assert_array_equal(getattr(back, key), getattr(PAYNE, key))
    text = path.read_text()
    assert "factors on the loss modulus" in text
    assert "loss moduli [Pa]" not in text
    path.write_text(text.replace("    0.4,", "    0.6,"))
    with pytest.raises(em.InputError, match=r"filled\.toml: softening: storage must fall"):
        load_material(path)
    path.write_text(re.sub(r"loss = \[.*?\n\][^\n]*\n", "", text, flags=re.DOTALL))
    with pytest.raises(em.InputError, match=r"key 'loss' in \[softening\] is missing"):
        load_material(path)
    path.write_text(text.replace("    1.3,", ""))
    with pytest.raises(em.InputError, match=r"strain, storage and loss in \[softening\] must have the same length"):
        load_material(path)


def test_the_check_wants_its_source_and_a_sweep_from_small_strain(tmp_path):
    path = tmp_path / "filled.toml"
    save_material(em.Prony(1e6, [], [], softening=em.Softening([0.5, 1.0], [0.4, 0.3], [0.9, 0.8])), path)
    findings = "\n".join(check_material(path))
    assert "citation is missing in [source.softening]" in findings
    assert "storage[0] in [softening], at the smallest strain, is 0.4, outside 0.5 to 2" in findings


def test_cards_say_that_they_are_of_small_strain():
    for card in (abaqus_card(rubber()), plain_card(rubber())):
        assert "softening (storage modulus times 0.4 at 1) has no place in this card" in card
