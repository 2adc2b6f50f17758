"""The format of material files: every fault is one clear line, and a file is written
completely or not at all.
"""

import os

import pytest

import elastomdr as em
from elastomdr.errors import InputError

from .check import check_material

GOOD = """
name = "mine"
description = "A rubber"
kind = "shear"
reference_temperature = 293.15
poisson = 0.5
equilibrium = 1e6
moduli = [1e6, 2e6]
times = [1e-3, 1.0]
[shift]
law = "WLF"
c1 = 5.0
c2 = 100.0
reference = 293.15
[range]
omega = [1.0, 1e3]
temperature = [263.15, 333.15]
[source.moduli]
citation = "Here"
grade = "measured"
[source.shift]
citation = "There"
grade = "published fit"
[source.poisson]
citation = "Assumed"
grade = "illustrative"
[source.range]
citation = "Assumed"
grade = "illustrative"
"""


@pytest.fixture
def file(tmp_path):
    def write(text=GOOD, name="mine.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


def one_line(error: pytest.ExceptionInfo[InputError], *parts: str) -> None:
    text = str(error.value)
    assert "\n" not in text
    for part in parts:
        assert part in text


def test_unknown_names_and_paths(file):
    path = file()
    with pytest.raises(InputError) as error:
        em.load_material("vhb4910")
    one_line(error, "'vhb4910'", "Did you mean 'vhb-4910'?")
    with pytest.raises(InputError) as error:
        em.load_material(path.with_name("mien.toml"))
    one_line(error, "mien.toml", "Did you mean 'mine.toml'?")
    with pytest.raises(InputError) as error:
        em.load_material(path.parent)
    one_line(error, str(path.parent), "Is a directory")
    with pytest.raises(InputError) as error:
        em.load_material(3)  # pyright: ignore[reportArgumentType]
    one_line(error, "got 3")


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("moduli = [1e6, 2e6]", "moduli = [1e6,, 2e6]", ["valid TOML", "line 8"]),
        ("poisson = 0.5", "poisson = 0.5\npoisson = 0.4", ["valid TOML", "line 7"]),
        ("moduli", "modulli", ["modulli must be", "Did you mean 'moduli'?"]),
        ("c2 =", "c3 =", ["[shift] c3 must be", "law, c1, c2"]),
        (
            "[source.moduli]",
            "[source.modulus]",
            ["[source] modulus must be", "Did you mean 'moduli'?"],
        ),
        ("times = [1e-3, 1.0]", "", ["times must be given"]),
        ("poisson = 0.5", "", ["poisson must be given, or bulk"]),
        ("c2 = 100.0", "", ["[shift] c2 must be given"]),
        (
            "equilibrium = 1e6",
            'equilibrium = "1 MPa"',
            ["equilibrium must be a finite number, got '1 MPa'"],
        ),
        (
            "equilibrium = 1e6",
            "equilibrium = true",
            ["equilibrium must be a finite number, got True"],
        ),
        (
            "equilibrium = 1e6",
            "equilibrium = inf",
            ["equilibrium must be a finite number, got inf"],
        ),
        (
            "[1e6, 2e6]",
            "[1e6, nan]",
            ["moduli must be a list of finite numbers", "nan"],
        ),
        (
            "[1e6, 2e6]",
            "1e6",
            ["moduli must be a list of finite numbers, got 1e+06"],
        ),
        (
            'law = "WLF"',
            'law = "WFL"',
            ["[shift] law must be one of WLF", "Did you mean 'WLF'?"],
        ),
        ('law = "WLF"', "law = [1]", ["[shift] law must be one of WLF", "got [1]"]),
        (
            "omega = [1.0, 1e3]",
            "omega = [1e3, 1.0]",
            ["[range] omega", "the lower first"],
        ),
        (
            '"published fit"',
            '"published"',
            ["[source.shift] grade", "Did you mean 'published fit'?"],
        ),
        (
            'kind = "shear"',
            'kind = "bending"',
            ["kind must be 'shear' or 'tensile', got 'bending'"],
        ),
        (
            "[1e6, 2e6]",
            "[1e6, -2e6]",
            ["moduli must be zero or positive and finite, got -2e+06"],
        ),
        ("[1e-3, 1.0]", "[1.0]", ["times must be as long as moduli", "got 1"]),
        ("poisson = 0.5", "poisson = 0.6", ["poisson must be", "0.6"]),
        (
            "poisson = 0.5",
            "poisson = 0.5\nbulk = 2e9",
            ["bulk must be left out", "2e+09"],
        ),
        ("c1 = 5.0", "c1 = -5.0", ["c1 must be positive"]),
        (
            "e_temperature = 293.15",
            "e_temperature = 300.0",
            ["reference_temperature", "293.15 K", "got 300"],
        ),
    ],
)
def test_every_fault_in_a_file_is_one_clear_line(file, old, new, parts):
    assert GOOD.count(old) >= 1
    path = file(GOOD.replace(old, new, 1))
    with pytest.raises(InputError) as error:
        em.load_material(path)
    one_line(error, str(path), *parts)
    assert check_material(path) == [str(error.value)]


def test_a_file_that_is_not_text(tmp_path):
    path = tmp_path / "binary.toml"
    path.write_bytes(b'name = "a"\nkind = "\xff"\n')
    with pytest.raises(InputError) as error:
        em.load_material(path)
    one_line(error, str(path), "UTF-8", "line 2")


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("moduli = [1e6, 2e6]", "moduli = [1e6, 2.0e-3]", "moduli[1] is 0.002 Pa"),
        ("equilibrium = 1e6", "equilibrium = 0.5", "equilibrium is 0.5 Pa"),
        (
            "moduli = [1e6, 2e6]",
            "moduli = [1e6, 2e11]",
            "all moduli is 2.00002e+11 Pa",
        ),
        ("times = [1e-3, 1.0]", "times = [1e-18, 1.0]", "times[0] is 1e-18 s"),
        ("[263.15, 333.15]", "[-10.0, 333.15]", "numbers for temperature"),
        (
            "[263.15, 333.15]",
            "[303.15, 333.15]",
            "reference_temperature is 293.15 K, outside 303.15 to 333.15 K",
        ),
        (
            "[263.15, 333.15]",
            "[173.15, 333.15]",
            "shift law does not",
        ),
        ("reference_temperature = 293.15", "", "reference_temperature is missing"),
        ("temperature = [263.15, 333.15]", "", "temperature is missing"),
        ("omega = [1.0, 1e3]", "", "omega (or time) is"),
        ("omega = [1.0, 1e3]", "omega = [0.0, 1e3]", "numbers for omega"),
        ('citation = "There"', "", "missing in [source.shift]"),
        ('grade = "measured"', "", "grade is missing"),
        (
            '"measured"',
            '"fitted here"',
            "storage_residual is missing",
        ),
        (
            "[source.poisson]",
            "[source.bulk]",
            "[source.bulk] describes",
        ),
        (
            'name = "mine"',
            'name = "yours"',
            "name is 'yours'",
        ),
        ('description = "A rubber"', "", "description is missing"),
    ],
)
def test_the_check_finds(file, old, new, part):
    assert check_material(file()) == []
    findings = check_material(file(GOOD.replace(old, new, 1)))
    assert any(part in finding for finding in findings), findings
    assert all("\n" not in finding for finding in findings)


def test_a_time_range_and_a_bulk_modulus_pass_the_check(file):
    text = GOOD.replace("omega = [1.0, 1e3]", "time = [1e-3, 10.0]").replace(
        "poisson = 0.5", "bulk = 2e9"
    )
    assert check_material(file(text.replace("[source.poisson]", "[source.bulk]"))) == []


def test_saving_fails_without_a_trace(tmp_path, monkeypatch, file):
    path = file()
    material = em.load_material(path)

    def no_space(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", no_space)
    with pytest.raises(InputError) as error:
        em.save_material(material, path)
    one_line(error, str(path), "No space left on device")
    assert path.read_text(encoding="utf-8") == GOOD
    assert list(tmp_path.iterdir()) == [path]


def test_what_cannot_be_saved(tmp_path):
    material = em.load_material("vhb-4910")
    for path in (tmp_path / "nowhere" / "x.toml", tmp_path):
        with pytest.raises(InputError) as error:
            em.save_material(material, path)
        one_line(error, str(path), "can be written")
    with pytest.raises(InputError) as error:
        em.save_material(em.half_space(material), tmp_path / "x.toml")  # pyright: ignore[reportArgumentType]
    one_line(error, "must be a Prony")
    with pytest.raises(InputError) as error:
        em.save_material(
            material, tmp_path / "x.toml", info={"range": {"omgea": [1.0, 2.0]}}
        )
    one_line(error, "omgea", "Did you mean 'omega'?")
    assert list(tmp_path.iterdir()) == []
