"""`elastomdr indent`: what it writes, the histories it knows, what it refuses."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import elastomdr as em
from elastomdr.cli.main import main

from .cli_cases import _TRIANGLE, BAD_INDENTS, INDENT, MATERIAL, arguments


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    (tmp_path / "rubber.toml").write_text(MATERIAL)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(*changes: tuple[str, str]) -> str:
    text = INDENT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    Path("scene.toml").write_text(text)
    return "scene.toml"


def history(program: str) -> dict:
    return arguments("indent", write((_TRIANGLE, program)))


def test_scene_to_table_and_figure(capsys):
    assert main(["indent", write(), "--out", "out"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert "depth" in out
    assert "not converged" not in out
    assert Path("out/scene-indent.png").read_bytes().startswith(b"\x89PNG")
    table = pd.read_csv("out/scene-indent.csv", comment="#")
    header = [
        line
        for line in Path("out/scene-indent.csv").read_text().splitlines()
        if line.startswith("#")
    ]
    assert any("MDR line (exact" in line for line in header)
    time = np.linspace(0, 2e-3, 9)
    expected = em.indent(
        em.load_material("rubber.toml"),
        em.Paraboloid(5e-3),
        time=time,
        depth=1e-4 * np.interp(time, [0, 1e-3, 2e-3], [0, 1, 0]),
        temperature=293.15,
        rtol=1e-4,
    )
    np.testing.assert_allclose(table["force [N]"], expected.force, rtol=1e-12)
    np.testing.assert_allclose(
        table["contact radius [m]"], expected.contact_radius, rtol=1e-12
    )


def test_histories():
    hold = history(
        'program = "hold"\nload = ["1 N", "2 N"]\nduration = "10 s"\nrise = "0.1 '
        's"\npoints = 20'
    )
    assert hold["load"].shape == (2, hold["time"].size)
    np.testing.assert_allclose(hold["load"][:, [0, -1]], [[0, 1], [0, 2]])
    step = history(
        'program = "hold"\ndepth = "1 mm"\nduration = "10 s"\nspacing = '
        '"linear"\npoints = 11'
    )
    np.testing.assert_allclose(step["depth"], 1e-3)
    np.testing.assert_allclose(step["time"], np.arange(11.0))
    at_once = history(
        'program = "hold"\ndepth = "1 mm"\nduration = "10 s"\nrise = "0 '
        's"\nspacing = "linear"\npoints = 11'
    )
    np.testing.assert_array_equal(at_once["depth"], step["depth"])
    np.testing.assert_array_equal(
        history('program = "triangle"\ndepth = "1 mm"\nduration = "2 s"\nrest = "0 s"')[
            "time"
        ],
        history('program = "triangle"\ndepth = "1 mm"\nduration = "2 s"')["time"],
    )
    twice = history(
        'program = "triangle"\ndepth = "1 mm"\nduration = "2 s"\nrest = "1 s"\ncycles '
        "= 2"
    )
    assert twice["time"][-1] == 6.0
    np.testing.assert_allclose(
        np.interp([1, 2, 3, 4, 5], twice["time"], twice["depth"]), [1e-3, 0, 0, 1e-3, 0]
    )
    points = history('time = ["0 s", "1 min"]\ndepth = ["-1 mm", "1 mm"]\npoints = 3')
    np.testing.assert_allclose(points["time"], [0, 30, 60])
    np.testing.assert_allclose(points["depth"], [-1e-3, 0, 1e-3], atol=1e-18)


def test_adhesion_has_its_own_key():
    found = arguments(
        "indent", write(('temperature = "20 degC"', 'adhesion = "50 mJ/m^2"'))
    )
    np.testing.assert_allclose(found["adhesion"], 0.05)


@pytest.mark.parametrize("name", BAD_INDENTS)
def test_refuses(capsys, name):
    change, message = BAD_INDENTS[name]
    before = {*Path().iterdir(), Path("scene.toml")}
    assert main(["indent", write(change)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert re.search(re.escape(message), err), err
    assert set(Path().iterdir()) == before
