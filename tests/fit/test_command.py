"""`elastomdr fit`: what it prints and writes, and what it refuses in one line."""

import argparse

import pytest

from elastomdr.cli.fit import Fit, add_arguments, content_of
from elastomdr.cli.main import main
from elastomdr.cli.schema import decode
from elastomdr.material.check import check_material

from ..cli.cli_cases import arguments
from ..io.dma_files import KNOWN, measure, two_rows

ROWS = measure(KNOWN)


def test_command_line(tmp_path, monkeypatch, capsys):
    two_rows(tmp_path, ROWS)
    monkeypatch.chdir(tmp_path)
    assert (
        main(
            [
                "fit",
                "two.csv",
                "--reference",
                "-5degC",
                "--out",
                "new/folder",
                "--name",
                "fitted",
                "--verbose",
            ]
        )
        == 0
    )
    out, err = capsys.readouterr()
    assert err == ""
    for said in (
        "log10 a_T",
        "WLF",
        "residuals",
        "-5 degC",
        "10 more files",
        "fitted.toml",
    ):
        assert said in out
    assert check_material(tmp_path / "new" / "folder" / "fitted.toml") == []
    scene = (
        'material = "new/folder/fitted.toml"\ntemperature = "20 '
        'degC"\n[indenter]\nshape = "sphere"\nradius = "5 mm"\n'
    )
    (tmp_path / "s.toml").write_text(
        scene + '[contact]\nload = "1 N"\nvelocity = ["1 mm/s", "1 cm/s"]\n'
    )
    assert arguments("friction", "s.toml")["material"].name == "fitted"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["two.csv", "--reference", "20 parsec"], "a temperature"),
        (["tow.csv"], "'tow.csv': No such"),
        (["two.csv", "--kind", "shearing"], "--kind must be"),
        (["two.csv", "--terms", "0"], "terms must be"),
        (["two.csv", "--law", "wolf"], "law must be"),
        (
            ["two.csv", "--reference", "-200degC"],
            "-10 to 60 degC",
        ),
        (["two.csv", "--name", "a/b"], "--name must be"),
        (["two.csv", "--column", "storage"], "--column[0] must be"),
        (["two.csv", "--poisson", "0.9"], "poisson must be"),
        (["two.csv", "--out", "two.csv"], "--out must be a folder"),
        (["nounit.csv"], "(--frequency-unit)"),
        (["notemperature.csv"], "--temperature 20degC"),
        (["short.csv"], "five points"),
        (["two.csv", "tensile.csv"], "one kind"),
        (["one.csv"], "range of frequencies"),
        (["hot.csv"], "not between 100 and 800"),
        (["noloss.csv"], "--storage-only"),
    ],
)
def test_bad_input_is_one_line_and_no_file(
    arguments, said, tmp_path, monkeypatch, capsys
):
    two_rows(tmp_path, ROWS)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "nounit.csv").write_text(
        "f,T [K],G' [Pa],G'' [Pa]\n1,293,2e6,1e5\n2,293,2e6,1e5\n"
    )
    (tmp_path / "notemperature.csv").write_text(
        "f [Hz],G' [Pa],G'' [Pa]\n" + "\n".join(f"{f},2e6,1e5" for f in range(1, 9))
    )
    (tmp_path / "one.csv").write_text(
        "f [Hz],T [K],G' [Pa],G'' [Pa]\n" + 9 * "10,293,2e6,1e5\n"
    )
    (tmp_path / "hot.csv").write_text(
        "f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "1,2e5,2e6,1e5\n9,9e5,2e6,1e5\n" * 4
    )
    (tmp_path / "noloss.csv").write_text(
        "f [Hz],T [degC],G' [Pa],damp\n1,20,2e6,1\n2,20,2e6,1\n"
    )
    (tmp_path / "short.csv").write_text(
        "f [Hz],T [degC],G' [Pa],G'' [Pa]\n1,20,2e6,1e5\n"
    )
    (tmp_path / "tensile.csv").write_text(
        "f [Hz],T [degC],E' [Pa],E'' [Pa]\n1,20,2e6,1e5\n2,20,2e6,1e5\n"
    )
    before = sorted(path.name for path in tmp_path.rglob("*"))
    assert main(["fit", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("elastomdr: error: ")
    assert err.count("\n") == 1
    assert said in err
    assert sorted(path.name for path in tmp_path.rglob("*")) == before


def test_temperatures_without_a_unit_are_in_celsius():
    def asked(*arguments):
        parser = argparse.ArgumentParser()
        add_arguments(parser)
        return decode(Fit, content_of(parser.parse_args(["a.csv", *arguments])))

    kelvin = [253.15, 273.15, 293.15]
    assert asked("--temperature", "-20,0,20").temperature == pytest.approx(kelvin)
    assert asked("--reference", "293.15 K").reference == 293.15
    assert asked("--reference", "20").reference == 293.15
