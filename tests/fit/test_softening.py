"""Softening from strain sweeps: known factors found again, sweeps joined, a table, what
is undecided, a real sweep.
"""

import csv
import os
from pathlib import Path

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")

TRUTH = {"drop": 0.6, "strain": 0.01, "exponent": 0.55, "rise": 0.8}
DATA = Path(
    os.environ.get(
        "ELASTOMDR_DATA", Path(__file__).parents[3] / "shared" / "data" / "dma"
    )
)
SWEEP = DATA / "epdm-70" / "sd_10hz.csv"


def factors(strain, drop=0.6, middle=0.01, exponent=0.55, rise=0.8):
    """Kraus 1984, written about the moduli of small strain."""
    x = strain / middle
    return (
        1 - drop + drop / (1 + x ** (2 * exponent)),
        1 + rise * 2 * x**exponent / (1 + x ** (2 * exponent)),
    )


def sweep(noise=0.0, seed=0, count=24, last=0.5, small=(5e6, 4e5)):
    rng = np.random.default_rng(seed)
    strain = np.geomspace(2e-5, last, count)
    f, g = factors(strain)
    return {
        "strain": strain,
        "storage": small[0] * f * np.exp(noise * rng.normal(size=count)),
        "loss": small[1] * g * np.exp(2 * noise * rng.normal(size=count)),
    }


def test_without_noise_the_factors_come_back():
    found = em.fit.softening(sweep())
    assert isinstance(found, em.Softening)
    for name, value in TRUTH.items():
        assert found.parameters[name] == pytest.approx(value, rel=1e-5), name
    strain = np.geomspace(1e-5, 0.5, 50)
    f, g = factors(strain)
    assert np.abs(found.factors(strain)[0] - f).max() < 5e-4
    assert np.abs(found.factors(strain)[1] - g).max() < 5e-3
    assert found.sweeps.small == pytest.approx(np.array([[5e6, 4e5]]), rel=1e-5)
    assert found.warnings == ()
    rubber = em.StandardSolid(1e6, 1e6, 1.0, softening=found)
    assert rubber.softening is found
    assert np.isfinite(jax.jit(lambda m: m.softening.factors(0.01)[0])(rubber))


def test_intervals_hold_the_truth_about_as_often_as_they_say():
    inside = []
    for seed in range(40):
        found = em.fit.softening(sweep(0.01, seed))
        inside += [
            found.interval[name][0] <= value <= found.interval[name][1]
            for name, value in TRUTH.items()
        ]
    assert 0.87 <= np.mean(inside) <= 0.995  # of 160, that depend on each other


def test_sweeps_at_several_temperatures_and_frequencies_are_joined():
    """Each of a third of the strains: no sweep sees both ends of the fall."""
    parts = []
    for i, (kelvin, hertz, small) in enumerate(
        (
            (283.15, 1.0, (7e6, 9e5)),
            (313.15, 10.0, (4e6, 2e5)),
            (283.15, 10.0, (8e6, 1e6)),
        )
    ):
        part = sweep(0.003, i, 36, small=small)
        kept = slice(8 * i, 8 * i + 20)
        rows = {name: values[kept] for name, values in part.items()}
        parts.append(
            {
                **rows,
                "temperature": np.full(20, kelvin),
                "omega": np.full(20, 2 * np.pi * hertz),
            }
        )
    mixed = np.random.default_rng(0).permutation(60)
    joined = {
        name: np.concatenate([part[name] for part in parts])[mixed] for name in parts[0]
    }
    found = em.fit.softening(joined)
    assert found.sweeps.omega.size == 3
    for name, value in TRUTH.items():
        assert found.interval[name][0] <= value <= found.interval[name][1], name
        assert found.parameters[name] == pytest.approx(value, rel=0.1)
    assert sorted(found.sweeps.small[:, 0]) == pytest.approx([4e6, 7e6, 8e6], rel=0.02)
    assert found.warnings == ()
    another = {**parts[1], "storage": parts[1]["storage"] * parts[1]["strain"] ** 0.1}
    with_it = {name: np.concatenate([joined[name], another[name]]) for name in joined}
    with_it["omega"][-20:] *= 10
    assert "does not follow" in " ".join(em.fit.softening(with_it).warnings)


def test_a_table_takes_the_factors_as_measured():
    found = em.fit.softening(sweep(0.01, 1, 40), form="table")
    f, g = factors(np.asarray(found.strain))
    assert np.all(np.diff(found.storage) <= 0)
    assert 16 <= found.strain.size <= 18  # four to a decade
    assert np.abs(found.storage - f).max() < 0.02
    assert np.abs(found.loss / g - 1).max() < 0.05


def test_what_a_short_sweep_cannot_decide_is_said():
    short = em.fit.softening(sweep(0.005, 0, 20, last=0.01))
    assert "still falls" in " ".join(short.warnings)
    assert short.strain[-1] == pytest.approx(0.01)
    wide = {name: values[9:] for name, values in sweep(0.005, 0, 20).items()}
    assert "softened already" in " ".join(em.fit.softening(wide).warnings)


def test_it_has_words_a_table_and_a_figure(tmp_path):
    found = em.fit.softening(sweep(0.01))
    for text in ("drop", "exponent", "Student", "24 points of 1 sweeps"):
        assert text in repr(found)
    found.to_csv(tmp_path / "s.csv")
    rows = [
        row
        for row in (tmp_path / "s.csv").read_text(encoding="utf-8").splitlines()
        if row[0] != "#"
    ]
    assert len(rows) == 25
    assert found.plot().get_xlabel() == "Strain amplitude [%]"


def test_bad_input_is_one_clear_line():
    good = sweep()
    for data, named in (
        ({**good, "strain": 100 * good["strain"]}, "per cent"),
        ({name: values[:3] for name, values in good.items()}, "four points"),
        ({**good, "loss": good["loss"][:5]}, "loss"),
        ({**good, "storage": -good["storage"]}, "storage"),
        ({**good, "temperature": [293.15, 303.15]}, "temperature"),
        ({"strain": good["strain"]}, "strain_sweep"),
        (
            em.fit.dma(
                good["strain"], good["storage"], good["loss"], 293.15, kind="shear"
            ),
            "strain",
        ),
        ([1.0, 2.0], "strain_sweep"),
    ):
        with pytest.raises(InputError, match=named) as caught:
            em.fit.softening(data)
        assert "\n" not in str(caught.value)
    assert caught.value.got == [1.0, 2.0]
    with pytest.raises(InputError, match="form"):
        em.fit.softening(good, form="cubic")


@pytest.mark.skipif(
    not SWEEP.exists(), reason="measured data are not part of the package"
)
def test_a_measured_sweep_of_a_filled_rubber():
    rows = list(csv.DictReader(SWEEP.read_text(encoding="utf-8").splitlines()))
    columns = {
        "strain": "strain_dyn_pct",
        "storage": "G_storage_pa",
        "loss": "G_loss_pa",
        "temperature": "temperature_C",
        "omega": "freq_hz",
    }
    data = {
        name: np.array([float(row[title]) for row in rows])
        for name, title in columns.items()
    }
    data["strain"], data["temperature"], data["omega"] = (
        data["strain"] / 100,
        data["temperature"] + 273.15,
        2 * np.pi * data["omega"],
    )
    found = em.fit.softening(data)
    f, g = found.factors(0.01)
    assert 0.77 < f < 0.83  # 5.2 to 4.2 MPa
    assert 2.0 < g < 3.2
    assert "still falls" in " ".join(found.warnings)  # the sweep ends at 1.1 %
