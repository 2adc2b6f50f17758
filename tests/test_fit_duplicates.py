"""Several columns of one quantity: one is taken, what contradicts it is named; and what was read is said."""

import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.fit import FitWarning

from .dma_files import KNOWN, measure, plain_csv

F, T, S, L = measure(KNOWN, np.array([0.0, 20.0]), np.geomspace(0.1, 10, 6)).T


def table(**columns):
    rows = zip(*columns.values(), strict=True)
    return "\n".join([",".join(columns), *(",".join(f"{x:.12g}" for x in row) for row in rows)])


def plain(**more):
    return table(**{"T [degC]": T, "f [Hz]": F, "G' [Pa]": S, "G'' [Pa]": L}, **more)


@pytest.mark.parametrize(
    "more",
    [
        {"Temperature [K]": T + 273.15},
        {"Set temp [degC]": T + 0.4},
        {"frequency [Hz]": F * 1.001},
        {"Storage modulus [MPa]": S / 1e6, "loss modulus [kPa]": L / 1e3},
        {"log10 G' [Pa]": np.log10(S)},
        {"E' [Pa]": 3 * S},
        {"storage": np.ones(F.size)},
    ],
    ids=lambda more: next(iter(more)),
)
def test_columns_that_agree_or_say_nothing_pass_without_a_word(more, write):
    with warnings.catch_warnings():
        warnings.simplefilter("error", FitWarning)
        dma = em.fit.read_dma(write(plain(**more)), kind="shear")
    np.testing.assert_allclose(dma.storage, S, rtol=1e-9)
    assert f"passed over: 5 '{next(iter(more))}'".replace("'", '"') in dma.columns[0].replace("'", '"')


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"Temperature [K]": T + 373.15}, r"columns 1 'T .degC.' and 5 'Temperature .K.' both hold .* differ by 100 K"),
        (
            {"frequency [Hz]": 2 * F},
            r"columns 2 .* and 5 'frequency .Hz.' both hold frequency and differ by a factor of 2",
        ),
        ({"frequency [Hz]": 1 + 0 * F}, "both hold frequency"),
        ({"Storage modulus [Pa]": 0.5 * S}, r"by a factor of 2 .* Taken is column 3; .* \(--column storage=5\)"),
        ({"G'' [kPa]": L}, r"columns 4 .* and 5 .* factor of 1e\+03"),
    ],
)
def test_columns_that_contradict_each_other_are_named(more, said, write):
    with pytest.warns(FitWarning, match=said):
        dma = em.fit.read_dma(write(plain(**more)))
    np.testing.assert_allclose(dma.storage, S, rtol=1e-9)
    place = 5 if "storage=5" in said else None
    if place:
        with warnings.catch_warnings():
            warnings.simplefilter("error", FitWarning)
            assert em.fit.read_dma(write(plain(**more)), columns={"storage": place}).size == F.size


@pytest.mark.parametrize("first", ["Temperature [degC]", "Set temperature [degC]", "Program temp. [degC]"])
def test_the_temperature_of_the_sample_goes_before_others(first, write):
    moduli = {"f [Hz]": F, "G' [Pa]": S, "G'' [Pa]": L}
    for more in (0.5, 15.0):
        path = write(table(**{first: T, "Sample temperature [degC]": T + more}, **moduli))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            dma = em.fit.read_dma(path)
        np.testing.assert_allclose(dma.temperature, T + more + 273.15)
        assert len(caught) == (more > 3)
    assert "'Sample temperature [degC]' and 1" in str(caught[0].message)
    assert "Taken is column 2" in str(caught[0].message)


def test_a_programmed_temperature_serves_where_there_is_no_other(write):
    dma = em.fit.read_dma(write(table(**{"Set temp [degC]": T, "f [Hz]": F, "G' [Pa]": S, "G'' [Pa]": L})))
    np.testing.assert_allclose(dma.temperature, T + 273.15)


def test_the_command_says_what_was_read(tmp_path, monkeypatch, capsys):
    plain_csv(tmp_path, measure(KNOWN))
    monkeypatch.chdir(tmp_path)
    assert main(["fit", "plain.csv", "--reference", "-5degC"]) == 0
    out = capsys.readouterr().out
    assert "columns         frequency from 1 'freq_hz', storage from 3 'G_storage_pa', loss from 4 'G_loss_pa', " in out


def test_files_that_differ_are_told_apart(write):
    one = write(plain(**{"strain [%]": F}), "one.csv")
    two = write(plain(), "two.csv")
    dma = em.fit.read_dma([one, two])
    assert [text[:9] for text in dma.columns] == ["one.csv: ", "two.csv: "]


def test_logarithms_under_a_plain_title_are_said(write):
    """Numbers of log10 Pa called MPa, and the moduli of a real rubber that happen to be as large in MPa."""
    moduli = {"T [degC]": T, "f [Hz]": F, "G' [MPa]": np.log10(S), "G'' [MPa]": np.log10(L)}
    with pytest.warns(
        FitWarning, match="and one if they are decadic logarithms of moduli in Pa. Assumed are the names"
    ):
        em.fit.read_dma(write(table(**moduli)))
    with warnings.catch_warnings():
        warnings.simplefilter("error", FitWarning)
        for factor in (4e6 / S.min(), 2.5e6 / L.min()):
            named = {"G' [MPa]": factor * S / 1e6, "G'' [MPa]": factor * L / 1e6}
            em.fit.read_dma(write(table(**{"T [degC]": T, "f [Hz]": F}, **named)))


@pytest.mark.parametrize("part", [0.0, 0.5])
def test_the_temperature_of_the_sample_needs_its_numbers(part, write):
    """A column of it that is empty, or has holes, gives way to one that is whole."""
    cells = [f"{x:g}" if i < part * T.size else "" for i, x in enumerate(T)]
    rows = plain().splitlines()
    text = [f"{rows[0]},Sample temperature [degC]", *(f"{a},{b}" for a, b in zip(rows[1:], cells, strict=True))]
    dma = em.fit.read_dma(write("\n".join(text)))
    np.testing.assert_allclose(dma.temperature, T + 273.15)
    assert dma.bad_rows == ()
