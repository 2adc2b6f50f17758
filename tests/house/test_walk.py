"""The walk of docs/your-data.md: from an instrument's export and a profile to friction
with its uncertainty, timed.
"""

import re
import shlex
import shutil
import time
from pathlib import Path

import numpy as np

import elastomdr as em
from elastomdr.cli.main import main

ROOT = Path(__file__).parents[2]
WALK = re.search(
    r"<!-- walk -->\n```console\n(.*?)^```$",
    (ROOT / "docs/your-data.md").read_text(),
    re.S | re.M,
)[1]


def test_from_two_files_to_friction(tmp_path, monkeypatch, capsys):
    """Each command is the one before's advice; together they take a small part of five
    minutes.
    """
    for name in ("dma-q800.txt", "profile.csv"):
        shutil.copy(ROOT / "examples" / "data" / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    began = time.process_time()
    for step in WALK.removeprefix("$ elastomdr ").split("\n$ elastomdr "):
        command, *said = step.strip().splitlines()
        status = main(shlex.split(command))
        heard = capsys.readouterr()
        assert status == (2 if said[0].startswith("elastomdr: error") else 0), heard.err
        for line in said:
            assert line in heard.out + heard.err
    assert time.process_time() - began < 30
    assert (tmp_path / "road-friction.png").stat().st_size > 10_000
    rows = [
        line.split(",")
        for line in (tmp_path / "road-friction.csv").read_text().splitlines()
        if line[0] != "#"
    ]
    table = dict(zip(rows[0], np.array(rows[1:]).T, strict=True))
    bound = next(
        table[key].astype(float)
        for key in table
        if key.startswith("bound on the error of the model")
    )
    assert (bound > 0).all()
    loss = em.load_material("dma-q800.toml").tensile().loss(2 * np.pi * 10.0)
    tau = np.geomspace(1e-12, 1e2, 29)  # the rubber of examples/data/make.py
    x = 2j * np.pi * 10.0 * tau
    np.testing.assert_allclose(
        loss, np.sum(3e8 * (tau / tau[0]) ** -0.25 * x / (1 + x)).imag, rtol=0.05
    )


def test_scene_to_start_from_with_files(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "road.csv").write_text("q [rad/m],C [m^4]\n1e3,1e-15\n1e5,1e-22\n")
    assert main(["init", "road"]) == 0
    assert (
        main(["init", "sub.toml", "--spectrum", "road.csv", "--material", "epdm-70"])
        == 0
    )
    assert main(["friction", "sub.toml"]) == 2
    assert "[surface] convention must be" in capsys.readouterr().err  # is never guessed
    assert main(["init", "x.toml", "--kind", "ball", "--profile", "road.csv"]) == 2
    assert "--kind must be road" in capsys.readouterr().err
