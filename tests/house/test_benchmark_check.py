"""benchmarks/check.py on records that were altered: a ratio that falls by 40 % is
reported, one by 20 % is not. And all benchmarks can be imported.
"""

import importlib
import json
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
RECORD = {
    "title": "Two contenders on the same work",
    "verdicts": [
        {
            "name": "times faster",
            "measured": 12000.0,
            "target": ">= 10000",
            "met": True,
        },
        {"name": "largest error", "measured": 1e-7, "target": "<= 1e-06", "met": True},
        {"name": "first number", "measured": 0.2, "target": "<= 0.8 s", "met": True},
    ],
}


def test_all_benchmarks_can_be_imported():
    """Each has what it names of the package and of the other benchmarks; none runs."""
    code = """
    import importlib, sys
    sys.path[:0] = sys.argv[1:3]
    for name in sys.argv[3:]:
        importlib.import_module(name)
    """
    folders = [BENCHMARKS, BENCHMARKS / "robustness"]
    names = [path.stem for folder in folders for path in sorted(folder.glob("*.py"))]
    assert len(names) == len(set(names)) > 50
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code), *map(str, folders), *names],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture
def check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """`check.main` on a folder of results of its own, whose record is committed."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    module = importlib.import_module("check")

    monkeypatch.setattr(module, "RESULTS", tmp_path)
    monkeypatch.setattr(sys, "argv", ["check.py"])
    write(tmp_path, RECORD)
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)
    commit(tmp_path)
    return module.main


def commit(folder: Path) -> None:
    who = [
        "-c",
        "user.name=A",
        "-c",
        "user.email=a@example.org",
        "-c",
        "commit.gpgsign=false",
    ]
    for command in (
        ["add", "."],
        [*who, "commit", "-q", "--allow-empty", "-m", "record"],
    ):
        subprocess.run(["git", *command], cwd=folder, check=True)


def write(folder: Path, record: dict) -> None:
    (folder / "work.json").write_text(json.dumps(record))


def altered(index: int, factor: float, met: bool) -> dict:
    verdicts = [dict(one) for one in RECORD["verdicts"]]
    verdicts[index].update(measured=verdicts[index]["measured"] * factor, met=met)
    return {**RECORD, "verdicts": verdicts}


@pytest.mark.parametrize(
    ("record", "status", "said"),
    [
        (RECORD, 0, "3 recorded figures, 0 fallen"),
        (altered(0, 0.6, met=False), 1, "times faster"),
        (altered(0, 0.8, met=False), 0, "0 fallen"),
        # a time that grows within its target
        (altered(2, 2.0, met=True), 1, "first number"),
        # grown, and still within its target
        (altered(1, 5.0, met=True), 0, "0 fallen"),
        (altered(1, 20.0, met=False), 1, "largest error"),
        (altered(0, float("nan"), met=False), 1, "times faster"),
        (altered(1, float("nan"), met=False), 1, "largest error"),
        ({**RECORD, "verdicts": RECORD["verdicts"][1:]}, 1, "gone"),
    ],
    ids=[
        "same",
        "ratio -40 %",
        "ratio -20 %",
        "time within target",
        "error within target",
        "error beyond target",
        "no ratio",
        "no error",
        "figure gone",
    ],
)
def test_check_reports_a_fall(
    check, tmp_path: Path, capsys, record: dict, status: int, said: str
) -> None:
    write(tmp_path, record)
    assert check() == status
    assert said in capsys.readouterr().out


@pytest.mark.parametrize(
    "record",
    [RECORD, {"title": "No figures"}, [{"mu": 0.1}]],
    ids=["with figures", "without", "points"],
)
def test_check_reports_a_record_that_is_gone(
    check, tmp_path: Path, capsys, record: dict
) -> None:
    write(tmp_path, record)
    (tmp_path / "other.json").write_text(json.dumps(RECORD))
    commit(tmp_path)
    (tmp_path / "work.json").unlink()
    assert check() == 1
    assert "the record" in capsys.readouterr().out


def test_a_record_that_was_never_committed_is_no_fall(
    check, tmp_path: Path, capsys
) -> None:
    (tmp_path / "new.json").write_text(json.dumps(RECORD))
    assert check() == 0
    assert "3 recorded figures, 0 fallen" in capsys.readouterr().out
