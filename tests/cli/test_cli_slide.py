"""`elastomdr slide`: its stages against a history written out, what it writes, what it
refuses.
"""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import elastomdr as em
from elastomdr.cli.main import main

from .cli_cases import BAD_SLIDES, MATERIAL, SLIDE, arguments


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    (tmp_path / "rubber.toml").write_text(MATERIAL)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(*changes: tuple[str, str]) -> str:
    text = SLIDE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    Path("scene.toml").write_text(text)
    return "scene.toml"


def test_scene_to_table_and_figure(capsys):
    assert main(["slide", write(), "--out", "out"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out.startswith(("peak ", "largest "))
    assert Path("out/scene-slide.png").read_bytes().startswith(b"\x89PNG")
    table = pd.read_csv("out/scene-slide.csv", comment="#")
    steady = em.friction(
        em.load_material("rubber.toml"),
        em.Paraboloid(5e-3),
        velocity=0.5,
        load=2.0,
        temperature=293.15,
        model=em.Line(),
    )
    np.testing.assert_allclose(
        table["friction coefficient [-]"][16], steady.mu, rtol=5e-2
    )
    np.testing.assert_allclose(
        table["normal force [N]"], [2.0] * 17 + [1.0] * 9, rtol=1e-9
    )


def test_stages_follow_each_other():
    history = arguments("slide", write())
    time, position, load = (history[name] for name in ("time", "position", "load"))
    assert time.size == 1 + 8 + 8 + 1 + 8  # the first instant, three stages, one jump
    np.testing.assert_allclose(
        time[[0, 8, 16, 17, 25]], [0, 2e-3, 10e-3, 10e-3, 12e-3], rtol=1e-12
    )
    np.testing.assert_allclose(
        position[[0, 8, 16, 17, 25]], [0, 0, 4e-3, 4e-3, 3e-3], atol=1e-15
    )
    np.testing.assert_array_equal(load, [2.0] * 17 + [1.0] * 9)
    np.testing.assert_allclose(
        np.diff(position[8:17]) / np.diff(time[8:17]), 0.5, rtol=1e-9
    )
    ramped = arguments("slide", write(('load = "1 N"', 'load = "1 N"\nramp = true')))
    np.testing.assert_allclose(ramped["load"][16:], np.linspace(2, 1, 9))
    grown = arguments("slide", write(('load = "2 N"', 'load = "2 N"\nramp = true')))
    np.testing.assert_allclose(
        grown["load"][:9], np.append(0, 2 * np.geomspace(1e-4, 1, 8))
    )


@pytest.mark.parametrize("name", BAD_SLIDES)
def test_refuses(capsys, name):
    change, message = BAD_SLIDES[name]
    before = {*Path().iterdir(), Path("scene.toml")}
    assert main(["slide", write(change)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert re.search(re.escape(message), err), err
    assert set(Path().iterdir()) == before
