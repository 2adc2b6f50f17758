"""The page for a user's own data is run as it stands: its commands, its scene file, its
Python, on its example data.

Only the velocities are fewer, 6 for 24.
"""

import re
import runpy
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "your-data.md").read_text(encoding="utf-8")
DATA = ROOT / "examples" / "data"


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


def fewer(text):
    """Six velocities in place of 24: nothing else would be learned from all."""
    shorter = re.sub(r"(points = |1e-4, 10, )24", r"\g<1>6", text)
    assert shorter != text
    return shorter


def mu_of(file):
    rows = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    at = next(
        i
        for i, title in enumerate(rows[0].split(","))
        if title.startswith("friction coefficient")
    )
    return [float(row.split(",")[at]) for row in rows[1:]]


@pytest.fixture
def place(tmp_path, monkeypatch):
    for name in ("dma.csv", "road.csv"):
        shutil.copy(DATA / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_page_runs(place, capsys):
    (scene,) = re.findall(
        r"<!-- file: (\S+) -->\n```toml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE
    )
    (place / scene[0]).write_text(fewer(scene[1]))
    for line in "".join(blocks("bash")).splitlines():
        program, *arguments = shlex.split(line)
        assert program == "elastomdr"
        assert main(arguments) == 0
    said = capsys.readouterr()
    for words in (
        "misfit",
        "reduced window",
        "rms height",
        "rms slope",
        "as read",
        "all converged",
    ):
        assert words in said.out
    assert "--material fitted/dma.toml" in said.out
    assert "outside the measured frequencies of the material" in said.err
    for file in re.findall(r"`((?:fitted|out)/[\w.-]+)`", PAGE):
        assert (place / file).exists(), file

    names = {}
    with pytest.warns(em.ExtrapolationWarning):
        exec(compile(fewer(blocks("python")[0]), "your-data.md", "exec"), names)
    curve = names["curve"]
    assert curve.converged.all()
    assert (np.diff(curve.mu[2]) > 0).all()  # at 60 degC, far below the peak
    np.testing.assert_allclose(
        mu_of(place / "out" / "road-friction.csv"), mu_of(place / "mu.csv"), rtol=1e-6
    )
    assert (place / "mu.png").stat().st_size > 10_000
    assert em.load_material("table.toml").omega.size == names["table"].omega.size


def test_file_head_is_that_of_the_data():
    (block,) = blocks("text")
    assert (DATA / "road.csv").read_text().startswith(block)


def test_example_data_are_what_their_script_makes(tmp_path):
    for name in ("make.py", "README.md"):
        shutil.copy(DATA / name, tmp_path)
    runpy.run_path(str(tmp_path / "make.py"))
    for name in ("dma.csv", "road.csv"):
        made, kept = (
            np.loadtxt(folder / name, delimiter=",", skiprows=2)
            for folder in (tmp_path, DATA)
        )
        np.testing.assert_allclose(made, kept, rtol=1e-3)
    for name in ("dma-q800.txt", "profile.csv"):
        assert (tmp_path / name).read_bytes() == (DATA / name).read_bytes()
