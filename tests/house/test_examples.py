"""Every example runs in less than 30 s, passes the check it ends in, and leaves the
figure that it shows.
"""

import functools
import os
import runpy
import subprocess
import sys
import time
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure

FOLDER = Path(__file__).parents[2] / "examples"
EXAMPLES = sorted(FOLDER.glob("[0-9][0-9]_*.py"))
LONG = ("26_models_beside_each_other", "27_seal_drive")  # half a minute and more
TO_RUN = [
    pytest.param(path, marks=pytest.mark.slow if path.stem in LONG else ())
    for path in EXAMPLES
]
LONGEST = 30.0  # s


@pytest.fixture(autouse=True)
def no_window(monkeypatch):
    """No window, half the dots, and what an example sets of matplotlib ends with it."""
    backend = matplotlib.get_backend()
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", functools.partialmethod(save, dpi=100))
    with matplotlib.rc_context():
        matplotlib.use("agg")
        yield
        plt.close("all")
    matplotlib.use(backend)


@pytest.mark.parametrize("path", TO_RUN, ids=[path.stem for path in EXAMPLES])
def test_runs_and_draws(path, tmp_path, monkeypatch):
    runs_and_draws(path, tmp_path, monkeypatch)


def runs_and_draws(path, tmp_path, monkeypatch):
    """The example passes its own check, leaves its figure and nothing else, and takes
    less than 30 s.

    What counts is the processor's time, which other jobs on the machine hardly change:
    examples wait for nothing, so that on an idle machine they take no longer than that
    by the clock. It is that of this process, which has the imports and what earlier
    examples compiled already, but plainer, slower machine code; `test_runs_for_itself`
    looks at a process of its own.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(path), "--out", "figures"])
    began = time.process_time()
    runpy.run_path(str(path), run_name="__main__")
    assert time.process_time() - began < LONGEST
    assert [file.name for file in tmp_path.rglob("*") if file.is_file()] == [
        f"{path.stem}.png"
    ]
    image = plt.imread(tmp_path / "figures" / f"{path.stem}.png")
    assert min(image.shape[:2]) > 200
    assert np.ptp(image[..., :3]) > 0.5
    assert not plt.get_fignums()


@pytest.mark.parametrize("column", [("", ""), (",temperature [degC]", ",20")])
def test_a_file_of_one_temperature(column, tmp_path, monkeypatch, capsys):
    """Example 25 says in a line what is wrong with a user's own file."""
    path = FOLDER / "25_measured_friction.py"
    rows = "".join(f"{v},0.05{column[1]}\n" for v in (0.1, 1, 10))
    (tmp_path / "own.csv").write_text(f"velocity [mm/s],mu{column[0]}\n{rows}")
    monkeypatch.setattr(
        sys,
        "argv",
        [str(path), "--out", str(tmp_path), "--data", str(tmp_path / "own.csv")],
    )
    with pytest.raises(SystemExit):
        runpy.run_path(str(path), run_name="__main__")
    assert "two temperatures or more" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "wait4"), reason="no wait4 on this system")
@pytest.mark.parametrize(
    "path", sorted(FOLDER.glob("**/[0-9][0-9]_*.py")), ids=lambda path: path.stem
)
def test_runs_for_itself(path, tmp_path):
    """As a user runs it: in a process of its own, with nothing compiled, and the
    machine code that users get.
    """
    left_out = (
        "XLA_FLAGS",
        "JAX_COMPILATION_CACHE_DIR",
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS",
    )
    own = {
        name: value for name, value in os.environ.items() if name not in left_out
    } | {"MPLBACKEND": "agg"}
    child = subprocess.Popen(
        [sys.executable, str(path), "--out", str(tmp_path)],
        env=own,
        stdout=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    assert child.returncode == 0
    assert used.ru_utime + used.ru_stime < LONGEST


def test_there_are_enough():
    assert len(EXAMPLES) >= 15


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_says_what_it_teaches(path):
    says_what_it_teaches(path)


def says_what_it_teaches(path):
    """The parts that every docstring has, and a check."""
    text = path.read_text(encoding="utf-8")
    for part in (
        "Teaches:",
        "Inputs:",
        "Check:",
        f"python examples/{path.relative_to(FOLDER).as_posix()} [--out DIR]",
    ):
        assert part in text.split('"""')[1]
    assert "assert " in text


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_one_look(path):
    """Axes of its own look like those of the package."""
    text = path.read_text(encoding="utf-8")
    assert 'plt.style.use("elastomdr.figures")' in text or "pyplot" not in text
    assert "dpi=" not in text


@pytest.mark.parametrize(
    "path", [p for p in EXAMPLES if p.stem >= "20"], ids=lambda path: path.stem
)
def test_application_is_in_the_docs(path):
    """Each application has a page that shows its figure and says how to make it
    again.
    """
    docs = FOLDER.parent / "docs"
    pages = [page.read_text(encoding="utf-8") for page in docs.glob("*.md")]
    assert any(
        f"figures/{path.stem}.png" in text and f"examples/{path.name}" in text
        for text in pages
    )
    assert (docs / "figures" / f"{path.stem}.png").is_file()
