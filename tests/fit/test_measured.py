"""Measured data, where they are: in ELASTOMDR_DATA, or in ../shared/data/dma beside the
checkout. Not part of the package.
"""

import os
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.fit import FitWarning
from elastomdr.fit.isotherms import moduli_exchanged

from ..refused import warned

DATA = Path(
    os.environ.get(
        "ELASTOMDR_DATA", Path(__file__).parents[3] / "shared" / "data" / "dma"
    )
)
LIBRARY = Path(__file__).parents[2] / "materials"
ENCAPSULANT = (19.8691651, 294.681774, 3.33736408e9, 225513873)
pytestmark = [
    # What is doubted is asserted where a test is about it.
    pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning"),
    pytest.mark.skipif(
        not DATA.is_dir(), reason="measured data are not here; set ELASTOMDR_DATA"
    ),
]


def read(*names, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FitWarning)
        return em.read_dma(
            [path for name in names for path in sorted(DATA.glob(name))], **options
        )


@pytest.mark.parametrize(
    ("names", "options", "size", "means"),
    [
        (
            ["epdm-70/tf_015p.csv"],
            {},
            210,
            (11.6650773, 299.927268, 4473894.4, 552220.645),
        ),
        (
            ["epdm-70/sd_10hz.csv"],
            {},
            15,
            (62.8318531, 295.374625, 4787639.5, 542413.91),
        ),
        (
            ["polyisoprene-34k/*.osc"],
            {},
            98,
            (2.29373532, 249.518911, 53632.4099, 87463.4463),
        ),
        (
            ["psa-468mp/frequency_sweep_tts.txt"],
            {},
            339,
            (8.68008885, 323.29471, 282803.86, 140028.64),
        ),
        (
            ["pv-encapsulant/freq_Eplexor_raw.xls"],
            {"kind": "tensile"},
            210,
            ENCAPSULANT,
        ),
        (["pv-encapsulant/freq_user_raw.csv"], {"kind": "tensile"}, 210, ENCAPSULANT),
        (
            ["pv-encapsulant/freq_user_master.csv"],
            {"kind": "tensile", "temperature": 300.0},
            206,
            (0.0335059062, 300, 336761863, 53341032.8),
        ),
    ],
    ids=lambda value: value[0].rpartition("/")[2] if isinstance(value, list) else "",
)
def test_measured_moduli(names, options, size, means):
    """Geometric means; and they are not taken for swapped, and would be if they
    were.
    """
    dma = read(*names, **options)
    assert dma.size == size
    found = [
        np.exp(np.log(x).mean())
        for x in (dma.omega, dma.temperature, dma.storage, dma.loss)
    ]
    np.testing.assert_allclose(found, means, rtol=1e-8)
    assert not moduli_exchanged(dma.temperature, dma.omega, dma.storage, dma.loss)
    if size > 200 and "master" not in names[0]:
        assert moduli_exchanged(dma.temperature, dma.omega, dma.loss, dma.storage)


@pytest.mark.parametrize(
    ("name", "reference", "ends"),
    [
        ("freq_Eplexor_raw__shift_factors.csv", 268.15, (11.1, -19.02)),
        ("freq_user_master__shift_factors.csv", 268.15, (12.75, -11.7)),
        (
            "time_user_raw__shift_factors.csv",
            276.15,
            (12.341761942568635, -16.228168239944775),
        ),
    ],
)
def test_shift_lists(name, reference, ends):
    shift = em.read_shifts(DATA / "pv-encapsulant" / name)
    np.testing.assert_allclose(
        [float(shift.reference), *shift.log10_a_table[[0, -1]]], [reference, *ends]
    )


@pytest.mark.parametrize(
    ("name", "options", "size", "hertz"),
    [
        ("q800.txt", {"kind": "tensile"}, 99, (0.1, 50)),
        ("netzsch.csv", {}, 420, (1, 50)),
        ("twostrains.csv", {}, 198, (0.1, 50)),
        ("tsweep1.csv", {}, 71, (10, 10)),
    ],
)
def test_layouts_of_a_known_rubber(name, options, size, hertz):
    """Each modulus within its noise of 1 % (6 % for a temperature off by 0.1 K) of the
    formula that made the file.
    """
    times = 10.0 ** np.arange(-10, 4)
    moduli = (
        np.array([400, 350, 250, 120, 45, 14, 5, 2.2, 1.2, 0.8, 0.55, 0.4, 0.3, 0.2])
        * 1e6
    )
    law = em.WLF(8.86, 101.6, 273.15)
    dma = read(f"../laboratory/{name}", **options)
    assert dma.size == size
    np.testing.assert_allclose(
        [dma.omega.min(), dma.omega.max()], 2 * np.pi * np.array(hertz)
    )
    log10_a = np.asarray(law.log10_a(dma.temperature)) - float(law.log10_a(293.15))
    reduced = dma.omega * 10**log10_a
    x = reduced[:, None] * times
    storage = 3e6 + (moduli * x**2 / (1 + x**2)).sum(axis=1)
    assert np.median(np.abs(dma.storage / storage - 1)) < 0.1


def test_layout_of_columns_by_temperature():
    dma = read("../laboratory/matrix.csv")
    np.testing.assert_allclose(
        np.unique(dma.temperature.round(6)), 273.15 + np.arange(-40, 81, 20)
    )
    np.testing.assert_allclose(
        [dma.storage[0], dma.loss[0], dma.omega[0]], [426.3e6, 279e6, np.pi]
    )
    np.testing.assert_allclose([dma.storage[-1], dma.loss[-1]], [4.918e6, 0.1148e6])


def test_polyisoprene_follows_the_published_law():
    master = em.fit.master_curve(read("polyisoprene-34k/*.osc"), 263.15)
    published = em.WLF(4.965, 139.3, 298.15).at_reference(263.15)
    assert (
        np.sqrt(
            np.mean(
                (master.log10_a - np.asarray(published.log10_a(master.temperature)))
                ** 2
            )
        )
        < 0.03
    )
    assert float(em.fit.prony(master).material.equilibrium) == 0


@pytest.mark.parametrize("kelvin", [None, 253.15, 263.15])
def test_the_material_of_polyisoprene_follows_it_too(kelvin):
    fit = em.fit.material(read("polyisoprene-34k/*.osc"), kelvin)
    at = fit.master.temperature
    published = (
        em.WLF(4.965, 139.3, 298.15).at_reference(fit.master.reference).log10_a(at)
    )
    for found in (fit.master.log10_a, fit.material.shift.log10_a(at)):
        assert np.sqrt(np.mean((np.asarray(found) - np.asarray(published)) ** 2)) < 0.03
    assert isinstance(fit.material.vertical, em.EntropicVertical)  # a melt
    assert fit.misfit["loss modulus"] < 0.015


@pytest.mark.parametrize("kelvin", [293.15, 298.15])
def test_epdm_is_met_and_judged(kelvin):
    dma = read("epdm-70/tf_015p.csv")
    fit, lifted = (
        em.fit.material(dma, kelvin),
        em.fit.material(dma, kelvin, vertical=True),
    )
    for sizes in (
        (fit.prony.storage_residual, fit.prony.loss_residual),
        fit.misfit.values(),
        (lifted.prony.storage_residual, lifted.prony.loss_residual),
    ):
        storage, loss = sizes
        assert storage < 0.03
        assert loss < 0.08
    assert fit.prony.terms <= 12
    assert fit.material.vertical is None  # as likely as not
    assert lifted.material.vertical is not None
    assert lifted.misfit["storage modulus"] < 1.1 * fit.misfit["storage modulus"]
    for one in (fit, lifted):
        assert one.master.ambiguous[one.master.temperature > 310].all()
        assert any(
            "Horizontal and vertical" in text and "45.98" in text
            for text in one.warnings
        )
        assert any("Not thermorheologically simple" in text for text in one.warnings)
    assert (
        np.abs(lifted.master.log10_a - fit.master.log10_a).max()
        < 1.96 * fit.master.log10_a_std.max()
    )


def test_adhesive_and_its_bad_row():
    with warned(FitWarning, 1, 538, "-29.8"):
        dma = em.read_dma(DATA / "psa-468mp" / "frequency_sweep_tts.txt")
    assert dma.size == 339
    master = em.fit.master_curve(dma, 303.15)
    np.testing.assert_allclose([master.wlf.c1, master.wlf.c2], [8.48, 139.2], rtol=0.05)
    fit = em.fit.prony(master)
    assert fit.storage_residual < 0.1
    assert fit.loss_residual < 0.1
    assert fit.terms <= 1.5 * np.log10(fit.window[1] / fit.window[0])


def test_sheet_and_table_of_the_encapsulant_agree():
    sheet, table = (
        read("pv-encapsulant/freq_Eplexor_raw.xls"),
        read("pv-encapsulant/freq_user_raw.csv"),
    )
    np.testing.assert_allclose(sheet.storage, table.storage, rtol=1e-9)
    np.testing.assert_allclose(sheet.temperature, table.temperature)
    assert sheet.kind == table.kind == "tensile"
    assert read("pv-encapsulant/time_user_raw.csv").time.size == 210


@pytest.mark.parametrize(
    ("name", "file", "kelvin"),
    [
        ("epdm-70", "epdm-70/tf_015p.csv", 298.15),
        ("psa-468mp", "psa-468mp/frequency_sweep_tts.txt", 303.15),
    ],
)
def test_the_library_holds_what_the_tool_makes_of_the_data(
    name, file, kelvin, tmp_path
):
    """benchmarks/fit_library.py writes the same bytes again; another machine may round
    the last digit otherwise.
    """
    fit = em.fit.material(read(file), kelvin, name=name)
    em.save_material(fit.material, tmp_path / "again.toml", info=fit.info())
    again, kept = (
        tomllib.loads((folder / f"{stem}.toml").read_text(encoding="utf-8"))
        for folder, stem in ((tmp_path, "again"), (LIBRARY, name))
    )
    for key in ("equilibrium", "moduli", "times"):
        assert again[key] == pytest.approx(kept[key], rel=1e-4), key
    assert again["shift"] == {
        key: value if isinstance(value, str) else pytest.approx(value, rel=1e-4)
        for key, value in kept["shift"].items()
    }
    assert again["range"]["omega"] == pytest.approx(kept["range"]["omega"], rel=1e-3)
    assert again["source"]["moduli"]["note"] == kept["source"]["moduli"]["note"]
