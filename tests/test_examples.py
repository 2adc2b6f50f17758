"""Every example runs, passes the check it ends in, and leaves the figure that it shows."""

import runpy
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest

FOLDER = Path(__file__).parents[1] / "examples"
EXAMPLES = sorted(FOLDER.glob("[0-9][0-9]_*.py"))


@pytest.fixture(autouse=True)
def no_window(monkeypatch):
    backend = matplotlib.get_backend()
    matplotlib.use("agg")
    yield
    plt.close("all")
    matplotlib.use(backend)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_runs_and_draws(path, tmp_path, monkeypatch):
    runs_and_draws(path, tmp_path, monkeypatch)


def runs_and_draws(path, tmp_path, monkeypatch):
    """The example passes its own check and leaves its figure, and nothing else."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(path), "--out", "figures"])
    runpy.run_path(str(path), run_name="__main__")
    assert [file.name for file in tmp_path.rglob("*") if file.is_file()] == [f"{path.stem}.png"]
    image = plt.imread(tmp_path / "figures" / f"{path.stem}.png")
    assert min(image.shape[:2]) > 400
    assert np.ptp(image[..., :3]) > 0.5
    assert not plt.get_fignums()


def test_there_are_enough():
    assert len(EXAMPLES) >= 15


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_says_what_it_teaches(path):
    says_what_it_teaches(path)


def says_what_it_teaches(path):
    """The parts that every docstring has, and a check."""
    text = path.read_text(encoding="utf-8")
    for part in ("Teaches:", "Inputs:", "Check:", f"python examples/{path.relative_to(FOLDER).as_posix()} [--out DIR]"):
        assert part in text.split('"""')[1]
    assert "assert " in text


@pytest.mark.parametrize("path", [p for p in EXAMPLES if p.stem >= "20"], ids=lambda path: path.stem)
def test_application_is_in_the_docs(path):
    """Each application has a page that shows its figure and says how to make it again."""
    docs = FOLDER.parent / "docs"
    pages = [page.read_text(encoding="utf-8") for page in docs.glob("*.md")]
    assert any(f"figures/{path.stem}.png" in text and f"examples/{path.name}" in text for text in pages)
    assert (docs / "figures" / f"{path.stem}.png").is_file()
