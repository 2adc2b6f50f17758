"""Isotherms that stand side by side or one under the other, and temperatures in lines above them."""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit import FitWarning

from .dma_files import KNOWN, isotherms, measure

ROWS = measure(KNOWN, np.array([-20.0, 0.0, 20.0]), np.geomspace(0.1, 10, 6))
PARTS = isotherms(ROWS)
TITLES = ["f [Hz]", "T [degC]", "G' [Pa]", "G'' [Pa]"]


def beside(parts, titles, mark=",", gap=0):
    """Parts side by side, filled up with empty cells."""
    lines = [mark.join((title + [""] * gap)[i] for title in titles for i in range(len(title) + gap))]
    for i in range(max(map(len, parts))):
        cells = []
        for part, title in zip(parts, titles, strict=True):
            cells += [f"{x:.12g}" for x in part[i]] if i < len(part) else [""] * len(title)
            cells += [""] * gap
        lines.append(mark.join(cells))
    return "\n".join(lines)


def check(dma, rows=ROWS):
    order = np.lexsort((dma.frequency, dma.temperature))
    np.testing.assert_allclose(dma.temperature[order], rows[:, 1] + 273.15)
    np.testing.assert_allclose(dma.frequency[order], 2 * np.pi * rows[:, 0])
    np.testing.assert_allclose([dma.storage[order], dma.loss[order]], rows[:, 2:].T)
    assert dma.bad_rows == ()


@pytest.mark.parametrize(("mark", "gap"), [(",", 0), ("\t", 1), (";", 2), (" ", 0)])
def test_isotherms_side_by_side(mark, gap, write):
    titles = [t.replace(" ", "") for t in TITLES] if mark == " " else TITLES
    dma = em.fit.read_dma(write(beside(PARTS, [titles] * 3, mark, gap)))
    check(dma)
    assert dma.warnings == ()
    assert dma.columns[0].endswith("and so on, 3 blocks side by side")


def test_blocks_may_be_shorter_have_units_of_their_own_and_titles_with_numbers(write):
    parts = [PARTS[0], PARTS[1][:3], PARTS[2][:5] * [1, 1, 1e-3, 1e-3]]
    titles = [TITLES, [f"{title}.1" for title in TITLES], [title.replace("Pa", "kPa") for title in TITLES]]
    check(em.fit.read_dma(write(beside(parts, titles))), np.concatenate([PARTS[0], PARTS[1][:3], PARTS[2][:5]]))
    half = beside([PARTS[0], PARTS[1]], [TITLES] * 2).splitlines()
    half[2] = ",".join([*half[2].split(",")[:6], "", half[2].split(",")[7]])
    with pytest.warns(FitWarning, match="1 row left out: line 3, block 2: G' .Pa. is '', no number"):
        assert em.fit.read_dma(write("\n".join(half))).size == 11


def test_relaxation_side_by_side(write):
    parts = [np.array([(t, 20.0 * i, 3e6 - 1e5 * t - 1e5 * i) for t in (1, 2, 4)]) for i in range(3)]
    dma = em.fit.read_dma(write(beside(parts, [["t [s]", "T [degC]", "G(t) [Pa]"]] * 3)))
    np.testing.assert_allclose(dma.relaxation, np.concatenate(parts)[:, 2])
    np.testing.assert_allclose(dma.time_temperature, np.repeat([273.15, 293.15, 313.15], 3))


def test_blocks_without_temperature_are_refused_unless_it_stands_above(write):
    text = beside([part[:, [0, 2, 3]] for part in PARTS], [[TITLES[0], *TITLES[2:]]] * 3)
    path = write(text)
    with pytest.raises(InputError, match="repeat 3 times, side by side, and have no temperature: give each"):
        em.fit.read_dma(path)
    with pytest.warns(FitWarning, match="1 of their temperatures are in more than one"):
        assert (em.fit.read_dma(path, temperature=300.0).temperature == 300.0).all()
    check(em.fit.read_dma(write("T = -20 degC,,,T = 0 degC,,,T = 20 degC,,\n" + text)))
    shared = beside(
        [PARTS[0][:, [0, 2, 3]], *(part[:, 2:] for part in PARTS[1:])], [TITLES[:1] + TITLES[2:], *[TITLES[2:]] * 2]
    )
    check(em.fit.read_dma(write(",-20 °C,,0 °C,,20 °C,\n" + shared)))


def test_the_same_temperatures_in_several_blocks_are_said(write):
    with pytest.warns(
        FitWarning, match="2 blocks of the same columns .* and 3 of their temperatures are in more than one"
    ):
        em.fit.read_dma(write(beside([ROWS, ROWS], [TITLES] * 2)))


@pytest.mark.parametrize(
    "title",
    [
        "T = {} degC",
        "# Temperature: {} °C",
        "[Isotherm {} °C]",
        "Temp. {} degC",
        "Step 3: {} °C",
        "Interval: T = {} °C",
        "{} °C",
    ],
)
@pytest.mark.parametrize("again", [True, False])
def test_temperatures_in_lines_above_blocks(title, again, write):
    """Each block may have its header, or all of them the first one."""
    text, header = "a rubber of 5 phr, measured at night\n", "f [Hz],G' [Pa],G'' [Pa]\n"
    for i, part in enumerate(PARTS):
        above = title.format(f"{part[0, 1]:g}") + "\n"
        rows = "\n".join(",".join(f"{x:.12g}" for x in row) for row in part[:, [0, 2, 3]])
        text += (above + header if again else header * (i == 0) + above) + rows + "\n\n"
    path = write(text)
    dma = em.fit.read_dma(path)
    check(dma)
    assert dma.warnings == ()
    assert dma.columns[0].endswith("temperature from the line above")
    with pytest.raises(InputError, match=r"temperature must be left out, got 300 K: lines .* say -20, 0 and 20 degC"):
        em.fit.read_dma(path, temperature=300.0)


@pytest.mark.parametrize(
    "line", ["Glass transition: -60 °C", "Tg = -60 degC", "300 C-units", "stored at 5 °C for 3 h", "T = 20"]
)
def test_other_lines_give_no_temperature(line, write):
    rows = "\n".join(",".join(f"{x:.12g}" for x in row) for row in PARTS[0][:, [0, 2, 3]])
    with pytest.warns(FitWarning, match="no temperature column.*--temperature 20degC"):
        dma = em.fit.read_dma(write(line + "\nf [Hz],G' [Pa],G'' [Pa]\n" + rows))
    assert np.isnan(dma.temperature).all()


def test_one_temperature_is_not_advised_for_several_sweeps(write):
    rows = "\n".join(",".join(f"{x:.12g}" for x in row) for row in ROWS[:, [0, 2, 3]])
    with pytest.warns(FitWarning, match="frequencies .or times. repeat") as caught:
        dma = em.fit.read_dma(write("f [Hz],G' [Pa],G'' [Pa]\n" + rows))
    assert not any("20degC" in str(one.message) for one in caught)
    with pytest.raises(InputError, match=r"temperature is not in the data: frequencies .* give each its own") as error:
        em.fit.master_curve(dma)
    assert "20degC" not in str(error.value)


def test_a_master_curve_of_several_isotherms_is_of_one_temperature(write):
    """Shifted isotherms overlap; few of their frequencies are the same."""
    f = np.sort(np.concatenate([ROWS[:6, 0] * 10 ** (0.7 * i) for i in range(3)]))
    f[3] = f[4]
    rows = "\n".join(f"{x:.12g},{1e6 * x**0.2:.12g},{1e5 * x**0.2:.12g}" for x in f)
    with pytest.warns(FitWarning, match="--temperature 20degC"):
        em.fit.read_dma(write("f [Hz],G' [Pa],G'' [Pa]\n" + rows))


def test_each_row_of_a_long_table_stays_one_material(write):
    """Two pairs of moduli of one temperature and frequency are no blocks."""
    text = beside([ROWS, ROWS[:, 2:]], [TITLES, TITLES[2:]])
    dma = em.fit.read_dma(write(text))
    check(dma)
    assert 'passed over: 5 "G\' [Pa]", 6' in dma.columns[0]


def above_each(lines):
    """One header, and a line above each isotherm."""
    text = [",".join(title for title in TITLES if "T" not in title)]
    for line, part in zip(lines, PARTS, strict=True):
        text += [line, *(",".join(f"{x:.12g}" for x in np.delete(row, 1)) for row in part)]
    return "\n".join(text)


def test_a_decimal_comma_above_a_table_with_commas(write):
    dma = em.fit.read_dma(write(above_each(["T = -20,5 °C", "T = 0,0 °C", "T = 20,5 °C"])), kind="shear")
    np.testing.assert_allclose(np.unique(dma.temperature), [252.65, 273.15, 293.65])


@pytest.mark.parametrize("line", ["T = 0 ± 0.1 °C", "T = 0", "T = 0 °C (repeated)", "T = .5 °C"])
def test_a_temperature_that_is_not_understood_is_not_that_of_the_last_isotherm(line, write):
    with pytest.raises(InputError, match=r"line 9, 'T = .* cannot be understood: write it as 'T = -20 degC'"):
        em.fit.read_dma(write(above_each(["T = -20 °C", line, "T = 20 °C"])), kind="shear")


def test_a_number_of_a_sweep_is_no_sign(write):
    """In 'Sweep 1-20 °C' nobody knows: no temperature, and a warning."""
    with pytest.warns(FitWarning, match="there is no temperature column"):
        dma = em.fit.read_dma(write(above_each(["Sweep 1-20 °C", "Sweep 2-30 °C", "Run 3 C"])), kind="shear")
    assert np.isnan(dma.temperature).all()


def test_two_temperatures_above_the_same_columns_are_refused(write):
    table = "f [Hz],G' [Pa],G'' [Pa]\n" + "\n".join(f"{f},{g},{h}" for f, _, g, h in PARTS[0])
    path = write(f"T = 20 degC\nT = 25 degC\n{table}\n")
    with pytest.raises(InputError, match="'T = 20 degC' and 'T = 25 degC' stand above the same columns"):
        em.fit.read_dma(path)
    with pytest.warns(FitWarning, match="says 25 degC; assumed is what you give, 20 degC"):
        assert set(em.fit.read_dma(path, temperature=293.15).temperature) == {293.15}
    same = em.fit.read_dma(write(f"T = 20 degC\nT = 293.15 K\n{table}\n"))
    assert set(same.temperature) == {293.15}
