"""The material library: every file is consistent, survives a round trip and says what
its source says.
"""

import os
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.material.library import material_info

from .check import check_material


def same(one: em.Prony, other: em.Prony) -> None:
    """Two materials agree in every bit."""
    for key in ("equilibrium", "moduli", "times", "viscosity"):
        np.testing.assert_array_equal(getattr(one, key), getattr(other, key))
    for key in ("poisson", "bulk", "kind", "name", "citation"):
        assert getattr(one, key) == getattr(other, key)
    assert type(one.shift) is type(other.shift)
    if one.shift is not None:
        assert vars(one.shift).keys() == vars(other.shift).keys()
        for key, value in vars(one.shift).items():
            np.testing.assert_array_equal(value, getattr(other.shift, key))


def test_the_library_has_what_it_promises():
    names = em.materials()
    assert names == sorted(names)
    assert len(names) >= 12
    assert {
        "vhb-4910",
        "epdm-70",
        "psa-468mp",
        "polyisoprene-34k",
        "tread-passenger-synthetic",
    } <= set(names)


def test_each_material_stands_in_the_table_with_its_grades_range_and_licence():
    readme = (Path(__file__).parents[2] / "materials" / "README.md").read_text(
        encoding="utf-8"
    )
    table = readme.partition("## What is here")[2].partition("###")[0]
    rows = [line.strip("| ").split(" | ") for line in table.splitlines() if "|" in line]
    assert sorted(row[0] for row in rows[2:]) == sorted(em.materials())
    for name, _, moduli, shift, omega, celsius, source, licence in rows[2:]:
        info = material_info(name)
        graded = {group: each["grade"] for group, each in info["source"].items()}
        assert moduli == graded["moduli"]
        assert shift == graded.get("shift", "none")
        material = em.load_material(name)
        for text, given, offset in (
            (omega, material.range.omega, 0.0),
            (celsius, material.range.temperature, 273.15),
        ):
            ends = [float(end) + offset for end in text.split(" to ")]
            assert ends == pytest.approx(given, rel=0.06, abs=0.0)
        assert source
        assert licence in ("own", "paper", "MIT", "BSD-3-Clause", "GPL-3.0")


ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "scene",
    [*ROOT.glob("examples/scenes/*.toml"), *ROOT.glob("src/elastomdr/cli/*/*.toml")],
    ids=lambda scene: f"{scene.parent.name}/{scene.name}",
)
def test_titles_of_scenes_say_that_a_rubber_is_illustrative(scene):
    content = tomllib.loads(scene.read_text(encoding="utf-8"))
    named = content.get("material", [])
    known = {*([named] if isinstance(named, str) else named)} & {*em.materials()}
    grades = {material_info(name)["source"]["moduli"]["grade"] for name in known}
    assert "illustrative" not in grades or "ynthetic" in content["title"]


@pytest.mark.parametrize("name", em.materials())
def test_every_material_passes_the_check(name):
    assert check_material(name) == []


@pytest.mark.parametrize("name", em.materials())
def test_every_material_survives_a_round_trip(name, tmp_path):
    material, info = em.load_material(name), material_info(name)
    assert material.name == info["name"] == name
    assert len(info["moduli"]) == material.moduli.size
    path = tmp_path / f"{name}.toml"
    em.save_material(material, path, info=info)
    same(em.load_material(path), material)
    assert path.read_bytes() == Path(info["path"]).read_bytes()
    bare = tmp_path / "bare.toml"
    em.save_material(material, bare)
    same(em.load_material(bare), material)


@pytest.mark.parametrize(
    "material",
    [
        em.KelvinVoigt(
            1e6, 1 / 3, name="a dashpot", citation='quotes " and \\ and\nlines, \u03c4'
        ),
        em.Maxwell(
            0.1 + 0.2, 1e-7, poisson=-1 / 7, shift=em.Arrhenius(1e5 / 3, 293.15)
        ),
        em.Prony(
            0,
            [1 / 3, 5e-324 + 1],
            [1e-99, 1e99],
            kind="tensile",
            shift=em.VFT(1e3 / 7, 0, 300),
        ),
        em.StandardSolid(
            1e6,
            1e7,
            1.0,
            bulk=2e9,
            kind="tensile",
            shift=em.ShiftTable([250, 300, 350], [3, 0.1, -2]),
        ),
        # crosses zero nowhere
        em.StandardSolid(1e6, 1e7, 1.0, shift=em.ShiftTable([250, 300], [3, 0.1])),
        em.load_material("psa-468mp").at(280.0),
    ],
    ids=lambda material: material.name or type(material.shift).__name__,
)
def test_any_material_survives_a_round_trip(material, tmp_path):
    em.save_material(material, tmp_path / "any.toml")
    same(em.load_material(tmp_path / "any.toml"), material)
    em.save_material(material, str(tmp_path / "any.toml"))  # again, over the old file
    assert [path.name for path in tmp_path.iterdir()] == ["any.toml"]


@pytest.fixture
def mine():
    """A third party's material file, as text."""
    own = Path(material_info("vhb-4910")["path"]).read_text(encoding="utf-8")
    return own.replace('name = "vhb-4910"', 'name = "mine"')


def test_directories_of_third_parties(mine, monkeypatch, tmp_path):
    path, other = tmp_path / "mine.toml", tmp_path / "other"
    path.write_text(mine, encoding="utf-8")
    other.mkdir()
    monkeypatch.setenv(
        "ELASTOMDR_MATERIALS", os.pathsep.join([str(tmp_path), "", str(other)])
    )
    assert "mine" in em.materials()
    same(em.load_material("mine"), em.load_material(path))
    assert material_info("mine")["path"] == str(path.resolve())
    assert check_material("mine") == []
    (other / "mine.toml").write_text(mine, encoding="utf-8")
    assert em.materials().count("mine") == 1
    with pytest.raises(InputError, match="name_or_path") as error:
        em.load_material("mine")
    assert str(path.resolve()) in str(error.value)
    assert str((other / "mine.toml").resolve()) in str(error.value)
    monkeypatch.setenv("ELASTOMDR_MATERIALS", str(tmp_path / "none"))
    with pytest.raises(InputError, match="ELASTOMDR_MATERIALS must be"):
        em.materials()


def test_listing_and_describing_load_no_jax():
    script = """
        import sys
        import elastomdr as em
        from elastomdr.material.library import material_info
        assert material_info(em.materials()[0])["description"]
        assert "jax" not in sys.modules and "numpy" not in sys.modules
    """
    subprocess.run(
        [sys.executable, "-W", "error", "-c", textwrap.dedent(script)], check=True
    )


def test_the_conveyor_cover_gives_the_exact_indentation_resistance():
    """Closed form for the three-parameter foundation: h = 8 mm, D = 0.159 m, v = 5.2
    m/s, W = 2 kN/m.
    """
    layer = em.springs(em.load_material("conveyor-cover"), 8e-3)
    rolling = em.rolling(layer, em.Cylinder(0.159 / 2, 1.0), velocity=5.2, load=2e3)
    np.testing.assert_allclose(rolling.coefficient, 0.0146018269035, rtol=1e-9)


@pytest.mark.parametrize(
    ("name", "time"),
    [("pa6-roller-9ms", 0.009), ("pa6-roller-45ms", 0.045), ("pa6-roller-2s", 2)],
)
def test_the_rollers_creep_as_contact_says(name, time):
    """J(t) = (1 + f (1 - exp(-t/tau)))/G with f = 1, G = 1143 MPa; half-widths of 6.33
    and 4.48 mm at 600 N/mm.
    """
    material = em.load_material(name)
    t = time * np.array([0.0, 0.5, 1.0, 3.0])
    np.testing.assert_allclose(
        material.creep_compliance(t) * 1143e6, 2 - np.exp(-t / time), rtol=1e-12
    )
    shear = np.array([571.5e6, 1143e6])
    half_width = np.sqrt(4 * 600e3 * 0.05 / np.pi / (shear / (1 - 0.4)))
    np.testing.assert_allclose(half_width, [6.33e-3, 4.48e-3], rtol=1e-3)
    np.testing.assert_allclose([material.equilibrium, material.instantaneous], shear)
    assert material.poisson == 0.4


def test_rewritten_shift_laws_are_the_published_ones():
    published = {  # as their sources give them
        "polyisoprene-95k": em.WLF(4.965, 139.3, 298.15),
        "polyisoprene-34k": em.WLF(4.965, 139.3, 298.15),
        "tread-passenger-synthetic": em.WLF(13.2, 39.7, 231.15),
        "tread-winter-synthetic": em.WLF(17.44, 51.6, 208.15),
    }
    for name, law in published.items():
        ours = em.load_material(name).shift
        assert ours is not None
        rewritten = law.at_reference(ours.reference)
        np.testing.assert_allclose(
            [ours.c1, ours.c2], [rewritten.c1, rewritten.c2], rtol=3e-4
        )


@pytest.mark.parametrize("name", ["a" * 400, "a" * 400 + ".toml", "b/" * 3000 + "x"])
def test_a_name_too_long_for_a_file_is_refused_as_any_other(name):
    with pytest.raises(InputError):
        em.load_material(name)
