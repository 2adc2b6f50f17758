"""The command line: what it writes, what it refuses and how."""

import os
import re
import tomllib
import warnings
from pathlib import Path

import jax
import numpy as np
import pandas as pd
import pytest

import elastomdr as em
from elastomdr.cli.kinds import read_content, read_scene
from elastomdr.cli.main import main
from elastomdr.cli.sweep import assembled
from elastomdr.errors import ConvergenceWarning

from ..refused import mentions
from .cli_cases import BAD_MATERIALS, BAD_SCENES, MATERIAL, SCENE, arguments

# lines that a command prints after the largest value
OTHERS = ["how sure", "rests on", "doubts", "wrote"]


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """A folder with one material, the current one; JAX's settings stay as they are."""
    (tmp_path / "rubber.toml").write_text(MATERIAL)
    (tmp_path / "no-shift.toml").write_text(MATERIAL[: MATERIAL.index("[shift]")])
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(
    folder: Path, *changes: tuple[str, str], name: str = "scene.toml", text: str = SCENE
) -> str:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / name).write_text(text)
    return name


def refused(capsys, *argv: str) -> str:
    """Runs what must fail as bad input: status 2, one line on stderr, no file written;
    returns that line.
    """
    before = sorted(Path().rglob("*"))
    assert main(argv) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("elastomdr: error: ")
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert "Traceback" not in err
    assert sorted(Path().rglob("*")) == before
    return err


@pytest.mark.parametrize(
    ("verb", "call", "coefficient"),
    [
        ("friction", em.friction, "friction coefficient [-]"),
        ("rolling", em.rolling, "rolling resistance coefficient [-]"),
    ],
)
def test_scene_to_table_and_figure(place, capsys, verb, call, coefficient):
    name = write(place)
    assert main([verb, name, "--out", "new/folder"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    first, *others = [line[:10].strip() for line in out.splitlines()]
    assert first == "peak"
    assert others == OTHERS
    assert f"new/folder/scene-{verb}.csv" in out.replace(os.sep, "/")
    assert sorted(p.name for p in Path("new/folder").iterdir()) == [
        f"scene-{verb}.csv",
        f"scene-{verb}.png",
    ]
    assert Path(f"new/folder/scene-{verb}.png").read_bytes().startswith(b"\x89PNG")
    lines = Path(f"new/folder/scene-{verb}.csv").read_text().splitlines()
    header = "\n".join(line for line in lines if line.startswith("# "))
    for said in (
        em.__version__,
        "Slider",
        "scene.toml",
        "10 N",
        "bare MDR line",
        "units: SI",
    ):
        assert said in header
    table = pd.read_csv(f"new/folder/scene-{verb}.csv", comment="#")
    expected = call(
        em.load_material("rubber.toml"),
        em.Paraboloid(5e-3),
        velocity=np.geomspace(1e-3, 1.0, 4),
        load=10.0,
        temperature=293.15,
        model=em.Line(),
        rtol=1e-4,
    )
    assert len(table) == 4
    assert table["converged"].dtype == bool
    np.testing.assert_allclose(table["velocity [m/s]"], expected.velocity, rtol=1e-14)
    np.testing.assert_allclose(
        table[coefficient],
        expected.mu if verb == "friction" else expected.coefficient,
        rtol=1e-14,
    )
    top = float(re.search(rf"{coefficient[:-4]} (\S+) at", out)[1])
    assert top == pytest.approx(table[coefficient].max(), rel=6e-3)
    assert main([verb, name, "--out", "new/folder", "--verbose"]) == 0
    said = capsys.readouterr().out
    assert all(text in said for text in ("10 N", "Slider"))


def test_points_that_fail_give_status_3_and_empty_cells(place, capsys, monkeypatch):
    computed = em.friction

    def half_failed(*args, **kwargs):
        curve = computed(*args, **kwargs)
        warnings.warn(
            "1 of 4 points did not converge", ConvergenceWarning, stacklevel=2
        )
        object.__setattr__(curve, "mu", np.where(np.arange(4) == 1, np.nan, curve.mu))
        object.__setattr__(curve, "converged", np.arange(4) != 1)
        return curve

    monkeypatch.setattr("elastomdr.friction", half_failed, raising=False)
    assert main(["friction", write(place)]) == 3
    out, err = capsys.readouterr()
    assert "not converged (left out) at 1 of 4" in out
    assert err.count("\n") == 1
    assert "1 of 4" in err
    table = pd.read_csv("scene-friction.csv", comment="#")
    assert table["friction coefficient [-]"].isna().tolist() == [
        False,
        True,
        False,
        False,
    ]


def test_plan(place, capsys):
    name = write(place)
    assert main(["plan", name, "--quantity", "rolling"]) == 0
    out, err = capsys.readouterr()
    assert "rolling" in out
    assert "branches" in out
    assert err == ""
    assert not list(place.glob("*.csv"))


def test_materials(place, capsys):
    assert main(["materials"]) == 0
    listed = capsys.readouterr().out
    for name in em.materials():
        assert f"\n{name} " in "\n" + listed
    assert main(["materials", em.materials()[0]]) == 0
    assert "[source.moduli]" in capsys.readouterr().out
    assert main(["materials", "rubber.toml"]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("# rubber.toml\n")
    assert tomllib.loads(shown) == tomllib.loads(Path("rubber.toml").read_text())
    assert "Did you mean" in refused(capsys, "materials", em.materials()[0] + "x")


def test_every_library_material_can_be_shown(capsys):
    for name in em.materials():
        assert main(["materials", name]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("case", BAD_SCENES)
def test_bad_scene(place, capsys, case):
    change, said = BAD_SCENES[case]
    line = refused(capsys, "friction", write(place, change))
    assert said in line
    assert "scene.toml" in line


@pytest.mark.parametrize("case", BAD_MATERIALS)
def test_bad_material(place, capsys, case):
    change, said = BAD_MATERIALS[case]
    write(place, change, name="rubber.toml", text=MATERIAL)
    line = refused(capsys, "friction", write(place))
    assert said in line
    assert "rubber.toml" in line


@pytest.mark.parametrize(
    "argv",
    [
        ("friction", "missing.toml"),
        ("friction", "."),
        ("friction", "bad\0name.toml"),
        ("friction", "latin.toml"),
        ("friction", "scene.toml", "--out", "rubber.toml"),
        ("friction", "scene.toml", "--out", "rubber.toml/below"),
        ("friction", "scene.toml", "--out", "bad\0name"),
        ("friction",),
        (),
        ("frictoin", "scene.toml"),
        ("friction", "scene.toml", "--outt", "."),
        ("plan", "scene.toml", "--quantity", "heat"),
        ("materials", "."),
        ("materials", "unknown"),
    ],
    ids=" ".join,
)
def test_bad_command(place, capsys, argv):
    (place / "latin.toml").write_bytes('title = "Gleitkörper"'.encode("latin-1"))
    write(place)
    refused(capsys, *argv)


def test_a_file_that_cannot_be_replaced_leaves_nothing_behind(place, capsys):
    name = write(place)
    Path("scene-friction.png").mkdir()
    refused(capsys, "friction", name)


def test_interrupt_is_one_line(place, capsys, monkeypatch):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("elastomdr.cli.compute.read_scene", stopped)
    assert main(["friction", write(place)]) == 130
    assert capsys.readouterr().err == "elastomdr: interrupted\n"


def test_lists_get_axes_of_their_own(place):
    name = write(
        place,
        ('"20 degC"', '["293.15 K", "-35 degC", "77 degF"]'),
        ('load = "10 N"', 'depth = ["1 mm", "20 µm"]'),
        ('"1e-3 m/s"', '"3.6e-3 km/h"'),
    )
    found = arguments("friction", name)
    assert found["temperature"].shape == (3, 1, 1)
    np.testing.assert_allclose(found["temperature"].ravel(), [293.15, 238.15, 298.15])
    np.testing.assert_allclose(found["depth"], [[1e-3], [2e-5]])
    np.testing.assert_allclose(found["velocity"], np.geomspace(1e-3, 1.0, 4))
    assert found["model"] == em.Line()
    one = arguments(
        "friction", write(place, ('"20 degC"', '["20 degC"]'), ('"10 N"', '"2 lbf"'))
    )
    assert one["temperature"] == 293.15
    assert one["load"] == pytest.approx(8.896443)


SHAPES = {
    'shape = "sphere"\nradius = "5 mm"': em.Sphere(5e-3),
    'shape = "cone"\nslope = 0.2': em.Cone(0.2),
    'shape = "power_law"\nexponent = 3\ncoefficient = "2 mm^-2"': em.PowerLaw(3, 2e6),
    'shape = "power_law"\nexponent = 1\ncoefficient = 0.2': em.PowerLaw(1, 0.2),
    'shape = "power_law"\nexponent = 2.5\ncoefficient = "100 m^-1.5"': em.PowerLaw(
        2.5, 100
    ),
    'shape = "flat_punch"\nradius = "1 cm"': em.FlatPunch(0.01),
    (
        'shape = "profile"\nunit = "mm"\nr = [0, 1, 2, 3, 4]\nz = [0.0, 0.1, 0.4, '
        "0.9, 1.6]"
    ): em.Profile(1e-3 * np.arange(5.0), 1e-4 * np.arange(5.0) ** 2),
}


@pytest.mark.parametrize("text", SHAPES)
def test_shapes(place, text):
    shape = arguments(
        "friction", write(place, ('shape = "paraboloid"\nradius = "5 mm"', text))
    )["shape"]
    assert type(shape) is type(SHAPES[text])
    for found, expected in zip(
        *(jax.tree.leaves(s) for s in (shape, SHAPES[text])), strict=True
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_layer_and_two_bodies(place):
    name = write(
        place, ("[contact]", '[layer]\nthickness = "8 mm"\nbonded = false\n[contact]')
    )
    layer = arguments("friction", name)["material"]
    assert isinstance(layer, em.Layer)
    assert (float(layer.thickness), layer.bonded) == (8e-3, False)
    name = write(
        place,
        (
            "[contact]",
            '[layer]\nthickness = "8 mm"\nbonded = false\nsprings = true\n[contact]',
        ),
    )
    layer = arguments("friction", name)["material"]
    rubber = em.load_material("rubber.toml")
    np.testing.assert_allclose(
        layer.moduli, em.springs(rubber, 8e-3, bonded=False).moduli
    )
    both = arguments(
        "friction", write(place, ("temperature", 'other = "rubber.toml"\ntemperature'))
    )["material"]
    np.testing.assert_allclose(both.moduli, em.half_space(rubber, rubber).moduli)


def test_two_bodies_that_shift_differently_meet_at_one_temperature(place, capsys):
    other = (
        Path("rubber.toml").read_text().replace("8.86", "17.4").replace("1e6", "3e6")
    )
    (place / "other.toml").write_text(other)
    found = arguments(
        "friction", write(place, ("temperature", 'other = "other.toml"\ntemperature'))
    )
    first, second = (
        em.load_material(name).at(293.15) for name in ("rubber.toml", "other.toml")
    )
    np.testing.assert_allclose(
        found["material"].times, em.half_space(first, second).times
    )
    assert "at 293.15 K" in found["material"].name
    assert "temperature" not in found
    name = write(
        place,
        (
            'temperature = "20 degC"',
            'other = "other.toml"\ntemperature = ["20 degC", "30 degC"]',
        ),
    )
    assert mentions(refused(capsys, "friction", name), "temperature", "single value")
    name = write(place, ('temperature = "20 degC"', 'other = "other.toml"'))
    assert mentions(refused(capsys, "friction", name), "temperature")


def test_files_are_looked_for_beside_the_scene(place, monkeypatch):
    name = write(place)
    (place / "elsewhere").mkdir()
    monkeypatch.chdir(place / "elsewhere")
    assert arguments("friction", f"../{name}")["material"].moduli.size == 2


@pytest.mark.parametrize(
    "scene",
    sorted((Path(__file__).parents[2] / "examples" / "scenes").glob("*.toml")),
    ids=lambda p: p.stem,
)
def test_shipped_scenes_can_be_read(scene):
    verb = scene.read_text().split("elastomdr ")[1].split()[0]
    if verb == "sweep":
        call, axes = assembled(read_content(scene), scene.parent)
        assert (
            len(call.arguments)
            * np.prod(
                [len(axis) for name, axis in axes.items() if name not in call.names]
            )
            > 100
        )
        return
    read = read_scene(verb, scene)
    assert read.title
    found = read.arguments(scene.parent)
    assert (
        max(np.size(found[key]) for key in ("velocity", "slip", "time") if key in found)
        >= 3
    )
    if read.called() in ("friction", "rolling") and read.mark == "indenter":
        assert em.plan(**found, quantity=verb).points >= 3
