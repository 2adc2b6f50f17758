"""Every worked problem runs, passes the check it ends in, leaves its figure, and stands
in the gallery.

A file of its own, so that another process can run it beside the examples.
"""

import pytest

from .test_examples import FOLDER, no_window, runs_and_draws, says_what_it_teaches  # noqa: F401

PROBLEMS = sorted((FOLDER / "problems").glob("[0-9][0-9]_*.py"))


def test_there_are_ten():
    assert len(PROBLEMS) == 10


@pytest.mark.parametrize("path", PROBLEMS, ids=lambda path: path.stem)
def test_runs_and_draws(path, tmp_path, monkeypatch):
    runs_and_draws(path, tmp_path, monkeypatch)


@pytest.mark.parametrize("path", PROBLEMS, ids=lambda path: path.stem)
def test_says_what_it_teaches(path):
    says_what_it_teaches(path)


@pytest.mark.parametrize("path", PROBLEMS, ids=lambda path: path.stem)
def test_the_gallery_has_its_figure(path):
    figures = FOLDER.parent / "docs" / "figures" / "problems"
    assert (figures / f"{path.stem}.png").is_file()
