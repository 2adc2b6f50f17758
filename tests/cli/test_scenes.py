"""The scenes that are shipped: each is what its first lines say, and what is cheap
runs; a tyre grips like one.
"""

import csv
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.kinds import read_scene
from elastomdr.cli.main import main
from elastomdr.cli.sweep import assembled, read_content

from ..refused import mentions

FOLDER = Path(__file__).parents[2] / "examples" / "scenes"
COMMAND = {
    path: re.search(
        r"elastomdr (\w+) (?:examples/scenes/)?" + re.escape(path.name),
        path.read_text(encoding="utf-8"),
    )
    for path in sorted(FOLDER.glob("*.toml"))
}
# less than two seconds each
QUICK = ("compounds", "measured_friction", "road", "seal", "slider", "temperatures")


def names(path):
    return path.stem


@pytest.mark.parametrize("path", COMMAND, ids=names)
def test_a_scene_says_its_command_and_is_read_by_it(path):
    assert COMMAND[path], "the command stands in the first lines"
    verb = COMMAND[path][1]
    if verb == "sweep":
        assert assembled(read_content(path), FOLDER)[1]
    else:
        assert read_scene(verb, path).arguments(FOLDER)


def ran(verb, scene, out):
    """Runs a scene; returns the rows of its table, in which every coefficient is a
    number.
    """
    assert main([verb, str(scene), "--out", str(out)]) == 0
    lines = (out / f"{scene.stem}-{verb}.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert rows
    (title,) = {"friction coefficient [-]", "traction coefficient [-]"} & set(rows[0])
    assert np.isfinite([float(row[title]) for row in rows]).all()
    return rows


@pytest.mark.parametrize(
    "path", [path for path in COMMAND if path.stem in QUICK], ids=names
)
def test_a_scene_runs(path, tmp_path, capsys):
    ran(COMMAND[path][1], path, tmp_path)
    assert "did not converge" not in capsys.readouterr().err


def fewer(name, count, folder):
    """A copy of a scene with so many velocities or slips, beside the files that it
    reads.
    """
    text = (FOLDER / name).read_text(encoding="utf-8")
    fewer_points, changed = re.subn(r"points = \d+", f"points = {count}", text)
    assert changed == 1
    (folder / name).write_text(
        fewer_points.replace(
            '"tread_friction.csv"', f"{str(FOLDER / 'tread_friction.csv')!r}"
        )
    )
    return folder / name


def test_the_table_of_the_tread_is_that_of_its_scene(tmp_path):
    """`tread_friction.csv` is what `tread_on_road.toml` writes: at both ends of its
    velocities here.
    """
    rows = ran("friction", fewer("tread_on_road.toml", 2, tmp_path), tmp_path)
    law = em.load_friction(FOLDER / "tread_friction.csv")
    for row in rows:
        place = (
            float(row[key])
            for key in ("velocity [m/s]", "temperature [K]", "nominal pressure [Pa]")
        )
        assert float(law(*place)) == pytest.approx(
            float(row["friction coefficient [-]"]), rel=1e-3
        )


def test_a_tyre_brakes_like_one(tmp_path):
    """A peak at some per cent of slip, from which the locked wheel loses a seventh or
    more, and property files.
    """
    rows = ran("traction", fewer("braking.toml", 24, tmp_path), tmp_path)
    slip, grip, kelvin = (
        np.array([float(row[key]) for row in rows]).reshape(9, 24)
        for key in ("slip [-]", "traction coefficient [-]", "temperature [K]")
    )
    top = grip.argmax(axis=1)
    peak = grip[np.arange(9), top]
    assert ((peak > 0.6) & (peak < 1.2)).all()
    assert ((slip[np.arange(9), top] > 0.01) & (slip[np.arange(9), top] < 0.15)).all()
    assert (grip[:, -1] < 0.86 * peak).all()
    assert (grip[:, -1] > 0.4).all()
    said = {
        f"braking-traction-{t - 273.15:g}degC.tir" for t in np.unique(kelvin).round(2)
    }
    assert {path.name for path in tmp_path.glob("*.tir")} == said


def test_what_rolling_rests_on_stands_beside_it(tmp_path, capsys):
    """A degree changes it by more than the plain band, which names what it leaves out;
    a whole belt has no parts, and says so before it is computed.
    """
    scene = fewer("belt_rig.toml", 2, tmp_path)
    assert main(["rolling", str(scene), "--out", str(tmp_path)]) == 0
    assert mentions(capsys.readouterr().out, "moduli", "temperature")
    assert main(["rolling", str(scene), "--out", str(tmp_path), "--uncertainty"]) == 0
    said = capsys.readouterr().out.splitlines()
    lines = (tmp_path / "belt_rig-rolling-uncertainty.csv").read_text().splitlines()
    rows = [*csv.DictReader(line for line in lines if not line.startswith("#"))]
    share = {
        part: max(float(r["share [-]"] or 0) for r in rows if r["part"] == part)
        for part in ("model", "temperature")
    }
    assert share["temperature"] > share["model"] > 0
    assert mentions(said[1], "temperature", "model")
    assert mentions(said[2], "band: rubber")
    belt = FOLDER / "belt_conveyor.toml"
    assert main(["rolling", str(belt), "--out", str(tmp_path), "--uncertainty"]) == 2
    assert mentions(capsys.readouterr().err, "--uncertainty", "[conveyor]")
    drawn = tmp_path / "belt.toml"
    drawn.write_text("uncertainty = 4\n" + belt.read_text())
    assert main(["rolling", str(drawn), "--out", str(tmp_path)]) == 2
    assert mentions(capsys.readouterr().err, "uncertainty", "draws")


def test_what_friction_rests_on_stands_beside_it(tmp_path, capsys):
    """What `curve.uncertainty()` is in Python, with its doubts."""
    scene = fewer("slider.toml", 4, tmp_path)
    assert main(["friction", str(scene), "--out", str(tmp_path), "--uncertainty"]) == 0
    said = capsys.readouterr().out.splitlines()
    lines = (tmp_path / "slider-friction-uncertainty.csv").read_text().splitlines()
    assert (tmp_path / "slider-friction-uncertainty.png").stat().st_size > 1e4
    rows = [*csv.DictReader(line for line in lines if not line.startswith("#"))]
    with warnings.catch_warnings(action="ignore"):
        held = em.friction(
            em.load_material("tread-passenger-synthetic"),
            em.Sphere(5e-3),
            load=10.0,
            velocity=np.geomspace(1e-6, 10.0, 4),
            temperature=293.15,
        ).uncertainty()
    assert {row["part"] for row in rows} == set(held.sources)
    share = [float(row["share [-]"] or np.nan) for row in rows]
    np.testing.assert_allclose(share, held.share.ravel(), rtol=1e-6, atol=1e-9)
    assert all("illustrative" in row["doubts"] for row in rows)
    assert any(line.startswith("# illustrative: 4 of 4") for line in lines)
    names = [line[:9].strip() for line in said]
    assert names == ["largest", "how sure", "rests on", "doubts", "wrote"]
    i = int(np.argmax(held.value))
    ends = held.value[i] * (1 + held.half_band()[i] * np.array([-1, 1]))
    assert mentions(said[1], *(f"{max(end, 0):.3g}" for end in ends))
    assert mentions(said[1], f"model {100 * held['model'].share[i]:.2g} %")
    best = held.at([i]).surer()[0]  # there, as the cards of the page say it
    assert best.words() != held.surer()[0].words()
    assert mentions(said[2], best.words(), "not in the band", "rubber")
    assert main(["friction", str(scene), "--out", str(tmp_path)]) == 0
    assert mentions(capsys.readouterr().out, "moduli", "temperature")
    asked = ["--out", str(tmp_path), "--uncertainty", "--verbose"]
    assert main(["friction", str(scene), *asked]) == 0
    assert all(each.words() in capsys.readouterr().out for each in held.surer()[:1])


def test_rolling_of_the_same_rubber_stands_beside_its_friction(tmp_path, capsys):
    """The README's main job: friction of a tread about 1, and beside it what
    `em.rolling` computes on a cover of the rubber.
    """
    text = (FOLDER / "tread.toml").read_text(encoding="utf-8")
    scene = tmp_path / "tread.toml"
    scene.write_text(text.replace("points = 24", "points = 2"))
    rows = ran("friction", scene, tmp_path / "out")
    assert max(float(r["friction coefficient [-]"]) for r in rows) == pytest.approx(
        1.0, abs=0.1
    )
    written = {file.name for file in (tmp_path / "out").iterdir()}
    assert written == {
        f"tread-{verb}.{kind}"
        for verb in ("friction", "rolling")
        for kind in ("csv", "png")
    }
    said = capsys.readouterr().out
    assert "rolling resistance coefficient" in said
    assert len(said.splitlines()) == 7
    lines = (tmp_path / "out" / "tread-rolling.csv").read_text().splitlines()
    rolling = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    cover = em.layer(em.load_material("tread-passenger-synthetic"), 8e-3)
    expected = em.rolling(
        cover,
        em.Cylinder(0.3, 0.2),
        load=4e3,
        velocity=np.array([1.0, 50.0]),
        temperature=np.array([[273.15], [293.15], [313.15]]),
    )
    found = {
        (float(r["temperature [K]"]), float(r["velocity [m/s]"])): float(
            r["rolling resistance coefficient [-]"]
        )
        for r in rolling
    }
    for kelvin, velocity, coefficient in zip(
        expected.temperature.ravel(),
        expected.velocity.ravel(),
        expected.coefficient.ravel(),
        strict=True,
    ):
        assert found[kelvin, velocity] == pytest.approx(coefficient, rel=1e-9)


def test_a_comparison_refuses_a_roller(tmp_path, capsys):
    text = (FOLDER / "tread.toml").read_text(encoding="utf-8")
    both = '["tread-passenger-synthetic", "sbr-gum-like"]'
    scene = tmp_path / "tread.toml"
    scene.write_text(text.replace('"tread-passenger-synthetic"', both))
    assert main(["compare", str(scene), "--out", str(tmp_path)]) == 2
    assert mentions(capsys.readouterr().err, "roller", "left out")
