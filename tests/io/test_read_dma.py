"""Files of moduli: every layout gives the same SI numbers, units are never guessed,
rows that are none are named.
"""

import warnings

import numpy as np
import pandas as pd
import pint_pandas  # noqa: F401  the dtype "pint[MPa]"
import polars as pl
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.fit import FitWarning
from elastomdr.io.point_tables import vertical_factors

from ..refused import mentions, refused, warned
from .cases import twins
from .dma_files import KNOWN, LAYOUTS, eplexor_xlsx, isotherms, measure, plain_csv, q800

ROWS = measure(KNOWN, np.array([-10.0, 0.0, 20.0]), np.geomspace(0.1, 50, 6))
# f [Hz], T [degC], storage, loss
FOUR = [(1, 20, 2e6, 1e5), (2, 20, 3e6, 2e5), (4, 20, 4e6, 3e5)]


def check(dma, rows=ROWS, digits=1e-11):
    order = np.lexsort((dma.omega, dma.temperature))
    rows = rows[np.lexsort((rows[:, 0], rows[:, 1]))]
    np.testing.assert_allclose(dma.temperature[order], rows[:, 1] + 273.15, rtol=1e-11)
    np.testing.assert_allclose(dma.omega[order], 2 * np.pi * rows[:, 0], rtol=digits)
    np.testing.assert_allclose(
        [dma.storage[order], dma.loss[order]], rows[:, 2:].T, rtol=digits
    )


def table(titles, rows=FOUR, mark=","):
    return "\n".join([titles, *(mark.join(f"{x:.12g}" for x in row) for row in rows)])


HELD = {"columns": {"strain": "1 %"}}  # which no file of a modulus alone says


def read(path, **options):
    """Without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return em.read_dma(path, **options)


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.__name__)
def test_every_layout_gives_the_same_numbers(layout, tmp_path):
    dma = read(layout(tmp_path, ROWS), kind="shear" if layout is q800 else None)
    check(
        dma, digits=1e-5 if layout.__name__ in ("reptate", "decimal_comma") else 1e-10
    )
    assert (dma.kind, dma.bad_rows) == ("shear", ())
    assert {"frequency", "storage", "loss"} - set(dma.units) <= {"frequency"}


@pytest.mark.parametrize(
    "titles",
    [
        (
            "Frequency (Hz),Temperature (°C),Storage modulus G' (MPa),Loss modulus "
            "G'' (MPa)"
        ),
        (
            "Frequency f [Hz],Temperature T [°C],Storage Modulus (G') (MPa),Loss "
            "Modulus (G'') (MPa)"
        ),
        "Frequency - Hz,Temperature - °C,G' - MPa,G'' - MPa",
        "Frequenz [Hz],Temperatur [°C],Speichermodul G' [MPa],Verlustmodul G'' [MPa]",
        "주파수 (Hz),온도 (℃),저장 탄성률 G' (MPa),손실 탄성률 G'' (MPa)",
        '"f [Hz]","T [°C]","G\' [MPa]","G"" [MPa]"',
        "f,T,G',G''\n\nHz,°C,MPa,MPa\n",
        "# f,T,G',G''\n# Hz,°C,MPa,MPa",
        "f [Hz],T [degC],G storage modulus [MPa],G loss modulus [MPa]",
        "freq_hz,temperature_deg_C,shear_storage_modulus_mpa,shear_loss_modulus_mpa",
        "Frequency [Hz],Temp. [degF],G_prime_N/mm²,G_double_prime_MPa",
        "f / Hz,T / °C,Re(G*) / MPa,Im(G*) / MPa",
        "frequency in kHz,T [K],Storage Shear Modulus (kPa),G-loss [GPa]",
        "omega [rad/s],Sample temperature (C),Shear storage modulus (psi),G2 (dyn/cm2)",
        "omega [1/s],T [degC],G_stor (bar),G_loss (kgf/cm2)",
        "f [Hz],T [degC],G\u2019 [MPa],G\u201d [MPa]",
    ],
)
def test_titles_and_units(titles, write):
    """Each file is written in the units of its titles."""
    sizes = {
        "MPa": 1e6,
        "mpa": 1e6,
        "kPa": 1e3,
        "GPa": 1e9,
        "N/mm²": 1e6,
        "psi": 6894.757293168,
        "dyn/cm2": 0.1,
        "bar": 1e5,
        "kgf/cm2": 98066.5,
    }
    head, behind = titles.split(",", 3)[:3], titles.split(",", 3)[3]
    factors = [
        next((v for k, v in sizes.items() if k in text), 1e6)
        for text in (head[2], behind)
    ]
    rows = np.array(FOUR) * [1, 1, 1 / factors[0], 1 / factors[1]]
    if "omega" in titles:
        rows[:, 0] *= 2 * np.pi
    rows[:, 0] *= 1e-3 if "kHz" in titles else 1
    rows[:, 1] = (
        rows[:, 1] * 1.8 + 32
        if "degF" in titles
        else rows[:, 1] + 273.15 * ("[K]" in titles)
    )
    dma = read(write(table(titles, rows)))
    check(dma, np.array(FOUR), 1e-9)
    assert dma.kind == "shear"


@pytest.mark.parametrize("comments", ["# ", "% ", "// ", ""])
@pytest.mark.parametrize(
    ("mark", "titles"),
    [
        (" ", "T[degC] f[Hz] G'[Pa] G''[Pa]"),
        (" ", "T [degC] f [Hz] G' [Pa] G'' [Pa]"),
        (
            " ",
            (
                "Temperature (degC)  Frequency (Hz)  Storage modulus G' (Pa)  Loss "
                "modulus G'' (Pa)"
            ),
        ),
        (" ", "T / degC  f / Hz  G' / Pa  G'' / Pa"),
        (" ", "T [degC],f [Hz],G' [Pa],G'' [Pa]"),
        (
            " ",
            "Temp [degC] Freq [Hz] Shear storage modulus [Pa] Shear loss modulus [Pa]",
        ),
        (";", "Temperature [degC];Frequency [Hz];G' [Pa];G'' [Pa]"),
    ],
)
def test_what_savetxt_writes(mark, titles, comments, tmp_path):
    np.savetxt(
        tmp_path / "a.txt",
        ROWS[:, [1, 0, 2, 3]],
        delimiter=mark,
        header=titles,
        comments=comments,
        fmt="%.15g",
    )
    check(read(tmp_path / "a.txt"))


@pytest.mark.parametrize(
    ("titles", "row"),
    [
        (
            "f [Hz],T [degC],|G*| [MPa],phase angle [deg]",
            (5.0, np.degrees(np.arctan(0.75))),
        ),
        ("f [Hz],T [degC],|G*| [MPa],delta (rad)", (5.0, np.arctan(0.75))),
        ("f [Hz],T [degC],|G*| [MPa],tan delta", (5.0, 0.75)),
        ("f [Hz],T [degC],G' [MPa],tan(delta)", (4.0, 0.75)),
        ("f,T,G',tan delta\nHz,degC,MPa,%", (4.0, 75.0)),
        (
            "log10 f [Hz],T [degC],log10 G' [kPa],log10(G''/kPa) [-]",
            (np.log10(4e3), np.log10(3e3)),
        ),
        ("lg(f/Hz),T [degC],lg(G') [Pa],lg(G'' [Pa])", (np.log10(4e6), np.log10(3e6))),
        ("ln f,T,ln G',ln G''\nHz,degC,kPa,kPa", (np.log(4e3), np.log(3e3))),
        ("f,T,G',G''\nln Hz,degC,ln kPa,ln(kPa)", (np.log(4e3), np.log(3e3))),
        (
            "log10_freq_hz,temperature_C,log10_G_storage_pa,log10_G_loss_pa",
            (np.log10(4e6), np.log10(3e6)),
        ),
    ],
)
def test_moduli_in_other_words(titles, row, write):
    f = np.array([1.0, 2.0, 4.0])
    rate = (
        np.log(f)
        if "ln" in titles
        else np.log10(f)
        if "lg" in titles or "log" in titles
        else f
    )
    dma = read(write(table(titles, [(x, 20, *row) for x in rate])))
    np.testing.assert_allclose(dma.omega, 2 * np.pi * f, rtol=1e-9)
    np.testing.assert_allclose(
        [dma.storage, dma.loss], [[4e6] * 3, [3e6] * 3], rtol=1e-9
    )


@pytest.mark.parametrize(
    ("titles", "kind"),
    [
        ("t,T,E_relax\ns,°C,MPa", "tensile"),
        ("Time [min],T [degC],Relaxation modulus G(t) [MPa]", "shear"),
        ("Time [s],T [degC],Relaxation modulus E [MPa]", "tensile"),
        ("time_s,temperature_C,relaxation_modulus_MPa", None),
    ],
)
def test_relaxation(titles, kind, write):
    dma = read(
        write(table(titles, [(1, 20, 3), (10, 20, 2.5), (100, 20, 2)])),
        kind=None if kind else "shear",
        **HELD,
    )
    np.testing.assert_allclose(
        dma.time, np.array([1, 10, 100]) * (60 if "min" in titles else 1)
    )
    np.testing.assert_allclose(dma.relaxation, [3e6, 2.5e6, 2e6])
    np.testing.assert_allclose(dma.time_temperature, 293.15)
    assert dma.kind == (kind or "shear")


@pytest.mark.parametrize(
    ("row", "storage"),
    [
        ('0.5,20,"8,097.18",100', 8097.18e6),  # thousands with a point elsewhere
        # decimal commas with a point between thousands
        ("0,5;20;8.097,18;100", 8097.18e6),
        ("0,5;20;8.097;100", 8097e6),
        ("0,5;\u221220;2,5;0,1", 2.5e6),
        ("0.5;20;2\u00a0100;100", 2100e6),  # a blank between thousands
        ("0.5\t20\t2d3\t100", 2e9),
    ],
)
def test_thousands_and_decimals(write, row, storage):
    mark = next(mark for mark in ";\t," if mark in row)
    dma = read(
        write(
            "\n".join(
                [
                    "sep=;" * (mark == ";"),
                    mark.join(["f [Hz]", "T [°C]", "E' [MPa]", "E'' [MPa]"]),
                    *3 * [row],
                ]
            )
        )
    )
    np.testing.assert_allclose([dma.storage[0], dma.omega[0]], [storage, np.pi])
    rows = "1;20;532.870;35.311\n2;20;1.018.790;80.114\n3;20;1.205.749;90.000\n"
    dma = read(write("Datum;12.05.2023\nf [Hz];T [degC];G' [Pa];G'' [Pa]\n" + rows))
    np.testing.assert_array_equal(
        [dma.storage, dma.loss], [[532870, 1018790, 1205749], [35311, 80114, 90000]]
    )


def test_isotherms_side_by_side_may_differ_in_length_and_unit(write):
    parts = isotherms(ROWS)
    parts[1] = parts[1][:3]
    lines = [
        ",".join(
            "f [Hz],T [degC],G' [Pa],G'' [Pa]".replace("Pa", u)
            for u in ("Pa", "kPa", "Pa")
        )
    ]
    for i in range(6):
        cells = [
            [x / (1e3 if j == 1 and k > 1 else 1) for k, x in enumerate(part[i])]
            if i < len(part)
            else [""] * 4
            for j, part in enumerate(parts)
        ]
        lines.append(",".join(str(x) for part in cells for x in part))
    check(read(write("\n".join(lines))), np.concatenate(parts))
    blocks = "\n\n".join(
        table(f"T = {p[0, 1]:g} °C\nf [Hz],G' [Pa],G'' [Pa]", p[:, [0, 2, 3]])
        for p in parts
    )
    check(read(write(blocks)), np.concatenate(parts), 1e-10)


@pytest.mark.parametrize(
    ("line", "hertz"),
    [("Frequency: 2.5 kHz", 2500.0), ("f = 10 rad/s", 10 / (2 * np.pi))],
)
def test_a_frequency_above_a_table(line, hertz, write):
    ramp = [(0, 2e6, 1e5), (20, 1e6, 1e5), (40, 8e5, 4e4)]
    dma = read(write(f"{line}\n" + table("T [degC],G' [Pa],G'' [Pa]", ramp)))
    np.testing.assert_allclose(dma.omega, 2 * np.pi * hertz)


@pytest.mark.parametrize(
    "line",
    [
        "Glass transition: -60 °C",
        "300 C-units",
        "T = 20",
        "Run 3 C",
        "stored at 5 °C for 3 h",
    ],
)
def test_lines_that_give_no_temperature(line, write):
    with pytest.warns(FitWarning, match=r"temperature=293\.15"):
        assert np.isnan(
            em.read_dma(
                write(
                    f"{line}\n"
                    + table("f [Hz],G' [Pa],G'' [Pa]", np.delete(FOUR, 1, 1))
                )
            ).temperature
        ).all()


def test_temperatures_from_the_user(write):
    """One for all, or one for each file or isotherm without; what the files say is not
    overruled.
    """
    parts = [
        write(table("f [Hz],G' [Pa],G'' [Pa]", part[:, [0, 2, 3]]), f"{i}.csv")
        for i, part in enumerate(isotherms(ROWS))
    ]
    check(read(parts, temperature=[263.15, 273.15, 293.15]), digits=1e-10)
    assert set(read(parts[0], temperature=300.0).temperature) == {300.0}
    with refused("temperature", 3):
        em.read_dma(parts, temperature=[263.15, 273.15])
    with refused("temperature", 300, 20):
        em.read_dma(write(table("f [Hz],T [degC],G' [Pa],G'' [Pa]")), temperature=300.0)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            "T = -20 °C\n1,2e6,1e5\n2,2e6,1e5\nT = 0 ± 0.1 °C\n1,2e6,1e5\n2,2e6,1e5",
            "line 6",
        ),
        (
            "T = 20 °C\n1,2e6,1e5\n2,2e6,1e5\nnothing,of,this\n1,2e6,1e5\n2,2e6,1e5",
            "line 6",
        ),
        ("T = 20 degC\nT = 25 degC\n1,2e6,1e5\n2,2e6,1e5", "T = 20 degC"),
    ],
)
def test_rows_of_which_nobody_knows_the_temperature_are_refused(text, line, write):
    with pytest.raises(em.InputError, match=line):
        em.read_dma(write("f [Hz],G' [Pa],G'' [Pa]\n" + text))


@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_rows_that_are_no_measurement_are_counted_and_named(write, tmp_path):
    rows = [
        "1,20,2e6,1e5",
        "2,20,,1e5",
        "3,20,2e6,-5",
        "4,20,x,1e5",
        "5,20,2e6,1e5",
        "nan,20,2e6,1e5",
        "6,20,2e6,0",
        "7,-300,2e6,1e5",
        "8",
        ",,,5",
        "end of run",
        ",,,",
        "9,20,2e6,1e5",
    ]
    path = write("f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "\n".join(rows), "one.csv")
    with warned(FitWarning, "one.csv", 8, 2, "bad_rows"):
        dma = em.read_dma(path)
    np.testing.assert_allclose(dma.omega / (2 * np.pi), [1, 5, 9])
    assert [text.split(":")[0] for text in dma.bad_rows] == [
        f"line {i}" for i in (3, 4, 5, 7, 8, 9, 10, 11)
    ]
    assert mentions(dma.bad_rows[1], "line 4", "G'' [Pa]", -5)
    good = "\n".join(
        f"{f},20,{2e6 * f**0.05},{1e5 * f**0.1}" for f in (1, 2, 4, 8, 16, 32)
    )
    with pytest.warns(FitWarning, match="left out"):
        both = em.read_dma(
            [
                path,
                write(
                    "f [Hz],T [degC],G' [Pa],G'' [Pa]\n1,20,-1,1e5\n" + good, "two.csv"
                ),
            ]
        )
    em.fit.master_curve(both).to_csv(tmp_path / "master.csv")
    said = [
        line
        for line in (tmp_path / "master.csv").read_text().splitlines()
        if "row left out" in line
    ]
    assert len(said) == 9
    assert mentions(said[-1], "# row", "two.csv", "line 2")
    blanks = "1 20 2e6 1e5 0.2\n0.5 2.5e6 5e5 0.2\n2 20 2e6 1e5 0.2\n1 20 2e6 1e5 0.2 7"
    with warned(FitWarning, 3, 4, 5, 6):
        assert em.read_dma(write("f[Hz] T[degC] G'[Pa] G''[Pa] x\n" + blanks)).size == 2
    for bad in (0.0, -1.5, 90.0, 270.0):
        phases = table(
            "f [Hz],T [degC],|G*| [Pa],phase [deg]",
            [(f, 20, 2e6, bad if f == 3 else 30) for f in (1, 2, 3)],
        )
        with warned(FitWarning, 4, 0, 90):
            np.testing.assert_allclose(em.read_dma(write(phases)).loss, 1e6)


def test_which_column_is_taken(write):
    """That of the sample before others, if it has its numbers; one that says the same
    passes.
    """
    f, t, s, l = ROWS.T
    named = {"T [degC]": t, "f [Hz]": f, "G' [Pa]": s, "G'' [Pa]": l}

    def of(**more):
        titles = (
            {**named, **more}
            if "first" not in more
            else {"Set temp [degC]": t - 9, **named}
        )
        return write(table(",".join(titles), np.column_stack(list(titles.values()))))

    for more in (
        {"Temperature [K]": t + 273.15},
        {"frequency [Hz]": f * 1.001},
        {"E' [Pa]": 3 * s},
        {"first": 0},
        {"Storage modulus [MPa]": s / 1e6, "loss modulus [kPa]": l / 1e3},
        {"log10 G' [Pa]": np.log10(s)},
        {"Phase [V]": f, "G* sigma": s, "No": f},
    ):
        check(read(of(**more), kind="shear"), digits=1e-9)
    dma = read(of(**{"Sample temperature [degC]": t + 15}))
    np.testing.assert_allclose(dma.temperature, t + 288.15)
    assert mentions(dma.columns[0], "from 5 'Sample temperature", "over: 1 'T [degC]'")
    holed = of(**{"Sample temperature [degC]": t}).read_text().splitlines()
    holed = [
        line if i % 2 else line.rpartition(",")[0] + ","
        for i, line in enumerate(holed[1:])
    ]
    head = "T [degC],f [Hz],G' [Pa],G'' [Pa],Sample temperature [degC]"
    check(read(write("\n".join([head, *holed]))), digits=1e-9)
    for more in (
        {"Temperature [K]": t + 373.15},
        {"frequency [Hz]": 2 * f},
        {"G'' [kPa]": l},
        {"storage [Pa]": s / 2},
    ):
        with refused("", "columns=", "differ"):
            em.read_dma(of(**more))


def test_moduli_of_both_kinds(write):
    path = write(
        table(
            "f [Hz],T [degC],E' [MPa],G'' [MPa],G' [MPa],E'' [MPa]",
            3 * [(1, 20, 6, 0.2, 2, 0.6)],
        )
    )
    for kind, storage, loss in (("shear", 2e6, 2e5), ("tensile", 6e6, 6e5)):
        np.testing.assert_allclose(
            [*read(path, kind=kind).storage[:1], read(path, kind=kind).loss[0]],
            [storage, loss],
        )
    with pytest.raises(em.InputError, match="kind must be 'shear'"):
        em.read_dma(write(table("f [Hz],T [degC],G' [Pa],G'' [Pa]")), kind="tensile")
    with pytest.raises(em.InputError, match="only one of both"):
        em.read_dma(write(table("f [Hz],T [degC],E' [MPa],G'' [MPa]")), kind="shear")


def test_columns_from_the_user(write):
    """By title or number, with units and logarithms; what a title says stays unless a
    unit is given.
    """
    rows = [(f, 2, 0.1, 20) for f in (1, 2, 4)]
    path = write(table("speed,stiff,damp,warm\nHz,MPa,MPa,C", rows))
    for columns in (
        {"frequency": "speed", "storage": 2, "loss": "damp", "temperature": "4"},
        {
            "frequency": "1 [Hz]",
            "storage": "stiff [MPa]",
            "loss": "3",
            "temperature": "warm [degC]",
        },
    ):
        check(
            read(path, columns=columns, kind="shear"),
            np.array([(f, 20, 2e6, 1e5) for f in (1, 2, 4)]),
        )
    bare = write("\n".join(",".join(map(str, row)) for row in rows))  # no header at all
    columns = {
        "frequency": "1 [rad/s]",
        "storage": "2 [MPa]",
        "loss": "3 [MPa]",
        "temperature": "4 [degC]",
    }
    np.testing.assert_allclose(
        read(bare, columns=columns, kind="shear").omega, [1, 2, 4]
    )
    ramp = write(
        table("T [degC],E' [MPa],E'' [MPa]", [(t, 2, 0.1) for t in (0, 10, 20)])
    )
    np.testing.assert_allclose(
        read(ramp, columns={"frequency": "10 Hz"}).omega, 20 * np.pi
    )
    logs = write(
        table(
            "log a [Hz],T [degC],x [MPa],y [MPa]",
            [(0, 20, np.log10(2), np.log10(0.1))] * 2,
        )
    )
    columns = {"frequency": "log10(1)", "storage": "log10(3)", "loss": "log10(4) [MPa]"}
    np.testing.assert_allclose(read(logs, columns=columns, kind="shear").storage, 2e6)
    swapped = read(
        write(table("f [Hz],T [degC],E'' [MPa],E' [MPa]", [(1, 20, 2, 0.1)])),
        columns={"storage": 3, "loss": 4},
    )
    np.testing.assert_allclose([swapped.storage[0], swapped.loss[0]], [2e6, 1e5])
    assert swapped.kind == "tensile"


def test_columns_of_one_isotherm_of_several(write):
    """Side by side only that with the named columns is read; lines above keep their
    temperatures.
    """
    parts = [part[:, [0, 2, 3]] for part in isotherms(ROWS)]
    text = "T = -10 degC,,,T = 0 degC,,,T = 20 degC,,\n" + table(
        ",".join(["f [Hz],G' [Pa],G'' [Pa]"] * 3), np.hstack(parts)
    )
    check(read(write(text), columns={"storage": 5, "loss": 6}), ROWS[6:12], 1e-10)
    text = "\n".join(
        f"T = {celsius} degC\n" + table("f [Hz],a,b", part)
        for celsius, part in zip((-10, 0, 20), parts, strict=True)
    )
    columns = {"storage": "2 [Pa]", "loss": "b [Pa]"}
    check(read(write(text), columns=columns, kind="shear"), digits=1e-10)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"kind": "bulk"}, ("kind", "'shear'", "'tensile'", "'bulk'")),
        ({"frequency_unit": "furlong"}, ("frequency_unit",)),
        ({"frequency_unit": "1/s"}, ("frequency_unit",)),
        ({"modulus_unit": 3}, ("modulus_unit",)),
        ({"columns": ["storage"]}, ("columns", "dict")),
        ({"columns": {"storge": 2}}, ("columns", "'storage'")),
        ({"columns": {"storage": 2.5}}, ("columns", "numbers")),
        ({"columns": {"storage": "3 [Hz]"}}, ("columns", "'Hz'")),
        ({"columns": {"storage": "G1 [MPa]"}}, ("columns", "file")),
        ({"temperature": -3.0}, ("temperature",)),
    ],
)
def test_bad_arguments(options, said, write):
    with refused(*said):
        em.read_dma(write(table("f [Hz],x [degC],G' [Pa],G'' [Pa]")), **options)


def test_files_that_are_none(tmp_path, write, monkeypatch):
    (tmp_path / "binary.csv").write_bytes(b"\x00\x01\x02" * 100)
    (tmp_path / "broken.xls").write_bytes(b"\xd0\xcf\x11\xe0" + b"\1" * 600)
    twice = write(table("f [Hz],T [degC],G' [Pa],G'' [Pa]"), "twice.csv")
    for path, said in (
        (tmp_path / "none.csv", "got '.*none.csv': No such file"),
        (tmp_path, "is a folder"),
        (3, "a file or a list"),
        (write("\n \n", "empty.csv"), "rows of numbers"),
        (tmp_path / "binary.csv", "binary"),
        (tmp_path / "broken.xls", "must be a spreadsheet"),
        ([twice, twice], "every file once"),
        (
            write("f [Hz],T [K],G' [Pa],G'' [Pa]\n1,2,a\n3,4,b", "no.csv"),
            "no row below .* is a measurement",
        ),
        (
            write(
                " ".join(["storage modulus G' (x) - y, z:"] * 500) + "\n1,2",
                "prose.csv",
            ),
            "there is no column of",
        ),
    ):
        with pytest.raises(em.InputError, match=said):
            em.read_dma(path)
    sheet = eplexor_xlsx(tmp_path, ROWS)[0]
    monkeypatch.setitem(__import__("sys").modules, "python_calamine", None)
    with pytest.raises(em.InputError, match=r"elastomdr\[excel\]"):
        em.read_dma(sheet)


def test_reptates_master_curves_and_relaxation(write):
    dma = read(
        write(
            (
                "T=-35;C1=8.8;\n 0.1 150 4500 -10 0\n 1.0 1500 9500 -20 0\n 10 9e3 "
                "2e4 -20 0\n"
            ),
            "pi.tts",
        )
    )
    np.testing.assert_allclose(
        [dma.temperature, dma.loss], [[238.15] * 3, [4500, 9500, 2e4]]
    )
    assert dma.shifted
    with pytest.warns(FitWarning, match="no temperature"):
        dma = em.read_dma(
            write("mwdfile=ps2.dmwd;\n 0.1 150 4500\n 1.0 1500 9500\n", "ps.tts")
        )
    with pytest.raises(em.InputError, match="--temperature 20degC"):
        em.fit.master_curve(dma)
    dma = read(write("T=20;gamma=1;\n 0.1 2e6\n 1.0 1e6\n", "pi.gt"), **HELD)
    np.testing.assert_allclose([dma.time, dma.relaxation], [[0.1, 1], [2e6, 1e6]])


@pytest.mark.parametrize(
    "titles",
    [
        "T,log_aT\nC,-",
        "T [K],a_T",
        "Temp. [degC],ln aT",
        "Temperature (°C),log10 shift factor",
    ],
)
def test_shift_lists(titles, write):
    celsius, log10_a = np.array([60.0, 20.0, -20.0]), np.array([-2.0, 0.0, 3.5])
    factor = {"a_T": 10**log10_a, "ln aT": np.log(10) * log10_a}.get(
        titles.split(",")[1], log10_a
    )
    shift = em.read_shifts(
        write(
            table(
                titles, np.column_stack([celsius + 273.15 * ("[K]" in titles), factor])
            )
        )
    )
    np.testing.assert_allclose(shift.temperature, celsius[::-1] + 273.15, rtol=1e-14)
    np.testing.assert_allclose(shift.log10_a_table, log10_a[::-1], atol=1e-12)
    np.testing.assert_allclose(shift.reference, 293.15)


BELOW = "w,Gp,Gpp,Gp,Gpp,Gp,Gpp,Gp,Gpp\n"
ABOVE = {
    "equal signs": f"T=-20,,T=0,,T=20,,T=40,\n{BELOW}",
    "three apart": f"T = -20,,,T = 0,,,T = 20,,,T = 40,,,\n{BELOW}",
    "each column": f",-20,-20,0,0,20,20,40,40\n{BELOW}",
    "bare": ",-20,,0,,20,,40,\nw,Gp,Gpp,Gp,Gpp,Gp,Gpp,Gp,Gpp\n",
    "label": "T,-20,,0,,20,,40,\nw,Gp,Gpp,Gp,Gpp,Gp,Gpp,Gp,Gpp\n",
    "unit": "T [degC],-20,,0,,20,,40,\nw,Gp,Gpp,Gp,Gpp,Gp,Gpp,Gp,Gpp\n",
    "blanks": "-20 0 20 40\nw Gp Gpp Gp Gpp Gp Gpp Gp Gpp\n",
    "behind": ",-20 degC,,0 degC,,20 degC,,40 degC,\nw,Gp,Gpp,Gp,Gpp,Gp,Gpp,Gp,Gpp\n",
}


@pytest.mark.parametrize("kind", ABOVE)
def test_temperatures_above_titles(tmp_path, kind):
    """36 points at four temperatures; one isotherm was all that the advice kept."""
    omega = np.geomspace(0.628319, 314.159, 9)
    celsius = np.array([-20.0, 0.0, 20.0, 40.0])
    columns = [
        np.geomspace(a, b, 9) * (1 - 0.01 * celsius[i // 2])
        for i in range(8)
        for a, b in [((1e6, 4e6), (2e5, 9e5))[i % 2]]
    ]
    mark = " " if kind == "blanks" else ","
    rows = [
        mark.join(f"{x:.9g}" for x in row) for row in np.column_stack([omega, *columns])
    ]
    text = ABOVE[kind] + "\n".join(rows)
    units = {"frequency_unit": "rad/s", "modulus_unit": "Pa", "kind": "shear"}
    name = "temperatures_above_titles.csv"
    for path in twins(tmp_path, name, text) if kind == "bare" else [tmp_path / name]:
        path.exists() or path.write_text(text)
        if kind not in ("unit", "behind"):
            with refused("", 1, -20, 0, 20, 40, 4):
                em.read_dma(path, **units)
        dma = em.read_dma(
            path,
            temperature_unit=None if kind in ("unit", "behind") else "degC",
            **units,
        )
        np.testing.assert_allclose(dma.temperature, np.repeat(celsius, 9) + 273.15)
        np.testing.assert_allclose(dma.omega, np.tile(omega, 4), rtol=1e-5)
    if kind != "bare":
        np.testing.assert_allclose(dma.storage, np.concatenate(columns[::2]), rtol=1e-8)


def test_temperatures_above_titles_in_kelvin(tmp_path):
    """The advice named degC alone: 253 degC in place of -20."""
    rows = np.outer(np.geomspace(1, 4, 9), np.linspace(1e3, 9e3, 9))
    file = tmp_path / "kelvin.csv"
    file.write_text(table(f",253.15,,273.15,,293.15,,313.15,\n{BELOW.strip()}", rows))
    units = {"frequency_unit": "rad/s", "modulus_unit": "kPa", "kind": "shear"}
    with refused("path_or_paths", "unit", "temperature_unit"):
        em.read_dma(file, **units)
    dma = em.read_dma(file, temperature_unit="K", **units)
    np.testing.assert_allclose(
        np.unique(dma.temperature), [253.15, 273.15, 293.15, 313.15]
    )
    file.write_text(file.read_text().replace("253.15", "-20"))
    with refused("", "kelvin.csv", "line 1"):
        em.read_dma(file, temperature_unit="K", **units)


def test_repeating_titles_without_temperatures_are_no_two_samples(tmp_path):
    """Three temperatures above four isotherms: the advice kept one isotherm."""
    rows = np.outer(np.geomspace(1, 4, 9), np.linspace(1e3, 9e3, 9))
    file = tmp_path / "isotherms.csv"
    file.write_text(table(f"T=-20,,T=0,,T=20,,,,\n{BELOW.strip()}", rows))
    with refused("", "need their temperatures"):
        em.read_dma(file, frequency_unit="rad/s", modulus_unit="kPa", kind="shear")


def test_isotherms_side_by_side_without_temperatures_are_asked_for_them(write):
    rows = np.column_stack(
        [np.geomspace(1, 100, 9), *np.geomspace(1e6, 4e6, 36).reshape(4, 9)]
    )
    file = write(table("w [rad/s],G' [Pa],G'' [Pa],G' [Pa],G'' [Pa]", rows))
    with refused("", "side by side"):
        em.read_dma(file, kind="shear")


def test_vertical_factors_beside_shift_factors(tmp_path, capsys):
    """A warning says how to give them, and the command uses them: isotherms made with b_T of 1.3, 1.15, 1, 0.9."""
    celsius, b = np.array([-20.0, 0.0, 20.0, 40.0]), np.array([1.3, 1.15, 1.0, 0.9])
    rubber = em.Prony(6e5, [2e7, 4e6, 8e5], [1e-4, 1e-2, 1.0], kind="shear")
    law = em.Arrhenius(8e4, 293.15)
    log10_a = np.asarray(law.log10_a(celsius + 273.15))
    shifts = "T [C],aT,bT\n" + "\n".join(
        f"{t:g},{10**a:.6g},{f:g}" for t, a, f in zip(celsius, log10_a, b, strict=True)
    )
    hertz = np.geomspace(0.1, 50, 9)
    points = []
    for t, a, f in zip(celsius, log10_a, b, strict=True):
        moduli = f * rubber.complex_modulus(2 * np.pi * hertz * 10**a)
        points += [
            f"{t:g},{x:.6g},{m.real / 1e6:.6g},{m.imag / 1e6:.6g}"
            for x, m in zip(hertz, moduli, strict=True)
        ]
    isotherms = "T [C],f [Hz],G' [MPa],G'' [MPa]\n" + "\n".join(points)
    both = zip(
        twins(tmp_path, "isotherms_with_bT.csv", isotherms),
        twins(tmp_path, "shifts_with_bT.csv", shifts),
        strict=True,
    )
    for data, factors in both:
        with warned(FitWarning, 3, "'bT'", 0.1139):
            shift = em.read_shifts(factors)
        dma = em.read_dma(data, kind="shear")
        given = em.VerticalTable(celsius + 273.15, b)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FitWarning)  # of where the data end
            fit = em.fit.material(dma, 293.15, shift=shift, vertical=given)
        assert max(fit.misfit.values()) < 1e-3
        np.testing.assert_allclose(fit.material.vertical.b(celsius + 273.15), b)
        with pytest.raises(em.InputError, match=r"1 at the reference.*got 1.15"):
            em.fit.material(dma, 273.15, shift=shift, vertical=given)
        em.save_material(fit.material, tmp_path / "kept.toml")
        kept = em.load_material(tmp_path / "kept.toml").vertical
        np.testing.assert_allclose(kept.b(celsius + 273.15), b)
        # the command takes both from the file
        out = tmp_path / "out"
        command = [
            "fit",
            data,
            "--reference",
            "20degC",
            "--verbose",
            "--shift",
            factors,
        ]
        assert main([*map(str, command), "--kind", "shear", "--out", str(out)]) == 0
        said = capsys.readouterr().out
        assert mentions(said, 30, "material")
        (fitted,) = out.glob("*.toml")
        law = em.load_material(fitted).vertical
        np.testing.assert_allclose(law.b(celsius + 273.15), b)
    (tmp_path / "plain.csv").write_text(
        shifts.replace("1.3", "1").replace("1.15", "1").replace("0.9", "1")
    )
    em.read_shifts(tmp_path / "plain.csv")


TITLED = ("b_T", "b(T)", "bV", "vertical", "vertical factor")


@pytest.mark.parametrize("title", [*TITLED, "y-shift", "rho T", "delta"])
def test_no_column_beside_shift_factors_is_lost(tmp_path, title):
    """Vertical factors by their usual titles, others as what was passed over."""
    file = tmp_path / "shifts.csv"
    file.write_text(f"T [C],a(T),{title},note\n-20,1e5,1.3,a\n0,30,1.1,b\n20,1,1,c")
    with pytest.warns(FitWarning, match=r"column 3|3 '") as caught:
        shift = em.read_shifts(file)
    (said,) = (str(one.message) for one in caught)
    assert ("log10 b_T from 0.0000 to 0.1139" in said) is (title in TITLED)
    assert "note" not in said
    np.testing.assert_allclose(shift.log10_a_table, np.log10([1e5, 30, 1]))


@pytest.mark.parametrize(
    "title",
    [
        "ln aT,11.5,3.4,0",
        "aT std,9,3,2",
        "no,1,2,3",
        "T_ref,20,20,20",
        "T [K],253.15,273.15,293.15",
    ],
)
def test_what_cannot_be_vertical_factors_is_not_taken_for_them(tmp_path, title):
    title, *numbers = title.split(",")
    rows = zip((-20, 0, 20), (1e5, 30, 1), numbers, strict=True)
    body = "\n".join(f"{t},{a:g},{x}" for t, a, x in rows)
    (tmp_path / "shifts.csv").write_text(f"T [C],aT,{title}\n{body}")
    shift = em.read_shifts(tmp_path / "shifts.csv")
    np.testing.assert_allclose(shift.log10_a_table, np.log10([1e5, 30, 1]))


@pytest.mark.parametrize(
    "title",
    [
        *("log aT WLF", "aT fit", "a_T (smoothed)", "WLF", "WLF aT", "log WLF aT"),
        *("shift factor WLF", "WLF shift factor"),
    ],
)
def test_a_second_shift_that_differs_is_refused(tmp_path, title):
    file, logs = tmp_path / "shifts.csv", np.array([4.6, 1.3, 0.0])
    second = logs if "log" in title else 10**logs
    rows = zip((-20, 0, 20), (1e5, 30, 1), second, strict=True)
    file.write_text(
        f"T [C],aT,{title}\n" + "\n".join(f"{t},{a:g},{x}" for t, a, x in rows)
    )
    with refused("", "2 'aT'", f"3 {title!r}", "differ"):
        em.read_shifts(file)
    named = f"log10({title})" if "log" in title else title
    by_user = em.read_shifts(file, columns={"shift": named})
    np.testing.assert_allclose(by_user.log10_a_table, logs)


@pytest.mark.parametrize("title", ["aT uncertainty", "95% CI", "aT 95% CI", "aT sd"])
def test_the_uncertainty_of_a_shift_is_no_second_shift(tmp_path, title):
    file = tmp_path / "shifts.csv"
    file.write_text(f"T [C],log aT,{title}\n-20,5,0.3\n0,1.5,0.2\n20,0,0.1")
    np.testing.assert_allclose(em.read_shifts(file).log10_a_table, [5, 1.5, 0])


def test_vertical_factors_under_another_title_where_no_shift_is_one(tmp_path):
    file = tmp_path / "shifts.csv"
    file.write_text("T [C],aT,y-shift\n-20,1e5,1.3\n0,30,1.1\n25,0.4,0.98")
    with warned(FitWarning, "3 'y-shift'", "title it so"):
        em.read_shifts(file)


@pytest.mark.parametrize("least", ["0", "-0.04"])
def test_vertical_factors_in_logarithms_are_refused_by_name(tmp_path, least):
    file = tmp_path / "shifts.csv"
    file.write_text(f"T [C],aT,bT\n-20,1e5,0.11\n0,30,0.05\n20,1,{least}")
    with refused("", "3 'bT'", "logarithms", "log10(3)"):
        em.read_shifts(file)
    with refused("", "logarithms"):
        vertical_factors(file)
    with warned(FitWarning, "log10 b_T"):
        em.read_shifts(file, columns={"vertical": "log10(3)"})


def test_a_hole_in_vertical_factors_is_said(tmp_path):
    file = tmp_path / "shifts.csv"
    file.write_text("T [C],aT,bT\n-20,1e5,1.3\n0,30,\n20,1,1")
    with warned(FitWarning, "3 'bT'", "273.15 K", "interpolated"):
        law = vertical_factors(file)
    np.testing.assert_allclose(law.factor, [1.3, 1])


def test_a_unit_of_levels_beside_moduli_is_passed_over(tmp_path):
    """`dB re 1e-6 m` in the row of units ended every reader in a traceback."""
    hertz = np.tile(np.geomspace(0.1, 50, 9), 4)
    celsius = np.repeat([-20.0, 0.0, 20.0, 40.0], 9)
    rows = [
        f"{t:g},{f:.6g},{30 + f:.6g},{3 + f:.6g},90"
        for t, f in zip(celsius, hertz, strict=True)
    ]
    text = "T,f,G',G'',level\nC,Hz,MPa,MPa,dB re 1e-6 m\n" + "\n".join(rows)
    for path in twins(tmp_path, "dma_unit_row_db.csv", text):
        dma = em.read_dma(path, kind="shear")
        assert dma.size == 36
        np.testing.assert_allclose(dma.temperature, celsius + 273.15)
        np.testing.assert_allclose(dma.omega, 2 * np.pi * hertz, rtol=1e-5)


def test_swapped_moduli_are_refused_where_a_passive_material_has_them_exchanged(
    tmp_path,
):
    """And nowhere else: melt, glass, filled rubber and gum, over one and three decades,
    with 5 % of noise.
    """
    law, times = em.WLF(7.0, 120.0, 293.15), np.geomspace(1e-9, 1e3, 25)
    melt = em.Prony(
        0.0, [1e9, 1e8, 1e6, 3e5, 3e5], [1e-9, 1e-7, 1e-5, 1e-3, 1e-2], shift=law
    )
    glass = em.Prony(1e9, np.full(25, 1e7), times, shift=law)  # tan delta of 0.01
    filled = em.Prony(4e6, 4e5 * times**-0.05, times, shift=law)
    from elastomdr.fit.isotherms import moduli_exchanged

    for material in (melt, glass, filled, KNOWN):
        for decades, noise in ((1.0, 0.002), (3.0, 0.05)):
            f, t, s, l = measure(
                material,
                np.array([-20.0, 20.0]),
                np.geomspace(0.1, 0.1 * 10**decades, 9),
                noise,
            ).T
            assert not moduli_exchanged(t + 273.15, 2 * np.pi * f, s, l)
            assert moduli_exchanged(t + 273.15, 2 * np.pi * f, l, s)
    omega = np.geomspace(0.1, 100, 20)
    rouse = 1e5 * np.sqrt(omega)
    assert not moduli_exchanged(np.full(20, 300.0), omega, rouse, rouse)  # alike
    # a ramp
    assert not moduli_exchanged(
        np.arange(20) + 200.0, np.full(20, 6.28), rouse, 10 * rouse
    )
    # damaged
    assert not moduli_exchanged(
        np.full(20, 300.0), omega, rouse, np.where(omega > 1, 1e306, rouse)
    )
    rows = measure(KNOWN)[:, [0, 1, 3, 2]]
    dma = em.read_dma(plain_csv(tmp_path, rows))
    named, advice = (
        "storage from column 3, loss from column 4",
        "--column storage=4 --column loss=3",
    )
    with pytest.raises(em.InputError, match=f"look exchanged.*{named}.*{advice}"):
        em.fit.material(dma)
    exchanged = em.read_dma(
        plain_csv(tmp_path, rows), columns={"storage": 4, "loss": 3}
    )
    np.testing.assert_allclose(exchanged.storage, rows[:, 3])


def test_arrays_and_joining(tmp_path):
    f, t, s, l = ROWS.T
    dma = em.fit.dma(2 * np.pi * f, s, l, t + 273.15, kind="shear")
    parts = [
        em.fit.dma(
            2 * np.pi * p[:, 0], p[:, 2], p[:, 3], p[0, 1] + 273.15, kind="shear"
        )
        for p in isotherms(ROWS)
    ]
    np.testing.assert_array_equal(em.fit.join(*parts).storage, dma.storage)
    np.testing.assert_allclose(
        em.read_dma(plain_csv(tmp_path, ROWS)[0]).storage, dma.storage
    )
    for wrong, said in (
        (
            lambda: em.fit.join(
                dma, em.fit.dma([1.0], [1e6], [1e5], 293.15, kind="tensile")
            ),
            "one kind",
        ),
        (
            lambda: em.fit.dma([1, 2], [1e6, 1e6], [1e5, -1], 293.15, kind="shear"),
            r"loss must be positive .* got -1",
        ),
        (lambda: em.fit.dma([1.0], [1e6], [1e5], 293.15, kind="bulk"), "kind must be"),
        (
            lambda: em.fit.Dma(
                np.full(3, 293.15), np.ones(3), np.ones(2), np.ones(3), "shear"
            ),
            "storage must be a list",
        ),
        (
            lambda: em.fit.Dma(
                np.full(2, 293.15), np.ones(2), -np.ones(2), np.ones(2), "shear"
            ),
            "storage must be positive",
        ),
    ):
        with pytest.raises(em.InputError, match=said):
            wrong()


TITLES = ("Frequency [Hz]", "Temperature [degC]", "E' [MPa]", "E'' [MPa]")
SCALE = np.array([1.0, 1.0, 1e-6, 1e-6])


def frames():
    """The same measurement as tables in memory."""
    values = ROWS * SCALE
    frame = pd.DataFrame(values, columns=TITLES)
    names, units = zip(
        *(title.removesuffix("]").split(" [") for title in TITLES), strict=True
    )
    two_rows = pd.DataFrame(
        values, columns=pd.MultiIndex.from_tuples(zip(names, units, strict=True))
    )
    columns = zip(names, units, values.T, strict=True)
    quantities = pd.DataFrame(
        {name: pd.Series(x, dtype=f"pint[{unit}]") for name, unit, x in columns}
    )
    return {
        "pandas": frame,
        "units in a second row": two_rows,
        "temperature as index": frame.set_index(TITLES[1]),
        "pint-pandas": quantities,
        "polars": pl.DataFrame(dict(zip(TITLES, values.T, strict=True))),
        "a list": [frame[:6], frame[6:]],
    }


@pytest.mark.parametrize("name", frames())
def test_tables_in_memory_are_read_like_files(name):
    check(read(frames()[name]))


def test_a_table_in_memory_without_units_asks_as_a_file_does():
    frame = pd.DataFrame(ROWS, columns=["f", "T", "E'", "E''"])
    with refused("", 1, "'f'"):
        em.read_dma(frame)
    check(read(frame, frequency_unit="Hz", temperature_unit="degC", modulus_unit="Pa"))
