"""Files that were misread or refused without advice: each is read, or answered with
what to do, and that works.
"""

import re
import warnings

import numpy as np
import openpyxl
import pytest

import elastomdr as em
from elastomdr.cli.fit import _column
from elastomdr.cli.main import main
from elastomdr.fit import FitWarning

from ..refused import mentions, refused

F = np.geomspace(0.1, 100.0, 30)
STORAGE, LOSS = 1 + F**0.3, 0.2 * F**0.3  # MPa
TANGENT = LOSS / STORAGE


def written(path, titles, *columns, mark=","):
    rows = zip(*columns, strict=True)
    cells = (
        mark.join(x if isinstance(x, str) else f"{x:.12g}" for x in row) for row in rows
    )
    path.write_text("\n".join([titles, *cells]), encoding="utf-8")
    return path


HELD = {"strain": "1 %"}  # which no file of a modulus alone says


def read(path, **options):
    """Without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return em.read_dma(path, **options)


def advised(message):
    """The values of `columns=` that a message offers, which are those of its --column
    options as well.
    """
    python = [eval(text) for text in re.findall(r"columns=(\{.*?\})", message)]
    python = [{role: str(one) for role, one in each.items()} for each in python]
    shell = [
        dict([_column(one or other)])
        for one, other in re.findall(r"--column (?:'(.*?)'|(\S+?))\)", message)
    ]
    assert python
    assert python == shell
    return python


@pytest.mark.parametrize("mark", [" ", "\t", ","])
def test_titles_of_many_columns(mark, tmp_path):
    celsius = np.arange(-60.0, 64.0, 4.0)
    titles = [
        title
        for t in celsius
        for title in (f"G'({t:g}degC)[MPa]", f"G''({t:g}degC)[MPa]")
    ]
    moduli = [
        column
        for i in range(celsius.size)
        for column in ((2 - 0.03 * i) * STORAGE, LOSS)
    ]
    dma = read(
        written(
            tmp_path / "wide.txt", mark.join(["f[Hz]", *titles]), F, *moduli, mark=mark
        )
    )
    assert len(mark.join(titles)) > 500
    np.testing.assert_allclose(np.unique(dma.temperature), celsius + 273.15)
    np.testing.assert_allclose(
        dma.storage[-F.size :], (2 - 0.03 * (celsius.size - 1)) * STORAGE * 1e6
    )


@pytest.mark.parametrize("reader", [em.read_dma, em.read_friction])
def test_too_many_columns_are_refused_at_once(reader, tmp_path):
    titles = ",".join(["f [Hz]", *(f"column {i} [MPa]" for i in range(20_000))])
    path = written(tmp_path / "wide.csv", titles, *[np.ones(3)] * 20_001)
    with pytest.raises(
        em.InputError, match=r"2,000 columns at most.* 20,001"
    ) as caught:
        reader(path)
    assert len(str(caught.value)) < 300


def test_loss_tangent_in_percent_without_a_unit_is_asked_for(tmp_path):
    path = written(
        tmp_path / "a.csv",
        "f [Hz],T [degC],E' [MPa],tan delta",
        F,
        0 * F + 20,
        STORAGE,
        100 * TANGENT,
    )
    with refused("", "unit") as caught:
        read(path)
    percent, plain = advised(str(caught.value))
    np.testing.assert_allclose(read(path, columns=percent).loss, 1e6 * LOSS)
    np.testing.assert_allclose(read(path, columns=plain).loss, 1e8 * LOSS)


def test_loss_tangent_of_a_melt_with_its_unit_is_believed(tmp_path):
    path = written(
        tmp_path / "a.csv",
        "f [Hz],T [degC],G' [MPa],tan delta [1]",
        F,
        0 * F + 20,
        STORAGE,
        20 + 0 * F,
    )
    np.testing.assert_allclose(read(path).loss, 20e6 * STORAGE)


@pytest.mark.parametrize("unit", ["", " [-]", " [%]"])
def test_loss_tangent_that_contradicts_the_moduli_is_asked_for(unit, tmp_path):
    factor = 100 if "%" in unit else 1
    titles = f"f [Hz],T [degC],E' [MPa],E'' [kPa],tan delta{unit}"
    path = written(
        tmp_path / "a.csv",
        titles,
        F,
        0 * F + 20,
        STORAGE,
        1e3 * LOSS,
        1.3 * factor * TANGENT,
    )
    with refused("", 1.3, 4, "\"E''", 3) as caught:
        read(path)
    loss, tangent = advised(str(caught.value))
    np.testing.assert_allclose(read(path, columns=loss).loss, 1e6 * LOSS)
    np.testing.assert_allclose(read(path, columns=tangent).loss, 1.3e6 * LOSS)


@pytest.mark.parametrize("factor", [1.0, 1.04, 100.0])
def test_loss_tangent_that_agrees_is_passed_over(factor, tmp_path):
    titles = "f [Hz],T [degC],E' [MPa],E'' [MPa],tan delta"
    path = written(
        tmp_path / "a.csv", titles, F, 0 * F + 20, STORAGE, LOSS, factor * TANGENT
    )
    np.testing.assert_allclose(read(path).loss, 1e6 * LOSS)


def test_of_two_columns_that_differ_either_is_read_by_the_number_that_is_told(tmp_path):
    titles = "f [Hz],G'' [MPa],G' [MPa],T [degC],G' [MPa]"
    warm = np.full(F.size, 20.0)
    path = written(tmp_path / "two.csv", titles, F, LOSS, STORAGE, warm, 2 * STORAGE)
    with refused("path_or_paths") as caught:
        em.read_dma(path)
    told = re.findall(r"'storage': (\d)", caught.value.hint)
    for number, times in zip(told, (1, 2), strict=True):
        found = em.read_dma(path, columns={"storage": int(number)})
        np.testing.assert_allclose(found.storage, times * 1e6 * STORAGE)


def test_a_loss_that_is_negative_is_refused(tmp_path):
    """Of the convention exp(-i omega t): nobody turns its sign."""
    titles = "f [Hz],T [degC],G' [MPa],G'' [MPa]"
    path = written(tmp_path / "a.csv", titles, F, 0 * F + 20, STORAGE, -LOSS)
    with refused("", 2, "G''"):
        em.read_dma(path)


def test_too_few_points_say_which_rows_were_left_out(tmp_path):
    sign = np.where(np.arange(F.size) < 4, 1.0, -1.0)
    sign[::2] *= -1
    sign[4:] = np.where(np.arange(F.size - 4) % 4 < 3, -1.0, np.nan)
    sign[:4] = 1.0
    path = written(
        tmp_path / "a.csv",
        "f [Hz],T [degC],G' [MPa],G'' [MPa]",
        F,
        0 * F + 20,
        STORAGE,
        sign * LOSS,
    )
    with pytest.warns(FitWarning, match="26 rows left out"):
        dma = em.read_dma(path)
    with refused("dma", 4, 26, "a.csv"):
        em.fit.master_curve(dma)


TIMES = np.unique(np.geomspace(1, 7200, 40).round(1))


def clock(seconds, start=0):
    seconds = seconds + start
    return (
        f"{int(seconds) // 3600:02d}:{int(seconds) // 60 % 60:02d}:{seconds % 60:04.1f}"
    )


@pytest.mark.parametrize(
    ("titles", "mark"),
    [
        ("time,G(t) [MPa]", ","),
        ("t [hh:mm:ss];G(t) [MPa]", ";"),
        ("time G(t)[MPa]", " "),
    ],
)
def test_times_as_hours_minutes_seconds(titles, mark, tmp_path):
    remark = "Start: 14:05:33\nOperator,A. B.,14:05:33,2\n"
    cells = [clock(t).replace(".", ",") if mark == ";" else clock(t) for t in TIMES]
    path = written(
        tmp_path / "a.txt", remark + titles, cells, 1 + TIMES**-0.2, mark=mark
    )
    dma = read(path, temperature=293.15, columns=HELD)
    np.testing.assert_allclose(dma.time, TIMES)
    np.testing.assert_allclose(dma.relaxation, 1e6 * (1 + TIMES**-0.2))


def test_durations_in_a_spreadsheet(tmp_path):
    import datetime

    book = openpyxl.Workbook()
    book.active.append(["time", "G(t) [MPa]"])
    for t in TIMES:
        book.active.append([datetime.timedelta(seconds=float(t)), 1 + float(t) ** -0.2])
    book.save(tmp_path / "a.xlsx")
    np.testing.assert_allclose(
        read(tmp_path / "a.xlsx", temperature=293.15, columns=HELD).time, TIMES
    )


@pytest.mark.parametrize(
    ("start", "hour"),
    [(50_000, r"13\.89"), (5_000, r"1\.389"), (85_800, r"23\.83")],
    ids=["afternoon", "longer than its start", "across midnight"],
)
def test_times_of_day_are_refused(start, hour, tmp_path):
    cells = [clock((t + start) % 86_400) for t in TIMES]
    path = written(tmp_path / "a.csv", "time,G(t) [MPa]", cells, 1 + TIMES**-0.2)
    with pytest.raises(
        em.InputError, match=rf"begins at {hour} h and lasts .* s, a time of day"
    ):
        read(path, temperature=293.15)


def test_formulas_without_values_are_refused_with_what_to_do(tmp_path):
    book = openpyxl.Workbook()
    book.active.append(["f [Hz]", "T [degC]", "G' [MPa]", "G'' [MPa]"])
    for i, f in enumerate(F, start=2):
        book.active.append([float(f), 20.0, f"=1+A{i}^0.3", f"=0.2*A{i}^0.3"])
    book.save(tmp_path / "a.xlsx")
    with refused("path_or_paths", "LibreOffice"):
        read(tmp_path / "a.xlsx")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_marks_of_windows_editors(encoding, tmp_path, capsys):
    em.save_material(
        em.Prony(1e6, [1e6], [1e-3], name="rubber"), tmp_path / "rubber.toml"
    )
    scene = """material = "rubber.toml"\n[indenter]\nshape = "sphere"\nradius = "5 mm"
[contact]\nload = "1 N"\nvelocity = "1 m/s"\n"""
    (tmp_path / "scene.toml").write_text(scene.replace("\n", "\r\n"), encoding=encoding)
    text = (tmp_path / "rubber.toml").read_text(encoding="utf-8")
    (tmp_path / "rubber.toml").write_text(text.replace("\n", "\r\n"), encoding=encoding)
    assert main(["plan", str(tmp_path / "scene.toml")]) == 0
    assert "rubber" in capsys.readouterr().out


def test_a_scene_that_is_no_utf8_says_what_to_do(tmp_path, capsys):
    (tmp_path / "scene.toml").write_bytes('# 20 °C\nmaterial = "x"\n'.encode("cp1252"))
    assert main(["plan", str(tmp_path / "scene.toml")]) == 2
    assert mentions(capsys.readouterr().err, "UTF-8", 1)
