"""Lines of titles: comment marks, titles with blanks in them above rows that are cut at blanks, and what is refused."""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit import FitWarning

ROWS = np.array([(-20, 0.1, 2e6, 4e5), (-20, 1, 3e6, 6e5), (0, 0.1, 1e6, 1e5), (0, 1, 1.1e6, 1.5e5)])


def read(path):
    dma = em.fit.read_dma(path)
    np.testing.assert_allclose(dma.temperature, ROWS[:, 0] + 273.15)
    np.testing.assert_allclose(dma.frequency, 2 * np.pi * ROWS[:, 1])
    np.testing.assert_allclose([dma.storage, dma.loss], ROWS[:, 2:].T)
    return dma


@pytest.mark.parametrize(
    ("delimiter", "header"),
    [
        (" ", "T[degC] f[Hz] G'[Pa] G''[Pa] |G*|[Pa]"),
        (" ", "T [degC] f [Hz] G' [Pa] G'' [Pa] |G*| [Pa]"),
        (" ", "Temperature (degC)  Frequency (Hz)  Storage modulus G' (Pa)  Loss modulus G'' (Pa)  tan delta"),
        (" ", "T / degC  f / Hz  G' / Pa  G'' / Pa  x"),
        (" ", "T [degC],f [Hz],G' [Pa],G'' [Pa],x y"),
        (" ", "Temp [degC] Freq [Hz] Shear storage modulus [Pa] Shear loss modulus [Pa] strain"),
        (",", "Temperature [degC],Frequency [Hz],G' [Pa],G'' [Pa],x"),
        ("\t", "Temperature [degC]\tFrequency [Hz]\tG' [Pa]\tG'' [Pa]\tx"),
        (";", "Temperature [degC];Frequency [Hz];G' [Pa];G'' [Pa];x"),
    ],
)
@pytest.mark.parametrize("comments", ["# ", "#", "% ", "// ", ""])
def test_what_savetxt_writes(delimiter, header, comments, tmp_path):
    table = np.column_stack([ROWS, np.hypot(ROWS[:, 2], ROWS[:, 3])])
    if "tan" in header:
        table[:, 4] = ROWS[:, 3] / ROWS[:, 2]
    np.savetxt(tmp_path / "a.txt", table, delimiter=delimiter, header=header, comments=comments)
    dma = read(tmp_path / "a.txt")
    assert dma.warnings == ()


def test_frequency_first_behind_a_comment_mark(tmp_path):
    header = "Frequency [Hz],T [degC],G' [Pa],G'' [Pa]"
    np.savetxt(tmp_path / "a.csv", ROWS[:, [1, 0, 2, 3]], delimiter=",", header=header)
    read(tmp_path / "a.csv")


def test_units_behind_a_comment_mark(write):
    rows = "\n".join(" ".join(map(str, row)) for row in ROWS)
    read(write("# T f G' G''\n# degC Hz Pa Pa\n" + rows))
    read(write("Temperature  Frequency  Storage modulus G'  Loss modulus G''\n[degC] [Hz] [Pa] [Pa]\n" + rows))


@pytest.mark.parametrize("mark", [" ", ","])
def test_a_mark_may_be_the_title_of_numbers_of_points(mark, write):
    rows = "\n".join(mark.join(map(str, (i, *row))) for i, row in enumerate(ROWS))
    read(write(mark.join(["#", "T[degC]", "f[Hz]", "G'[Pa]", "G''[Pa]"]) + "\n" + rows))


def test_titles_that_cannot_be_told_apart_are_refused(write):
    """Six words for five columns: which of them is of two words?"""
    rows = "\n".join(" ".join(map(str, (*row, 7))) for row in ROWS)
    path = write("T[degC] f[Hz] gap width G'[Pa] G''[Pa]\n" + rows)
    with pytest.raises(
        InputError, match="has 6 titles, and the rows below it have 5 cells: write titles without blanks"
    ):
        em.fit.read_dma(path)
    columns = {"temperature": 1, "frequency": 2, "storage": 3, "loss": 4}
    dma = em.fit.read_dma(
        path, columns=columns, kind="shear", frequency_unit="Hz", modulus_unit="Pa", temperature_unit="degC"
    )
    np.testing.assert_allclose([dma.storage, dma.loss], ROWS[:, 2:].T)


def test_a_cell_that_is_missing_between_blanks_costs_its_row(write):
    rows = [" ".join(map(str, (*row, 0.2))) for row in ROWS]
    rows[1:1] = ["0.5 2.5e6 5e5 0.2", "-20 0.5 2.5e6 5e5 0.2 7"]
    with pytest.warns(
        FitWarning, match="2 rows left out: line 3: it has 4 cells, the header 5 titles; line 4: it has 6"
    ):
        read(write("T[degC] f[Hz] G'[Pa] G''[Pa] x\n" + "\n".join(rows)))


@pytest.mark.parametrize(
    "header",
    [
        "temperature_degC,frequency_Hz,storage_modulus_Pa,loss_modulus_Pa",
        "temperature_deg_C,freq_Hz,shear_storage_modulus_Pa,shear_loss_modulus_Pa",
        "Temperature [degC],Frequency [Hz],Modulus G' [Pa],Modulus G'' [Pa]",
    ],
)
def test_more_titles(header, write):
    dma = em.fit.read_dma(write(header + "\n" + "\n".join(",".join(map(str, row)) for row in ROWS)), kind="shear")
    np.testing.assert_allclose([dma.storage, dma.loss], ROWS[:, 2:].T)


@pytest.mark.parametrize(
    ("title", "kind"),
    [
        ("Relaxation modulus G [MPa]", "shear"),
        ("Relaxation modulus E(t) [MPa]", "tensile"),
        ("Stress relaxation modulus [MPa]", None),
        ("relaxation_modulus_MPa", None),
    ],
)
def test_titles_of_relaxation(title, kind, write):
    path = write(f"T [degC],Time [s],{title}\n20,1,3\n20,10,2.5\n20,100,2\n")
    dma = em.fit.read_dma(path, kind=None if kind else "tensile")
    np.testing.assert_allclose(dma.relaxation, [3e6, 2.5e6, 2e6])
    assert dma.kind == (kind or "tensile")


def test_a_modulus_beside_a_time_is_asked_for_as_relaxation(write):
    path = write("T [degC],Time [s],Strain [%],Stiffness [MPa]\n20,1,1,3\n20,10,1,2.5\n")
    with pytest.raises(InputError, match=r"as columns={'relaxation': 4} \(--column relaxation=4\)"):
        em.fit.read_dma(path)
    assert em.fit.read_dma(path, columns={"relaxation": 4}, kind="tensile").size == 2


@pytest.mark.parametrize(
    ("title", "unit", "values"), [("Strain", "%", 0.1), ("No.", "#", 1.0), ("Damping", "%", 20.0)], ids=str
)
def test_a_unit_row_that_begins_with_a_mark(title, unit, values, tmp_path):
    """% and # are units of a column where they have a cell and a title of their own."""
    lines = [f"{title},Temperature,Frequency,G',G''", f"{unit},°C,Hz,MPa,kPa"]
    lines += [f"{values},{T},{f},{s / 1e6!r},{g / 1e3!r}" for T, f, s, g in ROWS.tolist()]
    (tmp_path / "a.csv").write_text("\n".join(lines), encoding="utf-8")
    assert read(tmp_path / "a.csv").bad_rows == ()


def test_an_index_without_a_title_is_read_by_numbers(tmp_path):
    """What pandas prints: one title fewer than columns, and the refusal's advice leads to the data."""
    lines = ["temperature frequency storage loss", *(f"{i} {' '.join(map(str, row))}" for i, row in enumerate(ROWS))]
    (tmp_path / "a.txt").write_text("\n".join(lines))
    units = {"frequency_unit": "Hz", "modulus_unit": "Pa", "temperature_unit": "degC", "kind": "shear"}
    with pytest.raises(InputError, match="or name every column by its number"):
        em.fit.read_dma(tmp_path / "a.txt", **units)
    columns = {"temperature": 2, "frequency": 3, "storage": 4, "loss": 5}
    dma = em.fit.read_dma(tmp_path / "a.txt", columns=columns, **units)
    np.testing.assert_allclose([dma.storage, dma.loss], ROWS[:, 2:].T)
    np.testing.assert_allclose(dma.temperature, ROWS[:, 0] + 273.15)


@pytest.mark.parametrize(
    ("storage", "loss", "kind"),
    [
        ("G_prime_MPa", "G_double_prime_MPa", "shear"),
        ("G-storage [MPa]", "G-loss [MPa]", "shear"),
        ("Re(E*) [MPa]", "Im(E*) [MPa]", "tensile"),
        ("Storage Young's Modulus (MPa)", "Loss Young's Modulus (MPa)", "tensile"),
    ],
)
def test_names_that_are_spelled_out(storage, loss, kind, write):
    rows = "\n".join(f"{f},20,{f**0.1},{0.3 * f**0.1}" for f in (0.1, 0.3, 1, 3, 10))
    found = em.fit.read_dma(write(f"f [Hz],T [degC],{storage},{loss}\n{rows}\n"))
    assert found.kind == kind
    np.testing.assert_allclose(found.loss / found.storage, 0.3)
    np.testing.assert_allclose(found.storage[2], 1e6)
