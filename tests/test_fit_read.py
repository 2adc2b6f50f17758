"""Reading DMA files: every format gives the same SI numbers, units are never guessed, bad rows are named."""

import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit import FitWarning

from .dma_files import WRITERS, eplexor_xlsx, isotherms, measure, plain_csv

MATERIAL = em.Prony(5e5, [2e6, 1e6, 5e5], [1e-5, 1e-3, 1e-1], shift=em.WLF(6.0, 110.0, 293.15))
ROWS = measure(MATERIAL)


@pytest.mark.parametrize("writer", WRITERS, ids=lambda writer: writer.__name__)
def test_every_format_gives_the_same_numbers(writer, tmp_path):
    paths = writer(tmp_path, ROWS)
    dma = em.fit.read_dma(paths if len(paths) > 1 else paths[0])
    order = np.lexsort((dma.frequency, dma.temperature))
    assert dma.kind == "shear"
    assert dma.size == len(ROWS)
    assert dma.bad_rows == ()
    digits = 1e-5 if writer.__name__ in ("reptate", "decimal_comma") else 1e-12
    np.testing.assert_allclose(dma.frequency[order], 2 * np.pi * ROWS[:, 0], rtol=digits)
    np.testing.assert_allclose(dma.temperature[order], ROWS[:, 1] + 273.15, rtol=1e-12)
    np.testing.assert_allclose(dma.storage[order], ROWS[:, 2], rtol=digits)
    np.testing.assert_allclose(dma.loss[order], ROWS[:, 3], rtol=digits)
    assert set(dma.units) >= {"storage", "loss", "temperature"}


def test_bad_rows_are_counted_and_named(write):
    rows = [
        "1,20,2e6,1e5",
        "2,20,,1e5",
        "3,20,2e6,-5",
        "4,20,x,1e5",
        "5,20,2e6,1e5",
        "nan,20,2e6,1e5",
        "6,20,2e6,0",
        "7,-300,2e6,1e5",
    ]
    path = write("f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "\n".join(rows))
    with pytest.warns(FitWarning, match=r"6 rows left out: line 3: .*line 4: G'' \[Pa\] is -5 Pa, not positive"):
        dma = em.fit.read_dma(path)
    assert dma.size == 2
    assert [text.split(":")[0] for text in dma.bad_rows] == ["line 3", "line 4", "line 5", "line 7", "line 8", "line 9"]
    assert "not above absolute zero" in dma.bad_rows[-1]


@pytest.mark.parametrize("bad", [0.0, -1.5, 90.0, 93.0, 270.0])
def test_a_phase_angle_that_no_material_has_costs_its_row_only(write, bad):
    rows = [f"{f},20,2e6,{bad if f == 3 else 30}" for f in (1, 2, 3, 4)]
    said = rf"1 row left out: line 4: phase \[deg\] is {bad:g} deg, not between 0 and 90 deg"
    with pytest.warns(FitWarning, match=said):
        dma = em.fit.read_dma(write("f [Hz],T [degC],|G*| [Pa],phase [deg]\n" + "\n".join(rows)))
    np.testing.assert_allclose(dma.loss, [1e6, 1e6, 1e6])
    with pytest.raises(
        InputError, match=r"is a measurement \(line 2: phase \[rad\] is 30 rad, not between 0 and 90 deg"
    ):
        em.fit.read_dma(write("f [Hz],T [degC],|G*| [Pa],phase [rad]\n1,20,2e6,30\n"))


def test_every_bad_row_is_in_the_table_of_the_master_curve(write, tmp_path):
    """The warning names six; a person at the command line finds the others, with their file, in what was written."""
    bad = [f"{k},20,none,1e5" for k in range(1, 10)]
    good = [f"{f},20,{2e6 * f**0.05},{1e5 * f**0.1}" for f in (1, 2, 4, 8, 16, 32)]
    first = write("f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "\n".join(bad + good), "first.csv")
    second = write("f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "\n".join(bad[:1] + good), "second.csv")
    with pytest.warns(FitWarning) as caught:
        dma = em.fit.read_dma([first, second])
    assert any("and 3 more, all of them in bad_rows" in str(warning.message) for warning in caught)
    em.fit.master_curve(dma).to_csv(tmp_path / "master.csv")
    named = [line for line in (tmp_path / "master.csv").read_text().splitlines() if "row left out" in line]
    assert len(named) == 10
    assert named[8].startswith("# row left out: first.csv: line 10: G' [Pa] is 'none'")
    assert named[9].startswith("# row left out: second.csv: line 2: ")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "1,20,2.5,0.3\n2,20,2.6,0.3\n", "implausibly low"),
        ("f [Hz],T [degC],G' [kPa],G'' [kPa]\n" + "1,20,2.5,0.3\n2,20,2.6,0.3\n", "low for a solid polymer, unless"),
        ("t [s],T [degC],G(t) [kPa]\n" + "1,20,2.5\n2,20,2.4\n", "implausibly low for a solid"),
        ("f [Hz],T [degC],G' [GPa],G'' [GPa]\n" + "1,20,2500,300\n2,20,2600,300\n", "implausibly high"),
        ("f [Hz],T [K],G' [Pa],G'' [Pa]\n" + "1,20,2e6,3e5\n2,20,2e6,3e5\n", "degC or K"),
        ("f [Hz],T [degC],G' [Pa],G'' [kPa]\n" + "1,20,2e6,3e5\n2,20,2e6,3e5\n", "units mixed up"),
        ("f [Hz],T [degC],G' [MPa],G'' [kPa]\n" + "1,20,2,0.56\n2,20,2,0.6\n", "units mixed up"),
        ("f [Hz],w [rad/s],T [degC],G' [Pa],G'' [Pa]\n" + "1,1,20,2e6,3e5\n2,2,20,2e6,3e5\n", "Hz and rad/s mixed"),
        ("f [Hz],T [degC],G' [Pa],G'' [Pa],tan_delta\n" + "1,20,2e6,3e2,0.15\n2,20,2e6,3e2,0.15\n", "loss tangent"),
    ],
)
def test_what_is_implausible_is_said(write, text, said):
    with pytest.warns(FitWarning) as caught:
        em.fit.read_dma(write(text))
    assert any(said in str(warning.message) and "ssumed" in str(warning.message) for warning in caught)


def test_a_melt_in_its_terminal_zone_may_be_soft(write):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        em.fit.read_dma(write("f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "1,20,150,2500\n2,20,3000,10000\n"))


def test_loss_from_the_loss_tangent_and_from_the_phase(write):
    path = write("f [Hz],T [degC],E' [MPa],tan(delta)\n" + "\n".join(f"{f},20,2,0.05" for f in (1, 2)))
    np.testing.assert_allclose(em.fit.read_dma(path).loss, 1e5)
    path = write("f,T,E',tan delta\nHz,degC,MPa,%\n" + "\n".join(f"{f},20,2,5" for f in (1, 2)))
    np.testing.assert_allclose(em.fit.read_dma(path).loss, 1e5)
    path = write("f [Hz],T [degC],|G*| [MPa],tan delta\n" + "\n".join(f"{f},20,5,0.75" for f in (1, 2)))
    dma = em.fit.read_dma(path)
    np.testing.assert_allclose([dma.storage, dma.loss], [[4e6, 4e6], [3e6, 3e6]])
    path = write("f [Hz],T [degC],|G*| [MPa],phase angle [deg]\n" + "\n".join(f"{f},20,2,30" for f in (1, 2)))
    np.testing.assert_allclose(em.fit.read_dma(path).loss, 1e6)


def test_time_domain(write):
    path = write("t,E_relax,T\ns,MPa,°C\n" + "\n".join(f"{t},{3 - 0.1 * t},20" for t in (1, 2, 4)), encoding="latin-1")
    dma = em.fit.read_dma(path)
    assert dma.frequency.size == 0
    np.testing.assert_allclose(dma.time, [1, 2, 4])
    np.testing.assert_allclose(dma.relaxation, [2.9e6, 2.8e6, 2.6e6])
    np.testing.assert_allclose(dma.time_temperature, 293.15)


def test_reptate_master_curve(write):
    path = write("T=-35;C1=8.8;\n 0.1 150 4500 -10 0\n 1.0 1500 9500 -20 0\n 10 9e3 2e4 -20 0\n", "pi.tts")
    dma = em.fit.read_dma(path)
    assert dma.shifted
    np.testing.assert_allclose(dma.temperature, 238.15)
    np.testing.assert_allclose(dma.loss, [4500, 9500, 2e4])
    with pytest.warns(FitWarning, match="no temperature column"):
        dma = em.fit.read_dma(write("mwdfile=ps2.dmwd;\n 0.1 150 4500\n 1.0 1500 9500\n 10 9e3 2e4\n", "ps.tts"))
    assert np.isnan(dma.temperature).all()
    with pytest.raises(InputError, match="--temperature"):
        em.fit.master_curve(dma)


def test_files_that_are_none(tmp_path, write, monkeypatch):
    for path, said in (
        (tmp_path / "none.csv", "cannot be read"),
        (tmp_path, "got a folder"),
        (".", r"^\.: must be a file, got a folder"),
        (write("\n \n", "empty.csv"), "the file is empty"),
        (write("f [Hz],T [K],G' [Pa],G'' [Pa]\n1,2,3\nx,y,z,w\n", "no.csv"), "is a measurement"),
        (3, "path must be a file"),
    ):
        with pytest.raises(InputError, match=said):
            em.fit.read_dma(path)
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\x00\x01\x02" * 100)
    with pytest.raises(InputError, match="binary"):
        em.fit.read_dma(binary)
    broken = tmp_path / "broken.xls"
    broken.write_bytes(b"\xd0\xcf\x11\xe0" + b"\1" * 600)
    with pytest.raises(InputError, match="is not a spreadsheet"):
        em.fit.read_dma(broken)
    sheet = eplexor_xlsx(tmp_path, ROWS)[0]
    monkeypatch.setitem(__import__("sys").modules, "python_calamine", None)
    with pytest.raises(InputError, match=r"elastomdr\[excel\]"):
        em.fit.read_dma(sheet)


def test_arrays_and_joining(tmp_path):
    f, t, s, l = ROWS.T
    dma = em.fit.dma(2 * np.pi * f, s, l, t + 273.15, kind="shear")
    parts = [em.fit.dma(2 * np.pi * p[:, 0], p[:, 2], p[:, 3], p[0, 1] + 273.15, kind="shear") for p in isotherms(ROWS)]
    np.testing.assert_array_equal(em.fit.join(*parts).storage, dma.storage)
    np.testing.assert_allclose(em.fit.read_dma(plain_csv(tmp_path, ROWS)[0]).storage, dma.storage)
    with pytest.raises(InputError, match="one kind"):
        em.fit.join(dma, em.fit.dma([1.0], [1e6], [1e5], 293.15, kind="tensile"))
    with pytest.raises(InputError, match=r"loss must be positive and finite, got -1 \(entry 1\)"):
        em.fit.dma([1, 2], [1e6, 1e6], [1e5, -1], 293.15, kind="shear")
    with pytest.raises(InputError, match="kind must be"):
        em.fit.dma([1.0], [1e6], [1e5], 293.15, kind="bulk")


def test_clean_files_read_without_a_word(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        em.fit.read_dma(plain_csv(tmp_path, ROWS))


@pytest.mark.parametrize(
    ("rows", "storage"),
    [
        ('0.5,20,"8,097.18",100', 8097.18e6),  # thousands with a point elsewhere
        ('0.5,20,"8,097",100', 8097e6),
        ("0,5;20;8.097,18;100", 8097.18e6),  # decimal commas with a point between thousands
        ("0,5;20;8.097;100", 8097e6),
        ("0.5;20;2\u00a0100;100", 2100e6),  # a blank between thousands
        ("0.5\t20\t2e3\t100", 2e9),
    ],
)
def test_thousands_and_decimals(write, rows, storage):
    mark = next(mark for mark in ";\t," if mark in rows)
    header = mark.join(["f [Hz]", "T [degC]", "E' [MPa]", "E'' [MPa]"])
    dma = em.fit.read_dma(write("\n".join([header, rows, rows, rows])))
    np.testing.assert_allclose(dma.storage, storage)
    np.testing.assert_allclose(dma.frequency, np.pi)


def test_points_between_thousands_of_whole_numbers(write):
    """A number with two points says what they are; a date above, with two as well, does not."""
    rows = "1;20;532.870;35.311\n2;20;1.018.790;80.114\n3;20;1.205.749;90.000\n"
    for above in ("", "Datum;12.05.2023\n"):
        dma = em.fit.read_dma(write(above + "f [Hz];T [degC];G' [Pa];G'' [Pa]\n" + rows))
        np.testing.assert_array_equal(dma.storage, [532870, 1018790, 1205749])
        np.testing.assert_array_equal(dma.loss, [35311, 80114, 90000])
    dma = em.fit.read_dma(
        write("Version;1.2.3;12.05.2023\nf [Hz];T [degC];G' [kPa];G'' [kPa]\n" + 3 * "1;20;532.870;35.311\n")
    )
    np.testing.assert_allclose(dma.storage, 532870)


def test_signs_and_separators_of_spreadsheets(write):
    dma = em.fit.read_dma(write("sep=;\nf [Hz];T [°C];G' [MPa];G'' [MPa]\n" + 3 * "1;\u221220;2;0,1\n"))
    np.testing.assert_allclose([dma.temperature[0], dma.loss[0]], [253.15, 1e5])


def test_titles_that_never_end(write):
    """A line of prose above the table is looked at as a header, and may be long."""
    prose = " ".join(["storage modulus G' (x) - y, z:"] * 500)
    dma = em.fit.read_dma(write(prose + "\nf [Hz],T [degC],G' [MPa],G'' [MPa]\n" + 3 * "1,20,2,0.1\n"))
    assert dma.size == 3


def test_measurements_that_do_not_match_are_refused():
    with pytest.raises(InputError, match="storage must have as many entries as frequency, 3, got 2"):
        em.fit.Dma(np.full(3, 293.15), np.ones(3), np.ones(2), np.ones(3), "shear")
    with pytest.raises(InputError, match="storage must be positive"):
        em.fit.Dma(np.full(2, 293.15), np.ones(2), -np.ones(2), np.ones(2), "shear")


def test_rows_that_break_off_are_named(write):
    """A row that breaks off after its first number is no remark. A file given twice is a mistake."""
    rows = [f"{f},20,{1e6 * f:g},1e5" for f in (1, 2, 3, 4)]
    text = "\n".join(["f (Hz),T (°C),G' (Pa),G'' (Pa)", *rows, "7", ",,,5", "end of run", ",,,"])
    with pytest.warns(FitWarning, match="2 rows left out: line 6: .* no number; line 7: .* no number"):
        dma = em.fit.read_dma(write(text))
    np.testing.assert_allclose(dma.storage, [1e6, 2e6, 3e6, 4e6])
    assert len(dma.bad_rows) == 2
    path = write("\n".join(["f (Hz),T (°C),G' (Pa),G'' (Pa)", *rows]))
    with pytest.raises(InputError, match=f"path must name every file once, got .*{path.name} twice"):
        em.fit.read_dma([path, path])


def test_typed_quotes_of_windows(tmp_path):
    """Spreadsheets turn G' into a typed quote, and write it in the code page of Windows."""
    path = tmp_path / "windows.csv"
    path.write_bytes("Freq. (Hz),Temp. (°C),G\u2019 (Pa),G\u201d (Pa)\n1,20,2e6,1e5\n2,20,3e6,2e5\n".encode("cp1252"))
    dma = em.fit.read_dma(path)
    np.testing.assert_allclose(dma.loss, [1e5, 2e5])
    assert dma.kind == "shear"
