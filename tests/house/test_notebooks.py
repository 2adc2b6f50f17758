"""The notebooks run, and print what their pages show."""

from pathlib import Path

import pytest

NOTEBOOKS = sorted(
    (Path(__file__).parents[2] / "examples" / "notebooks").glob("*.ipynb")
)


def printed(notebook) -> list[list[str]]:
    """Text and figures of each cell; a busy kernel sends one text in several pieces."""
    return [
        [
            "".join(output.get("text", "") for output in cell["outputs"]),
            *(
                "figure"
                for output in cell["outputs"]
                if "image/png" in output.get("data", {})
            ),
        ]
        for cell in notebook.cells
        if cell.cell_type == "code"
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
    assert sum(cell.count("figure") for cell in printed(held)) >= 2
    assert path.stat().st_size < 200_000


def test_there_is_one_for_each_kind_of_user():
    persons = [path.stem.partition("_")[2] for path in NOTEBOOKS]
    assert persons == ["tyre", "seal", "belt", "laboratory", "code", "teacher"]
