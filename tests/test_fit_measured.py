"""Measured data, where they are: in ELASTOMDR_DATA, or in ../shared/data/dma beside the checkout. Not part of
the package.
"""

import os
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.fit import FitWarning
from elastomdr.fit.reading.columns import Column
from elastomdr.fit.reading.misread import misread
from elastomdr.fit.reading.swapped import look_swapped, other_readings

DATA = Path(os.environ.get("ELASTOMDR_DATA", Path(__file__).parents[2] / "shared" / "data" / "dma"))
LIBRARY = Path(__file__).parents[1] / "materials"
pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason="measured data are not here; set ELASTOMDR_DATA")


def read(*names, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FitWarning)
        return em.fit.read_dma([path for name in names for path in sorted(DATA.glob(name))], **options)


@pytest.mark.parametrize(
    ("names", "options"),
    [
        (["epdm-70/tf_015p.csv", "epdm-70/sd_10hz.csv"], {}),
        (["polyisoprene-34k/*.osc"], {}),
        (["psa-468mp/frequency_sweep_tts.txt"], {}),
        (["pv-encapsulant/freq_Eplexor_raw.xls", "pv-encapsulant/freq_user_raw.csv"], {"kind": "tensile"}),
        (["pv-encapsulant/freq_user_master.csv"], {"kind": "tensile", "temperature": 300.0}),
    ],
    ids=lambda value: value[0].split("/")[0] if isinstance(value, list) else "",
)
def test_measured_moduli_are_not_taken_for_swapped_and_would_be_found(names, options):
    dma = read(*names, **options)
    assert not dma.doubtful
    assert not any("look exchanged" in text or "mixed up" in text for text in dma.warnings)
    for factor in (1e3, 10.0):
        mixed = other_readings(dma.temperature, dma.frequency, dma.storage, factor * dma.loss)
        assert mixed == [factor] or "master" in names[0]  # which contradicts itself
    assert look_swapped(dma.temperature, dma.frequency, dma.loss, dma.storage)
    tangent = dma.loss / dma.storage
    rows = {"omega": dma.frequency, "temperature": dma.temperature, "storage": dma.storage, "tangent": tangent}
    titles = {role: Column(0, role, role, "", "") for role in rows}
    assert not list(misread(rows, titles, {"tangent": ""}))
    assert list(misread(rows | {"tangent": 100 * tangent}, titles, {"tangent": ""}))


def test_polyisoprene_follows_the_published_law():
    master = em.fit.master_curve(read("polyisoprene-34k/*.osc"), 263.15)
    published = em.WLF(4.965, 139.3, 298.15).at_reference(263.15)
    assert np.sqrt(np.mean((master.log10_a - np.asarray(published.log10_a(master.temperature))) ** 2)) < 0.03
    assert float(em.fit.prony(master).material.equilibrium) == 0


@pytest.mark.parametrize("kelvin", [None, 253.15, 263.15])
def test_the_material_of_polyisoprene_follows_it_too(kelvin):
    fit = em.fit.material(read("polyisoprene-34k/*.osc"), kelvin)
    at = fit.master.temperature
    published = em.WLF(4.965, 139.3, 298.15).at_reference(fit.master.reference).log10_a(at)
    for found in (fit.master.log10_a, fit.material.shift.log10_a(at)):
        assert np.sqrt(np.mean((np.asarray(found) - np.asarray(published)) ** 2)) < 0.03
    assert any("The data leave no doubt of them" in text for text in fit.warnings)


@pytest.mark.parametrize("kelvin", [293.15, 298.15])
def test_epdm_is_met_and_judged(kelvin):
    dma = read("epdm-70/tf_015p.csv")
    fit, lifted = em.fit.material(dma, kelvin), em.fit.material(dma, kelvin, vertical=True)
    for sizes in ((fit.prony.storage_residual, fit.prony.loss_residual), fit.as_used.values(),
                  (lifted.prony.storage_residual, lifted.prony.loss_residual)):  # fmt: skip
        storage, loss = sizes
        assert storage < 0.03
        assert loss < 0.08
    assert fit.prony.terms <= 12
    assert lifted.as_used["storage modulus"] > 0.04  # so that the material without vertical shifts is the default
    for one in (fit, lifted):
        assert one.master.ambiguous[one.master.temperature > 310].all()
        assert any("Horizontal and vertical" in text and "45.98" in text for text in one.warnings)
        assert any("Not thermorheologically simple" in text for text in one.warnings)
    assert any(text.startswith("Fitted without vertical shifts") for text in fit.warnings)
    assert np.abs(lifted.master.log10_a - fit.master.log10_a).max() < 1.96 * fit.master.log10_a_std.max()


def test_adhesive_and_its_bad_row():
    with pytest.warns(FitWarning, match="1 row left out: line 538: Loss modulus is -29.8"):
        dma = em.fit.read_dma(DATA / "psa-468mp" / "frequency_sweep_tts.txt")
    assert dma.size == 339
    master = em.fit.master_curve(dma, 303.15)
    np.testing.assert_allclose([master.wlf.c1, master.wlf.c2], [8.48, 139.2], rtol=0.05)
    fit = em.fit.prony(master)
    assert fit.storage_residual < 0.1
    assert fit.loss_residual < 0.1
    assert fit.terms <= 1.5 * np.log10(fit.window[1] / fit.window[0])


def test_sheet_and_table_of_the_encapsulant_agree():
    sheet, table = read("pv-encapsulant/freq_Eplexor_raw.xls"), read("pv-encapsulant/freq_user_raw.csv")
    np.testing.assert_allclose(sheet.storage, table.storage, rtol=1e-9)
    np.testing.assert_allclose(sheet.temperature, table.temperature)
    assert sheet.kind == table.kind == "tensile"
    assert read("pv-encapsulant/time_user_raw.csv").time.size == 210


@pytest.mark.parametrize(
    ("name", "file", "kelvin"),
    [("epdm-70", "epdm-70/tf_015p.csv", 298.15), ("psa-468mp", "psa-468mp/frequency_sweep_tts.txt", 303.15)],
)
def test_the_library_holds_what_the_tool_makes_of_the_data(name, file, kelvin, tmp_path):
    """benchmarks/fit_library.py writes the same bytes again; another machine may round the last digit otherwise."""
    fit = em.fit.material(read(file), kelvin, name=name)
    em.save_material(fit.material, tmp_path / "again.toml", info=fit.info())
    again, kept = (
        tomllib.loads((folder / f"{stem}.toml").read_text(encoding="utf-8"))
        for folder, stem in ((tmp_path, "again"), (LIBRARY, name))
    )
    for key in ("equilibrium", "moduli", "times"):
        assert again[key] == pytest.approx(kept[key], rel=1e-4), key
    assert again["shift"] == {
        key: value if isinstance(value, str) else pytest.approx(value, rel=1e-4) for key, value in kept["shift"].items()
    }
    assert again["range"]["frequency"] == pytest.approx(kept["range"]["frequency"], rel=1e-3)
    assert again["source"]["moduli"]["note"] == kept["source"]["moduli"]["note"]
