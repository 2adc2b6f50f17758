"""The notebooks run, and print what their pages show."""

from pathlib import Path

import pytest

NOTEBOOKS = sorted(
    (Path(__file__).parents[2] / "examples" / "notebooks").glob("*.ipynb")
)


def printed(notebook) -> list[str]:
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return [
        output["text"]
        if "text" in output
        else "figure" * ("image/png" in output["data"])
        for output in outputs
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs_and_prints_what_it_holds(path):
    nbformat = pytest.importorskip("nbformat")
    client = pytest.importorskip("nbclient")
    held = nbformat.read(path, as_version=4)
    run = nbformat.read(path, as_version=4)
    client.NotebookClient(
        run, timeout=300, resources={"metadata": {"path": str(path.parent)}}
    ).execute()
    assert printed(run) == printed(held)
    assert printed(held).count("figure") >= 2
    assert path.stat().st_size < 200_000


def test_there_are_three():
    assert len(NOTEBOOKS) == 3
