"""Every example runs, passes the check it ends in, and leaves the figure that it shows."""

import runpy
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest

FOLDER = Path(__file__).parents[1] / "examples"
PROBLEMS = sorted((FOLDER / "problems").glob("[0-9][0-9]_*.py"))
EXAMPLES = sorted(FOLDER.glob("[0-9][0-9]_*.py")) + PROBLEMS


@pytest.fixture(autouse=True)
def no_window(monkeypatch):
    backend = matplotlib.get_backend()
    matplotlib.use("agg")
    yield
    plt.close("all")
    matplotlib.use(backend)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_runs_and_draws(path, tmp_path, monkeypatch):
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
    assert len(PROBLEMS) == 10


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_says_what_it_teaches(path):
    text = path.read_text(encoding="utf-8")
    for part in ("Teaches:", "Inputs:", "Check:", f"python examples/{path.relative_to(FOLDER).as_posix()} [--out DIR]"):
        assert part in text.split('"""')[1]
    assert "assert " in text


@pytest.mark.parametrize("path", PROBLEMS, ids=lambda path: path.stem)
def test_problem_is_in_the_docs(path):
    docs = FOLDER.parent / "docs"
    figure = f"figures/problems/{path.stem}.png"
    assert figure in (docs / "problems.md").read_text(encoding="utf-8")
    assert (docs / figure).is_file()


@pytest.mark.parametrize(
    "path", [p for p in EXAMPLES if p not in PROBLEMS and p.stem >= "20"], ids=lambda path: path.stem
)
def test_application_is_in_the_docs(path):
    """Each application has a page that shows its figure and says how to make it again."""
    docs = FOLDER.parent / "docs"
    pages = [page.read_text(encoding="utf-8") for page in docs.glob("*.md")]
    assert any(f"figures/{path.stem}.png" in text and f"examples/{path.name}" in text for text in pages)
    assert (docs / "figures" / f"{path.stem}.png").is_file()
